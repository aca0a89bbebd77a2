"""Tables as programs, instruments and people write them: all hold the same rows."""

from __future__ import annotations

import numpy as np
import pytest

from leak.errors import TableError
from leak.text_tables import decode, only_table, read_tables

X = 0.5 * np.arange(7) - 1.5
P = 200.25 - 80.0 * X**2
ROWS = list(zip(X.tolist(), P.tolist(), strict=True))


def lines(form: str, rows: list[tuple[float, float]] = ROWS) -> str:
    """Each row in a form, with its number."""
    return "".join(form.format(x, p, n=n) for n, (x, p) in enumerate(rows, start=1))


FIELD_REPORT = """
********************************************************************************
Field Output Report, written Tue Jan 12 14:20:33 2016

Source 1
---------

   ODB: D:/temp/seat.odb
   Step: Step-1
   Frame: Increment     12: Step Time =    1.000

Loc 1 : Nodal values from source 1

Output sorted by column "Node Label".

Field Output reported at nodes for part: SEAT-1

            Node     COORD.COOR1          CPRESS
           Label          @Loc 1          @Loc 1
-------------------------------------------------
""" + lines("{n:16d} {0:15.6E} {1:15.6E}\n")
MINIMUM = "\n\n  Minimum   -1.5   20.25\n      At Node      1       1\n\n       Total   0.   1001.\n"

# Text, names of the columns with x and p, and their places.
FILES = {
    "comma": ("x [mm],p [MPa]\n" + lines("{0},{1}\n"), ("x [mm]", "p [MPa]")),
    "comma and blank": ("x [mm], p [MPa]\n" + lines("{0}, {1}\n"), ("x [mm]", "p [MPa]")),
    "semicolons, decimal commas": (
        "x [mm]; p [MPa]\n" + lines("{0};{1}\n").replace(".", ","),
        ("x [mm]", "p [MPa]"),
    ),
    "blanks, decimal commas": (
        "x [mm] p [MPa]\n" + lines("{0:.4f} {1:.4f}\n").replace(".", ","),
        ("x [mm]", "p [MPa]"),
    ),
    "quotes": ('"x [mm]","p [MPa]"\n' + lines('"{0}","{1}"\n'), ("x [mm]", "p [MPa]")),
    "comments": (
        "# seat 7\n# x [mm], p [MPa]\n" + lines("{0},{1}\n", ROWS[:3]) + "# half\n" + lines("{0},{1}\n", ROWS[3:]),
        ("x [mm]", "p [MPa]"),
    ),
    "Abaqus, field report": (FIELD_REPORT + MINIMUM, ("Node", "COORD.COOR1", "CPRESS")),
    "Abaqus, XY report": (
        "\n\n          X               CPRESS:path-1   \n\n" + lines("  {0:14.6E}      {1:14.6E}\n") + "\n\n",
        ("X", "CPRESS:path-1"),
    ),
    "Abaqus, probe values": (
        "ODB Name, Step, Frame, Node Label, X, CPRESS\n"
        + lines("seat.odb, Step-1, Increment 12: Step Time = 1.000, {n}, {0}, {1}\n"),
        ("X", "CPRESS"),
    ),
    "Ansys, path": ("Length (mm)\tValue (MPa)\n" + lines("{0}\t{1}\n"), ("Length (mm)", "Value (MPa)")),
    "Ansys, path listing": (
        "\n ***** PATH VARIABLE SUMMARY *****\n\n     S            CONTPRES\n" + lines("  {0:.5f}     {1:.5f}\n"),
        ("S", "CONTPRES"),
    ),
    "ParaView, line": (
        '"p","Points:0","Points:1","arc_length"\n' + lines("{1},14.1,0,{0}\n"),
        ("arc_length", "p"),
    ),
    "COMSOL, line": (
        "% Model:              seat.mph\n% Version:            COMSOL 6.1\n% Date: May 3 2024, 10:22\n"
        "% Dimension:          1\n% Length unit:        mm\n% x                       y (MPa)\n"
        + lines("{0:<26}{1}\n"),
        ("x", "y (MPa)"),
    ),
    "Fortran": ("x_mm p_MPa\n" + lines("{0:.6E} {1:.6E}\n").replace("E", "D"), ("x_mm", "p_MPa")),
    "units below the names": ("x;p\n[mm];[MPa]\n" + lines("{0};{1}\n"), ("x [mm]", "p [MPa]")),
    "separator at the end": ("x [mm];p [MPa];\n" + lines("{0};{1};\n"), ("x [mm]", "p [MPa]")),
    "no header": (lines("{0}\t{1}\n"), ()),
}  # fmt: skip


@pytest.mark.parametrize("name", FILES)
def test_every_file_holds_the_same_rows(name: str) -> None:
    text, known = FILES[name]
    table = only_table_of_numbers(text)
    assert set(known) <= set(table.header)
    x, p = [table.header.index(one) for one in known[-2:]] if known else (0, 1)
    assert table.values[:, [x, p]] == pytest.approx(np.array(ROWS), rel=1e-5)


def only_table_of_numbers(text: str):
    (table,) = read_tables(text)
    assert table.stray is None
    return table


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "latin-1"])
@pytest.mark.parametrize("ends", ["\n", "\r\n", "\r"])
def test_encodings_and_line_ends(encoding: str, ends: str) -> None:
    text = "x [µm];p [MPa]\n" + lines("{0};{1}\n")
    assert decode(text.replace("\n", ends).encode(encoding)) == text


def test_two_steps_of_a_report_are_two_tables() -> None:
    second = FIELD_REPORT.replace("Step: Step-1", "Step: Step-2")
    tables = read_tables(FIELD_REPORT + MINIMUM + second + MINIMUM)
    assert [len(one.rows) for one in tables] == [7, 7]
    assert all(one.header == ("Node", "COORD.COOR1", "CPRESS") and one.stray is None for one in tables)
    assert [any("Step-2" in line for _, line in one.lines_above) for one in tables] == [False, True]


def test_lines_of_the_file_are_known() -> None:
    table = only_table(read_tables("seat\n\nx_m p_Pa\n\n1 2\n# none\n3 4\n"))
    assert table.lines == (5, 7)
    assert table.texts(1) == ["2", "4"]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("x,p\n", "no rows of numbers"),
        ("1,2\n3,five\n4,5\n", 'line 2 ("3,five"): must hold 2 finite numbers, like line 1'),
        ("1,2\n3,4\n5\n", 'line 3 ("5"): must hold 2 finite numbers, like line 1'),
        ("1,2\n3,nan\n", 'line 2 ("3,nan"): must hold 2 finite numbers, like line 1'),
        ("1,2\n3,4\n5,6,7\n", 'line 3 ("5,6,7"): must hold'),
        ("1,2\nx,p\n3,4\n", 'line 2 ("x,p"): must hold'),
        ("1," + "0" * 6000, "line 1 has 6002 characters"),
    ],
)
def test_what_is_no_table_is_told_with_its_line(text: str, said: str) -> None:
    with pytest.raises(TableError) as caught:
        only_table(read_tables(text))
    assert said in str(caught.value)


@pytest.mark.parametrize("content", [b"", b" \n", b"\0" * 20, b"PK\x03\x04" + bytes(range(256))])
def test_what_is_no_text_is_refused(content: bytes) -> None:
    with pytest.raises(TableError):
        decode(content)


def test_a_column_with_a_name_and_nothing_in_it_is_left_out():
    (table,) = read_tables("x_m,p_Pa,force_N\n0.1,200,\n0.2,210,\n")
    assert table.header == ("x_m", "p_Pa") and table.values.shape == (2, 2)
