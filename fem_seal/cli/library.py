"""The commands `fem-seal materials` and `fem-seal fluids`: lists of the libraries."""

from __future__ import annotations

import csv
import sys
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Annotated, Any

from fem_seal.cli import terminal
from fem_seal.cli.terminal import cell
from fem_seal.files import own_tables
from fem_seal.units import Display, System, parse_quantity

if TYPE_CHECKING:
    from rich.console import Console

Json = Annotated[bool, terminal.json_option("the entries")]
Csv = Annotated[bool, terminal.option("library", "csv")]
Temperature = Annotated[str, terminal.option("library", "temperature")]
Units = Annotated[System, terminal.option("library", "units")]
# Width of a terminal from which on a column of words fits next to the numbers.
_WIDE = 120


def materials(
    name: Annotated[str | None, terminal.argument("library", "material")] = None,
    temperature: Temperature = "20 degC",
    units: Units = "field",
    json: Json = False,
    csv: Csv = False,
    debug: terminal.Debug = False,
) -> None:
    """List the materials of the library: modulus, hardness, yield strength, expansion, conductivity, condition, source.

    Numbers that are not known at the temperature are left out.
    """
    from fem_seal.case.material_table import material
    from fem_seal.output import library

    display, kelvin = Display(units), parse_quantity(temperature, "temperature")
    rows = library.material_rows(kelvin) if name is None else [library.material_row(material(name), kelvin)]
    if json or csv:
        _print_rows(rows, name is not None, json)
    elif name is not None:
        _print_lines(library.material_lines(display, rows[0]))
    else:
        _print_table(*library.material_cells(display, rows), "condition", [row["condition"] for row in rows])
        hint = own_tables("library.toml")["more_of_materials"]
        terminal.tell(f"Numbers at {temperature}. {library.ONE_CONDITION}", hint)


def fluids(
    name: Annotated[str | None, terminal.argument("library", "fluid")] = None,
    temperature: Temperature = "20 degC",
    units: Units = "field",
    json: Json = False,
    csv: Csv = False,
    debug: terminal.Debug = False,
) -> None:
    """List the fluids of the library: viscosity, density, range of temperature, source."""
    from fem_seal.output import library

    display, kelvin = Display(units), parse_quantity(temperature, "temperature")
    rows = library.fluid_rows(kelvin) if name is None else [library.fluid_row(name, kelvin)]
    if json or csv:
        _print_rows(rows, name is not None, json)
    elif name is not None:
        _print_lines(library.fluid_lines(display, rows[0]))
    else:
        _print_table(*library.fluid_cells(display, rows), "source", [row["source"] for row in rows])
        terminal.tell(
            f"Viscosity and density at {temperature}. {own_tables('library.toml')['more_of_fluids']}"
        )


def _print_rows(rows: Sequence[dict[str, Any]], single: bool, as_json_text: bool) -> None:
    if as_json_text:
        terminal.say_json(rows[0] if single else rows)
        return
    writer = csv.writer(sys.stdout, lineterminator="\n")
    # a table does not fit into a cell
    rows = [{key: cell for key, cell in row.items() if not isinstance(cell, dict)} for row in rows]
    writer.writerow(rows[0])
    for row in rows:
        cells = (", ".join(cell) if isinstance(cell, list) else cell for cell in row.values())
        writer.writerow("" if cell is None else cell for cell in cells)


def _print_lines(lines: Iterable[tuple[str, str]]) -> None:
    from rich.table import Table

    table = Table.grid(padding=(0, 2))
    for word, text in lines:
        table.add_row(word, cell(text))
    terminal.show(table, _console(terminal.room_of(sys.stdout)))


def _print_table(
    headings: Sequence[str], cells: Sequence[Sequence[str]], hint: str, words: Sequence[str]
) -> None:
    """Print names and numbers, and a last column of words on a wide terminal."""
    # numbers are never cut
    console = _console(None if sys.stdout.isatty() else terminal.ENDLESS)
    wide = sys.stdout.isatty() and console.width >= _WIDE
    if wide:
        headings = [*headings, f"{hint}\n"]
        cells = [[*line, text] for line, text in zip(cells, words, strict=True)]
    terminal.show(terminal.numbers_table(headings, cells, narrow=True, names=True, words=wide), console)


def _console(width: int | None) -> Console:
    from rich.console import Console

    return Console(highlight=False, width=width)
