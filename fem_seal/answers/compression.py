"""How far a gasket is pressed together under the loads one after the other, and how far it springs back."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import reduce

import numpy as np

from fem_seal.answers.answer import Answer, Request
from fem_seal.answers.case_load import SolvedSeal


@dataclass(frozen=True)
class CompressionStep:
    """Compression at one load.

    Parameters
    ----------
    load_step : int
        Number of the load in the order of the case, from 1 on; without load one more than the last.
    applied_force : float
        [N]
    line_load : float
        f_N of each face [N/m].
    compression : float
        By how much the flanges have come nearer to each other since the mean planes of all faces touched, as warm as
        they are [m]: at small loads it is negative, as the asperities keep them apart.
    stop_force : float or None
        See `LoadResult.stop_force` [N].
    """

    load_step: int
    applied_force: float
    line_load: float
    compression: float
    stop_force: float | None = None


@dataclass(frozen=True)
class Compression:
    """Line load and compression along the loads of a gasket.

    Parameters
    ----------
    steps : tuple of CompressionStep
        One per load, and one without load where bodies yield and what is left is known.
    left : float or None
        Compression without load after the last one [m], the layer of asperities between the faces as thick as under
        that load; None where it is not known.
    stop : float or None
        Compression at which the flanges meet, as warm as they are [m]; None without a stop.
    """

    steps: tuple[CompressionStep, ...]
    left: float | None
    stop: float | None = None

    @property
    def largest_step(self) -> CompressionStep:
        """The load that presses the gasket together most; of several at a stop the largest."""
        return max(self.steps, key=lambda step: (step.compression, step.stop_force or 0.0))

    @property
    def springback(self) -> float | None:
        """By how much the gasket springs back from its largest compression [m]; None where that is not known."""
        return None if self.left is None else self.largest_step.compression - self.left

    def mean(self, other: Compression) -> Compression:
        """Of a gasket one of whose faces is pressed as here and the other as in another compression.

        Parameters
        ----------
        other : Compression
            Under the same loads.
        """
        steps = [
            replace(a, compression=0.5 * (a.compression + b.compression))
            for a, b in zip(self.steps, other.steps, strict=False)  # of one what is left may not be known
        ]
        residual = None if self.left is None or other.left is None else 0.5 * (self.left + other.left)
        return Compression(tuple(steps), residual)


def _compute(seal: SolvedSeal, request: Request) -> Compression:
    first, *others = map(_of_part, seal.parts)
    return reduce(Compression.mean, others, first)


def _of_part(seal: SolvedSeal) -> Compression:
    # the half that is solved comes nearer to one of the faces
    faces, steps = seal.problem.faces, []
    model = seal.loads[-1].contact.model
    stop = None if math.isinf(model.stop) else faces * (model.stop - model.touch)
    for number, load in enumerate(seal.loads, start=1):
        closing = faces * load.contact.face_approach
        steps.append(CompressionStep(number, load.applied_force, load.line_load, closing, load.stop_force))
    last = seal.loads[-1].contact
    layer = faces * float(last.gap[np.argmax(last.pressure)]) / last.model.touch_normal_z
    if not seal.problem.follows_path:
        return Compression(tuple(steps), 0.0, stop)
    if seal.unloaded_bodies is None:
        return Compression(tuple(steps), None, stop)
    residual = faces * seal.unloaded_bodies.closing_approach - layer
    steps.append(CompressionStep(len(seal.loads) + 1, 0.0, 0.0, residual, None if stop is None else 0.0))
    return Compression(tuple(steps), residual, stop)


COMPRESSION = Answer[Compression | None](
    "compression", "compression of the gasket", _compute, None, needs=("case.gasket",)
)
