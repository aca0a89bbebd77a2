"""Optional packages: which are missing, and the command that installs them."""

from __future__ import annotations

import re
import sys
from importlib import util
from pathlib import Path

_NAME = "fem-seal"
_EXTRA = re.compile(r"""^([\w.-]+)[^;]*(?:;.*extra\s*==\s*["']([\w-]+)["'])?""")
# Packages that are imported under another name than they are installed.
_IMPORT_NAMES = {"dask": "distributed"}
# What brings all others for those who work on the program itself.
_FOR_DEVELOPERS = ("dev", "docs")


def say_missing(extra: str, error: ImportError | None = None) -> str:
    """What is missing of an extra and how to install it, as the end of a sentence: "needs ...".

    Parameters
    ----------
    extra : str
        Such as "explore".
    error : ImportError, optional
        Why something could not be imported, for when all packages of the extra are there.

    Examples
    --------
    >>> say_missing("explore").startswith("needs ")
    True
    """
    absent = [name for name in _packages().get(extra, ()) if not _is_installed(name)]
    if not absent:
        # it is there and cannot be loaded
        absent = [(error.name or str(error)).split(".")[0] if error is not None else f"the extra {extra}"]
    several = len(absent) > 1
    names = " and ".join(filter(None, [", ".join(absent[:-1]), absent[-1]]))
    are, them = ("are", "them") if several else ("is", "it")
    return f"needs {names}, which {are} not installed; install {them} with: {command(extra)}"


def extra_with(module: str | None) -> str:
    """The extra that brings a module; empty if none does.

    Parameters
    ----------
    module : str or None
        As it is imported; of a part of a package the package counts.

    Examples
    --------
    >>> extra_with("optuna.trial")
    'studies'
    """
    root = (module or "").split(".")[0]
    name = _IMPORT_NAMES.get(root, root).lower()
    extras = (extra for extra, names in _packages().items() if name in (package.lower() for package in names))
    return next(extras, "")


def say_absent(module: str | None) -> str:
    """That a package which a light install leaves out is needed, as the end of a sentence; empty for any other module.

    Parameters
    ----------
    module : str or None
        As it is imported.

    Examples
    --------
    >>> say_absent("json")
    ''
    """
    name = (module or "").split(".")[0]
    if name.lower() not in (package.lower() for package in _packages().get("", ())):
        return ""
    return f"needs {name}, which is not installed; install it with: {_pip_install()} {name}"


def command(extra: str) -> str:
    """The command that installs an extra for this Python, from where the program itself was installed.

    Where that is not known, from an index or a checkout.

    Parameters
    ----------
    extra : str
    """
    pip, source = _pip_install(), _source()
    if source is None:
        return f'{pip} "{_NAME}[{extra}]", or in a checkout pip install ".[{extra}]" in the folder of {_NAME}'
    return f'{pip} "{source}[{extra}]"'


def _pip_install() -> str:
    python = f'"{sys.executable}"' if " " in sys.executable else sys.executable
    return f"{python} -m pip install" if util.find_spec("pip") else f"uv pip install --python {python}"


def _packages() -> dict[str, list[str]]:
    """Names of the packages of each extra; those that the program always has belong to none."""
    # what reads it takes as long as a small command, and is used by nothing else
    from importlib import metadata

    packages: dict[str, list[str]] = {}
    try:
        lines = metadata.requires(_NAME) or []
    except metadata.PackageNotFoundError:
        return packages
    for match in filter(None, map(_EXTRA.match, lines)):
        if match[2] not in _FOR_DEVELOPERS:
            packages.setdefault(match[2] or "", []).append(match[1])
    return packages


def _is_installed(name: str) -> bool:
    from importlib import metadata

    try:
        metadata.distribution(name)
    except metadata.PackageNotFoundError:
        return False
    return True


def _source() -> Path | None:
    """The folder or file that the program was installed from, or in which it stands; None if it is gone."""
    import json
    from importlib import metadata
    from urllib.parse import unquote, urlsplit
    from urllib.request import url2pathname

    checkout = Path(__file__).resolve().parent.parent
    try:
        record = json.loads(metadata.distribution(_NAME).read_text("direct_url.json") or "{}")
    except (metadata.PackageNotFoundError, ValueError):
        record = {}
    url = urlsplit(str(record.get("url", "")))
    if url.scheme == "file":
        path = Path(url2pathname(unquote(url.path) if sys.platform != "win32" else url.path))
        if path.exists():
            return path
    return checkout if (checkout / "pyproject.toml").exists() else None
