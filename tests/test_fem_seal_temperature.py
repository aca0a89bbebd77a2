"""Temperature: thermal strain of the bodies, materials over temperature, the fluid between them."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sample_results import case, cone, smooth_case
from skfem import Basis, MeshTri, condense, solve

import fem_seal
import leak
import meshes
from fem_seal.analysis.load_solver import LoadSolver, solve_loads
from fem_seal.analysis.problem import SealProblem, condensed, sizing
from fem_seal.bodies.condensed import body_field
from fem_seal.bodies.elasticity import (
    at_quadrature_points,
    displacement_basis,
    node_dofs,
    quadratic_nodes,
    stiffness_matrix,
    thermal_load,
)
from fem_seal.case.case import Case
from fem_seal.contact.model import ContactModel
from fem_seal.contact.other_loads import FurtherLoads
from fem_seal.contact.solution import fields_at_rest
from fem_seal.errors import InputError
from fem_seal.materials import Material, OverTemperature
from fem_seal.studies.responses import responses

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
    model = condensed(problem, meshes.build_contact(problem.contact, sizing(problem)))
    return solve_loads(LoadSolver(problem, model)).contacts[0]


# ---------------------------------------------------------------- bodies


def ring(refine: int, at: float = 0.0145) -> MeshTri:
    """Rectangle in the (r, z) half-plane, unequal elements, with a line of nodes at a radius."""
    r = np.array([INNER, at, OUTER])
    mesh = MeshTri.init_tensor(r, np.linspace(0, HEIGHT, 2)).refined(refine)
    return mesh.with_boundaries({"ends": lambda x: np.isclose(x[1], 0) | np.isclose(x[1], HEIGHT)})


def thermal_ring(basis: Basis, strain: np.ndarray) -> np.ndarray:
    """Displacement of a ring with free strains at the quadrature points, between smooth rigid plates."""
    held = basis.get_dofs("ends").all(["u^2"])
    return solve(*condense(stiffness_matrix(basis, STEEL), thermal_load(basis, STEEL, strain), D=held))


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
        u = thermal_ring(basis, at_quadrature_points(basis, log_strain(r)))
        at = np.asarray(basis.global_coordinates())[0]
        error = np.asarray(basis.interpolate(u))[0] - in_plane_strain(at, log_integral)
        errors.append(np.sqrt(np.sum(error**2 * basis.dx)))
    rates = np.diff(np.log(errors)) / np.log(0.5)
    assert rates[-1] == pytest.approx(3.0, abs=0.25)  # as of any load: third order in L2


def test_thermal_stress_of_a_thick_cylinder() -> None:
    basis = displacement_basis(ring(4))
    r = quadratic_nodes(basis.mesh)[0][:, 0]
    strain = log_strain(r)
    u = thermal_ring(basis, at_quadrature_points(basis, strain))
    body = type("Body", (), {})()
    body.basis, body.material = basis, STEEL
    body.stress_operator = fem_seal.bodies.fields.stress_operator(basis, STEEL)
    body.contact_nodes, body.contact_x = np.zeros(0, int), np.zeros(0)
    stress = body_field("ring", body, u, np.zeros(len(r)), strain).stress
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
    assert u[node_dofs(basis)[0]] == pytest.approx(exact, abs=2e-6 * exact.max())


def model_of(supports: fem_seal.Supports | None = None, wide: bool = False) -> ContactModel:
    ball = meshes.Ball(0.02)
    seat = meshes.SphericalSeat.around(0.785, ball) if wide else meshes.ConicalSeat.around(0.785, ball)
    sizing = meshes.Sizing(2e-5, 1e-4, (-1e-3, 1e-3), 0.2, 0.3, 4e-3)
    return fem_seal.condense(meshes.build(ball, seat, sizing), {"closure": STEEL, "seat": STEEL}, supports)


def grown(body: Any, strain: float) -> np.ndarray:
    """Displacement of a condensed body with a uniform free strain, by its stiffness."""
    held = body.held
    load = thermal_load(held.basis, held.material, np.full((1, 1), strain))
    return held.counted(body.solve(held.balanced(load)))


def test_the_column_of_the_closure_is_its_free_expansion() -> None:
    model = model_of()
    column = model.closure.loads["expansion"]
    by_stiffness = grown(model.closure, 1.0)
    # the solver's round-off
    assert column.response == pytest.approx(by_stiffness, abs=1e-8 * np.abs(by_stiffness).max())
    loads = FurtherLoads(closure={"expansion": 2e-3})
    stress = fields_at_rest(model, loads)["closure"].stress
    assert np.abs(stress).max() < 1e-9 * 2e-3 * STEEL.youngs_modulus


def test_a_seal_that_grows_evenly_only_changes_its_scale() -> None:
    """Both bodies together open the gap by strain times gap and a rigid motion: nothing but another scale."""
    model, strain = model_of(), 2e-3
    both = sum(body.trace @ body.held.retreat(grown(body, strain)) for body in (model.closure, model.seat))
    way = model.line.normal[1]
    scaled = strain * model.line.initial_gap
    rigid = float(way @ (both - scaled) / (way @ way))
    # chords instead of arcs
    sagitta = np.diff(model.line.vertices).max() ** 2 / (8 * 0.02)
    assert both == pytest.approx(scaled + rigid * way, abs=strain * sagitta)
    # which is what is left out: counted from the seat there is no motion at all
    assert SealProblem.of(heated(temperature={"uniform": "200 degC"})).at_rest.opening(
        model
    ) == pytest.approx(0.0)


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
        assert problem.at_rest.closure.get("expansion", 0.0) == 0.0 and problem.at_rest.seat == {}


def test_only_the_fluid_notices_a_uniform_temperature() -> None:
    rough = {"load": {"fluid_pressure": "20 bar"}}
    cold, hot = (
        fem_seal.run(
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
    # water of 80 degC is thinner, and that is all
    ratio = leak.liquid("water", 293.15).viscosity / leak.liquid("water", 353.15).viscosity
    assert after.leak.leak_rate / before.leak.leak_rate == pytest.approx(ratio, rel=1e-12)
    assert hot.table["contact_temperature_K"].tolist() == [353.15]
    assert cold.table["contact_temperature_K"].isna().all()


def test_a_grown_ball_is_a_larger_ball() -> None:
    """What the displacement leaves out is a change of the geometry by the strain itself, 2 per mille here."""
    strain = 16e-6 * 120
    hot = contact_of(heated(GROWING, STEADY, temperature={"closure": "140 degC", "seat": "20 degC"}))
    cold = contact_of(heated(GROWING, STEADY))
    drawn = contact_of(
        smooth_case(
            closure={"shape": "ball", "radius": f"{20 * (1 + strain)!r} mm", "material": GROWING},
            seat=cone(STEADY, bore_radius="12 mm"),
            load={"fluid_pressure": "20 bar", "axial_force": "0 N"},
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
    assert SealProblem.of(hot).interference == pytest.approx(15e-6, rel=1e-12)
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
    field = body_field(
        "seat", seat, grown(seat, strain), np.zeros(len(quadratic_nodes(seat.basis.mesh)[0])), strain
    )
    # ... by the interference that is calculated with ...
    fitted = fields_at_rest(model, FurtherLoads.press_fit(strain * outer))["seat"]
    scale = np.abs(fitted.stress).max()
    assert field.stress == pytest.approx(fitted.stress, abs=1e-7 * scale)
    # ... and by Lame: hoop stress at the bore 2 E/(1 - nu) A, u = A (r + B/r) = -e b at the wall
    nu, E = STEEL.poissons_ratio, STEEL.youngs_modulus
    A = -strain * outer / (outer + bore**2 * (1 + nu) / (1 - nu) / outer)
    at_bore = field.points[:, 0] < bore * (1 + 1e-9)
    # second order in elements of 1 mm at a bore of 10 mm
    assert field.stress[at_bore, 2] == pytest.approx(2 * E / (1 - nu) * A, rel=1e-2)


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
    load = {"fluid_pressure": "20 bar", "closing": "penetration", "axial_force": "2 kN"}
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
    assert SealProblem.of(hot).expansion == pytest.approx(10.2e-6 * 100 - 10e-6 * 40, rel=1e-12)
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
    with pytest.raises(InputError, match=r'1.4122: is not known.*"11e-6 1/K"') as error:
        heated(plain, STEADY, temperature={"uniform": "80 degC"})
    assert error.value.key == "closure.material.thermal_expansion"
    # the same material at the same temperature needs none
    assert not SealProblem.of(heated(plain, plain, temperature={"uniform": "80 degC"})).expansion
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
        fast, row = responses(design, columns), fem_seal.run(design).table.iloc[0]
        assert fast["contact_temperature_K"] == pytest.approx(0.5 * (closure + 333.15))
        # another mesh, both within 2e-4 of the limit of small elements
        assert fast["peak_pressure_Pa"] == pytest.approx(row["peak_pressure_Pa"], rel=3e-4)
        assert fast["leak_rate_m3_per_s"] == pytest.approx(row["leak_rate_m3_per_s"], rel=5e-4)


def test_results_show_the_temperature(tmp_path: Path) -> None:
    import meshio

    result = fem_seal.run(heated(GROWING, STEADY, temperature={"closure": "140 degC", "seat": "20 degC"}))
    result.write(tmp_path)
    written = meshio.read(tmp_path / "contact_000.vtu").point_data["temperature_K"]
    assert set(np.round(np.ravel(written), 6)) == {413.15, 293.15}
    report = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "140 °C" in report and "closure grows more than seat" in report
    assert "(not used)" not in report


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
    assert "slides 57.6 um along it" in text and "nearest end of a face is" in text
    assert "slides" not in " ".join(
        fem_seal.run(heated(GROWING, STEADY, temperature={"closure": "90 degC", "seat": "60 degC"})).warnings
    )
