"""A study survives the death of its processes: real workers and a real coordinator, killed by signal."""

from __future__ import annotations

import json
import os
import signal
import sqlite3
import subprocess
import sys
import time
from concurrent.futures.process import BrokenProcessPool
from contextlib import closing, contextmanager
from dataclasses import replace
from multiprocessing import parent_process
from multiprocessing.forkserver import _forkserver
from pathlib import Path
from threading import Event, Thread

import numpy as np
import pandas as pd
import pytest
from places import EXAMPLES

from fem_seal import StudyResult, load_study
from fem_seal.errors import ClusterError
from fem_seal.studies.cluster import cluster_pool
from fem_seal.studies.machine import LocalWorkers
from fem_seal.studies.progress import Lines
from fem_seal.studies.session import run_study
from fem_seal.studies.work import DesignSpec
from fem_seal.studies.worker_pool import WorkerPool

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
# Loaded by the process that workers are copies of: designs that take their time and little of the processor's.
SLOW = """
import time
from fem_seal.studies import responses

def slow(case, swift=responses.with_contact_temperatures):
    time.sleep(0.1)
    return swift(case)

responses.with_contact_temperatures = slow
"""
COMMAND = """
import sys
from fem_seal.__main__ import main
from fem_seal.studies import machine
machine._PRELOAD.append("slow")
sys.exit(main())
"""
# Longest wait for anything; on an idle machine it is seconds.
PATIENCE = 120.0


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
    monkeypatch.setenv("PYTHONPATH", str(tmp_path), prepend=os.pathsep)
    path = tmp_path / "study.toml"
    path.write_text(STUDY)
    return path


def start(study_file, folder, *options, quiet=True):
    """A study in processes of their own, as a terminal starts it."""
    command = [
        sys.executable,
        "-c",
        COMMAND,
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


@contextmanager
def dask_cluster(workers):
    """Workers as a cluster has them, on this machine."""
    distributed, dask = pytest.importorskip("distributed"), pytest.importorskip("dask")
    with (
        dask.config.set({"distributed.scheduler.allowed-failures": 0, "logging.distributed": "critical"}),
        distributed.LocalCluster(
            n_workers=workers, threads_per_worker=1, dashboard_address=None, silence_logs=50
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        yield client


@contextmanager
def some_workers(where, count):
    """What a study takes as its client."""
    with closing(LocalWorkers(count)) if where == "machine" else dask_cluster(count) as workers:
        yield workers


def pool_of(workers, retries=1):
    return (
        WorkerPool(workers, retries) if isinstance(workers, LocalWorkers) else cluster_pool(workers, retries)
    )


WHERE = pytest.mark.parametrize("where", ["machine", "cluster"])


@WHERE
def test_a_design_that_kills_every_worker_costs_itself_only(tmp_path, where):
    """Whoever calculates the third design dies at once."""
    study = load_study(_small(tmp_path))
    deadly = float(study.points[2, 0])
    spec = armed(DesignSpec.of(study), "die", deadly)
    with some_workers(where, 2) as workers:
        rows = [row for some in pool_of(workers).results(spec, [study.points]) for row in some]
    reasons = {row.inputs[0]: row.reason for row in rows}
    assert len(rows) == 4
    assert "every worker that calculated it died" in reasons.pop(deadly)
    assert set(reasons.values()) == {None}


@WHERE
def test_a_worker_whose_design_never_ends_is_replaced(tmp_path, monkeypatch, capsys, where):
    study = load_study(_small(tmp_path, '[run]\ntime_limit = "15 s"\n'))
    deadly = float(study.points[2, 0])
    spec_of = DesignSpec.of
    monkeypatch.setattr(DesignSpec, "of", lambda study: armed(spec_of(study), "hang", deadly))
    with some_workers(where, 1) as workers:
        start = time.monotonic()
        result = run_study(study, workers, folder=tmp_path / "out", progress=Lines())
        took = time.monotonic() - start
    assert result.table["status"].tolist() == ["done", "done", "failed", "done"]
    assert "time limit of 15 s" in result.table["reason"][2]
    assert 'load.applied_force = "2 N"' in capsys.readouterr().err
    # once, and not once more for each retry
    assert took < 100.0


def test_workers_of_this_machine_need_no_dask_and_listen_nowhere():
    psutil = pytest.importorskip("psutil")
    # the process that workers are copies of may have been started for something else
    _forkserver._stop()
    with closing(LocalWorkers(2)) as workers:
        loaded = [workers.call(name, loaded_modules).result() for name in workers.names()]
        own = psutil.Process()
        listening = [
            connection
            for process in own.children(recursive=True)
            for connection in process.net_connections(kind="inet")
            if connection.status == psutil.CONN_LISTEN
        ]
    assert "fem_seal.studies.responses" in loaded[0] and loaded[0] == loaded[1]
    assert not {"dask", "distributed"} & loaded[0]
    assert not listening


def loaded_modules():
    return set(sys.modules)


def test_a_worker_that_takes_more_than_its_share_of_the_memory_is_ended():
    with closing(LocalWorkers(1)) as workers:
        workers._memory = 1e9
        assert workers.call("0", take, 0.3e9).result(PATIENCE) == 0.3e9
        with pytest.raises(BrokenProcessPool):
            workers.call("0", take, 1.2e9).result(PATIENCE)
        # its successor has the same share
        assert workers.call("0", take, 0.3e9).result(PATIENCE) == 0.3e9


def take(size):
    """Memory for a while."""
    held = np.ones(int(size), dtype=np.uint8)
    time.sleep(3.0)
    return held.size


def test_a_worker_whose_library_keeps_all_of_its_threads_waiting_is_ended():
    with closing(LocalWorkers(1)) as workers:
        workers.call("0", be_impatient, 2.0).result(PATIENCE)
        with pytest.raises(BrokenProcessPool):
            workers.call("0", keep_everybody_waiting).result(PATIENCE)


def be_impatient(seconds):
    from fem_seal import processes

    processes.DEAF = seconds
    time.sleep(2.0)


def keep_everybody_waiting():
    import ctypes

    # unlike CDLL it does not let other threads go on meanwhile
    ctypes.PyDLL(None).sleep(1000)


def test_a_script_that_starts_itself_again_is_told_why(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(
        f"from fem_seal import load_study\nload_study({str(_small(tmp_path))!r}).run(workers=2)\n"
    )
    ended = subprocess.run(
        [sys.executable, str(script)], capture_output=True, text=True, timeout=PATIENCE, check=False
    )
    assert ended.returncode == 1
    assert 'A script that runs a study needs if __name__ == "__main__"' in ended.stderr.splitlines()[-1]


@pytest.mark.slow
def test_a_scheduler_by_its_address(tmp_path):
    """Scheduler and worker are started by themselves, as on a cluster; the command line is told where they are."""
    pytest.importorskip("distributed")
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
    distributed = pytest.importorskip("distributed")
    study = load_study(_small(tmp_path))
    with (
        distributed.LocalCluster(
            n_workers=0, processes=False, dashboard_address=None, silence_logs=50
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        rows = cluster_pool(client, 1, patience=3.0).results(DesignSpec.of(study), [study.points])
        with pytest.raises(ClusterError, match=r"no worker for 3 s.*--resume"):
            next(rows)


def test_chunks_of_the_only_worker_are_given_to_its_successor(tmp_path, monkeypatch):
    """When all workers are lost at once, as at the end of their time, dask keeps what was meant for them for ever."""
    distributed = pytest.importorskip("distributed")
    from fem_seal.studies import responses

    study, begun, free, found = load_study(_small(tmp_path)), Event(), Event(), []
    harmless = responses.with_contact_temperatures

    def held(*about, **more):
        begun.set()
        free.wait(PATIENCE)
        return harmless(*about, **more)

    monkeypatch.setattr(responses, "with_contact_temperatures", held)
    with (
        distributed.LocalCluster(
            n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None, silence_logs=50
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        # not even one more attempt: the designs have done nothing wrong
        rows = cluster_pool(client, 0, patience=PATIENCE).results(
            DesignSpec.of(study), [one[None] for one in study.points]
        )
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

    from fem_seal.studies import worker_pool

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
    )
    monkeypatch.setattr(worker_pool, "HEARTBEAT", 0.01)
    course = worker_pool._Schedule(cluster_pool(client, 1), None, [np.zeros((1, 1))])
    assert course.hand_out()
    for _ in range(5):
        course.events.put(Future())
        assert course.wait_for_chunk() is None
    (sent,) = course._tasks
    # two silences do, and then it is sent once more
    for known in (True, False):
        assert course.wait_for_chunk() is None
        assert course.hand_out()
        assert (sent in course._tasks) == known


def _small(folder, more=""):
    path = folder / "small.toml"
    path.write_text(
        f'base = "{CASE}"\nresponses = ["line_load_N_per_m"]\n{more}'
        '[changes]\nload.fluid_pressure = "10 bar"\nmesh.contact_size = "60 um"\n'
        '[parameters]\nload.applied_force = ["0 N", "1 N", "2 N", "3 N"]\n'
    )
    return path


class Arming(str):
    """What the designs have in common, which arms every worker that reads it."""

    def __reduce__(self):
        return arming, (str(self), self.how, self.deadly)


def armed(spec, how, deadly):
    """A study whose design with this force kills its worker, or never ends."""
    return replace(spec, fingerprint=arming(spec.fingerprint, how, deadly))


def arming(text, how, deadly):
    from fem_seal.studies import responses

    fingerprint, harmless = Arming(text), responses.with_contact_temperatures
    fingerprint.how, fingerprint.deadly = how, deadly

    def deadly_warmed(case):
        if case.load.applied_force == deadly:
            os.kill(os.getpid(), signal.SIGKILL) if how == "die" else time.sleep(1e6)
        return harmless(case)

    # a scheduler of dask reads it too, in the process of the test
    if parent_process() is not None:
        responses.with_contact_temperatures = deadly_warmed
    return fingerprint
