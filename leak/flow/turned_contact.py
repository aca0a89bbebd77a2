"""A turned face pressed against a flat one: crests in series, each a line of throats, the thread in parallel."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache, partial
from typing import TYPE_CHECKING, ClassVar, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import BoolArray, FloatArray
from leak.errors import ConductivityError, SurfaceError, positive
from leak.flow.conductivity import AnyTable, ConductivityTable, GasConductivityTable
from leak.flow.rarefied import log_flow_factor
from leak.flow.rough_contact import RoughContact, gas_conductivity_table
from leak.numerics.roots import bisect_roots
from leak.surfaces.random import random_map
from leak.surfaces.spectrum import PowerSpectrum
from leak.surfaces.turned import Crest, Cusps, TurnedTexture
from leak.theory.bulk_flow import HARDNESS_OVER_YIELD_STRESS, softer
from leak.theory.crest_flow import CrestFlow
from leak.theory.crest_line import CrestLines, PressedCrests, of_each
from leak.theory.interface_law import TabulatedLaw
from leak.theory.own_error import FlowError
from leak.theory.plasticity import Reading

if TYPE_CHECKING:
    from scipy.interpolate import PchipInterpolator

# Places along a piece of crest, pieces, feeds that a piece is long at least, and points in the shortest wave of the
# fine roughness on it.
_PLACES, _PIECES, _LEAST_FEEDS, _POINTS_PER_WAVE, _SEED = 1024, 8, 4, 4, 1
# Maps of it that pieces of crests of unlike heights come from.
_MAPS = 4
# A crest is known so many rms heights down its sides, and so many points at least.
_DEPTH, _LEAST_POINTS = 12.0, 16
# Over the rms height of the fine roughness: by how much crests differ that count as equally high, depth of valleys from
# which on fluid finds its way along them, and gaps for which throats between two turned faces are known.
_ALIKE, _OPEN_VALLEY, _THROAT_GAPS = 0.25, 0.6, np.geomspace(1e-4, 1e4, 97)
# Rms heights of the tops between two levels of the flat, and where it begins above their mean.
_STEP, _FIRST = 0.8, 3.0
# ... their most, and growth of the steps once nothing flows.
_MOST_LEVELS, _GROWTH = 40, 1.5
# Points of the law beyond the rough crests, and of a smooth crest from valley to valley.
_SMOOTH, _ACROSS = 20, 1025
# A face whose conductivity has fallen to this share of the first one is sealed.
_SEALED = 1e-9
# ln(largest/p) up to which ln(p*/p) is known after a larger pressure.
_FALLS = np.array([0.0, 0.1, 0.25, 0.45, 0.7, 1.0, 1.4, 1.9, 2.5, 3.2, 4.0, 5.0, 6.0])
_TINY = float(np.finfo(float).tiny)
# Mean gap over the height of the crests at which they are pressed flat.
_CLOSED = 0.02
# Rms height of the fine roughness over the height of the crests at which these begin to be lost in it, and are lost.
_LOST = (0.13, 0.39)
# Of the range of its table where the face is its fine roughness, the lowest pressure over the sealing pressure.
_LOWEST = 1e-8
# Pressures of a table below the first touch, for each of the levels, and beyond the sealing of crests up to a share of
# the contact pressure.
_BEFORE_TOUCH, _BETWEEN, _BEYOND, _NOMINAL, _NEARLY_FLAT = 3, 4, 8, 200, 0.9
# Share of the nominal area that touches where direct simulations begin, and what is left of the conductivity there in a
# face that is nearly sealed.
_BEARS, _NEARLY = 5e-3, 3e-3
# Standard deviation of ln(direct/theory) over the decades by which the conductivity has fallen since the first touch,
# and of a median wave of crest; mean, and that of crests half lost in the fine roughness: `benchmarks/turned_error.py`.
# Factor on the strain of the bulk by which what it does is not known.
_FALLEN, _SPREAD = (0.0, 1.5, 2.25, 3.75, 4.75), (0.2, 0.2, 0.42, 0.42, 2.0)
_OPEN_PLACES, _FEWER_PLACES, _MEAN, _HALF_LOST, _STRAIN_FACTOR = 0.61, 0.24, -0.1, 0.69, 1.45
# Inverse Knudsen numbers of u_eff in the table of a gas, and of the gaps of throats.
_LOG_D = -2.6 + 4.5 * np.sinh(np.linspace(-1.436, 1.693, 44))
_LOG_THROAT = np.linspace(math.log(1e-9), math.log(1e8), 1600)


class _State(NamedTuple):
    """A level of the flat: nominal pressure [Pa], mean gap [m], 12 eta times the conductivity across [m^3]."""

    pressure: float
    mean_gap: float
    gap_cubed: float
    level: float
    least_gap: FloatArray
    width: FloatArray


@dataclass(frozen=True)
class TurnedContact:
    """Contact between a turned face and a flat or another turned one, elastic or with crests that yield.

    All load is carried by the crests; between them the gap is open and resists nothing. With g(y) the least gap at a
    place along a crest, a throat between sides of slope m conducts m g^2/(12 eta) of a length of crest, since the
    integral of dx/(g + m abs(x))^3 is 1/(m g^2); crests a feed f apart in series conduct f m <g^2>/(12 eta).
    Two turned faces count as one whose depths add. Its crests stand where one of both has a crest, as high as the other
    one is there, and have sides of unlike slopes; their resistances add.

    Parameters
    ----------
    feed : float
        Distance of the crests [m].
    nose_radius : float
        Of the tool [m].
    fine : PowerSpectrum
        Roughness on the crests, with that of the other face.
    other : Cusps, optional
        Feed and nose radius of a turned face on this one.
    phase : float
        Way from a crest of this face to one of the other, over that after which both lie alike: a feed, if the feeds
        are equal; not known of real faces, so sample it [-].
    crest_scatter : float
        Rms deviation of the heights of crests from each other, by which the feed and vibration differ [m].
    effective_modulus : float
        E* [Pa].
    hardness : float, optional
        Of the softer face [Pa]; None for elastic crests.
    thread_radius : float
        r_0 of a contact through which the thread between the crests leads, which its tables include [m]; infinite for
        rings.

    Raises
    ------
    SurfaceError
        A value outside its meaning.

    Examples
    --------
    >>> import leak
    >>> fine = leak.PowerSpectrum.self_affine(rms_height=1e-7, hurst=0.8, q_low=3e4, q_rolloff=2.5e5, q_high=4e6)
    >>> face = leak.TurnedContact(feed=1e-4, nose_radius=8e-4, fine=fine, effective_modulus=115e9, hardness=3.5e9)
    >>> bool(face.flow_conductivity(25e6, 1e-3) < 0.5 * face.flow_conductivity(10e6, 1e-3))
    True
    """

    feed: float = field(kw_only=True)
    nose_radius: float = field(kw_only=True)
    fine: PowerSpectrum = field(kw_only=True)
    other: Cusps | None = field(default=None, kw_only=True)
    phase: float = field(default=0.5, kw_only=True)
    crest_scatter: float = field(default=0.0, kw_only=True)
    effective_modulus: float = field(kw_only=True)
    hardness: float | None = field(default=None, kw_only=True)
    thread_radius: float = field(default=math.inf, kw_only=True)
    theory: ClassVar[str] = "turned"
    peklenik: ClassVar[float] = 1.0

    def __post_init__(self) -> None:
        self.texture  # noqa: B018
        positive(SurfaceError, "effective_modulus", self.effective_modulus, "Pa")
        if not 0.0 <= self.crest_scatter < self.texture.crest_height:
            raise SurfaceError(
                f"crest_scatter = {self.crest_scatter:g} m: must be from 0 to below the height of the crests, "
                f"{self.texture.crest_height:g} m"
            )
        if self.hardness is not None:
            positive(SurfaceError, "hardness", self.hardness, "Pa")
        if not self.thread_radius > 0.0:
            raise SurfaceError(f"thread_radius = {self.thread_radius:g} m: must be positive [m]")

    @cached_property
    def texture(self) -> TurnedTexture:
        """The face without load, together with the other one."""
        return TurnedTexture(self.feed, self.nose_radius, self.fine, self.other, self.phase)

    @cached_property
    def _crests(self) -> tuple[Crest, ...]:
        """Those that repeat together; of unlike heights some more, which deviate as a normal distribution has it."""
        crests = self.texture.crests(self.fine.rms_height)
        if self.crest_scatter == 0.0:
            return crests
        from scipy.special import ndtri

        periods = math.ceil(_PIECES / len(crests))
        count = periods * len(crests)
        # a step that has no divisor in common with their number mixes high and low ones
        step = next(step for step in range(int(0.38 * count), count + 1) if math.gcd(step, count) == 1)
        deviation = ndtri((np.arange(count) * step % count + 0.5) / count)
        deviation *= self.crest_scatter / deviation.std()
        repeated = [
            crest._replace(place=crest.place + period * self.texture.period)
            for period in range(periods)
            for crest in crests
        ]
        return tuple(
            crest._replace(height=crest.height + by)
            for crest, by in zip(repeated, deviation.tolist(), strict=True)
        )

    @property
    def spectrum(self) -> PowerSpectrum:
        """Of the fine roughness."""
        return self.fine

    @property
    def readings(self) -> tuple[Reading, ...]:
        """What becomes of metal that yields: crests are crushed where they touch; "elastic" without a hardness."""
        return (Reading.ELASTIC,) if self.hardness is None else (Reading.VON_MISES,)

    def reading(self, reading: Reading) -> TurnedContact:
        """The same face with metal that yields read in another way; itself where its theory does not know that.

        Parameters
        ----------
        reading : Reading
        """
        return self.elastic if reading is Reading.ELASTIC else self

    @cached_property
    def elastic(self) -> TurnedContact:
        """The same face whose crests never yield; itself without a hardness."""
        return self if self.hardness is None else replace(self, hardness=None)

    def steeper(self, factor: float) -> TurnedContact:
        """The same feeds with cusps that are higher by a factor, and the same fine roughness.

        Parameters
        ----------
        factor : float
            [-]
        """
        other = (
            None if self.other is None else self.other._replace(nose_radius=self.other.nose_radius / factor)
        )
        return replace(self, nose_radius=self.nose_radius / factor, other=other)

    @property
    def knows_deviation(self) -> bool:
        """It says how far direct simulation may find the flow, see `flow_error`."""
        return True

    @property
    def exponential_at_low_pressure(self) -> bool:
        """Its pressure does not fall exponentially with the gap."""
        return False

    @cached_property
    def crest_distance(self) -> float:
        """Between crests that carry load, on average [m]: the feed of a face on a flat."""
        return self.texture.period / len(self.texture.crests(self.fine.rms_height))

    @property
    def contact_pressure(self) -> float:
        """Mean pressure where a crest touches: of elastic sides E* m'/2, limited by the hardness [Pa].

        m' is the rms slope across the crest: that of the cusp with the part of the fine roughness in this direction.

        References
        ----------
        K. L. Johnson, Contact mechanics (1985), sec. 5.2, of an elastic wedge. Its pressure and the hardness are joined
        by the square of their inverses, as elastic edges remain around what has yielded.
        """
        elastic = self._elastic_contact_pressure
        return elastic if self.hardness is None else 1.0 / math.hypot(1.0 / elastic, 1.0 / self.hardness)

    @property
    def _elastic_contact_pressure(self) -> float:
        """E* m'/2 [Pa]."""
        return 0.5 * self.effective_modulus * self._slope_across

    @property
    def _slope_across(self) -> float:
        """m' [-]."""
        sides = sum(crest.slope for crest in self._crests) / len(self._crests)
        return math.hypot(sides, self._resolved.rms_slope / math.sqrt(2.0))

    @property
    def _yielded_share(self) -> float:
        """Of an elastic contact of crests with the slope m' so much would bear more than the hardness [-].

        References
        ----------
        B. N. J. Persson, J. Chem. Phys. 115, 3840 (2001), for the stress distribution.
        """
        over = math.inf if self.hardness is None else self.hardness / self._elastic_contact_pressure
        return math.exp(-0.5 * over**2)

    @cached_property
    def _resolved(self) -> PowerSpectrum:
        """Fine roughness without waves that are short beside the feed, as direct simulations have it."""
        shortest = _POINTS_PER_WAVE * _LEAST_FEEDS * self.texture.mean_feed / _PLACES
        cut = max(2.0 * math.pi / shortest, 2.0 * self.fine.q_low)
        return (
            self.fine if self.fine.q_high <= cut * (1.0 + 1e-9) else self.fine.between(self.fine.q_low, cut)
        )

    @property
    def lines(self) -> CrestLines:
        """Pieces of its crests, from one random map of the fine roughness."""
        fine, crests = self._resolved, self._crests
        spacing = 2.0 * math.pi / fine.q_high / _POINTS_PER_WAVE
        heights, slope = [crest.height for crest in crests], min(crest.slope for crest in crests)
        reach = min(
            max(max(crest.valleys) for crest in crests),
            _LEAST_POINTS * spacing + (_DEPTH * fine.rms_height + max(heights) - min(heights)) / slope,
        )
        across = np.arange(-int(reach / spacing), int(reach / spacing) + 1)
        rows = max(_PIECES // len(crests), 1)
        # what the highest crests of all let through must not be chance
        maps = 1 if self.crest_scatter == 0.0 else _MAPS
        pieces = [
            rough[:, (row * (_PLACES // rows) + round(crest.place / spacing) + across) % _PLACES]
            - self._cusp(crest, np.asarray(across * spacing))
            for rough in (_heights_of(fine, spacing, _SEED + number) for number in range(maps))
            for row in range(rows)
            for crest in crests
        ]
        lines, smooth = (np.array([getattr(crest, name) for crest in crests]) for name in ("place", "height"))
        return CrestLines(
            np.stack(pieces),
            spacing,
            self.crest_distance,
            self.effective_modulus,
            self.contact_pressure,
            lines,
            smooth,
        )

    def _cusp(self, crest: Crest, x: FloatArray) -> FloatArray:
        """Depth of a smooth crest at a way x from its top, on beyond its valleys with its slope [m]."""
        if self.other is None:
            return self.texture.depth_at(np.abs(x)) - crest.height
        within = np.clip(x, -crest.valleys[0], crest.valleys[1])
        depth = self.texture.depth_below(crest.place + np.append(within, 0.0))
        return depth[:-1] - depth[-1] - crest.height + crest.slope * np.abs(x - within)

    @cached_property
    def _throat_slopes(self) -> tuple[tuple[FloatArray, FloatArray], ...]:
        """Of each crest ln of gaps [m], and of m of the throat m g^2 of straight sides from valley to valley [-]."""
        gaps = self.fine.rms_height * _THROAT_GAPS[:, None]
        slopes = []
        for crest in self._crests:
            x = np.linspace(-crest.valleys[0], crest.valleys[1], _ACROSS)
            depth = self.texture.depth_below(crest.place + x) + 0.5 * self.texture.curvature * x**2
            h = gaps + depth - depth.min()
            resistance = np.diff(x) * (h[:, 1:] + h[:, :-1]) / (2.0 * h[:, 1:] ** 2 * h[:, :-1] ** 2)
            slopes.append((np.log(gaps[:, 0]), -np.log(resistance.sum(axis=1) * gaps[:, 0] ** 2)))
        return tuple(slopes)

    def _throats(self, gap: FloatArray, flat: FloatArray | None = None) -> FloatArray:
        """m g^2 of all places of each crest, with a flat of width w less by w/g^3 in series, shape (n, ...) [m^2]."""
        gaps = of_each(gap, len(self._crests))
        if self.other is None:
            throats = self.texture.side_slope * gaps**2
        else:
            with np.errstate(divide="ignore"):
                slopes = [
                    np.interp(np.log(of), *table) for of, table in zip(gaps, self._throat_slopes, strict=True)
                ]
            throats = np.exp(slopes) * gaps**2
        if flat is None:
            return throats
        open_gaps = np.maximum(gaps, _TINY ** (1.0 / 3.0))
        return np.asarray(throats / (1.0 + of_each(flat, len(self._crests)) * throats / open_gaps**3))

    @cached_property
    def _alike(self) -> FloatArray:
        """Shares of the crests that are as high as one, shape (n, n): on a long face they hold the same places."""
        heights = np.round(
            np.array([crest.height for crest in self._crests]) / (_ALIKE * self.fine.rms_height)
        )
        same = (heights[:, None] == heights).astype(float)
        return np.asarray(same / same.sum(axis=1)[:, None])

    @property
    def crest_places(self) -> FloatArray:
        """Of the crests that repeat together, shape (n,) [m]: after n times `crest_distance`."""
        return np.array([crest.place for crest in self._crests])

    def crest_shares(self, pressure: FloatArray) -> FloatArray:
        """Of each crest that repeats in the resistance across all of them; equal where they are lost in roughness [-].

        Parameters
        ----------
        pressure : ndarray, shape (n, ...)
            Nominal at each crest in the order of `crest_places`, positive [Pa].
        """
        if len(self._crests) == 1 or self._lost_share == 1.0:
            return np.full(pressure.shape, 1.0 / len(self._crests))
        log_p, shares = self._known_shares
        return np.array(
            [np.interp(np.log(at), log_p, of_one) for at, of_one in zip(pressure, shares, strict=True)]
        )

    @cached_property
    def _known_shares(self) -> tuple[FloatArray, FloatArray]:
        """ln of the pressures of the levels of the flat, and the shares of `crest_shares` there, shape (n, levels)."""
        means = [self._alike @ self._throats(state.least_gap).mean(axis=1) for state in self._flowing]
        resistances = 1.0 / np.maximum(np.transpose(means), _TINY)
        return np.log([state.pressure for state in self._flowing]), resistances / resistances.sum(axis=0)

    @cached_property
    def _bridged(self) -> tuple[tuple[int, int, float], ...]:
        """Neighbouring crests whose valley hardly leads along them, and its depth over that of one that does [-]."""
        shares = [crest.next_valley / (_OPEN_VALLEY * self.fine.rms_height) for crest in self._crests]
        count = len(shares)
        return tuple(
            (one, (one + 1) % count, share) for one, share in enumerate(shares) if share < 1.0 < count
        )

    def _in_series(self, throats: FloatArray) -> float:
        """12 eta times the conductivity across crests of such throats [m^3].

        Fluid that has crossed a crest goes along the valley to where the next one is open; where there is hardly a
        valley it crosses both at the same place. Between both limits the logarithm crosses over.
        """
        means = self._alike @ throats.mean(axis=1)
        if not means.all():
            return 0.0
        resistance = np.mean(1.0 / means)
        for one, two, share in self._bridged:
            apart = 1.0 / means[one] + 1.0 / means[two]
            with np.errstate(divide="ignore"):
                together = np.mean(1.0 / (1.0 / throats[one] + 1.0 / throats[two]))
            more = np.maximum(together * apart, _SEALED) ** (share - 1.0) - 1.0
            resistance += apart * more / len(means)
        return float(self.crest_distance / resistance)

    @property
    def _path(self) -> tuple[_State, ...]:
        return _load(self.rings)

    @property
    def rings(self) -> TurnedContact:
        """The same crests without a way along the thread."""
        return replace(self, thread_radius=math.inf) if self._has_thread else self

    @property
    def other_way(self) -> TurnedContact:
        """The same crests for flow along them: through the valleys, as along a thread that leads straight across."""
        return replace(self, thread_radius=self.texture.mean_feed / (2.0 * math.pi))

    @property
    def _has_thread(self) -> bool:
        return math.isfinite(self.thread_radius)

    @property
    def touch_distance(self) -> float:
        """Mean gap of faces that just touch, valleys included [m]: of a million places one is five rms heights high."""
        return (
            self.texture.mean_depth + 5.0 * self.fine.rms_height + max(crest.height for crest in self._crests)
        )

    def _state(self, pressed: PressedCrests) -> _State:
        return _State(
            pressed.pressure,
            pressed.level + self.texture.mean_depth + pressed.overlap,
            self._in_series(self._throats(pressed.gap)),
            pressed.level,
            pressed.gap,
            pressed.width,
        )

    def contact_area(self, pressure: ArrayLike) -> FloatArray | float:
        """Share of the nominal area that touches [-].

        Parameters
        ----------
        pressure : array_like
            Nominal [Pa].
        """
        area = np.minimum(_checked(pressure) / self.contact_pressure, 1.0)
        return float(area) if area.ndim == 0 else area

    def interface_law(self, plastic: bool = False) -> TabulatedLaw:
        """Nominal pressure over the mean gap, valleys included: of crests that never yield, or of those that do.

        Beyond what is known of the crests they close as smooth cusps do that are as wide as the load asks for.

        Parameters
        ----------
        plastic : bool

        Raises
        ------
        SurfaceError
            `plastic` without a hardness.
        """
        if plastic and self.hardness is None:
            raise SurfaceError("hardness = None: the plastic interface law needs a hardness [Pa]")
        return (self if plastic else self.elastic)._law

    @cached_property
    def _law(self) -> TabulatedLaw:
        states = self._path
        share = np.linspace(states[-1].pressure / self.contact_pressure, 0.98, _SMOOTH + 1)
        rest = self.texture.gap_at(share)
        gap, pressure = (
            [getattr(state, name) for state in states[::-1]] for name in ("mean_gap", "pressure")
        )
        return TabulatedLaw(
            np.concatenate([gap[0] * rest[:0:-1] / rest[0], gap]),
            np.concatenate([self.contact_pressure * share[:0:-1], pressure]),
        )

    def equivalent_first_loading_pressure(self, pressure: ArrayLike, largest: ArrayLike) -> FloatArray:
        """Pressure of first loading that lets as much through as a place which carries less than it once did.

        By the flats that the largest load has left, see `leak.theory.coined_crest`; where crests are half lost in the
        fine roughness both cross over as in `flow_conductivity`. The mean gap is then that of the same pressure within
        a few per cent.

        Parameters
        ----------
        pressure : array_like
            Nominal [Pa].
        largest : array_like
            Largest one that the place has carried, counting where it exceeds `pressure` [Pa].

        Returns
        -------
        ndarray
            Between both, of the broadcast shape [Pa]; `pressure` where nothing larger was carried, where it is zero,
            and for elastic crests.
        """
        memory = self._table.memory
        assert memory is not None  # of all its tables
        with np.errstate(divide="ignore"):
            return np.exp(memory.first_loading(np.log(_checked(pressure)), np.log(_checked(largest))))

    def pressure_at_rest(
        self, pressure: ArrayLike, meridional: ArrayLike, hoop: ArrayLike, elastic: ArrayLike = 0.0
    ) -> FloatArray:
        """Pressure at which the face over a bulk that is not strained lets as much through, a thread included.

        Parameters
        ----------
        pressure : array_like
            Nominal [Pa].
        meridional, hoop : array_like
            Strain of the bulk at each of them, along the flow and along the crests, see `RoughContact.strained`; it
            counts for crests that yield [-].
        elastic : array_like
            See `RoughContact.pressure_at_rest` [-].

        Returns
        -------
        ndarray
            Of the broadcast shape; below the pressure only where metal is pressed together elastically [Pa].

        Examples
        --------
        >>> fine = PowerSpectrum.self_affine(rms_height=1e-7, hurst=0.8, q_low=3e4, q_rolloff=2.5e5, q_high=4e6)
        >>> face = TurnedContact(feed=1e-4, nose_radius=8e-4, fine=fine, effective_modulus=115e9, hardness=3.5e9)
        >>> bool(face.pressure_at_rest(25e6, 0.01, 0.0) > 40e6)
        True
        """
        strains = (np.asarray(strain) for strain in (meridional, hoop, elastic))
        p, m, h, e = np.broadcast_arrays(_checked(pressure), *strains)
        if self.hardness is None:
            return np.array(p)
        share = self._lost_share
        rough = self._rough.pressure_at_rest(p, m, h, e) if share > 0.0 else p
        least = p * softer(e, self.effective_modulus * HARDNESS_OVER_YIELD_STRESS / self.hardness)
        law, flat = CrestFlow(), _NEARLY_FLAT * self.contact_pressure
        wider, direction = law.widened(
            np.asarray(self.contact_area(p)),
            p / self.hardness,
            (m, h),
            slope=self._slope_across,
            hardness=self.hardness / self.effective_modulus,
        )

        def acts(closing: FloatArray | float) -> FloatArray:
            return np.maximum(np.minimum(least * (1.0 + closing * (wider - 1.0)), flat), least)

        across = np.asarray(
            acts(law.closing * (1.0 - law.direction * direction)) ** (1.0 - share) * rough**share
        )
        if not self._has_thread:
            return across
        valleys = acts(law.valleys)
        log_p, falling = self._falling
        both = np.exp(np.interp(-np.log(self._both_cubed(across, valleys)), falling, log_p))
        return np.where(valleys > across, np.clip(both, across, valleys), across)

    def _both_cubed(self, across: FloatArray, valleys: FloatArray) -> FloatArray:
        """12 eta times the conductivity of crests at one pressure and of the thread at another one [m^3]."""
        thread = self._winding * np.mean(self.valley_gaps(valleys) ** 3, axis=-1)
        return np.asarray(np.asarray(self._table.effective_separation(across)) ** 3 + thread)

    @cached_property
    def _falling(self) -> tuple[FloatArray, FloatArray]:
        """ln p, and what falls by that of `_both_cubed` there."""
        p = np.geomspace(self._table.pressure[0], _NEARLY_FLAT * self.contact_pressure, 10 * _NOMINAL)
        return np.log(p), -np.log(self._both_cubed(p, p))

    def first_loading(self, log_pressure: ArrayLike, log_largest: ArrayLike) -> FloatArray:
        """See `leak.flow.conductivity.LoadMemory.first_loading`; of crests that stand out of the fine roughness."""
        log_p, log_top = np.broadcast_arrays(
            np.asarray(log_pressure, dtype=float), np.asarray(log_largest, dtype=float)
        )
        result = np.array(log_p)
        harder = np.isfinite(log_p) & (log_top > log_p)
        if self.hardness is None or not np.any(harder):
            return result
        known, drops = self._drops
        # a larger one than is known counts as the largest known one
        log_p = log_p[harder]
        log_top = np.clip(
            log_top[harder], log_p, np.maximum(log_p, np.minimum(known[-1], log_p + _FALLS[-1]))
        )
        drop = drops(log_top - log_p)
        at = np.interp(log_top, known, np.arange(known.size))
        lower, places = np.minimum(at.astype(int), known.size - 2), np.arange(at.size)
        drop = drop[lower, places] + (at - lower) * (drop[lower + 1, places] - drop[lower, places])
        result[harder] = np.clip(log_top - drop, log_p, log_top)
        return result

    @cached_property
    def _drops(self) -> tuple[FloatArray, PchipInterpolator]:
        """ln of the largest pressures, and of each of them ln(largest/p*) over ln(largest/p)."""
        from scipy.interpolate import PchipInterpolator

        from leak.theory.coined_crest import CoinedCrests

        share, states, lines = self._lost_share, self._path, self.lines
        sealed, drops = _SEALED * states[0].gap_cubed, []
        # once nothing flows, a larger load changes little more
        states = states[: 1 + sum(state.gap_cubed > sealed for state in states)]
        for state in states:
            coined = CoinedCrests(lines, state.level, state.width, self._yielded_share)
            pressures, gaps = zip(*coined.lift(), strict=True)
            p, k = (
                np.array(pressures),
                np.array([self._in_series(self._throats(gap, coined.flat)) for gap in gaps]),
            )
            u = np.cbrt(np.maximum(k, sealed) if share > 0.0 else np.where(k > sealed, k, 0.0))
            if share > 0.0:
                acts = self._rough.equivalent_first_loading_pressure(p, p[0])
                u = u ** (1.0 - share) * np.asarray(self._rough_table.effective_separation(acts)) ** share
            log_p = np.log(p)
            ends = log_p, np.full(p.size, log_p[0])
            drop = log_p[0] - bisect_roots(partial(self._lets_more_through, u), *ends)[1]
            drops.append(PchipInterpolator(log_p[0] - log_p, np.maximum.accumulate(drop))(_FALLS))
        return np.log([state.pressure for state in states]), PchipInterpolator(_FALLS, drops, axis=1)

    def _lets_more_through(self, u: FloatArray, log_p: FloatArray) -> BoolArray:
        """Whether u_eff of first loading at ln(p/Pa) is above u [m]."""
        return self._table.at_log_pressure(log_p) > u

    def _acts(
        self,
        pressure: ArrayLike,
        largest: ArrayLike | None,
        strain: tuple[ArrayLike, ...] | None = None,
    ) -> FloatArray:
        """Pressure of first loading that stands for what acts after a larger one, over a strained bulk [Pa]."""
        p = _checked(pressure)
        if strain is not None:
            p = self.pressure_at_rest(p, *strain)
            largest = None if largest is None else self.pressure_at_rest(largest, *strain)
        return p if largest is None else self.equivalent_first_loading_pressure(p, largest)

    def mean_separation(self, pressure: ArrayLike, *, largest: ArrayLike | None = None) -> FloatArray | float:
        """Mean gap over the nominal area, valleys included [m]; infinite without pressure.

        Parameters
        ----------
        pressure : array_like
            Nominal [Pa].
        largest : array_like, optional
            See `effective_separation`.
        """
        p = self._acts(pressure, largest)
        gap = np.where(p > 0.0, self._law.gap(np.log(np.maximum(p, _TINY))), np.inf)
        return float(gap) if gap.ndim == 0 else gap

    def critical_separation(
        self, pressure: ArrayLike, *, largest: ArrayLike | None = None
    ) -> FloatArray | float:
        """Gap that the largest particle passes which crosses the crests [m]; zero where none is left.

        At the highest of its openings each crest lets the largest through; the crest with the smallest such opening
        stops it. Crests are known over some hundred waves of the fine roughness; a whole seal is longer and has a few
        higher openings. Where the crests are lost in the roughness it crosses over as `flow_conductivity` does. Along a
        thread what its valley lets pass goes through.

        Parameters
        ----------
        pressure : array_like
            Nominal [Pa].
        largest : array_like, optional
            See `effective_separation`.
        """
        p, share = self._acts(pressure, largest), self._lost_share
        gap = np.ones(p.shape)
        if share < 1.0:
            states = self._path
            opening = np.array([state.least_gap.max(axis=1).min() for state in states])
            log_p = np.log([state.pressure for state in states])
            gap = np.interp(np.log(np.maximum(p, _TINY)), log_p, opening)
            wider = np.asarray(self.mean_separation(p)) - states[0].mean_gap
            gap = (gap + np.where(p < states[0].pressure, wider, 0.0)) ** (1.0 - share)
        if share > 0.0:
            gap = gap * np.asarray(self._rough.critical_separation(p)) ** share
        if self._has_thread:
            gap = np.maximum(gap, self.valley_gaps(p).max(axis=-1))
        return float(gap) if gap.ndim == 0 else gap

    @property
    def _lost_share(self) -> float:
        """How far the crests are lost in the fine roughness, 0 to 1."""
        start, end = np.log(_LOST)
        share = (math.log(self.fine.rms_height / self.texture.crest_height) - start) / (end - start)
        return float(min(max(share, 0.0), 1.0))

    @cached_property
    def _rough(self) -> RoughContact:
        """The fine roughness alone."""
        return RoughContact(
            self.fine, effective_modulus=self.effective_modulus, hardness=self.hardness, theory="corrected"
        )

    def conductivity_table(
        self, p_min: float, p_max: float, num: int | None = None, method: str = "bruggeman"
    ) -> ConductivityTable:
        """Table of u_eff = (12 eta sigma)^(1/3) across the crests, with the thread of a `thread_radius`.

        Made once for all ranges.

        Parameters
        ----------
        p_min, p_max : float
            Range of nominal pressures [Pa]; the table reaches from the first touch to the sealing pressure anyway.
        num : int, optional
            As `RoughContact.conductivity_table` has it; the pressures are those of the levels of the flat.
        method : {"bruggeman"}
            Of the fine roughness where crests are lost in it. Throats know no other.
        """
        self._check_table(p_min, p_max, method)
        return self._thread_liquid if self._has_thread else self._table

    def gas_conductivity_table(
        self, p_min: float, p_max: float, num: int | None = None, method: str = "bruggeman"
    ) -> GasConductivityTable:
        """Table for all gases, as `leak.gas_conductivity_table` makes it of a `RoughContact`; made once.

        A throat of least gap g conducts m g^2/(12 eta Y(p_f g/(eta v0))) of a gas, with
        Y(D) = 2 D^2 times the integral of dt/(t^3 f(t)) from D on, f the `leak.flow.rarefied.flow_factor`.

        Parameters
        ----------
        p_min, p_max, num, method
            See `conductivity_table`.
        """
        self._check_table(p_min, p_max, method)
        return self._thread_table if self._has_thread else self._gas_table

    @cached_property
    def _thread_liquid(self) -> ConductivityTable:
        return self._with_thread(self._table)

    @cached_property
    def _thread_table(self) -> GasConductivityTable:
        return self.with_thread(self._gas_table)

    def with_thread(self, crests: GasConductivityTable) -> GasConductivityTable:
        """Table of crests and thread side by side, which stays open until the crests are pressed flat.

        Parameters
        ----------
        crests : GasConductivityTable
            Of the crests alone, see `rings`.
        """
        if not self._has_thread:
            return crests
        table = self._with_thread(crests.liquid)
        log_p, u = np.log(table.pressure), table.separation
        gas = np.empty((log_p.size, _LOG_D.size))
        for row, (gaps, own) in enumerate(zip(self.valley_gaps(table.pressure), u, strict=True)):
            deep = gaps[gaps > 0.0]
            factor = np.exp(log_flow_factor(_LOG_D[:, None] + np.log(deep / own)))
            gas[row] = self._winding * (factor @ deep**3) / gaps.size
        # the same gas has another inverse Knudsen number in the effective gap of the crests alone
        own_u = crests.liquid.at_log_pressure(log_p)
        own_u = own_u[own_u > 0.0]
        count = own_u.size
        flow = np.exp(crests.log_flow_at(log_p[:count, None])(_LOG_D + np.log(own_u / u[:count])[:, None]))
        gas[:count] += own_u[:, None] ** 3 * flow
        return GasConductivityTable(table, np.log(gas / u[:, None] ** 3) - log_flow_factor(_LOG_D), _LOG_D)

    def _with_thread(self, crests: ConductivityTable) -> ConductivityTable:
        """The same table of a liquid."""
        # between levels as well: near sealing the crests' own table knows where it ends, which that of both does not
        levels = crests.pressure
        places = np.linspace(0.0, levels.size - 1.0, _BETWEEN * (levels.size - 1) + 1)
        known = np.exp(np.interp(places, np.arange(levels.size), np.log(levels)))
        own_u = crests.at_log_pressure(np.log(known))
        known, own_u = known[own_u > 0.0], own_u[own_u > 0.0]
        beyond = np.geomspace(crests.sealing_pressure, _NEARLY_FLAT * self.contact_pressure, _BEYOND)
        beyond = beyond[beyond > 1.001 * known[-1]]
        pressure = np.concatenate([known, beyond])
        across = np.concatenate([own_u**3, np.zeros(beyond.size)])
        u = np.cbrt(across + self._winding * np.mean(self.valley_gaps(pressure) ** 3, axis=1))
        sealing = self.contact_pressure
        return ConductivityTable(pressure, u, sealing, sealing, memory=self._table.memory)

    @property
    def _winding(self) -> float:
        """Square of the way across the contact over that along the thread [-]."""
        return (self.texture.mean_feed / (2.0 * math.pi * self.thread_radius)) ** 2

    def valley_gaps(self, pressure: ArrayLike) -> FloatArray:
        """Gaps across a valley under the flat, which stands as high above it as the mean gap says [m].

        Parameters
        ----------
        pressure : array_like
            Nominal, positive [Pa].

        Returns
        -------
        ndarray, shape (..., n)
            At evenly spaced places from the crest to the middle of the valley; of two faces, of all that repeats.
        """
        level = np.asarray(self.mean_separation(pressure)) - self.texture.mean_depth
        return np.asarray(np.maximum(level[..., None] + self.texture.depths, 0.0))

    def thread_share(self, pressure: ArrayLike) -> FloatArray:
        """Conductivity of the thread over that of thread and crests [-]; zero for rings.

        Parameters
        ----------
        pressure : array_like
            Nominal, positive [Pa].
        """
        if not self._has_thread:
            return np.zeros(_checked(pressure).shape)
        thread = np.asarray(self.spiral_conductivity(pressure, 1.0, self.thread_radius))
        return np.asarray(thread / (thread + np.asarray(self.flow_conductivity(pressure, 1.0))))

    @property
    def nearly_sealed_pressure(self) -> float:
        """Where the conductivity has fallen to three thousandths; beyond it direct simulations say no more [Pa].

        Of what it is where half a hundredth of the face touches, as it does at first in the direct simulations.
        """
        start, sealing = _BEARS * self.contact_pressure, self.sealing_pressure
        pressure = np.geomspace(min(start, 0.5 * sealing), sealing, _NOMINAL)
        sigma = np.asarray(self.flow_conductivity(pressure, 1.0))
        return float(pressure[np.argmax(sigma <= _NEARLY * sigma[0])])

    def _check_table(self, p_min: float, p_max: float, method: str) -> None:
        low, high = (
            positive(ConductivityError, "p_min", p_min, "Pa"),
            positive(ConductivityError, "p_max", p_max, "Pa"),
        )
        if not low < high:
            raise ConductivityError(f"p_min = {p_min} and p_max = {p_max}: p_min must be below p_max [Pa]")
        if method != "bruggeman":
            raise ConductivityError(f"method = {method!r}: a turned face knows 'bruggeman' only")

    @cached_property
    def _table(self) -> ConductivityTable:
        share, sealing = self._lost_share, self.sealing_pressure
        if share == 1.0:
            return self._rough.conductivity_table(_LOWEST * sealing, sealing)
        flowing = self._flowing
        pressure = np.array([state.pressure for state in flowing])
        u = np.cbrt([state.gap_cubed for state in flowing])
        if share > 0.0:
            # crests that are sealed by themselves still take part in the crossover, by what they were sealed at
            more = np.geomspace(pressure[-1], sealing, _BEYOND + 2)[1:-1]
            u = np.concatenate([u, np.full(_BEYOND, np.cbrt(_SEALED * self._path[0].gap_cubed))])
            pressure = np.concatenate([pressure, more])
            u = u ** (1.0 - share) * np.asarray(self._rough_table.effective_separation(pressure)) ** share
        # before the first touch all gaps open as the law of the interface says, and then go on with ln p
        before = pressure[0] * np.exp(-np.arange(_BEFORE_TOUCH, 0, -1))
        wider = np.asarray(self.mean_separation(before)) - flowing[0].mean_gap
        opened = np.cbrt(
            [
                self._in_series(self._throats(flowing[0].least_gap + more)) / flowing[0].gap_cubed
                for more in wider
            ]
        )
        pressure, u = np.concatenate([before, pressure]), np.concatenate([u[0] * opened, u])
        return ConductivityTable(pressure, u, sealing, sealing, memory=self)

    @cached_property
    def _rough_table(self) -> ConductivityTable:
        """Of the fine roughness alone."""
        return self._rough.conductivity_table(_LOWEST * self.sealing_pressure, self._rough.sealing_pressure)

    @cached_property
    def _gas_table(self) -> GasConductivityTable:
        share, sealing, liquid = self._lost_share, self.sealing_pressure, self._table
        if share == 1.0:
            return gas_conductivity_table(self._rough, _LOWEST * sealing, sealing)
        log_u = np.log(liquid.separation[_BEFORE_TOUCH:])
        flows = np.stack([self._log_gas_flow(*pair) for pair in zip(self._flowing, log_u, strict=False)])
        flows = np.pad(flows, ((_BEFORE_TOUCH, _BEYOND if share > 0.0 else 0), (0, 0)), mode="edge")
        if share > 0.0:
            top = self._rough.sealing_pressure
            rough, log_p = (
                gas_conductivity_table(self._rough, _LOWEST * sealing, top),
                np.log(liquid.pressure)[:, None],
            )
            # the same gas has another inverse Knudsen number in another effective gap
            wider = np.log(rough.at_log_pressure(log_p) / liquid.separation[:, None])
            of_rough = rough.log_flow_at(log_p)(_LOG_D + wider)
            flows = (1.0 - share) * flows + share * of_rough
        return GasConductivityTable(liquid, flows - log_flow_factor(_LOG_D), _LOG_D)

    def _log_gas_flow(self, state: _State, log_u: float) -> FloatArray:
        """ln of a gas's flow through all throats over that of a liquid, at `_LOG_D` of an effective gap."""
        throats = self._throats(state.least_gap)
        liquid, gas = throats.sum(axis=1), np.zeros((len(throats), _LOG_D.size))
        for number, gaps in enumerate(of_each(state.least_gap, len(self._crests))):
            is_open = gaps > 0.0
            if is_open.any():
                # of the liquid's flow, m g^2, so much goes through gaps of about this size
                log_gap, weights = np.log(gaps[is_open]), throats[number, is_open]
                flow, ends = np.histogram(log_gap, bins=_LOG_THROAT.size, weights=weights)
                gas[number] = (
                    np.exp(_log_throat(_LOG_D[:, None] + 0.5 * (ends[1:] + ends[:-1]) - log_u)) @ flow
                )
        resistances = ((1.0 / (self._alike @ flows)).sum(axis=0) for flows in (liquid, gas))
        return np.asarray(np.log(next(resistances)) - np.log(next(resistances)))

    @property
    def _flowing(self) -> list[_State]:
        """States from which something flows, below the sealing pressure."""
        states, sealing = self._path, self.sealing_pressure
        return [
            state
            for state in states
            if state.gap_cubed > _SEALED * states[0].gap_cubed and state.pressure < sealing
        ]

    @cached_property
    def sealing_pressure(self) -> float:
        """From here on nothing flows across the crests; of crests whose last places are not known, beyond them [Pa]."""
        share = self._lost_share
        if share == 1.0:
            return self._rough.sealing_pressure
        states = self._path
        sealed = (state.pressure for state in states if state.gap_cubed <= _SEALED * states[0].gap_cubed)
        crests = next(sealed, 1.1 * states[-1].pressure)
        rough = self._rough.sealing_pressure
        return min(crests ** (1.0 - share) * rough**share, rough) if share > 0.0 else crests

    def effective_separation(
        self, pressure: ArrayLike, method: str = "bruggeman", *, largest: ArrayLike | None = None
    ) -> FloatArray | float:
        """u_eff = (12 eta sigma)^(1/3) across the crests [m], see `conductivity_table`.

        Parameters
        ----------
        pressure : array_like
            Nominal [Pa].
        method : {"bruggeman"}
        largest : array_like, optional
            Largest nominal pressure that the place has carried, counting where it exceeds `pressure`; broadcast
            against it [Pa]. What yielded then does not come back: the gaps are those of first loading at
            `equivalent_first_loading_pressure`.
        """
        self._check_table(1.0, 2.0, method)
        return self._table.effective_separation(self._acts(pressure, largest))

    def flow_conductivity(
        self,
        pressure: ArrayLike,
        viscosity: float,
        method: str = "bruggeman",
        *,
        largest: ArrayLike | None = None,
    ) -> FloatArray | float:
        """Across the crests, without the thread [m^3/(Pa s)], by `conductivity_table`.

        Where the fine roughness is as high as the crests the face is that roughness, by the corrected theory of
        `RoughContact`; between both the logarithm of the conductivity crosses over that of their ratio.

        Parameters
        ----------
        pressure : array_like
            Nominal, positive [Pa].
        viscosity : float
            [Pa s]
        method : {"bruggeman"}
        largest : array_like, optional
            See `effective_separation`.
        """
        self._check_table(1.0, 2.0, method)
        return self._table.conductivity(self._acts(pressure, largest), viscosity)

    def flow_error(
        self,
        pressure: ArrayLike,
        *,
        waves: float = math.inf,
        largest: ArrayLike | None = None,
        strain: tuple[ArrayLike, ...] | None = None,
    ) -> FlowError:
        """How far the flow conductivity may be from direct simulation; wide where the face is nearly sealed.

        Simulated cells of two short crests in series let less through than a long seal; of their mean deviation
        half is taken off, as they do so where the crests are wide open, too.

        Parameters
        ----------
        pressure : array_like
            Nominal, positive [Pa].
        waves : float
            Median wave lengths of the fine roughness squared that the sealing area holds; without end, the error of
            the theory alone [-].
        largest : array_like, optional
            Largest nominal pressure that the place has carried [Pa]. What opens again depends on what was pressed flat
            then: as far as crests yield the spread is that of first loading under this pressure.
        strain : tuple of array_like, optional
            Of the bulk, see `pressure_at_rest`; what its law is not known by widens the spread [-].

        References
        ----------
        benchmarks/turned_error.py finds the numbers, from direct simulations of twenty faces.
        """
        if not waves > 0.0:
            raise ConductivityError(f"waves = {waves}: must be positive [-]")
        strain = strain if strain is not None and any(map(np.any, strain)) else None
        share = self._lost_share
        p = self._acts(pressure, largest, strain)
        of_rough = self._rough.flow_error(p, waves=waves) if share > 0.0 else None
        if of_rough is not None and share == 1.0 and strain is None:
            return of_rough
        most = p if largest is None else np.maximum(p, self._acts(largest, None, strain))
        with np.errstate(divide="ignore"):
            now, then = (
                np.clip(3.0 * np.log10(self._table.separation[0] / u), 0.0, _FALLEN[-1])
                for u in map(self._table.effective_separation, (p, most))
            )
        fallen = now + self._yielded_share * (then - now)
        theory = np.interp(fallen, _FALLEN, _SPREAD) ** 2
        length = 2.0 * math.pi / self.fine.median_wavenumber
        sample = (
            (_OPEN_PLACES * 10.0 ** (_FEWER_PLACES * fallen)) ** 2 * self.crest_distance / (waves * length)
        )
        parts = {"turned crests": theory, "few waves": sample}
        bias = np.full(fallen.shape, _MEAN)
        if of_rough is not None:
            bias = share * of_rough.bias + (1.0 - share) * (_MEAN + _HALF_LOST * 4.0 * share)
            parts = {name: (1.0 - share) * part for name, part in parts.items()}
            parts["fine roughness"] = share * of_rough.spread**2
        # of the thread nothing is left open
        of_crests = 1.0 - self.thread_share(p)
        parts = {name: of_crests**2 * part for name, part in parts.items()}
        if strain is not None:
            further = [_STRAIN_FACTOR * np.asarray(e) for e in strain[:2]]
            table = self._thread_liquid if self._has_thread else self._table
            ends = p, self._acts(pressure, largest, (*further, *strain[2:]))
            u = [np.maximum(table.effective_separation(acts), _TINY) for acts in ends]
            parts["bulk flow"] = np.minimum(3.0 * np.log(u[0] / u[1]), _SPREAD[-1]) ** 2
        return FlowError(of_crests * bias, np.sqrt(sum(parts.values())), parts)

    def spiral_conductivity(self, pressure: ArrayLike, viscosity: float, radius: float) -> FloatArray | float:
        """Of the thread from the outside to the inside, to be added to that across the crests [m^3/(Pa s)].

        Each turn leads the fluid around by 2 pi r_0 while it comes nearer by f.

        Parameters
        ----------
        pressure : array_like
            Nominal, positive [Pa].
        viscosity : float
            [Pa s]
        radius : float
            r_0 of the contact [m].
        """
        eta = positive(ConductivityError, "viscosity", viscosity, "Pa s")
        r_0 = positive(ConductivityError, "radius", radius, "m")
        winding = replace(self, thread_radius=r_0)._winding
        sigma = np.mean(self.valley_gaps(pressure) ** 3, axis=-1) * winding / (12.0 * eta)
        return float(sigma) if sigma.ndim == 0 else sigma


# crests that yield and those that do not are of one roughness
@lru_cache(maxsize=_MAPS)
def _heights_of(fine: PowerSpectrum, spacing: float, seed: int) -> FloatArray:
    return random_map(fine, size=_PLACES * spacing, points=_PLACES, seed=seed)


@lru_cache(maxsize=32)
def _load(face: TurnedContact) -> tuple[_State, ...]:
    """First loading, level by level, until the crests are flat or no more is known of them."""
    lines = face.lines
    tops = lines.rough_tops
    level = float(lines.smooth.max()) + float(tops.mean()) + _FIRST * float(tops.std())
    step = _STEP * float(tops.std())
    states: list[_State] = []
    width: FloatArray | None = None
    for _ in range(_MOST_LEVELS):
        try:
            pressed = lines.press(level, width)
        except SurfaceError:
            break
        width, state = pressed.width, face._state(pressed)
        if state.mean_gap < _CLOSED * face.texture.crest_height:
            break
        # crests of two faces that are wide beside their distance push up more than is known of them
        flat = state.pressure > _NEARLY_FLAT * face.contact_pressure
        if flat or (states and state.mean_gap >= states[-1].mean_gap):
            break
        if state.pressure > 0.0:
            states.append(state)
            if state.gap_cubed <= _SEALED * states[0].gap_cubed:
                # the gap alone goes on, and is smooth
                step *= _GROWTH
        level -= step
    return tuple(states)


def _log_throat(log_inverse_knudsen: FloatArray) -> FloatArray:
    """ln of a gas's flow through a throat over that of a liquid, at ln D of its least gap."""
    x, log_factor = _throats()
    # free molecules below: the flow goes with 1/D
    below = np.minimum(log_inverse_knudsen - x[0], 0.0)
    return np.asarray(np.interp(log_inverse_knudsen, x, log_factor) - below)


@lru_cache(maxsize=1)
def _throats() -> tuple[FloatArray, FloatArray]:
    """ln D and ln of the factor 1/(2 D^2 times the integral of dt/(t^3 f(t)) from D on).

    Over s = ln t the integrand is exp(-2 s)/f: between two places its logarithm is straight.
    """
    x = _LOG_THROAT
    y = -2.0 * x - log_flow_factor(x)
    rate = -np.diff(y) / np.diff(x)
    parts = np.exp(y[:-1]) * -np.expm1(-rate * np.diff(x)) / rate
    rest = np.cumsum(np.append(parts, 0.5 * np.exp(y[-1]))[::-1])[::-1]
    return x, -np.log(2.0 * rest) - 2.0 * x


def _checked(pressure: ArrayLike) -> FloatArray:
    p = np.asarray(pressure, dtype=float)
    if not np.all(np.isfinite(p) & (p >= 0.0)):
        raise SurfaceError(f"pressure = {pressure!r}: must be finite and not negative [Pa]")
    return p


FaceContact: TypeAlias = RoughContact | TurnedContact
"""Two faces that touch, of any kind."""


def calculated_table(
    surface: FaceContact, p_min: float, p_max: float, num: int | None = None, *, of_gas: bool
) -> AnyTable:
    """Flow conductivity of faces of any kind over a range of contact pressures.

    Parameters
    ----------
    surface : FaceContact
    p_min, p_max, num
        See `RoughContact.conductivity_table`.
    of_gas : bool
        For all gases, see `leak.gas_conductivity_table`.
    """
    if isinstance(surface, TurnedContact):
        return (surface.gas_conductivity_table if of_gas else surface.conductivity_table)(p_min, p_max, num)
    if of_gas:
        return gas_conductivity_table(surface, p_min, p_max, num)
    return surface.conductivity_table(p_min, p_max, num)
