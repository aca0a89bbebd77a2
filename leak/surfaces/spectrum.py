"""The power spectrum C(q) of a randomly rough surface: piecewise power laws with exact moments."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from os import PathLike
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import FloatArray, IntArray
from leak.errors import SpectrumError, as_arrays, check_each, check_order, positive
from leak.numerics.integrals import not_zero, power_integral, power_law_moment, slopes, sorted_unique

if TYPE_CHECKING:
    from leak.surfaces.periodogram import Window
    from leak.surfaces.scan_files import Unit
    from leak.surfaces.scans import Detrend, SelfAffineContinuation


# What a spectrum of heights can hold, and no more: densities and wavenumbers stand in products of their powers.
_WAVENUMBERS, _DENSITIES = (1e-9, 1e18), (1e-300, 1e30)
# A sum of two power laws is no power law; its log-log interpolant is made as good as this.
_SUM_ERROR = 2e-5
# Between two spectra that do not meet there is nothing; a log-log interpolant needs a positive number for it.
_GAP = 1e-12
# Quadratures stop at nodes where the exponent of C changes by more than this or C steps; smaller kinks do no harm.
_KINK, _STEP = 0.05, 1e-4
# Where only some of many kinks are stops, those as large as this are always among them.
_STRONG_KINK, _STRONG_STEP = 1.5, 0.7
# With more kinks than this (a raw Fourier spectrum) they average out, and stopping at some of them is enough.
_MOST_BREAKS = 400
# The end of a spectrum that adds less than this fraction per e-fold of q to M; M itself resolves 1e-16.
_FAINT = 1e-10
# Of a steep piece of infinite length all but the last digit has grown.
_LEAST_GROWN = -1.0 + 1e-16


class SpectrumPoint(NamedTuple):
    """Where the cumulative slope moment has a given value: ln q and ln C there."""

    log_wavenumber: FloatArray
    log_density: FloatArray


@dataclass(frozen=True, eq=False)
class PowerSpectrum:
    """Isotropic two-dimensional power spectrum C(q), log-log linear between nodes and zero outside them.

    The convention is <h^2> = 2 pi int q C dq and <(grad h)^2> = 2 pi int q^3 C dq. Two nodes at the
    same wavenumber are a step. All moments are exact for this interpolant.

    Parameters
    ----------
    wavenumber : array_like
        q of the nodes, shape (n,), not decreasing [1/m].
    density : array_like
        C at the nodes, shape (n,), positive [m^4].

    Raises
    ------
    SpectrumError
        Fewer than two nodes, different lengths, values that are not positive and finite, q not increasing.

    References
    ----------
    B. N. J. Persson, J. Chem. Phys. 115, 3840 (2001).

    Examples
    --------
    >>> spectrum = PowerSpectrum.self_affine(
    ...     rms_height=1.9e-6, hurst=0.6, q_low=1e3, q_rolloff=3.7268e4, q_high=3.1415926e6
    ... )
    >>> round(spectrum.rms_slope, 4)
    0.4
    """

    wavenumber: FloatArray
    density: FloatArray

    def __post_init__(self) -> None:
        must = "wavenumber and density must be arrays of numbers"
        q, C = map(np.array, as_arrays(SpectrumError, must, self.wavenumber, self.density))
        if q.ndim != 1 or q.shape != C.shape or q.size < 2:
            raise SpectrumError(
                f"wavenumber has shape {q.shape}, density {C.shape}: both need the same length, at least 2"
            )
        for name, unit, values, (low, high) in (
            ("wavenumber", "1/m", q, _WAVENUMBERS),
            ("density", "m^4", C, _DENSITIES),
        ):
            must = f"must be positive, from {low:g} to {high:g} {unit}"
            check_each(SpectrumError, name, values, (values >= low) & (values <= high), must)
        check_order(SpectrumError, "wavenumber", q, "must increase [1/m]", equal=True)
        if q[0] == q[-1]:
            raise SpectrumError(f"wavenumber = {q[0]} throughout: must increase [1/m]")
        q.flags.writeable = False
        C.flags.writeable = False
        object.__setattr__(self, "wavenumber", q)
        object.__setattr__(self, "density", C)

    # ---------------------------------------------------------------- ways in

    @classmethod
    def self_affine(
        cls, *, rms_height: float, hurst: float, q_low: float, q_rolloff: float, q_high: float
    ) -> PowerSpectrum:
        """Self-affine roughness with a roll-off.

        C = C0 for q_low <= q < q_rolloff and C0 (q/q_rolloff)^(-2(1+H)) up to q_high, with C0 from rms_height.

        Parameters
        ----------
        rms_height : float
            Root-mean-square height [m].
        hurst : float
            Hurst exponent H, between 0 and 1 [-].
        q_low, q_rolloff, q_high : float
            Smallest wavenumber, end of the flat part (may equal q_low) and largest wavenumber [1/m].

        Raises
        ------
        SpectrumError
            A value is not positive, H is outside (0, 1], or not q_low <= q_rolloff <= q_high, q_low < q_high.
        """
        h = positive(SpectrumError, "rms_height", rms_height, "m")
        H = positive(SpectrumError, "hurst", hurst, "-")
        low = positive(SpectrumError, "q_low", q_low, "1/m")
        rolloff = positive(SpectrumError, "q_rolloff", q_rolloff, "1/m")
        high = positive(SpectrumError, "q_high", q_high, "1/m")
        if H > 1.0:
            raise SpectrumError(f"hurst = {hurst}: must lie in (0, 1]")
        if not low < high:
            raise SpectrumError(f"q_low = {q_low} and q_high = {q_high}: q_low must be below q_high [1/m]")
        if not low <= rolloff <= high:
            raise SpectrumError(
                f"q_rolloff = {q_rolloff}: must lie between q_low = {q_low} and q_high = {q_high}"
            )
        unit = _self_affine_shape(low, rolloff, high, H)
        return unit.scaled(h / unit.rms_height)

    @classmethod
    def from_table(cls, wavenumber: ArrayLike, density: ArrayLike) -> PowerSpectrum:
        """Spectrum through tabulated points q [1/m], C [m^4], q strictly increasing; log-log linear between."""
        q = np.atleast_1d(np.asarray(wavenumber, dtype=float))
        if q.ndim == 1:
            check_order(SpectrumError, "wavenumber", q, "must strictly increase [1/m]")
        return cls(q, np.asarray(density, dtype=float))

    @classmethod
    def from_profile(
        cls,
        x: ArrayLike,
        h: ArrayLike,
        *,
        detrend: Detrend = "tilt",
        window: Window = "hann",
        tip_radius: float | None = None,
        shortest_wavelength: float | None = None,
        extrapolation: Literal["cut"] | SelfAffineContinuation = "cut",
    ) -> PowerSpectrum:
        """Isotropic spectrum of a surface from a line scan over it; see `leak.measure`.

        Parameters
        ----------
        x, h : array_like, shape (n,)
            Position, monotonic, and height [m].
        detrend, window, tip_radius, shortest_wavelength, extrapolation
            See `leak.ScanSettings`.

        Raises
        ------
        ScanError
            The scan or a setting cannot be used.
        """
        # only these two ways in need the modules of scans
        from leak.surfaces.estimate import estimate
        from leak.surfaces.scans import ScanSettings, line_scan

        settings = ScanSettings(detrend, window, tip_radius, shortest_wavelength, extrapolation)
        return cls(*estimate((line_scan(x, h),), settings).continued_nodes)

    @classmethod
    def from_file(
        cls,
        path: str | PathLike[str] | Sequence[str | PathLike[str]],
        *,
        unit: Unit | None = None,
        detrend: Detrend = "tilt",
        window: Window = "hann",
        tip_radius: float | None = None,
        shortest_wavelength: float | None = None,
        extrapolation: Literal["cut"] | SelfAffineContinuation = "cut",
    ) -> PowerSpectrum:
        """Isotropic spectrum of a surface from a file of an instrument, or from several scans of it.

        Parameters
        ----------
        path : path or sequence of paths
            Text with position and height, or any format that SurfaceTopography reads; see `leak.read_topography`.
        unit : str or two of them, optional
            Unit of x and height where the file states none: "um", or ("mm", "um").
        detrend, window, tip_radius, shortest_wavelength, extrapolation
            See `leak.ScanSettings`.

        Raises
        ------
        ScanError
            A file or a setting cannot be used.
        """
        from leak.surfaces.estimate import estimate
        from leak.surfaces.scan_files import read_topographies
        from leak.surfaces.scans import ScanSettings

        settings = ScanSettings(detrend, window, tip_radius, shortest_wavelength, extrapolation)
        return cls(*estimate(read_topographies(path, unit=unit), settings).continued_nodes)

    # ---------------------------------------------------------------- values

    @property
    def q_low(self) -> float:
        """Smallest wavenumber [1/m]."""
        return float(self.wavenumber[0])

    @property
    def q_high(self) -> float:
        """Largest wavenumber [1/m]."""
        return float(self.wavenumber[-1])

    def __call__(self, wavenumber: ArrayLike) -> FloatArray | float:
        """C at `wavenumber` [m^4]; zero outside the nodes. Scalars stay scalars."""
        q = np.asarray(wavenumber, dtype=float)
        is_held = (q >= self.q_low) & (q <= self.q_high)
        safe = np.where(is_held, q, self.q_low)
        k = self._piece_of(safe)
        log_C = self._log_C[k] + self._slope[k] * (np.log(safe) - self._log_q[k])
        values = np.where(is_held, np.exp(log_C), 0.0)
        return float(values) if values.ndim == 0 else values

    def log_density(self, log_wavenumber: FloatArray) -> FloatArray:
        """ln C at ln q, both in SI units, between the smallest and the largest wavenumber."""
        return np.interp(log_wavenumber, self._log_q, self._log_C)

    def scaled(self, height: float) -> PowerSpectrum:
        """The same surface with all heights times `height`, which knows that its shape is the same.

        Parameters
        ----------
        height : float
            Ratio, positive [-].

        Examples
        --------
        >>> rough = PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=1e6)
        >>> rougher = rough.scaled(2.0)
        >>> round(rougher.rms_height * 1e6, 6), rougher.shape is rough.shape
        (2.0, True)
        """
        other = PowerSpectrum(self.wavenumber, height**2 * self.density)
        vars(other).update(_shape=self.shape, rms_height=height * self.rms_height)
        return other

    @property
    def shape(self) -> PowerSpectrum:
        """The spectrum of which this one and others are `scaled` copies; itself where it is none."""
        shape: PowerSpectrum = vars(self).get("_shape", self)
        return shape

    def __add__(self, other: PowerSpectrum) -> PowerSpectrum:
        """Spectrum of the sum of two statistically independent roughnesses."""
        if not isinstance(other, PowerSpectrum):
            return NotImplemented
        nodes = np.unique(np.concatenate([self.wavenumber, other.wavenumber]))
        left, right = nodes[:-1], nodes[1:]
        ends = [spectrum._at_ends_of(left, right) for spectrum in (self, other)]
        count = _pieces_of_sum(np.log(right / left), *ends)
        # the nodes of each stretch, both its ends among them, one stretch after the other
        of = np.repeat(np.arange(left.size), count + 1)
        share = (np.arange(of.size) - np.repeat(np.cumsum(count + 1) - count - 1, count + 1)) / count[of]
        q = left[of] * (right / left)[of] ** share
        q = np.where(share == 1.0, right[of], q)
        C = sum(np.exp(log_C[of, 0] + share * slope[of]) for log_C, slope in map(_straight, ends))
        is_empty = np.isneginf(np.maximum(ends[0][:, 0], ends[1][:, 0]))[of]
        C = np.where(is_empty, _GAP * min(self.density.min(), other.density.min()), C)
        same = (np.diff(q) == 0.0) & np.isclose(np.diff(np.log(C)), 0.0, atol=1e-13)
        keep = np.concatenate([[True], ~same])
        return PowerSpectrum(q[keep], C[keep])

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, PowerSpectrum):
            return NotImplemented
        return np.array_equal(self.wavenumber, other.wavenumber) and np.array_equal(
            self.density, other.density
        )

    def __hash__(self) -> int:
        return self._hash

    @cached_property
    def median_wavenumber(self) -> float:
        """q with half of the height variance above it [1/m]."""
        q = np.geomspace(self.q_low, self.q_high, 2000)
        variance = np.asarray(self.height_variance_above(q))
        return float(np.exp(np.interp(-0.5 * variance[0], -variance, np.log(q))))

    @cached_property
    def _hash(self) -> int:
        return hash((self.wavenumber.tobytes(), self.density.tobytes()))

    # ---------------------------------------------------------------- moments

    @cached_property
    def rms_height(self) -> float:
        """Root-mean-square height, (2 pi int q C dq)^(1/2) [m]."""
        return float(np.sqrt(2.0 * np.pi * self.moment(1)))

    @cached_property
    def rms_slope(self) -> float:
        """Root-mean-square slope, (2 pi int q^3 C dq)^(1/2) [-]."""
        return float(np.sqrt(2.0 * np.pi * self.moment(3)))

    def moment(self, order: float, q_from: float = 0.0, q_to: float = np.inf) -> float:
        """Exact int q^order C dq between two wavenumbers [m^(3-order)]."""
        low, high = np.log(np.clip([q_from, q_to], self.q_low, self.q_high))
        return power_law_moment(order, self._log_q, self._log_C, self._slope, low, high)

    def height_variance_above(self, wavenumber: ArrayLike) -> FloatArray:
        """2 pi int q C dq over wavenumbers above `wavenumber`: roughness not yet seen [m^2]."""
        q = np.minimum(np.maximum(np.asarray(wavenumber, dtype=float), self.q_low), self.q_high)
        k = self._piece_of(q)
        log_q = np.log(q)
        exponent = 2.0 + self._slope[k]
        log_C = self._log_C[k] + self._slope[k] * (log_q - self._log_q[k])
        in_piece = np.exp(log_C + 2.0 * log_q) * power_integral(exponent, self._log_q[k + 1] - log_q)
        return 2.0 * np.pi * (in_piece + self._height_above[k + 1])

    def slope_moment(self, wavenumber: ArrayLike) -> FloatArray:
        """M(q) = int_{q_low}^q q'^3 C dq' [-]; it is the mean square slope seen up to q over 2 pi."""
        q = np.clip(np.asarray(wavenumber, dtype=float), self.q_low, self.q_high)
        k = self._piece_of(q)
        piece = self._slope_scale[k] * power_integral(self._slope_exponent[k], np.log(q) - self._log_q[k])
        return self._slope_moment[k] + piece

    @property
    def whole_moment(self) -> float:
        """Slope moment M of the whole spectrum [-]."""
        return float(self._slope_moment[-1])

    def at_slope_moment(self, moment: FloatArray) -> SpectrumPoint:
        """ln q and ln C where the cumulative slope moment M has the value `moment`, the inverse of `slope_moment`.

        M, not q, is the coordinate of magnification in this package: at low pressure all contact is lost
        so close to q_low that q itself can no longer tell the points apart.
        """
        k = np.searchsorted(self._slope_moment[1:-1], moment, side="right")
        return self.on_piece(k, moment)

    def on_piece(self, piece: IntArray | int, moment: FloatArray) -> SpectrumPoint:
        """The same as `at_slope_moment` where the piece of the spectrum is already known."""
        # in the same place: arrays are large here
        step = moment - self._slope_moment[piece]
        step *= self._growth_rate[piece]
        step = np.maximum(step, _LEAST_GROWN)
        step = np.log1p(step, out=step)
        step *= self._inverse_exponent[piece]
        step = np.minimum(np.maximum(step, 0.0, out=step), self._length[piece], out=step)
        log_C = self._slope[piece] * step
        log_C += self._log_C[piece]
        step += self._log_q[piece]
        return SpectrumPoint(step, log_C)

    @cached_property
    def last_moment(self) -> float:
        """Slope moment M of the whole spectrum, less an end that is too faint to tell M apart there [-]."""
        total = float(self._slope_moment[-1])
        last = self._log_C[self._last_piece + 1] + 4.0 * self._log_q[self._last_piece + 1]
        return total if np.exp(last) > _FAINT * total else total * (1.0 - 0.1 * _FAINT)

    @property
    def break_moments(self) -> FloatArray:
        """Slope moments M at the nodes where a quadrature should be split, ends included, increasing [-]."""
        real = np.flatnonzero(self._length > 0.0)
        left, right = real[:-1], real[1:]
        bend = np.abs(self._slope[right] - self._slope[left])
        step = np.abs(self._log_C[right] - self._log_C[left + 1])
        any_kink = (bend > _KINK) | (step > _STEP)
        strong = (bend > _STRONG_KINK) | (step > _STRONG_STEP)
        kinks = self._spread_kinks(right[any_kink], right[strong])
        nodes = self._slope_moment[np.concatenate([[0], kinks, [self._last_piece + 1]])]
        breaks = sorted_unique(np.concatenate([nodes, self._saturation_moments()]))
        return np.append(breaks[breaks < self.last_moment], self.last_moment)

    def _spread_kinks(self, kinks: IntArray, strong: IntArray) -> IntArray:
        """So many kinks as are allowed, in even steps of what changes with magnification: q, M and its rest."""
        if kinks.size <= _MOST_BREAKS:
            return kinks
        M = self._slope_moment[kinks] / self.last_moment
        place = self._log_q[kinks] + 0.5 * np.log(M) - np.log(np.maximum(1.0 - M, 0.0) + 1e-3)
        end = max(self._log_q[-1] - np.log(1e-3), place[-1])
        even_places = np.linspace(place[0], end, _MOST_BREAKS + 2)[1:-1]
        k = np.clip(np.searchsorted(place, even_places), 1, place.size - 1)
        nearest = kinks[np.unique(k - (even_places - place[k - 1] < place[k] - even_places))]
        # where most are strong, in a raw Fourier spectrum, they average out as well
        return nearest if strong.size > 4 * _MOST_BREAKS else np.union1d(nearest, strong)

    def _saturation_moments(self) -> FloatArray:
        """Moments that part a steep spectrum, whose M hardly rises with q any more, at each half e-fold of dM/dlnq."""
        fall = np.maximum(-self._slope_exponent, 0.0) * self._length
        total = np.concatenate([[0.0], np.cumsum(fall)])
        is_rising = np.concatenate([[True], np.diff(total) > 0.0])
        log_q = np.interp(np.arange(0.5, total[-1], 0.5), total[is_rising], self._log_q[is_rising])
        return self.slope_moment(np.exp(log_q))

    @property
    def break_pieces(self) -> IntArray | None:
        """Piece between each pair of neighbouring breaks, where no break was left out; otherwise None."""
        breaks = self.break_moments
        if not np.all(np.isin(self._slope_moment[self._slope_moment < self.last_moment], breaks)):
            return None
        return np.searchsorted(self._slope_moment[1:-1], 0.5 * (breaks[1:] + breaks[:-1]), side="right")

    def between(self, low: float, high: float) -> PowerSpectrum:
        """The part of the spectrum between two wavenumbers, either of which may lie beyond its end.

        Parameters
        ----------
        low, high : float
            [1/m]

        Examples
        --------
        >>> rough = PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=1e6)
        >>> long_waves = rough.between(0.0, 1e5)
        >>> long_waves.q_low, long_waves.q_high, long_waves.rms_height < rough.rms_height
        (10000.0, 100000.0, True)
        """
        ends = np.array([max(low, self.q_low), min(high, self.q_high)])
        is_between = (self.wavenumber > ends[0]) & (self.wavenumber < ends[1])
        q = np.concatenate([ends[:1], self.wavenumber[is_between], ends[1:]])
        C = np.asarray(self(ends))
        return PowerSpectrum(q, np.concatenate([C[:1], self.density[is_between], C[1:]]))

    # ---------------------------------------------------------------- pieces

    def _piece_of(self, q: FloatArray) -> IntArray:
        return np.minimum(np.maximum(self.wavenumber.searchsorted(q, side="right") - 1, 0), self._last_piece)

    @property
    def _last_piece(self) -> int:
        return int(np.flatnonzero(self._length > 0.0)[-1])

    def _at_ends_of(self, left: FloatArray, right: FloatArray) -> FloatArray:
        """ln C at both ends of stretches within one piece, steps being steps; -inf outside, shape (n, 2)."""
        middle = np.sqrt(left * right)
        k = self._piece_of(middle)
        log_q = np.log(np.column_stack([left, right]))
        log_C = self._log_C[k, None] + self._slope[k, None] * (log_q - self._log_q[k, None])
        is_held = (middle > self.q_low) & (middle < self.q_high)
        return np.where(is_held[:, None], log_C, -np.inf)

    @cached_property
    def _log_q(self) -> FloatArray:
        return np.log(self.wavenumber)

    @cached_property
    def _log_C(self) -> FloatArray:
        return np.log(self.density)

    @property
    def _length(self) -> FloatArray:
        return self._log_q[1:] - self._log_q[:-1]

    @cached_property
    def _slope(self) -> FloatArray:
        return slopes(self._log_q, self._log_C)

    @property
    def _slope_exponent(self) -> FloatArray:
        return not_zero(4.0 + self._slope)

    @property
    def _slope_scale(self) -> FloatArray:
        return np.exp(self._log_C[:-1] + 4.0 * self._log_q[:-1])

    @property
    def _growth_rate(self) -> FloatArray:
        """What a rise of M from the start of a piece is times, to be exp(exponent x rise of ln q) - 1."""
        return self._slope_exponent / self._slope_scale

    @property
    def _inverse_exponent(self) -> FloatArray:
        return 1.0 / self._slope_exponent

    @cached_property
    def _slope_moment(self) -> FloatArray:
        steps = self._slope_scale * power_integral(self._slope_exponent, self._length)
        return np.concatenate([[0.0], np.cumsum(steps)])

    @property
    def _height_above(self) -> FloatArray:
        steps = np.exp(self._log_C[:-1] + 2.0 * self._log_q[:-1]) * power_integral(
            2.0 + self._slope, self._length
        )
        return np.concatenate([np.cumsum(steps[::-1])[::-1], [0.0]])


def _straight(ends: FloatArray) -> tuple[FloatArray, FloatArray]:
    """ln C at both ends of stretches and its rise, zero where there is nothing."""
    is_finite = np.isfinite(ends[:, 0])
    return ends, np.subtract(ends[:, 1], ends[:, 0], out=np.zeros(len(ends)), where=is_finite)


def _pieces_of_sum(length: FloatArray, first: FloatArray, second: FloatArray) -> IntArray:
    """Pieces of the sums of two power laws on stretches of `length` in ln q, from ln C at both ends, shape (n, 2).

    A sum bends by (difference of slopes)^2 w (1 - w), w the share of the first; its chord is off by length^2/8 of that.
    """
    are_finite = np.isfinite(first[:, 0]) & np.isfinite(second[:, 0])
    ratio = np.subtract(first, second, out=np.zeros(first.shape), where=are_finite[:, None])
    least_ratio = np.where(ratio[:, 0] * ratio[:, 1] < 0.0, 0.0, np.abs(ratio).min(axis=1))
    share = 1.0 / (1.0 + np.exp(np.minimum(least_ratio, 700.0)))
    bend = (ratio[:, 1] - ratio[:, 0]) ** 2 * share * (1.0 - share)
    return np.maximum(np.ceil(np.sqrt(bend / (8.0 * _SUM_ERROR))), 1).astype(int)


@lru_cache(maxsize=256)
def _self_affine_shape(low: float, rolloff: float, high: float, hurst: float) -> PowerSpectrum:
    """Self-affine spectrum with a flat part of 1 m^4."""
    q = np.array(sorted({low, rolloff, high}))
    return PowerSpectrum(q, np.where(q > rolloff, (q / rolloff) ** (-2.0 * (1.0 + hurst)), 1.0))
