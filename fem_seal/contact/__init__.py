"""Two bodies on one contact line: everything between their finite elements and a pressure profile.

Lengths in m, forces in N, pressures in Pa; `condense` makes the model of two bodies, `solve` presses them together.

Examples
--------
>>> import meshes
>>> from fem_seal import contact, material
>>> ball = meshes.Ball(0.02)
>>> cone = meshes.ConicalSeat.around(0.785, ball)
>>> mesh = meshes.build(ball, cone, meshes.Sizing(2e-5, 1e-4, (-1e-3, 1e-3), 0.2, 0.3, 4e-3))
>>> model = contact.condense(mesh, {"closure": material("steel"), "seat": material("steel")})
>>> pressed = contact.solve(model, contact.HardContact(), contact_force=1257.0)
>>> print(f"{pressed.profile.peak_pressure / 1e6:.0f} MPa")
195 MPa
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fem_seal.bodies.supports import Supports
    from fem_seal.contact.coupled import Seal
    from fem_seal.contact.fluid_path import FlowThrough, HeldFluid
    from fem_seal.contact.laws import HardContact
    from fem_seal.contact.model import ContactModel, condense
    from fem_seal.contact.newton import solve
    from fem_seal.contact.other_loads import FurtherLoads
    from fem_seal.contact.penetration import blow_off_pressure, solve_penetration
    from fem_seal.contact.solution import ContactSettings, ContactSolution, body_fields
    from fem_seal.profile import PressureProfile

# The public names of each module; loaded on first use, so that a program loads only what it calls.
_NAMES = {
    "fem_seal.bodies.supports": ("Supports",),
    "fem_seal.contact.coupled": ("Seal",),
    "fem_seal.contact.fluid_path": ("FlowThrough", "HeldFluid"),
    "fem_seal.contact.laws": ("HardContact",),
    "fem_seal.contact.model": ("ContactModel", "condense"),
    "fem_seal.contact.newton": ("solve",),
    "fem_seal.contact.other_loads": ("FurtherLoads",),
    "fem_seal.contact.penetration": ("blow_off_pressure", "solve_penetration"),
    "fem_seal.contact.solution": ("ContactSettings", "ContactSolution", "body_fields"),
    "fem_seal.profile": ("PressureProfile",),
}
_HOME = {name: module for module, names in _NAMES.items() for name in names}

__all__ = [
    "ContactModel",
    "ContactSettings",
    "ContactSolution",
    "FlowThrough",
    "FurtherLoads",
    "HardContact",
    "HeldFluid",
    "PressureProfile",
    "Seal",
    "Supports",
    "blow_off_pressure",
    "body_fields",
    "condense",
    "solve",
    "solve_penetration",
]


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'fem_seal.contact' has no attribute {name!r}")
    value = globals()[name] = getattr(import_module(_HOME[name]), name)
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
