"""Estimate for solid particles in the leaking fluid: constrictions that stop them, and the remaining leak.

A place narrower than a particle stops it; the places that particles of one size shut are taken as closed, and the
effective medium says what the others let through. Nothing is known here of particles that stick to walls, bridge a
place together, deform, or damage the faces.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields, replace
from functools import cached_property, lru_cache
from typing import NamedTuple, overload

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import FloatArray
from leak.errors import ConductivityError, positive
from leak.flow.conductivity import ConductivityTable, GasConductivityTable
from leak.flow.leak_rate import leak_flow
from leak.flow.medium import anisotropic_medium, dimension_number
from leak.flow.rough_contact import RoughContact
from leak.fluids.contamination import Concentration, ParticleCounts
from leak.theory.separation import SeparationGrid, density

_GRID_POINTS = 512
# Pressures at which P(u) is worked out: steps in ln p below the largest one, dense where the seal is tight.
_STEPS = np.concatenate([np.arange(0.0, 6.0, 0.15), np.arange(6.0, 30.0, 1.0)])
# Share of the leak that may be lost to particles below all that is counted, without counting them.
_SHARE_UNCOUNTED = 0.01
# Nothing but the last paths is left beyond this share of the sealing pressure.
_BELOW_SEALING = 0.98


@dataclass(frozen=True, eq=False)
class GapDistribution:
    """P(u) of a rough contact at some pressures, on cells of u.

    Parameters
    ----------
    pressure : ndarray, shape (P,)
        Increasing [Pa].
    edges : ndarray, shape (P, U + 1)
        Between the cells, from zero on [m].
    separation, weight : ndarray, shape (P, U)
        u in each cell [m], and the nominal area that has it [-].
    contact : ndarray, shape (P,)
        Area that lets nothing through [-].
    percolation_threshold, peklenik : float
        See `leak.RoughContact`.

    Examples
    --------
    >>> import leak
    >>> spectrum = leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=1e6)
    >>> surface = leak.RoughContact(spectrum, effective_modulus=115e9)
    >>> gaps = leak.GapDistribution.of(surface, [1e6, 1e8])
    >>> bool(gaps.area_below(1e-6)[0] < gaps.area_below(1e-6)[1])
    True
    >>> gaps.remaining_share(0.0).tolist()
    [1.0, 1.0]
    """

    pressure: FloatArray
    edges: FloatArray
    separation: FloatArray
    weight: FloatArray
    contact: FloatArray
    percolation_threshold: float
    peklenik: float

    @classmethod
    def of(cls, surface: RoughContact, pressure: ArrayLike) -> GapDistribution:
        """At nominal pressures, each positive and below the hardness.

        Parameters
        ----------
        surface : RoughContact
        pressure : array_like, shape (P,)
            Increasing [Pa].
        """
        p = np.atleast_1d(np.asarray(pressure, dtype=float))
        loss = surface.lost_area(p)
        grid = SeparationGrid.of(loss.mean_separation, surface.spectrum.rms_height, count=_GRID_POINTS)
        weight, u = density(loss, grid.separation) * grid.weight, grid.separation
        middle = 0.5 * (u[:, 1:] + u[:, :-1])
        edges = np.concatenate([np.zeros((p.size, 1)), middle, u[:, -1:]], axis=1)
        contact = np.maximum(1.0 - weight.sum(axis=1), 0.0)
        return cls(p, edges, u, weight, contact, surface.percolation_threshold, surface.peklenik)

    def area_below(self, size: float) -> FloatArray:
        """Nominal area with a gap narrower than a size, contact included, shape (P,) [-].

        Parameters
        ----------
        size : float
            [m]
        """
        return self.contact + (self.weight * self._shut_shares(size)).sum(axis=1)

    def remaining_share(self, size: float) -> FloatArray:
        """Conductivity with all gaps below a size shut, over that with all open, shape (P,) [-].

        The effective medium with those gaps at zero; zero where they and the contact percolate.

        Parameters
        ----------
        size : float
            Not negative [m].
        """
        if size == 0.0:
            return np.ones(self.pressure.shape)
        shares = self._shut_shares(size)
        gap = self._medium(self.weight * (1.0 - shares), self.area_below(size))
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(self._open_gap > 0.0, np.minimum(gap / self._open_gap, 1.0) ** 3, 0.0)

    @cached_property
    def _open_gap(self) -> FloatArray:
        """u_eff with nothing shut, shape (P,) [m]."""
        return self._medium(self.weight, self.contact)

    def _medium(self, weight: FloatArray, contact: FloatArray) -> FloatArray:
        n, none = dimension_number(self.percolation_threshold), np.zeros(self.pressure.shape)
        return anisotropic_medium(self.separation, weight, contact, none, n, self.peklenik).along

    @property
    def largest_passing(self) -> FloatArray:
        """Size from which on a particle finds no way through, shape (P,) [m]; zero where nothing flows."""
        sums = np.cumsum(self.weight, axis=1)
        return np.array(
            [
                np.interp(self.percolation_threshold, contact + np.concatenate([[0.0], row]), at, left=0.0)
                for contact, row, at in zip(self.contact, sums, self.edges, strict=True)
            ]
        )

    def _shut_shares(self, size: float) -> FloatArray:
        """Share of each cell below a size, shape (P, U)."""
        low, high = self.edges[:, :-1], self.edges[:, 1:]
        return np.clip((size - low) / np.maximum(high - low, 1e-300), 0.0, 1.0)


@lru_cache(maxsize=16)
def _gaps(surface: RoughContact, p_max: float) -> GapDistribution:
    """Over all pressures of a contact; the same for all sizes."""
    top = min(p_max, _BELOW_SEALING * surface.sealing_pressure)
    return GapDistribution.of(surface, top * np.exp(-_STEPS[::-1]))


@dataclass(frozen=True, eq=False)
class ShutConductivityTable(ConductivityTable):
    """u_eff of a surface whose narrow places are shut: that of the table it was made of, and less.

    Parameters
    ----------
    log_pressure : ndarray, shape (P,)
        ln(p/Pa), increasing.
    missing_share : ndarray, shape (P,)
        What of the area is missing to the percolation threshold, over the threshold; where none is, nothing flows [-].
    remaining_share : ndarray, shape (P,)
        Share of the conductivity that is left, over `missing_share` [-].

    Examples
    --------
    >>> import leak
    >>> spectrum = leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=1e6)
    >>> surface = leak.RoughContact(spectrum, effective_modulus=115e9)
    >>> shut = leak.shut_conductivity(surface.conductivity_table(1e4, 1e8), surface, 1e-6)
    >>> isinstance(shut, leak.ConductivityTable)
    True
    """

    log_pressure: FloatArray = field(kw_only=True)
    missing_share: FloatArray = field(kw_only=True)
    remaining_share: FloatArray = field(kw_only=True)

    def at_log_pressure(self, log_pressure: ArrayLike) -> FloatArray:
        """u_eff at ln(p/Pa) [m]; zero where nothing flows."""
        x = np.asarray(log_pressure, dtype=float)
        missing_area = np.maximum(np.interp(x, self.log_pressure, self.missing_share), 0.0)
        share = np.minimum(np.interp(x, self.log_pressure, self.remaining_share) * missing_area, 1.0)
        return super().at_log_pressure(x) * np.cbrt(share)


@overload
def shut_conductivity(table: ConductivityTable, surface: RoughContact, size: float) -> ConductivityTable: ...


@overload
def shut_conductivity(
    table: GasConductivityTable, surface: RoughContact, size: float
) -> GasConductivityTable: ...


def shut_conductivity(
    table: ConductivityTable | GasConductivityTable, surface: RoughContact, size: float
) -> ConductivityTable | GasConductivityTable:
    """A table of the flow conductivity in which all gaps below a size are shut.

    The conductivity of the table is multiplied by the share that the effective medium over P(u) leaves, so that a
    size of zero changes nothing, whatever the table was made by.

    Parameters
    ----------
    table : ConductivityTable or GasConductivityTable
        Of a gas, the rarefaction at the same effective gap stays that of the open surface.
    surface : RoughContact
        Of which the table is.
    size : float
        Not negative [m].

    Raises
    ------
    ConductivityError

    Examples
    --------
    >>> import leak
    >>> spectrum = leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=1e6)
    >>> surface = leak.RoughContact(spectrum, effective_modulus=115e9)
    >>> table = surface.conductivity_table(1e4, 1e8)
    >>> shut = leak.shut_conductivity(table, surface, 1e-6)
    >>> bool(shut.effective_separation(1e7) < table.effective_separation(1e7))
    True
    """
    if not (math.isfinite(size) and size >= 0.0):
        raise ConductivityError(f"size = {size!r}: must be finite and not negative [m]")
    if size == 0.0:
        return table
    if isinstance(table, GasConductivityTable):
        return replace(table, liquid=shut_conductivity(table.liquid, surface, size))
    gaps = _gaps(surface, table.p_max)
    # toward the threshold the share falls like the area that is missing to it; what is left of it is smooth
    missing_area = 1.0 - gaps.area_below(size) / gaps.percolation_threshold
    share, flows = gaps.remaining_share(size), missing_area > 0.0
    smooth = np.zeros(share.shape)
    smooth[flows] = share[flows] / missing_area[flows]
    if flows.any():
        smooth[~flows] = smooth[flows][-1]
    return ShutConductivityTable(
        **{entry.name: getattr(table, entry.name) for entry in fields(ConductivityTable)},
        log_pressure=np.log(gaps.pressure),
        missing_share=missing_area,
        remaining_share=smooth,
    )


def throttling_length(x: ArrayLike, pressure: ArrayLike, table: ConductivityTable) -> float:
    """Length of a uniform contact at the peak pressure that throttles as much as the whole profile [m].

    Parameters
    ----------
    x, pressure : array_like, shape (n,)
        Arc length [m] and contact pressure [Pa].
    table : ConductivityTable

    Examples
    --------
    >>> import leak
    >>> spectrum = leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=1e6)
    >>> table = leak.RoughContact(spectrum, effective_modulus=115e9).conductivity_table(1e4, 1e8)
    >>> f"{leak.throttling_length([0, 1e-4, 2e-4], [1e7, 1e7, 1e7], table):.3e}"
    '2.000e-04'
    """
    p = np.asarray(pressure, dtype=float)
    sigma = table.at(viscosity=1.0)
    # on a radius of one over two pi, under a pressure difference of one
    resistance = leak_flow(x, p, sigma, 1.0, 0.5 / math.pi).resistance
    return float(resistance * np.asarray(sigma(p.max())))


class Paths(NamedTuple):
    """Number of places side by side that a particle can shut.

    Examples
    --------
    >>> import leak
    >>> leak.Paths(100.0, 300.0).fewest
    100.0
    """

    fewest: float
    most: float


def parallel_paths(circumference: float, length: float, size: float) -> Paths:
    """How many places a leak has side by side that one particle each can shut: between two bounds, far apart.

    At least one path through each square of the contact, the picture of the critical junction, all of which one
    particle shuts: circumference/length. At most as many as particles find room side by side, because a junction is
    much wider than high, and a particle shuts no more of it than its own width: circumference/size.

    Parameters
    ----------
    circumference : float
        2 pi r [m].
    length : float
        Of the contact along the flow, see `throttling_length` [m].
    size : float
        Of the particles that are stopped [m].

    References
    ----------
    B. N. J. Persson, C. Yang, J. Phys.: Condens. Matter 20, 315011 (2008), for the critical junction of a square.

    Examples
    --------
    >>> import leak
    >>> fewest, most = leak.parallel_paths(0.1, 2e-4, 2e-6)
    >>> round(fewest), round(most)
    (500, 50000)
    """
    length_around = positive(ConductivityError, "circumference", circumference, "m")
    counts = (
        length_around / positive(ConductivityError, name, value, "m")
        for name, value in (("length", length), ("size", size))
    )
    fewest, most = sorted(max(count, 1.0) for count in counts)
    return Paths(fewest, most)


def stopped(counts: ParticleCounts, sizes: ArrayLike, remaining: ArrayLike) -> Concentration:
    """Particles per volume of leaking fluid that do not get through, each shape (1,) [1/m^3].

    NaN where they are so small that the counts say nothing of them.

    A particle of size d is stopped by the share of the flow 1 - Q(d)/Q0 that passes places narrower than d:
    c = -int N(d) d(Q(d)/Q0), N the particles of at least that size.

    Parameters
    ----------
    counts : ParticleCounts
    sizes : array_like, shape (n,)
        Increasing, positive [m].
    remaining : array_like, shape (n,)
        Q(d)/Q0, leak rate with all gaps below d shut over that with all open, falling [-]. All that it falls by below
        the first size is counted there, and what is left at the last size as falling to nothing there.

    Examples
    --------
    All narrow places are 2 um high:

    >>> import leak
    >>> dust = leak.ParticleCounts.of_counts([1e-6, 10e-6], [1e10, 1e8])
    >>> found = leak.stopped(dust, [1.999e-6, 2.001e-6], [1.0, 0.0])
    >>> f"{found.likely[0]:.2e}"
    '2.50e+09'
    """
    d, share = np.asarray(sizes, dtype=float), np.asarray(remaining, dtype=float)
    fall = -np.diff(np.concatenate([[1.0], share, [0.0]]))
    where = np.concatenate([d[:1], np.sqrt(d[:-1] * d[1:]), d[-1:]])
    if fall[where < counts.smallest].sum() > _SHARE_UNCOUNTED:
        return Concentration(*(np.array([np.nan]) for _ in range(3)))
    at = counts.at_least(np.maximum(where, counts.smallest))
    return Concentration(*(np.atleast_1d((count * fall).sum()) for count in at))


@dataclass(frozen=True)
class Clogging:
    """How a leak falls while its narrow places are shut one after the other: Q = Q0 exp(-k c V), an order of magnitude.

    V is the volume that has leaked, c the stopped particles per volume, and k = 1/N with N places side by side, see
    `parallel_paths`: each particle takes the N-th part of what still leaks (intermediate blocking of filtration).
    With dV = Q dt, Q = Q0/(1 + k c Q0 t).

    Parameters
    ----------
    leak_rate : float
        Q0 [m^3/s].
    rate : float
        k c [1/m^3].

    References
    ----------
    J. Hermia, Trans. IChemE 60, 183 (1982), blocking filtration laws.

    Examples
    --------
    >>> import leak
    >>> clogging = leak.Clogging(leak_rate=1e-9, rate=1e6)
    >>> f"{clogging.volume_to(0.5):.3e} m^3, {clogging.time_to(0.5):.0f} s"
    '6.931e-07 m^3, 1000 s'
    """

    leak_rate: float
    rate: float

    def volume_to(self, share: float) -> float:
        """Volume that leaks until a share of the first leak rate is left [m^3]; infinite if nothing clogs."""
        return math.inf if self.rate == 0.0 else -math.log(share) / self.rate

    def time_to(self, share: float) -> float:
        """Time until then [s]."""
        rate = self.rate * self.leak_rate
        return math.inf if rate == 0.0 else (1.0 / share - 1.0) / rate


def cloggings(leak_rate: float, stopped: Concentration, paths: Paths) -> tuple[Clogging, Clogging]:
    """The slowest and the fastest decay that counts of particles and paths allow.

    Parameters
    ----------
    leak_rate : float
        Q0 [m^3/s].
    stopped : Concentration
        From `stopped`.
    paths : Paths

    Examples
    --------
    >>> import leak
    >>> import numpy as np
    >>> few, many = np.array([1e9]), np.array([4e9])
    >>> slow, fast = leak.cloggings(1e-9, leak.Concentration(few, 2 * few, many), leak.Paths(100.0, 200.0))
    >>> fast.rate / slow.rate
    8.0
    """
    return (
        Clogging(leak_rate, float(stopped.low[0]) / paths.most),
        Clogging(leak_rate, float(stopped.high[0]) / paths.fewest),
    )
