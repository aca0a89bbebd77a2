"""Designs of a study: an array with one row per design. Nothing is calculated here."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from fem_seal.arrays import FloatArray
from fem_seal.case.case import Case
from fem_seal.case.fields import Quantity, show
from fem_seal.case.notation import as_difference, said_twice
from fem_seal.case.paths import Entry, Value, entry_at, with_open_materials
from fem_seal.errors import InputError
from fem_seal.files import UnreadableFileError, read_text
from fem_seal.sampling import LogNormal, Normal
from fem_seal.studies.tables import MOST_POINTS, Design, Parameter

# Kinds whose designs are points for sensitivity indices.
SENSITIVITY = ("sobol-sensitivity", "morris")
# Levels of Morris's method, the usual choice.
MORRIS_LEVELS = 4
# Outermost levels of a distribution without ends: half of Morris's points lie on the outermost ones.
MORRIS_SHARES = (0.005, 0.995)


def points(design: Design, parameters: Sequence[Parameter]) -> FloatArray:
    """All designs, shape (designs, parameters), as the numbers of `Parameter.value`.

    Parameters
    ----------
    design : Design
        Any kind but "list", whose points come with its parameters.
    parameters : sequence of Parameter

    Raises
    ------
    InputError
        If a grid has too many points.
    """
    if design.kind == "grid":
        return _grid(parameters)
    unit = unit_points(design, len(parameters))
    return np.column_stack(
        [parameter.values(_shares(design, parameter, unit[:, n])) for n, parameter in enumerate(parameters)]
    )


def _shares(design: Design, parameter: Parameter, unit: FloatArray) -> FloatArray:
    """Shares of a distribution that coordinates of the unit cube stand for."""
    if design.kind == "morris" and isinstance(parameter.distribution, (Normal, LogNormal)):
        low, high = MORRIS_SHARES
        return low + (high - low) * unit
    return unit


def _grid(parameters: Sequence[Parameter]) -> FloatArray:
    count = int(np.prod([len(parameter.numbers) for parameter in parameters], dtype=object))
    if count > MOST_POINTS:
        raise InputError.at("design", f"has {count} designs; allowed are {MOST_POINTS}")
    axes = np.meshgrid(*(parameter.numbers for parameter in parameters), indexing="ij")
    return np.column_stack([axis.ravel() for axis in axes])


def unit_points(design: Design, dimensions: int) -> FloatArray:
    """Points of a sampled design in the unit cube, shape (designs, dimensions)."""
    from scipy.stats import qmc

    num = design.num or 0
    if design.kind == "latin-hypercube":
        return qmc.LatinHypercube(dimensions, rng=np.random.default_rng(design.seed)).random(num)
    if design.kind == "sobol":
        sampler = qmc.Sobol(dimensions, scramble=True, rng=np.random.default_rng(design.seed))
        # drawn as a whole power of two, of which the first are used: balance is lost only beyond the last one
        return sampler.random_base2(max(num - 1, 0).bit_length())[:num]
    cube = {"num_vars": dimensions, "names": [f"x{n}" for n in range(dimensions)]}
    problem = {**cube, "bounds": [[0.0, 1.0]] * dimensions}
    if design.kind == "morris":
        from SALib.sample import morris

        return np.asarray(morris.sample(problem, design.num, num_levels=MORRIS_LEVELS, seed=design.seed))
    from SALib.sample import sobol

    return np.asarray(
        sobol.sample(problem, design.num, calc_second_order=False, scramble=True, seed=design.seed)
    )


def read_list(path: Path, case: Case) -> tuple[Case, tuple[Parameter, ...], FloatArray]:
    """Parameters and designs of a CSV file, and the case that they are entries of.

    Parameters
    ----------
    path : Path
        The first row holds paths, with the unit of the numbers below in brackets: ``seat.angle [deg]``. Without one
        every cell has its own unit.
    case : Case
        Base of the study; materials of the library become tables where a part of them varies.

    Raises
    ------
    InputError
        It names row and column of what is wrong.
    """
    try:
        lines = io.StringIO(read_text(path))
        rows = [row for row in csv.reader(lines) if any(cell.strip() for cell in row)]
    except (UnreadableFileError, UnicodeDecodeError, csv.Error) as error:
        what = str(error) if isinstance(error, UnreadableFileError) else "cannot be read (no CSV file)"
        raise _file_error(path, what) from None
    if len(rows) < 2:
        raise _file_error(path, "has no designs; a heading and one row each")
    heading = [_heading(cell, path) for cell in rows[0]]
    paths = [name for name, _ in heading]
    duplicates = [name for n, name in enumerate(paths) if name in paths[:n]]
    if duplicates:
        raise _file_error(path, f"has two columns {duplicates[0]}; remove one")
    pair = said_twice(paths)
    if pair:
        raise _file_error(path, f"has columns {pair[0]} and {pair[1]}, two words for one entry; remove one")
    case = with_open_materials(case, paths)
    entries = [_entry(case, name, path) for name in paths]
    columns: list[list[Value]] = [[] for _ in entries]
    fluid = None if any(name.startswith("fluid.") for name in paths) else case.written.get("fluid")
    for number, row in enumerate(rows[1:], start=2):
        if len(row) != len(entries):
            raise _file_error(path, f"row {number} has {len(row)} cells, the heading {len(entries)}")
        for column, entry, (_, unit), cell in zip(columns, entries, heading, row, strict=True):
            try:
                value = as_difference(entry.path, _cell(cell.strip(), unit, entry.marker), fluid)
                column.append(entry.read(value))
            except InputError as error:
                raise _file_error(path, f"row {number}, {error.problems[0]}") from None
            except ValueError as error:
                place = f"row {number}, {entry.path} = {show(cell.strip())}"
                raise _file_error(path, f"{place}: {error}") from None
    parameters = tuple(
        Parameter(entry, tuple(dict.fromkeys(column))) for entry, column in zip(entries, columns, strict=True)
    )
    numbers = [
        column if parameter.numeric else [parameter.levels.index(value) for value in column]
        for parameter, column in zip(parameters, columns, strict=True)
    ]
    return case, parameters, np.array(numbers, dtype=float).T


def _file_error(path: Path, what: str) -> InputError:
    return InputError.at("design.file", what, show(path.name))


def _heading(cell: str, path: Path) -> tuple[str, str]:
    match = re.fullmatch(r"\s*([\w.]+)\s*(?:\[([^\]]*)\])?\s*", cell)
    if match is None:
        separator = re.search(r"[;\t]", cell)
        advice = "; separate the columns by commas" if separator else ", such as seat.angle [deg]"
        raise _file_error(path, f"has a heading {show(cell)} that is no path{advice}")
    return match[1], (match[2] or "").strip()


def _entry(case: Case, name: str, path: Path) -> Entry:
    try:
        return entry_at(case, name)
    except InputError as error:
        what = f"column {name}: {error.problems[0].message}"
        raise _file_error(path, what) from None


def _cell(text: str, unit: str, marker: object) -> object:
    if isinstance(marker, Quantity):
        return f"{text} {unit}" if unit else text
    if text in ("true", "false"):
        return text == "true"
    try:
        return float(text) if marker is not None else text
    except ValueError:
        return text
