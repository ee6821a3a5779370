"""Placement of the feet in a gait: the stance foot moves backwards at exactly the pace, the other one swings."""

from __future__ import annotations

import math

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8

__all__ = ["lowest", "place_feet"]


_CLEARANCE = 0.004
"""Minimum clearance of the sole in mid-swing [m]."""

_TOES_UP = 0.44
"""Dorsiflexion of the toes in mid-swing for ground clearance [rad]: 25 degrees."""
_HANDOVER = 0.6
"""Share of double support after which the leading foot carries all load."""

_HEEL_UNTIL = 0.45
"""Share of the stance up to which the foot pitches about the heel, later about the ball."""

_LEAST_FLEXION = 0.035
"""Minimum knee flexion [rad]: 2 degrees."""

_LEAST_LEG = 0.25
"""Minimum squared distance from hip to ankle over the thigh's squared length."""

_SOFT_LIFT = 0.008
"""Height range in which a foot too close to the ground is lifted smoothly [m]."""

_ENDS, _FOOT = 5, 6
"""Numbers that `_ends` and `_stand` write."""


@kernel
def _ease(x: float) -> float:
    """Smooth step from 0 to 1."""
    x = min(max(x, 0.0), 1.0)
    return x * x * x * (10.0 + x * (6.0 * x - 15.0))


@kernel
def _at(table: F8, phase: float, column: int) -> float:
    """Interpolate a column of the cycle's table at a phase by a cubic."""
    count = table.shape[0]
    place = phase * count
    k = int(place)
    x = place - k
    a, b = table[(k - 1) % count, column], table[k % count, column]
    c, d = table[(k + 1) % count, column], table[(k + 2) % count, column]
    return b + 0.5 * x * (c - a + x * (2.0 * a - 5.0 * b + 4.0 * c - d + x * (3.0 * (b - c) + d - a)))


@kernel
def lowest(pitch: float, bend: float, shape: F8, sole: F8) -> float:
    """Return the height of a sole's lowest point over the ankle at a pitch and a bend of the toes."""
    s, c = math.sin(pitch), math.cos(pitch)
    ahead, above = shape[2], shape[7] - shape[0]
    toes_s, toes_c = math.sin(pitch + bend), math.cos(pitch + bend)
    low = math.inf
    for n in range(sole.shape[0]):
        share, z, y = sole[n, 0], sole[n, 1], sole[n, 2]
        front = ahead * s + above * c + (z - ahead) * toes_s + (y - above) * toes_c
        low = min(low, (1.0 - share) * (z * s + y * c) + share * front)
    return low


@kernel
def _stand(phase: float, stance: float, stride: float, touch: float, shape: F8, sole: F8, table: F8, out: F8) -> None:
    """Place a stance foot: the ankle rotates about heel, ball or tip, and the lowest point of the sole is at 0."""
    base = touch - stride * phase
    pitch = _at(table, phase, 2)
    half = _HEEL_UNTIL * stance
    pitch = max(pitch, 0.0) if phase < half else min(pitch, 0.0)
    # Rolled off over the joint of the toes, which stay flat; over the heel's corner before.
    pivot, joint = -shape[1], 0.0
    if pitch < 0.0:
        pivot, joint = shape[2], shape[7]
    elif pitch == 0.0:
        pivot = 0.0
    over, ball = shape[0] - joint, base + pivot
    # Toes that bend no further lift with the foot, about their tip.
    lifted, toes = max(-pitch - shape[6], 0.0), shape[3] - shape[2]
    ball += toes * (1.0 - math.cos(lifted)) + joint * math.sin(lifted)
    out[0] = ball - pivot * math.cos(pitch) - over * math.sin(pitch)
    out[2] = pitch
    out[3], out[4] = base + pivot, 1.0
    out[5] = min(max(-pitch, 0.0), shape[6])
    out[1] = -lowest(pitch, out[5], shape, sole)


@kernel
def _chord(knee: float, shape: F8) -> float:
    """Return the squared distance from hip to ankle for a knee flexion."""
    return shape[4] ** 2 + shape[5] ** 2 + 2.0 * shape[4] * shape[5] * math.cos(max(knee, _LEAST_FLEXION))


@kernel
def _hip_over(phase: float, shape: F8, table: F8, foot: F8) -> float:
    """Return the height of the hip over a stance foot with the table's knee flexion."""
    high = _chord(_at(table, phase, 1), shape) - foot[0] ** 2
    return foot[1] + math.sqrt(max(high, _LEAST_LEG * shape[4] ** 2))


@kernel
def _swing(phase: float, stance: float, ends: F8, hip: float, shape: F8, sole: F8, table: F8, out: F8) -> None:
    """Place a swing foot by the table's thigh and knee, blended between toe-off and heel strike."""
    x = (phase - stance) / (1.0 - stance)
    left, comes = 1.0 - _ease(2.0 * x), _ease(2.0 * x - 1.0)
    thigh, knee = _at(table, phase, 0), _at(table, phase, 1)
    ahead = shape[4] * math.sin(thigh) + shape[5] * math.sin(thigh - knee)
    up = hip - shape[4] * math.cos(thigh) - shape[5] * math.cos(thigh - knee)
    out[0] = ahead + left * ends[0] + comes * ends[2]
    out[1] = up + left * ends[1] + comes * ends[3]
    out[2] = _at(table, phase, 2)
    out[5] = max(left * min(max(-ends[4], 0.0), shape[6]), min(shape[6], _TOES_UP) * math.sin(math.pi * x))
    least = _CLEARANCE * math.sin(math.pi * x) - lowest(out[2], out[5], shape, sole)
    over = out[1] - least
    # Lifted smoothly where it would come nearer to the ground than that, to just that at either end.
    soft = _SOFT_LIFT * math.sin(math.pi * x)
    out[1] = least + 0.5 * (over + math.sqrt(over * over + soft * soft))
    out[3], out[4] = out[0], 0.0


@kernel
def place_feet(
    phase: float, stance: float, stride: float, touch: float, shape: F8, soles: F8, table: F8, out: F8
) -> float:
    """Compute positions of both ankles, pitch of the feet and points of support, relative to the hip.

    A sole touches with the heel, rolls down flat, and rolls off over the ball, by the table's pitch. The point that
    stands moves backwards by the stride in a cycle, whatever the foot does about it; the ankle follows from it. The hip
    is as high as lets the knee that carries bend as the table has it; the foot in the air follows the table.

    Args:
        phase: Phase of the left foot, 0 to 1, 0 at heel strike; the right foot is half a cycle apart.
        stance: Share of the cycle in which a foot stands.
        stride: Displacement of the body in a cycle [m].
        touch: Where the ankle of a flat foot would be at the heel's touch, ahead of the hip [m].
        shape: Ankle above the sole, heel behind the ankle, ball and tip of the toes before it, thigh, shank [m],
            farthest that toes bend [rad], joint of the toes above the
            sole [m]; [8].
        soles: Points that each foot may stand on: share of the toes in carrying it, ahead of the ankle and above it at
            rest [m]; [2, n, 3].
        table: Lean of the thigh, flexion of the knee, pitch of the foot over the cycle [rad], [n, 3].
        out: For each foot: ankle ahead of the hip [m], ankle above the ground [m], pitch (toes up) [rad], point of
            contact ahead of the hip [m], 1 while it stands, bend of the toes up [rad], share of the body that it
            carries; written, [2, 7].

    Returns:
        The hip's height above the ground [m].
    """
    hip = 0.0
    for k in range(2):
        own = (phase + 0.5 * k) % 1.0
        if own >= stance:
            continue
        _stand(own, stance, stride, touch, shape, soles[k], table, out[k])
        both = stance - 0.5
        # The foot that comes down carries before the other one has left.
        load = _ease(own / (_HANDOVER * both)) * (1.0 - _ease((own - 0.5) / (_HANDOVER * both)))
        out[k, 6] = load
        hip += load * _hip_over(own, shape, table, out[k])
    for k in range(2):
        own = (phase + 0.5 * k) % 1.0
        if own < stance:
            continue
        out[k, 6] = 0.0
        ends = np.empty(_ENDS)
        _ends(stance, stride, touch, hip, shape, soles[k], table, ends)
        _swing(own, stance, ends, hip, shape, soles[k], table, out[k])
    return hip


@kernel
def _ends(stance: float, stride: float, touch: float, hip: float, shape: F8, sole: F8, table: F8, ends: F8) -> None:
    """Compute the offsets of the table from the positions at toe-off and heel strike, and the pitch at toe-off."""
    foot = np.empty(_FOOT)
    for k in range(2):
        _stand(stance if k == 0 else 0.0, stance, stride, touch, shape, sole, table, foot)
        phase = stance if k == 0 else 1.0
        thigh, knee = _at(table, phase, 0), _at(table, phase, 1)
        ends[2 * k] = foot[0] - shape[4] * math.sin(thigh) - shape[5] * math.sin(thigh - knee)
        ends[2 * k + 1] = foot[1] - hip + shape[4] * math.cos(thigh) + shape[5] * math.cos(thigh - knee)
        if k == 0:
            ends[4] = foot[2]
