"""Prints the OpenAPI document: ``python -m service.http.openapi > web/openapi.json``. The output is deterministic."""

from __future__ import annotations

import json
import sys
from pathlib import Path

from service.http.app import create_app
from service.http.settings import Settings


def openapi_text() -> str:
    """Return the OpenAPI document as JSON text."""
    document = create_app(Settings(data=Path("unused"))).openapi()
    return json.dumps(document, indent=2, sort_keys=True, ensure_ascii=False) + "\n"


if __name__ == "__main__":
    sys.stdout.write(openapi_text())
