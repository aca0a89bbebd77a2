"""VTK's XML files: unstructured grids (.vtu), lines and surfaces (.vtp) and time series (.pvd).

Numbers are appended as raw bytes, uncompressed: the mantissas of a computed field do not compress, and writing
them as they are takes no time. A writer of our own because importing a library for it takes longer than the
whole export.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fem_seal.files import write_bytes, write_text

QUADRATIC_TRIANGLE = 22

Arrays = Mapping[str, NDArray[np.generic]]

_VTK_TYPES = {"f8": "Float64", "f4": "Float32", "i8": "Int64", "i4": "Int32", "u1": "UInt8"}
_BYTE_ORDER = {"little": "LittleEndian", "big": "BigEndian"}[sys.byteorder]


def write_grid(
    path: Path,
    points: NDArray[np.float64],
    cells: NDArray[np.int64],
    cell_type: int,
    *,
    point_data: Arrays,
    cell_data: Arrays,
    field_data: Arrays,
) -> Path:
    """Write an unstructured grid of one cell type as .vtu, replacing `path` in one step.

    Parameters
    ----------
    path : pathlib.Path
    points : ndarray, shape (n, 3)
        [m]
    cells : ndarray of int, shape (m, k)
        Points of each cell, in VTK's order.
    cell_type : int
        VTK's number of the cell type.
    point_data, cell_data, field_data : mapping of str to ndarray
        Named arrays, shape (n,) or (n, components); six components are a symmetric tensor XX YY ZZ XY YZ XZ.
    """
    m, k = cells.shape
    block = _Appended()
    topology = (
        block.array("connectivity", cells.astype(np.int32).ravel())
        + block.array("offsets", np.arange(k, (m + 1) * k, k, dtype=np.int32))
        + block.array("types", np.full(m, cell_type, dtype=np.uint8))
    )
    piece = (
        f'<Piece NumberOfPoints="{len(points)}" NumberOfCells="{m}">\n'
        + block.section("PointData", point_data)
        + block.section("CellData", cell_data)
        + f"<Points>\n{block.array('Points', points)}</Points>\n"
        + f"<Cells>\n{topology}</Cells>\n</Piece>\n"
    )
    return _write(path, "UnstructuredGrid", block.section("FieldData", field_data) + piece, block)


def write_lines(
    path: Path,
    points: NDArray[np.float64],
    parts: Sequence[int],
    *,
    point_data: Arrays,
    field_data: Arrays,
) -> Path:
    """Write lines through `points`, shape (n, 3) [m], as many in each as `parts` says, as .vtp, in one step."""
    n = len(points)
    block = _Appended()
    topology = block.array("connectivity", np.arange(n, dtype=np.int32)) + block.array(
        "offsets", np.cumsum(parts, dtype=np.int32)
    )
    piece = (
        f'<Piece NumberOfPoints="{n}" NumberOfVerts="0" NumberOfLines="{len(parts)}" NumberOfStrips="0" '
        'NumberOfPolys="0">\n'
        + block.section("PointData", point_data)
        + f"<Points>\n{block.array('Points', points)}</Points>\n"
        + f"<Lines>\n{topology}</Lines>\n</Piece>\n"
    )
    return _write(path, "PolyData", block.section("FieldData", field_data) + piece, block)


def write_surface(
    path: Path,
    points: NDArray[np.floating],
    quads: NDArray[np.int64],
    *,
    point_data: Arrays,
    field_data: Arrays,
) -> Path:
    """Write a surface of quadrilaterals as .vtp, replacing `path` in one step.

    Parameters
    ----------
    path : pathlib.Path
    points : ndarray, shape (n, 3)
        [m]
    quads : ndarray of int, shape (m, 4)
        Points of each, one after the other around it.
    point_data, field_data : mapping of str to ndarray
    """
    m = len(quads)
    block = _Appended()
    topology = block.array("connectivity", quads.astype(np.int32).ravel()) + block.array(
        "offsets", np.arange(4, 4 * m + 4, 4, dtype=np.int32)
    )
    piece = (
        f'<Piece NumberOfPoints="{len(points)}" NumberOfVerts="0" NumberOfLines="0" NumberOfStrips="0" '
        f'NumberOfPolys="{m}">\n'
        + block.section("PointData", point_data)
        + f"<Points>\n{block.array('Points', points)}</Points>\n"
        + f"<Polys>\n{topology}</Polys>\n</Piece>\n"
    )
    return _write(path, "PolyData", block.section("FieldData", field_data) + piece, block)


def write_series(path: Path, files: Sequence[str], times: Sequence[float]) -> Path:
    """Write a .pvd that lists one file per time, replacing `path` in one step."""
    entries = "".join(
        f'<DataSet timestep="{time:.12g}" group="" part="0" file={_quoted(file)}/>\n'
        for file, time in zip(files, times, strict=True)
    )
    return write_text(path, f"{_head('Collection', '0.1')}<Collection>\n{entries}</Collection>\n</VTKFile>\n")


class _Appended:
    """The data block at the end of a file, and the tags that point into it."""

    def __init__(self) -> None:
        self.chunks: list[bytes] = []
        self._offset = 0

    def array(self, name: str, values: NDArray[np.generic]) -> str:
        """Append one array; return its tag."""
        values = np.ascontiguousarray(values)
        components = values.shape[1] if values.ndim == 2 else 1
        kind = _VTK_TYPES[f"{values.dtype.kind}{values.dtype.itemsize}"]
        tag = (
            f'<DataArray type="{kind}" Name={_quoted(name)} NumberOfComponents="{components}" '
            f'format="appended" offset="{self._offset}"/>\n'
        )
        data = values.tobytes()
        self.chunks += [len(data).to_bytes(8, sys.byteorder), data]
        self._offset += 8 + len(data)
        return tag

    def section(self, kind: str, arrays: Arrays) -> str:
        """Append named arrays; return the section that lists them."""
        return f"<{kind}>\n{''.join(self._tag(kind, name, values) for name, values in arrays.items())}</{kind}>\n"

    def _tag(self, kind: str, name: str, values: NDArray[np.generic]) -> str:
        if kind != "FieldData":
            return self.array(name, values)
        # Without the number of tuples a reader cannot tell the length of an array that belongs to no point.
        return self.array(name, values).replace(
            "<DataArray ", f'<DataArray NumberOfTuples="{len(values)}" ', 1
        )


def _head(kind: str, version: str = "1.0") -> str:
    header = "" if kind == "Collection" else ' header_type="UInt64"'
    return (
        '<?xml version="1.0"?>\n'
        f'<VTKFile type="{kind}" version="{version}" byte_order="{_BYTE_ORDER}"{header}>\n'
    )


def _write(path: Path, kind: str, content: str, block: _Appended) -> Path:
    head = f'{_head(kind)}<{kind}>\n{content}</{kind}>\n<AppendedData encoding="raw">\n_'
    return write_bytes(path, [head.encode(), *block.chunks, b"\n</AppendedData>\n</VTKFile>\n"])


def _quoted(text: str) -> str:
    """An attribute's value in quotes."""
    return f'"{escape(text)}"'
