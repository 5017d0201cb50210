"""schemathesis asks a service that needs keys everything that its OpenAPI document allows and forbids, along its links too.

Each phase runs to its end, with a stated number of cases, against a service of its own.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import pytest

from service.http import identity
from service.http.app import create_app
from service.http.settings import Settings
from service.identity.principal import SCOPES
from tests.service.conftest import Running, running

CASES = {"examples": 150, "coverage": 7000, "fuzzing": 250, "stateful": 150}
"""Phases, and the requests that each sends at least."""
MAX_EXAMPLES = {"fuzzing": 3, "stateful": 40}
"""Requests for an operation of each kind, valid or not; sequences of requests along links."""
ACCEPTED = ["2xx", "3xx", 404, 409, 412, 429]
"""Answers to valid data: what it names may be missing, or have changed."""
ONLY_DECLARED = "[phases.stateful.inference]\nalgorithms = []\n"
"""Configuration that leaves out links which the document does not declare."""
HOOKS = "tests.service.http.stateful_hooks"
ROOT = Path(__file__).parents[3]
JUDGED = [*ACCEPTED, 413, 415, 422]
"""Answers to valid data of operations that take a camera, frames, a file, a body or a family of lenses: no schema says what
fits a shot, nor lists the library's families."""
OF_SHOTS = ("camera", "frames", "family")
"""Parameters that the schema does not judge: what a shot has, or the library."""


def configuration(document: dict) -> str:
    """The configuration of schemathesis: which answers to valid data each operation may give."""
    judged = [
        operation["operationId"]
        for methods in document["paths"].values()
        for operation in methods.values()
        if operation["operationId"] != "signIn"
        and ("requestBody" in operation or any(given["name"] in OF_SHOTS for given in operation.get("parameters", ())))
    ]
    return f"""
[checks.positive_data_acceptance]
expected-statuses = {json.dumps(ACCEPTED)}
[[operations]]
include-operation-id = {json.dumps(judged)}
[operations.checks.positive_data_acceptance]
expected-statuses = {json.dumps(JUDGED)}
[[operations]]
include-operation-id = "followEvents"
parameters = {{ follow = false }}
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


@contextmanager
def asked_service(folder: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Running]:
    """A service that is asked much."""
    monkeypatch.setattr(identity, "FAILURES", 10**6)  # wrong keys are sent, too, and refused without being slowed down
    settings = Settings(
        data=folder / "data",
        access="keys",
        requests_per_s=0,
        max_waiting=8,
        max_picture_px=30_000,
        max_picture_s=4,
        max_curve_frames=200,
    )
    with running(settings) as service:
        yield service


def ask(
    service: Running, phase: str, folder: Path, *, configured: str = "", hooks: str = "", arguments: Sequence[str] = ()
) -> int:
    """Run a phase to its end, without a finding. Returns the number of requests; its report lies in the folder.

    Args:
        service: is asked.
        phase: of schemathesis.
        folder: for its files.
        configured: what stands in its configuration before the rest.
        hooks: module of hooks; none where empty.
        arguments: more of the command.
    """
    config = folder / "schemathesis.toml"
    config.write_text(configured + configuration(service.app.openapi()))
    asked = subprocess.run(
        [*command(service, phase, config), *arguments, "--report", "ndjson", "--report-dir", str(folder / "report")],
        capture_output=True,
        text=True,
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(ROOT), "SCHEMATHESIS_HOOKS": hooks},
    )
    assert service.client.get("/livez").status_code == 200
    assert asked.returncode == 0, asked.stdout[-8000:] + asked.stderr[-2000:]
    return int(re.search(r"(\d+) generated", asked.stdout)[1])


@pytest.mark.parametrize("phase", CASES)
def test_no_answer_breaks_the_document(tmp_path, phase, monkeypatch):
    with asked_service(tmp_path, monkeypatch) as service:
        assert ask(service, phase, tmp_path) >= CASES[phase]


DOCUMENT = create_app(Settings(data=Path("unused"))).openapi()
LINKS = {
    call["operationId"]: {link["operationId"] for answer in answers for link in answer["links"].values()}
    for calls in DOCUMENT["paths"].values()
    for call in calls.values()
    if (answers := [answer for answer in call["responses"].values() if "links" in answer])
}
"""Calls that have links, and those that the links lead to."""


def followed_links(report: Path) -> Iterator[str]:
    """Names of the links that were followed and succeeded, which are those of the calls that they lead to."""
    for line in report.read_text(encoding="utf-8").splitlines():
        recorder = json.loads(line).get("ScenarioFinished", {}).get("recorder", {})
        for name, case in recorder.get("cases", {}).items():
            answer = recorder["interactions"].get(name, {}).get("response")
            if "transition" in case and answer and answer["status_code"] < 300:
                yield case["transition"]["id"].split(" -> ")[1].rpartition(" ")[2]


@pytest.mark.parametrize("source", LINKS)
def test_each_link_of_the_document_is_followed(tmp_path, monkeypatch, source):
    only = [argument for call in (source, *LINKS[source]) for argument in ("--include-operation-id", call)]
    with asked_service(tmp_path, monkeypatch) as service:
        ask(service, "stateful", tmp_path, configured=ONLY_DECLARED, hooks=HOOKS, arguments=only)
    (report,) = (tmp_path / "report").iterdir()
    assert set(followed_links(report)) >= LINKS[source]
