"""What takes a complete run of a design; loads nothing that calculates."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from fem_seal.output.columns import LEAK_COLUMNS

if TYPE_CHECKING:
    from fem_seal.case.case import Case

# Columns of leak.csv that take a complete run of the case, the second ones where inputs are uncertain; all others cost
# milliseconds.
_COMPLETE = (
    "knudsen_number",
    "max_accumulated_plastic_strain",
    "load_steps",
)
_SAMPLED = ("leak_rate_low_m3_per_s", "leak_rate_high_m3_per_s", "margin")
FAST = tuple(name for name in LEAK_COLUMNS if name not in _COMPLETE)


def takes_complete_run(case: Case, columns: Sequence[str]) -> bool:
    """Whether columns of a case take seconds or minutes, see `fem_seal.studies.responses.responses`."""
    return (
        not set(columns) <= set(FAST)
        or (case.sampled is not None and not set(columns).isdisjoint(_SAMPLED))
        or case.load.closing != "sealed-area"
        or case.load.target_leak_rate is not None
        or case.load.earlier is not None
        or case.leak.fluid_in_gap != "uncoupled"
        or getattr(case.seat, "wall", "free") != "free"
        or (case.temperature is not None and bool(case.temperature.faces))
        or case.closure.material.hardening is not None
        or case.seat.material.hardening is not None
    )
