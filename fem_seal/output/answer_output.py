"""Contributions of an answer to report, files and terminal: sections, tables, keys, pictures, lines."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from fem_seal.files import own_tables
from fem_seal.output.columns import ReadableTable
from fem_seal.seal.findings import Level
from fem_seal.seal.scenarios import BESIDE
from fem_seal.wording import fill

if TYPE_CHECKING:
    from fem_seal.answers.case_load import CaseLoad
    from fem_seal.answers.solution import SealSolution
    from fem_seal.output.pictures.style import Picture
    from fem_seal.output.tables import CsvTable
    from fem_seal.units import Display


def prose() -> dict[str, Any]:
    """The whole file: "definitions", "tables", "sources" and the other groups."""
    return own_tables("words.toml")


@dataclass(frozen=True)
class Section:
    """A section of the report.

    Parameters
    ----------
    name : str
        Anchor on the page, a word.
    title, link : str
        Heading, and entry in the list of sections.
    sentences : sequence of str
    pictures : sequence of str
        Names of its pictures; those not drawn are left out.
    tables : sequence of tuple
        Table and caption; without rows it is left out.
    files : sequence of str
        Files next to the page, with the program that reads them.
    """

    name: str
    title: str
    link: str
    sentences: Sequence[str] = ()
    pictures: Sequence[str] = ()
    tables: Sequence[tuple[ReadableTable, str]] = ()
    files: Sequence[str] = ()


def worded_section(
    display: Display, name: str, sentences: Sequence[str], *tables: ReadableTable, **values: object
) -> Section | None:
    """A section with its entry of words.toml under "sections"; None without a sentence and a row.

    Parameters
    ----------
    display : Display
    name : str
    sentences : sequence of str
    *tables : ReadableTable
        In the order of their captions.
    **values
        Values of the {names} in the captions.
    """
    if not sentences and not any(table.rows for table in tables):
        return None
    words = prose()["sections"][name]
    captions = (fill(display, caption, **values) for caption in words["captions"])
    captioned_tables = tuple(zip(tables, captions, strict=True))
    return Section(
        name, words["title"], words["link"], sentences, words["pictures"], captioned_tables, words["files"]
    )


@dataclass(frozen=True)
class Tile:
    """A number with its name, as the report and the live page show it at the top.

    Parameters
    ----------
    name, value : str
    remark : str
        At most twelve words.
    rank : int
        Tiles with a small rank come first; the page has room for six.
    level : Level
        How far the number can be trusted.
    """

    name: str
    value: str
    remark: str = ""
    rank: int = 9
    level: Level = Level.VALID


def decisive(result: SealSolution) -> CaseLoad:
    """The load that decides the verdict; without a requirement that with the highest fluid pressure.

    Parameters
    ----------
    result : SealSolution
    """
    judgement = result.judgement
    return result.highest if judgement is None or judgement.number is None else result.loads[judgement.number]


@dataclass(frozen=True)
class AnswerPage:
    """What an answer says of a result to report, terminal and live page; everything is optional.

    Parameters
    ----------
    first : sequence of str
        Below the verdict, at most one line.
    tiles : sequence of Tile
    why : sequence of str
        Reasons for the result, at most two.
    decides : sequence of str
        What decides the result or would change it, at most one.
    picture : str
        Name of the picture that may stand on the short page.
    backing : sequence of str
        What backs the interval, below the warnings.
    section : Section, optional
        On the full page.
    details : sequence of str
        On the terminal, where details are asked for.
    """

    first: Sequence[str] = ()
    tiles: Sequence[Tile] = ()
    why: Sequence[str] = ()
    decides: Sequence[str] = ()
    picture: str = ""
    backing: Sequence[str] = ()
    section: Section | None = None
    details: Sequence[str] = ()


@dataclass(frozen=True)
class AnswerOutput:
    """Contributions of an answer to the files of a result and to the terminal; each is optional.

    Parameters
    ----------
    answers : callable
        The answers that it shows; where they are empty or None it is asked for nothing.
    summary : callable
        Keys of summary.json with their values.
    absent : mapping
        What stands under these keys where it is asked for nothing; a key that is not here is left out then.
    tables : mapping
        Names of CSV files, and functions for their headings and rows.
    pictures : callable
        Its pictures, as far as the result has them.
    page : callable
        What it says of a result in the units of a display.
    """

    answers: Callable[[SealSolution], object] = lambda result: True
    summary: Callable[[SealSolution], dict[str, Any]] = lambda result: {}
    absent: Mapping[str, Any] = field(default_factory=dict)
    tables: Mapping[str, Callable[[SealSolution], CsvTable]] = field(default_factory=dict)
    pictures: Callable[[SealSolution], Iterable[Picture | None]] = lambda result: ()
    page: Callable[[SealSolution, Display], AnswerPage] = lambda result, display: AnswerPage()

    def page_of(self, result: SealSolution, display: Display) -> AnswerPage:
        """What it says of a result; nothing without an answer."""
        return self.page(result, display) if self.answers(result) else AnswerPage()

    def summary_of(self, result: SealSolution) -> Mapping[str, Any]:
        """Keys of summary.json with their values, or what stands there without an answer."""
        return self.summary(result) if self.answers(result) else self.absent


# Field of a dataclass with the values of scenarios beside -> name of the value in the file.
_READ = {"others": "leak_rate", "allowed_others": "allowed"}


def by_scenario(value: Any) -> Any:
    """Entries of a dataclass, with a separate entry for each scenario beside."""
    if isinstance(value, (list, tuple)):
        return [by_scenario(entry) for entry in value]
    if not isinstance(value, dict):
        return value
    entries = {name: by_scenario(entry) for name, entry in value.items() if name not in _READ}
    read = {name: value[name] for name in _READ if name in value}
    return entries | {
        f"{_READ[name]}_{scenario}": others.get(scenario)
        for name, others in read.items()
        for scenario in BESIDE
    }


def worded_table(
    display: Display,
    name: str,
    rows: Iterable[Mapping[str, object]],
    *,
    without: Collection[str] = (),
    **values: object,
) -> ReadableTable:
    """A table whose headings and cells are sentences of words.toml.

    Parameters
    ----------
    display : Display
    name : str
        Of the table in words.toml, under "tables".
    rows : iterable of mapping
        Values of the {names} in the cells of each row.
    without : collection of str
        Headings of columns that are left out, as in the file.
    **values
        Values of the {names} in headings and all rows.
    """
    columns = {key: cell for key, cell in prose()["tables"][name].items() if key not in without}
    return ReadableTable(
        tuple(fill(display, heading, **values) for heading in columns),
        tuple(tuple(fill(display, cell, **{**values, **row}) for cell in columns.values()) for row in rows),
    )
