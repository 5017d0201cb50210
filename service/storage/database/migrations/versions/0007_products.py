"""Keep with each render what is to be made of its frames."""

import sqlalchemy as sa
from alembic import op

revision = "0007"
down_revision = "0006"


def upgrade() -> None:
    """Add the columns."""
    op.add_column("renders", sa.Column("products", sa.JSON(), nullable=False, server_default="{}"))
    for name in ("waiting", "unpictured", "running", "lacking"):
        op.add_column("renders", sa.Column(f"products_{name}", sa.Integer(), nullable=False, server_default="0"))
