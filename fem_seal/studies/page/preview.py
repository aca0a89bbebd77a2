"""A study as a notebook shows it: its designs as a table, and one small picture of them."""

from __future__ import annotations

import base64
from html import escape
from io import BytesIO

from fem_seal.output.notebook import table_html
from fem_seal.output.pictures.style import style
from fem_seal.studies.designs_table import Designs
from fem_seal.studies.page.display import BLUE, GREY, Display


def preview(designs: Designs) -> str:
    """Table of the designs, in SI, and the first response over the first parameter.

    Parameters
    ----------
    designs : Designs
    """
    picture = _picture(designs) if designs.parameters and designs.outputs and len(designs.done) else ""
    return f"<p><b>{escape(str(designs.about['title']))}</b></p>{table_html(designs.table)}{picture}"


def _picture(designs: Designs) -> str:
    from matplotlib.figure import Figure

    display = Display(designs)
    x, y = designs.parameters[0], designs.outputs[0]
    rows = designs.done.index
    counted = designs.counted.loc[rows].to_numpy()
    with style():
        figure = Figure(figsize=(5.5, 3.5), layout="constrained")
        axes = figure.add_subplot()
        axes.grid(True)
        for which, colour in ((~counted, GREY), (counted, BLUE)):
            if which.any():
                axes.scatter(display.values(rows[which], x), display.values(rows[which], y), s=14, c=colour)
        axes.set(xlabel=display.label(x), ylabel=display.label(y))
        for name, scale in ((x, axes.set_xscale), (y, axes.set_yscale)):
            if display.logarithmic(name):
                scale("log")
        drawn = BytesIO()
        figure.savefig(drawn, format="png", dpi=110)
    alt = f"{display.label(y)} over {display.label(x)}, one dot for each design"
    data = base64.b64encode(drawn.getvalue()).decode("ascii")
    return f'<img src="data:image/png;base64,{data}" alt="{escape(alt)}" style="max-width: 100%">'
