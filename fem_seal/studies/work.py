"""What a worker is given and what it gives back: a few designs of equal bodies at a time."""

from __future__ import annotations

import hashlib
import json
import math
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fem_seal import __version__
from fem_seal.studies.expressions import Expression
from fem_seal.studies.parameters import Parameter
from fem_seal.studies.store import Row

if TYPE_CHECKING:
    from fem_seal.case import Case
    from fem_seal.studies.study import Study

FloatArray = NDArray[np.float64]

# A chunk is what is lost when a worker dies and what travels at once: about a second of work, by these estimates of
# what new bodies, a new surface and a further design cost [s]; a cone takes less, a land with its edges more.
_BODIES, _SURFACE, _DESIGN, _CHUNK = 0.3, 0.02, 0.008, 1.0

# Materials enter the bodies by their elastic constants, the surface by their hardness.
_BODY_TABLES = ("closure.", "seat.", "mesh.")
_SURFACE_ENTRIES = ("hardness", "yield_stress", "name")
_SURFACE_TABLES = ("roughness.", "interface.", "leak.")


@dataclass(frozen=True)
class Recipe:
    """Everything about a study that a worker has to know.

    Parameters
    ----------
    case : Case
        Base.
    parameters : tuple of Parameter
    columns : tuple of str
        Of leak.csv.
    derived : dict
    interpolate : bool
    fingerprint : str
        Hash of all that the designs have in common.
    """

    case: Case
    parameters: tuple[Parameter, ...]
    columns: tuple[str, ...]
    derived: dict[str, Expression]
    interpolate: bool
    fingerprint: str

    @classmethod
    def of(cls, study: Study) -> Recipe:
        """The recipe of a study."""
        interpolate = study.run_settings.interpolate_surfaces
        parameters = tuple(
            # a worker needs the words that numbers stand for, not the levels or distributions of numbers
            Parameter(one.entry) if one.numeric else one
            for one in study.parameters
        )
        return cls(
            study.case,
            parameters,
            study.responses,
            study.derived,
            interpolate,
            _fingerprint(study.case, study.responses, study.derived, interpolate),
        )

    def inputs(self, point: Sequence[float] | FloatArray) -> tuple[float | str | bool, ...]:
        """Values of the parameters in a design."""
        return tuple(one.value(number) for one, number in zip(self.parameters, point, strict=True))

    def key(self, point: Sequence[float] | FloatArray) -> str:
        """Hash of the full input of a design."""
        entries = sorted(zip((one.name for one in self.parameters), self.inputs(point), strict=True))
        text = json.dumps([self.fingerprint, [[name, _content(name, value)] for name, value in entries]])
        return hashlib.blake2b(text.encode(), digest_size=16).hexdigest()


@dataclass(frozen=True)
class Chunk:
    """Designs that a worker calculates in one go.

    Parameters
    ----------
    points : ndarray, shape (designs, parameters)
    """

    points: FloatArray


def calculate(recipe: Recipe, chunk: Chunk) -> list[Row]:
    """Rows of all designs of a chunk; a design that fails is a row with its reason."""
    return [_row(recipe, point) for point in chunk.points.tolist()]


def _row(recipe: Recipe, point: Sequence[float]) -> Row:
    start = time.perf_counter()
    reason = None
    outputs: tuple[float | None, ...] = (None,) * (len(recipe.columns) + len(recipe.derived))
    try:
        outputs = _outputs(recipe, point)
    except Exception as error:  # whatever it is, it is the end of this design and not of the study
        reason = _reason(error)
    return Row(recipe.key(point), recipe.inputs(point), outputs, reason, time.perf_counter() - start)


def _outputs(recipe: Recipe, point: Sequence[float]) -> tuple[float | None, ...]:
    from fem_seal.studies.evaluate import responses

    changes = {
        one.name: one.entry.written(one.value(number))
        for one, number in zip(recipe.parameters, point, strict=True)
    }
    found = responses(recipe.case.replace(changes), recipe.columns, interpolate=recipe.interpolate)
    numbers = {
        one.name: float(number) for one, number in zip(recipe.parameters, point, strict=True) if one.numeric
    }
    values: dict[str, float] = {**numbers, **found}
    for name, formula in recipe.derived.items():
        values[name] = formula(values)
    names = (*recipe.columns, *recipe.derived)
    return tuple(values[name] if math.isfinite(values[name]) else None for name in names)


def failed_row(recipe: Recipe, point: Sequence[float] | FloatArray, reason: str) -> Row:
    """Row of a design that could not be calculated at all."""
    nothing = (None,) * (len(recipe.columns) + len(recipe.derived))
    return Row(recipe.key(point), recipe.inputs(point), nothing, reason, 0.0)


def _reason(error: BaseException) -> str:
    text = " ".join(str(error).split())[:500]
    own = type(error).__module__.split(".")[0] in ("fem_seal", "leak", "meshes")
    return text if own and text else f"{type(error).__name__}: {text}"


def chunks(recipe: Recipe, points: FloatArray) -> Iterator[Chunk]:
    """All designs, each once, in an order in which equal bodies and then equal surfaces follow each other."""
    if len(points) == 0:
        return
    ranks = np.array([_rank(one.name) for one in recipe.parameters])
    # lexsort takes the most important column last
    ordered = points[np.lexsort(points[:, np.argsort(ranks, kind="stable")[::-1]].T)]
    changed = np.vstack([np.ones(ordered.shape[1], dtype=bool), ordered[1:] != ordered[:-1]])
    ordered, changed = ordered[changed.any(axis=1)], changed[changed.any(axis=1)]
    new_bodies, new_surface = (changed[:, ranks <= rank].any(axis=1) for rank in (0, 1))
    costs = _DESIGN + _SURFACE * new_surface + _BODIES * new_bodies
    start, cost = 0, 0.0
    for place, step in enumerate(np.asarray(costs).tolist()):
        if place > start and cost + step > _CHUNK:
            yield Chunk(ordered[start:place])
            start, cost = place, 0.0
        cost += step
    yield Chunk(ordered[start:])


def _rank(path: str) -> int:
    """0 for what changes the bodies, 1 for what changes the surface, 2 for the rest."""
    if path.startswith(_SURFACE_TABLES) or path.split(".")[-1] in _SURFACE_ENTRIES:
        return 1
    return 0 if path.startswith(_BODY_TABLES) else 2


def _fingerprint(
    case: Case, columns: Sequence[str], derived: Mapping[str, Expression], interpolate: bool
) -> str:
    """Hash of the base case with the contents of its files, of what is calculated, and of the program's version."""
    from fem_seal.summary import input_tables

    tables = {name: entry for name, entry in input_tables(case).items() if name != "output"}
    about = {
        "version": __version__,
        "case": _with_contents(tables),
        "columns": list(columns),
        "derived": {name: formula.text for name, formula in derived.items()},
        "interpolate": interpolate,
    }
    return hashlib.blake2b(
        json.dumps(about, sort_keys=True, default=str).encode(), digest_size=16
    ).hexdigest()


def _with_contents(entry: Any, name: str = "") -> Any:
    """Places of files do not matter, their contents do."""
    if isinstance(entry, Mapping):
        return {key: _with_contents(value, key) for key, value in entry.items()}
    if isinstance(entry, (list, tuple)):
        return [_with_contents(value, name) for value in entry]
    return _contents(entry) if name in ("file", "files") and isinstance(entry, str) else entry


def _content(name: str, value: float | str | bool) -> float | str | bool:
    return _contents(str(value)) if name.endswith(".file") else value


def _contents(path: str) -> str:
    """Hash of a file, its path if it is not there."""
    try:
        status = Path(path).stat()
        return _hash_of(path, status.st_mtime_ns, status.st_size)
    except OSError:
        return path


# The keys of all designs ask for the same few files.
@lru_cache(maxsize=1024)
def _hash_of(path: str, changed: int, size: int) -> str:
    return hashlib.blake2b(Path(path).read_bytes(), digest_size=16).hexdigest()
