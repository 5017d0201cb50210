"""Renders: jobs of many frames, kept in a database, so that a restart loses none."""
