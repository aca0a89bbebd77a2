"""Tasks of a simulation: distributed over processes, each stored on disk when done.

They are stored twice: with the results of the case, and in the user's `PieceStore` for all cases.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Hashable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, wait
from contextlib import closing
from itertools import islice
from pathlib import Path
from typing import Any, Protocol, TypeVar

from fem_seal.files import as_json, parse_json, read_text, write_text
from fem_seal.processes import Processes
from fem_seal.seal.piece_store import PieceStore
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
    store = PieceStore.of_user()
    results: dict[Piece, list[R]] = {}
    for piece in pieces:
        records = _read_folder(simulation, piece, folder)
        if records is None and (records := _read_store(simulation, piece, store, progress)) is not None:
            _write_folder(simulation, piece, folder, records)
        if records is not None:
            results[piece] = records
    todo = [piece for piece in pieces if piece not in results]
    if results and todo:
        progress(f"{len(results)} of {len(pieces)} pieces are there already")
    first_error: LeakError | None = None
    try:
        with closing(_calculate_pieces(simulation, todo, store, jobs)) as attempts:
            for piece, records, error in attempts:
                # of a piece that failed there are fewer records
                _write_folder(simulation, piece, folder, records)
                first_error = first_error or error
                if error is None:
                    results[piece] = records
                    progress(f"direct simulation: {len(results)} of {len(pieces)} pieces")
    except KeyboardInterrupt:
        if folder is not None:
            progress("interrupted; finished pieces are kept, and the same command goes on from there")
        raise
    finally:
        if store is not None and todo:
            store.shrink()
    if first_error is not None:
        raise first_error
    return results


def _calculate_pieces(
    simulation: Simulation[Piece, R], pieces: Sequence[Piece], store: PieceStore | None, jobs: int
) -> Generator[tuple[Piece, list[R], LeakError | None], None, None]:
    """Pieces as they are done; once one has failed no other is begun."""
    if jobs < 2 or len(pieces) < 2:
        for piece in pieces:
            records, error = _attempt(simulation, piece, store)
            yield piece, records, error
            if error is not None:
                return
        return
    # no more of them wait than processes can take; half of a piece is nothing, and ends with its process
    queue = iter(pieces)
    with Processes(jobs) as processes:
        futures = {
            processes.submit(_attempt, simulation, piece, store): piece for piece in islice(queue, jobs)
        }
        while futures:
            for future in wait(futures, return_when=FIRST_COMPLETED).done:
                piece, (records, error) = futures.pop(future), future.result()
                queue = queue if error is None else iter(())
                for next_piece in islice(queue, 1):
                    futures[processes.submit(_attempt, simulation, next_piece, store)] = next_piece
                yield piece, records, error


def _attempt(
    simulation: Simulation[Piece, R], piece: Piece, store: PieceStore | None
) -> tuple[list[R], LeakError | None]:
    """Records of a piece; of another process's, if that has finished it meanwhile."""
    if store is None:
        return _calculate(simulation, piece)
    keys = simulation.keys(piece)
    with store.lock(keys[-1]):
        if (known := _read_store(simulation, piece, store)) is not None:
            return known, None
        records, error = _calculate(simulation, piece)
        for key, record in zip(keys, records, strict=False):
            store.write(key, _text(record))
    return records, error


def _calculate(simulation: Simulation[Piece, R], piece: Piece) -> tuple[list[R], LeakError | None]:
    records: list[R] = []
    try:
        records.extend(simulation.records(piece))
    except LeakError as error:
        return records, error
    return records, None


def _text(record: Record) -> str:
    return as_json([record._asdict()])


def _files(simulation: Simulation[Piece, R], piece: Piece, folder: Path | None) -> list[Path]:
    return [] if folder is None else [folder / "pieces" / f"{key}.json" for key in simulation.keys(piece)]


def _write_folder(
    simulation: Simulation[Piece, R], piece: Piece, folder: Path | None, records: Sequence[R]
) -> None:
    for path, record in zip(_files(simulation, piece, folder), records, strict=False):
        write_text(path, _text(record))


def _read_folder(simulation: Simulation[Piece, R], piece: Piece, folder: Path | None) -> list[R] | None:
    """None if it is not there, or is no whole piece."""
    paths = _files(simulation, piece, folder)
    try:
        return [simulation.record(parse_json(read_text(path))[0]) for path in paths] or None
    except _DAMAGES:
        return None


def _read_store(
    simulation: Simulation[Piece, R],
    piece: Piece,
    store: PieceStore | None,
    progress: Callable[[str], None] = lambda text: None,
) -> list[R] | None:
    """None if it is not there; a file that is damaged is named."""
    if store is None or (texts := store.read(keys := simulation.keys(piece))) is None:
        return None
    records = []
    for key, text in zip(keys, texts, strict=True):
        try:
            records.append(simulation.record(parse_json(text)[0]))
        except _DAMAGES:
            progress(f"{store.path(key)}: is damaged, and is calculated again")
            return None
    return records


# What a file raises that is not there, or is not as it was written.
_DAMAGES = (ValueError, TypeError, KeyError, IndexError, AttributeError)
