"""Upkeep of a service: what this machine offers to it, and backups of its data folder."""
