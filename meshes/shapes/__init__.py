"""Shapes of closures and seats, one file each."""
