"""Lines of each room of the packages: `python benchmarks/lines_of_code.py [FOLDER of a checkout]`.

A line is code if anything but a comment or a docstring stands on it; every string that is a statement of its own counts
as a docstring, with the blank lines in it. TOML, Jinja, CSS, JavaScript, HTML and JSON are counted beside: lines that
are not blank.
"""

from __future__ import annotations

import ast
import sys
from collections import Counter
from pathlib import Path

PACKAGES = ("fem_seal", "leak", "meshes")
KINDS = ("files", "code", "docstrings", "comments", "blank")
BESIDE = (".toml", ".j2", ".css", ".js", ".html", ".json")


def count_lines(text: str) -> Counter[str]:
    """Lines of one Python file by what stands on them."""
    docstrings: set[int] = set()
    texts: set[int] = set()
    tree = ast.parse(text)
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant | ast.JoinedStr) and node.end_lineno != node.lineno:
            # a line of a text may look like a comment, or be blank
            texts.update(_lines(node))
        if (
            isinstance(node, ast.Expr)
            and isinstance(node.value, ast.Constant)
            and isinstance(node.value.value, str)
        ):
            docstrings.update(_lines(node))
    counts = Counter(files=1, code=0, docstrings=0, comments=0, blank=0)
    for number, line in enumerate(map(str.strip, text.splitlines()), start=1):
        if number in docstrings:
            counts["docstrings"] += 1
        elif number in texts:
            counts["code"] += 1
        else:
            counts["blank" if not line else "comments" if line.startswith("#") else "code"] += 1
    return counts


def _lines(node: ast.expr | ast.stmt) -> range:
    return range(node.lineno, (node.end_lineno or node.lineno) + 1)


def rooms(root: Path) -> dict[str, Counter[str]]:
    """Lines by room, "leak/flow"; files of a package that stand in no room are under its name."""
    counts: dict[str, Counter[str]] = {}
    for package in PACKAGES:
        for path in sorted((root / package).rglob("*.py*")):
            if path.suffix not in (".py", ".pyi"):
                continue
            room = "/".join(path.relative_to(root).parts[:-1][:2])
            counts.setdefault(room, Counter()).update(count_lines(path.read_text(encoding="utf-8")))
    return counts


def count_other_lines(root: Path) -> Counter[str]:
    """Lines of other files in the packages that are not blank, by their kind."""
    return Counter(
        path.suffix
        for package in PACKAGES
        for path in sorted((root / package).rglob("*"))
        if path.suffix in BESIDE
        for line in path.read_text(encoding="utf-8").splitlines()
        if line.strip()
    )


def main() -> None:
    """Print the table."""
    root = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parents[1]
    counts = rooms(root)
    total = sum(counts.values(), Counter())
    print(f"{'room':22}" + "".join(f"{kind:>12}" for kind in KINDS) + f"{'lines':>10}")
    for room, lines in [*sorted(counts.items()), ("all", total)]:
        each = "".join(f"{lines[kind]:12,}" for kind in KINDS)
        print(f"{room:22}{each}{sum(lines[kind] for kind in KINDS[1:]):10,}")
    print(
        "beside: "
        + ", ".join(f"{lines:,} {kind[1:]}" for kind, lines in sorted(count_other_lines(root).items()))
    )


if __name__ == "__main__":
    main()
