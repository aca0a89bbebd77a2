"""A level, its reasons, and the thresholds between the levels: what docs/guide/validity.md says."""

from __future__ import annotations

import math
from dataclasses import replace
from unittest.mock import Mock

import numpy as np
import pytest
from judged_loads import SURFACE, field, judged, load
from places import ROOT
from sample_results import STEEL, ball, case, cone, rough_result, run_loads

import fem_seal
from fem_seal.answers.case_load import case_loads
from fem_seal.answers.closed_forms import closed_form_limits, derive, nearly_open
from fem_seal.case.case import Case
from fem_seal.output.report.brief import first_line, second_line
from fem_seal.output.report.page import comparison_note
from fem_seal.profile import PressureProfile
from fem_seal.result import run
from fem_seal.seal import findings
from fem_seal.seal.findings import NOT_JUDGED, VALID, Level, Validity, remark, worst_first
from fem_seal.seal.load_result import GivenContact, LoadResult
from fem_seal.seal.problem import SealProblem
from fem_seal.validity import checks as warnings
from fem_seal.validity.checks import load_cautions, load_validity, profile_validity


def caution(level, reason):
    return remark("kind", level, reason)


def level_of(found):
    return Validity.of(found).level


def test_the_worst_reason_comes_first_and_gives_the_level():
    doubtful, outside, other = (
        caution(Level.DOUBTFUL, "a"),
        caution(Level.OUTSIDE, "b"),
        caution(Level.DOUBTFUL, "c"),
    )
    found = Validity.of([doubtful, outside, other])
    assert found.level is Level.OUTSIDE and found.outside_theory
    assert found.reasons == ("b", "a", "c")
    assert worst_first([doubtful, other, outside]) == (outside, doubtful, other)
    assert Validity.of([doubtful]).level is Level.DOUBTFUL
    assert VALID.level is Level.VALID and VALID.reasons == () and not VALID.outside_theory
    assert found.without_kinds("kind") == VALID
    assert [f"{level}" for level in Level] == ["valid", "doubtful", "outside the theory"]


def test_a_doubt_about_the_leak_rate_is_none_about_the_contact():
    of_leak = replace(caution(Level.DOUBTFUL, "next to sealing"), of_contact=False)
    both = Validity.of([caution(Level.DOUBTFUL, "cut off"), of_leak])
    assert Validity.of([of_leak]).level is Level.DOUBTFUL
    assert Validity.of([of_leak]).of_contact == VALID
    assert both.of_contact.reasons == ("cut off",)


@pytest.mark.parametrize(
    ("excess", "level"), [(1.01, Level.DOUBTFUL), (1.49, Level.DOUBTFUL), (1.51, Level.OUTSIDE)]
)
def test_an_elastic_body_is_outside_the_theory_from_one_and_a_half_times_its_yield_stress(excess, level):
    (found,) = judged("yield stress", load(bodies=(field("seat", excess * 1e9),)))
    assert found.level is level
    assert found.reason() == f"seat: von Mises stress {excess:.3g} times its yield stress"


@pytest.mark.parametrize(
    ("material", "at", "words"),
    [
        # annealed brass yields at 0.1 % of its modulus, and a line contact at 1.67 times that
        ({}, 1.67 * 1e-3 * 100e9, "annealed metals as stiff as soft yield"),
        ({"hardness": "1 GPa"}, 1.67 * 1e9 / 2.9, "metals as hard as soft may yield"),
        ({"yield_stress": "200 MPa"}, math.inf, ""),
    ],
)
def test_a_body_whose_strength_nobody_knows_is_told_where_it_may_yield(material, at, words):
    """A brass seat under 800 MPa passed without a word: the library's brass has no yield stress."""
    soft = {"name": "soft", "youngs_modulus": "100 GPa", "poissons_ratio": 0.3, **material}
    of = case(closure=ball(STEEL), seat=cone(soft))
    assert not judged("yield stress", load(peak=0.99 * min(at, 1e9)), of=of)
    found = judged("yield stress", load(peak=min(1.01 * at, 5e9)), of=of)
    assert len(found) == bool(words)
    for one in found:
        assert one.level is Level.DOUBTFUL
        assert one.reason() == "seat: may yield: soft has no yield_stress here"
        assert words in one.text() and "give the yield_stress" in one.text()


@pytest.mark.slow
def test_a_seal_of_unknown_strength_passes_with_doubt_and_says_what_decides():
    of = case(
        seat=cone("brass"),
        load={"fluid_pressure": "20 bar", "applied_force": "10 kN"},
        leak={"theory": "paper", "plasticity": False},
        uncertainty={"samples": 16, "rms_height": {"relative": 0.01}},
        requirement={"leak_rate": "1 l/min"},
    )
    result = run(of, sensitivities=False)
    assert first_line(result).startswith("Pass at 20 bar, with doubt")
    assert second_line(result).startswith("A yield_stress in the material of the body that has none decides")


def test_a_page_without_stresses_tells_that_a_body_may_yield():
    soft = {**STEEL, "yield_stress": "200 MPa"}
    problem = SealProblem.of(case(closure=ball(STEEL), seat=cone(soft)))
    loads = [load(peak=times * 200e6) for times in (1.6, 1.7)]
    for one in loads:
        one.contact.model.knows_stress = False
    low, high = (list(load_cautions(problem, [one])) for one in loads)
    assert not any(one.kind == "yield stress" for one in low)
    (found,) = (one for one in high if one.kind == "yield stress")
    assert found.reason() == "seat: may yield; a complete run calculates its stress"


def test_the_body_that_is_further_above_its_yield_stress_comes_first():
    of = case(closure=ball(STEEL))
    both = load(bodies=(field("closure", 2e9), field("seat", 5e9)))
    assert [one.reason()[:7] for one in judged("yield stress", both, of=of)] == ["seat: v", "closure"]


@pytest.mark.parametrize(
    ("strain", "levels"), [(0.02, []), (0.06, [Level.OUTSIDE]), (0.12, [Level.OUTSIDE] * 2)]
)
def test_plastic_strain_has_to_stay_on_its_curve_and_small(strain, levels):
    curve = {"plastic_strain": [0, 0.05], "stress": ["300 MPa", "400 MPa"]}
    material = {key: value for key, value in STEEL.items() if key != "yield_stress"}
    of = case(seat=cone({**material, "stress_strain": curve}))
    yielded = load(bodies=(field("seat", 400e6, strain),))
    found = judged("stress-strain curve", yielded, of=of) + judged("large strain", yielded, of=of)
    assert [one.level for one in found] == levels


@pytest.mark.parametrize(
    ("share", "radius", "level"),
    [
        (1e-7, 0.02, Level.VALID),
        (9e-3, 0.02, Level.DOUBTFUL),
        (1.1e-2, 0.02, Level.OUTSIDE),
        (1.1e-2, math.inf, Level.DOUBTFUL),
    ],
)
def test_contact_cut_off(share, radius, level):
    assert level_of(judged("cut off", load(end_share=share), relative_radius=radius)) is level


@pytest.mark.parametrize(
    ("share", "level"),
    [(0.29, Level.VALID), (0.31, Level.DOUBTFUL), (0.99, Level.DOUBTFUL), (1.01, Level.OUTSIDE)],
)
def test_no_body_carries_more_than_its_hardness(share, level):
    pressed = load(peak=share * 3.5e9)
    found = judged("hardness", pressed, surface=replace(SURFACE, hardness=3.5e9))
    assert level_of(found) is level
    assert all(f"{share:.2g} of the hardness" in caution.text() for caution in found)
    # also where asperities are kept elastic
    elastic = case(leak={"plasticity": False})
    assert level_of(judged("hardness", pressed, of=elastic)) is (Level.OUTSIDE if share > 1 else Level.VALID)


@pytest.mark.parametrize(
    ("share", "level"),
    [(0.09, Level.VALID), (0.11, Level.VALID), (0.49, Level.VALID), (0.51, Level.OUTSIDE)],
)
def test_fluid_pressure_that_is_not_coupled(share, level):
    pressed = load(fluid_pressure=share * 50e6)
    found = Validity.of(judged("fluid opens", pressed))
    assert found.level is level and found.of_contact == VALID
    # a factor that is known is in the interval, and no doubt
    assert found.leak_factor.high > 1.0 and bool(found.cautions[0].text()) is (share > 0.1)
    coupled = case(load={"fluid_pressure": "20 bar", "closing": "penetration"})
    assert level_of(judged("fluid opens", pressed, of=coupled)) is Level.VALID


def test_what_is_sealed_or_nearly_so_is_doubtful_and_what_is_blown_open_has_no_result():
    sealing = SURFACE.sealing_pressure
    assert level_of(judged("sealed", load(peak=1.01 * sealing, leak_rate=0.0))) is Level.DOUBTFUL
    few = Validity.of(judged("few channels", load(peak=0.9 * sealing)))
    # of known size: in the interval, told, and no doubt
    assert few.level is Level.VALID and few.leak_factor.high == pytest.approx(3.3) and not few.reasons
    local = case(leak={"fluid_in_gap": "local"})
    assert level_of(judged("lifted open", load(leak_rate=math.inf), of=local)) is Level.OUTSIDE


# ---------------------------------------------------------------- loads of a run


def soft_seat(**tables):
    return case(seat=cone({**STEEL, "yield_stress": "60 MPa"}), **tables)


@pytest.fixture(scope="module")
def soft_result():
    """At 2 and 20 bar a seat that is far below and far above its yield stress."""
    return fem_seal.run(soft_seat(load={"fluid_pressure": ["1 bar", "400 bar"]}))


def test_every_load_has_its_own_validity(soft_result):
    low, high = soft_result.loads
    assert low.validity.level is not Level.OUTSIDE
    assert high.validity.outside_theory
    assert "times its yield stress" in high.validity.reasons[0]
    assert not any("yield" in reason for reason in low.validity.reasons)
    # the warnings name the worst load, the worst of them first
    assert "exceeds 60 MPa" in soft_result.warnings[0] and "400 bar" in soft_result.warnings[0]
    assert soft_result.table["validity"].tolist() == [str(low.validity.level), "outside the theory"]
    assert soft_result.table["validity_reasons"].tolist()[1] == "; ".join(high.validity.reasons)


def test_the_paper_s_loads_are_valid():
    assert [load.validity.reasons for load in rough_result().loads] == [()] * 3


def test_a_check_that_fails_costs_no_result_and_is_no_clean_bill(monkeypatch):
    monkeypatch.setattr(warnings, "_wide", Mock(side_effect=ZeroDivisionError("nothing to divide by")))
    result = fem_seal.run(case(load={"fluid_pressure": ["2 bar", "20 bar"]}))
    assert [load.validity for load in result.loads] == [NOT_JUDGED] * 2
    assert NOT_JUDGED.level is Level.DOUBTFUL and NOT_JUDGED.reasons
    assert all(load.leak.leak_rate > 0 for load in result.loads)
    for pressure in ("2 bar", "20 bar"):
        assert any(one.startswith(f"validity at {pressure}: could not be") for one in result.warnings)


def test_a_coarse_mesh_makes_all_loads_doubtful(soft_result):
    from fem_seal.seal.load_result import DiscretisationError

    result, coarse = rough_result(), DiscretisationError(0.01, 0.0, 0.0, None)
    found = load_validity(result.problem, result.loads[0].with_values(mesh_error=coarse))
    assert found.level is Level.DOUBTFUL and found.reasons == ("estimated discretisation error 1 %",)
    assert found.without_kinds("mesh").level is Level.VALID


@pytest.mark.slow
def test_a_force_for_the_target_that_is_outside_the_theory_says_nothing_of_its_load():
    """The load itself is far inside; the force that the target takes crushes the seat."""
    result = fem_seal.run(soft_seat(load={"fluid_pressure": "2 bar", "target_leak_rate": "0.02 mm^3/s"}))
    (found,) = result.loads
    assert found.target_validity.outside_theory
    assert found.validity.level is Level.VALID
    assert any("at the force for the target leak rate" in one for one in result.warnings)
    contact = LoadResult(found.fluid_pressure, 0.0, found.contact, found.rough)
    assert not warnings.target_validity(result.problem, contact).outside_theory


# ---------------------------------------------------------------- numbers that agree


def test_a_peak_at_the_end_of_the_profile_is_its_largest_value():
    x = np.linspace(0.0, 1e-3, 21)
    for pressure in (
        1e9 / (1 + 1e5 * x),
        1e9 / (1 + 1e5 * x[::-1]),
        1e9 * np.exp(-((x - 4.1e-4) ** 2) / 1e-8),
    ):
        profile = PressureProfile(x, 0.01 + x, pressure, np.zeros(21), np.full(21, 5e-5))
        assert profile.peak_pressure >= pressure.max()
        assert profile.peak_pressure == pytest.approx(pressure.max(), rel=0.05)


def test_limits_are_those_of_the_documentation():
    text = (ROOT / "docs" / "guide" / "validity.md").read_text(encoding="utf-8")
    rows = {cells[1].strip(): cells[2:4] for line in text.splitlines() if len(cells := line.split("|")) == 5}

    def limits(start):
        (row,) = [cells for name, cells in rows.items() if name.startswith(start)]
        return [cell.strip() for cell in row]

    assert limits("von Mises stress of a body") == ["above 1", f"above {warnings.LARGEST_EXCESS:g}"]
    assert limits("pressure at the end of a face") == [
        f"above {warnings._CUT_SHARE:.0e}".replace("e-06", "e-6"),
        f"above {100 * warnings._LARGE_CUT_SHARE:g} %",
    ]
    assert limits("plastic strain, for")[1] == f"above {100 * warnings._LARGE_STRAIN:g} %"
    assert limits("peak pressure over")[0].startswith(f"above {warnings._NEAR_HARDNESS:g},")
    assert limits("fluid pressure over") == [
        f"above {warnings.FLUID_OPENS:g}, in the interval alone",
        f"above {warnings._FLUID_LIFTS:g}",
    ]
    assert limits("few channels")[0].startswith(f"above {warnings._FEW_CHANNELS:g}, in the interval alone")
    assert limits("width of the contact")[0] == f"above {warnings._NARROW:g}"
    assert limits("share of the height")[0].startswith(f"above {100 * warnings._LONG_WAVES:g} %,")
    errors = f"above {100 * warnings._LARGEST_ERROR:g} %; {100 * warnings._LARGEST_ERROR_OF_PATH:g} %"
    assert limits("discretisation error")[0].startswith(errors)


def test_a_mesh_error_that_is_not_known_is_no_clean_bill():
    from fem_seal.seal.load_result import DiscretisationError

    result, unknown = rough_result(), DiscretisationError(math.nan, math.nan, math.nan, None)
    found = load_validity(result.problem, result.loads[0].with_values(mesh_error=unknown))
    assert found.reasons == ("discretisation error not estimated",)


# ---------------------------------------------------------------- faces that bend within the thickness of the layer


def layered(u0: str, **tables: object) -> Case:
    """Elastic steel with an exponential law and no roughness."""
    law = {"law": "exponential", "u0": u0, "p_c": "5 GPa"}
    return case(**{"roughness": None, "fluid": None, "interface": law, "seat": cone("steel"), **tables})


def edge_case(edge_radius: str, u0: str) -> Case:
    return layered(
        u0,
        closure=cone("steel", mean_radius="5 mm", outer_radius="7 mm"),
        seat={"shape": "sharp-edge", "bore_radius": "5 mm", "edge_radius": edge_radius, "material": "steel"},
        load={"fluid_pressure": ["2 bar"]},
    )


@pytest.mark.parametrize(
    ("edge_radius", "u0", "level"),
    [("300 um", 1e-6, "valid"), ("30 um", 1e-6, "doubtful"), ("15 um", 5e-6, "outside the theory")],
)
def test_a_layer_that_is_not_thin_against_the_edge_says_so(edge_radius, u0, level):
    """u = u0 ln(p_c/p) is a fiftieth, a sixth and twice the radius of the edge here."""
    result = run(edge_case(edge_radius, f"{u0} m"))
    (load,) = result.loads
    assert load.validity.level == level
    if level != "valid":
        apart = u0 * math.log(5e9 / load.contact.profile.peak_pressure)
        said = next(text for text in result.warnings if "radius of curvature" in text)
        assert f"are {1e6 * apart:.3g} um apart" in said


def test_check_and_report_say_where_the_closed_forms_do_not_hold():
    load = {"fluid_pressure": ["2 bar", "20 bar"]}
    land = {**cone("steel", land_width="0.2 mm", edge_radius="0.1 mm"), "shape": "conical-land"}
    narrow = layered("0.76 um", seat=land, load=load)
    said = str(closed_form_limits(narrow, derive(narrow)))
    assert said.startswith("from 2 bar on")
    result = run(narrow)
    assert said[1:] in comparison_note(result)
    crossover = derive(narrow).loads[0].crossover
    assert abs(result.loads[0].contact.profile.peak_pressure / crossover.peak_pressure - 1) > 0.05
    wide = layered("0.76 um", load=load)
    assert closed_form_limits(wide, derive(wide)) == ""


def test_check_says_where_the_law_is_no_exponential_and_where_only_a_run_decides():
    rough = case(load={"fluid_pressure": ["20 bar", "1000 bar"]})
    said = str(closed_form_limits(rough, derive(rough)))
    assert "not exponential" in said
    tables = {
        "fluid_pressure": ["1 bar", "60 bar", "70 bar"],
        "pressure_side": "inner",
        "applied_force": "1 kN",
    }
    spring = case(load={**tables, "closing": "penetration"})
    opens = 1000 / (math.pi * spring.initial_contact_radius**2) / 1e5
    found = derive(spring)
    assert [math.isnan(load.contact_force) for load in found.loads] == [p > opens for p in (1, 60, 70)]
    assert "only a run can tell" in str(nearly_open(found))
    assert nearly_open(derive(rough)) == ""


def test_the_warning_of_yielding_can_be_followed():
    soft = {**STEEL, "yield_stress": "50 MPa"}
    curve = {"plastic_strain": [0, 0.1], "stress": ["50 MPa", "80 MPa"]}
    for closing in ("sealed-area", "penetration"):
        tables = {"load": {"fluid_pressure": "60 bar", "closing": closing, "applied_force": "5 kN"}}
        result = run_loads(case(**tables, seat=cone(soft)))
        assert any(
            "A stress_strain curve in its material calculates that" in text for text in result.warnings
        )
        assert result.case.replace({"seat.material.stress_strain": curve}).seat.material.hardening is not None


def test_a_seat_that_the_spring_alone_crushes_is_outside_the_theory_at_every_pressure():
    soft = {**STEEL, "yield_stress": "22 MPa"}
    load = {"fluid_pressure": ["1 bar", "55 bar"], "pressure_side": "inner", "applied_force": "4 kN"}
    alone, lifted = run_loads(case(load=load, seat=cone(soft))).loads
    # the estimate from the load that is left is below what the spring alone does
    stress = [max(one.contact.fields["seat"].von_mises) for one in (alone, lifted)]
    assert stress[1] < 22e6 < 1.5 * 22e6 < stress[0]
    estimate = stress[1] * math.sqrt(4000 / lifted.contact_force)
    assert estimate < stress[0]
    assert alone.validity.outside_theory and lifted.validity.outside_theory
    said = next(one for one in lifted.validity.cautions if "under the applied force alone" in one.reason())
    assert f"{estimate / 22e6:.2g} times" in said.reason()
    # a pressure that closes the seal, and a spring that the metal bears, leave nothing behind
    for change in ({"load.pressure_side": "outer"}, {"seat.material.yield_stress": "40 MPa"}):
        other = run_loads(case(load=load, seat=cone(soft)).replace(change))
        assert not any("alone" in reason for one in other.loads for reason in one.validity.reasons)


def test_next_to_the_percolation_threshold_no_more_leaks_than_where_direct_results_end():
    result = run(case(load={"fluid_pressure": "20 bar"}))
    x = np.linspace(-1e-3, 1e-3, 201)
    peak = 0.97 * result.surface.sealing_pressure
    shape = np.exp(-((x / 2e-4) ** 2))
    profile = PressureProfile(
        x, np.full_like(x, 0.014), peak * shape, np.full_like(x, np.nan), np.gradient(x)
    )
    assert 0.39 < float(result.surface.contact_area(peak)) < 0.42
    (load,) = result.loads
    rough = replace(load.rough, make=lambda flow, surface: flow.table_around(surface, [math.log10(peak)]))
    given = LoadResult(2e6, 0.0, GivenContact(profile), rough)
    validity = profile_validity(result.problem, given)
    (found,) = (one for one in validity.cautions if one.kind == "nearly sealed")
    # from A/A0 = 0.39 to 0.55 it fades in that nothing may leak
    area = float(result.surface.contact_area(peak))
    assert "orders of magnitude" in found.reason()
    assert found.leak_factor.low == pytest.approx(1e-3 ** ((area - 0.39) / 0.16), rel=1e-6)
    # the bound holds what the theory is off by there
    limit = float(np.interp(0.39, result.surface.contact_area(p := np.linspace(0.8, 1.0, 200) * peak), p))
    pressed = replace(profile, pressure=np.minimum(profile.pressure, limit))
    more = rough.leak(pressed, 2e6).leak_rate / given.leak.leak_rate
    assert found.leak_factor.high == pytest.approx(more, rel=1e-2) and more > 1.0
    assert validity.without_kinds("nearly sealed", "fluid opens").leak_factor.high == pytest.approx(
        3.3, rel=1e-2
    )
    (made,) = case_loads(result.problem, [given])
    whole = made.with_values(validity=validity)
    assert whole.leak_interval.high > 3.3 * rough.leak(pressed, 2e6).leak_rate


def test_the_bound_next_to_the_threshold_falls_with_the_load():
    """It rose with the load, by the channels of the narrow peak, and ended where the peak seals a wide contact."""
    result = run(case(leak={"theory": "corrected"}, load={"fluid_pressure": "20 bar"}))
    x = np.linspace(-4e-4, 4e-4, 201)
    sealing = result.surface.sealing_pressure
    (load,) = result.loads
    rough = replace(
        load.rough, make=lambda flow, surface: flow.table_around(surface, [math.log10(2.0 * sealing)])
    )
    at = []
    for share in (0.98, 0.995, 1.01, 1.025, 1.04):
        pressure = share * sealing * np.exp(-((x / 8e-5) ** 2))
        profile = PressureProfile(
            x, np.full_like(x, 0.014), pressure, np.full_like(x, np.nan), np.gradient(x)
        )
        given = LoadResult(2e6, 0.0, GivenContact(profile), rough)
        found = profile_validity(result.problem, given)
        assert not any(one.kind == "sealed" for one in found.cautions)
        at.append((given.leak.leak_rate, given.leak.leak_rate * found.leak_factor.high))
    rates, most = np.transpose(at)
    assert (np.diff(rates) < 0.0).all() and (np.diff(most) < 0.0).all() and (most > rates).all()


def test_a_thick_layer_on_a_small_steep_seat_says_so():
    """27 um of layer at 70 degrees and r0 = 0.94 mm: up to 8 % of the radius, as theory_geometry.md counts it."""
    load = {"fluid_pressure": "0.5 bar"}
    small = layered("3 um", closure=ball(radius="1 mm"), seat=cone("steel", "70 deg"), load=load)
    (steep,) = run(small).loads
    apart = 3e-6 * math.log(5e9 / steep.contact.profile.peak_pressure)
    share = apart * math.tan(math.radians(70)) / (1e-3 * math.sin(math.radians(70)))
    assert str(steep.validity.level) == "doubtful"
    assert any(f"{share:.2g} of the radius of first touch" in reason for reason in steep.validity.reasons)
    wide = run(layered("3 um", seat=cone("steel", "20 deg"), load=load))
    assert str(wide.loads[0].validity.level) == "valid"


def test_a_strain_far_beyond_small_ones_is_told_without_a_number():
    for strain, told in ((0.1234, "plastic strain 12.3 %"), (400.0, "plastic strain more than 100 %")):
        assert told in findings.caution("large_strain", name="needle", strain=strain, limit=10.0).reason()


@pytest.mark.parametrize("process", ["ground", "reamed"])
def test_a_lay_of_a_known_factor_makes_nothing_doubtful(process):
    """Every ground or reamed face was doubtful, its peak and its opening too."""
    drawn = {"seat": {"Ra": "0.8 um", "process": process}, "closure": {"Ra": "0.05 um", "process": "lapped"}}
    result = run_loads(case(roughness=drawn, load={"fluid_pressure": "5 bar", "applied_force": "1 kN"}))
    (one,) = result.loads
    lay = [found for found in one.validity.cautions if found.kind == "lay"]
    assert [found.level for found in lay] == [Level.VALID]
    assert one.leak_interval.high >= lay[0].leak_factor.high * one.leak.leak_rate
    assert "lay" not in " ".join(one.validity.reasons)
    assert one.validity.without_kinds("mesh").of_contact == VALID
    # and it is told, once
    assert sum("roughness with a lay" in text for text in result.warnings) == 1
