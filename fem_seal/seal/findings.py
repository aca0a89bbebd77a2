"""Findings and validity: what casts doubt on a result, by which factor, and the bounds that this leaves.

Their texts are entries of templates/findings.toml.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Any, Literal, NamedTuple

import numpy as np

from fem_seal.errors import Problem, Text, write
from fem_seal.files import own_tables
from fem_seal.seal.load_result import LoadResult, load_words
from fem_seal.seal.problem import Loads
from fem_seal.units import Display, round_digits
from fem_seal.wording import Quantity, Words

# Ratio of leak rates up to which they are told as one number.
AGREE = 1.005


class Bounds(NamedTuple):
    """The ends of an interval.

    Parameters
    ----------
    low, high : float
        In the unit of the number.

    Examples
    --------
    >>> Bounds.of([3.0, 1.0, 2.0]).widen(Bounds.factor_bounds(2.0))
    Bounds(low=0.5, high=6.0)
    """

    low: float
    high: float

    @classmethod
    def of(cls, values: Iterable[float]) -> Bounds:
        """The smallest and the largest of some values; NaN if one of them is.

        Parameters
        ----------
        values : iterable of float
            One at least.
        """
        numbers = np.array(list(values), dtype=float)
        return cls(float(numbers.min()), float(numbers.max()))

    @classmethod
    def factor_bounds(cls, factor: float) -> Bounds:
        """Factors of what may be so many times too large or too small.

        Parameters
        ----------
        factor : float
            One at least.
        """
        return cls(1.0 / factor, factor)

    @property
    def is_range(self) -> bool:
        """Whether both ends are read as two numbers."""
        return not self.high <= AGREE * self.low

    def widen(self, by: tuple[float, float]) -> Bounds:
        """Each end times its factor.

        Parameters
        ----------
        by : tuple of float
            Least and most.
        """
        return Bounds(self.low * by[0], self.high * by[1])

    def ratio_to(self, by: tuple[float, float]) -> Bounds:
        """What was widened by these factors.

        Parameters
        ----------
        by : tuple of float
            Least and most.
        """
        return Bounds(self.low / by[0], self.high / by[1])


EXACT = Bounds(1.0, 1.0)
"""Factors of what is off by nothing."""


class Level(StrEnum):
    """How far numbers can be trusted, worse and worse. Which is which: guide/validity in the manual."""

    VALID = "valid"
    DOUBTFUL = "doubtful"
    OUTSIDE = "outside the theory"

    @property
    def mark(self) -> str:
        """What stands beside such numbers in a table."""
        return {"valid": "", "doubtful": "?"}.get(self, "!")


_RANK = {level: rank for rank, level in enumerate(Level)}


@dataclass(frozen=True)
class Finding(Text):
    """One thing that a user should know before believing a result.

    Parameters
    ----------
    entry : str
        Of templates/findings.toml, which has its texts.
    level : Level
        What it makes of the numbers.
    values : mapping
        Numbers and names of the texts.
    leak_factor : Bounds, optional
        What really leaks over the calculated leak rate, at least and at most, where that is known: 0 and infinity
        where it may be orders of magnitude.
    of_contact : bool
        Whether it is about the contact, and so about all numbers; else it is about the leak rate alone.
    silent : bool
        Whether it is too little to be reported, but is in the interval.
    at : str or Text
        What it is about if not about a load as it is: "largest earlier load", "lower flange".
    """

    entry: str
    level: Level
    values: Mapping[str, object]
    leak_factor: Bounds = EXACT
    of_contact: bool = True
    silent: bool = False
    at: str | Text = ""

    @property
    def kind(self) -> str:
        """What it is about, in few words: "yield stress", "cut off", "mesh"."""
        return self._part("label")

    def reason(self, display: Display | None = None) -> str:
        """What it says: a clause with the number behind it, about one load that need not be named."""
        return (f"{write(self.at, display)}: " if self.at else "") + self._part("says", display)

    def place(self, display: Display | None = None) -> str:
        """Where it is: "at 20 bar"; empty of what is about all loads."""
        where = self.values.get("where")
        return self._part("place", display) or (f"at {write(where, display)}" if where else "")

    def remedy(self, display: Display | None = None, *, again: bool = False) -> str:
        """What it means, and what helps; without what another finding of this kind has said before it."""
        return (again and self._part("remedy_again", display)) or self._part("remedy", display)

    def text(self, display: Display | None = None) -> str:
        """All of it: what, where, and what helps; empty of what is silent."""
        if self.silent:
            return ""
        reason, place = self.reason(display), self.place(display)
        return ". ".join(filter(None, (f"{reason} ({place})" if place else reason, self.remedy(display))))

    def _part(self, name: str, display: Display | None = None) -> str:
        return Words(own_tables("findings.toml")[self.entry].get(name, ""), self.values).text(display)

    @property
    def in_clause(self) -> Words:
        """Its reason, for a sentence that is written later."""
        return Words("{{ finding.reason(display) }}", {"finding": self})

    def at_place(self, place: str | Text) -> Finding:
        """The same about something else than a load as it is.

        Parameters
        ----------
        place : str or Text
        """
        at = Words("{{ place }}: {{ at }}", {"place": place, "at": self.at}) if self.at else place
        return replace(self, at=at)

    @property
    def leak_error(self) -> float:
        """Relative error of the leak rate, where it is known; infinite if that may be orders of magnitude more."""
        low, high = self.leak_factor
        return max(high - 1.0, 1.0 - low)


def worst_first(cautions: Iterable[Finding]) -> tuple[Finding, ...]:
    """Cautions in the order of their levels, those of one level as they came.

    Parameters
    ----------
    cautions : iterable of Finding
    """
    return tuple(sorted(cautions, key=lambda finding: -_RANK[finding.level]))


@dataclass(frozen=True)
class Validity:
    """How far the numbers of one load can be trusted, and why no further.

    Parameters
    ----------
    cautions : tuple of Finding
        The worst first; see `Validity.of`.

    Examples
    --------
    >>> soft = remark("yield stress", Level.OUTSIDE, "seat: 3 times its yield stress")
    >>> str(Validity.of([soft]).level), str(Validity().level)
    ('outside the theory', 'valid')
    """

    cautions: tuple[Finding, ...] = ()

    @classmethod
    def of(cls, cautions: Iterable[Finding]) -> Validity:
        """The verdict of some cautions, but those that say nothing.

        Parameters
        ----------
        cautions : iterable of Finding
        """
        return cls(worst_first(x for x in cautions if not x.silent or x.leak_factor.is_range))

    @property
    def level(self) -> Level:
        """That of the worst caution."""
        return self.cautions[0].level if self.cautions else Level.VALID

    @property
    def of_contact(self) -> Validity:
        """That of all numbers but the leak rate: of peak, width, stresses and opening."""
        return Validity(tuple(finding for finding in self.cautions if finding.of_contact))

    @property
    def doubts(self) -> tuple[Finding, ...]:
        """Cautions that make numbers less than valid, the worst first."""
        return tuple(finding for finding in self.cautions if finding.level is not Level.VALID)

    @property
    def reasons(self) -> tuple[str, ...]:
        """Why the numbers are not simply valid, the worst reason first, in units of the field."""
        return self.reasons_in()

    def reasons_in(self, display: Display | None = None) -> tuple[str, ...]:
        """The same in the units of a display."""
        return tuple(dict.fromkeys(finding.reason(display) for finding in self.doubts))

    @property
    def leak_error(self) -> float:
        """The largest relative error of the leak rate that is told; zero where none is."""
        return max((finding.leak_error for finding in self.cautions if not finding.silent), default=0.0)

    @property
    def leak_factor(self) -> Bounds:
        """What may really leak over the calculated leak rate, at least and at most: one lies between.

        Orders of magnitude count as `ORDERS_OF_MAGNITUDE`.
        """
        low, high = (math.prod(finding.leak_factor[n] for finding in self.cautions) for n in range(2))
        return Bounds(min(max(low, 1.0 / ORDERS_OF_MAGNITUDE), 1.0), max(min(high, ORDERS_OF_MAGNITUDE), 1.0))

    def widens(self, *, more: bool) -> tuple[Finding, ...]:
        """Cautions by which more may leak than calculated, or less; none that explains nothing next to a larger one.

        Parameters
        ----------
        more : bool
        """
        factors = [
            (finding.leak_factor[1] if more else 1.0 / max(finding.leak_factor[0], 1e-300), finding)
            for finding in self.cautions
        ]
        # next to a larger one, some parts in ten thousand explain nothing
        most = max((factor for factor, _ in factors), default=1.0)
        return tuple(
            x for factor, x in factors if factor > 1.0 and factor - 1.0 > 0.01 * min(most - 1.0, 1.0)
        )

    def leak_reason(self, *, more: bool, display: Display | None = None) -> str:
        """Why more may leak than calculated, or why less; empty if nothing is known.

        Parameters
        ----------
        more : bool
        display : Display, optional
        """
        reasons = list(dict.fromkeys(finding.reason(display) for finding in self.widens(more=more)))
        if len(reasons) < 2:
            return "".join(reasons)
        factor = self.leak_factor[1] if more else 1.0 / self.leak_factor[0]
        return f"together a factor {round_digits(factor, 2):g} {'more' if more else 'less'}: {'; '.join(reasons)}"

    def leak_clause(self, *, more: bool) -> Words | str:
        """The same, for a sentence that is written later."""
        values = {"validity": self, "more": more}
        return (
            Words("{{ validity.leak_reason(more=more, display=display) }}", values)
            if self.widens(more=more)
            else ""
        )

    @property
    def outside_theory(self) -> bool:
        """Whether the theory does not hold, so that nothing may be claimed from the numbers."""
        return self.level is Level.OUTSIDE

    @property
    def leaks_more(self) -> bool:
        """Whether all that is outside the theory lets more leak than calculated: what fails without it fails."""
        factors = [finding.leak_factor for finding in self.cautions if finding.level is Level.OUTSIDE]
        return bool(factors) and all(low >= 1.0 < high for low, high in factors)

    def without_kinds(self, *kinds: str) -> Validity:
        """The verdict without the cautions of some kinds.

        Parameters
        ----------
        *kinds : str
        """
        return Validity(tuple(finding for finding in self.cautions if finding.kind not in kinds))


def remark(
    kind: str, level: Level, says: str | Text, leak_factor: Bounds = EXACT, *, of_contact: bool = True
) -> Finding:
    """A finding whose text was made elsewhere; see `Finding`.

    Parameters
    ----------
    kind : str
    level : Level
    says : str or Text
    leak_factor : Bounds, optional
    of_contact : bool
    """
    return Finding("remark", level, {"kind": kind, "says": says}, leak_factor, of_contact)


VALID = Validity()
NOT_CALCULATED = "not calculated"
"""What stands in place of the level of a load without numbers."""
YIELD_STRESS = "yield stress"
"""Kind of the caution about a body that is solved as elastic above its yield stress."""
DIRECT_SCATTER = "direct scatter"
"""Kind of the caution that says how uncertain a simulated conductivity is, of which the interval is made."""
NEARLY_SEALED, SEALED = "nearly sealed", "sealed"
"""Kinds of cautions about the percolation threshold, of which the leak rate itself has a bound and not a factor."""
ORDERS_OF_MAGNITUDE = 1e3
"""What "orders of magnitude" are taken for where something is to be decided: three."""
# A check that fails is no clean bill.
NOT_JUDGED = Validity((remark("checks", Level.DOUBTFUL, "checks of what the theory allows failed"),))


# How far the numbers of a row can be trusted, in words, and why no further.
VALIDITY_COLUMNS = ("validity", "validity_reasons")


def validity_entries(validity: Validity, display: Display) -> dict[str, Any]:
    """`VALIDITY_COLUMNS` of a row: the level in words and the list of reasons, the worst first.

    Parameters
    ----------
    validity : Validity
    display : Display
    """
    return dict(zip(VALIDITY_COLUMNS, (str(validity.level), list(validity.reasons_in(display))), strict=True))


def caution(
    name: str,
    load: LoadResult | None = None,
    loads: Sequence[LoadResult] = (),
    /,
    *,
    outside: bool = False,
    leak_factor: Bounds = EXACT,
    proven: bool = True,
    is_reported: bool = True,
    **values: object,
) -> Finding:
    """A caution about what its entry says.

    A factor of known size on the leak rate is in the interval and is no doubt.

    Parameters
    ----------
    name : str
        Of the entry, which has label, says, remedy and place, and leak_only where it is about the leak rate alone.
    load, loads
        The load that it is about, and all loads, among which its name is unique.
    outside : bool
        Whether it puts the numbers outside the theory.
    leak_factor
        See `Finding`.
    proven : bool
        Whether its size was found, in measurements or simulations, and is no guess.
    is_reported : bool
        Whether its number is above the limit from which on it is told; the factor fades in before, see `fade_in`.
    **values
        Values for the braces of the texts.
    """
    if load is not None:
        values["where"] = load_words(load, loads)
    leak_only = "leak_only" in own_tables("findings.toml")[name]
    in_interval = (
        leak_only and proven and leak_factor != EXACT and 0.0 < leak_factor.low <= leak_factor.high < math.inf
    )
    level = Level.OUTSIDE if outside else Level.VALID if in_interval else Level.DOUBTFUL
    return Finding(
        name,
        level if is_reported else Level.VALID,
        values,
        leak_factor,
        of_contact=not leak_only,
        silent=not is_reported,
    )


def fade_in(leak_factor: Bounds, ratio: float) -> Bounds:
    """Factors that fade in from half of the limit on: with a step there the interval would jump.

    Parameters
    ----------
    leak_factor : Bounds
    ratio : float
        The number of a caution over the limit from which on it is told.
    """
    share = min(max(2.0 * ratio - 1.0, 0.0), 1.0)
    return Bounds(leak_factor.low**share, leak_factor.high**share)


def sentence(name: str, part: str = "text", /, **values: object) -> Words:
    """A sentence of an entry, its values filled in.

    Parameters
    ----------
    name, part : str
    **values
        Values for the braces of the texts.
    """
    return Words(own_tables("findings.toml")[name][part], values)


def near_limit(pressure: float, limit: float, digits: int) -> Words:
    """A contact pressure or stress with so many digits, or more that tell it from a limit.

    Parameters
    ----------
    pressure, limit : float
        [Pa]
    digits : int
    """
    values = {"pressure": pressure, "limit": limit, "digits": digits}
    return Words("{{ display.near_limit('MPa', pressure, limit, digits) }}", values)


def why_missing(problem: Problem) -> str:
    """Why a load could not be calculated, in a clause.

    Parameters
    ----------
    problem : Problem
    """
    return str(sentence("why_not_calculated", problem.kind, problem=problem))


def not_calculated(loads: Loads, problems: Mapping[int, Problem]) -> Iterator[Finding]:
    """Which loads have no result: one sentence for each reason and force, or for all forces under one pressure.

    Parameters
    ----------
    loads : Loads
    problems : mapping
        Number of each load that could not be calculated, with the reason.
    """
    for kind in dict.fromkeys(problem.kind for problem in problems.values()):
        # they do not concern the remaining loads
        yield from _findings_of_kind(
            loads, {number: problem for number, problem in problems.items() if problem.kind == kind}, kind
        )


def _findings_of_kind(loads: Loads, problems: Mapping[int, Problem], kind: str) -> Iterator[Finding]:
    """Findings about loads with one kind of problem, each with the reason of the load that is nearest to a result."""
    points = {number: loads.points[number] for number in problems}
    # the one with the lowest pressure; of an open seal that with the largest force; without a solution the first
    direction = {"open": -1, "strain": 1}.get(kind, 0)
    if len(set(loads.fluid_pressure)) == 1:
        nearest = min(points, key=lambda number: direction * points[number][1])
        forces = [force for _, force in points.values()]
        yield _finding_of_loads(loads, nearest, problems[nearest], "with", forces)
        return
    for applied_force in dict.fromkeys(force for _, force in points.values()):
        numbers = [number for number, (_, force) in points.items() if force == applied_force]
        nearest = min(numbers, key=lambda number: abs(direction) * loads.fluid_pressure[number])
        pressures = [loads.fluid_pressure[number] for number in numbers]
        yield _finding_of_loads(loads, nearest, problems[nearest], "at", pressures)


def _finding_of_loads(
    loads: Loads, number: int, problem: Problem, how: Literal["with", "at"], values: Collection[float]
) -> Finding:
    """A finding about the loads with these forces, or at these pressures and with one force."""
    pressure, force = loads.points[number]
    several = len({applied_force for _, applied_force in loads.points}) > 1
    load = sentence("not_calculated", "load_of_forces" if several else "load", pressure=pressure, force=force)
    kind = "force" if how == "with" else "fluid pressure"
    names = [Quantity(value, f"short {kind}") for value in sorted(set(values))]
    with_force = sentence("not_calculated", "of_force", force=force) if several and how == "at" else ""
    return caution(
        "not_calculated",
        # the message of an open seal has its pressure and force already
        load="" if problem.kind == "open" else load,
        problem=problem,
        names=names,
        with_force=with_force,
        why=why_missing(problem),
    )
