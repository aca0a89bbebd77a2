"""Quantities with units, as they stand in the case file: ``"20 mm"``, ``"1e3 1/m"``, ``"45 deg"``.

Units exist at the border only; everything behind it is SI.
"""

from __future__ import annotations

import difflib
import math
import re
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, lru_cache
from typing import TYPE_CHECKING, Any

from fem_seal.errors import QuantityError

if TYPE_CHECKING:
    from pint import UnitRegistry

# The units of a seal's data sheet. The registry is defined here and not taken from pint's own list because
# that list costs ten times more time to load, and because it accepts units (such as "20 mM") that only a slip
# of the finger brings into a case file.
_DEFINITIONS = """
nano- = 1e-9 = n-
micro- = 1e-6 = µ- = μ- = u-
milli- = 1e-3 = m-
centi- = 1e-2 = c-
hecto- = 1e2 = h-
kilo- = 1e3 = k-
mega- = 1e6 = M-
giga- = 1e9 = G-
tera- = 1e12 = T-
meter = [length] = m = metre
second = [time] = s
gram = [mass] = g
radian = [] = rad
degree = 3.141592653589793 / 180 * radian = deg = ° = degrees
inch = 0.0254 * meter = in
foot = 0.3048 * meter = ft
liter = 1e-3 * meter ** 3 = l = L = litre
micron = 1e-6 * meter
angstrom = 1e-10 * meter = Å
minute = 60 * second = min
hour = 3600 * second = h
newton = 1000 * gram * meter / second ** 2 = N
kilogram_force = 9.80665 * newton = kgf = kp
pound_force = 4.4482216152605 * newton = lbf
pascal = newton / meter ** 2 = Pa
bar = 1e5 * pascal
standard_atmosphere = 101325 * pascal = atm
pounds_per_square_inch = pound_force / inch ** 2 = psi
kilopounds_per_square_inch = 1000 * pound_force / inch ** 2 = ksi
poise = 0.1 * pascal * second = P
"""


@dataclass(frozen=True)
class Dimension:
    """A kind of quantity: its SI unit and how an engineer writes it."""

    name: str
    si_unit: str
    examples: tuple[str, ...]

    @property
    def wanted(self) -> str:
        """What to write, for messages: ``a length with its unit, such as "20 mm"``."""
        article = "an" if self.name[0] in "aeiou" else "a"
        listed = ", ".join(f'"{example}"' for example in self.examples)
        return f"{article} {self.name} with its unit, such as {listed}"


DIMENSIONS = {
    dimension.name: dimension
    for dimension in (
        Dimension("length", "m", ("20 mm", "0.76 um", "0.5 in")),
        Dimension("pressure", "Pa", ("20 bar", "3.5 GPa", "300 psi")),
        Dimension("force", "N", ("250 N", "1.2 kN", "50 lbf")),
        Dimension("viscosity", "Pa s", ("1 mPa s", "46 cP")),
        Dimension("wavenumber", "1/m", ("1e3 1/m", "3.1 1/um")),
        Dimension("time", "s", ("20 s", "2 min")),
        Dimension("angle", "rad", ("45 deg", "0.785 rad")),
        Dimension("temperature", "K", ("20 degC", "293.15 K")),
        Dimension("spectral density", "m^4", ("1e-18 m^4", "1e6 nm^4")),
        Dimension("leak rate", "m^3/s", ("1e-3 cm^3/s", "0.5 ml/min")),
    )
}

# Number first, then a product of units with single-digit powers: no arithmetic, so no "9**9**9".
NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,4})?"
_POWER = r"(?:\s?(?:\^|\*\*)\s?-?\d)?"
_TERM = rf"(?:1|[^\W\d_]+{_POWER}|°)"
_PRODUCT = rf"{_TERM}(?:(?:\s?[*/·]\s?|\s){_TERM})*"
_UNIT = rf"{_TERM}(?:(?:\s?[*/·]\s?|\s)(?:{_TERM}|\({_PRODUCT}\)))*"
_QUANTITY = re.compile(rf"({NUMBER})\s*({_UNIT})")
_LONGEST = 60


@cache
def _registry() -> UnitRegistry[Any]:
    # pint takes a sixth of a second to import: only when a quantity is really read
    from pint import UnitRegistry

    registry: UnitRegistry[Any] = UnitRegistry(None)
    registry.load_definitions(_DEFINITIONS.strip().splitlines())
    return registry


@cache
def _factor(unit: str, dimension: str) -> Fraction:
    """Factor from `unit` to the SI unit of `dimension`; QuantityError if the unit is another dimension's."""
    import pint

    registry = _registry()
    wanted = DIMENSIONS[dimension]
    try:
        given = registry.parse_units(unit.replace("·", "*"))
    except (pint.PintError, ValueError, TypeError, AttributeError, KeyError):
        raise QuantityError(f'unit "{unit}" is unknown{_similar(unit)}; write {wanted.wanted}') from None
    si = registry.parse_units(wanted.si_unit)
    angular = any(name in ("radian", "degree") for name in given._units)
    if given.dimensionality != si.dimensionality or (dimension == "angle" and not angular):
        raise QuantityError(f'unit "{unit}" does not fit; write {wanted.wanted}')
    factor = float(registry.Quantity(1.0, given).to(si).magnitude)
    # decimal factors exactly, so that "1.9 um" is 1.9e-6 and not the float beside it
    return Fraction(
        f"{factor:.12g}" if math.isclose(float(f"{factor:.12g}"), factor, rel_tol=1e-14) else factor
    )


def _similar(unit: str) -> str:
    """Ask for known units that are spelled like the unknown one, " (do you mean mPa, MPa?)", or nothing."""
    known = [
        token
        for dimension in DIMENSIONS.values()
        for text in dimension.examples
        for token in text.split()[1:]
    ]
    known += ["m", "um", "µm", "nm", "Pa", "kPa", "MPa", "mPa", "N", "rad", "inch", "atm", "psi", "kgf"]
    same = [name for name in dict.fromkeys(known) if name.lower() == unit.lower()]
    similar = same or difflib.get_close_matches(unit, known, n=2, cutoff=0.6)
    return f" (do you mean {' or '.join(dict.fromkeys(similar))}?)" if similar else ""


def parse_quantity(text: object, dimension: str) -> float:
    """Value of a quantity with unit, in SI.

    Parameters
    ----------
    text : str
        Number and unit, such as ``"20 mm"``, ``"1e3 1/m"``, ``"45 deg"``.
    dimension : str
        One of `DIMENSIONS`: "length", "pressure", "force", "viscosity", "wavenumber", "angle", ...

    Returns
    -------
    float
        Value in the dimension's SI unit; angles in radian.

    Raises
    ------
    QuantityError
        If it is not a number with a unit of this dimension, or not finite. Bare numbers are not accepted:
        nobody could tell later whether 20 meant metres or millimetres.

    Examples
    --------
    >>> parse_quantity("20 mm", "length")
    0.02
    >>> round(parse_quantity("45 deg", "angle"), 6)
    0.785398
    """
    wanted = DIMENSIONS[dimension].wanted
    if isinstance(text, (int, float)) and not isinstance(text, bool):
        raise QuantityError(f"has no unit; write {wanted}")
    if not isinstance(text, str):
        raise QuantityError(f"is not a quantity; write {wanted}")
    return _parsed(" ".join(text.split()), dimension)


# a study reads the same texts again for each of its designs
@lru_cache(maxsize=4096)
def _parsed(stripped: str, dimension: str) -> float:
    wanted = DIMENSIONS[dimension].wanted
    if dimension == "temperature":
        return _temperature(stripped)
    match = _QUANTITY.fullmatch(stripped) if len(stripped) <= _LONGEST else None
    if match is None:
        raise QuantityError(f"{_what_is_wrong(stripped)}; write {wanted}")
    try:
        return float(Fraction(match[1]) * _factor(match[2], dimension))
    except OverflowError:
        raise QuantityError(f"is not a finite number; write {wanted}") from None


# Zero of each scale and size of its degree in kelvin.
_SCALES = {
    "K": ("0", "1"),
    "degC": ("273.15", "1"),
    "°C": ("273.15", "1"),
    "degF": ("459.67", "5/9"),
    "°F": ("459.67", "5/9"),
}


def _temperature(text: str) -> float:
    """Temperature [K]; scales have a zero of their own, so it is no product of number and unit."""
    wanted = DIMENSIONS["temperature"].wanted
    match = re.fullmatch(rf"({NUMBER})\s*(\S+)", text) if len(text) <= _LONGEST else None
    if match is None:
        raise QuantityError(f"{_what_is_wrong(text)}; write {wanted}")
    if match[2] not in _SCALES:
        raise QuantityError(f'unit "{match[2]}" is no temperature; write {wanted}')
    zero, degree = (Fraction(part) for part in _SCALES[match[2]])
    # degF counts its zero in its own degrees
    kelvin = (Fraction(match[1]) + zero) * degree
    try:
        return float(kelvin)
    except OverflowError:
        raise QuantityError(f"is not a finite number; write {wanted}") from None


def _what_is_wrong(text: str) -> str:
    if re.fullmatch(NUMBER, text):
        return "has no unit"
    if re.match(r"[+-]?\d+,\d", text):
        return "has a decimal comma, use a point"
    if re.match(r"[+-]?(nan|inf)", text.lower()):
        return "is not a finite number"
    if not re.match(NUMBER, text):
        return "does not begin with a number"
    return "is not a number followed by a unit"
