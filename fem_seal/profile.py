"""The nominal pressure profile of a contact and its measures."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from fem_seal.arrays import FloatArray
from leak.numerics.roots import root_of_rising

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from leak.flow.conductivity import RemembersLoad
    from leak.flow.contact_profile import ContactProfile
    from leak.flow.rough_contact import RoughContact
    from leak.flow.turned_contact import FaceContact

# Pressure that is as good as none [Pa].
_NONE = 1e-300
# Largest distance of (p/p0)^2 from its polynomial: 0.01 of Hertz's contact, 0.1 of yielding bodies, 0.6 of a flat land.
_NO_ELLIPSE = 0.2


@dataclass(frozen=True)
class PressureProfile:
    """Nominal pressure over the contact line.

    One that carries nothing, of a land that does not touch, has no width, and its middle as centroid.

    Parameters
    ----------
    x : ndarray, shape (m,)
        Arc length from first touch [m], increasing.
    radius : ndarray, shape (m,)
        Distance from the axis [m].
    pressure : ndarray, shape (m,)
        Contact pressure [Pa], positive in compression.
    gap : ndarray, shape (m,)
        Mean separation of the surfaces [m].
    arc_weight : ndarray, shape (m,)
        Quadrature weights over x [m] that belong to the points.
    ends : tuple of float or None, optional
        x at which the faces end [m], None where that is not known: the contact does not go on beyond.
    largest : ndarray, shape (m,), optional
        Largest pressure before that the gap at each place remembers, see `after` [Pa]; None on first loading.
    parts : tuple of PressureProfile, optional
        Lands that lie in series, from the axis outwards; empty where there is but one.
    strain : ndarray, shape (m, 3), optional
        Of the metal under the faces, along them and around the axis, and the sum of both elastic ones, see
        `ContactSolution.strain`; None where nothing is known of it [-].

    Examples
    --------
    >>> import numpy as np, fem_seal
    >>> x = np.linspace(-5e-4, 5e-4, 201)
    >>> p = 50e6 * np.exp(-0.5 * (x / 1e-4) ** 2)
    >>> weight = np.full_like(x, x[1] - x[0])
    >>> profile = fem_seal.PressureProfile(x, 0.014 + x, p, 0 * x, weight)
    >>> f"{profile.peak_pressure / 1e6:.1f} MPa, std {profile.std * 1e3:.3f} mm, FWHM {profile.fwhm * 1e3:.3f} mm"
    '50.0 MPa, std 0.100 mm, FWHM 0.235 mm'
    """

    x: FloatArray
    radius: FloatArray
    pressure: FloatArray
    gap: FloatArray
    arc_weight: FloatArray
    ends: tuple[float | None, float | None] = (None, None)
    largest: FloatArray | None = None
    parts: tuple[PressureProfile, ...] = ()
    strain: FloatArray | None = None

    @property
    def lands(self) -> tuple[PressureProfile, ...]:
        """Its lands, from the axis outwards; itself where it is one."""
        return self.parts or (self,)

    def moment(self, order: int, centre: float = 0.0) -> float:
        """int p (x - centre)^order dx [Pa m^(order + 1)]."""
        return float(self.arc_weight @ (self.pressure * (self.x - centre) ** order))

    @cached_property
    def centroid(self) -> float:
        """Centre of the pressure over x [m]."""
        return (
            self.moment(1) / self._force_per_length if self.touches else 0.5 * float(self.x[0] + self.x[-1])
        )

    @cached_property
    def std(self) -> float:
        """Square root of the second central moment of p over x [m]."""
        return float(np.sqrt(self.moment(2, self.centroid) / self._force_per_length)) if self.touches else 0.0

    @property
    def _force_per_length(self) -> float:
        """int p dx [Pa m]."""
        return float(self.arc_weight @ self.pressure)

    @cached_property
    def peak(self) -> tuple[float, float]:
        """Place x [m] and height [Pa] of the highest pressure, from a parabola through three points of p.

        Where the pressure rises up to an end of the profile it is that of the last point.
        """
        k = int(np.argmax(self.pressure))
        if k in (0, len(self.x) - 1):
            return float(self.x[k]), float(self.pressure[k])
        # Points that mirror each other about the peak make argmax a matter of round-off; the parabola does not.
        x, p = (self.x[k - 1 : k + 2] - self.x[k]).tolist(), self.pressure[k - 1 : k + 2].tolist()
        # 1 + c1 t + c2 t^2 over t = x / x[2], which is 0 and 1 at two of the points
        left, rise_before, rise = x[0] / x[2], p[0] / p[1] - 1, p[2] / p[1] - 1
        c2 = (rise_before / left - rise) / (left - 1)
        if not c2 < 0:
            return float(self.x[k]), p[1]
        c1 = rise - c2
        top = min(max(-c1 / (2 * c2), left), 1.0)
        return float(self.x[k] + top * x[2]), p[1] * (1 + c1 * top + c2 * top**2)

    @cached_property
    def contact(self) -> ContactProfile:
        """The profile between and beyond its points, on first loading.

        Raises
        ------
        ProfileError
            Its points cannot be used.
        """
        from leak.flow.contact_profile import ContactProfile, checked_ends, checked_profile, law_bends

        points = checked_profile(self.x, self.pressure, self.radius)
        bends = law_bends(self.pressure, self.gap)
        return ContactProfile.through(*points, checked_ends(self.ends), bends)

    def contact_for(self, conductivity: object) -> ContactProfile:
        """`contact` as a conductivity is asked of it: after what its places have carried before.

        Parameters
        ----------
        conductivity : RemembersLoad
            Which knows what that leaves behind.
        """
        from leak.flow.contact_profile import after_largest, checked_ends

        ends = checked_ends(self.ends)
        return after_largest(self.contact, self.x, self.radius, self.largest, ends, conductivity)

    def after(self, largest: FloatArray) -> PressureProfile:
        """The same after the largest pressure that each place has carried before [Pa], shape (m,).

        A place whose pressure has fallen by more than that of the contact as a whole was not unloaded but parted by the
        bodies, and its gap has opened with them. There p_max counts up to p times the ratio of both peaks.

        Examples
        --------
        >>> import numpy as np, fem_seal
        >>> x, p = np.array([0.0, 1e-4]), np.array([10.0, 1.0])
        >>> profile = fem_seal.PressureProfile(x, 0.014 + x, p, 0 * x, 5e-5 + 0 * x)
        >>> profile.after(np.array([20.0, 19.0])).largest.tolist()
        [20.0, 2.0]
        """
        highest = self.pressure.max()
        share = largest.max() / highest if highest > 0.0 else 0.0
        return replace(self, largest=np.minimum(largest, self.pressure * share))

    def at_rest(self, surface: FaceContact) -> PressureProfile:
        """Profile over metal that is not strained which lets as much through at every point; itself where it is that.

        Parameters
        ----------
        surface : RoughContact or TurnedContact
        """
        if self.strain is None:
            return self

        def rest(pressure: FloatArray) -> FloatArray:
            assert self.strain is not None  # looked at above
            return surface.pressure_at_rest(pressure, *self.strain.T)

        largest = None if self.largest is None else rest(self.largest)
        parts = tuple(part.at_rest(surface) for part in self.parts)
        return replace(self, pressure=rest(self.pressure), largest=largest, parts=parts, strain=None)

    @property
    def peak_strain(self) -> tuple[float, float, float]:
        """`strain` at the peak; zero where nothing is known of it."""
        if self.strain is None:
            return 0.0, 0.0, 0.0
        along, hoop, elastic = (float(np.interp(self.peak[0], self.x, part)) for part in self.strain.T)
        return along, hoop, elastic

    @property
    def without_strain(self) -> PressureProfile:
        """The same over metal that is not strained."""
        return replace(self, strain=None, parts=tuple(part.without_strain for part in self.parts))

    def surface_at_peak(self, surface: RoughContact) -> RoughContact:
        """A surface over metal that is strained as at the peak; itself without, or where its theory knows of none.

        Parameters
        ----------
        surface : RoughContact
        """
        if self.strain is None or surface.hardness is None or not surface.knows_deviation:
            return surface
        along, hoop, elastic = self.peak_strain
        return surface.strained(along, hoop, elastic=elastic)

    def equivalent(self, table: RemembersLoad, surface: FaceContact) -> PressureProfile:
        """Profile of new faces over metal that is not strained which lets as much through at every point.

        Parameters
        ----------
        table : ConductivityTable or GasConductivityTable
        surface : RoughContact or TurnedContact
            Of which the table is.
        """
        if self.strain is not None:
            return self.at_rest(surface).equivalent(table, surface)
        if self.largest is None:
            return self
        with np.errstate(divide="ignore"):
            log_p, log_largest = np.log(self.pressure), np.log(self.largest)
        equal = np.exp(table.first_loading(log_p, np.maximum(log_largest, log_p)))
        return replace(self, pressure=equal, largest=None)

    def pressed_up_to(self, most: float) -> PressureProfile:
        """The same if no place carried or had carried more than a pressure [Pa]."""
        largest = None if self.largest is None else np.minimum(self.largest, most)
        parts = tuple(part.pressed_up_to(most) for part in self.parts)
        return replace(self, pressure=np.minimum(self.pressure, most), largest=largest, parts=parts)

    @property
    def touches(self) -> bool:
        """Whether a place carries pressure."""
        return bool(self.pressure.max() > _NONE)

    @property
    def peak_pressure(self) -> float:
        """Highest nominal pressure p0 [Pa]."""
        return self.peak[1]

    @property
    def highest(self) -> float:
        """Highest pressure that a place carries or has carried [Pa]."""
        return float(
            self.pressure.max() if self.largest is None else max(self.pressure.max(), self.largest.max())
        )

    @property
    def fwhm(self) -> float:
        """Full width at half maximum [m]; the flanks are interpolated in (p/p0)^2, exact for an ellipse."""
        if not self.touches:
            return 0.0
        height = (self.pressure / self.peak_pressure) ** 2 - 0.25
        ends_sharply = self.pressure[0] == 0 and self.pressure[-1] == 0
        if ends_sharply and (width := self._width_of_ellipse(height)) is not None:
            return width
        places = (height >= 0).nonzero()[0]
        if len(places) == 0:
            return 0.0
        return self._crossing(height, places[-1], +1) - self._crossing(height, places[0], -1)

    def _width_of_ellipse(self, height: FloatArray) -> float | None:
        """Width between the roots of a polynomial through the inner part of p^2; None where that is no such curve.

        Where contact ends sharply p^2 is a smooth function up to the edge, but the outermost elements hold only
        part of it; they are left out.
        """
        inner = self.pressure > 0.4 * self.peak_pressure
        curve = np.polynomial.Polynomial.fit(self.x[inner], height[inner], min(4, int(inner.sum()) - 1))
        edges = self.x[np.flatnonzero(self.pressure)[[0, -1]]].tolist()
        distance = np.abs(curve(self.x[inner]) - height[inner]).max()
        if distance > _NO_ELLIPSE or not curve(self.centroid) > 0 > max(map(curve, edges)):
            return None
        return _root(curve, self.centroid, edges[1]) - _root(curve, edges[0], self.centroid)

    def _crossing(self, height: FloatArray, start: int, step: int) -> float:
        neighbour = start + step
        if not 0 <= neighbour < len(self.x):
            return float(self.x[start])
        lower = max(min(start, neighbour) - 2, 0)
        part = slice(lower, lower + 6)
        curve = _interpolate(self.x[part].tolist(), height[part].tolist())
        a, b = sorted((float(self.x[start]), float(self.x[neighbour])))
        return _root(curve, a, b)


def _interpolate(x: list[float], y: list[float]) -> Callable[[float], float]:
    """The polynomial through a few points, by divided differences."""
    d = list(y)
    for order in range(1, len(x)):
        for n in range(len(x) - 1, order - 1, -1):
            d[n] = (d[n] - d[n - 1]) / (x[n] - x[n - order])

    def curve(at: float) -> float:
        value = 0.0
        for place, difference in zip(reversed(x), reversed(d), strict=True):
            value = difference + (at - place) * value
        return value

    return curve


def _root(curve: Callable[[float], float], a: float, b: float) -> float:
    """Root between a and b, where the curve changes sign."""
    sign = math.copysign(1.0, curve(b) - curve(a))
    share = root_of_rising(lambda share: sign * curve(a + (b - a) * share), 0.0, 1.0, 0.5)
    return float(a + (b - a) * share)


def tightest_profile(profiles: Sequence[PressureProfile]) -> PressureProfile:
    """The one of several contact lines that is pressed hardest.

    Parameters
    ----------
    profiles : sequence of PressureProfile
    """
    return max(profiles, key=lambda profile: profile.peak_pressure) if len(profiles) > 1 else profiles[0]


def join_lands(profiles: Sequence[PressureProfile]) -> PressureProfile:
    """Lands of a contact line as one profile; a single one as it is.

    Parameters
    ----------
    profiles : sequence of PressureProfile
        From the axis outwards.
    """
    if len(profiles) == 1:
        return profiles[0]
    memories = [profile.largest for profile in profiles if profile.largest is not None]
    strains = [profile.strain for profile in profiles if profile.strain is not None]
    x, radius, pressure, gap, weight = (
        np.concatenate([getattr(profile, name) for profile in profiles])
        for name in ("x", "radius", "pressure", "gap", "arc_weight")
    )
    ends = profiles[0].ends[0], profiles[-1].ends[1]
    largest = np.concatenate(memories) if memories else None
    strain = np.concatenate(strains) if strains else None
    return PressureProfile(x, radius, pressure, gap, weight, ends, largest, tuple(profiles), strain)
