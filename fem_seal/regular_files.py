"""The one way in for files: what is read is a regular file of a sane size, never a pipe, a device or a folder.

A pipe that nobody writes to would be waited for without end, and a device such as /dev/zero never ends.
"""

from __future__ import annotations

import os
import stat
from pathlib import Path

from fem_seal.errors import SealError

# What a person writes, and what instruments and other programs do.
_MOST_BYTES = 64 * 2**20
MOST_BYTES_OF_SCAN = MOST_BYTES_OF_DRAWING = 2**30

_KINDS = (
    (stat.S_ISDIR, "a folder"),
    (stat.S_ISFIFO, "a pipe"),
    (stat.S_ISCHR, "a device"),
    (stat.S_ISBLK, "a device"),
    (stat.S_ISSOCK, "a socket"),
)


class UnreadableFileError(SealError, ValueError):
    """A file cannot be read; the message does not repeat its path: "cannot be read (no such file or directory)"."""


def read_bytes(path: str | os.PathLike[str], most: int = _MOST_BYTES) -> bytes:
    """Content of a regular file.

    Parameters
    ----------
    path : path
    most : int
        Largest size that is read [bytes].

    Raises
    ------
    UnreadableFileError
        If it is not there, may not be read, is no regular file, or is larger.
    """
    try:
        # Not blocking: to open a pipe would wait for the one who writes it.
        handle = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
        try:
            _check(os.fstat(handle), most)
            with open(handle, "rb", closefd=False) as file:
                # A file of the system may say that it is empty and have no end.
                content = file.read(most + 1)
        finally:
            os.close(handle)
    except (OSError, ValueError) as error:
        raise _unreadable(error) from None
    if len(content) > most:
        raise _too_large(most)
    return content


def read_text(path: str | os.PathLike[str], most: int = _MOST_BYTES) -> str:
    """The same as text in UTF-8, with or without a byte order mark.

    Raises
    ------
    UnreadableFileError
        As of `read_bytes`.
    UnicodeDecodeError
        If it is no such text.
    """
    text = read_bytes(path, most).decode("utf-8-sig")
    # as a file opened for text gives it
    return text.replace("\r\n", "\n").replace("\r", "\n")


def check_file(path: str | os.PathLike[str], most: int = _MOST_BYTES) -> None:
    """Whether `read_bytes` would read it, for those who are given the path and read it themselves.

    Raises
    ------
    UnreadableFileError
        As of `read_bytes`.
    """
    try:
        _check(Path(path).stat(), most)
        if not os.access(path, os.R_OK):
            raise UnreadableFileError("cannot be read (permission denied)")
    except (OSError, ValueError) as error:
        raise _unreadable(error) from None


def _check(status: os.stat_result, most: int) -> None:
    if not stat.S_ISREG(status.st_mode):
        kind = next((name for is_kind, name in _KINDS if is_kind(status.st_mode)), "no regular file")
        raise UnreadableFileError(f"cannot be read (is {kind}; a regular file is needed)")
    if status.st_size > most:
        raise _too_large(most)


def _too_large(most: int) -> UnreadableFileError:
    return UnreadableFileError(f"cannot be read (is larger than {most // 2**20} MB)")


def _unreadable(error: OSError | ValueError) -> UnreadableFileError:
    if isinstance(error, UnreadableFileError):
        return error
    reason = getattr(error, "strerror", None) or "not a file name"
    return UnreadableFileError(f"cannot be read ({reason.lower()})")
