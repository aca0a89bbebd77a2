"""Write the tables of a case as a TOML file."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from fem_seal.case.material_table import as_table
from fem_seal.case.words import problem
from fem_seal.errors import InputError
from fem_seal.files import write_text
from fem_seal.materials import Material

# Keys of all tables at which a file is named.
FILES = ("file", "files", "trace", "profile", "posterior")
_BARE = re.compile(r"[A-Za-z0-9_-]+")
_NAME = re.compile(r"[\w][\w .+-]*")
_MOST = 1000


def names_files(path: str) -> bool:
    """Whether the entry at a dotted path is a file, or several.

    Parameters
    ----------
    path : str
    """
    return path.split(".")[-1] in FILES


def with_files(entry: Any, change: Callable[[str], str], path: str = "") -> Any:
    """Tables of a case in which each file that they name is replaced by what a function makes of it.

    Parameters
    ----------
    entry : mapping
    change : callable
    path : str
        Of the entry.
    """
    if isinstance(entry, Mapping):
        return {key: with_files(value, change, key) for key, value in entry.items()}
    if isinstance(entry, (list, tuple)):
        return [with_files(value, change, path) for value in entry]
    return change(str(entry)) if isinstance(entry, (str, Path)) and names_files(path) else entry


def case_text(tables: Mapping[str, Any], folder: Path, remark: str = "") -> str:
    """A case file with all entries of a case; files named in it are given from a folder.

    Parameters
    ----------
    tables : mapping
        Of the case, as `Case.written` has them; where the results go is left out.
    folder : Path
        Where the file is to stand.
    remark : str
        First line, a comment.
    """
    tables = {name: one for name, one in tables.items() if name != "output" and one is not None}
    lines = [f"# {line}" for line in remark.splitlines()]
    plain = {key: value for key, value in tables.items() if not isinstance(value, Mapping)}
    lines += [f"{_key(key)} = {_value(value, key, folder)}" for key, value in plain.items()]
    for name, table in tables.items():
        if name in plain:
            continue
        lines += ["", f"[{_key(name)}]"]
        lines += [f"{_key(key)} = {_value(value, key, folder)}" for key, value in _given(table)]
    return "\n".join(lines).lstrip("\n") + "\n"


def _given(table: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    return ((key, value) for key, value in table.items() if value is not None)


def _key(key: str) -> str:
    return key if _BARE.fullmatch(key) else json.dumps(key, ensure_ascii=False)


def _value(value: Any, key: str, folder: Path) -> str:
    if isinstance(value, Material):
        value = as_table(value)
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_key(k)} = {_value(one, k, folder)}" for k, one in _given(value)) + " }"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_value(one, key, folder) for one in value) + "]"
    if isinstance(value, (bool, int, float)):
        return json.dumps(value)
    text = str(value)
    if key in FILES and Path(text).is_absolute() and Path(text).is_relative_to(folder):
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


def write_case(tables: Mapping[str, Any], folder: Path, name: str, remark: str = "") -> Path:
    """Write a case into a new file; nothing is written over.

    Parameters
    ----------
    tables : mapping
        Of the case, see `case_text`.
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
    return write_text(path, case_text(tables, folder.absolute(), remark))
