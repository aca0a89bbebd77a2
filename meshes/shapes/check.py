"""Dimensions that no body can have are refused, at their key."""

from __future__ import annotations

import math

from meshes.errors import GeometryError, mm


def length(body: str, key: str, value: float, right: bool, must: str) -> None:
    """Refuse a dimension [m] that is not right, and say what it must be.

    Raises
    ------
    GeometryError
    """
    if not right:
        raise GeometryError(f"{body} {key} = {mm(value)}: {must}")


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
        length(body, key, value, math.isfinite(value) and value > 0, "must be positive and finite")


def not_negative(body: str, key: str, value: float) -> None:
    """Refuse a dimension [m] that is negative or not finite; zero is sharp or flush.

    Raises
    ------
    GeometryError
    """
    length(body, key, value, math.isfinite(value) and value >= 0, "must not be negative")


def exceeds(body: str, key: str, value: float, limit: float, what: str) -> None:
    """Refuse a dimension [m] that is not finite or not larger than another one.

    Parameters
    ----------
    body : str
        "closure" or "seat".
    key : str
    value, limit : float
        [m]
    what : str
        The other one in words, in front of its value: "bore_radius =".

    Raises
    ------
    GeometryError
    """
    length(body, key, value, math.isfinite(value) and value > limit, f"must exceed {what} {mm(limit)}")


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
