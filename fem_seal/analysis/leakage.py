"""Leakage classes of leak rates, and the nominal size that they refer to."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from fem_seal.units import quantity

if TYPE_CHECKING:
    from fem_seal.analysis.results import LoadResult
    from fem_seal.case.case import Case
    from leak import LeakageClass


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


@dataclass(frozen=True)
class NextClass:
    """The class that is next to be met.

    Parameters
    ----------
    standard, name : str
    factor : float
        By which the leak rate would have to be smaller.
    """

    standard: str
    name: str
    factor: float


def next_class(case: Case, load: LoadResult, ends: tuple[float, float] | None = None) -> NextClass | None:
    """The loosest class, of the first standard that has several, which the upper end of a leak rate does not meet.

    None without a leak rate, outside the theory, and where the seal is open or meets them all.

    Parameters
    ----------
    case : Case
    load : LoadResult
    ends : tuple of float, optional
        See `leakage_classes`.
    """
    from leak import leakage_limits

    if load.leak is None or load.validity.outside:
        return None
    _, high = ends or load.leak_range or (0.0, load.leak.leak_rate)
    gas = load.leak.throughput is not None
    limits = leakage_limits(nominal_size(case).size, gas=gas)
    missed = [one for one in limits if one.standard == limits[0].standard and 0 < one.leak_rate < high]
    if not missed or math.isinf(high):
        return None
    closest = max(missed, key=lambda one: one.leak_rate)
    return NextClass(closest.standard, closest.name, high / closest.leak_rate)


def leakage_classes(
    case: Case, load: LoadResult, ends: tuple[float, float] | None = None
) -> tuple[LeakageClass, ...]:
    """The tightest class of each standard that a load meets; empty without a leak rate, and outside the theory.

    Parameters
    ----------
    case : Case
    load : LoadResult
    ends : tuple of float, optional
        Of the leak rate's interval [m^3/s], both of which have to meet a class; those of both readings of yielding
        asperities unless given.
    """
    from leak import leakage_class

    if load.leak is None or load.validity.outside:
        return ()
    size = nominal_size(case)
    low, high = ends or load.leak_range or (load.leak.leak_rate, load.leak.leak_rate)
    return leakage_class(
        low,
        size.size,
        gas=load.leak.throughput is not None,
        pressure_drop=load.fluid_pressure,
        seat_diameter=size.diameter,
        highest=high,
    )
