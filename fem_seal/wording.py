"""Sentences with their values: the only place that knows the language of templates.

Texts are templates of Jinja: macros of templates/answers/, pages, and entries of the TOML files of messages. A number
is written by the filter `quantity` in the units of display that the environment was made for.
"""

from __future__ import annotations

import math
import os
import re
import sys
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from importlib.util import cache_from_source
from pathlib import Path
from typing import TYPE_CHECKING

from fem_seal.errors import Text, write
from fem_seal.units import Display, keep_units_together

if TYPE_CHECKING:
    from jinja2 import BytecodeCache, Environment, Template


@cache
def environment(display: Display, *, escaped: bool = False) -> Environment:
    """Where templates are read, and what they may call.

    Parameters
    ----------
    display : Display
        Units of the filter `quantity`.
    escaped : bool
        Whether inserted values are escaped, as titles, names and file names of the user must be on a page; not in
        sentences, which are escaped when they enter a page.
    """
    from jinja2 import Environment, PackageLoader, StrictUndefined

    made = Environment(
        loader=PackageLoader("fem_seal"),
        bytecode_cache=_bytecode(escaped),
        auto_reload=False,
        autoescape=escaped,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        # a page is made once: folding constants takes longer than it saves
        optimized=False,
        finalize=lambda value: value.text(display) if isinstance(value, Text) else value,
    )
    made.filters |= {
        "quantity": display.quantity,
        "unbroken": keep_units_together,
        "few": lambda names: join_names([write(name, display) for name in names]),
        "text": lambda value: write(value, display),
    }
    made.globals |= {"math": math, "display": display}
    return made


def _bytecode(escaped: bool) -> BytecodeCache:
    """Compiled templates beside those of modules: to compile them takes a quarter of a second."""
    from jinja2 import BytecodeCache
    from jinja2.bccache import Bucket

    class Beside(BytecodeCache):
        def get_cache_key(self, name: str, filename: str | None = None) -> str:
            optimization = "page" if escaped else "words"
            return cache_from_source(f"{filename}.py", optimization=optimization) if filename else ""

        def load_bytecode(self, bucket: Bucket) -> None:
            with suppress(OSError), Path(bucket.key).open("rb") as file:
                bucket.load_bytecode(file)

        def dump_bytecode(self, bucket: Bucket) -> None:
            if bucket.key and not sys.dont_write_bytecode:
                # a program that is installed for all cannot write there
                with suppress(OSError):
                    draft = Path(f"{bucket.key}.{os.getpid()}")
                    draft.parent.mkdir(parents=True, exist_ok=True)
                    draft.write_bytes(bucket.bytecode_to_string())
                    draft.replace(bucket.key)

    return Beside()


def say(display: Display, name: str, macro: str, /, **values: object) -> str:
    """What a macro of an answer says, in one line.

    Parameters
    ----------
    display : Display
    name : str
        File in templates/answers/, without its ending.
    macro : str
        Its name, with other signs for "_" in it.
    **values
        Its arguments; others are passed over, for macros of one kind that need different ones.
    """
    return _squeezed(_rendered(display, name, macro, values))


def say_all(display: Display, name: str, macro: str, /, **values: object) -> list[str]:
    """Sentences of a macro, each of which has its own line; see `say`."""
    lines = map(_squeezed, _rendered(display, name, macro, values).splitlines())
    return [line for line in lines if line]


def _rendered(display: Display, name: str, macro: str, values: dict[str, object]) -> str:
    words = environment(display).get_template(f"answers/{name}.j2").module
    called = getattr(words, re.sub(r"\W", "_", macro))
    return str(called(**{key: values[key] for key in called.arguments if key in values}))


def _squeezed(text: str) -> str:
    # spaces that do not break stay
    return re.sub(r"[ \n]+", " ", text).strip(" ")


def fill(display: Display, text: str, /, **values: object) -> str:
    """One text with its values.

    Parameters
    ----------
    display : Display
    text : str
    **values
        What it has in braces.

    Examples
    --------
    >>> text = '{{ share | quantity("percent") }} of {{ pressure | quantity("given fluid pressure") }}'
    >>> fill(Display(), text, share=0.2, pressure=2e6), fill(Display("US"), text, share=0.2, pressure=2e6)
    ('20 % of 20 bar', '20 % of 290.075 psi')
    """
    return _template(display, text).render(values) if "{" in text else text


@cache
def _template(display: Display, text: str) -> Template:
    return environment(display).from_string(text)


@dataclass(frozen=True)
class Words(Text):
    """A template and its values.

    Parameters
    ----------
    template : str
    values : mapping
        What it has in braces.

    Examples
    --------
    >>> force = Quantity(250.0, "force 2")
    >>> print(force, force.text(Display("US")), Words("from {{ force }} on", {"force": force}))
    250 N 56 lbf from 250 N on
    """

    template: str
    values: Mapping[str, object]

    def text(self, display: Display | None = None) -> str:
        """See `fem_seal.errors.Text.text`."""
        return fill(display or Display(), self.template, **self.values)


@dataclass(frozen=True)
class Quantity(Text):
    """A number in a format of `Display.quantity`.

    Parameters
    ----------
    value : float or tuple of float
        SI.
    how : str
    """

    value: float | tuple[float, float]
    how: str

    def text(self, display: Display | None = None) -> str:
        """See `fem_seal.errors.Text.text`."""
        return (display or Display()).quantity(self.value, self.how)


def join_names(names: Sequence[str], most: int = 3) -> str:
    """Names with commas between them, of many the first two and how many more there are.

    Parameters
    ----------
    names : sequence of str
    most : int
        So many names are told.

    Examples
    --------
    >>> join_names(["1 bar", "2 bar", "3 bar"]), join_names(["1 bar", "2 bar", "3 bar", "4 bar"])
    ('1 bar, 2 bar, 3 bar', '1 bar, 2 bar and 2 more')
    """
    if len(names) <= most:
        return ", ".join(names)
    return f"{', '.join(names[: most - 1])} and {len(names) - most + 1} more"


def template(display: Display, name: str) -> Template:
    """A page, in which inserted values are escaped.

    Parameters
    ----------
    display : Display
    name : str
        File in templates/.
    """
    return environment(display, escaped=True).get_template(name)
