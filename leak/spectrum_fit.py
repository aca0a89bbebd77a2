"""The smooth spectrum that explains the Fourier power of scans best, isotropic and positive.

The inverse Abel transform, C(q) = -(1/pi) int_q^inf C_1D'(k) dk / sqrt(k^2 - q^2), takes a derivative of data that
scatter by 100 % per mode. So the transform is used forwards: ln C at the nodes is what makes the measured power
most likely (Whittle), with as few bends in ln C over ln q as the data allow.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from leak.periodogram import Evidence

FloatArray = NDArray[np.float64]

# Standard deviation of a bend of ln C from node to node at ten nodes per decade; beyond it bends cost only linearly, so
# that a roll-off or the end of a spectrum stays sharp.
_BEND = 0.1
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
    log_nodes = np.log(nodes)
    samples = np.concatenate([*(one.samples for one in evidence), variance.samples])
    hats = _hat_functions(np.log(samples), log_nodes)
    data = np.concatenate([one.density for one in evidence])
    freedom = np.concatenate([one.freedom for one in evidence])
    weights = _block_diagonal([*(one.weights for one in evidence), variance.weights[None, :]])
    bends = np.diff(np.eye(nodes.size), 2, axis=0)
    scale = _BEND * (log_nodes[1] - log_nodes[0]) / (0.1 * np.log(10.0))

    def model(log_C: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Log of the expected data and its derivative."""
        C = np.exp(hats @ log_C)
        value = weights @ C
        return np.log(value), (weights @ (C[:, None] * hats)) / value[:, None]

    def cost(log_C: FloatArray, log_value: FloatArray) -> float:
        misfit = log_value[:-1] - np.log(data)
        likelihood = np.sum(freedom * (misfit + np.exp(-misfit)))
        bent = np.sum(np.sqrt(1.0 + (bends @ log_C / scale) ** 2))
        return float(likelihood + bent + 0.5 * ((log_value[-1] - np.log(variance.value)) / _VARIANCE) ** 2)

    log_C = _start(log_nodes, evidence)
    log_value, slope = model(log_C)
    now = cost(log_C, log_value)
    for _ in range(_MOST_STEPS):
        gradient, hessian = _derivatives(log_C, log_value, slope, data, freedom, variance.value, bends, scale)
        step = -np.linalg.solve(hessian, gradient)
        step *= min(1.0, 3.0 / float(np.abs(step).max()))
        promised = -float(gradient @ step)
        for fraction in 0.5 ** np.arange(12):
            log_value, slope = model(log_C + fraction * step)
            trial = cost(log_C + fraction * step, log_value)
            if trial <= now - 1e-3 * fraction * promised:
                break
        else:
            break
        log_C, now = log_C + fraction * step, trial
        if promised < _CONVERGED:
            break
    log_value, slope = model(log_C)
    _, hessian = _derivatives(log_C, log_value, slope, data, freedom, variance.value, bends, scale)
    return SpectrumFit(log_C, np.sqrt(np.diag(np.linalg.inv(hessian))))


def _derivatives(
    log_C: FloatArray,
    log_value: FloatArray,
    slope: FloatArray,
    data: FloatArray,
    freedom: FloatArray,
    variance: float,
    bends: FloatArray,
    scale: float,
) -> tuple[FloatArray, FloatArray]:
    """Gradient, and the expected second derivative, which is always positive definite."""
    excess = 1.0 - np.exp(np.clip(np.log(data) - log_value[:-1], None, 50.0))
    bent = bends @ log_C / scale
    stiffness = 1.0 / (scale**2 * np.sqrt(1.0 + bent**2))
    pull = (log_value[-1] - np.log(variance)) / _VARIANCE**2
    gradient = slope[:-1].T @ (freedom * excess) + pull * slope[-1] + bends.T @ (stiffness * (bends @ log_C))
    hessian = slope[:-1].T @ (freedom[:, None] * slope[:-1]) + bends.T @ (stiffness[:, None] * bends)
    hessian += np.outer(slope[-1], slope[-1]) / _VARIANCE**2
    # a node that no data reach, such as one at the end of the last wave, keeps its place
    return gradient, hessian + 1e-6 * np.eye(log_C.size)


def _start(log_nodes: FloatArray, evidence: Sequence[Evidence]) -> FloatArray:
    """Data over what a spectrum of constant slope would give in their place, smoothed a little."""
    q = np.concatenate([np.log(one.wavenumber) for one in evidence])
    guess = np.concatenate([np.log(one.density) for one in evidence])
    flat = np.concatenate([_slope_weight(one) for one in evidence])
    order = np.argsort(q)
    rough = np.interp(log_nodes, q[order], (guess - flat)[order])
    return np.convolve(np.pad(rough, 2, mode="edge"), np.full(5, 0.2), mode="valid")


def _slope_weight(one: Evidence) -> FloatArray:
    """Log of the data that C = (q/q_bin)^-3 would give in each bin."""
    ratio = one.samples[None, :] / one.wavenumber[:, None]
    return np.log(np.sum(one.weights * np.minimum(ratio, 1e6) ** -3.0, axis=1))


def _hat_functions(log_q: FloatArray, log_nodes: FloatArray) -> FloatArray:
    """Linear interpolation in ln q as a matrix, continued as constant outside the nodes."""
    place = np.clip((log_q - log_nodes[0]) / (log_nodes[1] - log_nodes[0]), 0.0, log_nodes.size - 1.0)
    return np.maximum(1.0 - np.abs(place[:, None] - np.arange(log_nodes.size)), 0.0)


def _block_diagonal(blocks: Sequence[FloatArray]) -> FloatArray:
    from scipy.linalg import block_diag

    return np.asarray(block_diag(*blocks))
