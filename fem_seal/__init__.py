"""Leakage of metal seals: finite-element contact, rough-surface contact theory and leak rate.

>>> import fem_seal
>>> case = fem_seal.load_case("ball_cone.toml")     # doctest: +SKIP
>>> result = fem_seal.run(case)                     # doctest: +SKIP
>>> result.write("out")                             # doctest: +SKIP
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from fem_seal.version import __version__

if TYPE_CHECKING:
    from fem_seal import contact
    from fem_seal.answers.closed_forms import derive
    from fem_seal.answers.leak_map import LeakMap, leak_map
    from fem_seal.bodies.supports import Supports
    from fem_seal.case.case import Case, load_case
    from fem_seal.case.material_library import material, vickers_pressure
    from fem_seal.contact.coupled import Seal
    from fem_seal.contact.fluid_path import FlowThrough, HeldFluid
    from fem_seal.contact.laws import HardContact
    from fem_seal.contact.model import ContactModel, condense
    from fem_seal.contact.newton import solve
    from fem_seal.contact.other_loads import FurtherLoads
    from fem_seal.contact.penetration import blow_off_pressure, solve_penetration
    from fem_seal.contact.solution import ContactSettings, ContactSolution, body_fields
    from fem_seal.errors import ConvergenceError, InputError, SealError
    from fem_seal.materials import Material, effective_modulus
    from fem_seal.profile import PressureProfile
    from fem_seal.result import SealResult, applied_force_for_leak, blow_off_pressures, direct, run
    from fem_seal.studies.results import StudyResult
    from fem_seal.studies.study import Study, load_study

# Where each public name lives; loaded on first use, so that importing fem_seal takes no time.
_HOME = {
    "Case": "fem_seal.case.case",
    "load_case": "fem_seal.case.case",
    "Material": "fem_seal.materials",
    "material": "fem_seal.case.material_library",
    "vickers_pressure": "fem_seal.case.material_library",
    "effective_modulus": "fem_seal.materials",
    "SealError": "fem_seal.errors",
    "InputError": "fem_seal.errors",
    "ConvergenceError": "fem_seal.errors",
    "derive": "fem_seal.answers.closed_forms",
    "LeakMap": "fem_seal.answers.leak_map",
    "leak_map": "fem_seal.answers.leak_map",
    "run": "fem_seal.result",
    "direct": "fem_seal.result",
    "SealResult": "fem_seal.result",
    "applied_force_for_leak": "fem_seal.result",
    "blow_off_pressures": "fem_seal.result",
    "condense": "fem_seal.contact.model",
    "ContactModel": "fem_seal.contact.model",
    "solve": "fem_seal.contact.newton",
    "solve_penetration": "fem_seal.contact.penetration",
    "Seal": "fem_seal.contact.coupled",
    "FlowThrough": "fem_seal.contact.fluid_path",
    "HeldFluid": "fem_seal.contact.fluid_path",
    "blow_off_pressure": "fem_seal.contact.penetration",
    "FurtherLoads": "fem_seal.contact.other_loads",
    "Supports": "fem_seal.bodies.supports",
    "body_fields": "fem_seal.contact.solution",
    "ContactSettings": "fem_seal.contact.solution",
    "ContactSolution": "fem_seal.contact.solution",
    "HardContact": "fem_seal.contact.laws",
    "PressureProfile": "fem_seal.profile",
    "Study": "fem_seal.studies.study",
    "load_study": "fem_seal.studies.study",
    "StudyResult": "fem_seal.studies.results",
}

__all__ = [
    "Case",
    "ContactModel",
    "ContactSettings",
    "ContactSolution",
    "ConvergenceError",
    "FlowThrough",
    "FurtherLoads",
    "HardContact",
    "HeldFluid",
    "InputError",
    "LeakMap",
    "Material",
    "PressureProfile",
    "Seal",
    "SealError",
    "SealResult",
    "Study",
    "StudyResult",
    "Supports",
    "__version__",
    "applied_force_for_leak",
    "blow_off_pressure",
    "blow_off_pressures",
    "body_fields",
    "condense",
    "contact",
    "derive",
    "direct",
    "effective_modulus",
    "leak_map",
    "load_case",
    "load_study",
    "material",
    "run",
    "solve",
    "solve_penetration",
    "vickers_pressure",
]


# Former name, present name.
_FORMER = {"axial_force_for_leak": "applied_force_for_leak"}


def __getattr__(name: str) -> Any:
    if name == "contact":
        return import_module("fem_seal.contact")
    if name in _FORMER:
        from fem_seal.former_names import say_once

        say_once(f"fem_seal.{name}", f"fem_seal.{_FORMER[name]}")
        name = _FORMER[name]
    if name not in _HOME:
        raise AttributeError(f"module 'fem_seal' has no attribute {name!r}")
    return getattr(import_module(_HOME[name]), name)


def __dir__() -> list[str]:
    return sorted(__all__)
