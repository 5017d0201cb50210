"""Names of settings over REST, and on the shot."""

from __future__ import annotations

from service.models.changes import KeyedSetting
from usd_schemas.settings.tables import SETTINGS

_NAMES = {item.camel_name: name for name, item in SETTINGS.items()}


def setting_name(setting: KeyedSetting) -> str:
    """Return the shot's name of a camera's setting that takes keys.

    Args:
        setting: its name over REST.
    """
    return _NAMES[setting]
