"""JSON of files and messages that anybody may have written."""

from __future__ import annotations

import json
from typing import Any


def parse_json(text: str | bytes) -> Any:
    """Parse JSON.

    Args:
        text: of any length and depth.

    Raises:
        ValueError: it is none, or is nested too deeply.
    """
    try:
        return json.loads(text)
    except RecursionError as error:  # which the library lets out, and which is no ValueError
        raise ValueError("it is nested too deeply") from error
