"""The axisymmetric elements against closed solutions: patch test, rigid motion, Lame's thick cylinder."""

from __future__ import annotations

import numpy as np
import pytest
from contact_models import displacement_basis
from skfem import Basis, BilinearForm, LinearForm, MeshTri, condense, solve

from fem_seal.bodies.elasticity import (
    StressRecovery,
    lame_parameters,
    node_dofs,
    pressure_load,
    quadratic_nodes,
    shape_functions,
    shape_gradients,
    stiffness_matrix,
)
from fem_seal.bodies.fields import von_mises
from fem_seal.materials import Material

STEEL = Material("steel", 210e9, 0.3)
INNER, OUTER, HEIGHT = 0.01, 0.02, 0.005


def ring(refine: int, inner: float = INNER) -> MeshTri:
    """Rectangle in the (r, z) half-plane with its four sides named, elements deliberately unequal."""
    r = np.linspace(inner, OUTER, 3) + np.array([0, 0.1, 0]) * (OUTER - inner)
    mesh = MeshTri.init_tensor(r, np.linspace(0, HEIGHT, 2)).refined(refine)
    return mesh.with_boundaries(
        {
            "inner": lambda x: np.isclose(x[0], inner),
            "outer": lambda x: np.isclose(x[0], OUTER),
            "bottom": lambda x: np.isclose(x[1], 0),
            "top": lambda x: np.isclose(x[1], HEIGHT),
        }
    )


def nodal(basis: Basis, r_component: object, z_component: object) -> np.ndarray:
    points, _ = quadratic_nodes(basis.mesh)
    u = np.zeros(basis.N)
    u[node_dofs(basis.mesh)[0]], u[node_dofs(basis.mesh)[1]] = r_component(points), z_component(points)  # type: ignore[operator]
    return u


def test_stiffness_is_symmetric_and_positive() -> None:
    K = stiffness_matrix(ring(1), STEEL)
    assert abs(K - K.T).max() <= 1e-14 * abs(K).max()
    eigenvalues = np.linalg.eigvalsh(K.toarray())
    assert np.sum(eigenvalues < 1e-10 * eigenvalues[-1]) == 1  # the axial rigid motion, nothing else


@pytest.mark.parametrize("inner", [0.0, INNER])
def test_axial_rigid_motion_has_no_force_and_no_stress(inner: float) -> None:
    basis = displacement_basis(ring(2, inner))
    u = nodal(basis, lambda p: 0 * p[:, 0], lambda p: 0 * p[:, 0] + 1e-3)
    K = stiffness_matrix(basis.mesh, STEEL)
    assert np.abs(K @ u).max() < 1e-12 * abs(K).max() * 1e-3
    assert np.abs(StressRecovery(basis.mesh, STEEL).stress(u)).max() < 1e-10 * 210e9


@pytest.mark.parametrize("inner", [0.0, INNER])
def test_patch_test_uniform_pressure_gives_uniform_stress(inner: float) -> None:
    """Hydrostatic pressure on every surface: u = -p (1 - 2 nu)/E (r, z), exactly representable."""
    p, (E, nu) = 30e6, (STEEL.youngs_modulus, STEEL.poissons_ratio)
    basis = displacement_basis(ring(1, inner))
    k = -p * (1 - 2 * nu) / E
    u = nodal(basis, lambda x: k * x[:, 0], lambda x: k * x[:, 1])
    sides = ["outer", "top", "bottom"] + (["inner"] if inner else [])
    force = p * sum(pressure_load(basis.mesh, side) for side in sides)
    assert stiffness_matrix(basis.mesh, STEEL) @ u == pytest.approx(force, abs=1e-10 * np.abs(force).max())
    stress = StressRecovery(basis.mesh, STEEL).stress(u)
    assert stress == pytest.approx(np.tile([-p, -p, -p, 0.0], (len(stress), 1)), abs=1e-9 * p)


def test_pressure_load_sums_to_pressure_times_area() -> None:
    basis = displacement_basis(ring(1))
    load = pressure_load(basis.mesh, "top")
    axial = np.concatenate([basis.nodal_dofs[1], basis.facet_dofs[1]])
    assert load[axial].sum() == pytest.approx(-np.pi * (OUTER**2 - INNER**2), rel=1e-12)


def lame_displacement(r: np.ndarray, p: float) -> np.ndarray:
    """Radial displacement of a thick cylinder under inner pressure, plane strain (Timoshenko & Goodier, art. 28)."""
    lam, mu = lame_parameters(STEEL)
    A = p * INNER**2 / (OUTER**2 - INNER**2)
    return A / 2 * (r / (lam + mu) + OUTER**2 / (mu * r))


def solved_cylinder(refine: int, p: float) -> tuple[Basis, np.ndarray]:
    basis = displacement_basis(ring(refine))
    held = np.concatenate([basis.get_dofs(side).all(["u^2"]) for side in ("top", "bottom")])
    u = solve(*condense(stiffness_matrix(basis.mesh, STEEL), p * pressure_load(basis.mesh, "inner"), D=held))
    return basis, u


def test_lame_cylinder_converges_with_third_order() -> None:
    p, errors = 50e6, []
    for refine in (0, 1, 2, 3):
        basis, u = solved_cylinder(refine, p)
        field = basis.interpolate(u)
        r = np.asarray(basis.global_coordinates())[0]
        error = np.asarray(field)[0] - lame_displacement(r, p)
        errors.append(np.sqrt(np.sum(error**2 * basis.dx)))
    rates = np.diff(np.log(errors)) / np.log(0.5)
    assert rates[-1] == pytest.approx(3.0, abs=0.25)  # quadratic elements: displacement of third order in L2


@pytest.mark.parametrize("inner", [0.0, INNER])
def test_the_stiffness_is_that_of_the_weak_form(inner: float) -> None:
    """scikit-fem adds up the weak form over the same quadrature points."""
    basis = displacement_basis(ring(2, inner))
    lam, mu = lame_parameters(STEEL)

    def strains(w, u):  # type: ignore[no-untyped-def]
        (rr, rz), (zr, zz) = u.grad
        return rr, zz, u[0] / w.x[0], 0.5 * (rz + zr)

    @BilinearForm
    def work(u, v, w):  # type: ignore[no-untyped-def]
        *along_u, shear_u = strains(w, u)
        *along_v, shear_v = strains(w, v)
        normal = sum(a * b for a, b in zip(along_u, along_v, strict=True))
        density = lam * sum(along_u) * sum(along_v) + 2 * mu * (normal + 2 * shear_u * shear_v)
        return 2 * np.pi * w.x[0] * density

    expected = work.assemble(basis)
    assert abs(stiffness_matrix(basis.mesh, STEEL) - expected).max() < 1e-14 * abs(expected).max()


def test_recovered_stress_of_a_cylinder_is_of_third_order() -> None:
    """The mean over the triangles around each node is of second order: with these elements ten times as far off."""
    p, errors = 50e6, []
    A, B = p * INNER**2 / (OUTER**2 - INNER**2), p * INNER**2 * OUTER**2 / (OUTER**2 - INNER**2)
    for refine in (2, 3, 4):
        basis, u = solved_cylinder(refine, p)
        r = quadratic_nodes(basis.mesh)[0][:, 0]
        stress = StressRecovery(basis.mesh, STEEL).stress(u)
        exact = np.stack([A - B / r**2, 2 * STEEL.poissons_ratio * A + 0 * r, A + B / r**2, 0 * r], axis=1)
        errors.append(np.sqrt(np.mean((stress - exact) ** 2)))
    rates = np.diff(np.log(errors)) / np.log(0.5)
    assert rates[-1] > 2.9  # inside, where these triangles are even, it is of fourth order
    assert np.abs(stress - exact).max() < 1e-3 * p  # on the boundary, where a patch has one side


def test_lame_stress_at_the_bore() -> None:
    """Hoop stress at the bore p (ro^2 + ri^2)/(ro^2 - ri^2), radial stress -p."""
    p = 50e6
    basis, u = solved_cylinder(4, p)
    points, _ = quadratic_nodes(basis.mesh)
    stress = StressRecovery(basis.mesh, STEEL).stress(u)
    bore = np.isclose(points[:, 0], INNER)
    hoop = p * (OUTER**2 + INNER**2) / (OUTER**2 - INNER**2)
    # nodal stress is of third order: 1/32 of the wall per element leaves 3e-4
    assert stress[bore, 2] == pytest.approx(hoop, rel=5e-4)
    assert stress[bore, 0] == pytest.approx(-p, rel=5e-3)


def test_von_mises_of_simple_states() -> None:
    assert von_mises(np.array([100.0, 0, 0, 0])) == pytest.approx(100.0)
    assert von_mises(np.array([0.0, 0, 0, 50.0])) == pytest.approx(50 * np.sqrt(3))
    assert von_mises(np.array([-7.0, -7.0, -7.0, 0])) == pytest.approx(0.0)


@pytest.mark.parametrize("inner", [0.0, INNER])
def test_pressure_loads_are_those_of_scikit_fem(inner: float) -> None:
    """r times a quadratic shape function: both integrate it exactly."""
    basis = displacement_basis(ring(2, inner))

    @LinearForm
    def push(v, w):  # type: ignore[no-untyped-def]
        r, _ = w.x
        return -2 * np.pi * r * (v[0] * w.n[0] + v[1] * w.n[1])

    for boundary in basis.mesh.boundaries:
        expected = push.assemble(basis.boundary(boundary))
        scale = np.abs(expected).max() or 1.0  # nothing presses on the axis
        np.testing.assert_allclose(pressure_load(basis.mesh, boundary) / scale, expected / scale, atol=1e-14)


def test_shape_functions_are_those_of_scikit_fem() -> None:
    basis = displacement_basis(ring(1, 0.0))
    values, _ = shape_functions(basis.X)
    gradients = shape_gradients(basis.mesh, basis.X)
    for n in range(6):
        (radial,) = basis.basis[2 * n]
        np.testing.assert_allclose(
            np.broadcast_to(values[:, n], basis.dx.shape), np.asarray(radial)[0], atol=1e-14
        )
        np.testing.assert_allclose(
            gradients[:, :, n].transpose(2, 0, 1), radial.grad[0], rtol=1e-12, atol=1e-9
        )


def test_strain_of_a_quadratic_displacement_is_exact_at_the_nodes() -> None:
    """Strains that quadratic displacements have are linear, and those of all triangles around a node agree."""
    basis = displacement_basis(ring(2, 0.0))
    u = nodal(
        basis, lambda p: 3 * p[:, 0] * (1 + 40 * p[:, 1]), lambda p: 70 * p[:, 0] ** 2 - 9 * p[:, 1] ** 2
    )
    (r, z), (lam, mu) = quadratic_nodes(basis.mesh)[0].T, lame_parameters(STEEL)
    radial, axial, shear = 3 * (1 + 40 * z), -18 * z, 120 * r + 140 * r
    volume = lam * (2 * radial + axial)
    expected = np.stack(
        [volume + 2 * mu * radial, volume + 2 * mu * axial, volume + 2 * mu * radial, mu * shear]
    )
    stress = StressRecovery(basis.mesh, STEEL).stress(u).T
    np.testing.assert_allclose(stress, expected, atol=1e-12 * np.abs(expected).max())
