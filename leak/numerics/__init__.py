"""Quadrature and curves."""
