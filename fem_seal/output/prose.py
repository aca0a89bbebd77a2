"""What the report says at length: definitions, captions, notes and publications, from templates/words.toml.

The text stands there as data; which part of it a result needs is decided where the result is known.
"""

from __future__ import annotations

import tomllib
from functools import cache
from importlib.resources import files
from typing import TYPE_CHECKING, Any

from fem_seal.seal.readings import OWN, WORDS
from leak import Reading

if TYPE_CHECKING:
    from jinja2 import Template


@cache
def prose() -> dict[str, Any]:
    """The whole file: "definitions", "captions", "sources" and the other groups of sentences."""
    text = files("fem_seal").joinpath("templates", "words.toml").read_text(encoding="utf-8")
    return tomllib.loads(text)


@cache
def template(name: str, *, escaped: bool = True) -> Template:
    """A template of pages or of their words.

    Parameters
    ----------
    name : str
        File in templates/.
    escaped : bool
        Whether what is put into it is escaped, as titles, names and file names have to be, which come from the user;
        not in words, which are escaped where they enter a page.
    """
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("fem_seal"),
        autoescape=escaped,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return environment.get_template(name)


def definitions(*, readings: bool) -> list[tuple[str, str]]:
    """Words of the report with their meanings, in the order of the page.

    Parameters
    ----------
    readings : bool
        Whether those of the readings of yielding asperities are among them.
    """
    told = (one for one in prose()["definitions"] if readings or not one.get("readings", False))
    return [(one["term"], one["meaning"]) for one in told]


def other_reading(reading: Reading, told: str) -> str:
    """What something is in another reading of yielding asperities than the one it is told in.

    Parameters
    ----------
    reading : Reading
    told : str
        A clause.
    """
    return said(
        "readings.load", "other", taken=WORDS[OWN].taken, condition=WORDS[reading].condition, told=told
    )


def said(where: str, *parts: str, **values: object) -> str:
    """Some of the sentences of one table of the file, one after the other.

    Parameters
    ----------
    where : str
        The table, such as "captions.mesh".
    *parts : str
        Keys of the sentences, in their order; empty ones are passed over.
    **values
        What stands for {names} in them.
    """
    kind, name = where.split(".")
    sentences = prose()[kind][name]
    return " ".join(sentences[part].format(**values) for part in parts if part)
