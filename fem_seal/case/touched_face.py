"""Whether closure and seat touch on the faces that their shapes are named after."""

from __future__ import annotations

from collections.abc import Iterator

from fem_seal.case.tables import CaseTables
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
    where = f"inside its {face.name}, which begins" if inside else f"outside its {face.name}, which ends"
    return (
        f'{name}.shape = "{shape}": the bodies touch first at r = {mm(radius)}, {where} at r = '
        f"{mm(face.inner if inside else face.outer)}; change the radii or the angle of a body so that the "
        f"{face.name} reaches the contact, or take the shape of the face that is touched there"
    )
