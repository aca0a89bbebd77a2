"""Crests of a turned face over metal whose bulk flows: they sink, since nothing elastic holds them from below.

With x = p/H, A the area touched and e the plastic strain of the bulk over the slope across the crests,
d(A^n) = K x (1 + s c^2) (1 - A^n) de. A line sinks by the logarithm of its width, for which n stands. c is the share of
the flow that widens the metal across the crests: there it flows already as a crest does that sinks, and nothing
resists.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from leak.arrays import FloatArray
from leak.theory.bulk_flow import HARDNESS_OVER_YIELD_STRESS


class CrestFlow(NamedTuple):
    """What direct simulation says of crests over a strained bulk; all without unit, by `benchmarks/turned_bulk.py`.

    Examples
    --------
    >>> area, x, strain = np.array([0.05]), np.array([0.05]), np.array([0.02])
    >>> wider, direction = CrestFlow().widened(area, x, (strain, 0.0 * strain), slope=0.1, hardness=0.005)
    >>> bool(wider[0] > 2.0), bool(direction[0] == 1.0)
    (True, True)
    """

    rate: float = 2.6
    """K."""
    line: float = 1.22
    """n."""
    across: float = 4.2
    """s."""
    delay: float = 0.5
    """Yield strains by which the flattening begins late."""
    closing: float = 1.3
    """Growth of the pressure that would close the gaps as far, over that of the area touched."""
    direction: float = 0.38
    """By how much less they close of strain along the flow, and more of strain along the crests."""
    valleys: float = 2.4
    """Growth of the pressure that would close the valleys as far, over that of the area touched."""

    def widened(
        self,
        area: FloatArray,
        share: FloatArray,
        strain: tuple[FloatArray, FloatArray],
        *,
        slope: float,
        hardness: float,
    ) -> tuple[FloatArray, FloatArray]:
        """Area touched over that over a bulk that is not strained, and 1 of strain along the flow to -1 along crests.

        Parameters
        ----------
        area, share : ndarray
            A/A0 at rest and p/H [-].
        strain : tuple of ndarray
            Along the flow and along the crests, elastic part included [-].
        slope : float
            m', rms across the crests [-].
        hardness : float
            H/E* [-].
        """
        along, hoop = strain
        square = np.asarray(along**2 + hoop**2 + along * hoop)
        # of Poisson's ratio 0.3
        late = self.delay * 2.0 * hardness / (HARDNESS_OVER_YIELD_STRESS * 3.0 * (1.0 - 0.3))
        plastic = np.hypot(2.0 / math.sqrt(3.0) * np.sqrt(square), late) - late
        wide, direction = (
            np.divide(part, square, out=np.zeros(square.shape), where=square > 0.0)
            for part in (np.maximum(along + 0.5 * hoop, 0.0) ** 2, along**2 - hoop**2)
        )
        flattening = self.rate * plastic / slope * (1.0 + self.across * wide) * share
        narrow = area**self.line
        grown = np.divide(
            (1.0 - narrow) * -np.expm1(-flattening), narrow, out=np.zeros(area.shape), where=narrow > 0.0
        )
        return (1.0 + grown) ** (1.0 / self.line), direction
