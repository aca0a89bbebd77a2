"""Objects that work out what they are asked for, once."""

from __future__ import annotations

from typing import Self


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
