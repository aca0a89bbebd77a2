"""report.html of a study: one page with interactive plots that needs nothing but itself."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fem_seal.arrays import FloatArray
from fem_seal.errors import InputError
from fem_seal.files import write_text
from fem_seal.output.prose import said
from fem_seal.output.report.words import volumes_of_gas
from fem_seal.seal.findings import Level
from fem_seal.seal.readings import WORDS
from fem_seal.studies.designs import SENSITIVITY
from fem_seal.studies.designs_table import (
    LEAK_RATE,
    Designs,
    Sensitivity,
    class_shares,
    other_leak_rates,
    quantiles,
    sensitivities,
)
from fem_seal.studies.page import plots, plots_goals, plots_statistics
from fem_seal.studies.page.display import MOST_POINTS, Display, drawn, short
from fem_seal.studies.store import FILE, open_to_read
from fem_seal.units import leak_rate_text
from fem_seal.version import __version__
from leak.extras import needed

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
    store = open_to_read(folder / FILE)
    try:
        designs, counts, reasons = Designs.read(store), store.counts(), store.reasons()
    finally:
        store.close()
    try:
        return write_text(path, page(designs, counts, reasons))
    except ImportError as error:
        raise InputError.at("report", needed("studies", error)) from None


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


_VERDICTS = {"pass": "keep the requirement", "inconclusive": "inconclusive", "fail": "fail it"}


def _headline(designs: Designs, counts: dict[str, int]) -> str:
    varied = ", ".join(map(Display(designs).title, designs.parameters))
    total = sum(counts.values())
    failed = f", {counts['failed']} failed" if counts["failed"] else ""
    still = f", {counts['open']} not calculated yet" if counts["open"] else ""
    met = f"; {len(designs.feasible)} meet all constraints" if designs.about["constraints"] else ""
    levels = "".join(f"; {count} {level}" for level, count in designs.levels.items())
    levels += "".join(f"; {count} {_VERDICTS[word]}" for word, count in designs.verdicts.items())
    both = ""
    if LEAK_RATE in designs.done and other_leak_rates(designs):
        both = (
            " The leak rate is that of yielding asperities that conserve their volume everywhere (C_pl, as in the "
            "paper); the one of a surface that changes only where it touches is the other end of its interval."
        )
    return f"{total} designs over {varied}: {counts['done']} done{failed}{still}{met}{levels}.{both}"


def _doubts(designs: Designs) -> Iterator[str]:
    """How many designs are outside the theory or doubtful, and what is wrong with the first of each."""
    words = {
        Level.OUTSIDE: "outside the theory, where nothing may be claimed from the numbers",
        Level.DOUBTFUL: "doubtful",
    }
    for level, what in words.items():
        found = designs.worst_reason[designs.validity == str(level)]
        if len(found):
            number, why = found.index[0], found.iloc[0].rstrip(".")
            are = "1 design is" if len(found) == 1 else f"{len(found)} designs are"
            yield f"{are} {what} (design {number}: {why}); the column validity_reasons says why of each"


_BEST = 20
# A search crowds around its goal and Morris's method goes to the ends of all ranges: how many of their designs
# leak how much says nothing about the seal.
_WITHOUT_SHARES = ("search", "morris")


@dataclass(frozen=True)
class Section:
    """A heading with what stands below it; a broad figure is scrolled where the screen is narrow."""

    heading: str
    note: str = ""
    figure: Any = ""
    columns: tuple[str, ...] = ()
    rows: tuple[tuple[str, ...], ...] = ()
    broad: bool = False


def sections(designs: Designs) -> Iterator[Section]:
    """All sections that a study has something to show in.

    Parameters
    ----------
    designs : Designs
    """
    if designs.done.empty:
        return
    display = Display(designs)
    drawn_by_chance = is_drawn(designs)
    if drawn_by_chance:
        # how often it leaks how much is what such a study asks
        yield from _how_often(display)
    yield from _best(display)
    part = ""
    if len(designs.done) > MOST_POINTS:
        part = f"A regular part of the {len(designs.done)} designs is drawn, {len(drawn(designs.done))} of them. "
    yield from _plotted(
        "Pareto front",
        "No other design that meets the constraints beats these in one goal without being worse in the other.",
        plots_goals.pareto_plot(display),
    )
    yield from _plotted("Search", _search_note(designs), plots_goals.search_plot(display))
    yield from _plotted("Map", _crosses(designs), plots.map_plot(display))
    yield from _plotted("Responses over parameters", part + _hollow(designs), plots.response_plot(display))
    yield from _plotted(
        "All designs",
        "Drag along an axis to pick designs, drag axes to sort them. " + part + _incomplete(designs),
        plots.parallel_plot(display),
        broad=True,
    )
    yield from _sensitivity(display)
    if not drawn_by_chance:
        yield from _how_often(display)
    yield _columns(display)


def is_drawn(designs: Designs) -> bool:
    """Whether the designs were drawn from distributions and nothing is looked for among them: a batch of parts.

    Parameters
    ----------
    designs : Designs
    """
    by_chance = any(one["distribution"] for one in designs.about["parameters"])
    looked_for = designs.about["goals"] or designs.kind in (*_WITHOUT_SHARES, *SENSITIVITY)
    return by_chance and not looked_for


def _how_often(display: Display) -> Iterator[Section]:
    designs = display.designs
    if designs.kind not in _WITHOUT_SHARES and LEAK_RATE in designs.done:
        yield from _distribution(display)
        yield from _classes(designs)


def _plotted(heading: str, note: str, figure: Figure | None, *, broad: bool = False) -> Iterator[Section]:
    if figure is not None:
        yield Section(heading, note, _html(figure), broad=broad)


def _html(figure: Figure) -> Any:
    from markupsafe import Markup
    from plotly.io import templates, to_html

    drawn = figure.to_dict()
    # as it is: set on a figure, plotly checks all of it anew, which takes longer than all else of the figure
    drawn["layout"]["template"] = templates["plotly_white"].to_plotly_json()
    return Markup(
        to_html(
            drawn,
            full_html=False,
            include_plotlyjs=False,
            config={"displaylogo": False, "responsive": True},
            validate=False,
        )
    )


def _best(display: Display) -> Iterator[Section]:
    designs = display.designs
    if not designs.about["goals"]:
        return
    numbers, columns = display.best(_BEST)
    left_out = f" {outside_left_out(designs)}." if designs.left_out else ""
    if not numbers:
        none = "No design is left." if left_out else "No design meets all constraints."
        yield Section("Best designs", none + left_out)
        return
    wanted = (
        f"{'small' if designs.sign(name) > 0 else 'large'} {display.title(name)}"
        for name in designs.about["goals"]
    )
    constraints = " and ".join(designs.about["constraints"].values())
    yield Section(
        "Best designs",
        f"Goal: {' and '.join(wanted)}{', with ' + constraints if constraints else ''}.{left_out}",
        columns=("design", *columns),
        rows=tuple(zip(map(str, numbers), *columns.values(), strict=True)),
    )


def outside_left_out(designs: Designs) -> str:
    """How many designs are left out, as a sentence without its point."""
    count = designs.left_out
    are, their = ("design is", "its") if count == 1 else ("designs are", "their")
    return f'{count} {are} left out, {their} numbers being outside the theory (outside_theory = "keep" counts them)'


def _search_note(designs: Designs) -> str:
    two = ", in each goal by itself" if designs.goals.shape[1] == 2 else ""
    without = f", without trials that {designs.why_not_counted}" if designs.some_do_not_count else ""
    return f"The line is the best so far{two}{without}."


def _crosses(designs: Designs) -> str:
    return f"Designs at the crosses {designs.why_not_counted}." if designs.some_do_not_count else ""


def _hollow(designs: Designs) -> str:
    if not designs.some_do_not_count:
        return ""
    return f"Hollow designs {designs.why_not_counted}; point at one to see why."


def _incomplete(designs: Designs) -> str:
    table = drawn(designs.done)
    missing = len(table) - len(plots.complete(table, designs.telling_outputs))
    return f"{missing} designs, which lack one of the columns, are not drawn. " if missing else ""


def _sensitivity(display: Display) -> Iterator[Section]:
    designs = display.designs
    found = sensitivities(designs)
    if not found and designs.kind in SENSITIVITY:
        yield Section("Sensitivity", "Indices need all designs, and every one of them without failure.")
    for one in found:
        if one.output in designs.telling_outputs:
            yield (_morris if one.method == "morris" else _sobol)(display, one)


def _sobol(display: Display, found: Sensitivity) -> Section:
    of, _, _ = plots_statistics.scale(display, found)
    columns = [
        _column(one, found.total) for one in (found.first, found.first_error, found.total, found.total_error)
    ]
    note = ""
    if found.noise.any():
        columns[0] = [
            f"{text} (noise)" if bad else text
            for text, bad in zip(columns[0], found.noise.tolist(), strict=True)
        ]
        note = (
            " No first-order index is above the total one or below zero: one that is, is noise of the sample, which "
            "more designs (design.num) reduce."
        )
    return Section(
        f"Sensitivity of {display.title(found.output)}",
        f"Sobol' indices of {of}: the share of its variance that a parameter explains by itself (first order) and "
        "together with the others (total), over the distributions of the parameters; ± and bars are 95 % confidence "
        f"intervals.{' ln is the natural logarithm.' if found.logarithmic else ''}{note}",
        _html(plots_statistics.sensitivity_plot(display, found)),
        ("parameter", "first order", "±", "total", "±"),
        _ordered(display, found, columns),
    )


def _morris(display: Display, found: Sensitivity) -> Section:
    of, size, unit = plots_statistics.scale(display, found)
    columns = [
        _column(one / size, found.first / size) for one in (found.first, found.first_error, found.total)
    ]
    headings = [f"mean absolute effect{unit}", f"±{unit}", f"its spread{unit}"]
    factor = ""
    if found.logarithmic:
        title = display.title(found.output)
        factor = f" An effect x on {of}, the natural logarithm, multiplies or divides {title} by eˣ."
        columns.append([f"× {short(one, 3)}" for one in np.exp(found.first).tolist()])
        headings.append("mean effect as a factor")
    return Section(
        f"Sensitivity of {display.title(found.output)}",
        f"Elementary effects (Morris) on {of}, over the whole range of each parameter: their mean absolute value, and "
        "their spread, which is zero for a linear effect without interaction; ± and bars are 95 % confidence intervals."
        + factor,
        _html(plots_statistics.sensitivity_plot(display, found)),
        ("parameter", *headings),
        _ordered(display, found, columns),
    )


def _ordered(display: Display, found: Sensitivity, columns: list[list[str]]) -> tuple[tuple[str, ...], ...]:
    rows = list(zip(map(display.title, found.parameters), *columns, strict=True))
    return tuple(rows[n] for n in plots_statistics.order(found))


def _column(values: FloatArray, of: FloatArray) -> list[str]:
    """Numbers as they are written, round-off beside the largest of another column as zero."""
    return [short(value, 3) if abs(value) > 1e-9 * of.max() else "0" for value in values.tolist()]


def _distribution(display: Display) -> Iterator[Section]:
    figure = plots_statistics.distribution_plot(display)
    if figure is None:
        return
    designs = display.designs
    found = quantiles(designs.done[LEAK_RATE].dropna().to_numpy())
    meaning = (
        "a probability as far as the parameters were drawn from their distributions"
        if any(one["distribution"] for one in designs.about["parameters"])
        else "they were chosen and not drawn, so this is no probability"
    )
    leak_rate = f"leak rate{volumes_of_gas(bool(designs.about['seal'].get('gas')))}"
    headings: tuple[str, ...] = ("share of the designs below", leak_rate, "[m³/s]")
    rows: list[tuple[str, ...]] = [
        (f"{100 * share:g} %", leak_rate_text(value), short(value)) for share, value in found.items()
    ]
    other = ""
    for reading, rates in other_leak_rates(designs).items():
        headings += (WORDS[reading].title, "[m³/s]")
        ends = quantiles(rates).values()
        rows = [(*row, leak_rate_text(end), short(end)) for row, end in zip(rows, ends, strict=True)]
        other = f" {said('readings.ends', 'what')}"
    yield Section(
        "Distribution of the leak rate",
        f"Share {_of_calculated(designs)}; {meaning}.{other}",
        _html(figure),
        headings,
        tuple(rows),
    )


def _classes(designs: Designs) -> Iterator[Section]:
    if designs.done[LEAK_RATE].dropna().empty:
        return
    seal, standard, shares = designs.about["seal"], designs.about["standard"], class_shares(designs)
    unclaimed = " Outside the theory no class is claimed." if designs.outside.any() else ""
    if other_leak_rates(designs):
        unclaimed += " A class is met if both readings of asperities that yield meet it."
    base = f"DN {1e3 * seal['nominal_size']:.4g} and {seal['fluid'] or 'the fluid'} of the base case"
    if not shares:
        yield Section(
            "Leakage classes",
            f"No class of {standard} can be judged for {base} by the leak rate alone: {_WHY_NONE}. Another standard "
            "is chosen with report.standard in the study file.",
        )
        return
    yield Section(
        "Leakage classes",
        f"Share {_of_calculated(designs)} that meet each class of {standard}, for {base}.{unclaimed} Classes "
        "say what the leak rate allows; the standard prescribes test pressure and fluid of its own, to which the leak "
        "rates are not converted here. A complete run of a design does so.",
        columns=("class", "allowed leak rate", "share of the designs"),
        rows=tuple(
            (name, leak_rate_text(most) if most else "none", f"{100 * share:.4g} %")
            for name, most, share in shares
        ),
    )


_WHY_NONE = (
    "class V of a liquid depends on the pressure of each design, classes II to IV on the rated capacity of the valve, "
    "and class VI is a test with gas"
)


def _of_calculated(designs: Designs) -> str:
    """Which designs a share is a share of."""
    failed = len(designs.table) - len(designs.done)
    without = f"; {failed} failed {'one' if failed == 1 else 'ones'} not counted" if failed else ""
    outside = int(designs.outside.sum())
    if outside:
        without += f"; {outside} of them outside the theory"
    return f"of {designs.done[LEAK_RATE].notna().sum()} calculated designs{without}"


def _columns(display: Display) -> Section:
    about = display.designs.about
    rows = [
        (name, display.title(name), display.unit(name).name or "–", display.varied(name))
        for name in display.designs.parameters
    ]
    rows += [(name, name, "", text) for name, text in {**about["derived"], **about["constraints"]}.items()]
    return Section(
        "Parameters and formulas",
        "Formulas count in SI units." if len(rows) > len(about["parameters"]) else "",
        columns=("column", "called", "unit", "meaning"),
        rows=tuple(rows),
    )
