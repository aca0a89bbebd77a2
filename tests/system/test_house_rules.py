"""Rules of the sources that no tool checks."""

import ast
import re

import pytest
from places import ROOT

from fem_seal.files import own_tables

PACKAGE = ROOT / "fem_seal"
# Rooms that solve for the contact, and so may know that today's seals have one line.
OF_ONE_LINE = {"contact", "seal", "bodies"}


def one_line(source: str) -> list[str]:
    """Where a source asks a contact or a model for its only line."""
    asked = (node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Attribute))
    chains = {ast.unparse(node) for node in asked}
    return sorted(one for one in chains if one.endswith(("contact.profile", "model.line")))


@pytest.mark.parametrize(
    "path", sorted(PACKAGE.rglob("*.py")), ids=lambda path: str(path.relative_to(PACKAGE))
)
def test_whoever_reads_a_contact_goes_through_all_of_its_lines(path):
    if path.relative_to(PACKAGE).parts[0] not in OF_ONE_LINE:
        assert one_line(path.read_text(encoding="utf-8")) == []


def test_what_asks_for_the_only_line_is_found():
    """Otherwise the test above could not fail."""
    assert one_line("peak = load.contact.profile.peak_pressure\nx = contact.model.line.x") == [
        "contact.model.line",
        "load.contact.profile",
    ]
    assert one_line("said('captions.profile', load.profiles, model.lines)") == []


@pytest.mark.parametrize(
    ("file", "functions"),
    [("findings.toml", "caution|_over"), ("problems.toml", "problem|load_problem|wrong")],
)
def test_every_check_has_its_words_and_all_words_have_a_check(file, functions):
    """A check whose words are missing would fail only where it has something to say."""
    words = own_tables(file).keys()
    code = "\n".join(path.read_text(encoding="utf-8") for path in sorted(PACKAGE.rglob("*.py")))
    assert set(re.findall(rf'\b(?:{functions})\(\s*"(\w+)"', code)) <= words
    # f"trace_{what}" asks for all that begin so
    beginnings = tuple(re.findall(r'f"(\w+_)\{', code))
    assert [one for one in words if f'"{one}"' not in code and not one.startswith(beginnings)] == []
