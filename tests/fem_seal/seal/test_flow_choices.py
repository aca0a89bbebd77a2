"""Stretched roughness and coupled fluid pressure: from the case file to the result files."""

from __future__ import annotations

from functools import cache

import numpy as np
import pandas as pd
import pytest
from sample_results import SPECTRUM, STEEL, ball, case, cone, rough_result, run_loads

import fem_seal
import leak
from fem_seal.answers.profile_files import read_profiles
from fem_seal.answers.profile_leak import leak_of_profiles
from fem_seal.errors import InputError
from fem_seal.output.tables import write_profile_csv
from fem_seal.result import SealResult
from fem_seal.seal.problem import rough_contact


def stretched(gamma: float) -> dict[str, dict[str, object]]:
    """Tables along and across of the sample spectrum stretched by gamma: wavenumbers scaled, heights as before."""

    def scaled(factor: float) -> dict[str, object]:
        waves = {
            key: f"{float(str(SPECTRUM[key]).split()[0]) * factor!r} 1/m" for key in SPECTRUM if "q_" in key
        }
        return {**SPECTRUM, **waves}

    return {"along": scaled(gamma**-0.5), "across": scaled(gamma**0.5)}


def wrong(**tables: object) -> str:
    with pytest.raises(InputError) as caught:
        case(**tables)
    return str(caught.value)


@cache
def local_result() -> SealResult:
    """Loads from far below to above blow-off: the fluid in the bore lifts what 4 kN press down."""
    return fem_seal.run(
        case(
            leak={"fluid_in_gap": "local"},
            load={
                "fluid_pressure": ["1 bar", "40 bar", "60 bar", "62 bar"],
                "pressure_side": "inner",
                "applied_force": "4 kN",
            },
        )
    )


@pytest.mark.slow
def test_peklenik_reaches_the_surface_and_the_leak_rate():
    plain = rough_result()
    turned = run_loads(case(roughness={"spectrum": SPECTRUM, "peklenik": 0.2}))
    assert turned.surface.peklenik == 0.2
    np.testing.assert_allclose(turned.table.peak_pressure_Pa, plain.table.peak_pressure_Pa, rtol=1e-9)
    ratio = turned.table.leak_rate_m3_per_s / plain.table.leak_rate_m3_per_s
    # tighter, and the more so the closer the contact
    assert (ratio.diff().dropna() < 0).all()
    assert ratio.iloc[-1] == pytest.approx(0.38, abs=0.04)


def test_two_directions_give_number_and_average():
    surface = rough_contact(case(roughness=stretched(0.25)))
    assert surface.peklenik == pytest.approx(0.25, rel=1e-3)
    assert surface.spectrum.rms_height == pytest.approx(1.9e-6, rel=1e-3)
    same = rough_contact(case(roughness={"along": SPECTRUM, "across": SPECTRUM}))
    assert same.peklenik == pytest.approx(1.0, rel=1e-6)
    assert same.spectrum.rms_slope == pytest.approx(rough_contact(case()).spectrum.rms_slope, rel=1e-6)


def test_directions_that_are_no_stretch_are_remarked_on():
    rough = {**SPECTRUM, "hurst": 0.9}
    remarks = list(case(roughness={"along": SPECTRUM, "across": rough}).roughness.remarks())
    assert len(remarks) == 1
    assert "not similar ellipses" in remarks[0]
    assert not list(case(roughness=stretched(3.0)).roughness.remarks())


@pytest.mark.parametrize(
    ("tables", "says"),
    [
        ({"roughness": {"along": SPECTRUM}}, "needs along and across"),
        (
            {"roughness": {"along": SPECTRUM, "across": SPECTRUM, "seat": SPECTRUM}},
            "not several of these ways",
        ),
        ({"roughness": {"along": SPECTRUM, "across": SPECTRUM, "peklenik": 2}}, "determine already"),
        ({"roughness": {"spectrum": SPECTRUM, "peklenik": 0}}, "roughness.peklenik"),
        ({"leak": {"fluid_in_gap": "lokal"}}, '"uncoupled" or "local"'),
        ({"leak": {"fluid_in_gap": "local"}, "fluid": {"name": "helium"}}, "only for liquids"),
    ],
)
def test_what_is_refused(tables, says):
    assert says in wrong(**tables)


@pytest.mark.slow
def test_a_surface_without_slopes_seals_at_its_sealing_pressure():
    """A rms slope of 0.004: the sealing pressure lies within the contact pressures."""
    fine = {**SPECTRUM, "rms_height": "0.019 um"}
    surface = rough_contact(case(roughness={"spectrum": fine}, leak={"plasticity": False}))
    result = run_loads(
        case(roughness={"spectrum": fine}, load={"fluid_pressure": "20 bar"}, leak={"plasticity": False})
    )
    assert result.table.peak_pressure_Pa[0] > surface.sealing_pressure
    assert result.table.leak_rate_m3_per_s[0] == 0.0
    words = " ".join(caution.text() for caution in result.loads[0].validity.cautions)
    assert f"{surface.sealing_pressure / 1e6:.4g} MPa" in words


@pytest.mark.slow
def test_coupled_columns():
    result = local_result()
    table = result.table
    assert not {"lift_off_x_m", "blow_off_pressure_Pa"} & {*rough_result().table}
    np.testing.assert_allclose(table.blow_off_pressure_Pa, table.peak_pressure_Pa, rtol=1e-4)
    held = table.fluid_pressure_Pa < table.peak_pressure_Pa
    assert held.tolist() == [True, True, True, False]
    assert (np.isfinite(table.leak_rate_m3_per_s) == held).all()
    # high pressure in the bore: lifted off on the side of smaller x
    assert (table.lift_off_x_m[held] < 0).all()
    assert table.lift_off_x_m[~held].isna().all()


@pytest.mark.slow
def test_coupled_flow_is_that_of_leak():
    result = local_result()
    load = result.loads[1]
    profile, p = load.contact.profile, load.fluid_pressure
    sigma = result.surface.conductivity_table(1e-3, 1e9).at(result.case.fluid.viscosity)
    direct = leak.coupled_leak_flow(
        profile.x,
        profile.pressure,
        sigma,
        p,
        profile.radius,
        pressure_side="inner",
        pressure_law=result.case.fluid.pressure_law,
    )
    assert load.leak.leak_rate == pytest.approx(direct.leak_rate, rel=1e-4)
    alone = leak.leak_rate(profile.x, profile.pressure, sigma, p, profile.radius)
    assert load.leak.leak_rate > 1.02 * alone


@pytest.mark.slow
def test_files_of_a_seal_blown_open(tmp_path):
    result = local_result()
    assert any("62 bar" in text and "lifts the seal open" in text for text in result.warnings)
    result.write(tmp_path)
    written = pd.read_csv(tmp_path / "leak.csv")
    assert np.isinf(written.leak_rate_m3_per_s.iloc[-1])
    fluid = pd.read_csv(tmp_path / "profile.csv").groupby("fluid_pressure_Pa").fluid_pressure_in_gap_Pa
    assert fluid.max().iloc[1] == pytest.approx(40e5)
    assert fluid.count().iloc[-1] == 0
    assert "NaN" not in (tmp_path / "summary.json").read_text()
    assert "Infinity" not in (tmp_path / "summary.json").read_text()
    assert (tmp_path / "report.html").stat().st_size > 10_000


def cut_off(**tables):
    """A ball in a seat whose face ends within the contact."""
    return case(
        closure=ball(STEEL, "10 mm"),
        seat=cone(bore_radius="7 mm", face_radius="7.15 mm", height="0.5 mm", outer_radius="7.5 mm"),
        roughness={
            "spectrum": {
                **SPECTRUM,
                "rms_height": "0.5 um",
                "hurst": 0.7,
                "q_low": "5e3 1/m",
                "q_rolloff": "5e4 1/m",
            }
        },
        load={"fluid_pressure": "100 bar"},
        **tables,
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    "tables",
    [
        {"fluid": {"viscosity": "1 mPa s"}},
        {"fluid": {"viscosity": "1 mPa s"}, "leak": {"fluid_in_gap": "local"}},
        {"fluid": {"name": "nitrogen"}},
    ],
    ids=["liquid", "local", "gas"],
)
def test_the_leak_of_a_contact_that_is_cut_off_converges(tables, tmp_path):
    """Nothing resists beyond the end of a face, so that smaller elements at it change nothing; the estimate says so."""
    result = fem_seal.run(cut_off(**tables))
    finer = run_loads(cut_off(mesh={"contact_size": "3 um"}, **tables))
    rate, fine = (one.table.leak_rate_m3_per_s.iloc[0] for one in (result, finer))
    assert rate == pytest.approx(fine, rel=1e-3)
    assert result.discretisation_error.leak_rate < 2e-3
    assert abs(rate / fine - 1) < 3 * max(result.discretisation_error.leak_rate, 1e-5)
    # the profile in its file ends with the face, too
    file = write_profile_csv(result, tmp_path / "profile.csv")
    (load,) = leak_of_profiles(result.problem, read_profiles(file, result.problem.contact))
    assert load.leak.leak_rate == pytest.approx(rate, rel=2e-3)
    assert any("cut off" in text for text in result.warnings)
