"""The table [requirement] of the case file: allowed leak rate or leakage class."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated

from pydantic import Field, create_model

from fem_seal.case.fields import OneOrMany, Quantity, Table
from fem_seal.case.leak_rate import LeakRate

# Pressures that are written in other units than those of the loads are the same up to rounding.
_SAME = 1e-6


class _Requirement(Table):
    """[requirement]: what the seal must keep, for a verdict on every load; see guide/verdict in the manual."""

    leak_rate: Annotated[float, LeakRate("leak rate", "1e-30 m^3/s", "1e3 m^3/s")] | None = None
    standard: str | None = Field(None, max_length=40)
    rated_capacity: Annotated[float, LeakRate("leak rate", "1e-12 m^3/s", "1e6 m^3/s")] | None = None
    bubble_volume: Annotated[float, Quantity("volume", "1e-6 ml", "100 ml")] | None = None
    fluid_pressure: Annotated[float | tuple[float, ...], OneOrMany("pressure", "0 Pa", "10 GPa")] | None = (
        None
    )

    @property
    def class_name(self) -> str | None:
        """What stands at `class`, which Python has another use for."""
        return getattr(self, "class", None)

    @property
    def standard_and_class(self) -> tuple[str, str] | None:
        """Standard and class by their own names; None where none is required."""
        from leak.standards import classes_of, standard_named

        standard = None if self.standard is None else standard_named(self.standard)
        if standard is None:
            return None
        known = dict.fromkeys((*classes_of(standard, gas=True), *classes_of(standard, gas=False)))
        if self.class_name is None:
            # API 598 has but one
            return (standard, next(iter(known))) if len(known) == 1 else None
        found = [one for one in known if one.lower() == self.class_name.strip().lower()]
        return (standard, found[0]) if found else None

    @property
    def volume_of_bubble(self) -> float | None:
        """Its own, or that of its standard [m^3]; None where neither says it."""
        from leak.standards import STANDARDS, standard_named

        standard = None if self.standard is None else standard_named(self.standard)
        if self.bubble_volume is not None or standard is None:
            return self.bubble_volume
        return STANDARDS[standard].bubble_volume

    @property
    def pressures(self) -> tuple[float, ...]:
        """Fluid pressures of the loads that are judged [Pa]; empty if all are."""
        given = self.fluid_pressure
        if given is None:
            return ()
        return given if isinstance(given, tuple) else (given,)

    def judges(self, fluid_pressure: float) -> bool:
        """Whether it holds for a load with this fluid pressure [Pa]."""
        return not self.pressures or any(
            math.isclose(fluid_pressure, one, rel_tol=_SAME) for one in self.pressures
        )


if TYPE_CHECKING:
    Requirement = _Requirement
else:
    # `class` is no name that the body of a class could give to a field
    Requirement = create_model(
        "Requirement",
        __base__=_Requirement,
        __module__=__name__,
        **{"class": (Annotated[str, Field(max_length=40)] | None, None)},
    )
    Requirement.__doc__ = _Requirement.__doc__
