"""Admission of pictures by what they are expected to cost."""

from __future__ import annotations

from dataclasses import replace

import pytest

from render.engines import engine_names
from render.errors import SettingsError
from service.http.admission import Admission, Admitted
from service.http.settings import Settings
from service.models.frames import FrameQuery
from service.models.long_exposure import LongExposureBegin
from service.models.picture_limits import PictureCost
from service.workers.errors import UnfitError
from service.workers.jobs import NOBODY, Finished
from service.workers.places import Place


def query(**fields) -> FrameQuery:
    return FrameQuery(time=1, **{"width": 480, "height": 270} | fields)


def estimate_s(picture: FrameQuery) -> float:
    return PictureCost.of(picture).ordinary_s


def admission_of(max_s: float) -> Admission:
    return Admission(max_s, Settings().max_picture_px)


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
    with pytest.raises(SettingsError, match="expected to take"):
        admission_of(Settings().max_picture_s).check("shot", query(**beyond))


@pytest.mark.parametrize("engine", engine_names())
def test_a_full_hd_picture_of_all_but_the_baselines_is_admitted(engine):
    rays = 16 if engine == "accumulation" else 100
    picture = query(engine=engine, width=960 if engine == "gather" else 1920, height=None, rays=rays)
    admission_of(Settings().max_picture_s).check("shot", picture)


def finished(shot: str, cpu_s: float, estimate_s: float, error: Exception | None = None, **more: bool) -> Finished:
    """A picture that was made."""
    return Finished("final", NOBODY, Place(shot), 0.0, 1.0, cpu_s, estimate_s, error, **more)


def test_pictures_from_kept_layers_make_no_shot_cheap():
    admission = admission_of(600)
    for _ in range(20):
        admission.learn(finished("kept", 0.1, 10.0))
    cost = admission.check("kept", query()).cost
    assert cost.expected_s == cost.ordinary_s


def test_cheaper_pictures_make_a_dear_shot_cheap_again():
    admission = admission_of(600)
    for cpu_s in (80.0, *[4.0] * 20):
        admission.learn(finished("once", cpu_s, 10.0))
    cost = admission.check("once", query()).cost
    assert cost.expected_s == pytest.approx(cost.ordinary_s, rel=0.01)


def test_opening_a_shot_is_not_held_against_its_pictures():
    admission = admission_of(600)
    admission.learn(finished("new", 80.0, 10.0, has_started_process=True))
    cost = admission.check("new", query()).cost
    assert cost.expected_s == cost.ordinary_s


def test_what_a_worker_had_no_time_for_is_refused_next_time():
    estimated_s = estimate_s(query())
    admission = admission_of(1.5 * estimated_s)
    admission.learn(finished("slow", estimated_s, estimated_s, UnfitError("This takes longer.", "timeout")))
    admission.learn(finished("broken", estimated_s, estimated_s, UnfitError("The worker crashed.", "crash")))
    with pytest.raises(SettingsError, match="expected to take"):
        admission.check("slow", query())
    assert admission.check("broken", query()).cost.expected_s == estimated_s


@pytest.mark.parametrize("dearer", [{"wavelengths": 30, "noise": 0.002}, {"engine": "flag", "rays": 4096}])
def test_wavelengths_and_rays_of_a_closed_iris_are_counted(dearer):
    plain = {name: value for name, value in dearer.items() if name in ("engine", "noise")}
    assert estimate_s(query(**dearer)) > 5 * estimate_s(query(**plain))


def test_an_absurd_picture_is_refused_with_its_cost():
    with pytest.raises(SettingsError, match=r"expected to take .* at most 600 s") as refused:
        admission_of(600).check("shot", query(rays=10**9))
    assert (refused.value.code, refused.value.path) == ("too_costly", "query")


@pytest.mark.parametrize("beyond", [{"supersample": 1e300}, {"rays": 10**400}])
def test_a_cost_beyond_all_numbers_is_refused(beyond):
    with pytest.raises(SettingsError, match="expected to take"):
        admission_of(600).check("shot", query(**beyond))


def test_a_picture_is_judged_again_in_the_shape_of_its_gate():
    limits = admission_of(600).check("shot", FrameQuery(time=1, width=1280, rays=4000)).limits
    limits.check(1280, 720)
    with pytest.raises(SettingsError, match="expected to take") as dear:
        limits.check(1280, 1600)
    with pytest.raises(SettingsError, match="px are rendered") as large:
        limits.check(1280, 10**6)
    assert (dear.value.code, large.value.code) == ("too_costly", "too_many_pixels")


def test_the_shape_of_a_gate_is_counted_once():
    admission, picture = admission_of(600), FrameQuery(time=1, width=1280, rays=400)
    tall_s = admission.check("tall", picture).cost.with_height(2276).expected_s
    for _ in range(8):
        admission.learn(finished("tall", tall_s, PictureCost.of(picture).ordinary_s))
    cost = admission.check("tall", picture).cost
    assert cost.expected_s == pytest.approx(tall_s, rel=0.05)
    assert cost.with_height(2276).expected_s == tall_s


def test_a_preview_is_judged_by_its_pixels_alone():
    admission = Admission(600, max_px=1000)
    admission.check_preview(query(width=100, height=10, rays=10**9)).check(100, 10)
    with pytest.raises(SettingsError, match="px are rendered"):
        admission.check_preview(query(width=100, height=11))


@pytest.mark.parametrize(("max_s", "max_px", "code"), [(600, 100, "too_many_pixels"), (0.01, 2**25, "too_costly")])
def test_rest_refuses_a_camera_that_makes_a_picture_dear(service, client, room, monkeypatch, max_s, max_px, code):
    """The worker is given limits below what the service has admitted."""
    admission = service.internal.admission

    def admit(shot_id, picture):
        cost, limits = Admission.check(admission, shot_id, picture)
        return Admitted(cost, replace(limits, max_s=max_s, max_px=max_px))

    monkeypatch.setattr(admission, "check", admit)
    frame = client.get(f"/v1/shots/{room}/frame", params={"time": 1, "width": 16, "rays": 1})
    exposure = client.post(f"/v1/shots/{room}/long-exposure", json={"first": 1, "last": 2, "width": 16, "rays": 1})
    assert [(answer.status_code, answer.json()["code"]) for answer in (frame, exposure)] == [(422, code)] * 2
    assert [answer.json()["path"].split(".")[0] for answer in (frame, exposure)] == ["query", "body"]


def test_moments_that_an_exposure_chooses_count_at_their_most():
    choosing, stated = (LongExposureBegin(first=1, last=2, width=960, motion=motion) for motion in (1, 32))
    assert estimate_s(choosing) >= estimate_s(stated)


def test_a_shot_that_costs_more_than_others_is_judged_by_it():
    admission = admission_of(600)
    picture = query(rays=10_000)
    estimated = admission.check("dear", picture).cost.ordinary_s
    for _ in range(8):
        admission.learn(Finished("final", NOBODY, Place("dear"), 0.0, 1.0, 50 * estimated, estimated, None))
    with pytest.raises(SettingsError):
        admission.check("dear", picture)
    assert admission.check("other", picture).cost.expected_s == estimated


def test_rest_refuses_an_absurd_frame_before_it_works(service, client, room):
    before = dict(service.internal.pool.starts)
    answer = client.get(f"/v1/shots/{room}/frame", params={"time": 1, "rays": 10**9})
    assert (answer.status_code, answer.json()["code"]) == (422, "too_costly")
    answer = client.post(f"/v1/shots/{room}/long-exposure", json={"first": 1, "last": 2, "rays": 10**9})
    assert (answer.status_code, answer.json()["code"]) == (422, "too_costly")
    assert service.internal.pool.starts == before
