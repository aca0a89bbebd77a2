"""A results folder is of one run: killed at any moment, interrupted, or written by two at a time."""

from __future__ import annotations

import gc
import json
import os
import pickle
import re
import shutil
import signal
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from unittest.mock import Mock

import pytest
from places import EXAMPLES, ROOT
from sample_results import rough_result, single_result

from fem_seal.cli.app import main
from fem_seal.errors import InputError, OutputError
from fem_seal.files import write_bytes
from fem_seal.output import files, folders, stored
from fem_seal.output.answer_outputs import OUTPUTS
from fem_seal.output.folders import FILE as LOCK
from fem_seal.output.folders import UNFINISHED, folder_lock, replaced_together, unfinished

posix = pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")


def contents(folder):
    """All files that people see in a folder."""
    return {path.name: path.read_bytes() for path in folder.iterdir() if not path.name.startswith(".")}


@pytest.fixture(scope="module")
def two_runs(tmp_path_factory):
    """What stands in the folder before, and what a second run with fewer loads makes of it."""
    place = tmp_path_factory.mktemp("runs")
    before, after = place / "before", place / "after"
    rough_result().write(before)
    (before / "notes.txt").write_text("of the user")
    (before / "contact_0.vtu").write_text("of the user")
    shutil.copytree(before, after)
    single_result().write(after)
    return before, after


@pytest.mark.slow
def test_the_second_run_leaves_nothing_of_the_first(two_runs):
    before, after = map(contents, two_runs)
    assert before["leak.csv"] != after["leak.csv"]
    assert {"contact_002.vtu", "notes.txt", "contact_0.vtu"} <= before.keys()
    assert "contact_002.vtu" not in after and "contact_line_002.vtp" not in after
    assert {"notes.txt", "contact_0.vtu"} <= after.keys()
    assert not [path.name for path in two_runs[1].iterdir() if path.name.startswith(".")]
    assert UNFINISHED not in after
    told = json.loads(after["summary.json"])["input"]["output"]["folder"]
    assert told == str(two_runs[1].absolute())


def test_a_report_that_nobody_wants_yet_is_drawn_later(tmp_path, capsys):
    case = tmp_path / "case.toml"
    case.write_text(SMOOTH, encoding="utf-8")
    words, pages = ["run", str(case), "-o", str(tmp_path / "out")], {}
    assert main(words) == 0
    pages["at once"] = page_of(tmp_path / "out")
    assert "report.html" in capsys.readouterr().out
    # nor does that of the run before stay
    assert main([*words, "--no-report"]) == 0
    assert not (tmp_path / "out" / "report.html").exists() and "report.html" not in capsys.readouterr().out
    assert main(["report", str(tmp_path / "out")]) == 0
    pages["later"] = page_of(tmp_path / "out")
    assert len(pages["at once"]) > 10_000 and pages["at once"] == pages["later"]


SMOOTH = """
closure = { shape = "ball", radius = "20 mm", material = "steel" }
seat = { shape = "cone", angle = "45 deg", material = "steel" }
interface = { law = "smooth" }
load = { fluid_pressure = "20 bar" }
mesh = { contact_size = "20 um" }
"""


def page_of(folder):
    """The report without the minute of its making."""
    text = (folder / "report.html").read_text(encoding="utf-8")
    return re.sub(r"\d{4}-\d\d-\d\d \d\d:\d\d UTC", "", text)


def test_every_file_that_a_run_writes_is_known_as_one(two_runs):
    """Or it would be left behind by a later run without it."""
    written = contents(two_runs[0]).keys() - {"notes.txt", "contact_0.vtu"}
    written -= {name for one in OUTPUTS for name in one.tables}
    assert all(folders._OF_A_RUN.fullmatch(name) for name in written)


@pytest.fixture
def dying(two_runs):
    """Writes a result into a folder and is killed before it does the n-th thing to a file; gives the exit code.

    Copies of a process that has nothing but the result: to copy one that has run other tests takes longer than all that
    a copy does.
    """
    after = two_runs[1]
    ready = single_result(), *(after.joinpath(name).read_bytes() for name in DATED)
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), *sys.path])}
    command = [
        sys.executable,
        "-c",
        "from tests.fem_seal.output.test_results_folder import _killed; _killed()",
    ]
    with subprocess.Popen(command, env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
        pickle.dump(ready, process.stdin)

        def killed(moment, folder):
            process.stdin.write(f"{moment} {folder}\n".encode())
            process.stdin.flush()
            return int(process.stdout.readline())

        yield killed
    assert process.returncode == 0


# Files that say when they were made, or how.
DATED = ("report.html", "summary.json", stored.FILE)


def _write_old(setting, old):
    """Let `files` write copies of these files."""

    def write(result, path, *others, **options):
        write_bytes(path, old[path.name])

    setting(files, "write_report", write)
    setting(files, "write_summary", write)
    setting(stored, "store_result", write)


def _killed():
    """Answers `dying`."""
    result, *old = pickle.load(sys.stdin.buffer)
    # drawing takes seconds; what is killed here are the files
    _write_old(setattr, dict(zip(DATED, old, strict=True)))
    # what writing loads, and what of the result is calculated only then, is there for all copies
    with TemporaryDirectory() as once:
        result.write(Path(once))
    gc.freeze()
    for line in sys.stdin.buffer:
        moment, folder = line.decode().rstrip("\n").split(maxsplit=1)
        child = os.fork()
        if child == 0:
            _die_at(int(moment), Path(folder))
            result.write(Path(folder))
            os._exit(0)
        print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), flush=True)


@pytest.mark.slow
@posix
def test_killed_at_any_moment_it_mixes_nothing_silently(two_runs, dying, tmp_path, monkeypatch):
    """A process is killed, by SIGKILL, before each thing that it does to a file, from the first to the last."""
    before, after = map(contents, two_runs)
    _write_old(monkeypatch.setattr, after)
    seen = {"before": 0, "after": 0, "marked": 0}
    moment = 0
    while True:
        folder = tmp_path / f"{moment}"
        shutil.copytree(two_runs[0], folder)
        killed = dying(moment, folder)
        found = contents(folder)
        if killed == 0:
            assert found == after
            break
        assert killed == -signal.SIGKILL
        if UNFINISHED in found:
            seen["marked"] += 1
            assert "Do not use them" in unfinished(folder)
        else:
            seen["before" if found == before else "after"] += 1
            assert found in (before, after), f"mixed at {moment}"
        # whatever was left behind, the next run puts right, and it is not locked out
        if moment % 10 == 0:
            single_result().write(folder)
            assert contents(folder) == after
            assert not [path.name for path in folder.iterdir() if path.name.startswith(".")]
        shutil.rmtree(folder)
        moment += 1
    # all three were met, so the moments were fine enough
    assert min(seen.values()) > 0
    assert seen["before"] > 20 and seen["marked"] > 20


def _die_at(moment, folder):
    """Make this process kill itself before it does the n-th thing to a file below a folder."""
    left = moment

    def hook(event, arguments):
        nonlocal left
        changing = event in ("open", "os.mkdir", "os.rename", "os.remove", "os.rmdir", "os.link")
        if changing and str(arguments[0]).startswith(str(folder)):
            if left == 0:
                os.kill(os.getpid(), signal.SIGKILL)
            left -= 1

    sys.addaudithook(hook)


@pytest.mark.usefixtures("unrendered")
def test_a_file_that_cannot_be_moved_leaves_the_old_results(two_runs, tmp_path, monkeypatch):
    """As on Windows, where no file can be replaced that a spreadsheet has open."""
    folder = tmp_path / "out"
    shutil.copytree(two_runs[0], folder)
    move = os.replace

    def stubborn(source, target):
        if Path(source) == folder / "profile.csv":
            raise PermissionError(13, "Permission denied", str(source), None, str(target))
        move(source, target)

    monkeypatch.setattr(os, "replace", stubborn)
    with pytest.raises(OutputError, match=r"out.profile\.csv: cannot be written \(permission denied\)"):
        single_result().write(folder)
    assert contents(folder) == contents(two_runs[0])


def test_a_full_disc_leaves_the_old_results(two_runs, tmp_path, monkeypatch):
    folder = tmp_path / "out"
    shutil.copytree(two_runs[0], folder)

    def full(result, path, **how):
        raise OutputError(f"{path}: cannot be written (no space left on device)")

    monkeypatch.setattr(files, "write_report", full)
    with pytest.raises(OutputError) as raised:
        single_result().write(folder)
    # where it would have stood, not the draft that is gone
    assert str(raised.value) == f"{folder / 'report.html'}: cannot be written (no space left on device)"
    assert contents(folder) == contents(two_runs[0])


@pytest.mark.usefixtures("unrendered")
def test_a_folder_of_the_user_that_is_named_like_a_result_stays(tmp_path):
    (tmp_path / "leak.csv").mkdir()
    (tmp_path / "leak.csv" / "mine.txt").write_text("mine")
    with pytest.raises(OutputError, match=r"leak\.csv: cannot be written"):
        single_result().write(tmp_path)
    assert (tmp_path / "leak.csv" / "mine.txt").read_text() == "mine"
    assert contents_of_files(tmp_path) == set()


def contents_of_files(folder):
    return {path.name for path in folder.iterdir() if path.is_file()}


@pytest.mark.usefixtures("unrendered")
def test_ctrl_c_while_files_change_places_brings_the_old_ones_back(two_runs, tmp_path, monkeypatch):
    folder = tmp_path / "out"
    shutil.copytree(two_runs[0], folder)
    move = os.replace

    def interrupted(source, target):
        move(source, target)
        if Path(target) == folder / "mesh.msh":
            raise KeyboardInterrupt

    monkeypatch.setattr(os, "replace", interrupted)
    with pytest.raises(KeyboardInterrupt):
        single_result().write(folder)
    assert contents(folder) == contents(two_runs[0])


@pytest.mark.slow
@pytest.mark.usefixtures("unrendered")
def test_a_part_of_another_calculation_is_marked(two_runs, tmp_path, capsys):
    """`mesh` and `leak` write into the folder of a run what does not belong to it."""
    folder = tmp_path / "out"
    shutil.copytree(two_runs[0], folder)
    same = (folder / "mesh.msh").read_bytes()
    with replaced_together(folder, whole=False) as draft:
        (draft / "mesh.msh").write_bytes(same)
    assert unfinished(folder) is None

    assert main(["mesh", str(EXAMPLES / "smooth.toml"), "-q", "-o", str(folder)]) == 0
    assert "mesh.msh in this folder is newer" in capsys.readouterr().err
    assert "mesh.msh" in unfinished(folder)
    assert main(["run", str(EXAMPLES / "smooth.toml"), "-q", "-o", str(folder)]) == 0
    assert unfinished(folder) is None
    assert (folder / "notes.txt").exists()

    profile = EXAMPLES / "profile_from_another_code.csv"
    assert main(["leak", str(profile), str(EXAMPLES / "ball_cone.toml"), "-q", "-o", str(folder)]) == 0
    # it has no mesh, and that of the run before is gone with its other files
    assert unfinished(folder) is None
    assert contents(folder).keys() == {
        "leak.csv",
        "contacts.csv",
        "profile.csv",
        "summary.json",
        "report.html",
        "result.bin",
        "notes.txt",
        "contact_0.vtu",
    }


HOLDER = """
import sys, time
from pathlib import Path
from unittest.mock import Mock
from fem_seal.output.folders import folder_lock
with folder_lock(Path(sys.argv[1])):
    print("mine", flush=True)
    time.sleep(600)
"""


def test_a_second_run_is_refused_while_the_first_lives(tmp_path, capsys):
    """Two processes; the lock goes with the first one although it cannot take leave."""
    folder, case = tmp_path / "out", str(EXAMPLES / "smooth.toml")
    first = subprocess.Popen([sys.executable, "-c", HOLDER, str(folder)], stdout=subprocess.PIPE, text=True)
    try:
        assert first.stdout.readline() == "mine\n"
        for command in (["run", case], ["mesh", case]):
            assert main([*command, "-q", "-o", str(folder)]) == 2
            assert f"{folder}: is being written by another fem-seal process" in capsys.readouterr().err
        with pytest.raises(InputError, match="another fem-seal process"):
            single_result().write(folder)
        assert contents(folder) == {}
    finally:
        first.kill()
        first.wait()
    assert (folder / LOCK).exists()
    assert main(["mesh", case, "-q", "-o", str(folder)]) == 0
    assert {path.name for path in folder.iterdir()} == {"mesh.msh"}


def test_a_lock_that_was_removed_meanwhile_is_taken_anew(tmp_path, monkeypatch):
    """Opened before its owner removes it, locked after: another process may have a new one by then."""
    from fem_seal.output import folders

    lock = folders._lock
    removed = []

    def too_late(handle):
        lock(handle)
        if not removed:
            (tmp_path / LOCK).unlink()
            removed.append(True)

    monkeypatch.setattr(folders, "_lock", too_late)
    with folder_lock(tmp_path):
        assert (tmp_path / LOCK).exists()
        with pytest.raises(InputError), folder_lock(tmp_path):
            pass
    assert not (tmp_path / LOCK).exists()


@pytest.mark.parametrize("reason", ["ENOLCK", "ENOSYS"])
def test_without_locks_nobody_is_kept_out(tmp_path, monkeypatch, reason):
    import errno

    from fem_seal.output import folders

    error = OSError(getattr(errno, reason), "no locks here")
    monkeypatch.setattr(folders, "_lock", Mock(side_effect=error))
    with folder_lock(tmp_path), folder_lock(tmp_path):
        pass


@pytest.mark.usefixtures("unrendered")
def test_a_folder_that_is_deleted_during_the_run_is_made_again(tmp_path, monkeypatch):
    from fem_seal import result as seal_result

    folder = tmp_path / "out"

    def run(case, **_):
        shutil.rmtree(folder)
        return single_result()

    monkeypatch.setattr(seal_result, "run", run)
    assert main(["run", str(EXAMPLES / "smooth.toml"), "-q", "-o", str(folder)]) == 0
    assert {"leak.csv", "report.html", "summary.json"} <= contents(folder).keys()
