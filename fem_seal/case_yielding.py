"""What a case with bodies that yield cannot ask for."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from fem_seal.errors import Problem
from fem_seal.plastic_width import curves

if TYPE_CHECKING:
    from fem_seal.case import Case


def yielding_problems(case: Case) -> Iterator[Problem]:
    """What in a case with a stress_strain curve needs bodies that do not remember their loads."""
    if not curves(case):
        return
    bodies = [name for name in ("closure", "seat") if getattr(case, name).material.hardening is not None]
    because = f"a body that yields ({' and '.join(bodies)}: material.stress_strain) remembers its loads"
    remedy = "or leave stress_strain out"
    if case.load.closing == "penetration":
        yield Problem(
            "load.closing",
            f"the fluid's way between the surfaces is solved together with elastic bodies, but {because}; use "
            f'"sealed-area", {remedy}',
            '"penetration"',
        )
    if case.load.target_leak_rate is not None:
        yield Problem(
            "load.target_leak_rate",
            f"the force for it is looked for by trying forces, but {because}, each of the tries, too; list the forces "
            f"in load.axial_force instead, {remedy}",
            f"{case.load.target_leak_rate:.4g} m^3/s",
        )
    if case.uncertainty is not None:
        yield Problem(
            "uncertainty",
            f"the samples solve each load on its own, but {because}; remove the table (a study can vary the inputs: "
            f"it solves the whole path of every design), {remedy}",
        )
