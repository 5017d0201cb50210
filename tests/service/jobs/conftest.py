"""A queue over each kind of database, and its clock."""

from __future__ import annotations

import pytest

from tests.service.kits.queues import Clock, opened


@pytest.fixture
def clock():
    return Clock()


@pytest.fixture
def queue(tmp_path, clock, database):
    queue = opened(tmp_path, database, clock)
    yield queue
    queue.close()
