"""report.html of a study: one page with interactive plots that needs nothing but itself."""

from __future__ import annotations

from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path

from fem_seal import __version__
from fem_seal.atomic_files import write_text
from fem_seal.errors import InputError, Problem
from fem_seal.studies.analysis import Designs
from fem_seal.studies.sections import sections
from fem_seal.studies.store import FILE, open_to_read


def write_page(folder: Path, path: Path) -> Path:
    """Write the page of the study in a folder, atomically.

    Parameters
    ----------
    folder, path : Path

    Raises
    ------
    InputError
        If the folder holds no study, or plotly is not installed.
    """
    store = open_to_read(folder / FILE)
    try:
        designs, counts, reasons = Designs.read(store), store.counts(), store.reasons()
    finally:
        store.close()
    try:
        return write_text(path, page(designs, counts, reasons))
    except ImportError as error:
        raise InputError(
            Problem("report", f'needs {error.name}; install it with: pip install "fem-seal[studies]"')
        ) from None


def page(designs: Designs, counts: dict[str, int], reasons: list[tuple[str, int]]) -> str:
    """The page as HTML.

    Parameters
    ----------
    designs : Designs
    counts : dict
        Designs that are done, failed and open.
    reasons : list of (str, int)
        Why designs failed, and how many.
    """
    from jinja2 import Environment, PackageLoader, StrictUndefined
    from markupsafe import Markup
    from plotly.offline import get_plotlyjs

    # Titles, names and reasons come from the user: everything but plotly's own output is escaped.
    environment = Environment(
        loader=PackageLoader("fem_seal"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return environment.get_template("study.html.j2").render(
        title=designs.about["title"] or "Study",
        headline=_headline(designs, counts),
        warnings=[*(f"{times} failed: {reason}" for reason, times in reasons), *_doubts(designs)],
        sections=list(sections(designs)),
        plotly=Markup(get_plotlyjs()),
        version=__version__,
        created=datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
    )


def _headline(designs: Designs, counts: dict[str, int]) -> str:
    varied = ", ".join(designs.parameters)
    total = sum(counts.values())
    failed = f", {counts['failed']} failed" if counts["failed"] else ""
    still = f", {counts['open']} not calculated yet" if counts["open"] else ""
    met = f"; {len(designs.feasible)} meet all constraints" if designs.about["constraints"] else ""
    levels = "".join(f"; {count} {level}" for level, count in designs.levels.items())
    return f"{total} designs over {varied}: {counts['done']} done{failed}{still}{met}{levels}."


def _doubts(designs: Designs) -> Iterator[str]:
    """How many designs are outside the theory, and what is wrong with the first."""
    outside = designs.worst_reason[designs.outside]
    if len(outside):
        number, why = outside.index[0], outside.iloc[0]
        are = "1 design is" if len(outside) == 1 else f"{len(outside)} designs are"
        yield (
            f"{are} outside the theory, where nothing may be claimed from the numbers (design {number}: {why}); the "
            "column validity_reasons says why of each"
        )
