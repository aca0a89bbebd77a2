"""Validity of each load, and all findings, worst first."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from fem_seal.answers.answer import Answer, Request, at_pressure
from fem_seal.answers.case_load import CaseLoad, SolvedSeal
from fem_seal.answers.leakage_class import NominalSize, nominal_size
from fem_seal.answers.target import TARGET
from fem_seal.seal.findings import NOT_JUDGED, Finding, Level, Validity, caution, worst_first
from fem_seal.seal.load_result import highest_load
from fem_seal.seal.scenarios import with_own_contacts
from fem_seal.validity.checks import contact_cautions, load_validity
from fem_seal.wording import Quantity
from leak.standards import nominal_size_of_bore

# Bore over nominal size of valves, needles and reduced bores included.
_BORES = 0.1, 2.0


@dataclass(frozen=True)
class Findings:
    """What is said against a result.

    Parameters
    ----------
    validity : tuple of Validity
        Of each load.
    cautions : tuple of Finding
        The worst first.
    of_scenarios : tuple of mapping
        Validity of each load in the scenarios with contacts of their own; empty for loads of which no more than the
        number is told.
    """

    validity: tuple[Validity, ...] = ()
    cautions: tuple[Finding, ...] = ()
    of_scenarios: tuple[Mapping[str, Validity], ...] = ()


def _compute(seal: SolvedSeal, request: Request) -> Findings:
    problem, compute = seal.problem, request.steps.compute
    checks = compute("checks of what the theory allows", partial(contact_cautions, problem, seal.loads), ())
    validity = [
        compute(at_pressure("validity", load), partial(load_validity, problem, load), NOT_JUDGED)
        for load in seal.loads
    ]
    others = compute("validity by the other theory", partial(_in_scenarios, seal), ({},) * len(seal.loads))
    findings = (*seal.missing_load_findings, *_of_nominal_size(nominal_size(seal.case)), *checks)
    return Findings(tuple(validity), tuple(worst_first(findings)), others)


def findings_of_profiles(seal: SolvedSeal) -> Findings:
    """What is said against the leak rates of given contacts, each load's validity being known.

    Parameters
    ----------
    seal : SolvedSeal
        Of given contacts.
    """
    # of all loads the worst of each kind
    kinds = {item.kind: item for load in seal.loads for item in reversed(worst_first(load.validity.cautions))}
    findings = worst_first((*kinds.values(), *_of_nominal_size(nominal_size(seal.case))))
    names = [scenario.name for scenario in with_own_contacts(seal.problem)]
    validities = ({name: load.scenarios[name].validity for name in names} for load in seal.loads)
    return Findings(tuple(load.validity for load in seal.loads), tuple(findings), tuple(validities))


def _of_nominal_size(size: NominalSize) -> Iterator[Finding]:
    """A size that is not of this seat: limits of standards grow with it."""
    narrowest, widest = (share * size.size for share in _BORES)
    if not (size.is_estimated or narrowest <= size.diameter <= widest):
        usual = f"DN {1e3 * nominal_size_of_bore(size.diameter):.4g}"
        bore = Quantity(size.diameter, "length")
        finding = caution("nominal_size", given=size, circle=size.circle, bore=bore, own=usual)
        yield replace(finding, level=Level.VALID)


def _in_scenarios(seal: SolvedSeal) -> tuple[Mapping[str, Validity], ...]:
    """Of the loads whose interval by another theory is told: the highest, and those that are judged."""
    highest, requirement = highest_load(seal.loads), seal.case.requirement
    flags = [
        number == highest or (requirement is not None and requirement.judges(load.fluid_pressure))
        for number, load in enumerate(seal.loads)
    ]
    scenarios = list(with_own_contacts(seal.problem))
    return tuple(
        {
            scenario.name: load_validity(scenario.problem, other)
            for scenario in scenarios
            if flag and (other := load.scenarios.get(scenario.name)) is not None
        }
        for load, flag in zip(seal.loads, flags, strict=True)
    )


def _of_load(load: CaseLoad, number: int, findings: Findings) -> CaseLoad:
    validity = findings.validity[number] if findings.validity else NOT_JUDGED
    validities = findings.of_scenarios[number] if findings.of_scenarios else {}
    scenarios = {name: load.scenarios[name].with_values(validity=other) for name, other in validities.items()}
    return load.with_scenarios(scenarios).with_values(validity=validity)


FINDINGS = Answer[Findings](
    "findings", "checks of the result", _compute, Findings(), of_load=_of_load, of_part=True
)


def all_cautions(answers: Mapping[str, Any]) -> tuple[Finding, ...]:
    """What is said against a result, and against its force for a target leak rate, the worst first.

    Parameters
    ----------
    answers : mapping
        Of the result.
    """
    target = TARGET.of(answers)
    return worst_first((*FINDINGS.of(answers).cautions, *(() if target is None else target.remarks)))
