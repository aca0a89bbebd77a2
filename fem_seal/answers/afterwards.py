"""What comes after contact and leak: a step that fails is named, and costs none of the other results."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from typing import TypeVar

from fem_seal.errors import OutputError, error_text
from fem_seal.seal.lazy import Lazy

Asked = TypeVar("Asked", bound=Lazy)
Value = TypeVar("Value")
Other = TypeVar("Other")


@dataclass(frozen=True)
class Afterwards:
    """Steps of which each may fail without harm to the others.

    Parameters
    ----------
    failures : list of str
        A sentence for each step that failed.
    """

    failures: list[str] = field(default_factory=list)

    def get(self, what: str, calculate: Callable[[], Value], otherwise: Other) -> Value | Other:
        """What `calculate` gives or, if it fails, `otherwise`.

        Parameters
        ----------
        what : str
            What the step gives, the subject of the sentence that names its failure.
        calculate : callable
        otherwise : object
        """
        with self.going_on(what):
            return calculate()
        return otherwise

    def settled(self, one: Asked, steps: Mapping[str, str], otherwise: object = None) -> Asked:
        """A lazy object with some of its values worked out; those that fail are known to be `otherwise`.

        Parameters
        ----------
        one : Lazy
        steps : mapping
            Name of each value, with what it is for `get`.
        otherwise : object
        """
        for name, what in steps.items():
            one = one.knowing(**{name: self.get(what, partial(getattr, one, name), otherwise)})
        return one

    @contextmanager
    def going_on(self, what: str, *, but: type[Exception] = OutputError) -> Iterator[None]:
        """Name what fails inside, and go on after it.

        A file that cannot be written is not told here but to the caller, as is an interruption: the disc or the user
        is the cause then, and both concern the other results as well.

        Parameters
        ----------
        what : str
            See `get`.
        but : type of exception
            What stops everything.
        """
        try:
            yield
        except but:
            raise
        except Exception as error:
            # any: what is shown beside a result must never be the reason for having none
            self.name(what, error)

    def name(self, what: str, error: Exception) -> None:
        """Name a failure that was met elsewhere."""
        self.failures.append(
            f"{what}: could not be calculated ({error_text(error)}); all else is not affected"
        )
