"""VRPN in pure Python: a client for trackers and motion-capture systems."""

from __future__ import annotations

import socket

from mimics_app.contracts.clock import Clock
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.ports.tracker_port import TrackerSink
from mimics_app.inputs.trackers.threaded_tracker import ThreadedTracker
from mimics_app.inputs.trackers.vrpn_wire import (
    COOKIE,
    DEFAULT_PORT,
    POSE_TYPE,
    SENDER_DESCRIPTION,
    TYPE_DESCRIPTION,
    Message,
    MessageReader,
    announcement,
    open_socket,
)

__all__ = ["VrpnTracker"]

_PATIENCE_S = 3.0
_TCP = "tcp://"
"""What VRPN's own clients take to connect by TCP alone, without a first datagram."""
_POLL_S = 0.05
"""Period in which a waiting thread checks whether to end [s]."""


class VrpnTracker(ThreadedTracker):
    """One tracker of a server; its sensors are named by their numbers.

    Args:
        name: Name in the scene.
        address: TRACKER@HOST[:PORT] or TRACKER@tcp://HOST[:PORT], which is the same here: only TCP is used.
        clock: The session's clock.
    """

    def __init__(self, name: str, address: str, clock: Clock | None = None) -> None:
        super().__init__(name, clock)
        self._tracker, _, place = address.partition("@")
        host, _, port = place.removeprefix(_TCP).partition(":")
        self._place = (host or "127.0.0.1", int(port) if port.isdigit() else DEFAULT_PORT)
        self._senders: dict[int, str] = {}
        self._types: dict[int, str] = {}

    def _open(self) -> None:
        try:
            self._line = open_socket(socket.create_connection(self._place, _PATIENCE_S))
            greeting = COOKIE + announcement(SENDER_DESCRIPTION, self._tracker)
            self._line.sendall(greeting + announcement(TYPE_DESCRIPTION, POSE_TYPE))
        except OSError as error:
            what = f"no VRPN server at {self._place[0]}:{self._place[1]}: {error.strerror or error}"
            raise DeviceError(what, "start it, or correct the tracker's address") from None
        self._line.settimeout(_POLL_S)

    def _close(self) -> None:
        self._line.close()

    def _read(self, sink: TrackerSink) -> None:
        reader = MessageReader()
        while not self._stopping.is_set():
            try:
                data = self._line.recv(65536)
            except TimeoutError:
                continue
            except OSError as error:
                self.problem = f"the server is gone: {error.strerror or error}"
                return
            if not data:
                self.problem = "the server has closed the line"
                return
            t_ns = self._clock.now_ns()
            try:
                messages = reader.feed(data)
            except ValueError as error:
                self.problem = str(error)
                return
            for message in messages:
                self._take(message, t_ns, sink)

    def _take(self, message: Message, t_ns: int, sink: TrackerSink) -> None:
        if message.type == SENDER_DESCRIPTION:
            self._senders[message.sender] = message.text
        elif message.type == TYPE_DESCRIPTION:
            self._types[message.sender] = message.text
        elif self._types.get(message.type) == POSE_TYPE and self._senders.get(message.sender) == self._tracker:
            self._take_pose(message, t_ns, sink)

    def _take_pose(self, message: Message, t_ns: int, sink: TrackerSink) -> None:
        pose = message.pose
        if pose is None:
            self.rejected += 1
            return
        sensor, numbers = pose
        self._deliver_pose(str(sensor), numbers, t_ns, sink, message.t_ns)
