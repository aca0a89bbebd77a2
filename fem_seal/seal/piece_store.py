"""Finished pieces of direct simulations in the user's cache folder, for every later case with the same face."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from time import sleep
from typing import BinaryIO

from fem_seal.errors import OutputError
from fem_seal.files import UnreadableFileError, read_bytes, write_text

VARIABLE = "FEM_SEAL_CACHE"
# What a small file takes on a disk [bytes].
_BLOCK = 4096
# Between two looks at a lock [s].
_PATIENCE = 0.1


@dataclass(frozen=True)
class PieceStore:
    """Texts by the key of what they say; those that were not read for the longest time go first.

    Parameters
    ----------
    folder : Path
    limit : int
        Of all texts together on the disk [bytes].
    """

    folder: Path
    limit: int = 2 * 10**9

    @classmethod
    def of_user(cls) -> PieceStore | None:
        """In the folder of FEM_SEAL_CACHE, or the one that the system has for it; None where that is empty."""
        folder = os.environ.get(VARIABLE)
        if folder is None:
            with suppress(RuntimeError):  # a user without a home
                return cls(_user_folder() / "fem-seal")
        return cls(Path(folder).expanduser()) if folder else None

    def path(self, key: str) -> Path:
        """Of a text.

        Parameters
        ----------
        key : str
        """
        return self.folder / "pieces" / key[:2] / f"{key}.json"

    def read(self, keys: Sequence[str]) -> list[bytes] | None:
        """Their texts; None unless all are there.

        Parameters
        ----------
        keys : sequence of str
        """
        try:
            texts = [read_bytes(self.path(key)) for key in keys]
        except UnreadableFileError:
            return None
        for key in keys:
            with suppress(OSError):  # it may be removed meanwhile, or belong to somebody else
                os.utime(self.path(key))
        return texts

    def write(self, key: str, text: str) -> None:
        """Keep a text; where the folder cannot be written to, nothing is kept.

        Parameters
        ----------
        key, text : str
        """
        with suppress(OutputError):
            write_text(self.path(key), text)

    @contextmanager
    def lock(self, key: str) -> Iterator[None]:
        """While nobody else has the lock of a key: waits for a process that has it, not for one that has died.

        The system takes the lock from a process with its end. Where files cannot be locked, nobody waits.

        Parameters
        ----------
        key : str
        """
        # so few files that they may stay, so many that hardly two pieces share them
        path = self.folder / "locks" / key[:3]
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            file = path.open("ab")
        except OSError:
            yield
            return
        with file:
            is_locked = _wait_for_lock(file)
            try:
                yield
            finally:
                if is_locked:
                    # a copy of this process that was made meanwhile must not keep it
                    _unlock(file)

    def shrink(self) -> None:
        """Remove what was not read for the longest time, until the rest is within the limit."""
        files = []
        for path in (self.folder / "pieces").glob("*/*"):
            with suppress(OSError):
                about = path.stat()
                files.append((about.st_mtime, -(-about.st_size // _BLOCK) * _BLOCK, path))
        size = sum(length for _, length, _ in files)
        for _, length, path in sorted(files):
            if size <= self.limit:
                return
            with suppress(OSError):
                path.unlink()
            size -= length


def _user_folder() -> Path:
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local")
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches"
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")


if sys.platform == "win32":
    import msvcrt

    def _lock(file: BinaryIO) -> None:
        file.seek(0)
        msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)

    def _unlock(file: BinaryIO) -> None:
        file.seek(0)
        msvcrt.locking(file.fileno(), msvcrt.LK_UNLCK, 1)

else:
    import fcntl

    def _lock(file: BinaryIO) -> None:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)

    def _unlock(file: BinaryIO) -> None:
        fcntl.flock(file, fcntl.LOCK_UN)


def _wait_for_lock(file: BinaryIO) -> bool:
    """Whether it is locked; False where files cannot be."""
    while True:
        try:
            _lock(file)
        except (BlockingIOError, PermissionError):
            sleep(_PATIENCE)
        except OSError:
            return False
        else:
            return True
