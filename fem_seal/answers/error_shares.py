"""Share of each source of uncertainty in the width of the leak rate's interval."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from statistics import NormalDist
from typing import TYPE_CHECKING

import numpy as np

from fem_seal.seal.findings import Validity
from leak.surfaces.random import height_scatter

if TYPE_CHECKING:
    from fem_seal.answers.uncertainty import LeakInterval
    from fem_seal.case.case import Case
    from fem_seal.seal.load_result import LoadResult


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

    def passing_height(self, allowed: float) -> float:
        """Rms height up to which a requirement is then met, over the usual one.

        Parameters
        ----------
        allowed : float
            Leak rate of the case's fluid [m^3/s].
        """
        return float((allowed / self.high) ** (1.0 / self.exponent))


@dataclass(frozen=True)
class ErrorShares:
    """Shares in the width of the logarithm of an interval; empty where an end is zero or infinite.

    Parameters
    ----------
    of_width : mapping
        By source, the largest first: uncertain inputs by their keys, "gap law", "few waves" and "yielding" of what
        direct simulation finds, "readings", and "accuracy: " with what else the calculation may be off by [-].
    factor : float
        Upper over lower end of the interval.
    left : mapping
        The same factor if one of the sources were known exactly.
    by_profiles : AfterProfiles or None
        What would be left if each face with a drawing's finish were measured; None where there is none.
    """

    of_width: Mapping[str, float] = field(default_factory=dict)
    factor: float = 1.0
    left: Mapping[str, float] = field(default_factory=dict)
    by_profiles: AfterProfiles | None = None


# What a line scan shows of a surface; its lay and the waves below the stylus it does not.
_SHOWN = ("hurst", "q_rolloff", "rms_height")
_OF_FINISH = (*_SHOWN, "q_high", "lay")
_TOGETHER = "inputs together"
# A run over which an instrument is to go, over the cutoff: five and one before and after (ISO 21920-3).
_CUTOFFS = 7.0
# Of the range of a finish.
_PLACES = 200


@dataclass(frozen=True)
class MeasuredProfiles:
    """Line scans of all faces with a drawing's finish, one of each.

    Parameters
    ----------
    length : float
        Of the longest [m].
    left, before : float
        Variance of ln h that they leave, and that of the finishes as they are, h the rms height [-].
    """

    length: float
    left: float
    before: float


def measured_profiles(case: Case) -> MeasuredProfiles | None:
    """What line scans would say of the finishes of a case; None where there is none, or a rough face without.

    Parameters
    ----------
    case : Case
    """
    faces = {} if case.roughness is None else case.roughness.finishes
    spreads = {key: one.finish.spreads["rms_height"] for key, one in faces.items()}
    if case.roughness is None or not faces or len(faces) < len(case.roughness.parts):
        return None
    lengths = {key: _CUTOFFS * one.finish.band.lambda_c for key, one in faces.items()}
    surfaces = {key: one.surface() for key, one in faces.items()}
    whole = sum(one.spectrum.rms_height**2 for one in surfaces.values())
    share = {key: one.spectrum.rms_height**2 / whole for key, one in surfaces.items()}
    left = sum((share[key] * height_scatter(one.across, lengths[key])) ** 2 for key, one in surfaces.items())
    places = (np.arange(_PLACES) + 0.5) / _PLACES
    spread = np.sum([share[key] * np.log(one.at(places)) for key, one in spreads.items()], axis=0)
    return MeasuredProfiles(max(lengths.values()), left, float(spread.var())) if spread.any() else None


def error_shares(
    load: LoadResult,
    interval: LeakInterval | None,
    number: int,
    profiles: MeasuredProfiles | None = None,
) -> ErrorShares:
    """What makes the interval of one load.

    What is independent adds its variances: uncertain inputs, and what direct simulation finds. All else (mesh, doubts,
    readings of yielding asperities) widens what they make by a factor.

    Parameters
    ----------
    load : LoadResult
    interval : LeakInterval or None
        Of the uncertain inputs.
    number : int
        Of the load among those of the interval.
    profiles : MeasuredProfiles, optional
        Of the case.
    """
    ends = load.leak_interval
    if ends is None or not 0.0 < ends.low < ends.high < math.inf:
        return ErrorShares()
    whole = math.log(ends.high / ends.low)
    widths = {
        f"accuracy: {one.kind}": math.log(factors.high / factors.low)
        for one in load.leak_validity.cautions
        if one.kind != "theory" and (factors := Validity.of([one]).leak_factor).apart
    }
    together = max(whole - sum(widths.values()), 0.0)
    variances = {} if load.flow_error is None else {k: float(v) for k, v in load.flow_error.parts.items()}
    if interval is not None and load.sampled is not None:
        variances |= _of_inputs(interval, number)
    if not variances and load.leak_range is not None:
        variances = {"readings": 1.0}
    total = sum(variances.values())
    if not total > 0.0:
        return ErrorShares()
    # orders of magnitude of one and of all together count alike
    scale = whole / (sum(widths.values()) + together)
    widths = {name: scale * width for name, width in widths.items()}
    together *= scale
    left = {name: math.exp(whole - width) for name, width in widths.items()}
    for name, variance in variances.items():
        widths[name] = together * variance / total
        left[name] = math.exp(whole - together * (1.0 - math.sqrt(1.0 - variance / total)))
    ranked = sorted(widths, key=lambda name: -widths[name])
    by_profiles = None
    if profiles is not None and variances.get("rms_height", 0.0) > 0.0:
        shown = sum(variances.get(name, 0.0) for name in _SHOWN)
        shown *= 1.0 + variances[_TOGETHER] / sum(variances.get(name, 0.0) for name in _OF_FINISH)
        slope = variances["rms_height"] / profiles.before
        rest = min(total - shown + slope * profiles.left, total)
        after = math.exp(whole - together * (1.0 - math.sqrt(rest / total)))
        assert load.leak is not None and interval is not None  # of an interval that is sampled
        bias = 0.0 if load.flow_error is None else float(load.flow_error.bias)
        above = bias + math.sqrt(rest) * NormalDist().inv_cdf(0.5 + 0.5 * interval.confidence)
        most = max(load.leak.leak_rate, *(load.leak_range or (0.0,)))
        high = most * math.exp(max(above, 0.0)) * load.leak_validity.leak_factor.high
        by_profiles = AfterProfiles(profiles.length, after, high, math.sqrt(slope))
    return ErrorShares(
        {name: widths[name] / whole for name in ranked},
        math.exp(whole),
        {name: left[name] for name in ranked},
        by_profiles,
    )


def _of_inputs(interval: LeakInterval, number: int) -> dict[str, float]:
    """Variance of ln Q by uncertain input, and what these do only together."""
    rates = interval.leak_rate[number]
    known = rates[(rates > 0.0) & np.isfinite(rates)]
    variance = float(np.log(known).var()) if known.size else 0.0
    shares = dict(zip(interval.inputs, np.nan_to_num(interval.shares[number]).tolist(), strict=True))
    rest = max(1.0 - sum(shares.values()), 0.0)
    return {name: share * variance for name, share in shares.items()} | {_TOGETHER: rest * variance}
