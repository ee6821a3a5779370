"""A device with its emulated other side in one thread: a tick of the loop, then a step of the robot, counted."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.loop.loop_ports import DevicePlugin
from mimics_app.rendering.haptic.descriptors.lokomat import LOKOMAT
from mimics_app.rendering.haptic.devices.dynamics import servo_dynamics
from mimics_app.rendering.haptic.devices.emulators.faults import apply_order
from mimics_app.rendering.haptic.devices.emulators.hapticmaster import HapticMasterEmulator
from mimics_app.rendering.haptic.devices.emulators.hapticmaster_machine import RATE
from mimics_app.rendering.haptic.devices.emulators.serial_robot import (
    LEG_FRAMES,
    SerialRobotEmulator,
    UdpRobotEmulator,
)
from mimics_app.rendering.haptic.devices.registry import build_device
from mimics_app.rendering.haptic.devices.request import DeviceRequest
from mimics_app.rendering.haptic.devices.simulated_hapticmaster import (
    build_simulated_hapticmaster,
    write_robot,
    write_robot_memory,
)
from mimics_app.rendering.haptic.devices.simulated_lokomat import build_simulated_lokomat
from mimics_app.world.components.robot import Patient, Robot
from tests.support.haptic_bench import PUSH, Bench, read_pushed


class Rig:
    """An emulated robot; `step` moves it, `attended` lets it answer while something here waits for it."""

    def __init__(self, emulator: Any, name: str) -> None:
        self.emulator = emulator
        self.name = name
        self.can_fail = True
        self._plug_wanted = False

    def build(self, address: str = "", **robot: Any) -> DevicePlugin:
        with self.attended():
            return build_device(Robot(device=f"{self.name}:{address or self.emulator.address}", **robot))

    def step(self) -> None:
        self.emulator.step()
        if self._plug_wanted:  # the supervisor's greeting may come at any moment
            self.emulator.greet()

    def spoil(self, what: str) -> None:
        apply_order(self.emulator.faults, what)
        self._plug_wanted = self._plug_wanted or what == "plug"

    @contextmanager
    def attended(self) -> Iterator[None]:
        ended = threading.Event()

        def answer() -> None:
            while not ended.wait(0.002):
                self.emulator.greet()

        thread = threading.Thread(target=answer)
        thread.start()
        try:
            yield
        finally:
            ended.set()
            thread.join()
            self.emulator.greet()  # a program that lost patience while this side was compiled has asked twice

    def advance(self, bench: Bench, ticks: int) -> NDArray[Any]:
        """Ticks of the loop with a step of the robot after each; their samples."""
        rows = []
        for _ in range(ticks):
            rows.append(bench.advance(1))
            self.step()
        return np.concatenate(rows)


@contextmanager
def serial_rig(folder: Path, **robot: Any) -> Iterator[Rig]:
    """A simulated robot on a pseudo-terminal, held by a relaxed arm."""
    simulated = build_simulated_hapticmaster(DeviceRequest(robot=Robot(**{"delay_ticks": 0, **robot})))
    emulator = SerialRobotEmulator(simulated, folder / "robot")
    emulator.rehearse()
    try:
        yield Rig(emulator, "serial")
    finally:
        emulator.close()


@contextmanager
def pushed_serial_rig(folder: Path) -> Iterator[Rig]:
    """The same, pulled by a constant force and by nothing else."""
    request = DeviceRequest(robot=Robot(delay_ticks=0))
    memory = np.zeros(PUSH + 3)
    write_robot_memory(memory[:PUSH], request)
    emulator = SerialRobotEmulator(
        DevicePlugin("pushed", read_pushed, write_robot, memory, **servo_dynamics(request.robot, request.rate)),
        folder / "robot",
    )
    emulator.rehearse()
    try:
        yield Rig(emulator, "serial")
    finally:
        emulator.close()


@contextmanager
def lokomat_rig(folder: Path, line: str, **robot: Any) -> Iterator[Rig]:
    """The simulated gait orthosis on a pseudo-terminal ("serial") or at a UDP port ("udp"), its person passive."""
    request = DeviceRequest(Robot(device="lokomat", delay_ticks=0, **robot), Patient(intent=False), descriptor=LOKOMAT)
    legs = build_simulated_lokomat(request)
    emulator = (
        UdpRobotEmulator(legs, frames=LEG_FRAMES)
        if line == "udp"
        else SerialRobotEmulator(legs, folder / "lokomat", frames=LEG_FRAMES)
    )
    emulator.rehearse()
    try:
        yield Rig(emulator, "lokomat")
    finally:
        emulator.close()


@contextmanager
def hapticmaster_rig(**options: Any) -> Iterator[Rig]:
    """An emulated HapticMaster on a loopback socket; a person holds it who means to lift it by 50 mm when asked to."""
    robot, upwards = Robot(delay_ticks=0, sensor_noise=0.0), np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.05]])
    person = Patient(tremor=0.0, aim_error=0.0, grasp_variation=0.0)
    plugin = build_simulated_hapticmaster(DeviceRequest(robot, person, upwards, rate=RATE))
    emulator = HapticMasterEmulator(plugin, **options)
    emulator.rehearse()  # its first step is compiled, which takes longer than a program waits for an answer
    try:
        yield Rig(emulator, "hapticmaster")
    finally:
        emulator.close()
