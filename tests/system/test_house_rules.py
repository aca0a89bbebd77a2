"""Rules of the sources that no tool checks."""

import ast
import re
import tomllib
from dataclasses import fields

import house
import pytest
from lines_of_code import rooms
from places import ROOT

from fem_seal.files import own_tables
from fem_seal.seal.load_result import LoadResult
from fem_seal.seal.problem import SealProblem

PACKAGE = ROOT / "fem_seal"
# Rooms that solve for the contact, and so may take the land that is pressed hardest for all of it.
OF_ONE_LAND = {"contact", "seal", "bodies"}


def one_land(source: str) -> list[str]:
    """Where a source asks a contact for the profile of one of its lands."""
    asked = (node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Attribute))
    return sorted({chain for chain in map(ast.unparse, asked) if chain.endswith("contact.profile")})


@pytest.mark.parametrize(
    "path", sorted(PACKAGE.rglob("*.py")), ids=lambda path: str(path.relative_to(PACKAGE))
)
def test_whoever_reads_a_contact_goes_through_all_of_its_lands(path):
    if path.relative_to(PACKAGE).parts[0] not in OF_ONE_LAND:
        assert one_land(path.read_text(encoding="utf-8")) == []


def test_what_asks_for_one_land_is_found():
    """Otherwise the test above could not fail."""
    assert one_land("peak = load.contact.profile.peak_pressure") == ["load.contact.profile"]
    assert one_land("said('captions.profile', load.profiles)") == []


@pytest.mark.parametrize(
    ("file", "functions"),
    [("findings.toml", "caution|_over"), ("problems.toml", "problem|problem_of")],
)
def test_every_check_has_its_words_and_all_words_have_a_check(file, functions):
    """A check whose words are missing would fail only where it has something to say."""
    words = own_tables(file).keys()
    code = "\n".join(path.read_text(encoding="utf-8") for path in sorted(PACKAGE.rglob("*.py")))
    assert set(re.findall(rf'\b(?:{functions})\(\s*"(\w+)"', code)) <= words
    # f"trace_{what}" asks for all that begin so
    beginnings = tuple(re.findall(r'f"(\w+_)\{', code))
    assert [one for one in words if f'"{one}"' not in code and not one.startswith(beginnings)] == []


# Every calculation goes through these two: a field more is an option more that all of the program has to know.
FIELDS = {
    LoadResult: {
        "applied_force",
        "contact",
        "fluid_pressure",
        "circumference",
        "mesh_error",
        "opening",
        "rough",
    },
    SealProblem: {
        "at_rest",
        "contact",
        "contact_size",
        "file",
        "flow",
        "form",
        "gasket",
        "given_law",
        "interface",
        "loads",
        "materials",
        "origin",
        "supports",
        "surface",
    },
}


@pytest.mark.parametrize("kind", FIELDS, ids=lambda kind: kind.__name__)
def test_a_feature_is_a_scenario_or_an_answer_and_no_field(kind):
    assert {field.name for field in fields(kind)} <= FIELDS[kind], "make it a scenario or an answer instead"


def test_the_program_has_no_more_code_than_its_ceiling():
    code = sum(lines["code"] for lines in rooms(ROOT).values())
    ceiling = tomllib.loads(house.CEILINGS.read_text(encoding="utf-8"))["code_lines"]
    assert code <= ceiling, f"{house.RAISED}: {code - ceiling} lines above the ceiling in {house.CEILINGS}"


SOURCE = """
from leak.theory import persson
import re as theory_of_texts

WIDE, NARROW = 2.0, 1.0
NAMES = ("a", "b")

class Load:
    \"\"\"A load in both theories.\"\"\"

    force: float
    _own: int = 0
    TURNS = 3

    @cached_property
    def leak(self):
        return self.by_theory["leak.theory"]

    @lru_cache(maxsize=3)
    def _hidden(self): ...
"""


def test_what_is_counted_of_the_house():
    names = house.names_in(SOURCE)
    # neither where something is imported from nor what is said of it
    assert {name for name in names if "theor" in name} == {"by_theory", '"leak.theory"'}
    assert house.members("Load", {"load.py": SOURCE}) == (("force", "_own"), ("force", "TURNS", "leak"))
    assert (house.module_numbers(SOURCE), house.caches(SOURCE)) == (1, 2)


def test_a_name_that_is_gone_does_not_pass_for_less_knowledge():
    axis = house.Axis((r"by_theory", r"other_theory"), r"theor(y|ies)")
    known = house.files_that_know(axis, {"load.py": SOURCE, "force.py": "force = 1.0  # by no theory"})
    assert known == house.AxisFiles(("load.py",), 2, ("other_theory",))


# Words of earlier versions for which the field has others.
GONE = (
    "levers?",
    "few waves",
    "usual (?:surface|finish)",
    "uncertain inputs?",
    "own error",
    "as given",
    "both readings",
    "claimed",
    "unless the calculation is off",
    "what helps most",
    "largest part of the interval",
    "circle of first touch",
    "asperities that never yield",
    "with doubt",
    "this is no probability",
    "stand-in",
)


def test_texts_have_the_words_of_the_field() -> None:
    templates = ROOT / "fem_seal" / "templates"
    texts = {file: file.read_text("utf-8") for file in templates.rglob("*.j2")}
    for name in ("findings.toml", "problems.toml"):
        entries = tomllib.loads((templates / name).read_text("utf-8")).values()
        parts = [part for entry in entries for part in entry.values() if isinstance(part, str)]
        texts[templates / name] = "\n".join(parts)
    for file, text in texts.items():
        said = re.sub(r"{[{%#].*?[}%#]}", " ", text, flags=re.DOTALL)
        assert re.findall(rf"(?i)\b(?:{'|'.join(GONE)})\b", said) == [], file.name
