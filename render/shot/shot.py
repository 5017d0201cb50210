"""One opened shot: what the command line and the service both work on, so that both give the same pixels."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from pxr import Sdf, Usd

from render.errors import CameraError, NotFoundError, SettingsError
from render.focus import FocusCurve
from render.scene import Camera, Scene
from render.shot.anchor import Picked, anchored
from render.shot.curve import focus_layer, solve_curve
from render.shot.edits import Edits
from render.shot.findings import camera_findings
from render.shot.focusing import Focused, PlacedPoint, Readout, focus_camera, place_points, read_out
from render.shot.lens import author_lens, set_focus_mode
from render.stage import (
    AnchorReader,
    CameraChoice,
    Finding,
    FrameRange,
    StageReader,
    default_camera,
    frame_range,
    list_cameras,
    open_stage,
    read_camera,
)
from usd_schemas import FocusPoint, FocusPointView, Interpolation, Key, LensCamera


class Shot:
    """A USD stage, its cameras and focus, and the layer of edits over it.

    Each edit goes to the edit layer (`render.shot.edits`); no file of the user's is ever written. An edit that fails
    leaves everything as it was.

    A shot is for one thread at a time: USD stages may not be written while they are read, so callers with several threads
    (the service) hold a lock around each call.

    Where a camera path is asked for, None stands for the shot's default camera, and `CameraError` is raised where there is
    no such camera or its numbers are impossible. A time is a USD time code; one that is not finite raises `SettingsError`.

    Attributes:
        path: the file that was opened.
        stage: the composed stage, edits included.
    """

    def __init__(self, path: Path, stage: Usd.Stage, edits: Edits, reader: StageReader) -> None:
        """Use `Shot.open`."""
        self.path = path
        self.stage = stage
        self._edits = edits
        self._reader = reader
        self._anchors = AnchorReader(stage)
        edits.attach(stage)

    @classmethod
    def open(
        cls,
        path: str | Path,
        *,
        confined_to: Path | None = None,
        purposes: Sequence[str] = ("default", "render"),
        mask: Sequence[str] | None = None,
        complexity: str = "low",
        edits: Path | None = None,
    ) -> Shot:
        """Open a shot.

        Args:
            path: a USD file.
            confined_to: folder that nothing the stage refers to may lie outside of; None for anywhere.
            purposes: which of USD's purposes are drawn.
            mask: only what lies at, below or above these prim paths is drawn; None for everything.
            complexity: how finely surfaces are refined, as in usdrecord.
            edits: a layer that `save_edits` wrote, to go on from. The file itself is not written to.

        Raises:
            StageError: a file is no USD, is damaged, or refers to what is missing or outside ``confined_to``.
        """
        layer = Edits(edits)
        stage = open_stage(Path(path), edit_layer=layer.layer, confined_to=confined_to)
        reader = StageReader(stage, purposes=tuple(purposes), mask=mask, complexity=complexity)
        return cls(Path(path), stage, layer, reader)

    # What there is

    @property
    def edit_layer(self) -> Sdf.Layer:
        """The layer that all edits go to."""
        return self._edits.layer

    @property
    def frame_range(self) -> FrameRange:
        """First and last frame as time codes, and how many pass in a second."""
        return frame_range(self.stage)

    def cameras(self) -> list[str]:
        """Prim paths of all cameras."""
        return list_cameras(self.stage)

    def default_camera(self) -> CameraChoice:
        """The camera that is used when none is named, and why."""
        return default_camera(self.stage)

    def findings(self) -> list[Finding]:
        """What was found so far that is not honoured, or could not be used."""
        return [*self._reader.findings, *camera_findings(self.stage, self.cameras())]

    # What the renderer needs

    def scene_at(self, time: float) -> Scene:
        """What is drawn at a USD time code; what did not change since the last call is the same object."""
        return self._reader.read(_checked_time(time))

    def camera_at(self, camera_path: str | None, time: float, width: int, height: int) -> Camera:
        """The camera for a picture, its focus solved.

        Where ``focus:mode`` says points, the focus distance is the one that serves the focus points best. A camera whose
        mode is not authored is focused by hand, even where points exist: manual is what the schema falls back to, and
        what every other tool sees.

        Args:
            camera_path: of a camera.
            time: USD time code.
            width: of the picture in pixels.
            height: of the picture in pixels.

        Raises:
            SettingsError: the picture has no pixels.
        """
        if width < 1 or height < 1:
            raise SettingsError(f"a picture must be at least 1 × 1 pixels, but {width} × {height} was asked for")
        path = self._path_or_none(camera_path)
        if path is None:
            framing = default_camera(self.stage, aspect=width / height).framing
            if framing is not None:
                return framing
        focused = self._focused(self._path(path), time)
        return self._for_picture(focused, time, width / height)

    def readout(self, camera_path: str | None, time: float) -> Readout:
        """Focus, f-number, focal length and depth of field.

        Args:
            camera_path: of a camera.
            time: USD time code.
        """
        return read_out(self._focused(self._path(camera_path), time))

    # Focus points

    def focus_points(self, camera_path: str | None, time: float, *, aspect: float | None = None) -> list[PlacedPoint]:
        """A camera's focus points as they stand in its picture.

        Args:
            camera_path: of a camera.
            time: USD time code.
            aspect: width over height of the picture; None takes the camera's own film gate.
        """
        focused = self._focused(self._path(camera_path), time)
        return place_points(focused, self._for_picture(focused, time, aspect))

    def add_focus_point(self, camera_path: str | None, name: str, anchor: Picked | FocusPoint) -> FocusPoint:
        """Add a focus point, and let the points decide the focus where it was set by hand.

        Args:
            camera_path: of a camera.
            name: an identifier (letters, digits and ``_``, no digit first) that no other focus point of the camera has.
            anchor: what was clicked on, or all of a focus point (its own name does not matter).

        Returns:
            What was authored.

        Raises:
            SettingsError: the name is not legal or taken, or a value is not allowed.
        """
        lens_camera = self._lens_camera(camera_path)
        point = anchor if isinstance(anchor, FocusPoint) else anchored(name, anchor)
        if any(view.name == name for view in lens_camera.focus_points()):
            path = str(lens_camera.prim.GetPath())
            raise SettingsError(f"camera {path} already has a focus point named {name!r}", code="name_taken", path=path)
        with self._edits.editing():
            view = lens_camera.add_focus_point(name, replace(point, name=name))
            if lens_camera.focus.read().mode == "manual":
                set_focus_mode(lens_camera, "points")
        return view.read()

    def update_focus_point(
        self, camera_path: str | None, name: str, *, time: float | None = None, **changes: Any
    ) -> FocusPoint:
        """Change some fields of a focus point.

        A field that has keys gets one at the time; a field that has none is changed for all time.

        Args:
            camera_path: of a camera.
            name: of the focus point.
            time: USD time code, needed where a field has keys.
            changes: new values by the names of `FocusPoint`'s fields.

        Returns:
            The point as it is afterwards, at the time.

        Raises:
            NotFoundError: the camera has no such point.
            SettingsError: a value or a field is not allowed, or a field has keys and no time is given.
        """
        view = self._point(camera_path, name)
        unknown = set(changes) - (set(FocusPoint.__dataclass_fields__) - {"name"})
        if unknown:
            raise SettingsError(f"focus points have no {', '.join(sorted(unknown))} to change", code="bad_field")
        keyed = {field for field in changes if time is not None and field != "target" and view.keys(field)}
        with self._edits.editing():
            if keyed:
                view.author(replace(view.read(time), **{field: changes[field] for field in keyed}), time)
            view.author(replace(view.read(), **{field: v for field, v in changes.items() if field not in keyed}))
        return view.read(time)

    def remove_focus_point(self, camera_path: str | None, name: str) -> None:
        """Remove a focus point.

        Raises:
            NotFoundError: the camera has no such point.
        """
        self._point(camera_path, name)
        with self._edits.editing():
            self._lens_camera(camera_path).remove_focus_point(name)

    def keys(self, camera_path: str | None, name: str, attribute: str) -> list[Key]:
        """Keys of one attribute of a focus point, such as ``weight`` or ``enabled``, in order of time.

        Raises:
            NotFoundError: the camera has no such point.
            SettingsError: a focus point has no such attribute.
        """
        view = self._point(camera_path, name)
        with self._edits.editing():
            return view.keys(attribute)

    def set_key(
        self,
        camera_path: str | None,
        name: str,
        attribute: str,
        time: float,
        value: Any,
        interpolation: Interpolation | None = None,
    ) -> None:
        """Set, or replace, a key of one attribute of a focus point.

        Args:
            camera_path: of a camera.
            name: of the focus point.
            attribute: such as ``weight`` or ``enabled``; target, kind and topology take no keys.
            time: USD time code.
            value: in the attribute's own unit.
            interpolation: how the value goes on to the next key: linear, held, bezier or auto; None suits the attribute.

        Raises:
            NotFoundError: the camera has no such point.
            SettingsError: the attribute takes no such key, value or interpolation, or the time is not finite.
        """
        view = self._point(camera_path, name)
        with self._edits.editing():
            view.set_key(attribute, _checked_time(time), value, interpolation or "linear")

    def remove_key(self, camera_path: str | None, name: str, attribute: str, time: float) -> None:
        """Remove a key; after the last one its value stays for all time.

        Raises:
            NotFoundError: the camera has no such point, or the attribute no key at that time.
            SettingsError: a focus point has no such attribute.
        """
        view = self._point(camera_path, name)
        times = [key.time for key in self.keys(camera_path, name, attribute)]
        if time not in times:
            told = ", ".join(f"{t:g}" for t in times) or "none"
            raise NotFoundError(
                f"{attribute} of focus point {name!r} has no key at time {time:g}, its keys are: {told}"
            )
        with self._edits.editing():
            view.remove_key(attribute, time)

    # The lens

    def set_camera(
        self,
        camera_path: str | None,
        *,
        f_stop: float | None = None,
        focal_length_mm: float | None = None,
        focus_distance_m: float | None = None,
        focus_mode: str | None = None,
        time: float | None = None,
    ) -> None:
        """Change the lens. What is None stays as it is.

        A hand on the focus ring wins: with a focus distance and no mode, the mode becomes manual.

        Args:
            camera_path: of a camera.
            f_stop: f-number; 0 is a pinhole.
            focal_length_mm: focal length.
            focus_distance_m: depth of the plane of focus; infinite is authored as 100 km, since tools disagree on what 0
                means and a curve through infinity has no middle.
            focus_mode: manual, points, tiltPlane or surface; it is the same at all times.
            time: USD time code of the keys; None drops the keys there are and holds the values for all time.

        Raises:
            SettingsError: a value is out of range, or the time is not finite.
        """
        camera = self._lens_camera(camera_path)
        mode = focus_mode or ("manual" if focus_distance_m is not None else None)
        with self._edits.editing():
            author_lens(camera, time, f_stop=f_stop, focal_length_mm=focal_length_mm, focus_distance_m=focus_distance_m)
            if mode is not None:
                set_focus_mode(camera, mode)

    def focus_curve(self, camera_path: str | None, frames: Sequence[float]) -> FocusCurve:
        """The lens over some frames, its focus solved at each.

        Args:
            camera_path: of a camera.
            frames: rising USD time codes.

        Raises:
            SettingsError: there are no frames, too many, or they do not rise.
        """
        return solve_curve(self.stage, self._anchors, self._path(camera_path), frames)

    def focus_layer(self, camera_path: str | None, frames: Sequence[float], baked: bool = False) -> str:
        """The solved focus as a USD layer for other tools (usda text), to be sublayered over the shot.

        Args:
            camera_path: of a camera.
            frames: rising USD time codes.
            baked: time samples, for tools that read no splines, in place of a native spline.

        Raises:
            SettingsError: there are no frames, too many, or they do not rise.
        """
        return focus_layer(self.stage, self.focus_curve(camera_path, frames), baked=baked)

    # The edits

    def export_edits(self) -> str:
        """The edit layer as usda text."""
        return self._edits.export()

    def replace_edits(self, text: str) -> None:
        """Put other edits in place of all there are.

        Args:
            text: of a usda layer, as `export_edits` gives it.

        Raises:
            StageError: it is no usda; the edits there were stay.
        """
        self._edits.replace(text)

    def save_edits(self, path: Path) -> None:
        """Write the edit layer, as a whole or not at all.

        Args:
            path: of a .usda file; a file that the shot itself is made of is refused.

        Raises:
            SettingsError: it is not named .usda, or the shot is made of that file.
            OutputError: it cannot be written.
        """
        self._edits.save(path)

    def _focused(self, camera_path: str, time: float) -> Focused:
        return focus_camera(self.stage, self._anchors, camera_path, _checked_time(time))

    def _for_picture(self, focused: Focused, time: float, aspect: float | None) -> Camera:
        """The focused camera with its film gate conformed to a picture."""
        if aspect is None:
            return focused.camera
        picture = read_camera(self.stage, focused.camera.path, time, aspect=aspect)
        return replace(picture, focus_distance_m=focused.camera.focus_distance_m)

    def _path_or_none(self, camera_path: str | None) -> str | None:
        return camera_path if camera_path is not None else self.default_camera().path

    def _path(self, camera_path: str | None) -> str:
        path = self._path_or_none(camera_path)
        if path is None:
            raise CameraError(f"{self.path.name} has no camera", code="no_camera", path=str(self.path))
        return path

    def _lens_camera(self, camera_path: str | None) -> LensCamera:
        path = self._path(camera_path)
        read_camera(self.stage, path, self.frame_range.start)  # raises the room's own words for what is no camera
        prim = self.stage.GetPrimAtPath(path)
        if prim.IsInstanceProxy():
            raise CameraError(f"camera {path} lies in an instance, which USD lets nobody edit", path=path)
        return LensCamera(prim)

    def _point(self, camera_path: str | None, name: str) -> FocusPointView:
        lens_camera = self._lens_camera(camera_path)
        names = [view.name for view in lens_camera.focus_points()]
        if name not in names:
            path = str(lens_camera.prim.GetPath())
            raise NotFoundError(
                f"camera {path} has no focus point named {name!r}, it has: {', '.join(names) or 'none'}", path=path
            )
        return lens_camera.focus_point(name)


def _checked_time(time: float) -> float:
    if not math.isfinite(time):
        raise SettingsError(f"a time must be a finite USD time code, but it is {time}", code="bad_time")
    return time
