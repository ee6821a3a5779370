"""Where particles are: a closed formula of their number and their age, so that no frame has to come before another."""

from __future__ import annotations

import math

import numpy as np

from mimics_app.contracts.arrays import F4, F8, Records
from mimics_app.contracts.kernel import kernel

__all__ = ["BIRTH", "EMITTER", "MOST_COLOURS", "SPRITE", "ease", "fall", "fill_particles", "hash_unit"]


MOST_COLOURS = 8
MOST_TINTS = 16

EMITTER = np.dtype(
    [
        ("seed", "u8"),
        ("lifetime", "f8", (2,)),  # least, greatest [s]
        ("cosine", "f8"),  # of the cone's half angle
        ("speed", "f8", (2,)),  # [m/s]
        ("drag", "f8"),  # [1/s]
        ("pull", "f8", (3,)),  # gravity and what the wind does through drag, world [m/s^2]
        ("sway", "f8"),  # sideways [m]
        ("sway_rate", "f8"),  # [rad/s]
        ("spin", "f8"),  # greatest [rad/s]
        ("floor", "f8"),  # height at which they rest, world [m]; -inf: none
        ("size", "f8", (2,)),  # full height at birth [m]
        ("aspect", "f8"),  # width over height
        ("growth", "f8"),  # factor at the end of life
        ("colours", "i8"),  # in use
        ("colour", "f8", (MOST_COLOURS, 4)),  # linear RGBA over life
        ("tints", "i8"),  # in use
        ("tint", "f8", (MOST_TINTS, 4)),  # of which each has one
        ("tumbles", "i8"),  # 1: turns in space, 0: about the line of sight
        ("state", "i4"),
        ("style", "f4", (4,)),  # as SPRITE
    ]
)
"""What an emitter gives its particles."""

BIRTH = np.dtype(
    [
        ("number", "i8"),  # whose it is, -1: nobody's
        ("life", "f8"),  # [s]
        ("place", "f8", (3,)),  # in the emitter's box, each 0 to 1
        ("velocity", "f8", (3,)),  # across, across and along the emitter's direction [m/s]
        ("height", "f8"),  # half of it [m]
        ("angle", "f8"),  # [rad]
        ("spin", "f8"),  # [rad/s]
        ("axis", "f8", (3,)),  # it tumbles about, unit, world
        ("phase", "f8", (2,)),  # of its swing [rad]
        ("rest", "f8"),  # height above the floor it lies at [m]
        ("tint", "i8"),
    ]
)
"""What a particle is born with: all that chance decides, computed once and kept while its place is not needed."""

SPRITE = np.dtype(
    [
        ("place", "f8", (3,)),  # world [m]
        ("turn", "f4", (4,)),  # own: quaternion xyzw; else cosine and sine of the turn about the line of sight
        ("tint", "f4", (4,)),  # linear RGBA
        ("style", "f4", (4,)),  # layer, opacity (1: covers, 0: adds light), roundness, cutoff
        ("half", "f4", (2,)),  # of width and height [m]
        ("lift", "f4"),  # of the middle above the place, in half heights
        ("facing", "i4"),  # 0: to the eye, 1: to the eye about the vertical, 2: as turned in the world
        ("state", "i4"),  # what has to be set in the driver
    ]
)
"""One picture in space."""

_GOLDEN = np.uint64(0x9E3779B97F4A7C15)
_STRIDE = np.uint64(0xD1B54A32D192ED03)
_MIX_1 = np.uint64(0xBF58476D1CE4E5B9)
_MIX_2 = np.uint64(0x94D049BB133111EB)
_NEWTON_STEPS = 24
_SETTLED = 1e-7
"""Step below which a landing is found [s]."""

_OWN = 2
_LEAST_REST = 1e-3
"""Height above the floor at which particles come to rest; up to twice as much, so that they do not flicker [m]."""

_FOLD_1, _FOLD_2, _FOLD_3 = np.uint64(30), np.uint64(27), np.uint64(31)
"""Shifts of splitmix64 [bits]."""

_SPARE_BITS, _STEP_OF_ONE = np.uint64(11), 2.0**-53
"""Bits of 64 beyond those that a float64 holds exactly, and the step between its numbers below 1."""

_LIFE, _CONE, _AROUND, _SPEED, _BIRTHPLACE, _REST, _ANGLE, _SPIN = 0, 1, 2, 3, 4, 7, 8, 9
_AXIS_UP, _AXIS_AROUND, _TINT, _PHASE, _HEIGHT = 10, 11, 12, 13, 16
"""Questions about a particle; a place has three numbers, a phase two."""

_COLOUR = 4
"""Numbers of a colour and of a style."""

_HARDLY_DRAGGED, _BARELY_DRAGGED = 1e-3, 1e-8
"""Drag times age [-] below which `fall` and `ease` are their series: the closed form would lose its digits."""


@kernel
def hash_unit(seed: int, number: int, which: int) -> float:
    """A number in [0, 1) for the `which`-th question about particle `number`: splitmix64 (Steele et al. 2014)."""
    z = np.uint64(seed) + np.uint64(number) * _GOLDEN + np.uint64(which) * _STRIDE
    z = (z ^ (z >> _FOLD_1)) * _MIX_1
    z = (z ^ (z >> _FOLD_2)) * _MIX_2
    z = z ^ (z >> _FOLD_3)
    return float(z >> _SPARE_BITS) * _STEP_OF_ONE


@kernel
def ease(age: float, drag: float) -> float:
    """Distance of a unit speed that drag slows down: (1 - exp(-c t)) / c [s]."""
    x = drag * age
    return age * (1.0 - 0.5 * x) if x < _BARELY_DRAGGED else -math.expm1(-x) / drag


@kernel
def fall(age: float, drag: float, eased: float) -> float:
    """Distance under a unit pull that drag slows down: (t - ease) / c [s^2], given `ease` of the same."""
    x = drag * age
    return age * age * (0.5 - x / 6.0 + x * x / 24.0) if x < _HARDLY_DRAGGED else (age - eased) / drag


@kernel
def _bear(emitter: Records, number: int, birth: Records) -> None:
    """Ask all questions about particle `number`."""
    seed, one = emitter[0]["seed"], birth[0]
    one["number"] = number
    shortest, slowest, least = emitter[0]["lifetime"][0], emitter[0]["speed"][0], emitter[0]["size"][0]
    one["life"] = shortest + hash_unit(seed, number, _LIFE) * (emitter[0]["lifetime"][1] - shortest)
    cosine = 1.0 - hash_unit(seed, number, _CONE) * (1.0 - emitter[0]["cosine"])
    sine = math.sqrt(max(0.0, 1.0 - cosine * cosine))
    around = 2.0 * math.pi * hash_unit(seed, number, _AROUND)
    speed = slowest + hash_unit(seed, number, _SPEED) * (emitter[0]["speed"][1] - slowest)
    one["velocity"][0], one["velocity"][1] = speed * math.cos(around) * sine, speed * math.sin(around) * sine
    one["velocity"][2] = speed * cosine
    for k in range(3):
        one["place"][k] = hash_unit(seed, number, _BIRTHPLACE + k)
    one["rest"] = _LEAST_REST * (1.0 + hash_unit(seed, number, _REST))
    one["angle"] = 2.0 * math.pi * hash_unit(seed, number, _ANGLE)
    one["spin"] = emitter[0]["spin"] * (2.0 * hash_unit(seed, number, _SPIN) - 1.0)
    up, around = 2.0 * hash_unit(seed, number, _AXIS_UP) - 1.0, 2.0 * math.pi * hash_unit(seed, number, _AXIS_AROUND)
    flat = math.sqrt(1.0 - up * up)
    one["axis"][0], one["axis"][1], one["axis"][2] = flat * math.cos(around), up, flat * math.sin(around)
    one["tint"] = int(hash_unit(seed, number, _TINT) * emitter[0]["tints"])
    for k in range(2):
        one["phase"][k] = 2.0 * math.pi * hash_unit(seed, number, _PHASE + k)
    one["height"] = 0.5 * (least + hash_unit(seed, number, _HEIGHT) * (emitter[0]["size"][1] - least))


@kernel
def _landing(height: float, speed: float, pull: float, drag: float, floor: float, age: float) -> float:
    """Age at which the floor is reached, `age` itself while still above it.

    Height over time bends one way only, so that Newton's steps come from one side and never pass the root: from the
    present where it bends down, from birth where drag slows a fall.
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
        if abs(step) < _SETTLED:
            break
    return min(max(t, 0.0), age)


@kernel
def _turn(emitter: Records, birth: Records, age: float, landed: bool, out: F4) -> None:
    """How a particle is turned: in space about an axis of its own, lying flat where it landed; or before the eye."""
    one = birth[0]
    angle = one["angle"] + one["spin"] * age
    if not emitter[0]["tumbles"]:
        out[0], out[1], out[2], out[3] = math.cos(angle), math.sin(angle), 0.0, 0.0
        return
    c, s = math.cos(0.5 * angle), math.sin(0.5 * angle)
    if landed:
        # Yaw after a quarter turn about x: the picture's normal points up.
        c, s = c * math.sqrt(0.5), s * math.sqrt(0.5)
        out[0], out[1], out[2], out[3] = -c, s, s, c
        return
    out[0], out[1], out[2], out[3] = one["axis"][0] * s, one["axis"][1] * s, one["axis"][2] * s, c


@kernel
def _colour(emitter: Records, tint: int, share: float, out: F4) -> None:
    """Colour at a share of a life: between the two nearest of the list, times the one tint it was given."""
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
    """Where a particle is; returns the age at which it came to rest, its own while it has not."""
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
            # sin(phase + 2 half) - sin(phase): no swing at birth. Sideways only, so that landings stay what they are.
            out[2 * k] += 2.0 * emitter[0]["sway"] * math.cos(one["phase"][k] + half) * math.sin(half)
    if not math.isinf(floor):
        out[1] = max(out[1], floor + one["rest"])
    return moving


@kernel
def fill_particles(
    emitter: Records,
    births: Records,
    first: int,
    count: int,
    born: float,
    interval: float,
    now: float,
    corner: F8,
    box: F8,
    axes: F8,
    sprites: Records,
    start: int,
) -> int:
    """Write the particles of a row of births that are alive.

    Args:
        emitter: EMITTER, [1].
        births: BIRTH, [slots]: what is kept from call to call; how many there are changes the time, not the places.
        first: Number of the first one.
        count: How many were born.
        born: When the first one was [s].
        interval: Between two births [s].
        now: [s].
        corner: Of the box they begin in, world [m], [3].
        box: Its edges as columns, world [m], [3, 3].
        axes: Two directions across and the middle one, unit columns, world, [3, 3].
        sprites: SPRITE, written from `start` on.
        start: Where.

    Returns:
        Number of the next free one in `sprites`.
    """
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
