"""Which loads have no result, and why: one sentence for each reason."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from typing import TYPE_CHECKING

from fem_seal.seal.findings import Caution, Level

if TYPE_CHECKING:
    from fem_seal.errors import LoadProblem
    from fem_seal.seal.problem import Loads


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
