"""A leg in the simulated orthosis that is led along the reference walk, by a position controller or by guidance.

The device is the plug-in of the loop, the walk that of `joint_reference` at 1.4 km/h. The person in it bears the
own leg, and does nothing else, or walks the same path, but late.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8, Mat, Vec
from mimics_app.contracts.loop.loop_ports import (
    COMMAND_ENABLED,
    COMMAND_LENGTH,
    COMMAND_TORQUE,
    DATA_DQ,
    DATA_LENGTH,
    DATA_Q,
    DATA_TORQUE,
    INBOX_LENGTH,
)
from mimics_app.lab.haptic.lokomat_rig import IMPEDANCE, LegControl, Person, Rig
from mimics_app.lab.probe import shortest_us
from mimics_app.maths.gait_series import knee_series, natural_cadence, series_at, step_of, thigh_series
from mimics_app.rendering.haptic.control.lokomat.guidance_force import guide_joints
from mimics_app.rendering.haptic.control.lokomat.leg_control import LEG_INPUT, LEG_STATE, control_impedance
from mimics_app.rendering.haptic.control.lokomat.position_control import position_torques
from mimics_app.rendering.haptic.devices.simulated_lokomat import read_lokomat, write_lokomat
from mimics_app.rendering.haptic.kernels.lokomat import orthosis
from mimics_app.rendering.haptic.kernels.two_link import weight

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import LegInputRecord, LegSettingsRecord, LegStateRecord

__all__ = ["Led", "Leg"]

_LATE = 0.05
"""Share of the cycle by which a late person is late."""

_GUIDED = {"stiffness": 150.0, "damping": 30.0}
"""Guidance of the controllers' defaults [N m/rad, N m s/rad]."""

_SPEED, _HEIGHT = 1.4 / 3.6, 1.75
_DT = 1e-3
_CYCLES, _CALLS = 3, 20_000
_STEP = 1e-9
"""Motion between two calls that are timed [rad]."""
_PERSON_STIFFNESS, _PERSON_DAMPING = 400.0, 12.0
"""With which a person draws the own leg along the path [N m/rad, N m s/rad]."""


@dataclass(frozen=True, slots=True)
class Led:
    """A walk that was led, after its first cycle.

    Attributes:
        away: Root mean square of hip and knee from the reference [rad].
        torque: Root mean square of the torques of the drives that the guidance asks for, hip and knee [N m].
    """

    away: float
    torque: float


@kernel
def _lead(
    memory: Vec,
    ports: tuple[Vec, Vec, Vec],
    servo: bool,
    control: LegControl,
    links: Vec,
    walk: F8,
    persons: F8,
    rows: Mat,
) -> None:
    """Lead the left leg along `walk`, shape [ticks, 3, 2]; the person bears it, and draws it to `persons` if any."""
    data, command, inbox = ports
    settings, now, state = control
    plant = memory[memory.shape[0] - orthosis.MACHINE :]
    leg, place = orthosis.leg_of(plant, 0), orthosis.PERSON_TORQUE
    for tick in range(rows.shape[0]):
        read_lokomat(memory, inbox, data, tick)
        for joint in range(2):
            now.q[joint], now.dq[joint] = data[DATA_Q + joint], data[DATA_DQ + joint]
            now.torque[joint] = data[DATA_TORQUE + joint]
            now.q_ref[joint], now.dq_ref[joint] = walk[tick, 0, joint], walk[tick, 1, joint]
            now.ddq_ref[joint] = walk[tick, 2, joint]
        if servo:
            position_torques(
                settings.position, settings.frame, now.q, now.dq, now.q_ref, now.dq_ref, now.ddq_ref, state.tau
            )
        else:
            control_impedance(settings, now, state)
        leg[place], leg[place + 1] = weight(links, now.q[0], now.q[1])
        for joint in range(2):
            if persons.shape[0] > 0:
                leg[place + joint] += _PERSON_STIFFNESS * (persons[tick, 0, joint] - now.q[joint])
                leg[place + joint] += _PERSON_DAMPING * (persons[tick, 1, joint] - now.dq[joint])
        for joint in range(2):
            command[COMMAND_TORQUE + joint] = state.tau[joint]
            rows[tick, joint], rows[tick, 2 + joint] = now.q[joint], state.guided[joint]
        command[COMMAND_ENABLED] = 1.0
        write_lokomat(memory, command, tick)


@kernel
def _compute(servo: bool, settings: LegSettingsRecord, now: LegInputRecord, state: LegStateRecord, calls: int) -> None:
    """Compute the torques of position control or guidance again and again: for timing."""
    position, own = settings.position, settings.guidance
    for call in range(calls):
        now.q[0] += _STEP * call
        if servo:
            position_torques(position, settings.frame, now.q, now.dq, now.q_ref, now.dq_ref, now.ddq_ref, state.tau)
        else:
            guide_joints(own, now.guidance, now.q, now.dq, now.q_ref, now.dq_ref, now.ddq_ref, state.guided)


def _walk(ticks: int, late: float = 0.0) -> F8:
    """Return the reference of hip and knee with velocity and acceleration, shape [ticks, 3, 2]."""
    step, (knee, least) = step_of(_SPEED, _HEIGHT), knee_series(_HEIGHT)
    u, phase = (
        np.hypot(_SPEED, least),
        natural_cadence(_SPEED, _HEIGHT) * _DT * np.arange(ticks, dtype=np.float64) - late,
    )
    thigh: F8 = np.array([1.0, step, step * step]) @ thigh_series(_HEIGHT)
    shank: F8 = np.array([1.0, u, u * u]) @ knee
    path = np.stack([series_at(thigh, phase), series_at(shank, phase)], 1)
    rate = np.gradient(path, _DT, axis=0)
    return np.ascontiguousarray(np.stack([path, rate, np.gradient(rate, _DT, axis=0)], 1))


class Leg:
    """A leg and its controller.

    Args:
        servo: A position controller leads it; otherwise guidance.
        position: Fields of the position control (`POSITION_SETTINGS`).
        guidance: Fields of the guidance (`GUIDANCE_SETTINGS`).
    """

    def __init__(
        self, *, servo: bool, position: dict[str, float] | None = None, guidance: dict[str, float] | None = None
    ) -> None:
        self._rig, self._servo = Rig(), servo
        for field, value in (position or {}).items():
            self._rig.settings["position"][field] = value
        for field, value in (_GUIDED | (guidance or {})).items():
            self._rig.settings["guidance"][field] = value

    def lead(self, *, late: bool = False) -> Led:
        """Lead it along the walk; a person who is `late` walks the same path."""
        cycle = round(1.0 / (natural_cadence(_SPEED, _HEIGHT) * _DT))
        walk = _walk(_CYCLES * cycle)
        persons = _walk(len(walk), _LATE) if late else np.zeros((0, 3, 2))
        start = walk[0, 0]
        play = self._rig.begin(IMPEDANCE, Person(), start=(float(start[0]), float(start[1])))
        play.now["guidance"], rows = 1.0, np.zeros((len(walk), 4))
        ports = np.zeros(DATA_LENGTH), np.zeros(COMMAND_LENGTH), np.zeros(INBOX_LENGTH)
        _lead(play.memory, ports, self._servo, play.control, self._rig.person_links, walk, persons, rows)
        away, torque = (rows[:, :2] - walk[:, 0])[cycle:], rows[cycle:, 2:]
        return Led(float(np.sqrt((away**2).mean())), float(np.sqrt((torque**2).mean())))

    def cost_us(self) -> float:
        """Return the cost of its torques in a tick [us]."""
        now, state = np.zeros(1, LEG_INPUT), np.zeros(1, LEG_STATE)
        now["q"], now["dq"], now["q_ref"], now["dq_ref"] = (0.3, 0.6), (0.5, 0.8), (0.32, 0.5), (0.4, 0.9)
        now["ddq_ref"], now["guidance"] = (1.0, -2.0), 1.0
        settings = self._rig.settings[0]
        return shortest_us(lambda: _compute(self._servo, settings, now[0], state[0], _CALLS), _CALLS)
