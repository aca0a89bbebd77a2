"""Draws that a leak test has left, as a table: `[uncertainty] posterior` takes them in place of random numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from fem_seal.arrays import FloatArray
from fem_seal.errors import InputError, TextTableError
from fem_seal.files import problem, read_text_table, write_text
from leak import error_correlation

_THEORY = "theory at {:.6e} Pa"
# Of the correlation of errors at two pressures that are nearly the same.
_NUGGET = 1e-6


@dataclass(frozen=True)
class Posterior:
    """Draws that are alike likely, n of them.

    Parameters
    ----------
    uniform : mapping of ndarray, shape (n,)
        Number between 0 and 1 of each dimension of each input, as `columns_of` names them.
    peaks : ndarray, shape (k,)
        Decimal logarithms of peak pressures [Pa].
    error : ndarray, shape (n, k)
        The theory's own error there, in standard deviations.
    """

    uniform: Mapping[str, FloatArray]
    peaks: FloatArray = field(default_factory=lambda: np.empty(0))
    error: FloatArray = field(default_factory=lambda: np.empty((0, 0)))

    def write(self, path: Path) -> Path:
        """Write the draws, one in a row.

        Parameters
        ----------
        path : Path
        """
        columns = {
            **self.uniform,
            **{_THEORY.format(10.0**x): e for x, e in zip(self.peaks, self.error.T, strict=True)},
        }
        rows = np.column_stack(list(columns.values())) if columns else np.empty((0, 0))
        lines = [",".join(columns), *(",".join(f"{value:.9g}" for value in row) for row in rows.tolist())]
        return write_text(path, "\n".join(lines) + "\n")

    @classmethod
    def read(cls, path: str | Path) -> Posterior:
        """Draws of a file.

        Raises
        ------
        InputError
            If it is no such file.
        """
        try:
            table = read_text_table(path)
        except TextTableError as error:
            raise InputError.at("uncertainty.posterior", str(error), f'"{path}"') from None
        if len(table.header) != table.values.shape[1]:
            raise InputError(problem("posterior_header", file=path))
        columns = dict(zip(table.header, table.values.T, strict=True))
        theory = {name: col for name, col in columns.items() if name.startswith("theory at ")}
        uniform = {name: np.clip(col, 1e-9, 1 - 1e-9) for name, col in columns.items() if name not in theory}
        peaks = np.log10([float(name.split()[2]) for name in theory])
        return cls(
            uniform,
            peaks,
            np.column_stack(list(theory.values())) if theory else np.empty((len(table.values), 0)),
        )

    def of_inputs(self, columns: Sequence[str]) -> FloatArray:
        """Numbers of some columns, shape (n, columns).

        Raises
        ------
        InputError
            If one is not there.
        """
        for name in columns:
            if name not in self.uniform:
                raise InputError(
                    problem("posterior_input", name=name, known=", ".join(self.uniform) or "none")
                )
        return np.column_stack([np.empty((len(self.error), 0)), *(self.uniform[name] for name in columns)])

    def error_at(self, peaks: FloatArray, seed: int) -> FloatArray:
        """The theory's own error at other peak pressures, in standard deviations, shape (pressures, n).

        It has the correlation of `leak.error_correlation` with that at the known ones; the rest is random.

        Parameters
        ----------
        peaks : ndarray
            Decimal logarithms [Pa].
        seed : int
        """
        random = np.random.default_rng(seed).standard_normal((peaks.size, len(self.error)))
        if not self.peaks.size:
            return random
        correlation = error_correlation(self.peaks) + _NUGGET * np.eye(self.peaks.size)
        share = np.linalg.solve(correlation, error_correlation(self.peaks, peaks))
        variance = 1.0 - np.einsum("ij,ij->j", share, error_correlation(self.peaks, peaks))
        return np.asarray((self.error @ share).T + np.sqrt(np.maximum(variance, 0.0))[:, None] * random)


def columns_of(name: str, dimensions: int) -> list[str]:
    """Columns of an input that takes so many random numbers.

    Examples
    --------
    >>> columns_of("hardness", 1), columns_of("spectrum", 2)
    (['hardness'], ['spectrum.0', 'spectrum.1'])
    """
    return [name] if dimensions == 1 else [f"{name}.{n}" for n in range(dimensions)]
