"""Scenarios: one seal in one state of knowledge, and those that belong beside the seal of a case."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import leak
from fem_seal.files import own_tables
from fem_seal.seal.load_result import on_new_surfaces
from leak import Reading
from leak.theory.plasticity import READINGS

if TYPE_CHECKING:
    from fem_seal.seal.leak_model import FlowModel, LeakModel
    from fem_seal.seal.load_result import LoadResult
    from fem_seal.seal.problem import SealProblem
    from leak import Gas
    from leak.flow.turned_contact import FaceContact


TEST_GAS = "test gas"
"""Name of the scenario in which the gas of the standards' tests leaks."""
FIRST_LOADING = "first loading"
"""Name of the scenario in which no place has carried more before."""

# The gases that the standards test with, at 5 to 40 °C (ISO 5208) [K], and what stands for them.
TEST_GASES, TEST_TEMPERATURES, ROOM_TEMPERATURE = ("air", "nitrogen"), (278.15, 313.15), 293.15


@dataclass(frozen=True)
class ScenarioWords:
    """What a scenario is called where, and what becomes of its numbers.

    Parameters
    ----------
    in_interval : bool
        Whether its leak rate belongs in the interval.
    own_contact : bool
        Whether its contacts are its own, on the same bodies; else they are those of the seal beside which it stands,
        and only what leaks through them is another.
    has_interval : bool
        Whether its own interval is asked for, with the scenarios of which that is made.
    columns : tuple of str
        Kinds of its columns.
    asperities : str
        A noun, such as "elastic asperities"; only where its leak rate is worked out with every load.
    curve : str
        In the legend of a picture.
    condition : str
        A clause that begins with "if"; only of scenarios whose numbers stand beside wherever one is told.
    taken : str
        What a number is calculated with.
    title : str
        Behind "leak rate, " on an axis.
    in_headline : bool
        Whether the headline of the report tells it.
    """

    in_interval: bool = False
    own_contact: bool = False
    has_interval: bool = False
    columns: tuple[str, ...] = ()
    asperities: str = ""
    curve: str = ""
    condition: str = ""
    taken: str = ""
    title: str = ""
    in_headline: bool = False


SCENARIOS = {name: ScenarioWords(**words) for name, words in own_tables("scenarios.toml").items()}
BESIDE = tuple(name for name, words in SCENARIOS.items() if "force" in words.columns)
"""Scenarios whose numbers stand beside those of the case wherever they are told."""
IN_INTERVAL = tuple(name for name, words in SCENARIOS.items() if words.in_interval and words.columns)
"""Those with a column of which the interval is made."""


def leak_rate_column(scenario: str) -> str:
    """Column of the leak rate in a scenario.

    Parameters
    ----------
    scenario : str
        Its name.
    """
    return f"leak_rate_{scenario}_m3_per_s"


@dataclass(frozen=True)
class Scenario:
    """One seal in one state of knowledge: one theory, one surface, one fluid, one history.

    Parameters
    ----------
    name : str
        By which its number, its column and its words are found, such as "capped" or "test gas".
    problem : SealProblem
        Whose surface, flow and loads are those of the scenario.
    """

    name: str
    problem: SealProblem

    def on_contacts(
        self, loads: Sequence[LoadResult], prepare: Callable[[LeakModel], LeakModel] = lambda model: model
    ) -> list[LoadResult]:
        """What leaks in this scenario through the contacts of some loads; a load itself where nothing else does.

        Parameters
        ----------
        loads : sequence of LoadResult
            Of the seal beside which the scenario stands.
        prepare : callable
            Given the surfaces and the fluid of the scenario, once for all loads that share them.
        """
        if self.name == FIRST_LOADING:
            return list(map(on_new_surfaces, loads))
        models: dict[int, LeakModel] = {}
        for load in loads:
            if load.rough is not None and id(load.rough) not in models:
                models[id(load.rough)] = prepare(self._leak_model(load.rough))
        return [load if load.rough is None else replace(load, rough=models[id(load.rough)]) for load in loads]

    def _leak_model(self, seal_model: LeakModel) -> LeakModel:
        """With tables over the same pressures as those of the seal beside which the scenario stands."""
        assert self.problem.surface is not None  # of what leaks
        return replace(seal_model, surface=self.problem.surface, flow=self.problem.flow)


def alternatives_on_contact(problem: SealProblem) -> Iterator[Scenario]:
    """Those that share the contacts of a problem: other surfaces, the ends of a simulation, the gas of the tests.

    Parameters
    ----------
    problem : SealProblem
    """
    surface, flow = problem.surface, problem.flow
    if surface is None:
        return
    is_simulated = flow is not None and flow.direct is not None
    for reading in () if is_simulated else surface.readings:
        if (variant := surface.reading(reading)) is not surface:
            yield Scenario(str(reading), replace(problem, surface=variant))
    elastic, of_elastic = surface.elastic, None if flow is None else flow.elastic
    # of a turned face nobody waits as long again for crests that never yield
    is_told = not (is_simulated and isinstance(surface, leak.TurnedContact))
    if is_told and (elastic is not surface or of_elastic is not flow):
        yield Scenario(str(Reading.ELASTIC), replace(problem, surface=elastic, flow=of_elastic))
    if flow is None:
        return
    for end, name in {-1: "least simulated", 1: "most simulated"}.items() if is_simulated else ():
        yield Scenario(name, replace(problem, flow=replace(flow, end=end)))
    if (test_flow := with_test_gas(flow)) is not flow:
        yield Scenario(TEST_GAS, replace(problem, flow=test_flow))
    if surface.hardness is not None:
        yield Scenario(FIRST_LOADING, replace(problem, loads=problem.loads.on_new_surfaces))


def problem_in(problem: SealProblem, name: str) -> SealProblem:
    """A problem in one of `alternatives_on_contact`; itself where there is none of that name.

    Parameters
    ----------
    problem : SealProblem
    name : str
        Of the scenario.
    """
    problems = (scenario.problem for scenario in alternatives_on_contact(problem) if scenario.name == name)
    return next(problems, problem)


def with_own_contacts(problem: SealProblem) -> Iterator[Scenario]:
    """Those by the theories of the rough contact that a problem does not use, each with what it takes by default.

    None without roughness or fluid; a turned face and a simulation of the flow are of neither theory.

    Parameters
    ----------
    problem : SealProblem
    """
    surface, flow = problem.surface, problem.flow
    if not isinstance(surface, leak.RoughContact) or flow is None:
        return
    threshold = type(surface).percolation_threshold
    for theory in READINGS:
        if theory != surface.theory or flow.direct is not None:
            other = replace(
                problem,
                surface=replace(surface, theory=theory, yielding="", percolation_threshold=threshold),
                interface=problem.interface.model_copy(update={"plastic": False}),
                flow=replace(flow, direct=None),
                given_law=None,
            )
            yield Scenario(theory, other)


def names(surface: FaceContact | None, flow: FlowModel | None) -> tuple[str, ...]:
    """What the seal of a problem is called among scenarios: its surface, and its theory unless it is simulated.

    Parameters
    ----------
    surface : FaceContact or None
    flow : FlowModel or None
    """
    if surface is None:
        return (str(Reading.ELASTIC),)
    if flow is not None and flow.direct is not None:
        same = surface.elastic is surface and flow.elastic is flow
        return (str(Reading.ELASTIC),) if same else ("simulated",)
    if isinstance(surface, leak.TurnedContact):
        return str(Reading.ELASTIC) if surface.hardness is None else surface.theory, surface.theory
    return str(Reading.ELASTIC) if surface.hardness is None else surface.yielding, surface.theory


def with_test_gas(flow: FlowModel) -> FlowModel:
    """The same way for the gas that the standards test with; itself where that leaks, and for a liquid.

    Parameters
    ----------
    flow : FlowModel
    """
    test_gas = None if flow.gas is None else gas_of_test(flow.fluid, flow.gas)
    if test_gas is None or test_gas is flow.gas:
        return flow
    return replace(flow, fluid=test_gas.name, gas=test_gas, viscosity=test_gas.viscosity)


def gas_of_test(name: str, gas: Gas) -> Gas:
    """The gas itself where the standards test with it, air at room temperature for any other.

    Parameters
    ----------
    name : str
        What the case calls it.
    gas : Gas
    """
    low, high = TEST_TEMPERATURES
    is_test_gas = name.lower() in TEST_GASES and low <= gas.temperature <= high
    return gas if is_test_gas else leak.gas(TEST_GASES[0], ROOM_TEMPERATURE)
