"""All hostile files: those of the corpus and of each family of attacks."""

from __future__ import annotations

from collections.abc import Iterator

from tests.hostile.archive_attacks import archive_attacks
from tests.hostile.corpus import Canaries, Case, corpus, packed, textured
from tests.hostile.image_attacks import image_attacks
from tests.hostile.materialx_attacks import materialx_attacks
from tests.hostile.side_uploads import side_uploads


def all_cases(canaries: Canaries) -> Iterator[Case]:
    """All cases, the same ones in every run.

    Args:
        canaries: what they try to reach.
    """
    yield from corpus(canaries)
    for name, file, content in archive_attacks(canaries.text):
        yield Case(f"archive/{name}", file, content)
    for name, files in materialx_attacks(canaries.text):
        yield Case(f"materialx/{name}", "a.zip", packed(files))
    for name, image, content in image_attacks(canaries.text):
        yield Case(f"image/{name}", "a.zip", textured(image, content))
    for name, kind, file, content in side_uploads():
        yield Case(f"side/{name}", file, content, kind)
