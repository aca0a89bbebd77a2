"""The JSON Schemas of case and study: current, valid for all examples, one clear message for one slip."""

from __future__ import annotations

import copy
import json
import os
import shutil
import subprocess
import sys
import tomllib
from functools import cache
from pathlib import Path
from typing import Any

import input_reference
import pytest
from places import ROOT

from fem_seal.case import schema as of_a_case
from fem_seal.case.fields import Table, key_of
from fem_seal.case.notation import tables_of
from fem_seal.files import own_tables
from fem_seal.studies import tables as of_a_study

jsonschema = pytest.importorskip("jsonschema", reason="checks of the schema need jsonschema")

CASES = [
    *sorted((ROOT / "examples").glob("*.toml")),
    *sorted((ROOT / "fem_seal/templates/cases").glob("*.toml")),
]
STUDIES = sorted((ROOT / "examples" / "studies").glob("*.toml"))
# the same each time, and nobody changes it
case_schema, study_schema = cache(of_a_case.case_schema), cache(of_a_study.study_schema)
BALL = tomllib.loads((ROOT / "examples" / "ball_cone.toml").read_text(encoding="utf-8"))


def errors(schema: dict[str, Any], tables: dict[str, Any]) -> list[tuple[str, str]]:
    found = jsonschema.Draft202012Validator(schema).iter_errors(tables)
    return [(".".join(map(str, one.absolute_path)), one.message) for one in found]


@pytest.mark.parametrize("path", [*CASES, *STUDIES], ids=lambda path: path.stem)
def test_every_example_names_the_schema_that_it_fits(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    first = text.partition("\n")[0]
    assert first.startswith("#:schema ")
    schema = json.loads((path.parent / first.removeprefix("#:schema ")).read_text(encoding="utf-8"))
    assert schema["title"] == ("fem-seal study" if path in STUDIES else "fem-seal case")
    assert errors(schema, tomllib.loads(text)) == []


def test_the_shipped_schemas_are_current() -> None:
    """`make docs` writes them."""
    for file, text in input_reference.schemas().items():
        jsonschema.Draft202012Validator.check_schema(json.loads(text))
        assert file.read_text(encoding="utf-8") == text, f"{file.name} is old: make docs"


SLIPS = [
    ("seat.shape", "conee", "seat.shape", "'conical-land'"),
    ("closure.shape", "bal", "closure.shape", "'ball'"),
    ("closure.material", 7, "closure.material", "not of type 'string', 'object'"),
    ("roughness.spectrum.kind", "self-afine", "roughness.spectrum.kind", "'self-affine'"),
    ("load.fluid_pressure", 20, "load.fluid_pressure", "not of type 'string', 'array', 'object'"),
    ("load.fluid_pressure", ["20"], "load.fluid_pressure.0", "does not match"),
    ("seat.angel", "45 deg", "seat", "'angel' was unexpected"),
    ("seat.angle", None, "seat", "'angle' is a required property"),
    ("fluid.name", None, "fluid", "'viscosity' is a required property"),
    ("leak.plasticity", "true", "leak.plasticity", "not of type 'boolean'"),
]


def damaged(path: str, value: Any) -> dict[str, Any]:
    tables = copy.deepcopy(BALL)
    *parents, last = path.split(".")
    table = tables
    for parent in parents:
        table = table[parent]
    if value is None:
        del table[last]
    else:
        table[last] = value
    return tables


@pytest.mark.parametrize(("path", "value", "where", "said"), SLIPS)
def test_one_slip_is_one_message_at_its_place(path: str, value: Any, where: str, said: str) -> None:
    ((place, message),) = errors(case_schema(), damaged(path, value))
    assert place == where
    assert said in message


@pytest.mark.parametrize(
    ("roughness", "fits"),
    [
        ({"Ra": "0.4 um", "process": "lapped"}, True),
        ({"seat": {"Ra": "0.4 um", "process": "lapped"}, "closure": {"Rz": "1 um"}}, True),
        ({"seat": "lapped Ra 0.2 um"}, True),
        ({"seat": {"Ra": "0.4 um", "proces": "lapped"}}, False),
        ({"seat": {"kind": "finish", "Ra": 0.4}}, False),
    ],
)
def test_a_finish_needs_no_kind(roughness: dict[str, Any], fits: bool) -> None:
    found = errors(case_schema(), {**BALL, "roughness": roughness})
    assert len(found) == (0 if fits else 1)


@pytest.mark.parametrize(
    "seat",
    [
        {"included_angle": "90 deg"},
        {"included_angle": "90 deg", "bore_diameter": "20 mm"},
        {"angle": "45 deg"},
    ],
)
def test_either_word_of_a_dimension_fits(seat: dict[str, str]) -> None:
    assert errors(case_schema(), {**BALL, "seat": {"shape": "cone", "material": "steel", **seat}}) == []


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"base": None}, "'base' is a required property"),
        ({"responses": ["leak_rate"]}, "is not one of"),
        ({"parameters": {"seat.angle": "45 deg"}}, "is not of type 'array', 'object'"),
        ({"parameters": {"seat.angle": {"start": "1 deg", "stop": "2 deg"}}}, "'num' is a required property"),
        ({"parameters": {"seat.angle": {"distribution": "normall", "mean": "1 deg"}}}, "is not one of"),
        ({"design": {"kind": "gird"}}, "is not one of"),
    ],
)
def test_a_slip_in_a_study_is_one_message(change: dict[str, Any], said: str) -> None:
    study = {"base": "a.toml", "parameters": {"seat.angle": ["1 deg"]}, **change}
    ((_, message),) = errors(
        study_schema(), {key: value for key, value in study.items() if value is not None}
    )
    assert said in message


# --- with the language servers of editors -------------------------------------------------------------------


def server(name: str) -> str:
    beside = Path(sys.executable).with_name(name)
    found = str(beside) if beside.exists() else shutil.which(name)
    if found is None:
        pytest.skip(f"{name} is not installed (extra dev)")
    return found


def lint(name: str, *paths: Path) -> tuple[int, list[str]]:
    words = {"taplo": ["lint", "--colors", "never"], "tombi": ["lint", "--offline"]}[name]
    done = subprocess.run(
        [server(name), *words, *map(str, paths)],
        capture_output=True,
        text=True,
        env={**os.environ, "NO_COLOR": "1"},
        cwd=ROOT,
    )
    lines = [line.strip() for line in (done.stdout + done.stderr).splitlines()]
    return done.returncode, [line for line in lines if line.lower().startswith(("error:", "warning:"))]


@pytest.mark.parametrize("name", ["taplo", "tombi"])
def test_language_servers_find_nothing_in_the_examples(name: str) -> None:
    assert lint(name, *CASES, *STUDIES) == (0, [])


@pytest.mark.parametrize("name", ["taplo", "tombi"])
@pytest.mark.parametrize(
    ("old", "new"), [('shape = "cone"', 'shape = "conee"'), ('kind = "self-affine"', 'kind = "selfaffine"')]
)
def test_language_servers_say_one_thing_of_a_misspelt_form(name: str, old: str, new: str, tmp_path) -> None:
    text = (ROOT / "examples" / "ball_cone.toml").read_text(encoding="utf-8")
    assert old in text
    (tmp_path / "case.schema.json").write_text(json.dumps(case_schema()), encoding="utf-8")
    path = tmp_path / "case.toml"
    rest = text.partition("\n")[2].replace(old, new)
    path.write_text(f"#:schema ./case.schema.json\n{rest}", encoding="utf-8")
    code, (message,) = lint(name, path)
    assert code != 0
    assert "one of" in message and new.split('"')[1] in message


def test_every_key_has_its_meaning_and_every_meaning_its_key():
    """templates/keys.toml has an entry for each key but tables of their own and words that choose a form."""
    import fem_seal.case.case
    import fem_seal.studies.tables  # noqa: F401

    tables = {one.__name__: one for one in every_subclass(Table) if one.__module__.startswith("fem_seal")}
    told = dict(own_tables("keys.toml"))
    assert set(told.pop("shapes")) == {name for name, table in tables.items() if table.__doc__ is None}
    assert set(told) <= set(tables)
    for name, entries in told.items():
        assert set(entries) <= set(tables[name].model_fields), name
    for name, table in tables.items():
        for key, field in table.model_fields.items():
            assert key_of(table, key).meaning or tables_of(field), f"{name}.{key}"


def every_subclass(table):
    for one in table.__subclasses__():
        yield one
        yield from every_subclass(one)
