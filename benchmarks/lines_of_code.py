"""Lines of each room of the packages: `python benchmarks/lines_of_code.py [FOLDER of a checkout]`.

A line is code if anything but a comment or a docstring stands on it; every string that is a statement of its own counts
as a docstring, with the blank lines in it. TOML, Jinja, CSS, JavaScript, HTML and JSON are counted beside: lines that
are not blank.
"""

from __future__ import annotations

import ast
import io
import sys
import tokenize
from collections import Counter
from pathlib import Path

PACKAGES = ("fem_seal", "leak", "meshes")
KINDS = ("files", "code", "docstrings", "comments", "blank")
BESIDE = (".toml", ".j2", ".css", ".js", ".html", ".json")
_NO_CODE = {
    tokenize.COMMENT,
    tokenize.DEDENT,
    tokenize.ENCODING,
    tokenize.ENDMARKER,
    tokenize.INDENT,
    tokenize.NEWLINE,
    tokenize.NL,
}


def counted(text: str) -> Counter[str]:
    """Lines of one Python file by what stands on them."""
    docstrings = {
        line
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
        for line in range(node.lineno, (node.end_lineno or node.lineno) + 1)
    }
    code: set[int] = set()
    comments: set[int] = set()
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT:
            comments.add(token.start[0])
        elif token.type not in _NO_CODE:
            code.update(range(token.start[0], token.end[0] + 1))
    code -= docstrings
    comments -= code | docstrings
    all_lines = len(text.splitlines())
    found = Counter(files=1, code=len(code), docstrings=len(docstrings), comments=len(comments))
    found["blank"] = all_lines - len(code) - len(docstrings) - len(comments)
    return found


def rooms(root: Path) -> dict[str, Counter[str]]:
    """Lines by room, "leak/flow"; files of a package that stand in no room are under its name."""
    found: dict[str, Counter[str]] = {}
    for package in PACKAGES:
        for path in sorted((root / package).rglob("*.py*")):
            if path.suffix not in (".py", ".pyi"):
                continue
            room = "/".join(path.relative_to(root).parts[:-1][:2])
            found.setdefault(room, Counter()).update(counted(path.read_text(encoding="utf-8")))
    return found


def beside(root: Path) -> Counter[str]:
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
    found = rooms(root)
    total = sum(found.values(), Counter())
    print(f"{'room':22}" + "".join(f"{kind:>12}" for kind in KINDS) + f"{'lines':>10}")
    for room, lines in [*sorted(found.items()), ("all", total)]:
        each = "".join(f"{lines[kind]:12,}" for kind in KINDS)
        print(f"{room:22}{each}{sum(lines[kind] for kind in KINDS[1:]):10,}")
    print("beside: " + ", ".join(f"{lines:,} {kind[1:]}" for kind, lines in sorted(beside(root).items())))


if __name__ == "__main__":
    main()
