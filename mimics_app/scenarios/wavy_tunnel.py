"""The wavy tunnel (D2.1 3.2.2): carry a ball through a tunnel in the frontal plane; grasping makes the ball smaller."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.messages import HapticSnapshot, TaskOrders
from mimics_app.contracts.scenario_port import Scenario, TaskContext
from mimics_app.maths.quat import from_matrix
from mimics_app.rendering.haptic.scene_objects import objects_of_scene
from mimics_app.rendering.haptic.scene_tunnel import PROJECTIONS, tunnel_of_scene
from mimics_app.scenarios.body_nodes import BodyNodes
from mimics_app.scenarios.robot_scene import Places, robot_block, start_at
from mimics_app.world.components.robot import Ball, Robot, Tunnel
from mimics_app.world.components.systems import HapticSettings
from mimics_app.world.components.visible import TunnelView
from mimics_app.world.meshes.mesh import MeshData
from mimics_app.world.meshes.primitives import tube
from mimics_app.world.scene.scene import Scene
from mimics_app.world.scene_node import SceneNode
from mimics_app.world.world import World

__all__ = ["WavyTunnel"]

_TUNNEL_MESH = "tunnel_wall"
_BISECTOR_MESH = "tunnel_bisector"
_BISECTOR_SIDES = 8
_VIA_SPACING = 0.005
"""Distance of the points a simulated person sees along the bisector [m]."""

_FORCES = ("radius_scale", "stiffness", "damping", "drag", "drag_growth", "centring", "advance")
"""Fields the scene's tunnel and the loop's share by name."""

_SCALE_STEP = 0.01
"""The wall is built anew when its radius scale changed by this much [-]; less is not seen."""


class WavyTunnel(Scenario):
    """Tunnel, ball and rings of the scene.

    Args:
        scene: The checked scene; needs entities with `tunnel` and `tunnel_view`, `robot`, and `ball`.
        world: The world built from it; the tunnel's wall is added here.

    Raises:
        SceneError: something the scenario needs is missing, or the tunnel cannot be built.
    """

    def __init__(self, scene: Scene, world: World) -> None:
        self._scene = scene
        self._world = world
        entity, self._tunnel, _ = scene.one(Tunnel)
        self._view = scene.one(TunnelView)[1]
        self._robot = scene.one(Robot)[1]
        self._curve, self._residual = tunnel_of_scene(scene)
        self._scale = self._tunnel.radius_scale
        self._wall_node = world.find(entity)
        self._ball = world.find(scene.one(Ball)[0])
        self._bodies = BodyNodes(world, objects_of_scene(scene).body_entities)
        self._touching: bool | None = None
        self._show_tunnel()
        self._place_rings()

    @property
    def task_context(self) -> TaskContext:
        start = start_at(self._scene, self._curve.point(0.0))
        return TaskContext(*start, places=Places(self._scene), offers=frozenset({"tunnel"}))

    @property
    def via_points_world(self) -> NDArray[np.float64]:
        count = max(2, round(self._curve.length / _VIA_SPACING) + 1)
        return self._curve.point(self._curve.parameter_at(np.linspace(0.0, self._curve.length, count)))

    @property
    def facts(self) -> Mapping[str, Any]:
        s = np.linspace(0.0, len(self._curve.pieces), 241)
        product, _ = self._curve.max_radius_curvature
        placed = self._robot.robot_to_world
        return {
            "bisector_world": self._curve.point(s).tolist(),
            "radius": self._curve.radius(s).tolist(),
            "normal_world": self._curve.frame(s)[1].tolist(),
            "length_m": self._curve.length,
            "max_radius_curvature": product,
            "fit_residual_m": self._residual,
            "robot_to_world": {"rotation": placed.rotation, "translation": placed.translation},
        }

    def scene_block(self) -> NDArray[Any]:
        block = robot_block(self._scene)
        record = block[0]["tunnel"]
        self._curve.fill(record)
        for name in _FORCES:
            record[name] = getattr(self._tunnel, name)
        record["projection"] = PROJECTIONS[self._projection]
        return block

    @property
    def _projection(self) -> str:
        """As the scene names it, else as planned; without a plan the one that is always right."""
        settings = self._scene.system(HapticSettings)
        if settings is not None and settings.projection != "auto":
            return settings.projection
        return str(self._scene.methods.get("tunnel projection", {}).get("projection", "newton warm"))

    def apply(self, orders: TaskOrders, snapshot: HapticSnapshot) -> None:
        self._bodies.follow(snapshot.poses)
        self._ball.set_position(snapshot.hip_world)
        self._ball.set_scale((snapshot.ball_radius,) * 3)
        self._show_touch(touching=snapshot.penetration > 0.0 and bool(np.any(snapshot.f_user_world)))
        scale = orders.visual.get("radius_scale")
        if isinstance(scale, float) and abs(scale - self._scale) >= _SCALE_STEP:
            self._scale = scale
            self._world.replace_mesh(_TUNNEL_MESH, self._build_wall())
        look = orders.visual.get("tunnel_look")
        if isinstance(look, str):
            self._show_look(look)

    def _show_tunnel(self) -> None:
        self._world.replace_mesh(_TUNNEL_MESH, self._build_wall())
        self._show(self._wall_node, _TUNNEL_MESH, self._view.material)
        if self._view.bisector_material is None:
            return
        radii = np.full(self._stations().size, self._view.bisector_radius)
        self._world.replace_mesh(_BISECTOR_MESH, self._build_tube(radii, _BISECTOR_SIDES))
        known = _BISECTOR_MESH in self._world
        node = self._world.find(_BISECTOR_MESH) if known else self._wall_node.create_child(_BISECTOR_MESH)
        self._show(node, _BISECTOR_MESH, self._view.bisector_material, casts_shadow=False)

    def _show(self, node: SceneNode, mesh: str, material: str, *, casts_shadow: bool = True) -> None:
        """Show a mesh on a node, which has it already when the scene was reloaded."""
        if node.entity is not None:
            node.entity.set_material(material)
            return
        for part in self._world.show(node, [(mesh, material)]).subentities:
            part.casts_shadow = casts_shadow

    def _stations(self) -> NDArray[np.float64]:
        pieces = len(self._curve.pieces)
        return np.linspace(0.0, pieces, pieces * self._view.rings_per_piece + 1)

    def _build_wall(self) -> MeshData:
        return self._build_tube(self._scale * self._curve.radius(self._stations()), self._view.sides)

    def _build_tube(self, radii: NDArray[np.float64], sides: int) -> MeshData:
        s = self._stations()
        _, n, b = self._curve.frame(s)
        return tube(self._curve.point(s), n, b, radii, sides=sides)

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
        """Give the ball the look of touching, where the scene has a material for it."""
        if touching == self._touching:
            return
        self._touching = touching
        name = "ball_touching" if touching else "ball"
        if name in self._world.materials and self._ball.entity is not None:
            self._ball.entity.set_material(name)

    def _show_look(self, look: str) -> None:
        """Give the wall another material of the scene, or hide it."""
        wall = self._wall_node.entity
        if wall is None:
            return
        wall.visible = look != "hidden"
        if look != "hidden" and look in self._world.materials:
            wall.set_material(look)
