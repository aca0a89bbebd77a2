"""From a case file to the pressure profiles, and nothing else: python case_to_profile.py CASE CONTACT_SIZE PROFILES.

CONTACT_SIZE is the element size along the contact line [m], 0 for the one that fem-seal chooses.
"""
# ruff: noqa: E402

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from fem_seal.__main__ import postpone_unused_imports

# as the command fem-seal starts
postpone_unused_imports()

import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from fem_seal import Case, load_case
from fem_seal.contact.model import ContactModel, condense
from fem_seal.contact.newton import solve
from fem_seal.contact.solution import ContactSolution
from fem_seal.seal.problem import SealProblem, expected_forces, size_mesh
from meshes import SealMesh, build_contact


def mesh_of(case: Case, contact_size: float = 0.0) -> SealMesh:
    """Mesh of a case, with elements along the contact line coarser than [mesh] contact_size would allow."""
    sizes = size_mesh(SealProblem.of(case))
    return build_contact(case.contact, replace(sizes, contact_size=contact_size or sizes.contact_size))


def model_of(case: Case, seal_mesh: SealMesh) -> ContactModel:
    """Condense a case's bodies."""
    return condense(seal_mesh, {"closure": case.closure.material, "seat": case.seat.material})


def solutions(case: Case, model: ContactModel) -> Sequence[ContactSolution]:
    """Solve all loads of a case."""
    problem = SealProblem.of(case)
    return [solve(model, problem.law, contact_force=force) for force in expected_forces(problem)]


def main(file: str, contact_size: str, output: str) -> None:
    case = load_case(file)
    contacts = solutions(case, model_of(case, mesh_of(case, float(contact_size))))
    x = contacts[0].profile.x
    table = np.column_stack([x, *(solution.profile.pressure for solution in contacts)])
    np.savetxt(Path(output), table, delimiter=",", header="x_m, then contact_pressure_Pa of every load")


if __name__ == "__main__":
    main(*sys.argv[1:])
