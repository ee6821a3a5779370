"""S4: how stiff a wall may be before the steps of the encoder feed it, against 2 f_c / Delta.

A hand moves in and out across steps of the encoder in step with the ticks: out while the force is the one of the
deeper step, in while it is the one of the shallower. Over j steps of Delta that draws K j Delta per length of path, and
friction and damping of the device take 2 f_c + 2 b (j - 1) Delta / T. The worst j is 1 or very many, so that no motion
draws energy iff K <= min(2 b / T, 2 f_c / Delta) (Abbott & Okamura 2005, Diolaiti et al. 2006). Simulated: all such
motions, with the wall's law, the robot's own sensors and the passivity observer. A mass left to itself on the wall
must then come to rest from everywhere; beyond, it may swing for ever.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.loop_ports import DATA_LENGTH, DATA_Q
from mimics_app.lab.experiment import Experiment, Outcome, Row, curves_of
from mimics_app.lab.stability.linear import find_limit
from mimics_app.rendering.haptic.kernels import robot
from mimics_app.rendering.haptic.kernels.contact_law import spring_damper
from mimics_app.rendering.haptic.kernels.passivity import OBSERVER, observe
from mimics_app.rendering.haptic.kernels.robot import sense

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import ObserverRecord

__all__ = ["EXPERIMENT", "Device", "closed_limit", "largest_swing", "simulated_limit"]


_DT = 1e-3
_MASS = 0.5
_AXIS = 2
_SUBSTEPS = 20
_TICKS = 12_000
_SLIVER = 1e-5
"""How far beyond a step of the encoder a motion turns, as a share of the step."""

_MOST_STEPS = 100_000
_INSIDE = 0.95
_BEYOND = 20.0
_PRECISION = 1e-3
_NEGLIGIBLE = 1e-6
"""A swing of this share of an encoder step is rest."""

_CYCLE = 4
"""Ticks: twice to and fro, the second time with all that the first left behind."""

_EXTRAS, _BEFORES = (_SLIVER, 0.3, 0.9), (0.5 * _SLIVER, 0.2, 0.5)
"""Shares of an encoder's step by which a motion goes beyond whole steps, and before which it begins."""

_IN_THE_WALL = 10.5
"""Where it begins, in steps of the encoder."""

_COARSER = 1.15
"""Ratio of the numbers of steps that are tried one after the other."""

_QUARTERS = 4
"""Of a run."""


@dataclass(frozen=True, slots=True)
class Device:
    """An impedance device: its encoder's step [m], its Coulomb friction [N] and its damping [N s/m]."""

    quantum: float
    friction: float
    damping: float = 1.0


def _robot_memory(quantum: float) -> Vec:
    """Memory of a robot that has sensors only; its vertical axis shows positions in steps of `quantum` [m]."""
    memory = np.zeros(robot.ROBOT_LENGTH)
    memory[robot.TICK] = _DT
    memory[robot.ENCODER + _AXIS] = quantum
    memory[robot.NOISE] = 1.0
    memory[robot.SENSOR_GAIN] = 1.0
    memory[robot.DRIVE_FORCE] = 1.0
    memory[robot.AXIS_OFFSET] = 1.0
    return memory


@kernel
def _wall_force(x: float, k: float, memory: Vec, still: Vec, data: Vec) -> float:
    """Force [N] of a wall of stiffness k at a depth x as the sensors show it."""
    memory[robot.Q + _AXIS] = x
    sense(memory, still, data)
    return spring_damper(data[DATA_Q + _AXIS], 0.0, k, 0.0)


@kernel
def _work_of_cycle(near: float, far: float, k: float, memory: Vec, data: Vec, observer: ObserverRecord) -> float:
    """Energy [J] the wall takes while a hand goes from depth `near` to `far` in one tick and back in the next."""
    still = np.zeros(3)
    position = np.zeros(3)
    push = np.zeros(3)
    start = 0.0
    energy = 0.0
    for i in range(_CYCLE):
        x = near if i % 2 == 0 else far
        position[_AXIS] = -x
        push[_AXIS] = _wall_force(x, k, memory, still, data)
        energy = observe(observer, position, push)
        if i == 1:
            start = energy
    return energy - start


@kernel
def _is_passive(
    k: float, quantum: float, friction: float, damping: float, memory: Vec, observer: ObserverRecord
) -> bool:
    """Whether no motion over 1 to _MOST_STEPS steps of the encoder draws energy from wall and device together."""
    data = np.zeros(DATA_LENGTH)
    steps = 1
    while steps <= _MOST_STEPS:
        for extra in _EXTRAS:
            stroke = (steps - 1 + extra) * quantum
            for before in _BEFORES:
                near = (_IN_THE_WALL - min(before, 0.5 * extra)) * quantum
                taken = _work_of_cycle(near, near + stroke, k, memory, data, observer)
                if taken + 2.0 * stroke * (friction + damping * stroke / _DT) < 0.0:
                    return False
        steps = max(steps + 1, int(_COARSER * steps))
    return True


def simulated_limit(device: Device) -> float:
    """Stiffest wall [N/m] from which no motion draws energy, by simulation."""
    memory = _robot_memory(device.quantum)

    def is_passive(stiffness: float) -> bool:
        observer = np.zeros(1, OBSERVER)[0]
        return bool(_is_passive(stiffness, device.quantum, device.friction, device.damping, memory, observer))

    return find_limit(is_passive, 1e-3, 1e9, _PRECISION)


def closed_limit(device: Device) -> float:
    """The same in closed form: min(2 b / T, 2 f_c / Delta)."""
    return min(2.0 * device.damping / _DT, 2.0 * device.friction / device.quantum)


@kernel
def _slide(v: float, load: float, friction: float, damping: float, h: float) -> float:
    """Velocity of the device after h: Coulomb friction that holds and never reverses a motion, and damping."""
    if v == 0.0 and abs(load) <= friction:
        return 0.0
    direction = v if v != 0.0 else load
    drag = friction if direction > 0.0 else -friction
    moved = v + h * (load - drag - damping * v) / _MASS
    return 0.0 if moved * direction < 0.0 else moved


@kernel
def _swing(k: float, friction: float, damping: float, push: float, x: float, v: float, memory: Vec) -> float:
    """Range [m] of the last quarter of a run of a mass under a push against the wall."""
    data = np.zeros(DATA_LENGTH)
    still = np.zeros(3)
    lowest = np.inf
    highest = -np.inf
    h = _DT / _SUBSTEPS
    for i in range(_TICKS):
        load = push - _wall_force(x, k, memory, still, data)
        for _ in range(_SUBSTEPS):
            v = _slide(v, load, friction, damping, h)
            x += h * v
        if _QUARTERS * i >= 3 * _TICKS:
            lowest = min(lowest, x)
            highest = max(highest, x)
    return highest - lowest


def largest_swing(device: Device, stiffness: float) -> float:
    """Largest lasting swing [m] of a mass left to itself on a wall [N/m], over several starts."""
    memory = _robot_memory(device.quantum)
    starts = [(0.37 * device.quantum, 0.0), (30.3 * device.quantum, 0.0), (0.0, 0.02)]
    swings = [
        _swing(stiffness, device.friction, device.damping, 1.0, 1.0 / stiffness + x, v, memory) for x, v in starts
    ]
    return float(max(swings))


def _row(device: Device) -> Row:
    simulated, exact = simulated_limit(device), closed_limit(device)
    return {
        "quantum_m": device.quantum,
        "friction_n": device.friction,
        "damping_ns_m": device.damping,
        "simulated_n_m": simulated,
        "exact_n_m": exact,
        "swing_inside_quanta": largest_swing(device, _INSIDE * exact) / device.quantum,
        "swing_beyond_quanta": largest_swing(device, _BEYOND * exact) / device.quantum,
        "difference": abs(simulated / exact - 1.0),
    }


def _simulate_grid(points: int) -> Outcome:
    quanta = [float(quantum) for quantum in np.geomspace(2e-6, 5e-4, points)]
    rows = [_row(Device(quantum, friction)) for friction in (0.01, 0.05, 0.25) for quantum in quanta]
    rests = all(row["swing_inside_quanta"] < _NEGLIGIBLE for row in rows)
    return Outcome(
        rows,
        *curves_of(rows, "quantum_m", "simulated_n_m", "exact_n_m"),
        rules={"2 b/T, b = 1 N s/m": [(quanta[0], 2e3), (quanta[-1], 2e3)]},
        holds=rests,
        note="Friction of 0.01, 0.05 and 0.25 N (lowest to highest curve). A coarse encoder limits the wall by "
        f"2 f_c/Delta, a fine one by 2 b/T; at {_INSIDE:.0%} of the limit a mass of {_MASS:g} kg comes to rest from "
        "every start.",
    )


EXPERIMENT = Experiment(
    title="Quantised position: stiffest passive wall",
    claim="No motion draws energy from a sampled, quantised wall iff K <= min(2 b / T, 2 f_c / Delta).",
    x_label="step of the encoder [m]",
    y_label="stiffest passive wall [N/m]",
    kind="boundary",
    simulate=_simulate_grid,
    log_x=True,
    log_y=True,
)
