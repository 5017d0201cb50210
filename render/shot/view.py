"""One opened shot, to look at: its scene, cameras, focus and focus curves at any time."""

from __future__ import annotations

import math
from collections.abc import Hashable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Self

from pxr import Sdf, Usd

from render.errors import CameraError, NotFoundError, SettingsError
from render.focus import FocusCurve
from render.model.camera import Camera
from render.model.scene import Light, Scene
from render.shot.edits.edit_layer import Edits, schema_errors_as_settings
from render.shot.edits.shot_files import check_not_own
from render.shot.exposure.readout import ExposureReadout, read_exposure, with_exposure
from render.shot.findings.camera_findings import (
    camera_findings,
    close_focus_findings,
    light_findings,
    lost_point_findings,
    unmet_findings,
)
from render.shot.focus.camera_focus import CameraFocus
from render.shot.focus.focus_curve import focus_layer, solve_curve
from render.shot.focus.focused import Focused, without_points
from render.shot.focus.place_readout import PlaceReadout, read_place, read_point
from render.shot.focus.readout import PlacedPoint, Readout, place_points, read_out
from render.stage import (
    AnchorReader,
    CameraChoice,
    Finding,
    FrameRange,
    StageReader,
    conformed,
    default_camera,
    frame_range,
    list_cameras,
    open_stage,
    read_camera,
)
from usd_schemas import FocusPointView, Key, LensCamera, SchemaError
from usd_schemas.curves import EXACT


class ShotView:
    """The part of `Shot` that looks and changes nothing.

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
        # asks the reader and not the shot, so that who lets go of the shot lets go of its files
        self._focus = CameraFocus(stage, self._anchors, reader.read)
        edits.attach(stage)
        self._lights: tuple[Light, ...] = ()
        self._readings: tuple[int, dict[Hashable, float]] = 0, {}
        self._of_focus: dict[Finding, int] = {}  # what focusing found, and with which revision of the edits

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
    ) -> Self:
        """Open a shot.

        Args:
            path: a USD file.
            confined_to: folder that nothing the stage refers to may lie outside of; None for anywhere.
            purposes: which of USD's purposes are drawn.
            mask: only what lies at, below or above these prim paths is drawn; None for everything.
            complexity: how finely surfaces are refined, as in usdrecord.
            edits: a layer that `Shot.save_edits` wrote, to go on from. The file itself is not written to.

        Raises:
            StageError: a file is no USD, is damaged, or refers to what is missing or outside ``confined_to``.
        """
        layer = Edits(edits)
        stage = open_stage(Path(path), edit_layer=layer.layer, confined_to=confined_to)
        reader = StageReader(stage, purposes=tuple(purposes), mask=mask, complexity=complexity)
        return cls(Path(path), stage, layer, reader)

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
        found = [*self._reader.findings, *camera_findings(self.stage, self.cameras())]
        of_focus = [finding for finding, revision in self._of_focus.items() if revision == self._edits.revision]
        return found + light_findings(self._lights) + of_focus

    def scene_at(self, time: float) -> Scene:
        """What is drawn at a USD time code; what did not change since the last call is the same object."""
        scene = self._reader.read(checked_time(time))
        self._lights = scene.lights
        return scene

    def camera_at(self, camera_path: str | None, time: float, width: int, height: int) -> Camera:
        """The camera for a picture, its focus solved.

        Where ``focus:mode`` says points, the focus distance is the one that serves the focus points best. A camera whose
        mode is not authored is focused by hand, even where points exist: manual is what the schema falls back to, and
        what every other tool sees. Where no camera is named and none is to be preferred, one frames the whole stage.

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
        picture = self._for_picture(self._focused(camera_path, time), time, width / height)
        return with_exposure(self.stage, picture, time)

    @property
    def revision(self) -> int:
        """Another one after each edit."""
        return self._edits.revision

    @property
    def readings(self) -> dict[Hashable, float]:
        """What light meters (`render.shot.exposure.light_meter`) have read of the scene as it is: theirs to look up and to
        fill.
        """
        if self._readings[0] != self._reader.changes:
            self._readings = self._reader.changes, {}
        return self._readings[1]

    def exposure(self, camera_path: str | None, time: float) -> ExposureReadout:
        """How a camera exposes: its settings, and all that stands between the scene and the film.

        Args:
            camera_path: of a camera.
            time: USD time code.
        """
        return read_exposure(self.stage, self._focused(camera_path, time).camera, time)

    def readout(self, camera_path: str | None, time: float) -> Readout:
        """Focus, f-number, focal length and depth of field.

        Args:
            camera_path: of a camera.
            time: USD time code.
        """
        return read_out(self._focused(camera_path, time))

    def readout_at(
        self,
        camera_path: str | None,
        time: float,
        screen: tuple[float, float],
        depth_m: float,
        *,
        aspect: float | None = None,
    ) -> PlaceReadout:
        """What is in focus at a place of the picture, and the circle of confusion of a thing there.

        Args:
            camera_path: of a camera.
            time: USD time code.
            screen: the place: (0, 0) is the top left corner of the picture and (1, 1) the bottom right one.
            depth_m: of the thing, along the view axis; may be infinite.
            aspect: width over height of the picture; None takes the camera's own film gate.

        Raises:
            SettingsError: the place is no number, or the depth is not in front of the camera.
        """
        focused = self._focused(camera_path, time)
        return read_place(focused, self._for_picture(focused, time, aspect), screen, depth_m)

    def readout_at_point(
        self, camera_path: str | None, time: float, name: str, *, aspect: float | None = None
    ) -> PlaceReadout:
        """What is in focus at a focus point, and its circle of confusion.

        Args:
            camera_path: of a camera.
            time: USD time code.
            name: of the point.
            aspect: width over height of the picture; None takes the camera's own film gate.

        Raises:
            NotFoundError: the camera has no such point.
            InputError: the point has no place, or none in front of the camera.
        """
        focused = self._focused(camera_path, time)
        return read_point(focused, self._for_picture(focused, time, aspect), name)

    def focus_points(self, camera_path: str | None, time: float, *, aspect: float | None = None) -> list[PlacedPoint]:
        """A camera's focus points as they stand in its picture.

        Args:
            camera_path: of a camera.
            time: USD time code.
            aspect: width over height of the picture; None takes the camera's own film gate.
        """
        focused = self._focused(camera_path, time)
        return place_points(focused, self._for_picture(focused, time, aspect))

    def keys(self, camera_path: str | None, name: str, attribute: str) -> list[Key]:
        """Keys of one attribute of a focus point, such as ``weight`` or ``enabled``, in order of time.

        Raises:
            NotFoundError: the camera has no such point.
            SettingsError: a focus point has no such attribute.
        """
        with schema_errors_as_settings():
            return self._point(camera_path, name).keys(attribute)

    def focus_curve(self, camera_path: str | None, frames: Sequence[float]) -> FocusCurve:
        """The lens over some frames, its focus solved at each.

        Args:
            camera_path: of a camera.
            frames: rising USD time codes.

        Raises:
            SettingsError: there are no frames, too many, or they do not rise.
        """
        path = self._path(camera_path)
        return solve_curve(self.stage, path, frames, lambda times: self._focused_over(path, times))

    def focus_layer(
        self, camera_path: str | None, frames: Sequence[float], baked: bool = False, tolerance: float = EXACT
    ) -> str:
        """The solved focus as a USD layer for other tools (usda text), to be sublayered over the shot.

        Args:
            camera_path: of a camera.
            frames: rising USD time codes.
            baked: time samples, for tools that read no splines, in place of native splines.
            tolerance: how far a spline may be off, relative to the value; more makes fewer knots.

        Raises:
            SettingsError: there are no frames, too many, or they do not rise; or the tolerance is no share.
        """
        return focus_layer(self.stage, self.focus_curve(camera_path, frames), baked=baked, tolerance=tolerance)

    def check_not_own(self, path: Path) -> None:
        """Refuse to write a result over a file that the shot uses: a layer, a texture, or the saved edits over it.

        Args:
            path: of the file to be written.

        Raises:
            SettingsError: the shot is made of that file.
        """
        check_not_own(self.stage, path)
        edits = self._edits.path
        if edits is not None and path.is_file() and path.samefile(edits):
            raise SettingsError(
                f"the edits over the shot are {path}: write to another file", code="own_file", path=str(path)
            )

    def export_edits(self) -> str:
        """The edit layer as usda text."""
        return self._edits.export()

    def _focused(self, camera_path: str | None, time: float) -> Focused:
        checked_time(time)
        choice = self.default_camera() if camera_path is None else None
        if choice is not None and choice.framing is not None:
            return without_points(choice.framing)
        focused = self._focus.at(self._path(camera_path), time, self._edits.revision)
        self._note(close_focus_findings(focused))
        self._note_points(focused)
        return focused

    def _focused_over(self, camera_path: str, times: list[float]) -> list[Focused]:
        over = self._focus.over(camera_path, times, self._edits.revision)
        for focused in over:
            self._note_points(focused)
        return over

    def _note_points(self, focused: Focused) -> None:
        self._note([*lost_point_findings(focused), *unmet_findings(focused)])

    def _note(self, findings: Sequence[Finding]) -> None:
        self._of_focus.update(dict.fromkeys(findings, self._edits.revision))

    def _for_picture(self, focused: Focused, time: float, aspect: float | None) -> Camera:
        """The focused camera with its film gate conformed to a picture."""
        if aspect is None:
            return focused.camera
        if not focused.camera.path:
            return conformed(focused.camera, aspect)
        picture = read_camera(self.stage, focused.camera.path, time, aspect=aspect)
        own = focused.camera
        return replace(
            picture, focus_distance_m=own.focus_distance_m, f_stop=own.f_stop, focal_surface=own.focal_surface
        )

    def _path(self, camera_path: str | None) -> str:
        path = self.default_camera().path if camera_path is None else camera_path
        if path is None:
            known = self.cameras()
            what = f"{len(known)} cameras: name one of {', '.join(known)}" if known else "no camera: add one in a layer"
            raise CameraError(
                f"{self.path.name} has {what}",
                code="no_camera",
                path=str(self.path),
            )
        return path

    def _lens_camera(self, camera_path: str | None) -> LensCamera:
        """The camera as the schemas have it; its numbers may be impossible, so that they can be mended."""
        path = self._path(camera_path)
        try:
            return LensCamera(self.stage.GetPrimAtPath(path) if Sdf.Path.IsValidPathString(path) else Usd.Prim())
        except SchemaError as error:
            known = ", ".join(self.cameras()) or "none"
            raise CameraError(f"there is no camera at {path!r}, the cameras are: {known}", path=path) from error

    def _point(self, camera_path: str | None, name: str) -> FocusPointView:
        lens_camera = self._lens_camera(camera_path)
        names = [view.name for view in lens_camera.focus_points()]
        if name not in names:
            path = str(lens_camera.prim.GetPath())
            raise NotFoundError(
                f"camera {path} has no focus point named {name!r}, it has: {', '.join(names) or 'none'}", path=path
            )
        return lens_camera.focus_point(name)


def checked_time(time: float) -> float:
    """A time that can be asked about.

    Args:
        time: USD time code.

    Raises:
        SettingsError: it is not finite.
    """
    if not math.isfinite(time):
        raise SettingsError(f"a time must be a finite USD time code, but it is {time}", code="bad_time")
    return time
