"""Two bodies on one contact line: everything between their finite elements and a pressure profile."""

from fem_seal.bodies.held_body import Supports
from fem_seal.contact.coupled import Seal
from fem_seal.contact.fluid_path import FlowThrough, HeldFluid
from fem_seal.contact.laws import HardContact
from fem_seal.contact.model import ContactModel, condense
from fem_seal.contact.newton import solve
from fem_seal.contact.other_loads import FurtherLoads
from fem_seal.contact.penetration import blow_off_pressure, solve_penetration
from fem_seal.contact.solution import ContactSettings, ContactSolution, body_fields
from fem_seal.profile import PressureProfile

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
