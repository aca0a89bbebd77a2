"""Checks of the dimensions of shapes, and what is left open in proportion to the partner."""

from __future__ import annotations

import math
from dataclasses import dataclass

from meshes.curve import Curve
from meshes.errors import GeometryError
from meshes.faces import with_faces
from meshes.outline import Outline
from meshes.shape import Shape
from meshes.touch import first_touch


def check_positive(body: str, **lengths: float) -> None:
    """Refuse dimensions that are not positive and finite.

    Parameters
    ----------
    body : str
        "closure" or "seat".
    **lengths : float
        By key [m].

    Raises
    ------
    GeometryError
    """
    for key, value in lengths.items():
        if not (math.isfinite(value) and value > 0):
            raise GeometryError(f"{body} {key} = {value!r} m: must be positive and finite")


def check_angle(body: str, key: str, angle: float, low: float = 0.0, high: float = math.pi / 2) -> None:
    """Refuse an angle [rad] outside the open interval (low, high).

    Raises
    ------
    GeometryError
    """
    if not low < angle < high:
        raise GeometryError(
            f"{body} {key} = {math.degrees(angle):.6g} deg: must lie between {math.degrees(low):.6g} and "
            f"{math.degrees(high):.6g} deg"
        )


@dataclass(frozen=True)
class Partner:
    """What a seat needs to know about its closure to find the dimensions that are left open.

    Parameters
    ----------
    outline : Outline
        Of the closure.
    """

    outline: Outline

    @classmethod
    def of(cls, closure: Shape) -> Partner:
        """The closure as partner."""
        return cls(closure.outline)

    @property
    def size(self) -> float:
        """Radius L of the closure [m], of a ball its own."""
        return self.outline.largest_radius

    def touch_on(self, face: Curve) -> float:
        """Radius of first touch on a seat's face [m]."""
        return self._touch(face)[1]

    def curvature_on(self, face: Curve) -> float:
        """Curvature of the closure where it first touches a seat's face [1/m], positive where it bulges."""
        closure, touch = self._touch(face)
        return closure.curvature(closure.project_radius(touch))

    def _touch(self, face: Curve) -> tuple[Curve, float]:
        closure, seat = with_faces(self.outline, Outline("seat", face.reversed.segments))
        return closure.face, first_touch(closure.face, seat.face).radius

    def housing_radius(self, touch: float, face_end: float) -> float:
        """1.5 L wider than first touch: far enough to change a narrow contact's pressure by some 1e-5."""
        return max(touch + 1.5 * self.size, face_end)

    @property
    def housing_height(self) -> float:
        """1.5 L, as `housing_radius`."""
        return 1.5 * self.size
