"""Quotas: shots, bytes and processor time, over REST."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from threading import Event

import pytest

from service.http.quotas import size_of_edits
from service.http.settings import Settings
from service.identity.principal import SCOPES
from service.storage.store import ShotStore
from tests.service.conftest import ROOM, running, send, until


@pytest.fixture
def limited(tmp_path):
    def start(**quotas):
        return running(Settings(data=tmp_path, demo=False, trash_days=0, **quotas))

    return start


def refusal(answer) -> tuple[int, str]:
    return answer.status_code, answer.json()["code"]


def test_a_project_has_no_more_shots_than_it_may(limited):
    with limited(quota_shots=2) as service:
        client = service.client
        with ThreadPoolExecutor() as threads:  # at once: each is counted before it is stored
            answers = list(threads.map(lambda _: send(client, "room.usda", ROOM.encode()), range(4)))
        stored = [answer.json()["id"] for answer in answers if answer.status_code == 201]
        assert len(stored) == 2
        assert {refusal(answer) for answer in answers if answer.status_code != 201} == {(403, "quota_shots")}
        client.delete(f"/v1/shots/{stored[0]}")
        assert send(client, "room.usda", ROOM.encode()).status_code == 201
        usage = client.get("/v1/session").json()["usage"]
        assert (usage["shots"], usage["cpuS"]["allowed"]) == (None, None)  # for one who sees all projects
        mine = service.internal.quotas.usage("mara", "default")
        assert (mine.shots.used, mine.shots.allowed) == (2, 2)


def test_a_refused_upload_takes_no_room(limited):
    with limited(quota_shots=1) as service:
        assert send(service.client, "broken.usda", b"#usda 1.0 (").status_code == 422
        assert send(service.client, "room.usda", ROOM.encode()).status_code == 201


def test_a_shot_that_is_too_large_for_the_quota_leaves_nothing(limited):
    with limited(quota_stored_mb=1) as service:
        large = ROOM + "#" * (1 << 20)
        assert refusal(send(service.client, "large.usda", large.encode())) == (403, "quota_stored")
        assert service.client.get("/v1/shots").json()["shots"] == []
        assert send(service.client, "room.usda", ROOM.encode()).status_code == 201
        assert 0 < service.internal.quotas.usage("mara", "default").stored_mb.used < 0.1


@pytest.mark.parametrize("slow", ["begin", "list", "discard"])
def test_a_slow_disk_holds_up_an_upload_and_nobody_else(limited, monkeypatch, slow):
    with limited(quota_shots=1) as service:
        is_asked, may_go_on, original = Event(), Event(), getattr(ShotStore, slow)

        def wait(*args, **kwargs):
            is_asked.set()
            may_go_on.wait(30)
            return original(*args, **kwargs)

        monkeypatch.setattr(ShotStore, slow, wait)
        with ThreadPoolExecutor() as threads:
            answer = threads.submit(send, service.client, "broken.usda", b"#usda 1.0 (")
            try:
                assert is_asked.wait(30)
                assert service.client.get("/livez", timeout=10).status_code == 200
                if slow == "list":
                    listed = threads.submit(service.client.get, "/v1/shots")
                    assert service.client.get("/livez", timeout=10).status_code == 200
            finally:
                may_go_on.set()
            assert answer.result().status_code == 422
            assert slow != "list" or listed.result().status_code == 200


def test_the_shots_of_other_projects_do_not_count(limited):
    with limited(quota_shots=1) as service:
        for project in ("night-tram", "default"):
            assert send(service.client, "room.usda", ROOM.encode(), project=project).status_code == 201
        assert refusal(send(service.client, "room.usda", ROOM.encode())) == (403, "quota_shots")


def stored_mb(service) -> float:
    """Size of the shots of the project ``default`` with their edits, MiB."""
    return service.internal.quotas.usage("", "default").stored_mb.used


def test_edits_and_their_history_count(limited):
    with limited(quota_stored_mb=100) as service:
        shot = send(service.client, "room.usda", ROOM.encode()).json()["id"]
        assert service.client.patch(f"/v1/shots/{shot}/camera", json={"fStop": 2.8}).status_code == 200
        edits = service.internal.store.get(shot).edits_folder
        written = sum(file.stat().st_size for file in edits.rglob("*") if file.is_file())
        assert size_of_edits(service.internal.store.get(shot)) == written
        (edits / "history" / "large.usda").write_bytes(bytes(3 * 2**20))
        assert len(list(edits.rglob("*.usda"))) >= 3, "the edits, and two states of their history"
        assert stored_mb(service) == pytest.approx(3, abs=0.1), "it is measured again"


def test_work_is_refused_once_the_time_of_a_day_is_used_up(limited):
    with limited(quota_cpu_s_per_day=0.01, access="keys", requests_per_s=0) as service:
        keys = [service.app.state.identity.keys.create(name, SCOPES, "*")[1] for name in ("Mara", "Ida")]
        mara, ida = ({"Authorization": f"Bearer {key}"} for key in keys)
        service.client.headers.update(mara)
        shot = send(service.client, "room.usda", ROOM.encode()).json()["id"]
        until(lambda: service.client.get(f"/v1/shots/{shot}/inspect").status_code == 429)
        assert service.client.get("/v1/session").json()["usage"]["cpuS"]["used"] >= 0.01
        answer = service.client.get(f"/v1/shots/{shot}")
        assert refusal(answer) == (429, "quota_cpu")
        assert 0 < int(answer.headers["Retry-After"]) <= 24 * 3600
        assert service.client.get("/v1/shots").status_code == 200
        assert service.client.get(f"/v1/shots/{shot}", headers=ida).status_code == 200
    with limited(quota_cpu_s_per_day=0.01, access="keys") as service:  # which it remembers
        assert refusal(service.client.get(f"/v1/shots/{shot}", headers=mara)) == (429, "quota_cpu")


def test_a_service_without_quotas_tells_of_none(client):
    assert client.get("/v1/session").json()["usage"] is None
