"""Subdivision surfaces: rules of Catmull-Clark, Loop and bilinear refinement, and the limit surface. numpy alone."""
