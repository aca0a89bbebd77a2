"""What must not change a result: units, scale, order of the loads, what ran before; and the balance of forces."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from sample_results import STEEL, run_loads
from shape_tables import PAIRS, tables

import fem_seal
from fem_seal.case.case import Case
from fem_seal.output.columns import LEAK_COLUMNS
from fem_seal.output.tables import PROFILE_COLUMNS, leak_rows, profile_array
from fem_seal.result import SealResult

# Round-off of the input, and what a Newton iteration leaves.
SAME = 1e-8
SHAPES = {
    "ball in cone": (
        lambda mm, R: {"shape": "ball", "radius": mm(R)},
        lambda mm, R: {"shape": "cone", "angle": "45 deg"},
    ),
    "torus in cone": (
        lambda mm, R: {"shape": "torus", "centre_radius": mm(0.9 * R), "radius": mm(0.3 * R)},
        lambda mm, R: {"shape": "cone", "angle": "40 deg"},
    ),
    "ball in sphere": (
        lambda mm, R: {"shape": "ball", "radius": mm(R)},
        lambda mm, R: {"shape": "sphere", "radius": mm(1.5 * R), "contact_angle": "45 deg"},
    ),
}


def millimetres(length: float) -> str:
    return f"{length!r} mm"


def inches(length: float) -> str:
    return f"{length / 25.4!r} inch"


def seal(shape="ball in cone", radius=10.0, *, mm=millimetres, load=None, scale=1.0, **tables) -> Case:
    """A seal of some size with a surface whose lengths have the same scale."""
    closure, seat = (
        make(lambda length: mm(length * scale), radius) | {"material": STEEL} for make in SHAPES[shape]
    )
    spectrum = {
        "kind": "self-affine",
        "rms_height": f"{0.5 * scale!r} um",
        "hurst": 0.7,
        "q_low": f"{5e3 / scale!r} 1/m",
        "q_rolloff": f"{5e4 / scale!r} 1/m",
        "q_high": f"{3e6 / scale!r} 1/m",
    }
    return Case(
        closure=closure,
        seat=seat,
        roughness={"spectrum": spectrum},
        fluid={"viscosity": "1 mPa s"},
        load=load or {"fluid_pressure": "50 bar"},
        **tables,
    )


def rows(case: Case, run: Callable[[Case], SealResult] = run_loads) -> list[dict[str, float]]:
    """The numbers of leak.csv."""
    return [{name: row[name] for name in LEAK_COLUMNS} for row in leak_rows(run(case), all_columns=True)]


def assert_same(one, other, factors=None) -> None:
    for name, value in one.items():
        factor = (factors or {}).get(name, 1.0)
        assert other[name] == pytest.approx(factor * value, rel=SAME, nan_ok=True), name


@pytest.mark.parametrize(("closure", "seat"), PAIRS)
def test_the_pressure_carries_the_axial_force(closure, seat) -> None:
    """F_N = int 2 pi r p n_z facing dx, the seat's own normal from differences of its outline."""
    area = math.pi * Case(**tables(closure, seat)).initial_contact_radius ** 2
    pressures, springs = (7e5, 45e5), (0.8 * area * 7e5, -0.4 * area * 45e5)
    load = {
        "fluid_pressure": [f"{one!r} Pa" for one in pressures],
        "applied_force": [f"{one!r} N" for one in springs],
    }
    result = run_loads(Case(**tables(closure, seat, load=load)))
    contact = result.case.contact
    columns = dict(zip(PROFILE_COLUMNS, profile_array(result).T, strict=True))
    for one, pressure, spring in zip(result.loads, pressures, springs, strict=True):
        profile = one.contact.whole_profile
        x, step = profile.x, 1e-8
        rise_r, rise_z = (
            (line(x + step) - line(x - step)) / (2 * step) for line in (contact.radius, contact.height)
        )
        n_r, n_z = contact.normal(x)
        facing = (n_z * rise_r - n_r * rise_z) / np.hypot(rise_r, rise_z)
        carried = 2 * math.pi * contact.radius(x) * profile.pressure * n_z * facing
        assert profile.arc_weight @ carried == pytest.approx(one.contact_force, rel=1e-6)
        # one behind the other, lands hold back as much each where no flow is known, each on its own circle
        touching = [land for land in one.profiles if land.touches]
        circles = [math.pi * np.interp(land.centroid, land.x, land.radius) ** 2 for land in touching]
        held = pressure * (area if len(one.profiles) == 1 else np.mean(circles))
        assert one.contact_force == pytest.approx(spring + held, rel=1e-9)
        # what a user finds in profile.csv
        of_load = columns["fluid_pressure_Pa"] == pressure
        column = columns["contact_force_per_length_N_per_m"][of_load]
        np.testing.assert_allclose(column, carried, rtol=1e-6, atol=1e-6 * carried.max())
        along = columns["x_m"][of_load]
        # of the rule itself, which is further off where there are two peaks
        assert np.trapezoid(column, along) == pytest.approx(
            one.contact_force, rel=2e-4 if seat == "lands" else 1e-4
        )
        # f_N is the force along the normal, not along the axis
        at_touch = (
            profile.arc_weight @ (profile.pressure * facing * profile.radius) / contact.initial_contact_radius
        )
        # several lands have angles and radii of their own
        assert seat == "lands" or one.line_load == pytest.approx(at_touch, rel=3e-3)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("radius", [7.3, 20.0])
def test_inch_and_psi_are_mm_and_bar(shape, radius) -> None:
    """Stress is read off at the nodes of the mesh: only the very same mesh gives the same largest one."""
    (metric,) = rows(seal(shape, radius, load={"fluid_pressure": "33 bar"}))
    psi = f"{33e5 / 6894.757293168362!r} psi"
    (imperial,) = rows(seal(shape, radius, mm=inches, load={"fluid_pressure": psi}))
    assert_same(metric, imperial)


@pytest.mark.parametrize("shape", SHAPES)
def test_ten_times_as_large_is_the_same_seal(shape) -> None:
    """With all lengths times ten pressures stay; lengths, forces and leak rate grow with their powers of ten."""
    (small,), (large,) = rows(seal(shape)), rows(seal(shape, scale=10.0))
    ends = {
        "_m": 10.0,
        "_N": 100.0,
        "_N_per_m": 10.0,
        "m3_per_s": 1000.0,
        "kg_per_s": 1000.0,
        "m2_per_s": 100.0,
        "kg_per_m_s": 100.0,
    }
    factors = {name: factor for name in small for end, factor in ends.items() if name.endswith(end)}
    assert_same(small, large, factors)


@pytest.mark.parametrize("closing", ["sealed-area", "penetration"])
def test_the_order_of_the_loads_is_the_order_of_the_results(closing) -> None:
    bar = np.array([40.0, 5.0, 80.0, 20.0])
    given_order, rising = (
        rows(seal(load={"fluid_pressure": [f"{p} bar" for p in pressures], "closing": closing}))
        for pressures in (bar, np.sort(bar))
    )
    for row, number in zip(given_order, np.argsort(np.argsort(bar)), strict=True):
        assert_same(row, rising[number])


def test_what_ran_before_in_the_process_changes_nothing() -> None:
    case, other = seal(), seal("ball in sphere", 25.0, leak={"plasticity": False})
    first = rows(case, fem_seal.run)
    rows(other, fem_seal.run)
    for before, after in zip(first, rows(case, fem_seal.run), strict=True):
        assert before == pytest.approx(after, rel=0, abs=0, nan_ok=True)
