"""First touch of closure and seat, and the exact gap between them: no faceted mesh involved."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from meshes.ball import Ball
from meshes.errors import GeometryError

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class BallOnCone:
    """Contact line of a ball in a conical seat.

    The contact line is the seat's face. x is the arc length on it, zero at first touch, positive towards
    larger r; z is zero at first touch. Every point of the face meets the point of the ball in front of it
    along the face's normal.

    Parameters
    ----------
    ball : Ball
    angle : float
        Angle theta between the axis and the contact normal [rad].

    Notes
    -----
    r0 = R sin(theta) (Fischer, Schmitz, Tiwari, Persson, "Fluid leakage in metallic seals", above eq. 1).
    """

    ball: Ball
    angle: float

    def __post_init__(self) -> None:
        if not 0 < self.angle < math.pi / 2:
            raise GeometryError(
                f"seat angle = {math.degrees(self.angle):.6g} deg: must lie between 0 and 90 deg"
            )

    @property
    def touch_radius(self) -> float:
        """Radius r0 of first touch [m]."""
        return self.ball.radius * math.sin(self.angle)

    @property
    def relative_radius(self) -> float:
        """R_rel of the line contact [m]: 1/R_rel = 1/R1 + 1/R2, the cone being straight."""
        return self.ball.radius

    @property
    def reach(self) -> tuple[float, float]:
        """Arc lengths [m] between which the ball stands in front of the face at all."""
        return -self.touch_radius / math.cos(self.angle), self.ball.radius

    def radius(self, x: FloatArray) -> FloatArray:
        """Radius r(x) of the contact line [m]."""
        return self.touch_radius + np.asarray(x) * math.cos(self.angle)

    def height(self, x: FloatArray) -> FloatArray:
        """Height z(x) of the contact line [m]."""
        return np.asarray(x) * math.sin(self.angle)

    def normal(self, x: FloatArray) -> FloatArray:
        """Unit normal (n_r, n_z) of the seat, towards the closure; shape (2, ...) over x."""
        one = np.ones_like(np.asarray(x, dtype=float))
        return np.stack([-math.sin(self.angle) * one, math.cos(self.angle) * one])

    def gap(self, x: FloatArray) -> FloatArray:
        """Gap g0(x) along the normal at first touch [m], exact; x within `reach`."""
        s = np.asarray(x) / self.ball.radius
        # R - sqrt(R^2 - x^2) without the cancellation that would cost the digits near first touch.
        return self.ball.radius * s**2 / (1 + np.sqrt(1 - s**2))

    def closure_coordinate(self, r: FloatArray, z: FloatArray) -> FloatArray:
        """x of a point (r, z) of the closure's surface [m]."""
        return (np.asarray(r) - self.touch_radius) * math.cos(self.angle) + np.asarray(z) * math.sin(
            self.angle
        )

    def seat_coordinate(self, r: FloatArray, z: FloatArray) -> FloatArray:
        """x of a point (r, z) of the seat's face [m]."""
        return (np.asarray(r) - self.touch_radius) * math.cos(self.angle) + np.asarray(z) * math.sin(
            self.angle
        )

    @property
    def centre_height(self) -> float:
        """Height z of the ball's centre [m]."""
        return self.ball.radius * math.cos(self.angle)

    def polar_angle(self, x: FloatArray) -> FloatArray:
        """Angle of the ball's point at x from the downward axis [rad]."""
        return self.angle + np.arcsin(np.asarray(x) / self.ball.radius)
