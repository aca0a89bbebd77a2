"""What the command line shows: tables for people, JSON for programs."""

from __future__ import annotations

import json
import math
import shutil
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from fem_seal.case_dimensions import dimensions
from fem_seal.case_sections import in_words, section
from fem_seal.caution import Level
from fem_seal.opening import DIGITS, digits_near_opening
from fem_seal.readable import rounded

if TYPE_CHECKING:
    from rich.table import Table

    from fem_seal.case import Case
    from fem_seal.derived import Derived

# Wider than any table.
_ENDLESS = 100_000


@dataclass(frozen=True)
class Column:
    """A column of the results as it is shown: its name in the files, heading, unit and factor from SI."""

    key: str
    heading: str
    unit: str
    factor: float


LEAK_COLUMNS = (
    Column("fluid_pressure_Pa", "p fluid", "bar", 1e-5),
    Column("axial_force_N", "force", "N", 1.0),
    Column("peak_pressure_Pa", "p peak", "MPa", 1e-6),
    Column("fwhm_m", "FWHM", "mm", 1e3),
    Column("std_m", "std dev", "mm", 1e3),
    Column("critical_separation_m", "u_c", "um", 1e6),
    Column("leak_rate_m3_per_s", "leak rate", "mm³/s", 1e9),
    Column("leak_rate_Pa_m3_per_s", "leak rate", "mbar l/s", 10.0),
    Column("leak_rate_low_m3_per_s", "low", "mm³/s", 1e9),
    Column("leak_rate_high_m3_per_s", "high", "mm³/s", 1e9),
    Column("leak_rate_elastic_m3_per_s", "elastic", "mm³/s", 1e9),
    Column("max_von_mises_Pa", "von Mises", "MPa", 1e-6),
    Column("effective_seal_radius_m", "r fluid", "mm", 1e3),
    Column("blow_off_pressure_Pa", "opens at", "bar", 1e-5),
    Column("force_for_target_leak_N", "target force", "N", 1.0),
    Column("opening_margin_N", "to opening", "N", 1.0),
    Column("opening_margin_Pa", "to opening", "bar", 1e-5),
)
# What follows from the contact force, and is worth fewer digits close to opening; the narrowest gap only like ln F_N.
_OF_CONTACT_FORCE = {
    "axial_force_N": 0,
    "peak_pressure_Pa": 0,
    "critical_separation_m": 1,
    "leak_rate_m3_per_s": 0,
    "leak_rate_Pa_m3_per_s": 0,
    "leak_rate_low_m3_per_s": 0,
    "leak_rate_high_m3_per_s": 0,
    "leak_rate_elastic_m3_per_s": 0,
    "opening_margin_N": 0,
    "opening_margin_Pa": 0,
}


def show_leak_table(rows: Sequence[Mapping[str, Any]], title: str) -> None:
    """Print rows of leak.csv as a table, without the columns that no row fills, and a legend of its marks."""
    columns = [column for column in LEAK_COLUMNS if any(_filled(row.get(column.key)) for row in rows)]
    cells = [
        [_cell(row.get(column.key), column.factor, _digits(row, column)) for column in columns]
        for row in rows
    ]
    headings = [f"{column.heading}\n{column.unit}" for column in columns]
    levels = [Level(row["validity"]) for row in rows]
    # what tells the rows apart stays beside every part of a table that is too wide
    several_forces = len({row["fluid_pressure_Pa"] for row in rows}) < len(rows)
    keys = 2 if several_forces and columns[1].key == "axial_force_N" else 1
    if any(level.mark for level in levels):
        headings.insert(keys, "")
        for line, level in zip(cells, levels, strict=True):
            line.insert(keys, level.mark)
        keys += 1
    show_table(title, headings, cells, keys)
    for level in Level:
        if level.mark and level in levels:
            what = "nothing may be claimed" if level is Level.OUTSIDE else "uncertain"
            print(f"  {level.mark} {level}: {what}; why, says validity_reasons in leak.csv")  # noqa: T201


def _digits(row: Mapping[str, Any], column: Column) -> int:
    """Significant digits that a number of a row is worth."""
    share = row.get("opening_margin")
    if not _filled(share) or column.key not in _OF_CONTACT_FORCE:
        return DIGITS
    assert share is not None  # it is filled
    return min(digits_near_opening(share) + _OF_CONTACT_FORCE[column.key], DIGITS)


def show_leakage(case: Case, rows: Sequence[Mapping[str, Any]]) -> None:
    """Print the leak rate of the highest fluid pressure in the units of leak testing, and its classes.

    Of several forces at this pressure it is the one that closes most.
    """
    from fem_seal.leakage import leakage_lines

    row = max(rows, key=lambda row: (row["fluid_pressure_Pa"], row.get("axial_force_N", 0.0)))
    if not _filled(row.get("leak_rate_m3_per_s")):
        return
    pressure = row["fluid_pressure_Pa"]
    forces = {one.get("applied_force_N") for one in rows if one["fluid_pressure_Pa"] == pressure}
    force = row.get("applied_force_N") if len(forces) > 1 else None
    share = row.get("opening_margin", math.nan)
    digits = 3 if math.isnan(share) else min(digits_near_opening(share), 3)
    level, reason = row["validity"], next(iter(row["validity_reasons"]), "")
    rate = row["leak_rate_m3_per_s"]
    for line in leakage_lines(case, pressure, rate, force, digits=digits, level=level, reason=reason):
        print(line)  # noqa: T201


def show_table(title: str, headings: Sequence[str], rows: Sequence[Sequence[str]], keys: int = 1) -> None:
    """Print a table, numbers to the right and none of them cut.

    A terminal that is too narrow gets it in parts below each other. What is no terminal has no width.

    Parameters
    ----------
    title : str
    headings : sequence of str
        Of two lines at most.
    rows : sequence of sequence of str
    keys : int
        So many first columns say which row it is; they stand in every part.
    """
    from rich.console import Console

    # the terminal's own width decides how many columns stand side by side, never how many digits of one
    console = Console(width=_ENDLESS, highlight=False)
    # above the table and not its title, which would be broken to the width of the table
    console.print(title, style="bold", markup=False, soft_wrap=True)
    widths = [
        max(len(line) for cell in (heading, *column) for line in cell.split("\n"))
        for heading, *column in zip(headings, *rows, strict=True)
    ]
    for part in _parts(widths, keys):
        console.print(_table([headings[n] for n in part], [[row[n] for n in part] for row in rows]))


def _table(headings: Sequence[str], rows: Sequence[Sequence[str]]) -> Table:
    from rich import box
    from rich.markup import escape
    from rich.table import Table

    table = Table(box=box.SIMPLE_HEAD)
    for heading in headings:
        table.add_column(escape(heading), justify="right", no_wrap=True)
    for row in rows:
        table.add_row(*(escape(cell) for cell in row))
    return table


def _parts(widths: Sequence[int], keys: int) -> Iterator[list[int]]:
    """Columns that stand side by side: as many as fit beside the keys, and one at least."""
    room = shutil.get_terminal_size().columns if sys.stdout.isatty() else _ENDLESS
    # a blank on either side of each column, one between two and one at either end
    taken = [width + 3 for width in widths]
    alone = 1 + sum(taken[:keys])
    part, used = list(range(keys)), alone
    for n in range(keys, len(widths)):
        if len(part) > keys and used + taken[n] > room:
            yield part
            part, used = list(range(keys)), alone
        part.append(n)
        used += taken[n]
    yield part


def _filled(value: float | None) -> bool:
    return value is not None and not math.isnan(value)


def _cell(value: float | None, factor: float, digits: int = DIGITS) -> str:
    if value is None or math.isnan(value):
        return "-"
    if digits < DIGITS and math.isfinite(value) and value:
        exponent = math.floor(math.log10(abs(rounded(value * factor, digits))) + 1e-12)
        if -4 <= exponent < DIGITS:
            return f"{rounded(value * factor, digits):.{max(digits - 1 - exponent, 0)}f}"
    # so many digits, also when they are zeros: columns stay aligned
    return f"{value * factor:#.{digits}g}".removesuffix(".")


def as_json(value: object) -> str:
    """JSON of numbers, texts, lists and tables; what is not a number in JSON (NaN, infinity) becomes null."""
    return json.dumps(_plain(value), indent=2, ensure_ascii=False)


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(key): _plain(entry) for key, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(entry) for entry in value]
    if isinstance(value, float) or hasattr(value, "item"):
        number = value.item() if hasattr(value, "item") else value
        return None if isinstance(number, float) and not math.isfinite(number) else number
    return value


def derived_numbers(case: Case, derived: Derived) -> dict[str, Any]:
    """Derived numbers of a case in SI, as `check --json` prints them."""
    fluid = case.fluid
    return {
        "title": case.title,
        "touch_radius_m": derived.touch_radius,
        "contact_angle_rad": case.contact.angle,
        "relative_radius_m": derived.relative_radius,
        "dimensions": {name: dimensions(case, name) for name in ("closure", "seat")},
        "sections": {name: found for name in ("closure", "seat") if (found := section(case, name))},
        "effective_modulus_Pa": derived.effective_modulus,
        "hardness_Pa": derived.hardness,
        "rms_height_m": derived.rms_height,
        "rms_slope": derived.rms_slope,
        "decay_length_m": derived.decay_length,
        "law_pressure_Pa": derived.law_pressure,
        "viscosity_Pa_s": fluid.viscosity if fluid else None,
        "loads": [
            {
                "fluid_pressure_Pa": load.fluid_pressure,
                "axial_force_N": load.closing_force,
                "line_load_N_per_m": load.line_load,
                "blow_off_pressure_Pa": load.blow_off_pressure,
                "force_for_target_leak_N": load.force_for_target,
                "hertz_peak_pressure_Pa": load.hertz.peak_pressure if load.hertz else None,
                "hertz_half_width_m": load.hertz.half_width if load.hertz else None,
                "gaussian_peak_pressure_Pa": load.gaussian.peak_pressure if load.gaussian else None,
                "gaussian_std_m": load.gaussian.std if load.gaussian else None,
                "crossover_peak_pressure_Pa": load.crossover.peak_pressure if load.crossover else None,
                "crossover_fwhm_m": load.crossover.fwhm if load.crossover else None,
                "crossover_std_m": load.crossover.std if load.crossover else None,
            }
            for load in derived.loads
        ],
    }


_CHECK_COLUMNS = (
    Column("fluid_pressure_Pa", "p fluid", "bar", 1e-5),
    Column("axial_force_N", "force", "N", 1.0),
    Column("line_load_N_per_m", "line load", "kN/m", 1e-3),
    Column("hertz_peak_pressure_Pa", "Hertz p0", "MPa", 1e-6),
    Column("hertz_half_width_m", "half width", "mm", 1e3),
    Column("gaussian_peak_pressure_Pa", "Gauss p0", "MPa", 1e-6),
    Column("crossover_peak_pressure_Pa", "crossover p0", "MPa", 1e-6),
    Column("crossover_fwhm_m", "FWHM", "mm", 1e3),
    Column("crossover_std_m", "std dev", "mm", 1e3),
    Column("blow_off_pressure_Pa", "opens at", "bar", 1e-5),
    Column("force_for_target_leak_N", "target force", "N", 1.0),
)

_CHECK_LINES = (
    Column("touch_radius_m", "radius of first touch r0", "mm", 1e3),
    Column("contact_angle_rad", "angle of the contact normal", "deg", 180 / math.pi),
    Column("relative_radius_m", "radius of relative curvature", "mm", 1e3),
    Column("effective_modulus_Pa", "effective modulus E*", "GPa", 1e-9),
    Column("hardness_Pa", "hardness", "GPa", 1e-9),
    Column("rms_height_m", "rms height", "um", 1e6),
    Column("rms_slope", "rms slope", "", 1.0),
    Column("decay_length_m", "decay length u0", "um", 1e6),
    Column("law_pressure_Pa", "p_c", "GPa", 1e-9),
    Column("viscosity_Pa_s", "viscosity", "mPa s", 1e3),
    Column("contact_size_m", "element size in the contact", "um", 1e6),
)


def _dimension(key: str, value: float) -> str:
    return f"{math.degrees(value):.4g} deg" if key.endswith("angle") else f"{1e3 * value:.4g} mm"


def show_derived(numbers: Mapping[str, Any]) -> None:
    """Print the derived numbers of a case."""
    for body, lengths in numbers["dimensions"].items():
        shown = [f"{key} {_dimension(key, value)}" for key, value in lengths.items()]
        if body in numbers["sections"]:
            shown += in_words(numbers["sections"][body]).values()
        print(f"  {body:10}" + ", ".join(shown))  # noqa: T201
    for column in _CHECK_LINES:
        value = numbers[column.key]
        if value is not None and math.isfinite(value):
            print(f"  {column.heading:30}{_cell(value, column.factor)} {column.unit}".rstrip())  # noqa: T201
    rows = numbers["loads"]
    columns = [column for column in _CHECK_COLUMNS if any(row[column.key] is not None for row in rows)]
    closed = any(row["hertz_peak_pressure_Pa"] is not None for row in rows)
    show_table(
        "Closed-form pressure profiles"
        if closed
        else "Loads (no closed-form profiles: the faces fit each other)",
        [f"{column.heading}\n{column.unit}" for column in columns],
        [[_cell(row[column.key], column.factor) for column in columns] for row in rows],
    )
