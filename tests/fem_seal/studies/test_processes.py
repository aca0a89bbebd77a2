"""A study survives the death of its processes: real workers and a real coordinator, killed by signal."""

from __future__ import annotations

import json
import os
import signal
import socket
import sqlite3
import subprocess
import sys
import time
from contextlib import ExitStack, suppress
from pathlib import Path
from threading import Event, Thread

import pandas as pd
import pytest
from places import EXAMPLES

from fem_seal import StudyResult, load_study
from fem_seal.errors import ClusterError
from fem_seal.studies.session import run_study

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="finds the workers in /proc"),
]

CASE = EXAMPLES / "ball_cone.toml"
STUDY = f"""
base = "{CASE}"
responses = ["peak_pressure_Pa", "line_load_N_per_m"]

[changes]
mesh.contact_size = "100 um"

[parameters]
seat.angle = {{ start = "40 deg", stop = "50 deg", num = 12 }}
load.fluid_pressure = {{ start = "5 bar", stop = "20 bar", num = 6 }}
"""
DESIGNS = 12 * 6
# Loaded by each worker, which may do so twice: designs that take their time and little of the processor's.
SLOW = """
import time
from fem_seal.studies import responses

def slow(case, swift=responses.warmed):
    time.sleep(0.1)
    return swift(case)

if responses.warmed.__name__ != "slow":
    responses.warmed = slow
"""
# Longest wait for anything; on an idle machine it is seconds.
PATIENCE = 120.0


@pytest.fixture(autouse=True, scope="module")
def clusters():
    pytest.importorskip("distributed")


@pytest.fixture(autouse=True)
def never_forever():
    """A test that waits for a cluster that is gone fails instead of standing still."""

    def too_long(number, frame):
        raise TimeoutError("the test stood still")

    before = signal.signal(signal.SIGALRM, too_long)
    signal.alarm(int(2 * PATIENCE))
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)


@pytest.fixture
def study_file(tmp_path, monkeypatch):
    (tmp_path / "slow.py").write_text(SLOW)
    monkeypatch.setenv("DASK_DISTRIBUTED__WORKER__PRELOAD", str(tmp_path / "slow.py"))
    path = tmp_path / "study.toml"
    path.write_text(STUDY)
    return path


def start(study_file, folder, *options, quiet=True):
    """A study in processes of their own, as a terminal starts it."""
    command = [
        sys.executable,
        "-m",
        "fem_seal",
        "study",
        str(study_file),
        "-o",
        str(folder),
        "--workers",
        "2",
        *(["-q"] if quiet else []),
    ]
    return subprocess.Popen([*command, *options], stderr=subprocess.PIPE, text=True, start_new_session=True)


def rows(folder):
    try:
        with sqlite3.connect(f"file:{folder / 'study.sqlite'}?mode=ro", uri=True) as file:
            return dict(file.execute("SELECT key, seconds FROM point").fetchall())
    except sqlite3.Error:
        return {}


def wait_for(condition, process=None):
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end, "took too long"
        assert process is None or process.poll() is None, process.stderr.read()
        time.sleep(0.05)


def workers_of(pid):
    """Processes below `pid` that calculate, by their parents in /proc."""
    parents, names = {}, {}
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                status = (entry / "status").read_text()
                names[int(entry.name)] = (entry / "cmdline").read_text().replace("\0", " ")
            except OSError:
                continue
            parents[int(entry.name)] = int(status.split("PPid:")[1].split()[0])
    # copies of one process that has loaded everything, which is itself no worker
    (server,) = [
        one
        for one, parent in parents.items()
        if parent == pid and "multiprocessing.forkserver" in names.get(one, "")
    ] or [None]
    return [one for one, parent in parents.items() if server is not None and parent == server]


def alive(pid):
    try:
        return Path(f"/proc/{pid}/status").read_text().split("State:")[1].split()[0] != "Z"
    except OSError:
        return False


@pytest.mark.slow
def test_killed_worker_and_killed_coordinator_change_nothing(study_file, tmp_path):
    folder = tmp_path / "disturbed"
    coordinator = start(study_file, folder)
    try:
        wait_for(lambda: len(rows(folder)) > 10, coordinator)
        workers = workers_of(coordinator.pid)
        assert len(workers) == 2
        os.kill(workers[0], signal.SIGKILL)
        before = len(rows(folder))
        wait_for(lambda: len(rows(folder)) > before + 10, coordinator)
        # the dead worker has a successor
        wait_for(lambda: len(set(workers_of(coordinator.pid)) - {workers[0]}) == 2, coordinator)
        workers = workers_of(coordinator.pid)
    finally:
        coordinator.send_signal(signal.SIGKILL)
        coordinator.wait()
    kept = rows(folder)
    assert 0 < len(kept) < DESIGNS, "the study ended before it was killed"
    wait_for(lambda: not any(map(alive, workers)))

    again = start(study_file, folder, "--resume")
    assert again.wait(PATIENCE) == 0, again.stderr.read()
    after = rows(folder)
    # nothing lost, nothing calculated twice: a row that was there is the same row, down to the time it took
    assert len(after) == DESIGNS
    assert {key: after[key] for key in kept} == kept

    whole = run_study(load_study(study_file), folder=tmp_path / "whole", workers=0)
    assert whole.counts == {"done": DESIGNS, "failed": 0, "open": 0}
    pd.testing.assert_frame_equal(StudyResult(folder).table, whole.table, check_exact=True)


@pytest.mark.parametrize("calculating", [False, True], ids=["starting", "calculating"])
def test_ctrl_c_ends_with_one_line(study_file, tmp_path, calculating):
    """A terminal sends it to all processes: none of them complains, and no design fails of it."""
    folder = tmp_path / "interrupted"
    coordinator = start(study_file, folder, quiet=False)
    try:
        wait_for(lambda: rows(folder) if calculating else workers_of(coordinator.pid), coordinator)
    finally:
        os.killpg(coordinator.pid, signal.SIGINT)
    told = coordinator.communicate(timeout=PATIENCE)[1]
    assert coordinator.returncode == 130
    assert "interrupted; the designs that are done are kept, --resume" in told.splitlines()[-1]
    assert "Traceback" not in told
    assert bool(rows(folder)) == calculating
    if calculating:
        assert StudyResult(folder).counts["failed"] == 0


def test_a_port_that_is_taken_is_passed_over_in_silence(recwarn):
    from fem_seal.studies.pools import local_client

    with ExitStack() as taken:
        # by somebody else, perhaps
        with suppress(OSError):
            taken.enter_context(socket.create_server(("", 8787), reuse_port=True))
        taken.enter_context(local_client(1))
        assert not [str(one.message) for one in recwarn if "8787" in str(one.message)]


@pytest.mark.slow
def test_a_design_that_kills_every_worker_costs_itself_only(tmp_path):
    """Whoever calculates the third design dies at once."""
    from fem_seal.studies.pools import Cluster, local_client
    from fem_seal.studies.work import DesignSpec

    study = load_study(_small(tmp_path))
    recipe = DesignSpec.of(study)
    deadly = float(study.points[2, 0])
    with local_client(2) as client:
        client.register_plugin(_arming(deadly))
        cluster = Cluster(client, 1, PATIENCE)
        found = [row for rows in cluster.results(recipe, [study.points]) for row in rows]
    reasons = {row.inputs[0]: row.reason for row in found}
    assert len(found) == 4
    assert "every worker that calculated it died" in reasons.pop(deadly)
    assert set(reasons.values()) == {None}


@pytest.mark.slow
def test_a_scheduler_by_its_address(tmp_path):
    """Scheduler and worker are started by themselves, as on a cluster; the command line is told where they are."""
    study, place = _small(tmp_path), tmp_path / "scheduler.json"
    dask = [sys.executable, "-m", "dask"]
    where = ["--scheduler-file", str(place), "--no-dashboard"]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    processes = [
        subprocess.Popen([*dask, "scheduler", "--host", "127.0.0.1", "--port", "0", *where], **quiet)
    ]
    try:
        wait_for(place.exists)
        processes.append(subprocess.Popen([*dask, "worker", "--nthreads", "1", *where], **quiet))
        address = json.loads(place.read_text())["address"]
        command = [sys.executable, "-m", "fem_seal", "study", str(study), "-o", str(tmp_path / "far"), "-q"]
        subprocess.run([*command, "--scheduler", address], check=True, timeout=PATIENCE)
    finally:
        for one in reversed(processes):
            one.terminate()
            one.wait(PATIENCE)
    near = run_study(load_study(study), folder=tmp_path / "near", workers=0)
    pd.testing.assert_frame_equal(StudyResult(tmp_path / "far").table, near.table, check_exact=True)


def test_nobody_waits_for_ever(tmp_path):
    from dask.distributed import Client, LocalCluster

    from fem_seal.studies.pools import Cluster
    from fem_seal.studies.work import DesignSpec

    study = load_study(_small(tmp_path))
    with (
        LocalCluster(n_workers=0, processes=False, dashboard_address=None, silence_logs=50) as cluster,
        Client(cluster) as client,
    ):
        rows = Cluster(client, 1, 3.0).results(DesignSpec.of(study), [study.points])
        with pytest.raises(ClusterError, match=r"no worker for 3 s.*--resume"):
            next(rows)


def test_chunks_of_the_only_worker_are_given_to_its_successor(tmp_path, monkeypatch):
    """When all workers are lost at once, as at the end of their time, dask keeps what was meant for them for ever."""
    from dask.distributed import Client, LocalCluster

    from fem_seal.studies import responses
    from fem_seal.studies.pools import Cluster
    from fem_seal.studies.work import DesignSpec

    study, begun, free, found = load_study(_small(tmp_path)), Event(), Event(), []
    harmless = responses.warmed

    def held(*about, **more):
        begun.set()
        free.wait(PATIENCE)
        return harmless(*about, **more)

    monkeypatch.setattr(responses, "warmed", held)
    with (
        LocalCluster(
            n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None, silence_logs=50
        ) as cluster,
        Client(cluster) as client,
    ):
        # not even one more attempt: the designs have done nothing wrong
        rows = Cluster(client, 0, PATIENCE).results(DesignSpec.of(study), [one[None] for one in study.points])
        reader = Thread(target=lambda: found.extend(row for some in rows for row in some))
        reader.start()
        assert begun.wait(PATIENCE)
        (lost,) = client.scheduler_info(n_workers=-1)["workers"]
        client.sync(cluster.scheduler.remove_worker, lost, stimulus_id="lost")
        free.set()
        cluster.scale(2)
        reader.join(PATIENCE / 2)
        assert not reader.is_alive()
    assert sorted(row.inputs for row in found) == [(0.0,), (1.0,), (2.0,), (3.0,)]
    assert {row.reason for row in found} == {None}


def test_chunks_that_were_taken_back_are_no_silence(monkeypatch):
    """The scheduler may not have heard yet of what was sent in their place: only silences tell that it never will."""
    from concurrent.futures import Future
    from types import SimpleNamespace

    import numpy as np

    from fem_seal.studies import pools

    def submit(*what, **how):
        future = Future()
        future.key, future.status, future.release = "new", "pending", lambda: None
        return future

    def answered(what, **about):
        return dict.fromkeys(about["keys"]) if "keys" in about else {"tcp://there": 1}

    scheduler = SimpleNamespace(ncores=None, get_task_status=None)
    client = SimpleNamespace(
        submit=submit,
        sync=answered,
        scheduler=scheduler,
        status="running",
        subscribe_topic=lambda *about: None,
    )
    monkeypatch.setattr(pools, "_HEARTBEAT", 0.01)
    on_the_way = pools._Pending(pools.Cluster(client, 1, PATIENCE), None)
    on_the_way.send(np.zeros((1, 1)), "tcp://there")
    for _ in range(5):
        on_the_way._settled.put(Future())
        assert on_the_way.next() is None
    # two silences do
    assert on_the_way.next() is None
    _, rows = on_the_way.next()
    assert rows is None and not on_the_way


def _small(folder):
    path = folder / "small.toml"
    path.write_text(
        f'base = "{CASE}"\nresponses = ["line_load_N_per_m"]\n'
        '[changes]\nload.fluid_pressure = "10 bar"\nmesh.contact_size = "60 um"\n'
        '[parameters]\nload.applied_force = ["0 N", "1 N", "2 N", "3 N"]\n'
    )
    return path


def _arm(deadly):
    """Make this process die when it calculates a certain design."""
    from fem_seal.studies import responses

    harmless = responses.warmed

    def armed(case):
        if case.load.applied_force == deadly:
            os.kill(os.getpid(), signal.SIGKILL)
        return harmless(case)

    responses.warmed = armed


def _arming(deadly):
    from distributed import WorkerPlugin

    class Arming(WorkerPlugin):
        """Arms workers that come later as well."""

        def setup(self, worker):
            _arm(deadly)

    return Arming()
