"""Sentences call the bodies of a seal by their names, and leave the words of the user as they are."""

from __future__ import annotations

import re
import tomllib
from importlib.resources import files
from pathlib import Path
from typing import Any

import pytest

from fem_seal import Case, InputError
from fem_seal.cli.app import main

# Words of the user that are names of bodies, too.
BRONZE = {
    "name": "seat bronze",
    "youngs_modulus": "110 GPa",
    "poissons_ratio": 0.34,
    "hardness": "1.5 GPa",
    "yield_stress": "200 MPa",
    "thermal_expansion": "18e-6 1/K",
}
COPPER = {
    "name": "old seat copper",
    "youngs_modulus": "120 GPa",
    "poissons_ratio": 0.34,
    "hardness": "0.8 GPa",
    "thermal_expansion": "17e-6 1/K",
}
TITLE = "Ring for the seat of closure 7"
BODIES: dict[str, dict[str, Any]] = {
    "gasket": {
        "closure": {"shape": "disc", "diameter": "60 mm", "material": BRONZE},
        "gasket": {
            "shape": "ring",
            "mean_diameter": "40 mm",
            "section_diameter": "4 mm",
            "material": COPPER,
        },
        "temperature": {"uniform": "300 degC"},
    },
    "valve": {
        "closure": {"shape": "ball", "radius": "20 mm", "material": BRONZE},
        "seat": {"shape": "cone", "angle": "45 deg", "material": COPPER},
    },
}
# What the bodies above and below are called.
LABELS = {"gasket": ("flange", "gasket"), "valve": ("closure", "seat")}


def tables(kind: str) -> dict[str, Any]:
    spectrum = {
        "kind": "self-affine",
        "rms_height": "0.25 um",
        "hurst": 0.8,
        "q_low": "5e3 1/m",
        "q_rolloff": "5e4 1/m",
        "q_high": "3.1416e6 1/m",
    }
    return {
        "title": TITLE,
        **BODIES[kind],
        "roughness": {"spectrum": spectrum},
        "fluid": {"name": "helium", "outlet_pressure": "0 bar"},
        "load": {"fluid_pressure": "1 bar", "applied_force": "20 kN", "pressure_side": "outer"},
        "mesh": {"contact_size": "20 um"},
    }


@pytest.mark.parametrize("kind", BODIES)
def test_bodies_have_their_labels_and_the_user_his_words(kind: str, tmp_path, capsys, unrendered) -> None:
    upper, lower = LABELS[kind]
    case_file = tmp_path / "case.toml"
    case_file.write_text(str(Case(**tables(kind))), encoding="utf-8")
    assert main(["run", str(case_file), "--output", str(tmp_path / "out"), "--details"]) == 0
    streams = capsys.readouterr()
    told = {
        "terminal": streams.out + streams.err,
        **{
            name: (tmp_path / "out" / name).read_text(encoding="utf-8")
            for name in ("report.html", "leak.csv", "summary.json")
        },
    }
    # reasons in leak.csv, warnings elsewhere
    for text in told.values():
        assert re.search(rf"\b{upper}: (the )?(von Mises|peak pressure)", re.sub(r"\s+", " ", text))
    report = told["report.html"]
    assert f"Material of the {upper}" in report and f"Material of the {lower}" in report
    for name in (BRONZE["name"], COPPER["name"], TITLE):
        assert str(name) in report
    for text in told.values():
        assert not re.search(r"(closure|flange|gasket) (bronze|copper)|(flange|gasket|seat) 7", text)


def test_an_error_calls_the_bodies_of_a_gasket_by_their_names() -> None:
    given = tables("gasket")
    narrow = {"shape": "disc", "diameter": "30 mm", "material": BRONZE}
    with pytest.raises(InputError) as error:
        Case(**{**given, "closure": narrow})
    (problem,) = error.value.problems
    assert problem.key == "gasket"
    assert "flange" in problem.message and "gasket" in problem.message
    assert not re.search(r"\b(closure|seat)\b", problem.message)


def test_an_error_about_a_material_names_the_key_of_its_table() -> None:
    plain = {name: value for name, value in BRONZE.items() if name != "hardness"}
    given = tables("gasket")
    given["closure"] = {**given["closure"], "material": plain}
    given["gasket"] = {**given["gasket"], "material": {"name": "closure seat", **_elastic(COPPER)}}
    with pytest.raises(InputError) as error:
        Case(**given)
    (problem,) = error.value.problems
    assert '"seat bronze"' in problem.message and '"closure seat"' in problem.message


def _elastic(material: dict[str, Any]) -> dict[str, Any]:
    return {key: material[key] for key in ("youngs_modulus", "poissons_ratio", "thermal_expansion")}


def test_no_sentence_has_a_name_that_only_bodies_of_valves_have() -> None:
    # only where there is heat conduction, an example, an equation, or a word of the theory
    allowed = {"top", "bottom", "wall", "key peklenik", "equations", "name"}
    templates = Path(str(files("fem_seal").joinpath("templates")))

    def bare(entry: Any, path: tuple[str, ...]) -> list[str]:
        if isinstance(entry, dict):
            return [found for key, part in entry.items() for found in bare(part, (*path, key))]
        if isinstance(entry, list):
            return [found for part in entry for found in bare(part, path)]
        said = re.search(r"""(?<![\w.\["{'/-])(closure|seat)(?![\w\]"}/.-])""", str(entry))
        return [".".join(path)] if said and not allowed & set(path) else []

    for name in ("words.toml", "findings.toml"):
        assert bare(tomllib.loads((templates / name).read_text(encoding="utf-8")), ()) == []
    # what was measured of other seals
    for file in {*(templates / "answers").glob("*.j2")} - {templates / "answers" / "support.j2"}:
        lines = file.read_text(encoding="utf-8").splitlines()
        assert [line for line in lines if bare(re.sub(r"{[{%#].*?[}%#]}", "", line), ())] == [], file.name
