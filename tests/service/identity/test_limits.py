"""Rate limits, sessions and the audit log: bounded, and right at their edges."""

from __future__ import annotations

import json
import os
import stat

from service.identity import rate, sessions
from service.identity.audit import KEPT_FILES, AuditLog
from service.identity.rate import RateLimit
from service.identity.sessions import SESSION_S, Sessions


class Clock:
    """Time that is set by hand."""

    now_s = 0.0

    def __call__(self) -> float:
        return self.now_s


def test_a_line_that_the_disk_takes_in_part_is_left_out(tmp_path, monkeypatch, caplog):
    log, write = AuditLog(tmp_path / "audit.jsonl"), os.write
    log.write({"what": "first"})
    with monkeypatch.context() as full:
        full.setattr(os, "write", lambda descriptor, content: write(descriptor, content[:5]))
        log.write({"what": "second"})
    log.write({"what": "third"})
    lines = (tmp_path / "audit.jsonl").read_text().splitlines()
    assert [json.loads(line)["what"] for line in lines] == ["first", "third"]
    assert "second" in caplog.text


def test_a_bucket_empties_and_fills():
    clock = Clock()
    limit = RateLimit(2, 3, clock)
    assert [limit.take("a") for _ in range(4)] == [None, None, None, 1]
    assert limit.take("b") is None
    clock.now_s = 0.5
    assert [limit.take("a"), limit.take("a")] == [None, 1]
    clock.now_s = 100
    assert [limit.take("a") for _ in range(4)] == [None, None, None, 1]
    assert RateLimit(0.1, 1, clock).take("a") is None


def test_limits_and_sessions_use_bounded_memory(monkeypatch):
    monkeypatch.setattr(rate, "MAX_BUCKETS", 3)
    monkeypatch.setattr(sessions, "MAX_SESSIONS", 3)
    limit, opened = RateLimit(1, 1), Sessions()
    tokens = [opened.begin(f"key{n}") for n in range(5)]
    for name in "abcde":
        limit.take(name)
    assert len(limit._buckets) == len(opened._open) == 3
    assert [opened.key_id(token) for token in tokens] == [None, None, "key2", "key3", "key4"]


def test_one_key_does_not_end_the_sessions_of_others(monkeypatch):
    monkeypatch.setattr(sessions, "MAX_SESSIONS", 5)
    monkeypatch.setattr(sessions, "MAX_SESSIONS_EACH", 3)
    opened = Sessions()
    other = opened.begin("other")
    own = [opened.begin("own") for _ in range(20)]
    assert opened.key_id(other) == "other"
    assert [token for token in own if opened.key_id(token)] == own[-3:]


def test_a_session_ends():
    clock = Clock()
    opened = Sessions(clock)
    first, second = opened.begin("a"), opened.begin("b")
    opened.end(first)
    assert (opened.key_id(first), opened.key_id(second), opened.key_id("x")) == (None, "b", None)
    clock.now_s = SESSION_S
    assert opened.key_id(second) is None


def test_the_audit_log_is_private_and_rotates(tmp_path):
    log = AuditLog(tmp_path / "audit.jsonl", max_bytes=100)
    for n in range(40):
        log.write({"n": n, "path": "/v1\n{"})
    files = sorted(tmp_path.iterdir())
    assert len(files) == KEPT_FILES + 1
    assert all(stat.S_IMODE(file.stat().st_mode) == 0o600 and file.stat().st_size <= 100 for file in files)
    lines = [json.loads(line) for line in (tmp_path / "audit.jsonl").read_text().splitlines()]
    assert lines[-1]["n"] == 39


def test_an_audit_line_that_cannot_be_written_is_logged(tmp_path, caplog):
    AuditLog(tmp_path / "none" / "audit.jsonl").write({"path": "/v1/shots"})
    assert "/v1/shots" in caplog.text


def test_half_a_line_of_a_crash_spoils_no_other(tmp_path):
    file = tmp_path / "audit.jsonl"
    AuditLog(file).write({"n": 1})
    with file.open("a") as cut:
        cut.write('{"n": 2, "pa')
    AuditLog(file).write({"n": 3})
    first, _, last = file.read_text().splitlines()
    assert (json.loads(first), json.loads(last)) == ({"n": 1}, {"n": 3})
