"""The Dockerfile: what an image is made of, whom it runs as, and how it is started."""

from __future__ import annotations

import json
import re
import socket
import subprocess
import sys
from http.server import BaseHTTPRequestHandler, HTTPServer
from importlib import metadata
from pathlib import Path
from threading import Thread

import pytest
from docker.utils.build import exclude_paths
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from tests.docker.kits.commands import parse
from tests.docker.kits.files import (
    DOCKER,
    ROOT,
    VERSION,
    Stage,
    exec_form,
    image_environment,
    inherited,
    last,
    read_stages,
)

TARGETS = ("service", "worker")
VENDORS = "/usr/share/glvnd/egl_vendor.d"
EXTRAS = ("dask", "postgresql", "s3", "tracing")


@pytest.fixture(scope="module")
def stages() -> dict[str, Stage]:
    return read_stages()


@pytest.fixture(scope="module")
def sent(tmp_path_factory) -> set[str]:
    """Files that a build is sent, out of a folder with some that it must not be."""
    folder = tmp_path_factory.mktemp("context")
    tracked = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True).stdout.split(
        "\n"
    )
    strange = (
        ".git/config",
        ".venv/bin/python",
        "web/node_modules/vite/index.js",
        "docker/.env",
        "service/static/index.html",
        "render/__pycache__/frame.cpython-311.pyc",
        "pullfocus.egg-info/PKG-INFO",
        "build/docs/index.html",
    )
    for name in (*filter(None, tracked), *strange):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).touch()
    patterns = (ROOT / ".dockerignore").read_text().splitlines()
    found = exclude_paths(str(folder), [line for line in patterns if line and not line.startswith("#")])
    return {name for name in found if (folder / name).is_file()}


def test_a_build_is_sent_sources_alone(sent) -> None:
    parts = {part for name in sent for part in Path(name).parts}
    assert not parts & {".git", ".venv", "node_modules", ".env", "static", "__pycache__", "tests", "build"}
    assert not [name for name in sent if name.endswith((".pyc", ".env")) or "egg-info" in name]
    assert {"service/http/app.py", "web/package-lock.json", "render/cli/main.py"} <= sent


def test_what_is_copied_was_sent(stages, sent) -> None:
    copied = [
        source
        for stage in stages.values()
        for word, argument in stage.instructions
        if word == "COPY" and not argument.startswith("--from")
        for source in argument.split()[:-1]
    ]
    assert len(copied) > 10
    for source in copied:
        assert any(name == source or name.startswith(f"{source}/") for name in sent), source


def test_stages_come_from_stages_and_pinned_images(stages) -> None:
    images = {stage.base for stage in stages.values()} - set(stages)
    assert images
    for image in images:
        assert re.fullmatch(r"[a-z]+:\d+\.\d+[\w.-]*", image), f"{image} has no exact version, or names a registry"
    copied = re.findall(r"^COPY --from=(\S+)", (DOCKER / "Dockerfile").read_text(), re.MULTILINE)
    assert set(copied) <= set(stages)


@pytest.mark.parametrize(
    ("graphics", "left"), [("mesa", "50_mesa.json"), ("nvidia", "10_nvidia.json"), ("other", None)]
)
def test_an_image_sees_one_driver(stages, tmp_path, graphics, left) -> None:
    """The step of the Dockerfile that chooses it is run in a folder that stands for glvnd's."""
    (step,) = [argument for word, argument in stages["runtime"].instructions if "GRAPHICS}" in argument]
    assert ("COPY", f"docker/10_nvidia.json {VENDORS}/") in stages["runtime"].instructions
    for name in ("10_nvidia.json", "50_mesa.json"):
        (tmp_path / name).touch()
    command = ["sh", "-c", step.replace(VENDORS, str(tmp_path))]
    done = subprocess.run(
        command, env={"GRAPHICS": graphics, "PATH": "/usr/bin:/bin"}, stderr=subprocess.DEVNULL, check=False
    )
    assert (done.returncode == 0) == (left is not None)
    if left:
        assert [file.name for file in tmp_path.iterdir()] == [left]


def test_an_image_asks_for_the_graphics_of_a_gpu(stages) -> None:
    asked = image_environment(inherited(stages, "runtime"))["NVIDIA_DRIVER_CAPABILITIES"]
    assert {"graphics", "compute", "utility"} <= set(asked.split(","))
    vendor = json.loads((DOCKER / "10_nvidia.json").read_text())
    assert vendor["ICD"]["library_path"] == "libEGL_nvidia.so.0"


@pytest.mark.parametrize("target", TARGETS)
def test_an_image_runs_as_a_user_with_a_fixed_number(stages, target) -> None:
    made = inherited(stages, target)
    uid, gid = map(int, last(made, "USER").split(":"))
    assert uid > 0
    assert gid > 0
    (making,) = [argument for word, argument in made if "useradd" in argument]
    assert f"--uid {uid} --gid {gid}" in making
    after = made[[word for word, _ in made].index("USER") + 1 :]
    assert not {"RUN", "COPY", "ADD"} & {word for word, _ in after}, "files of the program belong to root"


@pytest.mark.parametrize("target", TARGETS)
def test_an_image_writes_to_its_volumes_alone(stages, target) -> None:
    made = inherited(stages, target)
    volumes = set(exec_form(last(made, "VOLUME")))
    environment = image_environment(made)
    assert {environment[name] for name in ("HOME", "TMPDIR", "XDG_CACHE_HOME")} <= volumes
    assert last(made, "WORKDIR") in volumes
    assert (environment["XDG_DATA_HOME"] in volumes) == (target == "service")
    assert environment["PYTHONDONTWRITEBYTECODE"] == "1"


@pytest.mark.parametrize("target", TARGETS)
def test_an_image_starts_and_stops_its_program_itself(stages, target) -> None:
    made = inherited(stages, target)
    parse([*exec_form(last(made, "ENTRYPOINT")), *exec_form(last(made, "CMD"))])
    assert last(made, "STOPSIGNAL") == "SIGTERM"


def test_the_health_check_asks_where_the_service_listens(stages) -> None:
    made = inherited(stages, "service")
    *_, port, path = exec_form(last(made, "HEALTHCHECK"))
    assert port == last(made, "EXPOSE")
    assert path == "/livez"


def test_the_labels_state_the_version_of_the_program(stages) -> None:
    made = inherited(stages, "service")
    assert f"VERSION={VERSION}" in [argument for word, argument in made if word == "ARG"]
    labels = " ".join(argument for word, argument in made if word == "LABEL")
    named = set(re.findall(r"org\.opencontainers\.image\.(\w+)=", labels))
    assert {"title", "description", "version", "revision", "licenses"} <= named


def test_an_image_has_what_the_program_needs() -> None:
    """The selection is held against what the installed packages themselves say they need."""
    command = [sys.executable, DOCKER / "select_requirements.py"]
    selected = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    pinned = set(re.findall(r"^([a-z0-9-]+)==", selected, re.MULTILINE))
    assert needs("pullfocus", EXTRAS) <= pinned
    assert not {"pytest", "playwright", "mkdocs", "ruff", "mypy", "uv", "setuptools"} & pinned
    hashes = re.findall(r"^[^\s#][^#]*?(?=^\S|\Z|^    #)", selected, re.MULTILINE)
    assert all("--hash=sha256:" in entry for entry in hashes)


def needs(name: str, extras: tuple[str, ...] = (), known: frozenset[str] = frozenset()) -> set[str]:
    """Find all that an installed package needs on this machine, by its own metadata."""
    found: set[str] = set()
    for text in metadata.requires(name) or ():
        requirement = Requirement(text)
        marker = requirement.marker
        if marker is None or any(marker.evaluate({"extra": extra}) for extra in (*extras, "")):
            needed = canonicalize_name(requirement.name)
            if needed not in known | found:
                found |= {needed} | needs(needed, tuple(requirement.extras), known | found | {needed})
    return found


class _Answer(BaseHTTPRequestHandler):
    def do_GET(self) -> None:
        self.send_response(200 if self.path == "/livez" else 503)
        self.end_headers()

    def log_message(self, *_: object) -> None:
        """Be silent."""


def health(*arguments: object) -> int:
    """Run a health check as a container does, and return its exit status."""
    command = [sys.executable, "-S", DOCKER / "health.py", *map(str, arguments)]
    return subprocess.run(command, stderr=subprocess.DEVNULL, check=False).returncode


def test_a_server_is_well_while_it_answers_200() -> None:
    with HTTPServer(("127.0.0.1", 0), _Answer) as server:
        Thread(target=server.serve_forever, daemon=True).start()
        assert health("http", server.server_port, "/livez") == 0
        assert health("http", server.server_port, "/readyz") == 1
        server.shutdown()
    assert health("http", server.server_port, "/livez") == 1


def test_a_worker_is_well_while_it_is_connected() -> None:
    with socket.create_server(("127.0.0.1", 0)) as scheduler:
        port = scheduler.getsockname()[1]
        assert health("joined", port) == 1
        with socket.create_connection(("127.0.0.1", port)):
            assert health("joined", port) == 0
    assert health("joined", port) == 1


def test_a_health_check_of_another_kind_is_refused() -> None:
    assert health("joined") == health("http", "port", "/") == health() == 2


def test_hadolint_finds_nothing() -> None:
    command = [Path(sys.executable).with_name("hadolint"), "--no-color", DOCKER / "Dockerfile"]
    found = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (found.returncode, found.stdout) == (0, "")
