"""Connection to a HapticMaster and its set-up: the main thread's side of hapticmaster:HOST[:PORT]."""

from __future__ import annotations

import socket
from collections.abc import Callable, Mapping
from contextlib import suppress
from functools import partial
from typing import Any

import numpy as np

from mimics_app.contracts.clock import MonotonicClock
from mimics_app.contracts.errors import DeviceError, nearest
from mimics_app.contracts.loop.calibrated_device import CalibratedDevice
from mimics_app.contracts.loop.loop_ports import DevicePlugin
from mimics_app.rendering.haptic.descriptors.hapticmaster import axis_offset
from mimics_app.rendering.haptic.devices import hapticmaster_loop as loop
from mimics_app.rendering.haptic.devices.address import host_and_port
from mimics_app.rendering.haptic.devices.device_objects import DEFAULT_INERTIA, DeviceObject, hapticmaster_commands
from mimics_app.rendering.haptic.devices.device_search import CONNECT_S, no_hapticmaster
from mimics_app.rendering.haptic.devices.link import LinkSupervisor
from mimics_app.rendering.haptic.devices.request import DeviceRequest

__all__ = ["build_hapticmaster"]

_HEADER = 8
_LONGEST_ANSWER = 65535
_ANSWER_S = 2.0
"""Time-out of one answer [s]."""

_INIT_NS = 90_000_000_000
"""Time-out of the calibration [ns]."""

_POLL_NS = 50_000_000
_INNER_PERIOD = 1.0 / 2500.0

_NUMBERS = {"inertia": (DEFAULT_INERTIA, 0.5, 50.0), "servo_gain": (150.0, 1.0, 1000.0)}
"""Settings that are numbers: default, least, most; [kg], [N s/m]."""

_MODES = ("force_stream", "objects")


class _Conversation:
    """Commands and answers in turn, before the socket is passed to the loop."""

    def __init__(self, host: str, port: int) -> None:
        self._where = f"{host}:{port}"
        try:
            self._socket = socket.create_connection((host, port), timeout=CONNECT_S)
        except OSError as failure:
            raise no_hapticmaster(host, port, failure) from failure
        self._socket.settimeout(_ANSWER_S)
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    def close(self) -> None:
        """Close the connection."""
        self._socket.close()

    def ask(self, command: str) -> str:
        """Return the answer without its ";".

        Raises:
            DeviceError: The machine refuses the command, or does not answer.
        """
        answer = self.try_to_ask(command)
        if answer.startswith("--- ERROR"):
            raise DeviceError(f'the HapticMaster at {self._where} refuses "{command}": {answer}')
        return answer

    def try_to_ask(self, command: str) -> str:
        """Return the answer, also a refusal ("--- ERROR ...").

        Raises:
            DeviceError: The machine does not answer.
        """
        text = command.encode("ascii")
        try:
            self._socket.sendall(len(text).to_bytes(4, "big") + bytes(4) + text)
            header = self._exactly(_HEADER)
            length = int.from_bytes(header[:4], "big")
            if length > _LONGEST_ANSWER or any(header[4:]):
                raise ConnectionError("what comes is not in its frames")
            return self._exactly(length).decode("ascii", "replace").strip().rstrip(";")
        except OSError as failure:
            raise DeviceError(f"the HapticMaster at {self._where} does not answer: {failure}") from failure

    def hand_over(self) -> socket.socket:
        """Return the socket, now non-blocking, for the loop."""
        self._socket.setblocking(False)
        return self._socket

    def _exactly(self, count: int) -> bytes:
        got = b""
        while len(got) < count:
            piece = self._socket.recv(count - len(got))
            if not piece:
                raise ConnectionError("it has closed the connection")
            got += piece
        return got


def build_hapticmaster(request: DeviceRequest) -> DevicePlugin:
    """A HapticMaster on the network.

    `robot.settings` may hold mode ("force_stream" or "objects"), inertia [kg] and servo_gain [N s/m].

    Raises:
        DeviceError: Nothing answers there, the machine refuses, or a setting is wrong.
    """
    host, port = host_and_port(request.address)
    settings = _settings(request.robot.settings)
    memory = np.zeros(loop.HAPTICMASTER_LENGTH)
    memory[loop.TICK] = 1.0 / request.rate
    memory[loop.AXIS_OFFSET] = axis_offset(request.robot)
    memory[loop.GAIN] = settings["servo_gain"]
    memory[loop.OBJECTS] = float(settings["mode"] == "objects")
    memory[loop.OWN_DELAY] = _INNER_PERIOD
    objects = request.objects if settings["mode"] == "objects" else ()
    may_move, wanted, lines = True, list[str](), list[socket.socket]()

    def open_line() -> tuple[int, Callable[[], None]]:
        nonlocal may_move
        talk = _Conversation(host, port)
        try:
            while wanted:
                _STEPS[wanted.pop(0)](talk)
            memory[loop.EMULATED] = _set_up(talk, settings["inertia"], objects, may_move=may_move)
        except DeviceError:
            talk.close()
            raise
        may_move = False
        lines[:] = [talk.hand_over()]
        return lines[0].fileno(), lines[0].close

    def calibrate(step: str) -> None:
        """Let the loop let go of the line; the supervisor opens it again, and calibrates before anything else."""
        wanted.append(step)
        with suppress(OSError):  # it is gone already: the supervisor opens it
            lines[0].shutdown(socket.SHUT_RDWR)

    supervisor = LinkSupervisor(memory, open_line, f"the HapticMaster at {host}:{port}")
    return CalibratedDevice(
        "hapticmaster",
        loop.read_hapticmaster,
        loop.write_hapticmaster,
        memory,
        supervisor.close,
        delay=_INNER_PERIOD,
        own_mass=True,
        real_time=True,
        trouble=supervisor.trouble,
        steps={name: partial(calibrate, name) for name in _STEPS},
    )


def _settings(given: dict[str, Any]) -> dict[str, Any]:
    """Settings of a scene, checked, with defaults for those left out."""
    settings: dict[str, Any] = {"mode": "force_stream"} | {name: limits[0] for name, limits in _NUMBERS.items()}
    for name, value in given.items():
        if name not in settings:
            raise DeviceError(f'the hapticmaster has no setting "{name}"', nearest(name, settings))
        if name == "mode" and value not in _MODES:
            raise DeviceError(f'the hapticmaster has no mode "{value}"', nearest(str(value), _MODES))
        if name in _NUMBERS:
            _, least, most = _NUMBERS[name]
            if isinstance(value, bool) or not isinstance(value, int | float) or not least <= value <= most:
                raise DeviceError(f'the hapticmaster\'s setting "{name}" is {value!r}', f"give {least:g} to {most:g}")
        settings[name] = value
    return settings


def _set_up(talk: _Conversation, inertia: float, objects: tuple[DeviceObject, ...], *, may_move: bool) -> float:
    """Bring the machine to "stop" with its mass, a bias force and the objects; 1 when it is this program's emulator.

    The calibration moves the machine; it runs with `may_move` only, never on its own after a lost connection.
    """
    talk.ask("remove all")
    if talk.ask("get emergencybuttonpushed") == "true":
        raise DeviceError("the HapticMaster's emergency button is down", "release it and press its start button")
    if talk.ask("get position_calibrated") == "false":
        if not may_move:
            what = "the HapticMaster has lost its calibration, which would move it"
            raise DeviceError(what, "take the hand off the handle and start the program again")
        _initialise(talk)
    talk.ask("set state stop")
    talk.ask(f"set inertia {inertia:.6g}")
    for command in ("create biasforce mimics", "set mimics force [0,0,0]", "set mimics enable"):
        talk.ask(command)
    for item in objects:
        for command in hapticmaster_commands(item):
            talk.ask(command)
    return float(talk.try_to_ask("get emulator") == '"mimics"')


def _initialise(talk: _Conversation) -> None:
    """Calibrate the axes of the machine: it moves to their ends."""
    clock = MonotonicClock()
    end = clock.now_ns() + _INIT_NS
    talk.ask("set state init")
    while talk.ask("get state") != "stop":
        if clock.now_ns() > end:
            raise DeviceError("the HapticMaster does not find the ends of its axes")
        clock.sleep_until_ns(clock.now_ns() + _POLL_NS)


def _zero_force_sensor(talk: _Conversation) -> None:
    """Take the present reading of the force sensor as zero."""
    talk.ask("calibrateforcesensor")


_STEPS: Mapping[str, Callable[[_Conversation], None]] = {"position": _initialise, "force_sensor": _zero_force_sensor}
"""Steps of the calibration by name; "position" moves the machine."""
