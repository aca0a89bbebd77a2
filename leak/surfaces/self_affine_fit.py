"""Roll-off and Hurst exponent of a surface, straight from the Fourier power of its scans, and how well they are known.

ln C over ln q is taken as straight pieces: constant up to the roll-off, a shoulder, the self-affine part, and whatever
follows it (a filter, the noise of the instrument). Where they meet is not known: every place on a grid is tried, level
and slopes are those that make the measured power most likely, and each such line counts with its probability. So the
shoulder of the roll-off is not taken for the self-affine part, and the interval of the Hurst exponent knows that the
ends of that part are uncertain.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from leak.arrays import BoolArray, FloatArray
from leak.surfaces.periodogram import Evidence, pool_scans

CONFIDENCE = 0.9
"""Share of scans whose interval contains the truth."""
_ENDS = (0.5 - 0.5 * CONFIDENCE, 0.5 + 0.5 * CONFIDENCE)

# Above this share of the last wavenumber sampled heights hold waves that are shorter still (aliasing).
_TRUSTED_SHARE = 0.5
# Shortest self-affine part, lengths of the shoulder that are tried, and how far below the range a roll-off may lie, all
# in ln q; of the nodes every second one is tried as the end of the self-affine part.
_SHORTEST, _SHOULDERS, _REACH_BELOW, _STRIDE = np.log(4.0), (0.0, np.log(3.0), np.log(9.0)), np.log(4.0), 2
# Where the slopes of ln C over ln q are expected, shoulder, self-affine part and behind, and how far off they may be.
_SLOPES, _SPREADS = np.array([-1.5, -3.4, -6.0]), np.array([1.5, 1.0, 6.0])
# A self-affine part falls between these two slopes; a filter behind it falls more, noise less. The shoulder does not
# rise, and falls less than the self-affine part by some amount.
_LEAST_FALL, _MOST_FALL, _BEND = -2.0, -4.2, 0.2
# What the likelihood does not know, found from synthetic scans: through the window waves of neighbouring bins are
# correlated; and waves beyond the end of the data may be missing, of which oblique ones show up at longer
# waves, the more the less the spectrum falls. Factor on the error of the exponent, and part of it over 1 - H.
_CORRELATION, _MISSING_SHARE = 1.2, 0.04
# A Hurst exponent whose interval is wider than this says nothing.
_WIDEST = 0.4
# Mean square deviation of the power from the line, over that of chance, from which on there is no such line.
_NO_LINE = 4.0
# A line whose rms height is below that of the scans by more than this many of its standard deviations is not theirs.
_TOO_LOW = 2.5
# C is taken as constant over this many of the pieces of the evidence.
_COARSER = 3
_MOST_STEPS, _LONGEST_STEP, _CLOSE_STEP, _USABLE = 30, 2.0, 1e-4, 0.05


@dataclass(frozen=True, eq=False)
class TrueHeight:
    """What the rms height of a surface may be, over that of its scans.

    Scans that hold few waves of the roll-off have too much or too little of the longest waves by chance, and less of
    them without their form.

    Parameters
    ----------
    log_ratio, probability : ndarray, shape (n,)
        ln of the ratio, and the probability that it is not exceeded [-].
    """

    log_ratio: FloatArray = field(repr=False)
    probability: FloatArray = field(repr=False)

    def quantile(self, probability: FloatArray | Sequence[float]) -> FloatArray:
        """Ratio of the rms heights, surface over scans [-]."""
        return np.exp(np.interp(probability, self.probability, self.log_ratio))

    @property
    def interval(self) -> tuple[float, float]:
        """Contains the ratio with a probability of `CONFIDENCE` [-]."""
        low, high = self.quantile(_ENDS)
        return float(low), float(high)


@dataclass(frozen=True)
class RollOff:
    """Broken power law through a spectrum: constant up to `wavenumber`, then q^(-2 (1 + hurst)) from `start` to `end`.

    Parameters
    ----------
    wavenumber : float or None
        Roll-off, where constant and power law cross [1/m]; None if the scans show none.
    start, end : float
        Self-affine part, on the short-wave side of the roll-off's shoulder [1/m].
    hurst : float or None
        Hurst exponent; None if it is not determined: nothing falls like a self-affine spectrum over two octaves, or the
        interval is wider than 0.4 [-].
    hurst_error : float or None
        Standard deviation [-].
    hurst_interval : tuple of float or None
        Contains the exponent with a probability of `CONFIDENCE` [-].
    height : TrueHeight
        What the rms height of the surface may be.
    confidence : float
        Probability with which the intervals contain the truth.
    """

    wavenumber: float | None
    start: float
    end: float
    hurst: float | None
    hurst_error: float | None
    hurst_interval: tuple[float, float] | None
    height: TrueHeight = field(repr=False)
    confidence: float = CONFIDENCE


def fit_rolloff(nodes: FloatArray, evidence: Sequence[Evidence], variance: float) -> RollOff:
    """Roll-off, Hurst exponent and rms height that scans tell.

    Parameters
    ----------
    nodes : ndarray
        Wavenumbers over the reliable range, evenly spaced in ln q [1/m].
    evidence : sequence of Evidence
        One per scan.
    variance : float
        Mean square height of the scans within the range [m^2].

    References
    ----------
    P. Whittle, J. Royal Stat. Soc. B 15, 125 (1953): likelihood of Fourier power; L. Tierney, J. B. Kadane,
    J. Am. Stat. Assoc. 81, 82 (1986): probability of each line by Laplace's approximation.
    """
    trusted_bins = pool_scans([_trusted_bins(scan, _TRUSTED_SHARE * nodes[-1]) for scan in evidence])
    lines = _Lines.through(np.log(nodes), trusted_bins)
    waves = _scatter_of_waves(evidence)
    if lines is None:
        height = TrueHeight(*_mixture(np.ones(1), np.zeros(1), np.array([waves])))
        return RollOff(None, float(nodes[0]), float(nodes[-1]), None, None, None, height)
    low, high = np.log(nodes[0]), np.log(nodes[-1])
    best = int(np.argmax(lines.weight))
    hurst, error = -0.5 * lines.slopes[:, 1] - 1.0, 0.5 * _CORRELATION * np.sqrt(lines.covariance[:, 2, 2])
    error = np.hypot(error, _MISSING_SHARE * np.maximum(1.0 - hurst, 0.0))
    value, probability = _mixture(lines.weight, hurst, error)
    ends = np.interp(_ENDS, probability, value)
    is_narrow = bool(ends[1] - ends[0] <= _WIDEST)
    mean = float(lines.weight @ hurst)
    deviation = float(np.sqrt(lines.weight @ (error**2 + (hurst - mean) ** 2)))
    corner, crossing = lines.corner[best], lines.crossing[best]
    log_height, height_error = lines.log_height(high)
    log_ratio = log_height - 0.5 * np.log(variance)
    if lines.weight @ log_ratio < -_TOO_LOW * waves:
        # the scans hold waves that the line does not know, a form or a waviness
        log_ratio, height_error = np.zeros_like(log_ratio), np.full_like(height_error, waves)
    return RollOff(
        # within one node of the longest wave a flat part is a matter of chance
        float(np.exp(crossing)) if crossing > low + 1.5 * (high - low) / (nodes.size - 1) else None,
        float(np.exp(max(corner, low))),
        float(np.exp(min(lines.end[best], high))),
        mean if is_narrow else None,
        deviation if is_narrow else None,
        (float(ends[0]), float(ends[1])) if is_narrow else None,
        TrueHeight(*_mixture(lines.weight, log_ratio, height_error)),
    )


def _trusted_bins(scan: Evidence, last: float) -> Evidence:
    """Bins without aliasing, and coarser pieces of C."""
    keep = (scan.wavenumber <= last) & (scan.wavenumber > 1.5 * scan.wavenumber[0])
    firsts = np.arange(0, scan.samples.size, _COARSER)
    count = np.diff(np.append(firsts, scan.samples.size))
    return Evidence(
        scan.wavenumber[keep],
        scan.density[keep],
        scan.freedom[keep],
        np.exp(np.add.reduceat(np.log(scan.samples), firsts) / count),
        np.add.reduceat(scan.weights[keep], firsts, axis=1),
    )


@dataclass(frozen=True, eq=False)
class _Lines:
    """Broken lines of ln C over x = ln q, each the most likely one with these places.

    Parameters
    ----------
    start, corner, end : ndarray, shape (lines,)
        Where the constant ends, where the self-affine part begins, and where it ends (infinite if not in the data).
    values : ndarray, shape (lines, 4)
        Level of the constant; slopes of shoulder, self-affine part and behind.
    covariance : ndarray, shape (lines, 4, 4)
        Of the values.
    weight : ndarray, shape (lines,)
        Probability.
    """

    start: FloatArray
    corner: FloatArray
    end: FloatArray
    values: FloatArray
    covariance: FloatArray
    weight: FloatArray

    @classmethod
    def through(cls, x: FloatArray, evidence: Sequence[Evidence]) -> _Lines | None:
        """All that are a roll-off and a self-affine part; None if the data show no such thing."""
        places = _places(x)
        if not places.size or not any(scan.density.size for scan in evidence):
            return None
        start, corner, end = places.T
        bases = [_basis(np.log(scan.samples)[None, :], start, corner, end) for scan in evidence]
        values, cost, covariance, usable = _most_likely(bases, evidence)
        shoulder, slope, fall_behind = values[:, 1:].T
        usable &= slope < _LEAST_FALL
        usable &= (corner == start) | ((shoulder < 0.0) & (shoulder > slope + _BEND))
        usable &= np.isinf(end) | (fall_behind > _LEAST_FALL) | (fall_behind < _MOST_FALL)
        if not usable.any():
            return None
        # a surface that is no broken power law scatters more about it than chance does: it is known less well
        bins = sum(scan.density.size for scan in evidence)
        excess = max(1.0, 2.0 * float(cost[usable].min()) / max(bins - values.shape[1], 1))
        if excess > _NO_LINE:
            return None
        covariance = covariance * excess
        log_weight = (-cost / excess + 0.5 * np.linalg.slogdet(covariance)[1])[usable]
        weight = np.exp(log_weight - log_weight.max())
        return cls(
            start[usable],
            corner[usable],
            end[usable],
            values[usable],
            covariance[usable],
            weight / weight.sum(),
        )

    @property
    def slopes(self) -> FloatArray:
        """Of shoulder, self-affine part and behind, shape (lines, 3)."""
        return self.values[:, 1:]

    @property
    def crossing(self) -> FloatArray:
        """ln q where the constant meets the continued self-affine part, shape (lines,)."""
        shoulder, slope = self.slopes[:, 0], self.slopes[:, 1]
        return self.corner - (self.corner - self.start) * shoulder / slope

    def log_height(self, high: float) -> tuple[FloatArray, FloatArray]:
        """ln of the rms height in all waves up to ln q = `high`, and its standard deviation, shape (lines,)."""
        share = np.linspace(0.0, 1.0, 200)
        x = self.start[:, None] + (high - self.start[:, None]) * share
        basis = _basis(x, self.start, self.corner, self.end)
        density = np.exp(2.0 * x + np.einsum("lxk,lk->lx", basis, self.values))
        weight = density * np.gradient(x, axis=1)
        weight[:, [0, -1]] *= 0.5
        # all waves longer than the roll-off: C is constant there
        weight[:, 0] += 0.5 * density[:, 0]
        total = weight.sum(axis=1)
        gradient = np.einsum("lx,lxk->lk", weight / total[:, None], basis)
        error = np.sqrt(np.einsum("lj,ljk,lk->l", gradient, self.covariance, gradient))
        return 0.5 * np.log(2.0 * np.pi * total), 0.5 * _CORRELATION * error


def _places(x: FloatArray) -> FloatArray:
    """Where the pieces may meet: start, corner and end in ln q, shape (lines, 3)."""
    step, last = x[1] - x[0], x[-1] + np.log(_TRUSTED_SHARE)
    x_below = x[0] - step * np.arange(int(_REACH_BELOW / step), 0, -1)
    starts, ends = np.concatenate([x_below, x[:-1]]), np.append(x[::-1][1::_STRIDE], np.inf)
    start, shoulder, end = (
        values.ravel() for values in np.meshgrid(starts, np.array(_SHOULDERS), ends, indexing="ij")
    )
    corner = start + shoulder
    # what lies below the range shows no shoulder
    is_real = (shoulder == 0.0) | (start > x[0] + 0.5 * step)
    is_long = np.minimum(end, last) - np.maximum(corner, x[0]) > _SHORTEST - 1e-9
    return np.stack([start, corner, end], axis=1)[is_real & (np.isinf(end) | (end < last)) & is_long]


def _basis(x: FloatArray, start: FloatArray, corner: FloatArray, end: FloatArray) -> FloatArray:
    """Broken lines as a sum, shape (lines, x, 4): level, and how far into each piece x is."""
    start, corner, end = (values[:, None] for values in (start, corner, end))
    pieces = (
        np.ones(np.broadcast_shapes(x.shape, start.shape)),
        np.clip(x, start, corner) - start,
        np.clip(x, corner, end) - corner,
        np.maximum(x - end, 0.0),
    )
    return np.stack(pieces, axis=-1)


def _most_likely(
    bases: Sequence[FloatArray], evidence: Sequence[Evidence]
) -> tuple[FloatArray, FloatArray, FloatArray, BoolArray]:
    """Values of all lines by Fisher scoring: values, minus ln likelihood, covariance, and whether each converged."""
    lines = bases[0].shape[0]
    usual = np.array([0.0, *_SLOPES])
    values = np.tile(usual, (lines, 1))
    values[:, 0] = _level(bases[0], usual, evidence[0])
    cost, longest = np.empty(lines), np.empty(lines)
    curvature: FloatArray = np.empty((lines, 4, 4))
    # the samples last: power and slopes of all lines are then one product of matrices each
    bases, active = [np.ascontiguousarray(np.swapaxes(basis, 1, 2)) for basis in bases], np.arange(lines)
    for _ in range(_MOST_STEPS):
        cost[active], gradient, curvature[active] = _likelihood(values[active], usual, bases, evidence)
        step = np.linalg.solve(curvature[active], gradient[..., None])[..., 0]
        longest[active] = np.abs(step).max(axis=1)
        # most lines need a few steps, the last of them some twenty
        is_far = longest[active] >= _CLOSE_STEP
        if not is_far.any():
            break
        active, step = active[is_far], step[is_far]
        bases = [basis[is_far] for basis in bases]
        values[active] -= step * np.minimum(1.0, _LONGEST_STEP / longest[active])[:, None]
    covariance = np.asarray(np.linalg.inv(curvature), dtype=float)
    return values, cost, covariance, longest < _USABLE


def _likelihood(
    values: FloatArray, usual: FloatArray, bases: Sequence[FloatArray], evidence: Sequence[Evidence]
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Minus ln likelihood of lines, its gradient and its expected curvature; `bases` of shape (lines, 4, samples)."""
    stiffness = np.diag([1e-9, *_SPREADS**-2.0])
    shift = values - usual
    shift[:, 0] = 0.0
    cost = 0.5 * np.sum(shift @ stiffness * shift, axis=1)
    gradient = shift @ stiffness
    curvature = np.tile(stiffness, (len(values), 1, 1))
    for basis, scan in zip(bases, evidence, strict=True):
        C = np.exp(np.clip(np.einsum("lks,lk->ls", basis, values), -600.0, 300.0))
        power = np.maximum(C @ scan.weights.T, np.finfo(float).tiny)
        # of the power's logarithm; the level raises all of it alike
        slope = np.ones((len(values), 4, power.shape[1]))
        slope_power = (C[:, None, :] * basis[:, 1:]).reshape(-1, C.shape[1]) @ scan.weights.T
        slope[:, 1:] = slope_power.reshape(len(values), 3, -1) / power[:, None, :]
        ratio = np.minimum(scan.density / power, 1e30)
        n = scan.freedom
        cost += np.sum(n * (np.log(power / scan.density) + ratio - 1.0), axis=1)
        gradient += np.einsum("lkb,lb->lk", slope, n * (1.0 - ratio))
        curvature += np.matmul(n * slope, np.swapaxes(slope, 1, 2))
    return cost, gradient, curvature


def _level(basis: FloatArray, values: FloatArray, scan: Evidence) -> FloatArray:
    """Level at which lines with given slopes have the measured power on average, shape (lines,)."""
    C = np.exp(basis @ values)
    excess = np.log(scan.density) - np.log(np.maximum(C @ scan.weights.T, np.finfo(float).tiny))
    return np.average(excess, axis=1, weights=scan.freedom)


def _mixture(weight: FloatArray, mean: FloatArray, error: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Value and cumulative probability of a mixture of normal distributions."""
    from scipy.special import ndtr

    is_likely = weight > 1e-6 * weight.max()
    weight, mean, error = weight[is_likely], mean[is_likely], np.maximum(error[is_likely], 1e-6)
    value = np.linspace(float((mean - 5 * error).min()), float((mean + 5 * error).max()), 2001)
    share = np.sum(weight[:, None] * ndtr((value - mean[:, None]) / error[:, None]), axis=0) / weight.sum()
    # np.interp needs increasing probabilities
    is_rising = np.append(True, np.diff(share) > 0.0)
    return value[is_rising], share[is_rising]


def _scatter_of_waves(evidence: Sequence[Evidence]) -> float:
    """Standard deviation of ln rms height from the number of waves that carry it, whatever the spectrum is."""
    share = np.concatenate([scan.density / scan.density.sum() * scan.freedom for scan in evidence])
    freedom = np.concatenate([scan.freedom for scan in evidence])
    return 0.5 * float(np.sqrt(np.sum(share**2 / freedom)) / np.sum(share))
