"""The wavy tunnel (D2.1 3.2.2): carry a ball through a tunnel in the frontal plane; grasping makes the ball smaller."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.messages.orders import Feature
from mimics_app.contracts.messages.stage_messages import HapticSnapshot, TaskOrders
from mimics_app.contracts.ports.scenario_port import Scenario, TaskContext
from mimics_app.maths.quat import from_matrix
from mimics_app.rendering.haptic.scene_objects import objects_of_scene
from mimics_app.rendering.haptic.scene_tunnel import built_tunnel, tunnel_of_scene
from mimics_app.scenarios.parts.body_nodes import BodyNodes
from mimics_app.scenarios.parts.robot_scene import Places, even_points, robot_block, robot_facts, start_at
from mimics_app.scenarios.parts.tunnel_appearance import TunnelAppearance
from mimics_app.tasks.kinds.tunnel.kind import own_tunnel
from mimics_app.world.components.robot import Ball, Tunnel
from mimics_app.world.components.visible import TunnelView
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.scene import Scene

__all__ = ["SCENARIO", "WavyTunnel"]


def _features_of(entity: str, own: str) -> tuple[Feature[float], Feature[str]]:
    """Return the features of a tunnel: its radius over that of its scene, and its material or "hidden".

    Those of the task's own tunnel have no entity in their names.
    """
    prefix = "" if entity == own else f"{entity}."
    return Feature(f"{prefix}radius_scale", 1.0), Feature(f"{prefix}tunnel_look", "")


class WavyTunnel(Scenario):
    """Tunnels, ball and rings of the scene. The path, the rings and the facts are those of the task's own tunnel.

    Args:
        scene: The checked scene; needs entities with `tunnel` and `tunnel_view`, `robot`, and `ball`.
        world: The world built from it; the tunnels' walls are added here.

    Raises:
        SceneError: something the scenario needs is missing, or a tunnel cannot be built.
    """

    def __init__(self, scene: Scene, world: World) -> None:
        self._scene = scene
        self._world = world
        self._own = own_tunnel(scene)
        self._curve, self._residual = tunnel_of_scene(scene, self._own)
        self._ball = world.find(scene.one(Ball)[0])
        self._bodies = BodyNodes(world, objects_of_scene(scene).body_entities)
        self._touching: bool | None = None
        self._looks = self._show_tunnels()
        self._place_rings()

    @property
    def task_context(self) -> TaskContext:
        start = start_at(self._scene, self._curve.point(0.0))
        return TaskContext(*start, places=Places(self._scene), offers=frozenset({"tunnel"}), path_m=self._curve.length)

    @property
    def via_points_world(self) -> NDArray[np.float64]:
        return even_points(self._curve)

    @property
    def facts(self) -> Mapping[str, Any]:
        s = np.linspace(0.0, len(self._curve.pieces), 241)
        product, _ = self._curve.max_radius_curvature
        return {
            "bisector_world": self._curve.point(s).tolist(),
            "radius": self._curve.radius(s).tolist(),
            "normal_world": self._curve.frame(s)[1].tolist(),
            "length_m": self._curve.length,
            "max_radius_curvature": product,
            "fit_residual_m": self._residual,
            **robot_facts(self._scene),
        }

    def scene_block(self) -> NDArray[Any]:
        block = robot_block(self._scene)
        block[0]["own_tunnel"] = objects_of_scene(self._scene).tunnel_entities.index(self._own)
        return block

    def apply(self, orders: TaskOrders, snapshot: HapticSnapshot) -> None:
        self._bodies.follow(snapshot.poses)
        self._ball.set_position(snapshot.hip_world)
        self._ball.set_scale((snapshot.ball_radius,) * 3)
        self._show_touch(touching=snapshot.penetration > 0.0 and bool(np.any(snapshot.f_user_world)))
        for entity, appearance in self._looks.items():
            radius, material = _features_of(entity, self._own)
            appearance.set_radius_scale(orders.visual.get(radius))
            appearance.set_material(orders.visual.get(material))

    @staticmethod
    def features(scene: Scene) -> Sequence[Feature[Any]]:
        own = own_tunnel(scene)
        return [each for entity, _, _ in scene.components(Tunnel) for each in _features_of(entity, own)]

    def _show_tunnels(self) -> dict[str, TunnelAppearance]:
        """Every tunnel that has a view, by its entity; the task's own needs one, be it another entity's."""
        views = {entity: view for entity, view, _ in self._scene.components(TunnelView)}
        views.setdefault(self._own, self._scene.one(TunnelView)[1])
        looks = {}
        for entity, tunnel, pointer in self._scene.components(Tunnel):
            if entity in views:
                curve, _ = built_tunnel(tunnel, pointer, self._scene)
                suffix = "" if entity == self._own else f":{entity}"
                node = self._world.find(entity)
                looks[entity] = TunnelAppearance(self._world, node, curve, views[entity], tunnel.radius_scale, suffix)
        return looks

    def _place_rings(self) -> None:
        """Stand the rings of start and goal upright at the tunnel's ends, where the scene has them."""
        for name, s in (("start_ring", 0.0), ("goal_ring", float(len(self._curve.pieces)))):
            if name in self._world:
                node = self._world.find(name)
                node.set_position(self._curve.point(s)[0])
                t, n, b = (axis[0] for axis in self._curve.frame(s))
                orientation = np.zeros(4)
                from_matrix(np.stack([n, t, -b], axis=1), orientation)
                node.set_orientation(orientation)

    def _show_touch(self, *, touching: bool) -> None:
        """Give the ball the material of touching, where the scene has a material for it."""
        if touching == self._touching:
            return
        self._touching = touching
        name = "ball_touching" if touching else "ball"
        if name in self._world.materials and self._ball.entity is not None:
            self._ball.entity.set_material(name)


SCENARIO = WavyTunnel
