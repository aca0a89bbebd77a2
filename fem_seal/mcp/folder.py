"""The one folder that an assistant may have files read from and written into."""

from __future__ import annotations

import csv
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fem_seal.case.case import Case, load_case
from fem_seal.errors import InputError
from fem_seal.files import TomlError, parse_toml, problem, read_any_text, read_text, read_toml, write_text

# Far beyond a case, a study, or a table that a person hands over; an answer repeats it.
MOST_BYTES = 256 * 1024
# Meshes that are lists of other files, and that name files with their arrays.
_NAME_OTHERS = (".vtm", ".pvtu", ".pvd", ".xdmf")
_FREE_TEXTS = ("title",)


@dataclass(frozen=True)
class Folder:
    """A folder that nothing leads out of: not "..", no absolute path, no symbolic link.

    Parameters
    ----------
    root : Path
        Without symbolic links, see `folder_at`.
    """

    root: Path

    def inside(self, name: str, key: str, beside: Path | None = None) -> Path:
        """Where a name leads; InputError if that is outside.

        Parameters
        ----------
        name : str
            From the folder, or from the one beside which it is looked for.
        key : str
            What has this name, for the message.
        beside : Path, optional
        """
        try:
            path = ((beside or self.root) / name).resolve()
        except (OSError, RuntimeError, ValueError):  # a link in a circle, no name of a file
            path = Path()
        if not path.is_relative_to(self.root):
            raise InputError(problem("mcp_outside", key=key, name=name, folder=self.root))
        return path

    def new(self, name: str, key: str) -> Path | None:
        """Where something new is to be written, None without a name; InputError if it is there already."""
        if not name:
            return None
        path = self.inside(name, key)
        if path.exists():
            raise InputError(problem("mcp_there", key=key, name=name))
        return path

    def shown(self, path: Path) -> str:
        """A path as an assistant names it."""
        return path.relative_to(self.root).as_posix()

    def case(self, case_path: str, case_toml: str) -> tuple[Case, str]:
        """A case and its text, of a file or the text itself.

        Parameters
        ----------
        case_path, case_toml : str
            One of them is empty.
        """
        path, text, tables = self.tables("case", case_path, case_toml)
        return load_case(tables if path is None else path), text

    def tables(self, kind: str, name: str, text: str) -> tuple[Path | None, str, dict[str, Any]]:
        """File, text and tables of a case or study; no file that they name is outside.

        Parameters
        ----------
        kind : str
            "case" or "study".
        name, text : str
            Of a file, or the text itself; one of them is empty.
        """
        path = self._one_of(kind, f"{kind}_toml", name, text)
        try:
            tables = parse_toml(text) if path is None else read_toml(path, kind)
        except TomlError as error:
            raise InputError.at(f"{kind}_toml", str(error)) from None
        if path is not None:
            text = read_text(path)
            _check_length(text, f"{kind}_path")
        beside = self.root if path is None else path.parent
        for key, entry in _texts(tables):
            self.inside(entry, key, beside)
        if kind == "study":
            self._check_study(tables, beside)
        return path, text, tables

    def _check_study(self, tables: Mapping[str, Any], beside: Path) -> None:
        """Look into the files of a study that name others: its case, and its list of designs."""
        if isinstance(base := tables.get("base"), str):
            self.tables("case", str(beside / base), "")
        design = tables.get("design")
        if isinstance(design, Mapping) and isinstance(name := design.get("file"), str):
            for row in csv.reader(read_any_text(beside / name).splitlines()):
                for cell in row:
                    self.inside(cell.strip(), "design.file", beside)

    def file(self, kind: str, name: str, text: str, place: Path) -> Path:
        """A table of a file, or of a text, which is written into a place for drafts.

        Parameters
        ----------
        kind : str
            "profile" or "measured".
        name, text : str
            One of them is empty.
        place : Path
        """
        path = self._one_of(kind, f"{kind}_csv", name, text)
        if path is None:
            return write_text(place / f"{kind}.csv", text)
        if path.suffix.lower() in _NAME_OTHERS:
            raise InputError(problem("mcp_names_others", key=f"{kind}_path", name=name))
        return path

    def _one_of(self, kind: str, other: str, name: str, text: str) -> Path | None:
        if bool(name) == bool(text):
            raise InputError(problem("mcp_one_of", key=f"{kind}_path", other=other, given=bool(name)))
        _check_length(text, other)
        return self.inside(name, f"{kind}_path") if name else None


def _check_length(text: str, key: str) -> None:
    if len(text.encode()) > MOST_BYTES:
        raise InputError(problem("mcp_long", key=key, most=MOST_BYTES // 1024))


def folder_at(path: Path) -> Folder:
    """The folder at a path; InputError if there is none."""
    if not path.is_dir() or not os.access(path, os.W_OK):
        raise InputError.at("--folder", "is no folder that can be written; name one", str(path))
    return Folder(path.resolve())


def _texts(entry: Any, key: str = "") -> Iterator[tuple[str, str]]:
    """All texts of a file: each may be the name of another file, also under a key that is not known today."""
    if isinstance(entry, Mapping):
        for name, value in entry.items():
            if key or name not in _FREE_TEXTS:
                yield from _texts(value, f"{key}.{name}".lstrip("."))
    elif isinstance(entry, list):
        for value in entry:
            yield from _texts(value, key)
    elif isinstance(entry, str):
        yield key, entry
