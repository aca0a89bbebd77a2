"""The table [bolts] of the case file: bolts that close the seal in place of load.applied_force."""

from __future__ import annotations

import math
from typing import Annotated, Any

from pydantic import model_validator

from fem_seal.bolts import STRESS_AREAS, BoltCircle, nominal_diameter, preload_of_torque
from fem_seal.case.fields import Number, Numbers, OneOrMany, Quantity, Several, Table, WholeNumber
from fem_seal.case.material_table import MaterialField
from fem_seal.case.temperature import Kelvin
from fem_seal.files import problem

# Nut factor where the state of the bolts is not known (Shigley, table 8-15: from memory).
NUT_FACTOR = 0.2
# Width across the flats of a hexagon head over the thread, and thread over the root of 4/pi of its stress area: from M8
# on, ISO 4014 (from memory) and the table of ISO 898-1.
_HEAD, _THREAD = 1.5, 1.16


class BoltsTable(Table):
    """[bolts]: bolts that close the seal, in place of load.applied_force; see guide/flange in the manual."""

    number: Annotated[int, WholeNumber(1, 1000)]
    size: str | None = None
    stress_area: Annotated[float, Quantity("area", "0.1 mm^2", "1e5 mm^2")] | None = None
    length: Annotated[float, Quantity("length", "1 mm", "10 m")]
    material: MaterialField | None = None
    youngs_modulus: Annotated[float, Quantity("pressure", "1 GPa", "1 TPa")] | None = None
    torque: Annotated[float | tuple[float, ...], OneOrMany("torque", "1e-3 N m", "1e6 N m")] | None = None
    nut_factor: Annotated[float, Number(0.02, 1)] = NUT_FACTOR
    preload: Annotated[float | tuple[float, ...], OneOrMany("force", "1 N", "1e8 N")] | None = None
    torque_scatter: Annotated[float, Number(0, 0.9)] = 0.0
    stiffness: Annotated[float, Quantity("stiffness", "1 N/m", "1e15 N/m")] | None = None
    temperature: Kelvin | None = None
    thermal_expansion: Annotated[float, Quantity("thermal expansion", "-1e-4 1/K", "1e-3 1/K")] | None = None
    circle_diameter: Annotated[float, Quantity("length", "1 mm", "20 m")] | None = None
    angles: Annotated[tuple[float, ...], Several(Quantity("angle", "-360 deg", "360 deg"))] | None = None
    tightness: Annotated[tuple[float, ...], Numbers(Number(0, 10))] | None = None

    @model_validator(mode="after")
    def _consistent(self) -> BoltsTable:
        has_diameter = self.size is not None and nominal_diameter(self.size) is not None
        if (self.torque is None) == (self.preload is None):
            raise ValueError(problem("bolts_preload"))
        if self.size is not None and not has_diameter:
            raise ValueError(problem("bolts_size", size=self.size))
        if self.stress_area is None and self._thread not in STRESS_AREAS:
            raise ValueError(problem("bolts_area", known=", ".join(STRESS_AREAS)))
        if self.torque is not None and not has_diameter:
            raise ValueError(problem("bolts_diameter"))
        if self.material is None and self.youngs_modulus is None:
            raise ValueError(problem("bolts_modulus"))
        one_by_one = {"angles": self.angles, "tightness": self.tightness}
        for key, entries in one_by_one.items():
            if entries is not None and self.circle_diameter is None:
                raise ValueError(problem("bolts_circle", name=key))
            if entries is not None and len(entries) != self.number:
                raise ValueError(problem("bolts_entries", name=key, given=len(entries), number=self.number))
        if self.tightness is not None and not any(self.tightness):
            raise ValueError(problem("bolts_all_loose"))
        if self.circle_diameter is not None and self.number < 2:
            raise ValueError(problem("bolts_few"))
        return self

    @property
    def area(self) -> float:
        """Stress area of a bolt [m^2]."""
        return STRESS_AREAS[self._thread] if self.stress_area is None else self.stress_area

    @property
    def _thread(self) -> str:
        return (self.size or "").replace(" ", "").upper()

    @property
    def circle(self) -> BoltCircle | None:
        """The bolts one by one; None where they press evenly all around."""
        if self.circle_diameter is None:
            return None
        even_angles = tuple(2 * math.pi * n / self.number for n in range(self.number))
        diameter = nominal_diameter(self.size) if self.size is not None else None
        thread = diameter or _THREAD * math.sqrt(4.0 / math.pi * self.area)
        tightness = self.tightness or (1.0,) * self.number
        return BoltCircle(0.5 * self.circle_diameter, _HEAD * thread, self.angles or even_angles, tightness)

    @property
    def torque_factor(self) -> float | None:
        """K d, torque over preload [m]; None without a size."""
        diameter = None if self.size is None else nominal_diameter(self.size)
        return None if diameter is None else self.nut_factor * diameter

    @property
    def preloads(self) -> tuple[float, ...]:
        """Preload of all bolts together, one or one for each load [N]."""
        tightening = self.preload if self.torque is None else self.torque
        each: tuple[Any, ...] = tightening if isinstance(tightening, tuple) else (tightening,)
        if self.torque is not None:
            diameter = nominal_diameter(self.size or "")
            assert diameter is not None  # of the validation
            each = tuple(preload_of_torque(torque, self.nut_factor, diameter) for torque in each)
        number = self.number if self.tightness is None else sum(self.tightness)
        return tuple(number * preload for preload in each)
