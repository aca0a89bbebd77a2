"""The columns of leak.csv: what each takes from a load, and its names on the terminal, in the report and in studies.

columns.toml has unit, headings and meaning of each.
"""

from __future__ import annotations

import difflib
import math
import re
from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from fem_seal.answers.case_load import CaseLoad
from fem_seal.answers.leakage_class import volume_of
from fem_seal.case.tables import curves
from fem_seal.files import own_tables
from fem_seal.seal.load_result import LoadResult, MissingLoad
from fem_seal.seal.scenarios import leak_rate_column
from fem_seal.units import DIGITS, LIQUID, LeakVolume, Unit, format_digits, split_unit, trim_zeros

if TYPE_CHECKING:
    from fem_seal.answers.case_load import AnyLoad
    from fem_seal.case.case import Case
    from fem_seal.case.tables import CaseTables
    from fem_seal.units import Display


@dataclass(frozen=True)
class TerminalColumn:
    """A number on the terminal, always in the same unit.

    Parameters
    ----------
    name : str
        In leak.csv or in ``check --json``.
    heading : str
    shown_in : str
        Unit, see `fem_seal.units.fixed_unit`.
    """

    name: str
    heading: str
    shown_in: str

    def unit_in(self, display: Display) -> Unit:
        """The unit in the system of display."""
        return display.fixed_unit(self.shown_in)


@dataclass(frozen=True)
class Column:
    """A column of leak.csv, the terminal, the report and studies.

    Parameters
    ----------
    name : str
        Name in the files; it ends in the SI unit.
    meaning : str
        Text for the reference of the columns.
    of : str
        Path of the number in a `CaseLoad`, in SI, unless `_OF` has a function for it; the column's name unless given.
    kind : str
        Kind of quantity, see `fem_seal.units.unit_for`; empty for a plain number.
    heading : str
        Heading in the report, without a unit.
    title : str
        Heading on the page of a study; the name in words unless given.
    short, shown_in : str
        Heading on the terminal and the unit there, see `fem_seal.units.fixed_unit`.
    unit_like : str
        Name of a column with the same unit in the report, so that the two can be compared.
    spare_digits : int, optional
        Near opening: significant digits beyond those of the contact force; None if the number does not depend on it.
    belongs : sequence of str
        Tables and keys of the cases whose results have the column, all of them or one of those with "or" between.
    repeats : bool
        Whether it repeats another column, and is not empty, in a case that has its tables but not its keys.
    text : bool
        Whether it holds words.
    most_digits : int
        Largest number of significant digits.
    error_of : str
        Name in `LoadResult.digits_of` of the number with the same error; empty where errors hardly matter.
    """

    name: str
    meaning: str
    of: str = ""
    kind: str = ""
    heading: str = ""
    title: str = ""
    short: str = ""
    shown_in: str = ""
    unit_like: str = ""
    spare_digits: int | None = None
    belongs: Sequence[str] = ()
    repeats: bool = False
    text: bool = False
    most_digits: int = DIGITS
    error_of: str = ""

    def lacking(self, case: CaseTables, varied: Collection[str] = ()) -> list[str]:
        """Those of `belongs` that a case has not.

        Parameters
        ----------
        case : CaseTables
        varied : collection of str
            Paths of the entries that a study varies; what they decide counts as there.
        """
        return [
            source
            for source in self.belongs
            if not any(
                _holds(case, condition) or _is_varied(condition, varied) for condition in source.split(" or ")
            )
        ]

    @property
    def unit(self) -> str:
        """SI unit, empty for a plain number."""
        return split_unit(self.name)[1]

    @property
    def words(self) -> str:
        """Name on the page of a study."""
        return self.title or split_unit(self.name)[0].replace("_", " ")

    @property
    def on_terminal(self) -> TerminalColumn:
        """The column on the terminal."""
        return TerminalColumn(self.name, self.short, self.shown_in)

    def value(self, load: AnyLoad) -> float | None:
        """Number of a load in SI, None where nothing was calculated."""
        if isinstance(load, MissingLoad):
            return load.column_values.get(self.name)
        return (
            _OF[self.name](load) if self.name in _OF else _follow(self.of or split_unit(self.name)[0], load)
        )

    def number(self, load: AnyLoad) -> float:
        """The same, NaN where nothing was calculated."""
        value = self.value(load)
        return math.nan if value is None else float(value)

    def digits(self, load: AnyLoad) -> int:
        """Significant digits at a load."""
        if isinstance(load, MissingLoad):
            return DIGITS
        of_force = DIGITS if self.spare_digits is None else load.digits + self.spare_digits
        of_error = load.digits_of(self.error_of) if self.error_of else DIGITS
        return min(of_force, of_error, self.most_digits)


def _follow(path: str, value: object) -> Any:
    """What stands at the end of a path of attributes; None where it ends before."""
    for name in path.split("."):
        value = getattr(value, name, None)
    return value


def _in_scenario(scenario: str, path: str, load: CaseLoad) -> float | None:
    value: float | None = _follow(path, load.scenario(scenario))
    return value


def _contact_radius(load: CaseLoad) -> float:
    profile = load.tightest
    return float(np.interp(profile.centroid, profile.x, profile.radius))


def _knudsen_number(load: CaseLoad) -> float | None:
    number = None if load.leak is None else load.leak.knudsen_number
    return number if number is not None and math.isfinite(number) else None


def _blow_off_pressure(load: CaseLoad) -> float | None:
    from leak import CoupledLeakResult

    return (load.leak if isinstance(load.leak, CoupledLeakResult) else load).blow_off_pressure


def _plastic_strain(load: CaseLoad) -> float | None:
    from fem_seal.bodies.fields import ElastoplasticField
    from fem_seal.contact.load_path import ElastoplasticContact

    contacts = [part.contact for part in load.parts]
    yielding = [contact for contact in contacts if isinstance(contact, ElastoplasticContact)]
    fields = [field for contact in yielding for field in contact.fields.values()]
    strains = [field.accumulated_plastic_strain for field in fields if isinstance(field, ElastoplasticField)]
    return max((float(strain.max()) for strain in strains), default=None)


def _load_steps(load: CaseLoad) -> int | None:
    return max(getattr(part.contact, "load_steps", 0) for part in load.parts) or None


def _interval_end(load: CaseLoad, which: int) -> float | None:
    """Lower (0) or upper (1) end of the interval of the leak rate [m^3/s]; None without an interval."""
    ends = load.leak_interval
    return ends[which] if ends is not None and load.has_interval else None


def _per_length(name: str, load: CaseLoad) -> float | None:
    """A number of the leak per length of the contact circle, of two different faces the mean of both."""
    radii = [part.contact.model.initial_contact_radius for part in load.parts]
    value = _follow(name, load.leak)
    return None if value is None else value / (2.0 * math.pi * sum(radii) / len(radii))


def _line_load_for_target(load: CaseLoad) -> float | None:
    force = load.contact_force_for_target
    return None if force is None else load.contact.model.line_load(force)


def _across_crests(load: CaseLoad) -> float | None:
    """Leak rate without the thread of a turned face, in the mean of two different faces [m^3/s]."""
    leaks = [
        LoadResult(*part.point, part.contact, part.rough.without_thread, part.circumference).leak
        for part in load.parts
        if part.rough is not None
    ]
    rates = [flow.leak_rate for flow in leaks if flow is not None]
    # the tables of both are points on smooth curves, and the thread takes nothing away
    return min(sum(rates) / len(rates), load.leak.leak_rate) if rates and load.leak is not None else None


def _entry(path: str, place: int, load: CaseLoad) -> float | None:
    """A number of the pair at the end of a path."""
    pair = _follow(path, load)
    return None if pair is None else pair[place]


def _largest_peak(load: CaseLoad) -> float | None:
    return None if load.circumference is None else float(load.circumference.peak_pressure.max())


# Columns of all tables, with their texts.
_TABLES = own_tables("columns.toml")
# Functions of columns whose number does not stand at a path of the load: at "of", or at the name of the column.
_OF: dict[str, Callable[[CaseLoad], float | None]] = {
    "leak_rate_low_m3_per_s": lambda load: _interval_end(load, 0),
    "leak_rate_high_m3_per_s": lambda load: _interval_end(load, 1),
    "blow_off_pressure_Pa": _blow_off_pressure,
    "line_load_for_target_N_per_m": _line_load_for_target,
    "peak_pressure_max_Pa": _largest_peak,
    "contact_radius_m": _contact_radius,
    "max_accumulated_plastic_strain": _plastic_strain,
    "load_steps": _load_steps,
    **{
        leak_rate_column(scenario): partial(_in_scenario, scenario, "leak.leak_rate")
        for scenario in ("elastic", "conserved", "capped", "corrected", "paper")
    },
    "force_for_target_leak_capped_N": partial(_in_scenario, "capped", "force_for_target"),
    "critical_separation_elastic_m": partial(_in_scenario, "elastic", "critical_separation"),
    "leak_rate_round_m3_per_s": lambda load: (
        None if load.circumference is None else _follow("leak_round.leak_rate", load)
    ),
    "leak_rate_crests_m3_per_s": _across_crests,
    "leak_rate_scratches_low_m3_per_s": partial(_entry, "around.scratches", 0),
    "leak_rate_scratches_high_m3_per_s": partial(_entry, "around.scratches", 1),
    "leak_rate_least_preload_m3_per_s": partial(_entry, "at_preload_ends", -1),
    "leak_rate_largest_preload_m3_per_s": partial(_entry, "at_preload_ends", 0),
    "leak_rate_per_length_m2_per_s": partial(_per_length, "leak_rate"),
    "leak_rate_per_length_kg_per_m_s": partial(_per_length, "mass_flow"),
    "leak_rate_per_length_Pa_m2_per_s": partial(_per_length, "throughput"),
    "knudsen_number": _knudsen_number,
}

# What no key of a case says alone, and the part of a path by which a study may vary it.
_CONDITIONS: dict[str, tuple[Callable[[CaseTables], object], str]] = {
    "[uncertainty]": (lambda case: case.sampling, ""),
    'an entry of [uncertainty] with varies = "part"': (
        lambda case: case.uncertainty and case.uncertainty.of_parts,
        "",
    ),
    "a gas in [fluid]": (lambda case: case.fluid and case.fluid.gas, "fluid.name"),
    "a liquid in [fluid]": (lambda case: case.fluid and not case.fluid.gas, "fluid.name"),
    "a thread between crests": (
        lambda case: any(part.roughness and part.roughness.has_thread for part in case.parts),
        "spiral",
    ),
    "fluid.density": (lambda case: case.fluid and case.fluid.density, "fluid."),
    "stress_strain of a material": (curves, "material"),
    "load.applied_force < 0": (
        lambda case: (np.atleast_1d(case.load.applied_force) < 0.0).any(),
        "applied_force",
    ),
    "--all-columns": (lambda case: False, ""),
}


def _holds(case: CaseTables, condition: str) -> bool:
    """Whether a case has "[table]", "key", "key = value" or one of `_CONDITIONS`, or has not "no key"."""
    if condition in _CONDITIONS:
        return bool(_CONDITIONS[condition][0](case))
    path, _, value = condition.removeprefix("no ").partition(" = ")
    entry = _follow(path.strip("[]"), case)
    if value:
        return str(entry).lower() == value.strip('"')
    return bool(entry) != condition.startswith("no ")


def _is_varied(condition: str, paths: Collection[str]) -> bool:
    """Whether a study varies what decides a condition; a table of its own has to stand in the base case."""
    path = condition.removeprefix("no ").partition(" = ")[0]
    _, key = _CONDITIONS.get(condition, (None, "" if path.startswith("[") else path))
    return bool(key) and any(key in path for path in paths)


# Names of the columns of each table; empty ones are left out.
SHOWN_COLUMNS: dict[str, list[str]] = _TABLES["shown"]
# Of a table in brief.
MOST_COLUMNS = 6
COLUMNS = {
    name: Column(name, **(_TABLES["kinds"].get(entry.get("kind"), {}) | entry))
    for name, entry in _TABLES["loads"].items()
}
LEAK_COLUMNS, TEXT_COLUMNS = (
    tuple(name for name, column in COLUMNS.items() if column.text is text) for text in (False, True)
)


def columns_of(
    case: CaseTables, *, of_profile: bool = False, all_columns: bool = False
) -> tuple[Column, ...]:
    """Columns of leak.csv for a case; what its tables say decides, never what was calculated.

    Parameters
    ----------
    case : CaseTables
    of_profile : bool
        Whether the contact is a given pressure profile, which has no bodies.
    all_columns : bool
        Also those that do not belong to the case.
    """
    return tuple(
        column
        for name, column in COLUMNS.items()
        if (not of_profile or name in SHOWN_COLUMNS["of_profiles"])
        and (all_columns or not column.lacking(case))
    )


def column_named(name: object, columns: Iterable[str], case: CaseTables | None = None) -> str:
    """The column that is meant by its name, with or without its SI unit; of several units the first one.

    Parameters
    ----------
    name : str
    columns : iterable of str
        Of the table.
    case : CaseTables, optional
        That of a result, whose tables decide which columns there are.

    Raises
    ------
    KeyError
        If there is none; it says what brings the column, or which are spelled like it.

    Examples
    --------
    >>> column_named("leak_rate", LEAK_COLUMNS)
    'leak_rate_m3_per_s'
    """
    full, any_column = _by_name(columns), _by_name(COLUMNS)
    if name in full:
        return full[str(name)]
    if name in any_column:
        column = COLUMNS[any_column[str(name)]]
        missing = [] if case is None else column.lacking(case)
        sources = f"it comes with {' and '.join(missing)}; result.all_columns has every column"
        raise KeyError(
            f"{column.name} is not in this table: {sources if missing else 'no response names it'}"
        )
    near = difflib.get_close_matches(str(name), full, n=3, cutoff=0.5)
    hint = f"do you mean {' or '.join(near)}? " if near else ""
    raise KeyError(f'there is no column "{name}"; {hint}.table.columns has all of them')


def _by_name(columns: Iterable[str]) -> dict[str, str]:
    """Columns by their names with and without the SI unit."""
    full = list(columns)
    return {split_unit(name)[0]: name for name in reversed(full)} | {name: name for name in full}


def in_full(text: str, taken: Collection[str] = ()) -> str:
    """A formula with the columns in it that stand there without their SI unit named in full.

    Parameters
    ----------
    text : str
        What stands in quotes stays.
    taken : collection of str
        Names that mean something else.

    Examples
    --------
    >>> in_full('leak_rate / "1 ml/min" + peak_pressure_Pa')
    'leak_rate_m3_per_s / "1 ml/min" + peak_pressure_Pa'
    """
    full_names = {split_unit(column)[0]: column for column in reversed(LEAK_COLUMNS)}
    return _NAME.sub(lambda name: name[0] if name[0] in taken else full_names.get(name[0], name[0]), text)


# Words that are no part of a path such as seat.angle, and no function; quotes as a whole.
_NAME = re.compile(r"""\"[^"]*\"|'[^']*'|(?<![\w.])[A-Za-z_]\w*(?![\w.(])""")


def in_words(display: Display, load: CaseLoad, name: str) -> str:
    """A number of a load for a sentence: with its unit, and no more digits than in the tables.

    Parameters
    ----------
    display : Display
    load : CaseLoad
    name : str
        Of a column with a kind of quantity.
    """
    column = COLUMNS[name]
    return display.quantity(column.number(load), f"worth {column.kind} {column.digits(load)}")


# Columns of the loads on the terminal.
LEAK_ON_TERMINAL = tuple(column.on_terminal for column in COLUMNS.values() if column.short)
# Rows of `fem-seal check` for the case as a whole: name and unit by the key in its JSON.
CHECK_OF_CASE: dict[str, tuple[str, str]] = _TABLES["of_the_case"]
# Columns of `fem-seal check` for the loads: those known before a solve, and the closed forms.
CHECK_ON_TERMINAL = (
    *(COLUMNS[name].on_terminal for name in ("fluid_pressure_Pa", "contact_force_N", "line_load_N_per_m")),
    *(TerminalColumn(name, heading, unit) for name, (heading, unit) in _TABLES["closed_forms"].items()),
    *(COLUMNS[name].on_terminal for name in ("blow_off_pressure_Pa", "force_for_target_leak_N")),
)


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


@dataclass(frozen=True)
class ReportColumn:
    """A column with its values.

    Parameters
    ----------
    display : Display
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

    display: Display
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
            return Unit("", 1.0)
        largest = max(abs(value) for value in self.values if value is not None)
        unit = self.display.unit_for(self.column.kind, largest)
        return self.display.name_unit(unit, self.volume) if self.column.kind == "flow" else unit


def filled_columns(case: Case, names: Iterable[str], loads: Sequence[AnyLoad]) -> list[ReportColumn]:
    """Columns of leak.csv with the values of loads, as far as they belong to the case.

    Parameters
    ----------
    case : Case
    names : iterable of str
    loads : sequence of CaseLoad or MissingLoad
    """
    of_profile = any(isinstance(load, CaseLoad) and load.of_profile for load in loads)
    columns = {column.name: column for column in columns_of(case, of_profile=of_profile)}
    return [
        ReportColumn(
            case.display,
            columns[name],
            [columns[name].value(load) for load in loads],
            [columns[name].digits(load) for load in loads],
            volume_of(case),
        )
        for name in names
        if name in columns
    ]


def columns_table(columns: Sequence[ReportColumn], none: str = "none measurable") -> ReadableTable:
    """Columns side by side, one unit in each, without empty ones.

    Parameters
    ----------
    columns : sequence of ReportColumn
    none : str
        Word for what is too little to be measured.
    """
    filled = [column for column in columns if column.some]
    unit_of = {column.column.name: column.unit for column in filled}
    units = [unit_of.get(column.column.unit_like, unit_of[column.column.name]) for column in filled]
    return ReadableTable(
        tuple(
            f"{column.column.heading} [{unit.name}]" if unit.name else column.column.heading
            for column, unit in zip(filled, units, strict=True)
        ),
        tuple(
            tuple(_cell(column, unit, n, none) for column, unit in zip(filled, units, strict=True))
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
