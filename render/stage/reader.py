"""The stage reader: a USD stage at a time as a `Scene`, with as little remade between times as can be."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from pxr import Sdf, Tf, Usd, UsdGeom

from render.model.refused_programs import REFUSED
from render.model.scene import Batch, Dome, Scene
from render.stage.assembly.groups import DrawContext, Group
from render.stage.assembly.inventory import Inventory, take_inventory
from render.stage.assembly.level_choice import LevelChoice, LevelChooser, may_change_levels
from render.stage.assembly.pieces import ShapeReader
from render.stage.assembly.plan import PieceCutter, plan_groups
from render.stage.assembly.poses import InstanceReader
from render.stage.assembly.subdivision_levels import Levels, SubdivisionChooser
from render.stage.camera.back_plates import PlateReader
from render.stage.camera.plate_places import plate_names
from render.stage.camera_list import list_cameras
from render.stage.findings import Finding, FindingLog
from render.stage.geometry.skinning import Skeletons
from render.stage.light_links import link_surfaces
from render.stage.lights import LightReader
from render.stage.limits import MAX_DRAWN_TRIANGLES
from render.stage.materials.bindings import binding_purposes
from render.stage.materials.looks import LookReader
from render.stage.materials.textures import TextureCache
from render.stage.materials.tile_check import TileCheck
from render.stage.notes import is_note
from render.stage.opening import composition_findings, confinement, read_quietly
from render.stage.options import DEFAULT_OPTIONS, StageOptions
from render.stage.population import note_unloaded
from render.stage.render_pass import RenderPass
from render.stage.world import world_from_stage
from usd_schemas.units import metres_per_unit

if TYPE_CHECKING:
    from render.stage.assembly.splats import SplatReader


@dataclass(frozen=True, eq=False)
class _Plan:
    """State that is valid for all times, until the stage is edited."""

    inventory: Inventory
    groups: list[Group]
    looks: LookReader
    skeletons: Skeletons
    lights: LightReader
    plates: PlateReader
    levels: LevelChooser
    subdivision: SubdivisionChooser
    binding_purposes: tuple[str, ...]
    splats: SplatReader | None

    @property
    def follows_camera(self) -> bool:
        """Whether what is drawn depends on the camera."""
        return bool(self.inventory.level_roots) or self.subdivision.follows_camera


class StageReader:
    """Reads a stage into scenes.

    What does not change between two times is the same object in both scenes: geometry, images, materials and whole batches.
    An edit of the stage (other than of cameras) starts over, and keeps the images.

    Args:
        stage: the stage; it stays open while the reader lives.
        options: what is drawn, and how.
        render_pass: chooses what is drawn; None for everything.
        max_texture: width and height that no texture exceeds.
    """

    def __init__(
        self,
        stage: Usd.Stage,
        options: StageOptions = DEFAULT_OPTIONS,
        render_pass: RenderPass | None = None,
        *,
        max_texture: int = 2048,
    ) -> None:
        self._stage, self._options, self._pass = stage, options, render_pass
        self._log = FindingLog()
        composition_findings(stage, self._log)
        note_unloaded(stage, self._log)
        self._textures = TextureCache(max_texture, confined_to=confinement(stage), log=self._log)
        self._prim_ids: dict[str, int] = {}
        self._material_ids: dict[str, int] = {}
        self._plan: _Plan | None = None
        self._scene: Scene | None = None
        self._key: tuple[Usd.TimeCode, str] | None = None
        self._levels = LevelChoice()
        self._tiles = TileCheck()
        self._subdivision: Levels = {}
        self._changes = 0
        self._refused = REFUSED.count
        self._identity = object()
        self._listener = Tf.Notice.Register(Usd.Notice.ObjectsChanged, self._on_change, stage)

    @property
    def findings(self) -> list[Finding]:
        """Findings so far, each once: requests that are not honoured and parts that could not be used."""
        return self._log.as_list()

    @property
    def options(self) -> StageOptions:
        """Options of what is drawn, and how."""
        return self._options

    @property
    def changes(self) -> int:
        """Count of edits that may change what is drawn, which most edits of cameras do not; earlier results are out of date."""
        return self._changes

    def read(self, time: float, camera_path: str = "") -> Scene:
        """Read the scene at a time.

        Args:
            time: USD time code.
            camera_path: prim path of the camera that levels of detail and of subdivision are chosen for; empty for none.

        Raises:
            StageError: a transform is not finite, or a file turns out to be damaged.
        """
        at = Usd.TimeCode(time)
        if self._refused != REFUSED.count:
            self._refused = REFUSED.count
            if self._plan is not None and self._plan.looks.has_refused:  # other materials stand in for some
                self._plan = None
                self._changes += 1
        with read_quietly(self._stage):
            if self._plan is None:
                self._scene = None
                skeletons, purposes = Skeletons(self._stage), binding_purposes(self._stage, self._log)
                shapes = ShapeReader(skeletons, purposes, at, self._log)
                self._plan = self._make_plan(skeletons, purposes, shapes)
            else:
                shapes = ShapeReader(self._plan.skeletons, self._plan.binding_purposes, at, self._log)
                shapes.look = partial(self._plan.looks.look, time=at)
            key = (at, camera_path if self._plan.follows_camera else "")
            if self._scene is None or self._key != key:
                self._scene, self._key = self._scene_at(self._plan, shapes, camera_path), key
        return self._scene

    def _scene_at(self, plan: _Plan, shapes: ShapeReader, camera_path: str) -> Scene:
        time = shapes.time
        transforms, instances = UsdGeom.XformCache(time), InstanceReader(time, self._log)
        world = world_from_stage(self._stage)
        levels = plan.levels.choose(camera_path, transforms, instances)
        shapes.levels = plan.subdivision.choose(self._camera(camera_path), transforms, instances, world)
        is_same = levels.equals(self._levels) and shapes.levels == self._subdivision
        if self._scene is not None and Usd.TimeCode(self._scene.time) == time and is_same:
            return self._scene
        self._levels, self._subdivision = levels, shapes.levels
        context = DrawContext(
            transforms=transforms,
            world=world,
            scale=metres_per_unit(self._stage),
            look=lambda path: plan.looks.look(path, time),
            shapes=shapes,
            instances=instances,
            levels=levels,
            prim_id=self._prim_id,
            material_id=lambda path: self._material_ids.setdefault(path, len(self._material_ids)) if path else -1,
            log=self._log,
        )
        unread = (piece for group in plan.groups for piece in group.unread(shapes))
        shapes.prepare(piece for piece in unread if levels.may_show(piece.occurrence))
        batches = [batch for group in plan.groups for batch in group.batches(context)]
        batches = self._drop_excess(batches)
        self._tiles.note_missing(batches, list(self._prim_ids), self._log)
        batches += plan.plates.batches(transforms, context.world, context.scale, self._prim_id)
        shining = [(prim, hiders) for prim, hiders, within in plan.inventory.lights if levels.shows(within).all()]
        splats = () if plan.splats is None else plan.splats.batches(context)
        lights, dome = plan.lights.read(shining, transforms)
        if dome is not None and not self._sees_dome(dome):
            dome = replace(dome, visible=False)
        return Scene(
            tuple(batches),
            lights,
            dome,
            tuple(self._prim_ids),
            time.GetValue(),
            stage_from_world=np.asarray(np.linalg.inv(context.world), np.float64),
            lit_by=self._options.lit_by,
            material_paths=tuple(self._material_ids),
            version=(self._identity, self._changes, time, camera_path if plan.follows_camera else ""),
            splats=splats,
        )

    def _drop_excess(self, batches: list[Batch]) -> list[Batch]:
        """Leave out the batches that exceed `MAX_DRAWN_TRIANGLES`, with a finding for each."""
        drawn, total = [], 0
        for batch in batches:
            count = len(batch.geometry.triangles) * len(batch.poses)
            if total + count > MAX_DRAWN_TRIANGLES:
                path = list(self._prim_ids)[batch.geometry.prim_ids[0]]
                message = (
                    f"{path} is not drawn: its {len(batch.poses):,} instances have {count:,} triangles, and a picture has up to "
                    f"{MAX_DRAWN_TRIANGLES:,}"
                )
                self._log.add("too_many_triangles", path, message)
                continue
            total += count
            drawn.append(batch)
        return drawn

    def _sees_dome(self, dome: Dome) -> bool:
        """Whether the camera sees the dome behind all surfaces; held out, it is as black as not seen."""
        seen = self._pass is None or self._pass.camera_role(Sdf.Path(dome.path)) == "seen"
        return seen and self._options.dome_visible

    def _make_plan(self, skeletons: Skeletons, purposes: tuple[str, ...], shapes: ShapeReader) -> _Plan:
        composition_findings(self._stage, self._log)
        inventory = take_inventory(self._stage, self._options, self._pass, self._log)
        surfaces = link_surfaces(inventory.surfaces, [prim for prim, _, _ in inventory.lights], self._log)
        looks = LookReader(self._stage, self._textures, self._log)
        shapes.look = partial(looks.look, time=shapes.time)
        cutter = PieceCutter(looks, skeletons, purposes, shapes, self._options.cull_backfaces, self._log)
        groups = plan_groups(surfaces, cutter, self._log)
        self._note_up_axis()
        lights = LightReader(self._stage, self._textures, skeletons, self._log, self._options.complexity)
        levels = LevelChooser(self._stage, inventory.level_roots, self._log)
        subdivision = SubdivisionChooser(inventory.surfaces, self._options.complexity, self._log, cutter.displaced)
        return _Plan(
            inventory,
            groups,
            looks,
            skeletons,
            lights,
            self._plate_reader(),
            levels,
            subdivision,
            purposes,
            self._splat_reader(inventory),
        )

    def _splat_reader(self, inventory: Inventory) -> SplatReader | None:
        """Reader of the splats; None where there are none."""
        if not inventory.splats:
            return None
        from render.stage.assembly.splats import SplatReader  # few shots need it

        return SplatReader(inventory.splats)

    def _plate_reader(self) -> PlateReader:
        """Reader of the plates of all cameras that the mask and the render pass leave."""
        cameras = [self._stage.GetPrimAtPath(path) for path in list_cameras(self._stage)]
        shown = [camera for camera in cameras if plate_names(camera) and self._shows(camera.GetPath())]
        roles = ["seen" if self._pass is None else self._pass.camera_role(camera.GetPath()) for camera in shown]
        confined_to, culls_backs = confinement(self._stage), self._options.cull_backfaces
        plated = dict(zip(shown, roles, strict=True))
        return PlateReader(plated, confined_to, culls_backs, self._log)

    def _shows(self, path: Sdf.Path) -> bool:
        """Whether the mask and the render pass leave a prim."""
        mask = self._options.mask
        if mask is not None and not Usd.StagePopulationMask([Sdf.Path(p) for p in mask]).Includes(path):
            return False
        return self._pass is None or (self._pass.shows(path) and not self._pass.prunes(path))

    def _prim_id(self, path: str) -> int:
        return self._prim_ids.setdefault(path, len(self._prim_ids))

    def _camera(self, path: str) -> UsdGeom.Camera | None:
        camera = UsdGeom.Camera(self._stage.GetPrimAtPath(path)) if path else None
        return camera if camera else None

    def _note_up_axis(self) -> None:
        axis = UsdGeom.GetStageUpAxis(self._stage)
        if axis not in (UsdGeom.Tokens.y, UsdGeom.Tokens.z):
            self._log.add("up_axis", "/", f"upAxis must be Y or Z, got {axis!r}: Z is up, as in usdrecord")

    def _on_change(self, notice: Usd.Notice.ObjectsChanged, _sender: object) -> None:
        # The first edit below a prim creates an empty `over` for it, which USD reports without changed fields.
        info_only = [path for path in notice.GetChangedInfoOnlyPaths() if notice.GetChangedFields(path)]
        paths = [path for path in (*notice.GetResyncedPaths(), *info_only) if not is_note(path)]
        if not all(self._is_only_a_camera(path) for path in paths):
            self._plan = None
            self._changes += 1
        elif self._plan is None:
            return
        elif any(self._plan.plates.is_camera(path.GetPrimPath()) for path in paths):
            self._scene = None
            self._changes += 1
        elif self._plan.follows_camera and any(map(may_change_levels, paths)):
            self._key = None
            if self._plan.inventory.level_roots:  # levels of subdivision show the same surface
                self._changes += 1

    def _is_only_a_camera(self, path: Sdf.Path) -> bool:
        """Whether what changed is a camera that stays with, or without, back plates."""
        prim = self._stage.GetPrimAtPath(path.GetPrimPath())
        is_camera = prim and prim.IsActive() and prim.IsDefined() and prim.IsA(UsdGeom.Camera)
        if not is_camera or prim.GetChildren():
            return False
        is_known = self._plan is not None and self._plan.plates.is_camera(prim.GetPath())
        return is_known or not plate_names(prim)
