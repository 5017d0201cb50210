"""schemathesis asks the service everything that its OpenAPI document allows and forbids, along its links too."""

from __future__ import annotations

import re
import subprocess
import sys

from service.http.settings import Settings
from tests.service.conftest import running

SECONDS = 45
NOT_CHECKED = "ignored_auth,positive_data_acceptance"
"""A service on loopback has no keys; and a schema does not say which camera a shot has: `test_examples` sends valid
data."""


def test_no_answer_breaks_the_document(tmp_path):
    with running(Settings(data=tmp_path, max_waiting=8)) as service:
        command = [sys.executable, "-m", "schemathesis.cli", "run", f"{service.client.base_url}/openapi.json"]
        command += ["--phases", "coverage,fuzzing,stateful", "--max-time", str(SECONDS), "--seed", "1"]
        command += ["--checks", "all", "--exclude-checks", NOT_CHECKED, "--exclude-operation-id", "watch"]
        command += [
            "--request-timeout",
            "120",
            "--max-response-time",
            "60",
            "--warnings",
            "off",
            "--no-color",
            "--continue-on-failure",
        ]
        asked = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)
        assert service.client.get("/livez").status_code == 200
    assert asked.returncode == 0, asked.stdout[-8000:] + asked.stderr[-2000:]
    assert int(re.search(r"(\d+) generated", asked.stdout)[1]) > 200
    assert "Stateful" in asked.stdout
