"""Ground faces: long grooves of random depth and distance, with fine roughness on their ridges."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from leak.arrays import FloatArray
from leak.errors import SurfaceError, positive
from leak.surfaces.random import profile_density, random_map
from leak.surfaces.spectrum import PowerSpectrum


@dataclass(frozen=True)
class GroundTexture:
    """A face as grinding leaves it, to be simulated directly: no theory of this package knows it.

    Parameters
    ----------
    grooves : PowerSpectrum
        Of an isotropic surface over which a line scan looks as one across the grooves does.
    fine : PowerSpectrum
        Isotropic roughness of grooves and ridges.
    length : float
        Way along a groove over which the correlation of its depth falls to 1/e [m]; endless unless given. The arc in
        which the wheel touches the work is sqrt(a d_s) long, of depth of cut a and diameter d_s: 1 to 2 mm of 5 um and
        0.2 to 0.5 m.

    Raises
    ------
    SurfaceError
        A value outside its meaning.

    References
    ----------
    S. Malkin, Grinding Technology (1989), chapter 3, of the length of the arc.

    Examples
    --------
    >>> import leak
    >>> grooves = leak.PowerSpectrum.self_affine(rms_height=3e-7, hurst=0.8, q_low=1e4, q_rolloff=1e5, q_high=2e6)
    >>> fine = leak.PowerSpectrum.self_affine(rms_height=1e-7, hurst=0.8, q_low=1e4, q_rolloff=2.5e5, q_high=2e6)
    >>> face = leak.GroundTexture(grooves, fine, length=1.5e-3)
    >>> heights = face.heights(points=128, crests=2, seed=1)
    >>> bool(heights.mean(axis=1).std() > 3.0 * heights.mean(axis=0).std())
    True
    """

    grooves: PowerSpectrum
    fine: PowerSpectrum
    length: float = math.inf

    def __post_init__(self) -> None:
        for name in ("grooves", "fine"):
            if not isinstance(getattr(self, name), PowerSpectrum):
                raise SurfaceError(f"{name} = {getattr(self, name)!r}: must be a PowerSpectrum")
        if not math.isinf(self.length):
            positive(SurfaceError, "length", self.length, "m")

    @property
    def period(self) -> float:
        """Half of the side of a square with eight of the waves that make the height of the grooves [m]."""
        return 4.0 * 2.0 * math.pi / self.grooves.median_wavenumber

    def heights(self, *, points: int, crests: int, seed: int) -> FloatArray:
        """A periodic square piece of the face, as `leak.direct.simulate` takes it.

        Parameters
        ----------
        points : int
            Along each side.
        crests : int
            So many periods are its side.
        seed : int
            Of grooves and fine roughness.

        Returns
        -------
        ndarray, shape (points, points)
            Heights [m]; grooves run along the second axis, so that the fluid crosses them along the first.
        """
        size = crests * self.period
        dq = 2.0 * math.pi / size
        q = dq * np.abs(np.fft.fftfreq(points, 1.0 / points))
        q_y = dq * np.arange(points // 2 + 1)
        across = np.asarray(profile_density(self.grooves, q)) * dq
        across[0] = 0.0
        # waves along the grooves, of which there are none in endless ones; all but the first stand for two
        along = np.where(
            q_y == 0.0, 1.0, 0.0 if math.isinf(self.length) else np.exp(-((0.5 * self.length * q_y) ** 2))
        )
        along /= along[0] + 2.0 * along[1:].sum()
        white = np.fft.rfft2(np.random.default_rng(seed).standard_normal((points, points)))
        grooves = np.fft.irfft2(white * np.sqrt(across[:, None] * along) * points, (points, points))
        return np.asarray(grooves + random_map(self.fine, size=size, points=points, seed=points + seed))
