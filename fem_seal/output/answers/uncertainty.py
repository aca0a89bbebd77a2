"""The interval of the leak rate and the shares of the inputs."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from fem_seal.answers.case_load import CaseLoad, rate_of
from fem_seal.answers.leakage_class import volume_of
from fem_seal.answers.solution import SealSolution
from fem_seal.answers.uncertainty import LeakInterval
from fem_seal.output.answer_output import AnswerOutput, AnswerPage, worded_section
from fem_seal.output.answers.error_shares import input_name
from fem_seal.output.columns import ReadableTable
from fem_seal.seal.load_result import load_name
from fem_seal.units import LIQUID, LeakVolume, format_digits, percent
from fem_seal.wording import say_all

if TYPE_CHECKING:
    from fem_seal.units import Display


def told_after_test(display: Display, load: CaseLoad, volume: LeakVolume = LIQUID, interval: str = "") -> str:
    """What leaks after a leak test: median and interval, "2.4 ml/min (2.1 to 2.7 ml/min)".

    Parameters
    ----------
    display : Display
    load : CaseLoad
        With samples.
    volume : LeakVolume
    interval : str, optional
        Of the leak rate in words.
    """
    ends = rate_of(load)
    middle = load.leak_rate_p50 or 0.0
    rates = ends if isinstance(ends, tuple) else (ends,)
    text = display.leak_range(middle, min(load.leak_digits, 2), beside=rates, volume=volume)
    return f"{text} ({interval or display.leak_range(ends, load.leak_digits, volume=volume)})"


def interval_table(result: SealSolution) -> ReadableTable:
    """Leak rates with their interval and the shares of the inputs; no rows if nothing was uncertain."""
    display = result.display
    interval = result.uncertainty
    if interval is None:
        return ReadableTable((), ())
    ends = [interval_ends or (math.nan, math.nan) for interval_ends in result.leak_ranges]
    volume = volume_of(result.case)
    unit = display.name_unit(display.shared_flow_unit([end for several in ends for end in several]), volume)
    span, tested = percent(interval.confidence), interval.error_scores is not None
    names, of_inputs = interval.inputs, interval.shares
    if tested:
        # the inputs depend on each other
        names = ("left by test",)
        of_inputs = np.array([[sources.of_width.get(*names, math.nan)] for sources in result.error_shares])
    headings = (
        "load",
        f"leak rate [{unit.name}]",
        f"{span}: from [{unit.name}]",
        f"to [{unit.name}]",
        *([f"median [{unit.name}]"] if tested else []),
        *(f"{input_name(name)} [%]" for name in names),
    )
    rows = []
    for load, both, shares in zip(result.loads, ends, of_inputs, strict=True):
        middle = [(load.leak_rate_p50 or 0.0, 2)] if tested else []
        rates = [(load.leak.leak_rate, 3)] if load.leak else []
        cells = [
            format_digits(unit.of(volume.measurable(rate)), min(load.leak_digits, digits))
            for rate, digits in (*rates, *((end, 2) for end in both), *middle)
        ]
        cells += ["–" if np.isnan(share) else f"{100 * share:.0f}" for share in shares]
        rows.append((load_name(load, result.loads, display), *cells))
    return ReadableTable(headings, tuple(rows))


def interval_notes(result: SealSolution, display: Display) -> list[str]:
    """Method of the interval; empty if there is none.

    Parameters
    ----------
    result : SealSolution
    display : Display
    """
    interval, settings, roughness = result.uncertainty, result.case.uncertainty, result.case.roughness
    if interval is None:
        return []
    given_as = {} if settings is None else settings.spreads
    spreads = {
        name: f" ±{percent(spread.relative)} ({spread.distribution})" for name, spread in given_as.items()
    }
    return say_all(
        display,
        "uncertainty",
        "method",
        interval=interval,
        inputs=", ".join(input_name(name) + spreads.get(name, "") for name in interval.inputs),
        tested=interval.error_scores is not None,
        finish=roughness is not None and roughness.finishes,
        both=result.highest.others,
        with_error=result.highest.flow_error is not None,
        sealed=float(interval.sealed_share.max()),
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
        "sealed_share": interval.sealed_share.tolist(),
        "shares_of_variance": {
            name: interval.shares[:, n].tolist() for n, name in enumerate(interval.inputs)
        },
    }


OUTPUT = AnswerOutput(
    lambda result: result.uncertainty,
    summary=lambda result: {
        "uncertainty": None if result.uncertainty is None else interval_numbers(result, result.uncertainty)
    },
    absent={"uncertainty": None},
    page=lambda result, display: AnswerPage(
        section=worded_section(
            display, "uncertainty", interval_notes(result, display), interval_table(result)
        )
    ),
)
