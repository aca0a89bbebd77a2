"""C(q) of a surface from its scans, at nodes within the range in which they can be trusted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from leak.arrays import FloatArray
from leak.errors import ScanError
from leak.surfaces.fit import VarianceShare, fit_spectrum
from leak.surfaces.outliers import FoundOutliers, find_outliers, without_outliers
from leak.surfaces.periodogram import Periodogram, evidence, periodogram, pooled
from leak.surfaces.power_laws import power_law_moment, slopes
from leak.surfaces.range import ReliableRange, reliable_range, share_above
from leak.surfaces.scans import Topography
from leak.surfaces.self_affine_fit import RollOff, fit_rolloff
from leak.surfaces.settings import ScanSettings, SelfAffineContinuation

# Nodes of the spectrum per decade of q, and how far the fit looks beyond the shortest wave: oblique waves that are
# shorter show up in a line scan, too.
_PER_DECADE = 10
_BEYOND = 10.0
_FINE = 0.02


# q [1/m] and C [m^4]
Nodes = tuple[FloatArray, FloatArray]


@dataclass(frozen=True, eq=False)
class Estimate:
    """What the scans of a surface say about C(q), and what it was taken from.

    `measured` and `continued` are C(q) at nodes, within the reliable range and with the ends that the
    settings ask for; `log_error` is the standard deviation of ln C at the nodes of `measured`. All else has an entry
    for each scan: its spikes, its heights without form, their waves, range and variance [m^2].
    """

    measured: Nodes
    continued: Nodes
    log_error: FloatArray
    rolloff: RollOff
    outliers: tuple[FoundOutliers, ...]
    scans: tuple[Topography, ...]
    waves: tuple[Periodogram, ...]
    ranges: tuple[ReliableRange, ...]
    variances: FloatArray


def estimate(scans: Sequence[Topography], settings: ScanSettings) -> Estimate:
    """See `leak.measure`."""
    if not scans:
        raise ScanError("no scan: at least one is needed")
    found = tuple(find_outliers(scan) for scan in scans)
    if settings.outliers == "remove":
        scans = tuple(without_outliers(scan, one) for scan, one in zip(scans, found, strict=True))
    flat = tuple(_without_form(scan, settings) for scan in scans)
    waves = tuple(periodogram(scan, settings.window) for scan in flat)
    ranges = tuple(reliable_range(scan, one, settings) for scan, one in zip(flat, waves, strict=True))
    variances = np.array([float(np.mean(scan.heights**2)) for scan in flat])
    measured, log_error, rolloff = _spectrum(waves, ranges, variances)
    continued = _continued(measured, settings.extrapolation)
    return Estimate(measured, continued, log_error, rolloff, found, flat, waves, ranges, variances)


def _continued(nodes: Nodes, by: Literal["cut"] | SelfAffineContinuation) -> Nodes:
    """The spectrum with its ends continued."""
    if by == "cut":
        return nodes
    q, C = map(list, nodes)
    fall = -2.0 * (1.0 + by.hurst)
    if by.q_low is not None:
        if not by.q_low < q[0]:
            raise ScanError(f"q_low = {by.q_low:.4g} 1/m: must be below the reliable range, {q[0]:.4g} 1/m")
        q, C = [by.q_low, *q], [C[0] * (by.q_low / q[0]) ** fall, *C]
    if by.q_high is not None:
        if not by.q_high > q[-1]:
            raise ScanError(
                f"q_high = {by.q_high:.4g} 1/m: must be above the reliable range, {q[-1]:.4g} 1/m"
            )
        q, C = [*q, by.q_high], [*C, C[-1] * (by.q_high / q[-1]) ** fall]
    return np.array(q), np.array(C)


def _without_form(scan: Topography, settings: ScanSettings) -> Topography:
    flat = scan.without_form(settings.detrend)
    if float(np.abs(flat.heights).max()) <= 1e-12 * float(np.abs(scan.heights).max()):
        raise ScanError(
            f"{scan.name or 'scan'}: nothing is left without its {settings.detrend}; there is no roughness"
        )
    return flat


def _spectrum(
    modes: Sequence[Periodogram], ranges: Sequence[ReliableRange], variances: FloatArray
) -> tuple[Nodes, FloatArray, RollOff]:
    """C(q) over the range of all scans together, the standard deviation of ln C, and its roll-off."""
    low, high = min(one.q_low for one in ranges), max(one.q_high for one in ranges)
    count = max(round(_PER_DECADE * np.log10(high / low)), 3)
    step = np.log(high / low) / count
    nodes = low * np.exp(step * np.arange(count + 1 + round(np.log(_BEYOND) / step)))
    pieces = max(round(step / _FINE), 1)
    edges = low * np.exp(step / pieces * np.arange(pieces * (nodes.size - 1) + 1))
    seen = [
        evidence(one, _edges_within(nodes[: count + 1], reliable), edges)
        for one, reliable in zip(modes, ranges, strict=True)
    ]
    held = np.array(
        [v * (1.0 - share_above(one, r.q_high)) for v, one, r in zip(variances, modes, ranges, strict=True)]
    )
    within = np.mean([_overlap(edges, reliable) for reliable in ranges], axis=0)
    share = VarianceShare(float(held.mean()), np.sqrt(edges[1:] * edges[:-1]), 2.0 * np.pi * within)
    fit = fit_spectrum(nodes, pooled(seen), share)
    q, C = nodes[: count + 1], np.exp(fit.log_density[: count + 1])
    log_q, log_C = np.log(q), np.log(C)
    slope = slopes(log_q, log_C)
    ends = [np.log(np.clip([one.q_low, one.q_high], q[0], q[-1])) for one in ranges]
    now = 2.0 * np.pi * np.mean([power_law_moment(1, log_q, log_C, slope, *pair) for pair in ends])
    return (q, C * held.mean() / now), fit.log_error[: count + 1], fit_rolloff(q, seen, float(held.mean()))


def _edges_within(nodes: FloatArray, reliable: ReliableRange) -> FloatArray:
    """Nodes inside the range of one scan, with its ends."""
    inner = nodes[(nodes > reliable.q_low * 1.05) & (nodes < reliable.q_high / 1.05)]
    return np.concatenate([[reliable.q_low], inner, [reliable.q_high]])


def _overlap(edges: FloatArray, reliable: ReliableRange) -> FloatArray:
    """int q dq of each piece within the range of one scan."""
    return np.diff(0.5 * np.clip(edges, reliable.q_low, reliable.q_high) ** 2)
