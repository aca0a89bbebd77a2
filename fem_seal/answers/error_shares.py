"""What makes the interval of a leak rate as wide as it is: the share of each source in its width."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from fem_seal.answers.uncertainty import LeakInterval
from fem_seal.seal.findings import Validity
from fem_seal.seal.load_result import LoadResult


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
    """

    of_width: Mapping[str, float] = field(default_factory=dict)
    factor: float = 1.0
    left: Mapping[str, float] = field(default_factory=dict)


def error_shares(load: LoadResult, interval: LeakInterval | None, number: int) -> ErrorShares:
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
    return ErrorShares(
        {name: widths[name] / whole for name in ranked},
        math.exp(whole),
        {name: left[name] for name in ranked},
    )


def _of_inputs(interval: LeakInterval, number: int) -> dict[str, float]:
    """Variance of ln Q by uncertain input, and what these do only together."""
    rates = interval.leak_rate[number]
    known = rates[(rates > 0.0) & np.isfinite(rates)]
    variance = float(np.log(known).var()) if known.size else 0.0
    shares = dict(zip(interval.inputs, np.nan_to_num(interval.shares[number]).tolist(), strict=True))
    rest = max(1.0 - sum(shares.values()), 0.0)
    return {name: share * variance for name, share in shares.items()} | {"inputs together": rest * variance}
