"""An upright figure of simple bodies: head, trunk, arms that reach for the hands, legs. It stands in for a person."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from mimics_app.maths.poses import quaternion_of
from mimics_app.world.scene_node import SceneNode
from mimics_app.world.world import World

__all__ = ["FIGURE_PARTS", "StandInFigure", "reach"]

F8 = NDArray[np.float64]

FIGURE_PARTS = ("head", "hand_left", "hand_right")
"""Parts of a person that move the figure."""

_EYES_ABOVE, _EYES_BEFORE = 0.08, 0.09
"""Of the head's middle from the eyes [m]."""
_NECK, _SHOULDER, _HIP = 0.18, 0.27, 0.72
"""Below the eyes: neck, shoulders, hips [m]."""
_WIDE = 0.20
"""From the middle to a shoulder [m]."""
_UPPER, _LOWER = 0.29, 0.27
"""Arms [m]."""
_STOMACH_BELOW, _STOMACH_DEEP, _BACK_BELOW, _BACK_DEEP = 0.52, 0.11, 0.42, 0.11
"""Sockets of the cord from the eyes down, and from the trunk's middle line to its surface [m]."""
_BROAD = 0.20
"""Half the breadth of the trunk [m]."""
_THICK = {"trunk": 0.125, "upper": 0.045, "lower": 0.038, "leg": 0.07, "hand": 0.045, "neck": 0.05}


def reach(shoulder: F8, hand: F8, upper: float, lower: float, pole: F8) -> tuple[F8, F8]:
    """Elbow and hand of an arm of two bones; a hand out of reach stays on the way to it.

    Args:
        shoulder: [m], float64 [3].
        hand: Where it is wanted [m], float64 [3].
        upper: Length of the upper arm [m].
        lower: Of the lower one [m].
        pole: Where the elbow points, of any length, float64 [3].
    """
    way = hand - shoulder
    distance = float(np.linalg.norm(way))
    axis = way / distance if distance > 1e-9 else np.array([0.0, -1.0, 0.0])
    distance = min(max(distance, abs(upper - lower) + 1e-6), upper + lower - 1e-6)
    along = (distance**2 + upper**2 - lower**2) / (2.0 * distance)
    out = pole - axis * float(pole @ axis)
    length = float(np.linalg.norm(out))
    out = out / length if length > 1e-6 else np.array([1.0, 0.0, 0.0])
    elbow = shoulder + along * axis + math.sqrt(max(upper**2 - along**2, 0.0)) * out
    return elbow, shoulder + distance * axis


class StandInFigure:
    """One figure in a world.

    Args:
        world: Where it stands.
        name: Of its nodes' names.
        shirt: Material of its trunk and arms.
        skin: Of head and hands.
        trousers: Of its legs.
    """

    def __init__(self, world: World, name: str, shirt: str, skin: str, trousers: str) -> None:
        self._world, self._name = world, name
        self.nodes: dict[str, SceneNode] = {}
        self._stomach = self._back = np.zeros(3)
        for part, mesh, material in _bodies(shirt, skin, trousers):
            node = world.root.create_child(f"{name} {part}")
            node.create_entity(mesh, material)
            self.nodes[part] = node

    @property
    def stomach(self) -> F8:
        """Where a cord leaves its stomach, world [m], float64 [3]."""
        return self._stomach

    @property
    def back(self) -> F8:
        """The same of its back."""
        return self._back

    def show(self, visible: bool, *, head: bool = True) -> None:
        """Show or hide it; a person sees no head of one's own."""
        for part, node in self.nodes.items():
            node.visible = visible and (head or part not in ("head", "neck"))

    def pose(self, world_from_ground: F8, parts: Mapping[str, F8]) -> None:
        """Move it.

        Args:
            world_from_ground: Where it stands, -z to its front; float64 [4, 4].
            parts: Of `FIGURE_PARTS`, each ground_from_part, float64 [4, 4]; the head's is that of the eyes.
        """
        head = parts["head"]
        eyes, turn = head[:3, 3], _heading(head[:3, :3])
        right, forward = turn[:, 0], -turn[:, 2]
        down = np.array([0.0, -1.0, 0.0])
        hips = np.array([0.5 * eyes[0], eyes[1] - _HIP, 0.5 * eyes[2]]) - 0.5 * _EYES_BEFORE * forward
        neck = eyes + _NECK * down - _EYES_BEFORE * forward
        self._put("head", world_from_ground, eyes + 0.02 * down - _EYES_BEFORE * forward, head[:3, :3], (1.0,) * 3)
        self._span("neck", world_from_ground, neck + 0.02 * down, eyes - _EYES_BEFORE * forward)
        self._span("trunk", world_from_ground, hips, neck + 0.02 * down, right)
        for side, sign in (("left", -1.0), ("right", 1.0)):
            shoulder = eyes + _SHOULDER * down - _EYES_BEFORE * forward + sign * _WIDE * right
            pole = down * 1.0 - 0.4 * forward + 0.5 * sign * right
            elbow, hand = reach(shoulder, parts[f"hand_{side}"][:3, 3], _UPPER, _LOWER, pole)
            self._span(f"upper {side}", world_from_ground, shoulder, elbow)
            self._span(f"lower {side}", world_from_ground, elbow, hand)
            self._put(f"hand {side}", world_from_ground, hand, parts[f"hand_{side}"][:3, :3], (1.0,) * 3)
            foot = np.array([0.0, 0.08, 0.0]) + sign * 0.10 * np.array([1.0, 0.0, 0.0])
            self._span(f"leg {side}", world_from_ground, foot, hips + sign * 0.09 * right)
        stomach, back = (eyes + below * down - _EYES_BEFORE * forward for below in (_STOMACH_BELOW, _BACK_BELOW))
        self._stomach = _moved(world_from_ground, stomach + _STOMACH_DEEP * forward)
        self._back = _moved(world_from_ground, back - _BACK_DEEP * forward)

    def _span(self, part: str, world_from_ground: F8, start: F8, end: F8, side: F8 | None = None) -> None:
        """Stretch a body between two points, its y along them; one with a `side` is broad that way."""
        way = end - start
        length = max(float(np.linalg.norm(way)), 1e-6)
        y = way / length
        x = np.cross(y, [0.0, 0.0, 1.0]) if abs(y[2]) < 0.9 else np.cross(y, [1.0, 0.0, 0.0])
        x = x if side is None else side - y * float(side @ y)
        x = x / np.linalg.norm(x)
        axes = np.stack([x, y, np.cross(x, y)], axis=1)
        thick = _THICK[part.split()[0]]
        broad = thick if side is None else _BROAD
        self._put(part, world_from_ground, 0.5 * (start + end), axes, (broad, 0.5 * length + 0.3 * thick, thick))

    def _put(self, part: str, world_from_ground: F8, place: F8, axes: F8, scale: tuple[float, float, float]) -> None:
        node = self.nodes[part]
        node.set_position(_moved(world_from_ground, place))
        node.set_orientation(quaternion_of(world_from_ground[:3, :3] @ axes))
        size = {"head": 0.12, "hand": _THICK["hand"]}.get(part.split()[0], 1.0)
        node.set_scale(tuple(size * each for each in scale))


def _bodies(shirt: str, skin: str, trousers: str) -> list[tuple[str, str, str]]:
    both = ("left", "right")
    parts = [("head", _BALL, skin), ("neck", _BALL, skin), ("trunk", _BALL, shirt)]
    for side in both:
        parts += [(f"upper {side}", _BALL, shirt), (f"lower {side}", _BALL, skin), (f"hand {side}", _BALL, skin)]
        parts.append((f"leg {side}", _BALL, trousers))
    return parts


_BALL = "#figure ball"
"""Mesh that all parts are stretched from; `AvatarCord` puts it into the world."""


def _heading(rotation: F8) -> F8:
    """The part of a turn about the vertical, float64 [3, 3]."""
    back = rotation[:, 2] * np.array([1.0, 0.0, 1.0])
    length = float(np.linalg.norm(back))
    back = back / length if length > 1e-6 else np.array([0.0, 0.0, 1.0])
    return np.stack([np.array([back[2], 0.0, -back[0]]), np.array([0.0, 1.0, 0.0]), back], axis=1)


def _moved(pose: F8, point: F8) -> F8:
    return np.asarray(pose[:3, :3] @ point + pose[:3, 3])
