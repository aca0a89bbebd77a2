"""Dimensions that no body can have are refused, at their key."""

from __future__ import annotations

import math

from meshes.errors import GeometryError, mm


def positive(body: str, **lengths: float) -> None:
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
            raise GeometryError(f"{body} {key} = {mm(value)}: must be positive and finite")


def not_negative(body: str, key: str, length: float) -> None:
    """Refuse a dimension [m] that is negative or not finite; zero is sharp or flush.

    Raises
    ------
    GeometryError
    """
    if not (math.isfinite(length) and length >= 0):
        raise GeometryError(f"{body} {key} = {mm(length)}: must not be negative")


def exceeds(body: str, key: str, length: float, limit: float, what: str) -> None:
    """Refuse a dimension [m] that is not finite or not larger than another one.

    Parameters
    ----------
    body : str
        "closure" or "seat".
    key : str
    length, limit : float
        [m]
    what : str
        The other one in words, in front of its value: "bore_radius =".

    Raises
    ------
    GeometryError
    """
    if not (math.isfinite(length) and length > limit):
        raise GeometryError(f"{body} {key} = {mm(length)}: must exceed {what} {mm(limit)}")


def angle(body: str, key: str, angle: float, low: float = 0.0, high: float = math.pi / 2) -> None:
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
