"""The axisymmetric contact as a function of line load, for each angle of a seal that is not round.

It is solved at a ladder of line loads, as far up and down as is asked for, and interpolated over ln f between them. Far
below the mean a rough contact only fades: its pressure keeps its shape and its approach falls by a constant for each
e-fold. Smooth surfaces part at a definite approach instead.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from fem_seal.contact.laws import HardContact, Law
from fem_seal.contact.newton import ContactProblem, solve, solve_many
from fem_seal.contact.solution import ContactSolution
from fem_seal.errors import ConvergenceError
from fem_seal.files import problem

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

    from fem_seal.arrays import FloatArray
    from fem_seal.profile import PressureProfile

# Step of the ladder in ln f, and degree of the spline over it: of the slope of the approach it leaves 1e-6, a cubic one
# left 2e-5 (tests/fem_seal/contact/test_around.py compares it with contacts in between). What is uneven from
# node to node, the width of a contact and all of smooth surfaces, has a cubic one.
_STEP, _DEGREE, _DEGREE_UNEVEN = 0.3, 5, 3
# Where the next rung is looked for: a polynomial through one to three rungs, the nearest first.
_EXTRAPOLATIONS = ((1.0,), (2.0, -1.0), (3.0, -3.0, 1.0))
# Rungs beyond what is asked for, so that a spline has no end there, and the fewest below the mean.
_EXTRA_RUNGS, _FEWEST = 2, 3
# Highest line load over the mean, and lowest of a smooth interface, where the contact gets narrower than its mesh.
_HIGHEST_LOAD, _LOWEST_SMOOTH = math.log(60.0), math.log(1e-2)
# A contact whose approach over ln f changes its slope by less than this share from rung to rung only fades.
_FADING_SHARE = 1e-6
# Ends of a first ladder where nobody knows the line loads yet, and of what counts as a load at all, in ln f over mean.
_FIRST_LOWEST, _FIRST_HIGHEST, _NO_LOAD = math.log(1e-2), math.log(4.0), -600.0
_POLISH = 4
# What counts as the mean line load, in ln f over it.
_LOAD_ACCURACY = 1e-12
# Part of the relative curvature by which a gap is bent to see what that does to the peak.
_BEND = 0.005


@dataclass(eq=False)
class LocalContact:
    """The contact of a seal over the line load.

    Parameters
    ----------
    mean : ContactSolution
        At the mean line load. Fluid and press fit act everywhere as they do there.
    law : Law
    neighbour : LocalContact, optional
        The same of another contact between the same points that is close to this one: where its rungs are looked for.
    """

    mean: ContactSolution
    law: Law
    neighbour: LocalContact | None = field(default=None, repr=False)
    openings: dict[int, FloatArray] = field(default_factory=dict, repr=False)
    """By how much more the gap opens under each harmonic than under an even line load [m per N/m], see `Stiffening`."""
    _rungs: dict[int, ContactSolution] = field(default_factory=dict, repr=False)
    _fades_below: float = field(default=-math.inf, repr=False)
    _splines: dict[str, BSpline] = field(default_factory=dict, repr=False)
    _profiles: dict[float, PressureProfile] = field(default_factory=dict, repr=False)

    @property
    def opens(self) -> bool:
        """Whether the surfaces part at a definite approach; rough ones never quite do."""
        return isinstance(self.law, HardContact)

    @property
    def touch_approach(self) -> float:
        """Approach along the normal at which smooth surfaces touch [m]."""
        line = self.mean.model.line
        gap = line.initial_gap + self.mean.loads.opening(self.mean.model)
        return float(np.min(gap / line.normal[1])) * self.mean.model.touch_normal_z

    def approach(self, line_load: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Approach along the normal [m] and its derivative over ln f [m].

        Parameters
        ----------
        line_load : ndarray, shape (m,)
            f [N/m], positive.
        """
        v = self._over_mean(line_load)
        if not self.opens:
            return self._approach(v)
        # over ln f the logarithm of the depth is nearly a straight line, as the depth of Hertz's contact is
        spline, at = (self._spline("depth", lambda c: math.log(self._depth(c))), np.maximum(v, self._low_end))
        slope = spline(at, 1)
        with np.errstate(under="ignore"):
            depth = np.exp(spline(at) + (v - at) * slope)
        return self.touch_approach + depth, depth * slope

    def _approach(self, v: FloatArray) -> tuple[FloatArray, FloatArray]:
        spline, at = (self._spline("approach", self._along_normal), np.maximum(v, self._low_end))
        slope = spline(at, 1)
        return spline(at) + (v - at) * slope, slope

    def line_load(self, approach: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Line load [N/m] at an approach along the normal [m], and its derivative [N/m^2].

        Parameters
        ----------
        approach : ndarray, shape (m,)
            Where smooth surfaces are apart they carry nothing.
        """
        from scipy.interpolate import PchipInterpolator

        self._climb(self._lowest_rung, _FIRST_HIGHEST)
        while self._rung_approach(max(self._rungs)) < float(np.max(approach)):
            self._climb(self._lowest_rung, (max(self._rungs) + 1) * _STEP)
        if self.opens:
            return self._smooth_line_load(approach)
        rungs = np.array(sorted(self._rungs))
        curve = PchipInterpolator([self._rung_approach(k) for k in rungs.tolist()], _STEP * rungs)
        low = self._low_end
        at = np.maximum(approach, self._spline("approach", self._along_normal)(low))
        v = curve(at)
        for _ in range(_POLISH):
            reached_approach, slope = self._approach(v)
            v = v + (approach - reached_approach) / slope
        _, slope = self._approach(v)
        f = self.mean.line_load * np.exp(np.maximum(v, _NO_LOAD))
        return f, f / slope

    def _smooth_line_load(self, approach: FloatArray) -> tuple[FloatArray, FloatArray]:
        """The same of smooth surfaces; over the depth ln f is a straight line but for a logarithm."""
        from scipy.interpolate import CubicSpline

        rungs, touch = np.array(sorted(self._rungs)), self.touch_approach
        depth = np.log([self._depth(self._rungs[k]) for k in rungs.tolist()])
        touches = approach > touch
        g = np.where(touches, approach - touch, 1.0)
        curve = CubicSpline(depth, _STEP * rungs)
        at = np.maximum(np.log(g), depth[0])
        slope = curve(at, 1)
        f = np.where(touches, self.mean.line_load * np.exp(curve(at) + (np.log(g) - at) * slope), 0.0)
        return f, f * slope / g

    def peak_pressure(self, line_load: FloatArray, bend: FloatArray | float = 0.0) -> FloatArray:
        """Highest pressure [Pa] at line loads [N/m]; zero where there is none.

        Parameters
        ----------
        line_load : ndarray, shape (m,)
            [N/m]
        bend : ndarray, shape (m,), or float
            By how much the gap is bent there beside its own curvature, in x^2 [1/m]; to first order, and not of smooth
            surfaces, whose peaks are no better than their mesh.
        """
        log_peak = self._logarithm(
            "peak", line_load, lambda c: math.log(c.profile.peak_pressure), fade_in=1.0
        )
        if np.any(bend) and not self.opens and math.isfinite(self.mean.model.relative_radius):
            v = np.maximum(self._over_mean(line_load), self._low_end)
            log_peak = log_peak + bend * self._spline("bent")(v)
        with np.errstate(under="ignore"):
            return np.where(line_load > 0, np.exp(log_peak), 0.0)

    def fwhm(self, line_load: FloatArray) -> FloatArray:
        """Full width at half maximum [m] at line loads [N/m]; zero where there is none."""
        log_fwhm = self._logarithm("fwhm", line_load, lambda c: math.log(c.profile.fwhm), fade_in=0.0)
        with np.errstate(under="ignore"):
            return np.where(line_load > 0, np.exp(log_fwhm), 0.0)

    def pressure_and_gap(self, line_load: FloatArray, approach: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Pressure [Pa] and gap [m] at the points of the contact line, both (m, points).

        Parameters
        ----------
        line_load : ndarray, shape (m,)
            [N/m]
        approach : ndarray, shape (m,)
            Along the normal [m]; it counts where smooth surfaces are apart.
        """
        if isinstance(self.law, HardContact):
            return self._hard_profiles(line_load, approach)
        log_pressure = self._logarithm(
            "pressure", line_load, lambda c: np.maximum(c.log_pressure, _NO_LOAD), fade_in=1.0
        )
        with np.errstate(under="ignore"):
            return np.exp(log_pressure), self.law.gap(log_pressure)

    @property
    def at_mean(self) -> ContactSolution:
        """The contact at the mean line load, which needs no ladder."""
        self._solve(0)
        return self._rungs[0]

    def _is_mean(self, line_load: float) -> bool:
        return abs(line_load / self.mean.line_load - 1.0) < _LOAD_ACCURACY

    @property
    def mean_approach(self) -> float:
        """Approach along the normal at the mean line load [m]."""
        return self._along_normal(self.at_mean)

    def profile(self, line_load: float) -> PressureProfile:
        """Profile on first loading, which all readings of the surfaces share.

        Parameters
        ----------
        line_load : float
            [N/m]
        """
        return self.profiles([line_load])[0]

    def profiles(self, line_loads: Sequence[float]) -> list[PressureProfile]:
        """`profile` of several line loads [N/m]."""
        profiles, mean = self._profiles, self.mean.profile
        new = [f for f in line_loads if f not in profiles and not self._is_mean(f)]
        if new:
            f = np.array(new)
            for load, p, gap in zip(new, *self.pressure_and_gap(f, self.approach(f)[0]), strict=True):
                profiles[load] = replace(mean, pressure=p, gap=gap, largest=None)
        for f_mean in [f for f in line_loads if f not in profiles]:
            contact = self.at_mean
            profiles[f_mean] = replace(mean, pressure=contact.pressure, gap=contact.gap, largest=None)
        return [profiles[f] for f in line_loads]

    def _hard_profiles(self, line_load: FloatArray, approach: FloatArray) -> tuple[FloatArray, FloatArray]:
        """The profiles of smooth surfaces end at another place for each line load: nothing to interpolate."""
        line = self.mean.model.line
        initial_gap = line.initial_gap + self.mean.loads.opening(self.mean.model)
        pressure = np.zeros((len(line_load), len(line.x)))
        gap = initial_gap - approach[:, None] / self.mean.model.touch_normal_z * line.normal[1]
        contacts: dict[float, ContactSolution] = {}
        for n in np.flatnonzero(line_load > 0).tolist():
            f = float(f"{line_load[n]:.9g}")
            if f not in contacts:
                contacts[f] = self.at(f)
            pressure[n], gap[n] = contacts[f].pressure, contacts[f].gap
        return pressure, gap

    def at(self, line_load: float) -> ContactSolution:
        """The contact at a line load [N/m], solved there."""
        if self._is_mean(line_load):
            return self.at_mean
        v = float(self._over_mean(np.array([line_load]))[0])
        k = min(self._rungs, key=lambda k: abs(_STEP * k - v))
        start, force = self._rungs[k], self.mean.contact_force * line_load / self.mean.line_load
        return solve(start.model, self.law, contact_force=force, loads=start.loads, start=start)

    def _logarithm(
        self,
        name: str,
        line_load: FloatArray,
        log_of: Callable[[ContactSolution], float | FloatArray],
        fade_in: float,
    ) -> FloatArray:
        """A logarithm between those on the rungs.

        Parameters
        ----------
        fade_in : float
            The power of the line load with which it goes below the ladder of a rough contact. What smooth surfaces
            have, whose contact gets narrower, goes on below the ladder as it does on it.
        """
        v = self._over_mean(line_load)
        spline, at = self._spline(name, log_of), np.maximum(v, self._low_end)
        values = spline(at)
        distance = (v - at).reshape(-1, *(1,) * (values.ndim - 1))
        power = (spline(0.0) - spline(self._low_end)) / -self._low_end if self.opens else fade_in
        return np.asarray(values + power * distance)

    def _over_mean(self, line_load: FloatArray) -> FloatArray:
        """ln f over the mean; the ladder reaches there."""
        with np.errstate(divide="ignore"):
            v = np.maximum(np.log(np.asarray(line_load) / self.mean.line_load), _NO_LOAD)
        self._climb(self._lowest_rung if self.opens else float(v.min()), float(v.max()))
        return v

    @property
    def _lowest_rung(self) -> float:
        return _LOWEST_SMOOTH if self.opens else _FIRST_LOWEST

    @property
    def _low_end(self) -> float:
        """ln f over the mean below which everything is extrapolated."""
        return max(self._fades_below, _STEP * (min(self._rungs) + (0 if self.opens else 1)))

    def _depth(self, contact: ContactSolution) -> float:
        """How far smooth surfaces are pressed beyond the approach at which they touch [m]."""
        return self._along_normal(contact) - self.touch_approach

    @staticmethod
    def _along_normal(contact: ContactSolution) -> float:
        return contact.approach * contact.model.touch_normal_z

    def _climb(self, lowest: float, highest: float) -> None:
        """Solve the rungs from `lowest` to `highest` ln f over the mean, unless they fade before."""
        if highest > _HIGHEST_LOAD:
            raise ConvergenceError(problem("local_load", times=math.exp(highest)))
        count = len(self._rungs)
        top = max(math.ceil(highest / _STEP), 0) + _EXTRA_RUNGS
        bottom = min(math.floor(lowest / _STEP) - (0 if self.opens else _EXTRA_RUNGS), -_FEWEST)
        if self.neighbour is not None:
            # what it cannot bear this one may
            with suppress(ConvergenceError):
                self.neighbour._climb(lowest, highest)
            self._solve(*(k for k in self.neighbour._rungs if bottom <= k <= top))
        for k in range(top + 1):
            self._solve(k)
        k, fade = 0, -math.inf if self.opens else self._fades_below
        while k > bottom and (_STEP * k > fade or k > -_FEWEST):
            k -= 1
            self._solve(k)
            if not self.opens and _STEP * k > fade and self._fades(k):
                self._fades_below = fade = _STEP * (k + 1)
        if len(self._rungs) > count:
            self._splines.clear()

    def _solve(self, *rungs: int) -> None:
        new = [k for k in rungs if k not in self._rungs]
        if not new:
            return
        model, loads, force = self.mean.model, self.mean.loads, self.mean.contact_force
        contacts = self._press(
            [
                ContactProblem(model, self.law, force * math.exp(_STEP * k), loads, start=self._guess_rung(k))
                for k in new
            ]
        )
        self._rungs.update(zip(new, contacts, strict=True))

    @staticmethod
    def _press(problems: Sequence[ContactProblem]) -> list[ContactSolution]:
        outcomes = solve_many(problems)
        for outcome in outcomes:
            if isinstance(outcome, ConvergenceError):
                raise outcome
        return outcomes  # type: ignore[return-value]

    def _guess_rung(self, k: int) -> ContactSolution:
        """Where the solution of a rung is looked for.

        As far from the mean as the rung of a contact near this one, or where a polynomial through the rungs before it
        goes.
        """
        if self.neighbour is not None and k in self.neighbour._rungs and not self.opens:
            rung, mean = self.neighbour._rungs[k], self.neighbour.mean
            return replace(
                self.mean,
                log_pressure=self.mean.log_pressure + (rung.log_pressure - mean.log_pressure),
                approach=self.mean.approach + (rung.approach - mean.approach),
            )
        inwards = -1 if k > 0 else 1
        places = [k + n * inwards for n in range(1, len(_EXTRAPOLATIONS) + 1)]
        rungs = [self._rungs[place] for place in places if place in self._rungs]
        if self.opens or not rungs:
            return rungs[0] if rungs else self.mean
        weights = np.array(_EXTRAPOLATIONS[len(rungs) - 1])
        return replace(
            rungs[0],
            log_pressure=weights @ np.stack([contact.log_pressure for contact in rungs]),
            approach=float(weights @ np.array([contact.approach for contact in rungs])),
        )

    def _bend_peaks(self, contacts: Sequence[ContactSolution]) -> list[float]:
        """Change of ln p_peak of contacts for each 1/m by which the gap is bent [m]."""
        line, bend = self.mean.model.line, _BEND / self.mean.model.relative_radius
        bent_line = replace(line, initial_gap=line.initial_gap + bend * line.x**2)
        model = replace(self.mean.model, line=bent_line)
        bent_contacts = self._press(
            [ContactProblem(model, self.law, c.contact_force, c.loads, start=c) for c in contacts]
        )
        peaks = [[contact.profile.peak_pressure for contact in group] for group in (bent_contacts, contacts)]
        return [math.log(bent_peak / peak) / bend for bent_peak, peak in zip(*peaks, strict=True)]

    def _fades(self, k: int) -> bool:
        first, second, third = (self._rung_approach(k + n) for n in range(3))
        return abs((second - first) - (third - second)) < _FADING_SHARE * abs(third - second)

    def _rung_approach(self, k: int) -> float:
        return self._along_normal(self._rungs[k])

    def _spline(
        self, name: str, of: Callable[[ContactSolution], float | FloatArray] | None = None
    ) -> BSpline:
        if name not in self._splines:
            from scipy.interpolate import make_interp_spline

            rungs = sorted(self._rungs)
            contacts = [self._rungs[k] for k in rungs]
            self._splines[name] = make_interp_spline(
                _STEP * np.array(rungs),
                np.array(self._bend_peaks(contacts) if of is None else [of(contact) for contact in contacts]),
                _DEGREE_UNEVEN if self.opens or name == "fwhm" else _DEGREE,
            )
        return self._splines[name]
