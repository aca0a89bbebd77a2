"""The temperatures of a case and what they do to the bodies, as names with values."""

from __future__ import annotations

from collections.abc import Iterator

from fem_seal.analysis.problem import SealProblem
from fem_seal.case.case import Case
from fem_seal.units import given, number, trimmed


def temperature_rows(case: Case, problem: SealProblem) -> Iterator[tuple[str, str]]:
    """Rows of the table of the temperature; none where the case says nothing of it.

    Parameters
    ----------
    case : Case
    problem : SealProblem
        That the case poses.
    """
    if case.temperature is None:
        return
    for name, temperature in problem.temperatures.items():
        yield f"temperature of the {name}", celsius(temperature)
    yield "dimensions hold at", celsius(case.temperature.reference)
    yield "closure grows more than seat", f"{number(1e6 * problem.expansion, 4)}·10⁻⁶"
    if problem.supports.wall == "fixed":
        yield "wall of the seat moves inwards", given("length", problem.interference)


def celsius(temperature: float) -> str:
    """A temperature [K] in words."""
    return f"{trimmed(temperature - 273.15)} °C"
