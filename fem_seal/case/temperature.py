"""The table [temperature] of the case file: temperatures of the bodies, and of the drawing."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Literal

from fem_seal.case.fields import Quantity, Table
from fem_seal.errors import QuantityError
from fem_seal.materials import ROOM_TEMPERATURE
from fem_seal.units import parse_quantity

Kelvin = Annotated[float, Quantity("temperature", "50 K", "1500 K")]
HeatTransfer = Annotated[float, Quantity("heat transfer", "1e-3 W/(m^2 K)", "1e7 W/(m^2 K)")]


@dataclass(frozen=True)
class ConductanceEntry(Quantity):
    """A conductance, or "theory"."""

    @property
    def range(self) -> str:
        """Allowed range, for messages and docs."""
        return f'"theory", or {super().range}'

    def read(self, text: object) -> float | Literal["theory"]:  # type: ignore[override]
        """Conductance in SI, or the word; ValueError if it is neither."""
        if text == "theory":
            return "theory"
        try:
            return super().read(text)
        except ValueError as error:
            raise ValueError(f'{error}; or write "theory"') from None

    @property
    def _schema(self) -> dict[str, Any]:
        return {"type": "string", "examples": ["theory", "10 kW/(m^2 K)"]}


Conductance = Annotated[
    float | Literal["theory"], ConductanceEntry("heat transfer", "1e-3 W/(m^2 K)", "1e9 W/(m^2 K)")
]


class Face(Table):
    """A face of the seal and what warms it, where temperatures are calculated: guide/temperature in the manual."""

    temperature: Kelvin
    heat_transfer: HeatTransfer | None = None


# Names of the faces, as they stand in the table.
FACES = ("inner", "outer", "top", "bottom", "wall")


class Temperature(Table):
    """[temperature]: how warm closure and seat are: all over, each its own, or by conduction from what is around them.

    See guide/temperature in the manual. The faces are insulated unless they are named.
    """

    uniform: Kelvin | None = None
    closure: Kelvin | None = None
    seat: Kelvin | None = None
    reference: Kelvin = ROOM_TEMPERATURE
    housing: Kelvin | None = None
    housing_expansion: Annotated[float, Quantity("thermal expansion", "-1e-4 1/K", "1e-3 1/K")] | None = None

    inner: Face | None = None
    outer: Face | None = None
    top: Face | None = None
    bottom: Face | None = None
    wall: Face | None = None
    contact_conductance: Conductance | None = None

    @property
    def of_rough_faces(self) -> bool:
        """Whether the contact conducts as the theory of its rough faces says."""
        return self.contact_conductance == "theory"

    @property
    def faces(self) -> dict[str, Face]:
        """Faces of the seal that are not insulated, by their names."""
        return {name: face for name in FACES if (face := getattr(self, name)) is not None}

    def of_body(self, name: str) -> float | None:
        """Temperature of the body "closure" or "seat" [K]; None where it is not given."""
        temperature: float | None = getattr(self, name)
        return self.uniform if temperature is None else temperature

    @property
    def film(self) -> float | None:
        """Mean of both bodies [K], the temperature of the fluid between them; None where they are not given."""
        closure, seat = self.of_body("closure"), self.of_body("seat")
        return None if closure is None or seat is None else 0.5 * (closure + seat)


def with_film_temperature(fluid: Any, temperature: Any) -> Any:
    """A table [fluid] as it is written, at the temperature of the film unless it has its own.

    Parameters
    ----------
    fluid, temperature : mapping, or whatever else stands there
        What is wrong with them is for the reading of the tables to say.
    """
    if not isinstance(fluid, Mapping) or not isinstance(temperature, Mapping) or "temperature" in fluid:
        return fluid
    try:
        temperatures = {
            name: parse_quantity(temperature[name], "temperature")
            for name in ("uniform", "closure", "seat")
            if temperature.get(name) is not None
        }
    except (QuantityError, ValueError):
        return fluid
    bodies = [temperatures.get(name) or temperatures.get("uniform") for name in ("closure", "seat")]
    warm = [t for t in bodies if t is not None and t > 0.0]
    return {**fluid, "temperature": f"{sum(warm) / 2!r} K"} if len(warm) == 2 else fluid
