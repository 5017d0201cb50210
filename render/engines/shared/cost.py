"""Expected cost of pictures: processor time under llvmpipe (Mesa's rasteriser) on two cores.

Each engine says what its pictures cost (`Engine.cost_s`), by the functions of this module. The constants are fitted to the demo
shot, frame 64: the estimates are within a factor of 1.6 of the pictures that took more than 2 s, 120 to 960 pixels wide
(``tests/bench/RESULTS.md``). Other scenes differ by what they hold and by how much they are blurred; a graphics card takes far
less. The estimates serve to judge what to admit, and what holds up what.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from render.engines.shared.layer_scale import blurred_scale, traced_scale
from render.model.limits import MAX_RAYS
from render.model.mattes import MATTES

SCENE_S = 0.8
"""Reading, loading and drawing the scene once, whatever the size of the picture, s."""
VIEW_S = 0.15
"""Drawing a scene that is loaded once more, whatever the size of the picture, s."""
LAYER_PIXEL_S = 7.5e-7
"""One pixel of one layer: drawing, light, highlights, N-buffers, s."""
RAY_S = 1.2e-7
"""One ray, s."""
NOISE_RAYS, NOISE = 256, 0.01
"""Mean rays of a pixel for a wanted noise; half the noise takes about twice as many, since more pixels then need them at all."""
COMMON_WAVELENGTHS = 3
"""Wavelengths up to which they are not counted: most lenses are traced at one."""
AOV_PIXEL_S = 1e-7
"""One pixel of one AOV that is measured along chief rays, s."""
MATTE_PIXEL_S = 5e-6
"""One pixel of mattes, s."""
UNLIT_SHARE = 0.9
"""Cost of a picture without light, as the albedo is, relative to one with light."""
MOVED_SHARE = 0.9
"""Cost of moving the layers to one moment, relative to drawing them."""


@dataclass(frozen=True)
class PictureWork:
    """Settings that the cost of a picture depends on, as in `FrameSettings` but of any size: a picture is judged
    before its settings are checked."""

    width: int
    height: float
    rays: int
    layers: int
    supersample: float
    noise: float
    wavelengths: int
    motion: int
    motion_by: str
    aovs: tuple[str, ...] = ()

    @property
    def pixels(self) -> float:
        """Pixels of the picture."""
        return self.width * self.height

    @property
    def is_swept(self) -> bool:
        """Whether several moments are drawn from one peeling."""
        return self.motion > 1 and self.motion_by == "velocities"

    @property
    def moments(self) -> int:
        """Number of times that the scene is loaded."""
        return 1 if self.is_swept else self.motion


def aovs_cost_s(work: PictureWork, drawn_s: float) -> float:
    """Estimate what AOVs take beside a picture, s.

    Args:
        work: the picture.
        drawn_s: what the picture takes at one moment, as often as the albedo draws it, s.
    """
    measured = sum(aov not in ("color", "albedo", *MATTES) for aov in work.aovs)
    cost_s = VIEW_S + (LAYER_PIXEL_S + AOV_PIXEL_S * measured) * work.pixels if measured else 0.0
    if any(aov in MATTES for aov in work.aovs):
        cost_s += MATTE_PIXEL_S * work.pixels
    return cost_s + (UNLIT_SHARE * (drawn_s - SCENE_S) if "albedo" in work.aovs else 0.0)


def traced_cost_s(work: PictureWork, layers: int) -> float:
    """Estimate what tracing rays through layers takes, s.

    Args:
        work: the picture.
        layers: layers that are peeled at most.
    """
    scale = blurred_scale(work) if work.is_swept else traced_scale(work, work.moments)
    drawn_s = LAYER_PIXEL_S * layers * work.pixels * scale**2
    swept_s = MOVED_SHARE * work.motion * drawn_s if work.is_swept else 0.0
    rays: float = max(work.rays, work.motion)
    if work.noise > 0:
        rays = max(rays, min(MAX_RAYS, NOISE_RAYS * NOISE / work.noise))
    rays *= max(1.0, work.wavelengths / COMMON_WAVELENGTHS)
    return work.moments * (SCENE_S + drawn_s) + swept_s + RAY_S * work.pixels * rays


def accumulated_cost_s(work: PictureWork) -> float:
    """Estimate what drawing the scene anew for each ray takes, s."""
    views = max(work.rays, work.motion)
    view_s = VIEW_S + 2 * LAYER_PIXEL_S * work.pixels  # one layer is drawn, and added up
    return work.moments * SCENE_S + views * view_s


def blurred_cost_s(work: PictureWork, pixel_s: float, per_px: float = 0.0, per_px2: float = 0.0) -> float:
    """Estimate what blurring a single image takes, s.

    The blur of one pixel may grow with its radius, which is a share of the picture's width in the shot that was measured. Of a
    camera whose iris is closed, which is known only when the shot is open, the engine traces a pinhole picture: the estimate
    is that of the dearer one.

    Args:
        work: the picture.
        pixel_s: time for one blurred pixel, with drawing it, s.
        per_px: what is added to it for each blurred pixel along the picture's width, s.
        per_px2: likewise for the square of that number, s.
    """
    fine = math.ceil(blurred_scale(work))
    across = fine * work.width
    one_s = pixel_s + per_px * across + per_px2 * across**2
    return max(work.motion * (SCENE_S + one_s * work.pixels * fine**2), traced_cost_s(work, layers=1))
