"""Loads that cannot be calculated and steps that fail: they are named, and cost no other result."""

from __future__ import annotations

import csv
import html
import json
import math
import re
from functools import cached_property
from pathlib import Path
from unittest.mock import Mock

import numpy as np
import pandas as pd
import pytest
from places import ROOT
from sample_results import SMOOTH, STEEL, case, cone, rough_result, run_loads, single_result

import fem_seal
from fem_seal.answers.answer import OptionalSteps
from fem_seal.answers.closed_forms import derive
from fem_seal.answers.opening import opening_margin
from fem_seal.case.checks import refused_loads
from fem_seal.cli import app as cli
from fem_seal.cli.terminal import show_result
from fem_seal.errors import ConvergenceError, InputError, NoLoadLeftError, OutputError
from fem_seal.output import files
from fem_seal.output.columns import LEAK_COLUMNS
from fem_seal.output.files import summary
from fem_seal.output.report.page import load_table, report
from fem_seal.seal.findings import not_calculated
from fem_seal.seal.leak_model import FlowModel
from fem_seal.seal.load_result import LoadResult, digits_near_opening
from fem_seal.seal.load_solver import LoadSolver, SolvedLoads
from fem_seal.seal.problem import Loads

# 20 bar lift a closure that touches at 14.142 mm with 1256.64 N.
OPENS = math.pi * case().initial_contact_radius ** 2 * 20e5


def seal(pressures, forces="1 kN", **load):
    return case(load={"fluid_pressure": pressures, "applied_force": forces, "pressure_side": "inner", **load})


def example(folder: Path, load: str) -> Path:
    """The main example with high pressure in the bore."""
    text = (ROOT / "examples" / "ball_cone.toml").read_text()
    path = folder / "case.toml"
    tables = re.split(r"(?=^\[)", text, flags=re.MULTILINE)
    kept = [table for table in tables if not table.startswith("[load]")]
    path.write_text(f'{"".join(kept)}\n[load]\npressure_side = "inner"\n{load}\n')
    return path


# ---------------------------------------------------------------- loads without a contact


def test_open_and_crushing_loads_are_left_out_and_the_others_are_as_if_they_had_never_been():
    mixed = seal(["10 bar", "20 bar", "15 bar", "10 bar"], ["1 kN", "1 kN", "1 kN", "100 MN"])
    result = run_loads(mixed)
    table = result.table
    assert table.fluid_pressure_Pa.tolist() == [10e5, 20e5, 15e5, 10e5]
    assert table.applied_force_N.tolist() == [1e3, 1e3, 1e3, 1e8]
    assert table.validity.tolist()[1::2] == ["not calculated"] * 2
    assert table.validity_reasons.tolist()[1::2] == ["the seal opens", "more than the faces carry"]
    alone = run_loads(seal(["10 bar", "15 bar"])).table
    np.testing.assert_allclose(table.leak_rate_m3_per_s[::2], alone.leak_rate_m3_per_s, rtol=1e-9)
    assert table.leak_rate_m3_per_s[1::2].isna().all() and table.contact_force_N[1::2].isna().all()
    opened, strained = (text for text in result.warnings if text.startswith("not calculated"))
    assert "The seal is open at a fluid pressure of 20 bar" in opened and "above 1256.64 N" in opened
    assert "At 10 bar with 100 MN: a contact force of" in strained and "effective modulus" in strained
    assert [load.hertz is None for load in derive(mixed).loads] == [False, True, False, True]


@pytest.mark.parametrize("details", [False, True])
def test_a_load_without_a_result_stays_a_row_and_stands_in_the_first_line(details, capsys):
    """The loads are told apart by what is given of them, though only one of them has numbers."""
    result = fem_seal.run(
        case(load={"fluid_pressure": "5 bar", "applied_force": ["2 kN", "100 MN"]}, **SMOOTH)
    )
    show_result(result, details=details)
    told = " ".join(capsys.readouterr().out.split())
    assert "5 bar with 2000 N" in told and "; not calculated: 100 MN" in told
    none = "-" if details else "–"
    force = "1.000e+08" if details else "100"
    assert f"{force} {none} {none}" in told
    assert load_table(result).rows[1][2:] == ("–",) * (len(load_table(result).headings) - 2)
    assert [row["applied_force_N"] for row in summary(result)["loads"]] == [2e3, 1e8]
    page = " ".join(html.unescape(re.sub(r"<[^>]+>", " ", report(result))).split())
    assert (
        "2 values from 2000 N to 100 MN" in page
        and "not calculated: 100 MN, more than the faces carry" in page
    )


@pytest.mark.parametrize("closing", ["sealed-area", "penetration"])
def test_the_same_loads_are_left_out_with_every_closing_mode(closing):
    mixed = seal(["5 bar", "20 bar", "10 bar"], ["1 kN", "0 N", "100 MN"], closing=closing)
    assert sorted(problem.kind for problem in refused_loads(mixed).values()) == ["open", "strain"]
    result = run_loads(mixed)
    assert result.table.dropna(subset="leak_rate_m3_per_s").fluid_pressure_Pa.tolist() == [5e5]
    assert sum(text.startswith("not calculated") for text in result.warnings) == 2


@pytest.mark.parametrize("closing", ["sealed-area", "penetration"])
def test_without_a_load_left_there_is_no_result_and_code_3(closing, tmp_path, capsys):
    path = example(
        tmp_path, f'fluid_pressure = ["10 bar", "20 bar"]\napplied_force = "1 N"\nclosing = "{closing}"'
    )
    assert cli.main(["run", "-q", str(path), "-o", str(tmp_path / "out")]) == 3
    said = capsys.readouterr().err
    assert "load.applied_force = 1 N: the seal is open" in said and "Traceback" not in said
    with pytest.raises(InputError):
        fem_seal.run(fem_seal.load_case(path))


@pytest.mark.slow
@pytest.mark.parametrize("size", [None, "25 um"])
def test_a_load_that_does_not_converge_is_tried_on_a_finer_mesh_and_then_left_out(size, monkeypatch):
    solve, tries = LoadSolver.solve, []

    def failing(self, fluid_pressure, applied_force, start=None):
        if fluid_pressure == 5e5:
            tries.append(len(self.model.line.x))
            raise ConvergenceError("residual 1e-3 after 60 iterations")
        return solve(self, fluid_pressure, applied_force, start)

    monkeypatch.setattr(LoadSolver, "solve", failing)
    monkeypatch.setattr(LoadSolver, "pressings", lambda self, settings=None: {})
    mesh = {} if size is None else {"mesh": {"contact_size": size}}
    result = fem_seal.run(case(**mesh))
    assert result.table.dropna(subset="leak_rate_m3_per_s").fluid_pressure_Pa.tolist() == [2e5, 20e5]
    (said,) = [text for text in result.warnings if text.startswith("not calculated")]
    assert said.endswith("no solution was found. At 5 bar: residual 1e-3 after 60 iterations")
    # a mesh whose size the user gives stays as it is
    assert (len(tries) > 1 and tries[1] > tries[0]) == (size is None)


def test_if_no_load_converges_it_is_an_error(monkeypatch):
    monkeypatch.setattr(LoadSolver, "solve", Mock(side_effect=ConvergenceError("residual 1e-3")))
    monkeypatch.setattr(LoadSolver, "pressings", lambda self, settings=None: {})
    with pytest.raises(ConvergenceError, match="residual 1e-3"):
        fem_seal.run(case())


def test_a_path_ends_before_a_load_whose_traces_are_not_known():
    yielding = {
        **STEEL,
        "yield_stress": None,
        "stress_strain": {"plastic_strain": [0, 0.1], "stress": ["0.3 GPa", "0.4 GPa"]},
    }
    path = case(
        seat=cone(yielding),
        load={
            "fluid_pressure": ["5 bar", "100 bar", "60 kbar", "10 bar"],
            "applied_force": ["0 N", "-1 MN", "0 N", "0 N"],
        },
    )
    # an open seal leaves no traces, what crushes the face does
    assert {n: problem.kind for n, problem in refused_loads(path).items()} == {
        1: "open",
        2: "strain",
        3: "path",
    }
    told = [caution.text() for caution in not_calculated(Loads.of(path), refused_loads(path))]
    assert len(told) == 3
    assert "At 10 bar with 0 N: a body that yields depends on its load history" in told[2]


@pytest.mark.slow
def test_a_ring_that_yields_through_keeps_its_row_and_says_so():
    """Free to spread it bears its yield stress times its face, and a load after that is not known."""
    corners = ((25, 0), (30, 0), (30, 3), (25, 3), (25, 0))
    soft = {"plastic_strain": [0], "stress": ["90 MPa"]}
    ring = fem_seal.Case(
        closure={"shape": "disc", "diameter": "90 mm", "material": "steel"},
        gasket={
            "shape": "profile",
            "outline": [{"to": [f"{r} mm", f"{z} mm"]} for r, z in corners],
            "material": {"youngs_modulus": "70 GPa", "poissons_ratio": 0.33, "stress_strain": soft},
        },
        interface={"law": "smooth"},
        load={
            "fluid_pressure": "1 bar",
            "applied_force": ["40 kN", "101 kN", "50 kN"],
            "pressure_side": "inner",
        },
        mesh={"contact_size": "1.2 mm"},
    )
    result = run_loads(ring)
    table = result.table
    assert table.applied_force_N.tolist() == [40e3, 101e3, 50e3]
    assert table.validity.tolist()[1:] == ["not calculated"] * 2
    assert [one.problem.kind for one in result.missing_loads] == ["limit", "path"]
    assert table.validity_reasons[1] == "the gasket yields through"
    assert "101 kN: not calculated, the gasket yields through" in repr(result)
    bears = float(re.search(r"bears ([\d.]+) kN", result.missing_loads[0].problem.message).group(1))
    assert bears == pytest.approx(90e-3 * math.pi * (30**2 - 25**2), rel=2e-3)
    assert [text for text in result.warnings if "the gasket yields through" in text]


def test_loads_without_a_solution_are_named_together_with_the_reason_of_the_first():
    pressures = Loads.of(case(load={"fluid_pressure": ["5 bar", "2 bar", "8 bar"]}))
    failures = {0: ConvergenceError("no luck"), 2: ZeroDivisionError("float division by zero")}
    (said,) = not_calculated(pressures, SolvedLoads((), failures=failures).problems)
    assert said.text() == "not calculated: 5 bar, 8 bar, no solution was found. At 5 bar: no luck"
    assert said.reason() == "not calculated: 5 bar, 8 bar, no solution was found"


# ---------------------------------------------------------------- steps that fail


@pytest.mark.parametrize(
    ("broken", "named"),
    [
        ("accuracy.on_coarser_mesh", "discretisation error"),
        ("accuracy.discretisation_error", "discretisation error"),
        ("accuracy.far_field", "influence of the far field"),
        ("opening.with_margins", "margin to opening"),
        ("variants.interface_variants", "comparison of elastic and plastic interface law"),
        ("findings.contact_cautions", "checks of what the theory allows"),
        ("findings.load_validity", "validity at 2 bar"),
    ],
)
@pytest.mark.usefixtures("unrendered")
def test_a_later_step_that_fails_costs_neither_contact_nor_leak(broken, named, monkeypatch, tmp_path):
    failing = Mock(side_effect=ZeroDivisionError("float division by zero"))
    monkeypatch.setattr(f"fem_seal.answers.{broken}", failing)
    result = fem_seal.run(seal("2 bar"), full=True)
    (said, *_) = [text for text in result.warnings if "could not be calculated" in text]
    assert said.startswith(
        f"{named}: could not be calculated (unexpected ZeroDivisionError: float division by"
    )
    assert np.all(result.table.leak_rate_m3_per_s > 0)
    if broken == "findings.load_validity":
        assert set(result.table.validity) == {"doubtful"}
    failures = files.write(result, tmp_path)
    assert (tmp_path / "leak.csv").is_file() and (tmp_path / "profile.csv").is_file()
    assert failures == (), failures
    assert said in json.loads((tmp_path / "summary.json").read_text())["warnings"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("broken", "named", "lost"),
    [
        ((LoadResult, "largest_stress"), "stress at 2 bar", ["max_von_mises_Pa"]),
        (
            (LoadResult, "critical_separation"),
            "critical separation at 2 bar",
            ["critical_separation_m", "critical_separation_elastic_m"],
        ),
        (
            (LoadResult, "critical_separation"),
            "critical separation of elastic asperities at 2 bar",
            ["critical_separation_elastic_m"],
        ),
        (
            (LoadResult, "leak"),
            "leak rate of elastic asperities at 2 bar",
            ["leak_rate_elastic_m3_per_s"],
        ),
        (
            (FlowModel, "table_around"),
            "flow conductivity",
            [
                "leak_rate_m3_per_s",
                "leak_rate_kg_per_s",
                "leak_rate_elastic_m3_per_s",
                "leak_rate_low_m3_per_s",
                "leak_rate_high_m3_per_s",
                "leak_rate_conserved_m3_per_s",
                "leak_rate_capped_m3_per_s",
                "leak_rate_paper_m3_per_s",
                "leak_rate_corrected_m3_per_s",
                "leak_rate_crests_m3_per_s",
                "leak_rate_per_length_m2_per_s",
                "leak_rate_per_length_kg_per_m_s",
            ],
        ),
    ],
)
def test_a_number_of_a_load_that_fails_costs_no_other(broken, named, lost, monkeypatch, tmp_path):
    works = vars(broken[0])[broken[1]]
    cached = isinstance(works, cached_property)

    def failing(self, *given):
        if "elastic" in named and self.rough.surface.hardness is not None:
            return works.func(self)
        raise ZeroDivisionError("float division by zero")

    whole, value = rough_result().all_columns, cached_property(failing) if cached else failing
    if cached:
        value.__set_name__(*broken)
    monkeypatch.setattr(*broken, value)
    result = fem_seal.run(case(), full=True)
    what = named.removesuffix(" at 2 bar")
    said = [text for text in result.warnings if text.startswith((f"{what}:", f"{what} at"))]
    assert said[0].startswith(f"{named}: could not be calculated (unexpected ZeroDivisionError")
    # each load is named once, a table for all of them
    assert len(said) == (1 if what == named else 3)
    assert result.all_columns[lost].isna().all().all()
    kept = [name for name in LEAK_COLUMNS if name not in lost]
    pd.testing.assert_frame_equal(result.all_columns[kept], whole[kept])
    assert files.write(result, tmp_path) == ()


def test_a_leak_rate_that_fails_costs_no_contact(monkeypatch):
    leak_of = FlowModel.leak_of

    def failing(flow, table, surface, profile, fluid_pressure):
        if fluid_pressure == 5e5:
            raise ZeroDivisionError("float division by zero")
        return leak_of(flow, table, surface, profile, fluid_pressure)

    monkeypatch.setattr(FlowModel, "leak_of", failing)
    result = run_loads(case())
    assert result.table.leak_rate_m3_per_s.isna().tolist() == [False, True, False]
    assert result.table.peak_pressure_Pa.notna().all()
    assert any(text.startswith("leak rate at 5 bar: could not be calculated") for text in result.warnings)


@pytest.mark.slow
def test_stress_that_nobody_can_calculate_costs_neither_contact_nor_leak(monkeypatch, tmp_path):
    """Checks, report and VTK files ask for it as well."""
    from fem_seal.contact import solution

    monkeypatch.setattr(solution, "body_fields", Mock(side_effect=MemoryError))
    result = fem_seal.run(case(load={"fluid_pressure": "20 bar"}))
    assert result.table.max_von_mises_Pa.isna().all() and (result.table.leak_rate_m3_per_s > 0).all()
    assert result.table.validity.tolist() == ["doubtful"]
    files.write(result, tmp_path)
    assert (tmp_path / "leak.csv").is_file() and (tmp_path / "profile.csv").is_file()


@pytest.mark.usefixtures("unrendered")
@pytest.mark.parametrize("broken", ["write_report", "write_contact", "write_unloaded", "write_summary"])
def test_a_file_that_cannot_be_made_costs_no_other(broken, monkeypatch, tmp_path):
    monkeypatch.setattr(files, broken, Mock(side_effect=KeyError("no such picture")))
    result = single_result()
    with pytest.warns(UserWarning, match="could not be calculated"):
        result.write(tmp_path)
    there = {path.name for path in tmp_path.iterdir()}
    wanted = {"leak.csv", "profile.csv", "mesh.msh", "report.html", "summary.json"}
    assert wanted - there <= {{"write_report": "report.html", "write_summary": "summary.json"}.get(broken)}


def test_a_full_disc_and_an_interruption_are_told_to_the_caller():
    steps = OptionalSteps()
    for error in (OutputError("leak.csv: no space left on device"), KeyboardInterrupt()):
        with pytest.raises(type(error)), steps.attempt("report.html"):
            raise error
    assert steps.failures == []


@pytest.mark.slow
def test_a_nearly_sealed_gas_contact_has_a_knudsen_number():
    """The flow is so small that u_eff next to the sealing pressure is no number of the effective medium any more."""
    result = run_loads(
        fem_seal.Case(
            closure={
                "shape": "torus",
                "centre_radius": "21.127298166069988 mm",
                "radius": "5.870442175774845 mm",
                "material": {"youngs_modulus": "534 GPa", "poissons_ratio": 0.22},
            },
            seat={
                "shape": "cone",
                "angle": "48.341103755954244 deg",
                "material": {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3, "hardness": "3.5 GPa"},
            },
            roughness={
                "spectrum": {
                    "kind": "self-affine",
                    "rms_height": "0.0012776070997593415 mm",
                    "hurst": 0.6287635231521382,
                    "q_low": "601.1711272471179 1/m",
                    "q_rolloff": "1799.9781113660677 1/m",
                    "q_high": "69294.90216312007 1/m",
                }
            },
            fluid={"name": "helium"},
            load={
                "fluid_pressure": "15.002543642589812 bar",
                "applied_force": "3155.6872382289393 N",
                "closing": "penetration",
            },
            leak={"theory": "paper"},
        )
    )
    (row,) = result.table.itertuples()
    assert 0 < row.leak_rate_m3_per_s < 1e-25
    assert row.knudsen_number > 1e6


# ---------------------------------------------------------------- distance from opening


def test_on_the_sealed_area_the_margin_is_the_contact_force():
    result = run_loads(seal(["10 bar", "15.5 bar"]))
    far, near = result.loads
    for load in result.loads:
        assert load.opening.force == pytest.approx(load.contact_force, rel=1e-9)
        assert load.opening.pressure == pytest.approx(load.contact_force / (OPENS / 20e5), rel=1e-9)
        assert load.opening.share == pytest.approx(load.contact_force / 1000, rel=1e-9)
    assert (far.digits, near.digits) == (4, 2)
    (said,) = [text for text in result.warnings if "from opening" in text]
    assert said.startswith(
        "2.6 % from opening the seal (at 15.5 bar). 26 N of the applied 1000 N, or 0.42 bar"
    )
    columns = ["opening_margin_N", "opening_margin_Pa", "opening_margin"]
    np.testing.assert_allclose(
        result.table[columns].iloc[1],
        [near.contact_force, near.opening.pressure, near.opening.share],
        rtol=1e-9,
    )


def test_with_penetration_the_margin_is_that_of_the_pressure_that_opens():
    (load,) = run_loads(seal("15.8 bar", closing="penetration")).loads
    assert load.opening.pressure == pytest.approx(load.blow_off_pressure - 15.8e5)
    # what the contact carries is what the spring has left
    assert load.opening.force == pytest.approx(load.contact_force, rel=0.02)


@pytest.mark.parametrize("closing", ["sealed-area", "penetration"])
def test_a_spring_that_lifts_is_held_by_the_fluid(closing):
    load = {"fluid_pressure": ["20 bar"], "applied_force": "-1 kN", "closing": closing}
    (found,) = run_loads(case(load=load)).loads
    assert found.opening.force == pytest.approx(OPENS - 1000, rel=5e-3)
    assert found.opening.pressure == pytest.approx(20e5 * (1 - 1000 / OPENS), rel=5e-3)


def test_nothing_opens_a_seal_that_spring_and_fluid_close():
    assert opening_margin(20e5, 0.0, "outer", edge=-OPENS) is None
    assert opening_margin(20e5, 100.0, "outer", edge=-OPENS) is None
    assert opening_margin(20e5, 100.0, "inner", opens=math.inf) is None
    assert opening_margin(20e5, 100.0, "inner") is None


@pytest.mark.parametrize(
    ("share", "digits"),
    [(2.0, 4), (0.5, 4), (0.1, 3), (0.05, 3), (0.026, 2), (0.01, 2), (0.0024, 1), (0.0, 1)],
)
def test_each_factor_of_ten_costs_a_digit(share, digits):
    assert digits_near_opening(share) == digits


@pytest.mark.slow
def test_near_opening_fewer_digits_are_shown(tmp_path, capsys):
    path = example(tmp_path, 'fluid_pressure = "15.9 bar"\napplied_force = "1 kN"')
    assert cli.main(["run", "--details", str(path), "-o", str(tmp_path / "out")]) == 0
    shown = capsys.readouterr().out
    line, *_ = [line for line in shown.splitlines() if line.strip().startswith("15.90")]
    # 0.97 N of 1000 N are left
    force = next(cell for cell in line.split()[1:] if cell not in "?!")
    assert force == "1.0" or force == "1"
    rate = re.search(r"Leak rate at 15.9 bar: ([\d.]+) ", shown).group(1)
    assert len(rate.strip("0").replace(".", "").strip("0")) == 1
    (row,) = csv.DictReader((tmp_path / "out" / "leak.csv").open())
    assert len(row["contact_force_N"]) > 5


def test_no_load_left_is_an_input_error():
    with pytest.raises(NoLoadLeftError) as caught:
        seal(["20 bar", "30 bar"])
    assert caught.value.key == "load.applied_force"
    assert "30 bar" in str(caught.value)
