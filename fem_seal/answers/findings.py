"""How far each load can be trusted, and everything to know before believing the result."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from fem_seal.answers.accuracy import ACCURACY
from fem_seal.answers.answer import Answer, Inquiry, Loads
from fem_seal.answers.target import TARGET
from fem_seal.seal.findings import NOT_JUDGED, Caution, Validity, worst_first
from fem_seal.seal.load_result import DiscretisationError, LoadResult, highest_load
from fem_seal.seal.solved_seal import SolvedSeal
from fem_seal.units import given
from fem_seal.validity.checks import contact_cautions, earlier_cautions, load_validity

if TYPE_CHECKING:
    from fem_seal.contact.solution import ContactSolution
    from fem_seal.seal.problem import SealProblem


@dataclass(frozen=True)
class Findings:
    """What is said against a result.

    Parameters
    ----------
    validity : tuple of Validity
        Of each load.
    cautions : tuple of Caution
        The worst first.
    by_theory : tuple of mapping
        Validity of each load by the theories that it is not calculated with; empty for loads of which no more than the
        number is told.
    """

    validity: tuple[Validity, ...] = ()
    cautions: tuple[Caution, ...] = ()
    by_theory: tuple[Mapping[str, Validity], ...] = ()


def _compute(seal: SolvedSeal, ask: Inquiry) -> Findings:
    problem, error, target = seal.problem, ACCURACY.of(ask.answers).error, TARGET.of(ask.answers)
    compute = ask.steps.compute
    check = partial(contact_cautions, problem, seal.model, seal.loads, error, problem.surface)
    checks = compute("checks of what the theory allows", check, ())
    find = partial(of_earlier, problem, seal.earlier, error)
    before = compute("checks of the largest earlier load", find, ())
    validity = [
        compute(
            f"validity at {given('fluid pressure', load.fluid_pressure)}",
            partial(validity_after, problem, load, error, before),
            NOT_JUDGED,
        )
        for load in seal.loads
    ]
    asked = () if target is None else target.remarks
    others = compute(
        "validity by the other theory",
        partial(_of_other_theories, seal, error, before),
        ({},) * len(seal.loads),
    )
    cautions = tuple(worst_first((*seal.left_out, *checks, *before, *asked)))
    return Findings(tuple(validity), cautions, others)


def _of_other_theories(
    seal: SolvedSeal, error: DiscretisationError, before: tuple[Caution, ...]
) -> tuple[Mapping[str, Validity], ...]:
    """Of the loads whose interval by another theory is told: the highest, and those that are judged."""
    highest, required = highest_load(seal.loads), seal.case.requirement
    told = [
        number == highest or (required is not None and required.judges(load.fluid_pressure))
        for number, load in enumerate(seal.loads)
    ]
    problems = {theory: seal.problem.in_theory(theory) for theory in seal.problem.other_theories}
    return tuple(
        {
            theory: validity_after(problems[theory], other, error, before)
            for theory, other in (load.by_theory or {}).items()
            if wanted
        }
        for load, wanted in zip(seal.loads, told, strict=True)
    )


def of_earlier(
    problem: SealProblem, earlier: ContactSolution | None, error: DiscretisationError
) -> tuple[Caution, ...]:
    """What is said against the largest load before those of a problem, whose traces they carry.

    Parameters
    ----------
    problem : SealProblem
    earlier : ContactSolution or None
        Under that load.
    error : DiscretisationError
    """
    if earlier is None or problem.loads.earlier is None:
        return ()
    load = LoadResult(*problem.loads.earlier, earlier, mesh_error=error)
    return tuple(earlier_cautions(problem, load))


def validity_after(
    problem: SealProblem, load: LoadResult, error: DiscretisationError, before: tuple[Caution, ...]
) -> Validity:
    """Validity of a load, in which stands what is said against the load before it.

    Parameters
    ----------
    problem : SealProblem
    load : LoadResult
    error : DiscretisationError
    before : tuple of Caution
        See `of_earlier`.
    """
    return Validity.of((*load_validity(problem, load, problem.surface, error).cautions, *before))


def _told(loads: Loads, found: Findings) -> Loads:
    validity = found.validity or [NOT_JUDGED] * len(loads)
    known = [load.knowing(validity=one) for load, one in zip(loads, validity, strict=True)]
    return [
        load.knowing(
            by_theory={
                theory: other.knowing(validity=of_load.get(theory, other.validity))
                for theory, other in (load.by_theory or {}).items()
            }
        )
        for load, of_load in zip(known, found.by_theory or ({},) * len(loads), strict=True)
    ]


FINDINGS = Answer[Findings]("findings", "checks of the result", _compute, Findings(), told=_told)
