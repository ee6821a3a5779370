"""Simulated human arm on the handle: mass, damping and stiffness around an intended movement.

The hand is a mass held to the handle by a stiff grip. Muscles pull it towards the intended position with the arm's
stiffness and damping. The intention is a chain of minimum-jerk movements (Flash and Hogan 1985) along a path: each
starts at the intended end of the last one, aims at the point of the path one reach ahead of the present position of the
hand, and misses it by a random error that shrinks with the length of the movement (Fitts 1954, Schmidt et al. 1979).
Between its ends a movement follows the path, but cuts its corners by a share of what the straight line would.

Without a path the arm pursues a given target by visual feedback: a movement of at most one reach, a pause, the next
movement by the remaining error. The sag of the hand under the weight of a held object is thus corrected. The hand
closes on request, with its usual force or with all its strength. Where the arm has a range of motion, the intention
stays inside it, a box about the place where the hand took the handle.

Tremor is a force. The only output to the robot is the force of the grip on the handle.
"""

from __future__ import annotations

import math

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.maths.vec import copy, fill
from mimics_app.rendering.haptic.kernels.noise import gauss, uniform

__all__ = [
    "AIM_ERROR",
    "ARM_DAMPING",
    "ARM_LENGTH",
    "ARM_MASS",
    "ARM_STIFFNESS",
    "CORNER_CUTTING",
    "GENERATOR",
    "GRASP_MEAN",
    "GRASP_VARIATION",
    "GRIP_FORCE",
    "INTENT",
    "LEAST",
    "LIMITED",
    "MIRRORED",
    "MOST",
    "OPENING",
    "PATH",
    "PATH_POINTS",
    "PEAK_SPEED",
    "REACH",
    "REACTION",
    "STRENGTH",
    "TOLERANCE",
    "TREMOR",
    "TREMOR_HZ",
    "TREMOR_PHASE",
    "VIA_POINTS",
    "VIA_STEP",
    "min_jerk",
    "step_arm",
]


PATH_POINTS = 400  # capacity of the path

HAND = 0  # position 0:3 [m] and velocity 3:6 [m/s], robot frame
PLACED = 6  # 1 once the hand has taken the handle
GRIP_FORCE = 7  # on the handle 7:10 [N], robot frame
INTENDED = 10  # intended position 10:13 [m] and velocity 13:16 [m/s], robot frame
FROM = 16  # start 16:19 of the present movement [m]
TO = 19  # end 19:22 of the present movement [m]
ELAPSED = 22  # time in the movement and the pause after it [s]
DURATION = 23  # of the movement [s]
ACTING = 24  # 1 while the person acts
TRIAL = 25  # number of the present trial
INDEX = 26  # of the via point nearest to the hand at the start of the movement
TIME = 27  # since the person began to act, phase of the tremor [s]
GRASP_DRIFT = 28  # slow noise of the grasp force, standard deviation 1
ARM_MASS = 29  # [kg]
ARM_DAMPING = 30  # [N s/m]
ARM_STIFFNESS = 31  # [N/m]
PEAK_SPEED = 32  # of a movement [m/s]
REACH = 33  # mean length of a movement [m]
AIM_ERROR = 34  # standard deviation of the end of a movement of one reach, per axis [m]
REACTION = 35  # pause after a movement [s]
TREMOR = 36  # amplitude [N]
TREMOR_HZ = 37  # [Hz]
TREMOR_PHASE = 38  # per axis 38:41 [rad]
GRASP_MEAN = 41  # [N]
GRASP_VARIATION = 42  # standard deviation of the grasp force [N]
INTENT = 43  # 0: never acts
GENERATOR = 44  # state of the random generator
VIA_POINTS = 45  # number in use
VIA_STEP = 46  # arc length between via points [m]
FROM_INDEX = 47  # of the via point at the start of the movement
TO_INDEX = 48  # of the via point at its end
CORNER_CUTTING = 49  # 0: follows the path, 1: straight lines
START_VELOCITY = 50  # intended velocity 50:53 at the start of a movement to a target [m/s]
CLOSED = 53  # share of the closing time, 0 open, 1 closed
TOLERANCE = 54  # distance within which a target is reached [m]
AT_TARGET = 55  # 1 from reaching the target until it moves away
HOME = 56  # where the hand took the handle 56:59 [m]
LIMITED = 59  # 1: the arm has a range of motion
LEAST = 60  # range of motion from there 60:63 and 63:66 [m], robot frame
MOST = 63
STRENGTH = 66  # largest grasp force [N]
OPENING = 67  # time in which the hand opens [s]
EFFORT = 68  # of the newest closing: 1 usual, 2 all the strength
MIRRORED = 69  # 1: the mirror image of an arm, across the lateral axis
PATH = 70  # via points, three numbers each [m]
ARM_LENGTH = PATH + 3 * PATH_POINTS

_LATERAL = 1
"""Axis of the robot frame to the sides of the person."""

_GRIP_STIFFNESS = 4000.0
"""Stiffness of the grip on the handle [N/m]."""

_GRIP_DAMPING = 50.0
"""Damping of the grip on the handle [N s/m]."""

_RELAXED_DAMPING = 5.0
"""Damping of a relaxed arm [N s/m]."""

_SHORTEST_MOVEMENT = 0.25
"""Smallest duration of a movement [s]."""

_GRASP_TIME = 0.5
"""Time in which the hand closes [s]."""

_GRASP_DRIFT_TIME = 0.4
"""Time constant of the noise of the grasp force [s]."""

_SEARCH_BACK, _SEARCH_AHEAD = 20, 40
"""Range of the search for the nearest via point, before and after the last one [via points]."""

_PEAK_OF_MIN_JERK = 1.875
"""Peak over mean speed of a minimum-jerk movement [-]."""

_FULL_ERROR_LENGTH = 0.1
"""Smallest length of a movement to a target at which its end has the full aim error [m]."""

_RESTART_RATIO = 2.5
"""Distance of the target at which a hand at rest moves again [tolerances]."""

_SHORTEST_REACH, _REACH_SPREAD = 0.8, 0.4
"""Smallest length of a movement, and the range of its random addition [reaches]."""


@kernel
def min_jerk(share: float) -> float:
    """Minimum-jerk profile: covered share of the path at a share 0-1 of the duration; at rest at both ends."""
    u = min(1.0, max(0.0, share))
    return u * u * u * (10.0 + u * (-15.0 + 6.0 * u))


@kernel
def _sense(arm: Vec, axis: int) -> float:
    """Sense of random movements along an axis of the robot frame: the other one laterally in the mirror image."""
    return -1.0 if axis == _LATERAL and arm[MIRRORED] != 0.0 else 1.0


@kernel
def _nearest_via_point(arm: Vec) -> int:
    """Index of the via point nearest to the hand, searched around the last one: it keeps its branch of the path."""
    last = int(arm[INDEX])
    best = last
    best_square = math.inf
    for k in range(max(0, last - _SEARCH_BACK), min(int(arm[VIA_POINTS]), last + _SEARCH_AHEAD)):
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
    """Choose end and duration of the next movement along the path."""
    here = _nearest_via_point(arm)
    arm[INDEX] = here
    arm[FROM_INDEX] = here
    reach = arm[REACH] * (_SHORTEST_REACH + _REACH_SPREAD * uniform(arm, GENERATOR))
    there = min(int(arm[VIA_POINTS]) - 1, here + max(1, int(reach / arm[VIA_STEP])))
    arm[TO_INDEX] = there
    error = arm[AIM_ERROR] * min(1.0, (there - here) * arm[VIA_STEP] / arm[REACH])
    length = 0.0
    for i in range(3):
        arm[FROM + i] = arm[INTENDED + i]
        arm[TO + i] = arm[PATH + 3 * there + i] + _sense(arm, i) * error * gauss(arm, GENERATOR)
        length += (arm[TO + i] - arm[FROM + i]) ** 2
    arm[DURATION] = max(_SHORTEST_MOVEMENT, _PEAK_OF_MIN_JERK * math.sqrt(length) / arm[PEAK_SPEED])
    arm[ELAPSED] = 0.0


@kernel
def _begin(arm: Vec, target: Vec) -> None:
    """Start to act from the present position: at the beginning of the path, or towards the target with an open hand."""
    copy(arm[HAND : HAND + 3], arm[INTENDED : INTENDED + 3])
    arm[INDEX] = 0.0
    arm[TIME] = 0.0
    if arm[VIA_POINTS] > 1.0:
        _plan_movement(arm)
        return
    fill(arm[INTENDED + 3 : INTENDED + 6], 0.0)
    arm[CLOSED] = 0.0
    arm[AT_TARGET] = 0.0
    _aim(arm, target)


@kernel
def _within_range(arm: Vec, axis: int, intended: float) -> float:
    """Bring a coordinate of the intention [m] into the range of motion of the arm."""
    if arm[LIMITED] == 0.0:
        return intended
    home = arm[HOME + axis]
    return min(max(intended, home + arm[LEAST + axis]), home + arm[MOST + axis])


@kernel
def _follow_path(arm: Vec, dt: float) -> None:
    """Advance the intended movement along the path."""
    arm[ELAPSED] += dt
    if arm[ELAPSED] >= arm[DURATION] + arm[REACTION]:
        _plan_movement(arm)
    progress = min_jerk(arm[ELAPSED] / arm[DURATION])
    first = int(arm[FROM_INDEX])
    last = int(arm[TO_INDEX])
    place = first + progress * (last - first)
    below = min(int(place), int(arm[VIA_POINTS]) - 2)
    cut = arm[CORNER_CUTTING]
    for i in range(3):
        low = arm[PATH + 3 * below + i]
        along = low + (place - below) * (arm[PATH + 3 * below + 3 + i] - low)
        error_from = arm[FROM + i] - arm[PATH + 3 * first + i]
        error_to = arm[TO + i] - arm[PATH + 3 * last + i]
        curved = along + (1.0 - progress) * error_from + progress * error_to
        straight = arm[FROM + i] + progress * (arm[TO + i] - arm[FROM + i])
        intended = _within_range(arm, i, cut * straight + (1.0 - cut) * curved)
        arm[INTENDED + 3 + i] = (intended - arm[INTENDED + i]) / dt
        arm[INTENDED + i] = intended


@kernel
def _aim(arm: Vec, target: Vec) -> None:
    """Choose the next movement to a target: at most about one reach long, its error in proportion to its length."""
    missing = 0.0
    for i in range(3):
        missing += (target[i] - arm[HAND + i]) ** 2
    missing = math.sqrt(missing)
    tolerance = arm[TOLERANCE] * (_RESTART_RATIO if arm[AT_TARGET] != 0.0 else 1.0)
    arm[AT_TARGET] = 1.0 if missing <= tolerance else 0.0
    arm[ELAPSED] = 0.0
    share = 0.0
    error = 0.0
    if arm[AT_TARGET] == 0.0:
        reach = arm[REACH] * (_SHORTEST_REACH + _REACH_SPREAD * uniform(arm, GENERATOR))
        share = min(1.0, reach / missing)
        error = arm[AIM_ERROR] * min(1.0, share * missing / max(arm[REACH], _FULL_ERROR_LENGTH))
    length = 0.0
    for i in range(3):
        arm[FROM + i] = arm[INTENDED + i]
        arm[START_VELOCITY + i] = arm[INTENDED + 3 + i]
        step = share * (target[i] - arm[HAND + i]) + _sense(arm, i) * error * gauss(arm, GENERATOR)
        arm[TO + i] = arm[INTENDED + i] + step
        length += step * step
    arm[DURATION] = max(_SHORTEST_MOVEMENT, _PEAK_OF_MIN_JERK * math.sqrt(length) / arm[PEAK_SPEED])


@kernel
def _pursue(arm: Vec, target: Vec, dt: float) -> None:
    """Advance the intended movement to a target: minimum jerk from intended position and velocity at its start."""
    arm[ELAPSED] += dt
    if arm[ELAPSED] >= arm[DURATION] + arm[REACTION]:
        _aim(arm, target)
    u = min(1.0, arm[ELAPSED] / arm[DURATION])
    for i in range(3):
        span = arm[TO + i] - arm[FROM + i]
        begun = arm[START_VELOCITY + i] * arm[DURATION]
        curve = 10.0 * span - 6.0 * begun + u * (-15.0 * span + 8.0 * begun + u * (6.0 * span - 3.0 * begun))
        intended = _within_range(arm, i, arm[FROM + i] + u * (begun + u * u * curve))
        arm[INTENDED + 3 + i] = (intended - arm[INTENDED + i]) / dt
        arm[INTENDED + i] = intended


@kernel
def _grasp(arm: Vec, closed: float, strain: float, dt: float) -> float:
    """Grasp force [N] of a hand closed by a share 0-1 of the closing time: its mean with slow noise.

    With a strain of 0 the mean is the usual one, with 1 all the strength.
    """
    share = dt / _GRASP_DRIFT_TIME
    mean = arm[GRASP_MEAN]
    if strain > 0.0:
        mean += strain * (arm[STRENGTH] - mean)
    arm[GRASP_DRIFT] += -share * arm[GRASP_DRIFT] + math.sqrt(2.0 * share) * gauss(arm, GENERATOR)
    return max(0.0, min_jerk(closed) * (mean + arm[GRASP_VARIATION] * arm[GRASP_DRIFT]))


@kernel
def _act(arm: Vec, target: Vec, close: float, dt: float) -> float:
    """Advance the intention by a tick, along the path or to the target; return the grasp force [N]."""
    arm[TIME] += dt
    if arm[VIA_POINTS] > 1.0:
        _follow_path(arm, dt)
        return _grasp(arm, arm[TIME] / _GRASP_TIME, 0.0, dt)
    _pursue(arm, target, dt)
    if close > 0.0:
        arm[EFFORT] = min(2.0, max(1.0, close))
    change = dt / _GRASP_TIME if close > 0.0 else -dt / arm[OPENING]
    arm[CLOSED] = min(1.0, max(0.0, arm[CLOSED] + change))
    return _grasp(arm, arm[CLOSED], arm[EFFORT] - 1.0, dt)


@kernel
def step_arm(arm: Vec, handle: Vec, active: bool, trial: float, target: Vec, close: float, dt: float) -> float:
    """Advance the arm by one tick.

    Args:
        arm: Arm memory, shape [ARM_LENGTH]; the force on the handle is written to arm[GRIP_FORCE:GRIP_FORCE + 3].
        handle: Position [m] and velocity [m/s] of the handle, robot frame, shape [6].
        active: Whether the person may act; otherwise the relaxed arm follows the handle.
        trial: Number of the trial; a change restarts the path.
        target: Target of the hand for an arm without a path, robot frame [m].
        close: Above 0: the hand of such an arm closes, at 1 with its usual force, at 2 with all its strength.
        dt: Tick [s].

    Returns:
        Grasp force [N].
    """
    if arm[PLACED] == 0.0:
        arm[PLACED] = 1.0
        copy(handle[0:3], arm[HAND : HAND + 3])
        copy(handle[0:3], arm[HOME : HOME + 3])
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
            muscle = arm[ARM_STIFFNESS] * (arm[INTENDED + i] - x) + arm[ARM_DAMPING] * (arm[INTENDED + 3 + i] - v)
            shake = math.sin(2.0 * math.pi * arm[TREMOR_HZ] * arm[TIME] + arm[TREMOR_PHASE + i])
            muscle += _sense(arm, i) * arm[TREMOR] * shake
        v += dt * (muscle - pull) / arm[ARM_MASS]
        arm[HAND + 3 + i] = v
        arm[HAND + i] = x + dt * v
        arm[GRIP_FORCE + i] = pull
    return grasp
