"""A load of a seal that is not round: line load, pressure and leak around the axis."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from scipy.interpolate import PchipInterpolator

from fem_seal.arrays import FloatArray
from fem_seal.contact.around import line_load_around
from fem_seal.contact.local_contact import LocalContact
from fem_seal.contact.waves import Stiffening
from fem_seal.form import FormError
from fem_seal.profile import PressureProfile

LeakOf = Callable[[PressureProfile], float]

# Angles for each wave of the highest harmonic.
ANGLES_PER_WAVE = 64
# Harmonics of the line load above this share of its mean need the bodies' own answer, and the most of them.
_FELT, _MOST_HARMONICS = 1e-3, 40
# Line loads between which the leak rate is interpolated, unless there are fewer.
_LINE_LOADS = 96


@dataclass(frozen=True, eq=False)
class Around:
    """A load around the axis of a seal that is not round.

    Parameters
    ----------
    form : FormError
        Its tolerance filled by a definite number of waves.
    local : LocalContact
        The axisymmetric contact at any line load.
    angle : ndarray, shape (m,)
        Uniform from 0 on [rad].
    gap_change : ndarray, shape (m,)
        What the form error adds to the gap [m].
    line_load : ndarray, shape (m,)
        f(phi) [N/m].
    approach : ndarray, shape (m,)
        Of closure and seat along the normal [m].
    leak_rate : ndarray, shape (m,), or None
        Of the fluid that flows straight across at each angle [m^3/s per radian]; None without roughness or fluid.
    """

    form: FormError
    local: LocalContact = field(repr=False)
    angle: FloatArray = field(repr=False)
    gap_change: FloatArray = field(repr=False)
    line_load: FloatArray = field(repr=False)
    approach: FloatArray = field(repr=False)
    leak_rate: FloatArray | None = field(default=None, repr=False)

    @property
    def least_over_mean(self) -> float:
        """Least line load over the mean."""
        return float(self.line_load.min() / self.line_load.mean())

    @property
    def most_over_mean(self) -> float:
        """Largest line load over the mean."""
        return float(self.line_load.max() / self.line_load.mean())

    @cached_property
    def peak_pressure(self) -> FloatArray:
        """Highest contact pressure at each angle [Pa]."""
        return self.local.peak_pressure(self.line_load)

    @cached_property
    def fwhm(self) -> FloatArray:
        """Full width at half maximum at each angle [m]."""
        return self.local.fwhm(self.line_load)

    def pressure_and_gap(self, step: int = 1) -> tuple[FloatArray, FloatArray]:
        """Pressure [Pa] and gap [m], (angles, points), at every `step`-th angle."""
        return self.local.pressure_and_gap(self.line_load[::step], self.approach[::step])

    def with_leak(self, leak_of: LeakOf) -> Around:
        """The same with its leak at each angle.

        Parameters
        ----------
        leak_of : callable
            Leak rate of the whole circumference under one profile [m^3/s].
        """
        found, place = np.unique(self.line_load, return_inverse=True)
        rates = (
            self._leak_rates(found, leak_of) if len(found) <= _LINE_LOADS else self._between(found, leak_of)
        )
        return replace(self, leak_rate=rates[place] / (2 * math.pi))

    def _between(self, line_loads: FloatArray, leak_of: LeakOf) -> FloatArray:
        """Leak rates at many line loads, increasing, interpolated between fewer; nothing from where they are sealed."""
        rungs = np.geomspace(line_loads[0], line_loads[-1], _LINE_LOADS)
        rates = self._leak_rates(rungs, leak_of)
        leaks = rates > 0
        if leaks.sum() < 2:
            return np.zeros_like(line_loads)
        curve = PchipInterpolator(np.log(rungs[leaks]), np.log(rates[leaks]))
        with np.errstate(under="ignore"):
            found = np.exp(curve(np.log(line_loads)))
        return np.where(line_loads <= rungs[leaks][-1], found, 0.0)

    def _leak_rates(self, line_loads: FloatArray, leak_of: LeakOf) -> FloatArray:
        mean = self.local.mean.profile
        fields = self.local.pressure_and_gap(line_loads, self.local.approach(line_loads)[0])
        return np.array([leak_of(replace(mean, pressure=p, gap=u)) for p, u in zip(*fields, strict=True)])


def around(form: FormError, local: LocalContact) -> Around:
    """Line load around the axis of a seal with a form error.

    Parameters
    ----------
    form : FormError
        Without a tolerance, or with one that is filled.
    local : LocalContact
        At the mean line load, and at any other.

    Raises
    ------
    ConvergenceError
    """
    mean, repeats = local.mean, form.symmetry
    size = ANGLES_PER_WAVE * max(form.highest // repeats, 1)
    if not form.felt:
        angle = _angles(size * repeats)
        even = np.full_like(angle, mean.line_load)
        return Around(form, local, angle, np.zeros_like(angle), even, local.approach(even)[0])
    gap = form.gap(_angles(size) / repeats)
    highest = max(max(one.waves for one in form.felt), 4 * repeats)
    while True:
        f, approach = line_load_around(
            local,
            Stiffening(mean.model, mean.pressure, highest),
            gap,
            mean.line_load,
            symmetry=repeats,
            guided=form.guided,
        )
        shares = np.abs(np.fft.rfft(f)) * 2 / (size * mean.line_load)
        felt = repeats * int(np.max(np.flatnonzero(shares > _FELT), initial=0))
        if felt <= highest or highest >= _MOST_HARMONICS * repeats:
            break
        highest = min(felt, _MOST_HARMONICS * repeats)
    whole = (np.tile(values, repeats) for values in (gap, f, approach))
    return Around(form, local, _angles(size * repeats), *whole)


def _angles(number: int) -> FloatArray:
    return 2 * math.pi * np.arange(number) / number
