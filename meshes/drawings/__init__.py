"""Bodies from drawings, outlines and meshes of other programs."""
