"""Results of small cases, solved once per test process and shared by the tests of all result files."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any
from unittest.mock import Mock

import pytest

import fem_seal
from fem_seal.answers.accuracy import NOT_ESTIMATED
from fem_seal.answers.answer import Request
from fem_seal.answers.verdict import VERDICT
from fem_seal.case.case import Case
from fem_seal.output.answer_output import Tile
from fem_seal.output.answer_outputs import pages_of
from fem_seal.result import SealResult
from leak import Reading

STEEL = {
    "name": "steel <1.4122>",
    "youngs_modulus": "210 GPa",
    "poissons_ratio": 0.3,
    "hardness": "3.5 GPa",
    "yield_stress": "1 GPa",
}
SPECTRUM = {
    "kind": "self-affine",
    "rms_height": "1.9 um",
    "hurst": 0.6,
    "q_low": "1e3 1/m",
    "q_rolloff": "3.7268e4 1/m",
    "q_high": "3.14159e6 1/m",
}
# Hard contact: no roughness, no fluid, no leak.
SMOOTH: dict[str, Any] = {
    "roughness": None,
    "fluid": None,
    "interface": {"law": "smooth"},
    "leak": {"plasticity": False},
}


def with_capped(load: Any, leak: Any) -> Any:
    """A load whose leak is given if its yielding asperities change only where they touch."""
    return load.with_scenarios({Reading.CAPPED: load.scenarios[Reading.CAPPED].with_values(leak=leak)})


def ball(material: object = "steel", radius: str = "20 mm") -> dict[str, Any]:
    """The table of a ball."""
    return {"shape": "ball", "radius": radius, "material": material}


def cone(material: object = STEEL, angle: str = "45 deg", **entries: str) -> dict[str, Any]:
    """The table of a conical seat."""
    return {"shape": "cone", "angle": angle, "material": material, **entries}


def case(**tables: Any) -> Case:
    """A ball of 20 mm on a cone of 45 deg with some tables changed; None leaves one out.

    By the paper's theory unless said otherwise: its two readings of yielding asperities fill more cells and sentences.
    """
    standard: dict[str, Any] = {
        "title": 'Ball & cone <script>alert("x")</script>',
        "closure": ball(),
        "seat": cone(),
        "roughness": {"spectrum": SPECTRUM},
        "fluid": {"name": "water"},
        "load": {"fluid_pressure": ["2 bar", "5 bar", "20 bar"]},
        **tables,
        "leak": {"theory": "paper", **tables.get("leak", {})},
    }
    return Case(**{name: table for name, table in standard.items() if table is not None})


def smooth_case(**tables: Any) -> Case:
    """Hard contact of the bodies alone."""
    return case(**SMOOTH, **tables)


def run_loads(of: Case, *, interval: bool = False) -> SealResult:
    """A run that ends with the numbers of its loads, and with their interval, for tests that look at no others.

    Left out is what is solved besides: on other elements, with other bodies, another law, another form, samples.
    Without an estimated error no load is valid.
    """
    replacements = {
        "answers.accuracy.on_coarser_mesh": None,
        "answers.accuracy.discretisation_error": NOT_ESTIMATED,
        "answers.accuracy.far_field": (),
        "answers.form.form_answers": None,
        **({} if interval else {"answers.uncertainty.leak_interval": None}),
    }
    with pytest.MonkeyPatch.context() as patch:
        for name, value in replacements.items():
            patch.setattr(f"fem_seal.{name}", lambda *asked, found=value, **told: found)
        return fem_seal.run(of)


@cache
def rough_result() -> SealResult:
    """Three loads with yielding asperities and water."""
    return fem_seal.run(case(), full=True)


@cache
def gasket_result() -> SealResult:
    """A copper ring between flanges, pressed and partly released; it yields."""
    curve = {"plastic_strain": [0, 0.02, 0.1], "stress": ["60 MPa", "120 MPa", "220 MPa"]}
    copper = {"youngs_modulus": "120 GPa", "poissons_ratio": 0.34, "stress_strain": curve}
    ring = {"shape": "ring", "mean_diameter": "40 mm", "section_diameter": "4 mm", "material": copper}
    load = {"fluid_pressure": "1 bar", "applied_force": ["2 kN", "1 kN"], "pressure_side": "inner"}
    flange = {"shape": "disc", "diameter": "60 mm", "material": "steel"}
    of = smooth_case(closure=flange, seat=None, gasket=ring, load=load, mesh={"contact_size": "7 um"})
    return run_loads(of)


def with_new_verdicts(result: SealResult) -> SealResult:
    """A result whose case or loads were changed, judged as a run does."""
    verdict = VERDICT.compute(result, Request(Mock(), Mock(), answers=dict(result.answers)))
    return replace(
        result.with_answers(verdict=verdict),
        loads=tuple(VERDICT.of_load(load, n, verdict) for n, load in enumerate(result.loads)),
    )  # type: ignore[arg-type]


def single_case() -> Case:
    """One load with elastic asperities, high pressure in the bore."""
    return case(
        load={"fluid_pressure": "20 bar", "pressure_side": "inner", "applied_force": "5 kN"},
        leak={"plasticity": False},
    )


@cache
def single_result() -> SealResult:
    """Its result."""
    return fem_seal.run(single_case())


@cache
def smooth_result() -> SealResult:
    """Two loads of hard contact."""
    return fem_seal.run(smooth_case(load={"fluid_pressure": ["20 bar", "50 bar"]}))


def tiles_of(result: SealResult) -> dict[str, Tile]:
    """All numbers at the top of its pages, by name."""
    return {tile.name: tile for page in pages_of(result) for tile in page.tiles}
