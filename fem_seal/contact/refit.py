"""Mesh adaptation: a new sizing where the mesh does not fit the contact found on it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from fem_seal.errors import ConvergenceError
from meshes import ContactGeometry, MeshingError, Sizing

if TYPE_CHECKING:
    from fem_seal.contact.solution import ContactSolution
    from fem_seal.profile import PressureProfile

# Pressure over peak pressure that the ends of the zone may carry.
_TAIL = 1e-6
_WIDER = 1.6
# Change of the pressure from one element to the next in units of the peak. The expected size keeps it below 0.3 at the
# edge of a Hertz contact and at 0.1 in a soft one; more means a peak that was not expected, as at a rounded edge.
_STEEPEST = 0.45
_FINER = 3.0
# Elements per standard deviation below which the mesh is made anew, and how many it then gets at the peak.
_FEWEST, _PER_STD = 4.0, 10.0
_MOST_MESHES = 6


@dataclass(frozen=True)
class MeshFit:
    """A mesh that is to be tried, and what was found on the one before.

    Parameters
    ----------
    sizing : Sizing or None
        Of the mesh that is to be tried; None when the one before fits, or no better one can be made.
    contact : ContactGeometry
    size_given : bool
        Whether the element size is the user's own; then only the zone grows.
    found : sequence of ContactSolution
        On the last mesh that gave any.
    tried : int
        How many meshes have been tried.
    refined : bool
        Whether elements have been halved because a contact did not converge.
    """

    sizing: Sizing | None
    contact: ContactGeometry
    size_given: bool
    found: Sequence[ContactSolution] = ()
    tried: int = 0
    refined: bool = False

    @classmethod
    def begun(cls, sizing: Sizing, contact: ContactGeometry, *, size_given: bool = False) -> MeshFit:
        """Before the first mesh. One that is given cannot be made finer."""
        return cls(sizing, contact, size_given or contact.has_ready_mesh)

    def after(self, outcome: Sequence[ContactSolution] | Exception) -> MeshFit:
        """With what was found on the mesh, or why nothing was.

        Raises
        ------
        ConvergenceError
            If a contact does not converge on the finer mesh either.
        MeshingError
            If the first mesh cannot be made. A better one that cannot be made is left: the estimate of the
            discretisation error says what the present one is worth.
        """
        assert self.sizing is not None
        if isinstance(outcome, MeshingError) and self.found:
            return replace(self, sizing=None)
        if isinstance(outcome, ConvergenceError) and not (self.refined or self.size_given):
            return replace(self, sizing=self.sizing.refined(2.0), tried=self.tried + 1, refined=True)
        if isinstance(outcome, Exception):
            raise outcome
        better = None
        if self.tried + 1 < _MOST_MESHES:
            profiles = [one.profile for one in outcome]
            better = better_sizing(self.sizing, self.contact, profiles, size_given=self.size_given)
        return replace(self, sizing=better, found=outcome, tried=self.tried + 1)


def solve_fitted(
    sizing: Sizing,
    contact: ContactGeometry,
    solve_on: Callable[[Sizing], Sequence[ContactSolution]],
    *,
    size_given: bool = False,
) -> Sequence[ContactSolution]:
    """Solve, look at the pressure, and solve again on a better mesh until zone and element sizes fit.

    Parameters
    ----------
    sizing : Sizing
        What was expected.
    solve_on : callable
        Meshes with a sizing and solves all loads.
    size_given : bool
        Whether the element size is the user's own; then only the zone grows.

    Raises
    ------
    ConvergenceError, MeshingError
        See `MeshFit.after`.
    """
    fit = MeshFit.begun(sizing, contact, size_given=size_given)
    while fit.sizing is not None:
        outcome: Sequence[ContactSolution] | Exception
        try:
            outcome = solve_on(fit.sizing)
        except (MeshingError, ConvergenceError) as error:
            outcome = error
        fit = fit.after(outcome)
    return fit.found


def better_sizing(
    sizing: Sizing, contact: ContactGeometry, profiles: Sequence[PressureProfile], *, size_given: bool = False
) -> Sizing | None:
    """A wider zone or smaller elements if the profiles found need them, else None.

    Parameters
    ----------
    sizing : Sizing
        With which they were found.
    profiles : sequence of PressureProfile
    size_given : bool
        Whether the element size must stay.
    """
    zone = _zone(sizing, contact, profiles)
    changed = sizing if zone == sizing.zone else replace(sizing, zone=zone)
    if not size_given:
        changed = _resolving(changed, profiles)
        spots = [spot for profile in profiles for spot in _steep_places(sizing, profile)]
        if spots:
            changed = replace(changed, spots=(*changed.spots, *_thinned(spots)))
    if changed == sizing:
        return None
    return rounded(changed, contact, size_given=size_given)


def rounded(sizing: Sizing, contact: ContactGeometry, *, size_given: bool = False) -> Sizing:
    """Round the sizing so that it is independent of floating-point noise; edges and ends of the faces stay.

    Parameters
    ----------
    size_given : bool
        Whether the element size is the user's own and stays.
    """
    return sizing.rounded({*contact.reach, *contact.breaks.tolist()}, exact_size=size_given)


def _resolving(sizing: Sizing, profiles: Sequence[PressureProfile]) -> Sizing:
    """Smaller elements where a profile came out narrower, or farther from first touch, than expected."""
    narrowest = min(profiles, key=lambda profile: profile.std)
    at, std = narrowest.centroid, narrowest.std
    if float(sizing.size(np.array(at))) <= std / _FEWEST:
        return sizing
    return replace(sizing, spots=(*sizing.spots, (at, std / _PER_STD)))


def _zone(
    sizing: Sizing, contact: ContactGeometry, profiles: Sequence[PressureProfile]
) -> tuple[float, float]:
    start, end = sizing.zone
    lower, upper = contact.reach
    highest = [profile.pressure.max() for profile in profiles]
    cut = [
        any(profile.pressure[n] / peak > _TAIL for profile, peak in zip(profiles, highest, strict=True))
        for n in (0, -1)
    ]
    return (
        max(_WIDER * start, lower) if cut[0] else start,
        min(_WIDER * end, upper) if cut[1] else end,
    )


def _steep_places(sizing: Sizing, profile: PressureProfile) -> list[tuple[float, float]]:
    """Where the pressure changes too much within an element, with the size that is needed there."""
    x, share = profile.x, profile.pressure / profile.pressure.max()
    # Three points lie in each element: compare those at equal places of neighbours.
    steep = (np.abs(share[3:] - share[:-3]) > _STEEPEST).nonzero()[0]
    ends = zip(x[steep].tolist(), x[steep + 3].tolist(), strict=True)
    return [
        (0.5 * (before + after), (after - before) / _FINER)
        for before, after in ends
        if after - before > sizing.contact_size / 50
    ]


def _thinned(spots: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Leave out spots that a neighbour of the same size covers."""
    kept: list[tuple[float, float]] = []
    for place, size in sorted(spots, key=lambda spot: spot[1]):
        if all(abs(place - other) > 3 * size for other, _ in kept):
            kept.append((place, size))
    return kept
