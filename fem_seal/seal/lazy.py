"""Values that are worked out when they are asked for, and steps of which a failure is no error."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from typing import Self, TypeVar

from fem_seal.errors import OutputError, error_text

T = TypeVar("T")


class Lazy:
    """Base of frozen dataclasses with cached properties."""

    def with_values(self, **known: object) -> Self:
        """A copy that knows more; what was worked out already stays, which `dataclasses.replace` would forget.

        Parameters
        ----------
        known : object
            Values of optional fields, or of cached properties in place of what they would work out.
        """
        fields = vars(self).keys()
        if strange := [name for name in known if not (hasattr(type(self), name) or name in fields)]:
            raise AttributeError(f"{type(self).__name__} has no optional {', '.join(strange)}")
        other = object.__new__(type(self))
        vars(other).update(vars(self), **known)
        return other


Asked = TypeVar("Asked", bound=Lazy)
Value = TypeVar("Value")
Other = TypeVar("Other")


@dataclass(frozen=True)
class OptionalSteps:
    """Steps each of which may fail without harm to the others.

    Parameters
    ----------
    failures : list of str
        A sentence for each step that failed.
    """

    failures: list[str] = field(default_factory=list)

    def compute(self, what: str, calculate: Callable[[], Value], otherwise: Other) -> Value | Other:
        """What `calculate` gives or, if it fails, `otherwise`.

        Parameters
        ----------
        what : str
            What the step gives, the subject of the sentence that names its failure.
        calculate : callable
        otherwise : object
        """
        with self.attempt(what):
            return calculate()
        return otherwise

    def compute_values(self, one: Asked, steps: Mapping[str, str], otherwise: object = None) -> Asked:
        """A lazy object with some of its values worked out; those that fail are known to be `otherwise`.

        Parameters
        ----------
        one : Lazy
        steps : mapping
            Name of each value, with what it is for `compute`.
        otherwise : object
        """
        for name, what in steps.items():
            one = one.with_values(**{name: self.compute(what, partial(getattr, one, name), otherwise)})
        return one

    @contextmanager
    def attempt(self, what: str, *, but: type[Exception] = OutputError) -> Iterator[None]:
        """Name what fails inside, and go on after it.

        A file that cannot be written is not told here but to the caller, as is an interruption: the disc or the user
        is the cause then, and both concern the other results as well.

        Parameters
        ----------
        what : str
            See `compute`.
        but : type of exception
            What stops everything.
        """
        try:
            yield
        except but:
            raise
        except Exception as error:
            # any: what is shown beside a result must never be the reason for having none
            self.name_failure(what, error)

    def name_failure(self, what: str, error: Exception) -> None:
        """Name a failure that was met elsewhere."""
        self.failures.append(
            f"{what}: could not be calculated ({error_text(error)}); all else is not affected"
        )
