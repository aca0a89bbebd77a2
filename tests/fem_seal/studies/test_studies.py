"""Design studies: which designs, what comes out, that nothing is lost, that mistakes are named before work starts."""

import json
import math
import re
import shutil
import sqlite3
from dataclasses import replace
from pathlib import Path
from unittest.mock import Mock

import numpy as np
import pandas as pd
import pytest
from places import EXAMPLES
from sample_results import run_loads

import fem_seal
import leak
from fem_seal import InputError, Study, load_study
from fem_seal.case.case import FILES, with_files
from fem_seal.errors import Problem
from fem_seal.files import own_tables
from fem_seal.output.columns import LEAK_COLUMNS
from fem_seal.output.folders import folder_lock
from fem_seal.output.tables import leak_rows
from fem_seal.sampling import LogNormal, Normal
from fem_seal.seal import sources
from fem_seal.seal.conductivity_tables import family_table
from fem_seal.seal.leak_model import FlowModel
from fem_seal.studies import designs, store, work
from fem_seal.studies.designs_table import pareto_front
from fem_seal.studies.expressions import Constraint, Expression, ExpressionError
from fem_seal.studies.progress import Lines
from fem_seal.studies.responses import evaluate_design
from fem_seal.studies.session import run_study
from fem_seal.studies.tables import Design
from fem_seal.units import Display
from fem_seal.wording import environment
from meshes import Sizing

CASE = EXAMPLES / "ball_cone.toml"

# Coarse elements and an exponential law: the tests are about studies, not about contact.
COARSE = {"mesh.contact_size": "60 um", "load.fluid_pressure": "10 bar"}


LIST = f"""
base = "{CASE}"
changes = {{ load.fluid_pressure = "10 bar" }}
design = {{ kind = "list", file = "designs.csv" }}
"""


def small(**tables):
    """A study of six designs that takes a second."""
    given = {
        "changes": COARSE,
        "parameters": {
            "roughness.spectrum.rms_height": ["1 um", "2 um", "3 um"],
            "load.applied_force": ["0 N", "100 N"],
        },
        "responses": ["peak_pressure_Pa", "leak_rate_m3_per_s"],
    }
    return Study(CASE, **{**given, **tables})


def interrupted_after(count):
    """Calculates so many chunks and no more."""
    done = []

    def calculate(spec, chunk):
        done.append(chunk)
        if len(done) > count:
            raise KeyboardInterrupt
        return work.calculate(spec, chunk)

    return calculate


@pytest.fixture(scope="module")
def calculated(tmp_path_factory):
    study = small(
        derived={"slimness": "peak_pressure_Pa / leak_rate_m3_per_s"},
        constraints={
            "tight": 'leak_rate_m3_per_s < "0.5 ml/s"',
            "half": "roughness.spectrum.rms_height < 2.5e-6",
        },
        report={"goals": {"leak_rate_m3_per_s": "min", "peak_pressure_Pa": "min"}},
    )
    return study, run_study(study, folder=tmp_path_factory.mktemp("study"), workers=0)


# ---------------------------------------------------------------- expressions


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("2 * a - b ** 2 / 4", 2 * 3.0 - 4.0),
        ("max(a, b, 7) + sqrt(b * b)", 11.0),
        ("seat.angle * 180 / pi", 45.0),
        ('a / "1 mm"', 3000.0),
        ('"6 ml/min" * 1e6', 0.1),
        ("-log10(1000) + abs(-1)", -2.0),
    ],
)
def test_expressions_calculate(text, value):
    names = {"a": 3.0, "b": 4.0, "seat.angle": math.pi / 4}
    assert Expression(text)(names) == pytest.approx(value, rel=1e-14)


@pytest.mark.parametrize(
    "text",
    [
        "__import__('os').system('true')",
        "(lambda: 1)()",
        "[a for a in (1, 2)]",
        "a.__class__()",
        "a[0]",
        "a if a else 1",
        "a and b",
        "f'{a}'",
        "max(a)",
        "sqrt(a, a)",
        "sqrt(x=1)",
        "a < 1",
        "'20 parsec'",
        "1 +",
        "a := 2",
        "True + 1",
        "1j",
        "(" * 240 + "1" + ")" * 240,
        "-" * 100 + "1",
        "a" * 600,
        "1e400 ** 'x'",
        "a * 1e400",
        "a / 9**9**9**9",
        "log(-1) + a",
        "a * 1" + "0" * 400,
    ],
)
def test_expressions_refuse_everything_else(text):
    with pytest.raises(ExpressionError):
        Expression(text)


def test_a_share_above_one_is_told_to_be_a_percentage():
    sampled = fem_seal.load_case(CASE).replace(requirement={"leak_rate": "1 ml/min"})
    with pytest.raises(InputError, match=r"a share of at most 1, with 95; write 0\.95 for 95 %"):
        Study(
            sampled,
            parameters={"load.fluid_pressure": ["5 bar", "6 bar"]},
            constraints={"safe": "pass_probability >= 95"},
        )


def test_a_percentage_or_a_bare_quantity_is_told_how_to_be_written():
    for text in ("pass_probability >= 95 %", "leak_rate_m3_per_s < 2 ml/min"):
        with pytest.raises(ExpressionError, match=r'in quotes inside of it, "2 ml/min", and 0.95 for 95 %'):
            Constraint(text)


def test_a_gauge_pressure_varies_as_it_does_in_a_case(tmp_path):
    gas = fem_seal.load_case(CASE).replace(fluid={"name": "nitrogen"})
    study = Study(gas, parameters={"load.fluid_pressure": ["20 barg", "25 bar"]})
    assert study.parameters[0].levels == pytest.approx((20e5, 25e5))
    (tmp_path / "designs.csv").write_text("load.fluid_pressure\n21.01325 bara\n30 barg\n")
    listed = Study(gas, design={"kind": "list", "file": str(tmp_path / "designs.csv")})
    assert listed.parameters[0].levels == pytest.approx((20e5, 30e5))
    # which outlet, each design says
    varied = {"load.fluid_pressure": ["20 bara"], "fluid.outlet_pressure": ["1 bar", "2 bar"]}
    with pytest.raises(InputError, match=r"parameters.load.fluid_pressure = .*absolute pressure"):
        Study(gas, parameters=varied)


def test_undefined_is_nan_and_meets_nothing():
    assert math.isnan(Expression("1 / a")({"a": 0.0}))
    assert math.isnan(Expression("log(a)")({"a": -1.0}))
    assert math.isnan(Expression("a ** 1000")({"a": 10.0}))
    for text in ("min(a, b)", "max(a, b)"):
        # Python's own min and max give the first of them where the other one is NaN
        assert math.isnan(Expression(text)({"a": 1.0, "b": math.nan}))
        assert math.isnan(Expression(text)({"a": math.nan, "b": 1.0}))
    assert not Constraint("min(a, b) < 5").is_met({"a": 1.0, "b": math.nan})
    assert not Constraint("1 / a < 5").is_met({"a": 0.0})
    assert Constraint("1 / a < 5").violation({"a": 0.0}) == math.inf


def test_violation_is_relative_and_changes_sign():
    limit = Constraint('stress < "1 GPa"')
    assert limit.violation({"stress": 2e9}) == pytest.approx(0.5)
    assert limit.violation({"stress": 0.5e9}) == pytest.approx(-0.5)


# ---------------------------------------------------------------- which designs


def test_grid_has_every_combination_the_last_parameter_fastest():
    study = small()
    heights, forces = study.points.T
    assert heights.tolist() == [1e-6, 1e-6, 2e-6, 2e-6, 3e-6, 3e-6]
    assert forces.tolist() == [0, 100] * 3


def test_ranges_are_linear_or_logarithmic():
    study = small(
        parameters={
            "roughness.spectrum.rms_height": {"start": "1 um", "stop": "4 um", "num": 3, "spacing": "log"},
            "seat.angle": {"start": "30 deg", "stop": "60 deg", "num": 4},
        }
    )
    assert study.parameters[0].levels == pytest.approx((1e-6, 2e-6, 4e-6), rel=1e-14)
    assert np.degrees(study.parameters[1].levels) == pytest.approx([30, 40, 50, 60], rel=1e-14)


@pytest.mark.parametrize("kind", ["latin-hypercube", "sobol"])
def test_samples_follow_their_distributions(kind):
    study = small(
        parameters={
            "seat.material.hardness": {"distribution": "lognormal", "median": "3 GPa", "relative": 0.1},
            "fluid.viscosity": {"distribution": "normal", "mean": "1 mPa s", "std": "0.05 mPa s"},
            "load.applied_force": {"distribution": "uniform", "low": "0 N", "high": "100 N"},
        },
        design={"kind": kind, "num": 1024, "seed": 3},
    )
    hardness, viscosity, force = study.points.T
    # stratified samples: means are far better than 1/sqrt(1024); 4 sigma cut off changes them by less than 1e-4
    assert np.log(hardness).mean() == pytest.approx(math.log(3e9), abs=1e-3)
    assert np.log(hardness).std() == pytest.approx(0.1, rel=0.02)
    assert viscosity.mean() == pytest.approx(1e-3, rel=1e-3)
    assert viscosity.std() == pytest.approx(5e-5, rel=0.02)
    assert (force.min() >= 0, force.max() <= 100, force.mean()) == (True, True, pytest.approx(50, rel=5e-3))
    again = small(parameters=study.written["parameters"], design={"kind": kind, "num": 1024, "seed": 3})
    assert np.array_equal(again.points, study.points)


def test_distributions_end_where_they_say():
    for one in (Normal(5.0, 1.0), LogNormal(5.0, 0.2)):
        low, high = one.quantile(np.array([0.0, 1.0]))
        assert (low, high) == pytest.approx(one.bounds)
        assert one.quantile(np.array([0.5]))[0] == pytest.approx(5.0)


def test_sensitivity_designs_have_the_size_of_their_method():
    for kind, count in (("sobol-sensitivity", 8 * (2 + 2)), ("morris", 8 * (2 + 1))):
        assert designs.unit_points(Design(kind=kind, num=8), 2).shape == (count, 2)


def test_morris_stays_in_the_central_part_of_what_has_no_ends():
    study = small(
        parameters={
            "fluid.viscosity": {"distribution": "normal", "mean": "1 mPa s", "std": "0.05 mPa s"},
            "seat.material.hardness": {"distribution": "lognormal", "median": "3 GPa", "relative": 0.1},
            "load.applied_force": {"distribution": "uniform", "low": "0 N", "high": "100 N"},
        },
        design={"kind": "morris", "num": 8},
    )
    viscosity, hardness, force = study.points.T
    # quantile 0.995 of the standard normal distribution
    assert (viscosity.max() - 1e-3) / 5e-5 == pytest.approx(2.5758, rel=1e-4)
    assert np.log(hardness / 3e9).min() / 0.1 == pytest.approx(-2.5758, rel=1e-4)
    assert (force.min(), force.max()) == (0, 100)


def test_list_of_designs_from_csv(tmp_path):
    (tmp_path / "designs.csv").write_text(
        "seat.angle [deg],roughness.spectrum.rms_height,leak.fluid_in_gap\n"
        "30,1.5 um,uncoupled\n45,2 um,local\n30,2 um,uncoupled\n"
    )
    (tmp_path / "study.toml").write_text(LIST)
    study = load_study(tmp_path / "study.toml")
    values = [study.values(point) for point in study.points]
    assert [value["leak.fluid_in_gap"] for value in values] == ["uncoupled", "local", "uncoupled"]
    assert study.case_of(study.points[1]).seat.angle == pytest.approx(math.pi / 4, rel=1e-15)
    assert study.case_of(study.points[0]).roughness.spectrum.rms_height == 1.5e-6


def test_a_part_of_a_library_material_can_be_varied():
    study = small(parameters={"closure.material.youngs_modulus": ["200 GPa", "220 GPa"]})
    assert study.case_of(study.points[1]).closure.material.youngs_modulus == 220e9
    assert study.case_of(study.points[1]).closure.material.poissons_ratio == 0.3


# ---------------------------------------------------------------- mistakes


@pytest.mark.parametrize(
    ("tables", "named"),
    [
        ({"parameters": {"seat.angel": ["30 deg"]}}, ["seat.angel", "seat.angle"]),
        ({"parameters": {"seat.angle": ["30 mm"]}}, ["seat.angle", '"30 mm"', "angle with its unit"]),
        ({"parameters": {"seat.angle": [30]}}, ["seat.angle", "30", "no unit"]),
        ({"parameters": {"seat.angle": ["95 deg"]}}, ["seat.angle", "95 deg", "below 90 deg"]),
        ({"parameters": {"seat.angle": ["30 deg", "30 deg"]}}, ["seat.angle", "twice"]),
        ({"parameters": {"seat.angle": []}}, ["seat.angle", "0 values"]),
        ({"parameters": {}}, ["parameters", "empty"]),
        ({"parameters": {"seat.angle": "30 deg"}}, ["seat.angle", "[changes]"]),
        ({"parameters": {"output.folder": ["a"]}}, ["output.folder", "no entry"]),
        ({"parameters": {"seat.shape": ["cone"]}}, ["seat.shape", "make one study for each"]),
        ({"parameters": {"leak.plasticity": ["true"]}}, ["leak.plasticity", '"true"', "true or false"]),
        ({"parameters": {"interface.law": [True]}}, ["interface.law", "text in quotes"]),
        ({"parameters": {"load.applied_force": [["1 N", "2 N"]]}}, ["load.applied_force", "not a quantity"]),
        ({"parameters": {"interface.p_c": ["1 GPa"]}}, ["interface.p_c", "exponential"]),
        ({"parameters": {"seat.bore_radius": ["18 mm"]}}, ["design 0", "seat.bore_radius", "touch first"]),
        ({"parameters": {"seat.angle": {"start": "30 deg", "num": 3}}}, ["seat.angle", "lacks stop"]),
        (
            {"parameters": {"seat.angle": {"start": "60 deg", "stop": "30 deg", "num": 3}}},
            ["seat.angle.start", "below stop"],
        ),
        ({"design": {"kind": "sobl"}}, ["design.kind", "sobl", '"sobol"']),
        ({"design": {"kind": "sobol"}}, ["design.num", "missing"]),
        ({"design": {"kind": "sobol", "num": 0}}, ["design.num", "out of range"]),
        ({"design": {"kind": "sobol", "num": 4}}, ["levels", "distribution", 'low = "1 µm", high = "3 µm"']),
        ({"design": {"kind": "morris", "num": 1}}, ["design.num = 1", "at least 2"]),
        ({"design": {"kind": "sobol-sensitivity", "num": 1}}, ["design.num = 1", "at least 2"]),
        ({"run": {"keep_fields": [0, 6]}}, ["run.keep_fields = 6", "0 to 5"]),
        ({"run": {"keep_fields": "best"}}, ["run.keep_fields", "goal"]),
        ({"design": {"kind": "list"}}, ["not with design.kind"]),
        ({"design": {"knd": "grid"}}, ["design.knd", "kind"]),
        ({"responses": ["leek_rate"]}, ["responses", "leak_rate_m3_per_s"]),
        ({"responses": ["fwhm_m", "fwhm_m"]}, ["responses", "twice"]),
        (
            {"changes": {**COARSE, "leak.plasticity": False}, "responses": ["leak_rate_p50_m3_per_s"]},
            ["responses", "[uncertainty]"],
        ),
        (
            {"changes": {**COARSE, "leak.plasticity": False}, "responses": ["leak_rate_capped_m3_per_s"]},
            ["responses", "leak.plasticity = true"],
        ),
        ({"derived": {"fwhm_m": "1"}}, ["derived.fwhm_m", "another column"]),
        ({"derived": {"a": "1", "A": "2"}}, ["derived.A", "another column"]),
        ({"derived": {"a b": "1"}}, ["derived.a b", "word"]),
        ({"derived": {"a": "leak_rat_m3_per_s"}}, ["derived.a", "leak_rate_m3_per_s"]),
        ({"derived": {"a": "open('x')"}}, ["derived.a", "unknown function"]),
        ({"constraints": {"a": "fwhm_m"}}, ["constraints.a", "no constraint"]),
        ({"constraints": {"a": 'fwhm_m < "1 MPa"'}}, ["constraints.a", "in m with", "in Pa"]),
        (
            {
                "changes": {**COARSE, "requirement": {"leak_rate": "1 ml/min"}},
                "constraints": {"a": '"1 N" > margin'},
            },
            ["constraints.a", "in N with a plain number"],
        ),
        ({"constraints": {"a": 'load.applied_force < "1 MPa"'}}, ["constraints.a", "in N with", "in Pa"]),
        ({"constraints": {"a": 'leak_rate_kg_per_s < "1 ml/min"'}}, ["constraints.a", "kg/s", "m^3/s"]),
        ({"constraints": {"a": "peak_pressure_Pa < fwhm_m"}}, ["constraints.a", "in Pa with", "in m"]),
        ({"report": {"goals": {"nothing": "min"}}}, ["report.goals.nothing"]),
        ({"changes": {}}, ["20 fluid pressures", "[changes]"]),
        ({"changes": {"load.fluid_presure": "1 bar"}}, ["changes.load.fluid_presure", "fluid_pressure"]),
        ({"optimise": {}}, ["optimise.minimise", "missing"]),
        ({"bogus": 1}, ["bogus", "known keys"]),
        (
            {"changes": {"load.fluid_pressure": "10 bar", "load.applied_force": "1 N"}},
            ["changes.load.applied_force", "parameter as well"],
        ),
        (
            {"parameters": {"seat.angle": ["40 deg"], "seat": {"angle": ["50 deg"]}}},
            ["parameters.seat.angle", "twice"],
        ),
    ],
)
def test_mistakes_are_named_before_any_work(tables, named):
    with pytest.raises(InputError) as error:
        small(**tables)
    for words in named:
        assert words in str(error.value)


def test_a_share_is_compared_with_a_share():
    changes = {
        "load.fluid_pressure": "10 bar",
        "requirement.leak_rate": "1 ml/min",
        "uncertainty.hardness": {"relative": 0.1},
    }
    sampled = fem_seal.load_case(CASE).replace(changes)
    parameters = {"load.applied_force": ["0 N", "100 N"]}
    assert Study(sampled, parameters=parameters, constraints={"a": "pass_probability >= 0.95"}).constraints
    with pytest.raises(InputError, match=r"write 0\.95 for 95 %"):
        Study(sampled, parameters=parameters, constraints={"a": "95 <= pass_probability"})


def test_every_message_is_asked_for_and_every_one_asked_for_is_there():
    files = (Path(fem_seal.__file__).parent / "studies").rglob("*.py")
    code = "\n".join(path.read_text("utf-8") for path in files)
    problems = {name for name in own_tables("problems.toml") if name.startswith("study_")}
    assert set(re.findall(r'problem\(\s*"([^"]+)"', code)) == problems
    notes = re.findall(r'say\([\w.\s]+,\s*"studies",\s*"notes_([^"]+)"', code)
    words = environment(Display()).get_template("answers/studies.j2").module
    assert {f"notes_{note}" for note in notes} == {name for name in vars(words) if name.startswith("notes_")}


def test_a_distribution_that_leaves_the_range_of_its_entry():
    wide = {"seat.angle": {"distribution": "normal", "mean": "80 deg", "std": "5 deg"}}
    with pytest.raises(InputError, match=r'seat\.angle.*reaches "100 deg".*below 90 deg'):
        small(parameters=wide, design={"kind": "sobol", "num": 4})


def test_mistakes_in_files_name_the_file(tmp_path):
    (tmp_path / "study.toml").write_text('base = "no.toml"')
    with pytest.raises(InputError, match=r"no\.toml.*cannot be read"):
        load_study(tmp_path / "study.toml")
    (tmp_path / "study.toml").write_text("title = 'x'")
    with pytest.raises(InputError, match=r"study\.toml: base: is missing"):
        load_study(tmp_path / "study.toml")
    header = "seat.angle [deg],seat.angle [rad]\n1,1\n"
    for content, words in (
        (header, "two columns seat.angle"),
        ("seat.angle [deg]\n", "no designs"),
        ("seat.angle [mm]\n3\n", "row 2"),
        ("seat.angle [deg]\n3,4\n", "row 2 has 2 cells"),
        ("roughness.RA [um]\n3\n", r"do you mean roughness\.Ra\?"),
        ("seat.angel [deg]\n3\n", r'file = "designs.csv": column seat\.angel.*do you mean seat\.angle'),
        ("seat.angle [deg];fluid.viscosity\n3;1 mPa s\n", "designs.csv.*separate the columns by commas"),
        ("the angle\n3\n", r"designs.csv.*such as seat\.angle \[deg\]"),
    ):
        (tmp_path / "designs.csv").write_text(content)
        (tmp_path / "study.toml").write_text(LIST)
        with pytest.raises(InputError, match=words):
            load_study(tmp_path / "study.toml")


def test_a_design_has_one_load(tmp_path):
    base = fem_seal.load_case(CASE).replace(
        {"load.fluid_pressure": ["1 bar", "2 bar"], "load.applied_force": ["10 N", "20 N"]}
    )
    heights = {"roughness.spectrum.rms_height": ["1 um", "2 um"]}
    both = r'2 fluid pressures and 2 applied forces.*"load\.fluid_pressure" = .* and "load\.applied_force" = "0 N"'
    with pytest.raises(InputError, match=both):
        Study(base, parameters=heights)
    for tables in (
        {"parameters": heights, "changes": {"load.fluid_pressure": "10 bar"}},
        {"parameters": {"load.fluid_pressure": ["5 bar", "10 bar"]}},
    ):
        with pytest.raises(
            InputError, match=r'2 applied forces, .* write \[changes\] "load\.applied_force" = "0 N"'
        ):
            Study(base, **tables)
    one = Study(
        base, parameters=heights, changes={"load.fluid_pressure": "10 bar", "load.applied_force": "0 N"}
    )
    varied = Study(
        base, parameters={"load.applied_force": ["1 N"]}, changes={"load.fluid_pressure": "10 bar"}
    )
    assert one.case_of(one.points[0]).load.points == ((1e6, 0.0),)
    assert varied.case_of(varied.points[0]).load.points == ((1e6, 1.0),)


# ---------------------------------------------------------------- what comes out


@pytest.mark.parametrize(
    "changes",
    [
        {"load.fluid_pressure": "10 bar"},
        pytest.param(
            {"load.fluid_pressure": "10 bar", "leak.fluid_in_gap": "local", "interface.law": "exponential"},
            marks=pytest.mark.slow,
        ),
        {"load.fluid_pressure": "3 bar", "fluid": {"name": "helium", "viscosity": None}},
    ],
    ids=["water", "coupled", "helium"],
)
def test_fast_way_gives_the_numbers_of_a_complete_run(changes):
    case = fem_seal.load_case(CASE).replace(changes)
    fast = evaluate_design(case, tuple(LEAK_COLUMNS)).values
    complete = leak_rows(run_loads(case), all_columns=True)[0]
    for name, value in fast.items():
        # another mesh, both within 2e-4 of the limit of small elements; the stress is a maximum over nodes
        tolerance = 1e-2 if name == "max_von_mises_Pa" else 3e-4
        assert value == pytest.approx(complete[name], rel=tolerance, nan_ok=True), name


def test_conductivities_of_a_family_are_those_of_the_surface_itself_up_to_half_its_sealing_pressure():
    spectrum = leak.PowerSpectrum.self_affine(
        rms_height=0.15e-6, hurst=0.8, q_low=1e4, q_rolloff=6e4, q_high=6e6
    )
    surface = leak.RoughContact(spectrum, effective_modulus=115e9, hardness=3.5e9)
    sealing = surface.sealing_pressure
    table = family_table(FlowModel("water", 1e-3), surface)
    p = np.geomspace(1e-7, 0.5, 40) * sealing
    # cubes of u_eff, asked for without any table
    found, own = np.asarray(table.effective_separation(p)) ** 3, surface.effective_separation(p) ** 3
    assert found == pytest.approx(own, rel=7e-4)
    assert found[p < 0.03 * sealing] == pytest.approx(own[p < 0.03 * sealing], rel=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize(
    "changes",
    [
        {"roughness.spectrum.rms_height": "0.5 um"},
        {"roughness.spectrum.rms_height": "4.5 um", "load.fluid_pressure": "2 bar"},
        {"seat.material.hardness": "1.7 GPa", "load.fluid_pressure": "45 bar"},
    ],
)
def test_interpolated_surfaces_are_good_to_some_parts_in_ten_thousand(changes):
    case = fem_seal.load_case(CASE).replace({**COARSE, **changes})
    columns = ("leak_rate_m3_per_s", "leak_rate_capped_m3_per_s", "leak_rate_elastic_m3_per_s")
    shared, alone = (evaluate_design(case, columns, interpolate=way).values for way in (True, False))
    for name in columns[:2]:
        assert shared[name] == pytest.approx(alone[name], rel=5e-4), name
    # elastic asperities scale exactly; what is left are the points of the tables
    assert shared["leak_rate_elastic_m3_per_s"] == pytest.approx(
        alone["leak_rate_elastic_m3_per_s"], rel=3e-5
    )


LAND = CASE.with_name("ball_on_land.toml")


@pytest.mark.slow
def test_designs_with_rounded_edges_share_meshes(monkeypatch):
    case = fem_seal.load_case(LAND)
    columns = ("leak_rate_m3_per_s", "peak_pressure_Pa", "fwhm_m")
    pressures = [f"{pressure} bar" for pressure in (9, 9.5, 10, 10.5, 11, 11.5)]
    made, condense = [], sources.condense
    monkeypatch.setattr(
        sources, "condense", lambda *asked, **known: made.append(asked) or condense(*asked, **known)
    )
    found = [evaluate_design(case.replace({"load.fluid_pressure": one}), columns).values for one in pressures]
    # a size may cross a step once in this range, of six designs with as many spots of their own
    assert 1 <= len(made) <= 2
    monkeypatch.setattr(sources, "round_sizes", lambda sizing, contact, *, exact_size, rounding: sizing)
    own = evaluate_design(case.replace({"load.fluid_pressure": pressures[0]}), columns).values
    for name in columns:
        # what docs/guide/studies.md promises
        assert found[0][name] == pytest.approx(own[name], rel=2e-4), name


def test_spots_are_rounded_down_and_edges_stay_where_they_are():
    contact = fem_seal.load_case(LAND).contact
    (edge, *_), (_, end) = contact.breaks.tolist(), contact.reach
    spots = ((edge, 1.1e-6), (end, 7.3e-6), (1.23e-5, 2.9e-6), (end - 1e-8, 3e-6))
    sizing = Sizing(4e-5, 1e-4, (0.9 * contact.reach[0], end), 0.1, 0.2, 1e-3, spots)
    rounded = sources.round_sizes(sizing, contact)
    (at_edge, fine), (near, size), (beside_end, _), (at_end, _) = sorted(rounded.spots)
    assert (at_edge, at_end) == (edge, end)
    assert 2**-0.25 * 1.1e-6 < fine <= 1.1e-6
    assert abs(near - 1.23e-5) <= 0.5 * size
    assert near / size == pytest.approx(round(near / size), abs=1e-9)
    assert beside_end <= end
    # a neighbour's
    moved = replace(sizing, spots=((edge, 1.12e-6), (end, 7.2e-6), (1.25e-5, 2.92e-6), (end - 1e-8, 2.95e-6)))
    assert sources.round_sizes(moved, contact) == rounded


@pytest.mark.slow
def test_rows_do_not_depend_on_order_or_neighbours(calculated):
    study, result = calculated
    spec = work.DesignSpec.of(study)
    for number in (4, 0, 3):
        (row,) = work.calculate(spec, study.points[number : number + 1])
        assert row.outputs == tuple(result.table.loc[number, study.output_names])


def test_derived_columns_and_constraints(calculated):
    _, result = calculated
    table = result.table
    assert (table["slimness"] == table["peak_pressure_Pa"] / table["leak_rate_m3_per_s"]).all()
    assert table["half"].tolist() == [True] * 4 + [False] * 2
    assert (table["tight"] == (table["leak_rate_m3_per_s"] < 0.5e-6)).all()
    best = result.best()
    assert best["half"].all()
    assert best["leak_rate_m3_per_s"].is_monotonic_increasing
    assert best["peak_pressure_Pa"].is_monotonic_decreasing


def test_pareto_front_by_its_definition():
    goals = np.random.default_rng(5).integers(0, 9, (60, 2)).astype(float)
    beaten = [any(np.all(b <= a) and np.any(b < a) for b in goals) for a in goals]
    assert pareto_front(goals).tolist() == [not one for one in beaten]


def test_a_failed_design_is_a_row_with_its_reason(tmp_path):
    study = small(
        parameters={"seat.bore_radius": ["10 mm", "18 mm"]}, design={"invalid": "skip"}, responses=["fwhm_m"]
    )
    result = run_study(study, folder=tmp_path, workers=0)
    assert result.counts == {"done": 1, "failed": 1, "open": 0}
    assert "touch first" in result.table.loc[1, "reason"]
    assert math.isnan(result.table.loc[1, "fwhm_m"])
    assert "1 failed" in result.report().read_text()


def test_a_load_that_opens_the_seal_is_a_failed_design(tmp_path):
    """With closing = "penetration" that is known only when it has been tried."""
    study = small(
        changes={**COARSE, "load.closing": "penetration", "load.pressure_side": "inner"},
        parameters={"load.applied_force": ["100 N", "2 kN"]},
        responses=["contact_force_N"],
    )
    result = run_study(study, folder=tmp_path, workers=0)
    assert result.table["status"].tolist() == ["failed", "done"]
    assert "the seal is open" in result.table.loc[0, "reason"]


def test_designs_are_grouped_by_bodies_then_surfaces():
    study = small(
        parameters={
            "load.applied_force": {"start": "0 N", "stop": "90 N", "num": 10},
            "roughness.spectrum.rms_height": ["1 um", "2 um"],
            "seat.angle": ["40 deg", "50 deg"],
        }
    )
    every = np.vstack(list(work.chunks(work.DesignSpec.of(study), study.points)))
    assert sorted(map(tuple, every)) == sorted(map(tuple, study.points))
    assert np.count_nonzero(np.diff(every[:, 2])) == 1
    assert np.count_nonzero(np.diff(every[:, 1])) == 3


def test_new_bodies_travel_a_few_at_a_time_and_further_loads_many():
    angles = {"seat.angle": {"start": "30 deg", "stop": "60 deg", "num": 12}}
    loads = {"load.applied_force": {"start": "0 N", "stop": "90 N", "num": 200}}
    bodies, designs_of_one = (
        [len(chunk) for chunk in work.chunks(work.DesignSpec.of(study), study.points)]
        for study in (small(parameters=angles), small(parameters=loads))
    )
    # about a second: a new cone takes a quarter of it, one more load on it some milliseconds
    assert 2 <= max(bodies) <= 5
    assert 50 <= max(designs_of_one) <= 200


def test_keys_depend_on_everything_and_on_nothing_else(tmp_path):
    study = small()
    key = work.DesignSpec.of(study).key(study.points[1])
    assert work.DesignSpec.of(small()).key(study.points[1]) == key
    turned = small(parameters=dict(reversed(list(study.written["parameters"].items()))))
    assert work.DesignSpec.of(turned).key(study.points[1][::-1]) == key
    others = [
        small(changes={**COARSE, "fluid.viscosity": "2 mPa s"}),
        small(responses=["fwhm_m"]),
        small(run={"interpolate_surfaces": False}),
    ]
    assert all(work.DesignSpec.of(one).key(study.points[1]) != key for one in others)
    assert work.DesignSpec.of(study).key(study.points[2]) != key


@pytest.mark.slow
def test_keys_depend_on_the_contents_of_files(tmp_path):
    for name in ("profile_from_drawing.toml", "seat.dxf"):
        shutil.copy(CASE.parent / name, tmp_path)
    drawing = tmp_path / "seat.dxf"

    def keys():
        studies = (
            Study(tmp_path / "profile_from_drawing.toml", parameters={"load.applied_force": ["0 N"]}),
            Study(tmp_path / "profile_from_drawing.toml", parameters={"seat.file": [str(drawing)]}),
        )
        return [work.DesignSpec.of(study).key(study.points[0]) for study in studies]

    before = keys()
    assert keys() == before
    # a comment, which changes no line of the drawing
    drawing.write_text("999\nedited\n" + drawing.read_text())
    assert not set(keys()) & set(before)


@pytest.mark.parametrize("path", sorted(FILES))
def test_every_key_that_names_a_file_stands_for_its_contents(path):
    table = {"form": {"seat": {path: ["a.csv", Path("b.csv")], "waves": 9}}, path: "c.csv", "title": "file"}
    found = with_files(table, lambda named: f"in {named}")
    assert found == {
        "form": {"seat": {path: ["in a.csv", "in b.csv"], "waves": 9}},
        path: "in c.csv",
        "title": "file",
    }


def test_a_trace_in_the_changes_is_looked_for_beside_the_study(tmp_path):
    rows = (f"{angle}, {math.cos(math.radians(2 * angle)):.3f}\n" for angle in range(0, 360, 10))
    (tmp_path / "trace.csv").write_text("angle [deg], height [um]\n" + "".join(rows))
    file = tmp_path / "study.toml"
    file.write_text(
        f'base = "{CASE}"\nresponses = ["peak_pressure_Pa"]\n'
        '[changes]\n"form.seat.trace" = "trace.csv"\n"load.fluid_pressure" = "10 bar"\n'
        '[parameters]\n"load.applied_force" = ["0 N", "100 N"]\n'
    )
    assert load_study(file).case.form.seat.trace is not None


# ---------------------------------------------------------------- storage


def test_nothing_is_changed_or_left_behind_if_nothing_calculates(tmp_path, monkeypatch):
    no_scheduler = Mock(side_effect=InputError(Problem("--scheduler", "there is no dask scheduler")))
    with monkeypatch.context() as patch:
        patch.setattr("fem_seal.studies.session.open_pool", no_scheduler)
        with pytest.raises(InputError, match="no dask scheduler"):
            run_study(small(), folder=tmp_path / "new")
        assert not (tmp_path / "new").exists()
    skipped = {"parameters": {"seat.bore_radius": ["10 mm", "18 mm"]}, "design": {"invalid": "skip"}}
    run_study(small(title="first", **skipped), folder=tmp_path, workers=0)
    monkeypatch.setattr("fem_seal.studies.session.open_pool", no_scheduler)
    with pytest.raises(InputError, match="no dask scheduler"):
        run_study(small(title="second", **skipped), folder=tmp_path, resume=True, retry_failed=True)
    file = store.open_to_read(tmp_path / store.FILE)
    assert (file.about["title"], file.counts()["failed"]) == ("first", 1)
    file.close()


@pytest.mark.slow
def test_true_and_false_stay_what_they_are(tmp_path):
    xr = pytest.importorskip("xarray")
    study = small(
        parameters={"leak.plasticity": [True, False]},
        responses=["leak_rate_m3_per_s", "leak_rate_elastic_m3_per_s"],
        run={"keep_fields": [1]},
    )
    result = run_study(study, folder=tmp_path, workers=0)
    table = result.table
    assert table["leak.plasticity"].dtype == bool
    assert table["leak.plasticity"].tolist() == [True, False]
    assert (table["leak_rate_m3_per_s"] == table["leak_rate_elastic_m3_per_s"]).tolist() == [False, True]
    kept = json.loads((tmp_path / "designs" / "000001" / "summary.json").read_text())
    assert kept["input"]["leak"]["plasticity"] is False
    assert pd.read_csv(result.export(tmp_path / "t.csv"))["leak.plasticity"].tolist() == [True, False]
    assert pd.read_parquet(result.export(tmp_path / "t.parquet"))["leak.plasticity"].dtype == bool
    with xr.open_dataset(result.export(tmp_path / "t.nc")) as data:
        elastic = data["leak_rate_m3_per_s"].sel({"leak.plasticity": False})
        assert float(elastic) == table.loc[1, "leak_rate_m3_per_s"]
    assert result.report().exists()


def test_a_failed_design_has_no_results_to_keep(tmp_path, capsys):
    study = small(
        parameters={"seat.bore_radius": ["10 mm", "18 mm"]},
        design={"invalid": "skip"},
        responses=["fwhm_m"],
        run={"keep_fields": [1]},
    )
    run_study(study, folder=tmp_path, workers=0, progress=Lines())
    assert "design 1 failed" in capsys.readouterr().err
    assert not (tmp_path / "designs").exists()


def test_resuming_calculates_only_what_is_missing(tmp_path, monkeypatch):
    study = small()
    whole = run_study(study, folder=tmp_path / "whole", workers=0).table

    with monkeypatch.context() as patch:
        patch.setattr("fem_seal.studies.pools.calculate", interrupted_after(3))
        with pytest.raises(KeyboardInterrupt):
            run_study(study, folder=tmp_path / "part", workers=0)
    kept = fem_seal.StudyResult(tmp_path / "part")
    assert kept.counts == {"done": 3, "failed": 0, "open": 3}
    with pytest.raises(InputError, match="--resume"):
        run_study(study, folder=tmp_path / "part", workers=0)
    calls = []
    monkeypatch.setattr(
        "fem_seal.studies.pools.calculate", lambda r, c: calls.append(len(c)) or work.calculate(r, c)
    )
    resumed = run_study(study, folder=tmp_path / "part", workers=0, resume=True)
    assert sum(calls) == 3
    pd.testing.assert_frame_equal(resumed.table, whole, check_exact=True)


@pytest.mark.parametrize(
    "force",
    [
        ["2 kN", "3 kN"],
        {"start": "1 kN", "stop": "3 kN", "num": 3},
        {"distribution": "normal", "mean": "2 kN", "std": "10 N"},
    ],
)
def test_changes_may_need_what_the_parameters_bring(force):
    """Fluid in the bore lifts the ball of the base case; the spring that holds it is what the study varies."""
    changes = {**COARSE, "load.pressure_side": "inner"}
    sampled = isinstance(force, dict) and "distribution" in force
    design = {"kind": "sobol", "num": 4} if sampled else {"kind": "grid", "invalid": "skip"}
    study = small(changes=changes, parameters={"load.applied_force": force}, design=design)
    assert study.case_of(study.points[-1]).load.applied_force > 1.9e3
    with pytest.raises(InputError, match=r"changes\.load\.applied_force = 0 N: the seal is open"):
        small(changes=changes, parameters={"load.applied_force": ["1 N", "2 N"]})


def test_failed_designs_are_calculated_again_on_request_alone(tmp_path, monkeypatch):
    study = small()

    def first_fails(spec, chunk):
        row, *others = work.calculate(spec, chunk)
        return [replace(row, reason="out of memory", outputs=(None,) * len(row.outputs)), *others]

    with monkeypatch.context() as patch:
        patch.setattr("fem_seal.studies.pools.calculate", first_fails)
        failed = run_study(study, folder=tmp_path / "part", workers=0).counts["failed"]
    assert failed > 0
    assert run_study(study, folder=tmp_path / "part", workers=0, resume=True).counts["failed"] == failed
    repaired = study.run(folder=tmp_path / "part", workers=0, resume=True, retry_failed=True)
    whole = run_study(study, folder=tmp_path / "whole", workers=0)
    pd.testing.assert_frame_equal(repaired.table, whole.table, check_exact=True)


def test_a_larger_study_uses_the_rows_that_are_there(tmp_path):
    run_study(small(), folder=tmp_path, workers=0)
    larger = small(
        parameters={
            "roughness.spectrum.rms_height": ["1 um", "2 um", "3 um"],
            "load.applied_force": ["100 N", "200 N"],
        }
    )
    result = run_study(larger, folder=tmp_path, workers=0, resume=True)
    assert len(result.table) == 6
    with sqlite3.connect(tmp_path / store.FILE) as file:
        assert file.execute("SELECT COUNT(*) FROM point").fetchone() == (9,)


def test_another_study_is_not_mixed_in(tmp_path):
    run_study(small(), folder=tmp_path, workers=0)
    with pytest.raises(InputError, match="other columns"):
        run_study(small(responses=["fwhm_m"]), folder=tmp_path, workers=0, resume=True)
    with folder_lock(tmp_path), pytest.raises(InputError, match="another fem-seal process"):
        run_study(small(), folder=tmp_path, workers=0, resume=True)


@pytest.mark.slow
def test_complete_results_of_chosen_designs_are_kept(tmp_path):
    study = small(run={"keep_fields": "best"}, report={"goals": {"leak_rate_m3_per_s": "max"}})
    result = run_study(study, folder=tmp_path, workers=0)
    (kept,) = (tmp_path / "designs").iterdir()
    number = int(kept.name)
    assert number == result.table["leak_rate_m3_per_s"].idxmax()
    assert (kept / "contact.pvd").exists()
    row = pd.read_csv(kept / "leak.csv").iloc[0]
    assert row["leak_rate_m3_per_s"] == pytest.approx(
        result.table.loc[number, "leak_rate_m3_per_s"], rel=5e-4
    )
    # results of a design that had the number before are replaced, those that belong to it stay
    mark = kept / "design.json"
    written = mark.read_text()
    mark.write_text(written.replace(json.loads(written)["key"], "another"))
    run_study(study, folder=tmp_path, workers=0, resume=True)
    assert mark.read_text() == written
    renewed = mark.stat().st_mtime_ns
    run_study(study, folder=tmp_path, workers=0, resume=True)
    assert mark.stat().st_mtime_ns == renewed


@pytest.mark.slow
def test_exports_hold_the_table(calculated, tmp_path):
    xr = pytest.importorskip("xarray")
    _, result = calculated
    csv = pd.read_csv(result.export(tmp_path / "t.csv"), index_col="number")
    parquet = pd.read_parquet(result.export(tmp_path / "t.parquet"))
    assert csv["leak_rate_m3_per_s"].tolist() == result.table["leak_rate_m3_per_s"].tolist()
    pd.testing.assert_frame_equal(parquet, result.table, check_dtype=False)
    with xr.open_dataset(result.export(tmp_path / "t.nc")) as data:
        assert dict(data.sizes) == {"roughness.spectrum.rms_height": 3, "load.applied_force": 2}
        cell = data["leak_rate_m3_per_s"].sel(
            {"roughness.spectrum.rms_height": 2e-6, "load.applied_force": 100.0}
        )
        assert float(cell) == result.table.loc[3, "leak_rate_m3_per_s"]
        assert data["load.applied_force"].attrs["units"] == "N"
    with pytest.raises(InputError, match=r"\.csv, \.parquet, \.nc"):
        result.export(tmp_path / "t.xls")


# ---------------------------------------------------------------- page, search, command line


def test_the_page_needs_nothing_but_itself(calculated):
    _, result = calculated
    text = result.report().read_text()
    # the plotting library itself holds addresses of maps, which nothing on the page asks for
    page = re.sub(r"<script>/\*\*.*?</script>", "", text, count=1, flags=re.DOTALL)
    assert len(text) - len(page) > 1e6
    assert not re.search(r"(?:src|href)\s*=", page)
    for heading in (
        "Best designs",
        "Pareto front",
        "Parameters and results side by side",
        "Leak rate over rms height and applied force",
        "Leak rate over each parameter",
        "Leakage classes",
    ):
        assert f"<h2>{heading}</h2>" in page


@pytest.mark.slow
def test_sensitivity_finds_the_parameter_that_matters(tmp_path):
    study = small(
        parameters={
            "fluid.viscosity": {"distribution": "lognormal", "median": "1 mPa s", "relative": 0.3},
            "load.applied_force": {"distribution": "uniform", "low": "0 N", "high": "1 N"},
        },
        design={"kind": "sobol-sensitivity", "num": 64},
        responses=["leak_rate_m3_per_s"],
    )
    result = run_study(study, folder=tmp_path, workers=0)
    from fem_seal.studies.designs_table import Designs, sensitivities

    file = store.open_to_read(tmp_path / store.FILE)
    (found,) = sensitivities(Designs.read(file))
    file.close()
    # Q goes like 1/viscosity, and one newton in six hundred does nothing
    assert found.total[0] == pytest.approx(1, abs=0.1)
    assert abs(found.total[1]) < 0.01
    assert "Sensitivity of leak rate" in result.report().read_text()


def search(title="", **optimise):
    return small(
        title=title,
        parameters={
            "load.applied_force": {"distribution": "uniform", "low": "0 N", "high": "400 N"},
            "interface.law": ["spectrum"],
        },
        constraints={"soft": 'peak_pressure_Pa < "35 MPa"'},
        optimise={"minimise": "leak_rate_m3_per_s", "trials": 10, "batch": 3, **optimise},
    )


@pytest.mark.slow
def test_a_search_stays_within_its_constraint_and_resumes(tmp_path, monkeypatch):
    whole = run_study(search(), folder=tmp_path / "whole", workers=0)
    best = whole.best(1).iloc[0]
    assert best["peak_pressure_Pa"] < 35e6
    feasible = whole.table[whole.table["soft"]]
    assert best["leak_rate_m3_per_s"] == feasible["leak_rate_m3_per_s"].min()

    with monkeypatch.context() as patch:
        patch.setattr("fem_seal.studies.pools.calculate", interrupted_after(4))
        with pytest.raises(KeyboardInterrupt):
            run_study(search(), folder=tmp_path / "part", workers=0)
    resumed = run_study(search(), folder=tmp_path / "part", workers=0, resume=True)
    pd.testing.assert_frame_equal(resumed.table, whole.table, check_exact=True)
    with pytest.raises(InputError, match="search for something else"):
        run_study(search("refused", seed=2), folder=tmp_path / "part", workers=0, resume=True)
    other = search("refused")
    other.case = other.case.replace({"fluid.viscosity": "2 mPa s"})
    with pytest.raises(InputError, match="search for something else"):
        run_study(other, folder=tmp_path / "part", workers=0, resume=True)
    file = store.open_to_read(tmp_path / "part" / store.FILE)
    assert file.about["title"] != "refused"
    file.close()
    with pytest.raises(InputError, match="learns from its failures"):
        run_study(search(), folder=tmp_path / "part", workers=0, resume=True, retry_failed=True)


def test_command_line(tmp_path, capsys):
    from fem_seal.cli.app import main

    (tmp_path / "study.toml").write_text(
        f'base = "{CASE}"\nresponses = ["peak_pressure_Pa"]\n'
        '[changes]\nload.fluid_pressure = "10 bar"\nmesh.contact_size = "60 um"\n'
        '[parameters]\nload.applied_force = ["0 N", "100 N"]\n[report]\ngoals = { peak_pressure_Pa = "min" }\n'
    )
    folder = tmp_path / "out"
    arguments = ["study", str(tmp_path / "study.toml"), "-o", str(folder), "--workers", "0", "--json"]
    assert main(arguments) == 0
    told = json.loads(capsys.readouterr().out)
    assert (told["done"], told["failed"], told["best"][0]["load.applied_force"]) == (2, 0, 0.0)
    assert main(arguments) == 2
    assert "--resume" in capsys.readouterr().err
    assert main([*arguments, "--resume"]) == 0
    (folder / "report.html").unlink()
    assert main(["study", "report", str(folder)]) == 0
    assert (folder / "report.html").exists()
    assert main(["study", "export", str(folder), str(tmp_path / "t.csv")]) == 0
    assert main(["study", "report", str(tmp_path)]) == 2
    assert "holds no study" in capsys.readouterr().err


def test_a_study_of_which_no_design_can_be_calculated_says_so_to_a_script(tmp_path, capsys):
    from fem_seal.cli.app import main

    study = tmp_path / "study.toml"
    study.write_text(
        f'base = "{CASE}"\nresponses = ["fwhm_m"]\n[changes]\nload.fluid_pressure = "10 bar"\n'
        '[parameters]\nseat.bore_radius = ["18 mm", "18.5 mm"]\n[design]\ninvalid = "skip"\n'
    )
    assert main(["study", str(study), "--workers", "0", "--quiet"]) == 3
    told = capsys.readouterr().err
    assert "touch first" in told
    assert f"error: {study}: none of its designs can be calculated" in told
    assert (tmp_path / "study.study" / "report.html").exists()


def test_a_study_in_a_few_lines():
    result = Study(
        CASE,
        changes=COARSE,
        parameters={"load.applied_force": ["0 N", "50 N"]},
        responses=["line_load_N_per_m"],
    ).run(workers=0)
    assert result.table["line_load_N_per_m"].is_monotonic_increasing
    folder = result.folder
    assert folder.exists()
    del result
    assert not folder.exists()


FINDINGS = {
    # more roughness leaks more at every angle
    "angle_and_roughness.toml": lambda table: all(
        part["leak_rate_m3_per_s"].is_monotonic_increasing for _, part in table.groupby("seat.angle")
    ),
    # a surface that is known leaves an uncertainty of some ten per cent, not of orders of magnitude
    "measured_surface.toml": lambda table: 0.03 < np.log(table["leak_rate_m3_per_s"]).std() < 0.5,
    # narrow and steep leaks least, but yields: the best allowed land is the one that uses most of the strength
    "conical_land.toml": lambda table: (
        not table["strength"][table["leak_rate_m3_per_s"].idxmin()]
        and table["leak_rate_m3_per_s"][table["strength"]].idxmin()
        == table["max_von_mises_Pa"][table["strength"]].idxmax()
    ),
    # at each angle a smaller ball passes more often, and one of nine designs does so often enough
    "passing_seats.toml": lambda table: (
        all(
            part["pass_probability"].is_monotonic_decreasing
            for _, part in table.sort_values("closure.radius").groupby("seat.angle")
        )
        and (table["pass_probability_error"] <= 0.02).all()
        and table.index[table["safe"]].tolist() == [0]
    ),
    # no form error makes a seal tighter, and the round seat is the same in all of the batch
    "batch_of_seats.toml": lambda table: (
        (table["leak_rate_m3_per_s"] > table["leak_rate_round_m3_per_s"]).all()
        and table["line_load_min_over_mean"].between(0, 1).all()
        and np.ptp(table["leak_rate_round_m3_per_s"]) < 1e-2 * table["leak_rate_round_m3_per_s"].mean()
    ),
}


def test_every_example_is_checked():
    assert {path.name for path in (CASE.parent / "studies").glob("*.toml")} == set(FINDINGS)


@pytest.mark.slow
@pytest.mark.parametrize("name", FINDINGS)
def test_example(name, tmp_path):
    result = run_study(load_study(CASE.parent / "studies" / name), folder=tmp_path, workers=0)
    assert result.counts["failed"] == result.counts["open"] == 0
    assert FINDINGS[name](result.table)
    assert result.report().stat().st_size > 1e6


def test_every_key_of_a_study_file_is_documented():
    text = (CASE.parent.parent / "docs" / "guide" / "studies.md").read_text()
    from fem_seal.case.notation import tables_of
    from fem_seal.studies.tables import StudyTables

    for key, field in StudyTables.model_fields.items():
        assert f"`{key}`" in text or f"`[{key}]`" in text
        for table in tables_of(field):
            for inner in table.model_fields:
                assert f"`{inner}`" in text, f"{key}.{inner}"


def test_formulas_know_columns_without_their_unit_as_results_do():
    study = small(
        responses=["leak_rate", "peak_pressure_Pa"],
        derived={"share": "leak_rate / leak_rate_elastic", "twice": "2 * share"},
        constraints={"gentle": 'peak_pressure < "1 GPa"'},
        report={"goals": {"leak_rate": "min", "share": "max"}},
    )
    assert {"leak_rate_m3_per_s", "peak_pressure_Pa", "leak_rate_elastic_m3_per_s"} <= set(study.responses)
    assert study.derived["share"].text == "leak_rate_m3_per_s / leak_rate_elastic_m3_per_s"
    assert study.constraints["gentle"].text == 'peak_pressure_Pa < "1 GPa"'
    assert list(study.goals) == ["leak_rate_m3_per_s", "share"]
    # the same quantity is compared in its unit
    with pytest.raises(InputError, match="compares a quantity in Pa with a quantity in N"):
        small(constraints={"gentle": 'peak_pressure < "1 N"'})
    # a derived column of that name is meant where there is one
    own = small(derived={"margin_of_mine": "leak_rate * 2", "leak_rate": "3 * margin_of_mine"})
    assert own.derived["leak_rate"].text == "3 * margin_of_mine"
