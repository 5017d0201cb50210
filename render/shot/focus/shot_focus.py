"""The focus part of a shot: focus points and their keys, racks, focus settings, readouts and focus curves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from pxr import Sdf, Usd

from render.errors import NotFoundError, SettingsError
from render.focus import FocusCurve
from render.focus.racks import Rack
from render.shot.camera.attributes import author_settings, set_focus_mode, setting_label
from render.shot.camera.lookup import CameraLookup
from render.shot.edits.edit_layer import Edits, schema_errors_as_settings
from render.shot.focus.anchor import SurfacePoint, check_has_face, make_point
from render.shot.focus.curve import focus_layer, solve_curve
from render.shot.focus.curve_layer import author_curve
from render.shot.focus.part_place import place_in_part
from render.shot.focus.place_readout import PlaceReadout, read_place, read_point
from render.shot.focus.rack import pull_rack
from render.shot.focus.readout import PlacedPoint, Readout, make_readout, place_points
from render.shot.focus.solver import FocusSolver
from render.shot.times import check_reading_time, check_time
from render.stage import AnchorReader
from usd_schemas import FocusData, FocusPoint, FocusPointView, Interpolation, Key, Tangents, TiltShiftData
from usd_schemas.curves import EXACT
from usd_schemas.racks import WeightRack
from usd_schemas.settings.tables import FOCUS_SETTINGS
from usd_schemas.topology import topology_under

if TYPE_CHECKING:  # pictures do without readers of curves
    from render.focus.files import ReadCurve

FOCUS_POINTS = "focusPoint:"
"""Prefix of the names of all properties of focus points."""


class ShotFocus:
    """Focus of the cameras of one shot.

    Args:
        stage: the shot.
        edits: where edits go.
        cameras: finds cameras by path.
        anchors: finds the positions of focus points on the stage.
        solver: solves the focus.
    """

    def __init__(
        self, stage: Usd.Stage, edits: Edits, cameras: CameraLookup, anchors: AnchorReader, solver: FocusSolver
    ) -> None:
        self._stage = stage
        self._edits = edits
        self._cameras = cameras
        self._anchors = anchors
        self._solver = solver

    def read(self, camera_path: str | None, time: float) -> Readout:
        """Read focus, f-number, focal length and depth of field.

        Args:
            camera_path: of a camera.
            time: USD time code.
        """
        return make_readout(self._solver.solve(camera_path, time))

    def read_at(
        self,
        camera_path: str | None,
        time: float,
        screen: tuple[float, float],
        depth_m: float,
        *,
        aspect: float | None = None,
    ) -> PlaceReadout:
        """Read the depth of field at a position of the picture, and the circle of confusion of an object there.

        Args:
            camera_path: of a camera.
            time: USD time code.
            screen: the position: (0, 0) is the top left corner of the picture and (1, 1) the bottom right one.
            depth_m: depth of the object along the view axis; may be infinite.
            aspect: width over height of the picture; None takes the camera's own film gate.

        Raises:
            SettingsError: the position is not a number, or the depth is not in front of the camera.
        """
        focused = self._solver.solve(camera_path, time)
        return read_place(focused, self._solver.fit_to_picture(focused, time, aspect), screen, depth_m)

    def read_at_point(
        self, camera_path: str | None, time: float, name: str, *, aspect: float | None = None
    ) -> PlaceReadout:
        """Read the depth of field at a focus point, and its circle of confusion.

        Args:
            camera_path: of a camera.
            time: USD time code.
            name: of the point.
            aspect: width over height of the picture; None takes the camera's own film gate.

        Raises:
            NotFoundError: the camera has no such point.
            InputError: the point has no position, or one behind the camera.
        """
        focused = self._solver.solve(camera_path, time)
        return read_point(focused, self._solver.fit_to_picture(focused, time, aspect), name)

    def points(self, camera_path: str | None, time: float, *, aspect: float | None = None) -> list[PlacedPoint]:
        """List a camera's focus points with their positions in its picture.

        Args:
            camera_path: of a camera.
            time: USD time code.
            aspect: width over height of the picture; None takes the camera's own film gate.
        """
        focused = self._solver.solve(camera_path, time)
        return place_points(focused, self._solver.fit_to_picture(focused, time, aspect))

    def add_point(self, camera_path: str | None, name: str, anchor: SurfacePoint | FocusPoint) -> FocusPoint:
        """Add a focus point. A camera in manual mode is switched to focus by its points.

        The topology of the target mesh is recorded with the point (`usd_schemas.topology`), so that a re-export with other faces
        can be detected.

        Args:
            camera_path: of a camera.
            name: an identifier (letters, digits and ``_``, no digit first) that no other focus point of the camera has.
            anchor: the point of a surface that was clicked on, or a whole focus point (its own name is ignored).

        Returns:
            The point as it was authored.

        Raises:
            SettingsError: the name is not legal or taken, or a value is not allowed, or it is on a back plate.
        """
        camera = self._cameras.editable(camera_path)
        point = anchor if isinstance(anchor, FocusPoint) else make_point(name, anchor)
        check_has_face(self._stage, point)
        if any(view.name == name for view in camera.focus_points()):
            path = str(camera.prim.GetPath())
            raise SettingsError(f"camera {path} already has a focus point named {name!r}", code="name_taken", path=path)
        with self._edits.transaction(f"add focus point {name}"):
            view = camera.add_focus_point(name, replace(point, name=name))
            if not point.topology:
                _record_topology(view, None)
            if camera.focus.read().mode == "manual":
                set_focus_mode(camera, "points")
        return view.read()

    def update_point(
        self, camera_path: str | None, name: str, *, time: float | None = None, **changes: Any
    ) -> FocusPoint:
        """Change some fields of a focus point.

        A field that has keys gets one at the time; a field that has none is changed for all time. Where the target or its face
        changes and no topology is given, the topology of the new target is recorded.

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
        view = self._cameras.editable_point(camera_path, name)
        unknown = set(changes) - (set(FocusPoint.__dataclass_fields__) - {"name"})
        if unknown:
            raise SettingsError(f"focus points have no {', '.join(sorted(unknown))} to change", code="bad_field")
        keyed = {
            field for field in changes if time is not None and field not in ("target", "part") and view.keys(field)
        }
        with self._edits.transaction(f"set {', '.join(changes)} of focus point {name}"):
            if keyed:
                view.author(replace(view.read(time), **{field: changes[field] for field in keyed}), time)
            view.author(replace(view.read(), **{field: v for field, v in changes.items() if field not in keyed}))
            if changes.keys() & {"target", "face", "fan_triangle"} and "topology" not in changes:
                _record_topology(view, time)
        return view.read(time)

    def follow_part(self, camera_path: str | None, name: str, part: str | None, time: float) -> FocusPoint:
        """Let a focus point follow the bounds of a part, from where it is at a time, or its target's surface again.

        Args:
            camera_path: of a camera.
            name: of the focus point.
            part: path of a prim whose bounds are followed, usually one above the target, such as a whole character. None goes
                back to the place on the target.
            time: USD time code at which the point stays where it is.

        Returns:
            The point as it is afterwards, at the time.

        Raises:
            NotFoundError: the camera has no such point; or the point has no place at the time, or the part is not there or has no
                bounds then.
            SettingsError: the part's path is no absolute prim path, or the point is out of reach of the part's bounds.
        """
        time = check_time(time)
        fields: dict[str, Any] = {"part": part or ""}
        with self._edits.transaction(f"let focus point {name} follow {part or 'its surface'}"):
            if part:
                point = self._cameras.editable_point(camera_path, name).read(time)
                fields["bounds_point"] = place_in_part(self._anchors, point, part, time)
            return self.update_point(camera_path, name, time=time, **fields)

    def move_point(self, camera_path: str | None, name: str, time: float, **anchor: Any) -> FocusPoint:
        """Move a focus point to another place on a surface.

        A point that follows the bounds of a part goes on to follow them where the new target is at or below the part; elsewhere
        it follows the new surface.

        Args:
            camera_path: of a camera.
            name: of the focus point.
            time: USD time code of the move.
            anchor: target, face, triangle, barycentric coordinates and instance, by the names of `FocusPoint`'s fields.

        Returns:
            The point as it is afterwards, at the time.

        Raises:
            NotFoundError: the camera has no such point, or the part that is followed has no bounds at the time.
            SettingsError: a value is not allowed.
        """
        part = self._cameras.editable_point(camera_path, name).read().part
        if not part:
            return self.update_point(camera_path, name, time=time, **anchor)
        with self._edits.transaction(f"move focus point {name}"):
            moved = self.update_point(camera_path, name, time=time, part="", **anchor)
            stays = any(Sdf.Path(path).HasPrefix(Sdf.Path(part)) for path in moved.target)
            return self.follow_part(camera_path, name, part, time) if stays else moved

    def rename_point(self, camera_path: str | None, name: str, new_name: str) -> None:
        """Rename a focus point, which keeps its values and keys.

        Args:
            camera_path: of a camera.
            name: of the focus point.
            new_name: an identifier (letters, digits and ``_``, no digit first) that no other focus point of the camera has.

        Raises:
            NotFoundError: the camera has no such point.
            SettingsError: the new name is not legal or taken.
        """
        self._cameras.editable_point(camera_path, name)
        camera = self._cameras.editable(camera_path)
        if any(view.name == new_name for view in camera.focus_points()):
            path = str(camera.prim.GetPath())
            raise SettingsError(
                f"camera {path} already has a focus point named {new_name!r}", code="name_taken", path=path
            )
        with self._edits.transaction(f"rename focus point {name}"):
            camera.rename_focus_point(name, new_name)

    def remove_point(self, camera_path: str | None, name: str) -> None:
        """Remove a focus point.

        Raises:
            NotFoundError: the camera has no such point.
        """
        self._cameras.editable_point(camera_path, name)
        with self._edits.transaction(f"remove focus point {name}"):
            self._cameras.editable(camera_path).remove_focus_point(name)

    def keys(self, camera_path: str | None, name: str, attribute: str) -> list[Key]:
        """List the keys of one attribute of a focus point, such as ``weight`` or ``enabled``, in order of time.

        Raises:
            NotFoundError: the camera has no such point.
            SettingsError: a focus point has no such attribute.
        """
        with schema_errors_as_settings():
            return self._cameras.point(camera_path, name).keys(attribute)

    def set_key(
        self,
        camera_path: str | None,
        name: str,
        attribute: str,
        time: float,
        value: Any,
        interpolation: Interpolation | None = None,
        tangents: Tangents | None = None,
    ) -> None:
        """Set, or replace, a key of one attribute of a focus point.

        Args:
            camera_path: of a camera.
            name: of the focus point.
            attribute: such as ``weight`` or ``enabled``; target, kind and topology take no keys.
            time: USD time code.
            value: in the attribute's own unit.
            interpolation: how the value goes on to the next key: linear, held, bezier or auto; None is linear,
                or held where values cannot be interpolated.
            tangents: of a bezier key; None gives it the tangents of an auto key.

        Raises:
            NotFoundError: the camera has no such point.
            SettingsError: the attribute takes no such key, value or interpolation, or the time is not finite.
        """
        view = self._cameras.editable_point(camera_path, name)
        with self._edits.transaction(f"key {attribute} of focus point {name} at {time:g}"):
            view.set_key(attribute, check_time(time), value, interpolation or "linear", tangents)

    def remove_key(self, camera_path: str | None, name: str, attribute: str, time: float) -> None:
        """Remove a key; after the last one its value stays for all time.

        Raises:
            NotFoundError: the camera has no such point, or the attribute no key at that time.
            SettingsError: a focus point has no such attribute.
        """
        view = self._cameras.editable_point(camera_path, name)
        times = [key.time for key in self.keys(camera_path, name, attribute)]
        if time not in times:
            known = ", ".join(f"{t:g}" for t in times) or "none"
            raise NotFoundError(
                f"{attribute} of focus point {name!r} has no key at time {time:g}, its keys are: {known}"
            )
        with self._edits.transaction(f"remove the key of {attribute} of focus point {name} at {time:g}"):
            view.remove_key(attribute, time)

    def rack(self, camera_path: str | None, rack: WeightRack) -> tuple[WeightRack, Rack]:
        """Rack the focus from one focus point to another, by keys of their weights.

        Args:
            camera_path: of a camera.
            rack: from which to which, when, and how.

        Returns:
            The rack as authored, which ends later where the ring cannot be turned that fast, and the resulting focus distances.

        Raises:
            NotFoundError: the camera has no such point.
            SettingsError: the rack makes no sense, or contradicts keys that are there.
            InputError: the target of a point is missing.
        """
        for name in (rack.from_point, rack.to_point):
            self._cameras.editable_point(camera_path, name)
        with self._edits.transaction(f"rack from {rack.from_point} to {rack.to_point}"):
            return pull_rack(self._stage, self._anchors, self._cameras.path(camera_path), rack)

    def settings(self, camera_path: str | None, time: float) -> tuple[FocusData, TiltShiftData]:
        """Read the focus settings of a camera, and tilt and shift of its lens.

        Args:
            camera_path: of a camera.
            time: USD time code.
        """
        camera = self._cameras.camera(camera_path)
        with schema_errors_as_settings():
            return camera.focus.read(check_reading_time(time)), camera.tilt_shift.read(time)

    def set(self, camera_path: str | None, *, time: float | None = None, **settings: Any) -> None:
        """Change focus settings of a camera, or the tilt and shift of its lens.

        Args:
            camera_path: of a camera.
            time: USD time code of the keys; None drops the keys there are and holds the values for all time. Settings that are
                words, such as modes, always hold for all time.
            settings: by the names of the fields of `FocusData` and `TiltShiftData`.

        Raises:
            SettingsError: there is no such setting, a value is out of range, or the time is not finite.
        """
        camera = self._cameras.editable(camera_path)
        unknown = set(settings) - set(FOCUS_SETTINGS)
        if unknown:
            raise SettingsError(f"the focus has no {', '.join(sorted(unknown))} to set", code="bad_field")
        labels = ", ".join(map(setting_label, settings))
        with self._edits.transaction(f"set {labels} of {camera.prim.GetName()}"):
            author_settings(camera, settings, time)

    def curve(self, camera_path: str | None, frames: Sequence[float], *, distortion: bool = False) -> FocusCurve:
        """Solve the focus curve: focus, f-number and tilt at each frame.

        Args:
            camera_path: of a camera.
            frames: rising USD time codes.
            distortion: whether the lens's distortion is wanted at each frame, as in OpenTrackIO files.

        Raises:
            SettingsError: there are no frames, too many, or they do not rise.
        """
        path = self._cameras.path(camera_path)
        return solve_curve(
            self._stage, path, frames, lambda times: self._solver.solve_over(path, times), distortion=distortion
        )

    def layer(
        self, camera_path: str | None, frames: Sequence[float], baked: bool = False, tolerance: float = EXACT
    ) -> str:
        """Write the focus curve as a USD layer for other tools (usda text), to be sublayered over the shot.

        Args:
            camera_path: of a camera.
            frames: rising USD time codes.
            baked: write time samples, for tools that read no splines, in place of native splines.
            tolerance: how far a spline may be off, relative to the value; more makes fewer knots.

        Raises:
            SettingsError: there are no frames, too many, or they do not rise; or the tolerance is not a share.
        """
        return focus_layer(self._stage, self.curve(camera_path, frames), baked=baked, tolerance=tolerance)

    def import_curve(self, camera_path: str | None, read: ReadCurve, *, baked: bool = False) -> None:
        """Author an imported focus curve on a camera, and switch the camera to manual focus.

        Args:
            camera_path: of a camera.
            read: result of `render.shot.focus.curve_import.read_for_shot`.
            baked: write time samples in place of native splines.

        Raises:
            SettingsError: a value is beyond what the camera's attribute allows.
        """
        camera = self._cameras.editable(camera_path)
        with self._edits.transaction("import a focus curve"):
            author_curve(camera, read.curve, read.given, baked=baked)

    def edited_properties(self, camera_path: str | None, name: str | None = None) -> tuple[str, ...]:
        """List the edited properties of focus points as usda text, for entity tags: the strings differ after an edit.

        Args:
            camera_path: of a camera.
            name: of a focus point; None for all points, with the list of their names.

        Raises:
            CameraError: there is no such camera.
            NotFoundError: it has no such point.
        """
        camera = self._cameras.camera(camera_path)
        path = camera.prim.GetPath()
        if name is None:
            names = [view.name for view in camera.focus_points()]
            return (
                str(path),
                *names,
                *self._edits.properties(path, lambda property_name: property_name.startswith(FOCUS_POINTS)),
            )
        prefix = f"{FOCUS_POINTS}{self._cameras.point(camera_path, name).name}:"
        return (str(path), name, *self._edits.properties(path, lambda property_name: property_name.startswith(prefix)))


def _record_topology(view: FocusPointView, time: float | None) -> None:
    """Record in a focus point the topology of the mesh under it at a time."""
    view.author(replace(view.read(), topology=topology_under(view.prim.GetStage(), view.read(time))))
