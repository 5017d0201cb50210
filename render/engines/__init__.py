"""Engines: one module each, with its manual page; `base.Engine` says what an engine is, `registry` which there are.

Importing this package loads no OpenGL. What the engines of one context share, and needs it, is in `shared`.
"""

from render.engines import registry
from render.engines.base import Engine
from render.engines.registry import (
    all_engines,
    check_scene,
    check_settings,
    engine_class,
    engine_names,
    register,
    sharp_engine,
    unregister,
)
from render.engines.shared.request import ALL_RAYS, DrawRequest

__all__ = [
    "ALL_RAYS",
    "DrawRequest",
    "Engine",
    "all_engines",
    "check_scene",
    "check_settings",
    "engine_class",
    "engine_names",
    "register",
    "sharp_engine",
    "unregister",
]

registry.discover(__path__)
