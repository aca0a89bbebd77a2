"""Axisymmetric geometry and mesh of metal seals: exact shapes, graded triangles, named boundaries."""

from meshes.build import build, build_contact
from meshes.drawings.meshed_body import MeshedBody
from meshes.drawings.profile import Profile
from meshes.drawings.section import read_section
from meshes.errors import GeometryError, MeshesError, MeshingError
from meshes.geometry.contact_geometry import ContactGeometry
from meshes.geometry.curve import Curve
from meshes.geometry.outline import Outline
from meshes.geometry.rounding import chain, rounded
from meshes.geometry.segment import Segment
from meshes.geometry.touch import first_touch
from meshes.mesh.seal_mesh import Quality, SealMesh
from meshes.mesh.sizing import Sizing
from meshes.shapes.ball import Ball
from meshes.shapes.conical_land import ConicalLand
from meshes.shapes.conical_seat import ConicalSeat
from meshes.shapes.disc import Disc
from meshes.shapes.flange_face import FlangeFace
from meshes.shapes.flat_land import FlatLand
from meshes.shapes.flat_seat import FlatSeat
from meshes.shapes.gaskets import DeltaRing, DoubleConeRing, LensRing, OctagonalRing, SolidRing
from meshes.shapes.lands import Land, Lands
from meshes.shapes.rounded_cone import RoundedCone
from meshes.shapes.shape import Shape, housing, plunger
from meshes.shapes.sharp_edge import SharpEdge
from meshes.shapes.spherical_seat import SphericalSeat
from meshes.shapes.spherical_tip import SphericalTip
from meshes.shapes.toroidal_edge import ToroidalEdge
from meshes.shapes.toroidal_seat import ToroidalSeat

__all__ = [
    "Ball",
    "ConicalLand",
    "ConicalSeat",
    "ContactGeometry",
    "Curve",
    "DeltaRing",
    "Disc",
    "DoubleConeRing",
    "FlangeFace",
    "FlatLand",
    "FlatSeat",
    "GeometryError",
    "Land",
    "Lands",
    "LensRing",
    "MeshedBody",
    "MeshesError",
    "MeshingError",
    "OctagonalRing",
    "Outline",
    "Profile",
    "Quality",
    "RoundedCone",
    "SealMesh",
    "Segment",
    "Shape",
    "SharpEdge",
    "Sizing",
    "SolidRing",
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
