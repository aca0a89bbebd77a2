"""Closure and seat that touch beside the face that their shape is named after: by hand, and what is said of it."""

from __future__ import annotations

import math

import pytest
from places import EXAMPLES

import fem_seal
import meshes
from fem_seal.case.checks import face_remarks
from fem_seal.cli.app import main
from meshes.shapes.shape import named_face

# a drawing is named after no face
CASES = [
    path
    for path in sorted(EXAMPLES.glob("*.toml"))
    if 'shape = "profile"' not in path.read_text(encoding="utf-8")
]
BALL = meshes.Ball(0.02)
E, THETA = 2e-4, math.radians(35)


def cut(turn: float) -> float:
    """How much of a face the rounding of a corner takes that turns by an angle."""
    return E * math.tan(0.5 * turn)


SLOPE, DOWN = cut(THETA) * math.cos(THETA), cut(math.pi / 2 - THETA) * math.cos(THETA)
LAND = meshes.ConicalLand.around(THETA, BALL, land_width=2e-3, edge_radius=E)


@pytest.mark.parametrize(
    ("shape", "inner", "outer"),
    [
        (
            meshes.RoundedCone.of(THETA, inner_radius=0.01, outer_radius=0.02, edge_radius=E),
            0.01 + SLOPE,
            0.02 - DOWN,
        ),
        (LAND, LAND.bore_radius + DOWN, LAND.land_end - SLOPE),
        (meshes.FlatLand.on(0.01, 0.012, BALL, edge_radius=E), 0.01 + E, 0.012 - E),
        (
            meshes.FlatSeat.on(meshes.ToroidalEdge.of(0.015, 3e-3), bore_radius=0.01, edge_radius=E),
            0.01 + E,
            None,
        ),
        (meshes.SharpEdge.around(0.01, BALL, edge_radius=E), 0.01, 0.01 + E),
        (meshes.Disc.of(0.02, edge_radius=E), 0.0, 0.02 - E),
        (meshes.ToroidalEdge.of(0.015, 3e-3, recess=3e-3), 0.012, 0.018),
        (meshes.ToroidalSeat.around(0.015, 3e-3, BALL), 0.012, None),
    ],
    ids=lambda one: type(one).__name__,
)
def test_the_named_face_lies_between_its_roundings(shape, inner, outer) -> None:
    face = named_face(shape)
    assert face.inner == pytest.approx(inner, rel=1e-12, abs=1e-12)
    assert outer is None or face.outer == pytest.approx(outer, rel=1e-12)


def test_a_ball_and_a_cone_without_ends_have_no_other_face() -> None:
    assert named_face(BALL) is None
    assert named_face(meshes.ConicalSeat.around(THETA, BALL)) is None


def case(closure: dict, seat: dict, **load) -> fem_seal.Case:
    return fem_seal.Case(
        closure={"material": "steel", **closure},
        seat={"material": "steel", **seat},
        interface={"law": "smooth"},
        load={"fluid_pressure": "5 bar", **load},
    )


BALL_40 = {"shape": "ball", "radius": "20 mm"}
NEEDLE = {"shape": "cone", "included_angle": "48 deg", "outer_diameter": "8 mm"}
EDGE = {"shape": "sharp-edge", "bore_diameter": "2 mm", "edge_radius": "0.5 mm"}
CONE = {"shape": "cone", "angle": "45 deg"}


@pytest.mark.parametrize(
    ("closure", "seat", "said"),
    [
        # the flat tip is wider than the bore
        ({**NEEDLE, "inner_diameter": "3 mm"}, EDGE, ['closure.shape = "cone"', "inside its conical face"]),
        ({**NEEDLE, "inner_diameter": "1 mm"}, EDGE, []),
        # r0 = R sin(45 deg) = 14.142 mm beside the land, and on it
        (
            BALL_40,
            {"shape": "conical-land", "angle": "45 deg", "land_radius": "15.2 mm", "land_width": "2 mm"},
            None,
        ),
        (
            BALL_40,
            {"shape": "conical-land", "angle": "45 deg", "land_radius": "14.6 mm", "land_width": "2 mm"},
            [],
        ),
        # a ball comes to the inner edge of a land before it comes to the land
        (
            BALL_40,
            {"shape": "flat-land", "land_inner_radius": "10 mm", "land_outer_radius": "12 mm"},
            ['seat.shape = "flat-land"', "inside its land, which begins at r = 10.1 mm"],
        ),
        (BALL_40, {"shape": "flat", "bore_radius": "8 mm"}, ['seat.shape = "flat"', "inside its flat face"]),
        (BALL_40, {"shape": "sharp-edge", "bore_radius": "8 mm", "edge_radius": "1 mm"}, []),
        (
            {"shape": "disc", "radius": "14 mm"},
            CONE,
            ['closure.shape = "disc"', "outside its flat face, which ends"],
        ),
        ({"shape": "torus", "centre_radius": "15 mm", "radius": "3 mm"}, CONE, []),
    ],
)
def test_says_which_face_is_touched_instead(closure, seat, said) -> None:
    told = [str(text) for _, _, text in face_remarks(case(closure, seat))]
    if said is None:
        assert len(told) == 1 and 'seat.shape = "conical-land"' in told[0]
        assert "inside its land" in told[0]
    elif said:
        assert len(told) == 1 and all(one in told[0] for one in said)
    else:
        assert told == []


def test_it_makes_a_run_doubtful_and_stands_in_the_check(tmp_path, capsys) -> None:
    touched = case(
        BALL_40, {"shape": "flat-land", "land_inner_radius": "10 mm", "land_outer_radius": "12 mm"}
    )
    result = fem_seal.run(touched)
    assert any("inside its land" in one for one in result.warnings)
    assert result.loads[0].validity.level == "doubtful"
    assert "gives the shape" in " ".join(result.loads[0].validity.reasons)
    path = tmp_path / "case.toml"
    path.write_text(
        '[closure]\nshape = "cone"\nincluded_angle = "48 deg"\ninner_diameter = "3 mm"\nouter_diameter = "8 mm"\n'
        'material = "316L"\n[seat]\nshape = "sharp-edge"\nbore_diameter = "2 mm"\nedge_radius = "0.5 mm"\n'
        'material = "316L"\n[interface]\nlaw = "smooth"\n[load]\nfluid_pressure = "350 bar"\napplied_force = "800 N"\n'
        'pressure_side = "inner"\n',
        encoding="utf-8",
    )
    assert main(["check", str(path), "-q"]) == 0
    assert 'warning: closure.shape = "cone": the bodies touch first at r = 1.32' in capsys.readouterr().err


@pytest.mark.parametrize(("width", "told"), [("10 mm", True), ("2 mm", False)])
def test_a_land_wider_than_the_face_of_the_plug_is_told(width, told) -> None:
    """A globe valve: the land of its seat and the cone of its plug, which is 6 mm long."""
    angle = {"included_angle": "60 deg"}
    plug = {"shape": "cone", **angle, "inner_diameter": "40 mm", "outer_diameter": "46 mm"}
    land = {"shape": "conical-land", **angle, "land_diameter": "43 mm", "land_width": width}
    found = list(face_remarks(case(plug, land)))
    assert [name for name, _, _ in found] == ["land_beyond_face"] * told
    if told:
        assert "conical face of the closure" in str(found[0][2])
        # it is calculated as it is: nothing is doubtful
        result = fem_seal.run(case(plug, land, applied_force="100 N"))
        reasons = " ".join(result.loads[0].validity.reasons)
        assert "beyond the face" not in reasons and any("up to the edge" in one for one in result.warnings)


def test_a_ball_on_a_wide_land_and_a_disc_on_a_narrow_one_are_not_told() -> None:
    wide = {"shape": "conical-land", "angle": "45 deg", "land_radius": "14.14 mm", "land_width": "6 mm"}
    assert not list(face_remarks(case(BALL_40, wide)))
    ring = {"shape": "flat-land", "land_inner_diameter": "40 mm", "land_outer_diameter": "60 mm"}
    for diameter, told in (("50 mm", 1), ("70 mm", 0)):
        assert len(list(face_remarks(case({"shape": "disc", "diameter": diameter}, ring)))) == told


def faceted(count: int, turned: float) -> dict:
    """A ball of 20 mm whose surface is written as short lines."""
    angles = [math.pi / 2 * (n + turned) / count for n in range(1, count)]
    points = [(0, -20), *((20 * math.sin(a), -20 * math.cos(a)) for a in angles), (20, 0), (20, 10), (0, 10)]
    outline = [{"to": [f"{r!r} mm", f"{z!r} mm"]} for r, z in [*points, points[0]]]
    return {"shape": "profile", "outline": outline, "material": "steel"}


@pytest.mark.slow
def test_a_run_on_a_curve_written_as_short_lines_is_doubtful() -> None:
    result = fem_seal.run(case(faceted(60, 0.5), CONE))
    assert any("polygon" in one for one in result.warnings)
    assert result.loads[0].validity.level == "doubtful"


def test_a_curve_written_as_short_lines_is_told() -> None:
    # a facet right across the contact, as if the ball were turned
    (told,) = face_remarks(case(faceted(60, 0.5), CONE))
    assert told[:2] == ("facets", "closure")
    assert "60 straight lines of about 0.52" in str(told[2])
    # a corner right on the cone cannot be calculated, and no edge radius of the ball would help
    with pytest.raises(fem_seal.InputError, match="60 short lines in a row stand for a curve; draw arcs"):
        case(faceted(60, 0.3), CONE)
    # a seat of three angles is no curve
    three = [(12, 0), (13.6, 1.343), (14.7, 2.443), (16, 3.992), (22, 3.992), (22, -10), (12, -10), (12, 0)]
    outline = [{"to": [f"{r} mm", f"{z} mm"]} for r, z in three]
    assert not list(
        face_remarks(case(BALL_40, {"shape": "profile", "outline": outline, "material": "steel"}))
    )


@pytest.mark.parametrize("path", CASES, ids=lambda one: one.stem)
def test_no_example_is_touched_beside_its_face(path) -> None:
    assert list(face_remarks(fem_seal.load_case(path))) == []
