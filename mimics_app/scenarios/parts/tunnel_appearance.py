"""Appearance of one tunnel: its wall, its bisector, and their changes by a task."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.rendering.haptic.tunnel_geometry import TunnelCurve
from mimics_app.world.components.visible import TunnelView
from mimics_app.world.content.meshes.mesh import MeshData
from mimics_app.world.content.meshes.primitives import tube
from mimics_app.world.content.meshes.shape_levels import PIXELS
from mimics_app.world.content.world import World
from mimics_app.world.graph.levels import coverages_of
from mimics_app.world.graph.scene_node import SceneNode

__all__ = ["TunnelAppearance"]


_BISECTOR_SIDES = 8
_FEWEST_SIDES, _THINNEST = 6, 3
"""Facets around the wall, and around the bisector, in the coarsest level of detail."""

_COARSER = 4
"""Levels of detail of a tube beside the finest."""

_SCALE_STEP = 0.01
"""Change of the radius scale at which the wall is rebuilt [-]; less is not visible."""


@dataclass(frozen=True, eq=False)
class TubeLevel:
    """A tube around the curve in one level of detail, and its largest deviation from the finest one [m]."""

    mesh: MeshData
    error: float


class TunnelAppearance:
    """A tunnel's wall and bisector on the node of its entity.

    Args:
        world: The world; its meshes get "tunnel_wall" and "tunnel_bisector", each with `suffix`.
        node: Node of the tunnel's entity.
        curve: Geometry of the tunnel.
        view: Materials and resolution.
        scale: Initial radius scale [-].
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

    def set_radius_scale(self, scale: float | None) -> None:
        """Set the radius scale; None, and what differs by less than is visible, changes nothing."""
        if scale is not None and abs(scale - self._scale) >= _SCALE_STEP:
            self._scale = scale
            self._publish(self._wall_mesh, self._build_wall())

    def set_material(self, appearance: str | None) -> None:
        """Set the wall's material by its name in the scene, or hide the wall ("hidden"); None changes nothing."""
        wall = self._node.entity
        if wall is None or appearance is None:
            return
        wall.visible = appearance != "hidden"
        if appearance != "hidden" and appearance in self._world.materials:
            wall.set_material(appearance)

    def _show_wall(self) -> None:
        self._show(self._node, self._wall_mesh, self._view.material, self._build_wall())

    def _show_bisector(self, mesh: str) -> None:
        if self._view.bisector_material is None:
            return
        tubes = self._build_tube(lambda s: np.full(s.size, self._view.bisector_radius), _BISECTOR_SIDES, _THINNEST)
        node = self._world.find(mesh) if mesh in self._world else self._node.create_child(mesh)
        self._show(node, mesh, self._view.bisector_material, tubes, casts_shadow=False)

    def _show(
        self, node: SceneNode, mesh: str, material: str, tubes: Sequence[TubeLevel], *, casts_shadow: bool = True
    ) -> None:
        """Show a tube on a node, in place of its meshes before a reload."""
        self._publish(mesh, tubes)
        self._world.require_material(material)
        self._world.content.drop_bodies(np.array([node.index], np.int32))
        levels = [[(name, material)] for name in _names(mesh)]
        coverages = coverages_of(tubes[0].mesh.radius, [level.error for level in tubes], PIXELS)
        self._world.content.add_levels(node.index, levels, coverages)
        body = node.entity
        assert body is not None, "its levels were just added"
        for part in body.subentities:
            part.casts_shadow = casts_shadow

    def _publish(self, mesh: str, tubes: Sequence[TubeLevel]) -> None:
        for name, level in zip(_names(mesh), tubes, strict=True):
            self._world.replace_mesh(name, level.mesh)

    def _build_wall(self) -> list[TubeLevel]:
        return self._build_tube(lambda s: self._scale * self._curve.radius(s), self._view.sides, _FEWEST_SIDES)

    def _build_tube(self, radius: Callable[[F8], F8], sides: int, fewest: int) -> list[TubeLevel]:
        """Return a tube around the curve in the resolution of the view, and in `_COARSER` coarser levels of detail.

        The first of these has as many sides as the finest, each further one half as many; each has the fewest rings
        whose error is no larger than that of its sides.

        Args:
            radius: Radius at parameters of the curve [m].
            sides: Sides of the finest.
            fewest: Smallest number of sides.
        """
        most = len(self._curve.pieces) * self._view.rings_per_piece
        tubes = [TubeLevel(self._tube(radius, most, sides), 0.0)]
        widest = float(radius(self._stations(most)).max())
        for k in range(_COARSER):
            around = max(fewest, sides >> k)
            flat = widest * (1.0 - math.cos(math.pi / around))
            rings, bend = self._fewest_rings(radius, most, flat)
            error = bend + flat - widest * (1.0 - math.cos(math.pi / sides))
            tubes.append(TubeLevel(self._tube(radius, rings, around), error))
        return tubes

    def _fewest_rings(self, radius: Callable[[F8], F8], most: int, error: float) -> tuple[int, float]:
        """Return the smallest number of rings within an error of curve and radius, by halving, and its error [m]."""
        every, found = self._stations(most), (most, 0.0)
        place, wide = self._curve.point(every), radius(every)
        while found[0] > 1:
            s = self._stations(found[0] // 2)
            points = self._curve.point(s)
            straight = np.stack([np.interp(every, s, points[:, axis]) for axis in range(3)], axis=1)
            off = np.linalg.norm(place - straight, axis=1) + np.abs(wide - np.interp(every, s, radius(s)))
            if float(off.max()) > error:
                break
            found = found[0] // 2, float(off.max())
        return found

    def _tube(self, radius: Callable[[F8], F8], rings: int, sides: int) -> MeshData:
        s = self._stations(rings)
        _, n, b = self._curve.frame(s)
        return tube(self._curve.point(s), n, b, radius(s), sides=sides)

    def _stations(self, rings: int) -> F8:
        """Return the parameters of the curve at equal steps, [rings + 1]."""
        return np.linspace(0.0, len(self._curve.pieces), rings + 1)


def _names(mesh: str) -> list[str]:
    """Return the mesh names of a tube's levels of detail, the finest first."""
    return [mesh, *(f"{mesh}/{k}" for k in range(1, _COARSER + 1))]
