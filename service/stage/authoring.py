"""From models to what the schemas say. Runs in the stage process, the one that imports USD."""

from __future__ import annotations

from render.errors import SettingsError
from service.models.focus import KeyEdit
from usd_schemas import Key as AuthoredKey
from usd_schemas import Tangents


def authored_key(key: KeyEdit, attribute: str, *, is_switch: bool) -> AuthoredKey:
    """A key as the schemas have it.

    Args:
        key: as it was sent.
        attribute: what it is of, for messages.
        is_switch: whether that is on or off: 1 or 0, and held.

    Raises:
        SettingsError: a switch is neither, or tangents were sent of a key that has none.
    """
    if key.tangents is not None and key.interpolation != "bezier":
        raise SettingsError(
            f"a bezier key alone has tangents, got some of a {key.interpolation} key", code="bad_key", path="tangents"
        )
    if is_switch and key.value not in (0, 1):
        raise SettingsError(f"a key of {attribute!r} is 0 or 1, got {key.value:g}", code="bad_key", path="value")
    if is_switch:
        return AuthoredKey(key.time, bool(key.value), "held")
    tangents = Tangents(**key.tangents.model_dump()) if key.tangents else None
    return AuthoredKey(key.time, key.value, key.interpolation, tangents)
