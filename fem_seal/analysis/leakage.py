"""Leak rates as a leak-testing engineer reads them: units, drops or bubbles, leakage classes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from fem_seal.analysis.problem import flow_of
from fem_seal.units import quantity

if TYPE_CHECKING:
    from fem_seal.analysis.results import LoadResult
    from fem_seal.case.case import Case
    from leak import LeakageClass


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

    flow, size = flow_of(case), nominal_size(case)
    assert flow is not None  # there is a leak rate
    return Leakage(
        fluid_pressure,
        leak_rate,
        flow.mass_flow(leak_rate),
        flow.throughput(leak_rate),
        flow.standard_leak_rate(leak_rate),
        leakage_class(
            leak_rate,
            size.size,
            gas=flow.gas is not None,
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
