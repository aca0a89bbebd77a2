"""Leak by a map of CalculiX's pressure, a moment and bolts in 3D: python benchmarks/calculix_around.py [--write].

--write writes calculix_around.md, a part of docs/verification/benchmark_calculix.md, and
tests/reference/calculix_moment.csv and calculix_bolts.csv, which tests compare with.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import argparse
import csv
import math
import sys
import tempfile
import tomllib
from collections.abc import Iterator, Sequence
from pathlib import Path

import calculix
import numpy as np
from calculix_deck import LOWEST_PRESSURE, FloatArray
from calculix_page import table
from calculix_solid import SolidSeal, solid_deck
from case_to_line_load import line_load
from scipy.interpolate import CubicSpline
from three_dimensional_seat import (
    AMPLITUDES,
    CASE,
    LOBES,
    SOLIDS,
    TOLERANCE,
    Solid,
    at_angles,
    corner_pressures,
    loads_around,
    run_solid,
)

import fem_seal
from fem_seal.seal.circumference import Circumference
from fem_seal.seal.problem import SealProblem

HERE = Path(__file__).resolve().parent
PART = HERE / "calculix_around.md"
REFERENCE = HERE.parent / "tests" / "reference"
TABLE, BOLTS_TABLE = REFERENCE / "calculix_moment.csv", REFERENCE / "calculix_bolts.csv"

# For the leak only; the longest waves are as long as the contact is wide.
LEAK = """
[roughness.spectrum]
kind = "self-affine"
rms_height = "0.15 um"
hurst = 0.8
q_low = "2e4 1/m"
q_rolloff = "5e4 1/m"
q_high = "1e6 1/m"
[leak]
plasticity = false
[fluid]
viscosity = "1 mPa s"
"""

# A flange that bends as a slender ring, on a ring gasket with a soft layer.
FLANGE = """
[closure]
shape = "flat"
bore_radius = "26 mm"
outer_radius = "{outer}"
height = "8 mm"
edge_radius = "0.5 mm"
material = {{ youngs_modulus = "200 GPa", poissons_ratio = 0.3 }}
[gasket]
shape = "ring"
mean_diameter = "60 mm"
section_diameter = "6 mm"
material = {{ youngs_modulus = "200 GPa", poissons_ratio = 0.3 }}
[interface]
law = "exponential"
u0 = "10 um"
p_c = "1 GPa"
[load]
fluid_pressure = "0.01 Pa"
"""
MOMENT = """
applied_force = "4 kN"
bending_moment = "{moment} N m"
"""
BOLTS = """
[bolts]
number = 4
stress_area = "36.6 mm^2"
length = "22 mm"
youngs_modulus = "200 GPa"
preload = "{preload} N"
circle_diameter = "72 mm"
tightness = [1, 1, {third}, 1]
"""
FORCE, RADIUS, SOLID = 4e3, 0.03, Solid(100e-6, 0.5, 24)
# Moments over F r0, with and without lift-off.
SHARES = 0.3, 0.7
# Tightness of the third of four bolts.
THIRDS = 1.0, 0.0
BOLTS_COLUMNS = "tightness_of_third", "angle_deg", "line_load_over_mean"
COLUMNS = "moment_share", "angle_deg", "line_load_over_mean", "tilt_rad", "moment_N_m"
Row = tuple[float, ...]


def bent_flange(share: float) -> SealProblem:
    """The flange under a moment."""
    text = (FLANGE + MOMENT).format(outer="34 mm", moment=share * FORCE * RADIUS)
    return SealProblem.of(fem_seal.Case(**tomllib.loads(text)))


def bolted_flange(third: float) -> SealProblem:
    """A wider flange under four bolts, the third of them less tight."""
    text = (FLANGE + BOLTS).format(outer="42 mm", preload=FORCE / (3.0 + third), third=third)
    return SealProblem.of(fem_seal.Case(**tomllib.loads(text)))


def run_bent(share: float, folder: Path) -> Iterator[Row]:
    """CalculiX's half of the flange: angle, line load over its mean, tilt of the top, moment of the whole contact."""
    seal, angle, over_mean = run_half(bent_flange(share), folder, share * FORCE * RADIUS)
    nodes, moved = zip(*calculix.displacements(folder).items(), strict=True)
    x = 1e-3 * seal.closure.places()[np.array(nodes) - 1, 0]
    tilt = -float(np.polyfit(x, np.array(moved)[:, 2], 1)[0])
    carried = -2.0 * calculix.contact_moment(folder)[1]
    for phi, one in zip(np.degrees(angle), over_mean, strict=True):
        yield tuple(float(f"{value:.5g}") for value in (share, phi, one, tilt, carried))


def run_half(
    problem: SealProblem, folder: Path, moment: float = 0.0
) -> tuple[SolidSeal, FloatArray, FloatArray]:
    """CalculiX's half of a flange, with the angles of its planes and the line load there over its mean."""
    found = line_load(problem)
    way_down = problem.law.u0 * math.log(1e-6 * found.local.mean.profile.peak_pressure / LOWEST_PRESSURE)
    seal = SolidSeal.of(SOLID.section(problem), SOLID.layers, 0.0, way_down, math.pi)
    deck = solid_deck(
        seal, problem.materials, problem.law, FORCE, TOLERANCE, moment=moment, bolts=found.form.bolts
    )
    print(calculix.run(deck, 1, folder), flush=True)
    (pressure,) = calculix.contact_pressures(folder / "seal.frd")
    angle, f, _ = loads_around(seal, pressure)
    return seal, angle, f * np.ptp(angle) / np.trapezoid(f, angle)


def run_bolted(third: float, folder: Path) -> Iterator[Row]:
    """CalculiX's half of the flange under bolts: angle and line load over its mean."""
    _, angle, over_mean = run_half(bolted_flange(third), folder)
    for phi, one in zip(np.degrees(angle), over_mean, strict=True):
        yield tuple(float(f"{value:.5g}") for value in (third, phi, one))


def bolt_rows(rows: Sequence[Row]) -> Iterator[tuple[object, ...]]:
    """Both programs at each tightness of the third bolt."""
    for third in THIRDS:
        angle, theirs = np.array([row[1:] for row in rows if row[0] == third]).T
        found = line_load(bolted_flange(third))
        ours = at_angles(found, found.over_mean, np.radians(angle))
        off = theirs - ours
        at = [int(np.flatnonzero(angle == phi)[0]) for phi in (0, 45, 90, 135, 180)]
        numbers = (f"{values[k]:.4f}" for k in at for values in (ours, theirs))
        yield third, *numbers, f"{1e2 * off[np.argmax(np.abs(off))]:+.2f} %"


def moment_rows(rows: Sequence[Row]) -> Iterator[tuple[object, ...]]:
    """Both programs at each moment."""
    for share in SHARES:
        angle, theirs, (tilt, *_), (carried, *_) = np.array([row[1:] for row in rows if row[0] == share]).T
        found = line_load(bent_flange(share))
        ours = at_angles(found, found.over_mean, np.radians(angle))
        off = theirs - ours
        numbers = ours[0], theirs[0], ours[-1], theirs[-1]
        yield (
            share,
            f"{share * FORCE * RADIUS:.2f}",
            f"{carried:.2f}",
            *(f"{n:.4f}" for n in numbers),
            f"{1e2 * off[np.argmax(np.abs(off))]:+.2f} %",
            f"{1e3 * found.tilt_angle:.4f}",
            f"{1e3 * tilt:.4f}",
            f"{1e2 * (tilt / found.tilt_angle - 1):+.2f} %",
        )


def write_map(file: Path, points: FloatArray, pressure: FloatArray) -> None:
    """Table of points of the whole seat, from the pressures of a quarter."""
    whole = np.concatenate([pressure, pressure[-2::-1]])
    whole = np.concatenate([whole, whole[1:-1]])
    phi = 2 * math.pi * np.arange(len(whole)) / len(whole)
    r, z = 1e3 * points
    columns = np.outer(np.cos(phi), r), np.outer(np.sin(phi), r), np.tile(z, (len(phi), 1)), 1e-6 * whole
    rows = np.column_stack([column.ravel() for column in columns])
    np.savetxt(file, rows, "%.9g", ",", header="x [mm],y [mm],z [mm],pressure [MPa]", comments="")


def own_pressures(found: Circumference, seal: SolidSeal, points: FloatArray) -> FloatArray:
    """The pressure of fem-seal at the nodes of CalculiX."""
    x = seal.closure.section.contact.coordinate(*points)
    profiles = [found.profile_at(float(phi)) for phi in seal.closure.angle[::2]]
    return np.exp([CubicSpline(one.x, np.log(one.pressure))(x) for one in profiles])


def leak_rows(solid: Solid, folder: Path) -> Iterator[tuple[object, ...]]:
    """Leak rate of the seal by a run, and what maps of its pressure have more."""
    for amplitude in (0.0, AMPLITUDES[1]):
        file, text = folder / "case.toml", CASE.format(lobes=LOBES, amplitude=f"{1e6 * amplitude:g}")
        file.write_text(text + LEAK)
        case = fem_seal.load_case(file)
        problem = SealProblem.of(case)
        found = line_load(problem)
        print(run_solid(problem, solid, amplitude, float(found.peak_pressure.max()), folder).cost, flush=True)
        seal = SolidSeal.of(solid.section(problem), solid.layers, amplitude, 0.0)
        (pressure,) = calculix.contact_pressures(folder / "seal.frd")
        points, theirs = corner_pressures(seal, pressure)
        file.write_text(text[: text.index("[form")] + LEAK)
        round_case, by_run = fem_seal.load_case(file), fem_seal.run(case).loads[-1].leak.leak_rate
        shares = []
        for name, p in ("own", own_pressures(found, seal, points)), ("calculix", theirs):
            write_map(folder / f"{name}.csv", points, p)
            (load,) = fem_seal.leak_of_pressure_map(folder / f"{name}.csv", round_case).loads
            shares.append(load.leak.leak_rate / by_run - 1)
        yield (
            f"{1e6 * amplitude:g} um",
            solid,
            p.size,
            f"{by_run:.4g}",
            *(f"{1e2 * share:+.2f} %" for share in shares),
            f"{1e2 * load.mesh_error.leak_rate:.1f} %",
        )


PAGE = """# The leak by a map of the pressure

Written by `benchmarks/calculix_around.py`. The round seat and the one with A = 1 um again: the pressures that CalculiX
found at the elements' corners, mirrored to the whole seat, as a table of points for `fem-seal leak map.csv case.toml`,
against the leak rate of `fem-seal run` with the table `[form]`. A liquid of 1 mPa s, 20 bar, lapped surfaces (rms
height 0.15 um). Map of its own pressure: the same with the pressures of fem-seal at these points, which is what the
points alone are worth. What is left is CalculiX's: its pressures carry up to 0.8 % more than the force, and its peak is
as much higher (see above). Stated: the error that goes with the map's leak rate.

{leaks}

# A bending moment

A steel flange of 8 mm by 8 mm around a circle of 60 mm, which bends as a slender ring, on a steel ring gasket of 6 mm
with a layer p = p_c exp(-u/u0), u0 = 10 um, under 4 kN and a moment M (`[load] bending_moment`). CalculiX gets a half
of both bodies (100 um across, 24 layers over 180 degrees), the moment as a pressure on the flange's top that goes with
cos(phi), no support of the flange but the gasket, and says what moment its contact carries. Line loads over their
mean, and the tilt of the flange's top [mrad], which fem-seal takes as rigid there and CalculiX does not. Difference:
the largest at any angle, over the mean (goal 2 %).

{moments}

# Bolts one by one

A wider flange, to a radius of 42 mm, on the same ring under the same force of four bolts on a circle of 72 mm
(`[bolts] circle_diameter`), at 0, 90, 180 and 270 degrees. CalculiX gets the same half, and each bolt as forces on the
nodes of the flange's top around its place, as a round head of 11.9 mm presses. Line loads over their mean; the
difference is the largest at any angle (goal 2 %).

{bolts}
"""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    try:
        calculix.version()
    except FileNotFoundError as error:
        print(f"skipped: {error}")
        return 0
    with tempfile.TemporaryDirectory() as name:
        rows = [row for share in SHARES for row in run_bent(share, Path(name))]
        bolted_rows = [row for third in THIRDS for row in run_bolted(third, Path(name))]
        leaks = table(
            "A, size and layers, points of the quarter, run [m^3/s], map of its own pressure, "
            "map of CalculiX's pressure, stated",
            [row for solid in SOLIDS for row in leak_rows(solid, Path(name))],
        )
    moments = table(
        "M/(F r0), M, M of CalculiX's contact [N m], at 0 deg: fem-seal, CalculiX, at 180 deg: fem-seal, CalculiX, "
        "difference, tilt: fem-seal, CalculiX, difference of tilt",
        moment_rows(rows),
    )
    at = ", ".join(f"at {phi} deg: fem-seal, CalculiX" for phi in (0, 45, 90, 135, 180))
    bolts = table(f"tightness at 180 deg, {at}, difference", bolt_rows(bolted_rows))
    text = PAGE.format(leaks=leaks, moments=moments, bolts=bolts)
    print(text)
    if options.write:
        PART.write_text(text, encoding="utf-8")
        with TABLE.open("w", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows([COLUMNS, *rows])
        with BOLTS_TABLE.open("w", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows([BOLTS_COLUMNS, *bolted_rows])
    return 0


if __name__ == "__main__":
    sys.exit(main())
