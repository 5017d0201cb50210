"""One opened shot. The command line and the service both render from it, so both give the same pixels."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any, Self

from pxr import Usd

from render.errors import PullfocusError, SettingsError
from render.model.camera import Camera
from render.model.framing import WHOLE, Framing
from render.model.scene import Scene
from render.model.shutter import moments
from render.shot.camera.lookup import CameraLookup
from render.shot.camera.shot_camera import ShotCamera
from render.shot.edits.edit_layer import Edits
from render.shot.edits.shot_files import check_not_own
from render.shot.exposure.readout import with_exposure
from render.shot.exposure.shot_exposure import ShotExposure
from render.shot.film.shot_film import ShotFilm
from render.shot.findings.shot_findings import ShotFindings
from render.shot.focus.plan import ShotPlan
from render.shot.focus.report import ReportedFrame, report_frames
from render.shot.focus.shot_focus import ShotFocus
from render.shot.focus.solver import FocusSolver
from render.shot.focus.tracker import FocusTracker
from render.shot.shot_choices import ShotChoices
from render.shot.shot_notes import ShotNotes
from render.shot.times import check_reading_time
from render.stage import (
    AnchorReader,
    CameraChoice,
    Finding,
    FrameRange,
    RenderSettings,
    StageOptions,
    StageReader,
    StereoPair,
    choose_settings,
    find_missing_targets,
    find_pass,
    frame_range,
    list_pairs,
    open_stage,
    stage_settings,
)
from render.stage.faults import faults_of_stage
from render.stage.findings import FindingLog
from render.stage.options import DEFAULT_OPTIONS, DRAWN_PURPOSES
from render.stage.own_settings import read_own_settings
from render.stage.population import Population
from render.stage.render_products import Product, read_products

_TRIAL_PX = (16, 9)
"""Size of the picture that `Shot.keep_usable` sets a camera up for; it is not rendered."""


class Shot:
    """A USD stage, its cameras and focus, and the layer of edits over it.

    Each edit goes to the edit layer (`render.shot.edits.edit_layer`); no file of the user's is ever written. An edit that fails
    leaves everything as it was.

    A shot is for one thread at a time: USD stages may not be written while they are read, so callers with several
    threads (the service) hold a lock around each call.

    In the shot and its parts, a camera path of None stands for the shot's default camera. `CameraError` is raised where there
    is no such camera or its numbers are impossible. A time is a USD time code, or `DEFAULT_TIME` for USD's
    default time; one that is infinite raises `SettingsError`.

    Attributes:
        path: the file that was opened.
        stage: the composed stage, edits included.
        edits: the edit layer and its history.
        camera: attributes and keys of cameras, their lenses and bodies.
        focus: focus points, focus settings, readouts and focus curves.
        plan: cameras and their focus points from above.
        exposure: exposure settings, readouts and metering.
        film: film settings, stocks and finishes.
        choices: variants and payloads.
        notes: texts and drawings at frames.
    """

    def __init__(self, path: Path, stage: Usd.Stage, edits: Edits, reader: StageReader, cameras: CameraLookup) -> None:
        """Use `Shot.open`."""
        edits.attach(stage)
        anchors = AnchorReader(stage, reader.options)
        # The parts refer to the reader and not to the shot: without a cycle, dropping the shot closes its files at once.
        self._reader = reader
        self._cameras = cameras
        self._findings = ShotFindings(stage, edits, cameras, reader)
        self._solver = FocusSolver(stage, edits, cameras, FocusTracker(stage, anchors, reader.read), self._findings)
        self.path = path
        self.stage = stage
        self.edits = edits
        self.camera = ShotCamera(stage, edits, cameras)
        self.focus = ShotFocus(stage, edits, cameras, anchors, self._solver)
        self.plan = ShotPlan(stage, edits, cameras, anchors, self._solver, self.focus)
        self.exposure = ShotExposure(stage, edits, cameras, self._solver, reader)
        self.film = ShotFilm(stage, edits, cameras)
        self.choices = ShotChoices(stage, edits)
        self.notes = ShotNotes(stage, edits, cameras)
        self._framing = WHOLE

    @classmethod
    def open(
        cls,
        path: str | Path,
        *,
        confined_to: Path | None = None,
        edits: Path | None = None,
        options: StageOptions = DEFAULT_OPTIONS,
    ) -> Self:
        """Open a shot.

        Args:
            path: a USD file.
            confined_to: folder that must hold every file of the stage; None allows any folder.
            edits: a layer that `Edits.save` wrote, to start from. The file itself is not written to.
            options: how the stage is opened and read.

        Raises:
            SettingsError: the options name a prim that is no RenderSettings or RenderPass.
            StageError: the file is not USD, is damaged, or refers to a file outside ``confined_to``; missing ones are findings.
        """
        with faults_of_stage(Path(path).name):
            return cls._open(path, confined_to, edits, options)

    @classmethod
    def _open(cls, path: str | Path, confined_to: Path | None, edits: Path | None, options: StageOptions) -> Self:
        layer = Edits(edits)
        stage = open_stage(
            Path(path),
            edit_layer=layer.layer,
            session_layer=options.session_layer,
            resolver=options.resolver,
            population=Population(
                options.mask,
                options.camera,
                options.all_cameras,
                options.settings_prim,
                options.render_pass,
                options.unloaded,
            ),
            confined_to=confined_to,
        )
        render_pass = find_pass(stage, options.render_pass) if options.render_pass is not None else None
        if options.settings_prim is not None:
            choose_settings(stage, options.settings_prim)
        purposes = options.purposes or _chosen_purposes(stage, options) or DRAWN_PURPOSES
        reader = StageReader(stage, replace(options, purposes=purposes), render_pass)
        cameras = CameraLookup(stage, Path(path), purposes, options.mask)
        shot = cls(Path(path), stage, layer, reader, cameras)
        if options.render_pass is not None and options.mask is None:  # a mask leaves out what a pass may name
            shot.note_asked(find_missing_targets(stage, options.render_pass))
        return shot

    @property
    def render_settings(self) -> RenderSettings | None:
        """The RenderSettings prim that the options of `open` chose, else the stage's own; None where there is none."""
        return stage_settings(self.stage)

    def own_settings(self) -> dict[str, Any]:
        """Fields of `FrameSettings` that the stage's RenderSettings prim authors (`render.stage.own_settings`)."""
        settings, log = self.render_settings, FindingLog()
        found = read_own_settings(settings.prim.GetPrim(), log) if settings else {}
        self._findings.note_asked(log.as_list())
        return found

    def rendering_space(self) -> str:
        """Linear colour space that EXR files are written in (`RenderSettings.rendering_space`); empty for the working space."""
        settings, log = self.render_settings, FindingLog()
        space = settings.rendering_space(log) if settings else ""
        self._findings.note_asked(log.as_list())
        return space

    def note_asked(self, findings: Sequence[Finding]) -> None:
        """Add findings of what the stage's render settings ask for."""
        self._findings.note_asked(findings)

    def products(self) -> list[Product]:
        """Products of the stage's RenderSettings prim.

        Raises:
            SettingsError: there is no such prim, or it has no product that can be rendered.
        """
        settings, log = self.render_settings, FindingLog()
        if settings is None:
            raise SettingsError(f"{self.path} has no RenderSettings prim to name products", code="no_render_settings")
        try:
            return read_products(settings, log)
        finally:
            self._findings.note_asked(log.as_list())

    @property
    def frame_range(self) -> FrameRange:
        """First and last frame as time codes, and the frames per second."""
        return frame_range(self.stage)

    def cameras(self) -> list[str]:
        """List the prim paths of all cameras."""
        return self._cameras.paths()

    def stereo_pairs(self) -> list[StereoPair]:
        """List the pairs of stereo cameras."""
        return list_pairs(self.stage, self.cameras())

    def default_camera(self) -> CameraChoice:
        """Choose the camera that is used when none is named, and say why."""
        return self._cameras.default()

    def findings(self) -> list[Finding]:
        """List the features of the stage found so far that are not supported, and the values that cannot be used."""
        return self._findings.all()

    def scene_at(self, time: float, camera_path: str = "") -> Scene:
        """Read the scene at a USD time code; what did not change since the last call is the same object.

        Args:
            time: USD time code.
            camera_path: prim path of the camera that levels of detail are chosen for; empty for their default ones.
        """
        scene = self._reader.read(check_reading_time(time), camera_path)
        self._findings.note_lights(scene.lights)
        return scene

    def camera_at(self, camera_path: str | None, time: float, width: int, height: int) -> Camera:
        """Make the camera of a picture, with its focus solved.

        Where ``focus:mode`` is ``points``, the focus distance is the weighted best one for the focus points. A camera
        without an authored mode is focused by hand, even where it has points: ``manual`` is the fallback of the schema, and
        what other tools show.
        Without a camera path or a default camera, a camera that frames the whole stage is made. The gate is framed as `framed`
        says.

        Args:
            camera_path: prim path of a camera.
            time: USD time code.
            width: of the picture in pixels.
            height: of the picture in pixels.

        Raises:
            SettingsError: the picture has no pixels.
        """
        if width < 1 or height < 1:
            raise SettingsError(f"a picture must be at least 1 × 1 pixels, but {width} × {height} was requested")
        focused, framing = self._solver.solve(camera_path, time), self._framing
        fitted = self._solver.fit_to_picture(focused, time, framing.aspect(width, height), framing.conform)
        return framing.apply(with_exposure(self.stage, fitted, time), width, height)

    def report_focus(
        self, camera_path: str | None, times: Sequence[float], width: int, height: int | None = None
    ) -> list[ReportedFrame]:
        """Report the lens and the sharpness of each focus point in the pictures of a camera.

        Args:
            camera_path: prim path of a camera.
            times: rising USD time codes, at least one.
            width: of the pictures in pixels.
            height: of the pictures in pixels; None for that of the film gate.

        Raises:
            SettingsError: the width is out of range.
        """
        return report_frames(self._solver, self.stage, camera_path, times, (width, height))

    @contextmanager
    def framed(self, framing: Framing) -> Iterator[None]:
        """Frame the pictures of the block, all that `camera_at` is asked for.

        Args:
            framing: in place of whole pictures with square pixels.
        """
        before, self._framing = self._framing, framing
        try:
            yield
        finally:
            self._framing = before

    def check_not_own(self, path: Path) -> None:
        """Refuse to overwrite a file that the shot itself uses: a layer, a texture, or the saved edits.

        Args:
            path: of the file to be written.

        Raises:
            SettingsError: the shot is made of that file.
        """
        check_not_own(self.stage, path)
        edits = self.edits.path
        if edits is not None and path.is_file() and path.samefile(edits):
            raise SettingsError(
                f"the edits over the shot are {path}: write to another file", code="own_file", path=str(path)
            )

    @contextmanager
    def keep_usable(self, camera_path: str | None, time: float) -> Iterator[None]:
        """Refuse the edits of the block if they leave a camera that cannot make a picture, but could before.

        Args:
            camera_path: of the camera that is edited.
            time: USD time code of the picture.

        Raises:
            PullfocusError: the error that the next picture would end with.
        """
        before = self._refusal(camera_path, time)
        yield
        after = self._refusal(camera_path, time)
        if after is not None and str(after) != str(before):
            raise after

    def _refusal(self, camera_path: str | None, time: float) -> PullfocusError | None:
        """Return the error that a picture would end with; None where it can be made."""
        try:
            camera = self.camera_at(camera_path, time, *_TRIAL_PX)
            self.film.finish(camera, time)
            moments(camera.shutter_open, camera.shutter_close, camera.shutter, 1)
        except PullfocusError as error:
            return error
        return None


def _chosen_purposes(stage: Usd.Stage, options: StageOptions) -> tuple[str, ...] | None:
    """Purposes that the settings prim of the options includes; None where they choose none."""
    settings = stage_settings(stage) if options.settings_prim or options.render_pass else None
    return settings.included_purposes if settings else None
