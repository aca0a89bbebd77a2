"""Interval of the leak rate from uncertain inputs, by quasi-Monte Carlo."""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial, reduce
from itertools import takewhile
from operator import add
from typing import TYPE_CHECKING, Literal

import numpy as np

from fem_seal.answers.answer import Answer
from fem_seal.answers.case_load import CaseLoad, SolvedSeal
from fem_seal.answers.posterior import Posterior, columns_of
from fem_seal.answers.response_surface import Polynomials, ResponseSurface, fit, fit_with_prior, variables
from fem_seal.arrays import FloatArray, IntArray
from fem_seal.case.checks import problems_with_uncertainty
from fem_seal.case.roughness import (
    SHAPE,
    SelfAffine,
    UncertainFinish,
    UncertainHeight,
    scan_spectra,
    self_affine_part,
    uncertain_finishes,
    uncertain_heights,
)
from fem_seal.case.tables import Uncertainty, curves
from fem_seal.contact.laws import HardContact, Law, ScaledLaw
from fem_seal.contact.solution import ContactSettings, ContactSolution
from fem_seal.errors import ConvergenceError, InputError
from fem_seal.processes import fork_map
from fem_seal.sampling import UncertainInput, sobol_points
from fem_seal.seal.bounds import Bounds
from fem_seal.seal.kept import Kept
from fem_seal.seal.leak_model import Conductivity, FlowModel, log_peaks, range_around
from fem_seal.seal.load_result import LoadResult, leak_rates
from fem_seal.seal.load_solver import LoadSolver, linearised_again, path_again, solved_again, solved_with
from fem_seal.seal.problem import SealProblem, condensed, interface_law
from fem_seal.seal.scenarios import TEST_GAS, with_test_gas
from leak import Reading

if TYPE_CHECKING:
    from fem_seal.case.case import Case
    from fem_seal.contact.model import ContactModel
    from fem_seal.materials import Material
    from leak import FlowError, NearbyTables, PowerSpectrum, RoughContact


_FIRST_RUNS = 16
# Left-out runs must be predicted this well: an error that adds 0.05 % to the width of the interval.
_ERROR_OF_STD = 0.03
_SMALLEST_ERROR = 2e-4
# Beside the runs of the polynomial: samples at both ends of the interval, calculated to see how well it does there.
_CHECKS = 4
# Bodies that yield are linearised at the loads of the case, unless these checks, which go through all loads, differ by
# more than the first and by more than this share of the width of ln Q that holds nine tenths of the samples.
_OF_LINEAR = 0.03, 0.06
# So it is with tables from that of the case: one of their own for every sample unless they are as good as this.
_OF_TABLES = 0.01, 0.02

# What is less is no leak: a molecule of a gas in a hundred years [m^3/s], or so much of what the case itself leaks.
# Next to sealing a sample that leaks so little may be off by a factor, and nobody sees it.
_NOTHING, _TRACE = 1e-35, 1e-9
# Share of the sealing pressure that counts for a sealed contact between whose asperities fluid carries.
_NEARLY_SEALED = 0.95


# Surfaces of samples that are kept for the next seal.
_KEPT = 256
# Residual of the contacts of samples, and so the relative error of their pressures.
_OF_SAMPLES = ContactSettings(1e-4, 1e-4)
# The tables of samples are close at halves of the case's highest pressure, down to so many halves above its lowest one,
# as there peaks are, and below this share of the sealing pressure.
_BELOW_PEAKS, _BELOW_SEALING = 19, 0.9
# Factors of the theory's own error for each sample, and the most of both together.
_FACTORS, _MOST_FOUND = 32, 2**18


def _quantile(share: float, rates: FloatArray) -> FloatArray:
    """Of each row."""
    # between a finite and an infinite leak rate there is nothing to interpolate
    method: Literal["linear", "nearest"] = "linear" if np.isfinite(rates).all() else "nearest"
    return np.asarray(np.quantile(rates, share, axis=1, method=method))


@dataclass(frozen=True)
class LeakInterval:
    """Leak rates of all samples at all loads, and what is said about them.

    Parameters
    ----------
    inputs : tuple of str
        Keys of the uncertain inputs.
    confidence : float
        Share of the samples between `low` and `high`.
    seed : int
    runs : int
        Samples whose contact and leak rate were calculated; the others follow from a polynomial through them.
    leak_rate : ndarray, shape (loads, samples)
        [m^3/s], zero where sealed, infinite where the fluid has blown the contact open.
    shares : ndarray, shape (loads, inputs)
        First-order share of each input in the variance of ln Q; their sum falls short of one by what inputs do only
        together. NaN where a sample is sealed or blown open.
    error : float or None
        Largest relative error of samples that were calculated anew beside them, at both ends of the interval, with
        conductivity tables of their own: of the polynomial and of tables from that of the case; a billionth of what the
        case itself leaks counts as nothing. None if every sample was calculated so.
    others : mapping of ndarray, shape (loads, samples)
        The same samples in the other readings of yielding asperities [m^3/s].
    own_error : sequence of FlowError or None
        Of the theory, at each load; it is in both ends of the interval.
    in_test : LeakInterval or None
        The same samples with the gas of the standards' tests; None where the fluid is one, and of a liquid.
    values : mapping of ndarray, shape (samples,)
        Of each input in each sample: its factor, or the value itself of what a finish leaves open; of a spectrum the
        weights of its scans, shape (samples, scans).
    error_scores : ndarray, shape (loads, samples), or None
        The theory's own error in standard deviations, of samples that a leak test has left; None where each sample has
        evenly spread ones.
    rougher : float
        See `LoadResult.rougher`, at the upper end.
    """

    inputs: tuple[str, ...]
    confidence: float
    seed: int
    runs: int
    leak_rate: FloatArray = field(repr=False)
    shares: FloatArray
    error: float | None
    others: Mapping[str, FloatArray] = field(default_factory=dict, repr=False)
    own_error: Sequence[FlowError | None] = field(default=(), repr=False)
    in_test: LeakInterval | None = field(default=None, repr=False)
    values: Mapping[str, FloatArray] = field(default_factory=dict, repr=False)
    error_scores: FloatArray | None = field(default=None, repr=False)
    rougher: float = 1.0

    @property
    def samples(self) -> int:
        """Number of samples."""
        return int(self.leak_rate.shape[1])

    @cached_property
    def low(self) -> FloatArray:
        """Lower end of the interval in the reading that leaks less, at each load, shape (loads,) [m^3/s]."""
        return np.minimum.reduce(list(map(partial(_quantile, 0.5 - 0.5 * self.confidence), self._found)))

    @cached_property
    def median(self) -> FloatArray:
        """Leak rate that half of the samples exceed, with the theory's own error, shape (loads,) [m^3/s]."""
        return _quantile(0.5, self._found[0])

    @cached_property
    def high(self) -> FloatArray:
        """Upper end of the interval in the reading that leaks more, at each load, shape (loads,) [m^3/s]."""
        return np.maximum.reduce(list(map(partial(_quantile, 0.5 + 0.5 * self.confidence), self._found)))

    @cached_property
    def _found(self) -> list[FloatArray]:
        """What direct simulation may find of the samples, in each reading: with evenly spread factors of its error."""
        every = [self.leak_rate, *self.others.values()]
        if not any(self.own_error):
            return every
        if self.error_scores is not None:
            own = zip(self.own_error, self.error_scores, strict=True)
            factor = np.array([np.ones(len(z)) if one is None else one.factor_at(z) for one, z in own])
            return [rates * factor for rates in every]
        count = min(_FACTORS, max(_MOST_FOUND // self.samples, 1))
        even = (np.arange(count) + 0.5) / count
        factors = np.array([np.ones(count) if one is None else one.factor(even) for one in self.own_error])
        return [(rates[:, :, None] * factors[:, None, :]).reshape(len(rates), -1) for rates in every]

    @cached_property
    def sealed(self) -> FloatArray:
        """Share of the samples that do not leak, shape (loads,)."""
        return (self.leak_rate == 0).mean(axis=1)

    def ends(self, number: int) -> Bounds:
        """`low` and `high` of a load [m^3/s]."""
        return Bounds(float(self.low[number]), float(self.high[number]))

    def of_load(self, load: CaseLoad, number: int) -> CaseLoad:
        """The load of this number, which knows the ends of its samples.

        Parameters
        ----------
        load : CaseLoad
        number : int
        """
        if self.in_test is not None and TEST_GAS in load.scenarios:
            ends = self.in_test.ends(number)
            load = load.with_scenarios({TEST_GAS: load.scenarios[TEST_GAS].with_values(sampled=ends)})
        return load.with_values(
            sampled=self.ends(number),
            leak_rate_p50=float(self.median[number]),
            rougher=self.rougher,
            tested=self.error_scores is not None,
        )


def leak_interval(
    result: SolvedSeal, settings: Uncertainty | None = None, progress: Callable[[str], None] | None = None
) -> LeakInterval:
    """Leak rate of a result with an interval from uncertain inputs.

    The samples are a scrambled Sobol sequence. For the first of them the whole chain is calculated: interface law,
    contact on the condensed bodies, flow conductivity, leak rate. If ln Q turns out to be a smooth function of the
    inputs, a polynomial through these runs gives the others; if not (a sample is sealed or blown open), all are
    calculated. A liquid's viscosity needs no runs: Q is inversely proportional to it. Where asperities yield, each run
    gives the leak rate in both readings of the theory, on the same contact.

    Bodies that yield have a path. What touches the surface alone changes the law between them: the bodies are
    linearised at each load of the case, plastic flow of its last load step included, and pressed together anew with the
    law of the sample. The samples at both ends of the interval go through all loads, and if that changes their leak
    rate by more than 3 %, and than 6 % of the width of the interval in ln Q, so do all others, unless some are sealed;
    they do at once if Young's moduli are uncertain.

    Parameters
    ----------
    result : SolvedSeal
        Of a case with roughness and fluid.
    settings : Uncertainty, optional
        Instead of the case's own table [uncertainty].
    progress : callable, optional
        Called with a status message before each step.

    Returns
    -------
    LeakInterval

    Raises
    ------
    InputError
        If the case has no roughness or no fluid, no input is uncertain, or one does not fit the case.
    ConvergenceError
        If the contact of a sample does not converge.

    References
    ----------
    A. B. Owen, SIAM J. Numer. Anal. 34, 1884 (1997): scrambled nets. B. Sudret, Reliab. Eng. Syst. Saf. 93, 964 (2008).

    Examples
    --------
    >>> from fem_seal.case.tables import Spread, Uncertainty
    >>> settings = Uncertainty(samples=1024, hardness=Spread(relative=0.1))
    >>> leak_interval(fem_seal.run(case), settings).high                # doctest: +SKIP
    """
    settings = settings or result.case.sampled
    if settings is None:
        raise InputError.at("uncertainty", "is missing; say which inputs are uncertain")
    wrong = list(problems_with_uncertainty(result.case, settings))
    if wrong:
        raise InputError(*wrong)
    told = progress or (lambda text: None)
    if any(one.case.roughness is not None and one.case.roughness.finishes for one in result.faces):
        return _interval_by_leaking(result, settings, told)
    return _interval(SampledSeal.of(result, settings), settings, told)


# Runs per term of a quadratic polynomial in the inputs of a finish, and the most runs.
_RUNS_PER_TERM, _MOST_RUNS = 1.35, 96
# Error of a left-out run over the scatter, above which the runs are doubled.
_ERROR_OF_WIDE = 0.4
# Error of a left-out run over the scatter, above which ln Q bends towards sealing; ln of how far it is followed.
_ERROR_OF_BENT, _LEAST_LOG = 0.2, 6.0
# Samples of a finish whose usual surface is sealed at a load, all calculated.
_OF_SEALED = 64
# Samples whose heights say how rough the roughest are.
_OF_HEIGHTS = 64
# Share of the runs that must converge.
_FEWEST_KNOWN = 0.7
# Loads that are sampled where there are more.
_LOADS = 5


def _interval_by_leaking(
    result: SolvedSeal, settings: Uncertainty, progress: Callable[[str], None]
) -> LeakInterval:
    """The interval of a finish, of loads that leak and of others each by themselves: none depends on the others."""
    nominal = SampledSeal(result, (), np.empty((1, 0)))
    usual = np.array(nominal.of_case).reshape(nominal.kinds, -1)
    leaks = np.all((usual > 0) & np.isfinite(usual), axis=0)
    leaking, others = (np.flatnonzero(one).tolist() for one in (leaks, ~leaks))
    parts = []
    if leaking:
        part = result.with_loads([result.loads[n] for n in leaking])
        parts.append((leaking, _interval_of_finish(part, settings, progress, leaking)))
    if others:
        # what is sealed has no ratios
        few = settings.model_copy(update={"samples": min(settings.samples, _OF_SEALED)})
        part = result.with_loads([result.loads[n] for n in others])
        study = replace(SampledSeal.of(part, few), numbers=others)
        parts.append((others, _interval(study, few, progress)))
    return parts[0][1] if len(parts) == 1 else _joined(*parts)


def _joined(one: tuple[list[int], LeakInterval], other: tuple[list[int], LeakInterval]) -> LeakInterval:
    """Intervals of the same inputs at some loads and at all others; fewer samples are repeated."""
    (first, own), (second, others) = one, other
    order = np.argsort([*first, *second])

    def rows(some: FloatArray, rest: FloatArray) -> FloatArray:
        repeated = rest[:, np.arange(some.shape[1]) % rest.shape[1]]
        return np.concatenate([some, repeated])[order]

    errors = [found.error for found in (own, others) if found.error is not None]
    errors_of_theory = [*own.own_error, *others.own_error]
    scores = (own.error_scores, others.error_scores)
    return replace(
        own,
        runs=own.runs + others.runs,
        leak_rate=rows(own.leak_rate, others.leak_rate),
        shares=np.concatenate([own.shares, others.shares])[order],
        error=max(errors, default=None),
        others={reading: rows(rates, others.others[reading]) for reading, rates in own.others.items()},
        own_error=[errors_of_theory[n] for n in order],
        in_test=None
        if own.in_test is None or others.in_test is None
        else _joined((first, own.in_test), (second, others.in_test)),
        error_scores=None if scores[0] is None or scores[1] is None else rows(scores[0], scores[1]),
    )


def _interval_of_finish(
    result: SolvedSeal,
    settings: Uncertainty,
    progress: Callable[[str], None],
    numbers: Sequence[int],
    *,
    whole_paths: bool = False,
) -> LeakInterval:
    """The interval of a finish, a factor of ten or more, for the price of few runs.

    Ratios of leak rates to those of the case itself at few loads: a quadratic polynomial of their logarithms gives the
    samples, and the other loads follow over the line load. All loads leak; `numbers` are theirs in the problem.
    """
    chosen = _representative(result.loads)
    part = result.with_loads([result.loads[n] for n in chosen])
    study = SampledSeal.of(part, settings)
    whole_paths = study.whole_paths or whole_paths
    study = replace(study, lenient=True, whole_paths=whole_paths, numbers=[numbers[n] for n in chosen])
    usual, viscosity = np.array(study.of_case), study.viscosity[:, None]
    terms = (study.scores.shape[1] + 1) * (study.scores.shape[1] + 2) // 2
    goal = min(math.ceil(_RUNS_PER_TERM * terms) + 1, len(study.uniform), _MOST_RUNS)
    runs, rates, surface, error = 0, np.empty((0, usual.size)), None, None
    while runs < goal:
        progress(f"uncertainty of the finish: samples {runs + 1} to {goal}")
        rates = np.concatenate([rates, study.leak_rates(range(runs, goal)) / usual])
        runs = goal
        # a contact that did not converge says nothing; the polynomial goes through the others
        known = np.flatnonzero(~np.isnan(rates).any(axis=1))
        if len(known) < _FEWEST_KNOWN * runs:
            raise ConvergenceError(f"uncertainty: {runs - len(known)} of {runs} samples did not converge")
        smooth = bool(np.all((rates[known] > 0) & np.isfinite(rates[known])))
        scores = study.scores[known]
        surface = fit(scores, np.log(rates[known]), study.scores, _RUNS_PER_TERM) if smooth else None
        if surface is None or np.any(surface.error > _ERROR_OF_WIDE * np.sqrt(surface.variance)):
            goal = min(2 * runs, len(study.uniform), _MOST_RUNS)
    chosen_samples: slice | IntArray = slice(None)
    if surface is None:
        ratios, viscosity, chosen_samples = rates[known], viscosity[known], known
    else:
        ratios = np.exp(_bent(surface, scores, np.log(rates[known]), study.scores))
        checked = np.array(_ends((ratios * usual / viscosity)[:, study.last_load], settings.confidence))
        truth = replace(study, whole_paths=True).leak_rates(checked.tolist()) / usual
        checked, truth = (one[~np.isnan(truth).any(axis=1)] for one in (checked, truth))
        error = float(np.abs(ratios[checked] / truth - 1).max(initial=0.0))
        if _linear_fails(study, checked, truth * usual, error, _allowed(ratios, *_OF_LINEAR)):
            return _interval_of_finish(result, settings, progress, numbers, whole_paths=True)
        ratios[checked], ratios[known] = truth, rates[known]
        runs += _CHECKS
    ratios = ratios / viscosity
    nominal = np.array(SampledSeal(result, (), study.uniform).of_case).reshape(study.kinds, 1, -1)
    by_kind = ratios.reshape(len(ratios), study.kinds, len(chosen)).swapaxes(0, 1)
    rates = _at_all_loads(np.log(_line_loads(result.loads)), chosen, by_kind) * nominal
    shares = _shares(study, ratios * usual, surface)
    near = np.argmin(np.abs(np.arange(len(result.loads))[:, None] - chosen), axis=1)
    kinds = [one.T for one in rates]
    return _interval_of_samples(
        study,
        settings,
        result.loads,
        kinds,
        runs=runs,
        shares=shares[near],
        error=error,
        chosen=chosen_samples,
    )


def _bent(surface: ResponseSurface, runs: FloatArray, logs: FloatArray, population: FloatArray) -> FloatArray:
    """ln of the ratios of a population, also where they fall the faster the nearer a sample is to sealing.

    A quadratic polynomial does not follow that: at the upper end of its samples too much leaks, in the median too
    little. Where it leaves much, the likeliest cubic one of -ln(bound - ln Q) takes its place.
    """
    found = surface(population)
    poor = surface.error > _ERROR_OF_BENT * np.sqrt(surface.variance)
    if not np.any(poor):
        return found
    # not by the standard deviation, most of which may be that of one sample next to sealing
    bound = logs.max(axis=0) + 0.5 * np.subtract(*np.quantile(logs, (0.84, 0.16), axis=0))
    bent = fit_with_prior(Polynomials.of(population, 3), runs, -np.log(bound - logs))
    return np.where(poor, bound - np.exp(np.minimum(-bent(population), _LEAST_LOG)), found)


def _interval_of_samples(
    study: SampledSeal,
    settings: Uncertainty,
    loads: Sequence[CaseLoad],
    rates: Sequence[FloatArray],
    *,
    runs: int,
    shares: FloatArray,
    error: float | None,
    chosen: slice | IntArray = slice(None),
) -> LeakInterval:
    """The interval of samples, shape (loads, samples) in each reading of the case's fluid, then of the tests' gas.

    `chosen` are the samples whose rates these are.
    """
    names = tuple(one.name for one in study.inputs)
    errors = [load.flow_error for load in loads]
    values = {one.name: one.shown(study.values[one.name])[chosen] for one in study.inputs}
    rougher, scores = study.rougher(0.5 + 0.5 * settings.confidence), None

    if settings.posterior is not None:
        # first-order shares are those of independent inputs
        shares = np.full(shares.shape, np.nan)
        peaks = np.log10([load.peak_pressure for load in loads])
        scores = Posterior.read(settings.posterior).error_at(peaks, settings.seed)[:, chosen]

    def interval(own: FloatArray, *others: FloatArray) -> LeakInterval:
        read: dict[str, FloatArray] = dict(zip(study.others, others, strict=True))
        about = names, settings.confidence, settings.seed, runs, own, shares, error, read, errors
        return LeakInterval(*about, values=values, error_scores=scores, rougher=rougher)

    own, *tested = (
        interval(*rates[first : first + study.readings]) for first in range(0, study.kinds, study.readings)
    )
    return replace(own, in_test=tested[0]) if tested else own


def _line_loads(loads: Sequence[CaseLoad]) -> FloatArray:
    return np.array([load.line_load for load in loads])


def _representative(loads: Sequence[CaseLoad]) -> list[int]:
    """Numbers of few loads with line loads over the whole range, the last one among them; of all if they are few."""
    if len(loads) <= _LOADS:
        return list(range(len(loads)))
    order = np.argsort(np.log(_line_loads(loads)), kind="stable")
    even = np.linspace(0, len(loads) - 1, _LOADS).round().astype(int)
    return sorted({*order[even].tolist(), len(loads) - 1})


def _at_all_loads(log_load: FloatArray, chosen: Sequence[int], ratios: FloatArray) -> FloatArray:
    """Ratios of leak rates at all loads from those at few, shape (readings, samples, chosen) to (.., .., loads)."""
    if len(chosen) == len(log_load):
        return ratios
    from scipy.interpolate import PchipInterpolator

    nodes = log_load[list(chosen)]
    _, first = np.unique(nodes, return_index=True)
    nearest = np.argmin(np.abs(log_load[:, None] - nodes), axis=1)
    found = ratios[..., nearest]
    smooth = np.all((ratios > 0) & np.isfinite(ratios), axis=-1)
    if len(first) > 1 and smooth.any():
        between = PchipInterpolator(nodes[first], np.log(ratios[smooth][:, first]), axis=-1)
        found[smooth] = np.exp(between(log_load))
    return found


def _interval(study: SampledSeal, settings: Uncertainty, progress: Callable[[str], None]) -> LeakInterval:
    viscosity = study.viscosity
    runs, rates, surface = _runs(study, progress)
    error = None
    nominal = rates * viscosity[:, None] if surface is None else np.exp(surface(study.scores))
    if study.calculated and (surface is not None or study.linearised or not study.exact):
        checked = _ends((nominal / viscosity[:, None])[:, study.last_load], settings.confidence)
        truth = replace(study, whole_paths=True, exact=True).leak_rates(checked)
        error = _largest_difference(nominal[checked], truth, study.of_case)
        allowed = _allowed(nominal, *_OF_LINEAR)
        if surface is not None and _linear_fails(study, checked, truth, error, allowed):
            return _interval(replace(study, whole_paths=True), settings, progress)
        if not study.exact and error > _allowed(nominal, *_OF_TABLES):
            return _interval(replace(study, exact=True), settings, progress)
        if surface is not None:
            nominal[: len(rates)] = rates
            runs += len(checked)
        nominal[checked] = np.where(np.isnan(truth), nominal[checked], truth)
    by_kind = np.split((nominal / viscosity[:, None]).T, study.kinds)
    shares = _shares(study, nominal, surface)
    return _interval_of_samples(
        study, settings, study.result.loads, by_kind, runs=runs, shares=shares, error=error
    )


def _linear_fails(
    study: SampledSeal, samples: Sequence[int] | IntArray, truth: FloatArray, error: float, allowed: float
) -> bool:
    """Whether the linearised bodies, and not the polynomial through their runs, miss samples by so much."""
    if not study.linearised or error <= allowed:
        return False
    found = study.leak_rates(list(samples))
    return _largest_difference(found, truth, study.of_case) > allowed


def _largest_difference(found: FloatArray, truth: FloatArray, of_case: Sequence[float]) -> float:
    """Relative difference of samples, shape (samples, columns), whose case leaks so much in each column."""
    own = np.array(of_case)
    least = np.maximum(_NOTHING, _TRACE * np.where(np.isfinite(own), own, 0.0))
    with np.errstate(invalid="ignore"):
        differ = np.abs((found + least) / (truth + least) - 1)
    # both blown open is no difference; a path that did not converge says nothing
    return float(np.nan_to_num(differ, nan=0.0).max())


def _allowed(leak_rate: FloatArray, least: float, share: float) -> float:
    """How far samples that scatter like these may be off, from shares of one and of their scatter in ln Q.

    At each load the samples that leak count, also where it seals or opens others, or all at another load.
    """
    leaking = [one[(one > 0) & np.isfinite(one)] for one in leak_rate.T]
    widths = [np.diff(np.quantile(np.log(one), (0.05, 0.95))) for one in leaking if one.size]
    return max(least, share * float(np.max(widths, initial=0.0)))


def _runs(
    study: SampledSeal, progress: Callable[[str], None]
) -> tuple[int, FloatArray, ResponseSurface | None]:
    """Calculate samples until a polynomial through them is good enough; None instead of it if all are calculated."""
    total = len(study.uniform)
    if not study.calculated:
        return 0, np.array([study.of_case]) / study.viscosity[:, None], None
    count, rates = 0, np.empty((0, study.kinds * len(study.result.loads)))
    goal = min(total, _FIRST_RUNS * 2 ** min(study.scores.shape[1] - 1, 3))
    while count < total:
        progress(f"uncertainty: samples {count + 1} to {goal} of {total}")
        rates = np.concatenate([rates, study.leak_rates(range(count, goal))])
        count = goal
        if np.all((rates > 0) & np.isfinite(rates)) and count < total:
            surface = fit(study.scores[:count], np.log(rates), study.scores)
            allowed = np.maximum(_ERROR_OF_STD * np.sqrt(surface.variance), _SMALLEST_ERROR)
            if np.all(surface.error <= allowed):
                return count, rates, surface
            goal = min(total, 2 * count)
        else:
            goal = total
    return count, rates / study.viscosity[:, None], None


def _ends(leak_rate: FloatArray, confidence: float) -> list[int]:
    """Samples at the ends of an interval: the lower one of the smaller reading, the upper one of the larger.

    Parameters
    ----------
    leak_rate : ndarray, shape (samples, readings)
    confidence : float
    """
    last = len(leak_rate) - 1
    near = []
    for share, outer in ((0.5 - 0.5 * confidence, np.argmin), (0.5 + 0.5 * confidence, np.argmax)):
        order = np.argsort(leak_rate[:, outer(np.quantile(leak_rate, share, axis=0, method="lower"))])
        near += [int(order[min(last, int(share * last) + n)]) for n in range(_CHECKS // 2)]
    return sorted(set(near))


def _shares(study: SampledSeal, nominal: FloatArray, surface: ResponseSurface | None) -> FloatArray:
    """First-order shares in the variance of ln Q of the case's own reading, shape (loads, inputs)."""
    loads, inputs = len(study.result.loads), study.inputs
    nominal = nominal[:, :loads]
    if not np.all((nominal > 0) & np.isfinite(nominal)):
        return np.full((loads, len(inputs)), np.nan)
    own = float(np.log(study.viscosity).var())
    if surface is None and study.calculated:
        surface = fit(study.scores, np.log(nominal), study.scores)
    variances = np.zeros((loads, len(inputs)))
    total = np.full(loads, own)
    if surface is not None:
        total += surface.variance[:loads]
    for n, one in enumerate(inputs):
        if one in study.calculated and surface is not None:
            variances[:, n] = surface.variance_of(study.columns(one))[:loads]
        elif one not in study.calculated:
            variances[:, n] = own
    return variances / total[:, None]


@dataclass(frozen=True)
class SampledSeal:
    """All samples of the inputs of one result.

    Parameters
    ----------
    uniform : ndarray, shape (samples, dimensions)
        Numbers between 0 and 1.
    lenient : bool
        Whether samples whose contact does not converge are NaN, instead of an error.
    exact : bool
        Whether each sample has a conductivity table of its own, instead of one from that of the case.
    whole_paths : bool
        Whether bodies that yield go through all their loads in every sample, instead of being linearised at each load
        of the case.
    numbers : sequence of int, optional
        Which of the loads of the problem are sampled; all unless given.
    of_faces : tuple of tuple
        Inputs of each of two different flange faces, with the same value where they have the same name.
    """

    result: SolvedSeal
    inputs: tuple[AnyInput, ...]
    uniform: FloatArray
    lenient: bool = False
    exact: bool = False
    whole_paths: bool = False
    numbers: Sequence[int] | None = None
    of_faces: tuple[tuple[AnyInput, ...], ...] = ()

    @classmethod
    def of(cls, result: SolvedSeal, settings: Uncertainty) -> SampledSeal:
        """The samples of a result.

        Parameters
        ----------
        result : SolvedSeal
        settings : Uncertainty
            The table [uncertainty].
        """
        inputs = uncertain_inputs(result.case, settings)
        faces = tuple(_inputs_of_face(one.case, settings) for one in result.faces)
        if settings.posterior is None:
            dimensions = sum(one.dimensions for one in inputs)
            uniform = sobol_points(settings.samples, dimensions, settings.seed)
        else:
            columns = [name for one in inputs for name in columns_of(one.name, one.dimensions)]
            uniform = Posterior.read(settings.posterior).of_inputs(columns)
        study = cls(result, inputs, uniform, of_faces=faces)
        return replace(study, whole_paths=study._bulk)

    @property
    def _bulk(self) -> bool:
        """Whether bodies yield elsewhere in a sample, because their modulus is another one."""
        return self.result.problem.follows_path and any(one.name == "youngs_modulus" for one in self.inputs)

    @property
    def linearised(self) -> bool:
        """Whether bodies that yield are linearised at the loads of the case."""
        return self.result.problem.follows_path and not self.whole_paths

    @property
    def others(self) -> tuple[Reading, ...]:
        """Readings of yielding asperities beside that of the case itself."""
        return tuple(map(Reading, self.result.loads[0].others))

    @property
    def readings(self) -> int:
        """Leak rates of each sample and load: that of the case's own reading first, then the others."""
        return 1 + len(self.others)

    @property
    def flows(self) -> tuple[FlowModel, ...]:
        """That of the case and, where it is another one, that of the gas that the standards test with."""
        own = self.result.problem.flow
        assert own is not None  # of the checks
        tested = with_test_gas(own)
        return (own,) if tested is own else (own, tested)

    @property
    def kinds(self) -> int:
        """Leak rates of each sample and load: the readings of each fluid."""
        return len(self.flows) * self.readings

    @property
    def last_load(self) -> slice:
        """Where the readings of its own fluid stand among the leak rates of a sample."""
        loads = len(self.result.loads)
        return slice(loads - 1, self.readings * loads, loads)

    @property
    def of_case(self) -> list[float]:
        """Leak rates of the case itself, as those of a sample."""
        own = self.result.loads
        fluids = [own, *([load.scenarios[TEST_GAS] for load in own] for _ in self.flows[1:])]
        read = [[one, *([load.scenarios[other] for load in one] for other in self.others)] for one in fluids]
        found = [load.leak for readings in read for loads in readings for load in loads]
        return [math.nan if leak is None else leak.leak_rate for leak in found]

    @cached_property
    def calculated(self) -> tuple[AnyInput, ...]:
        """Inputs whose effect is not known beforehand: all but a liquid's viscosity."""
        return tuple(one for one in self.inputs if one.name != "viscosity")

    @cached_property
    def values(self) -> dict[str, FloatArray]:
        """Factors (samples, 1) or weights (samples, scans) of each input."""
        return drawn_values(self.inputs, self.uniform)

    @cached_property
    def viscosity(self) -> FloatArray:
        """Factor of the viscosity of each sample, shape (samples,)."""
        return self.values.get("viscosity", np.ones((len(self.uniform), 1)))[:, 0]

    @cached_property
    def scores(self) -> FloatArray:
        """Variables of the polynomial, shape (samples, dimensions of `calculated`)."""
        parts = variables({one.name: one.shown(self.values[one.name]) for one in self.calculated})
        return np.concatenate(parts, axis=1) if parts else np.empty((len(self.uniform), 0))

    def columns(self, wanted: AnyInput) -> list[int]:
        """Columns of `scores` that belong to an input."""
        first = sum(one.dimensions for one in takewhile(lambda one: one is not wanted, self.calculated))
        return list(range(first, first + wanted.dimensions))

    def leak_rates(self, samples: Sequence[int]) -> FloatArray:
        """Leak rates at the case's own viscosity, calculated, shape (samples, readings times loads) [m^3/s]."""
        result = self.result
        if result.lower_half is not None:
            return np.asarray(np.mean([one.leak_rates(samples) for one in self.faces], axis=0))
        if self.exact or result.problem.follows_path or result.problem.form is not None:
            # the first makes the tables that all share, if they do not have their own
            shared = 0 if self.exact else 1
            first = [self._leak_rates(number) for number in samples[:shared]]
            return np.array(first + fork_map(self._leak_rates, samples[shared:]))
        found = self._all_known(samples)
        moved = [n for n, one in enumerate(found) if self._moves(one)]
        others = [(stiffer(result.model, found[n].stiffness), found[n].law) for n in moved]
        contacts = dict(
            zip(moved, solved_with(result.contact, others, result.earlier, _OF_SAMPLES), strict=True)
        )
        return np.array([self._rates_at(one, contacts.get(n)) for n, one in enumerate(found)])

    @property
    def faces(self) -> list[SampledSeal]:
        """The samples of each of two different faces."""
        ends = np.cumsum([one.dimensions for one in self.inputs], dtype=int)
        columns = {
            one.name: self.uniform[:, end - one.dimensions : end]
            for one, end in zip(self.inputs, ends, strict=True)
        }
        found = []
        for seal, inputs in zip(self.result.faces, self.of_faces, strict=True):
            if any(columns[one.name].shape[1] != one.dimensions for one in inputs):
                raise ConvergenceError("the scans of both flange faces must be as many")
            uniform = np.concatenate([self.uniform[:, :0], *(columns[one.name] for one in inputs)], axis=1)
            found.append(replace(self, result=seal, inputs=inputs, uniform=uniform))
        return found

    def _leak_rates(self, sample: int) -> list[float]:
        return self._rates_at(self._sample(sample))

    def _rates_at(
        self, sample: _Sample, contacts: Sequence[ContactSolution] | ConvergenceError | None = None
    ) -> list[float]:
        """Leak rates of a sample, on its contacts if they are known."""
        try:
            return self._rates(sample, self._loads(sample, contacts))
        except ConvergenceError:
            if self.lenient or (self.whole_paths and not self._bulk):
                return [math.nan] * (self.kinds * len(self.result.loads))
            raise

    def _all_known(self, samples: Sequence[int]) -> list[_Sample]:
        """Samples with their laws and tables, those that no seal has had yet made side by side."""
        new = [number for number in samples if _kept.known(self._name(number)) is None]
        if new:
            # the first makes the tables that all share
            made = [self._with_tables(new[0]), *fork_map(self._with_tables, new[1:])]
            for number, one in zip(new, made, strict=True):
                _kept.put(self._name(number), one)
        return list(map(self._sample, samples))

    def _with_tables(self, number: int) -> _Known:
        known = self._sample(number).known
        for one in (known.surface, *map(known.surface.reading, self.others)):
            self._table(known, self.flows[0], one, [-math.inf])
        return known

    def _sample(self, number: int) -> _Sample:
        factors = self._values_of(UncertainInput, number)
        known = _kept.get(self._name(number), lambda: self._made(number, factors))
        return _Sample(factors, known, known.law or self._law(known.surface))

    def _name(self, number: int) -> Hashable:
        """Of what a sample has in common with that of another seal."""
        result, flow = self.result, self.flows[0]
        assert result.case.roughness is not None  # of the checks
        values = tuple((one.name, *self.values[one.name][number].tolist()) for one in self.calculated)
        roughness = result.surface, result.case.roughness.model_dump_json(), result.problem.interface
        return *roughness, flow.gas is not None, self._within, values

    def _values_of(self, kind: type[UncertainInput | UncertainFinish], sample: int) -> dict[str, float]:
        """Values of the inputs of one kind."""
        inputs = [one for one in self.calculated if isinstance(one, kind)]
        return {one.name: float(self.values[one.name][sample, 0]) for one in inputs}

    def _rates(self, sample: _Sample, loads: Sequence[LoadResult]) -> list[float]:
        """Leak rates in each reading at each load."""
        surface, (flow, *_) = sample.known.surface, self.flows
        by_reading = (
            # with the range of the case itself, as long as it will do, the table's own error is that of all samples
            leak_rates(one, self.flows, loads, alike=self.result.loads)
            if self.exact or flow.simulated is not None
            else leak_rates(one, self.flows, loads, table=partial(self._table, sample.known))
            for one in (surface, *map(surface.reading, self.others))
        )
        return [rate for of_fluid in zip(*by_reading, strict=True) for rates in of_fluid for rate in rates]

    def _table(
        self, known: _Known, flow: FlowModel, surface: RoughContact, log_peaks: Sequence[float]
    ) -> Conductivity:
        """Conductivity from the table of the case; up to some levels it is that of the sample in all seals."""
        highest, sealing = 10.0 ** np.array(log_peaks), surface.sealing_pressure
        if flow.fluid_in_gap == "local":  # which opens what would be sealed without it
            highest = np.minimum(highest, _NEARLY_SEALED * sealing)
        low, high = self._within
        levels = high * 0.5 ** np.arange(math.log2(high / low) - _BELOW_PEAKS)
        levels = levels[levels < _BELOW_SEALING * sealing]
        nearby = self._nearby[surface.yielding]
        if highest.max() > levels.max(initial=0.0):
            return nearby.table(surface, highest)
        if surface.yielding not in known.tables:
            known.tables[surface.yielding] = nearby.table(surface, levels)
        return known.tables[surface.yielding]

    @cached_property
    def _within(self) -> tuple[float, float]:
        """Range of pressures over which the case has its tables [Pa]."""
        return range_around(log_peaks([one for load in self.result.loads for one in load.contacts]))

    @cached_property
    def _nearby(self) -> dict[str, NearbyTables]:
        """Tables of surfaces close to that of the case, by its reading of yielding."""
        from leak import NearbyTables

        surface, flow = self.result.surface, self.result.problem.flow
        assert surface is not None and flow is not None  # of the checks
        # the case has its tables already
        of_gas, within = flow.gas is not None, self._within

        def made(one: RoughContact) -> NearbyTables:
            return _kept.get((one, of_gas, within), lambda: NearbyTables(one, of_gas, within=within))

        return {one.yielding: made(one) for one in (surface, *map(surface.reading, self.others))}

    def _made(self, sample: int, factors: dict[str, float]) -> _Known:
        surface = self._surface(sample, factors)
        law = self._law(surface)
        own = law is not self.result.problem.law and not isinstance(law, ScaledLaw)
        return _Known(surface, law if own else None)

    def rougher(self, share: float) -> float:
        """Quantile of what the gaps of samples let through over those of the case, by h^3/eta [-].

        Parameters
        ----------
        share : float
            Of the samples that let less through.
        """
        if self.result.lower_half is not None:
            return max(one.rougher(share) for one in self.faces)
        assert self.result.surface is not None
        few, usual = range(min(len(self.uniform), _OF_HEIGHTS)), self.result.surface.spectrum.rms_height
        heights = np.array(
            [self._surface(n, self._values_of(UncertainInput, n)).spectrum.rms_height for n in few]
        )
        return float(np.quantile((heights / usual) ** 3 / self.viscosity[: len(few)], share))

    def _surface(self, sample: int, factors: dict[str, float]) -> RoughContact:
        assert self.result.surface is not None
        means = {
            one.name: one.spectrum(self.values[one.name][sample])
            for one in self.calculated
            if isinstance(one, UncertainScans)
        }
        for one in self.calculated:
            if isinstance(one, UncertainHeight):
                roughness = self.result.case.roughness
                assert roughness is not None
                mean = means[one.key] if one.key in means else roughness.parts[one.key].build()
                means[one.key] = one.spectrum(mean, float(self.values[one.name][sample, 0]))
        shares = self._values_of(UncertainFinish, sample)
        return changed_surface(self.result.case, self.result.surface, factors, means, shares)

    def _moves(self, sample: _Sample) -> bool:
        """Whether the law of a sample or its bodies are not those of the case; a given contact stays what it is."""
        changed = sample.stiffness != 1 or sample.law is not self.result.problem.law
        return changed and not self.result.of_profile

    def _loads(
        self, sample: _Sample, contacts: Sequence[ContactSolution] | ConvergenceError | None
    ) -> Sequence[LoadResult]:
        """Every load; those of the case itself where its law and its bodies have not changed."""
        result, law, factors = self.result, sample.law, sample.factors
        problem = result.problem
        if problem.form is not None and "form" in factors:
            problem = replace(problem, form=problem.form.scaled(factors["form"]))
        if not self._moves(sample):
            if problem.form is result.problem.form:
                return result.loads
            return [
                replace(load, circumference=problem.circumference(load.contact, near=load.circumference))
                for load in result.loads
            ]
        try:
            if contacts is None:
                contacts = self._contacts(problem, sample.known.surface, law, sample.stiffness)
            if isinstance(contacts, ConvergenceError):
                raise contacts
            return [
                LoadResult(
                    *load.point,
                    contact,
                    circumference=problem.circumference(contact, law, load.circumference),
                )
                for load, contact in zip(result.loads, contacts, strict=True)
            ]
        except ConvergenceError as error:
            changes = ", ".join(f"{name} times {factor:.4g}" for name, factor in factors.items())
            raise ConvergenceError(f"uncertainty, sample with {changes}: {error}") from error

    def _law(self, surface: RoughContact) -> Law:
        """The law of a sample; where the elastic p(u) keeps its shape that of the case in other units."""
        from leak.flow.nearby import height_ratio

        known, problem = self.result.surface, self.result.problem
        assert known is not None  # of the checks
        if self.result.of_profile:
            return problem.law
        if problem.interface.law != "spectrum" or problem.interface.plastic:
            return interface_law(problem.interface, surface)
        height = height_ratio(surface.elastic, known.elastic)
        if height is None:
            return interface_law(problem.interface, surface)
        pressure = height * surface.effective_modulus / known.effective_modulus
        if height == 1.0 and pressure == 1.0:
            return problem.law
        assert not isinstance(problem.law, HardContact)  # of law persson
        return ScaledLaw(problem.law, height, math.log(pressure))

    def _contacts(
        self, problem: SealProblem, surface: RoughContact, law: Law, stiffness: float
    ) -> Sequence[ContactSolution]:
        result = self.result
        if self.linearised:
            return linearised_again(result.contact, law)
        if not problem.follows_path:
            return solved_again(result.contact, stiffer(result.model, stiffness), law, result.earlier)
        changed = replace(problem, surface=surface, materials=stiffer_bodies(problem.materials, stiffness))
        model = result.model if stiffness == 1 else condensed(changed, result.seal_mesh)
        contacts = path_again(LoadSolver(changed, model))
        return contacts if self.numbers is None else [contacts[number] for number in self.numbers]


@dataclass(frozen=True)
class _Known:
    """What a sample has in common with the same one of another seal: whatever follows from its surface alone.

    Parameters
    ----------
    surface : RoughContact
    law : Law or None
        None where it is that of the case, or one of that shape.
    tables : dict
        Conductivity in each reading that was asked for.
    """

    surface: RoughContact
    law: Law | None
    tables: dict[str, Conductivity] = field(default_factory=dict)


@dataclass(frozen=True)
class _Sample:
    """A sample of a seal."""

    factors: dict[str, float]
    known: _Known
    law: Law

    @property
    def stiffness(self) -> float:
        """Factor of both Young's moduli."""
        return self.factors.get("youngs_modulus", 1.0)


# of all seals of this process
_kept = Kept(_KEPT)


def stiffer_bodies(materials: Mapping[str, Material], factor: float) -> dict[str, Material]:
    """Materials with both Young's moduli times a factor."""
    return {name: replace(one, youngs_modulus=one.youngs_modulus * factor) for name, one in materials.items()}


# Loads of a body that prescribe how far it moves, whatever its stiffness.
_IMPOSED = ("wall", "expansion", "heat")


def stiffer(model: ContactModel, factor: float) -> ContactModel:
    """Model of the same bodies with both Young's moduli times a factor, as far as a contact needs it."""
    if factor == 1:
        return model

    def body(one):  # type: ignore[no-untyped-def]
        material = replace(one.material, youngs_modulus=one.material.youngs_modulus * factor)
        # The wall of a pressed-in housing and heat move a body as far as before; pressures move a stiffer one less.
        loads = {
            name: load if name in _IMPOSED else replace(load, opening=load.opening / factor)
            for name, load in one.loads.items()
        }
        return replace(one.with_loads(loads), held=replace(one.held, material=material))

    return replace(
        model,
        closure=body(model.closure),
        seat=body(model.seat),
        compliance=model.compliance / factor,
        harmonics=(model.harmonics[0].stiffer(factor), model.harmonics[1].stiffer(factor)),
    )


@dataclass(frozen=True)
class UncertainScans:
    """The spectrum, from the differences between n scans: their mean with random weights.

    The weights are uniform over all sets of n positive numbers with sum one (Bayesian bootstrap): what else the mean
    of n scans could have been.

    Parameters
    ----------
    name : {"spectrum", "seat", "closure"}
        Which spectrum of the case it is.
    scans : tuple of PowerSpectrum
        One of each scan; two or more.

    References
    ----------
    D. B. Rubin, Ann. Stat. 9, 130 (1981).
    """

    name: str
    scans: tuple[PowerSpectrum, ...]

    @property
    def dimensions(self) -> int:
        """Number of random numbers that it takes."""
        return len(self.scans) - 1

    def values(self, uniform: FloatArray) -> FloatArray:
        """Weights from numbers between 0 and 1, by breaking a stick; shape (n, scans - 1) to (n, scans)."""
        left = len(self.scans) - 1 - np.arange(self.dimensions)
        rest = (1.0 - uniform) ** (1.0 / left)
        before = np.cumprod(np.column_stack([np.ones(len(uniform)), rest]), axis=1)
        return np.asarray(before * np.column_stack([1.0 - rest, np.ones(len(uniform))]), dtype=float)

    def shown(self, values: FloatArray) -> FloatArray:
        """The weights, shape (n, scans)."""
        return values

    def spectrum(self, weights: FloatArray) -> PowerSpectrum:
        """Mean spectrum with weights, shape (scans,); those of 1e-6 or less are left out."""
        known = [(scan, weight) for scan, weight in zip(self.scans, weights, strict=True) if weight > 1e-6]
        return reduce(add, (scaled(scan, float(np.sqrt(weight))) for scan, weight in known))


def scaled(spectrum: PowerSpectrum, factor: float) -> PowerSpectrum:
    """Spectrum of a surface with all heights times a factor."""
    from leak import PowerSpectrum

    return spectrum if factor == 1 else PowerSpectrum(spectrum.wavenumber, spectrum.density * factor**2)


AnyInput = UncertainInput | UncertainScans | UncertainHeight | UncertainFinish


def uncertain_inputs(case: Case, settings: Uncertainty) -> tuple[AnyInput, ...]:
    """The uncertain inputs of a case, in the order of the table, then what a finish and too short scans leave open.

    Of a lower flange of its own those follow that the upper one has not.

    Parameters
    ----------
    case : Case
    settings : Uncertainty
        Its table [uncertainty], or another one.
    """
    own = _inputs_of_face(case, settings)
    names = {one.name for one in own}
    others = (one for half in case.halves[1:] for one in _inputs_of_face(half, settings))
    return (*own, *(one for one in others if one.name not in names))


def _inputs_of_face(case: Case, settings: Uncertainty) -> tuple[AnyInput, ...]:
    inputs: list[AnyInput] = [
        UncertainInput(name, spread.distribution, spread.relative)
        for name, spread in settings.spreads.items()
    ]
    if settings.spectrum is not None:
        inputs += [UncertainScans(key, scans) for key, scans in scan_spectra(case.roughness).items()]
    finishes = uncertain_finishes(case.roughness, known=settings.spreads)
    heights = uncertain_heights(case.roughness, between_scans=settings.spectrum is not None)
    return (*inputs, *finishes, *heights)


def drawn_values(inputs: Sequence[AnyInput], uniform: FloatArray) -> dict[str, FloatArray]:
    """Values of each input from numbers between 0 and 1, see the inputs.

    Parameters
    ----------
    inputs : sequence
    uniform : ndarray, shape (n, dimensions of all)
    """
    ends = np.cumsum([one.dimensions for one in inputs], dtype=int)
    return {
        one.name: one.values(uniform[:, end - one.dimensions : end])
        for one, end in zip(inputs, ends, strict=True)
    }


def changed_surface(
    case: Case,
    surface: RoughContact,
    factors: Mapping[str, float],
    means: Mapping[str, PowerSpectrum] | None = None,
    shares: Mapping[str, float] | None = None,
) -> RoughContact:
    """The rough contact with some of its inputs changed.

    Parameters
    ----------
    case : Case
    surface : RoughContact
        The case's own.
    factors : mapping
        Factor of each uncertain input by its key.
    means : mapping, optional
        Spectra that stand instead of the case's own, by their key in [roughness].
    shares : mapping, optional
        Places in the ranges of what its finishes leave open.
    """
    means, shape = dict(means or {}), {key: factors[key] for key in SHAPE if key in factors}
    key = self_affine_part(case.roughness)
    if shape and key is not None:
        means[key] = _reshaped(case, key, factors)
    spectrum, peklenik = surface.spectrum, surface.peklenik
    if means or shares or shape:
        assert case.roughness is not None
        spectrum, peklenik = case.roughness.combined(means, shares, shape)
    hardness = surface.hardness
    return replace(
        surface,
        spectrum=scaled(spectrum, factors.get("rms_height", 1.0)),
        effective_modulus=surface.effective_modulus * factors.get("youngs_modulus", 1.0),
        hardness=None if hardness is None else hardness * factors.get("hardness", 1.0),
        peklenik=peklenik,
    )


def _reshaped(case: Case, key: str, factors: Mapping[str, float]) -> PowerSpectrum:
    """Self-affine spectrum with other exponent or ends and the same rms height."""
    from leak import PowerSpectrum

    assert case.roughness is not None
    given = case.roughness.parts[key]
    assert isinstance(given, SelfAffine)
    q_high = given.q_high * factors.get("q_high", 1.0)
    q_high = max(q_high, given.q_rolloff, 1.001 * given.q_low)
    return PowerSpectrum.self_affine(
        rms_height=given.rms_height,
        hurst=min(max(given.hurst * factors.get("hurst", 1.0), 0.01), 1.0),
        q_low=given.q_low,
        q_rolloff=min(max(given.q_rolloff * factors.get("q_rolloff", 1.0), given.q_low), q_high),
        q_high=q_high,
    )


UNCERTAINTY = Answer[LeakInterval | None](
    "uncertainty",
    "interval of the leak rates",
    lambda seal, request: leak_interval(seal, progress=request.clock.progress),
    None,
    # each sample repeats a path of loads: minutes for an interval of which nothing would be claimed
    lambda seal, request: not (curves(seal.case) and all(load.validity.outside for load in seal.loads)),
    lambda load, number, found: load if found is None else found.of_load(load, number),
    "leak rates of uncertain inputs",
    needs=("case.sampled",),
)
