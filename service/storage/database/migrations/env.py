"""Alembic's environment: migrations run on the connection that `service.storage.database.connection.migrate` gives."""

from alembic import context

from service.storage.database.tables import Table

context.configure(
    connection=context.config.attributes["connection"], target_metadata=Table.metadata, render_as_batch=True
)
with context.begin_transaction():
    context.run_migrations()
