"""The result with the other interface law."""

from __future__ import annotations

from dataclasses import asdict

from fem_seal import units
from fem_seal.answers.accuracy import Comparison
from fem_seal.answers.case_load import CaseLoad
from fem_seal.answers.leakage_class import volume_of
from fem_seal.answers.solution import SealSolution
from fem_seal.output.shown import ReadableTable, Shown, by_scenario, worded_table
from fem_seal.seal.bounds import Bounds


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
                "leak_rate": _rates_of(variant, unit, load, volume),
            }
            for variant in result.interface_variants
        ],
        unit=f" [{unit.name}]" if rates else "",
        load=load,
        fwhm_digits=load.digits_of("fwhm"),
        std_digits=load.digits_of("std"),
    )


def _rates_of(variant: Comparison, unit: units.Unit, load: CaseLoad, volume: units.LeakVolume) -> str:
    """The leak rate in all scenarios that stand beside each other, or the only one."""
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


SHOWN = Shown(
    summary=lambda result: {
        "interface_variants": [by_scenario(asdict(variant)) for variant in result.interface_variants]
    },
    words={"variants": variant_table},
)
