"""The table [direct] of the case file: which patch of the surface is simulated, and at which pressures."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import model_validator

from fem_seal.case.fields import Number, Pressures, Quantity, Table, Whole
from fem_seal.case.roughness import LengthUnits

Asperities = Literal["elastic", "capped", "von-mises"]
CONTACT_PRESSURE = Quantity("pressure", "1 Pa", "1e6 GPa")


class Direct(Table):
    """[direct]: direct simulation of a rough patch, see guide/direct in the manual."""

    points: Annotated[int, Whole(32, 4096)] = 256
    samples: Annotated[int, Whole(1, 200)] = 3
    seed: Annotated[int, Whole(0, 10**9)] = 1
    size: Annotated[float, Quantity("length", "1 nm", "1 m")] | None = None
    waves: Annotated[float, Number(1, 100)] = 8.0
    points_per_wave: Annotated[float, Number(2, 100)] = 4.0
    amplitudes: Literal["exact", "gaussian"] = "exact"
    pressure: Annotated[tuple[float, ...], Pressures(CONTACT_PRESSURE)] | None = None
    unload: Annotated[tuple[float, ...], Pressures(CONTACT_PRESSURE)] | None = None
    direction: Literal["both", "x", "y"] | None = None
    asperities: Asperities | None = None
    yield_stress: Annotated[float, CONTACT_PRESSURE] | None = None
    file: str | None = None
    unit: Annotated[tuple[str, ...], LengthUnits(most=2, what='["mm", "um"]')] | None = None
    continuation: Literal["mirror", "window"] = "mirror"
    folder: str | None = None

    @model_validator(mode="after")
    def _consistent(self) -> Direct:
        if self.unload is not None and self.pressure is None:
            raise ValueError("has unload, which needs pressure; add it")
        if self.unload is not None and self.pressure is not None and max(self.unload) >= max(self.pressure):
            raise ValueError("has unload above or at the largest pressure; only smaller ones come after it")
        if self.file is None and self.unit is not None:
            raise ValueError("has unit, which is only for a file; remove it")
        if self.file is not None and self.size is not None:
            raise ValueError("has size and file, whose map has its own; remove size")
        return self
