"""Leak rate where the fluid in the gap carries part of the load: local closure, lift-off and blow-off."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from math import exp, inf, log
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import FloatArray
from leak.errors import ProfileError, positive
from leak.flow.contact_profile import ContactProfile, checked_ends, checked_profile, checked_side
from leak.flow.leak_rate import LogConductivity, SigmaOfPressure, by_log_pressure, leak_flow
from leak.flow.leak_result import LeakResult
from leak.fluids.properties import FlowPotential, PressureLaw
from leak.numerics.curves import cell_cubics, spline_slopes
from leak.numerics.roots import MOST_STEPS, bisect_roots, root_between, root_of_rising

# The outlet tail is left where p is this small a part of the pressure drop; p_f <= p there, so it is the error, too.
_TAIL_SHARE = 1e-10
# Steps of the first solution, which only places the steps of the following ones.
_FIRST_STEPS, _STEPS = 120, 400
_FINE_TAIL = 64
# Nodes per cell between which the largest pressure and the lift-off point are looked for.
_FINE = 8
# Alexander's second-order, L-stable rule: both of its stages are the same implicit equation.
_STAGE = 1.0 - np.sqrt(0.5)
_ROUGH, _CLOSE, _MOST_LOG_FLOW = 1e-3, 1e-7, 1e3
# Where p begins with a jump the fluid rises in a thin layer, which each path has in finer steps than the one before.
_MOST_PATHS, _PATH_TOLERANCE, _FIRST_SHARE = 8, 0.03, 0.03


@dataclass(frozen=True, eq=False)
class CoupledLeakResult(LeakResult):
    """Flow through a ring-shaped contact whose fluid carries part of the load.

    Examples
    --------
    >>> import leak
    >>> issubclass(leak.CoupledLeakResult, leak.LeakResult)
    True
    """

    contact_pressure: FloatArray
    """Pressure p - p_f on the asperities, zero where the fluid has lifted them off, shape (n,) [Pa]."""
    lift_off_x: float | None
    """Where p falls to the high fluid pressure on its side: beyond, the fluid has lifted the surfaces off each other;
    None if the profile ends before, or if the contact is blown open [m]."""
    blow_off_pressure: float
    """Largest fluid pressure that this profile holds, its peak pressure; from there on Q is infinite [Pa]."""


def coupled_leak_flow(
    x: ArrayLike,
    p: ArrayLike,
    conductivity: SigmaOfPressure | LogConductivity,
    pressure_drop: float,
    radius: ArrayLike,
    *,
    pressure_side: str = "outer",
    ends: tuple[float | None, float | None] | None = None,
    pressure_law: PressureLaw | None = None,
) -> CoupledLeakResult:
    """Leak rate with the fluid pressure taken off the load of the asperities, place by place.

    Solves dp_f/dx = (Q/(2 pi r))/sigma_eff(p(x) - p_f(x)) from the low side, p_f = 0, to p_f = Delta P, for Q. Where
    p_f >= p the asperities carry nothing and the gap does not resist. Unlike `leak_flow` the fluid pressure need not be
    small against p, and Q is more than proportional to Delta P.

    Parameters
    ----------
    x, p, conductivity, pressure_drop, radius, pressure_side, ends, pressure_law
        See `leak.leak_flow`; p is the total nominal pressure [Pa], asperities and fluid together.

    Returns
    -------
    CoupledLeakResult
        With leak_rate = inf and fluid_pressure = nan if `pressure_drop` is not below the blow-off pressure, and
        leak_rate = 0 if the contact stays sealed: if p - Delta P somewhere exceeds the sealing pressure.

    Raises
    ------
    ProfileError
        As `leak.leak_flow`, or if the flow does not settle.

    Notes
    -----
    The equation is that of the theory of leakage with p replaced by p - p_f. That the sum p stays what it was without
    fluid is a heuristic, good while p_f is small against p or where it varies slowly; the sound form solves the
    elastic bodies under both pressures.

    Integrated from the low side, the right-hand side falls with p_f: solutions approach each other, and there is
    exactly one for each Q. In the low-pressure flank, where p falls to zero, p_f stays below p by itself, because the
    gap opens as p_f comes close. In the high-pressure flank p_f meets p at the lift-off point, where p = Delta P;
    beyond it p_f = Delta P. Nothing is clipped. p_f at the lift-off point rises with Q up to the peak of p, so that Q
    exists, uniquely, for every Delta P below the peak: the blow-off pressure.

    Of a liquid that thickens, psi(p_f) (`leak.FlowPotential`) is integrated in place of p_f.

    Examples
    --------
    A uniform contact, 4 MPa over 1 mm, sigma = B/p; in closed form Q = (2 pi r B/W) ln(p/(p - Delta P)):

    >>> flat = [4e6, 4e6, 4e6]
    >>> result = coupled_leak_flow([0, 5e-4, 1e-3], flat, lambda p: 1e-9 / p, 2e6, 0.014)
    >>> print(f"{result.leak_rate:.4e} {2 * np.pi * 0.014 * 1e-9 / 1e-3 * np.log(2):.4e}")
    6.0972e-08 6.0972e-08
    """
    xs, ps, rs = checked_profile(x, p, radius)
    drop = positive(ProfileError, "pressure_drop", pressure_drop, "Pa")
    checked_side(pressure_side)
    if not callable(conductivity) and not isinstance(conductivity, LogConductivity):
        raise ProfileError(f"conductivity = {conductivity!r}: must be a function of p [m^3/(Pa s)]")
    if pressure_side == "inner":
        # Everything below has its low side at small x.
        low, high = checked_ends(ends)
        leak = coupled_leak_flow(
            -xs[::-1], ps[::-1], conductivity, drop, rs[::-1], ends=(-high, -low), pressure_law=pressure_law
        )
        lift = None if leak.lift_off_x is None else -leak.lift_off_x
        arrays = leak.fluid_pressure[::-1], leak.contact_pressure[::-1]
        return CoupledLeakResult(leak.leak_rate, leak.resistance, *arrays, lift, leak.blow_off_pressure)
    profile = ContactProfile.through(xs, ps, rs, checked_ends(ends))
    fine, log_p = _fine_profile(profile)
    blow_off = float(np.exp(log_p.max()))
    if drop >= blow_off:
        unknown = np.full(xs.shape, np.nan)
        return CoupledLeakResult(float("inf"), 0.0, unknown, np.zeros(xs.shape), None, blow_off)
    end, lift = _lift_off(profile, fine, log_p, np.log(drop))
    curve = ResistanceCurve.of(by_log_pressure(conductivity), float(log_p.max()))
    if blow_off - drop >= curve.sealing_pressure:
        # It drops over the sealed part, wherever in it: as without coupling.
        fluid = leak_flow(xs, ps, conductivity, drop, rs, ends=ends, pressure_law=pressure_law).fluid_pressure
        return CoupledLeakResult(0.0, float("inf"), fluid, np.maximum(ps - fluid, 0.0), lift, blow_off)
    # A step must end at the peak, or p_f could not rise to it.
    peak = float(fine[np.argmax(log_p)])
    first_points = np.union1d(_first_steps(profile, fine, log_p, np.log(_TAIL_SHARE * drop), end), peak)
    liquid = None if pressure_law is None else _ThickLiquid.of(FlowPotential.of(pressure_law, blow_off))
    path, total = _Path.of(profile, first_points, liquid), FlowPotential.of(pressure_law, drop).at_highest
    log_Q = _flow_for(drop, path, curve, path.guess(total, curve), _ROUGH)
    for _ in range(_MOST_PATHS):
        path = _Path.of(profile, np.union1d(_second_steps(path, log_Q, curve), peak), liquid)
        last_log_Q, log_Q = log_Q, _flow_for(drop, path, curve, log_Q, _CLOSE)
        if abs(log_Q - last_log_Q) < _PATH_TOLERANCE:
            break
    else:
        raise ProfileError(
            f"pressure_drop = {drop:.6g} Pa: the flow of a fluid that carries load is not found to "
            f"{100 * _PATH_TOLERANCE:g} %: it blows the contact all but off, seals it, or makes the liquid solid"
        )
    fluid = np.interp(xs, path.x, path.fluid_pressure(log_Q, curve)[0], left=0.0, right=drop)
    with np.errstate(over="ignore"):
        Q, resistance = float(np.exp(log_Q)), float(np.exp(np.log(drop) - log_Q))
    return CoupledLeakResult(Q, resistance, fluid, np.maximum(ps - fluid, 0.0), lift, blow_off)


# -------------------------------------------------------------------- the way of the fluid


@dataclass(frozen=True, eq=False)
class _Path:
    """Steps from the low side to the lift-off point."""

    x: FloatArray
    """Ends of the steps, shape (N + 1,) [m]."""
    pressures: list[tuple[float, float]]
    """p at both stages of each step [Pa]."""
    log_lengths: list[tuple[float, float]]
    """ln(_STAGE h/(2 pi r)) at both stages."""
    liquid: _ThickLiquid | None
    """None for a liquid that pressure does not change."""

    @classmethod
    def of(cls, profile: ContactProfile, x: FloatArray, liquid: _ThickLiquid | None) -> _Path:
        """Steps between the points x."""
        h = np.diff(x)
        stages = np.stack([x[:-1] + _STAGE * h, x[1:]], axis=1)
        p = np.exp(profile.log_pressure_anywhere(stages))
        length = _STAGE * h[:, None] / (2.0 * np.pi * profile.radius(stages))
        length[0, 1] /= _STAGE
        return cls(x, list(map(tuple, p.tolist())), list(map(tuple, np.log(length).tolist())), liquid)

    def fluid_pressure(self, log_Q: float, curve: ResistanceCurve) -> tuple[FloatArray, FloatArray]:
        """p_f and ln(p - p_f) at the ends of the steps for one flow, shape (N + 1,) [Pa]."""
        potential, log_rest = self.potential(log_Q, curve)
        if self.liquid is not None:
            potential = [self.liquid.pressure.at(y)[0] for y in potential]
        return np.array(potential), np.array(log_rest)

    def potential(self, log_Q: float, curve: ResistanceCurve) -> tuple[list[float], list[float]]:
        """psi(p_f) [Pa], which is p_f of a liquid that does not thicken, and ln(p - p_f) at the ends of the steps."""
        y, guess, liquid = 0.0, curve.first_node, self.liquid
        values, log_rest = [y], [guess]
        # The first step is Euler's: of a jump the first stage would give (1 - _STAGE)/_STAGE times the rise.
        weight = 0.0
        for (p1, p2), (length1, length2) in zip(self.pressures, self.log_lengths, strict=True):
            rise, guess = curve.rise(p1, y, log_Q + length1, guess, liquid)
            y += weight * rise
            rise, guess = curve.rise(p2, y, log_Q + length2, guess, liquid)
            y, weight = y + rise, (1.0 - _STAGE) / _STAGE
            values.append(y)
            log_rest.append(guess)
        return values, log_rest

    def guess(self, total_potential: float, curve: ResistanceCurve) -> float:
        """Rough ln Q: that of the same contact without coupling, each place as far as it conducts."""
        total = 0.0
        for (_, p), (_, length) in zip(self.pressures, self.log_lengths, strict=True):
            if p > 0.0:
                total += exp(min(curve.at(min(log(p), curve.last_node))[0] + length, 600.0))
        return log(total_potential) - log(total)


def _first_steps(
    profile: ContactProfile, fine: FloatArray, log_p: FloatArray, log_cut: float, end: float
) -> FloatArray:
    """Ends of the steps from where p rises above exp(log_cut) to x = end, even in x and in ln p."""
    x, tail = fine[fine < end], profile.tails[0]
    excess = float(log_p[0]) - log_cut
    if tail is not None and excess > 0.0:
        start = x[0] - tail.reach(excess)
        x = np.concatenate([np.linspace(start, x[0], _FINE_TAIL, endpoint=False), x])
    x = np.append(x, end)
    log_p = np.maximum(profile.log_pressure_anywhere(x), log_cut)
    x, log_p = (values[max(int(np.argmax(log_p > log_cut)) - 1, 0) :] for values in (x, log_p))
    way = np.diff(x) / (x[-1] - x[0]) + np.abs(np.diff(log_p)) / np.abs(np.diff(log_p)).sum().clip(1e-9)
    return _divide(x, way, _FIRST_STEPS)


def _second_steps(path: _Path, log_Q: float, curve: ResistanceCurve) -> FloatArray:
    """Steps over which place, fluid pressure and 1/u change evenly, closer together toward the lift-off point.

    There 1/sigma falls to zero like 1/ln^3(p - p_f), which no evenly spaced rule follows.
    """
    fluid, log_rest = path.fluid_pressure(log_Q, curve)
    resistance = np.array([curve.at(v)[0] for v in log_rest])
    resistance[0] = resistance[1]
    inverse_gap = np.exp((resistance - resistance.max()) / 3.0)
    to_end = np.cbrt(path.x[-1] - path.x)
    changes = [np.abs(np.diff(values)) for values in (path.x, fluid, inverse_gap, to_end)]
    return _divide(path.x, np.sum([change / max(change.sum(), 1e-300) for change in changes], axis=0), _STEPS)


def _divide(x: FloatArray, way: FloatArray, count: int) -> FloatArray:
    """Points between the first and the last x with equal parts of the way between them, and one close to the first."""
    total = np.append(0.0, np.cumsum(way))
    return np.interp(
        np.insert(np.linspace(0.0, total[-1], count + 1), 1, _FIRST_SHARE * total[-1] / count), total, x
    )


def _flow_for(drop: float, path: _Path, curve: ResistanceCurve, guess: float, tolerance: float) -> float:
    """ln Q at which p_f reaches `drop` at the end; guess is near."""

    def excess(log_Q: float) -> float:
        # psi of a liquid that thickens much is all but the same over the last of the drop
        end = path.potential(log_Q, curve)[0][-1]
        return (end if path.liquid is None else path.liquid.pressure.at(end)[0]) / drop - 1.0

    return root_of_rising(excess, -_MOST_LOG_FLOW, _MOST_LOG_FLOW, guess, tolerance)


# -------------------------------------------------------------------- the profile


def _fine_profile(profile: ContactProfile) -> tuple[FloatArray, FloatArray]:
    """Points in all cells and ln p there, with the largest value of the spline among them."""
    share = np.arange(_FINE) / _FINE
    x = np.append((profile.x[:-1, None] + np.diff(profile.x)[:, None] * share).ravel(), profile.x[-1])
    log_p = profile.log_pressure(x)
    k = int(np.clip(np.argmax(log_p), 1, x.size - 2))
    if np.all(np.isfinite(log_p[k - 1 : k + 2])):
        from scipy.optimize import minimize_scalar

        peak = minimize_scalar(
            lambda at: -float(profile.log_pressure(np.array([at]))[0]),
            bounds=(x[k - 1], x[k + 1]),
            method="bounded",
        )
        place = int(np.searchsorted(x, peak.x))
        x, log_p = np.insert(x, place, peak.x), np.insert(log_p, place, -peak.fun)
    return x, log_p


def _lift_off(
    profile: ContactProfile, x: FloatArray, log_p: FloatArray, log_drop: float
) -> tuple[float, float | None]:
    """End of the resisting part on the high side, and the lift-off point: None where the profile ends before."""
    last_point = int(np.flatnonzero(log_p > log_drop)[-1])
    tail = profile.tails[-1]
    if last_point == x.size - 1:
        if tail is None:
            return float(x[-1]), None
        distance = tail.reach(float(log_p[-1]) - log_drop)
        place = float(x[-1]) + distance
        return place, None if distance == tail.length else place

    def excess(at: float) -> float:
        return max(float(profile.log_pressure(np.array([at]))[0]), log_drop - 1.0) - log_drop

    place = root_between(excess, x[last_point], x[last_point + 1], xtol=1e-15 * abs(x[-1] - x[0]) + 1e-300)
    return place, place


# Table of ln(1/sigma) over ln p: spacing, how far below the largest pressure, and equal ratios of its difference from
# p_seal or the largest pressure above.
_SPACING, _RANGE = 0.05, 60.0
_NEAR_SEALING = 14.0
# A conductivity below this is none: toward the sealing pressure sigma underflows before it vanishes [m^3/(Pa s)].
_NONE = 1e-200
# Newton's error squares with each step.
_NEWTON_CLOSE = 1e-8
# Values of a liquid over pressure: the cubic between them is off by less than 1e-9 for thickening by e^10.
_PRESSURES = 401


@dataclass(frozen=True, eq=False)
class _Curve:
    """A curve asked number by number: cubic between nodes, straight beyond them."""

    nodes: list[float]
    """Increasing."""
    values: list[float]
    slopes: list[float]

    @classmethod
    def through(cls, nodes: FloatArray, values: FloatArray, slopes: FloatArray) -> Self:
        """Of arrays."""
        return cls(nodes.tolist(), values.tolist(), slopes.tolist())

    def at(self, x: float) -> tuple[float, float]:
        """Value and slope."""
        nodes = self.nodes
        if not nodes[0] < x < nodes[-1]:
            end = 0 if x <= nodes[0] else -1
            return self.values[end] + (x - nodes[end]) * self.slopes[end], self.slopes[end]
        k = bisect_right(nodes, x) - 1
        t = x - nodes[k]
        y0, d0, c2, c3 = self._cubics[k]
        return y0 + t * (d0 + t * (c2 + t * c3)), d0 + t * (2.0 * c2 + 3.0 * t * c3)

    @cached_property
    def _cubics(self) -> list[tuple[float, float, float, float]]:
        """Coefficients of the cubic in each cell over x less its lower node."""
        cubics = cell_cubics(np.diff(self.nodes), np.array(self.values), np.array(self.slopes))
        return list(map(tuple, cubics.T.tolist()))


class _ThickLiquid(NamedTuple):
    """p_f and psi of each other."""

    pressure: _Curve
    """p_f over psi."""
    potential: _Curve
    """psi over p_f."""

    @classmethod
    def of(cls, potential: FlowPotential) -> _ThickLiquid:
        p = np.linspace(0.0, potential.highest, _PRESSURES)
        psi, mobility = potential(p), potential.mobility(p)
        return cls(_Curve.through(psi, p, 1.0 / mobility), _Curve.through(p, psi, mobility))


@dataclass(frozen=True, eq=False)
class ResistanceCurve(_Curve):
    """ln(1/sigma_eff) over v = ln p: cubic between nodes; below them 1/sigma ~ u^-3 with u linear in v."""

    sealing_pressure: float = inf
    """From here on sigma is as good as zero; infinite if not in the table's range [Pa]."""

    @classmethod
    def of(cls, sigma: Callable[[FloatArray], FloatArray], log_p_max: float) -> ResistanceCurve:
        """Table of a conductivity given as a function of ln p, up to `log_p_max` or the sealing pressure."""
        v = np.linspace(log_p_max - _RANGE, log_p_max, int(_RANGE / _SPACING) + 1)
        flows = sigma(v) > _NONE
        high, sealing = log_p_max, inf
        if not flows.all():
            first = int(np.argmin(flows))
            _, (high,) = bisect_roots(
                lambda at: sigma(at) > _NONE, v[first - 1 : first], v[first : first + 1]
            )
            sealing = exp(high)
        near_sealing = high + np.log1p(-np.exp(-np.arange(1.0, _NEAR_SEALING, 0.1)))
        v = np.concatenate([v[v < near_sealing[0] - 0.5 * _SPACING], near_sealing])
        values = sigma(v)
        usable = np.isfinite(values) & (values > _NONE)
        v, G = v[usable], -np.log(values[usable])
        return replace(cls.through(v, G, np.maximum(spline_slopes(v, G), 1e-12)), sealing_pressure=sealing)

    @property
    def first_node(self) -> float:
        """First node."""
        return self.nodes[0]

    @property
    def last_node(self) -> float:
        """Last node below the sealing pressure; without one, the curve goes on."""
        return self.nodes[-1] if self.sealing_pressure < inf else inf

    def at(self, v: float) -> tuple[float, float]:
        """ln(1/sigma) and its derivative at v = ln p."""
        if v > self.nodes[0]:
            return super().at(v)
        s = self.slopes[0] / 3.0
        stretch = 1.0 + s * (self.nodes[0] - v)
        return self.values[0] - 3.0 * log(stretch), 3.0 * s / stretch

    def rise(
        self, p: float, psi: float, log_flow: float, guess: float, liquid: _ThickLiquid | None = None
    ) -> tuple[float, float]:
        """Rise a/sigma(w) of psi over a step, and ln w, w = p - p_f at its end: the pressure left for the asperities.

        Newton on ln[w + p_f(psi + a/sigma(w)) - p_f(psi)] = ln(room), room = p - p_f(psi), in v = ln w, where the left
        side rises; a step that leaves the bracket is halved. Of a liquid that does not thicken the left side is convex,
        too: from above Newton's method converges without overshooting. No room: no contact, no rise.

        Parameters
        ----------
        p : float
            [Pa]
        psi : float
            Before the step [Pa].
        log_flow : float
            ln a, a = Q dx/(2 pi r).
        guess : float
            Near ln w.
        liquid : _Thickening or None
            None for a liquid that pressure does not change, psi = p_f.
        """
        p_start, slope = (psi, 1.0) if liquid is None else liquid.pressure.at(psi)
        room = p - p_start
        if not room > 0.0:
            return 0.0, guess
        target = log(room)
        top = min(target, self.last_node)
        v, low, high = min(guess, top), -inf, top
        for _ in range(MOST_STEPS):
            G, dG = self.at(v)
            rise = exp(min(G + log_flow, 600.0))
            lift, steep = rise * slope, slope
            if liquid is not None:
                p_end, steep = liquid.pressure.at(psi + rise)
                # of a small rise the difference of two pressures would be all round-off
                lift = p_end - p_start if rise > 1e-12 * (psi + rise) else lift
            w = exp(v)
            excess = log(w + lift) - target
            low, high = (v, high) if excess < 0.0 else (low, v)
            next_v = min(v - excess * (w + lift) / (w + steep * rise * dG), top)
            if not low <= next_v <= high:
                next_v = 0.5 * (low + high) if low > -inf else min(v - 1.0, top)
            # of the last step, which is tiny, the slope is enough
            step, G, v = abs(next_v - v), G + dG * (next_v - v), next_v
            if step < _NEWTON_CLOSE:
                break
        w = exp(v) if v > -700.0 else 0.0
        rise = exp(min(G + log_flow, 600.0))
        # So little flows that w stays at the last node, next to the sealing pressure; or of two numbers that add up to
        # `room` the smaller one is the accurate one.
        if v == self.last_node < target or rise * slope > w:
            return (room - w if liquid is None else liquid.potential.at(p - w)[0] - psi), v
        return rise, v
