"""A planned leak test as files: a protocol to print, and a table of readings for `fem-seal calibrate`."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from fem_seal.answers.leakage_class import volume_of
from fem_seal.answers.testplan import LeakTestPlan, PlannedReading
from fem_seal.case.measured import USUAL_UNCERTAINTY, is_filled
from fem_seal.errors import InputError
from fem_seal.files import problem, read_any_text, write_text
from fem_seal.output.tables import write_rows_csv
from fem_seal.seal.scenarios import FIRST_LOADING, SCENARIOS
from fem_seal.units import Unit
from fem_seal.version import __version__
from fem_seal.wording import environment, say

PROTOCOL, TABLE = "protocol.md", "readings.csv"
_COLUMNS = ("fluid_pressure", "applied_force", "largest_earlier_force")
_LOAD = ("fluid_pressure_Pa", "applied_force_N", "largest_earlier_force_N")


def check_unfilled(folder: Path) -> None:
    """InputError if leak rates stand in the table of a folder already.

    Parameters
    ----------
    folder : Path
    """
    file = folder / TABLE
    if file.exists() and is_filled(read_any_text(file)):
        raise InputError(problem("testplan_filled", path=file))


def write_testplan(plan: LeakTestPlan, folder: Path, case_file: str) -> None:
    """Write the protocol and the table with its loads, in which the leak rates are to be filled in.

    Parameters
    ----------
    plan : LeakTestPlan
    folder : Path
    case_file : str
        Name of the case's file.
    """
    display = plan.case.display
    rates = [rate for one in plan.readings for rate in one.load.leak_interval or ()]
    leak, units = display.shared_flow_unit(rates), [display.fixed_unit(name) for name in ("bar", "N", "N")]
    rows: list[list[float | str]] = [
        [*map(Unit.of, units, _load(one)), one.fluid, "", 100.0 * USUAL_UNCERTAINTY] for one in plan.readings
    ]
    columns = [f"{name} [{unit.name}]" for name, unit in zip(_COLUMNS, units, strict=True)]
    # not every program of tables reads a micro sign
    header = (*columns, "fluid", f"leak_rate [{leak.name.replace('µ', 'u')}]", "uncertainty [%]")
    write_rows_csv(folder / TABLE, header, rows)
    write_text(folder / PROTOCOL, protocol(plan, case_file))


def summary(plan: LeakTestPlan) -> list[dict[str, Any]]:
    """The readings with what is expected of each, SI; the interval, and other theories and histories by their names.

    Parameters
    ----------
    plan : LeakTestPlan
    """
    return [
        {
            "question": reading.question,
            "fluid": reading.fluid,
            **dict(zip(_LOAD, _load(reading), strict=True)),
            "expected_m3_per_s": reading.load.leak_interval,
            "others_m3_per_s": reading.others,
        }
        for reading in plan.readings
    ]


def _load(reading: PlannedReading) -> tuple[float, float, float]:
    return reading.load.fluid_pressure, reading.load.applied_force, reading.largest_earlier_force


def lines(plan: LeakTestPlan) -> Iterator[str]:
    """What the test decides, a sentence a line.

    Parameters
    ----------
    plan : LeakTestPlan
    """
    display = plan.case.display
    for question in dict.fromkeys(reading.question for reading in plan.readings):
        readings = plan.of(question)
        ratios = [_ratio(reading, by_memory=question == "pressed") for reading in readings]
        ratio = max((ratio for ratio in ratios if ratio is not None), default=None)
        if question in ("new", "pressed") and ratio is None:
            continue
        values = {"ratio": ratio, "force": readings[-1].largest_earlier_force, "fluid": readings[-1].fluid}
        yield say(display, "testplan", f"sentences_{question}", **values)


def _ratio(reading: PlannedReading, *, by_memory: bool) -> float | None:
    """What leaks by another theory, or without memory, over what is expected, or the other way round."""
    rates = [
        rate for name, rate in reading.others.items() if (name == FIRST_LOADING) == by_memory and rate > 0.0
    ]
    expected = 0.0 if reading.load.leak is None else reading.load.leak.leak_rate
    return max(rates[0] / expected, expected / rates[0]) if rates and expected > 0.0 else None


def protocol(plan: LeakTestPlan, case_file: str) -> str:
    """The protocol, Markdown of two pages.

    Parameters
    ----------
    plan : LeakTestPlan
    case_file : str
    """
    display = plan.case.display
    intervals = [reading.load.leak_interval or (0.0, 0.0) for reading in plan.readings]
    rows = []
    for number, (reading, interval) in enumerate(zip(plan.readings, intervals, strict=True), start=1):
        pressure, force, earlier = _load(reading)
        volume = volume_of(reading.case)
        others = [
            f"{SCENARIOS[name].title or 'no memory'} {display.leak_range(rate, 2, beside=interval, volume=volume)}"
            for name, rate in reading.others.items()
        ]
        rows.append(
            (
                number,
                reading.fluid,
                display.quantity(pressure, "short fluid pressure"),
                display.quantity(force, "short force"),
                "–" if math.isnan(earlier) else display.quantity(earlier, "force 3"),
                say(display, "testplan", "row_note", question=reading.question),
                display.leak_range(interval, volume=volume),
                "; ".join(others),
            )
        )
    last = {reading.question: reading for reading in plan.readings}
    page = environment(display).get_template("testplan.md.j2")
    return page.render(
        title=plan.case.title,
        version=__version__,
        sentences=list(lines(plan)),
        rows=rows,
        steps=[
            say(display, "testplan", f"step_{name}", force=one.largest_earlier_force, fluid=one.fluid)
            for name, one in last.items()
        ],
        least=display.leak_range(min((low for low, _ in intervals if low > 0.0), default=0.0), 1),
        case_file=case_file,
    )
