"""Let a frame have a file of each format of its render, in place of a single one, and a render products such as movies."""

import sqlalchemy as sa
from alembic import op

revision = "0003"
down_revision = "0002"


def upgrade() -> None:
    """Move sizes and hashes into a column by format, and name the formats of each render."""
    op.add_column("render_tasks", sa.Column("files", sa.JSON(), nullable=False, server_default="{}"))
    op.add_column("renders", sa.Column("time_codes_per_second", sa.Float()))
    op.add_column("renders", sa.Column("product_bytes", sa.BigInteger(), nullable=False, server_default="0"))
    if op.get_bind().dialect.name == "sqlite":  # no other one was in use before
        op.execute(
            """
            UPDATE render_tasks SET files = json_object(
                (SELECT json_extract(request, '$.format') FROM renders WHERE renders.id = render_tasks.render),
                json_object('size_bytes', size_bytes, 'sha256', sha256))
            WHERE sha256 IS NOT NULL
            """
        )
        op.execute(
            """
            UPDATE renders SET request = json_remove(
                json_set(request, '$.formats', json_array(json_extract(request, '$.format'))), '$.format')
            """
        )
    # Not in batch mode: making the table anew would remove the attempts, which refer to it.
    op.drop_column("render_tasks", "size_bytes")
    op.drop_column("render_tasks", "sha256")
