"""The same loads with another interface law, and with every reading of the theory."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import product
from typing import TYPE_CHECKING

from fem_seal.analysis.flow import conductivity_table, leak_of_contact
from fem_seal.analysis.load_solver import LoadSolver, solve_load, solve_loads
from fem_seal.analysis.problem import interface_law
from fem_seal.analysis.results import (
    InterfaceVariant,
    LoadResult,
    SealSolution,
    TheoryVariant,
    strongest_load,
)
from fem_seal.contact.laws import Law
from fem_seal.contact.newton import solve
from fem_seal.contact.solution import ContactSolution
from leak import RoughContact

if TYPE_CHECKING:
    from fem_seal.case.case import Case

# Share of the contact area at which channels close: two-dimensional percolation, and the textbook value.
_THRESHOLDS = (0.42, 0.5)
_WIDTHS = ("effective", "plain")


def theory_variants(result: SealSolution) -> tuple[TheoryVariant, ...]:
    """Leak rates of all loads with every reading of the theory: p(u), P(u), percolation threshold, channels.

    Parameters
    ----------
    result : SealSolution

    Returns
    -------
    tuple of TheoryVariant
        Empty if nothing leaks in the case for want of roughness or fluid.
    """
    case, surface = result.case, result.surface
    if surface is None or case.fluid is None:
        return ()
    variants: list[TheoryVariant] = []
    for plastic in _laws(result):
        contacts: Sequence[ContactSolution] = result.contact
        if plastic is not None and plastic != case.interface.plastic:
            changed = case.model_copy(
                update={"interface": case.interface.model_copy(update={"plastic": plastic})}
            )
            contacts = _contacts(result, interface_law(changed, surface))
        variants += [
            _variant(case, surface, contacts, plastic, *flow) for flow in _flows(case, surface.peklenik)
        ]
    return tuple(variants)


def _contacts(result: SealSolution, law: Law) -> Sequence[ContactSolution]:
    """The loads of a result with another interface law."""
    from fem_seal.contact.newton import solve

    if result.unloaded is not None:
        return solve_loads(LoadSolver(result.case, law, result.model)).contacts
    return tuple(
        solve(result.model, law, axial_force=load.axial_force, loads=load.contact.loads, start=load.contact)
        for load in result.loads
    )


def _laws(result: SealSolution) -> tuple[bool | None, ...]:
    if result.case.interface.law != "persson":
        return (None,)
    assert result.surface is not None
    return (False,) if result.surface.hardness is None else (False, True)


def _flows(case: Case, peklenik: float) -> list[tuple[str, str | None, float]]:
    """Conductivity, width in P(u) and threshold."""
    thresholds = sorted({*_THRESHOLDS, case.leak.percolation_threshold})
    channels: list[tuple[str, str | None, float]] = [
        ("bruggeman", width, threshold) for width, threshold in product(_WIDTHS, thresholds)
    ]
    if peklenik != 1.0:
        return channels  # one junction knows no direction
    return [*channels, *(("critical-junction", None, threshold) for threshold in thresholds)]


def _variant(
    case: Case,
    surface: RoughContact,
    contacts: Sequence[ContactSolution],
    plastic: bool | None,
    conductivity: str,
    width: str | None,
    threshold: float,
) -> TheoryVariant:
    from fem_seal.analysis.flow import conductivity_table, leak_of_contact

    read = case.model_copy(update={"leak": case.leak.model_copy(update={"conductivity": conductivity})})
    surface = replace(
        surface,
        percolation_threshold=threshold,
        separation_width=surface.separation_width if width is None else width,
    )
    table = conductivity_table(read, surface, contacts)
    rates = tuple(
        leak_of_contact(read, table, contact, pressure).leak_rate
        for contact, pressure in zip(contacts, case.load.fluid_pressure, strict=True)
    )
    used = (
        plastic in (None, case.interface.plastic)
        and conductivity == case.leak.conductivity
        and width in (None, "effective")
        and threshold == case.leak.percolation_threshold
    )
    return TheoryVariant(plastic, conductivity, width, threshold, rates, used)


def ratio_to_case(leak_rate: float, of_case: float) -> float:
    """Leak rate over that of the case; NaN where the case is sealed."""
    return leak_rate / of_case if of_case > 0 else float("nan")


def interface_variants(
    solver: LoadSolver, surface: RoughContact | None, loads: Sequence[LoadResult]
) -> tuple[InterfaceVariant, ...]:
    """The load with the largest closing force with p(u) of the elastic and of the plastically smoothed surface."""
    case = solver.case
    if surface is None or surface.hardness is None or case.interface.law != "persson":
        return ()
    strongest = strongest_load(loads)
    load, variants = loads[strongest], []
    for name, plastic in (("elastic p(u)", False), ("plastic p(u)", True)):
        contact = load.contact
        if plastic != case.interface.plastic:
            law = surface.interface_law(plastic=plastic)
            if solver.yields:
                contact = solve_load(replace(solver, law=law), strongest)
            else:
                # what the fluid does between the surfaces stays as it is
                contact = solve(solver.model, law, axial_force=load.axial_force, loads=contact.loads)
        leak = None
        if case.fluid is not None:
            table = conductivity_table(case, surface, [contact])
            leak = leak_of_contact(case, table, contact, load.fluid_pressure).leak_rate
        profile = contact.profile
        variants.append(InterfaceVariant(name, profile.peak_pressure, profile.fwhm, profile.std, leak))
    return tuple(variants)
