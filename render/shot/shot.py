"""One opened shot: what the command line and the service both work on, so that both give the same pixels."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from render.errors import NotFoundError, SettingsError
from render.focus.racks import Rack
from render.shot.edits.photography_edits import PhotographyEdits
from render.shot.focus.anchor import Picked, anchored
from render.shot.focus.focus_mode import set_focus_mode
from render.shot.focus.rack import pull_rack
from render.shot.view import checked_time
from usd_schemas import FocusPoint, FocusPointView, Interpolation, Tangents
from usd_schemas.racks import WeightRack
from usd_schemas.topology import topology_under


class Shot(PhotographyEdits):
    """A USD stage, its cameras and focus, and the layer of edits over it.

    Each edit goes to the edit layer (`render.shot.edits.edit_layer`); no file of the user's is ever written. An edit that fails
    leaves everything as it was.

    A shot is for one thread at a time: USD stages may not be written while they are read, so callers with several
    threads (the service) hold a lock around each call.

    Where a camera path is asked for, None stands for the shot's default camera, and `CameraError` is raised where there
    is no such camera or its numbers are impossible. A time is a USD time code; one that is not finite raises
    `SettingsError`.
    """

    def add_focus_point(self, camera_path: str | None, name: str, anchor: Picked | FocusPoint) -> FocusPoint:
        """Add a focus point, and let the points decide the focus where it was set by hand.

        What it is anchored to is noted with it (`usd_schemas.topology`), so that a re-export with other faces can be told.

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
            if not point.topology:
                _note_topology(view, None)
            if lens_camera.focus.read().mode == "manual":
                set_focus_mode(lens_camera, "points")
        return view.read()

    def update_focus_point(
        self, camera_path: str | None, name: str, *, time: float | None = None, **changes: Any
    ) -> FocusPoint:
        """Change some fields of a focus point.

        A field that has keys gets one at the time; a field that has none is changed for all time. Where the target or its face
        changes and no topology is given, what it is anchored to is noted anew.

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
            if changes.keys() & {"target", "face", "fan_triangle"} and "topology" not in changes:
                _note_topology(view, time)
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
        tangents: Tangents | None = None,
    ) -> None:
        """Set, or replace, a key of one attribute of a focus point.

        Args:
            camera_path: of a camera.
            name: of the focus point.
            attribute: such as ``weight`` or ``enabled``; target, kind and topology take no keys.
            time: USD time code.
            value: in the attribute's own unit.
            interpolation: how the value goes on to the next key: linear, held, bezier or auto; None suits the attribute.
            tangents: of a bezier key; None gives it those that an auto key would have now.

        Raises:
            NotFoundError: the camera has no such point.
            SettingsError: the attribute takes no such key, value or interpolation, or the time is not finite.
        """
        view = self._editable_point(camera_path, name)
        with self._edits.editing(f"key {attribute} of focus point {name} at {time:g}"):
            view.set_key(attribute, checked_time(time), value, interpolation or "linear", tangents)

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

    def rack(self, camera_path: str | None, asked: WeightRack) -> tuple[WeightRack, Rack]:
        """Take the focus from one focus point to another, by keys of their weights.

        Args:
            camera_path: of a camera.
            asked: from which to which, when, and how.

        Returns:
            What was authored, which ends later where the hand cannot turn the ring that fast, and what the lens does.

        Raises:
            NotFoundError: the camera has no such point.
            SettingsError: the rack makes no sense, or contradicts keys that are there.
            InputError: the target of a point is missing.
        """
        for name in (asked.from_point, asked.to_point):
            self._editable_point(camera_path, name)
        with self._edits.editing(f"rack from {asked.from_point} to {asked.to_point}"):
            return pull_rack(self.stage, self._anchors, self._path(camera_path), asked)

    def _editable_point(self, camera_path: str | None, name: str) -> FocusPointView:
        self._editable(camera_path)
        return self._point(camera_path, name)


def _note_topology(view: FocusPointView, time: float | None) -> None:
    """Note with a focus point the faces of the mesh that it is on at a time."""
    view.author(replace(view.read(), topology=topology_under(view.prim.GetStage(), view.read(time))))
