"""Exact stability of a leg of the gait orthosis with its foot on a wall, for S18: eigenvalues of one tick.

Leg, rods and spindles are written here once more, from the geometry of their sketch, as x' = f(x, u) with currents and
the person's torques held over a tick. They are linearised by central differences about the pose of rest, and so is the
law of the control; sensors, velocity filter, current lag and delay line are states of the tick. Nothing here uses the
code of the loop; `Leg` are numbers.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mimics_app.contracts.arrays import Mat, Vec
from mimics_app.lab.stability.linear import hold

__all__ = [
    "Leg",
    "Press",
    "combined_loop",
    "impedance_loop",
    "is_stable_but_for_a_neutral_way",
    "leader_of_press",
    "object_stiffness",
    "rest_in_combined",
    "rest_in_impedance",
]

_GRAVITY = 9.81
_FILTER_HZ, _CURRENT_LAG = 60.0, 5e-4
_STEP = 1e-6
"""Of the central differences [rad, m, ...]."""

_NEUTRAL = 1e-3
"""Distance from 1 of the eigenvalue of a foot that nothing holds along the wall, and error of the differences."""

_NEWTON = 6
"""Steps of Newton's method to a pose."""


@dataclass(frozen=True, slots=True)
class Leg:
    """Numbers of one leg; arrays are of hip and knee, or of thigh and shank.

    Attributes:
        lengths: Thigh, knee to sole, and sole's point of contact before the ankle [m].
        masses: Of person and orthosis together [kg].
        coms: Below the upper joint [m].
        inertias: About the centres of mass [kg m^2].
        worn: Share of `masses` and `inertias` that is the orthosis [-].
        fixed, moved, offset: Arms of the linkages [m] and the angle between them in standing [rad].
        spindle: Mass of motor and spindle [kg].
        viscous: Its friction [N s/m].
        rod: Stiffness [N/m] and damping [N s/m] of the rods, each shape [2].
        bearing: Damping of a joint [N m s/rad].
        person: Damping of the person's joint [N m s/rad].
    """

    lengths: Vec
    masses: Vec
    coms: Vec
    inertias: Vec
    worn: Vec
    fixed: Vec
    moved: Vec
    offset: Vec
    spindle: Vec
    viscous: Vec
    rod: Mat
    bearing: float
    person: float

    def foot(self, q: Vec) -> Vec:
        """Place of the foot, forward and up [m]."""
        psi = q[0] - q[1]
        along, down = np.array([math.cos(psi), math.sin(psi)]), np.array([math.sin(psi), -math.cos(psi)])
        thigh = self.lengths[0] * np.array([math.sin(q[0]), -math.cos(q[0])])
        return np.asarray(thigh + self.lengths[1] * down + self.lengths[2] * along)

    def jacobian(self, q: Vec) -> Mat:
        """Its derivatives by the joints [m/rad], shape [2, 2]: each turns what lies below it."""
        x, z = self.foot(q)
        thigh = self.lengths[0] * np.array([math.sin(q[0]), -math.cos(q[0])])
        return np.array([[-z, z - thigh[1]], [x, thigh[0] - x]])

    def eta(self, q: Vec) -> Vec:
        """Shaft lengths [m]: both shorten where the joint flexes."""
        turned = self.offset - q
        return np.asarray(np.hypot(self.fixed - self.moved * np.cos(turned), self.moved * np.sin(turned)))

    def arms(self, q: Vec) -> Vec:
        """Levers d eta / d q [m/rad]."""
        return np.asarray(-self.fixed * self.moved * np.sin(self.offset - q) / self.eta(q))

    def weight(self, q: Vec, share: Vec) -> Vec:
        """Torques of gravity [N m] of a share of each segment's mass."""
        m1, m2 = share * self.masses
        knee = _GRAVITY * m2 * self.coms[1] * math.sin(q[0] - q[1])
        hip = _GRAVITY * (m1 * self.coms[0] + m2 * self.lengths[0]) * math.sin(q[0])
        return np.array([hip + knee, -knee])

    def mass(self, q: Vec) -> Mat:
        """Mass matrix of the joints, without motors [kg m^2]."""
        (m1, m2), (c1, c2), (i1, i2), a = self.masses, self.coms, self.inertias, self.lengths[0]
        shank, both = i2 + m2 * c2 * c2, m2 * a * c2 * math.cos(q[1])
        return np.array([[i1 + m1 * c1 * c1 + m2 * a * a + shank + 2.0 * both, -shank - both], [-shank - both, shank]])


@dataclass(frozen=True, slots=True)
class Press:
    """The press of a foot on a vertical wall, and the numbers of its control.

    Attributes:
        rate: Ticks per second [Hz].
        force: Of the person on the wall [N].
        pose: Joints of a foot at its border [rad].
        delay: Ticks between the command and the torque.
        damping: lam of the wall under impedance control [N s/m^2].
        compensation: Share of the viscous friction that impedance control compensates.
        virtual_mass, virtual_damping: Of the shafts under combined control [kg, N s/m].
        anchor: Stiffness of friction along the wall there [N/m].
    """

    rate: float
    force: float = 60.0
    pose: tuple[float, float] = (0.45, 0.75)
    delay: int = 1
    damping: float = 3000.0
    compensation: float = 0.95
    virtual_mass: tuple[float, float] = (500.0, 150.0)
    virtual_damping: tuple[float, float] = (60.0, 60.0)
    anchor: float = 2e4


Law = Callable[[Vec, Vec, Vec], Vec]


def _slopes(f: Callable[[Vec], Vec], at: Vec) -> Mat:
    """Central differences of a vector function, shape [outputs, inputs]."""
    columns = []
    for i in range(len(at)):
        step = np.zeros(len(at))
        step[i] = _STEP
        columns.append((f(at + step) - f(at - step)) / (2.0 * _STEP))
    return np.array(columns).T


def _motion(leg: Leg, x: Vec, u: Vec) -> Vec:
    """Rates of angles, speeds, spindles and their speeds under motor forces [N] and torques of the person [N m]."""
    q, dq, eta, rate = x[0:2], x[2:4], x[4:6], x[6:8]
    arms = leg.arms(q)
    rod = leg.rod[0] * (eta - leg.eta(q)) + leg.rod[1] * (rate - arms * dq)
    tau = arms * rod + u[2:4] - leg.bearing * dq - leg.weight(q, np.ones(2))
    return np.concatenate(
        [dq, np.linalg.solve(leg.mass(q), tau), rate, (u[0:2] - leg.viscous * rate - rod) / leg.spindle]
    )


def _rest(leg: Leg, q: Vec, tau: Vec) -> tuple[Vec, Vec]:
    """State [8] and motor forces [2] of a leg at rest under joint torques of its drives."""
    rod = tau / leg.arms(q)
    return np.concatenate([q, np.zeros(2), leg.eta(q) + rod / leg.rod[0], np.zeros(2)]), rod


def _tick(leg: Leg, press: Press, q: Vec, tau: Vec, law: Law, own: Law, extra: int) -> Mat:
    """Return one tick of the whole loop as a matrix.

    Args:
        leg: The leg.
        press: The press.
        q: Pose of rest [rad].
        tau: Torques of the drives at rest [N m].
        law: Torques of the control from the state of the plant [8], filtered speeds [2] and advanced own states.
        own: Own states of the control after a tick, from the same with its states before.
        extra: Number of those.
    """
    dt, n = 1.0 / press.rate, press.delay
    x0, motor0 = _rest(leg, q, tau)
    person0 = leg.weight(q, 1.0 - leg.worn) + leg.jacobian(q)[0] * press.force

    def plant(x: Vec) -> Vec:
        return _motion(leg, x, np.concatenate([motor0, person0]))

    B = np.zeros((8, 4))
    B[6:8, 0:2], B[2:4, 2:4] = np.diag(1.0 / leg.spindle), np.linalg.inv(leg.mass(q))
    A, held = hold(_slopes(plant, x0), B, dt)

    def person(angles: Vec) -> Vec:
        return leg.weight(angles, 1.0 - leg.worn) + leg.jacobian(angles)[0] * press.force

    # z: plant 8, last angles 2, filtered speeds 2, motor forces 2, own states, 2 (n + 1) commands, newest first
    size = 14 + extra + 2 * (n + 1)
    blend = 1.0 - math.exp(-2.0 * math.pi * _FILTER_HZ * dt)
    lag = 1.0 - math.exp(-dt / _CURRENT_LAG)
    rest = np.zeros(size)
    rest[:8], rest[8:10], rest[12:14] = x0, q, motor0
    rest[14 + extra :] = np.tile(tau, n + 1)

    def step(z: Vec) -> Vec:
        after = np.zeros(size)
        due = z[14 + extra + 2 * n :]
        after[12:14] = z[12:14] + lag * (due / leg.arms(z[8:10]) - z[12:14])
        u = np.concatenate([after[12:14] - motor0, person(z[8:10]) - leg.person * z[2:4] - person0])
        after[:8] = x0 + A @ (z[:8] - x0) + held @ u
        after[8:10] = after[0:2]
        after[10:12] = z[10:12] + blend * ((after[0:2] - z[8:10]) / dt - z[10:12])
        after[14 : 14 + extra] = own(after[:8], after[10:12], z[14 : 14 + extra])
        after[14 + extra : 16 + extra] = law(after[:8], after[10:12], after[14 : 14 + extra])
        after[16 + extra :] = z[14 + extra : -2]
        return after

    return _slopes(step, rest)


def rest_in_impedance(leg: Leg, press: Press, stiffness: float) -> tuple[Vec, Vec]:
    """Return pose [rad] and torques [N m] at rest: the foot is `force / stiffness` deep, at the height of the pose."""
    goal = leg.foot(np.array(press.pose)) + [press.force / stiffness, 0.0]
    q = np.array(press.pose)
    for _ in range(_NEWTON):
        q = q - np.linalg.solve(leg.jacobian(q), leg.foot(q) - goal)
    return q, leg.weight(q, leg.worn) - leg.jacobian(q)[0] * press.force


def impedance_loop(leg: Leg, press: Press, stiffness: float) -> Mat:
    """Return one tick of the foot on a wall of a stiffness [N/m] under impedance control."""
    q, tau = rest_in_impedance(leg, press, stiffness)
    wall = leg.foot(np.array(press.pose))[0]

    def law(x: Vec, speed: Vec, _own: Vec) -> Vec:
        row, depth = leg.jacobian(x[:2])[0], leg.foot(x[:2])[0] - wall
        push = stiffness * depth + press.damping * depth * float(row @ speed)
        carried = leg.weight(x[:2], leg.worn)
        return np.asarray(carried + press.compensation * leg.arms(x[:2]) ** 2 * leg.viscous * speed - row * push)

    return _tick(leg, press, q, tau, law, lambda _x, _s, own: own, 0)


@dataclass(frozen=True, slots=True)
class _Virtual:
    """The virtual leg of combined control on the wall; its leader is the shaft that moves the foot less along it."""

    leg: Leg
    press: Press
    leader: int

    def angles(self, eta: float) -> Vec:
        """Joints [rad] with the foot on the border, at a shaft length of the leader [m]."""
        leg, i = self.leg, self.leader
        wall, q = leg.foot(np.array(self.press.pose))[0], np.array(self.press.pose)
        for _ in range(_NEWTON):
            off = np.array([leg.eta(q)[i] - eta, leg.foot(q)[0] - wall])
            rows = np.array([leg.arms(q) * (np.arange(2) == i), leg.jacobian(q)[0]])
            q = q - np.linalg.solve(rows, off)
        return np.asarray(q)

    def slopes(self, theta: Vec) -> Vec:
        """Rates of both shafts per rate of the leader."""
        by_eta = self.leg.jacobian(theta)[0] / self.leg.arms(theta)
        found = np.ones(2)
        found[1 - self.leader] = -by_eta[self.leader] / by_eta[1 - self.leader]
        return found

    def path(self, theta: Vec) -> float:
        """Way of the foot downwards along the wall per length of the leader."""
        up = self.leg.jacobian(theta)[1] / self.leg.arms(theta)
        return float(up @ self.slopes(theta))


def _virtual(leg: Leg, press: Press) -> _Virtual:
    pose = np.array(press.pose)
    by_eta = np.abs(leg.jacobian(pose)[0] / leg.arms(pose))
    return _Virtual(leg, press, 0 if by_eta[1] >= by_eta[0] else 1)


def leader_of_press(leg: Leg, press: Press) -> int:
    """Return the shaft that moves freely on the wall, 0 hip, 1 knee."""
    return _virtual(leg, press).leader


def _servo(leg: Leg, q: Vec, bandwidth: float) -> Mat:
    return np.asarray(bandwidth**2 * (leg.mass(q) + np.diag(leg.spindle * leg.arms(q) ** 2)))


def rest_in_combined(leg: Leg, press: Press, bandwidth: float) -> tuple[Vec, Vec, float]:
    """Return pose [rad], torques [N m], and friction along the wall [N] at rest, the virtual foot at the pose."""
    wish = q = np.array(press.pose)
    for _ in range(60):
        q = wish + np.linalg.solve(_servo(leg, q, bandwidth), leg.jacobian(q)[0] * press.force)
    virtual = _virtual(leg, press)
    pushed = leg.jacobian(q)[0] * press.force / leg.arms(q)
    drag = -float(pushed @ virtual.slopes(wish)) / virtual.path(wish)
    return q, leg.weight(q, leg.worn) - leg.jacobian(q)[0] * press.force, drag


def combined_loop(leg: Leg, press: Press, bandwidth: float) -> Mat:
    """Return one tick of the foot on a rigid wall under combined control, by the bandwidth of its servo [rad/s]."""
    q, tau, drag = rest_in_combined(leg, press, bandwidth)
    virtual, dt = _virtual(leg, press), 1.0 / press.rate
    start = float(leg.eta(np.array(press.pose))[virtual.leader])
    mass, damping = np.array(press.virtual_mass), np.array(press.virtual_damping)

    def own(x: Vec, _speed: Vec, before: Vec) -> Vec:
        eta, rate, way = before
        rod = leg.rod[0] * (x[4:6] - leg.eta(x[:2])) + leg.rod[1] * (x[6:8] - leg.arms(x[:2]) * x[2:4])
        force = leg.weight(x[:2], leg.worn) / leg.arms(x[:2]) - rod
        theta = virtual.angles(start + eta)
        slopes, path = virtual.slopes(theta), virtual.path(theta)
        way += path * rate * dt
        push = float(slopes @ (force - damping * slopes * rate)) + (drag - press.anchor * way) * path
        change = push / float(mass @ slopes**2)
        return np.array([eta + dt * rate + 0.5 * dt * dt * change, rate + dt * change, way])

    def law(x: Vec, speed: Vec, after: Vec) -> Vec:
        theta = virtual.angles(start + after[0])
        wish_rate = virtual.slopes(theta) * after[1] / leg.arms(theta)
        error = theta - x[:2] + 2.0 / bandwidth * (wish_rate - speed)
        return np.asarray(_servo(leg, x[:2], bandwidth) @ error + leg.weight(x[:2], leg.worn))

    return _tick(leg, press, q, tau, law, own, 3)


def object_stiffness(leg: Leg, press: Press, bandwidth: float) -> float:
    """Return the stiffness K_x = (J K_theta^-1 J^T)^-1 [N/m] of a rigid wall, by the bandwidth [rad/s]."""
    q = np.array(press.pose)
    row = leg.jacobian(q)[0]
    return float(1.0 / (row @ np.linalg.solve(_servo(leg, q, bandwidth), row)))


def is_stable_but_for_a_neutral_way(step: Mat) -> bool:
    """Whether a tick is stable; the foot may stand anywhere along a wall without friction: an eigenvalue of 1."""
    values = np.linalg.eigvals(step)
    neutral = (np.abs(values - 1.0) < _NEUTRAL) & (values.imag == 0.0)
    return bool(np.abs(values[~neutral]).max() < 1.0)
