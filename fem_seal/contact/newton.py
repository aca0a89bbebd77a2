"""Contact of the condensed bodies through an interface law: a small dense Newton solve."""

from __future__ import annotations

import math
from collections.abc import Hashable, Sequence
from dataclasses import dataclass, replace

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
from fem_seal.files import problem as problem_of
from fem_seal.processes import single_threaded

# Smallest decay length of a law in units of f_N/(pi E*), and of a length in units of the lengths it comes from.
_FLOOR = 1e-6
_ROUND_OFF = 64 * np.finfo(float).eps
# Compliance of the bodies at a point over that of the law below which it carries next to nothing: leaving it out of
# the coupling leaves such a share of the residual. It may be a thousandth of what is left anyway: of the tolerance, or
# of what Newton's step leaves, a thousandth of the square of the residual. No seal takes more steps by that.
_LEAST_SHARE, _LARGEST_SHARE, _SHARE_OF_REST, _SHARE_OF_SQUARE = 1e-8, 1e-4, 1e-3, 1e-3
# ... of the largest, where all of them are smaller than this.
_SOFT = 1e-3
# ln of the pressure over the largest below which a point that carries nothing may stay without any.
_LEAST_LOG_PRESSURE = math.log(np.finfo(float).eps)


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
    (outcome,) = solve_many(
        [ContactProblem(model, law, contact_force, loads, settings or DEFAULT_SETTINGS, start)]
    )
    if isinstance(outcome, ConvergenceError):
        raise outcome
    return outcome


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
def solve_many(problems: Sequence[ContactProblem]) -> list[ContactSolution | ConvergenceError]:
    """`solve` of several: the same to the last digit, in less time where bodies are the same, and laws of one shape.

    Parameters
    ----------
    problems : sequence of ContactProblem

    Returns
    -------
    list
        Of each its solution, or why there is none.
    """
    groups: dict[Hashable, list[int]] = {}
    for number, problem in enumerate(problems):
        hard = isinstance(problem.law, HardContact)
        kind = number if hard else (id(problem.model), problem.settings, problem.start is None)
        groups.setdefault(kind, []).append(number)
    outcomes: dict[int, ContactSolution | ConvergenceError] = {}
    for numbers in groups.values():
        outcomes.update(zip(numbers, _solve_alike([problems[n] for n in numbers]), strict=True))
    return [outcomes[number] for number in range(len(problems))]


def _solve_alike(problems: Sequence[ContactProblem]) -> list[ContactSolution | ConvergenceError]:
    """Of one model; if they are several with equal settings, and all with a start or none."""
    first = problems[0]
    if isinstance(first.law, HardContact):
        try:
            return [solve_hard(first.model, first.contact_force, first.loads)]
        except ConvergenceError as error:
            return [error]
    rows = _Rows.of(problems)
    starts = [problem.start for problem in problems if problem.start is not None]
    try:
        iterations = _newton(
            rows, _FLOOR, first.settings, [(problem.log_pressure, problem.approach) for problem in starts]
        )
    except FloatingPointError:
        # of one of them, whose own affair it is
        if len(problems) > 1:
            return [outcome for problem in problems for outcome in _solve_alike([problem])]
        iterations = [(None, [np.inf])]
    return [
        _solve_from_soft(problem) if state is None else _solution(problem, state, residuals)
        for problem, (state, residuals) in zip(problems, iterations, strict=True)
    ]


def _solve_from_soft(problem: ContactProblem) -> ContactSolution | ConvergenceError:
    """What does not come straight at the law: from a soft interface to the law in steps.

    It begins anew: where it was looked for before may be too far away even for a soft interface. A stop comes last: the
    pressures on the way would change between those of a contact that it holds and one that it does not.
    """
    residuals = [np.inf]
    states: list[State] = []
    free = _Rows.of([replace(problem, model=problem.model.with_stop(math.inf))])
    ways = [(free, floor) for floor in (1.0, 0.1, 1e-2, 1e-3, 1e-4, 1e-5, _FLOOR)]
    for rows, floor in ways if math.isinf(problem.model.stop) else (*ways, (_Rows.of([problem]), _FLOOR)):
        try:
            ((state, residuals),) = _newton(rows, floor, problem.settings, states)
        except FloatingPointError:
            state, residuals = None, [np.inf]
        if state is None:
            break
        states = [state]
    return (
        _solution(problem, states[0], residuals)
        if state is not None
        else _solve_flattened_law(problem, states, residuals)
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
    problem: ContactProblem, state: State, residuals: Sequence[float]
) -> ContactSolution | ConvergenceError:
    assert not isinstance(problem.law, HardContact)  # that has no states
    if _is_all_but_rigid(problem.model, state[0], problem.law.decay_length(state[0])):
        return _solve_flattened_law(problem, [state], residuals)
    # the last residual is that of the solution, after which no step is taken
    return _solution_of_state(problem, state, len(residuals) - 1, residuals)


def _solve_flattened_law(
    problem: ContactProblem, states: Sequence[State], residuals: Sequence[float]
) -> ContactSolution | ConvergenceError:
    """With a law that is all but rigid, from a state that may still be softer."""
    assert not isinstance(problem.law, HardContact)
    model, loads = problem.model, problem.loads or NO_LOADS
    gap = model.line.initial_gap + loads.opening(model)
    floor = _FLOOR * model.line_load(problem.contact_force) / (np.pi * model.effective_modulus)
    for state in states:
        solution = solve_flattened(
            model, problem.law, problem.contact_force, gap, state, floor, problem.settings.gap_tolerance
        )
        if solution is not None:
            v, d, steps = solution
            return _solution_of_state(problem, (v, d), len(residuals) - 1 + steps, residuals)
    numbers = {"force": problem.contact_force, "line_load": model.line_load(problem.contact_force)}
    numbers |= {"iterations": problem.settings.max_iterations, "residual": residuals[-1]}
    return ConvergenceError(problem_of("newton", **numbers))


def _solution_of_state(
    problem: ContactProblem, state: State, steps: int, residuals: Sequence[float]
) -> ContactSolution:
    assert not isinstance(problem.law, HardContact)
    (v, d), carried_force, line = state, problem.contact_force, problem.model.line
    loads, force, gap = problem.loads or BodyLoads(), line.area_weight * np.exp(v), problem.law.gap(v)
    if d >= problem.model.stop:
        carried_force = min(float(line.normal[1] @ force), carried_force)
    if not force.all():
        # what carries nothing is as far apart as the bodies are: no force depends on its ln p, which is not iterated
        apart = (
            line.initial_gap
            + loads.opening(problem.model)
            - d * line.normal[1]
            + line.lift(float(gap[v.argmax()]))
        )
        gap = np.where(force > 0, gap, apart + problem.model.compliance @ force)
    return ContactSolution(
        problem.model,
        carried_force,
        d,
        v,
        gap,
        steps,
        tuple(residuals),
        loads,
        stop_force=problem.contact_force - carried_force,
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
    def of(cls, problems: Sequence[ContactProblem]) -> _Rows:
        model = problems[0].model
        return cls(
            model,
            [problem.law for problem in problems if not isinstance(problem.law, HardContact)],
            np.array([problem.contact_force for problem in problems]),
            np.stack(
                [model.line.initial_gap + (problem.loads or NO_LOADS).opening(model) for problem in problems]
            ),
        )

    def select(self, rows: NDArray[np.bool_]) -> _Rows:
        """Some of them."""
        laws = [self.laws[number] for number in rows.nonzero()[0].tolist()]
        return _Rows(self.model, laws, self.force[rows], self.gap0[rows])

    def gap(self, log_pressure: FloatArray) -> FloatArray:
        """Mean separation u [m] at ln(p/Pa), each row by its own law."""
        return np.stack([law.gap(row) for law, row in zip(self.laws, log_pressure, strict=True)])

    def decay_length(self, log_pressure: FloatArray) -> FloatArray:
        """-du/d ln p [m], each row by its own law."""
        return np.stack([law.decay_length(row) for law, row in zip(self.laws, log_pressure, strict=True)])

    @property
    def softest(self) -> FloatArray:
        """f_N/(pi E*), shape (rows, 1) [m]."""
        model = self.model
        return self.force[:, None] * (model.line_load(1.0) / (np.pi * model.effective_modulus))

    def hardest(self, floor: float, v: FloatArray, d: FloatArray) -> FloatArray:
        """`floor` f_N/(pi E*) of what the contact carries, at the stop not all of F_N, shape (rows, 1) [m]."""
        if np.isinf(self.model.stop):
            return floor * self.softest
        line = self.model.line
        carried_share = (line.normal[1] * line.area_weight * np.exp(v)).sum(axis=1) / self.force
        return (
            floor
            * self.softest
            * np.where(d >= self.model.stop, np.minimum(carried_share, 1.0)[:, None], 1.0)
        )

    def open_gap(self, force: FloatArray) -> FloatArray:
        """Opening of the gap by normal forces at the points, shape (rows, m) [m]."""
        # a product with several at once would depend on how many they are
        return np.stack([self.model.compliance @ row for row in force])

    def lift(self, v: FloatArray, separation: FloatArray) -> FloatArray | float:
        """See `ContactLine.lift`, at the highest pressure of each row."""
        line = self.model.line
        if line.in_hollow is None:
            return 0.0
        at_peak = np.take_along_axis(separation, v.argmax(axis=1)[:, None], axis=1)
        return np.stack([np.asarray(line.lift(value)) for value in at_peak[:, 0].tolist()])


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
            v, d = np.stack([log_p for log_p, _ in states]), np.array([[d] for _, d in states])
        else:
            v, d = _first_guess(rows, floor)
        d = np.minimum(d, rows.model.stop)
        residuals: list[list[float]] = [[] for _ in v]
        is_solved, pending = np.zeros(len(v), dtype=bool), np.arange(len(v))
        for _ in range(settings.max_iterations):
            at_v, at_d = v[pending], d[pending]
            hardest = rows.hardest(floor, at_v, at_d)
            decay = rows.decay_length(at_v) + hardest
            gap_residual, missing_force, worst = _residual(rows, hardest, at_v, at_d, decay, settings)
            for number, residual in zip(pending.tolist(), worst.tolist(), strict=True):
                residuals[number].append(residual)
            at_stop = at_d[:, 0] >= rows.model.stop
            unheld = np.where(at_stop, np.minimum(missing_force, 0.0), missing_force)
            is_within = (worst < settings.gap_tolerance) & (
                np.abs(unheld) < settings.force_tolerance * rows.force
            )
            is_solved[pending] = is_within
            if is_within.all():
                break
            threshold = _least_carrying(worst, min(settings.gap_tolerance, settings.force_tolerance))
            step_v, step_d, has_step = _newton_step(
                rows.model, at_v, at_d, decay, gap_residual, missing_force, threshold, ~is_within
            )
            for number in pending[~(is_within | has_step)].tolist():
                residuals[number].append(np.inf)
            pending = pending[has_step]
            v[pending] += step_v[has_step]
            d[pending] += step_d[has_step]
            if not has_step.all():
                rows = rows.select(has_step)
            if not len(pending):
                break
    return [
        ((v[n].copy(), float(d[n, 0])) if is_solved[n] else None, residuals[n]) for n in range(len(residuals))
    ]


def _first_guess(rows: _Rows, floor: float) -> tuple[FloatArray, FloatArray]:
    """Boltzmann-like pressure, exp(-g0/s) with s the decay length of the law plus f_N/(pi E*), and approach.

    For a parabolic gap this is the Gaussian whose variance is that of the exponential law plus that of Hertz (exact
    variance, theory 2); faces that fit each other get an even pressure.
    """
    line, gap0 = rows.model.line, rows.gap0
    distance, share = gap0 - gap0.min(axis=1, keepdims=True), line.normal[1] * line.area_weight
    s, hardest = rows.softest, floor * rows.softest
    for _ in range(4):
        v = -distance / s
        v += np.log(rows.force / (share * np.exp(v)).sum(axis=1))[:, None]
        s = rows.decay_length(v.max(axis=1, keepdims=True)) + hardest + rows.softest
    opening = rows.open_gap(line.area_weight * np.exp(v)) + gap0
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
    terms = (rows.gap0 + rows.lift(v, separation), -d * line.normal[1], rows.open_gap(f), -separation)
    gap_residual = terms[0] + terms[1] + terms[2] + terms[3]
    # Lengths cancel in the gap: what is below their round-off is no residual.
    scale = np.abs(terms[0]) + np.abs(terms[1]) + np.abs(terms[2]) + np.abs(terms[3])
    scale *= _ROUND_OFF
    if line.in_hollow is not None:
        # the lift is the difference of places
        scale += _ROUND_OFF * model.initial_contact_radius / 8
    scale /= settings.gap_tolerance
    scale += decay
    # what carries nothing is out of balance, too, where the bodies are as near as at a pressure that matters
    by_gap = v - gap_residual / decay
    counts = (f > 0) | (by_gap > v.max(axis=1, keepdims=True) + _LEAST_LOG_PRESSURE)
    worst = np.where(counts, np.abs(gap_residual) / scale, 0.0).max(axis=1)
    return gap_residual, rows.force - (line.normal[1] * f).sum(axis=1), worst


def _least_carrying(worst: FloatArray, tolerance: float) -> FloatArray:
    """What a point has to carry to take part in a step from such residuals to a tolerance, shape (rows,) both."""
    residual_left = np.maximum(tolerance / np.maximum(worst, tolerance), _SHARE_OF_SQUARE * worst)
    return np.minimum(np.maximum(_SHARE_OF_REST * residual_left, _LEAST_SHARE), _LARGEST_SHARE)


def _newton_step(
    model: ContactModel,
    v: FloatArray,
    d: FloatArray,
    decay: FloatArray,
    gap_residual: FloatArray,
    missing_force: FloatArray,
    threshold: FloatArray,
    is_pending: NDArray[np.bool_],
) -> tuple[FloatArray, FloatArray, NDArray[np.bool_]]:
    """One Newton step of the states, and which of the rows that are asked have one.

    Points that carry less than `threshold`, shape (rows,), follow the others explicitly. The derivative neglects that
    the lift follows the highest pressure.
    """
    n_z, has_step = model.line.normal[1], is_pending.copy()
    softness = model.line.area_weight * np.exp(v) / decay
    carries = softness * model.compliance.diagonal()
    largest = carries.max(axis=1, keepdims=True)
    active = carries > threshold[:, None] * np.minimum(1.0, largest / _SOFT)
    step_d, opening = np.zeros((len(v), 1)), np.zeros_like(v)
    for row in is_pending.nonzero()[0].tolist():
        try:
            step_d[row], opening[row] = _step_of_row(
                model,
                active[row].nonzero()[0],
                softness[row],
                gap_residual[row],
                float(missing_force[row]),
                model.stop - float(d[row, 0]),
            )
        except np.linalg.LinAlgError:
            has_step[row] = False
    step_v = (-gap_residual + step_d * n_z - opening) / decay
    return np.where(step_v > 0, np.log1p(np.maximum(step_v, 0)), step_v), step_d, has_step


def _step_of_row(
    model: ContactModel,
    active: NDArray[np.intp],
    softness: FloatArray,
    gap_residual: FloatArray,
    missing_force: float,
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
    rhs = np.array([-gap_residual[part], n_z]).T
    # symmetric: the transpose is the same matrix in LAPACK's order
    factor, info = dpotrf(matrix.T, lower=True, overwrite_a=True, clean=False)
    if info:
        raise np.linalg.LinAlgError("the contact is not stable")
    forces = dpotrs(factor, rhs, lower=True, overwrite_b=True)[0]
    by_residual, by_approach = forces[:, 0], forces[:, 1]
    step_d = min(float((missing_force - n_z @ by_residual) / (n_z @ by_approach)), room)
    return step_d, columns @ (by_residual + step_d * by_approach)
