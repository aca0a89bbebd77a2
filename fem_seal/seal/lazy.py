"""Base of frozen dataclasses with cached properties."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import Any, Self, TypeVar

from leak import Reading

T = TypeVar("T")


class Lazy:
    """Base of frozen dataclasses with cached properties."""

    def knowing(self, **known: object) -> Self:
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
        other = self.knowing()
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
