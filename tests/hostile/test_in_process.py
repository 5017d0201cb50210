"""Hostile curves, lenses and MaterialX files, read in this process: each is read, or refused by an error of ours."""

from __future__ import annotations

import warnings
from pathlib import Path

from pxr import Usd

from render.errors import PullfocusError
from render.focus.files import Rates, read_curve
from render.optics.lens_files import parse_lens_file, parse_measured_lens
from render.optics.prescription.completion import complete_prescription
from render.stage.findings import FindingLog
from render.stage.materials.mtlx.looks import MaterialXLooks
from render.stage.materials.textures import TextureCache
from tests.hostile.materialx_attacks import materialx_attacks
from tests.hostile.side_uploads import side_uploads

EVERY = 7
FOUND = ("focus-group", "trackio-denom", "trackio-num", "trackio-hours", "trackio-width", "csv-rates", "of-one-hash")
"""Parts of the names of files that once ended in an error of Python's, or took minutes."""


def read_side(kind: str, file: str, content: bytes) -> bool:
    """Read a curve or a lens file. Returns whether it was taken."""
    try:
        if kind == "curve":
            read_curve(content, Rates(24.0, 24.0), gaps="interpolate")
        elif file.endswith(".lens"):
            parse_measured_lens(content, file)
        else:
            complete_prescription(parse_lens_file(content, file))
    except PullfocusError:
        return False
    return True


def test_hostile_curves_and_lenses_are_read_or_refused() -> None:
    files = [each for each in side_uploads() if "/large/" not in each[0] or "of-one-hash" in each[0]]
    found = [each for each in files if any(name in each[0] for name in FOUND)]
    assert len(found) > 20
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # of numpy, of numbers beyond all others
        taken = [read_side(*each[1:]) for each in (*found, *files[::EVERY])]
    assert True in taken
    assert False in taken


def test_hostile_materialx_files_give_a_look_or_none(tmp_path: Path) -> None:
    looks = []
    for number, (name, files) in enumerate(materialx_attacks(tmp_path / "secret.txt")):
        if not name.startswith(("name/", "encoding/", "number/", "loop/", "definition/")):
            continue
        folder = tmp_path / str(number)
        for file, content in files.items():
            target = folder / file
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(content.encode() if isinstance(content, str) else content)
        stage = Usd.Stage.Open(str(folder / "room.usda"))
        textures = TextureCache(2048, confined_to=folder)
        looks.append(
            MaterialXLooks(stage, textures, FindingLog()).of_document("/World/Looks/Materials/M", Usd.TimeCode(1.0))
        )
    assert len(looks) > 60
    assert any(look is not None for look in looks)
    assert any(look is None for look in looks)
