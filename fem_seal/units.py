"""Units: quantities of a case file to SI, and SI values to text.

Units exist at the border only; everything behind it is SI.
"""

from __future__ import annotations

import difflib
import math
import re
import tomllib
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache, lru_cache
from importlib.resources import files
from typing import TYPE_CHECKING, Any, Literal

from fem_seal.errors import QuantityError
from leak.standards import STANDARD_PRESSURE

if TYPE_CHECKING:
    from pint import UnitRegistry

_TEMPLATES = files("fem_seal").joinpath("templates")
_TABLES: dict[str, Any] = tomllib.loads(_TEMPLATES.joinpath("units.toml").read_text(encoding="utf-8"))


@dataclass(frozen=True)
class Dimension:
    """A kind of quantity: its SI unit and how an engineer writes it."""

    name: str
    si_unit: str
    examples: Sequence[str]

    @property
    def advice(self) -> str:
        """What to write, for messages: ``a length with its unit, such as "20 mm"``."""
        article = "an" if self.name[0] in "aeiou" else "a"
        listed = ", ".join(f'"{example}"' for example in self.examples)
        return f"{article} {self.name} with its unit, such as {listed}"


DIMENSIONS = {name: Dimension(name, **entries) for name, entries in _TABLES["dimensions"].items()}

# A pressure from here on is one of a solid [Pa].
_HARD = 5e8
# Significant digits of numbers in tables.
DIGITS = 4
# ... and of those that are as good as the limit beside which they stand.
_MOST_DIGITS = 9

# Number first, then a product of units with single-digit powers: no arithmetic, so no "9**9**9".
NUMBER = r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d{1,4})?"
# "cm3" is what drawings write for "cm^3"
_POWER = r"(?:\s?(?:\^|\*\*)\s?-?\d|[23](?!\w))?"
_TERM = rf"(?:1|[^\W\d_]+{_POWER}|°)"
_PRODUCT = rf"{_TERM}(?:(?:\s?[*/·]\s?|\s){_TERM})*"
_UNIT = rf"{_TERM}(?:(?:\s?[*/·]\s?|\s)(?:{_TERM}|\({_PRODUCT}\)))*"
_QUANTITY = re.compile(rf"({NUMBER})\s*({_UNIT})")
# "1 1/2 in", '3/8"', '2"'
_INCHES = re.compile(r'''(?:(\d+)[ -])?(\d+)/([1-9]\d*)\s?(?:in|inch|inches|")|(\d+(?:\.\d+)?)\s?"''')
_TEMPERATURE = re.compile(rf"({NUMBER})\s*(\S+)")
_LONGEST = 60


@cache
def _registry() -> UnitRegistry[Any]:
    # pint takes a sixth of a second to import: only when a quantity is really read
    from pint import UnitRegistry

    registry: UnitRegistry[Any] = UnitRegistry(None)
    registry.load_definitions(_TEMPLATES.joinpath("units.txt").read_text(encoding="utf-8").splitlines())
    return registry


@cache
def _factor(unit: str, dimension: str) -> Fraction:
    """Factor from `unit` to the SI unit of `dimension`; QuantityError if the unit is another dimension's."""
    usual = _TABLES["plain"].get(dimension, {}).get(unit)
    return _registered_factor(unit, dimension) if usual is None else Fraction(usual)


def _registered_factor(unit: str, dimension: str) -> Fraction:
    import pint

    registry = _registry()
    wanted = DIMENSIONS[dimension]
    try:
        given = registry.parse_units(re.sub(r"(?<=[^\W\d_])([23])(?!\w)", r"^\1", unit.replace("·", "*")))
    except (pint.PintError, ValueError, TypeError, AttributeError, KeyError):
        if unit in _TABLES["scales"]:
            raise QuantityError(f'unit "{unit}" does not fit; write {wanted.advice}') from None
        raise QuantityError(
            f'unit "{unit}" is unknown{_similar_units(unit)}; write {wanted.advice}'
        ) from None
    si = registry.parse_units(wanted.si_unit)
    angular = any(name in ("radian", "degree") for name in given._units)
    if given.dimensionality != si.dimensionality or (dimension == "angle" and not angular):
        raise QuantityError(f'unit "{unit}" does not fit; write {wanted.advice}')
    factor = float(registry.Quantity(1.0, given).to(si).magnitude)
    # decimal factors exactly, so that "1.9 um" is 1.9e-6 and not the float beside it
    return Fraction(
        f"{factor:.12g}" if math.isclose(float(f"{factor:.12g}"), factor, rel_tol=1e-14) else factor
    )


def _similar_units(unit: str) -> str:
    """Ask for known units that are spelled like the unknown one, " (do you mean mPa, MPa?)", or nothing."""
    texts = [text for dimension in DIMENSIONS.values() for text in dimension.examples]
    known = [unit for text in texts for unit in text.split()[1:]]
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
    if isinstance(text, str):
        return _parse(short_text(text, dimension), dimension)
    bare = isinstance(text, (int, float)) and not isinstance(text, bool)
    raise QuantityError(
        f"{'has no unit' if bare else 'is not a quantity'}; write {DIMENSIONS[dimension].advice}"
    )


DECIMAL_COMMA = "has a decimal comma, use a point"


def split_quantities(text: str) -> list[str]:
    """Quantities with commas between them; a comma between digits is a decimal one.

    Examples
    --------
    >>> split_quantities("10 bar,20 bar, 1,5 bar")
    ['10 bar', '20 bar', '1,5 bar']
    """
    return [part.strip() for part in re.split(r"(?<!\d),|,(?!\d)", text)]


def exact_quantity(text: str, dimension: str) -> Fraction:
    """Value of a quantity in SI before it is rounded to a float, for what is calculated from it.

    Half a diameter of "40.1 mm" is then the very radius of "20.05 mm".

    Parameters
    ----------
    text : str
    dimension : str
        As of `parse_quantity`; no temperature.

    Raises
    ------
    QuantityError
        As of `parse_quantity`.

    Examples
    --------
    >>> float(exact_quantity("40.1 mm", "length") / 2) == parse_quantity("20.05 mm", "length")
    True
    """
    return _parse_exactly(short_text(text, dimension), dimension)


def short_text(text: str, dimension: str) -> str:
    """Text of a quantity as it may be looked into: no longer than any quantity is.

    With single spaces, and the minus of a keyboard for that of print, which messages and reports have.

    Parameters
    ----------
    text : str
    dimension : str
        As of `parse_quantity`.

    Raises
    ------
    QuantityError
        If it is longer.
    """
    plain = " ".join(text.split()).replace("−", "-")
    if len(plain) > _LONGEST:
        wrong = f"is not a number followed by a unit but {len(plain)} characters"
        raise QuantityError(f"{wrong}; write {DIMENSIONS[dimension].advice}")
    return plain


# a study reads the same texts again for each of its designs
@lru_cache(maxsize=4096)
def _parse(stripped: str, dimension: str) -> float:
    try:
        return float(_parse_exactly(stripped, dimension))
    except OverflowError:
        raise QuantityError(f"is not a finite number; write {DIMENSIONS[dimension].advice}") from None


def _parse_exactly(stripped: str, dimension: str) -> Fraction:
    """Number times unit; of a temperature above the zero of its scale, so that it is no product."""
    wanted, is_temperature = DIMENSIONS[dimension].advice, dimension == "temperature"
    if dimension == "length" and (inches := _INCHES.fullmatch(stripped)):
        whole, over, under, plain = inches.groups()
        number = Fraction(plain or whole or 0) + Fraction(int(over or 0), int(under or 1))
        return number * Fraction("0.0254")
    match = (_TEMPERATURE if is_temperature else _QUANTITY).fullmatch(stripped)
    # "20" alone would be a temperature of 2 of the unit "0", and "0.1" a length of 0 of the unit "1"
    if match is None or re.fullmatch(NUMBER, stripped):
        raise QuantityError(f"{_syntax_error(stripped)}; write {wanted}")
    if not is_temperature:
        return Fraction(match[1]) * _factor(match[2], dimension)
    if match[2] not in _TABLES["scales"]:
        raise QuantityError(f'unit "{match[2]}" is no temperature; write {wanted}')
    zero, degree = (Fraction(part) for part in _TABLES["scales"][match[2]])
    # degF counts its zero in its own degrees
    kelvin = (Fraction(match[1]) + zero) * degree
    if kelvin < 0:
        raise QuantityError("is below absolute zero, -273.15 degC")
    return kelvin


def _syntax_error(text: str) -> str:
    if re.fullmatch(NUMBER, text):
        return "has no unit"
    if re.match(r"[+-]?\d+,\d", text):
        return DECIMAL_COMMA
    if re.match(r"[+-]?(nan|inf)", text.lower()):
        return "is not a finite number"
    if not re.match(NUMBER, text):
        return "does not begin with a number"
    return "is not a number followed by a unit"


@dataclass(frozen=True)
class Unit:
    """A unit for display.

    Parameters
    ----------
    name : str
    size : float
        One of it in SI.
    zero : float
        SI value at which it is zero: 273.15 K of a temperature in °C.
    """

    name: str
    size: float
    zero: float = 0.0

    def of(self, value: float) -> float:
        """An SI value in this unit."""
        return (value - self.zero) / self.size


System = Literal["SI", "field", "US"]
"""Units of display: SI with its prefixes, those of the field (bar, mm, ml/min), those of the United States."""
# What a system does not have of its own it has of the field.
_SYSTEMS: dict[str, dict[str, tuple[Unit, ...]]] = {
    system: {
        kind: tuple(Unit(**one) for one in several)
        for kind, several in (_TABLES["display"]["field"] | own).items()
    }
    for system, own in _TABLES["display"].items()
}


@dataclass(frozen=True)
class Display:
    """How quantities are shown: the only argument of sentences, tables and pictures that is not a result.

    Parameters
    ----------
    system : {"SI", "field", "US"}
    throughputs : bool
        Leak rates, of a gas, as pressure times volume over time; see `fem_seal.case.tables.CaseTables.display`.
    of_flow : Unit, optional
        The one of all leak rates, a volume over time.

    Examples
    --------
    >>> display = Display("US")
    >>> display.quantity(2e6, "fluid pressure"), display.quantity(1e-9, "flow")
    ('290 psi', '0.220 in³/h')
    >>> Display(throughputs=True).quantity(1e-6, "flow")
    '1.01 mbar l/s'
    >>> Display(of_flow=Unit("mm³/min", 1e-9 / 60)).leak_range((1e-15, 2e-9))
    '6.0·10⁻⁵ to 120 mm³/min'
    """

    system: System = "field"
    throughputs: bool = False
    of_flow: Unit | None = None

    def units(self, kind: str) -> tuple[Unit, ...]:
        """All units of a kind of quantity, the largest first; see `unit_for`.

        Parameters
        ----------
        kind : str
        """
        known = _SYSTEMS[self.system]
        if kind == "flow" and self.of_flow is not None:
            return (self.of_flow,)
        if kind == "flow" and self.throughputs:
            return tuple(replace(unit, size=unit.size / STANDARD_PRESSURE) for unit in known["throughput"])
        return known[kind]

    def unit_for(self, kind: str, value: float) -> Unit:
        """The unit in which `value` (SI) reads best.

        Parameters
        ----------
        kind : str
            "length", "contact pressure", "fluid pressure", "flow", "force", "line load", "viscosity",
            "pressure-viscosity coefficient", "throughput",
            "mass flow", "angle", "temperature", "volume" or "time".
        value : float
            Usually the largest of those shown together.
        """
        units = self.units(kind)
        if not (math.isfinite(value) and value):
            return units[min(_TABLES["usual"].get(kind, 1), len(units) - 1)]
        smallest = (_TABLES["smallest"]["field"] | _TABLES["smallest"].get(self.system, {})).get(kind, 1.0)
        # A rounding error below the limit must not change the unit: 1 MPa is not 1000 kPa.
        return next((unit for unit in units if abs(value) >= smallest * unit.size * (1 - 1e-9)), units[-1])

    def fixed_unit(self, name: str) -> Unit:
        """A unit that a table of the terminal shows whatever the size of its numbers.

        Parameters
        ----------
        name : str
            One of "bar", "MPa", "GPa", "N", "kN/m", "N/mm", "N m", "mm", "um", "nm", "deg", "degC", "mPa s",
            "ml/min", "mm³/s", "mbar l/s"; "" for a plain number. The system of display has another one in its place.
        """
        if name == _FIXED_FLOW and self.of_flow is not None:
            return self.of_flow
        other = _TABLES["fixed_in"].get(self.system, {}).get(name)
        return Unit(**other) if other else Unit(name, _TABLES["fixed"][name])

    def flow_unit(self, leak_rates: Collection[float]) -> Unit | None:
        """The unit for leak rates that stand together, the largest in which all can be read.

        That is 23 to 120 ml/min rather than 0.023 to 0.12 l/min, and 0.042 to 1.5 ml/min rather than 42 to 1500 µl/min.

        Parameters
        ----------
        leak_rates : collection of float
            [m^3/s]

        Returns
        -------
        Unit or None
            None if they are too far apart for any.
        """
        known = [rate for rate in leak_rates if 0 < rate < math.inf]
        if not known or self.of_flow is not None:
            return self.of_flow
        smallest, largest = min(known), max(known)
        if smallest < _TOGETHER * largest:
            return None
        units = self.units("flow")
        for unit in units[units.index(self.unit_for("flow", largest)) :]:
            if unit.of(smallest) >= (_READABLE if unit.of(largest) >= 1.0 else _READABLE_OF_LITTLE):
                return unit
        return units[-1]

    def shared_flow_unit(self, leak_rates: Collection[float]) -> Unit:
        """The unit of a table or picture of leak rates: that of sentences with them, or of the largest.

        Parameters
        ----------
        leak_rates : collection of float
            [m^3/s]

        Examples
        --------
        >>> [Display().shared_flow_unit(rates).name for rates in ((3.8e-7, 2e-6), (1e-13, 2e-6))]
        ['ml/min', 'l/min']
        """
        largest = max((rate for rate in leak_rates if math.isfinite(rate)), default=0.0)
        return self.flow_unit(leak_rates) or self.unit_for("flow", largest)

    def quantity(self, value: Any, how: str) -> str:
        """A number in the format that words and templates ask for; of a tuple both ends.

        Parameters
        ----------
        value : float or tuple of float
            SI; None is a dash.
        how : str
            "number", "percent", "share", "strain", "trimmed" or "worth", or a kind of `unit_for`, before which "given",
            "short" (four digits at most, no zeros at their end) or "worth" may stand; then the digits. So may "fixed"
            before a name of `fixed_unit`. A format of Python's is one, too, "g" or one that begins with no letter, and
            may have such a name behind it.

        Examples
        --------
        >>> display = Display()
        >>> display.quantity(0.00123, "length 2"), display.quantity(0.3, "percent")
        ('1.2 mm', '30 %')
        >>> display.quantity(2e6, "given fluid pressure"), display.quantity((0.001, 0.0025), "length 2")
        ('20 bar', '1.0 mm to 2.5 mm')
        >>> display.quantity(12.7346e9, "fixed MPa"), Display("US").quantity(6.894757e9, "fixed MPa")
        ('12730 MPa', '1000 ksi')
        >>> display.quantity(0.12345, ".2f"), display.quantity(2.54e-5, ".3g um"), display.quantity(1234.5, ".3g")
        ('0.12', '25.4 um', '1230')
        >>> Display("US").quantity(2e6, ".4g bar")
        '290.1 psi'
        """
        if isinstance(value, tuple):
            return range_text(*(self.quantity(end, how) for end in value))
        first, *rest = how.split()
        if not first[0].isalpha() or first == "g":
            unit = self.fixed_unit(" ".join(rest)) if rest else None
            text = format(value if unit is None else unit.of(value), first)
            # 1000 rather than 1e+03
            text = f"{float(text):g}" if "e+" in text and first.endswith("g") else text
            return text if unit is None else f"{text} {unit.name}"
        digits = [int(rest.pop())] if rest and rest[-1].isdigit() else []
        if value is None:
            return "–"
        if first in _PLAIN and not rest:
            return _PLAIN[first](value, *digits)
        if first == "fixed":
            unit, number_digits = self.fixed_unit(" ".join(rest)), (digits or [DIGITS])[0]
            return f"{round_digits(unit.of(value), number_digits):.{_MOST_DIGITS}g} {unit.name}".rstrip()
        if first == "short":
            return self.quantity(round_digits(value, DIGITS), " ".join(["given", *rest]))
        given, worth = first == "given", first == "worth"
        kind = " ".join(rest if given or worth else [first, *rest])
        if not (given or math.isfinite(value)):
            return "–"
        unit = self.unit_for(kind, value)
        write = trim_zeros if given else _sentence_number if worth else number
        return f"{write(unit.of(value), *digits)} {unit.name}"

    def near_limit(self, name: str, value: float, limit: float, digits: int) -> str:
        """An SI value in a `fixed_unit`, with `digits_at_limit` digits, without zeros at its end.

        Parameters
        ----------
        name : str
        value, limit : float
            [SI]
        digits : int

        Examples
        --------
        >>> Display().near_limit("MPa", 7213e6, 7200e6, 2)
        '7210 MPa'
        """
        unit = self.fixed_unit(name)
        return f"{format_at_limit(unit.of(value), round_digits(unit.of(limit), DIGITS), digits)} {unit.name}"

    def leak_rate(
        self, leak_rate: float, digits: int = 3, *, claimed: bool = True, volume: LeakVolume | None = None
    ) -> str:
        """A leak rate with the unit that suits it, and no more digits than it is worth.

        Only a zero that may be claimed is called sealed; less than anybody could measure is called so.

        Examples
        --------
        >>> Display().leak_rate(8e-62)
        'none measurable, less than a cubic nanometre per hour'
        """
        volume = LIQUID if volume is None else volume
        if leak_rate == 0:
            return "none, sealed" if claimed else "zero, as calculated"
        if not volume.measurable(leak_rate):
            return f"none measurable, less than {volume.least_name}"
        return self.quantity(leak_rate, f"worth flow {digits}")

    def leak_range(
        self,
        leak_rate: float | tuple[float, float],
        digits: int = 3,
        *,
        claimed: bool = True,
        beside: Collection[float] = (),
        volume: LeakVolume | None = None,
    ) -> str:
        """A leak rate, or both ends of its interval, in one unit.

        Parameters
        ----------
        leak_rate : float or tuple of float
            [m^3/s]
        digits : int
            That they are worth; two at most of an interval.
        claimed : bool
            See `leak_rate`.
        beside : collection of float, optional
            Leak rates in the same sentence, for one unit of all [m^3/s].
        volume : LeakVolume, optional
            What leaks, a liquid unless given; an end that nobody could measure is told as zero.

        Examples
        --------
        >>> display = Display()
        >>> display.leak_range((2e-9, 5.61e-9))
        '0.12 to 0.34 ml/min'
        >>> [display.leak_range(rate, beside=(1e-8, 2e-5)) for rate in (1e-8, 2e-5)]
        ['0.600 ml/min', '1200 ml/min']
        """
        volume = LIQUID if volume is None else volume
        low, high = leak_rate if isinstance(leak_rate, tuple) else (leak_rate, leak_rate)
        if math.isnan(high) or not volume.measurable(high) or low == math.inf:
            return self.leak_rate(high, digits, claimed=claimed, volume=volume)
        low = volume.measurable(low)
        beside = [volume.measurable(rate) for rate in beside]
        if low < high:
            digits = min(digits, _RANGE_DIGITS)
        if high == math.inf:
            return f"at least {self.quantity(low, f'worth flow {digits}')}"
        unit = self.flow_unit((low, high, *beside)) or self.shared_flow_unit((low, high))
        return f"{range_text(*(_sentence_number(unit.of(end), digits) for end in (low, high)))} {unit.name}"

    def state_of(self, volume: LeakVolume) -> str:
        """What has to be said beside a leak rate: nothing of a liquid, nor of pressure times volume.

        Parameters
        ----------
        volume : LeakVolume

        Examples
        --------
        >>> Display().state_of(LeakVolume.of_gas(293.15)), Display("US").state_of(LeakVolume.of_gas(293.15))
        ('20 °C and 1.01325 bar', '68 °F and 14.6959 psi')
        """
        if self.throughputs or volume.temperature is None:
            return ""
        unit = self.unit_for("temperature", volume.temperature)
        at = self.quantity(STANDARD_PRESSURE, "given fluid pressure")
        return f"{trim_zeros(round(unit.of(volume.temperature), 1))} {unit.name} and {at}"

    def name_unit(self, unit: Unit, volume: LeakVolume) -> Unit:
        """A unit with the state of the gas behind it, for headings and axes.

        Parameters
        ----------
        unit : Unit
        volume : LeakVolume

        Examples
        --------
        >>> Display().name_unit(Unit("ml/min", 1e-6 / 60), LeakVolume.of_gas(473.15)).name
        'ml/min at 200 °C and 1.01325 bar'
        """
        state = self.state_of(volume)
        return replace(unit, name=f"{unit.name} at {state}") if state else unit


# Of the leak rates in a table of the terminal.
_FIXED_FLOW = "mm³/s"


def unit_like(written: str, dimension: str, value: float, system: System) -> Unit | None:
    """The unit of a system in which a quantity of a case file is shown.

    Parameters
    ----------
    written : str
        Unit in the case file; one that the system has stays.
    dimension : str
        One of `DIMENSIONS`.
    value : float
        [SI]
    system : {"SI", "field", "US"}

    Returns
    -------
    Unit or None
        None where the unit stays as it is.

    Examples
    --------
    >>> unit_like("bar", "pressure", 2e6, "US").name, unit_like("bar", "pressure", 2e6, "field")
    ('psi', None)
    """
    kinds = ("fluid pressure", "contact pressure") if dimension == "pressure" else (dimension,)
    own = {one.name for kind in kinds for one in _SYSTEMS[system].get(kind, ())}
    if written.replace("um", "µm") in own or kinds[0] not in _SYSTEMS[system] or dimension == "angle":
        return None
    return Display(system).unit_for(kinds[-1] if value >= _HARD else kinds[0], value)


_AS_WRITTEN = re.compile(rf"\s*(?P<count>{NUMBER})\s*(?P<unit>[^\d\s].*?)\s*")


def unit_as_written(text: object, value: float) -> Unit | None:
    """The unit of a quantity as a case file writes it, for display.

    Parameters
    ----------
    text : str
        None and numbers have no unit.
    value : float
        What the text says [SI].

    Examples
    --------
    >>> unit_as_written("3 mm^3/min", 5e-11)
    Unit(name='mm³/min', size=1.66666666667e-11, zero=0.0)
    """
    found = _AS_WRITTEN.fullmatch(text) if isinstance(text, str) else None
    if found is None or not value:
        return None
    name = re.sub(r"(?:\^|\*\*)?3\b", "³", found["unit"]).replace("*", " ").replace("ul", "µl")
    # twelve digits: no rounding error makes 0.3 of it 0.30000000000000004
    return Unit(name, float(f"{value / float(found['count']):.12g}"))


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


def round_digits(value: float, digits: int) -> float:
    """A number with no more significant digits than it is worth.

    Examples
    --------
    >>> round_digits(774.2, 1)
    800.0
    """
    return float(f"{value:.{digits - 1}e}")


def digits_within(error: float) -> int:
    """Significant digits of a number with this relative error, four at most: in the last one it is five at most.

    Parameters
    ----------
    error : float
        NaN where nobody knows it: nothing is left out then.

    Examples
    --------
    >>> digits_within(0.004), digits_within(0.04), digits_within(0.4), digits_within(4.0)
    (4, 3, 2, 1)
    """
    if not error > 0:
        return DIGITS
    return min(max(1 + math.ceil(-math.log10(2 * error)), 1), DIGITS) if math.isfinite(error) else 1


def format_digits(value: float, digits: int) -> str:
    """A number with no more significant digits than it is worth, before the point neither: "800" for 774.2.

    Parameters
    ----------
    value : float
    digits : int
        Four leave every digit before the point.
    """
    return number(round_digits(value, digits) if digits < DIGITS and math.isfinite(value) else value, digits)


# A number that is as near to its limit has no side that anybody could measure.
_ALIKE = 1e-5


def digits_at_limit(value: float, limit: float, digits: int) -> int:
    """Significant digits of a number beside its limit: as many as it is worth, more if they show on which side it is.

    Parameters
    ----------
    value : float
    limit : float
        As it is written.
    digits : int

    Examples
    --------
    >>> [digits_at_limit(7213.0, limit, 2) for limit in (6800.0, 7200.0, 7210.0)]
    [2, 3, 4]
    >>> digits_at_limit(99.99999999, 100.0, 2)
    2
    """
    if not math.isfinite(value):
        return digits
    if abs(value - limit) < _ALIKE * abs(limit):
        value = limit
    shown = ((more, round_digits(value, more)) for more in range(digits, _MOST_DIGITS))
    sides = (more for more, one in shown if (one > limit, one < limit) == (value > limit, value < limit))
    return next(sides, _MOST_DIGITS)


def format_at_limit(value: float, limit: float, digits: int) -> str:
    """A number with `digits_at_limit` digits, without zeros at its end.

    Parameters
    ----------
    value, limit : float
    digits : int

    Examples
    --------
    >>> format_at_limit(7213.0, 6800.0, 2), format_at_limit(7213.0, 7200.0, 2), format_at_limit(1.004, 1.0, 2)
    ('7200', '7210', '1.004')
    """
    return f"{round_digits(value, digits_at_limit(value, limit, digits)):.{_MOST_DIGITS}g}"


def superscript(power: int) -> str:
    """An integer in raised digits."""
    return str(power).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))


def trim_zeros(value: float, digits: int = 6) -> str:
    """A number with up to so many significant digits and no trailing zeros."""
    text, *power = number(value, digits).split("·")
    return "·".join([text.rstrip("0").rstrip(".") if "." in text else text, *power])


def _sentence_number(value: float, digits: int) -> str:
    return format_digits(value, digits) if digits < DIGITS else number(value)


# Of one molecule [J/K].
_BOLTZMANN = 1.380649e-23


@dataclass(frozen=True)
class LeakVolume:
    """What a volume that leaks is: of a gas its state, and how much of it is too little to be measured.

    Parameters
    ----------
    temperature : float or None
        Of a gas, as which its volume counts [K]; None of a liquid.
    least : float
        Leak rates below it are called none measurable [m^3/s]: of a liquid a cubic nanometre per hour, some thirty
        molecules of water or one of oil.
    least_name : str
    """

    temperature: float | None = None
    least: float = 1e-27 / 3600.0
    least_name: str = "a cubic nanometre per hour"

    @classmethod
    def of_gas(cls, temperature: float) -> LeakVolume:
        """That of a gas at 101325 Pa, the least of which is one molecule per hour.

        Parameters
        ----------
        temperature : float
            [K]

        Examples
        --------
        >>> f"{LeakVolume.of_gas(293.15).least:.2e}"
        '1.11e-29'
        """
        volume = _BOLTZMANN * temperature / STANDARD_PRESSURE
        return cls(temperature, volume / 3600.0, "a molecule per hour")

    def measurable(self, leak_rate: float) -> float:
        """A leak rate, or zero where nobody could measure it [m^3/s]."""
        return 0.0 if 0.0 < leak_rate < self.least else leak_rate


LIQUID = LeakVolume()


# Digits of the ends of an interval: it says how little the others would be worth.
_RANGE_DIGITS = 2
# Smallest figure of a leak rate in the unit of a larger one beside it, also where that is below one, and how far apart
# they may be for one unit.
_READABLE, _READABLE_OF_LITTLE, _TOGETHER = 0.01, 0.1, 1e-4


def range_text(low: str, high: str) -> str:
    """Two ends as they are written, or what both of them are written as.

    Examples
    --------
    >>> range_text("1.2", "5.6"), range_text("1.2", "1.2")
    ('1.2 to 5.6', '1.2')
    """
    return low if low == high else f"{low} to {high}"


def percent(share: float | None, digits: int = 2) -> str:
    """A share in per cent."""
    return "–" if share is None or not math.isfinite(share) else f"{number(100 * share, digits)} %"


def strain_text(strain: float, digits: int = 2) -> str:
    """A plastic strain in per cent; far beyond small strains its number says nothing.

    Examples
    --------
    >>> strain_text(0.0123), strain_text(4e2)
    ('1.2 %', 'more than 100 %')
    """
    return "more than 100 %" if strain > 1 else percent(strain, digits)


def share_text(share: float) -> str:
    """A share with two digits and no zeros at its end.

    Examples
    --------
    >>> share_text(0.05), share_text(0.0123), share_text(0.997)
    ('5 %', '1.2 %', '100 %')
    """
    return f"{round_digits(100 * share, 2):g} %"


def split_unit(column: str) -> tuple[str, str]:
    """What a column of leak.csv is called without its unit, and its SI unit, empty for a plain number.

    Parameters
    ----------
    column : str

    Examples
    --------
    >>> split_unit("leak_rate_Pa_m3_per_s")
    ('leak_rate', 'Pa m^3/s')
    """
    for ending, unit in _TABLES["endings"].items():
        if column.endswith(ending):
            return column.removesuffix(ending), unit
    return column, ""


def attributes(found: object, *columns: str) -> dict[str, Any]:
    """Attributes of an object by what their columns are called: the name with the SI unit behind it.

    Parameters
    ----------
    found : object
    *columns : str

    Examples
    --------
    >>> from fractions import Fraction
    >>> attributes(Fraction(1, 2), "numerator_m", "denominator")
    {'numerator_m': 1, 'denominator': 2}
    """
    return {one: getattr(found, split_unit(one)[0]) for one in columns}


_OF_FLUID = ("fluid_pressure", "outlet_pressure")


def kind_of(path: str, si_unit: str) -> str:
    """What `unit_for` calls the quantity behind a key of the case file; empty if nothing is known of it.

    Parameters
    ----------
    path : str
        Such as "load.fluid_pressure".
    si_unit : str

    Examples
    --------
    >>> kind_of("load.fluid_pressure", "Pa"), kind_of("seat.material.hardness", "Pa")
    ('fluid pressure', 'contact pressure')
    """
    if si_unit == "Pa" and any(word in path for word in _OF_FLUID):
        return "fluid pressure"
    kind: str = _TABLES["kinds"].get(si_unit, "")
    return kind


def duration(seconds: float) -> str:
    """A time as people say it."""
    if seconds < 90:
        return f"{seconds:.0f} s"
    if seconds < 5400:
        return f"{seconds / 60:.0f} min"
    return f"{seconds / 3600:.1f} h"


# Formats of a number: without unit, and with the unit that suits it.
_PLAIN: dict[str, Callable[..., str]] = {
    "number": number,
    "percent": percent,
    "strain": strain_text,
    "share": share_text,
    "trimmed": trim_zeros,
    "worth": format_digits,
}


@cache
def _numbers_and_units() -> re.Pattern[str]:
    shown = {one.name for system in _SYSTEMS.values() for several in system.values() for one in several}
    names = sorted(
        {*shown, *_TABLES["fixed"], *_TABLES["scales"], "%", "drops/min", "bubbles/min", "kg/s"} - {""},
        key=len,
    )
    return re.compile(rf"((?<=[\d⁰¹²³⁴-⁹]) |(?<=\[))({'|'.join(map(re.escape, reversed(names)))})(?![\w/·])")


def keep_units_together(text: str) -> str:
    r"""A text of a page whose lines do not end between a number and its unit, nor within the unit of a heading.

    Examples
    --------
    >>> keep_units_together("leak rate [mbar l/s]: 2 mbar l/s"), keep_units_together("2 mm")
    ('leak rate [mbar\xa0l/s]: 2\xa0mbar\xa0l/s', '2\xa0mm')
    """
    return _numbers_and_units().sub(lambda found: found[0].replace(" ", "\N{NO-BREAK SPACE}"), text)
