"""Strips of a whole seal beside the chain: through the command, resumed, and their limits."""

import json

import numpy as np
import pandas as pd
import pytest
from typer.testing import CliRunner

import fem_seal
from fem_seal.cli.app import app, main

CASE = """
title = "ball on cone"
closure = { shape = "ball", radius = "20 mm", material = "steel" }
interface.law = "spectrum"
leak.theory = "corrected"
fluid.name = "water"
load = { fluid_pressure = ["5 bar", "20 bar"] }
direct = { points = 96, samples = 6 }

[seat]
shape = "cone"
angle = "45 deg"
material = { name = "steel", youngs_modulus = "210 GPa", poissons_ratio = 0.3, hardness = "3.5 GPa" }

[roughness.spectrum]
kind = "self-affine"
rms_height = "0.3 um"
hurst = 0.8
q_low = "1e4 1/m"
q_rolloff = "1e5 1/m"
q_high = "1e6 1/m"
"""


@pytest.fixture
def case_file(tmp_path):
    path = tmp_path / "ball.toml"
    path.write_text(CASE)
    return path


@pytest.mark.slow
def test_command_writes_table_and_picture_and_goes_on(case_file):
    run = CliRunner().invoke(app, ["direct", "--seal", str(case_file), "--jobs", "1", "--json"])
    assert run.exit_code == 0, run.output
    folder = case_file.with_suffix(".direct")
    table = pd.read_csv(folder / "direct_seal.csv")
    assert list(table["asperities"]) == ["elastic", "capped"] * 2
    assert (folder / "direct_seal.svg").stat().st_size > 1000
    told = json.loads(run.stdout)["strips"]
    assert [row["leak_rate_m3_per_s"] for row in told] == pytest.approx(list(table["leak_rate_m3_per_s"]))
    pieces = {path: path.stat().st_mtime_ns for path in (folder / "pieces").iterdir()}
    assert len(pieces) == 2 * 2 * 6
    again = CliRunner().invoke(app, ["direct", "--seal", str(case_file), "--jobs", "1", "--quiet"])
    assert again.exit_code == 0, again.output
    assert {path: path.stat().st_mtime_ns for path in (folder / "pieces").iterdir()} == pieces
    pd.testing.assert_frame_equal(pd.read_csv(folder / "direct_seal.csv"), table)


@pytest.mark.slow
def test_simulated_seal_agrees_with_the_chain_where_little_touches(case_file):
    case = fem_seal.load_case(case_file).replace({"leak.plasticity": False, "direct.samples": 12})
    for row in fem_seal.direct_seal(case):
        error = row.deviation / 12**0.5
        # 15 % of the theory and two standard errors
        assert abs(row.leak_rate - row.chain_held) < 0.15 * row.chain_held + 2.0 * error
        peak, fwhm = row.measures
        assert peak * fwhm == pytest.approx(
            row.place.line_load * 2.0 * np.sqrt(2.0 * np.log(2.0) / (2.0 * np.pi))
        )
        assert fwhm == pytest.approx(row.place.profile.fwhm, rel=0.25)


@pytest.mark.slow
def test_yielding_strips_leak_less_than_elastic_ones(case_file):
    case = fem_seal.load_case(case_file).replace({"load.fluid_pressure": "100 bar", "direct.samples": 2})
    elastic, capped = fem_seal.direct_seal(case)
    assert capped.leak_rate < elastic.leak_rate
    assert capped.contact_area > elastic.contact_area


def test_a_case_without_fluid_or_with_a_map_is_named(case_file, capsys):
    whole = case_file.read_text()
    for text, key in (
        (whole.replace('fluid.name = "water"', ""), "fluid"),
        (whole.replace("samples = 6", 'file = "map.x3p"'), "direct.file"),
    ):
        case_file.write_text(text)
        assert main(["direct", "--seal", str(case_file)]) == 2
        assert key in capsys.readouterr().err
