"""Temperature: thermal strain of the bodies, materials over temperature, the fluid between them."""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from contact_models import displacement_basis
from hypothesis import given, settings
from hypothesis import strategies as st
from sample_results import case, cone, run_loads, smooth_case
from skfem import Basis, ElementTriP2, MeshTri, condense, solve

import fem_seal
import leak
import meshes
from fem_seal.bodies.elasticity import (
    StressRecovery,
    at_quadrature_points,
    node_dofs,
    quadratic_nodes,
    stiffness_matrix,
    thermal_load,
    without_free_strain,
)
from fem_seal.case.case import Case
from fem_seal.case.material_table import LIBRARY
from fem_seal.contact.conduction import Face, Surroundings, conduct
from fem_seal.contact.load_path import load_path
from fem_seal.contact.model import BodyLoads, ContactModel, line_points
from fem_seal.contact.plastic_step import PathLoad
from fem_seal.contact.solution import fields_at_rest
from fem_seal.errors import InputError
from fem_seal.materials import HardeningCurve, Material, OverTemperature
from fem_seal.seal.findings import Level
from fem_seal.seal.heating import Heating
from fem_seal.seal.load_solver import LoadSolver, solve_load
from fem_seal.seal.problem import SealProblem, condense_bodies, size_mesh
from fem_seal.studies.responses import evaluate_design
from fem_seal.validity.fluid import film_cautions
from fem_seal.validity.materials import material_cautions

STEEL = Material("steel", 210e9, 0.3, thermal_expansion=11e-6)
STEADY = {
    "name": "1.4122",
    "youngs_modulus": "210 GPa",
    "poissons_ratio": 0.3,
    "thermal_expansion": "10e-6 1/K",
}
GROWING = {**STEADY, "name": "316L", "thermal_expansion": "16e-6 1/K"}
INNER, OUTER, HEIGHT = 0.01, 0.02, 0.005


def heated(closure: object = STEADY, seat: object = STEADY, /, **tables: Any) -> Case:
    """A smooth ball of one material on a cone of another."""
    return smooth_case(
        closure={"shape": "ball", "radius": "20 mm", "material": closure},
        seat=cone(seat, **tables.pop("seat", {})),
        **{"load": {"fluid_pressure": "20 bar"}, **tables},
    )


def contact_of(given: Case) -> Any:
    """Its only load, solved on the mesh that is made for it."""
    problem = SealProblem.of(given)
    model = condense_bodies(problem, meshes.build_contact(problem.contact, size_mesh(problem)))
    return solve_load(LoadSolver(problem, model), 0)


# ---------------------------------------------------------------- bodies


def ring(refine: int, at: float = 0.0145) -> MeshTri:
    """Rectangle in the (r, z) half-plane, unequal elements, with a line of nodes at a radius."""
    r = np.array([INNER, at, OUTER])
    mesh = MeshTri.init_tensor(r, np.linspace(0, HEIGHT, 2)).refined(refine)
    return mesh.with_boundaries({"ends": lambda x: np.isclose(x[1], 0) | np.isclose(x[1], HEIGHT)})


def thermal_ring(basis: Basis, strain: np.ndarray) -> np.ndarray:
    """Displacement of a ring with free strains at the quadrature points, between smooth rigid plates."""
    held = basis.get_dofs("ends").all(["u^2"])
    return solve(
        *condense(stiffness_matrix(basis.mesh, STEEL), thermal_load(basis.mesh, STEEL, strain), D=held)
    )


def in_plane_strain(r: np.ndarray, integral: Any) -> np.ndarray:
    """Radial displacement of a thick cylinder with a free strain e(r), no axial strain, free surfaces.

    (1 - nu)/(1 + nu) u = I(r)/r + ((1 - 2 nu) r + a^2/r) I(b)/(b^2 - a^2), I(r) = int_a^r e r dr
    (Timoshenko & Goodier, Theory of Elasticity, 3rd ed., art. 151).
    """
    nu, a, b = STEEL.poissons_ratio, INNER, OUTER
    whole = integral(np.array(b)) / (b**2 - a**2)
    return (1 + nu) / (1 - nu) * (integral(r) / r + ((1 - 2 * nu) * r + a**2 / r) * whole)


# Temperature between two held surfaces of a cylinder: logarithmic in r.
def log_strain(r: np.ndarray) -> np.ndarray:
    return 2e-3 * np.log(OUTER / r) / np.log(OUTER / INNER)


def log_integral(r: np.ndarray) -> np.ndarray:
    def primitive(x: Any) -> Any:
        return x**2 / 2 * (np.log(OUTER / x) + 0.5)

    return 2e-3 / np.log(OUTER / INNER) * (primitive(r) - primitive(INNER))


def test_a_thick_cylinder_with_a_radial_gradient_converges_with_third_order() -> None:
    errors = []
    for refine in (0, 1, 2, 3):
        basis = displacement_basis(ring(refine))
        r = quadratic_nodes(basis.mesh)[0][:, 0]
        # as it comes from a conduction solve: a quadratic field over the same nodes
        u = thermal_ring(basis, at_quadrature_points(basis.mesh, log_strain(r)))
        at = np.asarray(basis.global_coordinates())[0]
        error = np.asarray(basis.interpolate(u))[0] - in_plane_strain(at, log_integral)
        errors.append(np.sqrt(np.sum(error**2 * basis.dx)))
    rates = np.diff(np.log(errors)) / np.log(0.5)
    assert rates[-1] == pytest.approx(3.0, abs=0.25)  # as of any load: third order in L2


def test_thermal_stress_of_a_thick_cylinder() -> None:
    basis = displacement_basis(ring(4))
    r = quadratic_nodes(basis.mesh)[0][:, 0]
    strain = log_strain(r)
    u = thermal_ring(basis, at_quadrature_points(basis.mesh, strain))
    stress = without_free_strain(StressRecovery(basis.mesh, STEEL).stress(u), STEEL, strain)
    E, nu, whole = STEEL.youngs_modulus, STEEL.poissons_ratio, log_integral(OUTER) / (OUTER**2 - INNER**2)
    inside = log_integral(r) / r**2
    radial = E / (1 - nu) * ((1 - INNER**2 / r**2) * whole - inside)
    hoop = E / (1 - nu) * ((1 + INNER**2 / r**2) * whole + inside - strain)
    axial = nu * (radial + hoop) - E * strain
    scale = np.abs(hoop).max()
    # second order in elements of a thirtieth of the wall
    assert stress[:, 0] == pytest.approx(radial, abs=3e-3 * scale)
    assert stress[:, 1] == pytest.approx(axial, abs=3e-3 * scale)
    assert stress[:, 2] == pytest.approx(hoop, abs=3e-3 * scale)


def test_a_ring_of_two_metals() -> None:
    """Two rings, shrunk into each other by what the inner one grows more: the strain jumps at 14.5 mm."""
    at, inner, outer = 0.0145, 1.6e-3, 1.1e-3

    def integral(r: Any) -> Any:
        return inner * (np.minimum(r, at) ** 2 - INNER**2) / 2 + outer * (np.maximum(r, at) ** 2 - at**2) / 2

    basis = displacement_basis(ring(4, at))
    radius = np.asarray(basis.global_coordinates())[0]
    u = thermal_ring(basis, np.where(radius < at, inner, outer))
    r = quadratic_nodes(basis.mesh)[0][:, 0]
    exact = in_plane_strain(r, integral)
    assert u[node_dofs(basis.mesh)[0]] == pytest.approx(exact, abs=2e-6 * exact.max())


def model_of(supports: fem_seal.Supports | None = None, wide: bool = False) -> ContactModel:
    ball = meshes.Ball(0.02)
    seat = meshes.SphericalSeat.around(0.785, ball) if wide else meshes.ConicalSeat.around(0.785, ball)
    sizing = meshes.Sizing(2e-5, 1e-4, (-1e-3, 1e-3), 0.2, 0.3, 4e-3)
    return fem_seal.condense(meshes.build(ball, seat, sizing), {"closure": STEEL, "seat": STEEL}, supports)


def grown(body: Any, strain: float) -> np.ndarray:
    """Displacement of a condensed body with a uniform free strain, by its stiffness."""
    held = body.fem
    load = thermal_load(held.mesh, held.material, np.full((1, 1), strain))
    return held.remove_rigid_motion(body.solve(held.balance_forces(load)))


def test_the_column_of_the_closure_is_its_free_expansion() -> None:
    model = model_of()
    column = model.closure.loads["expansion"]
    by_stiffness = grown(model.closure, 1.0)
    # the solver's round-off
    assert column.response == pytest.approx(by_stiffness, abs=1e-8 * np.abs(by_stiffness).max())
    loads = BodyLoads(closure={"expansion": 2e-3})
    stress = fields_at_rest(model, loads)["closure"].stress
    assert np.abs(stress).max() < 1e-9 * 2e-3 * STEEL.youngs_modulus


def test_a_seal_that_grows_evenly_only_changes_its_scale() -> None:
    """Both bodies together open the gap by strain times gap and a rigid motion: nothing but another scale."""
    model, strain = model_of(), 2e-3
    both = sum(
        body.fem.trace @ body.fem.normal_displacement(grown(body, strain))
        for body in (model.closure, model.seat)
    )
    way = model.line.normal[1]
    scaled = strain * model.line.initial_gap
    rigid = float(way @ (both - scaled) / (way @ way))
    # chords instead of arcs
    sagitta = np.diff(model.line.vertices).max() ** 2 / (8 * 0.02)
    assert both == pytest.approx(scaled + rigid * way, abs=strain * sagitta)
    # which is what is left out: counted from the seat there is no motion at all
    even = SealProblem.of(heated(temperature={"uniform": "200 degC"}))
    assert even.at_rest.body_loads(model).opening(model) == pytest.approx(0.0)


# ---------------------------------------------------------------- the seal


@settings(max_examples=25, deadline=None)
@given(st.floats(60, 900), st.floats(60, 900))
def test_equal_expansion_and_uniform_temperature_load_nothing(warm: float, reference: float) -> None:
    for materials in ((STEADY, STEADY), (STEADY, {**STEADY, "name": "another", "youngs_modulus": "100 GPa"})):
        given = {"uniform": f"{warm!r} K", "reference": f"{reference!r} K"}
        try:
            problem = SealProblem.of(heated(*materials, temperature=given))
        except InputError as error:
            assert "would grow by" in str(error)  # over 2 %
            continue
        assert problem.at_rest.expansion == 0.0 and problem.at_rest.interference == 0.0


def test_only_the_fluid_notices_a_uniform_temperature() -> None:
    rough = {"load": {"fluid_pressure": "20 bar"}}
    cold, hot = (
        run_loads(
            case(
                closure={"shape": "ball", "radius": "20 mm", "material": {**STEADY, "hardness": "3.5 GPa"}},
                seat=cone({**STEADY, "hardness": "3.5 GPa"}),
                **rough,
                **heat,
            )
        )
        for heat in ({}, {"temperature": {"uniform": "80 degC"}})
    )
    before, after = cold.loads[0], hot.loads[0]
    assert after.contact.pressure == pytest.approx(before.contact.pressure, rel=1e-14)
    # water of 80 degC is thinner, and that is all: by its viscosity under the pressures in the gap ...
    ratio = after.leak.leak_rate / before.leak.leak_rate
    assert ratio == pytest.approx(before.effective_viscosity / after.effective_viscosity, rel=1e-9)
    # ... which 20 bar change by some tenths of a per cent
    thinner = leak.liquid("water", 293.15).viscosity / leak.liquid("water", 353.15).viscosity
    assert ratio == pytest.approx(thinner, rel=3e-3)
    assert hot.table["contact_temperature_K"].tolist() == [353.15]
    assert "contact_temperature_K" not in cold.table


def test_a_grown_ball_is_a_larger_ball() -> None:
    """What the displacement leaves out is a change of the geometry by the strain itself, 2 per mille here."""
    strain = 16e-6 * 120
    hot = contact_of(heated(GROWING, STEADY, temperature={"closure": "140 degC", "seat": "20 degC"}))
    cold = contact_of(heated(GROWING, STEADY))
    drawn = contact_of(
        smooth_case(
            closure={"shape": "ball", "radius": f"{20 * (1 + strain)!r} mm", "material": GROWING},
            seat=cone(STEADY, bore_radius="12 mm"),
            load={"fluid_pressure": "20 bar", "applied_force": "0 N"},
        )
    )
    assert hot.profile.peak_pressure == pytest.approx(cold.profile.peak_pressure, rel=strain)
    # the larger one touches at a larger radius: fluid force r^2, line load r, Hertz sqrt(r/R): all within one strain
    assert hot.profile.peak_pressure == pytest.approx(drawn.profile.peak_pressure, rel=2 * strain)
    # and stands higher: its centre by e R/cos(45 deg), its loaded top by about e R more
    stands = strain * (0.02 / math.cos(math.radians(45)) + 0.02)
    assert cold.approach - hot.approach == pytest.approx(stands, rel=0.5)


def test_a_shrink_fit_by_temperature_is_the_same_interference() -> None:
    held = {"wall": "fixed", "outer_radius": "25 mm"}
    hot = heated(seat=held, temperature={"uniform": "120 degC", "housing_expansion": "4e-6 1/K"})
    fitted = heated(seat={**held, "interference": "15 um"})  # (10 - 4) 1e-6 times 100 K on 25 mm
    assert SealProblem.of(hot).at_rest.interference == pytest.approx(15e-6, rel=1e-12)
    hot_contact, fitted_contact = contact_of(hot), contact_of(fitted)
    assert hot_contact.pressure == pytest.approx(fitted_contact.pressure, rel=1e-9)
    for name in ("closure", "seat"):
        scale = np.abs(fitted_contact.fields["seat"].stress).max()
        assert hot_contact.fields[name].stress == pytest.approx(
            fitted_contact.fields[name].stress, abs=1e-9 * scale
        )


def test_a_ring_in_a_colder_bore_is_that_of_lame() -> None:
    bore, outer, strain = 0.01, 0.03, 10e-6 * 100
    face = meshes.chain([(bore, 0.0), (0.9 * outer, 0.0)], "seat_face")
    contact = meshes.ContactGeometry.of(
        meshes.ToroidalEdge.of(0.018, 0.004).outline, meshes.housing(face, outer, 0.02)
    )
    mesh = meshes.build_contact(contact, meshes.Sizing(1e-4, 3e-4, (-1e-3, 1e-3), 0.2, 0.4, 1e-3))
    model = fem_seal.condense(mesh, {"closure": STEEL, "seat": STEEL}, fem_seal.Supports(wall="fixed"))
    seat = model.seat
    # the whole ring wants to grow, and its wall cannot: by the stiffness of the held ring ...
    stress = without_free_strain(seat.recovery.stress(grown(seat, strain)), STEEL, strain)
    # ... by the interference that is calculated with ...
    fitted = fields_at_rest(model, BodyLoads.press_fit(strain * outer))["seat"]
    scale = np.abs(fitted.stress).max()
    assert stress == pytest.approx(fitted.stress, abs=1e-7 * scale)
    # ... and by Lame: hoop stress at the bore 2 E/(1 - nu) A, u = A (r + B/r) = -e b at the wall
    nu, E = STEEL.poissons_ratio, STEEL.youngs_modulus
    A = -strain * outer / (outer + bore**2 * (1 + nu) / (1 - nu) / outer)
    at_bore = fitted.points[:, 0] < bore * (1 + 1e-9)
    # second order in elements of 1 mm at a bore of 10 mm
    assert stress[at_bore, 2] == pytest.approx(2 * E / (1 - nu) * A, rel=1e-2)


CURVE = {"plastic_strain": [0, 0.1], "stress": ["20 GPa", "25 GPa"]}


def test_a_body_that_does_not_reach_its_yield_stress_is_elastic_when_heated() -> None:
    held = {"wall": "fixed", "outer_radius": "25 mm"}
    heat = {"closure": "200 degC", "seat": "120 degC", "housing": "60 degC"}
    hard = {**STEADY, "stress_strain": CURVE}
    sized = {"mesh": {"contact_size": "20 um"}}
    elastic = contact_of(heated(GROWING, STEADY, seat=held, temperature=heat, **sized))
    yielding = contact_of(
        heated({**GROWING, "stress_strain": CURVE}, hard, seat=held, temperature=heat, **sized)
    )
    # the tolerance of the forces in the bodies, 1e-9 of the largest
    peak = elastic.profile.peak_pressure
    assert yielding.pressure == pytest.approx(elastic.pressure, abs=1e-6 * peak)
    for name in ("closure", "seat"):
        scale = np.abs(elastic.fields["seat"].von_mises).max()
        assert yielding.fields[name].temperature == pytest.approx(elastic.fields[name].temperature)
        # one is the mean over quadrature points, the other that of the nodes
        assert (
            np.median(np.abs(yielding.fields[name].von_mises - elastic.fields[name].von_mises)) < 1e-2 * scale
        )


def test_fluid_between_the_surfaces_is_solved_with_the_heat() -> None:
    held = {"wall": "fixed", "outer_radius": "25 mm"}
    load = {"fluid_pressure": "20 bar", "closing": "penetration", "applied_force": "2 kN"}
    hot = heated(seat=held, load=load, temperature={"uniform": "120 degC", "housing_expansion": "4e-6 1/K"})
    fitted = heated(seat={**held, "interference": "15 um"}, load=load)
    assert contact_of(hot).pressure == pytest.approx(contact_of(fitted).pressure, rel=1e-6, abs=1e3)


# ---------------------------------------------------------------- materials and case


def test_numbers_of_a_material_over_temperature() -> None:
    over = {
        **STEADY,
        "youngs_modulus": {"temperature": ["20 degC", "220 degC"], "value": ["210 GPa", "190 GPa"]},
        "poissons_ratio": {"temperature": ["0 degC", "400 degC"], "value": [0.29, 0.31]},
        "thermal_expansion": {"temperature": ["100 degC", "300 degC"], "value": ["10e-6 1/K", "12e-6 1/K"]},
    }
    hot = heated(over, STEADY, temperature={"closure": "120 degC", "seat": "60 degC"})
    material = hot.closure.material
    assert material.youngs_modulus == pytest.approx(200e9) and material.poissons_ratio == pytest.approx(0.296)
    plain = {
        "name": "plain",
        "youngs_modulus": "200 GPa",
        "poissons_ratio": 0.296,
        "thermal_expansion": "10.2e-6 1/K",
    }
    same = heated(plain, STEADY, temperature={"closure": "120 degC", "seat": "60 degC"})
    assert SealProblem.of(hot).at_rest.expansion == pytest.approx(10.2e-6 * 100 - 10e-6 * 40, rel=1e-12)
    assert contact_of(hot).pressure == pytest.approx(contact_of(same).pressure, rel=1e-9)
    # another temperature of the same case takes other numbers; at 20 degC nobody asks for the expansion
    assert hot.replace({"temperature.closure": "170 degC"}).closure.material.youngs_modulus == pytest.approx(
        195e9
    )
    assert hot.replace({"temperature": None}).closure.material.youngs_modulus == pytest.approx(210e9)
    for beyond, key in (("320 degC", "youngs_modulus"), ("60 degC", "thermal_expansion")):
        with pytest.raises(InputError, match=r"is known from .* and asked for at") as error:
            hot.replace({"temperature.closure": beyond})
        assert error.value.key == f"closure.material.{key}"


@given(st.lists(st.floats(100, 1000), min_size=1, max_size=6, unique=True), st.floats(0, 1))
def test_a_table_over_temperature_goes_through_its_points_and_not_beyond(
    at: list[float], share: float
) -> None:
    temperature = tuple(sorted(at))
    value = tuple(np.cos(np.arange(len(at))).tolist())
    table = OverTemperature("hardness", temperature, value)
    assert [table.at(T) for T in temperature] == pytest.approx(list(value))
    inside = temperature[0] + share * (temperature[-1] - temperature[0])
    assert min(value) - 1e-12 <= table.at(inside) <= max(value) + 1e-12
    for beyond in (temperature[0] - 0.1, temperature[-1] + 0.1):
        with pytest.raises(InputError, match="extend the table"):
            table.at(beyond)


def test_expansion_counts_from_twenty_degrees() -> None:
    table = OverTemperature("thermal_expansion", (93.15, 293.15, 593.15), (8e-6, 10e-6, 13e-6))
    material = Material("m", 2e11, 0.3, thermal_expansion=10e-6, over_temperature=(table,))
    # means from 20 degC, as data sheets have them: between two other temperatures their difference
    assert material.thermal_strain(593.15, 93.15) == pytest.approx(13e-6 * 300 + 8e-6 * 200, rel=1e-12)
    assert material.thermal_strain(593.15, 593.15) == 0.0


def test_a_linear_coefficient_is_integrated_between_temperatures() -> None:
    # alpha(T) = a + b (T - 20 degC), whose mean from 20 degC to T is a + b/2 (T - 20 degC): a table of two rows
    a, b, room = 10e-6, 8e-9, 293.15
    ends = (293.15, 693.15)
    table = OverTemperature("thermal_expansion", ends, tuple(a + b / 2 * (T - room) for T in ends))
    material = Material("m", 2e11, 0.3, thermal_expansion=a, over_temperature=(table,))

    def integral(low: float, high: float) -> float:
        return a * (high - low) + b / 2 * ((high - room) ** 2 - (low - room) ** 2)

    for low, high in ((293.15, 473.15), (373.15, 673.15), (600.0, 350.0)):
        assert material.thermal_strain(high, low) == pytest.approx(integral(low, high), rel=1e-12)
    field = np.array([300.0, 450.0, 690.0])
    assert material.thermal_strain(field, 400.0) == pytest.approx(integral(400.0, field), rel=1e-12)


# ---------------------------------------------------------------- hot numbers of the library


def hot(
    closure: Any = "316L", seat: Any = "316L", temperature: Any = "200 degC", **more: Any
) -> fem_seal.Case:
    heat = {"uniform": temperature} if isinstance(temperature, str) else temperature
    tables = {"fluid": {"name": "nitrogen"}, "load": {"fluid_pressure": "10 bar"}, **more}
    return case(
        closure={"shape": "ball", "radius": "10 mm", "material": closure},
        seat=cone(seat),
        temperature=heat,
        **tables,
    )


def said_of(one: fem_seal.Case) -> dict[str, tuple[Level, str]]:
    return {
        f"{caution.kind}, {caution.reason().split(':')[0]}": (caution.level, caution.text())
        for caution in material_cautions(SealProblem.of(one))
    }


@pytest.mark.parametrize(
    ("fluid", "level"),
    [
        ({"temperature": "20 degC"}, Level.DOUBTFUL),
        ({"temperature": "150 degC"}, Level.VALID),
        ({"temperature": "190 degC"}, None),
        ({}, None),  # that of the film
    ],
)
def test_a_fluid_keeps_a_temperature_of_its_own_and_the_result_says_so(fluid, level) -> None:
    """A template has 20 degC: with [temperature] added, the leak rate of the hot valve was that of cold gas."""
    given = hot(temperature="200 degC", fluid={"name": "nitrogen", **fluid})
    found = [one for one in film_cautions(SealProblem.of(given)) if one.kind == "film temperature"]
    assert [one.level for one in found] == ([] if level is None else [level])
    assert all(fluid["temperature"] in one.text() and "200 degC" in one.text() for one in found)


@pytest.mark.parametrize(
    ("given", "level"), [("300 degC", Level.DOUBTFUL), ("90 degC", Level.VALID), ("50 degC", None)]
)
def test_a_hot_fluid_between_bodies_without_a_temperature_is_told(given, level) -> None:
    cold = case(fluid={"name": "nitrogen", "temperature": given}, load={"fluid_pressure": "10 bar"})
    found = [one for one in film_cautions(SealProblem.of(cold)) if one.kind == "film temperature"]
    assert [one.level for one in found] == ([] if level is None else [level])
    assert all(
        given in one.text() and "20 degC" in one.text() and "[temperature]" in one.text() for one in found
    )


def test_a_hot_case_takes_the_hot_numbers_of_the_library() -> None:
    cold, warm = hot(temperature="20 degC").seat.material, hot().seat.material
    assert cold is LIBRARY["316L"]
    # EN 10088-1 and EN 10028-7 at 200 degC
    assert (warm.youngs_modulus, warm.yield_stress, warm.thermal_expansion) == (186e9, 137e6, 16.5e-6)
    assert (warm.hardness, warm.poissons_ratio) == (cold.hardness, cold.poissons_ratio)
    half = hot(temperature="250 degC").seat.material
    assert half.youngs_modulus == pytest.approx(182.5e9) and half.yield_stress == pytest.approx(127e6)
    # a part of its own keeps the rest, and another temperature takes other numbers
    own = hot(seat={"name": "AISI 316L", "hardness": "3 GPa"}).seat.material
    assert (own.youngs_modulus, own.yield_stress, own.hardness) == (186e9, 137e6, 3e9)
    again = hot().replace({"temperature.uniform": "100 degC"}).seat.material
    assert (again.youngs_modulus, again.yield_stress) == (194e9, 166e6)
    changed = hot().replace({"seat.material.hardness": "3 GPa"}).replace({"temperature.uniform": "100 degC"})
    assert (changed.seat.material.youngs_modulus, changed.seat.material.hardness) == (194e9, 3e9)


def test_a_study_of_a_hot_seal_keeps_the_tables_of_the_library() -> None:
    study = fem_seal.Study(
        hot(),
        parameters={
            "seat.material.hardness": ["2 GPa", "3 GPa"],
            "temperature.uniform": ["100 degC", "200 degC"],
        },
        responses=["peak_pressure_Pa"],
    )
    found = [study.case_of(point).seat.material for point in study.points]
    assert {(one.hardness, one.youngs_modulus) for one in found} == {
        (hardness, modulus) for hardness in (2e9, 3e9) for modulus in (194e9, 186e9)
    }
    # a number that a study sets holds whatever the temperature
    fixed = fem_seal.Study(
        hot(), parameters={"seat.material.youngs_modulus": ["200 GPa"]}, responses=["peak_pressure_Pa"]
    )
    assert fixed.case_of(fixed.points[0]).seat.material.youngs_modulus == 200e9


def test_a_number_that_is_not_known_when_hot_is_doubtful() -> None:
    said = said_of(hot())
    assert list(said) == ["hot hardness, closure", "hot hardness, seat"]
    level, text = said["hot hardness, seat"]
    assert level is Level.DOUBTFUL
    assert "seat.material.hardness: the library knows the hardness of 316L at 20 degC only: 1.64 GPa" in text
    assert 'hardness = { temperature = ["20 degC", "200 degC"], value = ["1.64 GPa", "..."] }' in text
    # the remedy, and what the limits are
    table = {"temperature": ["20 degC", "200 degC"], "value": ["1.64 GPa", "1.3 GPa"]}
    cured = {"name": "316L", "hardness": table}
    assert not said_of(hot(cured, cured))
    assert hot(cured, cured).hardness == pytest.approx(1.3e9)
    levels = {
        at: [level for level, _ in said_of(hot(temperature=at)).values()]
        for at in ("40 degC", "60 degC", "125 degC")
    }
    assert levels == {"40 degC": [], "60 degC": [Level.VALID] * 2, "125 degC": [Level.DOUBTFUL] * 2}
    # without yielding asperities nobody asks for the hardness of a material that has none
    assert not said_of(hot("stainless steel", "stainless steel", leak={"plasticity": False}))
    cold = said_of(hot(temperature="-100 degC", fluid={"name": "nitrogen", "temperature": "0 degC"}))
    assert '["-100 degC", "20 degC"], value = ["...", "1.64 GPa"]' in cold["hot hardness, seat"][1]


def test_beyond_a_table_of_the_library_its_end_is_kept_with_a_word() -> None:
    said = said_of(hot(temperature="620 degC"))
    assert "from 20 degC to 500 degC: 165 GPa; give a table" in said["hot youngs_modulus, seat"][1]
    assert (
        said["hot youngs_modulus, seat"][0] is Level.DOUBTFUL
        and said["hot yield_stress, seat"][0] is Level.VALID
    )
    assert hot(temperature="620 degC").seat.material.youngs_modulus == 165e9
    # expansion counts where the bodies grow differently
    assert "hot thermal_expansion, seat" not in said
    grown = said_of(hot(seat="stellite 6"))
    assert "from 20 degC to 100 degC: 11.4e-6 1/K" in grown["hot thermal_expansion, seat"][1]


def test_a_number_of_ones_own_without_a_temperature_is_a_remark() -> None:
    own = {
        "youngs_modulus": "190 GPa",
        "poissons_ratio": 0.3,
        "hardness": "3 GPa",
        "thermal_expansion": {"temperature": ["200 degC"], "value": ["12e-6 1/K"]},
    }
    told = {
        "youngs_modulus": {"temperature": ["200 degC"], "value": ["190 GPa"]},
        "hardness": {"temperature": ["200 degC"], "value": ["3 GPa"]},
    }
    ((level, text),) = said_of(hot(own, {**own, **told})).values()
    assert level is Level.VALID
    assert "closure.material: youngs_modulus and hardness of the case have no temperature" in text
    assert not said_of(hot(own, own, temperature="30 degC"))


@pytest.mark.slow
def test_doubt_reaches_the_loads_of_a_run_and_a_remark_only_the_warnings() -> None:
    result = fem_seal.run(hot(temperature="200 degC"))
    assert "seat: hardness at 20 degC used for 200 degC" in result.loads[0].validity.reasons
    assert result.loads[0].validity.level is not Level.VALID
    mild = fem_seal.run(hot(temperature="60 degC"))
    assert not any("hardness at" in reason for reason in mild.loads[0].validity.reasons)
    assert any("seat.material.hardness: the library knows" in warning for warning in mild.warnings)
    # yield onset is that of the hot metal
    stress = SealProblem.of(hot()).materials["seat"].yield_stress
    assert stress == 137e6


def test_what_a_conducting_seal_lacks_is_suggested_from_the_library() -> None:
    own = {"name": "316L", "youngs_modulus": "190 GPa", "poissons_ratio": 0.3}
    with pytest.raises(InputError) as error:
        hot(own, {**own, "name": "mine"}, temperature={"inner": {"temperature": "200 degC"}})
    told = {one.key: one.message for one in error.value.problems}
    assert '"14.3 W/(m K)" for 316L at 20 degC' in told["closure.material.thermal_conductivity"]
    assert "45" not in str(error.value) and "data sheet" in told["seat.material.thermal_conductivity"]
    # with names alone it runs, at the conductivity of each place
    case = hot(temperature={"inner": {"temperature": "200 degC"}, "wall": {"temperature": "100 degC"}})
    field = SealProblem.of(case)
    assert field.at_rest.heating is not None and 373.15 < field.at_rest.temperatures["seat"] < 473.15


SLIPS = [
    ({"uniform": "80"}, "temperature.uniform", "no temperature|has no unit"),
    ({}, "temperature", "give either uniform, or closure and seat"),
    ({"seat": "30 degC"}, "temperature", "give either uniform"),
    ({"uniform": "30 degC", "seat": "30 degC"}, "temperature", "give either uniform"),
    ({"uniform": "2000 degC"}, "temperature.uniform", "out of range"),
    ({"uniform": "80 degC", "housing": "20 degC"}, "temperature.housing", 'only with seat.wall = "fixed"'),
    ({"closure": "1200 degC", "seat": "1200 degC", "reference": "-200 degC"}, "temperature", "grow by"),
]


@pytest.mark.parametrize(("table", "key", "message"), SLIPS)
def test_slips_name_key_and_remedy(table: dict[str, str], key: str, message: str) -> None:
    with pytest.raises(InputError, match=message) as error:
        heated(GROWING, STEADY, temperature=table)
    assert error.value.key == key


def test_what_is_missing_or_cannot_hold_is_said() -> None:
    plain = {name: entry for name, entry in STEADY.items() if name != "thermal_expansion"}
    with pytest.raises(InputError, match=r"1.4122: is not known.*give it, in 1/K") as error:
        heated(plain, STEADY, temperature={"uniform": "80 degC"})
    assert error.value.key == "closure.material.thermal_expansion"
    # the same material at the same temperature needs none
    assert not SealProblem.of(heated(plain, plain, temperature={"uniform": "80 degC"})).at_rest.expansion
    held = {"wall": "fixed", "outer_radius": "25 mm"}
    with pytest.raises(InputError, match="the bore grows 15 um more than the seat"):
        heated(seat=held, temperature={"uniform": "120 degC", "housing_expansion": "16e-6 1/K"})
    with pytest.raises(InputError, match=r"would grow|pressed together by"):
        heated(seat=held, temperature={"uniform": "1220 degC", "housing_expansion": "-4e-6 1/K"})
    for table in (
        {"temperature": ["20 degC"], "value": []},
        {"temperature": ["20 degC", "10 degC"], "value": ["1 GPa", "2 GPa"]},
        {"temperature": ["20 degC"], "value": ["1 GPa", "2 GPa"]},
        {"value": ["1 GPa"]},
    ):
        with pytest.raises(InputError, match=r"closure\.material"):
            heated({**STEADY, "youngs_modulus": table})


def test_the_fluid_is_as_warm_as_the_film_unless_it_has_its_own_temperature() -> None:
    warm = case(
        temperature={"closure": "90 degC", "seat": "60 degC"},
        closure={"shape": "ball", "radius": "20 mm", "material": STEADY},
        seat=cone({**STEADY, "hardness": "2 GPa"}),
    )
    assert warm.fluid is not None and warm.fluid.temperature == pytest.approx(348.15)
    assert warm.fluid.viscosity == leak.liquid("water", 348.15).viscosity
    hotter = warm.replace({"temperature.closure": "110 degC"})
    assert hotter.fluid is not None and hotter.fluid.temperature == pytest.approx(358.15)
    cold = warm.replace({"temperature": None})
    assert cold.fluid is not None and cold.fluid.temperature == pytest.approx(293.15)
    own = warm.replace({"fluid.temperature": "40 degC"})
    assert own.fluid is not None and own.fluid.temperature == pytest.approx(313.15)
    with pytest.raises(InputError, match="water are known from") as error:
        warm.replace({"temperature": {"closure": "300 degC", "seat": "280 degC"}})
    assert error.value.key.startswith("fluid")


def test_studies_vary_the_temperature() -> None:
    base = case(
        temperature={"closure": "90 degC", "seat": "60 degC"},
        closure={"shape": "ball", "radius": "20 mm", "material": GROWING},
        seat=cone({**STEADY, "hardness": "3.5 GPa"}),
        load={"fluid_pressure": "20 bar"},
    )
    columns = ("leak_rate_m3_per_s", "peak_pressure_Pa", "contact_temperature_K")
    for closure in (310.0, 420.0):
        design = base.replace({"temperature.closure": closure})
        fast, row = evaluate_design(design, columns).values, run_loads(design).table.iloc[0]
        assert fast["contact_temperature_K"] == pytest.approx(0.5 * (closure + 333.15))
        # another mesh, both within 2e-4 of the limit of small elements
        assert fast["peak_pressure_Pa"] == pytest.approx(row["peak_pressure_Pa"], rel=3e-4)
        assert fast["leak_rate_m3_per_s"] == pytest.approx(row["leak_rate_m3_per_s"], rel=5e-4)


@pytest.mark.usefixtures("unrendered")
def test_results_show_the_temperature(tmp_path: Path) -> None:
    import meshio

    result = fem_seal.run(heated(GROWING, STEADY, temperature={"closure": "140 degC", "seat": "20 degC"}))
    result.write(tmp_path)
    written = meshio.read(tmp_path / "contact_000.vtu").point_data["temperature_K"]
    assert set(np.round(np.ravel(written), 6)) == {413.15, 293.15}
    report = (tmp_path / "report.html").read_text(encoding="utf-8").replace("\xa0", " ")
    assert "140 °C" in report and "closure grows more than seat" in report


def test_a_contact_that_heat_moves_to_the_end_of_its_face_is_doubtful() -> None:
    seat = cone(STEADY, bore_radius="14.1 mm", face_radius="16 mm")
    moved = smooth_case(
        closure={"shape": "ball", "radius": "20 mm", "material": GROWING},
        seat=seat,
        load={"fluid_pressure": "1 bar"},
        temperature={"closure": "200 degC", "seat": "20 degC"},
    )
    text = " ".join(fem_seal.run(moved).warnings)
    # 16e-6 times 180 K times 14.14 mm, along a face of 45 deg
    assert "moves the faces 57.6 um along each other" in text and "nearest end of a face is" in text
    assert "along each other" not in " ".join(
        fem_seal.run(heated(GROWING, STEADY, temperature={"closure": "90 degC", "seat": "60 degC"})).warnings
    )


# ---------------------------------------------------------------- conduction

CONDUCTING = Material("c", 2e11, 0.3, thermal_expansion=1e-5, thermal_conductivity=40.0)
POOR = Material("p", 2e11, 0.3, thermal_expansion=1e-5, thermal_conductivity=10.0)


def stacked(refine: int, share: float = 0.45) -> tuple[Any, np.ndarray, np.ndarray]:
    """Two rings on each other, both from 10 to 20 mm and 4 mm high, that touch all over their flat faces.

    Only what conduction asks of a mesh; the arc length is the radius less 15 mm. The seat's nodes on the contact line
    are those of the closure only with a share of 0.45.
    """
    outer = OUTER

    def body(name: str, bottom: float, share: float, ends: dict[str, float]) -> MeshTri:
        r = np.array([INNER, INNER + share * (outer - INNER), outer])
        mesh = MeshTri.init_tensor(r, bottom + np.array([0.0, 0.0022, 0.004])).refined(refine)
        sides = {"inner": (0, INNER), "outer": (0, outer), **{side: (1, z) for side, z in ends.items()}}
        return mesh.with_boundaries(
            {
                f"{name}_{side}": (lambda x, i=i, at=at: np.isclose(x[i], at))
                for side, (i, at) in sides.items()
            }
        )

    made = type("Stack", (), {})()
    made.seat = body("seat", -0.004, share, {"contact": 0.0, "bottom": -0.004})
    made.closure = body("closure", 0.0, 0.45, {"contact": 0.0, "top": 0.004})
    made.contact = type("Line", (), {"coordinate": staticmethod(lambda r, z: r - 0.015)})()
    ends = np.unique(made.seat.p[0][np.isclose(made.seat.p[1], 0.0)])
    points, weights = np.polynomial.legendre.leggauss(3)
    middle, half = 0.5 * (ends[1:] + ends[:-1]), 0.5 * np.diff(ends)
    r = (middle[:, None] + half[:, None] * points).ravel()
    return made, r - 0.015, 2 * np.pi * r * (half[:, None] * weights).ravel()


ALL_OVER = (-1.0, 1.0)


def test_a_slab_of_two_metals_with_convection_and_a_contact_conductance() -> None:
    """Heat through film, slab, contact, slab, film: resistances in series; linear in each body, so exact."""
    mesh, x, area = stacked(0)
    conductance, top, bottom = 5e3, Face(500.0, 800.0), Face(300.0, 2000.0)
    found = conduct(
        mesh,
        {"closure": CONDUCTING, "seat": POOR},
        Surroundings({"top": top, "bottom": bottom}, conductance, ALL_OVER),
        x,
        area,
    )
    resistances = np.array([1 / 800, 0.004 / 40, 1 / conductance, 0.004 / 10, 1 / 2000])
    flux = 200 / resistances.sum()
    heat = flux * np.pi * (OUTER**2 - INNER**2)
    assert found.heat == pytest.approx({"top": heat, "bottom": -heat}, rel=1e-10)
    assert found.contact_heat == pytest.approx(heat, rel=1e-10)
    drops = 500 - flux * np.cumsum(resistances)
    assert found.faces == pytest.approx({"closure": drops[1], "seat": drops[2]}, rel=1e-10)
    z = quadratic_nodes(mesh.closure)[0][:, 1]
    assert found.nodes["closure"] == pytest.approx(drops[1] + flux * z / 40, rel=1e-10)
    # perfect: no step but what is left of it, a thousandth of the change over an element of 0.1 mm or less
    perfect = conduct(
        mesh,
        {"closure": CONDUCTING, "seat": POOR},
        Surroundings({"top": top, "bottom": bottom}, None, ALL_OVER),
        x,
        area,
    )
    assert perfect.heat["top"] == pytest.approx(
        heat * resistances.sum() / np.delete(resistances, 2).sum(), rel=1e-3
    )
    assert perfect.faces["closure"] == pytest.approx(perfect.faces["seat"], abs=0.1)


def test_heat_across_a_contact_of_unequal_elements_converges() -> None:
    """The points of the contact line are those of the seat: what the closure's elements make of an even flow."""
    resistances = np.array([1 / 800, 0.004 / 40, 1 / 5e3, 0.004 / 10, 1 / 2000])
    heat, errors = 200 / resistances.sum() * np.pi * (OUTER**2 - INNER**2), []
    for refine in (0, 1, 2, 3):
        mesh, x, area = stacked(refine, 0.6)
        around = Surroundings({"top": Face(500.0, 800.0), "bottom": Face(300.0, 2000.0)}, 5e3, ALL_OVER)
        found = conduct(mesh, {"closure": CONDUCTING, "seat": POOR}, around, x, area)
        errors.append(abs(found.heat["top"] / heat - 1))
        assert found.heat["top"] == pytest.approx(-found.heat["bottom"], rel=1e-10)
        assert found.heat["top"] == pytest.approx(found.contact_heat, rel=1e-10)
    # of first order in the elements, by the points next to the kinks of the closure's trace: 2e-5 with 16 elements
    assert errors[-1] < 2e-5 and errors[-1] < errors[1] / 5


def test_a_cylinder_with_convection_converges_with_third_order() -> None:
    """T = A + B ln r between the films inside and outside; the joint across it is not seen."""
    errors, inside, outside = [], Face(480.0, 900.0), Face(300.0, 250.0)
    films = 1 / (900 * INNER) + 1 / (250 * OUTER) + np.log(OUTER / INNER) / 40
    per_radian = (480.0 - 300.0) / films  # heat per length over 2 pi
    for refine in (0, 1, 2, 3):
        mesh, x, area = stacked(refine)
        # the contact line itself is a wetted face of neither side where the bodies touch all over
        found = conduct(
            mesh,
            {"closure": CONDUCTING, "seat": CONDUCTING},
            Surroundings({"inner": inside, "outer": outside}, None, ALL_OVER),
            x,
            area,
        )
        error = 0.0
        for name in ("closure", "seat"):
            basis = Basis(getattr(mesh, name), ElementTriP2(), intorder=6)
            T = np.empty(basis.N)
            T[np.concatenate([basis.nodal_dofs[0], basis.facet_dofs[0]])] = found.nodes[name]
            r = np.asarray(basis.global_coordinates())[0]
            exact = 480.0 - per_radian * (1 / (900 * INNER) + np.log(r / INNER) / 40)
            error += np.sum((np.asarray(basis.interpolate(T)) - exact) ** 2 * basis.dx)
        errors.append(np.sqrt(error))
        heat = 2 * np.pi * per_radian * 0.008
        assert sum(found.heat.values()) == pytest.approx(0.0, abs=1e-9 * heat)
    # nothing drives heat across the joint but what the meshes of both bodies differ in
    assert abs(found.contact_heat) < 1e-8 * heat
    assert found.heat["inner"] == pytest.approx(heat, rel=1e-6)
    rates = np.diff(np.log(errors)) / np.log(0.5)
    assert rates[-1] == pytest.approx(3.0, abs=0.25)


def test_a_conductivity_that_falls_with_temperature() -> None:
    """k = k0 (1 - b (T - T0)): Kirchhoff's transform, int k dT linear over the height."""
    table = OverTemperature("thermal_conductivity", (300.0, 500.0), (50.0, 30.0))
    material = Material("k", 2e11, 0.3, thermal_conductivity=40.0, over_temperature=(table,))
    mesh, x, area = stacked(2)
    found = conduct(
        mesh,
        {"closure": material, "seat": material},
        Surroundings({"top": Face(500.0), "bottom": Face(300.0)}, None, ALL_OVER),
        x,
        area,
    )
    whole = 0.5 * (50 + 30) * 200
    assert found.heat["top"] == pytest.approx(whole / 0.008 * np.pi * (OUTER**2 - INNER**2), rel=1e-3)
    middle = 300 + (50 - np.sqrt(50**2 - 0.2 * whole / 2)) / 0.1
    # what is left of the step in a perfect contact
    assert 0.5 * (found.faces["closure"] + found.faces["seat"]) == pytest.approx(middle, abs=0.02)
    with pytest.raises(InputError, match="thermal_conductivity"):
        conduct(
            mesh,
            {"closure": STEEL, "seat": STEEL},
            Surroundings({"top": Face(500.0)}, None, ALL_OVER),
            x,
            area,
        )


@settings(max_examples=6, deadline=None)
@given(
    st.fixed_dictionaries(
        {"inner": st.floats(250, 700)},
        optional={"outer": st.floats(250, 700), "top": st.floats(250, 700), "wall": st.floats(250, 700)},
    ),
    st.booleans(),
    st.sampled_from([None, 1e2, 1e5]),
)
def test_heat_of_all_faces_balances_and_temperatures_stay_between_those_around(
    around: dict[str, float], films: bool, conductance: float | None
) -> None:
    seal = warm_mesh()
    faces = {name: Face(T, 300.0 if films else None) for name, T in around.items()}
    # a face with a film beside those that have a temperature themselves
    faces["bottom"] = Face(400.0, 50.0)
    found = conduct(
        seal,
        {"closure": CONDUCTING, "seat": POOR},
        Surroundings(faces, conductance, (-1e-4, 1e-4)),
        *line_points(seal),
    )
    scale = sum(abs(heat) for heat in found.heat.values())
    assert abs(sum(found.heat.values())) <= 1e-9 * max(scale, 1.0)
    of_closure = found.heat.get("top", 0.0)
    assert isinstance(of_closure, float)
    given_temperatures = [*around.values(), 400.0]
    low, high = min(given_temperatures), max(given_temperatures)
    # quadratic elements overshoot at corners where two given temperatures meet
    room = 0.15 * (high - low) + 1e-6
    for nodes in found.nodes.values():
        assert low - room <= nodes.min() and nodes.max() <= high + room


@cache
def warm_mesh() -> meshes.SealMesh:
    ball = meshes.Ball(0.02)
    return meshes.build(
        ball, meshes.ConicalSeat.around(0.785, ball), meshes.Sizing(4e-5, 1e-4, (-1e-3, 1e-3), 0.3, 0.4, 4e-3)
    )


WARM = {**STEADY, "thermal_conductivity": "40 W/(m K)"}


@pytest.mark.slow
def test_surroundings_of_one_temperature_are_a_uniform_temperature() -> None:
    around = {"temperature": "200 degC", "heat_transfer": "500 W/(m^2 K)"}
    calculated = heated(WARM, WARM, temperature={"inner": around, "outer": around})
    uniform = heated(WARM, WARM, temperature={"uniform": "200 degC"})
    first, second = contact_of(calculated), contact_of(uniform)
    # the round-off of a field of 473 K whose differences strain the bodies
    assert first.pressure == pytest.approx(second.pressure, rel=1e-6)
    assert first.fields["seat"].temperature == pytest.approx(473.15, abs=1e-6)
    problem = SealProblem.of(calculated)
    assert problem.at_rest.temperatures == pytest.approx({"closure": 473.15, "seat": 473.15}, abs=1e-6)


def test_two_held_bodies_without_contact_heat_are_bodies_of_two_temperatures() -> None:
    """A poor contact leaves the closure as warm as what is above it and the seat as what is below."""
    faces = {"top": {"temperature": "140 degC"}, "bottom": {"temperature": "60 degC"}}
    calculated = heated(WARM, WARM, temperature={**faces, "contact_conductance": "1e-3 W/(m^2 K)"})
    given = heated(WARM, WARM, temperature={"closure": "140 degC", "seat": "60 degC"})
    first, second = contact_of(calculated), contact_of(given)
    assert first.pressure == pytest.approx(second.pressure, rel=1e-6)
    # another course of the same calculation: the field strains the bodies by their stiffness
    assert first.approach == pytest.approx(second.approach, rel=1e-5)
    stress = np.abs(first.fields["closure"].stress - second.fields["closure"].stress).max()
    assert stress < 1e-5 * np.abs(second.fields["closure"].stress).max()


@pytest.mark.slow
@pytest.mark.usefixtures("unrendered")
def test_a_calculated_temperature_goes_through_case_results_and_study(tmp_path: Path) -> None:
    over = {"temperature": ["20 degC", "220 degC"], "value": ["210 GPa", "190 GPa"]}
    warm = case(
        closure={"shape": "ball", "radius": "20 mm", "material": {**WARM, "youngs_modulus": over}},
        seat=cone({**WARM, "hardness": "3.5 GPa"}),
        fluid={"name": "nitrogen"},
        load={"fluid_pressure": "20 bar"},
        temperature={
            "inner": {"temperature": "200 degC", "heat_transfer": "1 kW/(m^2 K)"},
            "outer": {"temperature": "60 degC", "heat_transfer": "200 W/(m^2 K)"},
        },
    )
    result = fem_seal.run(warm)
    result.write(tmp_path, full=True)
    at = result.loads[0].contact_temperature
    assert at is not None and 333.15 < at < 473.15
    # that at which fluid and materials are taken comes from a mesh of its own, without the contact pressure
    assert result.case.fluid is not None and result.case.fluid.temperature == pytest.approx(at, abs=1.0)
    closure = result.problem.at_rest.temperatures["closure"]
    modulus = np.interp(closure, [293.15, 493.15], [210e9, 190e9])
    assert result.problem.materials["closure"].youngs_modulus == pytest.approx(modulus, rel=1e-12)
    assert "temperature_K" in (tmp_path / "contact_000.vtu").read_text(encoding="utf-8", errors="ignore")
    report = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert 'id="picture-temperature"' in report and "inside, heat into the seal" in report
    row = evaluate_design(warm, ("leak_rate_m3_per_s", "contact_temperature_K")).values
    assert row["leak_rate_m3_per_s"] == result.table["leak_rate_m3_per_s"][0]
    hotter = evaluate_design(
        warm.replace({"temperature.inner.temperature": 500.0}), ("contact_temperature_K",)
    ).values
    assert hotter["contact_temperature_K"] > row["contact_temperature_K"]


@pytest.mark.slow
def test_bodies_that_yield_are_heated_by_the_field() -> None:
    faces = {"inner": {"temperature": "160 degC"}, "wall": {"temperature": "40 degC"}}
    curve = {"stress_strain": CURVE}
    elastic = contact_of(heated(WARM, WARM, temperature=faces, mesh={"contact_size": "20 um"}))
    yielding = contact_of(
        heated({**WARM, **curve}, {**WARM, **curve}, temperature=faces, mesh={"contact_size": "20 um"})
    )
    peak = elastic.profile.peak_pressure
    # the strain at the quadrature points is the same quadratic field
    assert yielding.pressure == pytest.approx(elastic.pressure, abs=1e-6 * peak)


CONDUCTION_SLIPS = [
    ({"inner": {"temperature": "80 degC"}, "uniform": "80 degC"}, "temperature", "give either uniform"),
    (
        {"uniform": "80 degC", "contact_conductance": "10 W/(m^2 K)"},
        "temperature.contact_conductance",
        "no face",
    ),
    ({"inner": {"heat_transfer": "10 W/(m^2 K)"}}, "temperature.inner.temperature", "missing"),
    (
        {"inner": {"temperature": "80 degC", "heat_transfer": "10 W/m"}},
        "temperature.inner.heat_transfer",
        "unit",
    ),
]


@pytest.mark.parametrize(("table", "key", "message"), CONDUCTION_SLIPS)
def test_slips_of_faces(table: dict[str, Any], key: str, message: str) -> None:
    with pytest.raises(InputError, match=message) as error:
        heated(WARM, WARM, temperature=table)
    assert error.value.key == key


def test_conduction_needs_its_numbers() -> None:
    with pytest.raises(InputError, match=r"thermal_conductivity: 1.4122: is not known"):
        heated(WARM, STEADY, temperature={"inner": {"temperature": "80 degC"}})
    over = {"temperature": ["20 degC", "100 degC"], "value": ["40 W/(m K)", "35 W/(m K)"]}
    short = heated(
        {**WARM, "thermal_conductivity": over}, WARM, temperature={"inner": {"temperature": "200 degC"}}
    )
    with pytest.raises(InputError, match="is known from 20 degC to 100 degC and asked for at 200 degC"):
        SealProblem.of(short)


@pytest.mark.slow
def test_a_body_that_yields_by_its_press_fit_is_the_same_by_heat() -> None:
    """Beyond the elastic limit, with the fluid between the surfaces: a hot seat in a cold bore and a tight one."""
    soft = {**STEADY, "stress_strain": {"plastic_strain": [0, 0.02], "stress": ["150 MPa", "300 MPa"]}}
    held = {"wall": "fixed", "outer_radius": "25 mm"}
    more: dict[str, Any] = {
        "load": {"fluid_pressure": "20 bar", "closing": "penetration", "applied_force": "2 kN"},
        "mesh": {"contact_size": "40 um"},
    }
    hot = contact_of(
        heated(STEADY, soft, seat=held, temperature={"uniform": "120 degC", "housing": "20 degC"}, **more)
    )
    fitted = contact_of(heated(STEADY, soft, seat={**held, "interference": "25 um"}, **more))
    assert fitted.states["seat"].plastic.accumulated_strain.max() > 1e-4
    assert hot.pressure == pytest.approx(fitted.pressure, rel=1e-6, abs=1e3)


@pytest.mark.slow
def test_a_field_of_heat_makes_a_body_yield_as_it_would_by_its_stress() -> None:
    """Heated through the path, or given as free strain to the solid at once: the same state without a contact."""
    faces = {"inner": Face(620.0), "wall": Face(300.0)}
    seal = warm_mesh()
    curve = HardeningCurve((0.0, 0.05), (250e6, 400e6))
    soft = Material("s", 2e11, 0.3, thermal_expansion=1.2e-5, thermal_conductivity=20.0, hardening=curve)
    heating = Heating(Surroundings(faces, None, (-1e-4, 1e-4)), 300.0)
    materials = {"closure": CONDUCTING, "seat": soft}
    model = fem_seal.condense(seal, materials, None, heating.of_bodies(seal, materials))
    loads = BodyLoads({"heat": 1.0}, {"heat": 1.0})
    path = load_path(model, fem_seal.HardContact(), [PathLoad(1e3, loads)], at_rest=loads)
    state = path.unloaded_bodies.initial_states["seat"]
    assert state.plastic.accumulated_strain.max() > 1e-4
    solid = path.unloaded_bodies.bodies["seat"].solid
    strain = at_quadrature_points(model.seat.fem.mesh, model.seat.fem.free_strain["heat"])
    # in balance without a force, and on the yield surface, by what the solid itself says of the strain
    flow = solid.respond(state.displacement, solid.virgin, strain)
    scale = np.abs(solid.internal_forces(np.abs(flow.stress))).max()
    free = model.seat.fem.free
    assert np.abs(solid.internal_forces(flow.stress)[free]).max() < 1e-8 * scale
    assert flow.state.accumulated_strain == pytest.approx(state.plastic.accumulated_strain, abs=1e-9)
