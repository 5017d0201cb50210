"""`Engine`: one way to draw a loaded scene, and what it can do, as attributes of its class.

An engine is one module of `render.engines` with one subclass of `Engine`. The module opens with the engine's manual page. Its
class attributes are read without a device: by the command line's help, by the service's HTTP process, by pictures that must know
what the engine leaves to be done. An instance draws on one OpenGL context.

Engine modules are imported by processes that load no OpenGL. So a module imports what needs OpenGL in its ``__init__``, which
runs on the device, and not at its top.
"""

from __future__ import annotations

from collections.abc import Generator, Mapping, Sequence
from typing import TYPE_CHECKING, ClassVar, Literal

from render.engines.shared.request import DrawRequest
from render.model.arrays import FloatArray
from render.model.camera import Camera

if TYPE_CHECKING:  # a device needs OpenGL
    from render.engines.shared.device import Device
    from render.layers.movement import Movement
    from render.trace.motion_tracer import ShutterSample

Preview = Literal["rays", "blur"]


class Engine:
    """An engine on one context.

    Args:
        device: the peeler, with the scene loaded, and what else the engines of a context share.

    Attributes:
        name: as `FrameSettings.engine` and ``--engine`` have it.
        summary: one phrase for help texts, without a full stop.
        rank: place in lists of engines; lower comes first, and equal ranks are sorted by name.
        has_rays: True where the picture is a mean over lens rays, so that a part of them can be drawn by itself.
        traces_lens: True where rays carry the light that the lens transmits. Elsewhere its transmittance is applied to the
            finished picture.
        is_sharp: True where the picture is that of a pinhole, whatever the camera's f-number.
        uses_image_space: True where no ray passes a lens by its data sheet, so that the sheet's errors are put on the finished
            picture (`render.pictures.image_space`).
        draws_axis_aberrations: True where the blur itself has the lens's errors on its axis, so that image space leaves them out.
        takes_velocities: True where `draw_swept` draws the moments of a moving scene from one peeling.
        draws_in_steps: True where `draw_in_steps` lets a picture be shown before it is finished.
        preview: kind of the small picture that goes before the engine's own: few lens rays (``rays``) or FLAG (``blur``).
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
    draws_in_steps: ClassVar[bool] = False
    preview: ClassVar[Preview] = "rays"

    def __init__(self, device: Device) -> None:
        self._device = device

    @classmethod
    def check_camera(cls, camera: Camera) -> None:
        """Raise `SettingsError` where the engine cannot show the camera's lens. Called before the scene is loaded."""

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
            The share that is done; `unfinished` has the picture then.
        """
        raise NotImplementedError

    def unfinished(self) -> tuple[FloatArray, FloatArray]:
        """Read the picture that `draw_in_steps` is drawing.

        Returns:
            ``(height, width, 4)`` float32, premultiplied, and ``(height, width, 1)``, the share of each pixel's rays that are in.
        """
        raise NotImplementedError

    def draw_swept(
        self, request: DrawRequest, samples: Sequence[ShutterSample], movements: Mapping[int, Movement]
    ) -> Generator[FloatArray, None, None]:
        """Draw the moments of a moving scene from one peeling. Only where `takes_velocities`. Close the generator in the end.

        Args:
            request: the picture in the middle of the shutter's opening.
            samples: the moments.
            movements: how the loaded scene's batches move, by number.

        Yields:
            Each moment's picture by its part of the rays, ``(height, width, 4)`` float32, premultiplied.
        """
        raise NotImplementedError

    def release(self) -> None:
        """Give back device memory that is the engine's own."""
