"""Leakage classes of closed valves, of flanges and stems, with their tests, and the units of leak testing.

Valves are judged by ISO 5208, EN 12266-1, API 598, MSS SP-61 and FCI 70-2, pressure relief valves by API 527. Flanges
are judged per length of their seal (VDI 2440, EN 13555 with EN 1591-1), the seals of valve stems per diameter of the
stem (ISO 15848-1), each with helium.

The numbers are those of the revisions named in `STANDARDS`, taken from secondary literature (tables of manufacturers
and of trade sites), not from the standards themselves: for acceptance read the standard. `Standard.source` says where
two of them disagree, `Standard.from_memory` which numbers stand in none that could be opened. A class says what the
leak rate allows under the conditions calculated; the test pressures and fluids of a standard are its `ClosureTest`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from types import MappingProxyType

from leak.errors import FluidError, positive
from leak.files import own_tables

_INCH, _PSI = 0.0254, 6894.757
_MINUTE, _HOUR = 60.0, 3600.0


@dataclass(frozen=True)
class ClosureTest:
    """A test of closed valves as a standard prescribes it: the fluid and its pressure.

    Parameters
    ----------
    name : str
    medium : {"water", "air"}
    share : float
        Of the rated pressure, of a relief valve of its set pressure.
    below_rated : float
        The pressure is at least so much below that one [Pa].
    highest_pressure : float
        Highest pressure of the test [Pa].
    classes : tuple of str
        For which it is; empty for all.
    of_its_kind : bool
        Whether it is for valves of such a fluid, gas or liquid, alone.

    Examples
    --------
    >>> low = STANDARDS["ISO 5208"].tests[1]
    >>> low.medium, low.pressure(40e5), round(low.pressure(4e5))
    ('air', 600000.0, 440000)
    """

    name: str
    medium: str
    share: float
    below_rated: float = -math.inf
    highest_pressure: float = math.inf
    classes: tuple[str, ...] = ()
    of_its_kind: bool = False

    @property
    def gas(self) -> bool:
        """Whether it is a test with gas."""
        return self.medium == "air"

    def pressure(self, rated_pressure: float) -> float:
        """Pressure difference of the test [Pa].

        Parameters
        ----------
        rated_pressure : float
            Rated pressure of the valve, set pressure of a relief valve [Pa].
        """
        return min(self.share * rated_pressure, rated_pressure - self.below_rated, self.highest_pressure)


@dataclass(frozen=True)
class Standard:
    """A standard and where its limits come from.

    Parameters
    ----------
    name, revision, source : str
    bubble_volume : float
        Of one bubble of its gas test [m^3].
    tests : tuple of ClosureTest
        Empty where they are not known here.
    from_memory : str
        Numbers that stand in no source that could be opened; empty if there are none.
    """

    name: str
    revision: str
    source: str
    bubble_volume: float
    tests: tuple[ClosureTest, ...] = ()
    from_memory: str = ""


_DATA = own_tables("leak.fluids", "standards.toml")
STANDARDS = MappingProxyType(
    {
        name: Standard(name, **{**data, "tests": tuple(ClosureTest(**row) for row in data.get("tests", ()))})
        for name, data in _DATA["standards"].items()
    }
)
# Those whose best class is told of every leak rate.
_ALWAYS_GRADED = ("ISO 5208", "API 598", "FCI 70-2")

# NPS [inch] to DN [mm] where it is not 25 mm to the inch.
_NPS: dict[float, float] = dict(_DATA["nominal_sizes"]["NPS"])
# API 598: drops and bubbles per minute and per inch of nominal pipe size, above NPS 2 (DN 50).
_API_DROPS, _API_BUBBLES, _API_SMALLEST = 2.0, 4.0, 50.0
# Up to DN 50 a gas may form less than one bubble in the shortest test, 15 s; a liquid may not be seen at all.
_API_SHORTEST_TEST = 15.0
# Longer than any closure test [s], and a droplet as small as the eye resolves, of 0.1 mm [m^3].
_LONGEST_TEST, _DROPLET = 600.0, math.pi / 6.0 * 1e-4**3
# FCI 70-2: share of the rated capacity.
_FCI_SHARES = (("IV", 1e-4), ("III", 1e-3), ("II", 5e-3))
# Class V: 5e-12 m^3/s of water per mm of seat diameter and bar; 4.7 ml/min of air per inch of orifice.
_FCI_V_LIQUID = 5e-12 / (1e-3 * 1e5)
_FCI_V_GAS = 4.7e-6 / _MINUTE / _INCH
# MSS SP-61, per inch of nominal pipe size: 10 ml/h of liquid, 0.1 ft^3/h of gas. API 527: 10 ml/h of water.
_MSS_LIQUID, _MSS_GAS = 10e-6 / _HOUR, 0.1 * (12.0 * _INCH) ** 3 / _HOUR
_API_527_WATER = 10e-6 / _HOUR
# A row holds for diameters that differ by no more from its own [mm].
_FCI_VI_NEAR = 2.0 + 1e-9


@dataclass(frozen=True)
class LeakageLimit:
    """The largest leak rate of one class of one standard for one valve.

    Parameters
    ----------
    standard, name : str
        Such as "ISO 5208", "B".
    leak_rate : float
        Largest allowed volume flow; of a gas at atmospheric pressure [m^3/s].

    Examples
    --------
    >>> import leak
    >>> leak.leakage_limits(0.025, gas=False)[0].standard
    'ISO 5208'
    """

    standard: str
    name: str
    leak_rate: float


@dataclass(frozen=True)
class LeakageClass:
    """The best class of one standard that a leak rate meets.

    Parameters
    ----------
    standard : str
    name : str or None
        None if it meets no class of those that can be judged. Of an interval: the class that both ends meet.
    limit : float or None
        Largest leak rate of that class [m^3/s].
    at_best : str or None
        Of an interval whose lower end meets a tighter class: that class.

    Examples
    --------
    >>> import leak
    >>> str(leak.LeakageClass("ISO 5208", "B", 1e-9))
    'ISO 5208 B'
    >>> str(leak.LeakageClass("ISO 5208", "D", 1e-8, at_best="B"))
    'ISO 5208 between B and D'
    """

    standard: str
    name: str | None
    limit: float | None
    at_best: str | None = None

    def __str__(self) -> str:
        """Standard and class in words."""
        if self.at_best:
            return f"{self.standard} between {self.at_best} and {self.name or 'no class'}"
        return f"{self.standard} {self.name}" if self.name else f"{self.standard}: no class met"


def leakage_limits(
    nominal_size: float,
    *,
    gas: bool,
    pressure_drop: float | None = None,
    seat_diameter: float | None = None,
    rated_capacity: float | None = None,
    bubble_volume: float | None = None,
    seal_length: float | None = None,
    density: float | None = None,
    set_pressure: float | None = None,
) -> tuple[LeakageLimit, ...]:
    """Limits of all classes that can be judged for a valve, the tightest of each standard first.

    Parameters
    ----------
    nominal_size : float
        DN as a length: 0.025 for DN 25 [m].
    gas : bool
        Whether a gas leaks, or a liquid.
    pressure_drop : float, optional
        Pressure difference; class V of FCI 70-2 needs it for liquids [Pa].
    seat_diameter : float, optional
        Bore of the seat for FCI 70-2; the nominal size unless given [m].
    rated_capacity : float, optional
        Flow through the open valve under the same conditions; classes II to IV of FCI 70-2 need it [m^3/s].
    bubble_volume : float, optional
        Of one bubble, which API 598 counts of a gas; that of the standard unless given [m^3].
    seal_length : float, optional
        Circumference of a seal that gas leaks through; classes per length need it [m].
    density : float, optional
        Of the gas at 101325 Pa, with which classes by mass, those of EN 13555, are volumes [kg/m^3].
    set_pressure : float, optional
        Of a pressure relief valve, from 15 to 6000 psi; API 527 needs it [Pa].

    Returns
    -------
    tuple of LeakageLimit
        ISO 5208 "A", and API 598 for liquids up to DN 50, have the limit zero: no leak may be seen during the test.

    Raises
    ------
    FluidError
        A size, pressure or capacity is not positive.

    Notes
    -----
    FCI 70-2 class VI is a test with air. A row of its table holds within 2 mm of its diameter; between rows the limit
    goes with the square of the diameter, beyond the largest there is none.

    Examples
    --------
    >>> limits = {(row.standard, row.name): row.leak_rate for row in leakage_limits(0.025, gas=False)}
    >>> f"{limits['ISO 5208', 'D'] * 1e9:.1f} mm^3/s"
    '2.5 mm^3/s'
    """
    dn = 1e3 * positive(FluidError, "nominal_size", nominal_size, "m")
    bore = 1e3 * positive(FluidError, "seat_diameter", seat_diameter or nominal_size, "m")
    drop = None if pressure_drop is None else positive(FluidError, "pressure_drop", pressure_drop, "Pa")
    capacity = (
        None if rated_capacity is None else positive(FluidError, "rated_capacity", rated_capacity, "m^3/s")
    )
    bubble = _bubble("API 598", bubble_volume)
    rates = {"A": 0.0} | {name: 1e-9 * dn * pair[gas] for name, pair in _DATA["rates_of_iso_5208"].items()}
    mss = (_MSS_GAS if gas else _MSS_LIQUID) * _inches(dn)
    return (
        *(LeakageLimit("ISO 5208", name, rate) for name, rate in rates.items()),
        LeakageLimit("API 598", "metal-seated", _api_limit(dn, bubble if gas else None)),
        *_fci_limits(bore, gas, drop, capacity),
        *(LeakageLimit("EN 12266-1", name, rate) for name, rate in rates.items() if len(name) == 1),
        LeakageLimit("MSS SP-61", "metal-seated", mss),
        *_relief_limits(dn, bore, set_pressure, _bubble("API 527", bubble_volume) if gas else None),
        *(_limits_per_length(seal_length, density) if gas and seal_length is not None else ()),
    )


def standard_named(name: str) -> str | None:
    """The name that a standard has here; None if it is not known.

    Parameters
    ----------
    name : str
        As people write it: "iso 5208", "ISO 5208:2015", "ANSI/FCI 70-2".

    Examples
    --------
    >>> standard_named("ANSI/FCI 70-2-2006"), standard_named("EN 1")
    ('FCI 70-2', None)
    """
    bare = re.sub(r"^ansi/|^din |[\s.-]", "", name.lower().split(":")[0])
    # which names the classes of the other
    bare = "en13555" if bare == "en15911" else bare
    names = {re.sub(r"[\s-]", "", standard.lower()): standard for standard in STANDARDS}
    return names.get(bare) or next(
        (full for short, full in names.items() if re.fullmatch(re.escape(short) + r"(19|20)\d\d", bare)), None
    )


def classes_of(standard: str, *, gas: bool, rated_capacity: bool = True) -> tuple[str, ...]:
    """Classes of a standard for a gas or a liquid, the tightest first.

    Parameters
    ----------
    standard : str
        As in `STANDARDS`.
    gas : bool
    rated_capacity : bool
        Whether the flow through the open valve is known, see `leakage_limits`.

    Examples
    --------
    >>> classes_of("FCI 70-2", gas=True)
    ('VI', 'V', 'IV', 'III', 'II')
    """
    capacity = 1.0 if rated_capacity else None
    limits = leakage_limits(
        0.025,
        gas=gas,
        pressure_drop=1e5,
        rated_capacity=capacity,
        seal_length=1.0,
        density=1.0,
        set_pressure=1e6,
    )
    return tuple(limit.name for limit in limits if limit.standard == standard)


def closure_tests(standard: str, name: str, *, gas: bool) -> tuple[ClosureTest, ...]:
    """Tests of a standard for a class; empty where they are not known here.

    Parameters
    ----------
    standard, name : str
        As in `STANDARDS` and `classes_of`.
    gas : bool
        Whether the valve is for a gas, or for a liquid.

    Examples
    --------
    >>> [test.name for test in closure_tests("FCI 70-2", "V", gas=True)]
    ['test with water']
    """
    return tuple(
        test
        for test in STANDARDS[standard].tests
        if (not test.classes or name in test.classes) and (test.gas == gas or not test.of_its_kind)
    )


def visible_leak_rate(*, gas: bool, bubble_volume: float | None = None) -> float:
    """Leak rate that no observer misses: a drop, or a bubble, within the shortest test of 15 s [m^3/s].

    Where a class allows no visible leakage, more than this fails it for certain, see `invisible_leak_rate`.

    Parameters
    ----------
    gas : bool
    bubble_volume : float, optional
        Of one bubble [m^3]; that of ISO 5208, whose class A is the only one of a gas without visible leakage, unless
        given.

    Examples
    --------
    >>> print(f"{millilitres_per_minute(visible_leak_rate(gas=False)):.2f} ml/min")
    0.25 ml/min
    """
    return (_bubble("ISO 5208", bubble_volume) if gas else DROP_VOLUME) / _API_SHORTEST_TEST


def invisible_leak_rate(*, gas: bool, bubble_volume: float | None = None) -> float:
    """Leak rate that no observer sees: less than a bubble, or a droplet of 0.1 mm, within 10 min [m^3/s].

    Where a class allows no visible leakage, no more than this meets it for certain: closure tests take up to 2 min,
    and a droplet of 0.1 mm is seen from 0.3 m under one minute of arc.

    Parameters
    ----------
    gas, bubble_volume
        See `visible_leak_rate`.

    Raises
    ------
    FluidError
        If the volume of a bubble is not positive.

    Examples
    --------
    >>> print(f"{invisible_leak_rate(gas=False):.2g} m^3/s, {invisible_leak_rate(gas=True):.2g} m^3/s")
    8.7e-16 m^3/s, 1.1e-10 m^3/s
    """
    return (_bubble("ISO 5208", bubble_volume) if gas else _DROPLET) / _LONGEST_TEST


def _bubble(standard: str, user_volume: float | None) -> float:
    volume = STANDARDS[standard].bubble_volume if user_volume is None else user_volume
    return positive(FluidError, "bubble_volume", volume, "m^3")


def leakage_class(
    leak_rate: float,
    nominal_size: float,
    *,
    gas: bool,
    pressure_drop: float | None = None,
    seat_diameter: float | None = None,
    rated_capacity: float | None = None,
    bubble_volume: float | None = None,
    highest: float | None = None,
) -> tuple[LeakageClass, ...]:
    """The tightest class of each standard that a leak rate, or both ends of its interval, meets.

    Class "A" of ISO 5208, "no visible leakage", is only met by what nobody sees (`invisible_leak_rate`): beyond it
    depends on the duration of the test and on the observer.

    Parameters
    ----------
    leak_rate : float
        Volume flow; of a gas at atmospheric pressure (`GasLeakResult.leak_rate`); infinite for a seal that the fluid
        has blown open, which meets no class. Of an interval its lower end [m^3/s].
    nominal_size, gas, pressure_drop, seat_diameter, rated_capacity, bubble_volume
        See `leakage_limits`.
    highest : float, optional
        Upper end where the leak rate is known as an interval [m^3/s].

    Returns
    -------
    tuple of LeakageClass
        Of ISO 5208, API 598 and FCI 70-2, as far as they have a limit for these data.

    Examples
    --------
    >>> [str(row) for row in leakage_class(1.2e-9, 0.025, gas=False, pressure_drop=20e5)]
    ['ISO 5208 CC', 'API 598: no class met', 'FCI 70-2 V']
    >>> str(leakage_class(1.2e-9, 0.025, gas=False, highest=8e-9)[0])
    'ISO 5208 between CC and EE'
    """
    if not leak_rate >= 0.0:
        raise FluidError(f"leak_rate = {leak_rate!r}: must be a number, not negative [m^3/s]")
    if highest is None:
        highest = leak_rate
    if not highest >= leak_rate:
        raise FluidError(f"highest = {highest!r}: must not be below the leak rate {leak_rate!r} [m^3/s]")
    invisible = invisible_leak_rate(gas=gas, bubble_volume=bubble_volume)
    leak_rate, highest = (0.0 if rate <= invisible else rate for rate in (leak_rate, highest))
    limits = leakage_limits(
        nominal_size,
        gas=gas,
        pressure_drop=pressure_drop,
        seat_diameter=seat_diameter,
        rated_capacity=rated_capacity,
        bubble_volume=bubble_volume,
    )
    return tuple(
        _tightest([limit for limit in limits if limit.standard == standard], leak_rate, highest)
        for standard in dict.fromkeys(limit.standard for limit in limits if limit.standard in _ALWAYS_GRADED)
    )


def class_per_length(
    leak_rate: float, seal_length: float, *, density: float | None = None, highest: float | None = None
) -> tuple[LeakageClass, ...]:
    """The tightest classes of a flange joint that the leak rate of a gas, or both ends of its interval, meets.

    Parameters
    ----------
    leak_rate : float
        Volume flow at 101325 Pa; of an interval its lower end [m^3/s].
    seal_length : float
        Circumference of the seal [m].
    density, highest
        See `leakage_limits`, `leakage_class`.

    Returns
    -------
    tuple of LeakageClass
        Of VDI 2440 and, with a density, of EN 13555.

    Examples
    --------
    A gasket of helium, 0.167 kg/m^3, with 1e-7 mbar l/s on 126 mm:

    >>> [str(row) for row in class_per_length(1e-8 / 101325, 0.126, density=0.167)]
    ['VDI 2440 TA Luft', 'EN 13555 L0.01']
    """
    limits = [limit for limit in _limits_per_length(seal_length, density) if limit.standard != "ISO 15848-1"]
    return tuple(
        _tightest([limit for limit in limits if limit.standard == standard], leak_rate, highest or leak_rate)
        for standard in dict.fromkeys(limit.standard for limit in limits)
    )


def _relief_limits(
    dn: float, bore: float, set_pressure: float | None, bubble_volume: float | None
) -> Iterator[LeakageLimit]:
    """That of API 527, of a gas with this volume of a bubble, of water without; DN and bore in mm."""
    table = _DATA["bubbles_of_api_527"]
    if set_pressure is None:
        return
    psi = positive(FluidError, "set_pressure", set_pressure, "Pa") / _PSI * (1.0 + 1e-9)
    if not min(table["set_pressure"]) <= psi <= table["highest_set_pressure"] * (1.0 + 1e-5):
        return
    rate = _API_527_WATER * max(_inches(dn), 1.0)
    if bubble_volume is not None:
        column = table["small" if math.pi / 4 * (1e-3 * bore) ** 2 <= table["orifice"] else "large"]
        row = max(n for n, lowest in enumerate(table["set_pressure"]) if lowest <= psi)
        rate = column[row] * bubble_volume / _MINUTE
    yield LeakageLimit("API 527", "metal-seated", rate)


def _inches(dn: float) -> float:
    """NPS of a DN in mm."""
    return next((inch for inch, size in _NPS.items() if size == dn), dn / 25.0)


def _limits_per_length(seal_length: float, density: float | None) -> Iterator[LeakageLimit]:
    length = positive(FluidError, "seal_length", seal_length, "m")
    rates, litre = _DATA["rates_per_length"], 1.0 / millibar_litres_per_second(STANDARD_PRESSURE)
    yield LeakageLimit("VDI 2440", "TA Luft", rates["vdi_2440"] * litre * length)
    if density is not None:
        density = positive(FluidError, "density", density, "kg/m^3")
        for name, rate in rates["en_13555"].items():
            yield LeakageLimit("EN 13555", name, 1e-6 * rate * length / density)
    for name, rate in rates["iso_15848_1"].items():
        yield LeakageLimit("ISO 15848-1", name, rate * litre * 1e3 * length / math.pi)


def nominal_size_of_bore(diameter: float) -> float:
    """The standard DN nearest to a bore, as a length [m]; for valves whose size is not given.

    Parameters
    ----------
    diameter : float
        [m]

    Examples
    --------
    >>> nominal_size_of_bore(0.0265)
    0.025
    """
    bore = 1e3 * positive(FluidError, "diameter", diameter, "m")
    sizes: list[int] = _DATA["nominal_sizes"]["DN"]
    return min(sizes, key=lambda dn: abs(dn / bore - 1.0) if dn > bore else abs(bore / dn - 1.0)) * 1e-3


def read_nominal_size(text: str) -> float | None:
    """Length [m] of "DN25", "DN 25" or "NPS 1", "NPS 1 1/2"; None if the text is neither.

    Examples
    --------
    >>> read_nominal_size("DN 25"), read_nominal_size("NPS 1/2")
    (0.025, 0.015)
    """
    dn = re.fullmatch(r"\s*DN\s*(\d{1,4})\s*", text, flags=re.IGNORECASE)
    if dn:
        return float(dn[1]) * 1e-3 or None
    nps = re.fullmatch(r"\s*NPS\s*(\d{1,3}(?:\.\d+)?)?(?:[\s-]*(\d)/(\d))?\s*", text, flags=re.IGNORECASE)
    if not nps or not (nps[1] or nps[2]) or nps[3] == "0":
        return None
    inches = float(nps[1] or 0) + (float(nps[2]) / float(nps[3]) if nps[2] else 0.0)
    return _NPS.get(inches, 25.0 * inches) * 1e-3 if inches else None


def _tightest(limits: list[LeakageLimit], lowest: float, highest: float) -> LeakageClass:
    """Of the limits of one standard."""
    at_best, at_worst = (
        min((row for row in limits if rate <= row.leak_rate), key=lambda row: row.leak_rate, default=None)
        for rate in (lowest, highest)
    )
    standard, tighter = limits[0].standard, None if at_best is None or at_best == at_worst else at_best.name
    if at_worst is None:
        return LeakageClass(standard, None, None, tighter)
    return LeakageClass(standard, at_worst.name, at_worst.leak_rate, tighter)


def _api_limit(dn: float, bubble_volume: float | None) -> float:
    """Limit of a gas with this volume of a bubble, of a liquid without; DN in mm."""
    if dn <= _API_SMALLEST:
        return 0.0 if bubble_volume is None else bubble_volume / _API_SHORTEST_TEST
    volume = _API_DROPS * DROP_VOLUME if bubble_volume is None else _API_BUBBLES * bubble_volume
    return _inches(dn) * volume / _MINUTE


def _fci_limits(
    bore: float, gas: bool, pressure_drop: float | None, rated_capacity: float | None
) -> Iterator[LeakageLimit]:
    """Bore in mm."""
    if gas:
        limit = _class_six(bore)
        if limit is not None:
            yield LeakageLimit("FCI 70-2", "VI", limit)
        yield LeakageLimit("FCI 70-2", "V", _FCI_V_GAS * bore * 1e-3)
    elif pressure_drop is not None:
        yield LeakageLimit("FCI 70-2", "V", _FCI_V_LIQUID * bore * 1e-3 * pressure_drop)
    if rated_capacity is not None:
        for name, share in _FCI_SHARES:
            yield LeakageLimit("FCI 70-2", name, share * rated_capacity)


def _class_six(bore: float) -> float | None:
    """Bore in mm."""
    table = _DATA["class_six_of_fci"]
    rates: dict[float, float] = dict(zip(table["diameter"], table["rate"], strict=True))
    nearest = min(rates, key=lambda size: abs(size - bore))
    if abs(nearest - bore) <= _FCI_VI_NEAR or bore < min(rates):
        return rates[nearest] * 1e-6 / _MINUTE
    if bore > max(rates):
        return None
    smaller, larger = max(size for size in rates if size < bore), min(size for size in rates if size > bore)
    share = (bore**2 - smaller**2) / (larger**2 - smaller**2)
    return (rates[smaller] + share * (rates[larger] - rates[smaller])) * 1e-6 / _MINUTE


STANDARD_PRESSURE = 101325.0
"""Pressure of the standard state, one atmosphere [Pa]."""
STANDARD_TEMPERATURE = 273.15
"""Temperature of the standard state, 0 degC (DIN 1343, ISO 10780; "sccm", "standard ml/min") [K]."""
DROP_VOLUME = 1e-6 / 16.0
"""One drop of liquid: 16 drops are one millilitre (API 598, table of closure tests, note a) [m^3]."""
BUBBLE_VOLUME = STANDARDS["FCI 70-2"].bubble_volume
"""One bubble of gas from a tube of 6 mm: 0.15 ml (FCI 70-2, class VI); other standards have others [m^3]."""


def millilitres_per_minute(leak_rate: float) -> float:
    """Volume flow [m^3/s] in ml/min.

    Parameters
    ----------
    leak_rate : float
        Volume flow [m^3/s].

    Examples
    --------
    >>> round(millilitres_per_minute(1e-6), 9)
    60.0
    """
    return leak_rate * 60e6


def drops_per_minute(leak_rate: float, drop_volume: float = DROP_VOLUME) -> float:
    """Volume flow of a liquid [m^3/s] in drops/min, a drop being 1/16 ml unless given [m^3].

    Parameters
    ----------
    leak_rate : float
        Volume flow of the liquid [m^3/s].
    drop_volume : float
        Of one drop [m^3]; 1/16 ml unless given.

    Examples
    --------
    >>> round(drops_per_minute(1e-6 / 60), 9)
    16.0
    """
    return leak_rate * 60.0 / drop_volume


def bubbles_per_minute(leak_rate: float, bubble_volume: float = BUBBLE_VOLUME) -> float:
    """Volume flow of a gas [m^3/s] in bubbles/min, a bubble being 0.15 ml unless given [m^3].

    Parameters
    ----------
    leak_rate : float
        Volume flow of the gas [m^3/s].
    bubble_volume : float
        Of one bubble [m^3]; 0.15 ml unless given.

    Examples
    --------
    >>> import leak
    >>> print(f"{leak.bubbles_per_minute(1e-9):.2f}")
    0.40
    """
    return leak_rate * 60.0 / bubble_volume


def millibar_litres_per_second(throughput: float) -> float:
    """Throughput of a gas [Pa m^3/s] in mbar l/s.

    Parameters
    ----------
    throughput : float
        Pressure times volume flow [Pa m^3/s].

    Examples
    --------
    >>> millibar_litres_per_second(1.0)
    10.0
    """
    return throughput * 10.0
