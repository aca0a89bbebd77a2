"""Flow conductivity of surfaces close to one whose table is known, from few pressures."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import FloatArray
from leak.flow.conductivity import (
    AnyTable,
    ConductivityTable,
    GasConductivityTable,
    LoadMemory,
    logarithmic,
    table_abscissa,
)
from leak.flow.rough_contact import RoughContact, asked_by, elastic_range, gas_conductivity_table
from leak.numerics.curves import MonotoneCurve, cubic_spline_slopes, lagrange, spline_weights
from leak.numerics.integrals import sorted_unique
from leak.surfaces.spectrum import PowerSpectrum

# Surfaces are calculated at the highest pressures of their contacts and at places below, in steps of the abscissa of
# the tables that widen with the distance from the next higher of them: a step is this long, and this share of the
# distance longer, down to this distance from the last, and to low pressures. These end at the next number; above it, up
# to sealing, no step is longer than the last.
_STEP, _WIDENING, _DEEPEST = 0.4, 0.55, 10.0
_LOW, _LONGEST = -2.5, 1.5
# All places are on a lattice, so that many surfaces share what is needed of the known one.
_LATTICE, _NEIGHBOURS = 0.25, np.arange(-2.0, 3.0)
# By so much of themselves densities of one shape may differ from each other.
_SAME = 1e-10
# Profiles may rise a little above the highest pressure between their points.
_ABOVE = 1.02
# The known table reaches from this share of the sealing pressure; no highest pressure counts as lower than the next,
# and nothing is calculated closer to sealing than the last.
_LOWEST, _LEAST, _CLOSEST = 1e-9, 1e-7, 0.98
# A spectrum with more kinks is calculated as so many power laws.
_PIECES = 14
# Both surfaces are calculated with so many times the usual points: what that changes is the same for both.
_DETAIL = 0.9
# ln of the inverse Knudsen numbers of a gas at which a surface is calculated.
_LOG_D = np.array([-9.0, -5.5, -3.0, -1.0, 1.2, 3.7, 6.5])
# A gap over the rms height that is none; a table calls it zero. Where its logarithm is half as far, nothing leaks yet.
_NOTHING = 1e-56
_LOG_CLOSED = 0.5 * float(np.log(_NOTHING))
# Places with a gap, fewer of which are those of contacts that all but seal.
_FEWEST = 4
# Steps in ln(hardness/(E* h)) between which what is known of one shape of the spectrum is interpolated.
_SPACING = 0.1
_LOG_SHARES = np.concatenate(
    [np.linspace(-60.0, -4.0, 1001), np.log1p(-np.geomspace(1.0 - np.exp(-4.0), 1e-4, 4001))[1:]]
)


class _Values(NamedTuple):
    """Of one surface at n pressures."""

    gap: FloatArray
    """u_eff over half the rms height, as the tables are smooth in it, shape (n,)."""
    log_rarefaction: FloatArray
    """Of a gas: ln R at `_LOG_D`, shape (n, 7)."""

    def first(self, number: int) -> _Values:
        return _Values(self.gap[:number], self.log_rarefaction[:number])


@dataclass(frozen=True, eq=False)
class NearbyTables:
    """Tables of surfaces close to one whose table is known.

    Two surfaces that differ little have gaps that differ smoothly at equal p/p_seal. What is interpolated over about
    seven pressures is that difference, of both calculated alike: with many kinks in the spectrum as some fourteen power
    laws (`PowerSpectrum.coarse`); the known table holds the rest. Surfaces that differ in height, modulus and hardness
    alone share what is calculated: at equal p/p_seal elastic ones are the same, others depend on hardness/(E* h) alone,
    over which there are values in steps of a tenth. So it is for what the averaging over unequal gaps
    adds for a gas. A capped surface is the elastic one at another pressure.

    Parameters
    ----------
    surface : RoughContact
        The known one.
    of_gas : bool
        Whether the tables are of a gas, `GasConductivityTable`.
    method : {"bruggeman", "critical-junction", "threshold-law"}
        See `RoughContact.effective_separation`.
    within : tuple of float, optional
        Range of pressures over which the known surface has a table already, by `RoughContact.conductivity_table` or
        `gas_conductivity_table`. It serves whoever needs no higher pressures; else there is one up to sealing [Pa].

    Notes
    -----
    Leak rates are mostly off by less than 0.5 %, at most by 0.8 % up to two thirds of the sealing pressure, mostly
    2 % above (a contact that all but sealed was off by 13 %), where their contacts' highest pressures were given:
    whoever needs to know compares some with the surfaces' own tables, as `fem_seal`'s intervals do.

    Examples
    --------
    >>> import leak
    >>> shape = dict(rms_height=1e-6, q_low=1e4, q_rolloff=5e4, q_high=1e6)
    >>> known, close = (
    ...     leak.RoughContact(leak.PowerSpectrum.self_affine(hurst=H, **shape), effective_modulus=115e9)
    ...     for H in (0.8, 0.75)
    ... )
    >>> table = leak.NearbyTables(known).table(close, 1e8)
    >>> bool(abs(table.effective_separation(9e7) / close.effective_separation(9e7) - 1) < 1e-3)
    True
    """

    surface: RoughContact
    of_gas: bool = False
    method: str = "bruggeman"
    within: tuple[float, float] | None = None
    _known_values: dict[int, dict[float, tuple[float, FloatArray]]] = field(default_factory=dict, repr=False)

    def table(self, surface: RoughContact, highest: ArrayLike) -> AnyTable:
        """Conductivity of a surface close to the known one, and of the same reading of yielding.

        Parameters
        ----------
        surface : RoughContact
        highest : array_like
            Highest pressures of the contacts, of each or of those with the highest and the lowest [Pa]. Above them the
            table goes on to the sealing pressure, for the flanks of contacts that are sealed anyway; of contacts whose
            highest pressure is above that there is nothing to know.
        """
        p = np.atleast_1d(np.asarray(highest, dtype=float))
        if surface.equivalent_elastic_surface is not None:
            return asked_by(
                surface,
                self._equivalent_elastic_tables.table(
                    surface.equivalent_elastic_surface, surface.equivalent_pressure(p)
                ),
            )
        sealing = surface.sealing_pressure_by(self.method)
        p = _ABOVE * p[p < sealing]
        if not p.size:
            return self._unlimited._scaled(surface, sealing)
        places = self._places(p / sealing)
        if places[-1] > _LATTICE * self._last:
            return self._unlimited.table(surface, highest)
        ours, theirs = self._of(surface, sealing, places), self._of_hardness(0, places)
        # between gaps of nothing there is nothing to interpolate
        number = int(np.count_nonzero(np.minimum(ours.gap, theirs.gap) > _LOG_CLOSED))
        if number < _FEWEST:
            return self._scaled(surface, sealing)
        places, ours, theirs = places[:number], ours.first(number), theirs.first(number)
        liquid = self._known.liquid
        log_sealing = np.log(liquid.sealing_pressure)
        x = np.log(liquid.pressure) - log_sealing
        inside = int(np.count_nonzero(self._abscissa(x) < places[-1] - 1e-3))
        x = np.append(x[:inside], self._log_share(places[-1:]))
        abscissa = self._abscissa(x)
        known = _smooth(liquid.at_log_pressure(x + log_sealing), self.surface)
        change = ours.gap - theirs.gap
        slopes = cubic_spline_slopes(places, change)
        # far below the lowest place both follow their laws at low pressure: what a spline ends with would go astray
        slopes[0] = self.surface.u0 / _length(self.surface) - surface.u0 / _length(surface)
        y = known + MonotoneCurve(places, change, slopes).value(abscissa)
        u = _length(surface) * np.logaddexp(0.0, y)
        found = ConductivityTable(np.exp(x) * sealing, u, sealing, np.inf, self.method, LoadMemory(surface))
        if not isinstance(self._known, GasConductivityTable):
            return found
        log_D = self._known.log_inverse_knudsen
        last = self._known.log_rarefaction_at(x[-1] + log_sealing)(log_D)
        rise = spline_weights(places, np.clip(abscissa, places[0], places[-1])) @ (
            ours.log_rarefaction - theirs.log_rarefaction
        )
        log_R = np.vstack([self._known.log_rarefaction[:inside], last]) + rise @ self._between_log_D.T
        return GasConductivityTable(found, log_R, log_D)

    @cached_property
    def _between_log_D(self) -> FloatArray:
        """From values at `_LOG_D` to those at the inverse Knudsen numbers of the known table."""
        assert isinstance(self._known, GasConductivityTable)  # of a gas
        return spline_weights(_LOG_D, np.clip(self._known.log_inverse_knudsen, _LOG_D[0], _LOG_D[-1]))

    def _scaled(self, surface: RoughContact, sealing: float) -> AnyTable:
        """The known table at equal p/p_seal: of contacts that all seal, to less than a molecule, it says so as well."""
        known = self._known.liquid
        height, pressure = _length(surface) / _length(self.surface), sealing / known.sealing_pressure
        return self._known.with_liquid(known.scaled(height, pressure, LoadMemory(surface)))

    @cached_property
    def _equivalent_elastic_tables(self) -> NearbyTables:
        assert self.surface.equivalent_elastic_surface is not None  # of all who ask
        within = None if self.within is None else elastic_range(self.surface, self.within, self.method)
        return replace(self, surface=self.surface.equivalent_elastic_surface, within=within, _known_values={})

    @cached_property
    def _unlimited(self) -> NearbyTables:
        """With a known table up to the sealing pressure."""
        return self if self.within is None else replace(self, within=None)

    @cached_property
    def _known(self) -> AnyTable:
        sealing = self.surface.sealing_pressure_by(self.method)
        ends = self.within or (_LOWEST * sealing, sealing)
        if self.of_gas:
            return gas_conductivity_table(self.surface, *ends, method=self.method)
        return self.surface.conductivity_table(*ends, method=self.method)

    def _of(self, surface: RoughContact, sealing: float, places: FloatArray) -> _Values:
        """What is interpolated; at equal p/p_seal it depends on shape and hardness/(E* h) alone."""
        height = height_ratio(surface, self.surface)
        if height is None:
            return self._at(surface, sealing, places)
        if surface.hardness is None or self.surface.hardness is None:
            return self._of_hardness(0, places)
        stiffer = height * surface.effective_modulus / self.surface.effective_modulus
        steps = float(np.log(surface.hardness / self.surface.hardness / stiffer)) / _SPACING
        first = int(np.floor(steps)) - 1
        weights = lagrange(steps - first)
        found = [self._of_hardness(first + n, places) for n in range(4)]
        gap, log_R = (sum(w * one[n] for w, one in zip(weights, found, strict=True)) for n in range(2))
        return _Values(np.asarray(gap), np.asarray(log_R))

    def _of_hardness(self, step: int, places: FloatArray) -> _Values:
        """Of the known surface with its hardness times exp(0.1 step), kept at all places."""
        known = self._known_values.setdefault(step, {})
        if not known.keys() >= set(places.tolist()):
            # also for contacts that carry a little more or less: many pressures at once cost little more than few
            wanted = places[:, None] + _LATTICE * _NEIGHBOURS
            new = sorted_unique(wanted[wanted <= _LATTICE * self._last])
            new = np.array([one for one in new.tolist() if one not in known])
            surface = self.surface
            if step and surface.hardness is not None:
                surface = replace(surface, hardness=surface.hardness * float(np.exp(_SPACING * step)))
            found = self._at(surface, surface.sealing_pressure_by(self.method), new)
            values = zip(found.gap.tolist(), found.log_rarefaction, strict=True)
            known.update(zip(new.tolist(), values, strict=True))
        gaps, log_R = zip(*(known[one] for one in places.tolist()), strict=True)
        return _Values(np.array(gaps), np.array(log_R))

    def _at(self, surface: RoughContact, sealing: float, places: FloatArray) -> _Values:
        """What is interpolated, of all surfaces in the same way."""
        few = self.surface.spectrum.break_moments.size > _PIECES
        rarefied = self.of_gas and self.method == "bruggeman"
        p = sealing * np.exp(self._log_share(places))
        return _calculated(surface, tuple(p.tolist()), self.method, few, rarefied)

    def _places(self, shares: FloatArray) -> FloatArray:
        """Where in the abscissa surfaces are calculated, for highest pressures over that of sealing."""
        wanted = np.ceil(self._abscissa(np.log(np.clip(shares, _LEAST, _CLOSEST))) / _LATTICE + 1e-6)
        tops = sorted(set(np.minimum(wanted, self._highest).tolist()))
        below, near = [tops.pop()], 0.0
        last = tops[0] if tops else below[0]
        # next to sealing the distance is a few per cent of the pressure, and the flanks of the contact leak far below
        while below[-1] > min(last - _DEEPEST / _LATTICE, _LOW / _LATTICE):
            longest = _LONGEST if below[-1] * _LATTICE > _LOW else _DEEPEST
            step = min(round(_STEP / _LATTICE + _WIDENING * near), round(longest / _LATTICE))
            following = below[-1] - step
            near += step
            while tops and tops[-1] >= following - 1:
                highest = tops.pop()
                if highest < below[-1] - 1:
                    following, near = highest, 0.0
                    break
            below.append(following)
        return _LATTICE * np.array(below[::-1])

    @cached_property
    def _highest(self) -> float:
        """The last place, in steps of the lattice."""
        return self._place_below(_CLOSEST)

    @cached_property
    def _last(self) -> float:
        """The last one to which the known table reaches."""
        if self.within is None:
            return self._highest
        return self._place_below(
            min(self.within[1] / self.surface.sealing_pressure_by(self.method), _CLOSEST)
        )

    def _place_below(self, share: float) -> float:
        """The last place below a share of the sealing pressure, in steps of the lattice."""
        return float(np.floor(self._abscissa(np.log(np.array([share])))[0] / _LATTICE))

    def _abscissa(self, log_share: FloatArray) -> FloatArray:
        return table_abscissa(log_share, 0.0, self.method)

    def _log_share(self, abscissa: FloatArray) -> FloatArray:
        """ln(p/p_seal), the inverse of `_abscissa`."""
        return np.interp(abscissa, self._even, _LOG_SHARES)

    @cached_property
    def _even(self) -> FloatArray:
        return self._abscissa(_LOG_SHARES)


@lru_cache(maxsize=128)  # neighbouring seals ask for the same surfaces
def _calculated(
    surface: RoughContact, pressures: tuple[float, ...], method: str, few: bool, rarefied: bool
) -> _Values:
    p = np.array(pressures)
    coarse = replace(surface, spectrum=_few_power_laws(surface.spectrum)) if few else surface
    if not rarefied:
        u = np.asarray(coarse.effective_separation(p, method, refinement=_DETAIL))
        return _Values(_smooth(u, surface), np.zeros((p.size, _LOG_D.size)))
    u, log_R = coarse.rarefied_separation(p, _LOG_D, refinement=_DETAIL)
    log_R[u <= _NOTHING * _length(surface)] = 0.0
    return _Values(_smooth(u, surface), log_R)


@lru_cache(maxsize=4)  # both readings of a surface that yields ask for the same
def _few_power_laws(spectrum: PowerSpectrum) -> PowerSpectrum:
    return spectrum.coarse(_PIECES)


def height_ratio(surface: RoughContact, other: RoughContact) -> float | None:
    """Heights of a surface over those of another one, if nothing but height, modulus and hardness differs; else None.

    Parameters
    ----------
    surface, other : RoughContact
    """
    q, C = other.spectrum.wavenumber, other.spectrum.density
    if not np.array_equal(surface.spectrum.wavenumber, q) or (surface.hardness is None) != (
        other.hardness is None
    ):
        return None
    ratio = surface.spectrum.density / C
    like = replace(
        surface, spectrum=other.spectrum, effective_modulus=other.effective_modulus, hardness=other.hardness
    )
    if like != other or np.abs(ratio / ratio[0] - 1.0).max() > _SAME:
        return None
    return float(np.sqrt(ratio[0]))


def _length(surface: RoughContact) -> float:
    return 0.5 * surface.spectrum.rms_height


def _smooth(gap: FloatArray, surface: RoughContact) -> FloatArray:
    """What is interpolated of u_eff; far below any gap next to sealing."""
    return logarithmic(np.maximum(gap / _length(surface), _NOTHING))
