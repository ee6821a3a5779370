"""A walk out of speed and step length, or out of angles of hip and knee: feet that stand do not slip.

Both are laid over the clips of a model: legs by reaching, the pelvis, trunk and arms by swinging along. Where angles
are given the legs follow them as far as the foot that stands allows; what was changed is reported.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimics_app.maths.quat import multiply
from mimics_app.world.motion.animator import Rig
from mimics_app.world.motion.humanoid import HumanoidMap
from mimics_app.world.motion.kernels.chain import localise
from mimics_app.world.motion.kernels.gait import foot_path
from mimics_app.world.motion.pose import Pose
from mimics_app.world.motion.reach import Chain, LimbReach

__all__ = ["Gait", "Pace", "Walk"]

F8 = NDArray[np.float64]

_SWING_HEIGHT = 0.05
"""Of the ankle above its path along the ground, in lengths of the leg."""
_HEEL_PITCH, _TOE_PITCH = math.radians(18.0), math.radians(38.0)
"""Pitch of the foot when the heel touches and when the toes leave at 1.4 m/s; less when slower."""
_PREFERRED = 1.4
"""Speed at which people walk [m/s]."""
_SINK = 0.03
"""Of the leg's length that the hips are lower than standing, so that both feet reach, for a step of half a leg."""
_BOB, _SWAY = 0.02, 0.02
"""How far hips rise and shift to the side at 1.4 m/s [m]."""
_PELVIS, _TRUNK, _ARMS = math.radians(5.0), math.radians(7.0), math.radians(22.0)
"""How far pelvis and trunk turn against each other and the arms swing at 1.4 m/s [rad]."""


@dataclass(frozen=True, slots=True)
class Pace:
    """How somebody walks.

    Attributes:
        speed: [m/s].
        step: From one foot to the other [m].
    """

    speed: float
    step: float

    @property
    def cadence(self) -> float:
        """Cycles of two steps in a second [1/s]."""
        return self.speed / (2.0 * self.step) if self.step > 0.0 else 0.0

    @property
    def stance(self) -> float:
        """Share of a cycle in which a foot stands: 62 % at 1.4 m/s, more when slower (Murray et al. 1966)."""
        return min(0.72, max(0.58, 0.62 + 0.05 * (_PREFERRED - self.speed)))


@dataclass(frozen=True, eq=False)
class Gait:
    """What a walk came to in a step, for reports.

    Attributes:
        phase: Of the left foot, 0: its heel touches.
        contacts: Points of contact of both feet in the model's frame [m], [2, 3]; rows of a foot in the air are nan.
        way: How far the model went ahead in this step [m].
        hip, knee: Angles of both sides in the plane ahead, flexion positive [rad], [2] each.
        correction: Root mean square of what given angles of hip and knee were changed by so far [rad].
        touched: Sides whose heel touched the ground in this step.
    """

    phase: float
    contacts: F8
    way: float
    hip: F8
    knee: F8
    correction: float
    touched: tuple[str, ...]


class Walk:
    """Walks a model; a step of an animator.

    Args:
        rig: The model's nodes, its bones turned as the model's axes at rest: +y up, +z ahead.
        bones: Its bones.
        pace: Gives speed and step length now.
        angles: Gives angles of hip and knee [rad] at a phase of the cycle, [left hip, left knee, right hip, right
            knee], flexion positive; None: the feet follow a path of their own.
        move: Called with the way ahead in each step [m]: moves what the model stands on.

    Attributes:
        gait: What the last step came to.
    """

    def __init__(
        self,
        rig: Rig,
        bones: HumanoidMap,
        pace: Callable[[], Pace],
        *,
        angles: Callable[[float], F8] | None = None,
        move: Callable[[float], None] | None = None,
    ) -> None:
        self._rig, self._bones, self._pace, self._angles, self._move = rig, bones, pace, angles, move
        self._rest, self._chain = Chain(rig), Chain(rig)
        self._feet = [bones.limb(f"{side}_leg") for side in ("left", "right")]
        self._goals = [np.zeros(3), np.zeros(3)]
        self._legs = [
            LimbReach(rig, joints, lambda k=k: self._goals[k], lambda hip: hip + (0.0, -0.1, 1.0), soft=0.005)  # type: ignore[misc]
            for k, joints in enumerate(self._feet)
        ]
        places = self._rest.places
        self._leg = float(places[self._feet[0][0], 1] - places[self._feet[0][2], 1])
        self._phase, self._sum, self._count = 0.0, 0.0, 0
        self._shape = self._foot_shape()
        self.gait = Gait(0.0, np.full((2, 3), np.nan), 0.0, np.zeros(2), np.zeros(2), 0.0, ())

    def __call__(self, pose: Pose, seconds: float) -> None:
        pace = self._pace()
        before, self._phase = self._phase, (self._phase + pace.cadence * seconds) % 1.0
        vigour = min(1.3, pace.speed / _PREFERRED)
        self._swing(pose, vigour)
        contacts = np.full((2, 3), np.nan)
        touched = []
        for k, side in enumerate(("left", "right")):
            phase = (self._phase + 0.5 * k) % 1.0
            contacts[k] = self._aim_foot(k, phase, pace, vigour)
            if phase < (before + 0.5 * k) % 1.0:
                touched.append(side)
        wanted = None if self._angles is None else np.asarray(self._angles(self._phase), np.float64)
        if wanted is not None:
            self._follow_angles(pose, wanted, pace)
        for leg in self._legs:
            leg(pose, seconds)
        self._chain.follow(pose)
        hip, knee = self._measure()
        if wanted is not None:
            self._sum += float(((np.stack([hip, knee], 1).ravel() - wanted) ** 2).sum())
            self._count += wanted.size
        self._flatten(pose, pace, vigour)
        way = pace.speed * seconds
        if self._move is not None:
            self._move(way)
        correction = math.sqrt(self._sum / self._count) if self._count else 0.0
        self.gait = Gait(self._phase, contacts, way, hip, knee, correction, tuple(touched))

    def _foot_shape(self) -> F8:
        """The foot as `foot_path` wants it, the pitches as at 1.4 m/s."""
        foot = self._feet[0][2]
        toes = self._bones.slots.get("leftToes", -1)
        height = float(self._rest.places[foot, 1])
        length = float(self._rest.places[toes, 2] - self._rest.places[foot, 2]) if toes >= 0 else 0.14
        return np.array([height, 0.3 * length, length, _SWING_HEIGHT * self._leg, _HEEL_PITCH, _TOE_PITCH])

    def _aim_foot(self, k: int, phase: float, pace: Pace, vigour: float) -> F8:
        """Set where an ankle goes; returns the point of contact, nan in the air."""
        shape, out = self._shape.copy(), np.empty(5)
        shape[4:] *= vigour
        foot_path(phase, pace.stance, 2.0 * pace.step, shape, out)
        ankle = self._rest.places[self._feet[k][2]]
        ground = ankle[1] - shape[0]
        self._goals[k][:] = (ankle[0], ground + out[1], ankle[2] + out[0])
        return np.array([ankle[0], ground, ankle[2] + out[3]]) if out[4] else np.full(3, np.nan)

    def _swing(self, pose: Pose, vigour: float) -> None:
        """Pelvis, trunk and arms: turned with the leg that is ahead, arms against it; hips sink, bob and sway."""
        slots, turn = self._bones.slots, 2.0 * math.pi * self._phase
        ahead = math.cos(turn)  # 1: the left foot is ahead
        hips = slots["hips"]
        step = self._pace().step
        sink = self._leg * (_SINK * min(2.6, (step / (0.5 * self._leg)) ** 2) if self._leg > 0.0 else 0.0)
        pose.translations[hips] = self._rig.rest.translations[hips] + (
            _SWAY * vigour * math.sin(turn),
            -sink - _BOB * vigour * math.cos(2.0 * turn),
            0.0,
        )
        self._chain.follow(pose)
        self._turn(pose, "hips", (0.0, 1.0, 0.0), -_PELVIS * vigour * ahead)
        for bone in ("spine", "chest"):
            self._turn(pose, bone, (0.0, 1.0, 0.0), 0.5 * (_PELVIS + _TRUNK) * vigour * ahead)
        for side, sign in (("left", 1.0), ("right", -1.0)):
            swing = _ARMS * vigour * sign * ahead
            self._turn(pose, f"{side}UpperArm", (1.0, 0.0, 0.0), swing)
            self._turn(pose, f"{side}LowerArm", (1.0, 0.0, 0.0), -0.35 * vigour * (1.0 - 0.6 * sign * ahead))

    def _turn(self, pose: Pose, bone: str, axis: tuple[float, float, float], angle: float) -> None:
        """Turn a bone about an axis of the model, from how it is now."""
        slot = self._bones.slots.get(bone, -1)
        if slot < 0:
            return
        turn, turned = np.array([*(math.sin(0.5 * angle) * part for part in axis), math.cos(0.5 * angle)]), np.empty(4)
        multiply(turn, self._chain.turns[slot], turned)
        localise(slot, turned, self._rig.parents, self._chain.turns, pose.rotations)
        for below in self._rig.below(slot)[1:]:
            self._chain.follow_slot(pose, below)

    def _follow_angles(self, pose: Pose, wanted: F8, pace: Pace) -> None:
        """Put the ankles where given angles have them; a foot that stands keeps its place over the ground instead."""
        places = self._chain.places
        self._chain.follow(pose)
        for k, (hip, knee, foot) in enumerate(self._feet):
            thigh = float(np.linalg.norm(places[knee] - places[hip]))
            shank = float(np.linalg.norm(places[foot] - places[knee]))
            lean, bend = wanted[2 * k], wanted[2 * k] - wanted[2 * k + 1]
            ahead = thigh * math.sin(lean) + shank * math.sin(bend)
            down = thigh * math.cos(lean) + shank * math.cos(bend)
            phase = (self._phase + 0.5 * k) % 1.0
            if phase >= pace.stance:
                # Toes and heel stay above the ground, whatever the angles say.
                x = (phase - pace.stance) / (1.0 - pace.stance)
                share = math.sin(math.pi * x) ** 2
                own = self._goals[k]
                asked = np.array([own[0], places[hip, 1] - down, places[hip, 2] + ahead])
                asked[1] = max(asked[1], own[1] * 0.9)
                self._goals[k][:] = (1.0 - share) * own + share * asked

    def _flatten(self, pose: Pose, pace: Pace, vigour: float) -> None:
        """Pitch the feet as their phase has them."""
        shape, out = self._shape.copy(), np.empty(5)
        shape[4:] *= vigour
        for k, joints in enumerate(self._feet):
            foot_path((self._phase + 0.5 * k) % 1.0, pace.stance, 2.0 * pace.step, shape, out)
            foot, turned = joints[2], np.empty(4)
            pitch = np.array([-math.sin(0.5 * out[2]), 0.0, 0.0, math.cos(0.5 * out[2])])
            multiply(pitch, self._rest.turns[foot], turned)
            localise(foot, turned, self._rig.parents, self._chain.turns, pose.rotations)

    def _measure(self) -> tuple[F8, F8]:
        """Flexion of both hips and knees in the plane ahead [rad]."""
        hips, knees, places = np.empty(2), np.empty(2), self._chain.places
        for k, (hip, knee, foot) in enumerate(self._feet):
            thigh, shank = places[knee] - places[hip], places[foot] - places[knee]
            hips[k] = math.atan2(thigh[2], -thigh[1])
            knees[k] = hips[k] - math.atan2(shank[2], -shank[1])
        return hips, knees
