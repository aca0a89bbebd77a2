"""Fluid that gets between the surfaces: loads, coupled contact and flow, blow-off - against what mechanics says."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from contact_models import STEEL, ball_on_cone
from sample_results import run_loads
from scipy.sparse.linalg import spsolve

import fem_seal
import leak
import meshes
from fem_seal import HardContact, solve
from fem_seal.bodies.elasticity import (
    boundary_dofs,
    node_dofs,
    pressure_load,
    quadratic_nodes,
    stiffness_matrix,
)
from fem_seal.bodies.supports import Supports
from fem_seal.contact.fixed_point import first_fixed_point, fixed_point
from fem_seal.contact.model import BodyLoads, condense
from fem_seal.contact.penetration import (
    CoupledContact,
    FluidAtContact,
    PenetratingFluid,
    blow_off_pressure,
    effective_radius,
    solve_at_contact_force,
    solve_penetration,
)
from fem_seal.errors import ConvergenceError, OpenSealError
from fem_seal.seal.problem import SealProblem, condense_bodies, size_mesh
from meshes import build_contact

LAW = leak.ExponentialLaw(p_c=10e9, u0=0.76e-6)
PRESSURE = 20e5


@cache
def model(fluid_pressure=PRESSURE):
    return ball_on_cone(LAW, [fluid_pressure])[0]


@cache
def hard_model():
    return ball_on_cone(HardContact(), [200e5])[0]


def power_law(side, exponent=1.0):
    """A liquid through sigma = B p^-m; its pressure does not depend on B."""

    def along(profile, fluid_pressure):
        flow = leak.leak_flow(
            profile.x,
            profile.pressure,
            lambda p: p**-exponent,
            fluid_pressure,
            profile.radius,
            pressure_side=side,
        )
        return flow.fluid_pressure

    return PenetratingFluid(along, math.inf, side)


def places(body):
    return quadratic_nodes(body.fem.mesh)[0]


# ---------------------------------------------------------------- the loads alone


def test_fluid_all_around_the_closure_lifts_nothing_and_shrinks_it_evenly():
    closure, line, p = model().closure, model().line, 100e5
    loads = BodyLoads.of_fluid((p, p), np.full_like(line.x, p))
    # of 12.6 kN on the ball's section
    assert abs(loads.lift(model())) < 1e-9
    moved = loads.displacement(closure, model())[node_dofs(closure.fem.mesh)]
    strain = -p * (1 - 2 * STEEL.poissons_ratio) / STEEL.youngs_modulus
    r, z = places(closure).T
    # The contact line lies on the seat, up to 21 um off the ball: what that shifts is felt nearby only.
    zone = line.vertices[-1] - line.vertices[0]
    far = np.hypot(r - model().initial_contact_radius, z) > 3 * zone
    rigid = np.mean(moved[1][far] - strain * z[far])
    assert np.abs(moved[0] - strain * r)[far].max() < 3e-3 * abs(strain) * 0.02
    assert np.abs(moved[1] - rigid - strain * z)[far].max() < 3e-3 * abs(strain) * 0.02


# What two bodies of different shape need for one: a line that ends in a fillet, a gap of millimetres at its end.
POPPET = {"shape": "cone", "angle": "45 deg", "inner_radius": "5 mm", "outer_radius": "10 mm"}
LAND = {"shape": "conical-land", "angle": "45 deg", "land_width": "1 mm"}
BALL = {"shape": "ball", "radius": "10 mm"}


def wetted(closure, seat, refine=1.0, **load):
    """Case with the fluid in the bore, and its model."""
    case = fem_seal.Case(
        closure={**closure, "material": "steel"},
        seat={**seat, "material": "steel"},
        interface={"law": "exponential", "u0": "0.5 um", "p_c": "10 GPa"},
        load={"fluid_pressure": "10 bar", "pressure_side": "inner", "closing": "penetration", **load},
    )
    problem = SealProblem.of(case)
    return case, condense_bodies(problem, build_contact(problem.contact, size_mesh(problem).refined(refine)))


def unevenness(model, p):
    """How far the stress of the closure is from -p at each node under fluid all around, over p."""
    loads = BodyLoads.of_fluid((p, p), np.full_like(model.line.x, p))
    # round-off of places on faces that fit to a thousandth
    assert abs(loads.lift(model)) < 1e-8 * p * math.pi * 0.01**2
    stress = model.closure.recovery.stress(loads.displacement(model.closure, model))
    return np.abs(stress / p - [-1, -1, -1, 0]).max(axis=1)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("closure", "seat"),
    [
        (POPPET, LAND),
        (BALL, {"shape": "sphere", "radius": "10 mm"}),
        (BALL, {"shape": "sphere", "radius": "10.01 mm", "contact_angle": "45 deg"}),
        (BALL, {"shape": "sharp-edge", "bore_radius": "7 mm", "edge_radius": "0.2 mm"}),
        (BALL, {"shape": "cone", "angle": "45 deg"}),
    ],
)
def test_fluid_all_around_leaves_a_closure_of_any_shape_under_even_pressure(closure, seat):
    off, finer = (unevenness(wetted(closure, seat, n, applied_force="1.5 kN")[1], 10e5) for n in (0.7, 1.4))
    # Straight edges against true arcs: of first order at the end of the line, where a ball stands 4 mm off its seat and
    # elements are large, of second order in the mean.
    assert off.max() < 2e-2
    assert off.mean() < 1e-3
    # Under a straight face nothing is left but round-off.
    assert finer.max() < max(0.7 * off.max(), 1e-9)
    assert finer.mean() < max(0.4 * off.mean(), 1e-10)


@pytest.mark.slow
def test_fluid_all_around_a_closure_with_facets_across_the_ends_of_the_line_lifts_nothing(tmp_path):
    """A ready mesh keeps its facets: those of the closure reach beyond the contact line by up to 0.2 mm here."""
    cone = {"shape": "cone", "angle": "45 deg"}
    case, _ = wetted(BALL, cone, applied_force="1.5 kN")
    coarse = meshes.Sizing(2e-4, 1e-3, (-2e-3, 2e-3), 0.1, 0.3, 2e-3)
    build_contact(case.contact, coarse).write(tmp_path / "coarse.msh")
    drawn = {"shape": "profile", "file": str(tmp_path / "coarse.msh")}
    _, model = wetted(drawn, cone, applied_force="1.5 kN")
    p = 10e5
    loads = BodyLoads.of_fluid((p, p), np.full_like(model.line.x, p))
    # round-off of 310 N on the ball's section; the strips beyond the line would be 5 N
    assert abs(loads.lift(model)) < 1e-6


@pytest.mark.slow
@pytest.mark.parametrize("seat", [LAND, {"shape": "conical-land", "angle": "45 deg", "land_width": "2 mm"}])
def test_a_poppet_on_its_land_opens_where_the_fluid_carries_the_spring(seat):
    case, _ = wetted(POPPET, seat, applied_force="1.5 kN")
    (load,) = run_loads(case).loads
    # No flow is known: the fluid gets through once the land nowhere presses harder. It then reaches over the bore at
    # least, and over the whole land at most, which carries as much once more.
    r0, half = case.initial_contact_radius, 0.5 * case.seat.land_width * math.sqrt(0.5)
    most = math.pi * ((r0 + half) ** 2 + 4 * r0 * half)
    assert 1500 / most < load.blow_off_pressure < 1500 / (math.pi * (r0 - half) ** 2)
    assert load.max_von_mises < load.contact.profile.peak_pressure


def test_fluid_all_around_a_seat_whose_wall_gives_way_shrinks_it_evenly():
    ball = meshes.Ball(0.02)
    cone = meshes.ConicalSeat.around(math.radians(45), ball)
    coarse = meshes.Sizing(2e-4, 5e-4, (-1e-3, 1e-3), 0.2, 0.4, 4e-3)
    built = meshes.build(ball, cone, coarse)
    held = condense(built, {"closure": STEEL, "seat": STEEL}, Supports(wall="fixed"))
    p = 100e5
    strain = p * (1 - 2 * STEEL.poissons_ratio) / STEEL.youngs_modulus
    loads = BodyLoads(
        seat={0: p, 1: p, "wall": strain * cone.outer_radius},
        gap_pressure=np.full_like(held.line.x, p),
    )
    seat = held.seat
    moved = loads.displacement(seat, held)
    r, z = places(seat).T
    dofs = node_dofs(seat.fem.mesh)
    scale = strain * cone.outer_radius
    # A linear field: the elements hold it exactly, up to the round-off of the factorisation.
    assert np.abs(moved[dofs[0]] + strain * r).max() < 1e-8 * scale
    assert np.abs(moved[dofs[1]] + strain * (z - z.min())).max() < 1e-8 * scale
    stress = seat.recovery.stress(moved)
    assert np.abs(stress - [-p, -p, -p, 0]).max() < 1e-6 * p


@pytest.mark.parametrize("side", ["outer", "inner"])
def test_fluid_up_to_a_circle_acts_on_the_area_of_that_circle(side):
    line = model().line
    a, b = (float(np.interp(x, line.x, line.radius)) for x in (line.vertices[20], line.vertices[30]))
    rising = np.clip((line.radius - a) / (b - a), 0.0, 1.0)
    share = rising if side == "outer" else 1 - rising
    inner, outer = (PRESSURE, 0.0) if side == "inner" else (0.0, PRESSURE)
    lift = BodyLoads.of_fluid((inner, outer), PRESSURE * share).lift(model())
    # Divergence theorem: pi int r^2 dp, p linear in r between the circles a and b.
    area = math.pi * (a**2 + a * b + b**2) / 3
    assert lift == pytest.approx((1 if side == "inner" else -1) * PRESSURE * area, rel=1e-10)


def test_bodies_move_as_in_one_solve_under_all_loads():
    line = model().line
    loads = BodyLoads.of_fluid((0.0, PRESSURE), PRESSURE * (line.x > 0))
    solution = solve(model(), LAW, contact_force=1000.0, loads=loads)
    seat = model().seat
    dofs = node_dofs(seat.fem.mesh)
    force = pressure_load(seat.fem.mesh, "seat_outer") * PRESSURE
    normal = np.stack([np.interp(seat.fem.contact_x, line.x, component) for component in line.normal])
    pressed = seat.fem.trace.T @ (line.area_weight * (solution.pressure + PRESSURE * (line.x > 0)))
    force[dofs[:, seat.fem.contact_nodes]] -= normal * pressed
    free = np.setdiff1d(np.arange(seat.fem.size), boundary_dofs(seat.fem.mesh, "seat_bottom", 1))
    stiffness = stiffness_matrix(seat.fem.mesh, STEEL)
    moved = np.zeros(seat.fem.size)
    moved[free] = spsolve(stiffness[free][:, free].tocsc(), force[free])
    assert solution.fields["seat"].displacement == pytest.approx(moved[dofs].T, abs=1e-9 * np.ptp(moved))


# ---------------------------------------------------------------- contact and fluid together


@pytest.mark.parametrize("path", [power_law("inner"), power_law("outer"), FluidAtContact("inner")])
def test_without_pressure_the_spring_alone_remains(path):
    spring = 1500.0
    alone = solve(model(), LAW, contact_force=spring)
    wet = solve_penetration(CoupledContact(model(), LAW, path), applied_force=spring, fluid_pressure=1.0)
    # 1 Pa on 6e-4 m^2 is 4e-7 of the spring's force
    assert wet.pressure == pytest.approx(alone.pressure, rel=1e-6)


@pytest.mark.parametrize("side", ["outer", "inner"])
@pytest.mark.parametrize("fluid_pressure", [2e5, 20e5])
def test_spring_fluid_and_contact_are_in_balance(side, fluid_pressure):
    spring = 2000.0
    seal = CoupledContact(model(), LAW, power_law(side))
    solution = solve_penetration(seal, applied_force=spring, fluid_pressure=fluid_pressure)
    line = model().line
    # By hand: contact and fluid on the ring of the contact line, fluid on the closure inside and outside of it.
    pressed = solution.pressure + solution.loads.gap_pressure
    ring = 2 * math.pi * float(line.arc_weight @ (line.radius * pressed * math.cos(math.radians(45))))
    ends = 0.02 * math.sin(math.radians(45)) + line.vertices[[0, -1]] * math.cos(math.radians(45))
    area = -(ends[1] ** 2) if side == "outer" else ends[0] ** 2
    assert ring + math.pi * area * fluid_pressure == pytest.approx(spring, rel=1e-10)
    assert abs(solution.force_error) < 1e-12
    # The fluid pressure is the one that flows through just this contact.
    again = seal.path.unknowns_of(solution.profile, fluid_pressure)
    assert solution.loads.gap_pressure / fluid_pressure == pytest.approx(again, abs=2e-9)


def test_a_liquid_acts_up_to_the_middle_of_the_contact_and_a_gas_against_vacuum_further():
    def gas(profile, fluid_pressure):
        liquid = power_law("outer").unknowns_of(profile, fluid_pressure)
        return fluid_pressure * np.sqrt(liquid)  # p_f^2 falls along the resistance

    liquid, thin = (
        solve_penetration(CoupledContact(model(), LAW, path), applied_force=0.0, fluid_pressure=PRESSURE)
        for path in (power_law("outer"), PenetratingFluid(gas, math.inf, "outer"))
    )
    profile = liquid.profile
    middle = float(np.interp(profile.centroid, profile.x, profile.radius))
    std = profile.std * math.cos(math.radians(45))
    radius = effective_radius(liquid, PRESSURE)
    # The resistance p is as wide as the profile and as symmetric: half of the pressure is left in the middle.
    assert radius == pytest.approx(middle, abs=0.02 * std)
    # For a Gaussian resistance the mean place of the drop of sqrt(share) lies 0.56 standard deviations inwards.
    share = np.linspace(0, 1, 20001)[1:-1]
    shift = np.mean(np.interp(share**2, *_normal_distribution()))
    assert radius - effective_radius(thin, PRESSURE) == pytest.approx(-shift * std, rel=0.05)
    # with it goes the force: F = pi r^2 p
    assert thin.contact_force == pytest.approx(math.pi * effective_radius(thin, PRESSURE) ** 2 * PRESSURE)


def _normal_distribution():
    from scipy.stats import norm

    x = np.linspace(-6, 6, 2001)
    return norm.cdf(x), x


def test_fluid_beside_the_contact_raises_the_peak_pressure():
    high = model(200e5)
    force = math.pi * high.initial_contact_radius**2 * 200e5
    spread = BodyLoads(closure={"outer": 200e5})
    raised = solve(high, LAW, contact_force=force, loads=spread).profile.peak_pressure
    from_the_top = solve(high, LAW, contact_force=force).profile.peak_pressure
    # 8e-4 when the closing force itself is spread over the closure down to the contact
    assert raised / from_the_top - 1 == pytest.approx(8e-4, abs=1.5e-4)


def test_a_held_fluid_gets_to_where_the_contact_presses_as_hard():
    for law, bodies, pressure in ((LAW, model(), PRESSURE), (HardContact(), hard_model(), 200e5)):
        seal = CoupledContact(bodies, law, FluidAtContact("outer"))
        solution = solve_penetration(seal, applied_force=0.0, fluid_pressure=pressure)
        dry = solution.loads.gap_pressure == 0
        wet = solution.loads.gap_pressure == pressure
        element = np.diff(bodies.line.vertices).max()
        edge = bodies.line.x[dry][-1]
        assert bodies.line.x[wet][0] - edge < 2 * element
        assert solution.pressure[dry].max() > pressure
        assert solution.pressure[wet].max() < 1.5 * pressure
        assert solution.applied_force == pytest.approx(0.0, abs=1e-9 * solution.contact_force)


@pytest.mark.parametrize("strained", [1.0, 2.0])
def test_where_the_contact_is_sealed_the_pressure_falls_in_the_sealed_part(strained):
    """Over strained metal where the pressure that acts seals, here twice that of the contact."""
    contact = solve(model(), LAW, contact_force=1000.0)
    profile = contact.profile
    limit = 0.5 * profile.peak_pressure
    path = PenetratingFluid(
        lambda *_: pytest.fail("nothing flows"),
        strained * limit,
        "outer",
        at_rest=lambda profile: replace(profile, pressure=strained * profile.pressure),
    )
    share = path.unknowns_of(profile, PRESSURE)
    assert (share[(profile.x < 0) & (profile.pressure < 0.99 * limit)] == 0).all()
    assert (share[(profile.x > 0) & (profile.pressure < 0.99 * limit)] == 1).all()
    # evenly over the width at half of the peak
    inside = (share > 0) & (share < 1)
    slope = np.diff(share[inside]) / np.diff(profile.x[inside])
    assert slope == pytest.approx(1 / profile.fwhm, rel=2e-3)


def test_force_and_pressure_are_two_ways_to_the_same_contact():
    seal = CoupledContact(model(), LAW, power_law("inner"))
    given = solve_penetration(seal, applied_force=2000.0, fluid_pressure=PRESSURE)
    back = solve_at_contact_force(seal, contact_force=given.contact_force, fluid_pressure=PRESSURE)
    assert back.applied_force == pytest.approx(2000.0, rel=1e-9)


# ---------------------------------------------------------------- blow-off


@pytest.mark.parametrize("path", [power_law("inner"), FluidAtContact("inner")])
def test_blow_off_is_where_the_fluid_carries_the_spring(path):
    spring = 1500.0
    seal = CoupledContact(model(), LAW, path)
    opens = blow_off_pressure(seal, applied_force=spring)
    just_before = solve_penetration(seal, applied_force=spring, fluid_pressure=0.999 * opens)
    radius = effective_radius(just_before, 0.999 * opens)
    left = just_before.contact_force / spring
    # pi r^2 p = spring less what the contact still carries
    assert math.pi * radius**2 * 0.999 * opens == pytest.approx((1 - left) * spring, rel=1e-9)
    # within the contact, three standard deviations wide
    std = just_before.profile.std
    assert radius == pytest.approx(model().initial_contact_radius, abs=3 * std)
    with pytest.raises(OpenSealError, match="lifts the closure off") as failure:
        solve_penetration(seal, applied_force=spring, fluid_pressure=1.001 * opens)
    assert failure.value.blow_off_pressure == pytest.approx(opens, rel=1e-4)


def test_flow_lets_the_contact_go_at_the_sealed_area():
    spring = 1500.0
    opens = blow_off_pressure(CoupledContact(model(), LAW, power_law("inner")), applied_force=spring)
    # the last contact is symmetric about first touch, to a share of its width of 0.3 mm in 14 mm
    assert opens == pytest.approx(spring / (math.pi * model().initial_contact_radius ** 2), rel=1e-3)


def test_pressure_from_outside_never_lifts():
    seal = CoupledContact(model(), LAW, power_law("outer"))
    assert blow_off_pressure(seal, applied_force=100.0) == math.inf
    with pytest.raises(OpenSealError, match="nothing is left"):
        solve_penetration(seal, applied_force=-3000.0, fluid_pressure=PRESSURE)


# ---------------------------------------------------------------- fixed points


def test_anderson_solves_a_linear_map_that_plain_iteration_cannot():
    rng = np.random.default_rng(1)
    directions = np.linalg.qr(rng.normal(size=(40, 3)))[0]
    A = directions @ np.diag([-3.0, 0.9, 2.0]) @ directions.T
    b = rng.uniform(0.4, 0.6, 40)
    found, residuals = fixed_point(
        lambda x: A @ x + b, np.zeros(40), tolerance=1e-12, bounds=(-100, 100), max_iterations=12
    )
    assert found == pytest.approx(np.linalg.solve(np.eye(40) - A, b), abs=1e-10)
    assert residuals[-1] <= 1e-12


def test_fixed_points_that_do_not_exist_are_no_results():
    with pytest.raises(ConvergenceError, match="no fixed point after 20"):
        fixed_point(
            lambda x: np.where(x < 0.5, 1.0, 0.0),
            np.full(3, 0.2),
            tolerance=1e-9,
            bounds=(0, 1),
            max_iterations=20,
        )
    with pytest.raises(ConvergenceError, match="no fixed point"):
        first_fixed_point(lambda x: x + 1, 0.0, tolerance=1e-9, jump=0.1)
    with pytest.raises(ConvergenceError, match="no fixed point"):
        first_fixed_point(lambda x: 3.0 if x < 1 else -3.0, 0.0, tolerance=1e-9, jump=0.1)


def test_the_first_of_two_fixed_points_is_taken():
    # x = x + (x - 1)(x - 2): from zero on the first is at one
    found = first_fixed_point(lambda x: x + 0.2 * (x - 1) * (x - 2), 0.0, tolerance=1e-10, jump=1e-3)
    assert found == pytest.approx(1.0, abs=1e-9)
