"""Senders of poses for tests of the trackers: a motion-capture system by OSC, and a VRPN server."""

from __future__ import annotations

import select
import socket
import threading

from pythonosc.udp_client import SimpleUDPClient

from mimics_app.inputs.trackers.vrpn_wire import (
    COOKIE,
    POSE_TYPE,
    SENDER_DESCRIPTION,
    TYPE_DESCRIPTION,
    announcement,
    open_socket,
    pack,
    pose_body,
)

__all__ = ["OscSender", "VrpnServer"]

_LOOK_S = 0.05


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


class VrpnServer:
    """Server that sends poses to every client, in place of a tracker or a motion-capture system.

    Args:
        tracker: Name of the tracker.
        port: Port to listen at on this machine; 0: any.

    Attributes:
        port: Number of the port.
    """

    def __init__(self, tracker: str, port: int = 0) -> None:
        self._tracker = tracker
        self._listening = socket.create_server(("127.0.0.1", port))
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
        """Send a pose to all clients; one that is gone is removed."""
        message = pack(0, 0, pose_body(sensor, position, rotation), t_ns)
        for client in list(self._clients):
            try:
                client.sendall(message)
            except OSError:
                self._clients.remove(client)
                client.close()

    @property
    def clients(self) -> int:
        """Number of connected clients."""
        return len(self._clients)

    def close(self) -> None:
        """Close all connections."""
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
            greeting = COOKIE + announcement(SENDER_DESCRIPTION, self._tracker)
            client.sendall(greeting + announcement(TYPE_DESCRIPTION, POSE_TYPE))
            self._clients.append(client)
