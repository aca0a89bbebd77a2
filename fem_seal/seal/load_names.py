"""Names of loads by fluid pressure, force and number; loads without a result."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from fem_seal.arrays import FloatArray
from fem_seal.errors import LoadProblem
from fem_seal.seal.findings import Caution, Level
from fem_seal.seal.load_result import LoadResult
from fem_seal.seal.problem import Loads
from fem_seal.units import Unit, given, unit_for


def load_name(load: LoadResult, loads: Sequence[LoadResult]) -> str:
    """What tells a load from the others: "20 bar", "20 bar with 400 N", or "20 bar (load 3)" where a path comes back.

    Parameters
    ----------
    load : LoadResult
    loads : sequence
        All of them, in their order.
    """
    return load_values(load, loads) + _number(load, loads)


def load_values(load: LoadResult, loads: Sequence[LoadResult]) -> str:
    """Pressure of a load and, if more forces act at this pressure, its force: "20 bar", "20 bar with 400 N".

    Parameters
    ----------
    load : LoadResult
    loads : sequence
        All of them.
    """
    pressure = given("fluid pressure", load.fluid_pressure)
    forces = {other.applied_force for other in loads if other.fluid_pressure == load.fluid_pressure}
    return pressure if len(forces) == 1 else f"{pressure} with {given('force', load.applied_force)}"


def different(loads: Sequence[LoadResult]) -> list[int]:
    """Numbers of the loads, the line load rising, without those to which elastic bodies come back exactly.

    Parameters
    ----------
    loads : sequence of LoadResult
        All of them, in their order.
    """
    order = sorted(range(len(loads)), key=lambda n: loads[n].line_load)
    return list({(*loads[n].point, _number(loads[n], loads)): n for n in order}.values())


def _number(load: LoadResult, loads: Sequence[LoadResult]) -> str:
    again = _remembers(load) and [other.point for other in loads].count(load.point) > 1
    return f" (load {loads.index(load) + 1})" if again else ""


def _remembers(load: LoadResult) -> bool:
    from fem_seal.contact.load_path import ElastoplasticContact

    return isinstance(load.contact, ElastoplasticContact)


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


def load_axis(loads: Sequence[LoadResult]) -> LoadAxis:
    """The fluid pressure, or the force of spring or actuator where it is all that changes.

    Parameters
    ----------
    loads : sequence of LoadResult
        In their order.
    """
    pressures = np.array([load.fluid_pressure for load in loads])
    forces = np.array([load.applied_force for load in loads])
    path = any(_remembers(load) for load in loads), any(_number(load, loads) for load in loads)
    if np.ptp(pressures) == 0 and np.ptp(forces) > 0:
        names = tuple(given("force", load.applied_force) + _number(load, loads) for load in loads)
        return LoadAxis("applied force", unit_for("force", float(np.abs(forces).max())), forces, names, *path)
    names = tuple(load_name(load, loads) for load in loads)
    return LoadAxis(
        "fluid pressure", unit_for("fluid pressure", float(pressures.max())), pressures, names, *path
    )


def left_out(loads: Loads, problems: Mapping[int, LoadProblem]) -> Iterator[Caution]:
    """Which loads have no result: one sentence for each reason and force, or for all forces under one pressure.

    Parameters
    ----------
    loads : Loads
    problems : mapping
        Number of each load that is left out, with the reason.
    """
    for kind in dict.fromkeys(problem.kind for problem in problems.values()):
        alike = {number: problem for number, problem in problems.items() if problem.kind == kind}
        for text in _alike(loads, alike):
            # nothing against the loads that are left
            yield Caution("left out", Level.DOUBTFUL, "left out", text)


def _alike(loads: Loads, problems: Mapping[int, LoadProblem]) -> Iterator[str]:
    """The same for loads with the same kind of problem; told is the reason of the one that is nearest to a result."""
    points = {number: loads.points[number] for number in problems}
    kind = next(iter(problems.values())).kind
    # whose pressure is lowest; of an open seal whose applied force is largest; of those without a solution the first
    direction = {"open": -1, "strain": 1}.get(kind, 0)
    if len(set(loads.fluid_pressure)) == 1:
        nearest = min(points, key=lambda number: direction * points[number][1])
        others = {force for _, force in points.values()} - {points[nearest][1]}
        yield _sentence(loads, nearest, problems[nearest], _others("with", others, "N"))
        return
    for applied_force in dict.fromkeys(force for _, force in points.values()):
        numbers = [number for number, (_, force) in points.items() if force == applied_force]
        nearest = min(numbers, key=lambda number: abs(direction) * loads.fluid_pressure[number])
        pressures = {loads.fluid_pressure[number] / 1e5 for number in numbers}
        others = pressures - {loads.fluid_pressure[nearest] / 1e5}
        yield _sentence(loads, nearest, problems[nearest], _others("at", others, "bar"))


def _sentence(loads: Loads, number: int, problem: LoadProblem, others: str) -> str:
    pressure, force = loads.points[number]
    several = len({applied_force for _, applied_force in loads.points}) > 1
    at = f"at {pressure / 1e5:.6g} bar" + (f" with {force:.6g} N" if several else "")
    # a seal that opens says itself at which pressure and under which force
    name = "" if problem.kind == "open" else f"{at}: "
    return f"{name}{problem.message}. This load is left out{others}"


def _others(how: str, values: Collection[float], unit: str) -> str:
    return (
        f"; so are those {how} {', '.join(f'{value:.6g}' for value in sorted(values))} {unit}"
        if values
        else ""
    )
