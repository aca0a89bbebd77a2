"""The leak rate: its interval, its class, and what throttles the flow."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from fem_seal.answers.case_load import rate_of
from fem_seal.answers.leakage_class import class_size, leakage_classes, volume_of
from fem_seal.output.answers.uncertainty import told_after_test
from fem_seal.output.report.words import (
    _narrowest_point,
    _two_numbers,
    _yielding_factor,
    has_finish,
    leakage_text,
    uncertain_in_words,
    usual_rate_of,
)
from fem_seal.output.shown import AnswerPage, Shown, Tile, decisive
from fem_seal.seal.load_result import load_values
from fem_seal.units import leak_range_text, percent
from fem_seal.validity.checks import FLUID_OPENS
from fem_seal.wording import say
from leak import CoupledLeakResult

if TYPE_CHECKING:
    from fem_seal.answers.case_load import CaseLoad
    from fem_seal.answers.solution import SealSolution
    from fem_seal.units import Display

# Part of the pressure drop whose strip of the contact does the sealing: its middle 80 %.
_MIDDLE = (0.1, 0.9)


def _tiles(result: SealSolution, display: Display, load: CaseLoad) -> Iterator[Tile]:
    if load.leak is None:
        return
    case, level, outside = result.case, load.validity.level, load.validity.outside
    volume = volume_of(case)
    text = leak_range_text(rate_of(load), load.leak_digits, claimed=not outside, volume=volume)
    middle, kind = "", "tested" if load.tested else "finish" if has_finish(case) else "inputs"
    if load.sampled is not None and not outside:
        middle = leak_range_text(usual_rate_of(load), min(load.leak_digits, 2), volume=volume)
        text = told_after_test(load, volume) if load.tested else text
    at = load_values(load, result.loads)
    yield Tile("Leak rate", text, say(display, "leak", "rate", load=at, middle=middle, kind=kind), 0, level)
    (short, size), classes = class_size(case), leakage_classes(case, load)
    met = [str(one) for one in classes if one.name]
    best = met[0] if met else str(classes[0]) if classes else "none stated"
    remark = say(display, "leak", "classes", size=size, none_stated=not classes)
    yield Tile(f"Leakage class, {short}", best, remark, 20 if result.judgement is None else 55, level)
    if load.leak.leak_rate > 0:
        units = leakage_text(load, volume).split(" = ")
        others = [amount for amount in units if amount.split(" (")[0] != text]
        if others:
            yield Tile("In other units", others[0], " = ".join(others[1:]), 95, level)
    if load.critical_separation is not None:
        value, remark = _narrowest_point(load)
        yield Tile("Narrowest point of the leak path", value, "u_c at the peak pressure", 80, level)


def sure(result: SealSolution, display: Display, load: CaseLoad) -> str:
    """What the interval of a leak rate covers, in one sentence; empty for a single number.

    Parameters
    ----------
    result : SealSolution
    display : Display
    load : CaseLoad
    """
    case, ends = result.case, rate_of(load)
    if load.leak is None or load.validity.outside:
        return ""
    if not isinstance(ends, tuple) or not volume_of(case).measurable(ends[1]):
        return ""
    also, share = "", 0.0
    if load.sampled is not None:
        assert case.sampled is not None
        kind, share = uncertain_in_words(case, load), case.sampled.confidence
        also = "both" if load.others else "" if load.flow_error is None else "own"
    elif load.leak_range is not None and (not load.others or _two_numbers(load)):
        kind = "bounds" if load.others else "simulated"
    else:
        kind = "error"
    return say(display, "leak", "sure", kind=kind, also=also, share=share)


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
    area = float(surface.contact_area(peak))
    yielded = float(surface.plastic_area(peak)) / area
    share = "nearly all" if yielded > 0.999 else "next to nothing" if yielded < 1e-3 else percent(yielded)
    factor, effect = _yielding_factor(load)
    yield say(display, "leak", "yielded", area=area, share=share, effect=effect, factor=factor)


def _throttle(display: Display, load: CaseLoad) -> str:
    assert load.leak is not None
    x, share = load.whole.x, load.leak.fluid_pressure / load.fluid_pressure
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


def _page(result: SealSolution, display: Display) -> AnswerPage:
    load = decisive(result)
    line = sure(result, display, load)
    return AnswerPage(
        first=[line] if line else (),
        tiles=[*_tiles(result, display, load)],
        why=[*_why(result, display, load)],
    )


SHOWN = Shown(page=_page)
