"""C(q) of a surface from its scans, at nodes within the range in which they can be trusted.

The inverse Abel transform, C(q) = -(1/pi) int_q^inf C_1D'(k) dk / sqrt(k^2 - q^2), takes a derivative of data that
scatter by 100 % per mode. So the transform is used forwards: ln C at the nodes is what makes the measured power
most likely (Whittle), with as few bends in ln C over ln q as the data allow.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from leak.arrays import FloatArray
from leak.errors import ScanError, um
from leak.numerics.integrals import power_law_moment, slopes
from leak.numerics.roots import MOST_STEPS
from leak.surfaces.periodogram import Evidence, Periodogram, evidence, periodogram, pool_scans
from leak.surfaces.scans import (
    LEAST_RANGE,
    FoundOutliers,
    ScanSettings,
    SelfAffineContinuation,
    Topography,
    find_outliers,
    without_outliers,
)
from leak.surfaces.self_affine_fit import RollOff, fit_rolloff

# Nodes of the spectrum per decade of q, and bins in which its end is looked for; and how far the fit looks beyond the
# shortest wave: oblique waves that are shorter show up in a line scan, too.
_PER_DECADE = 10
_REACH_BEYOND = 10.0
_FINE = 0.02


# q [1/m] and C [m^4]
Nodes = tuple[FloatArray, FloatArray]


@dataclass(frozen=True, eq=False)
class Estimate:
    """What the scans of a surface say about C(q), and what it was taken from.

    `measured_nodes` and `continued_nodes` are C(q) at nodes, within the reliable range and with the ends that the
    settings ask for; `log_error` is the standard deviation of ln C at the measured ones. All else has an entry
    for each scan: its spikes, its heights without form, their waves, range and variance [m^2].
    """

    measured_nodes: Nodes
    continued_nodes: Nodes
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
    outliers = tuple(find_outliers(scan) for scan in scans)
    if settings.outliers == "remove":
        scans = tuple(without_outliers(scan, outlier) for scan, outlier in zip(scans, outliers, strict=True))
    flat = tuple(_without_form(scan, settings) for scan in scans)
    waves = tuple(periodogram(scan, settings.window) for scan in flat)
    ranges = tuple(reliable_range(scan, modes, settings) for scan, modes in zip(flat, waves, strict=True))
    variances = np.array([float(np.mean(scan.heights**2)) for scan in flat])
    nodes, log_error, rolloff = _spectrum(waves, ranges, variances)
    nodes_with_ends = _continue_ends(nodes, settings.extrapolation)
    return Estimate(nodes, nodes_with_ends, log_error, rolloff, outliers, flat, waves, ranges, variances)


def _continue_ends(nodes: Nodes, by: Literal["cut"] | SelfAffineContinuation) -> Nodes:
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
    low, high = min(r.q_low for r in ranges), max(r.q_high for r in ranges)
    count = max(round(_PER_DECADE * np.log10(high / low)), 3)
    step = np.log(high / low) / count
    nodes = low * np.exp(step * np.arange(count + 1 + round(np.log(_REACH_BEYOND) / step)))
    pieces = max(round(step / _FINE), 1)
    edges = low * np.exp(step / pieces * np.arange(pieces * (nodes.size - 1) + 1))
    bins = [
        evidence(scan, _edges_within(nodes[: count + 1], reliable), edges)
        for scan, reliable in zip(modes, ranges, strict=True)
    ]
    variance = np.array(
        [v * (1.0 - share_above(scan, r.q_high)) for v, scan, r in zip(variances, modes, ranges, strict=True)]
    )
    # int q dq of each piece within the range of each scan
    area = np.mean([np.diff(0.5 * np.clip(edges, r.q_low, r.q_high) ** 2) for r in ranges], axis=0)
    share = VarianceShare(float(variance.mean()), np.sqrt(edges[1:] * edges[:-1]), 2.0 * np.pi * area)
    log_density, log_error = (values[: count + 1] for values in fit_spectrum(nodes, pool_scans(bins), share))
    q, C = nodes[: count + 1], np.exp(log_density)
    log_q, log_C = np.log(q), np.log(C)
    slope = slopes(log_q, log_C)
    ends = [np.log(np.clip([r.q_low, r.q_high], q[0], q[-1])) for r in ranges]
    variance_now = 2.0 * np.pi * np.mean([power_law_moment(1, log_q, log_C, slope, *pair) for pair in ends])
    return (q, C * variance.mean() / variance_now), log_error, fit_rolloff(q, bins, float(variance.mean()))


def _edges_within(nodes: FloatArray, reliable: ReliableRange) -> FloatArray:
    """Nodes inside the range of one scan, with its ends."""
    inner = nodes[(nodes > reliable.q_low * 1.05) & (nodes < reliable.q_high / 1.05)]
    return np.concatenate([[reliable.q_low], inner, [reliable.q_high]])


# -------------------------------------------------------------------- the fit

# A bend of ln C at one of ten nodes per decade costs half a unit of log-likelihood when it is this large, and rises
# only linearly beyond, so that a roll-off or the end of a spectrum stays sharp.
_BEND = 0.25
# Spectra of surfaces hardly ever rise with q. Below the roll-off a line scan tells nearly nothing of C; there a slope
# of ln C over ln q above zero by this much costs half a unit.
_RISE = 0.4
# The variance of the scans is known better than any single long wave: to this relative accuracy.
_VARIANCE = 2e-3
_LEAST_GAIN = 1e-6


@dataclass(frozen=True, eq=False)
class VarianceShare:
    """Variance [m^2] that scans hold, and its expectation ``weights @ C(samples)``."""

    value: float
    samples: FloatArray
    weights: FloatArray


@dataclass(frozen=True, eq=False)
class _Terms:
    """A part of minus the log-likelihood, its gradient and its expected second derivative."""

    cost: float
    gradient: FloatArray
    curvature: FloatArray


def fit_spectrum(
    nodes: FloatArray, evidence: Sequence[Evidence], variance: VarianceShare
) -> tuple[FloatArray, FloatArray]:
    """ln C, linear in ln q between nodes, by the binned power of scans and their variance, and its standard error.

    Each bin holds the mean of `freedom` exponentially distributed numbers, so that minus the log-likelihood is
    sum of freedom (ln model + data/model). Minimised by Fisher scoring with a line search.

    Parameters
    ----------
    nodes : ndarray, shape (nodes,)
        Wavenumbers, evenly spaced in ln q [1/m].
    evidence : sequence of Evidence
        One per scan.
    variance : VarianceShare
        What the spectrum must add up to.

    References
    ----------
    P. Whittle, J. Royal Stat. Soc. B 15, 125 (1953).
    """
    power = _Power.of(np.log(nodes), evidence, variance)
    smoothness = _Smoothness.at(np.log(nodes))

    def terms(log_C: FloatArray) -> _Terms:
        parts = (power.terms(log_C), smoothness.terms(log_C))
        return _Terms(
            *(sum(getattr(part, name) for part in parts) for name in ("cost", "gradient", "curvature"))
        )

    log_C = _start(np.log(nodes), evidence)
    state = terms(log_C)
    for _ in range(MOST_STEPS):
        step = -np.linalg.solve(state.curvature, state.gradient)
        step *= min(1.0, 3.0 / float(np.abs(step).max()))
        expected_gain = -float(state.gradient @ step)
        if expected_gain < _LEAST_GAIN:
            break
        for fraction in 0.5 ** np.arange(12):
            trial = terms(log_C + fraction * step)
            if trial.cost <= state.cost - 1e-3 * fraction * expected_gain:
                break
        else:
            break
        log_C, state = log_C + fraction * step, trial
    return log_C, np.sqrt(np.diag(np.linalg.inv(state.curvature)))


@dataclass(frozen=True, eq=False)
class _Power:
    """What the scans say: mean power of the bins, and last the variance."""

    log_data: FloatArray
    freedom: FloatArray
    weights: FloatArray
    hats: FloatArray

    @classmethod
    def of(cls, log_nodes: FloatArray, evidence: Sequence[Evidence], variance: VarianceShare) -> _Power:
        from scipy.linalg import block_diag

        samples = np.concatenate([*(scan.samples for scan in evidence), variance.samples])
        data = np.concatenate([*(scan.density for scan in evidence), [variance.value]])
        freedom = np.concatenate([scan.freedom for scan in evidence])
        weights = block_diag(*(scan.weights for scan in evidence), variance.weights[None, :])
        return cls(np.log(data), freedom, weights, _hat_functions(np.log(samples), log_nodes))

    def terms(self, log_C: FloatArray) -> _Terms:
        C = np.exp(self.hats @ log_C)
        value = self.weights @ C
        slope = (self.weights @ (C[:, None] * self.hats)) / value[:, None]
        misfit = np.log(value) - self.log_data
        ratio = np.exp(np.clip(-misfit[:-1], None, 100.0))
        n, total = self.freedom, misfit[-1] / _VARIANCE
        return _Terms(
            float(np.sum(n * (misfit[:-1] + ratio)) + 0.5 * total**2),
            slope[:-1].T @ (n * (1.0 - ratio)) + slope[-1] * total / _VARIANCE,
            slope[:-1].T @ (n[:, None] * slope[:-1]) + np.outer(slope[-1], slope[-1]) / _VARIANCE**2,
        )


@dataclass(frozen=True, eq=False)
class _Smoothness:
    """What is expected of any spectrum: few bends, no rise with q."""

    bends: FloatArray
    rises: FloatArray

    @classmethod
    def at(cls, log_nodes: FloatArray) -> _Smoothness:
        n, step = log_nodes.size, log_nodes[1] - log_nodes[0]
        per_decade = np.log(10.0) / step
        return cls(
            np.diff(np.eye(n), 2, axis=0) / (_BEND * 10.0 / per_decade),
            np.diff(np.eye(n), axis=0) / (_RISE * step),
        )

    def terms(self, log_C: FloatArray) -> _Terms:
        bend, rise = self.bends @ log_C, np.maximum(self.rises @ log_C, 0.0)
        length = np.sqrt(1.0 + bend**2)
        rising_bends = self.rises[rise > 0.0]
        return _Terms(
            float(np.sum(length) + 0.5 * np.sum(rise**2)),
            self.bends.T @ (bend / length) + self.rises.T @ rise,
            # a node that no data reach keeps its place
            (self.bends.T / length) @ self.bends + rising_bends.T @ rising_bends + 1e-6 * np.eye(log_C.size),
        )


def _start(log_nodes: FloatArray, evidence: Sequence[Evidence]) -> FloatArray:
    """Data over what C = (q/q_bin)^-3 would give in their place, smoothed a little."""
    log_q = np.concatenate([np.log(scan.wavenumber) for scan in evidence])
    level = np.concatenate([np.log(scan.density) - _log_of_steep_spectrum(scan) for scan in evidence])
    order = np.argsort(log_q)
    rough = np.interp(log_nodes, log_q[order], level[order])
    return np.convolve(np.pad(rough, 2, mode="edge"), np.full(5, 0.2), mode="valid")


def _log_of_steep_spectrum(scan: Evidence) -> FloatArray:
    ratio = scan.samples[None, :] / scan.wavenumber[:, None]
    return np.log(np.sum(scan.weights * ratio**-3.0, axis=1))


def _hat_functions(log_q: FloatArray, log_nodes: FloatArray) -> FloatArray:
    """Linear interpolation in ln q as a matrix, continued as constant outside the nodes."""
    place = np.clip((log_q - log_nodes[0]) / (log_nodes[1] - log_nodes[0]), 0.0, log_nodes.size - 1.0)
    return np.maximum(1.0 - np.abs(place[:, None] - np.arange(log_nodes.size)), 0.0)


# -------------------------------------------------------------------- the reliable range

# Waves this weak against the strongest one are not there at all; and where the mean power in bins falls by more than
# this from one to the next, never to return, the heights were filtered or calculated.
_NO_POWER, _SHARP = 1e-9, 1e-3


@dataclass(frozen=True)
class ReliableRange:
    """Wavenumbers that a scan can tell [1/m], and what limits them at the upper end."""

    q_low: float
    q_high: float
    limit: str


def reliable_range(scan: Topography, modes: Periodogram, settings: ScanSettings) -> ReliableRange:
    """Wavenumbers that a scan without form can tell; ScanError if they span less than two octaves."""
    limits = {"sampling": np.pi / scan.resolution}
    present = np.flatnonzero(modes.power > _NO_POWER * modes.power.max())
    end = _sharp_end(modes)
    if end is not None:
        limits["no shorter waves in the data"] = end
    if settings.shortest_wavelength is not None:
        limits["shortest wavelength"] = 2.0 * np.pi / settings.shortest_wavelength
    tip = settings.tip_radius or scan.tip_radius
    if tip is not None:
        limits["tip radius"] = _tip_limit(modes, tip)
    limit = min(limits, key=lambda name: limits[name])
    low, high = max(2.0 * np.pi / scan.length, modes.wavenumber[present[0]]), limits[limit]
    if high < LEAST_RANGE * low:
        raise ScanError(
            f"{scan.name or 'scan'}: nothing reliable is left between its length, {um(scan.length)}, and the "
            f"shortest wave, {um(2 * np.pi / high)} ({limit})"
        )
    return ReliableRange(low, high, limit)


def _tip_limit(modes: Periodogram, tip_radius: float) -> float:
    """Wavenumber up to which a profile bends less than the tip can follow [1/m]."""
    mean_q4 = np.mean(modes.vector**4, axis=1)
    curvature = np.sqrt(np.cumsum(modes.shares * mean_q4))
    beyond_tip = np.flatnonzero(curvature > 0.5 / tip_radius)
    return float(modes.wavenumber[beyond_tip[0]]) if beyond_tip.size else np.inf


def _sharp_end(modes: Periodogram) -> float | None:
    """Wavenumber above which there is nothing, as in filtered or calculated heights [1/m]; None without one.

    A spectrum that ends within the range of the fit would make it ring.
    """
    q, power = modes.wavenumber, modes.power
    edges = np.geomspace(q[0], q[-1], max(int(_PER_DECADE * np.log10(q[-1] / q[0])), 1) + 1)
    bins = np.clip(np.searchsorted(edges, q, side="right") - 1, 0, edges.size - 2)
    count = np.bincount(bins, minlength=edges.size - 1)
    mean = np.bincount(bins, power, minlength=edges.size - 1)[count > 0] / count[count > 0]
    highest_after = np.maximum.accumulate(mean[::-1])[::-1]
    drops = np.flatnonzero(highest_after[1:] < _SHARP * mean[:-1])
    if not drops.size:
        return None
    last_bin = np.unique(bins)[drops[0]]
    strong = np.flatnonzero((power > 0.1 * mean[drops[0]]) & (bins <= last_bin + 1))
    return float(q[strong[-1]])


def share_above(modes: Periodogram, q: float) -> float:
    """Share of the variance in waves above a wavenumber [-]."""
    shares = modes.shares
    return float(np.sum(shares[modes.wavenumber > q * (1 + 1e-9)]) / np.sum(shares))
