"""Diameters beside radii, the included angle beside the angle: the same case to the last digit in either word."""

from __future__ import annotations

import math
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fem_seal import Case, InputError, Study, load_case, load_study, run
from fem_seal.case.case import input_tables
from fem_seal.case.notation import choices, in_keys, partner, same_entry, tables_of, words_of
from fem_seal.output.case_words import listed_dimensions
from fem_seal.units import parse_quantity

STEEL = {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3}
SHAPES = [
    (body, table)
    for body in ("closure", "seat")
    for table in tables_of(Case.model_fields[body])
    if words_of(table)
]
IDS = [f"{body}-{choices(table, 'shape')[0]}" for body, table in SHAPES]


def tables(seat: dict[str, Any], closure: dict[str, Any] | None = None) -> dict[str, Any]:
    ball = {"shape": "ball", "radius": "20 mm"}
    return {
        "closure": {**(closure or ball), "material": STEEL},
        "seat": {"material": STEEL, **seat},
        "interface": {"law": "exponential", "u0": "2 um", "p_c": "1 GPa"},
        "load": {"fluid_pressure": "20 bar"},
    }


IN_KEYS = {"shape": "cone", "angle": "60 deg", "bore_radius": "12.05 mm", "face_radius": "19 mm"}
IN_WORDS = {
    "shape": "cone",
    "included_angle": "60 deg",
    "bore_diameter": "24.1 mm",
    "face_diameter": "38 mm",
}


def test_every_radius_has_a_diameter_and_every_cone_an_included_angle() -> None:
    for _, table in SHAPES:
        radii = {key for key in table.model_fields if key.endswith("radius")} - {"edge_radius"}
        angles = {"angle"} & set(table.model_fields)
        assert {word.key for word in words_of(table).values()} == radii | angles
        assert all(partner(name) == word.key for name, word in words_of(table).items())


@pytest.mark.parametrize(("body", "table"), SHAPES, ids=IDS)
@settings(max_examples=25, deadline=None)
@given(hundredths=st.integers(2, 39_000), unit=st.sampled_from(["mm", "um", "in", "cm"]))
def test_a_diameter_is_twice_the_radius_to_the_last_digit(body, table, hundredths: int, unit: str) -> None:
    """Decimal texts on both sides: 0.01 of the unit in radius is 0.02 in diameter."""
    if unit == "um":
        hundredths += 1000  # 10 um is the smallest radius
    for word in words_of(table).values():
        if word.marker.dimension == "length":
            texts = (f"{hundredths * share / 100:.2f} {unit}" for share in (1, 2))
            radius, diameter = texts
            found, wrong = in_keys(body, table, {word.name: diameter})
            assert not wrong
            assert parse_quantity(found[word.key], "length") == parse_quantity(radius, "length")
            assert word.of_key(parse_quantity(radius, "length")) == parse_quantity(diameter, "length")


@settings(max_examples=200, deadline=None)
@given(st.integers(1, 8999))
def test_an_included_angle_is_180_degrees_less_twice_the_angle(hundredths: int) -> None:
    """The angle stands between axis and normal, the cone's half-angle between axis and face: together 90 degrees."""
    word = words_of(dict(zip(IDS, (table for _, table in SHAPES), strict=True))["seat-cone"])[
        "included_angle"
    ]
    angle, included = f"{hundredths / 100:.2f} deg", f"{(18_000 - 2 * hundredths) / 100:.2f} deg"
    assert parse_quantity(word.in_key(included), "angle") == parse_quantity(angle, "angle")
    assert word.of_key(parse_quantity(angle, "angle")) == pytest.approx(parse_quantity(included, "angle"))


@pytest.mark.parametrize("included", ["0 deg", "180 deg", "-10 deg", "200 deg", "60"])
def test_impossible_included_angles_are_refused(included: str) -> None:
    with pytest.raises(InputError, match=r"seat.included_angle = "):
        Case(**tables({"shape": "cone", "included_angle": included}))


def test_results_are_the_same_to_the_last_digit() -> None:
    known, found = (Case(**tables(seat)) for seat in (IN_KEYS, IN_WORDS))
    assert input_tables(found) == input_tables(known)
    assert found.contact.angle == pytest.approx(math.radians(60))
    leaks = [run(case).table.drop(columns=["seconds"], errors="ignore") for case in (known, found)]
    assert leaks[0].equals(leaks[1])


def test_wrong_words_are_all_reported_with_what_was_written() -> None:
    with pytest.raises(InputError) as caught:
        load_case(
            tables(
                {"shape": "cone", "angle": "45 deg", "included_angle": "90 deg", "bore_diameter": 24},
                {"shape": "ball", "diameter": "1 um"},
            )
        )
    found = {one.key: str(one) for one in caught.value.problems}
    assert set(found) == {"closure.diameter", "seat.included_angle", "seat.bore_diameter"}
    assert 'angle = "45 deg" is given as well' in found["seat.included_angle"]
    assert "no unit" in found["seat.bore_diameter"]
    assert "from 20 um to 20 m" in found["closure.diameter"]


def test_other_problems_are_reported_beside_wrong_words() -> None:
    with pytest.raises(InputError) as caught:
        Case(**tables({"shape": "cone", "included_angle": "90", "heigth": "20 mm"}))
    assert {one.key for one in caught.value.problems} == {"seat.included_angle", "seat.heigth"}


@pytest.mark.parametrize(
    ("seat", "said"),
    [
        ({"shape": "cone"}, 'add angle = "45 deg" or included_angle = "90 deg"'),
        ({"shape": "sharp-edge"}, 'add bore_radius = "12 mm" or bore_diameter = "40 mm"'),
        ({"shape": "cone", "included_angel": "90 deg"}, "do you mean included_angle?"),
        ({"shape": "cone", "bore_diamter": "9 mm", "angle": "45 deg"}, "do you mean bore_diameter?"),
        ({"shape": "conical-lnd", "angle": "45 deg"}, 'do you mean "conical-land"?'),
    ],
)
def test_messages_know_the_words(seat: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError) as caught:
        Case(**tables(seat))
    assert said in str(caught.value)


def test_an_impossible_dimension_is_reported_in_the_words_of_the_case() -> None:
    seat = {"shape": "flat-land", "land_inner_diameter": "30 mm", "land_outer_diameter": "28 mm"}
    with pytest.raises(InputError) as caught:
        Case(**tables(seat, {"shape": "disc", "diameter": "40 mm"}))
    (one,) = caught.value.problems
    assert (one.key, one.value) == ("seat.land_outer_diameter", '"28 mm"')
    assert "land_outer_radius = 14 mm: must exceed land_inner_radius = 15 mm" in one.message


def lands(*each: dict[str, Any]) -> dict[str, Any]:
    return tables({"shape": "lands", "lands": list(each)}, {"shape": "disc", "diameter": "60 mm"})


def of_flat(inner: str, outer: str) -> dict[str, Any]:
    return {"shape": "flat-land", "land_inner_diameter": inner, "land_outer_diameter": outer}


def test_lands_behind_each_other_have_diameters_too() -> None:
    """They stand in a list of the seat."""
    radii = ("20 mm", "21.5 mm"), ("23 mm", "24.2 mm")
    keys = [
        {"shape": "flat-land", "land_inner_radius": one, "land_outer_radius": other} for one, other in radii
    ]
    words = of_flat("40 mm", "43 mm"), of_flat("46 mm", "48.4 mm")
    known, found = Case(**lands(*keys)), Case(**lands(*words))
    assert input_tables(found) == input_tables(known)
    for case in (known, found):
        wider = case.replace({"seat.lands.1.land_outer_diameter": "50 mm"})
        assert [one.land_outer_radius for one in wider.seat.lands] == [0.0215, 0.025]
        assert case.replace({"seat.lands.1.land_outer_radius": 0.025}).seat == wider.seat


def test_wrong_words_of_lands_name_the_land() -> None:
    twice = of_flat("46 mm", "48 mm") | {"land_inner_radius": "23 mm"}
    with pytest.raises(InputError) as caught:
        Case(**lands(of_flat("40", "43 mm"), twice))
    places = [one.key for one in caught.value.problems]
    assert places == ["seat.lands[1].land_inner_diameter", "seat.lands[2].land_inner_diameter"]


def test_a_typo_in_shape_is_one_line() -> None:
    with pytest.raises(InputError) as caught:
        Case(**tables({"shape": "conical-lnd", "included_angle": "90 deg", "land_widht": "1 mm"}))
    (one,) = caught.value.problems
    assert (one.key, one.value) == ("seat.shape", '"conical-lnd"')


@pytest.mark.parametrize("seat", [IN_KEYS, IN_WORDS], ids=["keys", "words"])
@pytest.mark.parametrize(
    ("change", "key", "value"),
    [
        ({"seat.bore_diameter": "20 mm"}, "bore_radius", 0.01),
        ({"seat.bore_radius": "10 mm"}, "bore_radius", 0.01),
        ({"seat.bore_diameter": 0.02}, "bore_radius", 0.01),
        ({"seat.bore_diameter": None}, "bore_radius", None),
        ({"seat.bore_radius": None}, "bore_radius", None),
        ({"seat.bore_radius": None, "seat.bore_diameter": "20 mm"}, "bore_radius", 0.01),
        ({"seat.bore_diameter": "20 mm", "seat.bore_radius": None}, "bore_radius", 0.01),
        ({"seat.included_angle": math.pi / 2}, "angle", math.pi / 4),
        ({"seat.angle": "45 deg"}, "angle", math.pi / 4),
        ({"seat": {"included_angle": "90 deg"}}, "angle", math.pi / 4),
    ],
)
def test_either_word_replaces_the_other(seat, change, key: str, value: float | None) -> None:
    case = Case(**tables(seat))
    changed = case.replace(**change) if "seat" in change else case.replace(change)
    assert getattr(changed.seat, key) == (value if value is None else pytest.approx(value, rel=1e-15))
    # and nothing else has changed
    others = {name: entry for name, entry in changed.seat if name != key}
    assert others == {name: entry for name, entry in case.seat if name != key}


@pytest.mark.parametrize("change", [{"seat.bore_diameter": "20 mm", "seat.bore_radius": "10 mm"}])
def test_a_change_in_both_words_is_refused(change) -> None:
    with pytest.raises(InputError, match=r"seat.bore_radius: is seat.bore_diameter in other words"):
        Case(**tables(IN_WORDS)).replace(change)
    with pytest.raises(InputError, match=r"is given as well"):
        Case(**tables(IN_WORDS)).replace(seat={"bore_diameter": "20 mm", "bore_radius": "10 mm"})


def test_what_is_listed_uses_the_words_of_the_case() -> None:
    in_keys_, in_words = (listed_dimensions(Case(**tables(seat)), "seat") for seat in (IN_KEYS, IN_WORDS))
    assert in_words["bore_diameter"] == (0.0241, False)
    assert in_keys_["bore_radius"] == (0.01205, False)
    assert in_words["outer_diameter"] == (2 * in_keys_["outer_radius"][0], True)
    for listed in (in_keys_, in_words):
        assert listed["angle"][0] + 0.5 * listed["included_angle"][0] == pytest.approx(math.pi / 2)


def study_of(seat: dict[str, Any], tmp_path, text: str) -> Study:
    lines = [
        '[closure]\nshape = "ball"\nradius = "20 mm"\nmaterial = { youngs_modulus = "210 GPa", poissons_ratio = 0.3 }',
        '[seat]\nmaterial = { youngs_modulus = "210 GPa", poissons_ratio = 0.3 }',
        *(f'{key} = "{value}"' for key, value in seat.items()),
        '[interface]\nlaw = "exponential"\nu0 = "2 um"\np_c = "1 GPa"\n[load]\nfluid_pressure = "20 bar"',
    ]
    (tmp_path / "base.toml").write_text("\n".join(lines))
    path = tmp_path / "study.toml"
    path.write_text('base = "base.toml"\nresponses = ["peak_pressure_Pa"]\n' + text)
    return load_study(path)


@pytest.mark.parametrize("seat", [IN_KEYS, IN_WORDS], ids=["keys", "words"])
def test_a_study_varies_and_changes_either_word(seat, tmp_path) -> None:
    peaks = []
    for text in (
        '[changes]\n"seat.bore_radius" = "10 mm"\n[parameters]\n"seat.angle" = ["45 deg", "60 deg"]\n',
        '[changes]\n"seat.bore_diameter" = "20 mm"\n[parameters]\n"seat.included_angle" = ["90 deg", "60 deg"]\n',
    ):
        study = study_of(seat, tmp_path, text)
        assert study.case.seat.bore_radius == 0.01
        peaks.append([study.case_of(point).seat.angle for point in study.points])
    assert peaks[0] == pytest.approx(peaks[1], rel=4e-16)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (
            '[parameters]\n"seat.bore_radius" = ["9 mm", "10 mm"]\n"seat.bore_diameter" = ["18 mm", "20 mm"]\n',
            "is another name of",
        ),
        (
            '[changes]\n"seat.bore_radius" = "9 mm"\n[parameters]\n"seat.bore_diameter" = ["18 mm", "20 mm"]\n',
            "is a parameter as well",
        ),
        ('[parameters]\n"seat.bore_diametr" = ["18 mm", "20 mm"]\n', "do you mean seat.bore_diameter"),
    ],
)
def test_a_study_refuses_an_entry_in_two_words(text: str, said: str, tmp_path) -> None:
    with pytest.raises(InputError, match=said):
        study_of(IN_WORDS, tmp_path, text)


def test_paths_of_other_tables_have_no_words() -> None:
    assert same_entry("form.seat.diameter") == "form.seat.diameter"
    assert same_entry("seat.bore_diameter") == same_entry("seat.bore_radius")
