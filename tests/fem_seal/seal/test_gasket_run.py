"""Gaskets that are solved: as the same seat, as Hertz says, and in all that follows from their leak rate."""

from __future__ import annotations

import csv
import math
from copy import deepcopy
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import leak
from fem_seal import Case, SealResult, run
from fem_seal.answers.answer import Request, loads_of
from fem_seal.answers.case_load import SolvedSeal
from fem_seal.answers.compression import COMPRESSION
from fem_seal.answers.target import contacts_at_target
from fem_seal.contact.plastic_step import press
from fem_seal.errors import InputError, LimitLoadError
from fem_seal.output.report.page import report
from fem_seal.seal.evaluate import SILENT, Evaluation, evaluate
from fem_seal.seal.problem import SealProblem
from fem_seal.studies.study import Study

STEEL = {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3, "hardness": "3 GPa"}
COPPER = {
    "youngs_modulus": "120 GPa",
    "poissons_ratio": 0.34,
    "hardness": "0.8 GPa",
    "stress_strain": {"plastic_strain": [0, 0.02, 0.1], "stress": ["60 MPa", "120 MPa", "220 MPa"]},
}
SURFACE = {"kind": "self-affine", "rms_height": "0.5 um", "hurst": 0.8}
SURFACE |= {"q_low": "5e3 1/m", "q_rolloff": "5e4 1/m", "q_high": "3e6 1/m"}
DISC = {"shape": "disc", "diameter": "60 mm", "material": STEEL}
# half a ring of 4 mm on a plate 0.2 mm thick, as it was before there were gaskets
HALF = [
    {"to": ["18 mm", "0 mm"]},
    {"to": ["22 mm", "0 mm"]},
    {"to": ["22 mm", "0.2 mm"]},
    {"to": ["20 mm", "2.2 mm"], "centre": ["20 mm", "0.2 mm"]},
    {"to": ["18 mm", "0.2 mm"], "centre": ["20 mm", "0.2 mm"]},
    {"to": ["18 mm", "0 mm"], "name": "inner"},
]


def tables(material: dict[str, Any] = STEEL, **others: Any) -> dict[str, Any]:
    found = {
        "closure": DISC,
        "gasket": {"shape": "ring", "mean_diameter": "40 mm", "section_diameter": "4 mm"},
        "roughness": {"spectrum": SURFACE},
        "fluid": {"name": "helium"},
        "load": {"fluid_pressure": "1 bar", "applied_force": ["2 kN", "4 kN"], "pressure_side": "inner"},
        "mesh": {"contact_size": "12 um"},
    }
    found = {**found, **deepcopy(others)}
    for name in ("gasket", "seat"):
        if found.get(name):
            found[name] = {"material": material, **found[name]}
    return {name: table for name, table in found.items() if table is not None}


def solved(given: dict[str, Any]) -> Evaluation:
    return evaluate(SealProblem.of(Case(**given)))


@cache
def elastic() -> SealResult:
    return run(tables(requirement={"leak_rate": "1e-3 mbar l/s"}))


@pytest.mark.slow
@pytest.mark.parametrize("material", [STEEL, COPPER], ids=["elastic", "yielding"])
def test_a_gasket_is_twice_the_seat_of_its_half(material: dict[str, Any]) -> None:
    loads = {"fluid_pressure": "1 bar", "applied_force": ["2 kN", "1 kN"], "pressure_side": "inner"}
    seat = solved(tables(material, gasket=None, seat={"shape": "profile", "outline": HALF}, load=loads))
    gasket = solved(tables(material, gasket={"shape": "profile", "outline": HALF}, load=loads))
    for one, two in zip(seat.loads, gasket.loads, strict=True):
        assert two.peak_pressure == pytest.approx(one.peak_pressure, rel=1e-9)
        assert two.contact.approach == pytest.approx(one.contact.approach, rel=1e-9)
        assert one.leak is not None and two.leak is not None
        assert two.leak.leak_rate == pytest.approx(2 * one.leak.leak_rate, rel=1e-12)
        assert two.leak.mass_flow == pytest.approx(2 * one.leak.mass_flow, rel=1e-12)
        assert two.leak.resistance == pytest.approx(one.leak.resistance / 2, rel=1e-12)


def test_a_round_ring_is_the_drawing_of_its_section() -> None:
    corners = [[20, -2], [22, 0], [20, 2], [18, 0], [20, -2]]
    outline = [{"to": [f"{r} mm", f"{z} mm"], "centre": ["20 mm", "0 mm"]} for r, z in corners]
    del outline[0]["centre"]
    drawn = solved(tables(gasket={"shape": "profile", "outline": outline}))
    ring = solved(tables())
    for one, two in zip(ring.loads, drawn.loads, strict=True):
        assert two.peak_pressure == pytest.approx(one.peak_pressure, rel=1e-3)
        assert two.contact.approach == pytest.approx(one.contact.approach, rel=1e-3)


def test_a_thin_ring_presses_as_hertz_says() -> None:
    """Half-width and peak of a line contact; the approach grows with f ln f.

    Of half a cylinder, plane strain, delta = f (1 - nu^2)/(pi E) (2 ln(4R/a) - 1) with a^2 in proportion to f (K. L.
    Johnson, Contact Mechanics, eq. 5.57): delta/f falls by (1 - nu^2)/(pi E) for each e-fold of f, and as much in the
    flange, whatever their sizes.
    """
    forces = [1e3, 2e3, 4e3]
    load = {"fluid_pressure": "1 mbar", "applied_force": [f"{one} N" for one in forces]}
    given = tables(roughness=None, fluid=None, interface={"law": "smooth"}, load=load)
    del given["mesh"]
    found = solved(given)
    modulus = 210e9 / (1 - 0.3**2) / 2
    for one in found.loads:
        f = one.line_load
        half_width = math.sqrt(4 * f * 2e-3 / (math.pi * modulus))
        assert one.peak_pressure == pytest.approx(2 * f / (math.pi * half_width), rel=5e-3)
        assert one.tightest.fwhm == pytest.approx(math.sqrt(3) * half_width, rel=5e-3)
    f = np.array([one.line_load for one in found.loads])
    compliance = np.array([one.contact.approach for one in found.loads]) / f
    slope = np.diff(compliance) / np.diff(np.log(f))
    assert slope == pytest.approx(-2 * (1 - 0.3**2) / (math.pi * 210e9) * np.ones(2), rel=0.03)


@pytest.mark.slow
def test_contacts_and_compression_are_written(tmp_path: Path) -> None:
    result = elastic()
    result.write(tmp_path)
    with (tmp_path / "contacts.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [row["contact"] for row in rows] == ["closure", "seat"] * 2
    for number, load in enumerate(result.loads):
        both = rows[2 * number : 2 * number + 2]
        assert sum(float(row["leak_rate_m3_per_s"]) for row in both) == pytest.approx(load.leak.leak_rate)
        assert float(both[0]["upstream_pressure_Pa"]) - float(both[0]["downstream_pressure_Pa"]) == 1e5
    with (tmp_path / "compression.csv").open() as file:
        steps = list(csv.DictReader(file))
    assert [int(step["load_step"]) for step in steps] == [1, 2]
    for step, load in zip(steps, result.loads, strict=True):
        assert float(step["compression_m"]) == pytest.approx(2 * load.contact.approach, rel=1e-9)
    assert (tmp_path / "report.html").exists()


@pytest.mark.slow
def test_report_and_warnings_speak_of_gasket_and_flange() -> None:
    result = elastic()
    page = report(result, full=True)
    assert "Compression of the gasket" in page and "springs back" in page
    assert "flange, radius" in page or "flange, diameter" in page
    assert "seat, outer wall" not in page and "Rollers" not in page
    assert [one for one in result.warnings if "without friction" in one]
    assert not [one for one in result.warnings if "could not be calculated" in one]
    assert not [one for one in result.warnings if " seat" in one or "closure" in one]
    assert "Material of gasket" in page or "Material of flange and gasket" in page


@pytest.mark.slow
def test_the_verdict_judges_both_faces() -> None:
    result = elastic()
    leak_rate = result.loads[-1].leak.leak_rate
    assert result.judgement is not None
    once = result.problem.flow
    assert once is not None and once.faces == 2
    one_face = replace(result.loads[-1].rough, flow=replace(once, faces=1))
    assert one_face.leak(result.loads[-1].tightest, 1e5).leak_rate == pytest.approx(leak_rate / 2, rel=1e-12)


def test_a_yielding_ring_springs_back_by_less_than_it_was_pressed() -> None:
    loads = {"fluid_pressure": "1 bar", "applied_force": ["3 kN", "1.5 kN"], "pressure_side": "inner"}
    others = {
        "roughness": None,
        "fluid": None,
        "interface": {"law": "smooth"},
        "mesh": {"contact_size": "8 um"},
    }
    given = tables(COPPER, load=loads, **others)
    found, case = solved(given), Case(**given)
    compression = COMPRESSION.compute(
        SolvedSeal.of([found], case, loads_of([found])), Request(found.solver, SILENT)
    )
    loaded, partly, free = compression.steps
    assert (loaded.load_step, partly.load_step, free.load_step) == (1, 2, 3)
    assert loaded.compression > partly.compression > free.compression == compression.left > 0
    assert free.line_load == 0.0
    # unloading is elastic and stiff at first: the second half of the force gives more way than the first
    assert partly.compression - free.compression > loaded.compression - partly.compression
    assert compression.springback == pytest.approx(loaded.compression - free.compression)


@pytest.mark.slow
def test_the_force_for_a_target_of_a_yielding_ring_is_found_on_one_path(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    steps = 0

    def counted(*args: Any, **others: Any) -> Any:
        nonlocal steps
        steps += 1
        return press(*args, **others)

    load = {"fluid_pressure": "1 bar", "applied_force": "2 kN", "pressure_side": "inner"}
    given = tables(COPPER, load=load, mesh={"contact_size": "16 um"})
    (own,) = solved(given).loads
    assert own.leak is not None
    target = 0.7 * own.leak.leak_rate
    monkeypatch.setattr("fem_seal.contact.load_path.press", counted)
    problem = SealProblem.of(Case(**given))
    (found,) = contacts_at_target([problem], target)
    assert found.leak is not None and found.leak.leak_rate == pytest.approx(target, rel=1e-5)
    # one path of 16 steps on each mesh, and a step or two for each force
    assert steps < 60
    again = deepcopy(given)
    again["load"]["applied_force"] = f"{found.applied_force!r} N"
    (alone,) = solved(again).loads
    assert alone.leak is not None and alone.leak.leak_rate == pytest.approx(target, rel=5e-3)
    # beyond small strains: what was reached
    with pytest.raises(InputError, match=r"a contact force of .* leaves .* at 1 bar, and") as caught:
        contacts_at_target([problem], 1e-30)
    assert caught.value.key == "load.target_leak_rate"


def test_grooves_leak_over_both_faces() -> None:
    form = {"scratches": [{"depth": "3 um", "width": "30 um"}]}
    load = {"fluid_pressure": "1 bar", "applied_force": "2 kN", "pressure_side": "inner"}
    half = {"shape": "profile", "outline": HALF}
    seat = solved(tables(gasket=None, seat=half, load=load, form=form)).loads[0]
    gasket = solved(tables(gasket=half, load=load, form=form)).loads[0]
    assert gasket.leak.leak_rate == pytest.approx(2 * seat.leak.leak_rate, rel=1e-9)
    for one, two in zip(seat.around.bounds, gasket.around.bounds, strict=True):
        assert two.extra == pytest.approx([2 * each for each in one.extra], rel=1e-9)
        assert isinstance(two.lower, leak.LeakResult)


@pytest.mark.slow
def test_a_study_over_the_section_of_a_ring(tmp_path: Path) -> None:
    study = Study(
        {
            "base": tables(load={"fluid_pressure": "1 bar", "applied_force": "2 kN"}),
            "parameters": {"gasket.section_diameter": ["4 mm", "6 mm"]},
            "responses": ["leak_rate_m3_per_s", "peak_pressure_Pa"],
        }
    )
    table = study.run(folder=tmp_path / "study", workers=0).table
    thin, thick = table["peak_pressure_Pa"]
    # between Hertz (R^-1/2) and a layer of asperities, which spreads the pressure
    assert 1.0 < thin / thick < math.sqrt(1.5)
    single = solved(tables(load={"fluid_pressure": "1 bar", "applied_force": "2 kN"})).loads[0]
    assert table["leak_rate_m3_per_s"][0] == pytest.approx(single.leak.leak_rate, rel=5e-3)


@pytest.mark.slow
def test_the_live_page_shows_what_a_run_gives() -> None:
    from fem_seal.explore.session import Session

    session = Session(Case(**tables()))
    assert {"gasket_mean_diameter", "gasket_section_diameter"} <= {one.key for one in session.factors.sliders}
    for number, load in enumerate(session.answer({}).loads):
        assert load.values["leak_rate_m3_per_s"] == pytest.approx(
            elastic().loads[number].leak.leak_rate, rel=2e-3
        )


@pytest.mark.slow
def test_a_leak_test_of_a_gasket_is_one_of_both_faces(tmp_path: Path) -> None:
    from fem_seal import calibrate

    expected = elastic().loads[0].leak.leak_rate
    path = tmp_path / "leak_test.csv"
    # a reading of what leaves the seal
    rows = [
        "fluid_pressure [bar],applied_force [N],leak_rate [m^3/s],uncertainty [%]",
        f"1,2000,{expected!r},10",
    ]
    path.write_text("\n".join(rows) + "\n")
    load = {"fluid_pressure": "1 bar", "applied_force": "2 kN", "pressure_side": "inner"}
    uncertain = {"samples": 64, "rms_height": {"relative": 0.3}}
    found = calibrate(tables(load=load, uncertainty=uncertain), path)
    assert found.conflict is None and found.p_value > 0.05


def test_ridges_of_a_kammprofile_seal_one_behind_the_other() -> None:
    tip, half = 0.4, 0.35
    foot = 2 - tip + math.sqrt(tip**2 - half**2)
    outline: list[dict[str, Any]] = [{"to": [18, 0]}, {"to": [21, 0]}, {"to": [21, 1.5]}]
    for centre, name in ((20.25, "outer"), (18.75, "chamber")):
        outline.append({"to": [centre + half, foot], "name": name})
        outline.append({"to": [centre - half, foot], "centre": [centre, 2 - tip], "name": "face"})
        outline.append({"to": [centre - 0.75, 1.5], "name": "chamber" if centre > 20 else "inner"})
    outline += [{"to": [18, 0]}]
    for piece in outline:
        for key in ("to", "centre"):
            if key in piece:
                piece[key] = [f"{one} mm" for one in piece[key]]
    load = {"fluid_pressure": "1 bar", "applied_force": "6 kN", "pressure_side": "inner"}
    given = tables(gasket={"shape": "profile", "outline": outline}, load=load, mesh={"contact_size": "8 um"})
    (found,) = solved(given).loads
    assert len(found.profiles) == 2
    flow = SealProblem.of(Case(**given)).flow
    assert flow is not None and found.leak is not None and found.leak.leak_rate > 0
    # half of the seal's leak goes through the ridges of each face
    one_face = replace(found, rough=replace(found.rough, flow=replace(flow, faces=1)))
    assert one_face.leak.leak_rate == pytest.approx(found.leak.leak_rate / 2, rel=1e-12)


def test_a_ring_that_flows_without_limit_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    # as a needle far beyond its limit load does, after a minute
    monkeypatch.setattr("fem_seal.contact.load_path._COLLAPSE_STRAIN", 1e-4)
    loads = {"fluid_pressure": "1 bar", "applied_force": "3 kN", "pressure_side": "inner"}
    others = {"roughness": None, "fluid": None, "interface": {"law": "smooth"}}
    with pytest.raises(LimitLoadError, match="flows without limit"):
        solved(tables(COPPER, load=loads, mesh={"contact_size": "8 um"}, **others))
