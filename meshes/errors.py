"""Everything that can go wrong while a geometry or a mesh is made."""


class MeshesError(Exception):
    """Base of all errors that this package raises on purpose."""


class GeometryError(MeshesError, ValueError):
    """The asked-for bodies cannot exist or cannot touch each other."""


class MeshingError(MeshesError, RuntimeError):
    """gmsh is missing, cannot be loaded, or did not deliver a usable mesh."""
