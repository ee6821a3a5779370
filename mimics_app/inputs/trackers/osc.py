"""Poses by OSC over UDP: /pose/SENSOR x y z qx qy qz qw, as sent by bridges of motion-capture systems."""

from __future__ import annotations

import socket

from mimics_app.contracts.clock import Clock
from mimics_app.contracts.errors import DeviceError, UsageError
from mimics_app.contracts.ports.tracker_port import TrackerSink
from mimics_app.inputs.trackers.network_place import hears_the_network, place_of
from mimics_app.inputs.trackers.osc_wire import OscMessage, read_datagram
from mimics_app.inputs.trackers.threaded_tracker import POSE_NUMBERS, ThreadedTracker

__all__ = ["OscTracker"]

_PREFIX = "/pose/"
_POLL_S = 0.05
"""Period in which a waiting thread checks whether to end [s]."""
_LARGEST = 1 << 16
"""Largest datagram [bytes]."""


class OscTracker(ThreadedTracker):
    """Tracker of the messages at a port; the sensor's name follows /pose/, e.g. "subject/wrist_left".

    A pose counts when it arrives; the time tag of its bundle is kept as the device's time.

    Args:
        name: Name in the scene.
        address: [HOST:]PORT to listen at; port 0: any.
        clock: The session's clock.

    Attributes:
        port: Number of the port, after `start`.
    """

    def __init__(self, name: str, address: str, clock: Clock | None = None) -> None:
        super().__init__(name, clock)
        self._address, self.port = address, 0

    def _open(self) -> None:
        self._line = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self._line.bind(place_of(self._address))
        except (OSError, UsageError) as error:
            self._line.close()
            why = error.strerror or error if isinstance(error, OSError) else error
            raise DeviceError(f"OSC cannot be received at {self._address}: {why}", "give another port") from None
        self._line.settimeout(_POLL_S)
        host, self.port = self._line.getsockname()
        if hears_the_network(host):
            self.problem = f"whoever is on the network can send it poses: it listens at {host}, not at 127.0.0.1"

    def _read(self, sink: TrackerSink) -> None:
        while not self._stopping.is_set():
            try:
                data = self._line.recv(_LARGEST)
            except TimeoutError:
                continue
            try:
                for message in read_datagram(data):
                    self._take(message, sink)
            except ValueError:
                self.rejected += 1

    def _close(self) -> None:
        self._line.close()

    def _take(self, message: OscMessage, sink: TrackerSink) -> None:
        numbers = message.numbers
        if not message.address.startswith(_PREFIX) or numbers is None or len(numbers) != POSE_NUMBERS:
            self.rejected += 1
            return
        self._deliver_pose(message.address[len(_PREFIX) :], numbers, self._clock.now_ns(), sink, message.sent_ns)
