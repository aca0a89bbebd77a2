"""The face of a case simulated as machined: kept once for all faces that are similar."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

import leak
from fem_seal.errors import InputError
from fem_seal.seal.direct import DirectSettings
from fem_seal.seal.direct_texture import TextureSimulation, simulate_face


def face(scale=1.0, modulus=115e9, hardness_over_modulus=0.03):
    fine = leak.PowerSpectrum.self_affine(
        rms_height=scale * 1e-7,
        hurst=0.8,
        q_low=2.0 * math.pi / (4e-4 * scale),
        q_rolloff=2.0 * math.pi / (2.5e-5 * scale),
        q_high=2.0 * math.pi / (1e-5 * scale),
    )
    return leak.TurnedContact(
        feed=1e-4 * scale,
        nose_radius=8e-4 * scale,
        fine=fine,
        effective_modulus=modulus,
        hardness=hardness_over_modulus * modulus,
    )


@pytest.mark.parametrize("asperities", ["elastic", "capped"])
def test_a_similar_face_is_in_the_store(tmp_path, monkeypatch, asperities):
    monkeypatch.setenv("FEM_SEAL_CACHE", str(tmp_path / "cache"))
    settings = DirectSettings(
        samples=2, pressures=(1e7, 4e7), asperities=asperities, folder=tmp_path / "case"
    )
    said: list[str] = []
    first = simulate_face(face(), settings, progress=said.append)
    assert said[-1] == "direct simulation: 4 of 4 pieces"
    metal = {} if asperities == "elastic" else {"hardness": face().hardness}
    plain = leak.direct.simulate_texture(
        face().texture, effective_modulus=115e9, pressures=[1e7, 4e7], **metal
    )
    assert first.k_across == pytest.approx(plain.k_across, rel=1e-12)
    assert first.mean_gap == pytest.approx(plain.mean_gap, rel=1e-12)
    # a face of half the size of a metal of twice the modulus and hardness
    said.clear()
    settings = replace(settings, pressures=(2e7, 8e7), folder=tmp_path / "other")
    second = simulate_face(face(0.5, 230e9), settings, progress=said.append)
    assert said == []
    assert second.k_across == pytest.approx(first.k_across / 8.0, rel=1e-12)
    assert second.k_along == pytest.approx(first.k_along / 8.0, rel=1e-12)
    assert second.contact_area.tolist() == first.contact_area.tolist()
    assert len(list((tmp_path / "other" / "pieces").iterdir())) == 4


def test_another_face_is_another_piece():
    settings = DirectSettings(samples=1, pressures=(1e7,))
    simulations = [
        TextureSimulation(face(), settings),
        TextureSimulation(face(), replace(settings, seed=2)),
        TextureSimulation(face(), replace(settings, pressures=(2e7,))),
        TextureSimulation(face(), replace(settings, asperities="elastic")),
        TextureSimulation(face(), replace(settings, asperities="von-mises")),
        TextureSimulation(face(hardness_over_modulus=0.02), settings),
        TextureSimulation(face(modulus=120e9), settings),
        TextureSimulation(replace(face(), feed=1.1e-4), settings),
        TextureSimulation(replace(face(), nose_radius=9e-4), settings),
        TextureSimulation(replace(face(), fine=face(0.9).fine), settings),
    ]
    keys = {key for s in simulations for piece in s.pieces() for key in s.keys(piece)}
    assert len(keys) == len(simulations)


@pytest.mark.slow
def test_metal_that_flows_is_one_path():
    settings = DirectSettings(samples=1, pressures=(4e7, 1e7), asperities="von-mises")
    (piece,) = TextureSimulation(face(), settings).pieces()
    assert piece.pressures == (1e7, 4e7)
    states = simulate_face(face(), settings)
    assert states.k_across[1] < states.k_across[0]


def test_metal_that_flows_needs_a_stress():
    soft = replace(face(), hardness=None)
    with pytest.raises(InputError, match="yield_stress"):
        simulate_face(soft, DirectSettings(samples=1, pressures=(1e7,), asperities="von-mises"))


def test_usual_pressures_end_where_the_face_is_sealed():
    pressures = TextureSimulation(face(), DirectSettings()).pressures
    assert len(pressures) == 12
    assert pressures[-1] == pytest.approx(face().sealing_pressure, rel=1e-3)
    assert face().contact_area(pressures[0]) == pytest.approx(0.002, rel=1e-3)
