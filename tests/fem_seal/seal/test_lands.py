"""Several lands in series: flow resistances that add up, chambers that are sealed, vented, or have a test port."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from scipy.optimize import brentq

import fem_seal
import leak
from fem_seal.answers.case_load import case_loads
from fem_seal.answers.opening import blow_off_pressures
from fem_seal.answers.profile_files import read_profiles
from fem_seal.answers.profile_leak import leak_of_profiles
from fem_seal.case.case import load_case
from fem_seal.contact.model import ContactModel
from fem_seal.errors import InputError
from fem_seal.output.answers.lands import OUTPUT
from fem_seal.output.tables import write_profile_csv
from fem_seal.seal.evaluate import Evaluation, evaluate
from fem_seal.seal.load_result import LoadResult
from fem_seal.seal.problem import SealProblem

EXAMPLES = Path(__file__).parents[3] / "examples"
STEEL = {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3, "hardness": "2 GPa"}
FLAT = {"shape": "flat-land"}
INNER = FLAT | {"land_inner_radius": "20 mm", "land_outer_radius": "21.5 mm"}
OUTER = FLAT | {"land_inner_radius": "23 mm", "land_outer_radius": "24.2 mm"}


def lands_case(
    *lands: dict[str, object], fluid: str = "water", closure: dict[str, object] | None = None, **load: object
) -> fem_seal.Case:
    """A disc on lands, pressed with 10 kN, 5 bar inside."""
    return fem_seal.Case(
        closure=closure or {"shape": "disc", "radius": "30 mm", "material": STEEL},
        seat={"shape": "lands", "lands": list(lands), "material": STEEL},
        roughness={
            "spectrum": {
                "kind": "self-affine",
                "rms_height": "0.5 um",
                "hurst": 0.8,
                "q_low": "1e4 1/m",
                "q_rolloff": "5e4 1/m",
                "q_high": "1e6 1/m",
            }
        },
        fluid={"name": fluid},
        load={"fluid_pressure": "5 bar", "applied_force": "10 kN", "pressure_side": "inner", **load},
    )


@pytest.fixture(scope="module")
def solved() -> Evaluation:
    """Two flat lands, water inside."""
    return evaluate(SealProblem.of(lands_case(INNER, OUTER)))


def with_flow(load: LoadResult, **changed: object) -> LoadResult:
    """The same contact with another flow."""
    assert load.rough is not None and load.rough.flow is not None
    flow = replace(load.rough.flow, **changed)
    rough = replace(load.rough, flow=flow, make=lambda flow, surface: flow.table_around(surface, [6, 8]))
    return replace(load, rough=rough)


def test_lands_carry_the_force_together(solved: Evaluation) -> None:
    (load,) = solved.loads
    carried = [2 * np.pi * one.arc_weight @ (one.pressure * one.radius) for one in load.profiles]
    assert sum(carried) == pytest.approx(load.contact_force, rel=1e-3)
    assert min(carried) > 0.3 * load.contact_force
    starts = [one.radius[one.pressure > 1e5].min() for one in load.profiles]
    assert starts == pytest.approx([0.02, 0.023], abs=1e-4)


def test_resistances_of_a_liquid_add_up(solved: Evaluation) -> None:
    (load,) = (with_flow(one, pressure_law=None) for one in solved.loads)
    assert load.rough is not None and load.rough.flow is not None and load.leak is not None
    resistances = [
        load.rough.flow.leak_of(load.rough.table, load.rough.surface, one, 5e5).resistance
        for one in load.profiles
    ]
    assert load.leak.leak_rate == pytest.approx(5e5 / sum(resistances), rel=1e-8)
    chamber = 5e5 * resistances[1] / sum(resistances)
    assert load.leak.lands[0].outer_pressure == load.leak.lands[1].inner_pressure
    assert load.leak.lands[0].outer_pressure == pytest.approx(chamber, rel=1e-8)
    assert load.leak.fluid_pressure[[0, -1]] == pytest.approx([5e5, 0.0], abs=100.0)


@pytest.mark.parametrize("outlet", [0.0, 1.01325e5])
def test_as_much_gas_passes_both_lands(solved: Evaluation, outlet: float) -> None:
    (load,) = solved.loads
    load = with_flow(load, gas=leak.gas("helium"), outlet_pressure=outlet)
    assert load.rough is not None and load.leak is not None
    rough, high = load.rough, outlet + 5e5

    def alone(number: int, p_in: float, p_out: float) -> float:
        flow = replace(rough.flow, outlet_pressure=p_out)
        found = flow.leak_of(rough.table, rough.surface, load.profiles[number], p_in - p_out)
        return float(found.mass_flow)

    chamber = brentq(
        lambda p: alone(0, high, p) - alone(1, p, outlet), outlet + 1.0, high - 1.0, xtol=1e-3, rtol=1e-12
    )
    assert load.leak.mass_flow == pytest.approx(alone(0, high, chamber), rel=1e-6)
    assert load.leak.lands[0].outer_pressure == pytest.approx(chamber - outlet, rel=1e-6)


def test_a_liquid_that_thickens_falls_in_its_own_way(solved: Evaluation) -> None:
    (load,) = solved.loads
    law = leak.Barus(20e-9)
    thick, thin = (with_flow(replace(load, fluid_pressure=2e8), pressure_law=one).leak for one in (law, None))
    assert thick is not None and thin is not None

    # psi = (1 - exp(-alpha p))/alpha is what falls by the resistances
    def psi(p: float) -> float:
        return -float(np.expm1(-20e-9 * p)) / 20e-9

    assert thick.leak_rate == pytest.approx(thin.leak_rate * psi(2e8) / 2e8, rel=1e-8)
    share = thin.lands[0].outer_pressure / 2e8
    assert psi(thick.lands[0].outer_pressure) == pytest.approx(share * psi(2e8), rel=1e-8)


def test_a_vented_chamber_takes_all_that_passes_the_first_land(solved: Evaluation) -> None:
    (load,) = (with_flow(one, pressure_law=None) for one in solved.loads)
    sealed, vented = load.leak, with_flow(load, chambers=(0.0,)).leak
    assert sealed is not None and vented is not None
    first = sealed.lands[0]
    resistance = (first.inner_pressure - first.outer_pressure) / first.leak_rate
    assert vented.leak_rate == pytest.approx(5e5 / resistance, rel=1e-8)
    assert vented.lands[1] == (0.0, 0.0, 0.0)


def test_a_test_port_feeds_both_lands(solved: Evaluation) -> None:
    (load,) = (with_flow(one, pressure_law=None) for one in solved.loads)
    sealed, port = load.leak, with_flow(load, chambers=(8e5,)).leak
    assert sealed is not None and port is not None
    r_inner, r_outer = ((one.inner_pressure - one.outer_pressure) / one.leak_rate for one in sealed.lands)
    assert port.leak_rate == pytest.approx(8e5 / r_outer, rel=1e-8)
    assert port.lands[0].leak_rate == pytest.approx(3e5 / r_inner, rel=1e-8)


@pytest.mark.slow
def test_a_land_that_is_set_back_far_carries_nothing() -> None:
    back = OUTER | {"set_back": "50 um"}
    (load,) = evaluate(SealProblem.of(lands_case(INNER, back))).loads
    alone = lands_case(INNER, OUTER).replace(
        seat={"shape": "flat-land", "land_inner_radius": 0.02, "land_outer_radius": 0.0215, "material": STEEL}
    )
    (single,) = evaluate(SealProblem.of(alone)).loads
    assert load.leak is not None and single.leak is not None
    assert load.profiles[1].pressure.max() < 1e-6 * load.peak_pressure
    # the wall of the chamber is not that of a land alone, which changes the pressure at the edge
    assert load.leak.leak_rate == pytest.approx(single.leak.leak_rate, rel=0.03)


@pytest.mark.parametrize("closing", ["sealed-area", "penetration"])
def test_a_land_that_does_not_touch_has_numbers(closing: str) -> None:
    """It carries nothing, has no width and passes what the other one lets through."""
    found = evaluate(SealProblem.of(lands_case(INNER, OUTER | {"set_back": "50 um"}, closing=closing)))
    (load,) = found.loads
    touching, open_ = load.profiles
    assert touching.touches and not open_.touches
    assert (open_.std, open_.fwhm, open_.peak_pressure) == (0.0, 0.0, 0.0)
    assert open_.x[0] < open_.centroid < open_.x[-1]
    assert load.leak is not None and load.leak.lands == (
        (5e5, 0.0, load.leak.leak_rate),
        (0.0, 0.0, load.leak.leak_rate),
    )


@pytest.mark.parametrize("chamber", [None, "0 bar"])
@pytest.mark.parametrize("set_back", ["0 um", "50 um"])
def test_given_lands_leak_as_those_that_were_solved(
    chamber: str | None, set_back: str, tmp_path: Path
) -> None:
    """Read from profile.csv: between two lands is a chamber with its own pressure, no contact that goes on."""
    load = {} if chamber is None else {"chamber_pressure": [chamber]}
    problem = SealProblem.of(lands_case(INNER, OUTER | {"set_back": set_back}, **load))
    solved = case_loads(problem, evaluate(problem).loads)
    file = write_profile_csv(SimpleNamespace(loads=solved, problem=problem), tmp_path / "profile.csv")
    (given,) = leak_of_profiles(problem, read_profiles(file, problem.contact))
    assert given.leak.leak_rate == pytest.approx(solved[0].leak.leak_rate, rel=1e-3)
    assert np.array(given.leak.lands) == pytest.approx(np.array(solved[0].leak.lands), rel=1e-3, abs=1.0)


@pytest.mark.slow
@pytest.mark.parametrize("number", [0, 1])
def test_all_is_written_of_a_land_that_does_not_touch(number: int, tmp_path: Path) -> None:
    lands = [INNER, OUTER]
    lands[number] = lands[number] | {"set_back": "50 um"}
    result = fem_seal.run(lands_case(*lands, fluid="nitrogen"))
    assert result.write(tmp_path) and not any("could not be calculated" in one for one in result.warnings)
    table = pd.read_csv(tmp_path / "contacts.csv")
    assert np.isfinite(table.select_dtypes("number").to_numpy()).all()
    assert table["leak_rate_m3_per_s"].nunique() == 1
    page = result.report(tmp_path / "full.html", full=True)
    assert "Lands in series" in page.read_text(encoding="utf-8")
    assert (tmp_path / "contact_line_000.vtp").is_file()


@pytest.mark.slow
def test_a_land_that_is_not_named_is_found() -> None:
    drawn = fem_seal.Case(
        closure={"shape": "disc", "radius": "30 mm", "material": STEEL},
        seat={
            "shape": "profile",
            "material": STEEL,
            "outline": [
                {"to": ["20 mm", "-30 mm"]},
                {"to": ["69 mm", "-30 mm"]},
                {"to": ["69 mm", "-1 mm"]},
                {"to": ["24.2 mm", "-1 mm"]},
                {"to": ["24.2 mm", "-0.06 mm"]},
                {"to": ["24.14 mm", "0 mm"], "centre": ["24.14 mm", "-0.06 mm"]},
                {"to": ["23.06 mm", "0 mm"], "name": "face"},
                {"to": ["22.6 mm", "-0.4 mm"], "name": "face"},
                {"to": ["21.9 mm", "-0.4 mm"], "name": "face"},
                {"to": ["21.44 mm", "0 mm"], "name": "face"},
                {"to": ["20.06 mm", "0 mm"], "name": "face"},
                {"to": ["20 mm", "-0.06 mm"], "centre": ["20.06 mm", "-0.06 mm"]},
                {"to": ["20 mm", "-30 mm"], "name": "inner"},
            ],
        },
        interface={"law": "exponential", "u0": "0.3 um", "p_c": "5 GPa"},
        load={"fluid_pressure": "5 bar", "applied_force": "10 kN", "pressure_side": "inner"},
    )
    (load,) = evaluate(SealProblem.of(drawn)).loads
    (profile,) = load.profiles
    outside = profile.radius > 0.0225
    carried = 2 * np.pi * profile.arc_weight[outside] @ (profile.pressure * profile.radius)[outside]
    assert carried > 0.3 * load.contact_force


@pytest.mark.slow
def test_fluid_between_the_lands_lifts_the_closure() -> None:
    case = lands_case(INNER, OUTER, closing="penetration")
    (load,) = evaluate(SealProblem.of(case)).loads
    assert load.leak is not None and load.contact.loads.gap_pressure is not None
    radii = np.concatenate([one.radius for one in load.profiles])
    weight = np.concatenate([one.arc_weight for one in load.profiles])
    gap = 2 * np.pi * weight @ (radii * load.contact.loads.gap_pressure)
    chamber = np.pi * (0.023**2 - 0.0215**2) * load.leak.lands[0].outer_pressure
    assert gap > chamber
    # fluid acts up to somewhere between the inner edge and the outer one
    lift = 10e3 - load.contact_force
    assert np.pi * 0.02**2 * 5e5 < lift < np.pi * 0.0242**2 * 5e5
    assert 0.0215 < np.sqrt(lift / (np.pi * 5e5)) < 0.0235


def test_conical_lands_have_normals_of_their_own() -> None:
    ball = {"shape": "ball", "radius": "20 mm", "material": STEEL}
    cones = [{"shape": "conical-land", "angle": one, "land_width": "1 mm"} for one in ("35 deg", "50 deg")]
    problem = SealProblem.of(lands_case(*cones, closure=ball, applied_force="2 kN"))
    found = evaluate(problem)
    (load,) = found.loads
    model: ContactModel = found.model
    normal = model.line.normal
    angles = []
    for (part, _), one in zip(model.line.lands, load.profiles, strict=True):
        at = int(np.argmax(one.pressure))
        angles.append(float(np.degrees(np.arctan2(-normal[0, part][at], normal[1, part][at]))))
    assert angles == pytest.approx([35, 50], abs=0.3)
    share = [one.arc_weight @ one.pressure for one in load.profiles]
    assert min(share) > 0.2 * sum(share)


@pytest.mark.parametrize(
    ("lands", "load", "key"),
    [
        ([INNER], {}, "seat"),
        ([INNER, OUTER | {"land_inner_radius": "21.4 mm"}], {}, "seat"),
        ([INNER, OUTER | {"land_inner_radius": "31 mm", "land_outer_radius": "33 mm"}], {}, "seat"),
        ([INNER, OUTER | {"land_outer_radius": "22 mm"}], {}, "seat.lands[2].land_outer_radius"),
        ([INNER, OUTER], {"chamber_pressure": ["vented", "vented"]}, "load.chamber_pressure"),
        ([INNER, OUTER], {"chamber_pressure": "open"}, "load.chamber_pressure"),
    ],
)
def test_what_cannot_be_says_so(lands: list[dict[str, object]], load: dict[str, object], key: str) -> None:
    with pytest.raises(InputError) as error:
        lands_case(*lands, **load)
    assert error.value.problems[0].key == key


def test_a_chamber_takes_lands() -> None:
    case = lands_case(INNER, OUTER)
    with pytest.raises(InputError, match="lands"):
        case.replace(
            seat={"shape": "flat", "bore_radius": 0.02, "material": STEEL},
            load=dict(case.load) | {"chamber_pressure": "vented"},
        )


@pytest.mark.slow
def test_the_report_and_the_files_have_every_land(tmp_path: Path) -> None:
    """Line loads of both lands make the contact force; as much flows through both, unless a port holds the chamber."""
    case = lands_case(INNER, OUTER, fluid="nitrogen", chamber_pressure="6 bar")
    result = fem_seal.run(case)
    lines = OUTPUT.page_of(result, case.display).details
    assert len(lines) == 2 and lines[1].endswith("held at 6.000 bar above the low side.")
    result.write(tmp_path)
    table = pd.read_csv(tmp_path / "contacts.csv")
    assert table["contact"].tolist() == ["seat 1", "seat 2"]
    outlet = result.problem.flow.outlet_pressure
    assert table["upstream_pressure_Pa"].to_numpy() - outlet == pytest.approx([6e5, 6e5])
    assert table["downstream_pressure_Pa"].to_numpy() - outlet == pytest.approx([5e5, 0.0], abs=1e-6)
    (load,) = result.loads
    assert table["leak_rate_m3_per_s"].iloc[1] == pytest.approx(load.leak.leak_rate)
    carried = (
        2
        * np.pi
        * sum(
            one.moment(0) * np.average(one.radius, weights=one.arc_weight * one.pressure)
            for one in load.profiles
        )
    )
    assert carried == pytest.approx(load.contact_force, rel=2e-3)
    page = result.report(tmp_path / "full.html", full=True)
    assert "Lands in series" in page.read_text(encoding="utf-8")
    alone = lands_case(INNER, OUTER).replace(
        seat={"shape": "flat-land", "land_inner_radius": 0.02, "land_outer_radius": 0.0215, "material": STEEL}
    )
    assert not OUTPUT.answers(fem_seal.run(alone))


@pytest.mark.slow
def test_a_test_port_lifts_the_closure_by_its_pressure() -> None:
    """Between the faces, too, or on one circle of each land."""
    port = {"fluid": "nitrogen", "chamber_pressure": "8 bar", "applied_force": "4 kN"}
    circles, between = (
        fem_seal.run(lands_case(INNER, OUTER, closing=one, **port)).loads[0]
        for one in ("sealed-area", "penetration")
    )
    # 5 bar inside up to somewhere on the inner land, 8 bar between the lands, falling to nothing on the outer one
    inner, chamber = np.pi * 0.02075**2 * 5e5, np.pi * (0.0236**2 - 0.02075**2) * 8e5
    assert 4e3 - between.contact_force == pytest.approx(inner + chamber, rel=0.05)
    assert circles.contact_force == pytest.approx(between.contact_force, rel=0.01)
    assert circles.leak.leak_rate == pytest.approx(between.leak.leak_rate, rel=0.05)
    assert circles.blow_off_pressure == pytest.approx(between.blow_off_pressure, rel=0.02)
    assert between.contact.loads.gap_pressure.max() == pytest.approx(8e5, rel=1e-6)


def held_back(load: LoadResult) -> float:
    """Force of the fluid on the closure by the pressures on both sides of each land [N], positive where it lifts."""
    assert load.leak is not None
    return sum(
        np.pi * np.interp(one.centroid, one.x, one.radius) ** 2 * (flow.inner_pressure - flow.outer_pressure)
        for one, flow in zip(load.profiles, load.leak.lands, strict=True)
    )


def test_force_contact_and_pressures_balance(solved: Evaluation) -> None:
    (load,) = solved.loads
    assert load.contact_force + held_back(load) == pytest.approx(load.applied_force, abs=1e-2)


@pytest.mark.slow
@pytest.mark.parametrize(
    "load",
    [
        {"pressure_side": "outer"},
        {"chamber_pressure": "vented"},
        {"chamber_pressure": "12 bar", "applied_force": "4 kN"},
        {"applied_force": "-100 N", "pressure_side": "outer"},
        {"applied_force": "770 N"},
        {"largest_earlier_force": "20 kN"},
    ],
    ids=["outer", "vented", "port", "pulled", "nearly open", "earlier"],
)
def test_any_force_contact_and_pressures_balance(load: dict[str, str]) -> None:
    (found,) = evaluate(SealProblem.of(lands_case(INNER, OUTER, **load))).loads
    assert found.contact_force + held_back(found) == pytest.approx(found.applied_force, abs=1e-2)
    assert found.contact_force > 0.0


@pytest.mark.slow
def test_bolts_hold_contact_and_fluid_of_a_ring_joint() -> None:
    """The forces of the flanks along the axis, summed over the line, and the pressures are all that there is."""
    case = load_case(EXAMPLES / "ring_joint.toml").replace({"load.applied_force": ["330 kN"]})
    (load,) = evaluate(SealProblem.of(case.replace({"gasket.material.stress_strain": None}))).loads
    assert load.leak is not None
    line = load.contact.model.line
    carried = float(line.normal[1] @ (line.area_weight * load.contact.pressure))
    assert carried + held_back(load) == pytest.approx(330e3, rel=1e-6)
    # in the groove some pressure between both sides lifts the flange, beside that in the bore
    bore, groove = (np.pi * radius**2 * 400e5 for radius in (0.0428, 0.0524))
    assert bore < held_back(load) < groove


def test_without_a_flow_the_pressure_falls_evenly_at_the_lands() -> None:
    case = lands_case(INNER, OUTER).replace(fluid=None)
    (load,) = evaluate(SealProblem.of(case)).loads
    areas = [np.pi * np.interp(one.centroid, one.x, one.radius) ** 2 for one in load.profiles]
    assert load.contact_force == pytest.approx(1e4 - 5e5 * np.mean(areas), rel=1e-6)


@pytest.mark.parametrize("number", [0, pytest.param(1, marks=pytest.mark.slow)])
def test_a_land_set_back_by_nothing_changes_nothing(number: int, solved: Evaluation) -> None:
    """Which land touches first does not decide on what the fluid acts."""
    lands = [INNER, OUTER]
    lands[number] = lands[number] | {"set_back": "0.001 um"}
    (back,), (even,) = evaluate(SealProblem.of(lands_case(*lands))).loads, solved.loads
    assert back.contact_force == pytest.approx(even.contact_force, rel=1e-4)
    assert back.leak is not None and even.leak is not None
    assert back.leak.leak_rate == pytest.approx(even.leak.leak_rate, rel=2e-3)


def test_an_open_land_between_two_held_pressures_leaves_no_load() -> None:
    back = OUTER | {"set_back": "50 um"}
    with pytest.raises(InputError, match="does not touch"):
        evaluate(SealProblem.of(lands_case(INNER, back, chamber_pressure="8 bar")))


@pytest.mark.slow
@pytest.mark.parametrize("angles", [(), (20, 72)])
@pytest.mark.parametrize("side", ["inner", "outer"])
def test_a_tenth_of_the_size_is_the_same_seal(angles: tuple[int, ...], side: str) -> None:
    """Pressures stay; the leak rate goes with the third power of the size, also of steep cones, from either side."""

    def load_at(scale: float) -> LoadResult:
        def mm(value: float) -> str:
            return f"{value * scale!r} mm"

        flats = [
            FLAT | {"land_inner_radius": mm(start), "land_outer_radius": mm(end)}
            for start, end in ((20, 21.5), (23, 24.2))
        ]
        cones = [{"shape": "conical-land", "angle": f"{one} deg", "land_width": mm(1)} for one in angles]
        disc, ball = {"shape": "disc", "radius": mm(30)}, {"shape": "ball", "radius": mm(20)}
        spectrum = {"kind": "self-affine", "rms_height": f"{0.5 * scale!r} um", "hurst": 0.8}
        waves = {"q_low": 1e4, "q_rolloff": 5e4, "q_high": 1e6}
        spectrum |= {name: f"{q / scale!r} 1/m" for name, q in waves.items()}
        case = fem_seal.Case(
            closure={**(ball if angles else disc), "material": STEEL},
            seat={"shape": "lands", "lands": cones or flats, "material": STEEL},
            roughness={"spectrum": spectrum},
            fluid={"name": "water"},
            load={"fluid_pressure": "5 bar", "applied_force": f"{1e4 * scale**2!r} N", "pressure_side": side},
        )
        (load,) = evaluate(SealProblem.of(case)).loads
        return load

    large, small = load_at(1.0), load_at(0.1)
    assert large.leak is not None and small.leak is not None
    assert small.peak_pressure == pytest.approx(large.peak_pressure, rel=1e-9)
    assert 1e3 * small.leak.leak_rate == pytest.approx(large.leak.leak_rate, rel=1e-9)
    assert small.leak.lands[0].outer_pressure == pytest.approx(large.leak.lands[0].outer_pressure, rel=1e-9)


@pytest.mark.slow
def test_under_a_test_port_the_opening_pressure_rises_with_the_force_as_two_circles_say() -> None:
    forces = np.array([1.5e3, 2e3, 4e3, 6e3])
    case = lands_case(
        INNER,
        OUTER,
        fluid_pressure="5 bar",
        chamber_pressure="12 bar",
        closing="penetration",
        applied_force=[f"{force} N" for force in forces],
    )
    pressure = blow_off_pressures(SealProblem.of(case))
    # force = circle of the inner land * pressure + ring of the chamber * its pressure, both within their lands
    circle, at_rest = np.polyfit(pressure, forces, 1)
    assert circle * pressure + at_rest == pytest.approx(forces, rel=1e-3)
    assert 20e-3 < np.sqrt(circle / np.pi) < 21.5e-3
    assert np.pi * (23e-3**2 - 21.5e-3**2) * 12e5 < at_rest < np.pi * (24.2e-3**2 - 20e-3**2) * 12e5


def test_the_width_of_a_land_lies_between_its_flanks():
    x = np.linspace(-1e-3, 1e-3, 401)
    flank = np.exp(-np.maximum(np.abs(x) - 4e-4, 0.0) / 2e-5)
    # nothing at both ends of the line, as where contact ends sharply, but no ellipse
    pressure = np.where(np.abs(x) < 9e-4, 1e7 * flank, 0.0)
    width = fem_seal.PressureProfile(x, 0.02 + x, pressure, 0 * x, np.gradient(x)).fwhm
    assert width == pytest.approx(8e-4 + 2 * 2e-5 * np.log(2.0), rel=2e-3)
