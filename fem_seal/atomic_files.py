"""Files that are either there in full or not at all."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path

from fem_seal.errors import OutputError


def write_bytes(path: str | os.PathLike[str], chunks: bytes | Iterable[bytes]) -> Path:
    """Write a file in one step: readers see the old content or the new one, never a part of it.

    Parameters
    ----------
    path : path
        File to write or replace; its folder is made if it does not exist.
    chunks : bytes or iterable of bytes
        Content.

    Returns
    -------
    pathlib.Path
        The file written.

    Raises
    ------
    OutputError
        If the file cannot be written; nothing is left behind.
    """
    path = Path(path)
    # In the same folder, because a rename is only atomic within one file system.
    draft = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with draft.open("wb") as file:
            file.writelines([chunks] if isinstance(chunks, bytes) else chunks)
        os.replace(draft, path)
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise OutputError(f"{path}: cannot be written ({reason})") from error
    finally:
        _remove(draft)
    return path


def write_text(path: str | os.PathLike[str], text: str) -> Path:
    """Write a text file (UTF-8, lines ending with a line feed) in one step; see `write_bytes`."""
    return write_bytes(path, text.encode("utf-8"))


def _remove(draft: Path) -> None:
    try:
        draft.unlink(missing_ok=True)
    except OSError:
        # The error that is already on its way says what is wrong with this folder.
        return
