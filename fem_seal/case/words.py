"""Texts of errors and remarks about a case, from templates/problems.toml."""

from __future__ import annotations

from fem_seal.errors import LoadProblem, Problem
from fem_seal.files import own_tables, sentence
from fem_seal.wording import Words


def problem(name: str, /, **values: object) -> Problem:
    """One wrong entry.

    Parameters
    ----------
    name : str
        Of its words: key, says, and where there are some remedy and value.
    **values
        What the words have in braces.
    """
    words = own_tables("problems.toml")[name]
    key, says, remedy, given = (
        Words(words.get(part, ""), values) for part in ("key", "says", "remedy", "value")
    )
    return Problem(str(key), says, given if "value" in words else None, remedy=remedy, entry=name)


def load_problem(name: str, kind: str = "open", /, **values: object) -> LoadProblem:
    """Why a load cannot be calculated; see `problem` and `LoadProblem`."""
    return LoadProblem(**vars(problem(name, **values)), kind=kind)


def wrong(name: str, /, **values: object) -> ValueError:
    """What the validation of a table says of it, in the words of that name."""
    return ValueError(str(sentence(name, **values)))


def gone_entry(entry: str) -> str | None:
    """What to write instead of a key, or of a value of a key, that earlier versions had; None if none had it.

    Parameters
    ----------
    entry : str
        "load.axial_force", 'interface.law = "persson"'.
    """
    remedy: str | None = own_tables("problems.toml")["gone"].get(entry)
    return remedy
