"""Contact of the condensed bodies through an interface law: a small dense Newton solve."""

from __future__ import annotations

import math
from collections.abc import Hashable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dpotrf, dpotrs

from fem_seal.arrays import FloatArray
from fem_seal.contact.flattened import solve_flattened
from fem_seal.contact.hard import solve_hard
from fem_seal.contact.laws import HardContact, InterfaceLaw, Law
from fem_seal.contact.model import NO_LOADS, BodyLoads, ContactModel
from fem_seal.contact.solution import DEFAULT_SETTINGS, ContactSettings, ContactSolution
from fem_seal.errors import ConvergenceError
from fem_seal.processes import single_threaded

# Smallest decay length of a law in units of f_N/(pi E*), and of a length in units of the lengths it comes from.
_FLOOR = 1e-6
_ROUND_OFF = 64 * np.finfo(float).eps
# Compliance of the bodies at a point over that of the law below which it carries next to nothing: leaving it out of
# the coupling leaves such a share of the residual. It may be a thousandth of what is left anyway: of the tolerance, or
# of what Newton's step leaves, a thousandth of the square of the residual. No seal takes more steps by that.
_LEAST, _MOST, _SPARED, _SQUARED = 1e-8, 1e-4, 1e-3, 1e-3
# ... of the largest, where all of them are smaller than this.
_SOFT = 1e-3


def solve(
    model: ContactModel,
    law: Law,
    *,
    contact_force: float,
    loads: BodyLoads | None = None,
    settings: ContactSettings | None = None,
    start: ContactSolution | None = None,
) -> ContactSolution:
    """Press the closure on the seat with a given axial force, which goes past the contact from a stop on.

    Parameters
    ----------
    law : InterfaceLaw or HardContact
        `leak.ExponentialLaw`, `leak.TabulatedLaw`, `RoughContact.interface_law()` or `HardContact()`.
    contact_force : float
        F_N that the solid contact carries [N], positive; where it would approach further than the stop of the model,
        what contact and stop carry together.
    loads : BodyLoads, optional
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
    pressure asks for (`ContactLine.lift`). With a stop d_s the force is F_N + F_s, where 0 <= F_s and d <= d_s, and one
    of both is an equation: a step ends at the stop, where a force that is missing is that of the stop.
    Increments of v are applied as they are where they fall and as log(1 + dv) where they rise: the pressure
    then never rises faster than linear extrapolation says, and the exponential cannot run away.

    Where the law is all but rigid, ln p is then found at the element ends alone, see `fem_seal.contact.flattened`.

    Examples
    --------
    >>> import fem_seal, meshes
    >>> ball = meshes.Ball(0.02)
    >>> cone = meshes.ConicalSeat.around(0.785, ball)
    >>> sizing = meshes.Sizing(2e-5, 1e-4, (-1e-3, 1e-3), 0.2, 0.3, 4e-3)
    >>> steel = fem_seal.Material("steel", 210e9, 0.3)
    >>> model = fem_seal.condense(meshes.build(ball, cone, sizing), {"closure": steel, "seat": steel})
    >>> contact = fem_seal.solve(model, fem_seal.HardContact(), contact_force=1257.0)
    >>> print(f"{contact.profile.peak_pressure / 1e6:.0f} MPa over {contact.profile.fwhm * 1e3:.3f} mm")
    195 MPa over 0.106 mm
    """
    (found,) = solve_many(
        [ContactProblem(model, law, contact_force, loads, settings or DEFAULT_SETTINGS, start)]
    )
    if isinstance(found, ConvergenceError):
        raise found
    return found


@dataclass(frozen=True)
class ContactProblem:
    """A closure that is to be pressed on its seat, see `solve`.

    Parameters
    ----------
    model : ContactModel
    law : InterfaceLaw or HardContact
    contact_force : float
        Of contact and stop together [N].
    loads : BodyLoads or None
    settings : ContactSettings
    start : ContactSolution or None
        Solution of a neighbouring load to start from.
    """

    model: ContactModel
    law: Law
    contact_force: float
    loads: BodyLoads | None = None
    settings: ContactSettings = DEFAULT_SETTINGS
    start: ContactSolution | None = None

    def __post_init__(self) -> None:
        force = self.contact_force
        if not (np.isfinite(force) and force > 0):
            raise ValueError(f"contact_force = {force!r} N: must be positive and finite")


@single_threaded
def solve_many(pressings: Sequence[ContactProblem]) -> list[ContactSolution | ConvergenceError]:
    """`solve` of several: the same to the last digit, in less time where bodies are the same, and laws of one shape.

    Parameters
    ----------
    pressings : sequence of ContactProblem

    Returns
    -------
    list
        Of each its solution, or why there is none.
    """
    alike: dict[Hashable, list[int]] = {}
    for number, one in enumerate(pressings):
        hard = isinstance(one.law, HardContact)
        kind = number if hard else (id(one.model), one.settings, one.start is None)
        alike.setdefault(kind, []).append(number)
    found: dict[int, ContactSolution | ConvergenceError] = {}
    for numbers in alike.values():
        found.update(zip(numbers, _solve_alike([pressings[n] for n in numbers]), strict=True))
    return [found[number] for number in range(len(pressings))]


def _solve_alike(pressings: Sequence[ContactProblem]) -> list[ContactSolution | ConvergenceError]:
    """Of one model; if they are several with equal settings, and all with a start or none."""
    first = pressings[0]
    if isinstance(first.law, HardContact):
        try:
            return [solve_hard(first.model, first.contact_force, first.loads)]
        except ConvergenceError as error:
            return [error]
    rows = _Rows.of(pressings)
    starts = [one.start for one in pressings if one.start is not None]
    try:
        found = _newton(rows, _FLOOR, first.settings, [(one.log_pressure, one.approach) for one in starts])
    except FloatingPointError:
        # of one of them, whose own affair it is
        if len(pressings) > 1:
            return [own for one in pressings for own in _solve_alike([one])]
        found = [(None, [np.inf])]
    return [
        _softened_first(one) if state is None else _solution(one, state, residuals)
        for one, (state, residuals) in zip(pressings, found, strict=True)
    ]


def _softened_first(one: ContactProblem) -> ContactSolution | ConvergenceError:
    """What does not come straight at the law: from a soft interface to the law in steps.

    It begins anew: where it was looked for before may be too far away even for a soft interface. A stop comes last: the
    pressures on the way would change between those of a contact that it holds and one that it does not.
    """
    residuals = [np.inf]
    states: list[State] = []
    free = _Rows.of([replace(one, model=one.model.with_stop(math.inf))])
    ways = [(free, floor) for floor in (1.0, 0.1, 1e-2, 1e-3, 1e-4, 1e-5, _FLOOR)]
    for rows, floor in ways if math.isinf(one.model.stop) else (*ways, (_Rows.of([one]), _FLOOR)):
        try:
            ((state, residuals),) = _newton(rows, floor, one.settings, states)
        except FloatingPointError:
            state, residuals = None, [np.inf]
        if state is None:
            break
        states = [state]
    return (
        _solution(one, states[0], residuals)
        if state is not None
        else _solve_flattened_law(one, states, residuals)
    )


# Compliance of the bodies at a point over that of the law from which on the law is all but rigid. Three pressures to an
# element, whose displacement has two more nodes, are free to go up and down then: by 0.3 % of the peak here, by 30 % at
# 1e8.
_RIGID = 1e3


def _is_all_but_rigid(model: ContactModel, log_pressure: FloatArray, decay_length: FloatArray) -> bool:
    """Whether a law yields next to nothing beside the bodies at some point of the contact line."""
    force = model.line.area_weight * np.exp(log_pressure)
    return bool(np.any(force * model.compliance.diagonal() > _RIGID * decay_length))


def _solution(
    one: ContactProblem, state: State, residuals: Sequence[float]
) -> ContactSolution | ConvergenceError:
    assert not isinstance(one.law, HardContact)  # that has no states
    if _is_all_but_rigid(one.model, state[0], one.law.decay_length(state[0])):
        return _solve_flattened_law(one, [state], residuals)
    # the last residual is that of the solution, after which no step is taken
    return _solution_of_state(one, state, len(residuals) - 1, residuals)


def _solve_flattened_law(
    one: ContactProblem, states: Sequence[State], residuals: Sequence[float]
) -> ContactSolution | ConvergenceError:
    """With a law that is all but rigid, from a state that may still be softer."""
    assert not isinstance(one.law, HardContact)
    model, loads = one.model, one.loads or NO_LOADS
    apart = model.line.initial_gap + loads.opening(model)
    floor = _FLOOR * model.line_load(one.contact_force) / (np.pi * model.effective_modulus)
    for state in states:
        found = solve_flattened(
            model, one.law, one.contact_force, apart, state, floor, one.settings.gap_tolerance
        )
        if found is not None:
            v, d, steps = found
            return _solution_of_state(one, (v, d), len(residuals) - 1 + steps, residuals)
    return ConvergenceError(
        f"contact at axial force {one.contact_force:.6g} N (line load {model.line_load(one.contact_force):.6g} N/m) "
        f"did not converge in {one.settings.max_iterations} iterations; last residual {residuals[-1]:.2g} decay "
        "lengths, refine [mesh] contact_size or soften the interface law"
    )


def _solution_of_state(
    one: ContactProblem, state: State, steps: int, residuals: Sequence[float]
) -> ContactSolution:
    assert not isinstance(one.law, HardContact)
    (v, d), carried, line = state, one.contact_force, one.model.line
    loads, pressure, gap = one.loads or BodyLoads(), np.exp(v), one.law.gap(v)
    if d >= one.model.stop:
        carried = min(float((line.normal[1] * line.area_weight) @ pressure), carried)
    if not pressure.all():
        # what carries nothing is as far apart as the bodies are: no force depends on its ln p, which is not iterated
        apart = (
            line.initial_gap
            + loads.opening(one.model)
            - d * line.normal[1]
            + line.lift(float(gap[v.argmax()]))
        )
        gap = np.where(pressure > 0, gap, apart + one.model.compliance @ (line.area_weight * pressure))
    return ContactSolution(
        one.model,
        carried,
        d,
        v,
        gap,
        steps,
        tuple(residuals),
        loads,
        stop_force=one.contact_force - carried,
    )


State = tuple[FloatArray, float]


@dataclass(frozen=True)
class _Rows:
    """Pressings of one model; of each a row in all arrays, and what stands in a row depends on that row alone.

    Parameters
    ----------
    model : ContactModel
    laws : sequence of InterfaceLaw
    force : ndarray, shape (rows,)
        F_N [N].
    gap0 : ndarray, shape (rows, m)
        Gap of the bodies without contact pressure [m].
    """

    model: ContactModel
    laws: Sequence[InterfaceLaw]
    force: FloatArray
    gap0: FloatArray

    @classmethod
    def of(cls, pressings: Sequence[ContactProblem]) -> _Rows:
        model = pressings[0].model
        return cls(
            model,
            [one.law for one in pressings if not isinstance(one.law, HardContact)],
            np.array([one.contact_force for one in pressings]),
            np.stack([model.line.initial_gap + (one.loads or NO_LOADS).opening(model) for one in pressings]),
        )

    def chosen(self, rows: NDArray[np.bool_]) -> _Rows:
        """Some of them."""
        laws = [self.laws[number] for number in rows.nonzero()[0].tolist()]
        return _Rows(self.model, laws, self.force[rows], self.gap0[rows])

    def gap(self, log_pressure: FloatArray) -> FloatArray:
        """Mean separation u [m] at ln(p/Pa), each row by its own law."""
        return np.stack([law.gap(row) for law, row in zip(self.laws, log_pressure, strict=True)])

    def decay_length(self, log_pressure: FloatArray) -> FloatArray:
        """-du/d ln p [m], each row by its own law."""
        return np.stack([law.decay_length(row) for law, row in zip(self.laws, log_pressure, strict=True)])

    @cached_property
    def softest(self) -> FloatArray:
        """f_N/(pi E*), shape (rows, 1) [m]."""
        model = self.model
        return self.force[:, None] * (model.line_load(1.0) / (np.pi * model.effective_modulus))

    def hardest(self, floor: float, v: FloatArray, d: FloatArray) -> FloatArray:
        """`floor` f_N/(pi E*) of what the contact carries, at the stop not all of F_N, shape (rows, 1) [m]."""
        if np.isinf(self.model.stop):
            return floor * self.softest
        line = self.model.line
        carried = (line.normal[1] * line.area_weight * np.exp(v)).sum(axis=1) / self.force
        return floor * self.softest * np.where(d >= self.model.stop, np.minimum(carried, 1.0)[:, None], 1.0)

    def opened(self, force: FloatArray) -> FloatArray:
        """Opening of the gap by normal forces at the points, shape (rows, m) [m]."""
        # a product with several at once would depend on how many they are
        return np.stack([self.model.compliance @ row for row in force])

    def lift(self, v: FloatArray, separation: FloatArray) -> FloatArray | float:
        """See `ContactLine.lift`, at the highest pressure of each row."""
        line = self.model.line
        if line.in_hollow is None:
            return 0.0
        at_peak = np.take_along_axis(separation, v.argmax(axis=1)[:, None], axis=1)
        return np.stack([np.asarray(line.lift(one)) for one in at_peak[:, 0].tolist()])


def _newton(
    rows: _Rows, floor: float, settings: ContactSettings, states: Sequence[State]
) -> list[tuple[State | None, list[float]]]:
    """Iterate each row to the tolerances: its state, None if that fails, and the residual before every step.

    Where a law becomes rigid (full contact of rough surfaces) the pressure at single points is not defined any
    more. A decay length of `floor` f_N/(pi E*) keeps it defined; with 1e-6 it changes the peak pressure by 1/(4c) with
    c = 1e6.

    Raises
    ------
    FloatingPointError
        Of one of the rows.
    """
    with np.errstate(over="raise", invalid="raise", under="ignore"):
        if states:
            v, d = np.stack([one for one, _ in states]), np.array([[one] for _, one in states])
        else:
            v, d = _first_guess(rows, floor)
        d = np.minimum(d, rows.model.stop)
        residuals: list[list[float]] = [[] for _ in v]
        solved, left = np.zeros(len(v), dtype=bool), np.arange(len(v))
        for _ in range(settings.max_iterations):
            at_v, at_d = v[left], d[left]
            hardest = rows.hardest(floor, at_v, at_d)
            decay = rows.decay_length(at_v) + hardest
            gap_residual, missing_force, worst = _residual(rows, hardest, at_v, at_d, decay, settings)
            for number, one in zip(left.tolist(), worst.tolist(), strict=True):
                residuals[number].append(one)
            stopped = at_d[:, 0] >= rows.model.stop
            unheld = np.where(stopped, np.minimum(missing_force, 0.0), missing_force)
            done = (worst < settings.gap_tolerance) & (np.abs(unheld) < settings.force_tolerance * rows.force)
            solved[left] = done
            if done.all():
                break
            least = _least_carrying(worst, min(settings.gap_tolerance, settings.force_tolerance))
            step_v, step_d, stepped = _newton_step(
                rows.model, at_v, at_d, decay, gap_residual, missing_force, least, ~done
            )
            for number in left[~(done | stepped)].tolist():
                residuals[number].append(np.inf)
            left = left[stepped]
            v[left] += step_v[stepped]
            d[left] += step_d[stepped]
            if not stepped.all():
                rows = rows.chosen(stepped)
            if not len(left):
                break
    return [
        ((v[n].copy(), float(d[n, 0])) if solved[n] else None, residuals[n]) for n in range(len(residuals))
    ]


def _first_guess(rows: _Rows, floor: float) -> tuple[FloatArray, FloatArray]:
    """Boltzmann-like pressure, exp(-g0/s) with s the decay length of the law plus f_N/(pi E*), and approach.

    For a parabolic gap this is the Gaussian whose variance is that of the exponential law plus that of Hertz (exact
    variance, theory 2); faces that fit each other get an even pressure.
    """
    line, gap0 = rows.model.line, rows.gap0
    apart, share = gap0 - gap0.min(axis=1, keepdims=True), line.normal[1] * line.area_weight
    s, hardest = rows.softest, floor * rows.softest
    for _ in range(4):
        v = -apart / s
        v += np.log(rows.force / (share * np.exp(v)).sum(axis=1))[:, None]
        s = rows.decay_length(v.max(axis=1, keepdims=True)) + hardest + rows.softest
    opening = rows.opened(line.area_weight * np.exp(v)) + gap0
    separation = rows.gap(v) - hardest * v
    opening = opening - separation + rows.lift(v, separation)
    centre = v.argmax(axis=1)[:, None]
    return v, np.take_along_axis(opening / line.normal[1], centre, axis=1)


def _residual(
    rows: _Rows,
    hardest: FloatArray,
    v: FloatArray,
    d: FloatArray,
    decay: FloatArray,
    settings: ContactSettings,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """How far the bodies are from the gap of the law [m], and the force from F_N [N]; the former in decay lengths."""
    model, line = rows.model, rows.model.line
    f = line.area_weight * np.exp(v)
    separation = rows.gap(v) - hardest * v
    terms = (rows.gap0 + rows.lift(v, separation), -d * line.normal[1], rows.opened(f), -separation)
    gap_residual = terms[0] + terms[1] + terms[2] + terms[3]
    # Lengths cancel in the gap: what is below their round-off is no residual.
    lost = np.abs(terms[0]) + np.abs(terms[1]) + np.abs(terms[2]) + np.abs(terms[3])
    lost *= _ROUND_OFF
    if line.in_hollow is not None:
        # the lift is the difference of places
        lost += _ROUND_OFF * model.initial_contact_radius / 8
    lost /= settings.gap_tolerance
    lost += decay
    worst = np.where(f > 0, np.abs(gap_residual) / lost, 0.0).max(axis=1)
    return gap_residual, rows.force - (line.normal[1] * f).sum(axis=1), worst


def _least_carrying(worst: FloatArray, tolerance: float) -> FloatArray:
    """What a point has to carry to take part in a step from such residuals to a tolerance, shape (rows,) both."""
    left_anyway = np.maximum(tolerance / np.maximum(worst, tolerance), _SQUARED * worst)
    return np.minimum(np.maximum(_SPARED * left_anyway, _LEAST), _MOST)


def _newton_step(
    model: ContactModel,
    v: FloatArray,
    d: FloatArray,
    decay: FloatArray,
    gap_residual: FloatArray,
    missing_force: FloatArray,
    least: FloatArray,
    asked: NDArray[np.bool_],
) -> tuple[FloatArray, FloatArray, NDArray[np.bool_]]:
    """One Newton step of the states, and which of the rows that are asked have one.

    Points that carry less than `least`, shape (rows,), follow the others explicitly. That the lift follows the highest
    pressure is left out of the derivative.
    """
    n_z, stepped = model.line.normal[1], asked.copy()
    softness = model.line.area_weight * np.exp(v) / decay
    carries = softness * model.compliance.diagonal()
    most = carries.max(axis=1, keepdims=True)
    active = carries > least[:, None] * np.minimum(1.0, most / _SOFT)
    step_d, opened = np.zeros((len(v), 1)), np.zeros_like(v)
    for row in asked.nonzero()[0].tolist():
        try:
            step_d[row], opened[row] = _step_of_row(
                model,
                active[row].nonzero()[0],
                softness[row],
                gap_residual[row],
                float(missing_force[row]),
                model.stop - float(d[row, 0]),
            )
        except np.linalg.LinAlgError:
            stepped[row] = False
    step_v = (-gap_residual + step_d * n_z - opened) / decay
    return np.where(step_v > 0, np.log1p(np.maximum(step_v, 0)), step_v), step_d, stepped


def _step_of_row(
    model: ContactModel,
    active: NDArray[np.intp],
    softness: FloatArray,
    gap_residual: FloatArray,
    missing: float,
    room: float,
) -> tuple[float, FloatArray]:
    """Step of the approach [m], at most up to the stop, and opening of the gap by that of the pressures [m]."""
    if not len(active):
        raise np.linalg.LinAlgError("no point carries anything")
    # mostly one stretch of them, of which nothing is copied
    stretch = active[-1] - active[0] == len(active) - 1
    part = slice(active[0], active[-1] + 1) if stretch else active
    columns, n_z = model.compliance[:, part], model.line.normal[1, part]
    # Badly scaled, but by its diagonal alone, which does not matter to Cholesky's factors.
    matrix = columns[part].copy()
    matrix.reshape(-1)[:: len(active) + 1] += 1.0 / softness[part]
    right = np.array([-gap_residual[part], n_z]).T
    # symmetric: the transpose is the same matrix in LAPACK's order
    factor, failed = dpotrf(matrix.T, lower=True, overwrite_a=True, clean=False)
    if failed:
        raise np.linalg.LinAlgError("the contact is not stable")
    forces = dpotrs(factor, right, lower=True, overwrite_b=True)[0]
    by_residual, by_approach = forces[:, 0], forces[:, 1]
    step_d = min(float((missing - n_z @ by_residual) / (n_z @ by_approach)), room)
    return step_d, columns @ (by_residual + step_d * by_approach)
