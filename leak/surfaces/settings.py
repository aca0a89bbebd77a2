"""Settings for the spectrum of measured scans."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from leak.errors import ScanError, positive
from leak.surfaces.outliers import OUTLIERS, Outliers
from leak.surfaces.periodogram import WINDOWS, Window
from leak.surfaces.scans import DETRENDS, Detrend


@dataclass(frozen=True)
class SelfAffineContinuation:
    """C ~ q^(-2 (1 + H)) outside the reliable range of a scan: an assumption, not a measurement.

    Parameters
    ----------
    hurst : float
        Hurst exponent H, between 0 and 1 [-].
    q_low, q_high : float, optional
        Where the continued spectrum begins and ends; None: the end of the reliable range [1/m].

    Raises
    ------
    ScanError
        A value is outside its range, or neither end is given.

    Examples
    --------
    >>> import leak
    >>> leak.SelfAffineContinuation(hurst=0.8, q_high=1e8).hurst
    0.8
    """

    hurst: float
    q_low: float | None = None
    q_high: float | None = None

    def __post_init__(self) -> None:
        if not 0.0 < positive(ScanError, "hurst", self.hurst, "-") <= 1.0:
            raise ScanError(f"hurst = {self.hurst}: must lie in (0, 1]")
        for name, value in (("q_low", self.q_low), ("q_high", self.q_high)):
            if value is not None:
                positive(ScanError, name, value, "1/m")
        if self.q_low is None and self.q_high is None:
            raise ScanError(
                "q_low and q_high are both missing: say where the continued spectrum begins or ends [1/m]"
            )


@dataclass(frozen=True)
class ScanSettings:
    """How scans become a spectrum.

    Parameters
    ----------
    detrend : {"tilt", "mean", "curvature"}
        What is taken off each scan first: its mean line or plane, its mean only, or its mean parabola or paraboloid
        (for scans over a ball, a cone or another curved part).
    window : {"hann", "none"}
        Weight of the heights along the scan. "none" is for periodic, calculated surfaces only.
    tip_radius : float, optional
        Radius of the stylus tip; the file's, if it states one, unless given [m].
    shortest_wavelength : float, optional
        What the instrument resolves (optical resolution, filter); two points unless given [m].
    extrapolation : "cut" or SelfAffineContinuation
        What lies outside the reliable range: nothing, or a continuation.
    outliers : {"keep", "remove"}
        Points that stand alone (`leak.surfaces.outliers.find_outliers`): kept, or replaced by what surrounds them.

    Raises
    ------
    ScanError
        A value is none of these.

    Examples
    --------
    >>> import leak
    >>> leak.ScanSettings(detrend="curvature", tip_radius=2e-6).window
    'hann'
    """

    detrend: Detrend = "tilt"
    window: Window = "hann"
    tip_radius: float | None = None
    shortest_wavelength: float | None = None
    extrapolation: Literal["cut"] | SelfAffineContinuation = "cut"
    outliers: Outliers = "keep"

    def __post_init__(self) -> None:
        for name, value, known in (
            ("detrend", self.detrend, DETRENDS),
            ("window", self.window, WINDOWS),
            ("outliers", self.outliers, OUTLIERS),
        ):
            if value not in known:
                raise ScanError(f"{name} = {value!r}: must be " + " or ".join(f'"{one}"' for one in known))
        for name, length in (
            ("tip_radius", self.tip_radius),
            ("shortest_wavelength", self.shortest_wavelength),
        ):
            if length is not None:
                positive(ScanError, name, length, "m")
        if self.extrapolation != "cut" and not isinstance(self.extrapolation, SelfAffineContinuation):
            raise ScanError(
                f'extrapolation = {self.extrapolation!r}: must be "cut" or a SelfAffineContinuation'
            )
