"""Particles in closed form of their number and age, so that any frame can be computed on its own."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F4, F8, Records

__all__ = ["BIRTH", "EMITTER", "SPRITE", "BirthPlace", "Series", "ease", "fall", "fill_particles", "hash_unit"]


_MAX_COLOURS = 8
MAX_TINTS = 16

EMITTER = np.dtype(
    [
        ("seed", "u8"),
        ("lifetime", "f8", (2,)),  # minimum, maximum [s]
        ("cosine", "f8"),  # cosine of the cone's half angle
        ("speed", "f8", (2,)),  # [m/s]
        ("drag", "f8"),  # [1/s]
        ("pull", "f8", (3,)),  # acceleration by gravity and by the wind through drag, world [m/s^2]
        ("sway", "f8"),  # horizontal amplitude [m]
        ("sway_rate", "f8"),  # [rad/s]
        ("spin", "f8"),  # maximum [rad/s]
        ("angles", "f8"),  # range of the angle at birth [rad]
        ("floor", "f8"),  # height at which they come to rest, world [m]; -inf: none
        ("size", "f8", (2,)),  # full height at birth [m]
        ("aspect", "f8"),  # width over height
        ("growth", "f8"),  # factor on the size at the end of life
        ("colours", "i8"),  # number of colours in use
        ("colour", "f8", (_MAX_COLOURS, 4)),  # linear RGBA over life
        ("tints", "i8"),  # number of tints in use
        ("tint", "f8", (MAX_TINTS, 4)),  # each particle has one
        ("tumbles", "i8"),  # 1: rotates in space, 0: about the line of sight
        ("state", "i4"),
        ("style", "f4", (4,)),  # as in SPRITE
    ]
)
"""Parameters of an emitter."""

BIRTH = np.dtype(
    [
        ("number", "i8"),  # number of the particle, of either sign; -2^62: none
        ("life", "f8"),  # [s]
        ("place", "f8", (3,)),  # position in the emitter's box, each 0 to 1
        ("velocity", "f8", (3,)),  # two components across and one along the emitter's direction [m/s]
        ("height", "f8"),  # half height [m]
        ("angle", "f8"),  # [rad]
        ("spin", "f8"),  # [rad/s]
        ("axis", "f8", (3,)),  # axis of tumbling, unit, world
        ("phase", "f8", (2,)),  # phases of its sway [rad]
        ("rest", "f8"),  # height above the floor at rest [m]
        ("tint", "i8"),
    ]
)
"""Random properties of a particle, computed once and kept while its slot is not needed."""

SPRITE = np.dtype(
    [
        ("place", "f8", (3,)),  # world [m]
        ("turn", "f4", (4,)),  # facing 2: quaternion xyzw; else cosine and sine of the angle about the line of sight
        ("tint", "f4", (4,)),  # linear RGBA
        ("style", "f4", (4,)),  # layer, opacity (1: covers, 0: adds light), roundness, alpha cutoff
        ("half", "f4", (2,)),  # half width and half height [m]
        ("lift", "f4"),  # height of the centre above the position, in half heights
        ("facing", "i4"),  # 0: to the camera, 1: to the camera about the vertical, 2: `turn`, 3: to the camera, level
        ("state", "i4"),  # number of the render state
    ]
)
"""One sprite: a textured rectangle in space."""

_GOLDEN = np.uint64(0x9E3779B97F4A7C15)
_STRIDE = np.uint64(0xD1B54A32D192ED03)
_MIX_1 = np.uint64(0xBF58476D1CE4E5B9)
_MIX_2 = np.uint64(0x94D049BB133111EB)
_NEWTON_STEPS = 24
_CONVERGED = 1e-7
"""Newton step below which the landing time has converged [s]."""

_OWN = 2
_MIN_REST = 1e-3
"""Minimum height above the floor at which particles come to rest; up to twice as much, against z-fighting [m]."""

_FOLD_1, _FOLD_2, _FOLD_3 = np.uint64(30), np.uint64(27), np.uint64(31)
"""Shifts of splitmix64 [bits]."""

_SPARE_BITS, _EPSILON = np.uint64(11), 2.0**-53
"""Bits of 64 beyond a float64's mantissa, and the spacing of the numbers in [0, 1) [-]."""

_LIFE, _CONE, _AROUND, _SPEED, _BIRTHPLACE, _REST, _ANGLE, _SPIN = 0, 1, 2, 3, 4, 7, 8, 9
_AXIS_UP, _AXIS_AROUND, _TINT, _PHASE, _HEIGHT = 10, 11, 12, 13, 16
"""Indices of a particle's random numbers; a position takes three, a phase two."""

_COLOUR = 4
"""Components of a colour and of a style."""

_SERIES_FALL, _SERIES_EASE = 1e-3, 1e-8
"""Drag times age [-] below which `fall` and `ease` use series: the closed form would lose digits to cancellation."""


@kernel
def hash_unit(seed: int, number: int, which: int) -> float:
    """Return the `which`-th random number of particle `number`, in [0, 1): splitmix64 (Steele et al. 2014)."""
    z = np.uint64(seed) + np.uint64(number) * _GOLDEN + np.uint64(which) * _STRIDE
    z = (z ^ (z >> _FOLD_1)) * _MIX_1
    z = (z ^ (z >> _FOLD_2)) * _MIX_2
    z = z ^ (z >> _FOLD_3)
    return float(z >> _SPARE_BITS) * _EPSILON


@kernel
def ease(age: float, drag: float) -> float:
    """Return the distance at unit initial speed under drag: (1 - exp(-c t)) / c [s]."""
    x = drag * age
    return age * (1.0 - 0.5 * x) if x < _SERIES_EASE else -math.expm1(-x) / drag


@kernel
def fall(age: float, drag: float, slowed: float) -> float:
    """Return the distance under unit acceleration and drag: (t - ease) / c [s^2], given `ease` of the same age."""
    x = drag * age
    return age * age * (0.5 - x / 6.0 + x * x / 24.0) if x < _SERIES_FALL else (age - slowed) / drag


@kernel
def _bear(emitter: Records, number: int, birth: Records) -> None:
    """Compute the random properties of particle `number`."""
    seed, one = emitter[0]["seed"], birth[0]
    one["number"] = number
    shortest, slowest, smallest = emitter[0]["lifetime"][0], emitter[0]["speed"][0], emitter[0]["size"][0]
    one["life"] = shortest + hash_unit(seed, number, _LIFE) * (emitter[0]["lifetime"][1] - shortest)
    cosine = 1.0 - hash_unit(seed, number, _CONE) * (1.0 - emitter[0]["cosine"])
    sine = math.sqrt(max(0.0, 1.0 - cosine * cosine))
    around = 2.0 * math.pi * hash_unit(seed, number, _AROUND)
    speed = slowest + hash_unit(seed, number, _SPEED) * (emitter[0]["speed"][1] - slowest)
    one["velocity"][0], one["velocity"][1] = speed * math.cos(around) * sine, speed * math.sin(around) * sine
    one["velocity"][2] = speed * cosine
    for k in range(3):
        one["place"][k] = hash_unit(seed, number, _BIRTHPLACE + k)
    one["rest"] = _MIN_REST * (1.0 + hash_unit(seed, number, _REST))
    one["angle"] = emitter[0]["angles"] * hash_unit(seed, number, _ANGLE)
    one["spin"] = emitter[0]["spin"] * (2.0 * hash_unit(seed, number, _SPIN) - 1.0)
    up, around = 2.0 * hash_unit(seed, number, _AXIS_UP) - 1.0, 2.0 * math.pi * hash_unit(seed, number, _AXIS_AROUND)
    flat = math.sqrt(1.0 - up * up)
    one["axis"][0], one["axis"][1], one["axis"][2] = flat * math.cos(around), up, flat * math.sin(around)
    one["tint"] = int(hash_unit(seed, number, _TINT) * emitter[0]["tints"])
    for k in range(2):
        one["phase"][k] = 2.0 * math.pi * hash_unit(seed, number, _PHASE + k)
    one["height"] = 0.5 * (smallest + hash_unit(seed, number, _HEIGHT) * (emitter[0]["size"][1] - smallest))


@kernel
def _landing(height: float, speed: float, pull: float, drag: float, floor: float, age: float) -> float:
    """Return the age at which the floor is reached, `age` while still above it.

    The curvature of height over time has one sign, so that Newton's method converges from one side: from the present
    where it is concave, from birth where drag slows a fall.
    """
    gone = ease(age, drag)
    if height + speed * gone + pull * fall(age, drag, gone) >= floor or height < floor:
        return age
    t = age if pull < drag * speed else 0.0
    for _ in range(_NEWTON_STEPS):
        gone = ease(t, drag)
        rate = speed * (1.0 - drag * gone) + pull * gone
        if rate >= 0.0:
            break
        step = (height + speed * gone + pull * fall(t, drag, gone) - floor) / rate
        t -= step
        if abs(step) < _CONVERGED:
            break
    return min(max(t, 0.0), age)


@kernel
def _turn(emitter: Records, birth: Records, age: float, landed: bool, out: F4) -> None:
    """Write a particle's rotation: about its own axis in space, flat once landed; or about the line of sight."""
    one = birth[0]
    angle = one["angle"] + one["spin"] * age
    if not emitter[0]["tumbles"]:
        out[0], out[1], out[2], out[3] = math.cos(angle), math.sin(angle), 0.0, 0.0
        return
    c, s = math.cos(0.5 * angle), math.sin(0.5 * angle)
    if landed:
        # Yaw after a rotation by 90 degrees about x: the sprite's normal points up.
        c, s = c * math.sqrt(0.5), s * math.sqrt(0.5)
        out[0], out[1], out[2], out[3] = -c, s, s, c
        return
    out[0], out[1], out[2], out[3] = one["axis"][0] * s, one["axis"][1] * s, one["axis"][2] * s, c


@kernel
def _colour(emitter: Records, tint: int, share: float, out: F4) -> None:
    """Write the colour at a share of a life: interpolated in the list of colours, times the particle's tint."""
    last = emitter[0]["colours"] - 1
    at = share * last
    first = min(int(at), max(last - 1, 0))
    mix = at - first
    after = min(first + 1, last)
    for k in range(_COLOUR):
        value = emitter[0]["colour"][first, k] * (1.0 - mix) + emitter[0]["colour"][after, k] * mix
        out[k] = value * emitter[0]["tint"][tint, k]


@kernel
def _place(emitter: Records, birth: Records, age: float, corner: F8, box: F8, axes: F8, out: F8) -> float:
    """Write a particle's position; return the age at which it came to rest, its present age while it moves."""
    one, drag, floor = birth[0], emitter[0]["drag"], emitter[0]["floor"]
    at, velocity = one["place"], one["velocity"]
    moving = age
    if not math.isinf(floor):
        born = corner[1] + at[0] * box[1, 0] + at[1] * box[1, 1] + at[2] * box[1, 2]
        climb = velocity[0] * axes[1, 0] + velocity[1] * axes[1, 1] + velocity[2] * axes[1, 2]
        moving = _landing(born, climb, emitter[0]["pull"][1], drag, floor, age)
    gone = ease(moving, drag)
    pulled = fall(moving, drag, gone)
    for k in range(3):
        begin = corner[k] + at[0] * box[k, 0] + at[1] * box[k, 1] + at[2] * box[k, 2]
        speed = velocity[0] * axes[k, 0] + velocity[1] * axes[k, 1] + velocity[2] * axes[k, 2]
        out[k] = begin + speed * gone + emitter[0]["pull"][k] * pulled
    if emitter[0]["sway"] > 0.0:
        half = 0.5 * emitter[0]["sway_rate"] * moving
        for k in range(2):
            # sin(phase + 2 half) - sin(phase): no sway at birth. Horizontal only, so that landings are unaffected.
            out[2 * k] += 2.0 * emitter[0]["sway"] * math.cos(one["phase"][k] + half) * math.sin(half)
    if not math.isinf(floor):
        out[1] = max(out[1], floor + one["rest"])
    return moving


class Series(NamedTuple):
    """Particles that are born one after the other.

    Attributes:
        first: Number of the first particle.
        births: Their number.
        born: Time of the first birth [s].
        interval: Time between two births [s].
    """

    first: int
    births: int
    born: float
    interval: float


class BirthPlace(NamedTuple):
    """Where and in which direction particles are born.

    Attributes:
        corner: Corner of the box they are born in, world [m], [3].
        box: Edges of the box as columns, world [m], [3, 3].
        axes: Two unit vectors across and one along the emitter's direction as columns, world, [3, 3].
    """

    corner: F8
    box: F8
    axes: F8


@kernel
def fill_particles(
    emitter: Records,
    births: Records,
    series: Series,
    now: float,
    place: BirthPlace,
    sprites: Records,
    start: int,
) -> int:
    """Write the sprites of the living particles of a sequence of births.

    Args:
        emitter: EMITTER, [1].
        births: BIRTH, [slots]: cache kept from call to call; the number of slots affects the run time alone.
        series: The births.
        now: Present time [s].
        place: Where they are born.
        sprites: SPRITE, written from `start` on.
        start: First row to write.

    Returns:
        The next free row of `sprites`.
    """
    first, count, born, interval = series
    corner, box, axes = place
    at = start
    for i in range(count):
        age, number = now - (born + interval * i), first + i
        slot = number % births.shape[0]
        birth = births[slot : slot + 1]
        if birth[0]["number"] != number:
            _bear(emitter, number, birth)
        life = birth[0]["life"]
        if age < 0.0 or age > life:
            continue
        sprite, share = sprites[at], age / life
        moving = _place(emitter, birth, age, corner, box, axes, sprite["place"])
        _turn(emitter, birth, moving, moving < age, sprite["turn"])
        _colour(emitter, birth[0]["tint"], share, sprite["tint"])
        height = birth[0]["height"] * (1.0 + (emitter[0]["growth"] - 1.0) * share)
        sprite["half"][0], sprite["half"][1] = height * emitter[0]["aspect"], height
        sprite["lift"] = 0.0
        sprite["facing"] = _OWN if emitter[0]["tumbles"] else 0
        sprite["state"] = emitter[0]["state"]
        for k in range(_COLOUR):
            sprite["style"][k] = emitter[0]["style"][k]
        at += 1
    return at
