"""Flare: what glass and iris add to a picture, ghosts of bright things and stars around them."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from render.engines import engine_class
from render.gl.resources import Resources
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.scene import Scene
from render.optics.iris import transmission
from render.optics.prescription.mounting import has_surfaces, mount_lens
from render.optics.spectrum import spectrum
from render.optics.thin_lens import pupil_radius_m
from render.optics.view import PinholeView

if TYPE_CHECKING:  # so that a process without GL can import the shot
    from render.frame import Frame, FrameRenderer, FrameSettings
    from render.optics.flare.diffraction import Star

_IRIS_SIDE = 512
_GHOST_WIDTH_PX = 640  # at most: sources are no points, so that edges of ghosts are soft
_FAINT = 2e-5  # radiance on the film over its white; fainter ghosts are left out
_NM_PER_M = 1e9


def add_flare(renderer: FrameRenderer, scene: Scene, camera: Camera, settings: FrameSettings, frame: Frame) -> Frame:
    """Add the flare of a frame's camera; returns the frame itself where there is none.

    Args:
        renderer: of the calling thread.
        scene: the scene, for a moving one at the middle of the exposure.
        camera: the camera; its lens has the strength of the flare.
        settings: as the frame was rendered: pinholes have no flare.
        frame: its light is changed, its AOVs are not.

    Raises:
        GraphicsError: OpenGL reports an error.
    """
    if engine_class(settings).is_sharp or camera.f_stop <= 0 or camera.lens.model == "pinhole":
        return frame
    ghosts = (
        _draw_ghosts(renderer, scene, camera, settings) if camera.lens.ghosts > 0 and has_surfaces(camera) else None
    )
    if ghosts is None and camera.lens.star == 0:
        return frame
    color = frame.color.copy()
    if camera.lens.star > 0:
        color[..., :3] = make_star(camera, settings.width, settings.height).spread(color[..., :3])
    if ghosts is not None:
        color[..., :3] += ghosts
    return replace(frame, color=color)


def make_star(camera: Camera, width: int, height: int) -> Star:
    """Make the star that diffraction at the iris draws in a camera's pictures.

    Raises:
        InputError: the prescription makes no lens.
        SettingsError: the lens does not reach the focus distance.
    """
    from render.optics.flare.diffraction import star  # few pictures have flare

    view = PinholeView.from_camera(camera, width, height)
    radius_m = mount_lens(camera).entrance_pupil_radius_mm / 1000 if has_surfaces(camera) else pupil_radius_m(camera)
    pupil_nm = 2 * radius_m * _NM_PER_M
    return star(
        camera.iris,
        (view.fx * camera.lens.squeeze / pupil_nm, view.fy / pupil_nm),
        width,
        height,
        strength=camera.lens.star,
    )


def _draw_ghosts(renderer: FrameRenderer, scene: Scene, camera: Camera, settings: FrameSettings) -> FloatArray | None:
    """Draw the ghosts, ``(height, width, 3)``; None where nothing in view is bright."""
    from render.optics.flare.ghost_sheets import ghost_sheets  # few pictures have flare
    from render.pictures.bright_sources import find_bright_sources
    from render.trace.ghost_pass import GhostPass  # with OpenGL

    if camera.lens.has_cylinders:  # sheets are traced in a plane of symmetry through the source
        return None
    sources = find_bright_sources(renderer, scene, camera, settings)
    if not sources:
        return None
    lens, iris = mount_lens(camera), transmission(camera.iris, _IRIS_SIDE)
    share = float(iris.mean()) * 4 / np.pi
    faintest = _FAINT / (camera.exposure_scale * camera.lens.ghosts)
    sheets = ghost_sheets(lens, sources, spectrum(settings.wavelengths), share, faintest=faintest)
    width = min(settings.width, _GHOST_WIDTH_PX)
    height = max(1, round(settings.height * width / settings.width))
    renderer.graphics.make_current()
    with Resources() as held:
        ghost_pass = held.keep(GhostPass(renderer.graphics.ctx))
        drawn = ghost_pass.draw(sheets, PinholeView.from_camera(camera, width, height), iris)
    return _resize(drawn, settings.width, settings.height) * np.float32(camera.lens.ghosts * camera.lens.transmittance)


def _resize(picture: FloatArray, width: int, height: int) -> FloatArray:
    """Resize a picture, linearly between the centres of its pixels."""
    if picture.shape[:2] == (height, width):
        return picture
    for axis, size in enumerate((height, width)):
        last = picture.shape[axis] - 1
        at = np.clip((np.arange(size) + 0.5) * (last + 1) / size - 0.5, 0, last)
        low = np.minimum(at.astype(np.int64), max(last - 1, 0))
        share = (at - low).reshape(-1, *([1] * (2 - axis)))
        picture = picture.take(low, axis) * (1 - share) + picture.take(np.minimum(low + 1, last), axis) * share
    return np.asarray(picture, np.float32)
