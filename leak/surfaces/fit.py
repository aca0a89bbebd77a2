"""The smooth spectrum that explains the Fourier power of scans best, isotropic and positive.

The inverse Abel transform, C(q) = -(1/pi) int_q^inf C_1D'(k) dk / sqrt(k^2 - q^2), takes a derivative of data that
scatter by 100 % per mode. So the transform is used forwards: ln C at the nodes is what makes the measured power
most likely (Whittle), with as few bends in ln C over ln q as the data allow.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from leak.arrays import FloatArray
from leak.surfaces.periodogram import Evidence

# A bend of ln C at one of ten nodes per decade costs half a unit of log-likelihood when it is this large, and rises
# only linearly beyond, so that a roll-off or the end of a spectrum stays sharp.
_BEND = 0.25
# Spectra of surfaces hardly ever rise with q. Below the roll-off a line scan tells nearly nothing of C; there a slope
# of ln C over ln q above zero by this much costs half a unit.
_RISE = 0.4
# The variance of the scans is known better than any single long wave: to this relative accuracy.
_VARIANCE = 2e-3
_MOST_STEPS = 200
_CONVERGED = 1e-6


@dataclass(frozen=True, eq=False)
class VarianceShare:
    """Variance [m^2] that scans hold, and its expectation ``weights @ C(samples)``."""

    value: float
    samples: FloatArray
    weights: FloatArray


@dataclass(frozen=True, eq=False)
class SpectrumFit:
    """Result: ln C and its standard deviation at the nodes, shape (nodes,)."""

    log_density: FloatArray
    log_error: FloatArray


@dataclass(frozen=True, eq=False)
class _Terms:
    """A part of minus the log-likelihood, its gradient and its expected second derivative."""

    cost: float
    gradient: FloatArray
    curvature: FloatArray


def fit_spectrum(nodes: FloatArray, evidence: Sequence[Evidence], variance: VarianceShare) -> SpectrumFit:
    """Fit ln C, linear in ln q between nodes, to the binned power of scans and their variance.

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
    now = terms(log_C)
    for _ in range(_MOST_STEPS):
        step = -np.linalg.solve(now.curvature, now.gradient)
        step *= min(1.0, 3.0 / float(np.abs(step).max()))
        promised = -float(now.gradient @ step)
        if promised < _CONVERGED:
            break
        for fraction in 0.5 ** np.arange(12):
            trial = terms(log_C + fraction * step)
            if trial.cost <= now.cost - 1e-3 * fraction * promised:
                break
        else:
            break
        log_C, now = log_C + fraction * step, trial
    return SpectrumFit(log_C, np.sqrt(np.diag(np.linalg.inv(now.curvature))))


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

        samples = np.concatenate([*(one.samples for one in evidence), variance.samples])
        data = np.concatenate([*(one.density for one in evidence), [variance.value]])
        freedom = np.concatenate([one.freedom for one in evidence])
        weights = block_diag(*(one.weights for one in evidence), variance.weights[None, :])
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
        rising = self.rises[rise > 0.0]
        return _Terms(
            float(np.sum(length) + 0.5 * np.sum(rise**2)),
            self.bends.T @ (bend / length) + self.rises.T @ rise,
            # a node that no data reach keeps its place
            (self.bends.T / length) @ self.bends + rising.T @ rising + 1e-6 * np.eye(log_C.size),
        )


def _start(log_nodes: FloatArray, evidence: Sequence[Evidence]) -> FloatArray:
    """Data over what C = (q/q_bin)^-3 would give in their place, smoothed a little."""
    log_q = np.concatenate([np.log(one.wavenumber) for one in evidence])
    level = np.concatenate([np.log(one.density) - _log_of_steep_spectrum(one) for one in evidence])
    order = np.argsort(log_q)
    rough = np.interp(log_nodes, log_q[order], level[order])
    return np.convolve(np.pad(rough, 2, mode="edge"), np.full(5, 0.2), mode="valid")


def _log_of_steep_spectrum(one: Evidence) -> FloatArray:
    ratio = one.samples[None, :] / one.wavenumber[:, None]
    return np.log(np.sum(one.weights * ratio**-3.0, axis=1))


def _hat_functions(log_q: FloatArray, log_nodes: FloatArray) -> FloatArray:
    """Linear interpolation in ln q as a matrix, continued as constant outside the nodes."""
    place = np.clip((log_q - log_nodes[0]) / (log_nodes[1] - log_nodes[0]), 0.0, log_nodes.size - 1.0)
    return np.maximum(1.0 - np.abs(place[:, None] - np.arange(log_nodes.size)), 0.0)
