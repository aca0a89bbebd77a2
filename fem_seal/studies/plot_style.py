"""What the plots of a study's page have in common."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from fem_seal.studies.analysis import Designs
from fem_seal.studies.display import Display

if TYPE_CHECKING:
    import pandas as pd

# More points than these make a page slow and its plots a blot; a regular part of the designs is drawn then.
MOST_POINTS = 5000
BLUE, ORANGE, GREY = "#0969da", "#bc4c00", "#8c959f"
LAYOUT: dict[str, Any] = {
    "template": "plotly_white",
    "margin": {"l": 70, "r": 20, "t": 30, "b": 60},
    "height": 460,
}
MEETING = {"size": 7, "color": BLUE, "opacity": 0.75}
VIOLATING = {"size": 7, "color": GREY, "symbol": "circle-open", "line": {"width": 1.5}}


def drawn(table: pd.DataFrame) -> pd.DataFrame:
    """The designs that are drawn: all, or a regular part of many."""
    step = -(-len(table) // MOST_POINTS)
    return table if step <= 1 else table.iloc[::step]


def verdict(designs: Designs) -> str:
    """What is wrong with a design that does not count, for a legend."""
    return designs.why_not_counted.replace("violate", "violates").replace("are outside", "outside")


def by_verdict(display: Display, rows: pd.Index) -> list[tuple[str, pd.Index, dict[str, Any]]]:
    """Designs that count and those that do not: legend, designs, marker; one group if all do."""
    designs = display.designs
    if not designs.some_do_not_count:
        return [("designs", rows, MEETING)]
    fails = ~designs.counted.loc[rows].to_numpy()
    good = "inside the theory" if designs.left_out else "meets the constraints"
    groups = [(good, rows[~fails], MEETING), (verdict(designs), rows[fails], VIOLATING)]
    return [group for group in groups if len(group[1])]
