"""Picture of a simulated seal: pressure across the contact and leak rates, beside the chain."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from fem_seal.output.pictures.style import (
    BLUE,
    FILL,
    GREEN,
    INK,
    ORANGE,
    Picture,
    label,
    logarithmic,
    panels,
    svg,
)
from fem_seal.output.prose import said
from fem_seal.units import quantity, unit_for

if TYPE_CHECKING:
    from fem_seal.seal.direct_seal import SealRow

_COLOURS = {"elastic": BLUE, "capped": ORANGE, "von-mises": GREEN}


def seal_picture(rows: Sequence[SealRow]) -> Picture:
    """Pressure across the contact of the highest load, and leak rates over the fluid pressure.

    Parameters
    ----------
    rows : sequence of SealRow
    """
    highest = max(row.place.fluid_pressure for row in rows)
    shown = [row for row in rows if row.place.fluid_pressure == highest]
    place = shown[0].place
    shown = [row for row in shown if row.place is place]
    figure, (pressures, leaks) = panels(2, height=3.8)
    length, stress = unit_for("length", place.strip.width), unit_for("contact pressure", shown[0].measures[0])
    n = place.strip.points[0]
    x = ((np.arange(n) + 0.5) / n - 0.5) * place.strip.width
    for row in shown:
        pressures.plot(
            x / length.size,
            row.profile / stress.size,
            color=_COLOURS[row.asperities],
            lw=0.8,
            label=row.asperities,
        )
    profile = place.profile
    pressures.plot(
        (profile.x - profile.centroid) / length.size, profile.pressure / stress.size, color=INK, label="chain"
    )
    pressures.set_xlim(x[0] / length.size, x[-1] / length.size)
    at = quantity("fluid pressure", highest)
    label(
        pressures,
        f"Contact pressure at {at}, {place.name}",
        f"x  [{length.name}]",
        f"pressure  [{stress.name}]",
    )
    pressures.legend(loc="best")
    fluid, flow = unit_for("fluid pressure", highest), unit_for("flow", max(row.leak_rate for row in rows))
    for name in dict.fromkeys(row.place.name for row in rows):
        for kind, colour in _COLOURS.items():
            own = [row for row in rows if row.asperities == kind and row.place.name == name]
            if own:
                p = np.array([row.place.fluid_pressure for row in own]) / fluid.size
                rates = np.array([row.leak_rate for row in own]) / flow.size
                error = [
                    2.0 * np.nan_to_num(row.deviation) / len(row.leak_rates) ** 0.5 / flow.size for row in own
                ]
                what = kind if name == "round" else f"{kind}, {name}"
                mark = "s" if name == "most loaded" else "o"
                leaks.errorbar(p, rates, error, fmt=mark, color=colour, ms=3.8, capsize=2, label=what)
    first = [
        row for row in rows if row.asperities == rows[0].asperities and row.place.name == rows[0].place.name
    ]
    p = np.array([row.place.fluid_pressure for row in first]) / fluid.size
    leaks.plot(
        p, np.array([row.chain_held for row in first]) / flow.size, color=INK, label="chain, same waves"
    )
    ends = [row.place.interval for row in first]
    if all(ends):
        low, high = np.array([one for one in ends if one is not None]).T / flow.size
        leaks.fill_between(p, low, high, color=FILL, lw=0, label="chain, interval")
    logarithmic(leaks, "y")
    label(leaks, "Leak rate", f"fluid pressure  [{fluid.name}]", f"leak rate  [{flow.name}]")
    leaks.legend(loc="best")
    return Picture(
        "direct_seal",
        svg(figure),
        said("captions.direct_seal", "alt"),
        said("captions.direct_seal", "caption"),
    )
