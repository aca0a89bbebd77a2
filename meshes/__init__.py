"""Axisymmetric geometry and mesh of metal seals: exact shapes, graded triangles, named boundaries."""

from lazy_loader import attach_stub

# a name is loaded with its first use, so that a program loads only what it calls
__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
