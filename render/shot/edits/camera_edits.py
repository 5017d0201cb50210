"""The edits of one opened shot that set a camera: its lens, how its focus is found, and the keys of both."""

from __future__ import annotations

from typing import Any

from render.errors import CameraError, SettingsError
from render.focus.files import ReadCurve
from render.shot.edits.camera_attributes import FOCUS_SETTINGS, CameraAttribute, author_settings
from render.shot.edits.edit_layer import schema_errors_as_settings
from render.shot.edits.undoing import EditableShot
from render.shot.focus.curve_layer import author_curve
from render.shot.focus.focus_mode import set_focus_mode
from render.shot.lens.lens_choice import LensChoice
from render.shot.view import checked_time
from usd_schemas import FocusData, Key, LensCamera, Mounted, TiltShiftData, mount_lens

LABELS = {
    "f_stop": "f-number",
    "focal_length_mm": "focal length",
    "focus_distance_m": "focus distance",
    "focus_mode": "focus mode",
}


class CameraEdits(EditableShot):
    """The part of `Shot` that edits cameras, their focus points aside."""

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
        said = [LABELS[name] for name, value in (numbers | {"focus_mode": focus_mode}).items() if value is not None]
        with self._edits.editing(f"set {' and '.join(said)} of {camera.prim.GetName()}"):
            author_settings(camera, {name: value for name, value in numbers.items() if value is not None}, time)
            if mode is not None:
                set_focus_mode(camera, mode)

    def mount_lens(self, camera_path: str | None, choice: LensChoice) -> Mounted:
        """Put another lens on a camera, for all time: its glass, its focal length, and no wider an f-number than it has.

        Args:
            camera_path: of a camera.
            choice: as `render.shot.lens.lens_choice` gives it.

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

    def import_focus_curve(self, camera_path: str | None, read: ReadCurve, *, baked: bool = False) -> None:
        """Give a camera the focus curve of a file, and let it be focused by hand.

        Args:
            camera_path: of a camera.
            read: as `render.shot.edits.curve_import.read_for_shot` reads it.
            baked: time samples in place of native splines.

        Raises:
            SettingsError: a value is beyond what the camera's attribute allows.
        """
        camera = self._editable(camera_path)
        with self._edits.editing("import a focus curve"):
            author_curve(camera, read.curve, read.said, baked=baked)

    def focus_settings(self, camera_path: str | None, time: float) -> tuple[FocusData, TiltShiftData]:
        """How a camera's focus is found, and how its lens is tilted.

        Args:
            camera_path: of a camera.
            time: USD time code.
        """
        camera = self._lens_camera(camera_path)
        with schema_errors_as_settings():
            return camera.focus.read(checked_time(time)), camera.tilt_shift.read(time)

    def set_focus(self, camera_path: str | None, *, time: float | None = None, **settings: Any) -> None:
        """Change how a camera's focus is found, or how its lens is tilted.

        Args:
            camera_path: of a camera.
            time: USD time code of the keys; None drops the keys there are and holds the values for all time. Modes and other
                words hold for all time either way.
            settings: by the names of the fields of `FocusData` and `TiltShiftData`.

        Raises:
            SettingsError: there is no such setting, a value is out of range, or the time is not finite.
        """
        camera = self._editable(camera_path)
        unknown = set(settings) - set(FOCUS_SETTINGS)
        if unknown:
            raise SettingsError(f"the focus has no {', '.join(sorted(unknown))} to set", code="bad_field")
        with self._edits.editing(f"set {', '.join(_words(name) for name in settings)} of {camera.prim.GetName()}"):
            author_settings(camera, settings, time)

    def camera_keys(self, camera_path: str | None, name: str) -> list[Key]:
        """Keys of one setting of a camera, in order of time.

        Args:
            camera_path: of a camera.
            name: such as ``focus_distance_m`` or ``expressive`` (`render.shot.edits.camera_attributes`).

        Raises:
            SettingsError: there is no such setting.
        """
        return CameraAttribute(self._lens_camera(camera_path), name).keys()

    def set_camera_key(self, camera_path: str | None, name: str, key: Key) -> None:
        """Set, or replace, a key of one setting of a camera. One of the focus distance makes the focus mode manual.

        Args:
            camera_path: of a camera.
            name: such as ``focus_distance_m`` or ``expressive`` (`render.shot.edits.camera_attributes`).
            key: in this package's units.

        Raises:
            SettingsError: there is no such setting, or it takes no such key.
        """
        camera = self._editable(camera_path)
        attribute = CameraAttribute(camera, name)
        checked_time(key.time)
        with self._edits.editing(f"key {_words(name)} of {camera.prim.GetName()} at {key.time:g}"):
            attribute.set_key(key)
            if name == "focus_distance_m":
                set_focus_mode(camera, "manual")

    def remove_camera_key(self, camera_path: str | None, name: str, time: float) -> None:
        """Remove a key of one setting of a camera; after the last one its value stays for all time.

        Args:
            camera_path: of a camera.
            name: of the setting.
            time: USD time code.

        Raises:
            NotFoundError: it has no key at that time.
            SettingsError: there is no such setting.
        """
        camera = self._editable(camera_path)
        attribute = CameraAttribute(camera, name)
        with self._edits.editing(f"remove the key of {_words(name)} of {camera.prim.GetName()} at {time:g}"):
            attribute.remove_key(time)

    def _editable(self, camera_path: str | None) -> LensCamera:
        camera = self._lens_camera(camera_path)
        if camera.prim.IsInstanceProxy():
            path = str(camera.prim.GetPath())
            raise CameraError(f"camera {path} lies in an instance, which USD lets nobody edit", path=path)
        return camera


def _words(name: str) -> str:
    return LABELS.get(name, name.replace("_", " "))
