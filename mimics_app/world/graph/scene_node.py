"""SceneNode: a node of the scene graph with what it carries: body, light and camera."""

from __future__ import annotations

from collections.abc import Sequence

from mimics_app.world.graph.camera import Camera
from mimics_app.world.graph.entity import Entity
from mimics_app.world.graph.light import Light
from mimics_app.world.graph.node import Node
from mimics_app.world.graph.node_tables import LightKind

__all__ = ["SceneNode"]


class SceneNode(Node):
    """A node, which carries at most one body, one light and one camera."""

    __slots__ = ()

    def attach(self, what: SceneNode | Entity | Light | Camera) -> None:
        """Move a node with its subtree, or a body, light or camera, to this node. Local transforms stay.

        Raises:
            ValueError: the node is this one or an ancestor of it, or this node has an object of that kind already.
        """
        if isinstance(what, SceneNode):
            self.world.graph.reparent(what.index, self.index)
            return
        if isinstance(what, Entity):
            self.world.content.move_body(what.index, self.index)
        elif isinstance(what, Light):
            self.world.content.lights.move(what.index, self.index)
        else:
            self.world.content.cameras.move(what.index, self.index)
        what.id = self.id

    def create_entity(self, mesh: str, material: str = "default") -> Entity:
        """Show a mesh of the world on this node.

        Raises:
            KeyError: the world has no such mesh or material; the message names the nearest.
            ValueError: the node has an Entity already.
        """
        return self.show([(mesh, material)])

    def show(self, parts: Sequence[tuple[str, str]]) -> Entity:
        """Show (mesh, material) parts on this node.

        Raises:
            KeyError: a mesh or material is unknown; the message names the nearest.
            ValueError: a body is there already.
        """
        for mesh, material in parts:
            self.world.require_mesh(mesh)
            self.world.require_material(material)
        self.world.content.add_body(self.index, parts)
        return Entity(self.world, self.id)

    def create_light(self, kind: LightKind = "directional", **settings: object) -> Light:
        """Put a light here; settings are columns of `Content.lights`.

        Raises:
            ValueError: the node has a light already, or a setting is not a number.
            KeyError: the kind is unknown, or a setting is not a column of the table.
        """
        self.world.content.add_light(self.index, kind, settings)
        return Light(self.world, self.id)

    def create_camera(self, vertical_fov: float = 0.8727, near: float = 0.05, far: float = 100.0) -> Camera:
        """Put a camera here: vertical angle of view [rad], distances of the near and far planes [m].

        Raises:
            ValueError: the node has a camera already, or a setting is not a number.
        """
        self.world.content.cameras.add(self.index, vertical_fov=vertical_fov, near=near, far=far)
        return Camera(self.world, self.id)

    @property
    def entity(self) -> Entity | None:
        """Body of this node, if any."""
        return Entity(self.world, self.id) if self.index in self.world.content.bodies else None

    @property
    def light(self) -> Light | None:
        """Light of this node, if any."""
        return Light(self.world, self.id) if self.index in self.world.content.lights else None

    @property
    def camera(self) -> Camera | None:
        """Camera of this node, if any."""
        return Camera(self.world, self.id) if self.index in self.world.content.cameras else None
