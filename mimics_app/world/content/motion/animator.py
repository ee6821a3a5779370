"""Animator: blends the clips of one model in layers, applies procedural steps, and writes the pose to its nodes."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from mimics_app.contracts.arrays import F8, I4
from mimics_app.contracts.errors import nearest
from mimics_app.maths.quat import rotate
from mimics_app.world.content.motion.clip import Clip, ClipEvent
from mimics_app.world.content.motion.layer import Layer
from mimics_app.world.content.motion.pose import Pose
from mimics_app.world.content.motion.rig import Rig
from mimics_app.world.graph.transforms import TransformTable

__all__ = ["Animator", "RootMotion", "mask_of"]


class RootMotion:
    """Root motion: a joint keeps its horizontal rest position, the model moves instead; an animator's last step.

    Args:
        animator: Animator whose layers move the joint.
        slot: The joint.
        transforms: Transform table of the world.
        entity: Entity index of the model's node.

    Attributes:
        travel: Displacement of the model in the last step, in its own frame [m], [3].
    """

    def __init__(self, animator: Animator, slot: int, transforms: TransformTable, entity: int) -> None:
        self._animator, self._slot = animator, slot
        self._transforms, self._entity = transforms, entity
        self._scratch = animator.rig.rest.copy()
        self.travel: F8 = np.zeros(3)

    def __call__(self, pose: Pose, seconds: float) -> None:
        travel, share = np.zeros(3), 0.0
        for layer in self._animator.layers:
            if layer.weight > 0.0 and layer.moves(self._slot) and not layer.additive:
                travel = (1.0 - layer.weight) * travel + layer.weight * layer.travel(self._slot, self._scratch)
                share = max(share, layer.weight)
        travel[1] = 0.0
        rest = self._animator.rig.rest.translations[self._slot]
        pose.translations[self._slot, [0, 2]] = rest[[0, 2]]
        self.travel = travel
        if share > 0.0 and travel.any():
            moved, table, index = np.empty(3), self._transforms, self._entity
            rotate(table.rotation(index), travel * table.scale(index), moved)
            table.set_translation(index, table.translation(index) + moved)


PoseStep = Callable[[Pose, float], None]
"""Procedural step that changes a pose after the clips: (pose, time since the last call [s])."""


class Animator:
    """Animation state of one model.

    Args:
        rig: Nodes of the model.
        clips: Its clips, with slots as targets.

    Attributes:
        clips: Clips by name.
        layers: Layers, lowest first; one that is faded out is removed.
        directors: Called with the time step [s] before each step, to start and stop clips.
        steps: Procedural steps after the clips, in order: reach, look-at, blink, trackers.
        pose: Pose of the last step.
        events: Events of the clips in the last step.
        moves: False: the nodes are not written, for a model that is posed otherwise.
    """

    def __init__(self, rig: Rig, clips: Sequence[Clip]) -> None:
        self.rig = rig
        self.clips: Mapping[str, Clip] = {clip.name: clip for clip in clips}
        self.layers: list[Layer] = []
        self.directors: list[Callable[[float], None]] = []
        self._ground: list[Layer] = []
        self.steps: list[PoseStep] = []
        self.pose = rig.rest.copy()
        self.events: list[ClipEvent] = []
        self.moves = False
        self._rows: I4 = np.zeros(0, np.int32)
        self._order = -1
        self._begun = False

    def reset(self) -> None:
        """Remove all layers, directors and steps."""
        for what in (self.layers, self.directors, self.steps, self._ground):
            what.clear()

    def play(
        self,
        name: str,
        *,
        at: float = 0.0,
        speed: float = 1.0,
        loop: bool = True,
        weight: float = 1.0,
        fade: float = 0.0,
        mask: F8 | None = None,
        additive: bool = False,
    ) -> Layer:
        """Play a clip in a new layer on top.

        Args:
            name: Name of the clip.
            at: Start time in the clip [s].
            speed: Seconds of the clip per second.
            loop: False holds its last frame.
            weight: Blend weight, 0 to 1.
            fade: Duration of the fade-in [s].
            mask: Factor on the weight by slot (see `mask_of`); None: 1 everywhere.
            additive: True: its difference from its first frame is added.

        Raises:
            KeyError: the clip is unknown; the message names the nearest.
            ValueError: a number is not finite; it would stay in the pose of every later frame.
        """
        if name not in self.clips:
            known = nearest(name, self.clips) if self.clips else "the model has no clips"
            raise KeyError(f'no clip "{name}"; {known}')
        if not all(map(math.isfinite, (at, speed, weight, fade))):
            raise ValueError(f"a clip cannot play at {at} s with speed {speed}, weight {weight} and a fade of {fade} s")
        layer = Layer(
            self.clips[name],
            self.rig.rest,
            self.rig.morph_first,
            speed=speed,
            loop=loop,
            weight=weight if fade <= 0.0 else 0.0,
            mask=mask,
            additive=additive,
        )
        if fade > 0.0:
            layer.fade(weight, fade)
        layer.at = min(max(at, 0.0), layer.clip.duration)
        self.layers.append(layer)
        self.moves = True
        return layer

    def change(self, name: str, fade: float, speed: float = 1.0, loop: bool = True) -> Layer:
        """Cross-fade the lowest layer to another clip.

        The old clip plays on below the new one until that has full weight, so that the rest pose never shows.

        Args:
            name: Name of the clip.
            fade: Duration of the cross-fade [s].
            speed: As `play`.
            loop: As `play`.

        Raises:
            KeyError: the clip is unknown.
            ValueError: a number is not finite.
        """
        self._ground = [layer for layer in self._ground if layer in self.layers]
        for layer in self._ground:
            layer.retire(fade)
        layer = self.play(name, speed=speed, loop=loop, fade=fade if self._ground else 0.0)
        self.layers.remove(layer)
        self.layers.insert(len(self._ground), layer)
        self._ground.append(layer)
        return layer

    def stop(self, fade: float = 0.0) -> None:
        """Fade out all layers within a time [s]; 0: at once."""
        for layer in self.layers:
            layer.fade(0.0, fade)

    def step(self, seconds: float) -> None:
        """Advance the time and compute the pose."""
        for direct in self.directors:
            direct(seconds)
        self.events = [event for layer in self.layers for event in layer.step(seconds)]
        self.layers = [layer for layer in self.layers if not layer.gone]
        self.pose.take(self.rig.rest)
        for layer in self.layers:
            layer.apply(self.pose)
        for change in self.steps:
            change(self.pose, seconds)

    def begin(self, transforms: TransformTable) -> None:
        """Take the present transforms of the nodes as rest pose, before the first step only."""
        if self._order != transforms.revision:
            self._order, self._rows = transforms.revision, transforms.rows(self.rig.entities)
        if not self._begun:
            self._begun, rest = True, self.rig.rest
            rest.translations[:] = transforms.translations[self._rows]
            rest.rotations[:] = transforms.rotations[self._rows]
            rest.scales[:] = transforms.scales[self._rows]

    def place(self, transforms: TransformTable) -> None:
        """Write the pose to the Transform table; it takes effect at the world's update."""
        first, pose = self.rig.fixed, self.pose
        transforms.set_poses(self._rows[first:], pose.translations[first:], pose.rotations[first:])
        transforms.set_scales(self._rows[first:], pose.scales[first:])


def mask_of(rig: Rig, names: Sequence[str]) -> F8:
    """Return a mask: 1 for some nodes and their descendants, 0 for the others, [slots].

    Raises:
        KeyError: the node is unknown; the message names the nearest.
    """
    mask = np.zeros(len(rig.names))
    for name in names:
        mask[rig.below(rig.slot(name))] = 1.0
    return mask
