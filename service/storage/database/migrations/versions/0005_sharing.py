"""Let services share a database: count lost workers apart from failures, and note who holds a frame and where a shot is."""

import sqlalchemy as sa
from alembic import op

revision = "0005"
down_revision = "0004"


def upgrade() -> None:
    """Add the columns."""
    op.add_column("render_tasks", sa.Column("losses", sa.Integer(), nullable=False, server_default="0"))
    op.add_column("render_tasks", sa.Column("holder", sa.Text()))
    for name in ("home", "files", "root"):
        op.add_column("renders", sa.Column(name, sa.Text()))
