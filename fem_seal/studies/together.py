"""Several designs at a time, each one step further in turn.

A design takes some thousand short steps of very different kinds. One design after the other, each kind finds nothing
of its own in the processor's caches any more; the same step of several designs in a row takes two thirds of the time.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Generator, Sequence
from contextlib import AbstractContextManager, nullcontext
from typing import TypeAlias, TypeVar

T = TypeVar("T")

# A calculation that stops after each of its steps, and returns what it has found at the end.
Steps: TypeAlias = Generator[None, None, T]
# Entered while the calculation of that number takes a step.
Turn: TypeAlias = Callable[[int], AbstractContextManager[None]]


def together(calculations: Sequence[Steps[T]], turn: Turn = nullcontext) -> list[tuple[T, float]]:
    """What calculations find, and how long each of them took [s].

    Parameters
    ----------
    calculations : sequence of generator
        None knows of the others: each finds what it would find alone.
    turn : callable
        Entered with the number of a calculation while it takes a step.
    """
    found: dict[int, T] = {}
    seconds = [0.0] * len(calculations)
    while len(found) < len(calculations):
        for number, one in enumerate(calculations):
            if number in found:
                continue
            start = time.perf_counter()
            with turn(number):
                try:
                    next(one)
                except StopIteration as end:
                    found[number] = end.value
            seconds[number] += time.perf_counter() - start
    return [(found[number], seconds[number]) for number in range(len(calculations))]


def alone(calculation: Steps[T]) -> T:
    """What a calculation finds."""
    ((found, _),) = together([calculation])
    return found
