"""One process at a time writes into a folder."""

from __future__ import annotations

import errno
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from fem_seal.errors import InputError, OutputError, Problem

if sys.platform == "win32":
    import msvcrt
else:
    import fcntl

FILE = ".fem-seal-lock"
# What the systems say if another process has the lock; anything else means that this file system has no locks.
_TAKEN = (errno.EWOULDBLOCK, errno.EAGAIN, errno.EACCES, errno.EDEADLK)


@contextmanager
def alone(folder: Path) -> Iterator[None]:
    """Keep others from writing into the same folder, which is made if it does not exist.

    The lock is the system's own, on a file in the folder: it goes with the process, however that ends. On a file
    system without locks, such as some network drives, nobody is kept out.

    Parameters
    ----------
    folder : pathlib.Path

    Raises
    ------
    InputError
        If another process writes into it.
    OutputError
        If it cannot be made or written.
    """
    path = Path(folder) / FILE
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle = _locked(path)
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise OutputError(f"{folder}: cannot be written ({reason})") from error
    try:
        yield
    finally:
        _release(path, handle)


def _locked(path: Path) -> int:
    """Handle of the locked file; InputError if another process has it."""
    while True:
        handle = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
        try:
            _lock(handle)
            if _is_at(path, handle):
                return handle
        except OSError as error:
            if error.errno not in _TAKEN:
                return handle
            os.close(handle)
            raise InputError(
                Problem(
                    str(path.parent),
                    "is being written by another fem-seal process; wait for it or choose another folder",
                )
            ) from None
        # whoever had it has removed the file since it was opened here: a lock on it keeps nobody out
        os.close(handle)


def _lock(handle: int) -> None:
    if sys.platform == "win32":
        msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)
    else:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)


def _is_at(path: Path, handle: int) -> bool:
    try:
        return os.path.samestat(os.fstat(handle), path.stat())
    except FileNotFoundError:
        return False


def _release(path: Path, handle: int) -> None:
    """Remove the file and let go of it, unless the folder has been deleted and another process is in a new one."""
    if sys.platform == "win32":
        # an open file cannot be removed there, neither by this process nor, once it is another's, by anybody
        os.close(handle)
        with suppress(OSError):
            path.unlink()
        return
    with suppress(OSError):
        if _is_at(path, handle):
            path.unlink()
    os.close(handle)
