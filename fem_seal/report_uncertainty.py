"""What the report says about how sure a leak rate is: intervals from uncertain inputs, and readings of the theory."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fem_seal.load_names import load_name
from fem_seal.readable import number, percent, trimmed, unit_for
from fem_seal.report_tables import ReadableTable
from fem_seal.theory_variants import ratio_to_case

if TYPE_CHECKING:
    from fem_seal.results import SealResult

_NAMES = {
    "viscosity": "viscosity",
    "hardness": "hardness",
    "youngs_modulus": "Young's modulus",
    "rms_height": "rms height",
    "hurst": "Hurst exponent",
    "q_rolloff": "roll-off",
    "q_high": "shortest wavelength",
    "spectrum": "spectrum between scans",
    "scan_length": "length of the scans",
}
_CHANNELS = {"bruggeman": "effective medium", "critical-junction": "critical junction"}


def _named(name: str) -> str:
    """An uncertain input in words; one of several measured spectra is called by its key."""
    key = name.removeprefix("scan_length_")
    return _NAMES.get(name, f"length of the scans ({key})" if key != name else f"{name} between scans")


def interval_table(result: SealResult) -> ReadableTable:
    """Leak rates with their interval and the shares of the inputs; no rows if nothing was uncertain."""
    interval = result.uncertainty
    if interval is None:
        return ReadableTable((), ())
    unit = unit_for("flow", float(interval.high.max()))
    span = percent(interval.confidence)
    headings = (
        "load",
        f"leak rate [{unit.name}]",
        f"{span}: from [{unit.name}]",
        f"to [{unit.name}]",
        *(f"{_named(name)} [%]" for name in interval.inputs),
    )
    rows = tuple(
        (
            load_name(load, result.loads),
            *(
                number(unit.of(rate))
                for rate in (load.leak.leak_rate if load.leak else None, interval.low[n], interval.high[n])
                if rate is not None
            ),
            *("–" if np.isnan(share) else f"{100 * share:.0f}" for share in interval.shares[n]),
        )
        for n, load in enumerate(result.loads)
    )
    return ReadableTable(headings, rows)


def interval_note(result: SealResult) -> str:
    """How the interval was made; empty if there is none."""
    interval, settings = result.uncertainty, result.case.uncertainty
    if interval is None:
        return ""
    given_as = {} if settings is None else settings.spreads
    inputs = [
        _named(name)
        + (
            f" ±{percent(given_as[name].relative)} ({given_as[name].distribution})"
            if name in given_as
            else ""
        )
        for name in interval.inputs
    ]
    text = f"{interval.samples} samples (seed {interval.seed}) of {', '.join(inputs)}."
    if interval.error is not None:
        text += (
            f" {interval.runs} of them were calculated in full; a polynomial through these gave the others, off by at "
            f"most {percent(interval.error)} where it was checked."
        )
    sealed = float(interval.sealed.max())
    if sealed > 0:
        text += f" Up to {percent(sealed)} of the samples are sealed."
    return text + (
        " The columns of the inputs show their first-order share in the variance of the logarithm of the leak rate; "
        "what is missing to 100 % comes from inputs acting together. The interval knows nothing of errors of the "
        "theory."
    )


def theory_table(result: SealResult) -> ReadableTable:
    """Leak rate at the lowest and highest fluid pressure with every reading of the theory; maybe no rows."""
    if not result.theory_variants:
        return ReadableTable((), ())
    order = sorted(range(len(result.loads)), key=lambda n: result.loads[n].point)
    shown = list(dict.fromkeys((order[0], order[-1])))
    of_case = [load.leak.leak_rate if load.leak else 0.0 for load in result.loads]
    largest = max(variant.leak_rate[n] for variant in result.theory_variants for n in shown)
    unit = unit_for("flow", largest)
    headings = ["p(u)", "channels", "P(u)", "percolation threshold"]
    for n in shown:
        pressure = load_name(result.loads[n], result.loads)
        headings += [f"leak rate at {pressure} [{unit.name}]", "over that of the case"]
    rows = []
    for variant in result.theory_variants:
        cells = [
            variant.interface_law + (" (used)" if variant.used else ""),
            _CHANNELS[variant.conductivity],
            variant.separation_width or "–",
            trimmed(variant.percolation_threshold),
        ]
        for n in shown:
            rate = variant.leak_rate[n]
            cells += [number(unit.of(rate)), number(ratio_to_case(rate, of_case[n]), 2)]
        rows.append(tuple(cells))
    return ReadableTable(tuple(headings), tuple(rows))


def theory_note(result: SealResult) -> str:
    """How far the readings lie apart; empty without them."""
    if not result.theory_variants:
        return ""
    load = max(range(len(result.loads)), key=lambda n: result.loads[n].point)
    rates = [variant.leak_rate[load] for variant in result.theory_variants]
    pressure = load_name(result.loads[load], result.loads)
    if min(rates) <= 0:
        return f"At {pressure} some readings of the theory say that the seal is tight, others that it leaks."
    return (
        f"At {pressure} the readings of the theory differ by up to a factor {number(max(rates) / min(rates), 2)}: a "
        "choice of model, not a precision. Direct numerical results favour the effective P(u) with the threshold "
        "0.42 (docs/verification.md); which p(u) carries the contact is open."
    )
