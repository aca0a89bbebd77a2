"""The terminal's tables: every number whole at every width, every row with its mark."""

from __future__ import annotations

import json
import re
import sys
import unicodedata
from pathlib import Path

import pytest
from sample_results import case

from fem_seal.answers.case_load import CaseLoad
from fem_seal.cli import app as cli
from fem_seal.cli import terminal
from fem_seal.cli.terminal import _cell, show_leak_table, show_leakage
from fem_seal.output import columns as output_columns
from fem_seal.seal import findings as caution
from fem_seal.seal.findings import Level, Validity, remark
from fem_seal.seal.load_result import DiscretisationError, LoadResult
from fem_seal.studies.progress import Lines
from fem_seal.units import Display
from leak import LeakResult


def judged(level):
    reason = "seat: 7.4 times its yield stress"
    return Validity(() if level is Level.VALID else (remark("kind", level, reason),))


def row(pressure=20e5, level=Level.VALID, **entries):
    """A row of leak.csv in which every column is filled, mostly by numbers that take room."""
    numbers = {
        name: 1.2345e-13 * (n + 1) if "leak_rate" in name else 12345.6 * (n + 1)
        for n, name in enumerate(output_columns.LEAK_COLUMNS)
    }
    return {
        **numbers,
        "fluid_pressure_Pa": pressure,
        **caution.validity_entries(judged(level), Display()),
        **entries,
    }


ROWS = [row(5e5), row(20e5, Level.DOUBTFUL), row(1800e5, Level.OUTSIDE)]


def load(error=None):
    """What a row of the table is of, as far as its numbers of digits go."""
    return CaseLoad.of(LoadResult(20e5, 0.0, None, mesh_error=error))


def shown(capsys, monkeypatch, rows, width=None):
    """The table on a terminal of some width; without one, what a file gets."""
    monkeypatch.setattr(sys.stdout, "isatty", lambda: width is not None)
    if width is not None:
        monkeypatch.setenv("COLUMNS", str(width))
    show_leak_table(Display(), rows, "Title", [load()] * len(rows))
    return re.sub(r"\x1b\[[0-9;]*m", "", capsys.readouterr().out)


# the applied force only tells loads apart that have no contact force
CALCULATED = [one for one in output_columns.LEAK_ON_TERMINAL if one.name != "applied_force_N"]


def four_digits(row, column):
    """A number with its zeros, so that columns stay aligned; one that is worth less has fewer digits."""
    digits = output_columns.COLUMNS[column.name].most_digits
    if digits < 4:
        return _cell(row[column.name], column.unit_in(Display()), digits)
    return f"{column.unit_in(Display()).of(row[column.name]):#.4g}".removesuffix(".")


def cells(text):
    return [line.split() for line in text.splitlines() if line.strip()]


@pytest.mark.parametrize("width", [40, 80, 420])
def test_a_terminal_folds_columns_and_cuts_no_number(width, capsys, monkeypatch):
    text = shown(capsys, monkeypatch, ROWS, width)
    table = text[: text.index("doubtful")]
    assert "…" not in text
    assert max(len(line.rstrip()) for line in table.splitlines()) <= width
    for one in ROWS:
        for column in CALCULATED:
            assert four_digits(one, column) in text.split()
    # every part begins with the pressure, and its rows carry their marks
    firsts = [line[0] for line in cells(table) if line[0] in ("5.000", "20.00", "1800")]
    parts = len(firsts) // 3
    assert firsts == ["5.000", "20.00", "1800"] * parts
    assert (parts == 1) == (width == 420)
    assert sum(line[:2] == ["1800", "!"] for line in cells(table)) == parts
    assert sum(line[:2] == ["20.00", "?"] for line in cells(table)) == parts


@pytest.mark.parametrize("columns", [None, "40"])
def test_a_file_gets_all_columns_in_lines_of_80(columns, capsys, monkeypatch):
    if columns:
        monkeypatch.setenv("COLUMNS", columns)
    text = shown(capsys, monkeypatch, ROWS)
    assert "…" not in text
    assert max(len(line.rstrip()) for line in text.splitlines()) <= 80
    parts = [line for line in cells(text) if line[0] == "1800"]
    assert all(line[:2] == ["1800", "!"] for line in parts)
    told = [cell for line in parts for cell in line[2:]]
    assert told == [four_digits(ROWS[2], column) for column in CALCULATED[1:]]


def test_no_number_has_more_digits_than_the_mesh_leaves(capsys):
    """An error of four per cent leaves three digits of a pressure; what the mesh does not touch keeps its four."""
    error = DiscretisationError(peak_pressure=0.04, fwhm=0.2, std=0.004, leak_rate=None)
    show_leak_table(
        Display(),
        [{**ROWS[0], "peak_pressure_Pa": 51.389e6, "fwhm_m": 0.12344e-3, "std_m": 0.56784e-3}],
        "",
        [load(error)],
    )
    told = capsys.readouterr().out.split()
    assert {"51.4", "0.12", "0.5678", "5.000"} <= set(told)
    assert {"51.39", "0.1234", "0.123"}.isdisjoint(told)


@pytest.mark.parametrize("width", [40, 80])
def test_on_a_real_terminal(width, tmp_path):
    """The same through a pseudo-terminal, which has a width of its own."""
    pty = pytest.importorskip("pty")
    import fcntl
    import os
    import struct
    import subprocess
    import termios

    script = (
        "from fem_seal.cli.terminal import show_table\n"
        "show_table('Title', [f'column {n}\\nmm³/s' for n in range(12)], [['2.018e-05'] * 12] * 2)\n"
    )
    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 24, width, 0, 0))
    environment = {name: text for name, text in os.environ.items() if name not in ("COLUMNS", "LINES")}
    process = subprocess.Popen([sys.executable, "-c", script], stdout=theirs, env=environment)
    os.close(theirs)
    read = b""
    while True:
        try:
            block = os.read(ours, 4096)
        except OSError:  # the other end is closed
            break
        if not block:
            break
        read += block
    os.close(ours)
    assert process.wait() == 0
    text = re.sub(r"\x1b\[[0-9;]*m", "", read.decode())
    assert max(len(line.rstrip()) for line in text.splitlines()) <= width
    assert "…" not in text
    # the first column of each part is the key again
    parts = text.count("column 0")
    assert parts > 1
    assert text.count("2.018e-05") == 2 * (12 + parts - 1)


def test_forces_tell_rows_of_one_pressure_apart_in_every_part(capsys, monkeypatch):
    rows = [row(contact_force_N=force) for force in (100.0, 200.0)]
    parts = [line[:2] for line in cells(shown(capsys, monkeypatch, rows, 60)) if line[0] == "20.00"]
    assert parts == [["20.00", "100.0"], ["20.00", "200.0"]] * (len(parts) // 2) and len(parts) > 2


def test_a_few_warnings_are_told_and_the_rest_is_counted(capsys):
    texts = [
        f"the {n}th word is followed by so many more that they fill more than one line of 80"
        for n in range(6)
    ]
    terminal.warn(texts, "report.html")
    few = capsys.readouterr().err
    assert few.splitlines()[-1] == "warning: 3 more, see report.html"
    assert max(map(len, few.splitlines())) <= 80 and few.count("warning: ") == 4
    # no word is broken
    assert set(" ".join(texts).split()) - {"3th", "4th", "5th"} <= set(few.split())
    terminal.warn(texts)
    assert capsys.readouterr().err.count("warning: ") == 6
    terminal.warn(texts[:4], "report.html")
    assert "more, see" not in capsys.readouterr().err


def test_marks_have_a_legend_and_valid_rows_none(capsys, monkeypatch):
    clean = shown(capsys, monkeypatch, [row()])
    assert "!" not in clean and "?" not in clean and "validity" not in clean
    text = shown(capsys, monkeypatch, ROWS)
    assert "! outside the theory: nothing may be claimed" in text
    assert "? doubtful: uncertain" in text
    assert "? doubtful" not in shown(capsys, monkeypatch, [ROWS[0], ROWS[2]])


def test_no_class_is_claimed_outside_the_theory(capsys):
    of = case(load={"fluid_pressure": ["5 bar", "20 bar", "1800 bar"]})
    loads = [
        CaseLoad(pressure, 0.0, None, validity=judged(level)).with_values(leak=LeakResult(1e-13, 1e18, None))
        for pressure, level in ((5e5, Level.VALID), (20e5, Level.DOUBTFUL), (1800e5, Level.OUTSIDE))
    ]
    show_leakage(of, loads[:2])
    doubtful = " ".join(capsys.readouterr().out.split())
    assert "ISO 5208 A" in doubtful and "(doubtful: seat: 7.4 times its yield stress)" in doubtful
    show_leakage(of, loads)
    outside = " ".join(capsys.readouterr().out.split())
    assert "ISO" not in outside and "FCI" not in outside
    assert "not claimed, because the leak rate is outside the theory" in outside
    assert "(outside the theory: seat: 7.4 times its yield stress)" in outside


# --- text from outside --------------------------------------------------------------------------------------

ESCAPES = "\x1b]0;PWNED\x07\x1b[31mred\x9b2J\u202e\u2028$\\frac{"


def obeyed(text):
    """What a terminal would not print but do, lines apart."""
    return [sign for sign in text if unicodedata.category(sign) in ("Cc", "Cf", "Zl", "Cs") and sign != "\n"]


def hostile_case(folder, **entries):
    """A case whose names hold control characters, in a file whose name does."""
    tables = {
        "title": ESCAPES + "\nerror: all is well",
        "closure": {"shape": "ball", "radius": "20 mm", "material": {**STEEL, "name": ESCAPES}},
        "seat": {"shape": "cone", "angle": "45 deg", "material": "steel"},
        "roughness": "lapped Ra 0.2 um",
        "fluid": {"name": "water"},
        "load": {"fluid_pressure": ["10 bar", "20 bar"]},
        **entries,
    }
    path = folder / "a\x1b[31mb\nc.toml"
    lines = [f"{key} = {inline(value)}" for key, value in tables.items()]
    path.write_text("\n".join(lines), encoding="utf-8")
    return path


STEEL = {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3, "hardness": "3 GPa"}


def inline(value):
    if isinstance(value, dict):
        return "{" + ", ".join(f"{json.dumps(key)} = {inline(one)}" for key, one in value.items()) + "}"
    # as JSON writes it, pure ASCII
    return json.dumps(value)


WRONG = {
    "word": {"interface": {"law": ESCAPES}},
    "quantity": {"load": {"fluid_pressure": "20 " + ESCAPES}},
    "entry of a list": {"load": {"fluid_pressure": ["1 bar", ESCAPES]}},
    "key": {"load": {"fluid_pressure": "20 bar", ESCAPES: 1}},
    "table": {ESCAPES: {"a": 1}},
    "fluid": {"fluid": {"name": ESCAPES}},
    "library": {"seat": {"shape": "cone", "angle": "45 deg", "material": ESCAPES}},
    "file": {"roughness": {"spectrum": {"kind": "table", "file": ESCAPES}}},
    "finish": {"roughness": {"seat": ESCAPES, "closure": "lapped Ra 0.2 um"}},
    "class": {"requirement": {"leakage_class": ESCAPES, "standard": ESCAPES}},
    "particles": {"fluid": {"name": "water", "particles": {"iso_4406": ESCAPES}}},
}


@pytest.mark.parametrize("what", WRONG)
def test_a_wrong_text_is_shown_without_its_control_characters(what, capfd, tmp_path):
    assert cli.main(["check", str(hostile_case(tmp_path, **WRONG[what]))]) == 2
    out, err = capfd.readouterr()
    assert err.startswith("error: ")
    assert all(line.startswith("error: ") for line in err.splitlines())
    assert not obeyed(out + err)


@pytest.mark.slow
@pytest.mark.parametrize(
    "arguments", [["check", "--picture", "p.png"], ["check", "--json"], ["table", "-o", "o"]]
)
def test_names_are_shown_without_their_control_characters(arguments, capfd, tmp_path, monkeypatch):
    """And drawn letter by letter: a dollar sign begins no formula."""
    monkeypatch.chdir(tmp_path)
    command, *options = arguments
    assert cli.main([command, str(hostile_case(tmp_path)), *options]) == 0
    out, err = capfd.readouterr()
    assert "PWNED" in out
    assert not obeyed(out + err)
    assert not any(line.startswith("error") for line in out.splitlines())
    if "--json" in options:
        assert json.loads(out)["title"] == ESCAPES + "\nerror: all is well"


def test_progress_is_shown_without_control_characters(capfd):
    lines = Lines()
    lines.note(ESCAPES)
    with terminal.progress_of(False) as progress:
        progress(ESCAPES)
    assert not obeyed("".join(capfd.readouterr()))


def test_only_one_file_prints():
    """What is printed elsewhere would not be looked through."""
    folder = Path(cli.__file__).parent.parent
    prints = re.compile(r"typer\.(echo|secho|prompt)\(|^\s*print\(", re.M)
    found = [path.name for path in folder.rglob("*.py") if prints.search(path.read_text(encoding="utf-8"))]
    assert found == ["terminal.py"]


@pytest.mark.slow
def test_many_wrong_entries_make_a_short_message(capfd, tmp_path):
    path = hostile_case(tmp_path)
    path.write_text("".join(f"k{n} = 1\n" for n in range(20_000)) + path.read_text(encoding="utf-8"))
    assert cli.main(["check", str(path)]) == 2
    lines = capfd.readouterr().err.splitlines()
    assert len(lines) == 21
    assert "k0: unknown key" in lines[0]
    assert lines[-1].endswith("19980 more entries are wrong; correct these first")


def test_plastic_law_of_asperities_that_do_not_yield_names_its_key(capfd, tmp_path):
    path = hostile_case(tmp_path, interface={"law": "spectrum", "plastic": True}, leak={"plasticity": False})
    assert cli.main(["check", str(path)]) == 2
    err = capfd.readouterr().err
    assert "interface.plastic = true: the asperities do not yield with leak.plasticity = false" in err
    right = hostile_case(tmp_path, interface={"law": "spectrum", "plastic": True}, leak={"theory": "paper"})
    assert cli.main(["check", str(right), "-q"]) == 0


def test_units_in_brackets_stand_in_the_help(capsys):
    assert cli.main(["leak", "--help"]) == 0
    assert '"x [mm],y [mm],z [mm],CPRESS' in capsys.readouterr().out
