"""Contact of the condensed bodies through an interface law: a small dense Newton solve."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg.lapack import dpotrf, dpotrs

from fem_seal.arrays import FloatArray
from fem_seal.bodies.single_thread import single_threaded
from fem_seal.contact.hard import solve_hard
from fem_seal.contact.laws import HardContact, InterfaceLaw, Law
from fem_seal.contact.model import ContactModel
from fem_seal.contact.other_loads import FurtherLoads
from fem_seal.contact.solution import ContactSettings, ContactSolution
from fem_seal.errors import ConvergenceError

# Smallest decay length of a law in units of f_N/(pi E*), and of a length in units of the lengths it comes from.
_FLOOR = 1e-6
_ROUND_OFF = 64 * np.finfo(float).eps
# What a point adds to I + D C D below which it carries next to nothing: it slows the iteration down by less than that.
_CARRIES = 1e-8
# ... of the largest, where all of them are smaller than this.
_SOFT = 1e-3


@single_threaded
def solve(
    model: ContactModel,
    law: Law,
    *,
    axial_force: float,
    loads: FurtherLoads | None = None,
    settings: ContactSettings | None = None,
    start: ContactSolution | None = None,
) -> ContactSolution:
    """Press the closure on the seat with a given axial force.

    Parameters
    ----------
    law : InterfaceLaw or HardContact
        `leak.ExponentialLaw`, `leak.TabulatedLaw`, `RoughContact.interface_law()` or `HardContact()`.
    axial_force : float
        F_N that the solid contact carries [N], positive.
    loads : FurtherLoads, optional
        What else acts on the bodies, with given magnitudes. The force on the top of the closure is then F_N plus the
        lift of these loads; `fem_seal.contact.penetration` finds fluid pressure and F_N together.
    settings : ContactSettings, optional
    start : ContactSolution, optional
        Solution of a neighbouring load to start from.

    Raises
    ------
    ValueError
        If the force is not positive and finite.
    ConvergenceError
        If the iteration does not reach the tolerances.

    Notes
    -----
    Unknowns are v = ln p at the points and the approach d:
    u(v) = g0 - d n_z + C (w e^v),  sum(n_z w e^v) = F_N,
    with the opening by further loads as a part of g0, and in a hollow seat the lift that the separation at the highest
    pressure asks for (`ContactLine.lift`).
    Increments of v are applied as they are where they fall and as log(1 + dv) where they rise: the pressure
    then never rises faster than linear extrapolation says, and the exponential cannot run away.

    Examples
    --------
    >>> import fem_seal, meshes
    >>> ball = meshes.Ball(0.02)
    >>> cone = meshes.ConicalSeat.around(0.785, ball)
    >>> sizing = meshes.Sizing(2e-5, 1e-4, (-1e-3, 1e-3), 0.2, 0.3, 4e-3)
    >>> steel = fem_seal.Material("steel", 210e9, 0.3)
    >>> model = fem_seal.condense(meshes.build(ball, cone, sizing), {"closure": steel, "seat": steel})
    >>> contact = fem_seal.solve(model, fem_seal.HardContact(), axial_force=1257.0)
    >>> print(f"{contact.profile.peak_pressure / 1e6:.0f} MPa over {contact.profile.fwhm * 1e3:.3f} mm")
    195 MPa over 0.106 mm
    """
    if not (np.isfinite(axial_force) and axial_force > 0):
        raise ValueError(f"axial_force = {axial_force!r} N: must be positive and finite")
    if isinstance(law, HardContact):
        return solve_hard(model, axial_force, loads)
    loads = loads or FurtherLoads()
    gap0 = model.line.initial_gap + loads.opening(model)
    settings = settings or ContactSettings()
    softest = model.line_load(axial_force) / (np.pi * model.effective_modulus)
    guess = None if start is None else (start.log_pressure, start.approach)
    # Straight at the law; if that fails, from a soft interface to the law in steps.
    for floors in ((_FLOOR,), (1.0, 0.1, 1e-2, 1e-3, 1e-4, 1e-5, _FLOOR)):
        state, residuals = guess, list[float]()
        for floor in floors:
            state, residuals = _newton(
                model, _Softened(law, floor * softest), axial_force, gap0, settings, state
            )
            if state is None:
                break
        if state is not None:
            v, d = state
            # the last residual is that of the solution, after which no step is taken
            return ContactSolution(
                model, axial_force, d, v, law.gap(v), len(residuals) - 1, tuple(residuals), loads
            )
    raise ConvergenceError(
        f"contact at axial force {axial_force:.6g} N (line load {model.line_load(axial_force):.6g} N/m) did not "
        f"converge in {settings.max_iterations} iterations; last residual {residuals[-1]:.2g} decay lengths, "
        "refine [mesh] contact_size or soften the interface law"
    )


@dataclass(frozen=True)
class _Softened:
    """A law with a constant added to its decay length.

    Where a law becomes rigid (full contact of rough surfaces) the pressure at single points is not defined any
    more. A decay length of 1e-6 f_N/(pi E*) keeps it defined; it changes the peak pressure by 1/(4c) with c = 1e6.
    """

    law: InterfaceLaw
    extra: float

    def gap(self, log_pressure: FloatArray) -> FloatArray:
        return self.law.gap(log_pressure) - self.extra * log_pressure

    def decay_length(self, log_pressure: FloatArray) -> FloatArray:
        return self.law.decay_length(log_pressure) + self.extra


State = tuple[FloatArray, float]


def _newton(
    model: ContactModel,
    law: InterfaceLaw,
    axial_force: float,
    gap0: FloatArray,
    settings: ContactSettings,
    state: State | None,
) -> tuple[State | None, list[float]]:
    """Iterate to the tolerances; None instead of a state if that fails. Also the residual before every step."""
    state = state or _first_guess(model, law, axial_force, gap0)
    residuals: list[float] = []
    for _ in range(settings.max_iterations):
        try:
            with np.errstate(over="raise", invalid="raise", under="ignore"):
                decay = law.decay_length(state[0])
                gap_residual, missing_force, worst = _unbalanced(
                    model, law, axial_force, gap0, state, decay, settings
                )
                residuals.append(worst)
                balanced = abs(missing_force) < settings.force_tolerance * axial_force
                if worst < settings.gap_tolerance and balanced:
                    return state, residuals
                state = _newton_step(model, state, decay, gap_residual, missing_force)
        except (FloatingPointError, np.linalg.LinAlgError):
            residuals.append(np.inf)
            return None, residuals
    return None, residuals


def _first_guess(
    model: ContactModel, law: InterfaceLaw, axial_force: float, gap0: FloatArray
) -> tuple[FloatArray, float]:
    """Boltzmann-like pressure, exp(-g0/s) with s the decay length of the law plus f_N/(pi E*).

    For a parabolic gap this is the Gaussian whose variance is that of the exponential law plus that of Hertz (exact
    variance, theory 2); faces that fit each other get an even pressure.
    """
    line = model.line
    softest = model.line_load(axial_force) / (np.pi * model.effective_modulus)
    apart, share = gap0 - gap0.min(), line.normal[1] * line.area_weight
    s = softest
    for _ in range(4):
        v = -apart / s
        v += np.log(axial_force / float(share @ np.exp(v)))
        s = float(law.decay_length(np.array([v.max()]))[0]) + softest
    centre = int(np.argmax(v))
    separations = law.gap(v)
    opening = model.compliance @ (line.area_weight * np.exp(v)) + gap0 - separations
    opening = opening + line.lift(float(separations[centre]))
    return v, float(opening[centre] / line.normal[1, centre])


def _unbalanced(
    model: ContactModel,
    law: InterfaceLaw,
    axial_force: float,
    gap0: FloatArray,
    state: State,
    decay: FloatArray,
    settings: ContactSettings,
) -> tuple[FloatArray, float, float]:
    """How far the bodies are from the gap of the law [m], and the force from F_N [N]; the former in decay lengths."""
    (v, d), line = state, model.line
    f = line.area_weight * np.exp(v)
    separations = law.gap(v)
    standing = gap0 + line.lift(float(separations[np.argmax(v)]))
    terms = (standing, -d * line.normal[1], model.compliance @ f, -separations)
    gap_residual = terms[0] + terms[1] + terms[2] + terms[3]
    # Lengths cancel in the gap: what is below their round-off is no residual.
    lost = _ROUND_OFF * sum(np.abs(term) for term in terms)
    if line.in_hollow is not None:
        # the lift is the difference of places
        lost = lost + _ROUND_OFF * model.touch_radius / 8
    round_off = lost / settings.gap_tolerance
    worst = float(np.max((np.abs(gap_residual) / (decay + round_off))[f > 0], initial=0.0))
    return gap_residual, axial_force - float(line.normal[1] @ f), worst


def _newton_step(
    model: ContactModel, state: State, decay: FloatArray, gap_residual: FloatArray, missing_force: float
) -> State:
    """The state after one Newton step; that the lift follows the highest pressure is left out of the derivative."""
    (v, d), C, n_z = state, model.compliance, model.line.normal[1]
    # Points that carry next to nothing follow the others explicitly; the rest is scaled to I + D C D, well conditioned.
    scale = np.sqrt(model.line.area_weight * np.exp(v) / decay)
    carries = scale**2 * C.diagonal()
    most = float(carries.max())
    if not most > 0.0:
        raise np.linalg.LinAlgError("no point carries anything")
    active = (carries > _CARRIES * min(1.0, most / _SOFT)).nonzero()[0]
    # mostly one stretch of them, of which nothing is copied
    stretch = len(active) > 0 and active[-1] - active[0] == len(active) - 1
    part = slice(active[0], active[-1] + 1) if stretch else active
    columns, D = C[:, part], scale[part]
    matrix = columns[part] * D
    matrix *= D[:, None]
    matrix.flat[:: len(active) + 1] += 1.0
    right = np.empty((len(active), 2))
    right[:, 0], right[:, 1] = -gap_residual[part], n_z[part]
    right *= D[:, None]
    # symmetric: the transpose is the same matrix in LAPACK's order
    factor, failed = dpotrf(matrix.T, lower=True, overwrite_a=True, clean=False)
    if failed:
        raise np.linalg.LinAlgError("the contact is not stable")
    eta = D[:, None] * dpotrs(factor, right, lower=True)[0]
    step_d = (missing_force - n_z[part] @ eta[:, 0]) / (n_z[part] @ eta[:, 1])
    step_f = eta[:, 0] + step_d * eta[:, 1]
    step_v = (-gap_residual + step_d * n_z - columns @ step_f) / decay
    return v + np.where(step_v > 0, np.log1p(np.maximum(step_v, 0)), step_v), d + step_d
