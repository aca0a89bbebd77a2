"""Names of loads by fluid pressure, force and number."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fem_seal.arrays import FloatArray
from fem_seal.seal.load_result import AnyLoad, LoadResult
from fem_seal.units import Unit, format_quantity, unit_for


def load_name(load: AnyLoad, loads: Sequence[AnyLoad]) -> str:
    """What tells a load from the others: "20 bar", "20 bar with 400 N", or "20 bar (load 3)" where a path comes back.

    Parameters
    ----------
    load : LoadResult or MissingLoad
    loads : sequence
        All of them, in their order.
    """
    return load_values(load, loads) + _number(load, loads)


def load_values(load: AnyLoad, loads: Sequence[AnyLoad]) -> str:
    """Pressure of a load and, if more forces act at this pressure, its force: "20 bar", "20 bar with 400 N".

    Parameters
    ----------
    load : LoadResult or MissingLoad
    loads : sequence
        All of them.
    """
    pressure = format_quantity("fluid pressure", load.fluid_pressure)
    forces = {other.applied_force for other in loads if other.fluid_pressure == load.fluid_pressure}
    return pressure if len(forces) == 1 else f"{pressure} with {format_quantity('force', load.applied_force)}"


def different(loads: Sequence[LoadResult]) -> list[int]:
    """Numbers of the loads, the line load rising, without those to which elastic bodies come back exactly.

    Parameters
    ----------
    loads : sequence of LoadResult
        All of them, in their order.
    """
    order = sorted(range(len(loads)), key=lambda n: loads[n].line_load)
    return list({(*loads[n].point, _number(loads[n], loads)): n for n in order}.values())


def _number(load: AnyLoad, loads: Sequence[AnyLoad]) -> str:
    again = _yields(load) and [other.point for other in loads].count(load.point) > 1
    return f" (load {loads.index(load) + 1})" if again else ""


def _yields(load: AnyLoad) -> bool:
    """Whether bodies yield under the load, so that the order of the loads matters."""
    from fem_seal.contact.load_path import ElastoplasticContact

    return isinstance(getattr(load, "contact", None), ElastoplasticContact)


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
    ordered : bool
        Whether the order of the loads matters, because a body remembers them.
    returns : bool
        Whether they come back to one that is not the same any more.
    """

    name: str
    unit: Unit
    values: FloatArray
    names: tuple[str, ...]
    ordered: bool
    returns: bool

    @property
    def order(self) -> str:
        """How a picture shows the order of the loads: "joined", "numbered", or empty if it does not matter."""
        return ("numbered" if self.returns else "joined") if self.ordered else ""

    @property
    def label(self) -> str:
        """Of the axis."""
        return f"{self.name}  [{self.unit.name}]"

    @property
    def shown(self) -> FloatArray:
        """Values in the unit of the axis."""
        return self.values / self.unit.size


def load_axis(loads: Sequence[AnyLoad]) -> LoadAxis:
    """The fluid pressure, or the force of spring or actuator where it is all that changes.

    Parameters
    ----------
    loads : sequence of LoadResult
        In their order.
    """
    pressures = np.array([load.fluid_pressure for load in loads])
    forces = np.array([load.applied_force for load in loads])
    path = any(_yields(load) for load in loads), any(_number(load, loads) for load in loads)
    if np.ptp(pressures) == 0 and np.ptp(forces) > 0:
        names = tuple(format_quantity("force", load.applied_force) + _number(load, loads) for load in loads)
        return LoadAxis("applied force", unit_for("force", float(np.abs(forces).max())), forces, names, *path)
    names = tuple(load_name(load, loads) for load in loads)
    return LoadAxis(
        "fluid pressure", unit_for("fluid pressure", float(pressures.max())), pressures, names, *path
    )
