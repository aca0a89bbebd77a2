"""Bodies given by an outline, a drawing or a mesh."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from meshes import (
    Ball,
    ConicalLand,
    ConicalSeat,
    ContactGeometry,
    Curve,
    GeometryError,
    MeshedBody,
    Outline,
    Profile,
    RoundedCone,
    Segment,
    Sizing,
    ToroidalEdge,
    ToroidalSeat,
    build,
    read_section,
)
from meshes.geometry.biarcs import fit_arcs, through
from meshes.gmsh_session import gmsh_session

MM, DEG = 1e-3, math.pi / 180
BALL = Ball(20 * MM, 12 * MM)
SEAT = ConicalSeat.around(45 * DEG, BALL)
POPPET = RoundedCone(40 * DEG, 9 * MM, 18 * MM, 1 * MM, 20 * MM)


def unnamed(outline: Outline, *, backwards: bool = False) -> Profile:
    """The same outline without any name."""
    pieces = [replace(s, name="") for s in outline.segments]
    if backwards:
        pieces = [Segment(s.end, s.start, "", s.centre) for s in reversed(pieces)]
    return Profile(outline.name, tuple(pieces))


@pytest.mark.parametrize("backwards", [False, True], ids=["counter-clockwise", "clockwise"])
@pytest.mark.parametrize(
    ("closure", "seat"),
    [
        (BALL, SEAT),
        (POPPET, ConicalLand.around(40 * DEG, POPPET, relief_angle=10 * DEG)),
        (ToroidalEdge.of(14 * MM, 3 * MM), ToroidalSeat.around(13 * MM, 4 * MM, Ball(16 * MM))),
    ],
    ids=["ball", "poppet", "torus"],
)
def test_boundaries_and_face_are_found(closure, seat, backwards) -> None:
    known = ContactGeometry.of(closure.outline, seat.outline)
    found = ContactGeometry.of(
        unnamed(closure.outline, backwards=backwards).outline,
        unnamed(seat.outline, backwards=backwards).outline,
    )
    assert found.initial_contact_radius == pytest.approx(known.initial_contact_radius, rel=1e-12)
    assert found.relative_radius == pytest.approx(known.relative_radius, rel=1e-9)
    for a, b in ((found.closure, known.closure), (found.seat, known.seat)):
        assert a.area == pytest.approx(b.area, rel=1e-12)
        for part in ("closure_axis", "closure_cavity", "seat_bottom", "seat_wall"):
            assert length_of(a, part) == pytest.approx(length_of(b, part), rel=1e-12)
    # the ball's own shoulder is where the upper half begins, not at 120 degrees
    assert length_of(found.closure, "closure_top") > 0


def length_of(outline: Outline, part: str) -> float:
    return sum(Curve((s,)).length for s in outline.segments if s.name == part)


def test_the_face_is_the_chain_that_touches_and_not_a_flange_above() -> None:
    """A closure with a collar: its underside looks down as well, but further up."""
    corners = [(0, 0), (5, 0), (8, 3), (8, 10), (20, 10), (20, 14), (0, 14)]
    points = [(r * MM, z * MM) for r, z in corners]
    closure = Profile(
        "closure", tuple(Segment(a, b, "") for a, b in zip(points, [*points[1:], points[0]], strict=True))
    )
    seat = ConicalLand(45 * DEG, 6.5 * MM, 1 * MM, 0.1 * MM, 0.0, 30 * MM, 15 * MM)
    contact = ContactGeometry.of(closure.outline, seat.outline)
    ends = contact.closure_face.point(np.array([0.0, contact.closure_face.length]))[0]
    assert ends == pytest.approx([0.0, 8 * MM], abs=1e-9)
    assert contact.initial_contact_radius == pytest.approx(6.5 * MM, rel=1e-9)
    assert math.isinf(contact.relative_radius)


SQUARE = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]


def polygon(points: list[tuple[float, float]], name: str = "closure", closed: bool = True) -> Profile:
    ends = [*points[1:], points[0]] if closed else points[1:]
    return Profile(name, tuple(Segment(a, b, "") for a, b in zip(points, ends, strict=False)))


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: polygon([*SQUARE[:3], (0.2, 1.0)], closed=False), "is open, 1019.8 mm are missing"),
        (lambda: polygon([(0, 0), (1, 1), (1, 0), (0, 1)]), "crosses itself"),
        (lambda: polygon([(-0.5, 0), (1, 0), (1, 1), (-0.5, 1)]), "crosses the axis"),
        (lambda: polygon([(r + 0.5, z) for r, z in SQUARE]), "straight piece on the axis"),
        (lambda: polygon(SQUARE, "seat"), "needs a bore"),
        (lambda: polygon([(1, 0), (2, 0.3), (1.5, 2)], "seat"), "has no bottom"),
        (lambda: polygon([(0, 0), (1, 0)]), "needs at least 3"),
    ],
)
def test_what_is_no_body_is_refused(make, said) -> None:
    with pytest.raises(GeometryError, match=said):
        make()


def write_dxf(outline: Outline, path: Path, *, sideways: bool = False, layer: str = "0") -> None:
    """Lines and arcs in millimetres; sideways with the axis along x."""
    ezdxf = pytest.importorskip("ezdxf", reason="DXF files need ezdxf")
    drawing = ezdxf.new(units=4)
    space = drawing.modelspace()

    def at(p):
        return (1e3 * p[1], 1e3 * p[0]) if sideways else (1e3 * p[0], 1e3 * p[1])

    for s in outline.segments:
        if s.centre is None:
            space.add_line(at(s.start), at(s.end), dxfattribs={"layer": layer})
            continue
        first, last = (
            math.degrees(math.atan2(at(p)[1] - at(s.centre)[1], at(p)[0] - at(s.centre)[0]))
            for p in (s.start, s.end)
        )
        if (s.sweep < 0) != sideways:
            first, last = last, first
        radius = 1e3 * math.dist(s.start, s.centre)
        space.add_arc(at(s.centre), radius, first, last, dxfattribs={"layer": layer})
    if layer != "0":
        space.add_line((500, 500), (600, 600))
    drawing.saveas(path)


@pytest.mark.usefixtures("read_here")
@pytest.mark.parametrize(("sideways", "layer"), [(False, "0"), (True, "BODY")])
@pytest.mark.parametrize("body", [BALL, SEAT, POPPET], ids=["ball", "cone seat", "poppet"])
def test_dxf_of_a_body_is_the_body(body, sideways, layer, tmp_path) -> None:
    path = tmp_path / "body.dxf"
    write_dxf(body.outline, path, sideways=sideways, layer=layer)
    read = read_section(
        path, body.outline.name, axis="x" if sideways else "y", layer=None if layer == "0" else layer
    )
    assert read.outline.area == pytest.approx(body.outline.area, rel=1e-9)


@pytest.mark.usefixtures("read_here")
def test_dxf_polyline_with_bulges_and_ellipse(tmp_path) -> None:
    ezdxf = pytest.importorskip("ezdxf", reason="DXF files need ezdxf")
    drawing = ezdxf.new(units=4)
    drawing.modelspace().add_lwpolyline(
        [(0, 0, 0), (10, 0, math.tan(math.pi / 8)), (13, 3, 0), (13, 9, 0), (0, 9, 0)],
        format="xyb",
        close=True,
    )
    drawing.saveas(tmp_path / "disc.dxf")
    disc = read_section(tmp_path / "disc.dxf", "closure").outline
    assert disc.area == pytest.approx((13 * 9 - (1 - math.pi / 4) * 9) * MM**2, rel=1e-9)

    drawing = ezdxf.new(units=4)
    space = drawing.modelspace()
    space.add_ellipse((0, 0), (20, 0), 0.75, -math.pi / 2, math.pi / 2)
    space.add_line((0, 15), (0, -15))
    drawing.saveas(tmp_path / "egg.dxf")
    errors, counts = [], []
    for tolerance in (1e-6, 1e-8):
        profile = read_section(tmp_path / "egg.dxf", "closure", tolerance=tolerance)
        errors.append(abs(profile.outline.area / (0.5 * math.pi * 20 * 15 * MM**2) - 1))
        counts.append(len(profile.pieces))
        points = np.array([s.start for s in profile.pieces]) / MM
        assert (points[:, 0] / 20) ** 2 + (points[:, 1] / 15) ** 2 == pytest.approx(
            1.0, abs=2e-3 * tolerance / 1e-6
        )
    # two arcs follow a curve to third order: a hundredth of the error needs 4.6 times the pieces
    assert errors[1] < 0.05 * errors[0] < 1e-5
    assert counts[1] < 6 * counts[0]


@pytest.mark.parametrize("solid", [False, True], ids=["section", "solid"])
def test_step_of_a_body_is_the_body(solid, tmp_path, capfd) -> None:
    path, outline = tmp_path / "poppet.step", POPPET.outline
    with gmsh_session("poppet") as gmsh:
        occ, known = gmsh.model.occ, {}

        def tag(p):
            key = (round(p[0], 12), round(p[1], 12))
            if key not in known:
                known[key] = occ.addPoint(1e3 * p[0], 1e3 * p[1], 0)
            return known[key]

        curves = [
            occ.addLine(tag(s.start), tag(s.end))
            if s.centre is None
            else occ.addCircleArc(tag(s.start), tag(s.centre), tag(s.end))
            for s in outline.segments
        ]
        face = occ.addPlaneSurface([occ.addCurveLoop(curves)])
        if solid:
            occ.revolve([(2, face)], 0, 0, 0, 0, 1, 0, 2 * math.pi)
            occ.remove([(2, face)])
        occ.synchronize()
        gmsh.write(str(path))
    capfd.readouterr()
    assert read_section(path, "closure").outline.area == pytest.approx(outline.area, rel=1e-9)


def test_files_that_hold_no_body_say_so(tmp_path) -> None:
    write_dxf(Outline("closure", POPPET.outline.segments[:-1]), tmp_path / "open.dxf")
    with pytest.raises(GeometryError, match="is open"):
        read_section(tmp_path / "open.dxf", "closure")
    write_dxf(POPPET.outline, tmp_path / "layers.dxf", layer="BODY")
    with pytest.raises(GeometryError, match="layers with drawing are 0, BODY"):
        read_section(tmp_path / "layers.dxf", "closure", layer="SEAT")
    with pytest.raises(GeometryError, match=r"more than one outline|is open"):
        read_section(tmp_path / "layers.dxf", "closure")
    (tmp_path / "text.dxf").write_text("no drawing")
    with pytest.raises(GeometryError, match="cannot be read as DXF"):
        read_section(tmp_path / "text.dxf", "closure")
    (tmp_path / "text.step").write_text("no shape")
    with pytest.raises(GeometryError, match=r"cannot be read as STEP|holds no shapes"):
        read_section(tmp_path / "text.step", "closure")
    (tmp_path / "text.msh").write_text("no mesh")
    with pytest.raises(GeometryError, match="cannot be read as gmsh mesh"):
        MeshedBody.read(tmp_path / "text.msh", "closure")


def test_arcs_through_points_of_a_circle_are_the_circle() -> None:
    angles = np.sort(np.random.default_rng(1).uniform(0.2, 1.4, 20))
    curve = through(20 * MM * np.column_stack([np.sin(angles), -np.cos(angles)]), "face", 40 * DEG)
    assert np.hypot(*curve.point(np.linspace(0, curve.length, 500))) == pytest.approx(20 * MM, rel=1e-12)
    assert len(curve.bends) == 0


def test_fitted_arcs_stay_within_the_tolerance_and_are_smooth() -> None:
    def parabola(t):
        return np.array([t, t**2]), np.array([1.0, 2 * t])

    chain = Curve(tuple(fit_arcs(parabola, -1.0, 2.0, 1e-6)))
    t = np.linspace(-1, 2, 5001)
    p = chain.point(chain.project(t, t**2))
    assert np.hypot(p[0] - t, p[1] - t**2).max() < 1.2e-6
    inner = chain.breaks[1:-1]
    assert chain.tangent(inner - 1e-9) == pytest.approx(chain.tangent(inner + 1e-9), abs=1e-6)


@pytest.fixture(scope="module")
def mesh_file(tmp_path_factory) -> Path:
    sizing = Sizing(40e-6, 0.3 * MM, (-1.2 * MM, 1.2 * MM), 0.1, 0.25, 2.5 * MM)
    return build(BALL, SEAT, sizing).write(tmp_path_factory.mktemp("mesh") / "seal.msh")


@pytest.mark.parametrize("which", ["closure", "seat", "both"])
def test_ready_meshes_keep_their_triangles_and_find_the_contact(mesh_file, which) -> None:
    read = {name: MeshedBody.read(mesh_file, name) for name in ("closure", "seat")}
    closure = read["closure"] if which != "seat" else BALL
    seat = read["seat"] if which != "closure" else SEAT
    contact = ContactGeometry.of(closure.outline, seat.outline)
    assert contact.initial_contact_radius == pytest.approx(20 * MM * math.sin(45 * DEG), rel=1e-9)
    assert contact.relative_radius == pytest.approx(20 * MM, rel=1e-6)
    x = np.linspace(-0.9, 0.9, 11) * MM
    exact = ContactGeometry.of(BALL.outline, SEAT.outline).gap(x)
    assert contact.gap(x) == pytest.approx(exact, abs=1e-13)
    sizing = Sizing(31e-6, 0.1 * MM, (-0.71 * MM, 0.63 * MM), 0.1, 0.25, 2.5 * MM)
    mesh = build(closure, seat, sizing)
    for name in ("closure", "seat"):
        if which in (name, "both"):
            body = getattr(mesh, name)
            assert body.nelements == read[name].outline.mesh.nelements
        ends = contact.coordinate(*getattr(mesh, name).p[:, np.unique(facets_of(mesh, name))])
        # the contact line covers the zone, in whole facets
        assert ends.min() <= -0.71 * MM * (1 - 1e-9)
        assert ends.max() >= 0.63 * MM * (1 - 1e-9)
    assert {"closure_inner", "closure_outer", "seat_inner", "seat_outer"} <= set(mesh.mesh.boundaries)


def facets_of(mesh, name):
    body = getattr(mesh, name)
    return body.facets[:, body.boundaries[f"{name}_contact"]]


def test_mesh_without_a_named_face_is_refused(mesh_file, tmp_path) -> None:
    text = mesh_file.read_text().replace('"seat_contact"', '"somewhere"')
    (tmp_path / "lost.msh").write_text(text)
    with pytest.raises(GeometryError, match='needs a physical group of lines "seat_face"'):
        MeshedBody.read(tmp_path / "lost.msh", "seat")


def test_flanks_between_faces_without_a_name_are_told_by_their_place() -> None:
    """Two lands with a groove between them, of which only the crests and the bottom have names."""
    crests = [(30.0, 0.0), (28.0, 0.0), (26.0, -1.0), (24.0, -1.0), (22.0, 0.0), (20.0, 0.0)]
    names = ["face", "", "chamber", "", "face"]

    def seat(names: list[str]) -> Profile:
        corners = [*crests, (10.0, 0.0), (10.0, -20.0), (40.0, -20.0), (40.0, 0.0)]
        ends = zip(corners, [*corners[1:], corners[0]], [*names, *[""] * 5], strict=True)
        return Profile("seat", tuple(Segment(_mm(a), _mm(b), name) for a, b, name in ends))

    with pytest.raises(GeometryError) as caught:
        ContactGeometry.of(BALL.outline, seat(names).outline)
    for said in ("(28 mm, 0 mm) to (26 mm, -1 mm)", "(24 mm, -1 mm) to (22 mm, 0 mm)", '"face"', '"chamber"'):
        assert said in str(caught.value)
    for name in ("face", "chamber"):
        assert len(seat([one or name for one in names]).outline.face.segments) == 5


def _mm(point: tuple[float, float]) -> tuple[float, float]:
    return MM * point[0], MM * point[1]
