"""The program's own work, done in a sandbox."""

from __future__ import annotations

from pathlib import Path

import pytest

from render.demo.shot import write_demo
from tests.service.workers.sandbox.confined import NOTHING, OFFERED, Confined

IMPORTS = """
from pxr import Work
Work.SetConcurrencyLimit(1)
import service.picture.frames, service.stage.shots
from render.film import GradeChoice
from render.frame import FrameRenderer, FrameSettings
from render.output import encode
from render.pictures.picture import make_picture
from render.shot import Shot
"""
PICTURE = """
Work.SetMaximumConcurrencyLimit()
root = Path({root!r})
shot = Shot.open(root, confined_to=root.parent)
with FrameRenderer() as renderer:
    picture = make_picture(renderer, shot, None, 40.0, FrameSettings(width=64, height=36))
assert picture.graded.std() > 0.05
files = [encode(name, picture.frame, picture.graded, picture.metadata) for name in ("png", "jpeg", "exr")]
print(*[len(file) > 500 for file in files])
import hashlib
print(hashlib.sha256(picture.graded.tobytes()).hexdigest())
"""


@pytest.fixture(scope="module")
def pictures(tmp_path_factory: pytest.TempPathFactory) -> dict[str, list[str]]:
    """Lines that the program prints which draws the demo shot, in a sandbox with all features and with none."""
    lines = {}
    for name, offered in (("all", None), ("none", NOTHING)):
        sandbox = Confined(tmp_path_factory.mktemp(name), graphics=True, offered=offered)
        root = write_demo(sandbox.shot)
        lines[name] = sandbox.output(PICTURE.format(root=str(root)), IMPORTS)
    return lines


@pytest.mark.gl
def test_the_demo_shot_is_drawn_and_encoded(pictures: dict[str, list[str]]) -> None:
    assert [lines[0] for lines in pictures.values()] == ["True True True"] * 2


@pytest.mark.gl
def test_a_picture_is_the_same_in_the_sandbox(pictures: dict[str, list[str]]) -> None:
    assert pictures["all"][1] == pictures["none"][1]


@pytest.mark.skipif(not OFFERED.landlock_abi, reason="this kernel offers no Landlock")
@pytest.mark.parametrize("abi", range(1, OFFERED.landlock_abi + 1))
def test_each_version_of_landlock_confines(tmp_path: Path, abi: int) -> None:
    sandbox = Confined(tmp_path, offered=type(OFFERED)(abi, OFFERED.seccomp))
    (sandbox.shot / "root.usda").write_text("#usda 1.0")

    lines = sandbox.output(f"""
        print(error_of(lambda: open({str(sandbox.shot / "root.usda")!r})))
        print(error_of(lambda: open({str(sandbox.other / "secret")!r})))
        print(error_of(lambda: Path({str(sandbox.edits / "new")!r}).write_text("x")))
        print(held.landlock_abi)
    """)

    assert lines == ["done", "EACCES", "done", str(abi)]
