"""report.html of a study: one page with interactive plots that needs nothing but itself."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fem_seal.answers.judgement import Verdict
from fem_seal.arrays import FloatArray
from fem_seal.errors import InputError
from fem_seal.files import write_text
from fem_seal.seal.findings import Level
from fem_seal.seal.scenarios import SCENARIOS
from fem_seal.studies import designs_table, plots
from fem_seal.studies.designs import SENSITIVITY
from fem_seal.studies.display import DesignDisplay, share_text, short_number
from fem_seal.studies.store import FILE, open_to_read
from fem_seal.version import __version__
from fem_seal.wording import environment
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

    display = DesignDisplay(designs)
    failures = [display.words.failure(times, reason) for reason, times in reasons]
    return (
        environment(display.units, escaped=True)
        .get_template("study/page.html.j2")
        .render(
            title=designs.about["title"] or "Study",
            headline=_headline(display, counts),
            warnings=[*failures, *_doubts(display)],
            sections=list(sections(designs)),
            plotly=Markup(get_plotlyjs()),
            version=__version__,
            created=datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
        )
    )


def _headline(display: DesignDisplay, counts: dict[str, int]) -> str:
    designs, varied = display.designs, list(map(display.title, display.designs.parameters))
    both = designs_table.LEAK_RATE in designs.successes and bool(designs_table.other_leak_rates(designs))
    passed, sealed = passing_words(display), display.sealed_count
    return str(display.words.headline(designs, counts, varied, passed, sealed, both))


def _doubts(display: DesignDisplay) -> Iterator[str]:
    """How many designs are outside the theory or doubtful, and what is wrong with the first of each."""
    designs = display.designs
    for level in (Level.OUTSIDE, Level.DOUBTFUL):
        reasons = designs.worst_reason[designs.validity == str(level)]
        if len(reasons):
            yield display.words.doubt(str(level), len(reasons), reasons.index[0], reasons.iloc[0].rstrip("."))


# A search crowds around its goal and Morris's method goes to the ends of all ranges: how many of their designs
# leak how much says nothing about the seal.
_WITHOUT_SHARES = ("search", "morris")
# Designs in the table.
_MOST_ROWS = 500


@dataclass(frozen=True)
class StudySection:
    """A heading with what stands below it.

    Parameters
    ----------
    heading, note : str
    figure : Markup
    columns, rows : tuple
        Of a table.
    keys : tuple, optional
        By what each cell of a row is sorted where the reader may sort the table, of which only the first rows are open.
    broad : bool
        Whether the figure is scrolled where the screen is narrow.
    folded : bool
    """

    heading: str
    note: str = ""
    figure: Any = ""
    columns: tuple[str, ...] = ()
    rows: tuple[tuple[str, ...], ...] = ()
    keys: tuple[tuple[Any, ...], ...] = ()
    broad: bool = False
    folded: bool = False


def sections(designs: designs_table.Designs) -> Iterator[StudySection]:
    """All sections that a study has something to show in, what it asks first and open.

    Parameters
    ----------
    designs : Designs
    """
    if designs.successes.empty:
        return
    display = DesignDisplay(designs)
    words, count = display.words, len(designs.successes)
    judged = designs_table.PASSES in designs.successes or bool(designs.verdicts)
    of_influence = designs.kind in SENSITIVITY
    # a batch of parts: nothing is looked for among them, and it asks how often it leaks how much
    batch = designs.has_distribution and not designs.about["goals"] and designs.kind not in _WITHOUT_SHARES
    batch &= not of_influence
    table = _table_of_designs(display, folded=not (judged or designs.about["goals"]))
    if not table.folded:
        yield table
    if batch:
        yield from _share_sections(display, folded=False)
    if of_influence:
        yield from _sensitivity_sections(display)
    thin = plots.thin_designs(designs.successes)
    hidden_count = len(thin) - len(plots.complete_rows(thin, designs.informative_outputs))
    note = words.parallel(count, len(thin), hidden_count)
    yield from _plot_section(
        "Parameters and results side by side", note, plots.parallel_plot(display), broad=True
    )
    yield from _plane_section(display)
    title = display.title(plots.main_output(designs)) if plots.main_output(designs) else ""
    note = words.part(count, min(count, plots.MOST_POINTS)) + words.hollow(designs)
    responses = plots.response_plot(display)
    yield from _plot_section(_capital(f"{title} over each parameter"), note, responses, broad=True)
    yield from _plot_section("Pareto front", words.pareto(), plots.pareto_plot(display))
    yield from _plot_section("Search", words.search(designs), plots.search_plot(display))
    if not batch:
        yield from _share_sections(display, folded=True)
    if table.folded:
        yield table
    yield _columns(display)


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]


def _share_sections(display: DesignDisplay, *, folded: bool) -> Iterator[StudySection]:
    designs = display.designs
    if designs.kind not in _WITHOUT_SHARES and designs_table.LEAK_RATE in designs.successes:
        yield from _distribution_section(display, folded=folded)
        yield from _class_section(display, folded=folded)


def _plot_section(
    heading: str, note: str, figure: Figure | None, *, broad: bool = False
) -> Iterator[StudySection]:
    if figure is not None:
        yield StudySection(heading, note.strip(), _html(figure), broad=broad)


def _plane_section(display: DesignDisplay) -> Iterator[StudySection]:
    """The main output over two parameters."""
    figure = plots.plane_plot(display)
    if figure is None:
        return
    designs, (names, rows) = display.designs, plots.plane(display)
    contour = figure.data[0].type == "contour"
    fixed = [name for name in designs.parameters if name not in names] if contour else []
    values = [
        " ".join((display.title(key), *display.texts(rows[:1], key), display.unit(key).name)) for key in fixed
    ]
    chance = share_text(designs.confidence) if designs_table.PASSES in designs.successes else ""
    output = plots.main_output(designs)
    limited = any(map(math.isfinite, display.limits(output)))
    best = _capital(", ".join(value.rstrip() for value in values))
    note, title = display.words.plane(best, chance, limited, contour, designs), display.title(output)
    heading = f"{title} over {' and '.join(map(display.title, names))}"
    yield from _plot_section(_capital(heading), note, figure)


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


def _table_of_designs(display: DesignDisplay, *, folded: bool) -> StudySection:
    """The designs that pass and the best ones first."""
    designs, words = display.designs, display.words
    order = designs.order
    numbers = order[:_MOST_ROWS]
    columns = display.describe(numbers)
    rows = designs.successes.loc[numbers].index
    ranks = {"verdict": [*Verdict], "validity": [*Level]}
    keys = [list[Any](numbers), *(display.numbers(name).loc[rows].tolist() for name in display.columns)]
    for name in list(columns)[len(display.columns) :]:
        keys.append(
            [ranks[name].index(word) if word in ranks[name] else len(ranks[name]) for word in columns[name]]
        )
    titles = list(map(display.title, designs.about["goals"]))
    note = words.best(designs, titles, edge_sentence(display)) + words.rows(len(order), len(numbers))
    return StudySection(
        "Best designs" if designs.about["goals"] else "Designs",
        note.strip(),
        columns=("design", *columns),
        rows=tuple(zip(map(str, numbers), *columns.values(), strict=True)),
        keys=tuple(zip(*keys, strict=True)),
        folded=folded,
    )


def passing_words(display: DesignDisplay) -> str:
    """How many designs pass often enough, or which does most often, as a sentence; empty where nobody asks."""
    designs = display.designs
    if designs_table.PASSES not in designs.successes or designs.successes.empty:
        return ""
    chances, limit = designs.successes[designs_table.PASSES], designs.limit
    allowed = display.units.quantity(limit, "given flow") if limit else ""
    count, unknown = int((chances >= designs.confidence).sum()), int(chances.isna().sum())
    beyond_theory = int((chances.isna() & designs.is_outside).sum()) == unknown
    best, row = share_text(float(chances.max())), chances.nlargest(1).index
    inputs = [
        (display.title(key), *display.texts(row, key), display.unit(key).name) for key in designs.parameters
    ]
    which = ", ".join(" ".join(words).rstrip() for words in inputs)
    confidence = f"{100.0 * designs.confidence:g} %"
    return str(
        display.words.passed(count, len(chances), allowed, confidence, unknown, best, which, beyond_theory)
    )


def edge_sentence(display: DesignDisplay) -> str:
    """Which ranges end where the best design is, as a sentence; empty where none does."""
    return str(display.words.at_edge(list(map(display.title, display.designs.parameters_at_edge))))


def _sensitivity_sections(display: DesignDisplay) -> Iterator[StudySection]:
    """Those of the main output open."""
    designs = display.designs
    indices = designs_table.sensitivities(designs)
    if not indices:
        yield StudySection("Sensitivity", display.words.indices_missing())
    for index in sorted(indices, key=lambda index: index.output != plots.main_output(designs)):
        if index.output in designs.informative_outputs:
            yield _index_section(display, index)


def _index_section(display: DesignDisplay, index: designs_table.Sensitivity) -> StudySection:
    of, size, unit = plots.scale(display, index)
    title, noise = display.title(index.output), index.noise.tolist()
    if index.method == "morris":
        note = display.words.morris(of, index.logarithmic, title)
    else:
        note = display.words.sobol(of, index.logarithmic, any(noise))
    headings = display.words.sensitivity_columns(index.method, unit).split(" | ")
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
        folded=index.output != plots.main_output(display.designs),
    )


def _column(values: FloatArray, of: FloatArray) -> list[str]:
    """Numbers as they are written, round-off beside the largest of another column as zero."""
    return [short_number(value, 3) if abs(value) > 1e-9 * of.max() else "0" for value in values.tolist()]


def _distribution_section(display: DesignDisplay, *, folded: bool) -> Iterator[StudySection]:
    figure = plots.distribution_plot(display)
    if figure is None:
        return
    designs = display.designs
    by_share = designs_table.quantiles(designs.successes[designs_table.LEAK_RATE].dropna().to_numpy())
    seal = designs.about["seal"]
    leak_rate = display.words.leak_rate(seal.get("gas") and not seal.get("throughputs"))
    share = display.words.share(designs.has_distribution)
    headings: tuple[str, ...] = (f"{share.lower()} below", leak_rate, "[m³/s]")
    rates = tuple(by_share.values())
    rows: list[tuple[str, ...]] = [
        (f"{100 * share:g} %", display.units.leak_range(value, beside=rates), short_number(value))
        for share, value in by_share.items()
    ]
    note = ""
    for name, others in designs_table.other_leak_rates(designs).items():
        headings += (SCENARIOS[name].title, "[m³/s]")
        ends = tuple(designs_table.quantiles(others).values())
        texts = [display.units.leak_range(end, beside=(*rates, *ends)) for end in ends]
        rows = [(*row, text, short_number(end)) for row, text, end in zip(rows, texts, ends, strict=True)]
        note = display.words.bounds()
    yield StudySection(
        f"{share} by leak rate",
        display.words.distribution(_design_counts(designs), note),
        _html(figure),
        headings,
        tuple(rows),
        folded=folded,
    )


def _class_section(display: DesignDisplay, *, folded: bool) -> Iterator[StudySection]:
    designs = display.designs
    if designs.successes[designs_table.LEAK_RATE].dropna().empty:
        return
    shares, both = designs_table.class_shares(designs), bool(designs_table.other_leak_rates(designs))
    yield StudySection(
        "Leakage classes",
        display.words.classes(designs.about, _design_counts(designs), bool(shares), both),
        columns=("class", "allowed leak rate", display.words.share(designs.has_distribution).lower()),
        rows=tuple(
            (name, display.units.leak_rate(limit), f"{100 * share:.4g} %") for name, limit, share in shares
        ),
        folded=folded,
    )


def _design_counts(designs: designs_table.Designs) -> tuple[int, int, int]:
    """Designs that shares are shares of, those that failed, and those of the former outside the theory."""
    count = int(designs.successes[designs_table.LEAK_RATE].notna().sum())
    return count, len(designs.table) - len(designs.successes), int(designs.is_outside.sum())


def _columns(display: DesignDisplay) -> StudySection:
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
        folded=True,
    )
