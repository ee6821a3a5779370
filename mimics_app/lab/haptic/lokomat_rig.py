"""Rig for measurements: the left leg of the simulated gait orthosis under either control, with a person who is known.

The device is the plug-in of the loop; each tick it is read, the control kernel of the loop sets its torques, and it is
written, as in a session, but without the rest of the loop. The person either presses the foot with a known force, and
bears the weight of the own leg, or moves the leg along a swing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Mat, Vec
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
from mimics_app.rendering.haptic.control.lokomat.leg_control import (
    LEG_INPUT,
    LEG_SETTINGS,
    LEG_STATE,
    control_combined,
    control_impedance,
)
from mimics_app.rendering.haptic.descriptors.lokomat import LOKOMAT
from mimics_app.rendering.haptic.descriptors.segments import HEIGHT, WEIGHT, segments_of
from mimics_app.rendering.haptic.devices.request import DeviceRequest
from mimics_app.rendering.haptic.devices.simulated_lokomat import (
    build_simulated_lokomat,
    read_lokomat,
    write_lokomat,
)
from mimics_app.rendering.haptic.kernels import two_link
from mimics_app.rendering.haptic.kernels.leg_kinematics import GEOMETRY, leg_jacobian
from mimics_app.rendering.haptic.kernels.lokomat import linear_drive, orthosis
from mimics_app.rendering.haptic.kernels.lokomat.linkage import lever
from mimics_app.rendering.haptic.kernels.two_link import centrifugal, mass_matrix, weight
from mimics_app.world.components.robot import Robot

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import LegInputRecord, LegSettingsRecord, LegStateRecord, Table

__all__ = ["COMBINED", "CONTROLS", "IMPEDANCE", "LegControl", "Person", "Play", "Rest", "Rig", "Rows"]

IMPEDANCE, COMBINED = 0, 1
CONTROLS = ("impedance", "combined")
"""Names of the two controls by number."""

_LENGTH = orthosis.MACHINE
_NAMES = (
    "x_real", "x_des", "f_x", "touching", "hip", "knee", "hip_angle", "knee_angle", "hip_rate", "knee_rate"
)  # fmt: skip
"""Columns of a run: place of the foot, force, residual torques of hip and knee, joint angles and true joint speeds."""

Rows = dict[str, NDArray[np.float64]]


@dataclass(frozen=True, slots=True)
class Person:
    """Torques of the person in the left leg.

    Attributes:
        force: On the foot, forward and up [N].
        sway: Amplitude of a force added to it along the first axis [N], at `sway_hz`.
        sway_hz: [Hz]
        damping: Of relaxed joints [N m s/rad].
        swing: Amplitudes of hip and knee of a swing that the person moves along [rad]; 0: the person presses only.
        swing_hz: Its frequency [Hz].
        middle: Its middle [rad].
        stiffness: With which the person follows it [N m/rad].
        bears: Share of the weight of the own leg that the person bears.
        preset: Whether tissue and reflexes are those of the preset that the machine's settings name, not `damping`.
    """

    force: tuple[float, float] = (0.0, 0.0)
    sway: float = 0.0
    sway_hz: float = 0.0
    damping: float = 2.0
    swing: tuple[float, float] = (0.0, 0.0)
    swing_hz: float = 0.0
    middle: tuple[float, float] = (0.15, 0.6)
    stiffness: float = 120.0
    bears: float = 1.0
    preset: bool = False

    @property
    def numbers(self) -> Vec:
        """All numbers in the order of their fields."""
        return np.array(
            [*self.force, self.sway, self.sway_hz, self.damping, *self.swing, self.swing_hz, *self.middle,
             self.stiffness, self.bears, float(self.preset)]
        )  # fmt: skip


_FORCE, _SWAY, _SWAY_HZ, _DAMPING, _SWING, _SWING_HZ, _MIDDLE, _STIFFNESS = 0, 2, 3, 4, 5, 7, 8, 10
_BEARS, _PRESET = 11, 12
_LAG = 0.04
"""Damping over stiffness with which a person follows a swing [s]."""


@kernel
def _move(person: Vec, links: Vec, geometry: Vec, state: Vec, t: float, tau: Vec) -> None:
    """Set the torques of the person at the joints [N m]; on entry those of the preset."""
    q, dq = state[0:2], state[2:4]
    x1, x2, z1, z2 = leg_jacobian(geometry, q)
    push = person[_FORCE] + person[_SWAY] * math.sin(2.0 * math.pi * person[_SWAY_HZ] * t)
    up = person[_FORCE + 1]
    g1, g2 = weight(links, q[0], q[1])
    for joint in range(2):
        tau[joint] = tau[joint] if person[_PRESET] != 0.0 else -person[_DAMPING] * dq[joint]
    tau[0] += person[_BEARS] * g1 + x1 * push + z1 * up
    tau[1] += person[_BEARS] * g2 + x2 * push + z2 * up
    if person[_SWING_HZ] == 0.0:
        return
    w = 2.0 * math.pi * person[_SWING_HZ]
    swing, turned = math.sin(w * t), w * math.cos(w * t)
    m11, m12, m22 = mass_matrix(links, math.cos(q[1]))
    c1, c2 = centrifugal(links, math.sin(q[1]), dq[0], dq[1])
    a1, a2 = -w * w * person[_SWING] * swing, -w * w * person[_SWING + 1] * swing
    tau[0] += m11 * a1 + m12 * a2 + c1
    tau[1] += m12 * a1 + m22 * a2 + c2
    for joint in range(2):
        error = person[_MIDDLE + joint] + person[_SWING + joint] * swing - q[joint]
        rate = person[_SWING + joint] * turned - dq[joint]
        tau[joint] += person[_STIFFNESS] * (error + _LAG * rate)


class LegControl(NamedTuple):
    """Records of the control of a leg.

    Attributes:
        settings: LEG_SETTINGS.
        now: LEG_INPUT of the present tick.
        state: LEG_STATE.
    """

    settings: LegSettingsRecord
    now: LegInputRecord
    state: LegStateRecord


@kernel
def _run(
    kind: int,
    memory: Vec,
    control: LegControl,
    person: Vec,
    links: Vec,
    ports: tuple[Vec, Vec, Vec, Vec],
    first: int,
    rows: Mat,
) -> None:
    """Run the left leg from a tick on for as many as `rows` has; the last port is a torque added to the person."""
    data, command, inbox, added = ports
    settings, now, state = control
    plant = memory[memory.shape[0] - _LENGTH :]
    leg, motion = orthosis.leg_of(plant, 0), orthosis.state_of(plant, 0)
    for tick in range(first, first + rows.shape[0]):
        read_lokomat(memory, inbox, data, tick)
        for joint in range(2):
            now.q[joint], now.dq[joint] = data[DATA_Q + joint], data[DATA_DQ + joint]
            now.torque[joint] = data[DATA_TORQUE + joint]
        if kind == COMBINED:
            control_combined(settings, now, state)
        else:
            control_impedance(settings, now, state)
        place = orthosis.PERSON_TORQUE
        _move(person, links, settings.frame.geometry, motion, tick * now.dt, leg[place : place + 2])
        for joint in range(2):
            leg[place + joint] += added[joint]
            command[COMMAND_TORQUE + joint] = state.tau[joint]
        command[COMMAND_ENABLED] = 1.0
        write_lokomat(memory, command, tick)
        row = rows[tick - first]
        row[0], row[1], row[2] = state.x_real[0], state.x_des[0], state.f_x[0]
        row[3] = 1.0 if state.f_x[0] != 0.0 else 0.0
        g1, g2 = weight(settings.load.links, now.q[0], now.q[1])
        row[4], row[5] = -now.torque[0] - g1, -now.torque[1] - g2
        for joint in range(2):
            row[6 + joint], row[8 + joint] = now.q[joint], motion[2 + joint]


@kernel
def _tick(
    kinds: int, ticks: int, settings: LegSettingsRecord, now: LegInputRecord, states: Table[LegStateRecord]
) -> None:
    """Control both legs for a number of ticks, in contact and out of it in turn: for timing."""
    for tick in range(ticks):
        now.q[0] += now.dt * math.cos(now.dt * tick)
        for leg in range(2):
            if kinds == COMBINED:
                control_combined(settings, now, states[leg])
            else:
                control_impedance(settings, now, states[leg])


@dataclass(frozen=True, slots=True)
class Rest:
    """Loads of a leg at rest.

    Attributes:
        torques: Of the drives of hip and knee [N m].
        state: LEG_STATE record of the control, shape [1].
    """

    torques: tuple[float, float]
    state: NDArray[Any]


def _load_drives(plant: Vec, torques: Vec) -> None:
    """Give the drives of the left leg the currents, rod forces and commands under way of joint torques [N m]."""
    leg, state = orthosis.leg_of(plant, 0), orthosis.state_of(plant, 0)
    for joint in range(2):
        drive = leg[orthosis.DRIVES + joint * linear_drive.DRIVE :][: linear_drive.DRIVE]
        force = torques[joint] / lever(drive, state[joint])
        drive[linear_drive.CURRENT] = force / drive[linear_drive.FORCE_PER_AMPERE]
        leg[orthosis.ROD + joint] = force
        state[orthosis.DRIVE_STATE + joint] += force / drive[linear_drive.ROD_STIFFNESS]
    for _ in range(int(plant[orthosis.DELAY]) + 1):
        orthosis.order_machine(plant, np.array([*torques, 0.0, 0.0]), True)


@dataclass(slots=True)
class Rig:
    """Left leg of the simulated orthosis with numbers of its control.

    Attributes:
        machine: Settings of the device (`robot.settings`).
        rate: Ticks per second.
        settings: LEG_SETTINGS record, shape [1].
        person_links: Links of the leg without the orthosis (`two_link`).
    """

    machine: dict[str, Any] = field(default_factory=dict)
    rate: int = 1000
    settings: NDArray[Any] = field(init=False)
    person_links: Vec = field(init=False)
    _memory: Vec = field(init=False)

    def __post_init__(self) -> None:
        robot = Robot(device="lokomat:sim", settings=self.machine)
        request = DeviceRequest(robot, rate=self.rate, address="sim", descriptor=LOKOMAT)
        self._memory = build_simulated_lokomat(request).memory
        plant = self._memory[-_LENGTH:]
        leg = orthosis.leg_of(plant, 0)
        own = segments_of(self.machine.get("height", HEIGHT), self.machine.get("weight", WEIGHT))
        links = np.array(leg[orthosis.LEG_LINKS : orthosis.LEG_LINKS + two_link.LINKS])
        self.person_links = links.copy()
        share = {
            two_link.THIGH_MASS: own.masses[0],
            two_link.THIGH_INERTIA: own.inertias[0],
            two_link.SHANK_MASS: own.masses[1],
            two_link.SHANK_INERTIA: own.inertias[1],
        }
        orthosis_links = links.copy()
        for place, value in share.items():
            self.person_links[place] = value
            orthosis_links[place] = links[place] - value
        settings = self.settings = np.zeros(1, LEG_SETTINGS)
        settings["frame"]["geometry"] = LOKOMAT.geometry_of(robot)[:GEOMETRY]
        for joint in range(2):
            drive = leg[orthosis.DRIVES + joint * linear_drive.DRIVE :][: linear_drive.DRIVE]
            settings["frame"]["links"][0, joint] = drive[linear_drive.LINK : linear_drive.MASS]
            settings["position"]["motor"][0, joint] = drive[linear_drive.MASS]
            settings["load"]["coulomb"][0, joint] = drive[linear_drive.COULOMB]
            settings["load"]["viscous"][0, joint] = drive[linear_drive.VISCOUS]
            settings["play"][0, joint] = drive[linear_drive.BACKLASH]
        settings["encoder"] = plant[orthosis.ENCODER]
        settings["position"]["links"], settings["load"]["links"] = links, orthosis_links
        settings["position"]["carried"] = orthosis_links
        _write_defaults(settings)

    def run(
        self,
        kind: int,
        person: Person,
        seconds: float,
        start: tuple[float, float] | None = None,
        rest: Rest | None = None,
    ) -> Rows:
        """Run under a control; return its columns over time, see `begin`."""
        return self.begin(kind, person, start, rest).go(seconds)

    def begin(
        self, kind: int, person: Person, start: tuple[float, float] | None = None, rest: Rest | None = None
    ) -> Play:
        """Begin a run under a control.

        Args:
            kind: `IMPEDANCE` or `COMBINED`.
            person: The person.
            start: Joints at the start [rad]; None: those of the device.
            rest: Loads under which the leg rests there; None: it is released.
        """
        memory, plant = (copied := self._memory.copy()), copied[-_LENGTH:]
        play = Play(self, kind, person, memory)
        if start is not None:
            plant[0:2] = start
            orthosis.place_drives(plant)
        if rest is not None:
            play.state = rest.state.copy()
            _load_drives(plant, np.array(rest.torques))
        play.now["dt"], play.now["hard"] = 1.0 / self.rate, 1
        return play

    @property
    def leg(self) -> Vec:
        """Record of the left leg (`orthosis`)."""
        return orthosis.leg_of(self._memory[-_LENGTH:], 0)

    def control(self, kind: int, ticks: int) -> None:
        """Run the control of two legs alone for a number of ticks, for timing."""
        now, states = np.zeros(1, LEG_INPUT), np.zeros(2, LEG_STATE)
        now["dt"], now["hard"], now["q"] = 1.0 / self.rate, 1, (0.3, 0.6)
        _tick(kind, ticks, self.settings[0], now[0], states)


@dataclass(slots=True)
class Play:
    """A run under way.

    Attributes:
        rig: Its rig, whose settings may change.
        kind: `IMPEDANCE` or `COMBINED`.
        person: The person.
        memory: Memory of the device.
        now: LEG_INPUT record, shape [1]; what the sensors do not set may be set between two parts of a run.
        state: LEG_STATE record, shape [1].
        added: Torques added to the person's [N m], shape [2].
        ticks: Ticks gone.
    """

    rig: Rig
    kind: int
    person: Person
    memory: Vec
    now: NDArray[Any] = field(default_factory=lambda: np.zeros(1, LEG_INPUT))
    state: NDArray[Any] = field(default_factory=lambda: np.zeros(1, LEG_STATE))
    added: Vec = field(default_factory=lambda: np.zeros(2))
    ticks: int = 0
    _ports: tuple[Vec, Vec, Vec] = field(
        default_factory=lambda: (np.zeros(DATA_LENGTH), np.zeros(COMMAND_LENGTH), np.zeros(INBOX_LENGTH))
    )

    @property
    def control(self) -> LegControl:
        """The records of the control."""
        return LegControl(self.rig.settings[0], self.now[0], self.state[0])

    def go(self, seconds: float) -> Rows:
        """Run on for a time [s]; return the columns of that part."""
        rig, rows = self.rig, np.zeros((round(seconds * self.rig.rate), len(_NAMES)))
        numbers, links, ports = self.person.numbers, rig.person_links, (*self._ports, self.added)
        _run(self.kind, self.memory, self.control, numbers, links, ports, self.ticks, rows)
        t = (self.ticks + np.arange(len(rows))) / rig.rate
        self.ticks += len(rows)
        return dict(zip(_NAMES, rows.T, strict=True)) | {"t": t}


def _write_defaults(settings: NDArray[Any]) -> None:
    """Write the numbers of both controls that a scene does not set."""
    settings["position"]["bandwidth"], settings["position"]["ratio"] = 40.0, 1.0
    settings["position"]["stiffness"], settings["position"]["computed"] = (4000.0, 2000.0), 1
    settings["load"]["weight"], settings["load"]["friction"], settings["load"]["slow"] = 1.0, 0.95, 0.01
    settings["shafts"]["mass"], settings["shafts"]["damping"] = (500.0, 150.0), 60.0
    settings["shafts"]["friction"], settings["shafts"]["sensor_sign"] = 10.0, 1.0
    settings["shafts"]["speed_limit"], settings["shafts"]["force_limit"] = 0.5, 3000.0
    settings["surface"]["anchor"], settings["surface"]["hold"] = 2e4, 2.0
    settings["foot"]["stiffness"], settings["foot"]["damping"] = 8000.0, 3000.0
    settings["foot"]["anchor"], settings["foot"]["threshold"] = 5000.0, 0.01
    settings["foot"]["impulse"]["force_limit"], settings["foot"]["impulse"]["fading"] = 300.0, 0.05
    settings["wall_force"] = 300.0
