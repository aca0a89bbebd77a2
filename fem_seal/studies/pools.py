"""Who calculates the designs of a study: this process, processes of this machine, or a dask cluster."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

from fem_seal.arrays import FloatArray
from fem_seal.errors import InputError
from fem_seal.files import problem
from fem_seal.processes import usable_cores
from fem_seal.studies.store import Row
from fem_seal.studies.tables import design_text
from fem_seal.studies.time_limit import OvertimeError, end_after, slow_line
from fem_seal.studies.work import DesignSpec, calculate, overtime_row
from fem_seal.studies.worker_pool import WorkerPool, Workers

if TYPE_CHECKING:
    from dask.distributed import Client


@dataclass(frozen=True)
class OwnProcess:
    """Calculates here, one design after the other.

    Parameters
    ----------
    note : callable
        Told of designs that take long.
    stuck : callable
        Given the row of a design that reached its time limit and does not stop.
    """

    note: Callable[[str], None]
    stuck: Callable[[Row], None]

    def results(self, spec: DesignSpec, chunks: Iterable[FloatArray]) -> Iterator[list[Row]]:
        """Rows of the designs, one by one."""
        # the limit is that of designs, not of loading what calculates them
        import fem_seal.studies.responses  # noqa: F401

        for chunk in chunks:
            for point in chunk:
                yield self._rows(spec, point)

    def _rows(self, spec: DesignSpec, point: FloatArray) -> list[Row]:
        def slow(seconds: float) -> None:
            self.note(slow_line(design_text(spec.parameters, point), seconds, spec.time_limit))

        try:
            with end_after(spec.time_limit, slow, lambda: self.stuck(overtime_row(spec, point))):
                return calculate(spec, point[None])
        except OvertimeError:
            return [overtime_row(spec, point)]


Pool: TypeAlias = OwnProcess | WorkerPool


@contextmanager
def open_pool(
    client: Client | Workers | None,
    workers: int | None,
    scheduler: str | None,
    retries: int,
    note: Callable[[str], None],
    stuck: Callable[[Row], None],
) -> Iterator[Pool]:
    """Who is to calculate; processes or a connection made for it are closed at the end.

    Parameters
    ----------
    client : dask.distributed.Client or Workers, optional
        The user's own.
    workers : int, optional
        Processes of this machine, one per core unless given; 0 for this process.
    scheduler : str, optional
        Address of a running scheduler, ``tcp://...``.
    retries, note
        See `WorkerPool`.
    stuck
        See `OwnProcess`.

    Raises
    ------
    InputError
        If there is no scheduler at the address, workers are asked of it, or dask is not installed.
    """
    if scheduler is not None and workers is not None:
        raise InputError(problem("study_workers_of_scheduler", workers=workers))
    from fem_seal.studies import cluster

    if isinstance(client, Workers):
        yield WorkerPool(client, retries, note)
    elif client is not None:
        yield cluster.cluster_pool(client, retries, note)
    elif scheduler is not None:
        with cluster.connect_client(scheduler) as new_client:
            yield cluster.cluster_pool(new_client, retries, note)
    elif workers == 0:
        yield OwnProcess(note, stuck)
    else:
        from fem_seal.studies.machine import LocalWorkers

        with closing(LocalWorkers(workers or usable_cores())) as processes:
            yield WorkerPool(processes, retries, note)
