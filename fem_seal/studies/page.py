"""report.html of a study: one page with interactive plots that needs nothing but itself."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fem_seal import __version__
from fem_seal.atomic_files import write_text
from fem_seal.errors import InputError, Problem
from fem_seal.readable import flow
from fem_seal.studies import plots
from fem_seal.studies.analysis import LEAK_RATE, Designs, class_shares, quantiles
from fem_seal.studies.display import Display
from fem_seal.studies.sensitivity import sensitivities
from fem_seal.studies.store import FILE, open_to_read

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

_BEST = 20


@dataclass(frozen=True)
class Section:
    """A heading with what stands below it."""

    heading: str
    note: str = ""
    figure: Any = ""
    columns: tuple[str, ...] = ()
    rows: tuple[tuple[str, ...], ...] = ()


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
        warnings=[f"{times} failed: {reason}" for reason, times in reasons],
        sections=list(_sections(designs)),
        plotly=Markup(get_plotlyjs()),
        version=__version__,
        created=datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
    )


def _headline(designs: Designs, counts: dict[str, int]) -> str:
    varied = ", ".join(one["name"] for one in designs.about["parameters"])
    total = sum(counts.values())
    failed = f", {counts['failed']} failed" if counts["failed"] else ""
    still = f", {counts['open']} not calculated yet" if counts["open"] else ""
    met = f"; {len(designs.feasible)} meet all constraints" if designs.about["constraints"] else ""
    return f"{total} designs over {varied}: {counts['done']} done{failed}{still}{met}."


def _sections(designs: Designs) -> Iterator[Section]:
    if designs.done.empty:
        return
    yield from _best(designs)
    part = ""
    if len(designs.done) > plots.MOST_POINTS:
        part = f"A regular part of the {len(designs.done)} designs is drawn, {len(plots.drawn(designs.done))} of them."
    yield from _plotted("Search", "", plots.history_plot(designs))
    yield from _plotted("Pareto front", _pareto_note(designs), plots.pareto_plot(designs))
    yield from _plotted("Map", "", plots.map_plot(designs))
    yield from _plotted("Responses over parameters", part, plots.response_plot(designs))
    yield from _plotted(
        "All designs",
        "Drag along an axis to pick designs, drag axes to sort them. " + part,
        plots.parallel_plot(designs),
    )
    yield from _sensitivity(designs)
    yield from _distribution(designs)
    yield from _classes(designs)
    yield _columns(designs)


def _plotted(heading: str, note: str, figure: Figure | None) -> Iterator[Section]:
    if figure is not None:
        yield Section(heading, note, _html(figure))


def _html(figure: Figure) -> Any:
    from markupsafe import Markup

    return Markup(figure.to_html(full_html=False, include_plotlyjs=False, config={"displaylogo": False}))


def _best(designs: Designs) -> Iterator[Section]:
    numbers = designs.best(_BEST)
    if not numbers:
        if designs.about["goals"]:
            yield Section("Best designs", "No design meets all constraints.")
        return
    columns = [str(name) for name in designs.table if name not in ("status", "reason")]
    rows, display = designs.table.loc[numbers, columns], Display(designs)
    shown = zip(*(display.values(rows, name) for name in columns), strict=True)
    note = "Goal: " + " and ".join(_goal(designs, name) for name in designs.about["goals"])
    constraints = " and ".join(designs.about["constraints"].values())
    yield Section(
        "Best designs",
        f"{note}{', with ' + constraints if constraints else ''}.",
        columns=("design", *(display.label(name) for name in columns)),
        rows=tuple(
            (str(number), *(_cell(value) for value in row))
            for number, row in zip(numbers, shown, strict=True)
        ),
    )


def _goal(designs: Designs, name: str) -> str:
    return f"{'small' if designs.about['goals'][name] == name else 'large'} {name}"


def _pareto_note(designs: Designs) -> str:
    return (
        "No other design that meets the constraints beats these in one goal without being worse in the other."
    )


def _sensitivity(designs: Designs) -> Iterator[Section]:
    found = sensitivities(designs)
    if not found and designs.about["design"]["kind"] in ("sobol-sensitivity", "morris"):
        yield Section("Sensitivity", "Indices need all designs, and every one of them without failure.")
    for one in found:
        of = f"the logarithm of {one.output}" if one.logarithmic else one.output
        if one.method == "sobol-sensitivity":
            note = (
                f"Sobol' indices of {of}: the share of its variance that a parameter explains by itself (first order) "
                "and together with the others (total); bars are 95 % confidence intervals."
            )
            columns = ("parameter", "first order", "±", "total", "±")
        else:
            note = (
                f"Elementary effects (Morris) on {of}, over the whole range of each parameter: their mean absolute "
                "value, and their spread, which is zero for a linear effect without interaction."
            )
            columns = ("parameter", "mean absolute effect", "±", "its spread", "")
        rows = tuple(
            (
                name,
                *(f"{value:.3g}" for value in (first, first_error, total)),
                f"{error:.3g}" if error else "",
            )
            for name, first, first_error, total, error in zip(
                one.parameters, one.first, one.first_error, one.total, one.total_error, strict=True
            )
        )
        yield Section(f"Sensitivity of {one.output}", note, _html(plots.sensitivity_plot(one)), columns, rows)


def _distribution(designs: Designs) -> Iterator[Section]:
    figure = plots.distribution_plot(designs)
    if figure is None:
        return
    found = quantiles(designs.done[LEAK_RATE].dropna().to_numpy())
    yield Section(
        "Distribution of the leak rate",
        "Over the designs as they were drawn; a probability where the parameters were drawn from their distributions.",
        _html(figure),
        ("share of the designs below", "leak rate", "[m³/s]"),
        tuple((f"{100 * share:g} %", flow(value), f"{value:.4g}") for share, value in found.items()),
    )


def _classes(designs: Designs) -> Iterator[Section]:
    shares = class_shares(designs)
    if shares:
        seal = designs.about["seal"]
        yield Section(
            "Leakage classes",
            f"Share of the designs that meet each class of {designs.about['standard']}, for DN "
            f"{1e3 * seal['nominal_size']:.4g} of the base case and {seal['fluid']}. Classes say what the leak rate "
            "allows; the standard prescribes test pressure and fluid of its own.",
            columns=("class", "allowed leak rate", "share of the designs"),
            rows=tuple((name, flow(most), f"{100 * share:.4g} %") for name, most, share in shares),
        )


def _columns(designs: Designs) -> Section:
    rows = [(one["name"], one["unit"] or "–", _varied(one)) for one in designs.about["parameters"]]
    rows += [(name, "", text) for name, text in designs.about["derived"].items()]
    rows += [(name, "", text) for name, text in designs.about["constraints"].items()]
    return Section("Parameters and formulas", "", columns=("column", "unit", "meaning"), rows=tuple(rows))


def _varied(parameter: dict[str, Any]) -> str:
    low, high = parameter["bounds"]
    if parameter["distribution"]:
        return f"{parameter['distribution'].lower()} from {low:.4g} to {high:.4g}"
    if parameter["numeric"]:
        return f"{len(parameter['levels'])} levels from {low:.4g} to {high:.4g}"
    return ", ".join(str(level) for level in parameter["levels"][:10])


def _cell(value: object) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if value is None:
        return "–"
    return f"{value:.5g}" if isinstance(value, float) else str(value)
