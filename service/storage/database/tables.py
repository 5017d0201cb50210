"""Tables of the renders (jobs, their tasks, which are a frame each, and the attempts of these), of events, and of webhooks."""

from __future__ import annotations

import re
from typing import Any, ClassVar, TypedDict

from sqlalchemy import (
    JSON,
    BigInteger,
    Dialect,
    ForeignKey,
    ForeignKeyConstraint,
    Index,
    Integer,
    Text,
    TypeDecorator,
    UniqueConstraint,
)
from sqlalchemy.ext.hybrid import hybrid_property
from sqlalchemy.orm import DeclarativeBase, Mapped, mapped_column

_NOT_STORED = re.compile("[\0\ud800-\udfff]")


def plain(value: Any) -> Any:
    """Return JSON whose texts are such that a database holds them, and any reader, too."""
    if isinstance(value, str):
        return _NOT_STORED.sub("\ufffd", value)
    if isinstance(value, dict):
        return {key: plain(one) for key, one in value.items()}
    return [plain(one) for one in value] if isinstance(value, list) else value


class PlainText(TypeDecorator[str]):
    """Text. In place of what no database holds, NUL and halves of surrogates, it has U+FFFD."""

    impl = Text
    cache_ok = True

    def process_bind_param(self, value: str | None, dialect: Dialect) -> str | None:
        """Return a text as it is stored and compared."""
        return None if value is None else _NOT_STORED.sub("\ufffd", value)


class FileEntry(TypedDict):
    """A stored file of a frame.

    Attributes:
        size_bytes: of the file.
        sha256: of its content, in hexadecimal digits.
    """

    size_bytes: int
    sha256: str


class ProductEntry(TypedDict):
    """A product that a render was sent with, such as a movie.

    Attributes:
        state: one of `service.models.render_products.ProductState`.
        attempts: at it, so far.
        failures: of these, since it was asked for last.
        losses: of these, whose service is gone, since then.
        not_before: time before which it is not tried again, s since 1970.
        holder: id of the data folder whose service makes it; None where none does.
        lease_until: time up to which that service holds it, s since 1970.
        size_bytes: of its file; None before it is made.
        error: what went wrong.
        reason: `frames`, where it has failed without an attempt, as frames have; else None.
    """

    state: str
    attempts: int
    failures: int
    losses: int
    not_before: float
    holder: str | None
    lease_until: float | None
    size_bytes: int | None
    error: str | None
    reason: str | None


class Table(DeclarativeBase):
    """Base of all tables. Times are seconds since 1970, UTC."""

    type_annotation_map: ClassVar = {str: PlainText}


class RenderRow(Table):
    """A render. The numbers of its tasks in each state are kept with it, so that lists are quick; and so are those of its
    products, which wait (of these, those that need no pictures, too), are made, or have failed or were given up
    (`service.jobs.product_states`).

    `home` is the id of the data folder that has its shot and frames; where they are in a bucket, `files` is the hash of the shot
    there, and `root` its root layer. `accepted` says that its frames which failed or were canceled are not wanted any more.
    """

    __tablename__ = "renders"
    __table_args__ = (
        UniqueConstraint("owner", "idempotency_key"),
        Index("renders_by_turn", "wanted", "priority", "created_at"),
    )

    id: Mapped[str] = mapped_column(primary_key=True)
    name: Mapped[str]
    project: Mapped[str] = mapped_column(index=True)
    owner: Mapped[str]
    owner_label: Mapped[str]
    idempotency_key: Mapped[str | None]
    digest: Mapped[str]
    shot: Mapped[str]
    shot_created_at: Mapped[str]
    home: Mapped[str | None]
    files: Mapped[str | None]
    root: Mapped[str | None]
    edits: Mapped[str] = mapped_column(deferred=True)
    revision: Mapped[str]
    request: Mapped[dict[str, Any]] = mapped_column(JSON)
    frames: Mapped[str]
    count: Mapped[int]
    priority: Mapped[int]
    wanted: Mapped[str]
    created_at: Mapped[float] = mapped_column(index=True)
    started_at: Mapped[float | None]
    finished_at: Mapped[float | None]
    not_before: Mapped[float] = mapped_column(default=0.0)
    stored_bytes: Mapped[int] = mapped_column(BigInteger, default=0)
    product_bytes: Mapped[int] = mapped_column(BigInteger, default=0)
    time_codes_per_second: Mapped[float | None]
    busy_s: Mapped[float] = mapped_column(default=0.0)
    ready: Mapped[int]
    running: Mapped[int] = mapped_column(default=0)
    done: Mapped[int] = mapped_column(default=0)
    failed: Mapped[int] = mapped_column(default=0)
    canceled: Mapped[int] = mapped_column(default=0)
    accepted: Mapped[bool] = mapped_column(default=False)
    products: Mapped[dict[str, ProductEntry]] = mapped_column(JSON, default=dict)
    products_waiting: Mapped[int] = mapped_column(default=0)
    products_unpictured: Mapped[int] = mapped_column(default=0)
    products_running: Mapped[int] = mapped_column(default=0)
    products_lacking: Mapped[int] = mapped_column(default=0)

    @hybrid_property
    def unended(self) -> int:
        """Number of its frames and products that have not ended."""
        return self.ready + self.running + self.products_waiting + self.products_running


class RenderNeedRow(Table):
    """A render that has to be done before another one begins."""

    __tablename__ = "render_needs"

    render: Mapped[str] = mapped_column(ForeignKey("renders.id", ondelete="CASCADE"), primary_key=True)
    needs: Mapped[str] = mapped_column(ForeignKey("renders.id", ondelete="CASCADE"), primary_key=True, index=True)


class FactRow(Table):
    """Something about the database itself, such as its `id`."""

    __tablename__ = "facts"

    name: Mapped[str] = mapped_column(primary_key=True)
    value: Mapped[str]


class TaskRow(Table):
    """A frame of a render. Its files, by format, are those of the attempt that drew it last."""

    __tablename__ = "render_tasks"
    __table_args__ = (
        Index("render_tasks_by_state", "render", "state", "frame"),
        Index("render_tasks_by_lease", "state", "lease_until"),
    )

    render: Mapped[str] = mapped_column(ForeignKey("renders.id", ondelete="CASCADE"), primary_key=True)
    frame: Mapped[int] = mapped_column(primary_key=True)
    state: Mapped[str]
    attempts: Mapped[int] = mapped_column(default=0)
    failures: Mapped[int] = mapped_column(default=0)
    losses: Mapped[int] = mapped_column(default=0)
    not_before: Mapped[float] = mapped_column(default=0.0)
    worker: Mapped[str | None]
    holder: Mapped[str | None]
    lease_until: Mapped[float | None]
    files: Mapped[dict[str, FileEntry]] = mapped_column(JSON, default=dict)


class AttemptRow(Table):
    """An attempt at a task."""

    __tablename__ = "render_attempts"
    __table_args__ = (
        ForeignKeyConstraint(["render", "frame"], ["render_tasks.render", "render_tasks.frame"], ondelete="CASCADE"),
    )

    render: Mapped[str] = mapped_column(primary_key=True)
    frame: Mapped[int] = mapped_column(primary_key=True)
    number: Mapped[int] = mapped_column(primary_key=True)
    worker: Mapped[str]
    started_at: Mapped[float]
    ended_at: Mapped[float | None]
    outcome: Mapped[str | None]
    error: Mapped[str | None]


class LogRow(Table):
    """Log of an attempt, and its size in UTF-8."""

    __tablename__ = "render_logs"
    __table_args__ = (
        ForeignKeyConstraint(
            ["render", "frame", "number"],
            ["render_attempts.render", "render_attempts.frame", "render_attempts.number"],
            ondelete="CASCADE",
        ),
    )

    render: Mapped[str] = mapped_column(primary_key=True)
    frame: Mapped[int] = mapped_column(primary_key=True)
    number: Mapped[int] = mapped_column(primary_key=True)
    size_bytes: Mapped[int]
    text: Mapped[str]


class EventRow(Table):
    """Something that has changed. Numbers rise in the order of commits, and none is given twice."""

    __tablename__ = "events"
    __table_args__ = {"sqlite_autoincrement": True}  # noqa: RUF012 - SQLAlchemy's own form

    number: Mapped[int] = mapped_column(BigInteger().with_variant(Integer, "sqlite"), primary_key=True)
    at: Mapped[float] = mapped_column(index=True)
    topic: Mapped[str]
    kind: Mapped[str]
    project: Mapped[str]
    shot: Mapped[str | None]
    render: Mapped[str | None]
    data: Mapped[dict[str, Any]] = mapped_column(JSON)


class WebhookRow(Table):
    """A receiver of events. `after` is the number of the last event that is delivered, or not wanted."""

    __tablename__ = "webhooks"

    id: Mapped[str] = mapped_column(primary_key=True)
    url: Mapped[str]
    secret: Mapped[str]
    project: Mapped[str | None]
    topics: Mapped[list[str]] = mapped_column(JSON)
    shot: Mapped[str | None]
    render: Mapped[str | None]
    created_at: Mapped[float]
    after: Mapped[int] = mapped_column(BigInteger)
    last_status: Mapped[int | None]
    last_error: Mapped[str | None]
    failures: Mapped[int] = mapped_column(default=0)
    failing_since: Mapped[float | None]
    next_try_at: Mapped[float | None]
    disabled: Mapped[str | None]
    worker: Mapped[str | None]
    lease_until: Mapped[float | None]
