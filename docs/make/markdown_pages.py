"""The pages of the manual as Markdown beside the HTML, and llms.txt, which lists them: for assistants."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

INCLUDED = re.compile(r"^```\{(literalinclude|include)\} (\S+)\n(?::language: (\w+)\n|:[^\n]*\n)*```$", re.M)
_FRONT = re.compile(r"\A---\n.*?\n---\n+", re.S)
_TOCTREE = re.compile(r"^```\{toctree\}.*?^```\n*", re.S | re.M)


def write_pages(app: Any, error: Exception | None) -> None:
    """Write them after a build of HTML.

    Parameters
    ----------
    app : sphinx.application.Sphinx
    error : Exception or None
        Why the build failed.
    """
    if error is not None or app.builder.name != "html":
        return
    source, out = Path(app.srcdir), Path(app.outdir)
    for name in pages(app.env):
        target = out / f"{name}.md"
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(plain(source / f"{name}.md", source), encoding="utf-8")
    (out / "llms.txt").write_text("\n".join(index(app.env, source)), encoding="utf-8")


def plain(file: Path, root: Path) -> str:
    """A page as it is read without Sphinx: files are included, lists of pages are left out.

    Parameters
    ----------
    file, root : Path
        The page, and the folder of the manual.
    """

    def included(match: re.Match[str]) -> str:
        kind, path, language = match.groups()
        place = root / path.lstrip("/") if path.startswith("/") else file.parent / path
        text = place.read_text(encoding="utf-8").rstrip()
        return text if kind == "include" else f"```{language or ''}\n{text}\n```"

    text = _TOCTREE.sub("", _FRONT.sub("", file.read_text(encoding="utf-8")))
    return INCLUDED.sub(included, text).rstrip() + "\n"


def pages(env: Any) -> list[str]:
    """Names of the pages that are written in Markdown, in the order of the manual."""
    return [name for name in _in_order(env, env.config.root_doc) if str(env.doc2path(name)).endswith(".md")]


def _in_order(env: Any, name: str) -> Iterator[str]:
    yield name
    for inner in env.toctree_includes.get(name, ()):
        yield from _in_order(env, inner)


def index(env: Any, source: Path) -> Iterator[str]:
    """Lines of llms.txt: what the program is, and its pages, those of a section below its title.

    Parameters
    ----------
    env : sphinx.environment.BuildEnvironment
    source : Path
        The folder of the manual.
    """
    root, names = env.config.root_doc, pages(env)
    about = plain(source / f"{root}.md", source).split("\n\n")[1]
    yield f"# {env.titles[root].astext()}\n\n> {' '.join(about.split())}\n"
    yield "`fem-seal mcp` answers an assistant directly: howto/assistant.md."
    for section in env.toctree_includes[root]:
        inside = [name for name in _in_order(env, section) if name in names]
        if inside:
            yield f"\n## {env.titles[section].astext()}\n"
            yield from (f"- [{env.titles[name].astext()}]({name}.md)" for name in inside)
    yield ""


def setup(app: Any) -> dict[str, bool]:
    """Let Sphinx call it."""
    app.connect("build-finished", write_pages)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
