"""The table [roughness]: measured spectra, two surfaces that add, and what is refused."""

import numpy as np
import pytest
from places import EXAMPLES
from sample_results import ball, cone

import leak
from fem_seal import Case, load_case
from fem_seal.answers.samples import UncertainScans, changed_surface
from fem_seal.case.roughness import scanned_faces
from fem_seal.errors import InputError
from fem_seal.output.case_words import finish_rows
from fem_seal.seal.problem import rough_contact

SCAN = EXAMPLES / "seat_scan.csv"
FLAT = {"kind": "self-affine", "rms_height": "0.5 um", "hurst": 0.8}
FLAT |= {"q_low": "1e3 1/m", "q_rolloff": "1e4 1/m", "q_high": "1e6 1/m"}
PROFILE = {"kind": "profile", "file": str(SCAN)}


def case(**roughness):
    return Case(
        closure=ball("steel 1.4122"),
        seat=cone({"youngs_modulus": "70 GPa", "poissons_ratio": 0.3, "hardness": "1 GPa"}),
        roughness=roughness,
        load={"fluid_pressure": "20 bar"},
    )


def wrong(**roughness):
    with pytest.raises(InputError) as caught:
        case(**roughness)
    return str(caught.value)


def test_a_measured_spectrum_is_the_one_of_leak():
    expected = leak.PowerSpectrum.from_file(SCAN)
    assert case(spectrum=PROFILE).roughness.build() == expected
    assert case(spectrum={"kind": "profile", "files": [str(SCAN)]}).roughness.build() == expected
    # the file states its units; saying them again is no contradiction
    assert case(spectrum={**PROFILE, "unit": ["mm", "um"]}).roughness.build() == expected


def test_settings_reach_leak():
    entries = {
        **PROFILE,
        "detrend": "curvature",
        "tip_radius": "2 um",
        "shortest_wavelength": "5 um",
        "extrapolation": "self-affine",
        "hurst": 0.7,
        "q_low": "1e2 1/m",
        "q_high": "1e8 1/m",
    }
    expected = leak.PowerSpectrum.from_file(
        SCAN,
        detrend="curvature",
        tip_radius=2e-6,
        shortest_wavelength=5e-6,
        extrapolation=leak.SelfAffineContinuation(0.7, q_low=1e2, q_high=1e8),
    )
    assert case(spectrum=entries).roughness.build() == expected


def test_seat_and_closure_add():
    both = case(seat=PROFILE, closure=FLAT).roughness.build()
    seat, closure = (case(spectrum=one).roughness.build() for one in (PROFILE, FLAT))
    assert both.rms_height**2 == pytest.approx(seat.rms_height**2 + closure.rms_height**2, rel=1e-4)
    assert both(5e4) == pytest.approx(seat(5e4) + closure(5e4), rel=1e-4)
    assert case(closure=FLAT).roughness.build() == closure


def test_yielding_acts_on_the_sum_with_the_softer_hardness():
    surface = rough_contact(case(seat=PROFILE, closure=FLAT).replace({"leak.theory": "paper"}))
    assert surface.hardness == 1e9
    total = leak.PowerSpectrum.from_file(SCAN) + case(closure=FLAT).roughness.build()
    alone = leak.RoughContact(total, effective_modulus=surface.effective_modulus, hardness=1e9)
    q = np.geomspace(2e3, 9e5, 7)
    assert surface.plastic_spectrum(5e7)(q) == pytest.approx(alone.plastic_spectrum(5e7)(q), rel=1e-12)


def test_scans_are_averaged_and_known_one_by_one(tmp_path):
    other = tmp_path / "other.csv"
    x, h = leak.random_line_scan(case(spectrum=FLAT).roughness.build(), length=4e-3, points=4000, seed=1)
    np.savetxt(other, np.column_stack([1e3 * x, 1e3 * h]))
    entry = {"kind": "profile", "files": [str(other), str(other)], "unit": "mm"}
    spectrum = case(spectrum=entry).roughness.spectrum
    one, two = spectrum.each_scan()
    assert one == two
    assert spectrum.build().rms_height == pytest.approx(one.rms_height, rel=1e-6)


def turned_file(folder, seed, **changes):
    """A scan of a known face across its crests, with a tilt and noise of the instrument."""
    values = {"feed": 5e-5, "nose_radius": 4e-4, **changes}
    x, h = leak.random_line_scan(FINE, length=4e-3, points=8000, seed=seed)
    texture = leak.TurnedTexture(fine=FINE, **values)
    feed = texture.feed
    h -= texture.depth_at(np.abs((x + 1e-5 * seed) % feed - 0.5 * feed))
    h += 0.001 * x + 1e-9 * np.random.default_rng(seed).standard_normal(x.size)
    path = folder / f"turned_{seed}.csv"
    np.savetxt(
        path, np.column_stack([1e3 * x, 1e6 * h]), delimiter=",", header="x [mm],height [um]", comments=""
    )
    return str(path)


FINE = leak.PowerSpectrum.self_affine(
    rms_height=1e-7, hurst=0.8, q_low=np.pi / 5e-5, q_rolloff=2.5e5, q_high=4e6
)


@pytest.fixture(scope="module")
def turned_files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("scans")
    return [turned_file(folder, seed) for seed in (1, 2, 3)]


def test_scans_that_show_a_feed_leak_as_the_face_that_they_are_of(turned_files):
    measured = rough_contact(case(seat={"kind": "profile", "files": turned_files}))
    fine = {"rms_height": "0.1 um", "hurst": 0.8, "q_rolloff": "2.5e5 1/m", "q_high": "4e6 1/m"}
    face = {"process": "turned", "feed": "50 um", "nose_radius": "0.4 mm", "fine": fine}
    given = rough_contact(case(seat=face))
    assert isinstance(measured, leak.TurnedContact) and isinstance(given, leak.TurnedContact)
    assert measured.feed == pytest.approx(given.feed, rel=2e-3)
    assert measured.nose_radius == pytest.approx(given.nose_radius, rel=0.05)
    assert measured.thread_radius == given.thread_radius
    p = np.array([2e6, 5e6, 1e7])
    ratio = measured.flow_conductivity(p, 1e-3) / given.flow_conductivity(p, 1e-3)
    assert np.all((ratio > 0.6) & (ratio < 1.4))
    # the other face joins the fine roughness, and the report says what was seen
    both = case(seat={"kind": "profile", "files": turned_files, "spiral": False}, closure=FLAT)
    surface = rough_contact(both)
    assert np.isinf(surface.thread_radius)
    assert surface.fine.rms_height == pytest.approx(np.hypot(measured.fine.rms_height, 5e-7), rel=1e-3)
    assert dict(finish_rows(both))["finish of seat"].startswith(
        "measured: turned, feed 50.0 µm, nose radius 0."
    )


def test_a_measured_turned_face_can_be_refused(turned_files):
    entries = {"kind": "profile", "file": turned_files[0]}
    random = rough_contact(case(seat={**entries, "turned": False}))
    assert isinstance(random, leak.RoughContact)
    assert random.spectrum == leak.PowerSpectrum.from_file(turned_files[0])
    assert "one wave" in " ".join(case(seat={**entries, "turned": False}).roughness.remarks())
    # with the cusps it is no wave of a random surface any more
    assert list(case(seat=entries).roughness.remarks()) == []
    assert isinstance(rough_contact(case(along=PROFILE, across=entries)), leak.RoughContact)
    assert "turned = false" in wrong(seat=entries, peklenik=0.2)
    assert "turned = false" in str(refused(case(seat=entries), {"leak.theory": "paper"}))
    assert "scans show no feed" in wrong(seat={**PROFILE, "spiral": False})
    both = rough_contact(case(seat=entries, closure=entries))
    assert isinstance(both, leak.TurnedContact) and both.other == both.texture.own


def refused(base, changes):
    with pytest.raises(InputError) as caught:
        base.replace(changes)
    return caught.value


def test_scans_without_a_feed_are_left_out_where_most_have_one(turned_files, tmp_path):
    along = tmp_path / "along.csv"
    x, h = leak.random_line_scan(FINE, length=4e-3, points=8000, seed=9)
    np.savetxt(along, np.column_stack([1e3 * x, 1e6 * h]))
    several = {"kind": "profile", "files": [*turned_files[:2], str(along)], "unit": ["mm", "um"]}
    roughness = case(seat=several).roughness
    assert [texture.feed for texture in roughness.seat.each_scan()] == pytest.approx([5e-5] * 2, rel=2e-3)
    (remark,) = roughness.remarks()
    assert "1 of 3 scans shows no feed" in remark and "50.0 µm" in remark
    # half of the scans are not most of them
    half = {**several, "files": [turned_files[0], str(along)]}
    assert isinstance(rough_contact(case(seat=half)), leak.RoughContact)


def test_scans_of_unlike_feeds_are_weighted_as_whole_faces(tmp_path):
    files = [turned_file(tmp_path, 1), turned_file(tmp_path, 2, feed=6.25e-5, nose_radius=8e-4)]
    measured = case(seat={"kind": "profile", "files": files})
    one, two = scanned_faces(measured.roughness)["seat"]
    mean = UncertainScans("seat", (one, two)).mean(np.array([0.25, 0.75]))
    assert mean.feed == pytest.approx(0.25 * one.feed + 0.75 * two.feed)
    assert 1.0 / mean.nose_radius == pytest.approx(0.25 / one.nose_radius + 0.75 / two.nose_radius)
    swapped = changed_surface(measured, rough_contact(measured), {}, {"seat": mean})
    assert (swapped.feed, swapped.nose_radius) == pytest.approx((mean.feed, mean.nose_radius))
    assert swapped.fine.rms_height == pytest.approx(mean.fine.rms_height)


def test_a_changed_file_is_read_again(tmp_path):
    path = tmp_path / "scan.csv"
    text = SCAN.read_text()
    path.write_text(text)
    first = case(spectrum={"kind": "profile", "file": str(path)}).roughness.build()
    path.write_text(text.replace("[um]", "[nm]"))
    second = case(spectrum={"kind": "profile", "file": str(path)}).roughness.build()
    assert second.rms_height == pytest.approx(1e-3 * first.rms_height, rel=1e-6)


def test_files_are_found_beside_the_case(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    loaded = load_case(EXAMPLES / "measured_seat.toml")
    assert loaded.roughness.seat.paths == (str(SCAN.absolute()),)
    again = loaded.replace({"load.fluid_pressure": "3 bar"})
    assert again.roughness.build() == loaded.roughness.build()
    # the surface that was put into the scan has rms height 1.9 um and slope 0.398
    assert loaded.roughness.build().rms_slope == pytest.approx(0.398, rel=0.05)


def test_remarks_on_the_scans_are_the_case_s(tmp_path):
    assert list(case(spectrum=PROFILE).roughness.remarks()) == []
    x = 1e-6 * np.arange(2000)
    h = 1e-6 * np.sin(x / 2e-5) + 1e-7 * np.random.default_rng(0).standard_normal(2000)
    np.savetxt(tmp_path / "turned.txt", np.column_stack([x, h]))
    turned = {"kind": "profile", "file": str(tmp_path / "turned.txt"), "unit": "m"}
    remarks = list(case(seat=turned).roughness.remarks())
    assert any(one.startswith("roughness.seat: ") and "one wave" in one for one in remarks)


@pytest.mark.parametrize(
    ("roughness", "said"),
    [
        ({}, "roughness: needs spectrum, of both surfaces together, or seat, closure or both"),
        ({"spectrum": FLAT, "seat": FLAT}, "not both ways"),
        ({"spectrum": {"kind": "profile"}}, 'roughness.spectrum: needs file = "seat.csv"'),
        ({"spectrum": {**PROFILE, "files": ["a"]}}, "one of both"),
        ({"spectrum": {**PROFILE, "file": "none.csv"}}, "none.csv: cannot be read (no such file"),
        ({"spectrum": {**PROFILE, "file": str(SCAN.parent)}}, "is a folder"),
        ({"spectrum": {"kind": "profile", "files": []}}, "has 0 entries"),
        ({"spectrum": {"kind": "profile", "files": [5]}}, "must be a list of texts"),
        ({"spectrum": {**PROFILE, "unit": "furlong"}}, 'roughness.spectrum.unit = "furlong"'),
        ({"spectrum": {**PROFILE, "unit": "nm"}}, "the file states that x is in units of 0.001 m"),
        ({"spectrum": {**PROFILE, "unit": ["mm"]}}, "must be one unit, or two"),
        ({"spectrum": {**PROFILE, "detrend": "parabola"}}, '"tilt" or "mean" or "curvature"'),
        ({"spectrum": {**PROFILE, "tip_radius": "2 mm s"}}, "roughness.spectrum.tip_radius"),
        ({"spectrum": {**PROFILE, "hurst": 0.8}}, 'hurst is only for extrapolation = "self-affine"'),
        ({"spectrum": {**PROFILE, "extrapolation": "self-affine"}}, "needs hurst"),
        (
            {"spectrum": {**PROFILE, "extrapolation": "self-affine", "hurst": 0.8}},
            "q_low and q_high are both missing",
        ),
        (
            {"spectrum": {**PROFILE, "extrapolation": "self-affine", "hurst": 0.8, "q_high": "1e5 1/m"}},
            "must be above the reliable range",
        ),
        ({"spectrum": {**PROFILE, "detrnd": "tilt"}}, "do you mean detrend?"),
        ({"seat": {**FLAT, "q_low": "1e7 1/m"}}, "roughness.seat.q_low"),
        ({"closure": {"kind": "tabel"}}, '"self-affine" or "table" or "profile"'),
        ({"closure": {}}, 'roughness.closure.kind: is missing; write kind = "self-affine"'),
    ],
)
def test_message_for(roughness, said):
    assert said in wrong(**roughness)
