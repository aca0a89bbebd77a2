"""What goes wrong around a study: designs that never end, read-only discs, files and folders that change."""

from __future__ import annotations

import shutil
import sqlite3
import subprocess
import sys
import time
import warnings
from contextlib import closing
from pathlib import Path

import pandas as pd
import pytest
from places import EXAMPLES, ROOT

from fem_seal import Study, StudyResult, load_case
from fem_seal.cli.app import main
from fem_seal.errors import InputError, OutputError
from fem_seal.output.columns import LEAK_COLUMNS
from fem_seal.seal.findings import VALID
from fem_seal.studies import plan, responses, store
from fem_seal.studies.progress import Lines
from fem_seal.studies.session import run_study

CASE = EXAMPLES / "ball_cone.toml"
COARSE = {"load.fluid_pressure": "10 bar", "mesh.contact_size": "60 um"}
NEVER = 2.0
"""Axial force of the design that never ends [N]."""


def study(**tables):
    standard = {
        "changes": COARSE,
        "parameters": {"load.applied_force": ["0 N", "1 N", "2 N", "3 N"]},
        "responses": ["line_load_N_per_m"],
        "run": {"time_limit": "2 s"},
    }
    return Study(CASE, **{**standard, **tables})


def loop():
    while True:
        pass


def wait():
    time.sleep(1e6)


def stubborn():
    while True:
        try:
            time.sleep(0.1)
        except Exception:
            continue


def hang_in(evaluate, how):
    """Make one design never end."""
    harmless = evaluate.with_contact_temperatures

    def armed(case):
        if case.load.applied_force == NEVER:
            how()
        return harmless(case)

    return armed


@pytest.fixture(scope="module")
def known_bodies(tmp_path_factory):
    """What the designs share is made: on a busy machine the first of them would take longer than its limit."""
    run_study(study(run={}), folder=tmp_path_factory.mktemp("known"), workers=0)


@pytest.mark.slow
@pytest.mark.usefixtures("known_bodies")
@pytest.mark.parametrize("how", [loop, wait, stubborn])
def test_a_design_that_never_ends_is_a_failed_row(tmp_path, monkeypatch, capsys, how):
    """In this process, whose own Ctrl-C still works afterwards."""
    import signal

    before = signal.getsignal(signal.SIGINT)
    with monkeypatch.context() as patch:
        patch.setattr(responses, "with_contact_temperatures", hang_in(responses, how))
        result = run_study(study(), folder=tmp_path, workers=0, progress=Lines())
    assert signal.getsignal(signal.SIGINT) is before
    assert result.table["status"].tolist() == ["done", "done", "failed", "done"]
    assert result.table["reason"][2] == (
        "took longer than its time limit of 2 s; a larger run.time_limit gives it more"
    )
    said = capsys.readouterr().err
    # who it is, before it fails
    assert 'the design load.applied_force = "2 N"; it fails after 2 s (run.time_limit)' in said
    # it stays failed, until it is asked for
    again = run_study(study(), folder=tmp_path, workers=0, resume=True)
    assert again.counts["failed"] == 1
    again = run_study(study(), folder=tmp_path, workers=0, resume=True, retry_failed=True)
    assert again.counts == {"done": 4, "failed": 0, "open": 0}


@pytest.mark.slow
def test_the_time_limit_changes_no_design(tmp_path):
    run_study(study(), folder=tmp_path, workers=0)
    keys = set(_keys(tmp_path))
    run_study(study(run={"time_limit": "1 h"}), folder=tmp_path, workers=0, resume=True)
    assert set(_keys(tmp_path)) == keys


def _keys(folder):
    with sqlite3.connect(folder / store.FILE) as file:
        return [key for (key,) in file.execute("SELECT key FROM point")]


def test_the_time_limit_is_a_time():
    assert study(run={"time_limit": "30 min"}).run_settings.time_limit == 1800.0
    assert study(run={}).run_settings.time_limit == 1800.0
    with pytest.raises(InputError, match=r'run.time_limit = "30 mm".*a time with its unit, such as "20 s"'):
        study(run={"time_limit": "30 mm"})


@pytest.mark.slow
@pytest.mark.usefixtures("known_bodies")
def test_a_search_goes_on_after_a_design_that_never_ends(tmp_path, monkeypatch):
    monkeypatch.setattr(responses, "with_contact_temperatures", hang_in(responses, wait))
    result = run_study(
        study(optimise={"minimise": "line_load_N_per_m", "trials": 8, "batch": 2, "seed": 3}),
        folder=tmp_path,
        workers=0,
    )
    tried = result.table
    assert len(tried) == 8
    assert NEVER in tried["load.applied_force"].tolist()
    assert (tried["status"] == "failed").tolist() == (tried["load.applied_force"] == NEVER).tolist()


# A library that never comes back: deaf to all signals, deep in the system.
STUCK = f"""
import ctypes, sys
from fem_seal.cli.app import main
from fem_seal.studies import responses, time_limit

time_limit._INTERVAL = 0.1
harmless = responses.with_contact_temperatures

def armed(case):
    if case.load.applied_force == {NEVER}:
        libc = ctypes.CDLL(None)
        everything = (ctypes.c_ulong * 16)(*[2**64 - 1] * 16)
        libc.pthread_sigmask(0, ctypes.byref(everything), None)
        while True:
            libc.sleep(1000)
    return harmless(case)

responses.with_contact_temperatures = armed
sys.exit(main(sys.argv[1:]))
"""


@pytest.mark.slow
@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="blocks signals by libc")
def test_a_library_that_never_comes_back_ends_the_process_and_not_the_study(tmp_path):
    file, folder = tmp_path / "study.toml", tmp_path / "out"
    file.write_text(
        f'base = "{CASE}"\nresponses = ["line_load_N_per_m"]\n[run]\ntime_limit = "6 s"\n'
        '[changes]\nload.fluid_pressure = "10 bar"\nmesh.contact_size = "60 um"\n'
        '[parameters]\nload.applied_force = ["0 N", "1 N", "2 N", "3 N"]\n'
    )
    command = ["study", str(file), "-o", str(folder), "--workers", "0"]
    ended = subprocess.run(
        [sys.executable, "-c", STUCK, *command], capture_output=True, text=True, timeout=120, check=False
    )
    assert ended.returncode == 1
    assert "does not stop at its time limit" in ended.stderr
    assert "--resume" in ended.stderr and "Traceback" not in ended.stderr
    assert StudyResult(folder).counts == {"done": 2, "failed": 1, "open": 1}
    # it is not tried again: here it would be done
    assert main([*command, "--resume", "-q"]) == 0
    result = StudyResult(folder)
    assert result.counts == {"done": 3, "failed": 1, "open": 0}
    assert result.table["status"][2] == "failed"


def test_what_takes_minutes_travels_one_design_at_a_time():
    """So that a worker that dies or hangs loses that design alone."""
    from fem_seal.studies.work import DesignSpec, chunks

    def sizes(**tables):
        plan = study(**tables)
        return [len(chunk) for chunk in chunks(DesignSpec.of(plan), plan.points)]

    assert sizes() == [4]
    assert sizes(changes={**COARSE, "load.closing": "penetration"}) == [4]
    curve = {"plastic_strain": [0, 0.1], "stress": ["300 MPa", "400 MPa"]}
    yielding = {**COARSE, "seat.material": {"yield_stress": None, "stress_strain": curve}}
    assert sizes(changes=yielding) == [1, 1, 1, 1]


@pytest.mark.slow
def test_a_worker_without_a_nanny_is_left_alone(tmp_path, monkeypatch):
    """It may be a thread of this very process, which is not to die of it."""
    pytest.importorskip("distributed")
    from dask.distributed import Client, LocalCluster

    from fem_seal.studies.cluster import cluster_pool
    from fem_seal.studies.work import DesignSpec, chunks

    free = []

    def wait_here():
        while not free:
            time.sleep(0.1)

    monkeypatch.setattr(responses, "with_contact_temperatures", hang_in(responses, wait_here))
    slow_enough = study(run={"time_limit": "6 s"})
    spec = DesignSpec.of(slow_enough)
    with (
        LocalCluster(
            n_workers=2, threads_per_worker=1, processes=False, dashboard_address=None, silence_logs=50
        ) as cluster,
        Client(cluster) as client,
    ):
        found = [
            row
            for rows in cluster_pool(client, 1, patience=60.0).results(spec, chunks(spec, slow_enough.points))
            for row in rows
        ]
        free.append(True)
    reasons = {row.inputs[0]: row.reason for row in found}
    assert len(found) == 4
    assert "time limit" in reasons.pop(NEVER)
    assert set(reasons.values()) == {None}


READER = """
import sys
from contextlib import closing
from pathlib import Path
from fem_seal import StudyResult
from fem_seal.cli.app import main
for folder, out in zip(*[map(Path, sys.argv[1:])] * 2):
    try:
        (folder / "probe").touch()
    except OSError:
        pass
    else:
        sys.exit(77)
    result = StudyResult(folder)
    print(result.counts["done"], len(result.table),
          main(["study", "report", str(folder), "-q", "-o", str(out / "page.html")]),
          main(["study", "export", str(folder), str(out / "t.csv"), "-q"]),
          main(["study", "report", str(folder), "-q"]))
"""


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("unshare") is None, reason="makes a read-only disc by unshare and mount")
def test_archived_studies_are_read_from_a_read_only_disc(tmp_path):
    """Also one that was killed and whose last rows SQLite has not yet moved from its log into the file."""
    folder, finished, interrupted = (tmp_path / name for name in ("study", "finished", "interrupted"))
    result = run_study(study(), folder=folder, workers=0)
    finished.mkdir()
    shutil.copy(folder / store.FILE, finished)
    interrupted.mkdir()
    writer = sqlite3.connect(folder / store.FILE)
    writer.execute("INSERT INTO about VALUES ('late', '1')")
    writer.commit()
    # copied while it is open, as it stands on the disc after a kill
    for file in folder.iterdir():
        if not file.name.endswith("-shm"):
            shutil.copy(file, interrupted)
    writer.close()
    assert (interrupted / f"{store.FILE}-wal").stat().st_size > 0
    pages = [tmp_path / f"of_{archive.name}" for archive in (finished, interrupted)]
    for page in pages:
        page.mkdir()
    read_only = 'for one in "$1" "$2"; do mount --bind "$one" "$one" && mount -o remount,bind,ro "$one" || exit 1; done'
    ended = subprocess.run(
        [
            "unshare",
            "--map-root-user",
            "--mount",
            "sh",
            "-c",
            f'{read_only}; shift 2; exec "$@"',
            "sh",
            finished,
            interrupted,
            sys.executable,
            "-c",
            READER,
            finished,
            pages[0],
            interrupted,
            pages[1],
        ],
        capture_output=True,
        text=True,
        cwd=ROOT,
        check=False,
    )
    if "unshare:" in ended.stderr or "mount:" in ended.stderr or ended.returncode == 77:
        pytest.skip("this system lets nobody mount")
    # the page cannot stand in the folder, which is said in plain words, but anywhere else
    assert ended.stdout == "4 4 0 0 1\n4 4 0 0 1\n", ended.stderr
    for archive in (finished, interrupted):
        assert f"{archive / 'report.html'}: cannot be written (read-only file system)" in ended.stderr
    assert "Traceback" not in ended.stderr
    for page in pages:
        assert (page / "page.html").exists()
        exported = pd.read_csv(page / "t.csv", index_col=0)
        assert exported["line_load_N_per_m"].tolist() == pytest.approx(
            result.table["line_load_N_per_m"].tolist()
        )


def test_rows_that_are_in_the_log_only_are_read_where_nothing_can_be_written(tmp_path, monkeypatch):
    """The same without a read-only disc: SQLite cannot open the file as usual."""
    folder, archive = tmp_path / "study", tmp_path / "archive"
    run_study(study(), folder=folder, workers=0)
    archive.mkdir()
    writer = sqlite3.connect(folder / store.FILE)
    writer.execute("INSERT INTO about VALUES ('late', '1')")
    writer.commit()
    for file in folder.iterdir():
        shutil.copy(file, archive)
    writer.close()
    connect = store._connect

    def nothing_written(path, how):
        if how == "mode=rw" and path.parent == archive:
            how = "mode=ro"
        return connect(path, how)

    monkeypatch.setattr(store, "_connect", nothing_written)
    (archive / f"{store.FILE}-shm").unlink()
    file = store.open_to_read(archive / store.FILE)
    assert file.about["late"] == 1
    file.close()


def scanned(tmp_path, **tables):
    """A study over a spectrum from a file and, as a parameter, over others."""
    for name in ("a.csv", "b.csv"):
        shutil.copy(EXAMPLES / "studies" / "spectrum.csv", tmp_path / name)
    return Study(
        CASE,
        changes={
            **COARSE,
            "leak.plasticity": False,
            "roughness.spectrum": {"kind": "table", "file": str(tmp_path / "a.csv")},
        },
        parameters={"load.applied_force": ["0 N", "1 N", "2 N", "3 N"]},
        responses=["leak_rate_m3_per_s"],
        **tables,
    )


def rougher(path):
    """Edit a spectrum: four times the variance."""
    heading, *rows = path.read_text().splitlines()
    pairs = [row.split(",") for row in rows]
    path.write_text("\n".join([heading, *(f"{q},{4 * float(C)!r}" for q, C in pairs)]) + "\n")


@pytest.mark.slow
def test_a_data_file_that_is_edited_during_a_study_is_noticed(tmp_path, monkeypatch):
    harmless = responses.with_contact_temperatures
    plan, folder = scanned(tmp_path), tmp_path / "out"

    def edited(case):
        if case.load.applied_force == 2.0:
            rougher(tmp_path / "a.csv")
        return harmless(case)

    with monkeypatch.context() as patch:
        patch.setattr(responses, "with_contact_temperatures", edited)
        with pytest.raises(InputError, match=r"a\.csv: was changed or removed while the study ran.*--resume"):
            run_study(plan, folder=folder, workers=0)
    # the design that read the new contents is not kept
    assert StudyResult(folder).counts == {"done": 2, "failed": 0, "open": 2}
    smooth = StudyResult(folder).table["leak_rate_m3_per_s"].max()

    # the same study does not go on with a file that it has not read
    with pytest.raises(InputError, match="was changed or removed"):
        run_study(plan, folder=folder, workers=0, resume=True)
    resumed = run_study(scanned_as_it_is(plan), folder=folder, workers=0, resume=True)
    assert resumed.counts == {"done": 4, "failed": 0, "open": 0}
    assert resumed.table["leak_rate_m3_per_s"].min() > 2 * smooth


def scanned_as_it_is(plan):
    """The study, read anew."""
    return Study(plan.case, parameters=plan.written["parameters"], responses=plan.written["responses"])


@pytest.mark.slow
def test_a_data_file_of_a_parameter_is_watched_only_by_its_designs(tmp_path):
    from fem_seal.studies.work import DesignSpec, calculate, chunks

    scanned(tmp_path)
    table = {"kind": "table", "file": str(EXAMPLES / "studies" / "spectrum.csv")}
    plan = Study(
        load_case(CASE).replace({"roughness.spectrum": table}),
        changes=COARSE,
        parameters={"roughness.spectrum.file": [str(tmp_path / "a.csv"), str(tmp_path / "b.csv")]},
        responses=["line_load_N_per_m"],
    )
    spec = DesignSpec.of(plan)
    rougher(tmp_path / "b.csv")
    (whole,) = chunks(spec, plan.points)
    (done,) = calculate(spec, whole[:1])
    assert done.reason is None
    with pytest.raises(InputError, match=r"b\.csv: was changed"):
        calculate(spec, whole[1:])


@pytest.mark.slow
@pytest.mark.parametrize("search", [False, True], ids=["grid", "search"])
def test_a_data_file_that_is_removed_during_a_study_is_noticed(tmp_path, monkeypatch, search):
    """And is no failure of the designs that miss it."""

    def removed(batch, cases, columns, *, interpolate):
        def one(number):
            force = cases[number].load.applied_force
            if force == 2.0:
                (tmp_path / "a.csv").unlink(missing_ok=True)
                raise OSError("no such file")
            return responses.DesignResult(dict.fromkeys(columns, 1e-6 + 1e-9 * force), VALID)

        return batch.map(cases, one)

    monkeypatch.setattr(responses, "evaluate_designs", removed)
    plan = scanned(
        tmp_path, **({"optimise": {"maximise": "leak_rate_m3_per_s", "trials": 9}} if search else {})
    )
    with pytest.raises(InputError, match=r"a\.csv: was changed or removed"):
        run_study(plan, folder=tmp_path / "out", workers=0)
    assert StudyResult(tmp_path / "out").counts["failed"] == 0


def test_a_worker_on_another_machine_need_not_have_what_it_does_not_read(tmp_path):
    from dataclasses import replace

    from fem_seal.studies.work import DesignSpec, calculate, chunks

    plan = study()
    spec = replace(DesignSpec.of(plan), files={str(tmp_path / "curve.csv"): "its contents at home"})
    (whole,) = chunks(spec, plan.points)
    assert [row.reason for row in calculate(spec, whole)] == [None] * 4


@pytest.mark.slow
def test_workers_that_are_started_as_on_windows_calculate_the_same(tmp_path, monkeypatch):
    plan = study(run={}, responses=["line_load_N_per_m", "peak_pressure_Pa", "leak_rate_m3_per_s"])
    monkeypatch.setattr("fem_seal.processes.START", "spawn")
    tables = [run_study(plan, folder=tmp_path / str(n), workers=n).table for n in (0, 2)]
    here, there = (table.drop(columns="seconds", errors="ignore") for table in tables)
    pd.testing.assert_frame_equal(here, there, check_exact=True)


@pytest.mark.slow
def test_workers_notice_an_edited_file_too(tmp_path):
    from fem_seal.studies.machine import LocalWorkers
    from fem_seal.studies.work import DesignSpec, chunks
    from fem_seal.studies.worker_pool import WorkerPool

    plan = scanned(tmp_path)
    spec = DesignSpec.of(plan)
    rougher(tmp_path / "a.csv")
    with (
        closing(LocalWorkers(1)) as workers,
        pytest.raises(InputError, match=r"a\.csv: was changed or removed"),
    ):
        list(WorkerPool(workers, 1).results(spec, chunks(spec, plan.points)))


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="there no folder with open files can be deleted")
@pytest.mark.parametrize("search", [False, True], ids=["grid", "search"])
@pytest.mark.parametrize(
    "how", [shutil.rmtree, lambda path: path.rename(f"{path}-moved")], ids=["deleted", "moved"]
)
def test_a_folder_that_is_deleted_stops_the_study_at_once(tmp_path, monkeypatch, how, search):
    folder, begun = tmp_path / "out", []
    harmless = responses.with_contact_temperatures

    def armed(case):
        begun.append(case.load.applied_force)
        if len(begun) == 2:
            how(folder)
        return harmless(case)

    monkeypatch.setattr(responses, "with_contact_temperatures", armed)
    optimise = {"optimise": {"minimise": "line_load_N_per_m", "trials": 8, "batch": 2}} if search else {}
    with pytest.raises(
        OutputError, match=r"study\.sqlite: was deleted or moved while the study ran, so the study stops"
    ):
        run_study(study(**optimise), folder=folder, workers=0)
    assert len(begun) == 2
    # nothing is made where the folder was
    assert not folder.exists()
    if (moved := Path(f"{folder}-moved")).exists():
        monkeypatch.setattr(responses, "with_contact_temperatures", harmless)
        run_study(study(**optimise), folder=moved, workers=0, resume=True)
        assert StudyResult(moved).counts["open"] == 0


@pytest.mark.slow
def test_a_search_that_was_killed_while_it_told_a_result_resumes_in_silence(tmp_path, monkeypatch, capsys):
    """Between a constraint and the goal of a trial: optuna has heard half of it."""
    from optuna.trial import Trial

    searching = study(
        constraints={"light": 'peak_pressure_Pa < "1 GPa"', "real": 'peak_pressure_Pa > "0 Pa"'},
        optimise={"minimise": "peak_pressure_Pa", "trials": 6, "batch": 2},
        responses=["peak_pressure_Pa"],
        parameters={"load.applied_force": {"distribution": "uniform", "low": "0 N", "high": "400 N"}},
    )
    whole = run_study(searching, folder=tmp_path / "whole", workers=0)
    set_constraint, told = Trial.set_constraint, []

    def killed(trial, name, value):
        told.append(name)
        if len(told) == 4:
            raise KeyboardInterrupt
        set_constraint(trial, name, value)

    with monkeypatch.context() as patch:
        patch.setattr(Trial, "set_constraint", killed)
        with pytest.raises(KeyboardInterrupt):
            run_study(searching, folder=tmp_path / "part", workers=0)
    capsys.readouterr()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        resumed = run_study(searching, folder=tmp_path / "part", workers=0, resume=True)
    assert capsys.readouterr().err == ""
    pd.testing.assert_frame_equal(resumed.table, whole.table, check_exact=True)


@pytest.mark.usefixtures("known_bodies")
def test_a_file_with_its_responses_in_another_order_goes_on(tmp_path, monkeypatch):
    """As a version of before wrote it: its designs are not calculated again, and others come to them."""
    forces, responses = ["0 N", "1 N", "2 N"], ["line_load_N_per_m", "fwhm_m"]
    with monkeypatch.context() as patch:
        patch.setattr(plan, "LEAK_COLUMNS", LEAK_COLUMNS[::-1])
        before = study(parameters={"load.applied_force": forces[:2]}, responses=responses)
    assert before.responses == ("fwhm_m", "line_load_N_per_m")
    first = run_study(before, folder=tmp_path, workers=0).table
    after = study(parameters={"load.applied_force": forces}, responses=responses)
    assert after.responses == ("line_load_N_per_m", "fwhm_m")
    resumed = run_study(after, folder=tmp_path, workers=0, resume=True)
    pd.testing.assert_frame_equal(resumed.table[:2], first, check_exact=True)
    whole = run_study(after, folder=tmp_path / "whole", workers=0).table
    pd.testing.assert_frame_equal(resumed.table[[*whole]], whole, check_exact=True)


@pytest.mark.parametrize(
    ("damage", "said"),
    [
        ("UPDATE about SET text = '{' WHERE name = 'asked'", r"study\.sqlite: is damaged \(.*; restore it"),
        ("UPDATE about SET text = '[]' WHERE name = 'asked'", "holds a search for something else"),
        ("UPDATE design SET key = 'x' WHERE number = 1", "holds a search for something else"),
        ('UPDATE point SET "load.applied_force" = 1234.5', "holds a search for something else"),
        ("DELETE FROM point", "holds a search for something else"),
    ],
)
def test_a_search_whose_trials_are_not_those_of_the_file_does_not_go_on(damage, said, a_search, tmp_path):
    folder = shutil.copytree(a_search, tmp_path / "out")
    with closing(sqlite3.connect(folder / store.FILE)) as file, file:
        file.execute(damage)
    with pytest.raises(InputError, match=said):
        run_study(study(**SEARCH), folder=folder, workers=0, resume=True)


SEARCH = {"optimise": {"minimise": "line_load_N_per_m", "trials": 4, "batch": 2}}


@pytest.fixture(scope="module")
def a_search(tmp_path_factory):
    folder = tmp_path_factory.mktemp("search") / "out"
    run_study(study(**SEARCH), folder=folder, workers=0)
    return folder
