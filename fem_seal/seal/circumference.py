"""A load of a seal that is not round: line load, pressure and leak around the axis."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.polynomial import Chebyshev

from fem_seal.contact.around import Stiffening, line_load_around
from fem_seal.errors import OpenSealError
from fem_seal.files import problem
from fem_seal.form import Wave
from fem_seal.profile import PressureProfile

if TYPE_CHECKING:
    from fem_seal.arrays import FloatArray
    from fem_seal.bolts import BoltCircle
    from fem_seal.contact.local_contact import LocalContact
    from fem_seal.contact.solution import ContactSolution
    from fem_seal.form import FormError
    from fem_seal.seal.leak_model import ProfileLeak
    from leak import LeakBounds, LeakResult

# Angles for each wave of the highest harmonic; a moment or bolts, which may lift one side, count as so many waves.
ANGLES_PER_WAVE, _OF_MOMENT = 64, 4
# Highest harmonic of bolts, and the share of the largest gap below which the next ones are none: what a force moves
# below it falls steeply with its waves.
_MOST_OF_BOLTS, _LEAST_OF_BOLTS = 64, 1e-4
# Harmonics to which the bodies are asked, of a form that repeats itself in units of its period; beyond them they answer
# as half-spaces do (two waves: 5e-5 of the line load, 50 random ones: 3e-4). A wave is strong with this share of all
# amplitudes.
_PERIODS, _HARMONICS, _STRONG = 3, 12, 0.05
# Leak rates are interpolated in a range of ln f whose ends are multiples of the first number and which is no wider than
# the second: by a polynomial through so many line loads and one, if it gives the same to the last numbers (of the leak
# rate itself, and of its ratio to the conductivity) without its highest degree, and to five times as much without the
# highest two, of which one may be none by chance. Mostly that leaves 1e-6, of 250 leak rates 4e-5 at most, also next to
# sealing; what all but seals may count as sealed (asked at every angle).
_ENDS, _WIDEST, _PARTS, _AGREE, _AGREE_OF_RATIO = 0.125, 8.0, (4, 8, 16), 4e-4, 1e-4
_OF_TWO = 0.2
# Their variable is this power of f, over which ln Q bends least.
_POWER = 0.25
# Else, and where places are sealed: between line loads with these steps in ln f, the coarse one far below the mean,
# where the surfaces stand apart; so many of the fine steps reach there, and so many lie beyond what is asked for.
_STEP, _COARSE_STEP, _FINE, _EXTRA_RUNGS = 0.125, 2.0, 48, 2
# What is left of a leak rate after a larger load is interpolated between line loads with these steps in ln f; less than
# so much of it is none.
_LATTICE, _NO_FLOW = 0.25, 1e-30
# What counts as no line load, and as an even one, in ln f over the mean.
_NO_LOAD, _EVEN = -500.0, 1e-12


@dataclass(frozen=True, eq=False)
class Circumference:
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
    bend : ndarray, shape (m,)
        By how much the waving part of the line load bends the gap across the width, in x^2 [1/m].
    tilt : Wave or None
        Of the gap, by a closure that tilts until the contact carries the given moment; None without one.
    bolts_gap : ndarray, shape (m,), or None
        What bolts one by one would add to the gap if the contact did not even it out, without the tilt [m].
    leak_rate : ndarray, shape (m,), or None
        Of the fluid that flows straight across at each angle [m^3/s per radian]; None without roughness or fluid.
    leak : LeakResult or None
        Of the whole circumference, scratches by their upper bound; its fluid pressure is that at the place where most
        leaks.
    bounds : tuple of LeakBounds
        Of scratches and lay, one by one; of a contact without its leak, none.
    before : Circumference or None
        The same form under the largest load before; None where none is known.
    """

    form: FormError
    local: LocalContact = field(repr=False)
    angle: FloatArray = field(repr=False)
    gap_change: FloatArray = field(repr=False)
    line_load: FloatArray = field(repr=False)
    approach: FloatArray = field(repr=False)
    bend: FloatArray = field(repr=False)
    tilt: Wave | None = None
    bolts_gap: FloatArray | None = field(default=None, repr=False)
    leak_rate: FloatArray | None = field(default=None, repr=False)
    leak: LeakResult | None = field(default=None, repr=False)
    bounds: tuple[LeakBounds[Any], ...] = field(default=(), repr=False)
    before: Circumference | None = field(default=None, repr=False)

    @property
    def scratches(self) -> tuple[float, float] | None:
        """Least and largest leak rate that scratches and lay add [m^3/s]; None without any."""
        if not self.bounds:
            return None
        least, largest = zip(*(bound.extra for bound in self.bounds), strict=True)
        return sum(least), sum(largest)

    @property
    def extremes(self) -> tuple[ContactSolution, ...]:
        """The contacts at the largest line load, now and under the largest load before."""
        return (self.most_loaded,) if self.before is None else (self.most_loaded, self.before.most_loaded)

    @cached_property
    def most_loaded(self) -> ContactSolution:
        """The contact at the largest line load."""
        return self.local.at(float(self.line_load.max()))

    @property
    def moved_gap(self) -> FloatArray:
        """What form error, bolts and tilt add to the gap [m]."""
        tilt = 0.0 if self.tilt is None else self.tilt.at(self.angle)
        return self.gap_change + tilt + (0.0 if self.bolts_gap is None else self.bolts_gap)

    @property
    def tilt_angle(self) -> float:
        """Of the closure's top against the bottom of the seat, without a shift, under a moment [rad]."""
        model = self.local.mean.model
        lever = model.initial_contact_radius * model.touch_normal_z
        return 0.0 if self.tilt is None else self.tilt.amplitude / lever

    @property
    def over_mean(self) -> FloatArray:
        """Line load over its mean, shape (m,)."""
        return self.line_load / self.line_load.mean()

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
        return self.local.peak_pressure(self.line_load, self.bend)

    @property
    def fwhm(self) -> FloatArray:
        """Full width at half maximum at each angle [m]."""
        return self.local.fwhm(self.line_load)

    def pressure_and_gap(self, step: int = 1) -> tuple[FloatArray, FloatArray]:
        """Pressure [Pa] and gap [m], (angles, points), at every `step`-th angle."""
        return self.local.pressure_and_gap(self.line_load[::step], self.approach[::step])

    def profiles(self, step: int = 1) -> list[PressureProfile]:
        """Profile at every `step`-th angle, with what it remembers."""
        pressures, gaps = self.pressure_and_gap(step)
        mean = replace(self.local.mean.profile, largest=None)
        profiles = [replace(mean, pressure=p, gap=gap) for p, gap in zip(pressures, gaps, strict=True)]
        if self.before is None:
            return profiles
        pairs = zip(profiles, self.before.profiles(step), strict=True)
        return [profile.after(larger.pressure) for profile, larger in pairs]

    def with_leak(self, curve: LeakCurve) -> Circumference:
        """The same with its leak.

        Parameters
        ----------
        curve : LeakCurve
            Of the same local contact.

        Raises
        ------
        OpenSealError
            If smooth surfaces are apart somewhere: their interface law says nothing of the flow there.
        """
        if self.local.opens and self.least_over_mean == 0.0:
            share = float(np.mean(self.line_load == 0.0))
            raise OpenSealError(problem("parted", share=share))
        rates, most = curve.leak_rates(self.line_load, self.before)
        bounds = tuple(
            curve.flow.bounds(self.profile_at(groove.angle), [groove.groove]) for groove in self.form.grooves
        )
        total = float(rates.mean()) + sum(bound.largest_extra for bound in bounds)
        if bounds and not most.leak_rate > 0:
            # nothing flows through the roughness, but along the grooves
            most = max((bound.upper for bound in bounds), key=lambda bound: bound.leak_rate).above_outlet
        return replace(self, leak_rate=rates / (2 * math.pi), leak=most.scaled(total), bounds=bounds)

    def profile_at(self, angle: float | None) -> PressureProfile:
        """Pressure profile at an angle around the axis [rad], or at the mean line load."""
        f = (
            self.line_load.mean()
            if angle is None
            else np.interp(angle, self.angle, self.line_load, period=2 * math.pi)
        )
        profile = self.local.profile(float(f))
        return profile if self.before is None else profile.after(self.before.profile_at(angle).pressure)


@dataclass(eq=False)
class LeakCurve:
    """Leak rate of a contact over its line load, worked out where it is asked for.

    Parameters
    ----------
    local : LocalContact
    flow : ProfileLeak
    """

    local: LocalContact
    flow: ProfileLeak
    _flows: dict[float, LeakResult] = field(default_factory=dict, repr=False)
    _flows_after_load: dict[tuple[float, float], LeakResult] = field(default_factory=dict, repr=False)

    def leak_rates(
        self, line_load: FloatArray, before: Circumference | None = None
    ) -> tuple[FloatArray, LeakResult]:
        """Leak rate of the whole circumference at line loads [N/m], (m,) [m^3/s], and the flow where most leaks.

        Parameters
        ----------
        line_load : ndarray, shape (m,)
            [N/m]
        before : Circumference, optional
            Under the largest load before, at the same angles; always the same mean line load.
        """
        first, most = self._rates_of_new_faces(line_load)
        if before is None:
            return first, most
        share, most = self._remaining_share(line_load, before)
        return first * share, most

    def _remaining_share(self, line_load: FloatArray, before: Circumference) -> tuple[FloatArray, LeakResult]:
        """What is left of the leak rate of first loading at each angle, and the flow where most leaks.

        It is a smooth function of the line load now and of how far the one before was above it, and one where it was
        not: interpolated on a lattice in the logarithms of both.
        """
        loads = ((line_load, self.local.mean), (before.line_load, before.local.mean))
        with np.errstate(divide="ignore"):
            v, v_before = (np.maximum(np.log(load / mean.line_load), -_FINE * _STEP) for load, mean in loads)
        apart = math.log(before.local.mean.line_load / self.local.mean.line_load)
        at = np.stack([v, np.maximum(v_before + apart - v, 0.0)]) / _LATTICE
        below = np.floor(at)
        log_share, flows = np.zeros(line_load.shape), []
        for corner in product((0.0, 1.0), repeat=2):
            step = np.array(corner)[:, None]
            weight = np.prod(np.where(step == 1.0, at - below, 1.0 - (at - below)), axis=0)
            places, place_of = np.unique((below + step) * _LATTICE, axis=1, return_inverse=True)
            pairs = ((a, a + above - apart) for a, above in places.T.tolist())
            corner_flows = [self._flow_after_load(*pair, before.local) for pair in pairs]
            firsts = [self._flow_at(float(f)).leak_rate for f in places[0]]
            shares = [
                flow.leak_rate / first if first > 0 else 1.0
                for flow, first in zip(corner_flows, firsts, strict=True)
            ]
            log_share += weight * np.log(np.maximum(shares, _NO_FLOW))[place_of.ravel()]
            flows += corner_flows
        return np.exp(log_share), max(flows, key=lambda flow: flow.leak_rate)

    def _flow_after_load(self, log_share: float, log_before: float, before: LocalContact) -> LeakResult:
        if (log_share, log_before) not in self._flows_after_load:
            profile, larger = (
                local.profile(local.mean.line_load * math.exp(v))
                for local, v in ((self.local, log_share), (before, log_before))
            )
            self._flows_after_load[log_share, log_before] = self.flow.leak(profile.after(larger.pressure))
        return self._flows_after_load[log_share, log_before]

    def _rates_of_new_faces(self, line_load: FloatArray) -> tuple[FloatArray, LeakResult]:
        mean = self.local.mean.line_load
        with np.errstate(divide="ignore"):
            v = np.maximum(np.log(line_load / mean), _NO_LOAD)
        if np.ptp(v) < _EVEN:
            flow = self._flow_at(float(v[0]))
            return np.full(len(v), flow.leak_rate), flow
        lowest, highest = float(v.min()), float(v.max())
        wide_range = _ENDS * math.floor(lowest / _ENDS), _ENDS * math.ceil(highest / _ENDS)
        # rounded ranges are those of other forms as well, but may reach to where it is sealed
        for low, high in (wide_range, (lowest, highest)):
            smooth_rates = self._polynomial_rates(low, high, v)
            if smooth_rates is not None:
                return smooth_rates, self._flow_at(low)
        rungs = _rungs(float(v.min()), float(v.max()))
        flows = self._flows_at(rungs)
        rates = np.array([flow.leak_rate for flow in flows])
        return _interpolate_rates(np.array(rungs), rates, v), max(flows, key=lambda flow: flow.leak_rate)

    def _polynomial_rates(self, low: float, high: float, v: FloatArray) -> FloatArray | None:
        """Leak rates at v by a polynomial in a range of ln f; None if there is none that is good enough.

        What is interpolated is the leak rate, or next to sealing its ratio to sigma_eff at the highest pressure, which
        knows where it would be sealed.
        """
        if high - low > _WIDEST or not self._flow_at(high).leak_rate > 0:
            return None
        first, last, at = (np.exp(_POWER * log_f) for log_f in (low, high, v))
        for parts in _PARTS:
            places = first + (last - first) * np.array(_shares(parts))
            rungs = np.array([low, *np.log(places[1:-1]) / _POWER, high])
            log_rates = np.log([flow.leak_rate for flow in self._flows_at(rungs.tolist())])
            off, rates = _polynomials(places, log_rates, at)
            if off < _AGREE:
                return rates
            at_rungs, at_v = self._log_conductivity(rungs), self._log_conductivity(v)
            if np.isfinite(at_rungs).all():
                off, rates = _polynomials(places, log_rates - at_rungs, at, at_v)
                if off < _AGREE_OF_RATIO:
                    return rates
        return None

    def _log_conductivity(self, v: FloatArray) -> FloatArray:
        """ln of sigma_eff at the highest pressure, at line loads in ln f over the mean."""
        peak = self.local.peak_pressure(self.local.mean.line_load * np.exp(v))
        with np.errstate(divide="ignore"):
            return np.log(self.flow.conductivity(peak))

    def _flow_at(self, log_share: float) -> LeakResult:
        return self._flows_at([log_share])[0]

    def _flows_at(self, log_shares: Sequence[float]) -> list[LeakResult]:
        """Flows at line loads, in ln f over the mean."""
        new = [v for v in log_shares if v not in self._flows]
        profiles = self.local.profiles([self.local.mean.line_load * math.exp(v) for v in new])
        self._flows.update(zip(new, map(self.flow.leak, profiles), strict=True))
        return [self._flows[v] for v in log_shares]


def _polynomials(
    places: FloatArray, y: FloatArray, at: FloatArray, base: FloatArray | float = 0.0
) -> tuple[float, FloatArray]:
    """exp of the polynomial through y plus what is known, and its mean change without the highest degrees."""
    degree = len(places) - 1
    through = Chebyshev.fit(places, y, degree, (float(places[0]), float(places[-1])))
    values = np.exp(base + through(at))
    lower_degrees = (np.exp(base + through.truncate(degree + 1 - n)(at)) for n in (1, 2))
    first, second = (float(np.abs(rates - values).mean() / values.mean()) for rates in lower_degrees)
    return max(first, _OF_TWO * second), values


def _shares(parts: int) -> list[float]:
    """Places from 0 to 1 through which polynomials do not swing; every other one is a place of half as many parts."""
    return [0.5 - 0.5 * math.cos(math.pi * (n / parts)) for n in range(parts + 1)]


def _rungs(lowest: float, highest: float) -> list[float]:
    """Places in ln f over the mean, the same whatever the range, some of them beyond it."""
    top = math.ceil(highest / _STEP) + _EXTRA_RUNGS
    fine = [_STEP * k for k in range(max(math.floor(lowest / _STEP), -_FINE) - _EXTRA_RUNGS, top + 1)]
    below = math.floor((fine[0] - lowest) / _COARSE_STEP) + _EXTRA_RUNGS if lowest < fine[0] else 0
    return [fine[0] - _COARSE_STEP * k for k in range(below, 0, -1)] + fine


def _interpolate_rates(rungs: FloatArray, rates: FloatArray, v: FloatArray) -> FloatArray:
    """Leak rates interpolated over ln f; nothing from where they are sealed."""
    from scipy.interpolate import CubicSpline, PchipInterpolator

    leaks = rates > 0
    if leaks.sum() < 2:
        return np.zeros_like(v)
    # next to where it is sealed the leak rate falls too fast for a spline
    interpolator = CubicSpline if leaks.all() else PchipInterpolator
    curve, last = interpolator(rungs[leaks], np.log(rates[leaks])), rungs[leaks][-1]
    with np.errstate(under="ignore"):
        return np.where(v <= last, np.exp(curve(np.minimum(v, last))), 0.0)


def solve_both_around(
    form: FormError, local: LocalContact, before: LocalContact | None, start: Circumference | None = None
) -> Circumference:
    """`solve_around`, and with it the same form under the largest load before.

    Parameters
    ----------
    form : FormError
    local : LocalContact
    before : LocalContact or None
        Under the larger load; None where none is known.
    start : Circumference, optional
        See `solve_around`.

    Raises
    ------
    ConvergenceError
    """
    circumference = solve_around(form, local, start)
    if before is None:
        return circumference
    # bolts are tightened, and springs set, before something bends the seal, and without fluid
    bolts = form.bolts and replace(form.bolts, force=before.mean.pressing_force)
    form_before = replace(circumference.form, moment=0.0, bolts=bolts)
    angles = len(circumference.angle) if form.moment or bolts else None
    # the waves that fill a tolerance are not known beforehand
    start_before = start.before if start is not None and form.tolerance is None else None
    return replace(circumference, before=solve_around(form_before, before, start_before, angles))


def solve_around(
    form: FormError, local: LocalContact, start: Circumference | None = None, angles: int | None = None
) -> Circumference:
    """Line load around the axis of a seal with a form error.

    Parameters
    ----------
    form : FormError
        A tolerance is filled by the number of waves that hurts most.
    local : LocalContact
        At the mean line load, and at any other.
    start : Circumference, optional
        Of a form error with the same waves, whose line load is close: where this one is looked for.
    angles : int, optional
        In the whole turn; as many as the form needs, in each of its periods, unless given.

    Raises
    ------
    ConvergenceError
    OpenSealError
        If the moment tips the closure over: it passes the circle of first touch.
    """
    if form.tolerance is not None:
        return min(
            (solve_around(form.with_waves(number), local) for number in form.tolerance.candidates),
            key=lambda circumference: circumference.least_over_mean,
        )
    mean, repeats = local.mean, 1 if angles else form.symmetry
    uneven_force = _OF_MOMENT if form.moment or form.bolts else 1
    bolts = 0 if form.bolts is None else min(len(form.bolts.angles), _HARMONICS)
    size = angles or ANGLES_PER_WAVE * max(max(form.highest, bolts) // repeats, uneven_force)
    if not form.uneven:
        angle = _angles(size * repeats)
        mean_load = np.full_like(angle, mean.line_load)
        zero = np.zeros_like(angle)
        return Circumference(
            form, local, angle, zero, mean_load, np.full_like(angle, local.mean_approach), zero
        )
    r0 = mean.model.initial_contact_radius
    # f_1, of M = pi r0^2 n_z f_1
    moment = form.carried_moment
    first = moment / (math.pi * r0**2 * mean.model.touch_normal_z)
    if abs(first) >= 2.0 * mean.line_load:
        raise OpenSealError(
            problem("tipped", moment=abs(moment), force=mean.contact_force, most=mean.contact_force * r0)
        )
    gap = form.gap(_angles(size) / repeats)
    stiffening = Stiffening(mean.model, mean.pressure, _highest_harmonic(form), repeats, local.openings)
    bolts_gap = None if form.bolts is None else _gap_of_bolts(form.bolts, stiffening, size)
    f, approach = line_load_around(
        local,
        stiffening,
        gap if bolts_gap is None else gap + bolts_gap,
        mean.line_load,
        symmetry=repeats,
        guided=form.guided,
        first=first,
        start=None if start is None else mean.line_load * start.over_mean[:size],
    )
    modes = np.fft.rfft(f)
    free = repeats == 1 and not (form.guided or moment)
    felt = range(2 if free else 1, stiffening.highest // repeats + 1)
    bends = np.zeros_like(modes)
    for n in felt:
        bends[n] = stiffening.bend(n * repeats) * modes[n]
    bend = np.fft.irfft(bends, size)
    tilt = None
    if moment:
        # of h = d n_z - D - (c_1 - c_0) f_1
        phasor = -2.0 / size * (np.fft.rfft(approach)[1] + stiffening(1) * modes[1])
        tilt = Wave(1, abs(phasor), -float(np.angle(phasor)))
    gap, f, approach, bend = (np.tile(values, repeats) for values in (gap, f, approach, bend))
    bolts_gap = None if bolts_gap is None else np.tile(bolts_gap, repeats)
    return Circumference(form, local, _angles(size * repeats), gap, f, approach, bend, tilt, bolts_gap)


def _gap_of_bolts(bolts: BoltCircle, stiffening: Stiffening, size: int) -> FloatArray:
    """What bolts add to the gap at the angles of one period, by harmonics from the second on [m], shape (size,).

    The mean is the load of the round seal, and the first a moment, which tilts the closure until the contact has it.
    """
    modes, period = np.zeros(size // 2 + 1, dtype=complex), stiffening.period
    largest = 0.0
    for n in range(period if period > 1 else 2, min(_MOST_OF_BOLTS, period * (size // 2 - 1)) + 1, period):
        # of bolts that repeat themselves more often than the form most harmonics are none
        force = bolts.wave(n) if n % bolts.period == 0 else 0j
        if not force:
            continue
        closing = stiffening.closing(n, bolts.radius)
        modes[n // period] = -0.5 * size * force * closing
        largest = max(largest, 2.0 * bolts.force * abs(closing))
        if 2.0 * bolts.force * abs(closing) < _LEAST_OF_BOLTS * largest:
            break
    return np.fft.irfft(modes, size)


def _highest_harmonic(form: FormError) -> int:
    """Highest harmonic of the line load to which the bodies' own answer is calculated."""
    total = sum(abs(wave.amplitude) for wave in form.felt_waves)
    strong = max((w.waves for w in form.felt_waves if abs(w.amplitude) > _STRONG * total), default=1)
    return max(_PERIODS * form.symmetry if form.symmetry > 1 else _HARMONICS, strong)


def _angles(number: int) -> FloatArray:
    return 2 * math.pi * np.arange(number) / number
