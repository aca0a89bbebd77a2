"""Result folders: one process at a time writes, and new files replace the old ones together.

A process may die at any moment. While it writes, the old files stay; while files are exchanged, which takes
milliseconds, a file marks the folder as unfinished, and it remains if the exchange is interrupted.
"""

from __future__ import annotations

import errno
import filecmp
import os
import re
import shutil
import sys
from collections.abc import Collection, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from fem_seal.errors import InputError, OutputError
from fem_seal.files import problem, write_text

if sys.platform == "win32":
    import msvcrt
else:
    import fcntl

FILE = ".fem-seal-lock"
# Error numbers of a lock held by another process; any other number means that the file system has no locks.
_TAKEN = (errno.EWOULDBLOCK, errno.EAGAIN, errno.EACCES, errno.EDEADLK)


@contextmanager
def folder_lock(folder: Path) -> Iterator[None]:
    """Lock a folder against other processes; it is created if it does not exist.

    The operating system locks a file in the folder and releases it when the process ends, for whatever reason. A file
    system without locks, such as some network drives, gives no protection.

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
        handle = _open_locked(path)
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise OutputError(f"{folder}: cannot be written ({reason})") from error
    try:
        yield
    finally:
        _release(path, handle)


def _open_locked(path: Path) -> int:
    """Handle of the locked file; InputError if another process has it."""
    while True:
        handle = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
        try:
            _lock(handle)
            if _is_same_file(path, handle):
                return handle
        except OSError as error:
            if error.errno not in _TAKEN:
                return handle
            os.close(handle)
            raise InputError(problem("folder_in_use", folder=path.parent)) from None
        # the previous owner has removed the file since it was opened here: a lock on it has no effect
        os.close(handle)


def _lock(handle: int) -> None:
    if sys.platform == "win32":
        msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)
    else:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)


def _is_same_file(path: Path, handle: int) -> bool:
    try:
        return os.path.samestat(os.fstat(handle), path.stat())
    except FileNotFoundError:
        return False


def _release(path: Path, handle: int) -> None:
    """Remove the lock file and release it, unless the folder was deleted and another process uses a new one."""
    if sys.platform == "win32":
        # on Windows an open file cannot be removed
        os.close(handle)
        with suppress(OSError):
            path.unlink()
        return
    with suppress(OSError):
        if _is_same_file(path, handle):
            path.unlink()
    os.close(handle)


UNFINISHED = "UNFINISHED.txt"
_DRAFT = ".fem-seal-draft"

# All files that a run may write, except the tables of its answers: those that the last run did not write are from an
# earlier one.
_OF_A_RUN = re.compile(
    r"(leak|contacts|profile|imprint)\.csv|summary\.json|report\.html|result\.bin|mesh\.msh"
    r"|(contact|contact_line|around)\.pvd|contact_\d{3,}\.vtu|(contact_line|around)_\d{3,}\.vtp|unloaded\.vtu"
)

_KILLED = (
    "The results in this folder are incomplete or from two runs: fem-seal was stopped while it moved new files in. "
    "Do not use them; run the case again."
)
_MIXED = (
    "{new} in this folder is newer than the other results and from another calculation; run the case again."
)


@contextmanager
def replaced_together(folder: Path, *, whole: bool = True, tables: Collection[str] = ()) -> Iterator[Path]:
    """Provide a draft folder for results, and at the end move them to `folder`, all of them or none.

    The draft is inside `folder`, so that its files are moved by renaming on any file system. Other files of the user
    are left alone. The caller holds the lock, see `folder_lock`.

    Parameters
    ----------
    folder : pathlib.Path
        Made if it does not exist.
    whole : bool
        Whether the new files are all results of a run, so that results of an earlier one are removed. If not, those
        stay, and if a new file differs from the old one, ``UNFINISHED.txt`` says that they do not belong together.
    tables : collection of str
        Names of the tables that the answers of a run may write.

    Raises
    ------
    OutputError
        If the files cannot be written or moved; the old ones are then still there.
    """
    folder = Path(folder)
    draft = folder / _DRAFT
    try:
        if draft.exists():  # of a process that was killed
            shutil.rmtree(draft)
        draft.mkdir(parents=True)
        yield draft
        _move(draft, folder, whole, tables)
    except OutputError as error:
        # the draft is gone when this is read
        raise OutputError(str(error).replace(str(draft), str(folder))) from error
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        moved = isinstance(error.filename, str) and error.filename != str(draft)
        place = folder / Path(error.filename).name if moved else folder
        raise OutputError(f"{place}: cannot be written ({reason})") from error
    finally:
        shutil.rmtree(draft, ignore_errors=True)


def unfinished(folder: Path) -> str | None:
    """Why the results in a folder do not belong together; None if they do."""
    with suppress(OSError):
        return (folder / UNFINISHED).read_text(encoding="utf-8").strip()
    return None


def _move(draft: Path, folder: Path, whole: bool, tables: Collection[str]) -> None:
    new = {path.name for path in draft.iterdir()}
    there = {path.name for path in folder.iterdir() if not path.is_dir()}
    others = {name for name in there - new if _OF_A_RUN.fullmatch(name) or name in tables}
    # the same files may be there already
    if not whole and not any(filecmp.cmpfiles(draft, folder, new, shallow=False)[1:]):
        return
    before = unfinished(folder)
    _mark(folder, _KILLED)
    try:
        _exchange(draft, folder, new, there & new | (others if whole else set()))
    except BaseException:
        _mark(folder, before)
        raise
    mixed = not whole and others and any(map(_OF_A_RUN.fullmatch, new))
    _mark(folder, _MIXED.format(new=" and ".join(sorted(new))) if mixed else None)


def _mark(folder: Path, text: str | None) -> None:
    if text is None:
        (folder / UNFINISHED).unlink(missing_ok=True)
    else:
        write_text(folder / UNFINISHED, text + "\n")


def _exchange(draft: Path, folder: Path, new: Collection[str], old: Collection[str]) -> None:
    """Move the old files out and the new ones in; if one cannot be moved, all are put back.

    On Windows no file can be moved that another program has open.
    """
    aside = draft / "old"
    aside.mkdir()
    touched: list[str] = []
    try:
        for name in sorted({*new, *old}):
            touched.append(name)
            if name in old:
                os.replace(folder / name, aside / name)
            if name in new:
                os.replace(draft / name, folder / name)
    except BaseException:
        for name in touched:
            with suppress(OSError):
                if name in new and not (draft / name).exists():
                    os.replace(folder / name, draft / name)
                if name in old and (aside / name).exists():
                    os.replace(aside / name, folder / name)
        raise
