"""Partial redraw: with a fixed camera only the parts of a picture are drawn in which something changed."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from functools import partial

from mimics_app.rendering.visual.changed_part import ChangedPart
from mimics_app.rendering.visual.drawing.draw_list import DrawList
from mimics_app.rendering.visual.drawing.frame_buffers import FrameBuffers
from mimics_app.rendering.visual.figures.hud import Hud
from mimics_app.rendering.visual.software.frame_inputs import capture_frame, may_keep
from mimics_app.rendering.visual.software.mirror_parts import MirrorParts
from mimics_app.rendering.visual.software.picture_changes import PictureChanges
from mimics_app.rendering.visual.stages.picture_stage import PictureStage
from mimics_app.rendering.visual.stages.redraw import Inside, Redraw
from mimics_app.rendering.visual.stages.world_stage import FrameScene, ViewDraws
from mimics_app.rendering.visual.view import Rect, View

__all__ = ["PartialRedraw"]


class PartialRedraw(Redraw):
    """Compares each frame with the last one; the first one is kept already where frames are far apart in time."""

    def __init__(self, listed: DrawList, frame: FrameBuffers, pictures: PictureStage, *, sparse: bool) -> None:
        super().__init__(listed, frame, pictures, sparse=sparse)
        self._listed, self._frame, self._sparse = listed, frame, sparse
        self._changes, self._mirrors = PictureChanges(sparse=sparse), MirrorParts(pictures)

    def forget(self) -> None:
        self._changes.forget()

    def find(
        self, scene: FrameScene, views: Sequence[View], place: Rect, shaders: int, hud: Hud
    ) -> list[ChangedPart] | None:
        if may_keep(scene, views, place):
            capture = partial(capture_frame, scene, self._listed, shaders)
            renewed, redrawn = self._mirrors.find(scene, self._listed, views[0], place[2:], capture)
            board = hud if self._sparse else None
            parts = self._changes.parts(capture(views[0], place, 0, renewed, redrawn, board))
        else:
            self._changes.forget()
            self._mirrors.forget()
            parts = None
        self.keeps, self.only_sprites = self._changes.keeps, self._changes.only_sprites
        return parts

    def queue(
        self, scene: FrameScene, view: View, place: Rect, parts: Sequence[ChangedPart], samples: int, inside: Inside
    ) -> list[ViewDraws]:
        batch, batch_parts = partial(inside, scene), partial(self._batch_parts, scene, samples)
        return self._mirrors.queue(scene.world, view, place, parts, batch, batch_parts)

    def _batch_parts(
        self, scene: FrameScene, samples: int, parts: Sequence[ChangedPart], view: View, place: Rect, key: Hashable
    ) -> list[ViewDraws]:
        """Queue what is visible in parts of a view in a rectangle of its target."""
        drawn, frame = [], self._frame
        for part in parts:
            size, (left, bottom) = part.rectangle[2:], part.rectangle[:2]
            seen = view.through((left - place[0], bottom - place[1], *size), place[2:])
            runs = self._listed.batch_views(frame, [seen], view.eye_world, [size], samples, key)
            projected = [] if scene.effects is None else scene.effects.meet([seen], self._listed, frame)
            mixed = runs[1] if scene.effects is None else scene.effects.mix(seen, size[1], *runs[1:])[0]
            drawn.append(ViewDraws(view, place, runs[0], mixed, projected=projected, part=part))
        return drawn
