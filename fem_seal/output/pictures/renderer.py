"""SVG renderer that caches the sizes of texts."""

from __future__ import annotations

from functools import lru_cache
from typing import Literal

from matplotlib.backends.backend_svg import RendererSVG
from matplotlib.font_manager import FontProperties, findfont, get_font
from matplotlib.textpath import TextToPath

_Heights = tuple[float, float, float] | tuple[None, None, None]


class Renderer(RendererSVG):
    """Measures a text once, however many pictures have it.

    Matplotlib shapes every text anew for each picture, and reads the tables of its font each time that it lays it out,
    which is five times in a legend: together a quarter of the time of drawing.
    """

    def get_text_width_height_descent(
        self, s: str, prop: FontProperties, ismath: bool | Literal["TeX"]
    ) -> tuple[float, float, float]:
        """Size of a text [pt]."""
        return _size(s, prop, ismath)

    def _get_font_height_metrics(self, prop: FontProperties) -> _Heights:
        """Ascent, descent and line gap of a font [pt], asked for by `Text._get_layout` of newer matplotlib.

        None where they must look further.
        """
        return _heights(prop)


# Properties of a font are equal as long as all of them are: those that somebody changes are found no more.
@lru_cache(1024)
def _size(text: str, font: FontProperties, mathematics: bool | Literal["TeX"]) -> tuple[float, float, float]:
    width, height, descent = TextToPath().get_text_width_height_descent(text, font, mathematics)
    return width, height, descent


@lru_cache(64)
def _heights(font: FontProperties) -> _Heights:
    file = get_font(findfont(font))
    table, head = file.get_sfnt_table("OS/2"), file.get_sfnt_table("head")
    if table is None or head is None:
        return None, None, None
    size = 1 / head["unitsPerEm"] * font.get_size_in_points()
    return table["sTypoAscender"] * size, -table["sTypoDescender"] * size, table["sTypoLineGap"] * size
