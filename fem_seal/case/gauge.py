"""Gauge and absolute pressures as data sheets write them: barg, psig, bara, psia.

A case has pressure differences across the seal, and one absolute pressure, that at the outlet of a gas.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

from fem_seal.case.fields import shown
from fem_seal.case.words import problem
from fem_seal.errors import InputError, Problem, QuantityError
from fem_seal.units import NUMBER, exact_quantity
from leak.standards import STANDARD_PRESSURE

_WRITTEN = re.compile(rf"\s*({NUMBER})\s*(m?bar|psi|[kM]?Pa)\s?(?:\(([ga])\)|([ga]))\s*")
_DIFFERENCES = (
    ("load", "fluid_pressure"),
    ("load", "largest_earlier_pressure"),
    ("load", "set_pressure"),
    ("requirement", "fluid_pressure"),
    ("requirement", "rated_pressure"),
)
# By how much the outlet may differ from one atmosphere for a gauge pressure to be the difference across the seal.
_NEAR = 0.05


def is_said_of_one_side(entry: object) -> bool:
    """Whether a pressure, a list, a range or a table of them is gauge or absolute anywhere.

    Parameters
    ----------
    entry : anything
        As it stands in a case file.

    Examples
    --------
    >>> is_said_of_one_side(["1 bar", "20 barg"]), is_said_of_one_side("20 bar")
    (True, False)
    """
    return any(map(_match, _texts(entry)))


def without_reference(text: str) -> str:
    """A pressure without what it is measured from.

    Examples
    --------
    >>> without_reference("20 barg"), without_reference("20 bar")
    ('20 bar', '20 bar')
    """
    match = _match(text)
    return text if match is None else _bare(match)


def as_differences(tables: Mapping[str, Any], fluid: object) -> tuple[dict[str, Any], list[Problem]]:
    """Tables whose pressures are differences across the seal, and what cannot be made one.

    Parameters
    ----------
    tables : mapping
        Tables of a case as they are written.
    fluid : anything
        The table [fluid] as it is written.

    Returns
    -------
    tuple
    """
    changed, wrong = dict(tables), list[Problem]()
    outlet = fluid.get("outlet_pressure") if isinstance(fluid, Mapping) else None
    if (match := _match(outlet)) and "fluid" in changed:
        if _kind(match) == "g":
            wrong.append(problem("gauge_outlet", value=shown(outlet), remedy=_absolute(match)))
        changed["fluid"] = {**changed["fluid"], "outlet_pressure": _bare(match)}
    for table, key in _DIFFERENCES:
        entries = changed.get(table)
        if isinstance(entries, Mapping) and is_said_of_one_side(entries.get(key)):
            made = _Differences(f"{table}.{key}", fluid)
            changed[table] = {**entries, key: made.of(entries[key])}
            wrong += made.wrong
    return changed, wrong


def as_difference(path: str, entry: Any, fluid: object) -> Any:
    """What varies at an entry of a case, gauge and absolute pressures as differences across the seal.

    Parameters
    ----------
    path : str
        Of the entry, "load.fluid_pressure".
    entry : anything
        A value, a list, a range or a distribution as it is written.
    fluid : anything
        The table [fluid] as it is written.

    Raises
    ------
    InputError
        If a pressure cannot be made one.
    """
    table, _, key = path.partition(".")
    if (table, key) not in _DIFFERENCES or not is_said_of_one_side(entry):
        return entry
    made = _Differences(f"parameters.{path}", fluid)
    found = made.of(entry)
    if made.wrong:
        raise InputError(*made.wrong)
    return found


def as_gauge(problem: Problem, tables: Mapping[str, Any]) -> Problem:
    """What is wrong with a pressure, with the pressure as it stands in the case.

    Parameters
    ----------
    problem : Problem
    tables : mapping
        The case as it was written.
    """
    table, _, key = problem.key.partition(".")
    entries = tables.get(table)
    entry = entries.get(key) if isinstance(entries, Mapping) else None
    if (table, key) not in _DIFFERENCES or not is_said_of_one_side(entry):
        return problem
    message = problem.message
    for text in _texts(entry):
        if match := _match(text):
            message = message.replace(f'"{_bare(match)}"', shown(text))
    return replace(problem, message=message, value=shown(entry))


class _Differences:
    """What pressures of one key become across the seal of this fluid."""

    def __init__(self, key: str, fluid: object) -> None:
        self.key, self.wrong = key, list[Problem]()
        self.outlet, self.is_gas = _outlet(fluid)

    def of(self, entry: Any) -> Any:
        if isinstance(entry, Mapping):
            return {name: self.of(value) for name, value in entry.items()}
        if isinstance(entry, (list, tuple)):
            return [self.of(value) for value in entry]
        match = _match(entry)
        return entry if match is None else self._of_text(entry, match)

    def _of_text(self, text: str, match: re.Match[str]) -> str:
        plain, refused = _bare(match), self._refused
        if _kind(match) == "g":
            far = self.outlet is not None and abs(self.outlet / STANDARD_PRESSURE - 1) > _NEAR
            return refused("gauge_far_outlet", text, plain) if far else plain
        if not self.is_gas or self.outlet is None:
            return refused("absolute_without_outlet", text, plain)
        try:
            difference = float(exact_quantity(plain, "pressure")) - self.outlet
        except (QuantityError, OverflowError):
            # which the reading of the table says
            return plain
        return refused("absolute_below_outlet", text, plain) if difference < 0 else f"{difference!r} Pa"

    def _refused(self, name: str, text: str, plain: str) -> str:
        """The pressure as it is written, and one problem more."""
        outlet = (self.outlet or 0.0) / 1e5
        self.wrong.append(problem(name, key=self.key, outlet=outlet, value=shown(text)))
        return plain


def _texts(entry: object) -> Iterator[object]:
    if isinstance(entry, Mapping):
        entry = list(entry.values())
    if isinstance(entry, (list, tuple)):
        for value in entry:
            yield from _texts(value)
    else:
        yield entry


def _match(entry: object) -> re.Match[str] | None:
    return _WRITTEN.fullmatch(entry) if isinstance(entry, str) else None


def _kind(match: re.Match[str]) -> str:
    return match[3] or match[4]


def _absolute(match: re.Match[str]) -> str:
    """How a gauge pressure is written as an absolute one."""
    try:
        bar = (float(exact_quantity(_bare(match), "pressure")) + STANDARD_PRESSURE) / 1e5
    except (QuantityError, OverflowError):
        bar = math.nan
    return f'write it as "{bar:.6g} bara"' if bar >= 0 else "there is no pressure below 0 bara"


def _bare(match: re.Match[str]) -> str:
    """The number and the unit without what it is measured from."""
    return f"{match[1]} {match[2]}"


def _outlet(fluid: object) -> tuple[float | None, bool]:
    """Absolute pressure at the outlet [Pa], None where it is not known; and whether the fluid is a gas."""
    from leak import is_gas

    if not isinstance(fluid, Mapping):
        return None, False
    name, outlet = fluid.get("name"), fluid.get("outlet_pressure")
    # whether a fluid of CoolProp is a gas depends on its temperature; with an outlet there is something to subtract
    gas = isinstance(name, str) and (is_gas(name) or (name.startswith("CoolProp:") and outlet is not None))
    if outlet is None:
        return (STANDARD_PRESSURE if gas else None), gas
    match = _match(outlet)
    try:
        return float(exact_quantity(_bare(match) if match else str(outlet), "pressure")), gas
    except (QuantityError, OverflowError):
        # which the reading of the table says
        return None, gas
