"""Plays the clips of one model: layers over each other, then whatever reaches or looks, into the nodes of the world."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mimics_app.contracts.arrays import F8, I4
from mimics_app.contracts.errors import nearest
from mimics_app.world.motion.clip import Clip, ClipEvent
from mimics_app.world.motion.layer import Layer
from mimics_app.world.motion.pose import Pose
from mimics_app.world.transforms import TransformTable

__all__ = ["Animator", "Rig", "mask_of"]


@dataclass(frozen=True, eq=False)
class Rig:
    """The nodes of a model as slots, parents before children.

    Attributes:
        names: Of the nodes in their file, "" for none.
        entities: Entity index of each, int32 [slots].
        parents: Slot each hangs on, -1: on what the model stands on; int32 [slots].
        rest: As they are in the file.
        morph_first: First morph weight of each slot, int32 [slots + 1].
        morph_names: Of all morph weights, "" for none.
        fixed: How many of the first slots stand where the scene puts them, whatever a pose says.
    """

    names: tuple[str, ...]
    entities: I4
    parents: I4
    rest: Pose
    morph_first: I4
    morph_names: tuple[str, ...]
    fixed: int = 0

    def slot(self, name: str) -> int:
        """The slot of a node.

        Raises:
            KeyError: there is none of that name; the message names the nearest.
        """
        if name not in self.names:
            raise KeyError(f'no node "{name}" in the model; {nearest(name, self.names)}')
        return self.names.index(name)

    def below(self, slot: int) -> list[int]:
        """A slot and all that hang on it."""
        inside = {slot}
        for each in range(slot + 1, len(self.names)):
            if int(self.parents[each]) in inside:
                inside.add(each)
        return sorted(inside)


PoseStep = Callable[[Pose, float], None]
"""Changes a pose after the clips: (pose, seconds since the last one)."""


class Animator:
    """What one model does.

    Args:
        rig: Its nodes.
        clips: What it can do; targets are slots.

    Attributes:
        clips: By name.
        layers: Lowest first; what is faded out leaves on its own.
        directors: Called with the seconds before each step: they decide what plays.
        steps: Called in order after the clips: reaching, looking, blinking, what a tracker says.
        pose: As of the last step.
        events: What the clips passed in the last step.
        moves: False leaves the nodes as they are, for a model that is posed by hand.
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
        """Do nothing any more: no layer, no director, no step."""
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
        """Lay a clip over what plays.

        Args:
            name: Of the clip.
            at: Where in it to begin [s].
            speed: Seconds of the clip in a second.
            loop: False holds its last frame.
            weight: 0 to 1.
            fade: Seconds in which it comes up.
            mask: Share of the weight by slot (see `mask_of`); None: all of it everywhere.
            additive: Add what it differs from its first frame.

        Raises:
            KeyError: there is no such clip; the message names the nearest.
        """
        if name not in self.clips:
            known = nearest(name, self.clips) if self.clips else "the model has no clips"
            raise KeyError(f'no clip "{name}"; {known}')
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
        """Have another clip play in place of the one below all others.

        The old one goes on below the new until that has come up whole, so that nothing of the rest pose is seen.

        Args:
            name: Of the clip.
            fade: In which it comes up [s].
            speed: As `play`.
            loop: As `play`.

        Raises:
            KeyError: there is no such clip.
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
        """Fade out all that plays, at once or within a time [s]."""
        for layer in self.layers:
            layer.fade(0.0, fade)

    def step(self, seconds: float) -> None:
        """Let time go by and compute the pose."""
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
        """Before the first step: what the nodes have been set to by now is how the model rests."""
        if self._order != transforms.revision:
            self._order, self._rows = transforms.revision, transforms.rows(self.rig.entities)
        if not self._begun:
            self._begun, rest = True, self.rig.rest
            rest.translations[:] = transforms.translations[self._rows]
            rest.rotations[:] = transforms.rotations[self._rows]
            rest.scales[:] = transforms.scales[self._rows]

    def place(self, transforms: TransformTable) -> None:
        """Hand the pose to the nodes; they are where it says after the world's update."""
        first, pose = self.rig.fixed, self.pose
        transforms.set_poses(self._rows[first:], pose.translations[first:], pose.rotations[first:])
        transforms.set_scales(self._rows[first:], pose.scales[first:])


def mask_of(rig: Rig, names: Sequence[str]) -> F8:
    """1 for some nodes and all that hang on them, 0 for the others, [slots].

    Raises:
        KeyError: a node of that name is not there; the message names the nearest.
    """
    mask = np.zeros(len(rig.names))
    for name in names:
        mask[rig.below(rig.slot(name))] = 1.0
    return mask
