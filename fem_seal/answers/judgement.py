"""Outcome of a leak rate beside its limit: pass, fail or inconclusive, and pass or fail unless the theory is off."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum
from typing import Protocol

from fem_seal.errors import Text
from fem_seal.seal.findings import ORDERS_OF_MAGNITUDE, VALID, Bounds, Validity


class Verdict(StrEnum):
    """What is claimed of a requirement, worse and worse."""

    PASS = "pass"
    PASS_UNLESS = "pass unless"
    """It passes unless the calculation is off, which it may be by so much."""
    INCONCLUSIVE = "inconclusive"
    FAIL_UNLESS = "fail unless"
    """It fails unless the calculation is off, which it may be by so much."""
    FAIL = "fail"


class VerdictReason(StrEnum):
    """What decided a verdict, or kept it from being decided."""

    LIMIT = "limit"
    """The whole interval is on one side of the limit."""
    OPEN = "open"
    """The seal is open."""
    INTERVAL = "interval"
    """The limit is inside the interval of the leak rate."""
    TEST_FLUID = "test fluid"
    """So it is once the interval is that of the fluid of the test."""
    VISIBLE = "visible"
    """No visible leakage is allowed, and what leaks may or may not be seen."""
    OUTSIDE = "outside"
    """The load is outside the theory."""
    FAR = "far"
    """More leaks than outside the theory, or without an interval, is taken for its error."""
    ACCURACY = "accuracy"
    """The limit is inside the interval, but outside of what is calculated without what that may be off by."""
    UNSAMPLED = "unsampled"
    """What the inputs leave open is not known."""
    UNKNOWN = "unknown"
    """There is no leak rate."""


RANK = {verdict: rank for rank, verdict in enumerate(Verdict)}


@dataclass(frozen=True)
class Limit:
    """A largest allowed leak rate, and for which fluid.

    Parameters
    ----------
    name : str
        "leak rate", or standard and class.
    leak_rate : float
        Of the fluid that it is for; where no leakage may be visible what nobody sees [m^3/s].
    visible : float
        Where no leakage may be visible: what is seen for certain [m^3/s].
    test_fluid : str
        Of the standard, where the leak rate of the case is not that of its test; empty otherwise.
    ratio : tuple of float
        Leak rate of the test's fluid over that of the case, at least and at most.
    bubble_volume : float or None
        Of one bubble, where the limit counts them [m^3].
    """

    name: str
    leak_rate: float
    visible: float = 0.0
    test_fluid: str = ""
    ratio: tuple[float, float] = (1.0, 1.0)
    bubble_volume: float | None = None

    @property
    def failing_rate(self) -> float:
        """What fails for certain if more leaks [m^3/s]."""
        return max(self.leak_rate, self.visible)


@dataclass(frozen=True)
class LoadVerdict:
    """What is said of one load.

    Parameters
    ----------
    verdict : Verdict
    margin : float
        Allowed leak rate over the upper end of the calculated one: infinite where sealed, zero where open, NaN where
        one of them is not known.
    why : VerdictReason
    limit : Limit
    ends : tuple of float
        Of the leak rate's interval, of the fluid that the limit is for [m^3/s].
    reason : str or Text
        Why the load is outside the theory, or what the calculation may be off by; empty otherwise.
    off : float
        Of "pass unless" and "fail unless": factor by which the calculation would have to be off for another verdict.

    Examples
    --------
    >>> judged = LoadVerdict.of(Limit("leak rate", 2e-9), (0.5e-9, 1e-9))
    >>> str(judged.verdict), judged.margin
    ('pass', 2.0)
    """

    verdict: Verdict
    margin: float
    why: VerdictReason
    limit: Limit
    ends: tuple[float, float] = (math.nan, math.nan)
    reason: str | Text = ""
    off: float = math.nan

    @property
    def times_over(self) -> float:
        """Lower end of the leak rate over what fails for certain: infinite where open, NaN if not known."""
        if self.why is VerdictReason.OPEN:
            return math.inf
        return self.ends[0] / self.limit.failing_rate

    @classmethod
    def of(
        cls,
        limit: Limit,
        ends: tuple[float, float],
        validity: Validity = VALID,
        *,
        complete: bool = True,
        core: Bounds | None = None,
    ) -> LoadVerdict:
        """The judgement of a leak rate.

        Parameters
        ----------
        limit : Limit
        ends : tuple of float
            Lower and upper end of the leak rate's interval, of the case's own fluid, with what the calculation may be
            off by [m^3/s]; NaN if not known.
        validity : Validity
            Of the leak rate, with the factors that are in the interval.
        complete : bool
            Whether the interval holds what the inputs leave open.
        core : Bounds, optional
            The interval without what the calculation may be off by; else what the factors have widened [m^3/s].
        """
        if any(map(math.isnan, (*ends, limit.leak_rate))):
            return cls(Verdict.INCONCLUSIVE, math.nan, VerdictReason.UNKNOWN, limit)
        in_test = Bounds(*ends).widen(limit.ratio)
        if math.isinf(ends[0]):
            return cls(Verdict.FAIL, 0.0, VerdictReason.OPEN, limit, in_test)
        verdict, why = _decide(limit, ends, in_test)
        margin = _margin(limit, in_test.high)
        core = in_test.ratio_to(validity.leak_factor) if core is None else core.widen(limit.ratio)
        if (validity.outside_theory or not complete) and core.low > ORDERS_OF_MAGNITUDE * limit.failing_rate:
            reason = validity.doubts[0].in_clause if validity.outside_theory else ""
            return cls(Verdict.FAIL, margin, VerdictReason.FAR, limit, in_test, reason)
        if validity.outside_theory and not (verdict is Verdict.FAIL and validity.leaks_more):
            # of what may not be claimed to be sealed there is no margin
            margin = math.nan if math.isinf(margin) else margin
            return cls(
                Verdict.INCONCLUSIVE,
                margin,
                VerdictReason.OUTSIDE,
                limit,
                in_test,
                validity.doubts[0].in_clause,
            )
        if not complete:
            return cls(Verdict.INCONCLUSIVE, math.nan, VerdictReason.UNSAMPLED, limit, in_test)
        if verdict is Verdict.INCONCLUSIVE:
            core_verdict, _ = _decide(limit, core, core)
            if core_verdict is not Verdict.INCONCLUSIVE:
                passes = core_verdict is Verdict.PASS
                verdict = Verdict.PASS_UNLESS if passes else Verdict.FAIL_UNLESS
                factor = _margin(limit, core.high) if passes else core.low / limit.failing_rate
                reason = validity.leak_clause(more=passes)
                return cls(verdict, margin, VerdictReason.ACCURACY, limit, in_test, reason, factor)
        return cls(verdict, margin, why, limit, in_test)


def _margin(limit: Limit, highest: float) -> float:
    if highest == 0:
        return math.inf
    return limit.leak_rate / highest


def _decide(
    limit: Limit, ends: tuple[float, float], in_test: tuple[float, float]
) -> tuple[Verdict, VerdictReason]:
    low, high = in_test
    if high <= limit.leak_rate:
        return Verdict.PASS, VerdictReason.LIMIT
    if low > limit.failing_rate:
        return Verdict.FAIL, VerdictReason.LIMIT
    if limit.visible:
        return Verdict.INCONCLUSIVE, VerdictReason.VISIBLE
    is_decided = ends[1] <= limit.leak_rate or ends[0] > limit.leak_rate
    return Verdict.INCONCLUSIVE, VerdictReason.TEST_FLUID if is_decided else VerdictReason.INTERVAL


def severity(outcome: LoadVerdict) -> tuple[int, float]:
    """By which verdicts are put in order: larger is worse. Of those that fail the surest is the worst.

    Parameters
    ----------
    outcome : LoadVerdict
    """
    how = outcome.times_over if outcome.verdict in (Verdict.FAIL, Verdict.FAIL_UNLESS) else -outcome.margin
    return RANK[outcome.verdict], -math.inf if math.isnan(how) else how


def worst_of(loads: Iterable[HasJudgement]) -> Verdict | None:
    """The worst verdict of some loads; None of none.

    Parameters
    ----------
    loads : iterable
        Each with its judgement, None where nothing is required of it.
    """
    verdicts = [load.judgement for load in loads if load.judgement is not None]
    return max(verdicts, key=severity).verdict if verdicts else None


class HasJudgement(Protocol):
    """Something that has a judgement."""

    @property
    def judgement(self) -> LoadVerdict | None:
        """None where nothing is required."""


@dataclass(frozen=True)
class Utilisation:
    """How far the bodies and the asperities are used, of the loads that are judged.

    Parameters
    ----------
    yield_stress : float or None
        Largest von Mises stress over the yield stress of its body; None if none is known.
    body : str
        Which body that is; empty without one.
    hardness : float or None
        Peak pressure over hardness; None if no hardness is known.
    opening : float or None
        Smallest margin to opening, as a share of what acts; None where nothing opens the seal.
    """

    yield_stress: float | None = None
    body: str = ""
    hardness: float | None = None
    opening: float | None = None


@dataclass(frozen=True)
class SealVerdict:
    """What is said of the seal: the worst of the loads at which the requirement is to be met.

    Parameters
    ----------
    worst : LoadVerdict
        That of the deciding load.
    fluid_pressure, applied_force : float
        Of the deciding load [Pa], [N].
    number : int or None
        Of the deciding load among those of the result; None if it has no result.
    load_numbers : tuple of int
        Numbers of the loads of the result that are judged.
    left_out : int
        Loads that should have been judged and have no result.
    shares : Utilisation
    """

    worst: LoadVerdict
    fluid_pressure: float
    applied_force: float
    number: int | None
    load_numbers: tuple[int, ...]
    left_out: int = 0
    shares: Utilisation = Utilisation()

    @property
    def verdict(self) -> Verdict:
        """That of the deciding load."""
        return self.worst.verdict

    @property
    def margin(self) -> float:
        """Of the deciding load, see `LoadVerdict.margin`."""
        return self.worst.margin


@dataclass(frozen=True)
class VerdictForce:
    """The smallest force with which the verdict passes, its interval and what the calculation may be off by included.

    Parameters
    ----------
    force : float or None
        Of spring or actuator [N]; None if none is found.
    why_none : str or Text
        Why not, a clause; empty with a force.
    looked_for : bool
        Whether it was, or was too dear unless asked for.
    begins : str
        What the load meets where loads leave something behind: "on a new seal", "after the largest earlier load".
    """

    force: float | None
    why_none: str | Text = ""
    looked_for: bool = True
    begins: str | Text = ""


@dataclass(frozen=True)
class PassProbability:
    """Share of the samples of a load that keep the requirement; in a batch that of the seals.

    Parameters
    ----------
    share : float
        Of the samples of inputs, finish and theory's own error; NaN if not known.
    error : float
        Its standard error.
    batch_low : float
        Share of a batch that passes with 95 % confidence; NaN where no input varies from part to part, and where
        samples are sealed or open.
    why_none : str
        Why there is no share, a clause; empty with one.
    """

    share: float = math.nan
    error: float = math.nan
    batch_low: float = math.nan
    why_none: str | Text = ""


@dataclass(frozen=True)
class BoltState:
    """Bolts under one load; all numbers are of one bolt, the tightest.

    Parameters
    ----------
    preload, force : float
        Tightened without fluid, and under the load [N].
    stress : float
        Of the larger of both on the stress area [Pa].
    utilisation : float or None
        This stress over the yield stress; None where that is not known.
    torque : float or None
        With which the preload is reached [N m]; None where it is not known.
    preload_for_target, torque_for_target, stress_for_target : float or None
        The smallest preload with which the leak rate stays below the target [N], its torque [N m], and the stress under
        the larger of preload and load [Pa]; None if not asked or not found.
    """

    preload: float
    force: float
    stress: float
    utilisation: float | None = None
    torque: float | None = None
    preload_for_target: float | None = None
    torque_for_target: float | None = None
    stress_for_target: float | None = None
