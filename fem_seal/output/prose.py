"""Sentences of the report from templates/answers/, with their values filled in.

The texts are data; the modules of the answers choose the sentences that a result needs.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from typing import TYPE_CHECKING, Any

from fem_seal.files import own_tables
from fem_seal.seal.load_result import load_name
from fem_seal.units import current_display
from fem_seal.wording import environment, fill

if TYPE_CHECKING:
    from jinja2 import Template


def prose() -> dict[str, Any]:
    """The whole file: "definitions", "tables", "sources" and the other groups."""
    return own_tables("words.toml")


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
    made = environment(current_display(), escaped=escaped)
    made.globals["load_name"] = load_name
    return made.get_template(name)


def phrase(where: str, *parts: str, **values: object) -> str:
    """Sentences of one table, joined.

    Parameters
    ----------
    where : str
        File in templates/answers/ and what the names of its macros begin with, such as "captions.mesh".
    *parts : str
        The sentences, in their order; empty ones are skipped.
    **values
        Values of the {names} in them.
    """
    kind, name = where.split(".")
    words = template(f"answers/{kind}.j2", escaped=False).module
    macros = [getattr(words, re.sub(r"\W", "_", f"{name}_{part}")) for part in parts if part]
    return " ".join(
        macro(**{one: values[one] for one in macro.arguments if one in values}) for macro in macros
    )


def filled(text: str, values: Mapping[str, object]) -> str:
    """A text of words.toml with its values."""
    return fill(current_display(), text, **values)


def worded_rows(name: str, *, without: Collection[str] = (), **values: object) -> list[tuple[str, str]]:
    """Names and texts of a table of words.toml under "rows", in its order.

    Parameters
    ----------
    name : str
        Of the table.
    without : collection of str
        Names that are left out.
    **values
        Values of the {names} in both.
    """
    rows = prose()["rows"][name]
    return [(filled(key, values), filled(text, values)) for key, text in rows.items() if key not in without]
