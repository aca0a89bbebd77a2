"""A load works out what it is asked for: once, the same for a run and for a study."""

from __future__ import annotations

import pickle
from dataclasses import fields, replace

import numpy as np
import pytest
from sample_results import case, rough_result, single_case, single_result, smooth_result

import fem_seal
from fem_seal.answers.accuracy import Comparison
from fem_seal.answers.case_load import CaseLoad, case_loads
from fem_seal.output.columns import COLUMNS, LEAK_COLUMNS
from fem_seal.output.tables import leak_rows
from fem_seal.seal.findings import VALID
from fem_seal.seal.leak_model import FlowModel, LeakModel
from fem_seal.seal.load_result import LoadResult
from fem_seal.seal.sources import OWN_BODIES
from fem_seal.studies import responses
from leak import Reading, effective_viscosity_ratio

HELIUM = case(fluid={"name": "helium"}, load={"fluid_pressure": "3 bar"})


def untouched(load: LoadResult) -> LoadResult:
    """The same load, of which nothing has been worked out."""
    return replace(load, rough=load.rough and replace(load.rough))


def numbers(load: LoadResult) -> list[float]:
    return [COLUMNS[name].number(load) for name in LEAK_COLUMNS]


def test_nothing_is_worked_out_before_it_is_asked_for_and_nothing_twice(monkeypatch):
    result, made, table_around = rough_result(), [], FlowModel.table_around

    def counted(flow, surface, log_peaks):
        made.append(surface)
        return table_around(flow, surface, log_peaks)

    monkeypatch.setattr(FlowModel, "table_around", counted)
    rough = LeakModel.of(result.surface, result.problem.flow, result.contact)
    bare = [LoadResult(*load.point, load.contact, rough) for load in result.loads]
    loads = case_loads(result.problem, bare)
    assert "leak" not in repr(loads[0]) and made == []
    rates = [load.leak.leak_rate for load in loads]
    assert made == [result.surface]
    assert np.all(np.array([load.scenarios[Reading.ELASTIC].leak.leak_rate for load in loads]) > rates)
    assert made == [result.surface, result.surface.elastic]
    assert "leak rate" in repr(loads[0])


def test_more_of_a_load_is_known_without_working_it_out_again():
    load = untouched(rough_result().loads[0])
    leak = load.leak
    known = load.with_values(blow_off_pressure=4e5, critical_separation=0.0)
    assert known.leak is leak and known.blow_off_pressure == 4e5 and known.critical_separation == 0.0
    assert load.blow_off_pressure is None and load.critical_separation > 0.0
    # another pressure is another leak rate, of water that becomes thinner by it
    law, drop = load.rough.flow.pressure_law, load.fluid_pressure
    thinner = effective_viscosity_ratio(law, drop) / effective_viscosity_ratio(law, 2 * drop)
    assert replace(known, fluid_pressure=2 * load.fluid_pressure).leak.leak_rate == pytest.approx(
        2 * leak.leak_rate * thinner, rel=1e-12
    )
    with pytest.raises(AttributeError, match="no optional blow_off"):
        load.with_values(blow_off=4e5)


def test_a_load_answers_alike_after_pickling_touched_or_not():
    for load in (rough_result().loads[0], single_result().loads[0], smooth_result().loads[0]):
        for one in (load, untouched(load)):
            again = pickle.loads(pickle.dumps(one))
            np.testing.assert_allclose(numbers(again), numbers(load), rtol=1e-14)
    whole = pickle.loads(pickle.dumps(rough_result()))
    assert repr(whole) == repr(rough_result())


@pytest.mark.slow
@pytest.mark.parametrize("of", [case(load={"fluid_pressure": "20 bar"}), single_case(), HELIUM])
def test_a_design_with_the_contact_of_a_run_has_its_numbers(of, monkeypatch):
    monkeypatch.setattr(responses, "_source", lambda *asked: OWN_BODIES)
    found = responses.evaluate_design(of, LEAK_COLUMNS, interpolate=False).values
    (row,) = leak_rows(fem_seal.run(of), all_columns=True)
    assert found == pytest.approx({name: row[name] for name in LEAK_COLUMNS}, rel=1e-12, nan_ok=True)


def test_a_contact_apart_from_the_others_has_its_own_critical_separation():
    load = rough_result().loads[0]
    alone = replace(load, rough=replace(load.rough, peaks=()))
    assert alone.critical_separation == pytest.approx(load.critical_separation, rel=1e-7)


def test_a_load_without_roughness_or_fluid_leaks_nothing():
    load = rough_result().loads[0]
    smooth = LoadResult(2e5, 0.0, load.contact)
    dry = replace(smooth, rough=LeakModel.of(rough_result().surface, None, [load.contact]))
    assert smooth.leak is dry.leak is smooth.critical_separation is None
    assert dry.critical_separation == pytest.approx(load.critical_separation, rel=1e-7)


def test_every_field_but_contact_and_point_may_stay_unknown():
    assert [one.name for one in fields(LoadResult)][:3] == ["fluid_pressure", "applied_force", "contact"]
    load = CaseLoad.of(LoadResult(2e5, 0.0, rough_result().contact[0]))
    assert load.validity is VALID and load.contact_force == load.contact.contact_force


def test_changes_are_relative_and_have_no_leak_rate_where_there_is_nothing_to_compare():
    base = Comparison("as it is", 100e6, 1e-3, 4e-4, 1e-9)
    change = Comparison("stiffer", 110e6, 0.9e-3, 4e-4, 0.8e-9).relative_to(base)
    assert change.name == "stiffer"
    assert (change.peak_pressure, change.fwhm, change.std, change.leak_rate) == pytest.approx(
        (0.1, -0.1, 0.0, -0.2)
    )
    for rate in (None, 0.0, np.inf):
        assert change.relative_to(replace(base, leak_rate=rate)).leak_rate is None
