"""`fem-seal surface` through real files: what it prints, what it writes, how it leaves."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

import leak
from fem_seal import cli
from fem_seal.spectrum_file import read_spectrum

SCAN = Path(__file__).parent.parent / "examples" / "seat_scan.csv"


@pytest.fixture
def call(capsys, tmp_path):
    """Run the command with an output folder; exit code, stdout, stderr."""

    def run(*arguments):
        code = cli.main(["surface", *map(str, arguments), "-o", str(tmp_path / "out")])
        out, err = capsys.readouterr()
        return code, out, err

    return run


def test_what_it_prints(call):
    code, out, err = call(SCAN)
    assert (code, err) == (0, "")
    for name in (
        "4000 points over 4.00 mm",
        "rms height",
        "rms slope",
        "skewness, kurtosis",
        "roll-off",
        "Hurst exponent",
        "reliable range",
        "(short end: sampling)",
        "spectrum.csv, surface.json, surface.svg",
    ):
        assert name in out
    assert "anisotropy" not in out


def test_what_it_writes(call, tmp_path):
    call(SCAN)
    spectrum = leak.PowerSpectrum.from_file(SCAN)
    # as it goes into a case with kind = "table"
    assert leak.PowerSpectrum.from_table(*read_spectrum(tmp_path / "out" / "spectrum.csv")) == spectrum
    assert (tmp_path / "out" / "surface.svg").read_bytes().startswith(b"<?xml")
    numbers = json.loads((tmp_path / "out" / "surface.json").read_text())
    assert numbers["spectrum_rms_height_m"] == spectrum.rms_height


def test_json_has_the_numbers_of_leak(call):
    code, out, _ = call(SCAN, "--json")
    numbers = json.loads(out)
    surface = leak.measure(leak.read_topography(SCAN))
    assert code == 0
    assert numbers["rms_height_m"] == surface.rms_height
    assert numbers["skewness"] == surface.skewness
    assert numbers["hurst"] == surface.rolloff.hurst
    assert numbers["q_high_per_m"] == surface.q_high
    assert numbers["anisotropy"] is None
    assert numbers["scans"][0]["points"] == [4000]


def test_options(call):
    options = ["--detrend", "curvature", "--window", "none", "--tip-radius", "2 um", "--unit", "mm,um"]
    options += ["--shortest-wavelength", "5 um", "--hurst", "0.8", "--q-high", "1e8 1/m"]
    code, out, _ = call(SCAN, "--json", *options)
    numbers = json.loads(out)
    assert code == 0
    assert (numbers["detrend"], numbers["window"], numbers["tip_radius_m"]) == ("curvature", "none", 2e-6)
    assert numbers["q_high_per_m"] <= 2 * math.pi / 5e-6 * (1 + 1e-9)
    assert numbers["spectrum_rms_slope"] > numbers["rms_slope"]


def test_several_scans(call):
    code, out, _ = call(SCAN, SCAN)
    assert code == 0
    assert "(scans: 2.0" in out


def test_a_map_shows_its_lay(call, topography_folder):
    pytest.importorskip("SurfaceTopography")
    code, out, err = call(topography_folder / "plu-1.plu")
    assert code == 0
    assert "anisotropy" in out
    assert "lay at 9" in out
    assert "warning: anisotropic" in err


def test_far_from_gaussian_is_warned_about(call, tmp_path):
    x = 1e-6 * np.arange(3000)
    h = np.exp(np.random.default_rng(0).standard_normal(3000))
    path = tmp_path / "peaks.txt"
    np.savetxt(path, np.column_stack([x, 1e-6 * h]))
    code, out, err = call(path, "--unit", "m", "--quiet")
    assert (code, out) == (0, "")
    assert "warning: far from Gaussian: skewness" in err


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["none.csv"], "none.csv: cannot be read"),
        ([SCAN, "--unit", "nm"], "the file states that x is in units of 0.001 m"),
        ([SCAN, "--unit", "furlong"], "must be a unit of length"),
        ([SCAN, "--detrend", "parabola"], '"tilt" or "mean" or "curvature"'),
        ([SCAN, "--tip-radius", "5"], 'tip_radius = "5": has no unit'),
        ([SCAN, "--q-high", "1e8 1/m"], "needs hurst"),
        ([SCAN, "--hurst", "1.5", "--q-high", "1e8 1/m"], "hurst = 1.5"),
        ([], "Missing argument"),
    ],
)
def test_wrong_input_leaves_with_2(call, options, said):
    code, out, err = call(*options)
    assert code == 2
    assert out == ""
    assert said in err


@pytest.mark.parametrize(
    "content", [b"", b"\x00\xff" * 300, b"1 2\n", b"1 2 3\n4 5 6\n", b"x\ny\n", b"1 nan\n" * 40]
)
def test_bad_files_leave_with_2(call, tmp_path, content):
    path = tmp_path / "bad.txt"
    path.write_bytes(content)
    code, _, err = call(path, "--unit", "um")
    assert code == 2
    assert err.startswith("error: ") and "bad.txt" in err
    assert "defect" not in err
