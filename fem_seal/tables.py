"""The results as tables: leak.csv, profile.csv and summary.json."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fem_seal.atomic_files import write_bytes

if TYPE_CHECKING:
    import pandas as pd

    from fem_seal.results import LoadResult, SealResult

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
)
PROFILE_COLUMNS = (
    "fluid_pressure_Pa",
    "x_m",
    "r_m",
    "contact_pressure_Pa",
    "gap_m",
    "fluid_pressure_in_gap_Pa",
)


def leak_rows(result: SealResult) -> list[dict[str, float]]:
    """Rows of leak.csv, one per load, SI; NaN where nothing was calculated.

    Parameters
    ----------
    result : SealResult
    """
    return [dict(zip(LEAK_COLUMNS, _leak_row(load), strict=True)) for load in result.loads]


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


def leak_table(result: SealResult) -> pd.DataFrame:
    """One row per load with `LEAK_COLUMNS`, SI.

    ``contact_radius_m`` is the distance of the pressure's centre from the axis; the other columns are those of
    `fem_seal.profile.PressureProfile` and `fem_seal.results.LoadResult`. NaN where nothing was calculated.

    Parameters
    ----------
    result : SealResult
    """
    import pandas as pd

    return pd.DataFrame(leak_rows(result), columns=list(LEAK_COLUMNS), dtype=float)


def profile_array(result: SealResult) -> NDArray[np.float64]:
    """The pressure profiles of all loads under each other, one column for each of `PROFILE_COLUMNS`, SI.

    Parameters
    ----------
    result : SealResult
    """
    blocks = []
    for load in result.loads:
        profile = load.contact.profile
        fluid = np.full(len(profile.x), math.nan) if load.leak is None else load.leak.fluid_pressure
        pressure = np.full(len(profile.x), load.fluid_pressure)
        blocks.append(
            np.column_stack([pressure, profile.x, profile.radius, profile.pressure, profile.gap, fluid])
        )
    return np.concatenate(blocks)


def profile_table(result: SealResult) -> pd.DataFrame:
    """The pressure profiles of all loads under each other, with `PROFILE_COLUMNS`, SI.

    Parameters
    ----------
    result : SealResult
    """
    import pandas as pd

    return pd.DataFrame(profile_array(result), columns=list(PROFILE_COLUMNS))


def write_leak_csv(result: SealResult, path: Path) -> Path:
    """Write leak.csv, atomically."""
    return _write_csv(path, LEAK_COLUMNS, [tuple(row.values()) for row in leak_rows(result)])


def write_profile_csv(result: SealResult, path: Path) -> Path:
    """Write profile.csv, atomically."""
    return _write_csv(path, PROFILE_COLUMNS, profile_array(result).tolist())


def _write_csv(path: Path, columns: Sequence[str], rows: Sequence[Sequence[float]]) -> Path:
    # Ten digits: more than any of the numbers is good for, and the file stays readable.
    line = ",".join(["%.10g"] * len(columns)) + "\n"
    text = ",".join(columns) + "\n" + "".join(line % tuple(row) for row in rows)
    return write_bytes(path, text.encode("ascii"))


def _or_nan(value: float | None) -> float:
    return math.nan if value is None else value
