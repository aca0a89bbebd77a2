"""Shapes of closures and seats, one file each; what is a special case of another stands beside it."""
