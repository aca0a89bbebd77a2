"""The leak rate: its interval, its class, and what throttles the flow."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from fem_seal.answers.case_load import rate_of
from fem_seal.answers.leakage_class import class_size, is_flange, leakage_classes, test_of, volume_of
from fem_seal.case.roughness import uncertain_heights
from fem_seal.errors import write
from fem_seal.output.answer_output import AnswerOutput, AnswerPage, Tile, decisive
from fem_seal.output.answers.uncertainty import told_after_test
from fem_seal.output.answers.variants import has_one_number
from fem_seal.output.columns import COLUMNS
from fem_seal.seal.findings import Bounds
from fem_seal.seal.load_result import load_values
from fem_seal.units import LIQUID, LeakVolume, digits_at_limit, format_digits, range_text
from fem_seal.validity.checks import FLUID_OPENS
from fem_seal.wording import say, say_all
from leak import CoupledLeakResult, LeakageClass, LeakResult, TurnedContact, drops_per_minute

if TYPE_CHECKING:
    from fem_seal.answers.case_load import CaseLoad
    from fem_seal.answers.solution import SealSolution
    from fem_seal.case.case import Case
    from fem_seal.units import Display

# Part of the pressure drop whose strip of the contact does the sealing: its middle 80 %.
_MIDDLE = (0.1, 0.9)


def _tiles(result: SealSolution, display: Display, load: CaseLoad) -> Iterator[Tile]:
    if load.leak is None:
        return
    case, level, outside = result.case, load.validity.level, load.validity.outside_theory
    volume = volume_of(case)
    text = display.leak_range(rate_of(load), load.leak_digits, claimed=not outside, volume=volume)
    middle, kind = "", "tested" if load.after_test else "finish" if has_finish(case) else "inputs"
    if load.sample_ends is not None and not outside:
        middle = display.leak_range(usual_rate_of(load), min(load.leak_digits, 2), volume=volume)
        text = told_after_test(display, load, volume) if load.after_test else text
    elif has_one_number(load) and (ends := separate_ends(load)) is not None:
        digits = min(load.leak_digits, 2)
        text, middle = (display.leak_range(end, digits, beside=ends, volume=volume) for end in ends)
        kind = "bound"
    at = load_values(load, result.loads, display)
    yield Tile("Leak rate", text, say(display, "leak", "rate", load=at, middle=middle, kind=kind), 0, level)
    (short, size), classes = class_size(case), leakage_classes(case, load)
    met = [str(leakage_class) for leakage_class in classes if leakage_class.name]
    best = met[0] if met else str(classes[0]) if classes else "none stated"
    remark = say(display, "leak", "classes", size=size, none_stated=not classes)
    yield Tile(
        f"Leakage class, {write(short, display)}", best, remark, 20 if result.judgement is None else 55, level
    )
    if load.leak.leak_rate > 0:
        units = leakage_text(display, load, volume).split(" = ")
        others = [amount for amount in units if amount.split(" (")[0] != text]
        if others:
            yield Tile("In other units", others[0], " = ".join(others[1:]), 95, level)
    if load.critical_separation is not None:
        value, remark = narrowest_point(display, load)
        yield Tile("Narrowest point of the leak path", value, "u_c at the peak pressure", 80, level)


def sure(case: Case, load: CaseLoad) -> str:
    """What the interval of a leak rate covers, in one line; empty for a single number.

    Parameters
    ----------
    case : Case
    load : CaseLoad
    """
    ends, least, most = rate_of(load), *load.leak_validity.leak_factor
    if load.leak is None or load.validity.outside_theory:
        return ""
    if not isinstance(ends, tuple) or not volume_of(case).measurable(ends[1]):
        return ""
    also, share = "", 0.0
    if load.sample_ends is not None:
        assert case.sampling is not None
        kind, share = uncertain_in_words(case, load), case.sampling.confidence
        also = "both" if load.others else "" if load.flow_error is None else "own"
    elif load.leak_range is not None and (not load.others or has_two_numbers(load)):
        kind = "bounds" if load.others else "simulated"
        also = "own" if max(most, 1.0 / least) > _NOTICED else ""
    else:
        kind = "error"
    return say(case.display, "leak", "sure", kind=kind, also=also, share=share)


def _why(result: SealSolution, display: Display, load: CaseLoad) -> Iterator[str]:
    if load.leak is None:
        return
    if not math.isfinite(load.leak.leak_rate):
        yield say(display, "leak", "forced_open")
    elif load.leak.leak_rate > 0:
        yield _throttle(display, load)
    surface, peak = result.surface, load.peak_pressure
    if surface is None:
        return
    if surface.hardness is None:
        yield say(display, "leak", "elastic")
        return
    if isinstance(surface, TurnedContact):
        yield from _flows(result, display, load, None)
        return
    surface = load.tightest.surface_at_peak(surface)
    area, (factor, effect) = float(surface.contact_area(peak)), yielding_factor(load)
    yield from _flows(result, display, load, area)
    share = float(surface.plastic_area(peak)) / area
    yield say(display, "leak", "yielded", area=area, share=share, effect=effect, factor=factor)


def _flows(result: SealSolution, display: Display, load: CaseLoad, area: float | None) -> Iterator[str]:
    """What metal that flows lets through less than the same face over unstrained metal, where that is much."""
    profile = load.whole_profile
    if load.rough is None or profile.strain is None:
        return
    flows, rests = (load.rough.leak(each, load.fluid_pressure) for each in (profile, profile.without_strain))
    if flows is None or rests is None or not rests.leak_rate > _MUCH_LESS * flows.leak_rate:
        return
    digits, sealed = min(load.leak_digits, 2), flows.leak_rate == 0.0
    body = getattr(load.contact, "flowing_body", "")
    yield say(
        display,
        "leak",
        "flows",
        body=result.case.label_of(body) if body else "",
        area=area,
        factor="" if sealed else format_digits(rests.leak_rate / flows.leak_rate, digits),
        rate=display.leak_range(rests.leak_rate, digits, volume=volume_of(result.case)) if sealed else "",
    )


def _throttle(display: Display, load: CaseLoad) -> str:
    assert load.leak is not None
    x, share = load.whole_profile.x, load.leak.fluid_pressure / load.fluid_pressure
    rising = share if share[-1] > share[0] else 1 - share
    ends = np.interp(_MIDDLE, rising, x)
    # with the accuracy of the width of the contact
    width = display.quantity(float(ends[1] - ends[0]), f"worth length {load.digits_of('fwhm')}")
    ratio = load.fluid_pressure / load.peak_pressure
    if isinstance(load.leak, CoupledLeakResult):
        effect = "local"
    elif load.effective_radius is not None:
        effect = "penetration"
    else:
        effect = "opens" if ratio > FLUID_OPENS else "neglected"
    middle = _MIDDLE[1] - _MIDDLE[0]
    return say(display, "leak", "throttle", share=middle, width=width, effect=effect, ratio=ratio)


# Ratio of leak rates that differs from one in two digits, and from which on the strain of the metal is told.
_NOTICED, _MUCH_LESS = 1.05, 1.5


def narrowest_point(display: Display, load: CaseLoad) -> tuple[str, str]:
    """u_c in both readings of yielding asperities, and its name."""
    separations = (scenario.critical_separation for scenario in (load, *load.others.values()))
    ends = Bounds.of(separation for separation in separations if separation is not None)
    closed = "calculated as zero" if load.validity.outside_theory else "sealed"
    unit = display.unit_for("length", ends[1])
    digits = min(COLUMNS["critical_separation_m"].digits(load), 3 if ends[0] == ends[1] else 2)
    low, high = (format_digits(unit.of(end), digits) if end else closed for end in ends)
    text = f"{range_text(low, high)} {unit.name}" if ends[1] else closed
    both = "" if low == high else ", in both readings of asperities that yield"
    return text, f"critical separation at the peak pressure{both}"


def separate_ends(load: CaseLoad) -> Bounds | None:
    """Leak rate in all readings of yielding asperities [m^3/s]; None where they agree."""
    ends = load.leak_range
    return ends if ends is not None and ends.is_range else None


def has_two_numbers(load: CaseLoad) -> bool:
    """Whether the readings of yielding asperities differ in their shown digits."""
    ends = separate_ends(load)
    return ends is not None and len({format_digits(end, min(load.leak_digits, 2)) for end in ends}) == 2


def usual_rate_of(load: CaseLoad) -> float | tuple[float, float]:
    """Leak rate with the inputs as given: all readings of yielding asperities, or the only one [m^3/s]."""
    return separate_ends(load) or (math.nan if load.leak is None else load.leak.leak_rate)


def has_finish(case: Case) -> bool:
    """Whether a face is given by the finish of a drawing."""
    return case.roughness is not None and bool(case.roughness.finishes)


def uncertain_in_words(case: Case, load: CaseLoad) -> str:
    """What the samples of a load are over: "tested", "finish", "inputs", or "mixed", a finish and other inputs."""
    if load.after_test or not has_finish(case):
        return "tested" if load.after_test else "inputs"
    given = case.uncertainty is not None and bool(case.uncertainty.spreads)
    return "mixed" if given or any(uncertain_heights(case.roughness, between_scans=False)) else "finish"


def yielding_factor(load: CaseLoad) -> tuple[str, str]:
    """Factor by which yielding lowers the leak rate, in both readings, and key of its sentence; empty if unknown."""
    leak, never = load.leak, (load.scenario("elastic") or load).leak
    if leak is None or never is None:
        return "", ""
    low, high = (separate_ends(load) if load.others else None) or (leak.leak_rate, leak.leak_rate)
    if not high > 0:
        return "", ""
    elastic, digits = never.leak_rate, min(load.leak_digits, 2)
    if low == 0:
        return format_digits(elastic / high, digits_at_limit(elastic / high, 1.0, digits)), "never_sealed"
    ratios = (elastic / high, elastic / low)
    texts = (format_digits(ratio, digits_at_limit(ratio, 1.0, digits)) for ratio in ratios)
    return range_text(*texts), "never" if elastic / low > _NOTICED else "hardly"


def leakage_text(
    display: Display,
    load: CaseLoad,
    volume: LeakVolume = LIQUID,
    rate: float | tuple[float, float] | None = None,
) -> str:
    """A leak rate of a load in the units of its kind: "1.2 to 3.4 ml/min = 19 to 54 drops/min".

    Parameters
    ----------
    display : Display
    load : CaseLoad
        With a leak rate.
    volume : LeakVolume
        State of the leaking volume.
    rate : float or tuple of float, optional
        Another leak rate than that of the load, or both ends [m^3/s].
    """
    rate = rate_of(load) if rate is None else rate
    assert load.leak is not None
    if not volume.measurable(rate[1] if isinstance(rate, tuple) else rate):
        return display.leak_range(rate, claimed=not load.validity.outside_theory, volume=volume)
    if not isinstance(rate, tuple):
        ends = load.leak, load.leak
    elif 0 < load.leak.leak_rate < math.inf:
        ends = load.leak.scaled(rate[0]), load.leak.scaled(rate[1])
    else:
        # a sealed or open seal has no mass flow to scale
        alone = display.leak_range(
            rate, load.leak_digits, claimed=not load.validity.outside_theory, volume=volume
        )
        state = display.state_of(volume)
        return f"{alone} ({state})" if state else alone
    digits = min(load.leak_digits, 3 if ends[0] is ends[1] else 2)
    measured = (end if volume.measurable(end.leak_rate) else end.scaled(0.0) for end in ends)
    columns = zip(*(_in_units(display, end, volume) for end in measured), strict=True)
    amounts = [
        (format_digits(low, digits), format_digits(high, digits), unit) for (low, unit), (high, _) in columns
    ]
    # equal ends in the first unit stay equal in the others
    as_one = amounts[0][0] == amounts[0][1]
    return " = ".join(f"{range_text(high if as_one else low, high)} {unit}" for low, high, unit in amounts)


def _gas_state(display: Display, volume: LeakVolume) -> str:
    """State of a gas, also where leak rates are pressure times volume; empty for a liquid."""
    return replace(display, throughputs=False).state_of(volume)


def _in_units(display: Display, leak: LeakResult, volume: LeakVolume) -> Iterator[tuple[float, str]]:
    volumes = display.fixed_unit("ml/min")
    if leak.throughput is not None:
        usual = display.fixed_unit("mbar l/s")
        yield usual.of(leak.throughput), usual.name
        yield from [(leak.throughput, "Pa m³/s")] if usual.name != "Pa m³/s" else []
        yield volumes.of(leak.leak_rate), f"{volumes.name} ({_gas_state(display, volume)})"
    else:
        yield volumes.of(leak.leak_rate), volumes.name
        yield drops_per_minute(leak.leak_rate), "drops/min"
    if leak.mass_flow is not None:
        yield leak.mass_flow, "kg/s"


def volume_notes(
    display: Display, volume: LeakVolume, units: Sequence[str], *, unmeasured: bool
) -> list[str]:
    """Notes below a table of leak rates.

    Parameters
    ----------
    display : Display
    volume : LeakVolume
    units : sequence of str
        Units of the volumes in it.
    unmeasured : bool
        Whether some of them are too small to be measured.
    """
    notes = [say(display, "interval", "volume_least", least=volume.least_name)] if unmeasured else []
    if state := _gas_state(display, volume):
        # pressure times volume, two words, has no state
        volumes = [unit for unit in dict.fromkeys(units) if " " not in unit]
        notes += [say(display, "interval", "volume_column", unit=unit, state=state) for unit in volumes]
    return notes


def classes_in_words(classes: Sequence[LeakageClass]) -> str:
    """The classes: "ISO 5208 B, FCI 70-2 V; API 598: no class met"; "not claimed" outside the theory."""
    if not classes:
        return "not claimed"
    met = [str(leakage_class) for leakage_class in classes if leakage_class.name]
    missed = [str(leakage_class) for leakage_class in classes if not leakage_class.name]
    return "; ".join([*([", ".join(met)] if met else []), *missed])


def judged_as(case: Case, load: CaseLoad) -> str:
    """Note that the classes hold for the fluid of the standards' test; empty if it is the fluid of the case.

    Parameters
    ----------
    case : Case
    load : CaseLoad
    """
    assert case.fluid is not None
    if is_flange(case):
        return ""
    fluid, ratio = test_of(case.fluid, load.fluid_pressure, load)
    if fluid:
        return say(case.display, "interval", "classes_test_fluid", fluid=fluid, ratio=tuple(sorted(ratio)))
    return ""


def leakage_lines(case: Case, load: CaseLoad, loads: Sequence[CaseLoad]) -> list[str]:
    """Lines for the terminal about one load; none without a leak rate.

    Parameters
    ----------
    case : Case
    load : CaseLoad
    loads : sequence
        All of them.
    """
    if load.leak is None:
        return []
    display, validity, volume = case.display, load.validity, volume_of(case)
    rate, tested = leakage_text(display, load, volume), load.after_test and not validity.outside_theory
    first, *others = say_all(
        display,
        "leak",
        "lines",
        load=load_values(load, loads, display),
        rate=told_after_test(display, load, volume, rate) if tested else rate,
        tested=tested,
        validity=validity,
        covered=sure(case, load),
        as_given=_as_given(case, load) if load.sample_ends is not None else "",
        size=class_size(case)[1],
        classes=classes_in_words(leakage_classes(case, load)),
        judged_as="" if validity.outside_theory else judged_as(case, load),
    )
    # what is said of a line stands below it
    return [first, *(line if line.startswith("Leakage class") else f"  {line}" for line in others)]


def _as_given(case: Case, load: CaseLoad) -> str:
    """The leak rate with the inputs as given, in both readings of yielding asperities."""
    # in the unit of the line above
    rate = leakage_text(case.display, load, volume_of(case), usual_rate_of(load)).split(" = ")[0]
    values = {"tested": load.after_test, "finish": has_finish(case), "rate": rate}
    return say(case.display, "interval", "as_given", **values)


def _page(result: SealSolution, display: Display) -> AnswerPage:
    load = decisive(result)
    line = "" if has_one_number(load) else sure(result.case, load)
    return AnswerPage(
        first=[line] if line else (),
        tiles=[*_tiles(result, display, load)],
        why=[*_why(result, display, load)],
    )


OUTPUT = AnswerOutput(page=_page)
