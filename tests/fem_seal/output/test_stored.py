"""A report drawn from a results folder, and folders from which none can be drawn."""

from __future__ import annotations

import importlib
import operator
import os
import pickle
import re
import shutil
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from sample_results import case, gasket_result, rough_result, run_loads

from fem_seal.cli import app as cli
from fem_seal.output import stored
from fem_seal.version import __version__


def undated(page: Path) -> str:
    return re.sub(r"\d{4}-\d\d-\d\d \d\d:\d\d UTC", "", page.read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return rough_result().write(tmp_path_factory.mktemp("out"))


@pytest.mark.parametrize("result", [rough_result, gasket_result], ids=["elastic", "yields"])
def test_the_report_of_a_folder_is_that_of_the_run(result, tmp_path):
    """Without the bodies' compliance, of which all but a small part of a yielding one consists."""
    _ = result().table  # which is not stored
    folder = result().write(tmp_path / "out")
    assert (folder / stored.FILE).stat().st_size < 10e6
    page = undated(folder / "report.html")
    assert cli.main(["report", str(folder), "-q", "-o", str(tmp_path / "again.html")]) == cli.DONE
    assert undated(tmp_path / "again.html") == page
    (folder / "report.html").unlink()
    assert cli.main(["report", str(folder)]) == cli.DONE
    assert undated(folder / "report.html") == page


class Harm:
    """Calls a function when it is read."""

    def __init__(self, call):
        self.call = call

    def __reduce__(self):
        return self.call


class Writer:
    """Reads as a method of a result, which writes files."""

    def __reduce__(self):
        return getattr, (rough_result().seal_mesh, "write")


HEAD = f"fem-seal result {__version__}\n".encode()


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (None, "holds no result.bin"),
        (b"PK\x03\x04", "is no result of fem-seal"),
        (b"fem-seal result 0.0.1\nabc", f"was written by fem-seal 0.0.1, this is {__version__}"),
        (HEAD, "cannot be read"),
        (HEAD + b"\x80\x05garbage", "cannot be read"),
        (HEAD + pickle.dumps(Harm((os.mkdir, ("harm",)))), "cannot be read"),
        (HEAD + pickle.dumps(Harm((exec, ("import os; os.mkdir('harm')",)))), "cannot be read"),
        (HEAD + pickle.dumps(Harm((shutil.copytree, (".", "harm")))), "cannot be read"),
        (HEAD + pickle.dumps(["no", "result"]), "cannot be read"),
    ],
    ids=["none", "foreign", "older", "empty", "damaged", "system", "code", "library", "list"],
)
def test_what_is_no_result_is_refused(content, reason, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    if content is not None:
        Path(stored.FILE).write_bytes(content)
    assert cli.main(["report", "."]) == cli.WRONG_INPUT
    error = capsys.readouterr().err
    assert reason in error and "run" in error
    assert {path.name for path in tmp_path.iterdir()} <= {stored.FILE}


def calling(module: str, name: str, *arguments: object) -> bytes:
    """A pickle that calls what a name of a module leads to, which `pickle.dumps` does not write."""
    names = b"".join(b"\x8c" + bytes([len(text)]) + text.encode() for text in (module, name))
    return b"\x80\x05" + names + b"\x93" + pickle.dumps(arguments, 5)[2:-1] + b"R."


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (calling("fem_seal.output.pdf", "subprocess.run", ["mkdir", "harm"]), "pdf.subprocess.run"),
        (calling("fem_seal.output.pdf", "subprocess.Popen", ["mkdir", "harm"]), "pdf.subprocess.Popen"),
        (calling("pathlib", "io.FileIO", "harm", "w"), "pathlib.io.FileIO"),
        (calling("fem_seal.studies.results", "StudyResult", "harm"), "StudyResult"),
        (calling("harmful", "call"), "harmful.call"),
        (pickle.dumps(np.array([1.0])), "numpy"),
        (calling(stored.__name__, "_array", "O", (1,), "C", bytes(8)), "OBJECT array"),
        (calling(stored.__name__, "_array", "f8,O", (1,), "C", bytes(16)), "OBJECT array"),
        (calling(stored.__name__, "_scalar", "O", bytes(8)), "OBJECT array"),
    ],
    ids=["function", "process", "file", "study", "import", "array", "objects", "record", "object"],
)
def test_what_could_run_code_is_not_read(content, reason, tmp_path, monkeypatch):
    """Nor is a module imported, from whichever folder."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    Path("harmful.py").write_text("import os; os.mkdir('harm')", encoding="utf-8")
    Path(stored.FILE).write_bytes(HEAD + content)
    with pytest.raises(ValueError, match=reason):
        stored.read_result(tmp_path)
    assert not Path("harm").exists()


def test_the_full_report_says_what_only_a_full_run_calculates(tmp_path, capsys):
    folder = run_loads(case(load={"fluid_pressure": "20 bar"})).write(tmp_path)
    assert cli.main(["report", str(folder), "--full"]) == cli.DONE
    assert "run CASE.toml --full" in capsys.readouterr().out
    assert 'id="contact"' in (folder / "report.html").read_text(encoding="utf-8")


@pytest.mark.parametrize(("module", "name"), sorted(stored._KNOWN))
def test_what_a_result_may_hold_has_its_present_name(module, name):
    """A renamed function would be met only by the rare results that hold it."""
    assert operator.attrgetter(name)(importlib.import_module(module))


def test_a_study_is_sent_to_its_own_command(tmp_path, capsys):
    (tmp_path / "study.sqlite").touch()
    assert cli.main(["report", str(tmp_path)]) == cli.WRONG_INPUT
    assert "fem-seal study report" in capsys.readouterr().err


def test_a_method_that_writes_is_not_read(tmp_path):
    content = BytesIO()
    stored._Slim(content, rough_result()).dump(Writer())
    (tmp_path / stored.FILE).write_bytes(HEAD + content.getvalue())
    with pytest.raises(ValueError, match=r"SealMesh\.write"):
        stored.read_result(tmp_path)


def test_half_a_file_is_refused(folder, tmp_path):
    whole = (folder / stored.FILE).read_bytes()
    (tmp_path / stored.FILE).write_bytes(whole[: len(whole) // 2])
    with pytest.raises(ValueError, match="cannot be read"):
        stored.read_result(tmp_path)


def test_what_is_left_out_has_a_name_of_its_own():
    """By the name of a class alone it would be left out of others, too."""
    root = Path(stored.__file__).parents[2]
    texts = [
        file.read_text("utf-8")
        for name in ("fem_seal", "leak", "meshes")
        for file in (root / name).rglob("*.py")
    ]
    for name in stored._OF_SOLVING:
        assert sum(len(re.findall(rf"^class {name}\b", text, flags=re.MULTILINE)) for text in texts) == 1, (
            name
        )
