"""Numbers and words of a design on the page, the same for a live answer and for a complete run."""

from __future__ import annotations

import math
import re
import signal
import time
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from fem_seal import units
from fem_seal.answers.judgement import Verdict
from fem_seal.answers.leakage_class import leakage_classes, limits, volume_of
from fem_seal.output.answer_output import Tile
from fem_seal.output.answers.lands import hardest_land
from fem_seal.output.answers.verdict import next_class_of, tiles, verdict_sentences, worst_verdict
from fem_seal.output.columns import COLUMNS
from fem_seal.output.pictures.section import contact_window
from fem_seal.seal.findings import Level
from fem_seal.seal.load_result import highest_load
from fem_seal.wording import environment

if TYPE_CHECKING:
    from fem_seal.answers.case_load import CaseLoad
    from fem_seal.answers.solution import SealSolution
    from fem_seal.arrays import FloatArray
    from fem_seal.case.case import Case
    from fem_seal.explore.factors import Factors
    from meshes import Outline

# Columns of leak.csv that stand on the page, those of a leak rate among them.
LEAK = ("leak_rate_m3_per_s", "leak_rate_low_m3_per_s", "leak_rate_high_m3_per_s")
FIELDS = ("fluid_pressure_Pa", "contact_force_N", "line_load_N_per_m", "peak_pressure_Pa", "fwhm_m", *LEAK)
# Those beside the leak rate, by their names on the page.
_NUMBERS = {
    "peak": "peak_pressure_Pa",
    "width": "fwhm_m",
    "force": "contact_force_N",
    "line": "line_load_N_per_m",
}
_POINTS = 241
_ARC_STEPS = 24


@dataclass(frozen=True)
class ShownLoad:
    """One load.

    Parameters
    ----------
    values : dict
        Columns of leak.csv in SI.
    applied_force : float
        [N]
    level : str
        How far the numbers can be trusted, see `Level`.
    reasons : tuple of str
        Why no further.
    classes : tuple of str
        Leakage classes that are met.
    digits : dict
        Significant digits that each of the values is worth.
    remarks : dict
        On which of several lands peak pressure and width are.
    """

    values: dict[str, float]
    applied_force: float
    level: str
    reasons: tuple[str, ...]
    classes: tuple[str, ...]
    digits: dict[str, int]
    remarks: dict[str, str]


@dataclass(frozen=True)
class ShownProfile:
    """Pressure and gap across the contact of one load.

    Parameters
    ----------
    x : list of float
        Arc length from first touch [m].
    pressure : list of float
        Contact pressure [Pa].
    gap : list of float
        Mean separation [m]; NaN where nothing is known of it.
    fluid : list of float
        Fluid pressure in the gap [Pa]; empty where it is not known.
    places : list of list
        r and z of each place on the seat [m].
    """

    x: list[float]
    pressure: list[float]
    gap: list[float]
    fluid: list[float]
    places: list[list[float]]


@dataclass(frozen=True)
class CrossSection:
    """Both bodies in section.

    Parameters
    ----------
    closure, seat : list of tuple
        Corners (r, z) [m].
    initial_contact_radius : float
        Of first touch, which lies at z = 0 [m].
    angle : float
        Between the axis and the contact normal [rad].
    pressure_side : str
    window : tuple of float
        Middle (r, z) of the enlarged picture of the contact, and half its height [m].
    middle : float or None
        Height of the mid-plane of a gasket [m].
    lower : CrossSection or None
        With the lower flange on both faces of a gasket; None where the flanges are alike.
    """

    closure: list[tuple[float, float]]
    seat: list[tuple[float, float]]
    initial_contact_radius: float
    angle: float
    pressure_side: str
    window: tuple[float, float, float] = (0.0, 0.0, 0.0)
    middle: float | None = None
    lower: CrossSection | None = None

    @property
    def rings(self) -> tuple[list[list[tuple[float, float]]], list[list[tuple[float, float]]]]:
        """Corners of closure and seat; of a gasket both flanges, and both halves."""
        both = ([self.closure], [self.seat])
        lower = self.lower or self
        if self.middle is not None and lower.middle is not None:
            for rings, corners in zip(both, (lower.closure, lower.seat), strict=True):
                rings.append([(r, self.middle + lower.middle - z) for r, z in corners])
        return both


@dataclass(frozen=True)
class Screen:
    """All that is shown of a design.

    Parameters
    ----------
    design : dict
        From keys of factors to texts.
    loads : tuple of ShownLoad
        In the order of the case.
    load_number : int
        Number of the load whose profile and numbers are shown: that with the highest fluid pressure.
    profile : ShownProfile or None
    section : CrossSection or None
    complete : bool
        Whether these are the numbers of `fem-seal run`.
    delay : str
        What is still being calculated; empty if nothing is.
    warnings : tuple of str
    problem : str
        Why there is nothing to show; empty if there is.
    wrong : dict
        From keys of factors to what is wrong with their values, where the problem is that of one.
    curve_loads : tuple of ShownLoad
        Further loads that fill the curve; the case does not have them.
    verdict : str
        Such as "pass"; empty without a requirement, and while its interval is not there.
    remarks : tuple of str
        The verdict in sentences, or the next class.
    tiles : tuple of Tile
        What it rests on.
    limits : tuple of tuple
        Name and leak rate of what is allowed at the load that is shown [m^3/s].
    widens : bool
        Whether the interval is still that of the inputs as given, and a complete run will widen it.
    volume : LeakVolume
        What a volume is that leaks.
    sensitivities : tuple of str
        What would change the leak most, in sentences; empty unless the run is complete.
    display : Display
        In which units it is shown.
    """

    design: dict[str, str]
    loads: tuple[ShownLoad, ...] = ()
    load_number: int = 0
    profile: ShownProfile | None = None
    section: CrossSection | None = None
    complete: bool = False
    delay: str = ""
    warnings: tuple[str, ...] = ()
    problem: str = ""
    curve_loads: tuple[ShownLoad, ...] = ()
    verdict: str = ""
    remarks: tuple[str, ...] = ()
    tiles: tuple[Tile, ...] = ()
    limits: tuple[tuple[str, float], ...] = ()
    widens: bool = False
    volume: units.LeakVolume = units.LIQUID
    wrong: dict[str, str] = field(default_factory=dict)
    sensitivities: tuple[str, ...] = ()
    display: units.Display = field(default_factory=units.Display)

    @property
    def load(self) -> ShownLoad | None:
        """The load whose numbers are shown."""
        return self.loads[self.load_number] if self.loads else None


def screen_of(solution: SealSolution, design: Mapping[str, str], **fields: Any) -> Screen:
    """What is shown of a solved case.

    Parameters
    ----------
    solution : SealSolution
    design : mapping
    more
        Further fields of the screen.
    """
    case, loads = solution.case, solution.loads
    number = highest_load(loads)
    # what is not known of a case widens the interval of a complete run, so that no verdict comes before it
    bolts, is_open = solution.problem.loads.bolts, case.roughness and case.roughness.leaves_open
    unknown = case.uncertainty is not None or bool(is_open or (bolts and bolts.scatter))
    widens = unknown and not fields.get("complete")
    return Screen(
        dict(design),
        tuple(shown_load(load, case) for load in loads),
        number,
        profile_of(loads[number], case),
        section_of(case),
        **({} if widens else _judge_solution(solution, complete=fields.get("complete", False))),
        widens=widens,
        limits=tuple(
            (limit.name, limit.leak_rate / limit.ratio[1])
            for limit in limits(case, loads[number].fluid_pressure, loads[number])
            if not limit.visible
        ),
        volume=volume_of(case),
        display=case.display,
        **fields,
    )


def sensitivity_words(result: SealSolution, *, follow: bool = False) -> tuple[str, ...]:
    """What would change the leak most, or why that is not said; nothing where there is no leak.

    Parameters
    ----------
    result : SealSolution
    follow : bool
        Whether they are still being calculated.
    """
    from fem_seal.output.answers.sensitivities import in_words, load_of, shown_sensitivities

    if not result.problem.leaks:
        return ()
    at = f"at {load_of(result)} " if len(result.loads) > 1 else ""
    texts = tuple(
        f"{at}{in_words(result.case, sensitivity)}"
        for sensitivity in shown_sensitivities(result.sensitivities)
    )
    reason = "yields" if result.problem.follows_path else "follow" if follow else "none"
    return texts or (getattr(page_words(), f"sensitivities_{reason}")(),)


def _judge_solution(solution: SealSolution, *, complete: bool) -> dict[str, Any]:
    if solution.judgement is None:
        text = "" if solution.highest.leak is None else next_class_of(solution)
        return {"remarks": (text,) if text else ()}
    requirement = solution.case.requirement
    follow = requirement is not None and requirement.test == "standard" and not complete
    service = (page_words().service(),) if follow else ()
    word = worst_verdict(solution)
    return {
        # service loads that pass decide nothing while the tests are not there
        "verdict": "" if follow and word in (Verdict.PASS, Verdict.PASS_UNLESS) else str(word),
        "remarks": (*service, *verdict_sentences(solution)),
        "tiles": tuple(tiles(solution)),
    }


def shown_load(load: CaseLoad, case: Case) -> ShownLoad:
    """What is shown of one load.

    Parameters
    ----------
    load : CaseLoad
    case : Case
    """
    return ShownLoad(
        {name: COLUMNS[name].number(load) for name in FIELDS},
        load.applied_force,
        str(load.validity.level),
        load.validity.reasons_in(case.display),
        _class_names(case, load),
        {name: COLUMNS[name].digits(load) for name in FIELDS},
        dict.fromkeys(
            ("peak_pressure_Pa", "fwhm_m"), hardest_land(load, case.display) if len(load.profiles) > 1 else ""
        ),
    )


def _class_names(case: Case, load: CaseLoad) -> tuple[str, ...]:
    """Classes that a load meets, that of the required standard first."""
    required = case.requirement and case.requirement.standard_and_class
    classes = leakage_classes(case, load)
    if required:
        classes = tuple(sorted(classes, key=lambda named: named.standard != required[0]))
    return tuple(map(str, classes))


def without_interval(load: ShownLoad) -> ShownLoad:
    """A load without the ends of its leak rate.

    Parameters
    ----------
    load : ShownLoad
    """
    return replace(load, values={**load.values, **dict.fromkeys(LEAK[1:], math.nan)})


def profile_of(load: CaseLoad, case: Case) -> ShownProfile:
    """Pressure and gap of a load, on all its lands.

    Parameters
    ----------
    load : CaseLoad
    case : Case
    """
    line = load.whole_profile
    x = np.asarray(line.x)
    carries = np.flatnonzero(line.pressure > 1e-3 * line.pressure.max())
    # as wide again to both sides: what the gap does there is what a drawing would show
    low, high = float(x[carries[0]]), float(x[carries[-1]])
    start = int(np.searchsorted(x, low - 0.35 * (high - low)))
    stop = int(np.searchsorted(x, high + 0.35 * (high - low), side="right"))
    step = max(1, (stop - start) // _POINTS)

    def thin_values(values: FloatArray) -> list[float]:
        numbers: list[float] = np.asarray(values, dtype=float)[start:stop:step].tolist()
        return numbers

    fluid = vars(load).get("leak_round")
    pressure = None if fluid is None else fluid.fluid_pressure
    return ShownProfile(
        thin_values(x),
        thin_values(line.pressure),
        thin_values(line.gap),
        [] if pressure is None else thin_values(pressure),
        [thin_values(axis) for axis in case.contact.point(x)],
    )


def section_of(case: Case) -> CrossSection:
    """Both bodies of a case in first touch.

    Parameters
    ----------
    case : Case
    """
    contact, window = case.contact, contact_window(case)
    touch = complex(contact.initial_contact_radius)
    return CrossSection(
        _corners(contact.closure, touch, window[2]),
        _corners(contact.seat, touch, window[2]),
        contact.initial_contact_radius,
        contact.angle,
        case.load.pressure_side,
        window,
        contact.seat.extent[1][0] if case.gasket is not None else None,
        next(map(section_of, case.parts[1:]), None),
    )


def _corners(outline: Outline, touch: complex, half: float) -> list[tuple[float, float]]:
    """Corners of an outline, arcs in short chords; around the touch, which is enlarged, in shorter ones."""
    corners: list[tuple[float, float]] = []
    for segment in outline.segments:
        if segment.centre is None:
            corners.append((float(segment.start[0]), float(segment.start[1])))
            continue
        # r + i z, turned about the centre
        centre, arm = complex(*segment.centre), complex(*segment.start) - complex(*segment.centre)
        at = float(np.angle((touch - centre) / arm)) / segment.sweep if touch != centre else 0.0
        dense = at + np.linspace(-2, 2, 4 * _ARC_STEPS) * half / abs(arm * segment.sweep)
        shares = np.union1d(np.arange(_ARC_STEPS) / _ARC_STEPS, dense[(dense > 0) & (dense < 1)])
        points = centre + arm * np.exp(1j * segment.sweep * shares)
        corners += zip(points.real.tolist(), points.imag.tolist(), strict=True)
    return corners


@dataclass(frozen=True)
class Number:
    """A number of the page.

    Parameters
    ----------
    name : str
        Short, unique on the page.
    what : str
        What it is.
    value : str
        With unit.
    remark : str
        A remark below it.
    si : float or None
        The number itself in SI.
    title : str
        What a pointer on it shows.
    """

    name: str
    what: str
    value: str
    remark: str = ""
    si: float | None = None
    title: str = ""


@dataclass(frozen=True)
class ShownDesign:
    """A design on the page, and what is said of it.

    Parameters
    ----------
    screen : Screen
    name : str
    colour : str
        Of its lines.
    """

    screen: Screen
    name: str
    colour: str

    @cached_property
    def numbers(self) -> dict[str, Number]:
        """Its numbers by their names."""
        return {number.name: number for number in numbers_of(self.screen)}

    @property
    def validity(self) -> tuple[str, str]:
        """See `validity_words`; without a load there is none."""
        return validity_words(self.screen) if self.screen.load else ("", "–")


def page_words(display: units.Display | None = None) -> Any:
    """Sentences and names of templates/explore/words.j2."""
    return environment(display or units.Display()).get_template("explore/words.j2").module


def leak_words(load: ShownLoad, volume: units.LeakVolume, display: units.Display | None = None) -> str:
    """The leak rate of a load, an interval where there is one."""
    rate, low, high = (load.values[name] for name in LEAK)
    if not math.isfinite(rate) and not math.isfinite(low):
        return "–"
    ends = (low, high) if math.isfinite(low) and math.isfinite(high) else rate
    digits, is_claimed = load.digits["leak_rate_m3_per_s"], load.level != str(Level.OUTSIDE)
    return (display or units.Display()).leak_range(ends, digits, claimed=is_claimed, volume=volume)


def numbers_of(screen: Screen) -> list[Number]:
    """The numbers of the load that is shown, and what its verdict rests on.

    Parameters
    ----------
    screen : Screen
    """
    load = screen.load
    if load is None:
        return []
    values, words, preliminary = load.values, page_words(screen.display), preliminary_words(screen)
    state = screen.display.state_of(screen.volume)
    at = words.at(values["fluid_pressure_Pa"], state, preliminary).strip()
    numbers = [
        Number(
            "leak",
            words.names["leak"],
            leak_words(load, screen.volume, screen.display),
            at,
            values["leak_rate_m3_per_s"],
        )
    ]
    for name, column in _NUMBERS.items():
        value = screen.display.quantity(values[column], f"worth {COLUMNS[column].kind} {load.digits[column]}")
        remark = load.remarks.get(column) or (words.both_forces() if name == "force" else "")
        numbers.append(Number(name, words.names[name], value, remark, values[column]))
    if load.classes:
        # a class is met by a whole interval or not at all
        first, *others = load.classes
        text = {"value": "–", "remark": words.class_follows()} if preliminary else {"value": first}
        numbers.append(Number("classes", words.names["classes"], **text, title=", ".join(others)))
    for tile in screen.tiles:
        numbers.append(Number(re.sub(r"\W+", "-", tile.name.lower()), tile.name, tile.value, tile.remark))
    return numbers


def preliminary_words(screen: Screen) -> str:
    """Why the leak rate and its interval are not those of `fem-seal run` yet; empty if they are.

    Parameters
    ----------
    screen : Screen
    """
    return str(page_words().preliminary()) if screen.widens else ""


def validity_words(screen: Screen) -> tuple[str, str]:
    """How far the shown load can be trusted: the class of its colour, and the words.

    What is preliminary is never called good.

    Parameters
    ----------
    screen : Screen
        With a load.
    """
    assert screen.load is not None
    colour = {str(Level.VALID): "good", str(Level.DOUBTFUL): "warn"}.get(screen.load.level, "bad")
    preliminary = preliminary_words(screen)
    words = str(page_words().validity(screen.load.level, preliminary))
    return "" if preliminary and colour == "good" else colour, words


def slow_words(seconds: float) -> str:
    """That a design takes too long to follow the sliders.

    Parameters
    ----------
    seconds : float
        Estimated processor time [s].
    """
    return str(page_words().slow(units.duration(seconds)))


def lost_words(code: int | None, *, has_successor: bool) -> str:
    """What became of a process of the page.

    Parameters
    ----------
    code : int or None
        With which it ended, minus the number of the signal that killed it; None if it was ended because it hung.
    has_successor : bool
        Whether another one does its work.
    """
    names = {-sign: sign.name for sign in signal.Signals.__members__.values()}
    name = names.get(code or 0, f"signal {-(code or 0)}")
    return str(page_words().lost(time.strftime("%H:%M:%S"), code, name, has_successor)).strip()


def not_taken_words(factors: Factors, design: Mapping[str, str], wrong: Mapping[str, str]) -> str:
    """That texts stand in fields that are not calculated with, and what is; empty if there are none.

    Parameters
    ----------
    factors : Factors
    design : mapping
        That the numbers belong to.
    wrong : mapping
        From keys of factors to the texts that stand in their fields.
    """
    labels = {key: label for key, label in factors.labels.items() if key in wrong}
    return str(page_words().not_taken(labels, wrong, design)) if labels else ""


def refused_words(screen: Screen, design: Mapping[str, str]) -> dict[str, str]:
    """What is said at the fields of a design that cannot be calculated, by the keys of their factors.

    Parameters
    ----------
    screen : Screen
    design : mapping
        The design that is still shown.
    """
    if not screen.problem:
        return {}
    notes = {
        key: str(page_words().refused(design[key]))
        for key, text in screen.design.items()
        if key in design and design[key] != text
    }
    return notes | screen.wrong


def still_words(factors: Factors, design: Mapping[str, str], old: Mapping[str, str]) -> str:
    """Which inputs the faded numbers of an earlier design belong to.

    Parameters
    ----------
    factors : Factors
    design : mapping
        That cannot be calculated.
    old : mapping
        That is still shown.
    """
    labels = {
        key: label for key, label in factors.labels.items() if key in old and old[key] != design.get(key)
    }
    return str(page_words().still(labels, old)) if labels else ""
