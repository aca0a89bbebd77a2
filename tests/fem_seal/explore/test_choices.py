"""Choices of the live page: every one of them is a case that can be calculated."""

import pytest

from fem_seal.case.new_case import read_text_case, template
from fem_seal.errors import InputError
from fem_seal.explore.choices import apply_choice, choices_of, pictures_of
from fem_seal.explore.factors import factors_of


@pytest.mark.parametrize("name", ["ball-valve", "needle", "flat-seat", "gasket"])
def test_every_shape_can_take_the_place_of_another(name):
    case = read_text_case(template(name))
    for row, several in pictures_of(case).items():
        for one in several:
            other = apply_choice(case, one.key, "1")
            shape = other.table_of(row if row == "closure" else other.key_of("seat")).shape
            assert (one.key, one.is_chosen) == (f"{row}.{shape}", one.is_chosen)
            assert other.load.fluid_pressure == case.load.fluid_pressure
            assert 0.3 < other.initial_contact_radius / case.initial_contact_radius < 3


def test_choices_say_what_the_case_has_and_change_it():
    case = read_text_case(template("ball-valve"))
    keys = {one.key: one for several in choices_of(case).values() for one in several}
    assert (keys["seat.material"].value, keys["requirement"].value) == ("stellite 6", "ISO 5208 D")
    assert any("1.4301" in one["search"] for one in keys["seat.material"].options)
    changes = {
        "seat.material": "316L",
        "roughness height": "Rz",
        "roughness.process": "ground",
        "requirement": "ISO 5208 A",
        "requirement.leak_rate": "1 ml/min",
        "form.seat.tolerance": "2 um",
        "report.units": "US",
    }
    for key, value in changes.items():
        case = apply_choice(case, key, value)
    assert case.seat.material.name == "316L"
    assert case.written["roughness"]["Rz"] == "0.1 um"
    assert case.requirement.standard_and_class == ("ISO 5208", "A")
    assert case.form.seat.tolerance == pytest.approx(2e-6)
    with pytest.raises(InputError, match="no choice of the page"):
        apply_choice(case, "load.fluid_pressure", "1 bar")
    with pytest.raises(InputError, match="no choice of the page"):
        apply_choice(case, "seat.material", "cheese")


def test_classes_of_the_rated_flow_are_offered_with_the_flow_that_they_need():
    case = read_text_case(template("ball-valve"))
    (offered,) = [one for one in choices_of(case)["demand"] if one.key == "requirement"]
    classes = {f"FCI 70-2 {name}" for name in ("II", "III", "IV")}
    assert classes <= {one["value"] for one in offered.options}
    with pytest.raises(InputError, match="share of the flow through the open valve; give that flow"):
        apply_choice(case, "requirement", "FCI 70-2 III")
    case = apply_choice(apply_choice(case, "requirement", "none"), "requirement.rated_capacity", "40 m^3/h")
    assert case.requirement.standard_and_class == ("FCI 70-2", "IV")
    case = apply_choice(case, "requirement", "FCI 70-2 III")
    assert case.requirement.standard_and_class == ("FCI 70-2", "III")
    assert case.requirement.rated_capacity == pytest.approx(40 / 3600)
    (flow,) = [one for one in choices_of(case)["demand"] if one.key == "requirement.rated_capacity"]
    assert flow.value == "40 m^3/h"


def test_sliders_are_in_the_units_of_the_case_and_its_values_stay():
    case = read_text_case(template("ball-valve"))
    american = apply_choice(case, "report.units", "US")
    factors = factors_of(american)
    texts = factors.base_design
    assert texts["fluid_pressure"] == "362.594 psi"
    assert texts["closure_diameter"] == "1.5748 in"
    assert factors.changes(american, texts) == {}
    assert american.load == case.load
