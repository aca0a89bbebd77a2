"""The tables of a result: their columns, the numbers that each column takes from a load, and their files.

leak.csv, the terminal, the report, studies and the manual all choose from the same columns; columns.toml has unit,
headings and meaning of each.
"""

from __future__ import annotations

import csv
import difflib
import io
import math
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from operator import attrgetter
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fem_seal.answers.case_load import AnyLoad, CaseLoad
from fem_seal.answers.leakage_class import leakage_classes, nominal_size
from fem_seal.files import own_tables, write_bytes
from fem_seal.seal.findings import (
    NOT_CALCULATED,
    VALID,
    VALIDITY_COLUMNS,
    Validity,
    validity_entries,
    why_missing,
)
from fem_seal.seal.load_result import MissingLoad, in_order
from fem_seal.seal.scenarios import BESIDE, SCENARIOS, force_column, leak_rate_column
from fem_seal.units import DIGITS, Unit, fixed_unit, quantity_worth, split_unit
from leak.standards import STANDARDS, Standard

if TYPE_CHECKING:
    import pandas as pd
    from numpy.typing import NDArray

    from fem_seal.answers.case_load import AnyLoad, CaseLoad
    from fem_seal.answers.judgement import Verdict
    from fem_seal.answers.solution import SealSolution
    from fem_seal.case.case import Case
    from fem_seal.seal.load_result import MissingLoad
    from leak import LeakResult


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

    @property
    def unit(self) -> Unit:
        """The unit in the system of display."""
        return fixed_unit(self.shown_in)


@dataclass(frozen=True)
class Column:
    """A column of leak.csv, the terminal, the report and studies.

    Parameters
    ----------
    name : str
        Name in the files; it ends in the SI unit.
    kind : str
        Kind of quantity, see `fem_seal.units.unit_for`; empty for a plain number.
    meaning : str
        Text for the reference of the columns.
    of : callable
        Function of a `CaseLoad`: the number in SI, None where nothing was calculated.
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
    needs : sequence of str
        Tables of the case without which the column stays empty.
    most_digits : int
        Largest number of significant digits.
    error_of : str
        Name in `LoadResult.digits_of` of the number with the same error; empty where errors hardly matter.
    """

    name: str
    kind: str
    meaning: str
    of: Callable[[CaseLoad], float | None]
    heading: str = ""
    title: str = ""
    short: str = ""
    shown_in: str = ""
    unit_like: str = ""
    spare_digits: int | None = None
    needs: Sequence[str] = ()
    most_digits: int = DIGITS
    error_of: str = ""

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
        return load.given.get(self.name) if isinstance(load, MissingLoad) else self.of(load)

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


def _leak_rate_in(scenario: str, load: CaseLoad) -> float | None:
    read = load.scenario(scenario)
    return None if read is None else _rate(read.leak)


def _force_in(scenario: str, load: CaseLoad) -> float | None:
    return load.scenarios[scenario].force_for_target if scenario in load.scenarios else None


def _critical_separation_in(scenario: str, load: CaseLoad) -> float | None:
    read = load.scenario(scenario)
    return None if read is None else read.critical_separation


def _rate(leak: LeakResult | None) -> float | None:
    return None if leak is None else leak.leak_rate


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

    contacts = [one.contact for one in load.contact_loads]
    yielding = [one for one in contacts if isinstance(one, ElastoplasticContact)]
    fields = [one for contact in yielding for one in contact.fields.values()]
    strains = [one.accumulated_plastic_strain for one in fields if isinstance(one, ElastoplasticField)]
    return max((float(strain.max()) for strain in strains), default=None)


def _load_steps(load: CaseLoad) -> int | None:
    return max(getattr(one.contact, "load_steps", 0) for one in load.contact_loads) or None


def _interval_end(load: CaseLoad, which: int) -> float | None:
    """Lower (0) or upper (1) end of the interval of the leak rate [m^3/s]; None without an interval."""
    ends = load.leak_interval
    return ends[which] if ends is not None and load.has_interval else None


def _per_length(load: CaseLoad, value: float | None) -> float | None:
    """A number per length of the circle of first touch, of two different faces the mean of both."""
    radii = [one.contact.model.initial_contact_radius for one in load.contact_loads]
    return None if value is None else value / (2.0 * math.pi * sum(radii) / len(radii))


def _line_load_for_target(load: CaseLoad) -> float | None:
    force = load.contact_force_for_target
    return None if force is None else load.contact.model.line_load(force)


def _of_bolt(name: str) -> Callable[[CaseLoad], float | None]:
    return lambda load: getattr(load.bolts, name, None) if isinstance(load, CaseLoad) else None


def _preload_end(load: CaseLoad, which: int) -> float | None:
    """Leak rate at the end of the preload where it is least (0) or largest (-1) [m^3/s]."""
    return None if load.at_preload_ends is None else load.at_preload_ends[which]


def _of_scratches(load: CaseLoad, which: int) -> float | None:
    around = load.around
    return None if around is None or around.scratches is None else around.scratches[which]


def _of_judged(name: str) -> Callable[[CaseLoad], float | None]:
    return lambda load: getattr(load, name) if isinstance(load, CaseLoad) else None


# Texts of the columns of all tables.
_SAID = own_tables("columns.toml")
# Functions of columns whose number is not the property of the load with the name of the column.
_OF: dict[str, Callable[[CaseLoad], float | None]] = {
    "contact_radius_m": _contact_radius,
    "leak_rate_m3_per_s": lambda load: _rate(load.leak),
    "leak_rate_low_m3_per_s": lambda load: _interval_end(load, 0),
    "leak_rate_high_m3_per_s": lambda load: _interval_end(load, 1),
    "leak_rate_kg_per_s": lambda load: getattr(load.leak, "mass_flow", None),
    "leak_rate_Pa_m3_per_s": lambda load: getattr(load.leak, "throughput", None),
    "leak_rate_standard_m3_per_s": lambda load: getattr(load.leak, "standard_leak_rate", None),
    "knudsen_number": _knudsen_number,
    "lift_off_x_m": lambda load: getattr(load.leak, "lift_off_x", None),
    "blow_off_pressure_Pa": _blow_off_pressure,
    "effective_seal_radius_m": lambda load: load.effective_radius,
    "force_for_target_leak_N": lambda load: load.force_for_target,
    "max_accumulated_plastic_strain": _plastic_strain,
    "load_steps": _load_steps,
    "opening_margin_N": lambda load: None if load.opening is None else load.opening.force,
    "opening_margin_Pa": lambda load: None if load.opening is None else load.opening.pressure,
    "opening_margin": lambda load: None if load.opening is None else load.opening.share,
    "peak_pressure_max_Pa": lambda load: (
        None if load.circumference is None else float(load.circumference.peak_pressure.max())
    ),
    "line_load_min_over_mean": lambda load: (
        None if load.circumference is None else load.circumference.least_over_mean
    ),
    "leak_rate_round_m3_per_s": lambda load: None if load.circumference is None else _rate(load.leak_round),
    "leak_rate_scratches_low_m3_per_s": lambda load: _of_scratches(load, 0),
    "leak_rate_scratches_high_m3_per_s": lambda load: _of_scratches(load, 1),
    "line_load_for_target_N_per_m": _line_load_for_target,
    "leak_rate_per_length_m2_per_s": lambda load: _per_length(load, _rate(load.leak)),
    "leak_rate_per_length_kg_per_m_s": lambda load: _per_length(load, getattr(load.leak, "mass_flow", None)),
    "leak_rate_per_length_Pa_m2_per_s": lambda load: _per_length(
        load, getattr(load.leak, "throughput", None)
    ),
    "bolt_preload_N": _of_bolt("preload"),
    "bolt_torque_N_m": _of_bolt("torque"),
    "bolt_force_N": _of_bolt("force"),
    "bolt_stress_Pa": _of_bolt("stress"),
    "leak_rate_least_preload_m3_per_s": lambda load: _preload_end(load, -1),
    "leak_rate_largest_preload_m3_per_s": lambda load: _preload_end(load, 0),
    "bolt_preload_for_target_N": _of_bolt("preload_for_target"),
    "bolt_torque_for_target_N_m": _of_bolt("torque_for_target"),
    "bolt_stress_for_target_Pa": _of_bolt("stress_for_target"),
    "force_for_verdict_N": _of_judged("force_for_verdict"),
    "margin": _of_judged("margin"),
    "pass_probability": _of_judged("pass_probability"),
    "pass_probability_error": _of_judged("pass_probability_error"),
    "batch_share_p05": _of_judged("batch_share_p05"),
}


_OF |= {leak_rate_column(scenario): partial(_leak_rate_in, scenario) for scenario in SCENARIOS}
_OF |= {force_column(scenario): partial(_force_in, scenario) for scenario in SCENARIOS}
_OF |= {
    f"critical_separation_{scenario}_m": partial(_critical_separation_in, scenario) for scenario in SCENARIOS
}


def _columns() -> Iterator[Column]:
    for name, said in _SAID["loads"].items():
        yield from _of_scenarios(before=name)
        yield Column(name, of=_OF.get(name) or attrgetter(split_unit(name)[0]), **said)
    yield from _of_scenarios(before="")


def _of_scenarios(before: str) -> Iterator[Column]:
    """Columns of scenarios that stand before another column: leak rates, then the others."""
    here = {name: words for name, words in SCENARIOS.items() if words.columns and words.before == before}
    for place in range(max((len(words.columns) for words in here.values()), default=0)):
        for scenario, words in here.items():
            for kind in words.columns[place : place + 1]:
                name = force_column(scenario) if kind == "force" else leak_rate_column(scenario)
                texts: dict[str, Any] = {
                    key: text.format(scenario=scenario, words=words) if isinstance(text, str) else text
                    for key, text in _SAID["of_each"][kind].items()
                }
                yield Column(name, of=_OF[name], **texts)


# Names of the columns of each table; empty ones are left out.
SHOWN_COLUMNS: dict[str, list[str]] = _SAID["shown"]
# Of a table in brief.
MOST_COLUMNS = 6
COLUMNS = {column.name: column for column in _columns()}


def column_named(name: object, columns: Iterable[str]) -> str:
    """The column that is meant by its name, with or without its SI unit; of several units the first one.

    Parameters
    ----------
    name : str
    columns : iterable of str

    Raises
    ------
    KeyError
        If there is none; it says which are spelled like it.

    Examples
    --------
    >>> column_named("leak_rate", LEAK_COLUMNS)
    'leak_rate_m3_per_s'
    """
    full = list(columns)
    known = {split_unit(one)[0]: one for one in reversed(full)} | {one: one for one in full}
    if name not in known:
        near = difflib.get_close_matches(str(name), known, n=3, cutoff=0.5)
        hint = f"do you mean {' or '.join(near)}? " if near else ""
        raise KeyError(f'there is no column "{name}"; {hint}.table.columns has all of them')
    return known[str(name)]


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
    known = {split_unit(one)[0]: one for one in reversed(LEAK_COLUMNS)}
    return _NAME.sub(lambda name: name[0] if name[0] in taken else known.get(name[0], name[0]), text)


# Words that are no part of a path such as seat.angle, and no function; quotes as a whole.
_NAME = re.compile(r"""\"[^"]*\"|'[^']*'|(?<![\w.])[A-Za-z_]\w*(?![\w.(])""")


def own_columns(loads: Sequence[CaseLoad]) -> set[str]:
    """Columns of the theory that the loads themselves use: they repeat the leak rate.

    Parameters
    ----------
    loads : sequence of CaseLoad
    """
    return {
        leak_rate_column(name)
        for name, words in SCENARIOS.items()
        if words.own_contact and all(load.scenario(name) is load for load in loads)
    }


def in_words(load: CaseLoad, name: str) -> str:
    """A number of a load for a sentence: with its unit, and no more digits than in the tables.

    Parameters
    ----------
    load : CaseLoad
    name : str
        Of a column with a kind of quantity.
    """
    column = COLUMNS[name]
    return quantity_worth(column.kind, column.number(load), column.digits(load))


LEAK_COLUMNS = tuple(COLUMNS)
# Columns for the pressure profile of another program.
PROFILE_LEAK_COLUMNS = (
    *SHOWN_COLUMNS["of_profiles"],
    *(leak_rate_column(name) for name, words in SCENARIOS.items() if words.columns),
)


def known_columns(loads: Sequence[AnyLoad]) -> Sequence[str]:
    """Names of the columns that loads have: of given contacts those that need no bodies.

    Parameters
    ----------
    loads : sequence of CaseLoad or MissingLoad
    """
    given = any(not isinstance(load, MissingLoad) and load.of_profile for load in loads)
    return PROFILE_LEAK_COLUMNS if given else LEAK_COLUMNS


# Columns of the loads on the terminal.
LEAK_ON_TERMINAL = tuple(COLUMNS[name].on_terminal for name in SHOWN_COLUMNS["terminal"])
# Rows of `fem-seal check` for the case as a whole: name and unit by the key in its JSON.
CHECK_OF_CASE: dict[str, tuple[str, str]] = _SAID["of_the_case"]
# Columns of `fem-seal check` for the loads: those known before a solve, and the closed forms.
CHECK_ON_TERMINAL = (
    *(COLUMNS[name].on_terminal for name in ("fluid_pressure_Pa", "contact_force_N", "line_load_N_per_m")),
    *(TerminalColumn(name, heading, unit) for name, (heading, unit) in _SAID["closed_forms"].items()),
    *(COLUMNS[name].on_terminal for name in ("blow_off_pressure_Pa", "force_for_target_leak_N")),
)

# Names and meanings of the columns of the other tables; "words" are the columns of leak.csv after its numbers.
MEANINGS: dict[str, dict[str, str]] = dict(_SAID["meanings"])
MEANINGS["around"] = MEANINGS["around"] | {
    f"leak_rate_{name}_m3_per_s_per_rad": f"the same with {SCENARIOS[name].taken}; empty where none yields"
    for name in BESIDE
}
TEXT_COLUMNS, PROFILE_COLUMNS, IMPRINT_COLUMNS, AROUND_COLUMNS, PARTICLE_COLUMNS = (
    tuple(MEANINGS[table]) for table in ("words", "profile", "imprint", "around", "particles")
)
# the same loads: by the name of a test, and by the share of the set pressure
MEANINGS["set_pressure"] |= {
    name: text for name, text in MEANINGS["standard_tests"].items() if name != "test"
}
CONTACT_COLUMNS, COMPRESSION_COLUMNS, STANDARD_TEST_COLUMNS, SET_PRESSURE_COLUMNS = (
    tuple(MEANINGS[table]) for table in ("contacts", "compression", "standard_tests", "set_pressure")
)


# Headings and rows of a CSV file; without rows there is no file.
CsvTable = tuple[Sequence[str], Sequence[Sequence[float | str]]]
# Ten digits are more than the accuracy of any number, and the files stay readable.
_NUMBER = ".10g"
# Keys of summary.json for a leak rate in the units of leak testing.
_LEAKAGE = ("leak_rate", "mass_flow", "throughput", "standard_leak_rate")


def leak_rows(result: SealSolution) -> list[dict[str, Any]]:
    """Rows of leak.csv, one per load of the case: numbers in SI, NaN where nothing was calculated; `TEXT_COLUMNS`.

    Reasons are a list, and a load without a requirement has the verdict None. Of given contacts `PROFILE_LEAK_COLUMNS`.

    Parameters
    ----------
    result : SealSolution
    """
    columns = known_columns(result.loads)
    rows = (_cells(columns, load) | _texts(load.verdict, load.validity) for load in result.loads)
    return in_order(rows, result.not_calculated, lambda load: _missing_row(result.case, load, columns))


def _texts(verdict: Verdict | None, validity: Validity) -> dict[str, Any]:
    return {"verdict": None if verdict is None else str(verdict)} | validity_entries(validity)


def _missing_row(case: Case, load: MissingLoad, columns: Sequence[str]) -> dict[str, Any]:
    # the check of a case loads no finite elements
    from fem_seal.answers.verdict import missing_verdict

    judged = case.requirement is not None and case.requirement.judges(load.fluid_pressure)
    verdict = missing_verdict(case, load.point, load.problem).verdict if judged else None
    why = why_missing(load.problem)
    said = dict(zip(VALIDITY_COLUMNS, (NOT_CALCULATED, [why]), strict=True))
    return _cells(columns, load) | _texts(verdict, VALID) | said


def _cells(names: Sequence[str], load: AnyLoad) -> dict[str, Any]:
    return {name: COLUMNS[name].number(load) for name in names}


def leak_table(result: SealSolution) -> pd.DataFrame:
    """One row per load of the case with `LEAK_COLUMNS`, SI, and `TEXT_COLUMNS`.

    reference/columns in the manual explains them. NaN where nothing was calculated. ``verdict`` is
    "pass", "pass unless", "inconclusive", "fail unless", "fail" or, without a requirement, empty. ``validity`` is
    "valid", "doubtful", "outside the theory" or, of a load without numbers, "not calculated"; ``validity_reasons``
    gives the reasons, the worst first, with "; " between them (guide/validity in the manual).

    Parameters
    ----------
    result : SealSolution
    """
    import pandas as pd

    rows = [with_text(row) for row in leak_rows(result)]
    table = pd.DataFrame(rows)
    return table.astype(dict.fromkeys(table.columns.drop([*TEXT_COLUMNS]), float))


def with_text(row: Mapping[str, Any]) -> dict[str, Any]:
    """A row with its reasons joined to one text, and an empty text instead of a missing verdict."""
    texts = {"verdict": row["verdict"] or ""} if "verdict" in row else {}
    return {**row, **texts, "validity_reasons": "; ".join(row["validity_reasons"])}


def profile_array(result: SealSolution) -> NDArray[np.float64]:
    """The pressure profiles of all loads, one below the other, with a column for each of `PROFILE_COLUMNS`, SI.

    Parameters
    ----------
    result : SealSolution
    """
    blocks = []
    for load in result.loads:
        along = np.concatenate(
            [np.stack([one.x, one.radius, one.pressure, one.gap], 1) for one in load.profiles]
        )
        fluid = np.full(len(along), math.nan) if load.gap_pressure is None else load.gap_pressure
        pressure = np.full(len(along), load.fluid_pressure)
        # the direction of the force is that of bodies
        force = np.full(len(along), math.nan) if load.of_profile else load.contact.force_per_length
        blocks.append(np.column_stack([pressure, along, fluid, force]))
    return np.concatenate(blocks)


def write_leak_csv(result: SealSolution, path: Path) -> Path:
    """Write leak.csv, atomically."""
    return write_rows(path, leak_rows(result))


def write_rows(path: Path, rows: Sequence[Mapping[str, Any]]) -> Path:
    """Write rows by the names of their columns, reasons as one text; see `write_rows_csv`."""
    texts = [with_text(row) if "validity_reasons" in row else row for row in rows]
    return write_rows_csv(path, tuple(texts[0]), [list(row.values()) for row in texts])


def write_rows_csv(path: Path, columns: Sequence[str], rows: Sequence[Sequence[float | str]]) -> Path:
    """Write numbers and texts under their headings, atomically; OutputError if that is impossible."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows([f"{one:{_NUMBER}}" if isinstance(one, float) else one for one in row] for row in rows)
    return write_bytes(path, text.getvalue().encode())


def contact_rows(result: SealSolution) -> CsvTable:
    """Numbers of each sealing contact under each load.

    Parameters
    ----------
    result : SealSolution
    """
    flow, faces = result.problem.flow, result.problem.faces
    outlet = 0.0 if flow is None else flow.outlet_pressure
    return CONTACT_COLUMNS, [
        (*load.point, f"{face}{number}", *values)
        for load in result.loads
        for face, own in zip(("closure", "seat")[-faces:], (load.contact_loads * faces)[:faces], strict=True)
        for number, values in _lands_of(own, faces, outlet)
    ]


def _lands_of(
    load: CaseLoad, faces: int, outlet: float
) -> Iterator[tuple[str, tuple[float, float, float, float, float, float]]]:
    """Number and values of each contact of one face: one, or those of its lands from the axis outwards."""
    leak = load.leak
    if len(load.profiles) == 1:
        rate = math.nan if leak is None else leak.leak_rate / faces
        pressures = outlet + load.fluid_pressure, outlet
        yield "", (load.line_load, load.peak_pressure, load.fwhm, *pressures, rate)
        return
    flows = ((math.nan,) * 3,) * len(load.profiles) if leak is None else leak.lands
    for number, (one, flow) in enumerate(zip(load.profiles, flows, strict=True), start=1):
        inner, outer, rate = flow
        ends = sorted((outlet + inner, outlet + outer), reverse=True)
        values = (one.moment(0), float(one.pressure.max()), one.fwhm, ends[0], ends[1], rate / faces)
        yield f" {number}", values


def imprint_rows(result: SealSolution) -> CsvTable:
    """Body, x [m] and depth [m] of each imprint; no rows if nothing yielded."""
    return IMPRINT_COLUMNS, [
        (name, x, depth)
        for name, imprint in result.imprints.items()
        for x, depth in zip(imprint.x.tolist(), imprint.depth.tolist(), strict=True)
    ]


def write_profile_csv(result: SealSolution, path: Path) -> Path:
    """Write profile.csv, atomically."""
    return write_rows_csv(path, PROFILE_COLUMNS, profile_array(result).tolist())


def leakage_table(result: SealSolution) -> list[dict[str, Any]]:
    """Units and classes of all loads as plain numbers and texts; empty without a leak rate.

    Both ends of the interval meet a class; only the lower end meets the class "at best". A load outside the theory has
    no classes.
    """
    size = nominal_size(result.case).size if any(load.leak for load in result.loads) else None
    return [
        {
            "fluid_pressure": load.fluid_pressure,
            **{name: getattr(load.leak, name) for name in _LEAKAGE},
            "classes": {one.standard: one.name for one in classes},
            "classes_at_best": {one.standard: one.at_best or one.name for one in classes},
            "nominal_size": size,
            "validity": str(load.validity.level),
        }
        for load in result.loads
        if load.leak is not None
        for classes in [leakage_classes(result.case, load)]
    ]


def standards_used(result: SealSolution) -> list[Standard]:
    """The standards whose classes the leak rates are given, and that which is required."""
    named = [one.standard for load in result.loads for one in leakage_classes(result.case, load)]
    required = result.case.requirement and result.case.requirement.standard_and_class
    return [STANDARDS[name] for name in dict.fromkeys([*named, *(required or ())[:1]])]
