"""Database in which the service keeps what outlives a restart: renders and their tasks."""
