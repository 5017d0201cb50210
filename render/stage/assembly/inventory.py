"""Inventory of a stage: every visible surface, instancer and light of the requested purpose, found in one walk."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from pxr import Sdf, Tf, Usd, UsdGeom, UsdLod, UsdLux, UsdProc, UsdShade

from render.errors import StageError
from render.model.scene import UNLINKED, CameraRole, LightLinks
from render.stage.assembly.draw_modes import draw_mode, is_replaced, note_no_model
from render.stage.assembly.linked_faces import LinkedFaces
from render.stage.findings import FindingLog
from render.stage.geometry.stand_ins import MODES
from render.stage.geometry.surface import is_drawable
from render.stage.limits import PrimCount
from render.stage.options import DRAWN_PURPOSES, PURPOSES, StageOptions
from render.stage.render_pass import RenderPass
from render.stage.values import SPLATS, schema_type

_DRAWN = Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)
# Prototypes of point instancers are often `over`s, to keep them from being drawn in their own place.
_PROTOTYPE = Usd.TraverseInstanceProxies(Usd.PrimIsActive & Usd.PrimIsLoaded & ~Usd.PrimIsAbstract)
_INSTANCER_ATTRIBUTES = ("positions", "orientations", "orientationsf", "scales", "protoIndices", "ids", "invisibleIds")
# A single sample of these moves instances all the time.
_INSTANCER_RATES = ("velocities", "accelerations", "angularVelocities")
_MAX_NESTED_INSTANCERS = 8


@dataclass(frozen=True, eq=False)
class InstancerLink:
    """One instancer on the way to a surface.

    Attributes:
        instancer: the PointInstancer.
        prototype: which of its prototypes the surface belongs to.
        root: that prototype's root prim.
    """

    instancer: Usd.Prim
    prototype: int
    root: Usd.Prim


@dataclass(frozen=True, eq=False)
class LevelRoot:
    """Prim whose children are levels of detail (UsdLodRootAPI).

    Attributes:
        prim: the prim; an instance proxy for native instances.
        chain: point instancers from the outermost inwards, empty for a root that stands by itself.
        count: number of its levels.
    """

    prim: Usd.Prim
    chain: tuple[InstancerLink, ...]
    count: int


Levels = tuple[tuple[LevelRoot, int], ...]
"""Roots of levels of detail above a prim, outermost first, each with the level that the prim is in."""


@dataclass(frozen=True, eq=False)
class Occurrence:
    """One surface, or cloud of splats, at one place of the stage.

    Attributes:
        prim: the mesh or implicit prim; an instance proxy for native instances.
        source: path of the prim that holds its data, the same for all native instances of it.
        mover: nearest prim at or above whose transform varies, or None.
        hiders: prims at or above whose visibility varies.
        chain: point instancers from the outermost inwards, empty for a surface that stands by itself.
        moves: whether its transform varies over time.
        camera_role: what the camera makes of it.
        levels: levels of detail that it is in.
        links: lights that leave it out.
        linked_faces: faces that it is, of a mesh that lights leave out in part; None for all.
        draw_mode: draw mode of a model that is drawn by a stand-in (`render.stage.geometry.stand_ins`), else empty.
    """

    prim: Usd.Prim
    source: Sdf.Path
    mover: Usd.Prim | None = None
    hiders: tuple[Usd.Prim, ...] = ()
    chain: tuple[InstancerLink, ...] = ()
    moves: bool = False
    camera_role: CameraRole = "seen"
    levels: Levels = ()
    links: LightLinks = UNLINKED
    linked_faces: LinkedFaces | None = None
    draw_mode: str = ""

    @property
    def path(self) -> str:
        """The prim's path on the stage."""
        return str(self.prim.GetPath())


@dataclass(frozen=True)
class _State:
    """Traversal state that a prim passes down to its children."""

    purpose: UsdGeom.Imageable.PurposeInfo
    mover: Usd.Prim | None = None
    hiders: tuple[Usd.Prim, ...] = ()
    chain: tuple[InstancerLink, ...] = ()
    moves: bool = False
    levels: Levels = ()
    draw_mode: str = ""
    predicate: object = field(default=_DRAWN)


@dataclass
class Inventory:
    """Everything found.

    Attributes:
        surfaces: surfaces that are drawn.
        lights: UsdLux light prims with the prims that may hide them, and the levels of detail that they are in.
        level_roots: prims whose children are levels of detail.
        splats: clouds of Gaussian splats that are drawn.
    """

    surfaces: list[Occurrence] = field(default_factory=list)
    lights: list[tuple[Usd.Prim, tuple[Usd.Prim, ...], Levels]] = field(default_factory=list)
    level_roots: list[LevelRoot] = field(default_factory=list)
    splats: list[Occurrence] = field(default_factory=list)


def take_inventory(
    stage: Usd.Stage, options: StageOptions, render_pass: RenderPass | None, log: FindingLog
) -> Inventory:
    """Walk the stage.

    Args:
        stage: the stage.
        options: purposes, mask and draw modes.
        render_pass: chooses what is drawn; None for everything.
        log: notes prims of kinds that are not honoured, and instances within instances that are too many to be walked.
    """
    walk = _Walk(options, render_pass, log)
    walk.below(stage.GetPseudoRoot(), _State(UsdGeom.Imageable.PurposeInfo()))
    return walk.found


class _Walk:
    def __init__(self, options: StageOptions, render_pass: RenderPass | None, log: FindingLog) -> None:
        self._purposes, self._log = frozenset(options.purposes or DRAWN_PURPOSES), log
        self._mask = Usd.StagePopulationMask([Sdf.Path(p) for p in options.mask]) if options.mask is not None else None
        self._pass, self._draw_modes = render_pass, options.draw_modes
        self.found = Inventory()
        self._instanced = PrimCount()
        self._waiting: list[tuple[Usd.Prim, _State]] = []

    def below(self, root: Usd.Prim, state: _State) -> None:
        """Visit all below a prim, in the stage's order and without recursion: hierarchies may be deeper than Python's stack."""
        self._descend(root, state)
        while self._waiting:
            self._visit(*self._waiting.pop())

    def _descend(self, prim: Usd.Prim, state: _State) -> None:
        children = prim.GetFilteredChildren(state.predicate)
        if children and prim.HasAPI(UsdLod.RootAPI):
            root = LevelRoot(prim, state.chain, len(children))
            self.found.level_roots.append(root)
            states = [replace(state, levels=(*state.levels, (root, index))) for index in range(root.count)]
        else:
            states = [state] * len(children)
        self._waiting.extend(reversed(list(zip(children, states, strict=True))))

    def _visit(self, prim: Usd.Prim, state: _State) -> None:
        if prim.IsA(UsdShade.Material) or prim.IsA(UsdShade.NodeGraph) or prim.IsA(UsdGeom.Subset):
            return
        if state.chain or prim.IsInstanceProxy():
            try:
                self._instanced.add(prim.GetPath())
            except StageError as problem:
                self._log.add(problem.code, "/", f"{problem.detail}; the others are not drawn")
                return
        if not state.chain and self._is_left_out(prim.GetPath()):
            return
        below = self._inherit(prim, state)
        if below is None:
            return
        is_shown = self._pass is None or bool(state.chain) or self._pass.shows(prim.GetPath())
        if self._draw_modes and prim.IsModel():
            mode = draw_mode(prim, below.draw_mode, self._log)
            if mode in MODES and is_replaced(prim):
                if is_shown and below.purpose.purpose in self._purposes:
                    self._add(prim, below, mode)
                return
            below = below if mode == below.draw_mode else replace(below, draw_mode=mode)
        if prim.IsA(UsdGeom.PointInstancer):
            if is_shown:
                self._instancer(prim, below)
            return
        if is_shown:
            self._take(prim, below)
        self._descend(prim, below)

    def _is_left_out(self, path: Sdf.Path) -> bool:
        """Whether a prim does not exist for the mask or the render pass, nor anything below it."""
        if self._mask is not None and not self._mask.Includes(path):
            return True
        return self._pass is not None and self._pass.prunes(path)

    def _inherit(self, prim: Usd.Prim, state: _State) -> _State | None:
        """State below a prim, or None where the prim is always invisible."""
        imageable = UsdGeom.Imageable(prim)
        if not imageable:
            return state
        hiders, mover, moves = state.hiders, state.mover, state.moves
        visibility = imageable.GetVisibilityAttr()
        if visibility.ValueMightBeTimeVarying():
            hiders = (*hiders, prim)
        elif visibility.Get() == UsdGeom.Tokens.invisible:
            return None
        xformable = UsdGeom.Xformable(prim)
        if xformable:
            if xformable.GetResetXformStack():
                mover, moves = None, bool(state.chain) and moves
            if self._might_move(xformable):
                mover, moves = prim, True
        purpose = imageable.ComputePurposeInfo(state.purpose)
        if hiders is state.hiders and mover is state.mover and moves == state.moves and purpose == state.purpose:
            return state
        return replace(state, purpose=purpose, hiders=hiders, mover=mover, moves=moves)

    def _might_move(self, xformable: UsdGeom.Xformable) -> bool:
        """Whether a transform may vary over time; notes one that USD cannot read."""
        if not _is_readable(xformable):
            path = xformable.GetPath()
            message = f"the transform of {path} cannot be read in whole: operations that USD does not know are left out"
            self._log.add("bad_transform", path, message)
        try:
            return bool(xformable.TransformMightBeTimeVarying())
        except Tf.ErrorException:
            return False

    def _take(self, prim: Usd.Prim, state: _State) -> None:
        if prim.HasAuthoredMetadata("clips"):
            self._note_missing_clips(prim)
        if prim.HasAPI(UsdLux.LightAPI):
            self._light(prim, state)
        if schema_type(prim) == SPLATS or is_drawable(prim):
            if state.purpose.purpose not in PURPOSES:
                message = f"{prim.GetPath()} is not drawn: its purpose must be one of {', '.join(PURPOSES)}, got "
                self._log.add("bad_purpose", prim.GetPath(), f"{message}{state.purpose.purpose}")
            if state.purpose.purpose in self._purposes:
                self._add(prim, state)
        elif _is_geometry(prim) and state.purpose.purpose in self._purposes:
            kind, path = schema_type(prim), prim.GetPath()
            self._log.add("unsupported_geometry", path, f"{path} is not drawn: {kind} prims are not honoured")
        if self._draw_modes and prim.HasAPI(UsdGeom.ModelAPI):
            note_no_model(prim, self._log)

    def _add(self, prim: Usd.Prim, state: _State, draw_mode: str = "") -> None:
        """Add a surface, a cloud of splats, or a model that is drawn by its draw mode."""
        source = prim.GetPrimInPrototype() if prim.IsInstanceProxy() else prim
        role = self._camera_role(prim, state)
        is_cloud = not draw_mode and schema_type(prim) == SPLATS
        (self.found.splats if is_cloud else self.found.surfaces).append(
            Occurrence(
                prim,
                source.GetPath(),
                state.mover,
                state.hiders,
                state.chain,
                state.moves,
                role,
                state.levels,
                draw_mode=draw_mode,
            )
        )

    def _camera_role(self, prim: Usd.Prim, state: _State) -> CameraRole:
        """Role of a surface for the camera; an instancer's are as the outermost instancer itself."""
        if self._pass is None:
            return "seen"
        return self._pass.camera_role((state.chain[0].instancer if state.chain else prim).GetPath())

    def _note_missing_clips(self, prim: Usd.Prim) -> None:
        path = prim.GetPath()
        for clips in prim.GetMetadata("clips").values():
            listed = clips.get("assetPaths") if isinstance(clips, dict) else None
            for asset in listed if isinstance(listed, Sdf.AssetPathArray) else ():
                if asset.path and not asset.resolvedPath:
                    message = (
                        f"{asset.path} is missing: prim {path} refers to it as a value clip and is read without it"
                    )
                    self._log.add("missing_clip", asset.path, message)

    def _light(self, prim: Usd.Prim, state: _State) -> None:
        path = prim.GetPath()
        if state.chain:
            self._log.add("instanced_light", path, f"light {path} in a point instancer is not honoured")
            return
        self.found.lights.append((prim, state.hiders, state.levels))

    def _instancer(self, prim: Usd.Prim, state: _State) -> None:
        path = prim.GetPath()
        if len(state.chain) >= _MAX_NESTED_INSTANCERS:
            self._log.add(
                "instancers_too_deep", path, f"{path} is nested in {_MAX_NESTED_INSTANCERS} instancers: not drawn"
            )
            return
        moves = state.moves or _instances_move(prim)
        for number, target in enumerate(UsdGeom.PointInstancer(prim).GetPrototypesRel().GetForwardedTargets()):
            root = prim.GetStage().GetPrimAtPath(target)
            if not root:
                message = f"prototype {target} of {path} does not exist: its instances are not drawn"
                self._log.add("missing_prototype", target, message)
                continue
            chain = (*state.chain, InstancerLink(prim, number, root))
            below = replace(state, chain=chain, mover=None, moves=moves, draw_mode="", predicate=_PROTOTYPE)
            self._waiting.append((root, below))


def _is_readable(xformable: UsdGeom.Xformable) -> bool:
    """Whether all operations of a transform are there and have values of their types."""
    order = [str(name) for name in xformable.GetXformOpOrderAttr().Get() or ()]
    if not order:
        return True
    last_reset = max(
        (place for place, name in enumerate(order) if name == UsdGeom.XformOpTypes.resetXformStack), default=-1
    )
    try:
        xformable.GetLocalTransformation(Usd.TimeCode.EarliestTime())
        return len(xformable.GetOrderedXformOps()) == len(order) - last_reset - 1
    except Tf.ErrorException:
        return False


def _is_geometry(prim: Usd.Prim) -> bool:
    return bool(prim.IsA(UsdGeom.Gprim) or prim.IsA(UsdProc.GenerativeProcedural))


def _instances_move(instancer: Usd.Prim) -> bool:
    varies = (instancer.GetAttribute(name) for name in _INSTANCER_ATTRIBUTES if instancer.HasAttribute(name))
    rates = (instancer.GetAttribute(name) for name in _INSTANCER_RATES if instancer.HasAttribute(name))
    return any(a.ValueMightBeTimeVarying() for a in varies) or any(a.HasAuthoredValue() for a in rates)
