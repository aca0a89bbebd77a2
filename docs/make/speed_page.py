"""Write docs/verification/made/: figures of speed and memory over versions, a table and a picture for the manual.

    python docs/make/speed_page.py

They come from benchmarks/history.csv, which `python benchmarks/goals.py --record` writes.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))

from history import FILE, Entry, find_previous, latest, read, row, states

FOLDER = Path(__file__).parents[1] / "verification" / "made"
COLUMNS = 3


def page(entries: Sequence[Entry]) -> str:
    """The figures as Markdown: missed goals first, then the latest figures, then all versions."""
    newest = latest(entries)
    misses = [entry for entry in newest if entry.is_met is False]
    with_goal = [entry for entry in newest if entry.is_met is not None]
    return "\n\n".join(
        [
            f"**{len(with_goal) - len(misses)} of {len(with_goal)} goals are met.**" + _list_misses(misses),
            "## The latest figures",
            _table(
                ("figure", "measured", "scaled", "goal", "", "ratio to the one before", "at"),
                [(*_plain(row(entry, find_previous(entries, entry))), entry.commit) for entry in newest],
            ),
            _notes(newest),
            "## Over versions",
            "![Figures over versions](speed.svg)",
            _table(
                ("figure", *(_name(state, entries) for state in states(entries))),
                [_over_versions(entry, entries) for entry in newest],
            ),
        ]
    )


def _list_misses(misses: Sequence[Entry]) -> str:
    if not misses:
        return ""
    lines = [
        f"- {entry.figure}: {_number(entry)}, {entry.machine_scaled / entry.goal:.3g} times "
        f"its goal of {entry.goal:g} {entry.unit}"
        for entry in misses
        if entry.goal
    ]
    return " Missed:\n\n" + "\n".join(lines)


def _number(entry: Entry) -> str:
    return f"{entry.machine_scaled:.3g} {entry.unit}"


def _plain(cells: tuple[str, ...]) -> tuple[str, ...]:
    return tuple("**missed**" if cell == "missed" else cell for cell in cells)


def _notes(newest: Sequence[Entry]) -> str:
    return "\n".join(f"- {entry.figure}: {entry.note}." for entry in newest if entry.note)


def _over_versions(entry: Entry, entries: Sequence[Entry]) -> tuple[str, ...]:
    by_state = {old.state: old for old in entries if old.figure == entry.figure}
    return entry.figure, *(_number(by_state[state]) if state in by_state else "" for state in states(entries))


def _name(state: tuple[str, str], entries: Sequence[Entry]) -> str:
    version, commit = state
    return f"{version} {commit} {next(entry.date for entry in entries if entry.state == state)}"


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    cells = [head, ["---", *["---:"] * (len(head) - 1)], *rows]
    return "\n".join(f"| {' | '.join(cell_row)} |" for cell_row in cells)


def picture(entries: Sequence[Entry], path: Path) -> None:
    """Every figure that has a goal, over versions, with the goal as a line."""
    import matplotlib

    matplotlib.use("svg")
    from matplotlib import pyplot as plt

    entries_shown, places = [entry for entry in latest(entries) if entry.goal is not None], states(entries)
    lines = -(-len(entries_shown) // COLUMNS)
    height = 1.7 * lines
    # given margins: to fit them to the texts of a hundred axes takes longer than to draw them
    margins = {"left": 0.06, "right": 0.975, "bottom": 0.25 / height, "top": 1 - 0.25 / height}
    figure, axes = plt.subplots(
        lines,
        COLUMNS,
        figsize=(3.3 * COLUMNS, height),
        squeeze=False,
        gridspec_kw={**margins, "hspace": 0.35},
    )
    for axis, entry in zip(axes.flat, entries_shown, strict=False):
        values = [old for old in entries if old.figure == entry.figure]
        colour = "tab:green" if entry.is_met else "tab:red"
        axis.plot(
            [places.index(x.state) for x in values], [x.machine_scaled for x in values], "o-", color=colour
        )
        axis.axhline(entry.goal, color="grey", linestyle="--", linewidth=1)
        axis.set_title(entry.figure, fontsize=7)
        axis.set_ylabel(entry.unit, fontsize=7)
        axis.set_ylim(0, 1.1 * max(entry.goal or 0.0, *(x.machine_scaled for x in values)))
        axis.set_xlim(-0.3, len(places) - 0.7)
        # the table has the others between the first and the last
        axis.set_xticks(
            range(len(places)), [places[0][1], *[""] * (len(places) - 2), places[-1][1]], fontsize=6
        )
        axis.tick_params(axis="y", labelsize=6)
    for axis in axes.flat[len(entries_shown) :]:
        axis.remove()
    figure.savefig(path, metadata={"Date": None})
    plt.close(figure)


def main(history: Path = FILE, folder: Path = FOLDER) -> None:
    """Write both files."""
    entries = read(history)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "speed.md").write_text(page(entries) + "\n", encoding="utf-8")
    picture(entries, folder / "speed.svg")


if __name__ == "__main__":
    main()
