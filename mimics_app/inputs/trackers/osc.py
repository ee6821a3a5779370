"""Poses by OSC over UDP: /pose/SENSOR x y z qx qy qz qw, as sent by bridges of motion-capture systems."""

from __future__ import annotations

from typing import Any

from pythonosc.dispatcher import Dispatcher
from pythonosc.osc_server import BlockingOSCUDPServer

from mimics_app.contracts.clock import Clock
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.tracker_port import TrackerSink
from mimics_app.inputs.trackers.threaded_tracker import POSE_NUMBERS, ThreadedTracker

__all__ = ["OscTracker"]

_PREFIX = "/pose/"
_LOOK_S = 0.05


class OscTracker(ThreadedTracker):
    """Tracker of the messages at a port; the sensor's name follows /pose/, e.g. "subject/wrist_left".

    Args:
        name: Name in the scene.
        address: [HOST:]PORT to listen at; port 0: any.
        clock: The session's clock.

    Attributes:
        port: Number of the port, after `start`.
    """

    def __init__(self, name: str, address: str, clock: Clock | None = None) -> None:
        super().__init__(name, clock)
        host, _, port = address.rpartition(":")
        self._place = (host or "127.0.0.1", int(port) if port.isdigit() else 0)
        self.port = 0

    def _open(self) -> None:
        self._dispatcher = Dispatcher()
        try:
            # The blocking server answers in the thread that reads: no thread per message.
            self._server = BlockingOSCUDPServer(self._place, self._dispatcher)
        except OSError as error:
            what = f"OSC cannot be received at {self._place[0]}:{self._place[1]}: {error.strerror or error}"
            raise DeviceError(what, "give another port") from None
        self.port = int(self._server.server_address[1])

    def _read(self, sink: TrackerSink) -> None:
        self._dispatcher.set_default_handler(lambda address, *values: self._take(address, values, sink))
        self._server.timeout = _LOOK_S
        while not self._stopping.is_set():
            self._server.handle_request()

    def _close(self) -> None:
        self._server.server_close()

    def _take(self, address: str, values: tuple[Any, ...], sink: TrackerSink) -> None:
        numbers = [float(value) for value in values if isinstance(value, int | float)]
        if not address.startswith(_PREFIX) or not len(values) == len(numbers) == POSE_NUMBERS:
            self.rejected += 1
            return
        self._deliver_pose(address[len(_PREFIX) :], numbers, self._clock.now_ns(), sink)
