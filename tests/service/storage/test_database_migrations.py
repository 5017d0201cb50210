"""The database of an older version is brought to the present tables, with what it holds."""

from __future__ import annotations

import json
import sqlite3
from pathlib import Path

from alembic import command
from alembic.config import Config
from sqlalchemy import create_engine

import service.storage.database.migrations
from service.jobs.states import state_of
from service.storage.database.file import DATABASE
from tests.service.kits.queues import opened

MIGRATIONS = Path(service.storage.database.migrations.__file__).parent


def database_of_version(folder: Path, revision: str) -> sqlite3.Connection:
    """A database as a version with this revision of the tables makes it."""
    config = Config()
    config.set_main_option("script_location", str(MIGRATIONS))
    engine = create_engine(f"sqlite:///{folder / DATABASE}")
    with engine.begin() as connection:
        config.attributes["connection"] = connection
        command.upgrade(config, revision)
    engine.dispose()
    return sqlite3.connect(folder / DATABASE)


def insert(database: sqlite3.Connection, table: str, **values: object) -> None:
    names, places = ", ".join(values), ", ".join("?" * len(values))
    database.execute(f"INSERT INTO {table} ({names}) VALUES ({places})", tuple(values.values()))


def test_a_render_of_before_products_has_none_and_goes_on(tmp_path: Path) -> None:
    database = database_of_version(tmp_path, "0006")
    texts = dict.fromkeys(("name", "project", "owner", "owner_label", "digest", "shot", "shot_created_at"), "x")
    numbers = dict.fromkeys(("priority", "not_before", "busy_s", "running", "failed", "canceled", "stored_bytes"), 0)
    more = {"edits": "", "revision": "", "request": json.dumps({"formats": ["png"]}), "frames": "1", "count": 1}
    insert(database, "renders", **texts | numbers | more, id="r-1", wanted="run", created_at=1.0, ready=1, done=0)
    insert(
        database, "render_tasks", render="r-1", frame=1, attempts=0, failures=0, not_before=0, state="ready", files="{}"
    )
    database.commit()
    database.close()

    queue = opened(tmp_path)
    try:
        before = queue.get("r-1")
        assert (before.products, before.unended, queue.products.claim(60)) == ({}, 1, None)
        claim = queue.claim("one", 60)
        assert claim is not None
        queue.finish(claim, {"png": {"size_bytes": 8, "sha256": "def"}}, 24)
        assert (queue.get("r-1").unended, state_of(queue.get("r-1"))) == (0, "done")
    finally:
        queue.close()


def test_a_frame_with_one_file_keeps_it_and_its_attempts(tmp_path: Path) -> None:
    database = database_of_version(tmp_path, "0001")
    texts = dict.fromkeys(("name", "project", "owner", "owner_label", "digest", "shot", "shot_created_at"), "x")
    numbers = dict.fromkeys(("priority", "not_before", "busy_s", "running", "failed", "canceled"), 0)
    insert(
        database,
        "renders",
        **texts | numbers,
        id="r-1",
        edits="",
        revision="",
        request=json.dumps({"rays": 4, "format": "png"}),
        frames="1-2",
        count=2,
        wanted="run",
        created_at=1.0,
        stored_bytes=12,
        ready=1,
        done=1,
    )
    task = {"render": "r-1", "failures": 0, "not_before": 0}
    insert(database, "render_tasks", **task, frame=1, attempts=1, state="done", size_bytes=12, sha256="abc")
    insert(database, "render_tasks", **task, frame=2, attempts=0, state="ready")
    insert(
        database,
        "render_attempts",
        render="r-1",
        frame=1,
        number=1,
        worker="one",
        started_at=1.0,
        ended_at=2.0,
        outcome="done",
    )
    database.commit()
    database.close()

    queue = opened(tmp_path)
    try:
        assert queue.get("r-1").request == {"rays": 4, "formats": ["png"]}
        (drawn, attempts), (waiting, none) = queue.tasks("r-1")
        assert drawn.files == {"png": {"size_bytes": 12, "sha256": "abc"}}
        assert (waiting.files, [attempt.outcome for attempt in attempts], list(none)) == ({}, ["done"], [])
        claim = queue.claim("one", 60)
        assert claim is not None
        assert queue.finish(claim, {"png": {"size_bytes": 8, "sha256": "def"}}, 25)
        assert queue.get("r-1").time_codes_per_second == 25
        assert queue.totals.stored_bytes("x") == 20
        queue.products.note_size("r-1", 100)
        assert queue.totals.stored_bytes("x") == 120
    finally:
        queue.close()
