"""Contact through a law that is all but rigid, as where asperities are pressed flat."""

from __future__ import annotations

import math

import numpy as np

from fem_seal.arrays import FloatArray
from fem_seal.contact.laws import InterfaceLaw
from fem_seal.contact.model import ContactModel

_MOST_STEPS = 60


def solve_flattened(
    model: ContactModel,
    law: InterfaceLaw,
    contact_force: float,
    initial_gap: FloatArray,
    start: tuple[FloatArray, float],
    floor: float,
    tolerance: float,
) -> tuple[FloatArray, float, int] | None:
    """Newton's method for ln p at the element ends, between which it is linear; None where it fails.

    As for hard contact, which it becomes for a rigid law, the gap is that of the law in the mean over the function that
    is one at an element end and zero at the others: stable with a quadratic displacement, whatever the law.

    Parameters
    ----------
    model : ContactModel
    law : InterfaceLaw
    contact_force : float
        F_N of contact and stop together [N].
    initial_gap : ndarray, shape (m,)
        Gap of the bodies without contact pressure [m].
    start : tuple
        ln(p/Pa) at the points, shape (m,), and approach [m].
    floor : float
        Added to the decay length of the law [m].
    tolerance : float
        Relative error of p.

    Returns
    -------
    tuple
        ln(p/Pa) at the points, shape (m,), approach [m], and the number of steps.
    """
    line, n_z, hats, stop = model.line, model.line.normal[1], model.line.hats, model.stop
    mean = (line.area_weight[:, None] * hats / (line.area_weight @ hats)).T
    opens, leans = mean @ model.compliance, mean @ n_z
    # not their best approximation, which runs far beyond them where ln p falls steeply at the edge of the contact
    v, d = np.interp(line.vertices, line.x, start[0]), min(start[1], stop)
    for step in range(1, _MOST_STEPS + 1):
        log_p = hats @ v
        with np.errstate(under="ignore"):
            force = line.area_weight * np.exp(log_p)
            of_change = force[:, None] * hats
        separation = law.gap(log_p) - floor * log_p
        lift = line.lift(float(separation[log_p.argmax()]))
        missing_gap = mean @ (separation - initial_gap - lift + d * n_z) - opens @ force
        matrix = opens @ of_change + mean @ ((law.decay_length(log_p) + floor)[:, None] * hats)
        try:
            by_gap, by_approach = np.linalg.solve(matrix, np.array([missing_gap, leans]).T).T
        except np.linalg.LinAlgError:
            return None
        missing_force, force_change = contact_force - float(n_z @ force), n_z @ of_change
        with np.errstate(divide="ignore", invalid="ignore"):  # where nothing carries, no step is finite
            step_d = min(
                float((missing_force - force_change @ by_gap) / (force_change @ by_approach)), stop - d
            )
        change = by_gap + step_d * by_approach
        aim = v + change
        v, d = v + np.where(change > 0, np.log1p(np.maximum(change, 0.0)), change), d + step_d
        if not np.all(np.isfinite(v)):
            return None
        # where next to nothing is carried yet, more may be at once
        least = v.max() + math.log(tolerance)
        v = np.maximum(v, np.minimum(aim, least))
        if np.abs(change[v >= least]).max() < tolerance:
            return hats @ v, d, step
    return None
