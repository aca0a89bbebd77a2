"""An octagonal ring in its groove: equilibrium of flanks whose normals cross, a tenth of the size, and a flat punch."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest

import fem_seal
import leak
import meshes
from fem_seal.bodies.fields import BodyField
from fem_seal.contact.sizing import element_sizes, round_sizing
from fem_seal.contact.solution import ContactSolution
from fem_seal.loads import line_load
from fem_seal.materials import effective_modulus

MATERIALS = {
    "closure": fem_seal.Material("flange", 210e9, 0.3),
    "seat": fem_seal.Material("ring", 195e9, 0.3),
}
BETA, FORCE = math.radians(67), 100e3


@cache
def solved(size: float = 1.0, decay_length: float = 1e-6) -> tuple[ContactSolution, meshes.SealMesh]:
    """R24 between flanges of NPS 2, all lengths but the decay length of the law [m] times `size`."""
    flange = meshes.FlangeFace.grooved(
        0.0245 * size,
        0.047625 * size,
        11.91e-3 * size,
        7.92e-3 * size,
        bottom_edge_radius=0.8e-3 * size,
        outer_radius=0.08 * size,
        height=0.03 * size,
    )
    ring = meshes.OctagonalRing(
        0.047625 * size, 11.13e-3 * size, 16e-3 * size, 7.75e-3 * size, edge_radius=1.5e-3 * size
    )
    contact = meshes.ContactGeometry.of(flange.outline, ring.outline)
    law, force = leak.ExponentialLaw(p_c=2e9, u0=decay_length), FORCE * size**2
    load = line_load(force, contact.initial_contact_radius, contact.angle)
    sizing = round_sizing(
        element_sizes(law, [load], contact, effective_modulus(*MATERIALS.values())), contact
    )
    mesh = meshes.build_contact(contact, sizing)
    return fem_seal.solve(fem_seal.condense(mesh, MATERIALS), law, contact_force=force), mesh


def flanks(contact: ContactSolution) -> np.ndarray:
    """Force of the inner and of the outer flank along their normals [N]."""
    line = contact.model.line
    (cut,) = line.chambers
    forces = line.area_weight * contact.pressure
    return np.array([forces[line.x < cut].sum(), forces[line.x > cut].sum()])


def hoop_force(field: BodyField) -> float:
    """Integral of the hoop stress over the section [N]: of a parabola the mean of the middles of the sides."""
    r, z = field.points.T[:, field.triangles6[:, :3]]
    area = 0.5 * np.abs((r[:, 1] - r[:, 0]) * (z[:, 2] - z[:, 0]) - (r[:, 2] - r[:, 0]) * (z[:, 1] - z[:, 0]))
    return float(area @ field.stress[field.triangles6[:, 3:], 2].mean(axis=1))


def test_both_flanks_carry_the_force_and_the_hoops_what_spreads() -> None:
    contact, _ = solved()
    inner, outer = flanks(contact)
    assert math.cos(BETA) * (inner + outer) == pytest.approx(FORCE, rel=1e-6)
    assert 0.4 < inner / (inner + outer) < 0.6
    # the groove pushes the inner flank outwards and the outer one inwards; what is left is taken by the hoop stress of
    # the ring, of the flange with the other sign: int sigma_phi dA = sum of F_r/(2 pi)
    spreads = math.sin(BETA) * (inner - outer) / (2 * math.pi)
    pressed = math.sin(BETA) * (inner + outer) / (2 * math.pi)
    assert hoop_force(contact.fields["seat"]) == pytest.approx(spreads, abs=2e-3 * pressed)
    assert hoop_force(contact.fields["closure"]) == pytest.approx(-spreads, abs=2e-3 * pressed)


def test_a_tenth_of_the_size_is_the_same_joint() -> None:
    whole, tenth = solved()[0], solved(0.1, 1e-7)[0]
    assert 100 * flanks(tenth) == pytest.approx(flanks(whole), rel=1e-4)
    assert tenth.pressure.max() == pytest.approx(whole.pressure.max(), rel=2e-3)
    assert 10 * tenth.approach == pytest.approx(whole.approach, rel=1e-4)


def test_each_flank_is_pressed_like_a_flat_punch_of_its_width() -> None:
    """Far from its edges: p = f/(pi sqrt(b^2 - x^2)), the part that is even about the middle of the flank."""
    contact, mesh = solved(decay_length=5e-8)
    line, (cut,) = contact.model.line, contact.model.line.chambers
    flat = 0.5 * ((11.13e-3 - 7.75e-3) / 2 / math.cos(BETA))
    shorter = 1.5e-3 * (math.tan((math.pi / 2 - BETA) / 2) + math.tan(BETA / 2))
    b = flat - 0.5 * shorter
    assert mesh.contact.breaks[(mesh.contact.breaks > 0)][0] == pytest.approx(b, rel=1e-6)
    for middle, side in ((0.0, line.x < cut), (2 * cut, line.x > cut)):
        x, p = line.x[side] - middle, contact.pressure[side]
        f = p @ line.arc_weight[side]
        near = np.linspace(0.0, 0.5 * b, 20)
        even = 0.5 * (np.interp(near, x, p) + np.interp(-near, x, p))
        # the pressure goes a little beyond the flat, onto the roundings
        assert even == pytest.approx(f / (math.pi * np.sqrt(b**2 - near**2)), rel=0.08)
