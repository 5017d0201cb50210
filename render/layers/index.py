"""The render index: a `Scene` as pyrender's scene graph, updated in place so that only what changed is uploaded."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from render.gl.compat import pyrender
from render.layers.bounds import BoxCache
from render.layers.materials import HalfTexture, PreviewSurface
from render.optics.view import PinholeView
from render.scene import Batch, DoubleArray, Geometry, Image, IntArray, Material, Scene, Wrap

IndexArray = NDArray[np.intp]
DrawKey = tuple[int, int, int, bool]
"""Identities of geometry and material, then of the poses (or the batch's place, where one pose may move), mirrored."""
HeldNode = tuple[pyrender.Node, tuple[object, ...]]
"""A node, and the objects whose identities its key holds: kept so that no new object gets their id."""


class ViewCamera(pyrender.Camera):  # type: ignore[misc]
    """A pyrender camera whose projection is a `PinholeView`."""

    def __init__(self, view: PinholeView) -> None:
        super().__init__(znear=view.near_m, zfar=None if np.isinf(view.far_m) else view.far_m, name="view")
        self.view = view

    def get_projection_matrix(self, width: int | None = None, height: int | None = None) -> DoubleArray:
        """``(4, 4)``; the view knows its own size."""
        return self.view.projection_matrix()


@dataclass(frozen=True)
class Draw:
    """One instanced draw of the index.

    Attributes:
        node: pyrender's node; its mesh has one primitive.
        batch: what it came from.
        instances: ``(k,)`` indices of the batch's poses, in the order of the draw's instances.
        first_object: the object number of its first instance; ids in layers are object numbers.
        mirrored: whether its poses turn the triangles' winding around.
        double_sided: whether back faces are drawn.
        corners: ``(n, 3)`` of boxes around what it draws, world, metres.
    """

    node: pyrender.Node
    batch: Batch
    instances: IndexArray
    first_object: int
    mirrored: bool
    double_sided: bool
    corners: DoubleArray


class SceneIndex:
    """Holds pyrender's scene for a `Scene` and keeps what has not changed.

    Objects are recognised by identity: the same `Geometry`, `Material`, `Image` object is uploaded once.
    """

    def __init__(self, anisotropy: float = 1.0) -> None:
        """``anisotropy``: most samples of an anisotropic texture look-up."""
        self._anisotropy = anisotropy
        self.graph = pyrender.Scene(ambient_light=np.zeros(3))
        self.draws: list[Draw] = []
        self._nodes: dict[DrawKey, HeldNode] = {}
        self._materials: dict[int, tuple[PreviewSurface, Material]] = {}
        self._textures: dict[tuple[int, Wrap, Wrap], HalfTexture] = {}
        self._boxes = BoxCache()
        self._camera: pyrender.Node | None = None
        self._scene: Scene | None = None

    def update(self, scene: Scene) -> None:
        """Make the graph show ``scene``."""
        if scene is self._scene:
            return
        self._scene = scene
        kept: dict[DrawKey, HeldNode] = {}
        self.draws = []
        first_object = 0
        for number, batch in enumerate(scene.batches):
            for mirrored, instances in _by_handedness(batch.poses):
                place = number if len(instances) == 1 else id(batch.poses)
                key = (id(batch.geometry), id(batch.material), place, mirrored)
                node = self._node(batch, instances, key, kept)
                corners = self._boxes.corners(batch)
                self.draws.append(Draw(node, batch, instances, first_object, mirrored, batch.double_sided, corners))
                first_object += len(instances)
        for key in self._nodes.keys() - kept.keys():
            self.graph.remove_node(self._nodes[key][0])
        self._nodes = kept
        self._boxes.forget(scene.batches)
        self._forget_unused()

    def look_through(self, view: PinholeView) -> None:
        """Put the graph's main camera at ``view``."""
        if self._camera is None:
            self._camera = self.graph.add(ViewCamera(view), pose=np.eye(4))
            self.graph.main_camera_node = self._camera
        self._camera.camera.view = view
        self.graph.set_pose(self._camera, np.linalg.inv(view.camera_from_world))

    def locate(self, object_number: int) -> tuple[Batch, int]:
        """The batch and pose index of an object number that a layer holds."""
        for draw in self.draws:
            offset = object_number - draw.first_object
            if 0 <= offset < len(draw.instances):
                return draw.batch, int(draw.instances[offset])
        raise IndexError(f"no object {object_number}")

    def _node(
        self,
        batch: Batch,
        instances: IndexArray,
        key: DrawKey,
        kept: dict[DrawKey, HeldNode],
    ) -> pyrender.Node:
        """The node that draws some of a batch's instances: an old one moved, where only its pose changed."""
        single = len(instances) == 1
        found = self._nodes.get(key)
        if found is not None and key not in kept:
            node, owners = found
            kept[key] = (node, owners)
            if single:
                self.graph.set_pose(node, batch.poses[instances[0]])
            return node
        pose = batch.poses[instances[0]] if single else np.eye(4)
        mesh = pyrender.Mesh([self._primitive(batch, None if single else batch.poses[instances])])
        node = pyrender.Node(mesh=mesh)
        self.graph.add_node(node)
        self.graph.set_pose(node, pose)  # a matrix given to the Node is decomposed, and mirrors and shears are lost
        kept[key] = (node, (batch.geometry, batch.material, batch.poses))  # owners keep the ids in the key from reuse
        return node

    def _primitive(self, batch: Batch, poses: DoubleArray | None) -> pyrender.Primitive:
        g: Geometry = batch.geometry
        return LargePrimitive(
            positions=g.positions,
            normals=g.normals,
            texcoord_0=g.uvs,
            color_0=g.colors,
            indices=g.triangles,
            material=self._material(batch.material),
            poses=poses,
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
        """Drop materials and textures that no draw uses, so that a long session does not grow."""
        used = {id(draw.batch.material) for draw in self.draws}
        self._materials = {key: value for key, value in self._materials.items() if key in used}
        images = {id(texture.image) for surface, _ in self._materials.values() for texture in surface.textures}
        self._textures = {key: value for key, value in self._textures.items() if key[0] in images}


class LargePrimitive(pyrender.Primitive):  # type: ignore[misc]
    """A primitive that keeps its indices whole: pyrender stores them as float32, which is wrong from 2^24 vertices on."""

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
