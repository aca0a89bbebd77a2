"""Asperities over metal whose bulk flows: they sink, since nothing elastic holds them from below.

The hardness of 2.9 yield stresses is that of a summit in elastic metal. Bulk that is strained in its plane yields at
any further pressure, and the more of the face touches, the slower the rest sinks: dA = K x/(1 + b x) (S - A) de, with
x = p/H and e the plastic strain of the bulk over the rms slope. S is one, and more where the bulk becomes narrower:
then its metal rises into the valleys by itself. The gaps close further than by pressing to the same area while little
touches, and less so the more does.

Metal that is stretched or pressed together elastically while the face is loaded does not sink, but has other summits:
tension helps them to yield, compression holds them.
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
    >>> BulkFlowConstants().least < 1.0
    True
    """

    rate: float = 11.8
    """K, of strain that makes one direction as much wider as the other one narrower."""
    load: float = 1.2
    """b, by how much the growth of the area over the load falls with the load."""
    softness: float = 4.3
    """By how much slower the area grows, over H/(E* h'): part of it is elastic."""
    delay: float = 1.0
    """Yield strains by which the flattening begins late."""
    early: float = 0.62
    """Share by which it is less late where the area grows by all of the strain, and later where it shrinks."""
    wider: float = 0.44
    """By how much faster it goes where the area grows by all of the strain, and slower where it shrinks."""
    rising: float = 0.56
    """By how much S exceeds one where the area shrinks by all of the strain."""
    closing: float = 1.64
    """Growth of the pressure that would close the gaps as far, over that of the area touched, while little touches."""
    crowded: float = 3.4
    """One over the area touched from which on it falls."""
    least: float = 0.9
    """To what: strained faces seal at a little more area than the theory has where faces at rest seal."""
    direction: float = 0.11
    """By how much less the gaps close for flow along the strain, and more for flow across it."""
    lay: float = 0.14
    """Power of the Peklenik number by which strain along the lay flattens less and strain across it more, and by which
    the gaps close less for flow along the lay."""
    tension: float = 0.1
    """Share by which summits are softer in metal that is stretched to its yield stress when they are loaded."""
    spread: float = 0.5
    """Standard deviation of ln(direct/theory) of conductivities where all of the contact is from sinking."""


BULK_FLOW = BulkFlowConstants()
HARDNESS_OVER_YIELD_STRESS = 2.9
"""Indentation hardness over the yield stress in tension of metal that no longer hardens; so of a summit that elastic
metal holds."""
_POISSON = 0.3


class BulkStrain(NamedTuple):
    """Strain of the metal under a face, elastic part included.

    Parameters
    ----------
    meridional, hoop : float or ndarray
        Along the flow and across it, of one place or of many [-].
    yield_stress : float, optional
        Of the asperities, in place of a 2.9th of the hardness [Pa].
    elastic : float or ndarray
        Sum of both elastic strains while the face is loaded [-].

    Examples
    --------
    >>> BulkStrain(0.01, 0.0).yield_stress is None
    True
    """

    meridional: FloatArray | float
    hoop: FloatArray | float
    yield_stress: float | None = None
    elastic: FloatArray | float = 0.0


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
    filled : ndarray
        Area towards which it goes, S [-].
    channels : float
        By how much the gaps close less for flow along the lay [-].
    softer : ndarray
        Hardness of metal without stress over that of the summits [-].
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
    filled: FloatArray | float = 1.0
    channels: float = 1.0
    softer: FloatArray | float = 1.0
    constants: BulkFlowConstants = BULK_FLOW

    @classmethod
    def of(
        cls,
        strain: BulkStrain,
        *,
        rms_slope: float,
        hardness: float,
        effective_modulus: float,
        peklenik: float = 1.0,
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
        peklenik : float
            Length of the asperities along the flow over that across it [-].
        constants : BulkFlowConstants
        """
        meridional, hoop, yield_stress, elastic = strain
        c, meridional, hoop = constants, np.asarray(meridional), np.asarray(hoop)
        square = meridional**2 + hoop**2 + meridional * hoop
        stress = hardness / HARDNESS_OVER_YIELD_STRESS if yield_stress is None else yield_stress
        # of metal that keeps its volume, and the same where it begins to yield
        equivalent = 2.0 / math.sqrt(3.0) * np.sqrt(square)
        yields = 2.0 * (1.0 + _POISSON) / 3.0 * stress / ((1.0 - _POISSON**2) * effective_modulus)
        some = square > 0.0
        wider = np.divide(meridional + hoop, equivalent, out=np.zeros(some.shape), where=some)
        late = c.delay * (1.0 - c.early * wider) * yields
        plastic = np.hypot(equivalent, late) - late
        direction = np.divide(meridional**2 - hoop**2, square, out=np.zeros(some.shape), where=some)
        rate = (1.0 + c.wider * wider) * peklenik ** (-c.lay * direction)
        slower = 1.0 + c.softness * HARDNESS_OVER_YIELD_STRESS * stress / (effective_modulus * rms_slope)
        return cls(
            plastic * rate / slower / rms_slope,
            direction,
            HARDNESS_OVER_YIELD_STRESS * stress,
            1.0 + c.rising * np.maximum(-wider, 0.0),
            max(peklenik, 1.0) ** -c.lay,
            softer(elastic, effective_modulus / stress, c),
            c,
        )

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
        c, x, left = self.constants, np.asarray(pressure) / self.hardness, 1.0 - np.asarray(area)
        sunk = -np.expm1(-c.rate * self.strain * x / (1.0 + c.load * x))
        return np.asarray(np.minimum((self.filled - 1.0 + left) * sunk, left))

    def pressure(self, area: FloatArray, pressure: FloatArray) -> FloatArray:
        """Nominal pressure at which the face over a bulk that is not strained lets as much through [Pa].

        Parameters
        ----------
        area, pressure : ndarray
            See `area`.
        """
        c, growth = self.constants, self._growth(area, pressure)
        alone = (1.0 + (c.crowded * (area + growth)) ** 4) ** -0.25
        ahead = c.closing * alone * (1.0 - c.direction * self.direction * alone)
        closing = np.maximum(ahead, c.least) * self.channels
        with np.errstate(divide="ignore", invalid="ignore"):
            further = np.where(np.asarray(area) > 0.0, growth / area, 0.0)
        return np.asarray(pressure * self.softer * (1.0 + closing * further))


def softer(
    elastic: FloatArray | float, modulus_over_stress: float, constants: BulkFlowConstants = BULK_FLOW
) -> FloatArray:
    """Hardness of metal without stress over that of metal stretched in its plane; below one if pressed together.

    Parameters
    ----------
    elastic : ndarray or float
        Sum of both elastic strains while the face is loaded [-].
    modulus_over_stress : float
        E* over the yield stress of the asperities [-].
    constants : BulkFlowConstants

    Examples
    --------
    >>> float(softer(0.01, 100.0))
    1.1
    """
    return np.asarray(1.0 + constants.tension * np.clip(elastic * modulus_over_stress, -1.0, 1.0))
