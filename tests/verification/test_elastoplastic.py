"""Elastoplastic bodies against closed solutions and an independent integration of the rate equations."""

from __future__ import annotations

import csv

import calculix_yielding
import numpy as np
import pytest
from plastic_solids import (
    HARDENING,
    HEIGHT,
    INNER,
    LAW,
    NU,
    OUTER,
    PERFECT,
    YIELD,
    E,
    find_balance,
    ring_solid,
    seal,
    shell_solid,
)
from scipy.linalg import solveh_banded
from skfem import Basis, LinearForm

from fem_seal.bodies.elasticity import pressure_load
from fem_seal.contact.load_path import load_path
from fem_seal.contact.plastic_step import PathLoad, PlasticSettings
from fem_seal.materials import HardeningCurve, Material


def hill_displacement(r: np.ndarray, c: float) -> np.ndarray:
    """Radial displacement of a spherical shell that has yielded up to the radius c under inner pressure.

    Hill, The Mathematical Theory of Plasticity (1950), V.2: exact for J2 and any Poisson's ratio, because two
    principal stresses are equal and plastic strain has no volume.
    """
    core = 2 * YIELD * c**3 / (3 * E * OUTER**3)

    def elastic(s: np.ndarray | float) -> np.ndarray:
        return core * ((1 - 2 * NU) * s + (1 + NU) * OUTER**3 / (2 * s**2))

    edge = -2 * YIELD / 3 * (1 - c**3 / OUTER**3)
    swelling = (3 * edge + 2 * YIELD) * (c**3 - r**3) / 3
    swelling += 6 * YIELD * (-(c**3) / 9 - r**3 / 3 * np.log(r / c) + r**3 / 9)
    return np.where(r > c, elastic(r), (c**2 * elastic(c) - (1 - 2 * NU) / E * swelling) / r**2)


def hill_pressure(c: float) -> float:
    """Inner pressure under which the shell has yielded up to the radius c (Hill, V.2, eq. 10)."""
    return float(2 * YIELD * np.log(c / INNER) + 2 * YIELD / 3 * (1 - c**3 / OUTER**3))


def push_on_arc(basis: Basis, boundary: str) -> np.ndarray:
    """Nodal forces [N] of 1 Pa on a curved boundary, which the program's own bodies do not have."""

    @LinearForm
    def push(v, w):
        return -2 * np.pi * w.x[0] * (v[0] * w.n[0] + v[1] * w.n[1])

    return push.assemble(basis.boundary(boundary))


def shell_errors(cells: int, c: float) -> tuple[float, float]:
    """Relative L2 errors of displacement and radial stress."""
    body = shell_solid(cells)
    p = hill_pressure(c)
    state, _ = find_balance(body, body.virgin, p * push_on_arc(body.basis, "inner"))
    x, dx = np.asarray(body.basis.global_coordinates()), body.basis.dx
    R = np.hypot(*x)
    u = np.asarray(body.basis.interpolate(state.displacement))
    exact = hill_displacement(R, c)
    (n_r, n_z), sigma = x / R, np.moveaxis(state.stress, -1, 0)
    radial = sigma[0] * n_r**2 + sigma[1] * n_z**2 + 2 * sigma[3] * n_r * n_z
    outside = -2 * YIELD * c**3 / (3 * OUTER**3) * (OUTER**3 / R**3 - 1)
    stress = np.where(c > R, -p + 2 * YIELD * np.log(R / INNER), outside)
    return (
        float(np.sqrt(np.sum(((u - exact * x / R) ** 2).sum(axis=0) * dx) / np.sum(exact**2 * dx))),
        float(np.sqrt(np.sum((radial - stress) ** 2 * dx) / np.sum(stress**2 * dx))),
    )


def test_spherical_shell_converges_to_hill() -> None:
    """Displacement of third, stress of second order, as in elasticity; c half-way through the wall."""
    errors = np.array([shell_errors(cells, 0.015) for cells in (4, 8, 16)])
    rates = np.log2(errors[:-1] / errors[1:])
    assert np.all(rates[:, 0] > 2.8)
    assert np.all(rates[:, 1] > 1.7)
    assert errors[-1, 0] < 5e-5
    assert errors[-1, 1] < 5e-3


def collapse_pressure(cells: int, nu: float) -> float:
    """Pressure that a thick cylinder between flat ends carries when it is opened by 3 % of its bore."""
    body = ring_solid(
        cells,
        Material("m", E, nu, hardening=HardeningCurve((0.0,), (YIELD,))),
        hold=("flat", "inner"),
    )
    wall = body.basis.get_dofs("inner").all(["u^1"])
    state, before = body.virgin, 0.0
    for opening in INNER * np.linspace(0, 0.03, 11)[1:]:
        start = state.displacement * (opening / before if before else 1.0)
        start[wall] = before = opening
        state, _ = find_balance(body, state, start=start)
    return float(body.internal_forces(state.stress)[wall].sum()) / (2 * np.pi * INNER * HEIGHT)


def test_no_locking_in_unrestricted_plastic_flow() -> None:
    """Plane strain collapse at 2/sqrt(3) Y ln(b/a): flow at constant volume everywhere, the trap of locking elements.

    Elements that lock overshoot it by tens of per cent at any fineness.
    """
    exact = 2 / np.sqrt(3) * YIELD * np.log(OUTER / INNER)
    overshoot = np.array([collapse_pressure(cells, NU) / exact - 1 for cells in (2, 4, 8)])
    assert np.all(overshoot > 0)
    assert overshoot[0] < 0.02
    assert overshoot[2] < 2e-4
    assert np.all(overshoot[:-1] / overshoot[1:] > 8)  # third order at least


def cylinder_by_rates(opening: float, cells: int = 200, steps: int = 1000) -> tuple[float, float]:
    """Pressure and outer displacement of a plane strain J2 cylinder, from the rate equations along the radius.

    Prandtl-Reuss rates (tangent to the yield surface), linear radial elements, Heun's method: neither the return
    mapping nor the elements of the product. No closed solution is exact here: Hill's takes Tresca's criterion,
    Prager's and Hodge's an incompressible solid.
    """
    lam, mu = E * NU / ((1 + NU) * (1 - 2 * NU)), E / (2 * (1 + NU))
    D = lam * np.ones((3, 3)) + 2 * mu * np.eye(3)
    r = np.linspace(INNER, OUTER, cells + 1)
    m, h = 0.5 * (r[1:] + r[:-1]), np.diff(r)
    strain = np.zeros((cells, 2, 2))
    strain[:, 0] = np.stack([-1 / h, 1 / h], axis=1)
    strain[:, 1] = (0.5 / m)[:, None]

    def split(stress: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        deviator = stress - stress.mean(axis=1, keepdims=True)
        return deviator, np.sqrt(1.5 * (deviator**2).sum(axis=1))

    def rates(stress: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        deviator, q = split(stress)
        along = deviator / np.maximum(np.linalg.norm(deviator, axis=1), 1.0)[:, None]
        yields = (q > YIELD * (1 - 1e-6))[:, None, None]
        tangent = D - 2 * mu * yields * along[:, :, None] * along[:, None, :]
        K = np.einsum("eia,eij,ejb,e->eab", strain, tangent[:, :2, :2], strain, m * h)
        band = np.zeros((2, cells + 1))
        band[1, :-1] += K[:, 0, 0]
        band[1, 1:] += K[:, 1, 1]
        band[0, 1:] = K[:, 0, 1]
        v = np.ones(cells + 1)
        v[1:] = solveh_banded(band[:, 1:], np.append(-band[0, 1], np.zeros(cells - 1)))
        rate = np.einsum("eia,ea->ei", strain, np.stack([v[:-1], v[1:]], axis=1))
        return np.einsum("eij,ej->ei", tangent[:, :, :2], rate), v

    stress, u, dt = np.zeros((cells, 3)), np.zeros(cells + 1), opening / steps
    for _ in range(steps):
        first, v_first = rates(stress)
        second, v_second = rates(stress + dt * first)
        stress, u = stress + 0.5 * dt * (first + second), u + 0.5 * dt * (v_first + v_second)
        deviator, q = split(stress)
        stress -= deviator * np.maximum(1 - YIELD / np.maximum(q, 1.0), 0.0)[:, None]
    return float(np.sum((stress[:, 1] - stress[:, 0]) / m * h)), float(u[-1])


def cylinder_by_elements(opening: float, steps: int, cells: int = 12) -> tuple[float, float]:
    body = ring_solid(cells, hold=("flat", "inner"))
    wall, outer = (body.basis.get_dofs(name).all(["u^1"]) for name in ("inner", "outer"))
    state = body.virgin
    for n in range(1, steps + 1):
        start = state.displacement * (n / (n - 1) if n > 1 else 1.0)
        start[wall] = n / steps * opening
        state, _ = find_balance(body, state, start=start)
    pressure = body.internal_forces(state.stress)[wall].sum() / (2 * np.pi * INNER * HEIGHT)
    return float(pressure), float(state.displacement[outer].mean())


@pytest.mark.slow
def test_thick_cylinder_in_plane_strain() -> None:
    """Two thirds of the wall yielding; the hoop, radial and axial stress do not stay in proportion there."""
    opening = 2e-5
    reference = np.array(cylinder_by_rates(opening))
    coarse, medium, fine = (np.array(cylinder_by_elements(opening, steps)) for steps in (10, 20, 40))
    assert fine == pytest.approx(reference, rel=3e-4)
    # Implicit Euler: the change halves with the steps.
    assert (coarse - medium) / (medium - fine) == pytest.approx(2, abs=0.4)


def test_incompressible_cylinder_tends_to_prager_and_hodge() -> None:
    """Closed for von Mises and an incompressible solid: p = k (2 ln(c/a) + 1 - c^2/b^2), u(b) = k c^2/(2 mu b).

    Prager, Hodge, Theory of Perfectly Plastic Solids (1951), sec. 15. What is left falls in proportion to 1 - 2 nu.
    """
    c, k = 0.015, YIELD / np.sqrt(3)
    p = k * (2 * np.log(c / INNER) + 1 - c**2 / OUTER**2)
    errors = []
    for nu in (0.45, 0.475):
        body = ring_solid(16, Material("m", E, nu, hardening=HardeningCurve((0.0,), (YIELD,))))
        state, load = body.virgin, pressure_load(body.mesh, "inner")
        for share in np.linspace(0.4, 1, 13):
            state, _ = find_balance(body, state, share * p * load)
        outer = body.basis.get_dofs("outer").all(["u^1"])
        errors.append(state.displacement[outer].mean() / (k * c**2 * (1 + nu) / (E * OUTER)) - 1)
    assert errors[0] == pytest.approx(0.1, abs=0.02)  # 1 - 2 nu
    assert 2 * errors[1] - errors[0] == pytest.approx(0, abs=2e-3)  # continued to nu = 1/2


def test_patch_of_uniaxial_tension() -> None:
    """A bar pulled beyond yield: the stress is that of the curve in every point, on elements of any shape."""
    curve = HardeningCurve((0.0, 0.01, 0.05), (YIELD, 1.4 * YIELD, 1.6 * YIELD))
    body = ring_solid(3, Material("m", E, NU, hardening=curve), hold=("bottom", "top"), inner=0.0)
    axis = np.flatnonzero(np.isclose(body.basis.doflocs[0], 0))
    radial = np.setdiff1d(axis, body.basis.get_dofs().all(["u^2"]))
    body = type(body)(body.mesh, body.material, free=np.setdiff1d(body.free, radial))
    top = body.basis.get_dofs("top").all(["u^2"])
    state = body.virgin
    for pull in (0.0005, 0.004, 0.03):
        start = state.displacement.copy()
        start[top] = pull * HEIGHT
        state, _ = find_balance(body, state, start=start)
        stress = state.stress[..., 1]
        plastic = pull - stress / E
        expected = np.where(plastic > 1e-12, curve.flow_stress(plastic), E * pull)
        assert stress == pytest.approx(expected, rel=1e-8)
        assert np.abs(state.stress[..., [0, 2, 3]]).max() < 1e-7 * YIELD


def test_newton_converges_quadratically() -> None:
    body = ring_solid(8, PERFECT)
    _, residuals = find_balance(body, body.virgin, 0.75 * YIELD * pressure_load(body.mesh, "inner"))
    last = np.log([r for r in residuals if r > 1e-14][-3:])
    # of the last three residuals, each has about twice the digits of the one before
    assert (last[2] - last[1]) / (last[1] - last[0]) > 1.6


def test_seal_against_calculix() -> None:
    """The same seal in CalculiX 2.20: 6-node triangles on the same mesh, *PLASTIC with this curve, 8 load steps.

    Its contact carries 0.5 % more than the load (its sum over the contact line against its own reactions), so that
    pressures are compared per line load. The elastic peak would be twice as high.
    """
    model, force = seal(LAW, 4e7, seat=HARDENING, wider=2.0)
    (contact,) = load_path(model, LAW, [PathLoad(force)], settings=PlasticSettings(steps=8)).contacts
    profile = contact.profile
    assert profile.peak_pressure / profile.moment(0) == pytest.approx(658.26e6 / 401812.2, rel=2e-3)
    assert (profile.fwhm, profile.std) == pytest.approx((0.62400e-3, 0.20599e-3), rel=4e-3)


@pytest.mark.parametrize("name", ["ball on cone", "poppet on edge"])
def test_spring_and_fluid_on_a_yielding_seat_against_calculix(name: str) -> None:
    """CalculiX 2.20 on the same mesh, pressure on the wetted faces and in the gap: `benchmarks/calculix_yielding.py`.

    Its surfaces overlap by 1.3 % of the radius of the edge, and differences there are of this size; on the cone, whose
    face is straight, nothing is left but how its pressure is printed.
    """
    (valve,) = (one for one in calculix_yielding.valves() if one.name == name)
    with calculix_yielding.TABLE.open() as file:
        theirs = [row for row in csv.DictReader(file) if row["valve"] == name]
    for contact, row in zip(calculix_yielding.ours(valve, valve.mesh()), theirs, strict=True):
        profile, allowed = contact.profile, 4e-3 if name == "ball on cone" else 1.5e-2
        measured = profile.peak_pressure / profile.moment(0), profile.fwhm, profile.std
        expected = [float(row[key]) for key in ("peak_over_line_load_per_m", "fwhm_m", "std_m")]
        assert measured == pytest.approx(expected, rel=allowed)
        # more than the seat strains elastically
        soft = valve.materials["seat"]
        yielded = contact.states["seat"].plastic.accumulated_strain.max()
        assert soft.yield_stress and yielded > soft.yield_stress / soft.youngs_modulus
