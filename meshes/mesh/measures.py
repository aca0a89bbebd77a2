"""Area and shape of triangles."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from skfem import MeshTri

    from meshes.arrays import FloatArray


def triangle_shape(p: FloatArray, t: NDArray[np.int64]) -> FloatArray:
    """Return 2 r_in/r_circ of every triangle: 1 equilateral, 0 degenerate."""
    a, b, c = (np.hypot(*(p[:, t[i]] - p[:, t[j]])) for i, j in ((0, 1), (1, 2), (2, 0)))
    return (b + c - a) * (c + a - b) * (a + b - c) / (a * b * c)


def doubled_area(p: FloatArray, t: NDArray[np.int64]) -> FloatArray:
    """Twice the area of every triangle [m^2], negative where its vertices go round clockwise."""
    e, f = p[:, t[1]] - p[:, t[0]], p[:, t[2]] - p[:, t[0]]
    return e[0] * f[1] - e[1] * f[0]


def section_area(mesh: MeshTri) -> float:
    """Area of the meshed section [m^2]."""
    return float(0.5 * np.abs(doubled_area(mesh.p, mesh.t)).sum())
