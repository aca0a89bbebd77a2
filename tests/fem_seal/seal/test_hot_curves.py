"""Hardening curves over temperature: between the curves, at many points, in bodies, in a case."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from plastic_solids import HEIGHT, INNER, NU, OUTER, E, HeldSolid, find_balance, ring_solid
from sample_results import cone, smooth_case

import fem_seal
from fem_seal.bodies.elastoplastic import ElastoplasticBody
from fem_seal.case.case import Case, load_case
from fem_seal.contact.load_path import ElastoplasticContact
from fem_seal.errors import InputError
from fem_seal.materials import HardeningCurve, HardeningOverTemperature, Material, OverTemperature
from fem_seal.output.report.page import curve_in_words
from fem_seal.seal.load_solver import LoadSolver, solve_load
from fem_seal.seal.problem import SealProblem, build_mesh, condense_bodies
from fem_seal.studies.responses import evaluate_design

COLD, HOT = (
    HardeningCurve((0.0, 0.002, 0.1), (250e6, 300e6, 350e6)),
    HardeningCurve((0.0, 0.05), (150e6, 200e6)),
)
ROOM, WARM = 293.15, 573.15
CURVES = HardeningOverTemperature((ROOM, WARM), (COLD, HOT))

# ---------------------------------------------------------------- between the curves

strains = st.lists(st.floats(1e-6, 1.5), max_size=4, unique=True)


@st.composite
def curves(draw: st.DrawFn) -> HardeningCurve:
    strain = (0.0, *sorted(draw(strains)))
    rises = draw(st.lists(st.floats(0, 3e8), min_size=len(strain), max_size=len(strain)))
    stress = np.cumsum([1e8, *rises[1:]])
    return HardeningCurve(strain, tuple(stress.tolist()))


@given(st.lists(curves(), min_size=1, max_size=4), st.floats(0, 1), st.floats(0, 2))
def test_between_two_curves_the_stress_is_linear_in_temperature_and_hardens(
    given_curves: list[HardeningCurve], share: float, strain: float
) -> None:
    temperature = tuple(300.0 + 100.0 * n for n in range(len(given_curves)))
    table = HardeningOverTemperature(temperature, tuple(given_curves))
    # at a table temperature the curve itself
    assert [table.at(T) for T in temperature] == given_curves
    at = temperature[0] + share * (temperature[-1] - temperature[0])
    # a HardeningCurve checks that it nowhere falls; its points are where those of either curve are
    found = float(table.at(at).flow_stress(np.array(strain)))
    by_hand = np.interp(at, temperature, [float(one.flow_stress(np.array(strain))) for one in given_curves])
    assert found == pytest.approx(by_hand, rel=1e-6)  # points closer than 1e-9 are one
    # known as far as both curves around it are
    assert table.at(at).last_strain >= min(one.last_strain for one in given_curves)
    assert table.next_to(1e4) == given_curves[-1]


@given(curves(), st.floats(300, 500))
def test_equal_curves_are_that_curve(curve: HardeningCurve, at: float) -> None:
    assert HardeningOverTemperature((300.0, 410.0, 500.0), (curve,) * 3).at(at) == curve


@settings(max_examples=50)
@given(st.lists(curves(), min_size=1, max_size=4), st.integers(0, 2**32 - 1))
def test_curves_of_many_points_are_those_of_each(given_curves: list[HardeningCurve], seed: int) -> None:
    random, stiffness = np.random.default_rng(seed), 3 * 80e9
    temperature = tuple(300.0 + 100.0 * n for n in range(len(given_curves)))
    table = HardeningOverTemperature(temperature, tuple(given_curves))
    T = random.uniform(temperature[0], temperature[-1], (5, 3))
    p = random.uniform(0, 2, (5, 3)) ** 3 / 4
    points = table.at_points(T)
    single = [table.at(one) for one in T.ravel().tolist()]
    stress = np.array([one.flow_stress(x) for one, x in zip(single, p.ravel(), strict=True)]).reshape(5, 3)
    assert points.flow_stress(p) == pytest.approx(stress, rel=1e-6)
    # the return: flow stress(p) + stiffness p = trial gives p back
    assert points.plastic_strain_at(stress + stiffness * p, stiffness) == pytest.approx(p, abs=1e-9)
    # the slope by a difference, away from corners
    step = 1e-7
    slope = (points.flow_stress(p + step) - points.flow_stress(p)) / step
    away = np.abs(p[..., None] - points.strain).min(axis=-1) > 10 * step
    assert points.slope(p)[away] == pytest.approx(slope[away], rel=1e-3, abs=1e3)


def test_a_material_has_the_curve_of_its_temperature() -> None:
    steel = Material("steel", E, NU, hardening_over_temperature=CURVES)
    assert steel.hardening == COLD and steel.yield_stress == 250e6
    warm = steel.at(WARM)
    assert warm.hardening == HOT and warm.yield_stress == 150e6
    assert warm.at(ROOM) == steel
    assert steel.at(433.15).yield_stress == pytest.approx(200e6, rel=1e-12)
    # what was not measured at both temperatures is not known
    assert steel.at(433.15).hardening.last_strain == 0.05
    with pytest.raises(
        InputError, match=r"stress_strain: is known from 20 degC to 300 degC and asked for at 301"
    ):
        steel.at(574.15)
    over = OverTemperature("yield_stress", (ROOM, WARM), (250e6, 150e6))
    with pytest.raises(InputError, match="leave yield_stress out"):
        Material("steel", E, NU, over_temperature=(over,), hardening_over_temperature=CURVES)


# ---------------------------------------------------------------- bodies

EXPANSION = 12e-6


@pytest.mark.parametrize("at", [303.15, 373.15, 433.15, 523.15, WARM])
def test_a_held_bar_that_is_heated_yields_as_by_hand(at: float) -> None:
    """Between two walls: a dT = s/E + p with s = Y(T) + H(T) p, whatever way the temperature rose."""
    soft = HardeningCurve((0.0, 0.1), (120e6, 170e6))
    table = HardeningOverTemperature((ROOM, WARM), (HardeningCurve((0.0, 0.1), (250e6, 450e6)), soft))
    steel = Material("steel", E, NU, hardening_over_temperature=table).at(at)
    share = (at - ROOM) / (WARM - ROOM)
    first, slope = 250e6 - 130e6 * share, (1 - share) * 2e9 + share * 0.5e9
    strain = EXPANSION * (at - ROOM)
    by_hand = min(E * strain, (first + slope * strain) / (1 + slope / E))
    body = ring_solid(4, steel)
    state, _ = find_balance(body, body.virgin, free_strain=strain)
    assert state.stress[..., 1] == pytest.approx(-by_hand, rel=1e-9)
    assert np.abs(state.stress[..., [0, 2, 3]]).max() < 1e-9 * by_hand
    assert state.plastic.accumulated_strain == pytest.approx(strain - by_hand / E, abs=1e-12)
    # the same by steps, with the curve of each temperature on the way
    stepped = body.virgin
    for T in np.linspace(ROOM, at, 9)[1:].tolist():
        solid = ring_solid(4, steel.at(T))
        stepped, _ = find_balance(solid, stepped, free_strain=EXPANSION * (T - ROOM))
    assert stepped.stress == pytest.approx(state.stress, abs=1e-7 * by_hand)


def hot_cylinder(cells: int) -> tuple[ElastoplasticBody, Any]:
    """Thick cylinder, perfectly plastic, hot inside: the yield stress at each radius."""
    perfect = HardeningOverTemperature(
        (300.0, 600.0), (HardeningCurve((0.0,), (300e6,)), HardeningCurve((0.0,), (120e6,)))
    )

    def temperature(r: np.ndarray) -> np.ndarray:
        return 320 + 260 * np.log(OUTER / r) / math.log(OUTER / INNER)

    plain = ring_solid(
        cells, Material("m", E, NU, hardening_over_temperature=perfect), hold=("flat", "inner")
    )
    r = np.asarray(plain.basis.global_coordinates())[0]
    body = HeldSolid(plain.mesh, plain.material, temperature(r), free=plain.free)
    return body, lambda r: 300e6 - 0.6e6 * (temperature(r) - 300)


def test_the_collapse_pressure_of_a_cylinder_that_is_hot_inside() -> None:
    """p = 2/sqrt(3) int Y(T(r)) dr/r: the stress difference at full flow is that of each radius (Hill 1950, V.2)."""
    body, yield_stress = hot_cylinder(8)
    wall = body.basis.get_dofs("inner").all(["u^1"])
    state, before = body.virgin, 0.0
    for opening in INNER * np.linspace(0, 0.03, 11)[1:]:
        start = state.displacement * (opening / before if before else 1.0)
        start[wall] = before = opening
        state, _ = find_balance(body, state, start=start)
    found = float(body.internal_forces(state.stress)[wall].sum()) / (2 * np.pi * INNER * HEIGHT)
    x = np.linspace(math.log(INNER), math.log(OUTER), 20001)
    exact = 2 / math.sqrt(3) * np.trapezoid(yield_stress(np.exp(x)), x)
    # as much above it as a cylinder of one temperature is with as many elements
    assert 0 < found / exact - 1 < 3e-4


# ---------------------------------------------------------------- case

STEADY = {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3, "thermal_expansion": "11e-6 1/K"}
LIST = [
    {
        "temperature": "20 degC",
        "plastic_strain": [0, 0.002, 0.1],
        "stress": ["250 MPa", "300 MPa", "350 MPa"],
    },
    {"temperature": "300 degC", "plastic_strain": [0, 0.05], "stress": ["150 MPa", "200 MPa"]},
]
PLAIN = {"plastic_strain": [0, 0.002, 0.1], "stress": ["250 MPa", "300 MPa", "350 MPa"]}


def pressed(stress_strain: object, /, seat: dict[str, Any] | None = None, **tables: Any) -> Case:
    """A smooth ball on a cone that yields, coarse for speed."""
    return smooth_case(
        seat=cone({**STEADY, "stress_strain": stress_strain, **(seat or {})}),
        **{
            "closure": {"shape": "ball", "radius": "20 mm", "material": STEADY},
            "load": {"fluid_pressure": "60 bar"},
            "mesh": {"contact_size": "40 um"},
            **tables,
        },
    )


def contact_of(given_case: Case) -> ElastoplasticContact:
    problem = SealProblem.of(given_case)
    found = solve_load(LoadSolver(problem, condense_bodies(problem, build_mesh(problem))), 0)
    assert isinstance(found, ElastoplasticContact)
    return found


def test_curves_in_a_case(tmp_path: Path) -> None:
    hot = pressed(LIST, temperature={"uniform": "300 degC"})
    assert hot.seat.material.hardening == HOT and hot.seat.material.hardening_over_temperature == CURVES
    assert pressed(LIST).seat.material.hardening == COLD
    assert hot.replace({"temperature.uniform": 433.15}).seat.material.yield_stress == pytest.approx(200e6)
    # one file for all temperatures, or one for each
    rows = ["temperature [degC], plastic_strain, stress_MPa", "20, 0, 250", "20, 0.002, 300", "20, 0.1, 350"]
    (tmp_path / "all.csv").write_text("\n".join([*rows, "300, 0, 150", "300, 0.05, 200"]))
    assert pressed({"file": str(tmp_path / "all.csv")}).seat.material == pressed(LIST).seat.material
    (tmp_path / "hot.csv").write_text("plastic_strain, stress_MPa\n0, 150\n0.05, 200\n")
    apart = [LIST[0], {"temperature": "300 degC", "file": str(tmp_path / "hot.csv")}]
    assert pressed(apart).seat.material == pressed(LIST).seat.material
    # files beside the case file
    (tmp_path / "case.toml").write_text(
        '[closure]\nshape = "ball"\nradius = "20 mm"\nmaterial = "steel"\n[seat]\nshape = "cone"\nangle = "45 deg"\n'
        '[seat.material]\nyoungs_modulus = "210 GPa"\npoissons_ratio = 0.3\n'
        '[[seat.material.stress_strain]]\nfile = "hot.csv"\ntemperature = "20 degC"\n'
        '[interface]\nlaw = "smooth"\n[load]\nfluid_pressure = "20 bar"\n'
    )
    assert load_case(tmp_path / "case.toml").seat.material.hardening == HOT


def test_total_strain_is_read_with_the_modulus_of_its_temperature() -> None:
    modulus = {"temperature": ["20 degC", "300 degC"], "value": ["210 GPa", "180 GPa"]}
    total = [
        {
            "temperature": "20 degC",
            "strain": [250 / 210e3, 0.1 + 350 / 210e3],
            "stress": ["250 MPa", "350 MPa"],
        },
        {
            "temperature": "300 degC",
            "strain": [150 / 180e3, 0.05 + 200 / 180e3],
            "stress": ["150 MPa", "200 MPa"],
        },
    ]
    read = pressed(total, seat={"youngs_modulus": modulus}).seat.material.hardening_over_temperature
    assert read is not None
    assert [one.plastic_strain for one in read.curve] == [pytest.approx((0, 0.1)), pytest.approx((0, 0.05))]


SLIPS: list[tuple[object, str, str]] = [
    ([LIST[1], LIST[0]], "seat.material", "temperatures must increase"),
    ([LIST[0], PLAIN], "seat.material", "curve 2 has no temperature; several curves need one each"),
    ([], "seat.material", "has no curve"),
    ([LIST[0], 3], "seat.material.stress_strain[2]", "must be a table"),
    ([LIST[0], {**LIST[1], "strss": 1}], "seat.material.stress_strain[2].strss", "do you mean stress"),
    (
        [LIST[0], {**LIST[1], "temperature": "300"}],
        "seat.material.stress_strain[2].temperature",
        "no temperature|has no unit",
    ),
    (
        [LIST[0], {**LIST[1], "stress": ["2 MPa", "1 MPa"]}],
        "seat.material",
        r"curve 2 \(300 degC\), row 2 .*not fall",
    ),
    ({**LIST[0], "temperature": "30 degC"}, "seat.material.stress_strain", "is known at 30 degC only"),
]


@pytest.mark.parametrize(("table", "key", "message"), SLIPS)
def test_slips_of_curves(table: object, key: str, message: str) -> None:
    with pytest.raises(InputError, match=message) as error:
        pressed(table)
    assert error.value.key == key


def test_wrong_files_of_curves(tmp_path: Path) -> None:
    path = tmp_path / "curve.csv"
    path.write_text("temperature_degC, plastic_strain, stress_MPa\n20, 0, 250\n300, 0, 150\n20, 0.1, 350\n")
    with pytest.raises(InputError, match=r"the rows of 20 degC do not stand together"):
        pressed({"file": str(path)})
    path.write_text("temperature_degC, plastic_strain, stress_MPa\n20, 0, 250\n20, 0.1, 350\n300, 0, 150\n")
    with pytest.raises(InputError, match="has a column for the temperature; leave temperature out"):
        pressed({"file": str(path), "temperature": "20 degC"})
    path.write_text("temperature, plastic_strain, stress_MPa\n20, 0, 250\n")
    with pytest.raises(InputError, match=r'column "temperature" has no unit; write it as "temperature_degC"'):
        pressed({"file": str(path)})


@pytest.mark.slow
def test_a_hot_seat_is_coined_deeper_and_a_table_is_its_curve() -> None:
    cold, hot = (contact_of(pressed(LIST, temperature={"uniform": at})) for at in ("20 degC", "300 degC"))
    deep, shallow = (one.states["seat"].plastic.accumulated_strain.max() for one in (hot, cold))
    assert deep > 1.5 * shallow
    assert hot.profile.std > cold.profile.std
    # at a temperature of the table it is the plain curve, and so it is of a table that says the same everywhere
    plain = contact_of(pressed(PLAIN, temperature={"uniform": "20 degC"}))
    same = [{**PLAIN, "temperature": T} for T in ("0 degC", "100 degC", "400 degC")]
    constant = contact_of(pressed(same, temperature={"uniform": "137 degC"}))
    for one in (cold, constant):
        assert np.array_equal(one.pressure, plain.pressure)
        assert np.array_equal(one.states["seat"].stress, plain.states["seat"].stress)


CONDUCTING = {"thermal_conductivity": "40 W/(m K)"}


def conducting(stress_strain: object, inner: str = "260 degC", wall: str = "60 degC") -> Case:
    faces = {"inner": {"temperature": inner}, "wall": {"temperature": wall}}
    closure = {"shape": "ball", "radius": "20 mm", "material": {**STEADY, **CONDUCTING}}
    return pressed(stress_strain, seat=CONDUCTING, closure=closure, temperature=faces)


@pytest.mark.slow
def test_each_place_of_a_body_yields_at_its_own_temperature() -> None:
    contact = contact_of(conducting(LIST))
    solid, state = contact.bodies["seat"].solid, contact.states["seat"]
    assert solid.temperature is not None and np.ptp(solid.temperature) > 100
    deviator = state.stress.copy()
    deviator[..., :3] -= state.stress[..., :3].mean(axis=-1, keepdims=True)
    q = np.sqrt(1.5 * (deviator**2 @ np.array([1, 1, 1, 2])))
    # nowhere above the curve of the place, and on it where it flows more than ever before
    p = state.plastic.accumulated_strain
    single = np.array(
        [CURVES.at(T).flow_stress(x) for T, x in zip(solid.temperature.ravel(), p.ravel(), strict=True)]
    )
    assert np.all(q.ravel() <= single * (1 + 1e-9))
    flows = np.isclose(q.ravel(), single, rtol=1e-9) & (p.ravel() > 0)
    assert flows.sum() > 20 and np.ptp(solid.temperature.ravel()[flows]) > 1


@pytest.mark.slow
def test_a_calculated_temperature_with_equal_curves_is_the_plain_curve() -> None:
    plain = contact_of(conducting(PLAIN))
    equal = contact_of(conducting([{**PLAIN, "temperature": T} for T in ("0 degC", "100 degC", "400 degC")]))
    assert plain.states["seat"].plastic.accumulated_strain.max() > 1e-3
    assert equal.pressure == pytest.approx(plain.pressure, rel=1e-7, abs=1e3)
    assert equal.states["seat"].plastic.accumulated_strain == pytest.approx(
        plain.states["seat"].plastic.accumulated_strain, abs=1e-9
    )


@pytest.mark.slow
def test_surroundings_of_one_temperature_are_the_curve_of_this_temperature() -> None:
    around = conducting(LIST, "220 degC", "220 degC")
    uniform = pressed(LIST, temperature={"uniform": "220 degC"})
    first, second = contact_of(around), contact_of(uniform)
    # the round-off of a field of 493 K whose differences strain the bodies
    assert first.pressure == pytest.approx(second.pressure, rel=1e-6, abs=1e3)


def test_a_calculated_temperature_beyond_the_curves_is_an_error() -> None:
    short = [LIST[0], {**LIST[1], "temperature": "255 degC"}]
    case = conducting(short)
    assert SealProblem.of(case).materials["seat"].hardening is not None  # at the contact it is known
    with pytest.raises(
        InputError, match=r"seat\.material\.stress_strain: is known from 20 degC to 255 degC and asked"
    ):
        contact_of(case)


@pytest.mark.slow
@pytest.mark.usefixtures("unrendered")
def test_a_design_of_another_temperature_takes_its_curve(tmp_path: Path) -> None:
    base, columns = pressed(LIST), ("max_accumulated_plastic_strain", "peak_pressure_Pa")
    hot = base.replace({"temperature": {"uniform": WARM}})
    result = fem_seal.run(hot)
    row = result.table.iloc[0]
    assert row[columns[0]] > 1.5 * contact_of(base).states["seat"].plastic.accumulated_strain.max()
    assert evaluate_design(hot, columns).values == {name: row[name] for name in columns}
    result.write(tmp_path)
    report = (tmp_path / "report.html").read_text(encoding="utf-8").replace("\xa0", " ")
    assert "taken from a table over temperature" in report
    assert curve_in_words(result.case.display, HOT) in report
