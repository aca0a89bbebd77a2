"""A solved seal with the answers to all that is asked of it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from fem_seal.seal.load_result import highest_load, strongest_load
from fem_seal.seal.solved_seal import SolvedSeal

if TYPE_CHECKING:
    from fem_seal.answers.accuracy import Comparison
    from fem_seal.answers.form import FormAnswers
    from fem_seal.answers.judgement import JudgedLoad, Judgement, SealJudgement, Verdict
    from fem_seal.answers.particles import ParticleAnswers
    from fem_seal.answers.sensitivities import Lever
    from fem_seal.answers.uncertainty import LeakInterval
    from fem_seal.answers.variants import TheoryVariant
    from fem_seal.seal.load_result import DiscretisationError


@dataclass(frozen=True, kw_only=True)
class SealSolution(SolvedSeal):
    """Everything that a case gave, as numbers.

    `SealResult` has its table and its files besides; see there for the fields.
    """

    loads: tuple[JudgedLoad, ...]
    discretisation_error: DiscretisationError
    far_field: tuple[Comparison, ...] = ()
    form: FormAnswers | None = None
    particles: tuple[ParticleAnswers, ...] = ()
    interface_variants: tuple[Comparison, ...] = ()
    theory_variants: tuple[TheoryVariant, ...] = ()
    uncertainty: LeakInterval | None = None
    judgement: SealJudgement | None = None
    levers: tuple[Lever, ...] = ()
    warnings: tuple[str, ...] = ()
    timings: dict[str, float] = field(default_factory=dict)

    @property
    def strongest(self) -> JudgedLoad:
        """The load with the largest closing force; for it error, far field and interface laws are compared."""
        return self.loads[strongest_load(self.loads)]

    @property
    def highest(self) -> JudgedLoad:
        """The load with the highest fluid pressure, which headline, report and terminal explain."""
        return self.loads[highest_load(self.loads)]

    @property
    def verdicts(self) -> tuple[Judgement | None, ...]:
        """What is said of each load; None of those of which nothing is required."""
        return tuple(load.judgement for load in self.loads)

    @property
    def verdict(self) -> Verdict | None:
        """The worst of the loads that are judged; None without a requirement."""
        return None if self.judgement is None else self.judgement.verdict

    @property
    def margin(self) -> float | None:
        """Allowed over calculated leak rate of the load that decides; None without a requirement."""
        return None if self.judgement is None else self.judgement.margin
