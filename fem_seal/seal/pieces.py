"""Tasks of a simulation: distributed over processes, each stored on disk when done."""

from __future__ import annotations

from collections.abc import Callable, Generator, Hashable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, wait
from contextlib import closing, suppress
from itertools import islice
from pathlib import Path
from typing import Any, Protocol, TypeVar

from fem_seal.files import as_json, parse_json, read_text, write_text
from fem_seal.processes import Processes
from leak import LeakError


class Record(Protocol):
    """Numbers of a piece, a named tuple."""

    def _asdict(self) -> dict[str, Any]:
        """As it is written."""


Piece = TypeVar("Piece", bound=Hashable)
Piece_contra = TypeVar("Piece_contra", bound=Hashable, contravariant=True)
R = TypeVar("R", bound=Record)
Record_co = TypeVar("Record_co", bound=Record, covariant=True)


class Simulation(Protocol[Piece_contra, Record_co]):
    """What is cut into pieces; it goes to other processes."""

    def keys(self, piece: Piece_contra) -> list[str]:
        """Hash of all that each record of a piece depends on."""

    def records(self, piece: Piece_contra) -> Iterator[Record_co]:
        """Calculate a piece: its records, one after the other."""

    def record(self, values: Mapping[str, Any]) -> Record_co:
        """A record as it stands in a file."""


def work(
    simulation: Simulation[Piece, R],
    pieces: Sequence[Piece],
    folder: Path | None,
    *,
    jobs: int = 1,
    progress: Callable[[str], None] = lambda text: None,
) -> dict[Piece, list[R]]:
    """Records of all pieces; those that are on disk are not calculated again.

    Parameters
    ----------
    simulation : Simulation
    pieces : sequence
    folder : Path or None
        Where finished pieces are kept.
    jobs : int
        Processes; 1 calculates in this one.
    progress : callable
        Told how far it is.

    Raises
    ------
    LeakError
        Of the first piece that fails; what was finished is kept.
    """
    results = {p: records for p in pieces if (records := _read_piece(simulation, p, folder)) is not None}
    todo = [piece for piece in pieces if piece not in results]
    if results and todo:
        progress(f"{len(results)} of {len(pieces)} pieces are there already")
    first_error: LeakError | None = None
    try:
        with closing(_calculate_pieces(simulation, todo, jobs)) as attempts:
            for piece, records, error in attempts:
                # of a piece that failed there are fewer records
                for path, record in zip(_files(simulation, piece, folder), records, strict=False):
                    write_text(path, as_json([record._asdict()]))
                first_error = first_error or error
                if error is None:
                    results[piece] = records
                    progress(f"direct simulation: {len(results)} of {len(pieces)} pieces")
    except KeyboardInterrupt:
        if folder is not None:
            progress("interrupted; finished pieces are kept, and the same command goes on from there")
        raise
    if first_error is not None:
        raise first_error
    return results


def _calculate_pieces(
    simulation: Simulation[Piece, R], pieces: Sequence[Piece], jobs: int
) -> Generator[tuple[Piece, list[R], LeakError | None], None, None]:
    """Pieces as they are done; once one has failed no other is begun."""
    if jobs < 2 or len(pieces) < 2:
        for piece in pieces:
            records, error = _attempt(simulation, piece)
            yield piece, records, error
            if error is not None:
                return
        return
    # no more of them wait than processes can take; half of a piece is nothing, and ends with its process
    queue = iter(pieces)
    with Processes(jobs) as processes:
        futures = {processes.submit(_attempt, simulation, piece): piece for piece in islice(queue, jobs)}
        while futures:
            for future in wait(futures, return_when=FIRST_COMPLETED).done:
                piece, (records, error) = futures.pop(future), future.result()
                queue = queue if error is None else iter(())
                for next_piece in islice(queue, 1):
                    futures[processes.submit(_attempt, simulation, next_piece)] = next_piece
                yield piece, records, error


def _attempt(simulation: Simulation[Piece, R], piece: Piece) -> tuple[list[R], LeakError | None]:
    records: list[R] = []
    try:
        records.extend(simulation.records(piece))
    except LeakError as error:
        return records, error
    return records, None


def _files(simulation: Simulation[Piece, R], piece: Piece, folder: Path | None) -> list[Path]:
    return [] if folder is None else [folder / "pieces" / f"{key}.json" for key in simulation.keys(piece)]


def _read_piece(simulation: Simulation[Piece, R], piece: Piece, folder: Path | None) -> list[R] | None:
    """None if it is not there, or is no whole piece."""
    paths = _files(simulation, piece, folder)
    if not paths or not all(path.is_file() for path in paths):
        return None
    with suppress(ValueError, TypeError, KeyError):
        return [simulation.record(parse_json(read_text(path))[0]) for path in paths]
    return None
