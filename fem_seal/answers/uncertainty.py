"""Interval of the leak rate from uncertain inputs, by quasi-Monte Carlo."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np

from fem_seal.answers.answer import Answer
from fem_seal.answers.case_load import CaseLoad, SolvedSeal
from fem_seal.answers.posterior import Posterior
from fem_seal.answers.response_surface import (
    ResponseSurface,
    allowed_difference,
    at_all_loads,
    bent_towards_sealing,
    first_runs,
    fit,
    largest_difference,
    representative,
    samples_at_ends,
)
from fem_seal.answers.samples import MOST_OF_FINISH, KnownRates, Samples
from fem_seal.arrays import FloatArray, IntArray
from fem_seal.case.checks import problems_with_uncertainty
from fem_seal.case.tables import Uncertainty, curves
from fem_seal.errors import InputError
from fem_seal.seal.findings import Bounds
from fem_seal.seal.scenarios import TEST_GAS

if TYPE_CHECKING:
    from leak import FlowError

# Fewest runs; left-out runs must be predicted to this share of the scatter, an error that adds 0.05 % to the width.
_FIRST_RUNS, _ERROR_OF_STD, _SMALLEST_ERROR = 16, 0.03, 2e-4
# The same of a finish, a factor of ten or more; at a sealed load it has so many samples.
_ERROR_OF_WIDE, _SEALED_OF_FINISH = 0.4, 64
# Bodies that yield are linearised at the loads of the case, unless these checks, which go through all loads, differ by
# more than the first and by more than this share of the width of ln Q that holds nine tenths of the samples.
_OF_LINEAR = 0.03, 0.06
# Factors of the theory's own error for each sample, and the most of both together.
_FACTORS, _MOST_FOUND = 32, 2**18


def _quantile(share: float, rates: FloatArray) -> FloatArray:
    """Of each row; between a finite and an infinite leak rate there is nothing to interpolate."""
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
        Largest relative error of samples that were calculated beside them, at both ends of the interval; a billionth of
        what the case itself leaks counts as nothing. None if every sample was calculated.
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
        See `CaseLoad.rougher`, at the upper end.
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
        return np.minimum.reduce(list(map(partial(_quantile, 0.5 - 0.5 * self.confidence), self._all_rates)))

    @property
    def median(self) -> FloatArray:
        """Leak rate that half of the samples exceed, with the theory's own error, shape (loads,) [m^3/s]."""
        return _quantile(0.5, self._all_rates[0])

    @cached_property
    def high(self) -> FloatArray:
        """Upper end of the interval in the reading that leaks more, at each load, shape (loads,) [m^3/s]."""
        return np.maximum.reduce(list(map(partial(_quantile, 0.5 + 0.5 * self.confidence), self._all_rates)))

    @cached_property
    def _all_rates(self) -> list[FloatArray]:
        """What direct simulation may find of the samples, in each reading: with evenly spread factors of its error."""
        all_rates = [self.leak_rate, *self.others.values()]
        if not any(self.own_error):
            return all_rates
        if self.error_scores is not None:
            errors = zip(self.own_error, self.error_scores, strict=True)
            factor = np.array([np.ones(len(z)) if x is None else x.factor_at(z) for x, z in errors])
            return [rates * factor for rates in all_rates]
        count = min(_FACTORS, max(_MOST_FOUND // self.samples, 1))
        places = (np.arange(count) + 0.5) / count
        factors = np.array([np.ones(count) if x is None else x.factor(places) for x in self.own_error])
        return [(rates[:, :, None] * factors[:, None, :]).reshape(len(rates), -1) for rates in all_rates]

    @property
    def sealed_share(self) -> FloatArray:
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
            load = load.with_scenarios({TEST_GAS: load.scenarios[TEST_GAS].with_values(sample_ends=ends)})
        return load.with_values(
            sample_ends=self.ends(number),
            leak_rate_p50=float(self.median[number]),
            rougher=self.rougher,
            after_test=self.error_scores is not None,
        )


def leak_interval(
    result: SolvedSeal,
    settings: Uncertainty | None = None,
    progress: Callable[[str], None] | None = None,
    known_rates: KnownRates | None = None,
) -> LeakInterval:
    """Leak rate of a result with an interval from uncertain inputs.

    The samples are a scrambled Sobol sequence. For the first of them the whole chain is calculated: interface law,
    contact on the condensed bodies, flow conductivity, leak rate. If ln Q turns out to be a smooth function of the
    inputs, a polynomial through these runs gives the others; if not (a sample is sealed or blown open), all are
    calculated, of a finish some. A liquid's viscosity needs no runs: Q is inversely proportional to it. Where
    asperities yield, each run gives the leak rate in both readings of the theory, on the same contact. Of many loads a
    few are sampled; at the others the ratio to what the case leaks follows over the line load.

    Bodies that yield are linearised at each load of the case, plastic flow of its last load step included, and pressed
    together anew with the law of the sample. The samples at both ends of the interval go through all loads, and if that
    changes their leak rate by more than 3 %, and than 6 % of the width of the interval in ln Q, so do all others; they
    do at once if Young's moduli are uncertain.

    Parameters
    ----------
    result : SolvedSeal
        Of a case with roughness and fluid.
    settings : Uncertainty, optional
        Instead of the case's own table [uncertainty].
    progress : callable, optional
        Called with a status message before each step.
    known_rates : dict, optional
        See `Samples.known_rates`.

    Returns
    -------
    LeakInterval

    Raises
    ------
    InputError
        If the case has no roughness or no fluid, no input is uncertain, or one does not fit the case.
    ConvergenceError
        If the contacts of too many samples do not converge.

    References
    ----------
    A. B. Owen, SIAM J. Numer. Anal. 34, 1884 (1997): scrambled nets. B. Sudret, Reliab. Eng. Syst. Saf. 93, 964 (2008).

    Examples
    --------
    >>> from fem_seal.case.tables import Spread, Uncertainty
    >>> settings = Uncertainty(samples=1024, hardness=Spread(relative=0.1))
    >>> leak_interval(fem_seal.run(case), settings).high                # doctest: +SKIP
    """
    if (settings := settings or result.case.sampling) is None:
        raise InputError.at("uncertainty", "is missing; say which inputs are uncertain")
    if problems := list(problems_with_uncertainty(result.case, settings)):
        raise InputError(*problems)
    samples = Samples.of(result, settings, known_rates)
    leaks = np.all((samples.of_case > 0) & np.isfinite(samples.of_case), axis=0)
    tell = progress or (lambda text: None)
    parts = [
        _LoadGroup(samples, np.flatnonzero(leaks == is_leaking), is_leaking, settings.confidence).part(tell)
        for is_leaking in np.unique(leaks)[::-1].tolist()
    ]
    return _interval(samples, settings, parts)


class _Part(NamedTuple):
    """Samples by their numbers at some loads, with leak rates (kinds, loads, samples) and shares (loads, inputs)."""

    loads: IntArray
    numbers: IntArray
    rates: FloatArray
    shares: FloatArray
    runs: int
    error: float | None


@dataclass(frozen=True)
class _LoadGroup:
    """Samples at loads at all of which the case itself leaks, or at none: from few runs where they are smooth."""

    samples: Samples
    loads: IntArray
    leaks: bool
    confidence: float
    whole_paths: bool = False

    @property
    def places(self) -> IntArray:
        """Places in `loads` of those that are sampled: all, or a few with line loads over the whole range."""
        return representative(self.log_line_load) if self.leaks else np.arange(len(self.loads))

    @property
    def log_line_load(self) -> FloatArray:
        """Of each load, shape (loads,)."""
        return np.log([self.samples.seal.loads[number].line_load for number in self.loads])

    @property
    def of_case(self) -> FloatArray:
        """Leak rates of the case itself, shape (kinds times sampled loads,) [m^3/s]."""
        return self.samples.of_case[:, self.loads[self.places]].ravel()

    def rates(self, numbers: Sequence[int], *, whole_paths: bool = False) -> FloatArray:
        """Leak rates of some samples, shape (samples, kinds times sampled loads) [m^3/s]."""
        loads, on_paths = self.loads[self.places].tolist(), self.whole_paths or whole_paths
        return self.samples.leak_rates(numbers, loads, whole_paths=on_paths).reshape(len(numbers), -1)

    def part(self, progress: Callable[[str], None]) -> _Part:
        """The samples at these loads."""
        samples, error, loads = self.samples, None, len(self.places)
        is_linear = samples.seal.problem.follows_path and not (self.whole_paths or samples.follow_paths)
        numbers, viscosity = np.arange(len(samples.uniform)), samples.viscosity[:, None]
        runs, surface = numbers[:0], None
        estimates = rates = np.tile(self.of_case, (len(numbers), 1))
        if samples.run_inputs:
            runs, estimates, surface = self._runs(progress)
            numbers, rates = (runs, estimates) if surface is None else (numbers, estimates.copy())
            rates[np.searchsorted(numbers, runs)] = self.rates(runs.tolist())
        if samples.run_inputs and (surface is not None or is_linear):
            # the scenarios with the fluid of the case at the last load
            last = slice(loads - 1, samples.scenario_count * loads, loads)
            ends = samples_at_ends((estimates / viscosity[numbers])[:, last], self.confidence)
            check_numbers, tolerance = numbers[ends], allowed_difference(estimates, *_OF_LINEAR)
            truth = self.rates(check_numbers.tolist(), whole_paths=True)
            error = largest_difference(estimates[ends], truth, self.of_case)
            if is_linear and error > tolerance:
                # and it is not the polynomial alone that is off
                linear = self.rates(check_numbers.tolist())
                if largest_difference(linear, truth, self.of_case) > tolerance:
                    return replace(self, whole_paths=True).part(progress)
            rates[ends] = np.where(np.isnan(truth), rates[ends], truth)
            runs = np.union1d(runs, check_numbers)
        shares = self._shares(numbers, rates[:, :loads], surface)
        rates = (rates / viscosity[numbers]).reshape(len(numbers), -1, loads).swapaxes(0, 1)
        if loads < len(self.loads):
            ratios = rates / self.of_case.reshape(-1, 1, loads)
            usual = samples.of_case[:, None, self.loads]
            rates = at_all_loads(self.log_line_load, self.places, ratios) * usual
        nearest = np.argmin(np.abs(np.arange(len(self.loads))[:, None] - self.places), axis=1)
        return _Part(self.loads, numbers, rates.swapaxes(1, 2), shares[nearest], len(runs), error)

    def _runs(self, progress: Callable[[str], None]) -> tuple[IntArray, FloatArray, ResponseSurface | None]:
        """Samples that are calculated, and leak rates of all by a polynomial through them; theirs if it is not good."""
        samples, scores, total = self.samples, self.samples.scores, len(self.samples.uniform)
        most, share, least = total, _ERROR_OF_STD, _SMALLEST_ERROR
        if samples.of_finish:
            most = min(total, MOST_OF_FINISH if self.leaks else _SEALED_OF_FINISH)
            share, least = _ERROR_OF_WIDE, 0.0
        goal = min(max(_FIRST_RUNS, first_runs(scores.shape[1])), most)
        while True:
            progress(f"uncertainty: samples up to {goal} of {most}")
            rates = self.rates(range(goal))
            # a contact that did not converge says nothing; the polynomial goes through the others
            # bodies do not always bear the extremes of a finish and of paths
            may_fail = samples.of_finish or samples.seal.problem.follows_path
            runs = samples.valid_rows(rates) if may_fail else samples.valid_rows(rates, 1.0)
            if goal < total and np.all((rates[runs] > 0) & np.isfinite(rates[runs])):
                logs = np.log(rates[runs])
                surface = fit(scores[runs], logs, scores)
                is_good = surface.error <= np.maximum(share * np.sqrt(surface.variance), least)
                if goal == most or is_good.all():
                    return runs, np.exp(bent_towards_sealing(surface, scores[runs], logs, scores)), surface
            if goal == most:
                return runs, rates[runs], None
            goal = min(goal + goal // 2, most)

    def _shares(self, numbers: IntArray, rates: FloatArray, surface: ResponseSurface | None) -> FloatArray:
        """First-order shares in the variance of ln Q of the case's own reading, shape (sampled loads, inputs)."""
        samples, loads = self.samples, rates.shape[1]
        if not np.all((rates > 0) & np.isfinite(rates)):
            return np.full((loads, len(samples.inputs)), np.nan)
        if surface is None and samples.run_inputs:
            surface = fit(samples.scores[numbers], np.log(rates), samples.scores)
        variance = np.full(loads, np.log(samples.viscosity).var())
        variances = [
            variance
            if surface is None or uncertain not in samples.run_inputs
            else surface.variance_of(samples.columns(uncertain))[:loads]
            for uncertain in samples.inputs
        ]
        total = variance if surface is None else variance + surface.variance[:loads]
        return np.array(variances).T / total[:, None]


def _interval(samples: Samples, settings: Uncertainty, parts: Sequence[_Part]) -> LeakInterval:
    """The interval of the samples at all loads; where fewer are known at some loads, they are repeated."""
    loads, (kinds, _, count) = samples.seal.loads, parts[0].rates.shape
    rates, shares = np.empty((kinds, len(loads), count)), np.empty((len(loads), len(samples.inputs)))
    numbers = np.empty((len(loads), count), dtype=np.intp)
    for part in parts:
        places = np.arange(count) % len(part.numbers)
        rates[:, part.loads] = part.rates[..., places]
        shares[part.loads], numbers[part.loads] = part.shares, part.numbers[places]
    scores = None
    if settings.posterior is not None:
        # first-order shares are those of independent inputs
        shares[:] = np.nan
        peaks = np.log10([load.peak_pressure for load in loads])
        scores = Posterior.read(settings.posterior).error_at(peaks, settings.seed)
        scores = np.take_along_axis(scores, numbers, axis=1)
    count, others = samples.scenario_count, tuple(loads[0].others)
    intervals = [
        LeakInterval(
            tuple(uncertain.name for uncertain in samples.inputs),
            settings.confidence,
            settings.seed,
            sum(part.runs for part in parts),
            rates[first],
            shares,
            max((part.error for part in parts if part.error is not None), default=None),
            dict(zip(others, rates[first + 1 : first + count], strict=True)),
            [load.flow_error for load in loads],
            values={
                uncertain.name: uncertain.reported_values(samples.values[uncertain.name])[parts[0].numbers]
                for uncertain in samples.inputs
            },
            error_scores=scores,
            rougher=samples.rougher(0.5 + 0.5 * settings.confidence),
        )
        for first in range(0, kinds, count)
    ]
    return replace(intervals[0], in_test=intervals[1]) if len(intervals) > 1 else intervals[0]


UNCERTAINTY = Answer[LeakInterval | None](
    "uncertainty",
    "interval of the leak rates",
    lambda seal, request: leak_interval(seal, progress=request.clock.progress, known_rates=request.samples),
    None,
    # each sample repeats a path of loads: minutes for an interval of which nothing would be claimed
    lambda seal, request: not (curves(seal.case) and all(x.validity.outside_theory for x in seal.loads)),
    lambda load, number, interval: load if interval is None else interval.of_load(load, number),
    "leak rates of uncertain inputs",
    needs=("case.sampling",),
)
