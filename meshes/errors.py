"""The exceptions of meshes."""


def mm(length: float) -> str:
    """A length [m] for a message, in the unit of drawings.

    Parameters
    ----------
    length : float

    Examples
    --------
    >>> mm(0.0199)
    '19.9 mm'
    """
    return f"{1e3 * length:.6g} mm"


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
    meshes.errors.GeometryError: closure radius = -20 mm: must be positive and finite
    """


class MeshingError(MeshesError, RuntimeError):
    """gmsh is missing, cannot be loaded, or did not deliver a usable mesh.

    Examples
    --------
    >>> import meshes
    >>> issubclass(meshes.MeshingError, meshes.MeshesError)
    True
    """
