"""The same loads with another interface law, and with every reading of the theory."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import TYPE_CHECKING, Literal

from fem_seal.answers.accuracy import Comparison
from fem_seal.answers.answer import Answer
from fem_seal.seal.leak_model import Flow, RoughFlow
from fem_seal.seal.load_result import LoadResult, leak_rates, strongest_load
from fem_seal.seal.load_solver import LoadSolver, solve_load, solve_loads, solved_again
from fem_seal.seal.solved_seal import SolvedSeal

if TYPE_CHECKING:
    from fem_seal.seal.problem import SealProblem
    from leak import RoughContact


# Share of the contact area at which channels close: two-dimensional percolation, and the textbook value.
_THRESHOLDS = (0.42, 0.5)
_WIDTHS: tuple[Literal["effective", "plain"], ...] = ("effective", "plain")


@dataclass(frozen=True)
class TheoryVariant:
    """One reading of the theory and the leak rates that it gives.

    Parameters
    ----------
    plastic : bool or None
        p(u) of the plastically smoothed (True) or of the elastic surface; None if the case gives the law itself.
    conductivity : {"bruggeman", "critical-junction", "threshold-law"}
    separation_width : {"effective", "plain"} or None
        Width of the Gaussians in P(u); None for the critical junction, which needs no P(u).
    percolation_threshold : float
    leak_rate : tuple of float
        At each load [m^3/s].
    used : bool
        Whether it is the one that the case asks for.
    """

    plastic: bool | None
    conductivity: str
    separation_width: str | None
    percolation_threshold: float
    leak_rate: tuple[float, ...]
    used: bool

    @property
    def interface_law(self) -> str:
        """The law in a word."""
        return "given" if self.plastic is None else "plastic" if self.plastic else "elastic"


def theory_variants(result: SolvedSeal) -> tuple[TheoryVariant, ...]:
    """Leak rates of all loads with every reading of the theory: p(u), P(u), percolation threshold, channels.

    Parameters
    ----------
    result : SolvedSeal

    Returns
    -------
    tuple of TheoryVariant
        Empty if nothing leaks for want of roughness or fluid.
    """
    problem = result.problem
    surface, flow = problem.surface, problem.flow
    if surface is None or flow is None:
        return ()
    variants: list[TheoryVariant] = []
    for plastic in _laws(problem, surface):
        loads: Sequence[LoadResult] = result.loads
        if plastic is not None and plastic != problem.interface.plastic:
            loads = _loads(result, _with_law(problem, plastic))
        for reading in _readings(flow, surface):
            rates = _leak_rates(surface, flow, loads, reading)
            used = plastic in (None, problem.interface.plastic) and reading.is_of(flow, surface)
            variants.append(
                TheoryVariant(plastic, reading.conductivity, reading.width, reading.threshold, rates, used)
            )
    return tuple(variants)


def _with_law(problem: SealProblem, plastic: bool) -> SealProblem:
    return replace(problem, interface=replace(problem.interface, plastic=plastic))


def _loads(result: SolvedSeal, problem: SealProblem) -> Sequence[LoadResult]:
    """The loads of a result with another interface law."""
    if result.unloaded is not None:
        contacts = solve_loads(LoadSolver(problem, result.model)).contacts
    else:
        contacts = solved_again(result.contact, result.model, problem.law, result.earlier)
    return [
        LoadResult(*load.point, contact, formed=problem.around(contact))
        for load, contact in zip(result.loads, contacts, strict=True)
    ]


def _laws(problem: SealProblem, surface: RoughContact) -> tuple[bool | None, ...]:
    if problem.interface.law != "spectrum":
        return (None,)
    return (False,) if surface.hardness is None else (False, True)


@dataclass(frozen=True)
class _Reading:
    """How the flow through a rough contact is read: conductivity, width in P(u) and threshold."""

    conductivity: Literal["bruggeman", "critical-junction", "threshold-law"]
    width: Literal["effective", "plain"] | None
    threshold: float

    def is_of(self, flow: Flow, surface: RoughContact) -> bool:
        """Whether it is that of the problem itself."""
        return (
            self.conductivity == flow.conductivity
            and self.width in (None, "effective")
            and self.threshold == surface.percolation_threshold
        )


def _readings(flow: Flow, surface: RoughContact) -> list[_Reading]:
    thresholds = sorted({*_THRESHOLDS, surface.percolation_threshold})
    channels = [_Reading("bruggeman", width, threshold) for width, threshold in product(_WIDTHS, thresholds)]
    if surface.peklenik != 1.0:
        return channels  # the others know no direction
    near = [_Reading("threshold-law", "effective", threshold) for threshold in thresholds]
    return [*channels, *near, *(_Reading("critical-junction", None, threshold) for threshold in thresholds)]


def _leak_rates(
    surface: RoughContact, flow: Flow, loads: Sequence[LoadResult], reading: _Reading
) -> tuple[float, ...]:
    read = replace(flow, conductivity=reading.conductivity)
    surface = replace(
        surface,
        percolation_threshold=reading.threshold,
        separation_width=surface.separation_width if reading.width is None else reading.width,
    )
    (found,) = leak_rates(surface, [read], loads)
    return found


def ratio_to_case(leak_rate: float, of_case: float) -> float:
    """Leak rate over that of the case; NaN where the case is sealed."""
    return leak_rate / of_case if of_case > 0 else float("nan")


def interface_variants(solver: LoadSolver, loads: Sequence[LoadResult]) -> tuple[Comparison, ...]:
    """The load with the largest closing force with p(u) of the elastic and of the plastically smoothed surface."""
    problem = solver.problem
    surface = problem.surface
    if surface is None or surface.hardness is None or problem.interface.law != "spectrum":
        return ()
    if surface.theory != "paper":
        return ()
    strongest = strongest_load(loads)
    load, variants = loads[strongest], []
    # pressures over which the loads have their tables: the same ones serve this contact
    shown = [contact for one in loads for contact in one.contacts]
    for name, plastic in (("elastic p(u)", False), ("plastic p(u)", True)):
        contact, told = load.contact, load
        if plastic != problem.interface.plastic:
            changed = _with_law(problem, plastic)
            if solver.yields:
                contact = solve_load(replace(solver, problem=changed), strongest)
            else:
                (contact,) = solved_again([contact], solver.model, changed.law, solver.earlier)
            formed = changed.around(contact)
            bare = LoadResult(*load.point, contact, formed=formed)
            told = replace(bare, rough=RoughFlow.of(surface, problem.flow, (*shown, *bare.contacts)))
        others = {reading: one.leak.leak_rate for reading, one in told.others.items() if one.leak is not None}
        variants.append(replace(Comparison.of(name, contact, told.leak), others=others))
    return tuple(variants)


INTERFACE_VARIANTS = Answer[tuple[Comparison, ...]](
    "interface_variants",
    "comparison of elastic and plastic interface law",
    lambda seal, ask: interface_variants(ask.solver, seal.loads),
    (),
    doing="comparing elastic and plastic interface law",
    clock="variants",
)
THEORY_VARIANTS = Answer[tuple[TheoryVariant, ...]](
    "theory_variants",
    "leak rates with every reading of the theory",
    lambda seal, ask: theory_variants(seal),
    (),
    lambda seal, wanted: seal.case.leak.variants,
    doing="leak rates with every reading of the theory",
    clock="theory",
)
