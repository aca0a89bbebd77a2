"""One function of many items in copies of this process."""

import os
import subprocess
import sys
import time
from multiprocessing import active_children
from threading import Thread
from unittest.mock import Mock

import numpy as np
import pytest
from sample_results import rough_result

from fem_seal import processes
from fem_seal.answers.uncertainty import leak_interval
from fem_seal.case.tables import Spread, Uncertainty
from fem_seal.errors import ConvergenceError
from fem_seal.processes import Processes, can_copy, fork_map, usable_cores
from leak import hertz_line
from meshes.gmsh_session import gmsh_session

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="no copies there")
HERE = os.getpid()


@pytest.mark.parametrize("processes", [1, 2, 3, 9])
@pytest.mark.parametrize("items", [0, 1, 2, 7])
def test_results_stand_in_the_order_of_the_items(items, processes):
    assert fork_map(lambda n: n**2, range(items), processes) == [n**2 for n in range(items)]


def test_every_process_has_its_share():
    pids = fork_map(lambda _: os.getpid(), range(6), 3)
    assert pids[:3] == pids[3:] and pids[0] == HERE and HERE not in pids[1:3]


@pytest.mark.parametrize("processes", [1, 2, 3])
def test_the_error_is_that_of_the_first_item_that_fails(processes):
    def fails(n):
        if n >= 4:
            raise ConvergenceError(f"item {n}")
        return n

    with pytest.raises(ConvergenceError, match="item 4"):
        fork_map(fails, range(8), processes)


def test_the_share_of_a_copy_that_died_is_calculated_here():
    # as a run does before, and without a word from the system about a pipe to nobody
    with gmsh_session("seat"):
        pass

    def dies_in_a_copy(n):
        if os.getpid() != HERE:
            os._exit(9)
        return -n

    assert fork_map(dies_in_a_copy, range(5), 2) == [0, -1, -2, -3, -4]


def test_an_interruption_ends_the_copies():
    def interrupted(n):
        if os.getpid() == HERE:
            raise KeyboardInterrupt
        time.sleep(30)

    begin = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        fork_map(interrupted, range(4), 2)
    assert time.monotonic() - begin < 10 and not active_children()


def test_no_copies_beside_threads_or_in_a_process_that_was_started():
    found = []
    thread = Thread(target=lambda: found.append(can_copy()))
    thread.start()
    thread.join()
    assert found == [False]
    assert fork_map(lambda _: can_copy(), range(2), 2)[1] is False


@pytest.mark.slow
def test_where_nothing_can_be_copied_an_interval_is_the_same_to_the_last_bit(monkeypatch):
    in_copies = Mock(side_effect=processes._in_copies)
    monkeypatch.setattr(processes, "_in_copies", in_copies)
    monkeypatch.setattr(processes, "usable_cores", lambda: 2)
    about = Uncertainty(samples=64, youngs_modulus=Spread(relative=0.1))
    found = {}
    for copies in (True, False):
        monkeypatch.setattr(processes, "can_copy", lambda copies=copies: copies)
        found[copies] = leak_interval(rough_result(), about)
        assert in_copies.called is copies
        in_copies.reset_mock()
    assert np.ptp(found[True].leak_rate) > 0
    assert np.array_equal(found[True].leak_rate, found[False].leak_rate)


def test_processes_are_started_as_on_windows_and_macos(monkeypatch):
    monkeypatch.setattr(processes, "START", "spawn")
    with Processes(1) as others:
        # started by this process, and no copy of it
        assert others.submit(os.getppid).result(timeout=120) == HERE
        assert (
            others.submit(eval, "'sample_results' in __import__('sys').modules").result(timeout=120) is False
        )
        assert others.submit(can_copy).result(timeout=120) is False
        # as it would be calculated here, to the last bit
        assert others.submit(hertz_line, 1e4, 1e11, 0.02).result(timeout=120) == hertz_line(1e4, 1e11, 0.02)


def test_copies_beside_the_wheel_that_turns_on_a_terminal():
    """In a process of its own: here the tests have threads."""
    code = """
from io import StringIO
from threading import active_count
from rich.console import Console
from fem_seal.processes import can_copy, fork_map
with Console(file=StringIO(), force_terminal=True).status("sampling"):
    found = active_count() > 1, can_copy(), fork_map(lambda n: n**2, range(6), 2)
print(*found)
"""
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True
    )
    assert done.stdout == "True True [0, 1, 4, 9, 16, 25]\n"


def test_some_core_may_be_used():
    assert 1 <= usable_cores() <= os.cpu_count()
