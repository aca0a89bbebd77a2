"""Remove control characters from text of the user."""

from __future__ import annotations

import unicodedata

_SHORT = {"\n": "\\n", "\t": "\\t", "\r": "\\r"}


def printable(text: str) -> str:
    r"""A text in one line without control characters, which stand there as they are written in TOML.

    Also without those that turn the direction of writing, and what is left of bytes that are no text.

    Parameters
    ----------
    text : str

    Examples
    --------
    >>> printable("\x1b[31mred\n")
    '\\u001b[31mred\\n'
    """
    if text.isprintable():
        return text
    return "".join(
        sign if sign.isprintable() or unicodedata.category(sign) == "Zs" else _written(sign) for sign in text
    )


def _written(sign: str) -> str:
    number = ord(sign)
    return _SHORT.get(sign) or (f"\\u{number:04x}" if number < 0x10000 else f"\\U{number:08x}")
