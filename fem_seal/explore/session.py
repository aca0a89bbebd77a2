"""A case with its sliders: designs, their cases, and what is shown of them.

A design is a few texts, "20.5 bar", in place of those of the case. What calculates (`fem_seal.explore.live`) is loaded
with the first answer: the page is there before.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any

from fem_seal.errors import InputError, SealError
from fem_seal.explore.factors import Factors, factors_of, opened
from fem_seal.explore.screen import Screen, section_of, slow_words
from fem_seal.seal.cost import seconds
from fem_seal.units import shown_in
from leak import LeakError
from meshes import MeshesError

if TYPE_CHECKING:
    from fem_seal.case.case import Case
    from fem_seal.explore.live import Live

# Stops between two designs for which things are made ahead.
_AHEAD = 4
# A design that takes longer is calculated when the sliders rest: people lose the thread of what they do after a second
# (R. B. Miller, Response time in man-computer conversational transactions, 1968).
_FOLLOWS = 1.0
# What can go wrong with a design: it is said on the page, which goes on.
WRONG = (SealError, LeakError, MeshesError, ValueError, RuntimeError, ArithmeticError)


class Session:
    """A case with its sliders, and what has been made for them.

    Parameters
    ----------
    case : Case
    waits : bool
        Whether a table that is missing is made at once, instead of leaving the leak rate open.
    name : str
        Of the case among those of the page; empty for that with which it was opened.
    like : Session, optional
        Another one, whose bodies and tables serve this one, too.

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

    def __init__(
        self, case: Case, *, waits: bool = True, name: str = "", like: Session | None = None
    ) -> None:
        self.name = name
        self.given = case
        self.base = opened(case)
        self.waits: bool = waits if like is None else like.waits
        self._like = like

    @cached_property
    def factors(self) -> Factors:
        """What can be moved."""
        return factors_of(self.base)

    @cached_property
    def live(self) -> Live:
        """What calculates."""
        from fem_seal.explore.live import Live

        return Live(one_shape=self.one_shape, like=None if self._like is None else self._like.live)

    def slow(self, case: Case) -> float:
        """Estimated processor time of a design [s] where it is too long to follow the sliders; zero where it is not."""
        found = seconds(case)
        return found if found > _FOLLOWS else 0.0

    @property
    def one_shape(self) -> bool:
        """Whether the sliders leave the shape of the spectrum as it is, but for a few steps of a finish's cutoff."""
        roughness = self.base.roughness
        return roughness is None or len({id(part) for part in roughness.parts.values()}) == 1

    def design(self, design: Mapping[str, str]) -> dict[str, str]:
        """A design with all that it leaves out."""
        own = self.factors.given | ({"case": self.name} if self.name else {})
        return own | {key: text.strip() for key, text in design.items() if key in own}

    def case(self, design: Mapping[str, str]) -> Case:
        """The case of a design.

        Raises
        ------
        InputError
            If a value cannot be used; it says which and why.
        """
        changes = self.factors.changes(self.base, self.design(design))
        return self.base.replace_written(changes) if changes else self.base

    def answer(self, design: Mapping[str, str], *, waiting: str = "") -> Screen:
        """What is shown of a design while the sliders move.

        Parameters
        ----------
        design : mapping
            From keys of factors to texts; what is missing is that of the case.
        waiting : str
            What is being calculated elsewhere: its section alone is shown.

        Returns
        -------
        Screen
            With its problem in words where the design cannot be calculated.
        """
        design = self.design(design)
        try:
            case = self.case(design)
            with shown_in(*case.shown):
                if slow := self.slow(case):
                    waiting = slow_words(slow)
                if waiting:
                    return Screen(design, section=section_of(case), waiting=waiting)
                return self.live.answer(design, case, waits=self.waits)
        except InputError as error:
            return Screen(
                design,
                problem="; ".join(str(one) for one in error.problems),
                wrong={key: one.message for one in error.problems if (key := self.factors.named(one.key))},
            )
        except WRONG as error:
            return Screen(design, problem=str(error))

    def needs(self, design: Mapping[str, str]) -> Iterator[Hashable]:
        """Names of what a design needs and is not there yet, each to be made before the next is asked for."""
        try:
            case = self.case(design)
            if not self.slow(case):
                yield from self.live.needs(case)
        except WRONG:
            return

    def make(self, name: Hashable) -> Any:
        """Make what a design needs, and keep it."""
        return self.live.make(name)

    def neighbours(self, design: Mapping[str, str]) -> Iterator[dict[str, str]]:
        """Designs that one slider away from a design, the nearest first: those of loads and surfaces."""
        design = self.design(design)
        yield dict(design)
        sliders = [one for one in self.factors.sliders if one.group != "dimension"]
        step = _AHEAD if self.one_shape else 1
        for away in range(1, max(len(one.stops) for one in sliders) // step + 1):
            for one in sliders:
                at = one.nearest(design[one.key])
                for place in (at + away * step, at - away * step):
                    if 0 <= place < len(one.stops):
                        yield {**design, one.key: one.stops[place]}
