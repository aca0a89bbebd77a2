"""leak.csv, profile.csv and summary.json say what the result holds."""

from __future__ import annotations

import json
import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure
from sample_results import case, rough_result, single_result, smooth_result

import fem_seal
from fem_seal.answers.judgement import VerdictReason
from fem_seal.answers.testplan import QUESTIONS
from fem_seal.errors import OutputError
from fem_seal.files import write_bytes, write_text
from fem_seal.output.answer_output import prose
from fem_seal.output.columns import COLUMNS
from fem_seal.output.files import summary, write_summary
from fem_seal.output.pictures.style import captioned
from fem_seal.output.sources import features_used
from fem_seal.output.tables import (
    PROFILE_COLUMNS,
    leak_table,
    profile_array,
    write_leak_csv,
    write_profile_csv,
)
from fem_seal.units import Display, number, percent, trim_zeros

# of a case by the paper's theory with a hardness and a liquid
LEAK_HEADER = (
    "fluid_pressure_Pa,applied_force_N,contact_force_N,leak_rate_m3_per_s,leak_rate_low_m3_per_s,"
    "leak_rate_high_m3_per_s,line_load_N_per_m,peak_pressure_Pa,fwhm_m,std_m,contact_radius_m,"
    "critical_separation_m,max_von_mises_Pa,leak_rate_elastic_m3_per_s,leak_rate_conserved_m3_per_s,"
    "leak_rate_capped_m3_per_s,leak_rate_corrected_m3_per_s,leak_rate_kg_per_s,leak_rate_per_length_m2_per_s,"
    "leak_rate_per_length_kg_per_m_s,effective_viscosity_Pa_s,critical_separation_elastic_m,validity,"
    "validity_reasons"
)
PROFILE_HEADER = (
    "fluid_pressure_Pa,x_m,r_m,contact_pressure_Pa,gap_m,fluid_pressure_in_gap_Pa,"
    "contact_force_per_length_N_per_m,bulk_strain_meridional,bulk_strain_hoop,elastic_area_strain,"
    "contact_conductance_W_per_m2_K"
)


def test_leak_csv_has_the_agreed_columns_and_the_numbers_of_the_table(tmp_path):
    result = rough_result()
    path = write_leak_csv(result, tmp_path / "leak.csv")
    assert path.read_text().splitlines()[0] == LEAK_HEADER
    table = leak_table(result)
    assert ",".join(table.columns) == LEAK_HEADER
    written = pd.read_csv(path)
    # pandas reads an empty cell as NaN
    written["validity_reasons"] = written["validity_reasons"].astype(object).fillna("")
    # ten digits are written
    pd.testing.assert_frame_equal(written, table, rtol=1e-9, atol=0, check_dtype=False)


def test_leak_table_is_consistent_with_statics_and_geometry():
    result = rough_result()
    table = leak_table(result)
    r0, theta = 0.02 * math.sin(math.radians(45)), math.radians(45)
    np.testing.assert_allclose(
        table["contact_force_N"], math.pi * r0**2 * table["fluid_pressure_Pa"], rtol=1e-12
    )
    np.testing.assert_allclose(
        table["line_load_N_per_m"],
        table["contact_force_N"] / (2 * math.pi * r0 * math.cos(theta)),
        rtol=1e-12,
    )
    # the centre of pressure stays within a fraction of the width around first touch
    assert (abs(table["contact_radius_m"] - r0) < 0.1 * table["std_m"]).all()
    assert (table["leak_rate_m3_per_s"] < table["leak_rate_elastic_m3_per_s"]).all()
    assert (table["critical_separation_m"] < table["critical_separation_elastic_m"]).all()


def test_without_plasticity_both_leak_columns_agree():
    table = leak_table(single_result(), all_columns=True)
    assert table["leak_rate_m3_per_s"].item() == table["leak_rate_elastic_m3_per_s"].item() > 0


@pytest.mark.slow
def test_a_smooth_seal_has_the_columns_of_its_contact_and_empty_cells(tmp_path):
    path = write_leak_csv(smooth_result(), tmp_path / "leak.csv")
    table = pd.read_csv(path)
    assert ",".join(table) == (
        "fluid_pressure_Pa,applied_force_N,contact_force_N,line_load_N_per_m,peak_pressure_Pa,fwhm_m,std_m,"
        "contact_radius_m,max_von_mises_Pa,validity,validity_reasons"
    )
    assert table.drop(columns="validity_reasons").notna().all().all()
    path = write_leak_csv(smooth_result(), tmp_path / "leak.csv", all_columns=True)
    assert "nan" not in path.read_text()
    table = pd.read_csv(path)
    assert [*table] == [*COLUMNS] and table["leak_rate_m3_per_s"].isna().all()


def test_profile_csv_gives_the_line_load_back(tmp_path):
    result = rough_result()
    path = write_profile_csv(result, tmp_path / "profile.csv")
    assert path.read_text().splitlines()[0] == PROFILE_HEADER
    profiles = pd.read_csv(path)
    expected = pd.DataFrame(profile_array(result), columns=list(PROFILE_COLUMNS))
    pd.testing.assert_frame_equal(profiles, expected, rtol=1e-9, atol=0, check_dtype=False)
    for (pressure, rows), load in zip(profiles.groupby("fluid_pressure_Pa"), result.loads, strict=True):
        assert pressure == load.fluid_pressure
        # trapezoids through Gauss points: good to a few 1e-3
        force = np.trapezoid(rows["contact_pressure_Pa"] * 2 * np.pi * rows["r_m"], rows["x_m"])
        assert force * math.cos(math.radians(45)) == pytest.approx(load.contact_force, rel=5e-3)
        fluid = rows["fluid_pressure_in_gap_Pa"].to_numpy()
        assert (np.diff(fluid) >= 0).all() and 0 <= fluid[0] < 0.05 * pressure < 0.95 * pressure < fluid[
            -1
        ] <= pressure


def test_summary_is_valid_json_and_complete(tmp_path):
    result = replace(rough_result(), warnings=("one µ warning",))
    told = json.loads(write_summary(result, tmp_path / "summary.json").read_text(encoding="utf-8"))
    assert list(told) == [
        "format_version",
        "program",
        "created",
        "title",
        "case_file",
        "input",
        "derived",
        "mesh",
        "loads",
        "leakage",
        "yielding",
        "imprint",
        "convergence",
        "discretisation_error",
        "far_field",
        "compression",
        "form",
        "particles",
        "theories",
        "interface_variants",
        "uncertainty",
        "error_shares",
        "requirement",
        "verdict_force",
        "standard_tests",
        "standard_verdict",
        "set_pressure",
        "levers",
        "warnings",
        "wall_times_s",
        "sources",
    ]
    assert told["program"] == {"name": "fem-seal", "version": fem_seal.__version__}
    assert told["warnings"] == ["one µ warning"]
    assert [",".join(row) for row in told["loads"]] == [LEAK_HEADER] * 3
    assert told["loads"][-1]["leak_rate_m3_per_s"] == result.loads[-1].leak.leak_rate
    for convergence in told["convergence"]:
        assert convergence["iterations"] >= 1
        assert convergence["residual"] < 1e-9
        assert abs(convergence["force_error"]) < 1e-8
    assert told["discretisation_error"]["peak_pressure"] == result.discretisation_error.peak_pressure
    assert told["mesh"]["triangles"] == result.seal_mesh.quality.elements
    assert set(told["wall_times_s"]) == set(result.timings)


def test_summary_holds_the_whole_input_in_si_with_defaults():
    told = summary(rough_result())["input"]
    assert told["closure"]["radius"] == 0.02
    assert told["seat"]["angle"] == pytest.approx(math.pi / 4)
    assert told["seat"]["material"]["hardness"] == 3.5e9
    assert told["roughness"]["spectrum"]["q_high"] == 3.14159e6
    assert told["load"]["fluid_pressure"] == [2e5, 5e5, 20e5]
    assert told["load"]["applied_force"] == 0.0
    assert told["leak"]["percolation_threshold"] == 0.42
    assert told["interface"] == {"law": "spectrum", "plastic": False, "gamma": None, "u0": None, "p_c": None}
    assert told["fluid"]["viscosity"] == case().fluid.viscosity


def test_summary_of_a_smooth_contact_has_null_for_what_does_not_exist(tmp_path):
    told = json.loads(write_summary(smooth_result(), tmp_path / "summary.json").read_text())
    assert "leak_rate_m3_per_s" not in told["loads"][0]
    assert told["input"]["roughness"] is None
    assert told["derived"]["decay_length_m"] is None
    assert told["interface_variants"] is None


def test_sources_are_those_of_the_formulas_used():
    used = {source["name"] for source in summary(rough_result())["sources"]}
    assert {"Persson 2001", "Yang & Persson 2008", "Persson 2016", "Dapp et al. 2012"} <= used
    assert {source["name"] for source in summary(smooth_result())["sources"]} == {
        "Fischer et al. 2020",
        "Johnson 1985",
    }


@pytest.mark.parametrize(
    ("kind", "value", "text"),
    [
        ("length", 0.000307, "0.307 mm"),
        ("length", 1.9e-6, "1.90 µm"),
        ("contact pressure", 61.6678e6, "61.7 MPa"),
        ("contact pressure", 1e6, "1.00 MPa"),
        ("fluid pressure", 2e6, "20.0 bar"),
        ("fluid pressure", 0.0, "0 bar"),
        ("flow", 3.84e-7, "23.0 ml/min"),
        ("flow", 1e-13, "6.00 nl/min"),
        ("force", 1256.6, "1257 N"),
        ("length", math.nan, "–"),
    ],
)
def test_units_suit_the_value(kind, value, text):
    assert Display().quantity(value, kind) == text


def test_numbers_for_readers():
    assert Display().quantity(2e6, "given fluid pressure") == "20 bar"
    assert trim_zeros(0.30) == "0.3" and trim_zeros(100.0) == "100" and trim_zeros(1.0016) == "1.0016"
    assert trim_zeros(1e-9) == "1·10⁻⁹"
    assert number(1.234e-9) == "1.23·10⁻⁹"
    assert number(-0.5) == "−0.500"
    assert percent(0.0388) == "3.9 %"
    assert Display().leak_rate(0.0) == "none, sealed"
    # a target as it was written, rather than a billionth of a picolitre
    assert Display().quantity(1e-29, "given flow") == "1·10⁻²⁹ m³/s"


def test_files_are_replaced_whole(tmp_path: Path):
    path = write_text(tmp_path / "new" / "a.txt", "ä\n")
    assert path.read_bytes() == "ä\n".encode()
    write_bytes(path, [b"b", b"c"])
    assert path.read_bytes() == b"bc"

    def broken():
        yield b"half"
        raise ValueError("no more")

    with pytest.raises(ValueError, match="no more"):
        write_bytes(path, broken())
    assert path.read_bytes() == b"bc"
    assert [p.name for p in path.parent.iterdir()] == ["a.txt"]


def test_a_file_that_cannot_be_written_is_named(tmp_path: Path):
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(OutputError, match=r"file/leak\.csv: cannot be written"):
        write_text(tmp_path / "file" / "leak.csv", "")


def test_every_sentence_of_the_report_is_asked_for_and_every_one_asked_for_is_there():
    package = Path(fem_seal.__file__).parent
    rooms = ("output", "cli", "studies")
    code = "\n".join(path.read_text("utf-8") for room in rooms for path in (package / room).rglob("*.py"))
    called = set(re.findall(r'say(?:_all)?\(\s*[\w.]+(?:\(\))?,\s*"(\w+)",\s*f?"([^"]+)"', code))
    captions = set(re.findall(r'captioned\(\s*[\w.]+,\s*figure,\s*"([^"]+)"', code))
    called |= {("captions", f"{name}_{{part}}") for name in captions}
    # chosen by the interface law of the case and by the order of its loads
    elsewhere = {"smooth", "exponential", "spectrum", "joined", "numbered"}
    elsewhere |= {
        f"{what}_{also}" for what in ("inputs", "finish", "mixed", "tested") for also in ("own", "both")
    }
    elsewhere |= {*VerdictReason, *QUESTIONS}
    elsewhere = {re.sub(r"\W", "_", part) for part in elsewhere}
    used = set()
    for file in {*(package / "templates/answers").glob("*.j2")} - {package / "templates/answers/citation.j2"}:
        words = file.read_text("utf-8")
        for macro in re.findall(r"{% macro (\w+)\(", words):
            # by name, by a name that is put together, or by a macro beside it
            found = {
                (name, macro[len(name.partition("{")[0]) :])
                for kind, name in called
                if kind == file.stem
                and (name == macro or ("{" in name and macro.startswith(name.partition("{")[0])))
            }
            by_macro = len(re.findall(rf"\b{macro}\(", words)) > 1
            assert found or by_macro or f'"{macro}"' in code, f"{file.name}: {macro}"
            assert not found or any(
                not part or part in elsewhere or re.search(rf"['\"]{part.replace('_', '.')}['\"]", code)
                for _, part in found
            ), f"{file.name}: {macro}"
            used |= {(file.stem, name) for name, _ in found}
    assert called == used
    for kind, function in (
        ("tables", "worded_table"),
        ("rows", "worded_rows"),
        ("sections", "worded_section"),
    ):
        assert set(re.findall(rf'{function}\(\s*[\w.]+,\s*"([^"]+)"', code)) == set(prose()[kind])


def test_sentences_stand_one_after_the_other_with_their_values():
    picture = captioned(Display(), Figure(), "scan", "several", "", "spectrum", count=3, form="tilt")
    assert picture.caption.startswith("Left: the first of 3 scans without its tilt. Right: ")


def test_words_of_the_report_ask_for_nothing_that_no_result_can_have_used():
    words = prose()
    asked = {"always"}
    for entry in words["sources"]:
        asked |= {*entry.get("when", ()), *entry.get("used_for", ()), *entry.get("equations", ())}
    assert asked == {"always", *features_used(rough_result())}
