"""The tables [closure] and [seat] of the case file, and the materials in them.

A new shape comes in as one more model beside `Ball` or `Cone`, in the union of its table in `case.Case`.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal, cast

from pydantic import BaseModel, ConfigDict, Field, GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, core_schema

import meshes
from fem_seal.case_fields import Number, Quantity
from fem_seal.errors import InputError
from fem_seal.materials import LIBRARY, Material, material
from meshes import Shape

LENGTH = Quantity("length", "10 um", "10 m")
MODULUS = Quantity("pressure", "1 MPa", "2 TPa")
STRENGTH = Quantity("pressure", "0.1 MPa", "200 GPa")


class Table(BaseModel):
    """Base of all tables: frozen, unknown keys refused, nothing converted silently."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, validate_default=False)


class MaterialTable(Table):
    """A material given by its numbers."""

    name: str = Field("user-defined", description="how tables and reports call it", max_length=80)
    youngs_modulus: Annotated[float, MODULUS] = Field(description="E", examples=["210 GPa"])
    poissons_ratio: Annotated[float, Number(0, 0.499)] = Field(description="nu", examples=[0.3])
    hardness: Annotated[float, STRENGTH] | None = Field(
        None,
        description="penetration hardness, the pressure at which asperities yield; about three times the "
        "yield stress at 15 % strain",
        examples=["3.5 GPa"],
    )
    yield_stress: Annotated[float, STRENGTH] | None = Field(
        None,
        description="onset of plastic flow in tension; a von Mises stress above it is warned about",
        examples=["1 GPa"],
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
                raise ValueError(error.allowed) from None
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
        return Material(**table.model_dump(), source="case file")


MaterialField = Annotated[Material, MaterialEntry()]


class Ball(Table):
    """[closure] shape = "ball": a ball, the body that moves along the axis."""

    shape: Literal["ball"] = Field(description="shape of the closure", examples=["ball"])
    radius: Annotated[float, LENGTH] = Field(description="radius R of the ball", examples=["20 mm"])
    cavity_radius: Annotated[float, LENGTH] | None = Field(
        None, description="radius of the cavity of a hollow ball; solid", examples=["15 mm"]
    )
    material: MaterialField = Field(description="name from the library, or a table", examples=["steel"])

    def body(self) -> Shape:
        """The closure that is meshed."""
        return meshes.Ball(self.radius, self.cavity_radius or 0.0)


class Cone(Table):
    """[seat] shape = "cone": a conical seat in a cylindrical housing, held at its bottom."""

    shape: Literal["cone"] = Field(description="shape of the seat", examples=["cone"])
    angle: Annotated[float, Quantity("angle", "0 deg", "90 deg", exclusive=True)] = Field(
        description="between the axis and the contact normal; the half-angle of the cone, measured from the "
        "axis, is 90 deg minus this",
        examples=["45 deg"],
    )
    material: MaterialField = Field(description="name from the library, or a table", examples=["steel"])
    bore_radius: Annotated[float, LENGTH] | None = Field(
        None,
        description="radius of the bore below the conical face; sized from the problem",
        examples=["10 mm"],
    )
    face_radius: Annotated[float, LENGTH] | None = Field(
        None,
        description="radius of the upper edge of the conical face; sized from the problem",
        examples=["18 mm"],
    )
    outer_radius: Annotated[float, LENGTH] | None = Field(
        None, description="radius of the housing; sized from the problem", examples=["40 mm"]
    )
    height: Annotated[float, LENGTH] | None = Field(
        None,
        description="from the lower edge of the face to the bottom of the housing; sized from the problem",
        examples=["40 mm"],
    )

    def body(self, closure: Shape) -> Shape:
        """The seat that is meshed, with the dimensions that are left open in proportion to the closure."""
        return meshes.ConicalSeat.around(
            self.angle,
            closure,
            bore_radius=self.bore_radius,
            face_radius=self.face_radius,
            outer_radius=self.outer_radius,
            height=self.height,
        )
