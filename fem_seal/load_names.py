"""How warnings, report and pictures call the loads of a result: by fluid pressure and, if that is not enough, force."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fem_seal.readable import Unit, given, unit_for

if TYPE_CHECKING:
    from fem_seal.results import LoadResult, TargetContact

FloatArray = NDArray[np.float64]


def load_name(load: LoadResult | TargetContact, loads: Sequence[LoadResult | TargetContact]) -> str:
    """What tells a load from the others: "20 bar", or "20 bar with 400 N" if more forces act at this pressure.

    Parameters
    ----------
    load : LoadResult or TargetContact
    loads : sequence
        All of them.
    """
    pressure = given("fluid pressure", load.fluid_pressure)
    forces = {other.applied_force for other in loads if other.fluid_pressure == load.fluid_pressure}
    return pressure if len(forces) == 1 else f"{pressure} with {given('force', load.applied_force)}"


@dataclass(frozen=True, eq=False)
class LoadAxis:
    """What changes from load to load, to draw results over.

    Parameters
    ----------
    name : str
    unit : Unit
    values : ndarray, shape (loads,)
        SI.
    names : tuple of str
        Of the loads, for a legend that is headed with `name`.
    """

    name: str
    unit: Unit
    values: FloatArray
    names: tuple[str, ...]

    @property
    def label(self) -> str:
        """Of the axis."""
        return f"{self.name}  [{self.unit.name}]"

    @property
    def shown(self) -> FloatArray:
        """Values in the unit of the axis."""
        return self.values / self.unit.size


def load_axis(loads: Sequence[LoadResult]) -> LoadAxis:
    """The fluid pressure, or the force of spring or actuator where it is all that changes.

    Parameters
    ----------
    loads : sequence of LoadResult
    """
    pressures = np.array([load.fluid_pressure for load in loads])
    forces = np.array([load.applied_force for load in loads])
    if np.ptp(pressures) == 0 and np.ptp(forces) > 0:
        names = tuple(given("force", force) for force in forces.tolist())
        return LoadAxis("spring force", unit_for("force", float(np.abs(forces).max())), forces, names)
    names = tuple(load_name(load, loads) for load in loads)
    return LoadAxis("fluid pressure", unit_for("fluid pressure", float(pressures.max())), pressures, names)
