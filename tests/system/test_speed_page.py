"""Figures over versions: how they are judged and kept, and the page that is made of them. Nothing is timed here."""

from dataclasses import replace

import history
import pytest
import speed_page
from history import Entry

OLD = Entry("0.1.0", "2026-01-01", "aaaaaaa", "run: wall time", 3.7, "s", 1.8, 0.33)
NEW = replace(OLD, version="0.2.0", date="2026-02-02", commit="bbbbbbb", value=3.0, reference_s=0.66)
MEMORY = replace(NEW, figure="run: memory", value=251.0, unit="MB", goal=200.0)
BARE = replace(OLD, figure="cluster: wall time", value=2.0, unit="ms", goal=None, note="2500 designs")


def test_a_time_is_judged_on_the_machine_of_the_goals():
    # twice as slow a machine: 3.0 s are 1.5 s there
    assert NEW.machine_scaled == pytest.approx(1.5)
    assert (OLD.is_met, NEW.is_met, MEMORY.is_met, BARE.is_met) == (False, True, False, None)
    # memory and ratios do not depend on how fast the machine is
    assert MEMORY.machine_scaled == 251.0
    assert replace(NEW, unit="imports").machine_scaled == 3.0


def test_the_ratio_is_to_the_last_program_that_was_measured():
    known = [OLD, MEMORY]
    assert history.find_previous(known, NEW) == OLD
    assert history.row(NEW, OLD)[-2:] == ("met", f"{1.5 / 3.7:.2f}")
    assert history.find_previous([OLD, NEW], NEW) == OLD
    assert history.find_previous([OLD], OLD) is None
    assert history.find_previous(known, BARE) is None


def test_rows_come_back_as_they_were_written(tmp_path):
    rows = [OLD, MEMORY, BARE, replace(NEW, note='with "quotes", and commas')]
    history.write(rows, tmp_path / "history.csv")
    assert history.read(tmp_path / "history.csv") == rows


def test_a_program_that_is_measured_again_has_its_rows_replaced():
    again = replace(NEW, value=2.9)
    assert history.with_new([OLD, NEW, MEMORY], [again]) == [OLD, MEMORY, again]
    assert history.latest([OLD, MEMORY, again]) == [again, MEMORY]


def test_the_page_says_plainly_what_is_missed(tmp_path):
    history.write([OLD, BARE, NEW, MEMORY], tmp_path / "history.csv")
    speed_page.main(tmp_path / "history.csv", tmp_path / "made")
    page = (tmp_path / "made" / "speed.md").read_text(encoding="utf-8")
    assert page.startswith(
        "**1 of 2 goals are met.** Missed:\n\n- run: memory: 251 MB, 1.25 times its goal of 200 MB\n"
    )
    assert "| run: wall time | 3 s | 1.5 | 1.8 s | met | 0.41 | bbbbbbb |" in page
    assert "| run: memory | 251 MB |  | 200 MB | **missed** |  | bbbbbbb |" in page
    # over versions: the scaled times, and a gap where a figure was not measured
    assert "| figure | 0.1.0 aaaaaaa 2026-01-01 | 0.2.0 bbbbbbb 2026-02-02 |" in page
    assert "| run: wall time | 3.7 s | 1.5 s |" in page
    assert "| cluster: wall time | 2 ms |  |" in page
    assert "- cluster: wall time: 2500 designs." in page
    assert (tmp_path / "made" / "speed.svg").read_text(encoding="utf-8").count("run: ") >= 2


def test_the_history_of_this_repository_is_readable():
    entries = history.read()
    assert len(entries) >= 10
    assert all(entry.value >= 0 and entry.reference_s > 0 for entry in entries)
    # one value of a figure for each program, and one unit in all of them
    assert len({(entry.state, entry.figure) for entry in entries}) == len(entries)
    assert len({(entry.figure, entry.unit) for entry in entries}) == len({entry.figure for entry in entries})
