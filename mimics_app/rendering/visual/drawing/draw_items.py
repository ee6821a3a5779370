"""The world's sub-entities as arrays for the compiled passes; rebuilt when the world's structure changes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import B1, F4, F8, I4, U1
from mimics_app.rendering.visual.drawing.mesh_arena import MeshArena, is_rewritten
from mimics_app.rendering.visual.kernels.bounds import follow_box
from mimics_app.rendering.visual.materials.material_instance import MaterialInstance
from mimics_app.rendering.visual.materials.materials import MaterialStore
from mimics_app.world.content.world import World

if TYPE_CHECKING:
    from mimics_app.world.content.motion.skinned_body import SkinnedBody

__all__ = ["DrawItems", "DrawState", "list_items"]

T = TypeVar("T")
A = TypeVar("A", bound=NDArray[Any])


@dataclass(frozen=True, eq=False)
class DrawState:
    """State that is bound before a run of draws: an instance of a material, and True where indices have 32 bits."""

    material_instance: MaterialInstance
    wide: bool


@dataclass(frozen=True, eq=False)
class DrawItems:
    """Arrays with one row per sub-entity.

    Attributes:
        rows: Row of the node in the Transform table, int32 [n].
        entities: Entity index of the node, int32 [n].
        states: Number in `of_state`, int32 [n].
        small_states: The same on small triangles, -1 where that is no other, int32 [n].
        shadow_states: Number in `of_shadow`, int32 [n].
        meshes: Number in `ranges`, int32 [n].
        instance_params: Instance parameters of the material, float32 [n, 4]; see `MaterialInstance.instance_params`.
        local: Centre [m] and radius [m] of the sphere in the node's frame, float64 [n, 4].
        half: Half extents of the box around the same centre [m], float64 [n, 3].
        drawable: 1 where there is something to draw, uint8 [n].
        transparent: True where blended, [n].
        solid: True where opaque and without holes, [n].
        one_sided: 1 where back faces are not drawn, uint8 [n].
        casting: True where it casts shadows, [n].
        levels: Level of detail it belongs to, uint8 [n].
        families: Number of its body in the table of levels, -1: a body without levels; int32 [n].
        mesh_names: Keys in `World.meshes`.
        ranges: Indices, first index and base vertex of each mesh, int32 [meshes, 3].
        listed: See `TriangleLists.line`, int32 [meshes, 2]; zeros for a mesh that was rewritten in place.
        bodies: Body of each skinned mesh, by its number in `ranges`.
        of_state: The states.
        of_shadow: The states of the shadow pass.
    """

    rows: I4
    entities: I4
    states: I4
    small_states: I4
    shadow_states: I4
    meshes: I4
    instance_params: F4
    local: F8
    half: F8
    drawable: U1
    transparent: B1
    solid: B1
    one_sided: U1
    casting: B1
    levels: U1
    families: I4
    mesh_names: list[str]
    ranges: I4
    listed: I4
    bodies: dict[int, SkinnedBody]
    of_state: list[DrawState]
    of_shadow: list[DrawState]

    def follow(self, body: SkinnedBody) -> I4:
        """Update the bounds of a deformable body; return its items."""
        items = self._of_body.get(body)
        if items is None:
            numbers = [self._numbers[name] for name in body.meshes if name in self._numbers]
            items = self._of_body[body] = np.flatnonzero(np.isin(self.meshes, numbers)).astype(np.int32)
        follow_box(items, *body.bounds, self.half, self.local)
        return items

    def rebound(self, world: World, names: Sequence[str]) -> B1:
        """Update the bounds of meshes whose vertices changed; return which items show one of them, [n]."""
        known = self._numbers
        numbers = np.array([known[name] for name in names if name in known], np.int32)
        local, half = _bounds(world, [self.mesh_names[number] for number in numbers])
        self.listed[numbers] = 0
        line = np.full(len(self.mesh_names), -1, np.int32)
        line[numbers] = np.arange(len(numbers))
        lines = line[self.meshes]
        touched: B1 = lines >= 0
        self.local[touched], self.half[touched] = local[lines[touched]], half[lines[touched]]
        return touched

    @cached_property
    def _of_body(self) -> dict[SkinnedBody, I4]:
        return {}

    @cached_property
    def _numbers(self) -> dict[str, int]:
        return _numbers(self.mesh_names)


def list_items(world: World, arena: MeshArena, materials: MaterialStore) -> DrawItems:
    """Build the draw items of a world.

    Args:
        world: After its update.
        arena: Up to date with the world's meshes.
        materials: Up to date with its materials.
    """
    listed = world.subentities()
    pairs = list(zip(listed.mesh, listed.material, strict=True))
    kinds = list(dict.fromkeys(pairs))
    names = list(dict.fromkeys(listed.mesh))
    kind_of, mesh_of = _numbers(kinds), _numbers(names)
    kind = np.array([kind_of[pair] for pair in pairs], np.int32)
    mesh = np.array([mesh_of[name] for name in listed.mesh], np.int32)
    ranges = [arena.ranges.get(name) for name in names]
    places = [ranges[mesh_of[name]] for name, _ in kinds]
    coloured, wide = ([bool(place and getattr(place, what)) for place in places] for what in ("coloured", "wide"))
    instances = [
        materials.instance(material, coloured=each) for (_, material), each in zip(kinds, coloured, strict=True)
    ]
    states = _States()
    of_kind = np.array(
        [states.number(instance.state, instance, flag) for instance, flag in zip(instances, wide, strict=True)],
        np.int32,
    )
    bodies = world.motion.body_of
    small = np.full(len(kinds), -1, np.int32)
    for i, (name, material) in enumerate(kinds):
        instance = materials.small_instance(material, coloured=coloured[i]) if name in bodies else None
        if instance is not None:
            small[i] = states.number(instance.state, instance, wide[i])
    shadows = _States()
    of_shadow = [
        shadows.number(instance.shadow_state, instance, flag) for instance, flag in zip(instances, wide, strict=True)
    ]
    local, half = _bounds(world, names)
    filled = np.array([place is not None and place.count > 0 for place in ranges], np.uint8)
    return DrawItems(
        rows=np.asarray(listed.row, np.int32),
        entities=listed.entity,
        states=_spread(of_kind, kind),
        small_states=_spread(small, kind),
        shadow_states=_spread(np.array(of_shadow, np.int32), kind),
        meshes=mesh,
        instance_params=_spread(
            np.array([instance.instance_params for instance in instances], np.float32).reshape(-1, 4), kind
        ),
        local=_spread(local, mesh),
        half=_spread(half, mesh),
        drawable=_spread(filled, mesh),
        transparent=_spread(np.array([instance.transparent for instance in instances], np.bool_), kind),
        solid=_spread(np.array([instance.solid for instance in instances], np.bool_), kind),
        one_sided=_spread(np.array([instance.one_sided for instance in instances], np.uint8), kind),
        casting=np.asarray(listed.casts_shadow, np.bool_),
        levels=listed.level,
        families=_families(world),
        mesh_names=names,
        ranges=np.array([(p.count, p.first, p.base_vertex) if p else (0, 0, 0) for p in ranges], np.int32).reshape(
            -1, 3
        ),
        listed=np.array([_listed(world, arena, name) for name in names], np.int32).reshape(-1, 2),
        bodies={mesh_of[name]: bodies[name] for name in names if name in bodies},
        of_state=states.found,
        of_shadow=shadows.found,
    )


def _listed(world: World, arena: MeshArena, name: str) -> tuple[int, int]:
    """Return the line of a mesh whose triangles may be listed; zeros for one that was rewritten."""
    return (0, 0) if is_rewritten(world, name) else arena.lists.line(name, bent=name in world.motion.body_of)


def _families(world: World) -> I4:
    """Return the row of each sub-entity's body in the table of levels, -1: a body without levels."""
    table, entities = world.content.levels, world.subentities().entity
    row_of = np.full(int(entities.max(initial=-1)) + 1, -1, np.int32)
    known = table.entities[table.entities < len(row_of)]
    row_of[known] = np.flatnonzero(table.entities < len(row_of))
    return row_of[entities]


class _States:
    """Numbers distinct states in the order they are added."""

    def __init__(self) -> None:
        self.found: list[DrawState] = []
        self._number: dict[object, int] = {}

    def number(self, key: object, instance: MaterialInstance, wide: bool) -> int:
        if (key, wide) not in self._number:
            self._number[key, wide] = len(self.found)
            self.found.append(DrawState(instance, wide))
        return self._number[key, wide]


def _bounds(world: World, names: Sequence[str]) -> tuple[F8, F8]:
    """Return bounding spheres [n, 4] and half extents of boxes [n, 3] of meshes; zeros for one the world lacks."""
    local, lower, upper = np.zeros((len(names), 4)), np.zeros((len(names), 3)), np.zeros((len(names), 3))
    bent = np.zeros(len(names), np.bool_)
    bodies = world.motion.body_of
    for i, name in enumerate(names):
        mesh = world.meshes.get(name)
        if mesh is None:
            continue
        lower[i], upper[i] = world.mesh_bounds(name)
        bent[i] = name in bodies
        if not bent[i]:
            local[i, :3], local[i, 3] = mesh.centre, mesh.radius
    half = 0.5 * (upper - lower)
    local[bent, :3], local[bent, 3] = 0.5 * (lower + upper)[bent], np.linalg.norm(half[bent], axis=1)
    return local, half


def _numbers(keys: Sequence[T]) -> dict[T, int]:
    return {key: number for number, key in enumerate(keys)}


def _spread(values: A, numbers: I4) -> A:
    """Return the row of each item, given one row per kind."""
    return values[numbers] if len(values) else values  # type: ignore[return-value]  # numpy forgets the kind
