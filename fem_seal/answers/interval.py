"""Interval of a leak rate, made of the numbers of scenarios and of what the calculation may be off by."""

from __future__ import annotations

import math

from fem_seal.seal.bounds import EXACT, Bounds
from fem_seal.seal.findings import DIRECT_SCATTER, NEARLY_SEALED, SEALED, Finding, Level, Validity
from fem_seal.seal.load_result import LoadResult
from fem_seal.units import share_text

_NINE_OF_TEN = 0.05, 0.95


def theory_error(load: LoadResult) -> Bounds:
    """Factors on a leak rate between which direct simulation finds it in nine of ten seals, by `LoadResult.flow_error`.

    Parameters
    ----------
    load : LoadResult
    """
    # what is told lies between its ends
    return EXACT if load.flow_error is None else Bounds.of([1.0, *load.flow_error.factor(_NINE_OF_TEN)])


def doubts(load: LoadResult, validity: Validity, *, sampled: bool) -> Validity:
    """The validity of a load with what its mesh leaves uncertain of the leak rate, and with the theory's own error.

    Parameters
    ----------
    load : LoadResult
    validity : Validity
    sampled : bool
        Whether samples have the theory's own error already.
    """
    # the interval holds what a simulation leaves open
    known = list(validity.without(DIRECT_SCATTER).cautions)
    share = None if load.mesh_error is None else load.mesh_error.leak_rate
    if share is not None and share > 0.0:
        told = f"the mesh leaves an error of {share_text(share)}"
        known.append(Finding("mesh", Level.VALID, told, told, Bounds.factor_bounds(1.0 + share)))
    error = EXACT if sampled else theory_error(load)
    if error != EXACT:
        told = f"direct simulation of rough surfaces finds {error.low:.2f} to {error.high:.2f} times as much"
        known.append(Finding("theory", Level.VALID, told, told, error))
    return Validity.of(known)


def combine(load: LoadResult, ends: Bounds, doubts: Validity, rougher: float) -> Bounds | None:
    """Ends of the leak rate of a load, but no more than physics lets through [m^3/s]; None without a leak rate.

    Parameters
    ----------
    load : LoadResult
        In the nominal scenario.
    ends : Bounds
        Of scenarios and samples [m^3/s].
    doubts : Validity
        What the calculation may be off by.
    rougher : float
        What the gaps of the roughest samples let through over that of the surface as given.
    """
    if load.leak is None:
        return None
    # the threshold is that of the surface as given: rougher samples are further from it, and leak no more by it
    near = [
        finding.leak_factor.high for finding in doubts.cautions if finding.kind in (NEARLY_SEALED, SEALED)
    ]
    by_threshold = load.leak_before_sealing if near else 0.0
    if near and not by_threshold and load.leak.leak_rate > 0.0:
        by_threshold = math.prod(near) * load.leak.leak_rate
    most = doubts.without(NEARLY_SEALED, SEALED).leak_factor.high
    found = Bounds(ends.low * doubts.leak_factor.low, max(ends.high, rougher * by_threshold) * most)
    # faces that are lifted off, as at the least preload, have no gap that bounds what passes
    if not found.apart or math.isinf(ends.high):
        return found
    limit = max(most_leak(load, rougher), load.leak.leak_rate)
    return Bounds(min(found.low, limit), min(found.high, limit))


def most_leak(load: LoadResult, rougher: float) -> float:
    """What physics lets through: the open bore, and the rough gap of a round seal without load [m^3/s].

    Parameters
    ----------
    load : LoadResult
    rougher : float
        See `combine`.
    """
    bore, gap = load.unsealed
    return min(bore, rougher * gap)
