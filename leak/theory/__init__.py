"""Persson's contact mechanics of a rough surface, and closed profiles of a line contact."""
