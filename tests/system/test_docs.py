"""What the pages of the manual and CONTRIBUTING.md name is there, and the pages that the program names."""

import ast
import importlib
import re

import pytest
from places import ROOT

PAGES = [
    ROOT / "docs" / "developer" / "architecture.md",
    ROOT / "CONTRIBUTING.md",
    *sorted((ROOT / "docs" / "theory").glob("*.md")),
]
PACKAGES = ("fem_seal", "leak", "meshes")

WORD = re.compile(r"[A-Za-z_][\w.]*")
FILES = r"(?:fem_seal|leak|meshes|tests|docs|examples|benchmarks)/[\w./]*"


def quoted(page):
    """What stands in backticks outside of blocks of code."""
    text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    return [token.strip() for token in re.findall(r"`([^`\n]+)`", text)]


def defined():
    """Names of all classes, functions, methods, fields and constants of the packages."""
    names = set()
    for package in PACKAGES:
        for path in (ROOT / package).rglob("*.py"):
            # what an expression holds has no name of its own
            waiting = [ast.parse(path.read_text(encoding="utf-8"))]
            while waiting:
                node = waiting.pop()
                waiting += [child for child in ast.iter_child_nodes(node) if isinstance(child, ast.stmt)]
                if isinstance(node, (ast.ClassDef, ast.FunctionDef)):
                    names.add(node.name)
                elif isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
                    names.add(node.target.id)
                elif isinstance(node, ast.Assign):
                    names.update(target.id for target in node.targets if isinstance(target, ast.Name))
    return names


def resolve(dotted):
    """The object of a dotted name that begins with a package."""
    package, *names = dotted.split(".")
    found, path = importlib.import_module(package), package
    for name in names:
        path = f"{path}.{name}"
        # a field of a dataclass without default is no attribute of the class
        if name in getattr(found, "__dataclass_fields__", {}):
            return found
        found = getattr(found, name) if hasattr(found, name) else importlib.import_module(path)
    return found


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_files_named_on_the_page_exist(page):
    text = page.read_text(encoding="utf-8")
    links = [link for link in re.findall(r"\]\(([^)#]+)\)", text) if "://" not in link]
    assert not [link for link in links if not (page.parent / link).exists()]
    named = [token for token in re.findall(rf"`({FILES})`", text)]
    assert not [name for name in named if not (ROOT / name).exists()]
    assert links or named


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_functions_named_with_their_package_exist(page):
    for token in quoted(page):
        name = token.partition("(")[0]
        if name == "leak.csv":
            continue  # a result file
        if WORD.fullmatch(name) and name.split(".")[0] in PACKAGES and "." in name:
            assert resolve(name) is not None


def test_every_name_of_the_architecture_page_is_defined_somewhere():
    known, page = defined(), ROOT / "docs" / "developer" / "architecture.md"
    names = [token for token in quoted(page) if WORD.fullmatch(token)]
    missing = [
        token
        for token in names
        if token not in (*PACKAGES, "contact", "bodies", "case", "pyproject.toml")
        and token.split(".")[0] not in PACKAGES
        and not set(token.split(".")) <= known
    ]
    assert missing == []
    assert len(names) > 25


def test_a_name_that_the_architecture_page_gives_with_its_file_stands_there():
    page = (ROOT / "docs" / "developer" / "architecture.md").read_text(encoding="utf-8")
    given = re.findall(rf"`([\w.]+)`,?\s+(?:in |of |\()`((?:{'|'.join(PACKAGES)})/[\w/]+\.py)`", page)
    assert len(given) > 20
    for name, file in given:
        last, code = name.rpartition(".")[2], (ROOT / file).read_text(encoding="utf-8")
        assert re.search(rf"^\s*(def|class)? ?{last}\b( ?[:=(]|$)", code, re.MULTILINE), f"{name} in {file}"


def test_the_floors_of_the_architecture_page_are_those_of_the_contract():
    (floors,) = re.findall(
        r"```\n( fem_seal.*?)```", (ROOT / "docs" / "developer" / "architecture.md").read_text(), re.DOTALL
    )
    for package in PACKAGES:
        for room in (path.parent.name for path in (ROOT / package).glob("*/__init__.py")):
            assert re.search(rf"\b{room}\b", floors), room
    for file in re.findall(r"\b(\w+\.py)\b", floors):
        assert (ROOT / "fem_seal" / file).exists()


def test_links_of_the_manual_lead_to_files():
    """Sphinx knows where links of one page to another lead; of files outside of docs/ it does not ask."""
    manual = ROOT / "docs"
    pages = sorted(manual.glob("[!_]*/*.md"))
    assert len(pages) > 25
    for page in pages:
        links = re.findall(r"\]\(([^)#\s]+)", page.read_text(encoding="utf-8"))
        paths = [(page.parent / link).resolve() for link in links if "://" not in link]
        missing = [path for path in paths if not path.is_relative_to(manual) and not path.exists()]
        assert not missing, page


def test_pages_of_the_manual_that_the_program_names_exist():
    """Who has installed the program has no files of the repository; it names pages, "theory/form in the manual"."""
    named = {}
    for folder, kinds in (
        ("fem_seal", ("py", "toml", "j2")),
        ("leak", ("py",)),
        ("examples", ("toml", "py")),
    ):
        for path in (one for kind in kinds for one in (ROOT / folder).rglob(f"*.{kind}")):
            text = path.read_text(encoding="utf-8")
            # "guide/form and theory/form in the manual"
            for several in re.findall(r"\b((?:[a-z]+/\w+(?:, | and )?)+) in the manual", text):
                for page in re.findall(r"[a-z]+/\w+", several):
                    named.setdefault(page, path)
            if path.suffix != ".py":
                assert "docs/" not in text, path
    assert len(named) > 10
    assert not {page: path for page, path in named.items() if not (ROOT / "docs" / f"{page}.md").exists()}


def test_code_in_contributing_is_code_of_the_packages():
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    code = "".join(
        re.sub(r"\s+", "", path.read_text(encoding="utf-8"))
        for package in (*PACKAGES, "tests")
        for path in (ROOT / package).rglob("*.py")
    )
    examples = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    assert len(examples) == 3
    for example in examples:
        assert re.sub(r"\s+", "", example) in code
