"""Mesh sizing: contact zone and element sizes from the expected width, and better ones from the pressure found."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from fem_seal.arrays import FloatArray
from fem_seal.contact.laws import HardContact, Law
from fem_seal.errors import ConvergenceError, InputError
from fem_seal.files import problem
from fem_seal.loads import plastic_half_width
from meshes import ContactGeometry, MeshingError, Sizing

if TYPE_CHECKING:
    from fem_seal.contact.solution import ContactSolution
    from fem_seal.profile import PressureProfile


# Chosen so that peak, width and standard deviation change by less than 2e-4 on further refinement
# (tests/verification/test_contact.py). A soft interface spreads the pressure smoothly; the stiffer it is against the
# bodies, the sharper the pressure ends, and the smaller the elements must be to follow its edge.
_PER_STD_SOFT, _PER_STD_HARD = 6.0, 14.0
_GROWTH_ALONG, _GROWTH_DEEP = 0.16, 0.2
# Elements over the largest radius of the closure, far from the contact.
_PER_LARGEST_RADIUS = 6
# Standard deviations from first touch up to which the elements stay as small as the narrowest contact wants them, and
# up to which any contact wants them small: Hertz's ends there.
_CORE, _EDGE = 3.0, 2.0

_MOST_ELEMENTS = 1500

# Places at which faces are looked at for further lands.
_PLACES = 2001

# Elements over what is pressed flat of a rounded edge, and over its whole arc.
_PER_EDGE, _PER_ARC = 5.0, 6.0
_AT_CORNER = 10.0

# Pressure over peak pressure at which the zone may end.
_TAIL = 1e-7
# Pressure over peak pressure that needs no element size of its own.
_NO_PRESSURE = 1e-3
_LOG_SHARES: FloatArray = np.log([[_TAIL], [_NO_PRESSURE], [1.0]])


@dataclass(frozen=True)
class Opening:
    """How far from first touch the undeformed faces stay close, on both sides; see `Opening.of`.

    Parameters
    ----------
    distance : ndarray, shape (2, n)
        Distances from first touch inwards and outwards [m], increasing.
    root_gap : ndarray, shape (2, n)
        Square root of the largest gap up to there [m^(1/2)], linear in the distance for a parabola.
    x, gap : ndarray, shape (k,)
        The gap over the arc length from first touch, everywhere alike [m].
    """

    distance: FloatArray
    root_gap: FloatArray
    x: FloatArray
    gap: FloatArray

    @classmethod
    def of(cls, contact: ContactGeometry) -> Opening:
        """The opening of two faces in first touch, of geometries that are asked for again from memory."""
        return _opening.__wrapped__(contact) if contact.has_ready_mesh else _opening(contact)

    @staticmethod
    def _side(contact: ContactGeometry, end: float) -> tuple[FloatArray, FloatArray]:
        reach, steps = abs(end), np.geomspace(1e-7, 1.0, 300)
        breaks = contact.breaks[(contact.breaks * end > 0) & (np.abs(contact.breaks) < reach)]
        # The gap may begin to open at a break, such as the edge of a land. Few breaks matter: those nearest.
        edges = np.sort(np.abs(breaks))[:3]
        behind_edges = (
            [edge + (reach - edge) * steps[::3] for edge in np.resize(edges, 3)] if len(edges) else []
        )
        distance = np.sort(np.concatenate([steps * reach, *behind_edges]))
        gap = contact.gap(math.copysign(1.0, end) * distance)
        gap = np.maximum.accumulate(np.where(np.isnan(gap), np.inf, np.maximum(gap, 0.0)))
        count = 600
        places = np.round(np.linspace(0, len(distance) - 1, count)).astype(int)
        return distance[places], np.sqrt(gap[places])

    def reach(self, gap: FloatArray) -> FloatArray:
        """Distances from first touch [m], inwards and outwards, within which the faces are at most `gap` [m] apart.

        Parameters
        ----------
        gap : ndarray, shape (n,)
            [m]

        Returns
        -------
        ndarray, shape (2, n)
        """
        sides, root = zip(self.root_gap, self.distance, strict=True), np.sqrt(gap)
        return np.array([np.interp(root, root_gap, distance) for root_gap, distance in sides])

    def further_lands(self, gap: float) -> list[tuple[float, float]]:
        """Stretches of x beside that of first touch on which the faces are at most `gap` apart [m].

        Parameters
        ----------
        gap : float
            [m]
        """
        close = np.concatenate([[False], self.gap <= gap, [False]])
        ends = np.flatnonzero(close[1:] != close[:-1]).reshape(-1, 2)
        stretches = [(float(self.x[first]), float(self.x[last - 1])) for first, last in ends]
        return [(start, end) for start, end in stretches if not start <= 0 <= end]

    def stretches(self, chambers: Sequence[float], width: float) -> list[tuple[float, float]]:
        """A stretch of each land about where the faces come closest [m]; none where there is but one land.

        Parameters
        ----------
        chambers : sequence of float
            x between the lands [m].
        width : float
            Half of each stretch [m].
        """
        if not chambers:
            return []
        cuts = [0, *np.searchsorted(self.x, chambers).tolist(), len(self.x)]
        at = [self.x[start + int(np.argmin(self.gap[start:end]))] for start, end in pairwise(cuts)]
        return [(float(x - width), float(x + width)) for x in at]


# Meshes that are ready know no equality.
@lru_cache(maxsize=32)
def _opening(contact: ContactGeometry) -> Opening:
    sides = [Opening._side(contact, end) for end in contact.reach]
    x = np.linspace(*contact.reach, _PLACES)
    gap = contact.gap(x)
    distance, root_gap = (np.stack(rows) for rows in zip(*sides, strict=True))
    return Opening(distance, root_gap, x, np.where(np.isnan(gap), np.inf, gap))


@dataclass(frozen=True)
class ContactWidth:
    """Expected width of one contact.

    Parameters
    ----------
    std : float
        Standard deviation of the pressure profile [m].
    per_std : float
        Elements per standard deviation that resolve it.
    reach : tuple of float
        Distances from first touch, inwards and outwards, at which the pressure has fallen to 1e-7 of its peak [m].
    decay_length : float
        Of the interface law at the peak [m].
    closed_gap, tail_gap : float
        Gap of the undeformed faces beyond which the pressure is below a thousandth, and below 1e-7, of its peak [m].
    """

    std: float
    per_std: float
    reach: tuple[float, float]
    decay_length: float
    closed_gap: float
    tail_gap: float


def contact_widths(
    law: Law, line_loads: Sequence[float], opening: Opening, effective_modulus: float
) -> list[ContactWidth]:
    """Widths of line contacts before they are solved.

    Two elastic cylinders touch up to where their undeformed surfaces are 2 f_N/(pi E*) apart; for faces of any shape
    the places with that gap give the width a to each side. The variance of the profile is the sum of the variances of
    the interface law alone, R u0, and of Hertz, a^2/4 - exact for the exponential law and a parabolic gap; R is that of
    the parabola as wide, u0 is taken at the peak pressure. Faces that fit each other are never wider than where they
    part.

    Parameters
    ----------
    law : InterfaceLaw or HardContact
    line_loads : sequence of float
        f_N of each [N/m].
    effective_modulus : float
        E* [Pa].
    """
    f = np.array(line_loads, dtype=float)
    closed_gap = tail_gap = flat_gap = 2 * f / (math.pi * effective_modulus)
    sides = opening.reach(flat_gap)
    a = 0.5 * (sides[0] + sides[1])
    if isinstance(law, HardContact):
        std, per_std, reach, decay = a / 2, np.full_like(a, _PER_STD_HARD), 1.3 * sides, np.zeros_like(a)
    else:
        R, of_hertz = a**2 / (2 * flat_gap), a**2 / 4
        log_peak = np.log(f / (math.sqrt(math.pi / 2) * a))
        for _ in range(4):
            decay = law.decay_length(log_peak)
            std = np.sqrt(R * decay + of_hertz)
            log_peak = np.log(f / (math.sqrt(2 * math.pi) * std))
        at_tail, at_closed, at_peak = law.gap(log_peak + _LOG_SHARES)
        reach = sides + opening.reach(at_tail - at_peak)
        closed_gap, tail_gap = flat_gap + at_closed - at_peak, flat_gap + at_tail - at_peak
        per_std = np.minimum(np.maximum(a / np.sqrt(R * decay), _PER_STD_SOFT), _PER_STD_HARD)
        std = np.minimum(std, (reach[0] + reach[1]) / math.sqrt(12))
    columns = (std, per_std, *reach, decay, closed_gap, tail_gap)
    return [
        ContactWidth(std_of_load, fine, (inner, outer), *others)
        for std_of_load, fine, inner, outer, *others in zip(*(c.tolist() for c in columns), strict=True)
    ]


def element_sizes(
    law: Law,
    line_loads: Sequence[float],
    contact: ContactGeometry,
    effective_modulus: float,
    contact_size: float | None = None,
) -> Sizing:
    """Sizes that resolve every load on one mesh: fine enough for the narrowest contact, wide enough for the widest.

    Parameters
    ----------
    law : InterfaceLaw or HardContact
    line_loads : sequence of float
        f_N of every load [N/m].
    effective_modulus : float
        E* [Pa].
    contact_size : float, optional
        Element size along the contact line [m], instead of the one found.

    Raises
    ------
    InputError
        If `contact_size` cannot resolve the narrowest profile, or needs an unreasonable number of elements.
    """
    opening = Opening.of(contact)
    widths = contact_widths(law, line_loads, opening, effective_modulus)
    std = min(w.std for w in widths)
    far_size = contact.closure.largest_radius / _PER_LARGEST_RADIUS
    size = min(min(w.std / w.per_std for w in widths), far_size)
    reach = [max(sides) for sides in zip(*(w.reach for w in widths), strict=True)]
    # Contact ends where one of the faces ends, whatever the law says.
    lower, upper = contact.reach
    # a land that is set back has points too, where it comes closest
    lands = opening.further_lands(max(w.tail_gap for w in widths)) + opening.stretches(contact.chambers, std)
    zone = (
        max(min([-reach[0], *(start for start, _ in lands)]), lower),
        min(max([reach[1], *(end for _, end in lands)]), upper),
    )
    closed_lands = opening.further_lands(max(w.closed_gap for w in widths))
    land_loads = [load / (1 + len(closed_lands)) for load in line_loads]
    spots = _edges(contact, zone, size, land_loads, widths, effective_modulus)
    # A contact that ends beyond the core, or may have peaks at edges, wants small elements there as well.
    has_peaks = bool(spots) or bool(np.any((contact.breaks > zone[0]) & (contact.breaks < zone[1])))
    growths = [1 / (_EDGE * w.per_std) for w in widths if has_peaks or _EDGE * w.std > _CORE * std]
    growth = min([_GROWTH_ALONG, *growths])
    spots += _on_further_lands(closed_lands, size, growth)
    sizing = Sizing(
        contact_size=size,
        core=_CORE * std,
        zone=zone,
        growth_along=growth,
        growth_deep=_GROWTH_DEEP,
        far_size=far_size,
        spots=spots,
    )
    if (without_stubs := _without_stubs(sizing, contact)) != zone:
        sizing = replace(sizing, zone=without_stubs)
    if contact_size is None:
        return sizing
    smallest_size = (sizing.zone[1] - sizing.zone[0]) / _MOST_ELEMENTS
    if not smallest_size <= contact_size <= std:
        sizes = {"smallest": smallest_size, "std": std, "size": sizing.contact_size, "value": contact_size}
        sizes = {name: 1e6 * size for name, size in sizes.items()}
        raise InputError(problem("contact_size", **sizes, count=_MOST_ELEMENTS))
    return replace(sizing, contact_size=contact_size)


def _on_further_lands(
    lands: Sequence[tuple[float, float]], size: float, growth: float
) -> tuple[tuple[float, float], ...]:
    """Places on lands, so close that no element there is twice as large [m]."""
    spots = list[tuple[float, float]]()
    for start, end in lands:
        count = max(1, math.ceil((end - start) * growth / size))
        spots += [(start + (end - start) * (n + 0.5) / count, size) for n in range(count)]
    return tuple(spots)


def _without_stubs(sizing: Sizing, contact: ContactGeometry) -> tuple[float, float]:
    """The zone with ends that lie less than an element from the end of a face moved there."""
    (start, end), (lower, upper) = sizing.zone, contact.reach
    room = sizing.size(np.array(sizing.zone))
    return (lower if start - lower < room[0] else start, upper if upper - end < room[1] else end)


def _edges(
    contact: ContactGeometry,
    zone: tuple[float, float],
    size: float,
    land_loads: Sequence[float],
    widths: Sequence[ContactWidth],
    effective_modulus: float,
) -> tuple[tuple[float, float], ...]:
    """Rounded edges within the zone, with the element size [m] that follows the peak of the pressure there.

    A flat punch of half-width b with edges of radius rho presses them flat over d = (b/2) (3 f_N rho/(E* b^2))^(2/3),
    for d small against b (theory_geometry.md); an interface law smears the peak over sqrt(rho u0). Of several lands
    each is taken to carry an equal part of f_N: with the whole the elements would be too large.
    """
    spots = []
    for edge in contact.breaks[(contact.breaks > zone[0]) & (contact.breaks < zone[1])].tolist():
        length, radius = _arc_beside(contact, edge)
        sizes, gap = [size], float(contact.gap(np.array(edge)))
        for f, width in zip(land_loads, widths, strict=True):
            if not gap <= width.closed_gap:
                continue
            b = max(min(abs(edge), math.sqrt(3) * width.std), size)
            flat_width = 0.5 * b * (3 * f * radius / (effective_modulus * b**2)) ** (2 / 3)
            sizes.append(math.sqrt(flat_width**2 + radius * width.decay_length) / _PER_EDGE)
        edge_size = min(min(sizes), length / _PER_ARC)
        if edge_size < size:
            spots.append((edge, edge_size))
    # At the end of a face that carries pressure there is a corner of the body, and the pressure rises towards it.
    closed_gap = max(width.closed_gap for width in widths)
    for at, end, goes_on in zip(zone, contact.reach, contact.turned_away, strict=True):
        if at == end and not goes_on and float(contact.gap(np.array(end))) <= closed_gap:
            spots.append((end, size / _AT_CORNER))
    return tuple(spots)


def _arc_beside(contact: ContactGeometry, edge: float) -> tuple[float, float]:
    """Length and relative radius of the most curved piece that ends at a break [m]; infinite if both are straight."""
    places = np.concatenate([[contact.reach[0]], contact.breaks, [contact.reach[1]]])
    n = int(np.argmin(np.abs(places - edge)))
    sides = [
        (places[m + 1] - places[m], _bend(contact, 0.5 * (places[m] + places[m + 1]))) for m in (n - 1, n)
    ]
    length, bend = max(sides, key=lambda side: side[1])
    return (float(length), 1 / bend) if bend > 0 else (math.inf, math.inf)


def _bend(contact: ContactGeometry, x: float) -> float:
    """Relative curvature of the faces at x [1/m]."""
    closure = float(contact.closure_arc(np.array(x)))
    if math.isnan(closure):
        return 0.0
    return contact.closure_face.curvature(closure) - contact.seat_face.curvature(
        float(contact.seat_arc(np.array(x)))
    )


# The pressure falls off over some distance beyond the plateau, and the face rises beside it.
_FALL_OFF = 1.3
# Every element of a body that yields costs in every iteration; a plateau needs no more of them than this.
_ELEMENTS = 100


def for_yielding(
    sizing: Sizing,
    contact: ContactGeometry,
    yield_stress: float,
    line_load: float,
    *,
    size_given: bool = False,
) -> Sizing:
    """A sizing for elastic bodies, wide enough for those that yield, and no finer than they need.

    Parameters
    ----------
    sizing : Sizing
    contact : ContactGeometry
    yield_stress : float
        Of the softest body that yields [Pa].
    line_load : float
        The largest f_N [N/m].
    size_given : bool
        Whether the element size is the user's own.
    """
    half = _FALL_OFF * plastic_half_width(line_load, yield_stress)
    if half <= sizing.core:
        return sizing
    lower, upper = contact.reach
    start, end = sizing.zone
    # Beyond the plateau the pressure falls off as it does between elastic bodies.
    zone = max(start - half, lower), min(end + half, upper)
    # The core of an elastic sizing is three standard deviations of the narrowest contact.
    coarsest = min(2 * half / _ELEMENTS, sizing.core / 3 / _FEWEST)
    size = sizing.contact_size if size_given else max(sizing.contact_size, coarsest)
    return replace(sizing, zone=zone, core=half, contact_size=size)


# Pressure over peak pressure that the ends of the zone may carry.
_CUT_OFF = 1e-6
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
    solutions : sequence of ContactSolution
        On the last mesh that gave any.
    tries : int
        How many meshes have been tried.
    is_refined : bool
        Whether elements have been halved because a contact did not converge.
    """

    sizing: Sizing | None
    contact: ContactGeometry
    size_given: bool
    solutions: Sequence[ContactSolution] = ()
    tries: int = 0
    is_refined: bool = False

    @classmethod
    def begin(cls, sizing: Sizing, contact: ContactGeometry, *, size_given: bool = False) -> MeshFit:
        """Before the first mesh. One that is given cannot be made finer."""
        return cls(sizing, contact, size_given or contact.has_ready_mesh)

    def with_outcome(self, outcome: Sequence[ContactSolution] | Exception) -> MeshFit:
        """With what was found on the mesh, or why nothing was; nothing at all fits any mesh.

        Raises
        ------
        ConvergenceError
            If a contact does not converge on the finer mesh either.
        MeshingError
            If the first mesh cannot be made. A better one that cannot be made is left: the estimate of the
            discretisation error says what the present one is worth.
        """
        assert self.sizing is not None
        if isinstance(outcome, MeshingError) and self.solutions:
            return replace(self, sizing=None)
        if isinstance(outcome, ConvergenceError) and not (self.is_refined or self.size_given):
            return replace(self, sizing=self.sizing.refined(2.0), tries=self.tries + 1, is_refined=True)
        if isinstance(outcome, Exception):
            raise outcome
        better = None
        if outcome and self.tries + 1 < _MOST_MESHES:
            profiles = [solution.profile for solution in outcome]
            better = better_sizing(self.sizing, self.contact, profiles, size_given=self.size_given)
        return replace(self, sizing=better, solutions=outcome, tries=self.tries + 1)


def fit_meshes(
    fits: Mapping[int, MeshFit], solve_on: Callable[[Mapping[int, MeshFit]], Mapping[int, MeshFit]]
) -> dict[int, MeshFit]:
    """Solve, look at the pressure, and solve again on better meshes until zones and element sizes fit.

    Parameters
    ----------
    fits : mapping
        Before the first mesh, by the number of the problem.
    solve_on : callable
        Given those that want a mesh, makes it, solves all loads and returns them `after` that; without what failed.
    """
    fits = dict(fits)
    while unfit := {number: fit for number, fit in fits.items() if fit.sizing is not None}:
        fits = {number: fit for number, fit in fits.items() if fit.sizing is None} | dict(solve_on(unfit))
    return fits


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
    better = sizing if zone == sizing.zone else replace(sizing, zone=zone)
    if not size_given:
        better = _resolve_profiles(better, profiles)
        if spots := [spot for profile in profiles for spot in _steep_places(sizing, profile)]:
            better = replace(better, spots=(*better.spots, *_thin_spots(spots)))
    if better == sizing:
        return None
    return round_sizing(better, contact, size_given=size_given)


def round_sizing(sizing: Sizing, contact: ContactGeometry, *, size_given: bool = False) -> Sizing:
    """Round the sizing so that it is independent of floating-point noise; edges and ends of the faces stay.

    Parameters
    ----------
    size_given : bool
        Whether the element size is the user's own and stays.
    """
    return sizing.rounded({*contact.reach, *contact.breaks.tolist()}, exact_size=size_given)


def _resolve_profiles(sizing: Sizing, profiles: Sequence[PressureProfile]) -> Sizing:
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
    peaks = [profile.pressure.max() for profile in profiles]
    is_cut = [
        any(profile.pressure[n] / peak > _CUT_OFF for profile, peak in zip(profiles, peaks, strict=True))
        for n in (0, -1)
    ]
    return (
        max(_WIDER * start, lower) if is_cut[0] else start,
        min(_WIDER * end, upper) if is_cut[1] else end,
    )


def _steep_places(sizing: Sizing, profile: PressureProfile) -> list[tuple[float, float]]:
    """Where the pressure changes too much within an element, with the size that is needed there."""
    x, share = profile.x, profile.pressure / profile.pressure.max()
    # Three points lie in each element: compare those at equal places of neighbours.
    steep = (np.abs(share[3:] - share[:-3]) > _STEEPEST).nonzero()[0]
    ends = zip(x[steep].tolist(), x[steep + 3].tolist(), strict=True)
    return [
        (0.5 * (begin + end), (end - begin) / _FINER)
        for begin, end in ends
        if end - begin > sizing.contact_size / 50
    ]


def _thin_spots(spots: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Leave out spots that a neighbour of the same size covers."""
    spots_left: list[tuple[float, float]] = []
    for place, size in sorted(spots, key=lambda spot: spot[1]):
        if all(abs(place - place_left) > 3 * size for place_left, _ in spots_left):
            spots_left.append((place, size))
    return spots_left
