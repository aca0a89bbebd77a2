"""The command `fem-seal table`: leak over pressure and force, for the simulation of a system."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from fem_seal.cli import terminal

if TYPE_CHECKING:
    from fem_seal.answers.leak_map import LeakMap
    from fem_seal.units import Display

_FORM = '"1 bar, 5 bar, 20 bar", or from, to and number of values: "1 bar : 20 bar : 10"'


def table(
    case_file: terminal.CaseFile,
    output: Annotated[Path | None, terminal.output_option("CASE.table", "Folder for the tables.")] = None,
    pressure: Annotated[str | None, terminal.option("table", "pressure", form=_FORM)] = None,
    force: Annotated[str | None, terminal.option("table", "force")] = None,
    quiet: terminal.Quiet = False,
    json: Annotated[bool, terminal.json_option("the points")] = False,
    debug: terminal.Debug = False,
) -> None:
    """Leak rate and equivalent leakage area over pressure and force: CSV, Modelica and MATLAB tables."""
    from fem_seal.answers.leak_map import leak_map
    from fem_seal.output.folders import folder_lock, replaced_together
    from fem_seal.output.leak_map import map_rows, write_map

    case = terminal.case_of_command(case_file)
    pressures = None if pressure is None else grid(pressure, "pressure")
    forces = None if force is None else grid(force, "force")
    folder = output or case_file.with_suffix(".table")
    with folder_lock(folder):
        leaks = leak_map(case, pressures, forces)
        with replaced_together(folder, whole=False) as draft:
            write_map(leaks, draft)
    if json:
        terminal.say_json({"folder": str(folder), "points": map_rows(leaks)})
    elif not quiet:
        _show(case.display, leaks)
    terminal.warn(_omission_notes(case.display, leaks))
    if not (json or quiet):
        terminal.say(
            f"Tables in {folder}: {', '.join(sorted(path.name for path in folder.iterdir() if path.suffix))}"
        )


def grid(text: str, dimension: str) -> list[float]:
    """Values of an axis of the table, SI.

    Parameters
    ----------
    text : str
        Quantities with "," between them, or first, last and number of values with ":" between them.
    dimension : str
        "pressure" or "force".

    Raises
    ------
    InputError
        If it is neither.

    Examples
    --------
    >>> grid("1 bar : 4 bar : 4", "pressure"), grid("0 N, 2 kN", "force")
    ([100000.0, 200000.0, 300000.0, 400000.0], [0.0, 2000.0])
    """
    from fem_seal.errors import InputError, QuantityError
    from fem_seal.units import parse_quantity, split_quantities

    *ends, number = [part.strip() for part in text.split(":")]
    if ends and (len(ends) != 2 or not number.isdecimal() or not 2 <= int(number) <= 1000):
        words = f"write a list or a range with 2 to 1000 values, such as {_FORM}"
        raise InputError.at(f"--{dimension}", words, repr(text))
    try:
        values = [parse_quantity(part, dimension) for part in ends or split_quantities(text)]
    except QuantityError as error:
        raise InputError.at(f"--{dimension}", str(error), repr(text)) from None
    if not ends:
        return values
    start, stop = values
    return [start + (stop - start) * n / (int(number) - 1) for n in range(int(number))]


def _show(display: Display, leaks: LeakMap) -> None:
    """Print the leak rates, one line per pressure, marked where they are not valid."""
    from fem_seal.seal.findings import Level
    from fem_seal.units import digits_within, round_digits
    from fem_seal.wording import say

    # a volume too small to be seen in ml is read in its power of ten
    fluid, flow, newton = (display.fixed_unit(name) for name in ("bar", "ml/min", "N"))
    forces = map(newton.of, leaks.applied_force.tolist())
    headings = [f"p fluid\n{fluid.name}", *(f"{force:.4g} {newton.name}\n{flow.name}" for force in forces)]
    rows = []
    for m, pressure in enumerate(leaks.fluid_pressure.tolist()):
        rows.append([f"{fluid.of(pressure):.4g}"])
        for n, validity in enumerate(leaks.validity[m]):
            if validity is None:
                rows[m].append("-")
                continue
            # as in the tables of a run: no more digits than the error of the theory allows
            digits = min(3, digits_within(validity.leak_error))
            rate = round_digits(flow.of(float(leaks.leak_rate[m, n])), digits)
            rows[m].append(f"{rate:.3g}{Level(validity.level).mark}")
    terminal.say(say(display, "leak_map", "title", leaks=leaks))
    terminal.show(terminal.numbers_table(headings, rows, narrow=True))


def _omission_notes(display: Display, leaks: LeakMap) -> list[str]:
    from fem_seal.output.leak_map import CSV
    from fem_seal.wording import say

    gaps = sum(validity is None for row in leaks.validity for validity in row)
    if not gaps:
        return []
    whole = leaks.complete
    rows, columns = leaks.fluid_pressure.size, leaks.applied_force.size
    counts = {"kept_rows": whole.fluid_pressure.size, "kept_columns": whole.applied_force.size, "csv": CSV}
    sizes = {"gaps": gaps, "points": rows * columns, "rows": rows, "columns": columns}
    return [say(display, "leak_map", "files_gaps", **sizes, **counts), *leaks.reasons[:1]]
