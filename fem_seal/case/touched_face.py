"""Check that closure and seat touch on their named faces."""

from __future__ import annotations

from collections.abc import Iterator

from fem_seal.case.tables import CaseTables
from fem_seal.case.words import sentence
from meshes.errors import mm
from meshes.shapes.shape import NamedFace, named_face


def touched_beside(case: CaseTables) -> Iterator[str]:
    """What is said of each body that is touched first beside the face that its shape is named after.

    Parameters
    ----------
    case : CaseTables
        Whose tables fit together.
    """
    radius = case.contact.touch_radius
    for name, table, body in zip(("closure", "seat"), (case.closure, case.seat), case.bodies, strict=True):
        face = named_face(body)
        if face is not None and not face.holds(radius):
            yield _sentence(name, table.shape, face, radius)


def _sentence(name: str, shape: str, face: NamedFace, radius: float) -> str:
    inside = radius < face.inner
    end = mm(face.inner if inside else face.outer)
    words = {"body": name, "shape": shape, "radius": mm(radius), "face": face.name, "end": end}
    return sentence("touched_inside" if inside else "touched_outside", **words)
