"""The report as a PDF file, printed by an installed browser."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from fem_seal.errors import DrawingError, OutputError
from fem_seal.files import own_tables, problem

_NAMED = "FEM_SEAL_BROWSER"
# A report takes some two seconds; a browser that starts for the first time a few more [s].
_PATIENCE = 120.0
# Parts and sizes of one page, the first at which everything fits, with letters of 7 pt and more; pages of a PDF file.
_FITS = [(cut, zoom) for cut in ("", " cut", " cut more") for zoom in (1.0, 0.95)]
_PAGES = re.compile(rb"/Type\s*/Page\b")


def find_browser() -> str | None:
    """A browser that prints without a window: that of FEM_SEAL_BROWSER, or Chromium, Chrome, Edge; None without one."""
    browsers: dict[str, list[str]] = own_tables("pictures.toml")["browsers"]
    folders = [Path(os.environ[key]) for key in browsers["below"] if key in os.environ]
    places = [folder / program for folder in folders for program in browsers["on_windows"]]
    installed = [str(place) for place in (*places, *map(Path, browsers["on_mac"])) if place.is_file()]
    return next(
        filter(None, (os.environ.get(_NAMED), *map(shutil.which, browsers["commands"]), *installed)), None
    )


def print_pdf(page: Path, pdf: Path, browser: str | None = None, *, one_page: bool = False) -> Path:
    """Print a page into a PDF file, which replaces an old one when it is complete.

    Parameters
    ----------
    page : pathlib.Path
        HTML file.
    pdf : pathlib.Path
    browser : str, optional
        Program based on Chromium; the one that is found unless given.
    one_page : bool
        Of a report, its beginning and its case alone, on one page.

    Raises
    ------
    DrawingError
        If there is no browser, or it prints nothing.
    OutputError
        If the file cannot be written.
    """
    browser = browser or find_browser()
    if browser is None:
        raise DrawingError(problem("no_browser", page=page, variable=_NAMED))
    # with its own profile, independent of an open browser
    with TemporaryDirectory(prefix="fem-seal-") as folder:
        draft, profile = Path(folder) / "report.pdf", Path(folder) / "profile"
        messages = "" if one_page else _printed(browser, page, draft, profile)
        for cut, zoom in _FITS if one_page else ():
            shrunk = Path(folder) / "page.html"
            how = f'<html class="one-page{cut}" style="zoom: {zoom}" '
            shrunk.write_text(page.read_text(encoding="utf-8").replace("<html ", how, 1), encoding="utf-8")
            messages = _printed(browser, shrunk, draft, profile)
            if not draft.is_file() or len(_PAGES.findall(draft.read_bytes())) == 1:
                break
        if not draft.is_file() or not draft.read_bytes().startswith(b"%PDF"):
            raise DrawingError(problem("nothing_printed", browser=browser, messages=messages, page=page))
        try:
            shutil.copyfile(draft, pdf)
        except OSError as error:
            raise OutputError(
                f"{pdf}: cannot be written ({(error.strerror or str(error)).lower()})"
            ) from None
    return pdf


def _printed(browser: str, page: Path, pdf: Path, profile: Path) -> str:
    """Messages of the browser that may explain why there is no file."""
    command = [
        browser,
        "--headless",
        "--disable-gpu",
        "--no-first-run",
        f"--user-data-dir={profile}",
        "--no-pdf-header-footer",
        f"--print-to-pdf={pdf}",
        page.absolute().as_uri(),
    ]
    # the sandbox of Chromium does not work for root; the page comes from this program
    if sys.platform != "win32" and os.geteuid() == 0:
        command.insert(1, "--no-sandbox")
    try:
        ended = subprocess.run(command, capture_output=True, timeout=_PATIENCE, check=False)
    except subprocess.TimeoutExpired:
        return f" within {_PATIENCE:g} s"
    except OSError as error:
        return f" ({(error.strerror or str(error)).lower()})"
    lines = ended.stderr.decode(errors="replace").strip().splitlines()
    return f" ({lines[-1]})" if lines else ""
