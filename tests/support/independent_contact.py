"""A small program of its own for two bodies in contact, to check the product against: nothing of it is used here.

Axisymmetric nine-node quadrilaterals on polar grids (exact geometry through the mapping of every quadrature point),
an exponential interface law integrated over the seat's face, and Newton's method with a line search on the convex
energy of both whole bodies.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import bmat, coo_matrix, csr_matrix
from scipy.sparse.linalg import splu

FloatArray = NDArray[np.float64]

GAUSS, WEIGHT = np.polynomial.legendre.leggauss(4)


@dataclass(frozen=True)
class Sector:
    """Part of a ring in section: centre (r, z), inner and outer radius, angles from the downward direction."""

    centre: tuple[float, float]
    radii: tuple[float, float]
    angles: tuple[float, float]


def shapes(t: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Quadratic functions on [-1, 1] with nodes -1, 0, 1, and their slopes; shape (3, n)."""
    return (
        np.stack([t * (t - 1) / 2, 1 - t**2, t * (t + 1) / 2]),
        np.stack([t - 0.5, -2 * t, t + 0.5]),
    )


def _of_elements() -> tuple[FloatArray, FloatArray, FloatArray]:
    """The nine functions at the sixteen points, and their slopes along both sides of [-1, 1]^2; shape (16, 9)."""
    N, slope = shapes(GAUSS)
    pairs = ((N, N), (slope, N), (N, slope))
    area_shapes, two, three = (np.einsum("as,bt->stab", f, g).reshape(GAUSS.size**2, 9) for f, g in pairs)
    return area_shapes, two, three


SHAPES = _of_elements()


class Body:
    """Stiffness of a sector on a grid that is fine where asked for."""

    def __init__(self, sector: Sector, radial: FloatArray, angular: FloatArray, E: float, nu: float) -> None:
        self.sector, self.radial, self.angular = sector, radial, angular
        self.rows, self.columns = 2 * len(angular) - 1, 2 * len(radial) - 1
        lame, mu = E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))
        D = np.diag([2 * mu, 2 * mu, 2 * mu, mu]).astype(float)
        D[:3, :3] += lame
        rows, columns, values = [], [], []
        for i in range(len(angular) - 1):
            for j in range(len(radial) - 1):
                dofs = self.element(i, j)
                K = self._stiffness(i, j, D)
                rows.append(np.repeat(dofs, 18))
                columns.append(np.tile(dofs, 18))
                values.append(K.ravel())
        size = 2 * self.rows * self.columns
        self.K = coo_matrix(
            (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape=(size, size)
        ).tocsr()

    def node(self, i: int, j: int) -> int:
        """Number of a node by its place along the angle and along the radius, both counted in half elements."""
        return i * self.columns + j

    def element(self, i: int, j: int) -> NDArray[np.int64]:
        """Dofs of an element: (r, z) of its nodes, the angle running slower."""
        nodes = [self.node(2 * i + a, 2 * j + b) for a in range(3) for b in range(3)]
        return np.array([2 * n + c for n in nodes for c in range(2)])

    def _stiffness(self, i: int, j: int, D: FloatArray) -> FloatArray:
        half_angle = 0.5 * (self.angular[i + 1] - self.angular[i])
        half_radius = 0.5 * (self.radial[j + 1] - self.radial[j])
        # all quadrature points at once, in order of the angle, then of the radius; functions in order of the nodes
        angle = np.repeat(self.angular[i] + half_angle * (1 + GAUSS), GAUSS.size)[:, None]
        rho = np.tile(self.radial[j] + half_radius * (1 + GAUSS), GAUSS.size)[:, None]
        r = self.sector.centre[0] + rho * np.sin(angle)
        N, d_along, d_outwards = SHAPES[0], SHAPES[1] / (half_angle * rho), SHAPES[2] / half_radius
        # Unit vectors outwards (sin, -cos) and along the angle (cos, sin).
        dr = d_outwards * np.sin(angle) + d_along * np.cos(angle)
        dz = -d_outwards * np.cos(angle) + d_along * np.sin(angle)
        B = np.zeros((len(N), 4, 18))
        B[:, 0, 0::2], B[:, 1, 1::2], B[:, 2, 0::2] = dr, dz, N / r
        B[:, 3, 0::2], B[:, 3, 1::2] = dz, dr
        weight = np.outer(WEIGHT, WEIGHT).reshape(-1, 1) * half_angle * half_radius * rho * 2 * math.pi * r
        return (B.transpose(0, 2, 1) @ (D @ B) * weight[:, None]).sum(axis=0)

    def surface(self, column: int, count: int = 4) -> tuple[FloatArray, FloatArray, csr_matrix, csr_matrix]:
        """Angles and weights (d angle) of points on an arc, and matrices from dofs to u_r and u_z there."""
        t, w = np.polynomial.legendre.leggauss(count)
        N, _ = shapes(t)
        angles, weights, rows, nodes, values = [], [], [], [], []
        for i in range(len(self.angular) - 1):
            half = 0.5 * (self.angular[i + 1] - self.angular[i])
            for k in range(count):
                for a in range(3):
                    rows.append(len(angles))
                    nodes.append(self.node(2 * i + a, column))
                    values.append(N[a, k])
                angles.append(self.angular[i] + half * (1 + t[k]))
                weights.append(w[k] * half)
        shape = (len(angles), self.K.shape[0])
        return (
            np.array(angles),
            np.array(weights),
            csr_matrix((values, (rows, 2 * np.array(nodes))), shape=shape),
            csr_matrix((values, (rows, 2 * np.array(nodes) + 1)), shape=shape),
        )


def press(
    closure: Sector, seat: Sector, E: float, nu: float, p_c: float, u0: float, force: float, touch: float
) -> tuple[FloatArray, FloatArray]:
    """Press a hollow ball on a shell.

    The ball is pushed by an even pressure above 120 degrees; the shell is held along the axis on its outer arc, as the
    product's bodies are. Returned are the arc length from first touch at the angle `touch` [m] and the pressure [Pa].
    """
    step, (low, high) = 0.5 * math.pi / 180, seat.angles
    seat_angles = np.linspace(low, high, round((high - low) / step) + 1)
    ball_angles = np.concatenate(
        [
            np.linspace(0.0, low, 8)[:-1],
            seat_angles[:-1],
            np.linspace(high, 2 * math.pi / 3, 12)[:-1],
            np.linspace(2 * math.pi / 3, math.pi, 9),
        ]
    )
    depth = np.cumsum(np.concatenate([[0.0], np.geomspace(1.0, 8.0, 10)])) / np.geomspace(1.0, 8.0, 10).sum()
    inner, outer = closure.radii
    ball = Body(closure, (outer - (outer - inner) * depth)[::-1], ball_angles, E, nu)
    shell = Body(seat, seat.radii[0] + (seat.radii[1] - seat.radii[0]) * depth, seat_angles, E, nu)

    # The product's gap: along the seat's normal to the ball, whose centre lies (R_s - R)(sin, cos)(touch) off.
    phi, weight, ur, uz = shell.surface(0)
    radius = seat.centre[0] + seat.radii[0] * np.sin(phi)
    gap = seat.radii[0] - outer
    turn = phi - touch
    gap0 = seat.radii[0] - gap * np.cos(turn) - np.sqrt(outer**2 - (gap * np.sin(turn)) ** 2)
    on_ball = touch + np.arcsin(np.clip((seat.radii[0] - gap0) * np.sin(turn) / outer, -1, 1))
    vr, vz = on_arc(ball, on_ball)
    # Towards the closure: inwards and up.
    n_r, n_z = -np.sin(phi), np.cos(phi)
    opening = bmat([[scaled(n_r, vr) + scaled(n_z, vz), -scaled(n_r, ur) - scaled(n_z, uz)]]).tocsr()
    area = 2 * math.pi * radius * seat.radii[0] * weight

    top, top_weight, tr, tz = ball.surface(ball.columns - 1)
    weights = np.where(top > 2 * math.pi / 3, 2 * math.pi * outer * np.sin(top) * outer * top_weight, 0.0)
    # An even pressure pushes against the outward normal (sin, -cos).
    push = tr.T @ (-np.sin(top) * weights) + tz.T @ (np.cos(top) * weights)
    push *= -force / float(np.abs((np.cos(top) * weights).sum())) * np.sign((np.cos(top) * weights).sum())

    K = bmat([[ball.K, None], [None, shell.K]]).tocsr()
    load = np.concatenate([push, np.zeros(shell.K.shape[0])])
    axis = [2 * ball.node(i, j) for i in (0, ball.rows - 1) for j in range(ball.columns)]
    rim = [ball.K.shape[0] + 2 * shell.node(i, shell.columns - 1) + 1 for i in range(shell.rows)]
    free = np.setdiff1d(np.arange(K.shape[0]), [*axis, *rim])
    K, G, load = K[free][:, free], opening[:, free], load[free]

    # Rigid ball first: down until the law carries the load.
    u = np.zeros(len(free))
    axial = np.concatenate([np.tile([0.0, 1.0], ball.K.shape[0] // 2), np.zeros(shell.K.shape[0])])[free]
    way = u0 * math.log(float((area * p_c * np.exp(-gap0 / u0) * n_z).sum()) / force)
    u += axial * way

    def energy(u: FloatArray) -> float:
        with np.errstate(over="ignore"):
            return float(
                0.5 * u @ (K @ u) - load @ u + (area * p_c * u0 * np.exp(-(gap0 + G @ u) / u0)).sum()
            )

    for _ in range(200):
        p = p_c * np.exp(-(gap0 + G @ u) / u0)
        residual = K @ u - load - G.T @ (area * p)
        stiffness = (K + G.T @ scaled(area * p / u0, G)).tocsc()
        du = splu(stiffness, permc_spec="MMD_AT_PLUS_A").solve(-residual)
        slope, old_energy, length = float(residual @ du), energy(u), 1.0
        if -slope < 1e-12 * abs(old_energy):
            break
        while energy(u + length * du) > old_energy + 1e-4 * length * slope:
            length *= 0.5
        u += length * du
    return seat.radii[0] * turn, p_c * np.exp(-(gap0 + G @ u) / u0)


def scaled(factors: FloatArray, matrix: csr_matrix) -> csr_matrix:
    """Rows of a matrix times factors."""
    return csr_matrix(matrix.multiply(factors[:, None]))


def on_arc(body: Body, angles: FloatArray) -> tuple[csr_matrix, csr_matrix]:
    """Matrices from dofs to u_r and u_z at angles of the outer arc."""
    i = np.clip(np.searchsorted(body.angular, angles) - 1, 0, len(body.angular) - 2)
    t = 2 * (angles - body.angular[i]) / (body.angular[i + 1] - body.angular[i]) - 1
    N, _ = shapes(t)
    rows = np.tile(np.arange(len(angles)), 3)
    nodes = np.concatenate([(2 * i + a) * body.columns + body.columns - 1 for a in range(3)])
    shape = (len(angles), body.K.shape[0])
    return (
        csr_matrix((N.ravel(), (rows, 2 * nodes)), shape=shape),
        csr_matrix((N.ravel(), (rows, 2 * nodes + 1)), shape=shape),
    )
