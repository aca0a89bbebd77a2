"""Readings: models of asperities that yield."""

from enum import StrEnum


class Reading(StrEnum):
    """What becomes of asperities that reach the hardness.

    Examples
    --------
    >>> [str(one) for one in READINGS["paper"]]
    ['conserved', 'capped']
    """

    CONSERVED = "conserved"
    """The spectrum C_pl: smoothed everywhere by plastic flow, valleys included (`leak.theory.plasticity`)."""
    CAPPED = "capped"
    """The hardness limits the pressure, and the surface changes only where it touches (`leak.theory.capped`)."""
    VON_MISES = "von-mises"
    """Metal that flows by von Mises below the surface (`leak.theory.capped`)."""
    ELASTIC = "elastic"
    """Nothing yields."""


READINGS = {"paper": (Reading.CONSERVED, Reading.CAPPED), "corrected": (Reading.VON_MISES,)}
"""Those of each theory, its default first."""
