"""The colour files that a shot names. One from outside may bring its own, but none may lead out of the shot's folder."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import PyOpenColorIO as ocio

from render.colour import BUILTIN_PREFIX, working_config
from render.colour.confined import ConfinedConfig, leaves_root
from render.errors import InputError
from render.stage.confinement import is_inside
from usd_schemas.settings import Asset


def config_file(asset: Asset, confined_to: Path | None) -> str | ConfinedConfig | None:
    """OpenColorIO configuration that a shot names, in the form of `render.film.Grade.config`; None where it names none.

    Args:
        asset: a file, or a built-in configuration as ``ocio://name``.
        confined_to: the folder that neither it nor a file that it names, used or not, may lie out of; None for anywhere.

    Raises:
        InputError: code ``missing_file`` or ``outside_reference``.
        SettingsError: the configuration cannot be read.
    """
    if not asset.path or asset.path.startswith(BUILTIN_PREFIX):
        return asset.path or None
    name = _file(asset, "film:ocio:config", confined_to)
    if confined_to is None:
        return name
    config = ConfinedConfig(name, confined_to)
    _check_confined(config)
    return config


def cdl_file(asset: Asset, confined_to: Path | None) -> str:
    """The CDL file that a shot names; arguments and errors as for `config_file`."""
    return _file(asset, "film:cdl:file", confined_to)


def _file(asset: Asset, named_by: str, confined_to: Path | None) -> str:
    if not asset.resolved:
        raise InputError(f"{named_by} names {asset.path}, which is not there", code="missing_file", path=asset.path)
    if confined_to is not None and not is_inside(asset.resolved, confined_to):
        raise InputError(
            f"{named_by} names {asset.path}, which is outside of the shot's folder",
            code="outside_reference",
            path=asset.path,
        )
    return asset.resolved


def _check_confined(source: ConfinedConfig) -> None:
    config = working_config(source)
    for transform in _file_transforms(config):
        file = str(transform.getSrc())
        if leaves_root(config, source, file):
            raise InputError(
                f"the OpenColorIO configuration {source} names {file}, which is outside of the shot's folder",
                code="outside_reference",
                path=str(source),
            )


def _file_transforms(config: ocio.Config) -> Iterator[ocio.FileTransform]:
    spaces = config.getColorSpaces(ocio.SEARCH_REFERENCE_SPACE_ALL, ocio.COLORSPACE_ALL)
    for space in spaces:
        yield from _files_in(space.getTransform(ocio.COLORSPACE_DIR_TO_REFERENCE))
        yield from _files_in(space.getTransform(ocio.COLORSPACE_DIR_FROM_REFERENCE))
    for look in config.getLooks():
        yield from _files_in(look.getTransform())
        yield from _files_in(look.getInverseTransform())
    for view in config.getViewTransforms():
        yield from _files_in(view.getTransform(ocio.VIEWTRANSFORM_DIR_TO_REFERENCE))
        yield from _files_in(view.getTransform(ocio.VIEWTRANSFORM_DIR_FROM_REFERENCE))
    for named in config.getNamedTransforms(ocio.NAMEDTRANSFORM_ALL):
        yield from _files_in(named.getTransform(ocio.TRANSFORM_DIR_FORWARD))
        yield from _files_in(named.getTransform(ocio.TRANSFORM_DIR_INVERSE))


def _files_in(transform: ocio.Transform | None) -> Iterator[ocio.FileTransform]:
    if isinstance(transform, ocio.FileTransform):
        yield transform
    elif isinstance(transform, ocio.GroupTransform):
        for step in transform:
            yield from _files_in(step)
