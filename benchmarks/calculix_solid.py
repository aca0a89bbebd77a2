"""Input deck for CalculiX: a quarter of both bodies as solids, the seat's face two-lobed, one closing force.

The triangles of the section, joined to quadrilaterals, are turned about the axis from 0 to 90 degrees, or to 180 where
a moment acts beside the force. Lengths are in mm, forces in N, stresses in MPa, as CalculiX users have it. The axis of
the seal is z, the angle 0 lies on x.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from calculix_deck import LOWEST_PRESSURE, Cells, FloatArray, IntArray, cells_of, node_points, sides_on

from fem_seal.bolts import BoltCircle
from fem_seal.materials import Material
from leak import ExponentialLaw
from meshes import SealMesh

# Of a coordinate that is zero on the axis [mm].
_ON_AXIS = 1e-9
_TYPES = {3: "C3D15", 4: "C3D20R"}


@dataclass(frozen=True, eq=False)
class SolidBody:
    """A quarter or a half of a body, symmetric about the planes at its ends.

    Parameters
    ----------
    name : str
        "closure" or "seat".
    section : SealMesh
        Both bodies' section.
    layers : int
        Quadratic elements over the span.
    deviation : float
        A [m] of its contact face, which lies higher along the contact normal by A cos(2 phi).
    higher : float
        By how much all of it stands higher than in first touch [m].
    first_node, first_element : int
        Numbers of its first node and element.
    span : float
        pi/2 or pi [rad].
    """

    name: str
    section: SealMesh
    layers: int
    deviation: float
    higher: float
    first_node: int
    first_element: int
    span: float = math.pi / 2

    @cached_property
    def cells(self) -> list[Cells]:
        """Elements of the section."""
        return [part for part in cells_of(self.section.mesh, "CAX8R") if part.body == self.name]

    @cached_property
    def angle(self) -> FloatArray:
        """Angles of the planes of nodes [rad], shape (2 layers + 1,); each second one is between the corners."""
        return np.linspace(0.0, self.span, 2 * self.layers + 1)

    @cached_property
    def number(self) -> IntArray:
        """Number of each of the section's nodes on each plane, shape (planes, nodes); 0 where there is none.

        On the axis the planes share their nodes.
        """
        mesh = self.section.mesh
        used = np.zeros(mesh.nvertices + mesh.nfacets, dtype=bool)
        for part in self.cells:
            used[part.nodes] = True
        corner = used & (np.arange(len(used)) < mesh.nvertices)
        exists = np.where(np.arange(len(self.angle))[:, None] % 2, corner, used)
        axis = self._points[0] < _ON_AXIS
        exists[1:, axis] = False
        number = np.where(exists, self.first_node - 1 + np.cumsum(exists).reshape(exists.shape), 0)
        number[1:, axis] = (
            np.where(np.arange(1, len(number))[:, None] % 2, corner[axis], used[axis]) * number[0, axis]
        )
        return number

    @cached_property
    def _points(self) -> FloatArray:
        """(r, z) of the section's nodes [mm]."""
        return 1e3 * node_points(self.section, curved=True)

    def boundary_nodes(self, boundary: str) -> IntArray:
        """The section's nodes on one of its boundaries."""
        mesh = self.section.mesh
        facets = mesh.boundaries[f"{self.name}_{boundary}"]
        return np.unique(np.concatenate([mesh.facets[:, facets].ravel(), mesh.nvertices + facets]))

    def places(self) -> FloatArray:
        """(x, y, z) of all nodes [mm], shape (nodes, 3), by their number."""
        face, theta = self.boundary_nodes("contact"), self.section.contact.angle
        places = np.zeros((self.number.max() - self.first_node + 1, 3))
        for plane, (angle, number) in enumerate(zip(self.angle, self.number, strict=True)):
            r, z = self._points.copy()
            z += 1e3 * self.higher
            # On the chord: CalculiX cuts the faces of both bodies against each other as if their outlines were convex.
            r[face] *= math.cos(self.angle[1]) if plane % 2 else 1.0
            shift = 1e3 * self.deviation * math.cos(2 * angle)
            r[face] -= shift * math.sin(theta)
            z[face] += shift * math.cos(theta)
            has_node = number > 0
            places[number[has_node] - self.first_node] = np.column_stack(
                [r * math.cos(angle), r * math.sin(angle), z]
            )[has_node]
        return places

    def elements(self) -> Iterator[tuple[str, IntArray]]:
        """Type and node numbers of the elements of each part of the section, layer by layer.

        The section's nodes stand counter-clockwise in (r, z) and thereby look back: an element begins on its far plane.
        """
        for part in self.cells:
            corners, middles = np.hsplit(part.nodes, 2)
            nodes = [
                np.hstack([far[corners], inner[corners], far[middles], inner[middles], middle[corners]])
                for inner, middle, far in zip(
                    self.number[:-2:2], self.number[1::2], self.number[2::2], strict=True
                )
            ]
            yield _TYPES[corners.shape[1]], np.concatenate(nodes)

    @property
    def end_element(self) -> int:
        """The number after its last element."""
        return self.first_element + self.layers * sum(len(part.nodes) for part in self.cells)

    def faces(self, boundary: str) -> list[tuple[int, int]]:
        """Number and face of each element at a boundary of the section."""
        counts = [len(part.nodes) for part in self.cells]
        offsets = np.cumsum([0, *counts])
        facets = []
        for cell, side in sides_on(self.section.mesh, self.cells, f"{self.name}_{boundary}"):
            part = int(np.searchsorted(offsets, cell, side="left")) - 1
            first = self.first_element + (self.layers - 1) * int(offsets[part]) + cell - 1
            facets += [(first + k * counts[part], side + 2) for k in range(self.layers)]
        return facets


@dataclass(frozen=True)
class SolidSeal:
    """A quarter or a half of the seal."""

    closure: SolidBody
    seat: SolidBody

    @classmethod
    def of(
        cls,
        section: SealMesh,
        layers: int,
        deviation: float,
        way_down: float,
        span: float = math.pi / 2,
    ) -> SolidSeal:
        """Turn a section about the axis.

        Parameters
        ----------
        section : SealMesh
        layers : int
            Quadratic elements over the span.
        deviation : float
            A [m] of the seat's face, which lies higher along its normal by A cos(2 phi).
        way_down : float
            By how much the closure starts below first touch along the normal [m].
        span : float
            pi/2 or pi [rad].
        """
        motion = -way_down / math.cos(section.contact.angle)
        closure = SolidBody("closure", section, layers, 0.0, motion, 1, 1, span)
        first_node = int(closure.number.max()) + 1
        seat = SolidBody("seat", section, layers, deviation, 0.0, first_node, closure.end_element, span)
        return cls(closure, seat)

    @property
    def bodies(self) -> tuple[SolidBody, SolidBody]:
        """Both bodies."""
        return self.closure, self.seat


def solid_deck(
    seal: SolidSeal,
    materials: Mapping[str, Material],
    law: ExponentialLaw,
    axial_force: float,
    tolerance: float,
    moment: float = 0.0,
    bolts: BoltCircle | None = None,
) -> str:
    """Deck that presses the closure into the seat.

    Parameters
    ----------
    seal : SolidSeal
    materials : mapping
        Of "closure" and "seat".
    law : ExponentialLaw
    axial_force : float
        Of the whole seal [N].
    tolerance : float
        Relative residual force and correction at which the iteration stops.
    moment : float
        Of the load on the closure's top [N m]; it presses at 0 degrees, and needs a half of the seal.
    bolts : BoltCircle, optional
        In place of an even load on the closure's top; the other half has the same ones.
    """
    return "\n".join(
        [
            "*HEADING",
            "closure pressed on a two-lobed seat; mm, N, MPa",
            "*NODE",
            *(
                f"{n},{x:.12e},{y:.12e},{z:.12e}"
                for body in seal.bodies
                for n, (x, y, z) in enumerate(body.places(), start=body.first_node)
            ),
            *_bodies(seal, materials),
            *_contact(seal, law),
            *_supports(seal),
            *_step(seal, _top_load(seal, axial_force, moment, bolts), tolerance),
            "",
        ]
    )


def _bodies(seal: SolidSeal, materials: Mapping[str, Material]) -> Iterator[str]:
    number = 0
    for body in seal.bodies:
        for kind, elements in body.elements():
            yield f"*ELEMENT, TYPE={kind}, ELSET={body.name}"
            for nodes in elements:
                number += 1
                # A line of a deck holds sixteen numbers.
                words = [str(number), *map(str, nodes)]
                yield ",".join(words[:16]) + ("," if len(words) > 16 else "")
                if len(words) > 16:
                    yield ",".join(words[16:])
    for body, material in materials.items():
        yield f"*MATERIAL, NAME={body}"
        yield from ("*ELASTIC", f"{material.youngs_modulus * 1e-6:.12g},{material.poissons_ratio:.12g}")
        yield f"*SOLID SECTION, ELSET={body}, MATERIAL={body}"


def _contact(seal: SolidSeal, law: ExponentialLaw) -> Iterator[str]:
    for body in seal.bodies:
        yield f"*SURFACE, NAME={body.name}_contact, TYPE=ELEMENT"
        yield from (f"{element},S{face}" for element, face in body.faces("contact"))
    yield "*SURFACE INTERACTION, NAME=interface"
    yield "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=EXPONENTIAL"
    # CalculiX asks for the clearance at which the pressure has fallen to a hundredth.
    yield f"{math.log(100) * law.u0 * 1e3:.12e},{LOWEST_PRESSURE:.12e}"
    # One pair for all of it: CalculiX 2.20 loses part of the area of pairs that share an edge.
    yield from (
        "*CONTACT PAIR, INTERACTION=interface, TYPE=SURFACE TO SURFACE",
        "closure_contact,seat_contact",
    )


def _supports(seal: SolidSeal) -> Iterator[str]:
    """Symmetry in both planes and on the axis where they meet, and the seat's bottom held axially.

    Halves could slide along their plane; a node of each holds them, where it moves by nothing else.
    """
    start, end = (np.concatenate([body.number[plane] for body in seal.bodies]) for plane in (0, -1))
    bottom = seal.seat.number[:, seal.seat.boundary_nodes("bottom")]
    is_half = seal.seat.span > 3.0
    top = seal.closure.number[:, seal.closure.boundary_nodes("top")]
    held = np.array([body.number[body.layers, body.boundary_nodes("contact")[0]] for body in seal.bodies])
    for name, numbers in (
        ("start", start),
        ("end", end),
        ("bottom", bottom),
        ("top", top),
        ("held", held),
    ):
        yield f"*NSET, NSET={name}"
        yield from (str(n) for n in np.unique(numbers[numbers > 0]))
    yield from ("*BOUNDARY", "start,2,2", "bottom,3,3")
    yield from ("end,2,2", "held,1,1") if is_half else ("end,1,1",)


def _top_load(seal: SolidSeal, axial_force: float, moment: float, bolts: BoltCircle | None) -> Iterator[str]:
    if bolts is not None:
        yield "*CLOAD"
        yield from (f"{node},3,{-force:.12e}" for node, force in bolt_forces(seal.closure, bolts).items())
        return
    mesh, closure = seal.closure.section.mesh, seal.closure
    radii = np.sort(1e3 * mesh.p[0, mesh.facets[:, mesh.boundaries["closure_top"]]], axis=0)
    even = axial_force / (math.pi * float(np.diff(radii**2, axis=0).sum()))
    # what waves is as large as it is in the middle of each face: 2 sum cos(middle) (sin(end) - sin(start)) r^3/3
    wave = np.cos(closure.angle[1::2])
    lever = 2.0 / 3.0 * float(np.diff(radii**3, axis=0).sum() * (wave @ np.diff(np.sin(closure.angle[::2]))))
    pressures = even + 1e3 * moment / lever * wave
    yield "*DLOAD"
    for k, (element, face) in enumerate(closure.faces("top")):
        yield f"{element},P{face},{pressures[k % closure.layers]:.12e}"


def bolt_forces(closure: SolidBody, bolts: BoltCircle) -> dict[int, float]:
    """Force of bolts on the closure's nodes [N], by number.

    Under each head it is even along the radius and half an ellipse around the axis, as that of a round one, and goes to
    the corners around each place with its resultant and its moments.
    """
    mesh, reach = closure.section.mesh, 0.5 * bolts.head / bolts.radius
    vertices = np.unique(mesh.facets[:, mesh.boundaries["closure_top"]])
    vertices = vertices[np.argsort(mesh.p[0, vertices])]
    # the integral over an ellipse by Chebyshev's quadrature of the second kind
    turn = math.pi * np.arange(1, _UNDER_HEAD + 1) / (_UNDER_HEAD + 1)
    weight = 2.0 / (_UNDER_HEAD + 1) * np.sin(turn) ** 2
    corners, forces = closure.angle[::2], np.zeros((closure.layers + 1, len(vertices)))
    radial = np.array([np.interp(bolts.radius, mesh.p[0, vertices], row) for row in np.eye(len(vertices))])
    for angle, tightness in zip(bolts.angles, bolts.tightness, strict=True):
        share = bolts.force * tightness / sum(bolts.tightness)
        at = (angle + reach * np.cos(turn) + math.pi) % (2.0 * math.pi) - math.pi
        inside = (at >= 0.0) & (at <= closure.span)
        around = [weight[inside] @ np.interp(at[inside], corners, row) for row in np.eye(len(corners))]
        forces += share * np.outer(around, radial)
    nodes = closure.number[::2, vertices]
    return {int(node): float(force) for node, force in zip(nodes.flat, forces.flat, strict=True) if force}


# Places around the axis at which the force of a head is taken, none of them in its middle.
_UNDER_HEAD = 1000


def _step(seal: SolidSeal, load: Iterable[str], tolerance: float) -> Iterator[str]:
    yield from ("*STEP, INC=200", "*STATIC", "1.,1.")
    yield from ("*CONTROLS, PARAMETERS=FIELD", f"{tolerance:g},{tolerance:g}")
    yield from load
    yield from ("*CONTACT FILE", "CDIS,CSTR", "*NODE PRINT, NSET=bottom, TOTALS=ONLY", "RF")
    yield from ("*NODE PRINT, NSET=top", "U", "*NODE PRINT, NSET=held", "RF")
    yield from ("*CONTACT PRINT, SLAVE=closure_contact, MASTER=seat_contact", "CF")
    yield "*END STEP"
