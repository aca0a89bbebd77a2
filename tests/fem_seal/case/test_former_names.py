"""Names of before the first release still work, and each is said once."""

from __future__ import annotations

import sqlite3
import tomllib
import warnings
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest
from places import EXAMPLES

import fem_seal
from fem_seal import former_names
from fem_seal.cli.app import main
from fem_seal.former_names import FormerNameWarning
from fem_seal.studies.progress import Progress
from fem_seal.studies.store import FILE

CASE = EXAMPLES / "relief_valve.toml"
SMOOTH = {
    "closure": {"shape": "ball", "radius": "20 mm", "material": "steel"},
    "seat": {"shape": "cone", "angle": "45 deg", "material": "steel"},
    "interface": {"law": "smooth"},
}
ROUGH = {
    "closure": {"shape": "ball", "radius": "20 mm", "material": "316L"},
    "seat": {"shape": "cone", "angle": "45 deg", "material": "316L"},
    "roughness": {
        "spectrum": {
            "kind": "self-affine",
            "rms_height": "0.3 um",
            "hurst": 0.8,
            "q_low": "1e4 1/m",
            "q_rolloff": "1e4 1/m",
            "q_high": "1e7 1/m",
        }
    },
    "fluid": {"name": "water"},
}


@pytest.fixture(autouse=True)
def nothing_said(monkeypatch) -> None:
    monkeypatch.setattr(former_names, "_said", set())


def told(caught: list[warnings.WarningMessage]) -> list[str]:
    return [str(one.message) for one in caught if issubclass(one.category, FormerNameWarning)]


def in_former_words(text: str) -> str:
    return text.replace("applied_force", "axial_force")


def test_a_case_with_the_former_key_is_the_same_case(tmp_path) -> None:
    path = tmp_path / "old.toml"
    path.write_text(in_former_words(CASE.read_text(encoding="utf-8")), encoding="utf-8")
    with pytest.warns(FormerNameWarning) as caught:
        old = fem_seal.load_case(path)
        again = (
            fem_seal.load_case(path).replace({"load.axial_force": "7 N"}).replace(load={"axial_force": 8.0})
        )
    assert told(caught) == ["load.axial_force is called load.applied_force now; the former name still works"]
    assert caught[0].filename == __file__ and issubclass(FormerNameWarning, DeprecationWarning)
    assert old.load.points == fem_seal.load_case(CASE).load.points
    assert again.load.applied_force == 8.0 and "axial_force" not in again.written["load"]


def test_the_former_name_of_a_value_works_and_is_said_once() -> None:
    tables = {**ROUGH, "load": {"fluid_pressure": "20 bar"}, "leak": {"plasticity": False}}
    with pytest.warns(FormerNameWarning) as caught:
        cases = [fem_seal.Case(**tables, interface={"law": "persson"}) for _ in range(2)]
        cases.append(cases[0].replace({"interface.law": "smooth"}).replace({"interface.law": "persson"}))
        study = fem_seal.Study(
            cases[0],
            parameters={"interface.law": ["persson", "smooth"]},
            responses=["peak_pressure_Pa"],
        )
    assert told(caught) == ['interface.law = "persson" is called "spectrum" now; the former name still works']
    assert caught[0].filename == __file__
    assert {case.interface.law for case in cases} == {"spectrum"}
    assert study.parameters[0].levels == ("spectrum", "smooth")


def test_both_names_of_a_key_are_refused() -> None:
    load = {"fluid_pressure": "20 bar", "axial_force": "1 N", "applied_force": "2 N"}
    with pytest.raises(fem_seal.InputError, match=r"load\.axial_force"):
        fem_seal.Case(**SMOOTH, load=load)


@pytest.mark.slow
def test_the_terminal_says_it_in_one_line(tmp_path, capsys) -> None:
    path = tmp_path / "old.toml"
    path.write_text(in_former_words(CASE.read_text(encoding="utf-8")), encoding="utf-8")
    for _ in range(2):
        assert main(["check", str(path), "--json"]) == 0
        said = capsys.readouterr()
        assert said.err.count("axial_force") == 1 and "warning: load.axial_force is called" in said.err
        assert '"contact_force_N"' in said.out
    assert main(["check", str(CASE), "-q"]) == 0
    assert "axial_force" not in capsys.readouterr().err


def test_the_former_option_is_taken(tmp_path, capsys) -> None:
    path = tmp_path / "new.toml"
    assert main(["new", "-t", "needle", "-o", str(path), "--axial-force", "321 N"]) == 0
    assert capsys.readouterr().err.count("--axial-force is called --applied-force now") == 1
    assert tomllib.loads(path.read_text(encoding="utf-8"))["load"]["applied_force"] == "321 N"


def test_the_former_option_of_sensitivities_is_taken(tmp_path, capsys, monkeypatch) -> None:
    asked = {}

    def run(case, progress, **wanted):
        asked.update(wanted)
        raise fem_seal.InputError.at("case", "is not run here")

    monkeypatch.setattr("fem_seal.result.run", run)
    assert main(["run", str(CASE), "--no-levers", "-o", str(tmp_path)]) != 0
    assert asked["sensitivities"] is False
    assert capsys.readouterr().err.count("--levers is called --sensitivities now") == 1


def test_names_in_python() -> None:
    case = fem_seal.Case(**SMOOTH, load={"fluid_pressure": "20 bar", "applied_force": "100 N"})
    result = fem_seal.run(case)
    (load,) = result.loads
    model, law = result.model, fem_seal.HardContact()
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        for _ in range(2):
            assert fem_seal.axial_force_for_leak is fem_seal.applied_force_for_leak
            assert case.load.axial_force == 100.0
            assert load.axial_force == load.contact.axial_force == load.contact_force
            assert load.contact.closing_force == load.contact.applied_force
            assert fem_seal.derive(case).loads[0].closing_force == pytest.approx(load.contact_force)
            assert fem_seal.solve(model, law, axial_force=1257.0).contact_force == 1257.0
    assert len(told(caught)) == len(set(told(caught))) == 7


def test_a_study_in_former_words(tmp_path) -> None:
    (tmp_path / "list.csv").write_text("load.axial_force [N]\n100\n2000\n", encoding="utf-8")
    with pytest.warns(FormerNameWarning) as caught:
        study = fem_seal.Study(
            {**SMOOTH, "load": {"fluid_pressure": "20 bar"}},
            parameters={"load": {"axial_force": ["100 N", "2 kN"]}},
            responses=["axial_force_N", "peak_pressure_Pa"],
            derived={"carried": "axial_force_N - load.axial_force"},
            constraints={"little": 'axial_force_N < "2 kN"'},
            report={"goals": {"axial_force_N": "max"}},
        )
        listed = fem_seal.Study(
            {**SMOOTH, "load": {"fluid_pressure": "20 bar"}},
            design={"kind": "list", "file": str(tmp_path / "list.csv")},
            responses=["axial_force_N"],
        )
    assert len(told(caught)) == 2
    assert study.names == listed.names == ["load.applied_force"]
    table = study.run(workers=0).table
    assert {"load.applied_force", "contact_force_N"} <= set(table.columns)
    assert table["carried"].to_numpy() == pytest.approx(np.pi * 0.02**2 / 2 * 20e5)
    assert table["little"].tolist() == [True, False]


def stored_under_former_names(folder: Path) -> None:
    """Put a stored study back to what a program of before has written."""
    with closing(sqlite3.connect(folder / FILE)) as connection, connection:
        connection.execute('ALTER TABLE point RENAME COLUMN "contact_force_N" TO "axial_force_N"')
        connection.execute('ALTER TABLE point RENAME COLUMN "load.applied_force" TO "load.axial_force"')
        connection.execute("UPDATE point SET key = 'former' || key")
        connection.execute("UPDATE design SET key = 'former' || key")
        for name, text in connection.execute("SELECT name, text FROM about").fetchall():
            former = text.replace("contact_force_N", "axial_force_N").replace("applied_force", "axial_force")
            connection.execute("UPDATE about SET text = ? WHERE name = ?", (former, name))


def test_a_stored_study_in_former_words_is_read_and_calculated_anew(tmp_path, capsys) -> None:
    tables = {
        "base": {**SMOOTH, "load": {"fluid_pressure": "20 bar"}},
        "parameters": {"load.applied_force": ["100 N", "2 kN"]},
        "responses": ["contact_force_N"],
        "constraints": {"little": 'contact_force_N < "2 kN"'},
        "report": {"goals": {"contact_force_N": "max"}},
    }
    before = fem_seal.Study(tables).run(folder=tmp_path, workers=0).table
    stored_under_former_names(tmp_path)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        held = fem_seal.StudyResult(tmp_path)
        assert held.table.equals(before) and held.best(1).index.tolist() == [0]
        assert "contact force" in held.report().read_text(encoding="utf-8")
    notes: list[str] = []

    class Told(Progress):
        def note(self, text: str) -> None:
            notes.append(text)

    with pytest.warns(FormerNameWarning):
        resumed = fem_seal.Study(tables).run(folder=tmp_path, workers=0, resume=True, progress=Told())
    assert len(notes) == 1 and "all are calculated anew" in notes[0]
    assert resumed.table.equals(before) and resumed.counts["done"] == 2
    fem_seal.Study(tables).run(folder=tmp_path, workers=0, resume=True, progress=Told())
    assert len(notes) == 1


@pytest.mark.slow
def test_stored_verdicts_are_told_in_present_words(tmp_path) -> None:
    table = {**ROUGH, "requirement": {"leak_rate": "1 ml/min"}, "load": {"fluid_pressure": "20 bar"}}
    study = fem_seal.Study(
        table, parameters={"load.applied_force": ["0 N", "4 kN"]}, responses=["verdict", "leak_rate_m3_per_s"]
    )
    now = study.run(folder=tmp_path, workers=0).table["verdict"].tolist()
    former = {present: word for word, present in former_names.VERDICTS.items()}
    with closing(sqlite3.connect(tmp_path / FILE)) as connection, connection:
        for present, word in former.items():
            connection.execute("UPDATE point SET verdict = ? WHERE verdict = ?", (word, present))
        stored = {word for (word,) in connection.execute("SELECT verdict FROM point")}
    assert stored <= set(former_names.VERDICTS) and set(now) <= set(former_names.VERDICTS.values())
    assert fem_seal.StudyResult(tmp_path).table["verdict"].tolist() == now
