"""A yielding seat under a spring and then a fluid, in fem-seal and in CalculiX: python benchmarks/calculix_yielding.py.

The same mesh of 6-node triangles, the same curve (`*PLASTIC`), the same exponential law, the same load steps. CalculiX
knows no flow: it is given the fluid pressure in the gap that fem-seal found, on both faces of the contact, beside the
pressure on the wetted faces. Writes tests/reference/calculix_yielding.csv, which the tests compare with.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import csv
import math
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import calculix
import calculix_deck as deck
import numpy as np
from calculix_deck import Cells, FloatArray

import leak
import meshes
from fem_seal.contact.load_path import ElastoplasticContact, load_path
from fem_seal.contact.model import condense
from fem_seal.contact.penetration import PenetratingFluid
from fem_seal.contact.plastic_step import PathLoad, PlasticSettings
from fem_seal.contact.sizing import element_sizes, for_yielding
from fem_seal.loads import line_load
from fem_seal.materials import HardeningCurve, Material, effective_modulus
from meshes import SealMesh

HERE = Path(__file__).resolve().parent
TABLE = HERE.parent / "tests" / "reference" / "calculix_yielding.csv"
STEPS = 8
STEEL = Material("steel", 210e9, 0.3)
SOFT = Material("soft steel", 210e9, 0.3, hardening=HardeningCurve((0.0, 0.002, 0.05), (250e6, 325e6, 400e6)))
HARD = Material("tool steel", 210e9, 0.3, hardening=HardeningCurve((0.0, 0.1), (1000e6, 1300e6)))


@dataclass(frozen=True)
class Valve:
    """A closure on a seat, a spring, and the pressure in the bore that comes after it.

    Parameters
    ----------
    name : str
    closure, seat : shapes of `meshes`
    materials : dict
        Of "closure" and "seat".
    spring : float
        [N]
    fluid_pressure : float
        [Pa]
    u0 : float
        Decay length of the exponential law [m]. CalculiX presses where the surfaces overlap alone, by some 17 u0: on an
        edge that must be little against its radius.
    """

    name: str
    closure: meshes.Shape
    seat: meshes.Shape
    materials: dict[str, Material]
    spring: float
    fluid_pressure: float
    u0: float

    @property
    def law(self) -> leak.ExponentialLaw:
        """The interface law."""
        return leak.ExponentialLaw(p_c=5e9, u0=self.u0)

    def mesh(self) -> SealMesh:
        """Coarse enough for CalculiX to take a minute."""
        contact = meshes.ContactGeometry.of(self.closure.outline, self.seat.outline)
        load = line_load(self.spring, contact.initial_contact_radius, contact.angle)
        modulus = effective_modulus(self.materials["closure"], self.materials["seat"])
        sizing = element_sizes(self.law, [load], contact, modulus)
        softest = min(material.yield_stress for material in self.materials.values() if material.yield_stress)
        return meshes.build_contact(contact, for_yielding(sizing, contact, softest, load).refined(0.5))


def valves() -> Iterator[Valve]:
    """A ball on a cone, and a poppet on the rounded edge of its bore where both yield."""
    ball = meshes.Ball(0.02)
    yield Valve(
        "ball on cone",
        ball,
        meshes.ConicalSeat.around(math.radians(45), ball),
        {"closure": STEEL, "seat": SOFT},
        2.5e4,
        300e5,
        0.76e-6,
    )
    poppet = meshes.RoundedCone.of(math.radians(45), outer_radius=6e-3, inner_radius=3e-3)
    yield Valve(
        "poppet on edge",
        poppet,
        meshes.SharpEdge.around(4e-3, poppet, edge_radius=0.2e-3),
        {"closure": HARD, "seat": HARD},
        2000.0,
        250e5,
        0.15e-6,
    )


def penetrating_fluid() -> PenetratingFluid:
    """A liquid in the bore, through sigma ~ 1/p."""

    def pressure_along(profile, fluid_pressure):  # type: ignore[no-untyped-def]
        return leak.leak_flow(
            profile.x,
            profile.pressure,
            lambda p: 1 / p,
            fluid_pressure,
            profile.radius,
            pressure_side="inner",
        ).fluid_pressure

    return PenetratingFluid(pressure_along, math.inf, "inner")


def ours(valve: Valve, mesh: SealMesh) -> tuple[ElastoplasticContact, ...]:
    """Contacts under the spring alone, and with the fluid."""
    model = condense(mesh, valve.materials)
    fluid = penetrating_fluid()
    loads = [
        PathLoad(valve.spring, path=fluid, fluid_pressure=pressure)
        for pressure in (0.0, valve.fluid_pressure)
    ]
    return load_path(model, valve.law, loads, settings=PlasticSettings(steps=STEPS), unload=False).contacts


def write_deck(valve: Valve, mesh: SealMesh, contacts: Sequence[ElastoplasticContact]) -> str:
    """Deck with as many steps for CalculiX: the spring rises, then the fluid."""
    cells = list(deck.cells_of(mesh.mesh, "CAX6"))
    first = contacts[0].profile.peak_pressure / STEPS
    lines = [
        "*HEADING",
        f"{valve.name}; mm, N, MPa",
        *deck._nodes(mesh, cells, valve.law, first, True),
        *_bodies(cells, valve.materials),
        *deck._contact(mesh.mesh, cells, valve.law),
        *deck._supports(mesh.mesh),
    ]
    gap = contacts[1].loads.gap_pressure
    assert gap is not None
    for number in range(1, 2 * STEPS + 1):
        spring, fluid = min(number / STEPS, 1.0), max(number / STEPS - 1.0, 0.0)
        lines += _step(valve, mesh, cells, spring, fluid, contacts[1].profile.x, gap, number == 1)
    return "\n".join([*lines, ""])


def _bodies(cells: Sequence[Cells], materials: dict[str, Material]) -> Iterator[str]:
    for line in deck._bodies(cells, materials):
        if line.startswith("*SOLID SECTION"):
            hardening = materials[line.split("MATERIAL=")[1]].hardening
            if hardening is not None:
                yield "*PLASTIC"
                for strain, stress in zip(hardening.plastic_strain, hardening.stress, strict=True):
                    yield f"{1e-6 * stress:.12g},{strain:.12g}"
        yield line


def _step(
    valve: Valve,
    mesh: SealMesh,
    cells: Sequence[Cells],
    spring: float,
    fluid: float,
    x: FloatArray,
    gap: FloatArray,
    first: bool,
) -> Iterator[str]:
    """One step; CalculiX gives a whole side of an element one pressure."""
    section, facets = mesh.mesh, mesh.mesh.boundaries["closure_top"]
    area = np.pi * float(np.abs(np.diff(section.p[0, section.facets[:, facets]] ** 2, axis=0)).sum())
    yield from ("*STEP, INC=200", "*STATIC", "1.,1.")
    if first:
        yield from ("*CONTROLS, PARAMETERS=FIELD", "1e-5,1e-5")
    yield "*DLOAD"
    for cell, side in deck.sides_on(section, cells, "closure_top"):
        yield f"{cell},P{side},{1e-6 * spring * valve.spring / area:.12e}"
    for boundary in ("closure_inner", "seat_inner"):
        if boundary in section.boundaries:
            for cell, side in deck.sides_on(section, cells, boundary):
                yield f"{cell},P{side},{1e-6 * fluid * valve.fluid_pressure:.12e}"
    for boundary in ("closure_contact", "seat_contact"):
        middles = _middles(mesh, cells, boundary)
        for (cell, side), at in zip(deck.sides_on(section, cells, boundary), middles, strict=True):
            yield f"{cell},P{side},{1e-6 * fluid * float(np.interp(at, x, gap)):.12e}"
    yield from (
        "*CONTACT FILE",
        "CDIS,CSTR",
        "*NODE PRINT, NSET=Nseat_bottom, TOTALS=ONLY",
        "RF",
        "*END STEP",
    )


def _middles(mesh: SealMesh, cells: Sequence[Cells], boundary: str) -> list[float]:
    """Arc length of the middle of each facet, in the order of `calculix_deck.sides_on`."""
    section, coordinates = mesh.mesh, []
    facets_of_side = section.nvertices + section.boundaries[boundary]
    middle = section.p[:, section.facets].mean(axis=1)
    for part in cells:
        nodes = part.nodes[:, part.nodes.shape[1] // 2 :]
        rows, columns = np.nonzero(np.isin(nodes, facets_of_side))
        facets = nodes[rows, columns] - section.nvertices
        coordinates += np.atleast_1d(mesh.contact.coordinate(*middle[:, facets])).tolist()
    return coordinates


COLUMNS = (
    "valve",
    "fluid_pressure_Pa",
    "carried_N",
    "peak_over_line_load_per_m",
    "fwhm_m",
    "std_m",
)


def main() -> None:
    """Compare and write the table."""
    rows = []
    for valve in valves():
        if len(sys.argv) > 1 and sys.argv[-1] not in ("--write", valve.name):
            continue
        mesh = valve.mesh()
        contacts = ours(valve, mesh)
        print(valve.name, mesh.mesh.nelements, "triangles", flush=True)
        with tempfile.TemporaryDirectory() as folder:
            calculix.run(write_deck(valve, mesh, contacts), 2 * STEPS, Path(folder))
            profiles = calculix.profiles(Path(folder), mesh)
        for contact, theirs, pressure in zip(
            contacts, (profiles[STEPS - 1], profiles[-1]), (0.0, valve.fluid_pressure), strict=True
        ):
            measures = []
            for profile in (theirs, contact.profile):
                is_loaded = (
                    2
                    * math.pi
                    * profile.moment(0)
                    * mesh.contact.initial_contact_radius
                    * math.cos(mesh.contact.angle)
                )
                measures.append(
                    (is_loaded, profile.peak_pressure / profile.moment(0), profile.fwhm, profile.std)
                )
            print(
                pressure, *(f"{b:.6g} ({b / a - 1:+.2%})" for a, b in zip(*measures, strict=True)), flush=True
            )
            rows.append((valve.name, pressure, *(f"{number:.7g}" for number in measures[0])))
    if "--write" in sys.argv:
        with TABLE.open("w", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows([COLUMNS, *rows])


if __name__ == "__main__":
    main()
