"""The temperatures of a case and what they do to the bodies, as names with values."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from fem_seal.units import given, number, trimmed

if TYPE_CHECKING:
    from fem_seal.case.case import Case
    from fem_seal.contact.conduction import TemperatureField
    from fem_seal.seal.problem import SealProblem


def temperature_rows(
    case: Case, problem: SealProblem, field: TemperatureField | None = None
) -> Iterator[tuple[str, str]]:
    """Rows of the table of the temperature; none where the case says nothing of it.

    Parameters
    ----------
    case : Case
    problem : SealProblem
        That the case poses.
    field : TemperatureField, optional
        Of a case whose temperatures are calculated.
    """
    if case.temperature is None:
        return
    calculated = problem.heating is not None
    for name, temperature in problem.temperatures.items():
        yield f"{name} at the contact" if calculated else f"temperature of the {name}", celsius(temperature)
    yield "dimensions hold at", celsius(case.temperature.reference)
    for name, face in case.temperature.faces.items():
        film = face.heat_transfer
        with_film = "" if film is None else f", {trimmed(film)} W/(m² K)"
        yield f"{_AROUND[name]}, {'face' if film is None else 'fluid'}", celsius(face.temperature) + with_film
        if field is not None:
            yield f"{_AROUND[name]}, heat into the seal", f"{number(field.heat[name], 4)} W"
    if field is not None:
        yield "heat from closure to seat", f"{number(field.across, 4)} W"
    if calculated:
        conductance = case.temperature.contact_conductance
        yield "contact conducts", "perfectly" if conductance is None else f"{trimmed(conductance)} W/(m² K)"
        return
    yield "closure grows more than seat", f"{number(1e6 * problem.expansion, 4)}·10⁻⁶"
    if problem.supports.wall == "fixed":
        yield "wall of the seat moves inwards", given("length", problem.interference)


_AROUND = {
    "inner": "inside",
    "outer": "outside",
    "top": "top of the closure",
    "bottom": "bottom of the seat",
    "wall": "wall of the seat",
}


def celsius(temperature: float) -> str:
    """A temperature [K] in words."""
    return f"{trimmed(round(temperature - 273.15, 2))} °C"
