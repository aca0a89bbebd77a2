"""Small strains against finite strain on small edges: python benchmarks/finite_strain.py [BODIES a/R ...].

Prints the table of docs/guide/validity.md: what fem-seal gives against `finite_strain_solid`.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import math
import sys
from typing import Any

import numpy as np
from calculix_deck import FloatArray, node_points
from finite_strain_solid import Profile, Solid, UnsettledError
from finite_strain_solid import solve as solve_finite
from scipy.spatial import cKDTree

from fem_seal import Case
from fem_seal.bodies.elasticity import node_dofs
from fem_seal.contact.newton import solve
from fem_seal.contact.solution import ContactSolution
from fem_seal.profile import PressureProfile
from fem_seal.seal.evaluate import evaluate
from fem_seal.seal.problem import SealProblem
from leak import ExponentialLaw
from meshes import SealMesh

STEEL = {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3}
SOFT = {"youngs_modulus": "2.1 GPa", "poissons_ratio": 0.3}
CREST = {
    "shape": "sharp-edge",
    "bore_radius": "10 mm",
    "top_angle": "-30 deg",
    "edge_radius": "1 mm",
    "material": STEEL,
}
BORE = {"shape": "sharp-edge", "bore_radius": "1 mm", "edge_radius": "0.1 mm", "material": STEEL}
DISC = {"shape": "disc", "radius": "15 mm", "height": "8 mm"}
NEEDLE = {"shape": "cone", "angle": "60 deg", "inner_radius": "0.5 mm", "outer_radius": "2 mm"}
BODIES = {
    "crest": ({**DISC, "material": STEEL}, CREST),
    "soft-disc": ({**DISC, "material": SOFT}, CREST),
    "soft-needle": ({**NEEDLE, "material": SOFT}, BORE),
}
SERIES = (0.1, 0.2, 0.3)
# Decay length of the law in units of a^2/R, and elements over the contact of Hertz.
_LAYER, _ELEMENTS = 0.05, 40
# a/R by which a load step of the reference grows.
_STEP = 0.025


def case_of(name: str, half_width: float) -> tuple[Case, float]:
    """The case in which Hertz's contact is `half_width` radii wide to each side, and its force [N]."""
    closure, seat = BODIES[name]
    law = {"law": "exponential", "u0": "1 nm", "p_c": "5 GPa"}
    first = Case(
        closure=closure,
        seat=seat,
        interface=law,
        load={"fluid_pressure": "1 mbar", "applied_force": "1 N"},
    )
    R, E = first.contact.relative_radius, first.effective_modulus
    line_load = math.pi * E * half_width**2 * R / 4
    force = float(line_load * 2 * math.pi * first.initial_contact_radius * math.cos(first.contact.angle))
    changes = {
        "load.applied_force": force,
        "interface.u0": _LAYER * half_width**2 * R,
        "interface.p_c": 0.5 * E * half_width,
        "mesh.contact_size": 2 * R * half_width / _ELEMENTS,
    }
    return first.replace(changes), force


def curved_points(seal_mesh: SealMesh) -> FloatArray:
    """Points of all nodes, those between the ends of a side of the contact line on the face itself [m]."""
    points = node_points(seal_mesh, False)
    mesh, contact = seal_mesh.mesh, seal_mesh.contact
    for body in ("closure", "seat"):
        nodes = mesh.nvertices + mesh.boundaries[f"{body}_contact"]
        x = contact.coordinate(*points[:, nodes])
        points[:, nodes] = contact.point(x)
        if body == "closure":
            points[:, nodes] += contact.gap(x) * contact.normal(x)
    return points


def displacement(solid: Solid, straight: FloatArray, contact: ContactSolution) -> FloatArray:
    """What fem-seal finds, at the nodes of the reference [m]: where Newton's method begins."""
    u, model = solid.at_rest, contact.model
    for name, body in (("closure", model.closure), ("seat", model.seat)):
        dofs, places = node_dofs(body.fem.mesh), body.fem.nodes[0]
        nodes = np.unique(solid.cells[solid.members[name]])
        own_nodes = nodes[cKDTree(straight[:, nodes].T).query(places)[1]]
        motion = body.displacement(contact.point_forces)
        u[2 * own_nodes] = motion[dofs[0]]
        u[2 * own_nodes + 1] = motion[dofs[1]] - (contact.approach if name == "closure" else 0.0)
    return u


def top(profile: PressureProfile) -> float:
    """Peak of the ellipse through the upper fifth [Pa]: pressures of the reference scatter by half a per cent."""
    upper = profile.pressure > 0.8 * profile.pressure.max()
    x = profile.x[upper] - profile.x[upper].mean()
    c2, c1, c0 = np.polyfit(x / np.ptp(x), profile.pressure[upper] ** 2, 2)
    return float(np.sqrt(c0 - c1**2 / (4 * c2)))


def leak_rate(profile: PressureProfile, reference: float, folds: float) -> float:
    """Flow through a conductivity exp(-folds p/reference), in units that cancel."""
    is_loaded = profile.pressure > 1e-3 * profile.pressure.max()
    resistance = np.exp(folds * profile.pressure[is_loaded] / reference) / profile.radius[is_loaded]
    return float(1 / (profile.arc_weight[is_loaded] @ resistance))


def finite(
    solid: Solid, straight: FloatArray, small: ContactSolution, law: ExponentialLaw, force: float, steps: int
) -> Profile:
    """The reference under the same force, in steps that begin with what small strains add."""
    u, u_before = solid.at_rest, solid.at_rest
    profile = None
    for share in np.linspace(0.25 if steps > 4 else 1.0, 1.0, steps if steps > 4 else 1) ** 2:
        contact = solve(small.model, law, contact_force=float(force * share))
        linear = displacement(solid, straight, contact)
        trial = u + linear - u_before
        u, u_before = trial if solid.sound(trial) else u, linear
        peak = contact.profile.peak_pressure
        u, _, profile = solve_finite(
            solid, float(force * share), law.u0, law.p_c, u, solid.no_history(), peak
        )
    assert profile is not None
    return profile


def compare(name: str, half_width: float, neo_hookean: bool = False) -> dict[str, Any]:
    """Relative errors of small strains.

    Raises
    ------
    UnsettledError
        If the reference finds no balance.
    """
    case, force = case_of(name, half_width)
    problem = SealProblem.of(case)
    law = problem.law
    assert isinstance(law, ExponentialLaw)
    evaluation = evaluate(problem)
    seal_mesh, contacts = evaluation.seal_mesh, evaluation.solved_loads
    small = contacts.contacts[0]
    materials = {"closure": case.closure.material, "seat": case.seat.material}
    solid = Solid(seal_mesh, curved_points(seal_mesh), materials, neo_hookean)
    q = finite(solid, node_points(seal_mesh, False), small, law, force, math.ceil(half_width / _STEP))
    large = PressureProfile(q.x, q.radius, q.pressure, np.full_like(q.x, np.nan), q.weight)
    own_profile = small.profile
    reference = top(own_profile)
    ratios = {
        "peak": reference / top(large),
        "FWHM": own_profile.fwhm / large.fwhm,
        "std": own_profile.std / large.std,
        **{
            f"leak {folds}": leak_rate(own_profile, reference, folds) / leak_rate(large, reference, folds)
            for folds in (3, 6)
        },
    }
    return {"turned": small.turning, **{key: value - 1 for key, value in ratios.items()}}


def main(*chosen_names: str) -> None:
    names = chosen_names[:1] or tuple(BODIES)
    print("| bodies | a/R | turned | peak | FWHM | std | leak, 3 e-folds | leak, 6 e-folds |")
    for name in names:
        for half_width in map(float, chosen_names[1:] or SERIES):
            try:
                angle, *errors = compare(name, half_width).values()
            except UnsettledError as error:
                print(f"| {name} | {half_width} | {error} |", flush=True)
                continue
            text = " | ".join(f"{100 * error:+.2g} %" for error in errors)
            print(f"| {name} | {half_width} | {angle:.3f} | {text} |", flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
