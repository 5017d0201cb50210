"""Keep a log of each attempt at a frame."""

import sqlalchemy as sa
from alembic import op

revision = "0006"
down_revision = "0005"


def upgrade() -> None:
    """Add the table."""
    op.create_table(
        "render_logs",
        sa.Column("render", sa.String(), primary_key=True),
        sa.Column("frame", sa.Integer(), primary_key=True),
        sa.Column("number", sa.Integer(), primary_key=True),
        sa.Column("size_bytes", sa.Integer(), nullable=False),
        sa.Column("text", sa.Text(), nullable=False),
        sa.ForeignKeyConstraint(
            ["render", "frame", "number"],
            ["render_attempts.render", "render_attempts.frame", "render_attempts.number"],
            ondelete="CASCADE",
        ),
    )
