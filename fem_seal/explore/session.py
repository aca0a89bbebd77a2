"""A case with its sliders: designs, their cases, and what is shown of them.

A design is a few texts, "20.5 bar", in place of those of the case. What calculates (`fem_seal.explore.live`) is loaded
with the first answer: the page is there before.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import cached_property
from typing import TYPE_CHECKING, TypeAlias

from fem_seal.errors import InputError, SealError
from fem_seal.explore.choices import choices_of
from fem_seal.explore.factors import Factors, factors_of, open_materials
from fem_seal.explore.screen import Screen, section_of, slow_words
from fem_seal.seal.cost import seconds
from leak import LeakError
from meshes import MeshesError

if TYPE_CHECKING:
    from fem_seal.case.case import Case

# A design that takes longer is calculated when the sliders rest: people lose the thread of what they do after a second
# (R. B. Miller, Response time in man-computer conversational transactions, 1968).
_FOLLOWS = 1.0
# What can go wrong with a design: it is said on the page, which goes on.
WRONG = (SealError, LeakError, MeshesError, ValueError, RuntimeError, ArithmeticError)

Calculate: TypeAlias = "Callable[[Case, Mapping[str, str]], Screen]"


class Session:
    """A case with its sliders.

    Parameters
    ----------
    case : Case
    name : str
        Of the case among those of the page; empty for that with which it was opened.

    Examples
    --------
    >>> import fem_seal
    >>> case = fem_seal.Case(
    ...     closure={"shape": "ball", "radius": "20 mm", "material": "steel"},
    ...     seat={"shape": "cone", "angle": "45 deg", "material": "steel"},
    ...     interface={"law": "smooth"},
    ...     load={"fluid_pressure": "20 bar"},
    ... )
    >>> session = Session(case)
    >>> screen = session.answer({"fluid_pressure": "40 bar"})
    >>> round(screen.load.values["peak_pressure_Pa"] / 1e6)
    271
    """

    def __init__(self, case: Case, name: str = "") -> None:
        self.name = name
        self.base_design = case
        self.base = open_materials(case)

    @cached_property
    def factors(self) -> Factors:
        """What can be moved."""
        return factors_of(self.base)

    def slow(self, case: Case) -> float:
        """Estimated processor time of a design [s] where it is too long to follow the sliders; zero where it is not."""
        estimate = seconds(case)
        return estimate if estimate > _FOLLOWS else 0.0

    def design(self, design: Mapping[str, str]) -> dict[str, str]:
        """A design with all that it leaves out."""
        base = self.factors.base_design | ({"case": self.name} if self.name else {})
        return base | {key: text.strip() for key, text in design.items() if key in base}

    def inputs(self, design: Mapping[str, str]) -> dict[str, str]:
        """What is chosen and moved in a design, by the labels for people."""
        by_row = choices_of(self.base)
        choices = {choice.label: choice.value for group in ("surface", "demand") for choice in by_row[group]}
        return choices | {
            self.factors.labels[key]: text
            for key, text in self.design(design).items()
            if key in self.factors.labels
        }

    def case(self, design: Mapping[str, str]) -> Case:
        """The case of a design.

        Raises
        ------
        InputError
            If a value cannot be used; it says which and why.
        """
        changes = self.factors.changes(self.base, self.design(design))
        return self.base.replace_written(changes) if changes else self.base

    def answer(self, design: Mapping[str, str], calculate: Calculate | None = None) -> Screen:
        """What is shown of a design while the sliders move.

        Parameters
        ----------
        design : mapping
            From keys of factors to texts; what is missing is that of the case.
        calculate : callable, optional
            Instead of `fem_seal.explore.live.live_screen`.

        Returns
        -------
        Screen
            With its problem in words where the design cannot be calculated; of a design that takes too long its
            section alone.
        """
        design = self.design(design)
        try:
            case = self.case(design)
            if slow := self.slow(case):
                return Screen(design, section=section_of(case), delay=slow_words(slow))
            return (calculate or _calculate_here)(case, design)
        except InputError as error:
            return Screen(
                design,
                problem="; ".join(problem.text(self.base.display) for problem in error.problems),
                wrong={
                    key: problem.message_in(self.base.display)
                    for problem in error.problems
                    if (key := self.factors.factor_key(problem.key))
                },
            )
        except WRONG as error:
            return Screen(design, problem=str(error))

    def neighbours(self, design: Mapping[str, str]) -> Iterator[dict[str, str]]:
        """Designs with another surface, one slider away from a design, the nearest first.

        Parameters
        ----------
        design : mapping
        """
        design = self.design(design)
        sliders = [factor for factor in self.factors.sliders if factor.group == "surface"]
        for distance in range(1, max((len(factor.stops) for factor in sliders), default=0)):
            for factor in sliders:
                at = factor.nearest(design[factor.key])
                for place in (at + distance, at - distance):
                    if 0 <= place < len(factor.stops):
                        yield {**design, factor.key: factor.stops[place]}


def _calculate_here(case: Case, design: Mapping[str, str]) -> Screen:
    from fem_seal.explore.live import live_screen

    return live_screen(case, design)
