"""Public names of the packages: typed, loaded on first use, and no others."""

import ast
import inspect
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from places import ROOT

import fem_seal
import fem_seal.contact
import leak
import meshes


def test_every_public_name_is_there():
    for name in fem_seal.__all__:
        assert getattr(fem_seal, name) is not None
    for name in fem_seal.contact.__all__:
        assert getattr(fem_seal.contact, name) is not None
    for name in leak.__all__:
        assert getattr(leak, name) is not None


def test_completion_offers_what_is_meant_and_nothing_else():
    # submodules and helpers are attributes of the package as soon as something loads them
    for package in (fem_seal, fem_seal.contact, leak, leak.direct, meshes):
        assert dir(package) == sorted(package.__all__)


LAZY = pytest.mark.parametrize(
    "package", [fem_seal, fem_seal.contact, leak, leak.direct, meshes], ids=lambda one: one.__name__
)


@LAZY
def test_the_type_checker_knows_every_name(package):
    stub = ast.parse(Path(package.__file__).with_suffix(".pyi").read_text(encoding="utf-8"))
    exported = {alias.asname for node in stub.body for alias in node.names if alias.asname == alias.name}
    assert exported == set(package.__all__)


@LAZY
def test_importing_the_package_loads_nothing_heavy(package):
    code = (
        f"import sys, {package.__name__}; print(sorted({{'numpy', 'scipy', 'pydantic'}} & set(sys.modules)))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True
    )
    assert done.stdout.strip() == "[]"


def test_public_functions_say_their_units_and_show_an_example():
    functions = {
        f"{package.__name__}.{name}": inspect.getdoc(getattr(package, name))
        for package in (fem_seal, fem_seal.contact, leak, leak.direct, meshes)
        for name in package.__all__
        if inspect.isfunction(getattr(package, name))
    }
    assert len(functions) > 100
    without_unit = [name for name, text in functions.items() if not re.search(r"\[[^\]\d][^\]]*\]", text)]
    without_example = [name for name, text in functions.items() if ">>>" not in text]
    # whether a fluid is a gas has no unit
    assert len(without_unit) <= 0.1 * len(functions), without_unit
    assert len(without_example) <= 0.1 * len(functions), without_example


# The type checker reads the packages as in a user's script; the stubs of these libraries would take it half a minute.
LEAN = """
[mypy]
ignore_missing_imports = true
[mypy-fem_seal.*,leak.*,meshes.*]
ignore_errors = true
[mypy-numpy.*,scipy.*,pandas.*,matplotlib.*,optuna.*,IPython.*,dask.*,distributed.*,jinja2.*,rich.*,pint.*,pydantic.*,pydantic_core.*,typer.*]
follow_imports = skip
follow_imports_for_stubs = true
"""


@pytest.mark.slow
def test_the_type_checker_knows_what_run_returns(tmp_path):
    (tmp_path / "mypy.ini").write_text(LEAN)
    script = tmp_path / "script.py"
    script.write_text(
        "import fem_seal\n"
        "reveal_type(fem_seal.run)\n"
        'reveal_type(fem_seal.run(fem_seal.load_case("case.toml")).loads[0].fluid_pressure)\n'
        'reveal_type(fem_seal.load_study("study.toml").run())\n'
        "reveal_type(fem_seal.contact.solve)\n"
    )
    done = subprocess.run(
        [sys.executable, "-m", "mypy", "--cache-dir", os.devnull, str(script)],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=300,
        env={**os.environ, "MYPYPATH": str(ROOT)},
    )
    run, pressure, study, solve = re.findall(r'Revealed type is "(.*)"', done.stdout)
    assert run.startswith("def (case: fem_seal.case.case.Case")
    assert run.endswith("-> fem_seal.result.SealResult")
    assert pressure.endswith("float")
    assert study == "fem_seal.studies.results.StudyResult"
    assert solve.endswith("-> fem_seal.contact.solution.ContactSolution")


# Tables and types, which have no docstring of their own.
DATA = {"FLUIDS", "GASES", "LineProfile", "__version__"}
PUBLIC = [
    (package, name) for package in (fem_seal, leak, meshes) for name in package.__all__ if name not in DATA
]


@pytest.mark.parametrize(("package", "name"), PUBLIC, ids=lambda one: getattr(one, "__name__", one))
def test_every_public_name_has_a_docstring_with_an_example(package, name):
    thing = getattr(package, name)
    text = inspect.getdoc(thing) or ""
    assert ">>> " in text
    if inspect.isfunction(thing):
        documented = set(re.findall(r"^([\w, ]+?) : ", text, re.MULTILINE))
        documented = {one.strip() for names in documented for one in names.split(",")}
        described = {*documented, *re.findall(r"\b\w+\b", text.partition(">>> ")[0])}
        # a number or a word needs its unit or its choices; a parameter of a type of its own says what it is
        plain = re.compile(r"\b(float|int|str|ArrayLike|FloatArray)\b")
        parameters = inspect.signature(thing).parameters.values()
        missing = {one.name for one in parameters if plain.search(str(one.annotation))} - described
        assert not missing, f"{name} says nothing about {missing}"


TAKE_A_CASE = [
    name
    for name in fem_seal.__all__
    if inspect.isfunction(one := getattr(fem_seal, name)) and "case" in inspect.signature(one).parameters
]


def test_the_functions_that_take_a_case_are_known():
    assert {
        "run",
        "direct",
        "direct_seal",
        "derive",
        "leak_map",
        "leak_of_pressure_map",
        "applied_force_for_leak",
        "blow_off_pressures",
        "calibrate",
    } == set(TAKE_A_CASE)


@pytest.mark.parametrize("name", [*TAKE_A_CASE, "Study"])
def test_what_takes_a_case_takes_its_file_and_its_tables(name, tmp_path):
    """Each comes as far as to say what is wrong inside, wherever the case is from."""
    tables = {"closure": {"shape": "ball"}}
    path = tmp_path / "case.toml"
    path.write_text('[closure]\nshape = "ball"\n', encoding="utf-8")
    more = ["measured.csv"] if name == "calibrate" else []
    before = ["map.vtu"] if name == "leak_of_pressure_map" else []
    for source in (path, str(path), tables):
        with pytest.raises(fem_seal.InputError, match=r"closure\.radius: is missing"):
            getattr(fem_seal, name)(*before, source, *more)
    with pytest.raises(
        fem_seal.InputError, match="must be a Case, the path of a case file or its tables, not int"
    ):
        getattr(fem_seal, name)(*before, 3, *more)


def test_a_file_and_a_case_of_it_give_the_same():
    case = fem_seal.load_case(ROOT / "examples" / "smooth.toml")
    told = [
        fem_seal.derive(source).initial_contact_radius
        for source in (case, case.file, str(case.file), case.written)
    ]
    assert told == [case.initial_contact_radius] * 4


def test_the_page_of_stability_has_every_public_name_in_one_tier():
    page = (ROOT / "docs" / "reference" / "stability.md").read_text(encoding="utf-8")
    stable, research = page.split("## Stable")[1].split("## Internal")[0].split("## Research")
    for package in (fem_seal, leak, meshes):
        found = [
            re.findall(r"`(\w+)`", line.split(":", 1)[1])
            for tier in (stable, research)
            for line in tier.splitlines()
            if line.startswith(f"**`{package.__name__}`**")
        ]
        assert len(found) == 2
        assert sorted(found[0] + found[1]) == sorted(package.__all__)
