"""One opened shot: what the command line and the service both work on, so that both give the same pixels."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from render.errors import CameraError, NotFoundError, SettingsError
from render.shot.anchor import Picked, anchored
from render.shot.lens import author_lens, set_focus_mode
from render.shot.lens_choice import LensChoice
from render.shot.undoing import EditableShot
from render.shot.view import checked_time
from usd_schemas import FocusPoint, FocusPointView, Interpolation, LensCamera, Mounted, mount_lens

FIELD_LABELS = {
    "f_stop": "f-number",
    "focal_length_mm": "focal length",
    "focus_distance_m": "focus distance",
    "focus_mode": "focus mode",
}


class Shot(EditableShot):
    """A USD stage, its cameras and focus, and the layer of edits over it.

    Each edit goes to the edit layer (`render.shot.edits`); no file of the user's is ever written. An edit that fails
    leaves everything as it was.

    A shot is for one thread at a time: USD stages may not be written while they are read, so callers with several
    threads (the service) hold a lock around each call.

    Where a camera path is asked for, None stands for the shot's default camera, and `CameraError` is raised where there
    is no such camera or its numbers are impossible. A time is a USD time code; one that is not finite raises
    `SettingsError`.
    """

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
        lens_camera = self._editable(camera_path)
        point = anchor if isinstance(anchor, FocusPoint) else anchored(name, anchor)
        if any(view.name == name for view in lens_camera.focus_points()):
            path = str(lens_camera.prim.GetPath())
            raise SettingsError(f"camera {path} already has a focus point named {name!r}", code="name_taken", path=path)
        with self._edits.editing(f"add focus point {name}"):
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
        view = self._editable_point(camera_path, name)
        unknown = set(changes) - (set(FocusPoint.__dataclass_fields__) - {"name"})
        if unknown:
            raise SettingsError(f"focus points have no {', '.join(sorted(unknown))} to change", code="bad_field")
        keyed = {field for field in changes if time is not None and field != "target" and view.keys(field)}
        with self._edits.editing(f"set {', '.join(changes)} of focus point {name}"):
            if keyed:
                view.author(replace(view.read(time), **{field: changes[field] for field in keyed}), time)
            view.author(replace(view.read(), **{field: v for field, v in changes.items() if field not in keyed}))
        return view.read(time)

    def remove_focus_point(self, camera_path: str | None, name: str) -> None:
        """Remove a focus point.

        Raises:
            NotFoundError: the camera has no such point.
        """
        self._editable_point(camera_path, name)
        with self._edits.editing(f"remove focus point {name}"):
            self._editable(camera_path).remove_focus_point(name)

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
        view = self._editable_point(camera_path, name)
        with self._edits.editing(f"key {attribute} of focus point {name} at {time:g}"):
            view.set_key(attribute, checked_time(time), value, interpolation or "linear")

    def remove_key(self, camera_path: str | None, name: str, attribute: str, time: float) -> None:
        """Remove a key; after the last one its value stays for all time.

        Raises:
            NotFoundError: the camera has no such point, or the attribute no key at that time.
            SettingsError: a focus point has no such attribute.
        """
        view = self._editable_point(camera_path, name)
        times = [key.time for key in self.keys(camera_path, name, attribute)]
        if time not in times:
            told = ", ".join(f"{t:g}" for t in times) or "none"
            raise NotFoundError(
                f"{attribute} of focus point {name!r} has no key at time {time:g}, its keys are: {told}"
            )
        with self._edits.editing(f"remove the key of {attribute} of focus point {name} at {time:g}"):
            view.remove_key(attribute, time)

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
        camera = self._editable(camera_path)
        mode = focus_mode or ("manual" if focus_distance_m is not None else None)
        numbers = {"f_stop": f_stop, "focal_length_mm": focal_length_mm, "focus_distance_m": focus_distance_m}
        said = [
            FIELD_LABELS[name] for name, value in (numbers | {"focus_mode": focus_mode}).items() if value is not None
        ]
        with self._edits.editing(f"set {' and '.join(said)} of {camera.prim.GetName()}"):
            author_lens(camera, time, **numbers)
            if mode is not None:
                set_focus_mode(camera, mode)

    def mount_lens(self, camera_path: str | None, choice: LensChoice) -> Mounted:
        """Put another lens on a camera, for all time: its glass, its focal length, and no wider an f-number than it has.

        Args:
            camera_path: of a camera.
            choice: as `render.shot.lens_choice` gives it.

        Returns:
            What changed of the camera's own numbers.

        Raises:
            SettingsError: the lens has a value that USD does not allow.
        """
        camera = self._editable(camera_path)
        with self._edits.editing(f"mount a lens on {camera.prim.GetName()}"):
            return mount_lens(
                camera,
                choice.lens,
                focal_length_mm=choice.focal_length_mm,
                f_stop=choice.f_stop,
                aperture=choice.aperture,
            )

    def _editable(self, camera_path: str | None) -> LensCamera:
        camera = self._lens_camera(camera_path)
        if camera.prim.IsInstanceProxy():
            path = str(camera.prim.GetPath())
            raise CameraError(f"camera {path} lies in an instance, which USD lets nobody edit", path=path)
        return camera

    def _editable_point(self, camera_path: str | None, name: str) -> FocusPointView:
        self._editable(camera_path)
        return self._point(camera_path, name)
