"""A human arm on the handle: mass, damping and stiffness around an intended movement.

The hand is a mass held to the handle by a stiff grip. Muscles pull it towards the intended position with the arm's
stiffness and damping. The intention is a chain of minimum-jerk movements (Flash and Hogan 1985) along the way: each
starts where the last one meant to end, aims at the point of the way that lies one reach ahead of where the hand is
now, and misses it by a random error that shrinks with the length of the movement (Fitts 1954, Schmidt et al. 1979).
Between its ends a movement follows the path, but cuts its corners by a share of what the straight line would.

Without a way the person goes after a target that is given (where the scene's task asks the hand to be), as far as it is
seen: a movement towards it no longer than a reach, a pause, a look at what is still missing, the next movement. What
the weight of a held thing pulls the hand down by is thus corrected as it is seen. The hand closes when asked to.

Tremor is a force. Nothing here touches the robot: the only result is the force of the grip on the handle.
"""

from __future__ import annotations

import math

from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.kernel import kernel
from mimics_app.rendering.haptic.kernels.noise import gauss, uniform
from mimics_app.rendering.haptic.kernels.vectors import copy, fill

__all__ = [
    "AIM_ERROR",
    "ARM_DAMPING",
    "ARM_LENGTH",
    "ARM_MASS",
    "ARM_STIFFNESS",
    "CONTENT",
    "CORNER_CUTTING",
    "GENERATOR",
    "GRASP_MEAN",
    "GRASP_VARIATION",
    "GRIP_FORCE",
    "INTENT",
    "PATH",
    "PATH_POINTS",
    "PEAK_SPEED",
    "REACH",
    "REACTION",
    "TREMOR",
    "TREMOR_HZ",
    "TREMOR_PHASE",
    "WAY_POINTS",
    "WAY_STEP",
    "min_jerk",
    "step_arm",
]


PATH_POINTS = 400

HAND = 0  # position 0:3 [m] and velocity 3:6 [m/s], robot frame
PLACED = 6  # 1 once the hand has taken the handle
GRIP_FORCE = 7  # on the handle 7:10 [N], robot frame
WISH = 10  # intended position 10:13 [m] and velocity 13:16 [m/s]
FROM = 16  # start 16:19 of the present movement
TO = 19  # end 19:22
ELAPSED = 22  # [s] in the movement and the pause after it
DURATION = 23  # [s] of the movement
ACTING = 24  # 1 while the person acts
TRIAL = 25
INDEX = 26  # nearest via points at the start of the movement
TIME = 27  # [s] acting, for tremor
GRASP_DRIFT = 28  # slow noise of the grasp force, deviation 1
ARM_MASS = 29
ARM_DAMPING = 30
ARM_STIFFNESS = 31
PEAK_SPEED = 32
REACH = 33
AIM_ERROR = 34
REACTION = 35
TREMOR = 36
TREMOR_HZ = 37
TREMOR_PHASE = 38  # per axis
GRASP_MEAN = 41
GRASP_VARIATION = 42
INTENT = 43  # 0: never acts
GENERATOR = 44
WAY_POINTS = 45  # number in use
WAY_STEP = 46  # arc length between via points [m]
FROM_INDEX = 47  # via points at the start of the movement
TO_INDEX = 48  # and at its end
CORNER_CUTTING = 49  # 0: follows the path, 1: straight lines
SPEED = 50  # velocity 50:53 of the wish when the present movement to a target began [m/s]
CLOSED = 53  # how far the hand is closed, 0-1, as a share of the closing time
CONTENT = 54  # a target nearer than this is reached [m]
SETTLED = 55  # 1 once the target was reached and as long as it stays about there
PATH = 56
ARM_LENGTH = PATH + 3 * PATH_POINTS

_GRIP_STIFFNESS = 4000.0
_GRIP_DAMPING = 50.0
_RELAXED_DAMPING = 5.0
_SHORTEST_MOVEMENT = 0.25
_GRASP_TIME = 0.5
_GRASP_DRIFT_TIME = 0.4
_LOOK_BEHIND = 20
_LOOK_AHEAD = 40
_PEAK_OF_MIN_JERK = 1.875
_WHOLE_AIM = 0.1
"""Length of a movement to a target that is missed by the whole aim error, where a reach is shorter [m]."""
_LEAVES_REST = 2.5
"""A settled hand moves again when the target is farther than this many times the distance that contents it."""


_SHORTEST_REACH, _REACH_SPREAD = 0.8, 0.4
"""A movement reaches this share of the person's reach, and up to so much more by chance [-]."""


@kernel
def min_jerk(share: float) -> float:
    """Minimum-jerk profile: share of the path done at a share 0-1 of the duration; at rest at both ends."""
    u = min(1.0, max(0.0, share))
    return u * u * u * (10.0 + u * (-15.0 + 6.0 * u))


@kernel
def _nearest_way_point(arm: Vec) -> int:
    """Index of the via point nearest to the hand, looked for around the last one: folds of the way do not confuse."""
    last = int(arm[INDEX])
    best = last
    best_square = math.inf
    for k in range(max(0, last - _LOOK_BEHIND), min(int(arm[WAY_POINTS]), last + _LOOK_AHEAD)):
        square = 0.0
        for i in range(3):
            gap = arm[PATH + 3 * k + i] - arm[HAND + i]
            square += gap * gap
        if square < best_square:
            best_square = square
            best = k
    return best


@kernel
def _plan_movement(arm: Vec) -> None:
    """Choose the next movement's end and duration."""
    here = _nearest_way_point(arm)
    arm[INDEX] = here
    arm[FROM_INDEX] = here
    reach = arm[REACH] * (_SHORTEST_REACH + _REACH_SPREAD * uniform(arm, GENERATOR))
    there = min(int(arm[WAY_POINTS]) - 1, here + max(1, int(reach / arm[WAY_STEP])))
    arm[TO_INDEX] = there
    error = arm[AIM_ERROR] * min(1.0, (there - here) * arm[WAY_STEP] / arm[REACH])
    length = 0.0
    for i in range(3):
        arm[FROM + i] = arm[WISH + i]
        arm[TO + i] = arm[PATH + 3 * there + i] + error * gauss(arm, GENERATOR)
        length += (arm[TO + i] - arm[FROM + i]) ** 2
    arm[DURATION] = max(_SHORTEST_MOVEMENT, _PEAK_OF_MIN_JERK * math.sqrt(length) / arm[PEAK_SPEED])
    arm[ELAPSED] = 0.0


@kernel
def _begin(arm: Vec, target: Vec) -> None:
    """Start acting: from where the hand is, at the beginning of the path, or towards the target, the hand open."""
    copy(arm[HAND : HAND + 3], arm[WISH : WISH + 3])
    arm[INDEX] = 0.0
    arm[TIME] = 0.0
    if arm[WAY_POINTS] > 1.0:
        _plan_movement(arm)
        return
    fill(arm[WISH + 3 : WISH + 6], 0.0)
    arm[CLOSED] = 0.0
    arm[SETTLED] = 0.0
    _aim(arm, target)


@kernel
def _wish(arm: Vec, dt: float) -> None:
    """Advance the intended movement."""
    arm[ELAPSED] += dt
    if arm[ELAPSED] >= arm[DURATION] + arm[REACTION]:
        _plan_movement(arm)
    progress = min_jerk(arm[ELAPSED] / arm[DURATION])
    first = int(arm[FROM_INDEX])
    last = int(arm[TO_INDEX])
    place = first + progress * (last - first)
    below = min(int(place), int(arm[WAY_POINTS]) - 2)
    cut = arm[CORNER_CUTTING]
    for i in range(3):
        low = arm[PATH + 3 * below + i]
        along = low + (place - below) * (arm[PATH + 3 * below + 3 + i] - low)
        error_from = arm[FROM + i] - arm[PATH + 3 * first + i]
        error_to = arm[TO + i] - arm[PATH + 3 * last + i]
        curved = along + (1.0 - progress) * error_from + progress * error_to
        straight = arm[FROM + i] + progress * (arm[TO + i] - arm[FROM + i])
        wish = cut * straight + (1.0 - cut) * curved
        arm[WISH + 3 + i] = (wish - arm[WISH + i]) / dt
        arm[WISH + i] = wish


@kernel
def _aim(arm: Vec, target: Vec) -> None:
    """Choose the next movement to a target: as far as a reach goes, missed by an error that shrinks with the length."""
    missing = 0.0
    for i in range(3):
        missing += (target[i] - arm[HAND + i]) ** 2
    missing = math.sqrt(missing)
    content = arm[CONTENT] * (_LEAVES_REST if arm[SETTLED] != 0.0 else 1.0)
    arm[SETTLED] = 1.0 if missing <= content else 0.0
    arm[ELAPSED] = 0.0
    share = 0.0
    error = 0.0
    if arm[SETTLED] == 0.0:
        reach = arm[REACH] * (_SHORTEST_REACH + _REACH_SPREAD * uniform(arm, GENERATOR))
        share = min(1.0, reach / missing)
        error = arm[AIM_ERROR] * min(1.0, share * missing / max(arm[REACH], _WHOLE_AIM))
    length = 0.0
    for i in range(3):
        arm[FROM + i] = arm[WISH + i]
        arm[SPEED + i] = arm[WISH + 3 + i]
        step = share * (target[i] - arm[HAND + i]) + error * gauss(arm, GENERATOR)
        arm[TO + i] = arm[WISH + i] + step
        length += step * step
    arm[DURATION] = max(_SHORTEST_MOVEMENT, _PEAK_OF_MIN_JERK * math.sqrt(length) / arm[PEAK_SPEED])


@kernel
def _go_after(arm: Vec, target: Vec, dt: float) -> None:
    """Advance the intended movement to a target: minimum jerk from where and how fast the last one left the wish."""
    arm[ELAPSED] += dt
    if arm[ELAPSED] >= arm[DURATION] + arm[REACTION]:
        _aim(arm, target)
    u = min(1.0, arm[ELAPSED] / arm[DURATION])
    for i in range(3):
        span = arm[TO + i] - arm[FROM + i]
        begun = arm[SPEED + i] * arm[DURATION]
        curve = 10.0 * span - 6.0 * begun + u * (-15.0 * span + 8.0 * begun + u * (6.0 * span - 3.0 * begun))
        wish = arm[FROM + i] + u * (begun + u * u * curve)
        arm[WISH + 3 + i] = (wish - arm[WISH + i]) / dt
        arm[WISH + i] = wish


@kernel
def _grasp(arm: Vec, closed: float, dt: float) -> float:
    """Grasp force [N] of a hand closed by a share 0-1 of the closing time: wavering slowly around its mean."""
    share = dt / _GRASP_DRIFT_TIME
    arm[GRASP_DRIFT] += -share * arm[GRASP_DRIFT] + math.sqrt(2.0 * share) * gauss(arm, GENERATOR)
    return max(0.0, min_jerk(closed) * (arm[GRASP_MEAN] + arm[GRASP_VARIATION] * arm[GRASP_DRIFT]))


@kernel
def _act(arm: Vec, target: Vec, close: float, dt: float) -> float:
    """One tick of intent: along the way, or after the target. The grasp force [N]."""
    arm[TIME] += dt
    if arm[WAY_POINTS] > 1.0:
        _wish(arm, dt)
        return _grasp(arm, arm[TIME] / _GRASP_TIME, dt)
    _go_after(arm, target, dt)
    change = dt / _GRASP_TIME
    arm[CLOSED] = min(1.0, max(0.0, arm[CLOSED] + (change if close > 0.0 else -change)))
    return _grasp(arm, arm[CLOSED], dt)


@kernel
def step_arm(arm: Vec, handle: Vec, active: bool, trial: float, target: Vec, close: float, dt: float) -> float:
    """Advance the person by one tick.

    Args:
        arm: Arm memory, shape [ARM_LENGTH]; the force on the handle is left in arm[GRIP_FORCE:GRIP_FORCE + 3].
        handle: Position [m] and velocity [m/s] of the handle, robot frame, shape [6].
        active: Whether the person may act; otherwise the arm hangs on the handle and follows.
        trial: Counts trials; a change starts the way over.
        target: Where a person without a path is to bring the hand, robot frame [m].
        close: Above 0: that person is to close the hand.
        dt: Tick [s].

    Returns:
        Grasp force [N].
    """
    if arm[PLACED] == 0.0:
        arm[PLACED] = 1.0
        copy(handle[0:3], arm[HAND : HAND + 3])
    acting = active and arm[INTENT] != 0.0
    if acting and (arm[ACTING] == 0.0 or arm[TRIAL] != trial):
        _begin(arm, target)
    arm[ACTING] = 1.0 if acting else 0.0
    arm[TRIAL] = trial
    grasp = 0.0
    if acting:
        grasp = _act(arm, target, close, dt)
    for i in range(3):
        x = arm[HAND + i]
        v = arm[HAND + 3 + i]
        pull = _GRIP_STIFFNESS * (x - handle[i]) + _GRIP_DAMPING * (v - handle[3 + i])
        muscle = -_RELAXED_DAMPING * v
        if acting:
            muscle = arm[ARM_STIFFNESS] * (arm[WISH + i] - x) + arm[ARM_DAMPING] * (arm[WISH + 3 + i] - v)
            muscle += arm[TREMOR] * math.sin(2.0 * math.pi * arm[TREMOR_HZ] * arm[TIME] + arm[TREMOR_PHASE + i])
        v += dt * (muscle - pull) / arm[ARM_MASS]
        arm[HAND + 3 + i] = v
        arm[HAND + i] = x + dt * v
        arm[GRIP_FORCE + i] = pull
    return grasp
