"""What the browser asks, checked: anything on this machine can send something else."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NoReturn, TypeVar

from pydantic import BaseModel, ConfigDict, TypeAdapter, ValidationError
from werkzeug.exceptions import BadRequest

T = TypeVar("T")
# From keys of factors to texts.
Design = dict[str, str]


class Asked(BaseModel):
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

    model_config = ConfigDict(strict=True, frozen=True)

    design: Design
    page: str
    number: int
    wrong: Design = {}


class Entered(BaseModel):
    """A text that has been typed in.

    Parameters
    ----------
    text : str
    before : str
        What was calculated with until then.
    at : int
        Place of its slider.
    """

    model_config = ConfigDict(strict=True, frozen=True)

    text: str
    before: str
    at: int


def checked(kind: type[T], sent: Any, what: str) -> T:
    """A part of a question.

    Parameters
    ----------
    kind : type
        That it must be of.
    sent : object
    what : str
        Its name.

    Raises
    ------
    BadRequest
        If it is something else.
    """
    try:
        return TypeAdapter(kind).validate_python(sent, strict=True)
    except ValidationError as error:
        refuse(next((str(part) for part in error.errors()[0]["loc"] if part in Asked.model_fields), what))


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
