"""Rough surfaces: from heights that an instrument measured to the power spectrum."""
