"""`fem-seal new`: commented templates, answers and options, and files that are not overwritten."""

from __future__ import annotations

import tomllib
from functools import cache
from importlib.resources import files

import pytest
from typer.testing import CliRunner

from fem_seal import InputError, load_case, run
from fem_seal.case.new_case import QUESTIONS, TEMPLATES, asked, template, with_entries
from fem_seal.case.schema import case_schema
from fem_seal.cli import app, main

schema = cache(case_schema)


@pytest.fixture(autouse=True)
def schema_made_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Which `fem-seal new` writes beside every case."""
    monkeypatch.setattr("fem_seal.case.schema.case_schema", schema)


@pytest.fixture
def call(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)

    def called(*words: str) -> tuple[int, str, str]:
        code = main(["new", *words])
        said = capsys.readouterr()
        return code, said.out, said.err

    return called


def test_every_template_is_listed_and_shipped() -> None:
    shipped = {file.name for file in files("fem_seal").joinpath("templates", "cases").iterdir()}
    assert shipped == {f"{name}.toml" for name in TEMPLATES}


@pytest.mark.parametrize("name", TEMPLATES)
def test_every_template_is_a_valid_case_in_the_words_of_a_drawing(name: str, call, tmp_path) -> None:
    code, out, err = call("--template", name, "-o", "sub/my case.toml")
    assert (code, err) == (0, "")
    path = tmp_path / "sub" / "my case.toml"
    assert 'fem-seal run "sub/my case.toml"' in out
    case = load_case(path)
    assert case.requirement is not None and case.roughness is not None and case.fluid is not None
    assert case.contact.touch_radius > 0
    lines = path.read_text(encoding="utf-8").splitlines()
    assert lines[0] == "#:schema ./fem-seal.schema.json"
    assert (tmp_path / "sub" / "fem-seal.schema.json").is_file()
    # no radius that a drawing would give as a diameter, no rms height, every table explained
    assert not [line for line in lines if "radius =" in line and not line.startswith("edge_radius")]
    assert sum("#" in line for line in lines) > 0.4 * len(lines)
    for path_asked in ("Ra", "process", "name", "fluid_pressure"):
        assert any(line.startswith(path_asked) for line in lines)


def test_a_template_runs_with_nothing_outside_the_theory(call, tmp_path) -> None:
    """The cheapest of them, without the levers of its verdict and the interval of its finish, which take longer."""
    code, _, _ = call(
        "--template", "check-valve", "--pressure", "50 bar", "--set", 'mesh.contact_size="8 um"'
    )
    assert code == 0
    case = load_case(tmp_path / "check-valve.toml")
    assert case.requirement.leak_rate == pytest.approx(1e-6 / 60)
    surface = {
        "kind": "self-affine",
        "rms_height": 0.27e-6,
        "hurst": 0.7,
        "q_low": 8e3,
        "q_rolloff": 1e5,
        "q_high": 6e6,
    }
    row = run(case.replace(requirement=None).replace({"roughness": {"spectrum": surface}})).table.iloc[0]
    assert row["validity"] != "outside the theory"
    # a ball of 12 mm on a lapped seat leaks less than a drop (50 ul) a minute at 50 bar, but is not tight
    assert 1e-15 < row["leak_rate_m3_per_s"] < 50e-9 / 60
    # F_N = pi r0^2 p + 5 N on a cone of 90 deg, r0 = R sin 45 deg
    assert row["contact_force_N"] == pytest.approx(3.14159265 * 0.5 * 0.006**2 * 50e5 + 5, rel=1e-6)


def test_options_replace_entries_and_keep_the_comments(call, tmp_path) -> None:
    code, _, err = call(
        *("-t", "ball-valve", "--diameter", "60 mm", "--pressure", "10 bar, 20 bar", "--fluid", "helium"),
        *("--seat-material", '{ name = "stellite 6", hardness = "4.2 GPa" }', "--leak-rate", "1 ml/min"),
        *(
            "--set",
            "seat.land_width=2 mm",
            "--set",
            'output.folder="there"',
            "--title",
            "mine",
            "--class",
            "B",
        ),
    )
    assert (code, err) == (0, "")
    text = (tmp_path / "ball-valve.toml").read_text(encoding="utf-8")
    tables = tomllib.loads(text)
    assert tables["closure"]["diameter"] == "60 mm"
    assert tables["load"]["fluid_pressure"] == ["10 bar", "20 bar"]
    assert tables["seat"]["material"]["hardness"] == "4.2 GPa"
    assert tables["requirement"] == {"standard": "ISO 5208", "class": "B", "leak_rate": "1 ml/min"}
    assert tables["output"] == {"folder": "there"}
    assert tables["title"] == "mine"
    assert text.count("#") == template("ball-valve").count("#")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([], "without a terminal nothing can be asked; give one: ball-valve"),
        (["-t", "flat-set"], "do you mean flat-seat?"),
        (["-t", "needle", "-o", "needle.txt"], "must end with .toml"),
        (["-t", "flat-seat", "--included-angle", "90 deg"], "is nothing that the template flat-seat has"),
        (["-t", "needle", "--ra", "0.1"], "roughness.Ra = 0.1: has no unit"),
        (["-t", "needle", "--bore", "50 mm"], "closure and seat"),
        (["-t", "needle", "--set", "seat.bore_diameter"], "must be KEY=VALUE"),
        (["-t", "needle", "--set", "seat.bore_diamter=1"], "do you mean bore_diameter?"),
    ],
)
def test_what_cannot_be_is_said_and_nothing_is_written(words, said: str, call, tmp_path) -> None:
    code, _, err = call(*words)
    assert code == 2
    assert said in err
    assert not list(tmp_path.iterdir())


def test_a_file_is_replaced_only_by_force(call, tmp_path) -> None:
    path = tmp_path / "needle.toml"
    path.write_text("mine")
    code, _, err = call("-t", "needle")
    assert code == 2 and "--force replaces it" in err
    assert path.read_text() == "mine"
    assert call("-t", "needle", "--force")[0] == 0
    assert "needle" in path.read_text()


def test_questions_are_asked_again_until_they_fit(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("fem_seal.cli_new._can_ask", lambda: True)
    answers = [
        "7",
        "check-valve",
        "my valve",
        "15",
        "15 mm",
        "",
        "60 deg",
        "",
        "",
        "0.4 um",
        "",
        "water",
        "5 bar, 9 bar",
    ]
    found = CliRunner().invoke(app, ["new", "-o", "mine.toml"], input="\n".join([*answers, "", "", ""]))
    assert found.exit_code == 0, found.output
    case = load_case(tmp_path / "mine.toml")
    assert case.title == "my valve"
    assert case.closure.radius == 0.0075
    assert case.load.fluid_pressure == (5e5, 9e5)
    assert case.fluid.name == "water"


def test_every_question_has_its_option(call) -> None:
    for question in QUESTIONS:
        _, out, err = call("-t", "flat-set", f"--{question.name}", "x")
        assert "do you mean flat-seat?" in out + err


def test_every_question_has_an_entry_in_some_template() -> None:
    found = {question.name for name in TEMPLATES for question, _, _ in asked(template(name))}
    assert found == {one.name for one in QUESTIONS}


@pytest.mark.parametrize(
    ("path", "value", "expected"),
    [
        ("seat.angle", "40 deg", 'angle = "40 deg"'),
        ("seat.bore_radius", "4 mm", 'bore_radius = "4 mm"'),
        ("mesh.contact_size", "5 um", '[mesh]\ncontact_size = "5 um"'),
        ("load.applied_force", "20 N", 'applied_force = "20 N"'),
    ],
)
def test_either_word_of_a_dimension_is_replaced(path: str, value: str, expected: str) -> None:
    text = with_entries(template("check-valve"), {path: value})
    assert expected in text
    load_case(tomllib.loads(text))


def test_a_template_that_is_none_is_refused() -> None:
    with pytest.raises(InputError, match="must be ball-valve"):
        template("../case.schema")
