"""Upper bound on the stress of a body under a contact pressure, at a hundredth of the cost of its field."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fem_seal.arrays import FloatArray
from fem_seal.bodies.constrained_body import CondensedBody, LoadName
from fem_seal.bodies.fields import von_mises

# Points of the contact line to one spline: three points lie in an element, ten elements in the narrowest contact.
_POINTS_PER_PATTERN, _FEWEST = 8, 8
# A pressure on a half-plane that is nowhere above e makes a von Mises stress of at most 2.3 e: each of the stresses in
# its plane is (2/pi) int p cos^2, cos sin or sin^2 over the angle under which it is seen. That of what the splines
# leave, which turns its sign from point to point, is far smaller, also in bodies that bend.
_OF_THE_REST = 5.0


@dataclass(frozen=True)
class StressBound:
    """Stress of a body under smooth pressures on its contact line; see `StressBound.of`.

    Parameters
    ----------
    patterns : ndarray, shape (m, k)
        Splines over the points of the contact line.
    fit : ndarray, shape (k, m)
        From a pressure at the points to that of each spline in it.
    stress : ndarray, shape (4, nodes, k)
        Stress under a spline of 1 Pa [-].
    further : mapping of ndarray, shape (4, nodes)
        Stress under each of the body's `CondensedBody.loads` that leaves the body cold [Pa per unit].
    alone : ndarray, shape (k,)
        Largest von Mises stress under each spline of 1 Pa [-].
    """

    patterns: FloatArray
    fit: FloatArray
    stress: NDArray[np.float32]
    further: Mapping[LoadName, FloatArray]
    alone: FloatArray

    @classmethod
    def of(cls, body: CondensedBody, area_weight: FloatArray) -> StressBound:
        """Stress of a body under each spline; takes as long as the fields of some twenty loads.

        Parameters
        ----------
        area_weight : ndarray, shape (m,)
            Area that each point of the contact line stands for [m^2].
        """
        from scipy.interpolate import BSpline

        count = len(area_weight)
        inner = np.linspace(0.0, 1.0, max(count // _POINTS_PER_PATTERN, _FEWEST))
        knots = np.concatenate([[0.0] * 3, inner, [1.0] * 3])
        patterns = BSpline.design_matrix(np.linspace(0.0, 1.0, count), knots, 3).toarray()
        assert body.solve is not None  # of a model that knows more than its contact line
        # that a floating body also moves along its axis makes no stress
        forces = [body.fem.nodal_forces(area_weight * pattern) for pattern in patterns.T]
        stress = body.recovery.stress(body.solve(np.column_stack(forces)))
        further = {
            name: body.recovery.stress(load.response).T
            for name, load in body.loads.items()
            if not np.any(load.free_strain)
        }
        return cls(
            patterns,
            np.asarray(np.linalg.pinv(patterns), dtype=float),
            np.ascontiguousarray(stress.transpose(1, 0, 2), dtype=np.float32),
            further,
            von_mises(np.moveaxis(stress, 1, -1)).max(axis=0),
        )

    def stays_below(self, stress: float, pressure: FloatArray, magnitudes: Mapping[LoadName, float]) -> bool:
        """Whether it is certain that no von Mises stress is above a value [Pa].

        Parameters
        ----------
        stress : float
            [Pa]
        pressure, magnitudes
            See `highest_von_mises`.
        """
        if not magnitudes:
            # the stress of a sum is at most the sum of the stresses: mostly that is enough
            shares, remainder = self._shares(pressure)
            if float(np.abs(shares) @ self.alone) + _OF_THE_REST * remainder < stress:
                return True
        return stress > self.highest_von_mises(pressure, magnitudes)

    def _shares(self, pressure: FloatArray) -> tuple[FloatArray, float]:
        """Pressure of each spline, and the largest that they leave [Pa]."""
        shares = self.fit @ pressure
        return shares, float(np.abs(pressure - self.patterns @ shares).max())

    def highest_von_mises(self, pressure: FloatArray, magnitudes: Mapping[LoadName, float]) -> float:
        """The von Mises stress is nowhere higher than this [Pa]; infinite where that takes a field.

        Parameters
        ----------
        pressure : ndarray, shape (m,)
            All that presses on the contact line [Pa].
        magnitudes : mapping
            Of the body's further loads, see `fem_seal.contact.model.BodyLoads`.
        """
        if not magnitudes.keys() <= self.further.keys():
            return np.inf
        shares, remainder = self._shares(pressure)
        stress = np.asarray(self.stress @ shares.astype(np.float32), dtype=float)
        for name, size in magnitudes.items():
            stress += size * self.further[name]
        return float(von_mises(stress.T).max()) + _OF_THE_REST * remainder
