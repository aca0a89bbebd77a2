"""How far a fluid gets between the surfaces of a contact: by flowing through it, or up to where it is held."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from fem_seal.arrays import FloatArray
from fem_seal.contact.model import ContactLine
from fem_seal.errors import OpenSealError
from fem_seal.loads import PressureSide
from fem_seal.profile import PressureProfile


class FluidPath(Protocol):
    """Fluid pressure between the surfaces, as a function of a few unknowns that follow from the solid contact."""

    @property
    def side(self) -> PressureSide:
        """Side of the high pressure."""

    def bounds(self, line: ContactLine) -> tuple[float, float]:
        """Between which all unknowns lie."""

    def share(self, line: ContactLine, unknowns: FloatArray) -> FloatArray:
        """Fluid pressure over the pressure difference at the points of the line, shape (m,)."""

    def found(self, profile: PressureProfile, fluid_pressure: float) -> FloatArray:
        """The unknowns that belong to a profile of the solid contact pressure."""


def _itself(profile: PressureProfile) -> PressureProfile:
    return profile


@dataclass(frozen=True)
class FlowThrough:
    """A fluid that flows through the rough contact; its pressure falls along the flow resistance.

    Parameters
    ----------
    pressure_along : callable
        Takes a `PressureProfile` and the pressure difference [Pa] to the fluid pressure at its points [Pa].
    sealing_pressure : float
        Contact pressure from which on nothing flows [Pa].
    side : {"outer", "inner"}
    as_first_loaded : callable
        Takes a profile to that of first loading which lets as much through; itself where the contact remembers no
        larger load.

    Notes
    -----
    Where the contact is sealed nothing flows, and what the fluid does between the two ends of the sealed stretch is
    not known: its pressure is taken to fall evenly there. That is also where it falls just before the contact seals.

    Examples
    --------
    >>> import numpy as np, fem_seal
    >>> evenly = lambda profile, drop: drop * np.linspace(0.0, 1.0, len(profile.x))
    >>> fem_seal.FlowThrough(evenly, sealing_pressure=1e9).side
    'outer'
    """

    pressure_along: Callable[[PressureProfile, float], FloatArray]
    sealing_pressure: float
    side: PressureSide = "outer"
    as_first_loaded: Callable[[PressureProfile], PressureProfile] = _itself

    def bounds(self, line: ContactLine) -> tuple[float, float]:
        """Shares of the pressure difference."""
        return 0.0, 1.0

    def share(self, line: ContactLine, unknowns: FloatArray) -> FloatArray:
        """The unknowns are the shares themselves."""
        return unknowns

    def found(self, profile: PressureProfile, fluid_pressure: float) -> FloatArray:
        """Fluid pressure over the pressure difference."""
        profile = self.as_first_loaded(profile)
        if profile.pressure.max() < self.sealing_pressure:
            return self.pressure_along(profile, fluid_pressure) / fluid_pressure
        inner, outer = _stretch_above(profile, self.sealing_pressure)
        # Sealed at one point alone the fall would be a step, which no point of the line feels.
        width = max(outer - inner, 1e-3 * float(np.min(np.diff(profile.x))))
        rising = np.clip((profile.x - inner) / width, 0.0, 1.0)
        return rising if self.side == "outer" else 1.0 - rising


@dataclass(frozen=True)
class HeldFluid:
    """A fluid of which no flow is known: it gets in as far as the contact pressure is below its own.

    Full pressure from its side up to the first place where the solid contact presses harder than the fluid, nothing
    beyond. The unknown is this place.

    Parameters
    ----------
    side : {"outer", "inner"}

    Examples
    --------
    >>> import fem_seal
    >>> fem_seal.HeldFluid("inner").side
    'inner'
    """

    side: PressureSide = "outer"

    def bounds(self, line: ContactLine) -> tuple[float, float]:
        """Ends of the contact line [m]."""
        return float(line.vertices[0]), float(line.vertices[-1])

    def share(self, line: ContactLine, unknowns: FloatArray) -> FloatArray:
        """One up to the place, zero beyond; in between it falls within one element, so that it follows the place."""
        front = float(unknowns[0])
        element = int(np.clip(np.searchsorted(line.vertices, front) - 1, 0, len(line.vertices) - 2))
        width = line.vertices[element + 1] - line.vertices[element]
        rising = np.clip(0.5 + (line.x - front) / width, 0.0, 1.0)
        return rising if self.side == "outer" else 1.0 - rising

    def found(self, profile: PressureProfile, fluid_pressure: float) -> FloatArray:
        """Where the contact pressure first exceeds that of the fluid, seen from the side of the fluid [m].

        Raises
        ------
        OpenSealError
            If it does so nowhere.
        """
        if profile.pressure.max() <= fluid_pressure:
            raise OpenSealError(
                f"the contact pressure, at most {profile.pressure.max() / 1e6:.4g} MPa, is nowhere above the fluid "
                f"pressure of {fluid_pressure / 1e6:.4g} MPa: the fluid gets through"
            )
        return np.array([_stretch_above(profile, fluid_pressure)[1 if self.side == "outer" else 0]])


def _stretch_above(profile: PressureProfile, pressure: float) -> tuple[float, float]:
    """First and last place at which a profile is above a pressure [m]."""
    above = np.flatnonzero(profile.pressure >= pressure)
    return _crossing(profile, pressure, above[0], -1), _crossing(profile, pressure, above[-1], 1)


def _crossing(profile: PressureProfile, pressure: float, inside: int, step: int) -> float:
    outside = inside + step
    if not 0 <= outside < len(profile.x):
        return float(profile.x[inside])
    # Squares: a Hertzian edge falls like a square root, and near its top any profile like a parabola.
    high, low = profile.pressure[inside] ** 2, profile.pressure[outside] ** 2
    share = (high - pressure**2) / (high - low)
    return float(profile.x[inside] + share * (profile.x[outside] - profile.x[inside]))
