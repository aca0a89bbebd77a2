"""Axisymmetric geometry and mesh of metal seals: exact shapes, graded triangles, named boundaries."""

from meshes.ball import Ball
from meshes.build import build, build_contact
from meshes.conical_land import ConicalLand
from meshes.conical_seat import ConicalSeat
from meshes.contact_geometry import ContactGeometry
from meshes.curve import Curve
from meshes.disc import Disc
from meshes.errors import GeometryError, MeshesError, MeshingError
from meshes.flat_seat import FlatSeat
from meshes.meshed_body import MeshedBody
from meshes.outline import Outline, Segment
from meshes.profile import Profile
from meshes.rounded_cone import RoundedCone
from meshes.rounding import chain, rounded
from meshes.seal_mesh import Quality, SealMesh
from meshes.section_file import read_section
from meshes.shape import Shape, housing, plunger
from meshes.sharp_edge import SharpEdge
from meshes.sizing import Sizing
from meshes.spherical_seat import SphericalSeat
from meshes.spherical_tip import SphericalTip
from meshes.toroidal_edge import ToroidalEdge
from meshes.toroidal_seat import ToroidalSeat
from meshes.touch import first_touch

__all__ = [
    "Ball",
    "ConicalLand",
    "ConicalSeat",
    "ContactGeometry",
    "Curve",
    "Disc",
    "FlatSeat",
    "GeometryError",
    "MeshedBody",
    "MeshesError",
    "MeshingError",
    "Outline",
    "Profile",
    "Quality",
    "RoundedCone",
    "SealMesh",
    "Segment",
    "Shape",
    "SharpEdge",
    "Sizing",
    "SphericalSeat",
    "SphericalTip",
    "ToroidalEdge",
    "ToroidalSeat",
    "build",
    "build_contact",
    "chain",
    "first_touch",
    "housing",
    "plunger",
    "read_section",
    "rounded",
]
