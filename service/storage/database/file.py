"""The database in a data folder."""

DATABASE = "renders.sqlite"
"""Name of the file; SQLite has others beside it while it is open."""
