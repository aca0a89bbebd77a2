"""What an answer adds to the files of a result."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from fem_seal.output.prose import filled, prose
from fem_seal.seal.readings import FURTHER

if TYPE_CHECKING:
    from fem_seal.answers.solution import SealSolution
    from fem_seal.output.pictures.style import Picture
    from fem_seal.output.readable import ReadableTable
    from fem_seal.output.tables import CsvTable


@dataclass(frozen=True)
class Section:
    """A section of the report.

    Parameters
    ----------
    name : str
        Of its place on the page, a word.
    title, link : str
        Above it, and in the list of sections.
    sentences : sequence of str
    pictures : sequence of str
        Names of those that stand in it, as far as they are drawn.
    tables : sequence of tuple
        Table and caption; without rows it is left out.
    files : sequence of str
        What stands beside the page, with the program that reads it.
    """

    name: str
    title: str
    link: str
    sentences: Sequence[str] = ()
    pictures: Sequence[str] = ()
    tables: Sequence[tuple[ReadableTable, str]] = ()
    files: Sequence[str] = ()


def worded_section(
    name: str, sentences: Sequence[str], *tables: ReadableTable, **values: object
) -> Section | None:
    """A section with what words.toml says of it under "sections"; None without a sentence.

    Parameters
    ----------
    name : str
    sentences : sequence of str
    *tables : ReadableTable
        In the order of their captions.
    **values
        What stands for {names} in the captions.
    """
    if not sentences:
        return None
    words = prose()["sections"][name]
    captions = (filled(caption, values) for caption in words["captions"])
    shown = tuple(zip(tables, captions, strict=True))
    return Section(name, words["title"], words["link"], sentences, words["pictures"], shown, words["files"])


@dataclass(frozen=True)
class Shown:
    """What an answer adds to the files of a result and to the terminal; nothing unless given.

    Parameters
    ----------
    summary : callable
        Keys of summary.json with their values.
    tables : mapping
        Names of CSV files, with what gives their headings and rows.
    section : callable
        The answer's own section of the report, or None.
    words : callable
        What the template of the report places elsewhere, by names.
    pictures : callable
        Those that there is something to show for.
    lines : callable
        Lines on the terminal.
    """

    summary: Callable[[SealSolution], dict[str, Any]] = lambda result: {}
    tables: Mapping[str, Callable[[SealSolution], CsvTable]] = field(default_factory=dict)
    section: Callable[[SealSolution], Section | None] = lambda result: None
    words: Callable[[SealSolution], dict[str, Any]] = lambda result: {}
    pictures: Callable[[SealSolution], Iterable[Picture | None]] = lambda result: ()
    lines: Callable[[SealSolution], Sequence[str]] = lambda result: ()


# Where a dataclass has what something is in further readings, and what that is called in the file.
_READ = {"others": "leak_rate", "allowed_others": "allowed"}


def by_reading(value: Any) -> Any:
    """Entries of a dataclass, with one of its own for each further reading of yielding asperities."""
    if isinstance(value, (list, tuple)):
        return [by_reading(one) for one in value]
    if not isinstance(value, dict):
        return value
    found = {name: by_reading(one) for name, one in value.items() if name not in _READ}
    read = {name: value[name] for name in _READ if name in value}
    return found | {
        f"{_READ[name]}_{one}": others.get(one) for name, others in read.items() for one in FURTHER
    }
