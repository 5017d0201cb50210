"""Settings of a frame. They are checked when they are made, before anything slow is done."""

from __future__ import annotations

from dataclasses import dataclass

from render.errors import SettingsError
from render.model.aovs import check_aov
from render.model.limits import MAX_LAYERS, MAX_RAYS, MAX_WAVELENGTHS, check_picture_size

SHADINGS = ("lit", "unlit")
MOTIONS = ("moments", "velocities")
MAX_SUPERSAMPLE = 4
MAX_MOTION = 256
ADAPTIVE_RAYS = 32
"""Rays per pixel from which on they can be distributed over the picture."""
LEAST_NOISE = 0.0005
MOST_NOISE = 0.1


@dataclass(frozen=True)
class FrameSettings:
    """Settings of a frame.

    Attributes:
        width: pixels.
        height: pixels.
        engine: name of an engine of `render.engines`, which checks that there is one (`check_settings`).
        rays: lens rays per pixel.
        layers: peeled layers at most.
        supersample: layer pixels per picture pixel along each axis, 1 or more and not whole if need be; 0 for as many as suit the
            engine and its rays.
        shading: ``lit``, or ``unlit``: base colour (or displayColor) for radiance and no lights, which isolates the optics.
        seed: seed of the sampling pattern.
        adaptive: give more rays to the parts of the picture that have more noise, so that ``rays`` is their mean; without effect
            below `ADAPTIVE_RAYS`, and on an untiled picture or one of several moments.
        noise: wanted error in place of ``rays``: the standard error of each tile of 8x8 pixels, in values of the clipped and
            encoded picture from 0 to 1, at the exposure rounded to a whole stop. 0 for none.
        tiled: give neighbouring pixels different ray patterns: noise instead of ghosts.
        connections: carry what is small, bright and blurred to the pixels of its blurred image along single rays; False leaves
            it to the lens rays, for exact comparisons.
        wavelengths: traced through a lens with colour errors: 3 is one for each channel, more a smoother spectrum.
        motion: moments of the shutter's opening that are sampled; 1 stops all motion at the frame's own time.
        motion_by: one of `MOTIONS`: ``moments`` peels the scene at each of them, which is exact; ``velocities`` peels it once and
            moves surfaces along straight paths, which is many times faster.
        aovs: names of `render.model.aovs`; ``color`` is always there.
        deep: make samples in depth (`render.model.deep`), in place of mattes. With ``connections``, the light that these carry
            is in the samples of the background.
    """

    width: int = 960
    height: int = 540
    engine: str = "lens"
    rays: int = 100
    layers: int = 4
    supersample: float = 0
    shading: str = "lit"
    seed: int = 0
    adaptive: bool = True
    noise: float = 0.0
    tiled: bool = True
    connections: bool = True
    wavelengths: int = 3
    motion: int = 1
    motion_by: str = "moments"
    aovs: tuple[str, ...] = ("color",)
    deep: bool = False

    def __post_init__(self) -> None:
        check_picture_size(self.width, self.height)
        _check_choice("shading", self.shading, SHADINGS)
        _check_range("rays", self.rays, 1, MAX_RAYS)
        _check_range("layers", self.layers, 1, MAX_LAYERS)
        if self.supersample != 0:
            _check_range("supersample", self.supersample, 1, MAX_SUPERSAMPLE)
        _check_range("wavelengths", self.wavelengths, 1, MAX_WAVELENGTHS)
        _check_range("motion", self.motion, 1, MAX_MOTION)
        if self.noise != 0:
            _check_range("noise", self.noise, LEAST_NOISE, MOST_NOISE)
        _check_choice("motion_by", self.motion_by, MOTIONS)
        _check_range("seed", self.seed, 0, 2**31 - 1)
        for aov in self.aovs:
            check_aov(aov)

    @property
    def is_adaptive(self) -> bool:
        """True where rays are distributed over the picture, if all of them are drawn at once."""
        return self.tiled and (self.noise > 0 or (self.adaptive and self.rays >= ADAPTIVE_RAYS))


def _check_choice(name: str, value: str, known: tuple[str, ...]) -> None:
    if value not in known:
        raise SettingsError(f"{name} must be one of {', '.join(known)}, got {value!r}")


def _check_range(name: str, value: float, low: float, high: float) -> None:
    if not low <= value <= high:
        raise SettingsError(f"{name} must be from {low} to {high}, got {value}")
