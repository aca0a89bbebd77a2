"""Input deck for CalculiX: both bodies on the mesh of fem-seal, exponential contact law, a sequence of forces.

Lengths are in mm, forces in N, stresses in MPa, as CalculiX users have it.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from skfem import MeshTri

from fem_seal.materials import Material
from leak import ExponentialLaw
from meshes import SealMesh

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
Elements = Literal["CAX6", "CAX8", "CAX8R"]

# CalculiX's face-to-face contact acts where the surfaces overlap only; p(u) goes on where they do not. The law is
# therefore written from this pressure [MPa] on, and the closure starts that much deeper.
LOWEST_PRESSURE = 1e-4
# Smallest sine of a corner of a quadrilateral.
_SHARPEST = 0.3


@dataclass(frozen=True)
class Choices:
    """What an analyst decides in CalculiX.

    Parameters
    ----------
    elements : str
        Quadratic triangles, or quadrilaterals (pairs of the same triangles; the few left over stay triangles).
    curved : bool
        Whether the midside nodes of the contact line lie on the faces, not on chords.
    held_steps : int
        Further steps at the same load, which pair the surfaces anew.
    tolerance : float
        Relative residual force and correction at which the iteration stops.
    """

    elements: Elements = "CAX8R"
    curved: bool = True
    held_steps: int = 0
    tolerance: float = 1e-6


@dataclass(frozen=True)
class Cells:
    """Elements of one type in one body: node numbers from 0, corners counter-clockwise, then the nodes between."""

    body: str
    type: str
    nodes: IntArray


def deck(
    seal_mesh: SealMesh,
    materials: dict[str, Material],
    law: ExponentialLaw,
    axial_forces: Sequence[float],
    first_peak: float,
    choices: Choices,
) -> str:
    """Deck that closes the seal with one force after the other, one step (and `held_steps`) each.

    Parameters
    ----------
    seal_mesh : SealMesh
    materials : dict
        Of "closure" and "seat".
    law : ExponentialLaw
    axial_forces : sequence of float
        [N]
    first_peak : float
        Peak pressure to expect under the first force [Pa]; the closure starts with the overlap that belongs to it.
    choices : Choices
    """
    cells = list(cells_of(seal_mesh.mesh, choices.elements))
    return "\n".join(
        [
            "*HEADING",
            "closure pressed on seat; mm, N, MPa",
            *_nodes(seal_mesh, cells, law, first_peak, choices.curved),
            *_bodies(cells, materials),
            *_contact(seal_mesh.mesh, cells, law),
            *_supports(seal_mesh.mesh),
            *_steps(seal_mesh.mesh, cells, axial_forces, choices),
            "",
        ]
    )


def node_points(seal_mesh: SealMesh, curved: bool) -> FloatArray:
    """Points (r, z) of the vertices, then of the facets' middles [m], shape (2, n)."""
    mesh, contact = seal_mesh.mesh, seal_mesh.contact
    middle = mesh.p[:, mesh.facets].mean(axis=1)
    if curved:
        facets = mesh.boundaries["closure_contact"]
        x = contact.coordinate(*middle[:, facets])
        middle[:, facets] = contact.point(x) + contact.gap(x) * contact.normal(x)
        # and those of a seat that is round itself
        facets = mesh.boundaries["seat_contact"]
        middle[:, facets] = contact.point(contact.coordinate(*middle[:, facets]))
    return np.hstack([mesh.p, middle])


def _nodes(
    seal_mesh: SealMesh, cells: Iterable[Cells], law: ExponentialLaw, first_peak: float, curved: bool
) -> Iterator[str]:
    points = node_points(seal_mesh, curved)
    overlap = law.u0 * math.log(1e-6 * first_peak / LOWEST_PRESSURE)
    closure = np.unique(np.concatenate([c.nodes.ravel() for c in cells if c.body == "closure"]))
    points[1, closure] -= overlap / math.cos(seal_mesh.contact.angle)
    used = np.unique(np.concatenate([c.nodes.ravel() for c in cells]))
    yield "*NODE"
    yield from (f"{k + 1},{r:.12e},{z:.12e}" for k, (r, z) in zip(used, 1e3 * points.T[used], strict=True))


def _bodies(cells: Sequence[Cells], materials: dict[str, Material]) -> Iterator[str]:
    number = 0
    for part in cells:
        yield f"*ELEMENT, TYPE={part.type}, ELSET={part.body}"
        for nodes in part.nodes + 1:
            number += 1
            yield f"{number}," + ",".join(map(str, nodes))
    for body, material in materials.items():
        yield f"*MATERIAL, NAME={body}"
        yield from ("*ELASTIC", f"{material.youngs_modulus * 1e-6:.12g},{material.poissons_ratio:.12g}")
        yield f"*SOLID SECTION, ELSET={body}, MATERIAL={body}"


def _contact(mesh: MeshTri, cells: Sequence[Cells], law: ExponentialLaw) -> Iterator[str]:
    for body in ("closure", "seat"):
        yield f"*SURFACE, NAME={body}_contact, TYPE=ELEMENT"
        yield from (f"{cell},S{side}" for cell, side in sides_on(mesh, cells, f"{body}_contact"))
    yield "*SURFACE INTERACTION, NAME=interface"
    yield "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=EXPONENTIAL"
    # CalculiX asks for the clearance at which the pressure has fallen to a hundredth.
    yield f"{math.log(100) * law.u0 * 1e3:.12e},{LOWEST_PRESSURE:.12e}"
    yield "*CONTACT PAIR, INTERACTION=interface, TYPE=SURFACE TO SURFACE"
    yield "closure_contact,seat_contact"


def _supports(mesh: MeshTri) -> Iterator[str]:
    for boundary in ("closure_axis", "seat_bottom"):
        facets = mesh.boundaries[boundary]
        nodes = np.unique(np.concatenate([mesh.facets[:, facets].ravel(), mesh.nvertices + facets]))
        yield f"*NSET, NSET=N{boundary}"
        yield from (str(node + 1) for node in nodes)
    yield from ("*BOUNDARY", "Nclosure_axis,1,1", "Nseat_bottom,2,2")


def _steps(
    mesh: MeshTri, cells: Sequence[Cells], axial_forces: Sequence[float], choices: Choices
) -> Iterator[str]:
    facets = mesh.boundaries["closure_top"]
    area = np.pi * 1e6 * float(np.abs(np.diff(mesh.p[0, mesh.facets[:, facets]] ** 2, axis=0)).sum())
    sides = sides_on(mesh, cells, "closure_top")
    for number, force in enumerate(np.repeat(axial_forces, 1 + choices.held_steps)):
        yield from ("*STEP", "*STATIC", "1.,1.")
        if number == 0:
            yield from ("*CONTROLS, PARAMETERS=FIELD", f"{choices.tolerance:g},{choices.tolerance:g}")
        yield "*DLOAD"
        yield from (f"{cell},P{side},{force / area:.12e}" for cell, side in sides)
        yield from ("*CONTACT FILE", "CDIS,CSTR", "*NODE PRINT, NSET=Nseat_bottom, TOTALS=ONLY", "RF")
        yield "*END STEP"


def sides_on(mesh: MeshTri, cells: Sequence[Cells], boundary: str) -> list[tuple[int, int]]:
    """Element number and side, both from 1, of each facet of a boundary."""
    facets = mesh.nvertices + mesh.boundaries[boundary]
    faces, first = [], 1
    for part in cells:
        middles = part.nodes[:, part.nodes.shape[1] // 2 :]
        rows, columns = np.nonzero(np.isin(middles, facets))
        faces += list(zip((first + rows).tolist(), (1 + columns).tolist(), strict=True))
        first += len(part.nodes)
    return faces


def cells_of(mesh: MeshTri, elements: Elements) -> Iterator[Cells]:
    e, f = mesh.p[:, mesh.t[1]] - mesh.p[:, mesh.t[0]], mesh.p[:, mesh.t[2]] - mesh.p[:, mesh.t[0]]
    triangles = np.where(e[0] * f[1] > e[1] * f[0], mesh.t, mesh.t[[0, 2, 1]]).T
    quadrilaterals, owner = np.empty((0, 4), dtype=np.int64), np.empty(0, dtype=np.int64)
    is_triangle = np.ones(mesh.nelements, dtype=bool)
    if elements != "CAX6":
        quadrilaterals, owner, is_triangle = _paired(mesh)
    for body, members in mesh.subdomains.items():
        is_member = np.isin(np.arange(mesh.nelements), members)
        yield Cells(body, "CAX6", _with_middles(mesh, triangles[is_member & is_triangle]))
        if len(owner):
            yield Cells(body, elements, _with_middles(mesh, quadrilaterals[is_member[owner]]))


def _paired(mesh: MeshTri) -> tuple[IntArray, IntArray, NDArray[np.bool_]]:
    """Join neighbouring triangles to quadrilaterals, the best shapes first.

    Returns
    -------
    corners : ndarray of int, shape (n, 4)
    owner : ndarray of int, shape (n,)
        One of the two triangles of each.
    left : ndarray of bool, shape (triangles,)
        Triangles that found no partner.
    """
    inner = np.flatnonzero(mesh.f2t[1] >= 0)
    first_side, second_side = mesh.f2t[:, inner]
    start, end = mesh.facets[:, inner]
    opposite = [mesh.t[:, cell].sum(axis=0) - start - end for cell in (first_side, second_side)]
    corners = np.stack([start, opposite[0], end, opposite[1]])
    side = np.roll(mesh.p[:, corners], -1, axis=1) - mesh.p[:, corners]
    side /= np.linalg.norm(side, axis=0)
    previous = -np.roll(side, 1, axis=1)
    sine = side[0] * previous[1] - side[1] * previous[0]
    clockwise = sine.sum(axis=0) < 0
    corners[:, clockwise] = corners[::-1, clockwise]
    shape = np.where(clockwise, -sine, sine).min(axis=0)
    is_free = np.ones(mesh.nelements, dtype=bool)
    pairs = []
    for k in np.argsort(-shape, kind="stable")[: int((shape > _SHARPEST).sum())]:
        if is_free[first_side[k]] and is_free[second_side[k]]:
            is_free[[first_side[k], second_side[k]]] = False
            pairs.append(k)
    return corners[:, pairs].T, first_side[pairs], is_free


def _with_middles(mesh: MeshTri, corners: IntArray) -> IntArray:
    """Corners and the nodes in the middle of the sides that follow them."""
    keys = mesh.facets.min(axis=0) * mesh.nvertices + mesh.facets.max(axis=0)
    order = np.argsort(keys)
    next_corners = np.roll(corners, -1, axis=1)
    sides = np.minimum(corners, next_corners) * mesh.nvertices + np.maximum(corners, next_corners)
    return np.hstack([corners, mesh.nvertices + order[np.searchsorted(keys[order], sides)]])
