"""Files that a worker sees, where the kernel has Landlock."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from service.workers.sandbox.landlock import ALL_THREADS_ABI
from tests.service.workers.sandbox.confined import OFFERED, Confined

pytestmark = pytest.mark.skipif(not OFFERED.landlock_abi, reason="this kernel offers no Landlock")


def _errors_of_reading(sandbox: Confined, *paths: Path | str) -> list[str]:
    names = [str(path) for path in paths]
    return sandbox.output(f"for path in {names!r}: print(error_of(lambda: open(path).read()))")


def test_the_shot_is_read_and_its_neighbour_is_not(tmp_path: Path) -> None:
    sandbox = Confined(tmp_path)
    (sandbox.shot / "root.usda").write_text("#usda 1.0")

    assert _errors_of_reading(sandbox, sandbox.shot / "root.usda", sandbox.other / "secret") == ["done", "EACCES"]


@pytest.mark.parametrize("path", ["/etc/passwd", "/etc/hostname", "/proc/1/environ", "/proc/self/root/etc/passwd"])
def test_files_of_the_machine_are_not_read(tmp_path: Path, path: str) -> None:
    assert _errors_of_reading(Confined(tmp_path), path) == ["EACCES"]


def test_links_and_dots_do_not_lead_out(tmp_path: Path) -> None:
    sandbox = Confined(tmp_path)
    (sandbox.shot / "link").symlink_to(sandbox.other / "secret")
    (sandbox.shot / "folder").symlink_to(sandbox.other)

    paths = (sandbox.shot / "link", sandbox.shot / "folder/secret", f"{sandbox.shot}/../other/secret")

    assert _errors_of_reading(sandbox, *paths) == ["EACCES"] * 3


def test_a_pipe_outside_blocks_nobody(tmp_path: Path) -> None:
    sandbox = Confined(tmp_path)
    os.mkfifo(sandbox.other / "pipe")

    assert _errors_of_reading(sandbox, sandbox.other / "pipe") == ["EACCES"]


def test_folders_outside_are_not_listed(tmp_path: Path) -> None:
    folders = [str(tmp_path), "/", "/tmp", "/home", str(Confined(tmp_path).other)]

    errors = Confined(tmp_path).output(f"for path in {folders!r}: print(error_of(lambda: os.listdir(path)))")

    assert errors == ["EACCES"] * len(folders)


def test_the_shot_is_not_written(tmp_path: Path) -> None:
    sandbox = Confined(tmp_path)
    (sandbox.shot / "root.usda").write_text("#usda 1.0")

    errors = sandbox.output(f"""
        shot = Path({str(sandbox.shot)!r})
        print(error_of(lambda: (shot / "new").write_text("x")))
        print(error_of(lambda: (shot / "root.usda").write_text("x")))
        print(error_of(lambda: (shot / "root.usda").unlink()))
        print(error_of(lambda: (shot / "folder").mkdir()))
        print(error_of(lambda: os.truncate(shot / "root.usda", 0)))
    """)

    refused = "EACCES" if OFFERED.landlock_abi >= 3 else "done"  # truncating by path is restricted from then on
    assert errors == [*["EACCES"] * 4, refused]


def test_the_folder_of_edits_is_written(tmp_path: Path) -> None:
    sandbox = Confined(tmp_path)

    sandbox.output(f"""
        edits = Path({str(sandbox.edits)!r})
        (edits / "history").mkdir()
        (edits / "new.part").write_text("first")
        os.replace(edits / "new.part", edits / "edits.usda")
        (edits / "history/1").write_text("x")
        (edits / "history/1").unlink()
        (edits / "history").rmdir()
    """)

    assert (sandbox.edits / "edits.usda").read_text() == "first"
    assert not (sandbox.edits / "history").exists()


def test_files_do_not_move_out_of_the_folders(tmp_path: Path) -> None:
    sandbox = Confined(tmp_path)
    (sandbox.edits / "edits.usda").write_text("x")

    (error,) = sandbox.output(f"""
        print(error_of(lambda: os.rename({str(sandbox.edits / "edits.usda")!r}, {str(sandbox.other / "new")!r})))
    """)

    assert error in ("EACCES", "EXDEV")
    assert not (sandbox.other / "new").exists()


@pytest.mark.skipif(OFFERED.landlock_abi >= ALL_THREADS_ABI, reason="this kernel confines threads that exist")
def test_a_thread_that_would_not_be_confined_is_an_error(tmp_path: Path) -> None:
    before = "import threading; threading.Thread(target=threading.Event().wait, daemon=True).start()"

    done = Confined(tmp_path).run("print('entered')", before)

    assert "SandboxError: 1 threads exist already" in done.stderr
    assert done.stdout == ""


def test_layers_outside_are_not_read_by_threads_of_usd(tmp_path: Path) -> None:
    sandbox = Confined(tmp_path)
    outside = [sandbox.other / f"{index}.usda" for index in range(64)]
    for layer in outside:
        layer.write_text('#usda 1.0\ndef "secret" {}\n')
    names = ", ".join(f"@{layer}@" for layer in outside)
    (sandbox.shot / "root.usda").write_text(f"#usda 1.0\n(subLayers = [{names}])\n")

    lines = sandbox.output(
        f"""
        Work.SetMaximumConcurrencyLimit()
        stage = Usd.Stage.Open({str(sandbox.shot / "root.usda")!r})
        print(len(stage.GetUsedLayers()), bool(stage.GetPrimAtPath("/secret")))
        """,
        "from pxr import Work; Work.SetConcurrencyLimit(1); from pxr import Usd",
    )

    assert lines == ["2 False"]


def test_threads_that_start_later_are_confined_too(tmp_path: Path) -> None:
    sandbox = Confined(tmp_path)

    errors = sandbox.output(f"""
        from concurrent.futures import ThreadPoolExecutor
        with ThreadPoolExecutor(1) as threads:
            print(threads.submit(error_of, lambda: open({str(sandbox.other / "secret")!r})).result())
    """)

    assert errors == ["EACCES"]
