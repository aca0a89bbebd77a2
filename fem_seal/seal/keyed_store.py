"""A store of the latest calculations, such as bodies and tables of a few designs."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable
from threading import RLock
from typing import Any


class KeyedStore:
    """The latest calculations, each under its key.

    Parameters
    ----------
    size : int
        So many are kept.

    Examples
    --------
    >>> store = KeyedStore(2)
    >>> [store.get(number, lambda number=number: 10 * number) for number in (1, 2, 3)]
    [10, 20, 30]
    >>> store.find(1) is None, store.find(3)
    (True, 30)
    """

    def __init__(self, size: int) -> None:
        self._size = size
        self._values: OrderedDict[Hashable, Any] = OrderedDict()
        self._lock = RLock()

    def find(self, key: Hashable) -> Any:
        """The value of a key; None if there is none."""
        with self._lock:
            if key in self._values:
                self._values.move_to_end(key)
            return self._values.get(key)

    @property
    def latest_value(self) -> Any:
        """What was asked for last; None in an empty store."""
        with self._lock:
            return next(reversed(self._values.values()), None)

    def put(self, key: Hashable, value: Any) -> None:
        """Keep a value."""
        with self._lock:
            self._values[key] = value
            while len(self._values) > self._size:
                self._values.popitem(last=False)

    def get(self, key: Hashable, make: Callable[[], Any]) -> Any:
        """The value of a key, made if there is none."""
        value = self.find(key)
        if value is None:
            value = make()
            self.put(key, value)
        return value
