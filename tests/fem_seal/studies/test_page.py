"""The page of a study: what an engineer decides from has to be there, legible and not misleading."""

import math
import re
from itertools import pairwise

import numpy as np
import pandas as pd
import pytest
from places import EXAMPLES

from fem_seal.output.columns import LEAK_COLUMNS
from fem_seal.studies import plots
from fem_seal.studies.designs import unit_points
from fem_seal.studies.designs_table import LEAK_RATE, Designs, sensitivities
from fem_seal.studies.display import DesignDisplay, short_number
from fem_seal.studies.expressions import Constraint
from fem_seal.studies.page import page, passing_words, sections
from fem_seal.studies.results import dataset
from fem_seal.studies.tables import Design

CASE = EXAMPLES / "ball_cone.toml"
PRESSURE, ML = "peak_pressure_Pa", 1e-6 / 60


def parameter(name, unit="", levels=(), distribution=None, bounds=None):
    numeric = not isinstance(next(iter(levels), 0.0), (str, bool))
    ends = bounds or ((min(levels), max(levels)) if numeric else (0, len(levels) - 1))
    return {
        "name": name,
        "unit": unit,
        "numeric": numeric,
        "levels": list(levels),
        "bounds": list(ends),
        "distribution": distribution,
    }


ANGLE = parameter("seat.angle", "rad", [math.pi / 6, math.pi / 4, math.pi / 3])
FORCE = parameter("load.applied_force", "N", distribution="Uniform", bounds=(0.0, 200.0))


def made(parameters, columns, failed=(), **about):
    """Designs as if they had been calculated; responses are the columns that are no parameters."""
    table = pd.DataFrame(columns)
    table.index.name = "number"
    names = [one["name"] for one in parameters]
    responses = [name for name in columns if name not in names and name not in about.get("derived", {})]
    rows = table.to_dict("records")
    for name, text in about.get("constraints", {}).items():
        table[name] = [Constraint(text).is_met(row) for row in rows]
    table.insert(0, "status", ["failed" if n in failed else "done" for n in table.index])
    table.insert(1, "reason", None)
    design = {"kind": "grid", "file": None, "num": None, "seed": 1, "invalid": "refuse", "optimise": False}
    standing = {
        "title": "Seats",
        "version": "1",
        "parameters": parameters,
        "responses": responses,
        "derived": {},
        "constraints": {},
        "goals": {},
        "standard": "ISO 5208",
        "seal": {"nominal_size": 0.025, "gas": False, "fluid": "water"},
    }
    return Designs(table, {**standing, **about, "design": {**design, **about.get("design", {})}})


def angles(**about):
    """Three angles; the tightest one violates the constraint."""
    columns = {
        "seat.angle": ANGLE["levels"],
        PRESSURE: [20e6, 30e6, 50e6],
        LEAK_RATE: [6 * ML, 5 * ML, 4 * ML],
    }
    given = {"constraints": {"gentle": 'peak_pressure_Pa < "40 MPa"'}, "goals": {LEAK_RATE: LEAK_RATE}}
    return made([ANGLE], columns, **{**given, **about})


def forces(count=40, **about):
    force = np.linspace(0.5, 199.5, count)
    columns = {"load.applied_force": force, LEAK_RATE: ML * np.exp(-force / 50)}
    return made([FORCE], columns, **about)


def headings(designs):
    return {one.heading: one for one in sections(designs)}


# ---------------------------------------------------------------- shares


@pytest.mark.parametrize("design", [{"kind": "morris", "num": 8}, {"optimise": True}])
def test_shares_are_left_out_where_they_mean_nothing(design):
    shares = {"Probability by leak rate", "Leakage classes"}
    assert shares <= set(headings(forces(design={"kind": "latin-hypercube"})))
    assert not shares & set(headings(forces(design=design)))


def test_shares_say_what_they_are_shares_of():
    designs = forces(design={"kind": "latin-hypercube"})
    assert "of 40 calculated designs." in headings(designs)["Probability by leak rate"].note
    part = made([FORCE], dict(forces().table.iloc[:, 2:]), failed=(0, 7))
    for heading in ("Probability by leak rate", "Leakage classes"):
        assert "of 38 calculated designs; 2 failed ones not counted" in headings(part)[heading].note
    # a probability only of designs that were drawn
    chosen = headings(angles())["Share of the designs by leak rate"]
    assert chosen.folded and chosen.columns[0] == "share of the designs below"


def test_a_standard_without_a_class_says_so():
    found = headings(angles(standard="FCI 70-2"))["Leakage classes"]
    assert "No class of FCI 70-2 can be judged for DN 25 and water" in found.note
    assert not found.rows
    assert headings(angles())["Leakage classes"].rows


# ---------------------------------------------------------------- constraints


def test_designs_that_violate_constraints_look_different():
    display = DesignDisplay(angles())
    good, bad = plots.response_plot(display).data
    assert (len(good.x), bad.name, bad.marker.symbol) == (2, "violates a constraint", "circle-open")
    assert bad.x == pytest.approx([60])
    assert 'violates gentle: peak_pressure_Pa &lt; "40 MPa"' in bad.text[0]
    assert "violates" not in good.text[0]
    # every entry of the menus moves both groups
    for menu in plots.response_plot(display).layout.updatemenus:
        assert all(len(next(iter(button.args[0].values()))) == 2 for button in menu.buttons)


def test_parallel_coordinates_show_the_verdict():
    (lines,) = plots.parallel_plot(DesignDisplay(angles())).data
    verdict = lines.dimensions[-1]
    assert (verdict.label, verdict.ticktext, list(verdict["values"])) == (
        "meets the constraints",
        ("no", "yes"),
        [1, 1, 0],
    )
    low, high = verdict.constraintrange
    assert 0 < low < 1 < high
    pressure = next(one for one in lines.dimensions if one.label == "peak pressure [MPa]")
    assert pressure.constraintrange == pytest.approx((20, 40))
    # the range moves to the marks beside its ends: one stands at the limit
    assert np.abs(np.array(pressure.tickvals) - 40).min() < 1e-9 and len(set(pressure.ticktext)) == len(
        pressure.ticktext
    )
    free = plots.parallel_plot(DesignDisplay(angles(constraints={}))).data[0]
    assert [one.label for one in free.dimensions] == [
        "seat angle [°]",
        "peak pressure [MPa]",
        "leak rate [ml/min]",
    ]


def test_map_marks_designs_that_violate_constraints():
    force = parameter("load.applied_force", "N", [0.0, 100.0])
    columns = {
        "seat.angle": np.repeat(ANGLE["levels"], 2),
        "load.applied_force": [0.0, 100.0] * 3,
        PRESSURE: [20e6, 30e6, 30e6, 50e6, 50e6, 60e6],
        LEAK_RATE: np.geomspace(1, 100, 6) * ML,
    }
    designs = made([ANGLE, force], columns, constraints={"gentle": 'peak_pressure_Pa < "40 MPa"'})
    contour, crosses = plots.plane_plot(DesignDisplay(designs)).data
    assert crosses.x == pytest.approx([45, 60, 60])
    assert np.array(contour.z) == pytest.approx(np.log10(np.geomspace(1, 100, 6)).reshape(3, 2).T)


# ---------------------------------------------------------------- words, axes, units


def test_words_and_truth_values_have_axes():
    law = parameter("interface.law", levels=["spectrum", "exponential"])
    plastic = parameter("leak.plasticity", levels=[True, False])
    columns = {
        "interface.law": ["exponential", "spectrum", "spectrum"],
        "leak.plasticity": [False, False, True],
        LEAK_RATE: [ML, 2 * ML, 3 * ML],
    }
    designs = made([law, plastic], columns, goals={LEAK_RATE: LEAK_RATE})
    first, second, _ = plots.parallel_plot(DesignDisplay(designs)).data[0].dimensions
    assert (first.ticktext, list(first["values"])) == (("spectrum", "exponential"), [1, 0, 0])
    assert (second.ticktext, list(second["values"])) == (("yes", "no"), [1, 1, 0])
    figure = plots.response_plot(DesignDisplay(designs))
    assert (figure.layout.xaxis.type, figure.layout.xaxis.categoryarray) == (
        "category",
        ("spectrum", "exponential"),
    )
    assert headings(designs)["Best designs"].rows[0][:3] == ("0", "exponential", "no")


@pytest.mark.parametrize(
    ("varied", "logarithmic"),
    [
        ({"distribution": "Uniform", "bounds": (0.0, 200.0)}, False),
        ({"distribution": "Uniform", "bounds": (1.0, 200.0)}, False),
        ({"distribution": "Normal", "bounds": (1.0, 20.0)}, False),
        ({"distribution": "LogUniform", "bounds": (1.0, 10.0)}, True),
        ({"distribution": "LogNormal", "bounds": (3.0, 4.0)}, False),
        ({"distribution": "LogNormal", "bounds": (1.0, 30.0)}, True),
        ({"levels": [1.0, 2.0, 4.0, 8.0]}, True),
        ({"levels": [1.0, 26.0, 51.0, 76.0]}, False),
        ({"levels": [1.0, 5.0, 60.0]}, True),
        ({"levels": [1.0, 2.0, 5.0]}, False),
        ({"levels": [0.0, 1.0, 100.0]}, False),
        ({"levels": [0.0, 1.0, 10.0, 100.0]}, True),
        ({"levels": [-1.0, 1.0, 10.0, 100.0]}, False),
    ],
)
def test_a_parameter_has_the_axis_that_it_was_varied_on(varied, logarithmic):
    # samples that span a factor of ten, whatever they were drawn from
    columns = {"load.applied_force": [1.0, 4.0, 16.0], LEAK_RATE: [ML, 2 * ML, 3 * ML]}
    display = DesignDisplay(made([parameter("load.applied_force", "N", **varied)], columns))
    assert display.logarithmic("load.applied_force") is logarithmic
    assert plots.response_plot(display).layout.xaxis.type == ("log" if logarithmic else "linear")


def test_parameters_are_listed_in_the_units_of_the_page():
    warm = parameter("fluid.temperature", "K", distribution="Uniform", bounds=(283.15, 333.15))
    rough = parameter("height", "m", distribution="LogUniform", bounds=(5e-7, 4e-6))
    columns = {
        "seat.angle": ANGLE["levels"],
        "fluid.temperature": [283.15, 300.0, 333.15],
        "height": [5e-7, 1e-6, 4e-6],
        LEAK_RATE: [ML] * 3,
    }
    designs = made([ANGLE, warm, rough], columns, derived={})
    assert headings(designs)["Parameters and formulas"].rows == (
        ("seat.angle", "seat angle", "°", "30, 45, 60"),
        ("fluid.temperature", "fluid temperature", "°C", "uniform from 10 to 60"),
        ("height", "height", "µm", "log-uniform from 0.5 to 4"),
    )


def test_ticks_stay_within_the_designs_that_did_not_fail():
    designs = made([ANGLE], dict(angles().table[["seat.angle", LEAK_RATE]]), failed=(2,))
    axis = plots.parallel_plot(DesignDisplay(designs)).data[0].dimensions[0]
    assert axis.ticktext == ("30", "45")


# One of each; that every column has the unit in its name is tested with the columns.
UNITS = {
    "fluid_pressure_Pa": "Pa",
    "contact_force_N": "N",
    "line_load_N_per_m": "N/m",
    "fwhm_m": "m",
    "leak_rate_m3_per_s": "m^3/s",
    "leak_rate_kg_per_s": "kg/s",
    "leak_rate_Pa_m3_per_s": "Pa m^3/s",
    "load_steps": "1",
    "effective_viscosity_Pa_s": "Pa s",
    "contact_temperature_K": "K",
    "bolt_torque_N_m": "N m",
    "leak_rate_per_length_m2_per_s": "m^2/s",
    "leak_rate_per_length_kg_per_m_s": "kg/(m s)",
    "leak_rate_per_length_Pa_m2_per_s": "Pa m^2/s",
}


def test_every_response_has_its_unit_in_exports_and_on_the_page():
    pytest.importorskip("xarray")
    target = parameter("load.target_leak_rate", "m^3/s", [1e-9, 2e-9])
    columns = {"load.target_leak_rate": target["levels"], **{name: [1.0, 2.0] for name in LEAK_COLUMNS}}
    designs = made([target], columns)
    data = dataset(designs)
    units = {name: data[name].attrs["units"] for name in LEAK_COLUMNS}
    assert units.items() >= UNITS.items()
    assert set(units.values()) == set(UNITS.values())
    assert data["load.target_leak_rate"].attrs["units"] == UNITS["leak_rate_m3_per_s"]
    display = DesignDisplay(designs)
    labels = ("leak_rate_Pa_m3_per_s", "leak_rate_kg_per_s", "line_load_N_per_m", "load_steps")
    assert [display.label(name) for name in labels] == [
        "leak rate pV [mbar l/s]",
        "leak rate by mass [g/h]",
        "line load [N/m]",
        "load steps",
    ]


def test_margins_to_opening_are_shown_beside_the_fluid_pressure_in_its_unit():
    columns = {"load.fluid_pressure": [5e5, 8e5], "opening_margin_Pa": [1e5, 3e5]}
    display = DesignDisplay(made([parameter("load.fluid_pressure", "Pa", [5e5, 8e5])], columns))
    assert display.label("opening_margin_Pa") == "opening margin [bar]"
    assert display.label("load.fluid_pressure") == "fluid pressure [bar]"


def test_numbers_are_short_and_never_in_computer_notation():
    texts = [short_number(one) for one in (30.0, 0.50976, 1500.0, 1.23e-10, None)]
    assert texts == ["30", "0.5098", "1500", "1.23·10⁻¹⁰", "–"]


# ---------------------------------------------------------------- sensitivity


def sensitive(kind, response=PRESSURE):
    """A response that goes like the exponential of the first of two parameters, and a tenth of the second."""
    points = unit_points(Design(kind=kind, num=8), 2)
    names = ("load.fluid_pressure", "seat.angle")
    parameters = [
        parameter(name, unit, distribution="Uniform", bounds=(1e5, 2e6))
        for name, unit in zip(names, ("Pa", "rad"), strict=True)
    ]
    columns = {
        **dict(zip(names, points.T + 1.0, strict=True)),
        "fluid_pressure_Pa": points[:, 0] + 1.0,
        "fwhm_m": np.full(len(points), 1e-3) * (1 + 1e-15 * points[:, 0]),
        PRESSURE: 1e6 * (10 * points[:, 0] + points[:, 1]),
        LEAK_RATE: ML * np.exp(3 * points[:, 0] + 0.3 * points[:, 1]),
    }
    return made(parameters, columns, design={"kind": kind, "num": 8}, goals={LEAK_RATE: LEAK_RATE})


@pytest.mark.parametrize("kind", ["morris", "sobol-sensitivity"])
def test_inputs_and_constants_have_no_sensitivity(kind):
    designs = sensitive(kind)
    shown = [heading for heading in headings(designs) if heading.startswith("Sensitivity")]
    assert shown == ["Sensitivity of leak rate", "Sensitivity of peak pressure"]
    assert [headings(designs)[heading].folded for heading in shown] == [False, True]
    assert designs.informative_outputs == [PRESSURE, LEAK_RATE]


def test_sensitivity_is_legible():
    designs = sensitive("morris")
    found = {one.output: one for one in sensitivities(designs)}
    linear = plots.sensitivity_plot(DesignDisplay(designs), found[PRESSURE])
    assert linear.layout.xaxis.title.text == "effect on peak pressure [MPa]"
    assert linear.data[0].x == pytest.approx([10, 1])
    section = headings(designs)["Sensitivity of peak pressure"]
    assert section.columns[1] == "mean absolute effect [MPa]"
    # a linear effect has no spread but that of round-off
    assert section.rows[0] == ("load.fluid_pressure", "10", "0", "0")

    logarithm = headings(designs)["Sensitivity of leak rate"]
    assert "multiplies or divides leak rate by eˣ" in logarithm.note
    assert logarithm.rows[0][-1] == f"× {short_number(math.exp(3), 3)}"
    figure = plots.sensitivity_plot(DesignDisplay(designs), found[LEAK_RATE])
    assert figure.layout.xaxis.title.text == "effect on ln(leak rate)"

    designs = sensitive("sobol-sensitivity")
    one = next(one for one in sensitivities(designs) if one.output == LEAK_RATE)
    figure = plots.sensitivity_plot(DesignDisplay(designs), one)
    assert figure.layout.xaxis.title.text == "share of the variance of ln(leak rate)"


# ---------------------------------------------------------------- goals


def test_a_search_for_two_goals_shows_its_course():
    columns = {"seat.angle": [1.0, 0.8, 0.9, 0.7, 0.6], LEAK_RATE: np.array([4.0, 3.0, 2.0, 1.0, 5.0]) * ML}
    angle = parameter("seat.angle", "rad", distribution="Uniform", bounds=(0.5, 1.1))
    designs = made(
        [angle],
        columns,
        goals={LEAK_RATE: LEAK_RATE, "seat.angle * 2": "-(seat.angle * 2)"},
        constraints={"flat": "seat.angle > 0.75"},
        design={"optimise": True},
    )
    assert "Search" in headings(designs)
    figure = plots.search_plot(DesignDisplay(designs))
    assert figure.layout.yaxis2.title.text == "seat.angle * 2 [SI]"
    small, large = (one for one in figure.data if one.name == "best so far")
    # trials 3 and 4 violate the constraint
    assert (list(small.x), list(large.y)) == ([0, 1, 2, 3, 4], [2.0] * 5)
    assert small.y == pytest.approx([4, 3, 2, 2, 2])
    assert [list(one.x) for one in figure.data if one.name == "violates a constraint"] == [[3, 4]] * 2
    best = headings(designs)["Best designs"]
    assert "small leak rate and large seat.angle * 2" in best.note
    # those on the front first, then those that violate the constraint
    assert best.columns[-1] == "seat.angle * 2 [SI]"
    assert [row[-1] for row in best.rows] == ["1.8", "2", "1.6", "1.4", "1.2"]


def test_a_design_that_occurs_twice_is_listed_once():
    columns = {"load.applied_force": [10.0, 5.0, 10.0, 5.0, 0.0], LEAK_RATE: np.array([1, 2, 1, 2, 3]) * ML}
    one = made([FORCE], columns, goals={LEAK_RATE: LEAK_RATE})
    assert one.best(10) == [0, 1, 4]
    two = made([FORCE], columns, goals={LEAK_RATE: LEAK_RATE, "load.applied_force": "load.applied_force"})
    assert two.best(10) == [0, 1, 4]


def test_the_page_escapes_what_users_write():
    text = page(angles(title="<b>seat</b>"), {"done": 3, "failed": 0, "open": 0}, [("<i>bad</i>", 1)])
    body = text[text.index("<body>") :]
    assert "<b>" not in body and "<i>" not in body
    assert "seat angle [°]" in body


@pytest.mark.slow
@pytest.mark.parametrize("width", [80, 120])
def test_the_table_of_the_command_line_is_never_cut(tmp_path, capsys, monkeypatch, width):
    from fem_seal.cli.app import main

    (tmp_path / "study.toml").write_text(
        f'base = "{CASE}"\nresponses = ["fluid_pressure_Pa", "line_load_N_per_m", "contact_force_N"]\n'
        '[changes]\nload.fluid_pressure = "10 bar"\nmesh.contact_size = "60 um"\n'
        '[parameters]\nroughness.spectrum.rms_height = ["1 um", "2 um", "3 um"]\n'
        'load.applied_force = ["0 N", "50 N", "100 N"]\nleak.plasticity = [true, false]\n'
        '[report]\ngoals = { line_load_N_per_m = "min" }\n'
    )
    monkeypatch.setenv("COLUMNS", str(width))
    assert main(["study", str(tmp_path / "study.toml"), "--workers", "0"]) == 0
    text = capsys.readouterr().out
    table = text[: text.index("18 designs done")]
    assert max(map(len, table.splitlines())) <= width
    assert "…" not in text and not re.search(r"\de[-+]\d", text)
    lines = [line for line in table.splitlines() if line.startswith("applied force [N]")]
    # ten of the eighteen: all without force, the others with the least
    assert " ".join(lines).split().count("0") == 6 and " ".join(lines).split().count("50") == 4
    truths = [line for line in table.splitlines() if line.startswith("plasticity")]
    assert {"yes", "no"} <= set(" ".join(truths).split())
    designs = [
        int(one) for line in table.splitlines() if line.startswith("design") for one in line.split()[1:]
    ]
    assert len(designs) == len(set(designs)) == 10
    numbers = [
        float(one) for line in table.splitlines() if line.startswith("line load") for one in line.split()[3:]
    ]
    assert all(earlier <= later for earlier, later in pairwise(numbers))


def test_parameters_that_would_be_called_the_same_keep_their_paths():
    names = ["closure.material.hardness", "closure.hardness", "seat.angle"]
    designs = made(
        [parameter(name, "", [1.0, 2.0]) for name in names],
        {**{name: [1.0, 2.0] for name in names}, LEAK_RATE: [ML] * 2},
        constraints={},
        derived={},
    )
    display = DesignDisplay(designs)
    assert [display.title(name) for name in names] == [*names[:2], "seat angle"]


def test_distribution_comes_first_where_the_designs_were_drawn():
    drawn = parameter("seat.angle", "rad", distribution="Normal", bounds=(0.7, 0.8))
    columns = {"seat.angle": [0.74, 0.78, 0.8], LEAK_RATE: np.array([1.0, 2.0, 3.0]) * ML}
    batch = made([drawn], columns, constraints={}, derived={}, goals={}, design={"kind": "sobol"})
    assert next(iter(headings(batch))) == "Probability by leak rate"
    chosen = made([ANGLE], {**columns, "seat.angle": ANGLE["levels"]}, constraints={}, derived={}, goals={})
    assert next(iter(headings(chosen))) != "Share of the designs by leak rate"


# ---------------------------------------------------------------- validity


def judged(designs, *levels):
    """Designs of these levels."""
    table = designs.table.copy()
    table.insert(2, "validity", levels)
    table.insert(3, "validity_reasons", ["" if one == "valid" else "too soft; too wide" for one in levels])
    return Designs(table, designs.about)


FOUR = {"load.applied_force": [10.0, 20.0, 30.0, 40.0], LEAK_RATE: np.array([4, 3, 2, 1]) * ML}
LEVELS = ("valid", "doubtful", "outside the theory", "outside the theory")


def test_front_course_and_best_leave_out_what_is_outside_the_theory():
    columns = {**FOUR, PRESSURE: np.array([1.0, 2, 3, 4]) * 1e7}
    goals = {LEAK_RATE: LEAK_RATE, PRESSURE: PRESSURE}
    designs = judged(made([FORCE], columns, goals=goals, design={"optimise": True}), *LEVELS)
    assert designs.best(10) == [1, 0]
    assert designs.left_out == 2
    display = DesignDisplay(designs)
    others, front = plots.pareto_plot(display).data
    assert len(front.x) == 2 and len(others.x) == 0
    course = plots.search_plot(display)
    assert [list(one.x) for one in course.data if one.name == "outside the theory"] == [[2, 3]] * 2
    (small, _) = (one for one in course.data if one.name == "best so far")
    assert small.y[-1] == pytest.approx(3)
    assert "outside the theory: too soft" in display.hover(designs.successes.index, [])[2]
    shown = headings(designs)
    assert "2 designs are left out because their numbers are outside the theory" in shown["Best designs"].note
    assert shown["Best designs"].columns[-1] == "validity"
    assert "without trials that are outside the theory" in shown["Search"].note
    kept = judged(made([FORCE], columns, goals=goals, outside_theory="keep"), *LEVELS)
    assert kept.best(10) == [3, 2, 1, 0] and kept.left_out == 0


def test_constraints_and_theory_are_told_apart():
    designs = judged(
        made([FORCE], FOUR, constraints={"strong": "load.applied_force > 15"}, goals={LEAK_RATE: LEAK_RATE}),
        *LEVELS,
    )
    assert designs.ineligibility == "violate a constraint or are outside the theory"
    good, bad = plots.response_plot(DesignDisplay(designs)).data
    assert len(good.x) == 1 and bad.name == "violates a constraint or outside the theory"
    assert designs.best(10) == [1]
    none = judged(made([FORCE], FOUR, goals={LEAK_RATE: LEAK_RATE}), *["outside the theory"] * 4)
    assert headings(none)["Best designs"].note.startswith("No design is left. 4 designs are left out")


def test_no_class_is_claimed_outside_the_theory():
    tight = {"load.applied_force": [10.0, 20.0, 30.0, 40.0], LEAK_RATE: np.zeros(4)}
    section = headings(judged(made([FORCE], tight), *LEVELS))["Leakage classes"]
    assert {row[-1] for row in section.rows} == {"50 %"}
    assert "Outside the theory no class is stated" in section.note
    assert (
        "2 of them outside the theory"
        in headings(judged(made([FORCE], FOUR), *LEVELS))["Probability by leak rate"].note
    )


def test_a_first_order_index_above_the_total_is_called_noise():
    from dataclasses import replace

    from fem_seal.studies.page import _index_section

    designs = sensitive("sobol-sensitivity")
    (found, *_) = sensitivities(designs)
    clean = replace(found, first=np.array([0.4, 0.1]), total=np.array([0.8, 0.3]))
    assert not clean.noise.any()
    section = _index_section(DesignDisplay(designs), clean)
    assert "noise" not in section.note and not any("noise" in cell for row in section.rows for cell in row)
    noisy = replace(found, first=np.array([0.9, -0.1]), total=np.array([0.8, 0.3]))
    section = _index_section(DesignDisplay(designs), noisy)
    assert [row[1] for row in section.rows] == ["0.9 (noise)", "−0.1 (noise)"]
    assert "sampling noise" in section.note
    assert not replace(noisy, method="morris").noise.any()


def test_designs_that_pass_stand_on_the_first_screen_and_the_limit_in_the_plots():
    angles = [math.pi / 6, math.pi / 4, math.pi / 3]
    seal = {"nominal_size": 0.025, "gas": False, "fluid": "water", "limit_m3_per_s": 2e-9}
    columns = {"seat.angle": angles, LEAK_RATE: [1e-9, 4e-9, 3e-8], "pass_probability": [0.97, 0.4, math.nan]}
    designs = made([ANGLE], columns, seal=seal)
    first = next(sections(designs))
    assert first.heading == "Designs" and [row[0] for row in first.rows] == ["0", "1", "2"]
    display = DesignDisplay(designs)
    words = passing_words(display)
    assert "1 of 3 designs leaks less than" in words and "of 1 it is not known" in words
    figure = plots.response_plot(display)
    (line,) = figure.layout.shapes
    assert line.y0 == line.y1 == pytest.approx(float(display.convert(LEAK_RATE, 2e-9)))
    menu = {button.label: button.args[1] for button in figure.layout.updatemenus[0].buttons}
    lines = [args["shapes"] for args in menu.values()]
    assert [[one["y0"] for one in each] for each in lines] == [[line.y0], [designs.confidence]]
    assert plots.distribution_plot(display).layout.shapes[0].x0 == line.y0
    text = page(designs, {"done": 3, "failed": 0, "open": 0}, [])
    assert text.index("<h2>Designs<") < text.index("<h2>Leak rate over each parameter")
    # a limit that differs from design to design is no line
    varied = made(
        [{**ANGLE, "name": "requirement.leak_rate"}],
        {"requirement.leak_rate": angles, LEAK_RATE: [1e-9] * 3},
        seal=seal,
    )
    assert varied.limit is None
    two = made(
        [ANGLE, FORCE],
        {
            "seat.angle": angles * 2,
            "load.applied_force": [0.0] * 3 + [9.0] * 3,
            LEAK_RATE: [1e-9, 4e-9, 3e-8] * 2,
        },
        seal=seal,
    )
    map_of = plots.plane_plot(DesignDisplay(two))
    assert map_of.data[1].contours.start == map_of.data[1].contours.end


def likely_designs(shares, **about):
    """Two forces at three angles, with how likely each passes."""
    columns = {
        "seat.angle": np.repeat(ANGLE["levels"], 2),
        "load.applied_force": [0.0, 100.0] * 3,
        LEAK_RATE: np.geomspace(1, 100, 6) * ML,
        "pass_probability": shares,
    }
    return made([ANGLE, parameter("load.applied_force", "N", [0.0, 100.0])], columns, **about)


def test_the_map_has_its_line_where_enough_designs_pass():
    shares = [0.2, 0.8, 0.5, 0.9, 0.7, 0.99]
    for text, level in (("pass_probability >= 0.9", 0.9), ("0.8 <= pass_probability", 0.8)):
        designs = likely_designs(shares, constraints={"safe": text})
        line = plots.plane_plot(DesignDisplay(designs)).data[1]
        assert (line.contours.start, line.contours.end) == (level, level)
        # forces in the rows, angles in the columns
        assert np.array(line.z).tolist() == [shares[::2], shares[1::2]]
        assert (
            f"Designs on the red line pass with a probability of {100 * level:.1f} %."
            in headings(designs)["Leak rate over seat angle and applied force"].note
        )
    assert likely_designs(shares).confidence == 0.95


def test_tiny_shares_are_written_as_such_and_no_design_that_passes_is_said(capsys):
    from fem_seal.cli.study import _show_remarks

    designs = likely_designs(
        [2.9e-170, 0.25, 0.1, 0.31, 0.2, 0.9], constraints={"safe": "pass_probability >= 0.95"}
    )
    section = headings(designs)["Designs"]
    assert passing_words(DesignDisplay(designs)).startswith(
        "No design passes with a probability of 95 % or more; the best reaches 90.0 % ("
    )
    cells = [row[section.columns.index("probability to pass")] for row in section.rows]
    assert cells == ["90.0 %", "31.0 %", "25.0 %", "20.0 %", "10.0 %", "< 0.1 %"]
    _show_remarks(designs)
    assert (
        "No design passes with a probability of 95 % or more; the best reaches 90.0 % ("
        in capsys.readouterr().out
    )


def test_a_best_design_at_the_edge_of_a_range_is_told(capsys):
    from fem_seal.cli.study import _show_remarks

    designs = likely_designs([0.5] * 6, goals={LEAK_RATE: LEAK_RATE})
    assert designs.parameters_at_edge == ["seat.angle", "load.applied_force"]
    told = "The best design is at the edge of your range of seat angle and of applied force: try beyond."
    assert headings(designs)["Best designs"].note.endswith(told)
    _show_remarks(designs)
    assert told in capsys.readouterr().out
    # in the middle of one of them; two goals have many best designs
    inside = likely_designs([0.5, 0.5, 0.9, 0.9, 0.5, 0.5], goals={"pass_probability": "-(pass_probability)"})
    assert inside.parameters_at_edge == ["load.applied_force"]
    assert (
        likely_designs([0.5] * 6, goals={LEAK_RATE: LEAK_RATE, "seat.angle": "seat.angle"}).parameters_at_edge
        == []
    )


def test_a_sealed_design_leaves_the_axes_logarithmic_and_stands_below_all_others():
    rates = [0.0, 1e-3 * ML, 1e-2 * ML, 5.0 * ML]
    columns = {"load.applied_force": [200.0, 150.0, 100.0, 0.0], LEAK_RATE: rates}
    designs = made([parameter("load.applied_force", "N", columns["load.applied_force"])], columns)
    display = DesignDisplay(designs)
    assert display.logarithmic(LEAK_RATE) and display.sealed_count == 1
    figure = plots.response_plot(display)
    (points,) = figure.data
    assert figure.layout.yaxis.type == "log" and len(points.y) == 4
    assert 0 < points.y[0] < min(points.y[1:])
    # what is told of it is what it leaks
    assert points.text[0].endswith("]: sealed") and points.hoverinfo == "text"
    assert figure.layout.yaxis.ticktext[0] == "sealed" and figure.layout.yaxis.tickvals[0] == points.y[0]
    (axis,) = [one for one in plots.parallel_plot(display).data[0].dimensions if "leak" in one.label]
    assert axis.ticktext[0] == "sealed" and np.isfinite(axis["values"]).all()
    assert np.isfinite(plots.distribution_plot(display).data[1].x).all()
    assert plots.distribution_plot(display).layout.xaxis.type == "log"
    assert "1 is sealed" in page(designs, {"done": 4, "failed": 0, "open": 0}, [])
    # zeros alone, or beside numbers that fill no decade, ask for no such axis
    flat = made([ANGLE], {"seat.angle": ANGLE["levels"], LEAK_RATE: [0.0, ML, 2.0 * ML]})
    assert not DesignDisplay(flat).logarithmic(LEAK_RATE)


def test_the_map_of_a_study_with_a_sealed_design_has_no_hole():
    designs = likely_designs([0.5] * 6)
    designs.table.loc[0, LEAK_RATE] = 0.0
    map_of = plots.plane_plot(DesignDisplay(designs)).data[0]
    assert np.isfinite(np.array(map_of.z, dtype=float)).all() and map_of.colorbar.ticktext[0] == "sealed"


def test_designs_that_pass_come_first_and_more_than_ten_are_folded():
    shares = [0.96, 0.99, 0.2, 0.5, 0.1, 0.3]
    section = next(sections(likely_designs(shares)))
    assert [row[0] for row in section.rows] == ["1", "0", "3", "5", "2", "4"]
    # a goal decides among those that pass, and a constraint before all
    by_goal = likely_designs(
        shares, goals={"seat.angle": "-(seat.angle)"}, constraints={"low": "load.applied_force < 50"}
    )
    assert by_goal.order == [0, 4, 2, 1, 5, 3]
    many = forces(goals={LEAK_RATE: LEAK_RATE})
    text = page(many, {"done": 40, "failed": 0, "open": 0}, [])
    (folded,) = re.findall(
        r"<details><summary>30 more designs</summary>(.*?)</details>", text, flags=re.DOTALL
    )
    assert folded.count("<tr>") == 31
    assert many.order == list(range(39, -1, -1))


def test_sorting_goes_by_numbers_in_si_and_by_rank():
    designs = judged(made([FORCE], FOUR, goals={LEAK_RATE: LEAK_RATE}), *LEVELS)
    section = headings(designs)["Best designs"]
    assert section.keys[0] == pytest.approx((1, 20.0, 3 * ML, 1))
    assert [keys[-1] for keys in section.keys] == [1, 0, 2, 2]


def test_the_plane_is_that_of_the_parameters_that_matter_through_the_best_design():
    """Of a product of powers the exponents say which matter."""
    grid = np.array(np.meshgrid([1.0, 2.0, 4.0], [1.0, 2.0, 4.0], [1.0, 2.0, 4.0])).reshape(3, -1)
    names = ["closure.radius", "load.applied_force", "seat.land_width"]
    columns = dict(zip(names, grid, strict=True))
    columns[LEAK_RATE] = ML * grid[0] ** 3 * grid[1] ** 0.5 * grid[2] ** -2
    parameters = [parameter(name, "", [1.0, 2.0, 4.0]) for name in names]
    display = DesignDisplay(made(parameters, columns, goals={LEAK_RATE: LEAK_RATE}))
    assert plots.by_influence(display, names) == [names[0], names[2], names[1]]
    chosen, rows = plots.plane(display)
    assert chosen == [names[0], names[2]] and set(display.numbers(names[1]).loc[rows]) == {1.0}
    # without a grid all designs are points, red-edged beyond the limit
    seal = {"nominal_size": 0.025, "gas": False, "fluid": "water", "limit_m3_per_s": 2 * ML}
    (points,) = plots.plane_plot(
        DesignDisplay(made(parameters, columns, seal=seal, design={"kind": "sobol"}))
    ).data
    assert len(points.x) == 27
    assert points.marker.line.color.count(plots.RED) == (columns[LEAK_RATE] > 2 * ML).sum()
