"""The version, in a file of its own: files and reports name it, and know nothing else of the package."""

__version__ = "0.1.0"
