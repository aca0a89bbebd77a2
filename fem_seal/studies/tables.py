"""The tables of a study file as they are read: shapes and types only; `study` says what fits together."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from fem_seal.case.fields import Quantity, Table, Whole

MOST_POINTS = 10_000_000


Kind = Literal["grid", "list", "latin-hypercube", "sobol", "sobol-sensitivity", "morris"]


class Design(Table):
    """[design]: which designs are calculated."""

    kind: Kind = "grid"
    file: str | None = None
    num: Annotated[int, Whole(1, MOST_POINTS)] | None = None
    seed: Annotated[int, Whole(0, 2**31 - 1)] = 1
    invalid: Literal["refuse", "skip"] = "refuse"


class Run(Table):
    """[run]: how the designs are calculated."""

    interpolate_surfaces: bool = True
    retries: Annotated[int, Whole(0, 20)] = 3
    time_limit: Annotated[float, Quantity("time", "1 s", "1000 h")] = 1800.0
    keep_fields: tuple[int, ...] | Literal["none", "best"] = "none"


class Report(Table):
    """[report]: what the page shows."""

    goals: dict[str, Literal["min", "max"]] = Field(default_factory=dict)
    standard: Literal["ISO 5208", "API 598", "FCI 70-2"] = "ISO 5208"


class Optimise(Table):
    """[optimise]: look for the best design instead of calculating a given set."""

    minimise: str | tuple[str, ...] | None = None
    maximise: str | tuple[str, ...] | None = None
    trials: Annotated[int, Whole(1, 1_000_000)] = 100
    batch: Annotated[int, Whole(1, 1000)] = 4
    seed: Annotated[int, Whole(0, 2**31 - 1)] = 1


class StudyTables(Table):
    """A study: one case turned into many."""

    title: str = ""
    base: str
    changes: dict[str, Any] = Field(default_factory=dict)
    parameters: dict[str, Any] = Field(default_factory=dict)
    design: Design = Design()
    responses: tuple[str, ...] = ("peak_pressure_Pa", "fwhm_m", "leak_rate_m3_per_s")
    derived: dict[str, str] = Field(default_factory=dict)
    constraints: dict[str, str] = Field(default_factory=dict)
    outside_theory: Literal["leave out", "keep"] = "leave out"
    run: Run = Run()
    report: Report = Report()
    optimise: Optimise | None = None
