"""Poses by OSC over UDP: /pose/SENSOR x y z qx qy qz qw, as motion-capture bridges send rigid bodies and joints."""

from __future__ import annotations

import math
import threading
from typing import Any

from pythonosc.dispatcher import Dispatcher
from pythonosc.osc_server import BlockingOSCUDPServer
from pythonosc.udp_client import SimpleUDPClient

from mimics_app.contracts.clock import Clock, MonotonicClock
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.tracker_port import TrackerSample, TrackerSink, TrackerSource
from mimics_app.inputs.trackers.plausibility import Plausibility

__all__ = ["OscSender", "OscTracker"]

_PREFIX = "/pose/"
_LOOK_S = 0.05


class OscTracker(TrackerSource):
    """Everything that arrives at a port; the sensor is what follows /pose/, e.g. "subject/wrist_left".

    Args:
        name: As the scene calls it.
        address: [HOST:]PORT to listen at; port 0: any.
        clock: The session's.

    Attributes:
        port: That it listens on, after `start`.
    """

    def __init__(self, name: str, address: str, clock: Clock | None = None) -> None:
        self.name, self.problem, self.rejected = name, "", 0
        host, _, port = address.rpartition(":")
        self._place = (host or "127.0.0.1", int(port) if port.isdigit() else 0)
        self._clock = clock or MonotonicClock()
        self._believed: dict[str, Plausibility] = {}
        self._thread: threading.Thread | None = None
        self.port = 0

    def start(self, sink: TrackerSink) -> None:
        dispatcher = Dispatcher()
        dispatcher.set_default_handler(lambda address, *values: self._take(address, values, sink))
        try:
            # The blocking server answers in the thread that reads: no thread per message.
            self._server = BlockingOSCUDPServer(self._place, dispatcher)
        except OSError as error:
            what = f"no OSC can be heard at {self._place[0]}:{self._place[1]}: {error.strerror or error}"
            raise DeviceError(what, "give another port") from None
        self.port = int(self._server.server_address[1])
        serve = self._server.serve_forever
        self._thread = threading.Thread(target=serve, args=(_LOOK_S,), name=f"tracker {self.name}", daemon=True)
        self._thread.start()

    def poll(self, now_ns: int) -> None:
        """It has a thread."""

    def stop(self) -> None:
        if self._thread is not None:
            self._server.shutdown()
            self._thread.join()
            self._server.server_close()

    def _take(self, address: str, values: tuple[Any, ...], sink: TrackerSink) -> None:
        t_ns = self._clock.now_ns()
        sample = _read(address, values, t_ns)
        sensor = sample.sensor if sample is not None else ""
        if sample is None or not self._believed.setdefault(sensor, Plausibility()).admits(sample):
            self.rejected += 1
            return
        sink(sample)


def _read(address: str, values: tuple[Any, ...], t_ns: int) -> TrackerSample | None:
    numbers = [float(value) for value in values if isinstance(value, int | float)]
    if not address.startswith(_PREFIX) or len(values) != 7 or len(numbers) != 7:
        return None
    x, y, z, qx, qy, qz, qw = numbers
    length = math.sqrt(qx * qx + qy * qy + qz * qz + qw * qw)
    if not 0.9 < length < 1.1:
        return None
    rotation = (qx / length, qy / length, qz / length, qw / length)
    return TrackerSample(address[len(_PREFIX) :], t_ns, (x, y, z), rotation)


class OscSender:
    """Sends poses: stands in for a motion-capture system.

    Args:
        port: Where to, on this machine unless set otherwise.
        host: Which.
    """

    def __init__(self, port: int, host: str = "127.0.0.1") -> None:
        self._client = SimpleUDPClient(host, port)

    def send(
        self, sensor: str, position: tuple[float, float, float], rotation: tuple[float, float, float, float]
    ) -> None:
        """Report a pose."""
        self._client.send_message(_PREFIX + sensor, [*map(float, position), *map(float, rotation)])

    def close(self) -> None:
        """Free the socket."""
        self._client._sock.close()
