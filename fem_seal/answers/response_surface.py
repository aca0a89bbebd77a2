"""A polynomial through a few runs of a smooth model, for the many samples of an uncertainty analysis."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations_with_replacement

import numpy as np

from fem_seal.arrays import FloatArray, IntArray

_HIGHEST_DEGREE = 6
# Runs per coefficient below which a least-squares polynomial follows single runs instead of the model.
_RUNS_PER_TERM = 1.35
# Error of a left-out run over the scatter, above which ln Q bends towards sealing; ln of how far it is followed.
_ERROR_OF_BENT, _LEAST_LOG = 0.2, 6.0
# What is less is no leak: a molecule of a gas in a hundred years [m^3/s], or so much of what the case itself leaks.
# Next to sealing a sample that leaks so little may be off by a factor, and nobody sees it.
_NO_LEAK, _TRACE = 1e-35, 1e-9
# Beside the runs of the polynomial: samples at both ends of the interval, calculated to see how well it does there.
_CHECKS = 4
# Loads that are sampled where there are more.
_LOADS = 5
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

    def choose_runs(self, candidates: FloatArray, count: int) -> IntArray:
        """Numbers of the runs that tell most of the coefficients, one after the other.

        Parameters
        ----------
        candidates : ndarray, shape (n, d)
            Inputs of runs that there may be.
        count : int
            How many are wanted, at most n.
        """
        design, covariance, numbers = self(candidates), np.diag(self.prior**2), list[int]()
        for _ in range(count):
            change = design @ covariance
            gains = (change**2).sum(axis=1) / (1.0 + (change * design).sum(axis=1))
            gains[numbers] = -1.0
            numbers.append(int(gains.argmax()))
            row = change[numbers[-1]]
            covariance -= np.outer(row, row) / (1.0 + design[numbers[-1]] @ row)
        return np.array(numbers, dtype=np.intp)


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

    def draw(self, count: int) -> FloatArray:
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


def first_runs(inputs: int) -> int:
    """Runs that a quadratic polynomial in so many inputs needs."""
    return math.ceil(_RUNS_PER_TERM * (inputs + 1) * (inputs + 2) / 2) + 1


def fit(inputs: FloatArray, outputs: FloatArray, population: FloatArray) -> ResponseSurface:
    """Least-squares polynomial through runs, of the degree that predicts left-out runs best.

    Parameters
    ----------
    inputs : ndarray, shape (runs, d)
    outputs : ndarray, shape (runs, outputs)
    population : ndarray, shape (n, d)
        Values of the inputs that represent their distribution; the runs may be among them.
    """
    best: ResponseSurface | None = None
    constant = Polynomials.of(population, 0)
    for degree in range(_HIGHEST_DEGREE + 1):
        polynomials = replace(constant, exponents=_exponents(inputs.shape[1], degree))
        if degree and len(inputs) < _RUNS_PER_TERM * len(polynomials.exponents):
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


def bent_towards_sealing(
    surface: ResponseSurface, runs: FloatArray, logs: FloatArray, population: FloatArray
) -> FloatArray:
    """ln Q of a population, also where it falls the faster the nearer a sample is to sealing.

    A quadratic polynomial does not follow that: at the upper end of its samples too much leaks, in the median too
    little. Where it leaves much, the likeliest cubic one of -ln(bound - ln Q) takes its place.

    Parameters
    ----------
    surface : ResponseSurface
    runs : ndarray, shape (runs, d)
    logs : ndarray, shape (runs, outputs)
        ln Q of the runs.
    population : ndarray, shape (n, d)
    """
    ln_rates = surface(population)
    poor = surface.error > _ERROR_OF_BENT * np.sqrt(surface.variance)
    if not np.any(poor):
        return ln_rates
    # not by the standard deviation, most of which may be that of one sample next to sealing
    bound = logs.max(axis=0) + 0.5 * np.subtract(*np.quantile(logs, (0.84, 0.16), axis=0))
    cubic = fit_with_prior(Polynomials.of(population, 3), runs, -np.log(bound - logs))
    return np.where(poor, bound - np.exp(np.minimum(-cubic(population), _LEAST_LOG)), ln_rates)


def largest_difference(estimate: FloatArray, truth: FloatArray, of_case: FloatArray) -> float:
    """Relative difference of samples, shape (samples, columns), whose case leaks so much in each column."""
    floor = np.maximum(_NO_LEAK, _TRACE * np.where(np.isfinite(of_case), of_case, 0.0))
    with np.errstate(invalid="ignore"):
        differ = np.abs((estimate + floor) / (truth + floor) - 1)
    # both blown open is no difference; a path that did not converge says nothing
    return float(np.nan_to_num(differ, nan=0.0).max())


def allowed_difference(leak_rate: FloatArray, least: float, share: float) -> float:
    """How far samples that scatter like these may be off, from shares of one and of their scatter in ln Q.

    At each load the samples that leak count, also where it seals or opens others, or all at another load.
    """
    columns = [column[(column > 0) & np.isfinite(column)] for column in leak_rate.T]
    widths = [np.diff(np.quantile(np.log(column), (0.05, 0.95))) for column in columns if column.size]
    return max(least, share * float(np.max(widths, initial=0.0)))


def representative(log_line_load: FloatArray) -> IntArray:
    """Places of few loads over the whole range, the last one among them; of all if they are few."""
    count = len(log_line_load)
    if count <= _LOADS:
        return np.arange(count)
    places = np.linspace(0, count - 1, _LOADS).round().astype(int)
    return np.unique([*np.argsort(log_line_load, kind="stable")[places], count - 1])


def at_all_loads(log_line_load: FloatArray, places: IntArray, ratios: FloatArray) -> FloatArray:
    """Ratios of leak rates at all loads from those at few, shape (kinds, samples, places) to (.., .., loads)."""
    from scipy.interpolate import PchipInterpolator

    nodes, first = np.unique(log_line_load[places], return_index=True)
    nearest = np.argmin(np.abs(log_line_load[:, None] - log_line_load[places]), axis=1)
    all_ratios = ratios[..., nearest]
    smooth = np.all((ratios > 0) & np.isfinite(ratios), axis=-1)
    if len(first) > 1 and smooth.any():
        interpolator = PchipInterpolator(nodes, np.log(ratios[smooth][:, first]), axis=-1)
        all_ratios[smooth] = np.exp(interpolator(log_line_load))
    return all_ratios


def samples_at_ends(leak_rate: FloatArray, confidence: float) -> IntArray:
    """Samples at the ends of an interval: the lower one of the smaller reading, the upper one of the larger.

    Parameters
    ----------
    leak_rate : ndarray, shape (samples, readings)
    confidence : float
    """
    last, numbers = len(leak_rate) - 1, list[int]()
    for share, outer in ((0.5 - 0.5 * confidence, np.argmin), (0.5 + 0.5 * confidence, np.argmax)):
        order = np.argsort(leak_rate[:, outer(np.quantile(leak_rate, share, axis=0, method="lower"))])
        numbers += [int(order[min(last, int(share * last) + n)]) for n in range(_CHECKS // 2)]
    return np.unique(numbers)


def variables(values: Mapping[str, FloatArray]) -> list[FloatArray]:
    """Variables of a polynomial for each input, shape (n, d): ln of a value, all weights of scans but the last.

    Parameters
    ----------
    values : mapping of ndarray
        Of each input, see `fem_seal.answers.uncertainty.LeakInterval`.
    """
    return [np.log(column)[:, None] if column.ndim == 1 else column[:, :-1] for column in values.values()]


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
        np.bincount(np.array(factors, dtype=np.intp), minlength=inputs)
        for total in range(degree + 1)
        for factors in combinations_with_replacement(range(inputs), total)
    ]
    return np.array(terms, dtype=np.intp).reshape(len(terms), inputs)
