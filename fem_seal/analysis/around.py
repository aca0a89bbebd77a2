"""A load of a seal that is not round: line load, pressure and leak around the axis."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from scipy.interpolate import CubicSpline, PchipInterpolator

from fem_seal.analysis.flow import ProfileFlow
from fem_seal.arrays import FloatArray
from fem_seal.contact.around import line_load_around
from fem_seal.contact.local_contact import LocalContact
from fem_seal.contact.solution import ContactSolution
from fem_seal.contact.waves import Stiffening
from fem_seal.errors import OpenSealError
from fem_seal.form import FormError
from fem_seal.profile import PressureProfile
from leak import LeakResult

# Angles for each wave of the highest harmonic.
ANGLES_PER_WAVE = 64
# Harmonics of the line load above this share of its mean need the bodies' own answer, and the most of them.
_FELT, _MOST_HARMONICS = 1e-3, 40
# Line loads for each e-fold between which the leak rate is interpolated, and the fewest and most of them.
_PER_FOLD, _LINE_LOADS = 12, (12, 96)


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
    leak : LeakResult or None
        Of the whole circumference, scratches by their upper bound; its fluid pressure is that at the place where most
        leaks.
    scratches : tuple of float or None
        Least and largest leak rate that scratches and lay add [m^3/s]; None without any.
    """

    form: FormError
    local: LocalContact = field(repr=False)
    angle: FloatArray = field(repr=False)
    gap_change: FloatArray = field(repr=False)
    line_load: FloatArray = field(repr=False)
    approach: FloatArray = field(repr=False)
    leak_rate: FloatArray | None = field(default=None, repr=False)
    leak: LeakResult | None = field(default=None, repr=False)
    scratches: tuple[float, float] | None = None

    @property
    def most_loaded(self) -> ContactSolution:
        """The contact at the largest line load."""
        return self.local.at(float(self.line_load.max()))

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

    def with_leak(self, flow: ProfileFlow) -> Around:
        """The same with its leak.

        Parameters
        ----------
        flow : ProfileFlow

        Raises
        ------
        OpenSealError
            If smooth surfaces are apart somewhere: their interface law says nothing of the flow there.
        """
        if self.local.opens and self.least_over_mean == 0.0:
            apart = float(np.mean(self.line_load == 0.0))
            raise OpenSealError(
                f"the form error parts the surfaces over {100 * apart:.2g} % of the circumference, and with "
                '[interface] law = "smooth" nothing is known of the gap\'s roughness there; use law = "persson"'
            )
        found, place = np.unique(self.line_load, return_inverse=True)
        least = max(float(found[0]), 1e-250 * float(found[-1]))
        count = int(np.clip(_PER_FOLD * math.log(found[-1] / least), *_LINE_LOADS))
        few = len(found) <= count
        rungs = found if few else np.geomspace(least, found[-1], count)
        flows = [flow.leak(profile) for profile in self._profiles(rungs)]
        rates = np.array([flow.leak_rate for flow in flows])
        each = (rates if few else _between(rungs, rates, found))[place]
        scratches = self._scratches(flow) if self.form.grooves else None
        total = float(each.mean()) + (0.0 if scratches is None else scratches[1])
        return replace(self, leak_rate=each / (2 * math.pi), leak=_scaled(flows, total), scratches=scratches)

    def _scratches(self, flow: ProfileFlow) -> tuple[float, float]:
        """Least and largest leak rate that grooves add, each under the pressure where it lies [m^3/s]."""
        least = largest = 0.0
        for placed in self.form.grooves:
            low, high = flow.bounds(self.profile_at(placed.angle), [placed.groove]).extra
            least, largest = least + low, largest + high
        return least, largest

    def profile_at(self, angle: float | None) -> PressureProfile:
        """Pressure profile at an angle around the axis [rad], or at the mean line load."""
        f = (
            self.line_load.mean()
            if angle is None
            else np.interp(angle, self.angle, self.line_load, period=2 * math.pi)
        )
        return self._profiles(np.atleast_1d(f))[0]

    def _profiles(self, line_loads: FloatArray) -> list[PressureProfile]:
        mean = self.local.mean.profile
        fields = self.local.pressure_and_gap(line_loads, self.local.approach(line_loads)[0])
        return [replace(mean, pressure=p, gap=u) for p, u in zip(*fields, strict=True)]


def _between(rungs: FloatArray, rates: FloatArray, line_loads: FloatArray) -> FloatArray:
    """Leak rates at many line loads, interpolated between fewer; nothing from where they are sealed."""
    leaks = rates > 0
    if leaks.sum() < 2:
        return np.zeros_like(line_loads)
    # next to where it is sealed the leak rate falls too fast for a spline
    interpolator = CubicSpline if leaks.all() else PchipInterpolator
    curve = interpolator(np.log(rungs[leaks]), np.log(rates[leaks]))
    last = rungs[leaks][-1]
    with np.errstate(under="ignore"):
        found = np.exp(curve(np.log(np.clip(line_loads, rungs[0], last))))
    return np.where(line_loads <= last * (1 + 1e-12), found, 0.0)


def _scaled(flows: Sequence[LeakResult], leak_rate: float) -> LeakResult:
    """The flow with a leak rate; mass and pV flow go with it, the fluid pressure is that of the highest line load."""
    most = max(flows, key=lambda flow: flow.leak_rate)
    if not 0 < most.leak_rate < math.inf:
        return most
    share = leak_rate / most.leak_rate

    def times(value: float | None) -> float | None:
        return None if value is None else share * value

    return replace(
        most,
        leak_rate=leak_rate,
        resistance=most.resistance / share,
        mass_flow=times(most.mass_flow),
        throughput=times(most.throughput),
        standard_leak_rate=times(most.standard_leak_rate),
    )


def around(form: FormError, local: LocalContact) -> Around:
    """Line load around the axis of a seal with a form error.

    Parameters
    ----------
    form : FormError
        A tolerance is filled by the number of waves that hurts most.
    local : LocalContact
        At the mean line load, and at any other.

    Raises
    ------
    ConvergenceError
    """
    if form.tolerance is not None:
        return min(
            (around(form.with_waves(number), local) for number in form.tolerance.candidates),
            key=lambda one: one.least_over_mean,
        )
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
    gap, f, approach = (np.tile(values, repeats) for values in (gap, f, approach))
    return Around(form, local, _angles(size * repeats), gap, f, approach)


def _angles(number: int) -> FloatArray:
    return 2 * math.pi * np.arange(number) / number
