"""Meshes and condensed bodies that one file of tests asks for again and again, made once.

They follow from what they are made of, which is the key, byte by byte: what is made anew by other code has the same
bytes only where the same thing was asked for.
"""

from __future__ import annotations

import hashlib
import pickle
from collections import OrderedDict
from collections.abc import Callable, Hashable
from functools import wraps
from typing import Any

import pytest

# Of each kind; factors of a body take tens of megabytes.
MOST = 8


class MadeOnce:
    """Functions that give again what they gave for the same arguments."""

    def __init__(self) -> None:
        self.keeps = True
        self._kept: dict[str, OrderedDict[Hashable, Any]] = {}

    def patch(self, patch: pytest.MonkeyPatch) -> None:
        """Meshes, bodies before and after their factorisation, and what is factorised of them around the axis."""
        for name in ("meshes.build.triangulate", "fem_seal.contact.model.held_body"):
            self._patch(patch, name, lambda *asked: hashlib.sha256(pickle.dumps(asked)).digest())
        for name in ("fem_seal.contact.model._condense_body", "fem_seal.contact.model.harmonic_body"):
            # of things that are kept here themselves
            self._patch(patch, name, id)

    def forget(self) -> None:
        """Make everything anew."""
        self._kept.clear()

    def _patch(self, patch: pytest.MonkeyPatch, name: str, key_of: Callable[..., Hashable]) -> None:
        module, function = name.rsplit(".", 1)
        make = getattr(_module(module), function)

        @wraps(make)
        def made_once(*asked: Any) -> Any:
            if not self.keeps:
                return make(*asked)
            kept, key = self._kept.setdefault(name, OrderedDict()), key_of(*asked)
            # asked from several threads
            found = kept.get(key)
            if found is not None:
                return found[1]
            made = make(*asked)
            # with what was asked for, so that nothing else gets its id
            kept[key] = asked, made
            while len(kept) > MOST:
                kept.popitem(last=False)
            return made

        patch.setattr(_module(module), function, made_once)


def _module(name: str) -> Any:
    import importlib

    return importlib.import_module(name)
