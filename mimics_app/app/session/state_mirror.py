"""What a session tells its mirrors: each frame, the rows of its world that differ from the scene as built."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.contracts.messages.mirror_frame import MirrorFrame, SoundNote

if TYPE_CHECKING:
    from mimics_app.app.session.frame import Frames
    from mimics_app.world.content.world import World

__all__ = ["StateMirror"]

_KEPT_SOUNDS = 32
"""Newest sounds that each frame repeats: one that is lost is in the next ones."""


_WHOLE = 60
"""Frames from one with all rows to the next: what was placed before the first frame is in them."""


class StateMirror:
    """Makes the frames for the mirrors of one session.

    Args:
        world: The world as built, before its first frame.
    """

    def __init__(self, world: World) -> None:
        self._world = world
        self._sounds: deque[SoundNote] = deque(maxlen=_KEPT_SOUNDS)
        self._count = 0
        self._begin()

    def listen(self, frames: Frames) -> None:
        """Note the sounds that began in a frame."""
        for cue in frames.orders.audio.cues:
            self._count += 1
            self._sounds.append(SoundNote(self._count, cue.t_ns, cue.kind))

    def frame(self, frames: Frames, now_ns: int) -> MirrorFrame:
        """Return the newest frame."""
        table, view = self._world.transforms, frames.orders.view
        if table.revision != self._revision or len(table) != len(self._translations):
            self._begin()  # rows were ordered anew: mirrors open the scene anew, too
        self._ever |= (table.translations != self._translations).any(axis=1) | (table.visible != self._visible)
        self._ever |= (table.rotations != self._rotations).any(axis=1) | (table.scales != self._scales).any(axis=1)
        whole = frames.number % _WHOLE == 0
        rows = np.arange(len(table), dtype=np.uint32) if whole else np.flatnonzero(self._ever).astype(np.uint32)
        return MirrorFrame(
            number=frames.number,
            t_ns=now_ns,
            rows=rows,
            translations=table.translations[rows].astype(np.float32),
            rotations=table.rotations[rows].astype(np.float32),
            scales=table.scales[rows].astype(np.float32),
            visible=table.visible[rows],
            state=view.state.value,
            trial=view.trial,
            trials=view.trials,
            progress=view.progress,
            board=frames.board,
            sounds=tuple(self._sounds),
        )

    def _begin(self) -> None:
        table = self._world.transforms
        self._revision = table.revision
        self._translations, self._rotations = table.translations.copy(), table.rotations.copy()
        self._scales, self._visible = table.scales.copy(), table.visible.copy()
        self._ever = np.zeros(len(table), bool)
