"""A drawing's finish in the case file: keys, words, changes, interval."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from places import EXAMPLES
from sample_results import tiles_of

import fem_seal
from fem_seal.answers.answer import loads_of
from fem_seal.answers.case_load import SolvedSeal
from fem_seal.answers.chain import solve_profiles
from fem_seal.answers.profile_files import ImportedProfile
from fem_seal.answers.samples import Samples
from fem_seal.answers.uncertainty import leak_interval
from fem_seal.case.roughness import read_finish
from fem_seal.case.tables import Uncertainty
from fem_seal.output.answers.leak import leakage_lines
from fem_seal.output.case_words import finish_numbers, finish_rows
from fem_seal.output.report.brief import first_line
from fem_seal.sampling import sobol_points
from fem_seal.seal.evaluate import evaluate
from fem_seal.seal.problem import SealProblem
from fem_seal.units import Display
from leak import Reading

EXAMPLE = EXAMPLES / "ball_cone.toml"
LAPPED = {"Ra": "0.2 um", "process": "lapped"}


@pytest.fixture(scope="module")
def base():
    return fem_seal.load_case(EXAMPLE).replace(
        {"load.fluid_pressure": "20 bar", "mesh.contact_size": "40 um"}
    )


@pytest.fixture(scope="module")
def solved(base):
    return fem_seal.run(base.replace_written({"roughness": LAPPED}))


def height(case):
    return case.roughness.build().rms_height


@pytest.mark.parametrize(
    ("text", "keys"),
    [
        ("lapped Ra 0.2 um", {"Ra": "0.2 um", "process": "lapped"}),
        ("Ra 0.4um, shot-blasted", {"Ra": "0.4 um", "process": "shot-blasted"}),
        ("as cast Rz = 25 um", {"Rz": "25 um", "process": "as cast"}),
        ("Rq 16 uin", {"Rq": "16 uin"}),
    ],
)
def test_a_finish_in_words(text, keys):
    assert read_finish(text) == {"kind": "finish", **keys}


def test_two_faces_add(base):
    pair = base.replace_written({"roughness": LAPPED})
    one = base.replace_written({"roughness": {"seat": LAPPED}})
    words = base.replace_written({"roughness": "lapped Ra 0.2 um"})
    written = base.replace_written({"roughness": {"seat": "lapped Ra 0.2 um", "closure": LAPPED}})
    assert height(pair) == pytest.approx(np.sqrt(2) * height(one))
    assert height(words) == height(pair) == height(written)
    mixed = base.replace_written({"roughness": {"seat": "ground Ra 0.4 um", "closure": LAPPED}})
    seat = base.replace_written({"roughness": {"seat": "ground Ra 0.4 um"}})
    assert height(mixed) ** 2 == pytest.approx(height(seat) ** 2 + height(one) ** 2, rel=5e-5)


def test_the_lay_of_the_steeper_face_prevails(base):
    reamed = base.replace_written({"roughness.seat": "reamed Ra 0.8 um"})
    both = base.replace_written({"roughness": {"seat": "reamed Ra 0.8 um", "closure": "lapped Ra 0.2 um"}})
    assert reamed.roughness.combine()[1] == pytest.approx(0.25)
    assert 0.25 < both.roughness.combine()[1] < 1.0
    radial = base.replace_written({"roughness.seat": {"Ra": "0.8 um", "process": "reamed", "lay": "radial"}})
    assert radial.roughness.combine()[1] == pytest.approx(4.0)
    told = base.replace_written({"roughness": {"seat": "reamed Ra 0.8 um", "peklenik": 0.5}})
    assert told.roughness.combine()[1] == 0.5


def test_changes_from_another_kind_and_back(base):
    dotted = base.replace_written({"roughness.Ra": "0.2 um", "roughness.process": "lapped"})
    assert height(dotted) == height(base.replace_written({"roughness": LAPPED}))
    in_code = base.replace({"roughness.Ra": 0.2e-6, "roughness.process": "lapped"})
    assert height(in_code) == pytest.approx(height(dotted))
    assert height(base.replace({"roughness.seat": {"Ra": 0.2e-6}})) == pytest.approx(
        height(base.replace_written({"roughness.seat.Ra": "0.2 um"}))
    )
    back = dotted.replace({"roughness.spectrum": base._input["roughness"]["spectrum"]})
    assert height(back) == height(base)
    # another value of the same finish, another parameter instead of it, and the finish of one face alone
    rougher = dotted.replace_written({"roughness.Ra": "0.4 um"})
    assert rougher.roughness.process == "lapped"
    assert dotted.replace_written({"roughness.Rz": "1.5 um"}).roughness.height == "Rz"
    seat = dotted.replace_written({"roughness.seat.Ra": "0.4 um"}).roughness
    assert (seat.seat.Ra, seat.closure.Ra) == (0.4e-6, 0.2e-6)
    assert seat.seat.process == seat.closure.process == "lapped"


@pytest.mark.parametrize(
    ("roughness", "says"),
    [
        ({"Ra": "0.4 um", "process": "laped"}, '"lapped" or "polished".*do you mean "lapped"'),
        ({"Ra": "0.4 um", "Rq": "0.5 um"}, "has Ra and Rq; a finish has one of them"),
        ({"seat": {"Ra": "0.4 um", "Rz": "2 um"}}, "roughness.seat: has Ra and Rz"),
        ({"process": "lapped"}, "has process, which goes with Ra, Rq or Rz"),
        ({"kind": "finish"}, "goes with Ra, Rq or Rz"),
        ({"seat": {"kind": "finish", "process": "lapped"}}, "needs Ra, Rq or Rz"),
        ({"Ra": "0.4"}, "has no unit"),
        ({"Ra": "0.4 um", "lambda_c": "1 um"}, "must be shorter than lambda_c"),
        ({"Ra": "0.4 um", "seat": LAPPED}, "the finish of each face, and seat"),
        ({"along": LAPPED, "across": LAPPED}, "a finish along or across the flow"),
        ("mirror", "is no finish"),
    ],
)
def test_errors_say_what_to_write(base, roughness, says):
    tables = {**base._input, "roughness": roughness}
    with pytest.raises(fem_seal.InputError, match=says):
        fem_seal.load_case(tables)


def test_a_value_that_the_process_does_not_reach_is_remarked_on(base):
    rough = base.replace_written({"roughness": "lapped Ra 6.3 um"})
    assert [text for text in rough.roughness.remarks() if "unusual for lapped surfaces" in text]
    assert not list(base.replace_written({"roughness": LAPPED}).roughness.remarks())


def test_an_interval_comes_without_being_asked_for(solved):
    (low, high), load = solved.leak_ranges[0], solved.loads[0]
    assert low < min(load.leak.leak_rate, load.scenarios[Reading.CAPPED].leak.leak_rate)
    assert high > max(load.leak.leak_rate, load.scenarios[Reading.CAPPED].leak.leak_rate)
    interval = solved.uncertainty
    assert interval.inputs == ("hurst", "q_rolloff", "q_high", "rms_height")
    assert interval.runs <= 40
    # what the ends are uncertain by themselves
    assert interval.error < 0.25


def test_the_widest_interval_leads_on_terminal_and_in_report(solved):
    load, ends = solved.loads[0], solved.leak_ranges[0]
    first, held, usual, _ = leakage_lines(solved.case, load, solved.loads)
    assert f": {Display().leak_range(ends, 2)} = " in first
    assert Display().leak_range(ends, 2) in first_line(solved)
    assert held == "  90 % interval over surfaces of this finish, with both bounds of yielding."
    assert (
        Display().leak_range((load.leak.leak_rate, load.scenarios[Reading.CAPPED].leak.leak_rate), 2) in usual
    )
    # in ml/min and in drops the ends are in the same ratio
    for part in first.split(": ", 1)[1].split(" = ")[:2]:
        low, high = (float(one) for one in re.findall(r"(\d+\.?\d*) to (\d+\.?\d*) ", part)[0])
        assert high / low == pytest.approx(ends[1] / ends[0], rel=0.11)  # two digits each


def test_the_report_shows_the_widest_interval_first_and_in_its_other_units(solved):
    load, ends = solved.highest, solved.leak_ranges[solved.loads.index(solved.highest)]
    tiles = tiles_of(solved)
    rate, others = tiles["Leak rate"], tiles["In other units"]
    assert rate.value == Display().leak_range(ends)
    first = leakage_lines(solved.case, load, solved.loads)[0]
    assert others.value in first and others.remark in first
    both = load.leak.leak_rate, load.scenarios[Reading.CAPPED].leak.leak_rate
    assert f"{Display().leak_range(both, 2)} median surface of this finish" in rate.remark


def test_given_profiles_have_the_interval_of_the_finish(solved):
    """The contact stays, whatever the surface: what it changes of the width of the contact is not in the interval."""
    found = solved.loads[0].contact.profile
    profile = ImportedProfile(found.x, found.pressure, None, None)
    given = solve_profiles(solved.case, [profile])
    assert given.uncertainty is not None and given.error_shares[0].of_width
    ends = zip(given.loads[0].leak_interval, solved.loads[0].leak_interval, strict=True)
    assert all(abs(math.log(one / of_run)) < 0.3 for one, of_run in ends)


def test_samples_are_the_whole_calculations_with_their_inputs(solved):
    """On meshes of their own, with tables over all pressures."""
    from fem_seal.case.tables import Uncertainty

    samples = Samples.of(solved, Uncertainty(samples=16, seed=2))
    for number in range(2):
        rates = [load.leak.leak_rate for load in evaluate(*samples.problems(number)).loads]
        assert samples.leak_rates([number])[0, 0] == pytest.approx(rates, rel=5e-3)


def test_an_interval_at_few_loads_goes_through_all(base):
    from fem_seal.answers.response_surface import at_all_loads, representative

    log_load = np.log(np.geomspace(1e3, 1e5, 21))
    chosen = representative(log_load)
    assert len(chosen) == 5
    assert {0, 20} <= set(chosen)
    slopes = np.array([-0.5, 0.7])[None, :, None]
    ratios = np.exp(slopes * log_load)
    assert at_all_loads(log_load, chosen, ratios[..., chosen]) == pytest.approx(ratios)
    # a sealed load makes no ratio: the nearest known one stands
    sealed = ratios[..., chosen].copy()
    sealed[0, 0, -1] = 0.0
    found = at_all_loads(log_load, chosen, sealed)
    assert found[0, 0, -1] == 0.0
    assert found[0, 1] == pytest.approx(ratios[0, 1])


def test_what_the_user_knows_is_no_longer_uncertain(base):
    from fem_seal.answers.samples import uncertain_inputs
    from fem_seal.case.tables import Spread, Uncertainty

    known = base.replace_written({"roughness": {**LAPPED, "hurst": 0.8, "q_high": "6e6 1/m"}})
    names = [one.name for one in uncertain_inputs(known, known.sampling)]
    assert names == ["q_rolloff", "rms_height"]
    told = Uncertainty(hurst=Spread(relative=0.05), hardness=Spread(relative=0.1))
    case = base.replace_written({"roughness": LAPPED})
    assert [one.name for one in uncertain_inputs(case, told)] == [
        "hardness",
        "hurst",
        "q_rolloff",
        "q_high",
        "rms_height",
    ]


def test_check_and_report_say_what_was_assumed(base):
    case = base.replace_written({"roughness": LAPPED})
    rows = dict(finish_rows(case))
    assert rows["finish of each face"] == "lapped, Ra 0.2 µm"
    assert rows["  measured between"] == "λs 2.5 µm and λc 0.8 mm, across the lay"
    assert "0.80 (assumed; 0.6 to 0.95)" in rows["  Hurst exponent"]
    numbers = finish_numbers(case)["seat"]
    assert numbers["Ra_m"] == pytest.approx(0.2e-6)
    assert numbers["rms_height_m"] > numbers["Rq_m"]


def test_a_finish_is_one_named_factor_of_a_study(base):
    study = fem_seal.Study(
        base,
        responses=["leak_rate_m3_per_s"],
        parameters={"roughness": ["lapped Ra 0.2 um", "ground Ra 0.4 um"], "roughness.seat": ["Ra 1 um"]},
    )
    assert study.names == ["roughness", "roughness.seat"]
    case = study.case_of([1.0, 0.0])
    assert case.roughness.parts["closure"].process == "ground"
    assert case.roughness.parts["seat"].Ra == 1e-6
    # of one parameter the design is the finish that its column names
    alone = fem_seal.Study(
        base,
        responses=["leak_rate_m3_per_s"],
        parameters={"roughness": ["lapped Ra 0.2 um", "ground Ra 0.4 um"]},
    )
    heights = [height(alone.case_of([number])) for number in (0.0, 1.0)]
    assert alone.values([1.0]) == {"roughness": "ground Ra 0.4 um"}
    assert heights[0] < heights[1]


@pytest.mark.slow
def test_a_finish_whose_usual_surface_is_sealed_has_an_interval_all_the_same(base):
    """No ratio to a leak rate of zero: rougher surfaces of the process let something through."""
    sealed = base.replace_written(
        {
            "roughness": {"Ra": "0.01 um", "process": "lapped"},
            "load.fluid_pressure": "300 bar",
            "uncertainty.samples": 16,
        }
    )
    result = fem_seal.run(sealed)
    (load,) = result.loads
    assert load.leak.leak_rate == 0.0
    low, high = result.leak_ranges[0]
    assert low == 0.0 < high


# -------------------------------------------------------------------- a range of the value

RANGE = {"Ra": "0.2 um to 0.4 um", "process": "lapped"}


def test_a_range_is_read_in_words_as_a_key_and_as_a_list(base):
    words = base.replace_written({"roughness": "lapped Ra 0.2 to 0.4 um"})
    key = base.replace_written({"roughness": RANGE})
    in_code = base.replace({"roughness.Ra": (0.2e-6, 0.4e-6), "roughness.process": "lapped"})
    assert words.roughness.parts == key.roughness.parts == in_code.roughness.parts
    assert key.roughness.Ra == (0.2e-6, 0.4e-6)
    assert read_finish("Rz 1.6um to 3.2um") == {"kind": "finish", "Rz": "1.6 um to 3.2 um"}
    # the usual surface has the geometric mean, and is that of this value alone
    usual = base.replace_written({"roughness": LAPPED}).replace({"roughness.Ra": np.sqrt(0.08) * 1e-6})
    assert height(key) == pytest.approx(height(usual), rel=1e-12)
    assert finish_rows(key)[0][1] == "lapped, Ra 0.2 µm to 0.4 µm (usual: 0.283 µm)"
    # a study sets single values
    assert key.replace_written({"roughness.Ra": "0.3 um"}).roughness.Ra == 0.3e-6


@pytest.mark.parametrize(
    ("value", "says"),
    [
        (
            "0.4 um to 0.2 um",
            r'no range from a value to a larger one \("0.4 um" to "0.2 um"\); write it as "0.2 um to',
        ),
        ("0.2 um to 0.2 um", "no range from a value to a larger one.*or write one value"),
        ("0.2 um to 40 um", r'spans more than a factor of 20 \("0.2 um" to "40 um"\); check the units'),
        ("0.2 to 0.4", "write a length with its unit"),
        ("0.2 um to 0.4 bar", 'entry 2, "0.4 bar", unit "bar" does not fit'),
        (["0.2 um", "0.3 um", "0.4 um"], 'is no range.*write it as "0.2 um to 0.4 um"'),
    ],
)
def test_a_range_that_is_none_is_named_with_its_key_and_a_remedy(base, value, says):
    with pytest.raises(fem_seal.InputError, match=rf"roughness.seat.Ra.*{says}"):
        base.replace_written({"roughness": {"seat": {"Ra": value}}})


@pytest.mark.slow
def test_sampled_heights_have_the_quantiles_of_their_closed_form(base):
    """ln Ra is even between both ends; the ratio Rq/Ra of real surfaces stands on top."""
    case = base.replace_written({"roughness": {"seat": RANGE}})
    finish = case.roughness.seat.finish
    sampled = (np.arange(400) + 0.5) / 400
    heights = [case.roughness.combine(shares={"Ra": one})[0].rms_height for one in sampled]
    shares = np.array([0.05, 0.25, 0.5, 0.75, 0.95])
    ratio = height(case) / np.sqrt(0.08)
    assert np.quantile(heights, shares) == pytest.approx(ratio * 0.2 * 2.0**shares, rel=1e-3)
    # both together: the closed form of the even one, integrated over the other
    ratios = finish.spreads["rms_height"]
    places = sobol_points(2**11, 2, 1)
    both = [
        case.roughness.combine(shares={"Ra": a, "rms_height": b})[0].rms_height for a, b in places.tolist()
    ]
    x = np.quantile(both, shares) / ratio
    below = np.log(x[:, None] / (0.2 * ratios.at(sampled))) / np.log(2.0)
    assert np.clip(below, 0.0, 1.0).mean(axis=1) == pytest.approx(shares, abs=2e-3)


@pytest.mark.slow
def test_samples_at_both_ends_are_those_of_the_single_values_and_bracket_the_interval(base):
    seals = {}
    for name, entries in {"range": RANGE, "low": LAPPED, "high": {**LAPPED, "Ra": "0.4 um"}}.items():
        case = base.replace_written({"roughness": {"seat": entries}})
        evaluations = [evaluate(SealProblem.of(case))]
        seals[name] = SolvedSeal.of(evaluations, case, loads_of(evaluations))
    found = {name: leak_interval(seal) for name, seal in seals.items()}
    assert found["range"].inputs == ("Ra", *found["low"].inputs)
    for end in ("low", "median", "high"):
        low, between, high = (getattr(found[name], end)[0] for name in ("low", "range", "high"))
        assert low < between < high
    narrow, wide = (np.log(found[name].high[0] / found[name].low[0]) for name in ("low", "range"))
    assert wide > narrow
    assert 0.02 < found["range"].shares[0, 0] < 0.9
    others = np.array([[0.3, 0.6, 0.4, 0.7]])
    for place, name in ((0.0, "low"), (1.0, "high")):
        one = Samples.of(seals[name], Uncertainty())
        at_end = Samples.of(seals["range"], Uncertainty())
        told = replace(one, uniform=others).leak_rates([0])
        uniform = np.column_stack([[place], others])
        assert replace(at_end, uniform=uniform, known_rates={}).leak_rates([0]) == pytest.approx(
            told, rel=2e-3
        )
