"""TOML files as tables, with words for what is wrong with them."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

from fem_seal.errors import InputError, Problem
from fem_seal.regular_files import UnreadableFileError, read_text


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
        return tomllib.loads(read_text(path))
    except UnicodeDecodeError:
        message = f"is not a text file; a {kind} file in TOML is needed"
    except tomllib.TOMLDecodeError as error:
        message = f'is not valid TOML: {error}. Texts and quantities need quotes: radius = "20 mm"'
    except RecursionError:
        message = f"is not a {kind} file: nested too deeply"
    except UnreadableFileError as error:
        message = str(error)
    raise InputError(Problem("", message), file=path)
