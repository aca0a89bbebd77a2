"""Leak rate and equivalent leakage area over fluid pressure and force, for the simulation of a system."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from fem_seal.answers.chain import solve
from fem_seal.answers.solution import SealSolution
from fem_seal.arrays import FloatArray
from fem_seal.case.case import Case, CaseSource, case_of
from fem_seal.case.checks import check_formed
from fem_seal.case.tables import curves
from fem_seal.errors import InputError
from fem_seal.files import problem
from fem_seal.seal.findings import Level, Validity, caution
from fem_seal.seal.load_solver import Progress
from fem_seal.units import Display
from fem_seal.wording import Quantity

# Pressures of a table where the case itself has fewer, and over which range below its highest.
_PRESSURES, _FEWEST_PRESSURES, _RANGE = 8, 3, 20.0
_MOST_POINTS = 2000


@dataclass(frozen=True)
class LeakMap:
    """Leak of a seal over fluid pressure (rows) and force of spring or actuator (columns).

    Parameters
    ----------
    title, fluid : str
        Of the case, and of its fluid.
    is_gas : bool
        The volume of a gas is that at 101325 Pa and its temperature.
    fluid_pressure : ndarray
        Pressure difference, shape (m,) [Pa].
    applied_force : ndarray
        Shape (n,) [N].
    leak_rate, leak_rate_low, leak_rate_high : ndarray
        Volume, and the ends of its interval; the leak rate itself where there is none; NaN where nothing was
        calculated. Shape (m, n) [m^3/s].
    density : float or None
        That turns volume into mass [kg/m^3]; None if unknown.
    area_of_leak_rate : ndarray
        Equivalent leakage area over leak rate, NaN if unknown, shape (m,) [s/m].
    validity : tuple of tuple of Validity or None
        None where nothing was calculated.
    display : Display
        Of the case.
    reasons : tuple of str
        Warnings of the run: why loads have no result, and what is doubtful.

    Examples
    --------
    >>> import fem_seal
    >>> case = fem_seal.load_case("examples/ball_cone.toml")
    >>> found = fem_seal.leak_map(case, [20e5], [500.0])
    >>> found.level, f"{float(found.leakage_area[0, 0]) * 1e6:.4f} mm^2"
    ([['valid']], '0.0046 mm^2')
    """

    title: str
    fluid: str
    is_gas: bool
    fluid_pressure: FloatArray
    applied_force: FloatArray
    leak_rate: FloatArray
    leak_rate_low: FloatArray
    leak_rate_high: FloatArray
    density: float | None
    area_of_leak_rate: FloatArray
    validity: tuple[tuple[Validity | None, ...], ...]
    reasons: tuple[str, ...] = ()
    display: Display = field(default_factory=Display)

    @property
    def mass_flow(self) -> FloatArray:
        """Shape (m, n) [kg/s]; NaN if the density is unknown."""
        return self.leak_rate * (math.nan if self.density is None else self.density)

    @property
    def leakage_area(self) -> FloatArray:
        """Area of the orifice without losses that leaks as much, shape (m, n) [m^2]; guide/table in the manual."""
        return self.leak_rate * self.area_of_leak_rate[:, None]

    @property
    def level(self) -> list[list[str]]:
        """Validity in words, "not calculated" where there is none."""
        return [["not calculated" if x is None else str(x.level) for x in row] for row in self.validity]

    @property
    def complete(self) -> LeakMap:
        """The largest part without gaps that is left when pressures and forces with most gaps go first.

        Raises
        ------
        InputError
            If nothing is left.
        """
        rows, columns = list(range(self.fluid_pressure.size)), list(range(self.applied_force.size))
        while rows and columns:
            gaps = np.isnan(self.leak_rate[np.ix_(rows, columns)])
            if not gaps.any():
                return self._part(rows, columns)
            by_row, by_column = gaps.mean(axis=1), gaps.mean(axis=0)
            if by_row.max() >= by_column.max():
                del rows[int(by_row.argmax())]
            else:
                del columns[int(by_column.argmax())]
        raise InputError.at("table", "has no pressure at which the seal closes under all of its forces")

    def _part(self, rows: Sequence[int], columns: Sequence[int]) -> LeakMap:
        part = np.ix_(rows, columns)
        return replace(
            self,
            fluid_pressure=self.fluid_pressure[rows],
            applied_force=self.applied_force[columns],
            leak_rate=self.leak_rate[part],
            leak_rate_low=self.leak_rate_low[part],
            leak_rate_high=self.leak_rate_high[part],
            area_of_leak_rate=self.area_of_leak_rate[rows],
            validity=tuple(tuple(self.validity[m][n] for n in columns) for m in rows),
        )

    @property
    def valid(self) -> FloatArray:
        """1 where valid, 0 where doubtful, -1 outside the theory, NaN where nothing was calculated, shape (m, n)."""
        marks = {Level.VALID: 1.0, Level.DOUBTFUL: 0.0, Level.OUTSIDE: -1.0}
        return np.array(
            [[math.nan if cell is None else marks[cell.level] for cell in row] for row in self.validity]
        )


def leak_map(
    case: CaseSource,
    fluid_pressure: Sequence[float] | None = None,
    applied_force: Sequence[float] | None = None,
    progress: Progress | None = None,
) -> LeakMap:
    """Leak rate and equivalent leakage area of a seal at every fluid pressure under every force.

    All of them are loads of one run, on one mesh: each has the interval and the validity that `run` gives it.

    Bodies that yield must have been formed by an earlier load that is as large as all of these: they then come back,
    whatever the order of the loads.

    Parameters
    ----------
    case : Case, path or mapping
        With roughness and fluid.
    fluid_pressure : sequence of float, optional
        Above zero [Pa]; those of the case, or if these are fewer than three, eight up to its highest.
    applied_force : sequence of float, optional
        [N]; those of the case unless given.
    progress : callable, optional
        Called with a status message before each step.

    Raises
    ------
    InputError
        If the case has no leak rate, bodies that yield were not formed by a larger load, or the grid is wrong.
    NoLoadLeftError, ConvergenceError
        As of `run`.

    Examples
    --------
    >>> import fem_seal
    >>> case = fem_seal.load_case("examples/ball_cone.toml")
    >>> found = fem_seal.leak_map(case, [20e5], [0.0, 500.0])
    >>> found.leak_rate.shape, bool(found.leak_rate[0, 1] < found.leak_rate[0, 0])
    ((1, 2), True)
    """
    case = case_of(case)
    if case.roughness is None or case.fluid is None:
        raise InputError(problem("table_without_leak"))
    pressures = _pressures(case) if fluid_pressure is None else _check_increasing("pressures", fluid_pressure)
    forces = (
        sorted({force for _, force in case.load.points})
        if applied_force is None
        else _check_increasing("forces", applied_force)
    )
    if not pressures[0] > 0:
        raise InputError(problem("table_at_zero", pressure=Quantity(pressures[0], "given fluid pressure")))
    if len(pressures) * len(forces) > _MOST_POINTS:
        size = {"pressures": len(pressures), "forces": len(forces)}
        raise InputError(problem("table_too_large", most=_MOST_POINTS, **size))
    points = [(pressure, force) for force in forces for pressure in pressures]
    yields = bool(curves(case))
    if yields:
        # from the largest load on a body that was formed by a larger one only comes back, and the first is asked again
        points = sorted(points, key=lambda point: -case.expected_force(*point))
        points.append(points[0])
    full_case = _with_loads(case, points)
    if yields:
        check_formed(full_case)
    solution = solve(full_case, progress)
    table = _of_solution(case, solution, pressures, forces)
    return _with_return(table, solution) if yields else table


# Change of the leak rate at the largest load, after all others, up to which a formed body is taken to come back.
_COMES_BACK = 0.01


def _with_return(table: LeakMap, solution: SealSolution) -> LeakMap:
    """The same, doubtful if the leak at its first load is another one when that load comes back."""
    first, last = solution.loads[0], solution.loads[-1]
    if len(solution.loads) < 2 or first.point != last.point or first.leak is None or last.leak is None:
        return table
    first_rate, last_rate = first.leak.leak_rate, last.leak.leak_rate
    if math.isclose(first_rate, last_rate, rel_tol=_COMES_BACK):
        return table
    change = f"{100 * (last_rate / first_rate - 1):+.2g} %" if first_rate > 0 else "from nothing"
    remark = caution("load_history", change=change)
    validity = tuple(
        tuple(None if cell is None else Validity.of([*cell.cautions, remark]) for cell in row)
        for row in table.validity
    )
    return replace(table, validity=validity, reasons=(*table.reasons, remark.text(table.display)))


def _with_loads(case: Case, points: Sequence[tuple[float, float]]) -> Case:
    grid = {
        "fluid_pressure": [pressure for pressure, _ in points],
        "applied_force": [force for _, force in points],
        # what a table does not show
        "target_leak_rate": None,
    }
    # the forces of a table are those that are applied, whatever gives them
    others = dict.fromkeys(key for key in ("requirement", "bolts") if getattr(case, key) is not None)
    return case.replace(load=grid, **others)


def _of_solution(
    case: Case, solution: SealSolution, pressures: Sequence[float], forces: Sequence[float]
) -> LeakMap:
    assert case.fluid is not None
    shape = len(pressures), len(forces)
    rate, low, high = (np.full(shape, math.nan) for _ in range(3))
    validity: list[list[Validity | None]] = [[None] * shape[1] for _ in range(shape[0])]
    for load, ends in zip(solution.loads, solution.leak_ranges, strict=True):
        if load.leak is None:
            continue
        # texts between the case and here may cost the last digit
        row = int(np.argmin(np.abs(np.array(pressures) - load.point[0])))
        column = int(np.argmin(np.abs(np.array(forces) - load.point[1])))
        rate[row, column] = load.leak.leak_rate
        low[row, column], high[row, column] = ends or (load.leak.leak_rate,) * 2
        validity[row][column] = load.validity
    if np.isnan(rate).all():
        raise InputError.at("table", "has no leak rate: " + " ".join(solution.warnings))
    return LeakMap(
        title=case.title,
        fluid=case.fluid.name,
        is_gas=case.fluid.gas is not None,
        fluid_pressure=np.array(pressures),
        applied_force=np.array(forces),
        leak_rate=rate,
        leak_rate_low=low,
        leak_rate_high=high,
        density=case.fluid.density,
        area_of_leak_rate=np.array([_area_of_leak_rate(case, pressure) for pressure in pressures]),
        validity=tuple(map(tuple, validity)),
        reasons=solution.warnings,
        display=case.display,
    )


def _area_of_leak_rate(case: Case, pressure: float) -> float:
    """Equivalent leakage area over the leak rate [s/m]; NaN where density or heat capacity of the fluid is unknown."""
    from leak.flow.leak_result import leakage_area_of_gas, leakage_area_of_liquid
    from leak.fluids.library import heat_capacity_ratio

    fluid = case.fluid
    assert fluid is not None
    gas, density = fluid.gas, fluid.density
    if density is None:
        return math.nan
    if gas is None:
        return leakage_area_of_liquid(1.0, pressure, density)
    ratio, outlet = heat_capacity_ratio(gas.name), fluid.outlet_pressure
    if ratio is None or outlet is None:
        return math.nan
    return leakage_area_of_gas(density, outlet + pressure, outlet, gas, ratio)


def _pressures(case: Case) -> list[float]:
    pressures = sorted(set(case.load.fluid_pressure))
    if len(pressures) >= _FEWEST_PRESSURES:
        return pressures
    lowest = pressures[0] if len(pressures) > 1 else pressures[-1] / _RANGE
    return [float(f"{pressure:.4g}") for pressure in np.geomspace(lowest, pressures[-1], _PRESSURES)]


def _check_increasing(name: str, values: Sequence[float]) -> list[float]:
    numbers = [float(value) for value in values]
    if not numbers or sorted(set(numbers)) != numbers or not all(map(math.isfinite, numbers)):
        raise InputError.at(name, "must be finite numbers that increase, at least one")
    return numbers
