"""Numbers as an engineer reads them: units chosen to suit the size of the value."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Unit:
    """A unit for display.

    Parameters
    ----------
    name : str
    size : float
        One of it in SI.
    """

    name: str
    size: float

    def of(self, value: float) -> float:
        """An SI value in this unit."""
        return value / self.size


# From large to small; the last one serves everything below.
_UNITS = {
    "length": (Unit("m", 1.0), Unit("mm", 1e-3), Unit("µm", 1e-6), Unit("nm", 1e-9)),
    "contact pressure": (Unit("GPa", 1e9), Unit("MPa", 1e6), Unit("kPa", 1e3), Unit("Pa", 1.0)),
    "fluid pressure": (Unit("bar", 1e5), Unit("mbar", 1e2), Unit("Pa", 1.0)),
    "flow": (
        Unit("m³/s", 1.0),
        Unit("l/min", 1e-3 / 60),
        Unit("ml/min", 1e-6 / 60),
        Unit("µl/min", 1e-9 / 60),
        Unit("nl/min", 1e-12 / 60),
        Unit("pl/min", 1e-15 / 60),
    ),
    "force": (Unit("MN", 1e6), Unit("kN", 1e3), Unit("N", 1.0)),
    "line load": (Unit("MN/m", 1e6), Unit("kN/m", 1e3), Unit("N/m", 1.0)),
    "viscosity": (Unit("Pa s", 1.0), Unit("mPa s", 1e-3), Unit("µPa s", 1e-6)),
}
# The smallest figure before the next smaller unit reads better: 0.31 mm, but 90 µm; 1200 N, but 12 kN.
_SMALLEST = {"length": 0.1, "fluid pressure": 0.1, "flow": 0.1, "force": 10.0}
# For a value of zero, which has no size.
_USUAL = {"fluid pressure": 0, "flow": 2, "force": 2}


def unit_for(kind: str, value: float) -> Unit:
    """The unit in which `value` (SI) reads best.

    Parameters
    ----------
    kind : {"length", "contact pressure", "fluid pressure", "flow", "force", "line load", "viscosity"}
    value : float
        Usually the largest of those shown together.
    """
    units = _UNITS[kind]
    if not (math.isfinite(value) and value):
        return units[_USUAL.get(kind, 1)]
    smallest = _SMALLEST.get(kind, 1.0)
    # A rounding error below the limit must not change the unit: 1 MPa is not 1000 kPa.
    return next((unit for unit in units if abs(value) >= smallest * unit.size * (1 - 1e-9)), units[-1])


def number(value: float | None, digits: int = 3) -> str:
    """A number with some significant digits, "–" for none, never in computer notation."""
    if value is None or not math.isfinite(value):
        return "–"
    if value == 0:
        return "0"
    exponent = math.floor(math.log10(abs(value)) + 1e-12)
    if not -3 <= exponent < 6:
        mantissa, power = f"{value:.{digits - 1}e}".split("e")
        return f"{mantissa}·10{superscript(int(power))}".replace("-", "−")
    text = f"{value:.{max(digits - 1 - exponent, 0)}f}"
    return text.replace("-", "−")


def rounded(value: float, digits: int) -> float:
    """A number with no more significant digits than it is worth.

    Examples
    --------
    >>> rounded(774.2, 1)
    800.0
    """
    return float(f"{value:.{digits - 1}e}")


def worth(value: float, digits: int) -> str:
    """A number with no more significant digits than it is worth, before the point neither: "800" for 774.2.

    Parameters
    ----------
    value : float
    digits : int
        Three and more leave every digit before the point.
    """
    return number(rounded(value, digits) if digits < 3 and math.isfinite(value) else value, digits)


def superscript(power: int) -> str:
    """An integer in raised digits."""
    return str(power).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))


def quantity(kind: str, value: float | None, digits: int = 3) -> str:
    """An SI value with the unit that suits it: "0.307 mm"; "–" for none."""
    if value is None or not math.isfinite(value):
        return "–"
    unit = unit_for(kind, value)
    return f"{number(unit.of(value), digits)} {unit.name}"


def given(kind: str, value: float) -> str:
    """An SI value as it was probably written in the input: "20 bar", without zeros that nobody wrote."""
    unit = unit_for(kind, value)
    return f"{trimmed(unit.of(value))} {unit.name}"


def trimmed(value: float) -> str:
    """A number with up to six significant digits and no trailing zeros."""
    text = number(value, 6)
    return text.rstrip("0").rstrip(".") if "." in text and "·" not in text else text


def quantity_worth(kind: str, value: float, digits: int) -> str:
    """The same with no more significant digits than it is worth, see `worth`; three at most."""
    if not math.isfinite(value):
        return "–"
    unit = unit_for(kind, value)
    return f"{worth(unit.of(value), min(digits, 3))} {unit.name}"


def flow(leak_rate: float, digits: int = 3, *, claimed: bool = True) -> str:
    """A leak rate with the unit that suits it, and no more digits than it is worth.

    Only a zero that may be claimed is called sealed.
    """
    if leak_rate == 0:
        return "none, sealed" if claimed else "zero, as calculated"
    return quantity_worth("flow", leak_rate, digits)


def percent(share: float | None, digits: int = 2) -> str:
    """A share in per cent."""
    return "–" if share is None or not math.isfinite(share) else f"{number(100 * share, digits)} %"
