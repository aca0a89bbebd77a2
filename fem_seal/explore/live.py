"""Evaluation of the sliders' design, fast enough to follow a hand.

What is shown of a design depends on it alone, never on the designs before it; what they share is kept: condensed bodies
of the last geometries, and flow conductivities of surfaces of one shape (`fem_seal.seal.sources`). The mesh is that of
`fem-seal run` with rounded sizes and coarser, most inside the bodies and between edges: its numbers are good to the
digits that are shown. Those of `fem-seal run` itself follow when the sliders rest (`fem_seal.explore.worker`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from fem_seal.answers.answer import Request, loads_of
from fem_seal.answers.case_load import SolvedSeal
from fem_seal.answers.opening import OPENING
from fem_seal.answers.solution import SealSolution, answer_parts
from fem_seal.answers.verdict import VERDICT
from fem_seal.explore.screen import Screen, screen_of, shown_load
from fem_seal.seal.cost import load_seconds
from fem_seal.seal.evaluate import SILENT, Evaluation, evaluate_seal
from fem_seal.seal.heating import with_contact_temperatures
from fem_seal.seal.keyed_store import KeyedStore
from fem_seal.seal.load_result import MissingLoad
from fem_seal.seal.problem import SealProblem, problems_of, under_loads
from fem_seal.seal.sources import MeshRounding, SharedBodies
from fem_seal.validity.checks import validity_of

if TYPE_CHECKING:
    from fem_seal.case.case import Case

# Loads of the case that follow a slider, of a liquid and of a gas; the others are there when it rests.
_LIVE_LOADS, _LIVE_LOADS_OF_GAS = 5, 3
# Processor time of a load [s] and pressures of a case below which the curve gets more points, these over the highest.
_FILLS, _FEW, _SHARES = 0.1, 3, (0.2, 0.4, 0.6, 0.8)
# Steps of the sizes in the logarithm to base 2, and how much coarser the elements are than those of a run, chosen for
# its numbers to 4e-4.
SOURCE = SharedBodies(MeshRounding(0.5, 0.5, along=1.41, deep=2.1, touching=1.41, edges=2.0), KeyedStore(96))


def live_screen(case: Case, design: Mapping[str, str]) -> Screen:
    """What is shown of a design while the sliders move.

    Parameters
    ----------
    case : Case
        Of the design.
    design : mapping
        From keys of factors to texts.
    """
    case = with_contact_temperatures(case)
    problems = problems_of(case)
    whole, numbers = problems[0], live_loads(problems[0])
    evaluations, count = solve_live_loads(case, problems, numbers)
    # the interval of every load is as wide as what its checks find
    seal = answer_parts(
        SolvedSeal.of(evaluations, case, loads_of(evaluations)),
        request := Request(evaluations[0].solver, SILENT),
        [OPENING],
    )
    loads = [load.with_values(validity=load.validity_by(validity_of, evaluations)) for load in seal.loads]
    failures = {
        numbers[n]: problem for n, problem in evaluations[0].solved_loads.problems.items() if n < len(numbers)
    }
    missing_loads = [
        MissingLoad(n, *whole.loads.points[n], problem, whole.loads.bolts is not None)
        for n, problem in sorted({**whole.loads.refusals, **failures}.items())
    ]
    seal = answer_parts(
        replace(seal, loads=tuple(loads[:count]), missing_loads=tuple(missing_loads)), request, [VERDICT]
    )
    solution = SealSolution(**vars(seal), answers=request.answers)
    return screen_of(solution, design, curve_loads=tuple(shown_load(load, case) for load in loads[count:]))


def live_loads(whole: SealProblem) -> list[int]:
    """Numbers of the loads that follow the sliders: evenly spread, with the last and the highest.

    Parameters
    ----------
    whole : SealProblem
        With all its loads.
    """
    points = whole.loads.points
    numbers = [number for number in range(len(points)) if number not in whole.loads.refusals]
    limit = _LIVE_LOADS_OF_GAS if _of_gas(whole) else _LIVE_LOADS
    if whole.follows_path or len(numbers) <= limit:
        return numbers
    highest = max(numbers, key=lambda n: points[n])
    steps = (len(numbers) - 1) / (limit - 2)
    return sorted({highest, *(numbers[round(n * steps)] for n in range(limit - 1))})


def solve_live_loads(
    case: Case, problems: Sequence[SealProblem], numbers: Sequence[int]
) -> tuple[tuple[Evaluation, ...], int]:
    """Some loads of a seal, and behind them others that fill the curve; how many with a contact are the case's.

    Parameters
    ----------
    case : Case
    problems : sequence of SealProblem
        Its problems with all loads.
    numbers : sequence of int
        Of the loads.
    """
    whole = problems[0]
    others = [number for number in range(len(whole.loads.points)) if number not in numbers]
    loads = replace(whole.loads.without_loads(others), target_leak_rate=None)
    if load_seconds(case) < _FILLS:
        # of a gas, and of a seal that is not round, each takes several times as long
        shares = _SHARES if whole.form is None and not _of_gas(whole) else (0.5,)
        fill = _fill_curve(loads.points, shares, _FEW if whole.form is None else 1)
        loads = replace(loads, points=(*loads.points, *fill))
    evaluations = evaluate_seal(under_loads(problems, loads), SOURCE)
    return evaluations, len(numbers) - sum(n < len(numbers) for n in evaluations[0].solved_loads.failures)


def _of_gas(problem: SealProblem) -> bool:
    return problem.flow is not None and problem.flow.gas is not None


def _fill_curve(
    points: Sequence[tuple[float, float]], shares: Sequence[float], limit: int
) -> list[tuple[float, float]]:
    """Loads that fill a curve of at most so many pressures; none where the force changes, too."""
    force = points[0][1]
    if len({f for _, f in points}) > 1 or len({pressure for pressure, _ in points}) > limit:
        return []
    highest = max(pressure for pressure, _ in points)
    return [
        (share * highest, force)
        for share in shares
        if all(abs(share * highest - pressure) > 0.08 * highest for pressure, _ in points)
    ]
