"""Make the tables of renders, their tasks and the attempts of these."""

import sqlalchemy as sa
from alembic import op

revision = "0001"
down_revision = None


def upgrade() -> None:
    """Make the tables."""
    op.create_table(
        "renders",
        sa.Column("id", sa.String(), primary_key=True),
        *(sa.Column(name, sa.String(), nullable=False) for name in ("name", "project", "owner", "owner_label")),
        sa.Column("idempotency_key", sa.String()),
        *(sa.Column(name, sa.String(), nullable=False) for name in ("digest", "shot", "shot_created_at")),
        sa.Column("edits", sa.Text(), nullable=False),
        sa.Column("revision", sa.String(), nullable=False),
        sa.Column("request", sa.JSON(), nullable=False),
        sa.Column("frames", sa.Text(), nullable=False),
        sa.Column("count", sa.Integer(), nullable=False),
        sa.Column("priority", sa.Integer(), nullable=False),
        sa.Column("wanted", sa.String(), nullable=False),
        sa.Column("created_at", sa.Float(), nullable=False),
        sa.Column("started_at", sa.Float()),
        sa.Column("finished_at", sa.Float()),
        sa.Column("not_before", sa.Float(), nullable=False),
        sa.Column("stored_bytes", sa.BigInteger(), nullable=False),
        sa.Column("busy_s", sa.Float(), nullable=False),
        *(sa.Column(name, sa.Integer(), nullable=False) for name in ("ready", "running", "done", "failed", "canceled")),
        sa.UniqueConstraint("owner", "idempotency_key"),
    )
    op.create_index("renders_by_turn", "renders", ["wanted", "priority", "created_at"])
    op.create_index("ix_renders_project", "renders", ["project"])
    op.create_index("ix_renders_created_at", "renders", ["created_at"])
    op.create_table(
        "render_tasks",
        sa.Column("render", sa.String(), sa.ForeignKey("renders.id", ondelete="CASCADE"), primary_key=True),
        sa.Column("frame", sa.Integer(), primary_key=True),
        sa.Column("state", sa.String(), nullable=False),
        sa.Column("attempts", sa.Integer(), nullable=False),
        sa.Column("failures", sa.Integer(), nullable=False),
        sa.Column("not_before", sa.Float(), nullable=False),
        sa.Column("worker", sa.String()),
        sa.Column("lease_until", sa.Float()),
        sa.Column("size_bytes", sa.BigInteger()),
        sa.Column("sha256", sa.String()),
    )
    op.create_index("render_tasks_by_state", "render_tasks", ["render", "state", "frame"])
    op.create_index("render_tasks_by_lease", "render_tasks", ["state", "lease_until"])
    op.create_table(
        "render_attempts",
        sa.Column("render", sa.String(), primary_key=True),
        sa.Column("frame", sa.Integer(), primary_key=True),
        sa.Column("number", sa.Integer(), primary_key=True),
        sa.Column("worker", sa.String(), nullable=False),
        sa.Column("started_at", sa.Float(), nullable=False),
        sa.Column("ended_at", sa.Float()),
        sa.Column("outcome", sa.String()),
        sa.Column("error", sa.Text()),
        sa.ForeignKeyConstraint(["render", "frame"], ["render_tasks.render", "render_tasks.frame"], ondelete="CASCADE"),
    )
