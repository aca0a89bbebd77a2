"""Compliance of a body under a contact load that waves around the axis: Fourier finite elements.

On the triangles of the axisymmetric model the displacement is (u_r cos n phi, u_z cos n phi, u_phi sin n phi) with n
waves per turn. The integral over phi is done by hand, the stiffness is K0 + n K1 + n^2 K2, and each n is a problem of
its own in the half-plane. The derivation is in docs/theory/form.md.

Forces and stiffness are per full turn, int 2 pi r dr dz, as if the wave were its own mean: cos^2 and sin^2 give half of
that on both sides of the equation. So the amplitude of a waving displacement stands to the amplitude of a waving load
as the displacement of the axisymmetric model stands to its load.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from fem_seal.arrays import FloatArray, IntArray
from fem_seal.bodies import elasticity
from fem_seal.bodies.constrained_body import ConstrainedBody, trace_matrix
from fem_seal.bodies.dissected_body import Dissection, places_of_elements
from fem_seal.materials import Material
from fem_seal.processes import single_threaded

if TYPE_CHECKING:
    from skfem import MeshTri

# Size of the cache of compliances [bytes]: enough for all harmonics, unless the contact line is very fine.
_CACHE_SIZE = 100e6


def harmonic_dofs(mesh: MeshTri) -> IntArray:
    """Dof of u_r, u_z and u_phi of every quadratic node, shape (3, nodes); u_r and u_z are `node_dofs`."""
    in_plane = elasticity.node_dofs(mesh)
    return np.vstack([in_plane, in_plane.size + np.arange(in_plane.shape[1])])


def harmonic_strains(mesh: MeshTri) -> tuple[FloatArray, FloatArray]:
    """B0 and B1 of the strains (B0 + n B1) u [1/m]; both of shape (elements, points, 6, shapes).

    The strains are (rr, zz, pp, rz, rp, zp), shear as g = 2 e, the last two times sin n phi, the others times
    cos n phi: e_pp = (u_r + n u_phi)/r, g_rp = u_phi,r - (u_phi + n u_r)/r, g_zp = u_phi,z - n u_z/r; the others as
    with axial symmetry. The shapes are those of `strain_matrix`, then six of u_phi. No integration point lies on the
    axis.
    """
    points, in_plane = elasticity.quadrature()[0], elasticity.strain_matrix(mesh)
    along_r, along_z = np.moveaxis(elasticity.shape_gradients(mesh, points), -1, 0)
    over_r = elasticity.shape_functions(points)[0] / elasticity.quadrature_radius(mesh)[..., None]
    constant, linear = np.zeros((2, *over_r.shape[:2], 6, 18))
    constant[..., :4, :12] = in_plane
    constant[..., 4, 12:], constant[..., 5, 12:] = along_r - over_r, along_z
    linear[..., 2, 12:] = over_r
    linear[..., 4, :12:2] = linear[..., 5, 1:12:2] = -over_r
    return constant, linear


def harmonic_stiffness(mesh: MeshTri, material: Material) -> tuple[FloatArray, FloatArray, FloatArray]:
    """K0, K1, K2 of each element's stiffness K0 + n K1 + n^2 K2 [N/m], over `harmonic_element_dofs`.

    int 2 pi r sigma : epsilon dr dz of the amplitudes; each of shape (elements, shapes, shapes).
    """
    D = np.zeros((6, 6))
    D[:4, :4] = elasticity.elasticity_matrix(material)
    D[4, 4] = D[5, 5] = D[3, 3]
    constant, linear = harmonic_strains(mesh)

    def element(left: FloatArray, right: FloatArray) -> FloatArray:
        return elasticity.contract(left, elasticity.ring_volume(mesh)[..., None, None] * (D @ right))

    cross = element(constant, linear)
    return element(constant, constant), cross + cross.transpose(0, 2, 1), element(linear, linear)


def harmonic_element_dofs(mesh: MeshTri) -> IntArray:
    """Dofs of the shapes of each element, as `harmonic_strains` has them; shape (elements, shapes)."""
    return np.hstack(
        [elasticity.element_dofs(mesh), elasticity.node_dofs(mesh).size + elasticity.quadratic_nodes(mesh)[1]]
    )


@dataclass(frozen=True)
class HarmonicBody:
    """One elastic body under normal loads on its contact line that wave around the axis.

    Parameters
    ----------
    fem : ConstrainedBody
        The body with its contact line and supports.

    Notes
    -----
    From two waves on a load has neither a resultant force nor a moment. The seat is then held as in the axisymmetric
    model, on its bottom along the axis and, if so, radially on its wall, free to slide around the axis on both. The
    closing load on the closure's top stays even and the closure is free.

    One wave pushes a body aside and tilts it. A closure that is free to move follows until there is no such load; the
    first harmonic is therefore that of a guided closure, with its top and the bottom of the seat fully held: the
    guide is infinitely stiff.
    """

    fem: ConstrainedBody
    _compliances: dict[int, FloatArray] = field(default_factory=dict, init=False, repr=False, compare=False)
    _pushes: dict[tuple[int, float], FloatArray] = field(
        default_factory=dict, init=False, repr=False, compare=False
    )

    @cached_property
    def stiffness(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """K0, K1 and K2 of each element [N/m], see `harmonic_stiffness`."""
        return harmonic_stiffness(self.fem.mesh, self.fem.material)

    def compliance(self, n: int) -> FloatArray:
        """Retreat of the contact nodes along the normal under normal forces at them that wave n times [m/N].

        Parameters
        ----------
        n : int
            Waves per turn, 1 or more; 1 means a guided closure.

        Returns
        -------
        ndarray, shape (nodes, nodes)
            Amplitude over amplitude, forces per full turn as in
            `fem_seal.bodies.constrained_body.CondensedBody.compliance`. Kept, and shared: not to be changed.

        Raises
        ------
        ValueError
            If n is not a whole number from 1 on.
        """
        if n < 1 or n != int(n):
            raise ValueError(f"{n} waves around the axis: a whole number from 1 on is needed")
        if n not in self._compliances:
            compliance = self._factorise(int(n))
            while self._compliances and (len(self._compliances) + 1) * compliance.nbytes > _CACHE_SIZE:
                self._compliances.pop(next(iter(self._compliances)))
            self._compliances[n] = compliance
        return self._compliances[n]

    def opening(self, n: int, point_forces: FloatArray) -> FloatArray:
        """How far the surface moves away from the other body at phi = 0 under forces times cos n phi [m], shape (m,).

        Parameters
        ----------
        n : int
            Waves per turn, 1 or more; 1 means a guided closure.
        point_forces : ndarray, shape (m,)
            Amplitude of the normal force at the points of the contact line, times the length of their circle [N]:
            2 pi r facing dx p, as `ConstrainedBody.nodal_forces` takes them.

        Raises
        ------
        ValueError
            If n is not a whole number from 1 on.
        """
        trace = self.fem.trace
        return np.asarray(trace @ (self.compliance(n) @ (trace.T @ point_forces)))

    def push(self, n: int, radius: float) -> FloatArray:
        """How far a force on the closure's top that waves n times pushes its surface out at phi = 0 [m/N], shape (m,).

        Parameters
        ----------
        n : int
            Waves per turn, 2 or more.
        radius : float
            Of the circle on the top where the force acts downwards, 1 N cos n phi per full turn [m].

        Returns
        -------
        ndarray, shape (m,)
            At the points of the contact line, towards the other body.

        Raises
        ------
        ValueError
            If n is not a whole number from 2 on.
        """
        if n < 2 or n != int(n):
            raise ValueError(f"{n} waves around the axis: a whole number from 2 on is needed")
        if (n, radius) not in self._pushes:
            self._pushes[n, radius] = self._pushed(int(n), radius)
        return np.asarray(self.fem.trace @ self._pushes[n, radius])

    def stiffer(self, factor: float) -> HarmonicBody:
        """The same body with another Young's modulus, whose compliances follow from those of this one.

        Parameters
        ----------
        factor : float
            Ratio of the moduli.
        """
        return _StifferBody(self.fem, self, factor)

    @single_threaded
    def _factorise(self, n: int) -> FloatArray:
        return (_Supports.of(self, guided=True) if n == 1 else self._other_supports).compliance(n, self)

    @single_threaded
    def _pushed(self, n: int, radius: float) -> FloatArray:
        """`push` at the contact nodes."""
        fem = self.fem
        nodes, trace, _ = trace_matrix(fem.mesh, "closure_top", lambda r, z: r, np.array([radius]))
        force = np.zeros(harmonic_dofs(fem.mesh).size)
        force[elasticity.node_dofs(fem.mesh)[1][nodes]] = -trace.toarray()[0]
        moved = self._other_supports.displacement(n, self, force)
        return -np.sum(fem.normal * moved[fem.contact_dofs], axis=0)

    @cached_property
    def _other_supports(self) -> _Supports:
        return _Supports.of(self, guided=False)


@dataclass(frozen=True)
class _StifferBody(HarmonicBody):
    """A body whose compliances are those of another one over a factor."""

    other: HarmonicBody
    factor: float

    def compliance(self, n: int) -> FloatArray:
        return self.other.compliance(n) / self.factor

    def push(self, n: int, radius: float) -> FloatArray:
        return self.other.push(n, radius) / self.factor


@dataclass(frozen=True)
class _Supports:
    """A body with the supports of the first harmonic, or of all others.

    Parameters
    ----------
    dissection : Dissection
        Its elements in parts, the motion of the contact nodes last.
    sign : ndarray, shape (elements, shapes)
        -1 where a dof is minus that whose unknown it shares.
    places : ndarray of int
        Which of the contact dofs can move; `ConstrainedBody.contact_dofs`, one after the other.
    free : ndarray of int
        Dofs that are not held; their unknowns are numbered in this order.
    """

    dissection: Dissection
    sign: FloatArray
    places: IntArray
    free: IntArray

    @classmethod
    def of(cls, body: HarmonicBody, guided: bool) -> _Supports:
        """With the supports of the first harmonic, or of all others."""
        fem, dofs = body.fem, harmonic_dofs(body.fem.mesh)
        radius = fem.nodes[0][:, 0]
        radial, axial, circumferential = dofs[:, radius <= elasticity.AXIS * radius.max()]
        sign = np.ones(dofs.size)
        fixed_dofs = [axial, circumferential]
        held = np.setdiff1d(np.arange(fem.size), fem.free)
        if fem.name == "seat":
            fixed_dofs.append(held)
        if guided:
            stand = "closure_top" if fem.name == "closure" else "seat_bottom"
            on_stand = np.isin(dofs[0], elasticity.boundary_dofs(fem.mesh, stand, 0))
            fixed_dofs.append(dofs[:, on_stand].ravel())
        else:
            # of the closure it is the axis and, where it is held, the top; the axial dof that is only held for the
            # even load is free
            fixed_dofs += [radial, np.intersect1d(held, dofs[0])]
        free = np.setdiff1d(np.arange(dofs.size), np.concatenate(fixed_dofs))
        number = np.full(dofs.size, -1)
        number[free] = np.arange(len(free))
        if guided:
            # On the axis u_phi = -u_r: a shift along x is u_r = cos phi, u_phi = -sin phi.
            number[circumferential], sign[circumferential] = number[radial], -1.0
        on_line, shapes = number[fem.contact_dofs].ravel(), harmonic_element_dofs(fem.mesh)
        places = np.flatnonzero(on_line >= 0)
        parts = Dissection.of(
            number[shapes],
            places_of_elements(fem),
            on_line[places],
            len(free),
            body.stiffness[0],
            fem.mesh.t.T,  # halves that share few vertices share few nodes
        )
        return cls(parts, sign[shapes], places, free)

    # the body is an argument, not a field, since it keeps this object
    def compliance(self, n: int, body: HarmonicBody) -> FloatArray:
        """Retreat of the contact nodes along the normal under normal forces at them [m/N], shape (nodes, nodes)."""
        inverse, _ = self._condense(n, body)
        normal = body.fem.normal
        nodal = np.zeros((normal.size, normal.size))
        nodal[np.ix_(self.places, self.places)] = inverse
        projected = normal.ravel()[:, None] * nodal * normal.ravel()
        return projected.reshape(*normal.shape, *normal.shape).sum(axis=(0, 2))

    def displacement(self, n: int, body: HarmonicBody, force: FloatArray) -> FloatArray:
        """Displacement (dofs,) [m] under nodal forces (dofs,) [N], of two waves or more."""
        _, solve = self._condense(n, body)
        moved = np.zeros_like(force)
        moved[self.free] = solve(force[self.free])
        return moved

    def _condense(self, n: int, body: HarmonicBody) -> tuple[FloatArray, Callable[[FloatArray], FloatArray]]:
        """Between the contact dofs, and from any forces to displacements."""
        (k0, k1, k2), sign = body.stiffness, self.sign
        stiffness = sign[:, :, None] * (k0 + n * k1 + n**2 * k2) * sign[:, None, :]
        return replace(self.dissection, elastic=stiffness).condense_elastic()
