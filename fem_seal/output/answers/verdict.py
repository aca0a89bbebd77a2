"""The verdict on a requirement in sentences, its basis, and the limits that `fem-seal check` lists."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Sequence
from typing import TYPE_CHECKING, Any

from fem_seal import units
from fem_seal.answers import leakage_class
from fem_seal.answers.judgement import RANK, Limit, SealVerdict, Utilisation, Verdict, VerdictReason, worst_of
from fem_seal.case.fields import Bubbles, NormalVolume
from fem_seal.errors import write
from fem_seal.materials import ROOM_TEMPERATURE
from fem_seal.output.answer_output import AnswerOutput, AnswerPage, Tile, decisive, worded_section
from fem_seal.seal.findings import ORDERS_OF_MAGNITUDE, YIELD_STRESS, Level
from fem_seal.seal.load_result import load_name
from fem_seal.seal.scenarios import SCENARIOS
from fem_seal.units import Display
from fem_seal.wording import say, say_all
from leak import millilitres_per_minute

if TYPE_CHECKING:
    from fem_seal.answers.case_load import AnyLoad, CaseLoad
    from fem_seal.answers.judgement import VerdictForce
    from fem_seal.answers.solution import SealSolution
    from fem_seal.case.case import Case


# Factors beyond this are shown as "more than".
_LARGEST_FACTOR, _FAR_IN_WORDS = 1e6, "a million"


def factor_text(factor: float, digits: int = 2) -> str:
    """A factor with its significant digits, and more digits where it is close to one.

    Parameters
    ----------
    factor : float
    digits : int

    Examples
    --------
    >>> factor_text(3.1415), factor_text(43210.0), factor_text(4e7), factor_text(0.99)
    ('3.1', '43000', 'more than a million', '0.99')
    >>> factor_text(1.004)
    '1.004'
    """
    if factor > _LARGEST_FACTOR:
        return f"more than {_FAR_IN_WORDS}"
    return units.format_digits(factor, units.digits_at_limit(factor, 1.0, digits))


def worst_verdict(result: SealSolution) -> Verdict | None:
    """The worst of the case's loads and of the tests of the standard; None without a requirement.

    Parameters
    ----------
    result : SealSolution
    """
    tested = worst_of(result.standard_tests) if result.standard_tests else None
    verdicts = [verdict for verdict in (result.verdict, tested) if verdict is not None]
    return max(verdicts, key=RANK.__getitem__, default=None)


def verdict_words(verdict: Verdict) -> str:
    """A verdict as a part of a sentence.

    Parameters
    ----------
    verdict : Verdict

    Examples
    --------
    >>> verdict_words(Verdict.PASS), verdict_words(Verdict.FAIL_UNLESS)
    ('pass', 'fail unless the model error is larger than stated')
    """
    return f"{verdict} the model error is larger than stated" if verdict.endswith("unless") else str(verdict)


def verdict_sentences(result: SealSolution) -> list[str]:
    """The verdict in one line, and its basis in further sentences; empty without a requirement.

    Parameters
    ----------
    result : SealSolution
    """
    judgement = result.judgement
    if judgement is None:
        return []
    return [f"{verdict_in_brief(result)}.", *_basis(result, judgement)]


def verdict_in_brief(result: SealSolution) -> str:
    """The verdict in one line, and how many pass where it is open; empty without a requirement.

    Parameters
    ----------
    result : SealSolution
    """
    judgement = result.judgement
    if judgement is None:
        return ""
    line, passes = _verdict(result, judgement), _passes(result, judgement)
    return f"{line}; {passes}" if passes and judgement.verdict is Verdict.INCONCLUSIVE else line


def _passes(result: SealSolution, judgement: SealVerdict) -> str:
    """How many seals pass at the deciding load; empty where nobody knows."""
    passing = None if judgement.number is None else result.loads[judgement.number].chance
    if passing is None or passing.why_none:
        return ""
    return say(result.display, "verdict", "passes_brief", chance=passing)


def _digits(result: SealSolution, judgement: SealVerdict) -> int:
    """Significant digits of the deciding leak rate, two at most, as for an interval."""
    return 2 if judgement.number is None else min(result.loads[judgement.number].leak_digits, 2)


def _doubt(result: SealSolution, judgement: SealVerdict) -> str:
    """Reason why the deciding load is doubtful; empty if it is not, and where it fails whatever the doubt."""
    if judgement.number is None or judgement.worst.why not in (VerdictReason.LIMIT, VerdictReason.INTERVAL):
        return ""
    if judgement.worst.verdict is Verdict.FAIL and judgement.worst.times_over > ORDERS_OF_MAGNITUDE:
        return ""
    validity = result.loads[judgement.number].validity
    return validity.reasons_in(result.display)[0] if validity.level is Level.DOUBTFUL else ""


# Heights over the usual ones above which the local exponent predicts the leak rate.
_LOWEST_HEIGHT = 0.4
# Reasons that compare an interval with the limit; those behind the first leave it inside.
_BY_INTERVAL = (VerdictReason.LIMIT, VerdictReason.INTERVAL, VerdictReason.ACCURACY)
# Reasons whose sentences have no leak rate.
_WITHOUT_RATES = (VerdictReason.OPEN, VerdictReason.OUTSIDE, VerdictReason.UNKNOWN)


def _place(result: SealSolution, judgement: SealVerdict) -> str:
    if judgement.number is not None:
        return load_name(result.loads[judgement.number], result.every_load, result.display)
    pressure = result.display.quantity(judgement.fluid_pressure, "given fluid pressure")
    if judgement.applied_force:
        return f"{pressure} with {result.display.quantity(judgement.applied_force, 'given force')}"
    return pressure


def _verdict(result: SealSolution, judgement: SealVerdict) -> str:
    display = result.display
    worst, limit, key = judgement.worst, judgement.worst.limit, _sentence(judgement)
    digits = _digits(result, judgement)
    volume = leakage_class.volume_of(result.case)
    load = _place(result, judgement)
    if judgement.number is not None and result.loads[judgement.number].after_test:
        load = f"{load} after the leak test"
    if worst.verdict is not Verdict.INCONCLUSIVE and _doubt(result, judgement):
        load = f"{load}, with doubt"
    measured = [volume.measurable(end) for end in worst.ends]
    if key in ("pass", "invisible") and not measured[1]:
        key = "unmeasurable"
    low, high = measured
    # the ends in the sentence have the same unit as the limit
    rates = {"pass": worst.ends[1:], "fail": worst.ends[:1]}.get(key, worst.ends)
    over = [end / limit.leak_rate for end in measured]
    # what is seen has no number beside which others stand
    compared = 0.0 if limit.visible else limit.leak_rate
    of_case, allowed = (limit.name == leakage_class.OF_LEAK_RATE, _limit_text(display, limit, rates=rates))
    of = f" of {limit.test_fluid}" if limit.test_fluid else ""
    written = _as_written(limit.leak_rate).removeprefix(", ")
    return say(
        display,
        "verdict",
        f"line_{key}",
        load=load,
        who="the limit" if of_case else limit.name,
        compared=f"the allowed {allowed}{f' ({written})' if written else ''}"
        if of_case
        else f"the {allowed} of {limit.name}",
        low=f"{_amount(display, low, digits, compared)}{of}",
        high=f"{_amount(display, high, digits, compared)}{of}",
        range=display.leak_range((low, high), digits, beside=(compared,)),
        factor=factor_text(worst.margin, digits),
        times_low=factor_text(over[0], digits),
        times_range=units.range_text(*(factor_text(ratio, digits) for ratio in over)),
        fluid=limit.test_fluid,
        reason=worst.reason,
        off=factor_text(worst.off),
        doubts=_doubts(result, judgement),
        likely=f" ({passes})" if (passes := _passes(result, judgement)) else "",
    )


def _doubts(result: SealSolution, judgement: SealVerdict) -> str:
    """By what the calculation may be off in the direction of the limit: "lay, long waves"."""
    if judgement.number is None:
        return ""
    more = judgement.worst.verdict is Verdict.PASS_UNLESS
    return ", ".join(
        dict.fromkeys(cause.kind for cause in result.loads[judgement.number].leak_validity.widens(more=more))
    )


def _sentence(judgement: SealVerdict) -> str:
    """Key of the sentence."""
    worst = judgement.worst
    if worst.why is VerdictReason.UNKNOWN and judgement.number is None:
        return "no_result"
    if worst.why is VerdictReason.UNKNOWN and math.isnan(worst.limit.leak_rate):
        return "no_limit"
    if worst.why is VerdictReason.ACCURACY:
        return "sealed_unless" if math.isinf(worst.off) else worst.verdict
    if worst.why is VerdictReason.FAR and not worst.reason:
        return "far_unsampled"
    if worst.why is not VerdictReason.LIMIT:
        return worst.why
    if worst.verdict == "fail":
        return "visible_fail" if worst.limit.visible else "fail"
    if math.isinf(worst.margin):
        return "sealed"
    return "invisible" if worst.limit.visible else "pass"


def _state(case: Case, limit: Limit) -> str:
    """In which a gas is measured: of a standard that tests with another one that of its test."""
    tested = units.LeakVolume.of_gas(ROOM_TEMPERATURE) if limit.test_fluid else leakage_class.volume_of(case)
    return case.display.state_of(tested)


def _as_written(leak_rate: float) -> str:
    """A limit as given, if in another state or in bubbles: ", 1 Nml/min"; empty for all others."""
    if isinstance(leak_rate, NormalVolume):
        return (
            f", {units.trim_zeros(units.round_digits(millilitres_per_minute(leak_rate.normal), 4))} Nml/min"
        )
    if isinstance(leak_rate, Bubbles):
        count = units.trim_zeros(units.round_digits(60.0 * leak_rate.count, 4))
        return f", {count} bubbles/min{_of_bubbles(leak_rate)}"
    return ""


def _of_bubbles(leak_rate: float) -> str:
    """Volume of a bubble of a limit that is given in them: " of 0.15 ml"; empty for all others."""
    volume = leak_rate.volume if isinstance(leak_rate, Bubbles) else 0.0
    return f" of {say(Display(), 'verdict', 'bubble', volume=volume)}" if volume else ""


def allowed_in_words(display: Display, loads: Sequence[AnyLoad]) -> str:
    """What the loads are held against, in a clause: "allowed: 0.3 ml/min"; empty where nothing is required.

    Parameters
    ----------
    display : Display
    loads : sequence of CaseLoad or MissingLoad
        Those without a judgement are passed over.
    """
    judged_loads = [load for load in loads if getattr(load, "judgement", None) is not None]
    limits = [load.judgement.limit for load in judged_loads]  # type: ignore[union-attr]
    known_limits = [limit for limit in limits if limit.visible or not math.isnan(limit.leak_rate)]
    if not known_limits:
        return ""
    rates = [limit.leak_rate for limit in known_limits]
    if any(limit.visible for limit in known_limits):
        allowed = _limit_text(display, known_limits[0])
    elif len(set(rates)) == 1:
        allowed = display.quantity(rates[0], f"given flow {units.DIGITS}")
    else:
        allowed = display.leak_range((min(rates), max(rates)))
    names = [limit.name for limit in known_limits if limit.name != leakage_class.OF_LEAK_RATE]
    of = f" of {known_limits[0].test_fluid}" if known_limits[0].test_fluid else ""
    of_class = "".join(f" ({name})" for name in dict.fromkeys(names))
    origin = _of_bubbles(rates[0]) or of_class or _as_written(rates[0])
    return say(display, "verdict", "check_beside", allowed=f"{allowed}{of}{origin}")


def _basis(result: SealSolution, judgement: SealVerdict) -> Iterator[str]:
    """Sentences that follow the verdict: its assumptions, its load, and what would turn it."""
    display = result.display
    if tests := worst_of(result.standard_tests):
        yield say(display, "standard_tests", "says_verdict", verdict=verdict_words(tests))
    if likely := _pass_sentence(result):
        yield likely
    volume = leakage_class.volume_of(result.case)
    if display.state_of(volume) and judgement.worst.why not in _WITHOUT_RATES:
        yield say(display, "verdict", "basis_volume", state=_state(result.case, judgement.worst.limit))
    limit, decided = judgement.worst.limit, judgement.worst.why in _BY_INTERVAL
    if limit.bubble_volume is not None:
        yield say(display, "verdict", "basis_bubble", limit=limit)
    if limit.test_fluid and decided and not math.isinf(judgement.margin):
        yield say(
            display, "verdict", "basis_converted", fluid=limit.test_fluid, ratio=tuple(sorted(limit.ratio))
        )
    if reason := _doubt(result, judgement):
        yield say(display, "verdict", "basis_doubtful", reason=reason, load=_place(result, judgement))
    if measured := would_pass(result):
        yield f"{measured}."
    yield from _in_scenarios(result, judgement)
    count = len(judgement.load_numbers) + judgement.left_out
    if count > 1:
        yield say(display, "verdict", "basis_several", count=count, load=_place(result, judgement))


def would_pass(result: SealSolution) -> str:
    """Measurement that may turn an inconclusive verdict into a pass; empty if there is none.

    Parameters
    ----------
    result : SealSolution
    """
    judgement = result.judgement
    undecided = _BY_INTERVAL[1:]
    if judgement is None or judgement.number is None or judgement.worst.why not in undecided:
        return ""
    heights = [_passing_height(result, number) for number in judgement.load_numbers]
    height, number = min(zip(heights, judgement.load_numbers, strict=True))
    if height < _LOWEST_HEIGHT:
        return ""
    profiles, load = result.error_shares[number].by_profiles, result.loads[number]
    assert profiles is not None  # of a height
    yields = any(caution.kind == YIELD_STRESS for caution in load.validity.cautions)
    at, length = load_name(load, result.loads, result.display), profiles.length
    return say(result.display, "verdict", "turns_profile", length=length, height=height, at=at, curve=yields)


def _passing_height(result: SealSolution, number: int) -> float:
    """Rms height over the usual one up to which a load passes with measured profiles; zero where nobody knows."""
    profiles = result.error_shares[number].by_profiles if number < len(result.error_shares) else None
    load = result.loads[number]
    judgement = load.judgement
    if (
        profiles is None
        or judgement is None
        or load.leak_interval is None
        or judgement.why not in _BY_INTERVAL
    ):
        return 0.0
    return profiles.passing_height(judgement.margin * load.leak_interval.high)


def _in_scenarios(result: SealSolution, judgement: SealVerdict) -> Iterator[str]:
    """Verdict in a scenario with contacts of its own, if it differs."""
    sampled = judgement.number is not None and result.loads[judgement.number].sample_ends is not None
    for name, (place, verdict, usual) in result.judgement_beside.items():
        yield say(
            result.display,
            "verdict",
            f"basis_{'beside_as_given' if sampled else 'beside'}",
            scenario=SCENARIOS[name].title,
            verdict=verdict_words(verdict.verdict),
            usual=verdict_words(usual),
            rate=result.display.leak_range(verdict.ends, 2, beside=(verdict.limit.leak_rate,)),
            load=load_name(result.loads[place], result.loads, result.display),
        )


def _amount(display: Display, leak_rate: float, digits: int, limit: float) -> str:
    """A leak rate with enough digits to be on the correct side of the limit in the sentence."""
    if not 0 < leak_rate < math.inf:
        return display.leak_range(leak_rate)
    unit = display.flow_unit((leak_rate, limit)) or display.unit_for("flow", leak_rate)
    value, allowed = unit.of(leak_rate), units.round_digits(unit.of(limit), 2)
    return f"{units.format_digits(value, units.digits_at_limit(value, allowed, digits))} {unit.name}"


def _limit_text(display: Display, limit: Limit, rates: Collection[float] = ()) -> str:
    if limit.visible:
        return "no visible leakage"
    return display.leak_range(limit.leak_rate, 2, beside=rates)


def used_in_words(result: SealSolution, shares: Utilisation) -> str:
    """Shares of yield stress and hardness, and the margin to opening: "12 % of the hardness, ..."; empty if unknown.

    Parameters
    ----------
    result : SealSolution
    shares : Utilisation
    """
    return ", ".join(
        say(result.display, "verdict", f"used_{name}", share=share, body=result.case.label_of(shares.body))
        for name, share in _shares(result, shares).items()
    )


def _shares(result: SealSolution, shares: Utilisation) -> dict[str, str]:
    """Known shares, in per cent."""
    digits = min(2, *(load.pressure_digits for load in result.loads))
    bodies = {"yield": shares.yield_stress, "hardness": shares.hardness}
    used = {
        name: f"{units.format_digits(100 * share, units.digits_at_limit(100 * share, 100, digits))} %"
        for name, share in bodies.items()
        if share is not None
    }
    return used if shares.opening is None else {**used, "opening": units.percent(shares.opening)}


_USED = {"yield": "Of the yield stress", "hardness": "Of the hardness", "opening": "Margin to opening"}
FORCE_TO_PASS = "Force for a pass"


def tiles(result: SealSolution) -> Iterator[Tile]:
    """Margin, share that passes, force for a pass and utilisation; none without a requirement or such a force.

    Parameters
    ----------
    result : SealSolution
    """
    display = result.display
    judgement, load = result.judgement, decisive(result)
    level, likely = load.validity.level, least_likely(result.loads)
    if judgement is not None:
        margin = "sealed" if math.isinf(judgement.margin) else "–"
        if math.isfinite(judgement.margin):
            margin = factor_text(judgement.margin, _digits(result, judgement))
        yield Tile("Margin", margin, say(display, "verdict", "tile_margin"), 10, level)
    if likely is not None and likely.chance is not None and not likely.chance.why_none:
        at = load_name(likely, result.loads, display)
        share = say(display, "verdict", "probability", share=likely.chance.share, error=likely.chance.error)
        yield Tile("Passes", share, say(display, "verdict", "tile_passes", load=at), 15, level)
    if force := load.verdict_force:
        none = "none" if force.looked_for else "not calculated"
        value = none if force.force is None else force_to_pass(display, force.force)
        remark = say(display, "verdict", "tile_force", force=force)
        yield Tile(FORCE_TO_PASS, value, remark, 40, load.validity.of_contact.level)
    shares = {} if judgement is None else _shares(result, judgement.shares)
    for name, share in shares.items():
        body = result.case.label_of(judgement.shares.body) if judgement is not None else ""
        yield Tile(_USED[name], share, say(display, "verdict", f"tile_{name}", body=body), 85, level)


def least_likely(loads: Sequence[CaseLoad]) -> CaseLoad | None:
    """The load that keeps the requirement with the smallest probability; None where nothing is required.

    Parameters
    ----------
    loads : sequence of CaseLoad
    """
    judged_loads = [load for load in loads if load.chance is not None]
    known_loads = [load for load in judged_loads if not load.chance.why_none]  # type: ignore[union-attr]
    return min(known_loads or judged_loads, key=lambda load: load.chance.share, default=None)  # type: ignore[union-attr]


def _pass_sentence(result: SealSolution) -> str:
    """How likely the load passes that passes least often; empty where nobody knows."""
    load = least_likely(result.loads)
    if load is None or load.chance is None:
        return ""
    at = load_name(load, result.loads, result.display)
    return say(result.display, "verdict", "passes", load=at, chance=load.chance, tested=load.after_test)


def next_class_in_words(case: Case, load: CaseLoad) -> str:
    """The next better class, and the factor by which the leak would have to fall; empty if there is none.

    Parameters
    ----------
    case : Case
    load : CaseLoad
    """
    next_class = leakage_class.next_class(case, load)
    if next_class is None:
        return ""
    factor = factor_text(next_class.factor, min(load.leak_digits, 2))
    return say(case.display, "verdict", "next_class", tighter=next_class, factor=factor)


def next_class_of(result: SealSolution) -> str:
    """`next_class_in_words` of the highest load, for a case without requirement.

    Parameters
    ----------
    result : SealSolution
    """
    return "" if result.judgement is not None else next_class_in_words(result.case, result.highest)


def basis_lines(result: SealSolution) -> list[str]:
    """What the verdict is based on, and the force for a pass; without a requirement the next class.

    Parameters
    ----------
    result : SealSolution
    """
    judgement, forces = result.judgement, verdict_force_sentences(result.display, result.loads)
    if judgement is None:
        return [*filter(None, [next_class_of(result)]), *forces]
    used = say_all(result.display, "verdict", "used_all", used=used_in_words(result, judgement.shares))
    return [*_basis(result, judgement), *used, *forces]


def verdict_force_sentences(display: Display, loads: Sequence[CaseLoad]) -> list[str]:
    """The force with which the verdict passes at each fluid pressure, or why none does; empty if not requested.

    Parameters
    ----------
    display : Display
    loads : sequence of CaseLoad
    """
    forces = {load.fluid_pressure: load.verdict_force for load in loads if load.verdict_force is not None}
    # a force that was not calculated has the same reason at each pressure
    return list(
        dict.fromkeys(_verdict_force_sentence(display, pressure, force) for pressure, force in forces.items())
    )


def _verdict_force_sentence(display: Display, pressure: float, verdict_force: VerdictForce) -> str:
    force = "" if verdict_force.force is None else force_to_pass(display, verdict_force.force)
    values = {"pressure": pressure, "verdict_force": verdict_force, "force": force}
    return say(display, "verdict", "force", **values)


def force_to_pass(display: Display, force: float) -> str:
    """A force rounded up to three digits, so that the verdict passes with the shown value.

    Parameters
    ----------
    display : Display
    force : float
        [N]

    Examples
    --------
    >>> force_to_pass(Display(), 75148.8)
    '75.2 kN'
    """
    if force == 0.0:
        return display.quantity(0.0, "given force")
    step = 10.0 ** (math.floor(math.log10(abs(force))) - 2)
    return display.quantity(units.round_digits(step * math.ceil(force / step - 1e-9), 3), "given force")


def requirement_lines(case: Case) -> list[str]:
    """The limits and their loads; empty without a requirement.

    Parameters
    ----------
    case : Case
    """
    required, fluid = case.requirement, case.fluid
    if required is None or fluid is None:
        return []
    at: dict[tuple[str, float], tuple[Limit, list[float]]] = {}
    for pressure in dict.fromkeys(case.load.fluid_pressure):
        if required.judges(pressure):
            for limit in leakage_class.limits(case, pressure):
                at.setdefault((limit.name, limit.leak_rate), (limit, []))[1].append(pressure)
    limits = leakage_class.limits(case, case.load.fluid_pressure[0])
    sizes = [
        leakage_class.class_size(case, per_length=limit.name.startswith(tuple(leakage_class.PER_LENGTH)))[1]
        if limit.name != leakage_class.OF_LEAK_RATE
        else ""
        for limit in limits
    ]
    return say_all(
        case.display,
        "verdict",
        "check",
        limits_at=at.values(),
        states=dict.fromkeys(_state(case, limit) for limit in limits)
        if case.display.state_of(fluid.volume)
        else (),
        limits=zip(limits, sizes, strict=True),
        fluid_of_case=fluid.name,
    )


def verdict_numbers(result: SealSolution) -> dict[str, Any] | None:
    """The verdict on the requirement with its basis; None without a requirement."""
    judgement = result.judgement
    if judgement is None:
        return None
    worst, shares, likely = judgement.worst, judgement.shares, least_likely(result.loads)
    return {
        "verdict": str(judgement.verdict),
        "margin": judgement.margin,
        "pass_probability": None if likely is None else likely.pass_probability,
        "pass_probability_error": None if likely is None else likely.pass_probability_error,
        "batch_share_p05": None if likely is None else likely.batch_share_p05,
        "says": verdict_sentences(result),
        "limit": worst.limit.name,
        "allowed_m3_per_s": worst.limit.leak_rate,
        "test_fluid": worst.limit.test_fluid or None,
        "leak_rate_low_m3_per_s": worst.ends[0],
        "leak_rate_high_m3_per_s": worst.ends[1],
        "decided_by": str(worst.why),
        "fluid_pressure_Pa": judgement.fluid_pressure,
        "applied_force_N": judgement.applied_force,
        "judged_loads": len(judgement.load_numbers),
        "loads_without_result": judgement.left_out,
        "share_of_yield_stress": shares.yield_stress,
        "share_of_hardness": shares.hardness,
        "margin_to_opening": shares.opening,
    }


def _page(result: SealSolution, display: Display) -> AnswerPage:
    basis, next_class = basis_lines(result), next_class_of(result)
    return AnswerPage(
        tiles=[*tiles(result)],
        decides=[next_class] if next_class else (),
        section=worded_section(display, "verdict", basis) if result.judgement is not None else None,
        details=basis,
    )


OUTPUT = AnswerOutput(
    summary=lambda result: {
        "requirement": verdict_numbers(result),
        "verdict_force": [
            {
                "fluid_pressure_Pa": load.fluid_pressure,
                "force": force.force,
                "why_none": write(force.why_none, result.display),
                "looked_for": force.looked_for,
                "begins": write(force.begins, result.display),
            }
            for load in result.loads
            if (force := load.verdict_force) is not None
        ]
        or None,
    },
    page=_page,
)
