"""Share of the samples that keep the requirement, with its standard error, and what follows for a batch."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fem_seal.answers.answer import Answer
from fem_seal.answers.judgement import JudgedLoad, Limit, PassProbability
from fem_seal.answers.leakage_class import limits
from fem_seal.answers.posterior import Posterior
from fem_seal.answers.response_surface import IntArray, ResponseSurface, fit
from fem_seal.answers.uncertainty import SampledSeal, UncertainScans
from fem_seal.arrays import FloatArray
from fem_seal.errors import ConvergenceError
from fem_seal.sampling import sobol_points
from fem_seal.validity.words import sentence
from leak import FlowError

if TYPE_CHECKING:
    from fem_seal.case.case import Case
    from fem_seal.case.tables import Uncertainty
    from fem_seal.seal.load_result import LoadResult, SolvedSeal

# Samples that are counted; a polynomial through a few runs gives them.
_SAMPLES = 4096
# Standard error at which the runs end; as many as the last number reach it by counting alone.
_ERROR, _MOST_RUNS = 0.02, 640
# Lowest degree of the polynomial and runs per coefficient; share of them that must converge.
_RUNS_PER_TERM, _FEWEST_KNOWN = 1.35, 0.7
# Inputs up to which that degree is two; beyond it is one.
_QUADRATIC = 12
# Of a share; a tail that is smaller is no number.
_DIGITS = 6
# Batches with other unknown inputs, seals of each; share of the batches in which fewer seals pass than is told.
_BATCHES, _SEALS, _DOUBT = 512, 256, 0.05
# Of a theory that does not know its error.
_EXACT = FlowError(np.zeros(()), np.full((), 1e-12))


@dataclass(frozen=True)
class QuickSamples:
    """Leak rates of many samples from few runs.

    Parameters
    ----------
    sampled : SampledSeal
        Its loads are those that are judged.
    known : ndarray of int, shape (runs,)
        Samples whose contact and leak rate were calculated.
    runs : ndarray, shape (runs, readings and fluids times loads)
        Their leak rates at the case's own viscosity [m^3/s].
    """

    sampled: SampledSeal
    known: IntArray
    runs: FloatArray = field(repr=False)

    @cached_property
    def smooth(self) -> NDArray[np.bool_]:
        """Whether a polynomial gives the samples, as no run is sealed or open, shape as a row of `runs`."""
        smooth = np.all((self.runs > 0) & np.isfinite(self.runs), axis=0)
        return np.asarray(smooth & bool(self.sampled.calculated))

    @cached_property
    def surface(self) -> ResponseSurface:
        """Polynomial of ln Q, of those that are smooth."""
        ln_rates, scores = np.log(np.where(self.smooth, self.runs, 1.0)), self.sampled.scores
        return fit(scores[self.known], ln_rates, scores, _RUNS_PER_TERM, _lowest_degree(scores.shape[1]))

    def ln_rates(self, column: int, of: SampledSeal | None = None) -> FloatArray:
        """ln Q by the polynomial, shape (samples,), of other samples of the same inputs if there are any."""
        sampled = of or self.sampled
        if sampled.calculated:
            return self.surface(sampled.scores)[:, column] - np.log(sampled.viscosity)
        with np.errstate(divide="ignore"):
            return np.asarray(np.log(self.runs[0, column]) - np.log(sampled.viscosity))

    def without_each(self, column: int) -> FloatArray:
        """ln Q by the polynomials through all runs but one, shape (samples, runs)."""
        known = self.surface.without_each(self.sampled.scores, column)
        return known - np.log(self.sampled.viscosity)[:, None]

    def of_runs(self, column: int) -> FloatArray:
        """ln Q of the runs themselves, shape (runs,)."""
        with np.errstate(divide="ignore"):
            return np.asarray(np.log(self.runs[:, column] / self.sampled.viscosity[self.known]))

    def column(self, reading: int, number: int, *, in_test: bool) -> int:
        """Of a reading at a load, of the case's fluid or of the gas of the test."""
        kind = reading + (self.sampled.readings if in_test and len(self.sampled.flows) > 1 else 0)
        return kind * len(self.sampled.result.loads) + number


def pass_probabilities(
    seal: SolvedSeal, progress: Callable[[str], None] = lambda text: None
) -> list[PassProbability | None]:
    """The share of the samples that keep the requirement, at each load; None where nothing is required.

    A seal's leak rate is a sample of what its inputs leave open times the theory's own error, whose distribution is
    integrated in closed form. The inputs are scrambled Sobol points, the same ones for each design with the same
    uncertain inputs. For the first of them the whole chain is calculated; a quadratic polynomial of ln Q gives the
    others. There are more runs until the standard error is 0.02 at most; where some are sealed or open, they are
    counted themselves. Of the readings of yielding asperities the one that passes less often counts.

    Parameters
    ----------
    seal : SolvedSeal
        Its loads with their validity.
    progress : callable, optional
        Called with a status message before each step.

    Raises
    ------
    ConvergenceError
        If too few samples converge.

    Notes
    -----
    The standard error adds the squares of two: of a count, sqrt((s+1) (f+1)/((n+2)^2 (n+3))) for s of n samples that
    pass and f that fail (a bound for Sobol points), and of the polynomial, by leaving out each of its runs (jackknife).
    What the calculation may be off by (`LoadResult.leak_validity`) has no distribution and is not in it.

    Where inputs vary from part to part, the share of a batch is itself not known: its distribution is that over the
    other inputs, each value of which is the same for all seals of the batch.

    References
    ----------
    B. Efron, C. Stein, Ann. Stat. 9, 586 (1981): variance by leaving out each run.
    """
    case, settings = seal.case, seal.case.sampled
    required = case.requirement
    asked = [n for n, load in enumerate(seal.loads) if required and required.judges(load.fluid_pressure)]
    none = {n: why for n in asked if (why := _why_none(case, seal.loads[n]))}
    judged = [n for n in asked if n not in none]
    found: dict[int, PassProbability] = {n: PassProbability(why_none=why) for n, why in none.items()}
    if judged:
        part = seal.with_loads([seal.loads[n] for n in judged])
        found |= dict(zip(judged, _found(part, settings, judged, progress), strict=True))
    return [found.get(n) for n in range(len(seal.loads))]


def _lowest_degree(inputs: int) -> int:
    """Of the polynomial in so many inputs."""
    return 2 if inputs <= _QUADRATIC else 1


def _why_none(case: Case, load: LoadResult) -> str:
    """Why there is no share; empty where there is one."""
    if load.leak is None:
        return sentence("pass_probability", "no_leak_rate")
    if load.validity.outside:
        return load.validity.reasons[0]
    if any(math.isnan(one.leak_rate) for one in limits(case, load.fluid_pressure)):
        return sentence("pass_probability", "no_limit")
    if case.sampled is None and load.flow_error is None:
        return sentence("pass_probability", "nothing_scatters")
    return ""


def _found(
    seal: SolvedSeal, settings: Uncertainty | None, numbers: Sequence[int], progress: Callable[[str], None]
) -> list[PassProbability]:
    if settings is None:
        sampled = SampledSeal(seal, (), np.empty((1, 0)))
    else:
        many = settings.model_copy(update={"samples": max(settings.samples, _SAMPLES)})
        sampled = replace(SampledSeal.of(seal, many), lenient=True, numbers=numbers)
    if not sampled.calculated:
        every = np.arange(len(sampled.uniform))
        return _of_loads(seal.case, QuickSamples(sampled, every, np.tile(sampled.of_case, (len(every), 1))))
    inputs, degree = sampled.scores.shape[1], _lowest_degree(sampled.scores.shape[1])
    fewest = goal = math.ceil(_RUNS_PER_TERM * math.comb(inputs + degree, degree)) + 1
    most = min(_MOST_RUNS, len(sampled.uniform))
    rates = np.empty((0, sampled.kinds * len(seal.loads)))
    while True:
        progress(f"probability to pass: samples {len(rates) + 1} to {goal}")
        rates = np.concatenate([rates, sampled.leak_rates(range(len(rates), goal))])
        known = np.flatnonzero(~np.isnan(rates).any(axis=1))
        if len(known) < _FEWEST_KNOWN * goal:
            raise ConvergenceError(
                f"pass probability: {goal - len(known)} of {goal} samples did not converge"
            )
        if len(known) >= fewest:
            found = _of_loads(seal.case, QuickSamples(sampled, known, rates[known]))
            if goal >= most or all(one.error <= _ERROR for one in found):
                return found
        goal = min(2 * goal, most)


def _of_loads(case: Case, quick: QuickSamples) -> list[PassProbability]:
    return [_of_load(case, load, number, quick) for number, load in enumerate(quick.sampled.result.loads)]


def _of_load(case: Case, load: LoadResult, number: int, quick: QuickSamples) -> PassProbability:
    allowed, error = limits(case, load.fluid_pressure), load.flow_error or _EXACT
    settings, every = case.sampled, np.arange(len(quick.sampled.uniform))
    tested = settings is not None and settings.posterior is not None

    def error_of(samples: IntArray) -> FlowError:
        """That of some samples; a leak test has left one of each."""
        if settings is None or settings.posterior is None:
            return error
        peak = np.log10([load.peak_pressure])
        own = Posterior.read(settings.posterior).error_at(peak, settings.seed)[0, samples]
        return FlowError(error.bias + error.spread * own, _EXACT.spread)

    read = []
    for reading in range(quick.sampled.readings):
        columns = [quick.column(reading, number, in_test=_tested_with_gas(case, one)) for one in allowed]
        smooth = bool(quick.smooth[columns].all())
        ln_ratio = _ln_ratio(allowed, columns, quick.ln_rates if smooth else quick.of_runs)
        own = error_of(every if smooth else quick.known)
        share = float(own.share_below(np.exp(ln_ratio)).mean())
        off = _error_of_count(share, len(ln_ratio)) if quick.sampled.inputs else 0.0
        if smooth:
            each = replace(own, bias=own.bias[:, None]) if tested else own
            without = each.share_below(np.exp(_ln_ratio(allowed, columns, quick.without_each)))
            off = math.hypot(off, _jackknife(without.mean(axis=0)))
        known = smooth or not quick.sampled.calculated
        # what a leak test has left belongs together, and is that of one seal
        batch = _batch(case, allowed, columns, quick, error) if known and not tested else math.nan
        read.append(PassProbability(round(share, _DIGITS), off, batch))
    return min(read, key=lambda one: one.share)


def _jackknife(without: FloatArray) -> float:
    """Standard error of a number from what it is without each of the runs."""
    return math.sqrt((len(without) - 1) * float(without.var()))


def _batch(
    case: Case, allowed: Sequence[Limit], columns: Sequence[int], quick: QuickSamples, error: FlowError
) -> float:
    """Share of a batch that passes for certain but for `_DOUBT`; NaN where no input varies from part to part.

    Each of many batches has unknown inputs of its own; its seals differ in the others. Of the theory's own error each
    seal has its own waves ("few waves"), all else is the same for a batch.
    """
    from scipy.special import ndtri

    sampled, settings = quick.sampled, case.sampled
    if settings is None or not settings.of_parts:
        return math.nan
    names = ["spectrum" if isinstance(one, UncertainScans) else one.name for one in sampled.inputs]
    counts = [one.dimensions for one in sampled.inputs]
    of_parts = np.repeat([name in settings.of_parts for name in names], counts)
    batches = sobol_points(_BATCHES, len(of_parts) + 1, settings.seed)
    seals = sobol_points(_SEALS, len(of_parts), settings.seed + 1)
    uniform = np.where(of_parts, seals, batches[:, None, :-1]).reshape(-1, len(of_parts))
    many = replace(sampled, uniform=uniform)
    ln_ratio = _ln_ratio(allowed, columns, partial(quick.ln_rates, of=many)).reshape(_BATCHES, _SEALS)
    of_seals = np.sqrt(np.maximum(error.parts.get("few waves", 0.0), _EXACT.spread**2))
    of_batch = np.sqrt(np.maximum(error.spread**2 - of_seals**2, 0.0))
    own = FlowError(error.bias + of_batch * ndtri(batches[:, -1:]), of_seals)
    return float(np.quantile(own.share_below(np.exp(ln_ratio)).mean(axis=1), _DOUBT))


def _error_of_count(share: float, count: int) -> float:
    """Standard deviation of a share of which so many were seen, each one before as likely as any other."""
    passed = share * count
    return math.sqrt((passed + 1.0) * (count - passed + 1.0) / (count + 3.0)) / (count + 2.0)


def _tested_with_gas(case: Case, limit: Limit) -> bool:
    """Whether a limit is that of another gas, which has flown through the same contact."""
    return bool(limit.test_fluid) and case.fluid is not None and case.fluid.gas is not None


def _ln_ratio(
    allowed: Sequence[Limit], columns: Sequence[int], ln_rates: Callable[[int], FloatArray]
) -> FloatArray:
    """ln of the allowed over the calculated leak rate, of several limits the least."""
    ratios = []
    for limit, column in zip(allowed, columns, strict=True):
        # a liquid leaks so many times as much in the test; a gas has a column of its own, and its ratio is a range
        more = limit.ratio[1] if limit.ratio[0] == limit.ratio[1] else 1.0
        most = math.log(limit.leak_rate / more) if limit.leak_rate else -math.inf
        rates = ln_rates(column)
        with np.errstate(invalid="ignore"):
            ratios.append(np.where(rates == -math.inf, math.inf, most - rates))
    return np.minimum.reduce(ratios)


PASS_PROBABILITY = Answer[Sequence[PassProbability | None]](
    "pass_probability",
    "share of the samples that keep the requirement",
    lambda seal, ask: pass_probabilities(seal, ask.clock.progress),
    (),
    lambda seal, wanted: seal.case.requirement is not None and seal.problem.leaks,
    lambda load, number, found: JudgedLoad.of(load, passing=found[number]) if found else load,
    "samples that keep the requirement",
)
