"""A case with a face as the tool leaves it: what is read, refused and calculated."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from places import EXAMPLES

import fem_seal
import leak
from fem_seal.answers.sensitivities import sensitivities
from fem_seal.output.answers.sensitivities import step_in_words
from fem_seal.output.case_words import crest_rows
from fem_seal.output.columns import COLUMNS, columns_of
from fem_seal.output.sources import sources
from fem_seal.seal.findings import Level
from fem_seal.seal.problem import rough_contact
from fem_seal.validity.turned import acting_pressure, crest_places

FINE = {"rms_height": "0.1 um", "hurst": 0.8, "q_rolloff": "2.5e5 1/m", "q_high": "4e6 1/m"}
TURNED = {"process": "turned", "feed": "0.1 mm", "nose_radius": "0.8 mm", "fine": FINE}


def case_of(roughness: dict[str, Any], **changes: Any) -> fem_seal.Case:
    base = fem_seal.load_case(EXAMPLES / "ball_cone.toml")
    load = {"load.fluid_pressure": "20 bar", "load.applied_force": "2 kN", "leak.theory": "corrected"}
    return base.replace({"roughness": roughness, **load, **changes})


@cache
def solved() -> fem_seal.SealResult:
    """Many crests in a wide contact of a soft metal, in rings."""
    face = {**TURNED, "feed": "0.05 mm", "nose_radius": "0.4 mm", "spiral": False}
    return fem_seal.run(case_of({"seat": face}, **{"closure.radius": "200 mm"}), sensitivities=False)


def test_keys_become_the_face_of_the_library():
    surface = rough_contact(case_of({"seat": TURNED}))
    assert isinstance(surface, leak.TurnedContact)
    assert (surface.feed, surface.nose_radius) == pytest.approx((1e-4, 8e-4))
    assert surface.hardness == pytest.approx(3.5e9)
    # waves up to two feeds, and the groove is one thread through the circle of first touch
    assert surface.fine.q_low == pytest.approx(math.pi / 1e-4)
    assert surface.fine.rms_height == pytest.approx(1e-7)
    assert surface.thread_radius == pytest.approx(20e-3 * math.sin(math.radians(45.0)))
    rings = rough_contact(case_of({"seat": {**TURNED, "spiral": False}}))
    assert isinstance(rings, leak.TurnedContact) and math.isinf(rings.thread_radius)


def test_the_other_face_joins_the_fine_roughness():
    alone, both = (
        rough_contact(case_of({"seat": TURNED, **other})) for other in ({}, {"closure": "lapped Ra 0.1 um"})
    )
    closure = fem_seal.load_case(EXAMPLES / "ball_cone.toml").replace(
        {"roughness": {"closure": "lapped Ra 0.1 um"}, "leak.theory": "corrected"}
    )
    lapped = rough_contact(closure)
    assert alone is not None and both is not None and lapped is not None
    heights = math.hypot(alone.spectrum.rms_height, lapped.spectrum.rms_height)
    assert both.spectrum.rms_height == pytest.approx(heights, rel=1e-6)


def test_fine_roughness_may_be_a_finish():
    surface = rough_contact(case_of({"seat": {**TURNED, "fine": "ground Ra 0.1 um"}}))
    assert isinstance(surface, leak.TurnedContact) and 1e-7 < surface.fine.rms_height < 2e-7


@pytest.mark.parametrize(
    ("roughness", "changes", "reason"),
    [
        ({"seat": {**TURNED, "hurst": 0.8}}, {}, "hurst, which describes a random surface"),
        ({"seat": {**TURNED, "lay": "circular"}}, {}, "in a table fine"),
        ({"seat": TURNED, "peklenik": 0.2}, {}, "peklenik"),
        (TURNED | {"seat": TURNED}, {}, "has feed, the finish of each face, and seat"),
        ({"along": TURNED, "across": TURNED}, {}, "along or across the flow"),
        ({**TURNED, "process": "lapped"}, {}, "has feed, which belongs to turned faces, beside lapped"),
        ({key: TURNED[key] for key in ("process", "feed", "fine")}, {}, "nose_radius is missing; add"),
        ({**TURNED, "q_high": "1e7 1/m"}, {}, "q_high, which describes a random surface"),
        ({"seat": {**TURNED, "fine": "turned Ra 0.1 um"}}, {}, "a turned finish in fine"),
        ({"seat": {**TURNED, "feed": "1 mm"}}, {}, "nose radius"),
        ({"seat": {**TURNED, "feed": 0.1}}, {}, "feed"),
        ({"seat": {key: TURNED[key] for key in ("process", "feed", "nose_radius")}}, {}, "fine"),
        ({"seat": {**TURNED, "fine": "shiny"}}, {}, 'fine, "shiny", is no finish'),
        ({"seat": TURNED}, {"leak.theory": "paper"}, "leak.theory"),
        ({"seat": TURNED}, {"leak.conductivity": "direct"}, "leak.conductivity"),
        (
            {"seat": TURNED},
            {"form": {"lay": {"pitch": "0.1 mm", "depth": "1 um"}}},
            "thread between the crests",
        ),
        ({"seat": TURNED}, {"interface.law": "exponential"}, "u0 nor p_c"),
    ],
)
def test_what_does_not_fit_is_refused(roughness, changes, reason):
    with pytest.raises(fem_seal.InputError, match=reason):
        case_of(roughness, **changes)


def test_a_drawing_becomes_crests_with_the_feed_of_its_ra():
    surface = rough_contact(case_of({"seat": "turned Ra 0.4 um"}))
    assert isinstance(surface, leak.TurnedContact)
    assert surface.texture.Ra == pytest.approx(0.4e-6, rel=0.01)
    assert surface.nose_radius == pytest.approx(0.8e-3)
    assert surface.feed == pytest.approx(math.sqrt(8.0 * 0.8e-3 * surface.texture.crest_height))
    assert math.isfinite(surface.thread_radius)
    # what stands beside it, and the other face on its crests
    known = {"Ra": "0.4 um", "process": "turned", "nose_radius": "0.4 mm", "spiral": False}
    told = rough_contact(case_of({"seat": known, "closure": "lapped Ra 0.1 um"}))
    assert isinstance(told, leak.TurnedContact) and math.isinf(told.thread_radius)
    assert told.nose_radius == pytest.approx(0.4e-3)
    assert told.fine.rms_height > 1.1 * surface.fine.rms_height


def test_two_turned_faces_are_two_combs():
    from fem_seal.answers.samples import changed_surface, uncertain_inputs

    each = rough_contact(case_of(TURNED))
    pair = rough_contact(case_of({"seat": TURNED, "closure": TURNED}))
    one = rough_contact(case_of({"seat": TURNED}))
    assert isinstance(each, leak.TurnedContact) and each == pair and isinstance(one, leak.TurnedContact)
    assert each.other == leak.Cusps(1e-4, 8e-4) and one.other is None
    assert each.fine.rms_height == pytest.approx(math.sqrt(2.0) * one.fine.rms_height)
    # on a drawing, too, and where the crests of one lie between those of the other is not known
    unlike = case_of({"seat": "turned Ra 0.4 um", "closure": {**TURNED, "feed": "0.13 mm"}})
    surface = rough_contact(unlike)
    assert isinstance(surface, leak.TurnedContact) and unlike.sampling is not None
    assert surface.other is not None
    assert sorted([surface.feed, surface.other.feed]) == pytest.approx([99.1e-6, 1.3e-4], rel=1e-3)
    assert [one.name for one in uncertain_inputs(unlike, unlike.sampling)][-1] == "phase"
    phases = [changed_surface(unlike, surface, {}, shares={"phase": place}) for place in (0.0, 0.5, 1.0)]
    assert [one.phase for one in phases if isinstance(one, leak.TurnedContact)] == [0.0, 0.25, 0.5]
    assert surface.phase == 0.25
    given = case_of({"seat": TURNED, "closure": TURNED})
    assert given.sampling is not None
    assert [one.name for one in uncertain_inputs(given, given.sampling)] == ["phase"]


@pytest.mark.parametrize(
    ("roughness", "reason"),
    [
        (
            {"Ra": "0.4 um", "process": "turned", "lay": "circular"},
            "has lay, which describes a random surface",
        ),
        ({"Ra": "0.4 um", "process": "turned", "peklenik": 0.2}, "has peklenik"),
        ({"seat": "turned Ra 0.4 um", "peklenik": 0.2}, "has peklenik"),
        ({"Ra": "0.4 um", "process": "turned", "q_low": "1e4 1/m"}, "has q_low"),
        ({"Ra": "0.4 um", "process": "lapped", "nose_radius": "0.8 mm"}, 'process = "turned"'),
        ({"Ra": "0.4 um", "spiral": False}, "has spiral, which belongs to turned faces, beside unspecified"),
        (
            {"seat": {"Ra": "0.8 um", "process": "turned", "lambda_c": "0.08 mm"}},
            "lambda_c.*are not measured with such a filter",
        ),
    ],
)
def test_what_no_turned_drawing_says_is_refused(roughness, reason):
    with pytest.raises(fem_seal.InputError, match=reason):
        case_of(roughness)


def test_what_a_turned_drawing_leaves_open():
    from fem_seal.answers.samples import changed_surface, uncertain_inputs

    case = case_of({"seat": {"Ra": "0.2 um to 0.8 um", "process": "turned", "hurst": 0.8}})
    assert case.sampling is not None
    names = [one.name for one in uncertain_inputs(case, case.sampling)]
    assert names == ["Ra", "q_rolloff", "q_high", "nose_radius", "fine_height"]
    known = case.replace({"roughness.seat.nose_radius": "0.4 mm"})
    assert "nose_radius" not in [one.name for one in uncertain_inputs(known, case.sampling)]
    surface = rough_contact(case)
    assert surface is not None
    rough = changed_surface(case, surface, {}, shares={"nose_radius": 1.0, "fine_height": 1.0, "Ra": 1.0})
    assert isinstance(rough, leak.TurnedContact)
    assert rough.nose_radius == pytest.approx(1.6e-3) and rough.texture.Ra == pytest.approx(0.8e-6, rel=0.02)
    ratio = rough.fine.rms_height / rough.texture.crest_height
    # as measured, without its shortest waves
    assert 0.2 < ratio < 0.21
    # a factor on all heights is one on the cusps, too
    higher = changed_surface(case, surface, {"rms_height": 1.1})
    assert isinstance(higher, leak.TurnedContact) and isinstance(surface, leak.TurnedContact)
    assert higher.texture.Ra == pytest.approx(1.1 * surface.texture.Ra)
    assert higher.feed == surface.feed


def test_check_says_what_a_turned_drawing_becomes():
    from fem_seal.output.case_words import finish_numbers, finish_rows

    case = case_of({"seat": "turned Ra 0.4 um"})
    rows = dict(finish_rows(case))
    assert rows["finish of seat"] == "turned, Ra 0.4 µm"
    assert rows["  crests"].startswith("feed 99.1 µm, 1.53 µm high") and rows["  crests"].endswith(
        "one thread"
    )
    assert rows["  nose radius"] == "0.800 mm (assumed; 0.2 mm to 1.6 mm)"
    assert "times the height of the crests (assumed; 0.03 to 0.2)" in rows["  fine roughness"]
    assert finish_numbers(case)["seat"]["feed_m"] == pytest.approx(99.1e-6, rel=1e-3)


def test_leak_rate_is_that_of_crests_in_series():
    """Resistance of each crest on the profile, f/sigma(p) over its circle, on average over the place of the first."""
    (load,) = solved().loads
    surface, (profile,) = solved().surface, load.profiles
    assert isinstance(surface, leak.TurnedContact) and load.leak is not None
    totals = []
    for phase in np.arange(40) / 40.0:
        x = np.arange(profile.x[0] + phase * surface.feed, profile.x[-1], surface.feed)
        p, radius = np.interp(x, profile.x, profile.pressure), np.interp(x, profile.x, profile.radius)
        sigma = surface.flow_conductivity(np.maximum(p, 1.0), 1.0016e-3)
        totals.append(np.sum(surface.feed / (2.0 * math.pi * radius * sigma)))
    assert load.leak.leak_rate == pytest.approx(load.fluid_pressure / np.mean(totals), rel=0.02)
    places = crest_places(surface, load)
    assert places.low == pytest.approx(np.mean(totals) / np.max(totals), rel=0.05)
    assert places.high == pytest.approx(np.mean(totals) / np.min(totals), rel=0.05)


def test_bounds_of_crests_of_two_faces_are_those_of_their_pattern():
    """Equal faces half a feed apart are one of half the feed; of unlike ones the highest crests lie far apart."""
    (load,) = solved().loads
    of_one = solved().surface
    assert isinstance(of_one, leak.TurnedContact)
    r = of_one.nose_radius
    other = leak.Cusps(2.0 * of_one.feed, 2.0 * r)
    halves = replace(of_one, feed=other.feed, nose_radius=other.nose_radius, other=other, phase=0.5)
    one, pair = crest_places(of_one, load), crest_places(halves, load)
    assert halves.crest_places == pytest.approx([0.0, of_one.feed])
    assert (pair.low, pair.high) == pytest.approx((one.low, one.high), rel=0.02)
    unlike = crest_places(replace(of_one, other=leak.Cusps(0.75 * of_one.feed, r)), load)
    assert unlike.low < one.low < 1.0 < one.high < unlike.high


def test_the_interval_has_the_error_of_the_theory():
    (load,) = solved().loads
    assert load.flow_error is not None and load.leak is not None
    assert load.leak_interval is not None
    low, high = load.leak_interval.low, load.leak_interval.high
    assert low < load.leak.leak_rate < high
    assert high / low > float(load.flow_error.factor(0.95) / load.flow_error.factor(0.05)) * 0.99


def test_report_tells_the_face_and_its_theory(tmp_path):
    from fem_seal.output.case_words import finish_rows

    rows = dict(finish_rows(solved().case))
    assert rows["finish of seat"].startswith("turned, feed 50 µm, nose radius 0.4 mm")
    text = solved().write(tmp_path).joinpath("report.html").read_text(encoding="utf-8")
    assert "of turned faces: crests in series" in text and "p(u) of the turned face" in text
    assert "turned, feed" in text and "Bruggeman" not in text


def test_thread_leaks_beside_the_crests():
    (load,) = solved().loads
    case = solved().case.replace({"roughness.seat.spiral": True})
    result = fem_seal.run(case, sensitivities=False)
    thread = result.loads[0]
    assert load.leak is not None and thread.leak is not None
    assert thread.leak.leak_rate > load.leak.leak_rate
    # across the crests it is the same, and of rings there is no other way
    crests = COLUMNS["leak_rate_crests_m3_per_s"]
    assert crests.number(thread) == pytest.approx(load.leak.leak_rate, rel=1e-6)
    assert crests in columns_of(case) and crests not in columns_of(solved().case)


@pytest.mark.slow
def test_sensitivities_are_those_of_faces_with_another_feed_and_nose():
    case = solved().case
    levers = {one.key: one for one in sensitivities(solved())}
    feed, nose = levers["roughness.seat.feed"], levers["roughness.seat.nose_radius"]
    (load,) = solved().loads
    assert load.leak is not None
    changed = fem_seal.run(case.replace({nose.key: nose.after}), sensitivities=False).loads[0]
    assert changed.leak is not None
    assert nose.ratio[0] == pytest.approx(changed.leak.leak_rate / load.leak.leak_rate, rel=0.05)
    # fewer and higher crests carry more each
    assert (
        feed.drawn and nose.drawn and feed.after == pytest.approx(2.0 * feed.before) and feed.ratio[0] < 0.5
    )
    assert step_in_words(case, feed) == "doubling the feed of the seat"
    assert "fine roughness on the crests" in step_in_words(case, levers["rms_height"])
    assert not levers["roughness.seat.fine.hurst"].drawn
    assert "Hurst exponent of 0.88" in step_in_words(case, levers["roughness.seat.fine.hurst"])


def test_check_tells_crests_and_thread_in_the_contact():
    case = solved().case.replace({"roughness.seat.spiral": True})
    forms, surface = fem_seal.derive(case), rough_contact(case)
    rows = dict(crest_rows(case.display, surface, forms, leaks=True))
    crests = forms.loads[0].crossover.fwhm / 5e-5
    assert rows["  in the contact"] == f"{crests:.0f} crests across the width at half maximum"
    assert rows["  through the thread"].endswith("of the conductivity at the peak pressure")
    rings = rough_contact(solved().case)
    assert "  through the thread" not in dict(crest_rows(case.display, rings, forms, leaks=True))
    assert crest_rows(case.display, None, forms, leaks=True) == []


def test_few_crests_are_told():
    (load,) = fem_seal.run(case_of({"seat": {**TURNED, "spiral": False}}), sensitivities=False).loads
    found = [finding.entry for finding in load.validity.cautions]
    assert "few_crests" in found and load.validity.level is not Level.VALID


def test_nearly_sealed_crests_have_a_lower_and_an_upper_end():
    surface = replace(solved().surface, hardness=1e9)
    assert 0.0 < surface.nearly_sealed_pressure < surface.sealing_pressure
    sigma = surface.flow_conductivity(surface.nearly_sealed_pressure, 1.0)
    assert sigma < 1e-2 * surface.flow_conductivity(5e-3 * surface.contact_pressure, 1.0)


@cache
def unloaded() -> fem_seal.SealResult:
    """The same seat, once closed three times as hard."""
    force = 3.2 * solved().loads[0].contact_force
    case = solved().case.replace({"load.largest_earlier_force": f"{force:.6g} N"})
    return fem_seal.run(case, sensitivities=False)


def test_leaks_less_after_a_larger_load_by_its_flats():
    (first,), (load,) = solved().loads, unloaded().loads
    surface, (profile,) = unloaded().surface, load.profiles
    assert isinstance(surface, leak.TurnedContact) and load.leak is not None and first.leak is not None
    assert load.remembers and profile.largest is not None
    assert load.leak.leak_rate < 0.8 * first.leak.leak_rate
    fresh = load.scenarios["first loading"]
    assert fresh.leak is not None
    assert fresh.leak.leak_rate == pytest.approx(first.leak.leak_rate, rel=0.01)
    # resistances f/sigma(p, p_max) over the circle of each crest, as many as lie in the contact
    x = np.linspace(profile.x[0], profile.x[-1], 4001)
    rest = profile.at_rest(surface)
    p, most, radius = (np.interp(x, rest.x, of) for of in (rest.pressure, rest.largest, rest.radius))
    sigma = np.asarray(surface.flow_conductivity(np.maximum(p, 1.0), 1.0016e-3, largest=most))
    resistance = np.trapezoid(1.0 / (2.0 * math.pi * radius * sigma), x)
    assert load.leak.leak_rate == pytest.approx(load.fluid_pressure / resistance, rel=0.03)


def test_error_cautions_and_sources_know_the_earlier_load():
    (first,), (load,) = solved().loads, unloaded().loads
    surface = unloaded().surface
    assert isinstance(surface, leak.TurnedContact)
    assert load.flow_error is not None and first.flow_error is not None
    assert float(load.flow_error.spread) >= float(first.flow_error.spread)
    acts = acting_pressure(surface, load)
    assert load.peak_pressure < acts < load.tightest.highest
    assert acts > surface.nearly_sealed_pressure > load.peak_pressure
    (nearly,) = [finding for finding in load.validity.cautions if finding.entry == "crests_nearly_sealed"]
    assert "after a larger load as tight as" in nearly.reason()
    used = {source.name: source.used_for for source in sources(unloaded())}
    assert "flats that a larger load before" in used["turned faces"] and "load memory" not in used


def test_an_earlier_fluid_pressure_is_remembered_as_well():
    load = {"fluid_pressure": ["5 bar", "20 bar"], "largest_earlier_pressure": "20 bar"}
    case = solved().case.replace({"load": load})
    low, high = fem_seal.run(case, sensitivities=False).loads
    for one in (low, high):
        assert one.leak is not None and one.scenarios["first loading"].leak is not None
    assert low.leak.leak_rate < 0.9 * low.scenarios["first loading"].leak.leak_rate  # type: ignore[union-attr]
    fresh = high.scenarios["first loading"].leak
    assert high.leak.leak_rate == pytest.approx(fresh.leak_rate, rel=1e-9)  # type: ignore[union-attr]


@pytest.mark.slow
def test_loads_up_and_down_of_bodies_that_yield_are_one_history():
    face = {**TURNED, "feed": "0.05 mm", "nose_radius": "0.4 mm", "spiral": False}
    curve = {"plastic_strain": [0, 0.05, 0.3], "stress": ["250 MPa", "300 MPa", "350 MPa"]}
    soft = {
        "name": "soft",
        "youngs_modulus": "120 GPa",
        "poissons_ratio": 0.34,
        "hardness": "0.9 GPa",
        "yield_stress": "250 MPa",
    }
    seat = {"closure.radius": "200 mm", "seat.material": {**soft, "stress_strain": curve}}
    forces = {"load.fluid_pressure": "2 bar", "load.applied_force": ["20 kN", "60 kN", "20 kN"]}
    loads = fem_seal.run(case_of({"seat": face}, **seat, **forces), sensitivities=False).loads
    up, most, down = (load.leak.leak_rate for load in loads if load.leak is not None)
    assert most < down < 0.5 * up
    fresh = loads[2].scenarios["first loading"].leak
    assert fresh is not None and fresh.leak_rate == pytest.approx(up, rel=0.02)
