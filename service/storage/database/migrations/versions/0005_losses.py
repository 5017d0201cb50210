"""Count losses of workers apart from failures of frames, and note which service holds a frame."""

import sqlalchemy as sa
from alembic import op

revision = "0005"
down_revision = "0004"


def upgrade() -> None:
    """Add the columns."""
    op.add_column("render_tasks", sa.Column("losses", sa.Integer(), nullable=False, server_default="0"))
    op.add_column("render_tasks", sa.Column("holder", sa.Text()))
