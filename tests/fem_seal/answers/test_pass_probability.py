"""The share of the samples that keep the requirement: against closed forms, complete runs and itself."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from sample_results import STEEL, case, cone
from scipy.special import ndtr, ndtri

import fem_seal
from fem_seal.answers import pass_probability as module
from fem_seal.answers.answer import loads_of
from fem_seal.answers.case_load import SolvedSeal
from fem_seal.answers.chain import ANSWERS
from fem_seal.answers.judgement import PassProbability
from fem_seal.answers.pass_probability import pass_probabilities
from fem_seal.answers.response_surface import Polynomials, fit_with_prior
from fem_seal.answers.samples import Samples, uncertain_inputs
from fem_seal.files import own_tables
from fem_seal.output.answers.verdict import basis_lines, tiles, verdict_in_brief, verdict_numbers
from fem_seal.output.report.brief import first_line
from fem_seal.output.tables import leak_table
from fem_seal.sampling import sobol_points
from fem_seal.seal.evaluate import evaluate
from fem_seal.seal.findings import Level, Validity, remark
from fem_seal.seal.problem import SealProblem
from fem_seal.studies.responses import evaluate_design
from fem_seal.units import Display
from fem_seal.wording import say
from leak import FlowError

PASSING = ["pass_probability", "pass_probability_error"]
FINISH = {"seat": {"Ra": "0.8 um", "process": "turned"}, "closure": {"Ra": "0.1 um", "process": "lapped"}}
HARD = {**STEEL, "hardness": "3.5 GPa"}


def one(leak_rate="1e-8 m^3/s", **tables):
    """A case of one load with a requirement, by the corrected theory."""
    given = {
        "load": {"fluid_pressure": "20 bar"},
        "leak": {"theory": "corrected", "plasticity": False},
        "requirement": {"leak_rate": leak_rate},
        **tables,
    }
    return case(**given)


def seal_of(wanted):
    """Its solved seal without answers."""
    evaluations = [evaluate(SealProblem.of(wanted))]
    return SolvedSeal.of(evaluations, wanted, loads_of(evaluations))


@cache
def seal_with(theory, **spreads):
    """A solved seal with uncertain inputs, by their relative widths."""
    table = {name: {"relative": width} for name, width in spreads.items()}
    return seal_of(one(leak={"theory": theory, "plasticity": False}, uncertainty=table))


def required(seal, leak_rate):
    """A solved seal with another requirement."""
    return replace(seal, case=seal.case.replace({"requirement": {"leak_rate": f"{leak_rate!r} m^3/s"}}))


def passing(seal, leak_rate):
    """Of its only load."""
    (found,) = pass_probabilities(required(seal, leak_rate))
    return found


@pytest.mark.parametrize("over", [0.8, 1.0, 1.3])
def test_a_lognormal_viscosity_alone_has_a_closed_form(over):
    seal = seal_with("paper", viscosity=0.2)
    found = passing(seal, over * seal.loads[0].leak.leak_rate)
    assert found.share == pytest.approx(ndtr(math.log(over) / 0.2), abs=2e-3)
    assert found.error <= 0.02


def test_with_the_error_of_the_theory_variances_add():
    seal = seal_with("corrected", viscosity=0.2)
    (load,) = seal.loads
    error, over = load.flow_error, 1.2
    spread = math.hypot(0.2, float(error.spread))
    closed = ndtr((math.log(over) - float(error.bias)) / spread)
    assert passing(seal, over * load.leak.leak_rate).share == pytest.approx(closed, abs=2e-3)


def test_without_uncertain_inputs_the_error_of_the_theory_is_all():
    seal = seal_of(one())
    (load,) = seal.loads
    found = passing(seal, load.leak.leak_rate)
    assert found.share == pytest.approx(float(load.flow_error.share_below(1.0)), abs=1e-6)
    assert found.error == 0.0
    # the paper's theory does not know its own
    none = passing(seal_of(one(leak={"theory": "paper", "plasticity": False})), load.leak.leak_rate)
    assert math.isnan(none.share) and "nothing is uncertain" in str(none.why_none)


@pytest.mark.slow
def test_complete_runs_with_drawn_inputs_find_the_same_share():
    wanted = one(
        leak={"theory": "paper", "plasticity": False},
        uncertainty={"rms_height": {"relative": 0.2}, "youngs_modulus": {"relative": 0.1}},
    )
    seal, count = seal_of(wanted), 48
    inputs = uncertain_inputs(wanted, wanted.uncertainty)
    uniform = sobol_points(count, 2, seed=77)
    factors = {each.name: each.values(uniform[:, [n]])[:, 0].tolist() for n, each in enumerate(inputs)}
    rates = []
    for n in range(count):
        height, stiffer = factors["rms_height"][n], factors["youngs_modulus"][n]
        rough = wanted.roughness.spectrum.rms_height
        steel = {**STEEL, "youngs_modulus": f"{210e9 * stiffer!r} Pa"}
        drawn = wanted.replace_written(
            {
                "roughness.spectrum.rms_height": f"{rough * height!r} m",
                "closure.material": steel,
                "seat.material": steel,
            }
        )
        (load,) = evaluate(SealProblem.of(drawn)).loads
        rates.append(load.leak.leak_rate)
    for limit in np.quantile(rates, [0.25, 0.6, 0.9]).tolist():
        found, counted = passing(seal, limit), float(np.mean(np.array(rates) <= limit))
        error = math.hypot(found.error, math.sqrt(counted * (1 - counted) / count))
        assert abs(found.share - counted) < 3 * error


@pytest.mark.slow
def test_the_share_rises_with_what_is_allowed():
    seal = seal_with("corrected", rms_height=0.2, hurst=0.05)
    rate = seal.loads[0].leak.leak_rate
    shares = [passing(seal, over * rate).share for over in np.geomspace(0.1, 10, 9).tolist()]
    assert (np.diff(shares) >= 0.0).all()
    assert shares[0] < 0.05 and shares[-1] > 0.95


@pytest.mark.slow
def test_a_finish_is_known_within_its_standard_error():
    wanted = one(roughness=FINISH, seat=cone(HARD), leak={"theory": "corrected"})
    seal = seal_of(wanted)
    rate = 1.2 * seal.loads[0].leak.leak_rate
    found, settings = passing(seal, rate), wanted.sampling
    assert 0.1 < found.share < 0.9 and found.error <= 0.02
    # four times the runs
    many = Samples.of(seal, settings.model_copy(update={"samples": 4096}))
    runs = many.leak_rates(range(120)).reshape(120, -1)
    told = module._of_loads(required(seal, rate).case, module.QuickSamples(many, (0,), np.arange(120), runs))
    assert abs(told[0].share - found.share) < 3 * math.hypot(found.error, told[0].error)
    # another scramble of the samples
    (other,) = pass_probabilities(
        replace(seal, case=required(seal, rate).case.replace({"uncertainty": {"seed": 9}}))
    )
    assert abs(other.share - found.share) < 3 * math.hypot(found.error, other.error)


@cache
def exact_rate(problem):
    """Leak rate of the only load of a problem, on a mesh of its own [m^3/s]."""
    (load,) = evaluate(problem).loads
    return load.leak.leak_rate


@pytest.mark.slow
@pytest.mark.parametrize("share", [0.1, 0.5, 0.95])
def test_complete_runs_of_a_finish_find_the_same_share_within_its_standard_error(share):
    wanted = one(roughness=FINISH, seat=cone(HARD), leak={"theory": "corrected"})
    seal, every = seal_of(wanted), 64
    samples = Samples.of(seal, wanted.sampling)
    # each of them solved as a run is, with a table of its own
    rates = np.array([exact_rate(*samples.problems(number)) for number in range(every)])
    assert samples.leak_rates(range(8))[:, 0, 0] == pytest.approx(rates[:8], rel=0.01)
    limit = float(np.quantile(rates, share))
    found, error = passing(seal, limit), seal.loads[0].flow_error
    counted = float(error.share_below(limit / rates).mean())
    both = math.hypot(found.error, math.sqrt(counted * (1 - counted) / every))
    assert found.error <= 0.02 and abs(found.share - counted) < 3 * both


def test_a_polynomial_with_a_prior_knows_its_error_and_which_runs_tell_most():
    points = sobol_points(1024, 4, seed=3)
    inputs = ndtri(points)
    polynomials = Polynomials.of(inputs, 3)
    assert (polynomials(inputs).T @ polynomials(inputs) / 1024).diagonal() == pytest.approx(1.0, abs=0.35)
    chosen = polynomials.choose_runs(inputs[:256], 24)
    assert len(set(chosen.tolist())) == 24
    rng, off = np.random.default_rng(5), []
    for _ in range(20):
        coefficients = rng.standard_normal(len(polynomials.exponents)) * np.minimum(polynomials.prior, 10.0)

        def model(z, coefficients=coefficients):
            return (polynomials(z) @ coefficients)[:, None]

        surface = fit_with_prior(polynomials, inputs[chosen], model(inputs[chosen]))
        spread = surface.draw(200)[1:, 0].std(axis=1)
        off.append((surface.coefficients[1:, 0] - coefficients[1:]) / spread)
    assert 0.5 < np.sqrt(np.mean(np.square(off))) < 1.3
    # nearly exact of a plane with enough runs
    plane = fit_with_prior(
        polynomials, inputs[chosen], inputs[chosen] @ np.array([[1.0], [2.0], [-1.0], [0.5]])
    )
    assert np.abs(plane(inputs) - inputs @ np.array([[1.0], [2.0], [-1.0], [0.5]])).max() < 0.2


def test_sealed_samples_pass_and_open_ones_fail(monkeypatch):
    seal = seal_with("paper", rms_height=0.1)

    def some(samples, numbers, loads):
        factor = samples.values["rms_height"][list(numbers)]
        return np.where(factor < 0.95, 0.0, np.where(factor > 1.1, math.inf, 1e-9))[:, None]

    monkeypatch.setattr(Samples, "leak_rates", some)
    few, all_closed = passing(seal, 1e-12), passing(seal, 1e-6)
    assert abs(few.share - ndtr(math.log(0.95) / 0.1)) < 3 * few.error
    assert abs(all_closed.share - ndtr(math.log(1.1) / 0.1)) < 3 * all_closed.error
    assert few.error <= 0.02 and all_closed.error <= 0.02


def test_a_finish_that_leaks_in_two_ways_is_counted(monkeypatch):
    """Few samples are wide open, all others leak through a thread: no polynomial gives both."""
    seal, tried = seal_with("paper", rms_height=0.1, hurst=0.05), set()

    def some(samples, numbers, loads):
        tried.update(numbers)
        z = np.log(samples.values["rms_height"][list(numbers)]) / 0.1
        return np.where(np.abs(z - 0.5) < 0.2, 1e-7, 1e-11 * np.exp(0.3 * z))[:, None]

    monkeypatch.setattr(Samples, "leak_rates", some)
    monkeypatch.setattr(Samples, "of_finish", True)
    found, true = passing(seal, 1e-9), 1.0 - (ndtr(0.7) - ndtr(0.3))
    assert abs(found.share - true) < 3 * found.error and found.error > 0.02
    assert tried.issuperset(range(module.MOST_OF_FINISH))


def test_of_two_readings_the_one_that_passes_less_often_counts():
    wanted = one(
        seat=cone(HARD),
        leak={"theory": "paper", "plasticity": True},
        uncertainty={"viscosity": {"relative": 0.3}},
    )
    seal = seal_of(wanted)
    (load,) = seal.loads
    rates = [each.leak.leak_rate for each in (load, *load.others.values())]
    assert len(rates) == 2
    limit = math.sqrt(rates[0] * rates[1])
    worse = ndtr(math.log(limit / max(rates)) / 0.3)
    assert passing(seal, limit).share == pytest.approx(worse, abs=2e-3)


def test_a_class_is_met_by_the_liquid_of_its_test():
    fluid = {"viscosity": "46 mPa s"}
    table = {"viscosity": {"relative": 0.2}}
    wanted = one(fluid=fluid, uncertainty=table, requirement={"standard": "ISO 5208", "class": "D"})
    seal = seal_of(wanted)
    (limit,) = module.limits(wanted, 20e5)
    assert limit.ratio[0] == limit.ratio[1] > 40
    (found,) = pass_probabilities(seal)
    assert found.share == passing(seal, limit.leak_rate / limit.ratio[1]).share


@pytest.mark.slow
def test_a_class_is_met_by_the_gas_of_its_test():
    wanted = one(
        fluid={"name": "helium"},
        uncertainty={"rms_height": {"relative": 0.2}},
        requirement={"standard": "ISO 5208", "class": "D"},
    )
    seal = seal_of(wanted)
    (load,), (limit,) = seal.loads, module.limits(wanted, 20e5)
    over = load.scenarios["test gas"].leak.leak_rate / load.leak.leak_rate
    (found,) = pass_probabilities(seal)
    assert limit.test_fluid and found.share == pytest.approx(
        passing(seal, limit.leak_rate / over).share, abs=0.02
    )


def test_outside_the_theory_there_is_no_probability():
    seal = seal_of(one())
    outside = Validity.of([remark("yield stress", Level.OUTSIDE, "seat: 3 times its yield stress")])
    (found,) = pass_probabilities(seal.with_loads([seal.loads[0].with_values(validity=outside)]))
    assert str(found.why_none) == "seat: 3 times its yield stress"
    assert math.isnan(found.share)


def test_next_to_none_and_all_the_standard_error_bounds_the_share():
    told = [
        say(Display(), "verdict", "passes", load="1 bar", chance=PassProbability(*each), tested=False)
        for each in ((0.0, 0.004), (1.0, 0.004), (0.3, 0.01), (1.0, 1e-5))
    ]
    shares = [text.removeprefix("At 1 bar ").split(", over")[0] for text in told]
    assert shares == [
        "less than 0.8 % of the samples pass",
        "more than 99.2 % of the samples pass",
        "30.0 % of the samples pass (standard error 1.0 %)",
        "more than 99.9 % of the samples pass",
    ]


def test_every_calculation_time_has_a_name_in_words():
    steps = own_tables("words.toml")["steps"]
    assert {answer.clock or answer.name for answer in ANSWERS if answer.status} <= steps.keys()


def test_a_result_tells_it_in_table_report_and_on_the_terminal():
    wanted = one(leak={"theory": "paper"}, requirement={"leak_rate": "1 m^3/s", "fluid_pressure": "20 bar"})
    wanted = wanted.replace(
        {"load": {"fluid_pressure": ["5 bar", "20 bar"]}, "uncertainty": {"viscosity": {"relative": 0.1}}}
    )
    result = fem_seal.run(wanted, sensitivities=False)
    first, last = result.loads
    assert first.chance is None and first.pass_probability is None and first.pass_probability_error is None
    table = leak_table(result)
    assert math.isnan(table["pass_probability"][0]) and table["pass_probability"][1] == last.pass_probability
    assert last.pass_probability == 1.0
    assert any("more than 99.9 % of the samples pass" in line for line in basis_lines(result))
    assert ("Passes", "more than 99.9 %") in [(tile.name, tile.value) for tile in tiles(result)]
    assert verdict_numbers(result)["pass_probability"] == 1.0
    # of a verdict that is open it is the first line that says it
    limit = {"requirement.leak_rate": last.leak.leak_rate, "requirement.fluid_pressure": ["5 bar", "20 bar"]}
    assert verdict_in_brief(result) == first_line(result) and "such seals" not in first_line(result)
    line = first_line(fem_seal.run(wanted.replace(limit), sensitivities=False))
    assert line.startswith("Inconclusive at 20 bar: ") and line.endswith(" % of such seals pass")
    none = replace(result, loads=(first, last.with_values(chance=PassProbability(why_none="of this"))))
    assert any("no probability to pass is known: of this" in line for line in basis_lines(none))


@pytest.mark.slow
@pytest.mark.parametrize("of", ["finish", "inputs"])
def test_a_design_has_the_probability_of_a_run(of):
    wanted = one(seat=cone(HARD), leak={"theory": "corrected"}, roughness=FINISH)
    if of == "inputs":
        wanted = one(uncertainty={"rms_height": {"relative": 0.2}, "youngs_modulus": {"relative": 0.1}})
    rate = seal_of(wanted).loads[0].leak.leak_rate
    wanted = wanted.replace({"requirement": {"leak_rate": f"{rate!r} m^3/s"}})
    design = evaluate_design(wanted, PASSING).values
    (load,) = fem_seal.run(wanted, sensitivities=False).loads
    assert 0.05 < load.pass_probability < 0.95
    assert design["pass_probability"] == pytest.approx(load.pass_probability, abs=1e-4)
    # whatever else is asked for
    beside = evaluate_design(wanted, ["leak_rate_high_m3_per_s", *PASSING]).values
    assert beside["pass_probability"] == pytest.approx(load.pass_probability, abs=1e-4)


@pytest.mark.slow
def test_equal_designs_have_equal_shares_and_a_better_one_no_smaller_one(tmp_path):
    forced = {"fluid_pressure": "20 bar", "applied_force": "5.1 kN"}
    wanted = one(load=forced, uncertainty={"rms_height": {"relative": 0.2}, "hurst": {"relative": 0.05}})
    rate = seal_of(wanted).loads[0].leak.leak_rate
    wanted = wanted.replace({"requirement": {"leak_rate": f"{rate!r} m^3/s"}})
    study = fem_seal.Study(
        wanted,
        parameters={"load.applied_force": ["5 kN", "5.05 kN", "5.1 kN", "5.2 kN"]},
        responses=[*PASSING, "leak_rate_m3_per_s"],
    )
    table = study.run(folder=tmp_path / "one", workers=0).table
    again = study.run(folder=tmp_path / "two", workers=0).table
    assert (table["pass_probability"] == again["pass_probability"]).all()
    assert (np.diff(table["leak_rate_m3_per_s"]) < 0).all()
    assert (np.diff(table["pass_probability"]) >= 0).all()
    assert table["pass_probability"].between(0.05, 0.95).any()
    assert (table["pass_probability_error"] <= 0.02).all()


@pytest.mark.slow
def test_a_search_keeps_to_designs_that_pass_often_enough(tmp_path):
    wanted = one(
        load={"fluid_pressure": "20 bar", "applied_force": "10 kN"},
        leak={"theory": "paper", "plasticity": False},
        uncertainty={"viscosity": {"relative": 0.3}},
    )
    rate = seal_of(wanted).loads[0].leak.leak_rate
    wanted = wanted.replace({"requirement": {"leak_rate": f"{rate!r} m^3/s"}})
    study = fem_seal.Study(
        wanted,
        parameters={"load.applied_force": {"distribution": "uniform", "low": "0 N", "high": "20 kN"}},
        responses=["leak_rate_m3_per_s"],
        constraints={"safe": "pass_probability >= 0.95"},
        optimise={"minimise": "load.applied_force", "trials": 8, "batch": 8},
    )
    designs = study.run(folder=tmp_path, workers=0)
    table = designs.table
    found = table[table["pass_probability"] >= 0.95]
    assert 0 < len(found) < len(table)
    less = table[table["load.applied_force"] < found["load.applied_force"].min()]
    assert (less["pass_probability"] < 0.95).all()


def test_a_study_says_which_tables_a_probability_needs():
    with pytest.raises(fem_seal.InputError, match=r"pass_probability needs \[requirement\]"):
        fem_seal.Study(
            case(load={"fluid_pressure": "20 bar"}),
            parameters={"seat.angle": ["44 deg", "45 deg"]},
            responses=["pass_probability"],
        )


@pytest.mark.parametrize("of_theory", [0.0, 0.05])
def test_of_a_batch_the_unknown_inputs_leave_a_distribution(monkeypatch, of_theory):
    # ln Q = ln Q0 + 2 ln h - ln eta, heights from part to part, one viscosity for all parts
    part, unknown, over = 0.1, 0.15, 1.6
    table = {
        "rms_height": {"relative": part, "varies": "part"},
        "viscosity": {"relative": unknown},
    }
    seal = seal_of(one(leak={"theory": "paper", "plasticity": False}, uncertainty=table))
    own = FlowError(np.zeros(()), np.full((), math.hypot(of_theory, of_theory)), {"few waves": of_theory**2})
    seal = seal.with_loads([seal.loads[0].with_values(flow_error=own if of_theory else None)])

    def heights(samples, numbers, loads):
        return 1e-9 * samples.values["rms_height"][list(numbers), None] ** 2

    monkeypatch.setattr(Samples, "leak_rates", heights)
    found = passing(seal, over * 1e-9)
    in_batch, of_batches = math.hypot(2 * part, of_theory), math.hypot(unknown, of_theory)
    assert found.share == pytest.approx(ndtr(math.log(over) / math.hypot(in_batch, of_batches)), abs=2e-3)
    low = ndtr((math.log(over) + of_batches * ndtri(0.05)) / in_batch)
    assert found.batch_low == pytest.approx(low, abs=0.01)
    assert found.batch_low < found.share
    # all of them unknown: nothing is said of a batch
    table["rms_height"]["varies"] = "unknown"
    alike = replace(seal, case=seal.case.replace({"uncertainty": table}))
    assert math.isnan(passing(alike, over * 1e-9).batch_low)
    assert passing(alike, over * 1e-9).share == found.share
