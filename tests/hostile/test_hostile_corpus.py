"""A sample of the hostile corpus against a real service; ``python -m tests.hostile --all`` runs the whole."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.hostile.corpus import checksum, controls, corpus
from tests.hostile.runner import run_cases
from tests.hostile.world import hostile_world

SAMPLE = 48


@pytest.mark.gl
def test_hostile_files_get_one_clear_answer(tmp_path: Path) -> None:
    with hostile_world(tmp_path) as world:
        good = list(run_cases(world.client, controls(), world.canaries, world.places))
        assert [verdict for verdict in good if max(verdict.statuses) >= 300] == [], "what is harmless is drawn"
        cases = list(corpus(world.canaries))
        assert len(cases) >= 500
        assert checksum(cases) == checksum(list(corpus(world.canaries))), "the corpus is the same in every run"
        verdicts = list(run_cases(world.client, cases[:: len(cases) // SAMPLE], world.canaries, world.places))

    assert [verdict for verdict in verdicts if not verdict.is_good] == []
    assert max(verdict.peak_mib for verdict in verdicts) < 2500
