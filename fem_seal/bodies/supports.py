"""Supports of a body."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class Supports:
    """How the bodies are held; the bottom of the seat always is, along the axis.

    Parameters
    ----------
    wall : {"free", "fixed"}
        Whether the outer wall of the housing is held radially.
    base, closure_base : {"free", "held"}
        Whether the bottom of the seat, and the top of the closure, is held radially.

    Examples
    --------
    >>> import fem_seal
    >>> fem_seal.Supports().wall
    'free'
    """

    wall: Literal["free", "fixed"] = "free"
    base: Literal["free", "held"] = "free"
    closure_base: Literal["free", "held"] = "free"
