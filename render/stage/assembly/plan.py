"""Draw plan: the inventory cut into pieces by material and gathered into groups."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Hashable, Iterable, Sequence
from dataclasses import dataclass, field

from pxr import Sdf, Usd, UsdGeom

from render.stage.assembly.groups import Group, InstancedGroup, RigidGroup
from render.stage.assembly.instance_primvars import NONE_INHERITED, inherited_by, without
from render.stage.assembly.inventory import Occurrence
from render.stage.assembly.linked_faces import linked_faces_vary
from render.stage.assembly.pieces import Piece, ShapeReader, Sides
from render.stage.findings import FindingLog
from render.stage.geometry.displacement import Displacement, metric_of
from render.stage.geometry.generated import is_ribbon
from render.stage.geometry.points_data import note_velocities
from render.stage.geometry.primvars import find_primvar
from render.stage.geometry.shape import PrimvarNames
from render.stage.geometry.skinning import Skeletons
from render.stage.geometry.stand_ins import stand_in_varies
from render.stage.geometry.surface import surface_varies
from render.stage.materials.bindings import bound_parts, subsets_vary
from render.stage.materials.looks import LookReader
from render.stage.values import UNREADABLE, why_unreadable

# A surface that occurs several times is drawn by instancing only if that spares more than this many triangles; below it, another
# draw call costs more than the copies (pyrender needs about 0.5 ms for each primitive and pass).
INSTANCING_PAYS_FROM = 10_000


def plan_groups(surfaces: Iterable[Occurrence], cutter: PieceCutter, log: FindingLog) -> list[Group]:
    """Gather surfaces into groups.

    Args:
        surfaces: surfaces that are drawn.
        cutter: cuts them into pieces.
        log: for findings.
    """
    rigid: dict[Hashable, list[Piece]] = defaultdict(list)
    shared: dict[Hashable, list[Piece]] = defaultdict(list)
    for surface in surfaces:
        try:
            pieces = cutter.cut(surface)
        except UNREADABLE as problem:
            log.add("bad_geometry", surface.path, f"{surface.path} is not drawn: {why_unreadable(problem)}")
            continue
        for piece in pieces:
            role = surface.camera_role, surface.links, surface.linked_faces
            if surface.chain:
                shared[(piece.shape_key, piece.part, piece.material, piece.sides, role, surface.path)].append(piece)
            else:
                shared[(piece.shape_key, piece.part, piece.material, piece.sides, role)].append(piece)
    cutter.shapes.prepare(pieces[0] for pieces in shared.values() if _needs_its_size(pieces))
    groups: list[Group] = []
    for pieces in shared.values():
        if _pays_to_instance(pieces, cutter.shapes):
            groups.append(InstancedGroup(pieces))
        else:
            for piece in pieces:
                rigid[_rigid_key(piece)].append(piece)
    return [RigidGroup(pieces) for pieces in rigid.values()] + groups


@dataclass(frozen=True, eq=False)
class PieceCutter:
    """Cuts surfaces into pieces by material.

    Attributes:
        looks: reads materials.
        skeletons: which surfaces a skeleton bends.
        binding_purposes: of materials.
        shapes: reads triangles, at the time at which the materials' primvars are read; the plan does not depend on it.
        cull_backfaces: leave out back faces of what is not ``doubleSided``.
        log: for findings.
        displaced: paths of the sources of the surfaces that were cut and are displaced (`Occurrence.source`).
    """

    looks: LookReader
    skeletons: Skeletons
    binding_purposes: Sequence[str]
    shapes: ShapeReader
    cull_backfaces: bool
    log: FindingLog
    displaced: set[Sdf.Path] = field(default_factory=set)

    def cut(self, surface: Occurrence) -> list[Piece]:
        """The pieces of a surface."""
        if surface.draw_mode:
            return self._cut_stand_in(surface, surface.draw_mode)
        prim, time = surface.prim, self.shapes.time
        parts = bound_parts(prim, self.binding_purposes, time, self.log)
        cuts_vary = subsets_vary(prim) or linked_faces_vary(prim, surface.linked_faces)
        deforms = surface_varies(prim, self.skeletons) or cuts_vary
        if deforms:
            note_velocities(prim, self.log)
        double = bool(UsdGeom.Gprim(prim).GetDoubleSidedAttr().Get(time)) or is_ribbon(prim)
        materials = [self.looks.representative(part.material, time) for part in parts]
        opaque = len(parts) == 1 or all(self._is_opaque(surface, material) for material in materials)
        sides = Sides(double, culled=self.cull_backfaces and not double, opaque=opaque)
        pieces = []
        for number, (part, material) in enumerate(zip(parts, materials, strict=True)):
            look = self.looks.look(material, time)
            read, metric = look.primvars, metric_of(prim) if look.displacement is not None else None
            from_instancers = inherited_by(surface, read)
            own = without(read, from_instancers)
            inherited, varies = _inherited_primvars(prim, own, time)
            key: Hashable = (surface.source, own, inherited, from_instancers, sides)
            if metric is not None:
                self.displaced.add(surface.source)
                key = (key, material, metric)
            pieces.append(
                Piece(
                    surface,
                    material,
                    part.material,
                    number,
                    len(parts),
                    sides,
                    deforms or varies or _displacement_varies(prim, look.displacement),
                    own,
                    from_instancers,
                    key,
                    metric=metric,
                )
            )
        return pieces

    def _cut_stand_in(self, surface: Occurrence, mode: str) -> list[Piece]:
        """The pieces of a model that is drawn by its draw mode."""
        stand_in, time = self.looks.stand_in(surface.prim, mode), self.shapes.time
        bound = [f"{surface.prim.GetPath()}.{name}" for name in stand_in.looks]
        materials = [self.looks.representative(path, time) for path in bound]
        read = [self.looks.look(material, time).primvars for material in materials]
        sides = Sides(double=False, culled=True, opaque=False)
        deforms = stand_in_varies(stand_in, surface.prim)
        key = (surface.source, stand_in, sides)
        return [
            Piece(
                surface,
                material,
                "",
                number,
                len(bound),
                sides,
                deforms,
                primvars,
                NONE_INHERITED,
                (*key, primvars),
                stand_in,
            )
            for number, (material, primvars) in enumerate(zip(materials, read, strict=True))
        ]

    def _is_opaque(self, surface: Occurrence, material: str) -> bool:
        """Whether a material hides what is behind it at all times, wherever it covers the surface."""
        look = self.looks.look(material, self.shapes.time)
        m, name = look.material, look.primvars.opacity
        if look.varies or m.may_be_transparent:
            return False
        return name is None or (
            find_primvar(surface.prim, name) is None and not inherited_by(surface, look.primvars).opacity
        )


def _displacement_varies(prim: Usd.Prim, displacement: Displacement | None) -> bool:
    if displacement is None:
        return False
    found = find_primvar(prim, displacement.primvar) if displacement.primvar else None
    return displacement.varies or (found is not None and found.varies())


def _inherited_primvars(prim: Usd.Prim, primvars: PrimvarNames, time: Usd.TimeCode) -> tuple[Hashable, bool]:
    """Key of the inherited primvars by which instances of one prim may differ; and whether any primvar varies over time."""
    values: list[Hashable] = []
    varies = False
    for name in primvars.all_names:
        found = find_primvar(prim, name)
        if found is not None:
            varies = varies or found.varies()
            if found.inherited:
                values.append((name, str(found.primvar.Get(time))))
    return tuple(values), varies


def _needs_its_size(pieces: list[Piece]) -> bool:
    """Whether it depends on the triangles of a surface if it is drawn by instancing. Levels of detail do not: one root's level is
    a rigid group of its own."""
    first = pieces[0].occurrence
    return not first.chain and not first.levels and not pieces[0].deforms and len(pieces) > 1


def _pays_to_instance(pieces: list[Piece], shapes: ShapeReader) -> bool:
    if not _needs_its_size(pieces):
        return len(pieces) > 1 or bool(pieces[0].occurrence.chain) or pieces[0].deforms
    whole = shapes.whole(pieces[0])
    return whole is not None and len(whole.triangles) * (len(pieces) - 1) > INSTANCING_PAYS_FROM


def _rigid_key(piece: Piece) -> Hashable:
    mover, hiders = piece.occurrence.mover, piece.occurrence.hiders
    return (
        piece.material,
        piece.sides,
        piece.occurrence.camera_role,
        piece.occurrence.links,
        piece.occurrence.levels,
        mover.GetPath() if mover is not None else None,
        tuple(prim.GetPath() for prim in hiders),
    )
