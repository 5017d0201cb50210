"""Make the table of webhooks."""

import sqlalchemy as sa
from alembic import op

revision = "0004"
down_revision = "0003"


def upgrade() -> None:
    """Make the table."""
    op.create_table(
        "webhooks",
        sa.Column("id", sa.String(), primary_key=True),
        *(sa.Column(name, sa.String(), nullable=False) for name in ("url", "secret")),
        sa.Column("project", sa.String()),
        sa.Column("topics", sa.JSON(), nullable=False),
        *(sa.Column(name, sa.String()) for name in ("shot", "render")),
        sa.Column("created_at", sa.Float(), nullable=False),
        sa.Column("after", sa.BigInteger(), nullable=False),
        sa.Column("last_status", sa.Integer()),
        sa.Column("last_error", sa.Text()),
        sa.Column("failures", sa.Integer(), nullable=False),
        sa.Column("failing_since", sa.Float()),
        sa.Column("next_try_at", sa.Float()),
        sa.Column("disabled", sa.Text()),
        sa.Column("worker", sa.String()),
        sa.Column("lease_until", sa.Float()),
    )
