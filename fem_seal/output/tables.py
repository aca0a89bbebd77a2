"""The tables of a result, and their files."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fem_seal.answers.case_load import CaseLoad
from fem_seal.answers.leakage_class import leakage_classes, nominal_size
from fem_seal.files import own_tables, write_bytes
from fem_seal.output.columns import TEXT_COLUMNS, Column, columns_of
from fem_seal.seal.findings import (
    NOT_CALCULATED,
    VALID,
    VALIDITY_COLUMNS,
    Validity,
    validity_entries,
    why_missing,
)
from fem_seal.seal.load_result import GivenContact, in_order
from fem_seal.seal.scenarios import BESIDE, SCENARIOS
from fem_seal.seal.surface_profile import SurfaceLeak
from leak.standards import STANDARDS, Standard

if TYPE_CHECKING:
    import pandas as pd
    from numpy.typing import NDArray

    from fem_seal.answers.case_load import AnyLoad
    from fem_seal.answers.judgement import Verdict
    from fem_seal.answers.solution import SealSolution
    from fem_seal.case.case import Case
    from fem_seal.seal.load_result import MissingLoad
    from fem_seal.units import Display

# Names and meanings of the columns of the other tables.
MEANINGS: dict[str, dict[str, str]] = dict(own_tables("columns.toml")["meanings"])
MEANINGS["around"] = MEANINGS["around"] | {
    f"leak_rate_{name}_m3_per_s_per_rad": f"the same with {SCENARIOS[name].taken}; empty where none yields"
    for name in BESIDE
}
PROFILE_COLUMNS, IMPRINT_COLUMNS, AROUND_COLUMNS, PARTICLE_COLUMNS = (
    tuple(MEANINGS[table]) for table in ("profile", "imprint", "around", "particles")
)
# the same loads: by the name of a test, and by the share of the set pressure
MEANINGS["set_pressure"] |= {
    name: text for name, text in MEANINGS["standard_tests"].items() if name != "test"
}
CONTACT_COLUMNS, COMPRESSION_COLUMNS, STANDARD_TEST_COLUMNS, SET_PRESSURE_COLUMNS = (
    tuple(MEANINGS[table]) for table in ("contacts", "compression", "standard_tests", "set_pressure")
)


# Headings and rows of a CSV file; without rows there is no file.
CsvTable = tuple[Sequence[str], Sequence[Sequence[float | str]]]
# Ten digits are more than the accuracy of any number, and the files stay readable.
_NUMBER = ".10g"
# Keys of summary.json for a leak rate in the units of leak testing.
_LEAKAGE = ("leak_rate", "mass_flow", "throughput", "standard_leak_rate")


def leak_rows(result: SealSolution, *, all_columns: bool = False) -> list[dict[str, Any]]:
    """Rows of leak.csv, one per load of the case: numbers in SI, NaN where nothing was calculated, and texts.

    Reasons are a list, and a load that is not judged has the verdict None.

    Parameters
    ----------
    result : SealSolution
    all_columns : bool
        With all columns, also those that do not belong to the case; see `columns_of`.
    """
    columns = columns_of(result.case, of_profile=result.of_profile, all_columns=all_columns)
    rows = (
        _with_map(load, _row(columns, load, load.verdict, load.validity, result.display))
        for load in result.loads
    )
    return in_order(rows, result.missing_loads, lambda load: _missing_row(result.case, load, columns))


def _with_map(load: CaseLoad, row: dict[str, Any]) -> dict[str, Any]:
    """The row with what only a load on a map of contact pressure has."""
    leak, contact = load.leak, load.contact
    if not isinstance(leak, SurfaceLeak) or not isinstance(contact, GivenContact):
        return row
    over = leak.over
    return {"step": contact.step, **row, "worst_tenth_share": over.worst_tenth_share, "error": over.error}


def _missing_row(case: Case, load: MissingLoad, columns: Sequence[Column]) -> dict[str, Any]:
    # the check of a case loads no finite elements
    from fem_seal.answers.verdict import missing_verdict

    is_judged = case.requirement is not None and case.requirement.judges(load.fluid_pressure)
    verdict = missing_verdict(case, load.point, load.problem).verdict if is_judged else None
    why = why_missing(load.problem)
    return _row(columns, load, verdict, VALID, case.display) | dict(
        zip(VALIDITY_COLUMNS, (NOT_CALCULATED, [why]), strict=True)
    )


def _row(
    columns: Sequence[Column], load: AnyLoad, verdict: Verdict | None, validity: Validity, display: Display
) -> dict[str, Any]:
    texts = {"verdict": None if verdict is None else str(verdict), **validity_entries(validity, display)}
    return {column.name: texts[column.name] if column.text else column.number(load) for column in columns}


def leak_table(result: SealSolution, *, all_columns: bool = False) -> pd.DataFrame:
    """One row per load of the case with the columns that belong to it, SI.

    reference/columns in the manual explains them. NaN where nothing was calculated. ``verdict`` is
    "pass", "pass unless", "inconclusive", "fail unless", "fail" or, of a load that is not judged, empty. ``validity``
    is "valid", "doubtful", "outside the theory" or, of a load without numbers, "not calculated"; ``validity_reasons``
    gives the reasons, the worst first, with "; " between them (guide/validity in the manual).

    Parameters
    ----------
    result : SealSolution
    all_columns : bool
        With all columns, also those that do not belong to the case.
    """
    import pandas as pd

    table = pd.DataFrame([with_text(row) for row in leak_rows(result, all_columns=all_columns)])
    return table.astype({name: float for name in table if name not in (*TEXT_COLUMNS, "step")})


def with_text(row: Mapping[str, Any]) -> dict[str, Any]:
    """A row with its reasons joined to one text, and an empty text instead of a missing verdict."""
    texts = {"verdict": row["verdict"] or ""} if "verdict" in row else {}
    return {**row, **texts, "validity_reasons": "; ".join(row["validity_reasons"])}


def profile_array(result: SealSolution) -> NDArray[np.float64]:
    """The pressure profiles of all loads, one below the other, with a column for each of `PROFILE_COLUMNS`, SI.

    Parameters
    ----------
    result : SealSolution
    """
    blocks, conductances = [], _conductances(result)
    for load, conductance in zip(result.loads, conductances, strict=True):
        along = np.concatenate(
            [
                np.stack([profile.x, profile.radius, profile.pressure, profile.gap], 1)
                for profile in load.profiles
            ]
        )
        fluid = np.full(len(along), math.nan) if load.gap_pressure is None else load.gap_pressure
        pressure = np.full(len(along), load.fluid_pressure)
        # the direction of the force is that of bodies
        force = np.full(len(along), math.nan) if load.of_profile else load.contact.force_per_length
        blocks.append(np.column_stack([pressure, along, fluid, force, _strain_of(load), conductance]))
    return np.concatenate(blocks)


def _conductances(result: SealSolution) -> list[NDArray[np.float64]]:
    """Thermal conductance along the profile of each load [W/(m^2 K)]; at once, because all share the surface."""
    joint, sizes = result.problem.joint, [len(load.whole_profile.x) for load in result.loads]
    if joint is None:
        return [np.full(size, math.nan) for size in sizes]
    rows = []
    for load, size in zip(result.loads, sizes, strict=True):
        profile = load.whole_profile.at_rest(joint.surface)
        fluid = np.full(size, math.nan) if load.gap_pressure is None else load.gap_pressure
        # where it is not known, that between both sides
        fluid = np.where(np.isfinite(fluid), fluid, 0.5 * load.fluid_pressure)
        rows.append(
            [profile.pressure, fluid, profile.pressure if profile.largest is None else profile.largest]
        )
    return np.split(joint.conductance(*np.concatenate(rows, axis=1)), np.cumsum(sizes)[:-1])


def _strain_of(load: CaseLoad) -> NDArray[np.float64]:
    strain = load.whole_profile.strain
    return np.full((len(load.whole_profile.x), 3), math.nan) if strain is None else strain


def write_leak_csv(result: SealSolution, path: Path, *, all_columns: bool = False) -> Path:
    """Write leak.csv, atomically."""
    return write_rows(path, leak_rows(result, all_columns=all_columns))


def write_rows(path: Path, rows: Sequence[Mapping[str, Any]]) -> Path:
    """Write rows by the names of their columns, reasons as one text; see `write_rows_csv`."""
    texts = [with_text(row) if "validity_reasons" in row else row for row in rows]
    return write_rows_csv(path, tuple(texts[0]), [list(row.values()) for row in texts])


def write_rows_csv(path: Path, columns: Sequence[str], rows: Sequence[Sequence[float | str]]) -> Path:
    """Write numbers and texts under their headings, NaN as nothing, atomically; OutputError if that is impossible."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(map(_cell, row) for row in rows)
    return write_bytes(path, text.getvalue().encode())


def _cell(value: float | str) -> float | str:
    if not isinstance(value, float):
        return value
    return "" if math.isnan(value) else f"{value:{_NUMBER}}"


def contact_rows(result: SealSolution) -> CsvTable:
    """Numbers of each sealing contact under each load.

    Parameters
    ----------
    result : SealSolution
    """
    flow, faces = result.problem.flow, result.problem.faces
    outlet = 0.0 if flow is None else flow.outlet_pressure
    return CONTACT_COLUMNS, [
        (*load.point, f"{face}{number}", *values)
        for load in result.loads
        for face, faces_of_part in zip(
            ("closure", "seat")[-faces:], (load.parts * faces)[:faces], strict=True
        )
        for number, values in _lands_of(faces_of_part, faces, outlet)
    ]


def _lands_of(
    load: CaseLoad, faces: int, outlet: float
) -> Iterator[tuple[str, tuple[float, float, float, float, float, float]]]:
    """Number and values of each contact of one face: one, or those of its lands from the axis outwards."""
    leak = load.leak
    if len(load.profiles) == 1:
        rate = math.nan if leak is None else leak.leak_rate / faces
        pressures = outlet + load.fluid_pressure, outlet
        yield "", (load.line_load, load.peak_pressure, load.fwhm, *pressures, rate)
        return
    flows = ((math.nan,) * 3,) * len(load.profiles) if leak is None else leak.lands
    for number, (profile, flow) in enumerate(zip(load.profiles, flows, strict=True), start=1):
        inner, outer, rate = flow
        ends = sorted((outlet + inner, outlet + outer), reverse=True)
        values = (
            profile.moment(0),
            float(profile.pressure.max()),
            profile.fwhm,
            ends[0],
            ends[1],
            rate / faces,
        )
        yield f" {number}", values


def imprint_rows(result: SealSolution) -> CsvTable:
    """Body, x [m] and depth [m] of each imprint; no rows if nothing yielded."""
    return IMPRINT_COLUMNS, [
        (name, x, depth)
        for name, imprint in result.imprints.items()
        for x, depth in zip(imprint.x.tolist(), imprint.depth.tolist(), strict=True)
    ]


def write_profile_csv(result: SealSolution, path: Path) -> Path:
    """Write profile.csv, atomically."""
    return write_rows_csv(path, PROFILE_COLUMNS, profile_array(result).tolist())


def leakage_table(result: SealSolution) -> list[dict[str, Any]]:
    """Units and classes of all loads as plain numbers and texts; empty without a leak rate.

    Both ends of the interval meet a class; only the lower end meets the class "at best". A load outside the theory has
    no classes.
    """
    size = nominal_size(result.case).size if any(load.leak for load in result.loads) else None
    return [
        {
            "fluid_pressure": load.fluid_pressure,
            **{name: getattr(load.leak, name) for name in _LEAKAGE},
            "classes": {leakage_class.standard: leakage_class.name for leakage_class in classes},
            "classes_at_best": {grade.standard: grade.at_best or grade.name for grade in classes},
            "nominal_size": size,
            "validity": str(load.validity.level),
        }
        for load in result.loads
        if load.leak is not None
        for classes in [leakage_classes(result.case, load)]
    ]


def standards_used(result: SealSolution) -> list[Standard]:
    """The standards whose classes the leak rates are given, and that which is required."""
    named = [grade.standard for load in result.loads for grade in leakage_classes(result.case, load)]
    required = result.case.requirement and result.case.requirement.standard_and_class
    return [STANDARDS[name] for name in dict.fromkeys([*named, *(required or ())[:1]])]
