"""Leak rates as a leak-testing engineer reads them: units, drops or bubbles, leakage classes."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from fem_seal.caution import Level
from fem_seal.readable import given, quantity, worth

if TYPE_CHECKING:
    from fem_seal.case import Case
    from fem_seal.results import LoadResult, SealResult
    from leak import LeakageClass
    from leak.leakage_class import Standard

_ATMOSPHERE = 101325.0


@dataclass(frozen=True)
class Leakage:
    """One leak rate in other units, SI, and its classes.

    Parameters
    ----------
    fluid_pressure : float
        Pressure difference [Pa].
    leak_rate : float
        Volume flow; of a gas at 101325 Pa and its temperature [m^3/s].
    mass_flow : float or None
        [kg/s]; None if the density is unknown.
    throughput : float or None
        pV flow of a gas [Pa m^3/s]; None for a liquid.
    standard_leak_rate : float or None
        Volume flow of a gas at 0 degC and 101325 Pa [m^3/s]; None for a liquid.
    classes : tuple of LeakageClass
        The tightest class of each standard that it meets; empty outside the theory, where none can be claimed.
    """

    fluid_pressure: float
    leak_rate: float
    mass_flow: float | None
    throughput: float | None
    standard_leak_rate: float | None
    classes: tuple[LeakageClass, ...]


@dataclass(frozen=True)
class NominalSize:
    """Nominal size that the classes refer to.

    Parameters
    ----------
    size : float
        DN as a length [m].
    diameter : float
        Bore of the seat, or the circle of first touch where no bore is given [m].
    circle : str
        Which of the two it is, in words.
    estimated : bool
        Whether the size was taken from the diameter.
    """

    size: float
    diameter: float
    circle: str
    estimated: bool

    def __str__(self) -> str:
        """The size in words."""
        text = f"DN {1e3 * self.size:.4g}"
        return (
            f"{text}, estimated from the {self.circle}, {quantity('length', self.diameter)} in diameter"
            if self.estimated
            else text
        )


def nominal_size(case: Case) -> NominalSize:
    """The case's own nominal size, or the one nearest to the bore of the seat.

    Parameters
    ----------
    case : Case
    """
    from leak import nominal_size_of_bore

    bore = getattr(case.seat, "bore_radius", None)
    diameter = 2.0 * (case.touch_radius if bore is None else bore)
    circle = "circle of first touch" if bore is None else "bore of the seat"
    if case.leak.nominal_size is not None:
        return NominalSize(case.leak.nominal_size, diameter, circle, False)
    return NominalSize(nominal_size_of_bore(diameter), diameter, circle, True)


def leakage(case: Case, fluid_pressure: float, leak_rate: float, *, claimed: bool = True) -> Leakage:
    """A leak rate in the units of leak testing, with its classes.

    Parameters
    ----------
    case : Case
        With a fluid.
    fluid_pressure : float
        Pressure difference [Pa].
    leak_rate : float
        As in `leak_rate_m3_per_s` of leak.csv [m^3/s].
    claimed : bool
        Whether classes may be claimed, which they may not outside the theory.
    """
    from leak import leakage_class

    assert case.fluid is not None
    gas, density, size = case.fluid.gas, case.fluid.density, nominal_size(case)
    return Leakage(
        fluid_pressure,
        leak_rate,
        None if density is None else leak_rate * density,
        None if gas is None else leak_rate * _ATMOSPHERE,
        None if gas is None else leak_rate * 273.15 / gas.temperature,
        leakage_class(
            leak_rate,
            size.size,
            gas=gas is not None,
            pressure_drop=fluid_pressure,
            seat_diameter=size.diameter,
        )
        if claimed
        else (),
    )


def leakage_of(case: Case, load: LoadResult) -> Leakage | None:
    """The leak rate of a load in other units, with its classes unless it is outside the theory; None without one.

    Parameters
    ----------
    case : Case
    load : LoadResult
    """
    if load.leak is None or case.fluid is None:
        return None
    return leakage(case, load.fluid_pressure, load.leak.leak_rate, claimed=not load.validity.outside)


def leakage_table(result: SealResult) -> list[dict[str, Any]]:
    """Units and classes of all loads as plain numbers and texts; empty without a leak rate.

    A load outside the theory has no classes.
    """
    case = result.case
    return [
        {
            **asdict(found),
            "nominal_size": nominal_size(case).size,
            "classes": {one.standard: one.name for one in found.classes},
            "validity": str(load.validity.level),
        }
        for load in result.loads
        for found in (leakage_of(case, load),)
        if found is not None
    ]


def standards_used(result: SealResult) -> list[Standard]:
    """The standards that the leak rates are classed by."""
    from leak.leakage_class import STANDARDS

    names = dict.fromkeys(
        one.standard
        for load in result.loads
        for found in (leakage_of(result.case, load),)
        for one in (() if found is None else found.classes)
    )
    return [STANDARDS[name] for name in names]


def in_words(found: Leakage, digits: int = 3) -> str:
    """The leak rate in the units of its kind: "1.2 ml/min = 19 drops/min = 20 mg/s"."""
    from leak import drops_per_minute, millibar_litres_per_second, millilitres_per_minute

    if found.throughput is not None and found.standard_leak_rate is not None:
        parts = [
            f"{worth(millibar_litres_per_second(found.throughput), digits)} mbar l/s",
            f"{worth(found.throughput, digits)} Pa m³/s",
            f"{worth(millilitres_per_minute(found.standard_leak_rate), digits)} standard ml/min (0 °C, 1.01325 bar)",
        ]
    else:
        parts = [
            f"{worth(millilitres_per_minute(found.leak_rate), digits)} ml/min",
            f"{worth(drops_per_minute(found.leak_rate), digits)} drops/min",
        ]
    if found.mass_flow is not None:
        parts.append(f"{worth(found.mass_flow, digits)} kg/s")
    return " = ".join(parts)


def classes_in_words(found: Leakage) -> str:
    """The classes: "ISO 5208 B, FCI 70-2 V; API 598: no class met"; "not claimed" outside the theory."""
    if not found.classes:
        return "not claimed"
    met = [str(one) for one in found.classes if one.name]
    missed = [str(one) for one in found.classes if not one.name]
    return "; ".join([*([", ".join(met)] if met else []), *missed])


def leakage_lines(
    case: Case,
    fluid_pressure: float,
    leak_rate: float,
    applied_force: float | None = None,
    *,
    digits: int = 3,
    level: str = Level.VALID,
    reason: str = "",
) -> list[str]:
    """Two lines for the command line about one load.

    Parameters
    ----------
    case : Case
    fluid_pressure, leak_rate : float
        [Pa], [m^3/s].
    applied_force : float, optional
        [N], where the force tells the load from others.
    level, reason : str
        How far the leak rate can be trusted, and why no further.
    """
    outside = level == Level.OUTSIDE
    found = leakage(case, fluid_pressure, leak_rate, claimed=not outside)
    at = given("fluid pressure", fluid_pressure)
    if applied_force is not None:
        at = f"{at} with {given('force', applied_force)}"
    doubt = f" ({level}: {reason})" if reason else ""
    why = ", because the leak rate is outside the theory" if outside else ""
    return [
        f"Leak rate at {at}: {in_words(found, digits)}{doubt}",
        f"Leakage class for {nominal_size(case)}: {classes_in_words(found)}{why}",
    ]
