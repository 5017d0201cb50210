"""Focus curves for the tests of their files."""

from __future__ import annotations

import math

import numpy as np

from render.focus import FocusCurve, PointTrack


def curve(**changes) -> FocusCurve:
    """Three frames of a rack from near to infinity, on a stage with two time codes a frame."""
    fields = {
        "camera": "/World/cam",
        "frames_per_second": 24.0,
        "time_codes_per_second": 48.0,
        "time_codes": np.array([2.0, 4.0, 6.0]),
        "focus_distance_m": np.array([1.0, 2.0, math.inf]),
        "f_stop": np.array([2.0, 2.0, 2.0]),
        "focal_length_mm": np.array([50.0, 50.0, 50.0]),
        "near_m": np.array([0.98, 1.9, 43.0]),
        "far_m": np.array([1.02, 2.1, math.inf]),
        "hyperfocal_m": np.array([43.0, 43.0, 43.0]),
        "coc_limit_mm": np.array([0.029, 0.029, 0.029]),
        "sources": ("points", "points", "camera"),
        "reasons": ("focused by hero", "focused by hero", "no focus point counts"),
        "points": (
            PointTrack(
                name="hero",
                depth_m=np.array([1.0, 2.0, math.nan]),
                weight=np.array([1.0, 1.0, 1.0]),
                share=np.array([1.0, 1.0, 0.0]),
                coc_mm=np.array([0.0, 0.01, math.nan]),
                states=("used", "used", "lost"),
            ),
        ),
    }
    return FocusCurve(**{**fields, **changes})


def full_curve(frames: int = 48, per_second: float = 24000 / 1001) -> FocusCurve:
    """A rack with everything that can be in a curve, one time code a frame from frame 1001 on."""
    rng = np.random.default_rng(4)
    t = np.arange(frames)
    distance = 1 / np.linspace(1 / 1.37, 1 / 11, frames)
    distance[-1] = math.inf
    return FocusCurve(
        camera="/World/rig/cam",
        frames_per_second=per_second,
        time_codes_per_second=per_second,
        time_codes=1001.0 + t,
        focus_distance_m=distance,
        f_stop=np.linspace(2.8, 4, frames),
        focal_length_mm=np.full(frames, 47.3),
        near_m=distance.clip(max=100) * 0.9,
        far_m=distance * 1.1,
        hyperfocal_m=rng.uniform(30, 40, frames),
        coc_limit_mm=np.full(frames, 0.025),
        sources=("points",) * (frames - 1) + ("camera",),
        reasons=tuple(f"focused by hero, at “{i}”, so far" for i in t.tolist()),
        points=(
            PointTrack(
                "hero",
                distance.clip(max=50),
                rng.random(frames),
                np.ones(frames),
                rng.random(frames) / 30,
                ("used",) * frames,
            ),
            PointTrack(
                "dog",
                np.full(frames, math.nan),
                np.ones(frames),
                np.zeros(frames),
                np.full(frames, math.nan),
                ("lost",) * frames,
            ),
        ),
        tilt_rad=np.linspace(0, 0.1, frames),
        swing_rad=np.linspace(0.05, -0.02, frames),
        limited=t % 5 == 0,
        lens_name="Summicron 50",
        gate_mm=(24.89, 18.66),
    )


def same(one: FocusCurve, other: FocusCurve, rel: float = 1e-14, *, header: bool = True) -> None:
    """Hold two curves to be the same, NaN for NaN; a file without a header knows no camera."""
    if header:
        assert (one.camera, one.lens_name, one.gate_mm) == (other.camera, other.lens_name, other.gate_mm)
    same_numbers(one, other, rel)
    assert (one.sources, one.reasons) == (other.sources, other.reasons)
    assert one.limited.tolist() == other.limited.tolist()
    assert [p.name for p in one.points] == [p.name for p in other.points]
    for a, b in zip(one.points, other.points, strict=True):
        assert a.states == b.states
        for name in ("depth_m", "weight", "share", "coc_mm"):
            np.testing.assert_allclose(getattr(a, name), getattr(b, name), rtol=rel)


def same_numbers(one: FocusCurve, other: FocusCurve, rel: float = 1e-14) -> None:
    """Hold the numbers of the lens and the times of two curves to be the same, NaN for NaN."""
    names = ("time_codes", "focus_distance_m", "f_stop", "focal_length_mm", "near_m", "far_m", "hyperfocal_m")
    for name in (*names, "coc_limit_mm", "tilt_rad", "swing_rad"):
        np.testing.assert_allclose(getattr(one, name), getattr(other, name), rtol=rel, atol=1e-16, err_msg=name)
    assert (one.frames_per_second, one.time_codes_per_second) == (other.frames_per_second, other.time_codes_per_second)
