"""Sensitivities of the leak rate: one load solved again with one dimension, material or roughness changed.

Each lever is a finite step, in the direction in which less leaks (of a dimension: upwards), and its local exponent
d ln Q / d ln x. Contacts start from the one that is known; a change of surface takes its own interface law and a short
table of flow conductivities, a change of geometry its own mesh.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property

from fem_seal.answers.answer import Answer, Inquiry, Wanted
from fem_seal.answers.uncertainty import changed_surface, stiffer, stiffer_bodies
from fem_seal.answers.verdict import VERDICT
from fem_seal.case.case import Case
from fem_seal.case.fields import quantities_of
from fem_seal.case.roughness import self_affine_part
from fem_seal.contact.model import ContactModel
from fem_seal.contact.solution import ContactSolution
from fem_seal.errors import SealError
from fem_seal.seal.evaluate import evaluate
from fem_seal.seal.leak_model import Conductivity, FlowModel, LeakModel, log_peaks
from fem_seal.seal.load_result import LoadResult, SolvedSeal, highest_load
from fem_seal.seal.load_solver import LoadSolver, solve_load
from fem_seal.seal.problem import SealProblem, build_mesh, condensed
from leak import LeakError, RoughContact
from meshes import GeometryError, MeshingError

# Relative step of the local exponent of what costs a surface, and of a force.
_SMALL, _SMALL_FORCE = 0.02, 0.01
# The same of a path, whose load steps leave some parts in ten thousand of the width.
_SMALL_PATH = 0.05
# Steps that are told: of the applied force; of heights, hardness, modulus and roll-off; of the Hurst exponent.
_FORCE, _TWICE, _HURST = 1.1, 2.0, 1.1
_LARGEST_HURST = 1.0
# Of lengths the largest round number up to this share; of angles this many.
_OF_LENGTH, _OF_ANGLE = 0.07, math.radians(5.0)
# Dimensions far from the contact, and those that others decide.
_NO_LEVERS = (
    "outer_radius",
    "height",
    "housing_radius",
    "cavity_radius",
    "stem_radius",
    "face_radius",
    "recess",
)
_MOST_DIMENSIONS = 3
# Range and points of the table of a changed surface: resistance further down is below 1e-4 of the whole.
_DECADES, _ABOVE, _POINTS = 2.0, 0.05, 16
_FAILURES = (SealError, LeakError, GeometryError, MeshingError, ValueError, ArithmeticError)

Rates = tuple[float, ...]


@dataclass(frozen=True)
class Lever:
    """One thing that can be changed, and what it does.

    Parameters
    ----------
    key : str
        "force", "rms_height", "hurst", "q_rolloff", "hardness", "youngs_modulus", or a dimension such as
        "closure.radius".
    before, after : float or None
        Value, SI; None of what is only scaled.
    factor : float
        Value after the step over that before.
    ratio : tuple of float
        Leak rate after over before in both readings of yielding asperities, volume conserved and changed only where it
        touches, or twice in the only one; zero where the step seals.
    exponents : tuple of float
        Local d ln Q / d ln x of the same readings; NaN where one does not leak on either side of a small step.
    """

    key: str
    before: float | None
    after: float | None
    factor: float
    ratio: tuple[float, float]
    exponents: tuple[float, float]

    @property
    def strength(self) -> float:
        """|ln| of the ratio in the reading that it moves less, by which levers are put in order.

        Infinite where the step seals, zero where the readings contradict each other.
        """
        logs = [math.log(one) if one > 0 else -math.inf for one in self.ratio]
        return min(map(abs, logs)) if logs[0] * logs[1] > 0 else 0.0

    @property
    def straight(self) -> bool:
        """Whether the exponents foretell the ratio to within a fifth of its logarithm."""
        if any(map(math.isnan, self.exponents)) or min(self.ratio) <= 0:
            return False
        told = [one * math.log(self.factor) for one in self.exponents]
        return all(
            abs(math.log(one) - end) <= max(0.2 * abs(end), 0.02)
            for one, end in zip(self.ratio, told, strict=True)
        )


def levers(result: SolvedSeal, number: int | None = None) -> tuple[Lever, ...]:
    """Levers of a result at one load, the strongest first.

    Parameters
    ----------
    result : SolvedSeal
        Where a body yields every step takes the path of loads once more.
    number : int, optional
        Of the load; the one with the highest fluid pressure unless given.

    Returns
    -------
    tuple of Lever
        Empty where nothing leaks, the seal is open, or there is no leak rate.
    """
    number = highest_load(result.loads) if number is None else number
    bench = _Bench(result, result.loads[number], number)
    if not bench.usable:
        return ()
    found = [*bench.force(), *bench.surface_levers(), *bench.dimensions()]
    return tuple(sorted(found, key=lambda one: -one.strength))


def _short_table(peaks: Sequence[float], flow: FlowModel, surface: RoughContact) -> Conductivity:
    low, high = min(peaks) - _DECADES, max(peaks) + _ABOVE
    points = _POINTS + math.ceil(8 * (max(peaks) - min(peaks)))
    return flow.table(surface, 10.0**low, 10.0**high, points)


@dataclass(frozen=True)
class _Bench:
    """A load whose inputs can be exchanged one by one."""

    result: SolvedSeal
    load: LoadResult
    number: int

    @property
    def problem(self) -> SealProblem:
        return self.result.problem

    @property
    def case(self) -> Case:
        return self.result.case

    @cached_property
    def rates(self) -> Rates:
        return _rates(self.load)

    @property
    def usable(self) -> bool:
        return self.problem.leaks and all(0 < rate < math.inf for rate in self.rates) and bool(self.rates)

    def solved(
        self, problem: SealProblem, model: ContactModel, force: float, start: ContactSolution | None
    ) -> LoadResult:
        """The load on another problem or model; its own table of conductivities as long as it will do."""
        if self.problem.curves:
            points = (*problem.loads.points[: self.number], (self.load.fluid_pressure, force))
            path = replace(problem, loads=replace(problem.loads, points=points))
            contact = solve_load(LoadSolver(path, model), self.number)
        else:
            contact = LoadSolver(problem, model).solve(self.load.fluid_pressure, force, start=start)
        bare = LoadResult(self.load.fluid_pressure, force, contact, formed=problem.around(contact))
        peaks = log_peaks(bare.contacts)
        surface, rough = problem.surface, self.load.rough
        assert surface is not None  # of `usable`
        # the tables of the load go on to the next decade
        reached = max(log_peaks(self.load.contacts)) + 0.25
        if surface is not self.problem.surface or max(peaks) > reached:
            rough = LeakModel(surface, problem.flow, lambda flow, of: _short_table(peaks, flow, of))
        return bare.with_values(rough=rough)

    def lever(
        self,
        key: str,
        solved: Callable[[float], LoadResult],
        small: float,
        large: float,
        value: float | None = None,
    ) -> Iterator[Lever]:
        """The lever of a factor: a small step up says which way, and a large one how far."""
        small = max(small, _SMALL_PATH) if self.problem.curves else small
        with suppress(*_FAILURES):
            near = _rates(solved(1.0 + small))
            if len(near) != len(self.rates):
                return
            factor = large if sum(near) < sum(self.rates) else 1.0 / large
            ratio = _ratio(self.rates, _rates(solved(factor)))
            after = None if value is None else value * factor
            yield Lever(key, value, after, factor, ratio, _exponents(self.rates, near, 1.0 + small))

    def force(self) -> list[Lever]:
        """More force of spring or actuator: a tenth of it or, where there is none, of the contact force."""
        applied = self.load.applied_force
        own = applied > 0
        unit = applied if own else self.load.contact_force

        def solved(factor: float) -> LoadResult:
            force = applied + (factor - 1.0) * unit
            return self.solved(self.problem, self.result.model, force, self.load.contact)

        return [
            replace(one, before=applied, after=applied + (one.factor - 1.0) * unit)
            for one in self.lever("force", solved, _SMALL_FORCE, _FORCE)
        ]

    def surface_levers(self) -> list[Lever]:
        """Heights, hardness, modulus and, of a self-affine spectrum, its shape."""
        if self.problem.flow is None or self.problem.flow.simulated is not None:
            return []
        surface, roughness = self.problem.surface, self.case.roughness
        assert surface is not None  # of `usable`
        steps = {"rms_height": _TWICE, "youngs_modulus": _TWICE}
        if surface.hardness is not None:
            steps["hardness"] = _TWICE
        values: dict[str, float | None] = {
            # of a drawing the height that it gives is halved, and not the rms height of the gap
            "rms_height": None if self._drawn else surface.spectrum.rms_height,
            "hardness": surface.hardness,
        }
        part = self_affine_part(roughness)
        if part is not None and roughness is not None:
            given = roughness.parts[part]
            values |= {key: getattr(given, key, None) for key in ("hurst", "q_rolloff")}
            steps |= {"hurst": _HURST, "q_rolloff": _TWICE}
        return [
            lever
            for key, large in steps.items()
            for lever in self.lever(key, self._with_surface(key), _SMALL, large, values.get(key))
            if not (key == "hurst" and lever.after is not None and lever.after > _LARGEST_HURST)
        ]

    def _with_surface(self, key: str) -> Callable[[float], LoadResult]:
        def solved(factor: float) -> LoadResult:
            surface, stiffness = self._changed(key, factor), factor if key == "youngs_modulus" else 1.0
            problem, model = replace(self.problem, surface=surface), self.result.model
            if stiffness != 1.0 and self.problem.curves:
                problem = replace(problem, materials=stiffer_bodies(problem.materials, stiffness))
                model = condensed(problem, self.result.seal_mesh)
            else:
                model = stiffer(model, stiffness)
            return self.solved(problem, model, self.load.applied_force, self.load.contact)

        return solved

    @property
    def _drawn(self) -> dict[str, float]:
        """Heights that a drawing gives [m], by their key in the case; none unless all the roughness is from it."""
        roughness = self.case.roughness
        if roughness is None or len(roughness.finishes) < len(roughness.parts):
            return {}
        if roughness.height is not None:
            return {f"roughness.{roughness.height}": getattr(roughness, roughness.height)}
        return {
            f"roughness.{face}.{one.height}": getattr(one, one.height)
            for face, one in roughness.finishes.items()
            if one.height is not None
        }

    def _changed(self, key: str, factor: float) -> RoughContact:
        """The surface with one input changed.

        Half of a drawing's value may be measured with another filter, and stand for other waves. A small change of it
        is one of heights alone: the filters change in steps.
        """
        surface, drawn = self.problem.surface, self._drawn
        assert surface is not None  # of `usable`
        if key != "rms_height" or factor != 1.0 / _TWICE or not drawn:
            return changed_surface(self.case, surface, {key: factor})
        halved = self.case.replace({path: factor * value for path, value in drawn.items()})
        assert halved.roughness is not None
        spectrum, peklenik = halved.roughness.combined()
        return replace(surface, spectrum=spectrum, peklenik=peklenik)

    def dimensions(self) -> list[Lever]:
        """Lengths and angles at the contact that the case gives, each with a mesh of its own."""
        found = []
        for paths, value, step in self._dimensions():
            with suppress(*_FAILURES):
                after = value + step
                far = _rates(self._with_dimensions(dict.fromkeys(paths, after)))
                if len(far) == len(self.rates):
                    effect = _ratio(self.rates, far), _exponents(self.rates, far, after / value)
                    found.append(Lever(" and ".join(paths), value, after, after / value, *effect))
        return found

    def _dimensions(self) -> Iterator[tuple[tuple[str, ...], float, float]]:
        """Keys that are changed together, their value and the step."""
        listed: dict[str, tuple[float, float]] = {}
        for body in ("closure", "seat"):
            table = getattr(self.case, body)
            for key in table.model_fields_set - set(_NO_LEVERS):
                marker = next(quantities_of(type(table).model_fields[key]), None)
                value = getattr(table, key)
                if marker is None or not value:
                    continue
                if marker.dimension == "angle":
                    listed[f"{body}.{key}"] = (value, _OF_ANGLE)
                elif key != "interference":
                    listed[f"{body}.{key}"] = (value, _round_step(value))
        both = [listed.get(f"{body}.angle") for body in ("closure", "seat")]
        if all(both):
            # faces that fit each other are turned together
            value, step = listed.pop("closure.angle")
            yield ("closure.angle", "seat.angle"), value, step
            listed.pop("seat.angle")
        order = sorted(listed, key=lambda path: (path.endswith(("edge_radius", "relief_angle")), path))
        for path in order[:_MOST_DIMENSIONS]:
            yield (path,), *listed[path]

    def _with_dimensions(self, entries: dict[str, float]) -> LoadResult:
        points = self.problem.loads.points[: self.number] if self.problem.curves else ()
        pressures, forces = zip(*points, self.load.point, strict=True)
        of_load = {"load.fluid_pressure": list(pressures), "load.applied_force": list(forces)}
        case = self.case.replace({**of_load, "requirement": None, **entries})
        size = self.result.seal_mesh.sizing.contact_size
        problem = replace(SealProblem.of(case), surface=self.problem.surface, contact_size=size)
        if self.problem.curves:
            model, start = condensed(problem, build_mesh(problem)), None
        else:
            evaluated = evaluate(problem)
            model, start = evaluated.model, evaluated.solved.contacts[0]
        return self.solved(problem, model, self.load.applied_force, start)


def _round_step(length: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is no more than a small share of a length [m].

    Examples
    --------
    >>> _round_step(0.02), _round_step(0.005)
    (0.001, 0.0002)
    """
    wanted = _OF_LENGTH * length
    power = 10.0 ** math.floor(math.log10(wanted) + 1e-9)
    return max(first * power for first in (1, 2, 5) if first * power <= wanted * (1 + 1e-9))


def _rates(load: LoadResult) -> Rates:
    """Leak rate in each reading of yielding asperities, or the only one [m^3/s]."""
    found = (load.leak, *(one.leak for one in load.others.values()))
    return tuple(leak.leak_rate for leak in found if leak is not None)


def _ratio(before: Rates, after: Rates) -> tuple[float, float]:
    ratios = [far / near for near, far in zip(before, after, strict=True)]
    return ratios[0], ratios[-1]


def _exponents(before: Rates, after: Rates, factor: float) -> tuple[float, float]:
    """d ln Q / d ln x of the readings; NaN where one does not leak or is open."""
    if not all(0 < rate < math.inf for rate in (*before, *after)):
        return math.nan, math.nan
    found = [math.log(far / near) / math.log(factor) for near, far in zip(before, after, strict=True)]
    return found[0], found[-1]


def _compute(seal: SolvedSeal, ask: Inquiry) -> tuple[Lever, ...]:
    judged = VERDICT.of(ask.answers).seal
    return levers(seal, None if judged is None else judged.number)


def _applies(seal: SolvedSeal, wanted: Wanted) -> bool:
    # of a path of loads they take as long as a dozen paths: only if they are asked for
    unasked = seal.case.requirement is not None and not seal.problem.curves
    return unasked if wanted.levers is None else wanted.levers


LEVERS = Answer[tuple[Lever, ...]](
    "levers", "levers on the leak rate", _compute, (), _applies, doing="what changes the leak rate most"
)
