"""Finite elements of one body: elasticity, plasticity, its answer at the contact line, its fields."""
