"""The results as tables: leak.csv, profile.csv and summary.json."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fem_seal.analysis.caution import VALIDITY_COLUMNS, validity_entries
from fem_seal.analysis.leakage import leakage_of, nominal_size
from fem_seal.analysis.profile_leak import PROFILE_LEAK_COLUMNS
from fem_seal.analysis.results import LoadResult, SealSolution
from fem_seal.analysis.variants import ratio_to_case
from fem_seal.bodies.fields import ElastoplasticField
from fem_seal.contact.load_path import ElastoplasticContact
from fem_seal.files import write_bytes, write_text
from leak import CoupledLeakResult
from leak.standards import STANDARDS, Standard

if TYPE_CHECKING:
    import pandas as pd


LEAK_COLUMNS = (
    "fluid_pressure_Pa",
    "axial_force_N",
    "line_load_N_per_m",
    "peak_pressure_Pa",
    "contact_radius_m",
    "fwhm_m",
    "std_m",
    "leak_rate_m3_per_s",
    "leak_rate_elastic_m3_per_s",
    "critical_separation_m",
    "critical_separation_elastic_m",
    "max_von_mises_Pa",
    "leak_rate_low_m3_per_s",
    "leak_rate_high_m3_per_s",
    "leak_rate_kg_per_s",
    "leak_rate_Pa_m3_per_s",
    "leak_rate_standard_m3_per_s",
    "knudsen_number",
    "lift_off_x_m",
    "blow_off_pressure_Pa",
    "applied_force_N",
    "effective_seal_radius_m",
    "force_for_target_leak_N",
    "max_accumulated_plastic_strain",
    "load_steps",
    "opening_margin_N",
    "opening_margin_Pa",
    "opening_margin",
)
PROFILE_COLUMNS = (
    "fluid_pressure_Pa",
    "x_m",
    "r_m",
    "contact_pressure_Pa",
    "gap_m",
    "fluid_pressure_in_gap_Pa",
)

IMPRINT_COLUMNS = ("body", "x_m", "depth_m")
# Ten digits: more than any of the numbers is good for, and the files stay readable.
_NUMBER = ".10g"


def leak_rows(result: SealSolution) -> list[dict[str, Any]]:
    """Rows of leak.csv, one per load: numbers in SI, NaN where nothing was calculated; validity, a list of reasons.

    Parameters
    ----------
    result : SealSolution
    """
    return [
        dict[str, Any](
            zip(
                LEAK_COLUMNS,
                (
                    *_leak_row(load),
                    *interval,
                    *_fluid_row(load),
                    *_lift_off_row(load),
                    *_force_row(load),
                    *_plastic_row(load),
                    *_opening_row(load),
                ),
                strict=True,
            )
        )
        | validity_entries(load.validity)
        for load, interval in zip(result.loads, _intervals(result), strict=True)
    ]


def _intervals(result: SealSolution) -> list[tuple[float, float]]:
    """Lower and upper end of the leak rate's interval at each load."""
    if result.uncertainty is None:
        return [(math.nan, math.nan)] * len(result.loads)
    ends = zip(result.uncertainty.low, result.uncertainty.high, strict=True)
    return [(float(low), float(high)) for low, high in ends]


def _leak_row(load: LoadResult) -> Iterator[float]:
    profile = load.contact.profile
    yield load.fluid_pressure
    yield load.axial_force
    yield load.line_load
    yield profile.peak_pressure
    yield float(np.interp(profile.centroid, profile.x, profile.radius))
    yield profile.fwhm
    yield profile.std
    yield math.nan if load.leak is None else load.leak.leak_rate
    yield math.nan if load.leak_elastic is None else load.leak_elastic.leak_rate
    yield _or_nan(load.critical_separation)
    yield _or_nan(load.critical_separation_elastic)
    yield load.max_von_mises


def _fluid_row(load: LoadResult) -> Iterator[float]:
    """The leak rate as mass and, of a gas, as throughput and at the standard state; the gas's Knudsen number."""
    found = load.leak
    if found is None:
        yield from [math.nan] * 4
        return
    yield _or_nan(found.mass_flow)
    yield _or_nan(found.throughput)
    yield _or_nan(found.standard_leak_rate)
    knudsen = _or_nan(found.knudsen_number)
    yield knudsen if math.isfinite(knudsen) else math.nan


def _lift_off_row(load: LoadResult) -> Iterator[float]:
    """Where the fluid lifts the surfaces off each other, and the pressure at which it does so everywhere."""
    coupled = load.leak if isinstance(load.leak, CoupledLeakResult) else None
    yield math.nan if coupled is None else _or_nan(coupled.lift_off_x)
    yield _or_nan(load.blow_off_pressure if coupled is None else coupled.blow_off_pressure)


def _force_row(load: LoadResult) -> Iterator[float]:
    """Spring force, the circle that the fluid acts on, and the spring force for the target leak rate."""
    yield load.applied_force
    yield _or_nan(load.effective_radius)
    yield _or_nan(load.force_for_target)


def _plastic_row(load: LoadResult) -> Iterator[float]:
    """The largest accumulated plastic strain of both bodies, and the load steps since the load before."""
    contact = load.contact
    if not isinstance(contact, ElastoplasticContact):
        yield from [math.nan] * 2
        return
    yield max(
        float(field.accumulated_plastic_strain.max())
        for field in contact.fields.values()
        if isinstance(field, ElastoplasticField)
    )
    yield float(contact.load_steps)


def _opening_row(load: LoadResult) -> Iterator[float]:
    """How far the load is from opening the seal: force, pressure, and their share in what acts."""
    if load.opening is None:
        yield from [math.nan] * 3
        return
    yield load.opening.force
    yield load.opening.pressure
    yield load.opening.share


def leak_table(result: SealSolution) -> pd.DataFrame:
    """One row per load with `LEAK_COLUMNS`, SI, and `VALIDITY_COLUMNS`, texts.

    ``contact_radius_m`` is the distance of the pressure's centre from the axis; the other columns are those of
    `fem_seal.profile.PressureProfile`, `fem_seal.analysis.results.LoadResult` and
    `fem_seal.analysis.results.LeakInterval`. NaN where nothing was calculated. ``leak_rate_m3_per_s`` of a gas is
    the volume at 101325 Pa and the temperature of the gas; ``leak_rate_kg_per_s``, ``leak_rate_Pa_m3_per_s`` (pV
    throughput of a gas), ``leak_rate_standard_m3_per_s`` (0 degC, 101325 Pa) say the same in other units.
    ``knudsen_number`` is the mean free path over u_eff at the peak. ``axial_force_N`` is the force that the solid
    contact carries, ``applied_force_N`` that of spring or actuator (load.axial_force); they differ by the axial
    force of the fluid, the fluid pressure times the circle of radius ``effective_seal_radius_m`` (closing =
    "penetration") or of first touch. ``blow_off_pressure_Pa`` is the fluid pressure that opens the seal at the force
    of the row, infinite if none does; ``force_for_target_leak_N`` the smallest force of spring or actuator for
    load.target_leak_rate. With leak.fluid_in_gap = "local" ``lift_off_x_m`` and ``blow_off_pressure_Pa`` are where
    the fluid has lifted the surfaces off each other, and the pressure at which it does so everywhere. Where a body
    yields, ``max_accumulated_plastic_strain`` is the largest of both bodies, and ``load_steps`` the number of steps
    from the load before. ``opening_margin_N`` and ``opening_margin_Pa`` are how far force and fluid pressure are
    from opening the seal, ``opening_margin`` their share in what acts; NaN where neither fluid nor spring opens it.
    ``validity`` is "valid", "doubtful" or "outside the theory"; ``validity_reasons`` says why, the worst reason
    first, with "; " between them (docs/validity.md).

    Parameters
    ----------
    result : SealSolution
    """
    import pandas as pd

    rows = [with_text(row) for row in leak_rows(result)]
    table = pd.DataFrame(rows, columns=[*LEAK_COLUMNS, *VALIDITY_COLUMNS])
    return table.astype(dict.fromkeys(LEAK_COLUMNS, float))


def with_text(row: Mapping[str, Any]) -> dict[str, Any]:
    """A row with its reasons in one text."""
    return {**row, "validity_reasons": "; ".join(row["validity_reasons"])}


def profile_array(result: SealSolution) -> NDArray[np.float64]:
    """The pressure profiles of all loads under each other, one column for each of `PROFILE_COLUMNS`, SI.

    Parameters
    ----------
    result : SealSolution
    """
    blocks = []
    for load in result.loads:
        profile = load.contact.profile
        fluid = np.full(len(profile.x), math.nan) if load.gap_pressure is None else load.gap_pressure
        pressure = np.full(len(profile.x), load.fluid_pressure)
        blocks.append(
            np.column_stack([pressure, profile.x, profile.radius, profile.pressure, profile.gap, fluid])
        )
    return np.concatenate(blocks)


def write_leak_csv(result: SealSolution, path: Path) -> Path:
    """Write leak.csv, atomically."""
    rows = [with_text(row) for row in leak_rows(result)]
    return write_rows_csv(path, (*LEAK_COLUMNS, *VALIDITY_COLUMNS), [list(row.values()) for row in rows])


def write_rows_csv(path: Path, columns: Sequence[str], rows: Sequence[Sequence[float | str]]) -> Path:
    """Write numbers and texts under their headings, atomically; OutputError if that is impossible."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows([f"{one:{_NUMBER}}" if isinstance(one, float) else one for one in row] for row in rows)
    return write_bytes(path, text.getvalue().encode())


def write_imprint_csv(result: SealSolution, path: Path) -> Path | None:
    """Write imprint.csv, atomically: body, x [m], depth [m]; None, and an old one is removed, if nothing yielded."""
    imprints = {} if result.unloaded is None else result.unloaded.imprints
    if not imprints:
        path.unlink(missing_ok=True)
        return None
    lines = [",".join(IMPRINT_COLUMNS)]
    for name, imprint in imprints.items():
        lines += [f"{name},{x:.10g},{depth:.10g}" for x, depth in zip(imprint.x, imprint.depth, strict=True)]
    return write_bytes(path, ("\n".join(lines) + "\n").encode("ascii"))


def write_profile_csv(result: SealSolution, path: Path) -> Path:
    """Write profile.csv, atomically."""
    return _write_csv(path, PROFILE_COLUMNS, profile_array(result).tolist())


def _write_csv(path: Path, columns: Sequence[str], rows: Sequence[Sequence[float]]) -> Path:
    line = ",".join([f"%{_NUMBER}"] * len(columns)) + "\n"
    text = ",".join(columns) + "\n" + "".join(line % tuple(row) for row in rows)
    return write_bytes(path, text.encode("ascii"))


def _or_nan(value: float | None) -> float:
    return math.nan if value is None else value


def leakage_table(result: SealSolution) -> list[dict[str, Any]]:
    """Units and classes of all loads as plain numbers and texts; empty without a leak rate.

    A load outside the theory has no classes.
    """
    case = result.case
    return [
        {
            **asdict(found),
            "nominal_size": nominal_size(case).size,
            "classes": {one.standard: one.name for one in found.classes},
            "validity": str(load.validity.level),
        }
        for load in result.loads
        for found in (leakage_of(case, load),)
        if found is not None
    ]


def standards_used(result: SealSolution) -> list[Standard]:
    """The standards that the leak rates are classed by."""
    names = dict.fromkeys(
        one.standard
        for load in result.loads
        for found in (leakage_of(result.case, load),)
        for one in (() if found is None else found.classes)
    )
    return [STANDARDS[name] for name in names]


VARIANT_COLUMNS = (
    "interface_law",
    "conductivity",
    "separation_width",
    "percolation_threshold",
    "fluid_pressure_Pa",
    "leak_rate_m3_per_s",
    "ratio_to_case",
)


def variant_rows(result: SealSolution) -> list[dict[str, object]]:
    """Rows with `COLUMNS`, one per reading and load.

    Parameters
    ----------
    result : SealSolution
        With its `theory_variants`.
    """
    return [
        dict(
            zip(
                VARIANT_COLUMNS,
                (
                    variant.interface_law,
                    variant.conductivity,
                    variant.separation_width or "",
                    variant.percolation_threshold,
                    load.fluid_pressure,
                    rate,
                    ratio_to_case(rate, load.leak.leak_rate if load.leak else 0.0),
                ),
                strict=True,
            )
        )
        for variant in result.theory_variants
        for load, rate in zip(result.loads, variant.leak_rate, strict=True)
    ]


def write_variants_csv(result: SealSolution, path: Path) -> Path:
    """Write variants.csv, atomically."""
    lines = [",".join(VARIANT_COLUMNS)]
    lines += [
        ",".join(f"{value:.10g}" if isinstance(value, float) else str(value) for value in row.values())
        for row in variant_rows(result)
    ]
    return write_text(path, "\n".join(lines) + "\n")


def write_rows(rows: Sequence[Mapping[str, Any]], path: Path) -> None:
    """Write rows as a CSV file; OutputError if it cannot be written."""
    write_rows_csv(
        path, (*PROFILE_LEAK_COLUMNS, *VALIDITY_COLUMNS), [list(with_text(row).values()) for row in rows]
    )
