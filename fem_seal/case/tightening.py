"""From the table [bolts] of a case to the load that the bolts give, and to bolts as springs."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

from fem_seal.bolts import BoltCircle, Bolts, stiffness_of
from fem_seal.case.bolts import BoltsTable
from fem_seal.case.tables import CaseTables, Load
from fem_seal.errors import InputError, Problem
from fem_seal.files import problem
from fem_seal.materials import ROOM_TEMPERATURE
from meshes.errors import mm


def apply_preloads(load: Load, table: BoltsTable) -> Load:
    """A table [load] whose applied forces are the preloads of bolts.

    Parameters
    ----------
    load : Load
    table : BoltsTable

    Raises
    ------
    InputError
        If there are neither as many preloads as fluid pressures nor one of them.
    """
    forces, pressures = table.preloads, load.fluid_pressure
    if len(forces) == 1:
        return load.model_copy(update={"applied_force": forces[0]})
    if len(pressures) == 1:
        pressures = pressures * len(forces)
    if len(pressures) != len(forces):
        key = "torque" if table.preload is None else "preload"
        raise InputError(problem("bolts_count", key=key, forces=len(forces), pressures=len(pressures)))
    return load.model_copy(update={"applied_force": forces, "fluid_pressure": pressures})


def bolts_of(case: CaseTables) -> Bolts | None:
    """Bolts of a case as springs; None where it has none.

    The clamped parts are as warm as the closure and of its material.

    Parameters
    ----------
    case : CaseTables
        Whose tables fit together; where temperatures are calculated they are counted once they are known.

    Raises
    ------
    InputError
        If an expansion is not known, or a table of a material does not reach to the temperature.
    """
    table = case.bolts
    if table is None:
        return None
    heat, warm, material = case.temperature, case.body_temperatures, table.material
    at, longer = ROOM_TEMPERATURE, 0.0
    if heat is not None and (table.temperature is not None or warm):
        at = table.temperature or sum(warm.values()) / len(warm)
        clamped_strain = case.closure.material.thermal_strain(
            warm.get("closure", heat.reference), heat.reference
        )
        if table.thermal_expansion is not None:
            strain = table.thermal_expansion * (at - heat.reference)
        elif material is not None:
            strain = material.thermal_strain(at, heat.reference)
        else:
            raise InputError(problem("bolts_expansion"))
        longer = (clamped_strain - strain) * table.length
    modulus = table.youngs_modulus
    if modulus is None:
        assert material is not None  # of the validation
        modulus = material.at(at).youngs_modulus
    tight = table.number if table.tightness is None else sum(t > 0 for t in table.tightness)
    stiffness = stiffness_of(tight, modulus, table.area, table.length, table.stiffness or math.inf)
    return Bolts(
        table.number,
        table.area,
        stiffness,
        stiffness * longer,
        table.torque_factor,
        table.torque_scatter,
        case.faces,
        table.circle,
    )


def problems_of_bolts(case: CaseTables, table: BoltsTable) -> list[Problem]:
    """What in [bolts] does not fit the other tables.

    Parameters
    ----------
    case : CaseTables
    table : BoltsTable
        The case's own.
    """
    faults = list[Problem]()
    if case.temperature is None and table.temperature is not None:
        faults.append(problem("bolts_temperature"))
    if case.load.earlier is not None:
        faults.append(problem("bolts_earlier", key=case.load.earlier_key))
    try:
        bolts = bolts_of(case)
    except InputError as error:
        return faults + [replace(p, key=f"bolts.{p.key.removeprefix('bolts.')}") for p in error.problems]
    least_force = min(force for _, force in case.load.points)
    if bolts is not None and not least_force + bolts.thermal_force > 0:
        faults.append(problem("bolts_loose", lost=-bolts.thermal_force, preload=least_force))
    if table.circle is not None:
        faults += _problems_of_circle(case, table.circle)
    return faults


def _problems_of_circle(case: CaseTables, circle: BoltCircle) -> Iterator[Problem]:
    """Bolts that do not stand on the closure's top, or all on one side of the seal."""
    radii = [
        r
        for segment in case.contact.closure.segments
        if segment.name == "closure_top"
        for r, _ in (segment.start, segment.end)
    ]
    given = 2 * circle.radius
    if not min(radii) <= circle.radius <= max(radii):
        ends = {"least": mm(2 * min(radii)), "most": mm(2 * max(radii))}
        yield problem("bolts_beside", circle=mm(given), **ends, **case.labels)
    lever, most = abs(circle.moment), case.initial_contact_radius
    if lever >= most:
        yield problem("bolts_tip", lever=mm(lever), radius=mm(most), **case.labels)
