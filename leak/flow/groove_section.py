"""Section of a groove in a seat: closed by the contact pressure, conductance of the rest."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import FloatArray
from leak.errors import ProfileError, positive
from leak.flow.rarefied import flow_factor
from leak.fluids.properties import Gas
from leak.numerics.curves import MonotoneCurve, cubic_spline_slopes
from leak.numerics.integrals import gauss

# Over half of the section: the flow of a gas through an ellipse to 1e-7 in the continuum, 1e-5 of free molecules.
_NODES = 16
# Of the table of that flow over ln D of the full depth: below it the flow is one of free molecules, above it that of a
# continuum to 1e-9. With this step it is interpolated to 1e-8, a tenth of what the table of the slit is good to.
_TABLE_ENDS, _TABLE_STEP = (-7.0, 24.0), 2e-3


@runtime_checkable
class GrooveSection(Protocol):
    """A groove that closes under pressure.

    Examples
    --------
    >>> import leak
    >>> isinstance(leak.EllipticGroove(1e-6, 20e-6), leak.GrooveSection)
    True
    """

    @property
    def width(self) -> float:
        """Full width [m]."""

    def closing_pressure(self, effective_modulus: float) -> float:
        """Nominal contact pressure that closes the groove [Pa]."""

    def open_depth(self, pressure: ArrayLike, effective_modulus: float) -> FloatArray:
        """Largest gap under a contact pressure, less the fluid pressure in the groove [m]."""

    def mean_gap(self, pressure: ArrayLike, effective_modulus: float) -> FloatArray:
        """Open area of the section over its full width [m]."""

    def liquid_conductance(
        self, pressure: ArrayLike, effective_modulus: float, viscosity: float
    ) -> FloatArray:
        """K = flow over pressure gradient [m^4/(Pa s)]."""

    def gas_conductance(
        self, pressure: ArrayLike, effective_modulus: float, gas: Gas, gas_pressure: ArrayLike
    ) -> FloatArray:
        """K = volume flow at the gas pressure over its gradient [m^4/(Pa s)]."""


@dataclass(frozen=True)
class EllipticGroove:
    """Groove with the section of an ellipse, `depth` deep and `width` wide, that closes like a crack.

    Parameters
    ----------
    depth : float
        d0, without load [m].
    width : float
        Full width 2a; pressure does not change it [m].

    Raises
    ------
    ProfileError
        A number is not positive and finite.

    Notes
    -----
    d(p) = d0 (1 - p/p_close), p_close = E* d0/(2a): two half-spaces close an elliptic gap as they open a crack, by
    2 a p/E* in the middle. K = pi a^3 b^3/(4 eta (a^2 + b^2)) with b = d/2, exact for an ellipse of the axes 2a and d;
    for b << a it is (3 pi/8) a d^3/(12 eta), a slit of the same depths. Half an ellipse, as a groove in one of
    two faces is, differs by d^2/(12 a^2) of K.

    References
    ----------
    H. Tada, P. C. Paris, G. R. Irwin, The Stress Analysis of Cracks Handbook (2000), 5.1; F. M. White, Viscous Fluid
    Flow (2006), section 3-3.3 (elliptic duct).

    Examples
    --------
    >>> groove = EllipticGroove(depth=5e-6, width=30e-6)
    >>> f"{groove.closing_pressure(115e9) / 1e9:.1f} GPa"
    '19.2 GPa'
    >>> f"{float(groove.liquid_conductance(0.0, 115e9, 1e-3)):.4g} m^4/(Pa s)"
    '1.791e-19 m^4/(Pa s)'
    """

    depth: float
    width: float

    def __post_init__(self) -> None:
        for key in ("depth", "width"):
            positive(ProfileError, key, getattr(self, key), "m")

    def closing_pressure(self, effective_modulus: float) -> float:
        """p_close = E* d0/(2a) [Pa]."""
        return positive(ProfileError, "effective_modulus", effective_modulus, "Pa") * self.depth / self.width

    def open_depth(self, pressure: ArrayLike, effective_modulus: float) -> FloatArray:
        """d(p) [m]: zero from the closing pressure on, d0 for no or negative pressure.

        Where the fluid pressure exceeds the contact pressure it presses on all of the faces, and opens no groove in
        them beyond d0.
        """
        share = np.asarray(pressure, dtype=float) / self.closing_pressure(effective_modulus)
        return np.asarray(self.depth * (1.0 - np.clip(share, 0.0, 1.0)))

    def mean_gap(self, pressure: ArrayLike, effective_modulus: float) -> FloatArray:
        """Open area over the width, (pi/4) d(p) [m]."""
        return 0.25 * np.pi * self.open_depth(pressure, effective_modulus)

    def liquid_conductance(
        self, pressure: ArrayLike, effective_modulus: float, viscosity: float
    ) -> FloatArray:
        """K = pi a^3 b^3/(4 eta (a^2 + b^2)), b = d(p)/2 [m^4/(Pa s)]."""
        a, b = 0.5 * self.width, 0.5 * self.open_depth(pressure, effective_modulus)
        eta = positive(ProfileError, "viscosity", viscosity, "Pa s")
        return np.asarray(np.pi * (a * b) ** 3 / (4.0 * eta * (a**2 + b**2)))

    def gas_conductance(
        self, pressure: ArrayLike, effective_modulus: float, gas: Gas, gas_pressure: ArrayLike
    ) -> FloatArray:
        """K of a rarefied gas [m^4/(Pa s)]: at every place of the section the slit flow of the local depth.

        Parameters
        ----------
        pressure : array_like
            Contact pressure less the fluid pressure that counts against it [Pa].
        effective_modulus : float
            E* [Pa].
        gas : Gas
        gas_pressure : array_like
            Absolute pressure of the gas, of a real one its `Gas.flow_pressure` [Pa].
        """
        D = _inverse_knudsen(self.open_depth(pressure, effective_modulus), gas, gas_pressure)
        factor = np.exp(_log_elliptic_factors().value(np.log(D)))
        return self.liquid_conductance(pressure, effective_modulus, gas.viscosity) * factor


@dataclass(frozen=True)
class SinusoidalGroove:
    """One wave of a sinusoidal surface, `height` from crest to trough, pressed against a flat one.

    Parameters
    ----------
    height : float
        2h, without load [m].
    wavelength : float
        l; must be long against the height [m].

    Raises
    ------
    ProfileError
        A number is not positive and finite.

    Notes
    -----
    Westergaard's contact, s = p/p*, p* = pi E* h/l: the surfaces touch over the share (2/pi) arcsin(sqrt(s)) of a wave,
    and between the contacts the gap is 2 h [t sqrt(t^2 - s) - s arcosh(t/sqrt(s))], t = abs(sin(pi x/l)), x counted
    from a crest. Its mean over the wave is h (1 - s + s ln s). K = int gap^3 dx/(12 eta).

    References
    ----------
    H. M. Westergaard, J. Appl. Mech. 6, A49 (1939); K. L. Johnson, Contact Mechanics (1985), section 13.2; K. L.
    Johnson, J. A. Greenwood, J. G. Higginson, Int. J. Mech. Sci. 27, 383 (1985).

    Examples
    --------
    >>> turned = SinusoidalGroove(height=1e-6, wavelength=100e-6)
    >>> f"{turned.closing_pressure(115e9) / 1e6:.0f} MPa"
    '1806 MPa'
    >>> float(turned.mean_gap(0.0, 115e9))
    5e-07
    """

    height: float
    wavelength: float

    def __post_init__(self) -> None:
        for key in ("height", "wavelength"):
            positive(ProfileError, key, getattr(self, key), "m")

    @property
    def width(self) -> float:
        """The wavelength [m]."""
        return self.wavelength

    def closing_pressure(self, effective_modulus: float) -> float:
        """p* = pi E* h/l [Pa]."""
        modulus = positive(ProfileError, "effective_modulus", effective_modulus, "Pa")
        return np.pi * modulus * 0.5 * self.height / self.wavelength

    def open_depth(self, pressure: ArrayLike, effective_modulus: float) -> FloatArray:
        """Gap above the trough [m]; zero from p* on, 2h for no or negative pressure."""
        return self.height * _wave_gap(np.float64(1.0), self._share(pressure, effective_modulus))

    def mean_gap(self, pressure: ArrayLike, effective_modulus: float) -> FloatArray:
        """Mean gap over a wave, h (1 - s + s ln s) [m]."""
        from scipy.special import xlogy

        s = self._share(pressure, effective_modulus)
        return np.asarray(0.5 * self.height * (1.0 - s + xlogy(s, s)))

    def liquid_conductance(
        self, pressure: ArrayLike, effective_modulus: float, viscosity: float
    ) -> FloatArray:
        """K = int gap^3 dx/(12 eta) over one wave [m^4/(Pa s)]."""
        eta = positive(ProfileError, "viscosity", viscosity, "Pa s")
        gap, weight = self._gaps(pressure, effective_modulus)
        return np.asarray((weight * gap**3).sum(axis=-1) / (12.0 * eta))

    def gas_conductance(
        self, pressure: ArrayLike, effective_modulus: float, gas: Gas, gas_pressure: ArrayLike
    ) -> FloatArray:
        """K of a rarefied gas, see `EllipticGroove.gas_conductance` [m^4/(Pa s)]."""
        gap, weight = self._gaps(pressure, effective_modulus)
        D = _inverse_knudsen(gap, gas, np.asarray(gas_pressure, dtype=float)[..., None])
        gap_cubed = gap**3 * flow_factor(D)
        return np.asarray((weight * gap_cubed).sum(axis=-1) / (12.0 * gas.viscosity))

    def _share(self, pressure: ArrayLike, effective_modulus: float) -> FloatArray:
        """s = p/p*, between zero and one."""
        share = np.asarray(pressure, dtype=float) / self.closing_pressure(effective_modulus)
        return np.asarray(np.clip(share, 0.0, 1.0))

    def _gaps(self, pressure: ArrayLike, effective_modulus: float) -> tuple[FloatArray, FloatArray]:
        """Gap at places along the open part of the wave [m], and the width that each stands for [m]."""
        s = self._share(pressure, effective_modulus)[..., None]
        # counted from the trough, both halves of the wave
        half = np.arccos(np.sqrt(s))
        gap = self.height * _wave_gap(np.cos(0.5 * half * (1.0 + gauss(_NODES)[0])), s)
        return gap, self.wavelength / np.pi * half * gauss(_NODES)[1]


def _wave_gap(t: FloatArray | np.float64, s: FloatArray) -> FloatArray:
    """Gap over the height of the wave, t sqrt(t^2 - s) - s arcosh(t/sqrt(s))."""
    from scipy.special import xlogy

    root = np.sqrt(np.maximum(t * t - s, 0.0))
    return np.maximum(t * root - s * np.log(t + root) + 0.5 * xlogy(s, s), 0.0)


def _inverse_knudsen(gap: FloatArray, gas: Gas, gas_pressure: ArrayLike) -> FloatArray:
    """D of the gas at gaps and pressures."""
    D = np.asarray(gas_pressure, dtype=float) * gap / (gas.viscosity * gas.molecular_speed)
    # where the groove is shut, or in a perfect vacuum, the product with gap^3 is what counts
    return np.maximum(D, 1e-100)


@lru_cache(maxsize=1)
def _log_elliptic_factors() -> MonotoneCurve:
    """ln of the flow of a gas through an ellipse, over that of a continuum, over ln D of its full depth."""
    angle = 0.25 * np.pi * (1.0 + gauss(_NODES)[0])
    # int g^3 dx over int g^3 f dx: cos^4 of the angle are three of the depth and one of dx
    weight = np.cos(angle) ** 4 * gauss(_NODES)[1]
    log_D = np.arange(_TABLE_ENDS[0], _TABLE_ENDS[1], _TABLE_STEP)
    factor = np.log(flow_factor(np.exp(log_D)[:, None] * np.cos(angle)) @ (weight / weight.sum()))
    return MonotoneCurve(log_D, factor, cubic_spline_slopes(log_D, factor))
