"""Motions of all people: standing, walking, running, kicking, greeting, clapping, cheering, pointing."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from assets.builders.avatars.holding import HELD, Held, hold
from assets.builders.avatars.postures import SIDES, Pose, X, Y, Z
from assets.builders.avatars.skeleton import Skeleton

__all__ = ["MOTIONS", "Motion"]

_TURN = 2.0 * math.pi


@dataclass(frozen=True)
class Motion:
    """A motion.

    Attributes:
        seconds: Duration.
        loops: Whether its end is equal to its beginning.
        pose: Function of joints and time [s] that gives the pose.
        rate: Key frames per second.
        speed: Speed of travel that it is made for, ahead positive [m/s].
        contacts: Times at which the left and the right foot come down [s]; None: no step sounds.
    """

    seconds: float
    loops: bool
    pose: Callable[[Skeleton, float], Pose]
    speed: float = 0.0
    rate: float = 20.0
    contacts: tuple[float, float] | None = None


def _between(keys: Sequence[tuple[float, Sequence[float]]], t: float, period: float = 0.0) -> list[float]:
    """Interpolate smoothly between keys (time, values); with a period the last key leads to the first."""
    rows = list(keys)
    if period:
        t %= period
        rows = [(rows[-1][0] - period, rows[-1][1]), *rows, (rows[0][0] + period, rows[0][1])]
    times = [row[0] for row in rows]
    i = min(max(int(np.searchsorted(times, t, "right")) - 1, 0), len(rows) - 2)
    values = np.array([row[1] for row in rows], float)
    before, after = max(i - 1, 0), min(i + 2, len(rows) - 1)
    gap = times[i + 1] - times[i]
    s = min(max((t - times[i]) / gap, 0.0), 1.0)
    one = (values[i + 1] - values[before]) / (times[i + 1] - times[before]) * gap
    two = (values[after] - values[i]) / (times[after] - times[i]) * gap
    if not period:  # rest at the ends
        one, two = (0.0 * one if i == 0 else one), (0.0 * two if i == len(rows) - 2 else two)
    h = s * s * (3.0 - 2.0 * s)
    found = values[i] + h * (values[i + 1] - values[i]) + (s**3 - 2 * s * s + s) * one + (s**3 - s * s) * two
    return [float(value) for value in found]


def _pulse(t: float, at: float, seconds: float) -> float:
    return math.exp(-(((t - at) / seconds) ** 2))


def _hanging(pose: Pose, swing: tuple[float, float] = (0.0, 0.0), bend: tuple[float, float] = (14.0, 14.0)) -> Pose:
    """Arms at the sides, swung ahead and bent by degrees (left, right)."""
    for side, word in SIDES:
        pose.turn(f"{word}Shoulder", (Z, -side * 5.0))
    for number, (side, _) in enumerate(SIDES):
        a, b = math.radians(swing[number]), math.radians(swing[number] + bend[number])
        pose.arm(side, (side * 0.15, -math.cos(a), math.sin(a) - 0.01), (side * 0.05, -math.cos(b), math.sin(b)))
        pose.hand(side, 0.20, thumb=0.25)
    return pose


def _standing(bones: Skeleton, t: float, weight: float = 0.0) -> Pose:
    """Upright and at ease, the weight on the left (1) to the right (-1) leg."""
    pose = Pose(bones)
    pose.turn("hips", (Z, 2.2 * weight), (Y, 2.0 * weight))
    pose.hips[0] += 0.030 * weight
    pose.turn("spine", (Z, -2.0 * weight), (X, 1.0)).turn("chest", (Z, -1.2 * weight), (Y, -1.5 * weight))
    for side, _ in SIDES:
        eased = max(-side * weight, 0.0)
        pose.leg(side, 3.0 + 6.0 * eased, 5.0 + 13.0 * eased, 2.0 + 6.0 * eased, out=2.5 - side * 1.6 * weight)
    breath = math.sin(_TURN * t / 4.0)
    pose.morphs["breathe"] = 0.5 + 0.5 * breath
    pose.turn("upperChest", (X, -0.8 * breath)).turn("neck", (X, 0.5 * breath + 1.0))
    for side, word in SIDES:
        pose.turn(f"{word}Shoulder", (Z, side * 0.8 * breath))
    return _hanging(pose, (2.0 + 0.8 * breath, 1.0 - 0.6 * breath), (16.0, 13.0))


def _idle(bones: Skeleton, t: float) -> Pose:
    weight = _between([(0.0, [0.75]), (3.6, [0.80]), (5.0, [-0.7]), (10.2, [-0.75]), (11.6, [0.7])], t, 12.0)[0]
    pose = _standing(bones, t, weight)
    yaw, pitch = _between(
        [(0.5, [0, 1]), (2.0, [-2, 1]), (2.7, [18, -2]), (4.4, [16, -1]), (5.2, [-4, 2]), (7.4, [-3, 4]),
         (8.1, [-22, 0]),
         (9.6, [-20, -2]), (10.4, [2, 0])], t, 12.0,
    )  # fmt: skip
    pose.turn("neck", (Y, 0.35 * yaw), (X, 0.3 * pitch)).turn(
        "head", (Y, 0.65 * yaw), (X, 0.7 * pitch), (Z, -0.08 * yaw)
    )
    quick = _between(
        [
            (0.4, [0]),
            (2.5, [0]),
            (2.7, [9]),
            (3.6, [1]),
            (5.0, [-7]),
            (6.2, [0]),
            (7.95, [-10]),
            (9.0, [0]),
            (10.2, [8]),
        ],
        t,
        12.0,
    )[0]
    for _, word in SIDES:
        pose.turn(f"{word}Eye", (Y, quick), (X, 1.0))
    pose.morphs["blink"] = min(sum(_pulse(t, at, 0.075) for at in (1.1, 2.68, 5.1, 7.95, 10.25)), 1.0)
    pose.morphs["smile"] = 0.36 + 0.14 * math.sin(_TURN * t / 12.0) ** 2
    return pose.ground()


_WALK_HIP = [(0, [22]), (12, [20]), (30, [3]), (50, [-12]), (62, [-2]), (75, [20]), (86, [25]), (95, [23])]
_WALK_KNEE = [(0, [5]), (14, [19]), (38, [6]), (50, [13]), (61, [40]), (72, [63]), (85, [32]), (95, [5])]
_WALK_ANKLE = [(0, [0]), (7, [-6]), (20, [4]), (44, [10]), (54, [2]), (63, [-18]), (75, [-4]), (86, [1]), (96, [0])]
_WALK_TOES = [(0, [0]), (42, [0]), (56, [26]), (63, [18]), (70, [0]), (90, [4])]
"""Degrees over the cycle from heel strike [%], after the usual curves of natural cadence (Winter 1991)."""


def _stride(bones: Skeleton, phase: float, size: float, arms: float, bend: float, lean: float) -> Pose:
    """A step of a walk; phase 0 is the left heel's strike."""
    pose = Pose(bones)
    for side, _ in SIDES:
        at = (phase + (0.0 if side > 0 else 0.5)) % 1.0 * 100.0
        hip, knee, ankle, toes = (
            _between(curve, at, 100.0)[0] for curve in (_WALK_HIP, _WALK_KNEE, _WALK_ANKLE, _WALK_TOES)
        )
        pose.leg(side, 4.0 + size * (hip - 4.0), size * knee, size * ankle, out=1.0, toes=size * toes)
    wave, rock = math.cos(_TURN * phase), math.sin(_TURN * (phase + 0.02))
    pose.turn("hips", (X, lean), (Y, -5.0 * size * wave), (Z, 3.0 * size * rock))
    pose.turn("spine", (Y, 4.0 * size * wave), (Z, -2.2 * size * rock)).turn(
        "chest", (Y, 5.0 * size * wave), (Z, -1.2 * size * rock)
    )
    pose.turn("neck", (Y, -2.0 * size * wave), (X, -0.6 * lean)).turn("head", (Y, -2.0 * size * wave), (X, -0.3 * lean))
    _hanging(pose, (-arms * wave - 2.0, arms * wave - 2.0), (bend - 0.4 * bend * wave, bend + 0.4 * bend * wave))
    pose.hips[0] += 0.020 * size * math.sin(_TURN * (phase + 0.06))
    return pose.ground()


def _walk(bones: Skeleton, t: float) -> Pose:
    pose = _stride(bones, t / 1.08, 1.0, 19.0, 20.0, 2.0)
    pose.morphs["smile"] = 0.26  # no blink: one a cycle would be one a second
    return pose


_RUN_HIP = [(0, [32]), (16, [16]), (36, [-14]), (50, [2]), (66, [44]), (80, [52]), (93, [38])]
_RUN_KNEE = [(0, [18]), (14, [38]), (34, [18]), (50, [72]), (64, [104]), (80, [58]), (93, [20])]
_RUN_ANKLE = [(0, [4]), (16, [20]), (36, [-22]), (50, [-10]), (70, [2]), (92, [6])]
_RUN_PERIOD = 0.72


def _run(bones: Skeleton, t: float) -> Pose:
    phase = t / _RUN_PERIOD
    pose = Pose(bones)
    for side, _ in SIDES:
        at = (phase + (0.0 if side > 0 else 0.5)) % 1.0 * 100.0
        hip, knee, ankle = (_between(curve, at, 100.0)[0] for curve in (_RUN_HIP, _RUN_KNEE, _RUN_ANKLE))
        pose.leg(side, hip, knee, ankle, out=1.0, toes=20.0 * _pulse(at, 36.0, 9.0))
    wave = math.cos(_TURN * phase)
    pose.turn("hips", (X, 8.0), (Y, -7.0 * wave)).turn("spine", (Y, 6.0 * wave)).turn("chest", (Y, 8.0 * wave))
    pose.turn("neck", (X, -4.0), (Y, -3.0 * wave)).turn("head", (X, -2.0), (Y, -3.0 * wave))
    _hanging(pose, (-36.0 * wave - 10.0, 36.0 * wave - 10.0), (82.0, 82.0))
    for side, _ in SIDES:
        pose.hand(side, 0.55, thumb=0.7)
    pose.ground()
    pose.hips[1] += 0.045 * max(math.cos(_TURN * (2.0 * phase + 0.12)), 0.0)  # both feet off the ground
    return pose


def _kick(bones: Skeleton, t: float) -> Pose:
    hip, knee, ankle, twist, lean = _between(
        [(0.0, [3, 5, 2, 0, 0]), (0.40, [-26, 70, -14, -14, 8]), (0.60, [44, 18, -24, 16, -10]),
         (0.74, [66, 14, -20, 14, -12]),
         (1.05, [22, 30, 0, 4, -2]), (1.4, [3, 5, 2, 0, 0])], t,
    )  # fmt: skip
    pose = Pose(bones)
    pose.leg(-1, hip, knee, ankle).leg(1, 6.0 + 0.4 * lean, 12.0 + 0.5 * abs(lean), 6.0, out=3.0)
    pose.turn("hips", (Y, 0.6 * twist), (X, -0.5 * lean)).turn("spine", (X, 0.9 * lean), (Y, -0.8 * twist)).turn(
        "chest", (Y, -0.8 * twist)
    )
    pose.turn("head", (X, 10.0), (Y, 0.8 * twist))
    out = 0.25 + 0.02 * abs(twist)
    pose.arm(1, (out, -0.8, -0.03 * twist), (0.8 * out, -0.7, 0.25 - 0.035 * twist))
    pose.arm(-1, (-out, -0.9, 0.025 * twist), (-0.7 * out, -0.8, 0.20 + 0.03 * twist))
    for side, _ in SIDES:
        pose.hand(side, 0.3)
    pose.hips[0] += 0.035 * min(max(hip + 10.0, 0.0) / 40.0, 1.0)
    return pose.ground()


def _raised(t: float, seconds: float, rise: float = 0.45) -> float:
    """Return 0 at both ends, 1 between."""
    return _between([(0.0, [0]), (rise, [1]), (seconds - rise, [1]), (seconds, [0])], t)[0]


def _towards(
    pose: Pose, side: int, share: float, upper: Sequence[float], lower: Sequence[float], roll: float = 0.0
) -> None:
    """An arm between hanging and a raised posture."""
    low_u, low_f = np.array([side * 0.15, -1.0, 0.02]), np.array([side * 0.05, -0.97, 0.24])
    u, f = low_u + share * (np.asarray(upper) - low_u), low_f + share * (np.asarray(lower) - low_f)
    pose.arm(side, (u[0], u[1], u[2]), (f[0], f[1], f[2]), share * roll)


def _wave(bones: Skeleton, t: float) -> Pose:
    pose, share = _standing(bones, t, 0.5), _raised(t, 3.0)
    swing = math.sin(_TURN * 1.9 * t) * share
    pose.turn("rightShoulder", (Z, -14.0 * share))
    _towards(pose, -1, share, (-0.95, -0.08, 0.35), (-0.18 - 0.42 * swing, 1.0, 0.25), 25.0)
    pose.hand(-1, 0.20 - 0.18 * share, thumb=0.1, spread=5.0 * share)
    pose.turn("head", (Z, -4.0 * share), (Y, -3.0 * share))
    pose.morphs |= {"smile": 0.85 * share, "brows": 0.5 * share, "blink": _pulse(t, 2.7, 0.07)}
    return pose.ground()


def _clap(bones: Skeleton, t: float) -> Pose:
    pose = _standing(bones, t, 0.3)
    gap = 0.5 - 0.5 * math.cos(_TURN * t / 0.48)
    for side, _ in SIDES:
        inwards = -0.66 + 0.36 * gap
        pose.arm(side, (side * (0.14 + 0.12 * gap), -0.82, 0.52), (side * inwards, 0.48, 0.80), -20.0)
        pose.hand(side, 0.03, thumb=0.0)
    pose.morphs |= {"smile": 0.8, "brows": 0.25}
    return pose.ground()


def _cheer(bones: Skeleton, t: float) -> Pose:
    pose, share = _standing(bones, t, 0.0), _raised(t, 2.4, 0.35)
    beat = share * math.sin(_TURN * t / 0.6)
    for side, word in SIDES:
        pose.turn(f"{word}Shoulder", (Z, side * 32.0 * share))  # a good part of the rise is the shoulder blade's
        _towards(
            pose, side, share, (side * 0.40, 0.92 + 0.12 * beat, 0.15), (-side * 0.14, 1.0, 0.12 + 0.10 * beat), 10.0
        )
        pose.hand(side, 0.20 + 0.70 * share, thumb=0.3 + 0.5 * share)
    pose.turn("upperChest", (X, -5.0 * share)).turn("head", (X, -6.0 * share))
    pose.morphs |= {"smile": 0.65 * share, "jaw": 0.45 * share, "brows": 0.8 * share}
    pose.ground()
    pose.hips[1] += 0.07 * share * max(math.sin(_TURN * t / 0.6), 0.0)
    return pose


def _step_back(bones: Skeleton, t: float) -> Pose:
    pose = _stride(bones, -t / 1.2, 0.55, 7.0, 18.0, 1.0)
    pose.morphs["brows"] = 0.4
    return pose


def _point(bones: Skeleton, t: float) -> Pose:
    pose, share = _standing(bones, t, -0.4), _raised(t, 2.6)
    _towards(pose, -1, share, (-0.35, -0.10, 0.95), (-0.28, 0.02, 1.0), 35.0)
    pose.hand(-1, 0.20 + 0.65 * share, thumb=0.3 + 0.5 * share, index=0.20 - 0.18 * share)
    pose.turn("chest", (Y, -6.0 * share)).turn("head", (Y, -6.0 * share)).turn("rightShoulder", (Y, 8.0 * share))
    pose.morphs["brows"] = 0.35 * share
    return pose.ground()


def _beckon(bones: Skeleton, t: float) -> Pose:
    pose, share = _standing(bones, t, 0.4), _raised(t, 2.8)
    curl = share * (0.5 - 0.5 * math.cos(_TURN * 1.6 * t))
    _towards(pose, -1, share, (-0.30, -0.90, 0.35), (-0.10, 0.45 + 0.30 * curl, 0.90 - 0.30 * curl), 60.0)
    pose.hand(-1, 0.15 + 0.55 * curl, thumb=0.2)
    pose.turn("head", (X, 3.0 * curl), (Z, 3.0 * share))
    pose.morphs |= {"smile": 0.7 * share, "brows": 0.4 * share}
    return pose.ground()


def _holding(held: Held) -> Callable[[Skeleton, float], Pose]:
    """The right forearm before the body with something in the hand; a mask takes the fingers alone, of both hands."""

    def pose(bones: Skeleton, t: float) -> Pose:
        pose = _standing(bones, t, -0.3)
        _towards(pose, -1, 1.0, (-0.20, -0.95, 0.10), (0.10, -0.05, 1.0), 20.0)
        pose.morphs["smile"] = 0.35
        return hold(pose, held).ground()

    return pose


MOTIONS: Mapping[str, Motion] = {
    "idle": Motion(12.0, True, _idle, rate=8.0),
    "walk": Motion(1.08, True, _walk, 1.25, contacts=(0.0, 0.54)),
    "run": Motion(_RUN_PERIOD, True, _run, 3.0, contacts=(0.0, 0.5 * _RUN_PERIOD)),
    "kick": Motion(1.4, False, _kick),
    "wave": Motion(3.0, False, _wave, rate=14.0),
    "clap": Motion(0.96, True, _clap),
    "cheer": Motion(2.4, False, _cheer, rate=14.0),
    "step_back": Motion(1.2, True, _step_back, -0.6, contacts=(0.456, 1.056)),  # the stride backwards
    "point": Motion(2.6, False, _point, rate=10.0),
    "beckon": Motion(2.8, False, _beckon, rate=12.0),
    **{name: Motion(0.5, True, _holding(held), rate=2.0) for name, held in HELD.items()},
}
"""By name."""
