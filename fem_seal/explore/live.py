"""From the sliders to what is shown, in the time that a hand takes to move on.

A design is a few texts, "20.5 bar", in place of those of the case. What it shows depends on it alone, never on the
designs before it; what they share is kept: condensed bodies of the last geometries, and flow conductivities of one
family of surfaces (`fem_seal.seal.shared_bodies`). The mesh is that of `fem-seal run` with sizes rounded to powers of
the square root of two, never coarser where the bodies touch, and coarser inside of them: its numbers are good to the
digits that are shown. Those of `fem-seal run` itself follow when the sliders rest (`fem_seal.explore.worker`).
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from threading import RLock
from typing import TYPE_CHECKING, Any

from fem_seal.answers.opening import with_margins
from fem_seal.answers.verdict import seal_judgement, with_judgements
from fem_seal.case.load_limits import refused_loads
from fem_seal.contact.model import ContactModel
from fem_seal.contact.refit import solve_fitted
from fem_seal.contact.solution import ContactSolution
from fem_seal.errors import InputError, SealError
from fem_seal.explore.factors import Factors, factors_of, opened
from fem_seal.explore.screen import Screen, profile_of, screen_of, section_of, shown_load, without_leak
from fem_seal.explore.tables import Missing, TableName, conductivity
from fem_seal.seal.leak_model import Flow, RoughFlow, log_peaks
from fem_seal.seal.load_result import LoadResult, highest_load
from fem_seal.seal.load_solver import LoadSolver
from fem_seal.seal.problem import SealProblem, condensed, sizing
from fem_seal.seal.shared_bodies import Rounding, rounded, with_shared_law
from fem_seal.validity.by_table import validity_by_table
from leak import LeakError, RoughContact
from meshes import MeshesError, Sizing, build_contact

if TYPE_CHECKING:
    from fem_seal.case.case import Case
    from fem_seal.seal.leak_model import Conductivity

# Loads of the case that follow a slider; the others are there when it rests.
_LIVE_LOADS = 5
# Pressures of a case below which the curve gets more points, and these over the highest.
_FEW, _SHARES = 3, (0.2, 0.4, 0.6, 0.8)
# Of a gas each takes several times as long.
_LIVE_LOADS_OF_GAS, _SHARES_OF_GAS = 3, (0.5,)
# Steps of the sizes in the logarithm to base 2, and how much faster the elements grow into the bodies and along the
# faces than those of a run: its numbers to 2e-4.
_ROUNDING = Rounding(step=0.5, reach_step=0.5, along=1.41, deep=2.1)
_MODELS, _TABLES = 96, 2048
# Stops between two designs for which things are made ahead.
_AHEAD = 4
# What can go wrong with a design: it is said on the page, which goes on.
WRONG = (SealError, LeakError, MeshesError, ValueError, RuntimeError, ArithmeticError)


@dataclass(frozen=True)
class ModelName:
    """Name of condensed bodies: what of a design decides them.

    Parameters
    ----------
    dimensions : tuple
        Keys and texts of the dimensions.
    sizing : Sizing
    warm : str
        Stiffness of the bodies and what warms them, which follow from their temperature.
    """

    dimensions: tuple[tuple[str, str], ...]
    sizing: Sizing
    warm: str = ""


class Kept:
    """Bodies and tables, the latest of each."""

    def __init__(self) -> None:
        self._models: OrderedDict[Hashable, ContactModel] = OrderedDict()
        self._tables: OrderedDict[Hashable, Conductivity] = OrderedDict()
        self._lock = RLock()

    def get(self, name: Hashable) -> Any:
        """What is kept under a name; None if nothing is."""
        with self._lock:
            place = self._place(name)
            if name in place:
                place.move_to_end(name)
            return place.get(name)

    def put(self, name: Hashable, made: Any) -> None:
        """Keep something."""
        with self._lock:
            place = self._place(name)
            place[name] = made
            while len(place) > (_MODELS if place is self._models else _TABLES):
                place.popitem(last=False)

    def _place(self, name: Hashable) -> OrderedDict[Hashable, Any]:
        return self._models if isinstance(name, ModelName) else self._tables


class Session:
    """A case with its sliders, and what has been made for them.

    Parameters
    ----------
    case : Case
    waits : bool
        Whether a table that is missing is made at once, instead of leaving the leak rate open.

    Examples
    --------
    >>> import fem_seal
    >>> case = fem_seal.Case(
    ...     closure={"shape": "ball", "radius": "20 mm", "material": "steel"},
    ...     seat={"shape": "cone", "angle": "45 deg", "material": "steel"},
    ...     interface={"law": "smooth"},
    ...     load={"fluid_pressure": "20 bar"},
    ... )
    >>> session = Session(case)
    >>> screen = session.answer({"fluid_pressure": "40 bar"})
    >>> round(screen.load.values["peak_pressure_Pa"] / 1e6)
    271
    """

    def __init__(self, case: Case, *, waits: bool = True) -> None:
        self.given = case
        self.base = opened(case)
        self.waits = waits
        self.kept = Kept()
        # contacts of the last design, for when a table that it waits for is there
        self._last: tuple[dict[str, str], SealProblem, int, list[LoadResult]] | None = None

    @cached_property
    def factors(self) -> Factors:
        """What can be moved."""
        return factors_of(self.base)

    @cached_property
    def not_live(self) -> str:
        """Why nothing but complete runs can be shown; empty if the sliders can be followed."""
        case = self.base
        if any(body.material.hardening is not None for body in (case.closure, case.seat)):
            return "A body yields: each change takes a complete run."
        if case.load.closing == "penetration":
            return "The fluid gets between the surfaces: each change takes a complete run."
        if case.leak.conductivity == "direct":
            return "The surface is simulated directly: each change takes a complete run."
        return ""

    @property
    def one_shape(self) -> bool:
        """Whether the sliders leave the shape of the spectrum as it is, but for a few steps of a finish's cutoff."""
        roughness = self.base.roughness
        return roughness is None or len({id(part) for part in roughness.parts.values()}) == 1

    def design(self, design: Mapping[str, str]) -> dict[str, str]:
        """A design with all that it leaves out."""
        own = self.factors.given
        return own | {key: text.strip() for key, text in design.items() if key in own}

    def case(self, design: Mapping[str, str]) -> Case:
        """The case of a design.

        Raises
        ------
        InputError
            If a value cannot be used; it says which and why.
        """
        changes = self.factors.changes(self.base, self.design(design))
        return self.base.replace_written(changes) if changes else self.base

    def answer(self, design: Mapping[str, str]) -> Screen:
        """What is shown of a design while the sliders move.

        Parameters
        ----------
        design : mapping
            From keys of factors to texts; what is missing is that of the case.

        Returns
        -------
        Screen
            With its problem in words where the design cannot be calculated.
        """
        design = self.design(design)
        try:
            case = self.case(design)
            section = section_of(case)
            if self.not_live:
                return Screen(design, section=section, waiting=self.not_live)
            return self._answer(design, case)
        except InputError as error:
            return Screen(
                design,
                problem="; ".join(str(one) for one in error.problems),
                wrong={key: one.message for one in error.problems if (key := self.factors.named(one.key))},
            )
        except WRONG as error:
            return Screen(design, problem=str(error))

    def _answer(self, design: dict[str, str], case: Case) -> Screen:
        if self._last is None or self._last[0] != design:
            problem, own = self._problem(case)
            self._last = design, problem, own, self._contacts(design, problem)
        _, problem, own, loads = self._last
        try:
            found = self._with_leak(problem, loads)
        except Missing:
            number = highest_load(loads[:own])
            return Screen(
                design,
                tuple(without_leak(load) for load in loads[:own]),
                number,
                profile_of(loads[number]),
                section_of(case),
                waiting="the flow conductivity of this surface",
            )
        remarks = (
            ()
            if case.form is None
            else ("Shown is the round seal; its form error follows when the sliders rest.",)
        )
        between = tuple(shown_load(case, load) for load in found[own:])
        found = self._with_validity(case, problem, found, own)
        judged = with_judgements(case, found[:own])
        points = dict(enumerate(case.load.points))
        missing = {points[number]: one for number, one in refused_loads(case).items()}
        judgement = seal_judgement(case, judged, missing, problem.hardness)
        return screen_of(case, design, judged, judgement, warnings=remarks, between=between)

    def _problem(self, case: Case) -> tuple[SealProblem, int]:
        """The problem of a design with the loads that follow the sliders, round, and how many of them are the case's.

        Those behind them only fill the curve.
        """
        whole = SealProblem.of(case)
        left = [number for number in range(len(whole.loads.points)) if number not in whole.loads.refused]
        gas = whole.flow is not None and whole.flow.gas is not None
        kept = _few(left, whole, _LIVE_LOADS_OF_GAS if gas else _LIVE_LOADS)
        gone = [number for number in range(len(whole.loads.points)) if number not in kept]
        loads = whole.loads.without(gone)
        own = len(loads.points)
        loads = replace(loads, points=(*loads.points, *_between(loads.points, gas)))
        problem = replace(whole, loads=loads, form=None)
        return with_shared_law(problem), own

    def _contacts(self, design: Mapping[str, str], problem: SealProblem) -> list[LoadResult]:
        """Contacts of all loads that follow the sliders, on bodies that neighbouring designs share."""
        points = problem.loads.points
        order = sorted(range(len(points)), key=lambda n: points[n], reverse=True)
        found: dict[int, ContactSolution] = {}
        solvers: list[LoadSolver] = []

        def solve_on(wanted: Sizing) -> Sequence[ContactSolution]:
            solvers.append(LoadSolver(problem, self._model(design, problem, wanted)))
            start = None
            for number in order:
                found[number] = solvers[-1].solve(*points[number], start=start)
                start = found[number].first_loading
            return [found[number] for number in sorted(found)]

        size_given = problem.contact_size is not None
        solve_fitted(sizing(problem), problem.contact, solve_on, size_given=size_given)
        loads = [LoadResult(*points[number], found[number]) for number in range(len(points))]
        solver, opens = solvers[-1], problem.loads.pressure_side == "inner"
        if opens:
            loads = [
                load.knowing(blow_off_pressure=solver.blow_off_pressure(load.applied_force)) for load in loads
            ]
        return list(with_margins(solver, loads))

    def _model_name(self, design: Mapping[str, str], problem: SealProblem, wanted: Sizing) -> ModelName:
        dimensions = tuple(
            (one.key, design[one.key]) for one in self.factors.sliders if one.group == "dimension"
        )
        stiffness = [(one.youngs_modulus, one.poissons_ratio) for one in problem.materials.values()]
        exact = problem.contact_size is not None
        wanted = rounded(wanted, problem.contact, exact_size=exact, rounding=_ROUNDING)
        return ModelName(dimensions, wanted, repr((stiffness, problem.heating)))

    def _model(self, design: Mapping[str, str], problem: SealProblem, wanted: Sizing) -> ContactModel:
        name = self._model_name(design, problem, wanted)
        known: ContactModel | None = self.kept.get(name)
        if known is None:
            known = made_model(problem, name.sizing)
            self.kept.put(name, known)
        return known

    def _with_validity(
        self, case: Case, problem: SealProblem, loads: list[LoadResult], own: int
    ) -> list[LoadResult]:
        """Loads of which those have been checked that are shown or judged."""
        required, shown = case.requirement, highest_load(loads[:own])
        return [
            load.knowing(validity=validity_by_table(_elastic_bodies(problem), load))
            if number == shown or (number < own and required and required.judges(load.fluid_pressure))
            else load
            for number, load in enumerate(loads)
        ]

    def _with_leak(self, problem: SealProblem, loads: list[LoadResult]) -> list[LoadResult]:
        """Loads with leak rate in both readings."""
        contacts = [load.contact for load in loads]
        rough = RoughFlow.of(problem.surface, problem.flow, contacts)
        if rough is not None:
            peak = max(log_peaks(contacts))
            rough = replace(rough, make=partial(self._table, peak=peak))
        found = [load.knowing(rough=rough) for load in loads]
        for load in found:
            _ = load.leak, load.leak_range
        return found

    def _table(self, flow: Flow, surface: RoughContact, peak: float) -> Conductivity:
        known = self._made_table if self.waits else self.kept.get
        return conductivity(flow, surface, peak, known, family=self.one_shape)

    def _made_table(self, name: TableName) -> Conductivity:
        known: Conductivity | None = self.kept.get(name)
        if known is None:
            known = name.made()
            self.kept.put(name, known)
        return known

    def needs(self, design: Mapping[str, str]) -> Iterator[Hashable]:
        """Names of what a design needs and is not there yet, each to be made before the next is asked for."""
        if self.not_live:
            return
        design = self.design(design)
        try:
            problem = self._problem(self.case(design))[0]
            name = self._model_name(design, problem, sizing(problem))
            if self.kept.get(name) is None:
                yield name
            if problem.surface is None or problem.flow is None:
                return
            peak = max(log_peaks([load.contact for load in self._contacts(design, problem)]))
            for one in map(problem.surface.reading, problem.surface.readings):
                try:
                    conductivity(problem.flow, one, peak, self.kept.get, family=self.one_shape)
                except Missing as missing:
                    yield from missing.keys
        except WRONG:
            return

    def make(self, name: Hashable, design: Mapping[str, str]) -> Any:
        """Make what a design needs, and keep it."""
        if isinstance(name, ModelName):
            known = made_model(self._problem(self.case(design))[0], name.sizing)
            self.kept.put(name, known)
            return known
        assert not isinstance(name, (str, int))
        return self._made_table(name)  # type: ignore[arg-type]

    def neighbours(self, design: Mapping[str, str]) -> Iterator[dict[str, str]]:
        """Designs that one slider away from a design, the nearest first: those of loads and surfaces."""
        design = self.design(design)
        yield dict(design)
        sliders = [one for one in self.factors.sliders if one.group != "dimension"]
        step = _AHEAD if self.one_shape else 1
        for away in range(1, max(len(one.stops) for one in sliders) // step + 1):
            for one in sliders:
                at = one.nearest(design[one.key])
                for place in (at + away * step, at - away * step):
                    if 0 <= place < len(one.stops):
                        yield {**design, one.key: one.stops[place]}


def _few(numbers: Sequence[int], problem: SealProblem, most: int) -> set[int]:
    """At most so many of some loads, evenly spread, with the last and the highest."""
    if len(numbers) <= most:
        return set(numbers)
    points = problem.loads.points
    highest = max(numbers, key=lambda n: points[n])
    steps = (len(numbers) - 1) / (most - 2)
    return {highest, *(numbers[round(n * steps)] for n in range(most - 1))}


def _between(points: Sequence[tuple[float, float]], gas: bool) -> list[tuple[float, float]]:
    """Loads that fill a curve of few points over the fluid pressure; none where the force changes, too."""
    force = points[0][1]
    if len({applied for _, applied in points}) > 1 or len({pressure for pressure, _ in points}) > _FEW:
        return []
    highest = max(pressure for pressure, _ in points)
    filled = (share * highest for share in (_SHARES_OF_GAS if gas else _SHARES))
    return [
        (pressure, force)
        for pressure in filled
        if all(abs(pressure - other) > 0.08 * highest for other, _ in points)
    ]


def made_model(problem: SealProblem, wanted: Sizing) -> ContactModel:
    """Condensed bodies without the way to stresses inside of them, which takes far more memory.

    Parameters
    ----------
    problem : SealProblem
    wanted : Sizing
    """
    full = condensed(_elastic_bodies(problem), build_contact(problem.contact, wanted))
    return replace(full, closure=full.closure.line_alone, seat=full.seat.line_alone)


def _elastic_bodies(problem: SealProblem) -> SealProblem:
    """The problem with bodies whose yield stress is not known: stresses take a complete run."""
    materials = {name: replace(one, yield_stress=None) for name, one in problem.materials.items()}
    return replace(problem, materials=materials)
