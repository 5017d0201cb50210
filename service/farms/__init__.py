"""Render farms: jobs that others run."""
