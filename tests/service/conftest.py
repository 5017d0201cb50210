"""A real service on a free port, and small shots to send to it."""

from __future__ import annotations

import secrets
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import httpx
import pytest
import uvicorn
from moto.server import ThreadedMotoServer

from service.bench.postgresql import PostgresqlServer
from service.http.app import create_app
from service.http.connections import server_config
from service.http.service import Service
from service.http.settings import Settings
from tests.service.kits.postgresql import empty_database, running_postgresql


@dataclass(frozen=True)
class Running:
    """A service that runs, a client of it, and the settings that it runs with."""

    client: httpx.Client
    settings: Settings
    app: object

    def worker(self, role: str, shot: str) -> int:
        """Process id of the one worker of a role that serves a shot."""
        workers = self.internal.pool.processes()
        (pid,) = [worker.pid for worker in workers if (worker.role.name, worker.place.key) == (role, shot)]
        return pid

    def working(self, role: str, shot: str) -> int:
        """Process id of the one worker of a role that serves a shot, once it works on a call: it has used a second."""
        until(
            lambda: any(worker.role.name == role and worker.cpu_s() > 1.0 for worker in self.internal.pool.processes())
        )
        return self.worker(role, shot)

    @property
    def internal(self) -> Service:
        """The application's queues, caches and counters."""
        return self.app.state.service


@contextmanager
def running(settings: Settings, forwarded_allow_ips: Sequence[str] = ()) -> Iterator[Running]:
    """Run a service in a thread of this process (its workers are processes of their own, as always)."""
    app = create_app(settings)
    server = uvicorn.Server(
        server_config(app, settings, port=0, proxy_headers=True, forwarded_allow_ips=list(forwarded_allow_ips))
    )
    thread = threading.Thread(target=server.run)
    thread.start()
    try:
        while not server.started:
            assert thread.is_alive(), "the service did not start"
            time.sleep(0.01)
        port = server.servers[0].sockets[0].getsockname()[1]
        with httpx.Client(base_url=f"http://127.0.0.1:{port}", timeout=120) as client:
            yield Running(client, settings, app)
    finally:
        server.should_exit = True
        thread.join()


@pytest.fixture(scope="session")
def service(tmp_path_factory) -> Iterator[Running]:
    """The service that most tests share, with limits that a small bomb or a few bytes too many can reach."""
    data = tmp_path_factory.mktemp("data")
    settings = Settings(data=data, demo=False, max_upload_mb=2, max_unpacked_mb=80, max_archive_entries=50)
    with running(settings) as service:
        yield service


@pytest.fixture
def client(service) -> httpx.Client:
    return service.client


@pytest.fixture(scope="session")
def postgresql() -> Iterator[PostgresqlServer]:
    """The PostgreSQL that the tests of a process share; skipped where none is installed."""
    with running_postgresql() as server:
        yield server


@pytest.fixture
def postgresql_database(postgresql) -> Iterator[str]:
    """Address of an empty database of PostgreSQL."""
    with empty_database(postgresql) as url:
        yield url


@pytest.fixture(scope="session")
def s3_endpoint() -> Iterator[str]:
    """Address of a server of S3 that the tests of a process share."""
    server = ThreadedMotoServer(ip_address="127.0.0.1", port=0, verbose=False)
    server.start()
    host, port = server.get_host_and_port()
    yield f"http://{host}:{port}"
    server.stop()


@pytest.fixture
def bucket(s3_endpoint, monkeypatch) -> dict[str, str]:
    """The settings of an empty bucket, which this process may use."""
    for name in ("AWS_ACCESS_KEY_ID", "AWS_SECRET_ACCESS_KEY"):
        monkeypatch.setenv(name, "testing")
    name = f"pullfocus-{secrets.token_hex(4)}"
    httpx.put(f"{s3_endpoint}/{name}").raise_for_status()
    return {"bucket": f"s3://{name}/studio", "bucket_endpoint": s3_endpoint}


@pytest.fixture(params=["sqlite", "postgresql"])
def database(request) -> str:
    """The setting `database` of an empty database of each kind."""
    return "" if request.param == "sqlite" else request.getfixturevalue("postgresql_database")


ROOM = """#usda 1.0
(
    defaultPrim = "World"
    metersPerUnit = 1
    upAxis = "Y"
    startTimeCode = 1
    endTimeCode = 24
    framesPerSecond = 24
    timeCodesPerSecond = 24
)

def Xform "World"
{
    def Camera "cam"
    {
        float focalLength = 0.5
        float horizontalAperture = 0.36
        float verticalAperture = 0.2025
        float fStop = 1.4
        float focusDistance = 3
        float2 clippingRange = (0.1, 100)
    }

    def Mesh "near"
    {
        int[] faceVertexCounts = [4]
        int[] faceVertexIndices = [0, 1, 2, 3]
        point3f[] points = [(-1, -0.6, -3), (0, -0.6, -3), (0, 0.6, -3), (-1, 0.6, -3)]
        color3f[] primvars:displayColor = [(0.8, 0.3, 0.1)]
    }

    def Mesh "far"
    {
        int[] faceVertexCounts = [4]
        int[] faceVertexIndices = [0, 1, 2, 3]
        point3f[] points = [(0, -1.5, -8), (3, -1.5, -8), (3, 1.5, -8), (0, 1.5, -8)]
        color3f[] primvars:displayColor = [(0.1, 0.3, 0.8)]
    }

    def DistantLight "sun"
    {
        float inputs:intensity = 3
        bool inputs:normalize = 1
    }
}
"""


@pytest.fixture(scope="session")
def room_file(tmp_path_factory) -> Path:
    """A shot of two cards, one three metres away and one eight."""
    file = tmp_path_factory.mktemp("room") / "room.usda"
    file.write_text(ROOM)
    return file


def until(true: Callable[[], bool]) -> None:
    """Wait for something to become true; the test's own time limit ends it."""
    while not true():
        time.sleep(0.005)


def hold_back(queue: object, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the service claim nothing more of a queue; what it had begun to claim is claimed."""
    looks: list[tuple[object, ...]] = []
    monkeypatch.setattr(queue, "claim", lambda *given: looks.append(given))  # which returns None
    until(lambda: bool(looks))


def is_running(process_id: int) -> bool:
    """Whether a process is there and no zombie."""
    time.sleep(0.02)
    try:
        with open(f"/proc/{process_id}/stat") as stat:
            return stat.read().rsplit(")", 1)[1].split()[0] != "Z"
    except FileNotFoundError:
        return False


def send(client: httpx.Client, name: str, content: bytes, **fields: str) -> httpx.Response:
    """Upload a file."""
    return client.post("/v1/shots", files={"file": (name, content)}, data=fields)


@pytest.fixture
def room(client, room_file) -> Iterator[str]:
    """The room as a shot of the service; its id."""
    sent = send(client, "room.usda", room_file.read_bytes())
    assert sent.status_code == 201, sent.text
    yield sent.json()["id"]
    client.delete(f"/v1/shots/{sent.json()['id']}")
