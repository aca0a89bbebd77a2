"""What drawings and meshes hold besides the outline: units, layers, blocks, doubles, planes, damage."""

from __future__ import annotations

import math
import os
import signal
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from meshes import Curve, GeometryError, MeshedBody, Profile, Segment, read_section
from meshes.geometry.biarcs import fit_arcs
from meshes.gmsh_session import gmsh_session

SEAT = [(3.5, 3.5), (11.3, 11.3), (22.0, 11.3), (22.0, -11.5), (3.5, -11.5)]
# Shoelace formula, in square millimetres.
AREA = 0.5 * abs(sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(SEAT, [*SEAT[1:], SEAT[0]], strict=True)))


def draw(space, layer: str = "0", size: float = 1.0) -> None:
    for a, b in zip(SEAT, [*SEAT[1:], SEAT[0]], strict=True):
        space.add_line([size * c for c in a], [size * c for c in b], dxfattribs={"layer": layer})


@pytest.fixture
def drawing(read_here):
    return pytest.importorskip("ezdxf", reason="DXF files need ezdxf").new(units=4)


def area_of(drawing, path: Path, **options) -> float:
    """Area of the seat in a drawing [mm^2]."""
    drawing.saveas(path)
    return 1e6 * read_section(path, "seat", **options).outline.area


@pytest.mark.parametrize(
    ("code", "metres"), [(1, 0.0254), (6, 1.0), (10, 0.9144), (12, 1e-9), (21, 1200 / 3937)]
)
def test_unit_of_a_drawing_is_its_own(code, metres, drawing, tmp_path) -> None:
    drawing.units = code
    draw(drawing.modelspace(), size=1e-3 / metres)
    assert area_of(drawing, tmp_path / "seat.dxf") == pytest.approx(AREA, rel=1e-9)
    assert read_section(tmp_path / "seat.dxf", "seat").file_unit == metres


def test_unit_that_is_not_known_is_asked_for(drawing, tmp_path) -> None:
    drawing.units = 20  # parsecs
    draw(drawing.modelspace())
    with pytest.raises(GeometryError, match=r"does not say its unit \(\$INSUNITS = 20\).* give length_unit"):
        area_of(drawing, tmp_path / "seat.dxf")
    assert area_of(drawing, tmp_path / "seat.dxf", length_unit=1e-3) == pytest.approx(AREA, rel=1e-9)


def test_drawing_without_a_unit_is_told_by_its_size(drawing, tmp_path) -> None:
    """Millimetres or inches: nobody but the user knows."""
    drawing.units = 0
    draw(drawing.modelspace())
    with pytest.raises(
        GeometryError, match=r'is 18\.5 wide and 22\.8 high: give length_unit, such as "mm" or "in"'
    ):
        area_of(drawing, tmp_path / "seat.dxf")
    assert area_of(drawing, tmp_path / "seat.dxf", length_unit=0.0254) == pytest.approx(25.4**2 * AREA)


def rounded_seat(space, millimetres: float, digits: int, turn: float) -> float:
    """A hollow seat that ends in lines, drawn with few digits, and the area that it has without rounding [mm^2]."""
    centre, radius = np.array([-23.3, 51.9]), 60.0
    angles = np.array([-56.3, -38.0]) + turn

    def place(angle: float) -> np.ndarray:
        return centre + radius * np.array([math.cos(math.radians(angle)), math.sin(math.radians(angle))])

    inner, outer = (place(angle) for angle in angles)
    corners = [outer, (40.0, outer[1]), (40.0, -15.0), (inner[0], -15.0), inner]

    def cut(values) -> list[float]:
        return [round(float(one) / millimetres, digits) for one in values]

    for a, b in pairwise(corners):
        space.add_line(cut(a), cut(b))
    space.add_arc(cut(centre), cut([radius])[0], *(round(float(angle), digits) for angle in angles))
    polygon = np.array([*corners, corners[0]])
    shoelace = 0.5 * abs(np.sum(polygon[:-1, 0] * polygon[1:, 1] - polygon[1:, 0] * polygon[:-1, 1]))
    sweep = math.radians(angles[1] - angles[0])
    return shoelace - 0.5 * radius**2 * (sweep - math.sin(sweep))


@pytest.mark.parametrize(("millimetres", "digits"), [(25.4, 3), (25.4, 4), (25.4, 5), (1.0, 2), (1.0, 3)])
def test_ends_that_rounding_has_parted_are_joined(millimetres, digits, tmp_path, read_here) -> None:
    ezdxf = pytest.importorskip("ezdxf", reason="DXF files need ezdxf")
    step, widest = millimetres * 10.0**-digits, 0.0
    for turn in np.random.default_rng(digits).uniform(-3, 3, 12):
        drawing = ezdxf.new(units=1 if millimetres > 1 else 4)
        area = rounded_seat(drawing.modelspace(), millimetres, digits, turn)
        drawing.saveas(tmp_path / "seat.dxf")
        found = read_section(tmp_path / "seat.dxf", "seat")
        # no side of some 20 mm is off by more than the last digit
        assert 1e6 * found.outline.area == pytest.approx(area, abs=100 * step)
        assert 1e3 * found.joined < 3 * step
        assert {s.name for s in found.outline.segments} >= {"seat_bottom", "seat_wall"}
        arc = next(s for s in found.outline.segments if s.centre)
        ends = [math.dist(arc.centre, end) for end in (arc.start, arc.end)]
        assert ends[0] == pytest.approx(ends[1], rel=1e-12)
        assert 1e3 * ends[0] == pytest.approx(60, abs=20 * step)
        widest = max(widest, found.joined)
    assert 1e3 * widest > 0.3 * step


@pytest.mark.parametrize("digits", [3, 4, 5])
def test_gasket_with_few_digits_is_still_its_own_image(digits, tmp_path, read_here) -> None:
    """A whole ring with two bulged faces, at a height that is no round number of inches; half is left."""
    ezdxf = pytest.importorskip("ezdxf", reason="DXF files need ezdxf")
    r, level, half, sagitta = (0.7, 0.9), 0.1234567, 0.0765432, 0.0111111
    radius = (0.01 + sagitta**2) / (2 * sagitta)
    turn = math.degrees(math.asin(0.1 / radius))

    def cut(*values: float) -> list[float]:
        return [round(one, digits) for one in values]

    drawing = ezdxf.new(units=1)
    space = drawing.modelspace()
    for side in r:
        space.add_line(cut(side, level - half), cut(side, level + half))
    for way in (-1, 1):
        centre = cut(0.8, level + way * (half + sagitta - radius))
        space.add_arc(centre, cut(radius)[0], *cut(90 * way - turn, 90 * way + turn))
    drawing.saveas(tmp_path / "ring.dxf")
    found = read_section(tmp_path / "ring.dxf", "gasket").outline
    sweep = 2 * math.radians(turn)
    area = 25.4**2 * (0.2 * half + 0.5 * radius**2 * (sweep - math.sin(sweep)))
    assert 1e6 * found.area == pytest.approx(area, abs=25.4**2 * 2 * 10.0**-digits)
    assert [s.name for s in found.segments].count("seat_bottom") == 1


def test_gap_that_no_rounding_leaves_is_closed_when_asked_for(drawing, tmp_path) -> None:
    """Two lines are drawn on to the corner that both lead to."""
    space = drawing.modelspace()
    # the numbers of a program that does not round
    corners = [(3.5 + 1e-9 / 3, 3.5), *SEAT[1:]]
    for a, b in zip(corners, [*corners[1:], corners[0]], strict=True):
        space.add_line(a, (b[0], b[1] + 0.02) if b == SEAT[3] else b)
    with pytest.raises(GeometryError, match=r"open at .* nearest end is 0\.02 mm away.* larger joint_gap"):
        area_of(drawing, tmp_path / "seat.dxf")
    closed = read_section(tmp_path / "seat.dxf", "seat", joint_gap=3e-5)
    assert 1e6 * closed.outline.area == pytest.approx(AREA, rel=1e-9)
    assert closed.joined == pytest.approx(2e-5)


def test_blocks_give_their_layer_to_what_they_hold_on_layer_0(drawing, tmp_path) -> None:
    inner, outer = drawing.blocks.new("INNER"), drawing.blocks.new("OUTER")
    draw(inner)
    inner.add_line((0, 0), (1, 1), dxfattribs={"layer": "AIDS"})
    outer.add_blockref("INNER", (0, 0))
    drawing.modelspace().add_blockref("OUTER", (0, 0), dxfattribs={"layer": "SEAT"})
    assert area_of(drawing, tmp_path / "seat.dxf", layer="seat") == pytest.approx(AREA, rel=1e-9)
    with pytest.raises(GeometryError, match=r'layer = "BALL": is empty; layers with drawing are AIDS, SEAT$'):
        area_of(drawing, tmp_path / "seat.dxf", layer="BALL")


@pytest.mark.parametrize("hide", ["off", "freeze"])
def test_hidden_layers_are_passed_over_unless_asked_for(hide, drawing, tmp_path) -> None:
    draw(drawing.modelspace())
    getattr(drawing.layers.add("OLD"), hide)()
    draw(drawing.modelspace(), layer="Old", size=0.5)
    assert area_of(drawing, tmp_path / "seat.dxf") == pytest.approx(AREA, rel=1e-9)
    assert area_of(drawing, tmp_path / "seat.dxf", layer="OLD") == pytest.approx(0.25 * AREA, rel=1e-9)
    getattr(drawing.layers.get("0"), hide)()
    with pytest.raises(
        GeometryError, match="all layers are switched off or frozen; layers with drawing are 0, Old"
    ):
        area_of(drawing, tmp_path / "seat.dxf")


def test_block_on_a_hidden_layer(drawing, tmp_path) -> None:
    """As in CAD: frozen it hides all that it holds, switched off only what it holds on layer "0"."""
    block = drawing.blocks.new("BLOCK")
    block.add_line((0, 0), (1, 1))
    draw(block, layer="SEAT")
    layer = drawing.layers.add("PARTS")
    drawing.modelspace().add_blockref("BLOCK", (0, 0), dxfattribs={"layer": "PARTS"})
    layer.off()
    assert area_of(drawing, tmp_path / "seat.dxf") == pytest.approx(AREA, rel=1e-9)
    layer.freeze()
    with pytest.raises(GeometryError, match="all layers are switched off or frozen"):
        area_of(drawing, tmp_path / "seat.dxf")


def test_what_is_drawn_twice_counts_once(drawing, tmp_path) -> None:
    space = drawing.modelspace()
    space.add_arc((0, 0), 10, -90, 90)
    space.add_line((0, 10), (0, -10))
    space.add_line((1e-6, -10), (0, 10))
    space.add_arc((0, 0), 10, 0, 90)
    drawing.saveas(tmp_path / "ball.dxf")
    ball = read_section(tmp_path / "ball.dxf", "closure").outline
    assert 1e6 * ball.area == pytest.approx(50 * math.pi, rel=1e-6)


def test_lens_of_two_arcs_is_no_double(drawing, tmp_path) -> None:
    """A closure between a flat and a round surface with the same ends."""
    space = drawing.modelspace()
    space.add_line((0, 10), (0, 0))
    space.add_arc((0, 10), 10, -90, 0)
    space.add_line((0, 10), (10, 10))
    drawing.saveas(tmp_path / "lens.dxf")
    assert 1e6 * read_section(tmp_path / "lens.dxf", "closure").outline.area == pytest.approx(25 * math.pi)


def pushed_area(profile: Profile) -> float:
    """Area of the top as seen from above."""
    top = [s for s in profile.outline.segments if s.name == "closure_top"]
    return sum(math.pi * (s.start[0] ** 2 - s.end[0] ** 2) for s in top)


def chain(points: list[tuple[float, float]]) -> tuple[Segment, ...]:
    return tuple(Segment(a, b, "") for a, b in zip(points, [*points[1:], points[0]], strict=True))


def test_top_of_many_arcs_or_facets_is_the_whole_upper_side() -> None:
    def egg(t: float):
        return np.array([math.cos(t), 2 * math.sin(t)]), np.array([-math.sin(t), 2 * math.cos(t)])

    pieces = fit_arcs(egg, -0.5 * math.pi, 0.5 * math.pi, 1e-6)
    ends = [(0.0, -2.0), *(s.end for s in pieces[:-1]), (0.0, 2.0)]
    smooth = tuple(Segment(a, b, "", s.centre) for s, a, b in zip(pieces, ends[:-1], ends[1:], strict=True))
    axis = Segment(ends[-1], ends[0], "")
    assert pushed_area(Profile("closure", (*smooth, axis))) == pytest.approx(math.pi, rel=1e-6)
    angles = np.linspace(-0.5 * math.pi, 0.5 * math.pi, 21).tolist()
    ball = chain([(max(math.cos(a), 0.0) if abs(a) < 1.57 else 0.0, math.sin(a)) for a in angles])
    assert pushed_area(Profile("closure", ball)) == pytest.approx(math.pi, rel=1e-12)


@pytest.mark.parametrize("start", range(8))
def test_top_ends_at_a_corner_and_at_a_wall(start) -> None:
    """A stem with a flat end in two pieces and a shallow bevel on a collar that looks upwards too."""
    corners = [(0, 0), (9, 0), (9, 4), (4, 5), (4, 8), (3.5, 8.2), (2, 8.2), (0, 8.2)]
    pieces = chain([(float(r), float(z)) for r, z in corners])
    profile = Profile("closure", (*pieces[start:], *pieces[:start]))
    assert pushed_area(profile) == pytest.approx(math.pi * 4**2, rel=1e-12)


def write_mesh(path: Path, plane: str, *, surface: bool = True, save: str = "seat_face") -> None:
    """The seat in metres, r and z along the two axes of `plane`, with its face as the only named line."""
    with gmsh_session("seat") as gmsh:
        geo = gmsh.model.geo
        where = ["xyz".index(c) for c in plane]
        points = []
        for p in SEAT:
            place = [0.0, 0.0, 0.0]
            place[where[0]], place[where[1]] = 1e-3 * p[0], 1e-3 * p[1]
            points.append(geo.addPoint(*place, 2e-3))
        lines = [geo.addLine(a, b) for a, b in zip(points, [*points[1:], points[0]], strict=True)]
        face = geo.addPlaneSurface([geo.addCurveLoop(lines)])
        geo.synchronize()
        gmsh.model.addPhysicalGroup(1, lines[:1], name=save)
        if surface:
            gmsh.model.addPhysicalGroup(2, [face], name="seat")
        gmsh.option.setNumber("Mesh.MeshSizeFromPoints", 1)
        gmsh.model.mesh.generate(2)
        # as gmsh writes unless told otherwise
        gmsh.option.setNumber("Mesh.MshFileVersion", 4.1)
        gmsh.write(str(path))


@pytest.mark.usefixtures("read_here")
@pytest.mark.parametrize(("plane", "axis"), [("xy", "y"), ("yx", "x"), ("xz", "z"), ("yz", "z"), ("zx", "x")])
def test_mesh_lies_in_a_plane_through_the_axis(plane, axis, tmp_path) -> None:
    write_mesh(tmp_path / "seat.msh", plane)
    seat = MeshedBody.read(tmp_path / "seat.msh", "seat", axis=axis)
    assert 1e6 * seat.outline.area == pytest.approx(AREA, rel=1e-9)
    assert seat.outline.extent == (pytest.approx((3.5e-3, 22e-3)), pytest.approx((-11.5e-3, 11.3e-3)))


@pytest.mark.usefixtures("read_here")
def test_axis_across_the_plane_of_a_mesh_is_refused(tmp_path) -> None:
    write_mesh(tmp_path / "seat.msh", "xy")
    said = r'seat.msh: axis = "z": the section must lie in a plane through this axis, but it reaches 0.022 along x'
    with pytest.raises(GeometryError, match=said):
        MeshedBody.read(tmp_path / "seat.msh", "seat", axis="z")


def test_mesh_with_lines_alone_says_how_gmsh_saves_triangles(tmp_path) -> None:
    write_mesh(tmp_path / "seat.msh", "xy", surface=False)
    with pytest.raises(
        GeometryError, match=r"holds no triangles of the seat but line; gmsh saves physical groups alone"
    ):
        MeshedBody.read(tmp_path / "seat.msh", "seat")


def test_damaged_files_are_refused_without_noise(tmp_path, capfd) -> None:
    write_mesh(tmp_path / "seat.msh", "xy")
    whole = (tmp_path / "seat.msh").read_bytes()
    step = b"ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n#1 = CARTESIAN_P"
    for name, content in (
        ("text.msh", b"no mesh"),
        ("empty.msh", b""),
        ("half.msh", whole[: len(whole) // 2]),
        ("text.step", b"no shape"),
        ("half.step", step),
    ):
        path = tmp_path / name
        path.write_bytes(content)
        read = MeshedBody.read if path.suffix == ".msh" else read_section
        with pytest.raises(GeometryError, match=rf"{name}: cannot be read as (gmsh mesh|STEP) \([^)\d]{{9}}"):
            read(path, "seat")
    out, err = capfd.readouterr()
    assert (out, err) == ("", "")


def test_extent_follows_arcs_beyond_their_ends() -> None:
    """Against dense samples."""
    rng = np.random.default_rng(3)
    for _ in range(50):
        a, b = rng.uniform(-math.pi, math.pi), rng.uniform(-3, 3)
        arc = Segment((math.cos(a), math.sin(a)), (math.cos(a + b), math.sin(a + b)), "", (0.0, 0.0))
        dense = Curve((arc,)).point(np.linspace(0, abs(b), 4001))
        corners = np.array(arc.corners).T
        assert corners.max(axis=1) == pytest.approx(dense.max(axis=1), abs=1e-6)
        assert corners.min(axis=1) == pytest.approx(dense.min(axis=1), abs=1e-6)


@pytest.mark.skipif(not hasattr(signal, "SIGPIPE"), reason="needs signals")
def test_gmsh_leaves_the_process_to_be_told_of_a_broken_pipe():
    """It takes the default of the system, which ends whoever writes to a process that has died."""
    before = signal.getsignal(signal.SIGPIPE)
    with gmsh_session("seat"):
        pass
    assert signal.getsignal(signal.SIGPIPE) == before
    reader, writer = os.pipe()
    os.close(reader)
    with pytest.raises(BrokenPipeError):
        os.write(writer, b"x")
    os.close(writer)
