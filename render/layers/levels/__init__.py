"""Simpler levels of meshes, for sketches while dragging."""
