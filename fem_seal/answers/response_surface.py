"""A polynomial through a few runs of a smooth model, for the many samples of an uncertainty analysis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import combinations_with_replacement

import numpy as np
from numpy.typing import NDArray

from fem_seal.arrays import FloatArray

IntArray = NDArray[np.intp]

_HIGHEST_DEGREE = 6
# Runs per coefficient below which a least-squares polynomial follows single runs instead of the model.
_RUNS_PER_TERM = 1.6


@dataclass(frozen=True)
class ResponseSurface:
    """Polynomial of some total degree in independent random inputs, orthonormal over their distribution.

    y = sum_k c_k prod_i P_{k_i}(z_i), <P_m P_n> = delta_mn over each input, so that mean, variance and its shares
    are sums over the coefficients (polynomial chaos).

    Parameters
    ----------
    bases : tuple of ndarray
        For each input, matrix from the powers of its scaled value to the polynomials P_0, P_1, ...
    centre, scale : ndarray, shape (d,)
        The scaled value is (z - centre)/scale.
    exponents : ndarray of int, shape (terms, d)
        Degrees k_i of each term; the first is the constant.
    coefficients : ndarray, shape (terms, outputs)
    error : ndarray, shape (outputs,)
        Root-mean-square difference between each run and the polynomial through all other runs.
    influence : ndarray, shape (terms, runs)
        Change of the coefficients per change of an output of a run.
    left_out : ndarray, shape (runs, outputs)
        Each run minus the polynomial through all other runs.

    References
    ----------
    B. Sudret, Reliab. Eng. Syst. Saf. 93, 964 (2008): shares of variance from polynomial chaos.
    """

    bases: tuple[FloatArray, ...]
    centre: FloatArray
    scale: FloatArray
    exponents: IntArray
    coefficients: FloatArray
    error: FloatArray
    influence: FloatArray = field(repr=False)
    left_out: FloatArray = field(repr=False)

    def __call__(self, inputs: FloatArray) -> FloatArray:
        """Outputs at inputs of shape (n, d); shape (n, outputs)."""
        return _design(inputs, self.bases, self.centre, self.scale, self.exponents) @ self.coefficients

    def without_each(self, inputs: FloatArray, output: int) -> FloatArray:
        """An output at inputs of shape (n, d) by the polynomials through all runs but one, shape (n, runs)."""
        design = _design(inputs, self.bases, self.centre, self.scale, self.exponents)
        changes = self.influence * self.left_out[:, output]
        return design @ (self.coefficients[:, [output]] - changes)

    @property
    def variance(self) -> FloatArray:
        """Variance of each output over the inputs, shape (outputs,)."""
        return (self.coefficients[1:] ** 2).sum(axis=0)

    def variance_of(self, group: Sequence[int]) -> FloatArray:
        """Variance that the inputs of a group cause on their own, shape (outputs,)."""
        others = np.setdiff1d(np.arange(self.exponents.shape[1]), group)
        alone = (self.exponents[:, others] == 0).all(axis=1) & (self.exponents > 0).any(axis=1)
        return (self.coefficients[alone] ** 2).sum(axis=0)


def fit(
    inputs: FloatArray,
    outputs: FloatArray,
    population: FloatArray,
    runs_per_term: float = _RUNS_PER_TERM,
    lowest_degree: int = 0,
) -> ResponseSurface:
    """Least-squares polynomial through runs, of the degree that predicts left-out runs best.

    Parameters
    ----------
    inputs : ndarray, shape (runs, d)
    outputs : ndarray, shape (runs, outputs)
    population : ndarray, shape (n, d)
        Values of the inputs that represent their distribution; the runs may be among them.
    runs_per_term : float
        Runs that there must be for each coefficient, above 1.
    lowest_degree : int
        Of the polynomials among which it is chosen.
    """
    centre, scale = population.mean(axis=0), population.std(axis=0)
    bases = tuple(_orthonormal((z - c) / s) for z, c, s in zip(population.T, centre, scale, strict=True))
    best: ResponseSurface | None = None
    for degree in range(lowest_degree, _HIGHEST_DEGREE + 1):
        exponents = _exponents(inputs.shape[1], degree)
        if degree > lowest_degree and len(inputs) < runs_per_term * len(exponents):
            break
        design = _design(inputs, bases, centre, scale, exponents)
        q, r = np.linalg.qr(design)
        influence = np.linalg.solve(r, q.T)
        coefficients = np.linalg.solve(r, q.T @ outputs)
        leverage = np.minimum((q**2).sum(axis=1), 1 - 1e-9)
        left_out = (outputs - design @ coefficients) / (1 - leverage)[:, None]
        error = np.sqrt((left_out**2).mean(axis=0))
        if best is None or error.max() < best.error.max():
            best = ResponseSurface(bases, centre, scale, exponents, coefficients, error, influence, left_out)
    assert best is not None
    return best


def _orthonormal(values: FloatArray) -> FloatArray:
    """Matrix from powers 0, 1, ... of the values to polynomials that are orthonormal over them."""
    degree = min(_HIGHEST_DEGREE, len(np.unique(values)) - 1)
    powers = np.vander(values, degree + 1, increasing=True)
    _, r = np.linalg.qr(powers / np.sqrt(len(values)))
    matrix = np.zeros((_HIGHEST_DEGREE + 1,) * 2)
    matrix[: degree + 1, : degree + 1] = np.linalg.inv(r)
    return matrix


def _design(
    inputs: FloatArray,
    bases: Sequence[FloatArray],
    centre: FloatArray,
    scale: FloatArray,
    exponents: IntArray,
) -> FloatArray:
    design = np.ones((len(inputs), len(exponents)))
    for i, basis in enumerate(bases):
        powers = np.vander((inputs[:, i] - centre[i]) / scale[i], len(basis), increasing=True)
        design *= (powers @ basis)[:, exponents[:, i]]
    return design


def _exponents(inputs: int, degree: int) -> IntArray:
    """Degrees of all terms up to a total degree, the constant first."""
    terms = [
        np.bincount(np.array(chosen, dtype=np.intp), minlength=inputs)
        for total in range(degree + 1)
        for chosen in combinations_with_replacement(range(inputs), total)
    ]
    return np.array(terms, dtype=np.intp).reshape(len(terms), inputs)
