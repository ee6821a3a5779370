"""Senders of poses for tests of the trackers: a motion-capture system by OSC, and a VRPN server."""

from __future__ import annotations

import select
import socket
import threading
from contextlib import suppress

from pythonosc.udp_client import SimpleUDPClient

from mimics_app.inputs.trackers.vrpn_wire import (
    COOKIE,
    PING_TYPE,
    PONG_TYPE,
    POSE_TYPE,
    SENDER_DESCRIPTION,
    TYPE_DESCRIPTION,
    MessageReader,
    announcement,
    open_socket,
    pack,
    pose_body,
)

__all__ = ["OscSender", "VrpnServer"]

_POLL_S = 0.05
_HERE = "127.0.0.1"
_LAST_PORT = 65_535
_POSE, _PONG = 0, 1
"""Numbers that the server gives to its types of messages."""
_LONGEST_REQUEST = 150
"""Longest datagram of a client that asks to be called [bytes]."""
_PATIENCE_S = 1.0
"""Time in which a client that asked to be called takes the connection [s]."""
_ATTEMPTS = 8
"""Numbers that are tried for a port that is free by TCP and UDP."""


class OscSender:
    """Sender of poses in place of a motion-capture system.

    Args:
        port: Port of the receiver.
        host: Host of the receiver, this machine by default.
    """

    def __init__(self, port: int, host: str = "127.0.0.1") -> None:
        self._client = SimpleUDPClient(host, port)

    def send(
        self, sensor: str, position: tuple[float, float, float], rotation: tuple[float, float, float, float]
    ) -> None:
        """Send a pose."""
        self._client.send_message("/pose/" + sensor, [*map(float, position), *map(float, rotation)])

    def close(self) -> None:
        """Close the socket."""
        self._client._sock.close()


class _Client:
    """A client of the server.

    Attributes:
        line: Connection to it.
        reader: Parser of what it sends.
        ping: Number that it gave to the type of its pings; None until it has announced one.
    """

    def __init__(self, line: socket.socket) -> None:
        self.line, self.reader = line, MessageReader()
        self.ping: int | None = None

    def pings(self) -> int:
        """Read what has arrived and return the number of pings in it.

        Raises:
            OSError: The client is gone.
            ValueError: It does not speak VRPN.
        """
        data = self.line.recv(65536)
        if not data:
            raise ConnectionResetError
        pings = 0
        for message in self.reader.feed(data):
            if message.type == TYPE_DESCRIPTION and message.text == PING_TYPE:
                self.ping = message.sender
            pings += message.type == self.ping
        return pings


class VrpnServer:
    """Server that sends poses to every client, in place of a tracker or a motion-capture system.

    A client connects by TCP (address TRACKER@tcp://HOST), or asks by UDP to be called (TRACKER@HOST): its datagram to
    the same port number holds its address and port in ASCII, ended by a zero, and the server connects there. A host
    that is not the sender of the datagram is not called. Pings are answered, without which clients report that the
    server does not respond.

    Args:
        tracker: Name of the tracker.
        port: Port to listen at on this machine, by TCP and UDP; 0: any.

    Attributes:
        port: Number of the port.
    """

    def __init__(self, tracker: str, port: int = 0) -> None:
        self._tracker = tracker
        self._listening, self._requests = _open_ports(port)
        self.port = int(self._listening.getsockname()[1])
        self._clients: dict[int, _Client] = {}
        self._sending = threading.Lock()
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
        """Send a pose to all clients; one that is gone is removed."""
        message = pack(0, _POSE, pose_body(sensor, position, rotation), t_ns)
        for client in list(self._clients.values()):
            self._send(client, message)

    @property
    def clients(self) -> int:
        """Number of connected clients."""
        return len(self._clients)

    def close(self) -> None:
        """Close all connections."""
        self._closing.set()
        self._thread.join()
        self._listening.close()
        self._requests.close()
        for client in self._clients.values():
            client.line.close()

    def _serve(self) -> None:
        while not self._closing.is_set():
            clients = {client.line.fileno(): client for client in self._clients.values()}
            waiting = [self._listening.fileno(), self._requests.fileno(), *clients]
            for ready in select.select(waiting, [], [], _POLL_S)[0]:
                if ready in clients:
                    self._answer(clients[ready])
                elif ready == self._requests.fileno():
                    self._call_back()
                else:
                    self._greet(self._listening.accept()[0])

    def _call_back(self) -> None:
        """Connect to the client that a datagram asks for; one that cannot be reached asks again."""
        request, sender = self._requests.recvfrom(_LONGEST_REQUEST)
        port = request.rstrip(b"\0").rpartition(b" ")[2]
        if not (port.isdigit() and 0 < int(port) <= _LAST_PORT):
            return
        with suppress(OSError):
            self._greet(socket.create_connection((sender[0], int(port)), _PATIENCE_S))

    def _greet(self, line: socket.socket) -> None:
        """Announce the tracker and the types of messages to a new client."""
        client = _Client(open_socket(line))
        names = announcement(TYPE_DESCRIPTION, POSE_TYPE, _POSE) + announcement(TYPE_DESCRIPTION, PONG_TYPE, _PONG)
        self._clients[id(client)] = client
        self._send(client, COOKIE + announcement(SENDER_DESCRIPTION, self._tracker) + names)

    def _answer(self, client: _Client) -> None:
        """Answer the pings of a client."""
        try:
            pings = client.pings()
        except (OSError, ValueError):
            self._drop(client)
        else:
            for _ in range(pings):
                self._send(client, pack(0, _PONG, b"", 0))

    def _send(self, client: _Client, message: bytes) -> None:
        """Send to a client; messages of the two threads do not mix."""
        try:
            with self._sending:
                client.line.sendall(message)
        except OSError:
            self._drop(client)

    def _drop(self, client: _Client) -> None:
        if self._clients.pop(id(client), None) is not None:
            client.line.close()


def _open_ports(port: int) -> tuple[socket.socket, socket.socket]:
    """Open a TCP and a UDP port of the same number on this machine.

    Raises:
        OSError: The number is in use; of 0, any other is taken.
    """
    for attempt in range(_ATTEMPTS):
        listening = socket.create_server((_HERE, port))
        requests = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            requests.bind(listening.getsockname())
        except OSError:
            listening.close()
            requests.close()
            if port or attempt == _ATTEMPTS - 1:
                raise
        else:
            return listening, requests
    raise AssertionError("the last attempt returns or raises")
