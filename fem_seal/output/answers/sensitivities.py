"""What would change the leak most, in an engineer's words."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING

from fem_seal.answers.sensitivities import Sensitivity
from fem_seal.answers.solution import SealSolution
from fem_seal.case.case import Case
from fem_seal.case.material_table import UNNAMED
from fem_seal.case.notation import partner
from fem_seal.output.columns import ReadableTable
from fem_seal.output.shown import AnswerPage, Shown, decisive, worded_section, worded_table
from fem_seal.seal.load_result import load_name
from fem_seal.units import format_digits, range_text, trim_zeros, unit_for
from fem_seal.wording import phrase, say_all

if TYPE_CHECKING:
    from fem_seal.answers.case_load import CaseLoad
    from fem_seal.units import Display

# So many are told, and none that changes the leak by less.
_TOLD, _SMALLEST = 3, 0.03
# Scaled by a factor, and told without their value.
_SCALED = ("rms_height", "hardness", "youngs_modulus", "q_rolloff", "hurst")
# Beyond it a leak is told as a multiple and not in per cent more.
_MULTIPLE = 2.0


def shown_sensitivities(found: Sequence[Sensitivity]) -> list[Sensitivity]:
    """Those that a drawing or an order can change and that change the leak by 3 % or more in both readings.

    Parameters
    ----------
    found : sequence of Sensitivity
    """
    return [
        one
        for one in found
        if one.drawn and one.strength > 0 and min(abs(1.0 - ratio) for ratio in one.ratio) >= _SMALLEST
    ]


def strongest(found: Sequence[Sensitivity]) -> list[Sensitivity]:
    """The strongest of those that are shown and do not fail elsewhere, the best of all materials among them.

    Parameters
    ----------
    found : sequence of Sensitivity
    """
    shown = [one for one in shown_sensitivities(found) if one.helps is not False]
    material = next((one for one in shown if one.material), None)
    return [one for one in shown if not one.material or one is material][:_TOLD]


def in_words(case: Case, one: Sensitivity) -> str:
    """A sensitivity as a sentence: "halving Ra cuts the leak by 82 to 89 %".

    Parameters
    ----------
    case : Case
    one : Sensitivity
    """
    return f"{step_in_words(case, one)} {effect_in_words(one)}"


def step_in_words(case: Case, one: Sensitivity) -> str:
    """What is changed, and by how much: "halving Ra", "10 % more force of spring or actuator".

    Parameters
    ----------
    case : Case
    one : Sensitivity
    """
    if one.key == "force":
        assert one.before is not None and one.after is not None  # of a force
        if one.before > 0:
            return phrase("sensitivities.step", "force", more=one.factor - 1.0)
        return phrase("sensitivities.step", "force_added", added=one.after - one.before)
    if one.material:
        body, own = _body_of(case, one.key)
        own = "its own" if own == UNNAMED else own
        return phrase("sensitivities.step", "material", body=body, material=one.material, own=own)
    if one.key == "form":
        parts = () if case.form is None else case.form.parts.values()
        drawn = parts and all(part.tolerance is not None for part in parts)
        return phrase("sensitivities.step", "tolerance" if drawn else "form")
    if one.key.startswith("roughness."):
        _, _, height = one.key.split(".")
        face, _ = _body_of(case, one.key.removeprefix("roughness."))
        return phrase("sensitivities.step", "finish", finish=f"{height} of the {face}")
    if one.key in _SCALED:
        finish = _finish(case)
        if one.key == "rms_height" and one.factor < 1 and finish:
            return phrase("sensitivities.step", "finish", finish=finish)
        key = f"{one.key}_{'more' if one.factor > 1 else 'less'}"
        return phrase("sensitivities.step", key, one=one)
    return _dimension(case, one)


def _body_of(case: Case, key: str) -> tuple[str, str]:
    """What the body is called to which a key belongs, and its material."""
    first, *others = case.every_body
    body = next((body for body in others if key.startswith(f"{body.key}.")), first)
    return body.label, body.table.material.name


def _finish(case: Case) -> str:
    """The heights that the drawing gives: "Ra"; empty where the roughness is given otherwise."""
    roughness = case.roughness
    if roughness is None or len(roughness.finishes) < len(roughness.parts):
        return ""
    heights = [one.height for one in roughness.finishes.values() if one.height is not None]
    return " and ".join(dict.fromkeys(heights))


def _dimension(case: Case, one: Sensitivity) -> str:
    """In the words of the case: where it has diameters and included angles, in these."""
    assert one.before is not None and one.after is not None  # of a dimension
    first, _, both = one.key.partition(" and ")
    table, _, key = first.partition(".")
    body, _ = _body_of(case, first)
    more, word = one.after - one.before, partner(key)
    if key == "angle" and word and word in case.written[table]:
        more, key = -2.0 * more, word
    elif (
        key.endswith("radius")
        and word
        and key != "edge_radius"
        and any(name.endswith("diameter") for name in case.written[table])
    ):
        more, key = 2.0 * more, word
    unit = unit_for("angle" if key.endswith("angle") else "length", abs(more))
    by = f"{trim_zeros(unit.of(abs(more)))} {unit.name} {'larger' if more > 0 else 'smaller'}".replace(
        " °", "°"
    )
    what = key.replace("_", " ")
    return phrase("sensitivities.step", "angles" if both else "dimension", by=by, body=body, what=what)


def effect_in_words(one: Sensitivity) -> str:
    """What the step does, in both readings: "cuts the leak by 82 to 89 %", and whether not everywhere.

    Parameters
    ----------
    one : Sensitivity
    """
    effect = _effect(one)
    return effect + phrase("sensitivities.words", "elsewhere") if one.helps is False else effect


def _effect(one: Sensitivity) -> str:
    low, high = sorted(one.ratio)
    if high == 0:
        return phrase("sensitivities.words", "closes")
    if low == math.inf:
        return phrase("sensitivities.words", "opens")
    if high < 1:
        return phrase("sensitivities.words", "cuts", part=range_text(_less(high), _less(low)))
    if low >= 1 and high < _MULTIPLE:
        part = range_text(*(f"{100 * (end - 1):.0f}" for end in (low, high)))
        return phrase("sensitivities.words", "raises", part=part)
    ends = range_text(*(format_digits(end, 2) if end else "0" for end in (low, high)))
    return phrase("sensitivities.words", "multiplies", ratio=ends)


def _less(ratio: float) -> str:
    """Per cent by which a leak is cut, with so many decimals that what is left of it can be read."""
    decimals = max(math.ceil(-math.log10(ratio)) - 2, 0) if ratio else 0
    return f"{100 * (1 - ratio):.{decimals}f}"


def _exponents(one: Sensitivity) -> str:
    if any(map(math.isnan, one.exponents)):
        return "–"
    ends = range_text(*(format_digits(end, 2) for end in sorted(one.exponents)))
    return ends if one.straight else phrase("sensitivities.words", "locally", exponents=ends)


def sensitivity_lines(result: SealSolution) -> list[str]:
    """The strongest sensitivities in sentences; empty if nobody asked or nothing moves the leak rate.

    Parameters
    ----------
    result : SealSolution
    """
    at = load_of(result)
    changes = (in_words(result.case, one) for one in strongest(result.sensitivities))
    return [phrase("sensitivities.words", "strong", load=at, change=change) for change in changes]


def change_in_brief(result: SealSolution, load: CaseLoad) -> str:
    """The change that helps most at a load, and whether it is enough for a pass; empty if none is known.

    Parameters
    ----------
    result : SealSolution
    load : CaseLoad
    """
    found = next((one for one in result.sensitivities if one.helps), None)
    if found is None:
        return ""
    # times the limit, at least, after the change
    left = 0.0 if load.judgement is None else load.judgement.times_over * max(found.ratio)
    alone = ", which alone is not enough" if left > 1.0 else ""
    what, at = in_words(result.case, found), load_name(load, result.loads)
    return phrase("sensitivities.words", "helps", what=what, at=at, alone=alone)


def load_of(result: SealSolution) -> str:
    """The load at which the leak rate is changed, by its name.

    Parameters
    ----------
    result : SealSolution
    """
    judged = result.judgement
    load = result.highest if judged is None or judged.number is None else result.loads[judged.number]
    return load_name(load, result.loads)


def sensitivity_table(result: SealSolution) -> ReadableTable:
    """All sensitivities that are shown: step, effect, exponent; no rows if nobody asked.

    Parameters
    ----------
    result : SealSolution
    """
    rows = [
        {
            "step": step_in_words(result.case, one),
            "effect": effect_in_words(one),
            "exponents": _exponents(one),
        }
        for one in shown_sensitivities(result.sensitivities)
    ]
    return worded_table("sensitivities", rows)


def _page(result: SealSolution, display: Display) -> AnswerPage:
    change = change_in_brief(result, decisive(result))
    notes = say_all(display, "sensitivities", "notes", load=load_of(result), both=result.highest.others)
    return AnswerPage(
        decides=[change] if change else (),
        section=worded_section("sensitivities", notes, sensitivity_table(result)),
        details=sensitivity_lines(result),
    )


SHOWN = Shown(
    lambda result: result.sensitivities,
    # under the key that result files have had from the beginning
    summary=lambda result: {
        "levers": [asdict(one) | {"says": in_words(result.case, one)} for one in result.sensitivities]
    },
    absent={"levers": []},
    page=_page,
)
