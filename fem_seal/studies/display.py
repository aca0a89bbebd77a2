"""Columns of a study as an engineer reads them: in words, in units that suit the size of the values."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fem_seal.readable import Unit, unit_for
from fem_seal.studies.analysis import Designs

if TYPE_CHECKING:
    import pandas as pd

FloatArray = NDArray[np.float64]

_DEGREE = Unit("°", math.pi / 180)
# Endings of the columns of leak.csv and what they are quantities of.
_ENDINGS = {
    "_standard_m3_per_s": None,
    "_Pa_m3_per_s": None,
    "_m3_per_s": "flow",
    "_N_per_m": "line load",
    "_Pa": "contact pressure",
    "_N": "force",
    "_m": "length",
}
_SI_UNITS = {"m": "length", "Pa": "contact pressure", "N": "force", "Pa s": "viscosity"}
_OF_FLUID = ("fluid_pressure", "blow_off_pressure", "outlet_pressure")


@dataclass(frozen=True, eq=False)
class Display:
    """How the columns of a study are shown.

    Parameters
    ----------
    designs : Designs
    """

    designs: Designs
    _units: dict[str, Unit] = field(default_factory=dict, repr=False)

    def label(self, name: str) -> str:
        """What a column is called, with its unit."""
        title, unit = _words(name, self._parameters), self.unit(name)
        return f"{title} [{unit.name}]" if unit.name else title

    def values(self, table: pd.DataFrame, name: str) -> list[Any]:
        """A column in its unit, None where there is no number; words as they are."""
        if table[name].dtype.kind not in "fiu":
            return list(table[name].tolist())
        numbers = table[name].to_numpy(dtype=float) / self.unit(name).size
        return [value if math.isfinite(value) else None for value in numbers.tolist()]

    def unit(self, name: str) -> Unit:
        """Unit of a column, by the largest value in it; without a name if it has none."""
        if name not in self._units:
            self._units[name] = _unit(self.designs, self._parameters, name)
        return self._units[name]

    @property
    def _parameters(self) -> dict[str, dict[str, Any]]:
        return {one["name"]: one for one in self.designs.about["parameters"]}


def _unit(designs: Designs, parameters: dict[str, dict[str, Any]], name: str) -> Unit:
    column = designs.done.get(name)
    if column is None or column.dtype.kind not in "fiu":
        return Unit("", 1.0)
    if name in parameters:
        si = parameters[name]["unit"]
        if si == "rad":
            return _DEGREE
        kind = _SI_UNITS.get(si)
    elif name in designs.about["responses"]:
        si = ""
        kind = next((kind for ending, kind in _ENDINGS.items() if name.endswith(ending)), None)
    else:
        return Unit("", 1.0)
    if kind == "contact pressure" and any(word in name for word in _OF_FLUID):
        kind = "fluid pressure"
    largest = float(np.nanmax(np.abs(column.to_numpy(dtype=float)), initial=0.0))
    return Unit(si, 1.0) if kind is None else unit_for(kind, largest)


def _words(name: str, parameters: dict[str, Any]) -> str:
    """A parameter keeps its path, which is what the user wrote; a response loses the unit at its end."""
    if name in parameters:
        return name
    for ending, kind in _ENDINGS.items():
        if kind is not None and name.endswith(ending):
            return name.removesuffix(ending).replace("_", " ")
    return name
