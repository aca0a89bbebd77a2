"""A turned face pressed against a flat one: crests in series, each a line of throats, the thread in parallel."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import FloatArray
from leak.errors import ConductivityError, SurfaceError, positive
from leak.flow.conductivity import ConductivityTable
from leak.flow.rough_contact import RoughContact
from leak.surfaces.random import random_map
from leak.surfaces.spectrum import PowerSpectrum
from leak.surfaces.turned import TurnedTexture
from leak.theory.crest_line import CrestLines, PressedCrests
from leak.theory.interface_law import TabulatedLaw

# Places along a piece of crest, pieces, and points in the shortest wave of the fine roughness.
_PLACES, _PIECES, _POINTS_PER_WAVE = 1024, 8, 4
_SEED = 1
# A crest is known so many rms heights down its sides.
_DEPTH = 12.0
# ... and so many points at least.
_LEAST_POINTS = 16
# Rms heights of the tops between two levels of the flat, and where it begins above their mean.
_STEP, _FIRST = 0.5, 3.0
_MOST_LEVELS = 40
# Growth of the steps once nothing flows.
_GROWTH = 1.5
# Points of the law beyond the rough crests.
_SMOOTH = 20
# A face whose conductivity has fallen to this share of the first one is sealed.
_SEALED = 1e-9
# Mean gap over the height of the crests at which they are pressed flat.
_CLOSED = 0.02
# Rms height of the fine roughness over the height of the crests at which these begin to be lost in it, and are lost.
_LOST = (0.13, 0.39)


class _State(NamedTuple):
    """A level of the flat: nominal pressure [Pa], mean gap [m], 12 eta times the conductivity across [m^3]."""

    pressure: float
    mean_gap: float
    gap_cubed: float
    level: float


@dataclass(frozen=True)
class TurnedContact:
    """Contact between a turned face and a flat, elastic or with crests that yield.

    All load is carried by the crests; between them the gap is open and resists nothing. With g(y) the least gap at a
    place along a crest, a throat between sides of slope m conducts m g^2/(12 eta) of a length of crest, since the
    integral of dx/(g + m abs(x))^3 is 1/(m g^2); crests a feed f apart in series conduct f m <g^2>/(12 eta).

    Parameters
    ----------
    feed : float
        Distance of the crests [m].
    nose_radius : float
        Of the tool [m].
    fine : PowerSpectrum
        Roughness on the crests, with that of the other face.
    effective_modulus : float
        E* [Pa].
    hardness : float, optional
        Of the softer face [Pa]; None for elastic crests.

    Raises
    ------
    SurfaceError
        A value outside its meaning.

    Examples
    --------
    >>> import leak
    >>> fine = leak.PowerSpectrum.self_affine(rms_height=1e-7, hurst=0.8, q_low=3e4, q_rolloff=2.5e5, q_high=4e6)
    >>> face = leak.TurnedContact(feed=1e-4, nose_radius=8e-4, fine=fine, effective_modulus=115e9, hardness=3.5e9)
    >>> bool(face.flow_conductivity(25e6, 1e-3) < 0.5 * face.flow_conductivity(10e6, 1e-3))
    True
    """

    feed: float = field(kw_only=True)
    nose_radius: float = field(kw_only=True)
    fine: PowerSpectrum = field(kw_only=True)
    effective_modulus: float = field(kw_only=True)
    hardness: float | None = field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        TurnedTexture(self.feed, self.nose_radius, self.fine)
        positive(SurfaceError, "effective_modulus", self.effective_modulus, "Pa")
        if self.hardness is not None:
            positive(SurfaceError, "hardness", self.hardness, "Pa")

    @property
    def texture(self) -> TurnedTexture:
        """The face without load."""
        return TurnedTexture(self.feed, self.nose_radius, self.fine)

    @property
    def contact_pressure(self) -> float:
        """Mean pressure where a crest touches: of elastic sides E* m'/2, limited by the hardness [Pa].

        m' is the rms slope across the crest: that of the cusp with the part of the fine roughness in this direction.

        References
        ----------
        K. L. Johnson, Contact mechanics (1985), sec. 5.2, of an elastic wedge. Its pressure and the hardness are joined
        by the square of their inverses, as elastic edges remain around what has yielded.
        """
        slope = math.hypot(self.texture.side_slope, self.fine.rms_slope / math.sqrt(2.0))
        elastic = 0.5 * self.effective_modulus * slope
        return elastic if self.hardness is None else 1.0 / math.hypot(1.0 / elastic, 1.0 / self.hardness)

    @cached_property
    def lines(self) -> CrestLines:
        """Pieces of its crests, from one random map of the fine roughness."""
        texture, fine = self.texture, self.fine
        spacing = 2.0 * math.pi / fine.q_high / _POINTS_PER_WAVE
        reach = min(0.5 * self.feed, _LEAST_POINTS * spacing + _DEPTH * fine.rms_height / texture.side_slope)
        across = np.arange(-int(reach / spacing), int(reach / spacing) + 1)
        heights = random_map(fine, size=_PLACES * spacing, points=_PLACES, seed=_SEED)
        middles = np.arange(_PIECES) * (_PLACES // _PIECES)
        cusp = texture.depth_at(np.abs(across) * spacing)
        pieces = np.stack([heights[:, (middle + across) % _PLACES] - cusp for middle in middles])
        return CrestLines(pieces, spacing, self.feed, self.effective_modulus, self.contact_pressure)

    @cached_property
    def _path(self) -> tuple[_State, ...]:
        """First loading, level by level, until the crests are flat or no more is known of them."""
        lines = self.lines
        level, step = (
            float(lines.tops.mean()) + _FIRST * float(lines.tops.std()),
            _STEP * float(lines.tops.std()),
        )
        states: list[_State] = []
        width: FloatArray | None = None
        for _ in range(_MOST_LEVELS):
            try:
                pressed = lines.press(level, width)
            except SurfaceError:
                break
            width, state = pressed.width, self._state(pressed)
            if state.mean_gap < _CLOSED * self.texture.crest_height:
                break
            if state.pressure > 0.0:
                states.append(state)
                if state.gap_cubed <= _SEALED * states[0].gap_cubed:
                    # the gap alone goes on, and is smooth
                    step *= _GROWTH
            level -= step
        return tuple(states)

    def _state(self, pressed: PressedCrests) -> _State:
        m, r_t = self.texture.side_slope, self.texture.crest_height
        return _State(
            pressed.pressure,
            pressed.level + 2.0 / 3.0 * r_t + pressed.overlap,
            self.feed * m * float(np.mean(pressed.gap**2)),
            pressed.level,
        )

    def contact_area(self, pressure: ArrayLike) -> FloatArray | float:
        """Share of the nominal area that touches [-].

        Parameters
        ----------
        pressure : array_like
            Nominal [Pa].
        """
        area = np.minimum(_checked(pressure) / self.contact_pressure, 1.0)
        return float(area) if area.ndim == 0 else area

    @cached_property
    def _law(self) -> TabulatedLaw:
        return self.interface_law()

    def interface_law(self) -> TabulatedLaw:
        """Nominal pressure over the mean gap, valleys included.

        Beyond what is known of the crests they close as smooth cusps do that are as wide as the load asks for.
        """
        states, texture = self._path, self.texture
        share = np.linspace(states[-1].pressure / self.contact_pressure, 0.98, _SMOOTH + 1)
        half = 0.5 * self.feed * share
        below = 0.5 * texture.side_slope * half**2 - half**3 / (6.0 * self.nose_radius)
        rest = (
            texture.crest_height * self.feed / 3.0 - below - texture.depth_at(half) * (0.5 * self.feed - half)
        )
        gap, pressure = (
            [getattr(state, name) for state in states[::-1]] for name in ("mean_gap", "pressure")
        )
        return TabulatedLaw(
            np.concatenate([gap[0] * rest[:0:-1] / rest[0], gap]),
            np.concatenate([self.contact_pressure * share[:0:-1], pressure]),
        )

    def mean_separation(self, pressure: ArrayLike) -> FloatArray | float:
        """Mean gap over the nominal area, valleys included [m]; infinite without pressure.

        Parameters
        ----------
        pressure : array_like
            Nominal [Pa].
        """
        with np.errstate(divide="ignore"):
            gap = np.where(
                _checked(pressure) > 0.0,
                self._law.gap(np.log(np.maximum(_checked(pressure), 1e-300))),
                np.inf,
            )
        return float(gap) if gap.ndim == 0 else gap

    def conductivity_table(self, p_min: float, p_max: float) -> ConductivityTable:
        """Table of u_eff = (12 eta sigma)^(1/3) across the crests, without the thread.

        Parameters
        ----------
        p_min, p_max : float
            Range of nominal pressures [Pa].
        """
        low, high = (
            positive(ConductivityError, "p_min", p_min, "Pa"),
            positive(ConductivityError, "p_max", p_max, "Pa"),
        )
        if not low < high:
            raise ConductivityError(f"p_min = {p_min} and p_max = {p_max}: p_min must be below p_max [Pa]")
        flowing = [state for state in self._path if state.gap_cubed > _SEALED * self._path[0].gap_cubed]
        pressure, gap_cubed = (
            np.array([getattr(state, name) for state in flowing]) for name in ("pressure", "gap_cubed")
        )
        sealing = self.sealing_pressure
        return ConductivityTable(pressure, np.cbrt(gap_cubed), sealing, max(high, sealing))

    @property
    def sealing_pressure(self) -> float:
        """From here on nothing flows across the crests; of crests whose last places are not known, beyond them [Pa]."""
        states = self._path
        sealed = (state.pressure for state in states if state.gap_cubed <= _SEALED * states[0].gap_cubed)
        return next(sealed, 1.1 * states[-1].pressure)

    def flow_conductivity(self, pressure: ArrayLike, viscosity: float) -> FloatArray | float:
        """Across the crests, without the thread [m^3/(Pa s)].

        Where the fine roughness is as high as the crests the face is that roughness, by the corrected theory of
        `RoughContact`; between both the logarithm of the conductivity crosses over that of their ratio.

        Parameters
        ----------
        pressure : array_like
            Nominal, positive [Pa].
        viscosity : float
            [Pa s]
        """
        p, eta = _checked(pressure), positive(ConductivityError, "viscosity", viscosity, "Pa s")
        start, end = np.log(_LOST)
        share = (math.log(self.fine.rms_height / self.texture.crest_height) - start) / (end - start)
        share = min(max(share, 0.0), 1.0)
        sigma = np.ones(p.shape)
        if share < 1.0:
            table = self.conductivity_table(self._path[0].pressure, self.sealing_pressure)
            sigma = sigma * np.asarray(table.conductivity(p, eta)) ** (1.0 - share)
        if share > 0.0:
            fine = RoughContact(
                self.fine,
                effective_modulus=self.effective_modulus,
                hardness=self.hardness,
                theory="corrected",
            )
            sigma = sigma * np.asarray(fine.flow_conductivity(p, eta)) ** share
        return float(sigma) if sigma.ndim == 0 else sigma

    def spiral_conductivity(self, pressure: ArrayLike, viscosity: float, radius: float) -> FloatArray | float:
        """Of the thread from the outside to the inside, to be added to that across the crests [m^3/(Pa s)].

        Each turn leads the fluid around by 2 pi r_0 while it comes nearer by f.

        Parameters
        ----------
        pressure : array_like
            Nominal, positive [Pa].
        viscosity : float
            [Pa s]
        radius : float
            r_0 of the contact [m].
        """
        eta = positive(ConductivityError, "viscosity", viscosity, "Pa s")
        r_0 = positive(ConductivityError, "radius", radius, "m")
        texture = self.texture
        depth = texture.depth_at(np.linspace(0.0, 0.5 * self.feed, 513)[1::2])
        # the flat stands as high above the valleys as the mean gap says
        level = np.asarray(self.mean_separation(pressure)) - 2.0 / 3.0 * texture.crest_height
        along = np.mean(np.maximum(level[..., None] + depth, 0.0) ** 3, axis=-1)
        sigma = along * (self.feed / (2.0 * math.pi * r_0)) ** 2 / (12.0 * eta)
        return float(sigma) if sigma.ndim == 0 else sigma


def _checked(pressure: ArrayLike) -> FloatArray:
    p = np.asarray(pressure, dtype=float)
    if not np.all(np.isfinite(p) & (p >= 0.0)):
        raise SurfaceError(f"pressure = {pressure!r}: must be finite and not negative [Pa]")
    return p
