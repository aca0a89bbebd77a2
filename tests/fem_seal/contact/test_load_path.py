"""Load paths, inverse questions, press fits and the far field: from the case to the files."""

import base64
import json
import math
import re
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from contact_models import STEEL
from sample_results import SMOOTH, SPECTRUM, ball, case, cone, run_loads, smooth_case
from sample_results import STEEL as STEEL_TABLE

import fem_seal
import meshes
from fem_seal.answers.case_load import CaseLoad
from fem_seal.answers.closed_forms import derive
from fem_seal.answers.profile_files import read_profiles
from fem_seal.answers.target import target_remarks
from fem_seal.bodies.elasticity import node_dofs, quadratic_nodes
from fem_seal.bodies.supports import Supports
from fem_seal.contact.model import BodyLoads, condense
from fem_seal.errors import InputError
from fem_seal.loads import contact_force
from fem_seal.output.answers.leak import leakage_lines
from fem_seal.output.files import summary
from fem_seal.output.report.page import far_field_sentence, report
from fem_seal.output.tables import write_profile_csv
from fem_seal.seal.load_result import distinct_loads, load_axis, load_name
from fem_seal.seal.problem import SealProblem, larger_housing, problems_of
from leak import LeakResult, Reading

VALVE = {
    "fluid_pressure": ["5 bar", "15 bar", "20 bar", "15 bar", "5 bar"],
    "applied_force": "1.5 kN",
    "pressure_side": "inner",
    "closing": "penetration",
}
TARGET = 0.2e-6


@cache
def valve():
    return fem_seal.run(case(load={**VALVE, "target_leak_rate": "0.2 cm^3/s"}))


# ---------------------------------------------------------------- load paths


@pytest.mark.slow
def test_loads_keep_their_order_and_elastic_bodies_come_back():
    table = valve().table
    assert table.fluid_pressure_Pa.tolist() == [5e5, 15e5, 20e5, 15e5, 5e5]
    # Solved anew on the way back: what differs is round-off of the coupled iteration, 1e-9 of the fluid pressure.
    up, down = table.iloc[:2], table.iloc[:2:-1]
    for column in ("contact_force_N", "peak_pressure_Pa", "leak_rate_m3_per_s", "effective_seal_radius_m"):
        assert down[column].to_numpy() == pytest.approx(up[column].to_numpy(), rel=1e-7)


@pytest.mark.slow
def test_loads_that_come_back_are_told_once():
    loads = valve().loads
    assert [load_name(load, loads) for load in loads] == ["5 bar", "15 bar", "20 bar", "15 bar", "5 bar"]
    assert [loads[n].fluid_pressure for n in distinct_loads(loads)] == [20e5, 15e5, 5e5]
    over = load_axis(loads)
    assert not over.order_matters and not over.returns and over.order == ""
    pictures = [
        base64.b64decode(code).decode()
        for code in re.findall(r"svg\+xml;base64,([\w+/=]+)", report(valve(), full=True))
    ]
    (profiles,) = [text for text in pictures if "All 5 loads" in text]
    assert profiles.count(">15 bar<") == 1


@pytest.mark.slow
def test_spring_and_fluid_are_what_the_contact_carries():
    table = valve().table
    fluid = math.pi * table.effective_seal_radius_m**2 * table.fluid_pressure_Pa
    assert (table.applied_force_N == 1500).all()
    np.testing.assert_allclose(table.contact_force_N, table.applied_force_N - fluid, rtol=1e-12)
    # and the fluid acts up to somewhere in the contact
    shift = (table.effective_seal_radius_m - valve().case.initial_contact_radius).abs()
    assert (shift < table.std_m).all()


def test_each_pressure_may_have_its_own_force():
    load = {"fluid_pressure": ["5 bar", "5 bar", "10 bar"], "applied_force": ["0 N", "200 N", "-100 N"]}
    asked = case(load=load)
    assert asked.load.points == ((5e5, 0.0), (5e5, 200.0), (10e5, -100.0))
    contacts = run_loads(asked).loads
    expected = [contact_force(asked.initial_contact_radius, p, force) for p, force in asked.load.points]
    assert [one.contact_force for one in contacts] == pytest.approx(expected, rel=1e-12)
    assert [one.contact_force for one in derive(asked).loads] == pytest.approx(expected, rel=1e-12)


@pytest.mark.slow
def test_the_pressure_in_the_gap_is_in_the_profile():
    for load in valve().loads:
        assert load.gap_pressure == pytest.approx(
            load.contact.loads.gap_pressure, abs=1e-6 * load.fluid_pressure
        )
        # from full pressure in the bore to none outside
        assert load.gap_pressure[0] > 0.98 * load.fluid_pressure
        assert load.gap_pressure[-1] < 0.02 * load.fluid_pressure
        assert (np.diff(load.gap_pressure) < 0).all()


@pytest.mark.slow
def test_too_much_pressure_is_refused_with_the_one_that_opens():
    opens = valve().table.blow_off_pressure_Pa.iloc[0]
    with pytest.raises(InputError, match="the seal is open at a fluid pressure of 25 bar") as failure:
        fem_seal.run(case(load={**VALVE, "fluid_pressure": "25 bar"}))
    assert failure.value.key == "load.applied_force"
    said = float(re.search(r"holds ([\d.]+) bar", str(failure.value)).group(1))
    assert said == pytest.approx(opens / 1e5, rel=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("side", "too_little", "tables", "below"),
    [
        # what flows lets the contact go evenly: the force is known to 1e-4 of the fluid's
        ("inner", "500 N", {}, 5e-4),
        ("outer", "-2 kN", {}, 5e-4),
        # a held fluid gets in before the contact is gone: the force that is named holds, a little less might
        ("inner", "500 N", SMOOTH, 0.01),
        ("outer", "-2 kN", SMOOTH, 0.01),
    ],
)
def test_an_open_seal_names_the_force_that_closes_it(side, too_little, tables, below):
    load = {**VALVE, "fluid_pressure": "20 bar", "pressure_side": side}

    def under(force):
        return run_loads(case(load={**load, "applied_force": force}, **tables))

    with pytest.raises(InputError) as failure:
        under(too_little)
    said = re.search(r"give an applied_force above ([-\u2212]?[\d.]+) N", str(failure.value)).group(1)
    needed = float(said.replace("\u2212", "-"))
    lifted = math.pi * case().initial_contact_radius ** 2 * 20e5 * (1 if side == "inner" else -1)
    assert needed == pytest.approx(lifted, rel=3e-3)
    assert under(f"{needed + 2e-4 * abs(needed)} N").loads[0].contact_force > 0
    with pytest.raises(InputError, match="the seal is open"):
        under(f"{needed - below * abs(needed)} N")


@pytest.mark.slow
def test_loads_that_open_the_seal_are_left_out_and_named():
    opens = valve().table.blow_off_pressure_Pa.iloc[0]
    pressures = [f"{bar} bar" for bar in (10, 25, 15, 30)]
    result = run_loads(case(load={**VALVE, "fluid_pressure": pressures}))
    np.testing.assert_allclose(result.table.fluid_pressure_Pa, [10e5, 25e5, 15e5, 30e5])
    assert result.table.leak_rate_m3_per_s.notna().tolist() == [True, False, True, False]
    # the mesh is sized for the loads, and what it is off changes the contact by some 1e-5
    alone = run_loads(case(load={**VALVE, "fluid_pressure": "15 bar"})).table.iloc[0]
    assert result.table.leak_rate_m3_per_s.iloc[2] == pytest.approx(alone.leak_rate_m3_per_s, rel=1e-3)
    (said,) = [text for text in result.warnings if "open" in text and "not calculated" in text]
    assert "at a fluid pressure of 25 bar" in said and "25 bar, 30 bar" in said
    assert float(re.search(r"holds ([\d.]+) bar", said).group(1)) == pytest.approx(opens / 1e5, rel=1e-4)


@pytest.mark.slow
def test_forces_that_leave_the_seal_open_are_named_together():
    forces = ["1.1 kN", "1.5 kN", "0.9 kN", "1.2 kN"]
    result = run_loads(case(load={**VALVE, "fluid_pressure": "20 bar", "applied_force": forces}))
    assert result.table.applied_force_N.tolist() == [1100, 1500, 900, 1200]
    assert [load.applied_force for load in result.loads] == [1500]
    (said,) = [text for text in result.warnings if "not calculated" in text]
    assert "an applied force of 1200 N holds" in said and "900 N, 1100 N" in said


def test_nothing_is_coupled_twice():
    with pytest.raises(InputError, match="already solves contact and fluid pressure in the gap together"):
        case(load=VALVE, leak={"fluid_in_gap": "local"})


def test_without_a_spring_the_fluid_in_the_bore_is_refused():
    with pytest.raises(InputError, match="give an applied_force above about"):
        case(load={**VALVE, "applied_force": "0 N"})


# ---------------------------------------------------------------- inverse questions


@pytest.mark.slow
def test_the_force_for_a_target_leaks_the_target():
    table = valve().table
    row = table.iloc[2]
    asked = case(
        load={**VALVE, "fluid_pressure": "20 bar", "applied_force": f"{row.force_for_target_leak_N:.12g} N"}
    )
    # another mesh, whose discretisation changes the leak rate by some 1e-5
    assert run_loads(asked).table.leak_rate_m3_per_s.iloc[0] == pytest.approx(TARGET, rel=1e-4)
    # a Gaussian profile of the right width knows it within a few per cent
    expected = derive(asked.replace({"load.target_leak_rate": "0.2 cm^3/s"})).loads[0].force_for_target
    assert expected == pytest.approx(row.force_for_target_leak_N, rel=0.05)
    # more than the target leaks at the present force, so a stronger spring is needed
    assert row.leak_rate_m3_per_s > TARGET
    assert row.force_for_target_leak_N > row.applied_force_N


@pytest.mark.slow
def test_a_target_that_only_an_extrapolation_reaches_is_warned_of():
    """The present load is far inside the theory; the force for the target is not, and says so as a run at it does."""
    load = {"fluid_pressure": ["20 bar", "40 bar"], "target_leak_rate": "0.02 mm^3/s"}
    soft = {**STEEL_TABLE, "yield_stress": "250 MPa"}
    result = fem_seal.run(case(seat=cone(soft), load=load))
    forces = [one.force_for_target for one in result.loads]
    low, high = (f"{force / 1e3:.4g} kN" for force in forces)
    prefix = f"at the force for the target leak rate, {low} at 20 bar to {high} at 40 bar: "
    assert all(text.startswith(prefix) for text in result.warnings)
    told = [text.removeprefix(prefix) for text in result.warnings]
    again = fem_seal.run(
        case(
            seat=cone(soft),
            load={
                "fluid_pressure": load["fluid_pressure"],
                "applied_force": [f"{force} N" for force in forces],
            },
        )
    )
    for sign in ("exceeds 250 MPa", "A/A0 = ", "of the hardness"):
        (mine,) = [text for text in told if sign in text]
        (there,) = [text for text in again.warnings if sign in text]
        # of another mesh the fourth digit may differ, and the place of the largest stress by an element
        numbers = [
            float(re.search(r"(?:stress|A/A0 =|pressure) ([\d.]+)", text).group(1)) for text in (mine, there)
        ]
        assert numbers[0] == pytest.approx(numbers[1], rel=3e-3)
    assert any("force for the target leak rate" in text for text in summary(result)["warnings"])


def test_force_for_a_target_with_the_fluid_on_the_sealed_area():
    sealed = case(load={"fluid_pressure": ["2 bar", "20 bar"], "applied_force": "0 N"})
    forces = fem_seal.applied_force_for_leak(sealed, TARGET)
    # 0.16 cm^3/s at 2 bar and 0.38 cm^3/s at 20 bar without a spring
    assert forces[0] < 0 < forces[1]
    again = run_loads(
        sealed.replace({"load.applied_force": [f"{force:.12g} N" for force in forces.tolist()]})
    )
    assert again.table.leak_rate_m3_per_s.to_numpy() == pytest.approx([TARGET, TARGET], rel=1e-4)


@pytest.mark.parametrize(
    ("changes", "target", "said"),
    [
        ({}, 1.0, "almost unloaded contact"),
        ({"fluid": None}, 1e-9, r"needs \[roughness\] and \[fluid\]"),
        ({}, None, "above zero"),
    ],
)
def test_targets_that_are_no_question(changes, target, said):
    with pytest.raises(InputError, match=said) as failure:
        fem_seal.applied_force_for_leak(case(**changes), target)
    assert failure.value.key == "load.target_leak_rate"


def soft_and_rough(**load):
    """Rubbery bodies with a coarse surface: no force that keeps strains small makes them tight."""
    rubber = {"youngs_modulus": "10 MPa", "poissons_ratio": 0.3}
    coarse = {"rms_height": "60 um", "q_rolloff": "1e4 1/m", "q_high": "1e6 1/m"}
    return case(
        closure=ball(rubber),
        seat=cone(rubber),
        roughness={"spectrum": {**SPECTRUM, **coarse}},
        leak={"plasticity": False},
        load={"fluid_pressure": "0.01 bar", **load},
    )


@pytest.mark.slow
def test_a_target_out_of_reach_is_said_and_does_not_cost_the_other_results():
    with pytest.raises(InputError, match="the largest for small strains"):
        fem_seal.applied_force_for_leak(soft_and_rough(), 1e-15)
    result = fem_seal.run(soft_and_rough(target_leak_rate="1e-15 m^3/s"))
    assert math.isnan(result.table.force_for_target_leak_N.iloc[0])
    assert result.table.leak_rate_m3_per_s.iloc[0] > 0
    assert any("the largest for small strains" in text for text in result.warnings)


def test_pressure_that_opens_the_seal():
    sealed = case(load={**VALVE, "closing": "sealed-area"})
    area = math.pi * sealed.initial_contact_radius**2
    assert fem_seal.blow_off_pressures(sealed) == pytest.approx([1500 / area] * 5, rel=1e-12)
    # where the fluid gets to is a few per mille of the radius
    coupled = fem_seal.blow_off_pressures(case(load=VALVE))
    assert coupled == pytest.approx([1500 / area] * 5, rel=2e-3)
    assert coupled == pytest.approx(valve().table.blow_off_pressure_Pa.to_numpy(), rel=1e-4)
    assert fem_seal.blow_off_pressures(case()).tolist() == [math.inf] * 3


@pytest.mark.slow
@pytest.mark.usefixtures("unrendered")
def test_summary_and_report_have_the_answers():
    told = summary(valve())
    assert told["loads"][0]["force_for_target_leak_N"] == valve().loads[0].force_for_target
    assert told["input"]["load"]["target_leak_rate"] == pytest.approx(TARGET)
    page = report(valve(), full=True).replace("\xa0", " ")
    for text in ("applied force for the target", "opens at", "Far from the contact, ", "between them"):
        assert text in page
    json.dumps(told["far_field"])
    # the load with the largest contact force is that of the lowest fluid pressure
    assert "Far from the contact, at 5 bar (the load with the largest contact force): " in page
    opens = f"{valve().loads[0].blow_off_pressure / 1e5:.2f} bar"
    last = valve().loads[2]
    force = f"{last.force_for_target:.0f} N to {last.scenarios[Reading.CAPPED].force_for_target / 1e3:.2f} kN"
    result = page[page.index('id="result"') : page.index('id="case"')]
    carried = f"the contact carries {valve().highest.contact_force:.0f} N of the applied 1500 N."
    assert re.search(rf"The fluid opens the seal at {opens}; at [\d.]+ % of it {carried}", result)
    for name, value in (("Opens at", opens), ("Force for the target leak rate", force)):
        assert re.search(rf'"name">{name}</span>\s*<span class="value">{value}</span>', result)
    # no table is wider than the page: twelve columns fit
    widths = [table.count('scope="col"') for table in page.split("<table")[1:]]
    assert max(widths) <= 12


@pytest.mark.slow
def test_a_path_of_forces_is_told_by_its_forces():
    result = fem_seal.run(case(load={"fluid_pressure": "5 bar", "applied_force": ["0 N", "200 N", "1 kN"]}))
    leaks = result.table.leak_rate_m3_per_s.to_numpy()
    assert (np.diff(leaks) < 0).all()
    page = report(result, full=True).replace("\xa0", " ")
    assert "5 bar, 5 bar" not in page
    result_section = page[page.index('id="result"') : page.index('id="case"')]
    for where in ("at 5 bar with 1000 N;", "The contact at 5 bar with 1000 N:"):
        assert where in result_section
    for force in ("0", "200", "1000"):
        assert re.search(rf"<t[dh][^>]*>5 bar with {force} N<", page)
    pictures = [base64.b64decode(code).decode() for code in re.findall(r"svg\+xml;base64,([\w+/=]+)", page)]
    over_force = [text for text in pictures if "applied force [N]" in " ".join(text.split())]
    # peak pressure and width, and the leak rate
    assert len(over_force) == 2


@pytest.mark.parametrize(
    "load",
    [
        {"fluid_pressure": "5 bar", "applied_force": ["0 N", "200 N", "1 kN"]},
        {"fluid_pressure": ["5 bar", "20 bar", "5 bar"]},
    ],
)
def test_profiles_of_loads_at_the_same_pressure_are_read_back_one_by_one(load, tmp_path):
    result = fem_seal.run(case(load=load))
    profiles = read_profiles(write_profile_csv(result, tmp_path / "profile.csv"), result.problem.contact)
    assert [one.fluid_pressure for one in profiles] == [one.fluid_pressure for one in result.loads]
    for found, one in zip(profiles, result.profiles, strict=True):
        np.testing.assert_allclose(found.x, one.x, rtol=1e-9)
        np.testing.assert_allclose(found.pressure, one.pressure, rtol=1e-9)


def test_a_single_pressure_under_several_forces_is_told_once():
    several = case(
        load={
            "fluid_pressure": "5 bar",
            "applied_force": ["0 N", "200 N", "1 kN"],
            "target_leak_rate": "1e3 m^3/s",
        }
    )
    # that any force meets it is one remark and not three
    assert len(target_remarks(problems_of(several))) == 1
    loads = [
        CaseLoad(5e5, force, None).with_values(leak=LeakResult(1e-9, 1e15, None)) for force in (0.0, 200.0)
    ]
    (lines, _) = leakage_lines(several, loads[1], loads)
    assert lines.startswith("Leak rate at 5 bar with 200 N:")


# ---------------------------------------------------------------- press fit and far field


def flat_ring(bore=0.01, outer=0.03, height=0.02):
    """A flat ring with a rounded plunger on it, condensed with its wall held."""
    face = meshes.chain([(bore, 0.0), (0.9 * outer, 0.0)], "seat_face")
    seat = meshes.housing(face, outer, height)
    closure = meshes.ToroidalEdge.of(0.018, 0.004).outline
    contact = meshes.ContactGeometry.of(closure, seat)
    sizing = meshes.Sizing(1e-4, 3e-4, (-1e-3, 1e-3), 0.2, 0.4, 1e-3)
    mesh = meshes.build_contact(contact, sizing)
    return condense(mesh, {"closure": STEEL, "seat": STEEL}, Supports(wall="fixed"))


def test_a_ring_pressed_into_a_bore_is_that_of_lame():
    bore, outer, interference = 0.01, 0.03, 20e-6
    ring = flat_ring(bore, outer)
    seat = ring.seat
    moved = BodyLoads.press_fit(interference).displacement(seat, ring)
    r, z = quadratic_nodes(seat.fem.mesh)[0].T
    # u = A r + B/r with sigma_r(bore) = 0, u(outer) = -interference, sigma_z = 0
    nu, E = STEEL.poissons_ratio, STEEL.youngs_modulus
    ratio = bore**2 * (1 + nu) / (1 - nu)
    A = -interference / (outer + ratio / outer)
    radial, axial = moved[node_dofs(seat.fem.mesh)]
    # quadratic elements of up to 1 mm for 1/r from 10 mm on
    assert radial == pytest.approx(A * r + A * ratio / r, abs=5e-5 * interference)
    # the faces stay flat: uniform strain -nu (sigma_r + sigma_t)/E, the bottom held
    strain = -2 * nu * A / (1 - nu)
    assert axial == pytest.approx(strain * (z - z.min()), abs=5e-5 * interference)
    stress = seat.recovery.stress(moved)
    hoop = 2 * E / (1 - nu) * A
    at_bore = r < bore * (1 + 1e-9)
    # second order in the element size of 1 mm in 10 mm
    assert stress[at_bore, 2] == pytest.approx(hoop, rel=1e-2)
    # what the contact feels: the flat seat sinks and stays flat, the closure does not notice
    opening = BodyLoads.press_fit(interference).opening(ring)
    assert opening == pytest.approx(-strain * 0.02, abs=5e-5 * interference)


def test_the_press_fit_stands_in_the_case():
    seat = cone("steel", wall="fixed", outer_radius="25 mm")
    fitted = fem_seal.run(
        smooth_case(seat={**seat, "interference": "10 um"}, load={"fluid_pressure": "20 bar"})
    )
    load = fitted.loads[0]
    field = load.contact.fields["seat"]
    at_wall = field.points[:, 0] > 0.025 * (1 - 1e-9)
    assert at_wall.sum() > len(fitted.seal_mesh.seat.boundaries["seat_wall"])
    assert field.displacement[at_wall, 0] == pytest.approx(-10e-6, rel=1e-12)
    # 10 um on 25 mm strain the housing by 4e-4, 84 MPa; the contact alone gives 60 MPa
    assert load.max_von_mises > 100e6
    # the spring carries no more and no less for it
    assert load.contact_force == pytest.approx(
        math.pi * fitted.case.initial_contact_radius**2 * 20e5, rel=1e-12
    )
    # another size would be another fit
    assert fitted.far_field == ()
    assert far_field_sentence(fitted) == ""


@pytest.mark.slow
def test_the_far_field_matters_where_the_housing_is_small():
    seat = cone("steel", bore_radius="12.5 mm", face_radius="15.5 mm", outer_radius="16 mm", height="3 mm")
    small = fem_seal.run(smooth_case(seat=seat, load={"fluid_pressure": "200 bar"}))
    assert [change.name for change in small.far_field] == [
        "a housing twice as wide and high",
        "holding its wall",
    ]
    # The default sizes are meant to be far enough away: 1e-5 of the peak, and the noise of another far mesh.
    assert max(abs(change.peak_pressure) for change in valve().far_field) < 1e-4
    assert abs(small.far_field[0].peak_pressure) > 1e-3
    # What is said is what a run with such a housing gives.
    wide = smooth_case(
        seat={**seat, "outer_radius": "32 mm", "height": "6 mm"}, load={"fluid_pressure": "200 bar"}
    )
    changed = fem_seal.run(wide).loads[0].contact.profile.peak_pressure
    share = changed / small.loads[0].contact.profile.peak_pressure - 1
    # on a coarse mesh, two elements of which make the rim of 0.5 mm
    assert small.far_field[0].peak_pressure == pytest.approx(share, rel=0.25)
    assert "a housing twice as wide and high changes the peak pressure by" in far_field_sentence(small)


@pytest.mark.parametrize("larger", [False, True], ids=["held wall", "larger housing"])
def test_a_closure_that_is_the_same_is_not_factorised_anew(larger):
    """To the last digit what it is without; another material or another mesh is another closure."""
    problem = SealProblem.of(valve().case)
    mesh = valve().seal_mesh
    known = condense(mesh, problem.materials)
    if larger:
        mesh = meshes.build_contact(larger_housing(valve().case), mesh.sizing)
    supports = None if larger else Supports(wall="fixed")
    anew = condense(mesh, problem.materials, supports)
    reused = condense(mesh, problem.materials, supports, known=known)
    assert reused.closure is known.closure and reused.harmonics[0] is known.harmonics[0]
    assert reused.seat is not known.seat
    np.testing.assert_array_equal(reused.compliance, anew.compliance)
    softer = {**problem.materials, "closure": replace(STEEL, youngs_modulus=100e9)}
    assert condense(mesh, softer, known=known).closure is not known.closure
    finer = meshes.build_contact(problem.contact, mesh.sizing.refined(1.2))
    assert condense(finer, problem.materials, known=known).closure is not known.closure
