"""VRPN in pure Python: a client for trackers and motion-capture systems, and a server that emulates one."""

from __future__ import annotations

import select
import socket
import threading

from mimics_app.contracts.clock import Clock
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.tracker_port import TrackerSink
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
    pack,
    pose_body,
)

__all__ = ["VrpnServer", "VrpnTracker"]

_PATIENCE_S = 3.0
_LOOK_S = 0.05
"""How often a waiting thread asks whether it is to end [s]."""


class VrpnTracker(ThreadedTracker):
    """One tracker of a server; its sensors are called by their numbers.

    Args:
        name: As the scene calls it.
        address: TRACKER@HOST[:PORT].
        clock: The session's.
    """

    def __init__(self, name: str, address: str, clock: Clock | None = None) -> None:
        super().__init__(name, clock)
        self._tracker, _, place = address.partition("@")
        host, _, port = place.partition(":")
        self._place = (host or "127.0.0.1", int(port) if port.isdigit() else DEFAULT_PORT)
        self._senders: dict[int, str] = {}
        self._types: dict[int, str] = {}

    def _open(self) -> None:
        try:
            self._line = open_socket(socket.create_connection(self._place, _PATIENCE_S))
            greeting = COOKIE + announcement(SENDER_DESCRIPTION, 0, self._tracker)
            self._line.sendall(greeting + announcement(TYPE_DESCRIPTION, 0, POSE_TYPE))
        except OSError as error:
            what = f"no VRPN server at {self._place[0]}:{self._place[1]}: {error.strerror or error}"
            raise DeviceError(what, "start it, or correct the tracker's address") from None
        self._line.settimeout(_LOOK_S)

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
        self._pass_pose(str(sensor), numbers, t_ns, sink, message.t_ns)


class VrpnServer:
    """Sends poses to every client: stands in for a tracker or a motion-capture system.

    Args:
        tracker: Its name.
        port: To listen on; 0: any.
        host: To listen at; this machine alone unless set otherwise.

    Attributes:
        port: That it listens on.
    """

    def __init__(self, tracker: str, port: int = 0, host: str = "127.0.0.1") -> None:
        self._tracker = tracker
        self._listening = socket.create_server((host, port))
        self.port = int(self._listening.getsockname()[1])
        self._clients: list[socket.socket] = []
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._serve, name="VRPN server", daemon=True)
        self._thread.start()

    def send(
        self,
        sensor: int,
        position: tuple[float, float, float],
        rotation: tuple[float, float, float, float],
        t_ns: int,
    ) -> None:
        """Report a pose to all clients; one that is gone is forgotten."""
        message = pack(0, 0, pose_body(sensor, position, rotation), t_ns)
        for client in list(self._clients):
            try:
                client.sendall(message)
            except OSError:
                self._clients.remove(client)
                client.close()

    @property
    def clients(self) -> int:
        """How many are connected."""
        return len(self._clients)

    def close(self) -> None:
        """Let go of all clients."""
        self._closing.set()
        self._thread.join()
        self._listening.close()
        for client in self._clients:
            client.close()

    def _serve(self) -> None:
        while not self._closing.is_set():
            if not select.select([self._listening], [], [], _LOOK_S)[0]:
                continue
            client, _ = self._listening.accept()
            open_socket(client)
            greeting = COOKIE + announcement(SENDER_DESCRIPTION, 0, self._tracker)
            client.sendall(greeting + announcement(TYPE_DESCRIPTION, 0, POSE_TYPE))
            self._clients.append(client)
