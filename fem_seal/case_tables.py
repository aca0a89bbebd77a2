"""The tables of the case file that describe the interface, the fluid and the loads.

One frozen model per table, in SI after reading. A new kind of spectrum comes in as one more model in the
union of `Roughness.spectrum`.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import ConfigDict, Field, field_validator, model_validator

from fem_seal.case_bodies import Table
from fem_seal.case_fields import Number, Pressures, Quantity, shown
from fem_seal.spectrum_file import read_spectrum

if TYPE_CHECKING:
    from leak import PowerSpectrum

SEPARATION = Quantity("length", "1e-3 nm", "1 mm")
WAVENUMBER = Quantity("wavenumber", "1 1/m", "1e12 1/m")
FLUID_PRESSURE = Quantity("pressure", "0 Pa", "10 GPa", exclusive=True)


class SelfAffine(Table):
    """kind = "self-affine": isotropic, constant up to q_rolloff, then falling as q^(-2 (1 + hurst))."""

    kind: Literal["self-affine"] = Field(description="kind of spectrum", examples=["self-affine"])
    rms_height: Annotated[float, Quantity("length", "0.01 nm", "1 mm")] = Field(
        description="root-mean-square height of the combined roughness of both surfaces", examples=["1.9 um"]
    )
    hurst: Annotated[float, Number(0, 1, exclusive_low=True)] = Field(
        description="Hurst exponent", examples=[0.6]
    )
    q_low: Annotated[float, WAVENUMBER] = Field(
        description="smallest wavenumber, 2 pi over the longest wavelength", examples=["1e3 1/m"]
    )
    q_rolloff: Annotated[float, WAVENUMBER] = Field(
        description="wavenumber above which the spectrum falls", examples=["3.727e4 1/m"]
    )
    q_high: Annotated[float, WAVENUMBER] = Field(
        description="largest wavenumber, 2 pi over the shortest wavelength", examples=["3.1416e6 1/m"]
    )

    def build(self) -> PowerSpectrum:
        """The spectrum as `leak` takes it."""
        from leak import PowerSpectrum

        return PowerSpectrum.self_affine(**self.model_dump(exclude={"kind"}))


class Tabulated(Table):
    """kind = "table": a two-dimensional isotropic spectrum from a file."""

    kind: Literal["table"] = Field(description="kind of spectrum", examples=["table"])
    file: str = Field(
        description="text file with two columns, wavenumber q [1/m] and density C [m^4], relative to the "
        "case file",
        examples=["C.csv"],
    )

    @field_validator("file")
    @classmethod
    def _readable(cls, file: str) -> str:
        read_spectrum(file)
        return str(Path(file).absolute())

    def build(self) -> PowerSpectrum:
        """The spectrum as `leak` takes it."""
        from leak import PowerSpectrum

        return PowerSpectrum.from_table(*read_spectrum(self.file))


class Roughness(Table):
    """[roughness]: combined roughness of both surfaces."""

    spectrum: Annotated[SelfAffine | Tabulated, Field(discriminator="kind")] = Field(
        description="power spectrum; the spectra of the two surfaces add"
    )


class Interface(Table):
    """[interface]: law between contact pressure and gap that carries the macroscopic contact."""

    law: Literal["persson", "exponential", "smooth"] = Field(
        "persson",
        description='"persson": the full p(u) of the spectrum; "exponential": p = p_c exp(-u/u0); "smooth": '
        "hard contact without roughness",
    )
    plastic: bool = Field(
        False,
        description='with law = "persson": p(u) of the elastic (false) or of the plastically smoothed '
        "spectrum (true)",
    )
    gamma: Annotated[float, Number(0.01, 2)] | None = Field(
        None,
        description='with law = "exponential": u0 = gamma times the rms height; 0.4 unless given',
        examples=[0.4],
    )
    u0: Annotated[float, SEPARATION] | None = Field(
        None,
        description='with law = "exponential": decay length of the law, instead of gamma',
        examples=["0.76 um"],
    )
    p_c: Annotated[float, Quantity("pressure", "1 Pa", "1e6 GPa")] | None = Field(
        None,
        description='with law = "exponential": pressure at zero gap; taken from the spectrum unless given. '
        "It shifts the gap, not the pressure profile",
        examples=["10 GPa"],
    )


class Fluid(Table):
    """[fluid]: the liquid that leaks, from the library by name, or by its viscosity."""

    model_config = ConfigDict(
        json_schema_extra=lambda schema: schema.update(
            anyOf=[{"required": ["name"]}, {"required": ["viscosity"]}], required=[]
        )
    )
    name: str = Field(
        "user-defined", description="library entry, or any name beside viscosity", max_length=80
    )
    viscosity: Annotated[float, Quantity("viscosity", "1e-4 mPa s", "1e6 Pa s")] = Field(
        description="dynamic viscosity; taken from the library unless given", examples=["1 mPa s"]
    )

    @model_validator(mode="before")
    @classmethod
    def _from_library(cls, table: Any) -> Any:
        if not isinstance(table, dict) or "viscosity" in table or not isinstance(table.get("name"), str):
            return table
        from leak import FLUIDS, liquid

        if table["name"] not in FLUIDS:
            known = ", ".join(f'"{name}"' for name in FLUIDS)
            raise ValueError(
                f"{shown(table['name'])} is not in the library; known are {known}, or give its viscosity"
            )
        return {**table, "viscosity": f"{liquid(table['name']).viscosity!r} Pa s"}


class Load(Table):
    """[load]: fluid pressures, one result each, and the force on the closure."""

    fluid_pressure: Annotated[tuple[float, ...], Pressures(FLUID_PRESSURE)] = Field(
        description='pressure difference across the seal: one, a list, or { start = "1 bar", '
        'stop = "20 bar", num = 20, spacing = "linear" or "log" }',
        examples=[["1 bar", "20 bar"]],
    )
    axial_force: Annotated[float, Quantity("force", "-1e9 N", "1e9 N")] = Field(
        0.0,
        description="additional force on the closure, positive when it closes the seal",
        examples=["0 N"],
        json_schema_extra={"default": "0 N"},
    )
    closing: Literal["sealed-area"] = Field(
        "sealed-area", description='"sealed-area": the fluid pressure acts on the circle of first touch'
    )
    pressure_side: Literal["outer", "inner"] = Field(
        "outer",
        description='side of the high pressure: "outer" (around the closure, presses it on the seat) or '
        '"inner" (in the bore, lifts it)',
    )


class Leak(Table):
    """[leak]: how the leak rate follows from the contact."""

    plasticity: bool = Field(
        True,
        description="asperities yield at the hardness of the softer body; needs a hardness of a material",
    )
    percolation_threshold: Annotated[float, Number(0.05, 0.95)] = Field(
        0.42, description="relative contact area above which no channel is open"
    )
    conductivity: Literal["bruggeman", "critical-junction"] = Field(
        "bruggeman", description="effective medium of all channels, or the narrowest junction alone"
    )


class Mesh(Table):
    """[mesh]: sized from the problem unless given."""

    contact_size: Annotated[float, Quantity("length", "1 nm", "0.1 m")] | None = Field(
        None, description="size of the elements along the contact line", examples=["20 um"]
    )


class Output(Table):
    """[output]: where the results go."""

    folder: str | None = Field(
        None,
        description="results folder, relative to the case file; <case name>.out unless given",
        examples=["out"],
    )
