"""Checks of the properties of materials at the temperature where they act."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from fem_seal.materials import ROOM_TEMPERATURE, Material, in_degrees
from fem_seal.seal.findings import Finding, Level, caution
from fem_seal.seal.problem import SealProblem
from fem_seal.wording import Quantity
from leak.theory.bulk_flow import HARDNESS_OVER_YIELD_STRESS

# Distance of a temperature from the known range of a number above which it is reported, and above which the results
# are doubtful [K]: 316L loses 1 % of its modulus and 5 % of its yield stress in 25 K, 4 % and a fifth in 100 K.
NEAR, FAR = 25.0, 100.0
# Plastic strain of metal under an indent (D. Tabor), and by what factor a hardness may differ from that of its curve.
_INDENT, _UNLIKE = 0.08, 2.0
# Key of a material -> its name, the unit of its table, and the factor to that unit.
_WORDS = {
    "youngs_modulus": ("Young's modulus", " GPa", 1e-9),
    "hardness": ("hardness", " GPa", 1e-9),
    "yield_stress": ("yield stress", " MPa", 1e-6),
    "thermal_expansion": ("thermal expansion", "e-6 1/K", 1e6),
    "thermal_conductivity": ("thermal conductivity", " W/(m K)", 1.0),
}
_OF_SURFACE = ("youngs_modulus", "hardness")
# Table of a case in which a body stands that is called otherwise.
_TABLES = {"flange": "closure", "upper flange": "closure", "lower flange": "seat", "gasket": "gasket"}


def material_cautions(problem: SealProblem, *, bodies: bool = True) -> Iterator[Finding]:
    """Cautions about numbers of materials that belong to another temperature than that of the body.

    A small difference of temperature leaves the result valid.

    Parameters
    ----------
    problem : SealProblem
    bodies : bool, optional
        Whether the bodies themselves are solved; otherwise only the contact of the rough surfaces is checked.
    """
    for name, temperature in problem.at_rest.temperatures.items():
        material, label, plain = problem.materials[name], problem.contact.label_of(name), []
        names: dict[str, Any] = {"name": label, "table": _TABLES.get(label, name)}
        for key in _used_keys(problem, material) if bodies else _OF_SURFACE:
            value = getattr(material, key)
            # asperities yield at the hardness of the softer body alone
            if value is None or (key == "hardness" and value != problem.hardness):
                continue
            table = material.table(key)
            if table is None:
                plain.append(key)
                continue
            at = max(_used_temperatures(problem, key, temperature), key=table.distance_outside)
            if table.nearest and table.distance_outside(at) > NEAR:
                yield _caution_beyond_table(names, material, key, at)
        distance = abs(temperature - ROOM_TEMPERATURE)
        if plain and distance > NEAR:
            yield _plain_caution(names, material, plain, temperature)
        curves = material.hardening_over_temperature
        if bodies and curves is not None and curves.nearest and curves.distance_outside(temperature) > NEAR:
            finding = caution("library_curve", **names, material=material.name, at=in_degrees(temperature))
            yield finding if distance >= FAR else replace(finding, level=Level.VALID)


def _used_keys(problem: SealProblem, material: Material) -> Iterator[str]:
    """Keys of the numbers that the result depends on."""
    yield from _OF_SURFACE
    if material.hardening is None:
        yield "yield_stress"
    if problem.at_rest.expansion or problem.at_rest.heating is not None or problem.supports.wall == "fixed":
        yield "thermal_expansion"
    if problem.at_rest.heating is not None:
        yield "thermal_conductivity"


def _used_temperatures(problem: SealProblem, key: str, temperature: float) -> list[float]:
    """Temperatures at which a number is used [K]; those of a body that conducts heat lie between those around it."""
    heating = problem.at_rest.heating
    if heating is None or key in ("youngs_modulus", "hardness", "yield_stress"):
        return [temperature]
    return [temperature, *(face.temperature for face in heating.surroundings.faces.values())]


def _with_unit(key: str, value: float) -> str:
    _, unit, factor = _WORDS[key]
    return f"{value * factor:.4g}{unit}"


def _table(key: str, end_of_table: float, at: float, value: str) -> str:
    # rounded outwards to tens: a calculated temperature changes a little with these numbers
    tens, outwards = (at - 273.15) / 10.0, math.copysign(1.0, at - end_of_table)
    end = 10.0 * outwards * math.ceil(outwards * tens - 1e-6)
    ends = [f'"{text}"' for text in (f"{end_of_table - 273.15:.4g} degC", f"{end:.4g} degC")]
    values = [f'"{value}"', '"..."']
    order = slice(None, None, int(outwards))
    return f"{key} = {{ temperature = [{', '.join(ends[order])}], value = [{', '.join(values[order])}] }}"


def _caution_beyond_table(names: Mapping[str, Any], material: Material, key: str, at: float) -> Finding:
    table = material.table(key)
    assert table is not None  # only keys with a table are checked
    end = table.temperature[0] if at < table.temperature[0] else table.temperature[-1]
    value, unit = table.at(end), _WORDS[key][1].strip()
    pressure = unit.endswith("Pa")
    finding = caution(
        "beyond_temperatures",
        **names,
        key=key,
        number=_WORDS[key][0],
        material=material.name,
        reach=table.reach,
        value=Quantity(value, f".4g {unit}") if pressure else _with_unit(key, value),
        end=in_degrees(end),
        at=in_degrees(at),
        example=_table(key, end, at, _with_unit(key, value)),
    )
    return finding if table.distance_outside(at) >= FAR else replace(finding, level=Level.VALID)


def _plain_caution(
    names: Mapping[str, Any], material: Material, keys: list[str], temperature: float
) -> Finding:
    value, several = _with_unit(keys[0], getattr(material, keys[0])), len(keys) > 1
    finding = caution(
        "no_temperature",
        **names,
        numbers=" and ".join(filter(None, (", ".join(keys[:-1]), keys[-1]))),
        have="have" if several else "has",
        are="are" if several else "is",
        at=in_degrees(temperature),
        example=_table(keys[0], ROOM_TEMPERATURE, temperature, value),
    )
    return replace(finding, level=Level.VALID)


def hardness_cautions(problem: SealProblem) -> Iterator[Finding]:
    """Questions about a hardness, by which asperities yield, that does not fit to the curve by which its body does.

    Parameters
    ----------
    problem : SealProblem
    """
    if problem.surface is None or problem.surface.hardness is None:
        return
    for label, material in problem.labelled_materials.items():
        hardness, curve = material.hardness, material.hardening
        if hardness is None or hardness != problem.hardness or curve is None:
            continue
        of_curve = HARDNESS_OVER_YIELD_STRESS * float(curve.flow_stress(np.array(_INDENT)))
        if not 1.0 / _UNLIKE <= hardness / of_curve <= _UNLIKE:
            finding = caution(
                "hardness_of_curve",
                name=label,
                hardness=Quantity(hardness, ".3g MPa"),
                of_curve=Quantity(of_curve, ".3g MPa"),
                harder=hardness > of_curve,
            )
            yield replace(finding, level=Level.VALID)
