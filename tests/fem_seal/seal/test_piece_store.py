"""The user's store of finished pieces: taken by every case, bounded, safe with several processes."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from time import monotonic, sleep
from typing import NamedTuple

import pytest

from fem_seal.seal.piece_store import PieceStore
from fem_seal.seal.pieces import work


class Square(NamedTuple):
    square: int


class Squares:
    """Squares that take so many seconds; each calculation leaves a file."""

    def __init__(self, calculations: Path, seconds: float = 0.0):
        self.calculations, self.seconds = calculations, seconds

    def keys(self, piece):
        return [f"{piece:020x}"]

    def record(self, values):
        return Square(**values)

    def records(self, piece):
        sleep(self.seconds)
        (self.calculations / f"{piece} {os.getpid()} {monotonic()}").touch()
        yield Square(piece**2)


@pytest.fixture
def store(tmp_path, monkeypatch):
    monkeypatch.setenv("FEM_SEAL_CACHE", str(tmp_path / "cache"))
    (tmp_path / "calculations").mkdir()
    return PieceStore(tmp_path / "cache")


def squares(store, numbers, folder=None, said=None, jobs=1, seconds=0.0):
    simulation = Squares(store.folder.parent / "calculations", seconds)
    progress = (lambda text: None) if said is None else said.append
    records = work(simulation, numbers, folder, jobs=jobs, progress=progress)
    assert {n: record.square for n, (record,) in records.items()} == {n: n**2 for n in numbers}
    return len(list(simulation.calculations.iterdir()))


@pytest.mark.parametrize("jobs", [1, 2])
def test_another_case_takes_what_is_kept(store, tmp_path, jobs):
    assert squares(store, [1, 2, 3], tmp_path / "first", jobs=jobs) == 3
    said: list[str] = []
    assert squares(store, [1, 2, 3, 4], tmp_path / "second", said, jobs=jobs) == 4
    assert said == ["3 of 4 pieces are there already", "direct simulation: 4 of 4 pieces"]
    # the folder of the second case is whole by itself
    assert {path.name: path.read_text() for path in (tmp_path / "first" / "pieces").iterdir()}.items() <= {
        path.name: path.read_text() for path in (tmp_path / "second" / "pieces").iterdir()
    }.items()


def test_empty_variable_switches_it_off(store, monkeypatch):
    monkeypatch.setenv("FEM_SEAL_CACHE", "")
    assert PieceStore.of_user() is None
    assert squares(store, [1]) == 1
    assert squares(store, [1]) == 2
    assert not store.folder.exists()


def test_folder_is_that_of_the_system(monkeypatch, tmp_path):
    monkeypatch.delenv("FEM_SEAL_CACHE")
    for name in ("HOME", "USERPROFILE"):
        monkeypatch.setenv(name, str(tmp_path))
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    monkeypatch.delenv("LOCALAPPDATA", raising=False)
    for system, folder in (
        ("linux", ".cache"),
        ("darwin", "Library/Caches"),
        ("win32", "AppData/Local"),
    ):
        monkeypatch.setattr("sys.platform", system)
        assert PieceStore.of_user() == PieceStore(tmp_path / folder / "fem-seal")
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "elsewhere"))
    assert PieceStore.of_user() == PieceStore(tmp_path / "elsewhere" / "fem-seal")


@pytest.mark.parametrize("content", [b"[{", b"", b"\xff\xfe\x00", b"[]", b'[{"cube": 8}]', b"7"])
def test_damaged_file_is_named_and_calculated_again(store, content):
    squares(store, [2, 3])
    path = store.path(f"{2:020x}")
    path.write_bytes(content)
    said: list[str] = []
    assert squares(store, [2, 3], said=said) == 3
    assert said[0] == f"{path}: is damaged, and is calculated again"
    assert squares(store, [2, 3]) == 3


def test_what_was_not_read_for_longest_goes_first(store):
    squares(store, [1, 2, 3, 4])
    for age, number in enumerate([4, 3, 2, 1]):
        os.utime(store.path(f"{number:020x}"), (1e9 - age, 1e9 - age))
    # the oldest is read, which makes it the newest
    squares(store, [1])
    PieceStore(store.folder, limit=2 * 4096).shrink()
    assert [n for n in (1, 2, 3, 4) if store.path(f"{n:020x}").exists()] == [1, 4]


def test_a_run_leaves_no_more_than_the_limit(store, monkeypatch):
    monkeypatch.setattr(PieceStore, "of_user", classmethod(lambda cls: cls(store.folder, 4096)))
    squares(store, [1, 2, 3])
    assert len(list((store.folder / "pieces").glob("*/*"))) == 1


def test_folder_that_cannot_be_written_stops_nobody(store):
    store.folder.write_text("a file where the folder should be")
    assert squares(store, [1, 2]) == 2


PROGRAM = """
import sys
from pathlib import Path
sys.path.insert(0, {tests!r})
from test_piece_store import PieceStore, squares
print("ready", flush=True)
sys.stdin.readline()
squares(PieceStore(Path({folder!r})), [7], seconds={seconds})
"""


def process(store, seconds):
    text = PROGRAM.format(tests=str(Path(__file__).parent), folder=str(store.folder), seconds=seconds)
    started = subprocess.Popen(
        [sys.executable, "-c", text], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    assert started.stdout.readline() == "ready\n"
    return started


def test_two_processes_calculate_a_face_once(store):
    both = [process(store, seconds=1.0) for _ in range(2)]
    for started in both:
        started.stdin.write("\n")
        started.stdin.flush()
    for started in both:
        started.communicate(timeout=60)
        assert started.returncode == 0
    assert len(list((store.folder.parent / "calculations").iterdir())) == 1


def test_nobody_waits_for_a_process_that_has_died(store):
    dead = process(store, seconds=600.0)
    dead.stdin.write("\n")
    dead.stdin.flush()
    lock = store.folder / "locks" / f"{7:020x}"[:3]
    while not lock.exists():
        sleep(0.05)
    sleep(0.2)
    dead.kill()
    dead.communicate()
    begin = monotonic()
    assert squares(store, [7]) == 1
    assert monotonic() - begin < 10.0
