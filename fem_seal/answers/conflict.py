"""Readings that contradict what is expected of a seal: by how much, and which explanation is the likeliest.

Notation: y = ln Q, n draws of the prior, m readings.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from fem_seal.arrays import BoolArray, FloatArray
from fem_seal.case.measured import MeasuredLeak

_DATA_SETS = 4000
# Draws of which a path beside the contact is added to each, and steps of what an explanation leaves open.
_PATH_DRAWS, _STEPS = 2000, 281
# What an explanation leaves open, evenly in its logarithm: a factor, either way; leak of a path over that of the seal,
# geometric means; scatter of ln Q beyond what is stated; how many times as fast the leak rate falls from load to load.
# The draws have the theory's own error, so that little is left for the latter.
_FACTOR, _PATH, _SCATTER, _SLOPE = 1e3, (1e-3, 1e3), (0.03, 3.0), 1.5
# ln of a leak rate below which nothing leaks.
_SEALED_LOG_RATE = -80.0


@dataclass(frozen=True)
class Data:
    """Readings as the likelihood takes them, arrays of shape (m,).

    Parameters
    ----------
    y : ndarray
        ln of the leak rates, or of the instrument's limit.
    spread : ndarray
        Standard deviation of y.
    is_below : ndarray of bool
        Whether less leaked.
    """

    y: FloatArray
    spread: FloatArray
    is_below: BoolArray

    @classmethod
    def of(cls, readings: Sequence[MeasuredLeak], slack: float = 0.0) -> Data:
        """Of readings whose leak rates are known to `slack`."""
        y = np.log([reading.leak_rate for reading in readings])
        spread = np.hypot([reading.uncertainty for reading in readings], slack)
        return cls(y, spread, np.array([reading.is_below for reading in readings], dtype=bool))

    def log_likelihood(self, y: FloatArray) -> FloatArray:
        """Of each draw, from its y, shape (n, m); shape (n,)."""
        from scipy.special import log_ndtr

        distance = (self.y - y) / self.spread
        return np.asarray(np.where(self.is_below, log_ndtr(distance), -0.5 * distance**2).sum(axis=1))


def data_p_value(y: FloatArray, data: Data, seed: int) -> float:
    """Share of data sets of the prior that are as far from its mean as the readings, or farther.

    Parameters
    ----------
    y : ndarray, shape (n, m)
        Of draws of the prior.
    data : Data
    seed : int
    """
    random = np.random.default_rng(seed)
    draws = y[random.choice(len(y), _DATA_SETS, replace=len(y) < _DATA_SETS)]
    draws = draws + data.spread * random.standard_normal(draws.shape)
    shares = []
    if not data.is_below.all():
        values = draws[:, ~data.is_below]
        covariance = np.atleast_2d(np.cov(values.T)) + 1e-12 * np.eye(values.shape[1])
        inverse, mean = np.linalg.inv(covariance), values.mean(axis=0)
        offsets, offset = values - mean, data.y[~data.is_below] - mean
        distance = np.einsum("ij,jk,ik->i", offsets, inverse, offsets)
        shares.append(float((distance >= offset @ inverse @ offset).mean()))
    if data.is_below.any():
        shares.append(float((draws[:, data.is_below] <= data.y[data.is_below]).all(axis=1).mean()))
    # of several looks the most surprising
    return min(1.0, len(shares) * max(min(shares), 1.0 / _DATA_SETS))


@dataclass(frozen=True)
class Explanation:
    """What may have made readings that the prior can hardly have made.

    Parameters
    ----------
    name : {"path", "factor", "reading", "order", "slope", "scatter"}
        A path that no force closes (scratch, particle); one factor on all leak rates (fluid, form); one reading that is
        off alone; rows that have changed places; leak rates that change more or less from load to load than by the
        theory; readings that scatter more than their uncertainty says.
    log_evidence : float
        ln of the mean likelihood of the readings over all that it leaves open.
    size : float
        Where the likelihood is greatest: leak rate of the path at the reading that is farthest off [m^3/s], factor,
        factor of the reading, number of rows that have changed places, factor on the change from load to load, standard
        deviation of ln Q [-].
    readings : tuple of int
        Numbers of those that it is about.
    """

    name: str
    log_evidence: float
    size: float
    readings: tuple[int, ...] = ()


@dataclass(frozen=True)
class Conflict:
    """Readings that the prior can hardly have made.

    Parameters
    ----------
    factor : float
        Measured over expected, geometric mean [-].
    explanations : tuple of Explanation
        The likeliest first.
    farthest : int
        Number of the reading that is farthest from what is expected.
    """

    factor: float
    explanations: tuple[Explanation, ...]
    farthest: int = 0

    @property
    def likeliest(self) -> Explanation:
        """What explains the readings best."""
        return self.explanations[0]

    @property
    def probabilities(self) -> Mapping[str, float]:
        """Probability of each explanation, all alike before [-]."""
        shares = {x.name: math.exp(x.log_evidence - self.likeliest.log_evidence) for x in self.explanations}
        return {name: share / sum(shares.values()) for name, share in shares.items()}


def conflict_of(y: FloatArray, data: Data, drive: FloatArray) -> Conflict:
    """What explains readings that the prior can hardly have made, by likelihood.

    Parameters
    ----------
    y : ndarray, shape (n, m)
        Of draws of the prior.
    data : Data
    drive : ndarray, shape (m,)
        What drives a flow through an open path, in any unit.

    References
    ----------
    D. MacKay, Information Theory, Inference, and Learning Algorithms (2003), chapter 28: model comparison by evidence.
    """
    y = np.maximum(y, _SEALED_LOG_RATE)
    mean = y.mean(axis=0)
    distance = data.y - mean
    farthest = int(np.argmax(np.abs(distance) / np.hypot(y.std(axis=0), data.spread)))
    causes = sorted(_explanations(y, data, np.log(drive / drive[farthest])), key=lambda x: -x.log_evidence)
    return Conflict(math.exp(float(distance.mean())), tuple(causes), farthest)


@dataclass(frozen=True)
class _Normal:
    """A normal distribution of the readings' y.

    Parameters
    ----------
    mean : ndarray, shape (m,)
    covariance : ndarray, shape (m, m)
        Of what is expected, without the errors of the readings.
    """

    mean: FloatArray
    covariance: FloatArray

    @classmethod
    def of(cls, y: FloatArray) -> _Normal:
        return cls(y.mean(axis=0), np.atleast_2d(np.cov(y.T)))

    def log_density(self, data: Data) -> float:
        """ln of the likelihood of readings; one below the instrument's limit counts by itself."""
        from scipy.special import log_ndtr

        covariance, exact = self.covariance + np.diag(data.spread**2), ~data.is_below
        distance = data.y - self.mean
        root = np.linalg.cholesky(covariance[np.ix_(exact, exact)])
        scores = np.linalg.solve(root, distance[exact])
        limits = distance[data.is_below] / np.sqrt(np.diag(covariance)[data.is_below])
        normal = -0.5 * float(scores @ scores) - float(np.log(math.sqrt(2.0 * math.pi) * np.diag(root)).sum())
        return normal + float(log_ndtr(limits).sum())


def _explanations(y: FloatArray, data: Data, log_drive: FloatArray) -> Iterator[Explanation]:
    prior, count = _Normal.of(y), len(data.y)
    factors = np.linspace(-math.log(_FACTOR), math.log(_FACTOR), _STEPS)
    yield _explain("factor", [(s, (), prior.log_density(replace(data, y=data.y - s))) for s in factors])
    if count == 1:
        return
    draws = y[:: max(1, len(y) // _PATH_DRAWS)]
    paths = (prior.mean - log_drive).mean() + np.log(np.geomspace(*_PATH, _STEPS))
    with_path = ((s, _Normal.of(np.logaddexp(draws, s + log_drive))) for s in paths)
    yield _explain("path", [(s, (), normal.log_density(data)) for s, normal in with_path])
    one_off = ((s, n, s * (np.arange(count) == n)) for n in range(count) for s in factors)
    yield _explain(
        "reading", [(s, (n,), prior.log_density(replace(data, y=data.y - by))) for s, n, by in one_off]
    )
    orders = ((rows, _reorder(data, rows)) for rows in _changed_places(count))
    yield _explain("order", [(math.log(len(rows)), rows, prior.log_density(swap)) for rows, swap in orders])
    mean, centre = prior.mean, prior.mean.mean()
    slopes = np.linspace(-math.log(_SLOPE), math.log(_SLOPE), _STEPS)
    steeper = ((s, replace(prior, mean=centre + math.exp(s) * (mean - centre))) for s in slopes)
    yield _explain("slope", [(s, (), normal.log_density(data)) for s, normal in steeper])
    spreads = [np.hypot(data.spread, x) for x in np.geomspace(*_SCATTER, _STEPS)]
    wider = ((math.log(np.median(spread)), replace(data, spread=spread)) for spread in spreads)
    yield _explain("scatter", [(s, (), prior.log_density(other)) for s, other in wider])


def _explain(name: str, trials: Sequence[tuple[float, tuple[int, ...], float]]) -> Explanation:
    """An explanation from ln of its size, readings and likelihood, all alike before."""
    from scipy.special import logsumexp

    log_size, readings, _ = max(trials, key=lambda trial: trial[2])
    evidence = float(logsumexp([trial[2] for trial in trials])) - math.log(len(trials))
    return Explanation(name, evidence, math.exp(log_size), readings)


def _changed_places(count: int) -> Iterator[tuple[int, ...]]:
    """Numbers of rows that stand in the reverse order: two of them, or all."""
    yield from combinations(range(count), 2)
    if count > 3:
        yield tuple(range(count))


def _reorder(data: Data, rows: tuple[int, ...]) -> Data:
    """Readings with those of some rows in the reverse order."""
    order = np.arange(len(data.y))
    order[list(rows)] = rows[::-1]
    return Data(data.y[order], data.spread[order], data.is_below[order])
