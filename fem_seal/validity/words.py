"""Texts of findings, from templates/findings.toml."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Literal

from fem_seal.errors import LoadProblem
from fem_seal.files import own_tables
from fem_seal.seal.findings import EXACT, Bounds, Finding, Level
from fem_seal.seal.load_result import LoadResult, load_name
from fem_seal.seal.problem import Loads
from fem_seal.units import fill_sentence, short_quantity


def caution(
    name: str,
    load: LoadResult | None = None,
    loads: Sequence[LoadResult] = (),
    /,
    *,
    outside: bool = False,
    leak_factor: Bounds = EXACT,
    found: bool = True,
    told: bool = True,
    **values: object,
) -> Finding:
    """A caution with the texts of its entry.

    A factor of known size on the leak rate is in the interval and is no doubt.

    Parameters
    ----------
    name : str
        Of the entry, which has kind, reason and text, and leak_only where it is about the leak rate alone.
    load, loads
        The load that it is about, and all loads, among which its name is unique.
    outside : bool
        Whether it puts the numbers outside the theory.
    leak_factor
        See `Finding`.
    found : bool
        Whether its size was found, in measurements or simulations, and is no guess.
    told : bool
        Whether its number is above the limit from which on it is told; the factor fades in before, see `fading`.
    **values
        Values for the braces of the texts.
    """
    if load is not None:
        values["where"] = load_name(load, loads)
    kind, reason, text = (sentence(name, part, **values) for part in ("kind", "reason", "text"))
    leak_only = "leak_only" in own_tables("findings.toml")[name]
    if not told:
        return Finding(kind, Level.VALID, reason, "", leak_factor, of_contact=not leak_only)
    held = (
        leak_only and found and leak_factor != EXACT and 0.0 < leak_factor.low <= leak_factor.high < math.inf
    )
    level = Level.OUTSIDE if outside else Level.VALID if held else Level.DOUBTFUL
    return Finding(kind, level, reason, text, leak_factor, of_contact=not leak_only)


def fading(leak_factor: Bounds, over: float) -> Bounds:
    """Factors that fade in from half of the limit on: with a step there the interval would jump.

    Parameters
    ----------
    leak_factor : Bounds
    over : float
        The number of a caution over the limit from which on it is told.
    """
    share = min(max(2.0 * over - 1.0, 0.0), 1.0)
    return Bounds(leak_factor.low**share, leak_factor.high**share)


def sentence(name: str, part: str = "text", /, **values: object) -> str:
    """A sentence of an entry, its values filled in.

    Parameters
    ----------
    name, part : str
    **values
        Values for the braces of the texts.
    """
    words: str = own_tables("findings.toml")[name][part]
    return fill_sentence(words, values)


def why_missing(problem: LoadProblem) -> str:
    """Why a load could not be calculated, in a clause.

    Parameters
    ----------
    problem : LoadProblem
    """
    return sentence("why_not_calculated", problem.kind, problem=problem)


def not_calculated(loads: Loads, problems: Mapping[int, LoadProblem]) -> Iterator[Finding]:
    """Which loads have no result: one sentence for each reason and force, or for all forces under one pressure.

    Parameters
    ----------
    loads : Loads
    problems : mapping
        Number of each load that could not be calculated, with the reason.
    """
    for kind in dict.fromkeys(problem.kind for problem in problems.values()):
        # they do not concern the remaining loads
        yield from _findings_of_kind(
            loads, {number: one for number, one in problems.items() if one.kind == kind}, kind
        )


def _findings_of_kind(loads: Loads, problems: Mapping[int, LoadProblem], kind: str) -> Iterator[Finding]:
    """Findings about loads with one kind of problem, each with the reason of the load that is nearest to a result."""
    points = {number: loads.points[number] for number in problems}
    # the one with the lowest pressure; of an open seal that with the largest force; without a solution the first
    direction = {"open": -1, "strain": 1}.get(kind, 0)
    if len(set(loads.fluid_pressure)) == 1:
        nearest = min(points, key=lambda number: direction * points[number][1])
        forces = [force for _, force in points.values()]
        yield _finding_of_loads(loads, nearest, problems[nearest], "with", forces)
        return
    for applied_force in dict.fromkeys(force for _, force in points.values()):
        numbers = [number for number, (_, force) in points.items() if force == applied_force]
        nearest = min(numbers, key=lambda number: abs(direction) * loads.fluid_pressure[number])
        pressures = [loads.fluid_pressure[number] for number in numbers]
        yield _finding_of_loads(loads, nearest, problems[nearest], "at", pressures)


def _finding_of_loads(
    loads: Loads, number: int, problem: LoadProblem, how: Literal["with", "at"], values: Collection[float]
) -> Finding:
    """A finding about the loads with these forces, or at these pressures and with one force."""
    pressure, force = loads.points[number]
    several = len({applied_force for _, applied_force in loads.points}) > 1
    load = sentence("not_calculated", "load_of_forces" if several else "load", pressure=pressure, force=force)
    kind, own = ("force", force) if how == "with" else ("fluid pressure", pressure)
    names = [short_quantity(kind, value) for value in sorted(set(values))]
    with_force = sentence("not_calculated", "of_force", force=force) if several and how == "at" else ""
    others = ", ".join(short_quantity(kind, value) for value in sorted(set(values) - {own}))
    return caution(
        "not_calculated",
        # the message of an open seal has its pressure and force already
        load="" if problem.kind == "open" else load,
        problem=problem,
        names=f"{few_words(names)}{with_force}",
        why=why_missing(problem),
        others=sentence("not_calculated", how, values=others) if others else "",
    )


# So many names are told.
_FEW = 3


def few_words(names: Sequence[str]) -> str:
    """Names with commas between them, of many the first two and how many more there are.

    Parameters
    ----------
    names : sequence of str
    """
    if len(names) <= _FEW:
        return ", ".join(names)
    return f"{', '.join(names[: _FEW - 1])} and {len(names) - _FEW + 1} more"
