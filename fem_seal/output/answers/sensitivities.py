"""What would change the leak most, in an engineer's words."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict
from functools import partial
from typing import TYPE_CHECKING

from fem_seal.answers.sensitivities import Sensitivity
from fem_seal.answers.solution import SealSolution
from fem_seal.case.case import Case
from fem_seal.case.material_table import UNNAMED
from fem_seal.case.notation import partner
from fem_seal.output.answer_output import AnswerOutput, AnswerPage, decisive, worded_section, worded_table
from fem_seal.output.columns import ReadableTable
from fem_seal.seal.load_result import load_name
from fem_seal.units import format_digits, range_text
from fem_seal.wording import say, say_all

if TYPE_CHECKING:
    from fem_seal.answers.case_load import CaseLoad
    from fem_seal.units import Display

# So many are told, and none that changes the leak by less.
_TOLD, _SMALLEST = 3, 0.03


def shown_sensitivities(sensitivities: Sequence[Sensitivity]) -> list[Sensitivity]:
    """Those that a drawing or an order can change and that change the leak by 3 % or more in both readings.

    Parameters
    ----------
    sensitivities : sequence of Sensitivity
    """
    return [
        step
        for step in sensitivities
        if step.drawn and step.strength > 0 and min(abs(1.0 - ratio) for ratio in step.ratio) >= _SMALLEST
    ]


def strongest(sensitivities: Sequence[Sensitivity]) -> list[Sensitivity]:
    """The strongest of those that are shown and do not fail elsewhere, the best of all materials among them.

    Parameters
    ----------
    sensitivities : sequence of Sensitivity
    """
    helpful = [step for step in shown_sensitivities(sensitivities) if step.helps is not False]
    material = next((sensitivity for sensitivity in helpful if sensitivity.material), None)
    return [step for step in helpful if not step.material or step is material][:_TOLD]


def in_words(case: Case, sensitivity: Sensitivity) -> str:
    """A sensitivity as a sentence: "halving Ra cuts the leak by 82 to 89 %".

    Parameters
    ----------
    case : Case
    sensitivity : Sensitivity
    """
    return f"{step_in_words(case, sensitivity)} {effect_in_words(case.display, sensitivity)}"


def step_in_words(case: Case, sensitivity: Sensitivity) -> str:
    """What is changed, and by how much: "halving Ra", "10 % more force of spring or actuator".

    Parameters
    ----------
    case : Case
    sensitivity : Sensitivity
    """
    key = sensitivity.key.removeprefix("roughness.")
    parts = () if case.form is None else case.form.parts.values()
    body, material = _body_of(case, key)
    return say(
        case.display,
        "sensitivities",
        "step",
        step=sensitivity,
        body=body,
        present="its own" if material == UNNAMED else material,
        tolerance=parts and all(part.tolerance is not None for part in parts),
        finish=_finish(case),
        turned=case.roughness is not None and bool(case.roughness.turned_faces),
        dimension=partial(_dimension, case, sensitivity),
    )


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
    heights = [finish.height for finish in roughness.finishes.values() if finish.height is not None]
    return " and ".join(dict.fromkeys(heights))


def _dimension(case: Case, sensitivity: Sensitivity) -> tuple[str, float]:
    """A dimension and its change in the words of the case: where it has diameters and included angles, in these."""
    assert sensitivity.before is not None and sensitivity.after is not None  # of a dimension
    table, _, key = sensitivity.key.partition(" and ")[0].partition(".")
    more, word, names = sensitivity.after - sensitivity.before, partner(key), case.written[table]
    if key == "angle" and word and word in names:
        return word, -2.0 * more
    if key.endswith("radius") and key != "edge_radius" and any(name.endswith("diameter") for name in names):
        return (word, 2.0 * more) if word else (key, more)
    return key, more


def effect_in_words(display: Display, sensitivity: Sensitivity) -> str:
    """What the step does, in both readings: "cuts the leak by 82 to 89 %", and whether not everywhere.

    Parameters
    ----------
    display : Display
    sensitivity : Sensitivity
    """
    low, high = sorted(sensitivity.ratio)
    cut = range_text(_less(high), _less(low)) if high < 1 else ""
    values = {"ends": (low, high), "cut": cut, "elsewhere": sensitivity.helps is False}
    return say(display, "sensitivities", "effect", **values)


def _less(ratio: float) -> str:
    """Per cent by which a leak is cut, with so many decimals that what is left of it can be read."""
    decimals = max(math.ceil(-math.log10(ratio)) - 2, 0) if ratio else 0
    return f"{100 * (1 - ratio):.{decimals}f}"


def _exponents(display: Display, sensitivity: Sensitivity) -> str:
    if any(map(math.isnan, sensitivity.exponents)):
        return "–"
    ends = range_text(*(format_digits(end, 2) for end in sorted(sensitivity.exponents)))
    return ends if sensitivity.straight else say(display, "sensitivities", "words_locally", exponents=ends)


def sensitivity_lines(result: SealSolution) -> list[str]:
    """The strongest sensitivities in sentences; empty if nobody asked or nothing moves the leak rate.

    Parameters
    ----------
    result : SealSolution
    """
    display = result.display
    at = load_of(result)
    changes = (in_words(result.case, sensitivity) for sensitivity in strongest(result.sensitivities))
    return [say(display, "sensitivities", "words_strong", load=at, change=change) for change in changes]


def change_in_brief(result: SealSolution, load: CaseLoad) -> str:
    """The change that helps most at a load, and whether it is enough for a pass; empty if none is known.

    Parameters
    ----------
    result : SealSolution
    load : CaseLoad
    """
    sensitivity = next((sensitivity for sensitivity in result.sensitivities if sensitivity.helps), None)
    if sensitivity is None:
        return ""
    # times the limit, at least, after the change
    left = 0.0 if load.judgement is None else load.judgement.times_over * max(sensitivity.ratio)
    what, at = in_words(result.case, sensitivity), load_name(load, result.loads, result.display)
    return say(result.display, "sensitivities", "words_helps", what=what, at=at, alone=left > 1.0)


def load_of(result: SealSolution) -> str:
    """The load at which the leak rate is changed, by its name.

    Parameters
    ----------
    result : SealSolution
    """
    return load_name(decisive(result), result.loads, result.display)


def sensitivity_table(result: SealSolution) -> ReadableTable:
    """All sensitivities that are shown: step, effect, exponent; no rows if nobody asked.

    Parameters
    ----------
    result : SealSolution
    """
    rows = [
        {
            "step": step_in_words(result.case, sensitivity),
            "effect": effect_in_words(result.display, sensitivity),
            "exponents": _exponents(result.display, sensitivity),
        }
        for sensitivity in shown_sensitivities(result.sensitivities)
    ]
    return worded_table(result.display, "sensitivities", rows)


def _page(result: SealSolution, display: Display) -> AnswerPage:
    change = change_in_brief(result, decisive(result))
    notes = say_all(display, "sensitivities", "notes", load=load_of(result), both=result.highest.others)
    return AnswerPage(
        decides=[change] if change else (),
        section=worded_section(display, "sensitivities", notes, sensitivity_table(result)),
        details=sensitivity_lines(result),
    )


OUTPUT = AnswerOutput(
    lambda result: result.sensitivities,
    # under the key that result files have had from the beginning
    summary=lambda result: {
        "levers": [asdict(step) | {"says": in_words(result.case, step)} for step in result.sensitivities]
    },
    absent={"levers": []},
    page=_page,
)
