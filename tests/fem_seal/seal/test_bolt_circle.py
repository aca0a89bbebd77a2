"""Bolts one by one on a flange: their forces around the axis, a ring in closed form, and whole cases."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from contact_models import out_of_plane
from places import EXAMPLES
from sample_results import run_loads
from scipy.optimize import root

from fem_seal import Case, InputError, load_case
from fem_seal.bolts import BoltCircle
from fem_seal.cli.app import main
from fem_seal.output.answers.form import _around
from fem_seal.seal.evaluate import evaluate
from fem_seal.seal.problem import SealProblem
from fem_seal.units import Display

STIFF = {"youngs_modulus": "1000 GPa", "poissons_ratio": 0.3}
# 800 N in all of four
BOLTS = {
    "number": 4,
    "stress_area": "20 mm^2",
    "length": "20 mm",
    "youngs_modulus": "200 GPa",
    "preload": "200 N",
}
DISC = {"shape": "disc", "diameter": "80 mm", "height": "25 mm", "material": STIFF}
RING = {"shape": "ring", "mean_diameter": "60 mm", "section_diameter": "6 mm", "material": STIFF}


def case_of(bolts: dict[str, Any], **tables: Any) -> Case:
    """A thick stiff disc on a ring with a soft layer, under bolts on a circle of 70 mm unless given."""
    return Case(
        **{
            "closure": DISC,
            "gasket": RING,
            "interface": {"law": "exponential", "u0": "50 um", "p_c": "100 MPa"},
            "load": {"fluid_pressure": "0.01 Pa"},
            "bolts": {**BOLTS, "circle_diameter": "70 mm", **bolts},
            **tables,
        }
    )


def around(case: Case) -> Any:
    found = evaluate(SealProblem.of(case)).solved_loads
    assert not found.failures, found.failures
    return found.circumferences[0]


def circle(*tightness: float, **changes: Any) -> BoltCircle:
    angles = tuple(2 * math.pi * n / len(tightness) for n in range(len(tightness)))
    return replace(BoltCircle(0.03, 0.012, angles, tightness, 1e3), **changes)


# ---------------------------------------------------------------- forces around the axis


@pytest.mark.parametrize("n", [1, 3, 8, 20])
def test_waves_of_round_heads(n: int) -> None:
    """Against the sum over narrow strips of each head, as long as they are wide across."""
    bolts, strips = circle(1.0, 0.5, 0.0, 1.0, 1.0), 20_000
    across = -1.0 + (np.arange(strips) + 0.5) * 2.0 / strips
    length = np.sqrt(1.0 - across**2)
    turned = np.array(bolts.angles)[:, None] + across * bolts.head / (2 * bolts.radius)
    under_head = np.exp(-1j * n * turned) @ (length / length.sum())
    expected = 2.0 * bolts.force * under_head @ np.array(bolts.tightness) / sum(bolts.tightness)
    assert bolts.wave(n) == pytest.approx(expected, rel=1e-5)


@pytest.mark.parametrize(
    ("tightness", "period"),
    [((1, 1, 1, 1, 1, 1), 6), ((1, 0.5) * 3, 3), ((1, 1, 0.2) * 2, 2), ((1, 1, 0, 1), 1), ((0, 1, 0, 1), 2)],
)
def test_how_often_bolts_repeat_themselves(tightness: tuple[float, ...], period: int) -> None:
    turned = tuple(angle + 0.3 for angle in circle(*tightness).angles)
    assert circle(*tightness).period == circle(*tightness, angles=turned).period == period


def test_moment_of_a_loose_bolt() -> None:
    """Three bolts of 1 kN/3 at 0, 90 and 270 degrees: 1/3 of the force stands at 0."""
    bolts = circle(1.0, 1.0, 0.0, 1.0)
    assert bolts.moment == pytest.approx(0.03 * 1e3 / 3)
    assert bolts.loosest == ((3, math.pi),)
    assert circle(1.0, 1.0, 1.0).moment == 0 and circle(1.0, 1.0, 1.0).loosest == ()


# ---------------------------------------------------------------- line load


@pytest.mark.parametrize(("u0", "least"), [(50e-6, 0.02), (10e-6, 1e-3)])
def test_a_slender_flange_against_a_ring_on_a_layer(u0: float, least: float) -> None:
    """Four bolts, one loose, on a flange of 4 mm by 4 mm around a circle of 120 mm, all around and nearly lifted off.

    The thin ring out of its plane (w_n = R^4/(E I) out_of_plane(n) (bolts_n - f_n)/R per length) on a layer
    u0 ln f = w + rigid motion, both in harmonics, solved at once.
    """
    side, steel = 4e-3, STIFF | {"youngs_modulus": "200 GPa"}
    flange = {"shape": "flat", "bore_radius": "58 mm", "outer_radius": "62 mm", "height": "4 mm"}
    found = around(
        case_of(
            {"tightness": [1, 1, 0, 1], "circle_diameter": "120 mm"},
            closure={**flange, "edge_radius": "0.02 mm", "material": steel},
            gasket={**RING, "mean_diameter": "120 mm"},
            interface={"law": "exponential", "u0": f"{u0} m", "p_c": "100 MPa"},
        )
    )
    size, radius = 128, 0.06
    angle = 2 * math.pi * np.arange(size) / size
    bolts = np.array([found.form.bolts.wave(n) for n in range(1, 33)]) / (2 * math.pi * radius)
    mean = found.line_load.mean()
    compliance = np.zeros(size // 2 + 1)
    waves = np.arange(2, size // 2 + 1)
    compliance[2:] = radius**4 / (200e9 * side**4 / 12) * out_of_plane(waves, 2 * 1.3 / 12 / 0.1406)

    def excess(unknown: np.ndarray) -> np.ndarray:
        log_f, motion = unknown[:size], unknown[size:]
        modes = np.fft.rfft(mean * np.exp(log_f))
        pressing = np.zeros_like(modes)
        pressing[1:33] = 0.5 * size * bolts
        # of a load on the ring beside the layer's
        moved = np.fft.irfft(compliance * (pressing - modes), size)
        rigid = motion[0] + motion[1] * np.cos(angle) + motion[2] * np.sin(angle)
        first = (modes[1] - pressing[1]) / size
        resultants = np.array([modes[0].real / size - mean, first.real, first.imag])
        return np.append(log_f - rigid - moved / u0, resultants / mean)

    solved = root(excess, np.zeros(size + 3))
    assert solved.success, solved.message
    expected = np.exp(solved.x[:size])
    ours = np.interp(angle, found.angle, found.over_mean)
    assert expected.max() > 1.3 and expected.min() < least
    # of the largest: what thin rings leave of the flange's compliance, as in test_moment
    np.testing.assert_allclose(ours, expected, atol=0.02 * expected.max())


def test_many_bolts_on_a_thick_disc_press_evenly() -> None:
    """40 bolts: their waves die out in the disc, and the line load is that of bolts without a circle to 1e-6."""
    found = around(case_of({"number": 40, "preload": "20 N"}))
    even = evaluate(SealProblem.of(case_of({"number": 40, "preload": "20 N", "circle_diameter": None})))
    assert even.problem.form is None
    np.testing.assert_allclose(found.line_load, even.loads[0].line_load, rtol=1e-6)


def test_a_stiff_disc_feels_the_moment_of_its_bolts_alone() -> None:
    """The line load of `bending_moment`, turned to where the bolts press; waves of the disc are 1e-3 of the mean."""
    angles = ["45 deg", "135 deg", "225 deg", "315 deg"]
    found = around(case_of({"tightness": [1, 1, 0.5, 1], "angles": angles}))
    moment = 0.035 * 800 * 3.5 / 4 * 0.5 / 3.5
    bent = case_of({"preload": "175 N", "circle_diameter": None}, load={"bending_moment": f"{moment} N m"})
    turned = np.roll(around(bent).line_load, len(found.angle) * 45 // 360)
    np.testing.assert_allclose(found.line_load, turned, atol=2e-3 * turned.mean())


def test_moments_of_load_and_bolts_are_carried_together() -> None:
    """Also beside an oval ring; the line load has both, and the tightening that of the bolts alone."""
    load = {"fluid_pressure": "10 bar", "pressure_side": "inner", "bending_moment": "3 N m"}
    form = {"closure": {"direction": "axial", "harmonics": [{"waves": 2, "amplitude": "5 um"}]}}
    bolts = {"preload": "2 kN", "tightness": [1, 1, 1, 0.6]}
    found = around(case_of(bolts, load=load, form=form))
    radius, share = found.local.mean.model.initial_contact_radius, 0.4 / 3.6

    def moments(load: Any) -> np.ndarray:
        arms = np.array([np.cos(load.angle), np.sin(load.angle)])
        return 2 * math.pi * radius**2 * np.mean(load.line_load * arms, axis=1)

    assert found.form.bolts.force != pytest.approx(7.2e3, rel=1e-4)  # the fluid has changed it
    np.testing.assert_allclose(moments(found), [3.0, 0.035 * share * found.form.bolts.force], atol=1e-4)
    np.testing.assert_allclose(moments(found.before), [0.0, 0.035 * share * 7.2e3], atol=1e-4)


def test_the_report_names_the_loosest_bolts() -> None:
    result = run_loads(case_of({"tightness": [1, 0.5, 0.5, 1]}))
    moment, line_load, bolts, *_ = _around(result, Display())
    # 200 N at 0 and 270 degrees, 100 N opposite to each
    assert moment.startswith(f"The bolts' moment of {0.035 * math.hypot(100, 100):.3g} N m, ")
    assert "at 135°" in line_load
    assert bolts.startswith(
        "The loosest bolts, number 2 at 90° and number 3 at 180°, have 50 % of the preload"
    )
    even = _around(run_loads(case_of({})), Display())
    assert not any("moment" in sentence or "loosest" in sentence for sentence in even)


@pytest.mark.slow
def test_the_example_leaks_at_its_loose_bolt(capsys: pytest.CaptureFixture[str]) -> None:
    case = load_case(EXAMPLES / "loose_bolt.toml")
    result = run_loads(case)
    load = result.loads[0]
    assert load.leak is not None and load.leak_round is not None and load.around is not None
    assert 1.3 < load.leak.leak_rate / load.leak_round.leak_rate < 3
    assert math.degrees(load.around.angle[np.argmax(load.around.leak_rate)]) == pytest.approx(135, abs=1)
    assert load.around.before is not None and np.ptp(load.around.before.line_load) > 0
    assert main(["check", str(EXAMPLES / "loose_bolt.toml")]) == 0
    said = " ".join(capsys.readouterr().err.split())
    assert "bolts.circle_diameter: the numbers below are for the round seal under even bolts" in said


# ---------------------------------------------------------------- what is wrong


@pytest.mark.parametrize(
    ("bolts", "why"),
    [
        ({"number": 1}, "has circle_diameter, but one bolt alone tips the seal over"),
        ({"tightness": [1, 1, 1]}, "has 3 entries in tightness, but number = 4; give one for each bolt"),
        ({"angles": ["0 deg", "90 deg"]}, "has 2 entries in angles, but number = 4"),
        ({"tightness": [1, 1, 1, -0.1]}, "tightness.*out of range; write a number from 0 to 10"),
        ({"tightness": [0, 0, 0, 0]}, "has bolts that are all loose"),
        ({"tightness": [0.1, 1, 1, 1], "circle_diameter": None}, "has tightness, but no circle_diameter"),
        ({"tightness": [1, 0, 0, 0]}, "bolts: tip the seal over: their force stands 35 mm beside the axis"),
        ({"circle_diameter": "90 mm"}, "the circle of 90 mm does not lie on the top of the flange.*to 80 mm"),
    ],
)
def test_what_bolts_cannot_do(bolts: dict[str, Any], why: str) -> None:
    with pytest.raises(InputError, match=why):
        case_of(bolts)


def test_a_guide_and_bodies_that_yield_are_refused() -> None:
    with pytest.raises(InputError, match=r"the guide and not the contact carries the moment of .bolts."):
        case_of({"tightness": [1, 1, 0, 1]}, form={"guide": "guided"})
    yields = {**STIFF, "stress_strain": {"plastic_strain": [0, 0.1], "stress": ["300 MPa", "400 MPa"]}}
    with pytest.raises(InputError, match=r"bolts.circle_diameter: .*calculated for elastic bodies"):
        case_of({}, gasket={**RING, "material": yields})
