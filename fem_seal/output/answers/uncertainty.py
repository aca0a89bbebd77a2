"""The interval of the leak rate and the shares of the inputs."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np

from fem_seal.answers.error_shares import ErrorShares, error_shares, measured_profiles
from fem_seal.answers.leakage_class import volume_of
from fem_seal.output.prose import phrase, prose
from fem_seal.output.shown import ReadableTable, Shown
from fem_seal.seal.load_names import load_name
from fem_seal.seal.load_result import highest_load
from fem_seal.units import format_digits, percent, unit_for

if TYPE_CHECKING:
    from fem_seal.answers.solution import SealSolution
    from fem_seal.answers.uncertainty import LeakInterval


# Sources of error are named from this factor of the interval on; their largest number, and smallest share.
_NARROW, _NAMED, _LEAST = 1.25, 4, 0.01
# A measurement that narrows the interval by a smaller factor is not named.
_NARROWER = 1.1


def _input_name(name: str) -> str:
    """An uncertain input in words; one of several measured spectra is called by its key."""
    names: dict[str, str] = prose()["sources_of_error"]
    if name in names or name.startswith("accuracy: "):
        return names.get(name, name.removeprefix("accuracy: "))
    key = name.removeprefix("scan_length_")
    return f"{names['scan_length']} ({key})" if key != name else f"{name} between scans"


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
        *(f"{_input_name(name)} [%]" for name in interval.inputs),
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
        inputs=", ".join(_input_name(name) + spreads.get(name, "") for name in interval.inputs),
        sealed=sealed,
    )


def error_shares_of(result: SealSolution) -> list[ErrorShares]:
    """Shares of the sources of error in the interval of each load.

    Parameters
    ----------
    result : SealSolution
    """
    profiles = measured_profiles(result.case)
    return [
        error_shares(load, result.uncertainty, number, profiles) for number, load in enumerate(result.loads)
    ]


def error_sentence(result: SealSolution) -> str:
    """Sources of error of the interval of the highest load, and measures against it; empty for a narrow interval."""
    number = highest_load(result.loads)
    found = error_shares_of(result)[number]
    if found.factor < _NARROW or len(found.of_width) < 2:
        return ""
    largest = next(iter(found.of_width))
    measured = found.by_profiles
    named = [(name, share) for name, share in list(found.of_width.items())[:_NAMED] if share >= _LEAST]
    return phrase(
        "notes.error_shares",
        "interval",
        "doubt" if largest.startswith("accuracy: ") else "source",
        "" if measured is None or measured.left * _NARROWER > found.factor else "profile",
        measured=measured,
        load=load_name(result.loads[number], result.loads),
        factor=found.factor,
        shares=", ".join(f"{_input_name(name)} {percent(share, 1)}" for name, share in named),
        largest=_input_name(largest),
        left=found.left[largest],
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
        "error_shares": [asdict(one) for one in error_shares_of(result)],
    },
    words=lambda result: {
        "interval": interval_table(result),
        "interval_note": interval_note(result),
        "error_sentence": error_sentence(result),
    },
    lines=lambda result: [f"  {one}" for one in [error_sentence(result)] if one],
)
