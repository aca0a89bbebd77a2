"""Input and output of the terminal: options, lines, tables.

The help of the options is in `templates/options.toml`. All output of the commands passes here and is stripped of
control characters.
"""

from __future__ import annotations

import math
import shutil
import sys
import textwrap
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TextIO

import typer

import fem_seal
from fem_seal.errors import printable
from fem_seal.files import as_json, own_tables
from fem_seal.units import DIGITS, LIQUID, LeakVolume, Unit, round_digits
from leak.standards import STANDARD_PRESSURE

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

    from fem_seal.answers.case_load import AnyLoad, CaseLoad
    from fem_seal.answers.solution import SealSolution
    from fem_seal.case.case import Case
    from fem_seal.output.columns import TerminalColumn
    from fem_seal.units import Display


def option(command: str, name: str, **words: str) -> Any:
    """An option of a command.

    Parameters
    ----------
    command, name : str
        Its table and key in the file.
    words
        Values for the braces of its help.
    """
    settings = dict(own_tables("options.toml")[command][name])
    settings["help"] = settings["help"].format(**words)
    return typer.Option(*settings.pop("flags", ()), **settings)


def argument(command: str, name: str) -> Any:
    """An argument of a command, see `option`."""
    return typer.Argument(**own_tables("options.toml")[command][name])


def output_option(default: str | bool, what: str = "Folder for the results.", metavar: str = "DIR") -> Any:
    """Option for the folder or file that a command writes."""
    return typer.Option("--output", "-o", metavar=metavar, show_default=default, help=what)


def json_option(what: str = "the result") -> Any:
    """Option to print JSON instead of words."""
    return typer.Option("--json", help=f"Print {what} as JSON, in SI units.")


CaseFile = Annotated[Path, argument("common", "case_file")]
ResultsFolder = Annotated[Path, argument("common", "results_folder")]
Quiet = Annotated[bool, option("common", "quiet")]
Json = Annotated[bool, json_option()]
Details = Annotated[bool, option("common", "details")]
AllColumns = Annotated[bool, option("common", "all_columns")]
Full = Annotated[bool, option("common", "full")]
Debug = Annotated[bool, option("common", "debug")]


@contextmanager
def progress_of(quiet: bool) -> Iterator[Callable[[str], None]]:
    """Show the current step on stderr: one changing line on a terminal, lines elsewhere, or nothing.

    Parameters
    ----------
    quiet : bool
    """
    try:
        if quiet:
            yield lambda text: None
        elif not sys.stderr.isatty():
            yield note
        else:
            from rich.console import Console

            with Console(stderr=True, highlight=False).status("starting") as status:
                yield lambda text: status.update(cell(text))
    except KeyboardInterrupt:
        note("interrupted")
        raise


def say(*lines: str, bold: bool = False) -> None:
    """Print lines; without any, an empty one."""
    for line in lines or ("",):
        typer.secho(printable(line), bold=bold or None)


def room_of(stream: TextIO) -> int:
    """Characters in a line: as many as the terminal is wide, 80 in a file or pipe."""
    return shutil.get_terminal_size().columns if stream.isatty() else _USUAL_WIDTH


def tell(*sentences: str, bold: bool = False, indent: int | None = None) -> None:
    """Print sentences, each broken between words to the width of the terminal.

    Parameters
    ----------
    *sentences : str
    bold : bool
    indent : int, optional
        Blanks before all lines but the first; two more than before the first unless given.
    """
    for sentence in sentences:
        margin = len(sentence) - len(sentence.lstrip()) + 2 if indent is None else indent
        say(*_break_lines(sentence, sys.stdout, margin), bold=bold)


def _break_lines(text: str, stream: TextIO, indent: int) -> list[str]:
    """A text in lines, broken between words only."""
    return textwrap.wrap(
        printable(text),
        max(room_of(stream), 2 * indent),
        subsequent_indent=" " * indent,
        break_long_words=False,
        break_on_hyphens=False,
    )


def say_json(value: object) -> None:
    """Print a value as JSON."""
    say(*as_json(value).split("\n"))


def note(line: str) -> None:
    """Print a status line on standard error."""
    typer.secho(printable(line), err=True)


def warn(warnings: Iterable[str], rest: str = "") -> None:
    """Print warnings on standard error.

    Parameters
    ----------
    warnings : iterable of str
    rest : str
        Where those after the first three can be read; all are printed without it.
    """
    texts = list(warnings)
    # one more takes no more room than the line that counts it
    count = _WARNINGS if rest and len(texts) > _WARNINGS + 1 else len(texts)
    for text in (*texts[:count], *([f"{len(texts) - count} more, see {rest}"] if texts[count:] else [])):
        for line in _break_lines(f"warning: {text}", sys.stderr, len("warning: ")):
            typer.secho(line, err=True, fg=typer.colors.YELLOW)


def complain(message: str, word: str = "error: ") -> None:
    """Print an error on standard error, with a word before each of its lines."""
    for line in message.split("\n"):
        text = f"{word}{printable(line)}"
        # a file keeps each entry of the case in a line of its own
        for part in _break_lines(text, sys.stderr, len(word)) if sys.stderr.isatty() else [text]:
            typer.secho(part, err=True, fg=typer.colors.RED)


def cell(text: str) -> str:
    """A cell of a table, or a line of progress, for rich: markup is escaped, line breaks are kept."""
    from rich.markup import escape

    return escape("\n".join(map(printable, text.split("\n"))))


def numbers_table(
    headings: Sequence[str],
    rows: Sequence[Sequence[str]],
    *,
    narrow: bool = False,
    names: bool = False,
    words: bool = False,
) -> Table:
    """A table of numbers, aligned to the right and never cut.

    Parameters
    ----------
    headings : sequence of str
    rows : sequence of sequence of str
    narrow : bool
        One blank between the columns.
    names, words : bool
        Whether the first column holds names, the last one words that may be broken.
    """
    from rich import box
    from rich.table import Table

    table = Table(box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0) if narrow else (0, 1))
    last_column = len(headings) - 1
    for number, heading in enumerate(headings):
        if words and number == last_column:
            table.add_column(cell(heading), overflow="fold")
        else:
            table.add_column(
                cell(heading), justify="left" if names and number == 0 else "right", no_wrap=True
            )
    for row in rows:
        table.add_row(*map(cell, row))
    return table


def show(table: Table, console: Console | None = None) -> None:
    """Print a table of cells."""
    from rich.console import Console

    (console or Console(highlight=False)).print(table)


def prompt(words: str, default: str) -> str:
    """Ask a question and return the answer, stripped of blanks."""
    answer: Any = typer.prompt(printable(words), default=printable(default))
    return default if answer == printable(default) else str(answer).strip()


# Wider than any table.
ENDLESS = 100_000
# Width of a file; warnings that are told before the rest is counted; width of a word in a heading.
_USUAL_WIDTH, _WARNINGS, _WORD = 80, 3, 10


def show_result(result: SealSolution, *, details: bool) -> None:
    """Print the verdict, what decides it, and the loads in brief; or everything that can be said.

    Parameters
    ----------
    result : SealSolution
    details : bool
        Everything: the whole table and the sentences of all answers.
    """
    from fem_seal.answers.leakage_class import volume_of
    from fem_seal.output.answer_outputs import pages_of
    from fem_seal.output.report.brief import lines_in_brief
    from fem_seal.output.tables import leak_rows

    case = result.case
    show_first(*lines_in_brief(result, pages_of(result)))
    if not details:
        show_loads(case, result.every_load)
        return
    show_leak_table(result.case.display, leak_rows(result), case.title, result.every_load, volume_of(case))
    show_leakage(case, result.loads)
    show_answers(result)


def show_first(first: str, *others: str) -> None:
    """Print what is said first: the verdict, and what decides it."""
    tell(first, bold=True)
    tell(*filter(None, others))
    say()


def show_loads(case: Case, loads: Sequence[AnyLoad]) -> None:
    """Print the loads in brief.

    Parameters
    ----------
    case : Case
    loads : sequence of CaseLoad or MissingLoad
    """
    from fem_seal.answers.leakage_class import volume_of
    from fem_seal.materials import ROOM_TEMPERATURE
    from fem_seal.output.answers.verdict import allowed_in_words
    from fem_seal.output.report.brief import loads_in_brief
    from fem_seal.output.report.page import marks_of
    from fem_seal.seal.load_result import MissingLoad

    table, count = loads_in_brief(case, loads)
    headings = []
    for heading in table.headings:
        words, _, unit = heading.rstrip("]").partition(" [")
        headings.append([*textwrap.wrap(words, _WORD), unit])
    height = max(map(len, headings))
    tell(case.title)
    show(
        numbers_table(
            ["\n".join([""] * (height - len(h)) + h) for h in headings], [list(row) for row in table.rows]
        )
    )
    notes = marks_of([load for load in loads if not isinstance(load, MissingLoad)])
    notes += [f"{count} more loads in leak.csv"] if count else []
    notes += [limits] if (limits := allowed_in_words(case.display, loads)) else []
    state = case.display.state_of(volume_of(case))
    if state:
        assert case.fluid is not None
        share = ROOM_TEMPERATURE / case.fluid.temperature
        # what a flow meter at room temperature shows of a hot leak
        cold = "" if 0.9 < share < 1.1 else f", at 20 °C {share:.2g} of them"
        notes += [f"volumes of gas at {state}{cold}"]
    tell(*([f"  {'; '.join(notes)}"] if notes else []))


def say_where(folder: Path) -> None:
    """Print where the results are."""
    names = sorted(path.name for path in folder.iterdir() if path.is_file() and not path.name.startswith("."))
    first = [name for name in ("report.html", "leak.csv") if name in names]
    others = [] if first else [name for name in names if not name.endswith((".vtu", ".vtp"))]
    rest = len(names) - len(first) - len(others)
    names_text = ", ".join([*first, *others]) + (f" and {rest} more files" if rest else "")
    tell(f"Results in {folder / '_'}"[:-1] + f": {names_text}")


def show_leak_table(
    display: Display,
    rows: Sequence[Mapping[str, Any]],
    title: str,
    loads: Sequence[AnyLoad],
    volume: LeakVolume = LIQUID,
) -> None:
    """Print rows of leak.csv as a table without empty columns, and a legend of its marks.

    Parameters
    ----------
    display : Display
    rows : sequence of mapping
    title : str
    loads : sequence of CaseLoad
        Loads of the rows, which determine the number of digits.
    volume : LeakVolume, optional
        State of the leaking volume; that of a liquid unless given.
    """
    from fem_seal.output.answers.leak import volume_notes
    from fem_seal.output.columns import COLUMNS, LEAK_ON_TERMINAL
    from fem_seal.seal.findings import Level
    from fem_seal.seal.load_result import MissingLoad

    results = [load for load in loads if not isinstance(load, MissingLoad)]
    # what tells the rows apart is the contact force, as far as there is one
    hidden = {"applied_force_N"} if len(results) == len(loads) else set()
    columns = [
        column
        for column in LEAK_ON_TERMINAL
        if column.name not in hidden and any(_has_value(row.get(column.name)) for row in rows)
    ]
    table = [
        (
            f"{column.heading}\n{column.unit_in(display).name}",
            [
                _leak_cell(display, row.get(column.name), column, load, volume)
                for row, load in zip(rows, loads, strict=True)
            ],
        )
        for column in columns
    ]
    flows = [column.unit_in(display).name for column in columns if COLUMNS[column.name].kind == "flow"]
    has_bounds = any("<" in texts for _, texts in table)
    marks = {str(level): level.mark for level in Level}
    levels = [row["validity"] for row in rows]
    # columns that tell the rows apart are repeated in every part of a wide table
    several_forces = len({row["fluid_pressure_Pa"] for row in rows}) < len(rows)
    keys = 2 if several_forces and columns[1].name.endswith("_force_N") else 1
    if any(marks.get(level) for level in levels):
        table.insert(keys, ("", [marks.get(level, "") for level in levels]))
        keys += 1
    if any(row.get("verdict") for row in rows):
        table.append(("verdict\n", [row.get("verdict") or "-" for row in rows]))
    headings, texts = zip(*table, strict=True)
    show_table(title, headings, list(zip(*texts, strict=True)), keys)
    for level in Level:
        if level.mark and level in levels:
            what = "nothing may be claimed" if level is Level.OUTSIDE else "uncertain"
            tell(f"  {level.mark} {level}: {what}; for the reasons see validity_reasons in leak.csv")
    for text in volume_notes(display, volume, flows, unmeasured=has_bounds):
        tell(f"  {text}")


def _leak_cell(
    display: Display, value: float | None, style: TerminalColumn, load: AnyLoad, volume: LeakVolume
) -> str:
    """A cell of a load: "<" for an unmeasurable leak rate, ">1e6" for a margin above a million."""
    from fem_seal.output.columns import COLUMNS

    column = COLUMNS[style.name]
    if value is not None and column.kind in ("flow", "throughput"):
        # a throughput is its volume times 101325 Pa
        rate = value / STANDARD_PRESSURE if column.kind == "throughput" else value
        if rate > 0 and not volume.measurable(rate):
            return "<"
    if value is not None and style.name == "margin" and value > 1e6:
        return "sealed" if math.isinf(value) else ">1e6"
    return _cell(value, style.unit_in(display), column.digits(load))


def show_leakage(case: Case, loads: Sequence[CaseLoad]) -> None:
    """Print the leak rate of the highest load in the units of leak testing, and its classes.

    Parameters
    ----------
    case : Case
    loads : sequence of CaseLoad
    """
    from fem_seal.output.answers.leak import leakage_lines
    from fem_seal.seal.load_result import highest_load

    tell(*leakage_lines(case, loads[highest_load(loads)], loads))


def show_answers(result: SealSolution) -> None:
    """Print the answers in words: largest earlier load, form error, particles, verdict, sensitivities.

    Parameters
    ----------
    result : SealSolution
    """
    from fem_seal.output.answer_outputs import pages_of

    tell(*(line for page in pages_of(result) for line in (*page.details, *page.backing)))


def show_table(title: str, headings: Sequence[str], rows: Sequence[Sequence[str]], keys: int = 1) -> None:
    """Print a table, numbers aligned to the right and never cut.

    Where it is wider than the terminal, or than 80 characters of a file, its parts are printed below each other.

    Parameters
    ----------
    title : str
    headings : sequence of str
        Of two lines at most.
    rows : sequence of sequence of str
    keys : int
        Number of first columns that identify a row; they are repeated in every part.
    """
    from rich.console import Console

    # the width of the terminal limits the columns of a part, never the digits of a number
    console = Console(width=ENDLESS, highlight=False)
    # not the title of the rich table, which would be broken to the width of the table
    tell(title, bold=True)
    widths = [
        max(len(line) for cell in (heading, *column) for line in cell.split("\n"))
        for heading, *column in zip(headings, *rows, strict=True)
    ]
    for part in _parts(widths, keys):
        show(numbers_table([headings[n] for n in part], [[row[n] for n in part] for row in rows]), console)


def _parts(widths: Sequence[int], keys: int) -> Iterator[list[int]]:
    """Columns of each part: the keys and as many others as fit, at least one."""
    room = room_of(sys.stdout)
    # each column has a blank on either side and one more after it; one blank begins the line
    spaces = [width + 3 for width in widths]
    own_width = 1 + sum(spaces[:keys])
    part, used = list(range(keys)), own_width
    for n in range(keys, len(widths)):
        if len(part) > keys and used + spaces[n] > room:
            yield part
            part, used = list(range(keys)), own_width
        part.append(n)
        used += spaces[n]
    yield part


def _has_value(value: float | None) -> bool:
    return value is not None and not math.isnan(value)


def _cell(value: float | None, unit: Unit, digits: int = DIGITS) -> str:
    if value is None or math.isnan(value):
        return "-"
    number = unit.of(value)
    if digits < DIGITS and math.isfinite(value) and value:
        exponent = math.floor(math.log10(abs(round_digits(number, digits))) + 1e-12)
        if -4 <= exponent < DIGITS:
            return f"{round_digits(number, digits):.{max(digits - 1 - exponent, 0)}f}"
    # trailing zeros are kept: columns stay aligned
    return f"{number:#.{digits}g}".removesuffix(".")


def _dimension(display: Display, key: str, value: float) -> str:
    unit = display.fixed_unit("deg" if key.endswith("angle") else "mm")
    return f"{unit.of(value):.4g} {unit.name}"


def case_of_command(path: Path, *, with_shapes: bool = True) -> Case:
    """The case of a command, in whose units all that follows is shown."""
    case = fem_seal.load_case(path)
    if with_shapes:
        case.check_shapes()
    return case


def show_derived(case: Case, numbers: Mapping[str, Any], *, details: bool = False) -> None:
    """Print the derived numbers of a case, of the loads six columns or all that are known."""
    from fem_seal.output.case_words import section_text
    from fem_seal.output.columns import CHECK_OF_CASE, CHECK_ON_TERMINAL, MOST_COLUMNS, SHOWN_COLUMNS

    display, lower = case.display, numbers.get("lower_flange")
    for part in case.every_body:
        name, body = part.label, part.case.key_of(part.name)
        its = numbers if part.case is case or lower is None else lower
        parts = [its["materials"][body]] if lower else []
        parts += [
            f"{key} {_dimension(case.display, key, value)}" for key, value in its["dimensions"][body].items()
        ]
        if body in its["sections"]:
            parts += section_text(case.display, its["sections"][body]).values()
        tell(f"  {name:{14 if lower else 10}}" + ", ".join(parts), indent=16 if lower else 12)
    for name, (words, unit) in CHECK_OF_CASE.items():
        usual = display.fixed_unit(unit)
        texts = [
            f"{_cell(value, usual)} {usual.name}".rstrip()
            for value in (numbers[name], (lower or {}).get(name))
            if value is not None and math.isfinite(value)
        ]
        if texts:
            tell(f"  {words:30}" + "; on the lower flange ".join(dict.fromkeys(texts)), indent=32)
    rows = numbers["loads"]
    columns = [column for column in CHECK_ON_TERMINAL if any(row[column.name] is not None for row in rows)]
    for name in () if details else SHOWN_COLUMNS["check_spared"]:
        if len(columns) > MOST_COLUMNS:
            columns = [column for column in columns if column.name != name]
    hertz = any(row["hertz_peak_pressure_Pa"] is not None for row in rows)
    show_table(
        "Closed-form pressure profiles" if hertz else "Loads (no closed-form profiles: the faces conform)",
        [f"{column.heading}\n{column.unit_in(display).name}" for column in columns],
        [[_cell(row[column.name], column.unit_in(display)) for column in columns] for row in rows],
    )
