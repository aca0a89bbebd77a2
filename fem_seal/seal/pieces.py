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
Asked = TypeVar("Asked", bound=Hashable, contravariant=True)
Found = TypeVar("Found", bound=Record)
Kept = TypeVar("Kept", bound=Record, covariant=True)


class Simulation(Protocol[Asked, Kept]):
    """What is cut into pieces; it goes to other processes."""

    def keys(self, piece: Asked) -> list[str]:
        """Hash of all that each record of a piece depends on."""

    def records(self, piece: Asked) -> Iterator[Kept]:
        """Calculate a piece: its records, one after the other."""

    def record(self, values: Mapping[str, Any]) -> Kept:
        """A record as it stands in a file."""


def work(
    simulation: Simulation[Piece, Found],
    pieces: Sequence[Piece],
    folder: Path | None,
    *,
    jobs: int = 1,
    progress: Callable[[str], None] = lambda text: None,
) -> dict[Piece, list[Found]]:
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
    known = {piece: found for piece in pieces if (found := _read(simulation, piece, folder)) is not None}
    missing = [piece for piece in pieces if piece not in known]
    if known and missing:
        progress(f"{len(known)} of {len(pieces)} pieces are there already")
    failed: LeakError | None = None
    try:
        with closing(_calculated(simulation, missing, jobs)) as calculated:
            for piece, records, error in calculated:
                # of a piece that failed there are fewer records
                for path, record in zip(_files(simulation, piece, folder), records, strict=False):
                    write_text(path, as_json([record._asdict()]))
                failed = failed or error
                if error is None:
                    known[piece] = records
                    progress(f"direct simulation: {len(known)} of {len(pieces)} pieces")
    except KeyboardInterrupt:
        if folder is not None:
            progress("interrupted; finished pieces are kept, and the same command goes on from there")
        raise
    if failed is not None:
        raise failed
    return known


def _calculated(
    simulation: Simulation[Piece, Found], pieces: Sequence[Piece], jobs: int
) -> Generator[tuple[Piece, list[Found], LeakError | None], None, None]:
    """Pieces as they are done; once one has failed no other is begun."""
    if jobs < 2 or len(pieces) < 2:
        for piece in pieces:
            records, error = _attempt(simulation, piece)
            yield piece, records, error
            if error is not None:
                return
        return
    # no more of them wait than processes can take; half of a piece is nothing, and ends with its process
    left = iter(pieces)
    with Processes(jobs) as processes:
        waiting = {processes.submit(_attempt, simulation, piece): piece for piece in islice(left, jobs)}
        while waiting:
            for future in wait(waiting, return_when=FIRST_COMPLETED).done:
                piece, (records, error) = waiting.pop(future), future.result()
                left = left if error is None else iter(())
                for following in islice(left, 1):
                    waiting[processes.submit(_attempt, simulation, following)] = following
                yield piece, records, error


def _attempt(simulation: Simulation[Piece, Found], piece: Piece) -> tuple[list[Found], LeakError | None]:
    records: list[Found] = []
    try:
        records.extend(simulation.records(piece))
    except LeakError as error:
        return records, error
    return records, None


def _files(simulation: Simulation[Piece, Found], piece: Piece, folder: Path | None) -> list[Path]:
    return [] if folder is None else [folder / "pieces" / f"{key}.json" for key in simulation.keys(piece)]


def _read(simulation: Simulation[Piece, Found], piece: Piece, folder: Path | None) -> list[Found] | None:
    """None if it is not there, or is no whole piece."""
    paths = _files(simulation, piece, folder)
    if not paths or not all(path.is_file() for path in paths):
        return None
    with suppress(ValueError, TypeError, KeyError):
        return [simulation.record(parse_json(read_text(path))[0]) for path in paths]
    return None
