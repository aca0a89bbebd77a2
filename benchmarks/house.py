"""How much of the program an option touches: `python benchmarks/house.py [FOLDER of a checkout] [--check]`.

Prints each figure beside its ceiling, which stands in `ceilings.toml`; `--check` ends with 1 where one is above it.

- **Entered files**: of `fem_seal`, `leak` and `meshes`, those of which a run of `examples/ball_cone.toml` calls a
  function. What runs while modules are imported (bodies of modules and classes, decorators) does not count, nor do
  nameless functions and comprehensions, nor processes that the run starts.
- **Members and fields** of the two objects that all calculations go through: public ones, as they stand in the class.
- **Files that know an axis**: those of `fem_seal` and `leak` in whose code one of its `NAMES` stands: a class,
  function, attribute, argument or key, each with the other names of the same thing. Docstrings, comments, sentences and
  the paths of imports do not count; "with prose" counts them, too, by one pattern for all of a file's text. A name that
  matches nothing any more makes `--check` fail: it is to be replaced by the new name of the thing, or goes with the
  thing, so that a renaming alone lowers no figure.
- **Numbers**: assignments of a module in whose value a number stands. **Caches**: functions and properties that keep
  what they return, and `KeyedStore`.
- **Code lines**: see `lines_of_code.py`.
"""

from __future__ import annotations

import ast
import re
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import CodeType, FrameType
from typing import Any

from lines_of_code import PACKAGES, rooms

HERE = Path(__file__).parent
CEILINGS = HERE / "ceilings.toml"
CASE = "examples/ball_cone.toml"
RAISED = "raising a ceiling needs a line in CHANGELOG.md that says by how much and for what"


@dataclass(frozen=True)
class Axis:
    """What can be otherwise in a calculation, by the names that it has in the code.

    Parameters
    ----------
    names : tuple of str
        Regular expressions, each found in at least one name or key; keys begin and end with a quotation mark.
    prose : str
        Regular expression of what is written about it.
    another_thing_in : tuple of str
        Ends of the paths of files in which these names are those of something else.
    """

    names: tuple[str, ...]
    prose: str
    another_thing_in: tuple[str, ...] = ()


AXES = {
    # the two theories of the rough contact, and what only one of them has: C_pl at a pressure that acts. Not what is
    # outside both of them, nor the error that a scenario's leak rate has by direct simulation, whichever theory it is
    # by, nor the paper on which plotly draws
    "theory": Axis(
        (
            r"(?i)(?<!outside_)theor(y|ies)(?!_error$)",
            r"paper",
            r"(?i)corrected",
            r"READINGS",
            r"equivalent_elastic_surface",
            r"equivalent_pressure",
            r"separation_width",
        ),
        r"theory|theories",
        ("explore/figures.py", "studies/plots.py"),
    ),
    # what becomes of asperities that yield; not the readings of an instrument, which calibrations are about
    "reading": Axis(
        (r"(?<!th)(?<!Th)(?<!calibrate_)(?i:reading)", r"(?i)\W?capped", r"(?i)conserved", r"^VON_MISES$"),
        r"\b[Rr]eadings?\b|\bReading",
        ("answers/calibration.py", "answers/conflict.py", "output/calibration.py", "testplan.py"),
    ),
    # the two flanges of a gasket; not the parts of a seal, through which the others loop: contacts that are solved by
    # themselves and leak side by side, whatever they are
    "face": Axis(
        (
            r"lower_half",
            r"of_all_faces",
            r"(lower|upper)_flange",
            r"unlike_flanges",
            r"GasketLoad",
            r"upper_share",
        ),
        r"lower_half|GasketLoad|lower flange",
    ),
    # loads that the seal has carried before
    "memory": Axis(
        (
            # not the memory of the machine, of an iteration, of the live page or of standards that are cited by it, nor
            # the largest file or map that is read
            r"(?i)(load|local|direct|with|and)_?memory$",
            r"remember(s|ed)$",
            r"(?i)earlier",
            r"(?i)first_loading",
            r"on_new_(surfaces|faces)",
            r"after_(largest|tightening)",
            r"log_largest",
            r"^largest_before$",
            r"^history$",
            r"unload(ing)?$",
        ),
        r"memory|earlier",
    ),
    # a seal that is not round
    "around": Axis(
        (r"(?i)around", r"(?i)circumference", r"FormError", r"(?i)\bform\b", r"(?i)harmonic"),
        r"around",
    ),
    # states of knowledge, whichever they are: what an option is to become
    "scenario": Axis((r"(?i)scenario", r"alternatives_on_contact", r"(?i)own_contacts?"), r"[Ss]cenario"),
}


def code_files(root: Path, packages: tuple[str, ...] = PACKAGES) -> dict[str, str]:
    """Text of each Python file, by its path from the root."""
    return {
        str(path.relative_to(root)): path.read_text(encoding="utf-8")
        for package in packages
        for path in sorted((root / package).rglob("*.py"))
    }


def names_in(text: str) -> set[str]:
    """Names in the code of a file, with its keys in quotation marks: texts of one word, as `leak.theory`."""
    tree = ast.parse(text)
    statements = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    return {
        name
        for node in ast.walk(tree)
        for name in _names(node)
        if not (isinstance(node, ast.Constant) and id(node) in statements)
    }


def _names(node: ast.AST) -> Iterator[str]:
    match node:
        case ast.Name(id=name) | ast.Attribute(attr=name) | ast.arg(arg=name) | ast.alias(name=name):
            yield name.rpartition(".")[2]
        case ast.FunctionDef(name=name) | ast.ClassDef(name=name) | ast.keyword(arg=str(name)):
            yield name
        case ast.Constant(value=str(text)) if re.fullmatch(r"[\w.\-]+", text):
            yield f'"{text}"'


@dataclass(frozen=True)
class AxisFiles:
    """Files that know an axis.

    Parameters
    ----------
    files : tuple of str
        By their names and keys.
    with_prose : int
        By what is written in them, docstrings and comments as well.
    unmatched : tuple of str
        Expressions that nothing matches.
    """

    files: tuple[str, ...]
    with_prose: int
    unmatched: tuple[str, ...]


def files_that_know(axis: Axis, files: Mapping[str, str]) -> AxisFiles:
    """Files that know an axis, of those whose text is given."""
    names = {path: names_in(text) for path, text in files.items()}
    all_names = set().union(*names.values())
    matches = {
        expression: {name for name in all_names if re.search(expression, name)} for expression in axis.names
    }
    of_axis = set().union(*matches.values())
    return AxisFiles(
        tuple(
            path
            for path, names_of_file in names.items()
            if names_of_file & of_axis and not path.endswith(axis.another_thing_in or ("/",))
        ),
        sum(re.search(axis.prose, text) is not None for text in files.values()),
        tuple(expression for expression, names_of_it in matches.items() if not names_of_it),
    )


def members(name: str, files: Mapping[str, str]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Fields of a dataclass, and all its public members, as they stand in its body."""
    for text in files.values():
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.ClassDef) and node.name == name:
                return _members(node)
    raise LookupError(f"there is no class {name}")


def _members(body: ast.ClassDef) -> tuple[tuple[str, ...], tuple[str, ...]]:
    fields = [
        node.target.id
        for node in body.body
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name)
    ]
    others = {
        name
        for node in body.body
        for name in (
            [node.name]
            if isinstance(node, ast.FunctionDef)
            else [target.id for target in node.targets if isinstance(target, ast.Name)]
            if isinstance(node, ast.Assign)
            else []
        )
    }
    public = [name for name in (*fields, *sorted(others)) if not name.startswith("_")]
    return tuple(fields), tuple(public)


def module_numbers(text: str) -> int:
    """Assignments of a module in whose value a number stands."""
    return sum(
        any(_is_number(node) for node in ast.walk(statement.value))
        for statement in ast.parse(text).body
        if isinstance(statement, ast.Assign | ast.AnnAssign) and statement.value is not None
    )


def _is_number(node: ast.AST) -> bool:
    return isinstance(node, ast.Constant) and type(node.value) in (int, float)


def caches(text: str) -> int:
    """Functions and properties that keep what they return, and stores of a given size."""
    tree = ast.parse(text)
    decorators = [
        ast.unparse(decorator).partition("(")[0].split(".")[-1]
        for node in ast.walk(tree)
        if isinstance(node, ast.FunctionDef)
        for decorator in node.decorator_list
    ]
    calls = [
        node.func.id
        for node in ast.walk(tree)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "KeyedStore"
    ]
    kinds = ("cache", "cached_property", "lru_cache", "variant")
    return sum(decorator in kinds for decorator in decorators) + len(calls)


def entered_files(root: Path) -> tuple[str, ...]:
    """Files of the packages of which a run of the example calls a function, in a process of its own."""
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, __file__, str(root), "--run-into", folder]
        process = subprocess.run(command, capture_output=True, text=True)
        if process.returncode != 0:
            raise RuntimeError(process.stderr[-2000:])
        return tuple((Path(folder) / "entered.txt").read_text(encoding="utf-8").split())


def _run_into(root: Path, folder: Path) -> None:
    """Run the example in this process, and write the files that it enters."""
    sys.path.insert(0, str(root))
    packages = tuple(f"{root / package}/" for package in PACKAGES)
    entered: dict[CodeType, bool] = {}

    def watch(frame: FrameType, event: str, _: Any) -> None:
        code = frame.f_code
        if event == "call" and not entered.get(code) and code.co_filename.startswith(packages):
            entered[code] = _is_named_function(code) and not _is_importing(frame)

    from fem_seal.__main__ import main as command_line

    sys.argv = ["fem-seal", "run", str(root / CASE), "--output", str(folder / "out")]
    sys.setprofile(watch)
    try:
        code = command_line()
    finally:
        sys.setprofile(None)
    files = sorted(
        {
            str(Path(code.co_filename).relative_to(root))
            for code, counts in entered.items()
            if counts
            and code.co_filename.endswith(".py")  # jinja's templates are none of the program's modules
        }
    )
    (folder / "entered.txt").write_text("\n".join(files), encoding="utf-8")
    sys.exit(code)


def _is_named_function(code: CodeType) -> bool:
    # the bodies of modules and classes have no local variables of this kind
    return bool(code.co_flags & 1) and not code.co_name.startswith("<")


def _is_importing(frame: FrameType | None) -> bool:
    while frame is not None:
        if frame.f_code.co_name == "<module>" and frame.f_globals["__name__"] != "__main__":
            return True
        frame = frame.f_back
    return False


def figures(root: Path) -> tuple[dict[str, int], list[str]]:
    """Each figure by its name in `ceilings.toml`, and what else stands in the table or is wrong with the patterns."""
    every = code_files(root)
    two = {path: text for path, text in every.items() if not path.startswith("meshes")}
    numbers = {
        "code_lines": sum(lines["code"] for lines in rooms(root).values()),
        "entered_files": len(entered_files(root)),
        "members_of_LoadResult": len(members("LoadResult", every)[1]),
        "fields_of_SealProblem": len(members("SealProblem", every)[0]),
    }
    faults = []
    for name, axis in AXES.items():
        count = files_that_know(axis, two)
        numbers[f"files_that_know_{name}"] = len(count.files)
        numbers[f"files_that_know_{name}_with_prose"] = count.with_prose
        faults += [f"{name}: nothing matches {expression!r}" for expression in count.unmatched]
    numbers["module_numbers"] = sum(map(module_numbers, every.values()))
    numbers["caches"] = sum(map(caches, every.values()))
    return numbers, faults


def main() -> None:
    """Print the table, and fail with `--check` where a figure is above its ceiling."""
    arguments = [word for word in sys.argv[1:] if not word.startswith("--")]
    root = Path(arguments[0]).resolve() if arguments else HERE.parent
    if "--run-into" in sys.argv:
        _run_into(root, Path(arguments[1]))
    ceilings = tomllib.loads(CEILINGS.read_text(encoding="utf-8"))
    numbers, faults = figures(root)
    excesses = []
    for name, number in numbers.items():
        ceiling = ceilings.get(name)
        print(
            f"{name.replace('_', ' '):42}{number:8,}"
            + ("" if ceiling is None else f"   at most {ceiling:7,}")
        )
        if ceiling is not None and number > ceiling:
            excesses.append(
                f"{name} = {number}: above its ceiling {ceiling} in benchmarks/{CEILINGS.name}; {RAISED}"
            )
    if "--check" in sys.argv and (excesses or faults):
        sys.exit("\n".join([*excesses, *faults]))


if __name__ == "__main__":
    main()
