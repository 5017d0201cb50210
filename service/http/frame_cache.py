"""Cache of encoded pictures by entity tag, and conditional requests."""

from __future__ import annotations

import hashlib
import json
from collections import OrderedDict
from collections.abc import Mapping


class FrameCache:
    """Least recently used cache of encoded pictures, bounded in bytes.

    Args:
        max_bytes: of all pictures together.
    """

    def __init__(self, max_bytes: int) -> None:
        self._max_bytes = max_bytes
        self._bytes = 0
        self._pictures: OrderedDict[str, bytes] = OrderedDict()

    def get(self, tag: str) -> bytes | None:
        """Return the picture of a tag, or None."""
        if tag in self._pictures:
            self._pictures.move_to_end(tag)
        return self._pictures.get(tag)

    def put(self, tag: str, picture: bytes) -> None:
        """Keep a picture, unless it is larger than the whole cache."""
        if len(picture) > self._max_bytes:
            return
        self._bytes += len(picture) - len(self._pictures.pop(tag, b""))
        self._pictures[tag] = picture
        while self._bytes > self._max_bytes:
            _, evicted = self._pictures.popitem(last=False)
            self._bytes -= len(evicted)


def frame_tag(inputs: Mapping[str, object]) -> str:
    """Return the strong entity tag of a picture, quotes included: same inputs, same pixels, same tag.

    Args:
        inputs: everything that the picture depends on, as JSON values.
    """
    text = json.dumps(inputs, sort_keys=True, allow_nan=False)
    return f'"{hashlib.sha256(text.encode()).hexdigest()[:32]}"'


def matches(if_none_match: str | None, tag: str) -> bool:
    """Return whether an ``If-None-Match`` header names a tag, by weak comparison (RFC 9110, section 13.1.2)."""
    if if_none_match is None:
        return False
    named = [part.strip().removeprefix("W/") for part in if_none_match.split(",")]
    return tag in named or "*" in named
