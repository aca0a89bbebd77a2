"""Axisymmetric geometry and mesh of metal seals: exact shapes, graded triangles, named boundaries."""

from meshes.ball import Ball
from meshes.build import build, build_contact
from meshes.conical_seat import ConicalSeat
from meshes.contact_geometry import ContactGeometry
from meshes.curve import Curve, chain
from meshes.errors import GeometryError, MeshesError, MeshingError
from meshes.outline import Outline, Segment
from meshes.seal_mesh import Quality, SealMesh
from meshes.shape import Shape, housing, plunger
from meshes.sizing import Sizing
from meshes.touch import first_touch

__all__ = [
    "Ball",
    "ConicalSeat",
    "ContactGeometry",
    "Curve",
    "GeometryError",
    "MeshesError",
    "MeshingError",
    "Outline",
    "Quality",
    "SealMesh",
    "Segment",
    "Shape",
    "Sizing",
    "build",
    "build_contact",
    "chain",
    "first_touch",
    "housing",
    "plunger",
]
