"""From one load of a case to the contact that carries it, for every way of closing."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from fem_seal.blow_off import blow_off_pressure
from fem_seal.case_flow import CaseFlow
from fem_seal.condensation import ContactModel, condense
from fem_seal.contact import solve
from fem_seal.contact_solution import ContactSolution
from fem_seal.coupled_contact import Seal
from fem_seal.elastoplastic_contact import yielding_bodies
from fem_seal.errors import InputError, OpenSealError, Problem
from fem_seal.fluid_paths import FlowThrough, FluidPath, HeldFluid
from fem_seal.further_loads import FurtherLoads
from fem_seal.held_body import Supports
from fem_seal.laws import Law
from fem_seal.loads import blow_off_of_sealed_area, closing_force
from fem_seal.penetration import least_closing_force, solve_at_contact_force, solve_penetration

if TYPE_CHECKING:
    from fem_seal.case import Case
    from meshes import SealMesh


def supports(case: Case) -> Supports:
    """How the seat of a case is held."""
    return Supports(wall=getattr(case.seat, "wall", "free"))


def interference(case: Case) -> float:
    """Interference of the press fit of a case's seat, on the radius [m]; zero without one."""
    return getattr(case.seat, "interference", None) or 0.0


def condensed(case: Case, seal_mesh: SealMesh) -> ContactModel:
    """The bodies of a case on a mesh, condensed."""
    materials = {"closure": case.closure.material, "seat": case.seat.material}
    return condense(seal_mesh, materials, supports(case))


@dataclass(frozen=True)
class LoadSolver:
    """Solves loads of a case on one model.

    Parameters
    ----------
    case : Case
    law : Law
        Between contact pressure and gap.
    model : ContactModel
    """

    case: Case
    law: Law
    model: ContactModel

    def solve(
        self, fluid_pressure: float, axial_force: float, start: ContactSolution | None = None
    ) -> ContactSolution:
        """Contact under a fluid pressure [Pa] and the force of spring or actuator [N].

        Raises
        ------
        InputError
            If these leave the seal open.
        ConvergenceError
        """
        if self.case.load.closing == "sealed-area":
            return self._sealed_area(axial_force + self._closes(fluid_pressure), start)
        try:
            return solve_penetration(
                self.seal, closing_force=axial_force, fluid_pressure=fluid_pressure, start=start
            )
        except OpenSealError as error:
            least = least_closing_force(self.seal, fluid_pressure)
            allowed = "" if least is None else f"; allowed is an axial_force above {least:.5g} N"
            problem = Problem(
                "load.axial_force",
                f"the seal is open at a fluid pressure of {fluid_pressure / 1e5:.6g} bar: {error}{allowed}",
                f"{axial_force:.6g} N",
            )
            raise InputError(problem, file=self.case.file) from error

    def at_contact_force(
        self, fluid_pressure: float, contact_force: float, start: ContactSolution | None = None
    ) -> tuple[ContactSolution, float]:
        """Contact that carries a force F_N [N] at a fluid pressure [Pa], and the spring force that this takes [N]."""
        if self.case.load.closing == "sealed-area":
            return self._sealed_area(contact_force, start), contact_force - self._closes(fluid_pressure)
        contact = solve_at_contact_force(
            self.seal, contact_force=contact_force, fluid_pressure=fluid_pressure, start=start
        )
        return contact, contact.closing_force

    def blow_off_pressure(self, axial_force: float) -> float:
        """Fluid pressure at which the fluid lifts the closure off [Pa], infinite if it does not."""
        load = self.case.load
        if load.closing == "penetration":
            return blow_off_pressure(self.seal, closing_force=axial_force)
        return blow_off_of_sealed_area(self.case.touch_radius, axial_force, load.pressure_side)

    def opening_force(self, fluid_pressure: float) -> float | None:
        """Force of spring or actuator [N] below which the seal is open at a fluid pressure [Pa]; None if not found."""
        if self.case.load.closing == "penetration":
            return least_closing_force(self.seal, fluid_pressure)
        return -self._closes(fluid_pressure)

    @property
    def yields(self) -> bool:
        """Whether a body yields, so that its loads are no questions of their own but a path."""
        return bool(yielding_bodies(self.model))

    @cached_property
    def flow(self) -> CaseFlow | None:
        """Flow through the contacts; None without roughness or fluid."""
        known = self.case.roughness is not None and self.case.fluid is not None
        return CaseFlow(self.case, self.law) if known else None

    @cached_property
    def seal(self) -> Seal:
        """What stays the same at every load."""
        return Seal(self.model, self.law, self._path, interference(self.case))

    @cached_property
    def _path(self) -> FluidPath:
        side, flow = self.case.load.pressure_side, self.flow
        if flow is None:
            return HeldFluid(side)
        return FlowThrough(
            lambda profile, pressure: flow.leak(profile, pressure).fluid_pressure,
            flow.surface.sealing_pressure,
            side,
        )

    def _sealed_area(self, force: float, start: ContactSolution | None) -> ContactSolution:
        fit = FurtherLoads.press_fit(interference(self.case))
        return solve(self.model, self.law, axial_force=force, loads=fit, start=start)

    def _closes(self, fluid_pressure: float) -> float:
        return closing_force(self.case.touch_radius, fluid_pressure, 0.0, self.case.load.pressure_side)
