"""Speed of the contact chain: mesh, condensation, and each further load once the bodies are condensed.

Run: pytest benchmarks/bench_contact.py --benchmark-only
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import pytest

from fem_seal.contact.model import ContactModel, condense
from fem_seal.contact.newton import solve
from fem_seal.contact.sizing import element_sizes
from fem_seal.materials import Material, effective_modulus
from leak import ExponentialLaw
from meshes import Ball, ConicalSeat, ContactGeometry, SealMesh, build

STEEL = Material("steel", 210e9, 0.3)
MATERIALS = {"closure": STEEL, "seat": STEEL}
RADIUS, ANGLE = 0.02, math.radians(45)
LAW = ExponentialLaw(p_c=5e9, u0=0.76e-6)
PRESSURES = [k * 1e5 for k in range(1, 21)]

Benchmark = Callable[..., Any]


def line_loads() -> list[float]:
    return [0.5 * RADIUS * p * math.tan(ANGLE) for p in PRESSURES]


def make_mesh() -> SealMesh:
    ball = Ball(RADIUS)
    seat = ConicalSeat.around(ANGLE, ball)
    contact = ContactGeometry.of(ball.outline, seat.outline)
    sizing = element_sizes(LAW, line_loads(), contact, effective_modulus(STEEL, STEEL))
    return build(ball, seat, sizing)


@pytest.fixture(scope="module")
def model() -> ContactModel:
    return condense(make_mesh(), MATERIALS)


def test_mesh(benchmark: Benchmark) -> None:
    assert benchmark(make_mesh).quality.smallest > 0.2


def test_condense(benchmark: Benchmark) -> None:
    mesh = make_mesh()
    assert benchmark(condense, mesh, MATERIALS).compliance.shape[0] > 50


def test_mesh_to_profile(benchmark: Benchmark) -> None:
    def chain() -> float:
        model = condense(make_mesh(), MATERIALS)
        return solve(model, LAW, contact_force=1256.6).profile.peak_pressure

    assert benchmark(chain) == pytest.approx(61.67e6, rel=1e-3)


def test_each_further_load(benchmark: Benchmark, model: ContactModel) -> None:
    assert benchmark(solve, model, LAW, contact_force=1256.6).iterations < 8


def test_twenty_loads(benchmark: Benchmark, model: ContactModel) -> None:
    forces = [math.pi * model.initial_contact_radius**2 * p for p in PRESSURES]
    solutions = benchmark(lambda: [solve(model, LAW, contact_force=force) for force in forces])
    assert len(solutions) == 20
