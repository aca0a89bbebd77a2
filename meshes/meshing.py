"""From outlines and sizes to a mesh."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from types import ModuleType
from typing import TYPE_CHECKING

import numpy as np

from meshes.drawings.meshed_body import MeshedOutline
from meshes.errors import GeometryError, MeshingError, mm
from meshes.geometry.contact_geometry import ContactGeometry
from meshes.geometry.outline import Outline
from meshes.gmsh_session import gmsh_session
from meshes.mesh.seal_mesh import SealMesh, Sizing
from meshes.shapes.shape import Shape

if TYPE_CHECKING:
    from skfem import MeshTri

    from meshes.arrays import FloatArray, IntArray

# The condensed contact is a dense matrix of two nodes per element and two components: a gigabyte at this number.
_MOST_VERTICES = 1600

# Share of a face's length that is no length, nor is what is shorter than half an element.
_END = 1e-5

# Decimals of the coordinates and digits of the sizes that gmsh gets, in units of the seal. A change in the last digit,
# such as other units leave behind, would give another mesh, and a result that differs by what the mesh is worth.
_DIGITS = 11

# gmsh's numbers of these elements.
_LINE, _TRIANGLE = 1, 2


def build(closure: Shape, seat: Shape, sizing: Sizing) -> SealMesh:
    """Mesh a closure in a seat.

    Parameters
    ----------
    closure, seat : Shape
        `Ball`, `ConicalSeat` and the other shapes of this package, or anything with an `outline`.
    sizing : Sizing

    Returns
    -------
    SealMesh
        In the plane of radius and height [m].

    Raises
    ------
    GeometryError
        If closure and seat do not touch properly, or the zone does not fit on their faces.
    MeshingError
        If gmsh cannot be loaded or fails.

    Examples
    --------
    >>> import meshes
    >>> ball = meshes.Ball(0.02)
    >>> cone = meshes.ConicalSeat.around(0.785, ball)
    >>> sizing = meshes.Sizing(2e-5, 1e-4, (-1e-3, 1e-3), 0.2, 0.3, 4e-3)
    >>> mesh = meshes.build(ball, cone, sizing)
    >>> mesh.quality.elements == mesh.mesh.nelements
    True
    """
    return build_contact(ContactGeometry.of(closure.outline, seat.outline), sizing)


def build_contact(contact: ContactGeometry, sizing: Sizing, known: SealMesh | None = None) -> SealMesh:
    """Mesh two sections in first touch, see `build`.

    Parameters
    ----------
    contact : ContactGeometry
        Both sections, also drawn ones or ready meshes.
    sizing : Sizing
    known : SealMesh, optional
        Of another seal, from which a body that is the same and would be meshed the same is taken.

    Returns
    -------
    SealMesh
        In the plane of radius and height [m].

    Raises
    ------
    GeometryError
        If the zone does not fit on the faces.
    MeshingError
        If gmsh cannot be loaded or fails.

    Examples
    --------
    >>> import meshes
    >>> ball = meshes.Ball(0.02)
    >>> cone = meshes.ConicalSeat.around(0.785, ball)
    >>> sizing = meshes.Sizing(2e-5, 1e-4, (-1e-3, 1e-3), 0.2, 0.3, 4e-3)
    >>> contact = meshes.ContactGeometry.of(ball.outline, cone.outline)
    >>> meshes.build_contact(contact, sizing).contact is contact
    True
    """
    _check_zone(contact, sizing)
    if isinstance(contact.seat, MeshedOutline):
        sizing = replace(sizing, zone=contact.seat.widen_zone(contact, sizing.zone))
    x = sizing.contact_vertices(contact.breaks)
    if len(x) > _MOST_VERTICES:
        raise MeshingError(
            f"the contact line would need {len(x) - 1} elements, allowed are {_MOST_VERTICES - 1}: the smallest of "
            f"{min([sizing.contact_size, *(s for _, s in sizing.spots)]) * 1e6:.3g} um is too fine for a zone of "
            f"{(sizing.zone[1] - sizing.zone[0]) * 1e6:.4g} um; use a larger contact size or edge radius"
        )
    # A break of the outline within half an element beyond the contact line would leave a sliver.
    stub = 0.5 * sizing.size(x[[0, -1]])
    outlines = tuple(
        outline if isinstance(outline, MeshedOutline) else _with_contact_line(outline, arc, stub)
        for outline, arc in ((contact.closure, contact.closure_arc(x)), (contact.seat, contact.seat_arc(x)))
    )
    is_alike = known is not None and _graded_alike(contact, sizing, known)
    known_outlines = {o.name: o for o in known.outlines} if known is not None and is_alike else {}
    bodies = {}
    for outline in outlines:
        if isinstance(outline, MeshedOutline):
            mesh = outline.with_contact(contact, sizing.zone)
        elif known_outlines.get(outline.name) == outline:
            mesh = getattr(known, outline.name)
        else:
            mesh = triangulate(outline, contact, sizing)
        bodies[outline.name] = mesh
    return SealMesh(bodies["closure"], bodies["seat"], contact, sizing, outlines)


def _graded_alike(contact: ContactGeometry, sizing: Sizing, mesh: SealMesh) -> bool:
    """Whether gmsh is asked for the same element sizes as in a mesh that is known."""
    measures = [
        (c.closure.largest_radius, c.initial_contact_radius, *c.point(np.array(sizing.zone)).ravel())
        for c in (contact, mesh.contact)
    ]
    return sizing == mesh.sizing and not sizing.spots and measures[0] == measures[1]


def _with_contact_line(outline: Outline, ends: FloatArray, stub: FloatArray) -> Outline:
    """Cut the face at the arc lengths `ends` [m]: inner part, contact line with these vertices, outer part.

    No piece of the inner and of the outer part that meets the contact line is shorter than its `stub` [m].
    """
    face, name = outline.face, outline.name
    # What is left of a face beyond the last ray that meets both bodies is round-off.
    first_end, last_end = np.minimum(_END * face.length, stub)
    ends = np.where(ends < first_end, 0.0, ends)
    ends = np.where(ends > face.length - last_end, face.length, ends)
    pieces = (
        *face.part(0.0, float(ends[0]), f"{name}_inner", (0.0, float(stub[0]))),
        *face.pieces(ends, f"{name}_contact"),
        *face.part(float(ends[-1]), face.length, f"{name}_outer", (float(stub[1]), 0.0)),
    )
    return outline.with_face(pieces)


def _check_zone(contact: ContactGeometry, sizing: Sizing) -> None:
    start, end = contact.reach
    slack = 1e-9 * (end - start)
    if sizing.zone[0] < start - slack or sizing.zone[1] > end + slack:
        r = contact.radius(np.array([*sizing.zone, start, end]))
        raise GeometryError(
            f"the contact zone from r = {mm(r[0])} to {mm(r[1])} does not fit where the faces of "
            f"{contact.closure.label} and {contact.seat.label} stand in front of each other, from r = {mm(r[2])} to "
            f"{mm(r[3])}"
        )


def triangulate(outline: Outline, contact: ContactGeometry, sizing: Sizing) -> MeshTri:
    """Mesh a body with straight triangles, graded from the contact line outwards; the other body changes nothing.

    Parameters
    ----------
    outline : Outline
        Section of the body [m].
    contact : ContactGeometry
        Where the elements are small.
    sizing : Sizing

    Raises
    ------
    MeshingError
        If gmsh fails.
    """
    # gmsh sees the seal in units of this length, so that its absolute tolerances mean the same for every size.
    scale = contact.closure.largest_radius
    with gmsh_session("seal") as gmsh:
        body = _add_body(gmsh, outline, scale)
        _set_sizes(gmsh, outline.name, contact, sizing, scale)
        try:
            gmsh.model.mesh.generate(2)
        except Exception as error:  # gmsh raises plain Exception
            raise MeshingError(f"gmsh could not mesh the {outline.name}: {error}") from error
        return _to_skfem(gmsh, body, scale)


@dataclass(frozen=True)
class _DrawnBody:
    """What gmsh calls a body: its points with their places, the curves of each boundary, the ends of contact pieces."""

    points: Mapping[int, tuple[float, float]]
    curves: Mapping[str, list[int]]
    chords: Mapping[str, list[tuple[int, int]]]


def _add_body(gmsh: ModuleType, outline: Outline, scale: float) -> _DrawnBody:
    """Add a body."""
    geo = gmsh.model.geo
    points: dict[int, tuple[float, float]] = {}

    @cache
    def point(p: tuple[float, float]) -> int:
        tag = int(geo.addPoint(*(round(x / scale, _DIGITS) for x in p), 0.0))
        points[tag] = p
        return tag

    curves: dict[str, list[int]] = {}
    chords: dict[str, list[tuple[int, int]]] = {}
    loop = []
    # A segment ends where the next one starts, also where round-off puts its own end a bit off that point.
    for s, next_s in zip(outline.segments, (*outline.segments[1:], outline.segments[0]), strict=True):
        start, end = point(s.start), point(next_s.start)
        # Pieces of the contact line carry one element each: chords, whatever they are cut from.
        if s.name.endswith("_contact"):
            loop.append(geo.addLine(start, end))
            geo.mesh.setTransfiniteCurve(loop[-1], 2)
            chords.setdefault(s.name, []).append((start, end))
            continue
        if s.centre is None:
            loop.append(geo.addLine(start, end))
        else:
            loop.append(geo.addCircleArc(start, point(s.centre), end))
        curves.setdefault(s.name, []).append(loop[-1])
    geo.addPlaneSurface([geo.addCurveLoop(loop)])
    geo.synchronize()
    return _DrawnBody(points, curves, chords)


def _set_sizes(gmsh: ModuleType, name: str, contact: ContactGeometry, sizing: Sizing, scale: float) -> None:
    """Element size over (r, z) in the body `name` as formulas that gmsh evaluates itself."""
    field, places = gmsh.model.mesh.field, np.array([x for x, _ in sizing.spots])
    # Beside a sharp edge the closure stands many elements away from the seat.
    on_closure = contact.closure_face.point(contact.closure_arc(np.clip(places, *contact.reach)))
    spots = on_closure if name == "closure" else contact.point(places)
    formulas = [
        _size(sizing.contact_size, sizing.core, sizing, *_along_and_deep(contact, sizing.zone, scale), scale),
        *(
            _size(size, 0.0, sizing, "0", f"Sqrt({_square(spot, scale)})", scale)
            for spot, (_, size) in zip(spots.T, sizing.spots, strict=True)
        ),
    ]
    fields = []
    for formula in formulas:
        fields.append(field.add("MathEval"))
        field.setString(fields[-1], "F", f"Min({formula},{sizing.far_size / scale:.{_DIGITS}g})")
    smallest = fields[0]
    if len(fields) > 1:
        smallest = field.add("Min")
        field.setNumbers(smallest, "FieldsList", fields)
    field.setAsBackgroundMesh(smallest)


def _size(size: float, core: float, sizing: Sizing, x_term: str, y_term: str, scale: float) -> str:
    return (
        f"{size / scale:.{_DIGITS}g}+{sizing.growth_along:.{_DIGITS}g}*Max(0,{x_term}-{core / scale:.{_DIGITS}g})"
        f"+{sizing.growth_deep:.{_DIGITS}g}*{y_term}"
    )


def _along_and_deep(contact: ContactGeometry, zone: tuple[float, float], scale: float) -> tuple[str, str]:
    """Distance from first touch along the contact line, and from the line: the circle through its ends and touch."""
    touch = np.array([contact.initial_contact_radius / scale, 0.0])
    ends = contact.point(np.array(zone)).T / scale
    chord = (ends[1] - ends[0]) / math.dist(*ends)
    normal = np.array([-chord[1], chord[0]])
    # Angle between the chords from first touch to both ends, over the radius of the circle through all three points.
    first_chord, second_chord = touch - ends[0], ends[1] - touch
    k = (
        2
        * (first_chord[0] * second_chord[1] - first_chord[1] * second_chord[0])
        / math.prod(math.hypot(*side) for side in (first_chord, second_chord, ends[1] - ends[0]))
    )
    if abs(k) * math.dist(*ends) < 1e-6:
        dr, dz = f"(x-({touch[0]:.{_DIGITS}g}))", "y"
        cos, sin = (f"({c:.{_DIGITS}g})" for c in chord)
        return f"Fabs({dr}*{cos}+{dz}*{sin})", f"Fabs({dz}*{cos}-{dr}*{sin})"
    middle, half = 0.5 * (ends[0] + ends[1]), 0.5 * math.dist(*ends)
    # On the other side of the chord than first touch.
    centre = middle + math.copysign(math.sqrt(max(1 / k**2 - half**2, 0.0)), k) * normal
    normal = (centre - touch) * k
    distance = f"(1e-12+Sqrt((x-({centre[0]:.{_DIGITS}g}))^2+(y-({centre[1]:.{_DIGITS}g}))^2))"
    # The chord between the directions of a point and of first touch, seen from the centre of curvature.
    r, z = (
        f"((({c})-({m:.{_DIGITS}g}))/{distance}-({d:.{_DIGITS}g}))"
        for c, m, d in zip("xy", centre, -np.sign(k) * normal, strict=True)
    )
    return f"{1 / abs(k):.{_DIGITS}g}*Sqrt({r}^2+{z}^2)", f"Fabs({distance}-{1 / abs(k):.{_DIGITS}g})"


def _square(point: FloatArray, scale: float) -> str:
    return f"(x-({point[0] / scale:.{_DIGITS}g}))^2+(y-({point[1] / scale:.{_DIGITS}g}))^2"


def _to_skfem(gmsh: ModuleType, body: _DrawnBody, scale: float) -> MeshTri:
    from meshes.mesh.triangles import Triangles, facets_between, smooth_triangles

    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    # One node on each point, in the order of the points' tags.
    on_points = gmsh.model.mesh.getNodes(0)[0]
    node = np.zeros(max(body.points) + 1, dtype=np.int64)
    node[sorted(body.points)] = on_points
    lines = {name: _connectivity(gmsh, _LINE, curves) for name, curves in body.curves.items()}
    lines |= {name: node[np.array(ends)] for name, ends in body.chords.items()}
    triangles = _connectivity(gmsh, _TRIANGLE, [-1])
    # Nodes that belong to no triangle, such as centres of arcs, are left out.
    corners = np.unique(triangles)
    row, index = np.full((2, int(tags.max()) + 1), -1)
    row[tags], index[corners] = np.arange(len(tags)), np.arange(len(corners))
    places = scale * coordinates.reshape(-1, 3)[:, :2]
    places[row[on_points]] = [body.points[point] for point in sorted(body.points)]
    t = np.ascontiguousarray(index[triangles].T)
    mesh = smooth_triangles(Triangles(np.ascontiguousarray(places[row[corners]].T), t))
    return mesh.with_boundaries(facets_between(mesh, {name: index[pairs] for name, pairs in lines.items()}))


def _connectivity(gmsh: ModuleType, kind: int, entities: list[int]) -> IntArray:
    parts = [gmsh.model.mesh.getElementsByType(kind, tag)[1] for tag in entities]
    return np.concatenate(parts).astype(np.int64).reshape(-1, kind + 1)
