"""What a session publishes to its mirrors: each frame, the rows of its world that differ from the scene as built."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.app.cues.cue_watch import TOUCHES, CueWatch, with_gait_cues
from mimics_app.contracts.arrays import Records
from mimics_app.contracts.messages.mirror_frame import BurstNote, CordNote, EffectsNote, MirrorFrame, SoundNote
from mimics_app.world.content.cords import Cord
from mimics_app.world.content.effects import Effects

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
        self._watch = CueWatch()
        self._begin()

    def listen(self, frames: Frames, now_ns: int) -> None:
        """Note what has begun in a frame that a sound may be assigned to: contacts, cues and orders of the task."""
        audio = with_gait_cues(frames.orders, frames.events).audio
        begun: list[tuple[int, str]]
        begun = [(int(event["t_ns"]), TOUCHES[int(event["kind"])]) for event in _touches(frames.events)]
        begun += [(cue.t_ns, cue.kind) for cue in audio.cues]
        begun += [(order.t_ns, order.sound) for order in audio.sounds]
        cue = self._watch.poll(frames.orders)
        begun += [(now_ns, cue)] if cue else []
        for t_ns, name in begun:
            self._count += 1
            self._sounds.append(SoundNote(self._count, t_ns, name))

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
            cords=tuple(_cord_note(name, cord) for name, cord in self._world.cords.items()),
            effects=_effects_note(self._world.effects),
        )

    def _begin(self) -> None:
        table = self._world.transforms
        self._revision = table.revision
        self._translations, self._rotations = table.translations.copy(), table.rotations.copy()
        self._scales, self._visible = table.scales.copy(), table.visible.copy()
        self._ever = np.zeros(len(table), bool)


def _touches(events: Records) -> Records:
    """Return those of EVENT records [n] that a sound may be assigned to."""
    return events[np.isin(events["kind"], list(TOUCHES))]


def _cord_note(name: str, cord: Cord) -> CordNote:
    ends, ball = cord.ends.tolist(), cord.ball.tolist()
    return CordNote(name, ends, cord.length, cord.radius, cord.colour, cord.visible, cord.swing, ball, list(cord.taps))


def _effects_note(effects: Effects) -> EffectsNote:
    bursts = [
        BurstNote(burst.emitter, burst.number, burst.born_s, burst.world_from_emitter.ravel().tolist())
        for burst in effects.bursts
    ]
    return EffectsNote(effects.time, effects.seed, bursts)
