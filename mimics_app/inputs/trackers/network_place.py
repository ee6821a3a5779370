"""Where a tracker listens: [HOST:]PORT, this machine alone unless a host is given."""

from __future__ import annotations

from mimics_app.contracts.errors import UsageError
from mimics_app.world.components.trackers import TrackersSettings
from mimics_app.world.files.scene.scene import Scene

__all__ = ["hears_the_network", "listening", "place_of"]

_HERE = "127.0.0.1"
_LAST_PORT = 65_535


def listening(scene: Scene) -> list[tuple[str, str]]:
    """Return the addresses of the scene's trackers that listen, each after its JSON pointer."""
    devices = (scene.system(TrackersSettings) or TrackersSettings()).devices
    return [
        (f"/systems/trackers/devices/{n}/address", spec.address) for n, spec in enumerate(devices) if spec.kind == "osc"
    ]


def place_of(address: str) -> tuple[str, int]:
    """Return host and port of [HOST:]PORT; "" is any port of this machine.

    Raises:
        UsageError: The port is none.
    """
    host, _, port = address.rpartition(":")
    if not port:
        return host or _HERE, 0
    if not (port.isascii() and port.isdigit() and len(port) < 6 and int(port) <= _LAST_PORT):
        raise UsageError(f'"{address}" is not [HOST:]PORT', f"give a port from 1 to {_LAST_PORT}, e.g. 9123")
    return host or _HERE, int(port)


def hears_the_network(host: str) -> bool:
    """Whether other machines reach what listens at this host: 0.0.0.0 is every network of this machine."""
    return host != "localhost" and not host.startswith("127.")
