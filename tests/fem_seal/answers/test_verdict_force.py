"""The force with which the verdict passes: a run with it passes, and one with 3 % less does not."""

from __future__ import annotations

import json
from dataclasses import replace
from unittest.mock import Mock

import pytest
from places import EXAMPLES
from sample_results import STEEL, ball, case, cone, run_loads

import fem_seal
from fem_seal.answers.accuracy import NOT_ESTIMATED
from fem_seal.answers.judgement import VerdictForce
from fem_seal.answers.verdict import _begins
from fem_seal.output.answers.verdict import (
    FORCE_TO_PASS,
    basis_lines,
    force_to_pass,
    tiles,
    verdict_force_sentences,
)
from fem_seal.output.files import summary
from fem_seal.units import Display
from leak import Reading

DRAWN = {"Ra": "0.4 um", "process": "lapped"}


def with_force(of, force):
    """The same case under one force, without the question for it."""
    return of.replace(load={"applied_force": f"{force!r} N", "target_leak_rate": None})


def verdict_under(of, force, limit):
    required = {} if of.requirement is not None else {"requirement": {"leak_rate": f"{limit!r} m^3/s"}}
    return fem_seal.run(with_force(of, force).replace(required), sensitivities=False)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("tables", "target"),
    [
        # both readings, and nothing sampled
        ({}, 2e-7),
        # the channels get few on the way
        ({}, 3e-8),
        # elastic asperities
        ({"leak": {"plasticity": False}}, 2e-7),
        # a gas against a class of another one
        (
            {"fluid": {"name": "helium"}, "requirement": {"standard": "ISO 5208", "class": "F"}},
            1e-6,
        ),
    ],
    ids=["readings", "few channels", "elastic", "helium"],
)
def test_a_run_with_the_force_passes_and_one_with_less_does_not(tables, target):
    load = {"fluid_pressure": "20 bar", "applied_force": "1 kN", "target_leak_rate": f"{target!r} m^3/s"}
    of = case(load=load, **tables)
    (found,) = fem_seal.run(of, sensitivities=False).loads
    force = found.force_for_verdict
    assert force is not None
    assert verdict_under(of, force, target).verdict == "pass"
    less = force - 0.03 * found.contact_force if force < 0 else 0.97 * force
    assert verdict_under(of, less, target).verdict != "pass"
    # never less than what the readings alone take
    if of.requirement is None:
        loads = [found, *found.others.values()]
        readings = [load.force_for_target for load in loads if load.force_for_target is not None]
        assert force >= max(readings)


@pytest.mark.slow
def test_what_a_drawing_leaves_open_is_in_the_force():
    load = {"fluid_pressure": "20 bar", "applied_force": "2 kN", "target_leak_rate": "1 ml/min"}
    of = case(roughness=DRAWN, load=load)
    result = fem_seal.run(of, sensitivities=False)
    (found,) = result.loads
    assert found.force_for_verdict > 1.1 * max(
        found.force_for_target, found.scenarios[Reading.CAPPED].force_for_target
    )
    limit = of.load.target_leak_rate
    for share, verdict in ((1.0, "pass"), (0.97, "pass unless")):
        under = verdict_under(of, share * found.force_for_verdict, limit)
        assert under.verdict == verdict
        assert under.loads[0].sample_ends is not None
    told = f"from an applied force of {force_to_pass(result.case.display, found.force_for_verdict)} on"
    (line,) = [one for one in basis_lines(result) if "lets the verdict" in one or "verdict passes" in one]
    assert told in line
    assert json.loads(json.dumps(summary(result)["verdict_force"]))[0]["force"] == found.force_for_verdict
    assert summary(result)["loads"][0]["force_for_verdict_N"] == found.force_for_verdict
    (tile,) = [one for one in tiles(result) if one.name == FORCE_TO_PASS]
    assert tile.value == force_to_pass(result.case.display, found.force_for_verdict)


@pytest.mark.slow
def test_where_the_seat_yields_before_the_verdict_passes_it_says_so():
    soft = {**STEEL, "yield_stress": "0.2 GPa", "hardness": "3.5 GPa"}
    load = {"fluid_pressure": "20 bar", "applied_force": "1 kN", "target_leak_rate": "1e-9 m^3/s"}
    (found,) = fem_seal.run(case(closure=ball(), seat=cone(soft), load=load), sensitivities=False).loads
    assert found.force_for_verdict is None
    assert "beyond it all loads are outside the theory (seat: von Mises stress" in str(
        found.verdict_force.why_none
    )
    (told,) = verdict_force_sentences(Display(), [found])
    assert told.startswith("At 20 bar no force lets the verdict pass: up to an applied force of ")


@pytest.mark.slow
def test_a_target_does_not_touch_the_verdict_of_its_load():
    """Another question spoils nothing: verdict, margin and words are those of the case without a target."""
    tables = {"requirement": {"leak_rate": "1e-9 m^3/s"}}
    plain = run_loads(case(load={"fluid_pressure": "2 bar"}, **tables))
    asked = run_loads(case(load={"fluid_pressure": "2 bar", "target_leak_rate": "0.02 mm^3/s"}, **tables))
    assert asked.loads[0].validity == plain.loads[0].validity
    assert asked.loads[0].judgement == plain.loads[0].judgement
    asked_lines = [one for one in basis_lines(asked) if "lets the verdict" not in one and "passes" not in one]
    assert asked_lines == basis_lines(plain)


@pytest.mark.slow
def test_of_a_body_that_yields_it_is_not_looked_for_unless_asked(monkeypatch):
    examples = EXAMPLES
    load = {"fluid_pressure": ["200 bar", "50 bar"], "applied_force": "100 N", "target_leak_rate": "1 mm^3/s"}
    of = fem_seal.load_case(examples / "elastoplastic_seat.toml").replace(
        {**{f"load.{key}": value for key, value in load.items()}, "mesh.contact_size": "40 um"}
    )
    # the forces without the interval are not what this is about
    monkeypatch.setattr("fem_seal.answers.target.contacts_at_target", Mock(side_effect=KeyError("not asked")))
    told = []

    def search(result, alone, *, progress):
        progress("trying")
        with pytest.raises(_LeaveError):
            alone(50e5, 100.0)
        return [VerdictForce(1e3, begins=_begins(result.problem))] * len(result.loads)

    def progress(text):
        told.append(text)
        if told[-2:-1] == ["trying"]:
            raise _LeaveError

    monkeypatch.setattr("fem_seal.answers.verdict.forces_for_verdict", search)
    plain = run_loads(of)
    assert all(not one.verdict_force.looked_for and one.force_for_verdict is None for one in plain.loads)
    (said,) = verdict_force_sentences(Display(), plain.loads)
    assert said.startswith(
        "The force with which the verdict passes was not calculated: where a body yields, "
    )
    (tile,) = [one for one in tiles(plain) if one.name == FORCE_TO_PASS]
    assert tile.value == "not calculated"
    with pytest.MonkeyPatch.context() as few:
        few.setattr("fem_seal.answers.accuracy.on_coarser_mesh", lambda *given: None)
        few.setattr("fem_seal.answers.accuracy.discretisation_error", lambda *given: NOT_ESTIMATED)
        few.setattr("fem_seal.answers.accuracy.far_field", lambda *given: ())
        few.setattr("fem_seal.answers.variants.interface_variants", lambda *given: ())
        asked = fem_seal.run(of, progress, sensitivities=False, verdict_force=True)
    # a run of the search tells what it does, and who is told may leave it
    assert told[told.index("trying") + 1] == "meshing closure and seat"
    for one in verdict_force_sentences(Display(), asked.loads):
        assert "the verdict passes on a new seal from an applied force of 1000 N on" in one


class _LeaveError(BaseException):
    pass


@pytest.mark.slow
def test_each_force_that_is_tried_is_told():
    load = {"fluid_pressure": "20 bar", "applied_force": "1 kN", "target_leak_rate": "2e-7 m^3/s"}
    of = case(load={**load, "largest_earlier_force": "1.5 kN"})
    told = []
    (found,) = fem_seal.run(of, told.append, sensitivities=False).loads
    tried = [one for one in told if one.startswith("force with which the verdict passes at 20 bar: trying ")]
    assert any("trying a contact force of " in one for one in tried)
    assert any("trying the whole run with " in one for one in tried)
    (said,) = verdict_force_sentences(Display(), [found])
    assert " after the largest earlier load" in said


def test_nobody_who_does_not_ask_pays():
    (load,) = run_loads(case(load={"fluid_pressure": "2 bar"})).loads
    assert load.verdict_force is None and load.force_for_verdict is None
    assert verdict_force_sentences(Display(), [load]) == []


def test_the_force_is_read_as_one_that_passes():
    load = run_loads(case(load={"fluid_pressure": "2 bar"})).loads[0]
    for force in (75148.8, 1000.0, 999.2, 0.01234):
        told = load.with_values(verdict_force=VerdictForce(force))
        assert told.force_for_verdict == force
        number, unit = force_to_pass(Display(), force).split()
        read = float(number) * {"kN": 1e3, "N": 1.0, "mN": 1e-3}[unit]
        assert force * (1 - 1e-9) <= read <= 1.011 * force
    assert replace(VerdictForce(None), why_none="x").force is None
