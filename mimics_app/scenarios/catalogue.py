"""Which scenario plays which scene: the first whose component the scene has."""

from __future__ import annotations

from collections.abc import Callable

from mimics_app.contracts.errors import SceneError
from mimics_app.scenarios.scenario import Scenario
from mimics_app.scenarios.wavy_tunnel import WavyTunnel
from mimics_app.world.components_haptic import Tunnel
from mimics_app.world.scene import Scene
from mimics_app.world.world import World

__all__ = ["open_scenario"]

_SCENARIOS: dict[type, Callable[[Scene, World], Scenario]] = {Tunnel: WavyTunnel}


def open_scenario(scene: Scene, world: World) -> Scenario:
    """Bring a scene to life in the world built from it.

    Raises:
        SceneError: no scenario can play it, or the one that would misses a part.
    """
    for component, scenario in _SCENARIOS.items():
        if scene.components(component):
            return scenario(scene, world)
    raise SceneError(scene.issue("/entities", "there is nothing to do in it", 'give an entity a "tunnel"'))
