"""Weights and line load of the contact line, on a seat whose face turns away from the contact normal."""

from __future__ import annotations

import math

import numpy as np
import pytest
from contact_models import STEEL

import meshes
from fem_seal.bodies.elasticity import node_dofs
from fem_seal.contact.laws import HardContact
from fem_seal.contact.model import ContactModel, condense
from fem_seal.contact.newton import solve
from fem_seal.contact.sizing import element_sizes
from fem_seal.materials import effective_modulus

EDGE_RADIUS = 0.1e-3
LINE_LOAD = 1e6
BALL = meshes.Ball(5e-3)


@pytest.fixture(scope="module")
def model() -> ContactModel:
    """A ball on an edge, with small elements far around the edge."""
    seat = meshes.SharpEdge.around(4e-3, BALL, edge_radius=EDGE_RADIUS)
    contact = meshes.ContactGeometry.of(BALL.outline, seat.outline)
    sizing = element_sizes(HardContact(), [LINE_LOAD], contact, effective_modulus(STEEL, STEEL))
    return condense(meshes.build(BALL, seat, sizing), {"closure": STEEL, "seat": STEEL})


def angle_of_contact() -> float:
    """theta at sin(theta) = c/(R + rho), see `meshes.SharpEdge`."""
    return math.asin((4e-3 + EDGE_RADIUS) / (BALL.radius + EDGE_RADIUS))


def area_across(x: np.ndarray) -> np.ndarray:
    """2 pi int r cos(x/rho) dx from first touch: area of a strip of the edge, seen along the contact normal [m^2].

    On the edge r = r0 + rho sin(x/rho) cos(theta) + rho (1 - cos(x/rho)) sin(theta).
    """
    rho, theta = EDGE_RADIUS, angle_of_contact()
    r0 = BALL.radius * math.sin(theta)
    s, c = np.sin(x / rho), np.cos(x / rho)
    along = rho**2 * math.cos(theta) * s**2 / 2 + rho**2 * math.sin(theta) * (s - x / (2 * rho) - s * c / 2)
    return 2 * np.pi * (r0 * rho * s + along)


def on_edge(model: ContactModel) -> tuple[np.ndarray, np.ndarray]:
    """Ends of the elements on the round of the edge, and for each point of the contact line whether it lies there."""
    far = 0.6 * EDGE_RADIUS
    ends = model.line.vertices[np.abs(model.line.vertices) < far]
    return ends, (model.line.x > ends[0]) & (model.line.x < ends[-1])


def test_area_of_a_strip_is_what_is_seen_along_the_contact_normal(model: ContactModel) -> None:
    ends, inside = on_edge(model)
    assert ends[-1] - ends[0] > 0.8 * EDGE_RADIUS  # the face has turned by more than 20 degrees at each end
    exact = area_across(ends[-1]) - area_across(ends[0])
    assert model.line.area_weight[inside].sum() == pytest.approx(exact, rel=1e-9)


def test_even_pressure_on_a_strip_presses_the_seat_with_its_area_along_the_axis(model: ContactModel) -> None:
    ends, inside = on_edge(model)
    held = model.seat.fem
    force = held.nodal_forces(np.where(inside, 1e6, 0.0) * model.line.area_weight)
    area = area_across(ends[-1]) - area_across(ends[0])
    axial = force[node_dofs(held.mesh)[1]].sum()
    assert abs(axial) == pytest.approx(1e6 * area * math.cos(angle_of_contact()), rel=1e-9)


def test_line_load_is_the_pressure_along_the_contact_normal(model: ContactModel) -> None:
    """int p r/r0 cos(x/rho) dx = f_N: nothing of the force is lost where the face has turned away."""
    r0 = BALL.radius * math.sin(angle_of_contact())
    found = solve(
        model, HardContact(), contact_force=LINE_LOAD * 2 * np.pi * r0 * math.cos(angle_of_contact())
    )
    assert found.line_load == pytest.approx(LINE_LOAD, rel=1e-9)
    line = model.line
    turned = np.cos(line.x / EDGE_RADIUS)
    carried = float((found.pressure * line.radius / r0 * turned * line.arc_weight).sum())
    assert found.line_load == pytest.approx(carried, rel=1e-6)
    assert turned[found.pressure > 0.01 * found.pressure.max()].min() < 0.995
