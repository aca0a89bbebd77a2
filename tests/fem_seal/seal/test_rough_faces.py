"""Heat across the faces of a seal: the conductance of its temperature field, and along its contact."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from sample_results import STEEL, ball, case, cone, rough_result

import leak
from fem_seal.case.case import Case
from fem_seal.errors import InputError
from fem_seal.materials import Material
from fem_seal.output.tables import PROFILE_COLUMNS, profile_array
from fem_seal.seal.problem import SealProblem, rough_contact

WARM = {**STEEL, "thermal_conductivity": "40 W/(m K)", "thermal_expansion": "10e-6 1/K"}
POOR = {**WARM, "name": "poor", "thermal_conductivity": "10 W/(m K)"}
TURNED = {
    "process": "turned",
    "feed": "50 um",
    "nose_radius": "0.4 mm",
    "fine": {"rms_height": "0.1 um", "hurst": 0.8, "q_rolloff": "2.5e5 1/m", "q_high": "4e6 1/m"},
}
AROUND = {"top": {"temperature": "60 degC"}, "bottom": {"temperature": "20 degC"}}


def heated(conductance: str = "theory", **tables: Any) -> Case:
    """A rough ball on a cone, heated from above."""
    given = {
        "closure": ball(WARM),
        "seat": cone(POOR),
        "fluid": {"name": "helium"},
        "load": {"fluid_pressure": ["10 bar", "20 bar"]},
        "leak": {"theory": "corrected"},
        **tables,
    }
    return case(**given, temperature={**AROUND, "contact_conductance": conductance})


def test_the_temperature_field_has_the_conductance_of_the_rough_faces() -> None:
    """Mean over Hertz' ellipse at the largest load, gas at the mean of its pressures."""
    given = heated()
    problem = SealProblem.of(given)
    assert problem.at_rest.heating is not None
    around = problem.at_rest.heating.surroundings
    surface, fluid = rough_contact(given), leak.GapFluid.of("helium", problem.at_rest.fluid_temperature)
    half, line_load = around.contact_range[1], 0.02 * 20e5 / 2
    peak = 2 * line_load / (math.pi * half)

    nodes, weights = np.polynomial.legendre.leggauss(30)
    angle = np.pi / 4 * (1 + nodes)
    h = leak.joint_conductance(surface, peak * np.cos(angle), 16.0, fluid, fluid_pressure=101325 + 10e5)
    assert around.conductance == pytest.approx(np.pi / 4 * weights @ (h * np.cos(angle)), rel=0.01)
    # the closure above stays warmer than in a perfect contact
    faces = problem.at_rest.temperatures
    assert 333.15 > faces["closure"] > faces["seat"] > 293.15


def conductance_of(**load: Any) -> float:
    heating = SealProblem.of(heated(load={"pressure_side": "inner", **load})).at_rest.heating
    assert heating is not None and heating.surroundings.conductance is not None
    return heating.surroundings.conductance


def test_after_a_larger_load_each_place_has_carried_its_hertz_pressure() -> None:
    """Of a contact that was wider and pressed harder, both by the root of the force."""
    given = heated(
        load={"fluid_pressure": "1 Pa", "applied_force": "200 N", "largest_earlier_force": "1.8 kN"}
    )
    problem = SealProblem.of(given)
    assert problem.at_rest.heating is not None
    around = problem.at_rest.heating.surroundings
    surface, fluid = rough_contact(given), leak.GapFluid.of("helium", problem.at_rest.fluid_temperature)
    r0, half = given.initial_contact_radius, around.contact_range[1]
    peak = 2 * 200.0 / (2 * math.pi * r0 * math.cos(given.contact.angle)) / (math.pi * half)
    nodes, weights = np.polynomial.legendre.leggauss(30)
    x = half * nodes
    pressure, before = (
        p0 * np.sqrt(1.0 - (x / b) ** 2) for p0, b in ((peak, half), (3.0 * peak, 3.0 * half))
    )
    h = leak.joint_conductance(surface, pressure, 16.0, fluid, fluid_pressure=101325, largest=before)
    assert around.conductance == pytest.approx(0.5 * weights @ h, rel=0.01)


def test_the_gas_is_that_of_the_load_that_presses_most() -> None:
    alone = conductance_of(fluid_pressure="0.1 bar", applied_force="2 kN")
    assert conductance_of(fluid_pressure=["0.1 bar", "5 bar"], applied_force="2 kN") == pytest.approx(alone)
    assert conductance_of(fluid_pressure="5 bar", applied_force="2 kN") > 1.01 * alone


def test_the_conductance_is_that_after_the_largest_load_before() -> None:
    new, loads = conductance_of(fluid_pressure="1 Pa", applied_force="200 N"), ("200 N", "800 N", "3 kN")
    after = [
        conductance_of(fluid_pressure="1 Pa", applied_force="200 N", largest_earlier_force=load)
        for load in loads
    ]
    assert after[0] == pytest.approx(new, rel=1e-5) and after[2] > 1.05 * after[1] > 1.05 * new
    # the load itself conducts more
    assert conductance_of(fluid_pressure="1 Pa", applied_force="3 kN") > after[2]


@pytest.mark.parametrize(
    ("tables", "message"),
    [
        ({"roughness": None, "interface": {"law": "smooth"}, "leak": {}}, r"has no \[roughness\]"),
        ({"fluid": {"name": "diesel"}}, "not known with diesel"),
        ({"fluid": {"viscosity": "3 mPa s"}}, "not known with user-defined"),
        ({"roughness": {"seat": TURNED}}, "of turned faces"),
    ],
)
def test_what_the_theory_needs(tables: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message) as error:
        SealProblem.of(heated(**tables))
    assert error.value.key == "temperature.contact_conductance"


def test_neither_a_number_nor_the_word() -> None:
    with pytest.raises(InputError, match='or write "theory"'):
        heated("theories")


def test_conductance_along_the_contact() -> None:
    """As `leak.joint_conductance` has it at each point; empty where the faces are far apart, or nothing is known."""
    result, column = rough_result(), PROFILE_COLUMNS.index("contact_conductance_W_per_m2_K")
    # the steel of the closure has no conductivity
    assert np.isnan(profile_array(result)[:, column]).all()
    metals = {
        name: Material(name, 210e9, 0.3, thermal_conductivity=k)
        for name, k in (("closure", 40.0), ("seat", 10.0))
    }
    problem = replace(result.problem, materials=metals)
    known: Any = SimpleNamespace(problem=problem, loads=result.loads)
    table = profile_array(known)
    values, p, gap = table[:, column], table[:, 3], table[:, 5]
    touches = np.isfinite(values)
    surface = result.problem.surface
    assert (np.asarray(surface.mean_separation(p[touches])) <= 1.0001 * surface.touch_distance).all()
    assert (np.asarray(surface.mean_separation(p[~touches])) >= 0.9999 * surface.touch_distance).all()
    water = leak.GapFluid.of("water", 293.15)
    some = np.flatnonzero(touches)[::60]
    expected = [
        float(leak.joint_conductance(surface, p[n], 16.0, water, fluid_pressure=gap[n])) for n in some
    ]
    assert values[some] == pytest.approx(expected, rel=0.01)
    # another fluid of which nothing is known
    assert replace(problem, at_rest=replace(problem.at_rest, fluid_temperature=None)).joint is None
