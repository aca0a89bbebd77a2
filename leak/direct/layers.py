"""Elastic half-space with plastic strain in layers below its surface, loaded alike in every cell of a square lattice.

Notation: z depth, u displacement, q wave vector in the plane; l, t along and across q. For each q the displacement is
(i U, i T, W) exp(iq.x) in the frame (l, t, z), so that all equations are real: e_ll = -q U, e_zz = W',
e_lz = i(U' + q W)/2, e_lt = -q T/2, e_tz = i T'/2. Linear elements in z with strain and stress at the middle of each
layer; the elastic half-space below the last one is exact. This midpoint rule keeps what decays with depth apart from
what grows, so that the compliance of the surface is 2/(E* q) whatever the layers.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from leak.arrays import FloatArray
from leak.direct.contact import PeriodicHalfSpace
from leak.numerics.roots import root_of_rising

# The first layer is half as thick as the grid is wide, all of them reach a third of the shorter side.
_FIRST_LAYER, _DEPTH = 0.5, 1.0 / 3.0

# Components of a strain without change of volume; e_zz = -e_xx - e_yy.
XX, YY, XY, XZ, YZ = range(5)


def squared_norm(strain: FloatArray) -> FloatArray:
    """e:e of strains without change of volume, components first [-]."""
    xx, yy, xy, xz, yz = strain
    return np.asarray(2.0 * (xx * xx + yy * yy + xx * yy + xy * xy + xz * xz + yz * yz))


class _Factors(NamedTuple):
    """Factorised stiffness, per wave, of nodes of which each knows the next ones: blocks from the lowest node up."""

    inverse: FloatArray
    """Of the pivots, shape (layers + 1, size, size, waves)."""
    transfer: FloatArray
    """What a node hands to the one above, shape (layers, size, size, waves)."""

    @classmethod
    def of(cls, pivot: FloatArray, coupling: FloatArray) -> _Factors:
        """Of diagonal blocks of one or two unknowns and the blocks above them, which are overwritten."""
        for k in range(len(pivot) - 1, -1, -1):
            if k < len(coupling):
                block = coupling[k].copy()
                coupling[k] = np.einsum("abm,bcm->acm", block, pivot[k + 1])
                pivot[k] -= np.einsum("abm,cbm->acm", coupling[k], block)
            if pivot.shape[1] == 1:
                pivot[k] = 1.0 / pivot[k]
            else:
                (a, b), (c, d) = pivot[k]
                pivot[k] = np.array([[d, -b], [-c, a]]) / (a * d - b * c)
        return cls(pivot, coupling)

    def solve(self, force: np.ndarray) -> np.ndarray:
        """Displacements by nodal forces, shape (layers + 1, size, waves); the forces are overwritten."""
        for k in range(len(self.transfer) - 1, -1, -1):
            force[k] -= (self.transfer[k] * force[k + 1]).sum(axis=1)
        for k, inverse in enumerate(self.inverse):
            force[k] = (inverse * force[k]).sum(axis=1)
            if k:
                force[k] -= (self.transfer[k - 1] * force[k - 1][:, None]).sum(axis=0)
        return force


class PlasticResponse(NamedTuple):
    """Displacement of the nodes by plastic strain, per wave.

    Examples
    --------
    >>> import numpy as np
    >>> from leak.direct import PeriodicHalfSpace
    >>> from leak.direct.layers import LayeredHalfSpace
    >>> body = LayeredHalfSpace(PeriodicHalfSpace(8, 1e-3, 100e9), poissons_ratio=0.3, layers=4)
    >>> float(np.abs(body.response(np.zeros((5, 4, 8, 8))).along_wave).max())
    0.0
    """

    along_wave: np.ndarray
    """U and W, shape (layers + 1, 2, waves)."""
    across_wave: np.ndarray
    """T, shape (layers + 1, waves)."""
    mean: FloatArray
    """Mean plastic strain of each layer, shape (5, layers)."""


@dataclass(frozen=True)
class LayeredHalfSpace:
    """Stress and displacement of an elastic half-space by the pressure on it and by plastic strain below.

    Parameters
    ----------
    surface : PeriodicHalfSpace
        Grid, side and E*; the solid is the only body that gives way, E = E*(1 - nu^2).
    poissons_ratio : float
        nu [-].
    layers : int
        Down to a third of the shorter side, the first one half a grid cell thick.

    References
    ----------
    K. L. Johnson, Contact Mechanics (1985), section 13.2; T. Mura, Micromechanics of Defects in Solids (1987), for
    eigenstrains; L. Frerot et al., Comput. Methods Appl. Mech. Eng. 351, 951 (2019), for the same task in integrals.

    Examples
    --------
    >>> body = LayeredHalfSpace(PeriodicHalfSpace(8, 1e-3, 100e9), poissons_ratio=0.3, layers=16)
    >>> round(1e3 * float(body.thickness.sum()), 3)
    0.333
    """

    surface: PeriodicHalfSpace
    poissons_ratio: float
    layers: int

    @property
    def shear_modulus(self) -> float:
        """G [Pa]."""
        return self.youngs_modulus / (2.0 * (1.0 + self.poissons_ratio))

    @property
    def youngs_modulus(self) -> float:
        """E = E*(1 - nu^2) [Pa]."""
        return self.surface.effective_modulus * (1.0 - self.poissons_ratio**2)

    @property
    def _lame(self) -> float:
        return 2.0 * self.shear_modulus * self.poissons_ratio / (1.0 - 2.0 * self.poissons_ratio)

    @cached_property
    def thickness(self) -> FloatArray:
        """Of each layer from the top, shape (layers,) [m]."""
        first_layer = _FIRST_LAYER * self.surface.spacing
        total = _DEPTH * min(self.surface.shape) * self.surface.spacing / first_layer
        n = np.arange(self.layers)
        log_growth = root_of_rising(
            lambda x: float(np.log(np.exp(n * x).sum() / total)), -5.0, 5.0, 0.05, 1e-12
        )
        return first_layer * np.exp(n * log_growth)

    # ---------------------------------------------------------------- waves

    @cached_property
    def _waves(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """q [1/m], and cosine and sine of its angle, shape (n, m // 2 + 1)."""
        (n, m), spacing = self.surface.shape, self.surface.spacing
        q_x, q_y = np.fft.fftfreq(n, spacing)[:, None], np.fft.rfftfreq(m, spacing)[None, :]
        q = np.hypot(q_x, q_y)
        q[0, 0] = 1.0
        return 2.0 * np.pi * q, q_x / q, q_y / q

    @property
    def _q(self) -> FloatArray:
        return self._waves[0].ravel()

    @property
    def _coupling_mask(self) -> FloatArray:
        """Waves through which plastic strain acts: all but the mean and, odd derivatives having none, the shortest."""
        n, m = self.surface.shape
        mask = np.ones(self._waves[0].shape)
        mask[0, 0] = 0.0
        if n % 2 == 0:
            mask[n // 2, :] = 0.0
        if m % 2 == 0:
            mask[:, m // 2] = 0.0
        return mask

    @cached_property
    def _factors(self) -> tuple[_Factors, _Factors]:
        """Of the waves' own plane, U and W, and of T across it."""
        q, G, lame, nu = self._q, self.shear_modulus, self._lame, self.poissons_ratio
        nodes, none = self.layers + 1, np.zeros_like(self._q)
        (pivot, coupling), (pivot_t, coupling_t) = (
            (np.zeros((nodes, size, size, q.size)), np.zeros((self.layers, size, size, q.size)))
            for size in (2, 1)
        )
        for k, h in enumerate(self.thickness):
            steep = np.full_like(q, 1.0 / h)
            # e_ll, e_zz and e_lz/i by U, W at the top and U, W at the bottom of the layer
            ll, zz, lz = (
                np.array([-0.5 * q, none, -0.5 * q, none]),
                np.array([none, -steep, none, steep]),
                np.array([-0.5 * steep, 0.25 * q, 0.5 * steep, 0.25 * q]),
            )
            stiffness = h * (
                lame * (ll + zz)[:, None] * (ll + zz)
                + 2.0 * G * (ll[:, None] * ll + zz[:, None] * zz + 2.0 * lz[:, None] * lz)
            )
            pivot[k] += stiffness[:2, :2]
            pivot[k + 1] += stiffness[2:, 2:]
            coupling[k] = stiffness[:2, 2:]
            pivot_t[k : k + 2] += h * G * (0.25 * q * q + steep * steep)
            coupling_t[k] = h * G * (0.25 * q * q - steep * steep)
        direct, cross = 2.0 - 2.0 * nu, 2.0 * nu - 1.0
        pivot[-1] += 2.0 * G * q / (3.0 - 4.0 * nu) * np.array([[direct, cross], [cross, direct]])[..., None]
        pivot_t[-1] += G * q
        return _Factors.of(pivot, coupling), _Factors.of(pivot_t, coupling_t)

    @cached_property
    def _by_pressure(self) -> FloatArray:
        """U and W by a pressure of one on the surface, shape (layers + 1, 2, waves) [m/Pa]."""
        force = np.zeros((self.layers + 1, 2, self._q.size))
        force[0, 1] = 1.0
        return self._factors[0].solve(force)

    # ---------------------------------------------------------------- answers

    def response(self, strain: FloatArray) -> PlasticResponse:
        """What plastic strain displaces.

        Parameters
        ----------
        strain : ndarray
            Plastic strain without change of volume, shape (5, layers, n, m), components `XX` to `YZ` [-].
        """
        from scipy import fft

        G, q, h = self.shear_modulus, self._q, self.thickness[:, None]
        waves = fft.rfft2(strain)
        mean = waves[..., 0, 0].real / math.prod(self.surface.shape)
        waves *= self._coupling_mask
        _, c, s = self._waves
        xx, yy, xy, xz, yz = waves

        def flat(values: np.ndarray) -> np.ndarray:
            return values.reshape(self.layers, -1)

        # stress 2 G e on the strains of the nodes' own displacement
        force, force_t = (np.zeros((self.layers + 1, size, q.size), complex) for size in (2, 1))
        stretch = (-G * h * q) * flat(c * c * xx + s * s * yy + 2.0 * c * s * xy)
        shear = (-2.0j * G) * flat(c * xz + s * yz)
        force[:-1, 0] = stretch - shear
        force[1:, 0] += stretch + shear
        rise, tilt = (-2.0 * G) * flat(xx + yy), (0.5 * h * q) * shear
        force[:-1, 1] = tilt - rise
        force[1:, 1] += tilt + rise
        stretch = (-G * h * q) * flat(c * s * (yy - xx) + (c * c - s * s) * xy)
        shear = (-2.0j * G) * flat(c * yz - s * xz)
        force_t[:-1, 0] = stretch - shear
        force_t[1:, 0] += stretch + shear
        in_plane, out_of_plane = self._factors
        return PlasticResponse(in_plane.solve(force), out_of_plane.solve(force_t)[:, 0], mean)

    def surface_rise(self, response: PlasticResponse) -> FloatArray:
        """Displacement of the surface by plastic strain, upwards, shape (n, m) [m].

        Its mean is that of a body that cannot become wider: (1 - 2 nu)/(1 - nu) of the mean plastic strain along z,
        over the depth.
        """
        from scipy import fft

        shape, nu = self.surface.shape, self.poissons_ratio
        surface = -response.along_wave[0, 1].reshape(shape[0], -1)
        thicker = -(response.mean[XX] + response.mean[YY])
        surface[0, 0] = math.prod(shape) * (1.0 - 2.0 * nu) / (1.0 - nu) * float(thicker @ self.thickness)
        return np.asarray(fft.irfft2(surface, shape))

    def distortion(
        self, response: PlasticResponse, pressure: FloatArray, stretch: tuple[float, float] = (0.0, 0.0)
    ) -> FloatArray:
        """Total strain less its change of volume, elastic and plastic, shape (5, layers, n, m) [-].

        Parameters
        ----------
        response : PlasticResponse
        pressure : ndarray
            On the surface, shape (n, m) [Pa].
        stretch : tuple of float
            Mean total strain in the plane along both axes [-].
        """
        from scipy import fft

        shape, q, h = self.surface.shape, self._q, self.thickness[:, None]
        points = math.prod(shape)
        _, c, s = self._waves
        waves_p = fft.rfft2(pressure).ravel()
        U, W = (response.along_wave[:, k] + self._by_pressure[:, k] * waves_p for k in (0, 1))
        T = response.across_wave

        def by_layer(values: np.ndarray) -> np.ndarray:
            return values.reshape(self.layers, *c.shape)

        ll, zz = (-0.5 * q) * (U[1:] + U[:-1]), (W[1:] - W[:-1]) / h
        third = by_layer((ll + zz) / 3.0)
        ll = by_layer(ll)
        lz = by_layer(0.5j * ((U[1:] - U[:-1]) / h + (0.5 * q) * (W[1:] + W[:-1])))
        lt, tz = by_layer((-0.25 * q) * (T[1:] + T[:-1])), by_layer(0.5j * (T[1:] - T[:-1]) / h)
        waves = np.stack(
            [
                c * c * ll - 2.0 * c * s * lt - third,
                s * s * ll + 2.0 * c * s * lt - third,
                c * s * ll + (c * c - s * s) * lt,
                c * lz - s * tz,
                s * lz + c * tz,
            ]
        )
        waves *= self._coupling_mask
        # the mean: the strain in the plane is given, no shear stress, and the mean pressure along z
        G, in_plane = self.shear_modulus, sum(stretch)
        thicker = -(response.mean[XX] + response.mean[YY])
        rise = (2.0 * G * thicker - self._lame * in_plane - float(np.mean(pressure))) / (self._lame + 2.0 * G)
        for axis, along in zip((XX, YY), stretch, strict=True):
            waves[axis, :, 0, 0] = (along - (rise + in_plane) / 3.0) * points
        waves[[XZ, YZ], :, 0, 0] = response.mean[[XZ, YZ]] * points
        return np.asarray(fft.irfft2(waves, shape, overwrite_x=True))
