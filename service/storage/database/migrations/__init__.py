"""Migrations of the database of renders, which Alembic runs."""
