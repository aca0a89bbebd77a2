"""The tables of the report: one unit per column, figures that mean something."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from fem_seal.caution import Level
from fem_seal.derived import closed_form_limits, derive
from fem_seal.load_names import load_name
from fem_seal.readable import Unit, flow, quantity, trimmed, unit_for, worth

if TYPE_CHECKING:
    from fem_seal.closed_forms import Sizes
    from fem_seal.results import SealResult
    from leak import LeakResult


@dataclass(frozen=True)
class ReadableTable:
    """A table for the page.

    Parameters
    ----------
    headings : tuple of str
    rows : tuple of tuple of str
    """

    headings: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


def load_table(result: SealResult, sizes: Mapping[str, Sizes]) -> ReadableTable:
    """All loads, with one unit per column and without the columns that no load fills."""
    calculated, loads = sizes["calculated"], result.loads
    digits = [load.digits for load in loads]
    # the narrowest gap follows the force only like its logarithm
    of_gap = [min(one + 1, 4) for one in digits]
    columns = [
        Column("fluid pressure", "fluid pressure", [load.fluid_pressure for load in loads]),
        Column("closing force", "force", [load.axial_force for load in loads], digits=digits),
        Column("line load", "line load", [load.line_load for load in loads], digits=digits),
        Column("peak pressure", "contact pressure", calculated.peak_pressure.tolist(), digits=digits),
        Column("width (FWHM)", "length", calculated.fwhm.tolist()),
        Column("std. deviation", "length", calculated.std.tolist(), unit_of="width (FWHM)"),
        Column("u_c", "length", [load.critical_separation for load in loads], digits=of_gap),
        Column(
            "u_c, elastic",
            "length",
            [load.critical_separation_elastic for load in loads],
            unit_of="u_c",
            digits=of_gap,
        ),
        Column("leak rate", "flow", [_leak_rate(load.leak) for load in loads], digits=digits),
        Column(
            "leak rate, elastic",
            "flow",
            [_leak_rate(load.leak_elastic) for load in loads],
            unit_of="leak rate",
            digits=digits,
        ),
        Column("von Mises", "contact pressure", [load.max_von_mises for load in loads]),
    ]
    if any(load.applied_force for load in loads):
        columns.insert(1, Column("spring force", "force", [load.applied_force for load in loads]))
    if result.surface is None or result.surface.hardness is None:
        columns = [column for column in columns if not column.name.endswith("elastic")]
    table = columns_table(columns)
    # with a mark and not a column more: the page is full
    rows = (
        (f"{first} {load.validity.level.mark}".rstrip(), *others)
        for (first, *others), load in zip(table.rows, loads, strict=True)
    )
    return ReadableTable(table.headings, tuple(rows))


def marks_in_words(result: SealResult) -> str:
    """What the marks in the table of the loads mean; empty without any."""
    found = [level for level in Level if any(load.validity.level is level for load in result.loads)]
    told = [f"{level.mark} {level}" for level in found if level.mark]
    return f" {', '.join(told)}." if told else ""


def validity_table(result: SealResult) -> ReadableTable:
    """Every reason why the numbers of a load are not simply valid; no rows if all are."""
    rows = [
        (load_name(load, result.loads), str(caution.level), caution.reason)
        for load in result.loads
        for caution in load.validity.cautions
    ]
    return ReadableTable(("load", "validity", "because"), tuple(rows))


@dataclass(frozen=True)
class Column:
    """A column in SI; `unit_of` names the one whose unit it shares, so that the two can be compared.

    Parameters
    ----------
    name, kind : str
        Heading without its unit, and what `fem_seal.readable.unit_for` calls the quantity.
    values : list of float or None
        One per row.
    unit_of : str
    digits : sequence of int, optional
        Significant digits that the values are worth, four unless given.
    """

    name: str
    kind: str
    values: list[float | None]
    unit_of: str = ""
    digits: Sequence[int] = ()

    @property
    def filled(self) -> bool:
        """Whether any row has a value."""
        return any(value is not None for value in self.values)

    @property
    def largest(self) -> float:
        """Largest absolute value."""
        return max(abs(value) for value in self.values if value is not None)


def columns_table(columns: Sequence[Column]) -> ReadableTable:
    """Columns side by side, one unit in each, without those that no row fills.

    Parameters
    ----------
    columns : sequence of Column
    """
    shown = [column for column in columns if column.filled]
    units = {column.name: unit_for(column.kind, column.largest) for column in shown}
    return ReadableTable(
        tuple(f"{column.name} [{units[column.unit_of or column.name].name}]" for column in shown),
        tuple(
            tuple(_cell(column, units[column.unit_of or column.name], n) for column in shown)
            for n in range(len(columns[0].values))
        ),
    )


def _leak_rate(leak: LeakResult | None) -> float | None:
    return None if leak is None else leak.leak_rate


def _cell(column: Column, unit: Unit, n: int) -> str:
    value = column.values[n]
    if value is None:
        return "–"
    if column.name == "fluid pressure":
        return trimmed(unit.of(value))
    return worth(unit.of(value), column.digits[n] if column.digits else 4)


def comparison_table(result: SealResult, sizes: Mapping[str, Sizes]) -> ReadableTable:
    """How much every load differs from the closed forms, in per cent; no rows where there are none."""
    names = {key: name for key, name in (("crossover", "crossover"), ("hertz", "Hertz")) if key in sizes}
    if not names:
        return ReadableTable((), ())
    measures = {"peak_pressure": "peak", "fwhm": "FWHM", "std": "std. dev."}
    headings = [f"{text} over {name} − 1 [%]" for name in names.values() for text in measures.values()]
    columns = [
        getattr(sizes["calculated"], measure) / getattr(sizes[key], measure) - 1
        for key in names
        for measure in measures
    ]
    rows = tuple(
        (load_name(load, result.loads), *(_difference(column[n]) for column in columns))
        for n, load in enumerate(result.loads)
    )
    return ReadableTable(("load", *headings), rows)


def comparison_note(result: SealResult) -> str:
    """What to expect of the comparison with the closed forms; empty if nothing needs saying."""
    law = result.case.interface.law
    if result.unloaded is not None:
        return " The closed forms are for elastic bodies: the differences show what yielding does."
    if limits := closed_form_limits(result.case, derive(result.case)):
        return f" {limits[0].upper()}{limits[1:]}."
    if law == "smooth":
        return " Small differences to Hertz are those of the mesh and of the curved sealing line."
    if law == "exponential":
        return " The crossover is exact for this interface law; the rest is the mesh and the curved sealing line."
    return (
        " The crossover is drawn with u₀ of the roughness at low pressure; differences of a per cent or more show that "
        "the full p(u) is no exponential at these pressures."
    )


def _difference(share: float) -> str:
    digits = 3 if abs(share) < 0.1 else 0
    return f"{100 * share:+.{digits}f}".replace("-", "−")


def variant_table(result: SealResult) -> ReadableTable:
    """What the interface law does to the load with the largest closing force; no rows if there was no choice."""
    rows = [
        (
            variant.name
            + (" (used)" if ("plastic" in variant.name) == result.case.interface.plastic else ""),
            quantity("contact pressure", variant.peak_pressure),
            quantity("length", variant.fwhm),
            quantity("length", variant.std),
            "–"
            if variant.leak_rate is None
            else flow(variant.leak_rate, claimed=not result.strongest.validity.outside),
        )
        for variant in result.interface_variants
    ]
    return ReadableTable(
        ("interface law", "peak pressure", "FWHM", "std. deviation", "leak rate"), tuple(rows)
    )
