"""`pullfocus bench scale`: how time and memory grow with the size of a scene and of its picture."""
