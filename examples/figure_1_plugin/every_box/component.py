"""Component and the scenario that reads it: a wind sock that shows how fast the ball is."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta

from mimics_app.scenarios.wavy_tunnel import WavyTunnel
from mimics_app.world.components.registry import Component


class WindSock(Component, frozen=True):
    """The entity becomes longer with the speed of the ball."""

    per_speed: Annotated[float, Meta(gt=0.0, le=100.0, description="Growth per speed [s/m]")] = 5.0


class WindyTunnel(WavyTunnel):
    """The wavy tunnel with wind socks."""

    def __init__(self, scene, world):
        super().__init__(scene, world)
        self._socks = [(world.find(entity), sock.per_speed) for entity, sock, _ in scene.components(WindSock)]

    def apply(self, orders, snapshot):
        """Carry out the orders, and stretch the socks."""
        super().apply(orders, snapshot)
        speed = sum(v * v for v in snapshot.v_world) ** 0.5
        for node, per_speed in self._socks:
            node.set_scale((1.0 + per_speed * speed, 1.0, 1.0))
