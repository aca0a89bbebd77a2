"""Interval of a leak rate, made of the numbers of scenarios and of what the calculation may be off by."""

from __future__ import annotations

import math
from collections.abc import Callable

from fem_seal.seal.bounds import EXACT, Bounds
from fem_seal.seal.findings import DIRECT_SCATTER, NEARLY_SEALED, SEALED, Finding, Level, Validity
from fem_seal.units import share_text


def doubts(validity: Validity, mesh_error: float | None, own_error: Bounds) -> Validity:
    """A validity with what the mesh leaves uncertain of the leak rate, and with the theory's own error.

    Parameters
    ----------
    validity : Validity
    mesh_error : float or None
        Relative error of the leak rate; None if not known.
    own_error : Bounds
        Factors on the leak rate between which direct simulation finds it.
    """
    # the interval holds what a simulation leaves open
    known = list(validity.without(DIRECT_SCATTER).cautions)
    if mesh_error is not None and mesh_error > 0.0:
        told = f"the mesh leaves an error of {share_text(mesh_error)}"
        known.append(Finding("mesh", Level.VALID, told, told, Bounds.factor_bounds(1.0 + mesh_error)))
    if own_error != EXACT:
        low, high = own_error
        told = f"direct simulation of rough surfaces finds {low:.2f} to {high:.2f} times as much"
        known.append(Finding("theory", Level.VALID, told, told, own_error))
    return Validity.of(known)


def combine(
    rate: float,
    ends: Bounds,
    doubts: Validity,
    rougher: float,
    before_sealing: Callable[[], float],
    most_leak: Callable[[], float],
) -> Bounds:
    """Ends of a leak rate, but no more than physics lets through [m^3/s].

    Parameters
    ----------
    rate : float
        In the nominal scenario [m^3/s].
    ends : Bounds
        Of scenarios and samples [m^3/s].
    doubts : Validity
        What the calculation may be off by.
    rougher : float
        What the gaps of the roughest samples let through over that of the surface as given.
    before_sealing, most_leak : callable
        Give what leaks at most where the percolation threshold decides, and what physics lets through [m^3/s]; asked
        only where they count.
    """
    # the threshold is that of the surface as given: rougher samples are further from it, and leak no more by it
    near = [
        finding.leak_factor.high for finding in doubts.cautions if finding.kind in (NEARLY_SEALED, SEALED)
    ]
    by_threshold = before_sealing() if near else 0.0
    if near and not by_threshold and rate > 0.0:
        by_threshold = math.prod(near) * rate
    most = doubts.without(NEARLY_SEALED, SEALED).leak_factor.high
    found = Bounds(ends.low * doubts.leak_factor.low, max(ends.high, rougher * by_threshold) * most)
    # faces that are lifted off, as at the least preload, have no gap that bounds what passes
    if not found.apart or math.isinf(ends.high):
        return found
    limit = max(most_leak(), rate)
    return Bounds(min(found.low, limit), min(found.high, limit))
