"""Look for the best design (optuna): proposals in batches, calculated like any other design and kept in the same file.

Every trial is proposed by a sampler that is made anew from the seed and the number of the trial, out of the batches
before it, which it is told again from the rows of the file. What an interrupted search proposes next is therefore what
it would have proposed anyway.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from fem_seal.errors import InputError
from fem_seal.files import problem
from fem_seal.sampling import LogUniform, Uniform
from fem_seal.seal.findings import Level
from fem_seal.studies.progress import Progress
from fem_seal.studies.store import Row, Store
from fem_seal.studies.work import DesignSpec, check_unchanged

if TYPE_CHECKING:
    from optuna import Study as OptunaStudy
    from optuna.distributions import BaseDistribution
    from optuna.samplers import TPESampler
    from optuna.trial import Trial

    from fem_seal.arrays import FloatArray
    from fem_seal.studies.plan import StudyPlan
    from fem_seal.studies.pools import Pool
    from fem_seal.studies.tables import Optimise


def search_space(study: StudyPlan) -> dict[str, BaseDistribution]:
    """Where optuna looks: numbers between bounds, or one of the levels.

    Parameters
    ----------
    study : StudyPlan
    """
    from optuna.distributions import CategoricalDistribution, FloatDistribution

    space: dict[str, BaseDistribution] = {}
    for parameter in study.parameters:
        if isinstance(parameter.distribution, (Uniform, LogUniform)):
            space[parameter.name] = FloatDistribution(
                *parameter.bounds, log=isinstance(parameter.distribution, LogUniform)
            )
        else:
            space[parameter.name] = CategoricalDistribution(parameter.numbers.tolist())
    return space


def optimise(
    study: StudyPlan, spec: DesignSpec, about: Mapping[str, Any], store: Store, pool: Pool, progress: Progress
) -> None:
    """Try designs until there are as many as asked for.

    Parameters
    ----------
    study : StudyPlan
        With [optimise].
    spec : DesignSpec
    about : dict
        Description of the study, kept with its designs.
    store : Store
        Gets the rows, and has those of the trials before.
    pool : OwnProcess or WorkerPool
    progress : Progress

    Raises
    ------
    InputError
        If the file holds another search.
    OutputError
        If the file cannot be written.
    """
    import optuna
    from optuna.trial import TrialState, create_trial

    settings, space = study.optimise, search_space(study)
    assert settings is not None
    search_inputs = _search_inputs(study, settings, space)
    rows = list(_rows_before(spec, store, search_inputs))
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    search = optuna.create_study(directions=["minimize"] * len(study.goals))
    for row in rows:
        goals, constraints = _goals_and_violations(study, row)
        search.add_trial(
            create_trial(
                state=TrialState.COMPLETE if goals else TrialState.FAIL,
                values=goals,
                params=dict(zip(space, spec.point(row.inputs), strict=True)),
                distributions=space,
                constraints=constraints,
            )
        )
    store.set_design([row.key for row in rows], **about, asked=search_inputs)
    progress.begin(settings.trials, len(rows))
    try:
        while batch := _batch(search, settings, space):
            points = np.array([[trial.params[name] for name in space] for trial in batch])
            rows = _rows(spec, store, pool, points)
            store.append_design(batch[0].number, [row.key for row in rows])
            for trial, row in zip(batch, rows, strict=True):
                goals, constraints = _goals_and_violations(study, row)
                for name, value in constraints.items():
                    trial.set_constraint(name, value)
                search.tell(trial, goals, None if goals else TrialState.FAIL)
            progress.advance(len(rows), sum(row.reason is not None for row in rows))
    finally:
        progress.end()


def _search_inputs(study: StudyPlan, settings: Optimise, space: Mapping[str, BaseDistribution]) -> list[Any]:
    """What the proposals depend on, in JSON's types."""
    return [
        study.names,
        [list(parameter.levels) for parameter in study.parameters],
        [str(distribution) for distribution in space.values()],
        [goal.text for goal in study.goals.values()],
        [constraint.text for constraint in study.constraints.values()],
        [settings.seed, settings.batch, study.keeps_outside],
    ]


def _rows_before(spec: DesignSpec, store: Store, search_inputs: list[Any]) -> Iterator[Row]:
    """Rows of the trials before, in their order; InputError if they are those of another search."""
    about = store.about
    if not about.get("design", {}).get("optimise"):
        return
    keys = store.design
    rows = store.rows(keys)
    for key in keys:
        if (
            about.get("asked") != search_inputs
            or key not in rows
            or spec.key(spec.point(rows[key].inputs)) != key
        ):
            raise InputError(problem("study_another_search"))
        yield rows[key]


def _batch(search: OptunaStudy, settings: Optimise, space: dict[str, BaseDistribution]) -> list[Trial]:
    """Trials to be calculated next: what is left of a batch, or a new one; empty at the end."""
    first = len(search.get_trials(deepcopy=False))
    batch = []
    for number in range(first, min((first // settings.batch + 1) * settings.batch, settings.trials)):
        search.sampler = _sampler(settings.seed, number)
        batch.append(search.ask(space))
    return batch


def _sampler(seed: int, number: int) -> TPESampler:
    """Sampler for one trial."""
    import warnings

    from optuna.exceptions import ExperimentalWarning
    from optuna.samplers import TPESampler

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", category=ExperimentalWarning)
        return TPESampler(seed=(seed * 1_000_003 + number) % 2**32, multivariate=True, constant_liar=True)


def _rows(spec: DesignSpec, store: Store, pool: Pool, points: FloatArray) -> list[Row]:
    """Rows of some designs, calculated where they are not known."""
    keys = [spec.key(point) for point in points]
    stored_keys = store.stored_keys(keys)
    fresh = {key: point for key, point in zip(keys, points, strict=True) if key not in stored_keys}
    for rows in pool.results(spec, [point[None] for point in fresh.values()]):
        check_unchanged(spec.files)
        store.write(rows)
    stored_rows = store.rows(keys)
    return [stored_rows[key] for key in keys]


def _goals_and_violations(study: StudyPlan, row: Row) -> tuple[Sequence[float] | None, dict[str, float]]:
    """Goals of a design, None if it has failed, and by how much it violates each constraint."""
    if row.reason is not None:
        return None, {}
    values = {
        name: math.nan if value is None else value
        for name, value in zip(study.output_names, row.outputs, strict=True)
    }
    values |= {
        parameter.name: float(value)
        for parameter, value in zip(study.parameters, row.inputs, strict=True)
        if parameter.numeric
    }
    goals = [formula(values) for formula in study.goals.values()]
    if not all(map(math.isfinite, goals)):
        return None, {}
    # infinite where a value is missing; optuna takes finite numbers only
    violations = {
        name: min(constraint.violation(values), 1e12) for name, constraint in study.constraints.items()
    }
    if not study.keeps_outside:
        # a name that no constraint can have
        violations[str(Level.OUTSIDE)] = 1.0 if row.validity == Level.OUTSIDE else -1.0
    return goals, violations
