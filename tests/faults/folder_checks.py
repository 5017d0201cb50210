"""Checks of a data folder that a killed service has left and a new one has opened."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

from pxr import Sdf, Tf

from service.storage.edit_files import INDEX


def faults_of_folder(data: Path) -> Iterator[str]:
    """Name each file that is half written, and each that nobody needs any more. No request may be under way.

    Args:
        data: of a service that has just started.
    """
    for shot in (data / "shots").iterdir():
        if not (shot / "shot.json").is_file():
            yield f"{shot.name} is left of an upload or a deletion"
    for file in data.rglob("*"):
        inside = file.relative_to(data)
        if not file.is_file() or "files" in inside.parts:  # uploaded files may have any name and content
            continue
        if file.suffix == ".part":
            yield f"{inside} is left of an interrupted write"
        elif file.suffix in (".json", ".jsonl"):
            yield from _faults_of_json(file, inside)
        elif file.suffix == ".usda" and not _is_layer(file.read_text() or "#usda 1.0\n"):
            yield f"{inside} is no whole USD layer"
        if file.name == INDEX and file.parent.name == "history":
            yield from _faults_of_index(file, inside)


def _is_layer(text: str) -> bool:
    try:
        return bool(Sdf.Layer.CreateAnonymous(".usda").ImportFromString(text))
    except Tf.ErrorException:
        return False


def _faults_of_json(file: Path, inside: Path) -> Iterator[str]:
    texts = file.read_text().splitlines() if file.suffix == ".jsonl" else [file.read_text()]
    for number, text in enumerate(texts, 1):
        try:
            json.loads(text)
        except ValueError as error:
            yield f"{inside}, record {number}, is no JSON: {error}"


def _faults_of_index(file: Path, inside: Path) -> Iterator[str]:
    for state in json.loads(file.read_text())["states"]:
        if not (file.parent / f"{state['revision']}.usda").is_file():
            yield f"{inside} names the state {state['revision']}, which is not there"
