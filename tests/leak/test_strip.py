"""A strip of a line contact simulated directly: Hertz without roughness, strips of others with it."""

import csv
from itertools import groupby

import numpy as np
import pytest
from places import SHARED

import leak
from leak.direct import PeriodicHalfSpace, Strip, press_elastoplastic, rest_gap

STRIPS = SHARED / "reference" / "strips.csv"
E_STAR, RADIUS = 115e9, 0.02


def _cylinder(n: int, width: float) -> np.ndarray:
    x = ((np.arange(n) + 0.5) / n - 0.5) * width
    return x**2 / (2.0 * RADIUS)


def test_hertz_line_contact_without_roughness():
    line_load, width, n = 5e3, 2e-3, 1024
    strip = Strip(None, (n, 4), width, _cylinder(n, width))
    state = strip.press(line_load, effective_modulus=E_STAR)
    a = np.sqrt(4.0 * line_load * RADIUS / (np.pi * E_STAR))
    p0 = 2.0 * line_load / (np.pi * a)
    x = ((np.arange(n) + 0.5) / n - 0.5) * width
    hertz = p0 * np.sqrt(np.clip(1.0 - (x / a) ** 2, 0.0, None))
    # the strip is 30 half-widths wide, and its images bend the cylinder by the square of their ratio
    assert np.abs(state.profile - hertz).max() < 0.03 * p0
    assert state.conductance == 0.0


def test_a_rectangle_is_the_square_beside_itself():
    spectrum = leak.PowerSpectrum.self_affine(
        rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=4e5
    )
    h = leak.random_map(spectrum, size=6e-4, points=32, seed=3)
    square, twice = PeriodicHalfSpace(32, 6e-4, E_STAR), PeriodicHalfSpace((32, 64), 6e-4, E_STAR)
    p = np.clip(h, 0.0, None) * 1e15
    one, two = square.displacement(p), twice.displacement(np.tile(p, (1, 2)))
    assert np.allclose(np.tile(one, (1, 2)), two, atol=1e-12 * np.abs(one).max())
    (state,) = press_elastoplastic(square, h, [2e7], yield_stress=5e8, layers=8)
    (beside,) = press_elastoplastic(twice, np.tile(h, (1, 2)), [2e7], yield_stress=5e8, layers=8)
    # both grids reach down to a third of their shorter side
    assert np.allclose(np.tile(state.gap, (1, 2)), beside.gap, atol=2e-3 * h.std())


def test_a_rectangular_map_has_the_spectrum():
    spectrum = leak.PowerSpectrum.self_affine(
        rms_height=1e-6, hurst=0.8, q_low=2e4, q_rolloff=5e4, q_high=4e5
    )
    maps = [leak.random_map(spectrum, size=2e-3, points=(256, 128), seed=seed) for seed in range(12)]
    assert maps[0].shape == (256, 128)
    assert np.sqrt(np.mean(np.square(maps))) == pytest.approx(1e-6, rel=0.02)
    along, across = (np.sqrt(np.mean(np.square(np.diff(maps, axis=axis)))) for axis in (1, 2))
    assert along == pytest.approx(across, rel=0.03)


def test_rest_gap_is_undone_by_the_same_pressure():
    n, width = 64, 1e-3
    x = ((np.arange(n) + 0.5) / n - 0.5) * width
    gap, pressure = 2e-6 + x**2 / 0.04, 5e7 * np.exp(-0.5 * (x / 1e-4) ** 2)
    rest = rest_gap(gap, pressure, width, E_STAR)
    moved = PeriodicHalfSpace((n, 1), width, E_STAR).displacement(pressure[:, None])[:, 0]
    assert np.ptp(rest + moved - gap) < 1e-15
    assert rest.min() == 0.0


def test_wrong_strips_are_named():
    spectrum = leak.PowerSpectrum.self_affine(
        rms_height=1e-6, hurst=0.8, q_low=1e7, q_rolloff=2e7, q_high=1e8
    )
    with pytest.raises(leak.DirectError, match="take more points or a narrower strip"):
        Strip(spectrum, (64, 32), 1e-3, np.zeros(64))
    with pytest.raises(leak.DirectError, match="macroscopic_gap has shape"):
        Strip(None, (64, 32), 1e-3, np.zeros(32))


@pytest.mark.slow
@pytest.mark.skipif(not STRIPS.is_file(), reason="reference strips of another program are not here")
@pytest.mark.parametrize("kind", ["elastic", "capped"])
def test_strips_of_another_program(kind):
    """Ten pieces of each of four seals: both means within three standard errors of their difference."""
    with STRIPS.open() as file:
        rows = [row for row in csv.DictReader(file) if row["model"] == kind]
    for case, group in groupby(rows, key=lambda row: row["case"]):
        theirs = list(group)
        value = {name: float(number) for name, number in theirs[0].items() if name not in ("case", "model")}
        spectrum = leak.PowerSpectrum.self_affine(
            rms_height=value["rms_height_m"],
            hurst=value["hurst"],
            q_low=value["q_low"],
            q_rolloff=value["q_rolloff"],
            q_high=value["q_high"],
        )
        n, width = 512, value["L_m"]
        x = ((np.arange(n) + 0.5) / n - 0.5) * width
        strip = Strip(spectrum, (n, 256), width, x**2 / (2.0 * value["R_m"]))
        own = [
            strip.press(
                value["line_load"],
                effective_modulus=value["E_star_Pa"],
                seed=seed,
                asperities=kind,
                hardness=value["hardness"],
            ).conductance
            for seed in range(8)
        ]
        reference = [float(row["conductance_m2"]) for row in theirs]
        error = np.hypot(np.std(own, ddof=1) / 8**0.5, np.std(reference, ddof=1) / len(reference) ** 0.5)
        assert abs(np.mean(own) - np.mean(reference)) < 3.0 * error, case
