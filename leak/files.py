"""Tables of numbers and words that are part of the program, in TOML files beside its rooms."""

from __future__ import annotations

import tomllib
from importlib.resources import files
from typing import Any


def own_tables(room: str, name: str) -> dict[str, Any]:
    """Tables of a TOML file in a room.

    Parameters
    ----------
    room, name : str
        Such as "leak.fluids" and "library.toml".
    """
    return tomllib.loads(files(room).joinpath(name).read_text(encoding="utf-8"))
