"""Units of length as instrument files write them."""

from __future__ import annotations

from collections.abc import Sequence

from leak.errors import ScanError

LENGTH_UNITS = {
    "m": 1.0,
    "cm": 1e-2,
    "mm": 1e-3,
    "um": 1e-6,
    "µm": 1e-6,  # micro sign
    "μm": 1e-6,  # Greek letter
    "micron": 1e-6,
    "microns": 1e-6,
    "micrometer": 1e-6,
    "micrometre": 1e-6,
    "nm": 1e-9,
    "nanometer": 1e-9,
    "pm": 1e-12,
    "å": 1e-10,
    "angstrom": 1e-10,
    "in": 0.0254,
    "inch": 0.0254,
    "uin": 0.0254e-6,
    "µin": 0.0254e-6,
    "millimeter": 1e-3,
    "meter": 1.0,
}

Unit = str | Sequence[str]


def length_unit(name: object) -> float:
    """Size of a unit of length [m]; ScanError if it is none."""
    size = LENGTH_UNITS.get(name.strip().lower()) if isinstance(name, str) else None
    if size is None:
        known = ", ".join(unit for unit in LENGTH_UNITS if unit.isascii())
        raise ScanError(f"unit = {name!r}: must be a unit of length: {known}")
    return size


def two_units(unit: Unit | None) -> tuple[float | None, float | None]:
    """Sizes of the units of x and height, from one unit for both or from two [m]."""
    if unit is None:
        return None, None
    if isinstance(unit, str):
        return length_unit(unit), length_unit(unit)
    if len(unit) != 2:
        raise ScanError(f'unit = {unit!r}: must be one unit, or two, those of x and height: ["mm", "um"]')
    return length_unit(unit[0]), length_unit(unit[1])


def agreed(column: str, stated: float | None, given: float | None) -> float:
    """Unit of a column from what the file states and what the user gives; neither is overruled, none is guessed."""
    if stated is None and given is None:
        raise ScanError(
            f'does not state the unit of {column}: give it, unit = "um", or two, unit = ["mm", "um"]'
        )
    if stated is not None and given is not None and abs(stated - given) > 1e-9 * stated:
        raise ScanError(
            f"unit: the file states that {column} is in units of {stated:g} m, but {given:g} m is given"
        )
    return float(stated if stated is not None else given)  # type: ignore[arg-type]
