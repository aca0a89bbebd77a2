"""Share of each source of uncertainty in the width of the leak rate's interval."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from fem_seal.answers.answer import Answer
from fem_seal.answers.case_load import CaseLoad, SolvedSeal
from fem_seal.answers.measurements import (
    EVEN_WEIGHTS,
    LEAK_TEST,
    LINE_SCAN,
    Draws,
    LineScans,
    Measurement,
    accuracies,
    instruments,
    line_scans,
)
from fem_seal.answers.uncertainty import UNCERTAINTY, LeakInterval
from fem_seal.arrays import FloatArray
from fem_seal.case.case import Case
from fem_seal.errors import SealError
from fem_seal.seal.findings import Bounds, Validity
from fem_seal.seal.load_result import highest_load
from fem_seal.seal.load_solver import LoadSolver
from leak import LeakError


@dataclass(frozen=True)
class AfterProfiles:
    """An interval after one line scan of each face with a finish.

    Parameters
    ----------
    length : float
        Of a scan [m].
    left : float
        Upper over lower end.
    high : float
        Upper end if the scans show what is usual for the finishes [m^3/s].
    exponent : float
        d ln Q / d ln h, h the rms height.
    """

    length: float
    left: float
    high: float
    exponent: float

    def passing_height(self, limit: float) -> float:
        """Rms height up to which a requirement is then met, over the usual one.

        Parameters
        ----------
        limit : float
            Leak rate of the case's fluid [m^3/s].
        """
        return float((limit / self.high) ** (1.0 / self.exponent))


@dataclass(frozen=True)
class EarlierLoad:
    """What a larger load before would leave, told of a case that says nothing of its history.

    Parameters
    ----------
    force : float
        With which it would have pressed, twice the largest of this load and of the tightening before it [N].
    share : float or None
        Leak rate after it over that without it [-]; None of bodies that yield, whose path it would take anew.
    """

    force: float
    share: float | None


@dataclass(frozen=True)
class ErrorShares:
    """Shares in the width of the logarithm of an interval; empty where an end is zero or infinite.

    Parameters
    ----------
    of_width : mapping
        By source, the largest first: uncertain inputs by their keys, "gap law", "few waves" and "yielding" of what
        direct simulation finds, "left by test" of all inputs after a leak test, "readings", and "accuracy: " with what
        else the calculation may be off by [-].
    factor : float
        Upper over lower end of the interval.
    left : mapping
        The same factor if one of the sources were known exactly.
    by_profiles : AfterProfiles or None
        What would be left if each face with a drawing's finish were measured; None where there is none.
    measurements : sequence of Measurement
        What would narrow the interval, and to which factor, the narrowest first; empty without uncertain inputs.
    earlier_load : EarlierLoad or None
        Of the highest load of faces or bodies that yield.
    """

    of_width: Mapping[str, float] = field(default_factory=dict)
    factor: float = 1.0
    left: Mapping[str, float] = field(default_factory=dict)
    by_profiles: AfterProfiles | None = None
    measurements: Sequence[Measurement] = ()
    earlier_load: EarlierLoad | None = None

    @property
    def parts(self) -> dict[str, float]:
        """Shares of "inputs" as given or as a test has left them, "theory" against simulation, and other "doubts"."""
        found = dict.fromkeys(("inputs", "theory", "doubts") if self.of_width else (), 0.0)
        for name, share in self.of_width.items():
            part = (
                "doubts" if name.startswith(ACCURACY_OF) else "theory" if name in _BY_SIMULATION else "inputs"
            )
            found[part] += share
        return found

    @property
    def is_telling(self) -> bool:
        """Whether there is more to say than that one source makes the interval."""
        return len(self.of_width) > 1 or bool(self.measurements) or self.by_profiles is not None


_JOINT_INPUTS, _BY_TEST, ACCURACY_OF = "inputs together", "left by test", "accuracy: "
_BY_SIMULATION = {
    *("gap law", "few waves", "yielding", "bulk flow", "turned crests", "fine roughness"),
    *("readings", "simulation"),
}
# Of the range of a finish.
_PLACES = 200
# A proof load, or a hand that closes firmly, over the load.
_HARDER = 2.0


def finish_variance(case: Case) -> float | None:
    """Variance of ln h of the finishes of a case, h the rms height; None where there is none, or a rough face without.

    Parameters
    ----------
    case : Case
    """
    faces = {} if case.roughness is None else case.roughness.finishes
    if (
        case.roughness is None
        or not faces
        or len(faces) < len(case.roughness.parts)
        or case.roughness.is_turned
    ):
        return None
    scans = line_scans(case.roughness)
    places = (np.arange(_PLACES) + 0.5) / _PLACES
    spreads = {key: table.finish.spreads["rms_height"].at(places) for key, table in faces.items()}
    spread = np.sum([scans.shares[key] * np.log(values) for key, values in spreads.items()], axis=0)
    return float(spread.var()) if spread.any() else None


@dataclass(frozen=True)
class _Outlook:
    """What measurements would do to the interval of each load.

    Parameters
    ----------
    seal : SolvedSeal
    draws : Draws
    scans : LineScans
    """

    seal: SolvedSeal
    draws: Draws
    scans: LineScans

    @cached_property
    def finish_variance(self) -> float | None:
        """See the function; None unless the finishes of the seal leave the height open."""
        settings = self.seal.case.sampling
        skip = settings is None or "rms_height" in settings.spreads
        return None if skip or "rms_height" not in self.draws.values else finish_variance(self.seal.case)

    @property
    def per_height(self) -> float:
        """By how much the uncertain ln h, of finishes the mean over the faces, changes with that of the gap."""
        if self.finish_variance is None:
            return 1.0
        return float(self.draws.values["rms_height"].std()) / math.sqrt(self.finish_variance)

    @cached_property
    def rows(self) -> list[tuple[str, dict[str, float], FloatArray]]:
        """Instruments with their accuracies and the weights of the draws after them."""
        scatter = self.scans.scatter
        scatters = {"q_rolloff": scatter, "hurst": scatter, "rms_height": scatter * self.per_height}
        return [
            (name, sigma, self.draws.weigh(sigma)) for name, sigma in accuracies(self.draws.values, scatters)
        ]

    @cached_property
    def doubts(self) -> list[Bounds]:
        """Factors by which the leak rate may be off at each load, beside the draws."""
        return [load.leak_validity.leak_factor for load in self.seal.loads]

    def of(self, shares: ErrorShares, number: int) -> ErrorShares:
        """The shares of a load with the measurements that would narrow its interval."""
        draws, rates = self.draws, self.draws.log_rate[:, number]
        if not shares.of_width or not np.isfinite(rates).all():
            return shares
        width, prior = math.log(shares.factor), draws.width(rates, EVEN_WEIGHTS)
        options = []
        for instrument, sigma, weights in self.rows:
            posterior = draws.width(rates, weights)
            gain = None if posterior is None or prior is None else max(prior - posterior, 0.0)
            options.append(Measurement(instrument, sigma, None if gain is None else math.exp(width - gain)))
        scan = max(
            (entry for entry in options if entry.instrument == LINE_SCAN and "rms_height" in entry.accuracy),
            key=lambda entry: len(entry.accuracy),
            default=None,
        )
        options += self._leak_tests(number, width)
        ranking = sorted(options, key=lambda entry: math.inf if entry.left is None else entry.left)
        by_profiles = None if scan is None else self._after_profiles(scan, number)
        return replace(shares, by_profiles=by_profiles, measurements=ranking)

    def _leak_tests(self, number: int, width: float) -> Iterator[Measurement]:
        """At the lowest load, and at this one."""
        loads, draws = self.seal.loads, self.draws
        (accuracy,) = instruments()[LEAK_TEST]["accuracies"].values()
        for at in dict.fromkeys((min(range(len(loads)), key=lambda n: loads[n].point), number)):
            if np.isfinite(draws.log_rate[:, at]).all():
                weights = draws.weigh_test(at, accuracy, self.doubts[at])
                posterior = draws.width(draws.rates_with_doubt(number, self.doubts[number]), weights)
                factor = None if posterior is None else math.exp(min(posterior, width))
                yield Measurement(LEAK_TEST, {"leak_rate": accuracy}, factor, at)

    def _after_profiles(self, scan: Measurement, number: int) -> AfterProfiles | None:
        """After scans of faces with a finish."""
        if self.finish_variance is None or scan.left is None:
            return None
        draws, load = self.draws, self.seal.loads[number]
        rates, height = draws.log_rate[:, number], draws.values["rms_height"]
        usual = {name: float(np.median(values)) for name, values in draws.values.items()}
        _, high = draws.ends(rates, draws.weigh(scan.accuracy, usual))
        assert load.leak is not None  # of an interval
        largest = max(load.leak.leak_rate, *(load.leak_range or (0.0,)), math.exp(high[0]))
        slope = float(np.polyfit(height, rates[0], 1)[0]) * self.per_height
        return AfterProfiles(self.scans.length, scan.left, largest * self.doubts[number].high, slope)


def all_error_shares(seal: SolvedSeal, interval: LeakInterval | None) -> tuple[ErrorShares, ...]:
    """What makes the interval of each load, and what would narrow it.

    Parameters
    ----------
    seal : SolvedSeal
    interval : LeakInterval or None
        Of the uncertain inputs.
    """
    if seal.case.bolts is not None and seal.case.bolts.torque_scatter > 0.0:
        return (ErrorShares(),) * len(seal.loads)  # the ends of their preload have no share
    shares = tuple(error_shares(load, interval, number) for number, load in enumerate(seal.loads))
    log_peaks = np.log10([load.peak_pressure for load in seal.loads])
    draws = None if interval is None else Draws.of(interval, log_peaks)
    if draws is None or seal.case.roughness is None:
        return shares
    outlook = _Outlook(seal, draws, line_scans(seal.case.roughness))
    return tuple(outlook.of(share, number) for number, share in enumerate(shares))


def error_shares(load: CaseLoad, interval: LeakInterval | None, number: int) -> ErrorShares:
    """What makes the interval of one load.

    What is independent adds its variances: uncertain inputs, and what direct simulation finds. All else (mesh, doubts,
    readings of yielding asperities) widens what they make by a factor.

    Parameters
    ----------
    load : CaseLoad
    interval : LeakInterval or None
        Of the uncertain inputs.
    number : int
        Of the load among those of the interval.
    """
    ends = load.leak_interval
    if ends is None or not 0.0 < ends.low < ends.high < math.inf:
        return ErrorShares()
    total_width = math.log(ends.high / ends.low)
    widths = {
        f"{ACCURACY_OF}{caution.kind}": math.log(factors.high / factors.low)
        for caution in load.leak_validity.cautions
        if caution.kind != "theory" and (factors := Validity.of([caution]).leak_factor).is_range
    }
    input_width = max(total_width - sum(widths.values()), 0.0)
    variances = {} if load.flow_error is None else {k: float(v) for k, v in load.flow_error.parts.items()}
    if interval is not None and load.sample_ends is not None:
        if interval.error_scores is not None:
            scatter = float(interval.error_scores[number].var())
            variances = {name: scatter * variance for name, variance in variances.items()}
        variances |= _of_inputs(interval, number)
    if load.leak_range is not None and (load.is_simulated or not variances):
        # of a simulation two standard errors to either side
        width = math.log(load.leak_range.high / load.leak_range.low)
        variances["simulation" if load.is_simulated else "readings"] = (width / 4.0) ** 2
    total = sum(variances.values())
    if not total > 0.0:
        return ErrorShares()
    # orders of magnitude of one and of all together count alike
    scale = total_width / (sum(widths.values()) + input_width)
    widths = {name: scale * width for name, width in widths.items()}
    input_width *= scale
    exact = {name: math.exp(total_width - width) for name, width in widths.items()}
    for name, variance in variances.items():
        widths[name] = input_width * variance / total
        exact[name] = math.exp(total_width - input_width * (1.0 - math.sqrt(1.0 - variance / total)))
    ranking = sorted(widths, key=lambda name: -widths[name])
    return ErrorShares(
        {name: widths[name] / total_width for name in ranking},
        math.exp(total_width),
        {name: exact[name] for name in ranking},
    )


def _of_inputs(interval: LeakInterval, number: int) -> dict[str, float]:
    """Variance of ln Q by uncertain input, and what these do only together."""
    rates = interval.leak_rate[number]
    finite = rates[(rates > 0.0) & np.isfinite(rates)]
    variance = float(np.log(finite).var()) if finite.size else 0.0
    shares = dict(zip(interval.inputs, np.nan_to_num(interval.shares[number]).tolist(), strict=True))
    remainder = max(1.0 - sum(shares.values()), 0.0)
    if interval.error_scores is not None:
        return {_BY_TEST: variance}
    return {name: share * variance for name, share in shares.items()} | {_JOINT_INPUTS: remainder * variance}


def _with_earlier_load(
    shares: tuple[ErrorShares, ...], seal: SolvedSeal, solver: LoadSolver | None
) -> tuple[ErrorShares, ...]:
    """The shares with what a load before that pressed twice as hard as the highest one leaves of its leak rate."""
    number, problem = highest_load(seal.loads), seal.problem
    load = seal.loads[number]
    remembers = problem.follows_path or (problem.surface is not None and problem.surface.hardness is not None)
    told, leak = seal.case.load.earlier is not None, None if load.is_simulated else load.leak
    if solver is None or told or not remembers or leak is None or not leak.leak_rate > 0.0:
        return shares
    force = _HARDER * max(contact.contact_force for contact in (load.contact, *load.contact.history))
    try:
        after = None if problem.follows_path else solver.after_force(load, force).leak
    except (SealError, LeakError):
        return shares  # nobody asked for that load
    earlier_load = EarlierLoad(force, None if after is None else after.leak_rate / leak.leak_rate)
    return tuple(replace(x, earlier_load=earlier_load) if n == number else x for n, x in enumerate(shares))


ERROR_SHARES = Answer[tuple[ErrorShares, ...]](
    "error_shares",
    "what makes the interval of the leak rates",
    lambda seal, request: _with_earlier_load(
        all_error_shares(seal, UNCERTAINTY.of(request.answers)), seal, request.solver
    ),
    (),
    # one of two different faces has no share
    lambda seal, request: len(seal.case.contacts) == 1,
)
