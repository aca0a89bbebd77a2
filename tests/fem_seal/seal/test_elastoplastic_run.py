"""A case whose seat yields, from the case file to the result files."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from sample_results import case as sample_case
from sample_results import cone, smooth_case, tiles_of

import fem_seal
from fem_seal.answers.closed_forms import derive, profile_sizes
from fem_seal.bodies.fields import ElastoplasticField, von_mises
from fem_seal.case.case import load_case
from fem_seal.contact.load_path import ElastoplasticContact, load_path
from fem_seal.contact.model import BodyLoads
from fem_seal.contact.newton import solve
from fem_seal.contact.plastic_step import PathLoad
from fem_seal.contact.solution import plastic_zone, yielding_of
from fem_seal.errors import InputError
from fem_seal.loads import contact_force
from fem_seal.output.answer_outputs import pages_of
from fem_seal.output.files import summary
from fem_seal.output.pictures import contact as pictures_contact
from fem_seal.output.pictures import leak as pictures_leak
from fem_seal.output.pictures.style import style
from fem_seal.result import SealResult
from fem_seal.seal import load_solver
from fem_seal.seal.evaluate import evaluate
from fem_seal.seal.load_result import distinct_loads, load_axis, load_name
from fem_seal.seal.problem import SealProblem

YIELD = 200e6
CASE = """
[closure]
shape = "ball"
radius = "10 mm"
material = "tungsten carbide"

[seat]
shape = "cone"
angle = "45 deg"
wall = "fixed"
interference = "2 um"

[seat.material]
name = "soft steel"
youngs_modulus = "210 GPa"
poissons_ratio = 0.3
stress_strain = { file = "curve.csv" }

[interface]
law = "exponential"
u0 = "0.5 um"
p_c = "2 GPa"

[load]
fluid_pressure = ["300 bar", "50 bar"]

[mesh]
contact_size = "30 um"
"""
ROUGH = {
    "roughness": {
        "spectrum": {
            "kind": "self-affine",
            "rms_height": "1 um",
            "hurst": 0.7,
            "q_low": "5e3 1/m",
            "q_rolloff": "5e4 1/m",
            "q_high": "3e6 1/m",
        }
    },
    "fluid": {"name": "water"},
    "leak": {"plasticity": False, "theory": "paper"},
}
CURVE = "plastic_strain, stress_MPa\n0, 200\n0.01, 240\n0.05, 300\n"


@pytest.fixture(scope="module")
def case_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("yields")
    (folder / "curve.csv").write_text(CURVE)
    (folder / "case.toml").write_text(CASE)
    return folder / "case.toml"


@pytest.fixture(scope="module")
def result(case_file: Path) -> SealResult:
    return fem_seal.run(load_case(case_file))


@pytest.fixture(scope="module")
def folder(result: SealResult, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return result.write(tmp_path_factory.mktemp("files"))


# the solver and the case -----------------------------------------------------------------------------------------


def test_a_run_is_the_load_path_of_the_case(result: SealResult) -> None:
    """The same contacts as those of the solver called by hand on the same mesh; same code, so to round-off."""
    case, law = result.case, result.problem.law
    fit = BodyLoads(seat={"wall": 2e-6})
    forces = [contact_force(case.initial_contact_radius, pressure) for pressure in (300e5, 50e5)]
    path = load_path(result.model, law, [PathLoad(force, fit) for force in forces], at_rest=fit)
    for load, contact in zip(result.loads, path.contacts, strict=True):
        assert isinstance(load.contact, ElastoplasticContact)
        assert load.contact_force == pytest.approx(contact.contact_force, rel=1e-14)
        assert load.contact.profile.pressure == pytest.approx(contact.profile.pressure, rel=1e-9)
    assert result.unloaded_bodies is not None
    ours, theirs = result.unloaded_bodies.imprints["seat"], path.unloaded_bodies.imprints["seat"]
    assert ours.depth == pytest.approx(theirs.depth, abs=1e-9 * theirs.deepest)


def test_the_mesh_covers_the_contact_that_yielding_makes_wide(result: SealResult) -> None:
    for contact in result.contact:
        share = contact.pressure[[0, -1]] / contact.pressure.max()
        assert share.max() < 1e-6


def test_a_coined_seat_is_wider_than_a_new_one(result: SealResult) -> None:
    """50 bar after 300 bar, against the same load on the elastic seat: that alone does not reach the yield stress."""
    coined, law = result.loads[1].contact, result.problem.law
    alone = solve(result.model, law, contact_force=coined.contact_force, loads=coined.loads)
    assert alone.fields["seat"].von_mises.max() < YIELD
    assert coined.profile.std > 1.02 * alone.profile.std
    assert coined.profile.peak_pressure < 0.98 * alone.profile.peak_pressure


def test_the_press_fit_is_no_imprint(result: SealResult) -> None:
    """The fit moves the whole face; the imprint is what the loads have added, next to nothing far from the contact."""
    assert result.unloaded_bodies is not None
    imprint = result.unloaded_bodies.imprints["seat"]
    fit = result.model.seat.fem.normal_displacement(
        result.unloaded_bodies.initial_states["seat"].displacement
    )
    assert np.abs(fit).min() > 3 * imprint.deepest
    assert abs(imprint.depth[[0, -1]]).max() < 0.15 * imprint.deepest
    assert 0 < imprint.width < 2 * result.loads[0].contact.profile.fwhm


# files -------------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_unloaded_vtu_has_residual_stress_and_imprint(result: SealResult, folder: Path) -> None:
    pyvista = pytest.importorskip("pyvista")
    assert result.unloaded_bodies is not None
    grid = pyvista.read(folder / "unloaded.vtu")
    fields = result.unloaded_bodies.fields
    closure, seat = fields["closure"], fields["seat"]
    assert isinstance(seat, ElastoplasticField)
    n = len(closure.points)
    for name in ("displacement_m", "stress_Pa", "plastic_strain", "accumulated_plastic_strain"):
        assert not np.any(grid[name][:n])  # the elastic ball comes back
    np.testing.assert_array_equal(grid["displacement_m"][n:, :2], seat.displacement)
    np.testing.assert_array_equal(grid["stress_Pa"][n:, :4], seat.stress)
    np.testing.assert_array_equal(grid["von_mises_Pa"][n:], seat.von_mises)
    # a tensor: half the engineering shear strain beside it
    np.testing.assert_array_equal(grid["plastic_strain"][n:, :4], seat.plastic_strain * [1, 1, 1, 0.5])
    np.testing.assert_array_equal(grid["accumulated_plastic_strain"][n:], seat.accumulated_plastic_strain)
    assert not grid["contact_pressure_Pa"].any()
    assert von_mises(seat.stress).max() > 0.1 * YIELD
    # plastic flow keeps the volume
    assert np.abs(seat.plastic_strain[:, :3].sum(axis=1)).max() < 1e-12


def test_loaded_files_have_plastic_strain_and_elastic_ones_do_not(folder: Path, result: SealResult) -> None:
    pyvista = pytest.importorskip("pyvista")
    grid = pyvista.read(folder / "contact_001.vtu")
    largest = grid["accumulated_plastic_strain"].max()
    assert largest == result.table.max_accumulated_plastic_strain.iloc[1] > 1e-4


def test_imprint_csv(result: SealResult, folder: Path) -> None:
    assert result.unloaded_bodies is not None
    table = pd.read_csv(folder / "imprint.csv")
    imprint = result.unloaded_bodies.imprints["seat"]
    assert set(table.body) == {"seat"}
    assert table.x_m.to_numpy() == pytest.approx(imprint.x, rel=1e-9, abs=1e-15)
    assert table.depth_m.max() == pytest.approx(imprint.deepest, rel=1e-9)


def test_what_an_elastic_run_leaves_is_no_imprint(folder: Path, tmp_path: Path) -> None:
    for name in ("unloaded.vtu", "imprint.csv"):
        (tmp_path / name).write_bytes((folder / name).read_bytes())
    result = low_yield_stress()
    result.write(tmp_path)
    assert not (tmp_path / "unloaded.vtu").exists()
    assert not (tmp_path / "imprint.csv").exists()
    assert result.all_columns[["max_accumulated_plastic_strain", "load_steps"]].isna().all(axis=None)
    assert summary(result)["imprint"] is None
    assert "imprint" not in (tmp_path / "report.html").read_text()


def test_summary_says_where_and_how_far(result: SealResult, folder: Path) -> None:
    told = json.loads((folder / "summary.json").read_text())
    seat = told["yielding"][0]["seat"]
    assert seat["solved_as"] == "elastoplastic"
    assert seat["yield_stress_Pa"] == YIELD
    assert 0 <= seat["depth_m"] < seat["yielded_down_to_m"] < 1e-3
    at = np.array([seat["at_r_m"], seat["at_z_m"]])
    first = np.array([result.model.initial_contact_radius, 0.0])
    assert np.linalg.norm(at - first) < seat["yielded_down_to_m"]
    # below the flow stress of the largest strain, above the elastic limit: the ball is harder and has no yield stress
    assert told["yielding"][0]["closure"] is None
    assert told["imprint"]["seat"]["depth_m"] > 0
    assert told["convergence"][0]["equilibrium_residual"] < 1e-9
    # of 16 only those in which something flows, and a few before
    assert 4 < told["convergence"][0]["load_steps"] == told["loads"][0]["load_steps"] <= 16


def test_report_shows_imprint_and_yielding(folder: Path) -> None:
    page = (folder / "report.html").read_text()
    for text in (
        'id="picture-imprint"',
        "Permanent imprint",
        "has yielded to a depth of",
    ):
        assert text in page
    assert "perfectly plastic" not in page
    assert "Simo" in page


# a path up and down -----------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def proof(case_file: Path) -> SealResult:
    """The working pressure before and after a proof test."""
    loads = {"fluid_pressure": ["50 bar", "300 bar", "50 bar"]}
    return fem_seal.run(load_case(case_file).replace(ROUGH, load=loads))


def drawn(monkeypatch: pytest.MonkeyPatch, picture: Callable[[], object]) -> Figure:
    """The figure behind a picture."""
    figures: list[Figure] = []
    monkeypatch.setattr("fem_seal.output.pictures.style.svg", lambda figure: figures.append(figure) or b"")
    with style():
        picture()
    (figure,) = figures
    return figure


def test_a_load_that_comes_back_has_a_number(proof: SealResult) -> None:
    loads = proof.loads
    assert [load_name(load, loads) for load in loads] == ["50 bar (load 1)", "300 bar", "50 bar (load 3)"]
    assert distinct_loads(loads) == [0, 2, 1]
    assert load_axis(loads).names == tuple(load_name(load, loads) for load in loads)


def test_pictures_follow_the_path(proof: SealResult, monkeypatch: pytest.MonkeyPatch) -> None:
    sizes = profile_sizes(proof, derive(proof.case))
    figure = drawn(monkeypatch, lambda: pictures_contact.size_picture(proof, sizes))
    for axes in figure.axes:
        (line,) = [line for line in axes.lines if line.get_label() == "calculated"]
        assert line.get_linestyle() == "-"
        assert np.asarray(line.get_xdata()).tolist() == [50, 300, 50]
    width = [text.get_text() for text in figure.axes[1].texts]
    assert width == ["1", "2", "3"]
    figure = drawn(monkeypatch, lambda: pictures_leak.leak_picture(proof))
    assert "".join(text.get_text() for text in figure.axes[0].texts).count("3") == 1


def test_profiles_of_a_path_are_told_apart(proof: SealResult, monkeypatch: pytest.MonkeyPatch) -> None:
    names = ["50 bar (load 1)", "50 bar (load 3)", "300 bar"]
    derived = derive(proof.case)
    profiles = [load.contact.profile for load in (proof.loads[0], proof.loads[2], proof.loads[1])]
    gaps = Figure().subplots()
    with style():
        pictures_contact.draw_gap(gaps, proof)
    pressures = drawn(monkeypatch, lambda: pictures_contact.profile_picture(proof, derived)).axes[0]
    for axes, values in (
        (pressures, [p.pressure / 1e6 for p in profiles]),
        (gaps, [p.gap / 1e-6 for p in profiles]),
    ):
        legend = axes.get_legend()
        assert legend is not None and [text.get_text() for text in legend.get_texts()] == names
        for line, y in zip(axes.lines, values, strict=True):
            np.testing.assert_allclose(np.asarray(line.get_ydata()), y, rtol=1e-12)


@pytest.mark.parametrize("share", [1.0, 0.02])
def test_plastic_strain_is_drawn_whole_with_a_readable_scale(
    proof: SealResult, monkeypatch: pytest.MonkeyPatch, share: float
) -> None:
    """Also for strains so small that per cent would need many digits."""
    assert proof.unloaded_bodies is not None
    state = proof.unloaded_bodies.states["seat"]
    less = replace(
        state, plastic=replace(state.plastic, accumulated_strain=share * state.plastic.accumulated_strain)
    )
    unloaded = replace(proof.unloaded_bodies, states={"seat": less})
    weaker = replace(proof, unloaded_bodies=unloaded)
    figure = drawn(monkeypatch, lambda: pictures_contact.imprint_picture(weaker))
    FigureCanvasAgg(figure).draw()
    _, view, scale = figure.axes
    field = unloaded.fields["seat"]
    assert isinstance(field, ElastoplasticField)
    zone = plastic_zone(field, proof.case.seat.material)
    assert zone is not None
    unit = {"mm": 1e-3, "µm": 1e-6}[view.get_ylabel().split("[")[1].rstrip("]")]
    assert -view.get_ylim()[0] * unit > 1.45 * zone.deepest
    labels = [label.get_text() for label in scale.get_yticklabels()]
    assert labels[0] == "0" and max(map(len, labels)) <= 5
    assert [float(text) for text in labels[1:]] == pytest.approx(scale.get_yticks()[1:])
    assert scale.yaxis.label.get_window_extent().x1 < figure.bbox.x1 - 1


def test_the_report_says_what_it_compares(proof: SealResult) -> None:
    fact = tiles_of(proof)["Largest stress"]
    body = proof.loads[1].max_von_mises_at[0]
    assert body == "closure"  # the seat cannot carry it
    assert fact.remark == "von Mises, in the closure"
    derived = derive(proof.case)
    (said,) = [text for page in pages_of(proof) for text in page.why if "smooth elastic" in text]
    hertz, profile = derived.loads[1].hertz, proof.loads[1].contact.profile
    assert hertz is not None
    # Hertz' bodies touch over 2 a; half of the peak is reached over sqrt(3) a
    assert f"{np.sqrt(3) * hertz.half_width * 1e3:.3f} mm" in said
    assert f"{profile.fwhm * 1e3:.3f} mm wide" in said and "touch" not in said


# elastic cases -----------------------------------------------------------------------------------------------------


@cache
def low_yield_stress() -> SealResult:
    """A smooth elastic contact far beyond its yield stress."""
    soft = {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3, "yield_stress": "100 MPa"}
    return fem_seal.run(smooth_case(seat=cone(soft), load={"fluid_pressure": "20 bar"}))


def test_elastic_results_name_where_and_how_far_the_yield_stress_is_passed() -> None:
    """Hertz' line contact under a load that exceeds it: place, size and depth from Johnson (1985), eq. 4.49."""
    result = low_yield_stress()
    (load,) = result.loads
    assert not isinstance(load.contact, ElastoplasticContact)
    profile = load.contact.profile
    f, peak = load.line_load, profile.peak_pressure
    a = 2 * f / (np.pi * peak)
    z = a * np.linspace(0, 6, 6001)
    root = np.sqrt(a**2 + z**2)
    along, deep = -peak / a * ((a**2 + 2 * z**2) / root - 2 * z), -peak * a / root
    stress = von_mises(np.column_stack([along, deep, 0.3 * (along + deep), 0 * z]))
    zone = yielding_of(load.contact)["seat"]
    # The hoop stress of the ring, which a half-space does not have, adds to the seat in proportion to the contact's
    # width: 0.8 % at 0.2 bar, 2.3 % at 20 bar and 4.9 % at 200 bar. The elements' share is 0.3 %.
    assert zone.excess == pytest.approx(stress.max() / 100e6, rel=0.03)  # type: ignore[union-attr]
    assert zone.depth == pytest.approx(z[np.argmax(stress)], abs=0.2 * a)
    assert zone.deepest > 0.9 * z[stress > 100e6].max()
    (said,) = [text for text in result.warnings if text.startswith("seat: von Mises")]
    assert f"{zone.excess:.3g} times its yield stress" in said  # type: ignore[union-attr]
    assert f"100 MPa to a depth of {zone.deepest * 1e6:.3g} um" in said
    assert "stress_strain curve" in said
    assert summary(result)["yielding"][0]["seat"]["solved_as"] == "elastic"


# what cannot be asked ----------------------------------------------------------------------------------------------


def test_more_than_the_whole_face_of_a_body_that_yields_can_carry_is_refused(case_file: Path) -> None:
    with pytest.raises(
        InputError, match=r"more than the body that yields can carry .* [\d.]+ kN at 2.97"
    ) as failure:
        load_case(case_file).replace(ROUGH, load={"applied_force": "100 MN"})
    assert failure.value.key == "load"


def test_a_path_says_how_far_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    soft = {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3, "hardness": "1 GPa"}
    soft["stress_strain"] = {"plastic_strain": [0, 0.2], "stress": ["80 MPa", "150 MPa"]}
    asked = sample_case(
        seat=cone(soft),
        load={"fluid_pressure": ["20 bar", "10 bar"], "largest_earlier_force": "4 kN"},
        mesh={"contact_size": "0.1 mm"},
    )
    monkeypatch.setattr(load_solver, "_TOLD_EVERY", 0.0)
    told: list[str] = []
    evaluate(SealProblem.of(asked), clock=load_solver.Clock(told.append))
    path = [text for text in told if "% of the way" in text]
    heads = list(dict.fromkeys(text.split(":")[0] for text in path))
    assert heads == ["the largest earlier load", "load 1 of 2", "load 2 of 2", "unloading"]
    for head in heads:
        ways = [float(text.split(": ")[1].split(" %")[0]) for text in path if text.startswith(head)]
        assert ways[0] == 0.0 and ways == sorted(ways) and ways[-1] < 100.0
    # only now and then
    monkeypatch.setattr(load_solver, "_TOLD_EVERY", 1e6)
    told.clear()
    evaluate(SealProblem.of(asked), clock=load_solver.Clock(told.append))
    assert not [text for text in told if "% of the way" in text]
