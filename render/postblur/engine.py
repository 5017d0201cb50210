"""Single-image engines: one peeling from the pupil's centre, and a blur of what it shows."""

from __future__ import annotations

from dataclasses import replace

import moderngl
import numpy as np

from render.gl.held import Held
from render.gl.shaders import ProgramCache, set_uniforms
from render.layers.peel import Layers, Peeler
from render.layers.surface_sampling import sampling_of_layers
from render.layers.umbra import layers_needed, umbra_reach
from render.optics.thin_lens import pupil_radius_m
from render.optics.view import PinholeView
from render.postblur.blur_shape import BlurShape, blur_shape
from render.postblur.flag import Field, Flag
from render.scene import Camera, FloatArray
from render.trace.focal_map import FocalMaps
from render.trace.picture_focus import PictureFocus, picture_focus

SPLIT_PX = 24.0
"""Circles of confusion from this radius on are spread at less resolution, at which they are half as large to as large."""
MAX_MARGIN = 0.125
"""Of the picture's longer side, what is peeled around it at most for what it sheds into it."""
_ALIKE = 100
"""Rays of a lens whose sampling of surfaces this is like."""


class PostBlurEngine:
    """Blurs pictures of a peeler's scene, with the programs of one context."""

    def __init__(self, ctx: moderngl.Context, programs: ProgramCache) -> None:
        self._ctx, self._programs = ctx, programs
        self._maps = FocalMaps(ctx, programs)
        self._flag = Flag(ctx, programs)

    def picture(
        self,
        peeler: Peeler,
        camera: Camera,
        view: PinholeView,
        *,
        layers: int,
        supersample: float = 1.0,
        unlit: bool = False,
    ) -> FloatArray:
        """Peel the loaded scene and blur it.

        Args:
            peeler: with the scene loaded.
            camera: its iris, stop, squeeze and focus count; its lens is taken for ideal.
            view: the picture, from the pupil's centre.
            layers: at most this many layers.
            supersample: pixels that are blurred to one of the picture's along each axis, rounded up to whole ones.
            unlit: take base colour for radiance.

        Returns:
            ``(height, width, 4)`` float32, premultiplied.
        """
        fine = int(np.ceil(supersample))
        scaled = _scaled(view, fine)
        pupil_px = max(scaled.fx, scaled.fy) * pupil_radius_m(camera)
        nearest_w = peeler.nearest_w(scaled)
        w_f, pupil = picture_focus(camera, scaled).over_picture()
        most_px = float((pupil_px * pupil * np.maximum(w_f, np.abs(nearest_w - w_f))).max())
        margin = fine * int(np.ceil(min(most_px / fine, MAX_MARGIN * max(view.width, view.height))))
        wide = _widened(scaled, margin)
        reach = pupil_px * float(pupil.max())
        if peeler.is_opaque:
            layers = min(layers, layers_needed(reach, nearest_w))
        focus = picture_focus(camera, wide)
        sampling = sampling_of_layers(wide, scaled, focus.affine or (0.0, 0.0, 0.0), reach / wide.fx, _ALIKE)
        peeled = peeler.peel(wide, layers=layers, umbra=umbra_reach(reach), unlit=unlit, sampling=sampling)
        picture = self._blurred(peeled, camera, focus, pupil_px, most_px)
        inner = picture[margin : margin + scaled.height, margin : margin + scaled.width]
        return np.ascontiguousarray(inner.reshape(view.height, fine, view.width, fine, 4).mean(axis=(1, 3)))

    def _blurred(
        self, peeled: Layers, camera: Camera, focus: PictureFocus, pupil_px: float, most_px: float
    ) -> FloatArray:
        view = focus.view
        size = view.width, view.height
        with Held() as held:
            near, far, picture = (held.keep(self._ctx.texture(size, 4, dtype="f4")) for _ in range(3))
            radii = held.keep(self._ctx.texture(size, 2, dtype="f4"))
            self._collect(peeled, focus, pupil_px, most_px, near, far, radii)
            shrink = 1 << max(0, int(np.ceil(np.log2(max(most_px, 1e-9) / SPLIT_PX))))
            program = self._programs.compute("postblur_join.comp")
            sides = {}
            for channel, (name, light) in enumerate((("near", near), ("far", far))):
                shape = blur_shape(camera.iris, behind=name == "far", squeeze=camera.lens.squeeze)
                field = Field(light, radii, channel)
                sides[name], sides[f"{name}_wide"] = self._both(held, field, shape, most_px, shrink)
            for unit, (name, texture) in enumerate((sides | {"far_sharp": far, "radii": radii}).items()):
                texture.use(unit)
                set_uniforms(program, **{name: unit})
            covered = [shrink * side for side in sides["far_wide"].size]
            set_uniforms(program, is_split=shrink > 1, wide_px=tuple(covered))
            picture.bind_to_image(0, read=False, write=True)
            program.run(-(-view.width // 8), -(-view.height // 8))
            self._ctx.memory_barrier()
            return np.frombuffer(picture.read(), np.float32).reshape(view.height, view.width, 4).copy()

    def _both(
        self, held: Held, field: Field, shape: BlurShape, most_px: float, shrink: int
    ) -> tuple[moderngl.Texture, moderngl.Texture]:
        """A field blurred at its resolution, and what is spread wide at less; the same twice where nothing is."""
        split = SPLIT_PX if shrink > 1 else 0.0
        blurred = held.keep(self._ctx.texture(field.light.size, 4, dtype="f4"))
        self._flag.blur(field, shape, min(most_px, SPLIT_PX), blurred, split_px=split)
        if shrink == 1:
            return blurred, blurred
        reduced = self._flag.reduced(field, shrink, split)
        held.keep(reduced.light)
        held.keep(reduced.radii)
        wide = held.keep(self._ctx.texture(reduced.light.size, 4, dtype="f4"))
        wide.repeat_x = wide.repeat_y = False
        self._flag.blur(reduced, shape, most_px / shrink, wide)
        return blurred, wide

    def _collect(
        self,
        peeled: Layers,
        focus: PictureFocus,
        pupil_px: float,
        most_px: float,
        near: moderngl.Texture,
        far: moderngl.Texture,
        radii: moderngl.Texture,
    ) -> None:
        program = self._programs.compute("flag_collect.comp")
        targets, affine = peeled.targets, focus.affine
        sources: dict[str, moderngl.Texture | moderngl.TextureArray] = {
            "packed_w": targets.packed_w[0],
            "packed_w_far": targets.packed_w[-1],
            "radiance": targets.radiance,
            "background": targets.background,
            "focal_map": self._maps.made(focus) if affine is None else radii,
        }
        for unit, (name, texture) in enumerate(sources.items()):
            texture.use(unit)
            set_uniforms(program, **{name: unit})
        set_uniforms(program, is_mapped=affine is None, focus=affine or (0.0, 0.0, 0.0), pupil_px=pupil_px)
        set_uniforms(program, most_px=most_px, layers=peeled.count)
        for unit, texture in enumerate((near, far, radii)):
            texture.bind_to_image(unit, read=False, write=True)
        program.run(-(-near.width // 8), -(-near.height // 8))
        self._ctx.memory_barrier()

    def release(self) -> None:
        """Give the memory back."""
        self._maps.release()


def _scaled(view: PinholeView, fine: int) -> PinholeView:
    return replace(
        view,
        width=view.width * fine,
        height=view.height * fine,
        fx=view.fx * fine,
        fy=view.fy * fine,
        cx=view.cx * fine,
        cy=view.cy * fine,
    )


def _widened(view: PinholeView, margin: int) -> PinholeView:
    return replace(
        view,
        width=view.width + 2 * margin,
        height=view.height + 2 * margin,
        cx=view.cx + margin,
        cy=view.cy + margin,
    )
