"""The table [direct] of the case file: which patch of the surface is simulated, and at which pressures."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from fem_seal.case.fields import Number, Pressures, Quantity, Table, Whole, optional
from fem_seal.case.roughness import LengthUnits

Asperities = Literal["elastic", "capped", "von-mises"]
CONTACT_PRESSURE = Quantity("pressure", "1 Pa", "1e6 GPa")


class Direct(Table):
    """[direct]: direct simulation of a rough patch, see guide/direct in the manual."""

    points: Annotated[int, Whole(32, 4096)] = Field(256, description="grid points along a side of the patch")
    samples: Annotated[int, Whole(1, 200)] = Field(
        3, description="patches with the same spectrum and other phases"
    )
    seed: Annotated[int, Whole(0, 10**9)] = Field(
        1, description="of the random phases; each sample has the next one"
    )
    size: Annotated[float, Quantity("length", "1 nm", "1 m")] | None = optional(
        "side of the patch; waves times the wavelength above which half of the height variance lies, "
        "unless given",
        "0.4 mm",
    )
    waves: Annotated[float, Number(1, 100)] = Field(
        8.0, description="waves along a side that make the height, see size"
    )
    points_per_wave: Annotated[float, Number(2, 100)] = Field(
        4.0, description="grid points on the shortest wave that is kept"
    )
    amplitudes: Literal["exact", "gaussian"] = Field(
        "exact",
        description='"exact": every sample has the spectrum itself, the phases alone are random; "gaussian": as pieces '
        "cut out of a Gaussian surface",
    )
    pressure: Annotated[tuple[float, ...], Pressures(CONTACT_PRESSURE)] | None = optional(
        "nominal contact pressures; eight unless given, from a contact area of 0.3 % to one of 30 % in the "
        "theory",
        ["10 MPa", "50 MPa"],
    )
    unload: Annotated[tuple[float, ...], Pressures(CONTACT_PRESSURE)] | None = optional(
        "pressures after the largest of pressure, below it", ["10 MPa"]
    )
    direction: Literal["both", "x", "y"] | None = optional(
        'of the flow: "both": the mean; "x": along the first direction of a map, along the flow of a '
        "roughness with a lay; both unless there is a lay, x then"
    )
    asperities: Asperities | None = optional(
        'what yields: "elastic": nothing; "capped": no pressure exceeds the hardness; "von-mises": metal '
        "flows below the surface; capped where asperities yield (leak.plasticity) and elastic elsewhere unless given"
    )
    yield_stress: Annotated[float, CONTACT_PRESSURE] | None = optional(
        'of asperities = "von-mises", in tension; the hardness over 2.9 unless given', "1.2 GPa"
    )
    file: str | None = optional(
        "measured map that is simulated instead of random patches, a file of an instrument; relative to "
        "the case file",
        "seat.x3p",
    )
    unit: Annotated[tuple[str, ...], LengthUnits(most=2, what='["mm", "um"]')] | None = optional(
        "unit of length of the map and its heights, if the file states none", "um"
    )
    continuation: Literal["mirror", "window"] = Field(
        "mirror",
        description='how the map becomes periodic: "mirror": with its mirror images, a side twice as long; "window": '
        "its border is brought down to the mean",
    )
    folder: str | None = optional(
        "where finished pieces are kept for the next run, relative to the case file; <case name>.direct "
        "unless given",
        "ball.direct",
    )

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
