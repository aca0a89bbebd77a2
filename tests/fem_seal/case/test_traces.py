"""Roundness traces as measuring instruments write them: every file holds the same two waves."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from fem_seal.case.traces import read_trace
from fem_seal.errors import TextTableError

ANGLE = 5.0 * np.arange(72)
DEVIATION = 1.5 * np.cos(2 * np.radians(ANGLE) - 0.3) + 0.4 * np.cos(5 * np.radians(ANGLE))


def rows(
    separator: str = ",", point: str = ".", angle: np.ndarray = ANGLE, deviation: np.ndarray = DEVIATION
) -> str:
    return "".join(
        f"{phi:.10f}{separator}{value:.10f}\n".replace(".", point)
        for phi, value in zip(angle, deviation, strict=True)
    )


def column(point: str = ".", deviation: np.ndarray = DEVIATION) -> str:
    return "".join(f"{value:.10f}\n".replace(".", point) for value in deviation)


def with_readings(separator: str, lost: dict[int, str]) -> str:
    """Rows with other cells in place of some readings."""
    lines = rows(separator).splitlines()
    for number, reading in lost.items():
        lines[number] = lines[number].split(separator)[0] + reading
    return "\n".join(lines)


FILES = {
    "csv": "angle [deg], deviation [um]\n" + rows(),
    "spreadsheet in German": "Winkel [°];Abweichung [µm]\n" + rows(";", ","),
    "tabs with decimal commas": "Angle [deg]\tDeviation [µm]\n" + rows("\t", ","),
    "spaces": "angle_deg deviation_um\n" + rows("   "),
    "spaces, brackets": "Angle [deg]  Deviation [um]\n" + rows("  "),
    "spaces with decimal commas": "Angle [deg] Deviation [um]\n" + rows(" ", ","),
    "radian": "phi [rad], r [um]\n" + rows(angle=np.radians(ANGLE)),
    "signed angles": "angle [deg], deviation [um]\n" + rows(angle=np.where(ANGLE > 180, ANGLE - 360, ANGLE)),
    "with the point at 360": "angle [deg], deviation [um]\n"
    + rows(angle=np.append(ANGLE, 360), deviation=np.append(DEVIATION, DEVIATION[0])),
    "no unit of a turn in degrees": "angle, deviation [um]\n" + rows(),
    "units of DIN": "Winkel / °;Abweichung / µm\n" + rows(";"),
    "units without brackets": "Angle deg;Dev um\n" + rows(";"),
    "units in words": "Winkel in Grad;Abweichung in µm\n" + rows(";", ","),
    "microns": "Angle (degrees),Deviation (microns)\n" + rows(),
    "greek letter for micro": "Angle [deg];Deviation [μm]\n" + rows(";"),
    "millimetres": "Angle [deg];Deviation [mm]\n" + rows(";", deviation=DEVIATION * 1e-3),
    "units in a line of their own": "Angle;Deviation\ndeg;um\n" + rows(";"),
    "units in brackets in a line of their own": "Winkel;Abweichung\n[°];[µm]\n" + rows(";", ","),
    "preamble": "Roundness of seat 4711\nDate: 01.02.2024\nRONt 3.1 µm\nPoints;72\nRadius;14.1\n\n"
    "angle [deg];deviation [um]\n" + rows(";"),
    "comments": "# seat 4711\n# angle [deg], deviation [um]\n" + rows(),
    "results below": "angle [deg];deviation [um]\n" + rows(";") + "RONt;3.2\nRONq;1.1\nEnd\n",
    "separator at the end": "angle [deg];deviation [um];\n" + rows(";").replace("\n", ";\n"),
    "quotes": '"Angle [deg]","Deviation [um]"\n'
    + rows('","').replace("\n", '"\n"').rstrip('"').join(['"', ""]),
    "deviation first": "Deviation [um], Angle [deg]\n" + rows(angle=DEVIATION, deviation=ANGLE),
    "numbered": "No.;Angle [deg];Deviation [um]\n"
    + "".join(f"{n};{line}\n" for n, line in enumerate(rows(";").splitlines(), start=1)),
    "radius beside it": "Angle [deg];Radius [mm];Deviation [um]\n"
    + "".join(f"{line.replace(';', ';14.1;')}\n" for line in rows(";").splitlines()),
    "lost readings": "angle [deg];deviation [um]\n"
    + with_readings(";", {10: ";", 11: ";---", 12: ";NaN", 13: ";***", 14: ";BAD", 15: ""}),
    "lost readings and commas": "angle [deg],deviation [um]\n" + with_readings(",", {10: ",", 11: ",n/a"}),
    "lost readings and tabs": "angle [deg]\tdeviation [um]\n" + with_readings("\t", {0: "\t", 71: ""}),
    "one column": "deviation [um]\n" + column(),
    "one column with decimal commas": "Abweichung [µm]\n" + column(","),
    "one column with the point at 360": "deviation [um]\n"
    + column(deviation=np.append(DEVIATION, DEVIATION[0])),
    "one column with lost readings": "deviation [um]\n"
    + "\n".join("---" if n in (5, 6) else line for n, line in enumerate(column().splitlines())),
}


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "trace.txt"


def check(file: Path, unit: str | None = None) -> None:
    """To 1e-5 of the waves, also with a few readings lost."""
    found = {one.waves: one for one in read_trace(file, unit).waves(8)}
    assert found[2].amplitude == pytest.approx(1.5e-6, rel=1e-5)
    assert found[2].phase == pytest.approx(0.3, abs=1e-5)
    assert found[5].amplitude == pytest.approx(0.4e-6, rel=1e-5)
    assert found[5].phase == pytest.approx(0.0, abs=1e-5)
    assert all(one.amplitude < 1e-11 for one in found.values() if one.waves not in (2, 5))


@pytest.mark.parametrize("name", FILES)
def test_files_of_instruments(file: Path, name: str) -> None:
    file.write_text(FILES[name], encoding="utf-8")
    check(file)


@pytest.mark.parametrize("encoding", ["utf-8-sig", "latin-1", "utf-16"])
@pytest.mark.parametrize("ends", ["\n", "\r\n", "\r"])
def test_encodings_and_line_ends(file: Path, encoding: str, ends: str) -> None:
    file.write_bytes(FILES["spreadsheet in German"].replace("\n", ends).encode(encoding))
    check(file)


def test_a_unit_given_beside_the_file(file: Path) -> None:
    file.write_text(rows(";"))
    check(file, "um")
    file.write_text(column())
    check(file, "um")
    file.write_text("angle [deg];deviation [mm]\n" + rows(";"))
    check(file, "um")


def test_an_offset_is_no_wave(file: Path) -> None:
    """A radius instead of a deviation: 14.1 mm of mean, and ten digits to hold both."""
    lines = (f"{phi:.3f};{14.1 + 1e-3 * dev:.10f}" for phi, dev in zip(ANGLE, DEVIATION, strict=True))
    file.write_text("angle [deg];radius [mm]\n" + "\n".join(lines))
    check(file)


def test_a_closed_turn_and_one_that_only_looks_like_it(file: Path) -> None:
    """An odd number of readings whose last is the first holds the point at 360 degrees; other readings stay."""
    for deviation, left in (
        (np.append(DEVIATION, DEVIATION[0]), 72),
        (np.append(DEVIATION[:-1], DEVIATION[0]), 72),
        (DEVIATION[:-1], 71),
    ):
        file.write_text("deviation [um]\n" + column(deviation=deviation))
        trace = read_trace(file)
        assert len(trace.angle) == left
        assert trace.widest_gap == pytest.approx(2 * math.pi / left)


WRONG = {
    "nothing": ("", "is empty"),
    "a few numbers": ("angle [deg], deviation [um]\n0,1\n90,2\n", "has fewer than 8 rows of numbers"),
    "words": ("a roundness of two microns\n" * 20, "no rows of numbers"),
    "no unit": (
        "angle [deg], deviation\n" + rows(),
        "does not give the unit of the deviation; write it into the",
    ),
    "no unit of small angles": (
        "angle, deviation [um]\n" + rows(angle=np.radians(ANGLE)),
        "does not give the unit of the angle; write it",
    ),
    "gon": (
        "angle [gon], deviation [um]\n" + rows(),
        'has an angle whose unit "gon" is unknown; write an angle',
    ),
    "points in a plane": ("X [mm];Y [mm]\n" + rows(";"), "a trace has the columns angle and deviation"),
    "pressure": ("angle [deg], deviation [bar]\n" + rows(), 'has a deviation whose unit "bar" does not fit'),
    "two turns": ("angle [deg], deviation [um]\n" + rows(angle=2 * ANGLE), "goes 1.97 times around the axis"),
    "metres": ("angle [deg], deviation [m]\n" + rows(), "mm; check their unit"),
    "all lost": (
        "angle [deg], deviation [um]\n" + "".join(f"{phi},---\n" for phi in ANGLE),
        "has only 0 points with a number; at least 8 are needed",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_is_wrong_is_said_with_its_remedy(file: Path, name: str) -> None:
    text, message = WRONG[name]
    file.write_text(text, encoding="utf-8")
    with pytest.raises(TextTableError, match=message):
        read_trace(file)


def test_no_text_and_no_file(file: Path) -> None:
    with pytest.raises(TextTableError, match="cannot be read"):
        read_trace(file)
    file.write_bytes(b"\x00\x01\xfe\x07" * 100)
    with pytest.raises(TextTableError, match="is not a text file"):
        read_trace(file)
