"""Look for the best design (optuna): proposals in batches, calculated like any other design and kept in the same file.

Every trial is proposed by a sampler that is made anew from the seed and the number of the trial, out of the batches
before it. What an interrupted search proposes next is therefore what it would have proposed anyway.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np

from fem_seal.case.words import problem
from fem_seal.errors import InputError, OutputError
from fem_seal.sampling import LogUniform, Uniform
from fem_seal.seal.findings import Level
from fem_seal.studies.progress import Progress
from fem_seal.studies.store import Row, Store, damaged
from fem_seal.studies.work import DesignSpec, check_unchanged

if TYPE_CHECKING:
    from optuna import Study as OptunaStudy
    from optuna.distributions import BaseDistribution
    from optuna.samplers import TPESampler
    from optuna.trial import FrozenTrial, Trial

    from fem_seal.studies.plan import StudyPlan
    from fem_seal.studies.pools import Pool
    from fem_seal.studies.tables import Optimise

_NAME = "fem-seal"


def search_space(study: StudyPlan) -> dict[str, BaseDistribution]:
    """Where optuna looks: numbers between bounds, or one of the levels.

    Parameters
    ----------
    study : StudyPlan
    """
    from optuna.distributions import CategoricalDistribution, FloatDistribution

    space: dict[str, BaseDistribution] = {}
    for one in study.parameters:
        if isinstance(one.distribution, (Uniform, LogUniform)):
            space[one.name] = FloatDistribution(*one.bounds, log=isinstance(one.distribution, LogUniform))
        else:
            space[one.name] = CategoricalDistribution(one.numbers.tolist())
    return space


def optimise(
    study: StudyPlan,
    recipe: DesignSpec,
    about: Mapping[str, Any],
    store: Store,
    pool: Pool,
    progress: Progress,
) -> None:
    """Try designs until there are as many as asked for.

    Parameters
    ----------
    study : StudyPlan
        With [optimise].
    recipe : Recipe
    about : dict
        Description of the study, kept with its designs.
    store : Store
        Gets the rows; optuna keeps its own tables in the same file.
    pool : Pool
    progress : Progress

    Raises
    ------
    InputError
        If the file holds another search.
    OutputError
        If the file cannot be written.
    """
    settings = study.optimise
    assert settings is not None
    with _writable(store):
        space = search_space(study)
        search = _search(study, settings, space, store)
        with _readable(store):
            there = _trials(search)
            # only the last one can have been cut short while it was proposed
            proposed = [trial for trial in there if trial.params.keys() == space.keys()]
            keys = [recipe.key(_point(trial, space)) for trial in proposed]
            finished = [key for key, trial in zip(keys, proposed, strict=True) if trial.state.is_finished()]
        if not set(finished) <= store.known(finished):
            raise InputError(problem("study_another_search"))
        store.set_design(keys, **about)
        progress.begin(settings.trials, len(finished))
        try:
            while batch := _batch(search, settings, space):
                store.check_place()
                points = np.array([_point(trial, space) for trial in batch])
                rows = _rows(recipe, store, pool, points)
                store.append_design(batch[0].number, [recipe.key(point) for point in points])
                for trial, row in zip(batch, rows, strict=True):
                    _tell(search, study, trial, row)
                progress.advance(len(rows), sum(row.reason is not None for row in rows))
        finally:
            progress.end()


@contextmanager
def _writable(store: Store) -> Iterator[None]:
    """Writing optuna's tables: a full disc and the like are called so."""
    from optuna.exceptions import StorageInternalError
    from sqlalchemy.exc import SQLAlchemyError

    try:
        yield
    except (StorageInternalError, SQLAlchemyError) as error:
        store.check_place()
        raise OutputError(f"{store.path}: cannot be written ({error.__cause__ or error})") from error


def _batch(search: OptunaStudy, settings: Optimise, space: dict[str, BaseDistribution]) -> list[Trial]:
    """Trials to be calculated next: what is left of the batch that was interrupted, or a new one; empty at the end."""
    from optuna.trial import Trial

    there = _trials(search)
    left = [trial.number for trial in there if not trial.state.is_finished()]
    start = (min(left) if left else len(there)) // settings.batch * settings.batch
    batch = []
    for number in range(start, min(start + settings.batch, settings.trials)):
        if number < len(there) and number not in left:
            continue
        search.sampler = _sampler(settings.seed, number)
        if number < len(there):
            batch.append(_suggested(Trial(search, there[number]._trial_id), space))
        else:
            batch.append(search.ask(space))
    return batch


def _suggested(trial: Trial, space: dict[str, BaseDistribution]) -> Trial:
    """A trial that was cut short while it was proposed, with the proposals that are missing."""
    from optuna.distributions import CategoricalDistribution, FloatDistribution

    for name, one in space.items():
        if isinstance(one, FloatDistribution):
            trial.suggest_float(name, one.low, one.high, log=one.log)
        elif isinstance(one, CategoricalDistribution):
            trial.suggest_categorical(name, one.choices)
    return trial


def _point(trial: Trial | FrozenTrial, space: Iterable[str]) -> list[float]:
    return [trial.params[name] for name in space]


def _trials(search: OptunaStudy) -> list[FrozenTrial]:
    return search.get_trials(deepcopy=False)


def _search(
    study: StudyPlan, settings: Optimise, space: dict[str, BaseDistribution], store: Store
) -> OptunaStudy:
    import optuna
    from optuna.storages import RDBStorage

    optuna.logging.set_verbosity(optuna.logging.ERROR)
    storage = RDBStorage(
        f"sqlite:///{store.path.absolute()}", engine_kwargs={"connect_args": {"timeout": 60}}
    )
    with _readable(store):
        search = optuna.create_study(
            storage=storage,
            study_name=_NAME,
            directions=["minimize"] * len(study.goals),
            load_if_exists=True,
        )
        asked_before = search.user_attrs.get("asked")
    asked = json.dumps(
        [
            study.names,
            [str(one) for one in space.values()],
            [one.text for one in study.goals.values()],
            [one.text for one in study.constraints.values()],
            [settings.seed, settings.batch, study.keeps_outside],
        ]
    )
    if asked_before not in (None, asked):
        raise InputError(problem("study_another_search"))
    search.set_user_attr("asked", asked)
    return search


@contextmanager
def _readable(store: Store) -> Iterator[None]:
    """Reading optuna's tables: whatever it makes of entries that it has not written means that they are damaged."""
    from optuna.exceptions import StorageInternalError
    from sqlalchemy.exc import SQLAlchemyError

    try:
        yield
    except (StorageInternalError, SQLAlchemyError):
        raise
    except Exception as error:
        raise damaged(store.path, f"the search cannot be read: {error}") from error


def _sampler(seed: int, number: int) -> TPESampler:
    """Sampler for one trial."""
    import warnings

    from optuna.exceptions import ExperimentalWarning
    from optuna.samplers import TPESampler

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", category=ExperimentalWarning)
        return TPESampler(seed=(seed * 1_000_003 + number) % 2**32, multivariate=True, constant_liar=True)


def _rows(recipe: DesignSpec, store: Store, pool: Pool, points: Any) -> list[Row]:
    """Rows of some designs, calculated where they are not known."""
    keys = [recipe.key(point) for point in points]
    known = store.known(keys)
    fresh = {key: point for key, point in zip(keys, points, strict=True) if key not in known}
    for rows in pool.results(recipe, [point[None] for point in fresh.values()]):
        check_unchanged(recipe.files)
        store.write(rows)
    found = store.rows(keys)
    return [found[key] for key in keys]


def _tell(search: OptunaStudy, study: StudyPlan, trial: Trial, row: Row) -> None:
    from optuna.trial import TrialState

    if row.reason is not None:
        search.tell(trial, state=TrialState.FAIL)
        return
    outputs = {
        name: math.nan if value is None else value
        for name, value in zip(study.output_names, row.outputs, strict=True)
    }
    inputs = {
        one.name: float(value) for one, value in zip(study.parameters, row.inputs, strict=True) if one.numeric
    }
    values = {**inputs, **outputs}
    goals = [formula(values) for formula in study.goals.values()]
    if not all(math.isfinite(goal) for goal in goals):
        search.tell(trial, state=TrialState.FAIL)
        return
    # some, of a search that was killed in these lines; optuna warns of the second time
    told = trial.constraints
    # a name that no constraint can have
    outside = str(Level.OUTSIDE)
    if not study.keeps_outside and outside not in told:
        trial.set_constraint(outside, 1.0 if row.validity == outside else -1.0)
    for name, one in study.constraints.items():
        if name not in told:
            # infinite where a value is missing; optuna's storage takes finite numbers only
            trial.set_constraint(name, min(one.violation(values), 1e12))
    search.tell(trial, goals)
