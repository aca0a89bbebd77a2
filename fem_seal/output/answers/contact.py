"""The contact: its main numbers, and what governs its width."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from fem_seal.answers.closed_forms import derive_beside
from fem_seal.contact.solution import PlasticZone, yielding_of
from fem_seal.output.answer_output import AnswerOutput, AnswerPage, Tile, decisive
from fem_seal.output.answers.lands import hardest_land
from fem_seal.output.case_words import earlier_load
from fem_seal.output.columns import in_words
from fem_seal.wording import say

if TYPE_CHECKING:
    from fem_seal.answers.case_load import CaseLoad
    from fem_seal.answers.solution import SealSolution
    from fem_seal.units import Display
    from leak.theory.line_contact import HertzLine

# Peak over Hertz's peak above which mesh and curved faces do not explain the difference.
_ABOVE_HERTZ = 1.05
PEAK = "Peak contact pressure"


def _tiles(result: SealSolution, display: Display, load: CaseLoad) -> Iterator[Tile]:
    level = load.validity.of_contact.level
    land = hardest_land(load, display) if len(load.profiles) > 1 else ""
    peak = in_words(display, load, "peak_pressure_Pa")
    mean = load.circumference is not None and load.circumference.form.uneven
    if mean:
        remark = say(display, "contact", "around", peak=peak)
        yield Tile(PEAK, in_words(display, load, "peak_pressure_max_Pa"), remark, 60, level)
    else:
        yield Tile(PEAK, peak, land, 60, level)
    yield Tile("Width at half maximum", in_words(display, load, "fwhm_m"), land, 70, level)
    if not load.of_profile:
        body = result.case.label_of(load.max_von_mises_at[0])
        where = say(display, "contact", "stress", body=body, mean=mean)
        yield Tile("Largest stress", in_words(display, load, "max_von_mises_Pa"), where, 90, level)
    if result.imprints:
        name, imprint = max(result.imprints.items(), key=lambda item: item[1].deepest)
        # with the accuracy of the width of the contact
        depth, width = (
            display.quantity(size, f"worth length {result.strongest.digits_of('fwhm')}")
            for size in (imprint.deepest, imprint.width)
        )
        where = say(display, "contact", "imprint", body=result.case.label_of(name), width=width)
        yield Tile("Permanent imprint", depth, where, 65, level)


def _why(result: SealSolution, display: Display, load: CaseLoad) -> Iterator[str]:
    if not load.of_profile:
        yield _width_reason(result, display, load)
    if result.unloaded_bodies is None:
        return
    zones = {name: zone for name, zone in load.zones.items() if isinstance(zone, PlasticZone)}
    if not zones:
        yield say(display, "contact", "elastic")
    for name, zone in zones.items():
        body, digits = result.case.label_of(name), load.digits_of("fwhm")
        yield say(display, "contact", "yielding", body=body, zone=zone, digits=digits)


def _width_reason(result: SealSolution, display: Display, load: CaseLoad) -> str:
    hertz = derive_beside(result).loads[result.loads.index(load)].hertz
    peak, width = in_words(display, load, "peak_pressure_Pa"), in_words(display, load, "fwhm_m")
    if hertz is None:
        return say(display, "contact", "width", kind="conforming", peak=peak, width=width)
    smooth = result.case.interface.law == "smooth"
    bulk = min((hertz.std / load.std) ** 2, 1.0)
    if any(isinstance(zone, PlasticZone) for zone in yielding_of(load.contact).values()):
        kind = "yielding" if smooth else "rough_yielding"
    elif _leaves_curvature(result, hertz, load.peak_pressure):
        kind = "other_curvature"
    elif smooth:
        kind = "smooth"
    else:
        kind = "roughness" if bulk < 0.25 else "elasticity" if bulk > 0.75 else "both"
    of_smooth = {
        "smooth_peak": display.quantity(hertz.peak_pressure, "contact pressure"),
        "smooth_width": display.quantity(hertz.fwhm, "length"),
    }
    return say(display, "contact", "width", kind=kind, peak=peak, width=width, **of_smooth)


def _leaves_curvature(result: SealSolution, hertz: HertzLine, peak: float) -> bool:
    """Whether Hertz does not apply: the contact exceeds the constant curvature, or its peak that of any roughness."""
    breaks = np.abs(result.case.contact.breaks)
    return bool((breaks < 2 * hertz.std).any()) or peak > _ABOVE_HERTZ * hertz.peak_pressure


def history(result: SealSolution, display: Display) -> list[str]:
    """What the loads before have left, in one sentence; none without a load history.

    Parameters
    ----------
    result : SealSolution
    display : Display
    """
    earlier = earlier_load(display, result.case.load)
    remembers = any(load.remembers for load in result.loads)
    if earlier:
        kind = "remembers" if remembers or result.unloaded_bodies else "forgets"
    elif not remembers:
        return []
    else:
        tightened = result.bolts is not None and result.problem.loads.earlier is not None
        kind = "tightened" if tightened else "path"
    return [say(display, "contact", "history", kind=kind, earlier=earlier)]


def _page(result: SealSolution, display: Display) -> AnswerPage:
    load, before = decisive(result), history(result, display)
    return AnswerPage(
        tiles=[*_tiles(result, display, load)], why=[*_why(result, display, load), *before], details=before
    )


OUTPUT = AnswerOutput(page=_page)
