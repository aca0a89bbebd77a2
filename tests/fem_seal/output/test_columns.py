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
from fem_seal.output.columns import CHECK_ON_TERMINAL, COLUMNS, LEAK_ON_TERMINAL, PROFILE_LEAK_COLUMNS
from fem_seal.output.report.page import load_table
from fem_seal.output.report.words import headline
from fem_seal.output.tables import leak_rows, write_profile_csv
from fem_seal.seal.load_result import highest_load
from fem_seal.studies.study import Study
from fem_seal.units import kind_of, parse_quantity, split_unit, unit_for

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
    assert SI[column.kind] == column.unit == split_unit(column.name)[1]
    assert column.meaning
    if column.unit_like:
        assert COLUMNS[column.unit_like].kind == column.kind


def test_the_terminal_shows_all_that_have_a_heading_there():
    shown = {one.name for one in (*LEAK_ON_TERMINAL, *CHECK_ON_TERMINAL)}
    assert shown & COLUMNS.keys() == {name for name, column in COLUMNS.items() if column.short}


@pytest.mark.parametrize("shown", [*LEAK_ON_TERMINAL, *CHECK_ON_TERMINAL], ids=lambda shown: shown.name)
def test_the_terminal_shows_each_column_in_a_unit_of_its_kind(shown):
    assert shown.heading
    kind, unit = split_unit(shown.name)[1], shown.unit
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
    celsius = unit_for("temperature", 0.0)
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
    assert "20 bar with 500 N" in headline(result)
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
        assert tuple(row) == (*PROFILE_LEAK_COLUMNS, "verdict", "validity", "validity_reasons")
        # another range of the table of conductivities
        for name in PROFILE_LEAK_COLUMNS:
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
    with pytest.raises(InputError, match=rf"{name} needs a table \[{missing}\]"):
        Study(smooth, parameters={"load.fluid_pressure": ["5 bar", "6 bar"]}, responses=(name,))


def test_a_derived_column_needs_what_it_is_made_of_whatever_its_name():
    dry = case(fluid=None, load={"fluid_pressure": "5 bar"})
    study = Study(
        dry,
        parameters={"load.fluid_pressure": ["5 bar", "6 bar"]},
        responses=("peak_pressure_Pa",),
        derived={"leak_rate_guess": "1 / peak_pressure_Pa", "twice": "2 * leak_rate_guess"},
    )
    assert study.responses == ("peak_pressure_Pa",)
