"""Copies a camera beside itself: lens, body, focus, film and all that it does over time."""

from __future__ import annotations

import re

from pxr import Sdf, Usd

from render.shot.camera.creation import named_path

_LEFT_OUT = ("stereoRole", "proxyPrim")
"""Properties that a copy does not have: a second camera for an eye would leave a stereo pair without one of them."""


def copy_path(stage: Usd.Stage, source: Sdf.Path, name: str | None) -> Sdf.Path:
    """Return the path of a copy, beside its source.

    Args:
        stage: the stage.
        source: path of the camera.
        name: of the copy; None for the camera's own, with the next number behind it that is free.

    Raises:
        SettingsError: the name is no identifier, or there is such a prim already.
    """
    parent = source.GetParentPath()
    if name is None:
        stem, number = re.sub(r"_\d+$", "", source.name) or source.name, 2
        while stage.GetPrimAtPath(parent.AppendChild(f"{stem}_{number}")):
            number += 1
        return parent.AppendChild(f"{stem}_{number}")
    return named_path(stage, parent, name)


def copy_camera(source: Usd.Prim, path: Sdf.Path) -> Usd.Prim:
    """Define a prim with the type, the applied schemas and the authored properties of another, in the stage's edit target.

    Children are not copied. Values are those of all layers together, keys and splines included.

    Args:
        source: the camera, in no instance.
        path: of the copy, where no prim is yet.
    """
    copy = source.GetStage().DefinePrim(path, source.GetTypeName())
    for schema in source.GetPrimTypeInfo().GetAppliedAPISchemas():
        copy.AddAppliedSchema(schema)
    for prop in source.GetAuthoredProperties():
        if prop.GetName() not in _LEFT_OUT:
            prop.FlattenTo(copy)
    return copy
