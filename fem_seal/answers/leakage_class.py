"""Leakage classes of leak rates, the nominal size that they refer to, and the limits that a requirement sets."""

from __future__ import annotations

import math
from dataclasses import dataclass
from statistics import fmean

from fem_seal.answers.case_load import CaseLoad
from fem_seal.answers.judgement import Limit
from fem_seal.case.case import Case
from fem_seal.case.fields import Bubbles
from fem_seal.case.fluid import Fluid
from fem_seal.case.tables import RELIEF, Requirement
from fem_seal.errors import Text, write
from fem_seal.seal.scenarios import ROOM_TEMPERATURE, TEST_GAS, TEST_GASES, TEST_TEMPERATURES, gas_of_test
from fem_seal.units import LIQUID, Display, LeakVolume
from fem_seal.wording import Quantity, Words
from leak import LeakageClass
from leak.standards import STANDARD_PRESSURE

# Standards whose limits are per length of the seal.
PER_LENGTH = frozenset({"VDI 2440", "EN 13555", "ISO 15848-1"})
# What the standards test with: liquids no thicker than water.
_TEST_LIQUID = "water"


def volume_of(case: Case) -> LeakVolume:
    """What a volume is that leaks: of a gas its state.

    Parameters
    ----------
    case : Case
    """
    return LIQUID if case.fluid is None else case.fluid.volume


@dataclass(frozen=True)
class NominalSize(Text):
    """Nominal size that the classes refer to.

    Parameters
    ----------
    size : float
        DN as a length [m].
    diameter : float
        Bore of the seat, or the circle of first touch where no bore is given [m].
    circle : str
        Which of the two it is, in words.
    is_estimated : bool
        Whether the size was taken from the diameter.
    case_text : str
        The size as the case has it, where that is a number of a list other than DN: "NPS 2".
    """

    size: float
    diameter: float
    circle: str
    is_estimated: bool
    case_text: str = ""

    @property
    def short_text(self) -> str | Quantity:
        """The size alone, as the case has it; DN of a whole number of millimetres."""
        is_whole = math.isclose(1e3 * self.size, round(1e3 * self.size), rel_tol=1e-6)
        return self.case_text or (f"DN {1e3 * self.size:.4g}" if is_whole else Quantity(self.size, "length"))

    def text(self, display: Display | None = None) -> str:
        """The size in words."""
        short = write(self.short_text, display)
        if not self.is_estimated:
            return short
        diameter = Quantity(self.diameter, "length").text(display)
        return f"{short}, estimated from the {self.circle}, {diameter} in diameter"


def nominal_size(case: Case) -> NominalSize:
    """The case's own nominal size, or the one nearest to the bore of the seat.

    Parameters
    ----------
    case : Case
    """
    from leak import nominal_size_of_bore

    # of two different flanges the narrower one, whichever of them is above
    name = "closure" if case.gasket else "seat"
    bores = [getattr(body.table, "bore_radius", None) for body in case.every_body if body.name == name]
    bore = min((radius for radius in bores if radius is not None), default=None)
    diameter = 2.0 * (min(_touch_radii(case)) if bore is None else bore)
    of = "bore of the seat" if case.gasket is None else "bore of the flange"
    of = of if case.has_shapes else "inner edge of the contact"
    circle = "circle of first touch" if bore is None else of
    if case.leak.nominal_size is not None:
        text = str(case.written.get("leak", {}).get("nominal_size", "")).strip().upper()
        case_text = text if text.startswith("NPS") else ""
        return NominalSize(case.leak.nominal_size, diameter, circle, False, case_text)
    return NominalSize(nominal_size_of_bore(diameter), diameter, circle, True)


def fluid_of_test(fluid: Fluid, pressure: float) -> tuple[str, tuple[float, float]]:
    """The fluid of the test, where it is another one, and its leak rate over that of the case, least and most.

    A liquid leaks in inverse proportion to its viscosity under that pressure; one that is no thicker than water may be
    the test's own, and so may water at any temperature of a test. Of gases it is what any gap may have
    (`leak.flow.rarefied.flow_ratio_range`); once the contact is known see `test_of`.

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
    from leak import effective_viscosity_ratio, liquid
    from leak.flow.rarefied import flow_ratio_range

    gas = fluid.gas
    if gas is None:
        own_viscosity, test_viscosity = (
            medium.viscosity * effective_viscosity_ratio(medium.pressure_law, pressure)
            for medium in (fluid, liquid(_TEST_LIQUID, ROOM_TEMPERATURE))
        )
        ratio = own_viscosity / test_viscosity
        coldest = liquid(_TEST_LIQUID, TEST_TEMPERATURES[0]).viscosity
        water = fluid.name.lower() == _TEST_LIQUID and fluid.viscosity <= coldest
        return ("", (1.0, 1.0)) if ratio <= 1.0 or water else (_TEST_LIQUID, (ratio, ratio))
    of_test = gas_of_test(fluid.name, gas)
    return ("", (1.0, 1.0)) if of_test is gas else (TEST_GASES[0], flow_ratio_range(of_test, gas))


def test_of(fluid: Fluid, pressure: float, load: CaseLoad | None = None) -> tuple[str, tuple[float, float]]:
    """`fluid_of_test`, of a gas with the ratios that a contact has at both ends of its leak rate's interval.

    Another gas is let through the same contact, in every reading and sample, so that the flow is as rarefied as it is.

    Parameters
    ----------
    fluid : Fluid
    pressure : float
        That drives the leak [Pa].
    load : CaseLoad, optional
        Without it the ratios are those that any gap may have.
    """
    name, widest = fluid_of_test(fluid, pressure)
    if not name or fluid.gas is None or load is None:
        return name, widest
    of_test = load.load_in_scenario(TEST_GAS)
    interval, test_interval = load.leak_interval, None if of_test is None else of_test.leak_interval
    if interval is None or test_interval is None:
        return name, widest
    # what is sealed is so for both
    ratios = [rate / end for rate, end in zip(test_interval, interval, strict=True) if 0.0 < end < math.inf]
    return name, (ratios[0], ratios[-1]) if ratios else (1.0, 1.0)


def in_the_test(case: Case, load: CaseLoad) -> tuple[float, float]:
    """Ends of a load's leak rate, see `LoadResult.leak_interval`, for the fluid of the standards' tests [m^3/s].

    Parameters
    ----------
    case : Case
    load : CaseLoad
        With a leak rate.
    """
    assert load.leak_interval is not None and case.fluid is not None
    low, high = load.leak_interval
    _, (least, most) = test_of(case.fluid, load.fluid_pressure, load)
    return low * least, high * most


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


def next_class(case: Case, load: CaseLoad) -> NextClass | None:
    """The loosest class, of the first standard that has several, which the upper end of a leak rate does not meet.

    None without a leak rate, outside the theory, and where the seal is open or meets them all.

    Parameters
    ----------
    case : Case
    load : CaseLoad
    """
    from leak import leakage_limits

    if load.leak is None or load.leak_interval is None or load.validity.outside_theory:
        return None
    size, gas = nominal_size(case).size, load.leak.throughput is not None
    per_length = _per_length(case) if is_flange(case) else {}
    high = load.leak_interval[1] if per_length else in_the_test(case, load)[1]
    limits = leakage_limits(size, gas=gas, bubble_volume=_bubble_volume(case), **per_length)
    standard = "EN 13555" if per_length else limits[0].standard
    classes = [entry for entry in limits if entry.standard == standard and 0 < entry.leak_rate < high]
    if not classes or math.isinf(high):
        return None
    closest = max(classes, key=lambda entry: entry.leak_rate)
    assert load.calculated_ends is not None  # of a leak rate
    share = load.calculated_ends.high / load.leak_interval.high
    return NextClass(
        closest.standard, closest.name, high / closest.leak_rate, share * high <= closest.leak_rate
    )


def leakage_classes(case: Case, load: CaseLoad) -> tuple[LeakageClass, ...]:
    """The tightest class of each standard that a load meets; empty without a leak rate, and outside the theory.

    Both ends of the leak rate's interval have to meet a class, and its limits stand for the fluid of the standard's
    test (`in_the_test`).

    Parameters
    ----------
    case : Case
    load : CaseLoad
    """
    from leak import leakage_class
    from leak.standards import class_per_length

    if load.leak is None or load.leak_interval is None or load.validity.outside_theory:
        return ()
    if is_flange(case):
        ends = load.leak_interval
        return class_per_length(ends[0], **_per_length(case), highest=ends[1])
    size = nominal_size(case)
    low, high = in_the_test(case, load)
    return leakage_class(
        low,
        size.size,
        gas=load.leak.throughput is not None,
        pressure_drop=load.fluid_pressure,
        seat_diameter=size.diameter,
        bubble_volume=_bubble_volume(case),
        highest=high,
    )


def is_flange(case: Case) -> bool:
    """Whether a seal is judged per length as a flange joint: it has bolts or a gasket, and gas leaks.

    Parameters
    ----------
    case : Case
    """
    joint = case.bolts is not None or case.gasket is not None
    return joint and case.fluid is not None and case.fluid.gas is not None


def class_size(case: Case, *, per_length: bool | None = None) -> tuple[str | Text, Text]:
    """What the classes of a case refer to, in short and in words: its nominal size, or the length of its seal.

    Parameters
    ----------
    case : Case
    per_length : bool, optional
        Whether they are classes per length; those of a flange joint are unless given.
    """
    if is_flange(case) if per_length is None else per_length:
        length = Words("{{ length | quantity('length') }} of seal", {"length": seal_length(case)})
        return length, length
    size = nominal_size(case)
    return size.short_text, size


def seal_length(case: Case) -> float:
    """Circumference of the circle of first touch, to which leak rates per length refer [m].

    Of two different faces of a gasket the mean.

    Parameters
    ----------
    case : Case
    """
    return 2.0 * math.pi * fmean(_touch_radii(case))


def _touch_radii(case: Case) -> list[float]:
    return [contact.initial_contact_radius for contact in case.contacts]


def _per_length(case: Case) -> dict[str, float]:
    """Length and density of the classes per length."""
    gas = None if case.fluid is None else case.fluid.gas
    values = {"seal_length": seal_length(case)}
    return values if gas is None else {**values, "density": gas.density(STANDARD_PRESSURE)}


def _bubble_volume(case: Case) -> float | None:
    return None if case.requirement is None else case.requirement.bubble_volume


OF_LEAK_RATE = "leak rate"


def limits(case: Case, fluid_pressure: float, load: CaseLoad | None = None) -> tuple[Limit, ...]:
    """The limits that a case's requirement sets at a fluid pressure; empty without a requirement.

    Parameters
    ----------
    case : Case
    fluid_pressure : float
        [Pa]
    load : CaseLoad, optional
        The load that is judged, whose contact says what a test with another fluid would find; without it the limits
        hold for any gap.
    """
    requirement = case.requirement
    if requirement is None or case.fluid is None:
        return ()
    of_rate = () if requirement.leak_rate is None else (limit_of_rate(requirement.leak_rate),)
    of_class = _of_class(case, requirement, case.fluid, fluid_pressure, load)
    return of_rate if of_class is None else (*of_rate, of_class)


def limit_of_rate(leak_rate: float) -> Limit:
    """A largest leak rate [m^3/s] as it was written."""
    volume = leak_rate.volume if isinstance(leak_rate, Bubbles) else None
    return Limit(OF_LEAK_RATE, leak_rate, bubble_volume=volume)


def _of_class(
    case: Case, requirement: Requirement, fluid: Fluid, fluid_pressure: float, load: CaseLoad | None
) -> Limit | None:
    from leak.standards import STANDARDS, invisible_leak_rate, leakage_limits, visible_leak_rate

    key = requirement.standard_and_class
    if key is None:
        return None
    size, gas = nominal_size(case), fluid.gas is not None
    table = leakage_limits(
        size.size,
        gas=gas,
        pressure_drop=fluid_pressure,
        seat_diameter=size.diameter,
        rated_capacity=requirement.rated_capacity,
        bubble_volume=requirement.bubble_volume,
        set_pressure=case.set_pressure,
        **_per_length(case),
    )
    rates = [limit.leak_rate for limit in table if (limit.standard, limit.name) == key]
    name = " ".join(key)
    test_fluid, ratio = test_of(fluid, fluid_pressure, load)
    if key[0] in PER_LENGTH:
        # with helium, which the fluid of the case is if it is so tested
        test_fluid, ratio = "", (1.0, 1.0)
    if not rates:
        # class VI of FCI 70-2 ends at a diameter, API 527 at a set pressure
        return Limit(name, math.nan, 0.0, test_fluid, ratio)
    rate, visible = rates[0], 0.0
    if not rate:
        rate = invisible_leak_rate(gas=gas, bubble_volume=requirement.bubble_volume)
        visible = visible_leak_rate(gas=gas, bubble_volume=requirement.bubble_volume)
    bubble = requirement.bubble_volume or STANDARDS[key[0]].bubble_volume
    counts_bubbles = gas and (visible > 0.0 or key[0] in ("API 598", RELIEF))
    return Limit(name, rate, visible, test_fluid, ratio, bubble if counts_bubbles else None)
