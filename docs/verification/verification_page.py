"""Parts of the verification page: words, a table, and figures with their goals."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Figure:
    """One number that has a goal."""

    what: str
    error: float
    goal: float

    @property
    def is_met(self) -> bool:
        """Whether the goal is met."""
        return abs(self.error) <= self.goal


@dataclass(frozen=True)
class PageSection:
    """One part of the page: words, a table, and the figures in it that have a goal."""

    title: str
    text: str
    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    figures: tuple[Figure, ...] = ()


def markdown(section: PageSection) -> str:
    """One section as Markdown."""
    lines = [
        f"## {section.title}",
        "",
        section.text,
        "",
        "| " + " | ".join(section.head) + " |",
        "|" + "---|" * len(section.head),
    ]
    lines += ["| " + " | ".join(row) + " |" for row in section.rows]
    misses = [figure for figure in section.figures if not figure.is_met]
    if section.figures:
        verdict = "All goals met." if not misses else f"**Missed: {', '.join(f.what for f in misses)}.**"
        lines += ["", verdict]
    return "\n".join(lines)
