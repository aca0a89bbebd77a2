"""Tables of a power spectrum, C(q), from a text file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from fem_seal.text_table import TextTableError, read_text_table

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


def read_spectrum(file: str | Path) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Wavenumber and density of a tabulated two-dimensional isotropic spectrum.

    Parameters
    ----------
    file : path
        Text with two columns, q [1/m] and C [m^4]; see `read_text_table`.

    Returns
    -------
    q, C : ndarray, shape (n,)
        Wavenumber [1/m], increasing, and density [m^4], positive.

    Raises
    ------
    TextTableError
        If the file is not such a table.
    """
    import numpy as np

    table = read_text_table(file)
    if table.values.shape[1] != 2 or table.values.shape[0] < 2:
        raise TextTableError("must hold two columns, q [1/m] and C [m^4], and at least two rows")
    q, C = table.values.T
    positive = (q > 0) & (C > 0)
    if not positive.all():
        raise TextTableError(f"q and C must be positive; line {table.lines[int(np.argmin(positive))]} is not")
    increasing = np.diff(q) > 0
    if not increasing.all():
        line = table.lines[int(np.argmin(increasing)) + 1]
        raise TextTableError(f"q must increase from row to row; line {line} does not")
    return q, C
