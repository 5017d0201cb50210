"""Footprint over which a picture filters the textures and the highlights of surfaces.

Each of many rays represents its share of the pupil, so that out of focus it represents a patch of surface as wide as that
share's own circle of confusion. Textures are filtered over that patch, as with ray differentials (Igehy 1999, "Tracing ray
differentials", section 3): a hundred points of a strongly blurred brick wall give a hatching, a hundred patches give its blur.
More rays have smaller patches and converge to the same picture. Cut-outs keep their edges.

Normals that vary within a sample blur its highlights (``layers/material.glsl``). A sample is a pixel of the pass, not of the
finished picture, which averages several: the highlight of a thin rim would be widened away before it is averaged.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from render.optics.view import PinholeView

PATCH_SHARE = 0.5
"""Side of the patch, relative to the side of a square as large as the ray's share of the pupil. Mipmaps filter wider."""

PATCH_STEP_PX = 0.5
"""Step of the plane of focus that layers are drawn for: change of a patch's side, pixels. While the focus stays within a step,
layers are the same, and are kept. At the focus, a patch of half a step makes the filter 3 % wider."""

QUAD_SCALE = 2.5
"""Pixels of a pass per pixel of the picture, along each axis, from which on 2x2 of them may share their light."""


@dataclass(frozen=True)
class SurfaceSampling:
    """Texture footprint of the finished picture, in pixels of the pass that draws the surfaces.

    Attributes:
        detail: times finer than this pass's pixels: 1 for layers; more where many shifted views make one picture.
        patch_px_m: side of the patch that one ray stands for, per 1/m of w between the surface and the plane of focus.
        focus: w of that plane at the pass's corner, 1/m, and how it changes from pixel to pixel along x and y.
        by_quads: light 2x2 pixels of the pass at once where their surfaces are alike (`render.layers.shading`).
    """

    detail: float = 1.0
    patch_px_m: float = 0.0
    focus: tuple[float, float, float] = (0.0, 0.0, 0.0)
    by_quads: bool = False

    def at_corner(self, x: float, y: float) -> SurfaceSampling:
        """The same sampling in a pass whose corner is this many pixels to the right and down."""
        corner, right, down = self.focus
        return replace(self, focus=(corner + right * x + down * y, right, down))


PLAIN = SurfaceSampling()
"""Sampling of a picture that is drawn once, at its own resolution, from one point."""


def patch_px_m(f_px: float, pupil_m: float, rays: int) -> float:
    """`SurfaceSampling.patch_px_m` for ``rays`` rays through a pupil of this radius; 0 for a single ray, as of a pinhole."""
    return 0.0 if rays == 1 else PATCH_SHARE * f_px * pupil_m * float(np.sqrt(np.pi / rays))


def layer_sampling(
    layers: PinholeView, picture: PinholeView, focus: tuple[float, float, float], pupil_m: float, rays: int
) -> SurfaceSampling:
    """Texture footprint for rays traced through peeled layers, for a plane of focus in steps of `PATCH_STEP_PX`.

    Args:
        layers: view of the layers' pixels.
        picture: view of the picture's pixels.
        focus: w of the plane of focus at the picture's corner, 1/m, and its change from pixel to pixel of the picture.
        pupil_m: radius of the entrance pupil.
        rays: number of rays per pixel.
    """
    scale = layers.fx / picture.fx
    patch = patch_px_m(max(layers.fx, layers.fy), pupil_m, rays)
    if patch == 0:
        return SurfaceSampling(by_quads=scale >= QUAD_SCALE)
    step = PATCH_STEP_PX / patch
    across = 4 * max(layers.width, layers.height)
    right, down = (_rounded(slope / scale, step / across) for slope in focus[1:])
    corner = focus[0] + right * (scale * picture.cx - layers.cx) + down * (scale * picture.cy - layers.cy)
    return SurfaceSampling(1.0, patch, (_rounded(corner, step), right, down), by_quads=scale >= QUAD_SCALE)


def _rounded(value: float, step: float) -> float:
    return step * round(value / step)
