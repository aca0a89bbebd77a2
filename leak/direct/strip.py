"""A piece of a seal simulated: a strip of the line contact with its roughness, and the flow across it.

x runs across the contact, in the direction of the flow, y along it. The strip is periodic in y and, far outside of the
contact, in x; what the bodies do besides a half-space of that period stands in the macroscopic gap.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from leak.arrays import FloatArray
from leak.direct.contact import ContactState, PeriodicHalfSpace, press
from leak.direct.elastoplastic import ElastoplasticState, press_elastoplastic
from leak.direct.flow import patch_flow, rarefied_gap
from leak.errors import DirectError, positive, um
from leak.surfaces.random import random_map
from leak.surfaces.spectrum import PowerSpectrum


class StripState(NamedTuple):
    """A pressed strip.

    Examples
    --------
    >>> import numpy as np
    >>> from leak.direct import Strip
    >>> x = np.linspace(-3e-4, 3e-4, 64, endpoint=False)
    >>> strip = Strip(None, (64, 8), 6e-4, x**2 / 0.04)
    >>> state = strip.press(5e3, effective_modulus=115e9, asperities="elastic")
    >>> bool(0.9 < state.pressure.max() / (115e9 * 5e3 / (np.pi * 0.02)) ** 0.5 < 1.1)
    True
    """

    gap: FloatArray
    """Shape (n, m) [m]; zero in contact."""
    pressure: FloatArray
    """Shape (n, m) [Pa]."""
    has_yielded: np.ndarray
    """Points at the hardness or above metal that has flowed, shape (n, m)."""
    conductance: float
    """12 eta times the leak rate per length of the strip and pressure difference [m^2]."""

    @property
    def profile(self) -> FloatArray:
        """Pressure over x, mean along the strip, shape (n,) [Pa]."""
        return np.asarray(self.pressure.mean(axis=1))


@dataclass(frozen=True, eq=False)
class Strip:
    """A rectangle of a line contact.

    Parameters
    ----------
    spectrum : PowerSpectrum or None
        Of the roughness; the strip holds its waves down to `points_per_wave` grid points. None: smooth.
    points : tuple of int
        Grid points across the contact and along it; they are as far apart in both directions.
    width : float
        Of the strip, across the contact [m].
    macroscopic_gap : ndarray, shape (points[0],)
        Gap without roughness and without load [m]; only differences count. The bodies are half-spaces here: where they
        are not, their displacement beyond that of a half-space stands in this gap, see `rest_gap`.
    points_per_wave : float
        Grid points on the shortest wave, at least 2.
    peklenik : float
        Stretch of the roughness along x, see `leak.random_map`.

    Raises
    ------
    DirectError
        If a value makes no sense, or the strip holds no wave of the spectrum.

    Examples
    --------
    >>> import numpy as np, leak
    >>> from leak.direct import Strip
    >>> spectrum = leak.PowerSpectrum.self_affine(rms_height=1e-7, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=1e6)
    >>> x = np.linspace(-3e-4, 3e-4, 64, endpoint=False)
    >>> strip = Strip(spectrum, (64, 32), 6e-4, x**2 / 0.04)
    >>> rough = strip.press(5e3, effective_modulus=115e9, seed=1, asperities="elastic")
    >>> bool(rough.conductance > 0.0)
    True
    """

    spectrum: PowerSpectrum | None
    points: tuple[int, int]
    width: float
    macroscopic_gap: FloatArray
    points_per_wave: float = 4.0
    peklenik: float = 1.0

    def __post_init__(self) -> None:
        positive(DirectError, "width", self.width, "m")
        if np.shape(self.macroscopic_gap) != self.points[:1]:
            raise DirectError(
                f"macroscopic_gap has shape {np.shape(self.macroscopic_gap)}: must be {self.points[:1]}"
            )
        if not self.points_per_wave >= 2.0:
            raise DirectError(f"points_per_wave = {self.points_per_wave!r}: must be at least 2")
        if self.spectrum is not None and not self.spectrum.q_low < self.q_high:
            raise DirectError(
                f"the shortest wave of the strip is {um(2.0 * math.pi / self.q_high)}, longer than all waves of the "
                "spectrum: take more points or a narrower strip"
            )

    @property
    def length(self) -> float:
        """Along the contact [m]."""
        return self.width * self.points[1] / self.points[0]

    @property
    def q_high(self) -> float:
        """Wavenumber of the shortest wave on the grid, or of the spectrum if that is longer [1/m]."""
        grid = 2.0 * math.pi * self.points[0] / (self.points_per_wave * self.width) * (1.0 + 1e-9)
        return grid if self.spectrum is None else min(grid, self.spectrum.q_high)

    @property
    def grid_spectrum(self) -> PowerSpectrum | None:
        """The spectrum with the waves that the grid can hold; those longer than the strip are not cut here."""
        spectrum = self.spectrum
        if spectrum is None or spectrum.q_high <= self.q_high:
            return spectrum
        return spectrum.between(0.0, self.q_high)

    def heights(self, seed: int) -> FloatArray:
        """Roughness of a sample, as of a piece cut out of an endless surface, shape (n, m) [m]."""
        if self.grid_spectrum is None:
            return np.zeros(self.points)
        return random_map(
            self.grid_spectrum, size=self.width, points=self.points, seed=seed, peklenik=self.peklenik
        )

    def press(
        self,
        line_load: float,
        *,
        effective_modulus: float,
        seed: int = 0,
        asperities: Literal["elastic", "capped", "von-mises"] = "elastic",
        hardness: float | None = None,
        yield_stress: float | None = None,
        poissons_ratio: float = 0.3,
        load_steps: int = 1,
        flight: float | None = None,
    ) -> StripState:
        """Press a sample of the strip and let a fluid flow across it.

        Parameters
        ----------
        line_load : float
            Contact force per length [N/m].
        effective_modulus : float
            E* of both bodies [Pa].
        seed : int
            Of the roughness.
        asperities : {"elastic", "capped", "von-mises"}
            What yields.
        hardness : float, optional
            Largest pressure [Pa], of "capped".
        yield_stress, poissons_ratio : float
            Of "von-mises" [Pa], [-].
        load_steps : int
            Of "von-mises", equal ones up to the load.
        flight : float, optional
            Of a gas, see `rarefied_gap` [m]; a liquid unless given.

        Raises
        ------
        DirectError
            The line load cannot be carried, or the contact does not converge.
        """
        body = PeriodicHalfSpace(self.points, self.width, effective_modulus)
        rough = self.heights(seed)
        mean = positive(DirectError, "line_load", line_load, "N/m") / self.width
        shape = np.asarray(self.macroscopic_gap, dtype=float)
        h = rough - (shape - shape.min())[:, None]
        # the solver takes its error as a share of all heights, of which the roughness is the part that counts
        scale = float(np.std(rough)) or float(np.std(h)) * 1e-2
        tolerance = 1e-3 * scale / float(np.std(h))
        if asperities == "von-mises":
            if yield_stress is None:
                raise DirectError("yield_stress: is needed for metal that flows")
            state: ElastoplasticState | None = None
            for load in mean * np.arange(1, load_steps + 1) / load_steps:
                (state,) = press_elastoplastic(
                    body, h, [load], yield_stress=yield_stress, poissons_ratio=poissons_ratio, start=state
                )
            assert state is not None
            return self._state(state.contact, state.has_yielded, flight)
        cap = hardness if asperities == "capped" else None
        contact = press(body, h, mean, hardness=cap, tolerance=tolerance)
        return self._state(contact, contact.pressure >= (cap or math.inf), flight)

    def _state(self, contact: ContactState, yields: np.ndarray, flight: float | None) -> StripState:
        gap = contact.gap if flight is None else rarefied_gap(contact.gap, flight)
        conductance = patch_flow(gap).gap_cubed / self.width
        return StripState(contact.gap, contact.pressure, yields, conductance)


def rest_gap(gap: FloatArray, pressure: FloatArray, width: float, effective_modulus: float) -> FloatArray:
    """Gap without load of a strip whose mean planes are `gap` apart under a pressure, on half-spaces of its period.

    A strip with this gap and no roughness, under this pressure, has the gaps that are given: what bodies of another
    shape than half-spaces do stands in it, at this pressure.

    Parameters
    ----------
    gap, pressure : ndarray, shape (n,)
        On a grid across the strip [m], [Pa].
    width : float
        Of the strip [m].
    effective_modulus : float
        E* [Pa].

    Returns
    -------
    ndarray, shape (n,)
        [m]; its least value is zero.

    Examples
    --------
    >>> import numpy as np
    >>> from leak.direct import rest_gap
    >>> float(np.ptp(rest_gap(np.ones(8), np.ones(8), 1e-3, 1e11)))
    0.0
    """
    body = PeriodicHalfSpace((len(gap), 1), width, effective_modulus)
    free_gap = np.asarray(gap) - body.displacement(np.asarray(pressure, dtype=float)[:, None])[:, 0]
    return np.asarray(free_gap - free_gap.min())
