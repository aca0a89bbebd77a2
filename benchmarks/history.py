"""What was measured of every version: the rows of benchmarks/history.csv, and how they are compared."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path

FILE = Path(__file__).parent / "history.csv"
# The goals in seconds are for a machine that imports numpy, scipy's sparse solvers, gmsh and scikit-fem in this time.
GOAL_MACHINE = 0.33
_TIMES = ("s", "ms")


@dataclass(frozen=True)
class Entry:
    """One figure of one version.

    Parameters
    ----------
    version, date, commit : str
        Of the program; the date is that of the measurement.
    figure : str
        What was measured; the same words in every version.
    value : float
    unit : str
        "s" and "ms" are times, which depend on the machine; "imports" is processor time over that of the imports.
    goal : float or None
        Largest value that is wanted, in `unit`, of a time on the machine of the goals.
    reference_s : float
        Processor time of the imports on the machine that measured [s], in one thread.
    note : str
        What else is to be known of the value.
    """

    version: str
    date: str
    commit: str
    figure: str
    value: float
    unit: str
    goal: float | None
    reference_s: float
    note: str = ""

    @property
    def state(self) -> tuple[str, str]:
        """Which program it was."""
        return self.version, self.commit

    @property
    def machine_scaled(self) -> float:
        """The value on the machine of the goals."""
        return self.value * GOAL_MACHINE / self.reference_s if self.unit in _TIMES else self.value

    @property
    def is_met(self) -> bool | None:
        """Whether the goal is met; None without goal."""
        return None if self.goal is None else self.machine_scaled <= self.goal


def read(path: Path = FILE) -> list[Entry]:
    """All rows, the oldest first."""
    with path.open(newline="", encoding="utf-8") as file:
        return [_entry(row) for row in csv.DictReader(file)]


def _entry(row: dict[str, str]) -> Entry:
    entry = Entry(**{**row, "value": 0.0, "goal": None, "reference_s": 0.0})  # type: ignore[arg-type]
    goal = float(row["goal"]) if row["goal"] else None
    return replace(entry, value=float(row["value"]), goal=goal, reference_s=float(row["reference_s"]))


def write(entries: Iterable[Entry], path: Path = FILE) -> None:
    """Replace the file."""
    with path.open("w", newline="", encoding="utf-8") as file:
        rows = csv.DictWriter(file, [field.name for field in fields(Entry)], lineterminator="\n")
        rows.writeheader()
        rows.writerows(
            {name: f"{x:.4g}" if isinstance(x, float) else x for name, x in asdict(entry).items()}
            for entry in entries
        )


def with_new(old: Sequence[Entry], new: Sequence[Entry]) -> list[Entry]:
    """History with new rows at its end; what was measured of the same program before, they replace."""
    names = {(entry.state, entry.figure) for entry in new}
    return [entry for entry in old if (entry.state, entry.figure) not in names] + list(new)


def find_previous(entries: Sequence[Entry], entry: Entry) -> Entry | None:
    """The same figure of the last program before this one."""
    others = [old_entry for old_entry in entries if old_entry.figure == entry.figure]
    at = others.index(entry) if entry in others else len(others)
    return next((old_entry for old_entry in reversed(others[:at]) if old_entry.state != entry.state), None)


def latest(entries: Sequence[Entry]) -> list[Entry]:
    """The last value of each figure, in the order in which the figures came first."""
    return list({entry.figure: entry for entry in entries}.values())


def states(entries: Sequence[Entry]) -> list[tuple[str, str]]:
    """The programs that were measured, the oldest first."""
    return list(dict.fromkeys(entry.state for entry in entries))


def row(entry: Entry, previous: Entry | None) -> tuple[str, ...]:
    """Cells of a table: figure, measured, on the machine of the goals, goal, whether met, ratio to the last version."""
    goal = "" if entry.goal is None else f"{entry.goal:g} {entry.unit}"
    verdict = {None: "", True: "met", False: "missed"}[entry.is_met]
    time_text = f"{entry.machine_scaled:.3g}" if entry.unit in _TIMES else ""
    ratio = (
        f"{entry.machine_scaled / previous.machine_scaled:.2f}"
        if previous is not None and previous.machine_scaled
        else ""
    )
    return entry.figure, f"{entry.value:.3g} {entry.unit}", time_text, goal, verdict, ratio


HEAD = ("figure", "measured", "scaled", "goal", "", "to last")
