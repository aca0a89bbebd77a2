"""Extent and depth of the yielded zone, or of the zone above yield of an elastic solution."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from fem_seal.arrays import FloatArray
from fem_seal.bodies.fields import BodyField, ElastoplasticField
from fem_seal.contact.solution import ContactSolution
from fem_seal.materials import Material

# Plastic strain that counts as yielded, as a share of the elastic strain at yield.
_COUNTS = 0.01


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
    yield_stress : float
        [Pa]
    """
    found = _largest(field, field.von_mises, yield_stress)
    return None if found is None else YieldedZone(field.name, yield_stress, *found)


@dataclass(frozen=True)
class PlasticZone:
    """Where a body that was solved as elastoplastic has yielded.

    Parameters
    ----------
    body : str
        "closure" or "seat".
    yield_stress : float
        Of its curve [Pa].
    strain : float
        The largest accumulated plastic strain [-].
    place : tuple of float
        (r, z) of the largest [m].
    depth : float
        Distance of that place from the contact line [m].
    deepest : float
        Largest distance from the contact line at which it has yielded [m].
    """

    body: str
    yield_stress: float
    strain: float
    place: tuple[float, float]
    depth: float
    deepest: float


def plastic_zone(field: ElastoplasticField, material: Material) -> PlasticZone | None:
    """Where a body has yielded; None if nowhere.

    Parameters
    ----------
    material : Material
        With its hardening curve.

    Notes
    -----
    Nodal values are averages over the triangles around, so that the edge of the zone is known to within a triangle. A
    hundredth of the elastic strain at yield counts as yielded.
    """
    assert material.yield_stress is not None  # that of the curve
    counts = _COUNTS * material.yield_stress / material.youngs_modulus
    found = _largest(field, field.accumulated_plastic_strain, counts)
    return None if found is None else PlasticZone(field.name, material.yield_stress, *found)


def yielding_of(
    contact: ContactSolution, materials: Mapping[str, Material] | None = None
) -> dict[str, YieldedZone | PlasticZone]:
    """Where the bodies of a contact yield or, solved as elastic, would; by name, without those that do not.

    Parameters
    ----------
    materials : mapping, optional
        Of "closure" and "seat", where the model is shared by materials that differ in their strength.
    """
    found: dict[str, YieldedZone | PlasticZone] = {}
    for name, body in contact.model.bodies.items():
        material = body.material if materials is None else materials[name]
        limit = material.yield_stress
        if limit is None:
            # without a look at the stress, which a model without displacements does not hold
            continue
        if contact.stays_below(name, limit):
            continue
        field = contact.fields[name]
        zone = (
            plastic_zone(field, material)
            if isinstance(field, ElastoplasticField)
            else yielded_zone(field, limit)
        )
        if zone is not None:
            found[name] = zone
    return found


def _largest(
    field: BodyField, values: FloatArray, limit: float
) -> tuple[float, tuple[float, float], float, float] | None:
    """Largest nodal value above a limit, its place and depth, and the largest depth at which the limit is passed."""
    above = np.flatnonzero(values > limit)
    if len(above) == 0:
        return None
    depth = _distance(field.points[above], field.points[field.contact_nodes])
    worst = int(np.argmax(values[above]))
    r, z = field.points[above[worst]].tolist()
    return float(values[above[worst]]), (r, z), float(depth[worst]), float(depth.max())


def _distance(points: FloatArray, line: FloatArray) -> FloatArray:
    """Distance of points (n, 2) from the polyline through the points (k, 2) of `line`."""
    start, along = line[:-1], np.diff(line, axis=0)
    offset = points[:, None, :] - start
    share = np.clip(np.sum(offset * along, axis=2) / np.sum(along**2, axis=1), 0.0, 1.0)
    return np.linalg.norm(offset - share[..., None] * along, axis=2).min(axis=1)
