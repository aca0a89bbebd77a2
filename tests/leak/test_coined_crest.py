"""Crests that an earlier load has coined: contact of flats, by theory, and by direct simulation of unloading."""

from __future__ import annotations

import csv
import math
from functools import cache
from itertools import groupby

import numpy as np
import pytest
from places import ROOT
from scipy.integrate import quad
from scipy.optimize import nnls

import leak
from leak.theory.coined_crest import CoinedCrests
from leak.theory.crest_line import CrestLines

DIRECT = ROOT / "benchmarks" / "turned_unloaded.csv"


def face(scale: float = 1.0, hardness: float | None = 3.5e9, **changes) -> leak.TurnedContact:
    fine = leak.PowerSpectrum.self_affine(
        rms_height=1e-7 * scale,
        hurst=0.8,
        q_low=3.1416e4 / scale,
        q_rolloff=2.5133e5 / scale,
        q_high=4.0212e6 / scale,
    )
    given = {"feed": 1e-4 * scale, "nose_radius": 8e-4 * scale, "fine": fine, "effective_modulus": 115e9}
    return leak.TurnedContact(**{**given, "hardness": hardness, **changes})


@cache
def steel() -> leak.TurnedContact:
    return face()


def coined(depth: float, level: float, yielded: float = 1.0, places: int = 32) -> CoinedCrests:
    """Cusps of slope 1/16 whose places are lower by up to a depth, after a flat at a level."""
    across = np.abs(np.arange(-64, 65)) * 1e-7
    heights = np.broadcast_to(-across / 16.0, (1, places, across.size)).copy()
    heights -= depth * np.random.default_rng(1).random((1, places, 1))
    lines = CrestLines(heights, 1e-7, 1e-4, 115e9, 3.5e9)
    return CoinedCrests(lines, level, lines.press(level).width, yielded)


def test_equal_places_come_back_as_far_as_they_sank() -> None:
    crest = coined(0.0, -0.6e-7)
    width = crest.width.mean()
    # all places alike give as the mean wave does
    give = crest.lines.give_under(crest.width)[0, 0, 0]
    assert crest.way == pytest.approx(give * width, rel=1e-9)
    for share in (0.1, 0.5, 0.9):
        load, gap = crest.press(crest.level + share * crest.way, crest.width)
        assert load == pytest.approx(np.full(load.shape, (1.0 - share) * width), rel=1e-2)
        assert (gap == 0.0).all()


def test_what_has_not_yielded_comes_back_to_its_height() -> None:
    elastic, half = coined(6e-8, -0.8e-7, 0.0), coined(6e-8, -0.8e-7, 0.5)
    assert elastic.tops == pytest.approx(elastic.lines.tops, abs=1e-15)
    assert (half.tops <= half.lines.tops + 1e-15).all()
    assert (half.tops >= coined(6e-8, -0.8e-7).tops).all()


def test_places_carry_or_lift_as_of_least_energy() -> None:
    """Against non-negative least squares of the whole matrix."""
    crest = coined(6e-8, -0.8e-7)
    touched = crest.width[0] > 0.0
    assert 0.3 < touched.mean() < 1.0
    n = touched.size
    give = np.fft.irfft(
        crest.lines.give_under(crest.width)[0, 0, :, None] * np.fft.rfft(np.eye(n), axis=0), n, axis=0
    )
    for share in (0.1, 0.4, 0.8):
        level = crest.level + share * crest.way
        root = np.linalg.cholesky(give[np.ix_(touched, touched)])
        expected = np.zeros(n)
        expected[touched] = nnls(root.T, np.linalg.solve(root, crest.tops[0, touched] - level))[0]
        load, gap = crest.press(level, crest.width)
        assert load[0] == pytest.approx(expected, abs=2e-3 * crest.width.max())
        assert gap[0, load[0] > 0.0] == pytest.approx(0.0)
        lifted = level + give @ expected - crest.tops[0]
        assert gap[0, load[0] == 0.0] == pytest.approx(lifted[load[0] == 0.0], abs=2e-3 * crest.way)


def test_a_lifted_flat_is_a_throat_of_its_own_width() -> None:
    g, w, m = 3e-8, 2e-6, steel().texture.side_slope
    sides = quad(lambda x: 2.0 / (g + m * x) ** 3, 0.0, 1e4 * g / m, limit=500)[0]
    throats = steel()._throats(np.array([[g, g, 0.0]]), np.array([[w, 0.0, w]]))
    assert throats[0] == pytest.approx([1.0 / (w / g**3 + sides), 1.0 / sides, 0.0], rel=1e-4)


def test_all_places_lift_in_the_end() -> None:
    pressures = np.array([pressure for pressure, _ in coined(6e-8, -0.8e-7).lift()])
    assert (np.diff(pressures) < 0.0).all() and 0.0 < pressures[-1] < 1e-2 * pressures[0]


def test_two_turned_faces_remember_as_well() -> None:
    both = face(other=leak.Cusps(feed=1.5e-4, nose_radius=8e-4))
    p, largest = np.array([5e6, 1e7, 2e7]), 4e7
    first, after = both.flow_conductivity(p, 1e-3), both.flow_conductivity(p, 1e-3, largest=largest)
    assert (np.asarray(after) < 0.95 * np.asarray(first)).all() and (np.diff(after) < 0.0).all()
    assert (np.asarray(after) > both.flow_conductivity(largest, 1e-3)).all()


def test_is_first_loading_where_nothing_larger_was_carried() -> None:
    p = np.geomspace(1e5, 4e8, 30)
    for largest in (p, 0.3 * p):
        assert steel().equivalent_first_loading_pressure(p, largest) == pytest.approx(p, rel=1e-12)
    first, after = steel().flow_conductivity(5e7, 1e-3), steel().flow_conductivity(5e7, 1e-3, largest=5.001e7)
    assert after == pytest.approx(first, rel=1e-3)
    assert steel().mean_separation(0.0, largest=1e8) == math.inf


def test_conducts_less_after_a_larger_load_and_under_a_larger_one() -> None:
    sealing = steel().sealing_pressure
    p, largest = np.geomspace(1e-3, 1.5, 40)[:, None] * sealing, np.geomspace(0.01, 2.0, 40) * sealing
    sigma = np.asarray(steel().flow_conductivity(p, 1e-3, largest=largest))
    assert (np.diff(sigma, axis=0) <= 0.0).all() and (np.diff(sigma, axis=1) <= 1e-3 * sigma[:, :-1]).all()
    equal = steel().equivalent_first_loading_pressure(p, largest)
    assert ((equal >= p * (1.0 - 1e-12)) & (equal <= np.maximum(p, largest) * (1.0 + 1e-12))).all()
    for name in ("mean_separation", "critical_separation", "effective_separation"):
        of = getattr(steel(), name)
        assert (np.asarray(of(p, largest=largest)) <= np.asarray(of(p)) * (1.0 + 1e-9)).all()


def test_elastic_crests_remember_nothing() -> None:
    elastic = face(hardness=None)
    p = np.array([1e6, 1e7, 5e7])
    assert elastic.equivalent_first_loading_pressure(p, 1e8) == pytest.approx(p, rel=1e-12)
    # and those that hardly yield next to nothing, as in direct simulation (-0.003 of ln k)
    hard = face(hardness=15e9)
    assert hard.flow_conductivity(p, 1e-3, largest=1e8) == pytest.approx(
        hard.flow_conductivity(p, 1e-3), rel=0.02
    )


def test_all_lengths_halved_conduct_an_eighth() -> None:
    p, largest = np.array([1e7, 4e7]), 9e7
    whole, half = (one.flow_conductivity(p, 1e-3, largest=largest) for one in (steel(), face(0.5)))
    assert half == pytest.approx(np.asarray(whole) / 8.0, rel=1e-6)
    softer = face(effective_modulus=11.5e9, hardness=0.35e9)
    assert softer.flow_conductivity(0.1 * p, 1e-3, largest=0.1 * largest) == pytest.approx(whole, rel=1e-6)


def test_tables_remember_with_and_without_a_thread_and_for_gases() -> None:
    thread = face(thread_radius=0.02)
    p, largest = np.log([2e7, 5e7]), np.log(1e8)
    expected = np.log(steel().equivalent_first_loading_pressure(np.exp(p), np.exp(largest)))
    for table in (
        steel().conductivity_table(1e6, 1e8),
        thread.conductivity_table(1e6, 1e8),
        thread.gas_conductivity_table(1e6, 1e8),
    ):
        assert table.first_loading(p, largest) == pytest.approx(expected, rel=1e-12)


@pytest.mark.slow
def test_crests_lost_in_the_roughness_have_its_memory() -> None:
    p, largest = np.array([2e7, 6e7]), 2e8
    fine = leak.PowerSpectrum.self_affine(
        rms_height=1e-6, hurst=0.8, q_low=3.1416e4, q_rolloff=2.5133e5, q_high=4.0212e6
    )
    rough = leak.RoughContact(fine, effective_modulus=115e9, hardness=3.5e9, theory="corrected")
    lost = face(fine=fine).equivalent_first_loading_pressure(p, largest)
    assert lost == pytest.approx(rough.equivalent_first_loading_pressure(p, largest), rel=1e-3)
    # between both ends ln p* is between as well
    heights = np.array([1.5, 2.5, 4.0, 6.0]) * 1e-7
    between = [
        np.log(face(fine=fine.scaled(height / 1e-6)).equivalent_first_loading_pressure(p, largest) / p)
        for height in heights
    ]
    assert np.isfinite(between).all() and (np.array(between) > 0.0).all()


def test_error_is_wider_after_a_load_that_nearly_sealed() -> None:
    first, after = (steel().flow_error(2.5e7, largest=largest) for largest in (None, 1.5e8))
    assert after.spread > first.spread


def states() -> list[tuple[leak.TurnedContact, float, float, np.ndarray, float]]:
    """Face, largest pressure and pressure of each state, conductivities of its cells and their mean gap."""
    found, faces = [], {}
    with DIRECT.open(encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["model"] == "capped"]
    for (name, largest, p), group in groupby(
        rows, key=lambda r: (r["face"], r["largest_Pa"], r["pressure_Pa"])
    ):
        cells = list(group)
        one = cells[0]
        wave = 2.0 * math.pi
        fine = leak.PowerSpectrum.self_affine(
            rms_height=float(one["fine_rms_m"]),
            hurst=float(one["hurst"]),
            q_low=math.pi / float(one["feed_m"]),
            q_rolloff=wave / float(one["rolloff_m"]),
            q_high=wave / float(one["shortest_m"]),
        )
        keys = {"feed": "feed_m", "nose_radius": "nose_radius_m", "effective_modulus": "E_star_Pa"}
        numbers = {key: float(one[column]) for key, column in keys.items()}
        of = faces.setdefault(
            name, leak.TurnedContact(fine=fine, hardness=float(one["hardness_Pa"]), **numbers)
        )
        across = np.array([float(cell["k_across_m3"]) for cell in cells])
        gap = float(np.mean([float(cell["mean_gap_m"]) for cell in cells]))
        found.append((of, float(largest), float(p), across, gap))
    return found


@pytest.mark.slow
def test_against_direct_simulation_of_unloading() -> None:
    """Nine faces in cells of two crests: means of three cells, and what a load changes in each cell.

    Cells that were nearly sealed vary by orders of magnitude: of them the own spread is asked.
    """
    known = states()
    first = {(of, p): across for of, largest, p, across, _ in known if p == largest}
    changes, errors, gaps, held = [], [], [], []
    for of, largest, p, across, gap in known:
        if p == largest:
            continue
        theory = of.flow_conductivity(p, 1.0 / 12.0, largest=largest)
        loaded, touch = (
            of.flow_conductivity(largest, 1.0 / 12.0),
            of.conductivity_table(1.0, 1e12).separation[0] ** 3,
        )
        waves = across.size * (2.0 * of.feed * of.fine.median_wavenumber / (2.0 * math.pi)) ** 2
        error = of.flow_error(p, waves=waves, largest=largest)
        low, high = error.factor([0.05, 0.95])
        held.append(low < across.mean() / theory < high)
        if loaded < 1e-3 * touch:
            continue
        if of.fine.rms_height < 0.13 * of.texture.crest_height:
            gaps.append(gap / of.mean_separation(p, largest=largest))
        errors.append(math.log(across.mean() / theory) - float(error.bias))
        if (of, p) in first and first[of, p].size == across.size:
            change = math.log(theory / of.flow_conductivity(p, 1.0 / 12.0))
            changes.append(np.mean(np.log(across / first[of, p])) - change)
    assert len(errors) >= 20 and len(changes) >= 15
    assert np.sqrt(np.mean(np.square(errors))) <= 0.35
    assert np.sqrt(np.mean(np.square(changes))) <= 0.15
    # 33 of 37; the other four in faces that the larger load had nearly sealed
    assert np.mean(held) > 0.88
    assert np.min(gaps) > 0.98 and np.max(gaps) < 1.08
