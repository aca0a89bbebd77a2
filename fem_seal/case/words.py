"""What is wrong with a case, in the words of templates/problems.toml."""

from __future__ import annotations

from fem_seal.errors import Problem
from fem_seal.files import own_tables


def problem(name: str, /, **values: object) -> Problem:
    """One wrong entry.

    Parameters
    ----------
    name : str
        Of its words: key, text, and value where one stands there.
    **values
        What the words have in braces.
    """
    words = own_tables("problems.toml")[name]
    return Problem(*(words[part].format(**values) for part in ("key", "text", "value") if part in words))
