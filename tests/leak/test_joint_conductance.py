"""Heat across a rough contact against direct simulation, closed forms and Yovanovich's formulas."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import erfcinv

import leak
from leak.direct import PeriodicHalfSpace, patch_conductance, press
from leak.errors import LeakError

SPECTRUM = leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=1e6)
FACE = leak.RoughContact(SPECTRUM, effective_modulus=115e9, hardness=3.5e9, theory="corrected")
VACUUM = 0.0


SIDE, POINTS, SEEDS = 1.0, 128, 6
PATCH = leak.PowerSpectrum.self_affine(
    rms_height=1.0, hurst=0.8, q_low=2 * math.pi, q_rolloff=16 * math.pi, q_high=64 * math.pi
)
PATCH = PATCH.scaled(1.0 / PATCH.rms_slope)
ELASTIC = leak.RoughContact(PATCH, effective_modulus=1.0, theory="corrected")


@lru_cache(maxsize=60)
def pressed_gap(pressure: float, seed: int) -> np.ndarray:
    """Of a map whose waves have the amplitudes of the spectrum, so that maps scatter less; zero in its spots."""
    heights = leak.random_map(PATCH, size=SIDE, points=POINTS, seed=seed, amplitudes="exact")
    state = press(PeriodicHalfSpace(POINTS, SIDE, 1.0), heights, pressure, tolerance=1e-6)
    return np.where(state.pressure > 0.0, 0.0, np.maximum(state.gap, 1e-30))


def simulated(pressure: float, fluid_conductivity: float = 0.0, jump: float = 0.0) -> float:
    """Mean conductance of pressed maps, conductivity of the bodies one."""
    fluid = {"fluid_conductivity": fluid_conductivity, "jump": jump}
    gaps = [pressed_gap(pressure, seed) for seed in range(SEEDS)]
    return float(np.mean([patch_conductance(gap, SIDE, 1.0, **fluid) for gap in gaps]))


def test_simulated_heat_has_its_closed_forms():
    """What judges the theory is right itself: the spot of a square lattice, 1/(2 a k) without its neighbours."""
    n, a, k, side = 256, 0.08, 3.0, 2.0
    x = (np.arange(n) - n / 2) / n
    gap = np.where(np.hypot(x[:, None], x) < a, 0.0, 1.0)
    # they lower it by 3.900/(pi k L), the lattice sum of 1/r less its background; pixels and the next order: 2 %
    expected = 1.0 / (2 * a * side * k) - 3.900 / (math.pi * k * side)
    assert 1.0 / (patch_conductance(gap, side, k) * side**2) == pytest.approx(expected, rel=0.02)
    with pytest.raises(LeakError, match="nothing touches"):
        patch_conductance(np.ones((8, 8)), 1.0, 1.0)


@pytest.mark.parametrize(("pressure", "scatter"), [(0.003, 0.06), (0.03, 0.03)])
def test_spots_conduct_as_they_press(pressure, scatter):
    """Barber's analogy: conductance of the spots of a map is its stiffness, the theory's within two errors."""
    direct, step = simulated(pressure), 0.01
    softer, stiffer = (
        np.mean([pressed_gap(pressure * factor, seed).mean() for seed in range(SEEDS)])
        for factor in (1.0 - step, 1.0 + step)
    )
    assert 2 * step * pressure / (softer - stiffer) == pytest.approx(direct, rel=0.01)
    assert float(leak.joint_conductance(ELASTIC, pressure, 1.0)) == pytest.approx(direct, rel=scatter)


# gases with a jump of 0.3 and of 0.03 rms heights, and a liquid that conducts like water between steels
@pytest.mark.parametrize(
    ("ratio", "jump", "tolerance"), [(0.01, 0.3, 0.05), (0.01, 0.03, 0.06), (0.04, 0.0, 0.11)]
)
@pytest.mark.parametrize("pressure", [0.003, 0.03])
def test_joint_conductance_against_direct_simulation(pressure, ratio, jump, tolerance):
    length = jump * PATCH.rms_height
    fluid = leak.GapFluid(ratio, length)
    found = float(leak.joint_conductance(ELASTIC, pressure, 1.0, fluid, fluid_pressure=1.0))
    assert found == pytest.approx(simulated(pressure, ratio, length), rel=tolerance)
    # the field without the fluid is a trial field with it: between the spots alone, and all of the step across all gaps
    gaps = leak.GapDistribution.of(ELASTIC, [pressure])
    metal = 2 * ratio / PATCH.q_high
    all_of_it = ratio * float((gaps.weight / (gaps.separation + length + metal)).sum())
    spots = float(leak.joint_conductance(ELASTIC, pressure, 1.0))
    assert spots < found < spots + all_of_it


def test_wide_open_the_gap_alone_conducts():
    """Next to no spots: k_f int phi(z)/(u - z + M) dz over Gaussian heights around the mean gap."""
    pressure, fluid = 1e2, leak.GapFluid.of("nitrogen", 293.15)
    u, s, M = float(FACE.mean_separation(pressure)), SPECTRUM.rms_height, float(fluid.jump_length(1e5))
    gauss = quad(lambda t: math.exp(-0.5 * t**2) / (u - s * t + M), -8, u / s)[0] / math.sqrt(2 * math.pi)
    found = float(leak.joint_conductance(FACE, pressure, 15.0, fluid, fluid_pressure=1e5))
    assert found == pytest.approx(fluid.conductivity * gauss, rel=0.02)
    assert fluid.conductivity / (u + M) < found


def test_a_place_conducts_the_same_whatever_else_is_asked():
    helium, shares = leak.GapFluid.of("helium", 293.15), np.array([0.1, 0.2, 0.3, 0.4, 0.45, 0.5, 0.7, 0.8])

    def conductance(pressure):
        return leak.joint_conductance(FACE, pressure, 15.0, helium, fluid_pressure=1e5)

    p = shares * 3.5e9
    alone = np.array([float(conductance(one)) for one in p])
    between = np.array([conductance([3.5e7, one, 3.3e9])[1] for one in p])
    np.testing.assert_allclose(between, alone, rtol=3e-3)
    assert np.isfinite(alone).all() and (np.diff(alone) > 0).all()
    several = leak.joint_conductance(FACE, 1e7, 15.0, helium, fluid_pressure=[1e5, 2e5])
    each = [float(leak.joint_conductance(FACE, 1e7, 15.0, helium, fluid_pressure=one)) for one in (1e5, 2e5)]
    assert several == pytest.approx(each, rel=1e-12)


def test_limits():
    p = np.array([0.0, 1e5, 1e6, 1e7, 1e8, 3.5e9, 4e9])
    spots = leak.joint_conductance(FACE, p, 15.0)
    helium = leak.GapFluid.of("helium", 293.15)
    assert leak.joint_conductance(FACE, p, 15.0, helium, fluid_pressure=VACUUM).tolist() == spots.tolist()
    filled = leak.joint_conductance(FACE, p, 15.0, helium, fluid_pressure=1e5)
    assert spots[0] == filled[0] == 0.0 and np.isinf(spots[-2:]).all() and np.isinf(filled[-2:]).all()
    assert (
        (np.diff(spots[:6]) > 0).all()
        and (np.diff(filled[:6]) > 0).all()
        and (filled[1:5] > spots[1:5]).all()
    )
    # more where more was carried before, and no less with a denser gas
    assert (leak.joint_conductance(FACE, p[1:4], 15.0, largest=1e8) > spots[1:4]).all()
    denser = leak.joint_conductance(FACE, p[1:5], 15.0, helium, fluid_pressure=[1e6, 2e6, 3e6, 4e6])
    assert (denser > filled[1:5]).all()
    # all lengths ten times as long and no other: a tenth
    scaled = leak.RoughContact(
        leak.PowerSpectrum.self_affine(rms_height=1e-5, hurst=0.8, q_low=1e3, q_rolloff=5e3, q_high=1e5),
        effective_modulus=115e9,
        hardness=3.5e9,
        theory="corrected",
    )
    assert leak.joint_conductance(scaled, p[1:5], 15.0) == pytest.approx(0.1 * spots[1:5], rel=1e-6)


@pytest.mark.parametrize("kind", [{"theory": "corrected"}, {"theory": "paper"}])
def test_stiffness_of_elastic_asperities_is_the_slope_of_their_law(kind):
    face = leak.RoughContact(SPECTRUM, effective_modulus=115e9, **kind)
    p = np.array([1e5, 1e7, 3e8])
    slope = 2e-4 * p / (face.mean_separation(p * (1 - 1e-4)) - face.mean_separation(p * (1 + 1e-4)))
    assert face.contact_stiffness(p) == pytest.approx(slope, rel=1e-3)
    assert face.contact_stiffness(p, largest=1e9) == pytest.approx(face.contact_stiffness(p), rel=1e-12)


@pytest.mark.parametrize(
    "kind", [{"theory": "corrected"}, {"theory": "paper"}, {"theory": "paper", "yielding": "capped"}]
)
def test_yielded_asperities_are_stiffer_on_unloading(kind):
    """By the slope of the mean gap after a larger load, and more than on loading, as ultrasound finds it."""
    face = leak.RoughContact(SPECTRUM, effective_modulus=115e9, hardness=3.5e9, **kind)
    p = np.array([1e7, 1e8])
    higher, lower = (face.mean_separation(p * factor, largest=2e8) for factor in (1.001, 0.999))
    assert face.contact_stiffness(p, largest=2e8) == pytest.approx(2e-3 * p / (lower - higher), rel=0.02)
    loading = 0.02 * p / (face.mean_separation(0.99 * p) - face.mean_separation(1.01 * p))
    assert (face.contact_stiffness(p) > 1.3 * loading).all()


# Means of docs/research/joint_conductance.csv: four maps on half-spaces that flow by von Mises, E* = 1, slope 1, k = 1;
# hardness, pressure and largest pressure over it, conductance of the spots and of the joint in a gas of k_f = 0.01 and
# M = 0.3 rms heights.
VON_MISES = [
    (0.05, 0.05, 0.05, 1.184, 1.399),
    (0.05, 0.2, 0.2, 4.877, 5.225),
    (0.05, 0.1, 0.2, 3.558, 3.911),
    (0.05, 0.02, 0.2, 0.8858, 1.268),
    (0.3, 0.05, 0.05, 1.931, 2.188),
    (0.3, 0.2, 0.2, 8.623, 9.105),
    (0.3, 0.1, 0.2, 5.511, 5.934),
    (0.3, 0.02, 0.2, 1.376, 1.73),
]


@pytest.mark.parametrize(("hardness", "share", "largest", "spots", "joint"), VON_MISES)
def test_spots_of_metal_that_flows(hardness, share, largest, spots, joint):
    """20 % above on loading, 12 % below on unloading: the spring-back of the theory is fitted to gaps, not to heat.

    Elastic asperities conduct a sixth to a half of it.
    """
    spectrum = leak.PowerSpectrum.self_affine(
        rms_height=1.0, hurst=0.8, q_low=2 * math.pi, q_rolloff=8 * math.pi, q_high=32 * math.pi
    )
    spectrum = spectrum.scaled(1.0 / spectrum.rms_slope)
    face = leak.RoughContact(spectrum, effective_modulus=1.0, theory="corrected", hardness=hardness)
    gas = leak.GapFluid(0.01, 0.3 * spectrum.rms_height)
    p, earlier = share * hardness, largest * hardness
    for fluid, simulated_one in ((None, spots), (gas, joint)):
        found = float(leak.joint_conductance(face, p, 1.0, fluid, fluid_pressure=1.0, largest=earlier))
        assert 0.88 < found / simulated_one < 1.21
    assert float(leak.joint_conductance(face.elastic, p, 1.0)) < 0.65 * spots


@pytest.mark.parametrize("share", [1e-4, 1e-3, 1e-2])
def test_yovanovich(share):
    """h = 1.25 k (m/sigma) (P/H)^0.95 of spots, m the mean absolute slope of a profile, and the mean gap Y.

    The formula is that of plastic asperities and knows only m/sigma of the surface: spots of waves up to 4 and up to
    100 times shorter than the roll-off differ by a factor of two.
    """
    slope, height = SPECTRUM.rms_slope / math.sqrt(math.pi), SPECTRUM.rms_height
    hardness = 3.5e9
    spots = float(leak.joint_conductance(FACE, share * hardness, 15.0))
    assert 0.6 < spots / (1.25 * 15.0 * slope / height * share**0.95) < 1.7
    separation = math.sqrt(2.0) * height * erfcinv(2 * share)
    assert float(FACE.mean_separation(share * hardness)) == pytest.approx(separation, rel=0.18)


@pytest.mark.parametrize("gas", ["helium", "argon", "nitrogen"])
@pytest.mark.parametrize(("height", "hurst", "cutoff"), [(2e-6, 0.6, 100.0), (1e-5, 0.9, 4.0)])
def test_the_gap_of_measured_metal(gas, height, hurst, cutoff):
    """Yovanovich's statistical gap conductance at Y, which measured joints of 304 and nickel follow; theory/heat.

    Surfaces and loads are the extreme ones of those in the manual, whose ratios go from 0.90 to 1.11.
    """
    shape = leak.PowerSpectrum.self_affine(
        rms_height=height, hurst=hurst, q_low=0.25, q_rolloff=1.0, q_high=cutoff
    )
    q, hardness, share = 0.1 * math.sqrt(math.pi) / shape.rms_slope, 3.5e9, np.array([1e-4, 1e-2])
    spectrum = leak.PowerSpectrum(q * shape.wavenumber, shape.density / q**2)
    face = leak.RoughContact(spectrum, effective_modulus=110e9, hardness=hardness, theory="corrected")
    assert spectrum.rms_height == pytest.approx(height)
    fluid, Y = leak.GapFluid.of(gas, 293.15), math.sqrt(2.0) * height * erfcinv(2 * share)
    M = float(fluid.jump_length(101325.0))
    spots, joint = (
        leak.joint_conductance(face, share * hardness, 16.2, filling, fluid_pressure=101325.0)
        for filling in (None, fluid)
    )
    measured = [
        quad(lambda t, y=y: math.exp(-0.5 * t**2) / (y - height * t + M), -8, y / height)[0] for y in Y
    ] / np.sqrt(2 * np.pi)
    assert joint - spots == pytest.approx(fluid.conductivity * measured, rel=0.12)
    assert np.asarray(face.mean_separation(share * hardness)) == pytest.approx(Y, rel=0.18)


def test_free_molecules():
    """For a = 1 and a gap narrow against M: p (kappa + 1)/(kappa - 1) sqrt(R_s/(8 pi T)) (Knudsen)."""
    T, p = 300.0, 50.0
    for name, kappa in (("oxygen", 1.395), ("hydrogen", 1.405)):
        fluid, gas = leak.GapFluid.of(name, T), leak.gas(name, T)
        free = p * (kappa + 1) / (kappa - 1) * math.sqrt(gas.specific_gas_constant / (8 * math.pi * T))
        assert fluid.conductivity / float(fluid.jump_length(p)) == pytest.approx(free, rel=3e-3)
    # a measured coefficient makes the jump longer by (2 - a)/a
    helium, molecules = leak.GapFluid.of("helium", T), leak.gas("helium", T)
    free = p * 4.0 * math.sqrt(molecules.specific_gas_constant / (8 * math.pi * T))
    assert helium.conductivity / float(helium.jump_length(p)) == pytest.approx(free * 0.45 / 1.55, rel=3e-3)


@pytest.mark.parametrize(
    ("name", "coolprop", "tolerance"),
    [
        *((name, name.title().replace(" ", ""), 0.012) for name in leak.GASES),
        *(("water", "Water", 0.006), ("ethanol", "Ethanol", 0.01), ("kerosene", "Dodecane", 0.01)),
        ("hydraulic oil ISO VG 46", "INCOMP::TX22", 0.01),
        ("glycol/water 50/50", "INCOMP::MEG[0.5]", 0.01),
    ],
)
def test_thermal_conductivities_against_coolprop(name, coolprop, tolerance):
    CoolProp = pytest.importorskip("CoolProp.CoolProp", reason="CoolProp is optional")
    for T in (280.0, 310.0, 340.0, *((250.0, 500.0) if name in leak.GASES else ())):
        pressure = 1e3 if name in leak.GASES else 101325.0
        expected = CoolProp.PropsSI("L", "T", T, "P", pressure, coolprop)
        assert leak.GapFluid.of(name, T).conductivity == pytest.approx(expected, rel=tolerance)
        by_name = leak.GapFluid.of(f"CoolProp:{coolprop}", T)
        assert by_name.conductivity == pytest.approx(expected, rel=1e-9)
        assert (by_name.jump > 0) == (name in leak.GASES)


def test_what_is_not_known_and_what_cannot_be():
    assert leak.GapFluid.of("diesel", 300.0) is None and leak.GapFluid.of("my oil", 300.0) is None
    for wrong in (lambda: leak.GapFluid(0.0), lambda: leak.GapFluid(1.0, -1.0)):
        with pytest.raises(LeakError, match="must"):
            wrong()
    with pytest.raises(LeakError, match="conductivity = -1"):
        leak.joint_conductance(FACE, 1e6, -1.0)
