"""Several designs at a time, each one step further in turn.

A design takes some thousand short steps of very different kinds. One design after the other, each kind finds nothing
of its own in the processor's caches any more; the same step of several designs in a row takes two thirds of the time.
The contacts of all are solved in one go.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Generator, Sequence
from contextlib import AbstractContextManager, nullcontext
from typing import TYPE_CHECKING, TypeAlias, TypeVar

if TYPE_CHECKING:
    from fem_seal.contact.newton import Pressing
    from fem_seal.contact.solution import ContactSolution

T = TypeVar("T")

# A calculation that stops after each of its steps, for the solution of a contact or for nothing, and returns what it
# has found at the end.
Steps: TypeAlias = "Generator[Pressing | None, ContactSolution | None, T]"
# Entered while the calculation of that number takes a step, None for what is done for several at once.
Turn: TypeAlias = Callable[[int | None], AbstractContextManager[None]]

# The residual is that of the state itself and so the relative error of its pressures: a hundredth of what the mesh
# leaves. Mostly Newton's last step falls far below it.
_TOLERANCE = 1e-6


def unwatched(number: int | None) -> AbstractContextManager[None]:
    """A turn of which nobody takes notice."""
    return nullcontext()


def together(calculations: Sequence[Steps[T]], turn: Turn = unwatched) -> list[tuple[T, float]]:
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
    solved: dict[int, ContactSolution | Exception] = {}
    while len(found) < len(calculations):
        pressings: dict[int, Pressing] = {}
        for number, one in enumerate(calculations):
            if number in found:
                continue
            start, answer = time.perf_counter(), solved.pop(number, None)
            with turn(number):
                try:
                    asked = one.throw(answer) if isinstance(answer, Exception) else one.send(answer)
                    if asked is not None:
                        pressings[number] = asked
                except StopIteration as end:
                    found[number] = end.value
            seconds[number] += time.perf_counter() - start
        if pressings:
            start, numbers = time.perf_counter(), list(pressings)
            with turn(numbers[0] if len(numbers) == 1 else None):
                solved.update(zip(numbers, _solved(list(pressings.values())), strict=True))
            for number in numbers:
                seconds[number] += (time.perf_counter() - start) / len(numbers)
    return [(found[number], seconds[number]) for number in range(len(calculations))]


def _solved(pressings: Sequence[Pressing]) -> Sequence[ContactSolution | Exception]:
    from fem_seal.contact.newton import solve_together
    from fem_seal.contact.solution import ContactSettings

    return solve_together(pressings, ContactSettings(_TOLERANCE, _TOLERANCE))


def alone(calculation: Steps[T]) -> T:
    """What a calculation finds."""
    ((found, _),) = together([calculation])
    return found
