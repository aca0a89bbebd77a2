"""Faces as machined pressed on a flat, grooves and crests as they are: conductivity across and along them."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, MutableMapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import FloatArray
from leak.direct.contact import PeriodicHalfSpace, checked_pressures, press
from leak.direct.elastoplastic import elastoplastic_path
from leak.direct.simulation import PressedPatch
from leak.errors import DirectError, positive
from leak.surfaces.ground import GroundTexture
from leak.surfaces.spectrum import PowerSpectrum
from leak.surfaces.turned import TurnedTexture
from leak.theory.bulk_flow import HARDNESS_OVER_YIELD_STRESS

Texture: TypeAlias = TurnedTexture | GroundTexture
# On the shortest wave of the fine roughness.
_POINTS_PER_WAVE = 4


@dataclass(frozen=True)
class TexturePatch:
    """A periodic square of a turned face on a grid.

    Waves of the fine roughness longer than the side, or shorter than four grid cells, are not in it.

    Parameters
    ----------
    texture : TurnedTexture or GroundTexture
    points : int
        Along a side, a multiple of `crests`.
    crests : int
        Feeds along a side; of two turned faces so many times what repeats.

    Raises
    ------
    DirectError
        A value outside its meaning.

    Examples
    --------
    >>> import leak
    >>> fine = leak.PowerSpectrum.self_affine(rms_height=1e-7, hurst=0.8, q_low=3e4, q_rolloff=2.5e5, q_high=4e6)
    >>> face = leak.TurnedTexture(feed=1e-4, nose_radius=8e-4, fine=fine)
    >>> patch = leak.direct.TexturePatch(face, points=128)
    >>> print(f"{patch.size * 1e6:.0f} um, waves from {patch.shortest_wavelength * 1e6:.2f} um on")
    200 um, waves from 6.25 um on
    """

    texture: Texture
    points: int
    crests: int = 2

    def __post_init__(self) -> None:
        _check_crests(self.crests)
        if self.points != int(self.points) or self.points < 8 or self.points % self.crests:
            raise DirectError(
                f"points = {self.points!r}: must be a multiple of crests = {self.crests}, 8 or more"
            )

    @property
    def size(self) -> float:
        """Side [m]."""
        return self.crests * self.texture.period

    @property
    def spectrum(self) -> PowerSpectrum:
        """Of all of the fine roughness."""
        return self.texture.fine

    @property
    def shortest_wavelength(self) -> float:
        """Of the fine roughness on the grid [m]."""
        return max(_POINTS_PER_WAVE * self.size / self.points, 2.0 * math.pi / self.texture.fine.q_high)

    @cached_property
    def grid_spectrum(self) -> PowerSpectrum:
        """The part of the fine roughness that the grid holds."""
        return self._held(self.texture.fine)

    def _held(self, spectrum: PowerSpectrum) -> PowerSpectrum:
        # the last wave on a grid line must not be lost to rounding
        highest = 2.0 * math.pi / self.shortest_wavelength * (1.0 + 1e-9)
        return spectrum.between(spectrum.q_low, highest)

    @property
    def height_cut(self) -> float:
        """Share of the height variance of the fine roughness that is cut [-]."""
        return float(1.0 - self.grid_spectrum.rms_height**2 / self.spectrum.rms_height**2)

    @property
    def slope_cut(self) -> float:
        """Share of its slope variance that is cut [-]."""
        return float(1.0 - self.grid_spectrum.rms_slope**2 / self.spectrum.rms_slope**2)

    def heights(self, seed: int) -> FloatArray:
        """A sample, shape (points, points) [m]; see `leak.TurnedTexture.heights`.

        Parameters
        ----------
        seed : int
            Of the fine roughness.
        """
        held: Texture = replace(self.texture, fine=self.grid_spectrum)
        if isinstance(held, GroundTexture):
            held = replace(held, grooves=self._held(held.grooves))
        return held.heights(points=self.points, crests=self.crests, seed=seed)


@dataclass(frozen=True, eq=False)
class TextureResult:
    """A textured face over rising pressure; all arrays have shape (P,), means over the seeds.

    Parameters
    ----------
    pressure : ndarray
        Nominal [Pa].
    contact_area, yielded_area : ndarray
        Shares of the points that touch, and of those at the hardness or below which metal has flowed [-].
    mean_gap : ndarray
        Valleys included [m].
    k_across, k_along : ndarray
        12 eta times the conductivity across and along the crests, without the thread [m^3].
    k_across_error : ndarray
        Standard error of the mean over the seeds [m^3]; nan of one seed.
    seeds : tuple of int
    points : int
        Along a side of the square.
    shortest_wave : float
        Of the fine roughness on the grid [m].
    """

    pressure: FloatArray
    contact_area: FloatArray
    yielded_area: FloatArray
    mean_gap: FloatArray
    k_across: FloatArray
    k_along: FloatArray
    k_across_error: FloatArray
    seeds: tuple[int, ...]
    points: int
    shortest_wave: float


def texture_points(texture: Texture, crests: int = 2) -> int:
    """Grid points along a side: four on the shortest wave of the fine roughness, from 128 to 512.

    It is a multiple of `crests`, so that all crests lie alike on the grid, and one that Fourier transforms are fast
    for. Where 512 points do not hold the shortest waves, `simulate_texture` cuts them.

    Parameters
    ----------
    texture : TurnedTexture or GroundTexture
    crests : int
        In the square.

    Examples
    --------
    >>> import leak
    >>> fine = leak.PowerSpectrum.self_affine(rms_height=1e-7, hurst=0.8, q_low=3e4, q_rolloff=2.5e5, q_high=2e6)
    >>> leak.direct.texture_points(leak.TurnedTexture(feed=1e-4, nose_radius=8e-4, fine=fine))
    256
    """
    from scipy.fft import next_fast_len

    _check_crests(crests)
    # fewer do not show a throat; more take over 90 s of one core for twelve pressures and two seeds
    least, most = 128, 512
    wanted = _POINTS_PER_WAVE * crests * texture.period * texture.fine.q_high / (2.0 * math.pi)
    # but for rounding
    side = math.ceil(min(max(wanted, least), most) / crests - 1e-6)
    return crests * min(next_fast_len(side, real=True), max(most // crests, 1))


def _check_crests(crests: int) -> None:
    if crests != int(crests) or crests < 1:
        raise DirectError(f"crests = {crests!r}: must be a whole number from 1 on")


def simulate_texture(
    texture: Texture,
    *,
    effective_modulus: float,
    pressures: ArrayLike,
    hardness: float | None = None,
    yield_stress: float | None = None,
    poissons_ratio: float = 0.3,
    crests: int = 2,
    points: int | None = None,
    seeds: Sequence[int] = (1, 2),
    finished: MutableMapping[tuple[int, float], PressedPatch] | None = None,
    progress: Callable[[str], None] = lambda text: None,
) -> TextureResult:
    """Press square pieces of a turned face on a rigid flat and let a liquid flow through what stays open.

    The pieces are periodic, and so is the flow. Seeds lie side by side along the crests of a face: their conductivities
    add. Waves of the fine roughness longer than the side, or shorter than four grid cells, are not in it.

    Parameters
    ----------
    texture : TurnedTexture or GroundTexture
        Both faces together.
    effective_modulus : float
        E* of both bodies together [Pa].
    pressures : array_like, shape (P,)
        Nominal, of first loading [Pa].
    hardness : float, optional
        Largest pressure that the softer body bears [Pa]; elastic without it and without a yield stress.
    yield_stress : float, optional
        Of metal that flows by von Mises' criterion [Pa], in place of a hardness; minutes for each seed.
    poissons_ratio : float
        Of metal that flows [-].
    crests : int
        Feeds along a side of the square; of two turned faces so many times what repeats.
    points : int, optional
        Along a side, a multiple of `crests`; see `texture_points`.
    seeds : sequence of int
        Of the fine roughness.
    finished : mutable mapping, optional
        Takes each state as it is done, by its seed and pressure, and those that are in it are not calculated again:
        what an interrupted run has done, for the same texture and options.
    progress : callable
        Told how far it is.

    Returns
    -------
    TextureResult

    Raises
    ------
    DirectError
        A value outside its meaning, or the contact does not converge.

    Examples
    --------
    >>> import leak
    >>> fine = leak.PowerSpectrum.self_affine(rms_height=1e-7, hurst=0.8, q_low=3e4, q_rolloff=2.5e5, q_high=1e6)
    >>> face = leak.TurnedTexture(feed=1e-4, nose_radius=8e-4, fine=fine)
    >>> found = leak.direct.simulate_texture(face, effective_modulus=115e9, hardness=3.5e9, pressures=[1e7, 5e7])
    >>> bool(found.k_across[1] < found.k_across[0] < found.k_along[0])
    True
    """
    E = positive(DirectError, "effective_modulus", effective_modulus, "Pa")
    path = np.unique(checked_pressures("pressures", pressures))
    if hardness is not None and yield_stress is not None:
        raise DirectError(
            "hardness and yield_stress: give one, the cap of the pressure or the stress of metal that flows"
        )
    if not seeds:
        raise DirectError("seeds: at least one is needed")
    patch = TexturePatch(texture, texture_points(texture, crests) if points is None else points, crests)
    body = PeriodicHalfSpace(patch.points, patch.size, E)

    def states(seed: int, wanted: Sequence[float]) -> Iterator[PressedPatch]:
        heights = patch.heights(seed)
        if yield_stress is None:
            for p in wanted:
                yield PressedPatch.of(
                    press(body, heights, p, hardness=hardness), hardness=hardness, periodic=True
                )
            return
        for state in elastoplastic_path(
            body,
            heights,
            path.tolist(),
            yield_stress=yield_stress,
            # 0.025 of a hardness of 2.9 yield stresses: conductivities are 3 to 9 % low, see `press_elastoplastic`
            longest_step=0.025 * HARDNESS_OVER_YIELD_STRESS * yield_stress,
            poissons_ratio=poissons_ratio,
        ):
            yield PressedPatch.of(state.contact, periodic=True)._replace(yielded_area=state.yielded_area)

    done = {} if finished is None else finished
    total = len(seeds) * path.size
    for seed in seeds:
        wanted = [p for p in path.tolist() if (seed, p) not in done]
        # metal that flows remembers its path, which begins anew
        along = wanted if yield_stress is None or not wanted else path.tolist()
        for p, state in zip(along, states(seed, wanted) if wanted else (), strict=True):
            done[seed, p] = state
            count = sum((s, q) in done for s in seeds for q in path.tolist())
            progress(f"direct simulation of the texture: {count} of {total} states")
    fields = np.array([[done[seed, p] for p in path.tolist()] for seed in seeds])
    area, yielded, gap, across, along_crests = np.moveaxis(fields.mean(axis=0), -1, 0)
    several = len(seeds) > 1
    error = (
        fields[:, :, 3].std(axis=0, ddof=1) / math.sqrt(len(seeds))
        if several
        else np.full(path.size, math.nan)
    )
    return TextureResult(
        path,
        area,
        yielded,
        gap,
        across,
        along_crests,
        error,
        tuple(seeds),
        patch.points,
        patch.shortest_wavelength,
    )
