"""Everything that can go wrong while a geometry or a mesh is made."""


class MeshesError(Exception):
    """Base of all errors that this package raises on purpose.

    Examples
    --------
    >>> import meshes
    >>> issubclass(meshes.GeometryError, meshes.MeshesError)
    True
    """


class GeometryError(MeshesError, ValueError):
    """The asked-for bodies cannot exist or cannot touch each other.

    Examples
    --------
    >>> import meshes
    >>> meshes.Ball(-0.02)
    Traceback (most recent call last):
        ...
    meshes.errors.GeometryError: closure radius = -0.02 m: must be positive and finite
    """


class MeshingError(MeshesError, RuntimeError):
    """gmsh is missing, cannot be loaded, or did not deliver a usable mesh.

    Examples
    --------
    >>> import meshes
    >>> issubclass(meshes.MeshingError, meshes.MeshesError)
    True
    """
