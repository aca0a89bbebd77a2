"""The table of the case file that describes the fluid: a liquid or a gas."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from pydantic import ConfigDict, Field, model_validator

from fem_seal.case.fields import AbsolutePressure, Number, Numbers, OneOrMany, Quantity, Table, show
from fem_seal.errors import InputError, QuantityError
from fem_seal.files import problem
from fem_seal.units import LIQUID, LeakVolume, parse_quantity
from leak.standards import STANDARD_PRESSURE

if TYPE_CHECKING:
    from leak import Gas, Liquid, ParticleCounts, PressureLaw

_COOLPROP = "CoolProp:"
_ROOM_TEMPERATURE = 293.15
# Above this pressure an exponential says too much of most liquids.
_BARUS_HOLDS = 1e8
# Roelands' law says nothing of thinner liquids [Pa s].
_LEAST_OF_ROELANDS = 1e-4


class Particles(Table):
    """[fluid.particles]: solid particles in the fluid, by ISO 4406 or by counts; see guide/particles in the manual."""

    iso_4406: str | None = Field(None, max_length=20)
    sizes: Annotated[float | tuple[float, ...], OneOrMany("length", "1 nm", "1 mm")] | None = None
    per_ml: Annotated[tuple[float, ...], Numbers(Number(0, 1e15, exclusive_low=True))] | None = None
    filter: Annotated[float, Quantity("length", "1 nm", "1 mm")] | None = None

    @model_validator(mode="after")
    def _check_counts(self) -> Particles:
        if (self.iso_4406 is None) == (self.sizes is None):
            raise ValueError("give either iso_4406, or sizes and per_ml")
        if (self.sizes is None) != (self.per_ml is None):
            raise ValueError("sizes and per_ml go together, one number for each size")
        _ = self.counts
        return self

    @property
    def counts(self) -> ParticleCounts:
        """Particles over their size."""
        from leak import ParticleCounts

        largest = math.inf if self.filter is None else self.filter
        if self.iso_4406 is not None:
            return ParticleCounts.of_iso_4406(self.iso_4406, largest)
        assert self.sizes is not None and self.per_ml is not None  # checked when the table was read
        return ParticleCounts.of_counts(self.sizes, [1e6 * number for number in self.per_ml], largest)


class Fluid(Table):
    """[fluid]: the liquid or gas that leaks, from the library by name, or a liquid by its viscosity."""

    model_config: ClassVar[ConfigDict] = ConfigDict(
        json_schema_extra=lambda schema: schema.update(
            anyOf=[{"required": ["name"]}, {"required": ["viscosity"]}], required=[]
        )
    )
    name: str = Field("user-defined", max_length=80)
    temperature: Annotated[float, Quantity("temperature", "50 K", "1500 K")] = _ROOM_TEMPERATURE
    viscosity: Annotated[float, Quantity("viscosity", "1e-4 mPa s", "1e6 Pa s")]
    pressure_viscosity: (
        Annotated[float, Quantity("pressure-viscosity coefficient", "0 1/GPa", "100 1/GPa")] | None
    ) = None
    roelands_z: Annotated[float, Number(0, 2, exclusive_low=True)] | None = None
    outlet_pressure: Annotated[float, AbsolutePressure("pressure", "0 Pa", "10 GPa")] | None = None
    particles: Particles | None = None

    @model_validator(mode="before")
    @classmethod
    def _from_library(cls, table: Any) -> Any:
        if not isinstance(table, dict) or not isinstance(table.get("name", ""), str):
            return table
        name = table.get("name", "")
        entry = _entry(name, _temperature(table))
        if entry is None:
            if "viscosity" not in table and name:
                raise ValueError(problem("unknown_fluid", name=show(name), known=_suggest_fluid(name)))
            return table
        entries = {"viscosity": f"{entry.viscosity!r} Pa s", **table, "name": entry.name}
        if hasattr(entry, "molar_mass"):
            entries.setdefault("outlet_pressure", f"{STANDARD_PRESSURE!r} Pa")
        return entries

    @property
    def library_entry(self) -> Gas | Liquid | None:
        """The entry of the library with this name at this temperature, None for a fluid of the user's own."""
        return _entry(self.name, self.temperature)

    def at(self, temperature: float) -> Fluid:
        """The same fluid at another temperature; a viscosity of the user's own stays.

        Raises
        ------
        InputError
            If its properties are not known there.
        """
        old_entry = self.library_entry
        try:
            entry = _entry(self.name, temperature)
        except ValueError as error:
            raise InputError.at("fluid.temperature", f"in the film, {error}") from None
        update: dict[str, float] = {"temperature": temperature}
        if old_entry is not None and entry is not None and old_entry.viscosity == self.viscosity:
            update["viscosity"] = entry.viscosity
        return self.model_copy(update=update)

    @property
    def gas(self) -> Gas | None:
        """The gas with the case's viscosity; None for a liquid."""
        from leak import Gas

        entry = self.library_entry
        return replace(entry, viscosity=self.viscosity) if isinstance(entry, Gas) else None

    @property
    def volume(self) -> LeakVolume:
        """What a volume is that leaks: of a gas that at 101325 Pa and its temperature."""
        return LIQUID if self.gas is None else LeakVolume.of_gas(self.temperature)

    @property
    def pressure_law(self) -> PressureLaw | None:
        """Viscosity and density over pressure, the case's own before the library's; None where nothing is known."""
        from leak import Barus, Liquid, Roelands

        entry = self.library_entry
        law = entry.pressure_law if isinstance(entry, Liquid) else None
        compression = law.compression if isinstance(law, Barus | Roelands) else None
        if self.pressure_viscosity is not None:
            return Barus(self.pressure_viscosity, compression, _BARUS_HOLDS)
        if self.roelands_z is not None and self.viscosity > _LEAST_OF_ROELANDS:
            return Roelands(self.roelands_z, self.viscosity, compression)
        if isinstance(law, Roelands) and self.viscosity > _LEAST_OF_ROELANDS:
            # a thicker oil thickens more
            return replace(law, viscosity=self.viscosity)
        return law

    @property
    def density(self) -> float | None:
        """Density that turns the volume of a leak into mass, of a gas at 101325 Pa [kg/m^3]; None if unknown."""
        from leak import Liquid

        if self.gas is not None:
            return self.gas.density(STANDARD_PRESSURE)
        entry = self.library_entry
        return entry.density if isinstance(entry, Liquid) else None


def _temperature(table: dict[str, Any]) -> float:
    """Temperature of a raw table [K]; that of the room if it is no temperature, which the field itself reports."""
    try:
        return parse_quantity(table.get("temperature", "20 degC"), "temperature")
    except QuantityError:
        return _ROOM_TEMPERATURE


# Fluids that a calculation of the optional package has under another name.
_OTHER_NAMES = {"steam": f"{_COOLPROP}Water", "water vapour": f"{_COOLPROP}Water"}


@lru_cache(maxsize=256)
def _entry(name: str, temperature: float) -> Gas | Liquid | None:
    """Gas or liquid of a library; ValueError for a temperature outside its range."""
    from leak import gas, is_gas, is_liquid, liquid

    if name.startswith(_COOLPROP):
        from leak.fluids.coolprop import coolprop_is_gas

        return gas(name, temperature) if coolprop_is_gas(name, temperature) else liquid(name, temperature)
    if is_gas(name):
        return gas(name, temperature)
    return liquid(name, temperature) if is_liquid(name) else None


def _suggest_fluid(name: str) -> str:
    from difflib import get_close_matches

    from leak import FLUIDS, GASES

    names, word = {fluid.lower(): fluid for fluid in (*FLUIDS, *GASES)}, name.lower()
    with_it = [fluid for fluid in names if len(word) > 2 and word in fluid]
    likely = [names[fluid] for fluid in with_it or get_close_matches(word, names, n=1)]
    close = [_OTHER_NAMES[word]] if word in _OTHER_NAMES else likely
    hint = f"do you mean {' or '.join(close)}? " if close else ""
    return hint + "known are " + ", ".join(f'"{fluid}"' for fluid in names.values())
