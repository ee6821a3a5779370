"""An arm on the simulated robot under admittance control, along its vertical axis: simulated and exact.

The *rigid* arm is the textbook model, mass, damper and spring on the handle itself: F = -(m a + b v + k x). The
*gripping* arm is the simulated person of the product, behind a soft grip. With the rigid arm the command of a tick
takes effect one tick later (sensor, sum, send), with the gripping one in the order of the product's loop.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Mat, Vec
from mimics_app.contracts.loop.haptic import AdmittanceForm
from mimics_app.contracts.loop.loop_ports import DATA_FORCE, DATA_LENGTH, DATA_Q
from mimics_app.lab.stability.growth import dies_away, note_peak
from mimics_app.lab.stability.linear import is_contracting
from mimics_app.rendering.haptic.kernels import arm, robot
from mimics_app.rendering.haptic.kernels.admittance import VirtualMass, admit
from mimics_app.rendering.haptic.kernels.arm import step_arm
from mimics_app.rendering.haptic.kernels.robot import command_robot, place_handle, sense, step_robot

__all__ = ["Arm", "Hold", "exact_matrix", "is_exactly_stable", "is_stable"]


_RATE = 1000.0  # ticks per second [Hz]
_FREE = 1e12  # limit that is never reached
_AXIS = 2  # joint that moves: the vertical one
_APART = 1e-3  # first deviation [m]
_LARGE = 1e3  # deviation at which a run has diverged [m]
_SHORTEST = 8_000  # ticks of a run, at least
_LONGEST = 200_000  # and at most
_GRIP_STIFFNESS = 4000.0  # of the hand that holds the robot [N/m]
_GRIP_DAMPING = 50.0  # [N s/m]

_SPEED_SHARE = 0.1
"""Weight of the speed in the distance from rest [s]."""


@dataclass(frozen=True, slots=True)
class Arm:
    """Arm of a person: mass [kg], damping [N s/m], stiffness [N/m]."""

    mass: float
    damping: float
    stiffness: float


@dataclass(frozen=True, slots=True)
class Hold:
    """A loop: arm, bandwidth of the servo [Hz], delay of the command [ticks], virtual damping [N s/m], kind of arm."""

    arm: Arm
    servo_hz: float = 60.0
    delay: int = 0
    virtual_damping: float = 0.0
    gripping: bool = False


def _robot_memory(loop: Hold) -> Vec:
    """Return the memory of a robot without noise, quantisation and limits, so that the loop is linear."""
    memory = np.zeros(robot.ROBOT_LENGTH)
    memory[robot.TICK] = 1.0 / _RATE
    memory[robot.SERVO] = 2.0 * math.pi * loop.servo_hz
    memory[robot.DELAY] = loop.delay
    memory[robot.AXIS_OFFSET] = 1.0
    memory[robot.MASSES : robot.MASSES + 3] = 1.0
    memory[robot.JOINT_MIN : robot.JOINT_MIN + 3] = -_FREE
    memory[robot.JOINT_MAX : robot.JOINT_MAX + 3] = _FREE
    memory[robot.VELOCITY_LIMIT : robot.VELOCITY_LIMIT + 3] = _FREE
    memory[robot.DRIVE_FORCE] = _FREE
    memory[robot.SENSOR_GAIN] = 1.0
    memory[robot.NOISE] = 1.0
    return memory


def _arm_memory(hand: Arm) -> Vec:
    """Return the memory of a person who holds a position: a path of two equal points, no tremor, no error of aim."""
    memory = np.zeros(arm.ARM_LENGTH)
    memory[arm.ARM_MASS] = hand.mass
    memory[arm.ARM_DAMPING] = hand.damping
    memory[arm.ARM_STIFFNESS] = hand.stiffness
    memory[arm.INTENT] = 1.0
    memory[arm.PEAK_SPEED] = 1.0
    memory[arm.REACH] = 1.0
    memory[arm.VIA_POINTS] = 2.0
    memory[arm.VIA_STEP] = 1.0
    memory[arm.GENERATOR] = 1.0
    return memory


@kernel
def _next_command(machine: Vec) -> float:
    """Return the command of the vertical axis that acts in this tick [m/s]."""
    due = int(machine[robot.WRITTEN]) - 1 - int(machine[robot.DELAY])
    return machine[robot.LINE + 3 * (due % (robot.MAX_DELAY + 1)) + _AXIS] if due >= 0 else 0.0


@kernel
def _rigid_force(machine: Vec, hand: Vec) -> float:
    """Return the force of a rigid arm (mass, damping, stiffness) on the handle [N]."""
    v = machine[robot.DQ + _AXIS]
    a = machine[robot.SERVO] * (_next_command(machine) - v)
    return -(hand[0] * a + hand[1] * v + hand[2] * machine[robot.Q + _AXIS])


@kernel
def _hold_rigidly(machine: Vec, hand: Vec, mass: float, damping: float, ticks: int, peaks: Vec) -> None:
    """Simulate the rigid arm; peaks of the handle's distance from rest by quarter, shape [4]."""
    dt, virtual = machine[robot.TICK], VirtualMass(mass, damping, _FREE, _FREE)
    scratch, v, dq, f, data = np.zeros(3), np.zeros(3), np.zeros(3), np.zeros(3), np.zeros(DATA_LENGTH)
    machine[robot.Q + _AXIS] = _APART
    for i in range(ticks):
        f[_AXIS] = _rigid_force(machine, hand)
        sense(machine, f, data)
        q, force = data[DATA_Q : DATA_Q + 3], data[DATA_FORCE : DATA_FORCE + 3]
        admit(AdmittanceForm.CARTESIAN, q, force, virtual, 1.0, dt, scratch, v, dq)
        step_robot(machine)
        command_robot(machine, dq)
        size = max(abs(machine[robot.Q + _AXIS]), _SPEED_SHARE * abs(v[_AXIS]))
        if note_peak(size, i, ticks, _LARGE, peaks):
            return


@kernel
def _hold_softly(machine: Vec, person: Vec, mass: float, damping: float, ticks: int, peaks: Vec) -> None:
    """Simulate the gripping arm; peaks of the handle's distance from rest by quarter, shape [4]."""
    dt, virtual = machine[robot.TICK], VirtualMass(mass, damping, _FREE, _FREE)
    scratch, v, dq, data = np.zeros(3), np.zeros(3), np.zeros(3), np.zeros(DATA_LENGTH)
    place_handle(machine)
    step_arm(person, machine[robot.HANDLE : robot.HANDLE + 6], True, 0.0, scratch, 0.0, dt)
    machine[robot.Q + _AXIS] = _APART
    place_handle(machine)
    for i in range(ticks):
        if i > 0:
            step_robot(machine)
        step_arm(person, machine[robot.HANDLE : robot.HANDLE + 6], True, 0.0, scratch, 0.0, dt)
        sense(machine, person[arm.GRIP_FORCE : arm.GRIP_FORCE + 3], data)
        q, force = data[DATA_Q : DATA_Q + 3], data[DATA_FORCE : DATA_FORCE + 3]
        admit(AdmittanceForm.CARTESIAN, q, force, virtual, 1.0, dt, scratch, v, dq)
        command_robot(machine, dq)
        size = max(abs(machine[robot.Q + _AXIS]), _SPEED_SHARE * abs(v[_AXIS]))
        if note_peak(size, i, ticks, _LARGE, peaks):
            return


def is_stable(loop: Hold, mass: float) -> bool:
    """Whether a virtual mass [kg] is stable, by simulation with the product's controller, robot and person."""

    def run(ticks: int) -> Vec:
        peaks = np.zeros(4)
        machine = _robot_memory(loop)
        if loop.gripping:
            _hold_softly(machine, _arm_memory(loop.arm), mass, loop.virtual_damping, ticks, peaks)
        else:
            hand = np.array([loop.arm.mass, loop.arm.damping, loop.arm.stiffness])
            _hold_rigidly(machine, hand, mass, loop.virtual_damping, ticks, peaks)
        return peaks

    return dies_away(run, _SHORTEST, _LONGEST)


def _servo(loop: Hold) -> tuple[Mat, Mat]:
    """Return one tick of handle position and velocity under a held velocity command, as in the simulated robot.

    The velocity is an exact first-order lag; the position integrates it by the trapezoidal rule, a delay of 0.03 ticks
    at 60 Hz.
    """
    dt = 1.0 / _RATE
    share = 1.0 - math.exp(-2.0 * math.pi * loop.servo_hz * dt)
    step = np.array([[1.0, dt * (1.0 - 0.5 * share)], [0.0, 1.0 - share]])
    return step, np.array([[0.5 * dt * share], [share]])


def _rigid_matrix(loop: Hold, mass: float) -> Mat:
    """Return the matrix of handle x, v, and the delayed virtual velocities, newest last, shape [3 + n, 3 + n]."""
    n, dt = loop.delay, 1.0 / _RATE
    wp = 2.0 * math.pi * loop.servo_hz
    A, held = _servo(loop)
    size = 3 + n
    step = np.zeros((size, size))
    step[:2, :2] = A
    step[:2, 2] = held[:, 0]
    for i in range(2, size - 1):
        step[i, i + 1] = 1.0
    force = np.zeros(size)
    force[0] = -loop.arm.stiffness
    force[1] = loop.arm.mass * wp - loop.arm.damping
    force[2] = -loop.arm.mass * wp
    step[-1, -1] = 1.0 - dt * loop.virtual_damping / mass
    step[-1] += dt / mass * force
    return step


def _gripping_matrix(loop: Hold, mass: float) -> Mat:
    """Return the matrix of handle x, v, hand x, v, delayed virtual velocities, newest last, shape [5 + n, 5 + n]."""
    n, dt = loop.delay, 1.0 / _RATE
    A, held = _servo(loop)
    size = 5 + n
    moved = np.eye(size)
    moved[:2, :2] = A
    moved[:2, 4] = held[:, 0]
    # Hand: semi-implicit Euler under muscle and grip, at the present position of the handle.
    grip = np.zeros(size)
    grip[0], grip[1], grip[2], grip[3] = -_GRIP_STIFFNESS, -_GRIP_DAMPING, _GRIP_STIFFNESS, _GRIP_DAMPING
    pulled = np.eye(size)
    pulled[3] -= dt / loop.arm.mass * grip
    pulled[3, 2] -= dt / loop.arm.mass * loop.arm.stiffness
    pulled[3, 3] -= dt / loop.arm.mass * loop.arm.damping
    pulled[2] += dt * pulled[3]
    # The controller takes the force of the grip before the hand moves.
    controlled = np.eye(size)
    for i in range(4, size - 1):
        controlled[i] = np.eye(size)[i + 1]
    controlled[-1, -1] = 1.0 - dt * loop.virtual_damping / mass
    moving = controlled @ pulled
    moving[-1] += dt / mass * grip
    return moving @ moved


def exact_matrix(loop: Hold, mass: float) -> Mat:
    """Return one tick of the loop as a matrix, for a virtual mass [kg]."""
    return _gripping_matrix(loop, mass) if loop.gripping else _rigid_matrix(loop, mass)


def is_exactly_stable(loop: Hold, mass: float) -> bool:
    """Whether a virtual mass [kg] is stable, by eigenvalues."""
    return is_contracting(exact_matrix(loop, mass))
