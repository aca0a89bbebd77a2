"""Where an elastic result passes the yield stress, how far and how deep."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fem_seal.stress import BodyField

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class YieldedZone:
    """The part of a body in which the von Mises stress is above the yield stress.

    Parameters
    ----------
    body : str
        "closure" or "seat".
    yield_stress : float
        [Pa]
    von_mises : float
        The largest [Pa].
    place : tuple of float
        (r, z) of the largest [m].
    depth : float
        Distance of that place from the contact line [m].
    deepest : float
        Largest distance from the contact line at which the yield stress is passed [m].
    """

    body: str
    yield_stress: float
    von_mises: float
    place: tuple[float, float]
    depth: float
    deepest: float

    @property
    def excess(self) -> float:
        """Largest von Mises stress over yield stress."""
        return self.von_mises / self.yield_stress


def yielded_zone(field: BodyField, yield_stress: float) -> YieldedZone | None:
    """Where a body's von Mises stress is above a yield stress; None if nowhere.

    Parameters
    ----------
    field : BodyField
    yield_stress : float
        [Pa]
    """
    stress = field.von_mises
    above = np.flatnonzero(stress > yield_stress)
    if len(above) == 0:
        return None
    depth = _distance(field.points[above], field.points[field.contact_nodes])
    worst = int(np.argmax(stress[above]))
    r, z = field.points[above[worst]].tolist()
    return YieldedZone(
        field.name,
        yield_stress,
        float(stress[above[worst]]),
        (r, z),
        float(depth[worst]),
        float(depth.max()),
    )


def _distance(points: FloatArray, line: FloatArray) -> FloatArray:
    """Distance of points (n, 2) from the polyline through the points (k, 2) of `line`."""
    start, along = line[:-1], np.diff(line, axis=0)
    offset = points[:, None, :] - start
    share = np.clip(np.sum(offset * along, axis=2) / np.sum(along**2, axis=1), 0.0, 1.0)
    return np.linalg.norm(offset - share[..., None] * along, axis=2).min(axis=1)
