"""Flow across a contact that is only a few waves of its roughness wide.

An effective medium is endless: above a percolation threshold no channel is open. A short piece conducts more. Channels
that are dead ends in the endless medium reach both of its edges, and it is open at contact areas at which the endless
one is sealed. Here the piece is an effective medium of its own, whose number n = 1/(1 - a_c) grows with N^(-5/4), N the
waves across: of the order of the finite-size shift of a percolation threshold, N^(-1/nu) with nu = 4/3, and faster,
since the edges let the fluid in everywhere. Both constants come from strips cut out of simulated maps (elastic, three
spectra, contact areas up to 0.25, 1 to 8 waves; theory/gap in the manual). No seal is in them.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from typing import NamedTuple, Self

import numpy as np

from leak.arrays import FloatArray
from leak.errors import ConductivityError
from leak.flow.conductivity import AlikeTables, AnyTable, ConductivityTable
from leak.flow.contact_profile import ContactProfile, checked_profile
from leak.flow.medium import area_argument_at, dimension_number
from leak.flow.rough_contact import RoughContact
from leak.numerics.curves import lagrange
from leak.numerics.roots import root_of_rising
from leak.surfaces.spectrum import PowerSpectrum

# n/n_endless - 1 = (_OPEN + _TOUCHING A/A0) N^_EXPONENT
_OPEN_TERM, _CONTACT_TERM, _EXPONENT = 0.25, 1.2, -1.25
# Where the pressure is below this share of its peak next to nothing of the resistance lies.
_FAINT = 1e-4
# Of ln n; the conductivity follows to a few times as much.
_CLOSE = 1e-5
# Waves below which a piece is taken to open no further: a sealed place may be as narrow as a point, and the tables end.
# With a third of them gaps would be 1 to 7 % wider up to half of the sealing pressure, 20 % near it.
_FEWEST = 0.01
# Shares of the peak pressure at which peaks are cut off; between them the leak rate is up to 2 % too large.
_CUTS = (0.95, 0.88, 0.78, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2)
# Steps of ln n between which tables are interpolated; from which share of the sealing pressure on those of the standard
# spectrum reach, and at so many pressures.
_SPACING, _LOWEST_SHARE, _NODES = 0.1, 1e-9, 50
# Pressures of a contact at which its area is calculated: it enters as a mean.
_AREAS = 16


class ShortMedium(NamedTuple):
    """What decides how open a short contact is.

    Examples
    --------
    >>> ShortMedium(2.0, 0.1, 0.48).waves
    2.0
    """

    waves: float
    """Waves of the roughness across the width that resists [-]."""
    contact_area: float
    """A/A0 there [-]."""
    percolation_threshold: float
    """A/A0 from which on nothing flows [-]."""


def short_threshold(waves: float, contact_area: float, endless: float = 0.42) -> float:
    """A/A0 from which on nothing flows across a piece of rough contact [-].

    Parameters
    ----------
    waves : float
        Wavelengths of the roughness across the piece, in the direction of the flow [-].
    contact_area : float
        A/A0 of the piece [-].
    endless : float
        The threshold of an endless piece [-].

    Raises
    ------
    ConductivityError
        Waves that are not positive, or a threshold outside 0 to 1.

    Examples
    --------
    >>> [round(short_threshold(waves, 0.1), 3) for waves in (1.0, 3.0, math.inf)]
    [0.577, 0.47, 0.42]
    """
    if not waves > 0.0:
        raise ConductivityError(f"waves = {waves}: must be positive [-]")
    n = dimension_number(endless) * (1.0 + (_OPEN_TERM + _CONTACT_TERM * contact_area) * waves**_EXPONENT)
    return 1.0 - 1.0 / n


def short_medium(
    surface: RoughContact, table: ConductivityTable, log_pressure: FloatArray, length: FloatArray
) -> ShortMedium:
    """How open a contact is that may be short: waves across, contact area and threshold follow from each other.

    Waves and area are those of the width that resists, with the resistance as weight.

    Parameters
    ----------
    surface : RoughContact
    table : ConductivityTable
        Of the endless surface.
    log_pressure, length : ndarray, shape (n,)
        ln(p/Pa) of the nominal pressure at places along the flow, and the length of which each stands [m].

    Examples
    --------
    >>> import numpy as np
    >>> import leak
    >>> spectrum = leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=1e6)
    >>> surface = leak.RoughContact(spectrum, effective_modulus=115e9, theory="corrected")
    >>> x = np.linspace(-1e-3, 1e-3, 81)
    >>> p = 5e8 * np.exp(-0.5 * (x / 2e-4) ** 2)
    >>> found = short_medium(surface, surface.conductivity_table(1e3, 1e9), np.log(p), np.gradient(x))
    >>> 1.0 < found.waves < 20.0 and 0.42 < found.percolation_threshold < 0.6
    True
    """
    medium_at, log_n = _Piece.of(surface, table, log_pressure, length).medium()
    return medium_at(log_n)


@dataclass(frozen=True, eq=False)
class _Piece:
    """What resists of a contact, and what is known of it whatever its medium.

    Parameters
    ----------
    surface : RoughContact
    table : ConductivityTable
        Of the endless surface.
    log_pressure, area, length : ndarray, shape (n,)
        Acting ln(p/Pa) and A/A0 at places along the flow, and the length of which each stands [m].
    at_cuts : ndarray, shape (2, m)
        Acting ln(p/Pa) and A/A0 at `_CUTS`.
    """

    surface: RoughContact
    table: ConductivityTable
    log_pressure: FloatArray
    area: FloatArray
    length: FloatArray
    at_cuts: FloatArray

    @classmethod
    def of(
        cls, surface: RoughContact, table: ConductivityTable, log_pressure: FloatArray, length: FloatArray
    ) -> Self:
        top = log_pressure.max()
        touches = log_pressure > top + math.log(_FAINT)
        log_p = np.append(log_pressure[touches], top + np.log(_CUTS))
        area, log_p = _contact_area(surface, log_p), table.table_log_p(log_p)
        end = -len(_CUTS)
        at_cuts = np.array([log_p[end:], area[end:]])
        return cls(surface, table, log_p[:end], area[:end], length[touches], at_cuts)

    def cut_off(self, number: int) -> Self:
        """The same with its peaks cut off."""
        log_p, area = self.at_cuts[:, number]
        log_p = np.minimum(self.log_pressure, log_p)
        return replace(self, log_pressure=log_p, area=np.minimum(self.area, area))

    def medium(self) -> tuple[Callable[[float], ShortMedium], float]:
        """What a medium with ln n makes of it, and the ln n that it asks for itself, see `short_medium`."""
        endless, wave = self.surface.percolation_threshold, self.surface.wavelength_along_flow

        @cache
        def medium_at(log_n: float) -> ShortMedium:
            table = self.table_at(log_n)
            gap = table.at_log_pressure(self.log_pressure)
            shares = _shares(gap, self.log_pressure - math.log(table.sealing_pressure))
            weight = self.length * shares
            # the width that resists is that of a box where resistance is even
            waves = max(float(weight.sum() ** 2 / (weight @ shares)) / wave, _FEWEST)
            contact_area = float(weight @ self.area / weight.sum())
            return ShortMedium(waves, contact_area, short_threshold(waves, contact_area, endless))

        # a more open medium resists over a wider piece: the threshold that it asks for falls, and is met once
        low = -math.log1p(-endless)
        high = -math.log1p(-medium_at(low).percolation_threshold)
        if high - low < _CLOSE:
            return medium_at, high

        def excess(log_n: float) -> float:
            return log_n + math.log1p(-medium_at(log_n).percolation_threshold)

        return medium_at, root_of_rising(excess, low, high, high, _CLOSE)

    def table_at(self, log_n: float) -> ConductivityTable:
        """The table in a medium with ln n."""
        return _with_threshold(self.table, self.surface.percolation_threshold, -math.expm1(-log_n))

    def resistance(self, log_n: float) -> float:
        """To the flow through it, in a medium with ln n [1/m^2]."""
        gap = self.table_at(log_n).at_log_pressure(self.log_pressure)
        with np.errstate(divide="ignore"):
            return float((self.length / (gap * gap * gap)).sum())

    def log_number(self) -> float:
        """ln n of the medium of a contact, which leaks no more than it would without its peaks.

        Narrow peaks, as at the edges of a land, are passed by: alone they would open the whole contact, the more the
        harder they are pressed. More pressure opens nothing, so that the contact resists at least as much as with its
        peaks cut off, at the share of the peak pressure where that resists most.
        """
        _, log_n_here = self.medium()
        most, without_peaks = self.resistance(log_n_here), log_n_here
        _, least = self.cut_off(-1).medium()
        for number in range(len(_CUTS)):
            piece = self.cut_off(number)
            # no peak left out is the closest medium, in which the less of the peak there is, the less resists
            if piece.resistance(least) <= most:
                break
            _, log_n = piece.medium()
            cut_resistance = piece.resistance(log_n)
            if cut_resistance > most:
                most, without_peaks = cut_resistance, log_n
        if without_peaks == log_n_here or most == math.inf:
            return without_peaks
        return root_of_rising(
            lambda log_n: 1.0 - self.resistance(log_n) / most, without_peaks, log_n_here, log_n_here, _CLOSE
        )


def in_contact(surface: RoughContact, table: AnyTable, x: FloatArray, pressure: FloatArray) -> AnyTable:
    """Flow conductivity in a contact that may be short.

    Parameters
    ----------
    surface : RoughContact
        Of the corrected theory; the paper's knows no ends, and has its table back.
    table : ConductivityTable or GasConductivityTable
        Of the endless surface.
    x : ndarray, shape (n,)
        Along the flow, rising [m].
    pressure : ndarray, shape (n,)
        Nominal pressure [Pa].

    Raises
    ------
    ProfileError
        No profile of pressures.

    Examples
    --------
    >>> import numpy as np
    >>> import leak
    >>> spectrum = leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=1e6)
    >>> surface = leak.RoughContact(spectrum, effective_modulus=115e9, theory="corrected")
    >>> table = surface.conductivity_table(1e3, 1e9)
    >>> x = np.linspace(-2e-4, 2e-4, 81)
    >>> p = 2e8 * np.exp(-0.5 * (x / 4e-5) ** 2)
    >>> short = leak.in_contact(surface, table, x, p)
    >>> bool(short.effective_separation(2e8) > 1.02 * table.effective_separation(2e8))
    True
    """
    # a circumference of one
    profile = ContactProfile.through(*checked_profile(x, pressure, 0.5 / math.pi))
    return in_profile(surface, table, profile, 0.5 / math.pi)


def in_profile(surface: RoughContact, table: AnyTable, profile: ContactProfile, radius: float) -> AnyTable:
    """`in_contact` of a profile between and beyond its points, around an axis.

    Parameters
    ----------
    surface, table
        See `in_contact`.
    profile : ContactProfile
    radius : float
        Distance from the axis, of which a contact's width is a small part [m].
    """
    liquid = table.liquid
    if surface.theory == "paper" or liquid.method != "bruggeman":
        return table
    log_p, weight, _ = profile.quadrature
    log_n = _Piece.of(surface, liquid, log_p, 2.0 * math.pi * radius * weight).log_number()
    # what rarefaction adds goes by the share of the sealing pressure, which stays
    return table.with_liquid(with_threshold(liquid, surface.percolation_threshold, -math.expm1(-log_n)))


def with_threshold(table: ConductivityTable, endless: float, threshold: float) -> ConductivityTable:
    """The table of a surface with another percolation threshold.

    The sealing pressure is in the ratio of inverse error functions of both, as Persson's contact area has it. At equal
    shares of it gaps are in a ratio that hardly depends on the spectrum: that of a standard one is taken. Of five
    spectra with Hurst exponents from 0.5 to 0.95 and cutoffs from 4 to 300 times the roll-off, conductivities at a
    threshold of 0.45 differ by up to 4 % from it, at 0.5 by up to 12 %, where the change is a factor
    of 1.5 to 10.

    Parameters
    ----------
    table : ConductivityTable
        By the effective medium.
    endless, threshold : float
        Thresholds of the table and of the one that is wanted [-].
    """
    open_table, ratio = _with_threshold(table, endless, threshold), _argument(endless, threshold)
    return replace(open_table, p_max=table.p_max * ratio, memory=table.memory, acts_at=table.acts_at)


def _with_threshold(table: ConductivityTable, endless: float, threshold: float) -> ConductivityTable:
    """`with_threshold` that is asked at acting pressures, without an end."""
    steps = (math.log1p(-endless) - math.log1p(-threshold)) / _SPACING
    begin = math.floor(steps) - 1
    sealing_pressure = table.sealing_pressure * _argument(endless, threshold)
    return _open_table(table, endless, begin).combine(lagrange(steps - begin), sealing_pressure)


def _argument(endless: float, threshold: float) -> float:
    """Sealing pressure at a threshold over that of the endless medium [-]."""
    return area_argument_at(threshold) / area_argument_at(endless)


@lru_cache
def _open_table(table: ConductivityTable, endless: float, begin: int) -> AlikeTables:
    """The table at four steps of ln n from that of the endless medium."""
    return AlikeTables.of([_at_step(table, endless, begin + step) for step in range(4)])


def _at_step(table: ConductivityTable, endless: float, step: int) -> ConductivityTable:
    argument = _argument(endless, _threshold_at(endless, step))
    log_share = np.log(table.pressure / table.sealing_pressure)
    open_table, endless_table = _standard(endless, step), _standard(endless, 0)
    endless_gap = endless_table.at_log_pressure(log_share + math.log(endless_table.sealing_pressure))
    gap = open_table.at_log_pressure(log_share + math.log(open_table.sealing_pressure))
    flows = (gap > 0.0) & (endless_gap > 0.0)
    return replace(
        table,
        pressure=table.pressure[flows] * argument,
        separation=table.separation[flows] * gap[flows] / endless_gap[flows],
        sealing_pressure=table.sealing_pressure * argument,
    )


@lru_cache
def _standard(endless: float, step: int) -> ConductivityTable:
    """Table of the standard spectrum, so many steps of ln n from that of the endless medium."""
    spectrum = PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=3e4, q_rolloff=1e5, q_high=3e6)
    threshold = _threshold_at(endless, step)
    surface = RoughContact(spectrum, effective_modulus=1e11, percolation_threshold=threshold)
    sealing = surface.sealing_pressure
    return surface.conductivity_table(_LOWEST_SHARE * sealing, sealing, _NODES)


def _threshold_at(endless: float, step: int) -> float:
    return -math.expm1(math.log1p(-endless) - _SPACING * step)


def _contact_area(surface: RoughContact, log_pressure: FloatArray) -> FloatArray:
    """Corrected A/A0, whose logarithm is nearly straight over ln p, shape (n,)."""
    nodes = np.linspace(log_pressure.min(), log_pressure.max(), _AREAS)
    return np.exp(np.interp(log_pressure, nodes, np.log(surface.corrected_contact_area(np.exp(nodes)))))


def _shares(gap: FloatArray, log_excess: FloatArray) -> FloatArray:
    """Resistances in units of the largest; where some are infinite, how much of each point's length is sealed.

    A point counts in part where the sealed length ends next to it: that length grows with the load without steps.

    Parameters
    ----------
    gap, log_excess : ndarray, shape (n,)
        Gap [m], and ln of pressure over sealing pressure.
    """
    if gap.all():
        resistance = 1.0 / (gap * gap * gap)
        return resistance / resistance.max()
    with np.errstate(divide="ignore", invalid="ignore"):
        shares = np.clip(0.5 + np.nan_to_num(log_excess / np.abs(np.gradient(log_excess))), 0.0, 1.0)
    # next to its sealing pressure the gap rounds to zero
    return shares if shares.any() else (gap == 0.0).astype(float)
