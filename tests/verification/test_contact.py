"""The finite-element contact against closed solutions and independent numbers.

The closed solutions are those of a half-space. The axisymmetric bodies of a ball on a cone differ from it by up to
3e-4 in peak, width and standard deviation at 200 bar (R = 20 mm, 30 to 60 deg); tolerances below are that plus the
discretisation error of 1e-4.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from contact_models import STEEL, ball_on_cone

from fem_seal.contact.flattened import solve_flattened
from fem_seal.contact.laws import HardContact
from fem_seal.contact.model import ContactModel, condense
from fem_seal.contact.newton import solve
from fem_seal.contact.sizing import element_sizes
from fem_seal.contact.solution import ContactSettings, ContactSolution, body_fields, move_together
from fem_seal.errors import ConvergenceError
from fem_seal.materials import Material, effective_modulus
from leak import ExponentialLaw, TabulatedLaw, crossover_line, hertz_line
from meshes import Ball, ConicalSeat, ContactGeometry, Sizing, build, build_contact

LAW = ExponentialLaw(p_c=5e9, u0=0.76e-6)
PRESSURES = [2e5, 2e6, 2e7]


def deviations(model: ContactModel, solution: ContactSolution, law: ExponentialLaw) -> list[float]:
    exact = crossover_line(
        solution.line_load, model.relative_radius, effective_modulus=model.effective_modulus, u0=law.u0
    )
    profile = solution.profile
    return [
        profile.peak_pressure / exact.peak_pressure - 1,
        profile.fwhm / exact.fwhm - 1,
        profile.std / exact.std - 1,
    ]


@pytest.fixture(scope="module")
def default() -> tuple[ContactModel, list[ContactSolution]]:
    model, forces = ball_on_cone(LAW, PRESSURES)
    return model, [solve(model, LAW, contact_force=force) for force in forces]


@pytest.mark.parametrize("index", range(3), ids=["2 bar", "20 bar", "200 bar"])
def test_exponential_law_meets_the_exact_crossover(
    default: tuple[ContactModel, list[ContactSolution]], index: int
) -> None:
    model, solutions = default
    assert np.abs(deviations(model, solutions[index], LAW)).max() < 5e-4


def test_paper_case_in_numbers(default: tuple[ContactModel, list[ContactSolution]]) -> None:
    """Closed crossover of steel on steel, u0 = 0.76 um: 20 bar and 2 bar in plain numbers."""
    _, solutions = default
    for solution, peak, fwhm, std in (
        (solutions[1], 61.6678e6, 0.307040e-3, 0.127685e-3),
        (solutions[0], 6.43935e6, 0.292018e-3, 0.123735e-3),
    ):
        profile = solution.profile
        assert (profile.peak_pressure, profile.fwhm, profile.std) == pytest.approx(
            (peak, fwhm, std), rel=2e-4
        )


def test_contact_force_equals_the_applied_force(default: tuple[ContactModel, list[ContactSolution]]) -> None:
    _, solutions = default
    for solution in solutions:
        assert abs(solution.force_error) < 1e-12
        # sum the profile by hand: the force is that of p over the cone's face
        profile = solution.profile
        by_hand = (
            2 * np.pi * np.sum(profile.pressure * profile.radius * profile.arc_weight) * math.cos(math.pi / 4)
        )
        assert by_hand == pytest.approx(solution.contact_force, rel=1e-12)


def test_newton_converges_in_a_few_iterations_and_quadratically(
    default: tuple[ContactModel, list[ContactSolution]],
) -> None:
    _, solutions = default
    for solution in solutions:
        assert solution.iterations <= 6
        assert solution.residuals[-1] < 1e-10


def test_a_solved_contact_takes_no_further_step(
    default: tuple[ContactModel, list[ContactSolution]],
) -> None:
    model, solutions = default
    solved = solutions[-1]
    again = solve(model, LAW, contact_force=solved.contact_force, start=solved)
    assert again.residuals == solved.residuals[-1:]
    np.testing.assert_array_equal(again.log_pressure, solved.log_pressure)


@pytest.mark.slow
def test_one_mesh_resolves_the_widest_of_very_different_contacts() -> None:
    """At a thousandfold load a stiff interface carries ten times as wide, with sharp ends far from first touch."""
    law = ExponentialLaw(p_c=5e9, u0=0.02e-6)
    model, forces = ball_on_cone(law, [2e5, 2e8])
    finer, (force,) = ball_on_cone(law, [2e8], refine=2.0)
    shared = solve(model, law, contact_force=forces[-1]).profile
    exact = solve(finer, law, contact_force=force).profile
    for name in ("peak_pressure", "fwhm", "std"):
        assert getattr(shared, name) == pytest.approx(getattr(exact, name), rel=2e-4)


def test_error_falls_with_fourth_order() -> None:
    """Quadratic elements: functionals of the solution converge with twice the order of the energy norm, h^4."""

    def measures(refine: float) -> np.ndarray:
        model, (force,) = ball_on_cone(LAW, [2e7], refine=refine)
        profile = solve(model, LAW, contact_force=force).profile
        return np.array([profile.peak_pressure, profile.fwhm, profile.std])

    exact, factors = measures(2.5), np.array([0.35, 0.5, 0.7, 1.0])
    errors = np.abs(np.array([measures(factor) for factor in factors]) / exact - 1)
    slopes = np.polyfit(np.log(factors), np.log(errors), 1)[0]
    assert np.all(slopes < -3.2)  # unstructured meshes scatter about the order
    assert errors[-1].max() < 1e-4


@pytest.mark.parametrize("degrees", [20, 30, 60, 70])
@pytest.mark.parametrize("radius", [5e-3, 50e-3])
def test_other_angles_and_radii(degrees: float, radius: float) -> None:
    law = ExponentialLaw(p_c=5e9, u0=0.2e-6)
    model, (force,) = ball_on_cone(law, [2e6], radius=radius, angle=math.radians(degrees))
    assert np.abs(deviations(model, solve(model, law, contact_force=force), law)).max() < 5e-4


@pytest.mark.parametrize(("closure", "seat"), [("tungsten carbide", "steel"), ("steel", "bronze")])
def test_dissimilar_materials(closure: str, seat: str) -> None:
    library = {
        "steel": STEEL,
        "tungsten carbide": Material("WC", 600e9, 0.22),
        "bronze": Material("bronze", 110e9, 0.34),
    }
    model, forces = ball_on_cone(LAW, [2e5, 2e6], closure=library[closure], seat=library[seat])
    for force in forces:
        assert np.abs(deviations(model, solve(model, LAW, contact_force=force), LAW)).max() < 5e-4


def test_swapping_the_materials_swaps_nothing_that_counts() -> None:
    hard = Material("hard", 420e9, 0.3)
    profiles = []
    for closure, seat in ((hard, STEEL), (STEEL, hard)):
        model, (force,) = ball_on_cone(LAW, [2e6], closure=closure, seat=seat)
        profiles.append(solve(model, LAW, contact_force=force).profile)
    assert profiles[0].peak_pressure == pytest.approx(profiles[1].peak_pressure, rel=2e-4)
    assert profiles[0].std == pytest.approx(profiles[1].std, rel=2e-4)


@pytest.mark.parametrize("pressure", [2e5, 2e6, 2e7])
def test_hard_contact_meets_hertz(pressure: float) -> None:
    model, (force,) = ball_on_cone(HardContact(), [pressure])
    solution = solve(model, HardContact(), contact_force=force)
    exact = hertz_line(solution.line_load, model.relative_radius, model.effective_modulus)
    profile = solution.profile
    assert profile.peak_pressure == pytest.approx(exact.peak_pressure, rel=5e-4)
    # the edge falls inside an element: the width is the least accurate number
    assert profile.fwhm == pytest.approx(exact.fwhm, rel=1e-3)
    assert profile.std == pytest.approx(exact.std, rel=5e-4)
    assert abs(solution.force_error) < 1e-8
    assert np.all(profile.pressure >= 0)
    assert profile.gap.min() > -1e-4 * 1e-6


def test_stiff_law_tends_to_hertz_and_soft_law_to_the_gaussian() -> None:
    stiff, soft = ExponentialLaw(p_c=5e9, u0=2e-10), ExponentialLaw(p_c=5e9, u0=5e-6)
    model, (force,) = ball_on_cone(stiff, [2e6])
    solution = solve(model, stiff, contact_force=force)
    hertz = hertz_line(solution.line_load, model.relative_radius, model.effective_modulus)
    c = solution.line_load / (math.pi * model.effective_modulus * stiff.u0)
    assert solution.profile.peak_pressure / hertz.peak_pressure - 1 == pytest.approx(-1 / (4 * c), abs=3e-4)
    model, (force,) = ball_on_cone(soft, [1e4])
    profile = solve(model, soft, contact_force=force).profile
    assert profile.std == pytest.approx(math.sqrt(0.02 * soft.u0), rel=5e-4)


def test_tabulated_law_against_independent_boundary_elements(
    reference: Callable[[str], np.ndarray], greenwood_williamson: TabulatedLaw
) -> None:
    law, rows = greenwood_williamson, reference("line_contact_tabulated_law.csv")
    pressures = [2 * row["line_load_N_per_m"] / 0.02 for row in rows]
    model, forces = ball_on_cone(law, pressures)
    for row, force in zip(rows, forces, strict=True):
        profile = solve(model, law, contact_force=force).profile
        assert profile.peak_pressure == pytest.approx(row["peak_pressure_Pa"], rel=5e-4)
        assert profile.fwhm == pytest.approx(row["fwhm_m"], rel=5e-4)
        assert profile.std == pytest.approx(row["std_m"], rel=5e-4)
        gap_at_centre = np.interp(profile.centroid, profile.x, profile.gap)
        # the gap itself is a difference of micrometres of displacement: absolute tolerance 2e-3 of the law's range
        assert gap_at_centre == pytest.approx(row["gap_at_centre_m"], abs=5e-9)


def test_virial_identity_for_a_tabulated_law(greenwood_williamson: TabulatedLaw) -> None:
    """f_N var(x)/R = f_N^2/(pi E*) + int Phi(u) dx, Phi(u) = int_u^inf p du': no closed solution is used."""
    law = greenwood_williamson
    model, (force,) = ball_on_cone(law, [2e6])
    solution = solve(model, law, contact_force=force)
    profile, f_N = solution.profile, solution.line_load
    log_p = np.linspace(
        np.log(profile.pressure[profile.pressure > 0].min()), np.log(profile.peak_pressure), 20001
    )
    # Phi(p) = int p (-du/dlnp) dlnp
    integrand = np.exp(log_p) * law.decay_length(log_p)
    phi = np.concatenate([[0], np.cumsum(0.5 * (integrand[1:] + integrand[:-1]) * np.diff(log_p))])
    stored = np.sum(profile.arc_weight * np.interp(np.log(np.maximum(profile.pressure, 1e-300)), log_p, phi))
    left = f_N * profile.std**2 / model.relative_radius
    right = f_N**2 / (np.pi * model.effective_modulus) + stored
    assert left == pytest.approx(right, rel=1e-3)


def test_result_does_not_depend_on_the_unit_system() -> None:
    """The same seal in millimetre and megapascal: k = 1024 times larger numbers for length, 1/2^20 for pressure."""
    k, m = 1024.0, 2.0**-20
    profiles = []
    for length, stress in ((1.0, 1.0), (k, m)):
        ball = Ball(0.02 * length)
        seat = ConicalSeat.around(math.radians(45), ball)
        sizing = Sizing(
            2e-5 * length, 3e-4 * length, (-8e-4 * length, 8e-4 * length), 0.1, 0.25, 2.5e-3 * length
        )
        law = ExponentialLaw(p_c=5e9 * stress, u0=0.76e-6 * length)
        material = Material("steel", 210e9 * stress, 0.3)
        model = condense(build(ball, seat, sizing), {"closure": material, "seat": material})
        profiles.append(solve(model, law, contact_force=1000.0 * stress * length**2).profile)
    assert profiles[1].peak_pressure == pytest.approx(profiles[0].peak_pressure * m, rel=1e-9)
    assert profiles[1].std == pytest.approx(profiles[0].std * k, rel=1e-9)


def test_size_of_the_housing_hardly_matters() -> None:
    profiles = []
    for scale in (1.0, 2.0):
        ball = Ball(0.02)
        seat = ConicalSeat.around(math.radians(45), ball, outer_radius=0.044 * scale, height=0.03 * scale)
        sizing = Sizing(2e-5, 3e-4, (-1e-3, 1e-3), 0.1, 0.25, 2.5e-3)
        model = condense(build(ball, seat, sizing), {"closure": STEEL, "seat": STEEL})
        profiles.append(solve(model, LAW, contact_force=1256.0).profile)
    assert profiles[0].peak_pressure == pytest.approx(profiles[1].peak_pressure, rel=3e-5)


def test_p_c_only_shifts_the_approach() -> None:
    model, (force,) = ball_on_cone(LAW, [2e6])
    other = ExponentialLaw(p_c=LAW.p_c * math.e**2, u0=LAW.u0)
    a, b = (solve(model, law, contact_force=force) for law in (LAW, other))
    assert b.profile.pressure == pytest.approx(a.profile.pressure, rel=1e-8)
    assert (a.approach - b.approach) * math.cos(math.pi / 4) == pytest.approx(2 * LAW.u0, rel=1e-6)


def test_compliance_is_symmetric_and_positive() -> None:
    model, _ = ball_on_cone(LAW, [2e6])
    for body in (model.closure, model.seat):
        assert np.abs(body.compliance - body.compliance.T).max() < 1e-9 * np.abs(body.compliance).max()
        assert np.linalg.eigvalsh(body.compliance).min() > -1e-12 * np.abs(body.compliance).max()


def test_stress_under_hertz_contact() -> None:
    """von Mises maximum 0.5577 p0 at depth 0.704 a (line contact, plane strain, nu = 0.3; Johnson 1985, 4.2)."""
    model, (force,) = ball_on_cone(HardContact(), [2e5])
    solution = solve(model, HardContact(), contact_force=force)
    exact = hertz_line(solution.line_load, 0.02, model.effective_modulus)
    for field in body_fields(solution).values():
        node = np.argmax(field.von_mises)
        # the hoop stress of the ring adds a few per cent that a half-space does not have
        assert field.von_mises[node] / exact.peak_pressure == pytest.approx(0.5577, rel=0.03)
        depth = (field.points[node] - [0.02 * math.sin(math.pi / 4), 0]) @ [-math.sqrt(0.5), math.sqrt(0.5)]
        assert abs(depth) / exact.half_width == pytest.approx(0.704, abs=0.12)
        centre = field.contact_nodes[np.argmin(np.abs(field.contact_x))]
        rr, zz, _, rz = field.stress[centre]
        assert 0.5 * (rr + zz) - rz == pytest.approx(-exact.peak_pressure, rel=5e-3)


@pytest.mark.slow
def test_the_largest_stress_is_that_of_a_finer_mesh() -> None:
    """The mean over the triangles around each node is 0.9 % too high in the ball and 0.5 % in the seat."""
    ball = Ball(0.02)
    contact = ContactGeometry.of(ball.outline, ConicalSeat.around(math.radians(45), ball).outline)
    sizes = element_sizes(LAW, [20e3], contact, effective_modulus(STEEL, STEEL))
    found = []
    for factor in (1, 2.5):
        model = condense(build_contact(contact, sizes.refined(factor)), {"closure": STEEL, "seat": STEEL})
        fields = body_fields(solve(model, LAW, contact_force=1257.0))
        found.append([float(field.von_mises.max()) for field in fields.values()])
    assert found[0] == pytest.approx(found[1], rel=3e-3)


def test_displaced_bodies_keep_the_gap(default: tuple[ContactModel, list[ContactSolution]]) -> None:
    """Gap from the bodies' own displacement fields: g0 - d n_z + n.(u_closure - u_seat)."""
    _, solutions = default
    ball = Ball(0.02)
    contact = ContactGeometry.of(ball.outline, ConicalSeat.around(math.radians(45), ball).outline)
    solution = solutions[1]
    fields = body_fields(solution)
    x = fields["seat"].contact_x
    normal = contact.normal(x)
    opening = [
        np.sum(normal * fields[name].displacement[fields[name].contact_nodes].T, axis=0)
        for name in ("closure", "seat")
    ]
    gap = contact.gap(x) - solution.approach * normal[1] + opening[0] - opening[1]
    inside = np.abs(x) < 3e-4
    expected = np.interp(x[inside], solution.profile.x, solution.profile.gap)
    assert gap[inside] == pytest.approx(expected, abs=1e-8)  # h^2/8R of linear interpolation


def test_untouched_places_are_as_far_apart_as_the_bodies_leave_them() -> None:
    """By the displacement fields, to round-off: where nothing is pressed a law has no part in it."""
    model, (force,) = ball_on_cone(LAW, [2e6], refine=0.5)
    solution = solve(model, replace(LAW, u0=2e-9), contact_force=force)
    untouched = solution.pressure == 0.0
    opening = model.line.initial_gap - solution.approach * model.line.normal[1]
    for name, body in model.bodies.items():
        opening = opening + body.fem.trace @ body.fem.normal_displacement(solution.displacements[name][0])
    assert untouched.sum() > 10
    assert solution.gap[untouched] == pytest.approx(opening[untouched], rel=1e-8)


def test_non_convergence_says_which_load_and_what_to_do() -> None:
    model, (force,) = ball_on_cone(LAW, [2e7])
    with pytest.raises(
        ConvergenceError, match=r"axial force .* did not converge in 2 iterations.*\[mesh\] contact_size"
    ):
        solve(model, LAW, contact_force=force, settings=ContactSettings(max_iterations=2))


@pytest.mark.parametrize("force", [0.0, -1.0, math.nan, math.inf])
def test_force_must_close_the_seal(force: float) -> None:
    model, _ = ball_on_cone(LAW, [2e6], refine=0.3)
    with pytest.raises(ValueError, match="contact_force"):
        solve(model, LAW, contact_force=force)


@pytest.mark.slow
def test_random_seals_all_converge() -> None:
    """A quarter of them on the elements that a case gets, the others on elements twice as large: as hard to solve."""
    rng = np.random.default_rng(20)
    for number in range(60):
        R, u0, p = (math.exp(rng.uniform(*np.log(b))) for b in ((1e-3, 0.05), (1e-9, 5e-5), (1e3, 5e8)))
        first, second = (
            Material("m", math.exp(rng.uniform(*np.log((1e9, 6e11)))), rng.uniform(0, 0.45)) for _ in "ab"
        )
        law = ExponentialLaw(p_c=5e9, u0=u0)
        angle = math.radians(rng.uniform(20, 70))
        model, (force,) = ball_on_cone(
            law,
            [p],
            radius=R,
            angle=angle,
            closure=first,
            seat=second,
            refine=1.0 if number % 4 == 0 else 0.5,
        )
        solution = solve(model, law, contact_force=force)
        assert abs(solution.force_error) < 1e-10
        assert solution.residuals[-1] < 1e-10


def test_a_soft_seal_under_an_all_but_rigid_law_meets_hertz() -> None:
    """One of those seals; 80 % of its contact line is pressed, and ln p falls by 1e5 over the rest."""
    radius, law = 0.0451, ExponentialLaw(p_c=5e9, u0=5.8e-9)
    closure, seat = Material("closure", 31.7e9, 0.135), Material("seat", 2.455e9, 0.426)
    model, (force,) = ball_on_cone(
        law, [28.56e6], radius=radius, angle=math.radians(49.36), closure=closure, seat=seat, refine=0.5
    )
    solution = solve(model, law, contact_force=force)
    hertz = math.sqrt(effective_modulus(closure, seat) * model.line_load(force) / (math.pi * radius))
    assert abs(solution.force_error) < 1e-10
    assert solution.profile.peak_pressure == pytest.approx(hertz, rel=0.02)


@pytest.mark.parametrize(("modulus", "pressure", "u0"), [(1e9, 2e6, 5e-10), (20e9, 30e6, 1e-11)])
def test_rigid_laws_carry_wherever_the_bodies_meet(modulus: float, pressure: float, u0: float) -> None:
    """Hertz's peak; a contact that leaves part of the faces without pressure in each other has 1.5 to 2 times it."""
    seat = Material("seat", modulus, 0.3)
    model, (force,) = ball_on_cone(LAW, [pressure], seat=seat, refine=0.5)
    solution = solve(model, ExponentialLaw(p_c=5e9, u0=u0), contact_force=force)
    hertz = math.sqrt(effective_modulus(STEEL, seat) * model.line_load(force) / (math.pi * 0.02))
    assert solution.profile.peak_pressure == pytest.approx(hertz, rel=0.02)


@pytest.mark.parametrize("u0", [2e-9, 2e-8])
def test_half_of_the_faces_that_start_without_pressure_carry_theirs(u0: float) -> None:
    """ln p rises by some ten in a step: the other half would be in balance long before, 3 times as high."""
    model, (force,) = ball_on_cone(LAW, [2e6], refine=0.5)
    law = ExponentialLaw(p_c=5e9, u0=u0)
    solution = solve(model, law, contact_force=force)
    half = replace(solution, log_pressure=np.where(model.line.x > 0, -1e4, solution.log_pressure))
    again = solve(model, law, contact_force=force, start=half)
    assert again.pressure == pytest.approx(solution.pressure, abs=1e-10 * solution.pressure.max())
    gap = model.line.initial_gap
    rigid = [
        solve_flattened(model, law, force, gap, (start.log_pressure, start.approach), 0.0, 1e-10)
        for start in (solution, half)
    ]
    assert rigid[0] is not None and rigid[1] is not None
    assert np.exp(rigid[1][0]) == pytest.approx(np.exp(rigid[0][0]), abs=1e-8 * np.exp(rigid[0][0].max()))


def test_contacts_moved_together_move_as_each_alone() -> None:
    model, forces = ball_on_cone(LAW, [2e6, 2e7])
    together, alone = ([solve(model, LAW, contact_force=force) for force in forces] for _ in range(2))
    move_together(together)
    for one, other in zip(together, alone, strict=True):
        for name, moved in other.displacements.items():
            assert one.displacements[name][0] == pytest.approx(moved[0], abs=1e-12 * np.abs(moved[0]).max())
            assert one.fields[name].von_mises == pytest.approx(other.fields[name].von_mises, rel=1e-9)
