"""The table [bolts] of the case file: bolts that close the seal in place of load.applied_force."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import model_validator

from fem_seal.bolts import STRESS_AREAS, Bolts, nominal_diameter, preload_of_torque, stiffness_of
from fem_seal.case.fields import Number, OneOrMany, Quantity, Table, Whole
from fem_seal.case.material_table import MaterialField
from fem_seal.case.temperature import Kelvin
from fem_seal.case.words import problem, wrong
from fem_seal.errors import InputError, Problem
from fem_seal.materials import ROOM_TEMPERATURE
from fem_seal.units import briefly

if TYPE_CHECKING:
    from fem_seal.case.tables import CaseTables, Load

# Nut factor where the state of the bolts is not known (Shigley, table 8-15: from memory).
NUT_FACTOR = 0.2


class BoltsTable(Table):
    """[bolts]: bolts that close the seal, in place of load.applied_force; see guide/flange in the manual."""

    number: Annotated[int, Whole(1, 1000)]
    size: str | None = None
    stress_area: Annotated[float, Quantity("area", "0.1 mm^2", "1e5 mm^2")] | None = None
    length: Annotated[float, Quantity("length", "1 mm", "10 m")]
    material: MaterialField | None = None
    youngs_modulus: Annotated[float, Quantity("pressure", "1 GPa", "1 TPa")] | None = None
    torque: Annotated[float | tuple[float, ...], OneOrMany("torque", "1e-3 N m", "1e6 N m")] | None = None
    nut_factor: Annotated[float, Number(0.02, 1)] = NUT_FACTOR
    preload: Annotated[float | tuple[float, ...], OneOrMany("force", "1 N", "1e8 N")] | None = None
    torque_scatter: Annotated[float, Number(0, 0.9)] = 0.0
    stiffness: Annotated[float, Quantity("stiffness", "1 N/m", "1e15 N/m")] | None = None
    temperature: Kelvin | None = None
    thermal_expansion: Annotated[float, Quantity("thermal expansion", "-1e-4 1/K", "1e-3 1/K")] | None = None

    @model_validator(mode="after")
    def _consistent(self) -> BoltsTable:
        known = self.size is not None and nominal_diameter(self.size) is not None
        if (self.torque is None) == (self.preload is None):
            raise wrong("bolts_preload")
        if self.size is not None and not known:
            raise wrong("bolts_size", size=self.size)
        if self.stress_area is None and self.size not in STRESS_AREAS:
            raise wrong("bolts_area", known=", ".join(STRESS_AREAS))
        if self.torque is not None and not known:
            raise wrong("bolts_diameter")
        if self.material is None and self.youngs_modulus is None:
            raise wrong("bolts_modulus")
        return self

    @property
    def area(self) -> float:
        """Stress area of a bolt [m^2]."""
        return STRESS_AREAS[self.size or ""] if self.stress_area is None else self.stress_area

    @property
    def torque_factor(self) -> float | None:
        """K d, torque over preload [m]; None without a size."""
        diameter = None if self.size is None else nominal_diameter(self.size)
        return None if diameter is None else self.nut_factor * diameter

    @property
    def preloads(self) -> tuple[float, ...]:
        """Preload of all bolts together, one or one for each load [N]."""
        given = self.preload if self.torque is None else self.torque
        each: tuple[Any, ...] = given if isinstance(given, tuple) else (given,)
        if self.torque is not None:
            diameter = nominal_diameter(self.size or "")
            assert diameter is not None  # of the validation
            each = tuple(preload_of_torque(one, self.nut_factor, diameter) for one in each)
        return tuple(self.number * one for one in each)

    def closes(self, load: Load) -> Load:
        """A table [load] whose applied forces are the preloads.

        Parameters
        ----------
        load : Load

        Raises
        ------
        InputError
            If there are neither as many preloads as fluid pressures nor one of them.
        """
        forces, pressures = self.preloads, load.fluid_pressure
        if len(forces) == 1:
            return load.model_copy(update={"applied_force": forces[0]})
        if len(pressures) == 1:
            pressures = pressures * len(forces)
        if len(pressures) != len(forces):
            key = "torque" if self.preload is None else "preload"
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
        clamped = case.closure.material.thermal_strain(warm.get("closure", heat.reference), heat.reference)
        if table.thermal_expansion is not None:
            own = table.thermal_expansion * (at - heat.reference)
        elif material is not None:
            own = material.thermal_strain(at, heat.reference)
        else:
            raise InputError(problem("bolts_expansion"))
        longer = (clamped - own) * table.length
    modulus = table.youngs_modulus
    if modulus is None:
        assert material is not None  # of the validation
        modulus = material.at(at).youngs_modulus
    stiffness = stiffness_of(table.number, modulus, table.area, table.length, table.stiffness or math.inf)
    preload = tuple(force for _, force in case.load.points)
    return Bolts(
        table.number,
        table.area,
        stiffness,
        preload,
        stiffness * longer,
        table.torque_factor,
        table.torque_scatter,
    )


def problems_of_bolts(case: CaseTables, table: BoltsTable) -> list[Problem]:
    """What in [bolts] does not fit the other tables.

    Parameters
    ----------
    case : CaseTables
    table : BoltsTable
        The case's own.
    """
    found = list[Problem]()
    if case.temperature is None and table.temperature is not None:
        found.append(problem("bolts_temperature"))
    if case.load.earlier is not None:
        found.append(problem("bolts_earlier", key=case.load.earlier_key))
    try:
        bolts = bolts_of(case)
    except InputError as error:
        return found + [replace(one, key=f"bolts.{one.key.removeprefix('bolts.')}") for one in error.problems]
    if bolts is not None and not min(bolts.preload) + bolts.thermal_force > 0:
        lost, least = -bolts.thermal_force, min(bolts.preload)
        found.append(problem("bolts_loose", lost=briefly("force", lost), preload=briefly("force", least)))
    return found
