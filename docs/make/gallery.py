"""Write docs/cases/: a page for every case and study in examples/, with its pictures and its complete report.

    python docs/make/gallery.py

A solved example is kept in docs/_build/examples and solved again only after a change of the program or of the examples.
The tests also solve the cases and keep them there, so that `make docs` after `make test` solves only the studies.
"""

from __future__ import annotations

import base64
import hashlib
import json
import os
import re
import shutil
import sys
import tomllib
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from functools import cache
from html import unescape
from multiprocessing import get_context
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fem_seal import SealResult

DOCS = Path(__file__).parents[1]
ROOT = DOCS.parent
EXAMPLES = ROOT / "examples"
RESULTS = DOCS / "_build" / "examples"
# Folders generated from the examples, next to cases/index.md.
PAGES, SCRIPTS, REPORTS = (
    DOCS / "cases" / "pages",
    DOCS / "_build" / "scripts",
    DOCS / "_build" / "with_pages" / "reports",
)

# The most informative pictures, after the section; each page shows the first two that its report has.
BEST_PICTURES = (
    "particles",
    "compression",
    "memory",
    "imprint",
    "unrolled",
    "line_load_around",
    "leak",
    "profiles",
    "stress",
)
# What is special about a case, where it is not its shape: the picture of its card.
SPECIAL = {
    "drawing_finish": "law",
    "exponential_law": "law",
    "smooth": "stress",
    "relief_valve": "leak",
    "relief_valve_350_bar": "imprint",
    "helium": "leak",
    "hot_valve": "temperature",
    "particles": "particles",
    "measured_seat": "surface",
    "measured_roundness": "line_load_around",
    "oval_seat": "unrolled",
    "tilted_poppet": "seal",
    "scratched_seat": "contact",
    "turned_seat": "law",
    "copper_ring": "compression",
    "bent_flange": "line_load_around",
    "loose_bolt": "line_load_around",
    "proof_load": "memory",
    "elastoplastic_seat": "imprint",
    "hot_coined_seat": "imprint",
}
# Groups of the cards of the index; an example without a group comes last.
GROUPS = {
    "Balls, poppets and rims": (
        "ball_cone",
        "drawing_finish",
        "ball_on_land",
        "poppet_on_land",
        "toroidal_edge_on_flat",
        "profile_from_drawing",
        "exponential_law",
        "smooth",
    ),
    "Relief valves, gases, heat, particles": (
        "relief_valve",
        "relief_valve_350_bar",
        "helium",
        "bolted_ring",
        "hot_valve",
        "diesel_1800_bar",
        "double_land",
        "particles",
    ),
    "Real seats: measured, turned, out of round, scratched": (
        "measured_seat",
        "measured_roundness",
        "turned_seat",
        "oval_seat",
        "tilted_poppet",
        "scratched_seat",
    ),
    "Gaskets": ("copper_ring", "delta_seal", "ring_joint", "bent_flange", "loose_bolt"),
    "After a larger load": ("proof_load", "elastoplastic_seat", "hot_coined_seat"),
}


def cases() -> list[Path]:
    """Case files of the examples."""
    return sorted(EXAMPLES.glob("*.toml"))


def studies() -> list[Path]:
    """Study files of the examples."""
    return sorted((EXAMPLES / "studies").glob("*.toml"))


@cache
def state() -> str:
    """One number for the state of the program and the examples, on which kept results depend."""
    digest = hashlib.sha256()
    for folder in ("fem_seal", "leak", "meshes", "examples"):
        for path in sorted((ROOT / folder).rglob("*")):
            place = path.relative_to(ROOT)
            is_result = any(part.endswith((".out", ".leak")) or part == "__pycache__" for part in place.parts)
            if path.is_file() and not is_result:
                digest.update(str(place).encode() + path.read_bytes())
    return digest.hexdigest()


def folder_of(example: Path) -> Path:
    """Folder of the kept results of an example."""
    return RESULTS / example.parent.name / example.stem


def keep(result: SealResult, example: Path) -> Path:
    """Write the results for the page of a case.

    Parameters
    ----------
    result : SealResult
    example : Path
        Its file in examples/.

    Returns
    -------
    Path
        The results folder.
    """
    from fem_seal.output.report.brief import first_line

    folder = folder_of(example)
    shutil.rmtree(folder, ignore_errors=True)
    result.write(folder, full=True)
    about = {"headline": first_line(result), "warnings": list(result.warnings), "state": state()}
    (folder / "page.json").write_text(json.dumps(about), encoding="utf-8")
    return folder


def is_kept(example: Path) -> bool:
    """Whether the results of an example exist and are up to date."""
    about = folder_of(example) / "page.json"
    return about.exists() and json.loads(about.read_text(encoding="utf-8"))["state"] == state()


def solve(example: Path) -> None:
    """Solve a case or a study and keep its results."""
    import fem_seal
    from fem_seal.units import Display

    if example.parent == EXAMPLES:
        keep(fem_seal.run(fem_seal.load_case(example)), example)
        return
    folder = folder_of(example)
    shutil.rmtree(folder, ignore_errors=True)
    result = fem_seal.load_study(example).run(folder=folder, workers=0)
    if set(result.counts) - {"done"} and any(result.counts[status] for status in ("failed", "open")):
        raise SystemExit(f"{example.name}: {result!r}, {result.reasons}")
    result.report()
    # table and picture as in a notebook, without the title, which the page has already
    table = re.sub(r"^<p>.*?</p>", "", result._repr_html_())
    is_inside = result["validity"] != "outside the theory"
    leaks = result["leak_rate_m3_per_s"][is_inside].dropna()
    span = f"{len(is_inside)} designs, {Display().leak_range((leaks.min(), leaks.max()), 2)}"
    about = {"headline": span, "warnings": [], "shown": table, "state": state()}
    (folder / "page.json").write_text(json.dumps(about), encoding="utf-8")


def solve_all() -> None:
    """Solve the examples without kept results, on all cores."""
    open_ = [example for example in (*studies(), *cases()) if not is_kept(example)]
    if not open_:
        return
    # The longest first, so that no core waits for the last one: studies, and seals that are not round.
    open_.sort(key=lambda toml: (toml.parent == EXAMPLES, "[form" not in toml.read_text(encoding="utf-8")))
    print(f"solving {len(open_)} examples", file=sys.stderr, flush=True)
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    with ProcessPoolExecutor(os.cpu_count(), mp_context=get_context("spawn")) as pool:
        list(pool.map(solve, open_))


def pictures(folder: Path) -> dict[str, tuple[bytes, str, str]]:
    """Drawing, alternative text and caption of every picture of a report."""
    page = (folder / "report.html").read_text(encoding="utf-8")
    entries = {}
    for name, figure in re.findall(r'<figure id="picture-(\w+)">(.*?)</figure>', page, re.DOTALL):
        (data,) = re.findall(r'src="data:image/svg\+xml;base64,([^"]+)"', figure)
        (alt,) = re.findall(r'alt="([^"]*)"', figure)
        (caption,) = re.findall(r"<figcaption>(.*?)</figcaption>", figure, re.DOTALL)
        entries[name] = base64.b64decode(data), unescape(alt), unescape(caption)
    return entries


def introduction(text: str) -> str:
    """The comment at the head of a case file, without the lines for programs."""
    lines = []
    for line in text.splitlines():
        if not line.startswith("#"):
            break
        if not line.startswith(("#:", "#   fem-seal")):
            lines.append(line.removeprefix("#").strip())
    # "the case of ball_cone.toml" and named pages become links
    text = re.sub(r"\b((?:guide|theory|reference)/\w+)", r"[\1](/\1.md)", " ".join(lines))
    return re.sub(r"\b(\w+)\.toml\b", lambda name: f"[{name[0]}](/cases/pages/{name[1]}.md)", text)


def case_page(example: Path) -> str:
    """The page of a case, Markdown; its pictures are written next to it."""
    name, text, folder = example.stem, example.read_text(encoding="utf-8"), folder_of(example)
    about = json.loads((folder / "page.json").read_text(encoding="utf-8"))
    files = pictures(folder)
    best = [name_of_picture for name_of_picture in BEST_PICTURES if name_of_picture in files][:2]
    seal = ["seal"] if "seal" in files else []
    names = dict.fromkeys(["sketch", SPECIAL.get(name, "sketch"), *best, *seal])
    parts = [f"# {tomllib.loads(text)['title']}", introduction(text), _shown_result(about["headline"])]
    for picture in names:
        drawing, alt, caption = files[picture]
        (PAGES / f"{name}_{picture}.svg").write_bytes(drawing)
        wide = "" if picture in ("sketch", "seal") else ":class: panels\n"
        if picture == SPECIAL.get(name, "sketch"):
            (PAGES / f"{name}_card.svg").write_bytes(first_panel(drawing))
        parts.append(f"```{{figure}} {name}_{picture}.svg\n:alt: {_line(alt)}\n{wide}\n{_line(caption)}\n```")
    if about["warnings"]:
        warnings = "\n".join(f"- {_line(warning)}" for warning in about["warnings"])
        parts.append(f"```{{dropdown}} Warnings of the program\n{warnings}\n```")
    parts.append(_report_link(f"{name}.html"))
    parts.append(
        f"## The case\n\n`examples/{example.name}`\n\n"
        f"```{{literalinclude}} /../examples/{example.name}\n:language: toml\n```"
    )
    shutil.copyfile(folder / "report.html", REPORTS / f"{name}.html")
    return "\n\n".join(part for part in parts if part) + "\n"


def study_page(example: Path) -> str:
    """The page of a study, Markdown."""
    name, text, folder = example.stem, example.read_text(encoding="utf-8"), folder_of(example)
    about = json.loads((folder / "page.json").read_text(encoding="utf-8"))
    (data,) = re.findall(r'<img src="data:image/png;base64,([^"]+)"', about["shown"])
    (PAGES / f"study_{name}.png").write_bytes(base64.b64decode(data))
    table = re.sub(r"<img [^>]*>", "", about["shown"])
    shutil.copyfile(folder / "report.html", REPORTS / f"study_{name}.html")
    return (
        f"# {tomllib.loads(text)['title']}\n\n{introduction(text)}\n\n"
        f"```{{figure}} study_{name}.png\n:alt: first response over the first parameter\n\n"
        "The first response over the first parameter, one dot for each design; the page of the study shows all "
        "responses interactively.\n```\n\n{_report_link(f'study_{name}.html', 'The page of the study')}\n\n"
        f"## The designs\n\n```{{raw}} html\n{table}\n```\n\n"
        f"## The study\n\n`examples/studies/{example.name}`\n\n"
        f"```{{literalinclude}} /../examples/studies/{example.name}\n:language: toml\n```\n"
    )


def _report_link(file: str, name: str = "The whole report") -> str:
    # Sphinx copies the reports without reading them
    return f'```{{raw}} html\n<p><a href="../../reports/{file}">{name}</a></p>\n```'


def _shown_result(headline: str) -> str:
    return f"```{{admonition}} Result\n{_line(headline)}\n```" if headline else ""


def _line(text: str) -> str:
    """Plain text on one line of Markdown."""
    return re.sub(r"([\\*_`<\[\]$])", r"\\\1", " ".join(text.split()))


def index() -> str:
    """The gallery, Markdown."""
    grouped = {name for names in GROUPS.values() for name in names}
    others = tuple(path.stem for path in cases() if path.stem not in grouped)
    parts = [INDEX]
    for group, names in (*GROUPS.items(), ("More", others)):
        cards = [_card(name) for name in names if (EXAMPLES / f"{name}.toml").exists()]
        if cards:
            parts.append(f"## {group}\n\n" + _grid(cards))
    parts.append(
        "## Studies\n\nMany designs of one case.\n\n" + _grid([_study_card(study) for study in studies()])
    )
    parts.append(SCRIPTS_AND_NOTEBOOK)
    contents = "\n".join(
        [*(f"pages/{case.stem}" for case in cases()), *(f"pages/study_{case.stem}" for case in studies())]
    )
    parts.append(f"```{{toctree}}\n:hidden:\n\n{contents}\npages/notebook\nscripts/index\n```")
    return "\n\n".join(parts) + "\n"


INDEX = """\
# Cases

Every case file, study and script of `examples/`, solved by this version of the program. Each page shows the section,
the result and the complete input to start from, and links to the complete report."""

SCRIPTS_AND_NOTEBOOK = """\
## In Python

- [A notebook of ten lines](pages/notebook.ipynb)
- [Scripts](scripts/index.rst): single tasks, in closed form or with your own arrays"""


def _grid(cards: list[str]) -> str:
    return "````{grid} 1 2 2 3\n:gutter: 3\n\n" + "\n\n".join(cards) + "\n````"


def _card(name: str) -> str:
    title = tomllib.loads((EXAMPLES / f"{name}.toml").read_text(encoding="utf-8"))["title"]
    return (
        f"```{{grid-item-card}} {title}\n:img-top: pages/{name}_card.svg\n:link: pages/{name}\n:link-type: doc\n"
        f"{_number(name)}\n```"
    )


# On the left of a panel, for its numbers [pt].
_MARGIN = 49.0


def first_panel(drawing: bytes) -> bytes:
    """A picture cut after the first of its panels, in a size that can be read on a card."""
    text = drawing.decode()
    frames = re.findall(r'<g id="axes_\d+">\s*<g id="patch_\d+">\s*<path d="([^"]*)"', text)
    lefts = [min(float(x) for x in re.findall(r"[ML] ?([\d.]+) ", frame)) for frame in frames]
    # every panel has the same margin on its left; one that is true to scale is drawn in the middle of its own
    wide = f"{lefts[1] - _MARGIN:.6g}" if len(lefts) > 1 and lefts[1] > lefts[0] else r"\g<width>"
    size = r'width="[\d.]+pt" height="(?P<high>[\d.]+)pt" viewBox="0 0 (?P<width>[\d.]+) '
    return re.sub(size, rf'width="{wide}pt" height="\g<high>pt" viewBox="0 0 {wide} ', text, count=1).encode()


def _number(name: str) -> str:
    """What the seal leaks under its last load, from the first line of its report; empty before it is solved."""
    about = folder_of(EXAMPLES / f"{name}.toml") / "page.json"
    if not about.exists():
        return ""
    first = json.loads(about.read_text(encoding="utf-8"))["headline"].partition(". ")[0]
    amount = re.sub(r" \(.*?\)", "", first.removeprefix("Leaks ").partition("; ")[0])
    return f"**{_line(amount)}**"


def _study_card(path: Path) -> str:
    title, about = tomllib.loads(path.read_text(encoding="utf-8"))["title"], folder_of(path) / "page.json"
    number = json.loads(about.read_text(encoding="utf-8"))["headline"] if about.exists() else ""
    return (
        f"```{{grid-item-card}} {title}\n:img-top: pages/study_{path.stem}.png\n:link: pages/study_{path.stem}\n"
        f":link-type: doc\n{number and f'**{_line(number)}**'}\n```"
    )


def scripts() -> Iterator[tuple[str, str]]:
    """Names and texts of the scripts for sphinx-gallery, with a heading in the docstring."""
    for path in sorted(EXAMPLES.glob("*.py")):
        title, _, rest = path.read_text(encoding="utf-8").removeprefix('"""').partition("\n")
        title = title.rstrip(".")
        # sphinx-gallery runs a script in its folder, but not as a file
        rest = rest.replace("Path(__file__)", f'Path("{path.name}")')
        yield path.name, f'"""\n{title}\n{"=" * len(title)}\n{rest}'


def write() -> None:
    """Write pages, pictures, reports, scripts and the notebook."""
    for folder in (PAGES, SCRIPTS, REPORTS):
        folder.mkdir(parents=True, exist_ok=True)
    for case in cases():
        _write(PAGES / f"{case.stem}.md", case_page(case))
    for study in studies():
        _write(PAGES / f"study_{study.stem}.md", study_page(study))
    _write(DOCS / "cases" / "index.md", index())
    for name, text in scripts():
        _write(SCRIPTS / name, text)
    _write(SCRIPTS / "GALLERY_HEADER.rst", "Scripts\n=======\n\nShort scripts; each prints one result.\n")
    # files that scripts and notebook read
    for path in EXAMPLES.iterdir():
        if path.suffix in (".csv", ".toml", ".ipynb"):
            for folder in (PAGES,) if path.suffix == ".ipynb" else (PAGES, SCRIPTS):
                _write(folder / path.name, path.read_text(encoding="utf-8"))


def _write(path: Path, text: str) -> None:
    """Write a file only if it changes, so that Sphinx does not read unchanged pages again."""
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    solve_all()
    write()
