"""Run CalculiX on a deck and read the contact pressure that it found."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from calculix_deck import FloatArray
from measured_process import Cost, measure_process

from fem_seal.profile import PressureProfile
from meshes import SealMesh

# CalculiX turns the section into a sector of this share of the circumference, and prints the forces of the sector.
SECTOR = 2 / 360

HOW_TO_INSTALL = "CalculiX (ccx) is not installed; on Debian or Ubuntu: apt-get install calculix-ccx"


class DivergenceError(RuntimeError):
    """CalculiX ended before the last step."""


def version() -> str:
    """Version of the installed CalculiX.

    Raises
    ------
    FileNotFoundError
        If there is none; the message says how to install it.
    """
    if shutil.which("ccx") is None:
        raise FileNotFoundError(HOW_TO_INSTALL)
    # It ends with a code other than 0 after it has said its version.
    return subprocess.run(["ccx", "-v"], capture_output=True, text=True, check=False).stdout.split()[-1]


def run(deck: str, steps: int, folder: Path, threads: int = 1) -> Cost:
    """Solve a deck; the results stay in the folder.

    Raises
    ------
    DivergenceError
        If it does not reach the last step.
    """
    (folder / "seal.inp").write_text(deck)
    cost = measure_process(["ccx", "-i", "seal"], folder, {"OMP_NUM_THREADS": str(threads)})
    log = (folder / "printed.log").read_text(errors="replace")
    increments = [int(line.split()[0]) for line in (folder / "seal.sta").read_text().splitlines()[2:]]
    if "Job finished" not in log or not increments or increments[-1] != steps:
        raise DivergenceError(
            f"CalculiX stopped in step {increments[-1] if increments else 1} of {steps}: {log[-500:]}"
        )
    return cost


def profiles(folder: Path, seal_mesh: SealMesh) -> list[PressureProfile]:
    """Pressure over the contact line after every step."""
    return [_profile(seal_mesh, pressure) for pressure in contact_pressures(folder / "seal.frd")]


def reactions(folder: Path) -> FloatArray:
    """Axial force on the seat's bottom after every step [N]."""
    return total_forces(folder)[:, 1] / SECTOR


def total_forces(folder: Path) -> FloatArray:
    """Reactions on the seat's bottom after every step [N], as CalculiX prints them, shape (steps, 3)."""
    lines = (folder / "seal.dat").read_text().splitlines()
    totals = [lines[k + 2] for k, line in enumerate(lines) if "total force" in line]
    return np.array([[float(word) for word in line.split()] for line in totals])


def contact_moment(folder: Path) -> FloatArray:
    """Of the contact about the origin after the last step [N m], as CalculiX prints it, shape (3,)."""
    lines = (folder / "seal.dat").read_text().splitlines()
    last = max(k for k, line in enumerate(lines) if "moment about the origin" in line)
    return 1e-3 * np.array(lines[last + 2].split()[3:], dtype=float)


def displacements(folder: Path) -> dict[int, FloatArray]:
    """Of the nodes of the one set that is printed [m], over their number."""
    lines = (folder / "seal.dat").read_text().splitlines()
    first = next(k for k, line in enumerate(lines) if "displacements" in line) + 2
    rows = (line.split() for line in lines[first : lines.index("", first)])
    return {int(node): 1e-3 * np.array(values, dtype=float) for node, *values in rows}


def contact_pressures(file: Path) -> Iterator[dict[int, float]]:
    """Pressure [Pa] over node number from 0, step by step."""
    pressure: dict[int, float] | None = None
    with file.open() as lines:
        for line in lines:
            if line.startswith(" -4"):
                pressure = {} if "CONTACT" in line else None
            elif pressure is not None and line.startswith(" -1"):
                pressure[int(line[3:13]) - 1] = 1e6 * float(line[49:61])
            elif pressure is not None and line.startswith(" -3"):
                yield pressure
                pressure = None


def _profile(seal_mesh: SealMesh, pressure: dict[int, float]) -> PressureProfile:
    """Profile at the vertices of the closure's contact line, with the weights of the trapezoidal rule.

    The pressure that CalculiX prints at midside nodes is extrapolated to them and lower by turns; without them all
    measures come out several times closer to the exact ones.
    """
    mesh, contact = seal_mesh.mesh, seal_mesh.contact
    vertices = np.unique(mesh.facets[:, mesh.boundaries["closure_contact"]])
    x = contact.coordinate(*mesh.p[:, vertices])
    order = np.argsort(x)
    x, vertices = x[order], vertices[order]
    weight = 0.5 * (np.diff(x, prepend=x[0]) + np.diff(x, append=x[-1]))
    p = np.array([pressure.get(vertex, 0.0) for vertex in vertices.tolist()])
    return PressureProfile(x, contact.radius(x), p, np.full_like(x, np.nan), weight)
