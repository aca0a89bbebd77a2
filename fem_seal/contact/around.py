"""Line load around the axis of a seal with form error.

As long as the waves are long against the contact's width, every place of the circumference is in the axisymmetric
contact of its own line load f(phi), and the bodies even out what they can:

    D(f(phi)) + sum_n (c_n - c_0) f_n(phi) + h(phi) = d n_z,    mean of f = f_N,

with D(f) the approach along the normal of the axisymmetric contact, f_n(phi) the n-th harmonic of f, c_n the opening
under a line load that waves n times, and h(phi) what the form error adds to the gap. A closure that is free to shift
and tilt takes no first harmonic of f, or that of a given moment, and gives way to that of h. See theory/form in the
manual.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from fem_seal.arrays import FloatArray
from fem_seal.contact.local_contact import LocalContact
from fem_seal.contact.model import ContactModel
from fem_seal.errors import ConvergenceError
from fem_seal.files import problem as problem_of

if TYPE_CHECKING:
    from scipy.interpolate import CubicSpline


# Waves up to which the bodies are asked to every harmonic.
_ALL_UP_TO = 6


@dataclass(frozen=True)
class Stiffening:
    """c_n - c_0: by how much less a contact opens under a line load that waves n times than under an even one.

    c_n is the opening under the line load w(x) cos(n phi), weighted with w(x), the share of the line load that each
    place of the width carries. The axisymmetric compliance is on the same mesh, and the logarithm that makes both
    depend on w cancels.

    Parameters
    ----------
    model : ContactModel
    pressure : ndarray, shape (m,)
        At the points of the contact line; only its shape counts.
    highest : int
        Harmonic beyond which the bodies are taken to answer as half-spaces do, from what they answer to this one.
    period : int
        Of the harmonics that may be asked for: multiples of it.
    openings : dict
        What the bodies answer to each harmonic, as far as it has been asked for, see `LocalContact.openings`.
    """

    model: ContactModel
    pressure: FloatArray = field(repr=False)
    highest: int
    period: int = 1
    openings: dict[int, FloatArray] = field(default_factory=dict, repr=False)

    def __call__(self, n: int) -> float:
        """c_n - c_0 [m per N/m]; of n = 1 that of a guided closure.

        Parameters
        ----------
        n : int
        """
        return self._half_spaces(n) + float(self._answer(min(n, self.highest))[0])

    def bend(self, n: int) -> float:
        """By how much a line load that waves n times bends the gap across the width, in (x - x_mean)^2 [1/m per N/m].

        None of it where the bodies answer as half-spaces do: such harmonics are weak.

        Parameters
        ----------
        n : int
        """
        return 0.0 if n > self.highest else n * float(self._answer(n)[1])

    def closing(self, n: int, radius: float) -> float:
        """By how much a force on a circle of the closure's top that waves n times closes the gap [m/N].

        Parameters
        ----------
        n : int
            Two or more.
        radius : float
            Of the circle [m].
        """
        return float(self._forces @ self.model.harmonics[0].push(n, radius) / self._forces.sum())

    def _answer(self, n: int) -> FloatArray:
        """By how much c_n - c_0 differs from that of half-spaces, and the bend over n."""
        return self._spline(-(n**-0.5)) if n > 1 and n not in self._harmonics else self._ask_bodies(n)

    def _ask_bodies(self, n: int) -> FloatArray:
        """The same as the bodies answer it."""
        forces, opening, x = self._forces, self._opening(n), self.model.line.x
        share = forces / forces.sum()
        parabola = (x - share @ x) ** 2
        parabola = parabola - share @ parabola
        bend = (share * parabola) @ opening / ((share * parabola) @ parabola)
        return np.array([share @ opening - self._half_spaces(n), bend / n])

    @property
    def _harmonics(self) -> list[int]:
        """Harmonics from the second on to which the bodies are asked: all up to 6, then half as many waves again.

        How they differ from half-spaces is a smooth function of n. A spline over n^(-1/2) between these leaves 2e-5 of
        c_n, and 1e-3 where a body is a slender ring, which bends like 1/(n^2 - 1)^2.
        """
        harmonics = [max(2, self.period)]
        while harmonics[-1] < self.highest:
            half = harmonics[-1] // (2 * self.period) if harmonics[-1] >= _ALL_UP_TO else 1
            harmonics.append(min(harmonics[-1] + max(1, half) * self.period, self.highest))
        return harmonics

    @cached_property
    def _spline(self) -> CubicSpline:
        from scipy.interpolate import CubicSpline

        return CubicSpline(-(np.array(self._harmonics) ** -0.5), list(map(self._ask_bodies, self._harmonics)))

    def _opening(self, n: int) -> FloatArray:
        """By how much more the gap opens under the n-th harmonic than under an even line load [m per N/m]."""
        if n not in self.openings:
            model, forces = self.model, self._forces
            of_bodies = (harmonic.opening(n, forces) for harmonic in model.harmonics)
            self.openings[n] = sum(of_bodies, -(model.compliance @ forces))
        return self.openings[n]

    @cached_property
    def _forces(self) -> FloatArray:
        """Forces at the points of the contact line that make a line load of one [N per N/m]."""
        forces = self.model.line.area_weight * self.pressure
        return forces * (2 * math.pi * self.model.initial_contact_radius / forces.sum())

    @cached_property
    def std(self) -> float:
        """Standard deviation of the pressure over x [m]."""
        share, x = self._forces / self._forces.sum(), self.model.line.x
        return math.sqrt(share @ x**2 - (share @ x) ** 2)

    def _half_spaces(self, n: int) -> float:
        """(2/(pi E*)) <K0(n |x - x'|/r0)> of a normal distribution."""
        t = 0.5 * (n * self.std / self.model.initial_contact_radius) ** 2
        from scipy.special import k0e

        return float(k0e(t)) / (math.pi * self.model.effective_modulus)


# What is left of the gap's change, in decay lengths of the approach over ln f, and steps to get there.
_TOLERANCE, _MAX_STEPS = 1e-9, 80
# Share of the form error that is put on first where all at once fails, by how much the next one grows, and the least.
_FIRST_SHARE, _GROWS, _LEAST_SHARE = 0.1, 1.5, 0.01
# Shares of a Newton step that are tried where the whole of it leads away, or to a line load that cannot be solved.
_OF_STEP = (1.0, 0.5, 0.25, 0.1, 0.03, 0.01)
# Where the line load falls, one step lets it fall by this many e-folds at most.
_FALL = 5.0
# Relative residual of the linear equations, and the most products to get there.
_LINEAR_TOLERANCE, _MOST_PRODUCTS = 1e-7, 400
# Least line load over the mean that is followed in its logarithm.
_LEAST_LOAD = 1e-60


def line_load_around(
    local: LocalContact,
    stiffening: Callable[[int], float],
    gap: FloatArray,
    mean: float,
    *,
    symmetry: int = 1,
    guided: bool = False,
    first: complex = 0.0,
    start: FloatArray | None = None,
) -> tuple[FloatArray, FloatArray]:
    """Line load and approach at uniform angles of one period of the form error.

    Parameters
    ----------
    local : LocalContact
    stiffening : callable
        c_n - c_0 of harmonic n [m per N/m]; that of the first is asked for only if the closure is guided.
    gap : ndarray, shape (m,)
        What the form error adds to the gap along the normal, at m uniform angles from 0 to 2 pi/symmetry [m].
    mean : float
        f_N [N/m].
    symmetry : int
        How often the form error repeats itself around the axis.
    guided : bool
        Whether the closure takes a lateral force and a moment.
    first : complex
        First harmonic that a given moment asks for, a of Re(a exp(i phi)), where neither guided nor symmetric [N/m].
    start : ndarray, shape (m,), optional
        Line load from which it is looked for; even unless given [N/m].

    Returns
    -------
    line_load : ndarray, shape (m,)
        f [N/m]; zero where smooth surfaces part.
    approach : ndarray, shape (m,)
        Along the normal [m].

    Raises
    ------
    ConvergenceError
    """
    ring = _Ring.of(len(gap), stiffening, symmetry, guided)
    ways = (_solve_in_line_loads,) if local.opens else (_solve_in_logarithms, _solve_in_line_loads)
    even_load = np.full(len(gap), mean)
    failures: list[ConvergenceError] = []

    def attempt(iterate: Iteration, share: float, begin: FloatArray) -> Solution | None:
        try:
            return iterate(_Problem(local, ring, share * gap, mean, share * first), begin)
        except ConvergenceError as error:
            # it asks for a contact that cannot be solved
            failures.append(error)
            return None

    for iterate in ways:
        solution = attempt(iterate, 1.0, even_load if start is None else start)
        solution = _put_on(partial(attempt, iterate), even_load) if solution is None else solution
        if solution is not None:
            return solution
    why = f": {failures[0]}" if failures else "; make it smaller, or its waves longer"
    raise ConvergenceError(problem_of("around", height=1e6 * float(np.ptp(gap)), why=why))


Solution = tuple[FloatArray, FloatArray]
Iteration = Callable[["_Problem", FloatArray], Solution | None]


def _put_on(attempt: Callable[[float, FloatArray], Solution | None], start: FloatArray) -> Solution | None:
    """The form error put on share by share, each from where the one before it ended; None if that fails."""
    share, step, solution = 0.0, _FIRST_SHARE, None
    while share < 1.0:
        aim = min(share + step, 1.0)
        next_solution = attempt(aim, start if solution is None else solution[0])
        if next_solution is None:
            step /= 2
            if step < _LEAST_SHARE:
                return None
        else:
            share, step, solution = aim, step * _GROWS, next_solution
    return solution


@dataclass(frozen=True)
class _Ring:
    """What the harmonics of a line load do to the gap, and which of them the closure does not take.

    Parameters
    ----------
    stiffening : ndarray, shape (m // 2 + 1,)
        c_n - c_0 of the harmonics of a period with m angles [m per N/m].
    rigid : ndarray, shape (1 or 3, m)
        Motions of the closure: along the axis, and unless guided the two first harmonics.
    """

    stiffening: FloatArray
    rigid: FloatArray

    @classmethod
    def of(cls, size: int, stiffening: Callable[[int], float], symmetry: int, guided: bool) -> _Ring:
        free = symmetry == 1 and not guided
        of_harmonics = [
            0.0,
            *(0.0 if free and n == 1 else stiffening(symmetry * n) for n in range(1, size // 2 + 1)),
        ]
        angle = 2 * np.pi * np.arange(size) / size
        motions = [np.ones(size), *((np.cos(angle), np.sin(angle)) if free else ())]
        return cls(np.array(of_harmonics), np.array(motions))

    def opening(self, line_load: FloatArray) -> FloatArray:
        """By how much less the bodies open at each angle than under a load that is even there [m]."""
        return np.fft.irfft(self.stiffening * np.fft.rfft(line_load), line_load.shape[-1])

    def missing_resultants(self, line_load: FloatArray, problem: _Problem) -> FloatArray:
        """What a line load lacks of the given resultants [N/m]: its mean, and unless guided its first harmonic."""
        first = 0.5 * problem.first
        resultants = np.array([problem.mean, first.real, -first.imag][: len(self.rigid)])
        return resultants - self.rigid @ line_load / line_load.shape[-1]

    def step(
        self, tangent: FloatArray, residual: FloatArray, missing: FloatArray
    ) -> tuple[FloatArray, FloatArray] | None:
        """Change y of the line load and s of the rigid motion: y + t (C y - s) = off, with y's resultants given.

        With y = off + w q and w^2 = t it is (1 + w C w) q = w (s - C off): symmetric, and near to 1 where the
        interface gives way more than the bodies, so that a few products with the circulant C solve it.

        Parameters
        ----------
        tangent : ndarray, shape (m,)
            t = df/dD [N/m^2], zero where smooth surfaces are apart.
        residual : ndarray, shape (m,)
            [N/m]
        missing : ndarray
            Resultants of y, see `missing`.
        """
        from scipy.sparse.linalg import LinearOperator, minres

        w = np.sqrt(tangent)
        operator = LinearOperator(
            (len(w), len(w)), lambda q: q + w * self.opening(w * q.ravel()), dtype=float
        )
        answers = []
        for rhs in (-w * self.opening(residual), *(w * self.rigid)):
            q, info = minres(operator, rhs, rtol=_LINEAR_TOLERANCE, maxiter=_MOST_PRODUCTS)
            if info:
                return None
            answers.append(w * q)
        by_residual, by_motion = residual + answers[0], np.array(answers[1:])
        resultants = self.rigid @ by_motion.T / len(w)
        size = np.linalg.solve(resultants, missing - self.rigid @ by_residual / len(w))
        return by_residual + size @ by_motion, size @ self.rigid


class _Problem(NamedTuple):
    """The line load to be found: of contacts around a ring, closes a gap's change, has a mean and a first harmonic."""

    local: LocalContact
    ring: _Ring
    gap: FloatArray
    mean: float
    first: complex


def _solve_in_logarithms(problem: _Problem, start: FloatArray) -> Solution | None:
    """Newton's method in ln f, for a contact that never opens; None if it does not converge.

    Where the line load rises, a step is taken as log(1 + dv), so that the exponential cannot run away.
    """
    local, ring, gap, mean, _ = problem
    v = np.log(start)
    motion = np.full(len(gap), np.mean(local.approach(start)[0] + gap))
    for _ in range(_MAX_STEPS):
        f = np.exp(v)
        if f.min() < _LEAST_LOAD * mean:
            return None
        approach, decay = local.approach(f)
        residual = motion - ring.opening(f) - gap - approach
        missing_load = ring.missing_resultants(f, problem)
        if np.max(np.abs(residual) / decay) < _TOLERANCE and np.max(np.abs(missing_load)) < _TOLERANCE * mean:
            return f, approach
        tangent = f / decay
        change = ring.step(tangent, tangent * residual, missing_load)
        if change is None:
            return None
        y, rigid_step = change
        step = (residual + rigid_step - ring.opening(y)) / decay
        if not np.isfinite(step).all():
            return None
        step = np.where(step > 0, np.log1p(np.maximum(step, 0.0)), np.maximum(step, -_FALL))
        share = _solvable(local, v, step)
        v, motion = v + share * step, motion + share * rigid_step
    return None


def _solvable(local: LocalContact, v: FloatArray, step: FloatArray) -> float:
    """The largest share of a step in ln f whose line loads can be solved; ConvergenceError if that is none."""
    for share in _OF_STEP:
        try:
            local.approach(np.exp(v + share * step))
        except ConvergenceError:
            if share == _OF_STEP[-1]:
                raise
        else:
            break
    return share


def _solve_in_line_loads(problem: _Problem, start: FloatArray) -> Solution | None:
    """Newton's method for a line load that may be nothing at some places; None if it fails."""
    local, ring, gap, mean, _ = problem
    motion = np.full(len(gap), np.mean(local.approach(start)[0] + gap))
    balance = _Balance.of(problem, start, motion)
    for _ in range(_MAX_STEPS):
        if max(balance.largest_residual, balance.lacks) < _TOLERANCE * mean:
            return balance.line_load, balance.approach
        change = ring.step(balance.tangent, balance.residual, ring.missing_resultants(balance.guess, problem))
        if change is None or not (np.isfinite(change[0]).all() and np.isfinite(change[1]).all()):
            return None
        balance = balance.advance(*change, problem)
    return None


@dataclass(frozen=True)
class _Balance:
    """A guessed line load, and the one that the contacts have where it leaves the bodies [N/m]."""

    guess: FloatArray
    motion: FloatArray
    approach: FloatArray
    line_load: FloatArray
    tangent: FloatArray
    lacks: float
    """What the guess lacks of the given resultants [N/m]."""

    @classmethod
    def of(cls, problem: _Problem, guess: FloatArray, motion: FloatArray) -> _Balance:
        local, ring, gap, *_ = problem
        approach = motion - ring.opening(guess) - gap
        with np.errstate(over="ignore"):
            line_load, tangent = local.line_load(approach)
        if not (np.isfinite(line_load).all() and (tangent >= 0).all()):
            raise ConvergenceError(problem_of("around_no_bounds"))
        lacks = float(np.abs(ring.missing_resultants(guess, problem)).max())
        return cls(guess, motion, approach, line_load, tangent, lacks)

    @property
    def residual(self) -> FloatArray:
        return self.line_load - self.guess

    @property
    def largest_residual(self) -> float:
        return float(np.max(np.abs(self.residual)))

    @property
    def merit(self) -> float:
        """How far it is from balance [N/m]: root of the mean square, which a short step makes less."""
        worst = max(self.largest_residual, 1e-300)
        return math.hypot(worst * math.sqrt(np.mean((self.residual / worst) ** 2)), self.lacks)

    def advance(self, change: FloatArray, rigid_step: FloatArray, problem: _Problem) -> _Balance:
        """The balance after a step, or after the share of it that leads nearer."""
        best, failure = None, None
        for share in _OF_STEP:
            try:
                balance = _Balance.of(problem, self.guess + share * change, self.motion + share * rigid_step)
            except ConvergenceError as error:
                failure = error
                continue
            if balance.merit < self.merit:
                return balance
            if best is None or balance.merit < best.merit:
                best = balance
        if best is None:
            assert failure is not None  # of every share
            raise failure
        return best
