"""Engines as REST names them: those of the registry when the service starts."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from render.engines import all_engines, engine_names

if TYPE_CHECKING:
    EngineName = str
else:
    EngineName = Literal[engine_names()]

ENGINE_HELP = "; ".join(f"`{engine.name}` {engine.summary}" for engine in all_engines()) + "."
