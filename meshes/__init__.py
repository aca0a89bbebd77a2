"""Axisymmetric geometry and mesh of metal seals: exact shapes, graded triangles, named boundaries."""

from meshes.ball import Ball
from meshes.build import build
from meshes.conical_seat import ConicalSeat
from meshes.contact_geometry import BallOnCone
from meshes.errors import GeometryError, MeshesError, MeshingError
from meshes.outline import Outline, Segment
from meshes.seal_mesh import Quality, SealMesh
from meshes.sizing import Sizing

__all__ = [
    "Ball",
    "BallOnCone",
    "ConicalSeat",
    "GeometryError",
    "MeshesError",
    "MeshingError",
    "Outline",
    "Quality",
    "SealMesh",
    "Segment",
    "Sizing",
    "build",
]
