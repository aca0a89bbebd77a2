"""Folders for results: one process at a time, and new files that take the place of old ones together.

A process may die at any moment. While it writes, the old files stand; while files change places, which takes
milliseconds, a file says that the folder is unfinished, and stays if that is never finished.
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
from fem_seal.files import write_text

if sys.platform == "win32":
    import msvcrt
else:
    import fcntl

FILE = ".fem-seal-lock"
# What the systems say if another process has the lock; anything else means that this file system has no locks.
_TAKEN = (errno.EWOULDBLOCK, errno.EAGAIN, errno.EACCES, errno.EDEADLK)


@contextmanager
def folder_lock(folder: Path) -> Iterator[None]:
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
            raise InputError.at(
                str(path.parent),
                "is being written by another fem-seal process; wait for it or choose another folder",
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


UNFINISHED = "UNFINISHED.txt"
_DRAFT = ".fem-seal-draft"

# All files that a run may write, but the tables of its answers: those that the last one did not write are of an earlier
# one.
_OF_A_RUN = re.compile(
    r"(leak|profile|imprint)\.csv|summary\.json|report\.html|mesh\.msh"
    r"|(contact|contact_line|around)\.pvd|contact_\d{3,}\.vtu|(contact_line|around)_\d{3,}\.vtp|unloaded\.vtu"
)

_KILLED = (
    "The results in this folder are not complete, or of two runs: fem-seal was stopped while it moved new files in. "
    "Do not use them; run the case again."
)
_MIXED = (
    "{new} in this folder is newer than the other results and of another calculation; run the case again."
)


@contextmanager
def replaced_together(folder: Path, *, whole: bool = True, tables: Collection[str] = ()) -> Iterator[Path]:
    """Give a folder to write results into, and at the end move them to `folder`, all of them or none.

    The draft stands in `folder` itself, so that its files can take their places by being renamed, whatever file system
    that is. Other files of the user are left alone. The caller sees to it that nobody else writes, see
    `fem_seal.output.folders`.

    Parameters
    ----------
    folder : pathlib.Path
        Made if it does not exist.
    whole : bool
        Whether the new files are all results of a run, so that other results are those of an earlier one and are
        removed. If not, such results stay, and if the new ones differ from what stood there, ``UNFINISHED.txt`` says
        that they do not belong together.
    tables : collection of str
        Names of the files that an answer of a run may have.

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
    # the same files may stand there already
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
    """Move the old files out and the new ones in; if one of them cannot be moved, all are put back.

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
