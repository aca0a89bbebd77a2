"""The faces of two bodies: named in their outlines, or the chains that would touch first."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

from meshes.errors import GeometryError
from meshes.outline import Outline, Segment
from meshes.touch import first_touch


def with_faces(closure: Outline, seat: Outline) -> tuple[Outline, Outline]:
    """Outlines whose faces are named, those that are not yet being found by the closest approach along the axis.

    Parameters
    ----------
    closure, seat : Outline
        A body that does not name its face has pieces without a name, one of which will touch.

    Raises
    ------
    GeometryError
        If no chain of one body lies above a chain of the other.
    """
    pairs = []
    for c, s in product(_candidates(closure), _candidates(seat)):
        try:
            pairs.append((first_touch(c.face, s.face).drop, c, s))
        except GeometryError as error:
            refusal = error
    if not pairs:
        raise refusal
    return min(pairs, key=lambda pair: pair[0])[1:]


def _candidates(outline: Outline) -> list[Outline]:
    """The outline with each chain that could be its face named so; the outline itself if it names one."""
    if any(s.name == f"{outline.name}_face" for s in outline.segments):
        return [named_beside(outline)]
    chains: list[list[int]] = []
    for n, s in enumerate(outline.segments):
        if s.name or looks(s) != (-1 if outline.name == "closure" else 1):
            continue
        if chains and chains[-1][-1] == n - 1:
            chains[-1].append(n)
        else:
            chains.append([n])
    if not chains:
        side = "downwards" if outline.name == "closure" else "upwards"
        raise GeometryError(f"{outline.name} outline: no piece without another name looks {side}")
    return [
        named_beside(
            Outline(
                outline.name,
                tuple(
                    replace(s, name=f"{outline.name}_face") if n in chain else s
                    for n, s in enumerate(outline.segments)
                ),
            )
        )
        for chain in map(set, chains)
    ]


def looks(s: Segment) -> int:
    """Whether a piece of a counter-clockwise outline looks upwards, 1, downwards, -1, or to the side, 0."""
    inwards = s.start[0] - s.end[0]
    steep = abs(inwards) <= 1e-9 * (abs(s.end[1] - s.start[1]) + abs(inwards))
    return 0 if steep else 1 if inwards > 0 else -1


def named_beside(outline: Outline) -> Outline:
    """Pieces without a name called after the side of the face on which they lie."""
    if all(s.name for s in outline.segments):
        return outline
    at = [n for n, s in enumerate(outline.segments) if s.name == f"{outline.name}_face"]
    # The surface of the closure begins at the axis, that of the seat at the wall.
    before, after = ("inner", "outer") if outline.name == "closure" else ("outer", "inner")
    return Outline(
        outline.name,
        tuple(
            s if s.name else replace(s, name=f"{outline.name}_{before if n < at[0] else after}")
            for n, s in enumerate(outline.segments)
        ),
    )
