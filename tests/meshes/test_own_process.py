"""A call in a process of its own: what it returns and raises comes back, and whatever else it does stays there."""

from __future__ import annotations

import math
import os
import pickle
import signal
import subprocess
import sys
import time
from operator import truediv

import pytest
from places import ROOT

from meshes import GeometryError, Profile
from meshes.own_process import OwnProcessError, TimeLimitError, run_in_subprocess

LONG = 120.0


@pytest.fixture(autouse=True)
def cold_processes(monkeypatch) -> None:
    """Processes as everybody has them, not the copies that other tests make do with."""
    monkeypatch.setattr("meshes.own_process.subprocess", subprocess)


def test_results_and_own_errors_come_back() -> None:
    assert run_in_subprocess(LONG, math.hypot, 3.0, 4.0) == 5.0
    with pytest.raises(
        GeometryError, match=r"^seat outline: has 0 pieces; a closed outline needs at least 3$"
    ):
        run_in_subprocess(LONG, Profile, "seat", ())
    with pytest.raises(OwnProcessError, match=r"^float division by zero$"):
        run_in_subprocess(LONG, truediv, 1.0, 0.0)
    with pytest.raises(OwnProcessError, match=r"^damaged$"):
        run_in_subprocess(LONG, next, iter(()))


def test_what_hangs_is_ended() -> None:
    started = time.monotonic()
    with pytest.raises(TimeLimitError, match=r"^takes longer than 0.5 s$"):
        run_in_subprocess(0.5, time.sleep, LONG)
    assert time.monotonic() - started < 0.5 * LONG


def test_what_crashes_is_said() -> None:
    with pytest.raises(OwnProcessError, match=r"^crashes \(SIGABRT\)$"):
        run_in_subprocess(LONG, os.abort)
    with pytest.raises(OwnProcessError, match=r"^ended with code 7$"):
        run_in_subprocess(LONG, os._exit, 7)


def test_what_is_printed_is_not_seen(capfd) -> None:
    """Neither by Python nor by a library under it."""
    for stream in (1, 2):
        assert run_in_subprocess(LONG, os.write, stream, b"noise") == 5
    assert run_in_subprocess(LONG, print, "noise") is None
    assert tuple(capfd.readouterr()) == ("", "")


def test_a_script_without_a_main_guard_is_not_run_again(tmp_path) -> None:
    script = tmp_path / "script.py"
    script.write_text(
        "import math\nfrom meshes.own_process import run_in_subprocess\n"
        "print('once', run_in_subprocess(120.0, math.hypot, 3, 4))\n"
    )
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    ended = subprocess.run(
        [sys.executable, str(script)],
        capture_output=True,
        text=True,
        env=environment,
        check=True,
        cwd=tmp_path,
    )
    assert ended.stdout == "once 5.0\n"


@pytest.mark.skipif(not hasattr(signal, "SIGALRM"), reason="needs signals")
def test_a_process_whose_parent_is_gone_ends_itself() -> None:
    """`kill -9` of the program must not leave OpenCASCADE spinning for ever."""
    start = (
        f"import sys; sys.path[:] = {sys.path!r}; "
        "from meshes import own_process; own_process._GRACE = 0.5; own_process.answer()"
    )
    request = pickle.dumps((0.5, time.sleep, (LONG,), {}))
    ended = subprocess.run(
        [sys.executable, "-c", start], input=request, capture_output=True, timeout=LONG, check=False
    )
    assert ended.returncode == -signal.SIGALRM
