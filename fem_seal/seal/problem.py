"""The problem that a case poses: bodies, surfaces, flow and loads as the calculation knows them.

`SealProblem.of` is the door: behind it nobody asks the tables of the case. A variant of a problem is
``replace(problem, ...)``.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields, is_dataclass, replace
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from fem_seal.bodies.supports import Supports
from fem_seal.case.checks import face_remarks, refused_loads
from fem_seal.case.tables import curves
from fem_seal.case.tightening import bolts_of
from fem_seal.contact.laws import HardContact, Law
from fem_seal.contact.sizing import Opening, contact_widths, element_sizes, for_yielding, round_sizing
from fem_seal.errors import InputError, Problem
from fem_seal.files import problem as problem_of
from fem_seal.loads import (
    LARGEST_TURNING,
    Closing,
    PressureSide,
    expected_force,
    line_load,
    plastic_half_width,
)
from fem_seal.materials import HardeningCurve, Material, effective_modulus
from fem_seal.profile import PressureProfile, join_lands
from fem_seal.seal.heating import Heating, heating_of, with_contact_temperatures
from fem_seal.seal.leak_model import MARGIN, Conductivity, FlowModel, ProfileLeak
from fem_seal.seal.rough_faces import Joint, rough_contact
from fem_seal.wording import Quantity
from meshes import ContactGeometry, SealMesh, Sizing, build_contact

if TYPE_CHECKING:
    from fem_seal.arrays import FloatArray
    from fem_seal.bodies.constrained_body import LoadName
    from fem_seal.bolts import Bolts
    from fem_seal.case.tables import CaseTables, Direct, Interface
    from fem_seal.contact.model import BodyLoads, ContactModel
    from fem_seal.contact.solution import ContactSolution
    from fem_seal.form import FormError
    from fem_seal.seal.circumference import Circumference
    from fem_seal.seal.direct import DirectSettings
    from leak import LeakResult
    from leak.flow.turned_contact import FaceContact

# Ratio of decay length to rms height of Fischer et al. 2020, below eq. 8.
DEFAULT_GAMMA = 0.4


def interface_law(interface: Interface, surface: FaceContact | None) -> Law:
    """The law of a rough contact; of "smooth", and of "exponential" with its own numbers, without one.

    Parameters
    ----------
    interface : Interface
    surface : FaceContact or None
    """
    from leak import ExponentialLaw, TurnedContact

    if interface.law == "smooth":
        return HardContact()
    if interface.law == "spectrum":
        assert surface is not None  # the case's own checks demand a roughness
        # crests bear all load, so that their gap is that of what they bear
        crests_yield = isinstance(surface, TurnedContact) and surface.hardness is not None
        return surface.interface_law(interface.plastic or crests_yield)
    u0, p_c = exponential_law(interface, surface)
    assert u0 is not None and p_c is not None
    return ExponentialLaw(p_c=p_c, u0=u0)


def exponential_law(interface: Interface, surface: FaceContact | None) -> tuple[float | None, float | None]:
    """Decay length u0 [m] and pressure p_c [Pa] of p = p_c exp(-u/u0); None, None for a smooth interface.

    With law "exponential" as given, or gamma times rms height and p_c of the spectrum; with law "spectrum" the elastic
    spectrum's at low pressure, which the corrected theory has none of: None, None.

    Parameters
    ----------
    interface : Interface
    surface : FaceContact or None
    """
    from leak import RoughContact

    exponential = surface is None or surface.exponential_at_low_pressure
    if interface.law == "smooth" or (interface.law == "spectrum" and not exponential):
        return None, None
    if not isinstance(surface, RoughContact):
        return interface.u0, interface.p_c
    if interface.law == "spectrum":
        return surface.u0, surface.p_c
    gamma = DEFAULT_GAMMA if interface.gamma is None else interface.gamma
    return interface.u0 or gamma * surface.spectrum.rms_height, interface.p_c or surface.p_c


@dataclass(frozen=True)
class Loads:
    """Loads of a seal, and what is asked of them.

    Parameters
    ----------
    points : tuple
        Fluid pressure [Pa] and force of spring or actuator [N] of every load.
    pressure_side : {"outer", "inner"}
        Side of the high pressure.
    closing : {"sealed-area", "penetration"}
        What the fluid pressure acts on: the circle of first touch, or all that it wets.
    target_leak_rate : float or None
        To which the smallest force is asked [m^3/s].
    refusals : mapping
        Number of each load of which is known beforehand that it cannot be calculated, with the reason.
    earlier : tuple or None
        Fluid pressure [Pa] and force of spring or actuator [N] of the largest load before all of them; None if none is
        known.
    bolts : Bolts or None
        That close the seal; None where a force is applied.
    preloads : tuple of float
        Preload of bolts for each load [N], where each load has its own; the bodies go through it before the fluid acts.
    bolts_solved : bool
        Whether the forces of the bolts stand in the points; their preloads do before.
    along_path : bool
        Whether all bodies go through them in load steps, those that are elastic as well, because one of the seal
        yields.
    """

    points: tuple[tuple[float, float], ...]
    pressure_side: PressureSide = "outer"
    closing: Literal["sealed-area", "penetration"] = "sealed-area"
    target_leak_rate: float | None = None
    refusals: Mapping[int, Problem] = field(default_factory=dict)
    earlier: tuple[float, float] | None = None
    bolts: Bolts | None = None
    preloads: tuple[float, ...] = ()
    bolts_solved: bool = False
    along_path: bool = False

    @property
    def fluid_may_open(self) -> bool:
        """Whether a fluid pressure may open the seal: that in the bore, or one that acts on all that it wets."""
        return self.closing == "penetration" or self.pressure_side == "inner"

    @property
    def may_open(self) -> bool:
        """Whether fluid pressure or applied force may open the seal."""
        return self.fluid_may_open or any(force < 0.0 for _, force in self.points)

    @classmethod
    def of(cls, case: CaseTables) -> Loads:
        """Those of a case."""
        load, earlier, bolts = case.load, case.load.earlier, None if case.bolts is None else bolts_of(case)
        refused = {number: why for part in case.parts[::-1] for number, why in refused_loads(part).items()}
        preloads = () if bolts is None else tuple(force for _, force in load.points)
        if len(set(preloads)) == 1:
            earlier, preloads = (0.0, preloads[0]), ()
        return cls(
            load.points,
            load.pressure_side,
            load.closing,
            load.target_leak_rate,
            refused,
            earlier,
            bolts,
            preloads,
            along_path=any(map(curves, case.parts)),
        )

    @property
    def fluid_pressure(self) -> tuple[float, ...]:
        """Fluid pressure of every load [Pa]."""
        return tuple(pressure for pressure, _ in self.points)

    @property
    def on_new_surfaces(self) -> Loads:
        """The same without a load before them."""
        return self if self.earlier is None else replace(self, earlier=None)

    def without_loads(self, numbers: Collection[int]) -> Loads:
        """The others.

        Parameters
        ----------
        numbers : collection of int
            Of the loads that go.
        """
        remaining = [number for number in range(len(self.points)) if number not in numbers]
        refused = {new: self.refusals[old] for new, old in enumerate(remaining) if old in self.refusals}
        points = tuple(self.points[number] for number in remaining)
        preloads = tuple(self.preloads[number] for number in remaining) if self.preloads else ()
        return replace(self, points=points, refusals=refused, preloads=preloads)

    def path(self, points: Sequence[tuple[float, float]]) -> Iterator[tuple[int | None, tuple[float, float]]]:
        """Points with their numbers, after what comes before them: the largest load, or each preload of bolts.

        Parameters
        ----------
        points : sequence of tuple
            The first of these loads, or others in their place.
        """
        if self.earlier is not None:
            yield None, self.earlier
        same = tuple(points) == self.points[: len(points)] and len(self.preloads) >= len(points)
        preload = None
        for number, point in enumerate(points):
            if same and self.preloads[number] != preload:
                preload = self.preloads[number]
                yield None, (0.0, preload)
            yield number, point

    @property
    def preparation(self) -> str:
        """What comes before them, in words; empty for new faces."""
        if self.bolts is not None:
            return "tightening the bolts"
        return "" if self.earlier is None else "the largest earlier load"

    @property
    def with_loose_bolts(self) -> Loads:
        """The same with bolts that are yet to be tightened, for each load anew."""
        return replace(self, earlier=None, preloads=(), bolts_solved=False)

    def after_tightening(self, fluid_pressure: float, preload: float) -> Loads:
        """One load in their place, at a fluid pressure [Pa] and with bolts that have a preload [N]."""
        point = fluid_pressure, preload
        return replace(self, points=(point,), refusals={}, earlier=(0.0, preload), preloads=())

    def with_preloads(self, bolts: Bolts, preloads: Sequence[float]) -> Loads:
        """The same with bolts of other preloads.

        Parameters
        ----------
        bolts : Bolts
        preloads : sequence of float
            Of each load [N].
        """
        return replace(
            self,
            points=tuple(zip(self.fluid_pressure, preloads, strict=True)),
            earlier=None if self.earlier is None else (0.0, preloads[0]),
            bolts=bolts,
            preloads=tuple(preloads) if self.preloads else (),
            bolts_solved=False,
        )

    @property
    def unsolved_bolts(self) -> Bolts | None:
        """Bolts whose force under each load is still to be found; None without bolts, and once they are solved."""
        return None if self.bolts_solved else self.bolts

    def with_forces(self, points: Mapping[int, tuple[float, float]]) -> Loads:
        """The same with the forces that bolts have under some of them.

        Parameters
        ----------
        points : mapping
            Fluid pressure [Pa] and force [N] by the number of the load.
        """
        all_points = tuple(points.get(number, point) for number, point in enumerate(self.points))
        return replace(self, points=all_points, bolts_solved=True)


@dataclass(frozen=True)
class AtRest:
    """What acts on the bodies of a seal without any load: a press fit, and heat.

    Parameters
    ----------
    interference : float
        How far a held wall is moved inwards, by a press fit and by heat [m]; zero without.
    expansion : float
        Thermal strain of the closure beyond that of the seat [-].
    temperatures : mapping
        Of "closure" and "seat", or of their faces where it is calculated [K]; empty where they are not given.
    fluid_temperature : float or None
        At which the library's properties of the fluid are taken [K]; None where the fluid is the case's own.
    heating : Heating or None
        What warms the seal, where its temperature is calculated.
    """

    interference: float = 0.0
    expansion: float = 0.0
    temperatures: Mapping[str, float] = field(default_factory=dict)
    fluid_temperature: float | None = None
    heating: Heating | None = None

    @classmethod
    def of(cls, case: CaseTables) -> AtRest:
        """What acts on the bodies of a case, see `with_contact_temperatures`."""
        of_library = case.fluid is not None and case.fluid.library_entry is not None
        return cls(
            case.wall_motion,
            case.thermal_strain("closure") - case.thermal_strain("seat") if case.expands else 0.0,
            case.body_temperatures,
            case.fluid.temperature if case.fluid is not None and of_library else None,
            heating_of(case) if case.conducts_heat else None,
        )

    def body_loads(self, model: ContactModel) -> BodyLoads:
        """The loads of condensed bodies.

        All is counted from a seal that has grown as the seat does, at the contact: that changes its scale only, by
        less than what is neglected elsewhere.

        Parameters
        ----------
        model : ContactModel
            Condensed with these temperatures.
        """
        from fem_seal.contact.model import BodyLoads

        if self.heating is None:
            expansion: dict[LoadName, float] = {"expansion": self.expansion} if self.expansion else {}
            fit = BodyLoads.press_fit(self.interference)
            return BodyLoads(expansion, fit.seat, temperature=self.temperatures)
        seat = model.seat.fem
        wall = self.interference + self.heating.wall_motion(seat)
        nodes = {body.fem.name: body.fem.temperature for body in (model.closure, model.seat)}
        return BodyLoads(
            {"heat": 1.0},
            {"heat": 1.0, **BodyLoads.press_fit(wall if len(seat.wall) else 0.0).seat},
            temperature={name: warm for name, warm in nodes.items() if warm is not None},
        )


_FREE, _NO_REST = Supports(), AtRest()


@dataclass(frozen=True)
class SurfaceOrigin:
    """Where the surfaces of a seal come from, and what is said against their use.

    Parameters
    ----------
    remarks : tuple of str
        What the scans themselves say against it.
    face_remarks : tuple
        What is said of the faces that touch: name of the finding, body and text.
    of_finish : bool
        Whether the surface comes from the finish of a drawing.
    usual_only : bool
        Whether it does and its range is not sampled.
    cutoff : float or None
        Wave beyond which a finish says nothing of the surface [m]; None without a finish.
    """

    remarks: tuple[str, ...] = ()
    face_remarks: tuple[tuple[str, str, Problem], ...] = ()
    of_finish: bool = False
    usual_only: bool = False
    cutoff: float | None = None

    @classmethod
    def of(cls, case: CaseTables) -> SurfaceOrigin:
        """That of the surfaces of a case."""
        rough, remarks = case.roughness, tuple(face_remarks(case))
        if rough is None:
            return cls(face_remarks=remarks)
        of_finish = bool(rough.finishes)
        usual_only = of_finish and case.fluid is not None and case.sampling is None
        return cls(tuple(rough.remarks()), remarks, of_finish, usual_only, rough.cutoff)


@dataclass(frozen=True)
class Gasket:
    """A gasket between two flanges.

    Parameters
    ----------
    stop : float
        Way of one face until the flanges meet at a stop, all at the temperature of assembly [m]; infinite without one.
    """

    stop: float = math.inf


@dataclass(frozen=True, eq=False)
class SealProblem:
    """What is solved: a seal with its surfaces, its fluid and its loads.

    Parameters
    ----------
    contact : ContactGeometry
        Closure and seat in first touch.
    materials : dict
        Of "closure" and "seat".
    interface : Interface
    loads : Loads
    surface : FaceContact or None
        With the hardness if asperities yield; None without roughness.
    flow : FlowModel or None
        None without a fluid.
    form : FormError or None
        None for a seal that is round.
    supports : Supports
        How the seat is held.
    at_rest : AtRest
        What acts without any load.
    contact_size : float or None
        Size of the elements along the contact line, if the user gives it [m].
    origin : SurfaceOrigin
        Where the surface comes from, and what is said against it.
    file : Path or None
        That errors name.
    given_law : Law or None
        That of a family of surfaces in place of the interface's own.
    gasket : Gasket or None
        Of two sealing faces, through which fluid leaks side by side; None of a valve seat. The bodies are those of one
        face: a flange, as closure, and the upper half of the gasket, as seat.
    """

    contact: ContactGeometry
    materials: dict[str, Material]
    interface: Interface
    loads: Loads
    surface: FaceContact | None = None
    flow: FlowModel | None = None
    form: FormError | None = None
    supports: Supports = _FREE
    at_rest: AtRest = _NO_REST
    contact_size: float | None = None
    origin: SurfaceOrigin = SurfaceOrigin()
    file: Path | None = None
    given_law: Law | None = None
    gasket: Gasket | None = None

    @classmethod
    def of(cls, case: CaseTables) -> SealProblem:
        """The problem that a case poses, of several the first one, see `problems_of`.

        Parameters
        ----------
        case : CaseTables
            Whose tables fit together, as those of a `Case` do.
        """
        case = with_contact_temperatures(case) if case.conducts_heat else case
        return cls(
            contact=case.contact,
            materials={name: case.table_of(name).material for name in ("closure", "seat")},
            interface=case.interface,
            loads=Loads.of(case),
            surface=rough_contact(case),
            flow=flow_of(case),
            form=case.form_error,
            supports=Supports(case.lower.wall, case.lower.base, case.closure.base),
            at_rest=AtRest.of(case),
            contact_size=case.mesh.contact_size,
            origin=SurfaceOrigin.of(case),
            file=case.file,
            gasket=None if case.gasket is None else Gasket((case.gasket.stop or math.inf) / case.faces),
        )

    @cached_property
    def law(self) -> Law:
        """The law between contact pressure and gap, made when it is asked for."""
        return self.given_law or interface_law(self.interface, self.surface)

    @property
    def initial_contact_radius(self) -> float:
        """Radius r0 of the circle of first touch [m]."""
        return self.contact.initial_contact_radius

    @property
    def on_sealed_area(self) -> bool:
        """Whether the fluid acts on the circle of first touch, so that its force is known before the contact."""
        return self.loads.closing == "sealed-area" and not self.contact.chambers

    def expected_force(self, fluid_pressure: float, applied_force: float) -> float:
        """Force F_N that the solid contact is expected to carry under a load [N], see `fem_seal.loads`.

        Parameters
        ----------
        fluid_pressure, applied_force : float
            [Pa], [N].
        """
        closing: Closing = "sealed-area" if self.on_sealed_area else "penetration"
        circle, side = self.initial_contact_radius, self.loads.pressure_side
        return expected_force(circle, fluid_pressure, applied_force, side, closing)

    def applied_force(self, contact: ContactSolution, fluid_pressure: float) -> float:
        """Force of spring, actuator or bolts on a contact under a fluid pressure [Pa] [N]."""
        if self.on_sealed_area:
            return contact.pressing_force - self.expected_force(fluid_pressure, 0.0)
        return contact.applied_force

    @property
    def hardness(self) -> float | None:
        """Penetration hardness of the softer body, whether asperities yield or not [Pa]; None where none is known."""
        values = (material.hardness for material in self.materials.values() if material.hardness is not None)
        return min(values, default=None)

    @property
    def faces(self) -> int:
        """Sealing faces, through which fluid leaks side by side: 1 of a valve seat, 2 of a gasket."""
        return 1 if self.gasket is None else 2

    @property
    def joint(self) -> Joint | None:
        """How heat crosses its faces; None where that is not known."""
        flow = self.flow
        if flow is None:
            return Joint.of(self.surface, self.materials, None, None)
        return Joint.of(
            self.surface, self.materials, flow.fluid, self.at_rest.fluid_temperature, flow.outlet_pressure
        )

    @property
    def labelled_materials(self) -> dict[str, Material]:
        """The materials by what their bodies are called."""
        return {self.contact.label_of(name): material for name, material in self.materials.items()}

    @property
    def effective_modulus(self) -> float:
        """E* of both bodies [Pa]."""
        return effective_modulus(self.materials["closure"], self.materials["seat"])

    def stop_approach(self, model: ContactModel, way: float) -> float:
        """Approach at which flanges meet whose faces, at the temperature of assembly, meet after a way of one face [m].

        Warm flanges grow from where they are pressed towards each other, and more than the gasket by their expansion.

        Parameters
        ----------
        model : ContactModel
        way : float
            [m]
        """
        from fem_seal.bodies.elasticity import grown_by_one

        body = model.closure.fem
        height = float(body.balance @ grown_by_one(body.mesh)) - self.contact.seat.extent[1][0]
        return way + self.at_rest.expansion * (way - height) if math.isfinite(way) else way

    @property
    def curves(self) -> list[HardeningCurve]:
        """Hardening curves of the two bodies, where they yield; empty if both are elastic."""
        return [material.hardening for material in self.materials.values() if material.hardening is not None]

    @property
    def follows_path(self) -> bool:
        """Whether a body of the seal yields, so that its loads are a path."""
        return self.loads.along_path or bool(self.curves)

    def circumference(
        self, contact: ContactSolution, fluid_pressure: float, start: Circumference | None = None
    ) -> Circumference | None:
        """Line load around the axis where one of the problem's contacts carries the mean; None for a round seal.

        Parameters
        ----------
        contact : ContactSolution
        fluid_pressure : float
            Of its load [Pa]: what it takes of the contact's force is not of the bolts.
        start : Circumference, optional
            Of a contact between the same points and a form error of the same waves, both close to these.

        Raises
        ------
        ConvergenceError
        """
        if self.form is None:
            return None
        from fem_seal.contact.local_contact import LocalContact
        from fem_seal.seal.circumference import solve_both_around

        contact, form = contact.without_stop, self.form
        if form.bolts is not None:
            force = self.applied_force(contact, fluid_pressure)
            form = replace(form, bolts=replace(form.bolts, force=force))
        local = LocalContact(contact, self.law, None if start is None else start.local)
        if contact.earlier is None or contact.largest is None:
            return solve_both_around(form, local, None, start)
        local_before = None if start is None or start.before is None else start.before.local
        earlier = LocalContact(contact.earlier.without_stop, self.law, local_before)
        return solve_both_around(form, local, earlier, start)

    @property
    def leaks(self) -> bool:
        """Whether there is a leak rate: it takes roughness and fluid."""
        return self.surface is not None and self.flow is not None


def problems_of(case: CaseTables) -> tuple[SealProblem, ...]:
    """The problems that a case poses: one of each of its parts, under the same loads.

    Each of them is a whole seal that has the contact of this part alone; the leak rate of the case is their mean.

    Parameters
    ----------
    case : CaseTables
    """
    first, others = SealProblem.of(case), case.parts[1:]
    return (first, *under_loads(map(SealProblem.of, others), first.loads))


def under_loads(problems: Iterable[SealProblem], loads: Loads) -> tuple[SealProblem, ...]:
    """The problems of one seal under other loads.

    Parameters
    ----------
    problems : iterable of SealProblem
    loads : Loads
    """
    return tuple(replace(problem, loads=loads) for problem in problems)


def flow_of(case: CaseTables) -> FlowModel | None:
    """How the case's fluid flows; None without one.

    Parameters
    ----------
    case : CaseTables
    """
    fluid = case.fluid
    if fluid is None:
        return None
    return FlowModel(
        fluid.name,
        fluid.viscosity,
        fluid.density,
        fluid.gas,
        fluid.outlet_pressure or 0.0,
        case.leak.fluid_in_gap,
        case.load.pressure_side,
        direct_settings(case) if case.leak.conductivity == "direct" else None,
        pressure_law=fluid.pressure_law if fluid.gas is None else None,
        chambers=case.chambers,
        faces=case.faces,
        bore_radius=getattr(case.closure if case.gasket else case.seat, "bore_radius", None) or math.inf,
    )


def direct_settings(case: CaseTables) -> DirectSettings:
    """How the case's surface is simulated directly.

    Parameters
    ----------
    case : CaseTables
    """
    from fem_seal.case.tables import Direct
    from fem_seal.seal.direct import DirectSettings
    from leak import TurnedContact
    from leak.direct import texture_points

    table = case.direct or Direct()
    same = ("points", "samples", "seed", "waves", "points_per_wave", "amplitudes", "size", "direction")
    values = {name: getattr(table, name) for name in same}
    surface = rough_contact(case)
    if isinstance(surface, TurnedContact):
        usual = {
            "points": texture_points(surface.texture, 2 if surface.other is None else 1),
            "samples": _SAMPLES_OF_CRESTS,
        }
        values |= {name: value for name, value in usual.items() if name not in table.model_fields_set}
    return DirectSettings(
        **values,
        pressures=table.pressure or (),
        unload=table.unload or (),
        map=None if table.file is None else partial(_periodic_map, table.file, table.unit, table),
        folder=None if table.folder is None else Path(table.folder),
        asperities=case.simulated_asperities,
        yield_stress=table.yield_stress,
        poissons_ratio=case.softer.poissons_ratio,
    )


def _periodic_map(file: str, unit: tuple[str, ...] | None, settings: Direct) -> tuple[FloatArray, float]:
    """A measured map on no more points than the table says, and its side [m]."""
    from leak import HeightMap, read_topography
    from leak.direct import periodic_map

    scan = read_topography(file, unit=unit)
    if not isinstance(scan, HeightMap):
        raise InputError.at("direct.file", "is a line scan; a map of heights is needed", file)
    heights, size = periodic_map(scan, continuation=settings.continuation)
    if heights.shape[0] > settings.points:
        heights, size = periodic_map(scan, points=settings.points, continuation=settings.continuation)
    return heights, size


# Of a turned face; as many take over a minute.
_SAMPLES_OF_CRESTS = 2
_LARGER = 2.0
_LENGTHS = ("outer_radius", "height")


def larger_housing(case: CaseTables) -> ContactGeometry | None:
    """The contact in a seat twice as wide and high; None if the seat has no such lengths.

    Parameters
    ----------
    case : CaseTables

    Raises
    ------
    GeometryError
    """
    closure, shape = case.bodies
    seat: Any = shape
    names = {field.name for field in fields(seat)} if is_dataclass(seat) else set()
    if case.gasket is not None or not set(_LENGTHS) <= names:
        return None
    larger = replace(seat, **{name: _LARGER * getattr(seat, name) for name in _LENGTHS})
    return ContactGeometry.of(closure.outline, larger.outline)


def build_mesh(problem: SealProblem) -> SealMesh:
    """Mesh of a problem, sized for all its loads.

    Parameters
    ----------
    problem : SealProblem

    Raises
    ------
    GeometryError, MeshingError
    """
    return build_contact(problem.contact, size_mesh(problem))


def size_mesh(problem: SealProblem, forces: Sequence[float] | None = None) -> Sizing:
    """Element sizes and contact zone for all loads of a problem, and for the largest one before them.

    Parameters
    ----------
    problem : SealProblem
    forces : sequence of float, optional
        Forces F_N of the contact [N] instead of those of the loads.

    Raises
    ------
    InputError
        If [mesh] contact_size is out of range for this contact.
    """
    contact, size = problem.contact, problem.contact_size
    forces = [*(expected_forces(problem) if forces is None else forces)]
    if problem.loads.earlier is not None:
        forces.append(problem.expected_force(*problem.loads.earlier))
    forces += problem.loads.preloads
    line_loads = [line_load(force, contact.initial_contact_radius, contact.angle) for force in forces]
    try:
        sizing = element_sizes(problem.law, line_loads, contact, problem.effective_modulus, size)
    except InputError as error:
        raise error.in_file(problem.file) from None
    size_given = size is not None
    if problem.curves:
        softest = min(curve.yield_stress for curve in problem.curves)
        sizing = for_yielding(sizing, contact, softest, max(line_loads), size_given=size_given)
    return round_sizing(sizing, contact, size_given=size_given)


def condense_bodies(problem: SealProblem, mesh: SealMesh, known: ContactModel | None = None) -> ContactModel:
    """The bodies of a problem on a mesh, condensed.

    Parameters
    ----------
    problem : SealProblem
    mesh : SealMesh
    known : ContactModel, optional
        Whose closure may be the same, see `fem_seal.contact.model.condense`.
    """
    from fem_seal.contact.model import condense

    heating = problem.at_rest.heating
    heat = None if heating is None else heating.of_bodies(mesh, problem.materials)
    model = condense(mesh, problem.materials, problem.supports, heat, known=known)
    return with_stop(problem, model)


def with_stop(problem: SealProblem, model: ContactModel) -> ContactModel:
    """Bodies of a gasket that know where warm faces touch and flanges meet; of a valve seat as they are.

    Parameters
    ----------
    problem : SealProblem
    model : ContactModel

    Raises
    ------
    InputError
        If warm flanges meet before they touch the gasket.
    """
    if problem.gasket is None:
        return model
    touch = problem.at_rest.body_loads(model).touch(model)
    stop = problem.stop_approach(model, problem.gasket.stop)
    if stop <= touch:
        given = Quantity(problem.faces * problem.gasket.stop, ".6g um")
        says = problem_of("warm_flanges_meet", growth=problem.faces * (touch - stop + problem.gasket.stop))
        raise InputError.at("gasket.stop", says, given, file=problem.file)
    return model.with_stop(stop, touch)


def expected_forces(problem: SealProblem) -> list[float]:
    """Force F_N that the solid contact is expected to carry at each load that can be calculated [N].

    With closing "sealed-area" it is the force, with "penetration" an estimate.

    Parameters
    ----------
    problem : SealProblem
    """
    loads = problem.loads
    return [problem.expected_force(*point) for n, point in enumerate(loads.points) if n not in loads.refusals]


def largest_force(problem: SealProblem) -> float:
    """Largest force F_N that small strains describe [N], from Hertz's half-width over contact radius and curvature.

    Where a body yields that of full plasticity over a tenth of them as well.

    Parameters
    ----------
    problem : SealProblem
    """
    contact, modulus = problem.contact, problem.effective_modulus
    r0, R = contact.initial_contact_radius, contact.relative_radius
    if math.isinf(R):
        # Faces that fit each other: the pressure at which Hertz' contact would be as wide, all over the face.
        start, end = contact.reach
        f = (end - start) * modulus * LARGEST_TURNING / 2
    else:
        f = math.pi * modulus * (LARGEST_TURNING * min(r0, R)) ** 2 / (4 * R)
    if problem.curves:
        per_line_load = plastic_half_width(1.0, min(curve.stress[-1] for curve in problem.curves))
        f = min(f, min(r0, R) / 10 / per_line_load)
    return f / line_load(1.0, r0, contact.angle)


# Points of a Gaussian profile, and how far it reaches in standard deviations.
_POINTS, _REACH = 121, 5.0


@dataclass(frozen=True)
class SealFlow:
    """Leak rates of any contacts of a seal, by tables over the range in which its loads are expected.

    Parameters
    ----------
    problem : SealProblem
        Of which the expected contacts are.
    surface : FaceContact
    flow : FlowModel
    """

    problem: SealProblem
    surface: FaceContact
    flow: FlowModel

    @classmethod
    def of(cls, problem: SealProblem, scenario: SealProblem | None = None) -> SealFlow | None:
        """The flow of a problem; None without roughness or fluid.

        Parameters
        ----------
        problem : SealProblem
        scenario : SealProblem, optional
            Of the same contacts, of whose surface and fluid it is; the problem itself unless given.
        """
        scenario_problem = scenario or problem
        if scenario_problem.surface is None or scenario_problem.flow is None:
            return None
        return cls(problem, scenario_problem.surface, scenario_problem.flow)

    def expected_rate(self, contact_force: float, fluid_pressure: float) -> float:
        """Leak rate of `expected_profile` under a force F_N [N] at a pressure difference [Pa] [m^3/s]."""
        return self.leak(self.expected_profile(contact_force), fluid_pressure).leak_rate

    def leak(self, profile: PressureProfile, fluid_pressure: float) -> LeakResult:
        """Flow through a contact at a pressure difference [Pa]."""
        return self.flow.leak_of(self._table(profile), self.surface, profile, fluid_pressure)

    def equivalent(self, profile: PressureProfile, largest: FloatArray) -> PressureProfile:
        """Profile of first loading that lets as much through as a contact that was pressed harder before.

        Parameters
        ----------
        profile : PressureProfile
        largest : ndarray, shape (m,)
            Largest pressure that each place has carried before [Pa].
        """
        ends = np.cumsum([len(land.x) for land in profile.lands])
        loaded_lands = [
            land.after(largest[end - len(land.x) : end])
            for land, end in zip(profile.lands, ends, strict=True)
        ]
        return join_lands([land.equivalent(self._table(land), self.surface) for land in loaded_lands])

    def leak_of(self, contact: ContactSolution, fluid_pressure: float) -> LeakResult:
        """Flow through a contact with the form error of the seal, at a pressure difference [Pa]."""
        from fem_seal.seal.circumference import LeakCurve

        circumference = self.problem.circumference(contact, fluid_pressure)
        if circumference is None:
            return self.leak(contact.whole_profile, fluid_pressure)
        flow = ProfileLeak(
            lambda profile: self.leak(profile, fluid_pressure),
            lambda profile, grooves: self.flow.bounds(
                self._table(profile), self.surface, profile, fluid_pressure, grooves
            ),
            lambda pressure: self.flow.conductivity_at(
                self._table(circumference.most_loaded.profile), pressure, fluid_pressure
            ),
        )
        leak = circumference.with_leak(LeakCurve(circumference.local, flow)).leak
        assert leak is not None  # it was asked for
        return leak

    def _table(self, profile: PressureProfile) -> Conductivity:
        low, high = self._expected_peaks
        # below the range the low-pressure law goes on, above it two more decades at a time
        top, peak = math.ceil(high + MARGIN), math.log10(profile.at_rest(self.surface).highest) + MARGIN
        decades = 2 * max(0, math.ceil((peak - top) / 2))
        return self.flow.table_around(self.surface, (low, high + decades))

    def expected_profile(self, contact_force: float) -> PressureProfile:
        """Gaussian with the line load and the expected width of a contact that carries a force F_N [N].

        A body that yields is coined over the width of full plasticity at least.
        """
        contact = self.problem.contact
        ((std, peak),) = self._expected([contact_force])
        x = std * np.linspace(-_REACH, _REACH, _POINTS)
        pressure = peak * np.exp(-0.5 * (x / std) ** 2)
        r0 = contact.initial_contact_radius
        radius = np.maximum(r0 + x * math.cos(contact.angle), 0.1 * r0)
        return PressureProfile(x, radius, pressure, np.full_like(x, np.nan), np.gradient(x))

    def _expected(self, contact_forces: Sequence[float]) -> list[tuple[float, float]]:
        """Standard deviation [m] and peak [Pa] of the pressure of contacts that carry forces F_N [N]."""
        problem, contact = self.problem, self.problem.contact
        line_loads = [
            line_load(force, contact.initial_contact_radius, contact.angle) for force in contact_forces
        ]
        widths = contact_widths(problem.law, line_loads, Opening.of(contact), problem.effective_modulus)
        stds = [width.std for width in widths]
        if problem.curves:
            softest = min(curve.yield_stress for curve in problem.curves)
            # an even pressure over 2 a has the standard deviation a/sqrt(3)
            stds = [
                max(std, plastic_half_width(f, softest) / math.sqrt(3))
                for std, f in zip(stds, line_loads, strict=True)
            ]
        return [(std, f / (math.sqrt(2 * math.pi) * std)) for std, f in zip(stds, line_loads, strict=True)]

    @cached_property
    def _expected_peaks(self) -> tuple[float, float]:
        """Decimal logarithms of the smallest and the largest peak pressure that is expected [Pa]."""
        peaks = [math.log10(peak) for _, peak in self._expected(expected_forces(self.problem))]
        return min(peaks), max(peaks)
