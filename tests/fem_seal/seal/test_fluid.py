"""Fluids in a case: temperatures, gases, nominal sizes, and what the results say of them."""

from __future__ import annotations

import json
import math
import re
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from sample_results import case, cone, rough_result, run_loads

import fem_seal
import leak
from fem_seal.answers.leakage_class import leakage_classes, nominal_size
from fem_seal.errors import InputError
from fem_seal.output.answers.leak import leakage_lines, leakage_text
from fem_seal.output.files import summary
from fem_seal.output.report.page import report
from fem_seal.output.tables import leak_table, leakage_table
from fem_seal.seal.findings import Level
from fem_seal.seal.load_result import LoadResult
from fem_seal.studies.responses import evaluate_design
from fem_seal.units import parse_quantity
from fem_seal.validity import fluid as fluid_warnings
from fem_seal.validity.fluid import _of_liquid
from leak import GasInertia, LeakResult, Reading


@cache
def helium_result() -> fem_seal.SealResult:
    """Two loads of helium against vacuum."""
    return fem_seal.run(
        case(
            fluid={"name": "helium", "outlet_pressure": "0 Pa"},
            load={"fluid_pressure": ["1 bar", "200 bar"]},
            leak={"nominal_size": "DN 25"},
        )
    )


@pytest.mark.parametrize(
    ("text", "kelvin"),
    [("20 degC", 293.15), ("-40 °C", 233.15), ("293.15 K", 293.15), ("68 degF", 293.15), ("-40degF", 233.15)],
)
def test_temperatures(text, kelvin):
    assert parse_quantity(text, "temperature") == pytest.approx(kelvin, rel=1e-15)


@pytest.mark.parametrize("text", ["20", "20 C", "20 bar", "warm", "1e999 K", 20, "20,5 degC"])
def test_no_temperatures(text):
    with pytest.raises(ValueError, match="temperature"):
        parse_quantity(text, "temperature")


def test_viscosity_follows_the_temperature():
    hot = case(fluid={"name": "water", "temperature": "80 degC"}).fluid
    assert hot.viscosity == pytest.approx(leak.liquid("water", 353.15).viscosity)
    assert hot.density == pytest.approx(971.8, rel=1e-4)
    assert hot.gas is None
    own = case(fluid={"name": "our oil", "viscosity": "30 mPa s"}).fluid
    assert own.library_entry is own.gas is own.density is None
    changed = case(fluid={"name": "helium", "viscosity": "25 uPa s"}).fluid
    assert changed.gas.viscosity == pytest.approx(25e-6)
    assert changed.outlet_pressure == 101325.0


def test_coolprop_in_a_case():
    pytest.importorskip("CoolProp.CoolProp", reason="CoolProp is optional")
    assert case(fluid={"name": "CoolProp:Water"}).fluid.viscosity == pytest.approx(1.0016e-3, rel=1e-3)
    assert case(fluid={"name": "CoolProp:R134a"}).fluid.gas is not None


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"fluid": {"name": "heluim"}}, "helium"),
        ({"fluid": {"name": "water", "temperature": "200 degC"}}, "temperature = 473.15 K"),
        ({"fluid": {"name": "water", "temperature": "hot"}}, "fluid.temperature"),
        ({"fluid": {"name": "helium", "outlet_pressure": "-1 bar"}}, "fluid.outlet_pressure"),
        ({"fluid": {"name": "water", "outlet_pressure": "1 bar"}}, "only for a gas"),
        ({"leak": {"nominal_size": "DN"}}, "leak.nominal_size"),
        ({"leak": {"nominal_size": 25}}, "leak.nominal_size"),
    ],
)
def test_wrong_input(change, message):
    with pytest.raises(InputError) as caught:
        case(**change)
    assert message in str(caught.value)


@pytest.mark.slow
def test_gas_in_a_case_is_the_gas_flow_of_its_profile():
    result = helium_result()
    load = result.loads[0]
    profile = load.contact.profile
    direct = leak.gas_leak_flow(
        profile.x, profile.pressure, result.surface, leak.gas("helium"), 1e5, 0.0, profile.radius
    )
    # the two tables cover different ranges
    assert load.leak.leak_rate == pytest.approx(direct.leak_rate, rel=1e-3)
    np.testing.assert_allclose(load.leak.fluid_pressure, direct.fluid_pressure, rtol=2e-3, atol=100.0)
    assert load.scenarios[Reading.ELASTIC].leak.leak_rate > load.leak.leak_rate
    row = leak_table(result).iloc[0]
    assert row.leak_rate_kg_per_s == pytest.approx(direct.mass_flow, rel=1e-3)
    assert row.leak_rate_Pa_m3_per_s == pytest.approx(direct.throughput, rel=1e-3)
    assert row.leak_rate_standard_m3_per_s == pytest.approx(direct.standard_leak_rate, rel=1e-3)
    assert row.knudsen_number == pytest.approx(direct.knudsen_number, rel=1e-3)


def test_liquid_has_no_throughput():
    row = leak_table(rough_result()).iloc[-1]
    assert row.leak_rate_kg_per_s == pytest.approx(row.leak_rate_m3_per_s * 998.2, rel=1e-4)
    of_gases = {"leak_rate_Pa_m3_per_s", "leak_rate_standard_m3_per_s", "knudsen_number"}
    assert not of_gases & {*row.index}


def test_dense_gas_is_warned_of():
    assert any("helium at 200 bar is not a dilute ideal gas" in text for text in helium_result().warnings)


def test_readable_leak_and_class():
    result = rough_result()
    load = result.loads[-1]
    assert "ml/min" in leakage_text(result.case.display, load) and "drops/min" in leakage_text(
        result.case.display, load
    )
    assert [one.standard for one in leakage_classes(result.case, load)] == ["ISO 5208", "API 598", "FCI 70-2"]
    size = nominal_size(result.case)
    assert size.is_estimated and size.size == 0.025
    # no bore is given: what the size is taken from is the circle of contact, and is called so
    assert "estimated from the circle of first touch, 28.3 mm in diameter" in " ".join(
        leakage_lines(result.case, load, result.loads)
    )
    bored = case(seat=cone(bore_radius="12 mm"))
    assert str(nominal_size(bored)) == "DN 25, estimated from the bore of the seat, 24.0 mm in diameter"
    gas = helium_result()
    assert str(nominal_size(gas.case)) == "DN 25"
    line = leakage_lines(gas.case, gas.loads[0], gas.loads)[0]
    assert all(unit in line for unit in ("mbar l/s", "Pa m³/s", "ml/min (20 °C and 1.01325 bar)", "kg/s"))


@pytest.mark.parametrize(
    ("size", "told"), [("DN 400", True), ("DN 65", False), ("DN 15", False), ("DN 10", True)]
)
def test_a_nominal_size_that_is_not_of_the_seat_is_told(size, told):
    """First touch is on a circle of 28.3 mm."""
    warnings = fem_seal.run(case(leak={"nominal_size": size})).warnings
    said = [text for text in warnings if text.startswith(f"{size} with a circle of first touch")]
    assert len(said) == told
    assert all(text.endswith("those of DN 25") for text in said)


def test_a_seat_below_all_nominal_sizes_is_no_wrong_one():
    tiny = fem_seal.run(case(closure={"shape": "ball", "radius": "0.3 mm", "material": "steel"}))
    assert not any("nominal_size" in text for text in tiny.warnings)


@pytest.mark.usefixtures("unrendered")
def test_summary_and_report_hold_units_and_class():
    result = helium_result()
    entries = leakage_table(result)
    assert [entry["fluid_pressure"] for entry in entries] == [1e5, 2e7]
    assert set(entries[0]["classes"]) == {"ISO 5208", "API 598", "FCI 70-2"}
    assert json.dumps(summary(result)["leakage"])
    page = report(result, full=True).replace("\xa0", " ")
    for text in ("mbar l/s", "Leakage class, DN 25", "ISO 5208", "Fukui", "Hurly"):
        assert text in page


def test_the_viscosity_of_a_gas_is_no_factor_of_its_leak():
    with pytest.raises(InputError, match="only for a liquid"):
        case(fluid={"name": "helium"}, uncertainty={"viscosity": {"relative": 0.1}})


# -------------------------------------------------------------------- liquids that thicken

# the fluid lifts the ball with 113 kN
THICK = {"load": {"fluid_pressure": ["1800 bar"], "applied_force": "118 kN", "pressure_side": "inner"}}


def leak_of(**fluid):
    """Leak and warnings of a liquid at 1800 bar."""
    result = fem_seal.run(case(fluid=fluid, **THICK), sensitivities=False)
    (load,) = result.loads
    return load, " ".join(result.warnings)


@pytest.mark.slow
def test_thickening_divides_the_leak_rate_by_its_mean():
    own = {"name": "our oil", "viscosity": "3 mPa s"}
    plain, said = leak_of(**own)
    barus, _ = leak_of(**own, pressure_viscosity="10 1/GPa")
    roelands, _ = leak_of(**own, roelands_z=0.67)
    assert "viscosity of our oil under 1800 bar is not known" in said
    x = 10e-9 * 1.8e8
    assert barus.leak.leak_rate / plain.leak.leak_rate == pytest.approx(-math.expm1(-x) / x, rel=1e-9)
    law = leak.Roelands(0.67, 3e-3)
    assert plain.leak.leak_rate / roelands.leak.leak_rate == pytest.approx(
        leak.effective_viscosity_ratio(law, 1.8e8), rel=1e-9
    )
    # the factors that the warning names enclose what such oils do
    low, high = (
        float(one) for one in said.split("the real leak rate is ")[1].split(" times")[0].split(" to ")
    )
    assert low < barus.leak.leak_rate / plain.leak.leak_rate < high


@pytest.mark.usefixtures("unrendered")
def test_diesel_of_the_library():
    result = fem_seal.run(case(fluid={"name": "diesel"}, **THICK), sensitivities=False)
    (load,), said = result.loads, " ".join(result.warnings)
    page = report(result, full=True)
    assert "H. I. Waterman" in page and "viscosity at 1800 bar" in page
    diesel = leak.liquid("diesel")
    assert load.effective_viscosity / diesel.viscosity == pytest.approx(2.53, abs=0.01)
    # what leaks has expanded to atmospheric pressure
    assert load.leak.mass_flow == pytest.approx(load.leak.leak_rate * diesel.density, rel=1e-12)
    assert "thicken" not in said


def test_own_viscosity_of_a_library_liquid_keeps_its_law():
    thin, thick = (case(fluid={"name": "diesel", "viscosity": text}).fluid for text in ("2 mPa s", "4 mPa s"))
    assert thin.pressure_law.coefficient < thick.pressure_law.coefficient
    assert case(fluid={"name": "diesel", "pressure_viscosity": "0 1/GPa"}).fluid.pressure_law.viscosity_ratio(
        1e8
    ) == pytest.approx(1.0)
    assert case(fluid={"name": "diesel", "viscosity": "0.01 mPa s"}).fluid.pressure_law is not None


@pytest.mark.parametrize(
    ("fluid", "said"),
    [
        ({"name": "helium", "pressure_viscosity": "20 1/GPa"}, "only for a liquid.*CoolProp"),
        ({"viscosity": "1 mPa s", "pressure_viscosity": "20 1/GPa", "roelands_z": 0.6}, "remove one of them"),
        ({"viscosity": "0.05 mPa s", "roelands_z": 0.6}, "as thin as 0.05 mPa s"),
        ({"viscosity": "1 mPa s", "pressure_viscosity": "20 GPa"}, 'such as "20 1/GPa"'),
        ({"viscosity": "1 mPa s", "pressure_viscosity": "-1 1/GPa"}, "out of range"),
    ],
)
def test_keys_of_thickening_that_make_no_sense(fluid, said):
    with pytest.raises(InputError, match=said):
        case(fluid=fluid)


@pytest.mark.slow
def test_fluid_opens_less_where_it_is_thick_next_to_the_inlet():
    """The high pressure gets less far: of a penetrated contact the leak falls by more than the mean viscosity."""
    settings = {"load": {"fluid_pressure": ["300 bar"], "applied_force": "3 kN", "closing": "penetration"}}
    plain, thick = (
        run_loads(
            case(fluid={"viscosity": "3 mPa s", "pressure_viscosity": f"{alpha} 1/GPa"}, **settings)
        ).loads[0]
        for alpha in (0, 60)
    )
    before, after = (
        np.trapezoid(load.leak.fluid_pressure, load.contact.profile.x) for load in (plain, thick)
    )
    assert after < before
    ratio = leak.effective_viscosity_ratio(leak.Barus(60e-9), 3e7)
    assert thick.leak.leak_rate < plain.leak.leak_rate / ratio


# -------------------------------------------------------------------- gases at high pressure

DENSE = {"load": {"fluid_pressure": ["700 bar"], "applied_force": "46 kN", "pressure_side": "inner"}}


@pytest.mark.slow
def test_dense_gas_says_how_much_and_names_the_real_gas():
    warnings = " ".join(fem_seal.run(case(fluid={"name": "hydrogen"}, **DENSE), sensitivities=False).warnings)
    assert "hydrogen at 701 bar is not a dilute ideal gas" in warnings
    assert "about 0.69 times as much leaks" in warnings
    assert '[fluid] name = "CoolProp:Hydrogen" calculates with the real gas' in warnings


def test_real_hydrogen_leaks_less():
    pytest.importorskip("CoolProp")
    ideal, real = (
        fem_seal.run(case(fluid={"name": name}, **DENSE), sensitivities=False)
        for name in ("hydrogen", "CoolProp:Hydrogen")
    )
    assert not any("dilute" in text or "extrapolated" in text for text in real.warnings)
    ratio = real.loads[0].leak.mass_flow / ideal.loads[0].leak.mass_flow
    # the viscosities of both libraries differ by up to 2 %, and slip adds a little
    assert ratio == pytest.approx(0.680, rel=0.04)


def test_a_gas_that_is_liquid_at_the_inlet_is_outside_the_theory():
    pytest.importorskip("CoolProp")
    result = fem_seal.run(case(fluid={"name": "CoolProp:CarbonDioxide"}, **DENSE), sensitivities=False)
    assert result.loads[0].validity.outside_theory
    assert any("condenses at 57.29 bar" in text for text in result.warnings)


@pytest.mark.slow
def test_gas_through_a_wide_gap_chokes():
    """Of a lightly loaded rough seat: what viscous flow says is more than sound allows."""
    rough = {"spectrum": {"kind": "self-affine", "rms_height": "20 um", "hurst": 0.8,
             "q_low": "1e3 1/m", "q_rolloff": "1e4 1/m", "q_high": "1e6 1/m"}}  # fmt: skip
    load = {"fluid_pressure": ["20 bar"], "applied_force": "1.5 kN", "pressure_side": "inner"}
    result = fem_seal.run(case(fluid={"name": "nitrogen"}, roughness=rough, load=load), sensitivities=False)
    (said,) = (text for text in result.warnings if "Mach number" in text)
    assert "it chokes" in said and "the real leak rate is lower" in said
    # slow enough at either load, but for the reading at 200 bar in which eight times as much leaks
    (said,) = (text for text in helium_result().warnings if "Mach" in text)
    assert "where the surface changes only where it touches" in said and "(at 200 bar)" in said


ROUGH = {"spectrum": {"kind": "self-affine", "rms_height": "20 um", "hurst": 0.8,
         "q_low": "1e3 1/m", "q_rolloff": "1e4 1/m", "q_high": "1e6 1/m"}}  # fmt: skip


def test_a_liquid_through_a_wide_gap_is_too_fast_for_viscous_flow():
    """Water where a gas would choke: inertia over friction, with a gap that the leak rate itself tells."""
    load = {"fluid_pressure": ["20 bar"], "applied_force": "1.5 kN", "pressure_side": "inner"}
    result = run_loads(case(fluid={"name": "water"}, roughness=ROUGH, load=load))
    (said,) = (text for text in result.warnings if "Reynolds number" in text)
    assert "the real leak rate is lower" in said
    (one,) = result.loads
    assert one.validity.level is not Level.VALID
    # a kilogram per second and metre over the viscosity, twice
    told = float(re.findall(r"Reynolds number ([\d.]+) in the gap", said)[0])
    per_length = one.leak.mass_flow / (2 * math.pi * one.contact.model.initial_contact_radius)
    assert told == pytest.approx(2 * per_length / one.effective_viscosity, rel=0.06)


@pytest.mark.slow
@pytest.mark.parametrize(("fluid", "amplitude"), [("nitrogen", "4 um"), ("water", "12 um")])
def test_inertia_of_an_oval_seat_is_that_of_a_round_one_as_lightly_loaded_as_its_weakest_place(
    fluid, amplitude
):
    spectrum = {**ROUGH["spectrum"], "rms_height": "2 um"}
    tables = {"fluid": {"name": fluid}, "roughness": {"spectrum": spectrum}}

    def pressed(force, **more):
        load = {"fluid_pressure": ["20 bar"], "applied_force": f"{force} N", "pressure_side": "inner"}
        return run_loads(case(**tables, load=load, **more))

    waves = [{"waves": 2, "amplitude": amplitude}]
    oval = pressed(4000, form={"seat": {"direction": "radial", "harmonics": waves}})
    (load,), flow = oval.loads, oval.problem.flow
    off = (1 - load.around.least_over_mean) * load.contact.contact_force
    (weakest,) = pressed(4000 - off).loads
    if flow.gas is None:
        assert _of_liquid(flow, load) == pytest.approx(_of_liquid(flow, weakest), rel=1e-2)
    else:
        (found, reduced), (round_, reduced_round) = (
            fluid_warnings._inertia_of(flow, one) for one in (load, weakest)
        )
        assert (found.reynolds, reduced) == pytest.approx((round_.reynolds, reduced_round), rel=1e-2)
        assert found.acceleration == pytest.approx(round_.acceleration, rel=1e-2)
        # the gas pressure, on which the speed at the outlet hangs, is that of a line load a little lower
        assert found.mach == pytest.approx(round_.mach, rel=0.06)
    (said,) = (text for text in oval.warnings if "Reynolds number" in text)
    assert "(at 20 bar, where most leaks around the axis)" in said
    assert load.validity.level is (Level.DOUBTFUL if flow.gas is None else Level.OUTSIDE)


def test_inertia_of_a_liquid_in_a_uniform_gap():
    """q = u^3 dp/(12 eta L) between plates: gap and both Reynolds numbers come back."""
    eta, gap, length, drop, r = 1e-3, 3e-6, 2e-4, 5e5, 0.01
    q = gap**3 * drop / (12 * eta * length)
    profile = SimpleNamespace(radius=np.array([r]), pressure=np.ones(1), std=0.5 * length)
    load = LoadResult(drop, 0.0, SimpleNamespace(profile=profile))
    load = load.with_values(leak=LeakResult(2 * math.pi * r * q, 1.0, None).with_density(900.0))
    water = SimpleNamespace(viscosity=eta, effective_viscosity=lambda pressure: None)
    reynolds, reduced = _of_liquid(water, load)
    assert reynolds == pytest.approx(2 * 900 * q / eta) and reduced == pytest.approx(
        900 * q / eta * gap / length
    )
    assert _of_liquid(water, LoadResult(drop, 0.0, SimpleNamespace(profile=profile))) is None


def test_a_turbulent_load_is_told_before_one_of_more_inertia(monkeypatch):
    profile = SimpleNamespace(profile=None)
    wide, turbulent = (LoadResult(drop, 0.0, profile) for drop in (1e5, 2e5))
    numbers = {id(wide): (1500.0, 3.0), id(turbulent): (2500.0, 2.0)}
    monkeypatch.setattr(fluid_warnings, "_of_liquid", lambda flow, load: numbers[id(load)])
    (found,) = fluid_warnings._inertia(SimpleNamespace(fluid="water", gas=None), [wide, turbulent])
    assert found.level is Level.OUTSIDE and "at 2 bar" in found.text()


@pytest.mark.parametrize(
    ("acceleration", "reduced", "least"), [(0.2, 0.5, 0.8), (0.06, 3.0, 1 / 1.3), (0.0, 2.0, 1 / 1.2)]
)
def test_inertia_says_how_much_less_may_leak(monkeypatch, acceleration, reduced, least):
    """The share of the flow that acceleration takes, or of the pressure, a tenth at one; of an upper end nothing."""
    load = LoadResult(1e5, 0.0, SimpleNamespace(profile=None))
    of_gas = GasInertia(100.0, 0.3, acceleration), reduced
    monkeypatch.setattr(fluid_warnings, "_inertia_of", lambda flow, load: of_gas)
    found = fluid_warnings._fastest_gas(SimpleNamespace(), [load], [(load, load)], end=False)
    assert found.leak_factor == (pytest.approx(least), 1.0) and found.leak_error == pytest.approx(1 - least)
    end = fluid_warnings._fastest_gas(SimpleNamespace(), [load], [(load, load)], end=True)
    assert end.leak_factor == (1.0, 1.0)
    if reduced > 1:
        monkeypatch.setattr(fluid_warnings, "_of_liquid", lambda flow, load: (500.0, reduced))
        (found,) = fluid_warnings._inertia(SimpleNamespace(fluid="water", gas=None), [load])
        assert found.leak_factor == (pytest.approx(1 / (1 + 0.1 * reduced)), 1.0)


@pytest.mark.slow
def test_the_end_of_an_interval_that_chokes_makes_it_doubtful():
    """In the reading that leaks little the gas is slow; in the other it would be faster than sound."""
    spectrum = {"kind": "self-affine", "rms_height": "2.85 um", "hurst": 0.93,
                "q_low": "6.35e3 1/m", "q_rolloff": "1.67e5 1/m", "q_high": "1.06e6 1/m"}  # fmt: skip
    soft = {"shape": "cone", "angle": "60 deg", "material": "316L"}
    hard = {"shape": "ball", "radius": "5.4 mm", "material": "tungsten carbide WC-Co"}
    result = run_loads(
        case(
            fluid={"name": "nitrogen"},
            closure=hard,
            seat=soft,
            roughness={"spectrum": spectrum},
            load={"fluid_pressure": ["4.41 bar"]},
        )
    )
    (one,) = result.loads
    assert one.scenarios[Reading.CAPPED].leak.leak_rate > 100 * one.leak.leak_rate
    assert one.validity.level is Level.DOUBTFUL
    (said,) = (text for text in result.warnings if "Mach number" in text)
    assert (
        "only where it touches" in said
        and "it chokes" in said
        and "the real leak rate is lower than the upper end" in said
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("fluid", "amplitude"), [("water", "20 um"), ("nitrogen", "0.5 um"), ("water", None)]
)
def test_a_study_sees_the_inertia_that_a_run_sees(fluid, amplitude):
    spectrum = {**ROUGH["spectrum"], "rms_height": "2.5 um"}
    load = {"fluid_pressure": ["20 bar"], "applied_force": "4 kN", "pressure_side": "inner"}
    waves = {"form": {"seat": {"direction": "radial", "harmonics": [{"waves": 2, "amplitude": amplitude}]}}}
    seal = case(
        fluid={"name": fluid},
        roughness={"spectrum": spectrum},
        load=load,
        requirement={"leak_rate": "1 l/min"},
        **(waves if amplitude else {}),
    )
    told = [
        {one.reason() for one in validity.cautions if one.kind == "inertia"}
        for validity in (
            evaluate_design(seal, ("leak_rate_m3_per_s", "margin")).validity,
            run_loads(seal).loads[0].validity,
        )
    ]
    assert told[0] == told[1] and bool(told[0]) == (amplitude is not None)
