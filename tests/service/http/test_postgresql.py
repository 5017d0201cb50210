"""A service whose renders are in PostgreSQL."""

from __future__ import annotations

import pytest

from render.cli.main import main
from service.http.settings import Settings
from service.upkeep.command import backup, restore
from tests.service.conftest import running, send, until

SMALL = {"width": 64, "rays": 4, "engine": "pinhole", "formats": ["png"]}


@pytest.mark.gl
def test_a_service_draws_renders_over_postgresql(tmp_path, postgresql, postgresql_database, room_file, capsys):
    data = tmp_path / "data"
    settings = Settings(data=data, demo=False, database=postgresql_database)
    with running(settings) as service:
        client = service.client
        room = send(client, "room.usda", room_file.read_bytes()).json()["id"]
        sent = client.post("/v1/renders", json=SMALL | {"shot": room, "frames": "1"})
        assert sent.status_code == 201, sent.text
        address = f"/v1/renders/{sent.json()['id']}"
        until(lambda: client.get(address).json()["state"] == "done")
        assert client.get(f"{address}/frames/1").content.startswith(b"\x89PNG")
        assert client.get("/v1/renders/r-%00").status_code == 404
        postgresql.stop()
        try:
            answer = client.get(address)
            assert (answer.status_code, answer.json()["code"]) == (503, "queue_unusable")
            assert "pullfocus-postgresql" not in answer.text  # clients are not told where it is
            assert client.get(f"/v1/shots/{room}/frame", params={"width": 64, "rays": 4, "time": 1}).status_code == 200
        finally:
            postgresql.start()
        again = client.post("/v1/renders", json=SMALL | {"shot": room, "frames": "2"}).json()
        until(lambda: client.get(f"/v1/renders/{again['id']}").json()["state"] == "done")
    assert not (data / "renders.sqlite").exists()
    assert backup([str(tmp_path / "b.tar.gz"), "--data", str(data)]) == 0
    assert "back up the database 'postgres' of PostgreSQL" in capsys.readouterr().err
    assert restore([str(tmp_path / "b.tar.gz"), "--data", str(tmp_path / "restored")]) == 0
    assert "'postgres' of PostgreSQL" in capsys.readouterr().err


def test_a_database_that_cannot_be_opened_ends_the_start(tmp_path, capfd):
    pytest.importorskip("psycopg")
    configuration = tmp_path / "studio.toml"
    configuration.write_text('data = "data"\nport = 0\ndatabase = "postgresql://mara:pa55word@127.0.0.1:1/renders"\n')
    assert main(["serve", "--config", str(configuration)]) == 1
    said = capfd.readouterr().err
    assert "the database of renders 'renders' of PostgreSQL on 127.0.0.1 cannot be opened" in said
    assert "pa55word" not in said
    assert "Traceback" not in said
