"""Evaluation of the sliders' design, fast enough to follow a hand.

A design is a few texts, "20.5 bar", in place of those of the case. What it shows depends on it alone, never on the
designs before it; what they share is kept: condensed bodies of the last geometries, and flow conductivities of one
family of surfaces (`fem_seal.seal.sources`). The mesh is that of `fem-seal run` with sizes rounded to powers of
the square root of two and coarser, most inside the bodies and between edges: its numbers are good to the digits
that are shown. Those of `fem-seal run` itself follow when the sliders rest (`fem_seal.explore.worker`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, TypeAlias

from fem_seal.answers.answer import Inquiry, answered
from fem_seal.answers.case_load import SolvedSeal, case_loads, solved_seal
from fem_seal.answers.opening import OPENING
from fem_seal.answers.solution import SealSolution
from fem_seal.answers.verdict import VERDICT, Judgements, seal_judgement, with_judgements
from fem_seal.case.load_limits import refused_loads
from fem_seal.explore.screen import Screen, profile_of, screen_of, section_of, shown_load
from fem_seal.seal.conductivity_tables import FamilyTable, family_table, family_tables
from fem_seal.seal.cost import load_seconds
from fem_seal.seal.evaluate import SILENT, Evaluation, evaluate
from fem_seal.seal.heating import warmed
from fem_seal.seal.kept import Kept
from fem_seal.seal.leak_model import MARGIN, Conductivity, FlowModel, theory_table
from fem_seal.seal.load_result import by_face, highest_load
from fem_seal.seal.problem import SealProblem, sizing
from fem_seal.seal.sources import Bodies, Rounding, Shared
from fem_seal.validity.checks import validity_of
from leak import RoughContact

if TYPE_CHECKING:
    from fem_seal.case.case import Case

# Loads of the case that follow a slider; the others are there when it rests.
_LIVE_LOADS = 5
# Processor time of a load [s] and pressures of a case below which the curve gets more points, these over the highest.
_FILLS, _FEW, _SHARES = 0.1, 3, (0.2, 0.4, 0.6, 0.8)
# Of a gas, and of a seal that is not round, each takes several times as long.
_LIVE_LOADS_OF_GAS, _SHARES_OF_GAS = 3, (0.5,)
# Steps of the sizes in the logarithm to base 2, and how much coarser the elements are than those of a run, chosen for
# its numbers to 4e-4.
_ROUNDING = Rounding(step=0.5, reach_step=0.5, along=1.41, deep=2.1, touching=1.41, edges=2.0)
_MODELS, _TABLES = 96, 2048
# Decades below the peak pressure over which a table of one surface alone reaches.
_DECADES = 9


class Missing(Exception):
    """Something that is not there yet and takes longer than a slider may.

    Parameters
    ----------
    keys : sequence
        Names of what is missing.
    """

    def __init__(self, keys: Sequence[Hashable]) -> None:
        super().__init__(f"{len(keys)} tables are not there yet")
        self.keys = tuple(keys)


@dataclass(frozen=True)
class OwnTable:
    """Name of a table of one surface alone, over whole decades of pressure.

    Parameters
    ----------
    surface : RoughContact
    low, high : int
        Decimal logarithms of the pressures [Pa].
    gas : bool
    """

    surface: RoughContact
    low: int
    high: int
    gas: bool

    def made(self) -> Conductivity:
        """The table."""
        low, high = 10.0**self.low, 10.0**self.high
        return theory_table(self.surface, low, high, None, of_gas=self.gas)


TableName: TypeAlias = FamilyTable | OwnTable


def conductivity(
    flow: FlowModel,
    surface: RoughContact,
    log_peak: float,
    known: Callable[[TableName], Conductivity | None],
    *,
    family: bool = True,
) -> Conductivity:
    """Flow conductivity of a surface, for liquids and gases, from tables that are kept.

    Parameters
    ----------
    flow : FlowModel
    surface : RoughContact
    log_peak : float
        Decimal logarithm of the highest pressure [Pa].
    known : callable
        Gives a table, or None if it is not there.
    family : bool
        Whether surfaces that follow have the same shape of spectrum, and tables of that shape are worth while.

    Raises
    ------
    Missing
        If one of them is not there.
    """
    names: Sequence[TableName]
    if family:
        names = family_tables(flow, surface)
    else:
        low, high = math.floor(log_peak - _DECADES), math.ceil(log_peak + MARGIN)
        names = (OwnTable(surface, low, high, flow.gas is not None),)
    found = {name: known(name) for name in names}
    tables = [table for table in found.values() if table is not None]
    if missing := [name for name in found if found[name] is None]:
        raise Missing(missing)
    made = family_table(flow, surface, tables) if family else tables[0]
    assert made is not None  # a simulation is not followed live
    return made


class Live:
    """What the designs of a case share, and the answers that are calculated with it.

    Parameters
    ----------
    one_shape : bool
        Whether all designs have spectra of one shape, so that tables of that shape are worth while.
    like : Live, optional
        Of another case, whose bodies and tables serve this one, too.
    """

    def __init__(self, *, one_shape: bool, like: Live | None = None) -> None:
        self.one_shape = one_shape
        self.bodies: Kept = Kept(_MODELS) if like is None else like.bodies
        self.tables: Kept = Kept(_TABLES) if like is None else like.tables
        # contacts of the last design, for when a table that it waits for is there
        self._last: tuple[dict[str, str], Evaluation, SolvedSeal, int] | None = None

    def answer(self, design: dict[str, str], case: Case, *, waits: bool) -> Screen:
        """What is shown of a design.

        Parameters
        ----------
        design : dict
        case : Case
            Of the design.
        waits : bool
            Whether a table that is missing is made at once, instead of leaving the leak rate open.
        """
        case = warmed(case)
        if self._last is None or self._last[0] != design:
            found, own = self._evaluated(case, waits)
            self._last = design, found, solved_seal(found, case), own
        _, found, seal, own = self._last
        number = highest_load(seal.loads[:own])
        try:
            for load in seal.loads:
                _ = load.leak, load.leak_range
        except Missing:
            return Screen(
                design,
                tuple(shown_load(load) for load in seal.loads[:own]),
                number,
                profile_of(seal.loads[number], case),
                section_of(case),
                waiting="the flow conductivity of this surface",
            )
        seal = answered(seal, Inquiry(found.solver, SILENT), [OPENING])
        # the interval of every load is as wide as what its checks find
        loads = [load.with_values(validity=validity_of(found, load)) for load in seal.loads]
        judged, between = with_judgements(case, loads[:own]), loads[own:]
        missing = {case.load.points[n]: one for n, one in refused_loads(case).items()} | found.missing
        # the page calculates by the theory of its case alone
        verdict = Judgements(seal_judgement(case, judged, missing, found.problem.hardness))
        solution = SealSolution(**vars(seal.with_loads(judged)), answers={VERDICT.name: verdict})
        return screen_of(solution, design, between=tuple(shown_load(load, case) for load in between))

    def problem(self, case: Case) -> tuple[SealProblem, int]:
        """The problem of a design with the loads that follow the sliders, and how many of them are the case's.

        Those behind them only fill the curve.
        """
        whole = SealProblem.of(case)
        left = [number for number in range(len(whole.loads.points)) if number not in whole.loads.refused]
        gas = whole.flow is not None and whole.flow.gas is not None
        kept = (
            left
            if whole.follows_path
            else _evenly_spread(left, whole, _LIVE_LOADS_OF_GAS if gas else _LIVE_LOADS)
        )
        gone = [number for number in range(len(whole.loads.points)) if number not in kept]
        loads = replace(whole.loads.without(gone), target_leak_rate=None)
        own = len(loads.points)
        if load_seconds(case) < _FILLS:
            shares = _SHARES if case.form is None and not gas else _SHARES_OF_GAS
            most = _FEW if case.form is None else 1
            loads = replace(loads, points=(*loads.points, *_between(loads.points, shares, most)))
        return replace(whole, loads=loads), own

    def _evaluated(self, case: Case, waits: bool) -> tuple[Evaluation, int]:
        """All loads that follow the sliders, and how many of those with a contact are the case's."""
        problem, own = self.problem(case)
        made = (lambda name: self.tables.get(name, name.made)) if waits else self.tables.known
        found = evaluate(problem, self._source(made))
        return found, own - sum(number < own for number in found.solved.failures)

    def _source(self, known: Callable[[TableName], Conductivity | None]) -> Shared:
        """Bodies and tables that are kept here."""

        def table(flow: FlowModel, surface: RoughContact, log_peaks: Sequence[float]) -> Conductivity:
            if flow.simulated is not None:
                return flow.table_around(surface, log_peaks)
            return conductivity(flow, surface, max(log_peaks), known, family=self.one_shape)

        return Shared(_ROUNDING, self.bodies, table)

    def needs(self, case: Case) -> Iterator[Hashable]:
        """Names of what a case needs and is not there yet, each to be made before the next is asked for."""
        source = self._source(self.tables.known)
        problem, _ = self.problem(warmed(case))
        if source.suited(problem) is not source:
            return
        for half in problem.halves:
            name = Bodies.of(half, sizing(half), _ROUNDING)
            if self.bodies.known(name) is None:
                yield name
        for load, *_ in by_face(case_loads(problem, evaluate(problem, source).loads)):
            for one in (load, *load.others.values()):
                try:
                    _ = one.rough and one.rough.table
                except Missing as missing:
                    yield from missing.keys

    def make(self, name: Hashable) -> Any:
        """Make what a design needs, and keep it."""
        made = name.made_light() if isinstance(name, Bodies) else name.made()  # type: ignore[attr-defined]
        self.keep(name, made)
        return made

    def keep(self, name: Hashable, made: Any) -> None:
        """Keep what was made elsewhere."""
        (self.bodies if isinstance(name, Bodies) else self.tables).put(name, made)


def _evenly_spread(numbers: Sequence[int], problem: SealProblem, most: int) -> set[int]:
    """At most so many of some loads, evenly spread, with the last and the highest."""
    if len(numbers) <= most:
        return set(numbers)
    points = problem.loads.points
    highest = max(numbers, key=lambda n: points[n])
    steps = (len(numbers) - 1) / (most - 2)
    return {highest, *(numbers[round(n * steps)] for n in range(most - 1))}


def _between(
    points: Sequence[tuple[float, float]], shares: Sequence[float], most: int
) -> list[tuple[float, float]]:
    """Loads that fill a curve of at most so many pressures; none where the force changes, too."""
    force = points[0][1]
    if len({applied for _, applied in points}) > 1 or len({pressure for pressure, _ in points}) > most:
        return []
    highest = max(pressure for pressure, _ in points)
    return [
        (share * highest, force)
        for share in shares
        if all(abs(share * highest - other) > 0.08 * highest for other, _ in points)
    ]
