"""Tables that a case file names: power spectra C(q) and stress-strain curves."""

from __future__ import annotations

from itertools import groupby
from operator import itemgetter
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from fem_seal.errors import TextTableError
from fem_seal.files import Names, TextTable, column, find_columns, read_text_table
from fem_seal.materials import celsius

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


_NAMES: Names = {
    "strain": ("strain", ("strain", "total_strain", "true_strain", "epsilon")),
    "plastic_strain": ("strain", ("plastic_strain", "true_plastic_strain", "epsilon_p", "ep")),
    "stress": ("pressure", ("stress", "true_stress", "flow_stress", "sigma")),
    "temperature": ("temperature", ("temperature", "t")),
}


class TensileTest(NamedTuple):
    """Strain and stress of a table.

    Parameters
    ----------
    kind : {"plastic_strain", "strain"}
    strain, stress : tuple of float
        [-], [Pa].
    temperature : float or None
        [K]; None where the table does not say.
    """

    kind: str
    strain: tuple[float, ...]
    stress: tuple[float, ...]
    temperature: float | None = None


def read_stress_strain(file: str | Path) -> list[TensileTest]:
    """Strain and stress of a table, or of the tables of several temperatures in one.

    Parameters
    ----------
    file : path
        Text with a header and the columns ``plastic_strain`` or ``strain`` (elastic and plastic together), true, as
        numbers or in ``[%]``, and ``stress_MPa``, true. A column ``temperature_degC`` says to which of several curves,
        one below the other, a row belongs.

    Returns
    -------
    list of TensileTest
        One, or one for each temperature in the order of the file.

    Raises
    ------
    TextTableError
        If the file is not such a table; the message names it.
    """
    try:
        return _read(read_text_table(file))
    except TextTableError as error:
        raise TextTableError(f"{file} {error}") from None


def _read(table: TextTable) -> list[TensileTest]:
    places = find_columns(table, _NAMES, 'such as "plastic_strain, stress_MPa"')
    kinds = [kind for kind in ("plastic_strain", "strain") if kind in places]
    if len(kinds) != 1 or "stress" not in places:
        raise TextTableError(
            "must have a column stress with its unit and either a column plastic_strain or a column strain; its "
            f"columns are {', '.join(table.header)}"
        )

    def read(role: str) -> list[float]:
        found: list[float] = column(table, places[role], _NAMES[role][0]).tolist()
        return found

    strain, stress = read(kinds[0]), read("stress")
    if "temperature" not in places:
        return [TensileTest(kinds[0], tuple(strain), tuple(stress))]
    rows = zip(read("temperature"), strain, stress, strict=True)
    tests: list[TensileTest] = []
    for temperature, group in groupby(rows, key=itemgetter(0)):
        _, strains, stresses = zip(*group, strict=True)
        if any(one.temperature == temperature for one in tests):
            raise TextTableError(
                f"the rows of {celsius(temperature)} do not stand together; write one curve below the other"
            )
        tests.append(TensileTest(kinds[0], strains, stresses, temperature))
    return tests
