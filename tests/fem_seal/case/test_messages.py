"""What is said of a key that stands in the wrong table."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any, get_args, get_origin

import pytest

import fem_seal
from fem_seal.case.case import Case
from fem_seal.case.new_case import template
from fem_seal.case.notation import choices, tables_of, words_of
from fem_seal.case.roughness import _OF_RANDOM, HEIGHTS, TurnedFace
from fem_seal.errors import InputError
from fem_seal.files import parse_toml

CASE = {
    "closure": {"shape": "ball", "radius": "20 mm", "material": "316L"},
    "seat": {"shape": "cone", "angle": "45 deg", "material": "316L"},
    "interface": {"law": "smooth"},
    "load": {"fluid_pressure": "20 bar"},
}


def is_list(annotation: Any) -> bool:
    return get_origin(annotation) in (tuple, list) or any(map(is_list, get_args(annotation)))


def tables(path: tuple[str, ...] = (), model: Any = Case, inside: tuple = ()) -> Iterator[tuple]:
    """Path, model, and what stands around it, of every table; of each form of a table one."""
    yield path, model, inside
    for key, field in model.model_fields.items():
        for below in tables_of(field):
            yield from tables((*path, key), below, (*inside, (key, is_list(field.annotation), below)))


def tag(model: Any) -> dict[str, str]:
    """The word that tells forms of a table apart."""
    return {key: choices(model, key)[0] for key in ("shape", "kind") if key in model.model_fields}


def written(inside: tuple, key: str) -> dict[str, Any]:
    """A case with a key in a table; what else the table needs is left out."""
    entry: Any = {key: "1"}
    for name, several, model in reversed(inside):
        entry = {**tag(model), **entry}
        entry = {name: [entry] if several else entry}
    return {**CASE, **entry}


def keys(model: Any) -> set[str]:
    return {*model.model_fields, *words_of(model)}


# what a material may be does not depend on the shape around it
ALL = list({(path, model): (path, model, inside) for path, model, inside in tables()}.values())
KEYS = {key for _, model, _ in ALL for key in keys(model)}


def chooses_another_form(model: Any, key: str) -> bool:
    """Whether the key makes a turned face or a finish of the table, about which then something else is said."""
    is_rough = model.__module__ == TurnedFace.__module__
    return is_rough and (key in ("feed", *HEIGHTS) or (model is TurnedFace and key in _OF_RANDOM))


def pairs() -> Iterator[tuple[tuple, str, str]]:
    """A table, a key that it does not know, and where that key belongs where this is one place."""
    for path, model, inside in ALL:
        for key in sorted(KEYS - keys(model)):
            if key in ("shape", "kind") or chooses_another_form(model, key):
                continue
            places = {other for other, one, _ in ALL if key in keys(one)}
            forms = [one for other, one, _ in ALL if other == path and key in keys(one)]
            if forms:
                yield inside, key, "it belongs to "
            elif len(places) == 1 and places != {()}:
                (place,) = places
                yield inside, key, f"[{'.'.join(place)}]"
            elif places == {()}:
                yield inside, key, f"in a table of its own, [{key}]" if key != "title" else "above all tables"


def said_of(inside: tuple, key: str) -> str:
    with pytest.raises(fem_seal.InputError) as caught:
        Case(**written(inside, key))
    here = ".".join(name for name, _, _ in inside)
    found = [
        one.message
        for one in caught.value.problems
        if re.sub(r"\[\d+\]", "", one.key) == f"{here}.{key}".lstrip(".")
    ]
    return " ".join(found)


@pytest.mark.slow
def test_every_key_is_looked_for_in_every_table() -> None:
    asked, missed = 0, []
    for inside, key, place in pairs():
        asked += 1
        message = said_of(inside, key)
        # of a key that another form of the table knows the nearest table may be named as well
        is_said = place in message or (place == "it belongs to " and "it belongs in [" in message)
        # "force" of a load is a word for another key of the load before it is one of a side force
        is_said = ("belongs" in message and is_said) or "do you mean applied_force?" in message
        if not is_said:
            missed.append((".".join(name for name, _, _ in inside), key, place, message[:120]))
    assert asked > 2000 and not missed, missed[:20]


@pytest.mark.parametrize(
    ("entry", "said"),
    [
        (
            {"contact_size": "1 um"},
            "fine.contact_size: unknown key; it belongs in [mesh]; known keys here are rms_height",
        ),
        ({"rms_heigth": "1 um"}, "fine.rms_heigth: unknown key; do you mean rms_height?"),
        ({"kind": "self-affine"}, 'fine.kind: unknown key; it belongs to kind = "finish"'),
        ({"hurst": 2}, "fine.hurst = 2: out of range"),
    ],
)
def test_fine_roughness_is_called_as_in_the_file(entry: dict[str, Any], said: str) -> None:
    fine = {"rms_height": "0.1 um", "hurst": 0.8, "q_rolloff": "1e5 1/m"} | entry
    turned = {"process": "turned", "feed": "0.1 mm", "nose_radius": "0.4 mm", "fine": fine}
    with pytest.raises(fem_seal.InputError) as caught:
        Case(**{**CASE, "roughness": turned})
    (one,) = caught.value.problems
    assert said in str(one)


@pytest.mark.parametrize(
    ("table", "key", "said"),
    [
        ("load", "outlet_pressure", "it belongs in [fluid];"),
        ("load", "Outlet-Pressure", "it belongs as outlet_pressure in [fluid];"),
        ("load", "viscocity", "do you mean viscosity, which belongs in [fluid]?"),
        ("load", "hurts", "do you mean hurst, which belongs in [roughness]?"),
        ("load", "fluid_presure", "do you mean fluid_pressure? known"),
        ("fluid", "pressure_outlet", "do you mean outlet_pressure? known"),
        ("closure", "hardness", "it belongs in [closure.material];"),
        ("load", "hardness", "it belongs in [closure.material], [seat.material] or [gasket.material];"),
        ("seat", "land_width", 'it belongs to shape = "conical-land";'),
        ("load", "depth", "it belongs in [[form.scratches]] or [form.lay];"),
        ("load", "nonsense", "unknown key; known keys here are"),
        # words of the field
        ("load", "force", "do you mean applied_force? known"),
        ("load", "pressure", "do you mean fluid_pressure? pressure belongs in [direct]; known"),
        ("load", "line_load", "give applied_force, the line load times the circumference of the seal; known"),
        ("load", "bolt_load", "give preload, the force of each bolt, in [bolts]; known"),
        ("closure", "E", "do you mean youngs_modulus, which belongs in a table of the material? known"),
    ],
)
def test_says_where_a_key_belongs(table, key, said) -> None:
    with pytest.raises(fem_seal.InputError, match=re.escape(f"{table}.{key}: ")) as caught:
        Case(**{**CASE, table: {**CASE.get(table, {}), key: "1"}})
    assert said in str(caught.value)


def test_a_key_above_all_tables() -> None:
    with pytest.raises(fem_seal.InputError, match=r"^viscosity: unknown key; it belongs in \[fluid\];"):
        Case(**CASE, viscosity="1 mPa s")


@pytest.mark.parametrize(
    ("name", "meant"),
    [
        ("steam", "CoolProp:Water"),
        ("oil", "hydraulic oil ISO VG 32 or hydraulic oil ISO VG 46"),
        ("hydraulic oil", "hydraulic oil ISO VG 32 or hydraulic oil ISO VG 46"),
        ("Wter", "water"),
        ("Heliun", "helium"),
    ],
)
def test_a_fluid_by_another_name_is_told_which_one_is_meant(name: str, meant: str) -> None:
    with pytest.raises(InputError, match=f"do you mean {meant}\\?"):
        fem_seal.Case(**CASE, roughness={"Ra": "0.2 um", "process": "lapped"}, fluid={"name": name})


@pytest.mark.parametrize(
    ("table", "key", "value", "said"),
    [
        ("fluid", "temperature", "-300 degC", "below absolute zero"),
        ("fluid", "temperature", "20", "has no unit"),
        ("fluid", "temperature", "3 K", "the properties of water are known"),
        ("fluid", "outlet_pressure", "1 barg", "absolute"),
        ("fluid", "name", "watr", "do you mean water?"),
        ("requirement", "standard", None, "belongs to a standard"),
        ("requirement", "standard", "ISO 5209", "is not known"),
        ("requirement", "class", "Z", "is no class"),
        ("load", "fluid_pressure", "200 degC", 'unit "degC" does not fit'),
        ("closure", "shape", "bal", "do you mean"),
        ("closure", "diameter", "-40 mm", "out of range"),
        ("seat", "land_width", "100 mm", "allowed is below"),
        ("roughness", "Ra", "0.1", "has no unit"),
        ("temperature", "uniform", "-300 degC", "below absolute zero"),
    ],
)
def test_one_mistake_is_one_error(table: str, key: str, value: str | None, said: str) -> None:
    given = parse_toml(template("ball-valve"))
    entries = {**given.get(table, {}), key: value}
    changed = {name: one for name, one in entries.items() if one is not None}
    with pytest.raises(InputError) as caught:
        Case(**{**given, table: changed})
    (wrong,) = caught.value.problems
    assert said in str(wrong)


def test_the_last_of_four_places_is_named() -> None:
    """ "or 1 others" is as long as the name itself."""
    closure = {"shape": "cone", "angle": "45 deg", "diameter": "3 mm", "material": "steel"}
    seat = {"shape": "cone", "angle": "45 deg", "material": "steel"}
    with pytest.raises(fem_seal.InputError, match=r'or shape = "disc"; known') as caught:
        Case(closure=closure, seat=seat, load={"fluid_pressure": "1 bar"})
    assert "others" not in str(caught.value)
