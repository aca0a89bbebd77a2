"""Supports of a body."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class Supports:
    """How the seat is held; its bottom always is, along the axis.

    Parameters
    ----------
    wall : {"free", "fixed"}
        Whether the outer wall of the housing is held radially.

    Examples
    --------
    >>> import fem_seal
    >>> fem_seal.Supports().wall
    'free'
    """

    wall: Literal["free", "fixed"] = "free"
