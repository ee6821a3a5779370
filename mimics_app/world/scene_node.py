"""SceneNode: a handle on one node of the scene graph."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.maths import mat, quat
from mimics_app.maths.decompose import decompose_trs
from mimics_app.world.camera import Camera
from mimics_app.world.entity import Entity
from mimics_app.world.handle import Handle
from mimics_app.world.light import Light, LightKind

__all__ = ["Frame", "SceneNode"]

Vector = Sequence[float] | F8
Frame = Literal["parent", "own"]
"""Axes of a movement: the parent's, or the node's own."""

_X, _Y, _Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


class SceneNode(Handle):
    """A node: transform, parent and children. Structural edits reach the Transform table at the frame's end."""

    __slots__ = ()

    @property
    def name(self) -> str:
        """Name, unique in the world, or "" for none."""
        return self.world.graph.name(self.index)

    @property
    def parent(self) -> SceneNode | None:
        """Parent node; None for the root and for detached nodes."""
        parent = self.world.graph.parent(self.index)
        return None if parent < 0 else self.world.node(parent)

    @property
    def children(self) -> list[SceneNode]:
        """Child nodes, in the order they were attached."""
        return [self.world.node(child) for child in self.world.graph.hierarchy.children(self.index)]

    def create_child(
        self,
        name: str = "",
        position: Vector = (0.0, 0.0, 0.0),
        orientation: Vector = quat.IDENTITY,
        scale: Vector = (1.0, 1.0, 1.0),
    ) -> SceneNode:
        """Create a child node: position [m], orientation xyzw, scale.

        Raises:
            TypeError: the name is not a text, or something in the place of a vector is none.
            ValueError: the name is taken, or a number is not finite. The node is removed at the frame's end.
        """
        child = self.world.create_node(name, self)
        try:
            child.set_position(position)
            child.set_orientation(orientation)
            child.set_scale(scale)
        except (TypeError, ValueError):
            child.remove()
            raise
        return child

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

    def detach(self) -> None:
        """Take the node off its parent: it and its subtree stay, invisible, until attached again.

        Raises:
            ValueError: it is the root.
        """
        self.world.graph.detach(self.index)

    def remove(self) -> None:
        """Remove the node, its components and its subtree at the frame's end; their handles are stale from then on.

        Raises:
            ValueError: it is the root.
        """
        self.world.graph.queue_removal(self.index)

    def create_entity(self, mesh: str, material: str = "default") -> Entity:
        """Show a mesh of the world on this node.

        Raises:
            KeyError: the world has no such mesh or material; the message names the nearest.
            ValueError: the node has an Entity already.
        """
        return self.world.show(self, [(mesh, material)])

    def create_light(self, kind: LightKind = "directional", **settings: object) -> Light:
        """Put a light here; settings are columns of `Content.lights`.

        Raises:
            ValueError: the node has a light already, or a setting is not a number.
            KeyError: there is no such kind, or a setting is not a column of the table.
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
    def position(self) -> F8:
        """Local position [m], a copy, [3]."""
        return self.world.transforms.translation(self.index)

    @property
    def orientation(self) -> F8:
        """Local orientation, unit xyzw with w >= 0, a copy, [4]."""
        return self.world.transforms.rotation(self.index)

    @property
    def local_scale(self) -> F8:
        """Local scale, a copy, [3]."""
        return self.world.transforms.scale(self.index)

    def set_position(self, position: Vector) -> None:
        """Set the local position [m], [3].

        Raises:
            ValueError: a number is not finite.
        """
        self.world.transforms.set_translation(self.index, position)

    def set_orientation(self, orientation: Vector) -> None:
        """Set the local orientation, xyzw of any length, [4].

        Raises:
            ValueError: it is zero or not finite.
        """
        self.world.transforms.set_rotation(self.index, orientation)

    def set_scale(self, scale: Vector) -> None:
        """Set the local scale, [3].

        Raises:
            ValueError: a number is not finite.
        """
        self.world.transforms.set_scale(self.index, scale)

    def translate(self, offset: Vector, frame: Frame = "parent") -> None:
        """Move by an offset [m] in the parent's axes or the node's own (before its scale)."""
        step = np.array(offset, np.float64)
        if frame == "own":
            quat.rotate(self.orientation, step, step)
        self.set_position(self.position + step)

    def rotate(self, turn: Vector, frame: Frame = "own") -> None:
        """Rotate by a quaternion xyzw, about the node's own axes or the parent's."""
        now, by = self.orientation, quat.normalise_rows(np.asarray(turn, np.float64))
        if frame == "own":
            quat.multiply(now, by, now)
        else:
            quat.multiply(by, now, now)
        self.set_orientation(now)

    def yaw(self, angle: float, frame: Frame = "own") -> None:
        """Rotate by an angle [rad] about +y: positive to the left."""
        self.rotate(quat.about_axis(_Y, angle), frame)

    def pitch(self, angle: float, frame: Frame = "own") -> None:
        """Rotate by an angle [rad] about +x: positive looks up."""
        self.rotate(quat.about_axis(_X, angle), frame)

    def roll(self, angle: float, frame: Frame = "own") -> None:
        """Rotate by an angle [rad] about +z: positive tilts to the left."""
        self.rotate(quat.about_axis(_Z, angle), frame)

    def scale(self, factor: float | Vector) -> None:
        """Multiply the local scale by one factor or by three."""
        self.set_scale(self.local_scale * np.asarray(factor, np.float64))

    def look_at(self, target_world: Vector, up: Vector = _Y) -> None:
        """Rotate the node so that its -z points at a world point [m] and its +y leans towards `up`.

        Raises:
            ValueError: the target is where the node is.
        """
        here = self.world_matrix()
        goal = mat.look_at(here[:3, 3], target_world, up)[:3, :3]
        parent = self.parent
        if parent is not None:
            rotation = np.empty((4, 4))
            mat.compose_trs(np.zeros(3), decompose_trs(parent.world_matrix())[1], np.ones(3), rotation)
            goal = rotation[:3, :3].T @ goal
        orientation = np.empty(4)
        quat.from_matrix(goal, orientation)
        self.set_orientation(orientation)

    def world_matrix(self) -> F8:
        """T_world_from_node as it is now, also before the frame's end; a copy, [4, 4]."""
        return self.world.graph.world_matrix(self.index)

    @property
    def visible(self) -> bool:
        """Visibility flag of the node itself; False hides its subtree too."""
        return self.world.transforms.is_visible(self.index)

    @visible.setter
    def visible(self, visible: bool) -> None:
        self.world.transforms.set_visible(self.index, visible=visible)

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
