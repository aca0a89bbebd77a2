"""What the libraries of materials and fluids hold, as rows: for the terminal, JSON, CSV and the pages of the manual."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

from fem_seal.case.material_library import ALIASES, LIBRARY
from leak.fluids.find import gas, is_gas, is_liquid, liquid
from leak.fluids.library import GAS_ENTRIES, LIQUID_ENTRIES
from leak.fluids.names import ROOM_TEMPERATURE, known_name

if TYPE_CHECKING:
    from fem_seal.materials import Material

ONE_CONDITION = (
    "Hardness and yield strength are those of one condition; another heat treatment or temper changes them."
)
# Pressure at which a listing shows how a liquid thickens [Pa].
_HIGH = 1e8
CREEPS = "creeps: contact and closing force change with time, results are those of a short time"

# Of a table of numbers: key in the rows, heading, factor to the unit of the heading, significant digits.
MATERIAL_COLUMNS = (
    ("youngs_modulus_Pa", "E\nGPa", 1e-9),
    ("poissons_ratio", "nu\n", 1.0),
    ("hardness_Pa", "hardness\nGPa", 1e-9),
    ("yield_stress_Pa", "yield\nMPa", 1e-6),
    ("thermal_expansion_1_per_K", "expand\n1e-6/K", 1e6),
    ("thermal_conductivity_W_per_m_K", "conduct\nW/(m K)", 1.0),
)
# Number of a material -> its column.
_COLUMN_OF = {
    "youngs_modulus": "youngs_modulus_Pa",
    "hardness": "hardness_Pa",
    "yield_stress": "yield_stress_Pa",
    "thermal_expansion": "thermal_expansion_1_per_K",
    "thermal_conductivity": "thermal_conductivity_W_per_m_K",
}
# Of one material in words: what a column is called, factor to the unit that follows.
_WORDS = {
    "youngs_modulus_Pa": ("Young's modulus", 1e-9, " GPa"),
    "poissons_ratio": ("Poisson's ratio", 1.0, ""),
    "hardness_Pa": ("penetration hardness", 1e-9, " GPa"),
    "yield_stress_Pa": ("yield strength", 1e-6, " MPa"),
    "thermal_expansion_1_per_K": ("thermal expansion", 1e6, "e-6/K"),
    "thermal_conductivity_W_per_m_K": ("thermal conductivity", 1.0, " W/(m K)"),
}


def material_row(material: Material, temperature: float = ROOM_TEMPERATURE) -> dict[str, Any]:
    """One material in SI units, None where a number is not known, or not at this temperature.

    Parameters
    ----------
    material : Material
    temperature : float
        [K]
    """
    known = {
        column: table.at(temperature)
        if (table := material.table(key)) and table.reaches(temperature)
        else None
        for key, column in _COLUMN_OF.items()
    }
    over = {
        _COLUMN_OF[table.key]: {
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
        "youngs_modulus_Pa": known["youngs_modulus_Pa"],
        "poissons_ratio": material.poissons_ratio,
        "hardness_Pa": known["hardness_Pa"],
        "yield_stress_Pa": known["yield_stress_Pa"],
        "thermal_expansion_1_per_K": known["thermal_expansion_1_per_K"],
        "thermal_conductivity_W_per_m_K": known["thermal_conductivity_W_per_m_K"],
        "creeps": material.creeps,
        "condition": material.condition,
        "source": material.source,
        "over_temperature": over,
    }


def material_rows(temperature: float = ROOM_TEMPERATURE) -> list[dict[str, Any]]:
    """All materials of the library.

    Parameters
    ----------
    temperature : float
        [K]
    """
    return [material_row(one, temperature) for one in LIBRARY.values()]


def fluid_rows(temperature: float = ROOM_TEMPERATURE) -> list[dict[str, Any]]:
    """All fluids of the library in SI units; None where a fluid has no such number, or not at this temperature.

    Parameters
    ----------
    temperature : float
        [K]
    """
    return [fluid_row(entry.name, temperature) for entry in (*LIQUID_ENTRIES, *GAS_ENTRIES)]


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
    if is_gas(name):
        known = gas(name).name
    elif is_liquid(name):
        known = liquid(name).name
    else:
        known = known_name(name, [one.name for one in (*LIQUID_ENTRIES, *GAS_ENTRIES)], {})
    (entry,) = (one for one in (*LIQUID_ENTRIES, *GAS_ENTRIES) if one.name == known)
    row: dict[str, Any] = {
        "name": known,
        "state": "gas" if is_gas(known) else "liquid",
        "temperature_K": temperature,
        "viscosity_Pa_s": None,
        "density_kg_per_m3": None,
        "viscosity_at_1000_bar_Pa_s": None,
        "molar_mass_kg_per_mol": None,
        "dilute_up_to_Pa": None,
        "from_K": entry.low,
        "to_K": entry.high,
        "source": entry.source,
    }
    if is_gas(known):
        row |= {
            "molar_mass_kg_per_mol": gas(known).molar_mass,
            "dilute_up_to_Pa": gas(known).dilute_pressure,
        }
    # a round number of degrees must not fail by the last bit of its kelvins
    if entry.low - 1e-6 <= temperature <= entry.high + 1e-6:
        if is_gas(known):
            row |= {"viscosity_Pa_s": gas(known, temperature).viscosity}
        else:
            found = liquid(known, temperature)
            row |= {"viscosity_Pa_s": found.viscosity, "density_kg_per_m3": found.density}
            if found.pressure_law is not None:
                ratio = float(found.pressure_law.viscosity_ratio(_HIGH))
                row |= {"viscosity_at_1000_bar_Pa_s": ratio * found.viscosity}
    return row


def shown(value: float | None, factor: float = 1.0, digits: int = 4) -> str:
    """A number of a row as it stands in a table, a dash where there is none.

    Parameters
    ----------
    value : float or None
    factor : float
        To the unit of the table.
    digits : int
    """
    return "-" if value is None else f"{value * factor:.{digits}g}"


def material_cells(rows: Sequence[dict[str, Any]]) -> tuple[list[str], list[list[str]]]:
    """Headings and cells of the numbers of some materials.

    Parameters
    ----------
    rows : sequence of dict
        Of `material_rows`.
    """
    headings = ["material\n", *(heading for _, heading, _ in MATERIAL_COLUMNS)]
    cells = [
        [
            row["name"] + (" (creeps)" if row["creeps"] else ""),
            *(shown(row[key], factor) for key, _, factor in MATERIAL_COLUMNS),
        ]
        for row in rows
    ]
    return headings, cells


def fluid_cells(rows: Sequence[dict[str, Any]]) -> tuple[list[str], list[list[str]]]:
    """Headings and cells of the numbers of some fluids.

    Parameters
    ----------
    rows : sequence of dict
        Of `fluid_rows`.
    """
    headings = [
        "fluid\n",
        "\n",
        "viscosity\nmPa s",
        "density\nkg/m3",
        "dilute to\nbar",
        "from\ndegC",
        "to\ndegC",
    ]
    cells = [
        [
            row["name"],
            row["state"],
            shown(row["viscosity_Pa_s"], 1e3),
            shown(row["density_kg_per_m3"]),
            shown(row["dilute_up_to_Pa"], 1e-5),
            shown(row["from_K"] - 273.15),
            shown(row["to_K"] - 273.15),
        ]
        for row in rows
    ]
    return headings, cells


def material_lines(row: dict[str, Any]) -> Iterator[tuple[str, str]]:
    """All that is known of one material, in words.

    Parameters
    ----------
    row : dict
        Of `material_row`.
    """
    yield "name", row["name"]
    if row["aliases"]:
        yield "also called", ", ".join(row["aliases"])
    at = row["temperature_K"] - 273.15
    for key, (word, factor, unit) in _WORDS.items():
        missing = f"not known at {at:.4g} degC" if key in row["over_temperature"] else "not given"
        yield word, missing if row[key] is None else shown(row[key], factor) + unit
    yield from over_temperature_lines(row)
    if row["creeps"]:
        yield "creep", CREEPS
    yield "condition", row["condition"]
    yield "source", row["source"]


def over_temperature_lines(row: dict[str, Any]) -> Iterator[tuple[str, str]]:
    """The numbers of one material that are known over temperature, in words.

    Parameters
    ----------
    row : dict
        Of `material_row`.
    """
    for key, table in row["over_temperature"].items():
        if len(set(table["value"])) < 2:
            continue
        word, factor, unit = _WORDS[key]
        values = [shown(value, factor) for value in table["value"]]
        at = [f"{one - 273.15:.4g}" for one in table["temperature_K"]]
        yield f"{word} at", f"{', '.join(at)} degC: {', '.join(values)}{unit}"


def fluid_lines(row: dict[str, Any]) -> Iterator[tuple[str, str]]:
    """All that is known of one fluid, in words.

    Parameters
    ----------
    row : dict
        Of `fluid_row`.
    """
    yield "name", row["name"]
    yield "state", row["state"]
    at = f" at {row['temperature_K'] - 273.15:.4g} degC"
    range_ = f"{row['from_K'] - 273.15:.4g} to {row['to_K'] - 273.15:.4g} degC"
    if row["viscosity_Pa_s"] is None:
        yield "viscosity", f"not known{at}"
    else:
        yield "viscosity", f"{shown(row['viscosity_Pa_s'], 1e3)} mPa s{at}"
    if row["viscosity_at_1000_bar_Pa_s"] is not None:
        yield "at 1000 bar", f"{shown(row['viscosity_at_1000_bar_Pa_s'], 1e3, 3)} mPa s"
    elif row["state"] == "liquid" and row["viscosity_Pa_s"] is not None:
        yield "at 1000 bar", "not known"
    if row["density_kg_per_m3"] is not None:
        yield "density", f"{shown(row['density_kg_per_m3'])} kg/m3{at}"
    if row["state"] == "gas":
        yield "molar mass", f"{shown(row['molar_mass_kg_per_mol'], 1e3, 6)} g/mol"
        yield "dilute ideal gas", f"within 5 % up to {shown(row['dilute_up_to_Pa'], 1e-5)} bar"
    yield "range", range_
    yield "source", row["source"]
