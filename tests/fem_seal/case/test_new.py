"""`fem-seal new`: commented templates, answers and options, and files that are not overwritten."""

from __future__ import annotations

import re
import tomllib
from functools import cache
from importlib.resources import files

import pytest
from sample_results import run_loads
from typer.testing import CliRunner

from fem_seal import InputError, load_case, run
from fem_seal.case.checks import face_remarks
from fem_seal.case.fields import NominalSizeEntry
from fem_seal.case.new_case import (
    QUESTIONS,
    TEMPLATES,
    find_questions,
    read_text_case,
    template,
    with_entries,
    with_options,
)
from fem_seal.case.schema import case_schema
from fem_seal.cli.app import app, main
from fem_seal.cli.new import CLASSES as LISTED
from fem_seal.units import parse_quantity
from leak.standards import STANDARDS, classes_of

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
    assert case.contact.initial_contact_radius > 0
    lines = path.read_text(encoding="utf-8").splitlines()
    assert lines[0] == "#:schema ./fem-seal.schema.json"
    assert (tmp_path / "sub" / "fem-seal.schema.json").is_file()
    # no radius that a drawing would give as a diameter, no rms height, every table explained
    assert not [line for line in lines if "radius =" in line and not line.startswith("edge_radius")]
    assert sum("#" in line for line in lines) > 0.4 * len(lines)
    for path_asked in ("Ra", "process", "name", "fluid_pressure"):
        assert any(line.startswith(path_asked) for line in lines)


@pytest.mark.slow
def test_a_template_runs_with_nothing_outside_the_theory(call, tmp_path) -> None:
    """The cheapest of them, without sensitivities and the interval of its finish, which take longer."""
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


def test_what_the_template_decides_is_told(call) -> None:
    _, told, _ = call("-t", "ball-valve", "--bore", "80 mm")
    # 300 N at a bore of 25 mm, times the square of 80/25
    assert "to the scale of what you gave: diameter of the closure 128 mm" in told
    assert "closing force of spring or actuator 3072 N" in told
    said = call("-t", "ball-valve", "--diameter", "40 mm", "--bore", "45 mm", "-o", "wide.toml")[2]
    assert "--bore = 45 mm: is wider than the circle" in said and "28.28 mm in diameter" in said
    assert "From the template" not in call("-t", "ball-valve", "-o", "as_it_is.toml")[1]


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
        ([], "without a terminal no questions can be asked; give one: ball-valve"),
        (["-t", "flat-set"], "do you mean flat-seat?"),
        (["-t", "needle", "-o", "needle.txt"], "must end with .toml"),
        (["-t", "flat-seat", "--included-angle", "90 deg"], "is not in the template flat-seat"),
        (["-t", "needle", "--ra", "0.1"], "roughness.Ra = 0.1: has no unit"),
        (["-t", "needle", "--bore", "50 mm", "--diameter", "8 mm"], "must exceed inner_radius = 15 mm"),
        (["-t", "needle", "--ra", "0,4 um"], "--ra = 0,4 um: has a decimal comma, use a point"),
        (["-t", "needle", "--set", "roughness.Ra=0,4 um"], 'roughness.Ra = "0,4 um": has a decimal comma'),
        (
            ["-t", "ball-valve", "--pressure", "10 bar, 1,5 bar"],
            "--pressure = 10 bar, 1,5 bar: has a decimal",
        ),
        (["-t", "needle", "--set", "seat.bore_diameter"], "must be KEY=VALUE"),
        (["-t", "needle", "--set", "seat.bore_diamter=1"], "do you mean bore_diameter?"),
    ],
)
def test_what_cannot_be_is_said_and_nothing_is_written(words, said: str, call, tmp_path) -> None:
    code, _, err = call(*words)
    assert code == 2
    assert said in err
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("options", "pressures"),
    [
        (["350 bar"], ["175 bar", "280 bar", "315 bar"]),
        (["20bar"], ["10 bar", "16 bar", "18 bar"]),
        (["700 barg"], ["350 barg", "560 barg", "630 barg"]),
        (["350 bar", "--pressure", "30 bar"], "30 bar"),
    ],
)
def test_a_relief_valve_of_another_set_pressure_is_run_up_to_it(options, pressures, call, tmp_path) -> None:
    code, _, err = call("-t", "relief-valve", "--set-pressure", *options)
    assert (code, err) == (0, "")
    tables = tomllib.loads((tmp_path / "relief-valve.toml").read_text(encoding="utf-8"))
    assert tables["load"]["fluid_pressure"] == pressures


def test_a_file_is_replaced_only_by_force(call, tmp_path) -> None:
    path = tmp_path / "needle.toml"
    path.write_text("mine")
    code, _, err = call("-t", "needle")
    assert code == 2 and "--force replaces it" in err
    assert path.read_text() == "mine"
    code, _, err = call("-t", "needle", "--force", "300 N")
    assert code == 2 and 'the closing force is --applied-force "300 N"' in err
    assert call("-t", "needle", "--force")[0] == 0
    assert "needle" in path.read_text()


def test_questions_are_asked_again_until_they_fit(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("fem_seal.cli.new._can_ask", lambda: True)
    answers = [
        str(len(TEMPLATES) + 1),
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
    found = {question.name for name in TEMPLATES for question, _, _ in find_questions(template(name))}
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


def test_names_may_be_numbers_and_pressures_stand_between_commas(call, tmp_path) -> None:
    words = [
        "-t",
        "ball-valve",
        "--seat-material",
        "1.4404",
        "--title",
        "4711",
        "--pressure",
        "10 bar,20 bar",
    ]
    assert call(*words, "--set", "closure.material=1.4404")[0] == 0
    tables = tomllib.loads((tmp_path / "ball-valve.toml").read_text(encoding="utf-8"))
    assert (tables["title"], tables["load"]["fluid_pressure"]) == ("4711", ["10 bar", "20 bar"])
    assert tables["seat"]["material"] == tables["closure"]["material"] == "1.4404"


def test_a_template_that_is_none_is_refused() -> None:
    with pytest.raises(InputError, match="must be ball-valve"):
        template("../case.schema")


# the others have a drawn section, which grows with no single dimension
GROWING = tuple(name for name in TEMPLATES if name != "flange")
BORES = ("1 mm", "7.3 mm", "25 mm", "80 mm", "200 mm")
CLASSES = {
    standard: {*classes_of(standard, gas=True), *classes_of(standard, gas=False)} for standard in STANDARDS
}
LENGTHS = ("diameter", "radius", "width", "height")


def made(name: str, bore: str, *words: str, entries: list[str] | None = None) -> dict:
    """Tables of a case from a template, as `fem-seal new` writes it."""
    answers = {"bore": bore, **dict(word.split("=", 1) for word in words)}
    text, _ = with_options(template(name), name, answers, entries or [])
    case = read_text_case(text)
    assert list(face_remarks(case)) == []
    return tomllib.loads(text)


def lengths(tables: dict) -> dict[str, float]:
    found = {
        f"{body}.{key}": parse_quantity(value, "length")
        for body in ("closure", "seat", "gasket")
        for key, value in tables.get(body, {}).items()
        if key.endswith(LENGTHS)
    }
    if "leak" in tables:
        found["bore"] = NominalSizeEntry("length", "0.1 mm", "10 m").read(tables["leak"]["nominal_size"])
    return found


@pytest.mark.parametrize("name", GROWING)
def test_every_template_grows_with_its_bore(name: str) -> None:
    first = tomllib.loads(template(name))
    (own,) = [
        value
        for key, value in lengths(first).items()
        if key in ("seat.bore_diameter", "seat.land_inner_diameter", "bore")
    ]
    for bore in BORES:
        tables, factor = made(name, bore), parse_quantity(bore, "length") / own
        for key, value in lengths(first).items():
            assert lengths(tables)[key] == pytest.approx(factor * value, rel=1e-3), key
        # of a relief valve that of its set pressure, which stays
        before, after = ([force for _, force in load_case(one).load.points] for one in (first, tables))
        assert after == pytest.approx([factor**2 * force for force in before], rel=1e-3)
        assert tables["load"]["fluid_pressure"] == first["load"]["fluid_pressure"]


@pytest.mark.slow
@pytest.mark.parametrize("name", GROWING)
def test_every_template_takes_every_class_at_every_bore(name: str) -> None:
    case = read_text_case(template(name))
    gas, lifts = case.fluid.gas is not None, case.load.pressure_side == "inner"
    for bore in BORES:
        for standard in STANDARDS:
            if standard == "API 527" and not lifts:
                with pytest.raises(InputError, match="set pressure"):
                    made(name, bore, f"class={standard}")
                continue
            for one in CLASSES[standard]:
                word = f"class={standard} {one}"
                if one not in classes_of(standard, gas=gas):
                    with pytest.raises(InputError, match="is no class for") as said:
                        made(name, bore, word)
                    assert ": ;" not in str(said.value)
                    continue
                required = {"standard": standard, "class": one}
                if one not in classes_of(standard, gas=gas, rated_capacity=False):
                    with pytest.raises(InputError, match="rated_capacity: is missing"):
                        made(name, bore, word)
                    required |= {"rated_capacity": "40 m^3/h"}
                entries = [f"requirement.{key}={value}" for key, value in list(required.items())[2:]]
                assert made(name, bore, word, entries=entries)["requirement"] == required


def test_a_flange_takes_a_torque_and_a_class_per_length() -> None:
    text, _ = with_options(template("flange"), "flange", {"torque": "3 N m", "class": "L0.1"})
    tables = tomllib.loads(text)
    assert tables["bolts"]["torque"] == "3 N m"
    assert tables["requirement"] == {"standard": "EN 13555", "class": "L0.1"}
    with pytest.raises(InputError, match="--torque"):
        with_options(template("flange"), "flange", {"bore": "20 mm"})


@pytest.mark.parametrize("fluid", ["water", "nitrogen", "diesel", "carbon dioxide"])
@pytest.mark.parametrize("name", TEMPLATES)
def test_another_fluid_has_its_temperature_and_a_requirement_that_there_is(name: str, fluid: str) -> None:
    before = tomllib.loads(template(name))
    text, _ = with_options(template(name), name, {"fluid": fluid}, [])
    case, tables = read_text_case(text), tomllib.loads(text)
    assert tables["fluid"]["name"] == fluid
    assert before["fluid"]["name"] == fluid or case.fluid.temperature == pytest.approx(293.15)
    of_gas = {"gasket": "1e-3 mbar l/s", "flange": None}
    if name in of_gas and case.fluid.gas is None:
        assert tables["requirement"] == {"leak_rate": "0.1 ml/min"}
    else:
        assert tables["requirement"] == before["requirement"]
    # the comments speak of any fluid
    assert not re.search(r"\b(oil|the gas|of gas)\b", re.sub(r'"[^"]*"', "", text))


def test_what_is_given_beside_a_fluid_stays() -> None:
    def tables(*entries: str, **given: str) -> dict:
        text, _ = with_options(template("flange"), "flange", {"fluid": "water", **given}, entries)
        return tomllib.loads(text)

    assert tables(**{"leak-rate": "2 ml/min"})["requirement"] == {"leak_rate": "2 ml/min"}
    assert tables("fluid.temperature=60 degC")["fluid"]["temperature"] == "60 degC"
    hot = tomllib.loads(with_options(template("check-valve"), "check-valve", {"pressure": "3 bar"})[0])
    assert hot["fluid"]["temperature"] == "50 degC"


@pytest.mark.parametrize(
    ("written", "expected"),
    [
        ("FCI 70.2 V", ("FCI 70-2", "V")),
        ("ANSI/FCI 70-2-2021 class V", ("FCI 70-2", "V")),
        ("Class IV", None),
        ("rate A", ("ISO 5208", "A")),
        ("DIN EN 12266-1 A", ("EN 12266-1", "A")),
        ("ISO 5208:2015 rate C", ("ISO 5208", "C")),
        ("FCI 70.2", r"names a standard and no class\. FCI 70-2 has V"),
        ("FCI 71-2 V", "is no class for a liquid"),
    ],
)
def test_a_class_is_written_as_people_write_it(written, expected) -> None:
    if isinstance(expected, tuple):
        required = made("ball-valve", "25 mm", f"class={written}")["requirement"]
        assert (required["standard"], required["class"]) == expected
    else:
        # class IV needs the flow through the open valve
        with pytest.raises(InputError, match=expected or "rated_capacity"):
            made("ball-valve", "25 mm", f"class={written}")


def test_a_face_gets_a_finish_of_its_own() -> None:
    """Where a template has one finish for both faces, the other face keeps it."""
    seen = 0
    for name in TEMPLATES:
        face = "gasket" if "\n[gasket]" in template(name) else "seat"
        options = [f'roughness.{face}.Ra="0.4 um"', f"roughness.{face}.process=turned"]
        text, _ = with_options(template(name), name, {"ra": "0.2 um"}, options)
        read_text_case(text)
        found = tomllib.loads(text)["roughness"]
        assert found[face]["Ra"] == "0.4 um" and found[face]["process"] == "turned"
        if "\n[roughness]" in template(name):
            seen += 1
            assert found["closure"]["Ra"] == "0.2 um" and set(found) == {face, "closure"}
    assert seen > 3


def test_a_force_behind_force_is_asked_for(call) -> None:
    code, _, err = call("-t", "needle", "--force", "300 N")
    assert code == 2 and '--applied-force "300 N"' in err


def test_a_class_is_found_by_its_name_alone() -> None:
    assert made("needle", "5 mm", "class=b")["requirement"] == {"standard": "ISO 5208", "class": "B"}
    assert made("needle", "5 mm", "class=V")["requirement"] == {"standard": "FCI 70-2", "class": "V"}
    assert made("ball-valve", "5 mm", "class=api 598")["requirement"]["standard"] == "API 598"
    both = made("needle", "5 mm", "class=B", "leak-rate=1 ml/min")["requirement"]
    assert both == {"standard": "ISO 5208", "class": "B", "leak_rate": "1 ml/min"}
    with pytest.raises(
        InputError, match=r"known are ISO 5208: A, AA, B, .*; API 598: metal-seated; FCI 70-2: VI, V"
    ):
        made("needle", "5 mm", "class=Z")


def test_the_help_lists_the_classes() -> None:
    for standard, names in CLASSES.items():
        told = LISTED[LISTED.index(standard) :].split(";")[0]
        assert len(names) == 1 or all(re.search(rf"\b{name}\b", told) for name in names)


def test_a_closure_of_its_own_size_and_what_is_set_stay_as_given() -> None:
    text, _ = with_options(
        template("needle"), "needle", {"bore": "2 mm", "diameter": "6 mm"}, ["seat.edge_radius=0.3 mm"]
    )
    tables = tomllib.loads(text)
    assert tables["closure"]["outer_diameter"] == "6 mm" and tables["closure"]["inner_diameter"] == "1.2 mm"
    assert tables["seat"]["edge_radius"] == "0.3 mm"
    alone = tomllib.loads(with_options(template("needle"), "needle", {"diameter": "16 mm"})[0])
    assert alone["seat"]["bore_diameter"] == "10 mm"


@pytest.mark.parametrize("name", ["ball-valve", "check-valve", "relief-valve", "needle"])
@pytest.mark.parametrize("angle", ["30 deg", "48 deg", "90 deg", "118 deg", "140 deg"])
def test_every_included_angle_fits(name: str, angle: str) -> None:
    made(name, "9 mm", f"included-angle={angle}")


@pytest.mark.slow
@pytest.mark.parametrize("bore", [BORES[0], BORES[-1]])
@pytest.mark.parametrize("name", GROWING)
def test_the_smallest_and_the_largest_are_calculated(name: str, bore: str, call, tmp_path, capsys) -> None:
    """Checked, and its highest load run, without what a verdict takes beside the leak."""
    assert call("-t", name, "--bore", bore, "--class", "ISO 5208 C", "-o", "case.toml")[0] == 0
    assert main(["check", "case.toml", "-q"]) == 0
    assert "touch first" not in capsys.readouterr().err
    case = load_case(tmp_path / "case.toml")
    (load,) = run_loads(
        case.replace(
            load={
                **dict(case.load),
                **dict(zip(("fluid_pressure", "applied_force"), case.load.points[-1], strict=True)),
                "set_pressure": None,
            },
            requirement=None,
        )
    ).loads
    assert load.leak is not None and load.leak.leak_rate >= 0.0
    assert load.contact.profile.peak_pressure > case.load.fluid_pressure[-1]
