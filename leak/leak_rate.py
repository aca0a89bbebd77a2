"""The leak integral: how much fluid a pressure profile lets through."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from leak.errors import ProfileError, positive
from leak.gauss import gauss

FloatArray = NDArray[np.float64]

# Below this p is as good as zero: what lies beyond adds less than 1e-6 of the flow resistance.
_SMALLEST_LOG = -700.0
_CELL_NODES = 8
_TAIL_NODES = 96


@runtime_checkable
class LogConductivity(Protocol):
    """A conductivity that can also be asked by ln p, where p underflows."""

    def at_log_pressure(self, log_pressure: ArrayLike) -> FloatArray:
        """sigma_eff at ln(p/Pa) [m^3/(Pa s)]."""


SigmaOfPressure = Callable[[FloatArray], ArrayLike]


@dataclass(frozen=True, eq=False)
class LeakResult:
    """Flow through a ring-shaped contact."""

    leak_rate: float
    """Q [m^3/s]; zero where the contact is sealed."""
    resistance: float
    """Pressure drop over Q [Pa s/m^3]; infinite where sealed."""
    fluid_pressure: FloatArray
    """Fluid pressure above the low side at the points x of the profile, shape (n,) [Pa]."""


def leak_rate(
    x: ArrayLike,
    p: ArrayLike,
    conductivity: SigmaOfPressure | LogConductivity,
    pressure_drop: float,
    radius: ArrayLike,
) -> float:
    """Volume flow Q = Delta P / int dx/(2 pi r(x) sigma_eff(p(x))) through a contact pressure profile.

    The fluid pressure must be small against the contact pressure. Between the points ln p is a cubic spline; tails
    of p beyond the ends are continued as in `leak_flow`.

    Parameters
    ----------
    x : array_like
        Arc length across the contact, strictly increasing, shape (n,), n >= 3 [m].
    p : array_like
        Nominal contact pressure there, not negative, shape (n,) [Pa].
    conductivity : callable
        sigma_eff(p) of an array of pressures [m^3/(Pa s)], for example `ConductivityTable.at(viscosity)`.
    pressure_drop : float
        Fluid pressure difference Delta P [Pa].
    radius : float or array_like
        Distance from the axis r, one number or one per point [m].

    Returns
    -------
    float
        Q [m^3/s].

    Raises
    ------
    ProfileError
        The profile or another input cannot be used; the message says which value.

    References
    ----------
    Fischer et al., "Fluid leakage in metallic seals", eqs. (13)-(15).

    Examples
    --------
    A uniform contact of width 1 mm on a ring of radius 14 mm:

    >>> Q = leak_rate([0, 5e-4, 1e-3], [1e6, 1e6, 1e6], lambda p: 1e-15 + 0 * p, 2e6, 0.014)
    >>> print(f"{Q:.4e}")
    1.7593e-07
    """
    return leak_flow(x, p, conductivity, pressure_drop, radius).leak_rate


def leak_flow(
    x: ArrayLike,
    p: ArrayLike,
    conductivity: SigmaOfPressure | LogConductivity,
    pressure_drop: float,
    radius: ArrayLike,
    *,
    pressure_side: str = "outer",
) -> LeakResult:
    """Leak rate, flow resistance and fluid pressure along a contact pressure profile.

    Ends of the profile. Where p has reached zero the contact ends like a Hertzian one, p^2 being smooth. Where p
    is still positive and falling outward, ln p is continued by the parabola through the last three points (by the
    tangent, if that parabola bends upward) to infinity; both tails are part of the resistance. Where p does not fall
    outward the contact ends with its last point.

    Parameters
    ----------
    x, p, conductivity, pressure_drop, radius
        See `leak_rate`.
    pressure_side : {"outer", "inner"}
        Side of the high fluid pressure: larger or smaller x.

    Returns
    -------
    LeakResult
    """
    x_all, p_all, r_all = _checked_profile(x, p, radius)
    drop = positive(ProfileError, "pressure_drop", pressure_drop, "Pa")
    if pressure_side not in ("outer", "inner"):
        raise ProfileError(f"pressure_side = {pressure_side!r}: must be 'outer' or 'inner'")
    profile = _Profile.through(x_all, p_all, r_all)
    sigma = _by_log_pressure(conductivity)
    inner_tail, cells, outer_tail = _resistances(profile, sigma)
    total = inner_tail + float(cells.sum()) + outer_tail
    below = np.concatenate([[0.0], np.cumsum(cells)])
    if np.isinf(total):
        fraction_at_nodes = _sealed_fraction(inner_tail, cells, outer_tail)
    else:
        fraction_at_nodes = (inner_tail + below) / total
    fraction = np.interp(x_all, profile.x, fraction_at_nodes)
    if pressure_side == "inner":
        fraction = 1.0 - fraction
    return LeakResult(0.0 if np.isinf(total) else drop / total, total, drop * fraction)


# -------------------------------------------------------------------- the profile between its points


class _Tail(NamedTuple):
    """ln p = ln p_end - slope d - curvature d^2 at distance d outward of an end; curvature >= 0."""

    slope: float
    curvature: float


@dataclass(frozen=True, eq=False)
class _Profile:
    """The contact patch: points with p > 0, edges where p reaches zero, tails where it does not."""

    x: FloatArray
    """Edges of the cells [m]."""
    inside: FloatArray
    """Points with positive pressure, a stretch of `x` [m]."""
    log_p: FloatArray
    slope: FloatArray
    """d ln p/dx of the spline at `inside` [1/m]."""
    radius: Callable[[FloatArray], FloatArray]
    tails: tuple[_Tail | None, _Tail | None]

    @classmethod
    def through(cls, x: FloatArray, p: FloatArray, r: FloatArray) -> _Profile:
        positive_points = np.flatnonzero(p > np.exp(_SMALLEST_LOG))
        first, last = int(positive_points[0]), int(positive_points[-1])
        inside, log_p = x[first : last + 1], np.log(np.maximum(p[first : last + 1], np.exp(_SMALLEST_LOG)))
        before = _edge(inside, log_p, x[first - 1], 0) if first > 0 else None
        after = _edge(inside, log_p, x[last + 1], -1) if last + 1 < x.size else None
        tails = (
            _tail(inside, log_p, 0) if before is None else None,
            _tail(inside, log_p, -1) if after is None else None,
        )
        edges = np.concatenate([[] if before is None else [before], inside, [] if after is None else [after]])
        slope = _log_slopes(inside, log_p)

        def radius(at: FloatArray) -> FloatArray:
            out_below, out_above = np.minimum(at - x[0], 0.0), np.maximum(at - x[-1], 0.0)
            ends = (r[1] - r[0]) / (x[1] - x[0]), (r[-1] - r[-2]) / (x[-1] - x[-2])
            straight = np.interp(at, x, r) + ends[0] * out_below + ends[1] * out_above
            # A tail that runs far beyond the profile adds nothing there, whatever the radius; keep it positive.
            return np.maximum(straight, 0.5 * r.min())

        return cls(edges, inside, log_p, slope, radius, tails)

    def log_pressure(self, x: FloatArray) -> FloatArray:
        """ln p between the edges; -inf where p is zero."""
        if self.inside.size == 1:
            spline = np.full(x.shape, self.log_p[0])
        else:
            k = np.clip(np.searchsorted(self.inside, x, side="right") - 1, 0, self.inside.size - 2)
            h = self.inside[k + 1] - self.inside[k]
            t = np.clip((x - self.inside[k]) / h, 0.0, 1.0)
            d0, d1, rise = h * self.slope[k], h * self.slope[k + 1], self.log_p[k + 1] - self.log_p[k]
            spline = self.log_p[k] + t * (d0 + t * (3.0 * rise - 2.0 * d0 - d1 + t * (d0 + d1 - 2.0 * rise)))
        for end, edge in ((0, self.x[0]), (-1, self.x[-1])):
            if edge != self.inside[end]:
                share = np.clip((x - edge) / (self.inside[end] - edge), 0.0, 1.0)
                beyond = (x - self.inside[end]) * (edge - self.inside[end]) > 0.0
                with np.errstate(divide="ignore"):
                    root = self.log_p[end] + 0.5 * np.log(share)
                spline = np.where(beyond, root, spline)
        return spline


def _edge(x: FloatArray, log_p: FloatArray, zero: float, end: int) -> float:
    """Where p reaches zero between the last positive point and the first zero one: p^2 extrapolated."""
    if x.size < 3:
        return float(zero)
    order = slice(0, 3) if end == 0 else slice(-1, -4, -1)
    xs, squares = x[order], np.exp(2.0 * (log_p[order] - log_p[order].max()))
    span = zero - xs[0]
    parabola = np.polynomial.Polynomial.fit((xs - xs[0]) / span, squares, 2, domain=[-1, 1], window=[-1, 1])
    roots = parabola.roots()
    real = np.sort(roots[np.isreal(roots)].real) if roots.size else roots.real
    between = real[(real > 1e-3) & (real <= 1.0)]
    return float(xs[0] + span * between[0]) if between.size else float(zero)


def _tail(x: FloatArray, log_p: FloatArray, end: int) -> _Tail | None:
    """Continuation of a falling end by the parabola through its last three points, or by its tangent."""
    if x.size < 3:
        return None
    order = slice(0, 3) if end == 0 else slice(-1, -4, -1)
    d, fall = np.abs(x[order] - x[order][0]), log_p[order] - log_p[order][0]
    first, second = fall[1] / d[1], fall[2] / d[2]
    curvature = (second - first) / (d[2] - d[1])
    slope = first - curvature * d[1]  # inward slope of ln p at the end
    if slope <= 0.0:
        return None
    return _Tail(float(slope), float(max(-curvature, 0.0)))


def _log_slopes(x: FloatArray, log_p: FloatArray) -> FloatArray:
    """Slopes of the cubic spline of ln p."""
    from scipy.interpolate import CubicSpline

    if x.size < 3:
        return np.gradient(log_p, x) if x.size == 2 else np.zeros(1)
    return CubicSpline(x, log_p)(x, 1)


# -------------------------------------------------------------------- the integral


def _resistances(
    profile: _Profile, sigma: Callable[[FloatArray], FloatArray]
) -> tuple[float, FloatArray, float]:
    """int dx/(2 pi r sigma_eff) over the inner tail, each cell, and the outer tail [Pa s/m^3]."""
    t, w = gauss(_CELL_NODES)
    half = 0.5 * np.diff(profile.x)
    at = (profile.x[:-1] + half)[:, None] + half[:, None] * t
    resistance = _inverse(sigma(profile.log_pressure(at)), profile.radius(at))
    cells = (resistance * (half[:, None] * w)).sum(axis=1)
    tails = [0.0, 0.0]
    for side, outward in ((0, -1.0), (1, 1.0)):
        tail = profile.tails[side]
        if tail is not None:
            tails[side] = _tail_resistance(profile, tail, side, outward, sigma)
    return tails[0], cells, tails[1]


def _tail_resistance(
    profile: _Profile, tail: _Tail, side: int, outward: float, sigma: Callable[[FloatArray], FloatArray]
) -> float:
    """Resistance from an end to infinity, over d = scale t/(1-t): 1/u^3 falls at least like d^-3."""
    t, w = gauss(_TAIL_NODES)
    t, w = 0.5 * (1.0 + t), 0.5 * w
    # Distance over which ln p falls by about ten: that of u_eff by several decay lengths.
    scale = 10.0 / (0.5 * tail.slope + np.sqrt(0.25 * tail.slope**2 + 10.0 * tail.curvature))
    d = scale * t / (1.0 - t)
    end = -side
    log_p = profile.log_p[end] - tail.slope * d - tail.curvature * d**2
    x = profile.inside[end] + outward * d
    return float(np.sum(_inverse(sigma(log_p), profile.radius(x)) * w * scale / (1.0 - t) ** 2))


def _inverse(sigma: FloatArray, radius: FloatArray) -> FloatArray:
    with np.errstate(divide="ignore"):
        return 1.0 / (2.0 * np.pi * radius * sigma)


def _sealed_fraction(inner_tail: float, cells: FloatArray, outer_tail: float) -> FloatArray:
    """Fraction of the pressure drop at the cell edges when part of the contact is sealed: it drops there alone."""
    parts = np.isinf(np.concatenate([[inner_tail], cells, [outer_tail]])).astype(float)
    return (np.cumsum(parts) / parts.sum())[:-1]


def _by_log_pressure(conductivity: SigmaOfPressure | LogConductivity) -> Callable[[FloatArray], FloatArray]:
    """sigma_eff as a function of ln p; infinite where p underflows and the callable only knows p."""
    if isinstance(conductivity, LogConductivity):
        return conductivity.at_log_pressure

    def sigma(log_p: FloatArray) -> FloatArray:
        usual = log_p > _SMALLEST_LOG
        p = np.exp(np.where(usual, log_p, 0.0))
        # In the tails p is tiny: a power law in it may overflow to infinity, which is what it should be.
        with np.errstate(over="ignore", divide="ignore"):
            values = np.broadcast_to(np.asarray(conductivity(p), dtype=float), p.shape)
        wrong = usual & ~(values >= 0.0)
        if np.any(wrong):
            raise ProfileError(
                f"conductivity({p[wrong].flat[0]}) = {values[wrong].flat[0]}: must not be negative [m^3/(Pa s)]"
            )
        return np.where(usual, values, np.inf)

    return sigma


# -------------------------------------------------------------------- input


def _checked_profile(
    x: ArrayLike, p: ArrayLike, radius: ArrayLike
) -> tuple[FloatArray, FloatArray, FloatArray]:
    try:
        xs, ps, rs = (np.asarray(values, dtype=float) for values in (x, p, radius))
    except (TypeError, ValueError) as error:
        raise ProfileError(f"x, p and radius must be arrays of numbers: {error}") from None
    if xs.ndim != 1 or xs.shape != ps.shape:
        raise ProfileError(f"x has shape {xs.shape}, p has shape {ps.shape}: both must be (n,)")
    if xs.size < 3:
        raise ProfileError(f"x has {xs.size} points: at least 3 are needed")
    if rs.shape not in ((), xs.shape):
        raise ProfileError(f"radius has shape {rs.shape}: must be one number or {xs.shape} like x")
    for name, unit, values in (("x", "m", xs), ("p", "Pa", ps)):
        bad = np.flatnonzero(~np.isfinite(values))
        if bad.size:
            raise ProfileError(f"{name}[{bad[0]}] = {values[bad[0]]}: must be finite [{unit}]")
    steps = np.flatnonzero(np.diff(xs) <= 0.0)
    if steps.size:
        i = int(steps[0])
        raise ProfileError(f"x[{i + 1}] = {xs[i + 1]} follows {xs[i]}: must strictly increase [m]")
    if np.any(ps < 0.0):
        i = int(np.flatnonzero(ps < 0.0)[0])
        raise ProfileError(f"p[{i}] = {ps[i]}: must not be negative [Pa]")
    if not np.any(ps > np.exp(_SMALLEST_LOG)):
        raise ProfileError("p is zero everywhere: there is no contact")
    rs = np.broadcast_to(rs, xs.shape)
    if not np.all((rs > 0.0) & np.isfinite(rs)):
        raise ProfileError(
            f"radius = {rs[~((rs > 0.0) & np.isfinite(rs))][0]}: must be positive and finite [m]"
        )
    return xs, ps, rs
