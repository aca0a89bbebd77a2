"""What is told of a gasket that flows in bulk, whose asperities sink with it."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

import fem_seal
from fem_seal.output.answer_outputs import pages_of
from fem_seal.output.pictures.surface import separation_picture, surface_picture
from fem_seal.seal.problem import SealProblem
from fem_seal.validity.materials import hardness_cautions

OUTLINE = [(25, 0), (30, 0), (30, 3), (25, 3), (25, 0)]
ALUMINIUM = {
    "name": "A1050",
    "youngs_modulus": "70 GPa",
    "poissons_ratio": 0.33,
    "hardness": "0.3 GPa",
    "stress_strain": {"plastic_strain": [0, 0.05, 0.2], "stress": ["90 MPa", "105 MPa", "115 MPa"]},
}


def flat_gasket(force: str, **material: object) -> fem_seal.Case:
    """A flat ring of aluminium between steel faces, of which nothing but the asperities is rough."""
    tables: dict[str, Any] = {
        "title": "flat gasket",
        "closure": {"shape": "disc", "diameter": "90 mm", "material": "steel 1.4122"},
        "gasket": {
            "shape": "profile",
            "outline": [{"to": [f"{r} mm", f"{z} mm"]} for r, z in OUTLINE],
            "material": ALUMINIUM | material,
        },
        "roughness": {
            "spectrum": {
                "kind": "self-affine",
                "rms_height": "0.1 um",
                "hurst": 0.8,
                "q_low": "2e4 1/m",
                "q_rolloff": "1e5 1/m",
                "q_high": "4e6 1/m",
            }
        },
        "fluid": {"name": "helium", "outlet_pressure": "0 Pa"},
        "load": {"fluid_pressure": "1 bar", "applied_force": force},
    }
    return fem_seal.Case(**tables)


@cache
def pressed(force: str) -> fem_seal.SealResult:
    return fem_seal.run(flat_gasket(force), sensitivities=False)


def reasons(force: str) -> list[str]:
    return [
        sentence
        for page in pages_of(pressed(force))
        for sentence in page.why
        if "sink" in sentence or "flatten" in sentence
    ]


def test_the_report_says_that_the_gasket_flows_and_what_it_changes() -> None:
    result = pressed("78 kN")
    (load,), (said,) = result.loads, reasons("78 kN")
    assert load.rough is not None and load.leak is not None and result.surface is not None
    at_rest = load.rough.leak(load.whole_profile.without_strain, load.fluid_pressure)
    assert at_rest is not None
    factor = at_rest.leak_rate / load.leak.leak_rate
    told = float(said.split("and ")[1].split(" times less")[0])
    assert factor > 1.5 and told == pytest.approx(factor, rel=0.15)
    strained = load.tightest.surface_at_peak(result.surface)
    area, rests = strained.contact_area(load.peak_pressure), result.surface.contact_area(load.peak_pressure)
    assert area > 1.02 * rests and said.startswith("The gasket flows: asperities flatten to")
    assert float(said.split("flatten to ")[1].split(" %")[0]) == pytest.approx(100.0 * area, rel=0.02)


def test_asperities_that_sink_bring_the_faces_nearer() -> None:
    """The mean gap is that of the law under the pressure at rest that lets as much through; pressures stay."""
    (load,), law = pressed("78 kN").loads, SealProblem.of(flat_gasket("78 kN")).law
    contact, surface = load.contact, pressed("78 kN").surface
    pressed_hard = contact.pressure > 0.5 * contact.pressure.max()
    rest = surface.pressure_at_rest(contact.pressure, *contact.strain.T)[pressed_hard]
    gap = load.whole_profile.gap[pressed_hard]
    assert gap == pytest.approx(law.gap(np.log(rest)), rel=1e-6)
    assert (gap < 0.8 * contact.gap[pressed_hard]).all()


def test_nothing_is_said_where_the_strain_changes_little() -> None:
    assert not reasons("40 kN")


def test_sealed_is_judged_by_the_pressure_that_acts() -> None:
    """The contact pressure is below that at which the face over unstrained metal seals."""
    (load,) = pressed("86 kN").loads
    assert load.leak is not None and load.leak.leak_rate == 0.0
    (sealed,) = [finding for finding in load.validity.cautions if finding.entry == "sealed"]
    assert load.peak_pressure < pressed("86 kN").surface.sealing_pressure
    assert "over strained metal as tight as" in str(sealed)
    assert "and nothing leaks (over unstrained metal" in reasons("86 kN")[0]


def test_the_pictures_show_the_area_over_strained_metal() -> None:
    result = pressed("86 kN")
    separation, surface = separation_picture(result), surface_picture(result, result.highest)
    assert separation is not None and "or lie over strained metal" in separation.caption
    assert surface is not None


@pytest.mark.parametrize(("hardness", "asked"), [("0.3 GPa", False), ("0.7 GPa", True), ("0.14 GPa", True)])
def test_a_hardness_that_does_not_fit_to_the_curve_is_asked_for(hardness: str, asked: bool) -> None:
    found = [str(one) for one in hardness_cautions(SealProblem.of(flat_gasket("40 kN", hardness=hardness)))]
    assert bool(found) == asked
    if asked:
        # 2.9 times 107 MPa at 8 %
        assert "310 MPa by its stress_strain curve" in found[0]
        assert ("machining" in found[0]) == (hardness == "0.7 GPa")
