"""Prims of the library files, opened once each."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from pxr import Usd


@cache
def library_prims(file: Path) -> dict[str, Usd.Prim]:
    """Prims under a library's default prim, by name; valid as long as the process, which keeps their stage."""
    return {prim.GetName(): prim for prim in _stage(file).GetDefaultPrim().GetChildren()}


@cache
def _stage(file: Path) -> Usd.Stage:
    return Usd.Stage.Open(str(file))  # prims live no longer than their stage
