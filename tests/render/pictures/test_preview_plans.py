"""Plans of previews: their size and rays follow the speed of the machine and the time there is."""

from __future__ import annotations

import pytest

from render.pictures.progressive.planner import ENOUGH_RAYS, GOOD_RAYS, PreviewPlan, PreviewPlanner


def test_plans_follow_the_speed_of_the_machine() -> None:
    planner = PreviewPlanner(is_software=True)
    assert planner.largest_size(960, 540) == (480, 270)
    assert planner.largest_size(8, 3) == (8, 3)

    least = {480: 32, 400: 13, 320: 9, 240: 7, 160: GOOD_RAYS}

    def settled(ms: float) -> PreviewPlan:
        for _ in range(60):
            plan = planner.plan(960, 540, 60)
            assert least[plan.width] <= plan.rays <= ENOUGH_RAYS
            planner.learn(plan, ms * plan.work, 0.0)
        return plan

    quick = settled(1e-5)
    assert (quick.width, quick.height) == (480, 270)
    assert 1e-5 * quick.work == pytest.approx(60, rel=0.1), "the time there is, is used"
    slow = settled(2e-5)
    assert slow.width == 400, "few rays make a smaller picture better"
    assert 2e-5 * slow.work == pytest.approx(60, rel=0.1)
    assert settled(1e-2) == PreviewPlan(160, 90, GOOD_RAYS)
    assert settled(1e-5).rays == pytest.approx(quick.rays, abs=1)
    assert settled(1e-9).rays == ENOUGH_RAYS


def test_plans_of_few_rays_are_as_large_as_they_can_be() -> None:
    planner = PreviewPlanner(is_software=True)
    assert planner.plan(480, 270, 60, most_rays=8) == PreviewPlan(400, 225, 8)
    for _ in range(60):
        planner.learn(PreviewPlan(480, 270, 8), 40.0, 0.0)
    assert planner.plan(480, 270, 60, most_rays=8) == PreviewPlan(480, 270, 8)


def test_plans_leave_time_for_what_takes_as_long_whatever_the_size() -> None:
    """So that a long search before the rays makes a preview coarser, but does not make large pictures seem dear."""
    planner = PreviewPlanner(is_software=True)
    for _ in range(60):
        plan = planner.plan(960, 540, 60)
        planner.learn(plan, 2e-5 * plan.work, 20.0)
    assert 2e-5 * plan.work == pytest.approx(40, rel=0.15)
    for _ in range(60):
        planner.learn(plan, 2e-5 * plan.work, 1000.0)
    assert planner.plan(960, 540, 60) == PreviewPlan(160, 90, GOOD_RAYS)
    assert 2e-5 * planner.plan(960, 540, 60, least_ms=30.0).work == pytest.approx(30, rel=0.15)
