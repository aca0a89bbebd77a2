"""Sentences of the report from templates/words.toml, with their values filled in.

The texts are data; the modules of the answers choose the sentences that a result needs.
"""

from __future__ import annotations

import math
import string
from collections.abc import Callable, Collection, Mapping
from functools import cache
from typing import TYPE_CHECKING, Any

from fem_seal.files import own_tables
from fem_seal.seal.load_names import load_name
from fem_seal.seal.readings import OWN, WORDS
from fem_seal.units import (
    format_digits,
    format_quantity,
    number,
    percent,
    quantity,
    quantity_worth,
    range_text,
    trimmed,
)
from leak import Reading

if TYPE_CHECKING:
    from jinja2 import Template


@cache
def prose() -> dict[str, Any]:
    """The whole file: "definitions", "captions", "sources" and the other groups of sentences."""
    return own_tables("words.toml")


@cache
def template(name: str, *, escaped: bool = True) -> Template:
    """A template of pages or of their words.

    Parameters
    ----------
    name : str
        File in templates/.
    escaped : bool
        Whether inserted values are escaped, as titles, names and file names of the user must be; not for words, which
        are escaped when they enter a page.
    """
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("fem_seal"),
        autoescape=escaped,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        # a page is made once: folding constants takes longer than it saves
        optimized=False,
    )
    environment.filters["written"] = written
    environment.globals |= {"math": math, "load_name": load_name}
    return environment.get_template(name)


# Formats of a number: without unit, and with the unit that suits it.
_PLAIN: dict[str, Callable[..., str]] = {
    "number": number,
    "percent": percent,
    "trimmed": trimmed,
    "worth": format_digits,
}
_WITH_UNIT: dict[str, Callable[..., str]] = {"given": format_quantity, "worth": quantity_worth}


def written(value: Any, how: str) -> str:
    """A number in the format that words and templates ask for; of a tuple both ends.

    Parameters
    ----------
    value : float or tuple of float
        SI; None is a dash.
    how : str
        "number", "percent", "trimmed" or "worth", or a kind of `fem_seal.units.unit_for`, before which "given" or
        "worth" may stand; then the digits. A format of Python's is one, too, if it begins with no letter.

    Examples
    --------
    >>> written(0.00123, "length 2"), written(0.3, "percent"), written(2e6, "given fluid pressure")
    ('1.2 mm', '30 %', '20 bar')
    >>> written((0.001, 0.0025), "length 2"), written(0.12345, ".2f")
    ('1.0 mm to 2.5 mm', '0.12')
    """
    if isinstance(value, tuple):
        return range_text(*(written(one, how) for one in value))
    first, *rest = how.split()
    if not first[0].isalpha():
        return format(value, how)
    digits = [int(rest.pop())] if rest and rest[-1].isdigit() else []
    if value is None:
        return "–"
    if first in _PLAIN and not rest:
        return _PLAIN[first](value, *digits)
    if first in _WITH_UNIT:
        return _WITH_UNIT[first](" ".join(rest), value, *digits)
    return quantity(" ".join([first, *rest]), value, *digits)


class _Sentence(string.Formatter):
    """Fills values in, in the format of their braces: "{load.fluid_pressure:given fluid pressure}"."""

    def format_field(self, value: Any, format_spec: str) -> str:
        return written(value, format_spec) if format_spec else str(value)


def filled(sentence: str, values: Mapping[str, object]) -> str:
    """A sentence of words.toml with its values; numbers are `written` in the format behind their colon.

    Parameters
    ----------
    sentence : str
    values : mapping
        Values of the {names} in it.

    Examples
    --------
    >>> filled("{share:percent} of {pressure:given fluid pressure}", {"share": 0.2, "pressure": 2e6})
    '20 % of 20 bar'
    """
    return _Sentence().vformat(sentence, (), values)


def other_reading(reading: Reading, clause: str) -> str:
    """A sentence about the result in another reading of yielding asperities.

    Parameters
    ----------
    reading : Reading
    clause : str
        The result in that reading.
    """
    return phrase(
        "readings.load", "other", taken=WORDS[OWN].taken, condition=WORDS[reading].condition, clause=clause
    )


def phrase(where: str, *parts: str, **values: object) -> str:
    """Sentences of one table of the file, joined.

    Parameters
    ----------
    where : str
        The table, such as "captions.mesh".
    *parts : str
        Keys of the sentences, in their order; empty ones are skipped.
    **values
        Values of the {names} in them, see `filled`.
    """
    kind, name = where.split(".")
    sentences = prose()[kind][name]
    return " ".join(filled(sentences[part], values) for part in parts if part)


def worded_rows(name: str, *, without: Collection[str] = (), **values: object) -> list[tuple[str, str]]:
    """Names and texts of a table of words.toml under "rows", in its order.

    Parameters
    ----------
    name : str
        Of the table.
    without : collection of str
        Names that are left out.
    **values
        Values of the {names} in both, see `filled`.
    """
    rows = prose()["rows"][name]
    return [(filled(key, values), filled(text, values)) for key, text in rows.items() if key not in without]
