"""Alembic's environment: migrations run on the connection that `service.renders.database.migrate` gives."""

from alembic import context

from service.renders.tables import Table

context.configure(
    connection=context.config.attributes["connection"], target_metadata=Table.metadata, render_as_batch=True
)
with context.begin_transaction():
    context.run_migrations()
