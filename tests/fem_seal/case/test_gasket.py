"""The table [gasket]: shapes, flanges that must be alike, and what does not go together with it."""

from __future__ import annotations

import math
from copy import deepcopy
from pathlib import Path
from typing import Any

import pytest

from fem_seal import Case, InputError, load_case
from fem_seal.case import shapes
from fem_seal.case.case import write_case
from fem_seal.case.schema import case_schema
from fem_seal.cli.app import main
from fem_seal.output.case_words import chosen_dimensions, listed_dimensions

STEEL = {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3, "hardness": "3 GPa"}
DISC = {"shape": "disc", "diameter": "60 mm", "material": STEEL}
CONE = {
    "shape": "conical-face",
    "angle": "20 deg",
    "bore_diameter": "30 mm",
    "face_diameter": "64 mm",
    "material": STEEL,
}
RING = {"shape": "ring", "mean_diameter": "40 mm", "section_diameter": "4 mm", "material": STEEL}
GASKETS: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
    "ring": (DISC, RING),
    "lens": (
        CONE,
        {
            "shape": "lens",
            "spherical_radius": "70 mm",
            "inner_diameter": "32 mm",
            "outer_diameter": "60 mm",
            "rim_height": "8 mm",
        },
    ),
    "delta": (
        {"shape": "flat", "bore_diameter": "20 mm", "outer_diameter": "60 mm", "material": STEEL},
        {"shape": "delta", "inner_diameter": "40 mm", "height": "8 mm", "angle": "60 deg"},
    ),
    "double-cone": (
        {**CONE, "angle": "60 deg", "face_diameter": "40 mm"},
        {"shape": "double-cone", "inner_diameter": "28 mm", "outer_diameter": "38 mm", "height": "14 mm"},
    ),
    "profile": (
        {"shape": "flat-land", "land_inner_diameter": "20 mm", "land_outer_diameter": "56 mm"},
        {
            "shape": "profile",
            "outline": [
                {"to": ["18 mm", "-1 mm"]},
                {"to": ["22 mm", "-1 mm"], "radius": "4 mm"},
                {"to": ["22 mm", "1 mm"]},
                {"to": ["18 mm", "1 mm"], "radius": "4 mm"},
                {"to": ["18 mm", "-1 mm"]},
            ],
        },
    ),
}
GASKETS["octagonal"] = (
    {
        "shape": "groove",
        "bore_diameter": "49 mm",
        "groove_mean_diameter": "95.25 mm",
        "groove_width": "11.91 mm",
        "groove_depth": "7.92 mm",
    },
    {
        "shape": "octagonal",
        "mean_diameter": "95.25 mm",
        "width": "11.13 mm",
        "height": "16 mm",
        "flat_width": "7.75 mm",
        "edge_radius": "1.5 mm",
    },
)
GASKETS["delta"][1]["edge_radius"] = "0.5 mm"
GASKETS["double-cone"][1].update(angle="60 deg", rim_height="7 mm", edge_radius="0.2 mm")


def tables(closure: dict[str, Any] = DISC, gasket: dict[str, Any] = RING, **others: Any) -> dict[str, Any]:
    found = {
        "closure": {"material": STEEL, **closure},
        "gasket": {"material": STEEL, **gasket},
        "interface": {"law": "smooth"},
        "load": {"fluid_pressure": "1 bar", "applied_force": "3 kN", "pressure_side": "inner"},
    }
    return deepcopy({**found, **others})


def problems(**others: Any) -> dict[str, str]:
    with pytest.raises(InputError) as error:
        Case(**tables(**others))
    return {one.key: one.message for one in error.value.problems}


def test_every_gasket_has_a_case() -> None:
    assert {*GASKETS} == {one.model_fields["shape"].annotation.__args__[0] for one in shapes.GASKETS} | {
        "profile"
    }


@pytest.mark.parametrize("name", GASKETS)
def test_every_gasket_touches_its_flange(name: str) -> None:
    case = Case(**tables(*GASKETS[name]))
    assert case.faces == 2 and case.seat is None
    low, high = case.contact.seat.extent[0]
    assert low < case.initial_contact_radius < high


def test_dimensions_that_are_left_open_are_those_of_the_body() -> None:
    case = Case(**tables(*GASKETS["double-cone"]))
    assert not chosen_dimensions(case, "seat")
    assert set(chosen_dimensions(case, "closure")) == {"outer_radius", "height"}
    assert listed_dimensions(case, "seat")["outer_diameter"] == (pytest.approx(0.038), False)


def test_a_seat_is_the_lower_flange() -> None:
    same = {"shape": "disc", "radius": "3 cm", "material": STEEL}
    case = Case(**tables(seat=same))
    assert case.contact == Case(**tables()).contact and len(case.parts) == 1
    lower = Case(**tables(seat={**same, "radius": "31 mm"})).parts[-1]
    assert lower.closure.radius == 0.031 and len(lower.parts) == 1
    # a number in SI as in any other table
    moved = Case(**tables(seat={**same, "radius": 0.031})).replace({"seat.radius": 0.032}).parts[-1]
    assert moved.closure.radius == 0.032
    assert "seat.shape" in problems(seat={"shape": "lands", "material": STEEL})
    assert "seat.radius" in problems(seat={"shape": "disc", "material": STEEL})
    assert "seat" in problems(seat={**same, "radius": "10 mm"})


@pytest.mark.parametrize(
    ("others", "key"),
    [
        ({"form": {"closure": {"tolerance": "2 um"}}}, "form"),
        (
            {
                "load": {"fluid_pressure": "1 bar"},
                "bolts": {
                    "number": 4,
                    "size": "M8",
                    "length": "40 mm",
                    "preload": "2 kN",
                    "material": "steel",
                },
            },
            "bolts",
        ),
        (
            {
                "fluid": {"name": "water", "particles": {"iso_4406": "18/16/13"}},
                "roughness": {"closure": "lapped Ra 0.2 um"},
            },
            "fluid.particles",
        ),
    ],
)
def test_what_is_not_calculated_for_different_flanges_is_said(others: dict[str, Any], key: str) -> None:
    found = problems(seat={"shape": "disc", "radius": "31 mm", "material": STEEL}, **others)
    assert "two different flange faces" in found[key]


def test_without_seat_and_gasket_the_seat_is_missing() -> None:
    given = tables()
    del given["gasket"]
    with pytest.raises(InputError, match=r"seat is missing|seat: is missing"):
        Case(**given)


@pytest.mark.parametrize(
    ("others", "key", "words"),
    [
        ({"gasket": {**RING, "mean_diameter": "70 mm"}}, "gasket", "flange and gasket do not meet"),
        ({"gasket": {**RING, "section_diameter": "60 mm"}}, "gasket.section_diameter", "must be below"),
        (
            {"gasket": {key: one for key, one in RING.items() if key != "material"}},
            "gasket.material",
            "missing",
        ),
        ({"gasket": {**RING, "shape": "o-ring"}}, "gasket.shape", 'do you mean "ring"'),
        ({"temperature": {"closure": "80 degC", "seat": "20 degC"}}, "temperature", "uniform"),
        ({"form": {"seat": {"tolerance": "2 um"}}}, "form.seat", "both flange faces"),
        (
            {
                "closure": {
                    "shape": "flat",
                    "bore_diameter": "20 mm",
                    "outer_diameter": "60 mm",
                    "material": STEEL,
                },
                "load": {"fluid_pressure": "1 bar", "applied_force": "3 kN", "closing": "penetration"},
            },
            "load.closing",
            "has a bore",
        ),
        (
            {"roughness": {"seat": "lapped Ra 0.2 um", "gasket": "lapped Ra 0.2 um"}},
            "roughness.seat",
            "give roughness.closure",
        ),
    ],
)
def test_what_cannot_be_is_said_in_a_sentence(others: dict[str, Any], key: str, words: str) -> None:
    given = tables()
    given.update(others)
    with pytest.raises(InputError) as error:
        Case(**given)
    found = {one.key: one.message for one in error.value.problems}
    assert words in found[key]


def test_flange_faces_need_a_gasket() -> None:
    given = tables(GASKETS["delta"][0], seat={"shape": "flat", "bore_radius": "8 mm", "material": STEEL})
    del given["gasket"]
    with pytest.raises(InputError, match=r"\[gasket\]"):
        Case(**given)


def test_a_gasket_is_changed_as_every_other_table() -> None:
    case = Case(**tables())
    assert case.in_diameters("seat")
    thicker = case.replace({"gasket.section_diameter": "5 mm"})
    assert thicker.gasket is not None and thicker.contact.seat.extent[1][1] == 0.0
    assert thicker.contact.relative_radius == pytest.approx(2.5e-3, rel=1e-12)
    assert thicker.replace({"gasket.material": "copper"}).lower.material.name == "copper"
    assert case.replace({"load.applied_force": "4 kN"}).contact is case.contact


def test_finishes_of_flange_and_gasket_add() -> None:
    finish, other = "lapped Ra 0.2 um", "turned Ra 0.8 um"
    fluid = {"name": "helium"}
    each = Case(**tables(roughness={"closure": finish, "gasket": other}, fluid=fluid, interface={}))
    assert each.roughness is not None
    valve = Case(**tables(roughness={"closure": finish, "gasket": finish}, fluid=fluid, interface={}))
    changed = valve.replace({"roughness.gasket": other})
    assert changed.roughness is not None
    assert changed.roughness.build().rms_height == pytest.approx(each.roughness.build().rms_height, rel=1e-12)
    both = Case(**tables(roughness={"Ra": "0.2 um", "process": "lapped"}, fluid=fluid, interface={}))
    assert both.roughness is not None and valve.roughness is not None
    assert both.roughness.build().rms_height == pytest.approx(valve.roughness.build().rms_height, rel=1e-12)


def test_the_schema_wants_a_seat_or_a_gasket() -> None:
    schema = case_schema()
    assert "gasket" in schema["properties"]
    assert {"if": {"not": {"required": ["seat"]}}, "then": {"required": ["gasket"]}} in schema["allOf"]


def test_the_template_is_a_gasket() -> None:
    from fem_seal.case.new_case import read_text_case, template

    case = read_text_case(template("gasket"))
    assert case.gasket is not None and math.isclose(case.contact.relative_radius, 2e-3)


def test_a_gasket_in_a_file(tmp_path) -> None:
    import ezdxf

    drawing = ezdxf.new()
    drawing.header["$INSUNITS"] = 4
    space = drawing.modelspace()
    space.add_circle((20.0, 0.0), 2.0)
    drawing.saveas(tmp_path / "ring.dxf")
    case = load_case(tables(gasket={"shape": "profile", "file": str(tmp_path / "ring.dxf")}))
    own = Case(**tables())
    assert case.contact.seat.area == pytest.approx(own.contact.seat.area, rel=1e-9)
    assert case.initial_contact_radius == pytest.approx(0.02, rel=1e-9)


def groove(half_width: float, depth: float) -> dict[str, Any]:
    """A blind flange with a rectangular groove around 20 mm, its edges rounded by nothing."""
    low, high = 20 - half_width, 20 + half_width
    corners = [(0, 0), (low, 0), (low, depth), (high, depth), (high, 0), (30, 0), (30, 15), (0, 15), (0, 0)]
    return {"shape": "profile", "outline": [{"to": [f"{r} mm", f"{z} mm"]} for r, z in corners]}


def test_a_ring_fits_into_its_groove_or_not() -> None:
    assert Case(**tables(groove(2.5, 1.0))).initial_contact_radius == pytest.approx(0.02)
    assert "the flanges meet" in problems(closure=groove(2.5, 2.5))["gasket"]
    narrow = groove(1.7, 1.0)
    assert "where the face of the flange ends" in problems(closure=narrow)["gasket"]
    narrow["outline"][3]["name"] = "face"
    assert "does not fit" in problems(closure=narrow)["gasket"]


@pytest.mark.parametrize(
    ("body", "others", "words"),
    [
        ("closure", {"groove_depth": "4.5 mm"}, "in a chamber between two lands"),
        ("gasket", {"height": "7 mm"}, "the flanks would meet"),
        ("gasket", {"flat_width": "11.2 mm"}, "must exceed flat_width"),
        ("gasket", {"height": "8.5 mm", "edge_radius": "0.2 mm"}, "the flanges meet"),
        ("closure", {"groove_depth": "15 mm"}, "the flanks meet at 14.0291 mm"),
        ("closure", {"bore_diameter": "84 mm"}, "must exceed bore_radius + half groove_width"),
        ("closure", {"outer_diameter": "104 mm"}, "must exceed the outer edge of the groove"),
        ("closure", {"height": "5 mm"}, "must be higher"),
    ],
)
def test_ring_joints_that_cannot_be(body: str, others: dict[str, Any], words: str) -> None:
    closure, gasket = GASKETS["octagonal"]
    changed = {"closure": closure, "gasket": gasket}
    changed[body] = {"material": STEEL, **changed[body], **others}
    found = problems(
        closure={"material": STEEL, **changed["closure"]}, gasket={"material": STEEL, **changed["gasket"]}
    )
    assert any(words in message for message in found.values()), found


def test_a_gasket_may_be_taken_away_for_a_seat() -> None:
    case = Case(**tables())
    seat = {
        "shape": "flat-land",
        "land_inner_radius": "20 mm",
        "land_outer_radius": "22 mm",
        "material": STEEL,
    }
    valve = case.replace({"gasket": None}, seat=seat)
    assert valve.faces == 1 and valve.gasket is None and valve.lower is valve.seat
    assert Case(**tables(seat=seat) | {"gasket": None}).faces == 1


def test_check_lists_a_lower_flange_where_it_differs(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    lower = {"shape": "disc", "radius": "31 mm", "material": "316L"}
    file = write_case(tables(seat=lower), tmp_path, "case")
    assert main(["check", str(file)]) == 0
    said = capsys.readouterr().out
    assert "  lower flange  316L, radius 31 mm" in said
    assert "; on the lower flange " in said
    file = write_case(tables(), tmp_path, "case")
    assert main(["check", str(file)]) == 0
    assert "lower flange" not in capsys.readouterr().out
