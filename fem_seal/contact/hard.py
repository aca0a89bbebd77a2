"""Hard unilateral contact (smooth surfaces) on the condensed contact line: primal-dual active set."""

from __future__ import annotations

import numpy as np

from fem_seal.contact.model import BodyLoads, ContactModel
from fem_seal.contact.solution import ContactSolution
from fem_seal.errors import ConvergenceError
from fem_seal.files import problem

_MAX_CHANGES = 100


def solve_hard(model: ContactModel, contact_force: float, loads: BodyLoads | None = None) -> ContactSolution:
    """Solve the contact of smooth bodies, which carries no more than the stop of the model leaves it.

    The pressure is continuous and linear between the element ends, the gap is taken as its weighted mean
    over each of these functions; this pair is stable with a quadratic displacement.

    Raises
    ------
    ConvergenceError
        If the active set does not settle.
    """
    line, loads = model.line, loads or BodyLoads()
    initial_gap = line.initial_gap + loads.opening(model)
    weights = line.area_weight[:, None] * line.hats
    compliance = weights.T @ model.compliance @ weights
    gap0, axial = weights.T @ initial_gap, weights.T @ line.normal[1]
    # A parabolic gap is as high as this where the contact of Hertz ends.
    hertz_gap = 2 * model.line_load(contact_force) / (np.pi * model.effective_modulus)
    distance = gap0 / weights.sum(axis=0)
    active = distance <= max(distance.min() + hertz_gap, np.sort(distance)[2])
    for change in range(1, _MAX_CHANGES + 1):
        ends = np.flatnonzero(active)
        matrix = np.block(
            [[compliance[np.ix_(ends, ends)], -axial[ends, None]], [-axial[None, ends], np.zeros((1, 1))]]
        )
        solution = np.linalg.solve(matrix, np.append(-gap0[ends], -contact_force))
        pressure, approach, carried_force = np.zeros(len(active)), float(solution[-1]), contact_force
        pressure[ends] = solution[:-1]
        if approach > model.stop:
            approach = model.stop
            pressure[ends] = np.linalg.solve(matrix[:-1, :-1], approach * axial[ends] - gap0[ends])
            carried_force = float(axial @ pressure)
        opening = gap0 + compliance @ pressure - approach * axial
        next_active = np.where(active, pressure > 0, opening < 0)
        if np.array_equal(next_active, active):
            p = line.hats @ pressure
            gap = initial_gap - approach * line.normal[1] + model.compliance @ (line.area_weight * p)
            with np.errstate(divide="ignore"):
                log_pressure = np.log(np.maximum(p, 0.0))
            return ContactSolution(
                model,
                carried_force,
                approach,
                log_pressure,
                np.where(p > 0, 0.0, gap),
                change,
                (),
                loads,
                stop_force=contact_force - carried_force,
            )
        active = next_active
    raise ConvergenceError(problem("hard_contact", force=contact_force, changes=_MAX_CHANGES))
