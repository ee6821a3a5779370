"""The simulated person in the gait orthosis: torques of muscles and tissue at the joints of both legs.

The person intends an own gait, hip and knee as Fourier series over the cycle with a stride that varies, and draws the
joints towards it with what strength there is. To that come

- weakness: a share of the torque of a healthy leg, per leg; fatigue takes more of it with use, and gives it back;
- spasticity: a stretch of the extensors or flexors beyond a threshold speed is answered against it, after the reflex's
  delay and with the lag of the muscle (Lance's velocity-dependent stretch reflex);
- clonus: a stretch beyond a speed of its own starts a rhythm of such answers that dies out;
- contracture: tissue that stops a joint before its range ends;
- fear: antagonists pulled together, a stiffness around where the leg is, without any direction.

Positive torques and angles are flexion.
"""

from __future__ import annotations

import math

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.rendering.haptic.kernels.noise import gauss

__all__ = [
    "AMPLITUDE",
    "CLONUS",
    "CLONUS_HZ",
    "CLONUS_SPEED",
    "CLONUS_TIME",
    "CONTRACTURE",
    "CONTRACTURE_MAX",
    "CONTRACTURE_MIN",
    "DAMPING",
    "EXTENDING",
    "FATIGUE",
    "FEAR",
    "FLEXING",
    "GAIT",
    "GENERATOR",
    "HARMONICS",
    "KEEPS",
    "LIMB",
    "LIMBS",
    "PASSIVE_DAMPING",
    "PASSIVE_STIFFNESS",
    "PHASE",
    "RECOVERY",
    "REFLEX_TICKS",
    "REST",
    "SERIES",
    "SHARE",
    "SPASTICITY",
    "STIFFNESS",
    "STRENGTH",
    "STRIDE",
    "STRIDE_NOW",
    "THRESHOLD",
    "TIRED",
    "VARIATION",
    "WALKER",
    "WILL",
    "intended",
    "keep_step",
    "limb_of",
    "limb_torques",
    "move_walker",
]

HARMONICS = 4
SERIES = 1 + 2 * HARMONICS  # mean, then cosine and sine of every harmonic [rad]

PHASE = 0  # of the own gait, 0-1 from the left foot's contact on
STRIDE = 1  # mean duration of a stride [s]
VARIATION = 2  # its coefficient of variation from stride to stride [-]
STRIDE_NOW = 3  # of the present stride [s]
AMPLITUDE = 4  # of the own gait as a share of that of the series
GENERATOR = 5  # state of the random generator
WILL = 6  # share of the voluntary torque: who begins to walk does not start at once
KEEPS = 7  # rate at which the own gait is drawn to the step in which the legs are led [1/s]; 0: it keeps its own time
GAIT = 8  # series of hip and knee
LIMBS = GAIT + 2 * SERIES  # records of the left and the right limb

FLEXING, EXTENDING = 0, 1  # directions: of a torque, and of the motion that a reflex answers

SHARE = 0  # of the torque of a healthy leg, 0-1
STRENGTH = 1  # largest voluntary torque [N m]: hip flexing, extending, knee flexing, extending
STIFFNESS = 5  # with which hip and knee are drawn to the own gait [N m/rad]
DAMPING = 7  # [N m s/rad]
SPASTICITY = 9  # of the stretch reflex [N m s/rad]: against hip flexing, extending, knee flexing, extending
THRESHOLD = 13  # speed from which on a stretch is answered [rad/s]
CLONUS = 14  # greatest torque of a beat at the knee [N m]
CLONUS_SPEED = 15  # speed of a stretch that starts clonus [rad/s]
CLONUS_HZ = 16  # beats per second
CLONUS_TIME = 17  # time constant of its decay [s]
CONTRACTURE_MIN = 18  # angles of hip and knee at which tissue stops them [rad]
CONTRACTURE_MAX = 20
CONTRACTURE = 22  # stiffness beyond [N m/rad]
PASSIVE_STIFFNESS = 23  # of tissue [N m/rad], hip and knee
PASSIVE_DAMPING = 25  # [N m s/rad]
REST = 27  # angles at which tissue rests [rad]
FEAR = 29  # co-contraction, 0-1
FATIGUE = 30  # strength lost by full effort [1/s]
RECOVERY = 31  # and won back [1/s]
TIRED = 32  # share of the strength lost
_REFLEX = 33  # answers of the stretch reflexes, hip and knee [N m]
_CLONUS_LEFT = 35  # strength of clonus, 0-1
_CLONUS_BEAT = 36  # its phase [cycles]
_SLOW = 37  # angles to which co-contraction holds [rad], hip and knee
_PLACED = 39  # 1 once these are set
_TICK = 40  # place of the newest speed in the ring
REFLEX_TICKS = 41  # delay of a reflex [ticks]
_RING = 42  # speeds of hip and knee of the last _PAST ticks [rad/s]
_PAST = 128
LIMB = _RING + 2 * _PAST
WALKER = LIMBS + 2 * LIMB

_MUSCLE_LAG = 0.04
"""Time constant of a muscle's torque after its nerve [s]; a setting, not verified."""

_BEGINNING = 1.0
"""Time in which a person who begins to walk comes to the whole torque [s]."""

_FEAR_STIFFNESS, _FEAR_DAMPING, _FEAR_TIME = 60.0, 4.0, 0.5
"""Co-contraction at full fear [N m/rad, N m s/rad], and time in which it yields [s]; settings, not verified."""

_CONTRACTURE_DAMPING = 0.02
"""Damping of contracture per stiffness [s]."""

_APART = 0.08
"""Amplitude of the hips' difference from which on a step is felt [rad]."""

_FASTEST, _SLOWEST = 0.5, 1.5
"""Bounds of a stride's duration, as shares of the mean."""


@kernel
def limb_of(walker: Vec, number: int) -> Vec:
    """Record of one limb, shape [LIMB]."""
    return walker[LIMBS + number * LIMB : LIMBS + (number + 1) * LIMB]


@kernel
def intended(walker: Vec, joint: int, phase: float) -> tuple[float, float]:
    """Angle [rad] of hip or knee in the own gait at a phase of the limb's cycle, and its rate by the phase [rad]."""
    first = GAIT + joint * SERIES
    angle, rate = walker[first], 0.0
    for k in range(1, HARMONICS + 1):
        turn = 2.0 * math.pi * k
        cosine, sine = math.cos(turn * phase), math.sin(turn * phase)
        a, b = walker[first + 2 * k - 1], walker[first + 2 * k]
        angle += walker[AMPLITUDE] * (a * cosine + b * sine)
        rate += walker[AMPLITUDE] * turn * (b * cosine - a * sine)
    return angle, rate


@kernel
def keep_step(walker: Vec, apart: float, rate: float, dt: float) -> None:
    """Draw the phase of the own gait to that in which both hips are.

    Args:
        walker: Record of `WALKER` numbers.
        apart: Left hip minus right one [rad].
        rate: Its rate [rad/s].
        dt: Tick [s].
    """
    turn = 2.0 * math.pi
    moves = rate * walker[STRIDE_NOW] / turn
    if walker[KEEPS] == 0.0 or math.hypot(apart, moves) < _APART:
        return
    left, left_rate = intended(walker, 0, walker[PHASE])
    right, right_rate = intended(walker, 0, walker[PHASE] + 0.5)
    ahead = math.atan2(-moves, apart) - math.atan2((right_rate - left_rate) / turn, left - right)
    ahead = math.atan2(math.sin(ahead), math.cos(ahead)) / turn
    walker[PHASE] = (walker[PHASE] + walker[KEEPS] * ahead * dt) % 1.0


@kernel
def _step_on(walker: Vec, dt: float) -> None:
    """Advance the own gait by a tick; every stride has its own duration."""
    walker[PHASE] += dt / walker[STRIDE_NOW]
    if walker[PHASE] >= 1.0:
        walker[PHASE] -= 1.0
        spread = 1.0 + walker[VARIATION] * gauss(walker, GENERATOR)
        walker[STRIDE_NOW] = walker[STRIDE] * min(_SLOWEST, max(_FASTEST, spread))


@kernel
def _voluntary(walker: Vec, limb: Vec, joint: int, phase: float, q: float, dq: float) -> float:
    """Torque [N m] that draws a joint to the own gait, within the strength that is left."""
    angle, rate = intended(walker, joint, phase)
    effort = limb[STIFFNESS + joint] * (angle - q) + limb[DAMPING + joint] * (rate / walker[STRIDE_NOW] - dq)
    strongest = limb[STRENGTH + 2 * joint + (FLEXING if effort > 0.0 else EXTENDING)]
    return walker[WILL] * limb[SHARE] * (1.0 - limb[TIRED]) * min(strongest, max(-strongest, effort))


@kernel
def _tire(limb: Vec, tau: Vec, dt: float) -> None:
    """Take strength for voluntary torques and give some back."""
    use = 0.0
    for joint in range(2):
        side = FLEXING if tau[joint] > 0.0 else EXTENDING
        use = max(use, abs(tau[joint]) / max(1.0, limb[STRENGTH + 2 * joint + side]))
    limb[TIRED] += dt * (limb[FATIGUE] * use * (1.0 - limb[TIRED]) - limb[RECOVERY] * limb[TIRED])


@kernel
def _answer_stretch(limb: Vec, joint: int, dt: float) -> float:
    """Torque [N m] of the stretch reflex of a joint, from its speed a reflex's delay ago."""
    past = (int(limb[_TICK]) - int(limb[REFLEX_TICKS])) % _PAST
    speed = limb[_RING + 2 * past + joint]
    side = FLEXING if speed > 0.0 else EXTENDING
    answer = limb[SPASTICITY + 2 * joint + side] * max(0.0, abs(speed) - limb[THRESHOLD])
    wish = -math.copysign(answer, speed)
    limb[_REFLEX + joint] += (1.0 - math.exp(-dt / _MUSCLE_LAG)) * (wish - limb[_REFLEX + joint])
    if joint == 1 and speed > limb[CLONUS_SPEED] and limb[CLONUS] > 0.0:
        limb[_CLONUS_LEFT] = 1.0
    return limb[_REFLEX + joint]


@kernel
def _beat(limb: Vec, dt: float) -> float:
    """Torque of clonus at the knee [N m]: beats of the extensors, which a fast flexion has started."""
    limb[_CLONUS_BEAT] = (limb[_CLONUS_BEAT] + limb[CLONUS_HZ] * dt) % 1.0
    limb[_CLONUS_LEFT] *= math.exp(-dt / limb[CLONUS_TIME])
    return -limb[CLONUS] * limb[_CLONUS_LEFT] * max(0.0, math.sin(2.0 * math.pi * limb[_CLONUS_BEAT]))


@kernel
def _tissue(limb: Vec, joint: int, q: float, dq: float) -> float:
    """Torque of passive tissue and contracture [N m]; a contracture only pushes."""
    tau = -limb[PASSIVE_STIFFNESS + joint] * (q - limb[REST + joint]) - limb[PASSIVE_DAMPING + joint] * dq
    stiff, damping = limb[CONTRACTURE], _CONTRACTURE_DAMPING * limb[CONTRACTURE]
    if q < limb[CONTRACTURE_MIN + joint]:
        tau += max(0.0, stiff * (limb[CONTRACTURE_MIN + joint] - q) - damping * dq)
    elif q > limb[CONTRACTURE_MAX + joint]:
        tau += min(0.0, stiff * (limb[CONTRACTURE_MAX + joint] - q) - damping * dq)
    return tau


@kernel
def _brace(limb: Vec, joint: int, q: float, dq: float, dt: float) -> float:
    """Torque of co-contraction [N m] around an angle that follows the leg slowly."""
    limb[_SLOW + joint] += dt / _FEAR_TIME * (q - limb[_SLOW + joint])
    return -limb[FEAR] * (_FEAR_STIFFNESS * (q - limb[_SLOW + joint]) + _FEAR_DAMPING * dq)


@kernel
def limb_torques(walker: Vec, number: int, q: Vec, dq: Vec, acting: bool, dt: float, tau: Vec) -> None:
    """Set the torques of one limb [N m], shape [2], and advance its muscles by a tick.

    Args:
        walker: Record of `WALKER` numbers.
        number: 0 the left, 1 the right limb.
        q: Angles of hip and knee [rad], shape [2].
        dq: Their velocities [rad/s], shape [2].
        acting: Whether the person walks; otherwise the muscles only answer stretches.
        dt: Tick [s].
        tau: Out: the torques.
    """
    limb = limb_of(walker, number)
    if limb[_PLACED] == 0.0:
        limb[_PLACED] = 1.0
        limb[_SLOW], limb[_SLOW + 1] = q[0], q[1]
    limb[_TICK] = (limb[_TICK] + 1.0) % _PAST
    phase = (walker[PHASE] + 0.5 * number) % 1.0
    for joint in range(2):
        limb[_RING + 2 * int(limb[_TICK]) + joint] = dq[joint]
        tau[joint] = _voluntary(walker, limb, joint, phase, q[joint], dq[joint]) if acting else 0.0
    _tire(limb, tau, dt)
    for joint in range(2):
        tau[joint] += _answer_stretch(limb, joint, dt) + _tissue(limb, joint, q[joint], dq[joint])
        tau[joint] += _brace(limb, joint, q[joint], dq[joint], dt)
    tau[1] += _beat(limb, dt)


@kernel
def move_walker(walker: Vec, acting: bool, dt: float) -> None:
    """Advance the own gait of a person by a tick of dt [s] while it walks; it begins softly, and ends at once."""
    walker[WILL] = min(1.0, walker[WILL] + dt / _BEGINNING) if acting else 0.0
    if acting:
        _step_on(walker, dt)
