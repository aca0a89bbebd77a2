"""Two bodies of revolution under finite strain, pressed on each other: a reference that shares the mesh alone.

Total Lagrangian, quadratic triangles (straight sides but for the contact line), Hencky's elasticity in logarithmic
strains with J2 flow (Simo, Comput. Methods Appl. Mech. Eng. 99 (1992) 61), or a compressible neo-Hookean solid.
The contact pressure p_c exp(-u/u0) acts along the normal of the deformed seat on the deformed area, wherever the
closure has slid to.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import spsolve

from fem_seal.materials import Material
from meshes import SealMesh

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

# Quadrature of degree 4 on the triangle, and the three Gauss points of a side.
_A, _B = 0.445948490915965, 0.091576213509771
_POINTS = np.array(
    [[_A, _A], [1 - 2 * _A, _A], [_A, 1 - 2 * _A], [_B, _B], [1 - 2 * _B, _B], [_B, 1 - 2 * _B]]
)
_WEIGHTS = 0.5 * np.array(3 * [0.223381589678011] + 3 * [0.109951743655322])
_SIDE = np.polynomial.legendre.leggauss(3)
# Pressure above which the law goes on along its tangent while Newton's method has not settled.
_CAP = 4.0
# Change of ln p in one step of Newton's method.
_FARTHEST = 3.0


class UnsettledError(RuntimeError):
    """Newton's method did not find a balance."""


@dataclass(frozen=True)
class Profile:
    """Contact pressure over the deformed line.

    Parameters
    ----------
    x : ndarray
        Arc length on the deformed line [m].
    radius, pressure, weight : ndarray
        Deformed radius [m], true pressure [Pa], weights over x [m].
    """

    x: FloatArray
    radius: FloatArray
    pressure: FloatArray
    weight: FloatArray


class Solid:
    """Both bodies: points, elements, and what holds them.

    Parameters
    ----------
    seal_mesh : SealMesh
    points : ndarray, shape (2, n)
        Of vertices, then of the facets' middles [m].
    materials : dict of Material
    neo_hookean : bool
        Of the bodies that do not yield.
    """

    def __init__(
        self,
        seal_mesh: SealMesh,
        points: FloatArray,
        materials: dict[str, Material],
        neo_hookean: bool = False,
    ):
        mesh = seal_mesh.mesh
        self.points, self.materials, self.neo_hookean = points, materials, neo_hookean
        facets = mesh.t2f + mesh.nvertices  # between corners 0-1, 1-2, 0-2
        self.cells = np.vstack([mesh.t, facets]).T
        self.members = {name: mesh.subdomains[name] for name in materials}
        self.sides = {}
        for name in ("closure_contact", "seat_contact", "closure_top"):
            side_facets = mesh.boundaries[name]
            ends = mesh.facets[:, side_facets]
            turn = points[0, ends[0]] > points[0, ends[1]]
            ends = np.where(turn, ends[::-1], ends)
            order = np.argsort(points[0, ends].sum(axis=0))
            self.sides[name] = np.vstack([ends, side_facets + mesh.nvertices])[:, order].T
        fixed_dofs = []
        for name, component in (("closure_axis", 0), ("seat_bottom", 1)):
            side_facets = mesh.boundaries[name]
            nodes = np.unique(
                np.concatenate([mesh.facets[:, side_facets].ravel(), side_facets + mesh.nvertices])
            )
            fixed_dofs.append(2 * nodes + component)
        used = np.unique(self.cells)
        dofs = np.sort(np.concatenate([2 * used, 2 * used + 1]))
        self.free = np.setdiff1d(dofs, np.concatenate(fixed_dofs))
        self._prepare()

    def _prepare(self) -> None:
        r, s = _POINTS.T
        l0 = 1 - r - s
        N = np.stack([l0 * (2 * l0 - 1), r * (2 * r - 1), s * (2 * s - 1), 4 * l0 * r, 4 * r * s, 4 * l0 * s])
        dr = np.stack([1 - 4 * l0, 4 * r - 1, 0 * r, 4 * (l0 - r), 4 * s, -4 * s])
        ds = np.stack([1 - 4 * l0, 0 * r, 4 * s - 1, -4 * r, 4 * r, 4 * (l0 - s)])
        X = self.points[:, self.cells]  # (2, cells, 6)
        J = np.stack([np.einsum("icn,nq->icq", X, dr), np.einsum("icn,nq->icq", X, ds)], axis=1)  # dX_i/dxi_j
        det = J[0, 0] * J[1, 1] - J[0, 1] * J[1, 0]
        inverse = np.stack([np.stack([J[1, 1], -J[0, 1]]), np.stack([-J[1, 0], J[0, 0]])]) / det
        grad = np.stack([dr, ds])  # (2, 6, q)
        D = np.einsum("jnq,jicq->cqin", grad, inverse)  # dN_n/dX_i
        R = np.einsum("cn,nq->cq", X[0], N)
        cells, q = R.shape
        # rows: F_rr, F_rz, F_zr, F_zz, F_tt; columns: u_r, u_z of the six nodes
        G = np.zeros((cells, q, 5, 12))
        G[:, :, 0, 0::2], G[:, :, 1, 0::2] = D[:, :, 0], D[:, :, 1]
        G[:, :, 2, 1::2], G[:, :, 3, 1::2] = D[:, :, 0], D[:, :, 1]
        G[:, :, 4, 0::2] = N.T[None] / R[:, :, None]
        self.G, self.weight = G, 2 * np.pi * R * np.abs(det) * _WEIGHTS
        self.dofs = np.stack([2 * self.cells, 2 * self.cells + 1], axis=2).reshape(cells, 12)

    @property
    def at_rest(self) -> FloatArray:
        """Displacements of all dofs, none [m]."""
        return np.zeros(2 * self.points.shape[1])

    def no_history(self) -> dict[str, tuple[FloatArray, FloatArray]]:
        """Inverse plastic metric and plastic strain at every point of bodies that yield."""
        q = len(_WEIGHTS)
        eye = np.array([1.0, 0.0, 1.0, 1.0])  # rr, rz, zz, tt
        return {
            name: (np.tile(eye, (len(members), q, 1)), np.zeros((len(members), q)))
            for name, members in self.members.items()
        }

    def sound(self, u: FloatArray) -> bool:
        """Whether no element is turned inside out, nor near to it."""
        F = np.einsum("cqij,cj->cqi", self.G, u[self.dofs]) + np.array([1.0, 0, 0, 1.0, 1.0])
        return bool((F[..., 0] * F[..., 3] - F[..., 1] * F[..., 2] > 0.1).all() and (F[..., 4] > 0.1).all())

    def inner(
        self, u: FloatArray, history: dict[str, Any], tangent: bool = True
    ) -> tuple[FloatArray, Any, dict[str, Any]]:
        """Nodal forces, stiffness matrix (None unless asked for) and new history."""
        size = len(u)
        forces, rows, columns, values, new = np.zeros(size), [], [], [], {}
        for name, members in self.members.items():
            G, w, dofs = self.G[members], self.weight[members], self.dofs[members]
            F = np.einsum("cqij,cj->cqi", G, u[dofs]) + np.array([1.0, 0, 0, 1.0, 1.0])
            law = self._law(self.materials[name], *history[name])
            P, new[name] = law(F)
            np.add.at(forces, dofs, np.einsum("cqij,cqi,cq->cj", G, P, w))
            if not tangent:
                continue
            A = np.empty((*F.shape, 5))
            step = 1e-7
            for k in range(5):
                G_k = np.zeros(5)
                G_k[k] = step
                A[..., k] = (law(F + G_k)[0] - law(F - G_k)[0]) / (2 * step)
            AG = np.matmul(A * w[..., None, None], G)
            K = np.matmul(np.swapaxes(G, 2, 3), AG).sum(axis=1)
            rows.append(np.repeat(dofs, 12, axis=1).ravel())
            columns.append(np.tile(dofs, (1, 12)).ravel())
            values.append(K.ravel())
        if not tangent:
            return forces, None, new
        K = coo_matrix(
            (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape=(size, size)
        )
        return forces, K, new

    def _law(
        self, material: Material, metric: FloatArray, strain: FloatArray
    ) -> Callable[[FloatArray], tuple[FloatArray, tuple[FloatArray, FloatArray]]]:
        E, nu = material.youngs_modulus, material.poissons_ratio
        mu, lam = E / 2 / (1 + nu), E * nu / (1 + nu) / (1 - 2 * nu)
        if material.hardening is None and self.neo_hookean:
            return lambda F: (_neo_hookean(F, mu, lam), (metric, strain))
        return lambda F: _hencky(F, mu, lam, material, metric, strain)


def _inverse_transposed(F: FloatArray) -> tuple[FloatArray, FloatArray]:
    det = F[..., 0] * F[..., 3] - F[..., 1] * F[..., 2]
    inverse = np.stack([F[..., 3], -F[..., 2], -F[..., 1], F[..., 0], det / F[..., 4]], axis=-1)
    return inverse / det[..., None], det * F[..., 4]


def _neo_hookean(F: FloatArray, mu: float, lam: float) -> FloatArray:
    """P = mu (F - F^-T) + lambda ln J F^-T."""
    inverse, J = _inverse_transposed(F)
    if not (J > 0).all():
        raise UnsettledError("a body is turned inside out")
    return mu * (F - inverse) + lam * np.log(J)[..., None] * inverse


def _hencky(
    F: FloatArray, mu: float, lam: float, material: Material, metric: FloatArray, strain: FloatArray
) -> tuple[FloatArray, tuple[FloatArray, FloatArray]]:
    """Return mapping in logarithmic strains; P = tau F^-T."""
    a, b, c, d, t = np.moveaxis(F, -1, 0)
    g_rr, g_rz, g_zz, g_tt = np.moveaxis(metric, -1, 0)
    # b = F Cp^-1 F^T
    rr = a * a * g_rr + 2 * a * b * g_rz + b * b * g_zz
    rz = a * c * g_rr + (a * d + b * c) * g_rz + b * d * g_zz
    zz = c * c * g_rr + 2 * c * d * g_rz + d * d * g_zz
    tt = t * t * g_tt
    mean, half = 0.5 * (rr + zz), 0.5 * (rr - zz)
    radius = np.hypot(half, rz)
    angle = 0.5 * np.arctan2(rz, half)
    cos, sin = np.cos(angle), np.sin(angle)
    squares = np.stack([mean + radius, mean - radius, tt])
    if not (squares > 0).all():
        raise UnsettledError("a body is turned inside out")
    e = 0.5 * np.log(squares)
    volume = e.sum(axis=0)
    dev = e - volume / 3
    factor = np.ones_like(volume)
    new = strain
    if material.hardening is not None:
        norm = np.sqrt((dev**2).sum(axis=0))
        trial = np.sqrt(6) * mu * norm  # equivalent stress
        curve = material.hardening
        table_e, table_s = np.asarray(curve.plastic_strain), np.asarray(curve.stress)
        step = np.zeros_like(trial)
        # piecewise linear: a few rounds settle on the right piece
        for _ in range(30):
            flow = np.interp(strain + step, table_e, table_s)
            slope = (np.interp(strain + step + 1e-9, table_e, table_s) - flow) / 1e-9
            change = (trial - 3 * mu * step - flow) / (3 * mu + slope)
            step = np.maximum(step + change, 0.0)
            if np.abs(change[step > 0]).max(initial=0.0) < 1e-13:
                break
        factor = 1 - 3 * mu * step / np.maximum(trial, 1e-30)
        new = strain + step
    dev = dev * factor
    tau = 2 * mu * dev + (lam + 2 * mu / 3) * volume
    s_rr, s_zz = cos**2 * tau[0] + sin**2 * tau[1], sin**2 * tau[0] + cos**2 * tau[1]
    s_rz = cos * sin * (tau[0] - tau[1])
    I, _ = _inverse_transposed(F)  # noqa: E741
    P = np.stack(
        [
            s_rr * I[..., 0] + s_rz * I[..., 2],
            s_rr * I[..., 1] + s_rz * I[..., 3],
            s_rz * I[..., 0] + s_zz * I[..., 2],
            s_rz * I[..., 1] + s_zz * I[..., 3],
            tau[2] * I[..., 4],
        ],
        axis=-1,
    )
    if material.hardening is None:
        return P, (metric, strain)
    squares = np.exp(2 * (dev + volume / 3))
    b_rr, b_zz = cos**2 * squares[0] + sin**2 * squares[1], sin**2 * squares[0] + cos**2 * squares[1]
    b_rz = cos * sin * (squares[0] - squares[1])
    # Cp^-1 = F^-1 b F^-T, with I = F^-T
    ia, ib, ic, id_, it = np.moveaxis(I, -1, 0)  # F^-T_rr, rz, zr, zz, tt
    m_rr = ia * ia * b_rr + 2 * ia * ic * b_rz + ic * ic * b_zz
    m_rz = ia * ib * b_rr + (ia * id_ + ib * ic) * b_rz + ic * id_ * b_zz
    m_zz = ib * ib * b_rr + 2 * ib * id_ * b_rz + id_ * id_ * b_zz
    return P, (np.stack([m_rr, m_rz, m_zz, it * it * squares[2]], axis=-1), new)


@dataclass(frozen=True)
class _Touch:
    """Contact forces in a state: nodal forces, their stiffness, and the profile."""

    forces: FloatArray
    stiffness: Any
    profile: Profile


def _shape(xi: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Shape functions of a side (start, end, middle) over xi from -1 to 1, and their derivative."""
    return (
        np.stack([0.5 * xi * (xi - 1), 0.5 * xi * (xi + 1), 1 - xi**2], axis=-1),
        np.stack([xi - 0.5, xi + 0.5, -2 * xi], axis=-1),
    )


def touch(solid: Solid, u: FloatArray, u0: float, p_c: float, cap: float) -> _Touch:
    """What the pressure between the deformed bodies does to them."""
    points = solid.points + u.reshape(-1, 2).T
    own_side, other_side = solid.sides["closure_contact"], solid.sides["seat_contact"]
    N, dN = _shape(_SIDE[0])
    y = np.einsum("ien,qn->ieq", points[:, own_side], N).reshape(2, -1)
    tangent = np.einsum("ien,qn->ieq", points[:, own_side], dN).reshape(2, -1)
    # nearest point of the seat: the side whose ends enclose the foot, then Newton's method along it
    ends = points[:, other_side]
    middle = ends[:, :, 2]
    side = np.argmin(((y[:, :, None] - middle[:, None, :]) ** 2).sum(axis=0), axis=1)
    xi = np.zeros(len(side))
    for _ in range(12):
        M, dM = _shape(xi)
        foot, foot_slope = (
            np.einsum("ikn,kn->ik", ends[:, side], M),
            np.einsum("ikn,kn->ik", ends[:, side], dM),
        )
        change = ((y - foot) * foot_slope).sum(axis=0) / (foot_slope**2).sum(axis=0)
        xi = xi + np.clip(change, -1, 1)
        goes_on, back = (xi > 1) & (side < len(other_side) - 1), (xi < -1) & (side > 0)
        side = side + goes_on - back
        xi = np.where(goes_on, xi - 2, np.where(back, xi + 2, np.clip(xi, -1, 1)))
    M, dM = _shape(xi)
    foot, foot_slope = np.einsum("ikn,kn->ik", ends[:, side], M), np.einsum("ikn,kn->ik", ends[:, side], dM)
    normal = np.stack([-foot_slope[1], foot_slope[0]]) / np.hypot(*foot_slope)
    gap = ((y - foot) * normal).sum(axis=0)
    lowest = -u0 * np.log(cap / p_c)
    p = p_c * np.exp(-np.maximum(gap, lowest) / u0)
    slope = -p / u0
    p = np.where(gap < lowest, p + slope * (gap - lowest), p)
    # area across the normal of the seat
    length = np.abs(tangent[0] * normal[1] - tangent[1] * normal[0]) * np.tile(_SIDE[1], len(own_side))
    area = 2 * np.pi * y[0] * length
    nodes = np.hstack([np.repeat(own_side, 3, axis=0), other_side[side]])  # (k, 6)
    share = np.hstack([np.tile(N, (len(own_side), 1)), -M])
    along_n = (share[:, :, None] * normal.T[:, None, :]).reshape(len(p), 12)  # d gap / d u
    dofs = np.stack([2 * nodes, 2 * nodes + 1], axis=2).reshape(len(p), 12)
    forces = np.zeros(len(u))
    np.add.at(forces, dofs, along_n * (p * area)[:, None])
    K = np.einsum("kd,k,ke->kde", along_n, slope * area, along_n)
    # the normal turns with the seat, the foot slides: what a pressure on a curved face adds
    bend = np.hypot(*foot_slope)
    d2 = np.array([1.0, 1.0, -2.0])
    second = np.einsum("ikn,n->ik", ends[:, side], d2)
    curvature = (second * normal).sum(axis=0) / bend**2  # of the seat, along the normal
    t = foot_slope / bend
    slide = (share[:, :, None] * t.T[:, None, :]).reshape(len(p), 12)
    turn = np.zeros((len(p), 6))
    turn[:, 3:] = dM / bend[:, None]
    rotation = (turn[:, :, None] * normal.T[:, None, :]).reshape(len(p), 12)
    # d2 gap = -(turned x slide + slide x turned) - gap ... ; leading terms, enough for Newton's method
    K -= np.einsum("k,kd,ke->kde", p * area, rotation, slide) + np.einsum(
        "k,kd,ke->kde", p * area, slide, rotation
    )
    K -= np.einsum("k,kd,ke->kde", p * area * curvature, slide, slide)
    size = len(u)
    matrix = coo_matrix(
        (K.ravel(), (np.repeat(dofs, 12, axis=1).ravel(), np.tile(dofs, (1, 12)).ravel())), shape=(size, size)
    )
    step = np.hypot(*np.diff(y, axis=1))
    x = np.concatenate([[0.0], np.cumsum(step)])
    return _Touch(forces, matrix, Profile(x, y[0], p, length))


def solve(
    solid: Solid,
    force: float,
    u0: float,
    p_c: float,
    start: FloatArray,
    history: dict[str, Any],
    peak: float,
    rounds: int = 40,
) -> tuple[FloatArray, dict[str, Any], Profile]:
    """Balance under an axial force on the closure's top (dead load, even over its undeformed area).

    Raises
    ------
    UnsettledError
    """
    top = solid.sides["closure_top"]
    N, dN = _shape(_SIDE[0])
    X = solid.points[:, top]
    r, dr = np.einsum("en,qn->eq", X[0], N), np.einsum("en,qn->eq", X[0], dN)
    weight = 2 * np.pi * r * np.abs(dr) * _SIDE[1]
    outer = np.zeros(len(start))
    np.add.at(outer, 2 * top + 1, -np.einsum("eq,qn->en", weight, N))
    outer *= force / weight.sum()
    u, free = start.copy(), solid.free
    worst = np.inf
    for _ in range(rounds):
        inner, K, new = solid.inner(u, history)
        contact = touch(solid, u, u0, p_c, _CAP * peak)
        residual = (outer + contact.forces - inner)[free]
        worst = float(np.abs(residual).sum() / force)
        if not np.isfinite(worst):
            break
        if worst < 1e-6:
            return u, new, contact.profile
        matrix = (K - contact.stiffness).tocsc()[free][:, free]
        step = np.zeros(len(u))
        step[free] = spsolve(matrix, residual)

        def residual(trial: FloatArray) -> float:
            try:
                inner_forces = solid.inner(trial, history, tangent=False)[0]
            except UnsettledError:
                return np.inf
            contact_forces = touch(solid, trial, u0, p_c, _CAP * peak).forces
            return float(np.abs((outer + contact_forces - inner_forces)[free]).sum() / force)

        trials = [_advance(solid, u, step, u0, p_c, _CAP * peak)]
        for _ in range(6):
            if residual(trials[-1]) < worst:
                break
            trials.append(u + 0.4 * (trials[-1] - u))
        u = min(trials, key=residual)
    raise UnsettledError(f"residual {worst:.2g} of the force after {rounds} rounds")


def _advance(solid: Solid, u: FloatArray, step: FloatArray, u0: float, p_c: float, cap: float) -> FloatArray:
    """As much of a step as contact and elements can follow."""
    old = touch(solid, u, u0, p_c, cap).profile.pressure
    share = 1.0
    for _ in range(12):
        new = touch(solid, u + share * step, u0, p_c, cap).profile.pressure
        is_loaded = np.maximum(old, new) > 1e-2 * cap / _CAP
        change = np.abs(np.log(np.maximum(new, 1e-9 * cap) / np.maximum(old, 1e-9 * cap)))[is_loaded]
        if change.max(initial=0.0) < _FARTHEST and solid.sound(u + share * step):
            break
        share /= 2
    return u + share * step
