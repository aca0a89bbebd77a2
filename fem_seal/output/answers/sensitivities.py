"""The strongest levers in words and as a table."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import TYPE_CHECKING

from fem_seal.output.prose import phrase
from fem_seal.output.shown import ReadableTable, Shown, worded_table
from fem_seal.seal.load_names import load_name
from fem_seal.units import format_digits, range_text, trimmed, unit_for

if TYPE_CHECKING:
    from fem_seal.answers.sensitivities import Lever
    from fem_seal.answers.solution import SealSolution
    from fem_seal.case.case import Case


# Number of levers on the terminal, and smallest strength: a change of half a per cent is no lever.
_MOST, _SMALLEST = 3, 0.005
# Levers that are not the force and no dimension.
_STEPS = ("rms_height", "hardness", "youngs_modulus", "q_rolloff", "hurst")


def strongest_levers(result: SealSolution) -> list[Lever]:
    """The levers that the terminal shows.

    Parameters
    ----------
    result : SealSolution
    """
    return [one for one in result.levers if one.strength > _SMALLEST][:_MOST]


def step_in_words(case: Case, lever: Lever) -> str:
    """The change, with its size: "halve Ra", "10 % more force of spring or actuator".

    Parameters
    ----------
    case : Case
    lever : Lever
    """
    if lever.key == "force":
        assert lever.before is not None and lever.after is not None  # of a force
        if lever.before > 0:
            return phrase("levers.step", "force", more=lever.factor - 1.0)
        return phrase("levers.step", "force_added", added=lever.after - lever.before)
    if lever.key in _STEPS:
        key = f"{lever.key}_{'more' if lever.factor > 1 else 'less'}"
        finish = _finish(case)
        if key == "rms_height_less" and finish:
            return phrase("levers.step", "rms_height_less_finish", finish=finish)
        return phrase("levers.step", key, lever=lever)
    return _dimension(lever)


def _finish(case: Case) -> str:
    """Parameter of the drawing for the heights: "Ra"; empty where the roughness is given otherwise."""
    roughness = case.roughness
    if roughness is None or len(roughness.finishes) < len(roughness.parts):
        return ""
    heights = [one.height for one in roughness.finishes.values() if one.height is not None]
    return " and ".join(dict.fromkeys(heights))


def _dimension(lever: Lever) -> str:
    assert lever.before is not None and lever.after is not None  # of a dimension
    first, _, both = lever.key.partition(" and ")
    body, _, key = first.partition(".")
    kind = "angle" if key.endswith("angle") else "length"
    unit = unit_for(kind, lever.after - lever.before)
    by = f"{trimmed(unit.of(lever.after - lever.before))} {unit.name}".replace(" °", "°")
    if both:
        return phrase("levers.step", "angles", by=by)
    return phrase("levers.step", "dimension", by=by, body=body, what=key.replace("_", " "))


def ratio_in_words(lever: Lever) -> str:
    """The effect of the step: "leak × 0.20", or that it seals.

    Parameters
    ----------
    lever : Lever
    """
    low, high = sorted(lever.ratio)
    if high == 0:
        return phrase("levers.words", "sealed")
    ends = range_text(*(format_digits(one, 2) if one else "0" for one in (low, high)))
    return phrase("levers.words", "effect", ratio=ends)


def _exponents(lever: Lever) -> str:
    if any(map(math.isnan, lever.exponents)):
        return "–"
    return range_text(*(format_digits(one, 2) for one in sorted(lever.exponents)))


def lever_lines(result: SealSolution) -> list[str]:
    """The strongest levers, for the terminal; empty if not calculated or without effect on the leak rate.

    Parameters
    ----------
    result : SealSolution
    """
    found = strongest_levers(result)
    if not found:
        return []
    lines = [phrase("levers.words", "heading", load=_load(result)) + ":"]
    for one in found:
        exponent = phrase(
            "levers.words", "exponent" if one.straight else "locally", exponents=_exponents(one)
        )
        lines.append(f"  {step_in_words(result.case, one)}: {ratio_in_words(one)} ({exponent})")
    return lines


def _load(result: SealSolution) -> str:
    judged = result.judgement
    load = result.highest if judged is None or judged.number is None else result.loads[judged.number]
    return load_name(load, result.loads)


def lever_table(result: SealSolution) -> ReadableTable:
    """All levers with an effect on the leak rate: step, ratio, exponent; no rows if not calculated.

    Parameters
    ----------
    result : SealSolution
    """
    rows = [
        {"step": step_in_words(result.case, one), "ratio": ratio_in_words(one), "exponents": _exponents(one)}
        for one in result.levers
        if one.strength > _SMALLEST
    ]
    return worded_table("levers", rows)


def lever_note(result: SealSolution) -> str:
    """Explanation of the table of levers.

    Parameters
    ----------
    result : SealSolution
    """
    both = "note_both" if result.highest.yields else ""
    return phrase("levers.words", "note", both, load=_load(result))


SHOWN = Shown(
    summary=lambda result: {
        "levers": [
            asdict(one) | {"says": f"{step_in_words(result.case, one)}: {ratio_in_words(one)}"}
            for one in result.levers
        ]
    },
    words=lambda result: {
        "levers": lever_table(result),
        "strongest_levers": lever_lines(result)[1:],
        "lever_note": lever_note(result),
    },
    lines=lever_lines,
)
