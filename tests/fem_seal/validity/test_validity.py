"""Every warning about the interface fires when it should, with its number, and is silent when it should be."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from judged_loads import SURFACE, judged, load
from sample_results import case, gasket_result, rough_result, run_loads, single_result, smooth_result

import leak
from fem_seal.seal.findings import Level
from fem_seal.seal.load_result import LoadResult
from fem_seal.validity import checks as warnings
from leak.fluids.library import molecular_size

PAPER = SURFACE.spectrum


def said(kind, *loads, **how):
    return " ".join(caution.text() for caution in judged(kind, *loads, **how))


def pressure_at(area: float) -> float:
    """Pressure under which this share of the area touches."""
    from scipy.special import erfinv

    return float(erfinv(area)) * float(np.sqrt(np.pi * PAPER.moment(3))) * 115e9


def test_sealed():
    tight, leaky = load(peak=1.01 * SURFACE.sealing_pressure, leak_rate=0.0), load()
    words = said("sealed", leaky, tight)
    assert "A/A0 = 0.42" in words
    assert f"above {float(f'{SURFACE.sealing_pressure / 1e6:.4g}'):g} MPa" in words
    assert said("sealed", leaky, load(peak=0.99 * SURFACE.sealing_pressure)) == ""
    assert said("few channels", tight) == ""


def test_a_short_contact_that_leaks_above_the_sealing_pressure_is_not_called_sealed():
    """It was, with no factor on its leak rate, while less pressed ones had a factor of 8."""
    short = load(peak=1.01 * SURFACE.sealing_pressure, leak_rate=1e-15)
    assert said("sealed", short) == ""
    (found,) = judged("nearly sealed", short)
    assert "Above 0.42" in found.text() and "so narrow that some are" in found.text()
    assert "above the percolation threshold" in found.reason() and "close to" not in found.reason()
    (close,) = judged("nearly sealed", load(peak=0.98 * SURFACE.sealing_pressure, leak_rate=1e-15))
    assert "close to the percolation threshold" in close.reason()
    area = float(SURFACE.contact_area(1.01 * SURFACE.sealing_pressure))
    assert found.leak_factor == (pytest.approx(1e-3 ** ((area - 0.39) / 0.16)), np.inf)


def test_loads_that_differ_in_their_force_alone_are_named_by_it():
    sealing = SURFACE.sealing_pressure
    tight = [load(peak=share * sealing, applied_force=300 * share, leak_rate=0.0) for share in (3, 2)]
    words = said("sealed", load(), *tight)
    assert "(at 20 bar with 900 N, from 20 bar with 600 N on)" in words


@pytest.mark.parametrize(
    ("area", "words"), [(0.14, ""), (0.17, "factor 1.4"), (0.31, "factor 3.3"), (0.41, "orders of magnitude")]
)
def test_few_channels_left(area, words):
    close = load(peak=pressure_at(area))
    found = said("few channels", load(), close) + said("nearly sealed", load(), close)
    assert words in found
    assert (f"A/A0 = {area:.2g}" in found) == bool(words)


def test_factors_are_those_of_the_direct_numerical_results(reference_folder):
    """The limits in the warning are those that the comparison with direct numerical results shows."""
    from direct_numerical import compare, read_direct

    for comparison in map(compare, read_direct(reference_folder)):
        # the theory's own area, which is what a user has
        area = np.asarray(
            leak.RoughContact(comparison.direct.spectrum, effective_modulus=1.0).contact_area(
                comparison.direct.pressure
            )
        )
        # beyond 0.32 there is no direct result
        for one, ratio in zip(area, comparison.default, strict=True):
            assert max(ratio, 1 / ratio) < warnings._interpolate_factor(warnings._FACTORS, one)


@pytest.mark.parametrize("peklenik", [0.2, 0.5, 1.0, 5.0])
def test_factors_rise_with_the_area_without_a_step(peklenik):
    """With a step a larger load would seem to leak more: its upper bound would."""
    area = np.linspace(0.001, 0.38, 500)
    factors = [
        [warnings._lay_factor(one, peklenik) for one in area],
        [warnings._interpolate_factor(warnings._FACTORS, one) for one in area],
    ]
    change = np.diff(np.log(factors), axis=1)
    assert np.all(change >= 0)
    assert change.max() < 0.02


@pytest.mark.slow
def test_factors_with_a_lay_are_those_of_the_direct_numerical_results(reference_folder):
    from verification_medium import lays

    worst = {}
    for one in lays(reference_folder):
        for number, ratios in (
            (one.direct.kind.peklenik, one.along),
            (1 / one.direct.kind.peklenik, one.across),
        ):
            for area, ratio in zip(one.theory_area, ratios, strict=True):
                factor = warnings._lay_factor(area, number)
                assert 1 / factor < ratio < factor, (one.direct.kind, area)
                worst[number < 1] = max(worst.get(number < 1, 0.0), max(ratio, 1 / ratio) / factor)
    # and they are not wildly larger than needed
    assert min(worst.values()) > 0.9


@pytest.mark.parametrize(
    ("peklenik", "area", "words"),
    [
        (1.0, 0.17, "up to a factor 1.4 either way"),
        (0.2, 0.17, "factor 2.5 either way; there are no such results beyond A/A0 = 0.16"),
        (0.2, 0.014, "factor 1.4 either way"),
        (5.0, 0.014, "factor 1.4 either way"),
        (5.0, 0.25, "factor 2.3 either way; there are no such results beyond A/A0 = 0.16"),
        (
            0.05,
            0.05,
            "factor 3.8 either way; there are no such results beyond a ratio of 10 of the correlation lengths",
        ),
        (0.2, 0.4, "orders of magnitude"),
        (0.8, 0.014, ""),
    ],
)
def test_the_factor_knows_the_lay(peklenik, area, words):
    surface = replace(SURFACE, peklenik=peklenik)
    close = load(peak=pressure_at(area))
    found = "".join(said(kind, close, surface=surface) for kind in ("lay", "few channels", "nearly sealed"))
    assert words in found
    assert bool(found) == bool(words)


def test_roughness_known_too_short():
    assert said("roughness range", load(std=0.9 / PAPER.q_low)) == ""
    words = said("roughness range", load(), load(std=1.1 / PAPER.q_low))
    assert "6283 um" in words
    assert "1100 um" in words
    assert "909 1/m" in words


def test_waves_that_a_finish_leaves_out():
    finish = case(roughness={"Ra": "0.4 um", "process": "ground"})
    assert said("waviness", load(std=0.9 / PAPER.q_low), of=finish) == ""
    words = said("waviness", load(std=1.1 / PAPER.q_low), of=finish)
    # 2 pi standard deviations are 1.8 times the width of an even pressure: such waves do not fit into it
    assert "bend the faces" in words and "Waves up to 6912 um do so" in words and "above 800 um" in words


def test_waves_longer_than_the_contact():
    # half of the height variance of this surface is in waves above 2 pi/q
    q = np.geomspace(PAPER.q_low, PAPER.q_high, 4000)
    above = PAPER.height_variance_above(q) / PAPER.rms_height**2
    half = float(np.interp(-0.5, -above, q))
    assert "50 % of the height variance" in said("long waves", load(), load(std=1 / half))
    assert said("long waves", load(std=1 / q[above > 0.91][-1])) == ""
    # simulated strips say how much: 1 + 1.5 times the share, of the corrected theory alone
    corrected = replace(SURFACE, theory="corrected", yielding="")
    assert ": up to 1.8 times as much leaks" in said("long waves", load(std=1 / half), surface=corrected)
    assert "as much leaks" not in said("long waves", load(std=1 / half))


def test_next_to_sealing_a_lay_leaves_the_upper_end_as_uncertain_as_before():
    """From A/A0 = 0.39 on the lay was forgotten: with a tenth more force the upper end was 4.6 times lower."""
    result = run_loads(
        case(
            closure={"shape": "ball", "diameter": "10 mm", "material": "100Cr6"},
            seat={"shape": "cone", "included_angle": "90 deg", "material": "316L"},
            roughness={"Ra": "0.4 um", "process": "ground"},
            load={"fluid_pressure": "100 bar", "applied_force": ["1.1 kN", "1.25 kN"]},
            leak={"theory": "corrected"},
        )
    )
    before, after = (one.validity for one in result.loads)
    assert any("roughness with a lay" in one for one in before.reasons)
    assert any("close to the percolation threshold" in one for one in after.reasons)
    assert after.leak_factor[1] == pytest.approx(before.leak_factor[1], rel=0.05)


def test_a_gas_that_is_a_liquid_is_outside_the_theory_whoever_knows_its_properties():
    """CoolProp's carbon dioxide said so at 80 bar; that of the library was doubtful, with a factor of a dense gas."""
    of = case(fluid={"name": "carbon dioxide"})
    assert "is a liquid at" in said("dense gas", load(fluid_pressure=80e5), of=of)
    assert "not a dilute ideal gas" in said("dense gas", load(fluid_pressure=50e5), of=of)


def test_sizes_of_molecules():
    """Kinetic diameters of Breck (1974), table 8.1, in nanometres."""
    printed = {
        "helium": 0.26,
        "hydrogen": 0.289,
        "nitrogen": 0.364,
        "air": 0.364,
        "oxygen": 0.346,
        "argon": 0.34,
        "carbon dioxide": 0.33,
        "methane": 0.38,
        "water": 0.265,
        "diesel": 0.43,
        "kerosene": 0.43,
    }
    for name, size in printed.items():
        assert molecular_size(name) == pytest.approx(1e-9 * size, rel=1e-12)


@pytest.mark.parametrize(("fluid", "size"), [("water", 0.265e-9), ("hydraulic oil ISO VG 32", 0.43e-9)])
def test_channels_narrower_than_a_molecule(fluid, size):
    assert molecular_size(fluid) == size
    of = case(fluid={"name": fluid})
    words = said("molecules", load(), load(critical_separation=0.9 * size), of=of)
    assert f"{0.9 * size * 1e9:.2g} nm" in words
    assert said("molecules", load(), load(critical_separation=1.1 * size), of=of) == ""
    # sealed: another warning's business
    assert said("molecules", load(critical_separation=0.0), of=of) == ""


def test_every_fluid_of_the_library_has_a_molecular_size():
    for name in [*leak.FLUIDS, *leak.GASES]:
        assert 0.25e-9 < molecular_size(name) < 0.5e-9
    assert molecular_size("something else") == molecular_size("helium")


def test_fluid_pressure_opens_the_gap():
    assert said("fluid opens", load(fluid_pressure=0.09 * 50e6)) == ""
    words = said("fluid opens", load(), load(fluid_pressure=0.2 * 50e6))
    assert "0.2 times the peak" in words
    assert "1.3 times" in words
    local = case(leak={"fluid_in_gap": "local"})
    assert said("fluid opens", load(fluid_pressure=0.2 * 50e6), of=local) == ""
    open_seal = load(fluid_pressure=55e6, leak_rate=np.inf)
    assert "lifts the seal open" in said("lifted open", load(), open_seal, of=local)
    assert "several times" in said("fluid opens", load(fluid_pressure=0.8 * 50e6))


def test_the_expected_increase_is_about_that_of_the_local_closure():
    """What the warning foretells, 1 + 1.7 p_f/p0, against the calculation with fluid pressure taken off the load."""
    from leak.flow.fluid_in_gap import coupled_leak_flow

    x = np.linspace(-6, 6, 241) * 0.139e-3
    p = 50e6 * np.exp(-0.5 * (x / 0.139e-3) ** 2)
    sigma = SURFACE.conductivity_table(1e3, 1e9).at(1e-3)
    for share in (0.1, 0.2, 0.4):
        ratio = (
            coupled_leak_flow(x, p, sigma, share * 50e6, 0.014).leak_rate
            / leak.leak_flow(x, p, sigma, share * 50e6, 0.014).leak_rate
        )
        # a rule of thumb, good to a tenth
        assert ratio == pytest.approx(1 + 1.7 * share, rel=0.1)


def test_the_paper_s_case_is_free_of_warnings():
    assert rough_result().warnings == ()
    assert smooth_result().warnings == () or all("roughness" not in text for text in smooth_result().warnings)


def test_checks_of_the_interface_are_part_of_a_run():
    """A surface that is known over too short a range says so in the result's own warnings."""
    result = single_result()
    spectrum = leak.PowerSpectrum.self_affine(
        rms_height=0.1e-6, hurst=0.8, q_low=1e6, q_rolloff=1e6, q_high=1e8
    )
    surface = replace(result.surface, spectrum=spectrum)
    found = warnings.contact_cautions(replace(result.problem, surface=surface), result.loads)
    assert any("too short a wave" in one.text() for one in found)
    own = warnings.contact_cautions(result.problem, result.loads)
    assert set(result.warnings) <= {caution.text() for caution in own}


@pytest.mark.slow
def test_flanges_that_meet_before_their_load_is_reached() -> None:
    result = gasket_result()
    kinds = [one.kind for one in warnings.load_cautions(result.problem, result.loads)]
    assert "flanges" not in kinds
    # the ring is 4 mm high; half of it was calculated
    load = result.loads[0]
    far = LoadResult(load.fluid_pressure, load.applied_force, replace(load.contact, approach=2.01e-3))
    (found,) = [one for one in warnings.load_cautions(result.problem, [far]) if one.kind == "flanges"]
    assert found.level is Level.OUTSIDE
    assert found.values["way"] == pytest.approx(4020) and found.values["apart"] == pytest.approx(4000)
