"""Discretisation error, influence of the far field, convergence."""

from __future__ import annotations

from dataclasses import asdict

from fem_seal.answers.solution import SealSolution
from fem_seal.output.prose import said
from fem_seal.output.shown import Shown, by_reading
from fem_seal.seal.load_names import load_name

# Relative changes below this are not worth a number.
_LEAST = 1e-5


def far_field_sentence(result: SealSolution) -> str:
    """The influence of the far field in one sentence; empty if nothing was compared."""
    if not result.far_field:
        return ""
    changes = "; ".join(
        said(
            "notes.far_field",
            "peak" if change.leak_rate is None else "both",
            change=change.name,
            peak=_in_words(change.peak_pressure),
            leak_rate="" if change.leak_rate is None else _in_words(change.leak_rate),
        )
        for change in result.far_field
    )
    which = "one" if len(result.loads) == 1 else "strongest"
    load = load_name(result.strongest, result.loads)
    return said("notes.far_field", which, load=load, changes=changes)


def _in_words(change: float) -> str:
    return f"{100 * change:+.2g} %" if abs(change) >= _LEAST else f"less than {100 * _LEAST:g} %"


SHOWN = Shown(
    summary=lambda result: {
        "discretisation_error": asdict(result.discretisation_error),
        "far_field": {
            "changes": [by_reading(asdict(change)) for change in result.far_field],
            "says": far_field_sentence(result),
        },
    },
    words=lambda result: {"far_field": far_field_sentence(result)},
)
