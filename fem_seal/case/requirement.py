"""The table [requirement]: what the seal must keep, for the verdict of a run."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated

from pydantic import Field, create_model

from fem_seal.case.fields import OneOrMany, Quantity, Table, optional
from fem_seal.case.leak_rate import LeakRate

# Pressures that are written in other units than those of the loads are the same up to rounding.
_SAME = 1e-6


class _Requirement(Table):
    """[requirement]: what the seal must keep, for a verdict on every load; see guide/verdict in the manual."""

    leak_rate: Annotated[float, LeakRate("leak rate", "1e-30 m^3/s", "1e3 m^3/s")] | None = optional(
        'largest allowed leak rate; of a liquid also in drops of 1/16 ml, such as "3 drops/min"; of a gas '
        'the volume at 101325 Pa and its temperature, or at 101325 Pa and 0 degC ("1 Nml/min", "1 sccm", "0.1 slm"), '
        'bubbles ("5 bubbles/min", see bubble_volume), or pressure times volume, such as "1e-3 mbar l/s"',
        "0.1 ml/min",
    )
    standard: str | None = Field(
        None,
        description='standard whose class is required: "ISO 5208", "API 598" or "FCI 70-2"; beside leak_rate both are '
        "required",
        examples=["ISO 5208"],
        max_length=40,
    )
    rated_capacity: Annotated[float, LeakRate("leak rate", "1e-12 m^3/s", "1e6 m^3/s")] | None = optional(
        "flow through the open valve under the conditions of the test, which classes II to IV of FCI 70-2 "
        "are a share of",
        "40 m^3/h",
    )
    bubble_volume: Annotated[float, Quantity("volume", "1e-6 ml", "100 ml")] | None = optional(
        "of a gas: volume of one bubble of the test, where leak_rate or a standard counts them (API 598) "
        "or allows none to be seen (ISO 5208 A); unless given that of the standard: ISO 5208 0.065 ml, "
        "API 598 0.01 ml, FCI 70-2 0.15 ml",
        "0.065 ml",
    )
    fluid_pressure: Annotated[float | tuple[float, ...], OneOrMany("pressure", "0 Pa", "10 GPa")] | None = (
        optional(
            "the loads at which it is required, by their fluid pressure, one or a list; all unless given",
            "20 bar",
        )
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
        **{
            "class": (
                Annotated[str, Field(max_length=40)] | None,
                optional(
                    "class of the standard, such as B of ISO 5208 or V of FCI 70-2; API 598 has one only, "
                    "for metal seats",
                    "B",
                ),
            )
        },
    )
    Requirement.__doc__ = _Requirement.__doc__
