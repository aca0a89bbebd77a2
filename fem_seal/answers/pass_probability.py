"""Share of the samples that keep the requirement, with its standard error, and what follows for a batch."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from itertools import islice

import numpy as np

from fem_seal.answers.answer import Answer
from fem_seal.answers.case_load import CaseLoad, SolvedSeal
from fem_seal.answers.judgement import Limit, PassProbability
from fem_seal.answers.leakage_class import limits
from fem_seal.answers.posterior import Posterior
from fem_seal.answers.response_surface import Polynomials, ResponseSurface, fit_with_prior
from fem_seal.answers.samples import MOST_OF_FINISH, KnownRates, Samples, UncertainScans
from fem_seal.arrays import FloatArray, IntArray
from fem_seal.case.case import Case
from fem_seal.case.tables import Uncertainty
from fem_seal.errors import Text
from fem_seal.sampling import sobol_points
from fem_seal.seal.findings import sentence
from fem_seal.seal.keyed_store import KeyedStore
from leak import FlowError

# Samples that are counted; a polynomial through a few runs gives them.
_SAMPLES = 4096
# Standard error at which the runs end; as many as the last number reach it by counting alone.
_ERROR, _MOST_RUNS = 0.02, 640
# Runs for each input at first, and more of them at a time.
_FOR_EACH, _RUNS_AT_A_TIME = 2, 3
# Runs that are chosen to tell most, of so many samples; runs that are counted at first.
_CHOSEN_RUNS, _CANDIDATES, _COUNTED_RUNS = 32, 256, 64
# Inputs up to which the polynomial is a cubic, and up to which it is a quadratic one.
_CUBIC, _QUADRATIC = 6, 16
# First samples of a finish, which a polynomial must give to this share of the scatter.
_CHECKED, _POOR = 16, 0.7
# Polynomials that the runs leave possible, and samples of each, for the standard error.
_CURVES, _OF_DRAWN = 48, 512
# ln of the allowed over the calculated leak rate of a case that is sealed; of one that is open with a minus.
_LN_BOUND = 30.0
# Of a share; a tail that is smaller is no number.
_DIGITS = 6
# Batches with other unknown inputs, seals of each; share of the batches in which fewer seals pass than is told.
_BATCHES, _SEALS, _DOUBT = 512, 256, 0.05
# Of a theory that does not know its error.
_NO_ERROR = FlowError(np.zeros(()), np.full((), 1e-12))


@dataclass(frozen=True)
class Plan:
    """What samples of the same inputs have in common, whatever seal they are of.

    Parameters
    ----------
    polynomials : Polynomials
        In the inputs.
    terms : ndarray, shape (samples, terms)
        Of each sample.
    order : list of int
        All samples, those first whose runs tell most.
    """

    polynomials: Polynomials
    terms: FloatArray = field(repr=False)
    order: list[int] = field(repr=False)

    @classmethod
    def of(cls, scores: FloatArray) -> Plan:
        """That of samples with such variables, shape (samples, inputs)."""
        return _plans.get((scores.shape, scores.tobytes()), lambda: cls._build(scores))

    @classmethod
    def _build(cls, scores: FloatArray) -> Plan:
        inputs = scores.shape[1]
        polynomials = Polynomials.of(scores, 3 if inputs <= _CUBIC else 2 if inputs <= _QUADRATIC else 1)
        candidates = scores[:_CANDIDATES]
        chosen = polynomials.choose_runs(candidates, min(_CHOSEN_RUNS, len(candidates))).tolist()
        return cls(polynomials, polynomials(scores), list(dict.fromkeys([*chosen, *range(len(scores))])))


# of all seals of this process
_plans = KeyedStore(8)


@dataclass(frozen=True)
class QuickSamples:
    """Leak rates of many samples from few runs.

    Parameters
    ----------
    samples : Samples
    loads : tuple of int
        Numbers of those that are judged.
    run_numbers : ndarray of int, shape (runs,)
        Samples whose contact and leak rate were calculated.
    runs : ndarray, shape (runs, kinds times loads)
        Their leak rates at the case's own viscosity [m^3/s].
    tried_count : int
        Of the first so many samples all were tried: their runs stand for the others.
    is_counted : bool
        Whether no polynomial gives the others.
    """

    samples: Samples
    loads: tuple[int, ...]
    run_numbers: IntArray
    runs: FloatArray = field(repr=False)
    tried_count: int = 0
    is_counted: bool = False

    @property
    def plan(self) -> Plan:
        """What it has in common with other seals."""
        return Plan.of(self.samples.scores)

    def smooth(self, columns: Sequence[int] | slice) -> bool:
        """Whether no run is sealed or open, nor counted."""
        runs = self.runs[:, columns]
        return not self.is_counted and bool(np.all((runs > 0) & np.isfinite(runs)))

    @property
    def stands_check(self) -> bool:
        """Whether the polynomials of a finish give its first samples; most may leak through a thread, few be open."""
        if not (self.samples.of_finish and self.smooth(slice(None))):
            return True
        rates = self.samples.leak_rates(range(_CHECKED), self.loads).reshape(_CHECKED, -1)
        surface = self.surface(range(rates.shape[1]), np.zeros(rates.shape[1]))
        with np.errstate(divide="ignore"):
            miss = self.plan.terms[:_CHECKED] @ surface.coefficients + np.log(rates)
        return bool(np.all(np.sqrt(np.nanmean(miss**2, axis=0)) <= _POOR * np.sqrt(surface.variance)))

    def surface(self, columns: Sequence[int], ln_most: FloatArray) -> ResponseSurface:
        """Polynomials of ln of what is allowed over what leaks.

        Parameters
        ----------
        columns : sequence of int
            Of `runs`.
        ln_most : ndarray, shape (columns,)
            ln of what is allowed by each limit [m^3/s].
        """
        ln_ratio = _ln_ratio(ln_most, self.runs[:, columns])
        inputs = self.samples.scores[self.run_numbers]
        return fit_with_prior(self.plan.polynomials, inputs, np.clip(ln_ratio, -_LN_BOUND, _LN_BOUND))

    def column(self, scenario: int, number: int, *, in_test: bool) -> int:
        """Of a scenario at a load, of the case's fluid or of the gas of the test."""
        other_gas = len(self.samples.of_case) > self.samples.scenario_count
        kind = scenario + (self.samples.scenario_count if in_test and other_gas else 0)
        return kind * len(self.loads) + self.loads.index(number)


def pass_probabilities(
    seal: SolvedSeal,
    progress: Callable[[str], None] = lambda text: None,
    known_rates: KnownRates | None = None,
) -> list[PassProbability | None]:
    """The share of the samples that keep the requirement, at each load; None where nothing is required.

    A seal's leak rate is a sample of what its inputs leave open times the theory's own error, whose distribution is
    integrated in closed form. The inputs are scrambled Sobol points, the same ones for each design with the same
    uncertain inputs. For those of them that tell most the whole chain is calculated; the likeliest cubic polynomial of
    ln Q gives the others, see `fit_with_prior`. There are more runs until the standard error is 0.02 at most; where
    some are sealed or open, the first samples are counted themselves. Of the readings of yielding asperities the one
    that passes less often counts.

    Parameters
    ----------
    seal : SolvedSeal
        Its loads with their validity.
    progress : callable, optional
        Called with a status message before each step.
    known_rates : dict, optional
        See `Samples.known_rates`.

    Raises
    ------
    ConvergenceError
        If too few samples converge.

    Notes
    -----
    The standard error adds the squares of two: of a count, sqrt((s+1) (f+1)/((n+2)^2 (n+3))) for s of n samples that
    pass and f that fail (a bound for Sobol points), and of the polynomials that its runs leave possible.
    What the calculation may be off by (`LoadResult.leak_validity`) has no distribution and is not in it.

    Where inputs vary from part to part, the share of a batch is itself not known: its distribution is that over the
    other inputs, each value of which is the same for all seals of the batch.

    References
    ----------
    K. Chaloner, I. Verdinelli, Stat. Sci. 10, 273 (1995): runs that tell most of coefficients with a prior.
    """
    case, settings = seal.case, seal.case.sampling
    demand = case.requirement
    numbers = [n for n, load in enumerate(seal.loads) if demand and demand.judges(load.fluid_pressure)]
    none = {n: why for n in numbers if (why := why_none(case, seal.loads[n]))}
    ready = [n for n in numbers if n not in none]
    chances: dict[int, PassProbability] = {n: PassProbability(why_none=why) for n, why in none.items()}
    if ready:
        chances |= dict(
            zip(ready, _estimate_shares(seal, settings, ready, progress, known_rates), strict=True)
        )
    return [chances.get(n) for n in range(len(seal.loads))]


def why_none(case: Case, load: CaseLoad) -> str | Text:
    """Why there is no share; empty where there is one.

    Parameters
    ----------
    case : Case
    load : CaseLoad
        With its validity.
    """
    if load.leak is None:
        return sentence("pass_probability", "no_leak_rate")
    if load.validity.outside_theory:
        return load.validity.doubts[0].in_clause
    if any(math.isnan(limit.leak_rate) for limit in limits(case, load.fluid_pressure)):
        return sentence("pass_probability", "no_limit")
    if case.sampling is None and load.flow_error is None:
        return sentence("pass_probability", "nothing_scatters")
    return ""


def _estimate_shares(
    seal: SolvedSeal,
    settings: Uncertainty | None,
    loads: Sequence[int],
    progress: Callable[[str], None],
    known_rates: KnownRates | None,
) -> list[PassProbability]:
    if settings is None:
        samples = Samples.of_nothing(seal)
    else:
        sampling = settings.model_copy(update={"samples": max(settings.samples, _SAMPLES)})
        samples = Samples.of(seal, sampling, known_rates)
    if not samples.run_inputs:
        of_case = samples.of_case[:, loads].ravel()
        quick = QuickSamples(samples, tuple(loads), np.array([0, 0]), np.tile(of_case, (2, 1)))
        return _of_loads(seal.case, quick)
    order: Iterable[int] = Plan.of(samples.scores).order
    most_runs, rates = min(_MOST_RUNS, len(samples.uniform)), dict[int, FloatArray]()
    goal, is_counted = min(_FOR_EACH * samples.scores.shape[1] + 2, most_runs), False
    while True:
        numbers = list(islice((number for number in order if number not in rates), goal - len(rates)))
        progress(f"probability to pass: samples {len(rates) + 1} to {goal}")
        rates.update(zip(numbers, samples.leak_rates(numbers, loads).reshape(len(numbers), -1), strict=True))
        runs = np.array(list(rates.values()))
        valid = samples.valid_rows(runs)
        run_numbers, runs = np.array(list(rates))[valid], runs[valid]
        tried_count = next(number for number in range(len(rates) + 1) if number not in rates)
        quick = QuickSamples(samples, tuple(loads), run_numbers, runs, tried_count, is_counted)
        if len(run_numbers) > samples.scores.shape[1] + 1:
            chances = _of_loads(seal.case, quick)
            if goal >= most_runs or all(chance.error <= _ERROR for chance in chances):
                if quick.stands_check:
                    return chances
                # those of the interval are counted
                is_counted, order = True, range(len(samples.uniform))
                goal = most_runs = len({*rates, *order[:MOST_OF_FINISH]})
                continue
        if quick.smooth(slice(None)):
            goal = min(goal + _RUNS_AT_A_TIME if goal < _CHOSEN_RUNS else 2 * goal, most_runs)
        else:
            # those that tell most do not stand for all
            order, goal = range(len(samples.uniform)), min(max(2 * goal, _COUNTED_RUNS), most_runs)


def _of_loads(case: Case, quick: QuickSamples) -> list[PassProbability]:
    loads = quick.samples.seal.loads
    return [_of_load(case, loads[number], number, quick) for number in quick.loads]


def _of_load(case: Case, load: CaseLoad, number: int, quick: QuickSamples) -> PassProbability:
    caps, settings = limits(case, load.fluid_pressure), case.sampling
    own_error = error = load.flow_error or _NO_ERROR
    if settings is not None and settings.posterior is not None:
        # a leak test has left one of each sample
        scores = Posterior.read(settings.posterior).error_at(np.log10([load.peak_pressure]), settings.seed)[0]
        own_error = FlowError(error.bias + error.spread * scores, _NO_ERROR.spread)
    ln_most, chances = _ln_most(caps), []
    for scenario in range(quick.samples.scenario_count):
        columns = [quick.column(scenario, number, in_test=_tested_with_gas(case, cap)) for cap in caps]
        batch = math.nan
        if quick.smooth(columns) or not quick.samples.run_inputs:
            surface = quick.surface(columns, ln_most)
            share, deviation = _by_polynomial(quick, surface, own_error)
            # what a leak test has left belongs together, and is that of one seal
            batch = math.nan if own_error is not error else _batch(case, quick, surface, error)
        else:
            share, deviation = _by_count(quick, columns, ln_most, own_error)
        chances.append(PassProbability(round(share, _DIGITS), deviation, batch))
    return min(chances, key=lambda chance: chance.share)


def _by_polynomial(quick: QuickSamples, surface: ResponseSurface, error: FlowError) -> tuple[float, float]:
    """Share of the samples that pass, and its standard error."""
    terms, ln_viscosity, subset = quick.plan.terms, np.log(quick.samples.viscosity), slice(_OF_DRAWN)
    ln_ratio = (terms @ surface.coefficients).min(axis=1) + ln_viscosity
    share = float(error.share_below(np.exp(ln_ratio)).mean())
    possible = np.tensordot(terms[subset], surface.draw(_CURVES), 1).min(axis=1) + ln_viscosity[subset, None]
    by_polynomial = float(_part(error, (subset, None)).share_below(np.exp(possible)).mean(axis=0).std())
    by_count = _error_of_count(share, len(terms)) if quick.samples.inputs else 0.0
    return share, math.hypot(by_count, by_polynomial)


def _by_count(
    quick: QuickSamples, columns: Sequence[int], ln_most: FloatArray, error: FlowError
) -> tuple[float, float]:
    """The same of the runs alone, as far as they stand for all samples."""
    runs = np.flatnonzero(quick.run_numbers < quick.tried_count)
    numbers, rates = quick.run_numbers[runs], quick.runs[runs][:, columns]
    ln_ratio = _ln_ratio(ln_most, rates / quick.samples.viscosity[numbers, None]).min(axis=1)
    share = float(_part(error, numbers).share_below(np.exp(ln_ratio)).mean()) if len(numbers) else 0.5
    return share, _error_of_count(share, len(numbers))


def _part(error: FlowError, samples: IntArray | tuple[slice, None]) -> FlowError:
    """That of some samples, where each has its own."""
    return replace(error, bias=error.bias[samples]) if error.bias.ndim else error


def _batch(case: Case, quick: QuickSamples, surface: ResponseSurface, error: FlowError) -> float:
    """Share of a batch that passes for certain but for `_DOUBT`; NaN where no input varies from part to part.

    Each of many batches has unknown inputs of its own; its seals differ in the others. Of the theory's own error each
    seal has its own waves ("few waves"), all else is the same for a batch.
    """
    from scipy.special import ndtri

    base, settings = quick.samples, case.sampling
    if settings is None or not settings.of_parts:
        return math.nan
    names = ["spectrum" if isinstance(source, UncertainScans) else source.name for source in base.inputs]
    counts = [source.dimensions for source in base.inputs]
    of_parts = np.repeat([name in settings.of_parts for name in names], counts)
    batches = sobol_points(_BATCHES, len(of_parts) + 1, settings.seed)
    seals = sobol_points(_SEALS, len(of_parts), settings.seed + 1)
    uniform = np.where(of_parts, seals, batches[:, None, :-1]).reshape(-1, len(of_parts))
    samples = replace(base, uniform=uniform)
    ln_ratio = (surface(samples.scores).min(axis=1) + np.log(samples.viscosity)).reshape(_BATCHES, _SEALS)
    of_seals = np.sqrt(np.maximum(error.parts.get("few waves", 0.0), _NO_ERROR.spread**2))
    of_batch = np.sqrt(np.maximum(error.spread**2 - of_seals**2, 0.0))
    batch_error = FlowError(error.bias + of_batch * ndtri(batches[:, -1:]), of_seals)
    return float(np.quantile(batch_error.share_below(np.exp(ln_ratio)).mean(axis=1), _DOUBT))


def _error_of_count(share: float, count: int) -> float:
    """Standard deviation of a share of which so many were seen, each one before as likely as any other."""
    successes = share * count
    return math.sqrt((successes + 1.0) * (count - successes + 1.0) / (count + 3.0)) / (count + 2.0)


def _tested_with_gas(case: Case, limit: Limit) -> bool:
    """Whether a limit is that of another gas, which has flown through the same contact."""
    return bool(limit.test_fluid) and case.fluid is not None and case.fluid.gas is not None


def _ln_most(caps: Sequence[Limit]) -> FloatArray:
    """ln of what each limit allows, shape (limits,) [m^3/s]."""
    # a liquid leaks so many times as much in the test; a gas has a column of its own, and its ratio is a range
    ratios = [cap.ratio[1] if cap.ratio[0] == cap.ratio[1] else 1.0 for cap in caps]
    with np.errstate(divide="ignore"):
        return np.log([cap.leak_rate for cap in caps]) - np.log(ratios)


def _ln_ratio(ln_most: FloatArray, rates: FloatArray) -> FloatArray:
    """ln of what each limit allows over what leaks, shape (samples, limits)."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(rates == 0.0, math.inf, ln_most - np.log(rates))


PASS_PROBABILITY = Answer[Sequence[PassProbability | None]](
    "pass_probability",
    "share of the samples that keep the requirement",
    lambda seal, request: pass_probabilities(seal, request.clock.progress, request.samples),
    (),
    # the preload of bolts is not among what is sampled
    lambda seal, request: seal.case.bolts is None or seal.case.bolts.torque_scatter == 0.0,
    lambda load, number, chances: load.with_values(chance=chances[number]) if chances else load,
    "samples that keep the requirement",
    needs=("case.requirement", "problem.leaks"),
)
