"""Two different flange faces on one gasket: the seal leaks the mean of two that have one of them on both sides.

Each face carries the same force along the axis, which alone determines its contact: what a face does to the other one
through the gasket balances itself, and fades over the height of the gasket (Saint-Venant).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

from fem_seal.seal.findings import EXACT, Bounds, Finding, Level, Validity

if TYPE_CHECKING:
    from leak import LeakResult


def mean_leak(one: LeakResult, other: LeakResult) -> LeakResult:
    """Leak of a gasket, half of it as in one result and half as in another; where it flows is told by the first.

    Parameters
    ----------
    one, other : LeakResult
    """
    rate = 0.5 * (one.leak_rate + other.leak_rate)
    if 0.0 < one.leak_rate < math.inf or rate == one.leak_rate:
        return one.scaled(rate)
    # one is sealed or the other open: where it flows is not scaled
    shares = other.scaled(rate)
    return replace(shares, fluid_pressure=one.fluid_pressure, lands=one.lands)


def share_of(one: LeakResult, other: LeakResult) -> float:
    """Share of one result in the leak of both; a half where both are sealed or open.

    Parameters
    ----------
    one, other : LeakResult
    """
    if one.leak_rate == other.leak_rate:
        return 0.5
    # an open one has all of it
    return 1.0 / (1.0 + other.leak_rate / one.leak_rate) if one.leak_rate > 0.0 else 0.0


def joined_validity(upper: Validity, lower: Validity, share: Callable[[], float]) -> Validity:
    """Cautions in the words of the face for which they are worse; each face is off by its own share of the leak.

    Parameters
    ----------
    upper, lower : Validity
    share : callable
        Gives the share of the upper face in the leak, where it is needed.
    """
    return Validity.of(_joined(upper, lower, share)) if upper.cautions or lower.cautions else upper


def _joined(upper: Validity, lower: Validity, share: Callable[[], float]) -> Iterator[Finding]:
    own = share()
    for kind in dict.fromkeys(one.kind for one in (*upper.cautions, *lower.cautions)):
        alike = [Validity.of(one for one in face.cautions if one.kind == kind) for face in (upper, lower)]
        factor = [
            own * above + (1.0 - own) * below
            for above, below in zip(*(face.leak_factor for face in alike), strict=True)
        ]
        worst, *others = max(alike, key=_how_bad).cautions
        yield replace(worst, leak_factor=Bounds(*factor))
        yield from (replace(one, leak_factor=EXACT) for one in others)


def _how_bad(face: Validity) -> tuple[int, float]:
    return list(Level).index(face.level) if face.cautions else -1, face.leak_error
