"""A leak test that decides between what is open: its loads in their order, with what is expected of each."""

from __future__ import annotations

import math
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from fem_seal.answers.accuracy import ACCURACY
from fem_seal.answers.calibration import with_points
from fem_seal.answers.case_load import CaseLoad
from fem_seal.answers.chain import solve
from fem_seal.answers.findings import FINDINGS
from fem_seal.answers.opening import OPENING
from fem_seal.answers.uncertainty import UNCERTAINTY
from fem_seal.answers.variants import OWN_CONTACTS
from fem_seal.case.case import Case
from fem_seal.case.measured import with_fluid
from fem_seal.errors import InputError, SealError
from fem_seal.files import problem
from fem_seal.seal.load_solver import Progress
from fem_seal.seal.scenarios import FIRST_LOADING, SCENARIOS

# Of the case's largest load, and what a larger load before is of that.
_SHARES, _OVERLOAD = (0.25, 0.5, 1.0), 2.0
_ANSWERS = (ACCURACY, OPENING, OWN_CONTACTS, FINDINGS, UNCERTAINTY)

QUESTIONS = ("new", "again", "held", "pressed", "gas")
"""What a reading is asked for: new faces, closed again, held for an hour, pressed harder before, another gas."""


@dataclass(frozen=True)
class PlannedReading:
    """A reading that is to be taken.

    Parameters
    ----------
    question : str
        One of `QUESTIONS`.
    case : Case
        With its fluid.
    load : CaseLoad
        With its expected interval, and what leaks in other theories and histories.
    largest_earlier_force : float
        By which the seal was closed before [N]; NaN where not more than by the load itself, or as the case has it.
    """

    question: str
    case: Case
    load: CaseLoad
    largest_earlier_force: float = math.nan

    @property
    def fluid(self) -> str:
        """Its name."""
        assert self.case.fluid is not None  # of what leaks
        return self.case.fluid.name

    @property
    def others(self) -> dict[str, float]:
        """Leak rate by the other theory of the rough contact, and without memory after a larger force [m^3/s]."""
        first = (FIRST_LOADING,) if self.largest_earlier_force > 0.0 else ()
        return {
            name: other.leak.leak_rate
            for name, other in self.load.scenarios.items()
            if (SCENARIOS[name].own_contact or name in first) and other.leak is not None
        }


@dataclass(frozen=True)
class LeakTestPlan:
    """Readings in the order in which they are to be taken.

    Parameters
    ----------
    case : Case
    readings : tuple of PlannedReading
    """

    case: Case
    readings: tuple[PlannedReading, ...]

    def of(self, question: str) -> tuple[PlannedReading, ...]:
        """Those of one question."""
        return tuple(reading for reading in self.readings if reading.question == question)


def plan_leak_test(case: Case, progress: Progress = lambda text: None) -> LeakTestPlan:
    """Readings that decide between theories, histories, clogging and closing; none of a history that leaves no trace.

    Parameters
    ----------
    case : Case
        With roughness and fluid; the largest of its loads is the largest of the test.
    progress : callable
        Called with a status message before each step.

    Raises
    ------
    InputError
        If the case has no leak rate by a theory, or is closed by bolts.
    """
    if case.roughness is None or case.fluid is None or case.leak.conductivity == "direct" or case.load.is_dry:
        raise InputError(problem("calibrate_without_leak"))
    if case.bolts is not None:
        raise InputError(problem("measured_bolts"))
    base = case.replace({"requirement": None, "load.target_leak_rate": None})
    pressure, force = max(case.load.points)
    points = [(share * pressure, share * force) for share in _SHARES]
    new = solve(with_points(base, points), progress, answers=_ANSWERS)
    largest = new.loads[-1]
    readings = [PlannedReading("new", case, load) for load in new.loads]
    readings += [PlannedReading("again", case, largest)] * 2
    if case.fluid.gas is None:
        readings.append(PlannedReading("held", case, largest))
    closed = (largest.contact_force, force, (case.load.earlier or (0.0, 0.0))[1])
    overload = _OVERLOAD * max(closed)
    pressed: Mapping[str, Any] = {
        "load.largest_earlier_force": overload,
        "load.largest_earlier_pressure": None,
    }
    # what leaves no trace, or cannot be calculated, is no part of the test
    if case.hardness is not None:
        with suppress(SealError):
            back = solve(with_points(base, points[::-1]).replace(pressed), progress, answers=_ANSWERS)
            readings += [PlannedReading("pressed", case, load, overload) for load in back.loads]
    earlier = readings[-1].largest_earlier_force
    with suppress(SealError):
        other = with_fluid(base, "helium" if case.fluid.name == "nitrogen" else "nitrogen")
        last = with_points(other, points[-1:]).replace(pressed if earlier > 0.0 else {})
        (gas_load,) = solve(last, progress, answers=_ANSWERS).loads
        readings.append(PlannedReading("gas", other, gas_load, earlier))
    return LeakTestPlan(case, tuple(readings))
