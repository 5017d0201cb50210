"""Removal of folders: whatever is in them, and nothing outside."""

from __future__ import annotations

import os
import resource

import pytest

from render.removal import remove_tree

DEPTH = 20_000
"""Folders in each other: their path is longer than any call takes, and they are more than a process has descriptors."""


@pytest.fixture
def tree(tmp_path):
    folder = tmp_path / "edits"
    folder.mkdir()
    return folder


def test_a_deep_tree_is_removed_with_few_descriptors(tree):
    place = os.open(tree, os.O_RDONLY)
    for _ in range(DEPTH):
        os.mkdir("a", dir_fd=place)
        inner = os.open("a", os.O_RDONLY, dir_fd=place)
        os.close(place)
        place = inner
    os.close(os.open("file", os.O_CREAT | os.O_WRONLY, dir_fd=place))
    os.close(place)
    limits = resource.getrlimit(resource.RLIMIT_NOFILE)
    highest = max(int(name) for name in os.listdir("/proc/self/fd"))
    resource.setrlimit(resource.RLIMIT_NOFILE, (highest + 4, limits[1]))
    try:
        remove_tree(tree)
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, limits)
    assert not tree.exists()


def test_links_are_removed_and_not_followed(tree, tmp_path):
    kept = tmp_path / "kept"
    kept.mkdir(mode=0o500)
    (tmp_path / "file").write_text("kept")
    for place in (tree, tree / "history"):
        place.mkdir(exist_ok=True)
        (place / "folder").symlink_to(kept)
        (place / "file").symlink_to(tmp_path / "file")
        (place / "loop").symlink_to(place)
    remove_tree(tree)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "kept"]
    assert kept.stat().st_mode & 0o777 == 0o500


def test_a_link_in_the_place_of_the_folder_is_refused(tree, tmp_path):
    (tmp_path / "link").symlink_to(tree)
    with pytest.raises(OSError, match="Not a directory"):
        remove_tree(tmp_path / "link")
    assert tree.is_dir()


def test_odd_names_and_kinds_are_removed(tree):
    for name in (b"-rf", b"\xff\xfe", b"new\nline", b"x" * 255, b"*", b" "):
        os.mkdir(os.path.join(os.fsencode(tree), name))
        os.close(os.open(os.path.join(os.fsencode(tree), name, name), os.O_CREAT | os.O_WRONLY))
    os.mkfifo(tree / "pipe")
    remove_tree(tree)
    assert not tree.exists()


def test_folders_that_nobody_may_enter_are_removed(tree):
    inner = tree / "a" / "b" / "c"
    inner.mkdir(parents=True)
    (inner / "file").touch()
    for folder in (inner, inner.parent, inner.parent.parent, tree):
        folder.chmod(0)
    remove_tree(tree)
    assert not tree.exists()


def test_a_folder_that_is_gone_is_no_error(tmp_path):
    remove_tree(tmp_path / "edits")
