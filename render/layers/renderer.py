"""pyrender's renderer with our shaders: draws the render index into one layer, or into a shadow map."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass

import moderngl
import numpy as np

from render.errors import RefusedProgramError
from render.gl.cancellation import NEVER_CANCELLED, CancellationPoint
from render.gl.compat import CLIP_NEGATIVE_ONE_TO_ONE, CLIP_ZERO_TO_ONE, GL, pyrender, set_clip_depth
from render.gl.shaders import ProgramCache
from render.layers.clusters import DrawRange
from render.layers.draw_splitter import DrawSplitter
from render.layers.drawing_space import DrawingSpace
from render.layers.hidden import HiddenMeasurer
from render.layers.index import Draw, SceneIndex
from render.layers.instance_colors import InstanceColors
from render.layers.levels.sketch_index import SketchIndex
from render.layers.light_links import LinkSets
from render.layers.materials import PreviewSurface
from render.layers.moving_draws import MovingDraws
from render.layers.selection import ClusterSelection, DrawnRanges
from render.layers.shadows import MAX_SHADOW_MAPS
from render.layers.source_program import SourceProgram
from render.layers.surface_sampling import PLAIN, SurfaceSampling
from render.layers.targets import MOST_RADIANCE, Slot
from render.model.arrays import DoubleArray, IndexArray
from render.model.limits import MAX_CLIP_PLANES
from render.model.refused_programs import REFUSED
from render.optics.view import PinholeView

OPAQUE = 0.999
"""Opacity from which a surface hides the surfaces behind it."""
_ANY_OPACITY = 1e-6
_MATERIAL_BINDING, _LIGHT_BINDING, _SHADOW_BINDING, _LINK_BINDING, _FILTER_BINDING = 1, 2, 3, 4, 5
DOME_UNIT = 9  # texture unit as the shaders bind it; materials use those below 8
_PREVIOUS_UNIT, _OWN_UNIT, _MOTION_UNIT, _REACH_UNIT, _FIRST_UNIT, _REST_UNIT = 8, 11, 12, 13, 14, 15


@dataclass(frozen=True)
class Rest:
    """Part of a pixel's surfaces that a pass is kept to: those that a peeling has no layer for (`render.layers.rest`).

    Attributes:
        last: slot of the last layer: surfaces in front of it where it is opaque, behind it where not, none where it is empty.
        light: RGBA32F; no surfaces where its alpha, the opacity of what is in front, is that of an opaque surface.
    """

    last: Slot
    light: moderngl.Texture


@dataclass(frozen=True)
class LayerPass:
    """Parameters of one pass over the scene.

    Attributes:
        view: camera and picture that it is drawn for.
        draws: draws to consider.
        slot: target that it is drawn into.
        umbra: how far behind an opaque surface its umbra reaches, in 1/m of inverse depth.
        previous: slot of the layer before; None for the first.
        solid_first: take the nearest opaque surface, and one that is partly transparent only where there is no opaque one.
        unlit: take the base colour as radiance.
        sampling: how finely the finished picture samples surfaces.
        number: index of the layer, from 0.
        moving: buffers of the moving draws; None where the layers keep no motion.
        motion: texture array that receives the motion; None where the layers keep none.
        reach: bound on what rays meet behind the previous layer (`render.layers.reach`); None where all surfaces are drawn.
        most_opaque: draw nothing where the previous layers have this many opaque surfaces; 0 draws everywhere.
        first: slot of the first layer, where ``most_opaque`` is not 0.
        rest: draw those surfaces alone that a peeling has no layer for; None for a layer.
        is_sketch: draw simpler levels of what is far away (`render.layers.levels`); the draws are those of the sketches' index.
    """

    view: PinholeView
    draws: list[Draw]
    slot: Slot
    umbra: float = 0.0
    previous: Slot | None = None
    solid_first: bool = False
    unlit: bool = False
    sampling: SurfaceSampling = PLAIN
    number: int = 0
    moving: MovingDraws | None = None
    motion: moderngl.TextureArray | None = None
    reach: moderngl.Texture | None = None
    most_opaque: int = 0
    first: Slot | None = None
    rest: Rest | None = None
    is_sketch: bool = False


class LayerRenderer(pyrender.renderer.Renderer):  # type: ignore[misc]
    """Draws a `SceneIndex` with ``layers/surface.vert``, and ``layers/depth.frag`` before ``layers/surface.frag``.

    pyrender keeps the meshes and textures in the context (`_update_context`) and draws the primitives with their
    instances; programs, materials, lights and targets are bound here.
    """

    def __init__(
        self,
        index: SceneIndex,
        sketches: SketchIndex,
        ctx: moderngl.Context,
        programs: ProgramCache,
        cancellation: CancellationPoint = NEVER_CANCELLED,
    ) -> None:
        super().__init__(1, 1)
        self._splitter = DrawSplitter(cancellation)
        self._index = index
        measurer = HiddenMeasurer(ctx, programs)
        self._selection = ClusterSelection(index, measurer)
        self._sketched = ClusterSelection(sketches, measurer, sketches.choose)
        self._programs: dict[tuple[object, ...], SourceProgram] = {}
        self._blocks = GL.glGenBuffers(5)
        self._material_block, self._light_block, self._shadow_block, self._link_block, self._filter_block = self._blocks
        self.link_sets = LinkSets(())
        self._bound_material: PreviewSurface | None = None
        self._instance_colors = InstanceColors(ctx)

    def upload(self) -> None:
        """Upload new geometry and textures, and drop those that the index no longer has."""
        self._update_context(self._index.graph, 0)
        self._instance_colors.keep(self._index.draws)

    def set_lighting(self, lights: bytes, clip_from_camera: DoubleArray, links: bytes, filters: bytes) -> None:
        """Set the contents of ``LightBlock``, the ``(n, 4, 4)`` matrices of the shadow maps, and, if any, ``LinkBlock`` and
        ``FilterBlock``."""
        matrices = np.zeros((MAX_SHADOW_MAPS, 4, 4), np.float32)
        matrices[: len(clip_from_camera)] = clip_from_camera.transpose(0, 2, 1)
        _fill_uniform_buffer(self._light_block, lights, _LIGHT_BINDING)
        _fill_uniform_buffer(self._shadow_block, matrices.tobytes(), _SHADOW_BINDING)
        if links:
            _fill_uniform_buffer(self._link_block, links, _LINK_BINDING)
        if filters:
            _fill_uniform_buffer(self._filter_block, filters, _FILTER_BINDING)

    def visible_draws(self, view: PinholeView, *, is_sketch: bool = False) -> list[Draw]:
        """Draws that may reach into a view, of the sketches' index or of the render index."""
        return (self._sketched if is_sketch else self._selection).draws_in(view)

    def sketched_clusters(self, view: PinholeView) -> IndexArray:
        """Indices of the clusters of the sketches' index that a sketch draws."""
        return self._sketched.clusters_in(view)

    def draw_layer(self, layer: LayerPass) -> None:
        """Draw the nearest surfaces behind the previous layer.

        Depth is drawn first, then colour where the depth is equal: materials are expensive, and this way each pixel's is
        evaluated once, however many surfaces lie behind it. Light is added later (`render.layers.shading`).
        """
        umbra = layer.umbra if layer.moving is None else 0.0  # where surfaces move apart, it may be cut short
        selection = self._sketched if layer.is_sketch else self._selection
        drawn = selection.ranges(layer.view, layer.draws, layer.previous, umbra, layer.reach)
        faded = [one for one in drawn if one.draw.may_be_translucent] if layer.solid_first else []
        try:
            self._draw_pass(layer, drawn, OPAQUE if faded else _ANY_OPACITY)
            if faded:
                self._draw_pass(layer, faded, _ANY_OPACITY, fill=True)
        except RefusedProgramError:
            self._refuse_others(unlit=layer.unlit)
            raise
        finally:
            self._end()

    def _draw_pass(
        self, layer: LayerPass, drawn: list[DrawnRanges], least_opacity: float, *, fill: bool = False
    ) -> None:
        """Draw fragments of at least ``least_opacity``; ``fill`` keeps to pixels in which the layer is empty."""
        self._begin(layer.view.width, layer.view.height, len(layer.view.clip_planes))
        self._draw_depths(layer, drawn, least_opacity, fill=fill)
        layer.slot.begin_colour(fill=fill)
        self._draw_colours(layer, drawn, least_opacity)

    def _draw_depths(
        self, layer: LayerPass, drawn: list[DrawnRanges], least_opacity: float, *, fill: bool = False
    ) -> None:
        view = layer.view
        space = DrawingSpace.of_view(view)
        previous = layer.previous or layer.slot  # the first layer's programs do not read it
        previous.w.use(_PREVIOUS_UNIT)
        own = layer.slot if layer.rest is None else layer.rest.last
        own.w.use(_OWN_UNIT)
        if layer.rest is not None:
            layer.rest.light.use(_REST_UNIT)
        if layer.reach is not None:
            layer.reach.use(_REACH_UNIT)
        if layer.first is not None:
            layer.first.w.use(_FIRST_UNIT)
        layer.slot.begin_depth()
        for draw, ranges, shows_backs in drawn:
            program = self._depth_program(
                draw,
                least_opacity,
                peel=layer.previous is not None,
                reach=layer.reach is not None,
                counted=layer.first is not None,
                fill=fill,
                rest=layer.rest is not None,
                moving=layer.moving,
                clip_planes=len(view.clip_planes),
            )
            GL.glUseProgram(program._program_id)
            self._set_motion(program, draw, layer)
            GL.glUniform1f(program.location("umbra"), layer.umbra)
            GL.glUniform1i(program.location("previous_channel"), previous.channel)
            GL.glUniform1i(program.location("most_opaque"), layer.most_opaque)
            GL.glUniform1i(program.location("packs"), 1 if layer.first is None or layer.first.w is previous.w else 2)
            GL.glUniform1i(program.location("own_channel"), own.channel)
            GL.glUniform1f(program.location("detail"), layer.sampling.detail)
            self._bind_draw(draw, program, space, cull=not shows_backs)
            for share in self._splitter.split_depth(ranges):
                self._draw_range(program, share)

    def _draw_colours(self, layer: LayerPass, drawn: list[DrawnRanges], least_opacity: float) -> None:
        view = layer.view
        space = DrawingSpace.of_view(view)
        GL.glDepthFunc(GL.GL_EQUAL)
        GL.glDepthMask(False)
        for draw, ranges, shows_backs in drawn:
            program = self._surface_program(
                draw, least_opacity, unlit=layer.unlit, moving=layer.moving, clip_planes=len(view.clip_planes)
            )
            GL.glUseProgram(program._program_id)
            self._set_motion(program, draw, layer)
            GL.glUniform1ui(program.location("first_object"), draw.first_object)
            if self.link_sets.is_linked:
                GL.glUniform1ui(program.location("link_set"), self.link_sets.number(draw.batch))
            GL.glUniform1i(program.location("is_holdout"), draw.batch.camera_role == "holdout")
            GL.glUniform1f(program.location("detail"), layer.sampling.detail)
            GL.glUniform1f(program.location("patch_px_m"), layer.sampling.patch_px_m)
            GL.glUniform3f(program.location("focus"), *layer.sampling.focus)
            self._bind_draw(draw, program, space, cull=not shows_backs)
            for share in self._splitter.split(draw, ranges, view):
                self._draw_range(program, share)

    def _set_motion(self, program: SourceProgram, draw: Draw, layer: LayerPass) -> None:
        """Set a program's motion buffers and uniforms for a draw."""
        if layer.moving is None or layer.motion is None:
            return
        view = layer.view
        layer.moving.bind(draw)
        layer.motion.use(_MOTION_UNIT)
        GL.glUniform2f(program.location("layer_axis"), view.cx, view.cy)
        GL.glUniform2f(program.location("layer_focal"), view.fx, view.fy)
        GL.glUniform1f(program.location("nearest_m"), view.near_m)
        GL.glUniform1i(program.location("previous_layer"), layer.number - 1)

    def draw_shadow(self, side_px: int, clip_from_world: DoubleArray, draws: Sequence[Draw]) -> None:
        """Draw the depth of draws into the bound shadow map; fragments of at most half opacity cast no shadow."""
        self._begin(side_px, side_px)
        space = DrawingSpace(np.eye(4), clip_from_world, (0.0, 0.0, 0.0), ())
        try:
            for draw, ranges, shows_backs in self._selection.shadow_ranges(clip_from_world, draws):
                program = self._depth_program(draw, 0.5, peel=False)
                GL.glUseProgram(program._program_id)
                GL.glUniform1f(program.location("detail"), 1.0)
                self._bind_draw(draw, program, space, cull=not shows_backs)
                for share in self._splitter.split_depth(ranges):
                    self._draw_range(program, share)
        except RefusedProgramError:
            self._refuse_others(unlit=False)
            raise
        finally:
            self._end()

    def delete(self) -> None:
        """Release everything that was uploaded."""
        super().delete()
        self._selection.release()
        self._sketched.release()
        self._instance_colors.release()
        for program in self._programs.values():
            program.delete()
        self._programs = {}
        GL.glDeleteBuffers(len(self._blocks), self._blocks)

    def __del__(self) -> None:
        """Do nothing: pyrender's own would free names that may belong to another renderer by now. The owner calls `delete`."""

    def _bind_draw(self, draw: Draw, program: SourceProgram, space: DrawingSpace, *, cull: bool) -> None:
        """Prepare one primitive for drawing. Its pose is multiplied in float64, for precision far from the origin."""
        primitive = draw.node.mesh.primitives[0]
        camera_from_node = (space.from_world @ self._index.graph.get_pose(draw.node)).astype(np.float32)
        GL.glUniformMatrix4fv(program.location("camera_from_node"), 1, GL.GL_TRUE, camera_from_node)
        GL.glUniformMatrix4fv(program.location("clip_from_camera"), 1, GL.GL_TRUE, space.clip.astype(np.float32))
        GL.glUniform2f(program.location("w_of_depth"), *space.w_of_depth)
        GL.glUniform1f(program.location("eye_z"), space.eye[2])
        if draw.batch.material.graph is not None:
            world = np.linalg.inv(space.from_world).astype(np.float32)
            GL.glUniformMatrix4fv(program.location("world_from_camera"), 1, GL.GL_TRUE, world)
            GL.glUniform1f(program.location("handedness"), -1.0 if draw.mirrored else 1.0)
        self._instance_colors.bind(draw)
        if space.clip_planes:
            planes = np.array(space.clip_planes, np.float32)
            GL.glUniform4fv(program.location("clip_planes"), len(planes), planes)
        self._bind_material(primitive.material)
        GL.glUniform1i(program.location("double_sided"), draw.batch.double_sided)
        # the picture's rows go down, which turns every triangle's winding around
        GL.glFrontFace(GL.GL_CCW if draw.mirrored else GL.GL_CW)
        (GL.glEnable if cull else GL.glDisable)(GL.GL_CULL_FACE)
        primitive._bind()

    def _draw_range(self, program: SourceProgram, share: DrawRange) -> None:
        """Draw a range of the prepared primitive. The shader's counts start at 0 in each range."""
        GL.glUniform1ui(program.location("first_triangle"), share.first_triangle)
        GL.glUniform1i(program.location("first_instance"), share.first_instance)
        GL.glDrawElementsInstancedBaseInstance(
            GL.GL_TRIANGLES,
            3 * share.triangles,
            GL.GL_UNSIGNED_INT,
            ctypes.c_void_p(3 * 4 * share.first_triangle),
            share.instances,
            share.first_instance,
        )

    def _bind_material(self, material: PreviewSurface) -> None:
        if material is self._bound_material:
            return
        self._bound_material = material
        _fill_uniform_buffer(self._material_block, material.block, _MATERIAL_BINDING)
        for unit, texture in zip(material.units, material.maps.values(), strict=True):
            GL.glActiveTexture(GL.GL_TEXTURE0 + unit)
            texture._bind()

    def _depth_program(
        self,
        draw: Draw,
        least_opacity: float,
        *,
        peel: bool,
        reach: bool = False,
        counted: bool = False,
        fill: bool = False,
        rest: bool = False,
        moving: MovingDraws | None = None,
        clip_planes: int = 0,
    ) -> SourceProgram:
        """Program of the depth pass. For opaque draws it reads no material, so that early depth tests work."""
        defines: dict[str, object] = {"PEEL": 1} if peel else {}
        if clip_planes:
            defines["CLIP_PLANES"] = clip_planes
        if reach:
            defines["REACH"] = 1
        if counted:
            defines["MOST_OPAQUE"] = 1
        if fill:
            defines["FILL"] = 1
        if rest:
            defines["REST"] = 1
        if moving is not None:
            defines |= moving.defines(draw)
        if draw.may_be_transparent:
            defines |= {"MAY_BE_TRANSPARENT": 1, "LEAST_OPACITY": least_opacity}
        return self._program("layers/depth.frag", draw, defines)

    def _surface_program(
        self, draw: Draw, least_opacity: float, *, unlit: bool, moving: MovingDraws | None, clip_planes: int
    ) -> SourceProgram:
        defines: dict[str, object] = {"UNLIT": 1} if unlit else {}
        if draw.batch.material.unlit:
            defines["OWN_LIGHT"] = 1
        if self.link_sets.is_linked and not unlit:
            defines["LINKED"] = 1
        if clip_planes:
            defines["CLIP_PLANES"] = clip_planes
        if moving is not None:
            defines |= moving.defines(draw)
        if draw.may_be_transparent:
            defines |= {"MAY_BE_TRANSPARENT": 1, "LEAST_OPACITY": least_opacity}
        return self._program("layers/surface.frag", draw, defines)

    def _refuse_others(self, *, unlit: bool) -> None:
        """Compile the other networks of the scene, so that a picture is begun anew once, not for each that the driver refuses."""
        tried = {""}
        for draw in self._index.draws:
            functions = draw.node.mesh.primitives[0].material.functions
            if functions not in tried and REFUSED.reason(functions) is None:
                tried.add(functions)
                with suppress(RefusedProgramError):
                    self._surface_program(draw, _ANY_OPACITY, unlit=unlit, moving=None, clip_planes=0)

    def _program(self, fragment: str, draw: Draw, defines: dict[str, object]) -> SourceProgram:
        primitive = draw.node.mesh.primitives[0]
        material: PreviewSurface = primitive.material
        maps = tuple((f"{name}_map", unit) for name, unit in zip(material.maps, material.units, strict=True))
        key: tuple[object, ...] = (
            fragment,
            maps,
            material.functions,
            tuple(material.defines.items()),
            primitive.texcoord_0 is None,
            primitive.color_0 is None,
            primitive.tangents is None,
        )
        if draw.batch.instance_colors is not None:
            defines["INSTANCE_COLORS"] = 1
        key += tuple(sorted(defines.items()))
        if key not in self._programs:
            attributes = ["NORMAL_LOC"]
            attributes += ["VALUES_0_LOC"] * (primitive.tangents is not None)
            attributes += ["TEXCOORD_0_LOC"] * (primitive.texcoord_0 is not None)
            attributes += ["VALUES_1_LOC"] * (primitive.texcoord_1 is not None)
            attributes += ["COLOR_0_LOC"] * (primitive.color_0 is not None) + ["INST_M_LOC"]
            constants = {"OPAQUE": OPAQUE, "MAX_HALF": MOST_RADIANCE}
            places = {name: place for place, name in enumerate(attributes, start=1)}
            all_defines = {**constants, **places, **material.defines, **defines}
            self._programs[key] = SourceProgram(fragment, all_defines, maps, material.functions)
        return self._programs[key]

    def _begin(self, width: int, height: int, clip_planes: int = 0) -> None:
        self._bound_material = None
        for i in range(clip_planes):
            GL.glEnable(GL.GL_CLIP_DISTANCE0 + i)
        set_clip_depth(CLIP_ZERO_TO_ONE)
        GL.glViewport(0, 0, width, height)
        GL.glEnable(GL.GL_DEPTH_TEST)
        GL.glDepthFunc(GL.GL_GREATER)
        GL.glDepthMask(GL.GL_TRUE)
        GL.glDisable(GL.GL_BLEND)
        GL.glCullFace(GL.GL_BACK)
        GL.glPolygonMode(GL.GL_FRONT_AND_BACK, GL.GL_FILL)

    def _end(self) -> None:
        """Restore the state that moderngl expects."""
        GL.glColorMask(True, True, True, True)
        GL.glBindVertexArray(0)
        GL.glUseProgram(0)
        for i in range(MAX_CLIP_PLANES):
            GL.glDisable(GL.GL_CLIP_DISTANCE0 + i)
        GL.glDisable(GL.GL_CULL_FACE)
        GL.glDisable(GL.GL_DEPTH_TEST)
        GL.glFrontFace(GL.GL_CCW)
        set_clip_depth(CLIP_NEGATIVE_ONE_TO_ONE)


def _fill_uniform_buffer(buffer: int, data: bytes, binding: int) -> None:
    GL.glBindBuffer(GL.GL_UNIFORM_BUFFER, buffer)
    GL.glBufferData(GL.GL_UNIFORM_BUFFER, len(data), data, GL.GL_DYNAMIC_DRAW)
    GL.glBindBufferBase(GL.GL_UNIFORM_BUFFER, binding, buffer)
    GL.glBindBuffer(GL.GL_UNIFORM_BUFFER, 0)
