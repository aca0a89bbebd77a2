"""A copper ring between steel plates, pressed and released, here and in CalculiX: python benchmarks/calculix_ring.py.

Half of the ring on its mid-plane, on the same mesh of 6-node triangles, with the same exponential law, the same curve
(`*PLASTIC`) and small strains in both. Writes tests/reference/calculix_ring.csv with --write, which the tests compare
with; --own solves the ring that yields here alone, to be timed.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import csv
import math
import re
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import calculix
import calculix_deck as deck
import numpy as np
from calculix_deck import Cells, FloatArray
from calculix_yielding import _bodies
from measured_process import Cost
from skfem import MeshTri

import leak
import meshes
from fem_seal.contact.load_path import load_path
from fem_seal.contact.model import condense
from fem_seal.contact.newton import solve
from fem_seal.contact.plastic_step import PathLoad, PlasticSettings
from fem_seal.contact.sizing import element_sizes, for_yielding
from fem_seal.contact.solution import ContactSolution
from fem_seal.loads import line_load
from fem_seal.materials import HardeningCurve, Material, effective_modulus
from fem_seal.profile import PressureProfile
from meshes import SealMesh

TABLE = Path(__file__).resolve().parent.parent / "tests" / "reference" / "calculix_ring.csv"
STEEL = Material("steel", 210e9, 0.3)
CURVE = HardeningCurve((0.0, 0.02, 0.1, 0.3), (60e6, 120e6, 220e6, 300e6))
COPPER = Material("copper", 120e9, 0.34, hardening=CURVE)
LAW = leak.ExponentialLaw(p_c=2e9, u0=0.2e-6)
# The loads [N], and steps per unit of the largest; CalculiX takes all of them.
FORCES, STEPS = (1e3, 3e3, 6e3, 3e3, 1e3), 24
MATERIALS = {
    "elastic": {"closure": STEEL, "seat": replace(COPPER, hardening=None)},
    "plastic": {"closure": STEEL, "seat": COPPER},
}


def ring() -> meshes.Profile:
    """Upper half of a ring with a section of 4 mm on a mean diameter of 40 mm, 0.2 mm of its sides upright."""
    outer, top, inner = (0.022, 0.2e-3), (0.020, 2.2e-3), (0.018, 0.2e-3)
    return meshes.Profile(
        "seat",
        (
            meshes.Segment((0.018, 0.0), (0.022, 0.0), "bottom"),
            meshes.Segment((0.022, 0.0), outer, "wall"),
            meshes.Segment(outer, top, "", centre=(0.020, 0.2e-3)),
            meshes.Segment(top, inner, "", centre=(0.020, 0.2e-3)),
            meshes.Segment(inner, (0.018, 0.0), "inner"),
        ),
    )


def mesh(name: str) -> SealMesh:
    """Coarse enough for CalculiX to take a minute or two."""
    contact = meshes.ContactGeometry.of(meshes.Disc.of(0.03).outline, ring().outline)
    loads = [line_load(force, contact.initial_contact_radius, contact.angle) for force in FORCES]
    sizing = element_sizes(LAW, loads, contact, effective_modulus(STEEL, COPPER))
    if name == "plastic":
        sizing = for_yielding(sizing, contact, CURVE.yield_stress, max(loads))
    return meshes.build_contact(contact, sizing.refined(0.7))


def ours(name: str, seal_mesh: SealMesh) -> Sequence[ContactSolution]:
    """The contact under each load."""
    model = condense(seal_mesh, MATERIALS[name])
    if name == "elastic":
        return [solve(model, LAW, contact_force=force) for force in FORCES]
    settings = PlasticSettings(steps=STEPS)
    return load_path(model, LAW, [PathLoad(f) for f in FORCES], settings=settings, unload=False).contacts


def measures(profile: PressureProfile, approach: float) -> tuple[float, float, float, float]:
    """Peak pressure over line load [1/m], width at half of the peak, standard deviation, and way of the plate [m]."""
    return profile.peak_pressure / profile.moment(0), profile.fwhm, profile.std, approach


def own_measures(name: str, seal_mesh: SealMesh) -> FloatArray:
    """`measures` of all loads, shape (loads, 4)."""
    return np.array([measures(contact.profile, contact.approach) for contact in ours(name, seal_mesh)])


def way() -> list[float]:
    """All forces on the way, from the smallest step on [N]."""
    step, at, increments = max(FORCES) / STEPS, 0.0, list[float]()
    for force in FORCES:
        count = math.ceil(abs(force - at) / step - 1e-9)
        increments += [at + (force - at) * n / count for n in range(1, count + 1)]
        at = force
    return increments


def write_deck(name: str, seal_mesh: SealMesh) -> str:
    """Deck: the closure's top goes down and up under an even pressure."""
    section = seal_mesh.mesh
    cells = list(deck.cells_of(section, "CAX6"))
    lines = [
        "*HEADING",
        "ring between plates; mm, N, MPa",
        *deck._nodes(seal_mesh, cells, LAW, ours(name, seal_mesh)[0].profile.peak_pressure / 5, True),
        *_bodies(cells, MATERIALS[name]),
        *deck._contact(section, cells, LAW),
        *deck._supports(section),
    ]
    facets = section.boundaries["closure_top"]
    top = np.unique(np.concatenate([section.facets[:, facets].ravel(), section.nvertices + facets]))
    lines += ["*NSET, NSET=Ntop", *(str(node + 1) for node in top)]
    for number, force in enumerate(way()):
        lines += _step(section, cells, force, number == 0)
    return "\n".join([*lines, ""])


def _step(section: MeshTri, cells: Sequence[Cells], force: float, first: bool) -> Iterator[str]:
    facets = section.boundaries["closure_top"]
    area = np.pi * 1e6 * float(np.abs(np.diff(section.p[0, section.facets[:, facets]] ** 2, axis=0)).sum())
    yield from ("*STEP, INC=200", "*STATIC", "1.,1.")
    if first:
        yield from ("*CONTROLS, PARAMETERS=FIELD", "1e-5,1e-5")
    yield "*DLOAD"
    for cell, side in deck.sides_on(section, cells, "closure_top"):
        yield f"{cell},P{side},{force / area:.12e}"
    yield from ("*CONTACT FILE", "CDIS,CSTR", "*NODE PRINT, NSET=Ntop", "U", "*END STEP")


def read_approaches(folder: Path, seal_mesh: SealMesh) -> list[float]:
    """By how much the closure's top has gone down after every step, in the mean over its area [m]."""
    section = seal_mesh.mesh
    points, facets = deck.node_points(seal_mesh, True), section.boundaries["closure_top"]
    # Simpson's rule over r dr on each facet
    weight = np.zeros(points.shape[1])
    for a, b, m in zip(*section.facets[:, facets], section.nvertices + facets, strict=True):
        length = abs(points[0, b] - points[0, a])
        for node, share in ((a, 1.0), (m, 4.0), (b, 1.0)):
            weight[node] += share * length * points[0, node]
    ways_down = []
    for block in re.split(r"displacements \(vx,vy,vz\).*\n", (folder / "seal.dat").read_text())[1:]:
        rows = [line.split() for line in block.splitlines() if len(line.split()) == 4]
        nodes = np.array([int(row[0]) - 1 for row in rows])
        displacements = np.array([float(row[2]) for row in rows])
        ways_down.append(-1e-3 * float(weight[nodes] @ displacements / weight[nodes].sum()))
    return ways_down


def theirs(name: str, seal_mesh: SealMesh) -> tuple[FloatArray, Cost]:
    """`measures` of CalculiX, and what it took; the way of the closure counts from a place of its own."""
    forces = way()
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        cost = calculix.run(write_deck(name, seal_mesh), len(forces), folder)
        profiles, ways_of_steps = calculix.profiles(folder, seal_mesh), read_approaches(folder, seal_mesh)
    ends, at = [], 0
    for force in FORCES:
        at = next(n for n in range(at, len(forces)) if math.isclose(forces[n], force))
        ends.append(at)
        at += 1
    return np.array([measures(profiles[n], ways_of_steps[n]) for n in ends]), cost


COLUMNS = ("bodies", "applied_force_N", "peak_over_line_load_per_m", "fwhm_m", "std_m", "way_m")


def compare_lines(first: FloatArray, second: FloatArray) -> Iterator[str]:
    """Both programs, with the ways from load to load."""
    ways = np.diff(first[:, 3]) / np.diff(second[:, 3]) - 1
    for n, force in enumerate(FORCES):
        peak, width, std = first[n, :3] / second[n, :3] - 1
        way_text = f", way {ways[n - 1]:+.2%}" if n else ""
        yield f"{force:6.0f} N: peak {peak:+.2%}, width {width:+.2%}, std {std:+.2%}{way_text}"


def main() -> None:
    """Compare and write the table."""
    rows = []
    for name in MATERIALS:
        seal_mesh = mesh(name)
        print(name, seal_mesh.mesh.nelements, "triangles", flush=True)
        calculix_line, _ = theirs(name, seal_mesh)
        print(*compare_lines(own_measures(name, seal_mesh), calculix_line), sep="\n", flush=True)
        rows += [
            (name, force, *(f"{number:.7g}" for number in line))
            for force, line in zip(FORCES, calculix_line.tolist(), strict=True)
        ]
    if "--write" in sys.argv:
        with TABLE.open("w", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows([COLUMNS, *rows])


if __name__ == "__main__":
    if "--own" in sys.argv:
        own_measures("plastic", mesh("plastic"))
    else:
        main()
