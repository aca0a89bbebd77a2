"""Turned faces: cusps between the grooves of a tool, with fine roughness on them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from leak.arrays import FloatArray
from leak.errors import SurfaceError, positive
from leak.surfaces.random import random_map
from leak.surfaces.spectrum import PowerSpectrum


@dataclass(frozen=True)
class TurnedTexture:
    """A face as a tool of round nose leaves it, which is fed by the same way each turn.

    Parameters
    ----------
    feed : float
        Distance of the crests [m].
    nose_radius : float
        Of the tool [m].
    fine : PowerSpectrum
        Isotropic roughness of the grooves: tool edge, built-up edge, material.

    Raises
    ------
    SurfaceError
        A value is not positive, or the feed is more than the nose of the tool spans.

    Examples
    --------
    >>> import leak
    >>> fine = leak.PowerSpectrum.self_affine(rms_height=1e-7, hurst=0.8, q_low=3e4, q_rolloff=2.5e5, q_high=4e6)
    >>> texture = leak.TurnedTexture(feed=1e-4, nose_radius=8e-4, fine=fine)
    >>> print(f"{texture.crest_height * 1e6:.2f} um, slope {texture.side_slope:.3f}, Ra {texture.Ra * 1e6:.2f} um")
    1.56 um, slope 0.062, Ra 0.41 um
    """

    feed: float
    nose_radius: float
    fine: PowerSpectrum

    def __post_init__(self) -> None:
        f = positive(SurfaceError, "feed", self.feed, "m")
        r = positive(SurfaceError, "nose_radius", self.nose_radius, "m")
        if not isinstance(self.fine, PowerSpectrum):
            raise SurfaceError(f"fine = {self.fine!r}: must be a PowerSpectrum")
        if f >= r:
            raise SurfaceError(
                f"feed = {f:g} m: must be below the nose radius, {r:g} m; cusps are flat parabolas"
            )

    @property
    def crest_height(self) -> float:
        """R_t = f^2/(8 r), from the bottom of a groove to a crest [m]."""
        return self.feed**2 / (8.0 * self.nose_radius)

    @property
    def side_slope(self) -> float:
        """m = f/(2 r), of both sides at the crest [-]."""
        return self.feed / (2.0 * self.nose_radius)

    @property
    def Ra(self) -> float:
        """Mean deviation of a profile across the grooves [m]: of parabolas 2/(9 sqrt 3)*2 R_t, with the fine roughness.

        Cusp and fine roughness are added as independent parts of one profile.
        """
        from scipy.special import erf

        deviation = self.depth_at(np.linspace(0.0, 0.5 * self.feed, 1025)[1::2])
        deviation = deviation - deviation.mean()
        s = self.fine.rms_height
        # mean of |d + z| over a Gaussian z
        rest = math.sqrt(2.0 / math.pi) * s * np.exp(-0.5 * (deviation / s) ** 2)
        return float(np.mean(rest + deviation * erf(deviation / (math.sqrt(2.0) * s))))

    def depth_at(self, distance: FloatArray) -> FloatArray:
        """Depth of the smooth face below its crests [m].

        Parameters
        ----------
        distance : ndarray
            From the nearest crest, up to half of the feed [m].
        """
        return self.side_slope * distance - distance**2 / (2.0 * self.nose_radius)

    def heights(self, *, points: int, crests: int, seed: int) -> FloatArray:
        """A periodic square piece of the face, as `leak.direct.simulate` takes it.

        Parameters
        ----------
        points : int
            Along each side.
        crests : int
            So many feeds are its side.
        seed : int
            Of the fine roughness.

        Returns
        -------
        ndarray, shape (points, points)
            Heights [m]; crests run along the second axis, so that the fluid crosses them along the first.
        """
        size = crests * self.feed
        place = np.arange(points) * (size / points)
        distance = np.abs((place + 0.5 * self.feed) % self.feed - 0.5 * self.feed)
        fine = random_map(self.fine, size=size, points=points, seed=seed)
        return np.asarray(fine - self.depth_at(distance)[:, None])
