"""report.html of a study: one page with interactive plots that needs nothing but itself."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fem_seal import units
from fem_seal.arrays import FloatArray
from fem_seal.errors import InputError
from fem_seal.files import own_tables, write_text
from fem_seal.output.prose import phrase, template
from fem_seal.output.report.words import volumes_of_gas
from fem_seal.seal.findings import Level
from fem_seal.seal.scenarios import SCENARIOS
from fem_seal.studies import designs_table, plots
from fem_seal.studies.designs import SENSITIVITY
from fem_seal.studies.display import LOOKS, Display, share_text, short_number
from fem_seal.studies.store import FILE, open_to_read
from fem_seal.units import Unit, format_quantity, leak_range_text, leak_rate_text, shown_in
from fem_seal.version import __version__
from leak.extras import say_missing

if TYPE_CHECKING:
    from plotly.graph_objects import Figure


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
    with closing(open_to_read(folder / FILE)) as store:
        designs, counts, reasons = designs_table.Designs.read(store), store.counts(), store.reasons()
    try:
        return write_text(path, page(designs, counts, reasons))
    except ImportError as error:
        raise InputError.at("report", say_missing("studies", error)) from None


def page(designs: designs_table.Designs, counts: dict[str, int], reasons: list[tuple[str, int]]) -> str:
    """The page as HTML.

    Parameters
    ----------
    designs : Designs
    counts : dict
        Designs that are done, failed and open.
    reasons : list of (str, int)
        Why designs failed, and how many.
    """
    from markupsafe import Markup
    from plotly.offline import get_plotlyjs

    seal = designs.about["seal"]
    of_flow = Unit(*seal["leak_rate_unit"]) if seal.get("leak_rate_unit") else None
    with shown_in(
        units.Display(designs.about.get("units") or "field", seal.get("throughputs", False), of_flow)
    ):
        return template("study.html.j2").render(
            title=designs.about["title"] or "Study",
            headline=_headline(designs, counts),
            warnings=[*(f"{times} failed: {reason}" for reason, times in reasons), *_doubts(designs)],
            sections=list(sections(designs)),
            plotly=Markup(get_plotlyjs()),
            version=__version__,
            created=datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
        )


def _words() -> Any:
    """What the page says, macro by macro."""
    return template("study.words.j2", escaped=False).module


def _headline(designs: designs_table.Designs, counts: dict[str, int]) -> str:
    both = designs_table.LEAK_RATE in designs.successes and bool(designs_table.other_leak_rates(designs))
    titles = list(map(Display(designs).title, designs.parameters))
    return str(_words().headline(designs, counts, titles, both))


def _doubts(designs: designs_table.Designs) -> Iterator[str]:
    """How many designs are outside the theory or doubtful, and what is wrong with the first of each."""
    for level in (Level.OUTSIDE, Level.DOUBTFUL):
        reasons = designs.worst_reason[designs.validity == str(level)]
        if len(reasons):
            yield _words().doubt(str(level), len(reasons), reasons.index[0], reasons.iloc[0].rstrip("."))


_BEST = 20
# A search crowds around its goal and Morris's method goes to the ends of all ranges: how many of their designs
# leak how much says nothing about the seal.
_WITHOUT_SHARES = ("search", "morris")


@dataclass(frozen=True)
class StudySection:
    """A heading with what stands below it; a broad figure is scrolled where the screen is narrow.

    Rows from `first` on are folded under a summary.
    """

    heading: str
    note: str = ""
    figure: Any = ""
    columns: tuple[str, ...] = ()
    rows: tuple[tuple[str, ...], ...] = ()
    broad: bool = False
    first: int | None = None
    summary: str = ""


def sections(designs: designs_table.Designs) -> Iterator[StudySection]:
    """All sections that a study has something to show in.

    Parameters
    ----------
    designs : Designs
    """
    if designs.successes.empty:
        return
    display = Display(designs)
    yield from _passing_section(display)
    # a batch of parts: nothing is looked for among them
    is_search = designs.about["goals"] or designs.kind in (*_WITHOUT_SHARES, *SENSITIVITY)
    batch = designs.has_distribution and not is_search
    if batch:
        # how often it leaks how much is what such a study asks
        yield from _share_sections(display)
    yield from _best_section(display)
    words, table, part = _words(), plots.thin_designs(designs.successes), ""
    if len(designs.successes) > plots.MOST_POINTS:
        part = f"{words.part(len(designs.successes), len(table))} "
    part += words.sealed(display.sealed_count)
    hidden_count = len(table) - len(plots.complete_rows(table, designs.informative_outputs))
    parallel = words.parallel(part, hidden_count)
    note = f" {words.sealed(display.sealed_count)}".rstrip()
    yield from _plot_section("Pareto front", f"{words.pareto()}{note}", plots.pareto_plot(display))
    yield from _plot_section("Search", words.search(designs), plots.search_plot(display))
    line = share_text(designs.confidence) if designs_table.PASSES in designs.successes else ""
    yield from _plot_section("Map", words.crosses(designs, line), plots.map_plot(display))
    # two menus side by side
    responses = plots.response_plot(display)
    yield from _plot_section("Responses over parameters", part + words.hollow(designs), responses, broad=True)
    yield from _plot_section("All designs", parallel, plots.parallel_plot(display), broad=True)
    yield from _sensitivity_sections(display)
    if not batch:
        yield from _share_sections(display)
    yield _columns(display)


def _share_sections(display: Display) -> Iterator[StudySection]:
    designs = display.designs
    if designs.kind not in _WITHOUT_SHARES and designs_table.LEAK_RATE in designs.successes:
        yield from _distribution_section(display)
        yield from _class_section(designs)


def _plot_section(
    heading: str, note: str, figure: Figure | None, *, broad: bool = False
) -> Iterator[StudySection]:
    if figure is not None:
        yield StudySection(heading, note, _html(figure), broad=broad)


def _html(figure: Figure) -> Any:
    from markupsafe import Markup
    from plotly.io import templates, to_html

    content = figure.to_dict()
    # as it is: set on a figure, plotly checks all of it anew, which takes longer than all else of the figure
    content["layout"]["template"] = templates["plotly_white"].to_plotly_json()
    return Markup(
        to_html(
            content,
            full_html=False,
            include_plotlyjs=False,
            config={"displaylogo": False, "responsive": True},
            validate=False,
        )
    )


def _best_section(display: Display) -> Iterator[StudySection]:
    designs = display.designs
    if not designs.about["goals"]:
        return
    numbers, columns = display.describe_best(_BEST)
    titles = list(map(display.title, designs.about["goals"]))
    note = _words().best(designs, titles, bool(numbers), edge_sentence(display))
    yield _table_of("Best designs", note, numbers, columns)


def _table_of(heading: str, note: str, numbers: list[int], columns: dict[str, list[str]]) -> StudySection:
    """Some designs, a row each, with columns by their labels."""
    rows = tuple(zip(map(str, numbers), *columns.values(), strict=True))
    return StudySection(heading, note, columns=("design", *columns), rows=rows)


# Designs in the table of how likely each passes.
_MOST_ROWS, _FEW_ROWS = 500, 10


def _passing_section(display: Display) -> Iterator[StudySection]:
    """Which designs keep the requirement often enough, the likeliest first."""
    designs = display.designs
    if designs_table.PASSES not in designs.successes:
        return
    chances = designs.successes[designs_table.PASSES].sort_values(ascending=False, kind="stable")
    numbers = chances.index[:_MOST_ROWS].tolist()
    note = _words().passing(passing_words(display), len(chances), len(numbers))
    count = int((chances >= designs.confidence).sum())
    table = _table_of("Designs that pass", note, numbers, display.describe(numbers))
    # without one that passes the likeliest
    first = min(count or _FEW_ROWS, len(numbers))
    yield replace(table, first=first, summary=_words().others(len(numbers) - first))


def passing_words(display: Display) -> str:
    """How many designs pass often enough, or which does most often, as a sentence; empty where nobody asks."""
    designs = display.designs
    if designs_table.PASSES not in designs.successes or designs.successes.empty:
        return ""
    chances, limit = designs.successes[designs_table.PASSES], designs.limit
    limits = f" less than {format_quantity('flow', limit)}" if limit else ""
    count, unknown = int((chances >= designs.confidence).sum()), int(chances.isna().sum())
    beyond_theory = int((chances.isna() & designs.is_outside).sum()) == unknown
    best, row = share_text(float(chances.max())), chances.nlargest(1).index
    inputs = [
        (display.title(key), *display.texts(row, key), display.unit(key).name) for key in designs.parameters
    ]
    which = ", ".join(" ".join(words).rstrip() for words in inputs)
    confidence = f"{100.0 * designs.confidence:g} %"
    return str(_words().passed(count, len(chances), limits, confidence, unknown, best, which, beyond_theory))


def edge_sentence(display: Display) -> str:
    """Which ranges end where the best design is, as a sentence; empty where none does."""
    return str(_words().at_edge(list(map(display.title, display.designs.parameters_at_edge))))


def left_out_sentence(designs: designs_table.Designs) -> str:
    """How many designs are left out, as a sentence without its point."""
    return str(_words().outside_left_out(designs.left_out))


def _sensitivity_sections(display: Display) -> Iterator[StudySection]:
    designs = display.designs
    indices = designs_table.sensitivities(designs)
    if not indices and designs.kind in SENSITIVITY:
        yield StudySection("Sensitivity", _words().indices_missing())
    for index in indices:
        if index.output in designs.informative_outputs:
            yield _index_section(display, index)


def _index_section(display: Display, index: designs_table.Sensitivity) -> StudySection:
    of, size, unit = plots.scale(display, index)
    title, noise = display.title(index.output), index.noise.tolist()
    if index.method == "morris":
        note = _words().morris(of, index.logarithmic, title)
    else:
        note = _words().sobol(of, index.logarithmic, any(noise))
    words = own_tables(LOOKS)["sensitivity"][index.method]
    headings = [heading.format(unit=unit) for heading in words["headings"]]
    values = (index.first, index.first_error, index.total, index.total_error)[: len(headings)]
    columns = [_column(column / size, index.influence / size) for column in values]
    columns[0] = [f"{text} (noise)" if bad else text for text, bad in zip(columns[0], noise, strict=True)]
    if index.method == "morris" and index.logarithmic:
        columns.append([f"× {short_number(factor, 3)}" for factor in np.exp(index.first).tolist()])
        headings.append("mean effect as a factor")
    rows = list(zip(map(display.title, index.parameters), *columns, strict=True))
    return StudySection(
        f"Sensitivity of {title}",
        note,
        _html(plots.sensitivity_plot(display, index)),
        ("parameter", *headings),
        tuple(rows[n] for n in index.order),
    )


def _column(values: FloatArray, of: FloatArray) -> list[str]:
    """Numbers as they are written, round-off beside the largest of another column as zero."""
    return [short_number(value, 3) if abs(value) > 1e-9 * of.max() else "0" for value in values.tolist()]


def _distribution_section(display: Display) -> Iterator[StudySection]:
    figure = plots.distribution_plot(display)
    if figure is None:
        return
    designs = display.designs
    by_share = designs_table.quantiles(designs.successes[designs_table.LEAK_RATE].dropna().to_numpy())
    seal = designs.about["seal"]
    leak_rate = f"leak rate{volumes_of_gas(seal.get('gas') and not seal.get('throughputs'))}"
    headings: tuple[str, ...] = ("share of the designs below", leak_rate, "[m³/s]")
    rates = tuple(by_share.values())
    rows: list[tuple[str, ...]] = [
        (f"{100 * share:g} %", leak_range_text(value, beside=rates), short_number(value))
        for share, value in by_share.items()
    ]
    note = ""
    for name, others in designs_table.other_leak_rates(designs).items():
        headings += (SCENARIOS[name].title, "[m³/s]")
        ends = tuple(designs_table.quantiles(others).values())
        texts = [leak_range_text(end, beside=(*rates, *ends)) for end in ends]
        rows = [(*row, text, short_number(end)) for row, text, end in zip(rows, texts, ends, strict=True)]
        note = phrase("interval.ends", "what")
    yield StudySection(
        "Distribution of the leak rate",
        _words().distribution(_design_counts(designs), designs.has_distribution, note),
        _html(figure),
        headings,
        tuple(rows),
    )


def _class_section(designs: designs_table.Designs) -> Iterator[StudySection]:
    if designs.successes[designs_table.LEAK_RATE].dropna().empty:
        return
    shares, both = designs_table.class_shares(designs), bool(designs_table.other_leak_rates(designs))
    yield StudySection(
        "Leakage classes",
        _words().classes(designs.about, _design_counts(designs), bool(shares), both),
        columns=("class", "allowed leak rate", "share of the designs"),
        rows=tuple((name, leak_rate_text(limit), f"{100 * share:.4g} %") for name, limit, share in shares),
    )


def _design_counts(designs: designs_table.Designs) -> tuple[int, int, int]:
    """Designs that shares are shares of, those that failed, and those of the former outside the theory."""
    count = int(designs.successes[designs_table.LEAK_RATE].notna().sum())
    return count, len(designs.table) - len(designs.successes), int(designs.is_outside.sum())


def _columns(display: Display) -> StudySection:
    about = display.designs.about
    rows = [
        (name, display.title(name), display.unit(name).name or "–", display.values_text(name))
        for name in display.designs.parameters
    ]
    rows += [(name, name, "", text) for name, text in {**about["derived"], **about["constraints"]}.items()]
    return StudySection(
        "Parameters and formulas",
        "Formulas count in SI units." if len(rows) > len(about["parameters"]) else "",
        columns=("column", "called", "unit", "meaning"),
        rows=tuple(rows),
    )
