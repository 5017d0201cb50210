"""schemathesis asks a service that needs keys everything that its OpenAPI document allows and forbids, along its links too.

Each phase runs to its end, with a stated number of cases, against a service of its own.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

from service.http import identity
from service.http.settings import Settings
from service.identity.principal import SCOPES
from tests.service.conftest import Running, running

CASES = {"examples": 150, "coverage": 7000, "fuzzing": 250, "stateful": 150}
"""Phases, and the requests that each sends at least."""
MAX_EXAMPLES = {"fuzzing": 3, "stateful": 30}
"""Requests for an operation of each kind, valid or not; sequences of requests along links."""
ACCEPTED = ["2xx", "3xx", 404, 409, 412, 429]
"""Answers to valid data: what it names may be missing, or have changed."""
JUDGED = [*ACCEPTED, 413, 415, 422]
"""Answers to valid data of operations that take a camera, a file or a body: no schema says what fits a shot."""


def configuration(document: dict) -> str:
    """The configuration of schemathesis: which answers to valid data each operation may give."""
    judged = [
        operation["operationId"]
        for methods in document["paths"].values()
        for operation in methods.values()
        if operation["operationId"] != "signIn"
        and ("requestBody" in operation or any(given["name"] == "camera" for given in operation.get("parameters", ())))
    ]
    return f"""
[checks.positive_data_acceptance]
expected-statuses = {json.dumps(ACCEPTED)}
[[operations]]
include-operation-id = {json.dumps(judged)}
[operations.checks.positive_data_acceptance]
expected-statuses = {json.dumps(JUDGED)}
[[operations]]
include-operation-id = "signIn"
[operations.checks.positive_data_acceptance]
expected-statuses = {json.dumps([*ACCEPTED, 401])}
"""


def command(service: Running, phase: str, config: Path) -> list[str]:
    """The command that runs one phase, with a key for everything."""
    _, key = service.app.state.identity.keys.create("schemathesis", SCOPES, "*")
    asked = [sys.executable, "-m", "schemathesis.cli", "--config-file", str(config), "run"]
    asked += [f"{service.client.base_url}/openapi.json", "--header", f"Authorization: Bearer {key}"]
    asked += ["--phases", phase, "--seed", "1", "--generation-database", "none"]
    asked += ["--max-examples", str(MAX_EXAMPLES.get(phase, 1))]
    asked += ["--checks", "all", "--exclude-operation-id", "watch", "--continue-on-failure"]
    return [*asked, "--request-timeout", "120", "--max-response-time", "60", "--warnings", "off", "--no-color"]


@pytest.mark.parametrize("phase", CASES)
def test_no_answer_breaks_the_document(tmp_path, phase, monkeypatch):
    monkeypatch.setattr(identity, "FAILURES", 10**6)  # wrong keys are sent, too, and refused without being slowed down
    settings = Settings(
        data=tmp_path / "data",
        access="keys",
        requests_per_s=0,
        max_waiting=8,
        max_picture_px=30_000,
        max_picture_s=2,
        max_curve_frames=200,
    )
    with running(settings) as service:
        config = tmp_path / "schemathesis.toml"
        config.write_text(configuration(service.app.openapi()))
        asked = subprocess.run(command(service, phase, config), capture_output=True, text=True, cwd=tmp_path)
        assert service.client.get("/livez").status_code == 200
    assert asked.returncode == 0, asked.stdout[-8000:] + asked.stderr[-2000:]
    assert int(re.search(r"(\d+) generated", asked.stdout)[1]) >= CASES[phase]
