"""What a leak test says about a seal: its uncertain inputs and its leak rates, given measured ones.

Bayes' rule on samples. Draws of the prior, the uncertain inputs of the case and the error of the theory, have the
likelihood of the readings as weights. Leak rates of the draws come from a polynomial through a few runs of each group
of loads (`fem_seal.answers.uncertainty`).

Notation: y = ln Q, n draws, m readings, l loads of the case.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from fem_seal.answers import measurements
from fem_seal.answers.accuracy import ACCURACY
from fem_seal.answers.answer import Request, loads_of
from fem_seal.answers.case_load import CaseLoad, SolvedSeal
from fem_seal.answers.conflict import Conflict, Data, conflict_of, data_p_value
from fem_seal.answers.judgement import PassProbability
from fem_seal.answers.leakage_class import limits
from fem_seal.answers.opening import OPENING
from fem_seal.answers.pass_probability import why_none
from fem_seal.answers.posterior import Posterior, columns_of
from fem_seal.answers.response_surface import fit, variables
from fem_seal.answers.samples import AnyInput, drawn_values, uncertain_inputs
from fem_seal.answers.solution import SealSolution, answer_parts
from fem_seal.answers.uncertainty import leak_interval
from fem_seal.answers.verdict import VERDICT, Verdicts, seal_verdict, with_verdicts
from fem_seal.arrays import FloatArray, IntArray
from fem_seal.case.case import Case
from fem_seal.case.measured import MeasuredLeak, with_fluid
from fem_seal.case.roughness import HEIGHTS, UncertainFinish
from fem_seal.case.tables import Uncertainty, curves
from fem_seal.errors import InputError, SealError
from fem_seal.files import problem
from fem_seal.sampling import sobol_points
from fem_seal.seal.evaluate import SILENT, evaluate_seal
from fem_seal.seal.findings import Bounds
from fem_seal.seal.heating import with_contact_temperatures
from fem_seal.seal.load_solver import Clock, Progress
from fem_seal.seal.problem import SealProblem, problems_of
from fem_seal.seal.scenarios import TEST_GAS, with_own_contacts
from fem_seal.validity.checks import validity_of

_DRAWS = 2**15
# Draws that keep the posterior: as many as a run has samples in its finest intervals.
_POSTERIOR_DRAWS = 512
# Draws that the posterior must be worth.
_FEWEST = 50.0
# Largest share of data sets of the prior that are farther from it than those that are called a conflict.
_CONFLICT = 0.02
# Draws of the posterior that say what a next test is expected to leave.
_PREDICTION_DRAWS = 4096
# Of values that a finish leaves open.
_UNITS = {
    **dict.fromkeys(HEIGHTS, "m"),
    **{"q_rolloff": "1/m", "q_high": "1/m", "hurst": "-", "lay": "-", "rms_height": "factor"},
    **{"nose_radius": "m", "fine_height": "-", "phase": "-"},
}
_SHARES = (0.05, 0.5, 0.95)
# What a reading below the instrument's limit and a sealed draw count as.
_NO_LEAK = -1e3

Percentiles = tuple[float, float, float]


@dataclass(frozen=True)
class Prediction:
    """Leak rate of one load before and after the test: 5, 50 and 95 % of the draws stay below [m^3/s]."""

    fluid_pressure: float
    applied_force: float
    prior: Percentiles
    posterior: Percentiles


@dataclass(frozen=True)
class LearnedInput:
    """One uncertain input before and after the test.

    Parameters
    ----------
    name : str
        Key, or "theory" of the theory's own error.
    prior, posterior : tuple of float
        5, 50 and 95 % of the draws stay below: of a factor, or of a value that a finish leaves open [SI].
    unit : str
        "factor", or the SI unit of a value, "-" of one without.
    """

    name: str
    prior: Percentiles
    posterior: Percentiles
    unit: str = "factor"

    @property
    def narrowing(self) -> float:
        """One less the ratio of both widths, of logarithms [-]."""
        prior, posterior = (math.log(ends[2] / ends[0]) for ends in (self.prior, self.posterior))
        return 1.0 - posterior / prior if prior > 0.0 else 0.0


@dataclass(frozen=True)
class NextTest:
    """A test that could follow, and how far it would narrow the last prediction.

    Parameters
    ----------
    name : str
        "force", "pressure", "unloading", "gas" or "hardness".
    fluid : str
    fluid_pressure, applied_force, largest_earlier_force : float
        NaN where it is no leak test [Pa], [N], [N].
    width, expected_width : float
        95 over 5 % of the leak rate now, and expected after the test [-].
    """

    name: str
    fluid: str = ""
    fluid_pressure: float = math.nan
    applied_force: float = math.nan
    largest_earlier_force: float = math.nan
    width: float = math.nan
    expected_width: float = math.nan

    @property
    def narrowing(self) -> float:
        """Share of the width of ln Q that goes [-]."""
        return 1.0 - math.log(self.expected_width) / math.log(self.width) if self.width > 1.0 else 0.0


@dataclass(frozen=True)
class Calibration:
    """What measured leak rates say about a seal.

    Parameters
    ----------
    case : Case
    readings : tuple of MeasuredLeak
    prior_rates, posterior_rates : tuple of Percentiles
        Leak rate of each reading's load before and after the test [m^3/s].
    predictions : tuple of Prediction
        Of each load of the case.
    inputs : tuple of LearnedInput
    p_value : float
        Share of data sets of the prior that are farther from it than the readings [-].
    conflict : Conflict or None
    alternatives : mapping
        Probability of each theory, reading of yielding and history that could be compared, all alike before [-].
    next_tests : tuple of NextTest
        The most informative first.
    effective_draws : float
        Draws that the posterior is worth.
    posterior : Posterior
        As many draws of it as a case samples.
    solution : SealSolution or None
        The loads of the case with the interval that the test has left and their verdicts; None without a requirement,
        and where the calibration is not settled.

    Examples
    --------
    >>> found = fem_seal.calibrate("seal.toml", "measured.csv")  # doctest: +SKIP
    >>> found.conflict is None, round(found.p_value, 2)  # doctest: +SKIP
    (True, 0.45)
    """

    case: Case
    readings: tuple[MeasuredLeak, ...]
    prior_rates: tuple[Percentiles, ...]
    posterior_rates: tuple[Percentiles, ...]
    predictions: tuple[Prediction, ...]
    inputs: tuple[LearnedInput, ...]
    p_value: float
    conflict: Conflict | None
    alternatives: Mapping[str, float]
    next_tests: tuple[NextTest, ...]
    effective_draws: float
    posterior: Posterior = field(repr=False)
    solution: SealSolution | None = field(default=None, repr=False)

    @property
    def is_usable(self) -> bool:
        """Whether draws of the posterior can stand for it in other calculations."""
        return self.conflict is None and self.effective_draws >= _FEWEST


# -------------------------------------------------------------------- draws and their leak rates


@dataclass(frozen=True)
class _Group:
    """Loads of one case, of which every draw has a leak rate.

    Parameters
    ----------
    points : list of tuple
        Fluid pressure [Pa] and applied force [N].
    log_rate : ndarray, shape (readings, loads, n)
        y by the theory; `_NO_LEAK` of what is sealed.
    bias, spread : ndarray, shape (loads,)
        Of the theory's own error [-].
    log_peak : ndarray, shape (loads,)
        Decimal logarithm of the peak pressure [Pa].
    slack : float
        Standard deviation of what the polynomial may be off by.
    """

    points: list[tuple[float, float]]
    log_rate: FloatArray
    bias: FloatArray
    spread: FloatArray
    log_peak: FloatArray
    slack: float


def _group(
    case: Case, settings: Uncertainty | None, values: Mapping[str, FloatArray], progress: Progress
) -> _Group:
    """Leak rates of all draws, with these values of the inputs, at the loads of a case.

    Raises
    ------
    InputError
        If a draw is blown open or no polynomial can be found.
    """
    case = with_contact_temperatures(case)
    evaluations = evaluate_seal(problems_of(case), clock=Clock(progress))
    seal = SolvedSeal.of(evaluations, case, loads_of(evaluations))
    leaks = [[scenario.leak for scenario in (load, *load.others.values())] for load in seal.loads]
    of_case = np.array([[math.nan if leak is None else leak.leak_rate for leak in row] for row in leaks]).T
    log_rate, slack = _logarithm(of_case)[:, :, None].repeat(_DRAWS, axis=2), 0.0
    if settings is not None and uncertain_inputs(case, settings):
        interval = leak_interval(seal, settings, progress)
        rates = np.array([interval.leak_rate, *interval.others.values()])
        if np.isinf(rates).any():
            raise InputError(problem("calibrate_open"))
        leaking = (rates > 0.0).all(axis=(0, 1))
        flat = _logarithm(rates).reshape(-1, rates.shape[2])
        of_samples = np.concatenate(variables(interval.values), axis=1)
        of_draws = np.concatenate(variables({name: values[name] for name in interval.values}), axis=1)
        surface = fit(of_samples[leaking], flat[:, leaking].T, of_samples)
        log_rate = surface(of_draws).T.reshape(*of_case.shape, _DRAWS)
        slack = max(float(surface.error.max()), interval.error or 0.0)
    errors = [load.flow_error for load in seal.loads]
    bias, spread = (
        np.array([0.0 if error is None else float(getattr(error, name)) for error in errors])
        for name in ("bias", "spread")
    )
    peaks = np.log10([load.peak_pressure for load in seal.loads])
    return _Group([load.point for load in seal.loads], log_rate, bias, spread, peaks, slack)


def _logarithm(rates: FloatArray) -> FloatArray:
    with np.errstate(divide="ignore"):
        return np.maximum(np.log(rates), _NO_LEAK)


@dataclass(frozen=True)
class _Joint:
    """Leak rates of all draws at the loads of several groups, the theory's error included.

    Parameters
    ----------
    y : ndarray, shape (n, loads)
        Draws of all readings of yielding asperities, one after the other.
    error : ndarray, shape (n, loads)
        The theory's error in each draw, in standard deviations.
    factor : ndarray, shape (n, loads)
        ln of what it makes.
    log_peak : ndarray, shape (loads,)
        See `_Group`.
    slack : float
    """

    y: FloatArray
    error: FloatArray
    factor: FloatArray
    log_peak: FloatArray
    slack: float

    @classmethod
    def of(cls, groups: Sequence[_Group], seed: int) -> _Joint:
        peaks, bias, spread = (
            np.concatenate([getattr(group, name) for group in groups])
            for name in ("log_peak", "bias", "spread")
        )
        log_rate = np.concatenate([group.log_rate for group in groups], axis=1)
        normal = np.random.default_rng(seed).standard_normal((log_rate.shape[0] * _DRAWS, peaks.size))
        error = normal @ measurements.error_root(peaks).T
        factor = bias + spread * error
        y = log_rate.transpose(0, 2, 1).reshape(-1, peaks.size) + factor
        return cls(y, error, factor, peaks, max(group.slack for group in groups))


# -------------------------------------------------------------------- Bayes' rule


def weights_of(log_likelihood: FloatArray) -> FloatArray:
    """Weights of draws, their sum one."""
    weights = np.exp(log_likelihood - log_likelihood.max())
    return np.asarray(weights / weights.sum())


def percentiles(values: FloatArray, weights: FloatArray, shares: Percentiles = _SHARES) -> Percentiles:
    """Values that 5, 50 and 95 % of the weight stay below, or three other shares; shapes (n,)."""
    return tuple(measurements.weighted_quantiles(values, weights, shares).tolist())


# -------------------------------------------------------------------- the calibration


def calibrate(
    case: Case, readings: Sequence[MeasuredLeak], progress: Progress = lambda text: None
) -> Calibration:
    """What measured leak rates say about a seal.

    Parameters
    ----------
    case : Case
        With roughness and fluid; its loads are what is predicted.
    readings : sequence of MeasuredLeak
    progress : callable
        Called with a status message before each step.

    Raises
    ------
    InputError
        If the case has no leak rate, or a load of it or of a reading cannot be calculated.

    References
    ----------
    A. Gelman et al., Bayesian Data Analysis (2013), section 10.4: importance sampling; 6.3: predictive checks.
    """
    if case.roughness is None or case.fluid is None or case.leak.conductivity == "direct":
        raise InputError(problem("calibrate_without_leak"))
    if case.uncertainty is not None and case.uncertainty.posterior is not None:
        raise InputError(problem("calibrate_again"))
    settings, seed = case.sampling, 1 if case.sampling is None else case.sampling.seed
    inputs = () if settings is None else uncertain_inputs(case, settings)
    uniform = sobol_points(_DRAWS, max(sum(uncertain.dimensions for uncertain in inputs), 1), seed)
    input_values = drawn_values(inputs, uniform)
    values = {uncertain.name: uncertain.reported_values(input_values[uncertain.name]) for uncertain in inputs}
    base = case.replace({"requirement": None, "load.target_leak_rate": None})
    tests = _load_tests(base)
    progress("leak rates of the case's own loads")
    # on the bodies of the case, unless the loads are a path
    alike = [n for n, reading in enumerate(readings) if not curves(base) and _alike(reading.case, base)]
    points = [
        *base.load.points,
        *(readings[n].case.load.points[0] for n in alike),
        *(point for _, point in tests),
    ]
    groups = [_group(with_points(base, points), settings, values, progress)]
    if groups[0].points[: len(base.load.points)] != list(base.load.points):
        raise InputError(problem("calibrate_load"))
    place: dict[int, int] = {}
    for n in alike:
        if (point := readings[n].case.load.points[0]) not in groups[0].points:
            raise InputError(problem("calibrate_reading", line=readings[n].line))
        place[n] = groups[0].points.index(point)
    for numbers, leak_case in _by_fluid_and_memory(readings, without=alike):
        progress(f"leak rates of {len(numbers)} readings")
        place |= {n: sum(len(group.points) for group in groups) + k for k, n in enumerate(numbers)}
        groups.append(_group(leak_case, _settings_for(leak_case, case, settings), values, progress))
        if len(groups[-1].points) != len(numbers):
            raise InputError(problem("calibrate_reading", line=readings[numbers[0]].line))
    first = sum(len(group.points) for group in groups)
    others: list[NextTest] = []
    for name, variant in _other_tests(base):
        with suppress(SealError):
            progress(f"leak rates of a next test: {name}")
            groups.append(_group(variant, _settings_for(variant, case, settings), values, progress))
            others.append(NextTest(name, _fluid(variant), *variant.load.points[-1], _earlier(variant)))
    joint = _Joint.of(groups, seed)
    places = [place[n] for n in range(len(readings))]
    y = joint.y[:, places]
    data = Data.of(readings, joint.slack)
    weights = weights_of(data.log_likelihood(y))
    picks = _resample(weights, _PREDICTION_DRAWS, seed)
    p_value = data_p_value(y, data, seed)
    conflict = conflict_of(y, data, _drive(readings)) if p_value < _CONFLICT else None
    last = len(base.load.points) - 1
    candidates = [
        (NextTest(name, case.fluid.name, *point), joint.y[picks, groups[0].points.index(point)])
        for name, point in tests
        if point in groups[0].points
    ]
    candidates += [(test, joint.y[picks, first + n]) for n, test in enumerate(others)]
    copies = len(joint.y) // _DRAWS
    columns = {name: np.tile(column, copies) for name, column in values.items() if column.ndim == 1}
    flat = np.full(len(weights), 1.0 / len(weights))
    theory = {"theory": np.exp(joint.factor[:, last])} if np.ptp(joint.factor[:, last]) > 0.0 else {}
    units = {finish.name: _UNITS[finish.name] for finish in inputs if isinstance(finish, UncertainFinish)}
    result = Calibration(
        case,
        tuple(readings),
        tuple(_exp(percentiles(rates, flat)) for rates in y.T),
        tuple(_exp(percentiles(rates, weights)) for rates in y.T),
        tuple(
            Prediction(*point, *(_exp(percentiles(joint.y[:, n], weight)) for weight in (flat, weights)))
            for n, point in enumerate(base.load.points)
        ),
        tuple(
            LearnedInput(name, percentiles(col, flat), percentiles(col, weights), units.get(name, "factor"))
            for name, col in {**columns, **theory}.items()
        ),
        p_value,
        conflict,
        _alternatives(base, readings, data, y, settings, values, progress),
        _next_tests(
            candidates,
            joint.y[picks, last],
            {name: np.log(column[picks]) for name, column in columns.items()},
        ),
        float(1.0 / (weights**2).sum()),
        _posterior(inputs, uniform, joint, weights, [*range(last + 1), *places], seed),
    )
    judges = result.is_usable and case.requirement is not None
    return (
        replace(result, solution=_judge(case, joint.y[:, : last + 1], weights, progress))
        if judges
        else result
    )


def _judge(case: Case, y: FloatArray, weights: FloatArray, progress: Progress) -> SealSolution:
    """The loads of a case with the interval that a test has left of each, and what is said of its requirement."""
    progress("verdict after the test")
    case = with_contact_temperatures(case)
    evaluations = evaluate_seal(problems_of(case))
    seal = answer_parts(
        SolvedSeal.of(evaluations, case, loads_of(evaluations)),
        Request(evaluations[0].solver, SILENT),
        [ACCURACY, OPENING],
    )
    tail, loads = 0.5 - 0.5 * (case.sampling or Uncertainty()).confidence, []
    shares = tail, 0.5, 1.0 - tail
    for load, rates in zip(seal.loads, y.T, strict=True):
        low, middle, high = _exp(percentiles(rates, weights, shares))
        tested_load = load.with_values(
            validity=load.validity_by(validity_of, evaluations),
            sample_ends=Bounds(low, high),
            leak_rate_p50=middle,
            after_test=True,
            scenarios={
                name: _sampled_as(load, scenario, low, high) if name == TEST_GAS else scenario
                for name, scenario in load.scenarios.items()
            },
        )
        loads.append(tested_load.with_values(chance=_pass_chance(case, tested_load, rates, weights)))
    judged_loads = with_verdicts(case, loads)
    verdict = Verdicts(
        seal_verdict(case, judged_loads, seal.load_problems, seal.problem.hardness),
        tuple(load.judgement for load in judged_loads),
    )
    return SealSolution(**vars(seal.with_loads(judged_loads)), answers={VERDICT.name: verdict})


def _sampled_as(load: CaseLoad, scenario: CaseLoad, low: float, high: float) -> CaseLoad:
    """A scenario of a load with the ends of draws that leak as much more than the load itself as it does."""
    assert load.leak is not None and scenario.leak is not None  # of draws
    ratio = scenario.leak.leak_rate / load.leak.leak_rate if load.leak.leak_rate > 0.0 else 1.0
    return scenario.with_values(sample_ends=Bounds(ratio * low, ratio * high))


def _pass_chance(case: Case, load: CaseLoad, y: FloatArray, weights: FloatArray) -> PassProbability | None:
    """Weight of the draws of a load that keep the requirement; None where nothing is required of it."""
    if case.requirement is None or not case.requirement.judges(load.fluid_pressure):
        return None
    if why := why_none(case, load):
        return PassProbability(why_none=why)
    top = min(math.log(limit.leak_rate / limit.ratio[1]) for limit in limits(case, load.fluid_pressure, load))
    share = min(float(weights[y <= top].sum()), 1.0)
    return PassProbability(share, math.sqrt(share * (1.0 - share) * float((weights**2).sum())))


def _exp(logarithms: Percentiles) -> Percentiles:
    low, middle, high = (math.exp(ln_rate) if ln_rate > 0.5 * _NO_LEAK else 0.0 for ln_rate in logarithms)
    return low, middle, high


def with_points(case: Case, points: Sequence[tuple[float, float]]) -> Case:
    """The case under other loads, without bolts.

    Parameters
    ----------
    case : Case
    points : sequence of tuple
        Fluid pressure [Pa] and applied force [N] of each.
    """
    pressures, forces = zip(*points, strict=True)
    entries = {"load.fluid_pressure": list(pressures), "load.applied_force": list(forces)}
    return case.replace({**entries, "bolts": None})


def _alike(case: Case, other: Case) -> bool:
    """Whether fluid and memory are the same."""
    return _fluid(case) == _fluid(other) and case.load.earlier == other.load.earlier


def _by_fluid_and_memory(
    readings: Sequence[MeasuredLeak], without: Sequence[int] = ()
) -> Iterator[tuple[list[int], Case]]:
    """Readings with the same fluid and memory, by their numbers, with a case that has their loads."""
    groups: dict[tuple[str, Any], list[int]] = {}
    for number, reading in enumerate(readings):
        if number not in without:
            groups.setdefault((_fluid(reading.case), reading.case.load.earlier), []).append(number)
    for numbers in groups.values():
        yield (
            numbers,
            with_points(readings[numbers[0]].case, [readings[n].case.load.points[0] for n in numbers]),
        )


def _fluid(case: Case) -> str:
    assert case.fluid is not None  # of all whose leak is asked for
    return case.fluid.name


def _earlier(case: Case) -> float:
    return math.nan if case.load.earlier is None else case.load.earlier[1]


def _settings_for(case: Case, base: Case, settings: Uncertainty | None) -> Uncertainty | None:
    """What is uncertain with another fluid: not the viscosity of the case's own."""
    return settings if _fluid(case) == _fluid(base) else case.sampling


def _drive(readings: Sequence[MeasuredLeak]) -> FloatArray:
    """What drives a flow through an open path, in any unit: p of a liquid, p^2 of a gas, over the viscosity."""
    drives = []
    for reading in readings:
        fluid, p = reading.case.fluid, reading.fluid_pressure
        assert fluid is not None  # of all whose leak is asked for
        outlet = fluid.outlet_pressure or 0.0
        drives.append((p * (p + 2.0 * outlet) if fluid.gas is not None else p) / fluid.viscosity)
    return np.array(drives)


def _resample(weights: FloatArray, count: int, seed: int) -> IntArray:
    """Numbers of draws that stand for the weighted ones, each as often as it weighs."""
    places = (np.arange(count) + np.random.default_rng(seed).random()) / count
    numbers = np.minimum(np.cumsum(weights).searchsorted(places), len(weights) - 1)
    return np.asarray(np.random.default_rng(seed).permutation(numbers))


def _posterior(
    inputs: Sequence[AnyInput],
    uniform: FloatArray,
    joint: _Joint,
    weights: FloatArray,
    loads: Sequence[int],
    seed: int,
) -> Posterior:
    """Draws of the posterior, with the theory's error at the peak pressures of some loads."""
    picks = _resample(weights, _POSTERIOR_DRAWS, seed)
    names = [name for uncertain in inputs for name in columns_of(uncertain.name, uncertain.dimensions)]
    columns = dict(zip(names, uniform[picks % _DRAWS].T, strict=False))
    if not np.ptp(joint.factor) > 0.0:
        return Posterior(columns, error=np.empty((_POSTERIOR_DRAWS, 0)))
    _, different = np.unique(joint.log_peak[loads].round(2), return_index=True)
    places = np.array(loads)[different]
    return Posterior(columns, joint.log_peak[places], joint.error[np.ix_(picks, places)])


# -------------------------------------------------------------------- other theories, histories and tests


def _alternatives(
    case: Case,
    readings: Sequence[MeasuredLeak],
    data: Data,
    y: FloatArray,
    settings: Uncertainty | None,
    values: Mapping[str, FloatArray],
    progress: Progress,
) -> dict[str, float]:
    """Probability of each theory and history that can be compared, all alike before."""
    from scipy.special import logsumexp

    evidence: dict[str, float] = {
        case.leak.theory: float(logsumexp(data.log_likelihood(y))) - math.log(len(y))
    }
    others: list[tuple[str, dict[str, Any]]] = [
        (scenario.name, {"leak.theory": scenario.name})
        for scenario in with_own_contacts(SealProblem.of(with_contact_temperatures(case)))
    ]
    if any(reading.case.load.earlier is not None for reading in readings):
        others.append(
            ("first loading", {"load.largest_earlier_force": None, "load.largest_earlier_pressure": None})
        )
    for name, changes in others:
        with suppress(SealError):
            variants = [replace(reading, case=reading.case.replace(changes)) for reading in readings]
            groups, order = [], []
            for numbers, leak_case in _by_fluid_and_memory(variants):
                progress(f"leak rates of the readings: {name}")
                groups.append(_group(leak_case, _settings_for(leak_case, case, settings), values, progress))
                order += numbers
            joint = _Joint.of(groups, 1)
            likelihoods = Data.of(readings, joint.slack).log_likelihood(joint.y[:, np.argsort(order)])
            evidence[name] = float(logsumexp(likelihoods)) - math.log(len(likelihoods))
    largest = max(evidence.values())
    shares = {name: math.exp(value - largest) for name, value in evidence.items()}
    return {name: share / sum(shares.values()) for name, share in shares.items()}


def _load_tests(case: Case) -> list[tuple[str, tuple[float, float]]]:
    """Loads on the same bodies that a next test could have: half and twice the force, half the pressure."""
    if curves(case):
        return []  # whose loads are a path
    pressure, force = case.load.points[-1]
    points = set(case.load.points)
    tests = [("pressure", (0.5 * pressure, force))]
    if force > 0.0:
        tests += [("force", (pressure, 2.0 * force)), ("force", (pressure, 0.5 * force))]
    return [(name, point) for name, point in tests if point not in points]


def _other_tests(case: Case) -> Iterator[tuple[str, Case]]:
    """Tests with another gas, and after a larger force, at the last load of the case."""
    pressure, force = case.load.points[-1]
    last = with_points(case, [(pressure, force)])
    gas = "helium" if _fluid(case) == "nitrogen" else "nitrogen"
    yield "gas", with_fluid(last, gas)
    if not curves(case) and case.hardness is not None and force > 0.0 and case.load.earlier is None:
        yield "unloading", last.replace({"load.largest_earlier_force": 2.0 * force})


def _next_tests(
    candidates: Sequence[tuple[NextTest, FloatArray]], target: FloatArray, values: Mapping[str, FloatArray]
) -> tuple[NextTest, ...]:
    """Tests in the order of what they are expected to say, from draws of the posterior."""
    log_rate = np.array([[target, *(y for _, y in candidates)]])
    noise = np.random.default_rng(1).standard_normal((measurements.TRUTHS, len(values) + 1))
    draws = measurements.Draws(_SHARES[2] - _SHARES[0], values, log_rate, np.zeros(target.size), noise)
    instruments, rates, alone = measurements.instruments(), draws.log_rate[:, 0], Bounds(1.0, 1.0)
    (accuracy,) = instruments[measurements.LEAK_TEST]["accuracies"].values()
    weighted = [(test, draws.weigh_test(at, accuracy, alone)) for at, (test, _) in enumerate(candidates, 1)]
    if "hardness" in values:
        weighted.append((NextTest("hardness"), draws.weigh(instruments["hardness_test"]["accuracies"])))
    width_now = draws.width(rates, measurements.EVEN_WEIGHTS)
    widths = ((test, draws.width(rates, weights)) for test, weights in weighted)
    tests = [
        replace(test, width=math.exp(min(width_now, 700.0)), expected_width=math.exp(min(width, 700.0)))
        for test, width in widths
        if width_now is not None and width is not None
    ]
    return tuple(sorted(tests, key=lambda test: test.expected_width))
