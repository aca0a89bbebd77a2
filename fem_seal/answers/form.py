"""Answers about the form error: its largest allowed size, its worst wave, the force that closes the seal all around."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

import leak
from fem_seal.answers.answer import Answer, Request
from fem_seal.answers.case_load import CaseLoad, SolvedSeal
from fem_seal.answers.force_search import End, Trials, find_zero, sensible_forces
from fem_seal.answers.leakage_class import leakage_classes, limits, test_of
from fem_seal.case.case import Case
from fem_seal.errors import ConvergenceError, OpenSealError
from fem_seal.form import FormError, Wave, WaveTolerance
from fem_seal.seal.circumference import Circumference, LeakCurve, solve_both_around
from fem_seal.seal.load_solver import LoadSolver

# Sizes of the form error that the curve shows, over the one that is given.
_FACTORS = (0.0, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0)
# Numbers of waves that are tried for the tolerance on the drawing, unless the case says which.
_WAVES = (2, 15)
# Radial part of the contact normal below which a drawing calls for flatness instead of roundness.
_FLAT = 0.05
# Angles on which the flow around the axis is solved, at most.
_ANGLES = 256
# Largest and first change of the gap that is looked at [m], steps and smallest in the logarithm, and the accuracy.
_MOST_GAP, _FIRST_GAP, _STEP, _WAY, _ACCURACY = 1e-3, 1e-6, 1.0, 20.0, 1e-3


# Least line load over the mean from which on a seal is called closed all around.
CLOSED_SHARE = 0.5


@dataclass(frozen=True)
class FormPoint:
    """A load with another size of its form error.

    Parameters
    ----------
    factor : float
        Size over the one that is given.
    height : float
        From the narrowest to the widest place of the gap's change [m].
    leak_rate : float or None
        [m^3/s]; None without roughness or fluid.
    line_load_min_over_mean : float
    others : mapping
        Where asperities yield, the leak rate in the other readings, see `LoadResult.others` [m^3/s].
    """

    factor: float
    height: float
    leak_rate: float | None
    line_load_min_over_mean: float
    others: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class WaveAlone:
    """A load with one wave of its form error alone.

    Parameters
    ----------
    waves : int
    amplitude : float
        Of the gap's change [m].
    leak_rate : float or None
        [m^3/s]
    line_load_min_over_mean : float
    others : mapping
        Where asperities yield, the leak rate in the other readings [m^3/s].
    """

    waves: int
    amplitude: float
    leak_rate: float | None
    line_load_min_over_mean: float
    others: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class AllowedForm:
    """How large a form error may be for a limit.

    Parameters
    ----------
    limit : str
        What sets it: "leak rate" of the requirement, "target", or standard and class.
    leak_rate : float
        [m^3/s]
    factor : float or None
        Largest size over the one that is given; None if the round seal leaks more, infinite if none does.
    zone : float or None
        Width of the tolerance zone in `direction` [m] that keeps it with the number of waves that hurts most.
    direction : {"radial", "axial"}
    waves : int or None
        That number.
    """

    limit: str
    leak_rate: float
    factor: float | None
    zone: float | None
    direction: str
    waves: int | None


@dataclass(frozen=True)
class FormAnswers:
    """What is known of a form error at the load with the highest fluid pressure.

    Parameters
    ----------
    fluid_pressure, applied_force : float
        Of the load [Pa], [N].
    curve : tuple of FormPoint
        Leak rate over the size of the form error.
    waves : tuple of WaveAlone
        The one that hurts most first.
    tolerance_waves : int or None
        Waves with which the case's tolerance was filled, the number that hurts most.
    closing_force : float or None
        Smallest force of spring or actuator at which the least line load is `CLOSED_SHARE` of the mean [N]; None if no
        force does it.
    allowed : AllowedForm or None
        None without a target or [form], and where no class is met even by the round seal.
    goes_round : float or None
        Share by which more leaks because fluid goes round tight places; None if not asked.
    deepest_scratch : tuple of float or None
        Depth and width [m] of the deepest scratch in place of the widest, of its proportions, with which the limit
        still holds beside all others, in all readings of yielding asperities; None without scratches or limit, or if
        none does.
    allowed_others : mapping
        What is allowed in the other readings of yielding asperities.
    """

    fluid_pressure: float
    applied_force: float
    curve: tuple[FormPoint, ...]
    waves: tuple[WaveAlone, ...]
    tolerance_waves: int | None
    closing_force: float | None
    allowed: AllowedForm | None
    goes_round: float | None = None
    deepest_scratch: tuple[float, float] | None = None
    allowed_others: Mapping[str, AllowedForm] = field(default_factory=dict)


def form_answers(solver: LoadSolver, case: Case, load: CaseLoad, form: FormError) -> FormAnswers:
    """Answers for one load.

    Parameters
    ----------
    solver : LoadSolver
        Of the load's model.
    case : Case
    load : CaseLoad
        Of a seal that is not round.
    form : FormError
        The form error as the case has it, its tolerance not yet filled.

    Raises
    ------
    ConvergenceError
    """
    trial = _FormLoad(load)
    waves = sorted(map(trial.alone, trial.form.felt_waves), key=lambda wave: wave.line_load_min_over_mean)
    tolerance_waves = None if form.tolerance is None else _filled_waves(form, trial.form)
    return FormAnswers(
        load.fluid_pressure,
        load.applied_force,
        tuple(trial.curve()),
        tuple(waves),
        tolerance_waves,
        _closing_force(solver, load),
        _allowed_form(case, load, trial, form),
        _goes_round(load) if case.form is not None and case.form.flow_around else None,
        _shallower([_deepest_scratch(case, load, x) for x in (trial, *trial.others.values())]),
        {
            name: allowed
            for name, other in trial.others.items()
            if (allowed := _allowed_form(case, load, other, form)) is not None
        },
    )


def _filled_waves(form: FormError, filled_form: FormError) -> int | None:
    """Number of waves that a tolerance was filled with."""
    amplitudes = {wave.waves: wave.amplitude for wave in form.waves}
    numbers = [wave.waves for wave in filled_form.waves if wave.amplitude != amplitudes.get(wave.waves, 0.0)]
    return numbers[0] if numbers else None


@dataclass(frozen=True)
class _FormLoad:
    """A load whose form error can be exchanged."""

    load: CaseLoad

    @property
    def circumference(self) -> Circumference:
        assert self.load.circumference is not None
        return self.load.circumference

    @property
    def form(self) -> FormError:
        """Without scratches: they are a question of their own."""
        return replace(self.circumference.form, grooves=())

    @property
    def leaks(self) -> LeakCurve | None:
        """Leak rate over the line load, the same for every form error."""
        flow = None if self.load.rough is None else self.load.rough.at(self.load.fluid_pressure)
        return None if flow is None else LeakCurve(self.circumference.local, flow)

    @property
    def others(self) -> dict[str, _FormLoad]:
        """In the other readings of yielding asperities."""
        return {name: _FormLoad(load) for name, load in self.load.others.items()}

    def evaluate(self, circumference: Circumference) -> tuple[float | None, float, dict[str, float]]:
        """Leak rate [m^3/s], least line load over mean, and leak rates in the other readings [m^3/s]."""
        leaks = {name: scenario.leaks for name, scenario in self.others.items()}
        rates = {
            name: _rate(circumference.with_leak(leak)) for name, leak in leaks.items() if leak is not None
        }
        others = {name: rate for name, rate in rates.items() if rate is not None}
        return _rate(circumference), circumference.least_over_mean, others

    def with_form(self, form: FormError) -> Circumference:
        previous = None if self.circumference.before is None else self.circumference.before.local
        circumference = solve_both_around(form, self.circumference.local, previous)
        return circumference if self.leaks is None else circumference.with_leak(self.leaks)

    def curve(self) -> list[FormPoint]:
        """Points of the curve, as far as they can be calculated."""
        points = []
        for factor in _FACTORS if self.form.felt_waves else ():
            try:
                circumference = self.with_form(self.form.scale(factor))
            except (ConvergenceError, OpenSealError):
                break
            points.append(
                FormPoint(factor, float(np.ptp(circumference.gap_change)), *self.evaluate(circumference))
            )
        return points

    def alone(self, wave: Wave) -> WaveAlone:
        circumference = self.with_form(replace(self.form, waves=(wave,), highest=wave.waves))
        return WaveAlone(wave.waves, wave.amplitude, *self.evaluate(circumference))

    def leak_with_wave(self, number: int, amplitude: float) -> float:
        """With one wave beside the eccentricity and tilt that there are, widest where they are."""
        rigid = tuple(wave for wave in self.form.waves if wave.waves == 1)
        zone = WaveTolerance(amplitude, (number, number))
        return self.leak_rate(replace(self.form, waves=rigid, tolerance=zone, highest=1).with_waves(number))

    def leak_rate(self, form: FormError) -> float:
        """Infinite where the form error is too large to be solved."""
        try:
            rate = _rate(self.with_form(form))
        except (ConvergenceError, OpenSealError):
            return math.inf
        return math.inf if rate is None else rate


def _rate(circumference: Circumference) -> float | None:
    return None if circumference.leak is None else circumference.leak.leak_rate


def _closing_force(solver: LoadSolver, load: CaseLoad) -> float | None:
    """Force of spring or actuator at which the seal is closed all around."""
    circumference = load.circumference
    if circumference is None or not circumference.form.uneven:
        return None

    trials = Trials([solver], load.fluid_pressure)
    lowest, highest = sensible_forces([solver.problem])

    def deficit(place: float) -> float:
        shape = trials.load(place).circumference
        return CLOSED_SHARE - (1.0 if shape is None else shape.least_over_mean)

    start = math.log(load.contact_force)
    zero = find_zero(deficit, start, lowest=lowest, highest=highest, step=0.5, accuracy=_ACCURACY)
    return trials.load(zero.place).applied_force if zero is not None and zero.end is None else None


def _goes_round(load: CaseLoad) -> float | None:
    circumference, rough = load.circumference, load.rough
    if circumference is None or rough is None or rough.flow is None or rough.table is None:
        return None
    step = max(len(circumference.angle) // _ANGLES, 1)
    table, profiles = rough.table, circumference.profiles(step)
    pressure = np.array([profile.equivalent(table, rough.surface).pressure for profile in profiles])
    return rough.flow.goes_round(table, load.tightest, pressure, load.fluid_pressure)


def _shallower(scratches: Sequence[tuple[float, float] | None]) -> tuple[float, float] | None:
    """The one that is allowed in every reading."""
    allowed = [scratch for scratch in scratches if scratch is not None]
    return min(allowed) if len(allowed) == len(scratches) else None


def _deepest_scratch(case: Case, load: CaseLoad, trial: _FormLoad) -> tuple[float, float] | None:
    """In place of the widest one, of its proportions; all others and the lay leak as they do."""
    limit = _limit(case, load)
    grooves = [(x, x.groove) for x in trial.circumference.form.grooves if isinstance(x.groove, leak.Scratch)]
    if not grooves or limit is None:
        return None
    place, widest = max(grooves, key=lambda pair: pair[1].width)
    if trial.leaks is None or trial.load.leak is None:
        return None
    flow, profile = trial.leaks.flow, trial.circumference.profile_at(place.angle)
    bare_rate = trial.load.leak.leak_rate - flow.bounds(profile, [widest]).largest_extra
    deepest = leak.deepest_scratch(
        lambda scratch: bare_rate + flow.bounds(profile, [scratch]).largest_extra,
        limit[1],
        width_over_depth=widest.width / widest.depth,
        angle=widest.angle,
    )
    return None if deepest is None else (deepest.depth, deepest.width)


def _limit(case: Case, load: CaseLoad) -> tuple[str, float] | None:
    """Leak rate that is wanted: what the case requires, its target, or the tightest class that the round seal meets."""
    if case.requirement is not None and case.requirement.judges(load.fluid_pressure):
        of_case = limits(case, load.fluid_pressure, load)
        # in the case's own fluid
        rates = [(limit.name, limit.leak_rate / limit.ratio[1]) for limit in of_case if limit.leak_rate > 0]
        return min(rates, key=lambda pair: pair[1], default=None)
    if case.load.target_leak_rate is not None:
        return "target", case.load.target_leak_rate
    classes = [
        entry
        for entry in leakage_classes(case, replace(load, circumference=None))
        if entry.name is not None and entry.limit is not None
    ]
    if not classes or not classes[0].limit or case.fluid is None:
        return None
    # in the case's own fluid
    ratio = test_of(case.fluid, load.fluid_pressure, load)[1][1]
    return f"{classes[0].standard} {classes[0].name}", classes[0].limit / ratio


def _allowed_form(case: Case, load: CaseLoad, trial: _FormLoad, form: FormError) -> AllowedForm | None:
    limit = _limit(case, load)
    if case.form is None or limit is None or load.leak is None:
        return None
    name, rate = limit
    axial = load.contact.model.touch_normal_z
    radial = math.sqrt(max(1.0 - axial**2, 0.0))
    direction, share = ("radial", radial) if radial > _FLAT else ("axial", axial)
    round_rate = math.inf if trial.load.leak_round is None else trial.load.leak_round.leak_rate
    if round_rate > rate:
        return AllowedForm(name, rate, None, None, direction, None)
    height = float(np.ptp(trial.circumference.gap_change))
    factor = (
        _largest_size(lambda f: trial.leak_rate(trial.form.scale(f)), rate, 1.0, _MOST_GAP / height)
        if height
        else math.inf
    )
    fewest, most = _WAVES if form.tolerance is None else form.tolerance.waves
    zones = {
        number: 2 / share * _largest_size(partial(trial.leak_with_wave, number), rate, _FIRST_GAP, _MOST_GAP)
        # the bodies even out more waves less; the fewest are asked as well, because thin walls may not
        for number in {fewest, most}
    }
    worst = min(zones, key=lambda n: zones[n])
    return AllowedForm(name, rate, factor, zones[worst], direction, worst)


def _largest_size(leak_rate: Callable[[float], float], limit: float, start: float, most: float) -> float:
    """Largest size with no more than the allowed leak rate; infinite if `most` has it."""

    def room(log_size: float) -> float:
        return max(math.log(limit / max(leak_rate(math.exp(log_size)), 1e-300)), -700.0)

    first, highest = math.log(start), math.log(most)
    zero = find_zero(room, first, lowest=first - _WAY, highest=highest, step=_STEP, accuracy=_ACCURACY)
    assert zero is not None  # it is known everywhere
    if zero.end is not None:
        return math.inf if zero.end is End.HIGHEST else 0.0
    return math.exp(zero.place)


def _compute(seal: SolvedSeal, request: Request) -> FormAnswers:
    case = seal.case
    form = case.form_error
    assert form is not None  # of `needs`
    return form_answers(request.solver, case, seal.highest, form)


FORM = Answer[FormAnswers | None](
    "form",
    "answers about the form error",
    _compute,
    None,
    status="what the form error means",
    needs=("problem.form",),
)
