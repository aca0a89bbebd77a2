"""What the first lines say of theory and support."""

from __future__ import annotations

import pytest
from sample_results import case, run_loads, smooth_result

from fem_seal.output.answer_outputs import pages_of
from fem_seal.output.answers.variants import beside_in_brief, supported_by
from fem_seal.output.report.brief import lines_in_brief


def test_the_papers_theory_gives_one_number_and_the_default_beside_it():
    result = run_loads(case(load={"fluid_pressure": "20 bar"}))
    first, *_ = lines_in_brief(result, pages_of(result))
    rate = result.case.display.leak_range(result.highest.leak.leak_rate, 2)
    assert first.startswith(f"Leaks {rate} by the theory of Fischer et al. 2020 at 20 bar")
    corrected = result.highest.scenario("corrected").leak_interval
    (default,) = [line for line in beside_in_brief(result) if "default theory" in line]
    assert result.case.display.leak_range(corrected, 2) in default
    assert supported_by(result)[0].startswith("Supported by: measured, one seal")


def test_the_default_theory_is_not_compared():
    result = run_loads(case(load={"fluid_pressure": "20 bar"}, leak={"theory": "corrected"}))
    assert [*beside_in_brief(result)] == []
    assert supported_by(result)[0].startswith("Supported by: simulation")


@pytest.mark.parametrize("theory", ["paper", "corrected"])
def test_every_line_is_a_short_sentence(theory):
    result = run_loads(case(load={"fluid_pressure": "20 bar"}, leak={"theory": theory}))
    assert max(len(line.split()) for line in lines_in_brief(result, pages_of(result))) <= 25


def test_without_a_leak_rate_nothing_is_supported():
    assert supported_by(smooth_result()) == [*beside_in_brief(smooth_result())] == []
