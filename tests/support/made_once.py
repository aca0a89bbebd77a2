"""Meshes and condensed bodies that one file of tests asks for again and again, made once.

They follow from what they are made of, which is the key, byte by byte: what is made anew by other code has the same
bytes only where the same thing was asked for.
"""

from __future__ import annotations

import hashlib
import pickle
from collections import OrderedDict
from collections.abc import Callable, Hashable
from dataclasses import fields, is_dataclass
from functools import wraps
from io import BytesIO
from typing import Any

import pytest

# Of each kind; factors of a body take tens of megabytes.
MOST = 12


class MadeOnce:
    """Functions that give again what they gave for the same arguments."""

    def __init__(self) -> None:
        self.keeps = True
        self._kept: dict[str, OrderedDict[Hashable, Any]] = {}

    def patch(self, patch: pytest.MonkeyPatch) -> None:
        """Meshes, bodies before and after their factorisation, and what is factorised of them around the axis."""
        for name in ("meshes.meshing.triangulate", "fem_seal.contact.model.constrained_body"):
            self._patch(patch, name, _bytes_of)
        for name in ("fem_seal.contact.model._condense_body", "fem_seal.contact.model.HarmonicBody"):
            # of things that are kept here themselves
            self._patch(patch, name, id)

    def forget(self) -> None:
        """Make everything anew."""
        self._kept.clear()

    def _patch(self, patch: pytest.MonkeyPatch, name: str, key_of: Callable[..., Hashable]) -> None:
        module, function = name.rsplit(".", 1)
        make = getattr(_module(module), function)

        @wraps(make)
        def made_once(*arguments: Any) -> Any:
            if not self.keeps:
                return make(*arguments)
            store, key = self._kept.setdefault(name, OrderedDict()), key_of(*arguments)
            # asked from several threads
            value = store.get(key)
            if value is not None:
                return value[1]
            value = make(*arguments)
            # with what was asked for, so that nothing else gets its id
            store[key] = arguments, value
            while len(store) > MOST:
                store.popitem(last=False)
            return value

        patch.setattr(_module(module), function, made_once)


class _Fields(pickle.Pickler):
    """Dataclasses by their fields, without what they have remembered since they were made."""

    def reducer_override(self, thing: Any) -> Any:
        if not is_dataclass(thing) or isinstance(thing, type):
            return NotImplemented
        return type(thing), tuple(getattr(thing, field.name) for field in fields(thing))


def _bytes_of(*arguments: Any) -> bytes:
    into = BytesIO()
    pickler = _Fields(into, pickle.HIGHEST_PROTOCOL)
    # two things that are equal have the same bytes as one thing that stands there twice
    pickler.fast = True
    pickler.dump(arguments)
    return hashlib.sha256(into.getbuffer()).digest()


def _module(name: str) -> Any:
    import importlib

    return importlib.import_module(name)
