"""The latest of what was made, such as bodies and tables of a few designs."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable
from threading import RLock
from typing import Any


class Kept:
    """The latest of what was made, by name.

    Parameters
    ----------
    most : int
        So many are kept.

    Examples
    --------
    >>> kept = Kept(2)
    >>> [kept.get(number, lambda number=number: 10 * number) for number in (1, 2, 3)]
    [10, 20, 30]
    >>> kept.known(1) is None, kept.known(3)
    (True, 30)
    """

    def __init__(self, most: int) -> None:
        self._most = most
        self._made: OrderedDict[Hashable, Any] = OrderedDict()
        self._lock = RLock()

    def known(self, name: Hashable) -> Any:
        """What is kept under a name; None if nothing is."""
        with self._lock:
            if name in self._made:
                self._made.move_to_end(name)
            return self._made.get(name)

    @property
    def latest(self) -> Any:
        """What was asked for last; None if nothing is kept."""
        with self._lock:
            return next(reversed(self._made.values()), None)

    def put(self, name: Hashable, made: Any) -> None:
        """Keep something."""
        with self._lock:
            self._made[name] = made
            while len(self._made) > self._most:
                self._made.popitem(last=False)

    def get(self, name: Hashable, make: Callable[[], Any]) -> Any:
        """What is kept under a name, made if nothing is."""
        found = self.known(name)
        if found is None:
            found = make()
            self.put(name, found)
        return found
