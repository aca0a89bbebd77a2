"""Dry contact, without fluid pressure, and bodies whose base is held radially."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import pyvista

import fem_seal
from fem_seal import Case, InputError, run
from fem_seal.bodies.elasticity import boundary_dofs
from fem_seal.contact.model import _is_same_body
from fem_seal.seal.evaluate import evaluate
from fem_seal.seal.load_result import load_name
from fem_seal.seal.problem import SealProblem

E, NU = 200e9, 0.3
MATERIAL = {"youngs_modulus": "200 GPa", "poissons_ratio": NU, "hardness": "2 GPa"}


def case_of(**tables: Any) -> Case:
    """A ball that is pressed into a cone by 500 N."""
    return Case(
        **{
            "closure": {"shape": "ball", "radius": "20 mm", "material": MATERIAL},
            "seat": {"shape": "cone", "angle": "45 deg", "material": MATERIAL},
            "interface": {"law": "exponential", "u0": "0.5 um", "p_c": "5 GPa"},
            "load": {"applied_force": "500 N"},
            **tables,
        }
    )


def contact_of(case: Case) -> Any:
    return evaluate(SealProblem.of(case)).loads[-1].contact


def layer(base: str) -> Any:
    """Retreat of the middle of a thin layer under an even pressure over many thicknesses, over p h [1/Pa]."""
    closure = {"shape": "torus", "centre_radius": "20 mm", "radius": "10 mm", "material": MATERIAL}
    size = {"bore_radius": "10 mm", "outer_radius": "30 mm", "height": "0.08 mm", "edge_radius": "0.02 mm"}
    seat = {"shape": "flat", **size, "base": base, "material": MATERIAL}
    model = contact_of(case_of(closure=closure, seat=seat)).model
    fem = model.seat.fem
    forces = fem.trace.T @ (model.line.area_weight * 1e6)
    retreat = model.seat.compliance @ forces
    return float(np.interp(0.0, fem.contact_x, retreat)) / (1e6 * 0.08e-3)


def test_a_thin_layer_on_a_held_base_cannot_spread() -> None:
    """Strain along the axis alone, to 1e-3; a strip that slides, to 5e-3 as it is not endless."""
    assert layer("held") == pytest.approx((1 + NU) * (1 - 2 * NU) / (1 - NU) / E, rel=1e-3)
    assert layer("free") == pytest.approx((1 - NU**2) / E, rel=5e-3)


def test_a_held_body_is_stiffer_under_even_loads_and_waves() -> None:
    """And is another body, also where one of the same mesh is known."""
    closure = {"shape": "disc", "radius": "20 mm", "height": "3 mm", "material": MATERIAL}
    seat = {
        "shape": "torus",
        "centre_radius": "14 mm",
        "radius": "4 mm",
        "height": "4 mm",
        "material": MATERIAL,
    }
    free = contact_of(case_of(closure=closure, seat=seat)).model
    held_seal = case_of(closure={**closure, "base": "held"}, seat={**seat, "base": "held"})
    held = contact_of(held_seal).model
    assert SealProblem.of(held_seal).supports == fem_seal.Supports(base="held", closure_base="held")
    for name, side in (("closure", "closure_top"), ("seat", "seat_bottom")):
        with_it, without = getattr(held, name), getattr(free, name)
        on_side = boundary_dofs(with_it.fem.mesh, side, 0)
        assert (
            not np.isin(on_side, with_it.fem.free).any()
            and np.isin(on_side, without.fem.free).sum() >= len(on_side) - 1
        )
        gained = np.linalg.eigvalsh(without.compliance - with_it.compliance)
        assert gained.max() > 0 and gained.min() > -1e-6 * gained.max()
        waves = [body.harmonics[name == "seat"].compliance(2) for body in (free, held)]
        assert np.linalg.eigvalsh(waves[0] - waves[1]).max() > 0
        supports = fem_seal.Supports(base="held", closure_base="held")
        assert _is_same_body(with_it, with_it.fem.mesh, with_it.material, supports)
        assert not _is_same_body(without, without.fem.mesh, without.material, supports)


@pytest.mark.parametrize("load", [{}, {"fluid_pressure": "0 bar"}])
def test_a_dry_contact_is_one_without_a_leak_rate(load: dict[str, str], tmp_path: Path) -> None:
    case = case_of(load={"applied_force": ["500 N", "900 N"], **load})
    result = run(case)
    assert [one.contact_force for one in result.loads] == pytest.approx([500, 900], rel=1e-9)
    assert result.answers["verdict"].seal is None and all(one.leak is None for one in result.loads)
    assert [load_name(one, result.loads) for one in result.loads] == ["500 N", "900 N"]
    result.write(tmp_path)
    rows = list(csv.DictReader((tmp_path / "leak.csv").open()))
    assert not [name for name in rows[0] if "leak" in name or "blow_off" in name]
    assert all(value not in ("nan", "inf") for row in rows for value in row.values())
    page = (tmp_path / "report.html").read_text()
    assert "It is dry, and no leak rate is asked for" in page and "0 bar" not in page
    mesh = pyvista.read(tmp_path / "contact_line_000.vtp")
    assert all(np.isfinite(mesh[name]).all() for name in mesh.array_names)


@pytest.mark.parametrize(
    ("tables", "said"),
    [
        (
            {"fluid": {"name": "water"}},
            "fluid_pressure: is missing: .* is dry, .*; give a fluid pressure, or remove .fluid.",
        ),
        ({"load": {"fluid_pressure": "0 bar"}}, "applied_force: must be above 0 N: a dry contact"),
        ({"load": {"fluid_pressure": ["0 bar", "1 bar"], "applied_force": "5 N"}}, "is zero at some loads"),
        (
            {"load": {"fluid_pressure": "0 bar", "applied_force": "5 N", "closing": "penetration"}},
            'is zero: .* remove load.closing = "penetration"',
        ),
        (
            {
                "seat": {"shape": "cone", "angle": "45 deg", "material": "steel", "base": "held"},
                "temperature": {"uniform": "50 degC"},
            },
            "seat.base: holds a body that .temperature. makes grow",
        ),
    ],
)
def test_what_is_wrong_with_a_dry_contact(tables: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        case_of(**tables)
