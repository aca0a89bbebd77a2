"""Several designs as a batch: each step for all of them, then the next.

A design takes some thousand short steps of very different kinds. One design after the other, each kind finds nothing
of its own in the processor's caches any more; the same step of several designs in a row takes two thirds of the time.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, field
from typing import TypeAlias, TypeVar

T = TypeVar("T")
Asked = TypeVar("Asked")

# Entered while work is done for the design of that number, None for what is done for several at once.
Turn: TypeAlias = Callable[[int | None], AbstractContextManager[None]]


def untimed(number: int | None) -> AbstractContextManager[None]:
    """No-op: no time limit."""
    return nullcontext()


@dataclass
class Batch:
    """Designs by number: how long each has taken, and which of them failed.

    Parameters
    ----------
    turn : callable
        Entered with the number of a design while work is done for it.

    Examples
    --------
    >>> batch = Batch()
    >>> batch.each([0, 1, 2], lambda number: 1 / number)
    {1: 1.0, 2: 0.5}
    >>> batch.failed
    {0: ZeroDivisionError('division by zero')}
    """

    turn: Turn = untimed
    seconds: dict[int, float] = field(default_factory=dict)
    failed: dict[int, Exception] = field(default_factory=dict)

    def each(self, numbers: Iterable[int], step: Callable[[int], T]) -> dict[int, T]:
        """What a step finds for each design that has not failed; one that fails now is left out from here on.

        Parameters
        ----------
        numbers : iterable of int
        step : callable
            Given the number of a design.
        """
        found: dict[int, T] = {}
        for number in numbers:
            if number in self.failed:
                continue
            start = time.perf_counter()
            with self.turn(number):
                try:
                    found[number] = step(number)
                except Exception as error:  # its own affair: the others go on
                    self.failed[number] = error
            self._spent(number, time.perf_counter() - start)
        return found

    def at_once(
        self, asked: Mapping[int, Asked], answers: Callable[[Sequence[Asked]], Sequence[T | Exception]]
    ) -> dict[int, T | Exception]:
        """Answers to what designs ask, found for all of them at once; an error is the answer of the one it belongs to.

        Parameters
        ----------
        asked : mapping
            By the number of the design.
        answers : callable
            Given all that is asked.
        """
        if not asked:
            return {}
        start = time.perf_counter()
        with self.turn(next(iter(asked)) if len(asked) == 1 else None):
            found = _answers(list(asked.values()), answers)
        for number in asked:
            self._spent(number, (time.perf_counter() - start) / len(asked))
        return dict(zip(asked, found, strict=True))

    def _spent(self, number: int, seconds: float) -> None:
        self.seconds[number] = self.seconds.get(number, 0.0) + seconds


def _answers(
    asked: Sequence[Asked], answers: Callable[[Sequence[Asked]], Sequence[T | Exception]]
) -> list[T | Exception]:
    try:
        return list(answers(asked))
    except Exception as error:
        return [error] if len(asked) == 1 else [found for one in asked for found in _answers([one], answers)]
