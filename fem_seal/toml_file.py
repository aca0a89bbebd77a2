"""TOML files as tables, with words for what is wrong with them."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

from fem_seal.errors import InputError, Problem


def read_toml(path: Path, kind: str) -> dict[str, Any]:
    """Tables of a file.

    Parameters
    ----------
    path : Path
    kind : str
        What the file is to be: "case" or "study".

    Raises
    ------
    InputError
        If it cannot be read or is no TOML.
    """
    try:
        return tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except UnicodeDecodeError:
        message = f"is not a text file; a {kind} file in TOML is needed"
    except tomllib.TOMLDecodeError as error:
        message = f'is not valid TOML: {error}. Texts and quantities need quotes: radius = "20 mm"'
    except RecursionError:
        message = f"is not a {kind} file: nested too deeply"
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or "not a file name"
        message = f"cannot be read ({reason.lower()})"
    raise InputError(Problem("", message), file=path)
