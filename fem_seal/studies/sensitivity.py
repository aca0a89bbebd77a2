"""Which parameters matter: Sobol' indices and Morris's elementary effects, where the design allows them (SALib)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fem_seal.studies.designs import MORRIS_LEVELS, SENSITIVITY, unit_points
from fem_seal.studies.study_tables import Design

if TYPE_CHECKING:
    from fem_seal.studies.analysis import Designs

FloatArray = NDArray[np.float64]

# Indices that differ by less, relative to the largest, are equal.
_ROUND_OFF = 1e-9


@dataclass(frozen=True)
class Sensitivity:
    """Influence of each parameter on one output.

    Parameters
    ----------
    output : str
    logarithmic : bool
        Whether the logarithm of the output was analysed, as of every output that is positive and spans a factor of ten.
    method : {"sobol-sensitivity", "morris"}
    parameters : tuple of str
    first, total : ndarray
        Sobol': first-order and total index. Morris: mean of the absolute effects and their standard deviation, in
        units of the (logarithm of the) output.
    first_error, total_error : ndarray
        Half widths of the 95 % confidence intervals; zero for the standard deviation of the effects.
    """

    output: str
    logarithmic: bool
    method: str
    parameters: tuple[str, ...]
    first: FloatArray
    total: FloatArray
    first_error: FloatArray
    total_error: FloatArray

    @property
    def noise(self) -> NDArray[np.bool_]:
        """Which first-order Sobol' indices are noise of the sample: above the total one, or below zero."""
        if self.method == "morris":
            return np.zeros(len(self.first), dtype=bool)
        round_off = _ROUND_OFF * self.total.max()
        return (self.first > self.total + round_off) | (self.first < -round_off)


def sensitivities(designs: Designs) -> list[Sensitivity]:
    """Sensitivity of every output; empty unless the design was made for it and all of its designs are done.

    Parameters
    ----------
    designs : Designs

    References
    ----------
    A. Saltelli et al., Comput. Phys. Commun. 181, 259 (2010); M. D. Morris, Technometrics 33, 161 (1991); J. Herman,
    W. Usher, J. Open Source Softw. 2, 97 (2017).
    """
    about = designs.about
    if about["design"]["kind"] not in SENSITIVITY or about["design"]["optimise"]:
        return []
    names = tuple(one["name"] for one in about["parameters"])
    design = Design(**{key: value for key, value in about["design"].items() if key != "optimise"})
    unit = unit_points(design, len(names))
    table = designs.table
    if len(table) != len(unit) or not (table["status"] == "done").all():
        return []
    found = []
    for output in designs.outputs:
        values = table[output].to_numpy(dtype=float)
        if np.all(np.isfinite(values)) and np.ptp(values) > 0:
            found.append(_sensitivity(design, names, unit, output, values))
    return found


def _sensitivity(
    design: Design, names: tuple[str, ...], unit: FloatArray, output: str, values: FloatArray
) -> Sensitivity:
    logarithmic = bool(np.all(values > 0) and values.max() > 10 * values.min())
    y = np.log(values) if logarithmic else values
    problem = {"num_vars": len(names), "names": list(names), "bounds": [[0.0, 1.0]] * len(names)}
    analyse = _morris if design.kind == "morris" else _sobol
    return Sensitivity(output, logarithmic, design.kind, names, *analyse(problem, unit, y, design.seed))


def _sobol(
    problem: Mapping[str, Any], unit: FloatArray, y: FloatArray, seed: int
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    from SALib.analyze import sobol

    found = sobol.analyze(problem, (y - y.mean()) / y.std(), calc_second_order=False, seed=seed)
    return found["S1"], found["ST"], found["S1_conf"], found["ST_conf"]


def _morris(
    problem: Mapping[str, Any], unit: FloatArray, y: FloatArray, seed: int
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    from SALib.analyze import morris

    found = morris.analyze(problem, unit, y, num_levels=MORRIS_LEVELS, seed=seed)
    sigma = np.asarray(found["sigma"])
    return np.asarray(found["mu_star"]), sigma, np.asarray(found["mu_star_conf"]), np.zeros(len(sigma))
