"""What the tables [closure] and [seat] of the case file have in common: dimensions and materials."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Annotated, Any, ClassVar, cast

from pydantic import Field, GetCoreSchemaHandler, GetJsonSchemaHandler, model_validator
from pydantic_core import CoreSchema, core_schema

from fem_seal.case.fields import Number, Numbers, Pressures, Quantity, Table
from fem_seal.case.input_files import read_stress_strain
from fem_seal.errors import InputError, Problem
from fem_seal.materials import LIBRARY, HardeningCurve, Material, material
from meshes import Shape

Length = Annotated[float, Quantity("length", "10 um", "10 m")]
# Of roundings and steps; zero is sharp or flush.
SmallLength = Annotated[float, Quantity("length", "0 um", "10 m")]
Inclination = Annotated[float, Quantity("angle", "0 deg", "90 deg", exclusive=True)]
Modulus = Annotated[float, Quantity("pressure", "1 MPa", "2 TPa")]
_STRENGTH = Quantity("pressure", "0.1 MPa", "200 GPa")
Strength = Annotated[float, _STRENGTH]
# Up to whatever was meant as per cent: the hardening curve then says what is wrong.
_STRAIN = Number(0, 100)


# Keys of a body that are no dimensions of its shape.
_OTHER_KEYS = {"shape", "material", "wall", "interference"}


class Body(Table):
    """Base of the tables [closure] and [seat]."""

    makes: ClassVar[Callable[..., Shape]]
    """Maker of the shape. Its parameters are called like the keys of the table, and know what an open one is."""

    def made(self, **around: Shape) -> Shape:
        """The shape with the dimensions that are given."""
        given = {key: value for key, value in self if key not in _OTHER_KEYS and value is not None}
        return type(self).makes(**around, **given)

    def problems(self) -> Iterator[Problem]:
        """What is wrong with the keys together, before there is a shape."""
        yield from ()


class StressStrain(Table):
    """A stress-strain curve in tension, true stress over true strain, from a file or written out."""

    file: str | None = Field(
        None,
        description="text file with a header and the columns plastic_strain (or strain, elastic and plastic together) "
        "and stress with its unit; relative to the case file",
        examples=["seat_curve.csv"],
    )
    plastic_strain: Annotated[tuple[float, ...], Numbers(_STRAIN)] | None = Field(
        None,
        description="true plastic strain as a number, 0.1 is 10 %, beginning with 0",
        examples=[[0, 0.02, 0.1]],
    )
    strain: Annotated[tuple[float, ...], Numbers(_STRAIN)] | None = Field(
        None,
        description="true strain, elastic and plastic together, beginning at the yield point, stress/E; instead of "
        "plastic_strain",
        examples=[[0.00119, 0.02, 0.1]],
    )
    stress: Annotated[tuple[float, ...], Pressures(_STRENGTH)] | None = Field(
        None, description="true stress", examples=[["250 MPa", "310 MPa", "350 MPa"]]
    )

    @model_validator(mode="after")
    def _one_source(self) -> StressStrain:
        strains = [self.strain, self.plastic_strain]
        written = self.file is None and strains.count(None) == 1 and self.stress is not None
        from_file = self.file is not None and strains.count(None) == 2 and self.stress is None
        if not (written or from_file):
            raise ValueError(
                'needs file = "curve.csv", or plastic_strain = [0, 0.1] (or strain) together with '
                'stress = ["250 MPa", "350 MPa"]'
            )
        if self.file is not None:
            read_stress_strain(self.file)
        return self

    def curve(self, youngs_modulus: float) -> HardeningCurve:
        """The hardening curve; InputError or TextTableError if the table is none."""
        if self.file is not None:
            kind, strain, stress = read_stress_strain(self.file)
        else:
            kind = "strain" if self.plastic_strain is None else "plastic_strain"
            strain, stress = self.plastic_strain or self.strain or (), self.stress or ()
        if kind == "strain":
            return HardeningCurve.from_total_strain(strain, stress, youngs_modulus)
        return HardeningCurve(strain, stress)


class MaterialTable(Table):
    """A material given by its numbers."""

    name: str = Field("user-defined", description="how tables and reports call it", max_length=80)
    youngs_modulus: Modulus = Field(description="E", examples=["210 GPa"])
    poissons_ratio: Annotated[float, Number(0, 0.499)] = Field(description="nu", examples=[0.3])
    hardness: Strength | None = Field(
        None,
        description="penetration hardness, the pressure at which asperities yield; about three times the "
        "yield stress at 15 % strain",
        examples=["3.5 GPa"],
    )
    yield_stress: Strength | None = Field(
        None,
        description="onset of plastic flow in tension; a von Mises stress above it is warned about",
        examples=["1 GPa"],
    )
    stress_strain: StressStrain | None = Field(
        None,
        description="stress-strain curve of a body that is solved as elastoplastic, with isotropic hardening; elastic "
        "whatever its stress unless given",
        examples=[{"plastic_strain": [0, 0.1], "stress": ["250 MPa", "350 MPa"]}],
    )


class MaterialEntry:
    """A name from the library or a table; read as a `Material`."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_wrap_validator_function(self.read, handler.generate_schema(MaterialTable))

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        table = handler(cast(core_schema.WrapValidatorFunctionSchema, schema)["schema"])
        return {"anyOf": [{"type": "string", "enum": list(LIBRARY)}, table]}

    @staticmethod
    def read(value: object, read_table: core_schema.ValidatorFunctionWrapHandler) -> Material:
        """Material from what stands in the file; ValueError if the library does not have it."""
        if isinstance(value, Material):
            return value
        if isinstance(value, str):
            try:
                return material(value)
            except InputError as error:
                raise ValueError(error.message) from None
        if not isinstance(value, dict):
            raise ValueError(
                'is no material; write a name such as "steel", or '
                '{ youngs_modulus = "210 GPa", poissons_ratio = 0.3, hardness = "3.5 GPa" }'
            )
        table = read_table(value)
        if (
            table.hardness is not None
            and table.yield_stress is not None
            and table.hardness < table.yield_stress
        ):
            raise ValueError(
                f"hardness = {table.hardness / 1e6:g} MPa must not be below yield_stress = "
                f"{table.yield_stress / 1e6:g} MPa (Tabor: about three times as large)"
            )
        try:
            hardening = table.stress_strain and table.stress_strain.curve(table.youngs_modulus)
            return Material(
                **table.model_dump(exclude={"stress_strain"}), source="case file", hardening=hardening
            )
        except InputError as error:
            raise ValueError(str(error)) from None


def place_body_files(body: object, folder: Path) -> None:
    """Make the files of a body's profile and material, as they stand in a case file, relative to that file's folder."""
    if isinstance(body, dict) and isinstance(body.get("file"), str):
        body["file"] = str(folder / body["file"])
    material = body.get("material") if isinstance(body, dict) else None
    curve = material.get("stress_strain") if isinstance(material, dict) else None
    if isinstance(curve, dict) and isinstance(curve.get("file"), str):
        curve["file"] = str(folder / curve["file"])


MaterialField = Annotated[Material, MaterialEntry()]


def material_field() -> Any:
    """Entry for the material of a body."""
    return Field(description="name from the library, or a table", examples=["steel"])


def required(description: str, example: str) -> Any:
    """Entry for a dimension that has to be given."""
    return Field(description=description, examples=[example])


def dimension(description: str, example: str) -> Any:
    """Entry for a dimension that may be left open; the description ends with what it is then."""
    return Field(None, description=description, examples=[example])
