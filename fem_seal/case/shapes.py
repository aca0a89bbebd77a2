"""The tables [closure], [seat] and [gasket]: a model of each shape, of the dimensions that its maker takes."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, cast

from pydantic import Field, create_model

import meshes
from fem_seal.case.fields import Quantity, Table
from fem_seal.case.material_table import MaterialField
from fem_seal.errors import Problem
from fem_seal.files import problem
from fem_seal.materials import Material
from meshes import GeometryError, Shape

Length = Annotated[float, Quantity("length", "10 um", "10 m")]
# Of a rounding that has to be there.
Rounding = Annotated[float, Quantity("length", "0.1 um", "10 m")]
# Of roundings and steps; zero is sharp or flush.
SmallLength = Annotated[float, Quantity("length", "0 um", "10 m")]
Inclination = Annotated[float, Quantity("angle", "0 deg", "90 deg", exclusive=True)]

# What stands at a key of a shape that is neither a length above zero nor an inclination between 0 and 90 deg.
_KINDS: dict[str, Any] = {
    "relief_angle": Annotated[float, Quantity("angle", "0 deg", "90 deg")],
    "top_angle": Annotated[float, Quantity("angle", "-90 deg", "90 deg", exclusive=True)],
    "recess": SmallLength,
}
# Keys of a body that are no dimensions of its shape.
_OTHER_KEYS = {"shape", "material", "wall", "base", "interference", "stop"}


class Body(Table):
    """Base of the tables [closure], [seat] and [gasket]."""

    makes: ClassVar[Callable[..., Shape]]
    """Maker of the shape. Its parameters are the keys of the table, and it knows what an open one is."""

    if TYPE_CHECKING:
        shape: str
        material: Material

    def make_shape(self, **neighbours: Shape) -> Shape:
        """The shape with the dimensions that are given."""
        sizes = {key: value for key, value in self if key not in _OTHER_KEYS and value is not None}
        return type(self).makes(**neighbours, **sizes)

    def problems(self) -> Iterator[Problem]:
        """What is wrong with the keys together, before there is a shape."""
        yield from ()


class Closure(Body):
    """A closure of any shape."""

    base: Literal["free", "held"] = "free"

    def body(self) -> Shape:
        """The closure that is meshed."""
        return self.make_shape()


class HeldSeat(Body):
    """How a seat is held, whatever its shape."""

    material: MaterialField
    wall: Literal["free", "fixed"] = "free"
    base: Literal["free", "held"] = "free"
    interference: Annotated[float, Quantity("length", "0 um", "10 mm")] | None = None

    def problems(self) -> Iterator[Problem]:
        """A seat can only be pressed into something that holds it."""
        if self.interference and self.wall == "free":
            yield problem("interference_of_free_wall", value=1e6 * self.interference)

    def body(self, closure: Shape) -> Shape:
        """The seat that is meshed, with the dimensions that are left open in proportion to the closure."""
        return self.make_shape(closure=closure)


class HousedSeat(HeldSeat):
    """A seat that is the top of a cylindrical housing with a bore."""

    outer_radius: Length | None = None
    height: Length | None = None


class Gasket(Body):
    """A gasket of any shape that is symmetric about its mid-plane, on which the lower end of its upper half rests."""

    wall: ClassVar[Literal["free"]] = "free"
    base: ClassVar[Literal["free"]] = "free"
    interference: ClassVar[None] = None
    stop: Annotated[float, Quantity("length", "1 um", "10 m")] | None = None

    def body(self, closure: Shape) -> Shape:
        """The upper half, which is meshed."""
        return self.make_shape()


class FlangeFace(Closure):
    """The face of a flange with a bore, which takes a gasket."""

    def body(self) -> Shape:
        """The flange that is meshed."""
        try:
            return self.make_shape()
        except GeometryError as error:
            # its face is made as a seat
            raise GeometryError(re.sub("^seat ", "closure ", str(error))) from error


class _Poppet(Closure):
    """A closure that is given by one or two of three radii."""

    def problems(self) -> Iterator[Problem]:
        """What is wrong with the radii together."""
        radii = [key for key in ("outer_radius", "inner_radius", "mean_radius") if getattr(self, key)]
        if not 1 <= len(radii) <= 2:
            which = "none is given" if not radii else "all three are given"
            yield problem("radii_of_cone", which=which)


class _Land(HousedSeat):
    """A seat whose land begins at the bore."""

    @property
    def bore_radius(self) -> float:
        """Radius of the bore [m]."""
        radius: float = vars(self)["land_inner_radius"]
        return radius


def _model(
    name: str,
    shape: str,
    makes: Callable[..., Shape],
    base: type[Body] | None = None,
    edge: Any = SmallLength,
) -> type[Body]:
    """Table of a shape: its word, then a key for each parameter of its maker that its base does not have.

    Parameters
    ----------
    name : str
        Of the model; what it is stands under this name in templates/keys.toml.
    shape : str
        The word for it.
    makes : callable
        Its maker; that of a seat takes the closure.
    base : type, optional
        `Closure` or `HousedSeat` unless given.
    edge : type
        What stands at its edge_radius.
    """
    parameters = dict(inspect.signature(makes).parameters)
    is_seat = parameters.pop("closure", None) is not None
    base = base or (HousedSeat if is_seat else Closure)
    fields: dict[str, Any] = {"shape": (Literal[shape], ...)}
    for key, parameter in parameters.items():
        if key not in base.model_fields:
            usual = Inclination if key.endswith("angle") else Length
            kind = edge if key == "edge_radius" else _KINDS.get(key, usual)
            fields[key] = (kind, ...) if parameter.default is parameter.empty else (kind | None, None)
    if not is_seat:
        fields["material"] = (MaterialField, ...)
    table = cast("type[Body]", create_model(name, __base__=base, __module__=__name__, **fields))
    table.makes = makes
    return table


Ball = _model("Ball", "ball", meshes.Ball)
RoundedCone = _model("RoundedCone", "cone", meshes.RoundedCone.of, _Poppet)
ToroidalEdge = _model("ToroidalEdge", "torus", meshes.ToroidalEdge.of)
SphericalTip = _model("SphericalTip", "spherical-tip", meshes.SphericalTip.of)
Disc = _model("Disc", "disc", meshes.Disc.of, edge=Rounding)
CLOSURES = (Ball, RoundedCone, ToroidalEdge, SphericalTip, Disc)

ConicalSeat = _model("ConicalSeat", "cone", meshes.ConicalSeat.around)
ConicalLand = _model("ConicalLand", "conical-land", meshes.ConicalLand.around)
Sphere = _model("Sphere", "sphere", meshes.SphericalSeat.around)
ToroidalSeat = _model("ToroidalSeat", "torus", meshes.ToroidalSeat.around)
Flat = _model("Flat", "flat", meshes.FlatSeat.on, edge=Rounding)
FlatLand = _model("FlatLand", "flat-land", meshes.FlatLand.on, _Land, Rounding)
SharpEdge = _model("SharpEdge", "sharp-edge", meshes.SharpEdge.around, edge=Rounding)


class _OneOfLands(Table):
    """Base of the lands of a seat."""

    if TYPE_CHECKING:
        shape: str
        set_back: float | None

    def make_land(self, closure: Shape, number: int) -> meshes.Land:
        """The land with the dimensions that are given, its number counted from one for what is wrong with them."""
        sizes = {key: value for key, value in self if key not in ("shape", "set_back") and value is not None}
        maker: Callable[..., Any] = (
            meshes.FlatLand.on if self.shape == "flat-land" else meshes.ConicalLand.around
        )
        try:
            return meshes.Land(maker(closure=closure, **sizes), self.set_back or 0.0)
        except GeometryError as error:
            raise GeometryError(re.sub("^seat ", f"seat lands[{number}].", str(error))) from error


class ConicalOfLands(_OneOfLands):
    """One of [[seat.lands]], shape = "conical-land"."""

    shape: Literal["conical-land"]
    angle: Inclination
    land_width: Length | None = None
    land_radius: Length | None = None
    edge_radius: SmallLength | None = None
    set_back: SmallLength | None = None


class FlatOfLands(_OneOfLands):
    """One of [[seat.lands]], shape = "flat-land"."""

    shape: Literal["flat-land"]
    land_inner_radius: Length
    land_outer_radius: Length
    edge_radius: Rounding | None = None
    set_back: SmallLength | None = None


class Lands(HousedSeat):
    """[seat] shape = "lands": several lands one behind the other, with chambers between them."""

    shape: Literal["lands"]
    lands: tuple[Annotated[ConicalOfLands | FlatOfLands, Field(discriminator="shape")], ...] = Field(
        strict=False
    )
    chamber_depth: Length | None = None

    def body(self, closure: Shape) -> Shape:
        """The seat that is meshed, with the dimensions that are left open in proportion to the closure."""
        return meshes.Lands.around(
            [land.make_land(closure, number) for number, land in enumerate(self.lands, start=1)],
            closure,
            chamber_depth=self.chamber_depth,
            outer_radius=self.outer_radius,
            height=self.height,
        )


SEATS = (ConicalSeat, ConicalLand, Sphere, ToroidalSeat, Flat, FlatLand, SharpEdge)

RaisedFace = _model("RaisedFace", "flat-land", meshes.FlangeFace.raised, FlangeFace, Rounding)
FlatFace = _model("FlatFace", "flat", meshes.FlangeFace.flat, FlangeFace, Rounding)
ConicalFace = _model("ConicalFace", "conical-face", meshes.FlangeFace.conical, FlangeFace)
GroovedFace = _model("GroovedFace", "groove", meshes.FlangeFace.grooved, FlangeFace)
FLANGES = (RaisedFace, FlatFace, ConicalFace, GroovedFace)

SolidRing = _model("SolidRing", "ring", meshes.SolidRing, Gasket)
LensRing = _model("LensRing", "lens", meshes.LensRing, Gasket)
DeltaRing = _model("DeltaRing", "delta", meshes.DeltaRing, Gasket, Rounding)
DoubleConeRing = _model("DoubleConeRing", "double-cone", meshes.DoubleConeRing, Gasket)
OctagonalRing = _model("OctagonalRing", "octagonal", meshes.OctagonalRing, Gasket)
GASKETS = (SolidRing, LensRing, DeltaRing, DoubleConeRing, OctagonalRing)
