"""Texts of findings, from templates/findings.toml."""

from __future__ import annotations

from collections.abc import Sequence

from fem_seal.files import own_tables
from fem_seal.seal.bounds import EXACT, Bounds
from fem_seal.seal.findings import Caution, Level
from fem_seal.seal.load_names import load_name
from fem_seal.seal.load_result import LoadResult


def caution(
    name: str,
    load: LoadResult | None = None,
    loads: Sequence[LoadResult] = (),
    /,
    *,
    outside: bool = False,
    leak_factor: Bounds = EXACT,
    **values: object,
) -> Caution:
    """One thing that a user should know before believing a result.

    Parameters
    ----------
    name : str
        Of its words: kind, reason and text.
    load, loads
        About which load it is, and those from which its name tells it.
    outside : bool
        Whether it makes the numbers worse than doubtful.
    leak_factor
        See `Caution`.
    **values
        What the words have in braces.
    """
    if load is not None:
        values["where"] = load_name(load, loads)
    kind, reason, text = (sentence(name, part, **values) for part in ("kind", "reason", "text"))
    return Caution(kind, Level.OUTSIDE if outside else Level.DOUBTFUL, reason, text, leak_factor)


def sentence(name: str, part: str = "text", /, **values: object) -> str:
    """One of the words of an entry.

    Parameters
    ----------
    name, part : str
    **values
        What the words have in braces.
    """
    words: str = own_tables("findings.toml")[name][part]
    return words.format(**values)
