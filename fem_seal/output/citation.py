"""How to cite the program and the paper whose method it implements."""

from __future__ import annotations

from fem_seal.output.prose import said
from fem_seal.version import __version__

# Of this version.
_YEAR = 2026
_NAMES = ("program", "paper")


def citation() -> str:
    """Both references as text, and as BibTeX below."""
    values = {"version": __version__, "year": _YEAR}
    program, paper = (
        [said(f"citation.{name}", form, **values) for form in ("text", "bibtex")] for name in _NAMES
    )
    return "\n\n".join([f"{program[0]}\n{paper[0]}", program[1], paper[1]])
