"""The families of hostile files: the same ones in every run, under names of their own, and none of them large."""

from __future__ import annotations

import time
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tests.hostile.archive_attacks import archive_attacks
from tests.hostile.corpus import packed
from tests.hostile.image_attacks import image_attacks
from tests.hostile.materialx_attacks import materialx_attacks
from tests.hostile.raw_archives import zeros
from tests.hostile.side_uploads import side_uploads

CANARY = Path("/somewhere/secret.txt")
MOST_BYTES = 8_000_000
LEAST = {"archive": 250, "materialx": 250, "image": 400, "side": 1000}
FAMILIES: dict[str, Callable[[], Iterator[tuple[str, bytes]]]] = {
    "archive": lambda: ((f"{name} {file}", content) for name, file, content in archive_attacks(CANARY)),
    "materialx": lambda: ((name, packed(files)) for name, files in materialx_attacks(CANARY)),
    "image": lambda: ((f"{name} {file}", content) for name, file, content in image_attacks(CANARY)),
    "side": lambda: ((f"{name} {kind} {file}", content) for name, kind, file, content in side_uploads()),
}


@pytest.mark.parametrize("family", FAMILIES)
def test_a_family_is_the_same_in_each_run(family: str) -> None:
    sums, sizes = {}, {}
    for name, content in FAMILIES[family]():
        assert name.split()[0] not in sizes, "each has a name of its own"
        sizes[name.split()[0]] = len(content)
        sums[name] = zlib.crc32(content)
    assert len(sizes) >= LEAST[family]
    assert max(sizes.values()) <= MOST_BYTES, max(sizes, key=sizes.__getitem__)
    assert {name: zlib.crc32(content) for name, content in FAMILIES[family]()} == sums


def test_a_gigabyte_of_zeros_is_made_soon() -> None:
    begun_s = time.process_time()
    content, _ = zeros.__wrapped__(1024)
    assert time.process_time() - begun_s < 2
    assert len(content) < 2_000_000
