"""The draw list of a frame: culled and sorted sub-entities, queued in the frame's buffers."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.contracts.arrays import B1, F8, I4, U1
from mimics_app.rendering.visual.drawing.culling import make_culler
from mimics_app.rendering.visual.drawing.draw_items import DrawItems, list_items
from mimics_app.rendering.visual.drawing.frame_buffers import DrawRun, FrameBuffers
from mimics_app.rendering.visual.drawing.levels import Levels
from mimics_app.rendering.visual.drawing.mesh_arena import MeshArena
from mimics_app.rendering.visual.drawing.occlusion import (
    MIN_ITEMS,
    NO_OCCLUDER,
    OcclusionPass,
    Raster,
    gather_occluders,
    make_raster,
)
from mimics_app.rendering.visual.drawing.shadow_casters import Casters
from mimics_app.rendering.visual.drawing.skinning import SkinnedMeshes
from mimics_app.rendering.visual.drawing.state_choice import StateChoice
from mimics_app.rendering.visual.drawing.triangle_lists import SeenItems
from mimics_app.rendering.visual.kernels.bounds import gather_casters, update_bounds
from mimics_app.rendering.visual.kernels.commands import Drawn
from mimics_app.rendering.visual.kernels.frustum import cull_flat
from mimics_app.rendering.visual.kernels.levels import pick_levels
from mimics_app.rendering.visual.kernels.order import Sorted, make_keys, sort_by_key
from mimics_app.rendering.visual.materials.materials import MaterialStore
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.rasteriser import Rasteriser
from mimics_app.rendering.visual.view import View
from mimics_app.world.content.world import World

if TYPE_CHECKING:
    from mimics_app.world.content.motion.skinned_body import SkinnedBody

__all__ = ["DRAWN", "HIDDEN", "DrawList"]


@dataclass(slots=True)
class Tally:
    """Counts of a frame, over all views: items, those outside, those occluded, frustum tests, skinned vertices."""

    items: int = 0
    culled: int = 0
    hidden: int = 0
    tests: int = 0
    bent: int = 0

    @property
    def figures(self) -> tuple[int, int, int, int, int]:
        """All counts, in this order: `astuple` would copy each, in thirty calls a frame."""
        return self.items, self.culled, self.hidden, self.tests, self.bent

    def count(self, items: int, in_frustum: int, drawn: int, tests: int) -> None:
        """Add the counts of one view."""
        self.tests += tests
        self.items += items
        self.culled += items - in_frustum
        self.hidden += in_frustum - drawn


class DrawOrder:
    """Sorts by layer of distance, state, distance from near to far, and mesh.

    Args:
        items: The draw items.
    """

    def __init__(self, items: DrawItems) -> None:
        count = len(items.rows)
        self._items = items
        self._keys, self._spare_keys = np.zeros(count, np.uint64), np.zeros(count, np.uint64)
        self._spare_items = np.zeros(count, np.int32)
        self._away = np.zeros(count, np.float32)
        self._digits = np.zeros((8, 256), np.int32)

    def sort(
        self,
        picked: I4,
        count: int,
        eye: F8,
        centres: F8,
        radii: F8,
        states: I4,
        mirrored: U1,
        *,
        layered: bool,
    ) -> None:
        """Sort the first `count` of `picked` in place.

        Args:
            picked: Numbers of items, [>= count].
            count: Number of items.
            eye: Origin of the distances, world [m], [3].
            centres: Centres of all items' spheres, world [m], [n, 3].
            radii: Their radii [m], [n].
            states: State of each item before mirroring, [n].
            mirrored: 1 where the winding of an item's faces is reversed, [n].
            layered: False sorts by states first.
        """
        by = Sorted(centres, radii, states, mirrored, self._items.meshes)
        make_keys(picked, count, eye, by, layered, self._away, self._keys)
        sort_by_key(self._keys, picked, count, self._spare_keys, self._spare_items, self._digits)


Size = tuple[int, int]


HIDDEN, DRAWN = 1, 2
"""Fates of an item in a view's frustum: occluded, or drawn."""


class DrawList:
    """The world's sub-entities, culled and sorted for each view.

    Attributes:
        items: The sub-entities as arrays.
        centres: Centres of their bounding spheres, world [m], float64 [n, 3].
        radii: Radii of the spheres [m], float64 [n].
        tally: Counts since the last update.
        moved: Items that moved or changed their shape since the update before, [n]; None where unknown.
        rewritten: Items whose mesh was rewritten in place since the structure changed, [n].
        remade: True where materials, meshes, settings or the world changed in the last update.
        drawn: Items drawn in a view since they were last set to False; all where the structure changed, [n].
        used: Items drawn in this frame, in any view or shadow map, [n].
        bent: The skinned meshes.
        fates: Fate of each item, 0 (in no view), `HIDDEN` or `DRAWN`, uint8 [n]; None unless requested.
    """

    def __init__(self, arena: MeshArena, materials: MaterialStore, rasteriser: Rasteriser) -> None:
        self._arena, self._choose = arena, rasteriser.member(StateChoice)
        self._materials = materials
        self._revision: tuple[int, int, str, str] | None = None
        self._occlusion: OcclusionPass | None = None
        self.tally = Tally()
        self.moved: B1 | None = None
        self.remade = True
        self._updates = 0
        self._world: F8 = np.zeros((0, 4, 4))
        self._last: F8 | None = None
        self._casters: dict[float, Casters] = {}
        self._coarser: dict[float, tuple[Casters, Casters]] = {}
        self._bent: dict[SkinnedBody, int] = {}
        self.bent = SkinnedMeshes()
        self.fates: U1 | None = None

    def update(
        self,
        world: World,
        settings: RenderSettings,
        *,
        light_features: frozenset[str],
        fates: bool = False,
        sparse: bool = False,
    ) -> None:
        """Rebuild the items where the world's structure changed, and update the bounds of what moved.

        Args:
            world: The world to draw.
            settings: Quality; determines techniques and occluders.
            light_features: See `MaterialStore.update`.
            fates: True records the fate of each item.
            sparse: True where the world is updated several times between two calls: what moved is then found by
                comparison with the matrices of the last call.
        """
        listed = world.subentities()
        worth = len(listed.row) >= MIN_ITEMS
        meshes = self._arena.update(world, solid=worth)
        materials = self._materials.update(
            world,
            light_features=light_features,
            shading=settings.shading,
            profile=settings.profile,
            vertex_light=settings.vertex_light > 0.0 and self._choose.by_size,
        )
        wanted = settings.occlusion if worth else "off"
        revision = (id(world), listed.revision, wanted, settings.culling)
        other = self._revision is None or revision[0] != self._revision[0]
        self.remade = meshes or materials or other or revision[2:] != (self._revision or revision)[2:]
        stale = self.remade or revision != self._revision
        if stale:
            self._take_structure(list_items(world, self._arena, self._materials), world)
            self._levels = Levels(world, self.items)
            nodes = world.transforms
            self._culler = make_culler(settings.culling, self.items, nodes.parent_rows, nodes.world[:, :3, 3])
            self._revision = revision
            occluders = gather_occluders(world, self.items, self._arena, wanted)
            self._occlusion = OcclusionPass(occluders) if len(occluders.inner_half) else None
        self._levels.begin()
        self._detail, self._by_triangle = settings.detail, settings.occlusion != "off"
        self._by_processor = settings.skinning == "processor"
        self._state.limit = settings.vertex_light
        self.tally = Tally()
        self._world = world.transforms.world
        before = self._shown.copy()
        np.multiply(listed.visible, self.items.drawable, out=self._shown)
        moved = self._move(world, everything=stale, other=other, sparse=sparse)
        if stale or moved or not np.array_equal(before, self._shown):
            self._casters.clear()
            self._coarser.clear()
        self._culler.moved(moved, self.centres, self.radii)
        self.fates = np.zeros(len(self.items.rows), np.uint8) if fates else None
        self.used[:] = False

    def shown_in(self, view: View, size: Size, key: Hashable) -> B1:
        """Return the items of the levels of detail that a view will be batched with, [n]; see `batch_views`."""
        return self._levels.show(key, view, size, self._shown, self.centres, self.radii, self._detail) != 0

    @property
    def matrices(self) -> F8:
        """T_world_from_node per row, [rows, 4, 4]."""
        return self._world

    def _move(self, world: World, *, everything: bool, other: bool, sparse: bool) -> int:
        """Update the bounding spheres; return how many items moved or changed their shape."""
        items, transforms, last = self.items, world.transforms, self._updates
        self._updates = transforms.updates
        skipped = other or transforms.updates > last + 1
        missed = everything or skipped
        changed = transforms.changed if transforms.updates > last else np.zeros_like(transforms.changed)
        if sparse:
            before, self._last = self._last, transforms.world.copy()
            if skipped and not other and before is not None and len(before) == len(self._last):
                changed, skipped = (before != self._last).any(axis=(1, 2)).astype(np.uint8), False
        rewritten, bent = self._arena.rewritten, self._newly_bent(world)
        if rewritten or bent:
            changed = changed.copy()
        if rewritten:
            touched = items.rebound(world, rewritten)
            self.rewritten |= touched
            changed[items.rows[touched]] = 1
        for body in bent:
            changed[items.rows[items.follow(body)]] = 1
        self.moved = None if skipped else changed[items.rows] > 0
        if not (missed or transforms.updates > last or rewritten or bent):
            return 0
        bounds = (items.local, self.centres, self.radii, self._mirrored)
        return int(update_bounds(items.rows, self._world, changed, missed, *bounds))

    def _newly_bent(self, world: World) -> list[SkinnedBody]:
        """Return the bodies whose skinned bounds changed since the last call."""
        bodies = world.motion.bodies.values()
        before, self._bent = self._bent, {body: body.revision for body in bodies}
        return [body for body in bodies if before.get(body) != body.revision]

    def casters(self, max_radius: float) -> Casters:
        """Return the shadow casters and the spheres that a shadow map has to cover.

        Args:
            max_radius: Larger bodies [m], such as grounds and skies, are left out of the spheres.

        Returns:
            The same object as in the last frame where nothing came, went or moved.
        """
        known = self._casters.get(max_radius)
        if known is None:
            shown = self._levels.show_finest(self._shown)
            items, centres, radii = np.empty(len(shown), np.int32), np.empty_like(self.centres), np.empty(len(shown))
            spheres = self.centres, self.radii
            count, held = gather_casters(shown, self.items.casting, *spheres, max_radius, items, centres, radii)
            known = self._casters[max_radius] = Casters(items[:count], centres[:held], radii[:held])
        return known

    def coarser(self, casters: Casters, texel: float) -> Casters:
        """Return the same bodies in the levels of detail that suffice for a map of a texel width [m].

        Returns:
            The same object as before for the same casters.
        """
        if not self._levels.bodies:
            return casters
        known = self._coarser.get(texel)
        if known is None or known[0] is not casters:
            known = self._coarser[texel] = casters, self._coarsen(casters, texel)
        return known[1]

    def _coarsen(self, casters: Casters, texel: float) -> Casters:
        shown = self._levels.show_for_texels(self._shown, self.radii, texel)
        items, found = self.items, np.empty(len(shown), np.int32)
        bodies = np.empty(self._levels.bodies, np.uint8)
        count = pick_levels(casters.items, shown, items.casting, items.families, bodies, found)
        return Casters(found[:count], casters.centres, casters.radii)

    def batch_casters(self, frame: FrameBuffers, casters: Casters, origin: F8) -> list[DrawRun]:
        """Queue the shadow pass: instances relative to `origin` [m], grouped by state and mesh."""
        count = len(casters.items)
        self.used[casters.items] = True
        self._picked[:count] = casters.items
        return self._queue(frame, self._picked, count, origin, shadow=True)

    def _queue(
        self,
        frame: FrameBuffers,
        picked: I4,
        count: int,
        origin: F8,
        *,
        shadow: bool = False,
        seen: bool = False,
    ) -> list[DrawRun]:
        """Sort the first `count` of some items, and queue them."""
        states = self.items.shadow_states if shadow else self._state.states
        layered = not (shadow or frame.few_pixels)  # drawing a few pixels twice costs less than a draw
        self._order.sort(picked, count, origin, self.centres, self.radii, states, self._mirrored, layered=layered)
        parts = self._whole if shadow or not seen else self._parts
        drawn = Drawn(states, self._mirrored, self.items.meshes, self.items.ranges, parts)
        return frame.add(picked, count, origin, self.items, self._world, drawn, shadow=shadow)

    def batch_views(
        self,
        frame: FrameBuffers,
        views: Sequence[View],
        origin: F8,
        sizes: Sequence[Size],
        samples: int,
        key: Hashable,
    ) -> tuple[list[DrawRun], list[DrawRun], F8]:
        """Queue the items that are visible in at least one of some views.

        Args:
            frame: Buffers of the frame.
            views: One view or a part of one, or the two views of a stereo pair.
            origin: Origin of the instance matrices and of the distances to sort by, world [m], [3].
            sizes: Sizes of the views' pictures as drawn [px].
            samples: Samples per pixel.
            key: Identifies the views from frame to frame.

        Returns:
            Opaque runs, by layers of distance, near to far within a state; blended runs of one item each, far to near;
            and the distances of the blended items from the origin [m].
        """
        picked = self._picked
        # One level for both eyes: two different levels of a body cannot be fused.
        between = views[0] if len(views) == 1 else replace(views[0], queued_at=origin)
        shown = self._levels.show(key, between, sizes[0], self._shown, self.centres, self.radii, self._detail)
        raster = make_raster(views[0], sizes[0], samples)
        count = self._pick(views[0], shown, raster)
        if len(views) > 1:
            count = self._pick_also(views[1:], count, shown, sizes[1:], samples)
        self._state.choose(key, between, sizes[0], picked, count, self.centres, self.radii)
        self.used[picked[:count]] = self.drawn[picked[:count]] = True
        blended = self._split(count)
        solid = count - len(blended)
        self._opaque = solid
        seen = len(views) == 1 and self._pick_triangles(views[0], solid, raster, samples)
        return self._queue(frame, picked, solid, origin, seen=seen), *self._batch_blended(frame, blended, origin)

    def _pick(self, view: View, shown: U1, raster: Raster) -> int:
        """Pick the items that are visible in a view; return how many."""
        items, picked = self.items, self._picked
        before = self._culler.tests
        seen = count = self._culler.cull(view.frustum_planes, shown, self._world, self.centres, self.radii, picked)
        self._remember(seen, HIDDEN)
        if self._occlusion is not None:
            spheres = (self.centres, self.radii)
            count = self._occlusion.remove_hidden(picked, seen, view, raster, items, self._world, *spheres)
        self._remember(count, DRAWN)
        self.tally.count(int(np.count_nonzero(shown)), seen, count, self._culler.tests - before)
        return count

    def _pick_triangles(self, view: View, count: int, raster: Raster, samples: int) -> bool:
        """List the triangles of the picked items that a view shows; return False where all are drawn."""
        if not self._by_triangle or view.clip_plane is not None:
            return False
        nearness = NO_OCCLUDER if self._occlusion is None else self._occlusion.nearness
        placed = (self._world, self.centres, self.radii, self._mirrored)
        seen = SeenItems(self._picked[:count], self.items, *placed)
        bent = self.bent if self._by_processor else None
        return self._arena.lists.pick(seen, raster, samples, nearness, bent, self._parts)

    def _pick_also(self, views: Sequence[View], count: int, shown: U1, sizes: Sequence[Size], samples: int) -> int:
        """Add the items visible in other views to those picked already; return how many there are."""
        either = np.zeros(len(self.items.rows), np.bool_)
        either[self._picked[:count]] = True
        for view, size in zip(views, sizes, strict=True):
            either[self._picked[: self._pick(view, shown, make_raster(view, size, samples))]] = True
        found = np.flatnonzero(either)
        self._picked[: len(found)] = found
        return len(found)

    def batch_meeting(self, frame: FrameBuffers, view: View, planes: F8, onto: I4 | None) -> list[DrawRun]:
        """Queue once more the opaque items of the view batched last that intersect a convex volume.

        Args:
            frame: Buffers of the frame.
            view: The same view.
            planes: Planes of the volume, unit normals inwards and offsets, [k, 4].
            onto: Entity indices to include; None: all.
        """
        tested = np.zeros(len(self.items.rows), np.uint8)
        tested[self._picked[: self._opaque]] = 1
        if onto is not None:
            tested &= np.isin(self.items.entities, onto)
        items, met = self.items, np.zeros(self._opaque, np.int32)
        count = cull_flat(planes, tested, items.rows, self._world, self.centres, self.radii, items.half, met)
        return self._queue(frame, met, count, view.eye_world)

    def drawn_meshes(self) -> list[str]:
        """Return the keys of the meshes drawn in this frame, in any view or shadow map."""
        names = self.items.mesh_names
        drawn = np.zeros(len(names), np.bool_)
        drawn[self.items.meshes[self.used]] = True
        return [names[number] for number in np.flatnonzero(drawn).tolist()]

    def _remember(self, count: int, fate: int) -> None:
        """Record a fate of the picked items, unless they have a better one."""
        if self.fates is not None:
            items = self._picked[:count]
            self.fates[items] = np.maximum(self.fates[items], fate)

    def _batch_blended(self, frame: FrameBuffers, blended: I4, eye: F8) -> tuple[list[DrawRun], F8]:
        if not len(blended):
            return [], np.zeros(0)
        away = np.linalg.norm(self.centres[blended] - eye, axis=1)
        far_first = np.argsort(-away, kind="stable")
        order = np.ascontiguousarray(blended[far_first])
        drawn = Drawn(self._state.states, self._mirrored, self.items.meshes, self.items.ranges, self._whole)
        runs = frame.add(order, len(order), eye, self.items, self._world, drawn, single=True)
        return runs, away[far_first]

    def _split(self, count: int) -> I4:
        """Remove the blended items from those picked, and return them."""
        if not self._any_transparent:
            return self._picked[:0]
        picked = self._picked[:count]
        blended = self.items.transparent[picked]
        apart, kept = picked[blended], picked[~blended]
        self._picked[: len(kept)] = kept
        return apart

    def _take_structure(self, items: DrawItems, world: World) -> None:
        self.items = items
        count = len(items.rows)
        self.centres, self.radii = np.zeros((count, 3)), np.zeros(count)
        self._shown = np.zeros(count, np.uint8)
        self.used, self.rewritten = np.zeros(count, np.bool_), np.zeros(count, np.bool_)
        self.drawn = np.ones(count, np.bool_)
        self._mirrored = np.zeros(count, np.uint8)
        self._picked = np.zeros(count, np.int32)
        self._whole, self._parts = (np.full((count, 2), -1, np.int32) for _ in range(2))
        self._opaque = 0
        self._order: DrawOrder = DrawOrder(items)
        self._state: StateChoice = self._choose(items, world)
        self._any_transparent = bool(items.transparent.any())
