"""Leak rates as a leak-testing engineer reads them: units, drops or bubbles, leakage classes."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from fem_seal.readable import given, quantity, worth

if TYPE_CHECKING:
    from fem_seal.case import Case
    from fem_seal.results import SealResult
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
        The tightest class of each standard that it meets.
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
    estimated : bool
        Whether the size was taken from the diameter.
    """

    size: float
    diameter: float
    estimated: bool

    def __str__(self) -> str:
        """The size in words."""
        text = f"DN {1e3 * self.size:.4g}"
        return (
            f"{text}, estimated from the seat's diameter of {quantity('length', self.diameter)}"
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
    if case.leak.nominal_size is not None:
        return NominalSize(case.leak.nominal_size, diameter, False)
    return NominalSize(nominal_size_of_bore(diameter), diameter, True)


def leakage(case: Case, fluid_pressure: float, leak_rate: float) -> Leakage:
    """A leak rate in the units of leak testing, with its classes.

    Parameters
    ----------
    case : Case
        With a fluid.
    fluid_pressure : float
        Pressure difference [Pa].
    leak_rate : float
        As in `leak_rate_m3_per_s` of leak.csv [m^3/s].
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
        ),
    )


def leakage_table(result: SealResult) -> list[dict[str, Any]]:
    """Units and classes of all loads as plain numbers and texts; empty without a leak rate."""
    case = result.case
    return [
        {
            **asdict(found),
            "nominal_size": nominal_size(case).size,
            "classes": {one.standard: one.name for one in found.classes},
        }
        for load in result.loads
        if load.leak is not None
        for found in (leakage(case, load.fluid_pressure, load.leak.leak_rate),)
    ]


def standards_used(result: SealResult) -> list[Standard]:
    """The standards that the leak rates are classed by."""
    from leak.leakage_class import STANDARDS

    load = next((load for load in result.loads if load.leak is not None), None)
    if load is None or load.leak is None:
        return []
    return [
        STANDARDS[one.standard]
        for one in leakage(result.case, load.fluid_pressure, load.leak.leak_rate).classes
    ]


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
    """The classes: "ISO 5208 B, FCI 70-2 V; API 598: no class met"."""
    met = [str(one) for one in found.classes if one.name]
    missed = [str(one) for one in found.classes if not one.name]
    return "; ".join([*([", ".join(met)] if met else []), *missed])


def leakage_lines(
    case: Case, fluid_pressure: float, leak_rate: float, applied_force: float | None = None, digits: int = 3
) -> list[str]:
    """Two lines for the command line about one load, which is named by its force as well if one is given."""
    found = leakage(case, fluid_pressure, leak_rate)
    at = given("fluid pressure", fluid_pressure)
    if applied_force is not None:
        at = f"{at} with {given('force', applied_force)}"
    return [
        f"Leak rate at {at}: {in_words(found, digits)}",
        f"Leakage class for {nominal_size(case)}: {classes_in_words(found)}",
    ]
