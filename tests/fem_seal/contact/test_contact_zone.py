"""The mesh that is fitted to the contact found on it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import pytest
from contact_models import STEEL

import meshes
from fem_seal.contact.laws import HardContact
from fem_seal.contact.model import condense
from fem_seal.contact.newton import solve
from fem_seal.contact.sizing import MeshFit, better_sizing, element_sizes
from fem_seal.contact.solution import ContactSolution
from fem_seal.errors import ConvergenceError
from fem_seal.materials import effective_modulus
from fem_seal.profile import PressureProfile
from leak import ExponentialLaw
from meshes import Ball, ConicalSeat, ContactGeometry, SharpEdge, Sizing
from meshes.mesh.triangles import doubled_area, triangle_shape

LAW = ExponentialLaw(p_c=5e9, u0=0.76e-6)
FORCE = 1256.0
BALL = Ball(0.02)
CONTACT = ContactGeometry.of(BALL.outline, ConicalSeat.around(math.radians(45), BALL).outline)
LINE_LOAD = FORCE / (2 * math.pi * CONTACT.initial_contact_radius * math.cos(CONTACT.angle))


def solver(tried: list[Sizing]) -> Callable[[Sizing], Sequence[ContactSolution]]:
    def solve_on(sizing: Sizing) -> Sequence[ContactSolution]:
        tried.append(sizing)
        model = condense(meshes.build_contact(CONTACT, sizing), {"closure": STEEL, "seat": STEEL})
        return [solve(model, LAW, contact_force=FORCE)]

    return solve_on


def solve_fitted(
    sizing: Sizing, solve_on: Callable[[Sizing], Sequence[ContactSolution]], *, size_given: bool = False
) -> Sequence[ContactSolution]:
    """Contacts on the last of the meshes that are tried."""
    fit = MeshFit.begin(sizing, CONTACT, size_given=size_given)
    while fit.sizing is not None:
        try:
            fit = fit.with_outcome(solve_on(fit.sizing))
        except ConvergenceError as error:
            fit = fit.with_outcome(error)
    return fit.solutions


@pytest.fixture(scope="module")
def expected() -> tuple[Sizing, PressureProfile]:
    sizing = element_sizes(LAW, [LINE_LOAD], CONTACT, effective_modulus(STEEL, STEEL))
    tried: list[Sizing] = []
    (solution,) = solve_fitted(sizing, solver(tried))
    assert tried == [sizing]  # a ball on a cone is foreseen exactly: no second mesh
    return sizing, solution.profile


def test_a_zone_that_cuts_the_contact_off_grows(expected: tuple[Sizing, PressureProfile]) -> None:
    sizing, profile = expected
    tried: list[Sizing] = []
    (solution,) = solve_fitted(replace(sizing, zone=(-2e-4, 4e-4)), solver(tried))
    assert len(tried) > 1
    ends = solution.profile.pressure[[0, -1]] / solution.profile.peak_pressure
    assert ends.max() < 1e-6
    # the mesh outside the core differs: within the discretisation error of 3e-5
    assert solution.profile.peak_pressure == pytest.approx(profile.peak_pressure, rel=1e-4)
    assert solution.profile.std == pytest.approx(profile.std, rel=1e-4)


def test_the_zone_ends_with_the_faces(expected: tuple[Sizing, PressureProfile]) -> None:
    sizing, profile = expected
    narrow = ConicalSeat.around(
        math.radians(45), BALL, bore_radius=0.0140, face_radius=0.0143, outer_radius=0.04
    )
    contact = ContactGeometry.of(BALL.outline, narrow.outline)
    lower, upper = contact.reach
    better = better_sizing(replace(sizing, zone=(0.9 * lower, 0.9 * upper)), contact, [profile])
    assert better is None  # the pressure found is nil at its ends, so nothing asks for a wider zone
    full = replace(profile, pressure=np.full_like(profile.pressure, 1e6))
    better = better_sizing(replace(sizing, zone=(0.9 * lower, 0.9 * upper)), contact, [full])
    assert better is not None
    assert better.zone == pytest.approx((lower, upper))


def test_elements_that_skip_over_the_pressure_become_smaller(
    expected: tuple[Sizing, PressureProfile],
) -> None:
    sizing, profile = expected
    tried: list[Sizing] = []
    coarse = replace(sizing, contact_size=6 * profile.std, far_size=1e-2, core=0.0)
    (solution,) = solve_fitted(coarse, solver(tried))
    assert np.diff(solution.model.line.vertices).min() < profile.std
    assert solution.profile.peak_pressure == pytest.approx(profile.peak_pressure, rel=5e-3)


def test_a_given_element_size_stays(expected: tuple[Sizing, PressureProfile]) -> None:
    sizing, profile = expected
    coarse = replace(sizing, contact_size=6 * profile.std, far_size=1e-2, core=0.0)
    tried: list[Sizing] = []
    solve_fitted(coarse, solver(tried), size_given=True)
    assert {s.contact_size for s in tried} == {coarse.contact_size}
    assert not any(s.spots for s in tried)


def test_no_convergence_is_tried_once_more_on_a_finer_mesh(expected: tuple[Sizing, PressureProfile]) -> None:
    sizing, _ = expected
    tried: list[Sizing] = []

    def never(sizing: Sizing) -> Sequence[ContactSolution]:
        tried.append(sizing)
        raise ConvergenceError("contact did not converge")

    with pytest.raises(ConvergenceError, match="did not converge"):
        solve_fitted(sizing, never)
    assert [s.contact_size for s in tried] == [sizing.contact_size, sizing.contact_size / 2]


@pytest.mark.parametrize(
    ("bore", "edge", "ratio"),
    [
        (0.0020, 1.0e-6, 1.3),
        (0.0050, 1.1e-6, 1.8),
        (0.0137, 5.0e-6, 1.15),
        (0.0350, 1.0e-6, 2.0),
        (0.035, 27e-6, 1.2),
    ],
)
def test_a_sharp_edge_is_meshed_as_it_is(bore: float, edge: float, ratio: float) -> None:
    """An edge 3e-5 to 8e-4 times the bore: all of it is in front of the ball, and area and volume are the seat's."""
    ball = Ball(ratio * bore)
    seat = SharpEdge.around(bore, ball, edge_radius=edge)
    contact = ContactGeometry.of(ball.outline, seat.outline)
    # up to a thousandth of the whole arc
    arc = math.pi / 2 * edge
    assert contact.reach[0] == pytest.approx(edge * contact.angle - arc, rel=0.0, abs=1.01e-3 * arc)
    wide = element_sizes(ExponentialLaw(p_c=5e9, u0=edge), [1e3], contact, effective_modulus(STEEL, STEEL))
    body = meshes.build_contact(contact, wide).seat
    r, t = body.p[0], body.t
    area = 0.5 * np.abs(doubled_area(body.p, t))
    # what the rounding takes off the corner: a square without a quarter of a circle
    square, quarter = edge**2, math.pi / 4 * edge**2
    taken = square * (bore + edge / 2) - quarter * (bore + edge - 4 * edge / (3 * math.pi))
    whole = seat.outer_radius - bore, seat.outer_radius**2 - bore**2
    # chords of a twelfth of the arc, or less, cut 0.3 % off the quarter
    cut = 3e-3 * quarter + 1e-14 * area.sum()
    assert area.sum() == pytest.approx(whole[0] * seat.height - (square - quarter), rel=0.0, abs=cut)
    volume = 2 * math.pi * float(area @ r[t].mean(axis=0))
    exact = math.pi * whole[1] * seat.height - 2 * math.pi * taken
    assert volume == pytest.approx(exact, rel=1e-12, abs=2 * math.pi * bore * 1.01 * cut)
    assert triangle_shape(body.p, t).min() > 0.4


def test_a_sharp_edge_is_pressed_as_hertz_says() -> None:
    """R_rel = 1/(1/R + 1/edge_radius), half-width 5 % of an edge radius that is a ten-thousandth of the bore."""
    bore, edge, ball = 0.01, 1e-6, Ball(0.018)
    contact = ContactGeometry.of(ball.outline, SharpEdge.around(bore, ball, edge_radius=edge).outline)
    modulus, radius, half_width = effective_modulus(STEEL, STEEL), 1 / (1 / 0.018 + 1 / edge), 0.05 * edge
    line_load = math.pi * modulus * half_width**2 / (4 * radius)
    sizing = element_sizes(HardContact(), [line_load], contact, modulus)
    model = condense(meshes.build_contact(contact, sizing), {"closure": STEEL, "seat": STEEL})
    found = solve(
        model,
        HardContact(),
        contact_force=line_load * 2 * math.pi * contact.initial_contact_radius * math.cos(contact.angle),
    )
    # (half_width/edge)^2/9 of the arc's own curvature, and what the mesh is worth
    peak = math.sqrt(modulus * line_load / (math.pi * radius))
    assert found.profile.peak_pressure == pytest.approx(peak, rel=1e-3)
    assert found.profile.std == pytest.approx(half_width / 2, rel=1e-3)


def test_a_layer_as_thick_as_the_edge_radius_wedges_nothing() -> None:
    """Edge of 13 um at a bore, rough layer of 180 um: the ball stands above the edge, not in the bore."""
    ball = Ball(5.75e-3)
    contact = ContactGeometry.of(ball.outline, SharpEdge.around(4.16e-3, ball, edge_radius=12.75e-6).outline)
    law, materials = ExponentialLaw(p_c=5e9, u0=13e-6), {"closure": STEEL, "seat": STEEL}
    sizing = element_sizes(law, [10.0], contact, effective_modulus(STEEL, STEEL))
    model = condense(meshes.build_contact(contact, sizing), materials)
    profile = solve(model, law, contact_force=1.0).profile
    assert abs(profile.x[np.argmax(profile.pressure)]) < 1e-6
    # that of a parabola of this radius is 13 um; the face beyond the edge bends no more
    assert profile.std < 20e-6
