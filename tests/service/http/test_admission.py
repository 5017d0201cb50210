"""Admission of pictures by what they are expected to cost."""

from __future__ import annotations

import pytest

from render.engines import engine_names
from service.http.admission import Admission, estimate_s
from service.http.errors import ServiceError
from service.http.settings import Settings
from service.models.frames import FrameQuery
from service.workers.errors import UnfitError
from service.workers.jobs import NOBODY, Finished
from service.workers.places import Place


def query(**fields) -> FrameQuery:
    return FrameQuery(time=1, **{"width": 480, "height": 270} | fields)


@pytest.mark.parametrize(
    ("dearer", "times"),
    [
        ({"rays": 10_000}, 20),
        ({"width": 4800, "height": 2700}, 30),  # with layers half as fine along each axis
        ({"motion": 64, "rays": 1}, 30),
        ({"noise": 0.002}, 2),
        ({"wavelengths": 30}, 2),
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
    assert estimate_s(query(motion=64, motion_by="velocities")) < estimate_s(query(motion=64))


def test_blur_by_points_costs_the_fourth_power_of_the_size():
    small, large = (estimate_s(query(engine="gather", width=w, height=w * 9 // 16)) for w in (2000, 4000))
    assert 12 < large / small < 18


@pytest.mark.parametrize(
    "beyond",
    [
        {"engine": "gather", "width": 1920, "height": 1080},
        {"engine": "importance", "width": 3840, "height": 2160, "supersample": 4},
        {"engine": "linear", "width": 3840, "height": 2160},
        {"engine": "accumulation", "width": 1920, "height": 1080, "rays": 1000},
        {"width": 3840, "height": 2160, "rays": 1000},
    ],
)
def test_a_picture_that_a_worker_has_no_time_for_is_refused(beyond):
    """A worker has 300 s (`frame_timeout_s`), which are 600 s of processor time on two cores."""
    with pytest.raises(ServiceError, match="expected to take"):
        Admission(Settings().max_picture_s).check("shot", query(**beyond))


@pytest.mark.parametrize("engine", engine_names())
def test_a_full_hd_picture_of_all_but_the_baselines_is_admitted(engine):
    rays = 16 if engine == "accumulation" else 100
    picture = query(engine=engine, width=960 if engine == "gather" else 1920, height=None, rays=rays)
    Admission(Settings().max_picture_s).check("shot", picture)


def test_pictures_from_kept_layers_do_not_admit_much_dearer_ones():
    admission = Admission(600)
    for _ in range(20):
        admission.learn(Finished("final", NOBODY, Place("kept"), 0.0, 1.0, 0.1, 10.0, None))
    ordinary_s, expected_s = admission.check("kept", query())
    assert expected_s == ordinary_s


def test_pictures_that_take_too_long_make_their_shot_dearer():
    admission = Admission(600)
    ended = UnfitError("This takes longer.", "timeout")
    admission.learn(Finished("final", NOBODY, Place("slow"), 0.0, 300.0, 0.0, 100.0, ended))
    crashed = UnfitError("The worker crashed.", "crash")
    admission.learn(Finished("final", NOBODY, Place("broken"), 0.0, 300.0, 0.0, 100.0, crashed))
    ordinary_s = estimate_s(query())
    assert admission.check("slow", query()).expected_s == pytest.approx(3 * ordinary_s)
    assert admission.check("broken", query()).expected_s == ordinary_s


@pytest.mark.parametrize("dearer", [{"wavelengths": 30, "noise": 0.002}, {"engine": "flag", "rays": 4096}])
def test_wavelengths_and_rays_of_a_closed_iris_are_counted(dearer):
    plain = {name: value for name, value in dearer.items() if name in ("engine", "noise")}
    assert estimate_s(query(**dearer)) > 5 * estimate_s(query(**plain))


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
    estimated = admission.check("dear", picture).ordinary_s
    for _ in range(8):
        admission.learn(Finished("final", NOBODY, Place("dear"), 0.0, 1.0, 50 * estimated, estimated, None))
    with pytest.raises(ServiceError):
        admission.check("dear", picture)
    assert admission.check("other", picture) == (estimated, estimated)


def test_rest_refuses_an_absurd_frame_before_it_works(service, client, room):
    before = dict(service.internal.pool.starts)
    for path, options in (("frame", {"params": {"time": 1, "rays": 10**9}}),):
        answer = client.get(f"/v1/shots/{room}/{path}", **options)
        assert (answer.status_code, answer.json()["code"]) == (422, "too_costly")
    answer = client.post(f"/v1/shots/{room}/long-exposure", json={"first": 1, "last": 2, "rays": 10**9})
    assert (answer.status_code, answer.json()["code"]) == (422, "too_costly")
    assert service.internal.pool.starts == before
