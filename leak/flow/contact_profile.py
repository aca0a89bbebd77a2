"""A contact pressure profile between and beyond its points: spline of ln p, edges, tails, quadrature."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import LARGEST_LOG, BoolArray, FloatArray, IntArray
from leak.errors import ProfileError, as_arrays, check_each, check_order
from leak.flow.conductivity import RemembersLoad
from leak.numerics.curves import cubic_spline_slopes
from leak.numerics.integrals import gauss, sorted_unique

# Faces that go on for ever.
NO_ENDS = (-np.inf, np.inf)
# Below this ln(p/Pa) p is as good as zero: what lies beyond adds less than 1e-6 of the flow resistance.
SMALLEST_LOG_PRESSURE = -LARGEST_LOG
_SMALLEST_PRESSURE = float(np.exp(SMALLEST_LOG_PRESSURE))
# ln p by which the spline may leave the range of two neighbouring points: near a peak that falls between them.
_OVERSHOOT = 0.1
# The last points stand for what is left of a face that ends within this share of the distance over three of them.
_NEAR_END = 0.5
# ln p by which p may rise there: more is no profile but scatter.
_STEEPEST_RISE = 1.0
# Nodes of a cell's quadrature; fewer where points lie close. Half as many are good to 1e-10 where ln p rises by less
# than this from one point to the next, at the highest pressure: far below it, where little resists, by more.
_CELL_NODES, _CLOSE_NODES = 8, 4
_CLOSE, _FURTHER = 0.5, 4.0
# Shares of a cell at which a cubic is looked at.
_CHECK_SHARES = np.linspace(0.125, 0.875, 7)
_TAIL_NODES = 96
# A law less bent than this is an exponential: its tail is the parabola of ln p, whatever the bend.
_STRAIGHT = 1e-3


class Tail(NamedTuple):
    """What grows beyond an end: the gap, by f = slope d + curvature d^2 decay lengths; slope > 0, curvature >= 0.

    Of an exponential law ln p = ln p_end - f; in general ln p = ln p_end - f - bend f^2.
    """

    slope: float
    curvature: float
    length: float = np.inf
    """Distance at which a face ends, and the contact with it [m]."""
    bend: float = 0.0
    """Of ln p over the gap, not negative: what the tail of Gaussian heights has."""

    def fall(self, d: FloatArray) -> FloatArray:
        """ln p_end - ln p at distances d; infinite beyond the end of the face."""
        growth = d * (self.slope + self.curvature * d)
        return np.where(d <= self.length * (1.0 + 1e-9), growth * (1.0 + self.bend * growth), np.inf)

    def reach(self, fall: float) -> float:
        """Distance at which ln p has fallen by `fall`, or the face ends [m]."""
        growth = 2.0 * fall / (1.0 + float(np.sqrt(1.0 + 4.0 * self.bend * fall)))
        root = float(np.sqrt(self.slope**2 + 4.0 * self.curvature * growth))
        return min(2.0 * growth / (self.slope + root), self.length)


@dataclass(frozen=True, eq=False)
class Panels:
    """Gauss points over stretches of the contact, increasing in x; arrays (stretches, points)."""

    log_pressure: FloatArray
    """ln(p/Pa)."""
    radius: FloatArray
    """r [m]."""
    stretch: FloatArray
    """dx/ds, s running from 0 to 1 along the stretch [m]."""
    log_equivalent: FloatArray
    """ln of the pressure at which new faces let as much through, see `ContactProfile.log_equivalent`."""


@dataclass(frozen=True, eq=False)
class Patch:
    """A stretch of points with p > 0: a cubic of ln p in each cell, and a root of p^2 where it ends at zero."""

    x: FloatArray
    """Points [m]."""
    log_p: FloatArray
    slopes: FloatArray
    """d ln p/dx at the left and right end of each cell, shape (2, n - 1) [1/m]."""
    ends: tuple[float, float]
    """Where the patch begins and ends: its first and last point, or the place where p reaches zero [m]."""

    @classmethod
    def through(cls, x: FloatArray, log_p: FloatArray, zeros: tuple[float | None, float | None]) -> Patch:
        """Patch through points, with the neighbouring points of zero pressure if there are any."""
        ends = [
            x[end] if zero is None else _edge(x, log_p, zero, end)
            for end, zero in zip((0, -1), zeros, strict=True)
        ]
        return cls(x, log_p, _cell_slopes(x, log_p), (float(ends[0]), float(ends[1])))

    def log_pressure(self, x: FloatArray) -> FloatArray:
        """ln p between the ends; -inf where p is zero."""
        if self.x.size == 1:
            spline = np.full(x.shape, self.log_p[0])
        else:
            k = self.x[1:-1].searchsorted(x, side="right")
            h = self.x[k + 1] - self.x[k]
            t = np.minimum(np.maximum((x - self.x[k]) / h, 0.0), 1.0)
            rise = self.log_p[k + 1] - self.log_p[k]
            spline = self.log_p[k] + _hermite(t, h * self.slopes[0, k], h * self.slopes[1, k], rise)
        for end, edge in zip((0, -1), self.ends, strict=True):
            if edge != self.x[end]:
                share = np.clip((x - edge) / (self.x[end] - edge), 0.0, 1.0)
                is_beyond = (x - self.x[end]) * (edge - self.x[end]) > 0.0
                with np.errstate(divide="ignore"):
                    root = self.log_p[end] + 0.5 * np.log(share)
                spline = np.where(is_beyond, root, spline)
        return spline


@dataclass(frozen=True, eq=False)
class ContactProfile:
    """All of the contact: patches with p > 0, open stretches between them, tails where p does not reach zero."""

    patches: tuple[Patch, ...]
    x: FloatArray
    """Edges of the cells [m]."""
    radii: tuple[FloatArray, FloatArray]
    """x and r of the points [m]."""
    tails: tuple[Tail | None, Tail | None]
    remembers: Callable[[FloatArray, FloatArray], FloatArray] | None = None
    """ln p* of first loading over x and ln p, of a contact that was pressed harder before."""

    @classmethod
    def through(
        cls,
        x: FloatArray,
        p: FloatArray,
        r: FloatArray,
        ends: tuple[float, float] = NO_ENDS,
        bends: tuple[float, float] = (0.0, 0.0),
    ) -> ContactProfile:
        """The contact through points as `checked_profile` returns them, on faces with ends as `checked_ends` does.

        `bends` are those of the law at either end, see `law_bends`.

        Points of zero pressure between others separate the contact into patches: the gap there is open, and the
        resistances of the patches add. A face that ends next to the last point carries the contact up to its end.
        """
        x, p, r = _up_to_ends(x, p, r, ends)
        runs = _group_points(p > _SMALLEST_PRESSURE)
        patches = tuple(
            Patch.through(
                x[run],
                np.log(p[run]),
                (
                    float(x[run[0] - 1]) if run[0] > 0 else None,
                    float(x[run[-1] + 1]) if run[-1] + 1 < x.size else None,
                ),
            )
            for run in runs
        )
        first, last = patches[0], patches[-1]
        tails = (
            _tail(first.x, first.log_p, 0, x[0] - ends[0], bends[0]) if runs[0][0] == 0 else None,
            _tail(last.x, last.log_p, -1, ends[1] - x[-1], bends[1]) if runs[-1][-1] == x.size - 1 else None,
        )
        is_single = len(patches) == 1 and first.ends == (first.x[0], first.x[-1])
        edges = (
            first.x
            if is_single
            else sorted_unique(np.concatenate([part for patch in patches for part in (patch.ends, patch.x)]))
        )
        return cls(patches, edges, (x, r), tails)

    @property
    def log_p(self) -> FloatArray:
        """ln p at the points with p > 0."""
        return np.concatenate([patch.log_p for patch in self.patches])

    def radius(self, at: FloatArray) -> FloatArray:
        """r(x), straight between points and beyond them [m]."""
        x, r = self.radii
        out_below, out_above = np.minimum(at - x[0], 0.0), np.maximum(at - x[-1], 0.0)
        ends = (r[1] - r[0]) / (x[1] - x[0]), (r[-1] - r[-2]) / (x[-1] - x[-2])
        straight = np.interp(at, x, r) + ends[0] * out_below + ends[1] * out_above
        # A tail that runs far beyond the profile adds nothing there, whatever the radius; keep it positive.
        return np.maximum(straight, 0.5 * r.min())

    def log_pressure(self, x: FloatArray) -> FloatArray:
        """ln p between the edges; as good as zero pressure between the patches."""
        log_p = np.full(x.shape, SMALLEST_LOG_PRESSURE)
        for patch in self.patches:
            log_p = np.where((x >= patch.ends[0]) & (x <= patch.ends[1]), patch.log_pressure(x), log_p)
        return log_p

    def log_pressure_anywhere(self, x: FloatArray) -> FloatArray:
        """ln p inside and in the tails; -inf beyond an edge."""
        log_p = self.log_pressure(x)
        for end, outward in ((0, -1.0), (-1, 1.0)):
            tail, d = self.tails[end], outward * (x - self.x[end])
            if tail is not None:
                log_p = np.where(d > 0.0, self.log_p[end] - tail.fall(d), log_p)
        return log_p

    def after_load(self, harder: ContactProfile, memory: RemembersLoad) -> ContactProfile:
        """The same contact after a load that pressed some of its places harder.

        Parameters
        ----------
        harder : ContactProfile
            The largest pressure before.
        memory : RemembersLoad
            What it leaves behind.
        """

        def remembers(x: FloatArray, log_p: FloatArray) -> FloatArray:
            return memory.first_loading(log_p, np.maximum(harder.log_pressure_anywhere(x), log_p))

        return replace(self, remembers=remembers)

    def log_equivalent(self, x: FloatArray, log_p: FloatArray) -> FloatArray:
        """ln p* of first loading that lets as much through as p at x, p itself where nothing larger is remembered."""
        return log_p if self.remembers is None else self.remembers(x, log_p)

    def with_cells(self, cells: int) -> ContactProfile:
        """The same profile with each cell cut into equal parts, so that there are at least so many."""
        parts = -(-cells // (self.x.size - 1))
        if parts == 1:
            return self
        at = np.arange(parts * (self.x.size - 1) + 1) / parts
        return replace(self, x=np.interp(at, np.arange(self.x.size), self.x))

    @cached_property
    def panels(self) -> tuple[Panels | None, Panels, Panels | None]:
        """Quadrature over the inner tail, the cells between the edges, and the outer tail; None for no tail."""
        t = 0.5 * (1.0 + gauss(_CLOSE_NODES if self._lies_close else _CELL_NODES)[0])
        length = (self.x[1:] - self.x[:-1])[:, None]
        x = self.x[:-1, None] + length * t
        log_p = self.log_pressure(x)
        cells = Panels(log_p, self.radius(x), np.broadcast_to(length, x.shape), self.log_equivalent(x, log_p))
        return self._tail_panel(0, -1.0), cells, self._tail_panel(-1, 1.0)

    @cached_property
    def quadrature(self) -> tuple[FloatArray, FloatArray, IntArray]:
        """All points of the panels: ln p* of first loading, weight over 2 pi r, and where each stretch begins.

        int f dx/(2 pi r) over each stretch is `np.add.reduceat(weight * f, begin)`.
        """
        parts = [panel for panel in self.panels if panel is not None]
        log_p, weights, begins, place = [], [], [], 0
        for panel in parts:
            count = panel.stretch.shape[1]
            log_p.append(panel.log_equivalent.ravel())
            weights.append((panel.stretch * gauss(count)[1] / (4.0 * np.pi * panel.radius)).ravel())
            begins.append(np.arange(place, place + panel.stretch.size, count))
            place += panel.stretch.size
        return np.concatenate(log_p), np.concatenate(weights), np.concatenate(begins)

    @property
    def _lies_close(self) -> bool:
        """Whether the points follow the pressure closely, and it does not end at zero, as a root."""
        first, *others = self.patches
        if others or first.x.size != self.x.size:
            return False
        rise, depth = np.abs(first.log_p[1:] - first.log_p[:-1]), first.log_p.max() - first.log_p
        return bool((rise <= _CLOSE * np.exp(np.minimum(depth[1:], depth[:-1]) / _FURTHER)).all())

    def _tail_panel(self, end: int, outward: float) -> Panels | None:
        """From an end to infinity, or to where the face ends, over d = scale s/(1-s).

        The resistance of a gap u falls at least like d^-3.
        """
        tail = self.tails[end]
        if tail is None:
            return None
        # Distance over which ln p falls by about ten: that of u_eff by several decay lengths.
        scale = 10.0 / (0.5 * tail.slope + np.sqrt(0.25 * tail.slope**2 + 10.0 * tail.curvature))
        top = 1.0 / (1.0 + scale / tail.length)
        s = top * 0.5 * (1.0 + gauss(_TAIL_NODES)[0])[None, :: int(outward)]
        d = scale * s / (1.0 - s)
        log_p, x = self.log_p[end] - tail.fall(d), self.x[end] + outward * d
        return Panels(log_p, self.radius(x), top * scale / (1.0 - s) ** 2, self.log_equivalent(x, log_p))


def _group_points(is_there: BoolArray) -> list[IntArray]:
    """Numbers of the points that are there, those that follow each other together."""
    if is_there.all():
        return [np.arange(is_there.size)]
    points = is_there.nonzero()[0]
    return np.split(points, np.flatnonzero(np.diff(points) > 1) + 1)


def _up_to_ends(
    x: FloatArray, p: FloatArray, r: FloatArray, ends: tuple[float, float]
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """The points, with one more where a face ends close to the last one that still carries pressure.

    ln p goes on there by the parabola through the last three points, falling or, towards the corner of a body, rising.
    """
    for end, place in zip((0, -1), ends, strict=True):
        order = slice(0, 3) if end == 0 else slice(-1, -4, -1)
        d, length = np.abs(x[order] - x[order][0]), place - x[end] if end else x[end] - place
        if not 0.0 < length <= _NEAR_END * d[2] or (p[order] <= _SMALLEST_PRESSURE).any():
            continue
        log_p = np.log(p[order])
        first, second = (log_p[1] - log_p[0]) / d[1], (log_p[2] - log_p[0]) / d[2]
        curvature = (second - first) / (d[2] - d[1])
        outermost = log_p[0] - length * (first - curvature * d[1]) + curvature * length**2
        outermost = min(outermost, log_p.max() + _STEEPEST_RISE)
        radius = r[order][0] + (r[order][0] - r[order][1]) * length / d[1]
        at = 0 if end == 0 else x.size
        x, p, r = (
            np.insert(values, at, value)
            for values, value in ((x, place), (p, np.exp(outermost)), (r, radius))
        )
    return x, p, r


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
    roots = real[(real > 1e-3) & (real <= 1.0)]
    return float(xs[0] + span * roots[0]) if roots.size else float(zero)


def law_bends(p: FloatArray, gap: FloatArray) -> tuple[float, float]:
    """How ln p bends over the gap at either end, zero where the law is as good as exponential there.

    Parameters
    ----------
    p, gap : ndarray, shape (n,)
        Pressure [Pa] and mean gap [m] at the points of a profile.

    Returns
    -------
    tuple of float
        b of ln p = ln p_end - f - b f^2, f the growth of the gap over the decay length at the end.
    """
    return _bend(p[:3], gap[:3]), _bend(p[:-4:-1], gap[:-4:-1])


def _bend(p: FloatArray, gap: FloatArray) -> float:
    closer = gap[0] - gap
    if not (p > _SMALLEST_PRESSURE).all() or not 0.0 < closer[1] < closer[2]:
        return 0.0
    first, second = np.log(p[1:] / p[0]) / closer[1:]
    curvature = (first - second) / (closer[2] - closer[1])
    slope = first + curvature * closer[1]
    # faces that touch all along have no slope
    bend = float(curvature / slope**2) if slope != 0.0 else 0.0
    return bend if bend > _STRAIGHT else 0.0


def _tail(x: FloatArray, log_p: FloatArray, end: int, length: float, bend: float) -> Tail | None:
    """Continuation of a falling end by the parabola through its last three points, or by its tangent."""
    if x.size < 3 or not length > 0.0:
        return None
    order = slice(0, 3) if end == 0 else slice(-1, -4, -1)
    d, fall = np.abs(x[order] - x[order][0]), log_p[order] - log_p[order][0]
    # in decay lengths of the gap
    fall = 2.0 * fall / (1.0 + np.sqrt(np.maximum(1.0 - 4.0 * bend * fall, 0.0)))
    first, second = fall[1] / d[1], fall[2] / d[2]
    curvature = (second - first) / (d[2] - d[1])
    slope = first - curvature * d[1]  # inward slope of ln p at the end
    if slope <= 0.0:
        return None
    return Tail(float(slope), float(max(-curvature, 0.0)), float(length), bend)


def _cell_slopes(x: FloatArray, log_p: FloatArray) -> FloatArray:
    """Slopes of the cubic of ln p at both ends of each cell, shape (2, n - 1).

    A spline, but where it would leave the range of the cell's two points by more than a smooth profile does, the
    chord: a single bad point must not invent a pressure that none of its neighbours has.
    """
    h, rise = x[1:] - x[:-1], log_p[1:] - log_p[:-1]
    if x.size < 3:
        return np.tile(rise / h, (2, 1))
    slope = cubic_spline_slopes(x, log_p)
    slopes = np.array([slope[:-1], slope[1:]])
    # A cubic is monotone where both slopes are between none and three times the chord's (Fritsch & Carlson).
    ends, steepest = h * slopes, 3.0 * rise
    bends = (ends < np.minimum(steepest, 0.0)) | (ends > np.maximum(steepest, 0.0))
    cells = (bends[0] | bends[1]).nonzero()[0]
    left, right = ends[:, cells]
    value = _hermite(_CHECK_SHARES[:, None], left, right, rise[cells])
    highest, lowest = np.maximum(rise[cells], 0) + _OVERSHOOT, np.minimum(rise[cells], 0) - _OVERSHOOT
    wild = cells[((value > highest) | (value < lowest)).any(axis=0)]
    slopes[:, wild] = rise[wild] / h[wild]
    return slopes


def _hermite(t: FloatArray, d0: FloatArray, d1: FloatArray, rise: FloatArray) -> FloatArray:
    """Cubic on 0 <= t <= 1 that begins at 0 with slope d0 and ends at `rise` with slope d1."""
    return t * (d0 + t * (3.0 * rise - 2.0 * d0 - d1 + t * (d0 + d1 - 2.0 * rise)))


def checked_profile(
    x: ArrayLike, p: ArrayLike, radius: ArrayLike
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """x, p and r(x) as arrays, or a `ProfileError` that says which value cannot be used."""
    xs, ps, rs = as_arrays(ProfileError, "x, p and radius must be arrays of numbers", x, p, radius)
    if xs.ndim != 1 or xs.shape != ps.shape:
        raise ProfileError(f"x has shape {xs.shape}, p has shape {ps.shape}: both must be (n,)")
    if xs.size < 3:
        raise ProfileError(f"x has {xs.size} points: at least 3 are needed")
    if rs.shape not in ((), xs.shape):
        raise ProfileError(f"radius has shape {rs.shape}: must be one number or {xs.shape} like x")
    for name, unit, values in (("x", "m", xs), ("p", "Pa", ps)):
        check_each(ProfileError, name, values, np.isfinite(values), f"must be finite [{unit}]")
    check_order(ProfileError, "x", xs, "must strictly increase [m]")
    check_each(ProfileError, "p", ps, ps >= 0.0, "must not be negative [Pa]")
    if not (ps > _SMALLEST_PRESSURE).any():
        raise ProfileError("p is zero everywhere: there is no contact")
    if rs.ndim == 0:
        rs = np.broadcast_to(rs, xs.shape)
    is_wrong = ~((rs > 0.0) & np.isfinite(rs))
    if is_wrong.any():
        raise ProfileError(f"radius = {rs[is_wrong][0]}: must be positive and finite [m]")
    return xs, ps, rs


def after_largest(
    profile: ContactProfile,
    x: FloatArray,
    r: FloatArray,
    largest: ArrayLike | None,
    ends: tuple[float, float],
    conductivity: object,
) -> ContactProfile:
    """The contact after its largest pressures at the points x; itself where there are none, or none larger.

    Raises
    ------
    ProfileError
        The pressures cannot be used, or nothing is known of what they leave behind.
    """
    if largest is None:
        return profile
    (most,) = as_arrays(ProfileError, "largest_pressure must be an array of numbers", largest)
    if most.shape != x.shape:
        raise ProfileError(f"largest_pressure has shape {most.shape}: must be {x.shape} like p [Pa]")
    usable = np.isfinite(most) & (most >= 0.0)
    check_each(ProfileError, "largest_pressure", most, usable, "must be finite and not negative [Pa]")
    if not isinstance(conductivity, RemembersLoad):
        raise ProfileError(
            f"largest_pressure: the conductivity, {conductivity!r}, says nothing of a contact that was pressed harder "
            "before; take one of a RoughContact, such as surface.conductivity_table(...).at(viscosity)"
        )
    if not np.any(most > np.exp(SMALLEST_LOG_PRESSURE)):
        return profile
    inner, outer = (0.0 if tail is None else tail.bend for tail in profile.tails)
    return profile.after_load(ContactProfile.through(x, most, r, ends, (inner, outer)), conductivity)


def profile_after(
    x: FloatArray,
    p: FloatArray,
    r: FloatArray,
    ends: tuple[float | None, float | None] | None,
    largest: ArrayLike | None,
    conductivity: object,
) -> ContactProfile:
    """The contact through checked points, after its largest pressures if a conductivity remembers them."""
    places = checked_ends(ends)
    profile = ContactProfile.through(x, p, r, places)
    return profile if conductivity is None else after_largest(profile, x, r, largest, places, conductivity)


def checked_ends(ends: tuple[float | None, float | None] | None) -> tuple[float, float]:
    """Where the faces end, infinite where they do not, or a `ProfileError`."""
    if ends is None:
        return NO_ENDS
    try:
        low, high = (
            endless if end is None else float(end) for end, endless in zip(ends, NO_ENDS, strict=True)
        )
    except (TypeError, ValueError):
        raise ProfileError(
            f"ends = {ends!r}: must be two places x, or None where a face goes on [m]"
        ) from None
    if not low < high:
        raise ProfileError(f"ends = {ends!r}: the first must be below the second [m]")
    return low, high


def checked_side(pressure_side: str) -> None:
    """Refuse a side of the high fluid pressure that is none."""
    if pressure_side not in ("outer", "inner"):
        raise ProfileError(f"pressure_side = {pressure_side!r}: must be 'outer' or 'inner'")
