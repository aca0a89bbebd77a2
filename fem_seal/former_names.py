"""Deprecated names: they still work and warn once with the present name.

Keys and columns are put in present words where they come in, so that nothing behind knows the former ones.
"""

from __future__ import annotations

import re
import sys
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import wraps
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

# Entries of a case, by their paths: former and present one.
ENTRIES = {"load.axial_force": "load.applied_force"}
# Values of entries.
VALUES = {"interface.law": {"persson": "spectrum"}}
# Columns of leak.csv.
COLUMNS = {"axial_force_N": "contact_force_N"}
# Public names of `fem_seal` and `fem_seal.contact`.
PUBLIC = {
    "axial_force_for_leak": "applied_force_for_leak",
    "FlowThrough": "PenetratingFluid",
    "FurtherLoads": "BodyLoads",
    "HeldFluid": "FluidAtContact",
    "Seal": "CoupledContact",
}
# Verdicts of studies that are stored.
VERDICTS = {"holds": "pass", "fails": "fail", "undecided": "inconclusive"}
_NAMES = ENTRIES | COLUMNS
_NAME = re.compile(rf"(?<![\w./\\])(?:{'|'.join(map(re.escape, _NAMES))})(?![\w./\\])")
_PACKAGE = str(Path(__file__).parent)

_said: set[str] = set()

P = ParamSpec("P")
R = TypeVar("R")


class FormerNameWarning(DeprecationWarning):
    """A name of before the first release, and the present one."""


def say_once(former: str, present: str) -> None:
    """Warn that a name has another one now, unless this was said before.

    Parameters
    ----------
    former, present : str
    """
    if former not in _said:
        _said.add(former)
        text = f"{former} is called {present} now; the former name still works"
        warnings.warn(text, FormerNameWarning, _level_of_caller())


@contextmanager
def said_to(tell: Callable[[str], None]) -> Iterator[None]:
    """Hand what is said of former names to a function instead of to Python's warnings, each once from here on.

    Parameters
    ----------
    tell : callable
        Takes the sentence.
    """
    _said.clear()
    with warnings.catch_warnings():
        warnings.simplefilter("always", FormerNameWarning)
        others = warnings.showwarning

        def show(message: Warning | str, category: type[Warning], *where: Any) -> None:
            if issubclass(category, FormerNameWarning):
                tell(str(message))
            else:
                others(message, category, *where)

        warnings.showwarning = show  # type: ignore[assignment]
        yield


def _level_of_caller() -> int:
    """How many calls above `say_once` the code stands that is not of this package."""
    frame, level = sys._getframe(1), 1
    while frame.f_back is not None and frame.f_code.co_filename.startswith(_PACKAGE):
        frame, level = frame.f_back, level + 1
    return level


def in_present_entries(entries: Mapping[str, Any], table: str = "") -> dict[str, Any]:
    """Entries of a case, nested tables or dotted keys, under their present names.

    A former name beside the present one stays: it is no key any more, which the check of the case says.

    Parameters
    ----------
    entries : mapping
    table : str
        In which they stand; empty for those of the whole case.

    Examples
    --------
    >>> in_present_entries({"load": {"fluid_pressure": "1 bar"}})
    {'load': {'fluid_pressure': '1 bar'}}
    """
    found: dict[str, Any] = {}
    for name, value in entries.items():
        path, key = f"{table}.{name}".lstrip("."), name
        present = ENTRIES.get(path, path).removeprefix(f"{table}.")
        if path in ENTRIES and present not in entries:
            say_once(path, ENTRIES[path])
            path, key = ENTRIES[path], present
        if path in VALUES:
            value = _present_value(path, value, VALUES[path])
        elif isinstance(value, Mapping) and not table:
            value = in_present_entries(value, path)
        found[key] = value
    return found


def _present_value(path: str, given: Any, values: Mapping[str, str]) -> Any:
    """A value, or each of the levels of a study, by its present name."""
    if isinstance(given, (list, tuple)):
        return [_present_value(path, one, values) for one in given]
    if not isinstance(given, str) or given not in values:
        return given
    say_once(f'{path} = "{given}"', f'"{values[given]}"')
    return values[given]


def in_present_words(value: Any, *, aloud: bool = True) -> Any:
    """Texts that name entries and columns, such as formulas, in present names; in mappings and lists all texts.

    Parameters
    ----------
    value : anything
        What is no text stays as it is.
    aloud : bool
        Whether former names are mentioned.

    Examples
    --------
    >>> in_present_words(["contact_force_N / 2", 3.0])
    ['contact_force_N / 2', 3.0]
    """
    if isinstance(value, str):
        return _NAME.sub(lambda found: _present(found[0], aloud), value)
    if isinstance(value, Mapping):
        return {
            in_present_words(key, aloud=aloud): in_present_words(one, aloud=aloud)
            for key, one in value.items()
        }
    if isinstance(value, (list, tuple)):
        return type(value)(in_present_words(one, aloud=aloud) for one in value)
    return value


def former_column(name: str) -> str:
    """Former name of a column, its present one if it had no other."""
    return next((former for former, present in COLUMNS.items() if present == name), name)


def _present(name: str, aloud: bool) -> str:
    if aloud:
        say_once(name, _NAMES[name])
    return _NAMES[name]


def formerly(**names: str) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Let a function take keywords by their former names.

    Parameters
    ----------
    **names : str
        Present name of each former one.
    """

    def taking(function: Callable[P, R]) -> Callable[P, R]:
        @wraps(function)
        def call(*args: P.args, **given: P.kwargs) -> R:
            for former, present in names.items():
                if former in given and present not in given:
                    say_once(f"{function.__name__}({former}=...)", f"{present}=...")
                    given[present] = given.pop(former)
            return function(*args, **given)

        return call

    return taking


def under_former_names(package: str, find: Callable[[str], Any]) -> Callable[[str], Any]:
    """``__getattr__`` of a package that finds its public names by their former ones, too.

    Parameters
    ----------
    package : str
    find : callable
        Takes a present name.
    """

    def find_by_any_name(name: str) -> Any:
        if name in PUBLIC:
            say_once(f"{package}.{name}", f"{package}.{PUBLIC[name]}")
            name = PUBLIC[name]
        return find(name)

    return find_by_any_name


def former_attribute(former: str, present: str) -> Any:
    """A property that gives an attribute by its former name.

    Parameters
    ----------
    former, present : str
    """

    def get(self: Any) -> Any:
        say_once(f"{type(self).__name__}.{former}", present)
        return getattr(self, present)

    return property(get, doc=f"Former name of `{present}`.")
