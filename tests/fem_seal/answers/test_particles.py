"""Particles in the fluid of a case: the table, the answers, and where they are told."""

from __future__ import annotations

import csv
import json
import math
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from sample_results import SPECTRUM, case

import fem_seal
import leak
from fem_seal import InputError
from fem_seal.answers.particles import KEPT_SHARE, particle_answers
from fem_seal.cli.app import main
from fem_seal.output.answers.particles import OUTPUT, particle_table
from fem_seal.output.report.page import report
from fem_seal.result import SealResult
from fem_seal.seal.findings import Level, Validity, remark
from leak import Reading

DIRTY: dict[str, Any] = {"iso_4406": "15/13/10"}


def dirty_case(particles: dict[str, Any] = DIRTY, **tables: Any) -> fem_seal.Case:
    return case(**{"fluid": {"name": "water", "particles": particles}, **tables})


@cache
def result() -> SealResult:
    return fem_seal.run(dirty_case(load={"fluid_pressure": ["5 bar", "20 bar"]}))


def details_of(found: SealResult) -> list[str]:
    """What the terminal says of the particles."""
    return list(OUTPUT.page_of(found, found.case.display).details)


# ---------------------------------------------------------------- the table


def test_a_code_or_counts_say_how_many_particles_there_are():
    assert dirty_case().fluid.particles.counts == leak.ParticleCounts.of_iso_4406("15/13/10")
    counted = {"sizes": ["2 um", "10 um"], "per_ml": [5000, 100.0], "filter": "3 um"}
    found = dirty_case(counted).fluid.particles.counts
    assert found == leak.ParticleCounts.of_counts([2e-6, 10e-6], [5e9, 1e8], 3e-6)


@pytest.mark.parametrize(
    ("particles", "says"),
    [
        ({}, "either iso_4406, or sizes"),
        ({"filter": "3 um"}, "either iso_4406, or sizes"),
        ({"iso_4406": "15/13/10", "sizes": ["1 um", "2 um"], "per_ml": [2, 1]}, "either iso_4406, or sizes"),
        ({"iso_4406": "15/13/10", "per_ml": [2, 1]}, "go together"),
        ({"sizes": ["1 um", "2 um"]}, "go together"),
        ({"sizes": ["1 um", "2 um"], "per_ml": [1]}, "needs as many"),
        ({"sizes": ["2 um", "1 um"], "per_ml": [2, 1]}, "increase"),
        ({"sizes": ["1 um", "2 um"], "per_ml": [1, 2]}, "rise"),
        ({"sizes": "1 um", "per_ml": [1]}, "at least 2"),
        ({"iso_4406": "15/18/10"}, "exceed"),
        ({"iso_4406": "15/13/10", "filter": "3"}, "has no unit"),
        ({"iso_4406": "15/13/10", "filters": "3 um"}, "unknown key"),
    ],
)
def test_a_wrong_table_is_refused(particles, says):
    with pytest.raises(InputError, match=says) as error:
        dirty_case(particles)
    assert all(one.key.startswith("fluid.particles") for one in error.value.problems)


def test_particles_need_rough_surfaces_and_a_code_a_liquid():
    with pytest.raises(InputError, match=r"without \[roughness\]"):
        dirty_case(roughness=None, interface={"law": "smooth"}, leak={"plasticity": False})
    with pytest.raises(InputError, match=r"helium.* is a gas"):
        case(fluid={"name": "helium", "particles": DIRTY})
    case(fluid={"name": "helium", "particles": {"sizes": ["1 um", "5 um"], "per_ml": [0.1, 0.001]}})


# ---------------------------------------------------------------- the answers


@pytest.mark.slow
def test_a_clean_fluid_asks_nothing():
    clean = result().case.replace({"fluid.particles": None, "load.fluid_pressure": "20 bar"})
    found = fem_seal.run(clean)
    assert found.particles == ()
    assert details_of(found) == [] and particle_table(found).rows == ()
    # the leak rate is that of the clean fluid either way
    assert found.loads[-1].leak.leak_rate == pytest.approx(result().loads[-1].leak.leak_rate, rel=1e-6)


def test_the_curve_falls_from_the_whole_leak_to_none():
    for answers, load in zip(result().particles, result().loads, strict=True):
        assert (answers.fluid_pressure, answers.applied_force) == load.point
        assert answers.leak_rate == load.leak_range
        rates = np.array([one.leak_rate for one in answers.curve])
        assert rates[0] == pytest.approx(answers.leak_rate, rel=1e-3) and rates[-1].tolist() == [0.0, 0.0]
        assert np.all(np.diff(rates, axis=0) <= 0) and np.all(rates[:, 0] <= rates[:, 1])
        left = np.array([one.remaining for one in answers.curve])
        assert np.all(np.diff(left, axis=0) <= 0) and left[0] == pytest.approx([1.0, 1.0], abs=1e-3)
        assert np.all(np.diff([one.gaps_below for one in answers.curve], axis=0) > 0)
        assert np.all(np.diff([one.particles for one in answers.curve], axis=0) < 0)
        # of each reading the first size that lets nothing through lies beyond the narrowest place, not the one before
        narrowest = [one.critical_separation for one in (load, *load.others.values())]
        assert answers.narrowest[0] < narrowest[0] < narrowest[1] == answers.narrowest[1]
        for end in (0, 1):
            sealed = next(one.size for one in answers.curve if one.leak_rate[end] == 0.0)
            last_open = [one.size for one in answers.curve if one.leak_rate[end] > 0.0][-1]
            # the critical junction is the other reading of the same place, some 15 per cent wider
            assert last_open < narrowest[end] < 1.3 * sealed


def test_the_leak_that_is_left_is_that_of_the_shut_conductivity():
    answers = result().particles[-1]
    for end, load in enumerate((result().loads[-1], result().loads[-1].scenarios[Reading.CAPPED])):
        profile, table = load.contact.profile, load.rough.table
        for one in answers.curve[3::4]:
            shut = leak.shut_conductivity(table, load.rough.surface, one.size)
            fluid = result().case.fluid
            rate = leak.leak_flow(
                profile.x,
                profile.pressure,
                shut.at(fluid.viscosity),
                20e5,
                profile.radius,
                pressure_law=fluid.pressure_law,
            ).leak_rate
            # the tails of the profile end where the faces do, which leaks some millionths less
            assert one.leak_rate[end] == pytest.approx(rate, rel=1e-4)


def test_the_filter_that_keeps_the_leak_keeps_it():
    for answers, both in zip(result().particles, result().loads, strict=True):
        for size, load in zip(
            answers.keeping_filter,
            (both, *both.others.values()),
            strict=True,
        ):
            shut = leak.shut_conductivity(load.rough.table, load.rough.surface, size)
            rough, profile = load.rough, load.contact.profile
            left = rough.flow.leak_of(shut, rough.surface, profile, load.fluid_pressure).leak_rate
            # interpolated between sizes a fifth apart
            assert left / load.leak.leak_rate == pytest.approx(KEPT_SHARE, abs=3e-3)


def test_without_yielding_there_is_one_reading():
    elastic = [load.scenarios[Reading.ELASTIC] for load in result().loads[-1:]]
    (answers,) = particle_answers(elastic, leak.ParticleCounts.of_iso_4406("15/13/10"))
    assert answers.keeping_filter[0] == answers.keeping_filter[1]
    assert answers.leak_rate == (elastic[0].leak.leak_rate,) * 2
    assert all(one.remaining[0] == one.remaining[1] for one in answers.curve)


def test_a_filter_leaves_what_its_particles_cannot_shut():
    counts = leak.ParticleCounts.of_iso_4406("15/13/10", largest=2e-6)
    unfiltered = result().particles[-1]
    (filtered,) = particle_answers(result().loads[-1:], counts)
    shut = np.array([one.remaining for one in unfiltered.curve]).T
    sizes = [one.size for one in unfiltered.curve]
    assert filtered.left == pytest.approx([np.interp(2e-6, sizes, one) for one in shut], abs=0.06)
    assert filtered.filter == 2e-6 and unfiltered.filter is unfiltered.left is None
    # so much is left that half of it is never gone
    assert filtered.left[0] > 0.5 and filtered.half_volume == filtered.half_time == (math.inf, math.inf)
    assert filtered.stopped[0] < unfiltered.stopped[0] and filtered.stopped[1] < unfiltered.stopped[1]
    assert filtered.curve[-1].particles == (0.0, 0.0)
    assert filtered.keeping_filter == unfiltered.keeping_filter


def test_a_power_more_of_particles_clogs_a_power_faster():
    # scale numbers ten higher are 1000 times as many particles, give or take the standard's rounding
    (few,), (many,) = (
        particle_answers(result().loads[-1:], leak.ParticleCounts.of_iso_4406(code))
        for code in ("15/13/10", "25/23/20")
    )
    for name in ("half_volume", "half_time"):
        assert np.divide(getattr(few, name), getattr(many, name)) == pytest.approx([1000, 1000], rel=0.1)
    assert many.places == few.places


def test_places_side_by_side_are_squares_at_least_and_particles_at_most():
    load = result().loads[-1]
    (answers,) = particle_answers(
        [load.scenarios[Reading.ELASTIC]], leak.ParticleCounts.of_iso_4406("15/13/10")
    )
    around = 2 * math.pi * load.contact.model.initial_contact_radius
    width = around / answers.places[0]
    # of the order of the contact's own width
    assert 0.5 * load.contact.profile.fwhm < width < 2 * load.contact.profile.fwhm
    assert around / answers.places[1] == pytest.approx(answers.narrowest[0], rel=1e-9)
    least, most = answers.half_volume
    assert least == pytest.approx(math.log(2) * answers.places[0] / answers.stopped[1])
    assert most == pytest.approx(math.log(2) * answers.places[1] / answers.stopped[0])
    # V = int Q dt: while the leak halves its mean lies between the whole and half of it
    for volume, time in zip(answers.half_volume, answers.half_time, strict=True):
        assert 0.5 < volume / (time * answers.leak_rate[0]) < 1.0


def test_a_sealed_load_has_no_answers():
    load = replace(result().loads[0], rough=None, scenarios={})
    assert particle_answers([load], leak.ParticleCounts.of_iso_4406("15/13/10")) == ()


# ---------------------------------------------------------------- where they are told


@pytest.mark.usefixtures("unrendered")
def test_it_is_said_as_an_estimate():
    told = details_of(result())
    assert told[0].startswith("Estimate: at 20 bar")
    assert any("order of magnitude" in one for one in told)
    assert any("extrapolation" in one for one in told)
    assert "not included" in told[-1]
    page = report(result(), full=True).replace("\xa0", " ")
    assert 'id="particles"' in page and 'id="picture-particles"' in page
    assert all(one.replace("'", "&#39;") in page for one in told)
    assert "ISO 4406" in page and "15/13/10" in page


def test_nothing_is_said_of_a_load_outside_the_theory():
    caution = remark("yield stress", Level.OUTSIDE, "seat: 3 times its yield stress")
    outside = replace(result().loads[-1], validity=Validity.of([caution]))
    assert details_of(replace(result(), loads=(result().loads[0], outside))) == []


def test_with_a_filter_that_stops_all_nothing_is_said_to_clog():
    counts = leak.ParticleCounts.of_counts([1e-6, 2e-6], [1e9, 1e8], largest=1e-8)
    table = {"sizes": ["1 um", "2 um"], "per_ml": [1000, 100], "filter": "10 nm"}
    changed = replace(
        result().with_answers(particles=particle_answers(result().loads, counts)),
        case=result().case.replace({"fluid.particles": None}).replace({"fluid.particles": table}),
    )
    told = " ".join(details_of(changed))
    assert (
        "All particles that pass the filter also pass the contact" in told and "half of the leak" not in told
    )


@pytest.mark.usefixtures("unrendered")
def test_a_seal_far_narrower_than_what_was_counted_gets_no_number():
    counts = leak.ParticleCounts.of_counts([50e-6, 200e-6], [1e9, 1e8])
    table = {"sizes": ["50 um", "200 um"], "per_ml": [1000, 100]}
    changed = replace(
        result().with_answers(particles=particle_answers(result().loads, counts)),
        case=result().case.replace({"fluid.particles": None}).replace({"fluid.particles": table}),
    )
    answers = changed.particles[-1]
    assert np.isnan([*answers.stopped, *answers.half_volume, *answers.half_time]).all()
    # what needs no counts is still said
    assert answers.keeping_filter == result().particles[-1].keeping_filter
    told = " ".join(details_of(changed))
    assert "is not known" in told and "half of the leak" not in told and "1.5 µm" in told
    assert particle_table(changed).rows[0][1] == "–"
    assert report(changed, full=True)


@pytest.mark.slow
@pytest.mark.usefixtures("unrendered")
def test_files_have_what_the_answers_say(tmp_path):
    result().write(tmp_path)
    with (tmp_path / "particles.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == sum(len(answers.curve) for answers in result().particles)
    last = result().particles[-1].curve[-1]
    assert float(rows[-1]["size_m"]) == last.size
    assert float(rows[-1]["particles_high_per_m3"]) == pytest.approx(last.particles[1], rel=1e-9)
    told = json.loads((tmp_path / "summary.json").read_text())["particles"]
    assert len(told) == 2 and tuple(told[-1]["keeping_filter"]) == result().particles[-1].keeping_filter
    # a run without particles into the same folder leaves none behind
    result().with_answers(particles=()).write(tmp_path)
    assert not (tmp_path / "particles.csv").exists()


@pytest.mark.slow
def test_the_terminal_tells_it(tmp_path, capsys):
    file = tmp_path / "case.toml"
    file.write_text(
        'title = "t"\n[closure]\nshape = "ball"\nradius = "20 mm"\nmaterial = "steel"\n'
        '[seat]\nshape = "cone"\nangle = "45 deg"\nmaterial = { youngs_modulus = "210 GPa", poissons_ratio = 0.3 }\n'
        "[roughness]\nspectrum = {"
        + ", ".join(f"{key} = {json.dumps(value)}" for key, value in SPECTRUM.items())
        + '}\n[leak]\nplasticity = false\n[fluid]\nname = "water"\n'
        '[fluid.particles]\niso_4406 = "15/13/10"\n[load]\nfluid_pressure = "20 bar"\n'
    )
    assert main(["run", "--details", str(file)]) == 0
    assert "Estimate: at 20 bar" in capsys.readouterr().out
