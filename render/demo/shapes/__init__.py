"""Geometry and noise made by arithmetic, for the demo shot and the generated scenes. numpy alone."""
