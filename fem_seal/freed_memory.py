"""Memory that is free inside the process, given back to the system."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any


@contextmanager
def given_back() -> Iterator[None]:
    """Give back at the end what was used in between and is free again.

    The C library of Linux keeps it in reserve, hundreds of megabytes after a large case; others have no such function
    and need none. It takes some milliseconds.
    """
    try:
        yield
    finally:
        trim = _trim()
        if trim is not None:
            trim(0)


@cache
def _trim() -> Any:
    try:
        return ctypes.CDLL(None).malloc_trim
    except (OSError, AttributeError, TypeError):  # Windows has no library without a name
        return None
