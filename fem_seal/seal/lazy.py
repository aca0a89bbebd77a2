"""Values that are worked out when they are asked for, and steps of which a failure is no error."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import Any, Self, TypeVar

from fem_seal.errors import OutputError, error_text
from leak import Reading

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
        if strange := [name for name in known if not hasattr(type(self), name)]:
            raise AttributeError(f"{type(self).__name__} has no optional {', '.join(strange)}")
        other = object.__new__(type(self))
        vars(other).update(vars(self), **known)
        return other


class ByReading(Lazy):
    """What is something else in each reading of yielding asperities, made when it is asked for."""

    def reading(self, reading: Reading) -> Self:
        """The same, its yielding asperities read in another way; itself where that is how they are read.

        Parameters
        ----------
        reading : Reading
        """
        known = vars(self)
        if reading.name not in known:
            other = self._read_as(reading)
            if other is self:
                return self
            known[reading.name] = other
        return known[reading.name]

    def _read_as(self, reading: Reading) -> Self:
        raise NotImplementedError

    def with_readings(self, known: Mapping[Reading, Self]) -> Self:
        """A copy that knows what it is in other readings.

        Parameters
        ----------
        known : mapping
        """
        other = self.with_values()
        vars(other).update({reading.name: one for reading, one in known.items()})
        return other


class variant(cached_property[T]):
    """A cached property that may be the object itself, which is not kept.

    What holds itself stays, with all that it has worked out, until the garbage collector goes through everything.
    """

    def __get__(self, instance: object, owner: type[Any] | None = None) -> Any:
        """The value, worked out once unless it is the object itself."""
        if instance is None or self.attrname is None:
            return self
        known = vars(instance)
        if self.attrname in known:
            return known[self.attrname]
        value = self.func(instance)
        if value is not instance:
            known[self.attrname] = value
        return value


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
