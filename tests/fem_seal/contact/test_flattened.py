"""Asperities that are pressed flat: a law that is all but rigid becomes hard contact, without ripples."""

from __future__ import annotations

import math

import numpy as np
import pytest
from contact_models import STEEL

import fem_seal
import leak
import meshes
from fem_seal.contact import newton
from fem_seal.contact.flattened import solve_flattened
from fem_seal.contact.model import condense
from fem_seal.contact.newton import solve
from fem_seal.contact.sizing import element_sizes
from fem_seal.materials import effective_modulus
from meshes import Ball, ConicalSeat, ContactGeometry

RADIUS, BALL = 0.01, Ball(0.01)
CONTACT = ContactGeometry.of(BALL.outline, ConicalSeat.around(math.radians(45), BALL).outline)
MODULUS = effective_modulus(STEEL, STEEL)


def law_of(rms_height: float) -> fem_seal.InterfaceLaw:
    spectrum = leak.PowerSpectrum.self_affine(
        rms_height=rms_height, hurst=0.7, q_low=1e3, q_rolloff=5e3, q_high=3e6
    )
    return leak.RoughContact(spectrum, effective_modulus=MODULUS).interface_law()


def pressed(rms_height: float, force: float) -> tuple[fem_seal.ContactSolution, float, float]:
    """The contact, and Hertz's peak [Pa] and half-width [m]."""
    law, line_load = (
        law_of(rms_height),
        force / (2 * math.pi * CONTACT.initial_contact_radius * math.cos(CONTACT.angle)),
    )
    sizing = element_sizes(law, [line_load], CONTACT, MODULUS)
    model = condense(meshes.build_contact(CONTACT, sizing), {"closure": STEEL, "seat": STEEL})
    found = solve(model, law, contact_force=force)
    half_width = math.sqrt(4 * line_load * RADIUS / (math.pi * MODULUS))
    return found, math.sqrt(MODULUS * line_load / (math.pi * RADIUS)), half_width


@pytest.mark.parametrize(
    ("rms_height", "force"),
    [
        (0.005e-6, 200.0),
        (0.01e-6, 2e3),
        (0.02e-6, 2e4),
        (0.05e-6, 2e4),
        (0.1e-6, 2e4),
        (0.2e-6, 5e4),
        (0.4e-6, 5e4),
    ],
)
def test_asperities_pressed_flat_leave_the_contact_of_hertz(rms_height: float, force: float) -> None:
    found, peak, half_width = pressed(rms_height, force)
    # half-width over radius is up to 0.043: a cone is no plane, by 0.25 %; and the mesh is worth 0.2 % at the edge
    assert found.profile.peak_pressure == pytest.approx(peak, rel=4e-3)
    assert found.profile.fwhm == pytest.approx(math.sqrt(3) * half_width, rel=8e-3)
    assert found.profile.std == pytest.approx(half_width / 2, rel=1e-2)
    # the same faces without any roughness; beside the edge asperities carry what smooth faces cannot
    smooth = solve(found.model, fem_seal.HardContact(), contact_force=force)
    inside = np.abs(found.model.line.x - smooth.profile.centroid) < 0.8 * half_width
    np.testing.assert_allclose(found.pressure[inside], smooth.pressure[inside], atol=0.01 * peak, rtol=0.0)
    assert found.force_error == pytest.approx(0.0, abs=1e-9)


def test_both_ways_agree_where_one_gives_over_to_the_other(monkeypatch: pytest.MonkeyPatch) -> None:
    at_ends, _, _ = pressed(0.4e-6, 3e4)
    monkeypatch.setattr(newton, "_is_all_but_rigid", lambda *_: False)
    at_points = solve(at_ends.model, law_of(0.4e-6), contact_force=3e4)
    assert not np.array_equal(at_points.log_pressure, at_ends.log_pressure)
    assert at_ends.profile.peak_pressure == pytest.approx(at_points.profile.peak_pressure, rel=3e-4)
    assert at_ends.profile.std == pytest.approx(at_points.profile.std, rel=3e-4)
    assert at_ends.profile.fwhm == pytest.approx(at_points.profile.fwhm, rel=1e-3)
    assert at_ends.approach == pytest.approx(at_points.approach, rel=1e-6)


def test_a_stop_takes_the_rest_of_the_force() -> None:
    free, _, _ = pressed(0.02e-6, 2e4)
    held = solve(free.model.with_stop(0.6 * free.approach), law_of(0.02e-6), contact_force=2e4)
    assert held.approach == 0.6 * free.approach
    assert held.contact_force + held.stop_force == pytest.approx(2e4)
    alone = solve(free.model, law_of(0.02e-6), contact_force=held.contact_force)
    # the least decay length is a millionth of what the whole force flattens
    np.testing.assert_allclose(held.pressure, alone.pressure, rtol=0.0, atol=1e-4 * alone.pressure.max())


def test_a_start_from_another_load_changes_nothing() -> None:
    found, _, _ = pressed(0.02e-6, 2e4)
    near = solve(found.model, law_of(0.02e-6), contact_force=1.9e4)
    again = solve(found.model, law_of(0.02e-6), contact_force=2e4, start=near)
    np.testing.assert_allclose(again.pressure, found.pressure, rtol=1e-7, atol=1e-7 * found.pressure.max())


def test_a_start_without_pressure_ends_without_a_warning(recwarn: pytest.WarningsRecorder) -> None:
    law = law_of(0.1e-6)
    sizing = element_sizes(law, [1e4], CONTACT, MODULUS)
    model = condense(meshes.build_contact(CONTACT, sizing), {"closure": STEEL, "seat": STEEL})
    nothing, apart = np.full(len(model.line.x), -800.0), np.zeros(len(model.line.x))
    assert solve_flattened(model, law, 1e3, apart, (nothing, 0.0), 0.0, 1e-9) is None
    assert not recwarn.list
