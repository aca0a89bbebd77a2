"""Both bodies condensed on the contact line: factorised once, then each load is a small dense problem.

The pressure acts at quadrature points of the contact line along the contact normal n; the same point forces,
with opposite sign, act on both bodies. A body answers with the normal displacement of its quadratic trace, so
the compliance between quadrature points is T S T^T with T the trace and S the compliance of the trace's
nodes. Where the normal turns it is that of the trace's nodes, interpolated by T like the displacement. The closure
floats: its axial rigid motion is an unknown of the contact problem, and its closing force is a pressure on its top
that balances whatever acts elsewhere. Fluid on the wetted surfaces, a housing pressed into a bore and thermal
expansion are further columns of the same factorisation.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from fem_seal.arrays import FloatArray
from fem_seal.bodies.constrained_body import (
    BoundaryLoad,
    CondensedBody,
    ConstrainedBody,
    Heat,
    LoadName,
    condense_body,
    constrained_body,
    free_dofs,
)
from fem_seal.bodies.dissected_body import DissectedBody
from fem_seal.bodies.elasticity import at_quadrature_points, grown_by_one, stiffness_matrix, thermal_load
from fem_seal.bodies.harmonics import HarmonicBody
from fem_seal.bodies.stress_bound import StressBound
from fem_seal.bodies.supports import Supports
from fem_seal.materials import Material, effective_modulus
from fem_seal.processes import single_threaded
from fem_seal.wording import Quantity
from leak.numerics.integrals import gauss
from meshes import ContactGeometry, SealMesh

if TYPE_CHECKING:
    from skfem import MeshTri


@dataclass(frozen=True)
class ContactLine:
    """Quadrature points of the contact line.

    Parameters
    ----------
    x : ndarray, shape (m,)
        Arc length from first touch [m], increasing.
    radius : ndarray, shape (m,)
        r(x) [m].
    arc_weight : ndarray, shape (m,)
        Quadrature weights over x [m].
    normal : ndarray, shape (2, m)
        Unit contact normal (n_r, n_z), towards the closure, see `meshes.ContactGeometry`.
    area_weight : ndarray, shape (m,)
        Area across the contact normal that each point stands for [m^2], see `line_points`.
    initial_gap : ndarray, shape (m,)
        Exact gap g0(x) at first touch [m].
    bend : ndarray, shape (m,)
        Curvature of the more curved face [1/m].
    vertices : ndarray
        x of the element ends between which the points lie [m], increasing.
    reach : tuple of float or None, optional
        x between which the faces stand in front of each other [m]; None where they are not known to end.
    in_hollow : ContactGeometry or None
        The faces, where the closure lies in a hollow seat.
    chambers : tuple of float
        x of the chambers that part the line into lands [m], increasing.
    """

    x: FloatArray
    radius: FloatArray
    arc_weight: FloatArray
    normal: FloatArray
    area_weight: FloatArray
    initial_gap: FloatArray
    bend: FloatArray
    vertices: FloatArray
    reach: tuple[float | None, float | None] = (None, None)
    in_hollow: ContactGeometry | None = field(default=None, repr=False)
    chambers: tuple[float, ...] = ()

    @property
    def lands(self) -> tuple[tuple[slice, tuple[float | None, float | None]], ...]:
        """Points of each land, from the axis outwards, and x between which its faces stand in front of each other."""
        cuts = [0, *np.searchsorted(self.x, self.chambers).tolist(), len(self.x)]
        ends = [self.reach[0], *self.chambers, self.reach[1]]
        return tuple(
            (slice(*part), reach) for part, reach in zip(pairwise(cuts), pairwise(ends), strict=True)
        )

    def lift(self, separation: float) -> FloatArray | float:
        """What lifting the closure adds to the gap beyond the axial part of its way [m], shape (m,); 0 on most seats.

        In a hollow seat the closure that a layer keeps off comes closest elsewhere, and the gap there is not what its
        slope at first touch says.

        Parameters
        ----------
        separation : float
            Thickness of the layer [m].
        """
        if self.in_hollow is None:
            return 0.0
        n_z = math.cos(self.in_hollow.angle)
        # Far more than any layer for which an interface law has a meaning.
        way = min(max(separation, 0.0) / n_z, 0.1 / self.in_hollow.closure_curvature)
        return self.in_hollow.gap(self.x, way) - self.in_hollow.gap(self.x) - way * self.normal[1]

    @cached_property
    def hats(self) -> FloatArray:
        """Functions that are one at an element end, zero at the others and linear between, shape (m, ends)."""
        return np.stack([np.interp(self.x, self.vertices, row) for row in np.eye(len(self.vertices))], axis=1)


@dataclass(frozen=True)
class ContactModel:
    """Compliance of both bodies on their contact line; independent of load, roughness and interface law.

    Parameters
    ----------
    line : ContactLine
    compliance : ndarray, shape (m, m)
        Opening of the gap at point i per unit normal force at point j [m/N], both bodies together.
    initial_contact_radius : float
        r0 [m].
    touch_normal_z : float
        cos(theta) of the contact normal at first touch.
    relative_radius : float
        R_rel [m].
    harmonics : tuple of HarmonicBody
        Closure and seat under loads that wave around the axis.
    screens : mapping of StressBound
        Of "closure" and "seat", where many loads ask whether they pass a stress.
    stop : float
        Approach at which the loaded surfaces meet beside the contact [m], so that it carries no more; infinite where
        they do not.
    touch : float
        Approach at which the mean planes of the faces touch, other than zero where heat has moved them [m].

    Examples
    --------
    >>> import fem_seal, meshes
    >>> ball = meshes.Ball(0.02)
    >>> cone = meshes.ConicalSeat.around(0.785, ball)
    >>> sizing = meshes.Sizing(2e-5, 1e-4, (-1e-3, 1e-3), 0.2, 0.3, 4e-3)
    >>> steel = fem_seal.Material("steel", 210e9, 0.3)
    >>> model = fem_seal.condense(meshes.build(ball, cone, sizing), {"closure": steel, "seat": steel})
    >>> model.closure.material.name, round(model.effective_modulus / 1e9, 1)
    ('steel', 115.4)
    >>> round(model.line_load(1257.0))
    20006
    """

    line: ContactLine
    closure: CondensedBody
    seat: CondensedBody
    compliance: FloatArray
    initial_contact_radius: float
    touch_normal_z: float
    relative_radius: float
    harmonics: tuple[HarmonicBody, HarmonicBody] = field(repr=False)
    screens: Mapping[str, StressBound] = field(default_factory=dict, repr=False)
    stop: float = math.inf
    touch: float = 0.0

    def __repr__(self) -> str:
        return (
            f"<{type(self).__name__}: {self.closure.material.name} on {self.seat.material.name}, "
            f"first touch at r = {Quantity(self.initial_contact_radius, 'length')}, "
            f"{len(self.line.x)} points on the contact line>"
        )

    @property
    def knows_stress(self) -> bool:
        """Whether the stress inside of the bodies can be calculated: not of those that many designs share."""
        return self.closure.solve is not None

    @property
    def bodies(self) -> dict[str, CondensedBody]:
        """By name."""
        return {"closure": self.closure, "seat": self.seat}

    @property
    def yields(self) -> bool:
        """Whether the material of a body has a hardening curve."""
        return any(body.material.hardening is not None for body in self.bodies.values())

    @property
    def with_face_strain(self) -> ContactModel:
        """The same, whose bodies know the strain of their faces without what is inside."""
        return replace(self, closure=self.closure.with_face_strain, seat=self.seat.with_face_strain)

    @property
    def path_strain(self) -> FloatArray | None:
        """Strain of faces along the path of bodies that yield, see `ContactSolution.strain`; None of elastic ones."""
        return None

    @property
    def line_alone(self) -> ContactModel:
        """The same without the factors of its bodies, which take most of the memory."""
        return replace(self, closure=self.closure.line_alone, seat=self.seat.line_alone)

    @property
    def effective_modulus(self) -> float:
        """E* of the pair [Pa]."""
        return effective_modulus(self.closure.material, self.seat.material)

    def with_stop(self, approach: float, touch: float | None = None) -> ContactModel:
        """The same with a stop at an approach, and first touch at another one if it is given [m]."""
        touch = self.touch if touch is None else touch
        return (
            self
            if (approach, touch) == (self.stop, self.touch)
            else replace(self, stop=approach, touch=touch)
        )

    def stiffer(self, factor: float) -> ContactModel:
        """Model of the same bodies with both Young's moduli times a factor, as far as a contact needs it."""
        if factor == 1.0:
            return self
        return replace(
            self,
            closure=self.closure.stiffer(factor),
            seat=self.seat.stiffer(factor),
            compliance=self.compliance / factor,
            harmonics=(self.harmonics[0].stiffer(factor), self.harmonics[1].stiffer(factor)),
        )

    def line_load(self, contact_force: float) -> float:
        """f_N = F_N / (2 pi r0 cos theta) [N/m] (Fischer et al., above eq. 1)."""
        return contact_force / (2 * np.pi * self.initial_contact_radius * self.touch_normal_z)


def with_stress_bound(model: ContactModel, names: Iterable[str]) -> ContactModel:
    """The same model with a quick look at the stress of some bodies, for many loads.

    Parameters
    ----------
    names : iterable of str
        "closure" or "seat".
    """
    area = model.line.area_weight
    return replace(model, screens={name: StressBound.of(model.bodies[name], area) for name in names})


@single_threaded
def condense(
    seal_mesh: SealMesh,
    materials: Mapping[str, Material],
    supports: Supports | None = None,
    heat: Mapping[str, Heat] | None = None,
    *,
    known: ContactModel | None = None,
) -> ContactModel:
    """Factorise both bodies and condense them on the contact line.

    Parameters
    ----------
    materials : mapping
        Material of the body "closure" and of the body "seat".
    supports : Supports, optional
    heat : mapping, optional
        Of the bodies whose temperature differs from place to place, by the same names.
    known : ContactModel, optional
        Of the same seal with another seat or support: a body that is the same, mesh and all, is not factorised anew.

    Returns
    -------
    ContactModel
        Compliance [m/N] at the points of the contact line, shape (m, m).

    Raises
    ------
    ValueError
        If the materials are not those of these two bodies.

    Examples
    --------
    >>> import fem_seal, meshes
    >>> ball = meshes.Ball(0.02)
    >>> cone = meshes.ConicalSeat.around(0.785, ball)
    >>> sizing = meshes.Sizing(2e-5, 1e-4, (-1e-3, 1e-3), 0.2, 0.3, 4e-3)
    >>> steel = fem_seal.Material("steel", 210e9, 0.3)
    >>> model = fem_seal.condense(meshes.build(ball, cone, sizing), {"closure": steel, "seat": steel})
    >>> model.compliance.shape == (len(model.line.x), len(model.line.x))
    True
    """
    if set(materials) != {"closure", "seat"}:
        raise ValueError(f'materials of {sorted(materials)}: needed are those of "closure" and "seat"')
    contact = seal_mesh.contact
    x, weight, vertices = _gauss_points(seal_mesh)
    area_weight = _area_weight(contact, x, weight)
    warm = heat or {}

    def body(name: str) -> CondensedBody:
        # what the seat changes warms the closure otherwise, too
        if known is not None and not warm and _same_line(known, seal_mesh, x, area_weight):
            body_before: CondensedBody = getattr(known, name)
            if _is_same_body(body_before, getattr(seal_mesh, name), materials[name], supports):
                return body_before
        return _condense_body(
            constrained_body(seal_mesh, name, materials[name], x, area_weight, supports, warm.get(name))
        )

    closure, seat = body("closure"), body("seat")
    # The normal that the bodies feel, so that the forces on them balance to the last digit.
    normal = np.stack([seat.fem.trace @ component for component in contact.normal(seat.fem.contact_x)])
    gap, bend = contact.gap(x), contact.bend(x)
    hollow = contact if contact.normal_turns and contact.closure_curvature > 0 else None
    line = ContactLine(
        x,
        contact.radius(x),
        weight,
        normal,
        area_weight,
        gap,
        bend,
        vertices,
        contact.reach,
        hollow,
        tuple(place for place in contact.chambers if x[0] < place < x[-1]),
    )
    return ContactModel(
        line,
        closure,
        seat,
        line_compliance(closure, seat),
        contact.initial_contact_radius,
        math.cos(contact.angle),
        contact.relative_radius,
        (
            known.harmonics[0]
            if known is not None and closure is known.closure
            else HarmonicBody(closure.fem),
            HarmonicBody(seat.fem),
        ),
    )


def _same_line(model: ContactModel, seal_mesh: SealMesh, x: FloatArray, area_weight: FloatArray) -> bool:
    """Whether the contact line of a model is that of a mesh, to the last digit."""
    return (
        seal_mesh.contact.initial_contact_radius == model.initial_contact_radius
        and np.array_equal(x, model.line.x)
        and np.array_equal(area_weight, model.line.area_weight)
    )


def _is_same_body(body: CondensedBody, mesh: MeshTri, material: Material, supports: Supports | None) -> bool:
    """Whether a body of a model that was condensed before is that of a mesh, to the last digit."""
    mesh_before = body.fem.mesh
    is_same_mesh = np.array_equal(mesh.p, mesh_before.p) and np.array_equal(mesh.t, mesh_before.t)
    if not is_same_mesh or material != body.material:
        return False
    return np.array_equal(free_dofs(mesh, body.fem.name, supports), body.fem.free)


def line_points(seal_mesh: SealMesh) -> tuple[FloatArray, FloatArray]:
    """Points of the contact line, arc length from first touch [m], and the area that each stands for [m^2]."""
    x, weight, _ = _gauss_points(seal_mesh)
    return x, _area_weight(seal_mesh.contact, x, weight)


def _area_weight(contact: ContactGeometry, x: FloatArray, arc_weight: FloatArray) -> FloatArray:
    """2 pi r facing dx [m^2]; facing is the cosine of the angle between contact normal and seat."""
    return 2 * np.pi * contact.radius(x) * contact.facing(x) * arc_weight


def line_compliance(closure: CondensedBody, seat: CondensedBody) -> FloatArray:
    """Opening of the gap at the points of the line per unit normal force at each, both bodies together [m/N]."""
    compliance = sum(body.fem.trace @ (body.fem.trace @ body.compliance.T).T for body in (closure, seat))
    return 0.5 * (compliance + compliance.T)


def _gauss_points(seal_mesh: SealMesh) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Three Gauss points on each contact facet of the seat, their weights over x, and the ends of the facets."""
    seat = seal_mesh.seat
    on_contact = np.unique(seat.facets[:, (seat.boundaries or {})["seat_contact"]])
    vertices = np.unique(seal_mesh.contact.coordinate(*seat.p[:, on_contact]))
    middle, half = 0.5 * (vertices[1:] + vertices[:-1]), 0.5 * np.diff(vertices)
    points, weights = gauss(3)
    return (middle[:, None] + half[:, None] * points).ravel(), (half[:, None] * weights).ravel(), vertices


def _condense_body(fem: ConstrainedBody) -> CondensedBody:
    forces = {}
    if len(fem.wall):
        outwards = np.zeros(fem.size)
        outwards[fem.wall] = 1.0
        forces["wall"] = np.asarray(stiffness_matrix(fem.mesh, fem.material) @ outwards)
    body = condense_body(fem, DissectedBody(fem).elastic(), forces)
    return replace(body, find_loads=lambda: {**body.loads, **dict(_heat_answers(body))})


def _heat_answers(body: CondensedBody) -> Iterator[tuple[LoadName, BoundaryLoad]]:
    """Answer of an elastic body to a unit of each way to be heated, by name."""
    fem = body.fem
    for name, strain in fem.free_strain.items():
        if name == "expansion":
            # Nothing keeps a closure from growing as a whole: its displacement is known, and it takes no stress.
            response = fem.remove_rigid_motion(grown_by_one(fem.mesh))
        else:
            assert body.solve is not None  # just condensed
            force = thermal_load(fem.mesh, fem.material, at_quadrature_points(fem.mesh, strain))
            response = fem.remove_rigid_motion(body.solve(force))
        yield (name, BoundaryLoad(0.0, fem.trace @ fem.normal_displacement(response), response, strain))


# What the wetted surfaces of a seal with one contact line may be called as well.
_SURFACE_NUMBERS = {"inner": 0, "outer": 1}


@dataclass(frozen=True)
class BodyLoads:
    """Loads away from the solid contact, and the fluid pressure between the surfaces.

    Parameters
    ----------
    closure, seat : mapping
        Magnitude of each of the body's `CondensedBody.loads`: fluid pressure [Pa] on each wetted
        surface, by its number from the axis outwards, "inner" and "outer" being 0 and 1; of a seat with fixed
        wall also "wall", its motion inwards [m]; of a closure also "expansion", its thermal strain beyond that of the
        seat [-]; of bodies whose temperature differs from place to place "heat", a share of it.
    gap_pressure : ndarray, shape (m,), optional
        Fluid pressure at the points of the contact line [Pa].
    lifting : float
        Axial force of a fluid on the closure that deforms no body, positive where it lifts [N].
    temperature : mapping, optional
        Of "closure" and "seat", all over or at their nodes [K]; it acts through the loads of the bodies, and stands
        here for all who show it. Empty where it is not given.

    Examples
    --------
    >>> import fem_seal
    >>> fem_seal.BodyLoads.press_fit(20e-6)
    BodyLoads(closure={}, seat={'wall': 2e-05})
    """

    closure: Mapping[LoadName, float] = field(default_factory=dict)
    seat: Mapping[LoadName, float] = field(default_factory=dict)
    gap_pressure: FloatArray | None = field(default=None, repr=False)
    lifting: float = field(default=0.0, repr=False, kw_only=True)
    temperature: Mapping[str, FloatArray | float] = field(default_factory=dict, repr=False)

    def __post_init__(self) -> None:
        for body in ("closure", "seat"):
            magnitudes: Mapping[LoadName, float] = getattr(self, body)
            if not magnitudes.keys().isdisjoint(_SURFACE_NUMBERS):
                by_number = {_SURFACE_NUMBERS.get(str(name), name): size for name, size in magnitudes.items()}
                object.__setattr__(self, body, by_number)

    @classmethod
    def of_fluid(
        cls, wetted: tuple[float, float], gap_pressure: FloatArray, at_rest: BodyLoads | None = None
    ) -> BodyLoads:
        """Fluid on both bodies, and what acts on them without any.

        Parameters
        ----------
        wetted : tuple of float
            Fluid pressure on the wetted surface inside and on the one outside of the contact line [Pa].
        gap_pressure : ndarray, shape (m,)
            Fluid pressure between the surfaces [Pa].
        at_rest : BodyLoads, optional
            Such as a press fit; without a pressure in the gap.
        """
        others = at_rest or cls()
        fluid: dict[LoadName, float] = dict(enumerate(wetted))
        return cls({**fluid, **others.closure}, {**fluid, **others.seat}, gap_pressure, others.temperature)

    @classmethod
    def press_fit(cls, interference: float) -> BodyLoads:
        """A seat pressed into a rigid bore.

        Parameters
        ----------
        interference : float
            Radius of the housing less that of the bore [m].
        """
        return cls(seat={"wall": interference} if interference else {})

    def on_body(self, body: str) -> Mapping[LoadName, float]:
        """Loads of the body "closure" or "seat"."""
        return self.closure if body == "closure" else self.seat

    def opening(self, model: ContactModel) -> FloatArray:
        """How far these loads move the surfaces apart at the points of the contact line [m], shape (m,)."""
        opening = np.zeros_like(model.line.x)
        for name, body in model.bodies.items():
            for load, magnitude in self.on_body(name).items():
                opening = opening + magnitude * body.loads[load].opening
        if self.gap_pressure is not None:
            opening = opening + model.compliance @ (model.line.area_weight * self.gap_pressure)
        return opening

    def touch(self, model: ContactModel) -> float:
        """Approach at which the mean planes touch under these loads, zero without any [m]."""
        gap, axial = model.line.initial_gap, model.line.normal[1]
        return float(np.min((gap + self.opening(model)) / axial) - np.min(gap / axial))

    def lift(self, model: ContactModel) -> float:
        """Axial force that the loads exert on the closure [N], positive where they lift it."""
        lift = self.lifting
        lift += sum(size * model.closure.loads[name].axial_force for name, size in self.closure.items())
        if self.gap_pressure is not None:
            lift += float(model.line.normal[1] @ (model.line.area_weight * self.gap_pressure))
        return lift

    def displacement(
        self, body: CondensedBody, model: ContactModel, point_forces: FloatArray | None = None
    ) -> FloatArray:
        """Displacement of a body of the model under these loads [m], shape (dofs,).

        Parameters
        ----------
        point_forces : ndarray, shape (m,), optional
            Normal forces of a solid contact at the points of the contact line, which act as well [N].
        """
        displacement = sum(
            (size * body.loads[name].response for name, size in self.on_body(body.fem.name).items()),
            np.zeros(body.fem.size),
        )
        forces = [] if point_forces is None else [point_forces]
        if self.gap_pressure is not None:
            forces.append(model.line.area_weight * self.gap_pressure)
        return displacement + body.displacement(np.sum(forces, axis=0)) if forces else displacement

    def free_strain(self, body: CondensedBody) -> FloatArray | float:
        """Strain of a body under these loads that takes no stress: a number, or one for each node."""
        return sum(
            (size * body.loads[name].free_strain for name, size in self.on_body(body.fem.name).items()), 0.0
        )

    def face_temperature(
        self, body: CondensedBody, pressure: FloatArray, model: ContactModel
    ) -> float | None:
        """Temperature of a body's face where it carries a pressure (m,), in the mean over it [K]; None if not given."""
        temperature = self.temperature.get(body.fem.name)
        if temperature is None or np.ndim(temperature) == 0:
            return None if temperature is None else float(temperature)
        weight = model.line.area_weight * pressure
        return float(
            weight @ (body.fem.trace @ np.asarray(temperature)[body.fem.contact_nodes]) / weight.sum()
        )


NO_LOADS = BodyLoads()
