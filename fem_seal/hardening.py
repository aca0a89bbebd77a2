"""Isotropic hardening: the flow stress as a function of the plastic strain, from a stress-strain table."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fem_seal.errors import InputError, Problem

FloatArray = NDArray[np.float64]

# How far the first point of a table of total strain may lie from the elastic line, as a strain: what is lost when
# strains are written with four decimals.
_YIELD_POINT = 1e-4
# What no tensile test reaches: larger numbers are meant as per cent.
_LARGEST_STRAIN = 2.0


@dataclass(frozen=True)
class HardeningCurve:
    """Flow stress over accumulated plastic strain, linear between the points of a table.

    Beyond the last point the stress stays at its last value: what was not measured is not assumed to harden. One
    point alone is an elastic-perfectly plastic material.

    Parameters
    ----------
    plastic_strain : tuple of float
        Logarithmic (true) plastic strain [-], zero at first, increasing, at most 2.
    stress : tuple of float
        True stress in tension [Pa], positive, nowhere falling; the first is the yield stress.

    Raises
    ------
    InputError
        If the table is not such a curve; the message names the row.

    Examples
    --------
    >>> curve = HardeningCurve((0.0, 0.1), (250e6, 350e6))
    >>> float(curve.flow_stress(np.array(0.05))) / 1e6, curve.yield_stress / 1e6
    (300.0, 250.0)
    """

    plastic_strain: tuple[float, ...]
    stress: tuple[float, ...]

    def __post_init__(self) -> None:
        _check(_rows(self.plastic_strain, self.stress), self.plastic_strain)

    @classmethod
    def from_total_strain(
        cls, strain: Sequence[float], stress: Sequence[float], youngs_modulus: float
    ) -> HardeningCurve:
        """Curve of a table that holds the whole strain, elastic and plastic.

        Parameters
        ----------
        strain : sequence of float
            Logarithmic (true) strain [-]. A first row (0, 0) is left out; the next row is the yield point, where
            strain = stress/E to within 1e-4.
        stress : sequence of float
            True stress [Pa].
        youngs_modulus : float
            E [Pa].

        Raises
        ------
        InputError
            If the table does not begin at the yield point, or is no hardening curve.
        """
        table = _rows(strain, stress)
        rows = [row for row in table if (row.strain, row.stress) != (0, 0)] or table
        plastic = [row.strain - row.stress / youngs_modulus for row in rows]
        if not abs(plastic[0]) <= _YIELD_POINT:
            raise rows[0].wrong(
                f"this row must be the yield point, strain = stress/E = {rows[0].stress / youngs_modulus:.6g}; begin "
                f"the table with it, or check youngs_modulus = {youngs_modulus / 1e9:.6g} GPa"
            )
        plastic[0] = 0.0
        _check(rows, plastic)
        return cls(tuple(plastic), tuple(row.stress for row in rows))

    @property
    def yield_stress(self) -> float:
        """Stress at the onset of plastic flow [Pa]."""
        return self.stress[0]

    @property
    def last_strain(self) -> float:
        """Plastic strain up to which the table reaches [-]; infinite for perfect plasticity, which claims no more."""
        return self.plastic_strain[-1] if len(self.stress) > 1 else math.inf

    def flow_stress(self, plastic_strain: FloatArray) -> FloatArray:
        """Flow stress [Pa] at an accumulated plastic strain [-]."""
        return np.interp(plastic_strain, *self._points)

    def slope(self, plastic_strain: FloatArray) -> FloatArray:
        """Derivative of the flow stress [Pa], at a corner of the curve that towards larger strain."""
        strain, stress = self._points
        slopes = np.append(np.diff(stress) / np.diff(strain), 0.0)
        return slopes[np.searchsorted(strain, plastic_strain, side="right") - 1]

    def plastic_strain_at(self, trial: FloatArray, stiffness: float) -> FloatArray:
        """Plastic strain p at which flow stress(p) + `stiffness` p = `trial`, exact for the linear pieces.

        Parameters
        ----------
        trial : ndarray
            [Pa], not below the yield stress.
        stiffness : float
            Positive [Pa].
        """
        strain, stress = self._points
        rising = stress + stiffness * strain
        return np.interp(trial, rising, strain) + np.maximum(trial - rising[-1], 0.0) / stiffness

    @cached_property
    def _points(self) -> tuple[FloatArray, FloatArray]:
        return np.array(self.plastic_strain), np.array(self.stress)


class _Row(NamedTuple):
    """A row of a table as the user wrote it: its strain may be the whole one."""

    number: int
    strain: float
    stress: float

    def wrong(self, message: str) -> InputError:
        found = f"row {self.number} (strain {self.strain:.6g}, stress {self.stress / 1e6:.6g} MPa)"
        return InputError(Problem("stress_strain", f"{found}: {message}"))


def _rows(strain: Sequence[float], stress: Sequence[float]) -> list[_Row]:
    if len(strain) != len(stress) or not stress:
        raise InputError(
            Problem(
                "stress_strain",
                f"needs as many stresses as strains, at least one, and has {len(stress)} and {len(strain)}",
            )
        )
    return [_Row(n, *pair) for n, pair in enumerate(zip(strain, stress, strict=True), start=1)]


def _check(rows: Sequence[_Row], plastic_strain: Sequence[float]) -> None:
    """InputError if a row with this plastic strain does not belong into a hardening curve."""
    for row, plastic in zip(rows, plastic_strain, strict=True):
        if not (math.isfinite(plastic) and math.isfinite(row.stress) and row.stress > 0):
            raise row.wrong("strain and stress must be finite, the stress positive")
        if plastic > _LARGEST_STRAIN:
            raise row.wrong(
                f"strain is a number, 0.1 is 10 %; allowed is at most {_LARGEST_STRAIN:g} (a file may have a column "
                '"plastic_strain [%]")'
            )
    if plastic_strain and plastic_strain[0] != 0:
        raise rows[0].wrong("the first row is the yield point, its plastic strain must be 0")
    for n in range(1, len(rows)):
        if not plastic_strain[n] > plastic_strain[n - 1]:
            raise rows[n].wrong("the plastic strain must increase from row to row")
        if not rows[n].stress >= rows[n - 1].stress:
            raise rows[n].wrong(
                "the stress must not fall from row to row: a softening material has no unique solution"
            )
