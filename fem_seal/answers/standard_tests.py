"""A valve in the tests of its standard, and a relief valve up to its set pressure: the case under other loads."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from fem_seal.answers.accuracy import ACCURACY
from fem_seal.answers.answer import Answer, Request
from fem_seal.answers.case_load import SolvedSeal
from fem_seal.answers.findings import FINDINGS
from fem_seal.answers.judgement import Limit, LoadVerdict, Verdict, VerdictReason
from fem_seal.answers.opening import OPENING
from fem_seal.answers.uncertainty import UNCERTAINTY
from fem_seal.answers.verdict import VERDICT, missing_verdict
from fem_seal.case.case import Case
from fem_seal.case.tables import RELIEF
from fem_seal.errors import NoLoadLeftError, SealError
from fem_seal.seal.findings import Bounds
from leak.standards import ClosureTest

# What a verdict on a load needs.
_ANSWERS = (ACCURACY, OPENING, FINDINGS, UNCERTAINTY, VERDICT)
# Shares of the set pressure at which the leak rate of a relief valve is told.
SHARES = (0.5, 0.7, 0.8, 0.9, 0.95, 0.98)


@dataclass(frozen=True)
class TestedLoad:
    """A valve under one load of a test.

    Parameters
    ----------
    test : str
        Name of the test; empty for a load that is none.
    medium : str
        Name of the fluid.
    fluid_pressure, applied_force : float
        [Pa], [N]
    leak_rate : float
        Infinite where the seal is open, NaN if not known [m^3/s].
    ends : Bounds
        Of its interval [m^3/s].
    judgement : LoadVerdict or None
        None where nothing is required.
    """

    test: str
    medium: str
    fluid_pressure: float
    applied_force: float
    leak_rate: float
    ends: Bounds
    judgement: LoadVerdict | None

    __test__ = False  # no test of pytest


@dataclass(frozen=True)
class SetPressure:
    """A relief valve up to its set pressure, in its own fluid.

    Parameters
    ----------
    pressure : float
        That the spring holds on the circle of first touch [Pa].
    radius : float
        Of this circle [m].
    force : float
        Of the spring, pressure times the area of the circle [N].
    opens : float or None
        Fluid pressure that lifts the closure by the calculation [Pa]; None if not known.
    loads : tuple of TestedLoad
        At shares of the set pressure, judged by API 527.
    """

    pressure: float
    radius: float
    force: float
    opens: float | None
    loads: tuple[TestedLoad, ...]


def under_test(case: Case, test: ClosureTest, *, at: float | None = None) -> Case:
    """A case as a standard tests it: its fluid at room temperature, its pressure, and its class alone required.

    The applied force is that of the load whose fluid pressure is nearest.

    Parameters
    ----------
    case : Case
        That requires a class of the standard.
    test : ClosureTest
    at : float, optional
        Fluid pressure in place of that of the test [Pa].

    Raises
    ------
    InputError
        If the seal cannot be calculated with this fluid.
    """
    pressure, (_, force) = _load_of_test(case, test)
    tables = case.written
    tables.pop("temperature", None)
    # water and air are known
    spread = tables.get("uncertainty")
    if spread is not None and spread.pop("viscosity", None) is not None and not _says_spread(spread):
        del tables["uncertainty"]
    keys = ("standard", "class", "bubble_volume") if test.gas else ("standard", "class")
    required_only = {
        key: value for key, value in tables["requirement"].items() if key in (*keys, "rated_capacity")
    }
    return Case(
        **{
            **tables,
            "fluid": {"name": test.medium},
            "requirement": required_only,
            "load": _load_of(tables["load"], [pressure if at is None else at], force),
        }
    )


def _load_of_test(case: Case, test: ClosureTest) -> tuple[float, tuple[float, float]]:
    """Fluid pressure of a test [Pa], and fluid pressure and applied force of the load that is nearest."""
    requirement = case.requirement
    assert requirement is not None  # of the checks
    rated_pressure = case.set_pressure if requirement.rated_pressure is None else requirement.rated_pressure
    assert rated_pressure is not None  # as well
    pressure = test.pressure(rated_pressure)
    return pressure, min(case.load.points, key=lambda point: abs(point[0] - pressure))


def _without_result(case: Case, test: ClosureTest, error: Exception) -> TestedLoad:
    """The row of a test whose load has no result: it opens the seal, or nothing is known."""
    pressure, (nearest, force) = _load_of_test(case, test)
    point, problem = (pressure, force), getattr(error, "problems", (None,))[0]
    if problem is not None and problem.kind:
        # the limit, from the test's fluid in a load that the seal holds
        judgement = missing_verdict(under_test(case, test, at=nearest), point, problem)
    else:
        assert case.requirement is not None  # of the tests
        limit = Limit(" ".join(case.requirement.standard_and_class or ()), math.nan)
        judgement = LoadVerdict(Verdict.INCONCLUSIVE, math.nan, VerdictReason.UNKNOWN, limit)
    rate = math.inf if judgement.verdict is Verdict.FAIL else math.nan
    return TestedLoad(test.name, test.medium, *point, rate, Bounds(rate, rate), judgement)


def _says_spread(table: Mapping[str, Any]) -> bool:
    return not table.keys() <= {"samples", "seed", "confidence"}


def _load_of(table: Mapping[str, Any], pressures: Sequence[float], force: float) -> dict[str, Any]:
    """A table [load] with other loads under one force."""
    keys = {"set_pressure", "target_leak_rate", "largest_earlier_pressure"}
    base = {key: value for key, value in table.items() if key not in keys}
    return {**base, "fluid_pressure": [f"{p!r} Pa" for p in pressures], "applied_force": f"{force!r} N"}


def _solve_loads(case: Case, test: str, request: Request) -> tuple[SolvedSeal, tuple[TestedLoad, ...]]:
    assert request.solve is not None and case.fluid is not None
    seal, name = request.solve(case, answers=_ANSWERS), case.fluid.name
    rows = [
        TestedLoad(
            test,
            name,
            *load.point,
            math.nan if load.leak is None else load.leak.leak_rate,
            Bounds(*(load.leak_interval or (math.nan, math.nan))),
            getattr(load, "judgement", None),
        )
        for load in seal.loads
    ]
    for point, problem in seal.load_problems.items():
        rate = math.inf if problem.kind == "open" else math.nan
        rows.append(
            TestedLoad(test, name, *point, rate, Bounds(rate, rate), missing_verdict(case, point, problem))
        )
    return seal, tuple(sorted(rows, key=lambda row: row.fluid_pressure))


def _tests(seal: SolvedSeal, request: Request) -> tuple[TestedLoad, ...]:
    case = seal.case
    assert case.requirement is not None and case.fluid is not None

    def solve_test(test: ClosureTest) -> tuple[TestedLoad, ...]:
        try:
            return _solve_loads(under_test(case, test), test.name, request)[1]
        except NoLoadLeftError as error:
            return (_without_result(case, test, error),)

    def solve_or_explain(test: ClosureTest) -> tuple[TestedLoad, ...]:
        rows = request.steps.compute(f"the {test.name} of the standard", partial(solve_test, test), ())
        return rows or (_without_result(case, test, SealError()),)

    return tuple(
        load
        for test in case.requirement.tests(gas=case.fluid.gas is not None)
        for load in solve_or_explain(test)
    )


STANDARD_TESTS = Answer[tuple[TestedLoad, ...]](
    "standard_tests",
    "tests of the standard",
    _tests,
    (),
    lambda seal, request: seal.case.requirement is not None and seal.case.requirement.test == "standard",
    status="tests of the standard",
    needs=("case.requirement",),
)


def _up_to_opening(seal: SolvedSeal, request: Request) -> SetPressure:
    case, pressure = seal.case, seal.case.set_pressure
    assert pressure is not None
    force = max(force for _, force in case.load.points)
    tables = case.written
    load = _load_of(tables["load"], [share * pressure for share in SHARES], force)
    if case.fluid is None or case.roughness is None:
        tables.pop("requirement", None)
    else:
        requirement = tables.get("requirement", {})
        tables["requirement"] = {"standard": RELIEF} | {
            key: requirement[key] for key in requirement if key == "bubble_volume"
        }
    solved_seal, loads = _solve_loads(Case(**{**tables, "load": load}), "", request)
    # as beside the case's own loads, of which bodies that yield keep what they have gone through
    own = [load for load in seal.loads if load.applied_force == force]
    opens = (own or solved_seal.loads)[-1].blow_off_pressure
    return SetPressure(pressure, case.initial_contact_radius, force, opens, loads)


SET_PRESSURE = Answer[SetPressure | None](
    "set_pressure",
    "leak rate up to the set pressure",
    _up_to_opening,
    None,
    status="leak rate up to the set pressure",
    needs=("case.set_pressure", "problem.leaks"),
)
