"""The demo shot of the bench's service, over REST: its edits are compared, and taken back."""

from __future__ import annotations

import json
from dataclasses import dataclass

from render.errors import PullfocusError
from service.bench.requests import FIRST_CLIENT, ask

_EDITS = "/v1/shots/demo/edits"


@dataclass(frozen=True)
class Edits:
    """Edits of the shot as the service has them.

    Attributes:
        revision: names their state.
        layer: their USD layer, text.
    """

    revision: str
    layer: str


def read_edits(port: int) -> Edits:
    """Read the edits of the demo shot.

    Args:
        port: of the service.

    Raises:
        PullfocusError: the service refuses.
        OSError: it cannot be reached.
    """
    history = json.loads(_asked(port, "GET", f"{_EDITS}/history"))
    return Edits(history["revision"], _asked(port, "GET", _EDITS))


def restore_edits(port: int, revision: str) -> None:
    """Go back to an earlier state of the edits; raises as `read_edits` does."""
    _asked(port, "PUT", _EDITS, json.dumps({"revision": revision}).encode())


def _asked(port: int, method: str, path: str, body: bytes | None = None) -> str:
    status, answer = ask(port, FIRST_CLIENT, method, path, body, {"Content-Type": "application/json"})
    text = answer.decode(errors="replace")
    if status >= 400:
        raise PullfocusError(f"the service refuses {method} {path}: {text[:500]}")
    return text
