"""One tunnel in the picture: its wall, a line along its middle, and what a task changes of how it looks."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimics_app.rendering.haptic.tunnel import TunnelCurve
from mimics_app.world.components.visible import TunnelView
from mimics_app.world.meshes.mesh import MeshData
from mimics_app.world.meshes.primitives import tube
from mimics_app.world.scene_node import SceneNode
from mimics_app.world.world import World

__all__ = ["TunnelLook"]

_BISECTOR_SIDES = 8

_SCALE_STEP = 0.01
"""The wall is built anew when its radius scale changed by this much [-]; less is not seen."""


class TunnelLook:
    """A tunnel's wall and bisector on the node of its entity.

    Args:
        world: The world; its meshes get "tunnel_wall" and "tunnel_bisector", each with `suffix`.
        node: Of the tunnel's entity.
        curve: Its geometry.
        view: How it looks.
        scale: Radius scale at first [-].
        suffix: Distinguishes its meshes from those of other tunnels of the scene.
    """

    def __init__(
        self, world: World, node: SceneNode, curve: TunnelCurve, view: TunnelView, scale: float, suffix: str = ""
    ) -> None:
        self._world = world
        self._node = node
        self._curve = curve
        self._view = view
        self._scale = scale
        self._wall_mesh = f"tunnel_wall{suffix}"
        self._show_wall()
        self._show_bisector(f"tunnel_bisector{suffix}")

    def widen(self, scale: object) -> None:
        """Show another radius scale; what is no number, or no other size that can be seen, changes nothing."""
        if isinstance(scale, float) and abs(scale - self._scale) >= _SCALE_STEP:
            self._scale = scale
            self._world.replace_mesh(self._wall_mesh, self._build_wall())

    def dress(self, look: object) -> None:
        """Give the wall another material of the scene by its name, or hide it ("hidden")."""
        wall = self._node.entity
        if wall is None or not isinstance(look, str):
            return
        wall.visible = look != "hidden"
        if look != "hidden" and look in self._world.materials:
            wall.set_material(look)

    def _show_wall(self) -> None:
        self._world.replace_mesh(self._wall_mesh, self._build_wall())
        self._show(self._node, self._wall_mesh, self._view.material)

    def _show_bisector(self, mesh: str) -> None:
        if self._view.bisector_material is None:
            return
        radii = np.full(self._stations().size, self._view.bisector_radius)
        self._world.replace_mesh(mesh, self._build_tube(radii, _BISECTOR_SIDES))
        node = self._world.find(mesh) if mesh in self._world else self._node.create_child(mesh)
        self._show(node, mesh, self._view.bisector_material, casts_shadow=False)

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
