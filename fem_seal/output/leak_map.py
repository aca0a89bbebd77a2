"""The leak over pressure and force as files: CSV, a text file of Modelica tables, a script of MATLAB matrices."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fem_seal.files import write_text
from fem_seal.output.tables import write_rows
from fem_seal.units import Display
from fem_seal.version import __version__
from fem_seal.wording import say

if TYPE_CHECKING:
    from fem_seal.answers.leak_map import LeakMap
    from fem_seal.arrays import FloatArray

CSV, MODELICA, MATLAB = "table.csv", "modelica_tables.txt", "leak_tables.m"


def map_rows(leaks: LeakMap) -> list[dict[str, Any]]:
    """One row per pressure and force, SI; NaN where nothing was calculated.

    Parameters
    ----------
    leaks : LeakMap
    """
    area, mass = leaks.leakage_area, leaks.mass_flow
    per_leak = leaks.area_of_leak_rate
    rows = []
    for n, force in enumerate(leaks.applied_force.tolist()):
        for m, pressure in enumerate(leaks.fluid_pressure.tolist()):
            validity = leaks.validity[m][n]
            low, high = float(leaks.leak_rate_low[m, n]), float(leaks.leak_rate_high[m, n])
            rows.append(
                {
                    "fluid_pressure_Pa": pressure,
                    "applied_force_N": force,
                    "leak_rate_m3_per_s": float(leaks.leak_rate[m, n]),
                    "leak_rate_low_m3_per_s": low,
                    "leak_rate_high_m3_per_s": high,
                    "leak_rate_kg_per_s": float(mass[m, n]),
                    "leakage_area_m2": float(area[m, n]),
                    "leakage_area_low_m2": low * float(per_leak[m]),
                    "leakage_area_high_m2": high * float(per_leak[m]),
                    "validity": leaks.level[m][n],
                    "validity_reasons": [] if validity is None else list(validity.reasons_in(leaks.display)),
                }
            )
    return rows


def write_map(leaks: LeakMap, folder: Path) -> None:
    """Write `CSV` with all points, `MODELICA` and `MATLAB` with the largest part without gaps.

    Parameters
    ----------
    leaks : LeakMap
    folder : pathlib.Path
    """
    write_rows(folder / CSV, map_rows(leaks))
    whole = leaks.complete
    write_text(folder / MODELICA, modelica_text(whole))
    write_text(folder / MATLAB, matlab_text(whole))


def tables_of(leaks: LeakMap) -> dict[str, FloatArray]:
    """Names and values of the tables for system simulation, shape (m, n); areas only where they are known.

    A gas is given by its mass flow, a liquid by its volume flow.

    Parameters
    ----------
    leaks : LeakMap
        Without gaps.
    """
    factor = (leaks.density or 1.0) if leaks.is_gas else 1.0
    name = "mass_flow" if leaks.is_gas else "leak_rate"
    ends = {"": leaks.leak_rate, "_low": leaks.leak_rate_low, "_high": leaks.leak_rate_high}
    tables = {f"{name}{end}": rate * factor for end, rate in ends.items()}
    if not np.isnan(leaks.area_of_leak_rate).any():
        per_leak = leaks.area_of_leak_rate[:, None]
        tables |= {f"leakage_area{end}": rate * per_leak for end, rate in ends.items()}
    return tables


def _with_zero(pressure: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Pressures and values with an added row for zero pressure difference, at which nothing leaks."""
    return np.append(0.0, pressure), np.vstack([np.zeros(values.shape[1]), values])


def modelica_text(leaks: LeakMap) -> str:
    """Text file for Modelica.Blocks.Tables.CombiTable2Ds: fluid pressure [Pa] is u1, force [N] is u2.

    Parameters
    ----------
    leaks : LeakMap
        Without gaps.
    """
    lines = ["#1", *(f"# {line}" for line in _about(leaks))]
    for name, values in tables_of(leaks).items():
        pressure, rows = _with_zero(leaks.fluid_pressure, values)
        lines.append(f"double {name}({len(pressure) + 1},{len(leaks.applied_force) + 1}) # {_unit(name)}")
        lines.append(_numbers([0.0, *leaks.applied_force.tolist()]))
        lines += [_numbers([p, *row]) for p, row in zip(pressure.tolist(), rows.tolist(), strict=True)]
    return "\n".join(lines) + "\n"


def matlab_text(leaks: LeakMap) -> str:
    """Script with a struct of grid vectors and matrices for Simscape and Simulink lookup tables.

    Parameters
    ----------
    leaks : LeakMap
        Without gaps.
    """
    lines = [f"% {line}" for line in _about(leaks)]
    pressure, _ = _with_zero(leaks.fluid_pressure, leaks.leak_rate)
    lines.append(f"leak_tables.fluid_pressure = [{_numbers(pressure.tolist())}]; % Pa")
    lines.append(f"leak_tables.applied_force = [{_numbers(leaks.applied_force.tolist())}]; % N")
    tables = {**tables_of(leaks), "valid": leaks.valid}
    for name, values in tables.items():
        # at zero pressure as valid as at the lowest pressure
        rows = (
            np.vstack([values[:1], values])
            if name == "valid"
            else _with_zero(leaks.fluid_pressure, values)[1]
        )
        text = "; ...\n  ".join(_numbers(row) for row in rows.tolist())
        lines.append(f"leak_tables.{name} = [ ...\n  {text}]; % {_unit(name)}")
    return "\n".join(lines) + "\n"


def _about(leaks: LeakMap) -> Iterator[str]:
    # a line break in a title would end the comment
    yield " ".join(f"{leaks.title or 'seal'}, {leaks.fluid}; fem-seal {__version__}".split())
    for key in ("grid", "gas" if leaks.is_gas else "liquid", "ends"):
        yield say(Display(), "leak_map", f"files_{key}")
    worst = sorted({word for row in leaks.level for word in row} - {"valid"})
    if worst:
        yield say(Display(), "leak_map", "files_validity", levels=" and ".join(worst))


def _unit(name: str) -> str:
    if name == "valid":
        return "1 valid, 0 doubtful, -1 outside the theory"
    return {"mass_flow": "kg/s", "leak_rate": "m^3/s", "leakage_area": "m^2"}[
        name.removesuffix("_low").removesuffix("_high")
    ]


def _numbers(values: list[float]) -> str:
    return " ".join(f"{value:.10g}" for value in values)
