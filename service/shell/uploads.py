"""Uploads of shots from a shell."""

from __future__ import annotations

import argparse
import re
from pathlib import Path

from render.cli.console import print_message
from render.errors import NotFoundError
from service.client import Client, Shot

_SHOT_ID = re.compile(r"[a-z0-9]+(-[a-z0-9]+)*")
_LAYERS = (".usd", ".usda", ".usdc")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of an upload, for `push_shot`."""
    parser.add_argument("--root", metavar="FILE", help="root layer within a folder or .zip that holds several stages")
    parser.add_argument("--project", metavar="NAME", help="project of the shot, for keys that see several")


def is_path(text: str) -> bool:
    """Whether a text is the path of a shot on this machine, and no id of a shot of the service: ids have no dots and slashes."""
    return not _SHOT_ID.fullmatch(text)


def push_shot(client: Client, path: Path, typed: argparse.Namespace, name: str | None = None) -> Shot:
    """Upload a shot, and say so.

    Args:
        client: of the service.
        path: a USD file, whose layers and textures go with it, or a .usdz, a .zip or a folder, which go as they are.
        typed: as `add_arguments` declares them.
        name: of the shot.

    Raises:
        NotFoundError: there is no such path.
        PullfocusError: a file cannot be read, or the service refuses the shot.
    """
    if not path.exists():
        raise NotFoundError(f"{path} does not exist", path=str(path))
    if path.suffix.lower() in _LAYERS and path.is_file():
        shot = _push_stage(client, path, typed, name)
    else:
        shot = client.push(path, name=name, root=typed.root, project=typed.project)
    frames = shot.frame_range
    size = f"{shot.file_count} file{'' if shot.file_count == 1 else 's'}, {shot.size_bytes / 2**20:.1f} MiB"
    print_message(f"pushed {shot.name}: shot {shot.id}, {size}, frames {frames.start:g} to {frames.end:g}")
    return shot


def _push_stage(client: Client, path: Path, typed: argparse.Namespace, name: str | None) -> Shot:
    from service.shell.stage_files import find_stage_files  # imports USD, which takes a while

    files = find_stage_files(path)
    if files.outside:
        detail = (
            f"{len(files.outside)} of its files lie outside {path.parent} and are not sent, such as {files.outside[0]}"
        )
        print_message(f"warning: {detail}; push the folder that holds them all, with --root")
    if len(files.inside) == 1:
        return client.push(path, name=name, root=typed.root, project=typed.project)
    folder = path.resolve().parent
    return client.push(
        folder, name=name or path.stem, root=path.resolve().name, project=typed.project, files=files.inside
    )
