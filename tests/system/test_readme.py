"""What the README and the generated reference say is true."""

import re
import tomllib

import input_reference
import pytest
from places import ROOT

from fem_seal.case.case import Case

README = (ROOT / "README.md").read_text(encoding="utf-8")


def test_make_knows_the_commands_of_the_readme():
    targets = set(re.findall(r"^([a-z]+):", (ROOT / "Makefile").read_text(), re.MULTILINE))
    commands = re.findall(r"^make (\w+)$", README, re.MULTILINE)
    assert commands == ["run", "test"]
    assert set(re.findall(r"`make (\w+)`", README)) | set(commands) <= targets


def test_the_readme_is_read_in_minutes():
    assert README.count("\n") <= 120


def test_files_and_folders_named_in_the_readme_exist():
    named = re.findall(r"\[[^\]]*\]\(([^)]+)\)", README) + re.findall(r"examples/[a-z_]+\.toml", README)
    named += re.findall(r"`([a-z_]+)/`", README)
    assert len(named) > 8
    assert not [name for name in named if not (ROOT / name).exists()]


def test_commands_named_in_the_readme_exist():
    from fem_seal.cli.app import app

    known = {command.name or command.callback.__name__ for command in app.registered_commands}
    known |= {group.name for group in app.registered_groups}
    assert set(re.findall(r"fem-seal (\w+) ", README)) <= known


def test_the_case_of_the_readme_is_valid():
    (text,) = re.findall(r"```toml\n(.*?)```", README, re.DOTALL)
    assert Case(**tomllib.loads(text)).closure.radius == 0.02


def test_system_libraries_are_listed_in_one_place():
    files = [ROOT / name for name in ("README.md", "Makefile", ".ci/Dockerfile", ".ci/run", ".ci/system")]
    assert [path.name for path in files if "libglu1-mesa" in path.read_text(encoding="utf-8")] == ["system"]
    assert all(".ci/system" in path.read_text(encoding="utf-8") for path in files[1:4])


def test_input_reference_is_up_to_date():
    written = input_reference.FILE.read_text(encoding="utf-8")
    assert written == input_reference.reference(), "run `make docs`"
    for page in input_reference.TASKS:
        written = (input_reference.PAGES / f"{page}.md").read_text(encoding="utf-8")
        assert written == input_reference.task(page), "run `make docs`"
    assert {path.stem for path in input_reference.PAGES.glob("*.md")} == set(input_reference.TASKS)


def test_reference_of_the_columns_is_up_to_date():
    written = input_reference.COLUMNS_FILE.read_text(encoding="utf-8")
    assert written == input_reference.columns_reference(), "run `make docs`"


def test_page_of_the_materials_is_up_to_date():
    written = input_reference.MATERIALS_FILE.read_text(encoding="utf-8")
    assert written == input_reference.materials_reference(), "run `make docs`"


@pytest.mark.parametrize("table", Case.model_fields)
def test_input_reference_has_every_table(table):
    assert table in input_reference.FILE.read_text(encoding="utf-8")


def test_the_conda_recipe_has_the_dependencies_of_the_program():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    recipe = (ROOT / ".ci" / "conda" / "recipe.yaml").read_text(encoding="utf-8")
    run = re.findall(r"- ([\w-]+) >=([\d.]+)", recipe.split("  run:")[1].split("tests:")[0])
    conda = {"gmsh": "python-gmsh", "matplotlib": "matplotlib-base", "lazy_loader": "lazy-loader"}
    wanted = [
        tuple(one.split(">=")) for one in (*project["dependencies"], f"python{project['requires-python']}")
    ]
    assert sorted(run) == sorted((conda.get(name, name), least) for name, least in wanted)
