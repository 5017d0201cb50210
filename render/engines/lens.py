"""Engine ``lens``: rays of the camera's lens traced through peeled layers.

Computes: the scene is drawn once, from the centre of the entrance pupil, as layers: for each pixel its visible surface and some
of those behind it. Every lens ray is a line ``s(w) = a + b·w`` on those layers, with w the inverse depth in 1/m; the tracer
bounds with N-buffers where the line can meet a surface, marches along it there, and takes the radiance of that surface. The
picture is the mean over the rays of each pixel. It has depth of field, tilted and bent focal surfaces, vignetting, distortion and
every error that a lens model or prescription has.

Settings:
    rays        lens rays per pixel, 1 to 4096 (100), in the mean over the picture. Noise falls with their square root.
    adaptive    from 32 rays on, more rays where the picture has more noise (True); without effect over several moments.
    noise       wanted standard error of each 8x8 pixels, in values of the clipped and sRGB-encoded picture from 0 to 1, in place
                of rays: 0.0005 to 0.1, or 0 for none (0).
    layers      peeled layers at most, 1 to 8 (4): how much of what is hidden from the pupil's centre a ray can still meet.
                Partly transparent surfaces do not count against it: up to eight surfaces of a pixel have a layer each, and
                further ones are merged into the last two (`render.layers.rest`).
    supersample layer pixels per picture pixel along each axis, 1 to 4; 0 for 2 below 8 rays, 3 below 48, 4 from there on, fewer
                where a picture has more than 1,650 lines, and 2 for each of several moments (0).
    wavelengths wavelengths traced for a lens with colour errors, 1 to 64 (3).
    connections True carries what is small, bright and blurred to the pixels of its blurred image, through any iris and any lens:
                along single rays, or cell by cell of the pupil where that image is uneven or folds, as near the focus of real
                glass; False leaves it to the rays (True).
    tiled       True gives neighbouring pixels different rays: noise in place of repeated images (True).
    motion      moments of the shutter's opening, 1 to 256 (1), by `moments` or by `velocities`.
    aovs        mattes (cryptoObject, cryptoMaterial) note which surfaces the rays of each pixel meet, up to 16, in the same pass.
    deep        True notes their light and depth too (False).

Cost: the demo shot (380,498 triangles) at 960x540 and the default settings takes 19 s on two CPU cores under
llvmpipe, most of it for drawing and lighting the layers. What the rays take is proportional to their number, not to
that of the lens surfaces.

Memory: layers take some 104 bytes for each layer pixel, with mattes 32 more and 128 for each pixel of the picture, 384 where
it is deep. Above 1 GiB, or an eighth of a GPU's memory where that is more, the picture is traced in tiles, whose number
does not change the pixels (`render.trace.tiling.plan`), but that adaptive rays are distributed over each tile by itself.
Highlights have a share of the connections in each strip of the layers, whose cut follows from their size. Above as much again,
textures are held as finely as the view shows them, in all engines (`render.layers.texture_budget`).

Limits: surfaces seen by no layer are missing: 44 to 53 dB from a converged path tracer on generated scenes. Shading
is that of the view from the pupil's centre, so that glints do not change over the pupil.

Gaussian splats are planes of depth between the layers, up to 32 (`render.trace.splats.planes`); a shot with some has no
connections. To draw 200,000 of them at 960x640 took 10 s on two busy CPU cores.

Source: Lee, Eisemann & Seidel 2010, "Real-Time Lens Blur Effects and Focus Control", section 3.1; lens tables:
`render.trace.bundles`.

Example::

    pullfocus record demo/night_street.usda lens.png --frames 40 --engine lens --lens planar_50 --rays 144
"""

from __future__ import annotations

from collections.abc import Generator, Mapping, Sequence
from typing import TYPE_CHECKING

from render.engines.base import Engine
from render.engines.shared.request import DrawRequest
from render.model.arrays import FloatArray

if TYPE_CHECKING:  # these modules load OpenGL
    from render.layers.movement import Movement
    from render.trace.motion_tracer import ShutterSample


class LensEngine(Engine):
    """Traces the camera's lens."""

    name = "lens"
    summary = "traces rays of the lens through peeled layers"
    rank = 0
    has_rays = True
    traces_lens = True
    takes_velocities = True
    draws_mattes = True
    draws_in_steps = True
    draws_splats = True

    def draw(self, request: DrawRequest) -> FloatArray:
        """Trace the request's part of the rays."""
        return self._device.trace(request)

    def draw_in_steps(self, request: DrawRequest) -> Generator[float, None, FloatArray]:
        """Trace all rays, piece by piece."""
        return self._device.trace_in_steps(request)

    def keeps_layers(self, request: DrawRequest) -> bool:
        """Tell whether the layers of the picture are kept."""
        return self._device.keeps_layers(request)

    def partial_picture(self) -> tuple[FloatArray, FloatArray]:
        """Read the mean over the rays traced so far."""
        return self._device.tracer.partial_picture()

    def draw_swept(
        self, request: DrawRequest, samples: Sequence[ShutterSample], movements: Mapping[int, Movement]
    ) -> Generator[FloatArray, None, None]:
        """Trace each moment through layers that are peeled once, with surfaces moved along straight lines."""
        return self._device.trace_swept(request, samples, movements)
