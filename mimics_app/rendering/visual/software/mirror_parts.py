"""Parts of mirrors' pictures that changed."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from mimics_app.contracts.arrays import B1, F8
from mimics_app.rendering.visual.changed_part import ChangedPart
from mimics_app.rendering.visual.drawing.draw_list import DrawList
from mimics_app.rendering.visual.pictures.live_picture import MirrorPicture
from mimics_app.rendering.visual.pictures.mirror_views import Reflection
from mimics_app.rendering.visual.software.frame_inputs import FrameInputs
from mimics_app.rendering.visual.software.picture_changes import PictureChanges
from mimics_app.rendering.visual.stages.picture_stage import Batch, PictureJob, PictureStage
from mimics_app.rendering.visual.stages.world_stage import FrameScene, ViewDraws
from mimics_app.rendering.visual.surfaces.surface import Size
from mimics_app.rendering.visual.view import Rect, View
from mimics_app.world.content.live_pictures import live_key
from mimics_app.world.content.world import World

__all__ = ["MirrorParts"]

BatchParts = Callable[[Sequence[ChangedPart], View, Rect, Hashable], list[ViewDraws]]
"""Queues what is visible in parts of a view in a rectangle of its target."""

Capture = Callable[[View, Rect, Hashable, B1], FrameInputs]
"""Captures what the picture of a view in a rectangle of its target depends on, given its key and what is renewed."""


@dataclass(eq=False)
class _Kept:
    """A mirror's picture in the only view, from frame to frame.

    Attributes:
        changes: Finds what changes in it.
        reflection: The reflection of this frame; None where the mirror is not visible.
        parts: Parts of the picture that changed; None: all of it.
    """

    changes: PictureChanges = field(default_factory=PictureChanges)
    reflection: Reflection | None = None
    parts: list[ChangedPart] | None = None


class MirrorParts:
    """Compares reflections with those of the last frame, and queues what changed of them.

    Args:
        pictures: Mirrors, screens and insets.
    """

    def __init__(self, pictures: PictureStage) -> None:
        self._pictures = pictures
        self._kept: dict[str, _Kept] = {}
        self._seen: set[str] = set()

    def forget(self) -> None:
        """Discard what is known of the last frame."""
        for kept in self._kept.values():
            kept.changes.forget()

    def find(self, scene: FrameScene, listed: DrawList, view: View, size: Size, capture: Capture) -> tuple[B1, F8]:
        """Find what differs from the last frame in the screens and reflections that the only view of a frame shows.

        Args:
            scene: World and settings of the frame.
            listed: Its draw list.
            view: The view.
            size: Size of its picture [px].
            capture: Captures a frame of a reflection.

        Returns:
            Items that show a screen whose picture is drawn in this frame, [n]; and where changed parts of reflections
            are seen, as shares of the view's picture: left, right, bottom, top; [m, 4].
        """
        renewed, places, world = self._renewed(scene.world, listed), [np.zeros((0, 4))], scene.world
        pictures = self._pictures
        self._kept = {key: kept for key, kept in self._kept.items() if key in pictures.pictures}
        for name, mirror in world.mirrors.items():
            key = live_key(name)
            kept = self._kept.setdefault(key, _Kept())
            kept.reflection = found = pictures.reflect(world, name, mirror, view, size, scene.settings.mirror_scale)
            if found is None:
                kept.changes.forget()
                pictures.held.discard(key)
                continue
            parts = kept.changes.parts(capture(found.view, found.view.rectangle, (key, 0), renewed))
            kept.parts = parts if key in pictures.held else None
            places.append(found.places(kept.parts) / np.repeat(size, 2))
        return renewed, np.concatenate(places)

    def queue(
        self, world: World, view: View, place: Rect, parts: Sequence[ChangedPart], batch: Batch, batch_parts: BatchParts
    ) -> list[ViewDraws]:
        """Queue what is visible in parts of the only view, in the changed parts of its mirrors, in screens and insets.

        Args:
            world: The world, updated.
            view: The view.
            place: Its rectangle in the target [px].
            parts: The parts; `find` has found those of the mirrors.
            batch: Queues what is visible in a view.
            batch_parts: Queues what is visible in parts of a view.

        Returns:
            The parts, each with the mirrors.
        """
        pictures, shown = self._pictures, []
        pictures.jobs = []
        drawn = batch_parts(parts, view, place, 0)
        for key in map(live_key, world.mirrors):
            picture, kept = pictures.pictures[key], self._kept[key]
            assert isinstance(picture, MirrorPicture)
            if kept.reflection is not None:
                seen, name = kept.reflection.view, (key, 0)
                whole = kept.parts is None
                jobs = [batch(seen, name)] if whole else batch_parts(kept.parts or (), seen, seen.rectangle, name)
                pictures.jobs += [PictureJob(picture, 0, jobs)] if jobs else []
                pictures.held.add(key)
            shown.append((picture, 0, kept.reflection))
        pictures.queue_cameras(world, view, self._seen, batch)
        return [replace(each, mirrors=shown) for each in drawn]

    def _renewed(self, world: World, listed: DrawList) -> B1:
        """Return the items that show a screen whose picture is drawn in this frame, [n]."""
        items = listed.items
        if not world.screens:
            self._seen = set()
            return np.zeros(len(items.rows), np.bool_)
        names = np.array([state.material_instance.material.name for state in items.of_state])
        self._seen = set(names[items.states[listed.drawn]].tolist())
        screens = ((live_key(name), screen) for name, screen in world.screens.items())
        due = [key for key, screen in screens if key in self._seen and self._pictures.due(key, screen.every)]
        return np.isin(names, due)[items.states]
