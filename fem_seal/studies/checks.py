"""Whether the tables of a study fit together, and each of its designs is a case: before any work starts."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from fem_seal.case_fields import shown
from fem_seal.errors import InputError, Problem
from fem_seal.studies.designs import SENSITIVITY
from fem_seal.studies.distributions import LogNormal, Normal

if TYPE_CHECKING:
    from fem_seal.case import Case
    from fem_seal.studies.parameters import Parameter
    from fem_seal.studies.study import Study
    from fem_seal.studies.study_tables import Design

# So many designs are built as cases before the study starts; of larger studies the extreme ones and a sample.
_CHECKED = 300


def check_changes(changes: Mapping[str, Any], paths: Sequence[str]) -> None:
    """InputError if an entry is changed and varied."""
    twice = [path for path in paths if path in changes]
    if twice:
        raise InputError(
            Problem(
                f"changes.{twice[0]}", "is a parameter as well, which would replace it; remove one of them"
            )
        )


def check_load(case: Case, paths: Collection[str]) -> None:
    """InputError if the case has several loads that no parameter replaces: a design has one."""
    pressures, forces = case.load.fluid_pressure, case.load.axial_force
    several = {}
    force_count = len(forces) if isinstance(forces, tuple) else 1
    # a single pressure stands there once for each force
    repeated = force_count > 1 and len(set(pressures)) == 1
    if len(pressures) > 1 and not repeated and "load.fluid_pressure" not in paths:
        several['"load.fluid_pressure" = "10 bar"'] = f"{len(pressures)} fluid pressures"
    if force_count > 1 and "load.axial_force" not in paths:
        several['"load.axial_force" = "0 N"'] = f"{force_count} axial forces"
    if several:
        raise InputError(
            Problem(
                "base",
                f"has {' and '.join(several.values())}, a design has one: write [changes] {' and '.join(several)}, or "
                f"make {'it a parameter' if len(several) == 1 else 'them parameters'}",
            )
        )


def check_design(design: Design, parameters: Sequence[Parameter], optimise: bool) -> None:
    """InputError if a design cannot be made of its parameters."""
    if not parameters:
        raise InputError(
            Problem("parameters", 'is empty; name what varies, such as "seat.angle" = ["30 deg", "45 deg"]')
        )
    if design.file is not None:
        raise InputError(Problem("design.file", 'only with kind = "list"; remove it', shown(design.file)))
    if optimise:
        _check_searched(parameters)
    elif design.kind == "grid":
        _check_grid(design, parameters)
    else:
        _check_sampled(design, parameters)


def _check_searched(parameters: Sequence[Parameter]) -> None:
    for one in parameters:
        if isinstance(one.distribution, (Normal, LogNormal)):
            raise InputError(
                Problem(
                    f"parameters.{one.name}",
                    'is spread by chance; an optimisation chooses from a list, or from distribution = "uniform" or '
                    '"log-uniform"',
                )
            )


def _check_grid(design: Design, parameters: Sequence[Parameter]) -> None:
    for one in parameters:
        if one.distribution is not None:
            raise InputError(
                Problem(
                    f"parameters.{one.name}",
                    'is a distribution, which has no levels; write a list or a range, or design.kind = "sobol"',
                )
            )
    if design.num is not None:
        raise InputError(Problem("design.num", "a grid has as many designs as its levels make; remove it"))


def _check_sampled(design: Design, parameters: Sequence[Parameter]) -> None:
    if design.num is None:
        raise InputError(
            Problem("design.num", f'is missing; kind = "{design.kind}" needs a number of designs')
        )
    if design.kind in SENSITIVITY and design.num < 2:
        raise InputError(
            Problem("design.num", f'kind = "{design.kind}" needs at least 2 to compare', str(design.num))
        )
    for one in parameters:
        if one.distribution is None and one.numeric:
            low, high = (one.entry.shown(bound) for bound in one.bounds)
            raise InputError(
                Problem(
                    f"parameters.{one.name}",
                    f'has levels, but kind = "{design.kind}" draws from distributions; write {{ distribution = '
                    f'"uniform", low = {low}, high = {high} }}, or design.kind = "grid"',
                )
            )


def check_kept(study: Study) -> None:
    """InputError if the designs whose complete results are wanted cannot exist."""
    wanted = study.run_settings.keep_fields
    if wanted == "best" and not study.goals:
        raise InputError(
            Problem("run.keep_fields", "the best design needs a goal; write [report] goals", shown(wanted))
        )
    if isinstance(wanted, str):
        return
    count = study.optimise.trials if study.optimise else len(study.points)
    for number in wanted:
        if not 0 <= number < count:
            raise InputError(
                Problem(
                    "run.keep_fields", f"there is no such design; allowed are 0 to {count - 1}", str(number)
                )
            )


def check_designs(study: Study) -> None:
    """InputError if a design is no valid case, unless such designs are to be left out."""
    if study.design.invalid == "skip":
        return
    for number in _telling_designs(study):
        point = study.points[number]
        try:
            study.case_of(point)
        except InputError as error:
            found = error.problems[0]
            listed = ", ".join(
                f"{one.name} = {one.entry.shown(one.value(value))}"
                for one, value in zip(study.parameters, point, strict=True)
            )
            raise InputError(
                Problem(
                    "design",
                    f"design {number} ({listed}) is no valid case: {found}. Change the values, or set "
                    'design.invalid = "skip" to leave such designs out',
                )
            ) from None


def _telling_designs(study: Study) -> Iterator[int]:
    """Designs that are built before the study starts: all of a small one, else extremes, corners and a sample."""
    points = study.points
    count = len(points)
    if count <= _CHECKED:
        yield from range(count)
        return
    span = np.ptp(points, axis=0)
    place = (points - points.min(axis=0)) / np.where(span > 0, span, 1.0)
    chosen = {*place.argmin(axis=0).tolist(), *place.argmax(axis=0).tolist()}
    dimensions = min(place.shape[1], 6)
    for corner in np.ndindex(*([2] * dimensions)):
        signs = 2.0 * np.array(corner) - 1.0
        chosen.add(int(np.argmax(place[:, :dimensions] @ signs)))
    chosen.update(np.linspace(0, count - 1, _CHECKED // 2).astype(int).tolist())
    yield from sorted(chosen)
