"""The result with the other interface law, and with every reading of the theory."""

from __future__ import annotations

from dataclasses import asdict

from fem_seal import units
from fem_seal.answers.accuracy import Comparison
from fem_seal.answers.leakage_class import volume_of
from fem_seal.answers.solution import SealSolution
from fem_seal.answers.variants import ratio_to_case
from fem_seal.output.columns import VARIANT_COLUMNS
from fem_seal.output.prose import phrase, prose
from fem_seal.output.shown import ReadableTable, Shown, by_reading, worded_table
from fem_seal.seal.bounds import Bounds
from fem_seal.seal.load_names import load_name
from fem_seal.seal.load_result import LoadResult, highest_load


def variant_table(result: SealSolution) -> ReadableTable:
    """Results with either interface law at the load with the largest contact force; no rows without a choice."""
    ends = [rate for one in result.interface_variants for rate in (one.leak_rate, *one.others.values())]
    rates = [rate for rate in ends if rate is not None]
    volume = volume_of(result.case)
    unit = volume.named(units.shared_flow_unit(rates))
    load = result.strongest
    used = result.case.interface.plastic
    return worded_table(
        "interface_laws",
        [
            {
                "variant": variant,
                "used": " (used)" if ("plastic" in variant.name) == used else "",
                "leak_rate": _both_readings(variant, unit, load, volume),
            }
            for variant in result.interface_variants
        ],
        unit=f" [{unit.name}]" if rates else "",
        load=load,
        fwhm_digits=load.digits_of("fwhm"),
        std_digits=load.digits_of("std"),
    )


def _both_readings(variant: Comparison, unit: units.Unit, load: LoadResult, volume: units.LeakVolume) -> str:
    """The leak rate in both readings of yielding asperities, or the only one."""
    claimed = not load.validity.outside
    if variant.leak_rate is None:
        return "–"
    ends = Bounds.of([variant.leak_rate, *variant.others.values()])
    digits = min(load.leak_digits, 2 if ends.apart else 3)
    texts = [
        units.format_digits(unit.of(one), digits) if one else units.leak_rate_text(0.0, claimed=claimed)
        for one in map(volume.measurable, ends)
    ]
    return units.range_text(*texts)


def theory_table(result: SealSolution) -> ReadableTable:
    """Leak rate at the lowest and highest fluid pressure with every reading of the theory; no rows without variants."""
    if not result.theory_variants:
        return ReadableTable((), ())
    lowest = min(range(len(result.loads)), key=lambda n: result.loads[n].point)
    shown = list(dict.fromkeys((lowest, highest_load(result.loads))))
    of_case = [load.leak.leak_rate if load.leak else 0.0 for load in result.loads]
    rates = [variant.leak_rate[n] for variant in result.theory_variants for n in shown]
    volume = volume_of(result.case)
    unit = volume.named(units.shared_flow_unit(rates))
    headings = ["p(u)", "channels", "P(u)", "percolation threshold"]
    for n in shown:
        pressure = load_name(result.loads[n], result.loads)
        headings += [f"leak rate at {pressure} [{unit.name}]", "ratio to the case"]
    rows = []
    for variant in result.theory_variants:
        cells = [
            variant.interface_law + (" (used)" if variant.used else ""),
            prose()["channels"][variant.conductivity],
            variant.separation_width or "–",
            units.trimmed(variant.percolation_threshold),
        ]
        for n in shown:
            rate, digits = variant.leak_rate[n], min(result.loads[n].leak_digits, 3)
            cells += [units.format_digits(unit.of(volume.measurable(rate)), digits)]
            cells += [units.number(ratio_to_case(rate, of_case[n]), 2)]
        rows.append(tuple(cells))
    return ReadableTable(tuple(headings), tuple(rows))


def theory_note(result: SealSolution) -> str:
    """Note on the difference of the readings; empty without them."""
    if not result.theory_variants:
        return ""
    load = highest_load(result.loads)
    rates = [variant.leak_rate[load] for variant in result.theory_variants]
    tight = min(rates) <= 0
    return phrase(
        "notes.theory",
        "tight" if tight else "factor",
        "yields" if result.highest.yields else "",
        load=load_name(result.loads[load], result.loads),
        factor=None if tight else max(rates) / min(rates),
    )


def variant_rows(result: SealSolution) -> list[tuple[float | str, ...]]:
    """Rows with `VARIANT_COLUMNS`, one per reading and load.

    Parameters
    ----------
    result : SealSolution
        With its `theory_variants`.
    """
    rows: list[tuple[float | str, ...]] = []
    for one in result.theory_variants:
        reading = one.interface_law, one.conductivity, one.separation_width or "", one.percolation_threshold
        for load, rate in zip(result.loads, one.leak_rate, strict=True):
            ratio = ratio_to_case(rate, load.leak.leak_rate if load.leak else 0.0)
            rows.append((*reading, load.fluid_pressure, rate, ratio))
    return rows


SHOWN = Shown(
    summary=lambda result: {
        "interface_variants": [by_reading(asdict(variant)) for variant in result.interface_variants],
        "theory_variants": [dict(zip(VARIANT_COLUMNS, row, strict=True)) for row in variant_rows(result)],
    },
    tables={"variants.csv": lambda result: (VARIANT_COLUMNS, variant_rows(result))},
    words={"variants": variant_table, "theory": theory_table, "theory_note": theory_note},
)
