"""NAFEMS contact benchmark 2 once more, by finite elements of its own: a judge where published numbers differ.

Axisymmetric quadrilaterals of scikit-fem in both bodies, nodes of one face over those of the other, no friction, small
strain: nothing of fem-seal is used. Lengths in mm, stresses in MPa.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import bmat, csr_matrix
from scipy.sparse.linalg import spsolve
from skfem import Basis, BilinearForm, ElementQuad1, ElementVector, FacetBasis, LinearForm, MeshQuad

FloatArray = NDArray[np.float64]

# Radius of the flat part, rounding of the edge, radius and height of punch and foundation; pressure on the punch.
FLAT, EDGE, PUNCH, FOUNDATION, LOAD = 40.0, 10.0, (50.0, 100.0), (100.0, 200.0), 100.0
# Where the faces are no longer compared: they stand far apart.
FARTHEST = 49.0


def lift(r: FloatArray) -> FloatArray:
    """How far the punch's face stands above the foundation before it is loaded."""
    return np.where(r > FLAT, EDGE - np.sqrt(np.maximum(EDGE**2 - (r - FLAT) ** 2, 0.0)), 0.0)


def settlement(size: float, at_edge: float | None = None) -> tuple[float, float]:
    """How far the middle of the foundation sinks, and the mean pressure within 10 mm of it [mm, MPa].

    Parameters
    ----------
    size : float
        Of the elements [mm].
    at_edge : float, optional
        Size where the faces part, from which it grows by a tenth from element to element; even unless given [mm].
    """
    fine = size if at_edge is None else at_edge
    inner, rounded = FLAT - _steps(FLAT, fine, size)[::-1], FLAT + _steps(EDGE, fine, size)[1:]
    r = np.r_[inner, rounded]
    outer = np.linspace(PUNCH[0], FOUNDATION[0], round((FOUNDATION[0] - PUNCH[0]) / size) + 1)[1:]
    punch = _Body(r, _steps(PUNCH[1], fine, size), 210e3, lift)
    # z of the foundation points into it
    base = _Body(np.r_[r, outer], _steps(FOUNDATION[1], fine, size), 70e3, np.zeros_like)
    gap, n = lift(punch.radius), punch.radius.size
    dofs = punch.stiffness.shape[0], base.stiffness.shape[0]
    stiffness = bmat([[punch.stiffness, None], [None, base.stiffness]]).tocsr()
    closing = csr_matrix(
        (np.ones(2 * n), (np.tile(np.arange(n), 2), np.r_[punch.face, dofs[0] + base.face])),
        shape=(n, sum(dofs)),
    )
    held = np.r_[punch.axis, dofs[0] + base.axis, dofs[0] + base.bottom]
    free = np.setdiff1d(np.arange(sum(dofs)), held)
    force, touches = np.r_[punch.load(), np.zeros(dofs[1])], gap == 0.0
    for _ in range(50):
        C = closing[touches][:, free]
        system = bmat([[stiffness[free][:, free], -C.T], [-C, None]]).tocsc()
        solution = spsolve(system, np.r_[force[free], gap[touches]])
        u, forces = np.zeros(sum(dofs)), np.zeros(n)
        u[free], forces[touches] = solution[: free.size], solution[free.size :]
        next_touches = (touches & (forces > 0.0)) | (~touches & (gap + closing @ u < 0.0))
        if np.array_equal(next_touches, touches):
            inside = int(np.searchsorted(punch.radius, 0.25 * FLAT))
            at, width = punch.radius[inside - 1], punch.radius[inside] - punch.radius[inside - 1]
            # the last node also carries its share of the ring outside
            area = np.pi * at**2 + 2 * np.pi * width * (at / 2 + width / 6)
            return float(-u[dofs[0] + base.face[0]]), float(forces[:inside].sum() / area)
        touches = next_touches
    raise RuntimeError("the faces did not settle")


def _steps(length: float, first: float, most: float) -> FloatArray:
    """From 0 to a length, growing by a tenth up to a size."""
    sizes = [first]
    while sum(sizes) < length:
        sizes.append(min(1.1 * sizes[-1], most))
    ends = np.r_[0.0, np.cumsum(sizes)]
    return ends * (length / ends[-1])


class _Body:
    """Stiffness of one body, its dofs of z on the face by radius, and those that are held."""

    def __init__(self, r: FloatArray, z: FloatArray, E: float, face) -> None:
        grid = MeshQuad.init_tensor(r, z)
        low, top = face(grid.p[0]), z[-1]
        self.mesh = MeshQuad(np.stack([grid.p[0], low + (top - low) * grid.p[1] / top]), grid.t)
        self.basis = Basis(self.mesh, ElementVector(ElementQuad1()), intorder=4)
        nu = 0.3
        lame, mu = E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))

        @BilinearForm
        def form(u, v, w):
            r = w.x[0]
            e, d = ((g.grad[0][0], g.grad[1][1], g[0] / r) for g in (u, v))
            shear = (u.grad[0][1] + u.grad[1][0]) * (v.grad[0][1] + v.grad[1][0])
            along = sum(one * other for one, other in zip(e, d, strict=True))
            return 2 * np.pi * r * (lame * sum(e) * sum(d) + 2 * mu * along + mu * shear)

        self.stiffness = form.assemble(self.basis)
        below = grid.facets_satisfying(lambda x: (x[1] < 1e-9) & (x[0] < FARTHEST), boundaries_only=True)
        dofs = self.basis.get_dofs(below).all(["u^2"])
        order = np.argsort(self.basis.doflocs[0, dofs])
        self.face, self.radius = dofs[order], self.basis.doflocs[0, dofs][order]
        self.axis = self.basis.get_dofs(lambda x: x[0] < 1e-9).all(["u^1"])
        self.bottom = self.basis.get_dofs(lambda x: x[1] > top - 1e-9).all()

    def load(self) -> FloatArray:
        """Forces of the pressure on the end that is away from the face."""
        end = self.mesh.facets_satisfying(lambda x: x[1] > self.mesh.p[1].max() - 1e-9, boundaries_only=True)
        basis = FacetBasis(self.mesh, self.basis.elem, facets=end)
        return LinearForm(lambda v, w: -LOAD * 2 * np.pi * w.x[0] * v[1]).assemble(basis)
