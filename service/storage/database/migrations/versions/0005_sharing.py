"""Let services share a database, count lost workers apart from failures, and let renders wait for others and be accepted."""

import secrets

import sqlalchemy as sa
from alembic import op

revision = "0005"
down_revision = "0004"


def upgrade() -> None:
    """Add the columns and the table."""
    op.add_column("render_tasks", sa.Column("losses", sa.Integer(), nullable=False, server_default="0"))
    op.add_column("render_tasks", sa.Column("holder", sa.Text()))
    for name in ("home", "files", "root"):
        op.add_column("renders", sa.Column(name, sa.Text()))
    op.add_column("renders", sa.Column("accepted", sa.Boolean(), nullable=False, server_default=sa.false()))
    op.create_table(
        "render_needs",
        *(
            sa.Column(name, sa.String(), sa.ForeignKey("renders.id", ondelete="CASCADE"), primary_key=True)
            for name in ("render", "needs")
        ),
    )
    facts = op.create_table(
        "facts",
        sa.Column("name", sa.String(), primary_key=True),
        sa.Column("value", sa.Text(), nullable=False),
    )
    op.bulk_insert(facts, [{"name": "id", "value": secrets.token_hex(8)}])
    op.create_index("ix_render_needs_needs", "render_needs", ["needs"])
