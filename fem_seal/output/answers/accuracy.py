"""Discretisation error, influence of the far field, convergence."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict

from fem_seal.answers.solution import SealSolution
from fem_seal.contact.load_path import ElastoplasticContact
from fem_seal.output.prose import said
from fem_seal.output.shown import Shown, by_reading
from fem_seal.seal.load_names import load_name
from fem_seal.units import number, percent

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


def accuracy(result: SealSolution) -> list[tuple[str, str]]:
    """How far the numbers can be trusted: discretisation and convergence."""
    error = result.discretisation_error
    iterations = [load.contact.iterations for load in result.loads]
    residuals = [load.contact.residuals[-1] for load in result.loads if load.contact.residuals]
    rows = [
        ("mesh error of the peak pressure", _error(error.peak_pressure)),
        ("mesh error of the width (FWHM)", _error(error.fwhm)),
        ("mesh error of the std. deviation", _error(error.std)),
    ]
    if error.leak_rate is not None:
        rows.append(("mesh error of the leak rate", _error(error.leak_rate)))
    rows.append(("iterations per load", f"{min(iterations)} to {max(iterations)}"))
    if residuals:
        rows.append(("residual of the gap", f"{number(max(residuals), 1)} decay lengths"))
    force = max(abs(load.contact.force_error) for load in result.loads)
    rows.append(("error of the contact force", _error(force)))
    return [*rows, *path_accuracy(result)]


def _error(share: float) -> str:
    """A relative error, without digits that mean nothing."""
    return "below 10⁻⁹ %" if share < 1e-11 else percent(share, 1)


def path_accuracy(result: SealSolution) -> Iterator[tuple[str, str]]:
    """Load steps and balance of the bodies that yield."""
    contacts = [load.contact for load in result.loads if isinstance(load.contact, ElastoplasticContact)]
    if contacts:
        yield "load steps", str(sum(contact.load_steps for contact in contacts))
        worst = max(contact.equilibrium_residuals[-1] for contact in contacts)
        yield "imbalance of forces in the bodies", f"{number(worst, 1)} of the largest force"


SHOWN = Shown(
    summary=lambda result: {
        "discretisation_error": asdict(result.discretisation_error),
        "far_field": {
            "changes": [by_reading(asdict(change)) for change in result.far_field],
            "says": far_field_sentence(result),
        },
    },
    words=lambda result: {"accuracy": accuracy(result), "far_field": far_field_sentence(result)},
)
