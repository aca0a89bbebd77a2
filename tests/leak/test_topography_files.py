"""Files of instruments: real ones, text with and without units, and everything that is no scan."""

import sys
from functools import cache

import numpy as np
import pytest
from any_text import ANY
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import leak
from leak.surfaces.likely_units import LENGTH_UNITS

# What each file holds: points, length [m], rms height without tilt [m], with what it was compared.
FILES = {
    # Rq = 3.959 um stands in the file itself (Gaussian filter; tilt alone gives 0.3 % more)
    "mitutoyo_2_mock.xlsx": ((6664,), 9.996e-3, 3.97e-6),
    "mitutoyo_mock.xlsx": ((960,), 0.48e-3, 0.169e-6),
    # 0.342 um if the tilt is drawn through the first and the last point, as SurfaceTopography does
    "hfm-1.hfm": ((9600,), 4.8e-3, 0.2453e-6),
    "dektak-1.csv": ((9600,), 1.5e-3, 0.0942e-6),
    "plu-1.plu": ((768, 576), 1.2749e-3, 0.01828e-6),
}
# A long spreadsheet takes some seconds.
SLOW = {"mitutoyo_2_mock.xlsx": pytest.mark.slow}

SCAN = "".join(f"{0.5 * k:.1f} {0.1 * (k * k % 7):.3f}\n" for k in range(64))


@pytest.fixture
def file(tmp_path):
    """Write a file and return its path."""

    def write(content, name="scan.txt"):
        path = tmp_path / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    return write


@cache
def scan_of(path):
    return leak.read_topography(path)


@cache
def surface_of(path):
    return leak.measure(scan_of(path))


# --- files of instruments -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("names", "size"),
    [
        ("m meter", 1.0),
        ("cm", 0.01),
        ("mm millimeter", 1e-3),
        ("um µm μm micron microns micrometer micrometre", 1e-6),
        ("nm nanometer", 1e-9),
        ("å angstrom", 1e-10),
        ("pm", 1e-12),
        ("in inch", 25.4e-3),
        ("uin µin", 25.4e-9),
    ],
)
def test_units_of_length(names, size):
    for name in names.split():
        assert LENGTH_UNITS[name] == pytest.approx(size, rel=1e-15)
    known = {
        "m", "meter", "cm", "mm", "millimeter", "um", "µm", "μm", "micron", "microns", "micrometer", "micrometre",
        "nm", "nanometer", "å", "angstrom", "pm", "in", "inch", "uin", "µin",
    }  # fmt: skip
    assert set(LENGTH_UNITS) == known


@pytest.mark.parametrize("name", [pytest.param(name, marks=SLOW.get(name, ())) for name in FILES])
def test_instrument_files_read(topography_folder, name):
    if not name.endswith((".hfm", ".csv")):
        pytest.importorskip("SurfaceTopography")
    points, length, rms_height = FILES[name]
    scan, surface = scan_of(topography_folder / name), surface_of(topography_folder / name)
    assert scan.heights.shape == points
    assert scan.length == pytest.approx(length, rel=1e-3)
    assert surface.rms_height == pytest.approx(rms_height, rel=0.01)
    # all of the variance within the range; of the map, that of its corners is outside
    assert surface.height_above < 0.003
    assert surface.spectrum.rms_height == pytest.approx(surface.rms_height, rel=0.002)
    if not name.endswith(".xlsx"):  # a spreadsheet takes more than a second
        assert surface.spectrum == leak.PowerSpectrum.from_file(topography_folder / name)


def test_instrument_files_agree_with_surface_topography(topography_folder):
    io = pytest.importorskip("SurfaceTopography.IO")
    for name in ("hfm-1.hfm", "dektak-1.csv"):
        scan = scan_of(topography_folder / name)
        with io.open_topography(str(topography_folder / name)) as reader:
            topography = reader.topography()
            size = {"mm": 1e-3, "µm": 1e-6}[topography.unit]
            x, h = topography.positions_and_heights()
        assert scan.heights == pytest.approx(np.asarray(h) * size, rel=1e-12)
        assert scan.length == pytest.approx(np.ptp(x) * size, rel=2e-4)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:wmf image format")
def test_profile_spectrum_of_a_real_scan_agrees_with_surface_topography(topography_folder):
    """Its power_spectrum_from_profile is h^2 per dq/(2 pi) and sign of q: C_1D here is that over 2 pi."""
    io = pytest.importorskip("SurfaceTopography.IO")
    path = topography_folder / "mitutoyo_2_mock.xlsx"
    with io.open_topography(str(path)) as reader:
        topography = reader.topography().detrend("slope")
        q, density = topography.to_unit("m").power_spectrum_from_profile(
            window="hann", resampling_method=None
        )
    mine = leak.profile_density(surface_of(path).measured, q[1:])
    ratio = density[1:] / (2 * np.pi) / mine
    for low, high in ((1e4, 1e5), (1e5, 3e5), (3e5, 1e6)):
        known = ratio[(q[1:] > low) & (q[1:] < high)]
        # the mean of n waves, two of three independent, scatters by 1/sqrt(n)
        assert known.mean() == pytest.approx(1.0, abs=0.03 + 3 / np.sqrt(0.5 * known.size))


def test_tip_radius_of_the_file_is_used(topography_folder):
    surface = surface_of(topography_folder / "dektak-1.csv")
    assert surface.tip_radius == pytest.approx(2.5e-6)


def test_without_surface_topography_the_message_says_what_to_install(topography_folder, monkeypatch):
    monkeypatch.setitem(sys.modules, "SurfaceTopography.IO", None)
    with pytest.raises(
        leak.ScanError, match=r"plu-1.plu: .* needs SurfaceTopography, .* install it with: .*\[surfaces\]"
    ):
        leak.read_topography(topography_folder / "plu-1.plu")
    # text needs nothing
    assert leak.read_topography(topography_folder / "hfm-1.hfm").heights.size == 9600


def test_importing_leak_does_not_import_surface_topography():
    import subprocess

    code = "import leak, sys; print('SurfaceTopography' in sys.modules, 'scipy.ndimage' in sys.modules)"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60
    )
    assert done.stdout.split()[0] == "False"


# --- text -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("head", "separator", "units"),
    [
        ("x [um], h [um]\n", ",", (1e-6, 1e-6)),
        ("x (mm);height (µm)\n", ";", (1e-3, 1e-6)),
        ("# measured on Monday\n# x [mm]\tz [nm]\n", "\t", (1e-3, 1e-9)),
        ("x_m h_m\n", " ", (1.0, 1.0)),
        ("Profile 7\n\nX;Z;\n[mm];[um];\n", ";", (1e-3, 1e-6)),
    ],
)
def test_units_in_the_heading(file, head, separator, units):
    # no scan is tens of metres long
    part = 1e-3 if units[0] == 1.0 else 1.0
    rows = [separator.join(f"{part * float(one):g}" for one in line.split()) for line in SCAN.splitlines()]
    scan = leak.read_topography(file(head + "\n".join(rows)))
    assert scan.spacing == pytest.approx(0.5 * part * units[0])
    assert np.ptp(scan.heights) == pytest.approx(0.4 * part * units[1])


def test_units_given(file):
    for unit, sizes in (("um", (1e-6, 1e-6)), (("mm", "um"), (1e-3, 1e-6)), (["cm", "nm"], (1e-2, 1e-9))):
        scan = leak.read_topography(file(SCAN), unit=unit)
        assert (scan.spacing, np.ptp(scan.heights)) == pytest.approx((0.5 * sizes[0], 0.4 * sizes[1]))


def test_units_are_never_guessed(file):
    with pytest.raises(leak.ScanError, match=r"scan.txt: does not state the unit of x: give it"):
        leak.read_topography(file(SCAN))
    with pytest.raises(leak.ScanError, match=r"does not state the unit of height"):
        leak.read_topography(file("x [mm] height\n" + SCAN))
    with pytest.raises(
        leak.ScanError, match=r"unit: the file states that x is in units of 0.001 m, but 1e-06"
    ):
        leak.read_topography(file("x [mm] h [um]\n" + SCAN), unit="um")
    with pytest.raises(leak.ScanError, match=r"unit = 'furlong': must be a unit of length: m, cm"):
        leak.read_topography(file(SCAN), unit="furlong")
    with pytest.raises(leak.ScanError, match=r"must be one unit, or two"):
        leak.read_topography(file(SCAN), unit=("um", "um", "um"))


def test_decimal_commas_between_semicolons(file):
    scan = leak.read_topography(file(SCAN.replace(" ", ";").replace(".", ",")), unit="um")
    assert scan.spacing == pytest.approx(0.5e-6)


def test_utf16_and_windows_line_ends(file):
    text = ("x [µm];z [µm]\r\n" + SCAN.replace(" ", ";").replace("\n", "\r\n")).encode("utf-16")
    assert leak.read_topography(file(text)).spacing == pytest.approx(0.5e-6)


def test_invalid_points_are_left_out(file):
    rows = [f"{k};{k * k % 7};{int(k != 30)}" for k in range(64)]
    scan = leak.read_topography(file("X;Y;valid\n[um];[um];[1/0]\n" + "\n".join(rows), "scan.hfm"))
    assert "interpolated" in scan.remarks[0]
    assert scan.heights[30] == pytest.approx(0.5e-6 * (29 * 29 % 7 + 31 * 31 % 7))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "is empty"),
        (b" \n\n", "is empty"),
        (b"\x00" * 500, "is empty"),
        (b"1 2\n", "a scan of 1 point"),
        (b"1\n2\n3\n", "line 1 holds 1 column: must hold two"),
        (b"1 2 3 4 5\n" * 30, "line 1 holds 5 columns: must hold two"),
        (b"hello\nworld\n", "no columns of numbers"),
        (SCAN.replace("\n5.0 ", "\nnan ").encode(), "must hold 2 finite numbers"),
        (SCAN.replace("0.400", "inf").encode(), "must hold 2 finite numbers"),
        ((SCAN + "oops\n" + SCAN).encode(), r'line 65 \("oops"\): must hold 2 finite numbers'),
        ((SCAN + "1 2 3\n").encode(), r'line 65 \("1 2 3"\)'),
        ((SCAN + SCAN).encode(), "not monotonic"),
        (SCAN.replace("\n7.0 ", "\n6.0 ").encode(), "not monotonic"),
        (b"\x89PNG\r\n\x1a\n" + bytes(range(256)) * 4, "is not a text file"),
        (b"PK\x03\x04" + bytes(range(256)) * 4, "is not a text file"),
        (b"Angle [deg];Deviation [um]\n" + b"0;3.1\n1;3.2\n" * 20, "it is a roundness trace, no scan"),
    ],
)
def test_bad_files_are_refused(file, content, message):
    with pytest.raises(leak.ScanError, match=message) as caught:
        leak.read_topography(file(content), unit="um")
    assert str(caught.value).startswith(str(file(content)))


def _rows(line: str) -> str:
    """The points of `SCAN` in another layout."""
    points = [row.split() for row in SCAN.splitlines()]
    return "\n".join(
        line.format(n=n, x=x, z=z, cx=x.replace(".", ","), cz=z.replace(".", ","))
        for n, (x, z) in enumerate(points)
    )


@pytest.mark.parametrize(
    "content",
    [
        "index,x [µm],z [µm]\n" + _rows("{n},{x},{z}"),
        "Point No.;x [um];z [um]\n" + _rows("{n};{x};{z}"),
        "#;x [um];z [um];valid\n" + _rows("{n};{x};{z};1"),
        "x [um],y [um],z [um]\n" + _rows("{x},7.5,{z}"),
        '"x [um]","z [um]"\n' + _rows('"{x}","{z}"'),
        '"x [um]","z [um]"\n' + _rows('"{cx}","{cz}"'),
        "x [um], z [um]\n" + _rows("{x}, {z}"),
        "x [um], z [um]\n" + _rows("{cx}, {cz}"),
        "x [um] z [um]\n" + _rows("{cx} {cz}"),
    ],
)
def test_points_with_numbers_quotes_and_blanks_are_those_of_the_plain_file(file, content):
    found, plain = (
        leak.read_topography(file(content)),
        leak.read_topography(file(SCAN, "plain.txt"), unit="um"),
    )
    assert found.spacing == pytest.approx(plain.spacing)
    assert found.heights == pytest.approx(plain.heights)
    # the numbers of the points are no x, and heights in whole units no numbers of points
    bare = leak.read_topography(file(_rows("{n} {x} {z}"), "bare.txt"), unit="um")
    assert bare.heights == pytest.approx(plain.heights)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("index;z [um]\n" + _rows("{n};{z}"), "numbers of points in place of x"),
        (
            "x [um];raw [um];waviness [um]\n" + _rows("{x};{z};{n}"),
            r"3 columns \(x \[um\], raw \[um\], waviness",
        ),
    ],
)
def test_columns_that_are_no_scan_are_told(file, content, message):
    with pytest.raises(leak.ScanError, match=message):
        leak.read_topography(file(content))


@pytest.mark.parametrize(
    ("units", "factors", "meant"),
    [
        # a length of 800 um with heights of 2 um, in the units of the file and as it is read
        (("mm", "m"), (1e-3, 1.0), "is the unit of height um"),
        (("mm", "mm"), (1e-3, 1.0), "is the unit of height um"),
        (("m", "m"), (1.0, 1.0), "is its unit um"),
        (("m", "um"), (1.0, 1.0), "is the unit of x um"),
        (("nm", "nm"), (1.0, 1.0), "is its unit um"),
        (("um", "mm"), (1.0, 1.0), "is the unit of height um"),
    ],
)
def test_a_scan_that_is_no_surface_is_asked_for_its_unit(file, units, factors, meant):
    random = np.random.default_rng(3)
    z = np.convolve(random.standard_normal(1620), np.ones(21) / 21, "valid")
    x, (in_x, in_z) = 0.5 * np.arange(1600), factors
    rows = "\n".join(f"{in_x * a:.9g};{in_z * b:.9g}" for a, b in zip(x, z, strict=True))
    with pytest.raises(leak.ScanError, match=f"no measured surface; {meant}"):
        leak.read_topography(file(f"x [{units[0]}];z [{units[1]}]\n{rows}"))
    with pytest.raises(leak.ScanError, match=f"no measured surface; {meant}"):
        leak.read_topography(file(rows, "bare.csv"), unit=units)
    right = leak.read_topography(file(rows, "bare.csv"), unit=("mm" if in_x < 1 else "um", "um"))
    assert right.length == pytest.approx(8e-4)


def test_what_a_reader_says_of_itself_is_not_told(file, monkeypatch):
    pytest.importorskip("SurfaceTopography")

    def fails(*_):
        raise IndexError("list index out of range")

    monkeypatch.setattr("SurfaceTopography.IO.open_topography", fails)
    with pytest.raises(leak.ScanError) as caught:
        leak.read_topography(file(b"\x89PNG\r\n\x1a\n" + bytes(range(256)), "scan.png"), unit="um")
    assert "SurfaceTopography cannot read it" in str(caught.value)
    assert "index" not in str(caught.value)


@pytest.mark.parametrize("suffix", [".xlsx", ".plu", ".hfm", ".csv", ".txt", ".npy", ".x3p", ".sur", ".dat"])
def test_garbage_of_any_suffix_is_refused(file, suffix):
    content = np.random.default_rng(1).bytes(5000)
    with pytest.raises(leak.ScanError, match="scan" + suffix):
        leak.read_topography(file(content, "scan" + suffix), unit="um")


def test_text_maps_read_through_surface_topography(file):
    pytest.importorskip("SurfaceTopography")
    x, y = np.meshgrid(0.5 * np.arange(32), 0.25 * np.arange(24), indexing="ij")
    z = np.random.default_rng(0).standard_normal(x.shape)
    path = file(
        "\n".join(f"{a} {b} {c}" for a, b, c in zip(x.T.flat, y.T.flat, z.T.flat, strict=True)), "map.xyz"
    )
    scan = leak.read_topography(path, unit=("um", "nm"))
    assert scan.spacing == pytest.approx((0.5e-6, 0.25e-6))
    assert scan.heights == pytest.approx(1e-9 * z)
    with pytest.raises(leak.ScanError, match="does not state the unit of x"):
        leak.read_topography(path)


def test_a_matrix_of_heights_without_size_is_refused(file):
    pytest.importorskip("SurfaceTopography")
    rows = np.random.default_rng(0).standard_normal((32, 24))
    path = file("\n".join(" ".join(map(str, row)) for row in rows), "matrix.txt")
    with pytest.raises(leak.ScanError, match="how long and wide the measured area is"):
        leak.read_topography(path, unit="um")


def test_missing_files_and_folders_are_refused(tmp_path):
    with pytest.raises(leak.ScanError, match=r"cannot be read \(no such file"):
        leak.read_topography(tmp_path / "none.csv")
    with pytest.raises(leak.ScanError, match=r"cannot be read \(is a directory"):
        leak.read_topography(tmp_path)
    with pytest.raises(leak.ScanError, match="not a file name"):
        leak.read_topography("a\0b")


@pytest.mark.parametrize("name", FILES)
def test_damaged_instrument_files_are_refused_or_read(topography_folder, file, name):
    content = (topography_folder / name).read_bytes()
    random = np.random.default_rng(0)
    for part in (content[: len(content) // 3], content[:300], content[100:]):
        _read_or_refuse(file(part, name))
    for _ in range(3):
        damaged = bytearray(content)
        for place in random.integers(0, min(len(content), 4000), 20):
            damaged[place] = random.integers(256)
        _read_or_refuse(file(bytes(damaged), name))


@pytest.mark.slow
@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    st.one_of(
        st.binary(max_size=300),
        st.text(ANY, max_size=200).map(str.encode),
        st.text("0123456789.,;+-eE \t\nnaif[]um#", max_size=400).map(str.encode),
        st.lists(st.tuples(st.floats(), st.floats()), max_size=40).map(
            lambda rows: "\n".join(f"{x} {h}" for x, h in rows).encode()
        ),
    ),
    st.sampled_from([".txt", ".csv", ".hfm", ".xyz"]),
)
def test_fuzzed_files_never_surprise(file, content, suffix):
    _read_or_refuse(file(content, "fuzz" + suffix))


@settings(max_examples=100, deadline=None)
@given(
    st.lists(st.floats(-1e3, 1e3), min_size=16, max_size=60, unique=True),
    st.integers(0, 2**31),
    st.floats(-12, 3),
)
def test_fuzzed_positions_never_surprise(positions, seed, size):
    x = np.sort(positions)
    h = np.random.default_rng(seed).standard_normal(x.size) * 10.0**size
    try:
        found = leak.PowerSpectrum.from_profile(x, h)
    except leak.ScanError:
        return
    assert np.isfinite(found.rms_height)


def _read_or_refuse(path):
    try:
        surface = leak.measure(leak.read_topography(path, unit="um"))
    except leak.ScanError as error:
        assert str(error)
        return
    assert np.isfinite(surface.spectrum.rms_height)


def test_positions_that_differ_by_round_off_are_refused():
    x = np.sort([-1.1e-308, 2.2e-308, *np.linspace(-1, 1, 20)])
    with pytest.raises(leak.ScanError, match="lie only"):
        leak.PowerSpectrum.from_profile(x, np.sin(7 * x))
