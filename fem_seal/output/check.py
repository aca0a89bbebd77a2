"""What is known of a case without solving it: closed forms, limits of them, and remarks on its entries."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from fem_seal.answers.closed_forms import (
    ClosedForms,
    closed_form_limits,
    derive,
    foresee_findings,
    nearly_open,
    run_seconds,
    strain_limit,
    without_stop,
)
from fem_seal.case.case import Case
from fem_seal.errors import write
from fem_seal.files import problem
from fem_seal.materials import creep_remarks
from fem_seal.output.case_words import derived_numbers, requirement_numbers
from fem_seal.seal.problem import SealProblem, problems_of, size_mesh
from fem_seal.validity.fluid import film_cautions
from fem_seal.validity.materials import hardness_cautions, material_cautions


@dataclass(frozen=True)
class Check:
    """A case that is valid, before it is solved.

    Parameters
    ----------
    problem : SealProblem
    derivation : ClosedForms
    numbers : dict
        In SI, as ``fem-seal check --json`` prints them.
    remarks : tuple of str
        On its entries, then what the closed forms foresee.
    """

    problem: SealProblem
    derivation: ClosedForms
    numbers: dict[str, Any]
    remarks: tuple[str, ...]


def check_of(case: Case) -> Check:
    """Closed forms of a case and what is to be said of it.

    Parameters
    ----------
    case : Case
        At the temperatures of its contact, see `fem_seal.seal.heating.with_contact_temperatures`.
    """
    seal, derivation = SealProblem.of(case), derive(case)
    numbers = derived_numbers(case, derivation) | {
        "contact_size_m": size_mesh(seal).contact_size,
        "requirement": requirement_numbers(case),
        "run_time_s": run_seconds(
            seal, samples=case.sampling is not None, target=case.load.target_leak_rate is not None
        ),
    }
    limits = [
        *foresee_findings(seal, derivation),
        nearly_open(derivation),
        strain_limit(derivation),
        without_stop(case) or closed_form_limits(case, derivation),
    ]
    texts = [*_remarks(case), *filter(None, limits)]
    return Check(seal, derivation, numbers, tuple(write(text, case.display) for text in texts))


def _remarks(case: Case) -> list[object]:
    remarks: list[object] = []
    if case.roughness is None:
        remarks.append("no [roughness]: no leak rate is calculated")
    if case.fluid is None:
        remarks.append("no [fluid]: no leak rate is calculated")
    if case.roughness is not None:
        remarks.extend(case.roughness.remarks())
    if (key := case.uneven_key) is not None:
        remarks.append(problem("check_of_round_seal", key="[form]" if key == "form" else key))
    if case.form is not None:
        remarks.extend(case.form.without_effect(case.contact.angle))
    problems = problems_of(case)
    first = problems[0]
    remarks.extend(text for _, _, text in first.origin.face_remarks)
    remarks.extend(creep_remarks(first.labelled_materials))
    remarks.extend((*film_cautions(first), *hardness_cautions(first), *material_cautions(first)))
    if case.load.target_leak_rate is not None:
        from fem_seal.answers.target import target_remarks

        remarks.extend(target_remarks(problems))
    return remarks
