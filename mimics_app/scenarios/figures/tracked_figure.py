"""A person's model that follows the tracked head and hands of a person, with attachment points for a cord."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.errors import SceneError
from mimics_app.maths.poses import conjugate, quaternion_of, rotate_vector
from mimics_app.world.content.motion.animator import Animator
from mimics_app.world.content.motion.humanoid import HumanoidMap, find_humanoid
from mimics_app.world.content.motion.kernels.chain import localise
from mimics_app.world.content.motion.pose import Pose
from mimics_app.world.content.motion.reach import Chain, LimbReach
from mimics_app.world.content.motion.rig import Rig
from mimics_app.world.content.motion.upper_body import Trackers, UpperBody
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.scene import Scene

__all__ = ["TrackedFigure"]

Parts = Mapping[str, F8 | None]

_LEAST_STANDING, _MOST_STANDING = 1.2, 2.1
"""Range of the eye height of standing people [m]; beyond, the tracker is at fault or the person sits."""
_FADE_S = 0.5
"""Crossfade between idling and tracking [s]."""
_LONGEST_ARM, _ARM_GROWTH = 1.15, 0.05
"""Largest factor on the model's arms, and its growth [1/s]: a tracker that errs for a moment lengthens nothing."""
_SHORT_BY = 0.005
"""Distance by which a wrist may miss its tracker before the arm counts as too short [m]."""
_STEP_FREE = 0.15
"""Horizontal displacement of the head that the feet do not follow [m]."""
_STOMACH, _BACK = ("chest", 1.0), ("upperChest", -1.0)
"""Joint at whose height the cord is attached, and its side: front (1) or back (-1)."""
_END_DEPTH = 0.012
"""Depth of the cord's end below the surface, which hides its rim [m]."""
_PATCH = 0.04
"""Distance from the joint's height and from the median plane within which vertices form its surface [m]."""
_TURNED = np.diag([-1.0, 1.0, -1.0])
"""Rotation between the model's frame, which looks along +z, and a person's, which looks along -z."""


_KNEE_AHEAD = np.array([0.0, 0.0, 1.0])
"""Direction of the knees from the hip, in the frame of a model [m]."""


class _PlantedFeet:
    """Bends hips and knees so that both feet stand flat as the model rests; a step after those that move the hips.

    Args:
        rig: The model's nodes.
        bones: Bones of the person.
    """

    def __init__(self, rig: Rig, bones: HumanoidMap) -> None:
        rest = Chain(rig)
        self._rig, self._chain = rig, Chain(rig)
        self._legs = [bones.limb(f"{side}_leg") for side in ("left", "right")]
        self._flat = [rest.turns[foot].copy() for _, _, foot in self._legs]
        self._reach = [
            LimbReach(rig, leg, _always(rest.places[leg[2]].copy()), lambda hip: np.asarray(hip + _KNEE_AHEAD))
            for leg in self._legs
        ]

    def __call__(self, pose: Pose, seconds: float) -> None:
        for leg, flat, reach in zip(self._legs, self._flat, self._reach, strict=True):
            reach(pose, seconds)
            self._chain.follow(pose)
            localise(leg[2], flat, self._rig.parents, self._chain.turns, pose.rotations)


def _always(place: NDArray[np.float64]) -> Callable[[], NDArray[np.float64]]:
    return lambda: place


class TrackedFigure:
    """A person's model in a scene. Without tracking it idles; an untracked hand moves as in idling.

    Args:
        scene: The scene, for error messages.
        world: The world of the model.
        entity: Entity with the model.
        standing: Height of its eyes before any tracking [m].

    Raises:
        SceneError: The entity is missing, or its model is not humanoid.

    Attributes:
        scale: Height of the person over that of the model [-].
        arms: Length of the person's arms over that of the model's at that height [-]: 1 until a wrist is tracked
            farther away than the arm reaches.
    """

    def __init__(self, scene: Scene, world: World, entity: str, standing: float) -> None:
        self._world = world
        self._animator, bones = _person(scene, world, entity)
        self._node = world.find(entity)
        rig = self._animator.rig
        self._animator.moves = False  # posed here, before the world's update: the cord is fixed to it in the same frame
        self._rest, self._chain = Chain(rig), Chain(rig)
        self._bones = bones
        self._eyes = _eyes(self._rest, bones)
        self._palms = [_palm(rig, self._rest, side) for side in ("left", "right")]
        self._tracked: Trackers | None = None
        self._upper = UpperBody(rig, bones, lambda: self._tracked)
        self._upper.weight = 0.0
        self._feet = _PlantedFeet(rig, bones)
        self._sockets = {"stomach": self._socket(*_STOMACH), "back": self._socket(*_BACK)}
        self._eye_height = float(self._rest.places[bones.slots["head"], 1] + self._eyes[1])
        self._standing = 0.0
        self._t_ns: int | None = None
        self._world_from_model = np.eye(4)
        self.scale = standing / self._eye_height
        self.arms = 1.0
        self._arm_slots = [bones.slots[f"{side}{part}"] for side in ("left", "right") for part in ("LowerArm", "Hand")]

    @property
    def stomach(self) -> F8:
        """Attachment point of a cord at its stomach, world [m], float64 [3]."""
        return self._place(*self._sockets["stomach"])

    @property
    def back(self) -> F8:
        """Attachment point of a cord at its back, world [m], float64 [3]."""
        return self._place(*self._sockets["back"])

    @property
    def head(self) -> F8:
        """Midpoint of its eyes, world [m], float64 [3]."""
        return self._place(self._bones.slots["head"], self._eyes)

    def show(self, visible: bool) -> None:
        """Show or hide the model."""
        self._node.visible = visible

    def pose(self, world_from_ground: F8, parts: Parts, now_ns: int) -> None:
        """Pose the model.

        Args:
            world_from_ground: Frame on the ground below the eyes at rest, -z to the front; float64 [4, 4].
            parts: "head" (the eyes), "hand_left", "hand_right", each ground_from_part, float64 [4, 4];
                None: not tracked. A hand's fingers point along its -z; +y is the normal of its back.
            now_ns: Session time [ns].
        """
        seconds = 0.0 if self._t_ns is None else (now_ns - self._t_ns) * 1e-9
        self._t_ns = now_ns
        eyes = parts["head"]
        self._measure(eyes)
        share = seconds / _FADE_S if eyes is not None else -seconds / _FADE_S
        self._upper.weight = min(max(self._upper.weight + share, 0.0), 1.0)
        ground_from_model = self._stand(eyes)
        if eyes is not None:
            self._tracked = self._trackers(ground_from_model, eyes, parts)
        self._world_from_model = world_from_ground @ ground_from_model
        self._node.set_position(self._world_from_model[:3, 3])
        self._node.set_orientation(quaternion_of(world_from_ground[:3, :3] @ _TURNED))
        self._node.set_scale((self.scale,) * 3)
        self._move(seconds)

    def _move(self, seconds: float) -> None:
        animator, transforms = self._animator, self._world.transforms
        animator.begin(transforms)
        animator.step(seconds)
        animator.pose.translations[self._arm_slots] *= self.arms
        self._upper(animator.pose, seconds)
        self._feet(animator.pose, seconds)
        self._chain.follow(animator.pose)
        animator.place(transforms)
        self._lengthen(seconds)

    def _lengthen(self, seconds: float) -> None:
        """Let the arms grow while a tracked wrist is farther away than they reach."""
        if self._tracked is None or self._upper.weight < 1.0:
            return
        for hand, slot in zip((self._tracked.left, self._tracked.right), self._arm_slots[1::2], strict=True):
            if hand is not None and float(np.linalg.norm(hand[:3] - self._chain.places[slot])) > _SHORT_BY:
                self.arms = min(self.arms + _ARM_GROWTH * seconds, _LONGEST_ARM)
                return

    def _measure(self, eyes: F8 | None) -> None:
        """Scale the model to the largest eye height of the standing person."""
        if eyes is not None and _LEAST_STANDING <= eyes[1, 3] <= _MOST_STANDING:
            self._standing = max(self._standing, float(eyes[1, 3]))
            self.scale = self._standing / self._eye_height

    def _stand(self, eyes: F8 | None) -> F8:
        """Return ground_from_model; the model keeps its place while the head moves by less than `_STEP_FREE`."""
        stands = np.eye(4)
        stands[:3, :3] = self.scale * _TURNED
        rest = self._rest.places[self._bones.slots["head"]] + self._eyes
        stands[:3, 3] = -self.scale * (_TURNED @ (rest * [1.0, 0.0, 1.0]))
        if eyes is not None:
            away = eyes[:3, 3] * [1.0, 0.0, 1.0]
            far = float(np.linalg.norm(away))
            if far > _STEP_FREE:
                stands[:3, 3] += self._upper.weight * (1.0 - _STEP_FREE / far) * away
        return stands

    def _trackers(self, ground_from_model: F8, eyes: F8, parts: Parts) -> Trackers:
        """Return the tracked poses as positions and rotations of the model's joints, in its frame."""
        turn = _TURNED.T @ eyes[:3, :3] @ _TURNED
        place = _inside(ground_from_model, self.scale, eyes[:3, 3]) - turn @ self._eyes
        hands: list[F8 | None] = []
        for side, palm in zip(("left", "right"), self._palms, strict=True):
            hand = parts[f"hand_{side}"]
            if hand is None:
                hands.append(None)
                continue
            turned = quaternion_of(_TURNED.T @ hand[:3, :3] @ _TURNED @ palm)
            hands.append(np.concatenate([_inside(ground_from_model, self.scale, hand[:3, 3]), turned]))
        return Trackers(np.concatenate([place, quaternion_of(turn)]), *hands)

    def _socket(self, bone: str, side: float) -> tuple[int, F8]:
        """Return the joint of an attachment point on the body's surface, and its offset at rest [m]."""
        slot = self._bones.slots.get(bone, self._bones.slots["spine"])
        joint = self._rest.places[slot]
        points = self._surface()
        near = points[(np.abs(points[:, :2] - joint[:2]) < _PATCH).all(axis=1)]
        depth = float((side * near[:, 2]).max(initial=0.05)) - _END_DEPTH
        return slot, np.array([0.0, 0.0, side * depth - joint[2]])

    def _surface(self) -> F8:
        """Return the model's vertices at rest [m], [n, 3]."""
        inside = self._world.graph.hierarchy.is_inside
        bodies = [body for body in self._world.motion.bodies.values() if inside(body.entity, self._node.index)]
        return np.vstack([mesh.positions.astype(np.float64) for body in bodies for mesh in body.meshes.values()])

    def _place(self, slot: int, offset: F8) -> F8:
        """Return the position of a point fixed to a joint, world [m]; the offset is in the model's axes at rest."""
        inside = self._chain.places[slot] + rotate_vector(
            self._chain.turns[slot], rotate_vector(conjugate(self._rest.turns[slot]), offset)
        )
        return np.asarray(self._world_from_model[:3, :3] @ inside + self._world_from_model[:3, 3])


def _person(scene: Scene, world: World, entity: str) -> tuple[Animator, HumanoidMap]:
    if entity not in world:
        what, hint = f'the scene has no entity "{entity}"', 'add it, with a "mesh" that shows a person\'s model'
        raise SceneError(scene.issue("/entities", what, hint))
    animator = world.motion.animators.get(world.find(entity).index)
    bones = None if animator is None else find_humanoid(animator.rig)
    if animator is None or bones is None or bones.missing:
        missing = "joints" if bones is None else ", ".join(bones.missing)
        what = f'the model of "{entity}" is not humanoid: it has no {missing}'
        raise SceneError(scene.issue("/entities", what, "see mimics avatar import"))
    return animator, bones


def _eyes(rest: Chain, bones: HumanoidMap) -> F8:
    """Return the midpoint of the eyes relative to the head's joint [m], [3]; an average for models without eyes."""
    both = [rest.places[bones.slots[eye]] for eye in ("leftEye", "rightEye") if eye in bones.slots]
    if len(both) < 2:
        return np.array([0.0, 0.08, 0.09])
    return np.asarray(0.5 * (both[0] + both[1]) - rest.places[bones.slots["head"]])


def _palm(rig: Rig, rest: Chain, side: str) -> F8:
    """Return the rotation of a hand from rest to fingers ahead and palm down, in the model's frame, [3, 3]."""
    names = [f"{side}{part}" for part in ("Hand", "MiddleProximal", "ThumbProximal")]
    if not all(name in rig.names for name in names):
        return np.eye(3)
    hand, finger, thumb = (rest.places[rig.slot(name)] for name in names)
    inwards = np.array([-1.0 if side == "left" else 1.0, 0.0, 0.0])
    return np.asarray(_axes(np.array([0.0, 0.0, 1.0]), inwards) @ _axes(finger - hand, thumb - hand).T)


def _axes(along: F8, aside: F8) -> F8:
    """Return a frame with the first axis along one direction and the second towards another, [3, 3]."""
    x = along / np.linalg.norm(along)
    y = aside - x * float(aside @ x)
    y = y / np.linalg.norm(y)
    return np.stack([x, y, np.cross(x, y)], axis=1)


def _inside(frame: F8, scale: float, place: F8) -> F8:
    """Return a point in a rotated and scaled frame, [3]."""
    return np.asarray(frame[:3, :3].T @ (place - frame[:3, 3]) / scale**2)
