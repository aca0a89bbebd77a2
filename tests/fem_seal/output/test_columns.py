"""One table of columns serves files, terminal, report and studies; one place says which load is the highest."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest
from sample_results import case, rough_result

from fem_seal.answers.chain import solve_profiles
from fem_seal.answers.profile_files import read_profiles
from fem_seal.cli.terminal import show_leakage
from fem_seal.errors import InputError
from fem_seal.output.answers.target import valve_table
from fem_seal.output.columns import CHECK_ON_TERMINAL, COLUMNS, LEAK_ON_TERMINAL, columns_of
from fem_seal.output.report.brief import first_line
from fem_seal.output.report.page import load_table
from fem_seal.output.tables import leak_rows, write_profile_csv
from fem_seal.seal.load_result import highest_load
from fem_seal.studies.study import Study
from fem_seal.units import Display, kind_of, parse_quantity, split_unit

SI = {
    "length": "m",
    "fluid pressure": "Pa",
    "contact pressure": "Pa",
    "force": "N",
    "line load": "N/m",
    "flow": "m^3/s",
    "throughput": "Pa m^3/s",
    "mass flow": "kg/s",
    "viscosity": "Pa s",
    "temperature": "K",
    "torque": "N m",
    "flow per length": "m^2/s",
    "mass flow per length": "kg/(m s)",
    "throughput per length": "Pa m^2/s",
    "": "",
}


@pytest.mark.parametrize("column", COLUMNS.values(), ids=COLUMNS)
def test_what_a_column_is_fits_the_unit_in_its_name(column):
    assert column.text or SI[column.kind] == column.unit == split_unit(column.name)[1]
    assert column.meaning
    if column.unit_like:
        assert COLUMNS[column.unit_like].kind == column.kind


def test_the_terminal_shows_all_that_have_a_heading_there():
    shown = {one.name for one in (*LEAK_ON_TERMINAL, *CHECK_ON_TERMINAL)}
    assert shown & COLUMNS.keys() == {name for name, column in COLUMNS.items() if column.short}


@pytest.mark.parametrize("shown", [*LEAK_ON_TERMINAL, *CHECK_ON_TERMINAL], ids=lambda shown: shown.name)
def test_the_terminal_shows_each_column_in_a_unit_of_its_kind(shown):
    assert shown.heading
    kind, unit = split_unit(shown.name)[1], shown.unit_in(Display())
    # one of the unit, read as a case file would write it, and its size
    known = {"m": "length", "Pa": "pressure", "N": "force", "m^3/s": "leak rate"}
    if kind in known:
        written = unit.name.replace("³", "^3")
        assert parse_quantity(f"1 {written}", known[kind]) == pytest.approx(unit.size, rel=1e-12)
    else:
        others = (
            ("N/m", "N/mm", 1e3),
            ("N m", "N m", 1.0),
            ("N/m", "kN/m", 1e3),
            ("Pa m^3/s", "mbar l/s", 0.1),
            ("", "", 1.0),
        )
        assert (kind, unit.name, unit.size) in others


@pytest.mark.parametrize(
    ("path", "unit", "kind"),
    [
        ("load.fluid_pressure", "Pa", "fluid pressure"),
        ("fluid.outlet_pressure", "Pa", "fluid pressure"),
        ("seat.material.hardness", "Pa", "contact pressure"),
        ("fluid.temperature", "K", "temperature"),
        ("leak.percolation_threshold", "", ""),
    ],
)
def test_what_a_parameter_is(path, unit, kind):
    assert kind_of(path, unit) == kind


def test_a_temperature_has_a_zero_of_its_own():
    celsius = Display().unit_for("temperature", 0.0)
    assert celsius.name == "°C" and celsius.of(293.15) == pytest.approx(20.0)


@pytest.mark.slow
def test_the_highest_load_is_the_same_everywhere(capsys):
    """Shuffled, so that it is neither the first nor the last; of two at one pressure the spring decides."""
    result = rough_result()
    low, high = result.loads[0], result.loads[-1]
    pushed = replace(high, applied_force=500.0)
    # the closing force of the first is the largest of all
    loads = (replace(low, contact=replace(low.contact, contact_force=1e6)), pushed, high)
    result = replace(result, loads=loads)
    assert highest_load(loads) == 1 and result.highest is pushed
    assert result.strongest is loads[0]
    assert "20 bar with 500 N" in first_line(result)
    show_leakage(result.case, loads)
    assert "Leak rate at 20 bar with 500 N" in capsys.readouterr().out


def test_a_column_stands_alone_where_the_one_it_is_compared_with_is_missing():
    """A step that failed leaves the yielding asperities without u_c, and the elastic ones have theirs."""
    result = rough_result()
    loads = tuple(load.with_values(critical_separation=None) for load in result.loads)
    table = load_table(replace(result, loads=loads))
    (heading,) = [text for text in table.headings if text.startswith("u_c")]
    assert re.fullmatch(r"u_c, elastic \[(µm|nm)\]", heading)


def test_the_report_shows_the_numbers_of_leak_csv_in_its_units():
    result = rough_result()
    table, rows = load_table(result), leak_rows(result)
    at = {text.split(" [")[0]: n for n, text in enumerate(table.headings)}
    for name, unit in (("peak_pressure_Pa", 1e6), ("fwhm_m", 1e-3)):
        column = COLUMNS[name]
        shown = [float(line[at[column.heading]]) for line in table.rows]
        assert shown == pytest.approx([row[name] / unit for row in rows], rel=1e-3)
    assert valve_table(result).rows == ()


def test_a_given_profile_has_the_columns_of_leak_csv(tmp_path):
    result = rough_result()
    file, contact = write_profile_csv(result, tmp_path / "profile.csv"), result.problem.contact
    found = solve_profiles(result.case, read_profiles(file, contact))
    for row, full, load in zip(leak_rows(found), leak_rows(result), result.loads, strict=True):
        assert {
            "contact_force_N",
            "max_von_mises_Pa",
        } <= full.keys() - row.keys() and row.keys() < full.keys()
        # another range of the table of conductivities
        for name in row.keys() - {"validity", "validity_reasons"}:
            if name == "leak_rate_corrected_m3_per_s":
                # through the very contact of the profile, which is one by the paper's theory
                corrected = replace(load, rough=load.scenario("corrected").rough)
                assert row[name] == pytest.approx(corrected.leak.leak_rate, rel=2e-3)
                continue
            assert row[name] == pytest.approx(full[name], rel=2e-3, nan_ok=True), name


@pytest.mark.parametrize(
    ("name", "missing"),
    [
        ("leak_rate_low_m3_per_s", "roughness"),
        ("leak_rate_kg_per_s", "roughness"),
        ("critical_separation_elastic_m", "roughness"),
    ],
)
def test_a_study_refuses_columns_that_its_case_leaves_empty(name, missing):
    smooth = case(roughness=None, interface={"law": "smooth"}, load={"fluid_pressure": "5 bar"})
    with pytest.raises(InputError, match=rf"{name} needs \[{missing}\]"):
        Study(smooth, parameters={"load.fluid_pressure": ["5 bar", "6 bar"]}, responses=(name,))


GAS = {
    "leak_rate_Pa_m3_per_s",
    "leak_rate_standard_m3_per_s",
    "leak_rate_per_length_Pa_m2_per_s",
    "knudsen_number",
}
TARGET = {"force_for_target_leak_N", "contact_force_for_target_N", "line_load_for_target_N_per_m"}
JUDGED = {"verdict", "margin", "pass_probability", "pass_probability_error"}
READINGS = {"leak_rate_conserved_m3_per_s", "leak_rate_capped_m3_per_s", "leak_rate_corrected_m3_per_s"}
OPENS = {"blow_off_pressure_Pa", "opening_margin_N", "opening_margin_Pa", "opening_margin"}


@pytest.mark.parametrize(
    ("changes", "brought", "gone"),
    [
        ({"load.fluid_pressure": ["1 bar", "350 bar"]}, set(), set()),
        ({"load.applied_force": "500 N"}, set(), set()),
        ({"fluid": {"name": "helium"}}, GAS, {"effective_viscosity_Pa_s"}),
        ({"load.target_leak_rate": "1 ml/min"}, TARGET | {"force_for_verdict_N"}, set()),
        ({"requirement": {"leak_rate": "1 ml/min"}}, JUDGED, set()),
        ({"leak.theory": "paper"}, READINGS, set()),
        ({"load.pressure_side": "inner", "load.applied_force": "5 kN"}, OPENS, set()),
        ({"load.closing": "penetration"}, OPENS | {"effective_seal_radius_m"}, set()),
        (
            {"leak.plasticity": False},
            set(),
            {"leak_rate_elastic_m3_per_s", "critical_separation_elastic_m"},
        ),
        (
            {"form": {"seat": {"harmonics": [{"waves": 2, "amplitude": "1 um"}]}}},
            {"peak_pressure_max_Pa", "line_load_min_over_mean", "leak_rate_round_m3_per_s"},
            set(),
        ),
    ],
)
def test_the_tables_of_a_case_bring_its_columns(changes, brought, gone):
    base = case(leak={"theory": "corrected"})
    before, after = ({one.name for one in columns_of(each)} for each in (base, base.replace(changes)))
    assert (after - before, before - after) == (brought, gone)


def test_all_columns_are_those_of_the_file_in_one_order():
    result = rough_result()
    names = [*COLUMNS]
    assert names[:5] == [
        "fluid_pressure_Pa",
        "applied_force_N",
        "contact_force_N",
        "leak_rate_m3_per_s",
        "leak_rate_low_m3_per_s",
    ]
    assert [*result.all_columns] == names
    assert [*result.table] == [name for name in names if name in result.table]
    assert result.all_columns[[*result.table]].equals(result.table)


def test_a_column_that_is_not_there_says_what_brings_it():
    result = rough_result()
    with pytest.raises(KeyError, match=r"bolt_force_N .* comes with \[bolts\]; result\.all_columns"):
        result["bolt_force"]
    with pytest.raises(KeyError, match=r"leak_rate_paper_m3_per_s .* comes with --all-columns"):
        result["leak_rate_paper"]
    with pytest.raises(KeyError, match="do you mean leak_rate"):
        result["leak_ratte"]


def test_a_study_may_vary_what_brings_a_column():
    base = case(leak={"theory": "corrected"}, load={"fluid_pressure": "5 bar"})
    asked = {"responses": ("force_for_target_leak_N", "leak_rate_capped_m3_per_s")}
    targets, theories = ["1 ml/min", "2 ml/min"], ["corrected", "paper"]
    with pytest.raises(InputError, match=r"needs load\.target_leak_rate in the base case"):
        Study(base, parameters={"load.fluid_pressure": ["5 bar", "6 bar"]}, **asked)
    varied = {"load.target_leak_rate": targets, "leak.theory": theories}
    assert set(Study(base, parameters=varied, **asked).responses) == set(asked["responses"])


def test_a_derived_column_needs_what_it_is_made_of_whatever_its_name():
    dry = case(fluid=None, load={"fluid_pressure": "5 bar"})
    study = Study(
        dry,
        parameters={"load.fluid_pressure": ["5 bar", "6 bar"]},
        responses=("peak_pressure_Pa",),
        derived={"leak_rate_guess": "1 / peak_pressure_Pa", "twice": "2 * leak_rate_guess"},
    )
    assert study.responses == ("peak_pressure_Pa",)
