"""What the report says in words: the result, why it came out so, and what the words mean."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from fem_seal.caution import Level, Validity
from fem_seal.leakage import classes_in_words, in_words, leakage_of, nominal_size
from fem_seal.load_names import load_values
from fem_seal.readable import flow, number, percent, quantity, quantity_worth, unit_for, worth
from fem_seal.report_plastic import imprint_in_words, what_yielded
from fem_seal.report_valve import TARGET_FORCE, opens_at, valve_facts, what_opens
from fem_seal.validity import FLUID_OPENS
from fem_seal.yielding import PlasticZone, yielding_of

if TYPE_CHECKING:
    from fem_seal.derived import Derived
    from fem_seal.leakage import Leakage, NominalSize
    from fem_seal.results import LoadResult, SealResult

# Share of the pressure drop whose place is called the seal proper: its middle 80 %.
_MIDDLE = (0.1, 0.9)


@dataclass(frozen=True)
class Fact:
    """A number with its name, as the report shows it at the top.

    Parameters
    ----------
    name, value, remark : str
    level : Level
        How far the number can be trusted.
    """

    name: str
    value: str
    remark: str = ""
    level: Level = Level.VALID


def highest_load(result: SealResult) -> LoadResult:
    """The load that the report explains in detail: the one with the highest fluid pressure."""
    return max(result.loads, key=lambda load: (load.fluid_pressure, load.line_load))


def facts(result: SealResult) -> list[Fact]:
    """The result in a few numbers, at the highest load, each with the level of its validity."""
    load = highest_load(result)
    of_target = load.target_validity or load.validity
    return [
        replace(fact, level=(of_target if fact.name == TARGET_FORCE else load.validity).level)
        for fact in _facts(result, load)
    ]


def _facts(result: SealResult, load: LoadResult) -> list[Fact]:
    profile = load.contact.profile
    found = [
        *(Fact(*told) for told in valve_facts(result, load)),
        Fact("Peak contact pressure", _peak(load)),
        Fact(
            "Width of the contact",
            quantity("length", profile.fwhm),
            "full width at half of the peak pressure",
        ),
    ]
    if load.critical_separation is not None:
        closed = "zero, as calculated" if load.validity.outside else "sealed"
        narrow = closed if load.critical_separation == 0 else quantity("length", load.critical_separation)
        found.append(
            Fact("Narrowest place on the leak path", narrow, "critical separation at the peak pressure")
        )
    found.append(
        Fact(
            "Largest stress in the bodies",
            quantity("contact pressure", load.max_von_mises),
            f"von Mises, in the {load.max_von_mises_at[0]}",
        )
    )
    if imprint := imprint_in_words(result):
        found.append(Fact("Lasting imprint", *imprint))
    if load.leak is not None:
        rate = load.leak.leak_rate
        told = flow(rate, load.digits, claimed=not load.validity.outside)
        found.insert(0, Fact("Leak rate", told, per_day(rate, load.digits)))
        read = leakage_of(result.case, load)
        assert read is not None  # a leak rate has its units
        if load.leak.leak_rate > 0:
            # the first of these units may be the one that stands there already
            others = [
                part for part in in_words(read, min(load.digits, 3)).split(" = ") if part != found[0].value
            ]
            found.insert(1, Fact("In other units", others[0], " = ".join(others[1:])))
        found.append(_class_fact(nominal_size(result.case), read))
    if result.uncertainty is not None:
        found.insert(1, _interval_fact(result, load))
    return found


def _class_fact(size: NominalSize, read: Leakage) -> Fact:
    """The best class, or that none can be claimed."""
    name = f"Leakage class, DN {1e3 * size.size:.4g}"
    if not read.classes:
        return Fact(name, "not claimed", "the leak rate is outside the theory")
    best = next((one for one in read.classes if one.name), read.classes[0])
    return Fact(name, str(best), f"{classes_in_words(read)}; {size}")


def _interval_fact(result: SealResult, load: LoadResult) -> Fact:
    assert result.uncertainty is not None
    n = result.loads.index(load)
    low, high = float(result.uncertainty.low[n]), float(result.uncertainty.high[n])
    unit = unit_for("flow", high)
    return Fact(
        f"{percent(result.uncertainty.confidence)} interval of the leak rate",
        f"{number(unit.of(low), 2)} to {number(unit.of(high), 2)} {unit.name}",
        "from the uncertain inputs",
    )


def per_day(leak_rate: float, digits: int = 2) -> str:
    """A leak rate as what collects in a day, with two digits at most."""
    litres = leak_rate * 86400e3
    for unit, size in (("m³", 1e3), ("litres", 1.0), ("ml", 1e-3), ("µl", 1e-6)):
        if litres >= size:
            return f"{worth(litres / size, 1) if digits < 2 else number(litres / size, 2)} {unit} per day"
    return "" if leak_rate == 0 else "less than 1 µl per day"


def headline(result: SealResult) -> str:
    """The answer in one or two sentences."""
    opens = {opens_at(load) for load in result.loads}
    (only,) = opens if len(opens) == 1 else (None,)
    return _what_leaks(result) + (f" It opens at {only}." if only else "") + _how_sure(result)


def _how_sure(result: SealResult) -> str:
    """Which loads are outside the theory and which doubtful, a sentence for the headline; empty if all are valid."""
    told = []
    for level in (Level.OUTSIDE, Level.DOUBTFUL):
        found = [load for load in result.loads if load.validity.level is level]
        if found:
            highest = max(found, key=lambda load: load.point)
            at = "" if len(result.loads) == 1 else f" at {_named(found, result.loads)}"
            told.append(f"{level}{at} ({_why(highest.validity)})")
    return f" The result is {', '.join(told)}." if told else ""


def _named(loads: Sequence[LoadResult], among: Sequence[LoadResult]) -> str:
    """A few loads by their names, of more the number."""
    if len(loads) == len(among):
        return "every load"
    if len(loads) > 3:
        return f"{len(loads)} of {len(among)} loads"
    return ", ".join(load_values(load, among) for load in loads)


def _why(validity: Validity) -> str:
    """The worst reason, and how many there are besides."""
    others = len(validity.reasons) - 1
    more = f" and {others} more {'reason' if others == 1 else 'reasons'}" if others else ""
    return validity.reasons[0] + more


def _what_leaks(result: SealResult) -> str:
    loads = result.loads
    highest = max(loads, key=lambda load: load.point)
    last = loads[-1]
    # a body that yields is another one after the highest load
    changed = result.unloaded is not None and last.point != highest.point
    lowest = min(loads[: loads.index(highest) + 1] if changed else loads, key=lambda load: load.point)
    shown = [highest] if lowest is highest else [lowest, highest]
    if changed:
        shown.append(last)
    span = load_values(highest, loads)
    rates = [load.leak.leak_rate for load in shown if load.leak is not None]
    if not rates:
        missing = "roughness" if result.surface is None else "fluid"
        then = f"; after {span}, {_contact(last)} at {load_values(last, loads)}" if changed else ""
        return f"At {span} the contact is {_contact(highest)}{then}. No leak rate: the case has no {missing}."
    if all(load.validity.outside for load in shown):
        # nothing may be claimed of them
        return f"At {span} no leak rate can be claimed."
    if all(load.leak and load.leak.leak_rate == 0 and not load.validity.outside for load in loads):
        return f"Sealed at every load up to {span}: so much of the nominal area touches that no leak path is open."
    told = [
        ("at an unknown rate" if load.validity.outside else _flow_beside(rate, rates, min(load.digits, 3)))
        + f" at {load_values(load, loads)}"
        for rate, load in zip(rates, shown, strict=True)
    ]
    then = f"; after {span}, {told.pop()}" if changed else ""
    return f"The seal leaks {' and '.join(told)}{then}."


def _contact(load: LoadResult) -> str:
    profile = load.contact.profile
    return f"{quantity('length', profile.fwhm)} wide under {_peak(load)} peak pressure"


def _peak(load: LoadResult) -> str:
    return quantity_worth("contact pressure", load.contact.profile.peak_pressure, load.digits)


def _flow_beside(leak_rate: float, others: Sequence[float], digits: int) -> str:
    """A leak rate in a unit that suits others too, as long as it stays readable."""
    unit = unit_for("flow", max(others))
    shown = unit.of(leak_rate)
    return flow(leak_rate, digits) if shown < 0.01 else f"{worth(shown, digits)} {unit.name}"


def reasons(result: SealResult, derived: Derived) -> list[str]:
    """Why the result came out so: what sets the contact and what throttles the flow."""
    load = highest_load(result)
    return [
        *_what_sets_the_width(result, derived, load),
        *what_yielded(result, load),
        *what_opens(result, load),
        *_what_throttles(load),
        *_what_yields(result, load),
    ]


def _what_sets_the_width(result: SealResult, derived: Derived, load: LoadResult) -> Iterator[str]:
    hertz = derived.loads[result.loads.index(load)].hertz
    profile = load.contact.profile
    if hertz is None:
        yield (
            "The faces fit each other along a stretch, so its width and its edges set the contact: it is "
            f"{_contact(load)}."
        )
        return
    expected = (
        f"the pressure would peak at {quantity('contact pressure', hertz.peak_pressure)} and be "
        f"{quantity('length', hertz.fwhm)} wide at half of that"
    )
    found = f"it peaks at {_peak(load)} and is {quantity('length', profile.fwhm)} wide"
    smooth = result.case.interface.law == "smooth"
    if any(isinstance(zone, PlasticZone) for zone in yielding_of(load.contact).values()):
        why = "yielding" if smooth else "roughness and yielding"
        yield f"Between smooth elastic bodies {expected}; with {why} {found}."
        return
    bulk = min((hertz.std / profile.std) ** 2, 1.0)
    if smooth:
        yield (
            "The surfaces are smooth, so the elasticity of the bodies alone sets the contact; Hertz' line contact "
            f"gives {quantity('contact pressure', hertz.peak_pressure)} peak pressure, the calculation "
            f"{_peak(load)}."
        )
        return
    if bulk < 0.25:
        dominant = "The roughness, not the elasticity of the bodies, sets the width of the contact"
    elif bulk > 0.75:
        dominant = "The elasticity of the bodies, not the roughness, sets the width of the contact"
    else:
        dominant = "Roughness and elasticity of the bodies both set the width of the contact"
    yield f"{dominant}: between perfectly smooth bodies {expected}, between the rough ones {found}."


def _what_throttles(load: LoadResult) -> Iterator[str]:
    from leak import CoupledLeakResult

    if load.leak is None or load.leak.leak_rate == 0:
        return
    if not math.isfinite(load.leak.leak_rate):
        yield "The fluid pressure is not below the peak contact pressure: it lifts the seal open everywhere."
        return
    x, share = load.contact.profile.x, load.leak.fluid_pressure / load.fluid_pressure
    rising = share if share[-1] > share[0] else 1 - share
    ends = np.interp(_MIDDLE, rising, x)
    yield (
        f"{percent(_MIDDLE[1] - _MIDDLE[0])} of the pressure drop falls over the middle "
        f"{quantity('length', float(ends[1] - ends[0]))} of the contact: this strip is the seal proper."
    )
    ratio = load.fluid_pressure / load.contact.profile.peak_pressure
    if isinstance(load.leak, CoupledLeakResult):
        yield (
            f"The fluid pressure is {percent(ratio)} of the peak contact pressure. That it carries part of the load "
            "and opens the gap is taken into account, place by place."
        )
    elif load.effective_radius is not None:
        yield (
            f"The fluid pressure is {percent(ratio)} of the peak contact pressure. That it acts between the surfaces, "
            "too, and opens the gap is solved together with contact and flow."
        )
    elif ratio > FLUID_OPENS:
        yield (
            f"The fluid pressure is {percent(ratio)} of the peak contact pressure. It helps to open the gap, which "
            "this calculation does not take into account: expect a larger leak rate."
        )
    else:
        yield (
            f"The fluid pressure is {percent(ratio)} of the peak contact pressure; that it pushes the surfaces apart "
            "is neglected."
        )


def _what_yields(result: SealResult, load: LoadResult) -> Iterator[str]:
    surface = result.surface
    if surface is None:
        return
    peak = load.contact.profile.peak_pressure
    if surface.hardness is None:
        if load.leak is not None:
            yield "Asperities are taken as elastic. If they yield, the surfaces come closer and less leaks."
        return
    area = float(surface.contact_area(peak))
    yielded = float(surface.plastic_area(peak)) / area
    share = "nearly all" if yielded > 0.999 else "next to nothing" if yielded < 1e-3 else percent(yielded)
    text = f"{percent(area)} of the nominal area really touches at the peak pressure, and {share} of that has yielded"
    if load.leak is not None and load.leak_elastic is not None and load.leak.leak_rate > 0:
        factor = load.leak_elastic.leak_rate / load.leak.leak_rate
        text += f"; with asperities that never yield {number(factor, 2)} times as much would leak"
    yield text + "."


DEFINITIONS = (
    (
        "contact pressure p",
        "pressure between the bodies, averaged over many asperities, positive in compression",
    ),
    ("x", "arc length across the sealing line, zero where the bodies first touch, positive outwards"),
    ("peak pressure", "largest nominal contact pressure over x"),
    ("FWHM", "full width of the pressure profile at half of its peak"),
    ("standard deviation", "square root of the second central moment of p over x"),
    ("line load", "force per circumference normal to the contact, F_N / (2π r₀ cos θ)"),
    ("gap u", "mean separation of the surfaces, measured between their mean planes"),
    (
        "u_c",
        "critical separation: height of the narrowest place on the first open leak path, at the peak pressure",
    ),
    (
        "magnification",
        "wavenumber up to which roughness is seen, over the smallest wavenumber of the spectrum",
    ),
    (
        "yielded area A_pl",
        "area of real contact in which the asperities carry the hardness; A_el: the elastic rest",
    ),
    ("elastic columns", "the same contact with asperities that never yield"),
    ("leak rate", "volume per time through the whole circumference, all fluid pressures as differences"),
    (
        "discretisation error",
        "error of the mesh alone: upper estimate from the load with the largest closing force, solved again on a mesh "
        "twice as coarse; shape, supports, roughness and the theory itself it cannot see",
    ),
)
