"""From a case file to the line load around the axis, and nothing else: python case_to_line_load.py CASE OUTPUT."""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import sys
from pathlib import Path

import numpy as np

from fem_seal import load_case
from fem_seal.contact.newton import solve
from fem_seal.contact.solution import ContactSolution
from fem_seal.seal.circumference import Circumference
from fem_seal.seal.problem import SealProblem, condense_bodies, expected_forces, size_mesh
from meshes import build_contact


def mean_contact(problem: SealProblem) -> ContactSolution:
    """The round seal under the load of a case."""
    model = condense_bodies(problem, build_contact(problem.contact, size_mesh(problem)))
    return solve(model, problem.law, contact_force=expected_forces(problem)[-1])


def line_load(problem: SealProblem) -> Circumference:
    """The seal as it is."""
    found = problem.circumference(mean_contact(problem), problem.loads.fluid_pressure[-1])
    assert found is not None  # of a seal that is not round
    return found


if __name__ == "__main__":
    case_file, output = sys.argv[1:]
    forces = line_load(SealProblem.of(load_case(case_file)))
    table = np.column_stack([forces.angle, forces.line_load, forces.peak_pressure])
    np.savetxt(Path(output), table, delimiter=",", header="angle_rad, line_load_N_per_m, peak_pressure_Pa")
