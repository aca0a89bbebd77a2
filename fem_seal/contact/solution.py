"""Settings and solution of a contact, the fields of its bodies and where these yield."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, reduce
from typing import Self

import numpy as np

from fem_seal.arrays import FloatArray
from fem_seal.bodies.elasticity import larger_strain, without_free_strain
from fem_seal.bodies.fields import BodyField, ElastoplasticField, body_field
from fem_seal.contact.model import NO_LOADS, BodyLoads, ContactModel
from fem_seal.materials import Material
from fem_seal.processes import single_threaded
from fem_seal.profile import PressureProfile, join_lands, tightest_profile
from fem_seal.wording import Quantity


@dataclass(frozen=True)
class ContactSettings:
    """When the iterations stop.

    Parameters
    ----------
    gap_tolerance : float
        Largest residual of the gap in units of the law's decay length; this is also the relative error of p.
    force_tolerance : float
        Relative residual of the axial force.
    max_iterations : int
    fluid_tolerance : float
        Error of the fluid pressure between the surfaces in units of the pressure difference.

    Examples
    --------
    >>> import fem_seal
    >>> fem_seal.ContactSettings(gap_tolerance=1e-8).max_iterations
    60
    """

    gap_tolerance: float = 1e-10
    force_tolerance: float = 1e-12
    max_iterations: int = 60
    fluid_tolerance: float = 1e-9


DEFAULT_SETTINGS = ContactSettings()


@dataclass(frozen=True)
class ContactSolution:
    """State of the contact line under one axial force.

    Parameters
    ----------
    contact_force : float
        Force F_N that the solid contact carries [N].
    approach : float
        Axial motion of the closure's loaded surface towards the seat's bottom since first touch of the mean
        planes of bodies that are not warm [m].
    log_pressure : ndarray, shape (m,)
        ln(p/Pa) at the points of the contact line; -inf where hard contact is open.
    gap : ndarray, shape (m,)
        Separation [m].
    iterations : int
    residuals : tuple of float
        Largest gap residual over decay length, before each iteration and at the end.
    loads : BodyLoads
        What acts on the bodies besides the contact pressure.
    largest : ndarray, shape (m,), or None
        Largest pressure that each place has carried before [Pa]; None where nothing is known of it.
    earlier : ContactSolution or None
        The contact that carried it last; where nothing is left of its pressure, the largest before.
    stop_force : float
        What goes past the contact through the stop of the model [N].

    Examples
    --------
    >>> import fem_seal, meshes
    >>> ball = meshes.Ball(0.02)
    >>> cone = meshes.ConicalSeat.around(0.785, ball)
    >>> sizing = meshes.Sizing(2e-5, 1e-4, (-1e-3, 1e-3), 0.2, 0.3, 4e-3)
    >>> steel = fem_seal.Material("steel", 210e9, 0.3)
    >>> model = fem_seal.condense(meshes.build(ball, cone, sizing), {"closure": steel, "seat": steel})
    >>> contact = fem_seal.solve(model, fem_seal.HardContact(), contact_force=1257.0)
    >>> round(contact.profile.peak_pressure / 1e6)
    195
    >>> abs(contact.force_error) < 1e-9
    True
    """

    model: ContactModel
    contact_force: float
    approach: float
    log_pressure: FloatArray = field(repr=False)
    gap: FloatArray = field(repr=False)
    iterations: int
    residuals: tuple[float, ...] = field(repr=False)
    loads: BodyLoads = NO_LOADS
    largest: FloatArray | None = field(default=None, repr=False)
    earlier: ContactSolution | None = field(default=None, repr=False)
    stop_force: float = 0.0

    def __repr__(self) -> str:
        profile = self.profile
        return (
            f"<{type(self).__name__} at F_N = {Quantity(self.contact_force, 'force')}: peak "
            f"{Quantity(profile.peak_pressure, 'contact pressure')}, FWHM {Quantity(profile.fwhm, 'length')}, "
            f"{len(self.log_pressure)} points, {self.iterations} iterations>"
        )

    @property
    def pressure(self) -> FloatArray:
        """Contact pressure at the points of the contact line [Pa]."""
        return np.exp(self.log_pressure)

    @property
    def point_forces(self) -> FloatArray:
        """Normal forces at the points of the contact line [N]."""
        return self.model.line.area_weight * self.pressure

    @property
    def force_per_length(self) -> FloatArray:
        """Axial force that the contact carries per arc length [N/m], shape (m,): dF_N/dx = 2 pi r p n_z facing."""
        line = self.model.line
        return line.normal[1] * line.area_weight / line.arc_weight * self.pressure

    @property
    def line_forces(self) -> FloatArray:
        """Normal forces of solid contact and fluid at the points of the contact line [N]."""
        between = self.loads.gap_pressure
        return (
            self.point_forces
            if between is None
            else self.point_forces + self.model.line.area_weight * between
        )

    @cached_property
    def displacements(self) -> dict[str, tuple[FloatArray, FloatArray]]:
        """Displacement (dofs,) [m] of "closure" and "seat" by all that acts on them, and its stress (nodes, 4) [Pa]."""
        return _move_bodies([self])[0]

    @cached_property
    def fields(self) -> dict[str, BodyField]:
        """Displacement and stress of "closure" and "seat"."""
        return body_fields(self)

    def stays_below(self, name: str, stress: float) -> bool:
        """Whether it is certain, without the fields, that no von Mises stress of a body is above a value [Pa].

        Parameters
        ----------
        name : str
            "closure" or "seat".
        stress : float
            [Pa]
        """
        screen = self.model.screens.get(name)
        if screen is None:
            return False
        pressure, between = self.pressure, self.loads.gap_pressure
        total_pressure = pressure if between is None else pressure + between
        return screen.stays_below(stress, total_pressure, self.loads.on_body(name))

    @cached_property
    def turning(self) -> float:
        """How far the deformed faces have turned against each other [rad]: a/R of Hertz's contact.

        Twice the root mean square, weighted with the pressure, of the slope that the load has added to the gap. Unlike
        a half-width over a radius it knows what has turned the faces: a layer of asperities that spreads the pressure
        over a curved face turns nothing.
        """
        line = self.model.line
        slope = np.gradient(self.gap - line.initial_gap, line.x)
        weight = line.arc_weight * self.pressure
        return float(2 * np.sqrt(weight @ slope**2 / weight.sum()))

    @property
    def pressing_force(self) -> float:
        """Force that presses the bodies together [N]: that of the contact, and what goes through a stop."""
        return self.contact_force + self.stop_force

    @property
    def face_approach(self) -> float:
        """Approach since the mean planes of the faces touched, as warm as they are [m]."""
        return self.approach - self.model.touch

    @property
    def applied_force(self) -> float:
        """Force of spring or actuator on the top of the closure [N], in balance with contact and further loads."""
        return self.pressing_force + self.loads.lift(self.model)

    @property
    def force_error(self) -> float:
        """(axial contact force - F_N) / F_N."""
        return float(self.model.line.normal[1] @ self.point_forces) / self.contact_force - 1

    @property
    def line_load(self) -> float:
        """f_N [N/m]."""
        return self.model.line_load(self.contact_force)

    @cached_property
    def strain(self) -> FloatArray | None:
        """Strain of the metal under the faces, which flattens asperities or holds them, in the plane of the faces [-].

        Along the faces and around the axis, each part of it counted with the pressure under which it came, over the
        highest pressure that the place has carried: int p d(strain)/p_max. Then the sum of both elastic strains, in
        full; along a path of bodies that yield where pressure times it was largest. Of the body that is strained more,
        where one yields of those that do.

        Returns
        -------
        ndarray, shape (m, 3), or None
            At the points of the contact line; None if not known.
        """
        known = self.model.path_strain
        return _strains([self])[0] if known is None else known

    @property
    def mean_gap(self) -> FloatArray:
        """Distance of the mean planes at the points of the contact line, of asperities that have sunk as well [m]."""
        return self.gap

    @cached_property
    def profiles(self) -> tuple[PressureProfile, ...]:
        """Nominal pressure profile on each land of the contact line, from the axis outwards."""
        line, strain = self.model.line, self.strain

        def profile_on(land: slice, reach: tuple[float | None, float | None]) -> PressureProfile:
            points = line.x[land], line.radius[land], self.pressure[land], self.mean_gap[land]
            profile = PressureProfile(*points, line.arc_weight[land], reach)
            if strain is not None:
                profile = replace(profile, strain=strain[land])
            return profile if self.largest is None else profile.after(self.largest[land])

        return tuple(profile_on(land, reach) for land, reach in line.lands)

    @property
    def whole_profile(self) -> PressureProfile:
        """All of the contact as one profile."""
        return join_lands(self.profiles)

    @property
    def profile(self) -> PressureProfile:
        """Nominal pressure profile on the land that is pressed hardest."""
        return tightest_profile(self.profiles)

    def after(self, earlier: ContactSolution | None) -> Self:
        """The same contact after an earlier one on the same line, and after all that this one remembers.

        Parameters
        ----------
        earlier : ContactSolution or None
            None: nothing is known of an earlier one.
        """
        if earlier is None:
            return self
        pressure = earlier.pressure
        largest = pressure if earlier.largest is None else np.maximum(pressure, earlier.largest)
        return replace(self, largest=largest, earlier=earlier)

    @property
    def history(self) -> tuple[ContactSolution, ...]:
        """Contacts before this one that are known, the last first."""
        contacts, contact = [], self.earlier
        while contact is not None:
            contacts.append(contact)
            contact = contact.earlier
        return tuple(contacts)

    @property
    def without_stop(self) -> Self:
        """The same contact on bodies without a stop."""
        model = self.model.with_stop(math.inf)
        return self if model is self.model else replace(self, model=model)

    @property
    def first_loading(self) -> Self:
        """The same contact if no place had ever carried more."""
        return self if self.largest is None else replace(self, largest=None, earlier=None)


def largest_before(contacts: Sequence[ContactSolution]) -> tuple[ContactSolution, ...]:
    """The contact under the largest load that some contacts know of before all of them; none if they know of none.

    Parameters
    ----------
    contacts : sequence of ContactSolution
        Of one path, or of elastic bodies.
    """
    ids = {id(contact) for contact in contacts}
    others = [earlier for contact in contacts for earlier in contact.history if id(earlier) not in ids]
    return tuple(sorted(others, key=lambda contact: -contact.contact_force)[:1])


def move_together(solutions: Sequence[ContactSolution]) -> None:
    """Work out `ContactSolution.displacements` of several contacts at once, in a fraction of the time.

    Parameters
    ----------
    solutions : sequence of ContactSolution
        Each then knows what it would have found when asked; those on another model than the first are left alone.
    """
    solutions = [solution for solution in solutions if solution.model is solutions[0].model]
    if solutions:
        for solution, motion in zip(solutions, _move_bodies(solutions), strict=True):
            vars(solution)["displacements"] = motion


def strain_together(solutions: Sequence[ContactSolution]) -> None:
    """Work out `ContactSolution.strain` of several contacts at once, in a fraction of the time.

    Parameters
    ----------
    solutions : sequence of ContactSolution
        As of `move_together`.
    """
    solutions = [solution for solution in solutions if solution.model is solutions[0].model]
    for solution, strain in zip(solutions, _strains(solutions) if solutions else (), strict=True):
        vars(solution)["strain"] = strain


def _strains(solutions: Sequence[ContactSolution]) -> Sequence[FloatArray | None]:
    """`ContactSolution.strain` of contacts on the same model."""
    forces = np.stack([solution.line_forces for solution in solutions], axis=1)
    strains = []
    for name, body in solutions[0].model.bodies.items():
        loads = [solution.loads.on_body(name) for solution in solutions]
        sizes = {key: np.array([load.get(key, 0.0) for load in loads]) for load in loads for key in load}
        strains.append(body.elastic_strain(forces, sizes))
    known = [strain for strain in strains if strain is not None]
    if not known:
        return [None for _ in solutions]
    elastic = reduce(larger_strain, known)
    # of what rises with the pressure half counts
    return list(np.concatenate([0.5 * elastic, elastic.sum(axis=2, keepdims=True)], axis=2))


@single_threaded
def _move_bodies(solutions: Sequence[ContactSolution]) -> list[dict[str, tuple[FloatArray, FloatArray]]]:
    """`ContactSolution.displacements` of contacts on the same model."""
    model = solutions[0].model
    forces = np.stack([solution.line_forces for solution in solutions], axis=1)
    motions: list[dict[str, tuple[FloatArray, FloatArray]]] = [{} for _ in solutions]
    for name, body in model.bodies.items():
        displacement = body.displacement(forces)
        for number, solution in enumerate(solutions):
            displacement[:, number] += replace(solution.loads, gap_pressure=None).displacement(body, model)
        stress = np.moveaxis(body.recovery.stress(displacement), 2, 0)
        for number, motion in enumerate(motions):
            motion[name] = displacement[:, number].copy(), stress[number].copy()
    return motions


def body_fields(solution: ContactSolution) -> dict[str, BodyField]:
    """Fields of both bodies under a solved contact, "closure" and "seat".

    Examples
    --------
    >>> import fem_seal, meshes
    >>> ball = meshes.Ball(0.02)
    >>> cone = meshes.ConicalSeat.around(0.785, ball)
    >>> sizing = meshes.Sizing(2e-5, 1e-4, (-1e-3, 1e-3), 0.2, 0.3, 4e-3)
    >>> steel = fem_seal.Material("steel", 210e9, 0.3)
    >>> model = fem_seal.condense(meshes.build(ball, cone, sizing), {"closure": steel, "seat": steel})
    >>> contact = fem_seal.solve(model, fem_seal.HardContact(), contact_force=1257.0)
    >>> fields = fem_seal.body_fields(contact)
    >>> sorted(fields), bool(fields["seat"].von_mises.max() > 50e6)
    (['closure', 'seat'], True)
    """
    return _fields(solution.model, solution.loads, solution.displacements, solution.profile)


def fields_at_rest(model: ContactModel, loads: BodyLoads) -> dict[str, BodyField]:
    """Fields of both bodies, "closure" and "seat", that do not touch.

    Parameters
    ----------
    loads : BodyLoads
        What acts on them.
    """
    motions = {}
    for name, body in model.bodies.items():
        displacement = loads.displacement(body, model)
        motions[name] = displacement, body.recovery.stress(displacement)
    return _fields(model, loads, motions)


def _fields(
    model: ContactModel,
    loads: BodyLoads,
    motions: Mapping[str, tuple[FloatArray, FloatArray]],
    contact: PressureProfile | None = None,
) -> dict[str, BodyField]:
    """Fields of bodies with a displacement [m] and the stress of the strain by it [Pa]."""
    fields = {}
    for name, (displacement, stress) in motions.items():
        body = model.bodies[name]
        stress = without_free_strain(stress, body.material, loads.free_strain(body))
        fields[name] = body_field(body.fem, displacement, stress, contact, loads.temperature.get(name))
    return fields


# Plastic strain that counts as yielded, as a share of the elastic strain at yield.
_YIELD_SHARE = 0.01


@dataclass(frozen=True)
class _Zone:
    """Where a body is loaded above its yield stress.

    Parameters
    ----------
    body : str
        "closure" or "seat".
    yield_stress : float
        [Pa]
    largest : float
        The largest value in the zone.
    place : tuple of float
        (r, z) of the largest [m].
    depth : float
        Distance of that place from the contact line [m].
    deepest : float
        Largest distance of the zone from the contact line [m].
    """

    body: str
    yield_stress: float
    largest: float
    place: tuple[float, float]
    depth: float
    deepest: float


class YieldedZone(_Zone):
    """The part of an elastic body in which the von Mises stress is above the yield stress."""

    @property
    def von_mises(self) -> float:
        """The largest [Pa]."""
        return self.largest

    @property
    def excess(self) -> float:
        """Largest von Mises stress over yield stress."""
        return self.von_mises / self.yield_stress


class PlasticZone(_Zone):
    """Where a body that was solved as elastoplastic has yielded."""

    @property
    def strain(self) -> float:
        """The largest accumulated plastic strain [-]."""
        return self.largest


def yielded_zone(field: BodyField, yield_stress: float) -> YieldedZone | None:
    """Where a body's von Mises stress is above a yield stress; None if nowhere.

    Parameters
    ----------
    yield_stress : float
        [Pa]
    """
    zone = _largest(field, field.von_mises, yield_stress)
    return None if zone is None else YieldedZone(field.name, yield_stress, *zone)


def plastic_zone(field: ElastoplasticField, material: Material) -> PlasticZone | None:
    """Where a body has yielded; None if nowhere.

    Parameters
    ----------
    material : Material
        With its hardening curve.

    Notes
    -----
    Nodal values are averages over the triangles around, so that the edge of the zone is known to within a triangle. A
    hundredth of the elastic strain at yield counts as yielded.
    """
    assert material.yield_stress is not None  # that of the curve
    counts = _YIELD_SHARE * material.yield_stress / material.youngs_modulus
    zone = _largest(field, field.accumulated_plastic_strain, counts)
    return None if zone is None else PlasticZone(field.name, material.yield_stress, *zone)


def yielding_of(
    contact: ContactSolution, materials: Mapping[str, Material] | None = None
) -> dict[str, YieldedZone | PlasticZone]:
    """Where the bodies of a contact yield or, solved as elastic, would; by name, without those that do not.

    Parameters
    ----------
    materials : mapping, optional
        Of "closure" and "seat", where the model is shared by materials that differ in their strength.
    """
    zones: dict[str, YieldedZone | PlasticZone] = {}
    for name, body in contact.model.bodies.items():
        material = body.material if materials is None else materials[name]
        limit = material.yield_stress
        # without a look at the stress, which a model without displacements does not hold
        if limit is None or contact.stays_below(name, limit):
            continue
        field = contact.fields[name]
        zone: YieldedZone | PlasticZone | None = (
            plastic_zone(field, material)
            if isinstance(field, ElastoplasticField)
            else yielded_zone(field, limit)
        )
        if zone is not None:
            zones[name] = zone
    return zones


def _largest(
    field: BodyField, values: FloatArray, limit: float
) -> tuple[float, tuple[float, float], float, float] | None:
    """Largest nodal value above a limit, its place and depth, and the largest depth at which the limit is passed."""
    nodes = np.flatnonzero(values > limit)
    if len(nodes) == 0:
        return None
    depth = _distance(field.points[nodes], field.points[field.contact_nodes])
    place = int(np.argmax(values[nodes]))
    r, z = field.points[nodes[place]].tolist()
    return float(values[nodes[place]]), (r, z), float(depth[place]), float(depth.max())


def _distance(points: FloatArray, line: FloatArray) -> FloatArray:
    """Distance of points (n, 2) from the polyline through the points (k, 2) of `line`."""
    # as complex numbers, of which a product is a dot product, too
    places, vertices = points @ (1, 1j), line @ (1, 1j)
    offset, edge = places[:, None] - vertices[:-1], np.diff(vertices)
    share = np.clip((offset * edge.conj()).real / np.abs(edge) ** 2, 0.0, 1.0)
    return np.asarray(np.abs(offset - share * edge).min(axis=1))
