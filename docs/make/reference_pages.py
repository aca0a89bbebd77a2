"""Write the pages generated at every build: commands, Python names, output of the tutorial.

    python docs/make/reference_pages.py

docs/reference/cli.md comes from the registered commands, docs/reference/api/ from the public names, grouped by package,
and docs/tutorial/made/ from running the tutorial.
"""

from __future__ import annotations

import base64
import os
import re
from collections import defaultdict
from collections.abc import Iterator
from contextlib import chdir, redirect_stderr, redirect_stdout
from html import unescape
from importlib import import_module
from inspect import cleandoc
from io import StringIO
from pathlib import Path
from tempfile import TemporaryDirectory
from types import ModuleType
from typing import Any

from typer.main import get_command

import fem_seal
import leak
import meshes
from fem_seal.cli.app import app, main
from fem_seal.output.report.brief import first_line

FOLDER = Path(__file__).parents[1] / "reference"

PACKAGES = {
    fem_seal: "Cases, results, studies, and the contact for bodies of your own.",
    leak: "Rough surfaces, contact theory and flow, with plain arrays in SI; needs neither a case nor a mesh.",
    meshes: "Shapes of seats and closures, first touch, and their triangles.",
}


def commands() -> str:
    """The page of the command line, Markdown."""
    parts = [COMMANDS_HEAD]
    for path, command in _commands(get_command(app), "fem-seal"):
        arguments = [each for each in command.params if each.param_type_name == "argument"]
        options = [each for each in command.params if each.param_type_name == "option" and not each.hidden]
        usage = " ".join(
            [path, *(_argument(each) for each in arguments), *(["[OPTIONS]"] if options else [])]
        )
        parts.append(f"## {path}\n\n{cleandoc(command.help or '')}\n\n```\n{usage}\n```\n")
        rows = [
            (f"`{each.metavar or each.name.upper()}`", getattr(each, "help", "") or "", "")
            for each in arguments
        ]
        rows += [(f"`{', '.join(opt.opts)}`{_value(opt)}", opt.help or "", _default(opt)) for opt in options]
        if rows:
            parts.append(
                "| | | default |\n|---|---|---|\n" + "\n".join(f"| {' | '.join(row)} |" for row in rows)
            )
    return "\n\n".join(parts) + "\n"


COMMANDS_HEAD = """\
# The command line

`fem-seal COMMAND --help` prints the same. Results go to files, tables to stdout, progress and warnings to stderr.

| exit code | meaning |
|---|---|
| 0 | done |
| 2 | wrong input |
| 3 | no load, or no design of a study, can be calculated |
| 130 | interrupted |
| 1 | anything else, such as a full disc |"""


def _commands(group: Any, path: str) -> Iterator[tuple[str, Any]]:
    for name, command in group.commands.items():
        if command.hidden:
            continue
        if getattr(command, "commands", None):
            if command.params:
                yield f"{path} {name}", command
            yield from _commands(command, f"{path} {name}")
        else:
            yield f"{path} {name}", command


def _argument(argument: Any) -> str:
    name = argument.metavar or argument.name.upper()
    return name if argument.required else f"[{name}]"


def _value(option: Any) -> str:
    return "" if option.is_flag else f" `{option.metavar or option.name.upper()}`"


def _default(option: Any) -> str:
    default = option.show_default if isinstance(option.show_default, str) else option.default
    return "" if default in (None, False, True, (), "") or callable(default) else f"`{default}`"


def api() -> Iterator[tuple[str, str]]:
    """Names and texts of the pages of Python, reStructuredText."""
    names_text = "\n".join(f"   {package.__name__}" for package in PACKAGES)
    yield "index", f"{_heading('Python', '=')}{API_HEAD}\n\n.. toctree::\n   :maxdepth: 2\n\n{names_text}\n"
    for package, about in PACKAGES.items():
        name = package.__name__
        parts = [_heading(name, "=") + about]
        for room, names in _rooms(package).items():
            title = (
                cleandoc(import_module(room).__doc__ or "").partition("\n")[0].rstrip(".")
                if room
                else "Tables"
            )
            entries = "\n".join(f"   {name}" for name in names)
            parts.append(
                f"{_heading(title, '-')}.. currentmodule:: {name}\n\n.. autosummary::\n   :toctree: names\n\n{entries}"
            )
        yield name, "\n\n".join(parts) + "\n"


API_HEAD = """\
The stable interface: the public names of three packages. All numbers are SI. Each name has its own page with an
example that runs with the tests."""


def _rooms(package: ModuleType) -> dict[str, list[str]]:
    """Public names by their package, "leak.flow"; modules and constants without one come last."""
    rooms: dict[str, list[str]] = defaultdict(list)
    for name in package.__all__:
        if name.startswith("__"):
            continue
        object_ = getattr(package, name)
        home = getattr(object_, "__module__", None)
        room = ".".join(home.split(".")[:2]) if isinstance(home, str) else ""
        if isinstance(object_, ModuleType):
            continue
        rooms[room].append(name)
    return dict(sorted(rooms.items(), key=lambda item: item[0] or "~"))


def _heading(text: str, line: str) -> str:
    return f"{text}\n{line * len(text)}\n\n"


def check_first_pages(report: str) -> None:
    """Fail where the leak rate on the first pages, typed by hand, is not that of the tutorial's seal.

    Parameters
    ----------
    report : str
        Text of its report.

    Raises
    ------
    ValueError
    """
    for page in (FOLDER.parent / "index.md", FOLDER.parents[1] / "README.md"):
        match = re.search(r"\*\*(.*ml/min)\*\*", page.read_text(encoding="utf-8"))
        if match is None or match[1] not in report:
            raise ValueError(f"{page}: the leak rate of the first seal is not the calculated one")


def tutorial(folder: Path) -> None:
    """Write the output of the tutorial's case on the terminal and in the report.

    Parameters
    ----------
    folder : Path
        Folder of the tutorial with its case; the output goes to ``made``.
    """
    import gallery

    folder_of_results = folder / "made"
    folder_of_results.mkdir(exist_ok=True)
    with TemporaryDirectory() as place:
        copy = Path(place) / "first_seal.toml"
        copy.write_text((folder / copy.name).read_text(encoding="utf-8"), encoding="utf-8")
        (folder_of_results / "check.txt").write_text(_terminal("check", copy), encoding="utf-8")
        (folder_of_results / "run.txt").write_text(_terminal("run", copy), encoding="utf-8")
        pictures = gallery.pictures(copy.with_suffix(".out"))
        page = (copy.with_suffix(".out") / "report.html").read_text(encoding="utf-8").replace("\xa0", " ")
    for name in ("sketch", "leak"):
        (folder_of_results / f"{name}.svg").write_bytes(pictures[name][0])
    # for the first page, on which the whole would have letters that nobody can read
    (folder_of_results / "section.svg").write_bytes(gallery.first_panel(pictures["sketch"][0]))
    first = re.search(r"<strong>(.*?)</strong>", page)
    assert first is not None
    (folder_of_results / "headline.md").write_text(f"> {unescape(first[1])}\n", encoding="utf-8")
    case = fem_seal.load_case(folder / "first_seal.toml")
    check_first_pages(unescape(page))
    finer = first_line(fem_seal.run(case.replace({"roughness.Ra": "0.1 um"})))
    (folder_of_results / "finer.md").write_text(f"> {finer}\n", encoding="utf-8")
    _leak_test(folder, folder_of_results)


def _leak_test(folder: Path, out: Path) -> None:
    """Write the output of the tutorial on a leak test."""
    with TemporaryDirectory() as place:
        for name in ("leak_test.toml", "leak_test.csv"):
            (Path(place) / name).write_text((folder / name).read_text(encoding="utf-8"), encoding="utf-8")
        case = Path(place) / "leak_test.toml"
        (out / "calibrate.txt").write_text(_terminal("calibrate", case, "leak_test.csv"), encoding="utf-8")
        match = re.search(
            r'base64,([^"]+)', (case.with_suffix(".calibrated") / "report.html").read_text(encoding="utf-8")
        )
    assert match is not None
    (out / "calibration.svg").write_bytes(base64.b64decode(match[1]))


def _terminal(command: str, case: Path, *options: str) -> str:
    """A command and its output."""
    words, output, err = [command, case.name, *options], StringIO(), StringIO()
    with chdir(case.parent), redirect_stdout(output), redirect_stderr(err):
        code = main(words)
    if code:
        raise SystemExit(f"{command}: {err.getvalue()}")
    text = output.getvalue().replace(f"{case.parent}{os.sep}", "")
    return f"$ fem-seal {' '.join(words)}\n" + "\n".join(line.rstrip() for line in text.splitlines()) + "\n"


if __name__ == "__main__":
    tutorial(FOLDER.parent / "tutorial")
    (FOLDER / "cli.md").write_text(commands(), encoding="utf-8")
    (FOLDER / "api").mkdir(exist_ok=True)
    for name, text in api():
        (FOLDER / "api" / f"{name}.rst").write_text(text, encoding="utf-8")
    # autosummary does not remove pages of names that are no longer public
    for page in (FOLDER / "api" / "names").glob("*.rst"):
        package, _, name = page.stem.rpartition(".")
        if name not in import_module(package).__all__:
            page.unlink()
