"""Every input ends in a sentence: damaged, endless and wrong files, and a disc that is full."""

from __future__ import annotations

import errno
import math
import os
import random
import re
import shutil
import sqlite3
import subprocess
import sys
from contextlib import closing, suppress
from pathlib import Path

import pytest
from places import EXAMPLES

from fem_seal import StudyResult
from fem_seal.case.case import load_case
from fem_seal.cli import app as cli
from fem_seal.errors import InputError, OutputError
from fem_seal.files import UnreadableFileError, check_file, read_bytes, read_text
from fem_seal.studies.session import description
from fem_seal.studies.store import Row, check_rows, create
from fem_seal.studies.study import load_study
from meshes import GeometryError, MeshedBody, read_section
from meshes.gmsh_session import gmsh_session

BODIES = """
[closure]
shape = "ball"
radius = "20 mm"
material = "steel"
[seat]
{seat}
material = "steel"
"""
CONE = 'shape = "cone"\nangle = "45 deg"'
SMOOTH = '[interface]\nlaw = "smooth"\n[load]\nfluid_pressure = "20 bar"\n'
ROUGH = """
[roughness]
spectrum = {{ kind = "{kind}", file = "{file}" }}
[leak]
plasticity = false
[load]
fluid_pressure = "20 bar"
"""


@pytest.fixture
def call(capfd):
    """Run the command line in this process; exit code and what it says, a sentence if it is an error."""

    def run(*arguments):
        code = cli.main([str(argument) for argument in arguments])
        out, err = capfd.readouterr()
        assert "Traceback" not in err
        assert code == 0 or err.startswith(("error: ", "warning: "))
        return code, out, err

    return run


# --- only regular files of a sane size --------------------------------------------------------------------


def write_case(folder: Path, kind: str, file: str) -> list[str]:
    """Arguments of a command that reads `file` in its folder as a file of this kind."""
    case = folder / "c.toml"
    if kind == "case":
        return ["check", str(folder / file)]
    if kind == "profile":
        return ["leak", str(folder / file), str(EXAMPLES / "ball_cone.toml"), "-o", str(folder / "out")]
    if kind == "scan":
        return ["surface", str(folder / file), "-o", str(folder / "out")]
    if kind in ("study", "list", "base"):
        study = folder / (file if kind == "study" else "s.toml")
        base = folder / file if kind == "base" else EXAMPLES / "ball_cone.toml"
        if kind != "study":
            study.write_text(f'base = "{base}"\n[design]\nkind = "list"\nfile = "{file}"\n')
        return ["study", str(study), "-o", str(folder / "out"), "--workers", "0"]
    if kind == "spectrum":
        case.write_text(BODIES.format(seat=CONE) + ROUGH.format(kind="table", file=file))
    elif kind == "scan of a case":
        case.write_text(BODIES.format(seat=CONE) + ROUGH.format(kind="profile", file=file))
    elif kind == "lay":
        case.write_text(BALL + f'[form.lay]\nprofile = "{file}"\n')
    elif kind == "trace":
        case.write_text(BALL + f'[form.seat]\ntrace = {{ file = "{file}", waves = 9 }}\n')
    elif kind == "stress-strain":
        text = (EXAMPLES / "elastoplastic_seat.toml").read_text()
        text, found = re.subn(r"stress_strain = \{[^}]*\}", f'stress_strain = {{ file = "{file}" }}', text)
        assert found
        case.write_text(text)
    else:
        case.write_text(BODIES.format(seat=f'shape = "profile"\nfile = "{file}"') + SMOOTH)
    return ["check", str(case)]


KINDS = {
    "case": "x.toml",
    "study": "x.toml",
    "base": "x.toml",
    "list": "x.csv",
    "profile": "x.csv",
    "scan": "x.csv",
    "scan of a case": "x.csv",
    "spectrum": "x.csv",
    "stress-strain": "x.csv",
    "DXF": "x.dxf",
    "STEP": "x.step",
    "mesh": "x.msh",
}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("thing", ["pipe", "device", "folder", "huge", "nothing"])
def test_only_regular_files_of_a_sane_size_are_read(kind, thing, call, tmp_path) -> None:
    path = tmp_path / KINDS[kind]
    if thing == "pipe":
        os.mkfifo(path)
    elif thing == "device":
        path.symlink_to("/dev/zero")
    elif thing == "folder":
        path.mkdir()
    elif thing == "huge":
        with path.open("wb") as file:
            file.truncate(2**40)
    said = {
        "pipe": "cannot be read (is a pipe; a regular file is needed)",
        "device": "cannot be read (is a device; a regular file is needed)",
        "folder": "cannot be read (is a folder; a regular file is needed)",
        "huge": "cannot be read (is larger than ",
        "nothing": "cannot be read (no such file or directory)",
    }[thing]
    code, _, err = call(*write_case(tmp_path, kind, path.name))
    assert code == 2
    assert said in err
    # a long path is cut where it stands as a value
    assert path.name in err or 'spectrum.file = "/' in err


def test_study_that_is_a_pipe_is_no_study(call, tmp_path) -> None:
    os.mkfifo(tmp_path / "study.sqlite")
    code, _, err = call("study", "report", tmp_path)
    assert code == 2
    assert "holds no study" in err


def test_content_is_that_of_the_file(tmp_path) -> None:
    path = tmp_path / "file"
    path.write_bytes(b"\xef\xbb\xbfa\r\nb\xc3\xa9\rc\n")
    assert read_bytes(path) == path.read_bytes()
    assert read_text(path) == path.read_text(encoding="utf-8-sig") == "a\nbé\nc\n"
    check_file(path, 12)
    for read in (read_bytes, read_text, check_file):
        with pytest.raises(UnreadableFileError, match=r"^cannot be read \(is larger than 0 MB\)$"):
            read(path, 10)
        with pytest.raises(UnreadableFileError, match=r"^cannot be read \(not a file name\)$"):
            read("a\0b")


@pytest.mark.skipif(not Path("/proc/self/status").is_file(), reason="needs /proc")
def test_file_that_says_it_is_empty_is_read_no_further_than_allowed() -> None:
    assert os.stat("/proc/self/status").st_size == 0
    assert read_text("/proc/self/status").startswith("Name:")
    with pytest.raises(UnreadableFileError, match="is larger"):
        read_bytes("/proc/self/status", 10)


# --- studies ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("value", "said"),
    [
        (
            "45",
            "must be a list, a range { start, stop, num } or a distribution; one value belongs into [changes]",
        ),
        ('"45 deg"', "must be a list, a range"),
        ("true", "must be a list, a range"),
        ("1979-05-27", "must be a list, a range"),
        ("[]", "has 0 values"),
    ],
)
@pytest.mark.parametrize("changes", ["", '[changes]\nload.fluid_pressure = "10 bar"\n'])
def test_parameter_without_brackets_is_refused(value, said, changes, call, tmp_path) -> None:
    study = tmp_path / "s.toml"
    study.write_text(f'base = "{EXAMPLES / "ball_cone.toml"}"\n{changes}[parameters]\nseat.angle = {value}\n')
    code, _, err = call("study", study, "-o", tmp_path / "out")
    assert code == 2
    assert "s.toml: parameters.seat.angle" in err
    assert said in err


def test_wrong_change_is_named_beside_a_parameter_without_brackets(call, tmp_path) -> None:
    """The parameters are looked at to see whether they would mend the change."""
    study = tmp_path / "s.toml"
    study.write_text(
        f'base = "{EXAMPLES / "ball_cone.toml"}"\n[changes]\nload.fluid_pressure = "10 mm"\n'
        "[parameters]\nseat.angle = 45\n"
    )
    code, _, err = call("study", study, "-o", tmp_path / "out")
    assert code == 2
    assert 'changes.load.fluid_pressure = "10 mm": unit "mm" does not fit' in err


@pytest.fixture(scope="module")
def done_study(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("study")
    study = folder / "s.toml"
    angles = ", ".join(f'"{45 + 0.001 * n} deg"' for n in range(40))
    study.write_text(
        f'base = "{EXAMPLES / "smooth.toml"}"\nresponses = ["peak_pressure_Pa"]\n'
        f'[changes]\nload.fluid_pressure = "10 bar"\n[parameters]\nseat.angle = [{angles}]\n'
    )
    read = load_study(study)
    store = create(folder / "out" / "study.sqlite", {"seat.angle": "REAL"}, ["peak_pressure_Pa"])
    store.set_design((f"key {n}" for n in range(40)), **description(read))
    store.write([Row(f"key {n}", (0.785 + 1e-5 * n,), (1e8 + n,), None, 1.0) for n in range(40)])
    store.close()
    return folder


def export_of(folder: Path, call, tmp_path: Path) -> tuple[int, str]:
    code, _, err = call("study", "export", folder, tmp_path / "table.csv")
    return code, err


def test_damaged_study_file_says_so(done_study, call, tmp_path) -> None:
    folder = tmp_path / "out"
    shutil.copytree(done_study / "out", folder)
    path = folder / "study.sqlite"
    assert export_of(folder, call, tmp_path) == (0, "")
    whole = path.read_bytes()
    # the pages of the tables, not the first one that makes it a database
    path.write_bytes(whole[:4096] + b"\xa5" * (len(whole) - 4096))
    for command in (["export", folder, tmp_path / "t.csv"], ["report", folder]):
        code, _, err = call("study", *command)
        assert code == 2
        assert "study.sqlite: is damaged (" in err
        assert "restore it from a copy" in err
    code, _, err = call("study", done_study / "s.toml", "-o", folder, "--resume", "--workers", "0")
    assert code == 2
    assert "study.sqlite: is damaged (" in err


@pytest.mark.parametrize(
    "damage",
    [
        "UPDATE about SET text = '{' WHERE name = 'parameters'",
        "UPDATE about SET text = '3' WHERE name = 'inputs'",
        "DELETE FROM about WHERE name = 'inputs'",
        "UPDATE point SET peak_pressure_Pa = 'a lot' WHERE key = 'key 7'",
        "UPDATE point SET peak_pressure_Pa = 1e308 WHERE key = 'key 7'",
        "UPDATE point SET \"seat.angle\" = 1e308 WHERE key = 'key 7'",
        "UPDATE point SET seconds = 'a lot' WHERE key = 'key 7'",
        "UPDATE point SET status = 'x' WHERE key = 'key 7'",
        "UPDATE about SET text = CAST(x'22D522' AS TEXT) WHERE name = 'title'",
        "DELETE FROM about WHERE name = 'constraints'",
        "UPDATE about SET text = '{\"a\": \"1 <\"}' WHERE name = 'constraints'",
    ],
)
def test_study_file_with_wrong_contents_says_so(damage, done_study, call, tmp_path) -> None:
    folder = tmp_path / "out"
    shutil.copytree(done_study / "out", folder)
    connection = sqlite3.connect(folder / "study.sqlite")
    with connection:
        connection.execute(damage)
    connection.close()
    code, err = export_of(folder, call, tmp_path)
    assert code == 2
    assert "study.sqlite: is damaged (" in err


def test_study_file_of_before_is_read_with_the_numbers_it_has(done_study, call, tmp_path) -> None:
    folder = tmp_path / "out"
    shutil.copytree(done_study / "out", folder)
    with closing(sqlite3.connect(folder / "study.sqlite")) as connection, connection:
        for key, number in (("key 3", 1e-300), ("key 7", -1e120)):
            connection.execute("UPDATE point SET peak_pressure_Pa = ? WHERE key = ?", (number, key))
    table = StudyResult(folder).table
    assert table["peak_pressure_Pa"][[3, 7]].tolist() == [1e-300, -1e120]
    assert call("study", "report", folder)[0] == 0


def test_study_file_is_looked_through_once_for_each_of_its_states(done_study, tmp_path, monkeypatch) -> None:
    folder, looks = tmp_path / "out", []
    shutil.copytree(done_study / "out", folder)
    monkeypatch.setattr("fem_seal.studies.store.check_rows", lambda *args: looks.append(check_rows(*args)))
    result = StudyResult(folder)
    assert (result.counts["done"], len(result.table), len(looks)) == (40, 40, 1)
    writer = sqlite3.connect(folder / "study.sqlite")
    with closing(writer):
        # stands in the log alone
        with writer:
            writer.execute("UPDATE point SET peak_pressure_Pa = 2e8 WHERE key = 'key 3'")
        assert StudyResult(folder).table["peak_pressure_Pa"][3] == 2e8
        assert len(looks) == 2
        with writer:
            writer.execute("UPDATE point SET seconds = 'a lot' WHERE key = 'key 3'")
        for _ in range(2):
            with pytest.raises(InputError, match=r"is damaged .*seconds IS NOT NULL"):
                StudyResult(folder)


# What no study writes, and some of what one does.
STORED = [
    *(1e308, -1e308, 5e-324, math.inf, -math.inf, None, -1, 0, 10**18, b"\xff\xfe\x00"),
    *("", "{", "[]", "null", "3", '"x"', '{"a": 1}', "true", "[" * 2000, "9" * 5000, "1e999", "NaN"),
    *("a lot", "\x1b[31m", "done", "failed", "pass", "valid", "peak_pressure_Pa <"),
]
STATEMENTS = [
    *(f"ALTER TABLE point DROP COLUMN {name}" for name in ("reason", "verdict", "peak_pressure_Pa")),
    *("DROP TABLE design", "DROP TABLE about", "DROP TABLE point", "DELETE FROM design", "DELETE FROM about"),
    'ALTER TABLE point RENAME COLUMN "seat.angle" TO x',
    "ALTER TABLE design RENAME COLUMN number TO n",
    "ALTER TABLE point ADD COLUMN more REAL",
    "UPDATE design SET number = number - 5",
    "UPDATE design SET key = 'x' WHERE number = 3",
    "DELETE FROM point WHERE key IN (SELECT key FROM point LIMIT 2)",
]


def spoiled(path: Path, chance: random.Random) -> str:
    """How a study file was damaged: bytes, entries, columns or tables."""
    content = bytearray(path.read_bytes())
    how = chance.choice(["bits", "bits", "end", "zeros", "row", "row", "row", "about", "about", "statement"])
    at = chance.randrange(16, len(content))
    if how == "bits":
        for _ in range(chance.choice([1, 1, 3, 20, 200])):
            content[chance.randrange(16, len(content))] ^= 1 << chance.randrange(8)
    elif how == "end":
        del content[at:]
    elif how == "zeros":
        some = min(chance.choice([10, 100, 4096]), len(content) - at)
        content[at : at + some] = bytes(some)
    path.write_bytes(content)
    if how in ("bits", "end", "zeros"):
        return how
    with closing(sqlite3.connect(path)) as connection, connection, suppress(sqlite3.IntegrityError):
        value = chance.choice(STORED)
        if how == "statement":
            how = chance.choice(STATEMENTS)
            connection.execute(how)
        elif how == "row":
            names = [row[1] for row in connection.execute("PRAGMA table_info(point)")]
            name = chance.choice(names)
            how = f"{name} = {value!r}"
            connection.execute(
                f'UPDATE point SET "{name}" = ? WHERE key = ?', (value, f"key {chance.randrange(40)}")
            )
        else:
            name, text = chance.choice(connection.execute("SELECT name, text FROM about").fetchall())
            place = chance.randrange(len(text))
            letter = chance.choice(["", 2 * text[place], "0", '"', "]", "-", "9e400", "\\"])
            other = chance.choice([value, text[:place] + letter + text[place + 1 :]])
            how = f"about {name} = {other!r}"
            connection.execute("UPDATE about SET text = ? WHERE name = ?", (other, name))
    return how


@pytest.mark.slow
@pytest.mark.parametrize("part", range(10))
def test_study_file_damaged_at_random_says_so_or_is_read(part, done_study, call, tmp_path) -> None:
    """Numpy's warnings are errors here, too; a file that is taken gives the designs that are whole in it."""
    study = load_study(done_study / "s.toml")
    whole = (done_study / "out" / "study.sqlite").read_bytes()
    for n in range(25):
        # a log that was left would be taken for that of the next file
        path = tmp_path / str(n) / "study.sqlite"
        path.parent.mkdir()
        path.write_bytes(whole)
        how = spoiled(path, random.Random(f"study {part} {n}"))
        command = ["report", path.parent] if n == 0 else ["export", path.parent, tmp_path / "t.csv"]
        code, _, err = call("study", *command)
        refused = ("study.sqlite: is damaged (", "holds no study")
        assert code == 0 or (code == 2 and any(one in err for one in refused)), (how, err)
        try:
            store = create(path, {"seat.angle": "REAL"}, ["peak_pressure_Pa"])
        except InputError as error:
            assert re.search(r"is damaged \(|with other columns", str(error)), how
            continue
        with closing(store):
            store.set_design((f"key {n}" for n in range(40)), **description(study))
            assert store.counts()["failed"] == 0, how
            rows = store.rows([f"key {n}" for n in range(40)])
            assert all(row.outputs[0] is None or abs(row.outputs[0]) <= 1e100 for row in rows.values()), how
            assert len(store.table()) == store.counts()["done"] == len(rows), how


def test_study_on_a_full_disc_says_so(done_study) -> None:
    """SQLite reports a full disc when its file may not grow."""
    store = create(done_study / "full" / "study.sqlite", {"seat.angle": "REAL"}, ["peak_pressure_Pa"])
    store._connection.execute("PRAGMA max_page_count = 1")
    with pytest.raises(OutputError, match=r"study\.sqlite: cannot be written \(database or disk is full\)"):
        store.write([Row(f"{n:0500}", (0.8,), (1e8,), None, 1.0) for n in range(100)])
    store.close()


# --- a full disc ------------------------------------------------------------------------------------------


def test_mesh_on_a_full_disc_says_so_and_leaves_no_draft(call, monkeypatch, tmp_path) -> None:
    def full(path, *arguments, **options) -> None:
        path.write_text("half of it")
        # written to an open file, the error knows no name
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(Path, "write_bytes", full)
    code, _, err = call("mesh", EXAMPLES / "smooth.toml", "-o", tmp_path / "out")
    assert code == 1
    assert err == f"error: {tmp_path / 'out' / 'mesh.msh'}: cannot be written (no space left on device)\n"
    assert list((tmp_path / "out").iterdir()) == []


@pytest.mark.slow
@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")
@pytest.mark.parametrize("command", ["--version", "schema", f"check {EXAMPLES / 'ball_cone.toml'}"])
def test_output_to_a_full_disc_says_so(command) -> None:
    with open("/dev/full", "wb") as full:
        ended = subprocess.run(
            [sys.executable, "-m", "fem_seal", *command.split()],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
        )
    assert ended.returncode == 1
    assert ended.stderr == "error: output: cannot be written (no space left on device)\n"


# --- what takes no machine long to read --------------------------------------------------------------------

BALL = (EXAMPLES / "ball_cone.toml").read_text()


def quickly(arguments) -> subprocess.CompletedProcess[str]:
    """A command in a process of its own that gets little memory and time."""
    code = (
        "import resource, sys; resource.setrlimit(resource.RLIMIT_AS, (2 * 2**30, 2 * 2**30));"
        "resource.setrlimit(resource.RLIMIT_CPU, (12, 12));"
        "from fem_seal.cli import app as cli; sys.exit(cli.main(sys.argv[1:]))"
    )
    words = [sys.executable, "-c", code, *map(str, arguments)]
    return subprocess.run(words, capture_output=True, text=True, check=False)


LONG = {
    "quantity of many digits": (
        BALL.replace('"20 mm"', '"' + "9" * 9_000 + ' mm"'),
        "is not a number followed by a unit but 9003 characters; write a length",
    ),
    "longer one": (BALL.replace('"20 mm"', '"' + "9" * 32_000 + ' mm"'), "closure.radius"),
    "number of many digits": (
        BALL.replace("hurst = 0.6", "hurst = " + "9" * 5_000),
        "holds a number of thousands of digits",
    ),
    "deep key": (".".join("a" * 100_000) + " = 1\n" + BALL, "is nested too deeply"),
    "deep keys": (
        "\n".join(".".join("a" * 10_000) + f".b{n} = 1" for n in range(9)),
        "is nested too deeply",
    ),
    "deep key in quotes": (".".join(['"a"'] * 9_000) + " = 1\n", "is nested too deeply"),
    "deep heading": ("[" + ".".join("a" * 9_000) + "]\n", "is nested too deeply"),
    "deep list": ("x = " + "[" * 300 + "]" * 300, "is nested too deeply"),
    "deeper list": ("x = " + "[" * 30_000 + "]" * 30_000, "is nested too deeply"),
    "deep tables": ("x = " + "{a = " * 300 + "1" + "}" * 300, "is nested too deeply"),
    "long text": ('title = "' + "a" * 20_000 + '"\n', "title"),
    "long key": ('"' + "a" * 20_000 + '" = 1\n', "a key, "),
    "finish in many words": (
        BALL.replace("spectrum =", "seat = '" + "a " * 4_000 + "Ra'  #"),
        "is no finish",
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "what"), [*(("case", what) for what in LONG), ("study", "deep key"), ("study", "deep list")]
)
def test_long_input_is_refused_at_once(kind, what, tmp_path) -> None:
    """Read in a process of its own, with little memory and time: these took minutes and ten gigabytes."""
    text, said = LONG[what]
    path = tmp_path / "x.toml"
    path.write_text(text)
    arguments = (
        ["check", path] if kind == "case" else ["study", path, "-o", tmp_path / "out", "--workers", "0"]
    )
    ended = quickly(arguments)
    assert ended.returncode == 2
    assert said in ended.stderr
    assert len(ended.stderr) < 1000


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["scan of a case", "profile", "lay", "trace"])
@pytest.mark.parametrize("line", ["x" + 60_000 * " " + "y", 20_000 * "tip "])
def test_long_line_of_a_table_takes_no_long_time(line, kind, tmp_path) -> None:
    (tmp_path / "x.csv").write_bytes(line.encode() + b"\n" + TABLES[kind])
    ended = quickly(write_case(tmp_path, kind, "x.csv"))
    assert ended.returncode in (0, 2), ended.stderr
    # another reader may still know the scan, but not its unit
    refused = ("characters; a table of numbers is needed", "does not state the unit of x")
    assert ended.returncode == 0 or any(one in ended.stderr for one in refused)


def test_what_people_write_is_not_too_long(tmp_path) -> None:
    """Texts of several lines, points inside texts, long lists."""
    pressures = ", ".join(f'"{1 + 0.01 * n:.2f} bar"' for n in range(1000))
    text = BALL.replace('{ start = "1 bar", stop = "20 bar", num = 20 }', f"[{pressures}]")
    dots = ".".join("1" * 40)
    path = tmp_path / "c.toml"
    path.write_text(
        re.sub("^title = .*$", f'title = """a {dots}\\\n  "b" {dots}"""  # {dots}', text, flags=re.M)
    )
    case = load_case(path)
    assert len(case.load.fluid_pressure) == 1000
    assert case.title == f'a {dots}"b" {dots}'


# --- files that were damaged at random --------------------------------------------------------------------

WORDS = [
    "nan",
    "inf",
    "1e308",
    "-1e308",
    "1e400",
    "0",
    "-1",
    "''",
    "[]",
    "true",
    "1w+20",
    "\0",
    "é",
    "9" * 400,
    "\n",
]


def damaged(content: bytes, chance: random.Random) -> bytes:
    """The content with a few bytes, numbers or words changed, cut out, doubled or put elsewhere."""
    for _ in range(chance.choice([1, 1, 2, 5])):
        at = chance.randrange(len(content) + 1)
        to = min(len(content), at + chance.choice([1, 3, 20, 200]))
        numbers = list(re.finditer(rb"[-+]?\d+\.?\d*(?:[eE][-+]?\d+)?", content))
        words = list(re.finditer(rb"[A-Za-z_]\w*", content))
        how = chance.choice(["byte", "cut", "double", "end", "insert", "number", "number", "number", "word"])
        if how == "byte":
            content = content[:at] + bytes([chance.randrange(256)]) + content[at + 1 :]
        elif how == "cut":
            content = content[:at] + content[to:]
        elif how == "double":
            content = content[:at] + 2 * content[at:to] + content[to:]
        elif how == "end":
            content = content[:at] if chance.random() < 0.3 else content
        elif how == "insert":
            content = content[:at] + chance.choice(WORDS).encode() + content[at:]
        elif how == "number" and numbers:
            one = chance.choice(numbers)
            old = one[0]
            new = chance.choice(
                [chance.choice(WORDS).encode(), b"-" + old, old + b"00000", old + b"e5", old[:-1]]
            )
            content = content[: one.start()] + new + content[one.end() :]
        elif how == "word" and words:
            one, other = chance.choice(words), chance.choice(words)
            content = content[: one.start()] + other[0] + content[one.end() :]
    return content


STRESS_STRAIN = b"plastic_strain, stress_MPa\n0, 300\n0.01, 350\n0.05, 420\n0.2, 500\n"


TEXT_FILES = {
    "case": (EXAMPLES / "ball_on_land.toml").read_bytes(),
    "study": (EXAMPLES / "studies" / "conical_land.toml").read_bytes(),
    "profile": (EXAMPLES / "profile_from_another_code.csv").read_bytes(),
    "scan": (EXAMPLES / "seat_scan.csv").read_bytes()[:20000],
    "spectrum": (EXAMPLES / "studies" / "spectrum.csv").read_bytes(),
    "stress-strain": STRESS_STRAIN,
}


@pytest.mark.slow
@pytest.mark.parametrize("kind", TEXT_FILES)
def test_text_damaged_at_random_ends_in_a_sentence(kind, call, tmp_path) -> None:
    """Numpy's warnings are errors here, too; `call` looks for the sentence."""
    chance = random.Random(f"text {kind}")
    for _ in range(8):
        content = damaged(TEXT_FILES[kind], chance)
        (tmp_path / KINDS[kind]).write_bytes(content)
        if kind == "study":
            ends_in_a_sentence(lambda: load_study(tmp_path / "x.toml"), content)
            continue
        code, _, err = call(*write_case(tmp_path, kind, KINDS[kind]))
        assert code in (0, 2, 3), (err, content)


ABSURD = [
    *("1e308", "-1e308", "1e-308", "5e-324", "nan", "inf", "-inf", "1e400", "9" * 20),
    *("1e150", "1e-150", "1e30", "-1e30", "1e-30", "1e10", "-1e10", "1e5", "0", "-1"),
]


def absurd(content: bytes, chance: random.Random) -> bytes:
    """A table with numbers, columns or rows that no instrument gives."""
    lines = content.split(b"\n")
    how = chance.choice(["numbers", "numbers", "column", "column", "all", "rows", "order"])
    if how == "rows":
        at = chance.randrange(1, len(lines))
        lines[at:at] = lines[at : at + 1] * chance.choice([1, 5, len(lines) // 2])
    elif how == "order":
        chance.shuffle(lines)
    elif how == "numbers":
        for _ in range(chance.choice([1, 4])):
            at = chance.randrange(len(lines))
            word = chance.choice(ABSURD).encode()
            lines[at] = re.sub(rb"(?<![\w.])[-+]?\d[\d.eE+-]*", word, lines[at], count=1)
    else:
        column, word = chance.randrange(2), chance.choice(ABSURD).encode()
        power = chance.choice([b"e100", b"e300", b"e-300", b"e-150", b"e30", b"e-30", b"e12", b"e-12", None])
        for at, line in enumerate(lines):
            cells = re.split(rb"([,;\t])", line)
            if re.match(rb"\s*[-+.\d]", line):
                for place in range(0, len(cells), 2) if how == "all" else [min(2 * column, len(cells) - 1)]:
                    cell = cells[place].strip()
                    cells[place] = word if power is None or b"e" in cell else cell + power
                lines[at] = b"".join(cells)
    return b"\n".join(lines)


def of_rows(header: str, rows) -> bytes:
    return "\n".join([header, *(f"{x:.5g},{z:.5g}" for x, z in rows)]).encode()


TABLES = {
    **{kind: TEXT_FILES[kind] for kind in ("profile", "spectrum", "stress-strain")},
    "scan": (EXAMPLES / "seat_scan.csv").read_bytes()[:9000].rpartition(b"\n")[0],
    "scan of a case": (EXAMPLES / "seat_scan.csv").read_bytes()[:9000].rpartition(b"\n")[0],
    "lay": of_rows("x [um],z [um]", ((5.0 * n, 0.5 * math.sin(0.6 * n)) for n in range(200))),
    "trace": of_rows("angle [deg],deviation [um]", ((4.0 * n, math.sin(0.14 * n)) for n in range(90))),
}


@pytest.mark.slow
@pytest.mark.parametrize("kind", TABLES)
def test_absurd_numbers_in_tables_end_in_a_sentence(kind, call, tmp_path) -> None:
    """Numpy's warnings are errors here, too; as they stand the tables are read."""
    chance = random.Random(f"absurd {kind}")
    for n in range(25):
        content = absurd(TABLES[kind], chance) if n else TABLES[kind]
        (tmp_path / "x.csv").write_bytes(content)
        code, _, err = call(*write_case(tmp_path, kind, "x.csv"))
        assert code in (0, 2, 3), (err, content)
        assert code == 0 or n, err


@pytest.mark.parametrize(
    ("kind", "old", "new", "said"),
    [
        ("lay", b"\n5,", b"\n1e308,", "line 3 holds 1e+308, which is no number"),
        ("lay", b"\n5,", b"\n5e20,", "which is no length"),
        ("scan", b"\n0.001,", b"\n0.001e200,", "which is no measured surface"),
        ("spectrum", b"e-29", b"e-307", "must be positive"),
    ],
)
def test_an_absurd_number_is_named(kind, old, new, said, call, tmp_path) -> None:
    content = TABLES[kind].replace(old, new)
    assert content != TABLES[kind]
    (tmp_path / "x.csv").write_bytes(content)
    code, _, err = call(*write_case(tmp_path, kind, "x.csv"))
    assert code == 2
    assert said in err


def ends_in_a_sentence(read, content: bytes) -> None:
    """Reading ends well, or as wrong input."""
    try:
        read()
    except Exception as error:
        assert cli._explain_error(error)[0] == 2, content


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["STEP", "DXF", "mesh"])
def test_drawing_damaged_at_random_ends_in_a_sentence(kind, capfd, tmp_path) -> None:
    path = tmp_path / KINDS[kind]
    whole = {
        "STEP": step_of_a_seat,
        "DXF": lambda _: (EXAMPLES / "seat.dxf").read_bytes(),
        "mesh": mesh_of_a_seat,
    }[kind](tmp_path)
    read = MeshedBody.read if kind == "mesh" else read_section
    # what stands in the header of a DXF is hardly looked at
    start = whole.rindex(b"ENTITIES") if kind == "DXF" else 0
    capfd.readouterr()
    chance = random.Random(f"drawing {kind}")
    for _ in range(5):
        content = whole[:start] + damaged(whole[start:], chance)
        path.write_bytes(content)
        ends_in_a_sentence(lambda: read(path, "seat", time_limit=10.0), content)
    assert tuple(capfd.readouterr()) == ("", "")


SECTION = [(8, 0), (40, 0), (40, 20), (20, 20), (8, 8)]


def mesh_of_a_seat(folder: Path) -> bytes:
    """Its conical face is named."""
    path = folder / "seat.msh"
    with gmsh_session("seat") as gmsh:
        geo = gmsh.model.geo
        points = [geo.addPoint(1e-3 * r, 1e-3 * z, 0, 8e-3) for r, z in SECTION]
        lines = [geo.addLine(a, b) for a, b in zip(points, [*points[1:], points[0]], strict=True)]
        face = geo.addPlaneSurface([geo.addCurveLoop(lines)])
        geo.synchronize()
        gmsh.model.addPhysicalGroup(1, [lines[3]], name="seat_face")
        gmsh.model.addPhysicalGroup(2, [face], name="seat")
        gmsh.option.setNumber("Mesh.MeshSizeFromPoints", 1)
        gmsh.model.mesh.generate(2)
        gmsh.write(str(path))
    return path.read_bytes()


def step_of_a_seat(folder: Path) -> bytes:
    """A face with five edges."""
    path = folder / "seat.step"
    with gmsh_session("seat") as gmsh:
        occ = gmsh.model.occ
        points = [occ.addPoint(r, z, 0) for r, z in SECTION]
        lines = [occ.addLine(a, b) for a, b in zip(points, [*points[1:], points[0]], strict=True)]
        occ.addPlaneSurface([occ.addCurveLoop(lines)])
        occ.synchronize()
        gmsh.write(str(path))
    return path.read_bytes()


def step_case(folder: Path, content: bytes, more: str = "") -> Path:
    """A case with this drawing of a seat."""
    (folder / "x.step").write_bytes(content)
    case = folder / "c.toml"
    case.write_text(BODIES.format(seat=f'shape = "profile"\nfile = "x.step"\n{more}') + SMOOTH)
    return case


@pytest.mark.slow
def test_typing_error_in_a_drawing_does_not_hang_the_program(call, tmp_path) -> None:
    """OpenCASCADE never comes back from this number, and it writes to the terminal."""
    whole = step_of_a_seat(tmp_path)
    assert b"(40.,0.,0.)" in whole
    assert call("check", step_case(tmp_path, whole))[0] == 0
    before, number, after = whole.rpartition(b"(40.,0.,0.)")
    assert number
    case = step_case(tmp_path, before + b"(40.1e3080.,0.)" + after, 'time_limit = "1 s"')
    code, _, err = call("check", case)
    assert code == 2
    assert err == (
        f'error: {case}: seat.file = "x.step": cannot be read as STEP (takes longer than 1 s); open it in a CAD '
        "program and export it anew, or allow a longer time_limit\n"
    )


def test_drawing_that_cannot_be_read_is_waited_for_once(tmp_path, monkeypatch) -> None:
    """A study builds its case hundreds of times."""
    calls = []

    def read(path, *arguments, **options) -> None:
        calls.append(options["time_limit"])
        raise GeometryError(f"{path.name}: cannot be read as STEP (takes longer than 20 s)")

    monkeypatch.setattr("fem_seal.case.drawn.read_section", read)
    case = step_case(tmp_path, b"")
    for _ in range(3):
        with pytest.raises(InputError, match=r'seat\.file = "x\.step": cannot be read as STEP'):
            load_case(case)
    assert calls == [20.0]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("old", "new", "said", "limit"),
    [
        (b"CLOSED_SHELL", b"OPEN", "cannot be read as STEP", "10 s"),
        # OpenCASCADE never comes back from this one, from the others in hundredths of a second
        (b"(40.,0.,0.)", b"(nan,0.,0.)", "cannot be read as STEP", "1 s"),
        (b"(40.,0.,0.)", b"(1e30,0.,0.)", "x.step", "10 s"),
        (b"SURFACE_CURVE", b"SURFACE", "x.step", "10 s"),
    ],
)
def test_damaged_step_ends_in_a_sentence(old, new, said, limit, call, tmp_path) -> None:
    case = step_case(tmp_path, step_of_a_seat(tmp_path).replace(old, new), f'time_limit = "{limit}"')
    code, _, err = call("check", case)
    assert code in (0, 2)
    assert code == 0 or said in err


@pytest.mark.parametrize("number", ["nan", "inf", "1e300", "1w+20", "", "9" * 400])
def test_dxf_with_a_number_that_is_none(number, tmp_path) -> None:
    whole = (EXAMPLES / "seat.dxf").read_bytes()
    start = whole.rindex(b"ENTITIES")
    drawn, found = re.subn(rb"( 10\r?\n)[^\r\n]+", rb"\g<1>" + number.encode(), whole[start:], count=1)
    assert found
    path = tmp_path / "x.dxf"
    path.write_bytes(whole[:start] + drawn)
    with pytest.raises(
        GeometryError, match=r"^x\.dxf: (cannot be read as DXF \(|holds a point at \(|a curve near )"
    ):
        read_section(path, "seat", layer="SEAT")


def test_dxf_with_blocks_in_blocks_without_end(tmp_path) -> None:
    ezdxf = pytest.importorskip("ezdxf", reason="DXF files need ezdxf")
    drawing = ezdxf.new(units=4)
    for n in range(12):
        block = drawing.blocks.new(f"B{n}")
        for _ in range(10):
            if n:
                block.add_blockref(f"B{n - 1}", (0, 0))
            else:
                block.add_line((1, 0), (2, 0))
    drawing.modelspace().add_blockref("B11", (0, 0))
    drawing.saveas(tmp_path / "x.dxf")
    with pytest.raises(GeometryError, match=r"cannot be read as DXF \(takes longer than 1 s\)"):
        read_section(tmp_path / "x.dxf", "seat", time_limit=1.0)
