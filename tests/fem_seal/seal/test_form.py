"""What a form error does to the gap: waves, rigid motions, traces, tolerances, and the table [form]."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fem_seal import Case, InputError, Study, load_case
from fem_seal.case.form import Form
from fem_seal.case.paths import entry_at, entry_paths
from fem_seal.case.traces import read_lay
from fem_seal.cli.app import main
from fem_seal.errors import TextTableError
from fem_seal.form import FormError, Trace, Wave, WaveTolerance, along_normal, combine_waves, rigid_wave
from leak import SpiralLay

TURN = 2 * np.pi * np.arange(360) / 360
ANGLE45 = math.radians(45)

AMPLITUDES = st.floats(-1e-5, 1e-5)
WAVES = st.builds(Wave, st.integers(1, 8), AMPLITUDES, st.floats(-7.0, 7.0))


def total(waves: Any, angle: np.ndarray = TURN) -> np.ndarray:
    return sum((one.at(angle) for one in waves), np.zeros_like(angle))


# ---------------------------------------------------------------- waves


@given(st.lists(WAVES, max_size=8))
def test_combined_waves_are_the_same_deviation(waves: list[Wave]) -> None:
    found = combine_waves(waves)
    np.testing.assert_allclose(total(found), total(waves), atol=1e-19)
    numbers = [one.waves for one in found]
    assert numbers == sorted(set(numbers)) and all(one.amplitude >= 0 for one in found)


def test_the_first_crest_stands_at_the_phase_over_the_number_of_waves() -> None:
    wave = Wave(3, 2e-6, 0.6)
    assert wave.at(0.2) == pytest.approx(2e-6)
    assert (wave.phasor * np.exp(3j * 0.1)).real == pytest.approx(wave.at(0.1))


def test_a_free_closure_feels_no_first_wave() -> None:
    waves = (Wave(1, 5e-6), Wave(4, 1e-6), Wave(6, 2e-6))
    free, guided = FormError(waves, highest=6), FormError(waves, guided=True, highest=6)
    assert [one.waves for one in free.felt_waves] == [4, 6] and free.symmetry == 2
    assert [one.waves for one in guided.felt_waves] == [1, 4, 6] and guided.symmetry == 1
    np.testing.assert_allclose(free.gap(TURN), total(waves[1:]), atol=1e-20)
    np.testing.assert_allclose(guided.gap(TURN), total(waves), atol=1e-20)
    np.testing.assert_allclose(guided.scale(-2.0).gap(TURN), -2 * total(waves), atol=1e-20)


def test_a_tolerance_is_filled_where_the_rest_is_widest() -> None:
    tolerance = WaveTolerance(1e-6, (2, 5))
    alone = FormError(tolerance=tolerance, highest=5).with_waves(3)
    assert alone.tolerance is None and alone.gap(TURN).max() == pytest.approx(1e-6)
    form = FormError((Wave(2, 2e-6, 1.0),), tolerance=tolerance, highest=5)
    for number in tolerance.candidates:
        filled = form.with_waves(number)
        # crest on crest, which no other place of the same waves exceeds
        assert filled.gap(np.array([0.5]))[0] == pytest.approx(3e-6, rel=1e-5)
        assert filled.highest == 5
    assert list(tolerance.candidates) == [2, 3, 4, 5]
    assert form.scale(2.0).tolerance == WaveTolerance(2e-6, (2, 5))
    assert alone.with_waves(7) is alone


# ---------------------------------------------------------------- directions and rigid motions


def test_signs_of_deviations_on_a_cone() -> None:
    """The normal points from the seat to the closure, inwards and up: a wider seat opens, a higher one closes."""
    normal = (-math.sin(ANGLE45), math.cos(ANGLE45))
    seat_moved = {"radial": (1.0, 0.0), "axial": (0.0, 1.0), "normal": normal}
    for direction, moved in seat_moved.items():
        share = along_normal(direction, normal)  # type: ignore[arg-type]
        assert share == pytest.approx(np.dot(moved, normal))
    form = {}
    for body in ("seat", "closure"):
        for direction in seat_moved:
            case = sealed(
                **{body: {"direction": direction, "harmonics": [{"waves": 2, "amplitude": "1 um"}]}}
            )
            form[body, direction] = error_of(case).gap(np.array([0.0]))[0]
    root = math.sqrt(0.5) * 1e-6
    assert form["seat", "radial"] == pytest.approx(root)
    assert form["seat", "axial"] == pytest.approx(-root)
    assert form["seat", "normal"] == pytest.approx(-1e-6)
    for direction in seat_moved:
        assert form["closure", direction] == pytest.approx(-form["seat", direction])


@given(
    st.floats(-1.2, 1.2),
    st.floats(0.0, 1e-6),
    st.floats(-math.pi, math.pi),
    st.floats(0.0, 1e-4),
    st.floats(-math.pi, math.pi),
    st.floats(-0.05, 0.05),
)
def test_rigid_motion_against_a_circle_of_points(
    angle: float, e: float, towards: float, tilt: float, leans: float, height: float
) -> None:
    """The closure's points of first touch, turned about the pivot and shifted, in three dimensions.

    What is left is of second order: tilt times tilt times the distance to the pivot.
    """
    normal, r0 = (-math.sin(angle), math.cos(angle)), 0.014
    points = np.stack([r0 * np.cos(TURN), r0 * np.sin(TURN), np.zeros_like(TURN)])
    axis = np.array([-math.sin(leans), math.cos(leans), 0.0])  # its top goes towards `leans`
    pivot = np.array([0.0, 0.0, height])[:, None]
    arm = points - pivot
    turned = (
        arm * math.cos(tilt)
        + np.cross(axis, arm.T).T * math.sin(tilt)
        + np.outer(axis, axis @ arm) * (1 - math.cos(tilt))
    )
    moved = turned + pivot - points + e * np.array([math.cos(towards), math.sin(towards), 0.0])[:, None]
    n = np.stack([normal[0] * np.cos(TURN), normal[0] * np.sin(TURN), np.full_like(TURN, normal[1])])
    expected = np.sum(moved * n, axis=0)
    found = total(rigid_wave(normal, r0, e, towards, tilt, leans, height))
    np.testing.assert_allclose(found, expected, atol=2 * tilt**2 * (r0 + abs(height)) + 1e-18)


def test_a_ball_that_leans_about_its_centre_stays_where_it_is() -> None:
    for angle in (0.3, ANGLE45, 1.1):
        normal, radius = (-math.sin(angle), math.cos(angle)), 0.02
        waves = rigid_wave(normal, radius * math.sin(angle), tilt=1e-3, tilt_height=radius * math.cos(angle))
        assert max(abs(one.amplitude) for one in waves) < 1e-18


# ---------------------------------------------------------------- traces


def test_waves_of_a_trace_with_gaps_and_an_offset() -> None:
    """Noise-free and uneven, with a missing sector of 60 degrees: exact, since 2 N + 1 unknowns fit it."""
    generator = np.random.default_rng(1)
    angle = np.sort(generator.uniform(0.0, 2 * np.pi, 400))
    angle = angle[(angle < 2.0) | (angle > 2.0 + math.radians(40))]
    waves = [Wave(1, 30e-6, 1.0), Wave(2, 1e-6, -0.3), Wave(3, 2e-7, 2.0)]
    trace = Trace(angle, 12e-3 + total(waves, angle))
    assert trace.most_waves >= 3
    for found, given_one in zip(trace.waves(3), waves, strict=True):
        assert found.amplitude == pytest.approx(given_one.amplitude, rel=1e-8)
        assert found.phase == pytest.approx(given_one.phase, abs=1e-8)
    assert trace.residual(trace.waves(3)) < 1e-14
    assert trace.residual(trace.waves(2)) == pytest.approx(2e-7 / math.sqrt(2), rel=0.1)


def test_the_highest_wave_that_a_trace_tells_is_found_at_any_phase() -> None:
    angle = 2 * np.pi * np.arange(9) / 9
    for phase in (0.0, 0.7, math.pi / 2):
        trace = Trace(angle, Wave(4, 1e-6, phase).at(angle))
        assert trace.most_waves == 4
        assert trace.waves(4)[-1].amplitude == pytest.approx(1e-6)
        assert trace.waves(4)[-1].phase == pytest.approx(phase, abs=1e-9)


def test_waves_of_a_noisy_trace_against_the_normal_equations() -> None:
    generator = np.random.default_rng(2)
    angle = generator.uniform(0.0, 2 * np.pi, 300)
    deviation = 1e-6 * np.cos(2 * angle) + 3e-7 * generator.standard_normal(300)
    basis = np.stack([np.ones(300), *(f(n * angle) for n in range(1, 6) for f in (np.cos, np.sin))])
    expected = np.linalg.solve(basis @ basis.T, basis @ deviation)
    for n, found in enumerate(Trace(angle, deviation).waves(5), start=1):
        assert found.amplitude * math.cos(found.phase) == pytest.approx(expected[2 * n - 1], abs=1e-16)
        assert found.amplitude * math.sin(found.phase) == pytest.approx(expected[2 * n], abs=1e-16)


@pytest.mark.parametrize(
    ("points", "missing", "most"),
    [(72, 0, 35), (73, 0, 36), (360, 0, 179), (360, 89, 1), (360, 88, 2), (4, 0, 1), (5, 0, 2)],
)
def test_the_widest_gap_says_how_many_waves_a_trace_tells(points: int, missing: int, most: int) -> None:
    angle = 2 * np.pi * np.arange(points - missing) / points
    trace = Trace(angle + 0.1, np.zeros(points - missing))
    assert trace.widest_gap == pytest.approx(2 * np.pi * (missing + 1) / points)
    assert trace.most_waves == most


# ---------------------------------------------------------------- the table


def tables(**form: Any) -> dict[str, Any]:
    return {
        "closure": {"shape": "ball", "radius": "20 mm", "material": "steel"},
        "seat": {"shape": "cone", "angle": "45 deg", "material": "steel"},
        "interface": {"law": "smooth"},
        "load": {"fluid_pressure": "20 bar"},
        "form": form,
    }


def sealed(**form: Any) -> Case:
    return load_case(tables(**form))


def error_of(case: Case) -> FormError:
    assert case.form is not None
    return case.form.error(case.contact.angle, case.initial_contact_radius)


def message(**form: Any) -> str:
    with pytest.raises(InputError) as caught:
        sealed(**form)
    return str(caught.value)


OVAL = {"waves": 2, "amplitude": "1 um"}

WRONG = {
    "an unknown key": ({"sead": {}}, ["form.sead", "unknown key"]),
    "an unknown key of a wave": ({"seat": {"harmonics": [{**OVAL, "fase": "0 deg"}]}}, ["harmonics[1].fase"]),
    "no unit": (
        {"seat": {"harmonics": [{"waves": 2, "amplitude": 1e-6}]}},
        ["amplitude = 1e-06: has no unit"],
    ),
    "another unit": (
        {"seat": {"harmonics": [{"waves": 2, "amplitude": "1 bar"}]}},
        ["does not fit", "length"],
    ),
    "millimetres": ({"seat": {"harmonics": [{"waves": 2, "amplitude": "2 mm"}]}}, ["from 0 m to 1 mm"]),
    "no waves": (
        {"seat": {"harmonics": [OVAL, {**OVAL, "waves": 0}]}},
        ["harmonics[2].waves = 0", "from 1 to 500"],
    ),
    "half a wave": ({"seat": {"harmonics": [{**OVAL, "waves": 2.5}]}}, ["not a whole number"]),
    "a bare phase": ({"seat": {"harmonics": [{**OVAL, "phase": 0.5}]}}, ["phase = 0.5: has no unit"]),
    "no amplitude": ({"seat": {"harmonics": [{"waves": 2}]}}, ["harmonics[1].amplitude", "missing"]),
    "two sources": (
        {"seat": {"harmonics": [OVAL], "tolerance": "2 um"}},
        ["form.seat", "harmonics and tolerance both say what the deviations are; keep one"],
    ),
    "waves of no tolerance": (
        {"seat": {"harmonics": [OVAL], "tolerance_waves": [2, 5]}},
        ["tolerance_waves is only for a tolerance"],
    ),
    "waves the wrong way round": (
        {"seat": {"tolerance": "2 um", "tolerance_waves": [8, 5]}},
        ["tolerance_waves = [8, 5]: the fewest must come before the most"],
    ),
    "one wave without its list": (
        {"seat": {"harmonics": OVAL}},
        ["harmonics", "must be a list", "[[harmonics]]"],
    ),
    "a range in words": (
        {"seat": {"tolerance": "2 um", "tolerance_waves": "2 to 15"}},
        ["tolerance_waves", "must be a list"],
    ),
    "another direction": ({"seat": {"direction": "up"}}, ["form.seat.direction", '"radial"']),
    "a trace that is not there": (
        {"seat": {"trace": "nowhere.csv"}},
        ["form.seat.trace", "nowhere.csv", "cannot be read (no such file or directory)"],
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_is_wrong_names_key_and_remedy(name: str) -> None:
    form, parts = WRONG[name]
    found = message(**form)
    for part in parts:
        assert part in found, found


def test_a_case_file_with_lists_of_tables(tmp_path: Path) -> None:
    text = """
[closure]
shape = "ball"
radius = "20 mm"
material = "steel"
[seat]
shape = "cone"
angle = "45 deg"
material = "steel"
[interface]
law = "smooth"
[load]
fluid_pressure = "20 bar"
[form]
guide = "guided"
eccentricity = "2 um"
[form.seat]
direction = "normal"
[[form.seat.harmonics]]
waves = 2
amplitude = "1 um"
phase = "90 deg"
[[form.seat.harmonics]]
waves = 2
amplitude = "1 um"
phase = "-90 deg"
[[form.seat.harmonics]]
waves = 3
amplitude = "0.5 um"
[form.closure]
tolerance = "2 um"
tolerance_waves = [2, 6]
"""
    assert tomllib.loads(text)
    (tmp_path / "case.toml").write_text(text)
    form = error_of(load_case(tmp_path / "case.toml"))
    assert form.guided and form.highest == 6
    amplitudes = {one.waves: one.amplitude for one in form.waves}
    assert amplitudes[1] == pytest.approx(2e-6 * math.sin(ANGLE45))
    assert amplitudes[2] < 1e-20 and amplitudes[3] == pytest.approx(5e-7)
    assert form.tolerance == WaveTolerance(pytest.approx(1e-6 * math.sin(ANGLE45)), (2, 6))  # type: ignore[arg-type]


def test_tolerances_of_both_bodies_add_up() -> None:
    form = error_of(
        sealed(
            seat={"tolerance": "2 um", "tolerance_waves": [3, 5], "direction": "normal"},
            closure={"tolerance": "1 um", "tolerance_waves": [2, 4], "direction": "normal"},
        )
    )
    assert form.tolerance == WaveTolerance(1.5e-6, (2, 5)) and form.highest == 5


def test_a_trace_beside_the_case_file(tmp_path: Path) -> None:
    """The least-squares circle is removed, and its file is looked for beside the case."""
    phi = np.radians(np.arange(0, 360, 5))
    deviation = 14e-3 + 20e-6 * np.cos(phi) + 1e-6 * np.cos(2 * phi - 0.5)
    rows = "\n".join(f"{a:.9f};{1e3 * d:.12f}" for a, d in zip(phi, deviation, strict=True))
    (tmp_path / "trace.csv").write_text("angle [rad];radius [mm]\n" + rows)
    lines = ['form.seat.trace = "trace.csv"']
    for table, entries in tables().items():
        lines += [f"{table}.{key} = {value!r}" for key, value in entries.items()]
    (tmp_path / "case.toml").write_text("\n".join(lines).replace("'", '"'))
    case = load_case(tmp_path / "case.toml")
    (oval,) = error_of(case).felt_waves[:1]
    assert oval.waves == 2 and oval.amplitude == pytest.approx(1e-6 * math.sin(ANGLE45), rel=1e-6)
    assert max(one.amplitude for one in error_of(case).felt_waves[1:]) < 1e-13
    assert str(tmp_path / "trace.csv") in case.named_files
    few = case.replace({"form.seat.trace": {"file": str(tmp_path / "trace.csv"), "waves": 60}})
    assert few.form is not None and few.form.seat is not None and few.form.seat.trace is not None
    assert few.form.seat.trace.usable_waves == 35
    assert any("resolves no more than 35 waves per turn" in one for one in error_of(few).remarks)


def test_a_trace_of_roughness_says_so_and_one_with_a_hole_is_refused(tmp_path: Path) -> None:
    phi = np.arange(0, 360, 2.0)
    rough = 1e-2 * np.cos(np.radians(2 * phi)) + np.cos(np.radians(40 * phi))
    (tmp_path / "rough.csv").write_text(
        "angle [deg];deviation [um]\n" + "\n".join(f"{a};{d}" for a, d in zip(phi, rough, strict=True))
    )
    found = error_of(sealed(seat={"trace": str(tmp_path / "rough.csv")})).remarks
    assert len(found) == 1 and "waves beyond 15 per turn and roughness are larger (rms 0.71 um)" in found[0]
    half = phi[phi < 200]
    (tmp_path / "half.csv").write_text("angle [deg];deviation [um]\n" + "\n".join(f"{a};0.5" for a in half))
    assert "leaves 162 deg without a point; two waves per turn need" in message(
        seat={"trace": str(tmp_path / "half.csv")}
    )


def test_what_changes_nothing_is_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """`fem-seal check` says it; the result is none the worse for it."""
    free = sealed(eccentricity="2 um", tilt="0.01 deg").form
    assert free is not None
    said = free.without_effect(ANGLE45)
    assert len(said) == 2 and all('"guided" holds it' in str(problem) for problem in said)
    guided = sealed(eccentricity="2 um", guide="guided").form
    assert guided is not None and not guided.without_effect(ANGLE45)
    shifted = sealed(seat={"harmonics": [{**OVAL, "waves": 1}]}).form
    assert shifted is not None and "follows one wave per turn" in str(shifted.without_effect(ANGLE45)[0])
    flat = sealed(seat={"harmonics": [OVAL]}).form
    assert flat is not None and not flat.without_effect(ANGLE45)
    assert 'only a deviation "axial" changes the gap' in str(flat.without_effect(0.0)[0])
    assert not np.any(flat.error(0.0, 0.014).gap(TURN))
    lines = ['form.eccentricity = "2 um"']
    for table, entries in tables().items():
        lines += [f"{table}.{key} = {value!r}" for key, value in entries.items()]
    (tmp_path / "case.toml").write_text("\n".join(lines).replace("'", '"'))
    assert main(["check", str(tmp_path / "case.toml")]) == 0
    warned = " ".join(capsys.readouterr().err.split())
    assert "the face moves until this has no effect" in warned
    assert "the numbers below are for the round seal" in warned


# ---------------------------------------------------------------- keys into lists


@pytest.fixture
def case() -> Case:
    return sealed(seat={"harmonics": [OVAL, {"waves": 3, "amplitude": "0.5 um", "phase": "10 deg"}]})


def harmonics(case: Case) -> list[tuple[int, float]]:
    assert case.form is not None and case.form.seat is not None
    return [(one.waves, one.amplitude) for one in case.form.seat.harmonics]


def test_a_whole_list_in_si_numbers(case: Case) -> None:
    changed = case.replace({"form.seat.harmonics": [{"waves": 5, "amplitude": 3e-6, "phase": 0.5}]})
    assert harmonics(changed) == [(5, 3e-6)]
    assert changed.form is not None and changed.form.seat is not None
    assert changed.form.seat.harmonics[0].phase == pytest.approx(0.5)
    with pytest.raises(InputError, match=r"harmonics\[1\].amplitude = 3e-06: has no unit"):
        case.replace_written({"form.seat.harmonics": [{"waves": 5, "amplitude": 3e-6}]})


def test_an_entry_of_a_list(case: Case) -> None:
    assert harmonics(case.replace({"form.seat.harmonics.1.amplitude": "2 um"})) == [(2, 1e-6), (3, 2e-6)]
    assert harmonics(case.replace({"form.seat.harmonics.0.amplitude": 2e-6})) == [(2, 2e-6), (3, 5e-7)]
    both = {"form.seat.harmonics.0.waves": 4, "form.seat.harmonics.1.waves": 6}
    assert harmonics(case.replace(both)) == [(4, 1e-6), (6, 5e-7)]
    assert harmonics(case.replace({"form.seat.harmonics.0": None})) == [(3, 5e-7)]
    assert harmonics(case) == [(2, 1e-6), (3, 5e-7)]
    pressures = case.replace({"load.fluid_pressure": ["1 bar", "2 bar"]})
    assert pressures.replace({"load.fluid_pressure.1": 3e5}).load.fluid_pressure == (1e5, 3e5)


@pytest.mark.parametrize(
    ("key", "value", "said"),
    [
        ("form.seat.harmonics.2.amplitude", "1 um", "entries are named by their number: it has 0 to 1"),
        ("form.seat.harmonics.-1.amplitude", "1 um", "entries are named by their number"),
        (
            "form.seat.harmonics.first.amplitude",
            "1 um",
            "form.seat.harmonics.first: form.seat.harmonics is a list",
        ),
        ("form.closure.harmonics.0.amplitude", "1 um", "form.closure.harmonics is no list whose entries"),
        ("form.seat.harmonics.0.amplitude", "3 mm", 'harmonics[1].amplitude = "3 mm": out of range'),
        ("form.seat.harmonics.0.size", "1 um", "harmonics[1].size"),
        ("load.fluid_pressure.0", "1 bar", "load.fluid_pressure is no list whose entries could be changed"),
    ],
)
def test_an_entry_that_a_list_does_not_have(case: Case, key: str, value: str, said: str) -> None:
    with pytest.raises(InputError) as caught:
        case.replace({key: value})
    assert said in str(caught.value)


def test_a_study_varies_an_entry_of_a_list(case: Case) -> None:
    assert "form.seat.harmonics.1.amplitude" in list(entry_paths(case))
    assert entry_at(case, "form.seat.harmonics.1.phase").unit == "rad"
    study = Study(
        case,
        parameters={"form.seat.harmonics.0.amplitude": ["0.5 um", "2 um"]},
        responses=["peak_pressure_Pa"],
    )
    assert "2 designs over form.seat.harmonics.0.amplitude" in repr(study)
    with pytest.raises(InputError, match=r"do you mean form\.seat\.harmonics\.0\.amplitude"):
        entry_at(case, "form.seat.harmonics.7.amplitude")


def _lay_file(path: Path, wave: float, noise: float = 0.05e-6) -> Path:
    """A profile across the lay: a wave of 63 um and 0.7 um amplitude on a bent and inclined face, and roughness."""
    x = np.linspace(0, 1.2e-3, 1201)
    z = wave * np.cos(2 * np.pi * x / 63e-6 + 0.4) + 3e-3 * x + 2.0 * x**2
    z = z + noise * np.random.default_rng(1).standard_normal(len(x))
    rows = "\n".join(f"{1e3 * a:.6f},{1e6 * b:.6f}" for a, b in zip(x, z, strict=True))
    path.write_text(f"x [mm], z [um]\n{rows}\n")
    return path


def test_the_lay_is_taken_from_a_measured_profile(tmp_path: Path) -> None:
    """Pitch to a thousandth and depth to half a per cent: noise of 7 % of the amplitude, over 1201 points."""
    pitch, depth = read_lay(_lay_file(tmp_path / "lay.csv", 0.7e-6))
    assert pitch == pytest.approx(63e-6, rel=1e-3) and depth == pytest.approx(1.4e-6, rel=5e-3)
    form = Form(lay={"profile": str(tmp_path / "lay.csv")})
    (placed,) = form.error(math.pi / 4, 0.014).grooves
    assert isinstance(placed.groove, SpiralLay) and placed.groove.pitch == pitch and placed.angle is None


def test_a_profile_without_a_lay_is_refused(tmp_path: Path) -> None:
    with pytest.raises(TextTableError, match="shows no lay: its strongest wave"):
        read_lay(_lay_file(tmp_path / "rough.csv", 0.01e-6))
