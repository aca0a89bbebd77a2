"""VTK's XML files: unstructured grids (.vtu), lines and surfaces (.vtp) and time series (.pvd).

Numbers are appended as raw bytes, uncompressed: the mantissas of a computed field do not compress, and writing
them as they are takes no time. meshio, which reads these files, writes neither lines and surfaces nor field data.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from fem_seal.files import write_bytes, write_text

# VTK's number of the cells of a grid.
_QUADRATIC_TRIANGLE = 22

Arrays = Mapping[str, NDArray[np.generic]]


def write_cells(
    path: Path,
    kind: Literal["Cells", "Lines", "Polys"],
    points: NDArray[np.floating],
    connectivity: NDArray[np.integer],
    offsets: NDArray[np.integer],
    *,
    point_data: Arrays,
    field_data: Arrays,
    cell_data: Arrays | None = None,
) -> Path:
    """Write cells of one kind, replacing `path` in one step.

    Parameters
    ----------
    path : pathlib.Path
    kind : {"Cells", "Lines", "Polys"}
        Quadratic triangles of a grid (.vtu), or lines or polygons (.vtp).
    points : ndarray, shape (n, 3)
        [m]
    connectivity : ndarray of int
        Points of one cell after the other, in VTK's order.
    offsets : ndarray of int, shape (m,)
        Where each cell ends in `connectivity`.
    point_data, field_data, cell_data : mapping of str to ndarray
        Named arrays, shape (n,) or (n, components); six components are a symmetric tensor XX YY ZZ XY YZ XZ.
    """
    chunks: list[bytes] = []

    def section(name: str, arrays: Arrays) -> str:
        """Append the bytes of the arrays; return the section that lists them."""
        tags = []
        for array, values in arrays.items():
            data = values.tobytes()
            number = values.dtype.name.capitalize().replace("Uint", "UInt")
            # without the number of tuples a reader cannot tell the length of an array that belongs to no point
            tags.append(
                f'<DataArray type="{number}" Name={_quoted(array)} NumberOfTuples="{len(values)}" '
                f'NumberOfComponents="{values.shape[1] if values.ndim == 2 else 1}" '
                f'format="appended" offset="{sum(map(len, chunks))}"/>\n'
            )
            chunks.extend([len(data).to_bytes(8, sys.byteorder), data])
        return f"<{name}>\n{''.join(tags)}</{name}>\n"

    cells: dict[str, NDArray[np.generic]] = {
        "connectivity": connectivity.astype(np.int32),
        "offsets": offsets.astype(np.int32),
    }
    if kind == "Cells":
        cells["types"] = np.full(len(offsets), _QUADRATIC_TRIANGLE, dtype=np.uint8)
    piece = (
        section(kind, cells)
        + section("PointData", point_data)
        + section("CellData", cell_data or {})
        + section("Points", {"Points": points})
    )
    dataset = "UnstructuredGrid" if kind == "Cells" else "PolyData"
    head = (
        f"{_head(dataset)}<{dataset}>\n{section('FieldData', field_data)}"
        f'<Piece NumberOfPoints="{len(points)}" NumberOf{kind}="{len(offsets)}">\n{piece}</Piece>\n'
        f'</{dataset}>\n<AppendedData encoding="raw">\n_'
    )
    return write_bytes(path, [head.encode(), *chunks, b"\n</AppendedData>\n</VTKFile>\n"])


def write_series(path: Path, files: Sequence[str], times: Sequence[float]) -> Path:
    """Write a .pvd that lists one file per time, replacing `path` in one step."""
    entries = "".join(
        f'<DataSet timestep="{time:.12g}" group="" part="0" file={_quoted(file)}/>\n'
        for file, time in zip(files, times, strict=True)
    )
    return write_text(path, f"{_head('Collection')}<Collection>\n{entries}</Collection>\n</VTKFile>\n")


def _head(kind: str) -> str:
    order = f"{sys.byteorder.capitalize()}Endian"
    return (
        '<?xml version="1.0"?>\n'
        f'<VTKFile type="{kind}" version="1.0" byte_order="{order}" header_type="UInt64">\n'
    )


def _quoted(text: str) -> str:
    """An attribute's value in quotes."""
    return f'"{escape(text)}"'
