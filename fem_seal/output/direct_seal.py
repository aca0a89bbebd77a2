"""What `fem-seal direct --seal` writes and shows: simulated strips of the seal beside the chain."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fem_seal.files import write_bytes
from fem_seal.output.prose import said
from fem_seal.output.tables import write_rows_csv
from fem_seal.units import number

if TYPE_CHECKING:
    from fem_seal.seal.direct_seal import SealRow

TABLE = "direct_seal.csv"


def seal_rows(rows: Sequence[SealRow]) -> list[dict[str, Any]]:
    """Rows of direct_seal.csv: names with units, numbers in SI.

    Parameters
    ----------
    rows : sequence of SealRow
    """
    return [_row(row) for row in rows]


def _row(row: SealRow) -> dict[str, Any]:
    place, (peak, fwhm) = row.place, row.measures
    low, high = place.interval or (math.nan, math.nan)
    return {
        "fluid_pressure_Pa": place.fluid_pressure,
        "applied_force_N": place.applied_force,
        "place": place.name,
        "line_load_N_per_m": place.line_load,
        "asperities": row.asperities,
        "samples": len(row.leak_rates),
        "peak_pressure_Pa": peak,
        "fwhm_m": fwhm,
        "contact_area_near_centre": row.contact_area,
        "leak_rate_m3_per_s": row.leak_rate,
        "leak_rate_std_m3_per_s": row.deviation,
        "leak_rate_all_waves_m3_per_s": row.with_all_waves,
        "chain_peak_pressure_Pa": place.profile.peak_pressure,
        "chain_fwhm_m": place.profile.fwhm,
        "chain_leak_rate_held_waves_m3_per_s": row.chain_held,
        "chain_leak_rate_m3_per_s": place.leak_rate,
        "chain_leak_rate_low_m3_per_s": low,
        "chain_leak_rate_high_m3_per_s": high,
        "strip_width_m": place.strip.width,
        "strip_length_m": place.strip.length,
    }


def seal_lines(rows: Sequence[SealRow]) -> list[str]:
    """What was simulated, in sentences.

    Parameters
    ----------
    rows : sequence of SealRow
    """
    strips = {row.place.strip.points: row.place.strip for row in rows}
    strip = next(iter(strips.values()))
    widths = [row.place.strip.width for row in rows]
    shortest = max(2.0 * math.pi / row.place.strip.q_high for row in rows)
    return [
        said(
            "direct.seal",
            "strips",
            least=min(widths),
            most=max(widths),
            points=strip.points,
            shortest=shortest,
        ),
        said("direct.seal", "chain"),
    ]


def write_direct_seal(rows: Sequence[SealRow], folder: Path) -> None:
    """Write table and picture.

    Parameters
    ----------
    rows : sequence of SealRow
    folder : Path
    """
    from fem_seal.output.pictures.direct_seal import seal_picture
    from fem_seal.output.pictures.style import style

    told = seal_rows(rows)
    write_rows_csv(folder / TABLE, tuple(told[0]), [list(row.values()) for row in told])
    with style():
        write_bytes(folder / "direct_seal.svg", seal_picture(rows).svg)


def shown_seal_rows(rows: Sequence[SealRow]) -> tuple[list[str], list[list[str]]]:
    """Headings and cells for the terminal.

    Parameters
    ----------
    rows : sequence of SealRow
    """
    headings = [
        "fluid\nbar", "force\nN", "place", "asperities", "peak\nMPa", "chain\nMPa", "leak rate\nml/min", "std error\n%",
        "chain, same\nwaves, ml/min", "chain over\nsimulated",
    ]  # fmt: skip
    cells = []
    for row in rows:
        place, mean = row.place, row.leak_rate
        error = row.deviation / math.sqrt(len(row.leak_rates)) / mean if mean > 0.0 else math.nan
        cells.append(
            [
                number(place.fluid_pressure / 1e5, 4),
                number(place.applied_force, 4),
                place.name,
                row.asperities,
                number(row.measures[0] / 1e6, 3),
                number(place.profile.peak_pressure / 1e6, 3),
                number(6e7 * mean, 3),
                "-" if math.isnan(error) else number(100.0 * error, 2),
                number(6e7 * row.chain_held, 3),
                number(row.chain_held / mean, 3) if mean > 0.0 else "tight",
            ]
        )
    return headings, cells
