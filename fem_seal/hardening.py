"""Isotropic hardening: the flow stress as a function of the plastic strain, from a stress-strain table."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from fem_seal.errors import InputError, Problem

FloatArray = NDArray[np.float64]

# How far the first point of a table of total strain may lie from the elastic line, as a strain: what is lost when
# strains are written with four decimals.
_YIELD_POINT = 1e-4


@dataclass(frozen=True)
class HardeningCurve:
    """Flow stress over accumulated plastic strain, linear between the points of a table.

    Beyond the last point the stress stays at its last value: what was not measured is not assumed to harden. One
    point alone is an elastic-perfectly plastic material.

    Parameters
    ----------
    plastic_strain : tuple of float
        Logarithmic (true) plastic strain [-], zero at first, increasing.
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
        for number, (strain, stress) in enumerate(_rows(self.plastic_strain, self.stress), start=1):
            if not (math.isfinite(strain) and math.isfinite(stress) and stress > 0):
                raise _wrong(number, strain, stress, "strain and stress must be finite, the stress positive")
            if number == 1 and strain != 0:
                raise _wrong(
                    number, strain, stress, "the first row is the yield point, its plastic strain must be 0"
                )
            if number > 1 and not strain > self.plastic_strain[number - 2]:
                raise _wrong(number, strain, stress, "the plastic strain must increase from row to row")
            if number > 1 and not stress >= self.stress[number - 2]:
                raise _wrong(
                    number,
                    strain,
                    stress,
                    "the stress must not fall from row to row: a softening material has no unique solution",
                )

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
        rows = [(e, s) for e, s in _rows(strain, stress) if (e, s) != (0, 0)]
        plastic = [e - s / youngs_modulus for e, s in rows]
        if plastic and not abs(plastic[0]) <= _YIELD_POINT:
            yield_strain = rows[0][1] / youngs_modulus
            raise _wrong(
                1,
                *rows[0],
                f"the first row must be the yield point, strain = stress/E = {yield_strain:.6g}; begin the table with "
                f"it, or check youngs_modulus = {youngs_modulus / 1e9:.6g} GPa",
            )
        return cls((0.0, *plastic[1:]), tuple(s for _, s in rows))

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


def _rows(strain: Sequence[float], stress: Sequence[float]) -> list[tuple[float, float]]:
    if len(strain) != len(stress) or not stress:
        raise InputError(
            Problem(
                "stress_strain",
                f"needs as many stresses as strains, at least one, and has {len(stress)} and {len(strain)}",
            )
        )
    return list(zip(strain, stress, strict=True))


def _wrong(row: int, strain: float, stress: float, message: str) -> InputError:
    return InputError(
        Problem("stress_strain", f"row {row} (strain {strain:.6g}, stress {stress / 1e6:.6g} MPa): {message}")
    )
