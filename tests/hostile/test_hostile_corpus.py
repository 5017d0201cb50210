"""A sample of the hostile corpus against a real service; ``python -m tests.hostile --all`` runs the whole."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.hostile.asking import ask_briefly
from tests.hostile.corpus import checksum, controls, corpus
from tests.hostile.families import all_cases
from tests.hostile.runner import finished_in, run_cases
from tests.hostile.world import hostile_world

SAMPLE = 30
LANES = {"check", "stage", "read", "live", "final", "long", "exposure"}


@pytest.mark.gl
def test_hostile_files_get_one_clear_answer(tmp_path: Path) -> None:
    with hostile_world(tmp_path) as world:
        harmless = list(controls())
        good = list(run_cases(world.client, harmless[1:], world.canaries, world.places, ask_briefly))
        good += run_cases(world.client, harmless[:1], world.canaries, world.places)
        assert [verdict for verdict in good if max(verdict.statuses) >= 300] == [], "what is harmless is drawn"
        cases = list(all_cases(world.canaries))
        assert len(cases) >= 2000
        known = list(corpus(world.canaries))
        assert checksum(known) == checksum(cases[: len(known)]), "the corpus is the same in every run"
        sample = cases[:: len(cases) // SAMPLE]
        brief = [case for place, case in enumerate(sample) if place % 10]
        verdicts = list(run_cases(world.client, brief, world.canaries, world.places, ask_briefly))
        verdicts += run_cases(world.client, sample[::10], world.canaries, world.places)
        assert set(finished_in(world.client)) == LANES

    assert [verdict for verdict in verdicts if not verdict.is_good] == []
    assert max(verdict.peak_mib for verdict in verdicts) < 2500
