"""Style of the pictures: size, type, colours, units on the axes, SVG for the page."""

from __future__ import annotations

import base64
import colorsys
import math
import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from io import BytesIO
from typing import TYPE_CHECKING, Any, Literal, cast

import numpy as np
from numpy.typing import ArrayLike

from fem_seal.errors import printable
from fem_seal.files import own_tables
from fem_seal.output.pictures.colours import BLUE
from fem_seal.units import Display, superscript
from fem_seal.wording import say

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from fem_seal.arrays import FloatArray
    from fem_seal.seal.load_result import LoadAxis

# Widths of pictures [inch]; the letters of a narrow one can be read on a telephone.
WIDTH, NARROW = 10.4, 5.6
# Points to an inch.
INCH = 72.0
# Resolution of images in a drawing [1/inch].
_DOTS = 170
# Space for tick labels and axis labels [inch].
_LEFT, _BOTTOM = 0.68, 0.52
# Largest number of numbered dots, and smallest distance of two numbers [pt].
_NUMBERED_DOTS, _NUMBERS_APART = 12, 10.0
# Every desktop has at least one of these fonts; matplotlib measures texts with the first.
_FONTS = "'DejaVu Sans', Verdana, 'Segoe UI', Arial, Helvetica, sans-serif"

_STYLE: dict[str, Any] = own_tables("pictures.toml")["style"]


@dataclass(frozen=True)
class Picture:
    """A picture for the page.

    Parameters
    ----------
    name : str
        Short name, unique on the page.
    svg : bytes
        The drawing.
    alt : str
        Description for screen readers.
    caption : str
        Caption.
    """

    name: str
    svg: bytes
    alt: str
    caption: str

    @property
    def dark(self) -> bool:
        """Whether it turns dark on a dark screen."""
        return b"prefers-color-scheme" in self.svg

    @property
    def address(self) -> str:
        """The drawing as a data URL: it needs no file, and its names cannot clash with those of the page."""
        return "data:image/svg+xml;base64," + base64.b64encode(self.svg).decode("ascii")


@contextmanager
def style() -> Iterator[None]:
    """Drawing settings of the report; those of the caller are restored afterwards."""
    import matplotlib

    with matplotlib.rc_context(cast("Any", _STYLE)):
        yield


def outside_text(text: str) -> str:
    r"""A title or name given by the user, escaped for matplotlib: no formula, no control characters.

    Examples
    --------
    >>> outside_text("5 $")
    '5 \\$'
    """
    return printable(text).replace("$", r"\$")


def panels(
    count: int,
    *,
    height: float = 3.5,
    width: float = WIDTH,
    ratios: Sequence[float] | None = None,
    head: float = 0.36,
    side: float = 0.12,
    kind: type[Figure] | None = None,
    shown_as: type[Axes] | None = None,
) -> tuple[Figure, list[Axes]]:
    """A figure with `count` axes side by side, with `head` inches of space above and `side` inches on the right."""
    from matplotlib.figure import Figure

    figure = (kind or Figure)(figsize=(width, height))
    axes = figure.subplots(
        1,
        count,
        squeeze=False,
        subplot_kw={"axes_class": shown_as} if shown_as else None,
        gridspec_kw={
            "left": _LEFT / width,
            "right": 1 - side / width,
            "bottom": _BOTTOM / height,
            "top": 1 - head / height,
            "wspace": 0.30 if count == 2 else 0.36,
            "width_ratios": ratios,
        },
    )
    return figure, list(axes[0])


def svg(figure: Figure) -> bytes:
    """The finished figure."""
    _put_legends_below(figure)
    for axes in figure.axes:
        if axes.axison and axes.name == "rectilinear" and axes.get_label() != "<colorbar>":
            _draw_ticks(axes)
    return _recolour_for_dark(_render(figure).replace(b"'DejaVu Sans'", _FONTS.encode()))


def captioned(display: Display, figure: Figure, name: str, *parts: str, **values: object) -> Picture:
    """A finished figure with its caption from templates/answers/captions.j2.

    Parameters
    ----------
    display : Display
    figure : Figure
    name : str
        Name of the picture.
    *parts : str
        Keys of the sentences of the caption; empty ones are passed over. That of the description is "alt".
    **values
        Values of the {names} in them.
    """
    description, caption = (
        " ".join(say(display, "captions", f"{name}_{key}", **values) for key in keys if key)
        for keys in (("alt",), parts)
    )
    return Picture(name, svg(figure), description, caption)


def _render(figure: Figure) -> bytes:
    out = BytesIO()
    figure.savefig(out, format="svg", dpi=_DOTS, metadata={"Date": None, "Creator": None})
    return out.getvalue()


# Height of a row of a legend [inch], and width of a letter and of what stands before and behind a name [pt].
_ROW, _LETTER, _BESIDE = 0.165, 4.7, 36.0


def _put_legends_below(figure: Figure) -> None:
    """Move the legends of panels below them, where no curve is; the figure grows by the highest of them."""
    rows = 0
    for axes in figure.axes:
        before = axes.get_legend()
        if before is None or axes.name != "rectilinear":
            continue
        width, height = inches(axes)
        handles, names = axes.get_legend_handles_labels()
        columns = len(names)
        while columns > 1 and INCH * width < sum(
            _LETTER * max(map(len, part)) + _BESIDE for part in np.array_split(names, columns)
        ):
            columns -= 1
        title = before.get_title().get_text()
        rows = max(rows, math.ceil(len(names) / columns) + bool(title))
        place: dict[str, Any] = {"loc": "upper left", "bbox_to_anchor": (0.0, -(_BOTTOM - 0.04) / height)}
        place |= {
            "ncols": columns,
            "alignment": "left",
            "borderpad": 0.0,
            "borderaxespad": 0.0,
            "columnspacing": 1.2,
        }
        axes.legend(handles, names, title=title or None, **place)
    before_height, more = figure.get_figheight(), rows * _ROW + 0.06 * bool(rows)
    figure.set_figheight(before_height + more)
    for axes in figure.axes if rows else ():
        x, y, width, height = axes.get_position(original=True).bounds
        bottom, high = (y * before_height + more, height * before_height)
        axes.set_position((x, bottom / (before_height + more), width, high / (before_height + more)))


# Length of the tick marks of an axis, and distance to their numbers [pt].
_MARK, _PAD = 3.5, 3.5
# For each side: the direction outwards, matplotlib's tick mark in that direction, and the alignment of numbers.
_SIDES: dict[str, tuple[int, int, Any, Any, Any]] = {
    "left": (-1, 0, 0, "right", "center_baseline"),
    "bottom": (0, -1, 3, "center", "top"),
    "top": (0, 1, 2, "center", "bottom"),
}


def _draw_ticks(axes: Axes) -> None:
    """Draw grid, tick marks and numbers of finished axes: one artist for the grid and for each row of marks.

    Matplotlib itself makes five artists for each tick and lays all of them out several times, which takes a third of
    the time of drawing. Axes with a true scale, maps and sections, have no grid.
    """
    from matplotlib.collections import LineCollection
    from matplotlib.ticker import NullLocator

    to_axes = axes.transScale + axes.transLimits
    grid: list[list[tuple[float, float]]] = []
    for axis, along in ((axes.xaxis, 0), (axes.yaxis, 1)):
        ticks = np.asarray(axis.get_major_locator()())
        # a position on the other axis that is valid on any scale
        places = np.empty((len(ticks), 2))
        places[:, along], places[:, 1 - along] = ticks, axes.viewLim.max[1 - along]
        at = to_axes.transform(places)[:, along]
        inside = (at > -1e-9) & (at < 1 + 1e-9)
        names = axis.get_major_formatter().format_ticks(ticks[inside].tolist())
        axis.set_major_locator(NullLocator())
        if not names:
            continue
        shares = at[inside].tolist()
        draw_marks(axes, shares, names, "left" if along else "bottom")
        ends = [[(share, 0.0), (share, 1.0)] for share in shares]
        grid += [[point[::-1] for point in line] for line in ends] if along else ends
    if axes.get_aspect() == "auto":
        how = {"colors": _STYLE["grid.color"], "linewidths": _STYLE["grid.linewidth"], "zorder": 0.5}
        axes.add_collection(LineCollection(grid, transform=axes.transAxes, **how), autolim=False)


def draw_marks(
    axes: Axes, shares: Sequence[float], names: Sequence[str], side: Literal["left", "bottom", "top"]
) -> None:
    """Draw tick marks at the frame of axes with their names.

    They belong to the figure: axes clip at their frame, and each text of axes computes the frame again.

    Parameters
    ----------
    axes : Axes
    shares : sequence of float
        Positions along the frame, over its length.
    names : sequence of str
    side : {"left", "bottom", "top"}
    """
    from matplotlib.font_manager import FontProperties
    from matplotlib.lines import Line2D
    from matplotlib.transforms import ScaledTranslation

    figure = figure_of(axes)
    across, up, marker, ha, va = _SIDES[side]
    end = 1.0 if side == "top" else 0.0
    places = [(end, share) if across else (share, end) for share in shares]
    marks = Line2D(*zip(*places, strict=True), linestyle="none", marker=marker, transform=axes.transAxes)
    colour = _STYLE["xtick.color"]
    marks.set(markersize=_MARK, markeredgewidth=0.8, color=colour)
    figure.add_artist(marks)
    away = (_MARK + _PAD) / INCH
    shifted = axes.transAxes + ScaledTranslation(across * away, up * away, figure.dpi_scale_trans)
    # one font for all of them: each would look up its settings again
    font = FontProperties()
    for place, name in zip(places, names, strict=True):
        if name:
            figure.text(*place, name, transform=shifted, ha=ha, va=va, color=colour, fontproperties=font)


def _recolour_for_dark(drawing: bytes) -> bytes:
    """A drawing that turns dark on a dark screen; one with an image in it stays light.

    Light and dark are exchanged and hues stay, so that a colour scale still fits its picture.
    """
    if b"<image" in drawing:
        return drawing
    colours = sorted(set(re.findall(rb"(fill|stroke): #([0-9a-f]{6})", drawing)))
    rules = "".join(
        f'[style*="{kind}: #{colour}"]{{{kind}:#{_turned(colour)} !important}}'
        for kind, colour in ((kind.decode(), colour.decode()) for kind, colour in colours)
    )
    # an element without a colour is black
    rules = f"text{{fill:#{_turned('000000')}}}{rules}"
    start = drawing.index(b">", drawing.index(b"<svg")) + 1
    style = f"<style>@media screen and (prefers-color-scheme: dark){{{rules}}}</style>"
    return drawing[:start] + style.encode() + drawing[start:]


def _turned(colour: str) -> str:
    """The colour "rrggbb" with light and dark exchanged: white becomes nearly black.

    Examples
    --------
    >>> _turned("ffffff"), _turned("000000")
    ('171717', 'ebebeb')
    """
    red, green, blue = (int(colour[n : n + 2], 16) / 255 for n in (0, 2, 4))
    hue, light, saturation = colorsys.rgb_to_hls(red, green, blue)
    turned = colorsys.hls_to_rgb(hue, 0.92 - 0.83 * light, saturation)
    return "".join(f"{round(255 * colour):02x}" for colour in turned)


def label(
    axes: Axes, title: str, x: str, y: str, *, log: str = "", legend: str = "", above: float = 0.09
) -> None:
    """Set title, `above` the axes [inch], and axis labels; logarithmic axes, such as "xy", and place of a legend.

    All positions are fixed: matplotlib's own layout computes all tick labels several times, which takes longer than the
    drawing.
    """
    from matplotlib.ticker import MaxNLocator

    logarithmic(axes, *log)
    if legend:
        axes.legend(loc=cast("Any", legend))
    width, height = inches(axes)
    for axis in (axes.xaxis, axes.yaxis):
        if axis.get_scale() == "linear" and isinstance(axis.get_major_locator(), MaxNLocator):
            axis.set_major_locator(MaxNLocator(nbins=6, steps=[1, 2, 2.5, 5, 10]))
    axes.set_title(title, y=1.0, pad=72 * above)
    axes.set_xlabel(x)
    axes.set_ylabel(y)
    axes.xaxis.set_label_coords(0.5, -(_BOTTOM - 0.25) / height)
    axes.yaxis.set_label_coords(-(_LEFT - 0.15) / width, 0.5)


def inches(axes: Axes) -> tuple[float, float]:
    """Width and height of the axes."""
    width, height = figure_of(axes).get_size_inches() * axes.get_position().size
    return float(width), float(height)


def figure_of(axes: Axes) -> Figure:
    """The figure in which axes stand."""
    figure = axes.get_figure(root=True)
    assert figure is not None
    return figure


def spans_decades(values: ArrayLike, decades: float = 1.2) -> bool:
    """Whether positive values span so many decades that only a logarithmic axis shows them all."""
    numbers = np.asarray(values, dtype=float)
    positive = numbers[np.isfinite(numbers) & (numbers > 0)]
    return bool(positive.size > 1 and math.log10(positive.max() / positive.min()) > decades)


def positive(values: ArrayLike | Sequence[float | None]) -> FloatArray:
    """Positive values for a logarithmic axis; NaN, a gap in the line, for all others."""
    numbers = np.asarray(values, dtype=float)
    return np.where(numbers > 0, numbers, np.nan)


def logarithmic(axes: Axes, *which: str) -> None:
    """Make axes "x" or "y" logarithmic, with plain figures as labels."""
    from matplotlib.ticker import LogLocator, NullLocator

    for name in which:
        axis = getattr(axes, f"{name}axis")
        if not 0 < axis.get_minpos() < math.inf:
            continue  # only zeros
        getattr(axes, f"set_{name}scale")("log")
        low, high = sorted(axis.get_view_interval())
        decades = math.log10(high / low) if low > 0 else 9.0
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if decades < 2.2 else (1.0,), numticks=8))
        axis.set_major_formatter(_plain_figures)
        # Every tick costs a millisecond, and minor ticks add nothing to the grid.
        axis.set_minor_locator(NullLocator())


def scale_over_loads(axes: Axes, over: LoadAxis, values: ArrayLike, decades: float = 1.2) -> None:
    """Scale axes over loads: from zero, or logarithmic where the values span many decades."""
    scales = ["x"] if over.values.min() > 0 and spans_decades(over.values) else []
    if spans_decades(values, decades):
        scales.append("y")
    else:
        axes.set_ylim(0.0, 1.08 * axes.get_ylim()[1])
    logarithmic(axes, *scales)


def _plain_figures(value: float, _: object) -> str:
    if value <= 0:
        return ""
    exponent = math.floor(math.log10(value) + 1e-9)
    if -3 <= exponent < 4:
        return f"{value:.{max(-exponent, 0)}f}"
    mantissa = round(value / 10.0**exponent)
    return f"{'' if mantissa == 1 else f'{mantissa}·'}10{superscript(exponent)}"


def load_colours(count: int) -> Callable[[int], Any]:
    """Colour of load number n of `count`: light for the first, dark for the last."""
    from matplotlib.colors import LinearSegmentedColormap

    ramp = LinearSegmentedColormap.from_list("loads", ["#9cc3e6", BLUE, "#0b2545"])
    return lambda n: ramp(1.0 if count == 1 else n / (count - 1))


def number_dots(axes: Axes, x: ArrayLike, y: ArrayLike, numbers: Sequence[int]) -> None:
    """Number some of the dots of finished axes, with "1, 3" where two numbers would overlap."""
    places = np.column_stack([x, y])
    axes.autoscale_view()
    points = 72 * axes.transLimits.transform(axes.transScale.transform(places)) * inches(axes)
    texts: dict[int, str] = {}
    for n in few(len(numbers), _NUMBERED_DOTS):
        if np.isfinite(points[n]).all():
            near = (m for m in texts if np.abs(points[m] - points[n]).max() < _NUMBERS_APART)
            at = next(near, n)
            texts[at] = f"{texts[at]}, {numbers[n]}" if at in texts else str(numbers[n])
    for n, text in texts.items():
        axes.annotate(
            text, places[n], (0, 5), textcoords="offset points", ha="center", fontsize=8, color=BLUE, zorder=4
        )


def few(count: int, most: int = 5) -> list[int]:
    """Numbers of at most `most` of `count` loads, evenly spread, first and last among them."""
    return sorted({round(n) for n in np.linspace(0, count - 1, min(count, most))})
