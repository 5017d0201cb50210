"""`Engine`: one way to draw a loaded scene, and what it can do, as attributes of its class.

An engine is one module of `render.engines` with one subclass of `Engine`. The module opens with the engine's manual page. Its
class attributes are read without a device: by the command line's help, by the service's HTTP process, by pictures that must know
what the engine leaves to be done. An instance draws on one OpenGL context.

Engine modules are imported by processes that load no OpenGL. So a module imports what needs OpenGL in the engine's ``__init__``,
which runs where there is a context, and not at its top.
"""

from __future__ import annotations

from collections.abc import Generator, Mapping, Sequence
from typing import TYPE_CHECKING, ClassVar, Literal

from render.engines.shared.cost import PictureWork, traced_cost_s
from render.engines.shared.request import DrawRequest
from render.model.arrays import FloatArray
from render.model.camera import Camera

if TYPE_CHECKING:  # a device needs OpenGL
    from render.engines.shared.device import Device
    from render.layers.movement import Movement
    from render.trace.motion_tracer import ShutterSample

Preview = Literal["rays", "blur"]
"""Kind of a preview: a picture of few lens rays, or a sharp picture blurred by FLAG."""


class Engine:
    """An engine on one context.

    Args:
        device: the peeler with the loaded scene, and the tracers and blurs that all engines of a context share.

    Attributes:
        name: value of `FrameSettings.engine` and of ``--engine`` that chooses the engine.
        summary: one phrase for help texts, without a full stop.
        rank: place in lists of engines; lower comes first, and equal ranks are sorted by name.
        has_rays: True where the picture is a mean over lens rays, so that a part of them can be drawn by itself.
        traces_lens: True where rays are weighted by the lens's transmittance. Otherwise it is applied to the finished picture.
        is_sharp: True where the picture is that of a pinhole, whatever the camera's f-number.
        uses_image_space: True where a data sheet's errors are applied to the finished picture, since the engine traces no
            rays through the lens (`render.pictures.image_space`).
        draws_axis_aberrations: True where the blur itself has the lens's errors on the axis, so that
            `render.pictures.image_space` leaves them out.
        takes_velocities: True where `draw_swept` draws the moments of a moving scene from one peeling.
        draws_mattes: True where it adds what its rays meet to `DrawRequest.mattes`.
        draws_in_steps: True where `draw_in_steps` lets a picture be shown before it is finished.
        draws_splats: True where it shows the Gaussian splats of a scene.
        preview: kind of the small picture that is shown before the engine's own.
    """

    name: ClassVar[str]
    summary: ClassVar[str]
    rank: ClassVar[int] = 100
    has_rays: ClassVar[bool] = False
    traces_lens: ClassVar[bool] = False
    is_sharp: ClassVar[bool] = False
    uses_image_space: ClassVar[bool] = False
    draws_axis_aberrations: ClassVar[bool] = False
    takes_velocities: ClassVar[bool] = False
    draws_mattes: ClassVar[bool] = False
    draws_in_steps: ClassVar[bool] = False
    draws_splats: ClassVar[bool] = False
    preview: ClassVar[Preview] = "rays"

    def __init__(self, device: Device) -> None:
        self._device = device

    @classmethod
    def check_camera(cls, camera: Camera) -> None:
        """Raise `SettingsError` where the engine cannot show the camera's lens. Called before the scene is loaded."""

    @classmethod
    def cost_s(cls, work: PictureWork) -> float:
        """Estimate the processor time of a picture, with all its moments, s; see `render.engines.shared.cost`.

        Unless the engine says otherwise, that of rays traced through layers.

        Raises:
            OverflowError: it is beyond all numbers.
        """
        return traced_cost_s(work, work.layers)

    def draw(self, request: DrawRequest) -> FloatArray:
        """Draw the loaded scene.

        Returns:
            ``(height, width, 4)`` float32 scene-linear radiance, premultiplied; alpha is coverage.

        Raises:
            Cancelled: the work is stale.
        """
        raise NotImplementedError

    def draw_in_steps(self, request: DrawRequest) -> Generator[float, None, FloatArray]:
        """Draw as `draw` does, to the bit, with pauses. Only where `draws_in_steps`.

        Yields:
            Share that is done; `partial_picture` can be read between steps.
        """
        raise NotImplementedError

    def keeps_layers(self, request: DrawRequest) -> bool:
        """Tell whether `draw_in_steps` would start from layers that are kept. Only where `draws_in_steps`."""
        raise NotImplementedError

    def partial_picture(self) -> tuple[FloatArray, FloatArray]:
        """Read the picture that `draw_in_steps` is drawing.

        Returns:
            ``(height, width, 4)`` float32, premultiplied, and ``(height, width, 1)``, the share of each pixel's rays that were
            traced.
        """
        raise NotImplementedError

    def draw_swept(
        self, request: DrawRequest, samples: Sequence[ShutterSample], movements: Mapping[int, Movement]
    ) -> Generator[FloatArray, None, None]:
        """Draw the moments of a moving scene from one peeling. Only where `takes_velocities`. The caller closes the generator.

        Args:
            request: the picture half-way through the shutter interval.
            samples: the moments.
            movements: movements of the loaded scene's batches, by batch index.

        Yields:
            Picture of each moment, drawn with that moment's part of the rays: ``(height, width, 4)`` float32, premultiplied.
        """
        raise NotImplementedError

    def release(self) -> None:
        """Release device memory that the engine does not share."""
