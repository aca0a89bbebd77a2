"""How far each load can be trusted, and everything to know before believing the result."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from fem_seal.answers.accuracy import ACCURACY
from fem_seal.answers.answer import Answer, Inquiry, Loads
from fem_seal.answers.target import TARGET
from fem_seal.seal.findings import NOT_JUDGED, Caution, Validity, worst_first
from fem_seal.seal.load_result import DiscretisationError, LoadResult
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
    """

    validity: tuple[Validity, ...] = ()
    cautions: tuple[Caution, ...] = ()


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
    return Findings(tuple(validity), tuple(worst_first((*seal.left_out, *checks, *before, *asked))))


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
    return [load.knowing(validity=one) for load, one in zip(loads, validity, strict=True)]


FINDINGS = Answer[Findings]("findings", "checks of the result", _compute, Findings(), told=_told)
