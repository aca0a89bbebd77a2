"""What an assistant reads of the manual: each page as Markdown, and the list of them."""

import re

import pytest
from markdown_pages import INCLUDED, plain
from places import ROOT
from sphinx.application import Sphinx

MANUAL = ROOT / "docs"


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """A small manual, built like the real one."""
    place = tmp_path_factory.mktemp("manual")
    pages = {
        "index": "# Seals\n\nLeakage of seals,\nfrom one file.\n\n```{toctree}\n:hidden:\n\nhowto/index\nnames\n```\n",
        "howto/index": "---\nmyst: {}\n---\n\n# How to\n\n```{toctree}\nstudy\n```\n",
        "howto/study": "# Run a study\n\n```{literalinclude} ../study.toml\n:language: toml\n```\n\nIt ends.\n",
        "names": "# Names\n\nOf columns.\n",
        "unlisted": "---\norphan: true\n---\n\n# Elsewhere\n",
    }
    for name, text in pages.items():
        (place / name).parent.mkdir(exist_ok=True)
        (place / f"{name}.md").write_text(text)
    (place / "study.toml").write_text('base = "ball.toml"\n')
    (place / "conf.py").write_text('extensions = ["myst_parser", "markdown_pages"]\n')
    out = place / "out"
    Sphinx(place, place, out, place / "doctrees", "html", status=None, warningiserror=True).build()
    return out


def test_a_page_is_beside_its_html_and_holds_what_it_shows(built):
    assert (built / "howto" / "study.html").is_file()
    text = (built / "howto" / "study.md").read_text()
    assert text == '# Run a study\n\n```toml\nbase = "ball.toml"\n```\n\nIt ends.\n'
    assert (built / "howto" / "index.md").read_text() == "# How to\n"


def test_the_list_has_every_page_in_its_section(built):
    lines = (built / "llms.txt").read_text().splitlines()
    assert lines[:3] == ["# Seals", "", "> Leakage of seals, from one file."]
    listed = [line for line in lines if line.startswith(("##", "- "))]
    assert listed == [
        "## How to",
        "- [How to](howto/index.md)",
        "- [Run a study](howto/study.md)",
        "## Names",
        "- [Names](names.md)",
    ]
    assert all((built / place).is_file() for place in re.findall(r"\]\((.+?)\)", "\n".join(listed)))


def test_every_file_that_the_manual_includes_is_found_as_such():
    text = "\n".join(page.read_text() for page in MANUAL.rglob("*.md") if "_build" not in page.parts)
    directives = re.findall(r"^```\{(?:literal)?include\}", text, re.M)
    assert len(directives) > 10 and len(INCLUDED.findall(text)) == len(directives)
    # what the list says of the program
    assert (
        plain(MANUAL / "index.md", MANUAL)
        .split("\n\n")[1]
        .startswith("Leakage of metal seals from one case file")
    )
