"""`fem-seal direct` and [leak] conductivity = "direct": from the case file to tables, pictures and the leak rate."""

from __future__ import annotations

import json
import math
import os
import re
import signal
import subprocess
import sys
from dataclasses import replace
from functools import cache
from multiprocessing import active_children
from pathlib import Path
from time import perf_counter, sleep

import numpy as np
import pandas as pd
import pytest
from sample_results import case

import fem_seal
from fem_seal.case.case import case_of
from fem_seal.cli import app as cli
from fem_seal.errors import InputError
from fem_seal.files import read_toml
from fem_seal.output.direct import direct_lines, direct_numbers, direct_rows
from fem_seal.seal.direct import BulkPath, DirectSettings, DirectTable, simulate_surface
from fem_seal.seal.problem import direct_settings, rough_contact
from fem_seal.units import Display
from fem_seal.validity.checks import _direct_cautions
from leak import DirectError, Reading, RoughContact
from leak.direct import simulate

SMALL = {"points": 64, "samples": 2, "pressure": ["40 MPa", "150 MPa", "500 MPa"]}
CASE = """
[closure]
shape = "ball"
radius = "20 mm"
material = "steel"

[seat]
shape = "cone"
angle = "45 deg"
material = { youngs_modulus = "210 GPa", poissons_ratio = 0.3, hardness = "3.5 GPa" }

[roughness.spectrum]
kind = "self-affine"
rms_height = "1.9 um"
hurst = 0.6
q_low = "1e3 1/m"
q_rolloff = "3.7268e4 1/m"
q_high = "3.14159e6 1/m"

[fluid]
name = "water"

[load]
fluid_pressure = "20 bar"

[direct]
points = 64
samples = 2
pressure = ["40 MPa", "150 MPa", "500 MPa"]
unload = ["40 MPa"]
"""


def simulated(**more):
    given = case(direct={**SMALL, **more})
    return direct_settings(given), rough_contact(given)


@cache
def table():
    settings, surface = simulated(unload=["40 MPa"])
    return settings.table(surface)


def wrong(**tables):
    with pytest.raises(InputError) as caught:
        case(**tables)
    return str(caught.value)


def test_rows_are_means_of_the_samples():
    found = table()
    simulation = found.simulation
    runs = [
        simulate(
            simulation.map(sample),
            simulation.patch.size,
            simulation.settings.pressures,
            effective_modulus=simulation.surface.effective_modulus,
            hardness=simulation.surface.hardness,
            unload=simulation.settings.unload,
        )
        for sample in range(2)
    ]
    area = np.mean([run.contact_area for run in runs], axis=0)
    sigma = np.exp(np.mean([np.log(run.flow_conductivity(1e-3)) for run in runs], axis=0))
    rows = pd.DataFrame(direct_rows(found, 1e-3))
    load = rows[rows.branch == "load"]
    # other starting points of the same contacts: tolerance of the contact, and a point at an edge of it
    assert load.contact_area.to_numpy() == pytest.approx(area, abs=3.0 / 64**2)
    assert load.conductivity_m3_per_Pa_s.to_numpy() == pytest.approx(sigma, rel=5e-3)
    back = rows[rows.branch == "unload"].iloc[0]
    assert back.contact_area == pytest.approx(
        np.mean([run.unloaded.contact_area[0] for run in runs]), abs=1e-3
    )
    assert back.largest_pressure_Pa == 5e8
    assert back.effective_gap_m < load.effective_gap_m.iloc[0]
    assert (load.conductivity_low_m3_per_Pa_s < load.conductivity_m3_per_Pa_s).all()
    assert (load.conductivity_high_m3_per_Pa_s > load.conductivity_m3_per_Pa_s).all()


def test_gaps_are_all_counted():
    found = table()
    widths = np.diff(found.simulation.gap_edges)
    for row, density in zip(found.rows, found.gap_density, strict=True):
        assert np.sum(density * widths) == pytest.approx(1.0 - row.contact_area, abs=2e-3)
        middle = 0.5 * (found.simulation.gap_edges[1:] + found.simulation.gap_edges[:-1])
        assert np.sum(density * widths * middle) == pytest.approx(row.mean_gap, rel=0.02)


def test_theory_stands_beside_it():
    found = table()
    first = found.rows[0]
    held = found.simulation.patch_surface
    assert first.theory.gap[Reading.CAPPED] == pytest.approx(
        float(held.capped.effective_separation(first.pressure))
    )
    assert first.theory.gap[Reading.CONSERVED] == pytest.approx(
        float(held.conserved.effective_separation(first.pressure))
    )
    # elastic asperities, most of those of this smooth patch: the theory's area is 20 to 40 % below direct ones, and
    # four points per wave add some 6 %
    for row in found.loading:
        assert 1.0 < row.contact_area / row.theory.contact_area < 1.8
    assert "of the slope variance are cut" in " ".join(direct_lines(Display(), found))
    assert direct_numbers(found)["slope_variance_cut"] > 0.8


def changed(row, **more):
    """The table with one row of loading changed."""
    found = table()
    rows = list(found.rows)
    rows[row] = replace(rows[row], **more)
    return DirectTable(found.simulation, tuple(rows), found.gap_density), rows[row]


def test_interval_when_short_waves_decide_whether_a_patch_is_tight():
    half, row = changed(1, cutoff_ratio=0.5)
    usual = half.ends(row)
    tight, row = changed(1, cutoff_ratio=0.0)
    low, high = tight.ends(row)
    assert low == usual[0]
    # no more than at the pressure before, whatever the last octave does
    assert usual[1] < high == pytest.approx(tight.ends(tight.rows[0])[1])
    nearly, row = changed(1, cutoff_ratio=1e-9)
    assert nearly.ends(row)[1] == pytest.approx(high)
    # at the first pressure nothing bounds it but a guess, which is doubtful wherever it counts
    first, row = changed(0, cutoff_ratio=0.0)
    assert 10.0 ** (1.0 / 3.0) <= first.ends(row)[1] / row.effective_gap < 100.0
    assert np.isfinite(first.conductivity_table(1e2, 1e9, 20, 1).separation).all()


def test_interval_with_tight_samples():
    usual = table().ends(table().rows[2])
    one, row = changed(2, blocked=1, log_scatter=np.nan)
    low, high = one.ends(row)
    # one of two is open: the mean of both is half of it, and it scatters at least as the others do
    assert (low / row.effective_gap) ** 3 < 0.5
    assert high > row.effective_gap
    assert low < usual[0]
    none, row = changed(2, blocked=2, effective_gap=0.0, log_scatter=np.nan, cutoff_ratio=np.nan)
    assert none.ends(row) == (0.0, none.ends(none.rows[1])[1])
    assert none.range == (4e7, 1.5e8)
    assert direct_rows(none, 1e-3)[2]["conductivity_low_m3_per_Pa_s"] == 0.0


@pytest.mark.slow
@pytest.mark.parametrize(
    ("row", "words"),
    [
        ({"blocked": 1, "log_scatter": np.nan}, "1 of 2 patches of the direct simulation tight at 40 MPa"),
        ({"cutoff_ratio": 0.0}, "uncertain by a factor"),
        ({"cutoff_ratio": np.nan, "log_scatter": 3.0}, "uncertain by a factor"),
        ({"samples": 1, "log_directions": np.inf}, "uncertain by a factor 10 down"),
    ],
)
def test_tight_samples_make_a_result_doubtful(row, words):
    found, _ = changed(0, **row)
    load = result().loads[-1]
    cautions = list(_direct_cautions(found, load, result().loads, result().surface))
    assert words in " ".join(caution.reason() for caution in cautions)
    assert not any(re.search(r"\b(nan|inf)\b", caution.text()) for caution in cautions)


@pytest.mark.slow
def test_surface_that_is_tight_at_all_pressures_has_its_pictures(tmp_path, capsys):
    file = tmp_path / "tight.toml"
    file.write_text(CASE.replace("1.9 um", "0.02 um").replace("points = 64", "points = 32"))
    assert cli.main(["direct", str(file), "--jobs", "1"]) == 0
    assert "2/2" in capsys.readouterr().out
    assert (tmp_path / "tight.direct" / "direct.svg").is_file()
    found = pd.read_csv(tmp_path / "tight.direct" / "direct.csv")
    assert (found.conductivity_m3_per_Pa_s[:3] == 0.0).all()


def test_finished_pieces_are_not_done_again(tmp_path):
    settings, surface = simulated()
    settings = DirectSettings(**{**vars(settings), "folder": tmp_path})
    simulation = settings.of(surface)
    said: list[str] = []

    class Interrupted(Exception):
        pass

    def interrupt(text):
        said.append(text)
        if "4 of" in text:
            raise Interrupted

    with pytest.raises(Interrupted):
        simulate_surface(simulation, progress=interrupt)
    assert len(list((tmp_path / "pieces").iterdir())) == 4
    said.clear()
    # a piece that is damaged is done again, the others are kept
    damaged = sorted((tmp_path / "pieces").iterdir())[0]
    damaged.write_text("[{")
    found = simulate_surface(simulation, progress=said.append)
    assert said[0] == "3 of 9 pieces are there already"
    assert len(said) == 1 + 6
    plain = simulate_surface(DirectSettings(**{**vars(settings), "folder": None}).of(surface))
    assert [row.effective_gap for row in found.rows] == [row.effective_gap for row in plain.rows]
    said.clear()
    simulate_surface(simulation, progress=said.append)
    assert said == []


@pytest.mark.slow
def test_interruption_does_not_wait_for_what_is_left(tmp_path):
    """Ctrl-C while two processes are busy with more than a minute of pieces: they end, and what is done stays."""
    settings, surface = simulated(points=128, samples=200)
    settings = DirectSettings(**{**vars(settings), "folder": tmp_path})
    said: list[tuple[float, str]] = []

    def interrupt(text):
        said.append((perf_counter(), text))
        if "1 of" in text:
            raise KeyboardInterrupt

    before = set(active_children())
    with pytest.raises(KeyboardInterrupt):
        simulate_surface(settings.of(surface), jobs=2, progress=interrupt)
    # what has begun is finished: a few seconds
    assert perf_counter() - said[0][0] < 30.0
    assert set(active_children()) <= before
    assert said[-1][1].startswith("interrupted; finished pieces are kept")
    assert len(list((tmp_path / "pieces").iterdir())) == 1


METAL = {
    "points": 32,
    "samples": 2,
    "asperities": "von-mises",
    "pressure": ["300 MPa", "40 MPa"],
    "unload": ["40 MPa"],
}


@cache
def metal():
    settings, surface = simulated(**METAL)
    return settings.table(surface)


@pytest.mark.slow
def test_metal_that_flows_is_loaded_step_by_step():
    """The library itself, along the path that the guide says, yield stress 3.5 GPa/2.9."""
    from leak.direct import PeriodicHalfSpace, patch_flow, press_elastoplastic

    found = metal()
    patch = found.simulation.patch
    modulus = 210e9 / (1.0 - 0.3**2) / 2.0
    path = 1e6 * np.array([40.0, 126.667, 213.333, 300.0, 213.333, 126.667, 40.0])
    states = [
        press_elastoplastic(
            PeriodicHalfSpace(32, patch.size, modulus),
            patch.heights(1 + sample, "exact"),
            path,
            yield_stress=3.5e9 / 2.9,
            poissons_ratio=0.3,
        )
        for sample in range(2)
    ]
    assert [(row.branch, row.pressure, row.largest_pressure) for row in found.rows] == [
        ("load", 4e7, 4e7), ("load", 3e8, 3e8), ("unload", 4e7, 3e8),
    ]  # fmt: skip
    for row, at in zip(found.rows, (0, 3, 6), strict=True):
        pressed = [path_of_one[at] for path_of_one in states]
        assert row.mean_gap == pytest.approx(np.mean([one.gap.mean() for one in pressed]), rel=2e-3)
        assert row.contact_area == pytest.approx(np.mean([one.contact_area for one in pressed]), abs=2e-3)
        assert row.yielded_area == pytest.approx(np.mean([one.yielded_area for one in pressed]), abs=4e-3)
        both = [[patch_flow(one).gap_cubed for one in (state.gap, state.gap.T.copy())] for state in pressed]
        logs = np.log(np.mean(both, axis=1))
        assert row.effective_gap == pytest.approx(np.exp(logs.mean() / 3.0), rel=5e-3)
    # flat asperities do not come back
    assert found.rows[2].contact_area > found.rows[0].contact_area
    assert found.rows[1].mean_gap < found.rows[2].mean_gap < found.rows[0].mean_gap
    assert found.rows[2].yielded_area >= found.rows[1].yielded_area
    drawn = found.press_sample(3e8)
    assert drawn.gap == pytest.approx(states[0][3].gap, abs=1e-3 * states[0][3].gap.max())
    assert np.mean(drawn.touches) == pytest.approx(states[0][3].contact_area, abs=2e-3)
    assert np.mean(drawn.yielded) == pytest.approx(states[0][3].yielded_area, abs=4e-3)
    assert "flows at a von Mises stress of 1.21 GPa" in " ".join(direct_lines(Display(), found))
    assert direct_numbers(found)["load_step_Pa"] == pytest.approx(0.025 * 3.5e9)


def test_a_strain_that_grows_with_the_pressure_counts_by_half():
    """int p d(strain)/p along the path itself; beyond the contact's pressure nothing is added."""
    bulk = BulkPath(0.01, -0.004, 2e8)
    for end in (5e7, 2e8, 5e8):
        p = np.linspace(0.0, end, 10_001)
        steps = np.diff([bulk.total(one) for one in p], axis=0)
        assert bulk.counted(end) == pytest.approx((p[1:] + p[:-1]) / 2 @ steps / end, rel=1e-4)
    assert bulk.counted(2e8) == (0.01, -0.004)


@pytest.mark.slow
@pytest.mark.parametrize("direction", ["x", "y"])
def test_metal_strained_in_bulk_is_loaded_along_the_flow(direction):
    """The library itself with both strains at each step; what is unloaded stays strained."""
    from leak.direct import PeriodicHalfSpace, patch_flow, press_elastoplastic

    given = case(direct={**METAL, "samples": 1, "direction": direction}, leak={"theory": "corrected"})
    settings, surface = direct_settings(given), rough_contact(given)
    bulk = BulkPath(0.006, -0.001, 3e8)
    found = replace(settings, bulk=bulk).table(surface)
    patch, step = found.simulation.patch, found.simulation.load_step
    # the strain asks for shorter steps than the load
    assert step < 0.025 * 3.5e9
    assert 0.012 * step / 3e8 == pytest.approx(0.025 * patch.grid_spectrum.rms_slope)
    path, last = [], 0.0
    for p in (4e7, 3e8, 4e7):
        path += np.linspace(last, p, int(np.ceil(abs(p - last) / step)) + 1)[1:].tolist()
        last = p
    strain = np.outer(np.maximum.accumulate(path) / 3e8, [0.012, -0.002])
    states = press_elastoplastic(
        PeriodicHalfSpace(32, patch.size, 210e9 / (1.0 - 0.3**2) / 2.0),
        patch.heights(1, "exact"),
        path,
        yield_stress=3.5e9 / 2.9,
        strain=strain if direction == "x" else strain[:, ::-1],
    )
    for row, at in zip(found.rows, (path.index(4e7), path.index(3e8), -1), strict=True):
        gap = states[at].gap if direction == "x" else states[at].gap.T.copy()
        assert row.contact_area == pytest.approx(states[at].contact_area, abs=2e-3)
        assert row.effective_gap == pytest.approx(np.cbrt(patch_flow(gap).gap_cubed), rel=5e-3)
    for strained, row in zip(found.rows[:2], settings.table(surface).rows[:2], strict=True):
        assert strained.effective_gap < row.effective_gap
        rest = surface.pressure_at_rest(row.pressure, *bulk.counted(row.pressure))
        whole = surface.effective_separation(rest)
        assert strained.theory.whole[Reading.CAPPED] == pytest.approx(float(whole), rel=1e-9)
    assert found.rows[1].contact_area > 1.1 * settings.table(surface).rows[1].contact_area


@pytest.mark.slow
def test_yielding_bodies_strain_the_patch(tmp_path):
    tables = read_toml(Path(__file__).parents[3] / "examples" / "copper_ring.toml", "case")
    tables["load"]["applied_force"] = "2 kN"
    tables["direct"] = {"points": 32, "samples": 1, "asperities": "von-mises", "pressure": ["50 MPa"]}
    ring = case_of(tables)
    found = fem_seal.direct(ring, folder=tmp_path)
    (load,) = fem_seal.run(ring).loads
    assert found.strained.simulation.settings.bulk == BulkPath.of(load.tightest)
    (row,) = direct_rows(found)
    share = 5e7 / load.tightest.highest
    assert row["bulk_strain_meridional"] == pytest.approx(share * load.tightest.peak_strain[0], rel=1e-9)
    assert row["strained_effective_gap_m"] == found.strained.rows[0].effective_gap != row["effective_gap_m"]
    assert "Patches over such metal stand beside the others" in " ".join(direct_lines(Display(), found))
    # bodies that do not yield are not solved, and nothing is strained
    assert metal().strained is None
    assert math.isnan(direct_rows(metal())[0]["strained_effective_gap_m"])


@pytest.mark.slow
def test_interval_holds_what_load_steps_miss():
    found = metal()
    row = found.rows[0]
    settings = replace(found.simulation.settings, yield_stress=None)
    capped = replace(found, simulation=replace(found.simulation, settings=settings))
    assert found.log_error(row)[1] == pytest.approx(capped.log_error(row)[1] + 0.09)
    assert found.log_error(row)[0] == capped.log_error(row)[0]


@pytest.mark.slow
def test_command_simulates_metal_that_flows(tmp_path, capsys):
    file = tmp_path / "seal.toml"
    given = CASE.replace("points = 64", 'points = 32\nasperities = "von-mises"')
    file.write_text(given.replace('["40 MPa", "150 MPa", "500 MPa"]', '["40 MPa", "300 MPa"]'))
    assert cli.main(["direct", str(file), "--jobs", "2"]) == 0
    out, said = capsys.readouterr()
    assert "The metal flows at a von Mises stress" in out
    assert "direct simulation: 3 of 3 pieces" in said
    folder = tmp_path / "seal.direct"
    # two paths of two pressures and back, and one of two pressures
    assert len(list((folder / "pieces").iterdir())) == 8
    assert (folder / "direct_map_high.svg").is_file()
    written = pd.read_csv(folder / "direct.csv")
    assert written.effective_gap_m.to_numpy() == pytest.approx(
        [row.effective_gap for row in metal().rows], rel=1e-9
    )
    assert cli.main(["direct", str(file), "--json"]) == 0
    out, said = capsys.readouterr()
    assert "pieces" not in said
    assert json.loads(out)["asperities"] == "von-mises"


@pytest.mark.slow
def test_pressure_that_fails_leaves_those_below_it(tmp_path):
    settings, surface = simulated(**{**METAL, "pressure": ["40 MPa", "300 MPa", "3 GPa"]})
    settings = replace(settings, folder=tmp_path)
    with pytest.raises(DirectError, match="flows down to a third of the side"):
        simulate_surface(settings.of(surface), jobs=2)
    # what had begun is finished, and nothing else begun
    assert len(list((tmp_path / "pieces").iterdir())) == 2 * 2
    said: list[str] = []
    lower = replace(settings, pressures=(4e7, 3e8), unload=())
    found = simulate_surface(lower.of(surface), progress=said.append)
    assert said[0] == "2 of 3 pieces are there already"
    assert [row.effective_gap for row in found.rows] == pytest.approx(
        [row.effective_gap for row in metal().rows[:2]], rel=1e-9
    )


@pytest.mark.slow
def test_interruption_ends_long_paths_at_once(tmp_path):
    """Ctrl-C while two processes are at paths of minutes."""
    (tmp_path / "seal.toml").write_text(CASE.replace("points = 64", 'points = 256\nasperities = "von-mises"'))
    called = subprocess.Popen(
        [sys.executable, "-m", "fem_seal", "direct", "seal.toml", "--jobs", "2"],
        cwd=tmp_path,
        stderr=subprocess.PIPE,
        start_new_session=True,
        text=True,
    )
    with pytest.raises(subprocess.TimeoutExpired):
        called.wait(15.0)
    os.killpg(called.pid, signal.SIGINT)
    said = called.communicate(timeout=20.0)[1]
    assert "interrupted; finished pieces are kept" in said
    assert "Traceback" not in said
    # nobody of the group is left: what tidies up behind them goes last
    with pytest.raises(ProcessLookupError):
        for _ in range(50):
            os.killpg(called.pid, 0)
            sleep(0.1)


@pytest.mark.slow
def test_elastic_asperities_of_a_body_with_a_hardness():
    settings, surface = simulated(asperities="elastic", unload=["40 MPa"])
    found = settings.table(surface)
    plain = case(direct={**SMALL, "unload": ["40 MPa"]}, leak={"plasticity": False})
    never = direct_settings(plain).table(rough_contact(plain))
    assert [row.effective_gap for row in found.rows] == [row.effective_gap for row in never.rows]
    assert [row.theory for row in found.rows] == [row.theory for row in never.rows]
    # what is elastic comes back, and nothing is at the hardness
    assert found.rows[3].mean_gap == pytest.approx(found.rows[0].mean_gap, rel=1e-3)
    assert direct_numbers(found)["hardness_Pa"] is None
    assert found.rows[2].mean_gap > table().rows[2].mean_gap
    # pressures may then reach the hardness
    assert case(direct={"asperities": "elastic", "pressure": "4 GPa"}).direct.pressure == (4e9,)


def test_the_softer_body_yields():
    hard = {"youngs_modulus": "400 GPa", "poissons_ratio": 0.2, "hardness": "9 GPa"}
    soft = {"youngs_modulus": "120 GPa", "poissons_ratio": 0.34, "hardness": "1 GPa"}
    for closure, seat in ((hard, soft), (soft, hard)):
        given = case(
            direct={**METAL, "pressure": "100 MPa", "unload": None},
            closure={"shape": "ball", "radius": "20 mm", "material": closure},
            seat={"shape": "cone", "angle": "45 deg", "material": seat},
        )
        simulation = direct_settings(given).of(rough_contact(given))
        assert simulation.settings.poissons_ratio == 0.34
        assert simulation.settings.yield_stress == pytest.approx(1e9 / 2.9)
        both = 1.0 / ((1.0 - 0.2**2) / 400e9 + (1.0 - 0.34**2) / 120e9)
        assert simulation.body.effective_modulus == pytest.approx(both)


def test_case_without_roughness_is_refused(tmp_path, capsys):
    file = tmp_path / "smooth.toml"
    file.write_text(
        CASE.replace(
            "[roughness.spectrum]", '[interface]\nlaw = "smooth"\n[leak]\nplasticity = false\n[other]'
        )
    )
    assert cli.main(["direct", str(file)]) == 2
    with pytest.raises(InputError, match="no surface to simulate"):
        fem_seal.direct(
            case(roughness=None, fluid=None, interface={"law": "smooth"}, leak={"plasticity": False})
        )


def test_another_surface_is_another_piece():
    settings, surface = simulated()
    keys = set()
    for one in (
        surface,
        surface.elastic,
        RoughContact(surface.spectrum, effective_modulus=1e11, hardness=3.5e9),
    ):
        simulation = settings.of(one)
        keys |= {simulation.key(piece) for piece in simulation.pieces()}
    assert len(keys) == 3 * len(simulation.pieces())
    # metal that flows remembers its path: each pressure has its own, and so has each yield stress
    metal = replace(settings, asperities="von-mises")
    for one in (
        metal,
        replace(metal, yield_stress=1e9),
        replace(metal, poissons_ratio=0.2),
        replace(metal, pressures=settings.pressures[:2], unload=(1e7,)),
    ):
        simulation = one.of(surface)
        new = {simulation.key(piece) for piece in simulation.pieces()}
        assert len(new) == 3
        assert not new & keys
        keys |= new
    # nothing yields whatever the hardness
    never = replace(settings, asperities="elastic").of(surface)
    assert {never.key(piece) for piece in never.pieces()} <= keys
    # in which way the theory reads asperities that yield is nothing to the simulation
    capped, conserved = settings.of(surface.capped), settings.of(surface.conserved)
    assert [capped.key(piece) for piece in capped.pieces()] == [
        conserved.key(piece) for piece in conserved.pieces()
    ]


def test_usual_pressures_span_the_contact_areas():
    simulation = DirectSettings(points=64).of(rough_contact(case()))
    areas = [float(simulation.patch_surface.contact_area(p)) for p in simulation.settings.pressures]
    assert len(areas) == 8
    assert areas[0] == pytest.approx(0.003, rel=0.01)
    assert areas[-1] == pytest.approx(0.3, rel=0.01)


def test_table_follows_the_simulation_and_goes_on_like_the_theory():
    found = table()
    conductivity = found.conductivity_table(1e2, 1e9, 80)
    for row in found.loading:
        assert conductivity.effective_separation(row.pressure) == pytest.approx(row.effective_gap, rel=0.02)
    theory = found.simulation.patch_surface.capped
    low = found.range[0]
    slope = [np.diff(np.asarray(one([1e-3 * low, 1e-2 * low])))[0] for one in (
        conductivity.effective_separation, theory.effective_separation,
    )]  # fmt: skip
    factor = found.rows[0].effective_gap / float(theory.effective_separation(low))
    assert slope[0] == pytest.approx(factor * slope[1], rel=1e-3)
    ends = [found.conductivity_table(1e2, 1e9, 80, end).effective_separation(1.5e8) for end in (-1, 1)]
    assert ends[0] < conductivity.effective_separation(1.5e8) < ends[1]


@cache
def result():
    return fem_seal.run(case(leak={"conductivity": "direct"}, direct=SMALL))


def test_leak_rate_of_a_case_comes_from_the_simulation():
    load = result().loads[-1]
    p = load.contact.profile
    # Q = integral by hand: 1/Q = int dx/(2 pi r sigma(p) dp)
    settings, surface = simulated()
    sigma = settings.table(surface).conductivity_table(1e-2, 1e10, 80).at(result().problem.flow.viscosity)
    resistance = np.trapezoid(1.0 / (2.0 * np.pi * p.radius * sigma(p.pressure)), p.x)
    assert load.leak.leak_rate == pytest.approx(load.fluid_pressure / resistance, rel=0.02)
    low, high = load.leak_range
    assert low < load.leak.leak_rate < high
    assert load.scenarios[Reading.ELASTIC].leak.leak_rate > load.leak.leak_rate


@cache
def metal_result():
    direct = {**METAL, "unload": None, "pressure": ["40 MPa", "150 MPa", "500 MPa"]}
    return fem_seal.run(case(leak={"conductivity": "direct"}, direct=direct))


@pytest.mark.slow
def test_leak_rate_of_metal_that_flows():
    same = {**SMALL, "points": 32}
    found, capped = (
        one.loads[-1]
        for one in (metal_result(), fem_seal.run(case(leak={"conductivity": "direct"}, direct=same)))
    )
    # hard asperities yield before they reach the hardness: a little tighter than capped ones
    assert 0.6 < found.leak.leak_rate / capped.leak.leak_rate < 0.99
    assert found.scenarios[Reading.ELASTIC].leak.leak_rate == pytest.approx(
        capped.scenarios[Reading.ELASTIC].leak.leak_rate, rel=1e-9
    )
    low, high = found.leak_range
    assert low < found.leak.leak_rate < high


@pytest.mark.slow
def test_report_names_what_yields(tmp_path):
    metal_result().write(tmp_path, full=True)
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "direct simulation of rough patches, metal that flows by von Mises" in page
    assert "Pei" in page
    assert "Orange: metal below has flowed." in page


@pytest.mark.slow
def test_report_shows_the_simulation(tmp_path):
    result().write(tmp_path, full=True)
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "direct simulation of rough patches" in page
    assert 'id="picture-direct"' in page
    assert 'id="picture-direct_map"' in page
    assert "Polonsky" in page
    assert "Bruggeman" not in page
    assert "no open leak path above" not in page
    row = pd.read_csv(tmp_path / "leak.csv").iloc[-1]
    load = result().loads[-1]
    (low, high), off = load.leak_range, 1 + load.mesh_error.leak_rate
    assert row.leak_rate_low_m3_per_s == pytest.approx(low / off, rel=1e-9)
    assert row.leak_rate_high_m3_per_s == pytest.approx(high * off, rel=1e-9)


def test_pressure_beyond_the_simulated_ones_is_doubtful():
    reasons = " ".join(result().loads[0].validity.reasons)
    assert "peak pressure below those of the direct simulation, 40 to 500 MPa" in reasons
    assert result().loads[0].validity.level == "doubtful"


@pytest.mark.parametrize("pressure", [4e7, 1.5e8])
def test_gas_flows_through_the_simulated_gaps(pressure):
    """The table against the flow of a rarefied gas through the same pressed maps."""
    found = table()
    simulation, log_p = found.simulation, np.log([pressure])
    gas = found.conductivity_table(1e5, 1e9, of_gas=True)
    assert gas.liquid.separation == pytest.approx(found.conductivity_table(1e5, 1e9).separation)
    metal = {"effective_modulus": simulation.surface.effective_modulus, "hardness": 3.5e9}
    u = float(gas.at_log_pressure(log_p)[0])
    for flight in (1e-7, 1e-5):
        liquid, rarefied = (
            [
                simulate(simulation.map(k), simulation.patch.size, [pressure], **metal, flight=way)
                .flow_conductivity(1.0)
                .item()
                for k in range(2)
            ]
            for way in (None, flight)
        )
        ratio = np.exp(np.mean(np.log(np.array(rarefied) / liquid)))
        flow = np.exp(gas.log_flow_at(log_p)(np.log([u / flight])))
        assert flow[0] == pytest.approx(ratio, rel=0.1)


def test_larger_load_before_is_that_of_the_simulation():
    """The theory's pressure of first loading that lets as much through, against the samples that were unloaded."""
    spectrum = {"kind": "self-affine", "rms_height": "1 um", "hurst": 0.8}
    spectrum |= {"q_low": "2e4 1/m", "q_rolloff": "5e4 1/m", "q_high": "2e5 1/m"}
    given = case(roughness={"spectrum": spectrum}, direct={**SMALL, "points": 128, "unload": ["40 MPa"]})
    found = direct_settings(given).table(rough_contact(given))
    # the patch holds all waves
    assert found.simulation.patch.slope_cut < 0.01
    back = found.rows[-1]
    liquid = found.conductivity_table(1e5, 1e9)
    at = liquid.first_loading(np.log([back.pressure]), np.log([back.largest_pressure]))
    first = found.rows[0].effective_gap
    assert back.effective_gap < 0.8 * first
    assert liquid.at_log_pressure(at)[0] ** 3 == pytest.approx(back.effective_gap**3, rel=0.2)


@pytest.mark.parametrize(
    "change",
    [
        {"hardness": 0.8 * 3.5e9},
        {"effective_modulus": 1.03e11},
        {"spectrum": simulated()[1].spectrum.scaled(1.2)},
    ],
)
def test_neighbour_that_is_not_simulated_has_the_factor_of_the_one_that_is(change):
    settings, surface = simulated()
    other = replace(surface, **change)
    corrected = settings.of_neighbour(surface, other, lambda x: x.conductivity_table(1e5, 1e9, 64))
    rows = settings.table(other).rows[:2]
    assert corrected.effective_separation([x.pressure for x in rows]) ** 3 == pytest.approx(
        np.array([x.effective_gap for x in rows]) ** 3, rel=0.1
    )
    # and the simulated one is itself
    same = settings.of_neighbour(surface, surface, lambda x: x.conductivity_table(1e5, 1e9, 64))
    own = settings.table(surface).rows[:2]
    assert same.effective_separation([x.pressure for x in own]) == pytest.approx(
        [x.effective_gap for x in own], rel=0.01
    )


def test_gas_uncertain_inputs_and_a_larger_load_before_in_a_run():
    tables = {
        "leak": {"conductivity": "direct"},
        "direct": SMALL,
        "load": {"fluid_pressure": "20 bar"},
        "fluid": {"name": "helium", "outlet_pressure": "1 bar"},
    }
    plain = fem_seal.run(case(**tables), sensitivities=False).loads[0]
    tables["load"] = {"fluid_pressure": "20 bar", "largest_earlier_force": "4 kN"}
    tables["uncertainty"] = {"samples": 16, "hardness": {"relative": 0.1}}
    after = fem_seal.run(case(**tables), sensitivities=False)
    (load,) = after.loads
    assert load.leak.leak_rate < 0.9 * plain.leak.leak_rate
    low, high = load.sample_ends
    assert low < load.leak.leak_rate < high
    # both are in the interval, as independent errors are
    down = np.hypot(*(np.log(load.leak.leak_rate / x) for x in (low, load.leak_range.low)))
    assert load.calculated_ends.low == pytest.approx(load.leak.leak_rate * np.exp(-down))
    assert load.leak_interval.high >= load.calculated_ends.high > max(high, load.leak_range.high)


def test_what_is_wrong_with_the_simulation_is_said_before_the_bodies_are_solved():
    said: list[str] = []
    tight = case(
        leak={"conductivity": "direct"}, direct={**SMALL, "points": 32, "pressure": ["2 GPa", "3 GPa"]}
    )
    with pytest.raises(InputError, match="tight at all of them"):
        fem_seal.run(tight, progress=said.append)
    assert said[-1] == "direct simulation: 6 of 6 pieces"
    with pytest.raises(InputError, match=r"direct: size = 0.001 um"):
        fem_seal.run(case(leak={"conductivity": "direct"}, direct={**SMALL, "size": "1 nm"}))


def test_what_does_not_go_with_it():
    assert "leak.conductivity" in wrong(leak={"conductivity": "direct"})
    assert "reaches the hardness" in wrong(direct={"pressure": "4 GPa"})
    assert "only smaller ones come after it" in wrong(direct={"pressure": "1 GPa", "unload": "2 GPa"})
    assert "has unload, which needs pressure" in wrong(direct={"unload": "2 GPa"})
    assert "direct.yield_stress" in wrong(direct={"yield_stress": "1 GPa"})
    assert 'add asperities = "von-mises"' in wrong(direct={"asperities": "capped", "yield_stress": "1 GPa"})
    for asked in ("capped", "von-mises"):
        never = wrong(direct={"asperities": asked}, leak={"plasticity": False})
        assert f'direct.asperities = "{asked}"' in never
        assert "leak.plasticity is false" in never
    plain = {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3}
    bodies = {
        "closure": {"shape": "ball", "radius": "20 mm", "material": plain},
        "seat": {"shape": "cone", "angle": "45 deg", "material": plain},
        "leak": {"plasticity": False},
    }
    assert "needs a hardness or direct.yield_stress" in wrong(direct={"asperities": "von-mises"}, **bodies)
    assert "needs a hardness, and there is none" in wrong(direct={"asperities": "capped"}, **bodies)
    given = case(direct={"asperities": "von-mises", "yield_stress": "1 GPa"}, **bodies)
    assert direct_settings(given).of(rough_contact(given)).settings.yield_stress == 1e9
    assert "remove size" in wrong(direct={"file": "map.x3p", "size": "1 mm"})


@pytest.mark.slow
def test_command_writes_tables_and_pictures(tmp_path, capsys):
    file = tmp_path / "seal.toml"
    file.write_text(CASE)
    assert cli.main(["direct", str(file), "--jobs", "2"]) == 0
    out, said = capsys.readouterr()
    assert "of the height variance" in out
    assert "direct simulation: 11 of 11 pieces" in said
    folder = tmp_path / "seal.direct"
    assert {path.name for path in folder.iterdir()} == {
        "direct.csv", "direct_gaps.csv", "direct.json", "direct.svg", "direct_map_low.svg",
        "direct_map_middle.svg", "direct_map_high.svg", "pieces",
    }  # fmt: skip
    written = pd.read_csv(folder / "direct.csv")
    assert list(written.branch) == ["load", "load", "load", "unload"]
    assert written.conductivity_m3_per_Pa_s[0] == pytest.approx(
        written.effective_gap_m[0] ** 3 / (12 * 1.0016e-3), rel=0.01
    )
    # two processes find what one does
    assert written.effective_gap_m.to_numpy() == pytest.approx(
        [row.effective_gap for row in table().rows], rel=1e-9
    )
    # everything is there: the second call only shows it
    assert cli.main(["direct", str(file), "--json"]) == 0
    out, said = capsys.readouterr()
    assert "pieces" not in said
    shown = json.loads(out)
    assert shown["points"] == 64
    assert shown["pressures"][0]["effective_gap_m"] == pytest.approx(written.effective_gap_m[0], rel=1e-9)


def test_measured_map_is_simulated(tmp_path, monkeypatch):
    import leak

    _, surface = simulated()
    heights = leak.random_map(surface.spectrum, size=5e-4, points=48, seed=4)
    scan = leak.height_map(heights, (5e-4 / 48, 5e-4 / 48))
    monkeypatch.setattr(leak, "read_topography", lambda path, unit=None: scan)
    given = case(direct={"file": "map.x3p", "pressure": "100 MPa", "points": 64})
    found = direct_settings(given).table(rough_contact(given))
    assert found.simulation.patch.points == 64  # 96 after mirroring, no more than the table says
    assert found.simulation.patch.size == pytest.approx(1e-3)
    assert found.rows[0].samples == 1
    assert np.isnan(found.rows[0].contact_area_scatter)
    # there is no scatter of samples, but the flow both ways through the map differs
    row = found.rows[0]
    piece = found.simulation.pieces()[0]
    x, y = next(found.simulation.records(piece))[3:5]
    low, high = found.log_error(row)
    assert low == pytest.approx(abs(np.log(x / y)))
    assert high >= low > 0.01
    one_way = replace(row, log_directions=np.inf)
    assert found.log_error(one_way)[0] == pytest.approx(np.log(10.0))
    assert "Measured map" in direct_lines(Display(), found)[0]
    line = leak.line_scan(np.arange(64) * 1e-6, 1e-7 * np.sin(np.arange(64)))
    monkeypatch.setattr(leak, "read_topography", lambda path, unit=None: line)
    with pytest.raises(InputError, match="line scan"):
        direct_settings(given).of(rough_contact(given))
