"""Write the tables of a case as a TOML file."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fem_seal.case.words import problem
from fem_seal.errors import InputError
from fem_seal.files import write_text

if TYPE_CHECKING:
    from fem_seal.case.case import Case

_FILES = ("file", "files", "trace", "profile", "posterior")
_BARE = re.compile(r"[A-Za-z0-9_-]+")
_NAME = re.compile(r"[\w][\w .+-]*")
_MOST = 1000


def case_text(case: Case, folder: Path, remark: str = "") -> str:
    """A case file with all entries of a case; files named in it are given from a folder.

    Parameters
    ----------
    case : Case
    folder : Path
        Where the file is to stand.
    remark : str
        First line, a comment.
    """
    tables = case.written
    tables.pop("output", None)
    lines = [f"# {line}" for line in remark.splitlines()]
    plain = {key: value for key, value in tables.items() if not isinstance(value, Mapping)}
    lines += [f"{_key(key)} = {_value(value, key, folder)}" for key, value in plain.items()]
    for name, table in tables.items():
        if name in plain:
            continue
        lines += ["", f"[{_key(name)}]"]
        lines += [f"{_key(key)} = {_value(value, key, folder)}" for key, value in table.items()]
    return "\n".join(lines) + "\n"


def _key(key: str) -> str:
    return key if _BARE.fullmatch(key) else json.dumps(key, ensure_ascii=False)


def _value(value: Any, key: str, folder: Path) -> str:
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_key(k)} = {_value(one, k, folder)}" for k, one in value.items()) + " }"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_value(one, key, folder) for one in value) + "]"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return repr(value)
    text = str(value)
    if key in _FILES and Path(text).is_absolute() and Path(text).is_relative_to(folder):
        text = Path(text).relative_to(folder).as_posix()
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def free_name(folder: Path, name: str, suffix: str) -> Path:
    """A path in a folder that nothing stands at yet: a number is added where the name is taken.

    Parameters
    ----------
    folder : Path
    name : str
        Without folders.
    suffix : str
        Such as ".toml"; added unless the name has it.

    Raises
    ------
    InputError
        If the name is none.
    """
    stem = name.strip().removesuffix(suffix)
    if not _NAME.fullmatch(stem) or stem.endswith("."):
        raise InputError(problem("explore_name", name=name))
    for number in range(1, _MOST):
        path = folder / (f"{stem}{suffix}" if number == 1 else f"{stem}-{number}{suffix}")
        if not path.exists():
            return path
    raise InputError(problem("explore_name_taken", times=_MOST - 1, folder=folder, name=name))


def write_case(case: Case, folder: Path, name: str, remark: str = "") -> Path:
    """Write a case into a new file; nothing is written over.

    Parameters
    ----------
    case : Case
    folder : Path
    name : str
        Of the file, see `free_name`.
    remark : str
        First line, a comment.

    Returns
    -------
    Path
    """
    path = free_name(folder, name, ".toml")
    return write_text(path, case_text(case, folder.absolute(), remark))
