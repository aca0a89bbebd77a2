"""Exact geometry of axisymmetric bodies: segments, outlines, first touch."""
