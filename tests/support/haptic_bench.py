"""A haptic engine on the bench: a scripted device, a simulated robot, a parameter block, and what came out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.compiled.kernel import kernel, typed_kernel
from mimics_app.contracts.loop.controller_slots import Slot, names_in
from mimics_app.contracts.loop.device_descriptor import Kinematics
from mimics_app.contracts.loop.haptic import INBOX, SAMPLE
from mimics_app.contracts.loop.loop_ports import (
    DATA_AGE,
    DATA_BUTTONS,
    DATA_DELAY,
    DATA_DQ,
    DATA_FORCE,
    DATA_GRASP,
    DATA_Q,
    READ,
    WRITE,
    DevicePlugin,
)
from mimics_app.contracts.loop.object_rows import ObjectCapacities, Rows, new_rows
from mimics_app.contracts.shared_memory import ring
from mimics_app.contracts.shared_memory.session_memory import Capacities, SessionMemory
from mimics_app.rendering.haptic.controllers.registry import controllers_of, set_controllers
from mimics_app.rendering.haptic.descriptors.hapticmaster import HAPTICMASTER
from mimics_app.rendering.haptic.devices.dynamics import servo_dynamics
from mimics_app.rendering.haptic.devices.registry import build_device
from mimics_app.rendering.haptic.devices.request import DeviceRequest
from mimics_app.rendering.haptic.devices.simulated_hapticmaster import write_robot, write_robot_memory
from mimics_app.rendering.haptic.engine import HapticEngine
from mimics_app.rendering.haptic.kernels.robot import ROBOT_LENGTH, sense, step_robot
from mimics_app.rendering.haptic.kernels.state import new_states
from mimics_app.rendering.haptic.replay import replay_run
from mimics_app.rendering.haptic.scene_block import controller_values, dynamics_of, scene_from_components
from mimics_app.rendering.haptic.tunnel_geometry import build_tunnel
from mimics_app.world.components.robot import Patient, Robot

Q, DQ, FORCE, GRASP, BUTTONS, AGE, DELAY, STATUS = 0, 3, 6, 9, 10, 11, 12, 13
ROW = 14
"""One scripted tick of three joints and a hand: their data one behind the other, and a DeviceStatus."""

_PLACES = np.array(
    [DATA_Q + i for i in range(3)]
    + [DATA_DQ + i for i in range(3)]
    + [DATA_FORCE + i for i in range(3)]
    + [DATA_GRASP, DATA_BUTTONS, DATA_AGE, DATA_DELAY]
)
KIN = tuple(HAPTICMASTER.kinematics)


@kernel
def script_data(memory, row, data):
    for i in range(STATUS):
        data[_PLACES[i]] = memory[row + i]


@typed_kernel(READ)
def read_script(memory, inbox, data, tick):
    row = min(tick, memory.shape[0] // ROW - 1) * ROW
    script_data(memory, row, data)
    return np.int64(memory[row + STATUS])


@typed_kernel(WRITE)
def ignore(memory, command, tick):
    return 0


def script(ticks: int) -> NDArray[np.float64]:
    """Rows of a device at rest in the middle of its workspace; change what the test is about."""
    return np.zeros((ticks, ROW))


def glide(rows: NDArray[np.float64], tick: int, column: int, to: float, ticks: int = 20) -> None:
    """Lead one column from what it is to another value within some ticks, as a hand can, and leave it there."""
    start = rows[tick - 1, column]
    rows[tick:, column] = to
    rows[tick : tick + ticks, column] = start + (to - start) * np.arange(1, ticks + 1) / ticks


PUSH = ROBOT_LENGTH
"""Place of the constant force [N], robot frame, in a pushed robot's memory; zero until the test sets it."""


@typed_kernel(READ)
def read_pushed(memory, inbox, data, tick):
    machine = memory[:ROBOT_LENGTH]
    if tick > 0:
        step_robot(machine)
    data[DATA_GRASP] = 20.0
    sense(machine, memory[PUSH : PUSH + 3], data)
    return 0


@dataclass
class Bench:
    """An engine with its memory, its parameter block and its inbox."""

    memory: SessionMemory
    engine: HapticEngine
    scene: NDArray[Any]
    inbox: NDArray[Any] = field(default_factory=lambda: np.zeros(1, INBOX))
    blocks: dict[int, NDArray[Any]] = field(default_factory=dict)
    rows: Rows = field(default_factory=lambda: new_rows(ObjectCapacities()))
    row_blocks: dict[int, Rows] = field(default_factory=dict)
    kinematics: Kinematics = HAPTICMASTER.kinematics
    period_ns: int = 1_000_000

    @property
    def tunnel(self) -> Any:
        """The bench's one tunnel, a TUNNEL record; without pieces it holds nothing."""
        return self.rows.tunnels[0]

    def publish(self, rows: Rows | None = None, **values: Any) -> None:
        """Change fields ("tunnel.stiffness" as tunnel__stiffness), count the sequence up, publish."""
        self.rows = (rows or self.rows)._replace(tunnels=self.rows.tunnels)
        self.scene[0]["objects"]["tunnels"] = len(self.rows.tunnels)
        for name, value in values.items():
            table, _, field = name.rpartition("__")
            part = self.tunnel if table == "tunnel" else self.scene[0][table] if table else self.scene[0]
            place = part[field]
            if np.ndim(place) and 1 < np.size(value) < np.size(place):  # joints, or points, of the device
                place[: np.size(value)], place[np.size(value) :] = value, 0.0
            else:
                part[field] = value
        self.scene[0]["sequence"] = len(self.blocks) + 1
        self.blocks[len(self.blocks) + 1] = self.scene.copy()
        self.row_blocks[len(self.blocks)] = Rows(*(table.copy() for table in self.rows))
        self.engine.publish(self.scene, self.rows)

    def send(self, **values: Any) -> None:
        for name, value in values.items():
            self.inbox[0][name] = value
        self.engine.send(self.inbox)

    def advance(self, ticks: int) -> NDArray[Any]:
        """Run ticks on the virtual clock and return their samples."""
        self.engine.advance(ticks)
        return self.samples()

    def replay(
        self,
        samples: NDArray[Any],
        blocks: Mapping[int, NDArray[Any]] | None = None,
        rows: Mapping[int, Rows] | None = None,
    ) -> NDArray[Any]:
        """Simulate recorded samples again, with the blocks and rows that were published unless others are given."""
        blocks, rows = self.blocks if blocks is None else blocks, self.row_blocks if rows is None else rows
        return replay_run(samples, blocks, rows, kinematics=self.kinematics, period_ns=self.period_ns).samples

    def samples(self) -> NDArray[Any]:
        out = np.zeros(self.memory.samples.shape[0], SAMPLE)
        count = ring.drain(self.memory.sample_words, self.memory.samples, out)
        return out[:count]


def add_forms(block: NDArray[Any]) -> None:
    """Put the other two forms of admittance into the slots behind PERSON."""
    for slot, name in enumerate(("admittance_polar", "admittance_seed"), Slot.PERSON + 1):
        for each, value in controller_values(block, slot, name).items():
            block[0][each] = value


def states_of(block: NDArray[Any]) -> NDArray[Any]:
    """Initial states of a loop with the controllers of a block."""
    states = new_states()
    set_controllers(states, controllers_of(names_in(block[0]["controller_names"])))
    return states


def bench_of(
    plugin: DevicePlugin, *, straight: float | None = 0.04, samples: int = 1 << 15, passivity: int = 1, **kwargs: Any
) -> Bench:
    """An engine over a plug-in. `straight`: radius of a straight tunnel along the world's x, None: no tunnel."""
    memory = SessionMemory(Capacities(samples=samples, **kwargs.pop("capacities", {})))
    kinematics, period_ns = (plugin.descriptor or HAPTICMASTER).kinematics, 1_000_000_000 // kwargs.get("rate", 1000)
    engine = HapticEngine(memory, plugin, **kwargs)
    bench = Bench(memory, engine, scene_from_components(), kinematics=kinematics, period_ns=period_ns)
    for name, value in dynamics_of(plugin).items():
        bench.scene[0][name] = value
    record = bench.tunnel
    record["radius_scale"] = 1.0
    if straight is not None:
        build_tunnel([[-0.15, 0.0, 0.0], [0.15, 0.0, 0.0]], straight).fill(record)
    record["stiffness"], record["damping"], record["drag"], record["drag_growth"] = 2000.0, 25.0, 2.0, 2000.0
    bench.scene[0]["force_rate_limit"], bench.scene[0]["passivity"] = 20000.0, 0 if plugin.own_mass else passivity
    bench.publish(controller=Slot.PERSON)
    return bench


def scripted(rows: NDArray[np.float64], **kwargs: Any) -> Bench:
    """An engine over a scripted device that repeats its last row for ever.

    It does not follow commands, so there is no virtual mass whose energy could be controlled.
    """
    plugin = DevicePlugin("script", read_script, ignore, np.ascontiguousarray(rows).ravel())
    return bench_of(plugin, passivity=0, **kwargs)


def wavy() -> Any:
    """A tunnel with two bends in the frontal plane."""
    x = np.linspace(-0.16, 0.16, 14)
    points = np.stack([x, 0.05 * np.sin((x + 0.16) / 0.32 * 2.5 * np.pi), np.zeros_like(x)], axis=1)
    return build_tunnel(points, 0.022)


def pushed_bench(robot: Robot, **kwargs: Any) -> Bench:
    """The simulated robot pulled by a constant force and by nothing else: no hand to steady it."""
    memory = np.zeros(ROBOT_LENGTH + 3)
    request = DeviceRequest(robot=robot)
    write_robot_memory(memory[:ROBOT_LENGTH], request)
    return bench_of(
        DevicePlugin("pushed", read_pushed, write_robot, memory, **servo_dynamics(request.robot, request.rate)),
        **kwargs,
    )


def patient_bench(
    preset: str = "healthy", seed: int = 1, *, intent: bool = True, robot: Robot | None = None, **kwargs: Any
) -> Bench:
    """The simulated person in the wavy tunnel, robot driven to its start by world PD."""
    curve = wavy()
    way = curve.point(np.linspace(0.0, len(curve.pieces), 200))
    plugin = build_device(robot or Robot(), Patient(preset=preset, intent=intent), way, seed)
    bench = bench_of(plugin, straight=None, **kwargs)
    curve.fill(bench.tunnel)
    R, origin = bench.scene[0]["R_world_from_robot"], bench.scene[0]["origin_world"]
    bench.scene[0]["ball_radius_min"], bench.scene[0]["ball_radius_max"] = 0.008, 0.016
    bench.publish(controller=Slot.START, target=R.T @ (curve.point(0.0)[0] - origin))
    return bench


def pointer_bench(**kwargs: Any) -> Bench:
    """A pointing device in a straight tunnel of 40 mm along the world's x."""
    return bench_of(build_device(Robot(device="pointer"), seed=3), **kwargs)
