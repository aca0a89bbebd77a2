"""How wide a contact becomes where a body yields, and the element sizes that follow it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING

from meshes import Sizing

if TYPE_CHECKING:
    from fem_seal.case import Case
    from fem_seal.hardening import HardeningCurve

# Prandtl's strip, the most that a narrow contact carries: (2 + pi)/sqrt(3) of the flow stress.
CONSTRAINT = 2.97
# The pressure falls off over some distance beyond the plateau, and the face rises beside it.
_BEYOND = 1.3
# Every element of a body that yields costs in every iteration; a plateau needs no more of them than this.
_ELEMENTS = 100
# As `fem_seal.contact_zone` demands it of the narrowest profile.
_PER_STD = 4.0


def curves(case: Case) -> list[HardeningCurve]:
    """Hardening curves of the bodies of a case that yield; empty if both are elastic."""
    materials = (case.closure.material, case.seat.material)
    return [material.hardening for material in materials if material.hardening is not None]


def plastic_half_width(line_load: float, flow_stress: float) -> float:
    """Half-width of a contact in the fully plastic range [m].

    Parameters
    ----------
    line_load : float
        f_N [N/m].
    flow_stress : float
        [Pa]
    """
    return line_load / (2 * CONSTRAINT * flow_stress)


def for_yielding(
    sizing: Sizing, case: Case, line_loads: Iterable[float], *, size_given: bool = False
) -> Sizing:
    """A sizing for elastic bodies, wide enough for those that yield, and no finer than they need.

    Parameters
    ----------
    sizing : Sizing
    case : Case
    line_loads : iterable of float
        f_N of every load [N/m].
    size_given : bool
        Whether the element size is the user's own.
    """
    softest = min(curve.yield_stress for curve in curves(case))
    half = _BEYOND * plastic_half_width(max(line_loads), softest)
    if half <= sizing.core:
        return sizing
    lower, upper = case.contact.reach
    start, end = sizing.zone
    # Beyond the plateau the pressure falls off as it does between elastic bodies.
    zone = max(start - half, lower), min(end + half, upper)
    # The core of an elastic sizing is three standard deviations of the narrowest contact.
    coarsest = min(2 * half / _ELEMENTS, sizing.core / 3 / _PER_STD)
    size = sizing.contact_size if size_given else max(sizing.contact_size, coarsest)
    return replace(sizing, zone=zone, core=half, contact_size=size)
