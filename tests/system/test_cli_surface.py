"""`fem-seal surface` through real files: what it prints, what it writes, how it leaves."""

import json
import math
import re

import numpy as np
import pytest
from places import EXAMPLES

import leak
from fem_seal.case.roughness import read_spectrum
from fem_seal.cli import app as cli
from fem_seal.output.surface import surface_lines, surface_numbers
from fem_seal.units import Display, number

SCAN = EXAMPLES / "seat_scan.csv"


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
    assert "peklenik" not in out
    # the scan was made with 0.60 and an rms height of 1.9 um
    hurst = re.search(r"Hurst exponent +(\S+), (\S+) to (\S+) \(90 %\)", out)
    assert float(hurst[2]) < 0.6 < float(hurst[3])
    height = re.search(r"of the whole surface +(\S+) µm to (\S+) µm \(90 %", out)
    assert float(height[1]) < 1.9 < float(height[2])


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
    assert numbers["hurst_interval"] == list(surface.rolloff.hurst_interval)
    assert numbers["peklenik_flow_across_lay"] is None
    assert numbers["q_high_per_m"] == surface.q_high
    assert numbers["anisotropy"] is None
    assert numbers["scans"][0]["points"] == [4000]


def test_options(call):
    options = ["--detrend", "curvature", "--window", "none", "--tip-radius", "2 um", "--unit", "mm,um"]
    options += [
        "--outliers",
        "remove",
        "--shortest-wavelength",
        "5 um",
        "--hurst",
        "0.8",
        "--q-high",
        "1e8 1/m",
    ]
    code, out, _ = call(SCAN, "--json", *options)
    numbers = json.loads(out)
    assert code == 0
    assert numbers["outliers"] == "remove"
    assert (numbers["detrend"], numbers["window"], numbers["tip_radius_m"]) == ("curvature", "none", 2e-6)
    assert numbers["q_high_per_m"] <= 2 * math.pi / 5e-6 * (1 + 1e-9)
    assert numbers["spectrum_rms_slope"] > numbers["rms_slope"]


def test_several_scans(call):
    code, out, _ = call(SCAN, SCAN)
    assert code == 0
    assert "(scans: 2.0" in out


def test_the_case_key_of_the_lay_is_printed_for_both_directions():
    """Not "Peklenik number 3", which is above one along the lay and turns a turned seat into a scratched one."""
    true = leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=6e4, q_high=1e6)
    heights = leak.random_map(true, size=4e-3, points=512, seed=1, peklenik=3.0)
    surface = leak.measure(leak.height_map(heights, (4e-3 / 512,) * 2))
    lines = dict(surface_lines(Display(), surface))
    across, along = (number(one) for one in surface.peklenik)
    assert float(across) < 1 < float(along)
    assert lines["key peklenik"] == (
        f"{across} if the fluid flows across the lay (a turned seat), {along} if along it"
    )
    numbers = surface_numbers(surface)
    assert numbers["peklenik_flow_across_lay"] == pytest.approx(1 / numbers["peklenik_flow_along_lay"])


def test_turned_face_is_named_with_the_keys_of_its_texture(call, tmp_path):
    fine = leak.PowerSpectrum.self_affine(rms_height=1e-7, hurst=0.8, q_low=3e4, q_rolloff=2.5e5, q_high=4e6)
    x, h = leak.random_line_scan(fine, length=4e-3, points=4_000, seed=1)
    h -= leak.TurnedTexture(feed=1e-4, nose_radius=8e-4, fine=fine).depth_at(np.abs(x % 1e-4 - 5e-5))
    path = tmp_path / "turned.csv"
    np.savetxt(
        path, np.column_stack([x * 1e3, h * 1e6]), delimiter=",", header="x [mm],height [um]", comments=""
    )
    code, out, _ = call(path)
    assert code == 0
    assert re.search(
        r"turned +feed (0\.100 mm|100\.\d µm), nose radius 0\.[78]\d* mm, crests 1\.5\d µm high", out
    )
    assert '[roughness.seat] process = "turned", feed = "0.1 mm", nose_radius = "0.' in out
    assert (tmp_path / "out" / "turned.svg").read_bytes().startswith(b"<?xml")
    numbers = json.loads((tmp_path / "out" / "surface.json").read_text())["turned"]
    assert numbers["feed_m"] == pytest.approx(1e-4, rel=5e-3)
    assert json.loads(call(SCAN, "--json")[1])["turned"] is None


def test_spikes_and_their_filter(call, tmp_path):
    x, h = np.loadtxt(SCAN, delimiter=",", skiprows=2).T
    h[[500, 1200, 1900, 2600, 3300]] += 10.0
    path = tmp_path / "spiked.csv"
    np.savetxt(path, np.column_stack([x, h]), delimiter=",", header="x [mm],height [um]", comments="")
    code, _, err = call(path)
    assert code == 0
    said = " ".join(err.split())
    assert "warning: spiked.csv: 5 outliers, up to" in said and 'outliers = "remove"' in said
    code, out, err = call(path, "--outliers", "remove", "--json")
    assert "5 outliers" in err and "are replaced" in err
    clean = leak.measure(leak.read_topography(SCAN))
    assert json.loads(out)["rms_slope"] == pytest.approx(clean.measured.rms_slope, rel=0.01)


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
        ([SCAN, "--outliers", "drop"], '"keep" or "remove"'),
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
