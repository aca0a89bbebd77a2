"""Leak over pressure and force: the loads of a run, areas by their formula, files as other programs read them."""

import csv
import math
import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from places import EXAMPLES
from sample_results import case, cone, run_loads
from scipy.interpolate import RegularGridInterpolator
from scipy.optimize import minimize_scalar

import fem_seal
import leak
from fem_seal import InputError
from fem_seal.answers.leak_map import _with_return
from fem_seal.cli import app as cli
from fem_seal.cli.table import grid
from fem_seal.output.leak_map import matlab_text, modelica_text, tables_of
from fem_seal.seal.findings import Bounds, remark
from fem_seal.units import Display
from leak.flow.leak_result import leakage_area_of_gas, leakage_area_of_liquid
from leak.fluids.library import HEAT_CAPACITIES, heat_capacity_ratio

PRESSURES, FORCES = [2e5, 20e5], [0.0, 400.0, 1000.0]
NITROGEN = leak.gas("nitrogen")


@pytest.fixture(scope="module")
def water():
    return fem_seal.leak_map(case(), PRESSURES, FORCES)


@pytest.fixture(scope="module")
def inside():
    """With the fluid in the bore: it opens the seal at the higher pressures under the smaller forces."""
    load = {
        "fluid_pressure": ["1 bar", "5 bar", "10 bar"],
        "pressure_side": "inner",
        "applied_force": "500 N",
    }
    return fem_seal.leak_map(case(load=load), applied_force=[100.0, 400.0, 1000.0])


@pytest.fixture(scope="module")
def gas(inside):
    """The same numbers as those of a gas."""
    helium, outlet = leak.gas("helium"), 101325.0
    density = helium.density(outlet)
    areas = [
        leakage_area_of_gas(density, outlet + dp, outlet, helium, 5 / 3)
        for dp in inside.fluid_pressure.tolist()
    ]
    return replace(inside, fluid="helium", is_gas=True, density=density, area_of_leak_rate=np.array(areas))


# --- areas ------------------------------------------------------------------------------------------------


def test_area_of_a_liquid_gives_the_flow_back():
    area, dp, density = 3e-9, 7e5, 870.0
    assert leakage_area_of_liquid(area * math.sqrt(2 * dp / density), dp, density) == pytest.approx(
        area, rel=1e-14
    )


@pytest.mark.parametrize("k", [1.2, 1.4, 5 / 3])
@pytest.mark.parametrize("outlet", [0.0, 1e5, 4e5, 6.9e5])
def test_area_of_a_gas_is_that_of_an_isentropic_nozzle(k, outlet):
    # density times velocity by the energy equation at every pressure in the nozzle; its throat has the most
    inlet, T, R = 7e5, NITROGEN.temperature, NITROGEN.specific_gas_constant

    def flux(p):
        cooled = T * (p / inlet) ** ((k - 1) / k)
        return p / (R * cooled) * math.sqrt(2 * k / (k - 1) * R * (T - cooled))

    throat = minimize_scalar(lambda p: -flux(p), bounds=(outlet + 1e-6, inlet), method="bounded")
    most = max(-throat.fun, flux(max(outlet, 1e-6)))
    assert leakage_area_of_gas(most * 2e-9, inlet, outlet, NITROGEN, k) == pytest.approx(2e-9, rel=1e-6)


def test_area_of_a_gas_is_that_of_a_liquid_for_small_pressure_differences():
    density, dp = NITROGEN.density(1e5), 1.0
    liquid = leakage_area_of_liquid(1e-9 / density, dp, density)
    # the first correction is of order dp/p = 1e-5
    assert leakage_area_of_gas(1e-9, 1e5 + dp, 1e5, NITROGEN, 1.4) == pytest.approx(liquid, rel=2e-5)


def test_choked_nozzle_has_the_published_critical_flow_function():
    # C* of an ideal gas of kappa = 1.4 is 0.684731 (ISO 9300)
    root = math.sqrt(NITROGEN.specific_gas_constant * NITROGEN.temperature)
    assert leakage_area_of_gas(0.684731 * 9e5 / root, 9e5, 1e5, NITROGEN, 1.4) == pytest.approx(1.0, rel=1e-6)


@pytest.mark.parametrize("name", HEAT_CAPACITIES)
def test_heat_capacities_are_those_of_another_source(name):
    pytest.importorskip("CoolProp")
    words = {"carbon dioxide": "CarbonDioxide"}
    other = heat_capacity_ratio("CoolProp:" + words.get(name, name.capitalize()))
    assert heat_capacity_ratio(name) == pytest.approx(other, rel=1e-3)
    assert heat_capacity_ratio("my gas") is None


# --- the map ----------------------------------------------------------------------------------------------


def test_points_are_those_of_a_run(water):
    alone = fem_seal.run(case(load={"fluid_pressure": "20 bar", "applied_force": "400 N"}))
    (ends,) = alone.leak_ranges
    # another mesh: the discretisation error is up to 0.2 %
    assert water.leak_rate[1, 1] == pytest.approx(alone.loads[0].leak.leak_rate, rel=2e-3)
    assert (water.leak_rate_low[1, 1], water.leak_rate_high[1, 1]) == pytest.approx(ends, rel=2e-3)
    assert water.level[1][1] == str(alone.loads[0].validity.level)
    assert water.leak_rate.shape == (2, 3)
    assert np.all(np.diff(water.leak_rate, axis=0) > 0)
    assert np.all(np.diff(water.leak_rate, axis=1) < 0)
    assert np.all(water.leak_rate_low <= water.leak_rate) and np.all(water.leak_rate <= water.leak_rate_high)


def test_areas_and_masses_follow_from_the_leak_rate(water):
    orifice = water.leakage_area * np.sqrt(2 * water.fluid_pressure[:, None] / water.density)
    assert orifice == pytest.approx(water.leak_rate, rel=1e-14)
    assert water.mass_flow == pytest.approx(leak.liquid("water").density * water.leak_rate, rel=1e-14)


@pytest.mark.slow
def test_a_gas_flows_through_the_area_as_through_a_nozzle():
    # rough on few scales: its table is made in no time
    spectrum = {"kind": "self-affine", "rms_height": "1 um", "hurst": 0.8, "q_low": "1e4 1/m"}
    spectrum |= {"q_rolloff": "2e4 1/m", "q_high": "1e5 1/m"}
    found = fem_seal.leak_map(
        case(fluid={"name": "helium"}, roughness={"spectrum": spectrum}, leak={"plasticity": False}),
        [5e5],
        [500.0],
    )
    helium, outlet = leak.gas("helium"), 101325.0
    expected = leakage_area_of_gas(float(found.mass_flow[0, 0]), outlet + 5e5, outlet, helium, 5 / 3)
    assert found.leakage_area[0, 0] == pytest.approx(expected, rel=1e-12)
    assert found.mass_flow[0, 0] == pytest.approx(helium.density(outlet) * found.leak_rate[0, 0], rel=1e-12)


def test_what_has_no_result_stays_empty_and_the_rest_is_complete(inside):
    # pi r0^2 p: 63, 314 and 628 N lift, so that 100 N hold only 1 bar and 400 N only 5 bar
    gaps = np.isnan(inside.leak_rate)
    assert gaps.tolist() == [[False] * 3, [True, False, False], [True, True, False]]
    assert inside.level[2][0] == "not calculated"
    assert any("the seal opens" in reason for reason in inside.reasons)
    whole = inside.complete
    assert not np.isnan(whole.leak_rate).any()
    assert whole.leak_rate.size == 4
    m = inside.fluid_pressure.tolist().index(whole.fluid_pressure[0])
    n = inside.applied_force.tolist().index(whole.applied_force[0])
    assert whole.leak_rate[0, 0] == inside.leak_rate[m, n] and whole.level[0][0] == inside.level[m][n]


@pytest.mark.parametrize(
    ("tables", "pressures", "forces", "said"),
    [
        ({"fluid": None}, None, None, "needs [roughness] and [fluid]"),
        ({}, [0.0, 1e5], None, "above zero"),
        ({}, [2e5, 1e5], None, "increase"),
        ({}, None, [], "at least one"),
        ({}, np.linspace(1e5, 2e5, 100), np.linspace(0, 1e3, 21), "up to 2000"),
        (
            {"seat": cone({"name": "316L", "stress_strain": {"plastic_strain": [0], "stress": ["240 MPa"]}})},
            None,
            None,
            "load.largest_earlier_force: is missing: the leak of a body that yields",
        ),
        (
            {
                "seat": cone(
                    {"name": "316L", "stress_strain": {"plastic_strain": [0], "stress": ["240 MPa"]}}
                ),
                "load": {"fluid_pressure": ["5 bar", "20 bar"], "largest_earlier_pressure": "10 bar"},
            },
            None,
            None,
            "load.largest_earlier_pressure: closes with",
        ),
    ],
)
def test_what_makes_no_table_is_refused_at_once(tables, pressures, forces, said):
    with pytest.raises(InputError) as caught:
        fem_seal.leak_map(case(**tables), pressures, forces)
    assert said in str(caught.value)


@pytest.mark.slow
def test_a_seat_that_was_coined_has_a_table_whatever_the_order():
    coined = fem_seal.load_case(EXAMPLES / "elastoplastic_seat.toml").replace(
        {
            "load": {"fluid_pressure": ["50 bar", "300 bar"], "largest_earlier_pressure": "300 bar"},
            "mesh.contact_size": "40 um",
        }
    )
    found = fem_seal.leak_map(coined, [60e5, 180e5, 300e5])
    assert found.level == [["valid"]] * 3 and found.reasons == ()
    # each as the only load after the earlier one; the elements are sized for it, half as long as the contact is wide
    for pressure, leak_rate in zip((60, 180), found.leak_rate[:, 0], strict=False):
        alone = run_loads(coined.replace({"load.fluid_pressure": f"{pressure} bar"})).loads[0]
        assert leak_rate == pytest.approx(alone.leak.leak_rate, rel=0.02)


def test_a_body_that_yields_again_makes_a_table_doubtful(water):
    def leaking(rate):
        return SimpleNamespace(point=(20e5, 0.0), leak=SimpleNamespace(leak_rate=rate))

    first, again = leaking(1e-9), leaking(1.2e-9)
    loads = (first, SimpleNamespace(point=(5e5, 0.0), leak=None), again)
    told = _with_return(water, SimpleNamespace(loads=loads))
    assert all(level in ("doubtful", "outside the theory") for row in told.level for level in row)
    assert "changes by +20 %" in told.reasons[-1]
    assert _with_return(water, SimpleNamespace(loads=(first, again, first))) is water


# --- files ------------------------------------------------------------------------------------------------


def modelica_tables(text):
    """Tables of a text file as the Modelica Standard Library documents its format, strictly."""
    lines = text.splitlines()
    # the first two characters, and nothing else on that line
    assert lines[0] == "#1"
    tables, rest = {}, iter(lines[1:])
    for line in rest:
        if line.startswith("#") or not line.strip():
            continue
        name, rows, columns = re.fullmatch(r"double (\w+)\((\d+),(\d+)\)(?: #.*)?", line).groups()
        values = [[float(one) for one in next(rest).split()] for _ in range(int(rows))]
        assert all(len(row) == int(columns) for row in values)
        tables[name] = np.array(values)
    return tables


def test_modelica_reads_back_what_was_calculated(water):
    tables = modelica_tables(modelica_text(water))
    ends = ("", "_low", "_high")
    assert list(tables) == [f"{name}{end}" for name in ("leak_rate", "leakage_area") for end in ends]
    table = tables["leak_rate"]
    u1, u2 = table[1:, 0], table[0, 1:]
    assert u1.tolist() == [0.0, *PRESSURES] and u2.tolist() == FORCES
    # bilinear, as CombiTable2Ds with LinearSegments
    y = RegularGridInterpolator((u1, u2), table[1:, 1:])
    for m, pressure in enumerate(PRESSURES):
        for n, force in enumerate(FORCES):
            assert y((pressure, force)) == pytest.approx(water.leak_rate[m, n], rel=1e-9)
    assert y((0.0, 700.0)) == 0
    assert tables["leakage_area_high"][1:, 1:][1:] == pytest.approx(
        water.leak_rate_high * water.area_of_leak_rate[:, None], rel=1e-9
    )


def test_matlab_reads_back_what_was_calculated(gas):
    whole = gas.complete
    text = matlab_text(whole)
    # a statement ends with a semicolon, "..." continues a line, "%" begins a comment
    code = re.sub(r"%[^\n]*", "", text.replace("...\n", " "))
    found = {
        name: np.array([[float(one) for one in row.split()] for row in body.split(";")])
        for name, body in re.findall(r"leak_tables\.(\w+) = \[([^\]]*)\];", code)
    }
    assert not re.sub(r"leak_tables\.(\w+) = \[([^\]]*)\];", "", code).strip()
    assert found["fluid_pressure"].ravel()[1:].tolist() == whole.fluid_pressure.tolist()
    assert found["applied_force"].ravel().tolist() == whole.applied_force.tolist()
    assert found["mass_flow"][1:] == pytest.approx(whole.mass_flow, rel=1e-9)
    assert found["valid"].shape == found["mass_flow"].shape == (3, 2)
    assert not found["mass_flow"][0].any()
    assert "leak_rate" not in found and "kg/s" in text


def test_without_a_density_there_are_no_areas(water):
    bare = replace(water, density=None, area_of_leak_rate=np.full(2, math.nan))
    assert list(tables_of(bare)) == ["leak_rate", "leak_rate_low", "leak_rate_high"]
    assert np.isnan(bare.mass_flow).all()


def test_a_title_ends_no_comment(water):
    tables = modelica_tables(modelica_text(replace(water, title="first\ndouble x(1,1)\n0")))
    assert "x" not in tables


CASE = """
title = "table"
[closure]
shape = "ball"
radius = "20 mm"
material = "steel"
[seat]
shape = "cone"
angle = "45 deg"
material = "steel 1.4122"
[roughness.spectrum]
kind = "self-affine"
rms_height = "1.9 um"
hurst = 0.6
q_low = "1e3 1/m"
q_rolloff = "3e4 1/m"
q_high = "3e5 1/m"
[fluid]
name = "water"
[load]
fluid_pressure = ["1 bar", "20 bar"]
pressure_side = "inner"
applied_force = "400 N"
"""


def test_command_writes_the_files_and_says_what_is_missing(capsys, tmp_path):
    (tmp_path / "case.toml").write_text(CASE, encoding="utf-8")
    arguments = [
        "table",
        str(tmp_path / "case.toml"),
        "--pressure",
        "1 bar, 20 bar",
        "--force",
        "100 N : 300 N : 2",
    ]
    assert cli.main(arguments) == 0
    out, err = capsys.readouterr()
    assert "300 N" in out and "2 of 4 points have no result" in err
    folder = tmp_path / "case.table"
    rows = list(csv.DictReader((folder / "table.csv").open(encoding="utf-8")))
    assert len(rows) == 4
    assert [row["validity"] == "not calculated" for row in rows] == [False, True, False, True]
    assert float(rows[0]["leak_rate_m3_per_s"]) > 0 and rows[1]["leak_rate_m3_per_s"] == ""
    table = modelica_tables((folder / "modelica_tables.txt").read_text(encoding="utf-8"))["leak_rate"]
    assert table.shape == (3, 3) and table[2, 1] == pytest.approx(float(rows[0]["leak_rate_m3_per_s"]))
    assert (folder / "leak_tables.m").exists()


@pytest.mark.parametrize(
    "text", ["1 bar : 2 bar", "1 bar : 2 bar : one", "1 : 2 : 3", "1 bar;2 bar", "50", "1,5 bar : 2 bar : 3"]
)
def test_a_grid_that_is_none_is_refused(text):
    with pytest.raises(InputError, match=f"^--pressure = '{text}': "):
        grid(text, "pressure")


def test_the_terminal_shows_of_a_leak_rate_what_its_theory_leaves(capsys):
    from fem_seal.cli import table as cli_table
    from fem_seal.seal.findings import VALID, Level, Validity

    few = Validity.of([remark("few channels", Level.DOUBTFUL, "few channels", Bounds.factor_bounds(3.3))])
    found = SimpleNamespace(
        applied_force=np.array([100.0, 200.0]),
        fluid_pressure=np.array([5e5]),
        validity=((VALID, few),),
        leak_rate=np.array([[1.2345e-6, 1.2345e-7]]) / 60,
        fluid="water",
        is_gas=False,
        title="seal",
    )
    cli_table._show(Display(), found)
    assert {"1.23", "0.1?"} <= set(capsys.readouterr().out.split())
