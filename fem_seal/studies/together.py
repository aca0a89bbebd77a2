"""Several designs at a time, each one step further in turn.

A design takes some thousand short steps of very different kinds. One design after the other, each kind finds nothing
of its own in the processor's caches any more; the same step of several designs in a row takes two thirds of the time.
The contacts of all are expected and solved in one go.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Generator, Sequence
from contextlib import AbstractContextManager, nullcontext
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar

if TYPE_CHECKING:
    from fem_seal.contact.newton import Pressing
    from fem_seal.contact.sizing import Expected

T = TypeVar("T")

# A calculation that stops after each of its steps, asking for a contact or for nothing, and returns at the end what it
# has found.
Asked: TypeAlias = "Pressing | Expected"
Steps: TypeAlias = Generator["Asked | None", Any, T]
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
    answers: dict[int, Any] = {}
    while len(found) < len(calculations):
        asked: dict[int, Asked] = {}
        for number, one in enumerate(calculations):
            if number in found:
                continue
            start, answer = time.perf_counter(), answers.pop(number, None)
            with turn(number):
                try:
                    question = one.throw(answer) if isinstance(answer, Exception) else one.send(answer)
                    if question is not None:
                        asked[number] = question
                except StopIteration as end:
                    found[number] = end.value
            seconds[number] += time.perf_counter() - start
        if asked:
            start = time.perf_counter()
            with turn(next(iter(asked)) if len(asked) == 1 else None):
                answers = dict(zip(asked, _answers(list(asked.values())), strict=True))
            for number in asked:
                seconds[number] += (time.perf_counter() - start) / len(asked)
    return [(found[number], seconds[number]) for number in range(len(calculations))]


def _answers(asked: Sequence[Asked]) -> list[Any]:
    """What is found for each, or the error that is its answer."""
    from fem_seal.contact.newton import Pressing, solve_together
    from fem_seal.contact.sizing import Expected, widths_together
    from fem_seal.contact.solution import ContactSettings

    presses = [one for one in asked if isinstance(one, Pressing)]
    expected = [one for one in asked if isinstance(one, Expected)]
    try:
        solved = iter(solve_together(presses, ContactSettings(_TOLERANCE, _TOLERANCE)))
        widths = iter(widths_together(expected))
    except Exception as error:  # of one of them, whose own affair it is
        return [error] if len(asked) == 1 else [answer for one in asked for answer in _answers([one])]
    return [next(solved) if isinstance(one, Pressing) else next(widths) for one in asked]


def alone(calculation: Steps[T]) -> T:
    """What a calculation finds."""
    ((found, _),) = together([calculation])
    return found
