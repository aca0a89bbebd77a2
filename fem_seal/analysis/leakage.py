"""Leakage classes of leak rates, and the nominal size that they refer to."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from fem_seal.units import LIQUID, LeakVolume, quantity

if TYPE_CHECKING:
    from fem_seal.analysis.results import LoadResult
    from fem_seal.case.case import Case
    from fem_seal.case.fluid import Fluid
    from leak import LeakageClass

# What the standards test with: liquids no thicker than water, air or nitrogen.
_TEST_LIQUID, _TEST_GASES = "water", ("air", "nitrogen")
_ROOM = 293.15
# ... at 5 to 40 °C (ISO 5208).
_TEST_TEMPERATURES = (278.15, 313.15)


def volume_of(case: Case) -> LeakVolume:
    """What a volume is that leaks: of a gas its state.

    Parameters
    ----------
    case : Case
    """
    return LIQUID if case.fluid is None else case.fluid.volume


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


def fluid_of_test(fluid: Fluid, pressure: float) -> tuple[str, tuple[float, float]]:
    """The fluid of the test, where it is another one, and its leak rate over that of the case, least and most.

    A liquid leaks in inverse proportion to its viscosity under that pressure; one that is no thicker than water may be
    the test's own, and so may water at any temperature of a test. Of gases see `leak.flow.rarefied.flow_ratio_range`.

    Parameters
    ----------
    fluid : Fluid
    pressure : float
        That drives the leak [Pa].

    Returns
    -------
    tuple
        Its name, empty where the case's own is one of the test, and both ratios.
    """
    from leak import effective_viscosity_ratio, gas, liquid
    from leak.flow.rarefied import flow_ratio_range

    own = fluid.gas
    as_in_test = _TEST_TEMPERATURES[0] <= fluid.temperature <= _TEST_TEMPERATURES[1]
    if own is None:
        own_viscosity, tested = (
            one.viscosity * effective_viscosity_ratio(one.pressure_law, pressure)
            for one in (fluid, liquid(_TEST_LIQUID, _ROOM))
        )
        ratio = own_viscosity / tested
        coldest = liquid(_TEST_LIQUID, _TEST_TEMPERATURES[0]).viscosity
        water = fluid.name.lower() == _TEST_LIQUID and fluid.viscosity <= coldest
        return ("", (1.0, 1.0)) if ratio <= 1.0 or water else (_TEST_LIQUID, (ratio, ratio))
    if fluid.name.lower() in _TEST_GASES and as_in_test:
        return "", (1.0, 1.0)
    return _TEST_GASES[0], flow_ratio_range(gas(_TEST_GASES[0], _ROOM), own)


def in_the_test(case: Case, load: LoadResult, ends: tuple[float, float] | None = None) -> tuple[float, float]:
    """Ends of what a load leaks at least and at most, converted to the fluid of the standards' tests [m^3/s].

    That is the interval of its leak rate and what the calculation may be off by (`LoadResult.leak_validity`).

    Parameters
    ----------
    case : Case
    load : LoadResult
        With a leak rate.
    ends : tuple of float, optional
        Those of the case's own fluid; both readings of yielding asperities unless given.
    """
    assert load.leak is not None and case.fluid is not None
    low, high = ends or load.leak_range or (load.leak.leak_rate, load.leak.leak_rate)
    _, (least, most) = fluid_of_test(case.fluid, load.fluid_pressure)
    lower, upper = load.leak_validity.leak_factor
    return low * least * lower, high * most * upper


@dataclass(frozen=True)
class NextClass:
    """The class that is next to be met.

    Parameters
    ----------
    standard, name : str
    factor : float
        By which the leak rate would have to be smaller, in the fluid of the test.
    as_calculated : bool
        Whether the interval of the leak rate meets it, and only what the calculation may be off by does not.
    """

    standard: str
    name: str
    factor: float
    as_calculated: bool


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
    _, high = in_the_test(case, load, ends)
    gas = load.leak.throughput is not None
    limits = leakage_limits(nominal_size(case).size, gas=gas, bubble_volume=_bubble_volume(case))
    missed = [one for one in limits if one.standard == limits[0].standard and 0 < one.leak_rate < high]
    if not missed or math.isinf(high):
        return None
    closest = max(missed, key=lambda one: one.leak_rate)
    _, most = load.leak_validity.leak_factor
    return NextClass(
        closest.standard, closest.name, high / closest.leak_rate, high / most <= closest.leak_rate
    )


def leakage_classes(
    case: Case, load: LoadResult, ends: tuple[float, float] | None = None
) -> tuple[LeakageClass, ...]:
    """The tightest class of each standard that a load meets; empty without a leak rate, and outside the theory.

    They are judged, and their limits stand, for the fluid of the standard's test (`in_the_test`).

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
    low, high = in_the_test(case, load, ends)
    return leakage_class(
        low,
        size.size,
        gas=load.leak.throughput is not None,
        pressure_drop=load.fluid_pressure,
        seat_diameter=size.diameter,
        bubble_volume=_bubble_volume(case),
        highest=high,
    )


def _bubble_volume(case: Case) -> float | None:
    return None if case.requirement is None else case.requirement.bubble_volume
