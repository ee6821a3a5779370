"""Runs an emulated robot in this process until it is stopped: `mimics devices emulate NAME`."""

from __future__ import annotations

import os
import select
import signal
import sys
import tempfile
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Protocol

import msgspec

from mimics_app.app.devices.emulated_trackers import check_emulated
from mimics_app.app.play.collector import frozen_objects
from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.app.scenes.scenario_choice import open_scenario
from mimics_app.contracts.clock import TICK_NS, MonotonicClock
from mimics_app.contracts.errors import DeviceError, UsageError
from mimics_app.rendering.haptic import scheduler
from mimics_app.rendering.haptic.descriptors.lokomat import LOKOMAT
from mimics_app.rendering.haptic.devices.emulators.faults import Faults, apply_order
from mimics_app.rendering.haptic.devices.request import DeviceRequest
from mimics_app.rendering.haptic.scene_block import robot_from_world
from mimics_app.world.components.robot import Patient, Robot
from mimics_app.world.files.scene.file import build_world

__all__ = ["EmulatorSettings", "open_emulator", "serve"]

_LATEST_NS = 20_000_000
"""Largest delay that is caught up [ns]; beyond, the lost time is skipped."""

_LISTEN_EVERY = 10
"""Period in which stdin is read [steps]."""


class Emulator(Protocol):
    """Interface of an emulated robot."""

    faults: Faults

    @property
    def address(self) -> str:
        """Address of the emulator, after the name and its colon."""

    def step(self) -> None:
        """Simulate one millisecond."""

    def rehearse(self) -> None:
        """Run all its code once, so that it is compiled before a client connects."""

    def close(self) -> None:
        """Close the emulator."""


@dataclass(frozen=True, slots=True)
class EmulatorSettings:
    """Settings of an emulated robot and its simulated person.

    Attributes:
        scene: Scene whose robot is emulated, its path followed; None: a relaxed arm on the default robot.
        patient: Preset instead of the scene's; "" keeps it.
        seed: Seed of person and sensor noise.
        port: Port at which the hapticmaster listens; 0: any free one. Of the lokomat: its UDP port; 0: a serial line.
        delay_ms: Delay of its answers [ms].
    """

    scene: Path | None = None
    patient: str = ""
    seed: int = 1
    port: int = 0
    delay_ms: int = 0


@contextmanager
def open_emulator(name: str, settings: EmulatorSettings) -> Iterator[Emulator]:
    """Open an emulated robot; the context closes it.

    Raises:
        UsageError: There is no emulator of that name.
        DeviceError: The port is in use, or the system has no pseudo-terminals.
        SceneError: The scene is faulty.
    """
    check_emulated(name)
    request = _request(settings)
    with tempfile.TemporaryDirectory(prefix="mimics-") as folder:
        emulator = _open(name, request, Path(folder), settings)
        try:
            emulator.rehearse()
            yield emulator
        finally:
            emulator.close()


def serve(emulator: Emulator, seconds: float | None) -> None:
    """Run an emulator in real time. Lines of stdin inject faults; "quit" or a signal ends it.

    Args:
        emulator: The emulated robot.
        seconds: Length [s]; None: until it is stopped.
    """
    if threading.current_thread() is threading.main_thread():
        _raise_priority()
    with frozen_objects():
        _step_each_millisecond(emulator, seconds)


def _step_each_millisecond(emulator: Emulator, seconds: float | None) -> None:
    clock = MonotonicClock()
    due = clock.now_ns()
    end = 1 << 62 if seconds is None else due + round(seconds * 1e9)
    orders = _Orders()
    steps = 0
    while due < end:
        emulator.step()
        steps += 1
        if steps % _LISTEN_EVERY == 0 and not orders.obey(emulator.faults):
            return
        due = max(due + TICK_NS, clock.now_ns() - _LATEST_NS)
        clock.sleep_until_ns(due)


def _raise_priority() -> None:
    """Run this thread at real-time priority, until the operating system's limit on its processor time is reached.

    Only in the main thread: the signal at the limit is that of the process.
    """
    if sys.platform.startswith("linux"):
        thread = threading.get_native_id()
        signal.signal(signal.SIGXCPU, lambda *_: scheduler.demote(thread))
    scheduler.arrange_thread("auto")


class _Orders:
    """Orders from stdin, read without blocking."""

    def __init__(self) -> None:
        self._text = ""
        self._open = True

    def obey(self, faults: Faults) -> bool:
        """Process the input received; return False when the emulator should end."""
        while self._open and select.select([sys.stdin], [], [], 0.0)[0]:
            got = os.read(sys.stdin.fileno(), 4096).decode("utf-8", "replace")
            self._open = bool(got)  # after the end of stdin the emulator continues
            self._text += got
        *lines, self._text = self._text.split("\n")
        for line in filter(None, map(str.strip, lines)):
            if line == "quit":
                return False
            try:
                apply_order(faults, line)
            except UsageError as error:
                sys.stderr.write(f"mimics: {error}\n")
        return True


def _open(name: str, request: DeviceRequest, folder: Path, settings: EmulatorSettings) -> Emulator:
    from mimics_app.rendering.haptic.devices.emulators.hapticmaster import HapticMasterEmulator
    from mimics_app.rendering.haptic.devices.emulators.hapticmaster_machine import RATE
    from mimics_app.rendering.haptic.devices.emulators.serial_robot import (
        LEG_FRAMES,
        SerialRobotEmulator,
        UdpRobotEmulator,
    )
    from mimics_app.rendering.haptic.devices.simulated_hapticmaster import build_simulated_hapticmaster
    from mimics_app.rendering.haptic.devices.simulated_lokomat import build_simulated_lokomat

    if name == "hapticmaster":
        machine = build_simulated_hapticmaster(replace(request, rate=RATE))
        try:
            return HapticMasterEmulator(machine, settings.delay_ms, settings.seed, settings.port)
        except OSError as failure:
            raise DeviceError(f"port {settings.port} cannot be listened on: {failure.strerror}") from failure
    if name == "lokomat" and settings.port:
        legs = build_simulated_lokomat(replace(request, descriptor=LOKOMAT))
        try:
            return UdpRobotEmulator(legs, settings.port, settings.seed, LEG_FRAMES)
        except OSError as failure:
            raise DeviceError(f"port {settings.port} cannot be bound: {failure.strerror}") from failure
    if not hasattr(os, "openpty"):
        raise DeviceError("this system has no pseudo-terminals", "emulate on Linux or macOS")
    if name == "lokomat":
        legs = build_simulated_lokomat(replace(request, descriptor=LOKOMAT))
        return SerialRobotEmulator(legs, folder / "lokomat", settings.seed, LEG_FRAMES)
    return SerialRobotEmulator(build_simulated_hapticmaster(request), folder / "robot", settings.seed)


def _request(settings: EmulatorSettings) -> DeviceRequest:
    """Return the request of a device with robot, person and path of the scene."""
    if settings.scene is None:
        return DeviceRequest(Robot(delay_ticks=0), None, seed=settings.seed)
    scene = load_checked_scene(settings.scene)
    scenario = open_scenario(scene, build_world(scene))
    robot, patient = scene.first(Robot) or Robot(), scene.first(Patient) or Patient()
    if settings.patient:
        patient = msgspec.structs.replace(patient, preset=settings.patient)
    via_points = robot_from_world(robot, scenario.via_points_world)
    return DeviceRequest(msgspec.structs.replace(robot, delay_ticks=0), patient, via_points, settings.seed)
