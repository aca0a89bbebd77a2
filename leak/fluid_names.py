"""What the libraries of liquids and gases share: finding a name, checking a temperature."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from difflib import get_close_matches

from leak.errors import FluidError, positive

ROOM_TEMPERATURE = 293.15
"""20 degC [K]."""


def known_name(name: str, library: Collection[str], synonyms: Mapping[str, str]) -> str:
    """Entry of `library` that is meant, whatever its capitals; FluidError with the nearest names if there is none."""
    key = str(name).strip().lower()
    by_key = {known.lower(): known for known in library} | dict(synonyms)
    if key in by_key:
        return by_key[key]
    close = get_close_matches(key, list(by_key), n=2)
    hint = f" - did you mean {' or '.join(close)}?" if close else ""
    raise FluidError(f"fluid = {name!r}: must be one of {', '.join(library)}{hint}")


def checked_temperature(name: str, temperature: float, low: float, high: float) -> float:
    """`temperature` as a float, or FluidError outside the range [K] in which the correlation of a fluid holds."""
    T = positive(FluidError, "temperature", temperature, "K")
    # A round number of degrees must not fail by the last bit of its kelvins.
    if not low - 1e-6 <= T <= high + 1e-6:
        raise FluidError(
            f"temperature = {T:.6g} K ({T - 273.15:.6g} degC): the properties of {name} are known from {low:g} to "
            f"{high:g} K ({low - 273.15:.4g} to {high - 273.15:.4g} degC)"
        )
    return T
