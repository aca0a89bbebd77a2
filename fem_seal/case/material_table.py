"""The table [closure.material] or [seat.material] of the case file, and the library of materials in its place.

The library has properties with source and condition, and their aliases: templates/materials.toml.
"""

from __future__ import annotations

import difflib
import math
import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from itertools import groupby
from operator import itemgetter
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, Any, Literal, NamedTuple, cast

from pydantic import Discriminator, Field, GetCoreSchemaHandler, GetJsonSchemaHandler, Tag, model_validator
from pydantic_core import CoreSchema, core_schema

from fem_seal.case.fields import (
    TEMPERATURE,
    Number,
    Numbers,
    OverTemperatureTable,
    Pressures,
    Quantity,
    Table,
    quantities_of,
)
from fem_seal.errors import InputError, TextTableError
from fem_seal.files import Names, column, find_columns, own_tables, problem, read_text_table
from fem_seal.materials import (
    ROOM_TEMPERATURE,
    HardeningCurve,
    HardeningOverTemperature,
    Material,
    OverTemperature,
    in_degrees,
)
from fem_seal.units import DIMENSIONS

if TYPE_CHECKING:
    from leak.text_tables import TextTable


# Half the angle between opposite faces of the Vickers pyramid, 136 degrees.
_VICKERS_HALF_ANGLE = math.radians(68)
_STANDARD_GRAVITY = 9.80665
_ROOM = ROOM_TEMPERATURE - 273.15


def vickers_pressure(vickers: float) -> float:
    """Penetration hardness of a Vickers hardness [Pa], the mean pressure on the projected area of the indent.

    HV is the load in kgf over the area of the facets in mm^2, which is larger than the projected area by 1/sin 68
    degrees = 1/0.927: H = HV 9.80665 MPa/0.927.

    Parameters
    ----------
    vickers : float
        HV.

    References
    ----------
    ISO 6507-1 (definition of HV); Tabor, The Hardness of Metals (1951).

    Examples
    --------
    >>> import fem_seal
    >>> f"{fem_seal.vickers_pressure(331) / 1e9:.2f} GPa"
    '3.50 GPa'
    """
    return vickers * _STANDARD_GRAVITY * 1e6 / math.sin(_VICKERS_HALF_ANGLE)


# In front of a name, what says no more than which list it is from.
_LISTS = re.compile(r"^(aisi|astm|sae|din|en|uns|jis|wnr|werkstoff|grade|alloy|material)")


def _key(name: str) -> str:
    """What is compared of a name: letters and digits only, small, without the list it is from."""
    plain = re.sub(r"[^a-z0-9]", "", name.casefold())
    while (shorter := _LISTS.sub("", plain)) not in (plain, ""):
        plain = shorter
    return plain


class LibraryCurve(NamedTuple):
    """A stress-strain curve of the library, at 20 degC.

    Parameters
    ----------
    hardening : HardeningCurve
    source : str
    """

    hardening: HardeningCurve
    source: str


def _read_library() -> tuple[dict[str, Material], dict[str, LibraryCurve], dict[str, str]]:
    tables = dict(own_tables("materials.toml"))
    sources, aliases = tables.pop("sources"), tables.pop("aliases")
    materials = {name: _material(name, entry, sources) for name, entry in tables.items()}
    curves = {
        name: _library_curve(entry["curve"], sources) for name, entry in tables.items() if "curve" in entry
    }
    return materials, curves, aliases


def _library_curve(entry: dict[str, Any], sources: dict[str, str]) -> LibraryCurve:
    stress = tuple(float(f"{number}e6") for number in entry["stress"])
    return LibraryCurve(HardeningCurve(tuple(entry["strain"]), stress), entry["source"].format(**sources))


# Number of a material -> its key in the file, the power of ten of its unit there, what it is called among the sources.
_KEYS = {
    "youngs_modulus": ("E", 9, "E"),
    "hardness": ("hardness", 9, "hardness"),
    "yield_stress": ("yield", 6, "yield strength"),
    "thermal_expansion": ("expansion", -6, "expansion"),
    "thermal_conductivity": ("conductivity", 0, "conductivity"),
}
# Up to where a mean expansion from 20 degC on holds unless its entry says [degC].
_EXPANSION_TO = 100


def _material(name: str, entry: dict[str, Any], sources: dict[str, str]) -> Material:
    tables = tuple(
        table for key in _KEYS if (table := _property_over_temperature(key, entry, sources)) is not None
    )
    table_sources = [f"{_KEYS[table.key][2]}: {table.source}" for table in tables if table.source]
    source = entry["source"].format(**sources)
    return Material(
        name,
        poissons_ratio=entry["nu"],
        source=f"{source}. Over temperature: {'; '.join(table_sources)}" if table_sources else source,
        condition=entry["condition"],
        creeps=entry.get("creeps", False),
        over_temperature=tables,
        **{table.key: table.value[0] for table in tables},  # type: ignore[arg-type]
    )


def _property_over_temperature(
    key: str, entry: dict[str, Any], sources: dict[str, str]
) -> OverTemperature | None:
    """What the file says of a number: from 20 degC on, where its first value holds; None if nothing."""
    word, exponent, _ = _KEYS[key]
    table = entry.get("over", {}).get(word, {})
    # of the decimal fraction the float beside it: 129.8 * 1e9 is another one
    warm = [float(f"{number}e{exponent}") for number in table.get("value", ())]
    if key == "hardness" and "HV" in entry:
        # three digits: no hardness is known better
        first = float(f"{vickers_pressure(entry['HV']):.3g}")
    elif word in entry:
        first = float(f"{entry[word]}e{exponent}")
    elif warm:
        first = warm[0]
    else:
        return None
    if table.get("scaled"):
        warm = [float(f"{first * number / warm[0]:.6g}") for number in warm]
    at = [float(temperature) for temperature in table.get("C", ())]
    if key == "thermal_expansion" and not at:
        at, warm = [float(entry.get("expansion_to", _EXPANSION_TO))], [first]
    if not at or at[0] > _ROOM:
        at, warm = [_ROOM, *at], [first, *warm]
    return OverTemperature(
        key,
        (ROOM_TEMPERATURE, *(round(temperature + 273.15, 6) for temperature in at[1:])),
        (first, *warm[1:]),
        nearest=True,
        source=table.get("source", "").format(**sources),
    )


def suggestion(name: str, key: str, unit: str) -> str:
    """What to write for a number that a case needs and does not have.

    Parameters
    ----------
    name : str
        Of the material, as the case has it.
    key : str
        Of the number.
    unit : str

    Examples
    --------
    >>> suggestion("AISI 316L", "thermal_conductivity", "W/(m K)")
    'give it, in W/(m K); the library has "14.3 W/(m K)" for 316L at 20 degC'
    >>> suggestion("my steel", "thermal_conductivity", "W/(m K)")
    'give it, in W/(m K), from the data sheet of the material'
    """
    entry = library_name(name)
    number = None if entry is None else getattr(LIBRARY[entry], key)
    if number is None:
        return f"give it, in {unit}, from the data sheet of the material"
    return f'give it, in {unit}; the library has "{number:.4g} {unit}" for {entry} at {in_degrees(ROOM_TEMPERATURE)}'


_MATERIALS, _CURVES, _ALIASES = _read_library()

LIBRARY = MappingProxyType(_MATERIALS)
"""Name -> material, read-only."""

CURVES = MappingProxyType(_CURVES)
"""Name in `LIBRARY` -> its stress-strain curve, of those that have one; read-only."""

ALIASES = MappingProxyType(_ALIASES)
"""Other word -> name in `LIBRARY`, read-only."""

_NAMES_BY_KEY = {_key(word): name for word, name in (*ALIASES.items(), *((name, name) for name in LIBRARY))}


def library_name(name: str) -> str | None:
    """Name in `LIBRARY` of the material that is meant, None if none is.

    Parameters
    ----------
    name : str
        Capitals, spaces and signs do not count.

    Examples
    --------
    >>> library_name("AISI 316L"), library_name("1.4404"), library_name("unobtainium")
    ('316L', '316L', None)
    """
    return _NAMES_BY_KEY.get(_key(name))


def similar_names(name: str) -> list[str]:
    """Names in `LIBRARY` that are spelled like one that it does not have, the nearest first; three at most.

    Parameters
    ----------
    name : str

    Examples
    --------
    >>> similar_names("stelite")
    ['stellite 6']
    """
    key = _key(name)
    likely = difflib.get_close_matches(key, _NAMES_BY_KEY, n=6, cutoff=0.76)
    longer = [word for word in _NAMES_BY_KEY if len(key) > 3 and key in word]
    return list(dict.fromkeys(_NAMES_BY_KEY[word] for word in (*likely, *longer)))[:3]


def material(name: str) -> Material:
    """Material of the library.

    Parameters
    ----------
    name : str
        A name of `LIBRARY`, for example "steel", or another word for one ("1.4404", "AISI 316L"); capitals do not
        count.

    Raises
    ------
    InputError
        If the library does not have it; the message names the nearest ones.

    Examples
    --------
    >>> import fem_seal
    >>> seat = fem_seal.material("Stellite 6")
    >>> print(f"{seat.youngs_modulus / 1e9:.0f} GPa, {seat.hardness / 1e9:.1f} GPa: {seat.condition[:4]}")
    209 GPa, 4.6 GPa: cast
    """
    entry = library_name(name)
    if entry is None:
        likely = similar_names(name)
        hint = f"do you mean {' or '.join(repr(w) for w in likely)}? ".replace("'", '"') if likely else ""
        names = ", ".join(f'"{material_name}"' for material_name in LIBRARY)
        raise InputError.at("material", f"not in the library; {hint}known are {names}", repr(name))
    return LIBRARY[entry]


def library_curve(name: str) -> LibraryCurve:
    """Stress-strain curve of a material of the library.

    Parameters
    ----------
    name : str
        See `material`.

    Raises
    ------
    InputError
        If the library has none of it; the message names those that have one.

    Examples
    --------
    >>> library_curve("1.4404").hardening.yield_stress / 1e6
    200.0
    """
    curve = CURVES.get(library_name(name) or "")
    if curve is None:
        names = ", ".join(f'"{material_name}"' for material_name in CURVES)
        raise InputError(problem("library_curve", name=name or "a material without a name", names=names))
    return curve


_STRENGTH = Quantity("pressure", "0.1 MPa", "200 GPa")
# Numbers of a material, each as one or as a table over temperature.
Over = tuple[tuple[float, ...], tuple[float, ...]]
Modulus = Annotated[float | Over, OverTemperatureTable(Quantity("pressure", "1 MPa", "2 TPa"))]
PoissonsRatio = Annotated[float | Over, OverTemperatureTable(Number(0, 0.499))]
Strength = Annotated[float | Over, OverTemperatureTable(_STRENGTH)]
Expansion = Annotated[
    float | Over, OverTemperatureTable(Quantity("thermal expansion", "-1e-4 1/K", "1e-3 1/K"))
]
Conductivity = Annotated[
    float | Over, OverTemperatureTable(Quantity("thermal conductivity", "1e-3 W/(m K)", "1e4 W/(m K)"))
]
# Up to whatever was meant as per cent: the hardening curve then says what is wrong.
_STRAIN = Number(0, 100)


_NAMES: Names = {
    "strain": ("strain", ("strain", "total_strain", "true_strain", "epsilon")),
    "plastic_strain": ("strain", ("plastic_strain", "true_plastic_strain", "epsilon_p", "ep")),
    "stress": ("pressure", ("stress", "true_stress", "flow_stress", "sigma")),
    "temperature": ("temperature", ("temperature", "t")),
}

# What a material is called that the case gives no name.
UNNAMED = "user-defined"


class TensileTest(NamedTuple):
    """Strain and stress of a table.

    Parameters
    ----------
    kind : {"plastic_strain", "strain"}
    strain, stress : tuple of float
        [-], [Pa].
    temperature : float or None
        [K]; None where the table does not say.
    """

    kind: str
    strain: tuple[float, ...]
    stress: tuple[float, ...]
    temperature: float | None = None


def read_stress_strain(file: str | Path) -> list[TensileTest]:
    """Strain and stress of a table, or of the tables of several temperatures in one.

    Parameters
    ----------
    file : path
        Text with a header and the columns ``plastic_strain`` or ``strain`` (elastic and plastic together), true, as
        numbers or in ``[%]``, and ``stress_MPa``, true. A column ``temperature_degC`` says to which of several curves,
        one below the other, a row belongs.

    Returns
    -------
    list of TensileTest
        One, or one for each temperature in the order of the file.

    Raises
    ------
    TextTableError
        If the file is not such a table; the message names it.
    """
    try:
        return _read(read_text_table(file))
    except TextTableError as error:
        raise TextTableError(f"{file} {error}") from None


def _read(table: TextTable) -> list[TensileTest]:
    places = find_columns(table, _NAMES, 'such as "plastic_strain, stress_MPa"')
    kinds = [kind for kind in ("plastic_strain", "strain") if kind in places]
    if len(kinds) != 1 or "stress" not in places:
        raise TextTableError(problem("curve_columns", columns=", ".join(table.header)))

    def read(role: str) -> list[float]:
        numbers: list[float] = column(table, places[role], _NAMES[role][0]).tolist()
        return numbers

    strain, stress = read(kinds[0]), read("stress")
    if "temperature" not in places:
        return [TensileTest(kinds[0], tuple(strain), tuple(stress))]
    rows = zip(read("temperature"), strain, stress, strict=True)
    tests: list[TensileTest] = []
    for temperature, group in groupby(rows, key=itemgetter(0)):
        _, strains, stresses = zip(*group, strict=True)
        if any(test.temperature == temperature for test in tests):
            raise TextTableError(problem("curve_rows", temperature=in_degrees(temperature)))
        tests.append(TensileTest(kinds[0], strains, stresses, temperature))
    return tests


class StressStrain(Table):
    """A stress-strain curve in tension, true stress over true strain, from a file or written out.

    Several of them, each with its temperature, are a list of such tables, [[seat.material.stress_strain]], or one file
    with a column for the temperature.
    """

    file: str | None = None
    plastic_strain: Annotated[tuple[float, ...], Numbers(_STRAIN)] | None = None
    strain: Annotated[tuple[float, ...], Numbers(_STRAIN)] | None = None
    stress: Annotated[tuple[float, ...], Pressures(_STRENGTH)] | None = None
    temperature: Annotated[float, TEMPERATURE] | None = None

    @model_validator(mode="after")
    def _one_source(self) -> StressStrain:
        strains = [self.strain, self.plastic_strain]
        is_in_case = self.file is None and strains.count(None) == 1 and self.stress is not None
        from_file = self.file is not None and strains.count(None) == 2 and self.stress is None
        if not (is_in_case or from_file):
            raise ValueError(problem("curve_source"))
        if self.file is not None:
            tests = read_stress_strain(self.file)
            if self.temperature is not None and tests[0].temperature is not None:
                raise ValueError(f"{self.file} has a column for the temperature; leave temperature out")
        return self

    @property
    def tests(self) -> list[TensileTest]:
        """What was measured, in the order of the temperatures; TextTableError if the file is no such table."""
        if self.file is not None:
            return [
                test if test.temperature is not None else test._replace(temperature=self.temperature)
                for test in read_stress_strain(self.file)
            ]
        kind = "strain" if self.plastic_strain is None else "plastic_strain"
        strain = self.plastic_strain or self.strain or ()
        return [TensileTest(kind, strain, self.stress or (), self.temperature)]


# Names of the forms in which curves are given; the messages leave them out.
CURVE_FORMS = ("one curve", "several curves", "the library's")


Curves = Annotated[
    Annotated[StressStrain, Tag(CURVE_FORMS[0])]
    | Annotated[tuple[StressStrain, ...], Tag(CURVE_FORMS[1]), Field(strict=False)]
    | Annotated[Literal["library"], Tag(CURVE_FORMS[2])],
    Discriminator(
        lambda value: CURVE_FORMS[2 if isinstance(value, str) else isinstance(value, (list, tuple))]
    ),
]


def _hardening(
    entry: StressStrain | tuple[StressStrain, ...] | Literal["library"] | None,
    name: str,
    youngs_modulus: Callable[[float | None], float],
) -> HardeningCurve | HardeningOverTemperature | None:
    """What a material's stress_strain says; InputError or TextTableError if it is no such thing.

    Parameters
    ----------
    name : str
        Of the material.
    youngs_modulus : callable
        At a temperature [K]; None for that of the material as it stands.
    """
    if entry == "library":
        return HardeningOverTemperature((ROOM_TEMPERATURE,), (library_curve(name).hardening,), nearest=True)
    tables = (entry,) if isinstance(entry, StressStrain) else entry or ()
    tests = [test for table in tables for test in table.tests]
    if entry is None:
        return None
    without_temperature = [n for n, test in enumerate(tests, start=1) if test.temperature is None]
    if not tests or (without_temperature and len(tests) > 1):
        what = f"curve {without_temperature[0]} has no temperature" if tests else "has no curve"
        raise InputError(problem("curve_temperature", what=what))
    curves = []
    for number, test in enumerate(tests, start=1):
        try:
            curves.append(_curve(test, youngs_modulus))
        except InputError as error:
            if len(tests) == 1:
                raise
            which = f"curve {number} ({in_degrees(test.temperature or 0.0)})"
            raise InputError(
                *(replace(fault, says=f"{which}, {fault.message}") for fault in error.problems)
            ) from None
    if without_temperature:
        return curves[0]
    return HardeningOverTemperature(tuple(test.temperature or 0.0 for test in tests), tuple(curves))


def _curve(test: TensileTest, youngs_modulus: Callable[[float | None], float]) -> HardeningCurve:
    if test.kind == "strain":
        return HardeningCurve.from_total_strain(test.strain, test.stress, youngs_modulus(test.temperature))
    return HardeningCurve(test.strain, test.stress)


class MaterialTable(Table):
    """A material given by its numbers; with a name from the library, what is left out is that of the library.

    Where modulus and Poisson's ratio are given, hardness and yield stress are not taken from the library: they would
    be those of another state of the material. Every number may be a table over temperature:
    youngs_modulus = { temperature = ["20 degC", "300 degC"], value = ["210 GPa", "185 GPa"] }.
    """

    name: str = Field(UNNAMED, max_length=80)
    youngs_modulus: Modulus
    poissons_ratio: PoissonsRatio
    hardness: Strength | None = None
    yield_stress: Strength | None = None
    stress_strain: Curves | None = None
    thermal_expansion: Expansion | None = None
    thermal_conductivity: Conductivity | None = None
    creeps: bool = False


def as_table(entry: Material) -> dict[str, Any]:
    """What a case file says of a material that was made in code: its numbers as they stand, and its curve.

    Parameters
    ----------
    entry : Material
    """
    numbers = {}
    for key, field in MaterialTable.model_fields.items():
        value = getattr(entry, key, None)
        if value is not None and value is not False:
            quantity = next(quantities_of(field), None)
            numbers[key] = f"{value!r} {DIMENSIONS[quantity.dimension].si_unit}" if quantity else value
    if entry.hardening is not None:
        stress = [f"{stress!r} Pa" for stress in entry.hardening.stress]
        numbers["stress_strain"] = {"plastic_strain": list(entry.hardening.plastic_strain), "stress": stress}
    return numbers


class MaterialEntry:
    """A name from the library or a table; read as a `Material`."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_wrap_validator_function(self.read, handler.generate_schema(MaterialTable))

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        table = handler.resolve_ref_schema(
            handler(cast("core_schema.WrapValidatorFunctionSchema", schema)["schema"])
        )
        # a name from the library stands for the others
        keys = table.pop("required", None)
        if keys:
            table["anyOf"] = [{"required": ["name"]}, {"required": keys}]
        # the names are offered, and any other word for one is accepted
        return {"anyOf": [{"type": "string", "enum": list(LIBRARY)}, {"type": "string"}, table]}

    @staticmethod
    def read(value: object, read_table: core_schema.ValidatorFunctionWrapHandler) -> Material:
        """Material from what stands in the file; ValueError if the library does not have it."""
        if isinstance(value, Material):
            return value
        if isinstance(value, str):
            try:
                return material(value)
            except InputError as error:
                raise ValueError(error.message) from None
        if not isinstance(value, dict):
            raise ValueError(problem("no_material"))
        curve = value.get("stress_strain")
        if isinstance(curve, str) and curve != "library":
            raise ValueError(problem("curve_word", given=curve))
        library = _missing_entries(value)
        table = read_table({**library, **value})
        try:
            numbers, laws = _over_temperature(table.model_dump(exclude={"stress_strain"}), _of_library(value))
            _check_hardness(numbers["hardness"], numbers["yield_stress"], library)
            modulus = next((law for law in laws if law.key == "youngs_modulus"), None)
            hardening = _hardening(
                table.stress_strain,
                str(value.get("name", "")),
                lambda at: numbers["youngs_modulus"] if modulus is None or at is None else modulus.at(at),
            )
            several = isinstance(hardening, HardeningOverTemperature)
            numbers["hardening_over_temperature" if several else "hardening"] = hardening
            return Material(**numbers, over_temperature=laws, **_origin(value))
        except InputError as error:
            raise ValueError(str(error)) from None


def _check_hardness(hardness: float | None, yield_stress: float | None, library: dict[str, Any]) -> None:
    if hardness is not None and yield_stress is not None and hardness < yield_stress:
        whose = [" (of the library)" if key in library else "" for key in ("hardness", "yield_stress")]
        raise ValueError(
            problem("soft", hardness=hardness / 1e6, yield_stress=yield_stress / 1e6, whose=whose)
        )


def _over_temperature(
    entries: dict[str, Any], of_library: Mapping[str, OverTemperature]
) -> tuple[dict[str, Any], tuple[OverTemperature, ...]]:
    """Numbers at 20 degC, or at the end of a table next to it, and the tables; the case takes them elsewhere.

    Parameters
    ----------
    entries : dict
        Of the table as it was read.
    of_library : mapping
        What the library knows of those that are its own.
    """
    tables = {
        key: of_library[key] if key in of_library else OverTemperature(key, *entry)
        for key, entry in entries.items()
        if key in of_library or isinstance(entry, tuple)
    }
    numbers = {
        key: table.at(min(max(ROOM_TEMPERATURE, table.temperature[0]), table.temperature[-1]))
        for key, table in tables.items()
    }
    return {**entries, **numbers}, tuple(tables.values())


# What a table with a name from the library may leave out, with the unit in which it is written.
_LIBRARY_UNITS = {
    "youngs_modulus": " Pa",
    "poissons_ratio": None,
    "hardness": " Pa",
    "yield_stress": " Pa",
    "thermal_expansion": " 1/K",
    "thermal_conductivity": " W/(m K)",
    "creeps": None,
}


def library_table(name: str) -> dict[str, Any]:
    """A material of the library as a table that a case file could have; empty for any other name.

    Parameters
    ----------
    name : str
        In any of its spellings, which is kept.

    Examples
    --------
    >>> library_table("brass")
    {'name': 'brass', 'youngs_modulus': '100600000000.0 Pa', 'poissons_ratio': 0.35, 'creeps': False}
    """
    library_entry = library_name(name)
    if library_entry is None:
        return {}
    entry, numbers = LIBRARY[library_entry], dict[str, Any]()
    for key, unit in _LIBRARY_UNITS.items():
        number, table = getattr(entry, key), entry.table(key)
        if table is not None and table.changes:
            numbers[key] = {
                "temperature": [f"{at!r} K" for at in table.temperature],
                "value": [f"{value!r}{unit}" for value in table.value],
            }
        elif number is not None:
            numbers[key] = number if unit is None else f"{number!r}{unit}"
    return {"name": name, **numbers}


def fill_from_library(value: dict[str, Any]) -> dict[str, Any]:
    """A table of a material with what it takes from the library written out.

    Parameters
    ----------
    value : dict
        As it stands in a case.

    Examples
    --------
    >>> fill_from_library({"name": "brass", "hardness": "1 GPa"})["youngs_modulus"]
    '100600000000.0 Pa'
    """
    return {**_missing_entries(value), **value}


def _of_library(value: dict[str, Any]) -> dict[str, OverTemperature]:
    """What the library knows over temperature of the numbers that a table takes from it, or has written out."""
    of_library, whole = library_table(str(value.get("name", ""))), fill_from_library(value)
    if not of_library:
        return {}
    tables = material(of_library["name"]).over_temperature
    return {table.key: table for table in tables if whole.get(table.key) == of_library[table.key]}


def _missing_entries(value: dict[str, Any]) -> dict[str, Any]:
    """Entries that a table does not have and the library has under its name; ValueError for a slip in the name."""
    name = value.get("name")
    if not isinstance(name, str):
        return {}
    of_library = library_table(name)
    if not of_library and not {"youngs_modulus", "poissons_ratio"} & value.keys():
        likely = similar_names(name)
        hint = " (do you mean " + " or ".join(f'"{word}"' for word in likely) + "?)" if likely else ""
        raise ValueError(problem("unknown_material", name=name, hint=hint))
    # With a modulus and a Poisson's ratio of its own it is another state of the material, a colder one for example:
    # hardness and yield stress of the library's would not be this one's. That it creeps is in its nature.
    complete = {"youngs_modulus", "poissons_ratio"} <= value.keys()
    other_state = (
        {"hardness", "yield_stress", "thermal_expansion", "thermal_conductivity"} if complete else set()
    )
    # a curve begins with its own yield stress
    other_state |= {"yield_stress"} if "stress_strain" in value else set()
    return {key: entry for key, entry in of_library.items() if key not in other_state | value.keys()}


def _origin(value: dict[str, Any]) -> dict[str, Any]:
    """What is said of where the numbers of a table are from."""
    of_library = library_table(str(value.get("name", "")))
    changed_keys = [key for key in value if key != "name" and value[key] != of_library.get(key)]
    if not of_library or {"youngs_modulus", "poissons_ratio"} <= set(changed_keys):
        return {"source": "case file"}
    library_material = material(of_library["name"])
    curve = value.get("stress_strain") == "library"
    changed_keys = [key for key in changed_keys if not (curve and key == "stress_strain")]
    words = f"{', '.join(changed_keys).replace('_', ' ')}: case file; " if changed_keys else ""
    of_curve = f"; stress_strain: {library_curve(of_library['name']).source}" if curve else ""
    return {"source": words + library_material.source + of_curve, "condition": library_material.condition}


MaterialField = Annotated[Material, MaterialEntry()]
