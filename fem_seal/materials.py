"""Elastic bodies, and the hardening of those that yield."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Any, NamedTuple, overload

import numpy as np

from fem_seal.arrays import FloatArray, IntArray
from fem_seal.errors import InputError
from fem_seal.files import problem
from fem_seal.wording import Quantity, Words

# Where the numbers of a material hold unless a temperature is said [K].
ROOM_TEMPERATURE = 293.15
_EXPANSION = "thermal_expansion"


@dataclass(frozen=True)
class OverTemperature:
    """A number of a material at one temperature or several, linear in between and not known beyond.

    Parameters
    ----------
    key : str
        Which number of a `Material` it is.
    temperature : tuple of float
        Increasing [K].
    value : tuple of float
        [SI]
    nearest : bool, optional
        Whether the value at an end stands for what is not known beyond it, as of the numbers of the library; whoever
        takes it says so (`beyond`). Otherwise to ask there is an error.
    source : str, optional
        Where the table is from.

    Raises
    ------
    InputError
        If the table is none.

    Examples
    --------
    >>> OverTemperature("poissons_ratio", (293.15, 493.15), (0.3, 0.32)).at(393.15)
    0.31
    """

    key: str
    temperature: tuple[float, ...]
    value: tuple[float, ...]
    nearest: bool = False
    source: str = ""

    def __post_init__(self) -> None:
        if len(self.temperature) != len(self.value) or not self.value:
            counts = {"values": len(self.value), "temperatures": len(self.temperature)}
            raise InputError(problem("unequal_table", key=self.key, **counts))
        if any(after <= before for before, after in pairwise(self.temperature)):
            raise InputError.at(self.key, "the temperatures must increase from entry to entry")

    def reaches(self, temperature: float | FloatArray) -> bool:
        """Whether the table holds a temperature, or all of them [K]."""
        # what 20 degC in kelvin is rounded to
        low, high = self.temperature[0] - 1e-6, self.temperature[-1] + 1e-6
        return low <= np.min(temperature) and bool(np.max(temperature) <= high)

    def distance_outside(self, temperature: float) -> float:
        """How far a temperature lies outside the table [K]; zero inside."""
        if self.reaches(temperature):
            return 0.0
        return max(self.temperature[0] - temperature, temperature - self.temperature[-1])

    @property
    def changes(self) -> bool:
        """Whether the number is another one at another temperature."""
        return len(set(self.value)) > 1

    @property
    def reach(self) -> Words:
        """Where the number is known, in words."""
        low, high = self.temperature[0], self.temperature[-1]
        ends = {"low": in_degrees(low), "high": in_degrees(high)}
        return Words("from {{ low }} to {{ high }}" if low < high else "at {{ low }} only", ends)

    @overload
    def at(self, temperature: float) -> float: ...

    @overload
    def at(self, temperature: FloatArray) -> FloatArray: ...

    def at(self, temperature: float | FloatArray) -> float | FloatArray:
        """The number at a temperature, or an array of them [K]; InputError outside the table unless `nearest`."""
        if not self.nearest and not self.reaches(temperature):
            high = self.temperature[-1]
            far = np.max(temperature) if np.max(temperature) > high else np.min(temperature)
            ends = {"reach": self.reach, "at": in_degrees(float(far))}
            raise InputError(problem("beyond_table", key=self.key, **ends))
        values = np.interp(temperature, self.temperature, self.value)
        return values if np.ndim(temperature) else float(values)


def in_degrees(temperature: float) -> Quantity:
    """A temperature [K] as it is said to people."""
    return Quantity(temperature, ".4g degC")


@dataclass(frozen=True)
class Material:
    """A homogeneous, isotropic material, linearly elastic up to its yield stress.

    Parameters
    ----------
    name : str
        As it is called in tables and reports.
    youngs_modulus : float
        E [Pa].
    poissons_ratio : float
        nu [-], below 0.5.
    hardness : float, optional
        Penetration hardness sigma_P [Pa], the pressure at which asperities yield; about three times the yield
        stress at 15 % strain (Tabor). None if unknown.
    yield_stress : float, optional
        Onset of plastic flow in tension [Pa], compared with the von Mises stress under the contact. None if
        unknown.
    source : str, optional
        Where the numbers come from.
    hardening : HardeningCurve, optional
        Flow stress over plastic strain; the body is then solved as elastoplastic, and `yield_stress` is that of the
        curve. Without it the body is elastic whatever its stress.
    thermal_expansion : float, optional
        Mean coefficient of linear thermal expansion from 20 degC on [1/K]. None if unknown.
    condition : str, optional
        State of the material, heat treatment for example, to which hardness and yield stress belong.
    creeps : bool, optional
        Whether it goes on yielding with time, as polymers do; results then carry a caution.
    thermal_conductivity : float, optional
        [W/(m K)]; None if unknown.
    over_temperature : tuple of OverTemperature, optional
        Which of the numbers depend on the temperature, and how, and of those of the library where they are known; the
        numbers beside it are those of one temperature, see `at`.
    hardening_over_temperature : HardeningOverTemperature, optional
        Hardening curves at several temperatures; `hardening` is then the curve at one of them, or between.

    Raises
    ------
    InputError
        If a number is not finite or outside its physical range, or two of them contradict each other.

    Examples
    --------
    >>> steel = Material("steel", youngs_modulus=210e9, poissons_ratio=0.3)
    >>> round(steel.plane_strain_modulus / 1e9, 3)
    230.769
    """

    name: str
    youngs_modulus: float
    poissons_ratio: float
    hardness: float | None = None
    yield_stress: float | None = None
    source: str = ""
    hardening: HardeningCurve | None = None
    thermal_expansion: float | None = None
    condition: str = ""
    creeps: bool = False
    thermal_conductivity: float | None = None
    over_temperature: tuple[OverTemperature, ...] = ()
    hardening_over_temperature: HardeningOverTemperature | None = None

    def __post_init__(self) -> None:
        for key in ("youngs_modulus", "hardness", "yield_stress"):
            value = getattr(self, key)
            if value is not None and not (math.isfinite(value) and value > 0):
                raise InputError.at(f"{self.name}: {key}", "must be a positive pressure [Pa]", repr(value))
        if not -1 < self.poissons_ratio < 0.5:
            raise InputError(problem("poissons_ratio", name=self.name, value=repr(self.poissons_ratio)))
        curves = self.hardening_over_temperature
        if self.hardening is None and curves is not None:
            object.__setattr__(self, "hardening", curves.next_to(ROOM_TEMPERATURE))
        if curves is not None and any(table.key == "yield_stress" for table in self.over_temperature):
            raise InputError(problem("yield_stress_of_curves", name=self.name))
        if self.hardening is not None:
            self._yield_with(self.hardening)

    def _yield_with(self, hardening: HardeningCurve) -> None:
        if self.yield_stress not in (None, hardening.yield_stress):
            stresses = {"start": hardening.yield_stress / 1e6, "value": (self.yield_stress or 0.0) / 1e6}
            raise InputError(problem("yield_stress_of_curve", name=self.name, **stresses))
        object.__setattr__(self, "yield_stress", hardening.yield_stress)

    def at(self, temperature: float) -> Material:
        """The material with its numbers at a temperature; its expansion is left open where that is not known.

        Parameters
        ----------
        temperature : float
            [K]

        Raises
        ------
        InputError
            If one of its tables does not reach there; the message names its range.

        Examples
        --------
        >>> modulus = OverTemperature("youngs_modulus", (293.15, 493.15), (210e9, 190e9))
        >>> steel = Material("steel", 210e9, 0.3, over_temperature=(modulus,))
        >>> round(steel.at(393.15).youngs_modulus / 1e9, 6)
        200.0
        """
        curves = self.hardening_over_temperature
        if not self.over_temperature and curves is None:
            return self
        numbers: dict[str, Any] = {
            table.key: None
            if table.key == _EXPANSION and not (table.nearest or table.reaches(temperature))
            else table.at(temperature)
            for table in self.over_temperature
        }
        if curves is None and all(getattr(self, key) == number for key, number in numbers.items()):
            return self
        if curves is not None:
            # the curve brings its own
            numbers |= {"hardening": curves.at(temperature), "yield_stress": None}
        return replace(self, **numbers)

    def table(self, key: str) -> OverTemperature | None:
        """What is known of a number over temperature; None of one that is given without."""
        return next((table for table in self.over_temperature if table.key == key), None)

    def conductivity(self, temperature: FloatArray) -> FloatArray:
        """Thermal conductivity at temperatures [W/(m K)].

        Parameters
        ----------
        temperature : ndarray
            [K]

        Raises
        ------
        InputError
            If it is not known, or not there.
        """
        if self.thermal_conductivity is None:
            raise InputError(problem("no_conductivity", name=self.name))
        table = self.table("thermal_conductivity")
        if table is not None:
            return np.asarray(table.at(temperature))
        return np.full(np.shape(temperature), self.thermal_conductivity)

    @property
    def largest_conductivity(self) -> float:
        """Largest thermal conductivity at any temperature [W/(m K)]; zero if none is known."""
        table = self.table("thermal_conductivity")
        return max((self.thermal_conductivity or 0.0, *(() if table is None else table.value)))

    @overload
    def thermal_strain(self, temperature: float, reference: float) -> float: ...

    @overload
    def thermal_strain(self, temperature: FloatArray, reference: float) -> FloatArray: ...

    def thermal_strain(self, temperature: float | FloatArray, reference: float) -> float | FloatArray:
        """Strain by which the material grows from one temperature [K] to others, one or an array.

        Its expansion is the mean from 20 degC on, as data sheets have it: e = a(T) (T - 20 degC) - the same at T_ref.

        Raises
        ------
        InputError
            If its expansion is not known, or not there.

        Examples
        --------
        >>> steel = Material("steel", 210e9, 0.3, thermal_expansion=11e-6)
        >>> round(steel.thermal_strain(393.15, 293.15) * 1e6, 6)
        1100.0
        """
        if np.array_equal(temperature, reference):
            return 0.0

        def since_room(at: float | FloatArray) -> float | FloatArray:
            if np.array_equal(at, ROOM_TEMPERATURE):
                return 0.0
            table = self.table(_EXPANSION)
            coefficient = self.thermal_expansion if table is None else table.at(at)
            if coefficient is None:
                raise InputError(problem("no_thermal_expansion", name=self.name))
            return coefficient * (at - ROOM_TEMPERATURE)

        return since_room(temperature) - since_room(reference)

    @property
    def plane_strain_modulus(self) -> float:
        """E / (1 - nu^2) [Pa]."""
        return self.youngs_modulus / (1 - self.poissons_ratio**2)


def effective_modulus(first: Material, second: Material) -> float:
    """Effective modulus E* of a contact pair [Pa], 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2.

    Parameters
    ----------
    first, second : Material
        The two bodies, in any order.

    References
    ----------
    Johnson, Contact Mechanics (1985), eq. 4.23.

    Examples
    --------
    >>> steel = Material("steel", youngs_modulus=210e9, poissons_ratio=0.3)
    >>> round(effective_modulus(steel, steel) / 1e9, 3)
    115.385
    """
    return 1 / (1 / first.plane_strain_modulus + 1 / second.plane_strain_modulus)


# How far the first point of a table of total strain may lie from the elastic line, as a strain: what is lost when
# strains are written with four decimals.
_YIELD_POINT = 1e-4
# Points of two curves that are nearer than this have the same strain.
_SAME_STRAIN = 1e-9
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
    known_to : float, optional
        Plastic strain up to which it was measured [-], where that is not the last point.

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
    known_to: float | None = None

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
            raise rows[0].error(
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
        if self.known_to is not None:
            return self.known_to
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
        line = stress + stiffness * strain
        return np.interp(trial, line, strain) + np.maximum(trial - line[-1], 0.0) / stiffness

    @property
    def _points(self) -> tuple[FloatArray, FloatArray]:
        return np.array(self.plastic_strain), np.array(self.stress)


@dataclass(frozen=True)
class HardeningOverTemperature:
    """Hardening curves at several temperatures.

    In between the flow stress at a plastic strain is linear in the temperature, whatever strains the points of the
    curves have; it is not known beyond the first and the last of them.

    Parameters
    ----------
    temperature : tuple of float
        Increasing [K].
    curve : tuple of HardeningCurve
    nearest : bool, optional
        Whether the curve at an end stands for what is not known beyond it, see `OverTemperature`.

    Raises
    ------
    InputError
        If there are not as many curves as temperatures, or these do not increase.

    Examples
    --------
    >>> cold, hot = HardeningCurve((0.0, 0.1), (250e6, 350e6)), HardeningCurve((0.0, 0.05), (150e6, 200e6))
    >>> between = HardeningOverTemperature((293.15, 573.15), (cold, hot)).at(433.15)
    >>> between.plastic_strain, [round(one / 1e6, 6) for one in between.stress]
    ((0.0, 0.05, 0.1), [200.0, 250.0, 275.0])
    """

    temperature: tuple[float, ...]
    curve: tuple[HardeningCurve, ...]
    nearest: bool = False

    def __post_init__(self) -> None:
        # which says what is wrong with the temperatures
        _ = self._number

    @cached_property
    def _number(self) -> OverTemperature:
        """The number of the curve over temperature, which knows its range and how far it is from one to the next."""
        return OverTemperature(
            "stress_strain", self.temperature, tuple(map(float, range(len(self.curve)))), self.nearest
        )

    def distance_outside(self, temperature: float) -> float:
        """How far a temperature lies outside the table [K]; zero inside."""
        return self._number.distance_outside(temperature)

    def at(self, temperature: float) -> HardeningCurve:
        """The curve at a temperature [K]; InputError outside the range of the table."""
        number = self._number.at(temperature)
        lower, share = int(number), number % 1
        if share == 0 or self.curve[lower] == self.curve[lower + 1]:
            return self.curve[lower]
        first, second = self.curve[lower : lower + 2]
        strain = _union((first, second))
        stress = (1 - share) * first.flow_stress(strain) + share * second.flow_stress(strain)
        stress = np.maximum.accumulate(stress)  # of round-off on a plateau
        last_strain = min(first.last_strain, second.last_strain)
        return HardeningCurve(
            tuple(strain.tolist()), tuple(stress.tolist()), None if last_strain == strain[-1] else last_strain
        )

    def next_to(self, temperature: float) -> HardeningCurve:
        """The curve at a temperature [K], or at the end of the table next to it."""
        return self.at(min(max(temperature, self.temperature[0]), self.temperature[-1]))

    def check(self, temperature: FloatArray) -> None:
        """InputError if the table does not reach all of some temperatures [K]."""
        self._number.at(temperature)

    def at_points(self, temperature: FloatArray) -> HardeningField:
        """The curve of each of many points.

        Parameters
        ----------
        temperature : ndarray, shape (...)
            [K]; beyond the table, which `check` looks for, the curve at its end.
        """
        number = np.interp(temperature, self.temperature, np.arange(len(self.curve)))
        strain = _union(self.curve)
        stresses = np.array([curve.flow_stress(strain) for curve in self.curve])
        lower = np.minimum(number.astype(int), max(len(self.curve) - 2, 0))
        upper = np.minimum(lower + 1, len(self.curve) - 1)
        share = (number - lower)[..., None]
        return HardeningField(strain, (1 - share) * stresses[lower] + share * stresses[upper])


def _union(curves: Sequence[HardeningCurve]) -> FloatArray:
    """Plastic strains of the points of all curves, increasing; those that only round-off tells apart are one."""
    strain = np.unique(np.concatenate([curve.plastic_strain for curve in curves]))
    return strain[np.diff(strain, prepend=-1.0) > _SAME_STRAIN]


@dataclass(frozen=True, eq=False)
class HardeningField:
    """Hardening curves of many points, which differ in their temperature and share their plastic strains.

    Parameters
    ----------
    strain : ndarray, shape (k,)
        Plastic strain, increasing from zero [-].
    stress : ndarray, shape (..., k)
        Flow stress of each point [Pa].
    """

    strain: FloatArray
    stress: FloatArray

    def flow_stress(self, plastic_strain: FloatArray) -> FloatArray:
        """Flow stress of each point [Pa] at its plastic strain [-], shape (...)."""
        piece = self._piece(self.strain, plastic_strain)
        return self._of(self.stress, piece) + self._slopes(piece) * (plastic_strain - self.strain[piece])

    def slope(self, plastic_strain: FloatArray) -> FloatArray:
        """Derivative of the flow stress of each point [Pa], at a corner of its curve that towards larger strain."""
        return self._slopes(self._piece(self.strain, plastic_strain))

    def plastic_strain_at(self, trial: FloatArray, stiffness: float) -> FloatArray:
        """Plastic strain p of each point at which flow stress(p) + `stiffness` p = `trial` [Pa], as of one curve."""
        line = self.stress + stiffness * self.strain
        piece = self._piece(line, trial)
        excess = trial - self._of(line, piece)
        return self.strain[piece] + excess / (stiffness + self._slopes(piece))

    def _piece(self, begins: FloatArray, value: FloatArray) -> IntArray:
        """Number of the last point of each curve that a value has reached; the first if none."""
        return np.maximum(np.sum(begins <= np.asarray(value)[..., None], axis=-1) - 1, 0)

    @staticmethod
    def _of(columns: FloatArray, piece: IntArray) -> FloatArray:
        return np.asarray(np.take_along_axis(columns, piece[..., None], axis=-1)[..., 0])

    def _slopes(self, piece: IntArray) -> FloatArray:
        return self._of(self._slope, piece)

    @cached_property
    def _slope(self) -> FloatArray:
        rise = np.diff(self.stress, axis=-1) / np.diff(self.strain)
        return np.concatenate([rise, np.zeros_like(self.stress[..., :1])], axis=-1)


class _Row(NamedTuple):
    """A row of a table as the user wrote it: its strain may be the whole one."""

    number: int
    strain: float
    stress: float

    def error(self, message: str) -> InputError:
        place = f"row {self.number} (strain {self.strain:.6g}, stress {self.stress / 1e6:.6g} MPa)"
        return InputError.at("stress_strain", f"{place}: {message}")


def _rows(strain: Sequence[float], stress: Sequence[float]) -> list[_Row]:
    if len(strain) != len(stress) or not stress:
        raise InputError(problem("unequal_curve", stresses=len(stress), strains=len(strain)))
    return [_Row(n, *pair) for n, pair in enumerate(zip(strain, stress, strict=True), start=1)]


def _check(rows: Sequence[_Row], plastic_strain: Sequence[float]) -> None:
    """InputError if a row with this plastic strain does not belong into a hardening curve."""
    for row, plastic in zip(rows, plastic_strain, strict=True):
        if not (math.isfinite(plastic) and math.isfinite(row.stress) and row.stress > 0):
            raise row.error("strain and stress must be finite, the stress positive")
        if plastic > _LARGEST_STRAIN:
            raise row.error(
                f"strain is a number, 0.1 is 10 %; allowed is at most {_LARGEST_STRAIN:g} (a file may have a column "
                '"plastic_strain [%]")'
            )
    if plastic_strain and plastic_strain[0] != 0:
        raise rows[0].error("the first row is the yield point, its plastic strain must be 0")
    for n in range(1, len(rows)):
        if not plastic_strain[n] > plastic_strain[n - 1]:
            raise rows[n].error("the plastic strain must increase from row to row")
        if not rows[n].stress >= rows[n - 1].stress:
            raise rows[n].error(
                "the stress must not fall from row to row: a softening material has no unique solution"
            )


def creep_remarks(materials: Mapping[str, Material]) -> list[str]:
    """What is to be known of bodies that creep, one sentence for each.

    Parameters
    ----------
    materials : mapping
        From what the bodies are called to their materials.
    """
    return [
        f"{name}: {material.name} creeps. Its contact grows with time and temperature, and what is lost of the "
        "closing force after a change of temperature or of load is not calculated: the results are those of a short "
        "time at the modulus and hardness given"
        for name, material in materials.items()
        if material.creeps
    ]
