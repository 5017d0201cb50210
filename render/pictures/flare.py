"""What glass and iris add to a picture: ghosts of what is bright, and stars around it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from render.engines import engine_of
from render.gl.resources import Resources
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.scene import Scene
from render.optics.flare.diffraction import Star, star
from render.optics.flare.ghost_sheets import ghost_sheets
from render.optics.iris import transmission
from render.optics.prescription.mounting import has_surfaces, mount_lens
from render.optics.spectrum import spectrum
from render.optics.thin_lens import pupil_radius_m
from render.optics.view import PinholeView
from render.pictures.bright_sources import bright_sources

if TYPE_CHECKING:  # so that a process without GL can import the shot
    from render.frame import Frame, FrameRenderer, FrameSettings

_IRIS_SIDE = 512
_MOST_PX = 640  # of width, at which ghosts are drawn: what they are of is no point, and so their edges are soft
_FAINT = 2e-5  # on the film, over what it shows white: fainter ghosts are left out
_NM_PER_M = 1e9


def flared(renderer: FrameRenderer, scene: Scene, camera: Camera, settings: FrameSettings, frame: Frame) -> Frame:
    """A frame with its camera's flare; itself where there is none.

    Args:
        renderer: of the calling thread.
        scene: what is there, for a moving one at the middle of the exposure.
        camera: what looked; its lens says how strong its flare is.
        settings: how the frame was rendered: pinholes have no flare.
        frame: its light; depths and the like stay.

    Raises:
        GraphicsError: the device refuses.
    """
    if engine_of(settings).is_sharp or camera.f_stop <= 0 or camera.lens.model == "pinhole":
        return frame
    ghosts = _ghosts(renderer, scene, camera, settings) if camera.lens.ghosts > 0 and has_surfaces(camera) else None
    if ghosts is None and camera.lens.star == 0:
        return frame
    color = frame.color.copy()
    if camera.lens.star > 0:
        color[..., :3] = star_of(camera, settings.width, settings.height).spread(color[..., :3])
    if ghosts is not None:
        color[..., :3] += ghosts
    return replace(frame, color=color)


def star_of(camera: Camera, width: int, height: int) -> Star:
    """The star that diffraction draws in a camera's pictures.

    Raises:
        InputError: the lens is none.
        SettingsError: it does not reach the focus distance.
    """
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


def _ghosts(renderer: FrameRenderer, scene: Scene, camera: Camera, settings: FrameSettings) -> FloatArray | None:
    """``(height, width, 3)`` light of the ghosts, where something is bright."""
    from render.trace.ghost_pass import GhostPass  # with OpenGL

    sources = bright_sources(renderer, scene, camera, settings)
    if not sources:
        return None
    lens, iris = mount_lens(camera), transmission(camera.iris, _IRIS_SIDE)
    share = float(iris.mean()) * 4 / np.pi
    faintest = _FAINT / (camera.exposure_scale * camera.lens.ghosts)
    sheets = ghost_sheets(lens, sources, spectrum(settings.wavelengths), share, faintest=faintest)
    width = min(settings.width, _MOST_PX)
    height = max(1, round(settings.height * width / settings.width))
    renderer.graphics.make_current()
    with Resources() as held:
        ghost_pass = held.keep(GhostPass(renderer.graphics.ctx))
        drawn = ghost_pass.draw(sheets, PinholeView.from_camera(camera, width, height), iris)
    return _enlarged(drawn, settings.width, settings.height) * np.float32(
        camera.lens.ghosts * camera.lens.transmittance
    )


def _enlarged(picture: FloatArray, width: int, height: int) -> FloatArray:
    """A picture at another size, joined linearly between the middles of its pixels."""
    if picture.shape[:2] == (height, width):
        return picture
    for axis, size in enumerate((height, width)):
        last = picture.shape[axis] - 1
        at = np.clip((np.arange(size) + 0.5) * (last + 1) / size - 0.5, 0, last)
        low = np.minimum(at.astype(np.int64), max(last - 1, 0))
        share = (at - low).reshape(-1, *([1] * (2 - axis)))
        picture = picture.take(low, axis) * (1 - share) + picture.take(np.minimum(low + 1, last), axis) * share
    return np.asarray(picture, np.float32)
