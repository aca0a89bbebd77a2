"""A case with a turned face whose crests are simulated: pieces, tables, leak rate and what is refused."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pandas as pd
import pytest
from places import EXAMPLES

import fem_seal
import leak
from fem_seal.cli import app as cli
from fem_seal.seal.problem import SealProblem, direct_settings, rough_contact

FINE = {"rms_height": "0.1 um", "hurst": 0.8, "q_rolloff": "2.5e5 1/m", "q_high": "1.5e6 1/m"}
TURNED = {"process": "turned", "feed": "0.1 mm", "nose_radius": "0.8 mm", "fine": FINE}
SMALL = {"points": 64, "pressure": ["8 MPa", "20 MPa", "50 MPa"]}


def case_of(direct: dict[str, Any] | None = None, **changes: Any) -> fem_seal.Case:
    base = fem_seal.load_case(EXAMPLES / "ball_cone.toml")
    tables = {"roughness": {"seat": TURNED}, "direct": SMALL if direct is None else direct}
    load = {"load.fluid_pressure": "1 bar", "load.applied_force": "5 kN", "closure.radius": "200 mm"}
    return base.replace({**tables, **load, "leak.theory": "corrected", **changes})


@cache
def solved() -> fem_seal.SealResult:
    changes = {"leak.conductivity": "direct", "roughness.seat.spiral": False}
    return fem_seal.run(case_of(**changes), sensitivities=False)


@cache
def texture() -> leak.direct.TextureResult:
    """The library itself."""
    surface = rough_contact(case_of())
    assert isinstance(surface, leak.TurnedContact)
    metal = {"effective_modulus": surface.effective_modulus, "hardness": surface.hardness}
    return leak.direct.simulate_texture(surface.texture, **metal, pressures=[8e6, 2e7, 5e7], points=64)


def test_rows_are_those_of_the_library():
    table = fem_seal.direct(case_of())
    rows, found = table.rows, texture()
    assert [row.effective_gap**3 for row in rows] == pytest.approx(found.k_across, rel=1e-9)
    assert [row.mean_gap for row in rows] == pytest.approx(found.mean_gap, rel=1e-9)
    assert [row.contact_area for row in rows] == pytest.approx(found.contact_area, rel=1e-9)
    # two standard errors of the seeds, growing with the pressure, and what the theory says of waves that are cut
    relative = found.k_across_error / found.k_across
    scatter = 2.0 * np.sqrt(np.log1p(2.0 * np.maximum.accumulate(relative) ** 2) / 2.0)
    simulation = table.simulation
    whole, held = (
        np.asarray(surface.flow_conductivity(found.pressure, 1.0))
        for surface in (simulation.surface, simulation.patch_surface)
    )
    cut = np.log(whole / held)
    for row, error, waves in zip(rows, scatter, cut, strict=True):
        low, high = table.log_error(row)
        assert low == pytest.approx(error + max(-waves, 0.0))
        # short crests in series: the square of the scatter, of which the error of two seeds has two roots
        assert high == pytest.approx(error + 0.5 * error**2 + max(waves, 0.0))


def test_closed_form_stands_beside_it():
    table = fem_seal.direct(case_of())
    for row in table.rows:
        assert row.theory is not None
        (gap,) = row.theory.gap.values()
        assert 0.5 < (row.effective_gap / gap) ** 3 < 2.0
        assert row.mean_gap == pytest.approx(row.theory.mean_gap, rel=0.1)


def test_unless_given_the_grid_is_that_of_the_face():
    surface = rough_contact(case_of())
    assert isinstance(surface, leak.TurnedContact)
    settings = direct_settings(case_of({}))
    assert (settings.points, settings.samples) == (leak.direct.texture_points(surface.texture), 2)
    pressures = settings.of(surface).settings.pressures
    assert len(pressures) == 12
    assert pressures[-1] == pytest.approx(surface.sealing_pressure, rel=1e-3)
    assert surface.contact_area(pressures[0]) == pytest.approx(0.002, rel=1e-3)
    given = direct_settings(case_of({"points": 64, "samples": 3}))
    assert (given.points, given.samples) == (64, 3)


def test_leak_rate_is_that_of_the_simulated_crests():
    """Mean resistance of the contact with k over the theory drawn straight between the three simulated states."""
    (load,) = solved().loads
    (profile,) = load.profiles
    found, surface = texture(), solved().surface
    assert isinstance(surface, leak.TurnedContact) and load.leak is not None
    assert profile.peak_pressure < found.pressure[-1]
    theory = np.asarray(surface.flow_conductivity(found.pressure, 1.0)) * 12.0
    p = np.maximum(profile.pressure, 1.0)
    factor = np.interp(np.log(p), np.log(found.pressure), np.log(found.k_across / theory))
    sigma = np.asarray(surface.flow_conductivity(p, 1.0016e-3)) * np.exp(factor)
    resistance = np.trapezoid(1.0 / (2.0 * math.pi * profile.radius * sigma), profile.x)
    assert load.leak.leak_rate == pytest.approx(load.fluid_pressure / resistance, rel=0.05)
    assert load.leak_interval is not None
    low, high = load.leak_interval
    assert low < load.leak.leak_rate < high
    assert load.flow_error is None


def test_table_goes_through_the_simulated_states_and_has_the_thread():
    found, case = texture(), case_of(**{"leak.conductivity": "direct"})
    surface, flow = rough_contact(case), SealProblem.of(case).flow
    assert isinstance(surface, leak.TurnedContact) and flow is not None
    for radius in (surface.thread_radius, 0.2e-3):
        # so near the axis the thread counts
        table = flow.table(replace(surface, thread_radius=radius), 1e5, 1e9)
        k = np.asarray(table.liquid.effective_separation(found.pressure)) ** 3
        winding = (1e-4 / (2.0 * math.pi * radius)) ** 2
        thread = winding * np.mean(surface.valley_gaps(found.pressure) ** 3, axis=-1)
        assert k == pytest.approx(found.k_across + thread, rel=0.02)


@pytest.mark.parametrize("pressure", [8e6, 2e7])
def test_gas_flows_through_the_simulated_crests(pressure):
    """The table against the flow of a rarefied gas through the same pressed faces: of free molecules a quarter less."""
    from leak.direct import PressedPatch, press

    found = fem_seal.direct(case_of())
    simulation, log_p = found.simulation, np.log([pressure])
    gas = found.conductivity_table(1e5, 1e9, of_gas=True)
    u = float(gas.at_log_pressure(log_p)[0])
    H = simulation.surface.hardness
    states = [press(simulation.body, simulation.map(k), pressure, hardness=H) for k in range(2)]
    for flight in (1e-7, 1e-6, 1e-5):
        k, k_gas = (
            np.mean([PressedPatch.of(x, periodic=True, flight=way).gap_cubed_along for x in states])
            for way in (None, flight)
        )
        flow = np.exp(gas.log_flow_at(log_p)(np.log([u / flight])))
        assert flow[0] == pytest.approx(k_gas / k, rel=0.25)


@pytest.mark.parametrize("key", ["hardness", "effective_modulus", "fine"])
def test_neighbour_that_is_not_simulated_has_the_factor_of_the_one_that_is(key):
    settings, surface = direct_settings(case_of()), rough_contact(case_of())
    assert isinstance(surface, leak.TurnedContact)
    value = surface.fine.scaled(1.2) if key == "fine" else 0.85 * getattr(surface, key)
    other = replace(surface, **{key: value})
    table = settings.of_neighbour(surface, other, lambda x: x.conductivity_table(1e5, 1e9))
    # the highest pressure is next to sealing, where few places decide
    rows = settings.table(other).rows[:2]
    k = np.array([row.effective_gap for row in rows]) ** 3
    assert table.liquid.effective_separation([row.pressure for row in rows]) ** 3 == pytest.approx(k, rel=0.1)


def test_a_second_case_takes_the_pieces_of_the_first(tmp_path, monkeypatch):
    monkeypatch.setenv("FEM_SEAL_CACHE", str(tmp_path))
    case = case_of({"points": 32, "samples": 1, "pressure": ["8 MPa", "20 MPa"]})
    said: list[str] = []
    first = fem_seal.direct(case, progress=said.append)
    assert said[-1] == "direct simulation: 2 of 2 pieces"
    said.clear()
    # rings or a thread, and another load, are of no concern to the crests
    other = case.replace({"roughness.seat.spiral": False, "load.applied_force": "7 kN"})
    assert [row.effective_gap for row in fem_seal.direct(other, progress=said.append).rows] == [
        row.effective_gap for row in first.rows
    ]
    assert said == []
    fem_seal.direct(case.replace({"roughness.seat.nose_radius": "0.9 mm"}), progress=said.append)
    assert said[-1] == "direct simulation: 2 of 2 pieces"


def test_nearly_sealed_crests_have_an_upper_end():
    direct = {"points": 32, "samples": 1, "pressure": ["5 MPa", "10 MPa"]}
    (load,) = fem_seal.run(
        case_of(direct, **{"leak.conductivity": "direct", "roughness.seat.spiral": False}),
        sensitivities=False,
    ).loads
    found = {caution.entry: caution for caution in load.validity.cautions}
    assert "crests_nearly_sealed" in found and "direct_range" not in found
    assert load.leak is not None and load.leak_interval is not None
    assert load.leak_interval.high > 2.0 * load.leak.leak_rate


@pytest.mark.parametrize(
    ("direct", "words"),
    [
        ({"waves": 4}, "direct.waves"),
        ({"size": "0.2 mm"}, "direct.size"),
        ({"direction": "x"}, "direct.direction"),
        ({"amplitudes": "gaussian"}, "direct.amplitudes"),
        ({"points": 65}, "direct.points"),
    ],
)
def test_options_of_random_patches_are_refused(direct, words):
    with pytest.raises(fem_seal.InputError, match=words):
        case_of(direct)


def test_command_writes_table_and_pictures(tmp_path, capsys):
    file = tmp_path / "turned.toml"
    file.write_text(str(case_of({"points": 32, "pressure": ["8 MPa", "20 MPa"]})), encoding="utf-8")
    assert cli.main(["direct", str(file), "--jobs", "1"]) == 0
    shown = capsys.readouterr().out
    assert "2 patches of two crests" in shown and "conserved" not in shown
    folder = tmp_path / "turned.direct"
    rows = pd.read_csv(folder / "direct.csv")
    assert rows.effective_gap_m.is_monotonic_decreasing and rows.theory_effective_gap_capped_m.notna().all()
    assert {path.name for path in folder.glob("*.svg")} == {
        "direct.svg", "direct_map_low.svg", "direct_map_middle.svg", "direct_map_high.svg",
    }  # fmt: skip
    assert cli.main(["direct", "--seal", str(file)]) == 2
    assert "without --seal" in capsys.readouterr().err


def test_crests_of_unlike_heights_have_the_factor_of_alike_ones():
    settings, surface = direct_settings(case_of()), rough_contact(case_of())
    assert isinstance(surface, leak.TurnedContact)
    unlike = replace(surface, crest_scatter=0.3 * surface.texture.crest_height)
    p = [8e6, 2e7]
    found, alike, theory, theory_alike = (
        np.asarray(table.effective_separation(p)) ** 3
        for table in (
            settings.conductivity(unlike, 1e5, 1e9).liquid,
            settings.conductivity(surface, 1e5, 1e9).liquid,
            unlike,
            surface,
        )
    )
    assert found / alike == pytest.approx(theory / theory_alike, rel=0.05)
    assert settings.table(unlike) is settings.table(surface)
