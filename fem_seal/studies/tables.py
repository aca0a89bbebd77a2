"""The tables of a study file as they are read: shapes and types only; `study` says what fits together."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from fem_seal.case.fields import Quantity, Table, Whole

MOST_POINTS = 10_000_000


Kind = Literal["grid", "list", "latin-hypercube", "sobol", "sobol-sensitivity", "morris"]


class Design(Table):
    """[design]: which designs are calculated."""

    kind: Kind = Field(
        "grid",
        description='"grid": every combination; "list": rows of a CSV file; "latin-hypercube", "sobol": spread over '
        'the distributions; "sobol-sensitivity", "morris": points for sensitivity indices',
    )
    file: str | None = Field(
        None,
        description='with kind = "list": CSV file, one column per parameter, relative to the study file',
        examples=["designs.csv"],
    )
    num: Annotated[int, Whole(1, MOST_POINTS)] | None = Field(
        None,
        description='"latin-hypercube", "sobol": number of designs; "sobol-sensitivity": N of N (d + 2) designs for d '
        'parameters; "morris": number of trajectories of d + 1 designs',
        examples=[256],
    )
    seed: Annotated[int, Whole(0, 2**31 - 1)] = Field(1, description="the same seed gives the same designs")
    invalid: Literal["refuse", "skip"] = Field(
        "refuse",
        description='designs that contradict themselves, such as a bore wider than the contact: "refuse" the study, or '
        '"skip" them as failed rows',
    )


class Run(Table):
    """[run]: how the designs are calculated."""

    interpolate_surfaces: bool = Field(
        True,
        description="surfaces that differ in height, hardness or modulus alone share tables of the flow conductivity, "
        "good to about 1e-4; false calculates every surface by itself",
    )
    retries: Annotated[int, Whole(0, 20)] = Field(
        3, description="how often designs are tried again after the worker that held them died"
    )
    time_limit: Annotated[float, Quantity("time", "1 s", "1000 h")] = Field(
        1800.0,
        description="longest time that one design may take; it becomes a failed row then, and the study goes on",
        examples=["30 min"],
    )
    keep_fields: tuple[int, ...] | Literal["none", "best"] = Field(
        "none",
        description='numbers of the designs whose complete results, with VTK files, are kept in DIR/designs; "best": '
        "that of the first goal of the report",
        examples=[[0, 12]],
    )


class Report(Table):
    """[report]: what the page shows."""

    goals: dict[str, Literal["min", "max"]] = Field(
        default_factory=dict,
        description="one or two columns that should be small or large: the best designs, and with two the Pareto front",
        examples=[{"leak_rate_m3_per_s": "min", "max_von_mises_Pa": "min"}],
    )
    standard: Literal["ISO 5208", "API 598", "FCI 70-2"] = Field(
        "ISO 5208", description="standard whose classes the leak rates are sorted into"
    )


class Optimise(Table):
    """[optimise]: look for the best design instead of calculating a given set."""

    minimise: str | tuple[str, ...] | None = Field(
        None,
        description="column or formula that should be small, or several",
        examples=["leak_rate_m3_per_s"],
    )
    maximise: str | tuple[str, ...] | None = Field(
        None, description="column or formula that should be large, or several"
    )
    trials: Annotated[int, Whole(1, 1_000_000)] = Field(100, description="number of designs that are tried")
    batch: Annotated[int, Whole(1, 1000)] = Field(
        4,
        description="designs proposed at a time, calculated side by side; the result does not depend on workers",
    )
    seed: Annotated[int, Whole(0, 2**31 - 1)] = Field(1, description="the same seed gives the same trials")


class StudyTables(Table):
    """A study: one case turned into many."""

    title: str = Field("", description="what tables and pages are headed with; the file name unless given")
    base: str = Field(description="case file, relative to the study file", examples=["ball_cone.toml"])
    changes: dict[str, Any] = Field(
        default_factory=dict,
        description="entries of the case that differ in all designs",
        examples=[{"load.fluid_pressure": "10 bar"}],
    )
    parameters: dict[str, Any] = Field(
        default_factory=dict,
        description='entries of the case that are varied: a list, { start = "30 deg", stop = "60 deg", num = 7, '
        'spacing = "linear" or "log" }, or a distribution',
        examples=[{"seat.angle": ["30 deg", "45 deg", "60 deg"]}],
    )
    design: Design = Design()
    responses: tuple[str, ...] = Field(
        ("peak_pressure_Pa", "fwhm_m", "leak_rate_m3_per_s"),
        description="columns of leak.csv that are calculated",
        examples=[["leak_rate_m3_per_s", "max_von_mises_Pa"]],
    )
    derived: dict[str, str] = Field(
        default_factory=dict,
        description="further columns by formulas over responses and parameters",
        examples=[{"ml_per_min": 'leak_rate_m3_per_s / "1 ml/min"'}],
    )
    constraints: dict[str, str] = Field(
        default_factory=dict,
        description="comparisons that a good design meets",
        examples=[{"elastic": 'max_von_mises_Pa < "1 GPa"'}],
    )
    outside_theory: Literal["leave out", "keep"] = Field(
        "leave out",
        description='designs whose numbers are outside the theory: "leave out" of the best ones, the search and the '
        'Pareto front, or "keep" them like any other; guide/validity in the manual says which they are',
    )
    run: Run = Run()
    report: Report = Report()
    optimise: Optimise | None = None
