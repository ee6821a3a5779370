"""A walk out of speed and step length, or out of angles of hip and knee: feet that stand do not slip.

Legs follow the published curves of `reference_gait`, made to fit the step by reaching; pelvis, trunk and arms swing
along. Where angles are given the legs follow them as far as the foot that stands allows; what was changed is reported.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.maths.quat import multiply
from mimics_app.world.motion.animator import Rig
from mimics_app.world.motion.clip import ClipEvent
from mimics_app.world.motion.footholds import Footholds, Ground
from mimics_app.world.motion.humanoid import HumanoidMap
from mimics_app.world.motion.kernels.chain import localise
from mimics_app.world.motion.kernels.gait import place_feet
from mimics_app.world.motion.pose import Pose
from mimics_app.world.motion.reach import Chain, LimbReach
from mimics_app.world.motion.reference_gait import NATURAL_STANCE, SAMPLES, shape_gait, stance_share

__all__ = ["Gait", "Pace", "Walk", "natural_step"]


_PREFERRED = 1.3
"""Speed at which people walk [m/s]."""
_LIVELY = 1.3
"""Most that the swing of pelvis, trunk and arms grows beyond that at the preferred speed."""
_SWAY, _LIST = 0.02, math.radians(2.0)
"""How far hips shift to the side [m] and drop on the side of the foot in the air at the preferred speed."""
_PELVIS, _TRUNK, _ARMS = math.radians(5.0), math.radians(7.0), math.radians(20.0)
"""How far pelvis and trunk turn against each other and the arms swing at the preferred speed [rad]."""
_NATURAL_STEP = 0.80
"""Step of the published curves in lengths of the leg: what their angles reach on a leg of two equal bones."""
_LEG = 0.82
"""From hip to ankle of somebody 1.75 m tall [m]."""
_TABLE_SPEED, _TABLE_STRETCH = 0.02, 0.02
"""Steps of speed [m/s] and of the step's share between which one table of angles is used."""
_SOFT = 5e-4
"""Share of the leg's length in which a reach gives way: less than what a knee is bent by at the least."""
_LEAST_BEND = math.radians(3.7)
"""Of a knee that carries: just more than where the reach begins to give way."""
_SLACK = 0.15
"""How much higher hips may be than a foot in the air reaches, for each cycle until or since it stands [m]."""
_TOE_BEND = math.radians(60.0)
"""Farthest that toes bend up."""
_HEEL, _TIP = 0.5, 1.75
"""Heel behind the ankle and tip of the toes before it, for a ball that is 1 before it: feet of 265 mm."""
_SETTLE = 0.9
"""Cycles in a second while feet are brought under somebody who stands [1/s]."""
_LEAST_STEP = 0.12
"""Of the step's share below which feet are lifted no less [1]."""


@dataclass(frozen=True, slots=True)
class Pace:
    """How somebody walks.

    Attributes:
        speed: [m/s]; negative: backwards.
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
        """Share of a cycle in which a foot stands."""
        return stance_share(abs(self.speed))


def natural_step(speed: float, leg: float = _LEG) -> float:
    """Step that people with legs of a length [m] choose at a speed [m/s]: it grows with its root (Grieve 1968) [m]."""
    return _NATURAL_STEP * leg * math.sqrt(abs(speed) / _PREFERRED)


@dataclass(frozen=True, eq=False)
class Gait:
    """What a walk came to in a step, for reports.

    Attributes:
        phase: Of the left foot, 0: its heel touches.
        contacts: Points of contact of both feet in the model's frame [m], [2, 3]; rows of a foot in the air are nan.
        advance: How far the model went ahead in this step [m].
        hip, knee, ankle: Angles of both sides in the plane ahead, flexion positive, the hip's against the vertical
            [rad], [2] each.
        correction: Root mean square of what given angles of hip and knee were changed by so far [rad].
        touched: Sides whose heel touched the ground in this step.
    """

    phase: float
    contacts: F8
    advance: float
    hip: F8
    knee: F8
    ankle: F8
    correction: float
    touched: tuple[str, ...]


class Walk:
    """Walks a model; a step of an animator. Who does not move stands, once both feet are under them.

    Args:
        rig: The model's nodes, its bones turned as the model's axes at rest: +y up, +z ahead.
        bones: Its bones.
        pace: Gives speed and step length now.
        angles: Gives angles of hip and knee [rad] at a phase of the cycle, [left hip, left knee, right hip, right
            knee], flexion positive; None: the feet follow the published curves.
        move: Called with the way ahead in each step [m]: moves what the model stands on.
        ground: Where the model stands now; given, feet that stand keep their place on it, however the model turns and
            changes its speed. None: they go back at the pace.
        events: Takes what is heard: a "step" where a foot comes down.

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
        ground: Ground | None = None,
        events: Callable[[ClipEvent], None] | None = None,
    ) -> None:
        self._rig, self._bones, self._pace, self._angles, self._move = rig, bones, pace, angles, move
        self._events = events
        self._rest, self._chain = Chain(rig), Chain(rig)
        self._feet = [bones.limb(f"{side}_leg") for side in ("left", "right")]
        self._toes = [bones.slots.get(f"{side}Toes", -1) for side in ("left", "right")]
        self._goals = [np.zeros(3), np.zeros(3)]
        self._legs = [
            LimbReach(rig, joints, lambda k=k: self._goals[k], lambda hip: hip + (0.0, -0.1, 1.0), soft=_SOFT)  # type: ignore[misc]
            for k, joints in enumerate(self._feet)
        ]
        self._shape = self._leg_shape()
        self._leg = float(self._shape[4] + self._shape[5])
        self._holds = Footholds(ground) if ground is not None else None
        self._phase, self._sum, self._count = 0.0, 0.0, 0
        self._placed = np.zeros((2, 7))
        zero = np.zeros(2)
        self.gait = Gait(0.0, np.full((2, 3), np.nan), 0.0, zero, zero, zero, 0.0, ())

    def __call__(self, pose: Pose, seconds: float) -> None:
        pace = self._pace()
        before = self._phase
        self._phase = (self._phase + self._cadence(pace) * seconds) % 1.0
        backwards = pace.cadence < 0.0
        natural = _NATURAL_STEP * self._leg * NATURAL_STANCE
        stretch = min(1.3, pace.step * pace.stance / natural)
        vigour = min(_LIVELY, abs(pace.speed) / _PREFERRED)
        table = self._aim_feet(pace, stretch)
        self._swing(pose, vigour)
        self._raise_hips(pose, table, pace.stance)
        wanted = None if self._angles is None else np.asarray(self._angles(self._phase), np.float64)
        if wanted is not None:
            self._follow_angles(pose, wanted, pace)
        for leg in self._legs:
            leg(pose, seconds)
        self._chain.follow(pose)
        self._pitch_feet(pose)
        hip, knee, ankle = self._measure()
        if wanted is not None:
            self._sum += float(((np.stack([hip, knee], 1).ravel() - wanted) ** 2).sum())
            self._count += wanted.size
        advance = pace.speed * seconds
        if self._move is not None:
            self._move(advance)
        correction = math.sqrt(self._sum / self._count) if self._count else 0.0
        touched = self._touched(before, pace.stance, backwards)
        self.gait = Gait(self._phase, self._contacts(), advance, hip, knee, ankle, correction, touched)

    def _leg_shape(self) -> F8:
        """Leg and foot as `place_feet` wants them."""
        places, (hip, knee, foot), toes = self._rest.places, self._feet[0], self._toes[0]
        ball = float(places[toes, 2] - places[foot, 2]) if toes >= 0 else 0.14
        joint = float(places[toes, 1]) if toes >= 0 else 0.0
        thigh, shank = (float(np.linalg.norm(places[a] - places[b])) for a, b in ((hip, knee), (knee, foot)))
        bend = _TOE_BEND if toes >= 0 else 0.0
        return np.array([places[foot, 1], _HEEL * ball, ball, _TIP * ball, thigh, shank, bend, max(joint, 0.0)])

    def _cadence(self, pace: Pace) -> float:
        """Cycles in a second; who stands brings the feet under the body first."""
        if self._holds is None or abs(pace.speed) > 1e-3:
            return pace.cadence
        stands = bool((self._placed[:, 4] > 0.0).all())
        return 0.0 if stands and self._holds.settled else _SETTLE

    def _aim_feet(self, pace: Pace, stretch: float) -> F8:
        """Set where the ankles go; returns the angles that the legs follow."""
        round_speed = _TABLE_SPEED * round(abs(pace.speed) / _TABLE_SPEED)
        lively = max(_LEAST_STEP, _TABLE_STRETCH * round(stretch / _TABLE_STRETCH))
        table = shape_gait(round(round_speed, 2), round(lively, 2))
        stance, stride = pace.stance, 2.0 * pace.step
        shape, placed = self._shape, self._placed
        place_feet(self._phase, stance, stride, _touch(table, stance, stride, shape), shape, table, placed)
        for k in range(2):
            ankle, hip = (self._rest.places[self._feet[k][j]] for j in (2, 0))
            x, z = ankle[0], hip[2] + placed[k, 0]
            if self._holds is not None:
                off = self._hold(k, x, hip[2] + placed[k, 3], pace)
                x, z = x + off[0], z + off[1]
            self._goals[k][:] = (x, placed[k, 1], z)
        return table

    def _hold(self, k: int, x: float, z: float, pace: Pace) -> F8:
        assert self._holds is not None
        own = (self._phase + 0.5 * k) % 1.0
        share = (own - pace.stance) / (1.0 - pace.stance)
        # The point kept is that of the flat foot under the ankle: heel and ball are fixed parts of it.
        base = z - self._pivot(k)
        return self._holds.follow(k, x, base, bool(self._placed[k, 4]), share if pace.speed >= 0.0 else 1.0 - share)

    def _pivot(self, k: int) -> float:
        """How far the point of contact of a foot is ahead of where a flat foot's ankle would be [m]."""
        pitch = self._placed[k, 2]
        if not self._placed[k, 4] or pitch == 0.0:
            return 0.0
        return float(-self._shape[1] if pitch > 0.0 else self._shape[2])

    def _swing(self, pose: Pose, vigour: float) -> None:
        """Pelvis, trunk and arms: turned with the leg that is ahead, arms against it; hips sway and drop."""
        slots, turn = self._bones.slots, 2.0 * math.pi * self._phase
        ahead = math.cos(turn)  # 1: the left foot is ahead
        side = math.sin(turn)  # 1: the left foot carries
        hips = slots["hips"]
        moving = min(1.0, 4.0 * vigour)
        rest = self._rig.rest.translations[hips]
        pose.translations[hips] = (1.0 - moving) * pose.translations[hips] + moving * rest
        pose.translations[hips, 0] += _SWAY * vigour * side
        self._chain.follow(pose)
        self._turn(pose, "hips", (0.0, 1.0, 0.0), -_PELVIS * vigour * ahead)
        self._turn(pose, "hips", (0.0, 0.0, 1.0), _LIST * vigour * side)
        self._turn(pose, "spine", (0.0, 0.0, 1.0), -_LIST * vigour * side)
        for bone in ("spine", "chest"):
            self._turn(pose, bone, (0.0, 1.0, 0.0), 0.5 * (_PELVIS + _TRUNK) * vigour * ahead)
        for word, sign in (("left", 1.0), ("right", -1.0)):
            swing = _ARMS * vigour * sign * ahead
            self._turn(pose, f"{word}UpperArm", (1.0, 0.0, 0.0), swing)
            self._turn(pose, f"{word}LowerArm", (1.0, 0.0, 0.0), -0.35 * vigour * (1.0 - 0.6 * sign * ahead))

    def _turn(self, pose: Pose, bone: str, axis: tuple[float, float, float], angle: float) -> None:
        """Turn a bone about an axis of the model, from how it is now."""
        slot = self._bones.slots.get(bone, -1)
        if slot < 0 or angle == 0.0:
            return
        self._set(pose, slot, _about(axis, angle), self._chain.turns[slot].copy())
        for below in self._rig.below(slot)[1:]:
            self._chain.follow_slot(pose, below)

    def _set(self, pose: Pose, slot: int, turn: F8, rest: F8) -> None:
        turned = np.empty(4)
        multiply(turn, rest, turned)
        localise(slot, turned, self._rig.parents, self._chain.turns, pose.rotations)

    def _raise_hips(self, pose: Pose, table: F8, stance: float) -> None:
        """Put the hips where the legs that carry bend as the angles say, and where feet that stand are in reach."""
        slot, places = self._bones.slots["hips"], self._chain.places
        thigh, shank = self._shape[4], self._shape[5]
        lift, highest = 0.0, math.inf
        for k, joints in enumerate(self._feet):
            hip, goal = places[joints[0]], self._goals[k]
            aside = float((goal[0] - hip[0]) ** 2 + (goal[2] - hip[2]) ** 2)
            phase = (self._phase + 0.5 * k) % 1.0
            at = phase * SAMPLES
            knee = max(float(np.interp(at, np.arange(SAMPLES + 1), np.append(table[:, 1], table[0, 1]))), _LEAST_BEND)
            chord = thigh**2 + shank**2 + 2.0 * thigh * shank * math.cos(knee)
            over = float(goal[1] - hip[1])
            lift += self._placed[k, 6] * (over + math.sqrt(max(chord - aside, 0.0)))
            # A foot in the air has time until it comes down.
            slack = 0.0 if self._placed[k, 4] else _SLACK * min(phase - stance, 1.0 - phase)
            highest = min(highest, slack + over + math.sqrt(max(((1.0 - _SOFT) * self._leg) ** 2 - aside, 0.0)))
        pose.translations[slot, 1] += min(lift, highest)
        self._chain.follow(pose)

    def _follow_angles(self, pose: Pose, wanted: F8, pace: Pace) -> None:
        """Put the ankles where given angles have them; a foot that stands keeps its place over the ground instead."""
        thigh, shank = self._shape[4], self._shape[5]
        for k, (hip, _, _) in enumerate(self._feet):
            lean, bend = wanted[2 * k], wanted[2 * k] - wanted[2 * k + 1]
            ahead = thigh * math.sin(lean) + shank * math.sin(bend)
            down = thigh * math.cos(lean) + shank * math.cos(bend)
            phase = (self._phase + 0.5 * k) % 1.0
            if phase >= pace.stance:
                # Toes and heel stay above the ground, whatever the angles say.
                x = (phase - pace.stance) / (1.0 - pace.stance)
                share = math.sin(math.pi * x) ** 2
                own, place = self._goals[k], self._chain.places[hip]
                asked = np.array([own[0], place[1] - down, place[2] + ahead])
                asked[1] = max(asked[1], 0.9 * own[1])
                own[:] = (1.0 - share) * own + share * asked

    def _pitch_feet(self, pose: Pose) -> None:
        """Pitch the feet as their phase has them, and bend the toes."""
        for k, joints in enumerate(self._feet):
            pitch, bend = self._placed[k, 2], self._placed[k, 5]
            yaw = 0.0 if self._holds is None else float(self._holds.off[k, 2])
            heading = _about((0.0, 1.0, 0.0), yaw)
            for slot, angle in ((joints[2], pitch), (self._toes[k], pitch + bend)):
                if slot >= 0:
                    turn = np.empty(4)
                    multiply(heading, _about((1.0, 0.0, 0.0), -angle), turn)
                    self._set(pose, slot, turn, self._rest.turns[slot])
                    self._chain.follow_slot(pose, slot) if slot == self._toes[k] else self._chain.follow(pose)

    def _contacts(self) -> F8:
        """Points of contact, in the frame of the model."""
        contacts = np.full((2, 3), np.nan)
        for k, joints in enumerate(self._feet):
            if self._placed[k, 4]:
                off = np.zeros(3) if self._holds is None else self._holds.off[k]
                ankle, hip = self._rest.places[joints[2]], self._rest.places[joints[0]]
                contacts[k] = (ankle[0] + off[0], 0.0, hip[2] + self._placed[k, 3] + off[1])
        return contacts

    def _touched(self, before: float, stance: float, backwards: bool) -> tuple[str, ...]:
        """Sides whose foot came down; a step is heard for each."""
        sides = []
        for k, side in enumerate(("left", "right")):
            own, was = (self._phase + 0.5 * k) % 1.0, (before + 0.5 * k) % 1.0
            if (was >= stance > own) if not backwards else (own <= stance < was):
                sides.append(side)
                if self._events is not None:
                    self._events(ClipEvent(0.0, "step", self._rig.names[self._feet[k][2]]))
        return tuple(sides)

    def _measure(self) -> tuple[F8, F8, F8]:
        """Flexion of hips against the vertical, knees and ankles in the plane ahead [rad]."""
        hips, knees, ankles, places = np.empty(2), np.empty(2), np.empty(2), self._chain.places
        for k, (hip, knee, foot) in enumerate(self._feet):
            thigh, shank = places[knee] - places[hip], places[foot] - places[knee]
            hips[k] = math.atan2(thigh[2], -thigh[1])
            lean = math.atan2(shank[2], -shank[1])
            knees[k] = hips[k] - lean
            ankles[k] = self._placed[k, 2] - lean
        return hips, knees, ankles


def _about(axis: tuple[float, float, float], angle: float) -> F8:
    """The turn about an axis, xyzw."""
    s = math.sin(0.5 * angle)
    return np.array([s * axis[0], s * axis[1], s * axis[2], math.cos(0.5 * angle)])


def _touch(table: F8, stance: float, stride: float, shape: F8) -> float:
    """Where the ankle of a flat foot is at the heel's touch, so that legs that stand lean as the table has it."""
    phase = np.arange(SAMPLES) / SAMPLES
    stands = phase <= stance
    thigh, knee = table[stands, 0], table[stands, 1]
    lean = shape[4] * np.sin(thigh) + shape[5] * np.sin(thigh - knee)
    rise = shape[2] * (1.0 - np.cos(table[stands, 2])) - (shape[0] - shape[7]) * np.sin(table[stands, 2])
    return float(np.mean(lean + stride * phase[stands] - rise))
