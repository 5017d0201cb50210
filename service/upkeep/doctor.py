"""Checks of what a service needs of its machine: each is one finding, with what to do where it is not well."""

from __future__ import annotations

import json
import os
import platform
import resource
import shutil
import socket
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any, Literal

from render.errors import OutputError, PullfocusError, SettingsError
from service.http.settings import Settings
from service.identity.issuer import Issuer
from service.storage.bucket import Bucket
from service.storage.database.address import address_of, name_of
from service.storage.database.connection import revisions
from service.storage.database.file import DATABASE, noted_database
from service.storage.migration import LAYOUT, layout_of
from service.workers import sandbox

State = Literal["ok", "warn", "fail"]

LEAST_FREE_BYTES = 1024**3
LITTLE_FREE_BYTES = 10 * 1024**3
LEAST_FILES = 1024
_PROBE_S = 60.0


@dataclass(frozen=True)
class Finding:
    """Result of one check.

    Attributes:
        name: of the check.
        state: ``ok``, ``warn`` where the service runs but not well, ``fail`` where it does not run.
        text: what was found.
        remedy: what to do; empty where it is ok.
    """

    name: str
    state: State
    text: str
    remedy: str = ""


def examine(settings: Settings) -> Iterator[Finding]:
    """Make every check, the quick ones first.

    Args:
        settings: of the service.
    """
    yield Finding("python", "ok", f"Python {platform.python_version()}, pullfocus {version('pullfocus')}")
    yield _kernel()
    yield _confinement()
    yield from _limits()
    yield _port(settings.host, settings.port)
    yield _data(settings.data)
    yield _disk(settings.data)
    yield _database(settings.data, settings.database)
    if settings.bucket:
        yield _bucket(settings.bucket, settings.bucket_endpoint)
    if settings.oidc_issuer:
        yield _issuer(settings.oidc_issuer)
    yield _probe("libraries", "reinstall pullfocus with its dependencies")
    yield _probe("gl", "install Mesa's EGL (libegl1, libgl1-mesa-dri), or give the process access to the GPU's device")


def _issuer(address: str) -> Finding:
    try:
        keys = Issuer(address).fetch_keys()
    except (SettingsError, OSError, ValueError) as error:
        remedy = "compare oidc_issuer with what the issuer's own page of settings (discovery) says, and let the service reach it"
        return Finding("issuer", "fail", f"{address}: {error}", remedy)
    if not keys:
        return Finding(
            "issuer", "fail", f"{address} has no public keys that can be used", "have it sign by RSA or EC keys"
        )
    return Finding("issuer", "ok", f"{address} has {len(keys)} keys")


def _kernel() -> Finding:
    name = f"{platform.system()} {platform.release()} on {platform.machine()}, {os.cpu_count()} cores"
    if platform.system() != "Linux":
        return Finding("kernel", "warn", name, "the service is made for Linux: its workers are not confined elsewhere")
    return Finding("kernel", "ok", name)


def _confinement() -> Finding:
    support = sandbox.support()
    if support.landlock_abi and support.seccomp:
        return Finding("sandbox", "ok", support.describe())
    remedy = "use a kernel with Landlock and seccomp before strangers may send shots"
    return Finding("sandbox", "warn", support.describe(), remedy)


def _limits() -> Iterator[Finding]:
    files = resource.getrlimit(resource.RLIMIT_NOFILE)[0]
    text = f"{files:,} open files"
    if files != resource.RLIM_INFINITY and files < LEAST_FILES:
        yield Finding(
            "limits", "warn", text, f"raise it for many viewers: ulimit -n {LEAST_FILES}, or LimitNOFILE of systemd"
        )
    else:
        yield Finding("limits", "ok", text)
    address_space = resource.getrlimit(resource.RLIMIT_AS)[0]
    if address_space != resource.RLIM_INFINITY:
        text = f"the address space is limited to {address_space / 1024**3:.1f} GiB"
        yield Finding("limits", "warn", text, "drivers of GPUs reserve far more than they use: ulimit -v unlimited")


def _port(host: str, port: int) -> Finding:
    try:
        family = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0][0]
        with socket.create_server((host, port), family=family):
            return Finding("port", "ok", f"{host}:{port} is free")
    except OSError as error:
        text = f"{host}:{port}: {error.strerror or error}"
        return Finding("port", "warn", text, "a service runs there already, or choose another with --port")


def _data(data: Path) -> Finding:
    existing = next(folder for folder in (data, *data.parents) if folder.exists())
    try:
        with tempfile.TemporaryFile(dir=existing):
            pass
        layout = layout_of(data) if (data / "shots").is_dir() else LAYOUT
    except (OSError, OutputError) as error:
        remedy = "give the user of the service write access, or choose another folder with --data"
        return Finding("data", "fail", f"{existing} cannot be used: {error}", remedy)
    if layout < LAYOUT:
        text = f"{data} has layout {layout}; it is brought to layout {LAYOUT} at the next start"
        return Finding("data", "warn", text, "back it up before: pullfocus backup")
    return Finding(
        "data", "ok", f"{data} can be written" if data.exists() else f"{data} will be made at the first start"
    )


def _disk(data: Path) -> Finding:
    existing = next(folder for folder in (data, *data.parents) if folder.exists())
    free = shutil.disk_usage(existing).free
    state: State = "fail" if free < LEAST_FREE_BYTES else "warn" if free < LITTLE_FREE_BYTES else "ok"
    remedy = "" if state == "ok" else "make room, or choose a folder on a larger disk with --data"
    return Finding("disk", state, f"{free / 1024**3:.1f} GiB are free", remedy)


def _database(data: Path, setting: str) -> Finding:
    noted = noted_database(data)
    if noted is not None and not setting:
        text = f"the service has last used the database {noted}, which these settings do not name"
        return Finding("database", "warn", text, "name its configuration: pullfocus doctor --config FILE")
    if not setting and not (data / DATABASE).exists():
        return Finding("database", "ok", "SQLite, which will be made in the data folder at the first start")
    try:
        name = name_of(address_of(data, setting))
        present, known = revisions(data, setting)
    except PullfocusError as error:
        remedy = "let the service reach the server and sign in (~/.pgpass)" if setting else "restore the last backup"
        return Finding("database", "fail", str(error), remedy)
    if present is None:
        return Finding("database", "ok", f"{name} answers; its tables will be made at the first start")
    if present not in known:
        text = f"{name} has tables of revision {present}, which a newer version of pullfocus wrote"
        return Finding("database", "fail", text, "install that version")
    if present != known[0]:
        text = f"{name} has tables of revision {present}; they are brought to {known[0]} at the next start"
        return Finding("database", "warn", text, "back it up before")
    return Finding("database", "ok", f"{name} answers, and has tables of revision {present}")


def _bucket(setting: str, endpoint: str) -> Finding:
    try:
        Bucket(setting, endpoint).check()
    except PullfocusError as error:
        remedy = "set AWS_ACCESS_KEY_ID and AWS_SECRET_ACCESS_KEY, and see whether the server answers"
        return Finding("bucket", "fail", str(error), remedy)
    return Finding("bucket", "ok", f"{setting} answers")


def _probe(what: str, remedy: str) -> Finding:
    """Ask the libraries of the workers in a process of its own."""
    command = [sys.executable, "-m", "service.upkeep.probe", what]
    try:
        asked = subprocess.run(command, capture_output=True, text=True, timeout=_PROBE_S, stdin=subprocess.DEVNULL)
    except subprocess.TimeoutExpired:
        return Finding(what, "fail", f"no answer within {_PROBE_S:g} s", remedy)
    if asked.returncode:
        said = asked.stderr.strip().splitlines() or [f"the process ended with status {asked.returncode}"]
        return Finding(what, "fail", said[-1], remedy)
    answer: dict[str, Any] = json.loads(asked.stdout.splitlines()[-1])
    return Finding(what, "ok", ", ".join(f"{name} {text}" for name, text in answer.items()))
