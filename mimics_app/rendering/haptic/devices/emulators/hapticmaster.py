"""Emulated HapticMaster: its network interface on a loopback socket, with a simulated person."""

from __future__ import annotations

import socket
from contextlib import suppress

import numpy as np

from mimics_app.contracts.loop.loop_ports import DevicePlugin
from mimics_app.rendering.haptic.devices.emulators.faults import Faults
from mimics_app.rendering.haptic.devices.emulators.hapticmaster_model import HapticMasterModel

__all__ = ["HapticMasterEmulator"]

_HEADER = 8
_MOST = 1 << 16


class HapticMasterEmulator:
    """Server for one client at a time, like the machine.

    Attributes:
        faults: Present faults of the line.
        model: The machine behind the socket.
        commands: Number of frames received.

    Args:
        plugin: Simulated robot and person, built for 2500 ticks per second.
        delay_steps: Delay of each answer, to emulate a slower network [ms].
        seed: Seed of the random bytes.
        port: Port to listen on; 0: any free port.
        calibrated: False: the machine must be calibrated first.
    """

    def __init__(
        self, plugin: DevicePlugin, delay_steps: int = 0, seed: int = 0, port: int = 0, *, calibrated: bool = True
    ) -> None:
        self.faults = Faults()
        self.model = HapticMasterModel(plugin, calibrated=calibrated)
        self.commands = 0
        self._delay = delay_steps
        self._random = np.random.default_rng(seed)
        self._waiting: list[tuple[int, bytes]] = []
        self._received = b""
        self._step = 0
        self._client: socket.socket | None = None
        self._listener: socket.socket | None = None
        self._port = port
        self._listen()

    @property
    def address(self) -> str:
        """Address of the device `hapticmaster:`."""
        return f"127.0.0.1:{self._port}"

    def step(self) -> None:
        """Advance by one millisecond: receive, move, answer."""
        self._follow_plug()
        self._receive()
        self.model.step()
        self._step += 1
        self._send_waiting()

    def rehearse(self) -> None:
        """Run one step, so that nothing is compiled later in real time."""
        self.model.step()

    def greet(self) -> None:
        """Answer without motion, while a program starts."""
        self._follow_plug()
        self._receive()
        if self.model.state == "init":
            self.model.step()
        self._send_waiting(at_once=True)

    def close(self) -> None:
        """Close the socket."""
        self._hang_up()
        if self._listener is not None:
            self._listener.close()
            self._listener = None
        self.model.plugin.close()

    def _listen(self) -> None:
        self._listener = socket.create_server(("127.0.0.1", self._port), reuse_port=False)
        self._listener.setblocking(False)
        self._port = int(self._listener.getsockname()[1])

    def _follow_plug(self) -> None:
        if self.faults.plugged and self._listener is None:
            self._listen()
        elif not self.faults.plugged and self._listener is not None:
            self._hang_up()
            self._listener.close()
            self._listener = None

    def _hang_up(self) -> None:
        if self._client is not None:
            self._client.close()
            self._client = None
            self.model.release()
        self._received = b""
        self._waiting.clear()

    def _receive(self) -> None:
        if self._client is None and self._listener is not None:
            with suppress(BlockingIOError):
                self._client, _ = self._listener.accept()
                self._client.setblocking(False)
                self._client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        if self._client is None:
            return
        try:
            got = self._client.recv(_MOST)
        except BlockingIOError:
            return
        except OSError:
            got = b""
        if not got:
            self._hang_up()
            return
        if not self.faults.deaf:
            self._received += got
            self._obey()

    def _obey(self) -> None:
        while len(self._received) >= _HEADER:
            length = int.from_bytes(self._received[:4], "big")
            if len(self._received) < _HEADER + length:
                return
            text = self._received[_HEADER : _HEADER + length].decode("ascii", "replace")
            self._received = self._received[_HEADER + length :]
            self.commands += 1
            answer = self.model.answer(text).encode("ascii", "replace")
            frame = len(answer).to_bytes(4, "big") + bytes(4) + answer
            self._waiting.append((self._step + self._delay, frame))

    def _send_waiting(self, *, at_once: bool = False) -> None:
        if self._client is None:
            return
        leaves = b""
        while self._waiting and (at_once or self._waiting[0][0] < self._step):
            leaves += self._waiting.pop(0)[1]
        sent = self.faults.spoil(leaves, self._random)
        if sent:
            try:
                self._client.sendall(sent)
            except OSError:  # the client is gone
                self._hang_up()
