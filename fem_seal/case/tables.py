"""All tables of a case file, and what follows from them directly.

One frozen model per table, in SI after reading.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self, Union

from pydantic import Discriminator, Field, PrivateAttr, Tag, create_model, model_validator

from fem_seal.case import shapes
from fem_seal.case.bolts import BoltsTable
from fem_seal.case.drawn import ClosureProfile, GasketProfile, SeatProfile
from fem_seal.case.fields import (
    FORMS,
    RATES,
    Bubbles,
    Chamber,
    Drops,
    LeakRate,
    NominalSizeEntry,
    NormalVolume,
    Number,
    Numbers,
    OneOrMany,
    Pressures,
    Quantity,
    Several,
    Table,
    Throughput,
    WholeNumber,
)
from fem_seal.case.fluid import Fluid
from fem_seal.case.form import Form
from fem_seal.case.roughness import LengthUnits, Roughness
from fem_seal.case.temperature import Temperature
from fem_seal.errors import InputError, Problem
from fem_seal.files import problem
from fem_seal.loads import Closing, blow_off_of_sealed_area, contact_force, expected_force
from fem_seal.materials import HardeningCurve, Material, effective_modulus
from fem_seal.units import Display, System, Unit, unit_as_written
from leak.standards import DROP_VOLUME
from meshes import ContactGeometry, Shape

if TYPE_CHECKING:
    from collections.abc import Collection

    from fem_seal.form import FormError
    from leak.standards import ClosureTest


SEPARATION = Quantity("length", "1e-3 nm", "1 mm")
FLUID_PRESSURE = Quantity("pressure", "0 Pa", "10 GPa", exclusive=True)
NO_OR_FLUID_PRESSURE = Quantity("pressure", "0 Pa", "10 GPa")
CHAMBER_PRESSURE = Chamber("pressure", "0 Pa", "10 GPa")
EARLIER_FORCE = Quantity("force", "0 N", "1e9 N", exclusive=True)


class Interface(Table):
    """[interface]: law between contact pressure and gap that carries the macroscopic contact."""

    law: Literal["spectrum", "exponential", "smooth"] = "spectrum"
    plastic: bool = False
    gamma: Annotated[float, Number(0.01, 2)] | None = None
    u0: Annotated[float, SEPARATION] | None = None
    p_c: Annotated[float, Quantity("pressure", "1 Pa", "1e6 GPa")] | None = None


class SideForce(Table):
    """[load.side_force]: a force on the closure at right angles to the axis."""

    force: Annotated[float, Quantity("force", "-1e9 N", "1e9 N")]
    height: Annotated[float, Quantity("length", "-100 m", "100 m")]


class Load(Table):
    """[load]: fluid pressures, one result each and in this order, and the force on the closure."""

    fluid_pressure: Annotated[tuple[float, ...], Pressures(NO_OR_FLUID_PRESSURE)] = (0.0,)
    applied_force: Annotated[float | tuple[float, ...], OneOrMany("force", "-1e9 N", "1e9 N")] = 0.0
    set_pressure: Annotated[float, FLUID_PRESSURE] | None = None
    closing: Literal["sealed-area", "penetration"] = "sealed-area"
    pressure_side: Literal["outer", "inner"] = "outer"
    largest_earlier_force: Annotated[float, EARLIER_FORCE] | None = None
    largest_earlier_pressure: Annotated[float, FLUID_PRESSURE] | None = None
    target_leak_rate: Annotated[float, LeakRate("leak rate", "1e-30 m^3/s", "1e3 m^3/s")] | None = None
    chamber_pressure: Annotated[tuple[float | None, ...], Several(CHAMBER_PRESSURE)] | None = None
    bending_moment: Annotated[float, Quantity("torque", "-1e9 N m", "1e9 N m")] = 0.0
    side_force: SideForce | None = None

    @model_validator(mode="after")
    def _one_pressure_under_all_forces(self) -> Load:
        if isinstance(self.applied_force, tuple) and len(self.fluid_pressure) == 1:
            # set during construction, before the model is shared
            object.__setattr__(self, "fluid_pressure", self.fluid_pressure * len(self.applied_force))
        return self

    @model_validator(mode="after")
    def _one_force(self) -> Load:
        if self.set_pressure is not None and "applied_force" in self.model_fields_set:
            raise ValueError(problem("set_pressure_and_force"))
        if self.set_pressure is not None and self.pressure_side != "inner":
            raise ValueError(problem("set_pressure_side"))
        return self

    def with_spring(self, sealing_radius: float) -> Load:
        """The same with the force of a spring that holds the set pressure on a circle [m]."""
        assert self.set_pressure is not None
        return self.model_copy(update={"applied_force": contact_force(sealing_radius, self.set_pressure)})

    @property
    def is_dry(self) -> bool:
        """Whether no load has a fluid pressure."""
        return not any(self.fluid_pressure)

    @property
    def moment(self) -> float:
        """That the contact carries about the centre of the circle of first touch [N m]."""
        side = self.side_force
        return self.bending_moment + (0.0 if side is None else side.force * side.height)

    @property
    def points(self) -> tuple[tuple[float, float], ...]:
        """Fluid pressure [Pa] and applied force [N] of every load."""
        forces = self.applied_force
        each = forces if isinstance(forces, tuple) else (forces,) * len(self.fluid_pressure)
        return tuple(zip(self.fluid_pressure, each, strict=True))

    @property
    def earlier(self) -> tuple[float, float] | None:
        """Fluid pressure [Pa] and applied force [N] of the largest load before all of them; None if none is given."""
        if self.largest_earlier_force is not None:
            return 0.0, self.largest_earlier_force
        if self.largest_earlier_pressure is not None:
            return self.largest_earlier_pressure, max(force for _, force in self.points)
        return None

    @property
    def path(self) -> tuple[tuple[float, float], ...]:
        """All of them after the largest load before them, where one is given."""
        return self.points if self.earlier is None else (self.earlier, *self.points)

    @property
    def earlier_key(self) -> str:
        """Key of that load."""
        return "load.largest_earlier_" + ("pressure" if self.largest_earlier_force is None else "force")

    def without_loads(self, numbers: Collection[int]) -> Load:
        """The same without some of the loads."""
        points = [point for number, point in enumerate(self.points) if number not in numbers]
        pressures, forces = zip(*points, strict=True)
        return self.model_copy(update={"fluid_pressure": pressures, "applied_force": forces})


class MapPart(Table):
    """A part of the edge of a map: where a field has a value, or inside a box."""

    field: str | None = None
    value: float | int | None = None
    box: Annotated[tuple[float, ...], Several(Quantity("length", "-100 m", "100 m"))] | None = None

    @model_validator(mode="after")
    def _one(self) -> MapPart:
        missing = (self.field, self.value).count(None)
        if (missing, 0 if self.box is None else len(self.box)) not in {(0, 0), (2, 6)}:
            raise ValueError(problem("map_part"))
        return self


Part = Annotated[
    Annotated[str, Tag(FORMS[1])] | Annotated[MapPart, Tag(FORMS[0])],
    Discriminator(lambda value: FORMS[isinstance(value, str)]),
]


class Map(Table):
    """[map]: where the fluid stands at the edge of a map of contact pressure, and how the lay of the roughness lies."""

    high: Part | None = None
    low: Part | None = None
    wall: Part | None = None
    lay: Annotated[tuple[float, ...], Numbers(Number(-1e6, 1e6))] | None = None

    @model_validator(mode="after")
    def _direction(self) -> Map:
        if self.lay is not None and not (len(self.lay) == 3 and any(self.lay)):
            raise ValueError(problem("map_lay"))
        return self

    @property
    def parts(self) -> dict[str, str | MapPart]:
        """Of the edge, by their keys."""
        return {name: part for name in ("high", "low", "wall") if (part := getattr(self, name)) is not None}


class Leak(Table):
    """[leak]: how the leak rate is calculated from the contact."""

    theory: Literal["paper", "corrected"] = "corrected"
    plasticity: bool = True
    percolation_threshold: Annotated[float, Number(0.05, 0.95)] = 0.42
    conductivity: Literal["bruggeman", "direct"] = "bruggeman"
    fluid_in_gap: Literal["uncoupled", "local"] = "uncoupled"
    nominal_size: Annotated[float, NominalSizeEntry("length", "1 mm", "5 m")] | None = None


class Mesh(Table):
    """[mesh]: sized from the problem unless given."""

    contact_size: Annotated[float, Quantity("length", "1 nm", "0.1 m")] | None = None


class Output(Table):
    """[output]: where the results are written."""

    folder: str | None = None


class ReportTable(Table):
    """[report]: how results are shown."""

    units: System | None = None


Asperities = Literal["elastic", "capped", "von-mises"]
CONTACT_PRESSURE = Quantity("pressure", "1 Pa", "1e6 GPa")


class Direct(Table):
    """[direct]: direct simulation of a rough patch, see guide/direct in the manual."""

    points: Annotated[int, WholeNumber(32, 4096)] = 256
    samples: Annotated[int, WholeNumber(1, 200)] = 3
    seed: Annotated[int, WholeNumber(0, 10**9)] = 1
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
    unit: Annotated[tuple[str, ...], LengthUnits(limit=2, example='["mm", "um"]')] | None = None
    continuation: Literal["mirror", "window"] = "mirror"
    folder: str | None = None

    @property
    def path(self) -> tuple[float, ...] | None:
        """Pressures of all branches one after the other [Pa]; None where the program chooses them."""
        return None if self.pressure is None else (*self.pressure, *(self.unload or ()))

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


class Spread(Table):
    """How an input spreads about its value in the case."""

    distribution: Literal["lognormal", "normal", "uniform"] = "lognormal"
    relative: Annotated[float, Number(0, 0.9, exclusive_low=True)]
    varies: Literal["unknown", "part"] = "unknown"


class Scans(Table):
    """How the spectrum spreads: by the differences between the scans that it was measured from."""

    distribution: Literal["scans"]
    varies: Literal["unknown", "part"] = "unknown"


class Uncertainty(Table):
    """[uncertainty]: leak rate with an interval, from inputs not known exactly; see guide/uncertainty in the manual.

    The length of measured scans is always among them.
    """

    samples: Annotated[int, WholeNumber(16, 100000)] = 256
    seed: Annotated[int, WholeNumber(0, 2**31 - 1)] = 1
    confidence: Annotated[float, Number(0.5, 0.999)] = 0.9
    viscosity: Spread | None = None
    hardness: Spread | None = None
    youngs_modulus: Spread | None = None
    rms_height: Spread | None = None
    hurst: Spread | None = None
    q_rolloff: Spread | None = None
    q_high: Spread | None = None
    form: Spread | None = None
    spectrum: Scans | None = None
    posterior: str | None = None

    @property
    def spreads(self) -> dict[str, Spread]:
        """The uncertain inputs with their spreads, without the spectrum between scans, in the order of the table."""
        return {name: value for name, value in self if isinstance(value, Spread)}

    @property
    def of_parts(self) -> set[str]:
        """Those that differ from part to part of a batch, the spectrum among them."""
        return {name for name, value in self if getattr(value, "varies", "") == "part"}


# The standard of pressure relief valves.
RELIEF = "API 527"
# Pressures that are written in other units than those of the loads are the same up to rounding.
_SAME = 1e-6


class _Requirement(Table):
    """[requirement]: what the seal must keep, for a verdict on every load; see guide/verdict in the manual."""

    leak_rate: Annotated[float, LeakRate("leak rate", "1e-30 m^3/s", "1e3 m^3/s")] | None = None
    standard: str | None = Field(None, max_length=40)
    test: Literal["service", "standard"] = "service"
    rated_pressure: Annotated[float, FLUID_PRESSURE] | None = None
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
        class_names = dict.fromkeys((*classes_of(standard, gas=True), *classes_of(standard, gas=False)))
        if self.class_name is None:
            # some have but one
            return (standard, next(iter(class_names))) if len(class_names) == 1 else None
        matches = [name for name in class_names if name.lower() == self.class_name.strip().lower()]
        return (standard, matches[0]) if matches else None

    @property
    def volume_of_bubble(self) -> float | None:
        """Its own, or that of its standard [m^3]; None where neither says it."""
        from leak.standards import STANDARDS, standard_named

        standard = None if self.standard is None else standard_named(self.standard)
        if self.bubble_volume is not None or standard is None:
            return self.bubble_volume
        return STANDARDS[standard].bubble_volume

    def tests(self, *, gas: bool) -> tuple[ClosureTest, ...]:
        """The tests of its standard for its class, of a valve for gas or for a liquid; empty without them."""
        from leak.standards import closure_tests

        standard = self.standard_and_class
        return () if standard is None else closure_tests(*standard, gas=gas)

    @property
    def pressures(self) -> tuple[float, ...]:
        """Fluid pressures of the loads that are judged [Pa]; empty if all are."""
        fluid_pressures = self.fluid_pressure
        if fluid_pressures is None:
            return ()
        return fluid_pressures if isinstance(fluid_pressures, tuple) else (fluid_pressures,)

    def judges(self, fluid_pressure: float) -> bool:
        """Whether it holds for a load with this fluid pressure [Pa]."""
        return not self.pressures or any(
            math.isclose(fluid_pressure, pressure, rel_tol=_SAME) for pressure in self.pressures
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


if TYPE_CHECKING:
    # made of the makers of the shapes, which a type checker does not follow
    Closure = shapes.Closure
    Seat = shapes.HeldSeat
    Gasket = shapes.Gasket
else:
    Closure = Annotated[
        Union[(*shapes.CLOSURES, *shapes.FLANGES, ClosureProfile)], Field(discriminator="shape")
    ]
    Seat = Annotated[Union[(*shapes.SEATS, shapes.Lands, SeatProfile)], Field(discriminator="shape")]
    Gasket = Annotated[Union[(*shapes.GASKETS, GasketProfile)], Field(discriminator="shape")]


class CaseTables(Table):
    """All tables of a case, read but not checked against each other; `Case` is."""

    title: str = ""
    closure: Closure
    seat: Seat | None = None
    gasket: Gasket | None = None
    roughness: Roughness | None = None
    interface: Interface = Interface()
    fluid: Fluid | None = None
    temperature: Temperature | None = None
    load: Load
    bolts: BoltsTable | None = None
    leak: Leak = Leak()
    map: Map | None = None
    requirement: Requirement | None = None
    direct: Direct | None = None
    form: Form | None = None
    uncertainty: Uncertainty | None = None
    mesh: Mesh = Mesh()
    report: ReportTable = ReportTable()
    output: Output = Output()

    _file: Path | None = PrivateAttr(default=None)
    _warm: dict[str, float] = PrivateAttr(default_factory=dict)
    _flange: str = PrivateAttr(default="flange")
    _has_shapes: bool = PrivateAttr(default=True)

    @property
    def has_shapes(self) -> bool:
        """Whether its bodies have shapes; those of given contacts need none."""
        return self._has_shapes

    @property
    def display(self) -> Display:
        """In which units its results are shown, and whether leak rates as pressure times volume.

        So are those of a gas, unless what is required of it, or its target, is a volume. Leak rates have the unit in
        which the case writes the limit, unless it asks for a system of units.
        """
        limit = self.load.target_leak_rate if self.requirement is None else self.requirement.leak_rate
        has_no_limit = self.requirement is None and limit is None
        of_gas = self.fluid is not None and self.fluid.gas is not None
        throughputs = of_gas and (has_no_limit or isinstance(limit, Throughput))
        rate = limit if limit is not None else self.load.target_leak_rate
        unit = None if rate is None or self.report.units else self._unit_of(rate)
        own_unit = unit if throughputs == isinstance(rate, Throughput) else None
        return Display(self.report.units or "field", throughputs, own_unit)

    def _unit_of(self, limit: float) -> Unit | None:
        """The unit in which a limit is written; None where it has none, or is that of a gas in another state."""
        if isinstance(limit, (Bubbles, Drops)):
            things, volume = (
                ("bubbles", limit.volume) if isinstance(limit, Bubbles) else ("drops", DROP_VOLUME)
            )
            return Unit(f"{things}/min", volume / 60.0)
        entry = self.written_entry("requirement.leak_rate") or self.written_entry("load.target_leak_rate")
        unit = None if isinstance(limit, NormalVolume) else unit_as_written(entry, limit)
        # numbers of Python stand there in m^3/s
        return None if unit is None or unit.size == 1.0 else unit

    def written_entry(self, key: str) -> object:
        """What stands at a key of the case file; None where nothing does, or where no file is known."""
        return None

    @property
    def faces(self) -> int:
        """Sealing faces, through which fluid leaks side by side: 1 of a valve seat, 2 of a gasket."""
        return 1 if self.gasket is None else 2

    @property
    def labels(self) -> dict[str, Any]:
        """What the body above and the one below are called: values of {upper} and {lower} in sentences."""
        if self.gasket is None:
            return {"upper": "closure", "lower": "seat"}
        return {"upper": self._flange, "lower": "gasket"}

    def label_of(self, body: str) -> str:
        """What a body is called: "closure" or "seat", also in "lower closure" and, of several contacts, "closure 1"."""
        upper = "flange" if body.startswith("lower ") else self.labels["upper"]
        labels = {"closure": upper, "seat": self.labels["lower"]}
        return " ".join(labels.get(word, word) for word in body.split())

    def key_of(self, body: str) -> str:
        """Table of a body of the contact, "closure" or "seat": of a gasket its upper half is the latter."""
        return body if body == "closure" or self.gasket is None else "gasket"

    def table_of(self, body: str) -> shapes.Closure | shapes.HeldSeat | shapes.Gasket:
        """What stands in the table of a body of the contact, "closure" or "seat"."""
        table: shapes.Closure | shapes.HeldSeat | shapes.Gasket = getattr(self, self.key_of(body))
        return table

    @property
    def lower(self) -> shapes.HeldSeat | shapes.Gasket:
        """The table of the body below: seat or gasket."""
        table = self.seat if self.gasket is None else self.gasket
        assert table is not None  # the reading of a case demands one of them
        return table

    @property
    def initial_contact_radius(self) -> float:
        """Radius r0 of the circle of first touch [m]."""
        return self.contact.initial_contact_radius

    @property
    def uneven_key(self) -> str | None:
        """What makes the line load uneven: [form], a moment of [load], or bolts one by one; None without any."""
        if self.form is not None:
            return "form"
        if self.load.moment:
            return "load.bending_moment" if self.load.bending_moment else "load.side_force"
        return None if self.bolts is None or self.bolts.circle is None else "bolts.circle_diameter"

    @property
    def form_error(self) -> FormError | None:
        """Form, moment and bolts of an uneven seal; None of an even one."""
        if self.uneven_key is None:
            return None
        form, bolts = self.form or Form(), None if self.bolts is None else self.bolts.circle
        return form.error(self.contact.angle, self.initial_contact_radius, self.load.moment, bolts)

    @property
    def on_sealed_area(self) -> bool:
        """Whether the fluid acts on the circle of first touch, so that its force is known before the contact."""
        return self.load.closing == "sealed-area" and not self.contact.chambers

    def expected_force(self, fluid_pressure: float, applied_force: float) -> float:
        """Force F_N that the solid contact is expected to carry under a load [N], see `fem_seal.loads`.

        Parameters
        ----------
        fluid_pressure, applied_force : float
            [Pa], [N].
        """
        closing: Closing = "sealed-area" if self.on_sealed_area else "penetration"
        circle, side = self.initial_contact_radius, self.load.pressure_side
        return expected_force(circle, fluid_pressure, applied_force, side, closing)

    @cached_property
    def contact(self) -> ContactGeometry:
        """Closure and seat in first touch."""
        labelled = zip(self.bodies, self.labels.values(), strict=True)
        return ContactGeometry.of(*(replace(body.outline, label=label) for body, label in labelled))

    @cached_property
    def bodies(self) -> tuple[Shape, Shape]:
        """Closure and seat with all their dimensions, those that are left open in proportion to the closure."""
        closure = self.closure.body()
        return closure, self.lower.body(closure)

    def _of_the_shape_of(self, like: CaseTables) -> bool:
        """Whether closure and seat are those of another case but for their material; a file may have changed."""
        ignored = {"material": None, "stop": None}
        return all(
            type(table) is type(like_table)
            and getattr(table, "file", None) is None
            and {**dict(table), **ignored} == {**dict(like_table), **ignored}
            for table, like_table in ((self.closure, like.closure), (self.lower, like.lower))
        )

    def _take_bodies(self, like: CaseTables) -> None:
        """Know those of a case with the same closure and seat."""
        keys = ("bodies", "contact") if like._flange == self._flange else ("bodies",)
        vars(self).update({key: vars(like)[key] for key in keys if key in vars(like)})

    def bodies_at(self, closure: float, seat: float) -> dict[str, Any]:
        """The tables of closure and seat with the materials' numbers at their temperatures.

        Parameters
        ----------
        closure, seat : float
            [K]

        Raises
        ------
        InputError
            If a table of a material does not reach there.
        """
        tables, faults = {}, list[Problem]()
        for name, temperature in (("closure", closure), ("seat", seat)):
            body, key = self.table_of(name), self.key_of(name)
            try:
                material = body.material.at(temperature)
            except InputError as error:
                faults += [replace(fault, key=f"{key}.material.{fault.key}") for fault in error.problems]
                continue
            same = material is body.material
            tables[key] = body if same else body.model_copy(update={"material": material})
        if faults:
            raise InputError(*faults)
        return tables

    @property
    def set_pressure(self) -> float | None:
        """Fluid pressure that the spring holds on the circle of first touch [Pa]; None where there is no such spring.

        That of the case, or that of its largest force where a relief valve is required (API 527).
        """
        requirement, load = self.requirement, self.load
        if load.set_pressure is not None or requirement is None or self.bolts is not None:
            return load.set_pressure
        class_pair, force = requirement.standard_and_class, max(force for _, force in load.points)
        if class_pair is None or class_pair[0] != RELIEF:
            return None
        pressure = blow_off_of_sealed_area(self.initial_contact_radius, force, load.pressure_side)
        return pressure if math.isfinite(pressure) else None

    def thermal_strain(self, name: str) -> float:
        """Strain by which the body "closure" or "seat" grows freely [-]; zero where its temperature is not given."""
        heat = self.temperature
        temperature = None if heat is None else heat.of_body(name)
        if heat is None or temperature is None:
            return 0.0
        return self.table_of(name).material.thermal_strain(temperature, heat.reference)

    @property
    def body_temperatures(self) -> dict[str, float]:
        """Temperature of "closure" and "seat", where calculated that of their faces [K]; empty where not known."""
        heat = self.temperature
        temperatures = {} if heat is None else {name: heat.of_body(name) for name in ("closure", "seat")}
        return self._warm or {name: value for name, value in temperatures.items() if value is not None}

    def with_temperatures(self, closure: float, seat: float) -> Self:
        """The same with the numbers of materials and fluid at temperatures that were calculated.

        Parameters
        ----------
        closure, seat : float
            Of their faces where they touch [K].

        Raises
        ------
        InputError
            If a table of a material, or the fluid, does not reach there.
        """
        update: dict[str, Any] = self.bodies_at(closure, seat)
        if self.fluid is not None and "temperature" not in self.fluid.model_fields_set:
            update["fluid"] = self.fluid.at(0.5 * (closure + seat))
        warm = self.model_copy(update=update)
        warm = warm.model_copy(update=warm.of_this_gas()[0])
        warm._warm = {"closure": closure, "seat": seat}
        return warm

    def of_this_gas(self) -> tuple[dict[str, Any], list[Problem]]:
        """Tables whose leak rates have the temperature of the gas and the bubbles that the case names.

        Returns
        -------
        tuple
            Changed tables, as `model_copy` takes them, and what cannot be told of their leak rates.
        """
        if self.fluid is None or self.fluid.gas is None:
            # which is said by those who look at the case as a whole
            return {}, []
        demand = self.requirement
        has_limit = demand is not None and not (demand.leak_rate is None and demand.standard is None)
        volume = None if demand is None else demand.volume_of_bubble
        tables, faults = dict[str, Any](), list[Problem]()
        for table, key in RATES:
            entries = tables.get(table, getattr(self, table))
            rate = getattr(entries, key, None)
            if isinstance(rate, NormalVolume):
                new_rate: float = NormalVolume.at(rate.normal, self.fluid.temperature)
            elif isinstance(rate, Bubbles) and volume is not None:
                new_rate = Bubbles.of(rate.count, volume)
            else:
                if isinstance(rate, Bubbles):
                    name = "no_bubble" if has_limit else "no_bubble_of_target"
                    faults.append(problem(name, key=f"{table}.{key}"))
                continue
            tables[table] = entries.model_copy(update={key: new_rate})
        return tables, faults

    @property
    def conducts_heat(self) -> bool:
        """Whether temperatures are calculated, from what is around the bodies."""
        return self.temperature is not None and bool(self.temperature.faces)

    @property
    def expands(self) -> bool:
        """Whether closure and seat grow by different strains."""
        heat = self.temperature
        if heat is None or heat.film is None:
            return False
        same_material = self.closure.material == self.lower.material
        return not (same_material and heat.of_body("closure") == heat.of_body("seat"))

    @property
    def wall_motion(self) -> float:
        """How far a held wall of the seat is moved inwards, by a press fit and by heat [m]; zero where it is free."""
        if self.lower.wall == "free":
            return 0.0
        heat, wall = self.temperature, self.contact.seat.largest_radius
        interference = self.lower.interference or 0.0
        warm = None if heat is None else heat.of_body("seat")
        if heat is None or warm is None:
            return interference
        housing = heat.housing or warm
        if heat.housing_expansion is None:
            housing_strain = self.lower.material.thermal_strain(housing, heat.reference)
        else:
            housing_strain = heat.housing_expansion * (housing - heat.reference)
        return interference + (self.thermal_strain("seat") - housing_strain) * wall

    @property
    def effective_modulus(self) -> float:
        """E* of both bodies [Pa]."""
        return effective_modulus(self.closure.material, self.lower.material)

    @property
    def hardness(self) -> float | None:
        """Penetration hardness of the contact [Pa]: the softer body's or the only one given; None if none."""
        values = [
            body.hardness
            for body in (self.closure.material, self.lower.material)
            if body.hardness is not None
        ]
        return min(values, default=None)

    @property
    def softer(self) -> Material:
        """The body of that hardness, or with the lower modulus if none is known."""
        return min(
            (self.closure.material, self.lower.material),
            key=lambda body: (body.hardness or math.inf, body.youngs_modulus),
        )

    @property
    def simulated_asperities(self) -> Asperities:
        """What yields in a direct simulation: as asked for, and unless asked what the theory takes."""
        asperities = None if self.direct is None else self.direct.asperities
        return asperities or ("capped" if self.leak.plasticity and self.hardness is not None else "elastic")

    @property
    def sampling(self) -> Uncertainty | None:
        """What is uncertain: [uncertainty], or for a finish without it a table that adds nothing; None if nothing is.

        None also without a fluid.
        """
        if self.uncertainty is not None or self.roughness is None or not self.roughness.leaves_open:
            return self.uncertainty
        return Uncertainty() if self.fluid is not None else None

    @property
    def file(self) -> Path | None:
        """File the case was read from, None if made in code."""
        return self._file

    @property
    def chambers(self) -> tuple[float | None, ...]:
        """Pressure in each chamber between the lands of the seat [Pa]; None where it follows from the flow."""
        pressures = self.load.chamber_pressure or (None,)
        count = len(self.contact.chambers)
        return pressures * count if len(pressures) == 1 else pressures

    @property
    def parts(self) -> tuple[CaseTables, ...]:
        """The case with each contact that is solved by itself and that leaks beside the others; here only itself."""
        return (self,)

    def without_loads(self, numbers: Collection[int]) -> Self:
        """The same without some of its loads; at least one must be left."""
        return self.model_copy(update={"load": self.load.without_loads(numbers)}) if numbers else self


def curves(case: CaseTables) -> list[HardeningCurve]:
    """Hardening curves of the bodies of a case that yield; empty if both are elastic."""
    materials = (case.closure.material, case.lower.material)
    return [material.hardening for material in materials if material.hardening is not None]
