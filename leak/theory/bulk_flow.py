"""Asperities over metal whose bulk flows: they sink, since nothing elastic holds them from below.

The hardness of 2.9 yield stresses is that of a summit in elastic metal. Bulk that is strained in its plane yields at
any further pressure, and the more of the face touches, the slower the rest sinks: dA = K x/(1 + b x) (1 - A) de, with
x = p/H and e the plastic strain of the bulk over the rms slope. The gaps close further than by pressing to the same
area.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from leak.arrays import FloatArray


class BulkFlowConstants(NamedTuple):
    """What direct simulation says of faces over a strained bulk; all without unit.

    Fitted and judged by `benchmarks/bulk_flow.py`.

    Examples
    --------
    >>> BulkFlowConstants().delay < 1.0
    True
    """

    rate: float = 10.9
    """K, of strain that makes one direction as much wider as the other one narrower."""
    load: float = 0.8
    """b, by how much the growth of the area over the load falls with the load."""
    softness: float = 4.8
    """By how much slower the area grows, over H/(E* h'): part of it is elastic."""
    delay: float = 0.5
    """Share of the yield strain by which the flattening begins late."""
    wider: float = 0.6
    """By how much faster it goes where the area grows by all of the strain."""
    narrower: float = -0.12
    """... where it shrinks by all of it."""
    closing: float = 2.33
    """Growth of the pressure that would close the gaps as far, over that of the area touched."""
    crowded: float = 2.47
    """By how much that falls with the area touched."""
    direction: float = 0.13
    """By how much less the gaps close for flow along the strain, and more for flow across it."""
    spread: float = 0.5
    """Standard deviation of ln(direct/theory) of conductivities where all of the contact is from sinking."""


BULK_FLOW = BulkFlowConstants()
HARDNESS_OVER_YIELD_STRESS = 2.9
"""Of a summit that elastic metal holds."""
_POISSON = 0.3


class BulkStrain(NamedTuple):
    """Strain of the metal under a face, elastic part included.

    Parameters
    ----------
    meridional, hoop : float or ndarray
        Along the flow and across it, of one place or of many [-].
    yield_stress : float, optional
        Of the asperities, in place of a 2.9th of the hardness [Pa].

    Examples
    --------
    >>> BulkStrain(0.01, 0.0).yield_stress is None
    True
    """

    meridional: FloatArray | float
    hoop: FloatArray | float
    yield_stress: float | None = None


class BulkFlow(NamedTuple):
    """What a strained bulk does to the asperities of a face, at one place or at many.

    Parameters
    ----------
    strain : ndarray
        Plastic strain that flattens, over the rms slope of the face, see `of` [-].
    direction : ndarray
        1 where all of it is along the flow, -1 across it [-].
    hardness : float
        Of the asperities, 2.9 times their yield stress [Pa].
    constants : BulkFlowConstants

    Examples
    --------
    >>> flow = BulkFlow(0.1, 1.0, 3e9)
    >>> bool(flow.area(0.1, 3e8) > 0.1)
    True
    """

    strain: FloatArray | float
    direction: FloatArray | float
    hardness: float
    constants: BulkFlowConstants = BULK_FLOW

    @classmethod
    def of(
        cls,
        strain: BulkStrain,
        *,
        rms_slope: float,
        hardness: float,
        effective_modulus: float,
        constants: BulkFlowConstants = BULK_FLOW,
    ) -> BulkFlow:
        """Of strains, zero at places that have none.

        Parameters
        ----------
        strain : BulkStrain
        rms_slope : float
            h' of the face [-].
        hardness : float
            Of the asperities [Pa].
        effective_modulus : float
            E* of a solid on a rigid one, whose Poisson's ratio is 0.3 [Pa].
        constants : BulkFlowConstants
        """
        meridional, hoop, yield_stress = strain
        c, meridional, hoop = constants, np.asarray(meridional), np.asarray(hoop)
        square = meridional**2 + hoop**2 + meridional * hoop
        stress = hardness / HARDNESS_OVER_YIELD_STRESS if yield_stress is None else yield_stress
        # of metal that keeps its volume, and the same where it begins to yield
        equivalent = 2.0 / math.sqrt(3.0) * np.sqrt(square)
        late = c.delay * 2.0 * (1.0 + _POISSON) / 3.0 * stress / ((1.0 - _POISSON**2) * effective_modulus)
        some = square > 0.0
        wider = np.divide(meridional + hoop, equivalent, out=np.zeros(some.shape), where=some)
        plastic = np.hypot(equivalent, late) - late
        rate = 1.0 + c.wider * np.maximum(wider, 0.0) + c.narrower * np.maximum(-wider, 0.0)
        direction = np.divide(meridional**2 - hoop**2, square, out=np.zeros(some.shape), where=some)
        softer = 1.0 + c.softness * HARDNESS_OVER_YIELD_STRESS * stress / (effective_modulus * rms_slope)
        flattening = plastic * rate / softer / rms_slope
        return cls(flattening, direction, HARDNESS_OVER_YIELD_STRESS * stress, c)

    def area(self, area: FloatArray, pressure: FloatArray) -> FloatArray:
        """A/A0 from that over a bulk that is not strained [-].

        Parameters
        ----------
        area : ndarray
            A/A0 [-].
        pressure : ndarray
            Nominal, of the same shape [Pa].
        """
        return np.asarray(area + self._growth(area, pressure))

    def _growth(self, area: FloatArray, pressure: FloatArray) -> FloatArray:
        c, x = self.constants, np.asarray(pressure) / self.hardness
        return np.asarray(
            (1.0 - np.asarray(area)) * -np.expm1(-c.rate * self.strain * x / (1.0 + c.load * x))
        )

    def pressure(self, area: FloatArray, pressure: FloatArray) -> FloatArray:
        """Nominal pressure at which the face over a bulk that is not strained lets as much through [Pa].

        Parameters
        ----------
        area, pressure : ndarray
            See `area`.
        """
        c, growth = self.constants, self._growth(area, pressure)
        closing = c.closing * (1.0 - c.direction * self.direction) / (1.0 + c.crowded * (area + growth))
        with np.errstate(divide="ignore", invalid="ignore"):
            further = np.where(np.asarray(area) > 0.0, growth / area, 0.0)
        return np.asarray(pressure * (1.0 + closing * further))
