"""A polynomial through a few runs of a smooth model, for the many samples of an uncertainty analysis."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations_with_replacement

import numpy as np

from fem_seal.arrays import FloatArray, IntArray

_HIGHEST_DEGREE = 6
# Runs per coefficient below which a least-squares polynomial follows single runs instead of the model.
_RUNS_PER_TERM = 1.6
# Variance of coefficients of degree 0, 1, 2 and 3 over that of what the polynomial leaves. With it standard errors
# suit leak rates of twelve seals, 150 to 200 samples each: elastic and yielding, liquid and gas, round and oval,
# finishes of a drawing and given spectra. The constant may be anything.
_PRIOR = (1e6, 100.0, 2.0, 0.06)


@dataclass(frozen=True)
class Polynomials:
    """Products of polynomials of the inputs up to some total degree, orthonormal over their distribution.

    Parameters
    ----------
    bases : tuple of ndarray
        For each input, matrix from the powers of its scaled value to the polynomials P_0, P_1, ...
    centre, scale : ndarray, shape (d,)
        The scaled value is (z - centre)/scale.
    exponents : ndarray of int, shape (terms, d)
        Degrees k_i of each term; the first is the constant.
    """

    bases: tuple[FloatArray, ...]
    centre: FloatArray
    scale: FloatArray
    exponents: IntArray

    @classmethod
    def of(cls, population: FloatArray, degree: int) -> Polynomials:
        """Those up to a degree.

        Parameters
        ----------
        population : ndarray, shape (n, d)
            Values of the inputs that represent their distribution.
        degree : int
        """
        centre, scale = population.mean(axis=0), population.std(axis=0)
        bases = tuple(_orthonormal((z - c) / s) for z, c, s in zip(population.T, centre, scale, strict=True))
        return cls(bases, centre, scale, _exponents(population.shape[1], degree))

    def __call__(self, inputs: FloatArray) -> FloatArray:
        """All terms at inputs of shape (n, d); shape (n, terms)."""
        design = np.ones((len(inputs), len(self.exponents)))
        for i, basis in enumerate(self.bases):
            powers = np.vander((inputs[:, i] - self.centre[i]) / self.scale[i], len(basis), increasing=True)
            design *= (powers @ basis)[:, self.exponents[:, i]]
        return design

    @property
    def prior(self) -> FloatArray:
        """How far each coefficient may be from zero, over what the polynomial leaves, shape (terms,)."""
        return np.sqrt(np.array(_PRIOR)[self.exponents.sum(axis=1)])

    def telling(self, candidates: FloatArray, count: int) -> IntArray:
        """Numbers of the runs that tell most of the coefficients, one after the other.

        Parameters
        ----------
        candidates : ndarray, shape (n, d)
            Inputs of runs that there may be.
        count : int
            How many are wanted, at most n.
        """
        design, covariance, chosen = self(candidates), np.diag(self.prior**2), list[int]()
        for _ in range(count):
            change = design @ covariance
            told = (change**2).sum(axis=1) / (1.0 + (change * design).sum(axis=1))
            told[chosen] = -1.0
            chosen.append(int(told.argmax()))
            own = change[chosen[-1]]
            covariance -= np.outer(own, own) / (1.0 + design[chosen[-1]] @ own)
        return np.array(chosen, dtype=np.intp)


@dataclass(frozen=True)
class ResponseSurface:
    """Polynomial of some total degree in independent random inputs, orthonormal over their distribution.

    y = sum_k c_k prod_i P_{k_i}(z_i), <P_m P_n> = delta_mn over each input, so that mean, variance and its shares
    are sums over the coefficients (polynomial chaos).

    Parameters
    ----------
    polynomials : Polynomials
    coefficients : ndarray, shape (terms, outputs)
    error : ndarray, shape (outputs,)
        Root-mean-square difference between each run and the polynomial through all other runs; with a prior, standard
        deviation of what the polynomial leaves.
    root : ndarray, shape (terms, terms)
        Its product with its transpose is the covariance of the coefficients, for an error of one.

    References
    ----------
    B. Sudret, Reliab. Eng. Syst. Saf. 93, 964 (2008): shares of variance from polynomial chaos.
    """

    polynomials: Polynomials
    coefficients: FloatArray
    error: FloatArray
    root: FloatArray = field(repr=False)

    def __call__(self, inputs: FloatArray) -> FloatArray:
        """Outputs at inputs of shape (n, d); shape (n, outputs)."""
        return self.polynomials(inputs) @ self.coefficients

    def drawn(self, count: int) -> FloatArray:
        """Coefficients that the runs leave possible, all alike likely, shape (terms, outputs, count)."""
        random = np.random.default_rng(count).standard_normal((len(self.root), count))
        return self.coefficients[:, :, None] + self.error[:, None] * (self.root @ random)[:, None]

    @property
    def variance(self) -> FloatArray:
        """Variance of each output over the inputs, shape (outputs,)."""
        return (self.coefficients[1:] ** 2).sum(axis=0)

    def variance_of(self, group: Sequence[int]) -> FloatArray:
        """Variance that the inputs of a group cause on their own, shape (outputs,)."""
        exponents = self.polynomials.exponents
        others = np.setdiff1d(np.arange(exponents.shape[1]), group)
        alone = (exponents[:, others] == 0).all(axis=1) & (exponents > 0).any(axis=1)
        return (self.coefficients[alone] ** 2).sum(axis=0)


def fit(
    inputs: FloatArray, outputs: FloatArray, population: FloatArray, runs_per_term: float = _RUNS_PER_TERM
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
    """
    best: ResponseSurface | None = None
    constant = Polynomials.of(population, 0)
    for degree in range(_HIGHEST_DEGREE + 1):
        polynomials = replace(constant, exponents=_exponents(inputs.shape[1], degree))
        if degree and len(inputs) < runs_per_term * len(polynomials.exponents):
            break
        design = polynomials(inputs)
        q, r = np.linalg.qr(design)
        coefficients = np.linalg.solve(r, q.T @ outputs)
        leverage = np.minimum((q**2).sum(axis=1), 1 - 1e-9)
        left_out = (outputs - design @ coefficients) / (1 - leverage)[:, None]
        error = np.sqrt((left_out**2).mean(axis=0))
        if best is None or error.max() < best.error.max():
            best = ResponseSurface(polynomials, coefficients, error, np.linalg.inv(r))
    assert best is not None
    return best


def fit_with_prior(polynomials: Polynomials, inputs: FloatArray, outputs: FloatArray) -> ResponseSurface:
    """Likeliest polynomial through runs, which may be fewer than its coefficients.

    Coefficients are known before to scatter around zero, the less the higher their degree (`_PRIOR`), in units of what
    the polynomial leaves; how much that is follows from the runs.

    Parameters
    ----------
    polynomials : Polynomials
    inputs : ndarray, shape (runs, d)
        At least two more runs than inputs.
    outputs : ndarray, shape (runs, outputs)

    References
    ----------
    A. Gelman et al., Bayesian Data Analysis, 3rd ed. (2013), section 14.8: a prior as further runs.
    """
    known_before = np.diag(1.0 / polynomials.prior)[1:]
    design = np.vstack([polynomials(inputs), known_before])
    values = np.vstack([outputs, np.zeros((len(known_before), outputs.shape[1]))])
    q, r = np.linalg.qr(design)
    coefficients = np.linalg.solve(r, q.T @ values)
    # the linear part may nearly be anything
    free = len(inputs) - inputs.shape[1] - 1
    error = np.sqrt(((values - design @ coefficients) ** 2).sum(axis=0) / free)
    return ResponseSurface(polynomials, coefficients, error, np.linalg.inv(r))


def variables(values: Mapping[str, FloatArray]) -> list[FloatArray]:
    """Variables of a polynomial for each input, shape (n, d): ln of a value, all weights of scans but the last.

    Parameters
    ----------
    values : mapping of ndarray
        Of each input, see `fem_seal.answers.uncertainty.LeakInterval`.
    """
    return [np.log(one)[:, None] if one.ndim == 1 else one[:, :-1] for one in values.values()]


def _orthonormal(values: FloatArray) -> FloatArray:
    """Matrix from powers 0, 1, ... of the values to polynomials that are orthonormal over them."""
    degree = min(_HIGHEST_DEGREE, len(np.unique(values)) - 1)
    powers = np.vander(values, degree + 1, increasing=True)
    _, r = np.linalg.qr(powers / np.sqrt(len(values)))
    matrix = np.zeros((_HIGHEST_DEGREE + 1,) * 2)
    matrix[: degree + 1, : degree + 1] = np.linalg.inv(r)
    return matrix


def _exponents(inputs: int, degree: int) -> IntArray:
    """Degrees of all terms up to a total degree, the constant first."""
    terms = [
        np.bincount(np.array(chosen, dtype=np.intp), minlength=inputs)
        for total in range(degree + 1)
        for chosen in combinations_with_replacement(range(inputs), total)
    ]
    return np.array(terms, dtype=np.intp).reshape(len(terms), inputs)
