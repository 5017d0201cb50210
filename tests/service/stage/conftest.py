"""A shot on disk, as the store has it."""

from __future__ import annotations

from datetime import UTC, datetime

import pytest

from service.storage.store import ShotRecord
from tests.service.conftest import ROOM


@pytest.fixture
def record(tmp_path) -> ShotRecord:
    made = ShotRecord("room", "room.usda", tmp_path, "room.usda", datetime.now(UTC), 0, 0)
    made.files.mkdir()
    made.root_path.write_text(ROOM)
    return made
