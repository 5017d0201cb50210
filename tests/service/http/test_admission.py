"""Admission of pictures by what they are expected to cost."""

from __future__ import annotations

import pytest

from service.http.admission import Admission, estimate_s
from service.http.errors import ServiceError
from service.models.frames import FrameQuery
from service.workers.jobs import NOBODY, Finished
from service.workers.places import Place


def query(**fields) -> FrameQuery:
    return FrameQuery(time=1, **{"width": 480, "height": 270} | fields)


@pytest.mark.parametrize(
    ("dearer", "times"),
    [
        ({"rays": 10_000}, 20),
        ({"width": 4800, "height": 2700}, 50),
        ({"motion": 64, "rays": 1}, 30),
        ({"noise": 0.01}, 2),
    ],
)
def test_what_makes_a_picture_dear_is_counted(dearer, times):
    assert estimate_s(query(**dearer)) > times * estimate_s(query(**dict.fromkeys({"rays", "motion"} & set(dearer), 1)))


def test_supersampling_counts_by_its_square():
    plain, fine = (estimate_s(query(rays=1, width=8000, height=4000, supersample=s)) for s in (1, 4))
    assert fine / plain > 8


def test_an_engine_that_draws_the_scene_for_each_ray_is_dear():
    assert estimate_s(query(engine="accumulation", rays=1000)) > 5 * estimate_s(query(engine="pinhole", rays=1000))


def test_velocities_draw_the_scene_once():
    assert estimate_s(query(motion=64, motion_by="velocities")) < estimate_s(query(motion=64)) / 3


def test_an_absurd_picture_is_refused_with_its_cost():
    with pytest.raises(ServiceError, match=r"expected to take .* at most 600 s") as refused:
        Admission(600).check("shot", query(rays=10**9))
    assert (refused.value.status, refused.value.code) == (422, "too_costly")


@pytest.mark.parametrize("beyond", [{"supersample": 1e300}, {"rays": 10**400}])
def test_a_cost_beyond_all_numbers_is_refused(beyond):
    with pytest.raises(ServiceError, match="expected to take"):
        Admission(600).check("shot", query(**beyond))


def test_a_shot_that_costs_more_than_others_is_judged_by_it():
    admission = Admission(600)
    picture = query(rays=10_000)
    estimated = admission.check("dear", picture)
    for _ in range(8):
        admission.learn(Finished("final", NOBODY, Place("dear"), 0.0, 1.0, 50 * estimated, estimated, None))
    with pytest.raises(ServiceError):
        admission.check("dear", picture)
    assert admission.check("other", picture) == estimated


def test_rest_refuses_an_absurd_frame_before_it_works(service, client, room):
    before = dict(service.internal.pool.starts)
    for path, options in (("frame", {"params": {"time": 1, "rays": 10**9}}),):
        answer = client.get(f"/v1/shots/{room}/{path}", **options)
        assert (answer.status_code, answer.json()["code"]) == (422, "too_costly")
    answer = client.post(f"/v1/shots/{room}/long-exposure", json={"first": 1, "last": 2, "rays": 10**9})
    assert (answer.status_code, answer.json()["code"]) == (422, "too_costly")
    assert service.internal.pool.starts == before
