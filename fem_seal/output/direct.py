"""Output of `fem-seal direct`: tables of the samples compared with the theory, pictures of contact and flow.

With `--seal` the samples are strips of the seal, compared with the chain.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fem_seal.files import as_json, write_bytes, write_text
from fem_seal.output.answer_output import prose
from fem_seal.output.tables import write_rows
from fem_seal.seal.direct import QUANTILES, DirectRow, DirectTable
from fem_seal.units import attributes, number
from fem_seal.wording import say_all
from leak import Reading
from leak.theory.plasticity import READINGS

if TYPE_CHECKING:
    from fem_seal.seal.direct_seal import SealRow
    from fem_seal.units import Display

TABLE, GAPS, ABOUT, SEAL_TABLE = "direct.csv", "direct_gaps.csv", "direct.json", "direct_seal.csv"


def direct_rows(table: DirectTable, viscosity: float | None = None) -> list[dict[str, Any]]:
    """Rows of direct.csv: names with units, numbers in SI.

    Parameters
    ----------
    table : DirectTable
    viscosity : float or None
        Of the liquid [Pa s]; without it there are only effective gaps, which depend on the surface alone.
    """
    return [_row(table, row, viscosity) for row in table.rows]


def _row(table: DirectTable, row: DirectRow, viscosity: float | None) -> dict[str, Any]:
    theory, nan = row.theory, math.nan
    low, high = table.ends(row) if row.branch == "load" else (nan, nan)

    def conductivity(gap: float) -> float:
        return nan if viscosity is None else gap**3 / (12.0 * viscosity)

    gaps = {name: nan if theory is None else theory.gap.get(name, nan) for name in READINGS["paper"]}
    return {
        **attributes(row, "branch", "pressure_Pa", "largest_pressure_Pa", "samples", "contact_area"),
        **attributes(row, "contact_area_scatter", "yielded_area", "mean_gap_m", "mean_gap_scatter_m"),
        **{f"gap_q{100 * q:.0f}_m": gap for q, gap in zip(QUANTILES, row.gap_quantiles, strict=True)},
        "effective_gap_m": row.effective_gap,
        "conductivity_m3_per_Pa_s": conductivity(row.effective_gap),
        "conductivity_low_m3_per_Pa_s": conductivity(low),
        "conductivity_high_m3_per_Pa_s": conductivity(high),
        "conductivity_log_scatter": row.log_scatter,
        "blocked_samples": row.blocked,
        "conductivity_ratio_half_cutoff": row.cutoff_ratio,
        "theory_contact_area": nan if theory is None else theory.contact_area,
        "theory_mean_gap_m": nan if theory is None else theory.mean_gap,
        **{f"theory_conductivity_{name}_m3_per_Pa_s": conductivity(gap) for name, gap in gaps.items()},
        **{f"theory_effective_gap_{name}_m": gap for name, gap in gaps.items()},
        **{
            f"theory_conductivity_ratio_all_waves_{name}": nan
            if theory is None or name not in theory.gap
            else theory.cutoff_factor(name)
            for name in gaps
        },
        **_strained(table, row),
    }


def _strained(table: DirectTable, row: DirectRow) -> dict[str, float]:
    """The same state over metal that is strained as in the contact; nan where that is not simulated."""
    strain, area, gap, expected = (math.nan, math.nan), math.nan, math.nan, math.nan
    if table.strained is not None:
        bulk, strained = table.strained.simulation.settings.bulk, table.strained.rows[table.rows.index(row)]
        area, gap = strained.contact_area, strained.effective_gap
        if bulk is not None and strained.theory is not None:
            strain, expected = bulk.counted(row.pressure), strained.theory.gap[Reading.CAPPED]
    return {
        "bulk_strain_meridional": strain[0],
        "bulk_strain_hoop": strain[1],
        "strained_contact_area": area,
        "strained_effective_gap_m": gap,
        "theory_strained_effective_gap_m": expected,
    }


def gap_rows(table: DirectTable) -> Iterator[dict[str, Any]]:
    """Rows of direct_gaps.csv: share of the area per gap in classes of equal width.

    Parameters
    ----------
    table : DirectTable
    """
    edges = table.simulation.gap_edges
    for row, density in zip(table.rows, table.gap_density, strict=True):
        for low, high, value in zip(edges[:-1], edges[1:], density, strict=True):
            yield {
                "branch": row.branch,
                "pressure_Pa": row.pressure,
                "gap_from_m": float(low),
                "gap_to_m": float(high),
                "density_per_m": float(value),
            }


def direct_numbers(table: DirectTable) -> dict[str, Any]:
    """Numbers of the simulation for direct.json and `--json`.

    Parameters
    ----------
    table : DirectTable
    """
    simulation, patch = table.simulation, table.simulation.patch
    measured = simulation.heights is not None
    return {
        **attributes(patch, "points", "size_m", "shortest_wavelength_m"),
        "samples": simulation.settings.samples,
        "seed": None if measured else simulation.settings.seed,
        "measured_map": measured,
        "direction": simulation.settings.direction,
        "rms_height_m": simulation.rms_height,
        "rms_height_of_surface_m": None if simulation.has_crests else simulation.surface.spectrum.rms_height,
        "rms_height_of_fine_roughness_m": simulation.surface.spectrum.rms_height
        if simulation.has_crests
        else None,
        "height_variance_cut": None if measured else patch.height_cut,
        "slope_variance_cut": None if measured else patch.slope_cut,
        **attributes(simulation.surface, "effective_modulus_Pa", "hardness_Pa"),
        "asperities": simulation.asperities,
        "yield_stress_Pa": simulation.settings.yield_stress,
        "poissons_ratio": None
        if simulation.settings.yield_stress is None
        else simulation.settings.poissons_ratio,
        "load_step_Pa": simulation.load_step,
    }


def direct_lines(display: Display, table: DirectTable) -> list[str]:
    """The simulation in sentences.

    Parameters
    ----------
    display : Display
    table : DirectTable
    """
    simulation, (default, *further) = table.simulation, table.simulation.readings
    several = len(simulation.surface.readings) > 1
    theory = [row.theory for row in table.loading if row.theory is not None]
    ratios = {
        str(reading if several else Reading.ELASTIC): [row.cutoff_factor(reading) for row in theory]
        for reading in ([*further, default] if several else [default])
    }
    ratios["half"] = [row.cutoff_ratio for row in table.loading]
    known_ratios = {name: [*filter(math.isfinite, some)] for name, some in ratios.items()}
    costs = {name: (min(some), max(some)) for name, some in known_ratios.items() if some}
    strained = None if table.strained is None else table.strained.simulation.settings.bulk
    return say_all(display, "direct", "simulated", simulation=simulation, costs=costs, strained=strained)


def write_direct(display: Display, table: DirectTable, folder: Path, viscosity: float | None) -> None:
    """Write tables and pictures.

    Parameters
    ----------
    display : Display
    table : DirectTable
    folder : Path
    viscosity : float or None
        Of the liquid [Pa s].
    """
    from fem_seal.output.pictures.direct import curves_picture, map_picture
    from fem_seal.output.pictures.style import style

    write_rows(folder / TABLE, direct_rows(table, viscosity))
    write_rows(folder / GAPS, list(gap_rows(table)))
    write_text(folder / ABOUT, as_json({**direct_numbers(table), "sentences": direct_lines(display, table)}))
    with style():
        write_bytes(folder / "direct.svg", curves_picture(display, table).svg)
        rows = [row for row in table.rows if row.branch == "load"]
        for name, n in zip(
            ("low", "middle", "high"), np.linspace(0, len(rows) - 1, 3).round().astype(int), strict=True
        ):
            write_bytes(folder / f"direct_map_{name}.svg", map_picture(display, table, rows[n].pressure).svg)


def shown_rows(display: Display, rows: Sequence[Mapping[str, Any]]) -> tuple[list[str], list[list[str]]]:
    """Headings and cells for the terminal.

    Parameters
    ----------
    display : Display
    rows : sequence of mapping
        From `direct_rows`.
    """
    return _on_terminal(
        display, "samples", [{**row, "tight": f"{row['blocked_samples']}/{row['samples']}"} for row in rows]
    )


def _on_terminal(
    display: Display, name: str, rows: Sequence[Mapping[str, Any]]
) -> tuple[list[str], list[list[str]]]:
    """Headings and cells of a table of words.toml: texts, and numbers in the units of display."""
    columns = [
        (column, display.fixed_unit(column.get("unit", "")))
        for column in prose()["terminal"][name]
        if "digits" not in column or not all(math.isnan(row[column["key"]]) for row in rows)
    ]
    cells = [
        [
            _cell(unit.of(row[column["key"]]), column["digits"]) if "digits" in column else row[column["key"]]
            for column, unit in columns
        ]
        for row in rows
    ]
    return [column["heading"].format(unit=unit.name) for column, unit in columns], cells


def _cell(value: float, digits: int) -> str:
    return "-" if math.isnan(value) else number(value, digits)


def seal_numbers(row: SealRow) -> dict[str, Any]:
    """A row of direct_seal.csv: names with units, numbers in SI.

    Parameters
    ----------
    row : SealRow
    """
    place, (peak, fwhm) = row.place, row.measures
    low, high = place.interval or (math.nan, math.nan)
    return {
        **attributes(place, "fluid_pressure_Pa", "applied_force_N"),
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


def seal_lines(display: Display, rows: Sequence[SealRow]) -> list[str]:
    """The simulation of the strips in sentences.

    Parameters
    ----------
    display : Display
    rows : sequence of SealRow
    """
    return say_all(display, "direct", "seal", strips=[row.place.strip for row in rows])


def write_direct_seal(display: Display, rows: Sequence[SealRow], folder: Path) -> None:
    """Write table and picture.

    Parameters
    ----------
    display : Display
    rows : sequence of SealRow
    folder : Path
    """
    from fem_seal.output.pictures.direct import seal_picture
    from fem_seal.output.pictures.style import style

    write_rows(folder / SEAL_TABLE, [seal_numbers(row) for row in rows])
    with style():
        write_bytes(folder / "direct_seal.svg", seal_picture(display, rows).svg)


def shown_seal_rows(display: Display, rows: Sequence[SealRow]) -> tuple[list[str], list[list[str]]]:
    """Headings and cells for the terminal.

    Parameters
    ----------
    display : Display
    rows : sequence of SealRow
    """
    cells = []
    for row in rows:
        mean, leaks = row.leak_rate, row.leak_rate > 0.0
        error = 100.0 * row.deviation / math.sqrt(len(row.leak_rates)) / mean if leaks else math.nan
        ratio = number(row.chain_held / mean, 3) if leaks else "tight"
        cells.append({**seal_numbers(row), "error": error, "chain_over_simulated": ratio})
    return _on_terminal(display, "seal", cells)
