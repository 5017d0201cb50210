"""Render index: a `Scene` as pyrender's scene graph, updated in place so that only changes are uploaded."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from render.gl.compat import GL, pyrender
from render.layers.bounds import BoxCache
from render.layers.clusters import ClusterIndex
from render.layers.materials import HalfTexture, PreviewSurface
from render.model.arrays import DoubleArray, FloatArray, IndexArray, IntArray
from render.model.scene import Batch, Geometry, Image, Material, Scene, Wrap

DrawKey = tuple[int, int, int, bool]
"""Ids of geometry and material, the number among draws with the same two, and whether the draw is mirrored."""
_FIRST_VALUES = (
    4  # further numbers of a vertex in pyrender's attribute for tangents; the others are in its second coordinates
)
_POSE_BUFFER = 1  # index among the buffers of pyrender's primitive: vertices, poses, indices
CachedNode = tuple[pyrender.Node, tuple[object, ...]]
"""Node, and the objects whose ids its key holds: kept alive so that no new object gets their id."""
Nodes = dict[DrawKey, CachedNode]


@dataclass(frozen=True)
class Draw:
    """One instanced draw of the index.

    Attributes:
        node: pyrender's node; its mesh has one primitive.
        batch: batch that is drawn.
        instances: ``(k,)`` indices of the batch's poses, in the order of the draw's instances.
        first_object: the object number of its first instance; ids in layers are object numbers.
        mirrored: whether its poses reverse the triangles' winding.
        has_backs: whether back faces are drawn for every view.
        insides: ``(n, 2, 3)`` least and greatest corners of boxes in the world, metres: back faces are drawn for views from
            within one of them; None where ``has_backs`` holds for every view.
        corners: ``(n, 3)`` corners of its bounding boxes in the world, metres.
        may_be_transparent: whether a fragment may be wholly or partly transparent.
        may_be_translucent: whether a fragment may be partly transparent; cut-outs are not.
    """

    node: pyrender.Node
    batch: Batch
    instances: IndexArray
    first_object: int
    mirrored: bool
    has_backs: bool
    insides: DoubleArray | None
    corners: DoubleArray
    may_be_transparent: bool
    may_be_translucent: bool


class SceneIndex:
    """pyrender's scene for a `Scene`; unchanged objects are kept on the device.

    Objects are recognised by identity: the same `Geometry`, `Material`, `Image` object is uploaded once.
    """

    def __init__(self, anisotropy: float = 1.0) -> None:
        """Create an empty index; ``anisotropy`` is the largest number of samples of an anisotropic texture look-up."""
        self._anisotropy = anisotropy
        self.graph = pyrender.Scene(ambient_light=np.zeros(3))
        self.draws: list[Draw] = []
        self._nodes: Nodes = {}
        self._materials: dict[int, tuple[PreviewSurface, Material]] = {}
        self._textures: dict[tuple[int, Wrap, Wrap], HalfTexture] = {}
        self.boxes = BoxCache()
        self.clusters = ClusterIndex()
        self._faded: dict[int, tuple[Geometry, bool]] = {}
        self._scene: Scene | None = None

    def update(self, scene: Scene) -> None:
        """Update the graph to ``scene``."""
        if scene is self._scene:
            return
        kept: Nodes = {}
        self.draws = []
        first_object = 0
        for batch in scene.batches:
            for mirrored, instances in _by_handedness(batch.poses):
                node = self.node(batch, instances, mirrored, self._nodes, kept)
                corners = self.boxes.corners(batch)
                clear, cut_out = self._may_be_transparent(batch), batch.material.opacity_threshold > 0
                is_solid = batch.has_backs and batch.insides is not None and not clear
                self.draws.append(
                    Draw(
                        node,
                        batch,
                        instances,
                        first_object,
                        mirrored,
                        batch.has_backs and not is_solid,
                        self.boxes.insides(batch)[instances].reshape(-1, 2, 3) if is_solid else None,
                        corners,
                        may_be_transparent=clear,
                        may_be_translucent=clear and not cut_out,
                    )
                )
                first_object += len(instances)
        self.remove_nodes(self._nodes, kept)
        self._nodes = kept
        self.boxes.forget(scene.batches)
        self.clusters.update(self.draws)
        self._forget_unused()
        self._scene = scene

    @property
    def textures(self) -> list[HalfTexture]:
        """Textures of the draws' materials."""
        return list(self._textures.values())

    def texture_of(self, material: Material, name: str) -> HalfTexture | None:
        """Texture of an input of a drawn material; None where it has none."""
        return self._materials[id(material)][0].maps.get(name)

    def locate(self, object_number: int) -> tuple[Batch, int]:
        """Batch and pose index of an object number that a layer holds."""
        for draw in self.draws:
            offset = object_number - draw.first_object
            if 0 <= offset < len(draw.instances):
                return draw.batch, int(draw.instances[offset])
        raise IndexError(f"no object {object_number}")

    def node(self, batch: Batch, instances: IndexArray, mirrored: bool, before: Nodes, kept: Nodes) -> pyrender.Node:
        """Node in the graph that draws some instances: the one that drew them before, moved, or a new one.

        Args:
            batch: batch that is drawn, of a material of the index.
            instances: ``(k,)`` indices of its poses.
            mirrored: whether they reverse the triangles' winding.
            before: nodes of an earlier list of draws.
            kept: nodes of the new list so far, to which this one is added.
        """
        times = 0
        while (key := (id(batch.geometry), id(batch.material), times, mirrored)) in kept:
            times += 1
        if key in before:
            node = before[key][0]
        else:
            node = pyrender.Node(mesh=pyrender.Mesh([self._primitive(batch)]))
            self.graph.add_node(node)
        kept[key] = (node, (batch.geometry, batch.material))
        self._set_poses(node, batch.poses[instances])
        return node

    def remove_nodes(self, before: Nodes, kept: Nodes) -> None:
        """Remove those nodes from the graph that are not kept."""
        for key in before.keys() - kept.keys():
            self.graph.remove_node(before[key][0])

    def _may_be_transparent(self, batch: Batch) -> bool:
        m, colors, instances = batch.material, batch.geometry.colors, batch.instance_colors
        if m.uses_display_color and instances is not None and (instances[:, 3] < 1).any():
            return True
        if m.uses_display_color and colors is not None:
            if id(batch.geometry) not in self._faded:
                self._faded[id(batch.geometry)] = (batch.geometry, bool((colors[:, 3] < 1).any()))
            if self._faded[id(batch.geometry)][1]:
                return True
        return m.may_be_transparent

    def _set_poses(self, node: pyrender.Node, poses: DoubleArray) -> None:
        """Set the poses of a node's instances.

        pyrender keeps instances' poses in float32, so they are relative to the position of the first instance, which is
        the node's own pose. A matrix is never passed to a Node's constructor: pyrender would decompose it and lose
        mirrors and shears.
        """
        primitive: LargePrimitive = node.mesh.primitives[0]
        if len(poses) == 1:
            primitive.set_poses(None)
            self.graph.set_pose(node, poses[0])
            return
        origin = np.eye(4)
        origin[:3, 3] = poses[0, :3, 3]
        relative = poses.copy()
        relative[:, :3, 3] -= origin[:3, 3]
        primitive.set_poses(relative.astype(np.float32))
        self.graph.set_pose(node, origin)

    def _primitive(self, batch: Batch) -> LargePrimitive:
        g: Geometry = batch.geometry
        return LargePrimitive(
            positions=g.positions,
            normals=g.normals,
            texcoord_0=g.uvs,
            color_0=g.colors,
            tangents=None if g.values is None else g.values[:, :_FIRST_VALUES],
            texcoord_1=None if g.values is None else g.values[:, _FIRST_VALUES:],
            indices=g.triangles,
            material=self._material(batch.material),
        )

    def _material(self, material: Material) -> PreviewSurface:
        if id(material) not in self._materials:
            maps = {
                name: self._texture(look.image, look.wrap_s, look.wrap_t) for name, look in material.lookups.items()
            }
            self._materials[id(material)] = (PreviewSurface(material, maps), material)
        return self._materials[id(material)][0]

    def _texture(self, image: Image, wrap_s: Wrap, wrap_t: Wrap) -> HalfTexture:
        key = (id(image), wrap_s, wrap_t)
        if key not in self._textures:
            self._textures[key] = HalfTexture(image, wrap_s, wrap_t, self._anisotropy)
        return self._textures[key]

    def _forget_unused(self) -> None:
        """Drop materials and textures that no draw uses, so that memory does not grow over a long session."""
        used = {id(draw.batch.material) for draw in self.draws}
        drawn = {id(draw.batch.geometry) for draw in self.draws}
        self._faded = {key: value for key, value in self._faded.items() if key in drawn}
        self._materials = {key: value for key, value in self._materials.items() if key in used}
        images = {id(texture.image) for surface, _ in self._materials.values() for texture in surface.textures}
        self._textures = {key: value for key, value in self._textures.items() if key[0] in images}


class LargePrimitive(pyrender.Primitive):  # type: ignore[misc]
    """Primitive with exact indices, whose instances can move after the upload. pyrender stores indices as float32."""

    poses: FloatArray | None

    def set_poses(self, poses: FloatArray | None) -> None:
        """Set the poses of the instances, ``(k, 4, 4)``, or None for one at the node."""
        if poses is None and self.poses is None:
            return
        if poses is not None and self.poses is not None and np.array_equal(poses, self.poses):
            return
        self.poses = poses
        if self._in_context():
            data = np.eye(4, dtype=np.float32)[None] if poses is None else poses
            GL.glBindBuffer(GL.GL_ARRAY_BUFFER, self._buffers[_POSE_BUFFER])
            columns = np.ascontiguousarray(data.transpose(0, 2, 1))
            GL.glBufferData(GL.GL_ARRAY_BUFFER, columns.nbytes, columns, GL.GL_STATIC_DRAW)
            GL.glBindBuffer(GL.GL_ARRAY_BUFFER, 0)

    @property
    def indices(self) -> NDArray[np.uint32] | None:
        """``(m, 3)`` uint32."""
        return self._indices

    @indices.setter
    def indices(self, value: IntArray | None) -> None:
        self._indices = None if value is None else np.ascontiguousarray(value, np.uint32)


def _by_handedness(poses: DoubleArray) -> list[tuple[bool, IndexArray]]:
    """Indices of the poses that keep a triangle's winding, then of those that mirror it; empty groups left out."""
    mirrored = np.linalg.det(poses[:, :3, :3]) < 0
    groups = [(False, np.flatnonzero(~mirrored)), (True, np.flatnonzero(mirrored))]
    return [(flag, indices) for flag, indices in groups if len(indices)]
