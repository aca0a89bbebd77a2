"""The search for a force against roots that are known, and forces put back into their case."""

from __future__ import annotations

import math

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from sample_results import case, run_loads

from fem_seal.answers.force_search import End, Zero, find_zero
from fem_seal.answers.target import contacts_at_target
from fem_seal.seal.problem import problems_of

ACCURACY = 1e-6


@settings(deadline=None)
@given(root=st.floats(-20.0, 20.0), start=st.floats(-20.0, 20.0), slope=st.floats(0.1, 30.0))
def test_the_root_is_found_from_wherever_the_search_begins(root: float, start: float, slope: float) -> None:
    def falling(place: float) -> float:
        return math.copysign(min(slope * abs(root - place), 13.0), root - place)

    found = find_zero(falling, start, accuracy=ACCURACY)
    assert found is not None and found.end is None
    assert found.place == pytest.approx(root, abs=2 * ACCURACY)


@settings(deadline=None)
@given(
    root=st.floats(-5.0, 5.0),
    start=st.floats(-5.0, 5.0),
    low=st.floats(-5.0, 0.0),
    high=st.floats(0.0, 5.0),
)
def test_where_no_force_meets_it_the_last_place_and_the_reason_are_told(
    root: float, start: float, low: float, high: float
) -> None:
    assume(high - low > 0.5 and min(abs(root - low), abs(root - high)) > 1e-3)
    found = find_zero(lambda place: root - place, start, lowest=low, highest=high, accuracy=ACCURACY)
    expected = Zero(low, End.LOWEST) if root < low else Zero(high, End.HIGHEST) if root > high else Zero(root)
    assert found is not None and found.end is expected.end
    assert found.place == pytest.approx(expected.place, abs=2 * ACCURACY)


@settings(deadline=None)
@given(root=st.floats(-3.0, 3.0), start=st.floats(-3.0, 3.0), edge=st.floats(-3.0, 3.0))
def test_a_place_beyond_what_is_known_is_never_the_answer(root: float, start: float, edge: float) -> None:
    assume(abs(root - edge) > 0.05)
    found = find_zero(lambda place: None if place > edge else root - place, start, accuracy=ACCURACY)
    assert found is not None and found.place <= edge
    if root < edge:
        assert found == Zero(pytest.approx(root, abs=2 * ACCURACY))
    else:
        # the edge to two thousandths of the force
        assert found.end is End.UNKNOWN and edge - found.place < 3e-3


def test_below_what_is_known_the_smallest_known_force_is_the_answer() -> None:
    found = find_zero(lambda place: None if place < -1.0 else -2.0, 0.0, accuracy=ACCURACY)
    assert found is not None and found.end is None
    assert -1.0 <= found.place <= -1.0 + 4 * ACCURACY
    assert find_zero(lambda place: None, 0.0, accuracy=ACCURACY) is None


@pytest.mark.parametrize(
    "load",
    [
        {"fluid_pressure": ["2 bar", "200 bar"]},
        {"fluid_pressure": "20 bar", "closing": "penetration", "pressure_side": "inner"},
        {"fluid_pressure": "20 bar", "largest_earlier_force": "9 kN"},
    ],
    ids=["fluid outside", "fluid between", "pressed before"],
)
@pytest.mark.parametrize("target", [1e-7, 1e-9])
def test_a_force_put_back_into_the_case_leaks_the_target(load: dict[str, object], target: float) -> None:
    of = case(load={"applied_force": "3 kN", **load})
    for found in contacts_at_target(problems_of(of), target):
        assert found.leak is not None
        assert found.leak.leak_rate == pytest.approx(target, rel=2e-5)
        again = of.replace(
            {"load.fluid_pressure": found.fluid_pressure, "load.applied_force": found.applied_force}
        )
        (put_back,) = run_loads(again).loads
        # on a mesh of its own: its error
        assert put_back.leak.leak_rate == pytest.approx(target, rel=1e-3)
