"""Contributions of an answer to report, files and terminal: sections, tables, keys, pictures, lines."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from fem_seal.output.prose import fill_sentence, prose
from fem_seal.output.tables import COLUMNS, Column, known_columns
from fem_seal.seal.scenarios import BESIDE
from fem_seal.units import LIQUID, LeakVolume, Unit, fixed_unit, format_digits, trim_zeros, unit_for

if TYPE_CHECKING:
    from fem_seal.answers.case_load import AnyLoad
    from fem_seal.answers.solution import SealSolution
    from fem_seal.output.pictures.style import Picture
    from fem_seal.output.tables import CsvTable


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
    name: str, sentences: Sequence[str], *tables: ReadableTable, **values: object
) -> Section | None:
    """A section with its entry of words.toml under "sections"; None without a sentence.

    Parameters
    ----------
    name : str
    sentences : sequence of str
    *tables : ReadableTable
        In the order of their captions.
    **values
        Values of the {names} in the captions.
    """
    if not sentences:
        return None
    words = prose()["sections"][name]
    captions = (fill_sentence(caption, values) for caption in words["captions"])
    shown = tuple(zip(tables, captions, strict=True))
    return Section(name, words["title"], words["link"], sentences, words["pictures"], shown, words["files"])


@dataclass(frozen=True)
class Shown:
    """Contributions of an answer to the files of a result and to the terminal; each is optional.

    Parameters
    ----------
    asked : callable
        The answers that it shows; where they are empty or None it is asked for nothing.
    summary : callable
        Keys of summary.json with their values.
    absent : mapping
        What stands under these keys where it is asked for nothing; a key that is not here is left out then.
    tables : mapping
        Names of CSV files, and functions for their headings and rows.
    section : callable
        The answer's own section of the report, or None.
    words : mapping
        Names in the template of the report and functions for their values, None where it is asked for nothing.
    pictures : callable
        Its pictures, as far as the result has them.
    lines : callable
        Lines on the terminal.
    """

    asked: Callable[[SealSolution], object] = lambda result: True
    summary: Callable[[SealSolution], dict[str, Any]] = lambda result: {}
    absent: Mapping[str, Any] = field(default_factory=dict)
    tables: Mapping[str, Callable[[SealSolution], CsvTable]] = field(default_factory=dict)
    section: Callable[[SealSolution], Section | None] = lambda result: None
    words: Mapping[str, Callable[[SealSolution], Any]] = field(default_factory=dict)
    pictures: Callable[[SealSolution], Iterable[Picture | None]] = lambda result: ()
    lines: Callable[[SealSolution], Sequence[str]] = lambda result: ()

    def summary_of(self, result: SealSolution) -> Mapping[str, Any]:
        """Keys of summary.json with their values, or what stands there without an answer."""
        return self.summary(result) if self.asked(result) else self.absent

    def words_of(self, result: SealSolution) -> dict[str, Any]:
        """Values for the template of the report by name."""
        has = self.asked(result)
        return {name: value(result) if has else None for name, value in self.words.items()}


# Field of a dataclass with the values of scenarios beside -> name of the value in the file.
_READ = {"others": "leak_rate", "allowed_others": "allowed"}


def by_scenario(value: Any) -> Any:
    """Entries of a dataclass, with a separate entry for each scenario beside."""
    if isinstance(value, (list, tuple)):
        return [by_scenario(one) for one in value]
    if not isinstance(value, dict):
        return value
    found = {name: by_scenario(one) for name, one in value.items() if name not in _READ}
    read = {name: value[name] for name in _READ if name in value}
    return found | {
        f"{_READ[name]}_{one}": others.get(one) for name, others in read.items() for one in BESIDE
    }


@dataclass(frozen=True)
class ReadableTable:
    """A table of the report.

    Parameters
    ----------
    headings : tuple of str
    rows : tuple of tuple of str
    """

    headings: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]

    def __len__(self) -> int:
        """Number of rows."""
        return len(self.rows)


def worded_table(
    name: str, rows: Iterable[Mapping[str, object]], *, without: Collection[str] = (), **values: object
) -> ReadableTable:
    """A table whose headings and cells are sentences of words.toml.

    Parameters
    ----------
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
        tuple(fill_sentence(heading, values) for heading in columns),
        tuple(tuple(fill_sentence(cell, {**values, **row}) for cell in columns.values()) for row in rows),
    )


@dataclass(frozen=True)
class ReportColumn:
    """A column with its values.

    Parameters
    ----------
    column : Column
    values : list of float or None
        One per row, SI.
    digits : list of int
        Significant digits of the values.
    volume : LeakVolume
        State of the leaking volume.
    given_unit : Unit, optional
        That for the largest of the values unless given.
    """

    column: Column
    values: list[float | None]
    digits: list[int]
    volume: LeakVolume = LIQUID
    given_unit: Unit | None = None

    @property
    def some(self) -> bool:
        """Whether any row has a value."""
        return any(value is not None for value in self.values)

    @property
    def unit(self) -> Unit:
        """Unit of all values."""
        if self.given_unit is not None:
            return self.given_unit
        if not self.column.kind:
            return fixed_unit("")
        largest = max(abs(value) for value in self.values if value is not None)
        found = unit_for(self.column.kind, largest)
        return self.volume.name_unit(found) if self.column.kind == "flow" else found


def filled_column(name: str, loads: Sequence[AnyLoad], volume: LeakVolume = LIQUID) -> ReportColumn:
    """A column of leak.csv with the values of loads, None where nothing is known of them."""
    column = COLUMNS[name]
    if name not in known_columns(loads):
        return ReportColumn(column, [None] * len(loads), [0] * len(loads), volume)
    return ReportColumn(
        column, [column.value(load) for load in loads], [column.digits(load) for load in loads], volume
    )


def columns_table(columns: Sequence[ReportColumn], none: str = "none measurable") -> ReadableTable:
    """Columns side by side, one unit in each, without empty ones.

    Parameters
    ----------
    columns : sequence of ReportColumn
    none : str
        Word for what is too little to be measured.
    """
    shown = [one for one in columns if one.some]
    own = {one.column.name: one.unit for one in shown}
    units = [own.get(one.column.unit_like, own[one.column.name]) for one in shown]
    return ReadableTable(
        tuple(
            f"{one.column.heading} [{unit.name}]" if unit.name else one.column.heading
            for one, unit in zip(shown, units, strict=True)
        ),
        tuple(
            tuple(_cell(one, unit, n, none) for one, unit in zip(shown, units, strict=True))
            for n in range(len(columns[0].values))
        ),
    )


def _cell(column: ReportColumn, unit: Unit, n: int, none: str) -> str:
    value = column.values[n]
    if value is None:
        return "–"
    if column.column.name == "fluid_pressure_Pa":
        return trim_zeros(unit.of(value))
    if column.column.kind == "flow" and value and not column.volume.measurable(value):
        return none
    return format_digits(unit.of(value), column.digits[n])
