"""Contact of the condensed bodies through an interface law: a small dense Newton solve."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve

from fem_seal.condensation import ContactModel
from fem_seal.contact_solution import ContactSettings, ContactSolution
from fem_seal.errors import ConvergenceError
from fem_seal.hard_contact import solve_hard
from fem_seal.laws import HardContact, InterfaceLaw, Law

FloatArray = NDArray[np.float64]


def solve(
    model: ContactModel,
    law: Law,
    *,
    axial_force: float,
    settings: ContactSettings | None = None,
    start: ContactSolution | None = None,
) -> ContactSolution:
    """Press the closure on the seat with a given axial force.

    Parameters
    ----------
    model : ContactModel
    law : InterfaceLaw or HardContact
        `leak.ExponentialLaw`, `leak.TabulatedLaw`, `RoughContact.interface_law()` or `HardContact()`.
    axial_force : float
        F_N [N], positive.
    settings : ContactSettings, optional
    start : ContactSolution, optional
        Solution of a neighbouring load to start from.

    Returns
    -------
    ContactSolution

    Raises
    ------
    ValueError
        If the force is not positive and finite.
    ConvergenceError
        If the iteration does not reach the tolerances.

    Notes
    -----
    Unknowns are v = ln p at the points and the approach d:
    u(v) = g0 - d n_z + C (w e^v),  sum(n_z w e^v) = F_N.
    Increments of v are applied as they are where they fall and as log(1 + dv) where they rise: the pressure
    then never rises faster than linear extrapolation says, and the exponential cannot run away.
    """
    if not (np.isfinite(axial_force) and axial_force > 0):
        raise ValueError(f"axial_force = {axial_force!r} N: must be positive and finite")
    if isinstance(law, HardContact):
        return solve_hard(model, axial_force)
    settings = settings or ContactSettings()
    v, d = _first_guess(model, law, axial_force) if start is None else (start.log_pressure, start.approach)
    residuals: list[float] = []
    for iteration in range(1, settings.max_iterations + 1):
        v, d, residual, force_residual = _newton_step(model, law, axial_force, v, d)
        residuals.append(residual)
        if residual < settings.gap_tolerance and abs(force_residual) < settings.force_tolerance:
            return ContactSolution(model, axial_force, d, v, law.gap(v), iteration, tuple(residuals))
    raise ConvergenceError(
        f"contact at axial force {axial_force:.6g} N (line load {model.line_load(axial_force):.6g} N/m) did not "
        f"converge in {settings.max_iterations} iterations; last residual {residuals[-1]:.2g} decay lengths, "
        "refine [mesh] contact_size or soften the interface law"
    )


def _first_guess(model: ContactModel, law: InterfaceLaw, axial_force: float) -> tuple[FloatArray, float]:
    """Gaussian whose variance is that of the exponential law plus that of Hertz (exact variance, theory 2)."""
    line, f_N, R = model.line, model.line_load(axial_force), model.relative_radius
    hertz_variance = f_N * R / (np.pi * model.effective_modulus)
    pressure = np.log(f_N / np.sqrt(2 * np.pi * hertz_variance))
    for _ in range(3):
        variance = R * float(law.decay_length(np.array([pressure]))[0]) + hertz_variance
        pressure = np.log(f_N / np.sqrt(2 * np.pi * variance))
    v = pressure - line.x**2 / (2 * variance)
    centre = int(np.argmax(v))
    opening = model.compliance @ (line.area_weight * np.exp(v)) + line.initial_gap - law.gap(v)
    return v, float(opening[centre] / line.normal[1, centre])


def _newton_step(
    model: ContactModel, law: InterfaceLaw, axial_force: float, v: FloatArray, d: float
) -> tuple[FloatArray, float, float, float]:
    """One Newton step for (v, d); also the residuals at the state that it leaves."""
    line, C = model.line, model.compliance
    n_z = line.normal[1]
    f = line.area_weight * np.exp(v)
    decay = law.decay_length(v)
    gap_residual = line.initial_gap - d * n_z + C @ f - law.gap(v)
    force_residual = 1 - float(n_z @ f) / axial_force
    # Points that carry nothing follow the others explicitly; the rest is scaled to I + D C D, well conditioned.
    scale = np.sqrt(f / decay)
    active = np.flatnonzero(scale**2 * np.diagonal(C) > 1e-18)
    D = scale[active]
    matrix = np.eye(len(active)) + D[:, None] * C[np.ix_(active, active)] * D
    right = np.column_stack([-gap_residual[active], n_z[active]]) * D[:, None]
    eta = D[:, None] * cho_solve(
        cho_factor(matrix, lower=True, check_finite=False), right, check_finite=False
    )
    step_d = (axial_force * force_residual - n_z[active] @ eta[:, 0]) / (n_z[active] @ eta[:, 1])
    step_f = eta[:, 0] + step_d * eta[:, 1]
    step_v = (-gap_residual + step_d * n_z - C[:, active] @ step_f) / decay
    worst = float(np.max(np.abs(gap_residual / decay)[f * decay > 0], initial=0.0))
    v_new = v + np.where(step_v > 0, np.log1p(np.maximum(step_v, 0)), step_v)
    return v_new, d + step_d, worst, force_residual
