"""Sensitivities of the leak rate: one load calculated again with one thing changed, all else as it is.

Each is a finite step: what a drawing or an order can change, and the numbers of a surface that stand behind them. The
changed case goes the way of every case, with bodies and tables shared as those of a study, so that its leak rate is
that of a complete run.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import chain

from fem_seal.answers.answer import Answer, Request, loads_of
from fem_seal.answers.case_load import CaseLoad, SolvedSeal
from fem_seal.answers.samples import changed_problem
from fem_seal.answers.verdict import VERDICT
from fem_seal.case.case import Case, CaseBody
from fem_seal.case.fields import quantities_of
from fem_seal.case.material_table import library_table
from fem_seal.case.roughness import FineRoughness, TurnedFace, self_affine_part
from fem_seal.errors import SealError
from fem_seal.processes import can_copy, fork_map
from fem_seal.seal.evaluate import Batch, Evaluation, evaluate_many, evaluate_seal
from fem_seal.seal.leak_model import FlowModel
from fem_seal.seal.load_result import highest_load
from fem_seal.seal.problem import SealProblem, problems_of, under_loads
from fem_seal.seal.sources import SharedBodies, Source
from fem_seal.validity.checks import validity_of
from leak import LeakError, TurnedContact
from meshes import GeometryError, MeshingError

# Relative step of the local exponent of what costs a surface, and of a force.
_SMALL_STEP, _SMALL_FORCE = 0.02, 0.01
# The same of a path, whose load steps leave some parts in ten thousand of the width.
_SMALL_PATH = 0.05
# The same of turned crests, of which levels of the flat leave some per cent of the leak rate.
_SMALL_CREST = 0.1
# Steps that are told: of the applied force; of heights, hardness, modulus and roll-off; of the Hurst exponent.
_FORCE, _TWO, _HURST = 1.1, 2.0, 1.1
_LARGEST_HURST = 1.0
# Of lengths the largest round number up to this share; of angles this many.
_OF_LENGTH, _OF_ANGLE = 0.07, math.radians(5.0)
# Dimensions at the contact, of all shapes; the others are far from it, or follow from these.
_AT_CONTACT = {
    "closure": {
        "angle",
        "radius",
        "centre_radius",
        "mean_radius",
        "inner_radius",
        "outer_radius",
        "edge_radius",
    },
    "seat": {
        *("angle", "contact_angle", "top_angle", "relief_angle", "stop"),
        *("radius", "centre_radius", "land_radius", "land_inner_radius", "land_outer_radius", "bore_radius"),
        *("land_width", "edge_radius", "mean_radius", "section_radius", "spherical_radius"),
    },
}
# Those that a drawing has even where the case leaves them open.
_DRAWN_KEYS = {"land_width", "edge_radius"}
# Both edges of a ring, and what they are changed as: its middle, its width.
_RINGS = {
    ("closure", "inner_radius", "outer_radius"): ("mean_radius", "face_width"),
    ("seat", "land_inner_radius", "land_outer_radius"): ("land_radius", "land_width"),
}
# What seats and closures are made of instead: soft and hard, stiff and compliant.
_MATERIALS = ("316L", "stellite 6", "aluminium bronze C95400")
# What no drawing and no order says.
_NOT_DRAWN = ("youngs_modulus", "q_rolloff", "hurst")
# Largest ratio of leak rates that is told as less, and the ratio up to which it is the same.
_CUTS, _SAME = 0.97, 1.001
_STATUS = "what changes the leak rate most"
_FAILURES = (SealError, LeakError, GeometryError, MeshingError, ValueError, ArithmeticError)

# Changes that are evaluated side by side.
_AT_ONCE = 4

Rates = tuple[float, ...]
# Of one seal, see `problems_of`.
Problems = tuple[SealProblem, ...]


@dataclass(frozen=True)
class Sensitivity:
    """One thing that can be changed, and what that does to the leak rate.

    Parameters
    ----------
    key : str
        "force", "rms_height", "form", "hardness", "youngs_modulus", "hurst", "q_rolloff", the path of a finish such as
        "roughness.seat.Ra", of a turned face such as "roughness.seat.feed", of a dimension such as "closure.radius", or
        of a material.
    before, after : float or None
        Value, SI; None of what is only scaled.
    factor : float
        Value after the step over that before; NaN of a material.
    ratio : tuple of float
        Leak rate after over before in both readings of yielding asperities, volume conserved and changed only where it
        touches, or twice in the only one; zero where the step seals.
    exponents : tuple of float
        Local d ln Q / d ln x of the same readings; NaN where one does not leak on either side of a small step.
    material : str
        Name of the other material; empty of all else.
    drawn : bool
        Whether a drawing or an order can say it: not modulus and spectrum, nor the hardness of an alloy that has one,
        nor a height that is not usual for its process.
    helps : bool or None
        Whether no load that is judged leaks more for it or leaves the theory for it; None where nobody has looked.
    """

    key: str
    before: float | None
    after: float | None
    factor: float
    ratio: tuple[float, float]
    exponents: tuple[float, float]
    material: str = ""
    drawn: bool = True
    helps: bool | None = None

    @property
    def strength(self) -> float:
        """|ln| of the ratio in the reading that it moves less, by which sensitivities are put in order.

        Infinite where the step seals, zero where the readings contradict each other.
        """
        logs = [math.log(ratio) if ratio > 0 else -math.inf for ratio in self.ratio]
        return min(map(abs, logs)) if logs[0] * logs[1] > 0 else 0.0

    @property
    def straight(self) -> bool:
        """Whether the exponents foretell the ratio to within a fifth of its logarithm."""
        if any(map(math.isnan, self.exponents)) or min(self.ratio) <= 0:
            return False
        logs = [exponent * math.log(self.factor) for exponent in self.exponents]
        return all(
            abs(math.log(ratio) - end) <= max(0.2 * abs(end), 0.02)
            for ratio, end in zip(self.ratio, logs, strict=True)
        )


def sensitivities(
    result: SolvedSeal,
    number: int | None = None,
    progress: Callable[[str], None] | None = None,
    load_numbers: Collection[int] = (),
) -> tuple[Sensitivity, ...]:
    """Sensitivities of a result at one load, the strongest first.

    Parameters
    ----------
    result : SolvedSeal
        Where a body yields every step takes the path of loads once more.
    number : int, optional
        Of the load; the one with the highest fluid pressure unless given.
    progress : callable, optional
        Told before each where they are calculated one after the other, in a process that cannot be copied.
    load_numbers : collection of int
        Numbers of the loads at which the strongest one that cuts the leak must help.

    Returns
    -------
    tuple of Sensitivity
        Empty where nothing leaks, the seal is open, or there is no leak rate.
    """
    number = highest_load(result.loads) if number is None else number
    changed_seal = _ChangedSeal(result, (number,))
    if not changed_seal.leaks:
        return ()

    tell = progress if progress is not None and not can_copy() else lambda text: None

    def evaluate(changes: Sequence[_Change]) -> list[Sensitivity | None]:
        tell(_STATUS)
        return changed_seal.sensitivities(changes)

    changes = list(changed_seal.changes())
    parts = [changes[first : first + _AT_ONCE] for first in range(0, len(changes), _AT_ONCE)]
    levers = sorted(filter(None, chain.from_iterable(fork_map(evaluate, parts))), key=lambda x: -x.strength)
    at_all_loads = _ChangedSeal(result, (*(n for n in load_numbers if n != number), number))
    for place, lever in enumerate(levers):
        if lever.drawn and lever.strength > 0.0 and max(lever.ratio) <= _CUTS:
            tell(_STATUS)
            levers[place] = lever = replace(lever, helps=at_all_loads.helps(lever))
            if lever.helps:
                break
    return tuple(levers)


@dataclass(frozen=True, eq=False)
class _Change:
    """One thing that is changed.

    Parameters
    ----------
    key : str
    step : float
        Factor that is told; one over it where less leaks then. NaN of what has none.
    problems : callable
        The problems of the seal with a factor on its value.
    small : float
        Relative step up of the local exponent, which says the direction as well; zero: there is only the one step.
    before : float, optional
        Value [SI].
    of : float, optional
        What the factor is of [SI]; `before` unless given.
    material : str
    """

    key: str
    step: float
    problems: Callable[[float], Problems]
    small: float = 0.0
    before: float | None = None
    of: float | None = None
    material: str = ""

    def value_after(self, factor: float) -> float | None:
        """Value after a step [SI]."""
        if self.before is None:
            return None
        return self.before + (factor - 1.0) * (self.before if self.of is None else self.of)


@dataclass(frozen=True)
class _ChangedSeal:
    """A seal up to some loads, and what it would be with other inputs.

    Parameters
    ----------
    result : SolvedSeal
    numbers : tuple of int
        Of the loads; sensitivities are those at the last one.
    """

    result: SolvedSeal
    numbers: tuple[int, ...]

    @property
    def number(self) -> int:
        """Of the load at which the leak rate is changed."""
        return self.numbers[-1]

    @cached_property
    def source(self) -> Source:
        return SharedBodies(tables=FlowModel.short_table)

    @cached_property
    def case(self) -> Case:
        # another bore may have another limit of its class, which nobody asks for here
        return self.result.case.replace({"requirement": None})

    @cached_property
    def problems(self) -> Problems:
        return self._at_load(problems_of(self.case))

    @property
    def problem(self) -> SealProblem:
        """Of several the first one, whose inputs are told."""
        return self.problems[0]

    @cached_property
    def rates(self) -> Rates:
        """Of the case itself, from the source that its changes share."""
        return self._rates(self.problems, evaluate_seal(self.problems, self.source))

    @property
    def leaks(self) -> bool:
        leak = self.result.loads[self.number].leak if self.result.problem.leaks else None
        if leak is None or not 0 < leak.leak_rate < math.inf:
            return False
        return bool(self.rates) and all(0 < rate < math.inf for rate in self.rates)

    def _at_load(self, problems: Problems, more_force: float = 0.0) -> Problems:
        """Problems with the loads in question, after those that have a say in them."""
        base, forces = self.result.problem.loads.points, dict.fromkeys(self.numbers, more_force)
        points = tuple((base[n][0], base[n][1] + forces.get(n, 0.0)) for n in self._order(problems[0]))
        # bolts keep the force that they have at this load
        loads = replace(problems[0].loads, points=points, refusals={}, target_leak_rate=None)
        return under_loads(problems, replace(loads, bolts_solved=True, preloads=()))

    def _order(self, problem: SealProblem) -> tuple[int, ...]:
        """Numbers of the loads that are solved, those in question at the end.

        Bodies that yield remember the loads before them; a tolerance is filled as at the highest of all.
        """
        if problem.follows_path:
            return tuple(range(max(self.numbers) + 1))
        highest = highest_load(self.result.loads)
        fills = problem.form is not None and problem.form.tolerance is not None
        return (highest, *self.numbers) if fills and highest not in self.numbers else self.numbers

    def helps(self, lever: Sensitivity) -> bool:
        """Whether no load in question leaks more for a change or leaves the theory for it.

        Parameters
        ----------
        lever : Sensitivity
        """
        same = (lever.key, lever.material)
        change = next(change for change in self.changes() if (change.key, change.material) == same)
        with suppress(*_FAILURES):
            problems = change.problems(lever.factor)
            evaluations = evaluate_seal(problems, SharedBodies(tables=FlowModel.short_table, stress=True))
            load_problems = evaluations[0].solved_loads.problems
            numbers = [n for at, n in enumerate(self._order(problems[0])) if at not in load_problems]
            loads = dict(zip(numbers, loads_of(evaluations), strict=True))
            return all(
                n in loads and self._better(evaluations, loads[n], self.result.loads[n]) for n in self.numbers
            )
        return False

    def _better(self, evaluations: Sequence[Evaluation], load: CaseLoad, load_before: CaseLoad) -> bool:
        rates = zip(_rates_of(load), _rates_of(load_before), strict=True)
        leaks_more = any(not new <= old * _SAME for new, old in rates)
        return not leaks_more and (
            load_before.validity.outside_theory
            or not load.validity_by(validity_of, evaluations).outside_theory
        )

    def _rates(self, problems: Problems, evaluations: Sequence[Evaluation]) -> Rates:
        """Leak rate in each reading of yielding asperities, or the only one [m^3/s]; none without a contact."""
        load = loads_of(evaluations)[-1]
        return _rates_of(load) if load.point == problems[0].loads.points[-1] else ()

    def sensitivities(self, changes: Sequence[_Change]) -> list[Sensitivity | None]:
        """What each of several changes does, evaluated side by side; None where it is none or cannot be calculated.

        A dimension whose larger value opens the seal is made smaller.
        """
        smallest = _SMALL_PATH if self.problem.follows_path else 0.0
        if isinstance(self.problem.surface, TurnedContact):
            smallest = _SMALL_CREST
        steps = [change.small and max(change.small, smallest) for change in changes]
        near_rates = self._rates_after(
            {change: 1.0 + step for change, step in zip(changes, steps, strict=True) if step}
        )
        near_rates = {change: near_rates.get(change, self.rates) for change in changes}
        factors = {
            change: 1.0 / change.step if sum(near_rates[change]) > sum(self.rates) else change.step
            for change in changes
        }
        far_rates = self._rates_after(factors)
        smaller = {
            change: 2.0 - factors[change]
            for change, step in zip(changes, steps, strict=True)
            if not far_rates[change] and not step and factors[change] > 1
        }
        factors |= smaller
        far_rates |= self._rates_after(smaller)
        return [
            self._sensitivity(change, step, near_rates[change], factors[change], far_rates[change])
            for change, step in zip(changes, steps, strict=True)
        ]

    def _sensitivity(
        self, change: _Change, step: float, near_rates: Rates, factor: float, far_rates: Rates
    ) -> Sensitivity | None:
        """From the leak rates after a small step up and after the step that is told."""
        value = change.value_after(factor)
        if not len(near_rates) == len(far_rates) == len(self.rates) or (
            change.key == "hurst" and value is not None and value > _LARGEST_HURST
        ):
            return None
        ratios = [new / old for old, new in zip(self.rates, far_rates, strict=True)]
        exponents = _exponents(self.rates, *((near_rates, 1.0 + step) if step else (far_rates, factor)))
        return Sensitivity(
            change.key,
            change.before,
            value,
            factor,
            (ratios[0], ratios[-1]),
            exponents,
            change.material,
            drawn=self._can_be_drawn(change, factor),
        )

    def _can_be_drawn(self, change: _Change, factor: float) -> bool:
        if change.key.rpartition(".")[2] in self._not_drawn:
            return False
        finish = change.key.startswith("roughness.") or (change.key == "rms_height" and self._drawn)
        # remarks are about heights that are not usual for their process
        return not (finish and change.problems(factor)[0].origin.remarks)

    @property
    def _not_drawn(self) -> tuple[str, ...]:
        """Keys of what nobody can order; an alloy of the library, as the softer body, has its hardness."""
        materials = (self.result.case.closure.material, self.result.case.lower.material)
        softer = min(materials, key=lambda material: material.hardness or math.inf)
        return (*_NOT_DRAWN, "hardness") if "hardness" in library_table(softer.name) else _NOT_DRAWN

    def _rates_after(self, factors: Mapping[_Change, float]) -> dict[_Change, Rates]:
        """Leak rates after each of some changes by a factor; none where they cannot be calculated."""
        changes, batch = list(factors), Batch()
        problems = batch.map(range(len(changes)), lambda n: changes[n].problems(factors[changes[n]]))
        sources = {n: (self.source,) * len(each) for n, each in problems.items()}
        evaluations = evaluate_many(problems, sources, batch)
        rates = batch.map(evaluations, lambda n: self._rates(problems[n], evaluations[n]))
        for error in batch.failed.values():
            if not isinstance(error, _FAILURES):
                raise error
        return {change: rates.get(n, ()) for n, change in enumerate(changes)}

    def changes(self) -> Iterator[_Change]:
        """All that can be changed."""
        yield self._force()
        yield from self._surface()
        if self.problem.form is not None and (self.problem.form.waves or self.problem.form.tolerance):
            yield _Change("form", 1.0 / _TWO, partial(self._with_surface, "form"))
        yield from self._dimensions()
        yield from self._materials()

    def _force(self) -> _Change:
        """More force of spring or actuator: a tenth of it or, where there is none, of the contact force."""
        load = self.result.loads[self.number]
        force = load.applied_force
        unit = force if force > 0 else load.contact_force

        def problems(factor: float) -> Problems:
            return self._at_load(self.problems, (factor - 1.0) * unit)

        return _Change("force", _FORCE, problems, _SMALL_FORCE, force, unit)

    def _surface(self) -> Iterator[_Change]:
        """Heights, hardness, modulus and, of a self-affine spectrum, its shape; none of a simulated surface."""
        surface, roughness = self.problem.surface, self.case.roughness
        assert surface is not None and roughness is not None and self.problem.flow is not None  # of `leaks`
        if self.problem.flow.direct is not None:
            return
        # of a drawing the heights that it gives are halved, and not the rms height of the gap
        heights = self._drawn
        steps: dict[str, tuple[float, float | None]] = {
            "rms_height": (
                _TWO,
                None if heights or len(self.case.contacts) > 1 else surface.spectrum.rms_height,
            ),
            "youngs_modulus": (_TWO, None),
        }
        if surface.hardness is not None:
            steps["hardness"] = _TWO, surface.hardness
        part = self_affine_part(roughness)
        if part is not None:
            spectrum = roughness.parts[part]
            steps["hurst"] = _HURST, getattr(spectrum, "hurst", None)
            steps["q_rolloff"] = _TWO, getattr(spectrum, "q_rolloff", None)
        for key, (step, value) in steps.items():
            yield _Change(key, step, partial(self._with_surface, key), _SMALL_STEP, value)
        yield from self._cusps()
        for path, value in heights.items() if len(heights) > 1 else ():
            yield _Change(path, 1.0 / _TWO, partial(self._with_entries, {path: value}, value), before=value)

    def _cusps(self) -> Iterator[_Change]:
        """Feed and nose radius of turned faces, and the shape of the fine roughness on their crests."""
        roughness = self.case.roughness
        assert roughness is not None  # of `leaks`
        faces = roughness.turned_faces
        if roughness.feed is not None:
            # of both
            faces = {"": faces["seat"]}
        for key, face in faces.items():
            if not isinstance(face, TurnedFace):
                continue
            steps = {"feed": (_TWO, face.feed), "nose_radius": (_TWO, face.nose_radius)}
            if isinstance(face.fine, FineRoughness):
                steps["fine.hurst"] = _HURST, face.fine.hurst
                steps["fine.q_rolloff"] = _TWO, face.fine.q_rolloff
            for name, (step, value) in steps.items():
                path = f"roughness.{key}.{name}"
                yield _Change(
                    path, step, partial(self._with_entries, {path: value}, value), _SMALL_STEP, value
                )

    @property
    def _drawn(self) -> dict[str, float]:
        """Heights that a drawing gives [m], by their key in the case; none unless all the roughness is from it."""
        roughness = self.case.roughness
        rough = [part.roughness for part in self.case.parts if part.roughness]
        if not rough or any(len(table.finishes) < len(table.parts) for table in rough):
            return {}
        if roughness is not None and roughness.height is not None:
            return {f"roughness.{roughness.height}": roughness.finish.value}
        return {
            f"roughness.{face}.{table.height}": table.finish.value
            for face, table in self.case.finishes.items()
            if table.height is not None
        }

    @property
    def _bodies(self) -> list[CaseBody]:
        """Those with a table of their own: a lower flange without has shape and material of [closure]."""
        return [body for body in self.case.every_body if body.key in self.case.written]

    def _with_surface(self, key: str, factor: float) -> Problems:
        """The problems with one input of their surfaces changed.

        Half of a drawing's value may be measured with another filter, and stand for other waves. A small change of it
        is one of heights alone: the filters change in steps.
        """
        if key == "rms_height" and factor == 1.0 / _TWO and self._drawn:
            heights = {path: factor * value for path, value in self._drawn.items()}
            return self._at_load(problems_of(self.case.replace(heights)))
        parts = zip(self.problems, self.case.parts, strict=True)
        return tuple(changed_problem(problem, part, {key: factor}) for problem, part in parts)

    def _with_entries(self, entries: Mapping[str, float], of: float, factor: float) -> Problems:
        """The problems with some numbers of the case larger by the same: a factor on one of them, or between two."""
        change = (factor - 1.0) * of
        return self._at_load(
            problems_of(self.case.replace({path: value + change for path, value in entries.items()}))
        )

    def _dimensions(self) -> Iterator[_Change]:
        """Lengths and angles at the contact."""
        lengths, angles = dict[str, float](), dict[str, float]()
        for path, kind, value in self._at_contact():
            (angles if kind == "angle" else lengths)[path] = value

        pair = {path: value for path, value in angles.items() if path.endswith(".angle")}
        difference = max(pair.values(), default=0.0) - min(pair.values(), default=0.0)

        def change(key: str, entries: Mapping[str, float], of: float) -> _Change:
            # faces that nearly fit are made with a small difference, and stay a pair
            of_angle = 0.5 * difference if key in pair and 0.0 < difference < _OF_ANGLE else _OF_ANGLE
            step = of_angle if key.endswith("angle") else _round_step(of)
            return _Change(key, 1.0 + step / of, partial(self._with_entries, entries, of), before=of)

        if len(pair) > 1 and difference == 0.0:
            # faces that fit each other are turned together
            yield change(" and ".join(pair), pair, next(iter(pair.values())))
            angles = {path: value for path, value in angles.items() if path not in pair}
        for (body, *keys), (middle, width) in _RINGS.items():
            edges = {path: lengths[path] for key in keys if (path := f"{body}.{key}") in lengths}
            if len(edges) == 2:
                inner, outer = edges.values()
                yield change(f"{body}.{middle}", edges, 0.5 * (inner + outer))
                yield change(f"{body}.{width}", {f"{body}.{keys[1]}": outer}, outer - inner)
                lengths = {path: value for path, value in lengths.items() if path not in edges}
        for path, value in {**lengths, **angles}.items():
            yield change(path, {path: value}, value)

    def _at_contact(self) -> Iterator[tuple[str, str, float]]:
        """Path, kind and value of each dimension at the contact that a drawing has."""
        for body in self._bodies:
            for key, entry in type(body.table).model_fields.items():
                marker = next(quantities_of(entry), None)
                if marker is None or key not in _AT_CONTACT[body.name]:
                    continue
                number = getattr(body.table, key)
                value = getattr(body.shape, key, None) if number is None and key in _DRAWN_KEYS else number
                if value:
                    yield f"{body.key}.{key}", marker.dimension, value

    def _materials(self) -> Iterator[_Change]:
        """Another material of closure or seat; not where the body yields, whose curve nobody knows of the other."""
        assert self.problem.flow is not None  # of `leaks`
        # those of the contact at its temperature
        bodies = {body.key: body.table.material for body in self._bodies}
        bodies |= {self.case.key_of(name): material for name, material in self.problem.materials.items()}
        for body, material in bodies.items():
            if material.hardening is not None or self.problem.flow.direct is not None:
                continue
            for name in _MATERIALS:
                if name != material.name:
                    yield _Change(
                        f"{body}.material", math.nan, partial(self._with_material, body, name), material=name
                    )

    def _with_material(self, body: str, name: str, factor: float) -> Problems:
        return self._at_load(problems_of(self.case.replace({f"{body}.material": name})))


def _rates_of(load: CaseLoad) -> Rates:
    """Leak rate of a load in each of its readings [m^3/s]."""
    leaks = (load.leak, *(scenario.leak for scenario in load.others.values()))
    return tuple(leak.leak_rate for leak in leaks if leak is not None)


def _round_step(length: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is no more than a small share of a length [m].

    Examples
    --------
    >>> _round_step(0.02), _round_step(0.005)
    (0.001, 0.0002)
    """
    limit = _OF_LENGTH * length
    power = 10.0 ** math.floor(math.log10(limit) + 1e-9)
    return max(first * power for first in (1, 2, 5) if first * power <= limit * (1 + 1e-9))


def _exponents(start: Rates, end: Rates, factor: float) -> tuple[float, float]:
    """d ln Q / d ln x of the readings; NaN where one does not leak or is open."""
    if not all(0 < rate < math.inf for rate in (*start, *end)):
        return math.nan, math.nan
    slopes = [math.log(new / old) / math.log(factor) for old, new in zip(start, end, strict=True)]
    return slopes[0], slopes[-1]


def _compute(seal: SolvedSeal, request: Request) -> tuple[Sensitivity, ...]:
    verdict = VERDICT.of(request.answers).seal
    if verdict is None:
        return sensitivities(seal, None, request.clock.progress, range(len(seal.loads)))
    return sensitivities(seal, verdict.number, request.clock.progress, verdict.load_numbers)


SENSITIVITIES = Answer[tuple[Sensitivity, ...]](
    "sensitivities",
    "sensitivities of the leak rate",
    _compute,
    (),
    # of a path of loads they take as long as some twenty paths: only if they are asked for
    lambda seal, request: bool(request.sensitivities) or not seal.problem.follows_path,
    status=_STATUS,
    # among the times of summary.json
    clock="levers",
    request_field="sensitivities",
    needs_unrequested=("case.requirement",),
)
