"""Keys of a camera's place: the times at which the operations of its own transform are keyed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from pxr import Sdf, Usd, UsdGeom

from render.errors import CameraError, NotFoundError, SettingsError
from render.shot.camera.placing import MAX_SAMPLES
from render.shot.times import check_time
from usd_schemas.keys import author_spline


def place_keys(camera: UsdGeom.Camera) -> list[float]:
    """USD time codes of the keys, rising; those of a camera with more than `MAX_SAMPLES` are the first ones.

    They are the time samples and the knots of all operations of the camera's own transform. What it is below may move it too.
    """
    times = {time for attribute in _operations(camera) for time in _key_times(attribute)}
    return sorted(times)[:MAX_SAMPLES]


def edited_keys(camera: UsdGeom.Camera, layer: Sdf.Layer) -> set[float]:
    """USD time codes of those of the keys that a layer has, which are all of an operation that it keys.

    Args:
        camera: of the stage.
        layer: the edit layer.
    """
    keyed = [attribute for attribute in _operations(camera) if _is_keyed_in(attribute, layer)]
    return {time for attribute in keyed for time in _key_times(attribute)}


def is_placing(name: str) -> bool:
    """Whether the property of that name is one of a prim's place."""
    return name == str(UsdGeom.Tokens.xformOpOrder) or name.startswith("xformOp:")


def remove_place_key(camera: UsdGeom.Camera, time: float) -> None:
    """Remove a key, in the stage's edit target; after the last one of an operation its value there stays for all time.

    Args:
        camera: of the stage, in no instance.
        time: USD time code.

    Raises:
        NotFoundError: there is no key at the time.
        CameraError: there are too many samples.
        SettingsError: the time is not finite.
    """
    _check_keys(camera, [time])
    for attribute in _operations(camera):
        if _has_key(attribute, time):
            _without_key(attribute, time)


def move_place_keys(camera: UsdGeom.Camera, moves: Mapping[float, float]) -> None:
    """Move keys in time, all at once, in the stage's edit target. Other keys that stand where one arrives are replaced.

    Args:
        camera: of the stage, in no instance.
        moves: new time by time, USD time codes.

    Raises:
        NotFoundError: there is no key at a time.
        CameraError: there are too many samples.
        SettingsError: a time is not finite, or two keys would come to one time.
    """
    if len(set(map(check_time, moves.values()))) < len(moves):
        raise SettingsError("two keys of the camera's place cannot come to one time", code="bad_key")
    _check_keys(camera, list(moves))
    for attribute in _operations(camera):
        keyed = set(_key_times(attribute))
        own = {time: to for time, to in moves.items() if time in keyed}
        if own and attribute.HasSpline():
            _move_knots(attribute, own)
        elif own:
            _move_samples(attribute, own)


def _operations(camera: UsdGeom.Camera) -> list[Usd.Attribute]:
    """Attributes of the operations of a camera's own transform; one that two operations share is there once."""
    found = {op.GetAttr().GetPath(): op.GetAttr() for op in camera.GetOrderedXformOps()}
    return list(found.values())


def _key_times(attribute: Usd.Attribute) -> list[float]:
    """Times of the first `MAX_SAMPLES` of its keys, rising. A time sample that blocks the value is none."""
    return [time for time in _sample_times(attribute)[:MAX_SAMPLES] if attribute.Get(time) is not None]


def _sample_times(attribute: Usd.Attribute) -> list[float]:
    """Times of its knots, or of its time samples, among them those that block the value; rising."""
    return list(attribute.GetSpline().GetKnots().keys() if attribute.HasSpline() else attribute.GetTimeSamples())


def _has_key(attribute: Usd.Attribute, time: float) -> bool:
    return time in _sample_times(attribute) and attribute.Get(time) is not None


def _is_keyed_in(attribute: Usd.Attribute, layer: Sdf.Layer) -> bool:
    spec = layer.GetAttributeAtPath(attribute.GetPath())
    return spec is not None and (spec.HasInfo("timeSamples") or spec.HasInfo("spline"))


def _check_keys(camera: UsdGeom.Camera, times: Iterable[float]) -> None:
    path = str(camera.GetPath())
    if any(attribute.GetNumTimeSamples() > MAX_SAMPLES for attribute in _operations(camera)):
        detail = f"the keys of camera {path} cannot be edited: its way has more than {MAX_SAMPLES:,} samples"
        raise CameraError(detail, code="bad_place", path=path)
    missing = set(map(check_time, times))
    for attribute in _operations(camera):
        missing -= {time for time in missing.intersection(_sample_times(attribute)) if attribute.Get(time) is not None}
    if missing:
        known = place_keys(camera)
        listed = ", ".join(f"{key:g}" for key in known[:10]) + (", …" if len(known) > 10 else "")
        detail = f"the place of camera {path} has no key at time {min(missing):g}, its keys are: {listed or 'none'}"
        raise NotFoundError(detail, path=path)


def _without_key(attribute: Usd.Attribute, time: float) -> None:
    value = attribute.Get(time)
    if attribute.HasSpline():
        spline = attribute.GetSpline()
        spline.RemoveKnot(time)
        if not spline.IsEmpty():
            author_spline(attribute, spline)
            return
    elif any(other != time and attribute.Get(other) is not None for other in _sample_times(attribute)):
        _own_samples(attribute)
        attribute.ClearAtTime(time)
        return
    attribute.Clear()
    attribute.Set(value)


def _move_samples(attribute: Usd.Attribute, moves: Mapping[float, float]) -> None:
    values = {to: attribute.Get(time) for time, to in moves.items()}
    _own_samples(attribute)
    for time in moves:
        attribute.ClearAtTime(time)
    for time, value in values.items():
        attribute.Set(value, time)


def _move_knots(attribute: Usd.Attribute, moves: Mapping[float, float]) -> None:
    spline = attribute.GetSpline()
    knots = [(to, spline.GetKnot(time)) for time, to in moves.items()]
    for time in moves:
        spline.RemoveKnot(time)
    for to, knot in knots:
        knot.SetTime(to)
        spline.SetKnot(knot)
    author_spline(attribute, spline)


def _own_samples(attribute: Usd.Attribute) -> None:
    """Copy the time samples of a weaker layer into the edit target, unless it has some of its own."""
    spec = attribute.GetStage().GetEditTarget().GetAttributeSpecForScenePath(attribute.GetPath())
    if spec is not None and spec.HasInfo("timeSamples"):
        return
    for time, value in [(time, attribute.Get(time)) for time in attribute.GetTimeSamples()]:
        attribute.Set(Sdf.ValueBlock() if value is None else value, time)
