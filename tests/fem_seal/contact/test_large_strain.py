"""Loads that turn the faces far: they are calculated, and what they are worth is said."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from judged_loads import judged, load
from sample_results import SMOOTH, ball, case, cone

import fem_seal
from fem_seal import Case
from fem_seal.answers.closed_forms import derive, strain_limit
from fem_seal.contact.solution import ContactSolution
from fem_seal.loads import LARGEST_TURNING, TURNED
from fem_seal.seal.evaluate import evaluate
from fem_seal.seal.problem import SealProblem
from fem_seal.validity.checks import load_validity

HARD = {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3}


def edge(half_width: float, law: dict[str, Any] | None = None, scale: float = 1.0, **tables: Any) -> Case:
    """A disc on a crest of 0.1 mm, pressed flat over `half_width` radii by Hertz's formula."""

    def mm(length: float) -> str:
        return f"{length * scale!r} mm"

    chosen = Case(
        closure={"shape": "disc", "radius": mm(1.5), "height": mm(0.8), "material": HARD},
        seat={
            "shape": "sharp-edge",
            "bore_radius": mm(1.0),
            "top_angle": "-30 deg",
            "edge_radius": mm(0.1),
            "material": HARD,
        },
        interface=law or {"law": "smooth"},
        load={"fluid_pressure": "1 mbar", "applied_force": "1 N"},
        **tables,
    )
    R = chosen.contact.relative_radius
    force = (
        math.pi
        * chosen.effective_modulus
        * half_width**2
        * R
        / 4
        * 2
        * math.pi
        * chosen.initial_contact_radius
    )
    return chosen.replace({"load.applied_force": float(force)})


def contact_of(chosen: Case) -> ContactSolution:
    return evaluate(SealProblem.of(chosen)).solved_loads.contacts[0]


@pytest.mark.parametrize("half_width", [0.01, 0.05])
def test_faces_turn_by_the_half_width_of_hertz_over_the_radius(half_width):
    # 1 %: elements at the edge of the contact, where the slope is largest
    assert contact_of(edge(half_width)).turning == pytest.approx(half_width, rel=1e-2)


def test_a_layer_that_spreads_the_pressure_turns_nothing():
    """Asperities with a decay length of half the radius: pressure far around the edge, and hardly any turning."""
    thick = contact_of(edge(0.05, {"law": "exponential", "u0": "50 um", "p_c": "5 GPa"}))
    assert 2 * thick.profile.std > 0.5e-4 and thick.turning < 0.02


@pytest.mark.parametrize(
    ("turning", "level"),
    [(0.99 * TURNED, None), (1.01 * TURNED, "doubtful"), (1.01 * LARGEST_TURNING, "outside the theory")],
)
def test_the_warning_knows_how_far(turning, level):
    found = [str(one.level) for one in judged("small strain", load(), load(turning=turning))]
    assert found == ([] if level is None else [level])


def test_a_load_beyond_the_old_limit_has_a_result_and_a_reason(tmp_path):
    """An edge pressed flat over a sixth of its radius: a tenth was refused once."""
    chosen = edge(0.16)
    result = fem_seal.run(chosen)
    (row,) = result.table.itertuples()
    assert row.validity == "doubtful" and row.peak_pressure_Pa > 0
    assert "too far for small-strain theory" in row.validity_reasons
    assert any("faces turned against each other by" in text for text in result.warnings)
    said = str(strain_limit(derive(chosen)))
    assert said.startswith("from 0.001 bar on") and f"doubtful above {TURNED:g}" in said
    assert strain_limit(derive(edge(0.06))) == ""


def test_far_outside_it_is_called_so():
    chosen = edge(0.4)
    problem = SealProblem.of(chosen)
    solved = evaluate(problem).solved_loads
    from fem_seal.seal.load_result import LoadResult

    found = load_validity(problem, LoadResult(*chosen.load.points[0], solved.contacts[0]))
    assert found.outside_theory and any("small-strain" in reason for reason in found.reasons)


@pytest.mark.slow
def test_nothing_jumps_where_the_old_limit_was():
    """a/R of 0.1, and of the marks: peak and width over Hertz's go on smoothly, and so does the turning."""
    for limit in (0.1, TURNED, LARGEST_TURNING):
        below, above = (contact_of(edge(limit * share)) for share in (0.999, 1.001))
        for name, power in (("peak_pressure", 1), ("std", 1)):
            ratio = getattr(above.profile, name) / getattr(below.profile, name)
            # 0.1 %: the meshes of both loads are their own
            assert ratio == pytest.approx((1.001 / 0.999) ** power, rel=1e-3)
        assert above.turning / below.turning == pytest.approx(1.001 / 0.999, rel=5e-3)


@pytest.mark.parametrize(("half_width", "scale"), [(0.05, 0.1), (0.2, 100.0), (0.5, 10.0)])
def test_a_seal_ten_times_as_large_has_the_same_pressures(half_width, scale):
    """All lengths times 10, the force times 100: powers of ten, because element sizes are rounded to two digits."""
    one, other = (contact_of(edge(half_width, scale=s)) for s in (1.0, scale))
    # round-off of coordinates, through a mesh generator
    assert other.profile.peak_pressure == pytest.approx(one.profile.peak_pressure, rel=1e-5)
    assert other.profile.std == pytest.approx(scale * one.profile.std, rel=1e-5)
    assert other.turning == pytest.approx(one.turning, rel=1e-4)


@pytest.mark.parametrize("half_width", [0.2, 0.5])
def test_the_mesh_of_such_a_load_has_converged(half_width):
    law = {"law": "exponential", "u0": "0.1 um", "p_c": "5 GPa"}
    chosen = edge(half_width, law)
    coarse = contact_of(chosen)
    size = float(np.diff(coarse.model.line.vertices).min())
    fine = contact_of(chosen.replace({"mesh.contact_size": size / 2}))
    assert coarse.profile.peak_pressure == pytest.approx(fine.profile.peak_pressure, rel=2e-3)
    assert coarse.profile.std == pytest.approx(fine.profile.std, rel=2e-3)


def test_a_face_that_yields_all_over_carries_no_more():
    soft = {**HARD, "stress_strain": {"plastic_strain": [0, 0.1], "stress": ["0.3 GPa", "0.4 GPa"]}}
    chosen = case(closure=ball(HARD), seat=cone(soft), **{**SMOOTH, "interface": {"law": "smooth"}})
    start, end = chosen.contact.reach
    # Prandtl: 2.97 flow stresses over all of the face, r0 cos(theta) = R/2
    most = 2.97 * 0.4e9 * (end - start) * 2 * math.pi * 0.02 / 2
    with pytest.raises(fem_seal.InputError, match="more than the body that yields can carry"):
        chosen.replace({"load.applied_force": 1.01 * most})
