"""Element sizes, and the mesh with its names, quality and files."""
