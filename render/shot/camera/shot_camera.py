"""The camera part of a shot: attributes and keys of cameras, and the lens and body that they have."""

from __future__ import annotations

from collections.abc import Mapping

from pxr import Usd, UsdGeom

from render.errors import CameraError, NotFoundError, SettingsError
from render.shot.camera.attributes import CameraAttribute, Simplified, author_settings, set_focus_mode, setting_label
from render.shot.camera.creation import create_camera, free_path
from render.shot.camera.duplicates import copy_camera, copy_path
from render.shot.camera.lookup import CameraLookup
from render.shot.camera.place_keys import edited_keys, is_placing, move_place_keys, place_keys, remove_place_key
from render.shot.camera.placing import CameraPlace, place_camera
from render.shot.camera.sharing import give_settings, lacks_settings
from render.shot.edits.edit_layer import Edits
from render.shot.lens.lens_choice import LensChoice
from render.shot.times import check_reading_time, check_time
from usd_schemas import Key, LibraryBody, Mounted, mount_body, mount_lens


class ShotCamera:
    """Cameras of one shot, their focus points aside.

    Args:
        stage: the shot.
        edits: where edits go.
        cameras: finds cameras by path.
    """

    def __init__(self, stage: Usd.Stage, edits: Edits, cameras: CameraLookup) -> None:
        self._stage = stage
        self._edits = edits
        self._cameras = cameras

    def create(self, name: str | None = None, time: float | None = None) -> str:
        """Create a camera from the view of the framing camera, which shows a shot that has none to be shown through.

        It is a plain ``def Camera`` at the root of the stage, with a Super 35 body and a thin lens
        (`render.shot.camera.creation`).

        Args:
            name: of the prim; None for ``main_cam``, or a free name like it.
            time: USD time code of the view; None for the shot's first.

        Returns:
            Its prim path.

        Raises:
            CameraError: the shot has a camera to be shown through.
            StageError: there is nothing to frame.
            SettingsError: the name is taken or no identifier, or the time is infinite.
        """
        view = self._cameras.framing(None if time is None else check_reading_time(time))
        path = free_path(self._stage, name)
        with self._edits.transaction(f"create camera {path.name}"):
            return str(create_camera(self._stage, path, view).prim.GetPath())

    def duplicate(self, camera_path: str | None, name: str | None = None) -> str:
        """Copy a camera beside itself, with its lens, body, focus points, film and keys; not with what lies below it.

        Args:
            camera_path: of a camera.
            name: of the copy; None for the camera's own, with the next free number behind it.

        Returns:
            Prim path of the copy.

        Raises:
            CameraError: there is no such camera, or it lies in an instance.
            SettingsError: the name is taken or no identifier.
        """
        prim = self._cameras.editable(camera_path).prim
        path = copy_path(self._stage, prim.GetPath(), name)
        with self._edits.transaction(f"duplicate camera {prim.GetName()}"):
            return str(copy_camera(prim, path).GetPath())

    def move(self, camera_path: str | None, place: CameraPlace, time: float, *, is_keyed: bool = False) -> None:
        """Place a camera in the world at a time (`render.shot.camera.placing`).

        Args:
            camera_path: of a camera.
            place: where to.
            time: USD time code at which it is there.
            is_keyed: whether it gets a key there; else all of its way is moved along.

        Raises:
            CameraError: there is no such camera, it lies in an instance, or cannot be placed.
            SettingsError: the place cannot be, or the time is not finite.
            StageError: a transform is not finite.
        """
        camera = self._cameras.editable(camera_path)
        name = camera.prim.GetName()
        with self._edits.transaction(f"key the place of {name} at {time:g}" if is_keyed else f"move {name}"):
            place_camera(UsdGeom.Camera(camera.prim), place, time, is_keyed=is_keyed)

    def place_keys(self, camera_path: str | None) -> list[float]:
        """USD time codes of the keys of a camera's place, rising (`render.shot.camera.place_keys`).

        Args:
            camera_path: of a camera.
        """
        return place_keys(UsdGeom.Camera(self._cameras.camera(camera_path).prim))

    def edited_place_keys(self, camera_path: str | None) -> set[float]:
        """USD time codes of the keys of a camera's place that are of the edits.

        Args:
            camera_path: of a camera.
        """
        return edited_keys(UsdGeom.Camera(self._cameras.camera(camera_path).prim), self._edits.layer)

    def is_placed(self, camera_path: str | None) -> bool:
        """Whether the edits have any part in where a camera is.

        Args:
            camera_path: of a camera.
        """
        return bool(self._edits.properties(self._cameras.camera(camera_path).prim.GetPath(), is_placing))

    def has_own_place(self, camera_path: str | None) -> bool:
        """Whether the shot itself has the camera, so that it has a place without the edits.

        Args:
            camera_path: of a camera.
        """
        return any(spec.layer != self._edits.layer for spec in self._cameras.camera(camera_path).prim.GetPrimStack())

    def remove_place_key(self, camera_path: str | None, time: float) -> None:
        """Remove a key of a camera's place; after the last one its value stays for all time.

        Args:
            camera_path: of a camera.
            time: USD time code.

        Raises:
            CameraError: there is no such camera, it lies in an instance, or has too many samples.
            NotFoundError: it has no key at that time.
        """
        prim = self._cameras.editable(camera_path).prim
        with self._edits.transaction(f"remove the key of the place of {prim.GetName()} at {time:g}"):
            remove_place_key(UsdGeom.Camera(prim), time)

    def move_place_keys(self, camera_path: str | None, moves: Mapping[float, float]) -> None:
        """Move keys of a camera's place in time, all at once.

        Args:
            camera_path: of a camera.
            moves: new time by time, USD time codes.

        Raises:
            CameraError: there is no such camera, it lies in an instance, or has too many samples.
            NotFoundError: it has no key at one of the times.
            SettingsError: two keys would come to one time.
        """
        prim = self._cameras.editable(camera_path).prim
        with self._edits.transaction(f"move keys of the place of {prim.GetName()}"):
            move_place_keys(UsdGeom.Camera(prim), moves)

    def give_back_place(self, camera_path: str | None) -> None:
        """Take a camera back to where the shot itself has it over all of its time.

        Args:
            camera_path: of a camera.

        Raises:
            CameraError: there is no such camera, it lies in an instance, or the edits alone have it.
            NotFoundError: the edits do not place it.
        """
        prim = self._cameras.editable(camera_path).prim
        path = str(prim.GetPath())
        if not self.has_own_place(camera_path):
            raise CameraError(
                f"camera {path} is of the edits: the shot has no place for it", code="no_place", path=path
            )
        if not self.is_placed(camera_path):
            raise NotFoundError(f"camera {path} is where the shot has it: no edit places it", path=path)
        with self._edits.transaction(f"take {prim.GetName()} back to its own place"):
            self._edits.clear_properties(prim.GetPath(), is_placing)

    def set(
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
        camera = self._cameras.editable(camera_path)
        mode = focus_mode or ("manual" if focus_distance_m is not None else None)
        numbers = {"f_stop": f_stop, "focal_length_mm": focal_length_mm, "focus_distance_m": focus_distance_m}
        given = {name: value for name, value in (numbers | {"focus_mode": focus_mode}).items() if value is not None}
        with self._edits.transaction(f"set {' and '.join(map(setting_label, given))} of {camera.prim.GetName()}"):
            author_settings(camera, {name: value for name, value in numbers.items() if value is not None}, time)
            if mode is not None:
                set_focus_mode(camera, mode)

    def keys(self, camera_path: str | None, name: str) -> list[Key]:
        """Keys of one setting of a camera, in order of time.

        Args:
            camera_path: of a camera.
            name: such as ``focus_distance_m`` or ``expressive`` (`render.shot.camera.attributes`).

        Raises:
            SettingsError: there is no such setting.
        """
        return CameraAttribute(self._cameras.camera(camera_path), name).keys()

    def set_key(self, camera_path: str | None, name: str, key: Key) -> None:
        """Set, or replace, a key of one setting of a camera. One of the focus distance makes the focus mode manual.

        Args:
            camera_path: of a camera.
            name: such as ``focus_distance_m`` or ``expressive`` (`render.shot.camera.attributes`).
            key: in this package's units.

        Raises:
            SettingsError: there is no such setting, or it takes no such key.
        """
        camera = self._cameras.editable(camera_path)
        attribute = CameraAttribute(camera, name)
        check_time(key.time)
        with self._edits.transaction(f"key {setting_label(name)} of {camera.prim.GetName()} at {key.time:g}"):
            attribute.set_key(key)
            if name == "focus_distance_m":
                set_focus_mode(camera, "manual")

    def remove_key(self, camera_path: str | None, name: str, time: float) -> None:
        """Remove a key of one setting of a camera; after the last one its value stays for all time.

        Args:
            camera_path: of a camera.
            name: of the setting.
            time: USD time code.

        Raises:
            NotFoundError: it has no key at that time.
            SettingsError: there is no such setting.
        """
        camera = self._cameras.editable(camera_path)
        attribute = CameraAttribute(camera, name)
        with self._edits.transaction(f"remove the key of {setting_label(name)} of {camera.prim.GetName()} at {time:g}"):
            attribute.remove_key(time)

    def simplify(self, camera_path: str | None, name: str, tolerance: float) -> Simplified:
        """Replace the keys of one setting of a camera by few that make nearly the same curve.

        Args:
            camera_path: of a camera.
            name: of the setting.
            tolerance: how far the curve may be off, as a share; see `CameraAttribute.simplify`.

        Raises:
            SettingsError: there is no such setting, or its keys make no curve.
        """
        camera = self._cameras.editable(camera_path)
        attribute = CameraAttribute(camera, name)
        with self._edits.transaction(f"simplify the {setting_label(name)} of {camera.prim.GetName()}"):
            return attribute.simplify(tolerance)

    def share_settings(self, one_path: str, other_path: str) -> tuple[str, ...]:
        """Give each of two cameras of a stereo rig the settings of lens, focus and film that the other alone has authored.

        Args:
            one_path: of a camera.
            other_path: of another.

        Returns:
            Paths of cameras that lack settings of the other and keep their own values, since they lie in an instance.
        """
        prims = [self._cameras.camera(path).prim for path in (one_path, other_path)]
        lacking = [(giver, taker) for giver, taker in (prims, prims[::-1]) if lacks_settings(giver, taker)]
        with self._edits.transaction("share the settings of two cameras"):
            for giver, taker in lacking:
                if not taker.IsInstanceProxy():
                    give_settings(giver, taker)
        return tuple(str(taker.GetPath()) for _, taker in lacking if taker.IsInstanceProxy())

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
        camera = self._cameras.editable(camera_path)
        with self._edits.transaction(f"mount a lens on {camera.prim.GetName()}"):
            return mount_lens(
                camera,
                choice.lens,
                focal_length_mm=choice.focal_length_mm,
                f_stop=choice.f_stop,
                aperture=choice.aperture,
            )

    def mount_body(self, camera_path: str | None, body: LibraryBody) -> None:
        """Give a camera another body, for all time: its gate, its photosites and its name.

        Args:
            camera_path: of a camera.
            body: of the library, or without a name a part of the camera's own gate.

        Raises:
            SettingsError: the camera is orthographic, and the body is another one.
        """
        camera = self._cameras.editable(camera_path)
        projection = UsdGeom.Camera(camera.prim).GetProjectionAttr().Get(Usd.TimeCode.EarliestTime())
        if body.name and projection == UsdGeom.Tokens.orthographic:
            raise SettingsError(
                f"{camera.prim.GetPath()} is orthographic: its film is as large as what it sees, so that no body fits it",
                code="orthographic",
            )
        with self._edits.transaction(f"put the {body.title} on {camera.prim.GetName()}"):
            mount_body(camera, body)

    def edited_properties(self, camera_path: str | None) -> tuple[str, ...]:
        """Edited properties of a camera, its focus points aside, as usda text: the same strings until an edit changes them.

        Args:
            camera_path: of a camera.

        Raises:
            CameraError: there is no such camera.
        """
        path = self._cameras.camera(camera_path).prim.GetPath()
        return (str(path), *self._edits.properties(path, lambda name: not name.startswith("focusPoint:")))
