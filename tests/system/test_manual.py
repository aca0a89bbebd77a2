"""The manual shows every example, and its pages say nothing that does not run."""

import json
import re
import tomllib

import gallery
import pytest
from places import ROOT
from reference_pages import check_first_pages

import fem_seal
from fem_seal.answers.closed_forms import derive
from fem_seal.case.case import Case
from fem_seal.case.notation import tables_of


def test_the_gallery_has_a_page_for_every_example():
    listed = gallery.index()
    files = [path for path in (ROOT / "examples").rglob("*.toml") if not path.parent.name.endswith(".out")]
    assert len(files) > 20
    for path in files:
        name = path.stem if path.parent.name == "examples" else f"study_{path.stem}"
        # a card and a place in the table of contents
        assert f":link: pages/{name}\n" in listed
        assert f"\npages/{name}\n" in listed
    assert "pages/notebook" in listed
    assert [name for name, _ in gallery.scripts()] == sorted(
        path.name for path in (ROOT / "examples").glob("*.py")
    )


def test_examples_in_the_groups_of_the_gallery_exist():
    names = [name for group in gallery.GROUPS.values() for name in group]
    assert sorted(set(names)) == sorted(names)
    assert set(names) <= {path.stem for path in gallery.cases()}


def test_a_kept_result_is_solved_again_after_a_change_of_the_program(tmp_path, monkeypatch):
    monkeypatch.setattr(gallery, "RESULTS", tmp_path)
    example = gallery.cases()[0]
    assert not gallery.is_kept(example)
    gallery.folder_of(example).mkdir(parents=True)
    (gallery.folder_of(example) / "page.json").write_text(json.dumps({"state": gallery.state()}))
    assert gallery.is_kept(example)
    monkeypatch.setattr(gallery, "state", lambda: "another program")
    assert not gallery.is_kept(example)


def test_pages_named_at_the_head_of_a_case_are_links():
    head = "#:schema x.json\n# As ball_cone.toml, see\n# guide/form in the manual.\n#   fem-seal run me.toml\na = 1\n"
    assert gallery.introduction(head) == (
        "As [ball_cone.toml](/cases/pages/ball_cone.md), see [guide/form](/guide/form.md) in the manual."
    )


def test_the_notebook_has_ten_lines_of_code_and_no_results_of_yesterday():
    cells = json.loads((ROOT / "examples" / "notebook.ipynb").read_text(encoding="utf-8"))["cells"]
    code = [cell for cell in cells if cell["cell_type"] == "code"]
    assert not any(cell["outputs"] or cell["execution_count"] for cell in code)
    assert len([line for cell in code for line in cell["source"] if line.strip()]) <= 10


def test_the_first_pages_have_the_leak_rate_of_the_first_seal():
    said = "The seal leaks 2.4 to 4.5 ml/min at 10 bar and {} at 50 bar."
    check_first_pages(said.format("4.9 to 10 ml/min"))
    with pytest.raises(ValueError, match="first seal"):
        check_first_pages(said.format("4.8 to 10 ml/min"))


DOCS = ROOT / "docs"
PAGES = sorted([*DOCS.glob("howto/*.md"), *DOCS.glob("tutorial/*.md")])
BLOCK = r"```toml\n(.*?)```"
INPUTS = [
    *((page.name, text) for page in PAGES for text in re.findall(BLOCK, page.read_text("utf-8"), re.DOTALL)),
    *((path.name, path.read_text("utf-8")) for path in sorted(DOCS.glob("*to*/*.toml"))),
]


def test_the_manual_has_inputs():
    assert sum("[closure]" in text for _, text in INPUTS) >= 4


@pytest.mark.parametrize(("page", "text"), INPUTS, ids=[f"{n} {page}" for n, (page, _) in enumerate(INPUTS)])
def test_inputs_of_the_how_to_pages_are_valid(page, text):
    given = tomllib.loads(text)
    if "closure" in given and "seat" in given:
        assert all(load.contact_force > 0 for load in derive(Case(**given)).loads)
        return
    # a part of a case, which goes into the example that the page is about
    case = fem_seal.load_case(ROOT / "examples" / "ball_cone.toml").replace({"leak.theory": "corrected"})
    for table, entries in given.items():
        if table == "roughness":
            case = case.replace(roughness=entries)
        else:
            (keys,) = tables_of(Case.model_fields[table])[:1]
            assert set(entries) <= set(keys.model_fields), table


@pytest.mark.slow
def test_the_relief_valve_of_the_how_to_page_is_told_as_the_page_says():
    # neither number nor verdict asks for sensitivities, which have tests of their own
    result = fem_seal.run(fem_seal.load_case(DOCS / "howto" / "relief_valve.toml"), sensitivities=False)
    # the oil lifts the poppet at pi r^2 P = spring, on a circle within the land
    for radius, sign in ((3.95e-3, 1), (4.45e-3, -1)):
        assert sign * (2500.0 / (3.14159 * radius**2) - result.loads[0].blow_off_pressure) > 0
    assert all(load.verdict for load in result.loads)


def test_commands_of_the_manual_exist():
    from fem_seal.cli.app import app

    known = {command.name or command.callback.__name__ for command in app.registered_commands}
    known |= {group.name for group in app.registered_groups}
    told = {
        (page.name, name)
        for page in DOCS.glob("*/*.md")
        for name in re.findall(r"(?:`|\$ )fem-seal ([a-z]\w*)\b", page.read_text(encoding="utf-8"))
    }
    assert len(told) > 20
    assert not {(page, name) for page, name in told if name not in known}


def test_terms_of_the_glossary_stand_there_once():
    terms = re.findall(r"^(\S.*)\n: ", (DOCS / "glossary.md").read_text(encoding="utf-8"), re.MULTILINE)
    assert len(terms) == len(set(terms)) > 30
    for term in (
        "Peklenik number",
        "roll-off",
        "percolation",
        "Persson theory",
        "poppet",
        "blow-off",
        "DN, NPS",
    ):
        assert term in terms


# What people type into the search of the manual, and the page that answers it.
SEARCHED = {
    "gasket": "guide/gasket",
    "copper ring": "guide/gasket",
    "ring joint": "guide/gasket",
    "springback": "guide/gasket",
    "95 %": "tutorial/passing_design",
    "helium leak test": "howto/flat_seat",
    "API 598": "howto/judge",
    "bolt torque": "guide/flange",
    "Ra 0.8": "guide/finish",
    "roundness": "howto/not_round",
    "relief valve": "howto/relief_valve",
    "hydrogen": "guide/fluids",
}


@pytest.mark.parametrize("words", SEARCHED)
def test_the_search_finds_the_page_of_a_word(words):
    """A main entry of the index is the first hit of a search for it."""
    text = (DOCS / f"{SEARCHED[words]}.md").read_text("utf-8")
    (entries,) = re.findall(r"^```\{index\} (.*)$", text, re.MULTILINE)
    assert f"! {words}" in entries.split(", ")
