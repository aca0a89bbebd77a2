"""Loads of a ball on a cone as the checks of warnings see them, with nothing to say against them unless asked for."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
from paper_surface import surface
from sample_results import case

from fem_seal.answers.case_load import CaseLoad
from fem_seal.bodies.fields import BodyField, ElastoplasticField
from fem_seal.case.case import Case
from fem_seal.profile import PressureProfile
from fem_seal.seal.findings import Finding
from fem_seal.seal.load_result import LoadResult
from fem_seal.seal.problem import SealProblem
from fem_seal.validity.checks import load_cautions
from leak import LeakResult, RoughContact

SURFACE = surface()
_X = np.array([-1e-3, 0, 1e-3])
_POINTS = np.array([[0.013, 0.0], [0.014, -1e-5], [0.015, 0.0]])


def field(name: str, von_mises: float = 0.0, plastic_strain: float | None = None) -> BodyField:
    """A body that is stressed, and that has yielded where a plastic strain is given, in the middle of three points."""
    stress = np.zeros((3, 4))
    stress[1, 1] = von_mises
    none = np.zeros((0, 6), dtype=int)
    values = name, _POINTS, none, 0 * _POINTS, stress, np.array([0, 2]), np.zeros(2), np.zeros(3)
    if plastic_strain is None:
        return BodyField(*values)
    return ElastoplasticField(*values, stress[:, 1], 0 * stress, np.array([0.0, plastic_strain, 0.0]))


def load(
    peak: float = 50e6,
    std: float = 0.15e-3,
    fluid_pressure: float = 20e5,
    critical_separation: float = 3e-6,
    leak_rate: float = 1e-7,
    applied_force: float = 0.0,
    end_share: float = 0.0,
    turning: float = 0.0,
    bodies: tuple[BodyField, ...] = (),
) -> Any:
    """What the checks look at in a load."""
    pressure = np.array([end_share * peak, peak, 0.0])
    profile = PressureProfile(_X, _POINTS[:, 0], pressure, np.zeros(3), np.full(3, 1e-3))
    # as asked for, and not of the three points
    vars(profile).update(peak=(0.0, peak), std=std)
    contact = SimpleNamespace(
        profile=profile,
        profiles=(profile,),
        pressure=pressure,
        point_forces=pressure,
        gap=np.zeros(3),
        turning=turning,
        contact_force=max(applied_force, 1.0),
        fields={name: field(name) for name in ("closure", "seat")} | {body.name: body for body in bodies},
        model=SimpleNamespace(
            bodies={"closure": None, "seat": None},
            knows_stress=True,
            initial_contact_radius=0.014,
            touch_normal_z=0.7,
            relative_radius=0.02,
            line=SimpleNamespace(x=_X, bend=np.zeros(3)),
        ),
        stays_below=lambda name, stress: False,
    )
    case_load: Any = CaseLoad.of(LoadResult(fluid_pressure, applied_force, contact))  # type: ignore[arg-type]
    return case_load.with_values(
        critical_separation=critical_separation, leak=LeakResult(leak_rate, 1.0, np.zeros(3))
    )


def judged(
    kind: str,
    *loads: Any,
    of: Case | None = None,
    surface: RoughContact = SURFACE,
    relative_radius: float = 0.02,
) -> list[Finding]:
    """The cautions of one kind about these loads of a case, a ball on a cone unless given."""
    for load_ in loads:
        load_.contact.model.relative_radius = relative_radius
    findings = load_cautions(replace(SealProblem.of(of or case()), surface=surface), loads)
    return [caution for caution in findings if caution.kind == kind]
