"""Loads that wave around the axis: patch tests, rates of convergence, closed solutions, the half-space."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
import pytest
from contact_models import STEEL, ball_on_cone, displacement_basis
from factorised_whole import contact_compliance
from scipy.sparse import csr_matrix, identity
from scipy.sparse.linalg import splu
from scipy.special import iv, kve
from skfem import Basis, ElementTriP2, ElementVector, MeshTri

from fem_seal.bodies import elasticity, harmonics
from fem_seal.bodies.constrained_body import CondensedBody
from fem_seal.bodies.elasticity import node_dofs, quadratic_nodes, ring_volume
from fem_seal.bodies.harmonics import (
    HarmonicBody,
    harmonic_dofs,
    harmonic_element_dofs,
    harmonic_stiffness,
    harmonic_strains,
)
from fem_seal.bodies.supports import Supports
from fem_seal.contact.model import ContactModel, condense
from leak import ExponentialLaw
from meshes import Ball, ConicalSeat, Sizing, SphericalSeat, build

E, NU = STEEL.youngs_modulus, STEEL.poissons_ratio
MU = E / (2 * (1 + NU))
INNER, OUTER, HEIGHT = 0.01, 0.02, 0.005
LAW = ExponentialLaw(p_c=5e9, u0=0.76e-6)

Amplitudes = Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray, np.ndarray]]


def rectangle(r: tuple[float, float], z: tuple[float, float], cells: tuple[int, int]) -> MeshTri:
    """Section of a ring, elements deliberately unequal, with its sides named."""
    along = [np.linspace(0, 1, n + 1) for n in cells]
    along = [t + 0.1 * t * (1 - t) for t in along]
    mesh = MeshTri.init_tensor(r[0] + (r[1] - r[0]) * along[0], z[0] + (z[1] - z[0]) * along[1])
    return mesh.with_boundaries(
        {
            "inner": lambda x: np.isclose(x[0], r[0]),
            "outer": lambda x: np.isclose(x[0], r[1]),
            "bottom": lambda x: np.isclose(x[1], z[0]),
            "top": lambda x: np.isclose(x[1], z[1]),
        }
    )


def ring(inner: float = INNER, cells: int = 4) -> MeshTri:
    return rectangle((inner, OUTER), (0.0, HEIGHT), (cells, cells))


def assembled(basis: Basis) -> tuple[csr_matrix, ...]:
    """K0, K1 and K2 of all elements together; nothing is held."""
    dofs, size = harmonic_element_dofs(basis.mesh), harmonic_dofs(basis.mesh).size
    rows, columns = (index.ravel() for index in np.broadcast_arrays(dofs[:, :, None], dofs[:, None, :]))
    return tuple(
        csr_matrix((part.ravel(), (rows, columns)), shape=(size, size))
        for part in harmonic_stiffness(basis.mesh, STEEL)
    )


def stiffness(basis: Basis, n: int) -> csr_matrix:
    k0, k1, k2 = assembled(basis)
    return (k0 + n * k1 + n**2 * k2).tocsr()


def nodal(basis: Basis, amplitudes: Amplitudes) -> np.ndarray:
    u = np.zeros(harmonic_dofs(basis.mesh).size)
    u[harmonic_dofs(basis.mesh)] = amplitudes(*quadratic_nodes(basis.mesh)[0].T)
    return u


def traction(basis: Basis, boundary: str, amplitudes: Amplitudes) -> np.ndarray:
    """Nodal forces of a surface traction [Pa], int 2 pi r t N ds; four Gauss points, exact up to t of fourth degree."""
    mesh, forces = basis.mesh, np.zeros(harmonic_dofs(basis.mesh).size)
    points, weights = np.polynomial.legendre.leggauss(4)
    t, weights = 0.5 * (points + 1), 0.5 * weights
    shapes = np.stack([(1 - t) * (1 - 2 * t), t * (2 * t - 1), 4 * t * (1 - t)])
    for facet in mesh.boundaries[boundary]:
        a, b = mesh.p[:, mesh.facets[:, facet]].T
        r, z = a[:, None] + (b - a)[:, None] * t
        nodes = [*mesh.facets[:, facet], mesh.nvertices + facet]
        measure = 2 * np.pi * r * weights * np.linalg.norm(b - a)
        for dofs, component in zip(harmonic_dofs(basis.mesh), amplitudes(r, z), strict=True):
            forces[dofs[nodes]] += shapes @ (measure * component)
    return forces


def moving(basis: Basis, n: int, held: np.ndarray | None = None) -> csr_matrix:
    """From what can move to all dofs: u = 0 where held, and finite strain on the axis."""
    dofs = harmonic_dofs(basis.mesh)
    radial, axial, around = dofs[:, quadratic_nodes(basis.mesh)[0][:, 0] == 0]
    ties = identity(dofs.size, format="lil")
    fixed = np.concatenate([axial if n else radial, around, np.zeros(0, int) if held is None else held])
    if n == 1:
        ties[around, radial] = -1.0
    elif n > 1:
        fixed = np.append(fixed, radial)
    return ties.tocsc()[:, np.setdiff1d(np.arange(dofs.size), fixed)]


@pytest.mark.parametrize("inner", [0.0, INNER])
def test_each_part_is_symmetric_and_turning_the_sense_of_rotation_changes_nothing(inner: float) -> None:
    """phi to -phi is u_phi to -u_phi and n to -n: K1 couples u_phi with the plane, K0 and K2 do not. Rounding 1e-14."""
    basis = displacement_basis(ring(inner))
    around = np.arange(basis.N, harmonic_dofs(basis.mesh).size)
    for number, part in enumerate(assembled(basis)):
        assert abs(part - part.T).max() <= 1e-14 * abs(part).max()
        across, own = part[around][:, : basis.N], part[around][:, around]
        assert abs(own if number == 1 else across).max() == 0
        assert abs(across if number == 1 else own).max() > 0


RIGID = {
    "along the axis": (0, lambda r, z: (0 * r, 0 * r + 1, 0 * r)),
    "around the axis": (0, lambda r, z: (0 * r, 0 * r, r / OUTER)),
    "aside": (1, lambda r, z: (0 * r + 1, 0 * r, 0 * r - 1)),
    "tilt": (1, lambda r, z: (z / OUTER, -r / OUTER, -z / OUTER)),
}


@pytest.mark.parametrize("inner", [0.0, INNER])
@pytest.mark.parametrize("motion", RIGID)
def test_rigid_motions_need_no_force(motion: str, inner: float) -> None:
    """Linear, hence exactly representable, so that only rounding is left: 1e-12."""
    n, amplitudes = RIGID[motion]
    basis = displacement_basis(ring(inner))
    K, free = stiffness(basis, n), moving(basis, n)
    assert np.abs(free.T @ K @ nodal(basis, amplitudes)).max() < 1e-12 * abs(free.T @ K @ free).max()


@pytest.mark.parametrize(("n", "rigid"), [(0, 2), (1, 2), (2, 0), (3, 0)])
def test_nothing_but_rigid_motions_is_free_of_energy(n: int, rigid: int) -> None:
    eigenvalues = np.linalg.eigvalsh(stiffness(displacement_basis(ring()), n).toarray())
    assert np.sum(eigenvalues < 1e-10 * eigenvalues[-1]) == rigid


PATCHES = {
    # u_x = x, u_y = -y
    "two waves": (
        2,
        lambda r, z: (r, 0 * r, -r),
        {"outer": (2 * MU, 0, -2 * MU), "inner": (-2 * MU, 0, 2 * MU)},
    ),
    # u_x = z: shear
    "one wave": (
        1,
        lambda r, z: (z, 0 * r, -z),
        {"outer": (0, MU, 0), "inner": (0, -MU, 0), "top": (MU, 0, -MU), "bottom": (-MU, 0, MU)},
    ),
    # u_z = x: the same strain, another rotation
    "one wave, axial": (
        1,
        lambda r, z: (0 * r, r, 0 * r),
        {"outer": (0, MU, 0), "inner": (0, -MU, 0), "top": (MU, 0, -MU), "bottom": (-MU, 0, MU)},
    ),
}


@pytest.mark.parametrize("inner", [0.0, INNER])
@pytest.mark.parametrize("patch", PATCHES)
def test_constant_strain_needs_the_tractions_of_constant_stress(patch: str, inner: float) -> None:
    """Constant in x, y, z and exactly representable; 1e-11: rounding of large terms that cancel."""
    n, amplitudes, tractions = PATCHES[patch]
    basis = displacement_basis(ring(inner))
    exact = sum(
        traction(basis, side, lambda r, z, t=t: tuple(0 * r + c for c in t)) for side, t in tractions.items()
    )
    free = moving(basis, n)
    force = free.T @ (stiffness(basis, n) @ nodal(basis, amplitudes))
    assert force == pytest.approx(free.T @ exact, abs=1e-11 * np.abs(exact).max())


@pytest.mark.parametrize("inner", [0.0, INNER])
def test_torsion_without_waves_needs_its_shear_stress(inner: float) -> None:
    """u_phi = r z: g_zp = r. Exactly representable."""
    basis = displacement_basis(ring(inner))
    exact = sum(
        traction(basis, side, lambda r, z, sign=sign: (0 * r, 0 * r, sign * MU * r))
        for side, sign in (("top", 1), ("bottom", -1))
    )
    free = moving(basis, 0)
    force = free.T @ (stiffness(basis, 0) @ nodal(basis, lambda r, z: (0 * r, 0 * r, r * z)))
    assert force == pytest.approx(free.T @ exact, abs=1e-11 * np.abs(exact).max())


def papkovich(n: int) -> Amplitudes:
    """(3 - 4 nu) psi e_z - z grad psi, psi = I_n(k r) cos n phi cos k z: in equilibrium without body forces."""
    k = 2.0 / OUTER

    def amplitudes(r: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        slope = 0.5 * k * (iv(n - 1, k * r) + iv(n + 1, k * r))
        # I_n/r by recurrence: n I_n(x)/x = (I_(n-1) - I_(n+1))/2
        over_r = 0.5 * k * (iv(n - 1, k * r) - iv(n + 1, k * r))
        psi = iv(n, k * r)
        return (
            -z * slope * np.cos(k * z),
            (3 - 4 * NU) * psi * np.cos(k * z) + z * k * psi * np.sin(k * z),
            z * over_r * np.cos(k * z),
        )

    return amplitudes


def exact_strains(n: int, amplitudes: Amplitudes, r: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Derivatives by a complex step, exact to rounding."""
    h = 1e-30
    u_r, u_z, u_p = amplitudes(r, z)
    by_r = [c.imag / h for c in amplitudes(r + 1j * h, z + 0j)]
    by_z = [c.imag / h for c in amplitudes(r + 0j, z + 1j * h)]
    around = by_r[2] - (u_p + n * u_r) / r
    return np.stack(
        [by_r[0], by_z[1], (u_r + n * u_p) / r, by_z[0] + by_r[1], around, by_z[2] - n * u_z / r], axis=-1
    )


def energy_error(n: int, inner: float, cells: int) -> float:
    """Energy norm of the error over that of the solution, displacement given on the surface."""
    mesh, amplitudes = ring(inner, cells), papkovich(n)
    basis = displacement_basis(mesh)
    u = nodal(basis, amplitudes)
    surface = [side for side in mesh.boundaries if inner or side != "inner"]
    on_surface = np.isin(node_dofs(basis.mesh)[0], basis.get_dofs(surface).all(["u^1"]))
    u[harmonic_dofs(basis.mesh)[:, ~on_surface]] = 0.0
    free = moving(basis, n, harmonic_dofs(basis.mesh)[:, on_surface].ravel())
    K = stiffness(basis, n)
    u += free @ splu((free.T @ K @ free).tocsc()).solve(-(free.T @ (K @ u)))
    fine = Basis(mesh, ElementVector(ElementTriP2()), intorder=8)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(elasticity, "quadrature", lambda: (fine.X, fine.W))
        (constant, linear), volume = harmonic_strains(mesh), ring_volume(mesh)
    shapes = np.vstack([fine.element_dofs, fine.N + quadratic_nodes(mesh)[1].T]).T
    strain = np.einsum("eqis,es->eqi", constant + n * linear, u[shapes])
    exact = exact_strains(n, amplitudes, *np.asarray(fine.global_coordinates()))
    lam = E * NU / ((1 + NU) * (1 - 2 * NU))

    def energy(e: np.ndarray) -> float:
        dilatation, shear = e[..., :3].sum(-1), (e[..., 3:] ** 2).sum(-1)
        density = MU * (2 * (e[..., :3] ** 2).sum(-1) + shear) + lam * dilatation**2
        return float((volume * density).sum())

    return math.sqrt(energy(strain - exact) / energy(exact))


@pytest.mark.parametrize("inner", [0.0, INNER], ids=["solid", "ring"])
@pytest.mark.parametrize("n", [1, 2, 3, 5])
def test_error_of_a_smooth_field_falls_with_the_square_of_the_element_size(n: int, inner: float) -> None:
    """Quadratic elements: rate 2 in the energy norm; 0.1 for the terms of higher order at these sizes."""
    coarse, middle, fine = (energy_error(n, inner, cells) for cells in (4, 8, 16))
    assert fine < 4e-3
    assert math.log2(middle / fine) == pytest.approx(2, abs=0.1)
    assert math.log2(coarse / middle) == pytest.approx(2, abs=0.2)


def thin_ring(n: int, thickness: float) -> float:
    """Radial displacement of a free ring of mean radius 1 under f cos n phi, over that of the theory of thin rings."""
    half = thickness / 2
    basis = displacement_basis(rectangle((1 - half, 1 + half), (-half, half), (2, 2)))
    f = 1e3
    # half of the load on either face, per length of the mean circle
    force = sum(
        traction(basis, side, lambda r, z: (f / (2 * thickness * r), 0 * r, 0 * r))
        for side in ("inner", "outer")
    )
    u = splu(stiffness(basis, n).tocsc()).solve(force)
    middle = np.argmin(np.hypot(*(quadratic_nodes(basis.mesh)[0] - [1, 0]).T))
    return float(u[harmonic_dofs(basis.mesh)[0][middle]] / (f / (E * thickness**4 / 12 * (n**2 - 1) ** 2)))


@pytest.mark.parametrize("n", [2, 3, 5])
def test_a_ring_tends_to_the_theory_of_thin_rings(n: int) -> None:
    """w = f R^4/(E I (n^2 - 1)^2); shear and stretch add (n t/R)^2 or so: a quarter at half of t."""
    thick, thin, thinner = (thin_ring(n, t) - 1 for t in (0.1, 0.05, 0.025))
    assert 0 < thinner < 1.6e-4 * n**2
    assert thick / thin == pytest.approx(4, rel=0.02)
    assert thin / thinner == pytest.approx(4, rel=0.01)


@pytest.mark.parametrize(("length", "tolerance"), [(10.0, 1.2e-4), (20.0, 2e-5)])
def test_a_cylinder_bends_under_one_wave_as_a_beam(length: float, tolerance: float) -> None:
    """Even lateral traction on one end of a solid cylinder of radius 1; the other stays plane and bears the opposite.

    Its resultant is the traction times pi r^2, half of what is integrated "per full turn". F l^3/(3 E I) plus
    Timoshenko's shear with the coefficient of Hutchinson (J. Appl. Mech. 68 (2001) 87), 2 or 0.5 %, of which the ends
    disturb a share of 0.03/l; and up to 2e-5 of these coarse elements.
    """
    load = 1e6
    basis = displacement_basis(rectangle((0.0, 1.0), (0.0, length), (3, int(2 * length))))
    dofs, points = harmonic_dofs(basis.mesh), quadratic_nodes(basis.mesh)[0]
    bottom, top = (np.argmin(np.hypot(*(points - [0, z]).T)) for z in (0.0, length))
    # across, only the axis is held, by no force
    free = moving(basis, 1, np.append(dofs[1, points[:, 1] == 0], dofs[0, bottom]))
    force = sum(
        sign * traction(basis, side, lambda r, z: (0 * r + load, 0 * r, 0 * r - load))
        for side, sign in (("top", 1), ("bottom", -1))
    )
    u = free @ splu((free.T @ stiffness(basis, 1) @ free).tocsc()).solve(free.T @ force)
    area, inertia = np.pi, np.pi / 4
    kappa = 6 * (1 + NU) ** 2 / (7 + 12 * NU + 4 * NU**2)
    beam = load * area * (length**3 / (3 * E * inertia) + length / (kappa * MU * area))
    assert u[dofs[0, top]] == pytest.approx(beam, rel=tolerance)


@pytest.fixture(scope="module", params=["cone", "cone, wall fixed", "hollow seat"])
def coarse(request: pytest.FixtureRequest) -> ContactModel:
    """A ball on coarse elements; in the hollow seat the contact normal turns along the line."""
    ball = Ball(0.02)
    seat = (
        SphericalSeat.around(0.021, ball, contact_angle=0.785)
        if request.param == "hollow seat"
        else ConicalSeat.around(0.785, ball)
    )
    mesh = build(ball, seat, Sizing(1e-4, 4e-4, (-1e-3, 1e-3), 0.3, 0.4, 5e-3))
    supports = Supports(wall="fixed" if "fixed" in request.param else "free")
    return condense(mesh, {"closure": STEEL, "seat": STEEL}, supports)


def bodies(model: ContactModel) -> tuple[CondensedBody, CondensedBody]:
    return model.closure, model.seat


def test_without_waves_the_elements_are_those_of_the_axisymmetric_model(coarse: ContactModel) -> None:
    """Closing load and counting of the motion included; rounding, which the condition of K makes larger: 1e-10."""
    for body in bodies(coarse):
        k0 = assembled(displacement_basis(body.fem.mesh))[0]
        in_plane = k0[: body.fem.size][:, : body.fem.size]
        assert abs(k0[body.fem.size :][:, : body.fem.size]).max() == 0
        free = in_plane[body.fem.free][:, body.fem.free].tocsc()
        compliance, solve = contact_compliance(body.fem, free)
        balanced = np.zeros(body.fem.size)
        balanced[body.fem.free] = solve(body.fem.balance[body.fem.free])
        compliance = body.fem.floating_compliance(compliance, balanced)
        assert compliance == pytest.approx(body.compliance, abs=1e-10 * np.abs(body.compliance).max())


def independently(body: CondensedBody, n: int, point_forces: np.ndarray) -> np.ndarray:
    """Opening by a factor of another kind, of supports written down anew, for one load at a time."""
    basis, held = displacement_basis(body.fem.mesh), body.fem
    dofs, closure = harmonic_dofs(basis.mesh), held.name == "closure"

    def at(boundary: str) -> np.ndarray:
        return np.isin(dofs[0], basis.get_dofs(boundary).all(["u^1"]))

    fixed = [] if closure else [dofs[1, at("seat_bottom")]]
    if not closure and len(held.wall):
        fixed.append(dofs[0, at("seat_wall")])
    if n == 1:
        fixed.append(dofs[:, at("closure_top" if closure else "seat_bottom")].ravel())
    free = moving(basis, n, np.concatenate([np.zeros(0, int), *fixed]))
    force = np.zeros(dofs.size)
    on_nodes = held.trace.T @ point_forces
    force[dofs[0, held.contact_nodes]] = held.normal[0] * on_nodes
    force[dofs[1, held.contact_nodes]] = held.normal[1] * on_nodes
    u = free @ splu((free.T @ stiffness(basis, n) @ free).tocsc()).solve(free.T @ force)
    return held.trace @ (held.normal * u[dofs[:2, held.contact_nodes]]).sum(axis=0)


@pytest.mark.parametrize("n", [1, 2, 7])
def test_opening_is_that_of_the_whole_system_and_reciprocal(coarse: ContactModel, n: int) -> None:
    """The condensed answer against the whole system, and work of one load on the other's way: rounding, 1e-9."""
    x = coarse.line.x / coarse.line.x.max()
    one, other = coarse.line.area_weight * np.exp(-8 * x**2), coarse.line.area_weight * (1.5 + np.sin(3 * x))
    for body in bodies(coarse):
        harmonic = HarmonicBody(body.fem)
        under_one, under_other = independently(body, n, one), independently(body, n, other)
        assert harmonic.opening(n, one) == pytest.approx(under_one, abs=1e-9 * np.abs(under_one).max())
        assert other @ under_one == pytest.approx(one @ under_other, rel=1e-9)


def test_answers_are_kept_up_to_a_bound(coarse: ContactModel, monkeypatch: pytest.MonkeyPatch) -> None:
    body = HarmonicBody(coarse.seat.fem)
    first = body.compliance(2)
    assert body.compliance(2) is first
    monkeypatch.setattr(harmonics, "_CACHE_SIZE", 2.5 * first.nbytes)
    third = body.compliance(3)
    assert body.compliance(2) is first
    last = body.compliance(4)
    assert body.compliance(4) is last
    assert body.compliance(2) is not first
    assert np.array_equal(body.compliance(2), first)
    assert body.compliance(3) is not third


@pytest.mark.parametrize("n", [0, -2, 1.5])
def test_waves_are_counted_by_whole_numbers_from_one_on(coarse: ContactModel, n: float) -> None:
    with pytest.raises(ValueError, match=f"{n} waves around the axis: a whole number from 1 on is needed"):
        HarmonicBody(coarse.seat.fem).compliance(n)  # type: ignore[arg-type]


def wave_compliance(model: ContactModel, std: float, waves: Sequence[int]) -> np.ndarray:
    """Opening averaged over the load itself, per line load on the circle of first touch [m^2/N]; (closure/seat, n)."""
    shape = model.line.radius * model.line.arc_weight * np.exp(-0.5 * (model.line.x / std) ** 2)
    forces = 2 * np.pi * model.initial_contact_radius * shape / shape.sum()
    both = [HarmonicBody(body.fem) for body in bodies(model)]
    return np.array([[forces @ body.opening(n, forces) / forces.sum() for n in waves] for body in both])


@pytest.mark.parametrize(
    ("radius", "n", "each", "together"),
    [(0.5, 50, 8e-4, 4e-4), (0.5, 20, 2e-3, 7e-4), (0.02, 20, 2e-3, 1.2e-3)],
    ids=["0.5 m, 50 waves", "0.5 m, 20 waves", "20 mm, 20 waves"],
)
def test_short_waves_find_a_half_space(radius: float, n: int, each: float, together: float) -> None:
    """A line load f cos(k y) presses a half-space in by 2 (1 - nu^2)/(pi E) f K0(k |x|) cos(k y), k = n/r0.

    Averaged over a load of Gaussian shape, K0 becomes exp(b) K0(b)/2 with b = (k s)^2/2. The bodies are not plane: ball
    and cone miss it by the order of s/r0 and 1/n and with opposite sign, the two together by 2e-4, 5e-4 and 8e-4.
    Elements of two thirds the size change that by 6e-5.
    """
    model, _ = ball_on_cone(LAW, [20e5], radius=radius)
    std = 1e-3 if radius > 0.1 else 0.128e-3
    b = 0.5 * (n / model.initial_contact_radius * std) ** 2
    half_space = 2 * (1 - NU**2) / (np.pi * E) * 0.5 * kve(0, b)
    closure, seat = wave_compliance(model, std, [n]).ravel()
    assert (closure, seat) == pytest.approx((half_space, half_space), rel=each)
    assert closure + seat == pytest.approx(2 * half_space, rel=together)


@pytest.mark.slow
def test_compliance_hardly_changes_on_a_finer_mesh() -> None:
    """On the default mesh within 3e-4 of that of two thirds the size, at few waves as well; 1e-3 with a guide.

    The guide ends in a corner between held and free surface, whose stress no mesh of this kind resolves.
    """
    default, finer = (
        wave_compliance(ball_on_cone(LAW, [20e5], refine=refine)[0], 0.128e-3, [1, 2, 12]).sum(axis=0)
        for refine in (1.0, 1.5)
    )
    assert default[0] == pytest.approx(finer[0], rel=1e-3)
    assert default[1:] == pytest.approx(finer[1:], rel=3e-4)
