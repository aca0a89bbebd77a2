"""Crests that an earlier load has coined: flats that come back elastically as the load falls, and lift place by place.

Metal that has yielded does not come back; the elastic sinking under the load does. At its largest load each place of a
crest has become a flat, as wide as its contact was and as high as it then springs back. Pressed less, these flats are
an elastic contact of known width: a place carries what holds it down, or it has lifted and lets fluid through.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from leak.arrays import FloatArray
from leak.errors import SurfaceError
from leak.theory.crest_line import CrestLines, conjugate_gradients, sinking_along

# Rms distance to the flat of the places that carry, over `CoinedCrests.way`, and most steps to their loads.
_TOLERANCE, _MOST_STEPS = 3e-4, 60
# Levels of the flat over this way.
_LEVELS = (0.02, 0.05, 0.1, 0.2, 0.3, 0.42, 0.55, 0.7, 0.85, 0.95, 0.998)
_TINY = float(np.finfo(float).tiny)


@dataclass(frozen=True, eq=False)
class CoinedCrests:
    """Pieces of rough crests with the flats of their largest load.

    Parameters
    ----------
    lines : CrestLines
        Before any load.
    level : float
        Of the flat at the largest load [m].
    width : ndarray, shape (crests, places)
        Of the contact then, zero where it did not touch [m].
    yielded : float
        Share of what was pressed in that has yielded, from elastic crests, which come back as they were, to flats [-].
    """

    lines: CrestLines
    level: float
    width: FloatArray
    yielded: float

    @cached_property
    def _give(self) -> FloatArray:
        return self.lines.give_under(self.width)

    @cached_property
    def _flats(self) -> FloatArray:
        """Height at which each place was held by the largest load, shape (crests, places) [m]."""
        flats = self.level + sinking_along(self._give, self.width)
        return np.where(self.width > 0.0, flats, self.lines.tops)

    @cached_property
    def tops(self) -> FloatArray:
        """Highest point of each place without load, shape (crests, places) [m]."""
        return self.yielded * self._flats + (1.0 - self.yielded) * np.maximum(self.lines.tops, self._flats)

    @property
    def flat(self) -> FloatArray:
        """Width of the flat of each place, shape (crests, places) [m]."""
        return self.yielded * self.width

    @property
    def way(self) -> float:
        """From the level of the largest load to where the last place lifts [m]."""
        return float(self.tops[self.width > 0.0].max()) - self.level

    def press(self, level: float, start: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Elastic contact of the flats under less than the largest load.

        Parameters
        ----------
        level : float
            Of the flat above the mean line of the smooth crests [m].
        start : ndarray
            Loads near those of this level [m].

        Returns
        -------
        tuple of ndarray
            Load of each place as the width that the contact pressure would need for it, and gap between the flat and
            its top, zero where it carries, both of shape (crests, places) [m].

        Raises
        ------
        SurfaceError
            No solution was found.
        """
        load, allowed = start, (_TOLERANCE * self.way) ** 2
        # what has not yielded comes back in proportion
        fall = (self.tops - self._flats) / np.maximum(self.width, _TINY)
        for _ in range(_MOST_STEPS):
            apart = level + sinking_along(self._give, load) + fall * load - self.tops
            carries = (self.width > 0.0) & np.where(apart < 0.0, load < self.width, load > 0.0)
            if (apart[carries] ** 2).sum() <= allowed * carries.sum():
                return load, np.where(load > 0.0, 0.0, np.maximum(apart, 0.0))
            change = conjugate_gradients(self._give, fall, carries, -apart)
            load = np.clip(load + change, 0.0, self.width)
        raise SurfaceError(f"level = {level:g} m: the load of coined crests does not converge")

    def lift(self) -> list[tuple[float, FloatArray]]:
        """Nominal pressure [Pa] and gap of each place [m], from the largest load to where the last place lifts."""
        load, states = self.width, []
        for share in (0.0, *_LEVELS):
            load, gap = self.press(self.level + share * self.way, load)
            states.append((self.lines.contact_pressure * float(load.mean()) / self.lines.feed, gap))
        return states
