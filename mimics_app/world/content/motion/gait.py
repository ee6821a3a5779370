"""Gait synthesis from speed and step length, or from angles of hip and knee, without foot slip.

Legs follow the published curves of `reference_gait`, fitted to the step by inverse kinematics; pelvis, trunk and arms
swing along. Given angles are followed as far as the stance foot allows; the correction is reported.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.maths.quat import multiply
from mimics_app.world.content.motion.clip import ClipEvent
from mimics_app.world.content.motion.humanoid import HumanoidMap
from mimics_app.world.content.motion.kernels.gait import lowest, place_feet
from mimics_app.world.content.motion.kernels.hips import LEG, fit_hips
from mimics_app.world.content.motion.pose import Pose
from mimics_app.world.content.motion.reach import Chain, LimbReach, about
from mimics_app.world.content.motion.reference_gait import NATURAL_STANCE, SAMPLES, shape_gait, stance_share
from mimics_app.world.content.motion.rig import Rig
from mimics_app.world.content.motion.walking_trunk import WalkingTrunk

__all__ = ["Gait", "LeadingLegs", "Pace", "Walk", "natural_step"]

Ground = Callable[[], tuple[float, float, float]]
"""Returns the present position of a model on the ground, x and z [m], and its yaw about +y [rad], 0 along +z."""

_MAX_OFFSET = 0.35
"""Maximum offset of a locked foot from its place in the walk [m]; beyond it the foot is dragged along."""


class Footholds:
    """Offset of each foot from its place in the walk that keeps it at its place on the ground.

    Args:
        ground: See `Ground`.

    Attributes:
        off: Offset of each foot in the frame of the model: x and z [m], yaw [rad]; [2, 3].
    """

    def __init__(self, ground: Ground) -> None:
        self._ground = ground
        self.off: F8 = np.zeros((2, 3))
        self._left: F8 = np.zeros((2, 3))
        self._places: list[tuple[float, float, float] | None] = [None, None]

    @property
    def at_rest(self) -> bool:
        """True when both offsets are below 15 mm and 5 degrees."""
        return bool(np.hypot(self.off[:, 0], self.off[:, 1]).max() < 0.015 and np.abs(self.off[:, 2]).max() < 0.09)

    def follow(self, foot: int, x: float, z: float, standing: bool, share: float) -> F8:
        """Update and return the offset of a foot, [3].

        Args:
            foot: 0: left, 1: right.
            x: Coordinate of its point of support in the walk, in the frame of the model [m].
            z: Likewise.
            standing: True in stance.
            share: Elapsed share of its swing, 0 to 1, over which the offset returns to 0.
        """
        if not standing:
            if self._places[foot] is not None:
                self._places[foot], self._left[foot] = None, self.off[foot]
            s = min(max(share, 0.0), 1.0)
            self.off[foot] = (1.0 - s * s * s * (10.0 + s * (6.0 * s - 15.0))) * self._left[foot]
            return np.asarray(self.off[foot])
        at_x, at_z, turn = self._ground()
        c, s = math.cos(turn), math.sin(turn)
        place = self._places[foot]
        if place is None:
            ox, oz, yaw = self.off[foot]
            fx, fz = x + ox, z + oz
            place = self._places[foot] = (at_x + c * fx + s * fz, at_z - s * fx + c * fz, turn + yaw)
        dx, dz = place[0] - at_x, place[1] - at_z
        off = np.array([c * dx - s * dz - x, s * dx + c * dz - z, math.remainder(place[2] - turn, 2.0 * math.pi)])
        far = math.hypot(off[0], off[1])
        if far > _MAX_OFFSET:
            # Dragged along; after a jump of the model the lock restarts.
            off = off * (_MAX_OFFSET / far) if far < 2.0 * _MAX_OFFSET else np.zeros(3)
            self._places[foot] = None
        self.off[foot] = off
        return off


_PREFERRED = 1.3
"""Preferred walking speed [m/s]."""
_LIVELY = 1.3
"""Maximum factor on the swing of pelvis, trunk and arms at the preferred speed."""
_NATURAL_STEP = 0.80
"""Step of the published curves over the leg's length, on a leg of two equal bones."""
_LEG = 0.82
"""Leg length, hip to ankle, of a person 1.75 m tall [m]."""
_TABLE_SPEED, _TABLE_STRETCH = 0.02, 0.02
"""Resolution of the cached tables of angles in speed [m/s] and in stretch of the step."""
_SOFT = 5e-4
"""Soft reach of the legs, as a share of their length, below the minimum knee flexion."""
_MIN_FLEXION = math.radians(3.7)
"""Minimum flexion of a loaded knee [rad], just beyond the start of the soft reach."""
_SLACK = 0.05
"""Excess height of the hips over the reach of a swing foot, per cycle until or since its stance [m]."""
_LATE = 4.0
"""Inverse of the share of the swing, from its middle on, in which its knee comes to be bent as the table has it."""
_ROUND = 0.003
"""Distance over which the hips change smoothly from one limit of their height to the other [m]."""
_TOE_BEND = math.radians(60.0)
"""Maximum dorsiflexion of the toes [rad]."""
_HEEL, _TIP = 0.5, 1.75
"""Distances of heel behind and toe tip before the ankle, over that of the ball: feet of 265 mm."""
_SETTLING_CADENCE = 0.9
"""Cadence while the feet of a standing person are brought under the body [1/s]."""
_LED = 6.0
"""Rate at which the phase is drawn to a given one [1/s]."""
_SLOW_BACK, _SLOW, _FASTER = 0.025, 0.5, 0.8
"""How much farther back feet stand at slow speeds than hip and knee of the table say [m], fitted to the knee: the foot
rolls off before toe-off; speeds up to which it is so, and from which they stand as the table says [m/s]."""
_GIVEN = 4.0
"""Inverse of the share of a swing at either end in which the foot changes between its own path and given angles."""
_DORSIFLEXION = 0.35
"""Largest dorsiflexion with which a swing foot clears the ground [rad]: 20 degrees."""
_PITCHES = np.linspace(0.0, 1.0, 9)
"""Shares of the way there that are tried."""
_MOST_SHIFT = 0.15
"""Largest shift of where a foot stands for given angles [m]."""
_MIN_STRETCH = 0.12
"""Stretch of the step below which foot clearance does not decrease further."""


@dataclass(frozen=True, slots=True)
class Pace:
    """Walking pace.

    Attributes:
        speed: Speed [m/s]; negative: backwards.
        step: Step length [m].
    """

    speed: float
    step: float

    @property
    def cadence(self) -> float:
        """Cadence in cycles of two steps [1/s]."""
        return self.speed / (2.0 * self.step) if self.step > 0.0 else 0.0

    @property
    def stance(self) -> float:
        """Stance phase as a share of the cycle."""
        return stance_share(abs(self.speed))


def natural_step(speed: float) -> float:
    """Return the natural step [m] at a speed [m/s]: it grows with the root (Grieve 1968)."""
    return _NATURAL_STEP * _LEG * math.sqrt(abs(speed) / _PREFERRED)


@dataclass(frozen=True, eq=False)
class Gait:
    """State of a walk after a time step.

    Attributes:
        phase: Phase of the left foot, 0: heel strike.
        contacts: Points of support of both feet in the model's frame [m], [2, 3]; NaN for a swing foot.
        advance: Distance of the model in this time step [m].
        hip, knee, ankle: Angles of both sides in the sagittal plane, flexion positive, the hip's to the vertical
            [rad], [2] each.
        correction: Root mean square correction of given angles of hip and knee so far [rad].
        touched: Sides with a heel strike in this time step.
    """

    phase: float
    contacts: F8
    advance: float
    hip: F8
    knee: F8
    ankle: F8
    correction: float
    touched: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class LeadingLegs:
    """Legs that a model's walk follows: those of a person.

    Attributes:
        angles: Returns angles of hip and knee [rad] at a phase of the cycle, [left hip, left knee, right hip, right
            knee], flexion positive; None: the feet follow the published curves.
        phase: Returns the phase of the left leg that the walk is to keep in step with, 0 at its heel strike; None: the
            walk has its own.
    """

    angles: Callable[[float], F8] | None = None
    phase: Callable[[], float] | None = None


class Walk:
    """Gait of a model; a step of an animator. At zero speed it stands, once both feet are under the body.

    Args:
        rig: Nodes of the model, whose rest axes are +y up, +z forward.
        bones: Bones of the model.
        pace: Returns the present speed and step length.
        legs: The person's legs, as far as they are known.
        move: Called with the distance of each time step [m], to move the model's root.
        ground: Returns the model's pose on the ground, for foot lock while the model turns and changes its speed. None:
            stance feet move backwards at the pace.
        soles: Outline of both feet (`outline_soles`), on which they stand and roll; None: heel, ball and tip of feet of
            265 mm, flat on the ground at rest.
        events: Receives a "step" event at each heel strike.

    Attributes:
        gait: State after the last time step.
    """

    def __init__(
        self,
        rig: Rig,
        bones: HumanoidMap,
        pace: Callable[[], Pace],
        *,
        legs: LeadingLegs = LeadingLegs(),
        move: Callable[[float], None] | None = None,
        ground: Ground | None = None,
        soles: F8 | None = None,
        events: Callable[[ClipEvent], None] | None = None,
    ) -> None:
        self._rig, self._bones, self._pace, self._angles, self._move = rig, bones, pace, legs.angles, move
        self._led = legs.phase
        self._events = events
        self._rest, self._chain = Chain(rig), Chain(rig)
        self._trunk = WalkingTrunk(rig, bones, self._rest, self._chain)
        self._feet = [bones.limb(f"{side}_leg") for side in ("left", "right")]
        self._toes = [bones.slots.get(f"{side}Toes", -1) for side in ("left", "right")]
        self._goals = [np.zeros(3), np.zeros(3)]
        self._legs = [
            LimbReach(rig, joints, lambda k=k: self._goals[k], lambda hip: hip + (0.0, -0.1, 1.0), soft=_SOFT)  # type: ignore[misc]
            for k, joints in enumerate(self._feet)
        ]
        self._shape = self._leg_shape()
        self._leg = float(self._shape[4] + self._shape[5])
        self._soles = _plain_soles(self._shape) if soles is None else soles
        self._holds = Footholds(ground) if ground is not None else None
        self._phase, self._sum, self._count = 0.0, 0.0, 0
        self._placed = np.zeros((2, 7))
        self._bent, self._hips = np.zeros((2, LEG)), np.zeros(2)
        self._shifts = [_Shift(), _Shift()]
        zero = np.zeros(2)
        self.gait = Gait(0.0, np.full((2, 3), np.nan), 0.0, zero, zero, zero, 0.0, ())

    def __call__(self, pose: Pose, seconds: float) -> None:
        pace = self._pace()
        before = self._phase
        self._phase = self._following(pace, seconds)
        backwards = pace.cadence < 0.0
        wanted = None if self._angles is None else np.asarray(self._angles(self._phase), np.float64)
        natural = _NATURAL_STEP * self._leg * NATURAL_STANCE
        stretch = min(1.3, pace.step * pace.stance / natural)
        vigour = min(_LIVELY, abs(pace.speed) / _PREFERRED)
        table = self._table_of(pace, stretch)
        if wanted is not None:
            self._shift_feet(wanted, table, pace.stance)
        self._aim_feet(pace, stretch, table)
        self._trunk.swing(pose, self._phase, vigour)
        if wanted is not None:
            self._fit_hips(pose, wanted, pace.stance, seconds)
            self._follow_angles(pose, wanted, pace)
        else:
            self._raise_hips(pose, table, pace.stance)
            self._keep_bent(table, pace.stance)
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
        """Return the dimensions of leg and foot for `place_feet`."""
        places, (hip, knee, foot), toes = self._rest.places, self._feet[0], self._toes[0]
        ball = float(places[toes, 2] - places[foot, 2]) if toes >= 0 else 0.14
        joint = float(places[toes, 1]) if toes >= 0 else 0.0
        thigh, shank = (float(np.linalg.norm(places[a] - places[b])) for a, b in ((hip, knee), (knee, foot)))
        bend = _TOE_BEND if toes >= 0 else 0.0
        return np.array([places[foot, 1], _HEEL * ball, ball, _TIP * ball, thigh, shank, bend, max(joint, 0.0)])

    def _following(self, pace: Pace, seconds: float) -> float:
        """Return the phase after a time step: one's own, drawn to the given one while somebody walks."""
        phase = self._phase + self._cadence(pace) * seconds
        if self._led is not None and pace.speed > 0.0:
            phase += min(_LED * seconds, 1.0) * math.remainder(self._led() - phase, 1.0)
        return phase % 1.0

    def _cadence(self, pace: Pace) -> float:
        """Return the cadence [1/s]; at zero speed the feet are first brought under the body."""
        if self._holds is None or abs(pace.speed) > 1e-3:
            return pace.cadence
        stands = bool((self._placed[:, 4] > 0.0).all())
        return 0.0 if stands and self._holds.at_rest else _SETTLING_CADENCE

    def _table_of(self, pace: Pace, stretch: float) -> F8:
        """Return the table of angles that the legs follow."""
        round_speed = _TABLE_SPEED * round(abs(pace.speed) / _TABLE_SPEED)
        lively = max(_MIN_STRETCH, _TABLE_STRETCH * round(stretch / _TABLE_STRETCH))
        return shape_gait(round(round_speed, 2), round(lively, 2))

    def _aim_feet(self, pace: Pace, stretch: float, table: F8) -> None:
        """Set the targets of the ankles."""
        stance, stride = pace.stance, 2.0 * pace.step
        shape, placed = self._shape, self._placed
        back = _SLOW_BACK * min(max((_FASTER - abs(pace.speed)) / (_FASTER - _SLOW), 0.0), 1.0)
        # Who stands has the feet under the body.
        touch = _touch(table, stance, stride, shape) - back * min(1.0, 2.0 * stretch)
        place_feet(self._phase, stance, stride, touch, shape, self._soles, table, placed)
        for k in range(2):
            ankle, hip = (self._rest.places[self._feet[k][j]] for j in (2, 0))
            ahead = self._shifts[k].ahead
            x, z = ankle[0], hip[2] + placed[k, 0] + ahead
            if self._holds is not None:
                off = self._hold(k, x, hip[2] + placed[k, 3] + ahead, pace)
                x, z = x + off[0], z + off[1]
            self._goals[k][:] = (x, placed[k, 1], z)

    def _hold(self, k: int, x: float, z: float, pace: Pace) -> F8:
        assert self._holds is not None
        own = (self._phase + 0.5 * k) % 1.0
        share = (own - pace.stance) / (1.0 - pace.stance)
        # The locked point is that of the flat foot under the ankle: heel and ball are rigid with it.
        base = z - self._pivot(k)
        return self._holds.follow(k, x, base, bool(self._placed[k, 4]), share if pace.speed >= 0.0 else 1.0 - share)

    def _pivot(self, k: int) -> float:
        """Return the distance of a foot's point of support ahead of a flat foot's ankle [m]."""
        pitch = self._placed[k, 2]
        if not self._placed[k, 4] or pitch == 0.0:
            return 0.0
        return float(-self._shape[1] if pitch > 0.0 else self._shape[2])

    def _shift_feet(self, wanted: F8, table: F8, stance: float) -> None:
        """Let each foot come down as much farther ahead than the table's as given angles had it before."""
        for k, shift in enumerate(self._shifts):
            own = (self._phase + 0.5 * k) % 1.0
            usual = table[int(own * SAMPLES) % SAMPLES]
            more = self._ankle(wanted[2 * k], wanted[2 * k + 1])[0] - self._ankle(usual[0], usual[1])[0]
            shift.follow(more, (own - stance) / (1.0 - stance))

    def _ankle(self, lean: float, knee: float) -> tuple[float, float]:
        """Return how far lean of the thigh and flexion of the knee have an ankle ahead of its hip and below it [m]."""
        bend = lean - knee
        thigh, shank = self._shape[4], self._shape[5]
        return (
            float(thigh * math.sin(lean) + shank * math.sin(bend)),
            float(thigh * math.cos(lean) + shank * math.cos(bend)),
        )

    def _fit_hips(self, pose: Pose, wanted: F8, stance: float, seconds: float) -> None:
        """Shift the hips so that the legs bend as given; a swinging one counts less the more its foot follows them."""
        for k, joints in enumerate(self._feet):
            hip, goal = self._chain.places[joints[0]], self._goals[k]
            knee = max(float(wanted[2 * k + 1]), _MIN_FLEXION)
            weight = 1.0 - self._given_share(k, stance)
            self._bent[k] = (goal[2] - hip[2], hip[1] - goal[1], goal[0] - hip[0], wanted[2 * k], knee, weight)
        bones = np.array([self._shape[4], self._shape[5], (1.0 - _SOFT) * self._leg])
        fit_hips(self._bent, bones, seconds, self._hips)
        up, ahead = self._hips
        self._chain.shift(pose, self._bones.slots["hips"], np.array([0.0, up, ahead]))

    def _given_share(self, k: int, stance: float) -> float:
        """Return the share of given angles in the place of a foot: all in mid-swing, none in stance."""
        x = ((self._phase + 0.5 * k) % 1.0 - stance) / (1.0 - stance)
        return 0.0 if x < 0.0 else _smooth_step(_GIVEN * x) * _smooth_step(_GIVEN * (1.0 - x))

    def _raise_hips(self, pose: Pose, table: F8, stance: float) -> None:
        """Set the height of the hips so that loaded legs bend as the table has it.

        Stance feet are in reach.
        """
        places = self._chain.places
        thigh, shank = self._shape[4], self._shape[5]
        lift, highest = 0.0, math.inf
        for k, joints in enumerate(self._feet):
            hip, goal = places[joints[0]], self._goals[k]
            aside = float((goal[0] - hip[0]) ** 2 + (goal[2] - hip[2]) ** 2)
            phase = (self._phase + 0.5 * k) % 1.0
            knee = max(_knee_at(table, phase), _MIN_FLEXION)
            chord = thigh**2 + shank**2 + 2.0 * thigh * shank * math.cos(knee)
            over = float(goal[1] - hip[1])
            lift += self._placed[k, 6] * (over + math.sqrt(max(chord - aside, 0.0)))
            # A swing foot need not be in reach until heel strike.
            slack = 0.0 if self._placed[k, 4] else _SLACK * min(phase - stance, 1.0 - phase)
            highest = min(highest, slack + over + math.sqrt(max(((1.0 - _SOFT) * self._leg) ** 2 - aside, 0.0)))
        # The smaller of the two, smoothly: where they meet, a nearly straight knee magnifies every kink.
        lift = 0.5 * (lift + highest - math.hypot(lift - highest, _ROUND))
        self._chain.shift(pose, self._bones.slots["hips"], np.array([0.0, lift, 0.0]))

    def _follow_angles(self, pose: Pose, wanted: F8, pace: Pace) -> None:
        """Move the targets of swing ankles to given angles; a stance foot keeps its place on the ground."""
        for k, (hip, _, _) in enumerate(self._feet):
            ahead, down = self._ankle(wanted[2 * k], wanted[2 * k + 1])
            share = self._given_share(k, pace.stance)
            if share > 0.0:
                own, place = self._goals[k], self._chain.places[hip]
                asked = np.array([own[0], place[1] - down, place[2] + ahead])
                own[:] = (1.0 - share) * own + share * asked
                self._clear_ground(k, wanted[2 * k] - wanted[2 * k + 1])

    def _clear_ground(self, k: int, lean: float) -> None:
        """Pitch the toes of a swing foot up until it clears the ground; what the ankle cannot, the leg lifts.

        Args:
            k: 0 left, 1 right.
            lean: Of the shank, forward [rad].
        """
        own, placed = self._goals[k], self._placed[k]
        steps = _PITCHES * max(lean + _DORSIFLEXION - placed[2], 0.0)
        heights = [-lowest(placed[2] + step, placed[5], self._shape, self._soles[k]) for step in steps]
        free = next((n for n, height in enumerate(heights) if height <= own[1]), -1)
        if free > 0:  # between the last pitch that touches and the first that clears
            below, above = heights[free - 1] - own[1], own[1] - heights[free]
            placed[2] += steps[free] - (steps[free] - steps[free - 1]) * above / (above + below)
        elif free < 0:
            placed[2] += steps[int(np.argmin(heights))]
        own[1] = max(own[1], -lowest(placed[2], placed[5], self._shape, self._soles[k]))

    def _keep_bent(self, table: F8, stance: float) -> None:
        """Move the targets of swing ankles to the hip until the knee has the table's flexion before strike."""
        thigh, shank = self._shape[4], self._shape[5]
        for k, (hip, _, _) in enumerate(self._feet):
            phase = (self._phase + 0.5 * k) % 1.0
            x = min(max(_LATE * ((phase - stance) / (1.0 - stance) - 0.5), 0.0), 1.0)
            if self._placed[k, 4] or x == 0.0:
                continue
            # From mid-swing on, where the knee bends most by itself.
            more = max(_knee_at(table, phase) - _knee_at(table, 0.0), 0.0)
            knee = _MIN_FLEXION + x * x * (3.0 - 2.0 * x) * more
            reach = math.sqrt(thigh**2 + shank**2 + 2.0 * thigh * shank * math.cos(knee))
            away = self._goals[k] - self._chain.places[hip]
            far = float(np.linalg.norm(away))
            if far > reach:
                self._goals[k][:] = self._chain.places[hip] + reach / far * away

    def _pitch_feet(self, pose: Pose) -> None:
        """Set the pitch of the feet for their phase, and bend the toes."""
        for k, joints in enumerate(self._feet):
            pitch, bend = self._placed[k, 2], self._placed[k, 5]
            yaw = 0.0 if self._holds is None else float(self._holds.off[k, 2])
            heading = about((0.0, 1.0, 0.0), yaw)
            for slot, angle in ((joints[2], pitch), (self._toes[k], pitch + bend)):
                if slot >= 0:
                    turn = np.empty(4)
                    multiply(heading, about((1.0, 0.0, 0.0), -angle), turn)
                    self._chain.turn(pose, slot, turn, self._rest.turns[slot])
                    self._chain.follow_slot(pose, slot) if slot == self._toes[k] else self._chain.follow(pose)

    def _contacts(self) -> F8:
        """Return the points of support in the frame of the model."""
        contacts = np.full((2, 3), np.nan)
        for k, joints in enumerate(self._feet):
            if self._placed[k, 4]:
                off = np.zeros(3) if self._holds is None else self._holds.off[k]
                ankle, hip = self._rest.places[joints[2]], self._rest.places[joints[0]]
                contacts[k] = (ankle[0] + off[0], 0.0, hip[2] + self._placed[k, 3] + off[1])
        return contacts

    def _touched(self, before: float, stance: float, backwards: bool) -> tuple[str, ...]:
        """Return the sides with a heel strike, and send an event for each."""
        sides = []
        for k, side in enumerate(("left", "right")):
            own, was = (self._phase + 0.5 * k) % 1.0, (before + 0.5 * k) % 1.0
            if (was >= stance > own) if not backwards else (own <= stance < was):
                sides.append(side)
                if self._events is not None:
                    self._events(ClipEvent(0.0, "step", self._rig.names[self._feet[k][2]]))
        return tuple(sides)

    def _measure(self) -> tuple[F8, F8, F8]:
        """Return flexion of hips to the vertical, knees and ankles in the sagittal plane [rad]."""
        hips, knees, ankles, places = np.empty(2), np.empty(2), np.empty(2), self._chain.places
        for k, (hip, knee, foot) in enumerate(self._feet):
            thigh, shank = places[knee] - places[hip], places[foot] - places[knee]
            hips[k] = math.atan2(thigh[2], -thigh[1])
            lean = math.atan2(shank[2], -shank[1])
            knees[k] = hips[k] - lean
            ankles[k] = self._placed[k, 2] - lean
        return hips, knees, ankles


def _smooth_step(x: float) -> float:
    """Return a smooth step from 0 to 1."""
    x = min(max(x, 0.0), 1.0)
    return x * x * (3.0 - 2.0 * x)


class _Shift:
    """How much farther ahead a foot stands than the walk's own: the mean of its last stance, changed in its swing.

    Attributes:
        ahead: Present shift [m].
    """

    def __init__(self) -> None:
        self.ahead = self._wanted = self._left = 0.0
        self._sum, self._count = 0.0, 0

    def follow(self, asked: float, share: float) -> None:
        """Take how much farther ahead the angles have the foot [m]; in swing move by its elapsed share, 0 to 1."""
        if share < 0.0:
            self._sum, self._count = self._sum + asked, self._count + 1
            self._left = self.ahead
            return
        if self._count:
            self._wanted = min(max(self._sum / self._count, -_MOST_SHIFT), _MOST_SHIFT)
            self._sum, self._count = 0.0, 0
        self.ahead = self._left + _smooth_step(share) * (self._wanted - self._left)


def _plain_soles(shape: F8) -> F8:
    """Return soles that are straight from the heel to the ball and from there to the tip of the toes."""
    ankle, heel, ball, tip = (float(length) for length in shape[:4])
    return np.array([[(0.0, -heel, -ankle), (1.0, ball, -ankle), (1.0, tip, -ankle)]] * 2)


def _knee_at(table: F8, phase: float) -> float:
    """Return the knee flexion of a table at a phase [rad]."""
    return float(np.interp(phase * SAMPLES, np.arange(SAMPLES + 1), np.append(table[:, 1], table[0, 1])))


def _touch(table: F8, stance: float, stride: float, shape: F8) -> float:
    """Return a flat foot's ankle position at heel strike with which stance legs lean as in the table."""
    phase = np.arange(SAMPLES) / SAMPLES
    stands = phase <= stance
    thigh, knee = table[stands, 0], table[stands, 1]
    lean = shape[4] * np.sin(thigh) + shape[5] * np.sin(thigh - knee)
    rise = shape[2] * (1.0 - np.cos(table[stands, 2])) - (shape[0] - shape[7]) * np.sin(table[stands, 2])
    return float(np.mean(lean + stride * phase[stands] - rise))
