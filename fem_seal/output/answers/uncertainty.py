"""The interval of the leak rate and the shares of the inputs."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from fem_seal.answers.leakage_class import volume_of
from fem_seal.output.answers.error_shares import input_name
from fem_seal.output.prose import phrase
from fem_seal.output.shown import ReadableTable, Shown
from fem_seal.seal.load_names import load_name
from fem_seal.units import format_digits, percent, unit_for

if TYPE_CHECKING:
    from fem_seal.answers.solution import SealSolution
    from fem_seal.answers.uncertainty import LeakInterval


def interval_table(result: SealSolution) -> ReadableTable:
    """Leak rates with their interval and the shares of the inputs; no rows if nothing was uncertain."""
    interval = result.uncertainty
    if interval is None:
        return ReadableTable((), ())
    ends = [one or (math.nan, math.nan) for one in result.leak_ranges]
    volume = volume_of(result.case)
    unit = volume.named(unit_for("flow", max(high for _, high in ends)))
    span = percent(interval.confidence)
    headings = (
        "load",
        f"leak rate [{unit.name}]",
        f"{span}: from [{unit.name}]",
        f"to [{unit.name}]",
        *(f"{input_name(name)} [%]" for name in interval.inputs),
    )
    rows = []
    for load, both, shares in zip(result.loads, ends, interval.shares, strict=True):
        rates = [(load.leak.leak_rate, 3)] if load.leak else []
        cells = [
            format_digits(unit.of(volume.measurable(rate)), min(load.leak_digits, digits))
            for rate, digits in (*rates, *((end, 2) for end in both))
        ]
        cells += ["–" if np.isnan(share) else f"{100 * share:.0f}" for share in shares]
        rows.append((load_name(load, result.loads), *cells))
    return ReadableTable(headings, tuple(rows))


def interval_note(result: SealSolution) -> str:
    """Method of the interval; empty if there is none."""
    interval, settings, roughness = result.uncertainty, result.case.uncertainty, result.case.roughness
    if interval is None:
        return ""
    given_as = {} if settings is None else settings.spreads
    spreads = {name: f" ±{percent(one.relative)} ({one.distribution})" for name, one in given_as.items()}
    sealed = float(interval.sealed.max())
    return phrase(
        "notes.interval",
        "samples",
        "polynomial" if interval.runs < interval.samples else "",
        "checked" if interval.error is not None else "",
        "finish" if roughness is not None and roughness.finishes else "",
        "sealed" if sealed > 0 else "",
        "shares",
        "shares_both" if result.highest.yields else "",
        "held",
        "" if result.highest.flow_error is None else "own",
        interval=interval,
        inputs=", ".join(input_name(name) + spreads.get(name, "") for name in interval.inputs),
        sealed=sealed,
    )


def interval_numbers(result: SealSolution, interval: LeakInterval) -> dict[str, Any]:
    """Leak rates with their interval, and its settings; one entry per load in each list."""
    low, high = np.transpose([ends or (math.nan, math.nan) for ends in result.leak_ranges]).tolist()
    return {
        "samples": interval.samples,
        "seed": interval.seed,
        "confidence": interval.confidence,
        "calculated_samples": interval.runs,
        "error_of_the_others": interval.error,
        "leak_rate_low_m3_per_s": low,
        "leak_rate_median_m3_per_s": interval.median.tolist(),
        "leak_rate_high_m3_per_s": high,
        "sealed_share": interval.sealed.tolist(),
        "shares_of_variance": {
            name: interval.shares[:, n].tolist() for n, name in enumerate(interval.inputs)
        },
    }


SHOWN = Shown(
    summary=lambda result: {
        "uncertainty": None if result.uncertainty is None else interval_numbers(result, result.uncertainty),
    },
    words=lambda result: {
        "interval": interval_table(result),
        "interval_note": interval_note(result),
    },
)
