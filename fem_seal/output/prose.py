"""What the report says at length: definitions, captions and publications, from templates/words.toml.

The text stands there as data; which part of it a result needs is decided where the result is known.
"""

from __future__ import annotations

import tomllib
from functools import cache
from importlib.resources import files
from typing import Any


@cache
def prose() -> dict[str, Any]:
    """The whole file: "definitions", "captions" and "sources"."""
    text = files("fem_seal").joinpath("templates", "words.toml").read_text(encoding="utf-8")
    return tomllib.loads(text)


def definitions() -> list[tuple[str, str]]:
    """Words of the report with their meanings, in the order of the page."""
    return [(one["term"], one["meaning"]) for one in prose()["definitions"]]


def caption(picture: str, *parts: str, **values: str) -> str:
    """Caption of a picture, made of some of its sentences.

    Parameters
    ----------
    picture : str
        Its table under [captions].
    *parts : str
        Keys of the sentences, in their order.
    **values : str
        What stands for {names} in them.
    """
    sentences = prose()["captions"][picture]
    return " ".join(sentences[part].format(**values) for part in parts)
