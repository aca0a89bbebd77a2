"""Readings of yielding asperities: each has its words, and one more needs nothing but its name."""

from dataclasses import replace

import pytest
from sample_results import rough_result

from fem_seal.answers.case_load import case_loads
from fem_seal.answers.form import _FormLoad
from fem_seal.seal.findings import Bounds
from fem_seal.seal.leak_model import LeakModel
from fem_seal.seal.load_result import LoadResult
from fem_seal.seal.scenarios import BESIDE, SCENARIOS
from leak import Reading
from leak.theory.plasticity import READINGS


@pytest.mark.parametrize("reading", Reading)
def test_every_reading_has_its_words(reading):
    words = SCENARIOS[reading]
    assert words.asperities and words.curve
    if reading == "conserved" or reading in BESIDE:
        assert words.condition.startswith("if ") and words.taken and words.title


def test_a_load_reads_itself_as_it_is_and_back():
    load = rough_result().highest
    assert load.scenario(Reading.CONSERVED) is load.scenario("paper") is load
    # its theory does not know this one
    assert load.scenario(Reading.VON_MISES) is None and list(load.others) == [Reading.CAPPED]
    capped = load.scenarios[Reading.CAPPED]
    assert capped is load.others[Reading.CAPPED] and capped.contact is load.contact
    assert load.scenarios[Reading.ELASTIC].rough.surface.hardness is None


def test_a_further_reading_is_one_more_name(monkeypatch):
    """Of the paper's theory there are three for once: the last stands in all that asks for all."""
    monkeypatch.setitem(READINGS, "paper", (Reading.CONSERVED, Reading.CAPPED, Reading.VON_MISES))
    result = rough_result()
    rough = LeakModel.of(result.surface, result.problem.flow, result.contact)
    monkeypatch.setitem(SCENARIOS, "von-mises", replace(SCENARIOS["capped"], title="a third"))
    bare = LoadResult(*result.highest.point, result.highest.contact, rough)
    (load,) = case_loads(result.problem, [bare])
    third = load.scenarios[Reading.VON_MISES]
    assert list(load.others) == [Reading.CAPPED, Reading.VON_MISES]
    assert third.rough.surface.yielding == "von-mises" and third.leak.leak_rate > 0
    rates = {one.leak.leak_rate for one in (load, *load.others.values())}
    assert load.leak_range == Bounds(min(rates), max(rates))
    assert list(_FormLoad(load).others) == list(load.others)


def test_bounds_are_widened_and_back():
    ends = Bounds.of([3.0, 1.0, 2.0])
    assert ends == (1.0, 3.0) and ends.is_range and not Bounds(1.0, 1.004).is_range
    wide = ends.widen(Bounds.factor_bounds(4.0))
    assert wide == (0.25, 12.0) and wide.ratio_to(Bounds.factor_bounds(4.0)) == ends
