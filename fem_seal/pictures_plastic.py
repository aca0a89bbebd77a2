"""Picture of what a load path leaves behind: the imprint, and where the body has yielded."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fem_seal.elastoplastic_fields import ElastoplasticField
from fem_seal.pictures import BLUE, INK, ORANGE, Picture, label, panels, svg
from fem_seal.pictures_fields import HEIGHT, QUARTERS, SCALE_ROOM, frame_zone, near, scale_of_colours, turned
from fem_seal.readable import percent, quantity, unit_for
from fem_seal.yielding import plastic_zone

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from fem_seal.elastoplastic_path import Unloaded
    from fem_seal.results import SealResult

_COLOURS = {"seat": BLUE, "closure": ORANGE}
# Widths of the imprint that are shown to each side, and depths of the yielded zone to above and below.
_WIDTHS, _DEPTHS = 1.6, 1.5
_BANDS = 10


def imprint_picture(result: SealResult) -> Picture | None:
    """The lasting imprint, and the plastic strain below it; None if nothing has yielded.

    Parameters
    ----------
    result : SealResult
    """
    unloaded = result.unloaded
    if unloaded is None or not unloaded.imprints:
        return None
    figure, (depth, strain) = panels(2, height=4.0, side=SCALE_ROOM)
    _imprints(depth, unloaded)
    caption = _strains(strain, result, unloaded)
    told = "; ".join(
        f"{name}: {quantity('length', imprint.deepest)} deep, {quantity('length', imprint.width)} wide at half of "
        f"that, with a rim of {quantity('length', imprint.rim)}"
        for name, imprint in unloaded.imprints.items()
    )
    return Picture(
        "imprint",
        svg(figure),
        "Lasting imprint in the contact face after unloading, and the plastic strain around it",
        f"Left: how far the face has moved into its body for good, after all loads have been taken away ({told}). "
        f"Right: accumulated plastic strain, closure above, seat below, undeformed shape. {caption} Residual stress "
        "and lasting displacement are in unloaded.vtu, the imprint in imprint.csv.",
    )


def _imprints(axes: Axes, unloaded: Unloaded) -> None:
    imprints = unloaded.imprints
    reach = max(_WIDTHS * imprint.width + abs(imprint.deepest_at) for imprint in imprints.values())
    length = unit_for("length", reach)
    height = unit_for("length", max(imprint.deepest for imprint in imprints.values()))
    for name, imprint in imprints.items():
        axes.plot(imprint.x / length.size, imprint.depth / height.size, color=_COLOURS[name], label=name)
    axes.axhline(0.0, color=INK, linewidth=0.8)
    axes.set_xlim(-reach / length.size, reach / length.size)
    axes.invert_yaxis()
    axes.legend(loc="best")
    label(axes, "Lasting imprint", f"x  [{length.name}]", f"depth  [{height.name}]")


def _strains(axes: Axes, result: SealResult, unloaded: Unloaded) -> str:
    """Plastic strain of all bodies that yield; says how far it reaches."""
    from matplotlib.ticker import MaxNLocator
    from matplotlib.tri import Triangulation

    fields = {n: field for n, field in unloaded.fields.items() if isinstance(field, ElastoplasticField)}
    materials = {"closure": result.case.closure.material, "seat": result.case.seat.material}
    found = {name: plastic_zone(field, materials[name]) for name, field in fields.items()}
    zones = {name: zone for name, zone in found.items() if zone is not None}
    widest = max(imprint.width for imprint in unloaded.imprints.values())
    reach = max(_WIDTHS * widest, *(_DEPTHS / HEIGHT * zone.deepest for zone in zones.values()))
    length = unit_for("length", 2 * reach)
    largest = max(float(field.accumulated_plastic_strain.max()) for field in fields.values())
    # few digits, so that the numbers of the scale find room
    size, unit = (1e-2, "%") if largest > 1e-3 else (1e-6, "10⁻⁶")
    largest /= size
    ticks = MaxNLocator(_BANDS, steps=[1, 2, 2.5, 5, 10]).tick_values(0.0, largest)
    levels = [largest / 100, *ticks[1:]]  # what has not yielded stays white
    bands = None
    for name, field in unloaded.fields.items():
        place = turned(result.seal_mesh, field.points)
        if name in fields:
            triangles = near(place, field.triangles6[:, QUARTERS].reshape(-1, 3), reach)
            grid = Triangulation(place[:, 0] / length.size, place[:, 1] / length.size, triangles)
            values = fields[name].accumulated_plastic_strain / size
            bands = axes.tricontourf(grid, values, levels=levels, cmap="YlOrRd")
        axes.plot(*(place[field.contact_nodes] / length.size).T, color=INK, linewidth=0.8)
    frame_zone(axes, reach / length.size, length.name, "Plastic strain")
    if bands is not None:
        scale_of_colours([axes], bands, f"accumulated plastic strain  [{unit}]", lowest="0")
    return " ".join(
        f"The largest in the {name}, {percent(zone.strain)}, lies {quantity('length', zone.depth)} from the contact "
        f"line; it has yielded down to {quantity('length', zone.deepest)}."
        for name, zone in zones.items()
    )
