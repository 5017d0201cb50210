"""Encoded pictures that were asked for lately, and the tag that says which is which."""

from __future__ import annotations

import hashlib
import json
from collections import OrderedDict
from collections.abc import Mapping


class FrameCache:
    """Keeps encoded pictures by tag until they are too many bytes; the one that was not used for longest goes first.

    Args:
        max_bytes: of all pictures together.
    """

    def __init__(self, max_bytes: int) -> None:
        self._max_bytes = max_bytes
        self._bytes = 0
        self._pictures: OrderedDict[str, bytes] = OrderedDict()

    def get(self, tag: str) -> bytes | None:
        """The picture of a tag, if it is still here."""
        if tag in self._pictures:
            self._pictures.move_to_end(tag)
        return self._pictures.get(tag)

    def put(self, tag: str, picture: bytes) -> None:
        """Keep a picture, unless it is larger than all that may be kept."""
        if len(picture) > self._max_bytes:
            return
        self._bytes += len(picture) - len(self._pictures.pop(tag, b""))
        self._pictures[tag] = picture
        while self._bytes > self._max_bytes:
            _, dropped = self._pictures.popitem(last=False)
            self._bytes -= len(dropped)


def frame_tag(inputs: Mapping[str, object]) -> str:
    """A strong entity tag, quotes included: same inputs, same pixels, so same tag.

    Args:
        inputs: everything that the picture depends on, as JSON values.
    """
    text = json.dumps(inputs, sort_keys=True, allow_nan=False)
    return f'"{hashlib.sha256(text.encode()).hexdigest()[:32]}"'


def matches(if_none_match: str | None, tag: str) -> bool:
    """Whether an ``If-None-Match`` header names a tag (RFC 9110, section 13.1.2: by weak comparison)."""
    if if_none_match is None:
        return False
    named = [part.strip().removeprefix("W/") for part in if_none_match.split(",")]
    return tag in named or "*" in named
