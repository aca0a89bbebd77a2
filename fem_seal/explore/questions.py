"""What the browser asks, checked: anything on this machine can send something else."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NoReturn

from werkzeug.exceptions import BadRequest


@dataclass(frozen=True)
class Asked:
    """A design that a page wants to see.

    Parameters
    ----------
    design : dict
        From keys of factors to texts.
    page : str
        Name of the page.
    number : int
        Of its question, counted up.
    wrong : dict
        From keys of factors to texts that stand in their fields and could not be taken.
    """

    design: dict[str, str]
    page: str = ""
    number: int = 0
    wrong: dict[str, str] = field(default_factory=dict)


def asked_of(sent: Any) -> Asked:
    """The question of a page.

    Raises
    ------
    BadRequest
        If it is none.
    """
    if not isinstance(sent, Mapping):
        refuse("asked")
    number = sent.get("number")
    if not isinstance(number, int):
        refuse("number")
    wrong = texts_of(sent.get("wrong") or {}, "wrong")
    return Asked(texts_of(sent.get("design"), "design"), text_of(sent.get("page"), "page"), number, wrong)


def designs_of(sent: Any, most: int) -> list[dict[str, str]]:
    """Designs that a page has pinned.

    Raises
    ------
    BadRequest
        If they are none, or more than a page can show.
    """
    if not isinstance(sent or [], list) or len(sent or []) > most:
        refuse("pins")
    return [texts_of(one, "pins") for one in sent or []]


def texts_of(sent: Any, what: str) -> dict[str, str]:
    """Texts with names.

    Raises
    ------
    BadRequest
        If it is something else.
    """
    if not isinstance(sent, Mapping):
        refuse(what)
    return {key: text_of(text, what) for key, text in sent.items()}


def text_of(sent: Any, what: str) -> str:
    """A text.

    Raises
    ------
    BadRequest
        If it is something else.
    """
    if not isinstance(sent, str):
        refuse(what)
    return sent


def place_of(sent: Any, several: Sequence[Any], what: str) -> int:
    """The place of something in a row.

    Raises
    ------
    BadRequest
        If it has none.
    """
    if not isinstance(sent, int) or not 0 <= sent < len(several):
        refuse(what)
    return sent


def refuse(what: str) -> NoReturn:
    """Say that a part of a question is wrong.

    Raises
    ------
    BadRequest
        Always.
    """
    raise BadRequest(f"{what}: not what the page sends")
