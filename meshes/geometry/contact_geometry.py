"""First touch of two faces, their contact line and the exact gap between them: no faceted mesh involved."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import groupby, pairwise, product
from typing import Any

import numpy as np

from meshes.arrays import FloatArray
from meshes.errors import GeometryError, mm
from meshes.geometry.curve import Curve, Segment
from meshes.geometry.outline import Outline

# So many straight lines in a row that turn the same way, by less than this at each corner [rad], are a curve that was
# written as lines.
_FACETS, _FACET_TURN = 4, math.radians(20)


@dataclass(frozen=True)
class Touch:
    """First touch.

    Parameters
    ----------
    radius : float
        r0 [m].
    drop : float
        Way of the closure along -z from where it was drawn to first touch [m].
    """

    radius: float
    drop: float


def first_touch(closure: Curve, seat: Curve, labels: tuple[str, str] = ("closure", "seat")) -> Touch:
    """Find the circle on which two faces touch first, in closed form for every pair of segments.

    Along a line or an arc that is run outwards the sine of the inclination is linear in r, so the places where two
    segments are parallel, and their distance along z stationary, solve a linear equation.

    Parameters
    ----------
    closure, seat : Curve
        Faces, run from smaller to larger radius.
    labels : tuple of str, optional
        What an error calls the two bodies.

    Returns
    -------
    Touch
        Its radius and the way there [m]. Faces that touch along a whole stretch (two cones of the same angle) touch
        first in its middle; of several circles that touch at once the innermost counts.

    Raises
    ------
    GeometryError
        If a face turns back towards the axis, or the faces do not lie above each other anywhere.

    Examples
    --------
    >>> import meshes
    >>> ball = meshes.Ball(0.02)
    >>> seat = meshes.ConicalSeat.around(0.785, ball)
    >>> touch = meshes.first_touch(ball.outline.face, seat.outline.face)
    >>> print(f"{touch.radius * 1e3:.2f} mm")
    14.14 mm
    """
    (top, bottom), upper, lower = labels, _graph(closure, labels[0]), _graph(seat, labels[1])
    places = [(r, c.height(r) - s.height(r)) for c in upper for s in lower for r in _candidates(c, s)]
    if not places:
        raise GeometryError(
            f"{top} and {bottom} do not meet: the {top}'s face reaches from r = {mm(upper[0].start)} to "
            f"{mm(upper[-1].end)}, the {bottom}'s from {mm(lower[0].start)} to {mm(lower[-1].end)}; change the radii, "
            "the angle or the bore so that they overlap"
        )
    drop = min(distance for _, distance in places)
    slack = 1e-13 * max(closure.length, seat.length)
    radii = sorted(r for r, distance in places if distance <= drop + slack)
    # Two circles that touch at once have a gap between them; a stretch has none.
    end = radii[0]
    for r in radii[1:]:
        if _distance(upper, lower, 0.5 * (end + r)) > drop + slack:
            break
        end = r
    return Touch(float(0.5 * (radii[0] + end)), float(drop))


def _distance(upper: list[_Graph], lower: list[_Graph], r: float) -> float:
    (c,) = [g for g in upper if g.start <= r <= g.end][:1]
    (s,) = [g for g in lower if g.start <= r <= g.end][:1]
    return c.height(r) - s.height(r)


@dataclass(frozen=True)
class _Graph:
    """A segment as function z(r)."""

    start: float
    end: float
    z: float
    angle: float
    curvature: float

    def sine(self, r: float) -> float:
        return math.sin(self.angle) + self.curvature * (r - self.start)

    def height(self, r: float) -> float:
        angle = math.asin(min(max(self.sine(r), -1.0), 1.0))
        # The chord from the start stands at the mean of both inclinations.
        return self.z + (r - self.start) * math.tan(0.5 * (angle + self.angle))


def _graph(face: Curve, name: str) -> list[_Graph]:
    points, tangents = face.point(face.breaks), face.tangent(face.breaks[:-1])
    pieces = zip(points.T[:-1], points.T[1:], tangents.T, face.curvatures(face.breaks[:-1]), strict=True)
    graphs = []
    for segment, ((start, z), (end, _), (dr, dz), curvature) in zip(face.segments, pieces, strict=True):
        angle = math.atan2(dz, dr)
        last = math.sin(angle) + curvature * (end - start)
        if not (end > start and abs(angle) <= math.pi / 2 * (1 + 1e-9) and abs(last) <= 1 + 1e-9):
            raise GeometryError(
                f"the face of the {name} turns back towards the axis between r = {mm(segment.start[0])} and "
                f"{mm(segment.end[0])}; a face must run outwards all the way"
            )
        graphs.append(_Graph(start, end, z, angle, curvature))
    return graphs


def _candidates(c: _Graph, s: _Graph) -> list[float]:
    low, high = max(c.start, s.start), min(c.end, s.end)
    if low > high:
        return []
    bend, slope = c.curvature - s.curvature, c.sine(low) - s.sine(low)
    if abs(bend) * (high - low) < 1e-12 and abs(slope) < 1e-12:
        return [0.5 * (low + high)]
    stationary = low - slope / bend if bend else math.nan
    inner = [stationary] if low < stationary < high else []
    return [*inner, low, high]


def at_a_corner(face: Curve, arc_length: float) -> bool:
    """Whether a face has a sharp corner at an arc length [m]."""
    is_near = np.abs(face.breaks[1:-1] - arc_length) < 1e-9 * face.length
    for s in face.breaks[1:-1][is_near]:
        step = 1e-12 * face.length
        tangent_before, tangent_after = face.tangent(s - step), face.tangent(s + step)
        if float(tangent_before @ tangent_after) < math.cos(1e-4):
            return True
    return False


def facets_at(face: Curve, radius: float) -> tuple[Segment, ...]:
    """The straight lines in place of a curve to which a face was reduced where it is touched; none where it was not.

    Parameters
    ----------
    face : Curve
    radius : float
        Where the bodies touch first [m].
    """
    turns = [
        0.0 if first.centre or second.centre else _turn(first, second)
        for first, second in pairwise(face.segments)
    ]
    signs = [math.copysign(1, t) if 1e-4 < abs(t) < _FACET_TURN else 0.0 for t in turns]
    start = 0
    for way, group in groupby(signs):
        end = start + len(list(group))
        pieces = face.segments[start : end + 1]
        if way and len(pieces) >= _FACETS and pieces[0].start[0] <= radius <= pieces[-1].end[0]:
            return pieces
        start = end
    return ()


def _turn(line: Segment, next_line: Segment) -> float:
    """Angle by which a line turns from the one before [rad]."""
    a, b = np.subtract(line.end, line.start), np.subtract(next_line.end, next_line.start)
    return math.atan2(a[0] * b[1] - a[1] * b[0], float(a @ b))


def with_faces(closure: Outline, seat: Outline) -> tuple[Outline, Outline]:
    """Outlines whose faces are named, those that are not yet being found by the closest approach along the axis.

    Parameters
    ----------
    closure, seat : Outline
        A body that does not name its face has pieces without a name, one of which will touch.

    Raises
    ------
    GeometryError
        If there are several chains, and none of one body lies above one of the other.
    """
    chains = list(product(_faces_in(closure), _faces_in(seat)))
    if len(chains) == 1:
        # whether they meet is found by whoever asks for their first touch
        return chains[0]
    pairs = []
    for c, s in chains:
        try:
            pairs.append((first_touch(c.face, s.face, (c.label, s.label)).drop, c, s))
        except GeometryError as error:
            refusal = error
    if not pairs:
        raise refusal
    return min(pairs, key=lambda pair: pair[0])[1:]


def _faces_in(outline: Outline) -> list[Outline]:
    """The outline with each chain that could be its face named so; the outline itself if it names one."""
    if any(s.name == f"{outline.name}_face" for s in outline.segments):
        return [named_beside(outline)]
    way = -1 if outline.name == "closure" else 1
    could_be = [not s.name and looks(s) == way for s in outline.segments]
    chains = [list(run) for could, run in groupby(range(len(could_be)), could_be.__getitem__) if could]
    if not chains:
        side = "downwards" if outline.name == "closure" else "upwards"
        raise GeometryError(f"{outline.name} outline: no piece without another name looks {side}")
    face = f"{outline.name}_face"
    return [named_beside(_rename_segments(outline, dict.fromkeys(chain, face))) for chain in chains]


def looks(s: Segment) -> int:
    """Whether a piece of a counter-clockwise outline looks upwards, 1, downwards, -1, or to the side, 0."""
    inwards = s.start[0] - s.end[0]
    steep = abs(inwards) <= 1e-9 * (abs(s.end[1] - s.start[1]) + abs(inwards))
    return 0 if steep else 1 if inwards > 0 else -1


def named_beside(outline: Outline) -> Outline:
    """Pieces without a name called after the side of the face on which they lie."""
    if all(s.name for s in outline.segments):
        return outline
    at = [n for n, s in enumerate(outline.segments) if s.name == f"{outline.name}_face"]
    # The surface of the closure begins at the axis, that of the seat at the wall.
    first, last = ("inner", "outer") if outline.name == "closure" else ("outer", "inner")
    numbers = [n for n, s in enumerate(outline.segments) if not s.name]
    return _rename_segments(outline, {n: f"{outline.name}_{first if n < at[0] else last}" for n in numbers})


def _rename_segments(outline: Outline, names: Mapping[int, str]) -> Outline:
    """The outline with new names of some of its segments, by their numbers."""
    pieces = (replace(s, name=names.get(n, s.name)) for n, s in enumerate(outline.segments))
    return Outline(outline.name, tuple(pieces), label=outline.label)


# Points of the seat's face between which the contact normal turns evenly, and rounds in which it settles.
_PER_FACE, _ROUNDS = 400, 4
# Cosine between contact normal and seat below which the seat has turned away from the closure.
_GRAZING = 0.25


@dataclass(frozen=True)
class ContactGeometry:
    """Closure and seat in first touch, z = 0 on the circle of touch.

    The contact line is the seat's face. x is the arc length on it, zero at first touch, positive towards larger r.
    Every point of it meets the point of the closure in front of it along the contact normal, which is the common one
    at first touch and turns with the less curved face: with the seat where the closure bends more, not at all where one
    face is straight or they bend away from each other. Along it the distance of the faces is that of a parabola on a
    plane however far they stand apart; along the normal of a small edge radius it is not.

    Parameters
    ----------
    closure, seat : Outline
        Sections of the bodies, already in touch.
    initial_contact_radius : float
        Radius r0 of first touch [m].

    Examples
    --------
    >>> import meshes
    >>> ball = meshes.Ball(0.02)
    >>> contact = meshes.ContactGeometry.of(ball.outline, meshes.ConicalSeat.around(0.785, ball).outline)
    >>> print(f"r0 = {contact.initial_contact_radius * 1e3:.2f} mm, R = {contact.relative_radius * 1e3:.1f} mm")
    r0 = 14.14 mm, R = 20.0 mm
    """

    closure: Outline
    seat: Outline
    initial_contact_radius: float

    @classmethod
    def of(cls, closure: Outline, seat: Outline) -> ContactGeometry:
        """Bring two sections together along the axis.

        Raises
        ------
        GeometryError
            If they touch on the axis, at a sharp corner, or where a face ends, or do not meet at all.
        """
        closure, seat = with_faces(closure, seat)
        touch = first_touch(closure.face, seat.face, (closure.label, seat.label))
        if touch.radius <= 1e-9 * seat.largest_radius:
            raise GeometryError(
                f"{closure.label} and {seat.label} touch first on the axis; a seal needs a circle of contact: give the "
                f"{seat.label} a bore, or choose shapes that touch away from the axis"
            )
        s = seat.face.project_radius(touch.radius)
        level = float(seat.face.point(np.asarray(s))[1])
        geometry = cls(closure.shift(-touch.drop - level), seat.shift(-level), touch.radius)
        geometry._check_touch()
        return geometry

    def _check_touch(self) -> None:
        labels = f"{self.closure.label} and {self.seat.label}"
        for body in (self.closure, self.seat):
            face, label = body.face, body.label
            s = float(face.project(np.array(self.initial_contact_radius), np.array(0.0)))
            if min(s, face.length - s) < 1e-9 * face.length:
                edge = face.point(np.array([0.0, face.length]))[0]
                examples = ', such as "sharp-edge" or "conical-land"' if body is self.seat else ""
                raise GeometryError(
                    f"{labels} would touch first at r = {mm(self.initial_contact_radius)}, where the face "
                    f"of the {label} ends: it reaches from {mm(edge[0])} to {mm(edge[1])}; change the radii, "
                    f"the angle or the bore, or take a shape whose edge is round{examples}"
                )
            if at_a_corner(face, s):
                corner = f"first at r = {mm(self.initial_contact_radius)} at a sharp corner of the {label}"
                facets = facets_at(face, self.initial_contact_radius)
                remedy = (
                    f"where {len(facets)} short lines in a row stand for a curve; draw arcs or a spline there"
                    if facets
                    else "give it an edge radius"
                )
                raise GeometryError(f"{labels} touch {corner}{',' if facets else ';'} {remedy}")

        if any(start < self._origin < end for start, end in self._chambers):
            raise GeometryError(
                f"{labels} touch first at r = {mm(self.initial_contact_radius)}, in a chamber between two "
                "lands; make the chamber deeper, or the lands closer to each other"
            )

    @property
    def labels(self) -> dict[str, Any]:
        """What the body above and the one below are called: values of {upper} and {lower} in sentences."""
        return {"upper": self.closure.label, "lower": self.seat.label}

    def label_of(self, name: str) -> str:
        """What a body is called, by its name "closure" or "seat"."""
        return self.closure.label if name == "closure" else self.seat.label

    @property
    def has_ready_mesh(self) -> bool:
        """Whether a body is meshed already, so that its elements are what they are."""
        return any(body.ready_mesh is not None for body in (self.closure, self.seat))

    def with_finer_meshes(self) -> ContactGeometry:
        """The same contact with every ready mesh halved; bodies without one are left alone."""
        return replace(self, closure=self.closure.halve_triangles(), seat=self.seat.halve_triangles())

    @cached_property
    def closure_face(self) -> Curve:
        """Face of the closure in first touch, from smaller to larger r."""
        return self.closure.face

    @cached_property
    def seat_face(self) -> Curve:
        """Face of the seat, from smaller to larger r."""
        return self.seat.face

    @cached_property
    def _origin(self) -> float:
        return self.seat_face.project_radius(self.initial_contact_radius)

    @cached_property
    def angle(self) -> float:
        """Angle theta between the axis and the contact normal at first touch [rad]; negative leans outwards."""
        n = self.normal(np.array(0.0))
        angle = math.atan2(-n[0], n[1])
        return angle if abs(angle) > 1e-15 else 0.0

    @property
    def seat_curvature(self) -> float:
        """Curvature of the seat at first touch [1/m], positive where it is hollow."""
        return self.seat_face.curvature(self._origin)

    @property
    def closure_curvature(self) -> float:
        """Curvature of the closure at first touch [1/m], positive where it bulges."""
        touch = self.closure_face.project(np.array(self.initial_contact_radius), np.array(0.0))
        return self.closure_face.curvature(float(touch))

    @cached_property
    def relative_radius(self) -> float:
        """R_rel of the line contact [m]: 1/R_rel = 1/R_closure + 1/R_seat, hollow negative; inf if they fit."""
        bend = self.closure_curvature - self.seat_curvature
        size = min(self.closure_face.length, self.seat_face.length)
        return 1 / bend if bend * size > 1e-9 else math.inf

    @cached_property
    def _normal_angles(self) -> tuple[FloatArray, FloatArray] | None:
        """Arc lengths on the seat [m] and angles of the contact normal there [rad]; None if it does not turn."""
        seat, closure = self.seat_face, self.closure_face
        if seat.is_straight or closure.is_straight:
            return None
        s = _sorted_unique(np.append(seat.dense(_PER_FACE), self._origin))
        # In the middle of a chamber the normal turns evenly from that of one land to that of the next.
        ends = [0.0, *(end for chamber in self._chambers for end in chamber), seat.length]
        lands = [s[(s >= low) & (s <= high)] for low, high in zip(ends[::2], ends[1::2], strict=True)]
        angles = np.concatenate([self._normal_angle(land) for land in lands])
        return None if np.ptp(angles) < 1e-12 else (np.concatenate(lands), angles)

    def _normal_angle(self, s: FloatArray) -> FloatArray:
        """Angle of the contact normal at arc lengths of one land [rad]."""
        seat, closure, tilt = self.seat_face, self.closure_face, _angles(self.seat_face, s)
        if s[0] <= self._origin <= s[-1]:
            origin, first = self._origin, float(_angles(seat, np.array([self._origin]))[0])
        else:
            # where the closure comes closest along the axis
            height, arc = closure.hits(seat.point(s), np.broadcast_to([[0.0], [1.0]], (2, len(s))))
            if np.isnan(height).all():
                return np.full(len(s), float(_angles(seat, np.array([self._origin]))[0]))
            nearest = int(np.nanargmin(height))
            origin, first = float(s[nearest]), float(_angles(closure, arc[nearest : nearest + 1])[0])
        angle = np.full(len(s), first)
        # A turn of the rays moves where they meet the closure by that turn of a small gap: it settles at once.
        for _ in range(_ROUNDS):
            arc = closure.hits(seat.point(s), _normals(angle))[1]
            is_hit = ~np.isnan(arc[1:] + arc[:-1])
            turns = np.diff(_angles(closure, np.where(np.isnan(arc), 0.0, arc)))
            share = _smaller(np.diff(tilt), turns) / np.where(np.diff(tilt) == 0, 1.0, np.diff(tilt))
            # Beside the closure the normal goes on turning as it does at its end.
            steps = np.interp(s[1:], s[1:][is_hit], share[is_hit]) * np.diff(tilt)
            angle = np.concatenate([[0.0], np.cumsum(steps)])
            angle += first - np.interp(origin, s, angle)
        return angle

    @cached_property
    def reach(self) -> tuple[float, float]:
        """Arc lengths [m] between which both faces stand in front of each other."""
        r, z = self.closure_face.point(np.array([0.0, self.closure_face.length]))
        start, end = self.coordinate(r, z).tolist()
        # Where the last ray grazes the end of the face it may miss by round-off; the face is long enough without, and
        # so is the arc of a sharp edge.
        shortest = min(s.length for face in (self.closure_face, self.seat_face) for s in face.segments)
        slack = min(1e-6 * (end - start), 1e-3 * shortest)
        return self._last_in_front(start + slack, slack), self._last_in_front(end - slack, slack)

    @property
    def turned_away(self) -> tuple[bool, bool]:
        """Whether the seat goes on at the ends of `reach`, turned away from the closure."""
        start, end = (self.facing(np.array(self.reach)) < 1.05 * _GRAZING).tolist()
        return start, end

    def _last_in_front(self, end: float, tolerance: float) -> float:
        """How far towards x = `end` every contact normal leaves the seat and meets the closure, both [m]."""
        inner_end, rounds = 0.0, max(3, math.ceil(math.log(abs(end) / tolerance, 40)))
        for _ in range(rounds):
            x = np.linspace(inner_end, end, 41)
            misses = np.isnan(self.gap(x)) | (self.facing(x) < _GRAZING)
            if not misses.any():
                return end
            first = int(np.argmax(misses))
            inner_end, end = float(x[max(first - 1, 0)]), float(x[first])
        return inner_end

    @property
    def breaks(self) -> FloatArray:
        """x at which one of the two faces has a corner or bends differently from there on [m], increasing."""
        seat_bends = self.seat_face.bends - self._origin
        closure_bends = self.coordinate(*self.closure_face.point(self.closure_face.bends))
        return _sorted_unique(np.concatenate([seat_bends, closure_bends]))

    @property
    def chambers(self) -> tuple[float, ...]:
        """x in the middle of each chamber between two lands [m], increasing; none on most seats."""
        return tuple(0.5 * (start + end) - self._origin for start, end in self._chambers)

    @cached_property
    def _chambers(self) -> tuple[tuple[float, float], ...]:
        """Arc lengths on the seat between which the middle half of each chamber lies [m], of a groove below it."""
        seat = self.seat_face
        chambers = [np.array(ends) for ends in _middles(seat)]
        for ends in _middles(self.closure_face):
            arc = seat.hits(self.closure_face.point(np.array(ends)), np.array([[0.0, 0.0], [-1.0, -1.0]]))[1]
            chambers.append(arc)
        return tuple(sorted((float(start), float(end)) for start, end in chambers))

    def point(self, x: FloatArray) -> FloatArray:
        """Points (r, z) of the contact line [m], shape (2, ...) over x."""
        return self.seat_face.point(np.asarray(x) + self._origin)

    def radius(self, x: FloatArray) -> FloatArray:
        """Radius r(x) of the contact line [m]."""
        return self.point(x)[0]

    def height(self, x: FloatArray) -> FloatArray:
        """Height z(x) of the contact line [m]."""
        return self.point(x)[1]

    def normal(self, x: FloatArray) -> FloatArray:
        """Unit contact normal (n_r, n_z), from seat to closure; shape (2, ...) over x."""
        s = np.asarray(x, dtype=float) + self._origin
        if self._normal_angles is None:
            first = self.seat_face.normal(np.array(self._origin))
            return np.broadcast_to(first.reshape(2, *(1,) * s.ndim), (2, *s.shape)).copy()
        return _normals(np.interp(s, *self._normal_angles))

    def facing(self, x: FloatArray) -> FloatArray:
        """Cosine of the angle between the seat's own normal and the contact normal, over x."""
        normal = self.seat_face.normal(np.asarray(x, dtype=float) + self._origin)
        return np.sum(normal * self.normal(x), axis=0)

    def bend(self, x: FloatArray) -> FloatArray:
        """Curvature of the more curved of the two faces over x [1/m], whichever way it bends."""
        arc = self.closure_arc(x)
        closure = self.closure_face.curvatures(np.where(np.isnan(arc), 0.0, arc))
        return np.maximum(np.abs(closure), np.abs(self.seat_face.curvatures(self.seat_arc(x))))

    @property
    def normal_turns(self) -> bool:
        """Whether the contact normal turns: the closure lies in a hollow seat."""
        return self._normal_angles is not None

    def gap(self, x: FloatArray, standoff: float = 0.0) -> FloatArray:
        """Gap along the contact normal [m], exact; nan outside `reach`.

        Parameters
        ----------
        x : ndarray
            [m]
        standoff : float
            How far the closure is lifted off first touch along the axis [m], not negative. The ends of its face then go
            on for as far as that.
        """
        return self._in_front(x, standoff)[0]

    def closure_arc(self, x: FloatArray) -> FloatArray:
        """Arc length on the closure's face of the point in front of x at first touch [m]; nan outside `reach`."""
        return self._in_front(x)[1]

    def seat_arc(self, x: FloatArray) -> FloatArray:
        """Arc length on the seat's face [m], from its inner end."""
        return np.asarray(x) + self._origin

    def _in_front(self, x: FloatArray, standoff: float = 0.0) -> tuple[FloatArray, FloatArray]:
        x = np.asarray(x, dtype=float)
        flat = x.ravel()
        feet = self.point(flat)
        # The closure lifted is the seat lowered.
        feet[1] -= standoff
        gap, arc = self.closure_face.hits(feet, self.normal(flat), standoff)
        return gap.reshape(x.shape), arc.reshape(x.shape)

    def coordinate(self, r: FloatArray, z: FloatArray) -> FloatArray:
        """x of a point (r, z) [m] of either face in first touch: where the contact normal through it leaves the seat.

        Points beside the contact line get the foot of their perpendicular on the seat.
        """
        r, z = np.broadcast_arrays(np.asarray(r, dtype=float), np.asarray(z, dtype=float))
        points = np.stack([r.ravel(), z.ravel()])
        foot = self.seat_face.project(*points)
        if self.seat_face.is_straight:
            return foot.reshape(r.shape) - self._origin
        # Nodes of a chord lie a sag below the face.
        clearance = 1e-3 * self.seat_face.length
        for _ in range(1 if self._normal_angles is None else _ROUNDS):
            normal = self.normal(foot - self._origin)
            hit = self.seat_face.hits(points + clearance * normal, -normal)[1]
            foot = np.where(np.isnan(hit), foot, hit)
        return foot.reshape(r.shape) - self._origin


def _middles(face: Curve) -> Iterator[tuple[float, float]]:
    """Arc lengths between which the middle half of each chamber of a face lies [m]."""
    place = 0.0
    for kind, segments in groupby(face.segments, lambda s: s.name.endswith("_chamber")):
        length = sum(s.length for s in segments)
        if kind:
            yield place + 0.25 * length, place + 0.75 * length
        place += length


def _angles(face: Curve, s: FloatArray) -> FloatArray:
    """Direction of a face at increasing arc lengths [rad], without jumps."""
    t = face.tangent(s)
    return np.unwrap(np.arctan2(t[1], t[0]))


def _normals(angle: FloatArray) -> FloatArray:
    """Unit normals to the left of directions [rad], shape (2, ...)."""
    return np.stack([-np.sin(angle), np.cos(angle)])


def _smaller(a: FloatArray, b: FloatArray) -> FloatArray:
    """Of two turns the smaller one; none if they turn against each other."""
    return np.where(a * b > 0, np.copysign(np.minimum(np.abs(a), np.abs(b)), a), 0.0)


def _sorted_unique(values: FloatArray) -> FloatArray:
    """Finite numbers in increasing order, each once: numpy.unique loads numpy.ma, which takes longer than all its work.

    Parameters
    ----------
    values : ndarray
        Of one dimension.
    """
    numbers = np.sort(values)
    return numbers[np.diff(numbers, prepend=-np.inf) > 0]
