"""The libraries of materials and fluids as rows, for the terminal, JSON, CSV and the manual."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from fem_seal.case.material_table import ALIASES, CURVES, LIBRARY
from fem_seal.files import own_tables, worded_rows
from fem_seal.materials import Material
from fem_seal.units import Display
from leak.fluids.library import ENTRIES, ROOM_TEMPERATURE, gas, is_gas, is_liquid, known_name, liquid

_SAID = own_tables("library.toml")
ONE_CONDITION, CREEPS = _SAID["one_condition"], _SAID["creeps"]
# Pressure at which a list shows the thickening of a liquid [Pa].
_HIGH = 1e8


@dataclass(frozen=True)
class ListedNumber:
    """A number of a material or fluid in a list, from library.toml.

    Parameters
    ----------
    key : str
        Its key in the rows.
    heading : str
        Its heading in a table.
    of : str
        Its key among the numbers over temperature of a material; empty where there is none.
    word : str
        Its name in the list of one material.
    unit : str
        A `fem_seal.units.fixed_unit`.
    """

    key: str
    heading: str
    of: str = ""
    word: str = ""
    unit: str = ""

    def text(self, display: Display, value: float | None) -> str:
        """A value in the unit of the table, a dash for none."""
        return "-" if value is None else display.quantity(value, f"fixed {self.unit}").split()[0]

    def with_unit(self, display: Display, *values: float) -> str:
        """Values and their unit, written once: "16, 16.5e-6/K"."""
        name = display.fixed_unit(self.unit).name
        return (
            (", ".join(self.text(display, value) for value in values) + f" {name}")
            .rstrip()
            .replace(" 1e-6/", "e-6/")
        )


_OF_MATERIALS, _OF_FLUIDS = (
    {entry["key"]: ListedNumber(**entry) for entry in _SAID[kind]} for kind in ("materials", "fluids")
)


def material_row(material: Material, temperature: float = ROOM_TEMPERATURE) -> dict[str, Any]:
    """One material in SI units, None where a number is not known, or not at this temperature.

    Parameters
    ----------
    material : Material
    temperature : float
        [K]
    """
    columns = {number.of: key for key, number in _OF_MATERIALS.items()}
    numbers = {
        key: table.at(temperature)
        if (table := material.table(number.of)) and table.reaches(temperature)
        else None
        for key, number in _OF_MATERIALS.items()
    }
    over = {
        columns[table.key]: {
            "temperature_K": list(table.temperature),
            "value": list(table.value),
            "source": table.source,
        }
        for table in material.over_temperature
    }
    return {
        "name": material.name,
        "aliases": [word for word, name in ALIASES.items() if name == material.name],
        "temperature_K": temperature,
        **numbers,
        "poissons_ratio": material.poissons_ratio,
        "creeps": material.creeps,
        "condition": material.condition,
        "source": material.source,
        "over_temperature": over,
        "stress_strain": None
        if (curve := CURVES.get(material.name)) is None
        else {
            "plastic_strain": list(curve.hardening.plastic_strain),
            "stress_Pa": list(curve.hardening.stress),
            "source": curve.source,
        },
    }


def material_rows(temperature: float = ROOM_TEMPERATURE) -> list[dict[str, Any]]:
    """All materials of the library.

    Parameters
    ----------
    temperature : float
        [K]
    """
    return [material_row(material, temperature) for material in LIBRARY.values()]


def fluid_rows(temperature: float = ROOM_TEMPERATURE) -> list[dict[str, Any]]:
    """All fluids of the library in SI units; None where a fluid has no such number, or not at this temperature.

    Parameters
    ----------
    temperature : float
        [K]
    """
    return [fluid_row(entry.name, temperature) for entry in ENTRIES]


def fluid_row(name: str, temperature: float = ROOM_TEMPERATURE) -> dict[str, Any]:
    """One fluid of the library in SI units.

    Parameters
    ----------
    name : str
    temperature : float
        [K]; outside the range of a fluid its viscosity and density are None.

    Raises
    ------
    FluidError
        If the library has no such fluid; the message names the nearest ones.
    """
    entries = {entry.name: entry for entry in ENTRIES}
    if is_gas(name):
        full_name = gas(name).name
    elif is_liquid(name):
        full_name = liquid(name).name
    else:
        full_name = known_name(name, list(entries), {})
    entry, of_gas = entries[full_name], gas(full_name) if is_gas(full_name) else None
    row: dict[str, Any] = {
        "name": full_name,
        "state": "liquid" if of_gas is None else "gas",
        "temperature_K": temperature,
        "viscosity_Pa_s": None,
        "density_kg_per_m3": None,
        "viscosity_at_1000_bar_Pa_s": None,
        "molar_mass_kg_per_mol": None if of_gas is None else of_gas.molar_mass,
        "dilute_up_to_Pa": None if of_gas is None else of_gas.dilute_pressure,
        "from_K": entry.low,
        "to_K": entry.high,
        "source": entry.source,
    }
    # a round number of degrees must not fail because of the last bit of its kelvins
    if entry.low - 1e-6 <= temperature <= entry.high + 1e-6:
        if of_gas is not None:
            row |= {"viscosity_Pa_s": gas(full_name, temperature).viscosity}
        else:
            fluid = liquid(full_name, temperature)
            row |= {"viscosity_Pa_s": fluid.viscosity, "density_kg_per_m3": fluid.density}
            if fluid.pressure_law is not None:
                ratio = float(fluid.pressure_law.viscosity_ratio(_HIGH))
                row |= {"viscosity_at_1000_bar_Pa_s": ratio * fluid.viscosity}
    return row


def material_cells(display: Display, rows: Sequence[dict[str, Any]]) -> tuple[list[str], list[list[str]]]:
    """Headings and cells of the numbers of some materials.

    Parameters
    ----------
    display : Display
    rows : sequence of dict
        Of `material_rows`.
    """
    names = [[row["name"] + (" (creeps)" if row["creeps"] else "")] for row in rows]
    return _cells(display, ["material\n"], names, rows, _OF_MATERIALS)


def fluid_cells(display: Display, rows: Sequence[dict[str, Any]]) -> tuple[list[str], list[list[str]]]:
    """Headings and cells of the numbers of some fluids.

    Parameters
    ----------
    display : Display
    rows : sequence of dict
        Of `fluid_rows`.
    """
    return _cells(display, ["fluid\n", "\n"], [[row["name"], row["state"]] for row in rows], rows, _OF_FLUIDS)


def _cells(
    display: Display,
    headings: list[str],
    names: list[list[str]],
    rows: Sequence[dict[str, Any]],
    numbers: Mapping[str, ListedNumber],
) -> tuple[list[str], list[list[str]]]:
    """Headings and cells: first the names, then the numbers."""
    cells = [[number.text(display, row[key]) for key, number in numbers.items()] for row in rows]
    return (
        [
            *headings,
            *(
                number.heading.format(unit=display.fixed_unit(number.unit).name)
                for number in numbers.values()
            ),
        ],
        [[*first, *others] for first, others in zip(names, cells, strict=True)],
    )


def material_lines(display: Display, row: dict[str, Any]) -> Iterator[tuple[str, str]]:
    """All that is known of one material, in words.

    Parameters
    ----------
    display : Display
    row : dict
        Of `material_row`.
    """
    yield from worded_rows(display, "material", row=row)
    at = display.quantity(row["temperature_K"], "fixed degC")
    for key, number in _OF_MATERIALS.items():
        missing = f"not known at {at}" if key in row["over_temperature"] else "not given"
        yield number.word, missing if row[key] is None else number.with_unit(display, row[key])
    yield from over_temperature_lines(display, row)
    yield from worded_rows(display, "material_source", row=row, creeps=CREEPS)


def over_temperature_lines(display: Display, row: dict[str, Any]) -> Iterator[tuple[str, str]]:
    """The numbers of one material that are known over temperature, in words.

    Parameters
    ----------
    display : Display
    row : dict
        Of `material_row`.
    """
    degrees = ListedNumber("temperature_K", "", unit="degC")
    for key, table in row["over_temperature"].items():
        if len(set(table["value"])) > 1:
            at, number = degrees.with_unit(display, *table["temperature_K"]), _OF_MATERIALS[key]
            yield f"{number.word} at", f"{at}: {number.with_unit(display, *table['value'])}"


def fluid_lines(display: Display, row: dict[str, Any]) -> list[tuple[str, str]]:
    """All that is known of one fluid, in words.

    Parameters
    ----------
    display : Display
    row : dict
        Of `fluid_row`.
    """
    return worded_rows(display, "fluid", row=row, high=_HIGH)
