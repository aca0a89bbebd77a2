"""Leakage of metal seals: finite-element contact, rough-surface contact theory and leak rate.

>>> import fem_seal
>>> case = fem_seal.load_case("ball_cone.toml")     # doctest: +SKIP
>>> result = fem_seal.run(case)                     # doctest: +SKIP
>>> result.write("out")                             # doctest: +SKIP
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fem_seal.case import Case, load_case
    from fem_seal.errors import ConvergenceError, InputError, SealError
    from fem_seal.materials import Material

__version__ = "0.1.0"

# Where each public name lives; loaded on first use, so that importing fem_seal takes no time.
_HOME = {
    "Case": "fem_seal.case",
    "load_case": "fem_seal.case",
    "Material": "fem_seal.materials",
    "material": "fem_seal.materials",
    "effective_modulus": "fem_seal.materials",
    "SealError": "fem_seal.errors",
    "InputError": "fem_seal.errors",
    "ConvergenceError": "fem_seal.errors",
    "derive": "fem_seal.derived",
    "run": "fem_seal.pipeline",
    "SealResult": "fem_seal.results",
    "axial_force_for_leak": "fem_seal.inverse_questions",
    "blow_off_pressures": "fem_seal.inverse_questions",
    "condense": "fem_seal.condensation",
    "ContactModel": "fem_seal.condensation",
    "solve": "fem_seal.contact",
    "solve_penetration": "fem_seal.penetration",
    "Seal": "fem_seal.coupled_contact",
    "FlowThrough": "fem_seal.fluid_paths",
    "HeldFluid": "fem_seal.fluid_paths",
    "blow_off_pressure": "fem_seal.blow_off",
    "FurtherLoads": "fem_seal.further_loads",
    "Supports": "fem_seal.held_body",
    "body_fields": "fem_seal.stress",
    "ContactSettings": "fem_seal.contact_solution",
    "ContactSolution": "fem_seal.contact_solution",
    "HardContact": "fem_seal.laws",
    "PressureProfile": "fem_seal.profile",
    "Study": "fem_seal.studies.study",
    "load_study": "fem_seal.studies.study",
    "StudyResult": "fem_seal.studies.results",
}

__all__ = ["Case", "ConvergenceError", "InputError", "Material", "SealError", "load_case", *_HOME]


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'fem_seal' has no attribute {name!r}")
    return getattr(import_module(_HOME[name]), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *_HOME})
