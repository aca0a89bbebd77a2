"""Leak rates in the units of leak testing, and the states that a volume of gas is counted at."""

from __future__ import annotations

STANDARD_PRESSURE = 101325.0
"""Pressure of the standard state, one atmosphere [Pa]."""
STANDARD_TEMPERATURE = 273.15
"""Temperature of the standard state, 0 degC (DIN 1343, ISO 10780; "sccm", "standard ml/min") [K]."""
DROP_VOLUME = 1e-6 / 16.0
"""One drop of liquid: 16 drops are one millilitre (API 598, table of closure tests, note a) [m^3]."""
BUBBLE_VOLUME = 0.15e-6
"""One bubble of gas from a tube of 6 mm: 0.15 ml (FCI 70-2, class VI) [m^3]."""


def millilitres_per_minute(leak_rate: float) -> float:
    """Volume flow [m^3/s] in ml/min.

    Examples
    --------
    >>> round(millilitres_per_minute(1e-6), 9)
    60.0
    """
    return leak_rate * 60e6


def drops_per_minute(leak_rate: float, drop_volume: float = DROP_VOLUME) -> float:
    """Volume flow of a liquid [m^3/s] in drops/min, a drop being 1/16 ml unless given [m^3].

    Examples
    --------
    >>> round(drops_per_minute(1e-6 / 60), 9)
    16.0
    """
    return leak_rate * 60.0 / drop_volume


def bubbles_per_minute(leak_rate: float, bubble_volume: float = BUBBLE_VOLUME) -> float:
    """Volume flow of a gas [m^3/s] in bubbles/min, a bubble being 0.15 ml unless given [m^3]."""
    return leak_rate * 60.0 / bubble_volume


def millibar_litres_per_second(throughput: float) -> float:
    """Throughput of a gas [Pa m^3/s] in mbar l/s.

    Examples
    --------
    >>> millibar_litres_per_second(1.0)
    10.0
    """
    return throughput * 10.0
