"""A moment and a side force on an axisymmetric seal, through whole cases."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from contact_models import out_of_plane
from places import EXAMPLES
from sample_results import run_loads
from scipy.optimize import brentq
from scipy.special import i0, i1

from fem_seal import Case, InputError, load_case
from fem_seal.cli.app import main
from fem_seal.contact.around import Stiffening
from fem_seal.seal.evaluate import evaluate
from fem_seal.seal.problem import SealProblem

U0, RADIUS = 50e-6, 0.014
STIFF = {"youngs_modulus": "1000 GPa", "poissons_ratio": 0.3}


def case_of(**tables: Any) -> Case:
    """A stiff ring on a soft layer, pressed with 200 N."""
    return Case(
        **{
            "closure": {
                "shape": "torus",
                "centre_radius": "14 mm",
                "radius": "3 mm",
                "material": STIFF,
            },
            "seat": {"shape": "flat", "bore_radius": "8 mm", "material": STIFF},
            "interface": {"law": "exponential", "u0": "50 um", "p_c": "10 MPa"},
            "load": {"fluid_pressure": "0.01 Pa", "applied_force": "200 N", "bending_moment": "1 N m"},
            **tables,
        }
    )


def around(case: Case) -> Any:
    found = evaluate(SealProblem.of(case)).solved_loads
    assert not found.failures, found.failures
    return found.circumferences[0]


@pytest.mark.parametrize("moment", [0.3, 1.0, 2.4])
def test_a_rigid_ring_on_a_soft_layer(moment: float) -> None:
    """f = f_N exp(k cos phi)/I0(k), I1(k)/I0(k) = M/(F r), tilt k u0/r; bodies give way by 1e-3 of the layer."""
    load = {"fluid_pressure": "0.01 Pa", "applied_force": "200 N", "bending_moment": f"{moment} N m"}
    found = around(case_of(load=load))
    share = moment / (200 * found.local.mean.model.initial_contact_radius)
    k = brentq(lambda k: i1(k) / i0(k) - share, 0, 50)
    np.testing.assert_allclose(found.over_mean, np.exp(k * np.cos(found.angle)) / i0(k), rtol=2e-3)
    assert found.tilt_angle == pytest.approx(k * U0 / RADIUS, rel=5e-4)
    # the gap opens opposite to where the moment presses
    assert np.argmax(found.moved_gap) == len(found.angle) // 2


def test_a_slender_flange_bends_out_of_its_plane_as_thin_rings_do() -> None:
    """Two and three waves on a flange of 4 mm by 4 mm around a circle of 60 mm (J = 0.1406 a^4): to 2 %.

    After lift-off these are the waves that a moment puts on it beside the first.
    """
    side, bore, steel = (
        4e-3,
        {"bore_radius": "58 mm", "outer_radius": "62 mm"},
        STIFF | {"youngs_modulus": "200 GPa"},
    )
    flange = {"shape": "flat", **bore, "height": "4 mm", "edge_radius": "0.02 mm", "material": steel}
    gasket = {"shape": "ring", "mean_diameter": "120 mm", "section_diameter": "6 mm", "material": STIFF}
    contact = evaluate(SealProblem.of(case_of(closure=flange, seat=None, gasket=gasket))).loads[-1].contact
    stiffening = Stiffening(contact.model, contact.pressure, 3)
    for n in (2, 3):
        thin = 0.06**4 / (200e9 * side**4 / 12) * out_of_plane(n, 2 * 1.3 / 12 / 0.1406)
        assert stiffening(n) == pytest.approx(thin, rel=0.02), stiffening(n) / thin


def test_the_moment_is_in_balance_beside_an_oval_seat() -> None:
    """Also of a force at a height; the oval seat is pressed at two sides, of which the moment relieves one."""
    load = {"fluid_pressure": "0.01 Pa", "applied_force": "200 N", "bending_moment": "0.4 N m"}
    load["side_force"] = {"force": "20 N", "height": "30 mm"}
    oval = {"seat": {"direction": "axial", "harmonics": [{"waves": 2, "amplitude": "10 um"}]}}
    found = around(case_of(load=load, form=oval))
    radius, f = found.local.mean.model.initial_contact_radius, found.line_load
    moment = 2 * math.pi * radius**2 * np.mean(f * np.cos(found.angle))
    assert moment == pytest.approx(1.0, rel=1e-7)
    assert 2 * math.pi * radius * f.mean() == pytest.approx(200, rel=1e-4)
    assert abs(np.mean(f * np.sin(found.angle))) < 1e-7 * f.mean()
    first, second = f[0], f[len(f) // 2]
    assert first > 2 * second and abs(np.fft.rfft(f)[2]) > 0.05 * f.sum()


@pytest.mark.parametrize("guide", ["free", "guided"])
def test_a_guide_leaves_no_moment_to_the_contact(guide: str) -> None:
    why = "carries no moment" if guide == "free" else "the guide and not the contact carries the moment"
    with pytest.raises(InputError, match=f'guide = "{guide}": .*{why} of .load.; leave guide out'):
        case_of(form={"guide": guide})


def test_what_cannot_carry_a_moment_says_so() -> None:
    yields = {**STIFF, "stress_strain": {"plastic_strain": [0, 0.1], "stress": ["300 MPa", "400 MPa"]}}
    with pytest.raises(
        InputError, match=r"load.bending_moment: the line load around the axis is calculated for elastic"
    ):
        case_of(closure={"shape": "torus", "centre_radius": "14 mm", "radius": "3 mm", "material": yields})
    load = {"fluid_pressure": "0.01 Pa", "applied_force": "200 N", "bending_moment": "3 N m"}
    tipped = evaluate_failure(case_of(load=load))
    assert "a moment of 3 N m tips the seal over, whose force of 200 N carries less than 2.8 N m" in tipped


def evaluate_failure(case: Case) -> str:
    with pytest.raises(Exception, match="tips") as caught:
        evaluate(SealProblem.of(case))
    return str(caught.value)


@pytest.mark.slow
def test_the_example_says_what_the_moment_does(capsys: pytest.CaptureFixture[str]) -> None:
    """Bolts were tightened before the pipe bends: most leaks where they are relieved."""
    case = load_case(EXAMPLES / "bent_flange.toml")
    result = run_loads(case)
    load = result.loads[0]
    assert load.leak is not None and load.leak_round is not None and load.around is not None
    assert 1.05 < load.leak.leak_rate / load.leak_round.leak_rate < 2
    assert load.around.before is not None and np.ptp(load.around.before.line_load) == 0
    assert np.argmax(load.around.leak_rate) == len(load.around.angle) // 2
    assert main(["check", str(EXAMPLES / "bent_flange.toml")]) == 0
    assert "load.bending_moment: the numbers below are for the round seal without a moment" in " ".join(
        capsys.readouterr().err.split()
    )
