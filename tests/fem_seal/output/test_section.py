"""`fem-seal check --picture`: the section with the dimensions that stand on a drawing."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from places import EXAMPLES

from fem_seal import Case, InputError
from fem_seal.cli.app import main
from fem_seal.output.pictures.section import write_section

EXAMPLE = EXAMPLES / "ball_cone.toml"
SEATS = {
    "cone": ({"included_angle": "90 deg", "bore_diameter": "20 mm"}, ["bore ⌀20", "90°", "contact ⌀28.28"]),
    "conical-land": ({"angle": "30 deg", "land_width": "1 mm"}, ["120°", "land ⌀20.87", "contact ⌀20"]),
    "flat-land": (
        {"land_inner_diameter": "24 mm", "land_outer_diameter": "30 mm"},
        ["bore ⌀24", "land ⌀30", "⌀24"],
    ),
    "torus": ({"centre_diameter": "28 mm", "radius": "3 mm"}, ["ring ⌀28"]),
    "sphere": ({"radius": "26 mm", "contact_angle": "40 deg", "face_diameter": "34 mm"}, ["face ⌀34"]),
    "sharp-edge": ({"bore_diameter": "24 mm"}, ["bore ⌀24"]),
}


def texts(path: Path) -> str:
    return " | ".join(re.findall(r"<text[^>]*>([^<]*)</text>", path.read_text(encoding="utf-8")))


@pytest.mark.parametrize("shape", SEATS)
def test_the_section_shows_what_stands_on_a_drawing(shape: str, tmp_path) -> None:
    keys, expected = SEATS[shape]
    case = Case(
        title="a title",
        closure={"shape": "ball", "diameter": "40 mm", "material": "steel"},
        seat={"shape": shape, "material": "brass", **keys},
        interface={"law": "exponential", "u0": "2 um", "p_c": "1 GPa"},
        load={"fluid_pressure": "1 bar", "pressure_side": "inner", "applied_force": "1 kN"},
    )
    drawn = texts(write_section(case, tmp_path / "section.svg"))
    for text in ["a title", "closure ⌀40", "ball, steel", f"{shape}, brass", *expected]:
        assert text in drawn
    # the bore is on the side of the high pressure: its two words stand in the bore, one below the other
    assert "low pressure" in drawn and "high pressure" not in drawn


def test_the_same_case_is_drawn_the_same(tmp_path) -> None:
    from fem_seal import load_case

    first, second = (
        write_section(load_case(EXAMPLE), tmp_path / name).read_bytes() for name in ("a.svg", "b.svg")
    )
    assert first == second


@pytest.mark.parametrize(
    ("words", "file"),
    [
        (["--picture"], "ball_cone.png"),
        (["--picture", "section.pdf"], "section.pdf"),
        (["--picture", "--quiet"], "ball_cone.png"),
    ],
)
def test_check_draws_into_the_named_file_or_beside_the_user(
    words, file, tmp_path, monkeypatch, capsys
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["check", str(EXAMPLE), *words]) == 0
    assert [path.name for path in tmp_path.iterdir()] == [file]
    said = capsys.readouterr().out
    assert ("--quiet" in words) == (said == "")
    assert said == "" or said.endswith(f"picture in {file}\n")


def test_the_case_may_follow_the_option(tmp_path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["check", "--picture", str(EXAMPLE)]) == 0
    assert (tmp_path / "ball_cone.png").stat().st_size > 20_000


@pytest.mark.parametrize(
    ("name", "said"), [("section.jpg", r"must end with .png"), ("no/where.png", "cannot be written")]
)
def test_a_picture_that_cannot_be_is_refused(name: str, said: str, tmp_path) -> None:
    from fem_seal import load_case

    with pytest.raises(InputError, match=said):
        write_section(load_case(EXAMPLE), tmp_path / name)
