"""What a case poses: its loads, and variants of it without the tables of a case file."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from sample_results import case, cone, rough_result, run_loads, single_result

import fem_seal
from fem_seal.bodies.supports import Supports
from fem_seal.contact.laws import HardContact
from fem_seal.errors import Problem
from fem_seal.seal.leak_model import FlowModel, log_peaks
from fem_seal.seal.problem import Loads, SealProblem, expected_forces, larger_housing


def test_what_is_left_of_the_loads_keeps_its_reasons():
    points = ((1e5, 0.0), (2e5, 10.0), (3e5, 20.0), (4e5, 30.0))
    reasons = {1: Problem("load", "a", kind="open"), 3: Problem("load", "b")}
    left = Loads(points, refusals=reasons).without_loads({0, 1})
    assert left.points == points[2:] and left.fluid_pressure == (3e5, 4e5)
    assert left.refusals == {1: reasons[3]}
    assert Loads(points, refusals=reasons).without_loads(()).refusals == reasons


def test_loads_that_leave_the_seal_open_size_nothing():
    lifted = case(
        load={"fluid_pressure": ["5 bar", "20 bar"], "applied_force": "1 kN", "pressure_side": "inner"}
    )
    problem = SealProblem.of(lifted)
    area = math.pi * problem.initial_contact_radius**2
    assert list(problem.loads.refusals) == [1]
    assert expected_forces(problem) == pytest.approx([1e3 - 5e5 * area], rel=1e-12)


def test_case_and_problem_of_a_result_have_the_same_loads():
    mixed = case(
        load={"fluid_pressure": ["2 bar", "20 bar", "5 bar"], "applied_force": ["0 N", "-1 MN", "0 N"]}
    )
    result = fem_seal.run(mixed)
    assert result.problem.loads.points == result.case.load.points == ((2e5, 0.0), (5e5, 0.0))
    assert mixed.load.fluid_pressure == (2e5, 20e5, 5e5)


def test_a_variant_of_a_problem_leaks_as_a_case_that_asks_for_it():
    """Fluid that opens the gap, with the contact as it is: the same number as that of a run of the changed case."""
    result, changed = single_result(), {"leak.fluid_in_gap": "local"}
    problem = result.problem
    flow = replace(problem.flow, fluid_in_gap="local")
    (load,) = result.loads
    table = flow.table_around(problem.surface, log_peaks(result.contact, problem.surface))
    found = flow.leak_of(table, problem.surface, load.contact.profile, load.fluid_pressure).leak_rate
    (expected,) = run_loads(result.case.replace(changed)).loads
    assert found == pytest.approx(expected.leak.leak_rate, rel=1e-9)
    assert abs(found / load.leak.leak_rate - 1) > 0.01


def test_the_law_is_that_of_the_variant():
    problem = rough_result().problem
    plastic = replace(problem, interface=problem.interface.model_copy(update={"plastic": True}))
    pressure = np.log(np.array([1e6, 1e8]))
    assert plastic.law is not problem.law
    assert np.all(plastic.law.decay_length(pressure) < problem.law.decay_length(pressure))
    assert (
        replace(problem, interface=problem.interface.model_copy(update={"law": "smooth"})).law
        == HardContact()
    )


def test_the_seat_of_a_case_and_its_larger_housing():
    held = case(seat=cone(wall="fixed", interference="2 um"))
    problem = SealProblem.of(held)
    assert problem.supports == Supports(wall="fixed") and problem.at_rest.interference == pytest.approx(2e-6)
    larger = larger_housing(held)
    assert larger.seat.largest_radius == pytest.approx(2 * held.contact.seat.largest_radius, rel=1e-12)
    assert larger.initial_contact_radius == pytest.approx(held.initial_contact_radius, rel=1e-12)


def test_a_liquid_without_density_has_no_mass_flow_and_only_a_gas_a_throughput():
    own, rough = FlowModel("my oil", 0.05), rough_result().loads[0].rough
    profile = rough_result().loads[0].contact.profile
    drops = own.leak_of(rough.table, rough.surface, profile, 1e5)
    assert (drops.mass_flow, drops.throughput, drops.standard_leak_rate) == (None, None, None)
    helium = SealProblem.of(case(fluid={"name": "helium", "temperature": "20 degC"})).flow
    found = helium.leak_of(helium.table(rough.surface, 1e1, 1e9), rough.surface, profile, 1e5)
    rate = found.leak_rate
    assert found.throughput == pytest.approx(101325 * rate, rel=1e-12)
    assert found.standard_leak_rate == pytest.approx(rate * 273.15 / 293.15, rel=1e-12)
    # 4.0026 g/mol at 101325 Pa and 20 degC
    assert found.mass_flow == pytest.approx(rate * 101325 * 4.0026e-3 / (8.314462618 * 293.15), rel=1e-4)
